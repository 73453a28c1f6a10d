import sys
from fractions import Fraction

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from symflex.errors import SpecError
from symflex.expressions import (
    PROGRAM_LIMITS,
    USER_LIMITS,
    Attribute,
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    parse,
    parse_equation,
    text_length,
)
from tests.unit.expressions.trees import SHAPE_LIMITS, trees
from tests.unit.quantities.texts import text_of

a, b, c = (Name(name) for name in "abc")


def n(value):
    return Number(Fraction(value))


def read(written):
    return parse(text_of(written), limits=SHAPE_LIMITS)


@settings(max_examples=40)
@given(trees, trees)
@example(Product((a, Negative(Product((b, c))), c)), a)
@example(Sum((Negative(Negative(a)), Negative(Sum((b, c))))), a)
@example(Power(Power(a, b), Negative(Power(b, c))), a)
@pytest.mark.slow
def test_a_printed_equation_and_its_sides_are_read_back_as_themselves(left, right):
    printed = format_expression(Equation(left, right))
    assert parse_equation(text_of(printed), limits=SHAPE_LIMITS) == Equation(left, right)
    assert read(format_expression(left)) == left
    assert read(format_expression(right, power="**")) == right


def without_each_pair(written):
    opened = []
    for position, character in enumerate(written):
        if character == "(":
            opened.append(position)
        elif character == ")":
            start = opened.pop()
            if start == 0 or not (written[start - 1].isalnum() or written[start - 1] in "_'"):
                yield written[:start] + written[start + 1 : position] + written[position + 1 :]


@settings(max_examples=25)
@given(trees)
def test_no_pair_of_parentheses_can_be_left_out(tree):
    for shorter in without_each_pair(format_expression(tree)):
        try:
            found = read(shorter)
        except SpecError:
            continue
        assert found != tree


def test_a_tree_prints_as_a_person_writes_it():
    for tree, expected in [
        (Sum((a, b, Negative(c))), "a + b - c"), (Sum((Negative(a), b)), "-a + b"),
        (Sum((a, Negative(Sum((b, c))))), "a - (b + c)"), (Negative(Sum((a, b))), "-(a + b)"),
        (Product((a, Sum((b, c)))), "a*(b + c)"), (Product((Quotient(a, b), c)), "a/b*c"),
        (Product((a, Quotient(b, c))), "a*(b/c)"), (Product((a, Negative(b))), "a*-b"),
        (Product((Negative(a), b)), "(-a)*b"), (Negative(Product((a, b))), "-a*b"),
        (Quotient(a, Product((b, c))), "a/(b*c)"), (Quotient(Quotient(a, b), c), "a/b/c"),
        (Power(Negative(a), n(2)), "(-a)^2"), (Negative(Power(a, n(2))), "-a^2"),
        (Power(Power(a, b), c), "(a^b)^c"), (Power(a, Power(b, c)), "a^b^c"),
        (Power(a, Quotient(n(1), n(2))), "a^(1/2)"), (Power(Derivative("w", 1), n(2)), "w'^2"),
        (Call("w", Quotient(Name("l"), n(2)), 2), "w''(l/2)"), (Attribute("motor", "i"), "motor.i"),
        (Sum((a, Number(Fraction(-3)))), "a - 3"), (Product((a, Number(Fraction(-3)))), "a*-3"),
    ]:  # fmt: skip
        assert format_expression(tree) == expected, tree


def test_the_operators_can_be_chosen():
    assert format_expression(Product((a, Power(b, n(2)))), multiply=" * ", power="**") == "a * b**2"


def test_a_number_prints_as_short_as_it_is_exact():
    for value, expected in [
        ("0", "0"),
        ("2100000000000", "2.1e12"),
        ("62500000", "62500000"),
        ("1000000", "1000000"),
        ("1/2", "0.5"),
        ("21/10000", "0.0021"),
        ("1/10000", "0.0001"),
        ("1/100000", "1e-5"),
        ("47/10000000000000", "4.7e-12"),
        ("1000001/1000", "1000.001"),
        ("1e-200", "1e-200"),
        (f"{10**39}.5", f"{10**39 * 2 + 1}/2"),
        ("1e-201", f"1/{10**201}"),
        (f"{10**49 + 1}/{4 * 10**52}", f"{10**49 + 1}/4e52"),  # as its sides print alone
        ("1/3", "1/3"),
        ("22/7", "22/7"),
        (f"1/{2**1000}", f"1/{2**1000}"),
        (f"1/{5**700}", f"1/{5**700}"),
    ]:
        assert format_expression(n(value)) == expected, value


@given(st.integers(0, 10**9), st.integers(1, 10**9))
def test_a_number_without_a_short_decimal_is_read_back_as_a_quotient_of_integers(numerator, denominator):
    value = Fraction(numerator, 3 * denominator) + Fraction(1, 3**25)
    expected = Quotient(n(value.numerator), n(value.denominator))
    assert read(format_expression(Number(value))) == expected


def test_a_fraction_inside_a_tree_keeps_its_value():
    for tree, expected in [
        (Power(n("1/3"), n(2)), "(1/3)^2"),
        (Product((a, n("1/3"))), "a*(1/3)"),
        (Product((n("1/3"), a)), "1/3*a"),
        (Quotient(a, n("2/3")), "a/(2/3)"),
        (Power(a, n("1/3")), "a^(1/3)"),
        (Sum((a, Number(Fraction(-1, 3)))), "a - 1/3"),
    ]:
        assert format_expression(tree) == expected, tree


def test_an_integer_longer_than_the_interpreter_prints_is_printed_and_read_back():
    value = Number(Fraction(10**6000 + 7))
    assert parse(text_of(format_expression(value)), limits=PROGRAM_LIMITS) == value


def test_a_sum_longer_than_a_user_may_write_is_printed_and_read_back():
    terms = tuple(Product((n(k + 1), Name(f"a_{k}"), Power(Name("s"), n(k % 9 + 2)))) for k in range(1_500))
    tree = Sum(tuple(Negative(t) if k % 3 else t for k, t in enumerate(terms)))
    printed = format_expression(tree)
    assert len(printed) > USER_LIMITS.characters
    assert parse(text_of(printed), limits=PROGRAM_LIMITS) == tree


def test_a_tree_deeper_than_the_interpreter_can_call_is_printed():
    tree, depth = a, 3 * sys.getrecursionlimit()
    for _ in range(depth):
        tree = Negative(Sum((tree, b)))
    assert format_expression(tree) == "-(" * depth + "a" + " + b)" * depth


def test_a_node_without_a_text_is_refused():
    with pytest.raises(TypeError, match="Expression"):
        format_expression(Expression())


@settings(max_examples=50)
@given(trees)
def test_a_text_is_as_long_as_its_length_says(tree):
    assert text_length(tree) == text_length(tree) == len(format_expression(tree))
