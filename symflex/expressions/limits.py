"""How large an expression may be, decided before anything large is computed.

The size of a subtree is bounded from the sizes of its operands alone. A coefficient of a subtree, read as a
quotient of polynomials in its names, is never larger than the value of the same subtree with every name set
to one and every sign to plus; the logarithms of its numerator and denominator are what is tracked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import NamedTuple

# A constant is followed exactly while it is this small: enough for every exponent that is allowed.
FOLLOWED_BITS = 128


@dataclass(frozen=True, slots=True)
class Limits:
    """What a text may contain; beyond any of these it is refused with SF103."""

    characters: int  # length of the text
    parentheses: int  # depth of nested parentheses
    depth: int  # depth of the tree; a name alone has depth 1
    digits: int  # digits of a number, without those of its decimal exponent
    decimal_exponent: int  # magnitude of the exponent after ``e`` in a number
    exponent: int  # magnitude of a constant exponent, and of the product of exponents nested in one another
    bits: int  # bits of any coefficient that a power can reach
    order: int  # primes after the name of a field


USER_LIMITS = Limits(  # limits for texts that people write
    characters=10_000,
    parentheses=64,
    depth=96,
    digits=200,
    decimal_exponent=200,
    exponent=64,
    bits=4_000,
    order=64,
)

PROGRAM_LIMITS = Limits(  # limits for texts that the program itself has written
    characters=10_000_000,
    parentheses=200,
    depth=200,
    digits=100_000,
    decimal_exponent=200,
    exponent=1_000_000,
    bits=1_000_000,
    order=64,
)


class Size(NamedTuple):
    """Bounds on a subtree."""

    depth: int
    exponent: int  # largest product of exponents nested in one another
    # upper and lower: bits of any coefficient of the numerator, of the denominator.
    upper: int
    lower: int
    constant: bool  # whether the subtree contains no name
    value: Fraction | None  # of a small constant; ``None`` when it is large, undefined or not a constant


SIZE_OF_NAME = Size(1, 1, 0, 0, constant=False, value=None)


def size_of_number(value: Fraction) -> Size:
    """Return the size of a non-negative number."""
    return _followed(Size(1, 1, _bits(value.numerator), _bits(value.denominator), constant=True, value=value))


def size_of_call(argument: Size) -> Size:
    """Return the size of a function of ``argument``, which acts as a new name."""
    return SIZE_OF_NAME._replace(depth=argument.depth + 1, exponent=argument.exponent)


def size_of_negative(operand: Size) -> Size:
    """Return the size of minus ``operand``."""
    value = None if operand.value is None else -operand.value
    return operand._replace(depth=operand.depth + 1, value=value)


def size_of_sum(terms: Sequence[Size]) -> Size:
    """Return the size of a sum."""
    lower = sum(term.lower for term in terms)
    upper = max(term.upper - term.lower for term in terms) + lower + _bits(len(terms))
    value: Fraction | None = Fraction(0)
    for term in terms:
        value = None if value is None or term.value is None else _small(value + term.value)
    return _combined(terms, upper, lower, value)


def size_of_product(factors: Sequence[Size]) -> Size:
    """Return the size of a product."""
    upper = sum(factor.upper for factor in factors)
    lower = sum(factor.lower for factor in factors)
    value: Fraction | None = Fraction(1)
    for factor in factors:
        value = None if value is None or factor.value is None else _small(value * factor.value)
    return _combined(factors, upper, lower, value)


def size_of_quotient(numerator: Size, denominator: Size) -> Size:
    """Return the size of a quotient."""
    upper = numerator.upper + denominator.lower
    lower = numerator.lower + denominator.upper
    value = numerator.value / denominator.value if numerator.value is not None and denominator.value else None
    return _combined((numerator, denominator), upper, lower, value)


def size_of_power(base: Size, exponent: Size) -> Size:
    """Return the size of a power that :func:`power_problem` found no fault with."""
    if exponent.value is None:
        nested = base.exponent * exponent.exponent
        return _combined((base, exponent), base.upper, base.lower, None)._replace(exponent=nested)
    times = ceil(abs(exponent.value))
    upper, lower = base.upper * times, base.lower * times
    value = None
    if exponent.value < 0:
        upper, lower = lower, upper
    if base.value is not None and exponent.value.denominator == 1 and max(upper, lower) <= FOLLOWED_BITS:
        value = base.value**exponent.value.numerator if base.value or exponent.value >= 0 else None
    nested = base.exponent * max(1, times)
    return _combined((base, exponent), upper, lower, value)._replace(exponent=nested)


def exponent_problem(exponent: Size, limits: Limits) -> str | None:
    """Return what is wrong with an exponent, or ``None``."""
    if not exponent.constant or (exponent.value is not None and abs(exponent.value) <= limits.exponent):
        return None
    return f"this exponent is not a number between -{limits.exponent} and {limits.exponent}"


def power_problem(base: Size, exponent: Size, limits: Limits) -> str | None:
    """Return what is wrong with a power whose exponent is allowed by itself, or ``None``."""
    size = size_of_power(base, exponent)
    if size.exponent > limits.exponent:
        return f"nested exponents multiply to {size.exponent}; at most {limits.exponent} is allowed"
    bits = max(size.upper, size.lower)
    if bits > limits.bits:
        return f"this power has numbers of up to {bits} bits; at most {limits.bits} are allowed"
    return None


def _combined(parts: Sequence[Size], upper: int, lower: int, value: Fraction | None) -> Size:
    depth, exponent = 1 + max(part.depth for part in parts), max(part.exponent for part in parts)
    return _followed(Size(depth, exponent, upper, lower, all(part.constant for part in parts), value))


def _followed(size: Size) -> Size:
    return size if size.value is None or _small(size.value) is not None else size._replace(value=None)


def _small(value: Fraction) -> Fraction | None:
    return value if max(_bits(abs(value.numerator)), _bits(value.denominator)) <= FOLLOWED_BITS else None


def _bits(magnitude: int) -> int:
    """Return the least b with ``magnitude <= 2**b``."""
    return (magnitude - 1).bit_length() if magnitude > 1 else 0
