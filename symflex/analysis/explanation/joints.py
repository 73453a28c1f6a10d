"""What is one place: ends of elements and their nodes, and values that conditions of fields make equal.

Input: a model. Output: the same model in which every place is written in one way, and groups of values that
are equal by a condition such as ``w_2(l/2) = w_1(l/2)``.

Example: of a beam of two fields, with the force a jump of the shear in a condition of ``w_2``, the output
``w_1(l/2)`` is ``w_2(l/2)``, on which the force does work.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.analysis.explanation.constraints import holds
from symflex.expressions import (
    Attribute,
    Call,
    Equation,
    Name,
    Negative,
    Number,
    Product,
    Sum,
    is_number,
    names,
    replace_values,
)
from symflex.library.elements import LineElement
from symflex.model.nodes import variable_of
from symflex.model.points import Line

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

    from symflex.expressions import Expression
    from symflex.model import Input, Model, PlacedElement

PAIR = 2


def in_one_way(model: Model) -> Model:
    """Return a model whose places are written in one way: ends of elements as nodes, equal points alike.

    Points are equal by the parameters' values where they have some.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.l = "2 m"
    ... elements.bar = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = "l" }
    ... inputs.F = { force = "x" }
    ... outputs.U = "s*bar.u(l/2 + 1 m)"
    ... ''')
    >>> from symflex.expressions import format_expression
    >>> format_expression(in_one_way(model).outputs[0].expression)
    's*x'
    """
    line = Line.of_numbers(model.definitions, ((p.name, p.value) for p in model.parameters))
    ends = {
        (f"{use.name}.{name}", line.key(place)): shown
        for use in model.elements
        if isinstance(use.element, LineElement)
        for name, place, shown in _ends(model, use, use.element)
    }
    spelled: dict[Hashable, Expression] = {}
    unknowns = {u for field in model.fields for u in field.unknowns}

    def written(expression: Expression) -> Expression:
        changed: dict[Call, Expression] = {}
        for call in (n for n in names(expression) if isinstance(n, Call)):
            place = line.key(call.argument) if call.name in unknowns or "." in call.name else None
            if call.name in unknowns:
                changed[call] = replace(call, argument=spelled.setdefault(place, call.argument))
            elif not call.order and (call.name, place) in ends:
                changed[call] = ends[call.name, place]
        return replace_values(expression, changed)

    for field in model.fields:
        for end in (field.start, field.end):
            spelled.setdefault(line.key(end), end)
    fields = [
        replace(
            f,
            conditions=tuple(replace(c, left=written(c.left), right=written(c.right)) for c in f.conditions),
        )
        for f in model.fields
    ]
    signals = [replace(each, expression=written(each.expression)) for each in model.signals]
    outputs = [replace(each, expression=written(each.expression)) for each in model.outputs]
    return replace(model, fields=tuple(fields), signals=tuple(signals), outputs=tuple(outputs))


def _ends(
    model: Model, use: PlacedElement, element: LineElement
) -> Iterator[tuple[str, Expression, Expression]]:
    """Yield what the motion of an element's ends is called, the place, and the node that moves so."""
    (_, references), *_ = use.nodes
    nodes = {node.name: node for node in model.nodes}
    read_otherwise = {each.name for each in model.signals} | {each.name for each in model.inputs}
    domain = element.ports[0].domain
    for reference, place in zip(
        references, (Number(Fraction(0)), dict(use.values)[element.length]), strict=True
    ):
        if reference.is_ground or reference.node in read_otherwise:
            continue
        for component, called in zip(element.ends, element.along, strict=False):
            picked = replace(reference, component=component) if domain == "planar" else reference
            moved = variable_of(picked, nodes[reference.node], domain)
            shown = Attribute(moved.owner, moved.component) if moved.component else Name(moved.owner)
            for name in called:
                yield name, place, shown


def joined_values(model: Model) -> list[list[Expression]]:
    """Return the groups of values that conditions make equal.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... inputs.F = {}
    ... outputs.U = "u(1)"
    ... fields.u = { domain = [0, 1], equation = "u'' = u", conditions = ["u(0) = 0", "u(1) = v(1)"] }
    ... fields.v = { domain = [1, 2], equation = "v'' = v", conditions = ["v'(1) = u'(1) + F", "v(2) = 0"] }
    ... ''')
    >>> from symflex.expressions import format_expression
    >>> [[format_expression(value) for value in group] for group in joined_values(model)]
    [['u(1)', 'v(1)']]
    """
    groups: list[list[Expression]] = []
    for field in model.fields:
        for condition in field.conditions:
            equal = _equal(model, condition)
            if equal is None:
                continue
            met = [g for g in groups if any(value in g for value in equal)]
            whole = [value for group in met for value in group]
            whole += [value for value in equal if value not in whole]
            groups = [*(g for g in groups if g not in met), whole]
    return groups


def seen_at_the_input(model: Model, output: str, source: Input) -> Model:
    """Return the model with an output written in the value of the field, or node, on which an input acts.

    An output of one value of a field is written in the equal one that stands in a condition with the input,
    else in the node it is equal to. Nothing else is changed.
    """
    (wanted,) = (o for o in model.outputs if o.name == output)
    unknowns = {u for f in model.fields for u in f.unknowns}
    shown = {n for n in names(wanted.expression) if isinstance(n, Call) and n.name in unknowns}
    group = next((g for g in joined_values(model) if all(v in g for v in shown)), []) if shown else []
    loaded = {
        unknown
        for field in model.fields
        if any(holds(condition, source.name) for condition in field.conditions)
        for unknown in field.unknowns
    }
    chosen = next((v for v in group if (v.name in loaded if isinstance(v, Call) else not loaded)), None)
    if chosen is None:
        return model
    changed = replace(wanted, expression=replace_values(wanted.expression, dict.fromkeys(shown, chosen)))
    return replace(model, outputs=tuple(changed if o is wanted else o for o in model.outputs))


def _equal(model: Model, condition: Equation) -> tuple[Expression, Expression] | None:
    """Return the two values that a condition says are equal, ``None`` when it says anything else."""
    left, right = condition.left, condition.right
    if is_number(left, 0):
        left, right = right, left
    if is_number(right, 0) and isinstance(left, Sum) and len(left.terms) == PAIR:
        plus = [term for term in left.terms if not isinstance(term, Negative)]
        minus = [term.operand for term in left.terms if isinstance(term, Negative)]
        if len(plus) != 1:
            return None
        left, right = plus[0], minus[0]
    if isinstance(left, Product) and isinstance(right, Product) and left.factors[:-1] == right.factors[:-1]:
        left, right = left.factors[-1], right.factors[-1]
    return (left, right) if _is_value(model, left) and _is_value(model, right) else None


def _is_value(model: Model, side: Expression) -> bool:
    match side:
        case Call(name=name):
            return any(name in field.unknowns for field in model.fields)
        case Name(name=name) | Attribute(owner=name):
            return any(node.name == name for node in model.nodes)
    return False
