"""What is printed means what the tree means: read back by a reader of its own and compared in numbers."""

import re
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.expressions import Name, Negative, Number, Power, Product, Quotient, Sum
from symflex.print.latex import latex_expression
from symflex.print.latex.expression import Writer, break_lines
from tests.contract.exact import Point, value_of

VALUES = {"a": Fraction(3, 7), "b": Fraction(5, 11), "c": Fraction(13, 17), "s": Fraction(19, 23)}
POINT = Point(0, **VALUES)
TOKEN = re.compile(r"\\frac|\\times|\\cdot|[0-9.]+|[a-z]|[-+/^(){}\[\]]|\\[{}]")
LAYOUT = re.compile(r"\\left|\\right|\\[bB]ig[lr]|\\quad|\\,|\{\}|\s")
OPENING = {"(": ")", "[": "]", "\\{": "\\}", "{": "}"}


class Reader:
    """Reads printed mathematics as a mathematician would; what could be read two ways is an error."""

    def __init__(self, latex):
        text = LAYOUT.sub(" ", latex)
        self.tokens = TOKEN.findall(text)
        assert "".join(self.tokens) == text.replace(" ", "")
        self.place = 0

    @property
    def next(self):
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self):
        self.place += 1
        return self.tokens[self.place - 1]

    def sum(self):
        sign = -1 if self.next == "-" else 1
        if self.next in ("-", "+"):
            self.take()
        total = sign * self.product()
        while self.next in ("+", "-"):
            sign = -1 if self.take() == "-" else 1
            total += sign * self.product()
        return total

    def product(self):
        total, after_slash = self.power(), False
        while self.next not in ("", "+", "-", ")", "]", "}", "\\}"):
            if self.next == "/":
                self.take()
                total /= self.power()
                after_slash = True
                continue
            signed = self.next in ("\\times", "\\cdot")
            if signed:
                self.take()
            assert signed or not after_slash, "a factor right after a slash belongs to either side"
            assert signed or not self.next[0].isdigit(), "two numbers side by side"
            total *= self.power()
            after_slash = False
        return total

    def power(self):
        base = self.atom()
        if self.next == "^":
            self.take()
            return base ** int(self.group())
        return base

    def group(self):
        assert self.take() == "{"
        inner = self.sum()
        assert self.take() == "}"
        return inner

    def atom(self):
        token = self.take()
        if token == "\\frac":
            above = self.group()
            return above / self.group()
        if token in OPENING:
            inner = self.sum()
            assert self.take() == OPENING[token]
            return inner
        return VALUES[token] if token in VALUES else Fraction(token)


def meaning(latex):
    reader = Reader(latex)
    total = reader.sum()
    assert reader.next == ""
    return total


numbers = st.builds(
    Number, st.sampled_from([Fraction(2), Fraction(1, 3), Fraction(5, 4), Fraction(10**40 + 1)])
)
leaves = st.one_of(st.sampled_from([Name(n) for n in VALUES]), numbers)


def branches(inner):
    several = st.lists(inner, min_size=2, max_size=4).map(tuple)
    exponent = st.sampled_from([Number(Fraction(2)), Number(Fraction(3)), Negative(Number(Fraction(1)))])
    return st.one_of(
        st.builds(Sum, several),
        st.builds(Product, several),
        st.builds(Quotient, inner, inner),
        st.builds(Power, inner, exponent),
        st.builds(Negative, inner),
    )


trees = st.recursive(leaves, branches, max_leaves=20)


def is_finite(tree):
    try:
        value_of(tree, POINT)
    except ZeroDivisionError:
        return False
    return True


@settings(max_examples=80)
@given(trees.filter(is_finite), st.sampled_from([6.0, 9.0, 15.0]))
@pytest.mark.slow
def test_an_expression_means_what_its_tree_means_whole_and_broken(tree, width):
    expected = value_of(tree, POINT)
    assert meaning(latex_expression(tree, {})) == expected
    # A number too long for a line goes on in the next.
    lines = [line.replace(r"\quad ", "") for line in break_lines(tree, Writer({}), width, width)]
    assert meaning("".join(lines)) == expected
