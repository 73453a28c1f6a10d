"""Counting roots by the argument principle: how often a function winds about 0 along a path.

Paths are straight in z = ln(s), where rows of resonances are spaced alike whatever their frequency. Steps
are halved until values and slopes at both ends agree; that is fast, and proves nothing. Where each step is
proved, :func:`total_turn` chooses steps as long as their proofs allow.
"""

from __future__ import annotations

from cmath import pi
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, exp, inf, log
from typing import Generic, TypeVar

from flint import arb

from symflex.balls import UndecidedError, covered
from symflex.budget import entered_budget, spend
from symflex.errors import BudgetError, Diagnostic
from symflex.roots.functions.entire import Followed, Sample
from symflex.roots.functions.kernel_function import ROOM

RING = log(2)
LARGEST_RING = 120  # octaves searched for the lowest root, from that of one wave: more than 36 decades
FAR = 60.0  # logarithm of a frequency beyond all that matter
SAME_ORDER = 0.05  # difference of a count from the order at 0, in turns, that rounding may cause
LONGEST_STEP = 0.4  # longest step of a path [in z]
PHASE_STEP = 2.0  # largest change [rad] of a kernel's argument over a step: no row of roots is missed
DISAGREEMENT = 0.3  # largest difference between ln F at a step's end and what both ends' slopes predict
BEND = 2.0  # largest change of ln F over a step that a change of slope may cause
SMALLEST_STEP = 1e-13  # smallest step of a path [in z]; a path that needs a shorter one meets a root
NEARLY_WHOLE = 0.05  # difference from an integer, in turns, that rounding may cause
WORK_LIMIT = 5_000_000  # terms evaluated in one search
SHORTER = "ask for fewer modes or a smaller region"
TOO_LONG = "the search for roots takes too long"


F_co = TypeVar("F_co", bound=Followed, covariant=True)


class RootOnPathError(Exception):
    """A path meets a root, or passes too close to it."""


class RootOnAxisError(RootOnPathError):
    """The imaginary axis meets a root: no other path about the right half-plane avoids it."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A rectangle ``low < ln abs(s) < high``, ``right < arg(s) < left``."""

    low: float
    high: float
    right: float
    left: float

    @property
    def centre(self) -> complex:
        """The middle, in z."""
        return complex((self.low + self.high) / 2, (self.right + self.left) / 2)

    @property
    def size(self) -> float:
        """The longer side."""
        return max(self.high - self.low, self.left - self.right)

    @property
    def edges(self) -> tuple[tuple[complex, complex], ...]:
        """The four sides, counterclockwise about the cell."""
        corners = (
            complex(self.low, self.right),
            complex(self.high, self.right),
            complex(self.high, self.left),
            complex(self.low, self.left),
        )
        return tuple((corners[i - 1], corners[i]) for i in range(4))

    @property
    def upper_edges(self) -> tuple[tuple[complex, complex], ...]:
        """The sides above the real axis, where those below are their mirror images; none of other cells."""
        if self.right + self.left == 0:
            inner, _, outer, left = replace(self, right=0.0).edges
            return inner, outer, left
        return replace(self, left=pi).edges[:3] if self.right + self.left == 2 * pi else ()

    def holds(self, z: complex, margin: float = 0.0) -> bool:
        """Tell whether a point lies inside, or at most ``margin`` outside."""
        along = self.low - margin < z.real < self.high + margin
        return along and self.right - margin < z.imag < self.left + margin

    def split(self, share: float) -> tuple[Cell, Cell]:
        """Return the two parts on both sides of a cut across the longer side."""
        if self.high - self.low >= self.left - self.right:
            middle = self.low + share * (self.high - self.low)
            return replace(self, high=middle), replace(self, low=middle)
        middle = self.right + share * (self.left - self.right)
        return replace(self, left=middle), replace(self, right=middle)

    def without(self, hole: Cell) -> tuple[Cell, ...]:
        """Return cells that fill this one but for a hole."""
        low, high = max(self.low, hole.low), min(self.high, hole.high)
        right, left = max(self.right, hole.right), min(self.left, hole.left)
        if low >= high or right >= left:
            return (self,)
        around = (
            replace(self, high=low),
            replace(self, low=high),
            Cell(low, high, self.right, right),
            Cell(low, high, left, self.left),
        )
        return tuple(cell for cell in around if cell.low < cell.high and cell.right < cell.left)


class Winding(Generic[F_co]):
    """Follows one function along paths, remembering its values, each of which spends."""

    def __init__(self, function: F_co) -> None:
        self.function = function
        self._samples: dict[complex, Sample | None] = {}
        self._reaches: dict[float, float] = {}
        self._edges: dict[tuple[complex, complex], float] = {}

    def spend(self) -> None:
        """Go on if the work and the time allow it; else SF505, or SF506 if a time was given."""
        spend()
        if not entered_budget().is_timed and self.function.work > WORK_LIMIT:
            raise BudgetError(Diagnostic("SF505", TOO_LONG, None, SHORTER))

    def sample(self, z: complex) -> Sample:
        """Return ln F and its slope at a point; RootOnPathError where it is a root. Spends."""
        if z not in self._samples:
            self.spend()
            self._samples[z] = self.function.at_logarithm(z)
        kept = self._samples[z]
        if kept is None:
            raise RootOnPathError
        return kept

    def reach(self, z: float) -> float:
        """Return the largest kernel argument at ``abs(s) = exp(z)``."""
        if z not in self._reaches:
            self._reaches[z] = self.function.reach(exp(z))
        return self._reaches[z]

    def smallest(self, left: float, holes: Sequence[Cell] = ()) -> float:
        """Return ln of a radius with no roots within but at 0, by all appearances, off holes."""
        order = self.function.order_at_zero()
        z = min([self._scale(), *(hole.low - RING for hole in holes)])
        for _ in range(LARGEST_RING):
            try:
                turns = self.turn(complex(z, 0), complex(z, left)) / left
            except RootOnPathError:
                turns = inf
            if abs(turns - order) < SAME_ORDER:
                return z
            z -= RING
        message, hint = "the lowest root cannot be found", "ask for a band, which needs no lowest root"
        raise BudgetError(Diagnostic("SF505", message, None, hint))

    def _scale(self) -> float:
        """Return ln of a frequency at which the largest argument of a kernel is about one."""
        z, step = 0.0, 2 * RING
        reach = self.reach(z)
        if self.reach(FAR) == reach:
            return z  # no kernel depends on s, as of a beam without mass
        for _ in range(LARGEST_RING):
            if reach > 1:
                z -= step
                lower = self.reach(z)
                if lower > 0.9 * reach:
                    break
                reach = lower
            else:
                if self.reach(z + step) > 1:
                    break
                z += step
        return z

    def turn(self, start: complex, end: complex, smallest: float = SMALLEST_STEP) -> float:
        """Return the change of the argument [rad] from ``start`` straight to ``end``."""
        if (end, start) in self._edges:
            return -self._edges[end, start]
        if (start, end) not in self._edges:
            longest = min(LONGEST_STEP, PHASE_STEP / max(1.0, self.reach(max(start.real, end.real))))
            pieces = abs(end - start) / longest
            if not pieces <= WORK_LIMIT:
                raise BudgetError(Diagnostic("SF505", TOO_LONG, None, SHORTER))

            def step(low: float, high: float) -> float | None:
                a, b = (end if t == 1 else start + (end - start) * t for t in (low, high))
                return continuous_step(self.sample(a), self.sample(b), b - a)

            shortest = smallest / max(abs(end - start), smallest) / 2
            try:
                steps = covered(step, max(1, ceil(pieces)), shortest)
                self._edges[start, end] = sum(turn for _, _, turn in steps)
            except UndecidedError as error:
                raise RootOnPathError from error
        return self._edges[start, end]

    def count(self, cell: Cell) -> int:
        """Return the number of roots in a cell, with multiplicity; else RootOnPathError."""
        smallest = max(SMALLEST_STEP, 1e-7 * cell.size)
        turns = sum(self.turn(start, end, smallest) for start, end in cell.edges) / (2 * pi)
        if abs(turns - round(turns)) > NEARLY_WHOLE:
            raise RootOnPathError
        return round(turns)


def continuous_step(start: Sample, end: Sample, step: complex) -> float | None:
    """Return the change of the argument over a step, ``None`` when the step is too long to tell."""
    predicted = step * (start.slope + end.slope) / 2
    change = end.log - start.log
    change += 2j * pi * round((predicted.imag - change.imag) / (2 * pi))
    if abs(change - predicted) > DISAGREEMENT or abs(step * (end.slope - start.slope)) > BEND:
        return None
    return change.imag


GOAL = 1.15  # deviation that the next step aims at
GROWTH = 1.5  # most that one step may be longer than the last, or shorter
LITTLE = 0.01  # deviation so small that other bounds hold here than where a step was too long
LEAP = 4.0  # growth of a step after one that deviated so little
SHRINKING = 0.5  # least that is tried of a step that was too long
NEARER = 0.5  # share of a step that was too long to try next: deviations grow exponentially
FORGETTING = 1.1  # growth of that bound with every step
WIDENED = 1 + 2.0**-40  # makes up for the rounding of half a step
SPREAD = 2.0**-50  # relative width that makes up for the rounding of a step's middle


def total_turn(change: Callable[[float, float], tuple[float, arb]], first: float, smallest: float) -> arb:
    """Return the change of an argument from t = 0 to 1, by bounds and turns that ``change`` has of steps."""
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
        longest, growth = (inf, LEAP) if off < LITTLE else (longest * FORGETTING, GROWTH)
        step = min((end - t) * max(1 / GROWTH, min(growth, GOAL / max(off, 0.1))), NEARER * longest)
        t = end
    return total
