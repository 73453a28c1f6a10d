"""What stands at a node: bodies, supports, what hangs down to the ground, marks of inputs and outputs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise
from typing import Final

from symflex.drawing.cells import SPACE, label_of, tags_of
from symflex.drawing.geometry import BOLD, FILLED, LINE, THIN, Placed, around, union
from symflex.drawing.lettering import SMALL, text
from symflex.drawing.scheme import DrawnPart, Mark, Style
from symflex.drawing.symbols import Strokes, arc, arrow, circle, head, line, rectangle, turning
from symflex.library.elements import CIRCUITS, COMPONENTS

DISC_WIDTH, DISC_HEIGHT = 9.0, 34.0
REACH: Final = 7.0  # how far a bar or body goes beyond the wires that meet it
FLAT, SHOE = 2.4, 8.0  # the same of a node on a member, and of one in a guide
LANE: Final = 7.0  # width of a lane for a lead upwards or downwards
ARROW: Final = 11.0  # width of an arrow that stands upright, with the space before its text
UPRIGHT: Final = ("lift", "turn", "probe", "push", "torque", "raise", "twist")  # at nodes; others run along x
HANGING: Final = 24.0  # length of what hangs from a node, where its symbol says nothing


@dataclass
class Column:
    """A node, what stands at it and how far that reaches."""

    name: str
    kind: str  # domain of the node
    bodies: list[DrawnPart] = field(default_factory=list)
    supports: list[DrawnPart] = field(default_factory=list)  # below the node
    # Supports beside it, -1 to the left and 1 to the right.
    faces: dict[int, DrawnPart] = field(default_factory=dict)
    hanging: list[DrawnPart] = field(default_factory=list)
    stubs: list[DrawnPart] = field(default_factory=list)  # join it to the ground, and stand lower
    marks: list[Mark] = field(default_factory=list)
    has_lead_up: bool = False
    outside: int = 0  # on which side of it the row ends: -1 on the left, 1 on the right, 0 on none or both
    levels: list[float] = field(default_factory=list)  # of wires that meet it
    # Where the node is, how far its body reaches to both sides, up (with labels) and down.
    x: float = 0.0
    half: float = 0.0
    top: float = 0.0
    bottom: float = 0.0
    crown: float = 0.0  # height of labels above the body
    # How much room it takes in the row to both sides.
    left: float = 0.0
    right: float = 0.0

    @property
    def is_flat(self) -> bool:
        """Whether it moves across the row."""
        return self.kind in COMPONENTS

    @property
    def is_electrical(self) -> bool:
        """Whether it is a wire."""
        return self.kind in CIRCUITS

    @property
    def upright(self) -> list[Mark]:
        """The marks that stand side by side on it."""
        return [m for m in self.marks if m.style in UPRIGHT]

    @property
    def first_mark(self) -> float:
        """Where its first upright mark begins."""
        start = self.x - max(self.half, ARROW / 2)
        if self.upright and (self.has_lead_up or len(self.upright) < len(self.marks)):
            return max(start + LANE, self.x + LANE / 2 if self.half < ARROW / 2 else start)
        return start

    @property
    def lead_x(self) -> float:
        """Where a lead goes up from it: before what stands there."""
        return self.first_mark - LANE / 2 if self.upright else self.x

    @property
    def is_round(self) -> bool:
        """Whether it is the end of a member, or a wheel there, and no box on which parts could stand."""
        return self.is_flat and all(p.type_name == "inertia" for p in self.bodies)

    @property
    def below(self) -> list[tuple[float, float]]:
        """Where supports and parts that hang, side by side or outside, begin and end from the node."""
        holds, hangs = [*map(support_width, self.supports)], [*map(hanging_width, self.hanging)]
        outside = self.outside if self.is_round and (holds or len(hangs) > 1) else 0
        x = -sum(holds) / 2 - (0.0 if outside else sum(hangs) / 2)
        at = x - sum(hangs) if outside < 0 else x + sum(holds)
        places = (accumulate(holds, initial=x), accumulate(hangs, initial=at))
        return [ends for each in places for ends in pairwise(each)]

    def resize(self, size: float) -> None:
        """Find how far it reaches; masses are at least so large."""
        low, high = min(self.levels, default=0.0), max(self.levels, default=0.0)
        sizes = [body_size(p, self.kind, size) for p in self.bodies]
        widths, heights = [w for w, _ in sizes], [h for _, h in sizes]
        start = min((x for x, _ in self.below), default=0.0)
        end = max((x for _, x in self.below), default=0.0)
        lane = LANE if self.below and self.stubs else 0.0
        middle, spread = (high + low) / 2, high - low + 2 * REACH
        if not sizes:
            is_shoe = self.is_flat and any(p.type_name == "slider" for p in self.faces.values())
            is_bar = not self.is_electrical and (high > low or self.kind == "translation")
            reach = SHOE if self.faces else FLAT if self.is_flat else REACH if is_bar else 0.0
            tall, self.half = high - low + 2 * reach, SHOE / 2 * is_shoe
        elif self.kind == "rotation":
            self.crown = max(heights) + SPACE
            tall, self.half = max(DISC_HEIGHT, spread), sum(widths) / 2
        else:
            tall = max(sum(heights), spread)
            self.half = max(*widths, 0.0 if self.is_round else end - start + 2 * lane) / 2
        self.top, self.bottom = middle + tall / 2 + self.crown, middle - tall / 2
        marks = sum(map(upright_width, self.upright))
        least = max(self.half, ARROW / 2 if marks else 1.0)
        self.left = max(least, lane - start)
        self.right = max(least, lane + end, self.first_mark + marks)


def body_size(part: DrawnPart, kind: str, size: float) -> tuple[float, float]:
    """Return width and height of a mass; of a moment of inertia, its width and the height of its label."""
    block = label_of(part).box
    if kind == "rotation":
        return max(DISC_WIDTH, block.width + 2), block.height
    is_wide = part.type_name == "rigid_body"
    wide = max(size + 12 if is_wide else size, block.width + size / 3, 2 * _arm(part) + 12)
    tall = max(size, block.height + (17 if is_wide else 8))
    return (wide, max(wide, tall)) if part.type_name == "inertia" else (wide, tall)


def bodies(column: Column, size: float) -> list[Placed]:
    """Draw masses as boxes one above the other, and moments of inertia as discs on the shaft."""
    drawn: list[Placed] = []
    sizes = [body_size(p, column.kind, size) for p in column.bodies]
    if column.kind == "rotation":
        x = column.x - column.half
        middle = (column.top - column.crown + column.bottom) / 2
        if len(sizes) > 1 or column.half > DISC_WIDTH / 2:
            axis = line((x, middle), (x + 2 * column.half, middle), width=BOLD)
            drawn.append(Placed("wire", column.name, (axis,)))
        for part, (width, _) in zip(column.bodies, sizes, strict=True):
            label, at, top = label_of(part), x + width / 2, column.top - column.crown
            disc = rectangle(at - DISC_WIDTH / 2, column.bottom, at + DISC_WIDTH / 2, top, FILLED)
            drawn.append(Placed(part.kind, part.name, (disc,)))
            drawn.append(label.moved(at, top + SPACE - label.box.y0))
            x += width
        return drawn
    y = column.top
    spare = (column.top - column.bottom - sum(h for _, h in sizes)) / max(1, len(sizes))
    for part, (_, height) in zip(column.bodies, sizes, strict=True):
        drawn += _mass(part, column, y - height - spare, y)
        y -= height + spare
    return drawn


def _mass(part: DrawnPart, column: Column, y0: float, y1: float) -> list[Placed]:
    x, middle = column.x, (y0 + y1) / 2
    strokes: Strokes = (rectangle(x - column.half, y0, x + column.half, y1, FILLED),)
    if part.type_name == "inertia":
        strokes = (circle(x, middle, min(column.half, (y1 - y0) / 2), FILLED),)
    if part.type_name == "rigid_body":
        middle = (y0 + 9 + y1) / 2
        strokes += _mass_centre(part, x, column.half, y0 + 6)
    label = label_of(part)
    label = label.moved(x, middle - label.box.centre[1])
    if offset := text(part.centre[0], SMALL):
        label_x = x + 2.5 - (offset.width + 5 if part.centre[1] > 0 else 0.0)
        moved = offset.moved(label_x, y0 + 6 - (offset.height - offset.depth) / 2)
        label = replace(label, texts=(*label.texts, moved))
    return [Placed(part.kind, part.name, strokes), label]


def _arm(part: DrawnPart) -> float:
    """Return how far the mass centre of a body is drawn from its node, with room for its label beyond."""
    offset = text(part.centre[0], SMALL)
    return max(13.0, offset.width) if offset else 0.0


def _mass_centre(part: DrawnPart, x: float, half: float, y: float) -> Strokes:
    """Draw the mass centre, and how far it is from the node, which stands in the middle of its body."""
    cx = x + min(_arm(part), half - 5) * part.centre[1]
    cross = (line((cx - 3, y), (cx + 3, y), width=THIN), line((cx, y - 3), (cx, y + 3), width=THIN))
    centre = (circle(cx, y, 3.0), *cross)
    if cx == x:
        return centre
    length = arrow((x, y), (cx - 3 * part.centre[1], y), THIN)
    return (line((x, y - 3.5), (x, y + 3.5), width=THIN), *length, *centre)


def support_width(part: DrawnPart) -> float:
    """Return how wide a support below a node is."""
    tags = [one.width + 2 for one in tags_of(part)]
    return max([around(p for s in part.symbol.hold() for p in s.points).width, *tags]) + 3


def tags_below(part: DrawnPart, x: float, y: float) -> list[Placed]:
    """Write what outputs show of a support below it, centred."""
    tags = []
    for one in tags_of(part):
        y -= one.above + SPACE
        tags += [i.moved(x - one.width / 2 + 10, y) for i in one.placed]
        y += one.below
    return tags


def hanging_length(part: DrawnPart) -> float:
    """Return how long a part that hangs from a node is."""
    return HANGING if part.symbol.role in ("source", "coupling") else part.symbol.length


def hanging_reach(part: DrawnPart) -> tuple[float, float]:
    """Return how far its symbol reaches to the left and to the right of its line."""
    box = around(p for s in part.symbol.draw(hanging_length(part)) for p in s.points)
    return max(7.0, -box.y0), max(6.0, box.y1)


def hanging_texts(part: DrawnPart, x: float, y: float) -> list[Placed]:
    """Write what belongs to a part that hangs from x on, its middle at y."""
    label = label_of(part)
    blocks = [*([(label,)] if label.texts else []), *(one.placed for one in tags_of(part))]
    boxes = [union(i.box for i in block) for block in blocks]
    y += sum(b.height + 3 for b in boxes) / 2
    hanging = []
    for block, box in zip(blocks, boxes, strict=True):
        y -= box.height + 1.5
        hanging += [i.moved(x - box.x0, y - box.y0) for i in block]
        y -= 1.5
    return hanging


def hanging_width(part: DrawnPart) -> float:
    """Return how wide it is with its texts."""
    left, right = hanging_reach(part)
    return left + right + SPACE + union(i.box for i in hanging_texts(part, 0.0, 0.0)).width + 5


def labels_width(mark: Mark) -> float:
    """Return how wide the labels of a mark are side by side, with the space after each."""
    return sum(t.width + 4 for _, _, label in mark.labels if (t := text(label)))


def upright_width(mark: Mark) -> float:
    """Return how wide an upright mark is with its texts."""
    return ARROW + labels_width(mark)


def mark_of_source(part: DrawnPart, *, is_flat: bool = True) -> Mark:
    """Return the arrow of a source at one node, which moves across the row or in its plane, or along."""
    end = part.ends[0]
    style: Style = "push" if is_flat and end.component != "x" else "force"
    label = r",\,".join((part.label, *part.lines))
    parts = (("element", part.name, label), *part.tags)
    return Mark("torque" if end.domain == "rotation" else style, end.node, parts)


def upright_mark(mark: Mark, x: float, foot: float) -> list[Placed]:
    """Draw an arrow upwards or about a node, or a probe, from x on."""
    middle, y = x + 5, foot + 14
    kind, name, _ = mark.labels[0]
    strokes: Strokes
    match mark.style:
        case "lift":
            datum = line((middle - 3, foot + 2), (middle + 3, foot + 2), width=THIN)
            strokes = (datum, *arrow((middle, foot + 2), (middle, y), LINE))
        case "push":
            strokes = arrow((middle, foot), (middle, y + 2), BOLD)
        case "raise":
            strokes = arrow((middle, foot + 1), (middle, y), LINE, is_double=True)
        case "probe":
            strokes = (line((middle, foot), (middle, y - 4), width=THIN), circle(middle, y - 2.5, 1.5))
        case "turn":
            tip = head((middle - 4.2, foot + 5.6), (0.15, -0.98), 3.4)
            strokes = (arc(middle, foot + 7, 4.2, -50, 190, LINE), tip)
        case _:
            strokes = turning(middle, foot + 7, 4.6)
    return [Placed(kind, name, strokes), *texts_of_mark(mark, x + ARROW, foot + 5)]


def texts_of_mark(mark: Mark, x: float, y: float) -> list[Placed]:
    """Write the labels of a mark side by side from x on; those after the first stand for themselves."""
    texts = []
    for i, (kind, name, label) in enumerate(mark.labels):
        shown = text(label if i == len(mark.labels) - 1 else f"{label},")
        if shown is None:
            continue
        texts.append(Placed(kind if i else "label", name, (), (shown.moved(x, y),)))
        x += shown.width + 2
    return texts


def flat_mark(mark: Mark, x: float, foot: float) -> list[Placed]:
    """Draw an arrow along x above a node, from a datum."""
    kind, name, _ = mark.labels[0]
    y = foot + 4
    bold = BOLD if mark.style == "force" else LINE
    strokes = arrow((x, y), (x + 15, y), bold, is_double=mark.style == "motion")
    datum = line((x, foot), (x, foot + 8), width=THIN)
    return [Placed(kind, name, (*strokes, datum)), *texts_of_mark(mark, x + 18, foot + 1.5)]


def flat_width(mark: Mark) -> float:
    """Return how far such a mark reaches beyond its datum."""
    return 18 + labels_width(mark)
