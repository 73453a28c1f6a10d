"""What is to be drawn of a model: parts at nodes, grouped in networks, and marks of inputs and outputs.

Input: a resolved model. Output: a :class:`Scheme`, which knows nothing of places.

    spring between x and ground, F at x, output s*x    a spring with the ends x and ground, Mark("force", x),
                                                       Mark("shift", x) with the output's label
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from typing import Final, Literal

from symflex.drawing.lettering import Labels
from symflex.drawing.signals import whole
from symflex.drawing.symbols import (
    FORCE_BETWEEN,
    MOTION_BETWEEN,
    SYMBOLS,
    TORQUE_BETWEEN,
    TRANSFORMER_SYMBOLS,
    TRANSFORMERS,
    ElementSymbol,
    box,
    rack,
    screw,
    tapered,
)
from symflex.expressions import (
    Attribute,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    names,
)
from symflex.library.elements import CIRCUITS, COMPONENT_DOMAIN, COMPONENTS, LineElement
from symflex.model import DrawingHints, Input, Model, NodeReference, Output, PlacedElement
from symflex.model.along import COORDINATE, is_tapered
from symflex.model.model import INPUT_KINDS

GROUND: Final = ""
Domains = Mapping[str, str]
Depths = tuple[float, ...]
Tags = tuple[tuple[str, str, str], ...]
Style = Literal["shift", "lift", "turn", "probe", "force", "push", "torque", "motion", "raise", "twist"]


@dataclass(frozen=True, slots=True)
class End:
    """Where a part is attached."""

    node: str  # empty for the reference
    domain: str  # in which it acts there: ``translation``, ``rotation`` or ``electrical``
    component: str = ""


@dataclass(frozen=True, slots=True)
class DrawnPart:
    """An element, or an input between two nodes, as a symbol with ends."""

    kind: str  # ``element`` or ``input``
    name: str
    type_name: str
    symbol: ElementSymbol
    ends: tuple[End, ...]
    label: str  # mathematics
    lines: tuple[str, ...] = ()  # what it is called, and values where they are asked for
    tags: Tags = ()  # what shows or reads what it carries, as of a mark
    points: tuple[tuple[float, str, str], ...] = ()  # share of its length, output there and its label
    depths: Depths = ()  # of a member that tapers, at even stations
    # Of a body: where its mass centre lies, in mathematics, and whether that is before its node (-1).
    centre: tuple[str, int] = ("", 1)
    # Of a member: its length, and what is left of its label where a dimension shows that.
    dimension: tuple[str, str] = ("", "")

    @property
    def nodes(self) -> tuple[str, ...]:
        """The nodes it is attached to, without the reference."""
        return tuple(dict.fromkeys(e.node for e in self.ends if e.node))


@dataclass(frozen=True, slots=True)
class Mark:
    """An input or the outputs at a node, drawn as an arrow."""

    style: Style
    node: str
    # Kind (``input``, ``output``, ``element``, ``reading``), name and mathematics.
    labels: Tags


@dataclass(frozen=True, slots=True)
class Distance:
    """An output that is the difference of two nodes, or the length of a member between them."""

    nodes: tuple[str, str]  # one of a member's is empty where it ends at the ground
    name: str
    label: str
    lines: tuple[str, ...] = ()  # values, where they are asked for
    is_length: bool = False


@dataclass(frozen=True, slots=True)
class DrawnNetwork:
    """Parts that hang together, and what is marked at their nodes."""

    nodes: tuple[str, ...]
    parts: tuple[DrawnPart, ...]
    marks: tuple[Mark, ...]
    spans: tuple[Distance, ...]
    order: tuple[str, ...] = ()  # nodes as the specification wants them, from left to right
    has_rollers: bool = False  # below its masses


@dataclass(frozen=True, slots=True)
class Scheme:
    """All that is drawn of nodes and elements; ``others`` are outputs of another kind."""

    networks: tuple[DrawnNetwork, ...]
    domains: Domains  # of nodes: ``translation``, ``rotation``, ``electrical``, ``planar``, ``plane``
    others: tuple[str, ...]


def scheme_of(model: Model, labels: Labels) -> Scheme:
    """Return what is drawn of a model's elements, nodes, inputs and outputs."""
    domains = _domains(model)
    collected = _Collected([_part(use, labels, domains) for use in model.elements])
    for one in model.inputs:
        if len(one.nodes) > 1 or (one.nodes and INPUT_KINDS[one.kind].domain in CIRCUITS):
            collected.parts.append(_input_part(one, labels))
        elif one.nodes:
            collected.marks.append(_input_mark(one, labels, domains))
    signals = frozenset(x.name for x in model.signals)
    for out in model.outputs:
        collected.show(model, out, labels.end(out.name, out.latex), domains, signals)
    seen = [Mark(style, node, tuple(shown)) for (style, node), shown in collected.seen.items()]
    networks = _networks(tuple(domains), collected.parts, [*collected.marks, *seen], collected.spans)
    together = {node: i for i, net in enumerate(networks) for node in net.nodes}
    apart = [s.name for s in collected.spans if together[s.nodes[0]] != together[s.nodes[1]]]
    networks = tuple(_as_wanted(net, domains, model.drawing) for net in networks)
    return Scheme(networks, domains, (*collected.others, *apart))


def _domains(model: Model) -> dict[str, str]:
    """Return how nodes move: what holds a string moves across it, as the end of a beam does."""
    held: dict[str, set[str]] = {"string": set(), "rod": set()}
    for use in model.elements:
        ends = (r.node for _, references in use.nodes for r in references if not r.is_ground)
        held.get(use.element.type_name, set()).update(ends)
    across = held["string"] - held["rod"]
    return {n.name: "planar" if n.name in across else n.domain for n in model.nodes}


def _as_wanted(net: DrawnNetwork, domains: Domains, hints: DrawingHints) -> DrawnNetwork:
    """Return a network as the specification wants it; rollers show masses that nothing else guides."""
    is_free = all(domains[n] == "translation" for n in net.nodes) and not (
        any(p.symbol.role == "support" or any(not e.node for e in p.ends) for p in net.parts)
        or any(m.style == "motion" and m.labels[0][0] == "input" for m in net.marks)
    )
    rollers = is_free if hints.rollers is None else hints.rollers
    return replace(net, order=tuple(n for n in hints.order if n in net.nodes), has_rollers=rollers)


def with_readings(scheme: Scheme, readings: Sequence[str], labels: Labels) -> Scheme:
    """Return a scheme with marks at the nodes and elements that signals read."""
    networks = list(scheme.networks)
    for name in readings:
        owner, _, component = name.partition(".")
        end = _node(Attribute(owner, component) if component else Name(owner), scheme.domains)
        shown = ("reading", name, labels.name(name))
        for i, net in enumerate(networks):
            if owner in net.nodes and end:
                style = _style(end, scheme.domains)
                at = next((m for m in net.marks if (m.style, m.node) == (style, owner)), None)
                marks = [m for m in net.marks if m is not at]
                index = net.marks.index(at) if at else len(marks)
                beside = at.labels if at else ()
                if all(label != shown[2] for *_, label in beside):
                    marks.insert(index, Mark(style, owner, (*beside, shown)))
                    networks[i] = replace(net, marks=tuple(marks))
            elif component and any(p.name == owner for p in net.parts):
                parts = [replace(p, tags=(*p.tags, shown)) if p.name == owner else p for p in net.parts]
                networks[i] = replace(net, parts=tuple(parts))
    return replace(scheme, networks=tuple(networks))


@dataclass
class _Collected:
    """What is found of a model, as its outputs are looked at one by one."""

    parts: list[DrawnPart]
    marks: list[Mark] = field(default_factory=list)
    spans: list[Distance] = field(default_factory=list)
    seen: dict[tuple[Style, str], list[tuple[str, str, str]]] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)

    def show(self, model: Model, out: Output, label: str, domains: Domains, signals: frozenset[str]) -> None:
        """Mark an output where it is, or note that it is at no one place."""
        core = without_s(out.expression)
        of_signals = signals & {n.name for n in names(core) if isinstance(n, Name)}
        end = None if of_signals else _node(core, domains)
        pair = None if of_signals else _difference(core, domains)
        call = _place(out.expression)
        shown = ("output", out.name, label)
        if end:
            self.seen.setdefault((_style(end, domains), end.node), []).append(shown)
        elif pair:
            self.spans.append(Distance(pair, out.name, label))
        elif not (isinstance(core, Attribute) and self._tag(core.owner, shown)):
            point = (_share(model, call), out.name, label) if call else None
            if not (call and point and self._write(call.name.partition(".")[0], points=(point,))):
                self.others.append(out.name)

    def _write(self, name: str, tags: Tags = (), points: tuple[tuple[float, str, str], ...] = ()) -> bool:
        """Add tags and points to a part; False where there is none of that name."""
        for i, part in enumerate(self.parts):
            if part.name == name:
                every = tuple(sorted((*part.points, *points)))
                self.parts[i] = replace(part, tags=(*part.tags, *tags), points=every)
                return True
        return False

    def _tag(self, owner: str, shown: tuple[str, str, str]) -> bool:
        """Write an output at the element or input whose force, torque or current it is."""
        i, mark = next(((i, m) for i, m in enumerate(self.marks) if m.labels[0][1] == owner), (0, None))
        if mark is None:
            return self._write(owner, (shown,))
        if mark.style == "motion":  # what that takes
            self.marks.append(Mark("force", mark.node, (shown,)))
        else:
            self.marks[i] = replace(mark, labels=(*mark.labels, shown))
        return True


def _part(use: PlacedElement, labels: Labels, domains: Domains) -> DrawnPart:
    by_port = dict(use.domains)
    ends = tuple(_end(r, by_port[port], domains) for port, references in use.nodes for r in references)
    kind = use.element.type_name
    symbol = SYMBOLS.get(kind, ElementSymbol("coupling"))  # a plain box for one that has none
    if kind == "transformer":
        first = [_end(references[0], by_port[port], domains) for port, references in use.nodes]
        pair = (first[0].domain, first[1].domain)
        drawn = TRANSFORMERS.get(pair, box) if len(ends) == len(pair) else box
        turned = {"pi", *(p.name for p in labels.model.parameters if "rev" in p.written_unit)}
        if drawn == rack and any(n.name in turned for n in names(use.values[0][1])):
            drawn = screw
        symbol = ElementSymbol("coupling", drawn, 34.0)
    elif kind in BETWEEN and len(ends) > 1:
        symbol = replace(BETWEEN[kind], role="source")
    if wanted := dict(labels.model.drawing.symbols).get(use.name):
        symbol = replace(symbol, draw=TRANSFORMER_SYMBOLS[wanted])
    label, lines = _label(use, labels)
    if symbol.role == "support" and len(ends) == 1 and not use.latex:
        label = ""
    if use.latex and label != (called := labels.end(use.name, use.latex)):
        lines = (called, *lines)
    sections = _sections(use, labels.model) if kind in TAPERS else ()
    if sections:
        symbol = replace(symbol, draw=partial(tapered, symbol.draw, sections))
    centre, dimension = _centre(use, labels), _dimension(use, labels, label)
    return DrawnPart(
        "element", use.name, kind, symbol, ends, label, lines, (), (), sections, centre, dimension
    )


def _dimension(use: PlacedElement, labels: Labels, label: str) -> tuple[str, str]:
    """Return the length of a member, and its label without it; nothing of what has no length."""
    values = dict(use.values)
    if not (length := values.get("l", values.get("length"))):
        return "", ""
    written = labels.quantity(length, "m")
    return written, JOINED.join(one for one in label.split(JOINED) if one not in (written, f"{{{written}}}"))


def _centre(use: PlacedElement, labels: Labels) -> tuple[str, int]:
    """Return where the mass centre of a rigid body lies."""
    offset = dict(use.values).get("cg", Number(Fraction(0)))
    if offset == Number(Fraction(0)):
        return "", 1
    value = evaluate(offset, values_of(labels.model))
    return labels.quantity(offset, "m"), -1 if value is not None and value < 0 else 1


TAPERS: Final = {
    "beam": (("I", "EI"), ("A", "rhoA")),
    "rod": (("A", "EA", "rhoA"), ("A", "rhoA", "EA")),
    "shaft": (("J", "GJ", "rhoJ"), ("J", "rhoJ", "GJ")),
}  # measures of a section that may vary along a member, the first that is given: how stiff it is, and heavy


def _sections(use: PlacedElement, model: Model) -> Depths:
    if not is_tapered(model):
        return ()
    known, values = values_of(model), dict(use.values)
    measures = TAPERS[use.element.type_name]
    stiff, heavy = (next(values[name] for name in names if name in values) for names in measures)
    ends = (0.0, evaluate(values["l"], known) or UNKNOWN)
    return sections(stiff, heavy, ends, known, {"rod": 2, "shaft": 4}.get(use.element.type_name))


def sections(
    stiff: Expression,
    heavy: Expression,
    ends: tuple[float, float],
    known: Mapping[str, float],
    root: int | None,
) -> Depths:
    """Return the depths of a member by its section: a ``root``, of a beam (None) the radius of gyration."""
    if root:
        return depths(heavy, ends, known, root)
    return depths(Quotient(stiff, heavy), ends, known, 2) or depths(heavy, ends, known, 1)


def _end(reference: NodeReference, domain: str, domains: Domains) -> End:
    if reference.is_ground:
        return End(GROUND, "translation" if domain in COMPONENTS else domain)
    node_domain = domains[reference.node]
    component = reference.component
    if domain in COMPONENTS:
        return End(reference.node, "translation", component)
    if node_domain in COMPONENTS and not component:
        component = "theta" if domain == "rotation" else "y"
    return End(reference.node, COMPONENT_DOMAIN[component] if component else domain, component)


BETWEEN: Final = {"force_source": FORCE_BETWEEN, "torque_source": TORQUE_BETWEEN}
"""Sources between two nodes, drawn as inputs there."""
STIFF: Final[dict[str, tuple[tuple[str, ...], str]]] = {
    "beam": (("E", "I"), "A"),
    "frame": (("E", "I"), "A"),
    "rod": (("E", "A"), "A"),
    "shaft": (("G", "J"), "J"),
    "string": (("N",), "A"),
}  # what makes a member stiff, and the measure of its section by which it is heavy
JOINED: Final = r",\,"
LABEL_LENGTH: Final = 4  # parameters of an element that are written at it; of more, its name is


def _label(use: PlacedElement, labels: Labels) -> tuple[str, tuple[str, ...]]:
    """Return what is written at an element: its parameters that are not nought, and their values."""
    by_port = dict(use.domains)
    defaults = {p.name: p.default for p in use.element.parameters}
    given = [
        (name, e)
        for name, e in use.values
        if not (isinstance(e, Number) and defaults[name] is not None and str(e.value) == defaults[name])
    ]
    if use.element.is_source:
        value = use.values[0][1]
        return labels.expression(value) if isinstance(whole(value), Name) else labels.name(use.name), ()
    if isinstance(use.element, LineElement):
        by_name = dict(given)
        first, second = STIFF.get(use.element.type_name, ((), ""))
        wanted = [first, ("rho", second), ("eta",), ("l",)] if first else []
        wanted = [("".join(g),) if "".join(g) in by_name else g for g in wanted]
        groups = [g for g in wanted if all(n in by_name for n in g)]
        if not groups or not all(isinstance(by_name[n], Name) for g in wanted for n in g if n in by_name):
            return labels.end(use.name, use.latex), ()
        products = ("".join(f"{{{labels.quantity(by_name[n], '')}}}" for n in g) for g in groups)
        return JOINED.join(products), ()
    inside = ("angle", "cg")  # drawn, not written
    shown = [labels.quantity(e, use.element.unit_of(n, by_port)) for n, e in given if n not in inside]
    seen = list(dict.fromkeys(shown))
    if not 0 < len(seen) <= LABEL_LENGTH:
        seen = [labels.end(use.name, use.latex)]
    return JOINED.join(seen), tuple(labels.values([e for _, e in given]))


def _input_part(one: Input, labels: Labels) -> DrawnPart:
    law = INPUT_KINDS[one.kind]
    ends = tuple(End("" if r.is_ground else r.node, law.domain, r.component) for r in one.nodes)
    ends = ends if len(ends) > 1 else (*ends, End(GROUND, law.domain))
    if one.kind in ("voltage", "current"):
        symbol = SYMBOLS[f"{one.kind}_source"]
    elif law.is_imposed:
        symbol = MOTION_BETWEEN
    else:
        symbol = TORQUE_BETWEEN if law.domain == "rotation" else FORCE_BETWEEN
    return DrawnPart("input", one.name, one.kind, symbol, ends, labels.end(one.name, one.latex))


def _input_mark(one: Input, labels: Labels, domains: Domains) -> Mark:
    (reference,) = one.nodes
    law = INPUT_KINDS[one.kind]
    is_flat = domains[reference.node] in COMPONENTS and reference.component != "x"
    style: Style
    if law.is_imposed:
        style = "twist" if law.domain == "rotation" else "raise" if is_flat else "motion"
    else:
        style = "torque" if law.domain == "rotation" else "push" if is_flat else "force"
    return Mark(style, reference.node, (("input", one.name, labels.end(one.name, one.latex)),))


def without_s(expression: Expression) -> Expression:
    """Return what is differentiated in time: ``x`` of ``s^2*x``."""
    if not isinstance(expression, Product):
        return expression
    s = Name("s")
    factors = [
        f
        for f in expression.factors
        if f != s and not (isinstance(f, Power) and f.base == s and isinstance(f.exponent, Number))
    ]
    return factors[0] if len(factors) == 1 else expression


def _node(expression: Expression, domains: Domains) -> End | None:
    match expression:
        case Name(name=name) if name in domains:
            kind = domains[name]
            return End(name, "translation", "y") if kind in COMPONENTS else End(name, kind)
        case Attribute(owner=owner, name=component) if owner in domains and component in COMPONENT_DOMAIN:
            return End(owner, COMPONENT_DOMAIN[component], component)
        case _:
            return None


def _style(end: End, domains: Domains) -> Style:
    if end.domain in CIRCUITS:
        return "probe"
    if end.domain == "rotation":
        return "turn"
    return "lift" if end.component == "y" and domains[end.node] in COMPONENTS else "shift"


def _difference(expression: Expression, domains: Domains) -> tuple[str, str] | None:
    match expression:
        case Sum(terms=(first, Negative(operand=second))):
            a, b = _node(first, domains), _node(second, domains)
            if a and b and a.node != b.node and domains[a.node] != "plane" and replace(a, node=b.node) == b:
                return a.node, b.node
    return None


def _place(expression: Expression) -> Call | None:
    """Return the one value along x that an expression is, but for factors."""
    calls = [n for n in names(expression) if isinstance(n, Call) and "." in n.name]
    varying = [n for n in names(expression) if isinstance(n, Attribute)]
    inner: Expression = expression
    while isinstance(inner, Negative | Quotient | Product):
        inner = next((c for c in inner.children if any(n in calls for n in names(c))), Name("s"))
    return calls[0] if len(calls) == 1 and not varying and inner == calls[0] else None


def _share(model: Model, call: Call) -> float:
    """Return where a point lies along an element, as a share of its length; a half where that is unknown."""
    use = next(e for e in model.elements if e.name == call.name.partition(".")[0])
    length = dict(use.values)["l"]
    values = values_of(model)
    at, extent = evaluate(call.argument, values), evaluate(length, values)
    if at is None or not extent:
        return 0.5
    return min(1.0, max(0.0, at / extent))


def values_of(model: Model) -> dict[str, float]:
    """Return what parameters and definitions are, where that is known."""
    numbers = {p.name: float(p.value.nearly) for p in model.parameters if p.value}
    for one in model.definitions:
        if (value := evaluate(one.expression, numbers)) is not None:
            numbers[one.name] = value
    return numbers


STATIONS: Final = 24  # sections at which a member that varies along x is measured
UNKNOWN: Final = 0.5  # what a parameter without value is taken for: of ``1 - c*x/l`` a taper can be seen


def depths(
    coefficient: Expression, ends: tuple[float, float], known: Mapping[str, float], root: int
) -> Depths:
    """Return a root at even stations, the greatest as 1; nothing of a coefficient that does not vary."""
    a, b = ends
    guessed = {n.name: UNKNOWN for n in names(coefficient) if isinstance(n, Name)} | dict(known)
    places = (a + (b - a) * i / STATIONS for i in range(STATIONS + 1))
    values = [evaluate(coefficient, {**guessed, COORDINATE: x}) or 0.0 for x in places]
    roots = [max(0.0, value) ** (1 / root) for value in values]
    most = max(roots)
    return tuple(d / most for d in roots) if min(roots) < (1 - 1e-6) * most else ()


def evaluate(expression: Expression, known: Mapping[str, float]) -> float | None:
    """Return the value of an expression of parameters, None if one is unknown."""
    try:
        return fold(
            expression,
            number=float,
            name=lambda n: {"pi": math.pi, **known}[n],
            power=lambda base, exponent: float(base ** float(evaluate(exponent, known) or 0)),
            call=lambda node, argument: float(getattr(math, node.name)(argument)),
        )
    except (KeyError, ValueError, ZeroDivisionError, OverflowError, AttributeError):
        return None


def _networks(
    nodes: Sequence[str], parts: Sequence[DrawnPart], marks: Sequence[Mark], spans: Sequence[Distance]
) -> tuple[DrawnNetwork, ...]:
    """Return what hangs together; the reference joins nothing."""
    together = {node: frozenset((node,)) for node in nodes}
    for part in parts:
        joined = frozenset[str]().union(*(together[n] for n in part.nodes))
        together.update(dict.fromkeys(joined, joined))
    networks = [
        DrawnNetwork(
            tuple(n for n in nodes if n in nodes_joined),
            tuple(p for p in parts if nodes_joined.intersection(p.nodes)),
            tuple(m for m in marks if m.node in nodes_joined),
            tuple(s for s in spans if nodes_joined.issuperset(s.nodes)),
        )
        for nodes_joined in dict.fromkeys(together.values())
    ]
    loose = tuple(p for p in parts if not p.nodes)
    return (*networks, DrawnNetwork((), loose, (), ())) if loose else tuple(networks)
