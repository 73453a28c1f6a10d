"""Exact values of expressions and of small linear systems, computed with nothing but fractions."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from random import Random
from typing import TYPE_CHECKING

from symflex.algebra.ring import terms_of
from symflex.errors import Source, Span, Text
from symflex.expressions import (
    PROGRAM_LIMITS,
    Call,
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
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored


def read(text: str) -> Expression:
    """Parse what the program printed."""
    return parse(Text(text, Span(Source("<printed>", text), 0, len(text))), limits=PROGRAM_LIMITS)


class Point:
    """A random whole number for every name, and for every function of constants by its text."""

    def __init__(self, seed, **values):
        self._random = Random(seed)
        self.values = {name: Fraction(value) for name, value in values.items()}

    def __getitem__(self, name: str) -> Fraction:
        """Return the value of a name, drawn when it is first asked for."""
        if name not in self.values:
            self.values[name] = Fraction(self._random.randrange(2, 1000))
        return self.values[name]


def value_of(expression: Expression, point: Point) -> Fraction:
    """Return the exact value of an expression, a function of constants being one more unknown number."""
    match expression:
        case Number(value):
            return value
        case Name(name):
            return point[name]
        case Call():
            return point[format_expression(expression)]
        case Negative(operand):
            return -value_of(operand, point)
        case Sum(terms):
            return sum((value_of(t, point) for t in terms), Fraction(0))
        case Product(factors):
            result = Fraction(1)
            for factor in factors:
                result *= value_of(factor, point)
            return result
        case Quotient(numerator, denominator):
            return value_of(numerator, point) / value_of(denominator, point)
        case Power(base, exponent):
            power = value_of(exponent, point)
            assert power.denominator == 1
            return value_of(base, point) ** int(power)
    raise TypeError(type(expression).__name__)


def value_in_ring(factored: Factored, values: Mapping[str, Fraction]) -> Fraction:
    """Return what a product of powers of polynomials is where every name of their ring has its value."""
    names = factored.ring.names
    found = Fraction(factored.unit)
    for polynomial, exponent in factored.factors:
        terms = (c * prod(values[names[i]] ** e for i, e in powers) for powers, c in terms_of(polynomial))
        found *= Fraction(sum(terms)) ** exponent
    return found


def solve(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Return x of ``matrix x = right`` by elimination with exact fractions."""
    size = len(matrix)
    rows = [[Fraction(v) for v in row] + [Fraction(r)] for row, r in zip(matrix, right, strict=True)]
    for i in range(size):
        pivot = next(k for k in range(i, size) if rows[k][i])
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(size):
            if k != i and rows[k][i]:
                factor = rows[k][i] / rows[i][i]
                rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i], strict=True)]
    return [rows[i][size] / rows[i][i] for i in range(size)]
