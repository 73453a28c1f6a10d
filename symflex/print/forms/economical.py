"""Arguments of single transfer functions as long as the model's.

The transfer functions of a model share base lengths: with one output at midspan all of them are in kernels of
``l/2``. One that needs only even multiples of such a half is written in kernels of ``l`` again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import Factored, KernelTable, Ring
from symflex.algebra.normal_form import NormalForm
from symflex.print.forms.invariants import IMAGINARY, factor_by_factor, in_exponentials, real_powers
from symflex.print.forms.notation import angles_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.print.forms.notation import Angle
    from symflex.transfer import TransferFunction

DOUBLINGS = 8
"""Halvings that are undone at most."""
LARGE = 300
"""Number of terms of a factor from which it is left as it is."""


def economical(tf: TransferFunction) -> TransferFunction:
    """Return the same function in kernels of whole lengths where it can be.

    ``sinh(q)*cosh(q)`` of ``q = gamma*l/2`` becomes ``sinh(q)/2`` of ``q = gamma*l``.
    """
    if any(len(factor) > LARGE for factor, _ in tf.ratio.factors):
        return tf
    for _ in range(DOUBLINGS):
        lengths = dict.fromkeys(a.length for a in angles_of(tf.kernels) if is_half(a.length))
        found = next((d for length in lengths if (d := _doubled(tf, length)) is not None), None)
        if found is None:
            return tf
        tf = found
    return tf


def is_half(length: Factored) -> bool:
    """Tell whether a length is a half of what stands in the model."""
    return not length.is_constant and length.unit.denominator % 2 == 0


def _doubled(tf: TransferFunction, length: Factored) -> TransferFunction | None:
    """Return the function in kernels of twice a length, ``None`` when it is not one or nothing is in them."""
    angles = [a for a in angles_of(tf.kernels) if a.length is length]
    ring = tf.ratio.ring
    kernels = [ring.index[g] for a in angles for g in a.kernels.values()]

    def holds(factor: fmpz_mpoly) -> bool:
        return any(int(factor.degrees()[i]) for i in kernels)

    def one(factor: fmpz_mpoly) -> Factored | None:
        return _in_doubles(tf, factor, angles) if holds(factor) else Factored.polynomial(ring, factor)

    def whole(side: fmpz_mpoly) -> Factored | None:
        return _in_doubles(tf, side, angles) if len(side) <= LARGE else None

    if not any(holds(factor) for factor, _ in tf.ratio.factors):
        return None
    result = factor_by_factor(tf.ratio, ring, one, whole)
    if result is None:
        return None
    twice = length * 2
    table = KernelTable(
        tf.kernels.dispersions,
        tuple(
            replace(k, length=twice) if k.wavenumber and k.length is length else k for k in tf.kernels.kernels
        ),
    )
    ratio = NormalForm(ring, table).reduce_factored(result)
    return replace(tf, reduced=ratio, kernels=table, parts=None)


def _in_doubles(tf: TransferFunction, factor: fmpz_mpoly, angles: Sequence[Angle]) -> Factored | None:
    """Return a polynomial in kernels of twice the argument."""
    source = tf.ratio.ring
    ring = Ring((*source.names, IMAGINARY))
    work = factor.compose(*(ring.generator(n) for n in source.names), ctx=ring.context)
    halves = 0
    for angle in angles:
        found = angle_doubled(ring, work, angle)
        if found is None:
            return None
        work, times = found
        halves += times
    back = [source.generator(n) for n in source.names]
    plain = work.compose(*back, source.constant(0), ctx=source.context)
    scale = Factored.number(source, 2) ** halves
    return NormalForm(source, tf.kernels).reduce(plain) / scale


def angle_doubled(ring: Ring, work: fmpz_mpoly, angle: Angle) -> tuple[fmpz_mpoly, int] | None:
    """Return 2^n times a polynomial in kernels of twice one angle, and n."""
    coefficients, highest = in_exponentials(ring, work, angle)
    j = ring.generator(IMAGINARY)
    kernels = {f: ring.generator(g) for f, g in angle.kernels.items()}
    total = ring.constant(0)
    for (a, b), part in coefficients.items():
        if part.is_zero():
            continue
        if a % 2 or b % 2:
            return None
        total = total + part * _power(kernels, j, a // 2, b // 2)
    return real_powers(ring, total), highest


def _power(kernels: Mapping[str, fmpz_mpoly], j: fmpz_mpoly, a: int, b: int) -> fmpz_mpoly:
    """Return ``E^a z^b``."""
    c, s = kernels["cosh"], kernels["sinh"]
    grown = (c + s) ** a if a >= 0 else (c - s) ** -a
    if not b:
        return grown
    turned = kernels["cos"] + (1 if b > 0 else -1) * j * kernels["sin"]
    return grown * turned ** abs(b)
