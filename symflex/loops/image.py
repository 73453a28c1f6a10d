"""Stable values of models with complex coefficients, from a function times its mirror image.

Input: what was found for the product, which is real, with poles of both. Output: the same of the model alone.

Example: ``s + 1 - j K`` has the image ``s + 1 + j K``. A pole of the model that crosses the axis at 3 rad/s
does so with its image at -3 rad/s: of two poles one counts, and the model itself vanishes at one of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import acb, arb

from symflex.balls import bits_for_digits, precision
from symflex.errors import Diagnostic, ModelError
from symflex.loops.apart import PolesApart
from symflex.loops.boxes import BITS, CharacteristicFunction, FirstOrder
from symflex.loops.chart import count_at
from symflex.loops.stability_map import BOXES, Boundary, PoleCount, StabilityMap
from symflex.model import Model
from symflex.roots.root import exact_fraction
from symflex.transfer import TransferFunction
from symflex.transfer.mirrored import mirrored


def real_product(tf: TransferFunction, what: str) -> TransferFunction:
    """Return a function times its mirror image; SF251 where its waves have complex coefficients."""
    product = mirrored(tf)
    if product is None:
        message = f"{what} is not available with waves that have complex coefficients"
        hint = "write real equations, of both planes or axes"
        raise ModelError(Diagnostic("SF251", message, None, hint))
    return product


def without_image(found: StabilityMap, function: CharacteristicFunction) -> StabilityMap:
    """Return what was found for a function times its image of the function alone."""
    intervals = found.intervals
    if found.method != BOXES:  # there poles are those of the function alone
        halves = (PoleCount(i.poles.right // 2, i.poles.axis // 2) for i in intervals)
        intervals = tuple(replace(i, poles=poles) for i, poles in zip(intervals, halves, strict=True))
    tf = function.tf
    polynomials = (*(f for f, e in tf.den.factors if e > 0), *(h.polynomial for h in tf.hidden))
    alone = replace(function, chosen=polynomials)
    found = found.with_boundaries([_with_signs(b, alone, found.digits) for b in found.boundaries])
    found = replace(found, intervals=intervals)
    if found.method == BOXES:
        return found
    at_nominal = None if found.nominal is None else count_at(function, (found.nominal,))[0]
    apart = PolesApart() if at_nominal is None else PolesApart(at_nominal)
    return replace(found, at_nominal=found.at_nominal and at_nominal, apart=apart)


def function_of(model: Model, tf: TransferFunction, name: str) -> CharacteristicFunction:
    """Return the characteristic function of a model with numbers in one parameter, without an image."""
    return CharacteristicFunction.of(model, tf.whole, (name,))


def _with_signs(boundary: Boundary, function: CharacteristicFunction, digits: int) -> Boundary:
    """Return a boundary with the frequencies at which the function itself has a pole."""
    ends = (exact_fraction(boundary.gain.lower()), exact_fraction(boundary.gain.upper()))
    with precision(bits_for_digits(digits) + BITS):
        values = function.expanded((ends,))
        crossings = tuple(
            replace(c, frequencies=tuple(w for each in c.frequencies for w in _signed(each, values)))
            for c in boundary.crossings
        )
    return replace(boundary, crossings=crossings)


def _signed(omega: arb, values: FirstOrder) -> Sequence[arb]:
    if omega.contains(0):
        return (omega,)
    every = range(len(values.polynomials))
    both = [w for w in (omega, -omega) if any(v.contains(0) for v, _ in values.around(acb(0, w), every))]
    return both or (omega,)
