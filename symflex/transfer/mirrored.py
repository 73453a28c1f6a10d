"""The product of a function with complex coefficients and its mirror image, which is real.

Input: a transfer function that holds j. Output: one without, whose poles and zeros are those of the first and
their mirror images in the real axis, so that every one that was real, or paired, is there twice.

Example: ``s - j w`` has the image ``s + j w``; the product is ``s^2 + w^2``. In general f = g + j h with real
g and h has the product ``g^2 + h^2``, a polynomial in the same kernels if the waves themselves are real. It
is the determinant of the equations in both planes of a rotor, or in both axes of a machine.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from flint import fmpz_mpoly

from symflex.algebra import Factored, Ring, degree_in, irreducible_factors, real_parts
from symflex.model.model import IMAGINARY
from symflex.transfer.bound import BoundTransferFunction
from symflex.transfer.transfer_function import HiddenFactor, TransferFunction

Function = TypeVar("Function", TransferFunction, BoundTransferFunction)


def mirrored(function: Function) -> Function | None:
    """Return a function times its mirror image; None where its waves have complex coefficients."""
    ring = function.ratio.ring
    if IMAGINARY not in ring.index:
        return function
    if has_complex_waves(function):
        return None
    parts = function.parts and (times_image(function.parts[0]), times_image(function.parts[1]))
    hidden = tuple(
        HiddenFactor(f, e * h.multiplicity)
        for h in function.hidden
        for f, e in times_image(Factored.polynomial(ring, h.polynomial)).factors
    )
    ratio = times_image(function.ratio)
    if isinstance(function, BoundTransferFunction):
        return replace(function, ratio=ratio, hidden=hidden, parts=parts, is_of_model=False)
    waves = None if function.with_waves is None else mirrored(function.with_waves)
    return replace(
        function, reduced=ratio, closed=None, hidden=hidden, parts=parts, with_waves=waves, solve=None
    )


def has_complex_waves(function: Function) -> bool:
    """Tell whether waves of a function have complex coefficients: its image has other waves."""
    is_complex = IMAGINARY in function.ratio.ring.index
    return is_complex and any(value.depends_on(IMAGINARY) for value in function.kernels.values)


def times_image(value: Factored) -> Factored:
    """Return a product times its mirror image, over the same ring and without j."""
    if IMAGINARY not in value.ring.index:
        return value
    return value.map_factors(value.ring, lambda factor: _times_image(value.ring, factor))


def _times_image(ring: Ring, factor: fmpz_mpoly) -> Factored:
    g, h = real_parts(ring, factor, IMAGINARY)
    if not degree_in(factor, ring.index[IMAGINARY]):
        return Factored.polynomial(ring, factor) ** 2
    common = g.gcd(h)
    g, h = g // common, h // common
    unit, factors = irreducible_factors(g * g + h * h)
    product = Factored.polynomial(ring, common) ** 2 * unit
    for each, exponent in factors:
        product = product * Factored.polynomial(ring, each) ** exponent
    return product
