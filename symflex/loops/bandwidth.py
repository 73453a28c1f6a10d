"""The bandwidth a loop allows: its crossover frequency where the gain can still be doubled.

Definition: the gain is raised from 0 up to half of the one at which the loop first becomes unstable, so that
a gain margin of 6 dB is left (Franklin, Powell & Emami-Naeini, Feedback Control of Dynamic Systems, 2010,
section 6.4). The bandwidth is the frequency at which the loop gain then first falls below one.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from flint import acb, arb

from symflex.roots import precision
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.loops.margins import LoopGain
    from symflex.loops.stability_map import GainInterval

MARGIN: Final = 2
BITS: Final = 128


@dataclass(frozen=True, slots=True)
class AllowedBandwidth:
    """Up to which frequency a loop can follow, with a gain margin of 6 dB."""

    gain: Fraction | None  # the largest gain with that margin; ``None`` when every gain is stable
    # At which the loop gain first falls below one [rad/s]; ``None`` when there is no such gain, or when the
    # loop gain is below one from the lowest frequencies on.
    frequency: arb | None
    phase_margin: arb | None  # the smallest one there in absolute value [rad], positive for lag
    is_limited: bool  # by a boundary: twice the gain is one. Otherwise the gains examined end there.


def allowed_bandwidth(
    intervals: Sequence[GainInterval], limit: Fraction | None, loop_gain: LoopGain
) -> AllowedBandwidth | None:
    """Return the bandwidth that the stable gains next to 0 allow, ``None`` when there are none.

    Intervals ascend, and negative gains may be among them; gains were examined up to ``limit``, None for all.
    ``loop_gain`` is that of a loop closed once.
    """
    begin = next((i for i in intervals if _is_above(i.high) and not (i.low is not None and i.low > 0)), None)
    if begin is None or not begin.poles.is_stable:
        return None
    if begin.high is None:
        return AllowedBandwidth(None, None, None, is_limited=False)
    is_limited = begin is not intervals[-1]
    end = Fraction(float(begin.high.mid())) if is_limited or limit is None else limit
    gain = end / MARGIN
    found = loop_gain.crossovers(gain)
    with precision(BITS):
        size = ball(gain)
        if not found or not abs(loop_gain.ratio(found[0][0].mid() / 2)) * size > 1:
            return AllowedBandwidth(gain, None, None, is_limited)
        angles = [(-ratio * acb(size)).arg() for _, ratio in found]
    worst = min(angles, key=lambda angle: abs(float(angle.mid())))
    return AllowedBandwidth(gain, found[0][0], worst, is_limited)


def _is_above(end: arb | None) -> bool:
    return end is None or bool(end > 0)
