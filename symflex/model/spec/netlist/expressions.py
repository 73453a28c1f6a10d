"""Values and expressions as SPICE writes them, read into expressions of a specification.

    4.7k, 10MEGohm     numbers with suffixes, exactly; letters after a suffix are ignored
    2*(a + 1k)^2       the sum of a parameter and 1000: what stands in braces has no units
    pow(a, 2), f(1k)   functions, those of .func included
    3*V(a, b) + I(V1)  where signals are read, in sources of a linear function

Constants are computed exactly. What simulators read in two ways is refused: ``4k7``, ``2^3^2``, a ``mil`` in
an expression; and so is what chooses by value, as min and the ternary operator do, because formulas hold
for all values of their letters. Source: ngspice 39, User's Manual, section 2.8.
"""

from __future__ import annotations

import re
from collections.abc import Container, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import reduce
from typing import Final, Protocol

from symflex.errors import SpecError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    fold,
    names_among,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.expressions.derivative import derivative
from symflex.expressions.nodes import negative, nodes
from symflex.model.spec.netlist.cards import QUOTED, Card

SUFFIXES: Final = {
    "t": "e12", "g": "e9", "k": "e3", "m": "e-3", "u": "e-6", "µ": "e-6", "μ": "e-6", "n": "e-9", "p": "e-12",
    "f": "e-15",
}  # fmt: skip
MIL: Final = "25.4e-6"
NUMBER: Final = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)([a-zµμ\u2126Ω]*)", re.I)
ZEROS: Final = re.compile(r"^(-?)0+(?=\d)")  # before a number, as specifications do not have them
CODED: Final = re.compile(r"\d+(meg|[a-df-zµμΩ])\d+", re.I)  # values such as 4k7
LARGEST_EXPONENT: Final = 60  # of ten, as in the quantities of a specification
MOST_DIGITS: Final = 200
LARGEST_POWER: Final = 64
MOST_BITS: Final = 4000  # of a constant
MOST_DEPTH: Final = 64  # of brackets
PIECE: Final = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?[a-zµμΩ]*)"
    r"|(?P<signal>[vi])\s*\((?P<places>[^()]*)\)"
    r"|(?P<name>[a-z_]\w*)|(?P<sign>\*\*|&&|\|\||[<>=!]=|[-+*/^(),?:<>=!&|%\\]))",
    re.I | re.A,
)
ONE_ARGUMENT: Final = ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")
CHOOSING: Final = frozenset(  # functions, and signs, that are not smooth in their arguments
    "min max int nint floor ceil round sgn abs if limit ternary_fcn pwr uramp u buf inv table pwl".split()
)
COMPARING: Final = ("?", "<", ">", "==", "<=", ">=", "!=", "&&", "||", "=", "!", "&", "|", "%", "\\")
DIFFERS: Final = "simulators read it differently"


class Vocabulary(Protocol):
    """What names mean where an expression stands."""

    def parameter(self, name: str) -> Expression:
        """Return what a name stands for."""

    def call(self, name: str, arguments: Sequence[Expression]) -> Expression | None:
        """Return the value of a function that was defined, ``None`` if there is none of this name."""

    def signal(self, kind: str, places: Sequence[str]) -> Expression:
        """Return a voltage ("v") between nodes, or the current ("i") through a source."""


def number_of(card: Card, text: str) -> tuple[str, str] | None:
    """Return the digits and the power of ten of a value, ``None`` where it is no number."""
    if CODED.fullmatch(text):
        hint = "write a point and a suffix: 4.7k"
        raise card.refuse(f"'{text[:40]}' is not read: {DIFFERS}, 4k7 as 4.7k or as 4k", hint)
    match = NUMBER.fullmatch(text)
    if match is None:
        return None
    digits, letters = ZEROS.sub(r"\1", match[1].lstrip("+")), match[2].lower()
    digits = re.sub(r"\.(?!\d)", "", re.sub(r"^(-?)\.", r"\g<1>0.", digits))
    if (letters[:1] in ("e", "d") and len(letters) > 1) or (letters[:1] == "x" and digits == "0"):
        raise card.refuse(f"'{text[:40]}' is not read: {DIFFERS}", "write an exponent with its digits: 1e3")
    if letters.startswith("mil"):
        return _checked(card, str(Decimal(digits) * Decimal(MIL)), "")
    return _checked(card, digits, "e6" if letters.startswith("meg") else SUFFIXES.get(letters[:1], ""))


def _checked(card: Card, digits: str, suffix: str) -> tuple[str, str]:
    _, _, exponent = digits.lower().partition("e")
    is_large = len(digits) > MOST_DIGITS or len(exponent) > 4  # noqa: PLR2004 (a sign and three digits)
    if is_large or abs(int(exponent or 0)) > LARGEST_EXPONENT:
        raise card.refuse(f"'{digits[:40]}' is too large or too small a number")
    if exponent and suffix:
        digits, suffix = str(Decimal(digits) * Decimal(f"1{suffix}")), ""
    return digits, suffix


def exactly(digits: str, suffix: str) -> Fraction:
    """Return the number of digits and a power of ten."""
    return Fraction(digits) * Fraction(f"1{suffix}")


def exact(value: Expression) -> Fraction | None:
    """Return the number that an expression is."""
    match value:
        case Number(found):
            return found
        case Negative(Number(found)):
            return -found
    return None


def inner_text(text: str) -> str:
    """Return an expression without the braces or quotes around it."""
    while QUOTED.fullmatch(text):
        text = text[1:-1].strip()
    return text


def expression_of(card: Card, text: str, names: Vocabulary) -> Expression:
    """Return an expression of parameters; SF105 when it cannot be read."""
    reading = _Parser(card, inner_text(text.strip()), names)
    try:
        return reading.whole()
    except ZeroDivisionError:
        raise card.refuse(f"'{text[:60]}' divides by zero") from None


class _Parser:
    """One expression, read from left to right."""

    def __init__(self, card: Card, text: str, names: Vocabulary) -> None:
        self.card, self.text, self.names = card, text, names
        self.depth = 0
        self.pieces: list[re.Match[str]] = []
        self.next = offset = 0
        # What braces and quotes within enclose is as in brackets.
        plain = re.sub(r"[{}]", lambda brace: "()"[brace[0] == "}"], text).rstrip()
        while offset < len(plain):
            piece = PIECE.match(plain, offset)
            if piece is None:
                raise self.refuse()
            self.pieces.append(piece)
            offset = piece.end()

    def refuse(self, why: str = "", hint: str = "") -> SpecError:
        hint = hint or "expressions have numbers, parameters, + - * / ^ and functions"
        message = f"'{self.text[:60]}' is not an expression that can be read"
        return self.card.refuse(f"{message}: {why}" if why else message, hint)

    def sign(self, *signs: str) -> str:
        """Take one of these signs, if it comes next."""
        if self.next < len(self.pieces) and (found := self.pieces[self.next]["sign"]) in signs:
            self.next += 1
            return str(found)
        return ""

    def whole(self) -> Expression:
        """Return the value of the whole text."""
        value = self.sum()
        if self.next < len(self.pieces):
            raise self.unread("")
        return value

    def unread(self, otherwise: str) -> SpecError:
        """Return the error that says why the next piece is none that can follow."""
        following = self.pieces[self.next]["sign"] if self.next < len(self.pieces) else None
        if following in COMPARING:
            return self.refuse("it chooses by value", "write the value that it chooses")
        return self.refuse(otherwise)

    def sum(self) -> Expression:
        self.depth += 1
        if self.depth > MOST_DEPTH:
            raise self.refuse("too many brackets are nested")
        value = self.product()
        while sign := self.sign("+", "-"):
            other = self.product()
            value = added(value, other if sign == "+" else negative(other))
            self.bounded(value)
        self.depth -= 1
        return value

    def product(self) -> Expression:
        value = self.signed()
        while sign := self.sign("*", "/"):
            other = self.signed()
            value = product_of([value, other]) if sign == "*" else divided(value, other)
            self.bounded(value)
        return value

    def signed(self) -> Expression:
        is_negative = False
        while sign := self.sign("+", "-"):
            is_negative ^= sign == "-"
        value = self.power()
        return negative(value) if is_negative else value

    def power(self) -> Expression:
        base = self.atom()
        if not self.sign("^", "**"):
            return base
        sign = self.sign("+", "-")
        exponent = self.atom()
        if self.sign("^", "**"):
            raise self.refuse(f"{DIFFERS}, 2^3^2 as 64 or as 512", "write brackets: (2^3)^2")
        return self.raised(base, negative(exponent) if sign == "-" else exponent)

    def raised(self, base: Expression, exponent: Expression) -> Expression:
        by = exact(exponent)
        if by is None or (2 * by).denominator != 1 or abs(by) > LARGEST_POWER:
            raise self.refuse("exponents are whole numbers or halves, at most 64")
        if by.denominator != 1:
            return self.raised(Call("sqrt", base), number(2 * by))
        known = exact(base)
        if known is None or (known == 0 and by <= 0):
            return power(base, int(by))
        return self.bounded(number(known**by.numerator))

    def bounded(self, value: Expression) -> Expression:
        known = exact(value)
        if (
            known is not None
            and max(known.numerator.bit_length(), known.denominator.bit_length()) > MOST_BITS
        ):
            raise self.card.refuse(f"'{self.text[:60]}' has a number of too many digits", code="SF103")
        return value

    def atom(self) -> Expression:
        if self.next == len(self.pieces):
            raise self.refuse("something is missing at its end" if self.pieces else "it is empty")
        piece = self.pieces[self.next]
        self.next += 1
        if text := piece["number"]:
            after = self.pieces[self.next] if self.next < len(self.pieces) else None
            if after is not None and after["number"] and after.start() == piece.end():
                raise self.refuse(f"'{text}{after[0]}'", "write a point and a suffix: 4.7k")
            if re.search(r"\dmil", text, re.I):
                raise self.refuse(f"{DIFFERS}, a mil as 25.4u or as 1m", "write 25.4u")
            digits, suffix = number_of(self.card, text) or ("", "")
            return number(exactly(digits, suffix))
        if kind := piece["signal"]:
            places = [w for w in re.split(r"[\s,]+", piece["places"].strip()) if w]
            return self.names.signal(kind.lower(), places)
        if name := piece["name"]:
            return self.named(name)
        if piece["sign"] != "(":
            raise self.refuse()
        value = self.sum()
        self.closed()
        return value

    def closed(self) -> None:
        """Take the bracket that closes."""
        if not self.sign(")"):
            raise self.unread("a bracket is not closed")

    def named(self, name: str) -> Expression:
        if not self.sign("("):
            return self.names.parameter(name)
        arguments = [self.sum()]
        while self.sign(","):
            arguments.append(self.sum())
        self.closed()
        word = name.lower()
        defined = self.names.call(word, arguments)
        if defined is not None:
            return defined
        match word, arguments:
            case ("ln", [argument]):
                return Call("log", argument)
            case ("log10", [argument]):
                return quotient(Call("log", argument), Call("log", number(10)))
            case ("sqr", [argument]):
                return self.raised(argument, number(2))
            case ("pow", [base, exponent]):
                return self.raised(base, exponent)
            case (_, [argument]) if word in ONE_ARGUMENT:
                return Call(word, argument)
        if word in CHOOSING:
            raise self.refuse(f"'{name}' chooses by value", "write the value that it chooses")
        raise self.refuse(f"there is no function '{name[:40]}' of {len(arguments)}", "define it: .func")


def added(one: Expression, two: Expression) -> Expression:
    """Return a sum; of two numbers, their sum."""
    first, second = exact(one), exact(two)
    return sum_of([one, two]) if first is None or second is None else number(first + second)


def divided(above: Expression, below: Expression) -> Expression:
    """Return a quotient; of two numbers, the number."""
    first, second = exact(above), exact(below)
    return quotient(above, below) if first is None or second is None else number(first / second)


def slopes(expression: Expression, signals: Container[str]) -> dict[str, Expression] | None:
    """Return the coefficient of every signal in an expression, ``None`` where it is not linear.

    What does not vary is left out, because a constant does not act on small signals.
    """
    if any(isinstance(n, Call) and names_among(n, signals) for n in nodes(expression)):
        return None
    found: dict[str, Expression] = {}
    for name in dict.fromkeys(names_among(expression, signals)):
        try:
            slope = derivative(expression, Name(name))
        except ValueError:  # of a broken or varying power
            return None
        if names_among(slope, signals):
            return None
        found[name] = fold(
            slope,
            number=number,
            name=Name,
            power=power,
            call=lambda call, argument: Call(call.name, argument),
            negative=negative,
            total=lambda terms: reduce(added, terms),
            product=product_of,
            quotient=divided,
        )
    return found
