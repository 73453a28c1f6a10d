"""Values in balls and in power series of balls, of polynomials above all.

Input: numbers that enclose what is meant, real or complex, or power series in the displacement from a point.
Output: numbers that enclose the result, rounding included. Example: ``raised(arb(2, 0.1), -1)`` contains 1/x
for every x between 1.9 and 2.1. Theorem: an expression's value at a point of its inputs lies in its value at
the inputs (Moore 1966; Johansson 2017, IEEE Trans. Comput. 66, 1281, for balls).

Polynomials are prepared for evaluation: products shared by successive terms are made once.
"""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from flint import acb, acb_series, arb, fmpq, fmpz_mpoly, fmpz_mpoly_ctx

from symflex.balls.precision import precision, series_terms

Value = acb | acb_series  # a number, or a power series in the displacement from one
Arithmetic = Any  # a ball or a power series, real or complex. Their arithmetic is one.


Numeral = TypeVar("Numeral", Fraction, arb, float)


def _loaded(centre: tuple[int, int], radius: tuple[int, int]) -> arb:
    """Return a ball of another process, no smaller: flint rounds its radius up."""
    return arb(arb(centre), arb(radius))


def _stored(x: arb) -> tuple[Callable[..., arb], tuple[object, ...]]:
    if not x.is_finite():
        return arb, (x.str(),)
    parts = (part.man_exp() for part in (x.mid(), x.rad()))
    return _loaded, tuple((int(mantissa), int(exponent)) for mantissa, exponent in parts)


# flint pickles none of these, and what is found is made of them.
copyreg.pickle(arb, _stored)
copyreg.pickle(acb, lambda z: (acb, (z.real, z.imag)))
copyreg.pickle(fmpz_mpoly_ctx, lambda ring: (fmpz_mpoly_ctx.get, (ring.names(), ring.ordering().name)))
copyreg.pickle(fmpz_mpoly, lambda p: (p.context().from_dict, (p.to_dict(),)))


def ball(value: Fraction) -> arb:
    """Return a rational number as a ball at the current precision."""
    return arb(fmpq(value.numerator, value.denominator))


def opposite(x: arb) -> arb:
    """Return -x with all digits of x: a minus sign rounds to the precision that is set."""
    with precision(max(x.bits(), 2)):
        return -x


def expansion(s: acb) -> acb_series:
    """Return ``s + x`` to first order in x."""
    return acb_series([s, acb(1)], 2)


def at_centre(value: Value) -> acb:
    """Return the first coefficient of a series; a number is its own."""
    return value[0] if isinstance(value, acb_series) else value


def value_at(
    polynomial: fmpz_mpoly, values: Callable[[int], Numeral], number: Callable[[int], Numeral]
) -> Numeral:
    """Return a polynomial's value, term by term; ``values`` gives that of the generator at a position."""
    total = number(0)
    for monomial, coefficient in polynomial.terms():
        term = number(int(coefficient))
        for i, exponent in enumerate(monomial):
            if exponent:
                term = term * values(i) ** int(exponent)
        total = total + term
    return total


def raised(base: Arithmetic, exponent: int) -> Arithmetic:
    """Return an integer power of a ball or a series, not finite where it divides by zero.

    >>> raised(acb_series([2, 1], 2), -1), raised(acb_series([0, 1], 2), -1)[0].is_finite()
    (0.500000000000000 + (-0.250000000000000)*x + O(x^2), False)
    """
    if isinstance(base, acb | arb):
        return base**exponent
    power: Arithmetic = base**0 if exponent == 0 else base
    for _ in range(abs(exponent) - 1):
        power = power * base
    if exponent < 0:
        # Balls are not finite then by themselves; series of them raise an error.
        return power * arb("nan") if power[0].contains(0) else 1 / power
    return power


def binary_exponent(value: acb) -> int | None:
    """Return about the binary logarithm of a ball's size, None for zero and what is not finite.

    >>> binary_exponent(acb(5)), binary_exponent(acb(0))
    (3, None)
    """
    size = value.abs_upper()
    if size == 0 or not size.is_finite():
        return None
    mantissa, exponent = size.man_exp()
    return int(mantissa).bit_length() + int(exponent)


def balancing(sizes: Sequence[Mapping[int, int]], columns: int, passes: int) -> tuple[list[int], list[int]]:
    """Return exponents of two for rows and columns that bring their largest entries near one.

    ``sizes`` are the binary exponents of what is not zero, row by row and by column; units make them differ.

    >>> balancing([{0: 10, 1: 0}, {0: 10, 1: 4}], 2, 2)
    ([-10, -10], [0, 6])
    """
    left, right = [0] * len(sizes), [0] * columns
    for _ in range(passes):
        for i, row in enumerate(sizes):
            left[i] = -max((e + right[j] for j, e in row.items()), default=0)
        largest: list[int | None] = [None] * columns
        for i, row in enumerate(sizes):
            for j, e in row.items():
                exponent = largest[j]
                largest[j] = e + left[i] if exponent is None else max(exponent, e + left[i])
        right = [0 if e is None else -e for e in largest]
    return left, right


def series_quotient(above: Sequence[acb], below: Sequence[acb], count: int) -> list[acb]:
    """Return the first coefficients of a quotient of power series; the divisor's first is not zero.

    >>> [complex(c) for c in series_quotient([acb(1)], [acb(1), acb(-2)], 3)]
    [(1+0j), (2+0j), (4+0j)]
    """
    with series_terms(count):
        quotient = acb_series(above, count) / acb_series(below, count)
    return [quotient[i] for i in range(count)]


Step = tuple[int, tuple[int, ...], int]  # factors of the last product kept, powers that follow, the integer


@dataclass(frozen=True, slots=True)
class EvaluationPlan:
    """How to evaluate one polynomial."""

    powers: tuple[tuple[int, int], ...]  # positions of generators, and exponents, that occur
    steps: tuple[Step, ...]  # one per term

    def value(self, powers: Sequence[Value]) -> Value:
        """Return the polynomial's value from those of the powers."""
        products: list[Value] = [acb(1)]
        total: Value = acb(0)
        for kept, following, coefficient in self.steps:
            del products[kept + 1 :]
            product = products[-1]
            for i in following:
                product = product * powers[i]
                products.append(product)
            total = total + product * coefficient
        return total


def plan(polynomial: fmpz_mpoly) -> EvaluationPlan:
    """Return how to evaluate a polynomial."""
    numbers: dict[tuple[int, int], int] = {}
    steps: list[Step] = []
    last: tuple[int, ...] = ()
    for monomial, coefficient in polynomial.terms():
        factors = ((i, int(e)) for i, e in enumerate(monomial) if e)
        powers = tuple(numbers.setdefault(power, len(numbers)) for power in factors)
        kept = 0
        while kept < min(len(last), len(powers)) and last[kept] == powers[kept]:
            kept += 1
        steps.append((kept, powers[kept:], int(coefficient)))
        last = powers
    return EvaluationPlan(tuple(numbers), tuple(steps))
