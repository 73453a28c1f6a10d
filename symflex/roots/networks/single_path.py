"""Zeros of a network whose input and output are joined by one path: eigenvalues of what stands beside it.

    torque -> J_0 ~ J_1 ~ J_2 -> angle      a load that a third shaft ties to J_1 swings against J_1 at rest:
                   ~ load                   that is the only zero

Of a symmetric matrix the minor between two unknowns is a sum over the paths between them: what couples the
unknowns along a path, times the determinant of the matrix without them. Where one path alone leads from one
to the other and its couplings vanish nowhere, zeros are where that determinant vanishes: where the network
without the path's members vibrates while the path rests. They are counted as eigenvalues are, wherever the
sensor is.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from flint import arb

from symflex.algebra import LAPLACE
from symflex.roots.networks.counting import Counter
from symflex.roots.networks.members import UndecidedError

if TYPE_CHECKING:
    from symflex.roots.networks.network import Network, NetworkMember

BEYOND_ALL = 2**300
"""Lambda [rad^2/s^2] beyond what masses and springs have: 1e45 rad/s."""
BITS = 128
"""Only signs are asked for there."""
Ways = list[dict[int, list["NetworkMember | None"]]]
"""Per unknown, what couples it to others: members, and ``None`` for an entry."""


def beside_path(network: Network) -> Network | None:
    """Return the network whose eigenvalues are the zeros; ``None`` where motion has more than one way."""
    if len(network.driven) != 1 or len(network.read) != 1:
        return None
    (start,), (end,) = network.driven, network.read
    ways = _ways(network)
    path = _path(ways, start, end)
    if path is None:
        return None
    along: set[int] = set()
    for a, b in pairwise(path):
        couplings = ways[a][b]
        if len(couplings) > 1 or _path(_without(ways, a, b), start, end) is not None:
            return None
        (member,) = couplings
        if not _couples_always(network, member, a, b):
            return None
        along.add(id(member))
    labels = {i: k for k, i in enumerate(i for i in range(network.size) if i not in path)}
    entries = {
        (labels[i], labels[j]): value
        for (i, j), value in network.entries.items()
        if i in labels and j in labels
    }
    members = tuple(
        replace(m, ends=tuple(None if i is None else labels.get(i) for i in m.ends))
        for m in network.members
        if id(m) not in along
    )
    moved = {i for pair, value in entries.items() if value.depends_on(LAPLACE) for i in pair}
    beside = replace(network, size=len(labels), entries=entries, members=members, driven={}, read={})
    return beside if members or _has_all(beside, len(moved)) else None


def _has_all(network: Network, most: int) -> bool:
    """Tell whether all eigenvalues of a network without members are in reach: there are so many at most."""
    counter = Counter(network, ())
    try:
        below, above = (counter.sample(arb(x), BITS).below for x in (-BEYOND_ALL, BEYOND_ALL))
    except UndecidedError:
        return False
    return above - below == most


def _ways(network: Network) -> Ways:
    ways: Ways = [{} for _ in range(network.size)]
    for i, j in network.entries:
        if i != j:
            ways[i].setdefault(j, []).append(None)
            ways[j].setdefault(i, []).append(None)
    for member in network.members:
        ends = [i for i in member.ends if i is not None]
        for i in ends:
            for j in ends:
                if i != j:
                    ways[i].setdefault(j, []).append(member)
    return ways


def _without(ways: Ways, a: int, b: int) -> Ways:
    """Return the ways but for those between two unknowns."""
    return [
        {j: c for j, c in row.items() if {i, j} != {a, b}} if i in (a, b) else row
        for i, row in enumerate(ways)
    ]


def _path(ways: Ways, start: int, end: int) -> list[int] | None:
    """Return a shortest path."""
    before: dict[int, int] = {start: start}
    pending = [start]
    for i in pending:
        for j in ways[i]:
            if j not in before:
                before[j] = i
                pending.append(j)
    if end not in before:
        return None
    path = [end]
    while path[-1] != start:
        path.append(before[path[-1]])
    return path[::-1]


def _couples_always(network: Network, member: NetworkMember | None, a: int, b: int) -> bool:
    """Tell whether what couples two unknowns vanishes nowhere but with a member's own frequencies."""
    if member is None:
        return not network.entries[min(a, b), max(a, b)].depends_on(LAPLACE)
    compliance = member.system[0][len(member.system) // 2]
    return len(member.ends) == 2 and not compliance.is_zero and not compliance.depends_on(LAPLACE)  # noqa: PLR2004
