"""A network laid out in a row: its nodes as columns, parts in the gaps between them, marks above and below.

Input: a network and the domains of its nodes. Output: placed parts, with the axis of the row at y = 0.

    wall --k-- [m] ==beam== [m]        columns m, m; gaps: spring with its wall, beam
               --b-- wall              what joins a node in the middle to the ground hangs below it

Parts between neighbours stack in their gap; others bridge the columns between, above everything there. Every
symbol has a place of its own by construction: gaps have symbols, columns have bodies, supports and vertical
leads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Final

from symflex.drawing.cells import (
    COORDINATES,
    SPACE,
    SPACINGS,
    WALL,
    Spacing,
    SymbolCell,
    build,
    coordinate,
    label_of,
    strokes_of,
)
from symflex.drawing.columns import (
    LANE,
    Column,
    bodies,
    flat_mark,
    flat_width,
    hanging_length,
    hanging_reach,
    hanging_texts,
    hanging_width,
    labels_width,
    mark_of_source,
    support_width,
    tags_below,
    texts_of_mark,
    upright_mark,
    upright_width,
)
from symflex.drawing.geometry import BLACK, BOLD, LINE, THIN, Extent, Placed, Point, free_level, union
from symflex.drawing.lettering import text
from symflex.drawing.order import order_of
from symflex.drawing.scheme import Distance, DrawnNetwork, DrawnPart, End, Mark
from symflex.drawing.symbols import DOT, HATCH, arrow, circle, earth, floor, guide, line, rectangle, wall
from symflex.library.elements import CIRCUITS

SIDE_ARROW: Final = 20.0
FACE: Final = 9.0  # room of a wall or a guide beside a node
MARK: Final = 17.0  # height of what stands upright at a node
WIDEST_LENGTH: Final = 34.0  # widest length that a dimension shows; a longer one is in the label [points]


@dataclass(frozen=True, slots=True)
class _SideArrow:
    """A force on the first or last column, drawn beside it."""

    mark: Mark
    column: int


@dataclass(frozen=True, slots=True)
class _Level:
    """Something in a gap, how wide it is and how high above the axis."""

    what: SymbolCell | _SideArrow
    width: float
    y: float


def lay_out(
    network: DrawnNetwork, domains: Mapping[str, str], spacing: Spacing = SPACINGS[0]
) -> tuple[Placed, ...]:
    """Return a network as a row, the axis of its columns at y = 0."""
    return tuple(_Layout(network, domains, spacing).items)


@dataclass
class _Layout:
    """Places the parts of a row, from the widths of its gaps to the marks above them."""

    network: DrawnNetwork
    domains: Mapping[str, str]
    spacing: Spacing
    items: list[Placed] = field(default_factory=list)
    occupied: list[Extent] = field(default_factory=list)
    bridges: list[SymbolCell] = field(default_factory=list)
    leads: list[Extent] = field(default_factory=list)  # upwards to bridges
    spans: list[Distance] = field(default_factory=list)
    members: dict[str, tuple[SymbolCell, Extent]] = field(default_factory=dict)  # and where they are drawn

    def __post_init__(self) -> None:
        self.columns = [Column(n, self.domains[n]) for n in order_of(self.network, self.domains)]
        self.at = {c.name: i for i, c in enumerate(self.columns)}
        self.spans = list(self.network.spans)
        self.direct: list[list[SymbolCell | _SideArrow]] = [[] for _ in range(len(self.columns) + 1)]
        self._sort_parts()
        self._sort_marks()
        self._sort_supports()
        self.gaps = [self._stacked(cells) for cells in self.direct]
        self._measure()
        self.edges = self._place()
        for column in self.columns:
            self._draw_column(column)
        for g in range(len(self.gaps)):
            self._draw_gap(g)
        self._draw_below()
        self._draw_bridges()
        self._draw_above()

    def _column(self, node: str) -> Column:
        return self.columns[self.at[node]]

    # ------------------------------------------------------------------------------------ where parts go

    def _sort_parts(self) -> None:
        for part in self.network.parts:
            role, is_single = part.symbol.role, len(part.ends) == 1
            columns = sorted({self.at[n] for n in part.nodes})
            first = self.columns[columns[0]] if columns else None
            if first is None:
                self.direct[0].append(SymbolCell(part, 0, [part.ends[0]], list(part.ends[1:])))
            elif role == "body":
                first.bodies.append(part)
            elif is_single and role == "support":
                first.supports.append(part)
            elif is_single and first.is_electrical:
                first.hanging.append(part)
            elif is_single:
                first.marks.append(mark_of_source(part, is_flat=first.is_flat))
            elif len(columns) == 1 and len(part.ends) == 2 and role != "coupling":  # noqa: PLR2004
                self._sort_grounded(part, columns[0])
            else:
                self._sort_branch(part, columns)
        for cells in self.direct:
            # The length of a member that is alone in its gap is a dimension, instead of in its label.
            members = [c for c in cells if isinstance(c, SymbolCell) and c.is_member]
            length, surplus = members[0].part.dimension if len(members) == 1 else ("", "")
            if (shown := text(length)) and shown.width <= WIDEST_LENGTH:
                cell, part = members[0], members[0].part
                left, right = (next((e.node for e in side if e.node), "") for side in (cell.left, cell.right))
                lines = () if surplus else part.lines
                self.spans.append(Distance((left, right), part.name, length, lines, is_length=True))
                cell.part = replace(part, label=surplus)

    def _sort_grounded(self, part: DrawnPart, index: int) -> None:
        """Place what lies between a node and the ground, or two components of a node."""
        column, last = self.columns[index], len(self.columns) - 1
        hangs = column.is_electrical or (column.is_flat and part.symbol.role != "member")
        if hangs or all(e.node for e in part.ends):
            column.hanging.append(part)
        elif index == 0 and not (last == 0 and self._is_better_right(part)):
            self._add_direct(part, 0)
        elif index == last:
            self._add_direct(part, last + 1)
        else:
            column.stubs.append(part)

    def _is_better_right(self, part: DrawnPart) -> bool:
        """Tell whether the only node has the ground to its right: for a member that goes on, or for room."""
        left, right = ([c for c in side if isinstance(c, SymbolCell)] for side in self.direct[:2])
        if part.symbol.role == "member":
            return any(c.is_member for c in left) and not any(c.is_member for c in right)
        return len(left) > len(right) + 2

    def _add_direct(self, part: DrawnPart, gap: int) -> None:
        left, right = sorted(part.ends, key=lambda e: bool(e.node), reverse=gap > 0)
        self.direct[gap].append(SymbolCell(part, gap, [left], [right], is_reversed=left is not part.ends[0]))

    def _sort_branch(self, part: DrawnPart, columns: Sequence[int]) -> None:
        low, high = columns[0], columns[-1]
        gap = max(low + 1, (low + high + 1) // 2)
        cell = SymbolCell(part, gap)
        for end in part.ends:
            if end.node:
                (cell.left if self.at[end.node] < gap else cell.right).append(end)
        for i, end in enumerate(part.ends):
            if not end.node:
                (cell.left if self._is_ground_left(part, i, gap) else cell.right).append(end)
        cell.left.sort(key=lambda e: -self.at.get(e.node, -1))
        cell.right.sort(key=lambda e: self.at.get(e.node, len(self.columns)))
        cell.is_reversed = part.ends[0] in cell.right
        if high - low <= 1:
            self.direct[gap].append(cell)
        else:
            self.bridges.append(cell)

    def _is_ground_left(self, part: DrawnPart, index: int, gap: int) -> bool:
        """Tell on which side an end at the ground is drawn: beside its pair, facing it in a stack."""
        end = part.ends[index]
        # The other of its pair first: terminals, windings and sides are listed in pairs.
        others = [*part.ends[index ^ 1 :][:1], *part.ends]
        alike = [e for e in others if e.domain == end.domain and e.node]
        if not alike:
            others = [e for e in part.ends if e.node]
            return not any(self.at[e.node] < gap for e in others)
        is_stack = part.type_name == "piezo" and end.domain not in CIRCUITS
        is_beside = len(part.ends) > 2 and not is_stack  # noqa: PLR2004
        return (self.at[alike[0].node] < gap) is is_beside

    def _sort_marks(self) -> None:
        last = len(self.columns) - 1
        for mark in self.network.marks:
            self.columns[self.at[mark.node]].marks.append(mark)
        for index in sorted({0, last}) if self.columns else ():
            for mark in [m for m in self.columns[index].marks if m.style == "force"]:
                self.columns[index].marks.remove(mark)
                self.direct[last + 1 if index == last else 0].insert(0, _SideArrow(mark, index))
        for node in (
            *(end.node for cell in self.bridges for end, *_ in cell.attached()),
            *(n for span in self.spans for n in span.nodes if not span.is_length),
        ):
            self._column(node).has_lead_up = True

    def _sort_supports(self) -> None:
        """Stand walls and guides beside the first and last node, where there is room."""
        for column, side in ((self.columns[0], -1), (self.columns[-1], 1)) if self.columns else ():
            beside = self.direct[0 if side < 0 else -1]
            for part in column.supports:
                is_wall = part.type_name in ("fixed", "slider") and part.ends[0].component not in ("x", "y")
                if is_wall and not beside and side not in column.faces and not column.is_electrical:
                    column.supports.remove(part)
                    column.faces[side] = part
                    break

    # --------------------------------------------------------------------------------------------- sizes

    def _stacked(self, cells: Sequence[SymbolCell | _SideArrow]) -> list[_Level]:
        """Return what stands in a gap, one below the other and about the axis."""
        levels: list[_Level] = []
        y = 0.0
        for i, one in enumerate(cells):
            if isinstance(one, SymbolCell):
                one.is_label_below = i == len(cells) - 1 and i > 0
                built = build(one, self.spacing)
                width, above, below = built.width, built.above, built.below
            else:
                labels = union(i.box for i in texts_of_mark(one.mark, 0.0, 0.0))
                width, above, below = max(SIDE_ARROW, labels_width(one.mark)), 5.0 + labels.height, -4.0
            y -= above + SPACE if i else 0.0
            levels.append(_Level(one, width, y))
            y += below
        middle = (levels[0].y + levels[-1].y) / 2 if levels else 0.0
        return [replace(level, y=level.y - middle) for level in levels]

    def _measure(self) -> None:
        for level in (level for gap in self.gaps for level in gap):
            if isinstance(level.what, SymbolCell):
                for end, offset, _ in level.what.attached():
                    self._column(end.node).levels.append(level.y + offset)
            else:
                self.columns[level.what.column].levels.append(level.y)
        for index, column in enumerate(self.columns):
            column.outside = (index == len(self.columns) - 1) - (index == 0)
            column.resize(self.spacing.body)

    def _place(self) -> list[tuple[float, float]]:
        """Give every column its x, and return where gaps begin and end."""
        edges, x = [], 0.0
        for g, levels in enumerate(self.gaps):
            bridging = (build(b, self.spacing).width for b in self.bridges if b.gap == g)
            width = max([0.0, *bridging, *(level.width for level in levels)])
            before = self.columns[g - 1] if g else None
            after = self.columns[g] if g < len(self.columns) else None
            if before and after:
                width = max(width, 0.0 if levels else 14.0)
                if self.spacing.has_room:
                    wide = max([0.0, *(flat_width(m) for m in before.marks if m not in before.upright)])
                    width = max(width, wide - before.right - after.left)
            x += FACE if before and 1 in before.faces else 0.0
            edges.append((x, x + width))
            x += width + (FACE if after and -1 in after.faces else 0.0)
            if after:
                after.x = x + after.left
                x = after.x + after.right
        return edges

    # ------------------------------------------------------------------------------------------- drawing

    def _add(self, *items: Placed) -> None:
        self.items.extend(items)
        self.occupied.extend(i.box for i in items if i.kind != "wire")

    def _wire(self, name: str, *points: tuple[float, float], width: float = LINE) -> None:
        if len(set(points)) > 1:
            self.items.append(Placed("wire", name, (line(*points, width=width),)))

    def _free(self, room: Extent, limit: float, *, is_up: bool, leads: Sequence[Extent] = ()) -> float:
        occupied = [*self.occupied, *(b for b in leads if not room.x0 - 1 <= b.x0 <= room.x0 + 1)]
        return free_level(room, limit, occupied, is_up=is_up)

    def _draw_column(self, column: Column) -> None:
        x, top, bottom = column.x, column.top, column.bottom
        self._add(*bodies(column, self.spacing.body))
        if column.bodies:
            stands = self.network.has_rollers and column.kind == "translation"
            if stands and not (column.supports or column.hanging or column.stubs):
                wheels = (circle(x + side * 0.55 * column.half, bottom - 2, 2.0) for side in (-1, 1))
                below = floor(x - column.half, x + column.half, bottom - 4)
                self._add(Placed("ground", column.name, (*wheels, *below)))
            return
        index = self.at[column.name]
        bare = [side for side in (-1, 1) if not self.gaps[index + (side > 0)]]
        is_along = not column.faces and not column.is_flat
        if bare and is_along and any(m.style == "motion" for m in column.marks):
            self._add(Placed("ground", column.name, wall(bottom, top, bare[0], x)))
        else:
            width = LINE if column.is_electrical else BOLD if column.kind == "rotation" else 1.4
            self._wire(column.name, (x, bottom), (x, top), width=width)
        joints = len(column.levels) + len(column.hanging) + column.has_lead_up
        if (column.is_flat and joints > 1) or (column.is_electrical and joints > 2):  # noqa: PLR2004
            levels = dict.fromkeys(column.levels or [0.0]) if column.is_electrical else [0.0]
            self._add(Placed("node", column.name, tuple(circle(x, y, DOT, fill=BLACK) for y in levels)))

    def _draw_gap(self, g: int) -> None:
        low, high = self.edges[g]
        for level in self.gaps[g]:
            if isinstance(level.what, _SideArrow):
                self._draw_side_arrow(level.what, g, level.y)
                continue
            cell = level.what
            first, last = low, high
            if cell.is_member:
                for end, _, sign in cell.attached():
                    column = self._column(end.node)
                    first = column.x + column.half if sign > 0 else first
                    last = column.x - column.half if sign < 0 else last
                cell.margins = (low - first, last - high)
            built = build(cell, self.spacing, last - first)
            self._add(*(p.moved(first, level.y) for p in built.placed))
            if cell.is_member:
                box = next(i.box for i in built.placed if (i.kind, i.name) == ("element", cell.part.name))
                self.members[cell.part.name] = (cell, box.moved(first, level.y))
            for end, offset, sign in cell.attached():
                column, y = self._column(end.node), level.y + offset
                ends = ((first if sign > 0 else last, y), (column.x + sign * column.half, y))
                self._wire(cell.part.name, *ends, width=_wire_width(cell, end))
        self._join_walls(g)

    def _join_walls(self, g: int) -> None:
        """Make one wall of those in an outer gap."""
        low, high = self.edges[g]
        if 0 < g < len(self.columns):
            return
        grounds = [(i, i.box) for i in self.items if i.kind == "ground" and not i.name]
        walls = [i for i, b in grounds if low - HATCH - 1 <= b.x0 <= high and b.height > b.width]
        if len(walls) < 2 or len({round(w.box.x0, 3) for w in walls}) > 1:  # noqa: PLR2004
            return
        box, side = union(w.box for w in walls), -1 if g == 0 else 1
        for one in walls:
            self.items.remove(one)
        self._add(Placed("ground", "", wall(box.y0, box.y1, side, box.x1 if side < 0 else box.x0)))

    def _draw_side_arrow(self, shown: _SideArrow, gap: int, y: float) -> None:
        column, (low, high) = self.columns[shown.column], self.edges[gap]
        if gap > shown.column:
            start = column.x + max(column.half, 1.0)
            end = max(start + SIDE_ARROW, high)
        else:
            end = column.x - max(column.half, 0.5)
            start = min(low, end - SIDE_ARROW)
        kind, name, _ = shown.mark.labels[0]
        self._add(Placed(kind, name, arrow((start, y), (end, y), BOLD)))
        texts = texts_of_mark(shown.mark, 0.0, 0.0)
        box = union(i.box for i in texts)
        self._add(*(i.moved((start + end) / 2 - box.centre[0], y + 3.5 - box.y0) for i in texts))

    # --------------------------------------------------------------------------------- below and above it

    def _draw_below(self) -> None:
        hanging: list[tuple[DrawnPart, Column, float]] = []
        for column in reversed(self.columns):
            for side, part in column.faces.items():
                self._draw_face(part, column, side)
            hanging += self._draw_supports(column)
        # x stands below a member, and what hangs there below x, where x misses the leads of what hangs.
        leads = [Extent(x - 1, c.bottom - hanging_length(p) - 8, x + 1, c.bottom) for p, c, x in hanging]
        self._draw_coordinates(leads)
        for part, column, x in hanging:
            self._draw_hanging(part, column, x)
        for column in reversed(self.columns):
            for part in column.stubs:
                self._draw_stub(part, column)

    def _draw_coordinates(self, leads: Sequence[Extent]) -> None:
        """Draw x below members, but for those along which x of the member before runs on."""
        along = [(c, box) for c, box in self.members.values() if c.part.type_name in COORDINATES]
        ends = {(c.part.ends[1].node, c.is_reversed) for c, _ in along} - {("", False), ("", True)}
        for cell, box in along:
            if (cell.part.ends[0].node, cell.is_reversed) not in ends:
                sign, start = (-1, box.x1) if cell.is_reversed else (1, box.x0)
                items = [i.rotated(sign, 0).moved(start, 0) for i in coordinate()]
                room = union(i.box for i in items).grown(2.0)
                wires = [i.box.grown(0.5) for i in self.items if i.kind == "wire" and not i.box.height]
                y = free_level(room, box.y0 - 1.0, [*self.occupied, *leads, *wires], is_up=False)
                self._add(*(i.moved(0, y) for i in items))

    def _draw_face(self, part: DrawnPart, column: Column, side: int) -> None:
        x = column.x + side * column.half
        low, high = column.bottom, column.top - column.crown
        is_guide = part.type_name == "slider"
        if is_guide and not column.bodies and side == next(iter(column.faces)):
            shoe = rectangle(column.x - column.half, low, column.x + column.half, high)
            self._add(Placed("node", column.name, (shoe,)))
        strokes = (guide if is_guide else wall)(low, high, side, x)
        self._add(Placed(part.kind, part.name, strokes))
        self._add(*tags_below(part, x + side * 5, low - 5))

    def _draw_supports(self, column: Column) -> list[tuple[DrawnPart, Column, float]]:
        """Draw supports side by side with the leads to what hangs, and return where these lead to."""
        middle, bottom = column.x - (LANE if column.stubs and column.below else 0.0), column.bottom
        if column.hanging and column.is_electrical and column is self.columns[-1]:  # the corner of a mesh
            middle -= column.below[-1][0] + 2 + hanging_reach(column.hanging[-1])[0]
        feet = [column.x]
        supports = []
        for part, (start, end) in zip((*column.supports, *column.hanging), column.below, strict=True):
            if part in column.supports:
                foot = middle + (start + end) / 2
                support = Placed(part.kind, part.name, part.symbol.hold()).moved(foot, bottom)
                self._add(support, *tags_below(part, foot, support.box.y0))
            else:
                foot = middle + start + 2 + hanging_reach(part)[0]
                supports.append((part, column, foot))
            feet.append(foot)
        if max(feet) - min(feet) > 2 * column.half:
            width = LINE if column.is_electrical else 1.4
            self._wire(column.name, (min(feet), bottom), (max(feet), bottom), width=width)
        return supports

    def _draw_hanging(self, part: DrawnPart, column: Column, x: float) -> None:
        """Draw a part from a node down to the ground, or to another component of the node."""
        length, (left, right) = hanging_length(part), hanging_reach(part)
        top = self._free(Extent(x - left, -length, x + right, 0.0), column.bottom - 3, is_up=False)
        strokes = strokes_of(part, length, is_reversed=not part.ends[0].node)
        self._add(Placed(part.kind, part.name, strokes).rotated(0, -1).moved(x, top))
        self._wire(part.name, (x, column.bottom), (x, top))
        end = top - length
        if len(part.ends) > 1 and all(e.node for e in part.ends):
            self._add(Placed("node", part.name, (circle(x, end - DOT, DOT),)))
        else:
            base = earth(x, end) if column.is_electrical else floor(x - 6, x + 6, end)
            self._add(Placed("ground", "", base))
        self._add(*hanging_texts(part, x + right + SPACE, (top + end) / 2))

    def _draw_stub(self, part: DrawnPart, column: Column) -> None:
        """Draw what joins a node in the middle to the ground: down, then to the right."""
        node, ground = sorted(part.ends, key=lambda e: not e.node)
        cell = SymbolCell(part, 0, [node], [ground], is_reversed=part.ends[0] is ground, is_label_below=True)
        built = build(cell, self.spacing)
        drops = sum(map(support_width, column.supports)) + sum(map(hanging_width, column.hanging))
        x = column.x + drops / 2 - (LANE / 2 if drops else 0.0)
        room = Extent(x - 1, built.below - SPACE, x + 2 + built.width, built.above + SPACE)
        y = self._free(room, column.bottom - 1, is_up=False)
        self._add(*(p.moved(x + 2, y) for p in built.placed))
        route = ((column.x, column.bottom), (x, column.bottom), (x, y), (x + 2, y))
        self._wire(part.name, *route, width=_wire_width(cell, node))

    def _draw_bridges(self) -> None:
        """Draw what joins nodes that are not neighbours above everything between them, short ones first."""

        def spanned(cell: SymbolCell) -> list[Column]:
            ends = [self.at[end.node] for end, *_ in cell.attached()]
            return self.columns[min(ends) : max(ends) + 1]

        for cell in sorted(self.bridges, key=lambda c: len(spanned(c))):
            built = build(cell, self.spacing)
            start = (sum(self.edges[cell.gap]) - built.width) / 2
            between = spanned(cell)
            ends = (min(between[0].lead_x, start), max(between[-1].lead_x, start + built.width))
            room = Extent(ends[0] - 2, built.below - SPACE, ends[1] + 2, built.above + SPACE)
            above = MARK + 1 if any(c.upright for c in between) else 3
            y = self._free(room, max(c.top for c in between) + above, is_up=True)
            self._add(*(p.moved(start, y) for p in built.placed))
            self.occupied.append(room.moved(0, y))
            for end, offset, sign in cell.attached():
                column, level = self._column(end.node), y + offset
                x = column.lead_x
                self.leads.append(Extent(x - 1, column.top, x + 1, level))
                foot = [(x, column.top), (column.x, column.top)]
                if column.crown:  # beside the label of a disc, to the end of its shaft
                    x = column.x - column.half
                    foot = [(x, (column.top - column.crown + column.bottom) / 2)]
                edge = (start if sign > 0 else start + built.width, level)
                self._wire(cell.part.name, edge, (x, level), *foot, width=_wire_width(cell, end))

    def _draw_above(self) -> None:
        for column in reversed(self.columns):
            x = column.first_mark
            for mark in column.upright:
                self._add(*upright_mark(mark, x, column.top))
                x += upright_width(mark)
        self._draw_spans()
        flat = [(c, m, c.lead_x) for c in reversed(self.columns) for m in c.marks if m not in c.upright]
        rooms = [Extent(x - 1, -2.5, x + flat_width(m), 11.0) for _, m, x in flat]
        # Datums stand at one height where that is possible.
        levels = (
            self._free(room, column.top + 3, is_up=True, leads=self.leads)
            for (column, *_), room in zip(flat, rooms, strict=True)
        )
        level = max(levels, default=0.0)
        for (column, mark, x), room in zip(flat, rooms, strict=True):
            y = self._free(room, level - 1.0, is_up=True, leads=self.leads)
            self._wire(mark.labels[0][1], (column.x, column.top), (x, column.top), (x, y), width=THIN)
            self._add(*flat_mark(mark, x, y))
            self.occupied.append(room.moved(0, y))

    def _end_of(self, span: Distance, i: int) -> Point:
        """Return the point from which a lead goes up to one end of a distance."""
        if span.nodes[i]:
            column = self._column(span.nodes[i])
            if span.is_length:
                return column.x, column.top + MARK * bool(column.upright)
            return column.lead_x, column.top
        box = self.members[span.name][1]
        return (box.x1 if i else box.x0), (box.y0 + box.y1) / 2 + WALL

    def _draw_spans(self) -> None:
        """Draw distances between two nodes; lengths, with an arrow at both ends, stand at one height."""
        drawn = []
        for span in sorted(self.spans, key=lambda s: not s.is_length):
            ends = (self._end_of(span, 0), self._end_of(span, 1))
            label = label_of(span)
            shown = label.box
            left, right = sorted(x for x, _ in ends)
            more = max(0.0, shown.width + 4 - (right - left)) / 2 + (0.0 if span.is_length else 1.0)
            room = Extent(left - more, -3.0, right + more, 5.0 + shown.height)
            y = self._free(room, max(y for _, y in ends) + 4, is_up=True)
            drawn.append((span, ends, label, room, y))
        level = max((y for span, *_, y in drawn if span.is_length), default=0.0)
        for span, ends, label, room, free in drawn:
            y = self._free(room, (level if span.is_length else free) - 3.0, is_up=True)
            for node, (x, top) in zip(span.nodes, ends, strict=True):
                foot = (self._column(node).x if node else x, top)
                self._wire(span.name, foot, (x, top), (x, y + 3), width=THIN)
            kind, width = ("length", THIN) if span.is_length else ("output", LINE)
            (a, _), (b, _) = ends
            self._add(Placed(kind, span.name, arrow((b, y), (a, y), width, is_double=span.is_length)))
            self.occupied.append(room.moved(0, y))
            low, high = sorted((a, b))
            # Leads go up between them.
            between = sorted(c.lead_x for c in self.columns if low <= c.lead_x <= high)
            widest = max(pairwise(between), key=lambda pair: pair[1] - pair[0], default=(low, high))
            start, end = widest if widest[1] - widest[0] > label.box.width + 2 else (low, high)
            self._add(label.moved((start + end) / 2, y + 3 - label.box.y0))


def _wire_width(cell: SymbolCell, end: End) -> float:
    if cell.is_member and cell.part.type_name != "string":
        return 2.2
    return BOLD if end.domain == "rotation" else LINE
