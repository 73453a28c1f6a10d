"""The phase of a distributed system on the imaginary axis, followed from s = 0 upwards.

Input: frequencies. Output: the continuous phase at each.

There are infinitely many poles and zeros to sum over. So the argument is followed from a small positive s on
a quarter circle to the imaginary axis and along it, in steps that are halved until values and slopes at both
ends agree. A root on the axis is passed on its right: beyond it a zero gives +pi, a pole -pi, as in
:mod:`symflex.analysis.response.phase`.
"""

from __future__ import annotations

from itertools import pairwise
from math import ceil, exp, log, pi
from typing import TYPE_CHECKING

import numpy as np
from flint import acb

from symflex.budget import entered_budget, spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.counting.winding import Winding, continuous_step
from symflex.roots.functions.kernel_function import KernelFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from symflex.roots.functions.kernel_function import Sample
    from symflex.transfer import BoundTransferFunction

LONGEST_STEP = 0.1
SMALLEST_STEP = 1e-9
"""In ln(s): where a step along the axis is still not clear, a root lies on it."""
DETOUR = 4.0
"""Width of the way around a root, in lengths of the step that meets it."""

STEEPEST = 1e11
"""Slope of ln G over ln(s) from which on a frequency is as good as a root."""
SHORTEST_SHARE = 1e-6

Point = tuple[complex, "Sample"]


def follow_phase(bound: BoundTransferFunction, omega: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the continuous phase [rad] at increasing positive frequencies; NaN exactly at a root.

    Parameters
    ----------
    bound : BoundTransferFunction
        Of a distributed system, not identically zero.
    omega : array of float, shape (n,)
        [rad/s], positive and increasing.

    Raises
    ------
    BudgetError
        SF505 when the band holds too many resonances.
    """
    walk = _Walk(bound)
    phase = np.full(omega.shape, np.nan)
    start = min(walk.start, log(omega[0]) - LONGEST_STEP) if omega.size else walk.start
    here, total = walk.reach_axis(start)
    for i, value in enumerate(omega.tolist()):
        sample = walk.function.at_point(acb(0, value))
        if sample is None:
            continue
        if abs(sample.slope) > STEEPEST:
            phase[i] = total
            continue
        there = (complex(log(value), pi / 2), sample)
        total += walk.along(here, there)
        here, phase[i] = there, total
    return phase


class _Walk:
    """Follows the argument of one function."""

    def __init__(self, bound: BoundTransferFunction) -> None:
        self.function = KernelFunction(bound, bound.ratio)
        sides = [KernelFunction(bound, part) for part in (bound.num, bound.den)]
        self.start = min(Winding(f, entered_budget()).smallest(pi / 2 if f.is_even else pi) for f in sides)
        """ln of a radius below the lowest pole and zero."""
        self._winding = Winding(self.function, entered_budget())

    def reach_axis(self, start: float) -> tuple[Point, float]:
        """Return a point low on the axis, and the phase there."""
        first = self._winding.sample(complex(start, 0.0))
        phase = 0.0
        if (round(first.log.imag / pi) % 2 == 1) != (self.function.part.unit < 0):
            phase = pi if round(first.slope.real) < 0 else -pi
        end = complex(start, pi / 2)
        return (end, self._winding.sample(end)), phase + self._winding.turn(complex(start, 0.0), end)

    def along(self, here: Point, there: Point) -> float:
        """Return the change of the argument from one point of the axis to another."""
        highest = max(there[0].real, here[0].real)
        length = min(LONGEST_STEP, 0.5 / max(self._winding.reach(highest), 1.0))
        count = max(1, ceil(abs(there[0] - here[0]) / length))
        between = [here[0] + (there[0] - here[0]) * i / count for i in range(1, count)]
        points = [here, *self._clear(between), there]
        return sum(self._step(a, b) for a, b in pairwise(points))

    def _step(self, here: Point, there: Point) -> float:
        total = 0.0
        pending = [(here, there)]
        while pending:
            spend()
            a, b = pending.pop()
            change = continuous_step(a[1], b[1], b[0] - a[0])
            if change is not None:
                total += change
                continue
            middle = self._clear([(a[0] + b[0]) / 2])
            if middle and abs(b[0] - a[0]) > SMALLEST_STEP:
                pending += [(a, middle[0]), (middle[0], b)]
            else:
                total += self._around(a, b)
        return total

    def _clear(self, points: Sequence[complex]) -> list[Point]:
        """Return the points that are no roots, with their samples."""
        sampled = ((z, self._winding.function.at_logarithm(z)) for z in points)
        return [(z, sample) for z, sample in sampled if sample is not None]

    def _around(self, here: Point, there: Point) -> float:
        """Pass a root on its right."""
        aside = -1j * DETOUR * max(abs(there[0] - here[0]), SMALLEST_STEP)
        points = [here, *self._clear([here[0] + aside, there[0] + aside]), there]
        total = 0.0
        pending = list(pairwise(points))
        while pending:
            spend()
            a, b = pending.pop()
            change = continuous_step(a[1], b[1], b[0] - a[0])
            if change is not None:
                total += change
                continue
            middle = self._clear([(a[0] + b[0]) / 2])
            if not middle or abs(b[0] - a[0]) < SHORTEST_SHARE * abs(aside):
                hertz = exp(here[0].real) / (2 * pi)
                message = f"the phase of {self.function.bound.name} cannot be followed past {hertz:g} Hz"
                raise UncertifiedError(Diagnostic("SF404", message))
            pending += [(a, middle[0]), (middle[0], b)]
        return total
