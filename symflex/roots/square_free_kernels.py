"""Squares hidden in polynomials in kernels: multiplicities of roots that are exact.

``cosh^4 - cosh^2`` is ``(cosh*sinh)^2``, and ``1 - cos`` is twice the square of the sine of half the angle.
Over exponentials and half-angle functions polynomials factor in one way only (Yun 1976 for the square-free
part); whatever square appears there is written in kernels of half the length.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.kernels import Factored
from symflex.kernels.exponentials import Exponentials
from symflex.kernels.normal_form import NormalForm

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.transfer import BoundTransferFunction

MOST_TERMS = 3000
"""Terms of a polynomial in exponentials up to which its squares are sought."""


def without_squares(bound: BoundTransferFunction, part: Factored) -> tuple[BoundTransferFunction, Factored]:
    """Return a product of factors without squares, and the function with the kernels these are made of.

    Parameters
    ----------
    bound : BoundTransferFunction
        Whose kernels the factors have.
    part : Factored
        Polynomials in s, wavenumbers and kernels.
    """
    table = bound.kernels
    if any(kernel.function == "fundamental" for kernel in table.kernels):
        return bound, part
    coordinates = Exponentials(part.ring, table)
    split: list[tuple[fmpz_mpoly, int]] = []
    circular = [
        coordinates.coordinates.generator(name)
        for angle in coordinates.angles
        if angle.kind == "circular"
        for name in angle.coordinates
    ]
    has_squares = False
    for factor, exponent in part.factors:
        if len(factor) > MOST_TERMS:
            return bound, part
        for polynomial, times in coordinates.transform(factor).factors:
            if len(polynomial) > MOST_TERMS:
                return bound, part
            _, pieces = polynomial.factor_squarefree()
            has_squares = has_squares or any(
                int(e) * times > 1 and (len(p) > 1 or any(p == c for c in circular)) for p, e in pieces
            )
            split += [(p, int(e) * times * exponent) for p, e in pieces]
    if not has_squares:
        return bound, part
    halved = coordinates.halved([k for angle in coordinates.angles for k in (angle.even, angle.odd)])
    normal = NormalForm(part.ring, halved)
    result = Factored.number(part.ring, part.unit)
    left = [0] * sum(angle.kind == "hyperbolic" for angle in coordinates.angles)
    for polynomial, exponent in split:
        restored, powers = coordinates.restore_halved(polynomial)
        left = [n + exponent * power for n, power in zip(left, powers, strict=True)]
        result = result * normal.reduce(restored) ** exponent
    if any(left):
        return bound, part
    return replace(bound, kernels=halved), result
