"""A graph of signals laid out as block diagrams.

Input: a :class:`~symflex.drawing.signals.SignalGraph`. Output: bands of placed parts, one below the other.

A band is the longest path that is not drawn yet, from left to right. What else leads to its sums comes from
below or above, from right to left; what leaves a named signal to end elsewhere begins a band of its own,
with the name:

    r --o--[k]--e-->
        |
        '--[K]-- x
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

from symflex.drawing.cells import Built
from symflex.drawing.geometry import BLACK, Extent, Lettering, Placed, Point, free_level, union
from symflex.drawing.lettering import SIZE, SMALL, column_of, downwards, filled, text
from symflex.drawing.signals import MOST_AT_SUM, SignalGraph, SignalNode, formula
from symflex.drawing.symbols import DOT, arrow, circle, line, rectangle

RADIUS: Final = 4.2  # radius of a sum
WIRE: Final = 11.0  # length of a wire between two symbols, enough for an arrow
EDGE: Final = 3.5  # space between a text and the box around it
TURN: Final = 10.0  # room for a wire that goes back to the left
APART: Final = 6.0  # space between rows
WIDEST: Final = 90.0  # widest formula in a box; a longer one is not printed
WIDEST_FORMULA, BETWEEN_FORMULAS = 200.0, 4.0  # widest formula below diagrams, and space after it [points]
MOST_PATHS: Final = 2000  # paths that are tried for the longest one, from a start
NAMED: Final = ("input", "reading", "signal")
BOXES: Final = ("gain", "block")


@dataclass(frozen=True, slots=True)
class _Branch:
    """What leads to a sum besides the path: from the sum back to a source, or to a signal that is drawn."""

    target: int
    nodes: tuple[int, ...]  # the first one is next to the sum
    origin: int | None  # a signal of the same path, from which a wire leads here
    is_minus: bool
    is_tag: bool = False  # the last node is drawn elsewhere, and here its name


def diagrams(graph: SignalGraph, widest: float) -> list[list[Placed]]:
    """Return the block diagrams of a graph, one band each; a wider one goes on below its beginning."""
    drawn: set[int] = set()
    joined: set[tuple[int, int]] = set()
    bands = []
    while path := _longest(graph, drawn, joined):
        tags = frozenset(drawn.intersection(path))
        one_band = _Band(graph, path, tags, set(drawn), set(joined))
        if one_band.box.width <= widest:
            drawn |= one_band.drawn
            joined |= one_band.joined
            bands.append(one_band.items)
            continue
        drawn.update(path)
        joined.update(pairwise(path))
        pieces: list[_Band] = []
        for piece in _cut(graph, one_band, widest - 2 * TURN):
            before = pieces[-1].path[-1] if pieces else None
            pieces.append(_Band(graph, piece, tags.intersection(piece), drawn, joined, before))
        bands.append(_wrapped(pieces))
    return bands


def _cut(graph: SignalGraph, band: _Band, widest: float) -> list[list[int]]:
    """Return a path in pieces that are narrow enough, where a node alone is; none begins with a signal."""
    pieces: list[list[int]] = []
    start = 0.0
    for node in band.path:
        begin, end = band.x[node]
        is_wide = end - start > widest and graph.nodes[node].kind not in ("signal", "output")
        if not pieces or is_wide:
            pieces.append([])
            start = begin
        pieces[-1].append(node)
    return pieces


def _wrapped(bands: list[_Band]) -> list[Placed]:
    """Return the pieces of a path below each other, joined by wires back to the left."""
    last, (shift, level), edge = bands[0], (0.0, 0.0), bands[0].box
    items, edge_x = list(last.items), edge.x0
    for band in bands[1:]:
        below = edge.y0 - TURN
        dx, dy = edge_x + TURN - band.box.x0, below - band.box.y1
        far, between = edge.x1 + TURN / 2, below + TURN / 2
        start = last.x[last.path[-1]][1] + shift
        route = ((start, level), (far, level), (far, between), (edge_x, between), (edge_x, dy))
        first = band.path[0]
        items.append(Placed("wire", "", (line(*route), *arrow((edge_x, dy), (dx + band.x[first][0], dy)))))
        items += [i.moved(dx, dy) for i in band.items]
        last, (shift, level), edge = band, (dx, dy), band.box.moved(dx, dy)
    return items


def _longest(graph: SignalGraph, drawn: set[int], joined: set[tuple[int, int]]) -> list[int]:
    """Return the longest path that is not drawn, from an input or else a named signal where there is one."""

    def ahead(node: int) -> list[int]:
        return [n for n in graph.nodes[node].after if (node, n) not in joined and n not in drawn]

    fresh = [i for i, n in enumerate(graph.nodes) if i not in drawn or (n.kind in NAMED and ahead(i))]
    starts = [i for i in fresh if not _is_fed_back(graph, i)]
    minus = {(before, i) for i, n in enumerate(graph.nodes) for before, is_minus in n.before if is_minus}
    best: list[int] = []
    best_rank = (0, 0)
    # From anywhere else no path is better than one from an input, so that these are tried only without one.
    starts = [i for i in starts if graph.nodes[i].kind == "input"] or starts
    shared = 20 * MOST_PATHS // max(len(starts), 1)
    most = min(MOST_PATHS, max(shared, len(graph.nodes) + 1))  # so that each reaches the end of one path
    for start in starts:
        pending, tries = [[start]], 0
        while pending and tries < most:
            path = pending.pop()
            tries += 1
            passed = set(path)
            onward = [n for n in ahead(path[-1]) if n not in passed]
            while len(path) > 1 and not onward:
                last = graph.nodes[path[-1]]
                if last.kind not in (*BOXES, "sum") or not any(n in path for n in last.after):
                    break  # else it feeds what is on the path, and is drawn from there
                path = path[:-1]
            # How much of it comes before what it is subtracted from, that is fed back.
            forward = next((i for i, pair in enumerate(pairwise(path), 1) if pair in minus), len(path))
            if not onward and (forward, len(path)) > best_rank:
                best, best_rank = path, (forward, len(path))
            pending += [[*path, n] for n in reversed(onward)]
    return best


def _is_fed_back(graph: SignalGraph, node: int) -> bool:
    """Tell whether a node is a box before a sum: what leads to it comes first, or is drawn from there."""
    while graph.nodes[node].kind in BOXES:
        node = graph.nodes[node].after[0]
        if graph.nodes[node].kind == "sum":
            return True
    return False


@dataclass
class _Band:
    graph: SignalGraph
    path: list[int]
    tags: frozenset[int]  # of the path, what is drawn elsewhere
    drawn: set[int]
    joined: set[tuple[int, int]]
    before: int | None = None  # what leads to the path, where it goes on
    items: list[Placed] = field(default_factory=list)
    occupied: list[Extent] = field(default_factory=list)  # rows of chains among it
    solid: list[Extent] = field(default_factory=list)  # symbols and texts
    risers: list[float] = field(default_factory=list)  # where wires go up and down
    x: dict[int, tuple[float, float]] = field(default_factory=dict)  # left and right end of what is drawn
    y: dict[int, float] = field(default_factory=dict)
    reach: dict[int, tuple[float, float]] = field(default_factory=dict)  # down and up from there
    sides: dict[int, list[str]] = field(default_factory=dict)  # of sums, those that arrows come from
    shown_at: dict[int, list[int]] = field(default_factory=dict)  # outputs that are named signals

    def __post_init__(self) -> None:
        self.drawn.update(self.path)
        self.joined.update(pairwise(self.path))
        branches = self._branches(self.path)
        self._draw_path(branches)
        for branch in branches:
            centre = self.x[branch.target][0] + RADIUS
            self.risers.append(centre)
            if branch.origin is not None:
                self.risers.append(self._left_at(branch.origin, centre))
        waiting = sorted(branches, key=lambda b: -self.x[b.target][0])
        while waiting:
            branch = waiting.pop(0)
            self._draw_branch(branch)
            waiting += self._branches(branch.nodes)

    @property
    def box(self) -> Extent:
        """The rectangle around it."""
        return union(i.box for i in self.items)

    def _branches(self, nodes: list[int] | tuple[int, ...]) -> list[_Branch]:
        """Return what leads to the sums among nodes and is not joined yet."""
        branches = []
        for target in nodes:
            for one, is_minus in self.graph.nodes[target].before:
                if (one, target) in self.joined:
                    continue
                self.joined.add((one, target))
                chain: list[int] = []
                node = one
                while node not in self.drawn:
                    chain.append(node)
                    self.drawn.add(node)
                    before = [b for b, _ in self.graph.nodes[node].before]
                    if not before:
                        break
                    self.joined.add((before[0], node))
                    node = before[0]
                is_met = node not in chain  # it is drawn elsewhere
                is_wired = is_met and self._kind(node) == "signal" and {node, target} <= {*self.path}
                is_tag = is_met and not is_wired
                nodes_drawn = (*chain, node) if is_tag else tuple(chain)
                branches.append(_Branch(target, nodes_drawn, node if is_wired else None, is_minus, is_tag))
        return branches

    # ------------------------------------------------------------------------------------------- drawing

    def _draw_path(self, branches: list[_Branch]) -> None:
        x = 0.0
        for i, node in enumerate(self.path):
            if i:
                x += WIRE / 2 if self._kind(node) == "signal" else WIRE
            for branch in (b for b in branches if b.origin is not None):
                other = branch.origin if node == branch.target else branch.target
                length = sum(one.width + WIRE for one in self._all_shown(branch))
                if node in (branch.target, branch.origin) and other in self.x:
                    x = max(x, self.x[other][1] + length + 2 * WIRE)
            shown = self._shown(node, is_tag=node in self.tags)
            self._place(node, shown, x, 0.0)
            before = self.path[i - 1] if i else self.before
            if i:
                self._lead((self.x[self.path[i - 1]][1], 0.0), (x, 0.0), node)
            if before is not None and self._kind(node) == "sum":
                self._sign(node, "left", is_minus=self._is_minus(before, node))
            x += shown.width
        last = self.path[-1]
        if self._kind(last) == "signal" and not self.graph.nodes[last].after:
            name = self.graph.nodes[last].name
            self.items.append(Placed("end", name, arrow((x, 0.0), (x + WIRE, 0.0))))

    def _all_shown(self, branch: _Branch) -> list[Built]:
        last = len(branch.nodes) - 1
        return [self._shown(n, is_tag=branch.is_tag and i == last) for i, n in enumerate(branch.nodes)]

    def _lead(self, start: Point, end: Point, to: int | None) -> None:
        """Draw a straight wire, with a head where it enters a symbol."""
        is_plain = to is None or self._kind(to) == "signal"
        self.items.append(Placed("wire", "", (line(start, end),) if is_plain else arrow(start, end)))

    def _is_minus(self, before: int, node: int) -> bool:
        return next(m for b, m in self.graph.nodes[node].before if b == before)

    def _sign(self, node: int, side: str, *, is_minus: bool) -> None:
        """Note from which side an arrow comes to a sum, and write its sign where it is subtracted."""
        self.sides.setdefault(node, []).append(side)
        if not is_minus:
            return
        x, y = self.x[node][0] + RADIUS, self.y[node]
        places = {
            "left": (x - RADIUS - 6, y + 3.2),
            "right": (x + RADIUS + 6, y + 3.2),
            "below": (x + 4.5, y - RADIUS - 4),
            "above": (x + 4.5, y + RADIUS + 4),
        }
        at = places[side]
        self._add(Placed("sign", "", (line((at[0] - 1.8, at[1]), (at[0] + 1.8, at[1]), width=0.7),)))

    def _add(self, *items: Placed) -> None:
        self.items.extend(items)
        solid = [i.box for i in items if i.kind != "wire"]
        self.occupied.extend(solid)
        self.solid.extend(solid)

    def _place(self, node: int, shown: Built, x: float, y: float) -> None:
        self._add(*(i.moved(x, y) for i in shown.placed))
        self.x[node], self.y[node] = (x, x + shown.width), y
        self.reach[node] = shown.below, shown.above

    def _draw_branch(self, branch: _Branch) -> None:
        """Draw a branch below or above the sum that it leads to."""
        target, shown = branch.target, self._all_shown(branch)
        centre, level = self.x[target][0] + RADIUS, self.y[target]
        length = sum(s.width + WIRE for s in shown)
        other = centre + length if branch.origin is None else self._left_at(branch.origin, centre)
        is_read = branch.origin is None and self._kind(branch.nodes[-1]) == "reading"
        if is_read:  # from beyond the end of the path, where a wire finds it without crossing that
            other = max(other, self.box.x1)
        low, high, sign = min(centre, other), max(centre, other), 1.0 if other >= centre else -1.0
        below, above = min([-RADIUS, *(s.below for s in shown)]), max([RADIUS, *(s.above for s in shown)])
        room = Extent(low - 3, below - APART / 2, high + 4, above + APART / 2)
        y, is_up = self._height(branch, room, [centre] if branch.origin is None else [centre, other])
        self._sign(target, "above" if is_up else "below", is_minus=branch.is_minus)
        spare = max(0.0, high - low - length)
        slack = self._slack(branch, shown, (centre, y), sign * spare)
        x = before = centre + sign * slack
        if slack:
            self.items.append(Placed("wire", "", (line((centre, y), (x, y)),)))
            before = centre
        for i, (node, one) in enumerate(zip(branch.nodes, shown, strict=True)):
            x += sign * WIRE + (spare if is_read and node == branch.nodes[-1] else 0.0)
            self._place(node, one, x if sign > 0 else x - one.width, y)
            towards = branch.nodes[i - 1] if i else None
            self._lead((x, y), (before, y), towards)
            if towards is not None and self._kind(towards) == "sum":
                self._sign(towards, "right" if sign > 0 else "left", is_minus=self._is_minus(node, towards))
            x += sign * one.width
            before = x
        edge = level + self.reach[target][is_up]
        self.items.append(Placed("wire", "", arrow((centre, y), (centre, edge))))
        if branch.origin is not None:  # the wire from the signal of the path that feeds it
            self.items.append(Placed("wire", "", (line((other, 0.0), (other, y)),)))
            self._lead((other, y), (before, y), branch.nodes[-1] if branch.nodes else None)
            self.items.append(Placed("node", "", (circle(other, 0.0, DOT, fill=BLACK),)))
        self.occupied += [room.moved(0, y), Extent(centre - 1, min(y, edge), centre + 1, max(y, edge))]

    def _left_at(self, origin: int, centre: float) -> float:
        """Return where a wire leaves a signal of the path for a branch to a sum."""
        left, right = self.x[origin]
        return right if left > centre else left

    def _slack(self, branch: _Branch, shown: Sequence[Built], anchor: Point, spare: float) -> float:
        """Return how far from its sum a branch bends: such that wires up and down meet little on it."""
        is_loose, sign = branch.origin is None, 1.0 if spare >= 0 else -1.0

        def met(slack: float) -> int:
            x, count = anchor[0] + sign * (slack + WIRE), 0
            for node, one in zip(branch.nodes, shown, strict=True):
                low, high = sorted((x, x + sign * one.width))
                box = Extent(low, anchor[1] + one.below, high, anchor[1] + one.above)
                if len(self.graph.nodes[node].before) == MOST_AT_SUM:  # a sum with wires up and down
                    line_up = Extent(low + RADIUS - 1, -1e4, high - RADIUS + 1, 1e4)
                    count += sum(b.overlaps(line_up) for b in self.solid)
                elif not is_loose:
                    count += sum(low - 1 < riser < high + 1 for riser in self.risers)
                count += is_loose and slack > 0 and any(b.overlaps(box) for b in self.occupied)
                x += sign * (one.width + WIRE)
            return count

        shares = [abs(spare) * share for share in (0.5, 0.3, 0.7, 0.1, 0.9)]
        return min([6.0 * i for i in range(8)] if is_loose else shares, key=met)

    def _height(self, branch: _Branch, room: Extent, risers: list[float]) -> tuple[float, bool]:
        """Return where a branch runs, and whether that is above its sum."""
        level, taken = self.y[branch.target], self.sides.setdefault(branch.target, [])
        down = free_level(room, level - RADIUS - 5, self.occupied, is_up=False)
        up = free_level(room, level + RADIUS + 5, self.occupied, is_up=True)
        is_up = "below" in taken
        if not is_up and "above" not in taken and self._is_blocked(risers, down, level):
            is_up = not self._is_blocked(risers, up, level)
        return (up if is_up else down), is_up

    def _is_blocked(self, risers: list[float], y: float, level: float) -> bool:
        """Tell whether vertical wires would pass through something."""
        low, high = sorted((y, level + (RADIUS + 1 if y > level else -RADIUS - 1)))
        return any(b.overlaps(Extent(x - 1, low, x + 1, high)) for b in self.solid for x in risers)

    # ------------------------------------------------------------------------------------------- symbols

    def _kind(self, node: int) -> str:
        return self.graph.nodes[node].kind

    def _shown(self, node: int, *, is_tag: bool) -> Built:
        one = self.graph.nodes[node]
        match one.kind:
            case "sum":
                ring = Placed("sum", "", (circle(RADIUS, 0.0, RADIUS),))
                return Built(2 * RADIUS, (ring,), -RADIUS, RADIUS)
            case kind if kind in BOXES:
                return self._box(one)
            case "signal" if not is_tag:
                return self._signal(one)
            case _:
                return self._tag(one, is_tag=is_tag)

    def _box(self, one: SignalNode) -> Built:
        fraction = formula(self.graph.blocks[one.name]) if one.kind == "block" else None
        shown = text(self.graph.labels.fraction(fraction), SIZE) if fraction is not None else None
        if shown and shown.width <= WIDEST:
            is_named = one.name not in self.graph.labels.written_delays
            return _boxed(one, shown, _fitting(one.label, SMALL) if is_named else None)
        return _boxed(one, _fitting(one.label, SIZE) or text(r"\cdots", SIZE), None)

    def _tag(self, one: SignalNode, *, is_tag: bool) -> Built:
        """Return a name at the beginning or end of a wire."""
        shown = _fitting(one.label, SIZE)
        if shown is None:
            return Built(1.0, (), -1.0, 1.0)
        middle = -(shown.height - shown.depth) / 2
        kind = "tag" if is_tag or one.kind == "reading" else one.kind
        placed = Placed(kind, one.name, (), (shown.moved(1.5, middle),))
        return Built(shown.width + 3, (placed,), middle - shown.depth, middle + shown.height)

    def _signal(self, one: SignalNode) -> Built:
        """Return a wire with its name, and the outputs that show it."""
        items: list[Placed] = []
        shown = _fitting(one.label, SIZE)
        wide = shown.width + 4 if shown else 4.0
        below, above = -1.0, 1.0
        if shown:
            items.append(Placed("signal", one.name, (), (shown.moved(2.0, 2.5 + shown.depth),)))
            above = 2.5 + shown.depth + shown.height
        index = self.graph.nodes.index(one)
        for end in one.after:
            if self._kind(end) == "output" and (index, end) not in self.joined and end not in self.drawn:
                self.joined.add((index, end))
                self.drawn.add(end)
                self.shown_at.setdefault(index, []).append(end)
        for end in self.shown_at.get(index, []):
            out = self.graph.nodes[end]
            label = _fitting(out.label, SIZE)
            dot = circle(wide, 0.0, DOT, fill=BLACK)
            items.append(Placed("output", out.name, (dot, *arrow((wide, 0.0), (wide, -13.0)))))
            if label:
                items.append(Placed("label", out.name, (), (label.moved(wide + 3, -10.0),)))
                wide += label.width + 8
            below = -14.0
        wire = Placed("wire", one.name, (line((0.0, 0.0), (wide, 0.0)),))
        return Built(wide, (*items, wire), below, above)


def _fitting(latex: str, size: float) -> Lettering | None:
    """Return a text that is not too wide for a box."""
    shown = text(latex, size)
    return shown if shown is None or shown.width <= WIDEST else text(r"\cdots", size)


def _boxed(one: SignalNode, shown: Lettering | None, name: Lettering | None) -> Built:
    texts = column_of([t for t in (shown, *(text(line, SMALL) for line in one.lines)) if t])
    block = union(t.box for t in texts)
    wide, tall = max(16.0, block.width + 2 * EDGE), max(7.0, block.height / 2 + EDGE)
    items = [Placed(one.kind, one.name, (rectangle(0.0, -tall, wide, tall),))]
    if texts:
        offset = wide / 2, -(block.y0 + block.y1) / 2
        items.append(Placed("label", one.name, (), tuple(t.moved(*offset) for t in texts)))
    above = tall
    if name:
        offset = (wide - name.width) / 2, tall + 2 + name.depth
        items.append(Placed("label", one.name, (), (name.moved(*offset),)))
        above += name.height + name.depth + 2
    return Built(wide, tuple(items), -tall, above)


def statements(graph: SignalGraph) -> list[Placed]:
    """Return equations, and the formulas of blocks that stand in no diagram, one below the other."""
    drawn = {n.name for n in graph.nodes if n.kind == "block"} | {*graph.labels.written_delays}
    y, lines_drawn = 0.0, []
    for equation in graph.equations:
        sides = " = ".join(graph.labels.expression(side) for side in equation.children)
        if shown := text(sides, SMALL):
            lines, y = downwards([shown], y, BETWEEN_FORMULAS)
            lines_drawn.append(Placed("condition", "", (), tuple(lines)))
    for block in (b for b in graph.blocks.values() if b.name not in drawn):
        value = formula(block)
        name = graph.labels.name(block.name)
        written = text(f"{name} = {graph.labels.fraction(value)}", SMALL) if value is not None else None
        written = written if written and written.width <= WIDEST_FORMULA else text(name, SMALL)
        values = filled(graph.labels.values([e for _, e in block.values]), WIDEST_FORMULA)
        lines, y = downwards((written, *values) if written else (), y, BETWEEN_FORMULAS)
        lines_drawn.append(Placed("block", block.name, (), tuple(lines)))
    return lines_drawn
