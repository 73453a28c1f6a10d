"""Plane frames drawn to their geometry: members where lengths and angles put them, all else around nodes.

Input: a network with members of frames, and the lengths and angles of these. Output: placed parts, or None
where members lie on each other and a row tells them apart better.

What stands at a node (supports, springs to the ground, arrows, labels) is tried in one place after the other,
until it touches nothing that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product
from math import acos, cos, dist, hypot, pi, sin, tan
from typing import TYPE_CHECKING, Final

from symflex.drawing.cells import coordinate, label_of, tags_of
from symflex.drawing.columns import flat_mark, mark_of_source, upright_mark
from symflex.drawing.geometry import BLACK, BOLD, FILLED, LINE, MEMBER, THIN, Extent, Placed, around, union
from symflex.drawing.lettering import SMALL, name_latex, text
from symflex.drawing.scheme import DrawnNetwork, DrawnPart, Mark, evaluate, values_of
from symflex.drawing.symbols import DOT, HALF, arrow, circle, guide, head, line, outline, rectangle, wall
from symflex.figures.runs import places_of_members

if TYPE_CHECKING:
    from symflex.drawing.geometry import Point
    from symflex.model import Model

EXTENT: Final = 95.0  # extent of a frame, and the least length of a member [points]
SHORTEST: Final = 40.0
LONGEST: Final = 500.0  # longest member beside one of the least length; other frames are drawn in a row
INNER: Final = HALF - LINE / 2  # half the width of a member without its outline
JOINT: Final = 2.4  # radius of a joint of members
CLAMP: Final = 8.0  # half the width of a wall that holds a member [points]
SHARP: Final = pi / 3  # members at a smaller angle would overlap where they meet
CLEAR: Final = 1.2
SAME: Final = 1e-6
DIRECTIONS: Final = ((0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0))
AROUND: Final = tuple((cos(pi / 180 * a), sin(pi / 180 * a)) for a in (45, 135, -45, -135, 90, 0, -90, 180))
MEMBERS: Final = ("frame", "rigid_link")
ALONE: Final = ("spring", "damper", "torsion_spring", "rotary_damper")


def frame_plan(network: DrawnNetwork, model: Model) -> tuple[list[Placed], list[DrawnPart]] | None:
    """Return the drawing of a frame and the parts that have no place in it; None without members of one."""
    if not any(p.type_name == "frame" for p in network.parts):
        return None
    plan = _Plan(network, model)
    return (plan.items, plan.others) if plan.is_sound else None


@dataclass
class _Plan:
    network: DrawnNetwork
    model: Model
    items: list[Placed] = field(default_factory=list)
    others: list[DrawnPart] = field(default_factory=list)
    solid: list[Extent] = field(default_factory=list)
    # Half the width and height of bodies.
    radius: dict[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.members = [p for p in self.network.parts if p.type_name in MEMBERS]
        self.vectors = self._vectors()
        self.ends = self._place()
        self.is_sound = self._is_sound()
        if not self.is_sound:
            return
        pairs = [pair for p in self.members for pair in zip(p.ends, self.ends[p.name], strict=True)]
        at = {end.node: point for end, point in pairs if end.node}
        # What a joint holds, such as a cart below its pole, has the place of the member's end.
        at = {self.joint(node): point for node, point in at.items()} | at
        self.at = {n: at[self.joint(n)] for n in self.network.nodes if self.joint(n) in at}
        self.at = at | self.at
        self.others = [p for p in self.network.parts if not self._belongs(p)]
        planned = [p for p in self.network.parts if p not in self.others]
        self._draw_bodies([p for p in planned if p.symbol.role == "body"])
        for x, y in filter(self._is_rigid, dict.fromkeys(self.at.values())):
            self.items.append(Placed("node", "", (circle(x, y, HALF, FILLED),)))
        for part in self.members:
            self._draw_member(part)
        self._draw_joints()
        for part in (p for p in planned if p.symbol.role == "support"):
            self._draw_support(part)
        for part in (p for p in planned if p.type_name in ALONE):
            if part.type_name == "torsion_spring":
                self._draw_spiral(part)
            else:
                self._draw_grounded(part)
        sources = [mark_of_source(p) for p in planned if p.symbol.role == "source"]
        for mark in (m for m in (*sources, *self.network.marks) if m.node in self.at):
            self._draw_mark(mark)
        for part in self.members:
            self._label(part)
        for node in dict.fromkeys(n for p in self.others for n in p.nodes if n in self.at):
            self._draw_mark(name_of(node))
        for part in (p for p in self.members if p.type_name == "frame"):
            self._draw_coordinate(part)

    # -------------------------------------------------------------------------------------------- places

    def joint(self, node: str) -> str:
        """Return the node in whose place another is, which a joint holds there."""
        for part in self.network.parts:
            if part.symbol.role == "support" and part.nodes[1:] == (node,):
                return self.joint(part.nodes[0])
        return node

    def _belongs(self, part: DrawnPart) -> bool:
        if any(n not in self.at for n in part.nodes):
            return False
        if part.type_name in MEMBERS or part.symbol.role == "body":
            return True
        is_spiral = part.type_name == "torsion_spring" and len(part.nodes) > 1
        if is_spiral or part.symbol.role in ("support", "source"):
            return len({tuple(round(v, 3) for v in self.at[n]) for n in part.nodes}) == 1
        return part.type_name in ALONE and len(part.nodes) == 1 and any(not e.node for e in part.ends)

    def _vectors(self) -> dict[str, tuple[float, float]]:
        values_by_name = values_of(self.model)
        values = {use.name: dict(use.values) for use in self.model.elements}
        vectors = {}
        for part in self.members:
            given = values[part.name]
            length = evaluate(given["l" if "l" in given else "length"], values_by_name) or 1.0
            angle = evaluate(given["angle"], values_by_name) or 0.0
            vectors[part.name] = (length * cos(angle), length * sin(angle))
        return vectors

    def _place(self) -> dict[str, tuple[Point, Point]]:
        """Return where both ends of each member are, at the scale of the drawing."""
        joints = {p.name: [self.joint(e.node) if e.node else "" for e in p.ends] for p in self.members}
        ends = places_of_members({name: (a, b, self.vectors[name]) for name, (a, b) in joints.items()})
        box = around(p for pair in ends.values() for p in pair)
        least = min(dist(a, b) for a, b in ends.values())
        scale = EXTENT / (max(box.width, box.height) or 1.0)
        scale = max(scale, SHORTEST / least) if least > SAME else scale
        return {n: ((a[0] * scale, a[1] * scale), (b[0] * scale, b[1] * scale)) for n, (a, b) in ends.items()}

    def _is_rigid(self, point: Point) -> bool:
        """Tell whether members run into each other at a place, without a body or a hinge."""
        hinges = (p.nodes for p in self.network.parts if p.symbol.role == "support" and len(p.nodes) > 1)
        held = (self.at[n] for n in (*self.radius, *(n for pair in hinges for n in pair)) if n in self.at)
        return self._meeting(point) > 1 and not any(_is_near(one, point) for one in held)

    def _draw_joints(self) -> None:
        for part in (p for p in self.members if p.type_name == "frame"):  # over the ends of other members
            shape = outline(*_corners(*self._shortened(part), INNER), fill=FILLED, width=0.0)
            self.items.append(Placed("node", "", (shape,)))
        for node, (x, y) in self.at.items():
            if all(self.at[other] != (x, y) for other in self.radius):
                radius = JOINT if self._meeting((x, y)) > 1 else DOT
                shape = circle(x, y, radius, fill=BLACK)
                if self._is_rigid((x, y)):
                    shape = circle(x, y, INNER, FILLED, 0.0)
                self.items.append(Placed("node", node, (shape,)))

    def _is_sound(self) -> bool:
        """Tell whether members lie beside each other, and each between its own ends."""
        for name, (a, b) in self.ends.items():
            dx, dy = self.vectors[name]
            size = dist(a, b)
            along = ((b[0] - a[0]) * dx + (b[1] - a[1]) * dy) / (size * hypot(dx, dy)) if size else 0.0
            if not SHORTEST - 1 < size < LONGEST or along < 1 - SAME:
                return False
        for one, other in combinations(self.ends.values(), 2):
            pieces = [list(_pieces(*pair, skip=9.0)) for pair in (one, other)]
            if any(a.overlaps(b) for a in pieces[0] for b in pieces[1]):
                return False
        pairs = (pair for p in self.members for pair in zip(p.ends, self.ends[p.name], strict=True))
        clamps = [point for end, point in pairs if not end.node]
        return all(dist(a, b) > 2 * CLAMP for a, b in combinations(clamps, 2))

    # ------------------------------------------------------------------------------------------- drawing

    def _add(self, *items: Placed) -> None:
        self.items.extend(items)
        self.solid.extend(e for i in items for e in i.extents)

    def _is_free(self, items: Sequence[Placed]) -> bool:
        return self._first_free(items, [(0.0, 0.0), (1.0, 1.0)]) == (0.0, 0.0)

    def _first_free(self, items: Sequence[Placed], moves: Iterable[Point]) -> Point:
        """Return the first move after which parts touch nothing that is drawn; the last one if all do."""
        pieces = [e.grown(1.6 if i.texts else 0.8) for i in items for e in i.extents]
        move = (0.0, 0.0)
        for move in moves:
            if not any(p.moved(*move).overlaps(s) for p in pieces for s in self.solid):
                break
        return move

    def _draw_bodies(self, bodies: Sequence[DrawnPart]) -> None:
        for node in dict.fromkeys(p.nodes[0] for p in bodies):
            of_node = [p for p in bodies if p.nodes[0] == node]
            written = [r",\,".join(one for one in (p.label, p.centre[0]) if one) for p in of_node]
            labels = [label_of(replace(p, label=one)) for one, p in zip(written, of_node, strict=True)]
            blocks = [label.box for label in labels]
            wide = max(14.0, *(b.width + 6 for b in blocks))
            wheels = [p.type_name == "inertia" for p in of_node]
            heights = [wide if w else max(13.0, b.height + 6) for w, b in zip(wheels, blocks, strict=True)]
            x, y = self.at[node]
            top = y + sum(heights) / 2
            self.radius[node] = (wide / 2, sum(heights) / 2)
            for part, label, height in zip(of_node, labels, heights, strict=True):
                shape = rectangle(x - wide / 2, top - height, x + wide / 2, top, FILLED)
                if part.type_name == "inertia":
                    shape = circle(x, top - height / 2, wide / 2, FILLED)
                self._add(Placed(part.kind, part.name, (shape,)))
                self._add(label.moved(x, top - height / 2 - label.box.centre[1]))
                top -= height

    def _meeting(self, point: Point) -> int:
        """Return how many members meet at a place."""
        return sum(_is_near(end, point) for pair in self.ends.values() for end in pair)

    def _body_at(self, point: Point) -> tuple[float, float]:
        """Return half the width and height of the body at a place, noughts where there is none."""
        found = [size for node, size in self.radius.items() if self.at[node] == point]
        return found[-1] if found else (0.0, 0.0)

    def _shortened(self, part: DrawnPart) -> tuple[Point, Point]:
        """Return the ends of a member at the surfaces of bodies."""
        a, b = self.ends[part.name]
        size, d = _direction(a, b)
        cuts = []
        for end, point, sign in ((part.ends[0], a, 1.0), (part.ends[1], b, -1.0)):
            wide, tall = self._body_at(self.at[end.node]) if end.node else (0.0, 0.0)
            reach = [h / abs(c) for h, c in ((wide, d[0]), (tall, d[1])) if abs(c) > SAME]
            meets = end.node and self._meeting(self.at[end.node]) > 1
            cut = min(reach) if wide else JOINT + 0.6 if meets and not self._is_rigid(point) else 0.0
            others = self._directions(point, but=part.name)
            cosines = (sign * (d[0] * e[0] + d[1] * e[1]) for e in others)
            narrow = min((acos(max(-1.0, min(1.0, c))) for c in cosines), default=pi)
            cuts.append(max(cut, min(HALF / tan(narrow / 2), size / 3)) if narrow < SHARP else cut)
        return (a[0] + cuts[0] * d[0], a[1] + cuts[0] * d[1]), (b[0] - cuts[1] * d[0], b[1] - cuts[1] * d[1])

    def _draw_member(self, part: DrawnPart) -> None:
        a, b = self._shortened(part)
        _, (dx, dy) = _direction(a, b)
        is_frame = part.type_name == "frame"
        shape = outline(*_corners(a, b, HALF), fill=FILLED) if is_frame else line(a, b, width=MEMBER)
        self._add(Placed(part.kind, part.name, (shape,)))
        ends = zip(part.ends, (a, b), self.ends[part.name], (-1.0, 1.0), strict=True)
        for end, at, joint, sign in ends:
            is_bare = not any(_is_near(self.at[n], joint) for n in self.radius)
            if is_bare and dist(at, joint) > JOINT + 1:
                # At a sharp angle to another one only its axis reaches the joint.
                self.items.append(Placed("wire", part.name, (line(joint, at, width=MEMBER),)))
            if not end.node:
                clamp = Placed("ground", "", wall(-CLAMP, CLAMP, 1)).rotated(sign * dx, sign * dy)
                self._add(clamp.moved(*at))

    def _directions(self, point: Point, but: str = "") -> list[Point]:
        """Return the directions of members from where they meet, but for one."""
        ends = [pair for name, pair in self.ends.items() if name != but]
        pairs = (pair for a, b in ends for pair in ((a, b), (b, a)))
        return [_direction(*pair)[1] for pair in pairs if _is_near(pair[0], point)]

    def _free_directions(self, node: str) -> list[Point]:
        """Return directions from a node, the one farthest from its members first."""
        taken = self._directions(self.at[node])

        def nearest(d: Point) -> float:
            return round(max((d[0] * t[0] + d[1] * t[1] for t in taken), default=0.0), 3)

        return sorted(DIRECTIONS, key=nearest)

    def _surface(self, node: str, direction: Point) -> float:
        """Return how far the body at a node reaches in a direction along x or y."""
        wide, tall = self.radius.get(node, (DOT + 1.0, DOT + 1.0))
        return wide if direction[0] else tall

    def _draw_support(self, part: DrawnPart) -> None:
        node = part.nodes[0]
        x, y = self.at[node]
        if len(part.nodes) > 1:
            x, y = self._hinge(part.nodes[1])
            is_pin = part.type_name == "pin"
            ring = circle(x, y, JOINT - 0.3) if is_pin else rectangle(x - 1.8, y - 1.8, x + 1.8, y + 1.8)
            self.items.append(Placed(part.kind, part.name, (ring,)))
            self.solid.append(self.items[-1].box)
            return
        symbol = Placed(part.kind, part.name, part.symbol.hold())
        component, directions = part.ends[0].component, self._free_directions(node)
        if part.type_name == "fixed" and component in ("x", "y"):
            # It rolls along the other one.
            symbol = Placed(part.kind, part.name, guide(-7, 7, -1, 0)).rotated(0, 1)
            directions = [d for d in directions if bool(d[0]) is (component == "x")]
        for d in directions:
            surface = self._surface(node, d)
            start, foot = ((x + d[0] * r, y + d[1] * r) for r in (surface, surface + CLEAR))
            turned = symbol.rotated(-d[1], d[0]).moved(*foot)
            if self._is_free([turned]):
                self._add(turned, Placed("wire", node, (line(start, foot),)))
                break
        else:
            self._beside([symbol], node)
        self._tags(part, node)

    def _beside(self, items: Sequence[Placed], node: str) -> None:
        """Draw parts near a node, in the first place that is free."""
        self._near(items, _about(self.at[node], *self.radius.get(node, (2.0, 2.0))))

    def _near(self, items: Sequence[Placed], what: Extent) -> None:
        """Draw parts beside a rectangle, in the first place that is free."""
        box = union(i.box for i in items)

        def moves() -> Iterator[Point]:
            distances = (4.0, 8.0, 13.0, 20.0, 30.0, 42.0, 60.0, 90.0, 130.0, 200.0)
            for distance, (dx, dy) in product(distances, AROUND):
                side = ((dx > SAME) - (dx < -SAME), (dy > SAME) - (dy < -SAME))
                x = what.centre[0] + dx * (what.width / 2 + distance) + side[0] * box.width / 2
                y = what.centre[1] + dy * (what.height / 2 + distance) + side[1] * box.height / 2
                yield x - box.centre[0], y - box.centre[1]

        move = self._first_free(items, moves())
        self._add(*(i.moved(*move) for i in items))

    def _tags(self, part: DrawnPart, node: str) -> None:
        for one in tags_of(part):
            self._beside(one.placed, node)

    def _draw_grounded(self, part: DrawnPart) -> None:
        """Draw a spring or damper from a node to the ground, along the component that it acts on."""
        node = part.nodes[0]
        component = next(e.component for e in part.ends if e.node)
        free, is_turning = self._free_directions(node), component == "theta"
        allowed = [d for d in free if is_turning or bool(d[0]) is (component == "x")]
        length = part.symbol.length
        tried: list[list[Placed]] = []
        for stub, d in product((2.0, 10.0, 20.0, 34.0, 50.0), allowed):
            reach = self._surface(node, d) + stub
            symbol = Placed(part.kind, part.name, part.symbol.draw(length)).moved(reach, 0)
            base = Placed("ground", "", wall(-6, 6, 1, reach + length))
            lead = Placed("wire", part.name, (line((self._surface(node, d), 0.0), (reach, 0.0)),))
            tried.append([i.rotated(*d).moved(*self.at[node]) for i in (symbol, base, lead)])
            if self._is_free(tried[-1]):
                self._add(*tried[-1])
                break
        else:
            self._near(tried[0], _about(self.at[node], 4.0, 4.0))
        self._finish(part, self.items[-3])

    def _hinge(self, node: str) -> Point:
        """Return where a member or spring turns about what a joint holds: the surface of a body there."""
        point = self.at[node]
        has_body = any(self.at[other] == point for other in self.radius)
        for part in self.members if has_body and self.joint(node) != node else ():
            for end, at in zip(part.ends, self._shortened(part), strict=True):
                if end.node == node:
                    return at
        return point

    def _draw_spiral(self, part: DrawnPart) -> None:
        """Draw a torsion spring round the joint that it acts on; its outer end may be held by the ground."""
        node = part.nodes[0]
        x, y = next((xy for n in part.nodes if (xy := self._hinge(n)) != self.at[n]), self.at[node])
        is_apart = (x, y) != self.at[node]
        sizes = (max(size) for n, size in self.radius.items() if self.at[n] == (x, y) and not is_apart)
        inner = max(sizes, default=JOINT)
        dx, dy = self._free_directions(node)[-1 if len(part.nodes) > 1 else 1]
        steps = (i / 48 for i in range(48 + 1))
        polar = [(inner + CLEAR + 7.0 * share, 2 * pi * 1.75 * (share - 1)) for share in steps]
        spiral = line(*((r * cos(a), r * sin(a)) for r, a in polar))
        items = [Placed(part.kind, part.name, (spiral,))]
        if len(part.nodes) == 1:
            items.append(Placed("ground", "", wall(-5, 5, 1, polar[-1][0])))
        turned = [i.rotated(dx, dy).moved(x, y) for i in items]
        self._add(*turned)
        if is_apart:  # behind the body, whose letters it would strike out
            self.items = [turned[0], *(i for i in self.items if i is not turned[0])]
        self._finish(part, turned[0])

    def _finish(self, part: DrawnPart, symbol: Placed) -> None:
        """Write what belongs to a symbol beside it."""
        self._near([label_of(part)], symbol.box)
        self._tags(part, part.nodes[0])

    def _draw_mark(self, mark: Mark) -> None:
        """Draw an arrow at a node, or near it where there is no room at it."""
        x, y = self.at[mark.node]
        if mark.style in ("force", "push"):
            kind, name, label = mark.labels[0]
            d = (1.0, 0.0) if mark.style == "force" else (0.0, 1.0)
            shown, reach = text(label), self._surface(mark.node, d) + CLEAR
            for start in (reach, -reach - 17):
                strokes = arrow((start, 0.0), (start + 17, 0.0), BOLD)
                shaft = Placed(kind, name, strokes).rotated(*d).moved(x, y)
                if self._is_free([shaft]):
                    self._add(shaft)
                    if shown:
                        self._near([Placed("label", name, (), (shown,))], shaft.box)
                    for each, other, words in mark.labels[1:]:
                        if extra := text(words):
                            self._beside([Placed(each, other, (), (extra,))], mark.node)
                    return
        flat = mark.style in ("shift", "force", "motion")
        items = flat_mark(mark, 0.0, 0.0) if flat else upright_mark(mark, 0.0, 0.0)
        self._beside(items, mark.node)

    def _draw_coordinate(self, part: DrawnPart) -> None:
        """Draw an arrow along x close to where a member begins, if there is room on one side."""
        a, b = self._shortened(part)
        _, d = _direction(a, b)
        for off in (s * (HALF + more) for more in (3.5, 5.5) for s in (-1, 1)):
            items = [i.moved(1.5, 0).rotated(*d).moved(*a) for i in coordinate(off)]
            if self._is_free(items):
                self._add(*items)
                return

    def _label(self, part: DrawnPart) -> None:
        """Write the label of a member beside it, and mark outputs at its points."""
        a, b = self._shortened(part)
        size, d = _direction(a, b)
        n = (-d[1], d[0])
        for share, name, label in part.points:
            shown = text(label, SMALL)
            if shown is None:
                continue
            at = min(max(size * share, 6.0), size - 6.0)
            x, y = a[0] + at * d[0], a[1] + at * d[1]
            options = []
            for distance, sign in product((9.0, 14.0, 20.0, 30.0), (1.0, -1.0)):
                m = (sign * n[0], sign * n[1])
                far = _reach(shown.box, m) + distance + 2
                tip = (x + 3.0 * m[0], y + 3.0 * m[1])
                stem = line((x + distance * m[0], y + distance * m[1]), tip, width=THIN)
                cx, cy = shown.box.centre
                placed = shown.moved(x + far * m[0] - cx, y + far * m[1] - cy)
                marker = Placed("output", name, (stem, head(tip, (-m[0], -m[1]), 3.0)))
                options.append([marker, Placed("label", name, (), (placed,))])
            self._add(*next(filter(self._is_free, options), options[-1]))
        lettering = label_of(part)
        (x, y), near = lettering.box.centre, _reach(lettering.box, n) + HALF + 2.5
        tried = product((0.0, 6.0, 14.0, 26.0, 40.0), (0.5, 0.38, 0.62, 0.25, 0.75), (1.0, -1.0))
        places = ((share * size, sign * (near + more)) for more, share, sign in tried)
        moves = ((a[0] + u * d[0] + v * n[0], a[1] + u * d[1] + v * n[1]) for u, v in places)
        lettering = lettering.moved(-x, -y)
        self._add(lettering.moved(*self._first_free([lettering], moves)))
        for one in tags_of(part):
            self._near(one.placed, _about((a[0] + 0.5 * size * d[0], a[1] + 0.5 * size * d[1]), 4.0, 4.0))


def name_of(node: str) -> Mark:
    """Return the name of a node that stands in a frame and in a row beside it."""
    return Mark("probe", node, (("tag", node, name_latex(node)),))


def _reach(box: Extent, direction: Point) -> float:
    """Return how far a rectangle reaches from its middle in a direction, corners cut."""
    return (abs(direction[0]) * box.width + abs(direction[1]) * box.height) / 2


def _about(centre: Point, wide: float, tall: float) -> Extent:
    """Return a rectangle by its middle and half its width and height."""
    return Extent(centre[0] - wide, centre[1] - tall, centre[0] + wide, centre[1] + tall)


def _corners(a: Point, b: Point, half: float) -> list[Point]:
    """Return the corners of a member between two points, half of whose width is given."""
    _, (dx, dy) = _direction(a, b)
    return [(x - s * dy * half, y + s * dx * half) for (x, y), s in ((a, 1), (b, 1), (b, -1), (a, -1))]


def _direction(a: Point, b: Point) -> tuple[float, Point]:
    """Return how far one point is from another, and in which direction."""
    size = dist(a, b) or 1.0
    return size, ((b[0] - a[0]) / size, (b[1] - a[1]) / size)


def _is_near(a: Point, b: Point) -> bool:
    return abs(a[0] - b[0]) + abs(a[1] - b[1]) < 1.0


def _pieces(a: Point, b: Point, skip: float) -> Iterator[Extent]:
    """Yield squares along a line between two points, but near its ends."""
    size = dist(a, b)
    count = max(2, int(size / 3))
    for share in (i / count for i in range(count + 1)):
        if skip < share * size < size - skip:
            yield _about((a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])), HALF, HALF)
