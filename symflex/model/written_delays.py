"""Delays written as ``exp(-s*T)``: each is a block of type delay without a name.

Input: a draft, as read. Output: the same, with a name of a block wherever the exponential stood.

Example: in ``u = "K*exp(-s*T)*(r - x)"`` the exponential is the block ``{ type = "delay", T = "T" }``. What
else stands in the exponent is a factor: ``exp(-(s + a)*T)`` is ``exp(-a*T)`` times that block.
A definition that holds one, ``C = "K*exp(-s*T)"``, and such a tf block are written out where they are used.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import count
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Number,
    Product,
    Quotient,
    is_number,
    names,
    names_among,
    negative,
    nodes,
    number,
    product_of,
    replace_values,
    substitute,
)
from symflex.library.blocks import BLOCKS
from symflex.model.branches import opened_definitions, powers_of
from symflex.model.model import PlacedBlock, rewritten
from symflex.model.scope import COORDINATE

if TYPE_CHECKING:
    from symflex.model.network import Draft

ONE = Number(Fraction(1))
SIZE_LIMIT = 200  # nodes of what is written out: definitions of definitions would double at every level


def with_written_delays(draft: Draft, taken: Collection[str]) -> Draft:
    """Return a draft with a delay block for each ``exp(-s*T)``; their names are not among those taken."""
    places = draft.expressions()
    ratios = {
        b.name: Quotient(*(dict(b.values)[n] for n in ("num", "den")))
        for b in draft.blocks
        if b.block is BLOCKS["tf"]
    }
    places += ratios.values()
    # What depends on x is no delay, unless x is a parameter.
    along = {COORDINATE}.difference(draft.parameters)
    exponentials = [n for e in places for n in nodes(e) if isinstance(n, Call) and n.name == "exp"]
    opened = opened_definitions(draft) if exponentials else None
    moving = {name: e for name, e in (opened or {}).items() if names_among(e, (LAPLACE,))}
    written = {n: _written_delay(n, moving) for n in exponentials}
    late_nodes = {n: delay for n, delay in written.items() if delay and not names_among(delay[0], along)}
    if not late_nodes:
        return draft
    used = {*taken, *(n.name for e in places for n in names(e))}
    free = (name for i in count(1) if (name := f"delay_{i}") not in used)
    spans = {time: node.span for node, (time, _) in late_nodes.items()}
    blocks = {
        time: PlacedBlock(next(free), BLOCKS["delay"], (("T", replace(time, span=span)),), span=span)
        for time, span in spans.items()
    }
    mapping: dict[Expression, Expression] = {
        node: product_of([gain, Name(blocks[time].name, span=node.span)])
        for node, (time, gain) in late_nodes.items()
    }
    late = _written_out({d.name: d.expression for d in draft.definitions} | ratios, mapping)
    if late is None:
        return draft  # which is refused where the exponentials stand

    def put_in(expression: Expression) -> Expression:
        return substitute(replace_values(expression, mapping), late)

    kept = replace(
        draft,
        definitions=tuple(d for d in draft.definitions if d.name not in late),
        blocks=tuple(b for b in draft.blocks if b.name not in late),
    )
    kept = rewritten(kept, put_in)
    return replace(kept, blocks=(*kept.blocks, *blocks.values()))


def _written_out(
    bodies: Mapping[str, Expression], mapping: Mapping[Expression, Expression]
) -> dict[str, Expression] | None:
    """Return what holds a delay, written out; ``None`` where that would be too long."""
    late: dict[str, Expression] = {}
    grown = True
    while grown:  # each may use those that were late before
        grown = False
        for name in [n for n in bodies if n not in late]:
            put = substitute(replace_values(bodies[name], mapping), late)
            if put is bodies[name]:
                continue
            if len(nodes(put)) > SIZE_LIMIT:
                return None
            late[name], grown = put, True
    return late


def _written_delay(node: Call, moving: Mapping[str, Expression]) -> tuple[Expression, Expression] | None:
    """Return T and a constant C of ``exp(-s*T)*C``, as of ``exp(a - s*T)``; None of all else."""
    if node.order:
        return None
    argument = substitute(node.argument, moving)
    powers = powers_of(negative(argument), LAPLACE)
    if powers is None or max(powers) != 1 or is_number(powers[1], 0):
        return None
    delay = negative(powers.get(0, number(0)))
    if is_number(delay, 0):
        return powers[1], number(1)
    if ONE in nodes(argument) and not any(isinstance(n, Number) for n in nodes(delay)):
        delay = Product((ONE, delay))  # in (s - 1)*T the 1 is one per second
    return powers[1], Call("exp", delay)
