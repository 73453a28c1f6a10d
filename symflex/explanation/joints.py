"""What conditions of fields make one: values of two fields at a joint, or of a field and a node.

Input: a model. Output: groups of values that are equal by a condition such as ``w_2(l/2) = w_1(l/2)``.

Example: of a beam of two fields, with the force a jump of the shear in a condition of ``w_2``, the output
``w_1(l/2)`` is ``w_2(l/2)``, on which the force does work.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.expressions import (
    Attribute,
    Call,
    Equation,
    Name,
    Negative,
    Number,
    Sum,
    format_expression,
    names,
    replace_values,
)

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.model import Input, Model

PAIR = 2


def joined_values(model: Model) -> list[list[Expression]]:
    """Return the groups of values that conditions make equal.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... inputs.F = {}
    ... outputs.U = "u(1)"
    ... [fields.u]
    ... domain = ["0", "1"]
    ... equation = "u'' - s^2*u = 0"
    ... conditions = ["u(0) = 0", "u(1) = v(1)"]
    ... [fields.v]
    ... domain = ["1", "2"]
    ... equation = "v'' - s^2*v = 0"
    ... conditions = ["v'(1) - u'(1) = F", "v(2) = 0"]
    ... ''')
    >>> [[format_expression(value) for value in group] for group in joined_values(model)]
    [['u(1)', 'v(1)']]
    """
    groups: list[list[Expression]] = []
    for field in model.fields:
        for condition in field.conditions:
            equal = _equal(model, condition)
            if equal is None:
                continue
            met = [g for g in groups if any(_is_same(a, b) for a in g for b in equal)]
            whole = [value for group in met for value in group]
            whole += [value for value in equal if not any(_is_same(value, other) for other in whole)]
            groups = [*(g for g in groups if g not in met), whole]
    return groups


def seen_at_the_input(model: Model, output: str, source: Input) -> Model:
    """Return the model with an output written in the value of the field, or node, on which an input acts.

    An output of one value of a field is written in the equal one that stands in a condition with the input,
    else in the node it is equal to. Nothing else is changed.
    """
    (wanted,) = (o for o in model.outputs if o.name == output)
    unknowns = {u for f in model.fields for u in f.unknowns}
    shown = [n for n in names(wanted.expression) if isinstance(n, Call) and n.name in unknowns]
    if len(shown) != 1:
        return model
    group = next((g for g in joined_values(model) if any(_is_same(v, shown[0]) for v in g)), [])
    loaded = {
        unknown
        for field in model.fields
        if any(_holds(condition, source.name) for condition in field.conditions)
        for unknown in field.unknowns
    }
    chosen = next(
        (v for v in group if (v.name in loaded if isinstance(v, Call) else not loaded)),
        None,
    )
    if chosen is None or chosen == shown[0]:
        return model
    changed = replace(wanted, expression=replace_values(wanted.expression, {shown[0]: chosen}))
    return replace(model, outputs=tuple(changed if o is wanted else o for o in model.outputs))


def _equal(model: Model, condition: Equation) -> tuple[Expression, Expression] | None:
    """Return the two values that a condition says are equal, ``None`` when it says anything else."""
    left, right = condition.left, condition.right
    if _is_zero(left):
        left, right = right, left
    if _is_zero(right) and isinstance(left, Sum) and len(left.terms) == PAIR:
        plus = [term for term in left.terms if not isinstance(term, Negative)]
        minus = [term.operand for term in left.terms if isinstance(term, Negative)]
        if len(plus) != 1:
            return None
        left, right = plus[0], minus[0]
    return (left, right) if _is_value(model, left) and _is_value(model, right) else None


def _is_zero(side: Expression) -> bool:
    return isinstance(side, Number) and not side.value


def _is_value(model: Model, side: Expression) -> bool:
    match side:
        case Call(name=name):
            return any(name in field.unknowns for field in model.fields)
        case Name(name=name) | Attribute(owner=name):
            return any(node.name == name for node in model.nodes)
    return False


def _is_same(a: Expression, b: Expression) -> bool:
    return format_expression(a) == format_expression(b)


def _holds(condition: Equation, name: str) -> bool:
    return any(isinstance(n, Name) and n.name == name for n in names(condition))
