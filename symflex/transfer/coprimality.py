"""Proving large polynomials coprime from their images on a line, without a multivariate gcd."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, PolynomialMemo, Ring, degree_in

if TYPE_CHECKING:
    from flint import fmpz_mpoly

LARGE = 40
"""Number of terms of the larger polynomial from which the proof is tried first."""
LINE = Ring((LAPLACE,))


@dataclass
class Images:
    """The images of polynomials with every generator but s set to an integer, each made once.

    Parameters
    ----------
    ring : Ring
        Where the polynomials live; s is its first generator.
    """

    ring: Ring

    def prove_coprime(self, f: fmpz_mpoly, g: fmpz_mpoly) -> bool:
        """Tell whether two factors are proved coprime; False decides nothing.

        A generator and a polynomial without monomial factor are coprime. Otherwise: a common factor that
        contains s would survive setting all other generators to integers, as long as neither degree in s
        drops; a common factor without s divides every coefficient of both, also their leading ones. Neither
        exists when the images are coprime and so are the leading coefficients.
        """
        if len(f) == 1 or len(g) == 1:
            return f != g
        if max(len(f), len(g)) < LARGE or not degree_in(f, 0) or not degree_in(g, 0):
            return False
        leading_f, image_f = self._image(f)
        leading_g, image_g = self._image(g)
        if image_f is None or image_g is None or not leading_f.gcd(leading_g).is_constant():
            return False
        return bool(image_f.gcd(image_g).is_constant())

    @cached_property
    def _point(self) -> tuple[fmpz_mpoly, ...]:
        random = Random(1)
        numbers = [LINE.constant(random.randrange(2**20, 2**21)) for _ in self.ring.names[1:]]
        return (LINE.generator(LAPLACE), *numbers)

    @cached_property
    def _image(self) -> PolynomialMemo[tuple[fmpz_mpoly, fmpz_mpoly | None]]:
        return PolynomialMemo(self._made)

    def _made(self, f: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly | None]:
        """Return the leading coefficient in s, and the image unless its degree drops."""
        image = f.compose(*self._point, ctx=LINE.context)
        kept = degree_in(image, 0) == degree_in(f, 0)
        return _leading_coefficient(self.ring, f), image if kept else None


def _leading_coefficient(ring: Ring, f: fmpz_mpoly) -> fmpz_mpoly:
    """Return the coefficient of the highest power of s, a polynomial in the other generators."""
    highest = degree_in(f, 0)
    terms = {}
    # Terms stand in lexicographic order, s first: the wanted ones lead.
    for i in range(len(f)):
        monomial = f.monomial(i)
        if monomial[0] != highest:
            break
        terms[(0, *monomial[1:])] = f.coefficient(i)
    return ring.context.from_dict(terms)
