"""Blocks that stand in no diagram, below a drawing: those in a gain, in a parameter of an element, or unused.

Input: a graph of signals. Output: lines of mathematics, one part each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.drawing.geometry import Placed
from symflex.drawing.lettering import SMALL, filled, text
from symflex.drawing.signals import formula

if TYPE_CHECKING:
    from symflex.drawing.signals import SignalGraph

LEADING: Final = 4.0
"""Between lines [points]."""
WIDEST: Final = 200.0
"""Of a formula that is written out [points]."""


def statements(graph: SignalGraph) -> list[Placed]:
    """Return the formulas, one below the other."""
    shown = {n.name for n in graph.nodes if n.kind == "block"}
    y, found = 0.0, []
    for block in graph.blocks.values():
        if block.name in shown:
            continue
        value = formula(block)
        name = graph.labels.name(block.name)
        line = text(f"{name} = {graph.labels.fraction(value)}", SMALL) if value is not None else None
        line = line if line and line.width <= WIDEST else text(name, SMALL)
        values = filled(graph.labels.values([e for _, e in block.values]), WIDEST)
        lines = []
        for one in (line, *values) if line else ():
            y -= one.height
            lines.append(one.moved(0.0, y))
            y -= one.depth + LEADING
        found.append(Placed("block", block.name, (), tuple(lines)))
    return found
