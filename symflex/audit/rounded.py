"""Formulas whose numbers are printed with so many digits, against functions of the model's values.

Input: a printed formula in s and numbers, and a derived one. Output: whether each printed number is right to
its last digit.

    2.792/(s^2 + 0.717*s + 9.985)      of 2.79245/(s^2 + 0.71698*s + 9.98491)

A coefficient is an interval as wide as its last digit. The printed fraction is right if one factor brings
every coefficient of the derived one into its interval. Numbers below 100 without a point are exact. Formulas
in which a number bears upon several coefficients, such as the product of two brackets, are not compared.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from typing import Final, NamedTuple

from symflex.algebra import LAPLACE
from symflex.expressions import Expression, Name, Negative, Number, Power, Product, Quotient, Sum

EXACT_BELOW: Final = 100  # whole numbers such as the 2 of 2*zeta
HIGHEST: Final = 60  # power of s


class _Interval(NamedTuple):
    middle: Fraction
    radius: Fraction


_Polynomial = dict[int, _Interval]  # coefficients by power of s
_ZERO: Final = _Interval(Fraction(0), Fraction(0))


class _NotExpandedError(Exception):
    """A number bears upon several coefficients, or something is no polynomial in s."""


def is_right_to_its_digits(printed: Expression, derived: Expression) -> bool:
    """Tell whether one factor brings all coefficients of a derived fraction into those of a printed one."""
    try:
        above, below = _fraction(printed, last_digit)
        right_above, right_below = _fraction(derived, lambda _: Fraction(0))
    except _NotExpandedError:
        return False
    low, high = None, None
    for shown, right in ((above, right_above), (below, right_below)):
        for power in {*shown, *right}:
            wanted, given = shown.get(power, _ZERO), right.get(power, _ZERO).middle
            if not given:
                if abs(wanted.middle) > wanted.radius:
                    return False
                continue
            ends = sorted(((wanted.middle - wanted.radius) / given, (wanted.middle + wanted.radius) / given))
            low = ends[0] if low is None else max(low, ends[0])
            high = ends[1] if high is None else min(high, ends[1])
    return low is not None and high is not None and low <= high and (low > 0 or high < 0)


def last_digit(node: Number) -> Fraction:
    """Return half a unit of the last digit of a number as it is printed, zero for small whole numbers."""
    typed = "" if node.span is None else re.sub(r"[{}\\,~ ]", "", node.span.text.replace("{,}", "."))
    if re.fullmatch(r"\d*\.\d+", typed):
        return Fraction(1, 2 * 10 ** len(typed.partition(".")[2]))
    if node.value.denominator == 1:
        return Fraction(1, 2) if node.value >= EXACT_BELOW else Fraction(0)
    decimals = next((k for k in range(40) if (node.value * 10**k).denominator == 1), None)
    return Fraction(0) if decimals is None else Fraction(1, 2 * 10**decimals)


def _fraction(node: Expression, radius: Callable[[Number], Fraction]) -> tuple[_Polynomial, _Polynomial]:
    one = {0: _Interval(Fraction(1), Fraction(0))}
    match node:
        case Negative(operand):
            above, below = _fraction(operand, radius)
            return _times(above, {0: _Interval(Fraction(-1), Fraction(0))}), below
        case Quotient(numerator, denominator):
            above, below = _fraction(numerator, radius)
            over, under = _fraction(denominator, radius)
            return _times(above, under), _times(below, over)
        case Product(factors):
            above, below = one, one
            for factor in factors:
                more, under = _fraction(factor, radius)
                above, below = _times(above, more), _times(below, under)
            return above, below
        case Sum(terms):
            parts = [_fraction(term, radius) for term in terms]
            if any(len(below) != 1 or 0 not in below or below[0].radius for _, below in parts):
                raise _NotExpandedError
            total: _Polynomial = {}
            for above, below in parts:
                for power, (middle, width) in above.items():
                    had = total.get(power, _ZERO)
                    divisor = below[0].middle
                    total[power] = _Interval(had.middle + middle / divisor, had.radius + width / abs(divisor))
            return total, one
        case Power(base, Number(value)) if value.denominator == 1 and value <= HIGHEST:
            above, below = _fraction(base, radius)
            whole = one, one
            for _ in range(int(value)):
                whole = _times(whole[0], above), _times(whole[1], below)
            return whole
        case Power(base, Negative(exponent)):
            above, below = _fraction(Power(base, exponent), radius)
            return below, above
        case Number(value):
            return {0: _Interval(value, radius(node))}, one
        case Name(name) if name == LAPLACE:
            return {1: _Interval(Fraction(1), Fraction(0))}, one
    raise _NotExpandedError


def _times(a: _Polynomial, b: _Polynomial) -> _Polynomial:
    """Return a product in which every number still bears upon one coefficient."""
    wide = [any(c.radius for c in p.values()) for p in (a, b)]
    if (wide[0] and (wide[1] or len(b) > 1)) or (wide[1] and len(a) > 1):
        raise _NotExpandedError
    if max(a, default=0) + max(b, default=0) > HIGHEST:
        raise _NotExpandedError
    out: _Polynomial = {}
    for i, x in a.items():
        for j, y in b.items():
            had = out.get(i + j, _ZERO)
            width = x.radius * abs(y.middle) + y.radius * abs(x.middle)
            out[i + j] = _Interval(had.middle + x.middle * y.middle, had.radius + width)
    return out
