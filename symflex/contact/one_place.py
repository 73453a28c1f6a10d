"""A machine whose controller acts where it measures: what it does at that one place decides for the whole.

Input: a model with numbers. Output: the part at the place as a model with a port there, and the rest.

Passive parts that are connected make a passive machine (Anderson & Vongpanitlerd 1973, chapter 2). So a
frame, a tapered beam or a line is passive at every port if what its sources do at one node is, together with
what else lies between that node and ground, and the rest supplies no energy. Example: a motor at the hub of
an arm, ``tau = -K/(1 + T s) theta``, with a rotary damper b there: its part has the impedance
``b + K/(s (1 + T s))``, whose real part is ``b - K T/(1 + (omega T)^2)``. With ``b >= K T`` the arm is
passive at its tip.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from symflex.contact.port import ADMITTANCES, with_branch
from symflex.expressions import Attribute, Call, Derivative, Name, names, names_among, number
from symflex.library.elements import Variable
from symflex.library.elements.lumped import ThroughSource
from symflex.model import ContactPort, Model, NetworkNode, NodeReference, PlacedElement, scope_of
from symflex.model.network import domain_of, variable_of
from symflex.model.signs import follows_inputs, line_of, parameter_signs

LUMPED = frozenset(type_name for laws in ADMITTANCES.values() for type_name, _, _ in laws.values())
PROOF = "passive, as all that acts at {} is, and nothing else supplies energy"


def at_one_place(model: Model) -> tuple[Model, ContactPort, Model] | None:
    """Return what may supply energy, with its port, and the rest; None if it is not at one place."""
    if model.fields or model.imposed or model.has_equations:
        return None
    line, inputs = line_of(model, ()), {i.name for i in model.inputs}
    active = [
        e
        for e in model.elements
        if (e.element.is_source and not follows_inputs(e, line, inputs))
        or (e.element.type_name in LUMPED and -1 in parameter_signs(e, line).values())
    ]
    if not all(isinstance(e.element, ThroughSource) or e.element.type_name in LUMPED for e in active):
        return None
    places = {v for e in active for v in _moved(e, model)} | _measured(model, active)
    if len(places) != 1 or None in places:
        return None
    (place,) = (v for v in places if v is not None)
    node = next(n for n in model.nodes if n.name == place.owner)
    kept = [
        e
        for e in model.elements
        if e in active or (e.element.type_name in LUMPED and _moved(e, model) == places)
    ]
    others = [e for e in model.elements if e not in kept]
    blocks = {b.name for b in model.blocks}
    if not others or any(names_among(x, blocks) for e in others for _, x in e.all_values):
        return None
    ports = {c: _port(node, c) for c in node.components}
    port = ports.pop(place.component)
    free = tuple(i for i in model.inputs if not i.nodes)
    part = replace(model, nodes=(node,), elements=tuple(kept), inputs=free, outputs=(), ports=())
    for other in ports.values():
        part = _held_softly(part, other)
    rest = replace(model, elements=tuple(others), signals=(), blocks=(), outputs=(), ports=(), sampled=None)
    return part, port, _held_softly(rest, port)


def _measured(model: Model, active: Sequence[PlacedElement]) -> set[Variable | None]:
    """Return what signals and active elements see of nodes, None for what else moves or flows."""
    scope, seen = scope_of(model), set[Variable | None]()
    values = [x for e in active for _, x in e.all_values] + [x.expression for x in model.signals]
    for each in (n for value in values for n in names(value)):
        meaning = scope.find(each) if isinstance(each, Name | Attribute) else None
        variable = meaning.variable if meaning else None
        if (
            isinstance(each, Derivative)
            or (isinstance(each, Call) and "." in each.name)
            or (variable and variable.kind == "through")
        ):
            seen.add(None)
        elif variable and variable.kind == "node":
            seen.add(variable)
    return seen


def _port(node: NetworkNode, component: str) -> ContactPort:
    """Return a port at a part of a node."""
    reference = NodeReference(node.name, component)
    name = f"{node.name}.{component}" if component else node.name
    return ContactPort(name, (reference,), domain_of(reference, node))


def _held_softly(model: Model, port: ContactPort) -> Model:
    """Return a model with a spring at a place, so that nothing is left without an equation there."""
    type_name, parameter, _ = ADMITTANCES[port.domain]["elastic"]
    return with_branch(model, port, type_name, {parameter: number(1)}, "held")


def _moved(use: PlacedElement, model: Model) -> set[Variable | None]:
    """Return what moves at the nodes of an element but the reference; None if it has several ports."""
    if len(use.nodes) != 1:
        return {None}
    nodes = {n.name: n for n in model.nodes}
    ((port, ends),), domains = use.nodes, dict(use.domains)
    return {variable_of(r, nodes[r.node], domains[port]) for r in ends if not r.is_ground}
