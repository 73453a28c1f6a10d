"""Where closed-loop poles cross the imaginary axis as a gain changes, whatever the loop is made of.

Along the axis ``A + K B`` vanishes for a real K only where ``Im(A conj(B))`` does: crossings are isolated in
one dimension. Next to s = 0, where both may vanish, power series say what poles do.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Generic, TypeVar

from flint import arb

from symflex.loops.axis import AxisRoots, LoopAtOrigin, OnAxis, find_on_axis
from symflex.loops.loop import LoopValue
from symflex.loops.stability_map import Crossing, PoleCount
from symflex.roots import Budget, precision
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

BITS = 128
"""Of gains and their limits."""
SHRINKINGS = 30
"""Halvings of a disc about 0."""
NEXT_TO_ZERO = 1e-6
"""Of the frequency of one wave: from there on crossings are sought where nothing is known of 0."""

F = TypeVar("F", bound=OnAxis)


class AxisFactors(ABC, Generic[F]):
    """The factors of a characteristic function that no polynomial tells, on the imaginary axis.

    ``limits`` are the range of the gain; ``reasons`` say why something is not certified, ``method`` how poles
    are counted.
    """

    limits: tuple[Fraction, Fraction]
    budget: Budget
    reasons: list[str]
    method: str

    @property
    @abstractmethod
    def with_gain(self) -> tuple[F, ...]:
        """A and B of every factor that depends on the gain."""

    @property
    @abstractmethod
    def radius(self) -> tuple[float, bool]:
        """How far poles are searched [rad/s], and whether it is proved that none lies beyond on the right."""

    @property
    def axis_end(self) -> float:
        """How far crossings of the axis are searched [rad/s]."""
        return self.radius[0]

    @property
    @abstractmethod
    def scale(self) -> float:
        """A frequency [rad/s] at which the largest argument of a kernel is about one."""

    @abstractmethod
    def is_mirrored(self, function: F) -> bool:
        """Tell whether A and B are even or odd alike, so that roots mirror each other for every gain."""

    @abstractmethod
    def tells_meetings(self, function: F) -> bool:
        """Tell whether its second derivatives are known, by which roots that meet are found."""

    @abstractmethod
    def origin(self, function: F) -> LoopAtOrigin | None:
        """Return A and B near 0, ``None`` where their orders or series cannot be told."""

    @abstractmethod
    def last_crossover(self, function: F, gain: arb) -> float:
        """Return the frequency [rad/s] beyond which the loop gain is not one, as far as it is searched."""

    @abstractmethod
    def count(self, gain: Fraction) -> PoleCount:
        """Return how many poles lie right of the axis and on it, as far as they are searched.

        SF802 when a pole lies on the path of the count.
        """

    def crossings(self, digits: int) -> list[Crossing]:
        """Return where poles cross the axis for gains in the range; the search's gaps go to ``reasons``."""
        found: list[Crossing] = []
        for function in self.with_gain:
            found += self._crossings(function, digits)
        return found

    def _crossings(self, function: F, digits: int) -> list[Crossing]:
        found: list[Crossing] = []
        is_mirrored = self.is_mirrored(function)
        if is_mirrored and not self.tells_meetings(function):
            self.reasons.append("where poles that mirror each other meet on the axis is not searched")
            return []
        first, origin = self.next_to_zero(function, is_mirrored=is_mirrored)
        if origin is not None:
            gain = origin.gain()
            if gain is not None and self._may_be_in_range(gain):
                found.append(Crossing(gain, (arb(0),)))
        equation = LoopValue.meeting if is_mirrored else LoopValue.crossing
        order = 2 if is_mirrored else 1
        result = self.on_axis(function, equation, self._is_far, (first, self.axis_end), digits, order)
        for omega in result.roots:
            bits = max(BITS, 2 * omega.bits())
            around, _ = function.on(omega, bits)
            with precision(bits):
                if self._is_far(around):
                    continue
                if around.b.contains(0):
                    place = float((omega.mid() / (2 * arb.pi())).mid())
                    self.reasons.append(f"poles near {place:.6g} Hz may stay on the axis for every gain")
                    continue
                gain = around.gain()
            if self._may_be_in_range(gain):
                found.append(Crossing(gain, (omega,), is_symmetric=is_mirrored))
        return found

    def on_axis(
        self,
        function: F,
        equation: Callable[[LoopValue], tuple[arb, arb]],
        is_excluded: Callable[[LoopValue], bool],
        limits: tuple[float, float],
        digits: int,
        order: int = 1,
    ) -> AxisRoots:
        """Return the roots of a real function along the axis between two frequencies."""
        low, high = limits
        result = find_on_axis(function, equation, is_excluded, (low, high * 1.01), digits, self.budget, order)
        for gap in result.undecided:
            place = float((gap.mid() / (2 * arb.pi())).mid())
            self.reasons.append(f"whether poles cross the axis near {place:.6g} Hz is not decided")
        return result

    def next_to_zero(self, function: F, *, is_mirrored: bool = False) -> tuple[float, LoopAtOrigin | None]:
        """Return a frequency [rad/s] within which no pole crosses the axis but at 0, as far as proved."""
        origin = self.origin(function)
        if origin is None:
            self.reasons.append("what poles do next to s = 0 is not proved")
            return self.scale * NEXT_TO_ZERO, None
        radius = origin.series[0].reach / 4
        for _ in range(SHRINKINGS):
            is_proved = origin.moves_away(radius) if is_mirrored else origin.turns_away(radius)
            if is_proved or self._beyond_all_gains(origin, radius):
                break
            radius = radius / 2
        else:
            # Several crossings meet at 0: nothing is gained by going closer.
            self.reasons.append("what poles do next to s = 0 is not proved")
            radius = origin.series[0].reach / 4
        return float(radius.lower()), origin

    def _beyond_all_gains(self, origin: LoopAtOrigin, radius: arb) -> bool:
        first, second = origin.orders
        if first > second:
            return False
        a, b = origin.sizes(radius)
        most = max(abs(x) for x in self.limits)
        bound = ball(most) * b.abs_upper() * radius ** (second - first)
        return bool(a.abs_lower() > bound)

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
