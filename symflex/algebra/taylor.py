"""Taylor series of kernels over a prime field, where only what is zero vanishes, almost surely.

Wavenumbers are square and fourth roots of quantities of either sign, which exist in some fields and not in
others: the primes are one more than a multiple of eight, and there are several of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from random import Random
from typing import TYPE_CHECKING

from flint import fmpz, nmod_poly
from flint.utils.flint_exceptions import DomainError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra.factored import Factored


def primes() -> Iterator[int]:
    """Yield the sizes of fields that are tried, the same ones every time."""
    prime = 2**61 + 1 - STEP
    for _ in range(FIELDS):
        prime = _next_prime(prime)
        yield prime


@cache
def _next_prime(prime: int) -> int:
    candidate = prime + STEP
    while not fmpz(candidate).is_prime():
        candidate += STEP
    return candidate


FIELDS = 400
STEP = 8
FIRST_PRIME = next(primes())
BASE = 3
"""Powers of it stand for exponentials."""


@dataclass(frozen=True, slots=True)
class TaylorField:
    """Series to a fixed number of terms."""

    terms: int  # number of coefficients kept
    prime: int = FIRST_PRIME  # the field's size

    def constant(self, value: int) -> nmod_poly:
        """Return a number as a series."""
        return nmod_poly([value % self.prime], self.prime)

    def power(self, exponent: int, start: int = 0) -> nmod_poly:
        """Return ``start + x^exponent``."""
        return nmod_poly([start, *[0] * (exponent - 1), 1] if exponent else [start + 1], self.prime)

    def order(self, series: nmod_poly) -> int | None:
        """Return the order of the first term, ``None`` when there is none."""
        return next((i for i, c in enumerate(series.coeffs()) if int(c)), None)

    def times(self, left: nmod_poly, right: nmod_poly) -> nmod_poly:
        """Return a product."""
        return left.mul_low(right, self.terms)

    def inverse(self, series: nmod_poly) -> nmod_poly | None:
        """Return the reciprocal, ``None`` when the series starts with zero."""
        return series.inverse_series_trunc(self.terms) if int(series[0]) else None

    def root(self, series: nmod_poly) -> nmod_poly | None:
        """Return a square root, ``None`` when the valuation is odd or the leading coefficient no square."""
        first = self.order(series)
        if first is None or first % 2:
            return None
        lead = square_root(int(series[first]), self.prime)
        if lead is None:
            return None
        square, root = series.right_shift(first), self.constant(lead)
        half, known = pow(2, -1, self.prime), 1
        while known < self.terms - first:
            known = min(2 * known, self.terms - first)
            # Newton's iteration doubles the number of terms.
            root = (root + square.mul_low(root.inverse_series_trunc(known), known)) * half
        return root.left_shift(first // 2).truncate(self.terms)

    def even_odd(self, argument: nmod_poly, start: int, *, circular: bool) -> tuple[nmod_poly, nmod_poly]:
        """Return cosh and sinh, or cos and sin, of an argument.

        A constant term of the argument is a transcendental angle: ``start`` stands for its exponential, or
        for the tangent of its half.
        """
        constant = int(argument[0])
        moving = argument - self.constant(constant)
        sign = self.prime - 1 if circular else 1
        square = self.times(moving, moving) * sign
        even, odd = self.constant(1), moving
        term_even, term_odd = self.constant(1), moving
        below = _reciprocals(self.terms + 2, self.prime)
        for n in range(1, self.terms // 2 + 1):
            term_even = self.times(term_even, square) * (below[2 * n] * below[2 * n - 1] % self.prime)
            term_odd = self.times(term_odd, square) * (below[2 * n] * below[2 * n + 1] % self.prime)
            if term_even.is_zero() and term_odd.is_zero():
                break
            even, odd = even + term_even, odd + term_odd
        if not constant:
            return even, odd
        if circular:
            share = pow(1 + start * start, -1, self.prime)
            c, s = (1 - start * start) * share % self.prime, 2 * start * share % self.prime
        else:
            half, back = pow(2, -1, self.prime), pow(start, -1, self.prime)
            c, s = (start + back) * half % self.prime, (start - back) * half % self.prime
        return even * c + odd * (s * sign % self.prime), even * s + odd * c

    def polynomial(
        self, polynomial: fmpz_mpoly, names: Sequence[str], values: Mapping[str, nmod_poly]
    ) -> nmod_poly:
        """Return a polynomial with series in place of its generators."""
        total = self.constant(0)
        powers: dict[tuple[int, int], nmod_poly] = {}
        for monomial, coefficient in polynomial.terms():
            product = self.constant(int(coefficient))
            for i, exponent in enumerate(monomial):
                if exponent:
                    key = (i, int(exponent))
                    if key not in powers:
                        powers[key] = values[names[i]].pow_trunc(int(exponent), self.terms)
                    product = self.times(product, powers[key])
            total = total + product
        return total

    def rational(
        self, value: Factored, names: Sequence[str], values: Mapping[str, nmod_poly]
    ) -> nmod_poly | None:
        """Return a rational function, ``None`` when a denominator starts with zero."""
        unit = value.unit.numerator * pow(value.unit.denominator, -1, self.prime)
        total = self.constant(unit)
        for factor, exponent in value.factors:
            series: nmod_poly | None = self.polynomial(factor, names, values)
            if exponent < 0 and series is not None:
                series = self.inverse(series)
            if series is None:
                return None
            total = self.times(total, series.pow_trunc(abs(exponent), self.terms))
        return total


@cache
def _reciprocals(count: int, prime: int) -> tuple[int, ...]:
    """Return 0 and the reciprocals of the numbers below ``count`` modulo a larger prime."""
    found = [0, 1]
    for n in range(2, count):
        found.append(-(prime // n) * found[prime % n] % prime)
    return tuple(found)


def square_root(value: int, prime: int) -> int | None:
    """Return a square root modulo a prime, ``None`` when there is none.

    Examples
    --------
    >>> square_root(2, 17), square_root(3, 17)
    (6, None)
    """
    try:
        return int(fmpz(value).sqrtmod(prime))
    except DomainError:
        return None


def random_values(names: Sequence[str], random: Random, field: TaylorField) -> dict[str, nmod_poly]:
    """Return a random number per name."""
    return {name: field.constant(random.randrange(1, field.prime)) for name in names}
