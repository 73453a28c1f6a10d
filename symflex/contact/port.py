"""The machine where it is touched: its driving-point function, and the machine with an element put there.

Input: a model and one of its ports. Output: a model with an input more and one output, whose transfer
function is the driving-point function; or a model with one element more.

A port is free unless something is attached: all inputs of the machine are zero, what is imposed stands still.
What is delivered into the node (force, torque, current, flow) drives it, and the partner answers::

    mass m on a spring k and a damper b, touched at its node    v/f = s/(m*s^2 + b*s + k)

With ``is_imposed`` the partner drives, and what has to be delivered answers: ``f/v``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Literal

from symflex.algebra import LAPLACE
from symflex.expressions import Attribute, Expression, Name, negative, number, product_of, sum_of
from symflex.library.elements import ELEMENTS, THROUGH_NAME
from symflex.model import (
    ContactPort,
    Input,
    Model,
    NetworkNode,
    NodeReference,
    Output,
    PlacedElement,
    scope_of,
)
from symflex.model.model import INPUT_KINDS, PORT_PAIRS
from symflex.model.network import variable_of
from symflex.model.scope import free_name
from symflex.quantities import unit_of

Kind = Literal["elastic", "inertial", "dissipative"]
ORDER: dict[Kind, int] = {"elastic": -1, "inertial": 1, "dissipative": 0}  # of s in the admittance
ADMITTANCES: dict[str, dict[Kind, tuple[str, str, bool]]] = {
    "translation": {
        "elastic": ("spring", "k", False),
        "inertial": ("mass", "m", False),
        "dissipative": ("damper", "b", False),
    },
    "rotation": {
        "elastic": ("torsion_spring", "k", False),
        "inertial": ("inertia", "J", False),
        "dissipative": ("rotary_damper", "b", False),
    },
    "electrical": {
        "elastic": ("inductor", "L", True),
        "inertial": ("capacitor", "C", False),
        "dissipative": ("resistor", "R", True),
    },
    "acoustic": {
        "elastic": ("acoustic_mass", "M", True),
        "inertial": ("acoustic_compliance", "C", False),
        "dissipative": ("acoustic_resistance", "R", True),
    },
}
"""By domain, elements with the admittances a/s, a s and a: type, parameter, and whether that is 1/a."""
RATES = {"translation": "v", "rotation": "omega", "electrical": "v", "acoustic": "p"}
"""What answers what is delivered, as formulas call it."""


def at_port(model: Model, port: ContactPort, *, is_imposed: bool = False) -> tuple[Model, tuple[str, str]]:
    """Return a model that is driven at a port, and its driving-point function as (output, input)."""
    model, port = _with_clear_nodes(model, port)
    taken, written = taken_names(model), port.name.replace(".", "_")
    through, rate = (
        free_name(f"{name}_{written}", taken) for name in (THROUGH_NAME[port.domain], RATES[port.domain])
    )
    pair = PORT_PAIRS[port.domain]
    delivered, followed = INPUT_KINDS[pair.delivered], INPUT_KINDS[pair.imposed]
    if is_imposed:
        reaction = Attribute(rate, followed.quantity)
        source = Input(rate, pair.imposed, port.nodes, unit_of(followed.unit).dimension, followed.unit)
        answer = Output(through, reaction, unit_of(delivered.unit).dimension, delivered.unit)
    else:
        moved = product_of([*[Name(LAPLACE)] * (followed.order or 0), _across(model, port)])
        source = Input(through, pair.delivered, port.nodes, unit_of(delivered.unit).dimension, delivered.unit)
        answer = Output(rate, moved, unit_of(followed.unit).dimension, followed.unit)
    pair_of_names = answer.name, source.name
    quotient = unit_of(answer.unit).dimension / unit_of(source.unit).dimension
    driven = replace(
        model,
        inputs=(*model.inputs, source),
        outputs=(answer,),
        quotients=((pair_of_names, quotient),),
        figures=(),
        published=(),
        tables=(),
    )
    return driven, pair_of_names


def with_branch(
    model: Model, port: ContactPort, type_name: str, values: Mapping[str, Expression], name: str
) -> Model:
    """Return a model with a two-terminal element from a port to its second node or to ground.

    An element at a single node, such as a mass, goes to the port's node. ``name`` is changed where it is
    taken. Values are in SI units.
    """
    element = ELEMENTS[type_name]
    (attached,) = element.ports
    ends = (*port.nodes, NodeReference("ground"))[: attached.terminals]
    given = {p.name: number(Fraction(p.default)) for p in element.parameters if p.default is not None}
    use = PlacedElement(
        free_name(name, taken_names(model)),
        element,
        ((attached.name, ends),),
        ((attached.name, port.domain),),
        tuple({**given, **values}.items()),
    )
    return replace(model, elements=(*model.elements, use))


def with_hanging_mass(
    model: Model,
    port: ContactPort,
    spring: tuple[str, Mapping[str, Expression]],
    mass: tuple[str, Mapping[str, Expression]],
) -> Model:
    """Return a model with a spring at the first node of a port, and a mass at its other end.

    Each is a type with its values; those of another domain are what is like them there.
    """
    end = free_name("touched_end", taken_names(model))
    domain = port.domain
    model = replace(model, nodes=(*model.nodes, NetworkNode(end, domain)))
    at_end = ContactPort(end, (NodeReference(end),), domain)
    between = replace(port, nodes=(port.nodes[0], NodeReference(end)))
    return with_branch(with_branch(model, between, *spring, "touched"), at_end, *mass, "touched_mass")


def _across(model: Model, port: ContactPort) -> Expression:
    """Return the across quantity at a port: that of the first node, less that of the second."""
    nodes = {n.name: n for n in model.nodes}
    terms: list[Expression] = []
    for i, reference in enumerate(port.nodes):
        if reference.is_ground:
            continue
        variable = variable_of(reference, nodes[reference.node], port.domain)
        term: Expression = Name(variable.owner)
        if variable.component:
            term = Attribute(variable.owner, variable.component)
        terms.append(negative(term) if i else term)
    return sum_of(terms)


def _with_clear_nodes(model: Model, port: ContactPort) -> tuple[Model, ContactPort]:
    """Return a model in which a port's nodes have names that mean nothing else.

    A node may share its name with a parameter, say: then no expression names the node.
    """
    scope = scope_of(model)
    components = {n.name: n.components for n in model.nodes}
    for reference in port.nodes:
        if reference.is_ground or components[reference.node] != ("",):
            continue
        if len(scope.meanings.get(reference.node, ())) > 1:
            new = free_name(f"{reference.node}_node", taken_names(model))
            model, port = _renamed(model, port, reference.node, new)
    return model, port


def _renamed(model: Model, port: ContactPort, old: str, new: str) -> tuple[Model, ContactPort]:
    def names(references: tuple[NodeReference, ...]) -> tuple[NodeReference, ...]:
        return tuple(replace(r, node=new) if r.node == old else r for r in references)

    return (
        replace(
            model,
            nodes=tuple(replace(n, name=new) if n.name == old else n for n in model.nodes),
            elements=tuple(
                replace(e, nodes=tuple((p, names(r)) for p, r in e.nodes)) for e in model.elements
            ),
            inputs=tuple(replace(i, nodes=names(i.nodes)) for i in model.inputs),
            ports=tuple(replace(p, nodes=names(p.nodes)) for p in model.ports),
        ),
        replace(port, nodes=names(port.nodes)),
    )


def taken_names(model: Model) -> set[str]:
    """Return every name of a model."""
    scope = scope_of(model)
    outputs = (o.name for o in model.outputs)
    return {*scope.meanings, *scope.owners, *outputs, *scope.unknowns, *(e.name for e in model.elements)}
