"""Dashed wires that join a block diagram to the mechanics: from what a sensor reads, to where a source acts.

Input: a drawing, and what is to be joined. Output: the wires that find a way, each a part of its own.

    [m]--k--[m]      A wire leaves the right mass, runs between the drawing and the diagram below it, and ends
     :        :      at the name x_tip there. It bends as little as it can, crosses other wires only where it
     '--[K]<--'      must, and nothing else. Where there is no way the names on both sides have to do.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from heapq import heappop, heappush
from itertools import pairwise
from typing import Final

from symflex.drawing.geometry import BLACK, THIN, Drawing, Extent, Placed, Point, Stroke, around, union
from symflex.drawing.symbols import circle, head

CELL: Final = 2.5  # width of the grid on which wires are routed [points]
CLEAR: Final = 1.6  # space between a wire and what it passes
BEND, CROSSING, STRIKING = 8.0, 24.0, 60.0
"""What a corner, a dashed wire that is crossed, and another line that is, cost in cells of length."""
LONGEST: Final = 300.0  # cost of a way that would rather confuse
STEPS: Final = ((1, 0), (-1, 0), (0, 1), (0, -1))
Cell = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Join:
    """What is to be joined: a name, and the rectangles where its wire may begin and end."""

    name: str
    starts: tuple[Extent, ...]
    ends: tuple[Extent, ...]
    otherwise: tuple[Extent, ...] = ()  # where it may end if it cannot end there


def joined(drawing: Drawing, joins: Sequence[Join]) -> tuple[Placed, ...]:
    """Return the wires of what can be joined, in order."""
    solid = [box for item in drawing.items if item.kind not in ("wire", "node") for box in item.extents]
    blocked: set[Cell] = set()
    crossed: dict[Cell, float] = {}  # and what that costs
    for item in drawing.items:
        is_wire = item.kind == "wire"
        for stroke in item.strokes if is_wire else ():
            for pair in pairwise(stroke.points):
                # The head of an arrow is no line that may be crossed.
                cells = _covered(around(pair), 0.5 * CELL)
                if stroke.fill:
                    blocked.update(cells)
                else:
                    crossed.update(dict.fromkeys(cells, STRIKING))
        for box in () if is_wire else item.extents:
            blocked.update(_covered(box, CLEAR))
    right, top = int(drawing.width / CELL), int(drawing.height / CELL)
    blocked.update((x, y) for x in (0, right) for y in range(top + 1))
    blocked.update((x, y) for x in range(right + 1) for y in (0, top))
    wires = list[Placed]()
    ways: dict[str, list[Point]] = {}  # the first wire of each name, from which others branch
    for one in joins:
        stem = tuple(around(pair) for pair in pairwise(ways.get(one.name, [])[:-1]))
        pairs = [pair for name, way in ways.items() if name != one.name for pair in pairwise(way)]
        passed = {cell for pair in pairs for cell in _covered(around(pair), 0.5 * CELL)}
        met = {**dict.fromkeys(passed, CROSSING), **crossed}
        branch = _best(replace(one, starts=stem), blocked, met, solid) if stem else []
        if way := branch or _best(one, blocked, met, solid):
            wires.append(_drawn(one.name, way, is_branch=bool(branch)))
            ways.setdefault(one.name, way)
    return tuple(wires)


def _best(
    one: Join, blocked: set[Cell], crossed: Mapping[Cell, float], solid: Sequence[Extent]
) -> list[Point]:
    """Return the corners of the cheapest way of a wire, or nothing."""
    points = _way(one.starts, one.ends, blocked, crossed) or _way(one.starts, one.otherwise, blocked, crossed)
    # A symbol may reach into another one's place, where a way begins or ends.
    is_struck = any(
        around(pair).grown(0.01).overlaps(box.grown(-0.3)) for pair in pairwise(points) for box in solid
    )
    return [] if is_struck else points


def _drawn(name: str, points: Sequence[Point], *, is_branch: bool) -> Placed:
    """Return a way as a dashed wire with the head of an arrow, and a dot where it leaves another one."""
    (ax, ay), tip = points[-2:]
    size = abs(tip[0] - ax) + abs(tip[1] - ay)
    d = ((tip[0] - ax) / size, (tip[1] - ay) / size)
    dashes = Stroke((*points[:-1], (tip[0] - 2 * d[0], tip[1] - 2 * d[1])), THIN, is_dashed=True)
    dot = (circle(*points[0], 0.9, fill=BLACK),) if is_branch else ()
    return Placed("join", name, (dashes, head(tip, d, 3.0), *dot))


def _centre(cell: Cell) -> Point:
    return (cell[0] + 0.5) * CELL, (cell[1] + 0.5) * CELL


def _covered(box: Extent, by: float) -> Iterator[Cell]:
    """Yield the cells whose centres lie in a rectangle with a border around it."""
    left, low, right, high = (round(v / CELL) for v in (box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by))
    yield from ((x, y) for x in range(left, right) for y in range(low, high))


def _beside(box: Extent) -> dict[Cell, Point]:
    """Return the cells straight beside a rectangle, each with the point of its border that is nearest."""
    beside = {}
    for cell in set(_covered(box, CLEAR + CELL)) - set(_covered(box, CLEAR)):
        x, y = _centre(cell)
        nearest = (min(max(x, box.x0), box.x1), min(max(y, box.y0), box.y1))
        if (nearest[0] == x) is not (nearest[1] == y):
            beside[cell] = nearest
    return beside


def _way(
    first: Sequence[Extent], last: Sequence[Extent], blocked: set[Cell], crossed: Mapping[Cell, float]
) -> list[Point]:
    """Return where the cheapest way begins, turns and ends, or nothing where there is none (A*)."""
    starts, ends = (
        {c: p for box in boxes for c, p in _beside(box).items() if c not in blocked}
        for boxes in (first, last)
    )
    if not starts or not ends:
        return []
    goal = union(Extent(x, y, x, y) for x, y in ends)

    @cache
    def left(cell: Cell) -> float:
        """Return a number of cells that the rest of a way takes at least."""
        across = max(goal.x0 - cell[0], 0.0, cell[0] - goal.x1)
        return across + max(goal.y0 - cell[1], 0.0, cell[1] - goal.y1)

    pending: list[tuple[float, Cell, int]] = []
    best: dict[tuple[Cell, int], float] = {}
    before: dict[tuple[Cell, int], tuple[Cell, int] | None] = {}
    for cell in sorted(starts):
        for d in range(len(STEPS)):
            if _leads(starts[cell], d, _centre(cell)):
                best[cell, d], before[cell, d] = 0.0, None
                heappush(pending, (left(cell), cell, d))
    seen: set[tuple[Cell, int]] = set()
    while pending:
        _, cell, d = heappop(pending)
        if (cell, d) in seen:
            continue
        seen.add((cell, d))
        if cell in ends and _leads(_centre(cell), d, ends[cell]):
            points, state = [ends[cell]], (cell, d)
            while (earlier := before[state]) is not None:
                if earlier[1] != state[1]:
                    points.append(_centre(earlier[0]))
                state = earlier
            return [starts[state[0]], *reversed(points[1:]), points[0]]
        paid = best[cell, d] + 1
        for turn, (dx, dy) in enumerate(STEPS):
            other = (cell[0] + dx, cell[1] + dy)
            if other in blocked or turn == d ^ 1:
                continue
            price = paid + BEND * (turn != d) + crossed.get(other, 0.0)
            if price + left(other) < LONGEST and price < best.get((other, turn), LONGEST):
                best[other, turn], before[other, turn] = price, (cell, d)
                heappush(pending, (price + left(other), other, turn))
    return []


def _leads(start: Point, d: int, goal: Point) -> bool:
    return (goal[0] - start[0]) * STEPS[d][0] + (goal[1] - start[1]) * STEPS[d][1] > 0
