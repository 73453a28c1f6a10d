"""In which order the nodes of a network stand from left to right.

Input: the pairs of nodes that parts join, where the network begins. Output: the nodes in order, such that
joined ones stand near each other: a chain from its actuator, or from the ground, to its tip.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

BRIDGE: Final = 0.5
"""What it costs that a part joins no neighbours, besides what it spans."""
MEMBER: Final = 3.0
"""How much more that is of a member, which is long and looks stiff at corners."""
MOST_MOVES: Final = 40
"""Rounds of moving single nodes; small networks need three or four."""
LARGEST: Final = 40
"""Nodes of a network whose order is improved; longer ones are chains."""
LANES: Final = {"electrical": 0, "acoustic": 0, "rotation": 1, "translation": 2, "planar": 2, "plane": 2}
"""Which domain stands to the left of which, where a part joins both."""


def ordered(
    nodes: Sequence[str],
    joints: Sequence[tuple[str, str]],
    pull: Mapping[str, float],
    lanes: Mapping[str, str],
    directed: Collection[tuple[str, str]] = (),
) -> tuple[str, ...]:
    """Return the nodes from left to right.

    ``joints`` are pairs that parts join; ``pull`` draws a node to the left (negative) or to the right;
    ``lanes`` are the nodes' domains; ``directed`` joints run from left to right where they can.
    """
    if len(nodes) < 2:  # noqa: PLR2004
        return tuple(nodes)
    start = min(nodes, key=lambda n: (LANES[lanes[n]], pull.get(n, 0.0), _degree(n, joints), nodes.index(n)))
    found = _walked(nodes, joints, start)
    if len(nodes) > LARGEST:
        return tuple(found)

    members = {*directed}

    def cost(order: Sequence[str]) -> float:
        at = {n: i for i, n in enumerate(order)}
        total = 0.0
        for a, b in joints:
            apart = at[b] - at[a]
            bridged = abs(apart) - 1 + BRIDGE if abs(apart) > 1 else 0.0
            total += bridged * (MEMBER if {(a, b), (b, a)} & members else 1.0)
            total += 0.3 if apart < 0 and (a, b) in directed else 0.0
            if LANES[lanes[a]] != LANES[lanes[b]] and (LANES[lanes[a]] - LANES[lanes[b]]) * apart > 0:
                total += 0.6
        return total - sum(p * at[n] / len(order) for n, p in pull.items() if n in at)

    best, least = found, cost(found)
    for start in nodes:
        candidate = _walked(nodes, joints, start)
        if (price := cost(candidate)) < least - 1e-9:
            best, least = candidate, price
    for _ in range(MOST_MOVES):
        improved = False
        for node in nodes:
            rest = [n for n in best if n != node]
            for i in range(len(best)):
                candidate = [*rest[:i], node, *rest[i:]]
                if (price := cost(candidate)) < least - 1e-9:
                    best, least, improved = candidate, price, True
        if not improved:
            break
    return tuple(best)


def _degree(node: str, joints: Sequence[tuple[str, str]]) -> int:
    return len({n for pair in joints if node in pair for n in pair} - {node})


def _walked(nodes: Sequence[str], joints: Sequence[tuple[str, str]], start: str) -> list[str]:
    """Return nodes as they are reached from one, depth first, shorter branches before longer ones."""
    beside: dict[str, list[str]] = {n: [] for n in nodes}
    for a, b in joints:
        if b not in beside[a]:
            beside[a].append(b)
            beside[b].append(a)
    far = _distances(beside, start)
    found: list[str] = []
    seen: set[str] = set()
    pending = [start]
    while pending:
        node = pending.pop()
        if node in seen:
            continue
        seen.add(node)
        found.append(node)
        # The one that is reached last leads farthest: it is put at the bottom of the pile. Of those that lead
        # as far the one that is written first stands on top.
        ahead = [n for n in reversed(beside[node]) if n not in seen]
        pending += sorted(ahead, key=lambda n: -_reach(beside, n, far))
    return [*found, *(n for n in nodes if n not in seen)]


def _distances(beside: Mapping[str, Sequence[str]], start: str) -> dict[str, int]:
    found = {start: 0}
    pending = deque([start])
    while pending:
        node = pending.popleft()
        for other in beside[node]:
            if other not in found:
                found[other] = found[node] + 1
                pending.append(other)
    return found


def _reach(beside: Mapping[str, Sequence[str]], node: str, far: Mapping[str, int]) -> int:
    """Return how far one gets from a node without turning back."""
    best, pending, seen = far[node], [node], {node}
    while pending:
        one = pending.pop()
        best = max(best, far[one])
        for other in beside[one]:
            if far[other] > far[one] and other not in seen:
                seen.add(other)
                pending.append(other)
    return best
