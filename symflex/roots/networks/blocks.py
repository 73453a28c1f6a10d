"""How many zeros there are at most, from the blocks that the numerator's equations fall into.

    a shaft from a to b, a torque at a, the angle at b read: what is left without that angle and the balance
    of a are the two laws of the shaft, whose determinant is that of exp(A l), which vanishes nowhere

Rows and columns are matched; what depends on each other in a circle is a block, and the determinant is the
product of those of the blocks (Dulmage and Mendelsohn 1958). Blocks without waves are polynomials in s, whose
degree is at most the largest sum of degrees along a matching; a delay vanishes nowhere, nor does what takes
the state from one end of a member to the other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from symflex.algebra import LAPLACE, Factored, terms_of
from symflex.algebra.propagators import EXPONENTIAL

if TYPE_CHECKING:
    from symflex.roots.networks.cramer import CramerEquations

NONE = -1e6  # the degree of an entry that is zero: less than any sum of degrees


def most_zeros(cramer: CramerEquations) -> int | None:
    """Return how many zeros the numerator has at most; ``None`` where there may be infinitely many."""
    blocks = blocks_of(cramer.entries)
    degrees = [None] if blocks is None else [_degree_of_block(cramer, *block) for block in blocks]
    return None if None in degrees else sum(degree or 0 for degree in degrees)


def blocks_of(entries: Sequence[Mapping[int, object]]) -> list[tuple[list[int], list[int]]] | None:
    """Return rows and columns of each block of a square matrix; ``None`` where its determinant is zero.

    >>> blocks_of([{0: "k", 1: "b"}, {1: "m"}])
    [([1], [1]), ([0], [0])]
    >>> blocks_of([])
    []
    """
    from scipy.sparse import csr_array  # takes 0.2 s, and only functions of networks need it
    from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

    places = [(i, j) for i, row in enumerate(entries) for j in row]
    indices = np.array(places, np.int32).reshape(-1, 2).T  # scipy 1.14 matches no others
    pattern = csr_array((np.ones(len(places)), tuple(indices)), shape=(len(entries), len(entries)))
    matched = maximum_bipartite_matching(pattern, perm_type="column")
    if (matched < 0).any():
        return None
    # Row i needs the unknowns of its columns, which the rows matched to them give.
    count, block_of = connected_components(pattern[:, matched], directed=True, connection="strong")
    rows = [np.flatnonzero(block_of == block).tolist() for block in range(count)]
    return [(own, [int(matched[i]) for i in own]) for own in rows]


def _degree_of_block(cramer: CramerEquations, rows: Sequence[int], columns: Sequence[int]) -> int | None:
    """Return how many roots the determinant of a block has at most."""
    if _is_of_member(cramer, rows, columns):
        return 0
    if len(rows) == 1:
        return _degree(cramer, cramer.entries[rows[0]][columns[0]], is_alone=True)
    from scipy.optimize import linear_sum_assignment  # takes as long again, and few networks need it

    degrees = np.full((len(rows), len(columns)), NONE)
    for (k, i), (m, j) in product(enumerate(rows), enumerate(columns)):
        if j in cramer.entries[i]:
            degree = _degree(cramer, cramer.entries[i][j], is_alone=False)
            if degree is None:
                return None
            degrees[k, m] = degree
    return int(degrees[linear_sum_assignment(degrees, maximize=True)].sum())


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
    """Return the degree of an entry in s, but for delays alone; ``None`` of one that is no polynomial."""
    names = value.ring.names
    delays = {n for n, waves in cramer.numeric.waves_of.items() if waves.orders[n] == EXPONENTIAL}
    total = 0
    for factor, exponent in value.factors:
        terms = [{names[i]: power for i, power in monomial} for monomial, _ in terms_of(factor)]
        left_out = {LAPLACE, *delays} if is_alone and len(terms) == 1 else {LAPLACE}
        degree = max(term.get(LAPLACE, 0) for term in terms)
        waves = cramer.numeric.moving(LAPLACE) - left_out
        if any(name in waves for term in terms for name in term) or (exponent < 0 and degree):
            return None
        total += exponent * degree
    return total
