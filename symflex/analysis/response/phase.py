"""The phase on the imaginary axis: from poles and zeros, or followed from s = 0 upwards.

Input: certified roots and the principal values of the phase, or frequencies alone. Output: the whole turns
that are missing, or the continuous phase.

G(j omega) = K (j omega)^n prod(1 - j omega/z) / prod(1 - j omega/p). Along omega each factor runs on a ray
from 1 that never meets the negative real axis, so the principal value of its argument is its continuous
phase. The exception, a root j b on the axis, is taken as the limit from the left half plane: beyond b a zero
gives +pi, a pole -pi.

Of a distributed system there are infinitely many poles and zeros to sum over. So the argument is followed
from a small positive s on a quarter circle to the imaginary axis and along it, in steps that are halved until
values and slopes at both ends agree. A root on the axis is passed on its right, which comes to the same.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import ceil, exp, log, pi
from typing import TYPE_CHECKING, NoReturn

import numpy as np
from flint import acb

from symflex.budget import entered_budget, spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.counting.winding import Winding, continuous_step
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.root import exact_fraction

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import numpy.typing as npt

    from symflex.roots import PoleZeroMap, Root
    from symflex.roots.functions.kernel_function import Sample
    from symflex.transfer import BoundTransferFunction


def count_turns(
    omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128], roots: PoleZeroMap
) -> npt.NDArray[np.int64]:
    """Return how many whole turns to add to ``np.angle(values)``, given all poles and zeros.

    Values are those at ``1j*omega``; entries that are 0 or not finite do not matter.

    Examples
    --------
    >>> from symflex.roots import RootProblem, find_pole_zero_map
    >>> triple = RootProblem.from_rationals([1, 3, 3, 1])  # (s + 1)^3
    >>> found = find_pole_zero_map("y/u", triple, RootProblem.from_rationals([1]))
    >>> omega = np.array([0.1, 10.0])
    >>> count_turns(omega, (1j * omega + 1) ** -3, found)
    array([ 0, -1])
    """
    integrators = sum(root.multiplicity for root in roots.poles if root.is_zero)
    differentiators = sum(root.multiplicity for root in roots.zeros if root.is_zero)
    order = differentiators - integrators
    phase = order * np.pi / 2 * np.sign(omega) + _phase_of(roots.zeros, omega) - _phase_of(roots.poles, omega)
    usable = np.isfinite(values) & (values != 0)
    principal = np.angle(np.where(usable, values, 1))
    # With K > 0 the two agree up to whole turns, with K < 0 they are half a turn apart.
    if np.sum(np.cos(phase - principal)[usable]) < 0:
        phase = phase + (np.pi if order < 0 else -np.pi) * np.where(omega < 0, -1, 1)
    return np.rint((phase - principal) / (2 * np.pi)).astype(np.int64)


def _phase_of(roots: Iterable[Root], omega: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the sum of arg(1 - j omega/root) over the roots other than 0, in the limit convention above."""
    total = np.zeros_like(omega)
    for root in roots:
        if root.is_zero:
            continue
        re = -0.0 if root.on_imaginary_axis else float(root.re.mid())
        exact = exact_fraction(root.im)
        im = float(exact)
        rest = float(exact - Fraction(im))
        # Close to the root im - omega is exact in double precision, and rest holds the digits im lost.
        total += root.multiplicity * np.arctan2(-omega * re, re * re + im * ((im - omega) + rest))
    return total


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
    """Return the continuous phase [rad] of a distributed system; NaN exactly at a root.

    Frequencies [rad/s] are positive and increase; the function is not identically zero. SF505 when the band
    holds too many resonances.
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
        return self._divided([here, there], SMALLEST_STEP, self._around)

    def _divided(
        self, points: Sequence[Point], shortest: float, past: Callable[[Point, Point], float]
    ) -> float:
        """Return the change along a path, divided until no step is ambiguous; ``past`` takes the shortest."""
        total, pending = 0.0, list(pairwise(points))
        while pending:
            spend()
            a, b = pending.pop()
            change = continuous_step(a[1], b[1], b[0] - a[0])
            if change is not None:
                total += change
                continue
            middle = self._clear([(a[0] + b[0]) / 2])
            if middle and abs(b[0] - a[0]) > shortest:
                pending += [(a, middle[0]), (middle[0], b)]
            else:
                total += past(a, b)
        return total

    def _clear(self, points: Sequence[complex]) -> list[Point]:
        """Return the points that are not roots, with their samples."""
        sampled = ((z, self._winding.function.at_logarithm(z)) for z in points)
        return [(z, sample) for z, sample in sampled if sample is not None]

    def _around(self, here: Point, there: Point) -> float:
        """Pass a root on its right."""
        aside = -1j * DETOUR * max(abs(there[0] - here[0]), SMALLEST_STEP)

        def refuse(*_: Point) -> NoReturn:
            hertz = exp(here[0].real) / (2 * pi)
            message = f"the phase of {self.function.bound.name} cannot be followed past {hertz:g} Hz"
            raise UncertifiedError(Diagnostic("SF404", message))

        points = [here, *self._clear([here[0] + aside, there[0] + aside]), there]
        return self._divided(points, SHORTEST_SHARE * abs(aside), refuse)
