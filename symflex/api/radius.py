"""How far the midpoint of a complex ball can be from what the ball encloses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mpmath

from symflex.roots import precision
from symflex.roots.multiprecision import to_mpmath

if TYPE_CHECKING:
    from flint import acb

RADIUS_BITS = 64


def radius_of(ball: acb) -> mpmath.mpf:
    """Return an upper bound on the distance from the midpoint to any point of a ball, in the ball's unit.

    Examples
    --------
    >>> from flint import acb, arb
    >>> round(float(radius_of(acb(arb(1, 3), arb(0, 4)))), 6)
    5.0
    """
    with precision(RADIUS_BITS):
        return to_mpmath((ball.real.rad() ** 2 + ball.imag.rad() ** 2).sqrt().upper())
