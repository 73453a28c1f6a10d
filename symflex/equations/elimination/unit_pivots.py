"""Elimination of unknowns whose pivot is plus or minus one, which keeps rows polynomial."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symflex.equations.elimination.closing import SparseRow


@dataclass(frozen=True)
class Reduced:
    """What remains: square rows over ``columns`` (unknowns), borders over the inputs, and the outputs.

    ``kept`` are the positions of the remaining rows in the original system.
    """

    rows: tuple[SparseRow, ...]
    outputs: tuple[SparseRow, ...]
    columns: tuple[int, ...]
    kept: tuple[int, ...]


def eliminate_unit_pivots(
    rows: tuple[SparseRow, ...], outputs: tuple[SparseRow, ...], unknowns: int
) -> Reduced:
    """Eliminate unknowns by unit pivots, the cheapest first (Markowitz 1957).

    Parameters
    ----------
    rows, outputs : tuple of dict
        Sparse rows; columns below ``unknowns`` are unknowns, the others inputs.
    unknowns : int
        Number of unknowns.

    Returns
    -------
    Reduced
        The quotient of bordered determinant and determinant is that of the full system.
    """
    live: dict[int, SparseRow] = {i: dict(r) for i, r in enumerate(rows)}
    goals = [dict(r) for r in outputs]
    columns = set(range(unknowns))
    users: dict[int, set[int]] = {c: set() for c in columns}
    for i, row in live.items():
        for c in row:
            if c in columns:
                users[c].add(i)
    while (pivot := _cheapest(live, users, columns)) is not None:
        r, c = pivot
        pivot_row = live.pop(r)
        for other in pivot_row:
            if other in columns:
                users[other].discard(r)
        sign = int(pivot_row[c].leading_coefficient())
        for i in sorted(users[c]):
            _subtract(live[i], pivot_row, c, sign)
            for other in pivot_row:
                if other in columns:
                    (users[other].add if other in live[i] else users[other].discard)(i)
        for goal in goals:
            if c in goal:
                _subtract(goal, pivot_row, c, sign)
        columns.discard(c)
        del users[c]
    kept = tuple(sorted(live))
    return Reduced(tuple(live[i] for i in kept), tuple(goals), tuple(sorted(columns)), kept)


def _cheapest(
    live: dict[int, SparseRow], users: dict[int, set[int]], columns: set[int]
) -> tuple[int, int] | None:
    """Return the unit pivot with the smallest fill-in bound; ties go to the first row and column."""
    best: tuple[int, int, int] | None = None
    for r in sorted(live):
        row = live[r]
        inside = sum(1 for c in row if c in columns)
        for c, entry in row.items():
            if c not in columns or not entry.is_constant() or abs(int(entry.leading_coefficient())) != 1:
                continue
            cost = (inside - 1) * (len(users[c]) - 1)
            if best is None or (cost, r, c) < best:
                best = (cost, r, c)
        if best is not None and best[0] == 0:
            break
    return None if best is None else best[1:]


def _subtract(row: SparseRow, pivot_row: SparseRow, column: int, sign: int) -> None:
    """Clear ``column`` of ``row`` in place."""
    factor = row[column] * sign
    for c, entry in pivot_row.items():
        value = row[c] - factor * entry if c in row else -factor * entry
        if value.is_zero():
            row.pop(c, None)
        else:
            row[c] = value
