"""Products of sums as numerator and denominator, each sum in the arrangement that prints shortest."""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate
from math import isqrt
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.algebra.ring import by_powers
from symflex.expressions import (
    Call,
    Expression,
    Negative,
    Sum,
    format_expression,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from flint import fmpz_mpoly

    from symflex.print.forms.arrange import Arranger

SMALL = 400
"""Number of terms up to which every arrangement of a sum is tried."""
READABLE = 4
"""Depth of parentheses that reads easily."""

Sides = tuple[Expression, Expression]


class ProductPrinter:
    """Prints products over one ring; a sum met again is not arranged again.

    With the generator of the imaginary unit given, sums are split into real and imaginary part.
    """

    def __init__(self, arranger: Arranger, imaginary: str = "") -> None:
        self.arranger = arranger
        self._imaginary = arranger.ring.index[imaginary] if imaginary else None
        self._apart = tuple(arranger.ring.index[name] for name in arranger.apart)
        self._sums: dict[str, Expression] = {}

    def sides(self, value: Factored) -> Sides:
        """Return numerator and denominator, the sign in the numerator."""
        unit = value.unit
        powers = [0] * len(value.ring.names)
        sums: list[tuple[Expression, int]] = []
        for factor, exponent in value.factors:
            if len(factor) == 1:
                powers[next(i for i, d in enumerate(factor.degrees()) if int(d))] += exponent
                continue
            printed = self.sum(factor)
            if isinstance(printed, Negative):
                printed, unit = printed.operand, unit * (-1) ** abs(exponent)
            sums.append((printed, exponent))
        above = self.arranger.monomial([max(e, 0) for e in powers])
        below = self.arranger.monomial([max(-e, 0) for e in powers])
        return (
            product_of([number(unit.numerator), above, *(power(x, e) for x, e in sums if e > 0)]),
            product_of([number(unit.denominator), below, *(power(x, -e) for x, e in sums if e < 0)]),
        )

    def quotient(self, value: Factored) -> Expression:
        """Return the product as one expression."""
        return quotient(*self.sides(value))

    def square_root(self, value: Factored) -> Expression:
        """Return one square root of a product, with what is a square outside the sign of the root."""
        outside, inside = value**0, value**0
        for factor, exponent in value.factors:
            half = int(exponent / 2)
            outside = outside * Factored(value.ring, Fraction(1), ((factor, half),) if half else ())
            if exponent % 2:
                inside = inside * Factored(value.ring, Fraction(1), ((factor, exponent - 2 * half),))
        for part, sign in ((abs(value.unit.numerator), 1), (value.unit.denominator, -1)):
            root = isqrt(part)
            exact = root * root == part
            outside = outside * Fraction(root if exact else 1) ** sign
            inside = inside * Fraction(1 if exact else part) ** sign
        if value.unit < 0:
            inside = -inside
        if inside.is_one:
            return self.quotient(outside)
        above, below = self.sides(outside)
        return quotient(product_of([above, Call("sqrt", self.quotient(inside))]), below)

    def sum(self, polynomial: fmpz_mpoly) -> Expression:
        """Return a sum in its shortest arrangement; a minus sign that all of it bears stands in front."""
        polynomial = self.arranger.closed(polynomial)
        key = str(polynomial)
        if key not in self._sums:
            self._sums[key] = self._arranged(polynomial)
        return self._sums[key]

    def _arranged(self, polynomial: fmpz_mpoly) -> Expression:
        degrees = polynomial.degrees()
        if self._imaginary is not None and int(degrees[self._imaginary]):
            parts = by_powers(self.arranger.ring, polynomial, self._imaginary)
            j = self.arranger.monomial([int(i == self._imaginary) for i in range(len(degrees))])
            return sum_of([self.sum(parts[0]), product_of([j, self.sum(parts[1])])])
        if not any(int(degrees[i]) for i in self._apart):
            return self.arranger.grouped_by_s(polynomial)
        tried = [self.arranger.separated(polynomial, by_functions=True)]
        if len(polynomial) <= SMALL:
            nested = self.arranger.grouped(polynomial)
            tried = [nested, *tried, self.arranger.separated(polynomial, by_functions=False)]
        found = min(tried, key=_cost)
        if isinstance(found, Sum) and isinstance(found.terms[0], Negative):
            terms = [t.operand if isinstance(t, Negative) else Negative(t) for t in found.terms]
            found = Negative(Sum(tuple(terms)))
        return found


def _cost(expression: Expression) -> int:
    """Return the length of a text, and more for parentheses too deep to read."""
    text = format_expression(expression)
    deepest = max(accumulate({"(": 1, ")": -1}.get(c, 0) for c in text), default=0)
    return len(text) * (READABLE + max(0, deepest - READABLE)) // READABLE


def length(sides: Iterable[Expression]) -> int:
    """Return how many characters expressions take."""
    return sum(len(format_expression(e)) for e in sides)


def shortest_sides(printer: ProductPrinter, value: Factored, laws: Mapping[str, Factored]) -> Sides:
    """Return the sides of a product, powers of wavenumbers traded for s and parameters if that is shorter.

    ``laws`` give, for a wavenumber, a product of its power with s and parameters that is one.
    """
    tried = [value]
    for name, one in laws.items():
        if value.depends_on(name):
            tried = [v * one**t for v in tried for t in (0, -1, 1)]
    return min((printer.sides(v) for v in tried), key=length)
