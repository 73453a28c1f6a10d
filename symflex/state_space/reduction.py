"""State equations without what no input reaches or no output shows.

Input: a :class:`StateSpace`. Output: a minimal one with the same transfer functions, proved so (Kalman 1963,
SIAM J. Control 1, 152).

What inputs reach is a subspace in which some states determine the others: these stay, under their names. What
outputs show are combinations of states: the simplest ones that do become the new states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import nmod_mat

from symflex.algebra import Factored, Ring, residue
from symflex.algebra.radicals import Point
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.state_space.popov import FieldElement, Vector, applied, combined, transposed
from symflex.state_space.realise import Combination, State, StateSpace

SIZE_LIMIT = 5_000  # terms that a basis may hold on the way

LARGEST = 1000  # largest numerators and denominators looked for before anything is solved with symbols

Basis = dict[int, Vector]  # vectors in reduced echelon form, by pivot
FEW = 2  # terms of a combination that is named after them


def minimal(system: StateSpace) -> StateSpace:
    """Return the controllable and observable part, which is minimal for almost all values of parameters."""
    used = system.ring.used_in(
        p for _, rows, _ in system.matrices for r in rows for v in r.values() for p in (v.num, v.den)
    )
    free = [system.ring.names[i] for i in sorted(system.radicals.free) if system.ring.names[i] in used]
    if free:
        message = f"it is not known how {free[0]} depends on parameters and other roots"
        hint = "keep all states, or give parameters under roots a sign and write nested roots out"
        raise UncertifiedError(Diagnostic("SF401", message, None, hint))
    columns = transposed(system.a, system.order)
    reached = _closed(transposed(system.b, len(system.inputs)), columns, system)
    if len(reached) < system.order:
        system = _controllable(system, reached)
    shown = _closed(system.c, system.a, system)
    if len(shown) < system.order:
        system = _observable(system, shown)
    return replace(system, is_minimal=True)


def _controllable(system: StateSpace, basis: Basis) -> StateSpace:
    """Return the part that inputs reach; its states are some of the system's."""
    columns = transposed(system.a, system.order)
    kept = sorted(basis)
    place = {k: i for i, k in enumerate(kept)}
    # Column i of A on the subspace: where A takes basis vector i, read off at the states that are kept.
    moved = [applied(basis[k], columns) for k in kept]
    a = transposed([{place[j]: v for j, v in vector.items() if j in place} for vector in moved], len(kept))
    # Column i of C: what outputs show of basis vector i.
    shown = transposed(system.c, system.order)
    c = transposed([applied(basis[k], shown) for k in kept], len(system.c))
    states = tuple(system.states[k] for k in kept)
    b = tuple(system.b[k] for k in kept)
    return replace(system, states=states, a=tuple(a), b=b, c=tuple(c))


def _observable(system: StateSpace, basis: Basis) -> StateSpace:
    """Return the part that outputs show; its states are combinations of the system's."""
    kept = sorted(basis)
    place = {k: i for i, k in enumerate(kept)}
    moved = [applied(basis[k], system.a) for k in kept]
    a = tuple({place[j]: v for j, v in vector.items() if j in place} for vector in moved)
    c = tuple({place[j]: v for j, v in row.items() if j in place} for row in system.c)
    b = tuple(applied(basis[k], system.b) for k in kept)
    taken: set[str] = set()
    states = tuple(_state(basis[k], k, i, system.states, taken) for i, k in enumerate(kept))
    return replace(system, states=states, a=a, b=b, c=c)


def _closed(start: Sequence[Vector], rows: Sequence[Vector], system: StateSpace) -> Basis:
    """Return the least space that contains the given vectors and that a matrix maps into itself."""
    at_points = (_at_random_point(start, rows, system, seed) for seed in (0, 1))
    points = [point for point in at_points if point is not None]
    dimension = max((len(space) for _, space in points), default=0)
    one = FieldElement.number(system.ring, 1)
    if dimension == system.order:
        # With numbers in place of parameters a dimension can only be lost, so this is a proof.
        return {j: {j: one} for j in range(system.order)}
    guess = _constants(points, system.ring)
    if guess is not None and not any(_rest(v, guess) for v in start):
        moved = (applied(vector, rows) for vector in guess.values())
        if not any(_rest(vector, guess) for vector in moved):
            return guess
    return _generated(start, rows, system)


def _constants(points: Sequence[tuple[int, Mapping[int, Mapping[int, int]]]], ring: Ring) -> Basis | None:
    """Return a basis of small numbers that is the same at all random points, ``None`` when there is none."""
    reconstructed = [
        {k: {j: _reconstructed(x, prime) for j, x in entries.items()} for k, entries in space.items()}
        for prime, space in points
    ]
    if not reconstructed or any(other != reconstructed[0] for other in reconstructed[1:]):
        return None
    basis: Basis = {}
    for pivot, row in reconstructed[0].items():
        basis[pivot] = {}
        for j, fraction in row.items():
            if fraction is None:
                return None
            basis[pivot][j] = FieldElement(ring.constant(fraction[0]), ring.constant(fraction[1]))
    return basis


def _reconstructed(value: int, prime: int) -> tuple[int, int] | None:
    """Return the small fraction that a residue is (Wang 1981), ``None`` when it is not one."""
    (above, below), (left, right) = (prime, value), (0, 1)
    while below > LARGEST:
        quotient = above // below
        above, below = below, above - quotient * below
        left, right = right, left - quotient * right
    if not 0 < abs(right) <= LARGEST:
        return None
    return (below, right) if right > 0 else (-below, -right)


def _generated(start: Sequence[Vector], rows: Sequence[Vector], system: StateSpace) -> Basis:
    """Return the least such space as products of the vectors with powers of the matrix.

    What is multiplied next is what a vector adds to those before, so that entries stay small.
    """
    basis: Basis = {}
    waiting = list(reversed(start))
    while waiting:
        spend()
        vector = _rest(waiting.pop(), basis)
        if not vector:
            continue
        pivot = min(vector)
        lead = vector[pivot]
        vector = {j: value / lead for j, value in vector.items()}
        for p, known in basis.items():
            if pivot in known:
                basis[p] = combined(known, vector, -known[pivot])
        basis[pivot] = vector
        if sum(v.size for known in basis.values() for v in known.values()) > SIZE_LIMIT:
            message = f"the states of a minimal form are combinations of more than {SIZE_LIMIT} terms"
            hint = "give the parameters numbers first, with bind(); or keep all states"
            raise BudgetError(Diagnostic("SF502", message, None, hint))
        waiting.insert(0, applied(vector, rows))
    return basis


def _rest(vector: Vector, basis: Basis) -> Vector:
    """Return a vector without its part in the space."""
    for pivot, known in basis.items():
        if pivot in vector:
            vector = combined(vector, known, -vector[pivot])
    return vector


def _state(vector: Vector, pivot: int, number: int, states: Sequence[State], taken: set[str]) -> State:
    """Return a combination of states as one."""
    parts = sorted(vector.items(), key=lambda item: (item[0] != pivot, item[0]))
    terms: Combination = tuple(
        (quantity, factor * value) for j, value in parts for quantity, factor in states[j].terms
    )
    first = states[pivot]
    name = first.name
    if len(parts) > 1:
        is_difference = len(parts) == FEW and (-parts[1][1]).is_one
        name = f"{name}_minus_{states[parts[1][0]].name}" if is_difference else f"z_{number + 1}"
    while name in taken:
        name += "_"
    taken.add(name)
    return State(name, terms, first.unit)


def _at_random_point(
    start: Sequence[Vector], rows: Sequence[Vector], system: StateSpace, seed: int
) -> tuple[int, dict[int, dict[int, int]]] | None:
    """Return a prime and the least such space modulo it, by pivot; ``None`` where roots have no values."""
    n = system.order
    point = system.radicals.point(seed)
    if point is None:
        return None
    step = _residues(rows, n, point, system)
    basis = _independent(_residues(start, n, point, system))
    length = 1
    while basis.nrows() and length < n:
        entries = [*basis.entries(), *(basis * step).entries()]
        basis = _independent(nmod_mat(2 * basis.nrows(), n, entries, point[0]))
        step, length = step * step, 2 * length
    table = [[int(x) for x in row] for row in basis.tolist()]
    vectors = [{j: x for j, x in enumerate(row) if x} for row in table]
    return point[0], {min(vector): vector for vector in vectors}


def _residues(rows: Sequence[Vector], columns: int, point: Point, system: StateSpace) -> nmod_mat:
    prime, values = point
    matrix = nmod_mat(len(rows), columns, prime)
    for i, row in enumerate(rows):
        for j, value in row.items():
            quotient = Factored(system.ring, Fraction(1), ((value.num, 1), (value.den, -1)))
            matrix[i, j] = residue(quotient, values, prime)
    return matrix


def _independent(matrix: nmod_mat) -> nmod_mat:
    reduced, rank = matrix.rref()
    return nmod_mat(rank, matrix.ncols(), reduced.entries()[: rank * matrix.ncols()], matrix.modulus())
