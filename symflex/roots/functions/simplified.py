"""A function made ready for a search: kernels of length zero are numbers, and hidden squares written out.

``cosh^4 - cosh^2`` is ``(cosh*sinh)^2``, and ``1 - cos`` is twice the square of the sine of half the angle.
Over exponentials and half-angle functions polynomials factor in one way only (Yun 1976 for the square-free
part); whatever square appears there is written in kernels of half the length, so that multiplicities of roots
are exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import NO_KERNELS, Factored, Ring, degree_in, square_free_factors
from symflex.algebra.exponentials import Exponentials
from symflex.algebra.normal_form import NormalForm
from symflex.errors import Diagnostic, ModelError
from symflex.transfer.transfer_function import HiddenFactor

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.algebra.dispersion import Kernel
    from symflex.transfer import BoundTransferFunction


EVEN = ("cosh", "cos", "exp")


def without_lengths_of_zero(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return the function with the values of kernels whose length is zero in their place.

    SF231 when the denominator vanishes: two nodes are one.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.T = { value = "0 s", assume = "nonnegative" }
    ... blocks.D = { type = "delay", T = "T" }
    ... inputs.u = {}
    ... outputs.y = "u/(1 + D)"
    ... ''')
    >>> bound = pipeline.derive_bound(model, model.transfer_functions)[0]
    >>> without_lengths_of_zero(bound).is_distributed
    False
    """
    gone = [kernel for kernel in bound.kernels.kernels if kernel.length.is_zero]
    if not gone:
        return bound
    ring = bound.ratio.ring
    images = [ring.context.gen(i) for i in range(len(ring.names))]
    for kernel in gone:
        images[ring.index[kernel.generator]] = ring.constant(_value(kernel))

    def evaluated(factor: fmpz_mpoly) -> Factored:
        return Factored.polynomial(ring, ring.compose(factor, images))

    num, den = (part.map_factors(ring, evaluated) for part in (bound.num, bound.den))
    if den.is_zero:
        message = f"the denominator of {bound.name} is zero for these values"
        raise ModelError(Diagnostic("SF231", message, None, "a part needs its length"))
    hidden = [
        HiddenFactor(f, e * known.multiplicity)
        for known in bound.hidden
        for f, e in evaluated(known.polynomial).factors
    ]
    kernels = [ring.index[generator] for generator in bound.kernels.generators]
    factors = [f for f, _ in (*num.factors, *den.factors)] + [h.polynomial for h in hidden]
    if any(degree_in(f, i) for f in factors for i in kernels):
        return replace(bound, ratio=num / den, parts=(num, den), hidden=tuple(hidden))
    small = Ring(tuple(name for name in ring.names if name not in bound.kernels.generators))
    places = [ring.index[name] for name in small.names]

    def moved(factor: fmpz_mpoly) -> fmpz_mpoly:
        terms = {tuple(int(m[i]) for i in places): int(c) for m, c in factor.terms()}
        return small.context.from_dict(terms)

    ratio = (num / den).map_factors(small, lambda f: Factored.polynomial(small, moved(f)))
    known = tuple(HiddenFactor(moved(h.polynomial), h.multiplicity) for h in hidden)
    return replace(bound, ratio=ratio, hidden=known, kernels=NO_KERNELS, parts=None)


def _value(kernel: Kernel) -> int:
    if kernel.function == "entry":
        return int(kernel.order % (kernel.dispersion.order + 1) == 0)
    if kernel.function == "fundamental":
        return int(kernel.order == kernel.dispersion.order - 1)
    return int(kernel.function in EVEN)


MOST_TERMS = 3000
"""Terms of a polynomial in exponentials up to which its squares are sought."""


def without_squares(bound: BoundTransferFunction, part: Factored) -> tuple[BoundTransferFunction, Factored]:
    """Return a product of factors without squares, and the function with the kernels these are made of."""
    table = bound.kernels
    if any(kernel.function in ("fundamental", "entry") for kernel in table.kernels):
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
