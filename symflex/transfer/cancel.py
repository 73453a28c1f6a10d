"""Exact cancellation of common factors."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING

from symflex.kernels import LAPLACE, Factored, Ring, degree_in

if TYPE_CHECKING:
    from flint import fmpz_mpoly

LARGE = 40
"""Number of terms from which a proof of coprimality at a point is tried before a multivariate gcd."""


def cancel(numerator: Factored, denominator: Factored) -> tuple[Factored, Factored]:
    """Return numerator/denominator in lowest terms, and the common factor that was found.

    Both may be rational; equal factors cancel at once, the others pairwise by exact greatest common divisors.
    """
    ring = numerator.ring
    quotient = numerator / denominator
    if quotient.is_zero:
        return quotient, Factored.number(ring, 1)
    shared = Factored.number(ring, 1)
    for factor, exponent in numerator.factors:
        other = next((e for f, e in denominator.factors if f == factor), 0)
        if exponent > 0 and other > 0:
            shared = shared * Factored(ring, Fraction(1), ((factor, min(exponent, other)),))
    above = [(f, e) for f, e in quotient.factors if e > 0]
    below = [(f, -e) for f, e in quotient.factors if e < 0]
    i, changed = 0, False
    while i < len(above):
        j = 0
        while j < len(below):
            f, m = above[i]
            g, n = below[j]
            common = ring.constant(1) if coprime_by_image(ring, f, g) else f.gcd(g)
            if common.is_constant():
                j += 1
                continue
            power = min(m, n)
            piece = Factored.polynomial(ring, common)
            shared, changed = shared * piece**power, True
            above[i : i + 1] = _pieces(f, common, m, power)
            below[j : j + 1] = _pieces(g, common, n, power)
            if i >= len(above):
                break
            j = 0
        i += 1
    if not changed:
        return quotient, shared
    result = Factored.number(ring, quotient.unit)
    for f, e in above:
        result = result * Factored.polynomial(ring, f) ** e
    for f, e in below:
        result = result / Factored.polynomial(ring, f) ** e
    return result, shared


def _pieces(
    factor: fmpz_mpoly, common: fmpz_mpoly, exponent: int, power: int
) -> list[tuple[fmpz_mpoly, int]]:
    """Return ``factor**exponent / common**power`` as factors with positive exponents."""
    rest = factor / common
    pieces = [(rest, exponent), (common, exponent - power)]
    return [(f, e) for f, e in pieces if e > 0 and not f.is_constant()]


def coprime_by_image(ring: Ring, f: fmpz_mpoly, g: fmpz_mpoly) -> bool:
    """Tell whether two large polynomials are proved coprime cheaply; False decides nothing.

    A common factor that contains s would survive setting all other generators to integers, as long as
    neither degree in s drops; a common factor without s divides every coefficient of both, also their
    leading ones. Neither exists when the images are coprime and so are the leading coefficients.
    """
    if min(len(f), len(g)) < LARGE:
        return False
    s = ring.index[LAPLACE]
    if not degree_in(f, s) or not degree_in(g, s):
        return False
    if not _leading_coefficient(ring, f).gcd(_leading_coefficient(ring, g)).is_constant():
        return False
    random = Random(1)
    line = Ring((LAPLACE,))
    point = [line.constant(random.randrange(2**20, 2**21)) for _ in ring.names]
    point[s] = line.generator(LAPLACE)
    image_f, image_g = (h.compose(*point, ctx=line.context) for h in (f, g))
    if degree_in(image_f, 0) != degree_in(f, s) or degree_in(image_g, 0) != degree_in(g, s):
        return False
    return bool(image_f.gcd(image_g).is_constant())


def _leading_coefficient(ring: Ring, f: fmpz_mpoly) -> fmpz_mpoly:
    """Return the coefficient of the highest power of s, a polynomial in the other generators."""
    s = ring.index[LAPLACE]
    highest = degree_in(f, s)
    terms = {}
    # Terms stand in lexicographic order, s first: the wanted ones lead.
    for i in range(len(f)):
        monomial = f.monomial(i)
        if monomial[s] != highest:
            break
        terms[(*monomial[:s], 0, *monomial[s + 1 :])] = f.coefficient(i)
    return ring.context.from_dict(terms)
