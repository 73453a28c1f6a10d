"""Field equations as a first-order system in x, and the way there from equations of any order.

    EI w'''' + rho A s^2 w = 0   ->   z' = M z,  z = (w, w', w'', w''')

Input: for every equation, the coefficient of every derivative of every unknown, and of every load.
Output: a :class:`FieldSystem` whose states are the unknowns and their derivatives below the highest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.algebra import Factored


Matrix = tuple[tuple["Factored", ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class FieldSystem:
    """``dz/dx = matrix(s) z + load(s) u``, Laplace-transformed in time."""

    # Names of z. A theory lists its across quantities first and its through quantities after them.
    states: tuple[str, ...]
    matrix: Matrix  # constant in x, rational in s and the parameters
    loads: Matrix = ()  # one column per input that acts all along the field, uniform in x


class FieldTheory(Protocol):
    """A theory: the first-order system of a uniform element.

    A new theory is one function and one line in :data:`symflex.library.fields.FIELDS`.
    """

    def __call__(self, s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
        """Return the field equations for the element's values."""
        ...


def system_of(
    states: tuple[str, ...], entries: Mapping[tuple[str, str], Factored], zero: Factored
) -> FieldSystem:
    """Return a system from its entries that are not zero, named by (derivative, state)."""
    matrix = tuple(tuple(entries.get((row, column), zero) for column in states) for row in states)
    return FieldSystem(states, matrix)


@dataclass(frozen=True, slots=True, eq=False)
class FieldEquation:
    """``sum(terms[u, k] * d^k u/dx^k) + sum(loads[i] * input_i) = 0``."""

    terms: Mapping[tuple[str, int], Factored]
    loads: Mapping[str, Factored]


def first_order(
    unknowns: Sequence[str], inputs: Sequence[str], equations: Sequence[FieldEquation], zero: Factored
) -> FieldSystem | None:
    """Return the equations as a first-order system, ``None`` when the highest derivatives are not determined.

    The state called ``(u, k)`` is named ``u`` followed by k primes.
    """
    orders = {u: max((k for e in equations for v, k in e.terms if v == u), default=0) for u in unknowns}
    highest = [[e.terms.get((u, orders[u]), zero) for u in unknowns] for e in equations]
    states = [(u, k) for u in unknowns for k in range(orders[u])]
    right = [
        [-e.terms.get(state, zero) for state in states] + [-e.loads.get(i, zero) for i in inputs]
        for e in equations
    ]
    solved = _solve(highest, right)
    if solved is None:
        return None
    position = {state: i for i, state in enumerate(states)}
    one = zero + 1
    matrix: list[tuple[Factored, ...]] = []
    loads: list[tuple[Factored, ...]] = []
    for u, k in states:
        if k + 1 < orders[u]:
            following = position[u, k + 1]
            matrix.append(tuple(one if j == following else zero for j in range(len(states))))
            loads.append(tuple(zero for _ in inputs))
        else:
            row = solved[list(unknowns).index(u)]
            matrix.append(tuple(row[: len(states)]))
            loads.append(tuple(row[len(states) :]))
    columns: Matrix = tuple(tuple(loads[i][j] for i in range(len(states))) for j in range(len(inputs)))
    return FieldSystem(tuple(u + "'" * k for u, k in states), tuple(matrix), columns)


def _solve(matrix: list[list[Factored]], right: list[list[Factored]]) -> list[list[Factored]] | None:
    """Return ``matrix^-1 right`` by Gauss-Jordan elimination, ``None`` when the matrix is singular."""
    rows = [[*a, *b] for a, b in zip(matrix, right, strict=True)]
    n = len(matrix)
    for column in range(n):
        pivot = next((r for r in range(column, n) if not rows[r][column].is_zero), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        scale = rows[column][column]
        rows[column] = [x / scale for x in rows[column]]
        for r in range(n):
            factor = rows[r][column]
            if r != column and not factor.is_zero:
                rows[r] = [
                    x if y.is_zero else x - factor * y for x, y in zip(rows[r], rows[column], strict=True)
                ]
    return [row[n:] for row in rows]
