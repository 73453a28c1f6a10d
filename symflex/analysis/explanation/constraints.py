"""The constrained models whose poles are the zeros: a coordinate held, a source opened, a condition replaced.

Input: a model. Output: a :class:`Constraint`, the same model with one constraint more.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from symflex.analysis.explanation.coordinates import Coordinates, driven_source, expressions_of, holds
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Number,
    format_expression,
    names,
)
from symflex.library.elements import COMPONENT_DOMAIN, ELEMENTS, Placing, Variable
from symflex.model import FieldProblem, Input, Model, NodeReference, PlacedElement
from symflex.model.model import INPUT_KINDS

HOLD = "hold"


@dataclass(frozen=True, slots=True)
class Constraint:
    """A model with one constraint more."""

    model: Model  # the constrained model
    held: str  # what is zero in it: ``x_act = 0``
    words: str  # the same in words: ``node x_act held``
    spec: str  # the line that constrains the specification; empty when it takes more than a line


def hold(model: Model, coordinates: Coordinates) -> Constraint:
    """Return a model with one coordinate held, or with two locked to each other.

    >>> from symflex import pipeline
    >>> from symflex.library.elements import Variable
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.body = { type = "mass", at = "x", m = 1 }
    ... elements.mount = { type = "spring", between = ["x", "ground"], k = 1 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> hold(model, ((Variable("node", "x"), 1),)).spec
    'hold = { type = "fixed", at = "x" }'
    """
    taken = {use.name for use in model.elements}
    name = next(n for n in (HOLD, *(f"{HOLD}_{i}" for i in range(2, len(taken) + 3))) if n not in taken)
    if len(coordinates) > 1:
        (first, _), (second, _) = coordinates
        references = {"from": _reference(first), "to": _reference(second)}
        placed = PlacedElement(
            name,
            ELEMENTS["transformer"],
            tuple((port, (r,)) for port, r in references.items()),
            tuple((port, _domain(model, v)) for port, v in (("from", first), ("to", second))),
            (("ratio", Number(Fraction(1))),),
        )
        spec = f'{name} = {{ type = "transformer", from = "{first}", to = "{second}", ratio = 1 }}'
        words = f"{first} and {second} locked to each other"
        return Constraint(_with(model, placed), f"{first} - {second} = 0", words, spec)
    ((variable, _),) = coordinates
    domain = next(n.domain for n in model.nodes if n.name == variable.owner)
    kind = {"y": "pin", "theta": "slider"}.get(variable.component if domain == "planar" else "", "fixed")
    reference = NodeReference(variable.owner)
    if domain == "plane":
        reference, domain = _reference(variable), _domain(model, variable)
    placed = PlacedElement(name, ELEMENTS[kind], (("at", (reference,)),), (("at", domain),), ())
    words = f"node {variable} short-circuited" if domain == "electrical" else f"{variable} held"
    at = f"{reference.node}.{reference.component}" if reference.component else reference.node
    spec = f'{name} = {{ type = "{kind}", at = "{at}" }}'
    return Constraint(_with(model, placed), f"{variable} = 0", words, spec)


def _with(model: Model, placed: PlacedElement) -> Model:
    return replace(model, elements=(*model.elements, placed))


def _reference(variable: Variable) -> NodeReference:
    return NodeReference(variable.owner, variable.component)


def _domain(model: Model, variable: Variable) -> Placing:
    domain = next(n.domain for n in model.nodes if n.name == variable.owner)
    return COMPONENT_DOMAIN.get(variable.component, domain)


def open_circuit(model: Model, source: Input) -> Constraint | None:
    """Return a model in which a voltage or a motion is not imposed, ``None`` when the input imposes none."""
    words = f"the terminals of {source.name} open"
    kind = INPUT_KINDS.get(source.kind)
    if kind is not None and kind.is_imposed:
        if _is_read(model, source.name):
            return None
        inputs = tuple(
            replace(i, kind=kind.effort) if i.name == source.name else i  # of an effort, none is delivered
            for i in model.inputs
        )
        # What is left out is named by outputs only, and those do not make the determinant.
        free = replace(model, inputs=inputs, outputs=())
        if kind.domain == "electrical":
            return Constraint(free, f"the current of {source.name} = 0", words, "")
        return Constraint(
            free, f"{source.name}.{kind.quantity} = 0", f"what {source.name} moves left free", ""
        )
    use = driven_source(model, source)
    if use is None or use.element.type_name != "voltage_source":
        return None
    if _is_read(model, use.name):
        return None
    # What is left out is named by outputs only, and those do not make the determinant.
    without = replace(model, elements=tuple(e for e in model.elements if e is not use), outputs=())
    return Constraint(without, f"{use.name}.i = 0", words, "")


def _is_read(model: Model, owner: str) -> bool:
    """Tell whether a quantity of an element or input is read by anything but an output."""
    read = (n for _, e in expressions_of(model, with_outputs=False) for n in names(e))
    return any(isinstance(n, Attribute) and n.owner == owner for n in read)


@dataclass(frozen=True, slots=True)
class ReplacedCondition:
    """A field's condition that gives way to one that keeps an output at zero."""

    field: FieldProblem  # as it was
    loaded: Equation  # its condition that contains the input
    measured: Call  # the value of the field that the output shows
    constraint: Constraint  # the model with the condition replaced

    @property
    def is_dual(self) -> bool:
        """Whether the input is the force, or moment, dual to what is measured.

        Of an unknown with highest derivative n, the derivatives k and n - 1 - k at one point are dual by
        Lagrange's identity: deflection and shear force, slope and moment, displacement and axial force.
        """
        order = max(
            n.order
            for e in self.field.equations
            for n in (*names(e), Derivative(self.measured.name, 0))
            if isinstance(n, Derivative) and n.name == self.measured.name
        )
        calls = [n for n in names(self.loaded) if isinstance(n, Call) and n.name in self.field.unknowns]
        orders = [n.order for n in calls if n.name == self.measured.name]
        position = format_expression(self.measured.argument)
        return (
            bool(orders)
            and max(orders) + self.measured.order == order - 1
            and all(format_expression(c.argument) == position for c in calls)
        )


def replace_condition(model: Model, source: Input, output: Expression) -> ReplacedCondition | None:
    """Return the model in which an output is zero in place of the input's one condition; else ``None``."""
    unknowns = {u for f in model.fields for u in f.unknowns}
    calls = [*{n: None for n in names(output) if isinstance(n, Call) and n.name in unknowns}]
    constants = {p.name for p in model.parameters} | {d.name for d in model.definitions} | {"s", "pi"}
    free_names = [n for n in names(output) if not isinstance(n, Call)]
    if len(calls) != 1 or any(not isinstance(n, Name) or n.name not in constants for n in free_names):
        return None
    places = [(f, c) for f in model.fields for c in f.conditions if holds(c, source.name)]
    if len(places) != 1 or sum(holds(e, source.name) for _, e in expressions_of(model)) != 1:
        return None
    ((field, loaded),) = places
    zero = Equation(calls[0], Number(Fraction(0)))
    changed = replace(field, conditions=tuple(zero if c is loaded else c for c in field.conditions))
    fields = tuple(changed if f is field else f for f in model.fields)
    held = format_expression(zero)
    words = f"{held} in place of {format_expression(loaded)}"
    constraint = Constraint(replace(model, fields=fields), held, words, f'"{held}"')
    return ReplacedCondition(field, loaded, calls[0], constraint)
