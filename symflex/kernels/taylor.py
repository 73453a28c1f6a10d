"""Taylor series of kernels over a prime field, where only what is zero vanishes, almost surely.

Wavenumbers are square and fourth roots of quantities of either sign, which exist in some fields and not in
others: the primes are one more than a multiple of eight, and there are several of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from flint import fmpz, nmod_poly

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.kernels.factored import Factored


def primes() -> Iterator[int]:
    """Yield the sizes of fields that are tried, the same ones every time."""
    candidate = 2**61 + 1
    for _ in range(FIELDS):
        while not fmpz(candidate).is_prime():
            candidate += 8
        yield candidate
        candidate += 8


FIELDS = 400
FIRST_PRIME = next(primes())
BASE = 3
"""Powers of it stand for exponentials."""


@dataclass(frozen=True, slots=True)
class TaylorField:
    """Series to a fixed number of terms.

    Parameters
    ----------
    terms : int
        Number of coefficients kept.
    prime : int
        The field's size.
    """

    terms: int
    prime: int = FIRST_PRIME

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
        coefficients = series.coeffs()
        lead = square_root(int(coefficients[first]), self.prime)
        if lead is None:
            return None
        found = [lead]
        below = pow(2 * lead, -1, self.prime)
        for n in range(1, self.terms - first):
            here = int(coefficients[first + n]) if first + n < len(coefficients) else 0
            known = sum(found[k] * found[n - k] for k in range(1, n))
            found.append((here - known) * below % self.prime)
        return nmod_poly([0] * (first // 2) + found, self.prime).truncate(self.terms)

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
        for n in range(1, self.terms // 2 + 1):
            term_even = self.times(term_even, square) * pow(2 * n * (2 * n - 1), -1, self.prime)
            term_odd = self.times(term_odd, square) * pow(2 * n * (2 * n + 1), -1, self.prime)
            if not any(int(c) for c in term_even.coeffs()) and not any(int(c) for c in term_odd.coeffs()):
                break
            even, odd = even + term_even, odd + term_odd
        if not constant:
            return even, odd
        if circular:
            below = pow(1 + start * start, -1, self.prime)
            c, s = (1 - start * start) * below % self.prime, 2 * start * below % self.prime
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


def square_root(value: int, prime: int) -> int | None:
    """Return a square root modulo a prime (Tonelli 1891), ``None`` when there is none.

    Examples
    --------
    >>> square_root(2, 17), square_root(3, 17)
    (6, None)
    """
    half = (prime - 1) // 2
    if pow(value, half, prime) != 1:
        return None
    twos = ((prime - 1) & -(prime - 1)).bit_length() - 1
    odd = (prime - 1) >> twos
    other = next(n for n in range(2, prime) if pow(n, half, prime) != 1)
    z, r, t = pow(other, odd, prime), pow(value, (odd + 1) // 2, prime), pow(value, odd, prime)
    while t != 1:
        i, square = 0, t
        while square != 1:
            square, i = square * square % prime, i + 1
        b = pow(z, 1 << (twos - i - 1), prime)
        twos, z, r = i, b * b % prime, r * b % prime
        t = t * z % prime
    return r


def random_values(names: Sequence[str], random: Random, field: TaylorField) -> dict[str, nmod_poly]:
    """Return a random number per name."""
    return {name: field.constant(random.randrange(1, field.prime)) for name in names}
