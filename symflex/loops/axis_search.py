"""Where poles of a loop cross the imaginary axis for gains in a range, whatever evaluates A and B there.

Input: an :class:`OnAxis`, ``A + K B`` at s = j omega and next to s = 0. Output: where poles cross, and at
which gains; what the search leaves open goes to ``reasons``.

Example: with A = s^2 + s + 1 and B = s^2 - s a pole lies at s = j sqrt(1/2) for K = 1.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from fractions import Fraction
from typing import Protocol

from flint import arb

from symflex.balls import ball, precision
from symflex.loops.axis import AxisRoots, LoopAtOrigin, find_on_axis
from symflex.loops.loop_function import LoopValue
from symflex.loops.stability_map import BITS, Crossing
from symflex.roots.root import hertz

SHRINKINGS = 30  # halvings of a disc about 0
NOT_PROVED_AT_ZERO = "the motion of poles next to s = 0 is not proved"
WIDER = 16.0  # by how much a disc about 0 is widened
NEXT_TO_ZERO = 1e-6  # share of the frequency of one wave at which crossings are sought if 0 stays open


class OnAxis(Protocol):
    """``A + K B`` on the imaginary axis."""

    def on(self, omega: arb, bits: int) -> tuple[LoopValue, LoopValue]:
        """Return A and B on a ball of frequencies [rad/s], and in its middle."""

    def at_origin(self, times: float = 1.0) -> LoopAtOrigin | None:
        """Return A and B near 0, as far as roots next to it times a factor; ``None`` if that is not known."""

    def is_blurred(self, omega: arb) -> bool:
        """Tell whether next to nothing is known of A or B on a hundredth of a frequency."""


class AxisSearch(ABC):
    """A loop whose poles are followed across the axis. ``reasons`` say why something is not certified."""

    limits: tuple[Fraction, Fraction]  # range of the gain
    reasons: list[str]

    @property
    @abstractmethod
    def axis_end(self) -> float:
        """How far crossings of the axis are searched [rad/s]."""

    @property
    @abstractmethod
    def scale(self) -> float:
        """A frequency of the loop [rad/s]."""

    def frequency(self, omega: arb) -> arb:
        """Return the frequency [rad/s] at a place of the axis."""
        return omega

    def from_root(self, size: float) -> float:
        """Return an ``abs(s)`` [rad/s] up to which no root of it exceeds a size."""
        return size

    def leave_open(self, omega: arb) -> None:
        """Say that it could not be decided whether poles cross near a frequency [rad/s]."""
        frequency = float(hertz(omega).mid())
        self.reasons.append(f"it could not be decided whether poles cross the axis near {frequency:.6g} Hz")

    def crossings_of(self, function: OnAxis, digits: int, *, is_simple: bool = True) -> list[Crossing]:
        """Return where poles cross the axis for gains in the range; roots of a function may be multiple."""
        crossings: list[Crossing] = []
        first, origin = self.next_to_zero(function)
        if origin is not None:
            gain = origin.gain()
            if gain is not None and self._may_be_in_range(gain):
                crossings.append(Crossing(gain, (arb(0),), change=None))
        result = self.on_axis(function, LoopValue.crossing, self._is_far, (first, self.axis_end), digits)
        for omega in result.roots:
            bits = max(BITS, 2 * omega.bits())
            around, _ = function.on(omega, bits)
            with precision(bits):
                if self._is_far(around):
                    continue
                if around.b.contains(0):
                    frequency = float(hertz(omega).mid())
                    self.reasons.append(f"poles near {frequency:.6g} Hz may stay on the axis for every gain")
                    continue
                gain = around.gain()
                # A simple pole s moves by ds/dK = -B/(A' + K B'); its mirror image moves alike.
                slope = -(around.b / (around.a_slope + gain * around.b_slope)).real
                change = 2 if is_simple and slope > 0 else -2 if is_simple and slope < 0 else None
            if self._may_be_in_range(gain):
                crossings.append(Crossing(gain, (self.frequency(omega),), change=change))
        return crossings

    def on_axis(
        self,
        function: OnAxis,
        equation: Callable[[LoopValue], tuple[arb, arb]],
        is_excluded: Callable[[LoopValue], bool],
        limits: tuple[float, float],
        digits: int,
    ) -> AxisRoots:
        """Return the roots of a real function along the axis between two frequencies."""
        low, high = limits
        result = find_on_axis(function.on, equation, is_excluded, (low, high * 1.01), digits)
        for gap in result.undecided:
            self.leave_open(gap)
        return result

    def next_to_zero(self, function: OnAxis) -> tuple[float, LoopAtOrigin | None]:
        """Return a frequency [rad/s] within which no pole crosses the axis but at 0, as far as proved."""
        origin = function.at_origin()
        if origin is None:
            self.reasons.append(NOT_PROVED_AT_ZERO)
            return self.scale * NEXT_TO_ZERO, None
        radius = self._proved_within(origin)
        if radius is None:
            # Several crossings meet at 0: nothing is gained by going closer.
            self.reasons.append(NOT_PROVED_AT_ZERO)
            return float((origin.series[0].reach / 4).lower()), origin
        times = WIDER
        # Balls know little next to 0 where wavenumbers vanish, and series reach farther.
        while function.is_blurred(radius) and (wider := function.at_origin(times)) is not None:
            larger = self._proved_within(wider)
            if larger is None or not larger > radius:
                break
            origin, radius, times = wider, larger, times * WIDER
        return float(radius.lower()), origin

    def _proved_within(self, origin: LoopAtOrigin) -> arb | None:
        radius, most = origin.series[0].reach / 4, ball(max(abs(x) for x in self.limits))
        for _ in range(SHRINKINGS):
            if origin.turns_away(radius) or origin.side(most, radius) > 0:
                return radius
            radius = radius / 2
        return None

    def _is_far(self, value: LoopValue) -> bool:
        """Tell whether the gain of a pole at these values is out of the range."""
        low, high = (ball(x) for x in self.limits)
        most = abs(low).max(abs(high))
        size = value.a.abs_lower()
        if size > most * value.b.abs_upper():
            return True
        if low > 0 and value.a.abs_upper() < low * value.b.abs_lower():
            return True
        if value.b.contains(0):
            return False
        gain = value.gain()
        return bool(gain < low) or bool(gain > high)

    def _may_be_in_range(self, gain: arb) -> bool:
        low, high = (ball(x) for x in self.limits)
        return not (gain < low or gain > high)
