"""Dead times written as ``exp(-s*T)``: each is a block of type delay without a name of its own.

Input: a draft, as read. Output: the same, with a name of a block wherever the exponential stood.

Example: in ``u = "K*exp(-s*T)*(r - x)"`` the exponential is the block ``{ type = "delay", T = "T" }``.
A definition that holds one, ``C = "K*exp(-s*T)"``, and such a tf block are written out where they are used.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, TypeVar

from symflex.algebra import LAPLACE
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    is_number,
    names,
    names_among,
    negative,
    nodes,
    number,
    product_of,
    replace_values,
    substitute,
    sum_of,
)
from symflex.library.blocks import BLOCKS
from symflex.model.model import PlacedBlock

if TYPE_CHECKING:
    from collections.abc import Collection

    from symflex.model.network import Draft, DraftElement

Placed = TypeVar("Placed", "DraftElement", PlacedBlock)
SIZE_LIMIT = 200
"""Nodes of what is written out: definitions of definitions would double at every level."""


def with_dead_times(draft: Draft, taken: Collection[str]) -> Draft:
    """Return a draft with a delay block for each ``exp(-s*T)``; their names are not among those taken."""
    places = [e for use in draft.elements for _, e in use.values]
    for group in (draft.definitions, draft.signals, draft.outputs):
        places += [x.expression for x in group]
    equations = [e for field in draft.fields for e in (*field.equations, *field.conditions)]
    places += [side for e in equations for side in (e.left, e.right)]
    ratios = {b.name: _ratio(b) for b in draft.blocks if b.block is BLOCKS["tf"]}
    places += ratios.values()
    times = {n: t for e in places for n in nodes(e) if (t := _dead_time(n)) is not None}
    if not times:
        return draft
    used = {n.name for e in places for n in names(e)}
    free = (name for i in count(1) if (name := f"delay_{i}") not in taken and name not in used)
    spans = {time: node.span for node, time in times.items()}
    blocks = {
        time: PlacedBlock(next(free), BLOCKS["delay"], (("T", replace(time, span=span)),), span=span)
        for time, span in spans.items()
    }
    mapping = {node: Name(blocks[time].name, span=node.span) for node, time in times.items()}
    late: dict[str, Expression] = {}
    bodies = {d.name: d.expression for d in draft.definitions} | ratios
    grown = True
    while grown:  # each may use those that were late before
        grown = False
        for name in [n for n in bodies if n not in late]:
            put = substitute(replace_values(bodies[name], mapping), late)
            if put is bodies[name]:
                continue
            if len(nodes(put)) > SIZE_LIMIT:
                return draft  # which is refused where the exponentials stand
            late[name], grown = put, True

    def put_in(expression: Expression) -> Expression:
        return substitute(replace_values(expression, mapping), late)

    def with_values(item: Placed) -> Placed:
        return replace(item, values=tuple((n, put_in(e)) for n, e in item.values))

    return replace(
        draft,
        definitions=tuple(d for d in draft.definitions if d.name not in late),
        elements=tuple(with_values(x) for x in draft.elements),
        signals=tuple(replace(x, expression=put_in(x.expression)) for x in draft.signals),
        outputs=tuple(replace(x, expression=put_in(x.expression)) for x in draft.outputs),
        blocks=(*(with_values(x) for x in draft.blocks if x.name not in late), *blocks.values()),
        fields=tuple(field.rewritten(put_in) for field in draft.fields),
    )


def _ratio(block: PlacedBlock) -> Expression:
    values = dict(block.values)
    return Quotient(values["num"], values["den"])


def _dead_time(node: Expression) -> Expression | None:
    """Return T of ``exp(-s*T)``; None of all else."""
    if not isinstance(node, Call) or node.name != "exp" or node.order:
        return None
    time = _per_s(negative(node.argument))
    return None if time is None or is_number(time, 0) else time


def _per_s(expression: Expression) -> Expression | None:
    """Return what s is multiplied by in a product of s and constants, or a sum of these."""
    match expression:
        case Name(name) if name == LAPLACE:
            return number(1)
        case Negative(operand):
            inner = _per_s(operand)
            return None if inner is None else negative(inner)
        case Product(factors):
            moving = [f for f in factors if names_among(f, (LAPLACE,))]
            inner = _per_s(moving[0]) if len(moving) == 1 else None
            return None if inner is None else product_of([inner if f is moving[0] else f for f in factors])
        case Quotient(numerator, denominator) if not names_among(denominator, (LAPLACE,)):
            inner = _per_s(numerator)
            return None if inner is None else Quotient(inner, denominator)
        case Sum(terms):
            inner_terms = [_per_s(term) for term in terms]
            terms_per_s = [each for each in inner_terms if each is not None]
            return sum_of(terms_per_s) if len(terms_per_s) == len(terms) else None
    return None
