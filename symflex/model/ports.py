"""Reading ``[ports]``: where a machine is touched.

Input: a section of a specification, or the text of ``--port``, and the model. Output: a
:class:`~symflex.model.ContactPort`, whose effort and flow follow from the domain of its node.

    [ports]
    tip = { at = "tip" }            # force and velocity, where the node moves in translation
    jaw = { at = ["a", "b"] }       # between two nodes: a force and its reaction, the relative velocity
"""

from __future__ import annotations

from symflex.errors import Span, Text, UsageError, nearest, refused
from symflex.model.model import INPUT_KINDS, PORT_PAIRS, ContactPort, Model, NetworkNode, NodeReference
from symflex.model.network import domain_of, read_reference, variable_of
from symflex.model.reading import Reader
from symflex.model.scope import LISTED_NAMES
from symflex.model.spec import KeyValue, TableValue

KEYS = ("at", "doc")
EXAMPLE = 'for instance tip = { at = "tip" }'


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


def _read(reader: Reader, entry: KeyValue, model: Model) -> ContactPort | None:
    what = f"port '{entry.key}'"
    table = reader.table(entry, what, EXAMPLE)
    if table is None:
        return None
    reader.keys(table, KEYS, what, EXAMPLE)
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
        hint = nearest(reference.node, nodes) or "nodes: " + (", ".join([*nodes][:LISTED_NAMES]) or "none")
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
