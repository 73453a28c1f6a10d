"""From a tree to text in the specification's own grammar, with no parentheses to spare."""

from __future__ import annotations

from decimal import Decimal
from enum import Enum
from fractions import Fraction
from math import floor, log10

from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
    Differentiated,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    once,
)

# A decimal is short up to so many significant digits, and can be read back down to this decimal exponent.
SHORT_DIGITS = 40
SMALLEST_EXPONENT = -200
SMALLEST_PLAIN_EXPONENT = -4
# A whole number of more than so many digits has an exponent where that saves so many characters.
PLAIN = 7
FEWER = 3


class _Position(Enum):
    """Where a subtree is printed, which decides whether it needs parentheses."""

    ALONE = "the whole text, or between parentheses"
    TERM = "a term of a sum, or what a leading minus negates"
    LEAD = "the first factor of a product, or a numerator"
    FACTOR = "a later factor, a denominator or an exponent"
    BASE = "the base of a power"


# Tuples: so few places are found sooner by identity than by their hashes.
_BARE_SUM = (_Position.ALONE,)
_BARE_NEGATIVE = (_Position.ALONE, _Position.TERM, _Position.FACTOR)
_BARE_PRODUCT = (_Position.ALONE, _Position.TERM, _Position.LEAD)
_BARE_POWER = tuple(place for place in _Position if place is not _Position.BASE)
_BARE_LEAF = tuple(_Position)

# Work still to do, last piece first: finished text, or a subtree and its place.
_Work = list["str | tuple[Expression, _Position]"]


def format_expression(expression: Expression, *, multiply: str = "*", power: str = "^") -> str:
    """Print a tree so that :func:`~symflex.expressions.parse` reads the same tree back.

    It may have any width and depth, and gets the fewest parentheses; an :class:`Equation` is printed as
    ``left = right``. The operators may be others: ``power="**"`` is read back too and suits other languages.

    Text is read back as the same tree when sums do not stand directly in sums, nor products in products, and
    numbers are non-negative integers or finite decimals of at most 40 significant digits, not below 1e-200.
    Any other number prints as numerator over denominator and is read back as the ``Quotient`` of two
    integers, of the same value; a negative number is read back as the ``Negative`` of a positive one.
    """
    pieces: list[str] = []
    work: _Work = [(expression, _Position.ALONE)]
    while work:
        item = work.pop()
        if isinstance(item, str):
            pieces.append(item)
            continue
        node, place = item
        parts, bare = _parts(_unsigned(node), place, multiply, power)
        if place not in bare:
            parts = ["(", *parts, ")"]
        work.extend(reversed(parts))
    return "".join(pieces)


def text_length(expression: Expression) -> int:
    """Return how many characters :func:`format_expression` prints; the length of a sum is found once.

    >>> x = Name("x")
    >>> text_length(Product((x, Sum((x, Negative(x))))))
    9
    """
    return _measured(expression, _Position.ALONE)


def _measured(node: Expression, place: _Position) -> int:
    """Return the length of a node's text at a place."""
    if type(node) is Sum:
        return _length_of_sum(node) + (2 if place is not _Position.ALONE else 0)
    parts, bare = _parts(_unsigned(node), place, "*", "^")
    inner = 0 if place in bare else 2
    for part in parts:
        inner += len(part) if isinstance(part, str) else _measured(*part)
    return inner


@once
def _length_of_sum(node: Sum) -> int:
    length = 0
    for part in _sum_parts(node.terms):
        length += len(part) if isinstance(part, str) else _measured(*part)
    return length


def _parts(
    node: Expression, place: _Position, multiply: str, power: str
) -> tuple[_Work, tuple[_Position, ...]]:
    """Return the pieces a node prints as, and the places where they need no parentheses."""
    match node:
        case Number(value=value):
            text = number_text(value)
            return [text], _BARE_PRODUCT if "/" in text else _BARE_LEAF
        case Name(name):
            return [name], _BARE_LEAF
        case Attribute(owner, name):
            return [f"{owner}.{name}"], _BARE_LEAF
        case Derivative(name, order):
            return [name + "'" * order], _BARE_LEAF
        case Call(name=name, argument=argument, order=order):
            return [name + "'" * order + "(", (argument, _Position.ALONE), ")"], _BARE_LEAF
        case Differentiated(operand=operand, order=order, point=point):
            at: _Work = [] if point is None else ["(", (point, _Position.ALONE), ")"]
            return ["(", (operand, _Position.ALONE), ")" + "'" * order, *at], _BARE_LEAF
        case Negative(operand=operand):
            # A sign before a product is the whole product's, a sign inside one its next factor's alone.
            within = _Position.FACTOR if place is _Position.FACTOR else _Position.TERM
            return ["-", (operand, within)], _BARE_NEGATIVE
        case Power(base=Name(name=name), exponent=Number(value=value)) if (
            value.denominator == 1 and value >= 0
        ):
            return [f"{name}{power}{number_text(value)}"], _BARE_POWER
        case Power(base=base, exponent=exponent):
            return [(base, _Position.BASE), power, (exponent, _Position.FACTOR)], _BARE_POWER
        case Quotient(numerator=numerator, denominator=denominator):
            return [(numerator, _Position.LEAD), "/", (denominator, _Position.FACTOR)], _BARE_PRODUCT
        case Product(factors=factors):
            parts: _Work = [(factors[0], _Position.LEAD)]
            for factor in factors[1:]:
                parts += [multiply, factor.name if isinstance(factor, Name) else (factor, _Position.FACTOR)]
            return parts, _BARE_PRODUCT
        case Sum(terms=terms):
            return _sum_parts(terms), _BARE_SUM
        case Equation(left=left, right=right):
            return [(left, _Position.ALONE), " = ", (right, _Position.ALONE)], _BARE_SUM
        case _:
            raise TypeError(f"no text for {type(node).__name__}")


def _sum_parts(terms: tuple[Expression, ...]) -> _Work:
    parts: _Work = [(terms[0], _Position.TERM)]
    for written in terms[1:]:
        term = _unsigned(written)
        sign, size = (" - ", term.operand) if isinstance(term, Negative) else (" + ", term)
        parts += [sign, (size, _Position.TERM)]
    return parts


def _unsigned(node: Expression) -> Expression:
    return Negative(Number(-node.value)) if isinstance(node, Number) and node.value < 0 else node


def number_text(value: Fraction) -> str:
    """Print a non-negative number exactly: an integer, a short decimal, or numerator over denominator.

    >>> from fractions import Fraction
    >>> [number_text(Fraction(text)) for text in ("3", "21/10000", "4.7e-12", "2/3", "5e17")]
    ['3', '0.0021', '4.7e-12', '2/3', '5e17']
    """
    if value.denominator == 1:
        # Decimal writes integers of any length; str(int) stops at the interpreter's digit limit.
        whole = str(Decimal(value.numerator))
        digits = whole.rstrip("0")
        short = f"{digits[:1]}{'.' * (len(digits) > 1)}{digits[1:]}e{len(whole) - 1}"
        is_long = PLAIN < len(whole) <= -SMALLEST_EXPONENT
        return short if is_long and len(short) + FEWER <= len(whole) else whole
    sides = (Fraction(value.numerator), Fraction(value.denominator))
    return _decimal_text(value) or "/".join(map(number_text, sides))


def decimal_exponent(value: Fraction) -> int:
    """Return floor(log10(value)) of a positive rational, exactly."""
    estimate = floor((value.numerator.bit_length() - value.denominator.bit_length()) * log10(2))
    while value >= Fraction(10) ** (estimate + 1):
        estimate += 1
    while value < Fraction(10) ** estimate:
        estimate -= 1
    return estimate


def _decimal_text(value: Fraction) -> str | None:
    """Return the exact decimal of a proper fraction, or ``None`` when it is endless or long."""
    most_places = SHORT_DIGITS - SMALLEST_EXPONENT
    denominator = value.denominator
    twos = (denominator & -denominator).bit_length() - 1
    odd, fives = denominator >> twos, 0
    while fives <= most_places and odd % 5 == 0:
        odd, fives = odd // 5, fives + 1
    places = max(twos, fives)
    if odd != 1 or places > most_places:
        return None
    mantissa = value.numerator * 10**places // denominator
    if mantissa >= 10**SHORT_DIGITS:
        return None
    digits = str(mantissa)
    exponent = len(digits) - 1 - places
    if exponent >= SMALLEST_PLAIN_EXPONENT:
        digits = digits.zfill(places + 1)
        return f"{digits[:-places]}.{digits[-places:]}"
    if exponent < SMALLEST_EXPONENT:
        return None
    point = "." if len(digits) > 1 else ""
    return f"{digits[0]}{point}{digits[1:]}e{exponent}"
