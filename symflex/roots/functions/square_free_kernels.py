"""Squares hidden in polynomials in kernels: multiplicities of roots that are exact.

``cosh^4 - cosh^2`` is ``(cosh*sinh)^2``, and ``1 - cos`` is twice the square of the sine of half the angle.
Over exponentials and half-angle functions polynomials factor in one way only (Yun 1976 for the square-free
part); whatever square appears there is written in kernels of half the length.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import Factored, square_free_factors
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.normal_form import NormalForm

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.transfer import BoundTransferFunction

MOST_TERMS = 3000
"""Terms of a polynomial in exponentials up to which its squares are sought."""


def without_squares(bound: BoundTransferFunction, part: Factored) -> tuple[BoundTransferFunction, Factored]:
    """Return a product of factors without squares, and the function with the kernels these are made of."""
    table = bound.kernels
    if any(kernel.function == "fundamental" for kernel in table.kernels):
        return bound, part
    coordinates = Exponentials(part.ring, table)
    circular = [
        coordinates.coordinates.generator(name)
        for angle in coordinates.angles
        if angle.kind == "circular"
        for name in angle.coordinates
    ]
    split: list[tuple[fmpz_mpoly, int]] = []
    has_squares = False
    for factor, exponent in part.factors:
        pieces = _pieces(coordinates, factor)
        if pieces is None:
            return bound, part
        has_squares = has_squares or any(
            e > 1 and (len(piece) > 1 or any(piece == c for c in circular)) for piece, e in pieces
        )
        split += [(piece, e * exponent) for piece, e in pieces]
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


def _pieces(coordinates: Exponentials, factor: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]] | None:
    """Return a polynomial as powers of polynomials without squares, ``None`` where it is too long."""
    if len(factor) > MOST_TERMS:
        return None
    if len(factor) == 1:
        # A generator; those other than kernels are coordinates themselves.
        name = coordinates.ring.names[factor.degrees().index(1)]
        if name in coordinates.coordinates.index:
            return [(coordinates.coordinates.generator(name), 1)]
    found = []
    for polynomial, times in coordinates.transform(factor).factors:
        if len(polynomial) > MOST_TERMS:
            return None
        if len(polynomial) == 1:
            # A coordinate.
            found.append((polynomial, times))
            continue
        _, pieces = square_free_factors(polynomial)
        found += [(piece, e * times) for piece, e in pieces]
    return found
