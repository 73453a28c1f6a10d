"""Delays written as ``exp(-s*T)``: each is a block of type delay without a name.

Input: a draft, as read. Output: the same, with a name of a block wherever the exponential stood.

Example: in ``u = "K*exp(-s*T)*(r - x)"`` the exponential is the block ``{ type = "delay", T = "T" }``.
A definition that holds one, ``C = "K*exp(-s*T)"``, and such a tf block are written out where they are used.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Quotient,
    is_number,
    names,
    names_among,
    negative,
    nodes,
    replace_values,
    substitute,
)
from symflex.library.blocks import BLOCKS
from symflex.model.branches import per
from symflex.model.model import PlacedBlock, rewritten
from symflex.model.scope import COORDINATE

if TYPE_CHECKING:
    from symflex.model.network import Draft

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
    along = {COORDINATE} - {p.name for p in draft.declared} - {p.name for p in draft.inherited}
    times = {n: t for e in places for n in nodes(e) if (t := _written_delay(n)) and not names_among(t, along)}
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

    kept = replace(
        draft,
        definitions=tuple(d for d in draft.definitions if d.name not in late),
        blocks=tuple(b for b in draft.blocks if b.name not in late),
    )
    kept = rewritten(kept, put_in)
    return replace(kept, blocks=(*kept.blocks, *blocks.values()))


def _written_delay(node: Expression) -> Expression | None:
    """Return T of ``exp(-s*T)``; None of all else."""
    if not isinstance(node, Call) or node.name != "exp" or node.order:
        return None
    found = per(negative(node.argument), LAPLACE)
    return None if found is None or found[1] != 1 or is_number(found[0], 0) else found[0]
