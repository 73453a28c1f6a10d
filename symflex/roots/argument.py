"""How far the argument of what lies in a ball may turn.

A ball of radius 1 about 2 is seen from 0 at 30 degrees on both sides of its middle: whatever a function does
on a step whose values lie in it, its argument stays within these.
"""

from __future__ import annotations

from math import asin, inf, pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import acb, arb

ROOM = 1.5
"""Largest deviation of the argument [rad] from the middle to an end of a step; less than pi/2."""


def deviation(values: acb) -> float:
    """Return how far the argument may turn from the middle of a ball of values [rad].

    Half a turn and more stands for what may wind about 0; infinite where nothing is known.
    """
    if not values.is_finite():
        return inf
    middle = values.mid()
    room = middle.abs_lower()
    return angle((values - middle).abs_upper(), room) if room > 0 else inf


def angle(off: arb, size: arb) -> float:
    """Return half the angle [rad] at which a disc of radius ``off``, so far from 0, is seen from there."""
    share = float((off / size).upper())
    return asin(share) if share < 1 else share * pi / 2
