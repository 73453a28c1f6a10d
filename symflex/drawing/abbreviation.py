"""Long chains of equal links, of which the first two and the last two are drawn.

Input: a network and its nodes in order. Output: the network without the links between, with a row of dots in
their place and their number.

    m - m - m - ... 200 of them    becomes    m - m - ... n = 200 ... - m - m
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from symflex.drawing.scheme import DrawnPart, End
from symflex.drawing.symbols import ElementSymbol, dots

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.drawing.scheme import DrawnNetwork

LONGEST: Final = 8
"""Links of a chain that is drawn as a whole."""
DOTS: Final = ElementSymbol("branch", dots, 26.0)
KEPT: Final = 2
"""Links at either end of a longer one."""


def abbreviated(
    network: DrawnNetwork, order: Sequence[str], domains: Mapping[str, str]
) -> tuple[DrawnNetwork, tuple[str, ...]]:
    """Return a network with its long chains shortened, and the names of the elements that are left out."""
    hidden: set[str] = set()
    extra: list[DrawnPart] = []
    for run in _runs(network, order):
        alike = _alike(network, order, run)
        # What is marked before or behind it is one of those that are kept.
        first, last = (KEPT - (end in alike[1:-1]) for end in (run[0], run[-1]))
        hidden.update(run[first:-last])
        acting = "translation" if domains[run[0]] in ("planar", "plane") else domains[run[0]]
        ends = tuple(End(node, acting) for node in (run[first - 1], run[-last]))
        extra.append(DrawnPart("dots", "", "dots", DOTS, ends, f"n = {len(alike)}"))
    if not hidden:
        return network, ()
    gone = tuple(p.name for p in network.parts if hidden & set(p.nodes))
    parts = (*(p for p in network.parts if not hidden & set(p.nodes)), *extra)
    return replace(network, nodes=tuple(n for n in network.nodes if n not in hidden), parts=parts), gone


def _alike(network: DrawnNetwork, order: Sequence[str], run: Sequence[str]) -> Sequence[str]:
    """Return the nodes in a row that bear the same bodies, a run and its neighbours together."""
    bodies: dict[str, list[str]] = {n: [] for n in order}
    for part in network.parts:
        if part.symbol.role == "body":
            bodies[part.nodes[0]].append(part.type_name)
    first = last = order.index(run[0])
    while first and bodies[order[first - 1]] == bodies[run[0]]:
        first -= 1
    while last + 1 < len(order) and bodies[order[last + 1]] == bodies[run[0]]:
        last += 1
    return order[first : last + 1]


def _runs(network: DrawnNetwork, order: Sequence[str]) -> list[list[str]]:
    """Return the long runs of nodes that look alike, at which nothing is marked."""
    at = {n: i for i, n in enumerate(order)}
    marked = {m.node for m in network.marks} | {n for s in network.spans for n in s.nodes}
    touching: dict[str, list[DrawnPart]] = {n: [] for n in order}
    for part in network.parts:
        for node in part.nodes:
            touching[node].append(part)

    def look(node: str) -> tuple[str, ...] | None:
        """Return the types of what stands at a node and before it, None where it is no link of a chain."""
        i = at[node]
        for part in touching[node]:
            is_far = any(abs(at[n] - i) > 1 for n in part.nodes)
            if is_far or part.tags or part.points or part.kind != "element" or part.symbol.role == "source":
                return None
        return tuple(sorted(p.type_name for p in touching[node] if all(at[n] >= i for n in p.nodes)))

    runs: list[list[str]] = []
    run: list[str] = []
    last: tuple[str, ...] | None = None
    for node in order:
        found = None if node in marked else look(node)
        if found is None or found != last:
            runs.append(run)
            run = []
        if found is not None:
            run.append(node)
        last = found
    return [r for r in (*runs, run) if len(r) > LONGEST]
