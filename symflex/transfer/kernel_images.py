"""Proving that two polynomials share no factor with a kernel in it, from their images in one kernel's angle.

Input: polynomials in kernels, in normal form.
Output: a proof, or none; without one, greatest common divisors have to be sought in exponentials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from flint import nmod_poly

from symflex.algebra import PRIME, PolynomialMemo, random_point

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Ring
    from symflex.algebra.exponentials import KernelPair

Image = nmod_poly | None
"""A polynomial in an angle's exponential, or half-angle tangent; ``None`` when its degree is too low."""


@dataclass
class KernelImages:
    """Images of polynomials with everything but one angle set to a residue, each made once.

    With ``cosh = (E + 1/E)/2`` or ``tan`` of half the angle, a polynomial of degree d in an angle's kernels
    is one of degree 2d in a single variable. A common factor with that angle in it divides both images, and
    its degree does not drop unless theirs do. So images that are coprime and of full degree prove that there
    is none.
    """

    ring: Ring  # where the polynomials live
    angles: Sequence[KernelPair]  # the kernels: hyperbolic and circular functions, in pairs

    def prove_apart(self, f: fmpz_mpoly, g: fmpz_mpoly) -> bool:
        """Tell whether two polynomials are proved to share no factor with a kernel; False decides nothing."""
        pairs = zip(self._images(f), self._images(g), strict=True)
        return all(a is not None and b is not None and a.gcd(b).degree() <= 0 for a, b in pairs)

    @cached_property
    def _point(self) -> Mapping[int, int]:
        """A residue per generator that is true to the relations of the kernels."""
        point = dict(enumerate(random_point(self.ring.names).values()))
        for angle in self.angles:
            x = point[self.ring.index[angle.even.generator]]
            even, odd = self.ring.index[angle.even.generator], self.ring.index[angle.odd.generator]
            if angle.kind == "hyperbolic":
                below = pow(2 * x, -1, PRIME)
                point[even], point[odd] = (x * x + 1) * below % PRIME, (x * x - 1) * below % PRIME
            else:
                below = pow(1 + x * x, -1, PRIME)
                point[even], point[odd] = (1 - x * x) * below % PRIME, 2 * x * below % PRIME
        return point

    @cached_property
    def _images(self) -> PolynomialMemo[list[Image]]:
        return PolynomialMemo(self._made)

    def _made(self, f: fmpz_mpoly) -> list[Image]:
        point = self._point
        powers: dict[tuple[int, int], int] = {}
        pairs = [(self.ring.index[a.even.generator], self.ring.index[a.odd.generator]) for a in self.angles]
        coefficients: list[dict[tuple[int, int], int]] = [{} for _ in self.angles]
        for monomial, number in f.terms():
            exponents = [int(e) for e in monomial]
            value = int(number) % PRIME
            for i, exponent in enumerate(exponents):
                if exponent:
                    if (i, exponent) not in powers:
                        powers[i, exponent] = pow(point[i], exponent, PRIME)
                        powers[i, -exponent] = pow(point[i], -exponent, PRIME)
                    value = value * powers[i, exponent] % PRIME
            for own, (even, odd) in zip(coefficients, pairs, strict=True):
                key = (exponents[even], exponents[odd])
                rest = value
                for i, exponent in zip((even, odd), key, strict=True):
                    if exponent:
                        rest = rest * powers[i, -exponent] % PRIME
                own[key] = own.get(key, 0) + rest
        return [
            _image(own, angle.kind == "circular")
            for own, angle in zip(coefficients, self.angles, strict=True)
        ]


def _image(coefficients: Mapping[tuple[int, int], int], is_circular: bool) -> Image:
    """Return a polynomial in an angle's kernels in one variable, if its degree is twice theirs."""
    degree = max(i + j for i, j in coefficients)
    if is_circular:
        even, odd, one = [1, 0, PRIME - 1], [0, 2, 0], [1, 0, 1]
    else:
        even, odd, one = [1, 0, 1], [PRIME - 1, 0, 1], [0, 2, 0]
    c, s, unit = (nmod_poly(x, PRIME) for x in (even, odd, one))
    total = nmod_poly([0], PRIME)
    for (i, j), number in coefficients.items():
        total += c**i * s**j * unit ** (degree - i - j) * (number % PRIME)
    is_full = total.degree() == 2 * degree and (is_circular or int(total[0]) != 0)
    return total if is_full else None
