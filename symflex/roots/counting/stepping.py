"""Adding up how far an argument turns along a path, in steps as long as the proof of each allows."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from flint import arb

from symflex.budget import spend
from symflex.roots.argument import ROOM
from symflex.roots.counting.winding import RootOnPathError

GOAL = 1.15
"""Deviation that the next step aims at."""
GROWTH = 1.5
"""Most that one step may be longer than the last, or shorter."""
SHRINKING = 0.5
"""Least that is tried of a step that was too long."""
NEARER = 0.5
"""Of the last step that was too long, what is tried next: deviations grow exponentially."""
FORGETTING = 1.1
"""Growth of that bound with every step."""
WIDENED = 1 + 2.0**-40
"""Makes up for the rounding of half a step."""
SPREAD = 2.0**-50
"""Relative width that makes up for the rounding of a step's middle."""


def total_turn(change: Callable[[float, float], tuple[float, arb]], first: float, smallest: float) -> arb:
    """Return the change of an argument along a path from t = 0 to 1.

    ``change`` returns for a step between two t a bound on the deviation from its middle, and the turn from
    one end to the other, which has to be right where the bound is at most ``ROOM``. ``first`` is the length
    of the first step in t; RootOnPathError when steps would become smaller than ``smallest``.
    """
    total = arb(0)
    t, step = 0.0, first
    longest = inf
    while t < 1:
        spend()
        end = min(1.0, t + step)
        off, turn = change(t, end)
        if off > ROOM:
            longest = end - t
            step = longest * max(SHRINKING, min(0.7, GOAL / off))
            if step < smallest:
                raise RootOnPathError
            continue
        total += turn
        longest *= FORGETTING
        step = min((end - t) * max(1 / GROWTH, min(GROWTH, GOAL / max(off, 0.1))), NEARER * longest)
        t = end
    return total
