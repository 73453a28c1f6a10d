"""Where the parts of a model stand in a figure of its modes: in rows, laid end to end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING, Final

from symflex.expressions import Name
from symflex.library.elements import LineElement

if TYPE_CHECKING:
    from symflex.analysis.modes import DistributedShape, EnclosedShape
    from symflex.model import Model, PlacedElement

Vector = tuple[float, float]
AT_REST: Final = 1e-9
SUPPORTS: Final = ("fixed", "pin", "slider")
APART: Final = 0.3  # space between members that no node joins, as a share of the length of one


@dataclass(frozen=True, slots=True)
class Segment:
    """A distributed part in a panel."""

    name: str  # the element's or field's
    offset: float  # where it begins on the panel's axis
    is_reversed: bool = False  # its x runs against the axis


@dataclass(frozen=True, slots=True)
class Run:
    """Distributed parts end to end."""

    segments: tuple[Segment, ...]  # in order along the axis
    ends: tuple[float, ...]  # where they begin and end
    loaded: tuple[tuple[str, float], ...] = ()  # nodes that carry inertia, and where they are
    is_turning: bool = False  # the displacement is an angle
    unit: str = "m"  # of the axis; empty when unknown


@dataclass(frozen=True, slots=True)
class Stems:
    """Nodes side by side; ``unit`` is that of their motion."""

    names: tuple[str, ...]
    unit: str


@dataclass(frozen=True, slots=True)
class Plan:
    """Members of frames where they lie in the plane [m]."""

    members: tuple[tuple[str, float, float], ...]  # names, and where their first ends are
    loaded: tuple[tuple[str, float, float], ...]  # nodes that carry inertia
    held: tuple[
        tuple[str, float, float], ...
    ] = ()  # how ends are held, ``fixed``, ``pin`` or ``slider``, and where


Panel = Run | Plan | Stems


def panels_of(model: Model, shapes: Sequence[EnclosedShape]) -> tuple[Panel, ...]:
    """Return what a figure of the modes shows; voltages and signals when nothing else moves."""
    if not shapes:
        return ()
    parts = {part.name: part for part in shapes[0].distributed}
    runs: list[Panel] = [*_plan(model, parts), *_runs_of_elements(model, parts)]
    runs += _runs_of_fields(model, parts)
    shown = _nodes_on(model)
    stems = []
    for unit in ("m", "rad"):
        names = [
            m.name
            for m in shapes[0].motions
            if m.unit == unit and m.variable.kind == "node" and m.name not in shown
            if any(abs(complex(shape.motion(m.name).value.mid())) > AT_REST for shape in shapes)
        ]
        if names:
            stems.append(Stems(tuple(names), unit))
    if not runs and not stems:
        lumped = [m for m in shapes[0].motions if m.variable.kind in ("node", "signal")]
        units = dict.fromkeys(m.unit for m in lumped)
        stems = [Stems(tuple(m.name for m in lumped if m.unit == unit), unit) for unit in units]
    return (*runs, *stems)


def _ends(use: PlacedElement) -> tuple[str, str]:
    a, b = dict(use.nodes)["between"]
    return a.node, b.node


def _lines(model: Model) -> Iterator[PlacedElement]:
    return (use for use in model.elements if isinstance(use.element, LineElement))


def _nodes_on(model: Model) -> set[str]:
    """Return the names of motions that distributed elements show."""
    nodes: set[str] = set()
    for use in _lines(model):
        for node in _ends(use):
            nodes |= {node, f"{node}.y", f"{node}.theta"}
            if isinstance(use.element, LineElement) and "x" in use.element.ends:
                nodes.add(f"{node}.x")
    return nodes


def _carrying(model: Model) -> set[str]:
    """Return the nodes that inertia moves with."""
    heavy = [use for use in model.elements if use.element.is_inertia]
    return {reference.node for use in heavy for _, found in use.nodes for reference in found}


def _plan(model: Model, parts: dict[str, DistributedShape]) -> Iterator[Plan]:
    """Yield the members of frames, joined ones side by side; each end at ground is a place of its own."""
    lines = [use for use in _lines(model) if parts[use.name].direction]
    joints = [found for use in model.elements if use.element.carries_x for _, found in use.nodes]
    pairs = [(found[0], other) for found in joints for other in found[1:]]
    joined = {b.node: a.node for a, b in pairs if not (a.is_ground or b.is_ground)}

    def joint(node: str) -> str:
        while node in joined:
            node = joined[node]
        return "" if node == "ground" else node

    def reach(part: DistributedShape) -> Vector:
        x, y = (float(part.length.mid()) * float(x.mid()) for x in part.direction)
        return x, y

    nodes = {use.name: _ends(use) for use in lines}
    ends = places_of_members({n: (joint(a), joint(b), reach(parts[n])) for n, (a, b) in nodes.items()})
    if lines:
        carrying = _carrying(model)
        at = {node: point for n, both in nodes.items() for node, point in zip(both, ends[n], strict=True)}
        loaded = tuple((node, *point) for node, point in at.items() if node in carrying)
        places = [
            (node, point) for n, both in nodes.items() for node, point in zip(both, ends[n], strict=True)
        ]
        support = _supports(model)
        held = tuple(dict.fromkeys((support[node], *point) for node, point in places if node in support))
        yield Plan(tuple((name, *start) for name, (start, _) in ends.items()), loaded, held)


def _supports(model: Model) -> dict[str, str]:
    """Return how nodes are held: ``fixed`` (ground, too), ``pin`` or ``slider``."""
    found = {"ground": "fixed"}
    for use in model.elements:
        if use.element.type_name in SUPPORTS:
            found |= {reference.node: use.element.type_name for _, at in use.nodes for reference in at}
    return found


def places_of_members(members: Mapping[str, tuple[str, str, Vector]]) -> dict[str, tuple[Vector, Vector]]:
    """Return where both ends of each member are, those that are joined beside each other.

    A member has the joints at its ends, ``""`` for a place of its own, and how far it reaches from the first
    to the second. One that is not joined to those before begins to their right.
    """
    places: dict[str, Vector] = {}
    ends: dict[str, tuple[Vector, Vector]] = {}
    waiting = dict(members)
    while waiting:
        beside = (n for n, (a, b, _) in waiting.items() if a in places or b in places)
        name = next(beside, next(iter(waiting)))
        a, b, (dx, dy) = waiting.pop(name)
        far = max((x for pair in ends.values() for x, _ in pair), default=0.0)
        right = far + bool(ends) * APART * hypot(dx, dy) - min(dx, 0.0)
        start = places.get(a) or ((places[b][0] - dx, places[b][1] - dy) if b in places else (right, 0.0))
        end = places.get(b) or (start[0] + dx, start[1] + dy)
        ends[name] = (start, end)
        for node, point in ((a, start), (b, end)):
            if node:
                places.setdefault(node, point)
    return ends


def _runs_of_elements(model: Model, parts: dict[str, DistributedShape]) -> Iterator[Run]:
    """Yield elements of one kind that follow each other, laid end to end."""
    carrying = _carrying(model)
    lines = [use for use in _lines(model) if not parts[use.name].direction]
    waiting = list(lines)
    while waiting:
        chain = _chain(waiting[0], lines)
        offset, segments, ends, loaded = 0.0, [], [0.0], []
        for use, is_reversed in chain:
            waiting.remove(use)
            first, second = _ends(use)[:: -1 if is_reversed else 1]
            length = float(parts[use.name].length.mid())
            segments.append(Segment(use.name, offset, is_reversed))
            loaded += [(n, x) for n, x in ((first, offset), (second, offset + length)) if n in carrying]
            offset += length
            ends.append(offset)
        is_turning = chain[0][0].element.ports[0].domain == "rotation"
        yield Run(tuple(segments), tuple(ends), tuple(dict.fromkeys(loaded)), is_turning)


def _chain(first: PlacedElement, lines: Sequence[PlacedElement]) -> list[tuple[PlacedElement, bool]]:
    """Return the path of elements of one kind that holds one, each with whether it is walked backwards."""
    kind = first.element.type_name
    meeting: dict[str, list[PlacedElement]] = {}
    for use in (use for use in lines if use.element.type_name == kind):
        for node in _ends(use):
            meeting.setdefault(node, []).append(use)

    def beyond(node: str, use: PlacedElement) -> PlacedElement | None:
        """Return the one other element at a node; beams must go on in the direction of their x."""
        others = [other for other in meeting[node] if other is not use]
        if node == "ground" or len(others) != 1:
            return None
        is_folded = _ends(others[0]).index(node) == _ends(use).index(node)
        return None if is_folded and use.element.compliance == "bending" else others[0]

    start, node = first, _ends(first)[0]
    seen = {start.name}
    while (before := beyond(node, start)) is not None and before.name not in seen:
        seen.add(before.name)
        a, b = _ends(before)
        start, node = before, a if b == node else b
    chain: dict[str, tuple[PlacedElement, bool]] = {}
    here: PlacedElement | None = start
    while here is not None and here.name not in chain:
        a, b = _ends(here)
        is_reversed = node == b != a
        chain[here.name] = here, is_reversed
        node = a if is_reversed else b
        here = beyond(node, here)
    return list(chain.values())


def _runs_of_fields(model: Model, parts: dict[str, DistributedShape]) -> Iterator[Run]:
    """Yield fields whose domains do not overlap, on one axis."""
    units = {p.name: p.unit for p in model.parameters}
    runs: list[list[tuple[float, float, str]]] = []
    unit = ""
    for field in model.fields:
        part = parts[field.name]
        low, high = sorted((float(part.start.mid()), float((part.start + part.length).mid())))
        named = [e.name for e in (field.end, field.start) if isinstance(e, Name) and e.name in units]
        unit = units[named[0]] if named else unit
        free = (run for run in runs if all(high <= a + AT_REST or low >= b - AT_REST for a, b, _ in run))
        if not (fitting := next(free, [])):
            runs.append(fitting)
        fitting.append((low, high, field.name))
    for run in runs:
        run.sort()
        segments = tuple(Segment(name, low) for low, _, name in run)
        ends = tuple(dict.fromkeys(x for low, high, _ in run for x in (low, high)))
        yield Run(segments, ends, (), False, unit)
