"""Values to double precision, from balls at growing precision."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import TYPE_CHECKING

from flint import acb, arb, ctx

if TYPE_CHECKING:
    from collections.abc import Callable

    Ball = Callable[[acb], acb]

FIRST_BITS = 96
LAST_BITS = 6144
DOUBLE_BITS = 54
"""One more than the significand of a double."""
NEAR = (200, 220)
"""Negative powers of two between which the behaviour at a point is read off, where there is no number."""


def double_value(enclosed: Callable[[int], Ball], first: Ball, s: complex, patience: int | None) -> complex:
    """Return a function's value at one complex frequency [rad/s] to double precision.

    Parameters
    ----------
    enclosed : callable
        Returns the function in balls at a number of bits.
    first : callable
        The same at ``FIRST_BITS``.
    s : complex
        [rad/s].
    patience : int or None
        How often the precision is doubled before a value that is no number is sought as a limit; None for
        never, where only a pole has none.

    Returns
    -------
    complex
        Nan where ``s`` is not finite, ``inf + nan*1j`` at a pole.
    """
    if not (isfinite(s.real) and isfinite(s.imag)):
        return complex(nan, nan)
    point, function, bits = acb(s.real, s.imag), first, FIRST_BITS
    while True:
        value = function(point)
        if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
            return complex(float(value.real.mid()), float(value.imag.mid()))
        if patience is not None and not value.is_finite() and bits >= FIRST_BITS << patience:
            return _limit_at(enclosed, s)
        if bits >= LAST_BITS:
            return 0j if value.is_finite() else complex(inf, nan)
        bits *= 2
        function = enclosed(bits)


def _limit_at(enclosed: Callable[[int], Ball], s: complex) -> complex:
    """Return the value where parts of an expression are no numbers, by continuity."""
    order, value = order_near(enclosed, s)
    if value is None or order < 0:
        return complex(inf, nan)
    return 0j if order > 0 else complex(float(value.real.mid()), float(value.imag.mid()))


def order_near(enclosed: Callable[[int], Ball], s: complex) -> tuple[int, acb | None]:
    """Return the order of the zero (negative: of the pole) at ``s``, and a value close by if one is found."""
    near, nearer = (_beside(enclosed, s, -e) for e in NEAR)
    if near is None or nearer is None:
        return 0, None
    with ctx.workprec(LAST_BITS):
        ratio = abs(nearer / near).log() / arb(2).log() / (NEAR[0] - NEAR[1])
        return round(float(ratio.mid())), nearer


def _beside(enclosed: Callable[[int], Ball], s: complex, exponent: int) -> acb | None:
    """Return a ball around the value at ``s + 2^exponent``, ``None`` when it is not found."""
    bits = FIRST_BITS * 8
    while bits <= LAST_BITS:
        with ctx.workprec(bits):
            point = acb(s.real, s.imag) + (arb(2) ** exponent) * max(abs(s), 1.0)
            value = enclosed(bits)(point)
            if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
                return value
        bits *= 2
    return None
