"""What a drawing is made of: boxes, strokes, texts, and what they stand for; lengths in points, y upwards."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

Point = tuple[float, float]
THIN, LINE, BOLD, MEMBER = 0.5, 0.8, 1.6, 2.6
"""Widths of strokes [points]: of dimensions, of symbols, of shafts and forces, of rigid links."""
PLAIN, FILLED, PAPER = "", "#E3E3E3", "#FFFFFF"
"""What an outline is filled with: nothing, the grey of bodies, the page."""
BLACK = "#000000"


@dataclass(frozen=True, slots=True)
class Extent:
    """A rectangle with sides along x and y."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width(self) -> float:
        """Its extent along x."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """Its extent along y."""
        return self.y1 - self.y0

    @property
    def centre(self) -> Point:
        """Its middle."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    def moved(self, dx: float, dy: float) -> Extent:
        """Return the rectangle elsewhere."""
        return Extent(self.x0 + dx, self.y0 + dy, self.x1 + dx, self.y1 + dy)

    def grown(self, by: float) -> Extent:
        """Return the rectangle with a border around it."""
        return Extent(self.x0 - by, self.y0 - by, self.x1 + by, self.y1 + by)

    def overlaps(self, other: Extent) -> bool:
        """Tell whether two rectangles share more than an edge."""
        return self.x0 < other.x1 and other.x0 < self.x1 and self.y0 < other.y1 and other.y0 < self.y1


def around(points: Iterable[Point]) -> Extent:
    """Return the smallest rectangle around points."""
    xs, ys = zip(*points, strict=True)
    return Extent(min(xs), min(ys), max(xs), max(ys))


def union(boxes: Iterable[Extent]) -> Extent:
    """Return the smallest rectangle around rectangles; around none an empty one at the origin."""
    corners = [p for b in boxes for p in ((b.x0, b.y0), (b.x1, b.y1))]
    return around(corners or [(0.0, 0.0)])


def free_level(room: Extent, limit: float, occupied: Sequence[Extent], *, is_up: bool) -> float:
    """Return how far a rectangle is moved up (or down) from a limit until nothing is in its way."""
    y = limit - (room.y0 if is_up else room.y1)
    beside = [b for b in occupied if b.x0 < room.x1 and room.x0 < b.x1]
    while hit := [b for b in beside if b.overlaps(room.moved(0, y))]:
        y = max(b.y1 for b in hit) - room.y0 + 0.1 if is_up else min(b.y0 for b in hit) - room.y1 - 0.1
    return y


@dataclass(frozen=True, slots=True)
class Stroke:
    """A line through points, closed and filled where it is an outline."""

    points: tuple[Point, ...]
    width: float = LINE
    fill: str = PLAIN  # a colour; an outline is closed
    is_dashed: bool = False


@dataclass(frozen=True, slots=True)
class Lettering:
    """A line of mathematics with its baseline's left end at a point; its size was measured."""

    markup: str  # between dollar signs, as matplotlib reads it
    x: float
    y: float
    width: float
    height: float  # above the baseline
    depth: float  # below it
    size: float  # of the type [points]

    @property
    def box(self) -> Extent:
        """The rectangle of its letters."""
        return Extent(self.x, self.y - self.depth, self.x + self.width, self.y + self.height)

    def moved(self, dx: float, dy: float) -> Lettering:
        """Return the text elsewhere."""
        return replace(self, x=self.x + dx, y=self.y + dy)


@dataclass(frozen=True, slots=True)
class Placed:
    """A part of a drawing and what it stands for.

    ``kind`` is ``element``, ``input``, ``output``, ``block``, ``sum``, ``field``, ``ground``, ``node``,
    ``wire`` or ``label``, the text of another part; ``name`` is the name in the specification.
    """

    kind: str
    name: str
    strokes: tuple[Stroke, ...] = ()
    texts: tuple[Lettering, ...] = ()

    @property
    def box(self) -> Extent:
        """The rectangle around it, line widths left out."""
        return union((*(around(s.points) for s in self.strokes), *(t.box for t in self.texts)))

    def scaled(self, by: float) -> Placed:
        """Return the part larger or smaller, with its strokes and type."""
        sizes = ((t, (t.x, t.y, t.width, t.height, t.depth, t.size)) for t in self.texts)
        texts = (Lettering(t.markup, *(by * v for v in measures)) for t, measures in sizes)
        return self._mapped(lambda x, y: (by * x, by * y), texts, by)

    def moved(self, dx: float, dy: float) -> Placed:
        """Return the part elsewhere."""
        return self._mapped(lambda x, y: (x + dx, y + dy), (t.moved(dx, dy) for t in self.texts))

    def _mapped(
        self, image: Callable[[float, float], Point], texts: Iterable[Lettering], by: float = 1.0
    ) -> Placed:
        """Return the part with every point of its strokes elsewhere, its lines thicker, and other texts."""
        moved = ((tuple(image(*p) for p in s.points), s) for s in self.strokes)
        strokes = tuple(replace(s, points=points, width=by * s.width) for points, s in moved)
        return replace(self, strokes=strokes, texts=tuple(texts))

    @property
    def extents(self) -> tuple[Extent, ...]:
        """Rectangles that cover it, small ones along what is slanted."""
        boxes = [t.box for t in self.texts]
        for stroke in self.strokes:
            box, is_simple = around(stroke.points), len(stroke.points) <= MOST_CORNERS
            if not is_simple and box.width > LARGE:
                boxes += [around(ends) for ends in pairwise(stroke.points)]
            elif not (is_simple and any(_is_slanted(*ends) for ends in pairwise(stroke.points))):
                boxes.append(box)
            else:
                boxes += [piece for ends in pairwise(stroke.points) for piece in _pieces(*ends)]
        return tuple(boxes)

    def rotated(self, dx: float, dy: float) -> Placed:
        """Return a part turned about the origin, so that x runs in a direction; its texts stay upright."""

        def turned(x: float, y: float) -> Point:
            return dx * x - dy * y, dy * x + dx * y

        texts = []
        for one in self.texts:
            (x, y), (to_x, to_y) = one.box.centre, turned(*one.box.centre)
            texts.append(one.moved(to_x - x, to_y - y))
        return self._mapped(turned, texts)


def upright(items: Sequence[Placed]) -> Sequence[Placed]:
    """Return parts of a row turned so that x runs upwards, or as they are where texts would cover any."""
    runs: list[list[Placed]] = []  # texts side by side stay there
    for item in items:
        before, first = runs[-1][-1].texts if runs else (), item.texts if not item.strokes else ()
        gap = first[0].x - before[-1].box.x1 if before and first and before[-1].y == first[0].y else NEXT
        runs = [*runs[:-1], [*runs[-1], item]] if 0 < gap < NEXT else [*runs, [item]]
    standing: list[Placed] = []
    for run in runs:
        extent = union(around(s.points) for i in items if i.name == run[0].name for s in i.strokes)
        box = union(t.box for item in run for t in item.texts)
        (x, y), longer = box.centre, (box.width - box.height) / 2
        aside, along = (
            (z > high) - (z < low) for z, low, high in ((y, extent.y0, extent.y1), (x, extent.x0, extent.x1))
        )
        # Above an arrow a long text ends not far beyond it.
        dx = -y - (aside * longer if aside else max(0.0, box.width / 2 - BEYOND) * along)
        dy = x if aside else x - along * longer
        standing += [
            replace(i.rotated(0, 1), texts=tuple(t.moved(dx - x, dy - y) for t in i.texts)) for i in run
        ]
    texts = [(i.name, t.box) for i in standing for t in i.texts]
    strokes = [(i.name, b) for i in standing for b in replace(i, texts=()).extents]
    is_crossed = any(t.overlaps(b) for name, t in texts for other, b in strokes if other != name)
    return (
        items if is_crossed or any(a.overlaps(b) for (_, a), (_, b) in combinations(texts, 2)) else standing
    )


NEXT, BEYOND = 3.0, 6.0  # between the texts of one mark, and beyond its arrow [points]
MOST_CORNERS, LARGE = 6, 36.0  # largest slanted member; with more corners, a symbol or a taper [points]
_SHORT, _PIECE = 20.0, 3.0


def _is_slanted(a: Point, b: Point) -> bool:
    shorter, longer = sorted((abs(a[0] - b[0]), abs(a[1] - b[1])))
    return shorter > 1.0 and longer > _SHORT / 2


def _pieces(a: Point, b: Point) -> Iterator[Extent]:
    """Yield rectangles along a line."""
    count = max(1, int(max(abs(a[0] - b[0]), abs(a[1] - b[1])) / _PIECE))
    points = [(a[0] + (b[0] - a[0]) * i / count, a[1] + (b[1] - a[1]) * i / count) for i in range(count + 1)]
    yield from (around(pair) for pair in pairwise(points))


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing that is laid out: its parts, in points, from the lower left corner of the page."""

    width: float  # of the page [points]
    height: float
    items: tuple[Placed, ...]
    abbreviated: tuple[str, ...] = ()  # elements that stand in a row of dots

    def scaled(self, by: float) -> Drawing:
        """Return the drawing larger or smaller."""
        items = tuple(i.scaled(by) for i in self.items)
        return replace(self, width=by * self.width, height=by * self.height, items=items)
