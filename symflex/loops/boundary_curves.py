"""Curves in a chart of two parameters on which a pole lies on the imaginary axis, with its frequency.

Input: a characteristic function, the ranges of two parameters, and boxes with the pieces of the axis that are
open there. Output: curves, as points that are proved to lie on them.

Example: ``s + a exp(-s T)`` has a root on the axis where a T = pi/2 and omega = a; (1, 1.5707963..., 1) is a
point. From one to the next the tangent is followed, and Newton's method returns to the curve while one
parameter rests. Interval Newton proves a root about every point (Hansen 1968), with that parameter at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from math import floor, hypot

from flint import acb, arb, fmpz_mpoly

from symflex.balls import Pair, precision, status_of, two_steps
from symflex.budget import spend
from symflex.errors import BudgetError
from symflex.loops.boxes import BITS, Box, CharacteristicFunction, FirstOrder, OpenBox
from symflex.transfer import TransferFunction

Point = tuple[float, float, float]  # two parameters in parts of their ranges, and a frequency [rad/s]
LONGEST, SHORTEST = 1 / 64, 1e-6  # steps along a curve, in parts of the ranges
BEND = 0.1  # part of a step by which a curve may leave its tangent
NEWTON_STEPS, CONVERGED = 6, 1e-12  # Newton steps to a curve; the last step, in parts of the ranges
RADIUS, ROOM = 1e-9, 100  # where a root is certified about a point, in parts of a range; of the frequency
MOST_POINTS = 2000
ALIKE = 0.05  # part by which frequencies of one curve at one place may differ


@dataclass(frozen=True, eq=False)
class Tracer:
    """One polynomial of a characteristic function, followed over two parameters."""

    function: CharacteristicFunction
    ranges: Box
    tf: TransferFunction
    polynomials: tuple[fmpz_mpoly, ...]
    which: int

    def steps(
        self, point: Point, free: int, reach: float = 0.0, rise: float = 0.0
    ) -> tuple[list[arb], Pair] | None:
        """Return the slopes within ``reach`` and ``rise``, and Newton's steps of parameter and frequency."""
        spend()
        ends = []
        for k, (low, high) in enumerate(self.ranges):
            wide = Fraction(reach) if k == free else Fraction(0)
            x, size = Fraction(point[k]), high - low
            ends.append((low + size * (x - wide), low + size * (x + wide)))
        values = FirstOrder(self.function, self.tf, self.polynomials, tuple(ends))
        near = values.generators(acb(0, arb(point[2], rise)))
        ((_, slope),) = values.around(acb(0), [self.which], near)
        ((value, slopes),) = values.at(acb(0, arb(point[2])), [self.which], near)
        turn = slope * acb(0, 1)
        sizes = [float(high - low) for low, high in self.ranges]
        by_parts = [each * size for each, size in zip(slopes, sizes, strict=True)]
        steps = two_steps(value, by_parts[free], turn)
        return None if steps is None else ([(each / turn).imag for each in by_parts], steps)

    def corrected(self, point: Point, free: int) -> Point | None:
        """Return the point of the curve with the other parameter as it is; None unless it is proved."""
        x, omega = point[free], point[2]
        for _ in range(NEWTON_STEPS):
            known = self.steps(_moved(point, free, x, omega), free)
            if known is None:
                return None
            step, climb = (float(each.mid()) for each in known[1])
            if abs(step) > LONGEST or (omega and abs(climb) > omega / 2):
                return None
            x, omega = x - step, omega - climb if omega else omega
            if abs(step) < CONVERGED and abs(climb) <= CONVERGED * omega:
                break
        found, rise = _moved(point, free, x, omega), ROOM * RADIUS * omega
        known = self.steps(found, free, RADIUS, rise)
        if known is None:
            return None
        unknowns = 2 if omega else 1  # a real root rests at 0
        status = status_of(known[1][:unknowns], (arb(RADIUS), arb(rise))[:unknowns])
        return found if status == "one" else None

    def traced(self, start: Point) -> list[Point]:
        """Return a curve through a point of it, to the ends of the ranges, or as far as it is proved."""
        ahead = list(self._one_way(start, 1.0))
        if ahead and ahead[-1] == start:
            return [start, *ahead]
        return [*list(self._one_way(start, -1.0))[::-1], start, *ahead]

    def _one_way(self, start: Point, way: float) -> Iterator[Point]:
        point, size, before = start, LONGEST / 4, (0.0, 0.0)
        for count in range(MOST_POINTS):
            known = self.steps(point, 0) or self.steps(point, 1)
            if known is None:
                return
            across, up = (float(x.mid()) for x in known[0])
            length = hypot(across, up)
            tangent = (-up / length * way, across / length * way)
            if before[0] * tangent[0] + before[1] * tangent[1] < 0:  # what it is divided by changed its sign
                way, tangent = -way, (-tangent[0], -tangent[1])
            held = int(abs(tangent[1]) > abs(tangent[0]))
            while size > SHORTEST:
                part = size
                if not 0 <= (aim := point[held] + size * tangent[held]) <= 1:
                    part = (float(aim > 1) - point[held]) / tangent[held]
                guess = (point[0] + part * tangent[0], point[1] + part * tangent[1], point[2])
                guess = _moved(guess, held, float(aim > 1) if part < size else guess[held], point[2])
                new = self.corrected(guess, 1 - held) if part > 0 else None
                if new and abs(new[1 - held] - guess[1 - held]) < BEND * size:
                    break
                size /= 2
            else:
                return
            if not 0 <= new[1 - held] <= 1:
                edge = _moved(new, 1 - held, float(new[1 - held] > 1), new[2])
                if (end := self.corrected(edge, held)) and 0 <= end[held] <= 1:
                    yield end
                return
            if count > 2 and _are_near(start, new, size):  # noqa: PLR2004 (it has left its start)
                yield start
                return
            yield new
            if part < size:
                return
            point, before, size = new, tangent, min(1.5 * size, LONGEST)


def _are_near(a: Point, b: Point, size: float) -> bool:
    return max(abs(a[0] - b[0]), abs(a[1] - b[1])) < size and abs(a[2] - b[2]) <= ALIKE * a[2]


def _moved(point: Point, which: int, x: float, omega: float) -> Point:
    return (point[0], x, omega) if which else (x, point[1], omega)


def boundary_curves(
    function: CharacteristicFunction, ranges: Box, boxes: Sequence[OpenBox]
) -> tuple[list[list[Point]], str]:
    """Return the curves that pass the boxes, with parameters in SI units, and why some may be missing."""
    lows, sizes = [low for low, _ in ranges], [high - low for low, high in ranges]
    curves: list[list[Point]] = []
    missing = ""
    with precision(BITS):
        try:
            for curve in _traced(function, ranges, boxes):
                curves.append(curve)
        except BudgetError as error:
            missing = error.diagnostics[0].message
    # The ends do not belong to the ranges.
    inner = [c for c in curves if not any({p[k] for p in c} in ({0.0}, {1.0}) for k in (0, 1))]
    (u, v), (a, b) = map(float, lows), map(float, sizes)
    return [[(u + a * x, v + b * y, w) for x, y, w in curve] for curve in inner], missing


def _traced(function: CharacteristicFunction, ranges: Box, boxes: Sequence[OpenBox]) -> Iterator[list[Point]]:
    """Yield the curves, with parameters as shares of their ranges."""
    lows, sizes = [low for low, _ in ranges], [high - low for low, high in ranges]
    parts = max(
        (size / (b - a) for box in boxes for size, (a, b) in zip(sizes, box.box, strict=True)), default=1
    )
    passed: dict[tuple[int, int], list[float]] = {}
    for box in boxes:
        x, y = (
            float(((a + b) / 2 - low) / size) for (a, b), low, size in zip(box.box, lows, sizes, strict=True)
        )
        here = floor(x * parts), floor(y * parts)
        for tf, polynomials, which, low, high in _starts(function, box):
            if any(low * (1 - ALIKE) <= w <= high * (1 + ALIKE) for w in passed.get(here, ())):
                continue
            tracer = Tracer(function, ranges, tf, polynomials, which)
            guess = (x, y, (low + high) / 2)
            start = tracer.corrected(guess, 0) or tracer.corrected(guess, 1)
            if start is None or max(abs(start[0] - x), abs(start[1] - y)) * parts > 1:
                continue
            curve = tracer.traced(start)
            yield curve
            for one, two in pairwise(curve):
                count = int(2 * parts * max(abs(one[0] - two[0]), abs(one[1] - two[1]))) + 1
                for k in range(count + 1):
                    u, v, w = (a + (b - a) * k / count for a, b in zip(one, two, strict=True))
                    for i, j in product((-1, 0, 1), (-1, 0, 1)):
                        passed.setdefault((floor(u * parts) + i, floor(v * parts) + j), []).append(w)


def _starts(
    function: CharacteristicFunction, box: OpenBox
) -> Iterator[tuple[TransferFunction, tuple[fmpz_mpoly, ...], int, float, float]]:
    """Return what may vanish in a box, and from where to where on the axis [rad/s]."""
    for i, pieces in enumerate(box.pieces):
        for low, high in pieces:
            if not low:
                resting = function.at_rest
                yield from ((*resting, k, 0.0, 0.0) for k in range(len(resting[1])))
            yield function.tf, function.factors, i, float(low), float(high)
