"""Balls as mpmath numbers, with all their bits whatever mpmath's working precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mpmath

if TYPE_CHECKING:
    from flint import acb, arb


def to_mpmath(ball: arb) -> mpmath.mpf:
    """Return the midpoint of a real ball, exactly.

    Examples
    --------
    >>> from flint import arb
    >>> to_mpmath(arb(0.75))
    mpf('0.75')
    """
    mantissa, exponent = ball.mid().man_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(mantissa), int(exponent)))


def to_complex_mpmath(ball: acb) -> mpmath.mpc:
    """Return the midpoint of a complex ball, exactly."""
    # mpmath.mpc(re, im) would round to the working precision.
    return mpmath.mp.make_mpc((to_mpmath(ball.real)._mpf_, to_mpmath(ball.imag)._mpf_))
