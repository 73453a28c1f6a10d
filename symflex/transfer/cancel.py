"""Exact cancellation of common factors."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.budget import spend
from symflex.transfer.coprimality import Images

if TYPE_CHECKING:
    from flint import fmpz_mpoly


def cancel(
    numerator: Factored, denominator: Factored, images: Images | None = None
) -> tuple[Factored, Factored]:
    """Return numerator/denominator in lowest terms, and the common factor that was found.

    Both may be rational; equal factors cancel at once, the others pairwise by exact greatest common divisors.
    ``images`` may be shared by calls over one ring, so that an image is made once.
    """
    ring = numerator.ring
    quotient = numerator / denominator
    if quotient.is_zero:
        return quotient, Factored.number(ring, 1)
    shared = Factored.number(ring, 1)
    for factor, exponent in numerator.factors:
        other = denominator.exponent_of(factor)
        if exponent > 0 and other > 0:
            shared = shared * Factored(ring, Fraction(1), ((factor, min(exponent, other)),))
    above = [(f, e) for f, e in quotient.factors if e > 0]
    below = [(f, -e) for f, e in quotient.factors if e < 0]
    images = images or Images(ring)
    i, changed = 0, False
    while i < len(above):
        j = 0
        while j < len(below):
            spend()
            f, m = above[i]
            g, n = below[j]
            if images.prove_coprime(f, g) or (common := f.gcd(g)).is_constant():
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
