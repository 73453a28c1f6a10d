"""Symbols with their leads and texts, each in a place of its own, about the axis y = 0 from x = 0 on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from symflex.drawing.geometry import BOLD, LINE, THIN, Placed, Stroke
from symflex.drawing.lettering import SMALL, column_of, name_latex, text
from symflex.drawing.scheme import Distance, DrawnPart, End
from symflex.drawing.symbols import (
    FORCE_BETWEEN,
    FORCE_TOGETHER,
    HATCH,
    arrow,
    box,
    earth,
    half_depth,
    head,
    line,
    mirrored,
    rectangle,
    wall,
)
from symflex.library.elements import CIRCUITS

SPACE: Final = 3.0  # space between a symbol and a text, and between texts [points]
WIDEST: Final = 80.0  # widest label at a symbol [points]; beyond it the element's name is written
PITCH: Final = {"dc_motor": 19.0}  # distance of two ends on one side of a symbol [points]
USUAL_PITCH, GROUNDED_PITCH = 9.0, 20.0
PLACES: Final = {"dc_motor": 3, "voice_coil": 3}
"""Ends for which a symbol has places of their own, where that is fewer than two on each side."""
FEEDBACK: Final = 15.0  # how far above an amplifier's axis a wire goes from its output's side to an input
INSET: Final = {"dc_motor": (0.233, 0.5)}  # how far one end, or two, reach into a symbol, in its lengths
COORDINATES: Final = ("beam", "rod", "shaft", "string")  # members with a coordinate along them
NEAR_END: Final = 4.0  # how far from an end of a member an output at that end is marked [points]
WALL: Final = 6.0  # half the height of the ground at one symbol [points]


@dataclass(frozen=True, slots=True)
class Spacing:
    """How much room symbols take [points]."""

    lead: float  # of a wire before and after a symbol
    body: float  # width and height of a mass, where its label needs no more
    length: float  # of symbols, as a share of their usual length
    member: float  # of members, likewise
    has_room: bool  # gaps are as wide as the marks above them


SPACINGS: Final = (  # spacings, from the widest, which is taken if it fits, to the last
    Spacing(5.0, 20.0, 1.0, 1.0, has_room=True),
    Spacing(4.0, 18.0, 0.9, 0.9, has_room=False),
    Spacing(2.0, 15.0, 0.76, 0.66, has_room=False),
)


@dataclass
class SymbolCell:
    """A part in a gap, or above or below one."""

    part: DrawnPart
    gap: int
    left: list[End] = field(default_factory=list)
    right: list[End] = field(default_factory=list)
    is_reversed: bool = False  # its first end is on the right
    is_label_below: bool = False
    margins: tuple[float, float] = (0.0, 0.0)  # of what reaches beyond its gap: room without a label

    def offsets(self, side: Sequence[End]) -> list[float]:
        """Return where the ends of a side are, upwards from the axis."""
        if self.is_fed_back:
            # The output stays at the tip, and the input beside it comes round the triangle.
            has_output = any(not self.is_input(e) for e in side)
            return [(FEEDBACK if self.is_input(e) else 0.0) if has_output else -USUAL_PITCH / 2 for e in side]
        usual = GROUNDED_PITCH if any(not e.node for e in side) else USUAL_PITCH
        pitch = usual if self.is_boxed else PITCH.get(self.part.type_name, usual)
        return [pitch * ((len(side) - 1) / 2 - i) for i in range(len(side))]

    def is_input(self, end: End) -> bool:
        """Whether an end is an input of an amplifier."""
        return self.part.type_name == "op_amp" and any(e is end for e in self.part.ends[:2])

    @property
    def is_fed_back(self) -> bool:
        """Whether an input of an amplifier lies on the side of its output, as one node or near it."""
        sides = ([self.is_input(e) for e in side] for side in (self.left, self.right))
        return not self.is_boxed and any(len(set(side)) > 1 for side in sides)

    @property
    def is_boxed(self) -> bool:
        """Whether it is a box to which all ends lead, as its own symbol has no places for them."""
        if self.part.symbol.role != "coupling" or len(self.part.ends) <= 2:  # noqa: PLR2004
            return False
        if len(self.part.ends) > PLACES.get(self.part.type_name, len(self.part.ends)):
            return True
        return self.part.symbol.draw is box or max(len(self.left), len(self.right)) > 2  # noqa: PLR2004

    @property
    def is_member(self) -> bool:
        """Whether it reaches from body to body."""
        return self.part.symbol.role == "member"

    def attached(self) -> Iterator[tuple[End, float, int]]:
        """Yield ends at nodes, how far above the axis they are, and on which side of the node it stands."""
        for side, sign in ((self.left, 1), (self.right, -1)):
            pairs = zip(side, self.offsets(side), strict=True)
            yield from ((end, offset, sign) for end, offset in pairs if end.node)


@dataclass(frozen=True, slots=True)
class Built:
    """A symbol with its texts about its own axis, from x = 0 on."""

    width: float
    placed: tuple[Placed, ...]
    below: float
    above: float


def label_of(one: DrawnPart | Distance) -> Placed:
    """Return a label with lines of values below it, centred at x = 0, the last line on y = 0."""
    first = text(one.label)
    if one.label and (first is None or first.width > WIDEST):
        first = text(name_latex(one.name))
    lines = (first, *(text(line, SMALL) for line in one.lines)) if one.label else ()
    return Placed("label", one.name, (), column_of([t for t in lines if t]))


def tags_of(part: DrawnPart) -> list[Built]:
    """Return what shows or reads what a part carries, with arrows; before it, a support's own name."""
    tags = []
    if part.symbol.role == "support" and len(part.ends) == 1 and (called := text(part.label, SMALL)):
        tag = Placed("label", part.name, (), (called,))
        tags.append(Built(called.width + 10, (tag.moved(-5, 0),), -called.depth, called.height))
    for kind, name, label in part.tags:
        if shown := text(label, SMALL):
            pointer = Placed(kind, name, arrow((-10, shown.height / 2), (-2, shown.height / 2), THIN))
            placed = (pointer, Placed("label", name, (), (shown,)))
            tags.append(Built(shown.width + 10, placed, -shown.depth, shown.height))
    return tags


def strokes_of(part: DrawnPart, length: float, *, is_reversed: bool) -> tuple[Stroke, ...]:
    """Return the symbol of a part from its first end at the origin, or (reversed) from its second."""
    strokes = part.symbol.draw(length)
    if not is_reversed:
        return FORCE_TOGETHER(length) if part.symbol.draw == FORCE_BETWEEN.draw else strokes
    return mirrored(strokes, length)


def build(cell: SymbolCell, spacing: Spacing, width: float = 0.0) -> Built:
    """Draw a cell at least so wide."""
    part, is_member = cell.part, cell.is_member
    length = part.symbol.length * (spacing.member if is_member else spacing.length)
    label = label_of(part)
    tags = tags_of(part)
    widest = max([label.box.width, *(one.width + 2 for one in tags)])
    lead = 0.0 if is_member else spacing.lead
    walls = [HATCH + 3.0 if any(not e.node for e in side) else 0.0 for side in (cell.left, cell.right)]
    width = max(max(length + 2 * lead, widest + 4) + sum(walls), width)
    begin, end = walls[0], width - walls[1]
    if is_member:
        length = end - begin
    start, is_reversed = begin + (end - begin - length) / 2, cell.is_reversed
    if part.type_name == "planetary_gear":  # its shaft is on the side of one end; both others reach its ring
        is_reversed = len(cell.right) == 1
    elif part.type_name == "transformer" and {e.domain for e in part.ends} == {"rotation", "translation"}:
        # Screw and rack have their shaft on its side.
        is_reversed = any(e.domain == "rotation" for e in cell.right)
    strokes = _casing(cell, length) if cell.is_boxed else strokes_of(part, length, is_reversed=is_reversed)
    symbol = Placed(part.kind, part.name, strokes).moved(start, 0)
    items = [*_wires(cell, (0.0, begin, start), (width, end, start + length)), symbol]
    if part.type_name == "dc_motor" and (letter := text(r"\mathrm{M}")):
        half = (letter.width / 2, letter.height / 2)
        items.append(Placed("label", part.name, (), (letter.moved(start + length / 2 - half[0], -half[1]),)))
    if part.type_name == "op_amp" and not cell.is_boxed:
        items += _signs(cell, start, length)
    items += _points(cell, start, length)
    boxes = [i.box for i in items]
    above, below = max(b.y1 for b in boxes), min(b.y0 for b in boxes)
    middle = start + length / 2
    if label.texts:
        block = label.box
        y = below - SPACE - block.y1 if cell.is_label_below else above + SPACE - block.y0
        shift = _kept(middle, block.width, 1.0 + cell.margins[0], width - 1.0 - cell.margins[1])
        items.append(label.moved(shift, y))
        above, below = max(above, y + block.y1), min(below, y + block.y0)
    for one in tags:
        y = below - SPACE - one.above
        # A member says what it delivers at its second end.
        at = middle if not is_member else start if cell.is_reversed else start + length
        x = _kept(at, one.width, 1.0, width - 1.0) - one.width / 2
        items += [i.moved(x + 10, y) for i in one.placed]
        below = y + one.below
    return Built(width, tuple(items), below, above)


def _casing(cell: SymbolCell, length: float) -> tuple[Stroke, ...]:
    """Return a box, with a lead on each side where only one end is."""
    a, b = 0.2 * length, 0.8 * length
    leads = ((cell.left, line((0, 0), (a, 0))), (cell.right, line((b, 0), (length, 0))))
    return (*(lead for side, lead in leads if len(side) == 1), rectangle(a, -6.5, b, 6.5))


def _signs(cell: SymbolCell, start: float, length: float) -> list[Placed]:
    """Return the signs of an amplifier's inputs, the first of which is not inverted."""
    signs = []
    x = start + length * (0.73 if cell.is_reversed else 0.27)
    for end, sign in zip(cell.part.ends, ("+", "-"), strict=False):
        side = cell.left if any(e is end for e in cell.left) else cell.right
        index = next(i for i, e in enumerate(side) if e is end)
        y = max(-USUAL_PITCH / 2, min(USUAL_PITCH / 2, cell.offsets(side)[index]))
        if written := text(sign, SMALL):
            low = y - (written.height - written.depth) / 2
            signs.append(Placed("label", cell.part.name, (), (written.moved(x - written.width / 2, low),)))
    return signs


def _wires(
    cell: SymbolCell, left: tuple[float, float, float], right: tuple[float, float, float]
) -> list[Placed]:
    """Draw what leads to a symbol: from the edge of its place, or from the ground."""
    part, wires = cell.part, []
    insets = (0.0, 0.2) if cell.is_boxed else INSET.get(part.type_name, (0.0, 0.2))
    amplifier = part.type_name == "op_amp" and not cell.is_boxed
    for side, (edge, ground, inner), sign in ((cell.left, left, 1), (cell.right, right, -1)):
        inset = insets[len(side) > 1] * abs(right[2] - left[2])
        for one, y in zip(side, cell.offsets(side), strict=True):
            at, reach = edge if one.node else ground, inner + sign * inset
            if amplifier:
                reach = inner + sign * 0.2 * abs(right[2] - left[2]) * cell.is_input(one)
            if y == FEEDBACK:
                back = (right if sign > 0 else left)[2]
                into = (back - sign * 0.2 * (right[2] - left[2]), USUAL_PITCH / 2)
                around = ((at, y), (back, y), (back, USUAL_PITCH / 2), into)
                wires.append(Placed("wire", part.name, (line(*around),)))
                continue
            if at != reach:
                bold = BOLD if one.domain == "rotation" else LINE
                route = [(at, y), (reach, y)]
                if (
                    len(side) > 1
                    and abs(y) > USUAL_PITCH / 2
                    and (cell.is_boxed or part.type_name not in PITCH)
                ):
                    level = USUAL_PITCH / 2 if y > 0 else -USUAL_PITCH / 2
                    route = [(at, y), (inner, y), (inner, level), (reach, level)]
                wires.append(Placed("wire", part.name, (line(*route, width=bold),)))
            if not one.node:
                is_wall = one.domain not in CIRCUITS
                strokes = wall(y - WALL, y + WALL, -sign, at) if is_wall else earth(at, y)
                wires.append(Placed("ground", "", strokes))
    return wires


def _kept(middle: float, width: float, low: float, high: float) -> float:
    """Return a middle such that what is so wide stays between two limits, where it can."""
    return max(low + width / 2, min(high - width / 2, middle)) if width <= high - low else (low + high) / 2


def coordinate(y: float = 0.0) -> list[Placed]:
    """Draw an arrow along x from the origin, or from above or below it."""
    strokes = (*arrow((0, y), (15, y), THIN), line((0, y - 2), (0, y + 2), width=THIN))
    shown = text("x", SMALL)
    assert shown is not None
    label = shown.moved(17.5, y - shown.height / 2)
    return [Placed("axis", "x", strokes), Placed("label", "x", (), (label,))]


def _points(cell: SymbolCell, start: float, length: float) -> list[Placed]:
    """Mark outputs along a member, beside what stands at the nodes at its ends."""
    part, ends = cell.part, (start + cell.margins[0], start + length - cell.margins[1])
    marks: list[Placed] = []
    taken: list[tuple[float, float, int]] = []  # from where to where texts reach, and at which level
    beyond = 1e9
    for share, name, label in reversed(part.points):
        shown = text(label, SMALL)
        if shown is None:
            continue
        x = min(max(start + length * share, ends[0] + NEAR_END), ends[1] - NEAR_END)
        low = min(x - 1.0, ends[1] - 1.0 - shown.width)
        # Texts to the right stand lower, and so no arrow passes through one.
        level = 1 + max([-1, *(n for a, b, n in taken if a - SPACE < low + shown.width and low < b + SPACE)])
        taken.append((min(low, x), low + shown.width, level))
        tip = half_depth(part.depths, (x - start) / length)
        y = tip + 5.8 + 10 * level
        arrow_down = (line((x, tip + 0.8), (x, y), width=THIN), head((x, tip), (0, -1), 3.0))
        placed_label = shown.moved(low, y + 1.5 + shown.depth)
        if beyond - x > SPACE:
            marks += [Placed("output", name, arrow_down), Placed("label", name, (), (placed_label,))]
            beyond = x
        else:
            marks.append(Placed("output", name, (), (placed_label,)))  # at the arrow of the one beside it
    return marks
