"""A machine that touches another one: both specifications as one model, joined at a port of each.

Input: two models and a port of each. Output: the first one with all parts of the second, whose names end in
``_e`` there, as those of an environment do, and a rigid joint between the ports. Example: a mass at ``x``
that touches the tip of a beam of another file, port ``tip``: its stiffness EI is called ``EI_e``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from symflex.contact.port import taken_names
from symflex.errors import refused
from symflex.expressions import Attribute, Call, Expression, Name, names, number, substitute
from symflex.library.elements import ELEMENTS
from symflex.model import ContactPort, Model, NodeReference, PlacedElement
from symflex.model.model import rewritten
from symflex.model.scope import RESERVED, free_name

JOINT = "joint"  # the element between both ports


def joined(machine: Model, port: ContactPort, other: Model, other_port: ContactPort) -> Model:
    """Return a machine with another one at its port; SF902 where the ports do not fit or fields are in it."""
    if port.domain != other_port.domain:
        message = f"port '{port.name}' is in {port.domain}, and '{other_port.name}' in {other_port.domain}"
        raise refused(message, "join what moves or flows alike")
    if other.fields or any(type(n) is Call and "." in n.name for e in _expressions(other) for n in names(e)):
        message = "an environment of a file cannot have [fields], or quantities at points of members"
        raise refused(message, "write its elements into the specification")
    taken = taken_names(machine)
    new = {name: free_name(f"{name}_e", taken) for name in sorted(taken_names(other))}
    moved = _renamed(other, new)
    nodes = tuple(_reference(r, new) for r in other_port.nodes)
    joint = PlacedElement(
        free_name(JOINT, taken | set(new.values())),
        ELEMENTS["transformer"],
        (("from", port.nodes), ("to", nodes)),
        (("from", port.domain), ("to", port.domain)),
        (("ratio", number(1)),),
    )
    return replace(
        machine,
        parameters=(*machine.parameters, *moved.parameters),
        definitions=(*machine.definitions, *moved.definitions),
        nodes=(*machine.nodes, *moved.nodes),
        elements=(*machine.elements, *moved.elements, joint),
        signals=(*machine.signals, *moved.signals),
        blocks=(*machine.blocks, *moved.blocks),
        inputs=(*machine.inputs, *moved.inputs),
        conversions=(*machine.conversions, *moved.conversions),
        quotients=(),
        figures=(),
        published=(),
        tables=(),
    )


def _expressions(model: Model) -> Iterable[Expression]:
    """Return the expressions of a model but those of outputs."""
    return (e for _, e in replace(model, outputs=()).expressions())


def _renamed(model: Model, new: Mapping[str, str]) -> Model:
    """Return a model whose parts have other names, without outputs."""

    def moved(expression: Expression) -> Expression:
        mapping: dict[str, Expression] = {}
        for node in names(expression):
            if isinstance(node, Name) and node.name in new and node.name not in RESERVED:
                mapping[node.name] = Name(new[node.name], span=node.span)
            elif isinstance(node, Attribute) and node.owner in new:
                mapping[f"{node.owner}.{node.name}"] = Attribute(new[node.owner], node.name, span=node.span)
        return substitute(expression, mapping)

    model = rewritten(replace(model, outputs=()), moved)
    return replace(
        model,
        parameters=tuple(replace(p, name=new[p.name]) for p in model.parameters),
        definitions=tuple(
            replace(d, name=new[d.name], expression=moved(d.expression)) for d in model.definitions
        ),
        nodes=tuple(replace(n, name=new[n.name]) for n in model.nodes),
        elements=tuple(
            replace(
                e,
                name=new[e.name],
                nodes=tuple((k, tuple(_reference(r, new) for r in rs)) for k, rs in e.nodes),
            )
            for e in model.elements
        ),
        signals=tuple(replace(x, name=new[x.name]) for x in model.signals),
        blocks=tuple(replace(b, name=new[b.name]) for b in model.blocks),
        inputs=tuple(
            replace(i, name=new[i.name], nodes=tuple(_reference(r, new) for r in i.nodes))
            for i in model.inputs
        ),
        conversions=tuple(replace(p, name=new.get(p.name, p.name)) for p in model.conversions),
    )


def _reference(reference: NodeReference, new: Mapping[str, str]) -> NodeReference:
    return reference if reference.is_ground else replace(reference, node=new[reference.node])
