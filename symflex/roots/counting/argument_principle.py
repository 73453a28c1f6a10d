"""Counting roots by the argument principle, with proof: every step of a path is a ball of s.

A sum of exponentials is followed through the largest of these, whose argument is known, and the ratio to it,
whose values on a step's ball must keep to one side of 0: :mod:`~symflex.roots.functions.exponential_values`.
Any other
function leaves its value F(m) in the middle by no more than the bound of abs(F') over the ball times half the
step; where that is less than abs(F(m)), the argument stays within the arc sine of the ratio.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import TypeVar

from flint import acb, arb

from symflex.balls import precision, precisions
from symflex.roots.counting.local_series import SeriesSteps
from symflex.roots.counting.winding import (
    SPREAD,
    WIDENED,
    Cell,
    RootOnAxisError,
    RootOnPathError,
    Winding,
    total_turn,
)
from symflex.roots.functions.entire import Entire
from symflex.roots.functions.kernel_function import ROOM, angle

BITS = 64  # precision of turns, of which only the nearest integer is wanted
LAST_BITS = 2048  # largest precision: if a factor is still lost with it, a root is on the path
FIRST_STEP = 0.2  # length of the first step [in z]
SMALLEST = 1e-12  # step [in z] below which a root is said to lie on the path
LOSSY = 0.01  # share of its bound below which a turn says that the bound is poor: exponentials cancel


E_co = TypeVar("E_co", bound=Entire, covariant=True)


@dataclass(frozen=True, slots=True)
class LogarithmicLine:
    """What is straight in z = ln(s)."""

    start: complex  # start and end: z; the double nearest to pi or pi/2 stands for that number itself
    end: complex

    def _place(self, t: float) -> complex:
        return self.start if t == 0 else self.end if t == 1 else self.start + (self.end - self.start) * t

    def point(self, t: float) -> acb:
        """Return a point."""
        z = self._place(t)
        return acb(arb(z.real), _angle(z.imag)).exp()

    def step(self, start: float, end: float) -> tuple[acb, acb, arb]:
        """Return a ball around a step, its middle, and the most that s moves from the middle on it."""
        a, b = self._place(start), self._place(end)
        middle, half = (a + b) / 2, (b - a) / 2
        re = arb(middle.real, abs(half.real) * WIDENED + SPREAD * abs(middle.real))
        im = arb(middle.imag, abs(half.imag) * WIDENED + SPREAD * (1 + abs(middle.imag)))
        ball = acb(re, im).exp()
        centre = acb(middle.real, middle.imag).exp()
        return ball, centre, ball.abs_upper() * acb(re.rad(), im.rad()).abs_upper()


class CertifiedWinding(Winding[E_co]):
    """Follows one function along paths with proof; with ``tries_series`` by power series, too."""

    def __init__(self, function: E_co, *, tries_series: bool = False) -> None:
        super().__init__(function)
        self._tries_series = tries_series
        self._bits = BITS
        self._turns: dict[tuple[complex, complex], arb] = {}
        self._series = SeriesSteps(function)

    def count(self, cell: Cell) -> int:
        """Return the number of roots in a cell, with multiplicity: proved, or RootOnPathError."""
        smallest = max(SMALLEST, 1e-9 * cell.size)
        # Sides are followed with more room than the last digit by which mirrored ones may be apart.
        upper = cell.upper_edges if self.function.is_real else ()
        with precision(BITS):
            turns = (self.certified_turn(start, end, smallest) for start, end in upper or cell.edges)
            return _whole(sum(turns, arb(0)) / (arb.pi() if upper else 2 * arb.pi()))

    def count_right(self, low: float, high: float, angle: float = pi / 2) -> int:
        """Return the number of roots on the right with ``low < ln(abs(s)) < high``: proved."""
        smallest = max(SMALLEST, 1e-9 * max(high - low, pi))
        above, below = complex(high, angle), complex(low, angle)
        try:
            turn = self.certified_turn(above, below, smallest)
        except RootOnPathError as error:
            raise RootOnAxisError from error
        with precision(BITS):
            turn += self.certified_turn(complex(high, 0.0), above, smallest)
            turn += self.certified_turn(below, complex(low, 0.0), smallest)
            return _whole(turn / arb.pi())

    def count_within(self, z: float, left: float) -> int:
        """Return the number of roots with ln(abs(s)) below ``z``, also at 0: proved, up to ``left``."""
        turn = self.certified_turn(complex(z, 0.0), complex(z, left))
        with precision(BITS):
            if not self.function.is_paired:
                turn = (turn + self.certified_turn(complex(z, -left), complex(z, 0.0))) / 2
            return _whole(turn / _angle(left))

    def certified_turn(self, start: complex, end: complex, smallest: float = SMALLEST) -> arb:
        """Return a ball around the change of the argument [rad] from ``start`` straight to ``end``, in z."""
        if (end, start) in self._turns:
            return -self._turns[end, start]
        if (start, end) not in self._turns:
            length = abs(end - start)
            with precision(BITS):
                turn, self._bits = self._follow(
                    LogarithmicLine(start, end), length, smallest / length, self._bits
                )
            self._turns[start, end] = turn
        return self._turns[start, end]

    def _follow(self, path: LogarithmicLine, length: float, smallest: float, bits: int) -> tuple[arb, int]:
        """Return the change of the argument along a path, and the precision that it took."""
        tries_series = self._tries_series

        def change(start: float, end: float) -> tuple[float, arb]:
            nonlocal bits, tries_series
            self.spend()
            with precision(bits):
                off, turn = self._change(path, start, end, bits, tries_series=tries_series)
            tries_series = tries_series or (off <= ROOM and _is_lossy(off, turn))
            if off == inf:
                # Perhaps it is not the step that is too long, but the precision that is too low.
                bits = self._sufficient(path.point((start + end) / 2), bits)
            return off, turn

        turn = total_turn(change, FIRST_STEP / length, smallest)
        return turn, bits

    def _change(
        self, path: LogarithmicLine, start: float, end: float, bits: int, *, tries_series: bool = False
    ) -> tuple[float, arb]:
        """Return a bound on how far arg F may turn on a step, and how far it turns from end to end."""
        ball, centre, reach = path.step(start, end)
        here, there = path.point(start), path.point(end)
        by_exponentials = self.function.turn_of_exponentials(ball, here, there, bits)
        if by_exponentials is not None:
            if tries_series and (by_exponentials[0] > ROOM or _is_lossy(*by_exponentials)):
                by_series = self._series.change(centre, reach, here, there, bits)
                return min(by_series, by_exponentials, key=lambda values: values[0])
            return by_exponentials
        if self.function.cancels:
            return self._series.change(centre, reach, here, there, bits)
        values = self.function.enclosed_about(ball, centre, bits)
        off = 0.0
        for value, slope, exponent in values:
            size, change = value.abs_lower(), (slope * reach).abs_upper()
            if not change.is_finite() or not size > 0:
                return inf, arb(0)
            off += abs(exponent) * angle(change, size)
        off *= self.function.power
        if off > ROOM:
            return off, arb(0)
        # Both ends of every factor lie within a right angle of its middle.
        factors = zip(self.function.enclosed(here, bits), self.function.enclosed(there, bits), strict=True)
        turn = sum((e * (last / first).arg() for (first, _, e), (last, _, _) in factors), arb(0))
        return off, turn * self.function.power

    def _sufficient(self, s: acb, bits: int) -> int:
        """Return a precision at which no factor of F is lost at a point."""
        for enough in precisions(bits, max(LAST_BITS, 4 * s.bits())):
            with precision(enough):
                factors = self.function.enclosed(s, enough)
                if all(value.is_finite() and not value.contains(0) for value, _, _ in factors):
                    return enough
        raise RootOnPathError


def _angle(value: float) -> arb:
    """Return an imaginary part of z, where a double stands for pi or pi/2 if it is the nearest one."""
    for known, exact in ((pi, arb.pi()), (pi / 2, arb.pi() / 2)):
        if abs(value) == known:
            return exact if value > 0 else -exact
    return arb(value)


def _is_lossy(off: float, turn: arb) -> bool:
    return bool(abs(turn) < LOSSY * off)


def _whole(turns: arb) -> int:
    """Return the only integer in a ball."""
    count = turns.unique_fmpz()
    if count is None:
        raise RootOnPathError
    return int(count)
