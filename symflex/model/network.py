"""Reading elements, inputs and their nodes, and which domain each node has, from what is attached to it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heapify, heappop, heappush

from symflex.errors import Diagnostic, Span, Text, counted, nearest
from symflex.expressions import Expression
from symflex.library import ParameterPort
from symflex.library.blocks import BLOCKS
from symflex.library.elements import CIRCUITS, COMPONENT_DOMAIN, COMPONENTS, ELEMENTS, Element, Port, Variable
from symflex.library.elements.element import Domain, PortDomain
from symflex.library.words import hint_of_type
from symflex.model.declarations import DeclaredParameter, read_label
from symflex.model.model import (
    INPUT_KINDS,
    Definition,
    FieldProblem,
    Input,
    ModelParameter,
    NamedExpressions,
    NetworkNode,
    NodeReference,
    OperatingPoint,
    Output,
    PlacedBlock,
    Published,
    SampledBlocks,
    Signal,
)
from symflex.model.reading import NAME, Reader, has_ports, signed_number
from symflex.model.scope import RESERVED
from symflex.model.spec import ArrayValue, BooleanValue, KeyValue, StringValue, TableValue
from symflex.quantities import Dimension, name_hint, parse_unit, unit_of

RESTS = {"electrical": "a terminal at earth", "acoustic": "an open end", "thermal": "what stays as it is"}
"""What is at ground, where that is no end that does not move."""
PORTS = {name for element in ELEMENTS.values() for p in element.ports for name in (p.name, p.pair)} | {
    *("node", "nodes", "pins", "ends")
}
"""Keys under which elements name their nodes, and what else people call them."""
EXAMPLE = 'for instance { force = "x_act" }, or {} for a free signal'
TYPES_HINT = "'symflex elements' lists the types"


@dataclass(frozen=True, slots=True)
class DraftElement:
    """An element as written, before the nodes' domains are known."""

    name: str
    element: Element
    nodes: tuple[tuple[Port, tuple[NodeReference, ...]], ...]
    values: NamedExpressions
    span: Span
    choices: tuple[tuple[str, str], ...] = ()
    latex: str = ""

    def attachments(self, measure: Callable[[Expression], Dimension | None]) -> list[Attachment]:
        """Return what this element says about its nodes; ``measure`` tells a constant's dimension."""
        who, kind = f"{self.element.type_name} '{self.name}'", self.element.type_name
        attachments = []
        for port, references in self.nodes:
            coupling = self._coupling(port, measure) if port.domain == "any" else None
            attachments += [
                Attachment(r, port.domain, who, coupling, self.element.carries_x and not r.component, kind)
                for r in references
            ]
        return attachments

    def _coupling(self, port: Port, measure: Callable[[Expression], Dimension | None]) -> Coupling | None:
        ratio = dict(self.values).get("ratio")
        for other, references in self.nodes:
            if other is not port:
                dimension = measure(ratio) if ratio is not None else None
                partner = next((r for r in references if not r.is_ground), references[0])
                return Coupling(self.element, port.name, other.name, partner, dimension)
        return None


@dataclass(frozen=True, slots=True)
class DraftInput:
    """An input as written."""

    input: Input
    unit_text: str = ""

    def attachments(self) -> list[Attachment]:
        """Return what this input says about its nodes."""
        if self.input.kind == "signal":
            return []
        domain, who = INPUT_KINDS[self.input.kind].domain, f"input '{self.input.name}'"
        return [Attachment(r, domain, who, kind=self.input.kind) for r in self.input.nodes]


def read_elements(reader: Reader, section: TableValue | None) -> tuple[DraftElement, ...]:
    """Return every element; what is wrong is noted and the element left out."""
    return reader.entries(section, "an element", lambda entry: _read_element(reader, entry))


def _read_element(reader: Reader, entry: KeyValue) -> DraftElement | None:
    what = f"element '{entry.key}'"
    table = reader.table(entry, what, 'for instance { type = "spring", between = ["a", "b"], k = "k" }')
    element = _element_type(reader, table, entry) if table else None
    if table is None or element is None:
        return None
    keys = [key for p in element.ports for key in (p.name, p.pair) if key]
    keys += [p.name for p in element.parameters]
    keys += [c.name for c in element.choices]
    meant = reader.keys(table, ("type", *keys, "latex", "doc"), f"{element.type_name} '{entry.key}'")
    nodes = [(port, _references(reader, table, port, entry, element, meant)) for port in element.ports]
    choices = _choices(reader, table, entry, element)
    values = None if choices is None else _values(reader, table, entry, element, dict(choices), meant)
    if any(references is None for _, references in nodes):
        return None
    if all(r.is_ground for _, references in nodes for r in references or ()):
        message = f"{element.type_name} '{entry.key}' is attached to ground only"
        reader.note("SF218", message, entry.key_span, "the ground does not move; name a node")
        return None
    attached = tuple((p, r) for p, r in nodes if r is not None)
    label = read_label(reader, table, what)
    return DraftElement(entry.key, element, attached, values or (), entry.key_span, choices or (), label)


def _choices(
    reader: Reader, table: TableValue, entry: KeyValue, element: Element
) -> tuple[tuple[str, str], ...] | None:
    """Return what was chosen for every choice; ``None`` when a word is unknown."""
    chosen: list[tuple[str, str]] = []
    for choice in element.choices:
        given = table.get(choice.name)
        who = f"{element.type_name} '{entry.key}'"
        if given is None:
            chosen.append((choice.name, choice.default))
        elif choice.is_flag and isinstance(given.value, BooleanValue):
            chosen.append((choice.name, choice.name if given.value.value else choice.default))
        elif choice.is_flag:
            reader.misfit(f"{choice.name} of {who} must be true or false", given.value)
        elif text := reader.string(given, f"{choice.name} of {who}"):
            if text.value in choice.values:
                chosen.append((choice.name, text.value))
                continue
            hint = nearest(text.value, choice.values) or "known: " + ", ".join(choice.values)
            reader.note("SF208", f"unknown {choice.name} '{text.value[:60]}' of {who}", text.span, hint)
    return tuple(chosen) if len(chosen) == len(element.choices) else None


def _values(
    reader: Reader,
    table: TableValue,
    entry: KeyValue,
    element: Element,
    choices: Mapping[str, str],
    meant: frozenset[str],
) -> NamedExpressions | None:
    """Return an expression for every parameter that goes with the choices; ``None`` when one is wrong."""
    who = f"{element.type_name} '{entry.key}'"
    given: dict[str, Expression] = {}
    complete = True
    said: list[ParameterPort] = []
    spare = _spare(table, element, choices)
    for parameter in element.parameters:
        expression: Expression | None = None
        entry_given, applies = table.get(parameter.name), parameter.applies(choices.values())
        if entry_given is None and (parameter.of or parameter.name in spare):
            continue
        if entry_given is not None and not applies:
            chosen = ", ".join(f'{name} = "{value}"' for name, value in choices.items())
            others = " or ".join(f'"{value}"' for value in parameter.only)
            message = f"{parameter.name} of {who} does not go with {chosen}"
            reader.note("SF247", message, entry_given.key_span, f"it goes with {others}")
        elif entry_given is not None and parameter.name in spare:
            product = spare[parameter.name]
            choice = f"{product.name} in place of {'*'.join(product.of)}"
            hint = f"leave {parameter.name} or {product.name} out"
            message = f"{who} has {choice} and also {parameter.name}"
            reader.note("SF247", message, entry_given.key_span, hint)
        elif entry_given is not None:
            expression = reader.expression(entry_given.value, f"{parameter.name} of {who}")
        elif parameter.default is not None:
            like = any(p.name == parameter.default for p in element.parameters)
            expression = given.get(parameter.default) if like else signed_number(Fraction(parameter.default))
        elif applies:
            missing = _missing(table, element, choices, parameter)
            if missing not in said and missing.name not in meant:
                said.append(missing)
                message = f"{who} lacks {missing.name}, {missing.doc}"
                reader.note("SF214", message, entry.key_span, _parameters_of(element, choices))
        else:
            continue
        if expression is None:
            complete = False
        else:
            given[parameter.name] = expression
    return tuple(given.items()) if complete else None


def _missing(
    table: TableValue, element: Element, choices: Mapping[str, str], parameter: ParameterPort
) -> ParameterPort:
    """Return the parameter that is missing: beside EI, I is needed for another product alone."""
    with_it = [p for p in element.parameters if p.applies(choices.values()) and parameter.name in p.of]
    has_others = any(table.get(p.name) is not None for p in with_it)
    lacking = [p for p in with_it if has_others and not any(map(table.get, (p.name, *p.of)))]
    return lacking[0] if lacking else parameter


def _parameters_of(element: Element, choices: Mapping[str, str]) -> str:
    """Say which parameters an element has."""
    possible = [p for p in element.parameters if p.applies(choices.values())]
    listed = ", ".join(p.name for p in possible if not p.of)
    products = ", ".join(f"{p.name} for {'*'.join(p.of)}" for p in possible if p.of)
    return f"parameters of {element.type_name}: {listed}" + f"; {products}" * bool(products)


def _spare(table: TableValue, element: Element, choices: Mapping[str, str]) -> Mapping[str, ParameterPort]:
    """Return the parameters that nothing needs, as products of them are given, each with its product."""
    products = [p for p in element.parameters if p.of and p.applies(choices.values())]
    given = [p for p in products if table.get(p.name) is not None]
    needed = {factor for p in products if p not in given for factor in p.of}
    return {factor: p for p in given for factor in p.of if factor not in needed}


def _element_type(reader: Reader, table: TableValue, entry: KeyValue) -> Element | None:
    what = f"element '{entry.key}'"
    kind = reader.needed(table, "type", entry, f"{what} has no type", TYPES_HINT)
    text = reader.string(kind, f"type of {what}") if kind else None
    if text is None:
        return None
    element = ELEMENTS.get(text.value)
    if element is None:
        hint = hint_of_type(text.value, ELEMENTS, BLOCKS, "a block, of [blocks]") or TYPES_HINT
        reader.note("SF216", f"unknown element type '{text.value[:60]}'", text.span, hint)
    return element


def _other_count(port: Port, texts: Sequence[Text], wanted: int) -> str | None:
    """Return what to do where a port has more nodes or fewer than it takes."""
    if len(texts) < wanted:
        given = [text.value[:60] for text in texts] or ["..."]
        ends = ", ".join(f'"{name}"' for name in (*given, *["ground"] * (wanted - len(given))))
        return f'{RESTS.get(port.domain, "an end that does not move")} is at "ground": [{ends}]'
    if port.reacts:
        return f'two nodes at most, the second for the reaction: {port.name} = ["a", "b"]'
    return f"two nodes are written {port.pair} = [...]" if port.pair else None


def _references(
    reader: Reader, table: TableValue, port: Port, entry: KeyValue, element: Element, meant: frozenset[str]
) -> tuple[NodeReference, ...] | None:
    what = f"{port.name} of {element.type_name} '{entry.key}'"
    entry_given, wanted = table.get(port.name), port.terminals
    both = table.get(port.pair) if port.pair else None
    if entry_given is not None and both is not None:
        message = f"{element.type_name} '{entry.key}' takes {port.name} or {port.pair}, not both"
        reader.note("SF217", message, both.key_span)
        return None
    if both is not None:
        what, entry_given, wanted = f"{port.pair} of {element.type_name} '{entry.key}'", both, 2
    if entry_given is None:
        if port.default is not None:
            return tuple(NodeReference(n) for n in port.default)
        if port.name in meant:
            return None
        nodes = '"a"' if wanted == 1 else str(list("abcd"[:wanted])).replace("'", '"')
        message = f"{element.type_name} '{entry.key}' lacks its port '{port.name}' ({port.doc})"
        written = _as_ports(table, element) or f"for instance {port.name} = {nodes}"
        reader.note("SF217", message, entry.key_span, written)
        return None
    kind = "the name of a node" if wanted == 1 else f"an array of {wanted} nodes"
    texts = reader.strings(entry_given, what, kind)
    if texts is None:
        return None
    if port.reacts and len(texts) == 2:  # noqa: PLR2004
        wanted = 2
    if len(texts) != wanted:
        message = f"{what} takes {counted(wanted, 'node')}, found {len(texts)}"
        reader.note("SF217", message, entry_given.value.span, _other_count(port, texts, wanted))
        return None
    references = [read_reference(reader, t, port.domain, what) for t in texts]
    kept = tuple(r for r in references if r is not None)
    if len(kept) < len(texts):
        return None
    match kept:
        case (a, b) if (a.node, a.component) == (b.node, b.component):
            message = f"both ends of {element.type_name} '{entry.key}' are at '{texts[0].value}'"
            hint = 'give one end a node of its own; { type = "fixed", at = NODE } holds it'
            reader.note("SF218", message, entry_given.value.span, hint if a.is_ground else None)
            return None
    return kept


def _as_ports(table: TableValue, element: Element) -> str | None:
    """Return how nodes given under another element's port are written, None if that is not known."""
    ports = {name for p in element.ports for name in (p.name, p.pair)}
    missing = [p for p in element.ports if table.get(p.name) is None and p.default is None]
    for entry in table.entries:
        value = entry.value
        if entry.key not in PORTS - ports or not isinstance(value, StringValue | ArrayValue):
            continue
        items = (value,) if isinstance(value, StringValue) else value.items
        nodes = [f'"{i.text.value[:60]}"' for i in items if isinstance(i, StringValue)]
        if len(nodes) == 1 and [p.terminals for p in missing] == [2]:
            nodes = ['"ground"', *nodes]
        if len(nodes) > (wanted := sum(p.terminals for p in missing)):
            nodes = [node for node in nodes if node != '"ground"']
        if len(nodes) == wanted:
            pieces = []
            for p in missing:
                taken, nodes = nodes[: p.terminals], nodes[p.terminals :]
                listed = ", ".join(taken)
                pieces.append(f"{p.name} = {listed if p.terminals == 1 else f'[{listed}]'}")
            return "write " + ", ".join(pieces)
    return None


def read_reference(reader: Reader, text: Text, domain: PortDomain, what: str) -> NodeReference | None:
    """Return the node, or the part of a planar node, that a text names; what is wrong is noted."""
    node, dot, component = text.value.partition(".")
    good = NAME.match(node) and (not dot or component in COMPONENT_DOMAIN)
    if not good or (dot and node == "ground"):
        hint = (name_hint(node) or "").partition(", which")[0]
        if not hint and node == "0":
            hint = "the ground is 'ground'"
        elif not hint and node[:1].isdigit() and node.isalnum():
            hint = f"a name begins with a letter: write 'n{node}'"
        usual = "a node is a name, or name.x, name.y or name.theta of a planar node"
        reader.note("SF213", f"{what}: '{text.value[:80]}' is not a node", text.span, hint or usual)
        return None
    if dot and domain in COMPONENTS:
        reader.note("SF219", f"{what} takes a whole node, not '{text.value}'", text.span, f"write '{node}'")
        return None
    if dot and domain in DOMAINS[:2] and COMPONENT_DOMAIN[component] != domain:
        kind = "translational" if domain == "translation" else "rotational"
        reader.note("SF219", f"{what} is {kind}; '{text.value}' is not", text.span)
        return None
    if dot and domain in CIRCUITS:
        reader.note("SF219", f"{what} is {domain}; '{text.value}' is mechanical", text.span)
        return None
    return NodeReference(node, component, text.span)


def read_inputs(reader: Reader, section: TableValue | None) -> tuple[DraftInput, ...]:
    """Return every input; what is wrong is noted and the input left out."""
    return reader.entries(section, "an input", lambda entry: _read_input(reader, entry), RESERVED)


def _read_input(reader: Reader, entry: KeyValue) -> DraftInput | None:
    what = f"input '{entry.key}'"
    table = reader.table(entry, what, EXAMPLE)
    if table is None:
        return None
    reader.keys(table, (*INPUT_KINDS, "unit", "latex", "doc"), what, EXAMPLE)
    label = read_label(reader, table, what)
    kinds = [e for e in table.entries if e.key in INPUT_KINDS]
    if len(kinds) > 1:
        keys = " and ".join(e.key for e in kinds)
        hint = "write an input of its own for each: " + ", ".join(
            f"{e.key[0]}_{i} = {{ {e.key} = ... }}" for i, e in enumerate(kinds, 1)
        )
        reader.note("SF217", f"{what} is given as {keys}; it can be only one", kinds[1].key_span, hint)
        return None
    if not kinds:
        unit = _unit(reader, table, what, None)
        return DraftInput(Input(entry.key, "signal", (), None, unit, label, entry.key_span), unit)
    (attachment,) = kinds
    kind, law = attachment.key, INPUT_KINDS[attachment.key]
    _unit(reader, table, what, kind)
    texts = reader.strings(attachment, f"{kind} of {what}", "the name of a node, or two")
    if texts is None:
        return None
    if len(texts) not in (1, 2):
        message = f"{what} acts on one node, or on one with its reaction on a second, found {len(texts)}"
        reader.note("SF217", message, attachment.value.span)
        return None
    references = [read_reference(reader, t, law.domain, what) for t in texts]
    kept = tuple(r for r in references if r is not None)
    if len(kept) != len(texts):
        return None
    if all(r.is_ground for r in kept):
        verb = "moves the ground" if law.is_imposed and law.domain not in CIRCUITS else "acts on ground only"
        hint = "the ground does not move; name a node of its own, to which the elements are attached"
        reader.note("SF218", f"{what} {verb}", attachment.value.span, hint if law.is_imposed else None)
        return None
    if len({(r.node, r.component) for r in kept}) != len(kept):
        reader.note("SF218", f"{what} acts and reacts on the same node", attachment.value.span)
        return None
    return DraftInput(Input(entry.key, kind, kept, None, law.unit, label, entry.key_span))


def _unit(reader: Reader, table: TableValue, what: str, kind: str | None) -> str:
    """Return the unit an input declares; transfer functions are per SI unit, so it must be one."""
    text = reader.text(table, "unit", what)
    unit = reader.read(parse_unit, text)
    if text is None or unit is None:
        return ""
    if kind is not None and unit.dimension != unit_of(INPUT_KINDS[kind].unit).dimension:
        a_kind = f"{'an' if kind.startswith('a') else 'a'} {kind.replace('_', ' ')}"
        message = f"unit of {what} is '{text.value}'; {a_kind} is in '{INPUT_KINDS[kind].unit}'"
        reader.note("SF203", message, text.span)
    elif unit.scale != 1 or unit.pi_power or unit.cycles:
        message = f"unit of {what} is '{text.value}'; transfer functions are per SI unit"
        reader.note("SF203", message, text.span, f"write '{unit.dimension}'")
    return text.value


@dataclass(frozen=True, slots=True)
class Coupling:
    """What a coupling says about the domains of its two sides."""

    element: Element  # whose ``ratio`` has a unit that depends on both domains
    # port and partner_port: this side and the other side.
    port: str
    partner_port: str
    partner: NodeReference  # the node at the other side
    ratio: Dimension | None  # what the given ratio is measured in, when that is known

    def suggested(self, partner: Domain) -> Domain:
        """Return the domain for this side that the ratio's unit asks for, or else its partner's."""
        if self.ratio is None:
            return partner
        for domain in (partner, *DOMAINS):
            unit = self.element.unit_of("ratio", {self.port: domain, self.partner_port: partner})
            if unit_of(unit).dimension == self.ratio:
                return domain
        return partner


@dataclass(frozen=True, slots=True)
class Attachment:
    """One port at one node; a coupling's port has no domain of its own."""

    reference: NodeReference
    domain: PortDomain
    who: str
    coupling: Coupling | None = None
    is_carried: bool = False  # where another node of the same element moves along x, this one does, too
    kind: str = ""  # the type of element, or the kind of input


DOMAINS: tuple[Domain, ...] = ("translation", "rotation", *CIRCUITS)
WORDS = {
    "translation": "a displacement",
    "rotation": "an angle",
    "electrical": "a voltage",
    "acoustic": "a pressure",
    "thermal": "a temperature",
    "planar": "a planar node",
    "plane": "a node of the plane",
}


def infer_nodes(attachments: Sequence[Attachment]) -> tuple[tuple[NetworkNode, ...], list[Diagnostic]]:
    """Return the nodes in order of appearance, with every contradiction found."""
    # A node touched by a planar element, or named with ``.y`` or ``.theta``, is planar; translational
    # elements then act on y and rotational ones on theta. Where it is touched by a frame, named with ``.x``
    # or carried along, it moves along x as well, and a translational element says which of the two it acts
    # on. Otherwise all elements must agree.
    problems: list[Diagnostic] = []
    first: dict[str, Attachment] = {}
    claims: dict[str, dict[str, Attachment]] = {}
    for attachment in attachments:
        reference = attachment.reference
        if reference.is_ground:
            continue
        first.setdefault(reference.node, attachment)
        claims.setdefault(reference.node, {}).setdefault(_claim(attachment), attachment)
    moving = _moving_along(attachments)
    nodes: dict[str, NetworkNode] = {}
    for name, claimed in claims.items():
        span = first[name].reference.span
        definite = [d for d in claimed if d in DOMAINS]
        if any(d in COMPONENTS for d in claimed):
            if any(d in CIRCUITS for d in claimed):
                one, other, *_ = (d for d in claimed if d in (*COMPONENTS, *CIRCUITS))
                problems.append(_contradiction(name, claimed[one], claimed[other]))
            nodes[name] = NetworkNode(name, "plane" if name in moving else "planar", span)
            continue
        for other in definite[1:]:
            problems.append(_contradiction(name, claimed[definite[0]], claimed[other]))
        if definite:
            nodes[name] = NetworkNode(name, definite[0], span)
    _spread(attachments, nodes, first)
    for a in attachments:  # what does not say whether it acts along x or y
        is_bare = not a.reference.component and a.domain in ("translation", "any")
        if is_bare and (node := nodes.get(a.reference.node)) and node.domain == "plane":
            problems.append(_without_direction(a))
    problems += [*_unlike(attachments, nodes), *_mixed(attachments, nodes)]
    return tuple(nodes[name] for name in first), problems


def _claim(attachment: Attachment) -> PortDomain:
    component = attachment.reference.component
    return attachment.domain if not component else "plane" if component == "x" else "planar"


def _moving_along(attachments: Sequence[Attachment]) -> set[str]:
    """Return the nodes that move along x: by themselves, or as a link, pin or joint carries them along."""
    carried: dict[str, list[str]] = {}
    for attachment in attachments:
        if attachment.is_carried and not attachment.reference.is_ground:
            carried.setdefault(attachment.who, []).append(attachment.reference.node)
    beside: dict[str, set[str]] = {}
    for together in carried.values():
        for name in together:
            beside.setdefault(name, set()).update(together)
    moving: set[str] = set()
    pending = [a.reference.node for a in attachments if _claim(a) == "plane" and not a.reference.is_ground]
    while pending:
        name = pending.pop()
        if name not in moving:
            moving.add(name)
            pending += beside.get(name, ())
    return moving


def _without_direction(attachment: Attachment) -> Diagnostic:
    name = attachment.reference.node
    message = f"node '{name}' moves along x and y; {attachment.who} acts on one of them"
    hint = f"write '{name}.x' or '{name}.y'; a mass that moves both ways is a rigid_body"
    return Diagnostic("SF219", message, attachment.reference.span, hint)


def _unlike(attachments: Sequence[Attachment], nodes: Mapping[str, NetworkNode]) -> Iterator[Diagnostic]:
    """Yield what is held to a single coordinate that is of another kind, or of a node that has two."""
    held: dict[str, list[Attachment]] = {}
    for attachment in attachments:
        if attachment.domain == "whole" and not attachment.reference.is_ground:
            held.setdefault(attachment.who, []).append(attachment)
    for pair in held.values():
        domains = [nodes[each.reference.node].domain for each in pair]
        is_whole = [d in COMPONENTS and not a.reference.component for d, a in zip(domains, pair, strict=True)]
        if all(is_whole):
            continue
        one = pair[is_whole.index(False)]
        held_as = domain_of(one.reference, nodes[one.reference.node])
        for other, domain, is_body in zip(pair, domains, is_whole, strict=True):
            found = domain_of(other.reference, nodes[other.reference.node])
            if is_body and domain == "plane" and held_as == "translation":
                yield _without_direction(other)
            elif found != held_as and not (is_body and held_as == "rotation"):
                what = WORDS[domain if is_body else found]
                message = f"{one.who} holds {what} to '{one.reference.node}', which is {WORDS[held_as]}"
                hint = "couple them, with a transformer for instance"
                yield Diagnostic("SF220", message, other.reference.span, hint)


def _mixed(attachments: Sequence[Attachment], nodes: Mapping[str, NetworkNode]) -> Iterator[Diagnostic]:
    """Yield pairs of nodes of one side of a coupling that do not move alike."""
    first: dict[tuple[str, str], Attachment] = {}
    for attachment in attachments:
        if attachment.coupling is None or attachment.reference.is_ground:
            continue
        other = first.setdefault((attachment.who, attachment.coupling.port), attachment)
        kinds = [domain_of(a.reference, nodes[a.reference.node]) for a in (other, attachment)]
        if kinds[0] != kinds[1]:
            names = f"'{other.reference.node}' and '{attachment.reference.node}'"
            words = f"{WORDS[kinds[0]]} and {WORDS[kinds[1]]}"
            message = f"{names} of {attachment.who} are {words}, but a pair must be of one kind"
            yield Diagnostic("SF220", message, attachment.reference.span)


def _spread(
    attachments: Sequence[Attachment], nodes: dict[str, NetworkNode], first: dict[str, Attachment]
) -> None:
    """Give nodes that only couplings touch a domain that suits the ratio's unit (translation at last)."""
    waiting: dict[str, list[int]] = {}
    for i, attachment in enumerate(attachments):
        if attachment.coupling is not None and not attachment.reference.is_ground:
            waiting.setdefault(attachment.coupling.partner.node, []).append(i)
    ready = [i for node in nodes for i in waiting.get(node, ())]
    heapify(ready)
    while ready:
        attachment = attachments[heappop(ready)]
        name, coupling = attachment.reference.node, attachment.coupling
        if coupling is None or name in nodes:
            continue
        domain = coupling.suggested(domain_of(coupling.partner, nodes[coupling.partner.node]))
        nodes[name] = NetworkNode(name, domain, first[name].reference.span)
        for i in waiting.get(name, ()):
            heappush(ready, i)
    for name, attachment in first.items():
        nodes.setdefault(name, NetworkNode(name, "translation", attachment.reference.span))


def domain_of(reference: NodeReference, node: NetworkNode) -> Domain:
    """Return the domain a one-variable port sees at a node; a bare planar node is its deflection y."""
    match node.domain:
        case "planar" | "plane":
            return COMPONENT_DOMAIN[reference.component or "y"]
        case domain:
            return domain


def variable_of(reference: NodeReference, node: NetworkNode, domain: PortDomain) -> Variable:
    """Return the across variable a port of the given domain acts on."""
    if node.domain not in COMPONENTS:
        return Variable("node", node.name)
    component = reference.component or ("theta" if domain == "rotation" else "y")
    return Variable("node", node.name, component)


def _contradiction(name: str, one: Attachment, other: Attachment) -> Diagnostic:
    claims = [_claim(a) for a in (one, other)]
    hint = (
        "use two nodes and couple them, with a transformer for instance; a node that both moves and turns "
        "is planar: name its parts with .x, .y and .theta"
    )
    if "electrical" in claims:
        hint = "use two nodes and couple them, with a dc_motor or a gyrator for instance"
    elif "acoustic" in claims:
        hint = "use two nodes and couple them with a piston"
    if alike := _alike(other.kind, claims[0]):
        hint = f"if '{name}' is {WORDS[claims[0]]}, write {alike} in place of {other.kind}; if not, {hint}"
    message = f"node '{name}' is {WORDS[claims[0]]} for {one.who} and {WORDS[claims[1]]} for {other.who}"
    return Diagnostic("SF220", message, other.reference.span, hint)


def _alike(kind: str, domain: PortDomain) -> str | None:
    """Return what a lumped element or a kind of input is called in another domain: force, torque, heat."""
    kinds: dict[str, tuple[object, ...]] = {
        name: (type(e).__base__, getattr(e, "order", None), e.ports[0].domain)
        for name, e in ELEMENTS.items()
        if len(e.ports) == 1 and type(e).__base__ is not Element
    }
    kinds |= {name: (law.order, law.domain) for name, law in INPUT_KINDS.items()}
    domains = kinds.get(kind, ())
    return next((name for name, each in kinds.items() if domains and each == (*domains[:-1], domain)), None)


class AsWritten:
    """Reads expressions in which nothing counts cycles; :class:`symflex.model.cycles.Cycles` reads others."""

    eager: Collection[str] = ()  # what is declared in cycles, and by its name in radians
    converted: Collection[str] = ()  # what became radians somewhere

    def read(self, expression: Expression, *, is_delay: bool = False) -> Expression:
        """Return an expression, or an equation, as it is meant."""
        return expression

    def printed(self, published: Published) -> Published:
        """Return a printed formula as it is meant."""
        return published


@dataclass(frozen=True, slots=True)
class Draft:
    """What was read, before names and units were checked."""

    declared: tuple[DeclaredParameter, ...]
    inherited: tuple[ModelParameter, ...]
    definitions: tuple[Definition, ...]
    nodes: tuple[NetworkNode, ...]
    elements: tuple[DraftElement, ...]
    inputs: tuple[DraftInput, ...]
    blocks: tuple[PlacedBlock, ...]
    signals: tuple[Signal, ...]
    outputs: tuple[Output, ...]
    cycles: AsWritten  # reads frequencies as they are meant
    fields: tuple[FieldProblem, ...] = ()
    point: OperatingPoint | None = None  # at which the equations of motion are linear
    sampled: SampledBlocks | None = None

    @property
    def parameters(self) -> list[str]:
        """Names of parameters, those of blocks last."""
        return [*(p.name for p in self.declared), *(p.name for p in self.inherited)]

    @property
    def constants(self) -> set[str]:
        """Names of parameters, definitions and blocks."""
        return {*self.parameters, *(d.name for d in self.definitions), *(b.name for b in self.blocks)}

    @property
    def loads(self) -> set[str]:
        """Names of signals and inputs."""
        return {x.name for x in self.signals} | {d.input.name for d in self.inputs}

    @property
    def names(self) -> set[str]:
        """All names that are taken."""
        return self.constants | self.loads | {n.name for n in self.nodes}

    def expressions(self) -> list[Expression]:
        """Return all expressions, of equations each side."""
        places = [d.expression for d in self.definitions] + [x.expression for x in self.signals]
        places += [x.expression for x in self.outputs]
        places += [e for group in (self.elements, self.blocks) for x in group for _, e in x.values]
        equations = (c for f in self.fields for c in (*f.equations, *f.conditions))
        return places + [side for c in equations for side in (c.left, c.right)]


def broken_names(sections: Mapping[str, TableValue | None], draft: Draft) -> frozenset[str]:
    """Return the names in declarations that could not be read: their own and those of nodes listed there."""
    read = {
        "parameters": {p.name for p in draft.declared},
        "definitions": {d.name for d in draft.definitions},
        "elements": {e.name for e in draft.elements},
        "inputs": {d.input.name for d in draft.inputs},
        "signals": {x.name for x in draft.signals},
        "blocks": {b.name for b in draft.blocks},
        "fields": {f.name for f in draft.fields},
    }
    equations = sections["equations"]
    entries = equations.entries if equations else ()
    broken = set(_listed_names(e for e in entries if e.key != "equations")) - read["signals"]
    for section, names_read in read.items():
        table = sections[section]
        for entry in table.entries if table else ():
            if section == "blocks" and isinstance(entry.value, TableValue) and has_ports(entry.value):
                listed = _listed_names(e for e in entry.value.entries if e.key in ("to", "states"))
                broken.update(set(listed) - read["signals"])
            elif entry.key not in names_read:
                broken.add(entry.key)
                if not isinstance(entry.value, TableValue):
                    continue
                if section in ("elements", "inputs"):
                    broken.update(_listed_names(entry.value.entries))
                if section == "fields":
                    broken.update(_listed_names(e for e in entry.value.entries if e.key == "unknowns"))
    return frozenset(broken)


def _listed_names(entries: Iterable[KeyValue]) -> Iterator[str]:
    for entry in entries:
        items = entry.value.items if isinstance(entry.value, ArrayValue) else (entry.value,)
        yield from (i.text.value.partition(".")[0] for i in items if isinstance(i, StringValue))
