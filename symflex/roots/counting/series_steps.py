"""How far an argument turns on a step, from a function's power series about it.

Divided by the exponential that it resembles there, the function hardly changes; what is left is told by the
series, whatever large terms the function is a small difference of.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, inf, isfinite, log
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb

from symflex.roots.argument import ROOM, angle
from symflex.roots.counting.local_series import LocalSeries, bound_on_circle, sampled_series
from symflex.roots.precision import precision

if TYPE_CHECKING:
    from symflex.roots.functions.kernel_function import KernelFunction

LEAST = 2
"""Coefficients without which nothing can be told."""
FEWEST = 20
"""Terms where a bound is as small as the function."""
MOST = 250
"""Terms; where more were needed, shorter steps are better."""
SHRUNK = 0.25
"""Radius of the circle where values are taken, over that where they are bounded."""
ARCS = 16
"""Into which a circle is cut to bound a function on it, at first."""
BITS = 160
"""Least precision: sums that cancel lose about half of them."""
WIDER = 4
"""Radius to which a series is bounded, over that of the step it is made for."""
BEYOND = 3
"""Radius on which what is cut off a product of series is bounded, over that of the step."""
SHARP = 2.0**-20
"""Largest relative error of values at the ends of a step."""
BLURRED = 2.0
"""Reported where that is exceeded: more than any step may turn."""
COVERED = 0.4
"""Of the radius to which it is bounded, how much of a series serves for steps."""
NOTHING = (inf, arb("nan"))
"""Bound and turn where nothing is proved."""


@dataclass(eq=False)
class SeriesSteps:
    """Follows one function by its power series."""

    # Its :attr:`~symflex.roots.functions.kernel_function.KernelFunction.power` is followed.
    function: KernelFunction
    _last: LocalSeries | None = field(default=None, init=False)
    _bits: int = field(default=0, init=False)

    def change(self, middle: acb, reach: arb, start: acb, end: acb, bits: int) -> tuple[float, arb]:
        """Return a bound on how far the argument turns away from that of an exponential, and its turn.

        The bound is infinite where nothing is proved. ``reach`` is the most that s moves from the middle on
        the step [rad/s]; ``bits`` the precision, if more than usual is needed.
        """
        bits = max(BITS, 2 * bits)
        with precision(bits):
            centre, radius = middle.mid(), reach + (middle - middle.mid()).abs_upper()
            last = self._last
            if last is not None and bits <= self._bits and _covers(last, centre, radius):
                bound, turn = _followed(last, centre, radius, start, end)
                if bound <= ROOM or last.reach < radius * (2 * WIDER):
                    return bound, turn
            self._last, self._bits = self._made(centre, (radius * WIDER).mid(), bits), bits
            return NOTHING if self._last is None else _followed(self._last, centre, radius, start, end)

    def _made(self, centre: acb, reach: arb, bits: int) -> LocalSeries | None:
        bound = bound_on_circle(self.function, centre, reach, ARCS)
        if bound is None:
            return None
        # Terms enough to make up for what the bound is larger than the function.
        excess = float((bound / abs(self.function.value(centre, bits))).upper().log())
        terms = FEWEST + ceil(max(0.0, excess) / log(WIDER)) if isfinite(excess) else MOST
        if terms > MOST:
            return None
        bits += 2 * terms
        return sampled_series(self.function, centre, reach, bound, bits, terms, terms, SHRUNK)


def _covers(series: LocalSeries, centre: acb, radius: arb) -> bool:
    return bool((centre - series.centre).abs_upper() + radius < series.reach * COVERED)


def _followed(series: LocalSeries, centre: acb, radius: arb, start: acb, end: acb) -> tuple[float, arb]:
    """Return what a series tells of a step in a disc."""
    here = series.around(centre, radius)
    if here is None or len(here[0]) < LEAST:
        return NOTHING
    coefficients, missed = here
    growth = (coefficients[1] / coefficients[0]).mid()
    if not growth.is_finite():
        return NOTHING
    size = abs(growth)
    count = len(coefficients)
    terms = acb_poly(list(coefficients))
    decay = [acb(1)]
    for n in range(1, count):
        decay.append(decay[-1] * -growth / n)
    # Times exp(-growth x), the term of first order is gone.
    flat = (terms * acb_poly(decay)).truncate(count).coeffs()
    wide = radius * BEYOND
    largest = acb_poly([abs(c) for c in coefficients])(acb(wide)).real * (size * wide).exp()
    cut = largest * arb(BEYOND) ** -count * BEYOND / (BEYOND - 1)
    error = cut + missed * (size * radius).exp()
    power, off = arb(1), error
    for coefficient in flat[1:]:
        power *= radius
        off += abs(coefficient) * power
    first = flat[0]
    if not off.is_finite():
        return NOTHING
    bound = angle(off, abs(first))
    if not error < abs(first) * SHARP:
        # What was cut off would make the argument at the ends too blurred to add up.
        bound = max(BLURRED, bound)
    unsure = acb(arb(0, error), arb(0, error))
    ends = [acb_poly(flat)(place - centre) + unsure for place in (start, end)]
    turn = (growth * (end - start)).imag
    # Both ends lie within a right angle of the middle.
    return bound, turn + (ends[1] / first).arg() - (ends[0] / first).arg()
