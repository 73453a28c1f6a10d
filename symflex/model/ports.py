"""Reading ``[ports]``: where a machine is touched.

Input: a section of a specification, or the text of ``--port``, and the model. Output: a
:class:`~symflex.model.ContactPort`, whose effort and flow follow from the domain of its node.

    [ports]
    tip  = { at = "tip" }                      # force and velocity, where the node has an x
    jaw  = { at = ["a", "b"] }                 # a force and its reaction, the relative velocity
    hand = { force = "F", velocity = "V" }     # an input and an output, of equations or fields

Equations have no nodes. There a port names a free input and the output that is its dual. It becomes a node
of its own name (:func:`with_port_nodes`): what is delivered into the node adds to the input, and the node
follows the output.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Span, Text, UsageError, nearest, refused
from symflex.expressions import (
    Equation,
    Expression,
    Name,
    Product,
    negative,
    product_of,
    replace_values,
    sum_of,
)
from symflex.library.elements import ELEMENTS, THROUGH_NAME
from symflex.model.model import (
    INPUT_KINDS,
    PORT_PAIRS,
    ContactPort,
    Model,
    NetworkNode,
    NodeReference,
    Signal,
    rewritten,
)
from symflex.model.network import DraftElement, domain_of, read_reference, variable_of
from symflex.model.reading import Reader
from symflex.model.scope import LISTED_NAMES, free_name
from symflex.model.spec import KeyValue, TableValue

if TYPE_CHECKING:
    from symflex.model.network import Draft

DELIVERED = {pair.delivered: domain for domain, pair in PORT_PAIRS.items()}
FOLLOWED = tuple(name for name, kind in INPUT_KINDS.items() if kind.is_imposed and kind.domain in PORT_PAIRS)
KEYS = ("at", *DELIVERED, *FOLLOWED, "doc")
EXAMPLE = 'for instance tip = { at = "tip" }'
PAIR_EXAMPLE = 'for instance hand = { force = "F", velocity = "V" }'


def read_ports(reader: Reader, section: TableValue | None, model: Model) -> tuple[ContactPort, ...]:
    """Return the declared ports; what is wrong in one is noted at its place."""
    return reader.entries(section, "a port", lambda entry: _read(reader, entry, model))


def port_named(model: Model, name: str | None) -> ContactPort:
    """Return a declared port, or the one at a node; without a name the only one that is declared.

    UsageError: SF902 where none is named and one alone is not declared, SF2xx for what is no place to touch.
    """
    if name is None:
        if len(model.ports) == 1:
            return model.ports[0]
        known = ", ".join(p.name for p in model.ports) or "none is declared in [ports]"
        raise refused("name the port with --port", f"ports: {known}; a node is one, too")
    if declared := next((p for p in model.ports if p.name == name), None):
        return declared
    text = Text.alone("--port", name)
    reader = Reader()
    port = _placed(reader, name, (text,), text.span, model)
    if port is None:
        raise UsageError(*reader.problems)
    return port


def with_port_nodes(reader: Reader, section: TableValue | None, draft: Draft) -> Draft:
    """Return a draft in which each port of an input and an output is a node, whose source feeds the input."""
    for entry in section.entries if section else ():
        table = entry.value
        if isinstance(table, TableValue) and _is_pair(table):
            draft = _with_node(reader, entry, table, draft)
    return draft


def _is_pair(table: TableValue) -> bool:
    """Tell whether a port is an input and an output in place of a node."""
    return table.get("at") is None and not {*DELIVERED, *FOLLOWED}.isdisjoint(table.keys())


def _with_node(reader: Reader, entry: KeyValue, table: TableValue, draft: Draft) -> Draft:
    what = f"port '{entry.key}'"
    reader.keys(table, KEYS, what, PAIR_EXAMPLE)
    delivered = [key for key in table.keys() if key in DELIVERED]
    followed = [key for key in table.keys() if key in FOLLOWED]
    if len(delivered) != 1 or len(followed) != 1:
        message = f"{what} needs an input that is delivered and an output that is its dual"
        reader.note("SF217", message, entry.key_span, PAIR_EXAMPLE)
        return draft
    domain, kind = DELIVERED[delivered[0]], INPUT_KINDS[followed[0]]
    if kind.domain != domain:
        dual = ", ".join(name for name in FOLLOWED if INPUT_KINDS[name].domain == domain)
        message = f"{what}: the product of {delivered[0]} and {followed[0].replace('_', ' ')} is no power"
        reader.note("SF219", message, entry.key_span, f"beside {delivered[0]}: {dual}")
        return draft
    inputs = {d.input.name: d.input for d in draft.inputs if d.input.kind == "signal"}
    outputs = {o.name: o for o in draft.outputs}
    named = []
    for key, known, group in ((delivered[0], inputs, "free input"), (followed[0], outputs, "output")):
        text = reader.text(table, key, what)
        if text is None:
            return draft
        if text.value not in known:
            hint = nearest(text.value, known) or f"{group}s: " + (
                ", ".join([*known][:LISTED_NAMES]) or "none"
            )
            reader.note("SF210", f"{what}: there is no {group} '{text.value[:64]}'", text.span, hint)
            return draft
        named.append(text.value)
    if entry.key in draft.names:
        reader.note("SF211", f"{what} has the name of something else", entry.key_span, "rename the port")
        return draft
    return _driven(draft, entry, domain, named, kind.order or 0)


def _driven(draft: Draft, entry: KeyValue, domain: str, pair: Sequence[str], order: int) -> Draft:
    """Return a draft with the node of a port: ``s^order * node`` is the output, a source feeds the input."""
    source, output = pair
    taken = draft.names | {e.name for e in draft.elements} | {entry.key}
    through = free_name(f"{THROUGH_NAME[domain]}_into_{entry.key}", taken)
    fed: Expression = sum_of([Name(source), Name(through)])
    draft = rewritten(draft, lambda e: replace_values(e, {Name(source): fed}))
    answer = next(o.expression for o in draft.outputs if o.name == output)
    while order and isinstance(answer, Product) and Name(LAPLACE) in answer.factors:
        # A velocity s*x is the rate of x: the node moves by x, without an integrator of its own.
        factors = list(answer.factors)
        factors.remove(Name(LAPLACE))
        answer, order = product_of(factors), order - 1
    node = product_of([*[Name(LAPLACE)] * order, Name(entry.key)])
    element = ELEMENTS[f"{PORT_PAIRS[domain].delivered}_source"]
    (place,), (value,) = element.ports, element.parameters
    feeding = DraftElement(
        free_name(f"feed_{entry.key}", taken),
        element,
        ((place, (NodeReference(entry.key, span=entry.key_span),)),),
        ((value.name, negative(Name(through))),),
        entry.key_span,
    )
    unknown = Signal(through, Equation(node, answer), entry.key_span)
    return replace(draft, elements=(*draft.elements, feeding), signals=(*draft.signals, unknown))


def _read(reader: Reader, entry: KeyValue, model: Model) -> ContactPort | None:
    what = f"port '{entry.key}'"
    table = reader.table(entry, what, EXAMPLE)
    if table is None:
        return None
    if _is_pair(table):
        node = next((n for n in model.nodes if n.name == entry.key), None)
        place = NodeReference(entry.key, span=entry.key_span)
        return ContactPort(entry.key, (place,), domain_of(place, node), entry.key_span) if node else None
    reader.keys(table, ("at", "doc"), what, EXAMPLE)
    at = reader.needed(table, "at", entry, f"{what} does not say where it is", EXAMPLE)
    texts = reader.strings(at, f"at of {what}", "the name of a node, or two") if at else None
    if at is None or texts is None:
        return None
    if len(texts) not in (1, 2):
        reader.note("SF217", f"{what} is at one node or between two, found {len(texts)}", at.value.span)
        return None
    return _placed(reader, entry.key, texts, entry.key_span, model)


def _placed(
    reader: Reader, name: str, texts: tuple[Text, ...], span: Span, model: Model
) -> ContactPort | None:
    """Return the port at one node or between two; None where something is wrong, which is noted."""
    what = f"port '{name}'"
    references = [read_reference(reader, text, "any", what) for text in texts]
    kept = tuple(r for r in references if r is not None)
    if len(kept) < len(texts) or not all(
        _is_place(reader, r, t, what, model) for r, t in zip(kept, texts, strict=True)
    ):
        return None
    live = tuple(r for r in kept if not r.is_ground)
    if not live or len({(r.node, r.component) for r in kept}) < len(kept):
        message = f"{what} is at ground, which does not move" if not live else f"{what} has one node twice"
        reader.note("SF218", message, span, "name a node that moves")
        return None
    nodes = {n.name: n for n in model.nodes}
    if len(live) == 1 and (holder := _holder(live[0], nodes[live[0].node], model)):
        message = f"{what}: '{texts[kept.index(live[0])].value}' {holder}"
        reader.note("SF218", message, live[0].span, "name a node that can be moved from outside")
        return None
    domains = [domain_of(r, nodes[r.node]) for r in live]
    if len(set(domains)) > 1:
        reader.note("SF219", f"{what} is between {domains[0]} and {domains[1]}", span)
        return None
    if domains[0] not in PORT_PAIRS:
        message = f"{what} is {domains[0]}: the product of what flows there and its potential is no power"
        known = "; ".join(f"{d}: {pair.effort} and {pair.flow}" for d, pair in PORT_PAIRS.items())
        reader.note("SF219", message, span, f"ports are of dual pairs: {known}")
        return None
    return ContactPort(name, kept, domains[0], span)


def _is_place(reader: Reader, reference: NodeReference, text: Text, what: str, model: Model) -> bool:
    """Tell whether a node is there and has the part that is named, and note where not."""
    if reference.is_ground:
        return True
    nodes = {n.name: n for n in model.nodes}
    node = nodes.get(reference.node)
    if node is None:
        known = {"ports": [p.name for p in model.ports], "nodes": [*nodes]}
        listed = [f"{group}: {', '.join(some[:LISTED_NAMES])}" for group, some in known.items() if some]
        hint = nearest(reference.node, [*known["ports"], *nodes]) or "; ".join(listed)
        hint = hint or f"without nodes, name an input and an output: {PAIR_EXAMPLE}"
        reader.note("SF210", f"{what}: there is no node '{reference.node[:64]}'", text.span, hint)
        return False
    if reference.component not in (*node.components, ""):
        message = f"{what}: '{node.name}' has no part '{reference.component}'"
        parts = ", ".join(f"'{node.name}.{c}'" if c else f"'{node.name}'" for c in node.components)
        reader.note("SF219", message, text.span, f"write {parts}")
        return False
    if node.domain == "plane" and not reference.component:
        message = f"{what}: '{node.name}' moves along x and y, and turns"
        reader.note("SF219", message, text.span, f"write '{node.name}.y', .x or .theta")
        return False
    return True


def _holder(reference: NodeReference, node: NetworkNode, model: Model) -> str | None:
    """Say what keeps a node from being moved from outside; None where nothing does."""
    variable = variable_of(reference, node, domain_of(reference, node))
    for source in model.inputs:
        kind = INPUT_KINDS.get(source.kind)
        if kind is None or not kind.is_imposed or len(source.nodes) != 1:
            continue
        (followed,) = source.nodes
        if followed.node == node.name and variable_of(followed, node, kind.domain) == variable:
            return f"follows input '{source.name}', an imposed {source.kind}"
    for use in model.elements:
        held = dict(use.nodes)["at"] if use.element.type_name == "fixed" else ()
        if len(held) == 1 and held[0].node == node.name and held[0].component in ("", variable.component):
            return f"does not move, as '{use.name}' holds it"
    return None
