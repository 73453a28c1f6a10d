"""How many zeros there are at most, from the blocks that the numerator's equations fall into.

    a shaft from a to b, a torque at a, the angle at b read: what is left without that angle and the balance
    of a are the two laws of the shaft, whose determinant is that of exp(A l), which vanishes nowhere

Rows and columns are matched; what depends on each other in a circle is a block, and the determinant is the
product of those of the blocks (Dulmage and Mendelsohn 1958). Blocks without waves are polynomials in s, whose
degree is at most the largest sum of degrees along a matching; a delay vanishes nowhere, nor does what takes
the state from one end of a member to the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, terms_of
from symflex.algebra.propagators import EXPONENTIAL

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from symflex.algebra import Factored
    from symflex.roots.networks.cramer import CramerEquations

NONE = -1e6
"""The degree of an entry that is zero: less than any sum of degrees."""


def most_zeros(cramer: CramerEquations) -> int | None:
    """Return how many zeros the numerator has at most; ``None`` where there may be infinitely many."""
    entries = cramer.entries
    matched = _matched(entries)
    if matched is None:
        return None
    total = 0
    for block in _blocks(entries, matched):
        degree = _degree_of_block(cramer, block, [matched[i] for i in block])
        if degree is None:
            return None
        total += degree
    return total


def _matched(entries: Sequence[Collection[int]]) -> list[int] | None:
    """Return a column for every row, no two the same (Kuhn 1955); ``None`` where there is no such choice."""
    columns = [-1] * len(entries)
    row_of: dict[int, int] = {}
    for start in range(len(entries)):
        came: dict[int, int] = {}  # from which row a column was reached
        pending = [start]
        while pending:
            i = pending.pop()
            came |= {j: i for j in entries[i] if j not in came}
            free = next((j for j in entries[i] if j not in row_of), None)
            if free is not None:
                break
            pending += [row_of[j] for j in entries[i] if came[j] == i and row_of[j] != i]
        else:
            return None
        while free >= 0:
            i = came[free]
            row_of[free] = i
            free, columns[i] = columns[i], free
    return columns


def _blocks(entries: Sequence[Collection[int]], matched: Sequence[int]) -> list[list[int]]:
    """Return the rows that need each other: a row needs the unknowns of its columns, which others give."""
    row_of = {j: i for i, j in enumerate(matched)}
    needs = [[row_of[j] for j in row] for row in entries]
    needed: list[list[int]] = [[] for _ in entries]
    for i, others in enumerate(needs):
        for k in others:
            needed[k].append(i)
    ended = [i for tree in _trees(needs, range(len(needs))) for i in tree]
    return list(_trees(needed, reversed(ended)))  # Kosaraju's (1978) algorithm


def _trees(graph: Sequence[Sequence[int]], starts: Iterable[int]) -> Iterator[list[int]]:
    """Yield what is reached from each start and was not before, in the order in which a search ends it."""
    seen: set[int] = set()
    for start in starts:
        ended: list[int] = []
        path = [] if start in seen else [(start, iter(graph[start]))]
        seen.add(start)
        while path:
            node, others = path[-1]
            following = next((k for k in others if k not in seen), None)
            if following is None:
                ended.append(node)
                path.pop()
            else:
                seen.add(following)
                path.append((following, iter(graph[following])))
        if ended:
            yield ended


def _degree_of_block(cramer: CramerEquations, rows: Sequence[int], columns: Sequence[int]) -> int | None:
    """Return how many roots the determinant of a block has at most."""
    if _is_of_member(cramer, rows, columns):
        return 0
    degrees = []
    for i in rows:
        row = cramer.entries[i]
        known = {j: _degree(cramer, row[j], is_alone=len(rows) == 1) for j in columns if j in row}
        if None in known.values():
            return None
        degrees.append([known.get(j) for j in columns])
    if len(rows) == 1:
        return degrees[0][0]
    from scipy.optimize import linear_sum_assignment  # takes 0.5 s, and most models have no such block

    weights = [[NONE if degree is None else degree for degree in row] for row in degrees]
    best = linear_sum_assignment(weights, maximize=True)
    return int(sum(weights[i][k] for i, k in zip(*best, strict=True)))


def _is_of_member(cramer: CramerEquations, rows: Sequence[int], columns: Sequence[int]) -> bool:
    """Tell whether a block are the laws of one member and the state at its start."""
    equations = cramer.equations
    places = {v: j for j, v in enumerate(equations.unknowns)}
    for continuum in equations.continua:
        if {places.get(v) for v in continuum.initial if v is not None} == set(columns):
            laws = [i for i, row in enumerate(equations.rows) if row.about.owner == continuum.name]
            return len(columns) == len(continuum.initial) and set(laws) == set(rows)
    return False


def _degree(cramer: CramerEquations, value: Factored, *, is_alone: bool) -> int | None:
    """Return the degree of an entry in s, or ``None`` of one that is no polynomial.

    Delays alone in a block are left out, as they vanish nowhere.
    """
    names = value.ring.names
    delays = {name for group in cramer.waves.values() for name, order in group if order == EXPONENTIAL}
    total = 0
    for factor, exponent in value.factors:
        terms = list(terms_of(factor))
        powers = []
        for monomial, _ in terms:
            degree = 0
            for i, power in monomial:
                if names[i] == LAPLACE:
                    degree += power
                elif names[i] in cramer.moving_names and not (
                    is_alone and len(terms) == 1 and names[i] in delays
                ):
                    return None
            powers.append(degree)
        if exponent < 0 and max(powers):
            return None
        total += exponent * max(powers)
    return total
