"""Which nodes of a network are drawn, and in which order they stand from left to right.

Input: a network and the domains of its nodes. Output: the nodes in order, such that joined ones stand near
each other: a chain from its actuator, or from the ground, to its tip. Of a long chain of equal links the
first two and the last two are drawn, with a row of dots and the number of links in place of those between:

    m - m - m - ... 200 of them    becomes    m - m - ... n = 200 ... - m - m
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby, pairwise
from typing import Final

from symflex.drawing.scheme import DrawnNetwork, DrawnPart, End
from symflex.drawing.symbols import DOTS

BRIDGE: Final = 0.5  # what it costs that a part joins no neighbours, besides what it spans
MEMBER: Final = 3.0  # how much more that is of a member, which is long and looks stiff at corners
LARGEST: Final = 40  # nodes of a network that is walked from each of them; longer ones are chains
LANES: Final = {"rotation": 1, "translation": 2, "planar": 2, "plane": 2}
"""Which domain stands to the left of which, where a part joins both; circuits stand at 0."""
LONGEST: Final = 8  # links of a chain that is drawn as a whole
KEPT: Final = 2  # links at either end of a longer one


def order_of(network: DrawnNetwork, domains: Mapping[str, str]) -> tuple[str, ...]:
    """Return the nodes of a network from left to right."""
    pull = dict.fromkeys(network.nodes, 0.0)  # to the left (negative) or to the right
    for part in network.parts:
        if len(part.ends) > 1 and any(not e.node for e in part.ends):
            for node in part.nodes:
                pull[node] -= 0.7
        for node in part.nodes[:1]:
            pull[node] -= {"source": 0.6, "support": 0.1}.get(part.symbol.role, 0.0)
    for mark in network.marks:
        kinds = {kind for kind, *_ in mark.labels}
        moved = mark.style in ("motion", "raise", "twist")
        pull[mark.node] += (-2.0 if moved else -0.4) if "input" in kinds else 0.15
    joints = [(pair, p.symbol.role == "member") for p in network.parts for pair in pairwise(p.nodes)]
    found = _ordered(network.nodes, joints, pull, {n: LANES.get(domains[n], 0) for n in network.nodes})
    wanted = iter(network.order)
    return tuple(next(wanted) if n in network.order else n for n in found)


def _ordered(
    nodes: Sequence[str],
    joints: Sequence[tuple[tuple[str, str], bool]],
    pull: Mapping[str, float],
    lanes: Mapping[str, int],
) -> Sequence[str]:
    """Return nodes from left to right; ``joints`` are pairs that parts join, and whether by a member."""
    if len(nodes) < 2:  # noqa: PLR2004
        return nodes
    beside: dict[str, list[str]] = {n: [] for n in nodes}
    for (a, b), _ in joints:
        if b not in beside[a]:
            beside[a].append(b)
            beside[b].append(a)
    start = min(nodes, key=lambda n: (lanes[n], pull[n], len(beside[n]), nodes.index(n)))
    best = _walked(beside, start)
    if len(nodes) > LARGEST:
        return best
    directed = {pair for pair, is_member in joints if is_member}  # run from left to right where they can
    members = directed | {(b, a) for a, b in directed}

    def cost(order: Sequence[str]) -> float:
        at = {n: i for i, n in enumerate(order)}
        total = 0.0
        for (a, b), _ in joints:
            apart = at[b] - at[a]
            bridged = abs(apart) - 1 + BRIDGE if abs(apart) > 1 else 0.0
            total += bridged * (MEMBER if (a, b) in members else 1.0)
            total += 0.3 if apart < 0 and (a, b) in directed else 0.0
            total += 0.6 if (lanes[a] - lanes[b]) * apart > 0 else 0.0
        return total - sum(p * at[n] / len(order) for n, p in pull.items())

    least = cost(best)
    for candidate in [_walked(beside, node) for node in nodes]:
        if (price := cost(candidate)) < least - 1e-9:
            best, least = candidate, price
    return best


def _walked(beside: Mapping[str, Sequence[str]], start: str) -> list[str]:
    """Return nodes as they are reached from one, depth first, shorter branches before longer ones."""
    far, reached = {start: 0}, [start]
    for node in reached:  # which grows
        for other in beside[node]:
            if other not in far:
                far[other] = far[node] + 1
                reached.append(other)
    reach: dict[str, int] = {}  # how far one gets from a node without turning back
    for node in reversed(reached):
        reach[node] = max([far[node], *(reach[n] for n in beside[node] if far[n] > far[node])])
    order: dict[str, None] = {}
    pending = [start]
    while pending:
        node = pending.pop()
        if node in order:
            continue
        order[node] = None
        # The one that is reached last leads farthest: it is put at the bottom of the pile. Of those that lead
        # as far the one that is written first stands on top.
        ahead = [n for n in reversed(beside[node]) if n not in order]
        pending += sorted(ahead, key=lambda n: -reach[n])
    return list(order | dict.fromkeys(beside))


def abbreviated(network: DrawnNetwork, domains: Mapping[str, str]) -> tuple[DrawnNetwork, tuple[str, ...]]:
    """Return a network with its long chains shortened, and the names of the elements that are left out."""
    order = order_of(network, domains)
    at = {n: i for i, n in enumerate(order)}
    marked = {m.node for m in network.marks} | {n for s in network.spans for n in s.nodes}
    touching: dict[str, list[DrawnPart]] = {n: [] for n in order}
    for part in network.parts:
        for node in part.nodes:
            touching[node].append(part)

    def look(node: str) -> list[str] | None:
        """Return the types of what stands at a node and before it, None if it is no link of a chain."""
        for part in touching[node]:
            is_far = any(abs(at[n] - at[node]) > 1 for n in part.nodes)
            if is_far or part.tags or part.points or part.kind != "element" or part.symbol.role == "source":
                return None
        types = [p.type_name for p in touching[node] if all(at[n] >= at[node] for n in p.nodes)]
        return None if node in marked else sorted(types)

    def bodies(node: str) -> list[str]:
        return [p.type_name for p in touching[node] if p.symbol.role == "body"]

    runs = [list(found) for seen, found in groupby(order, look) if seen is not None]
    groups = [list(found) for _, found in groupby(order, bodies)]
    hidden: set[str] = set()
    extra: list[DrawnPart] = []
    for run in (r for r in runs if len(r) > LONGEST):
        alike = next(group for group in groups if run[0] in group)
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
