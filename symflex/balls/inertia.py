"""Pivots of sparse symmetric matrices in balls: how many are negative.

    [ 2  1  0 ]    pivots 2, 5/2, and -2/5 from the last row: the matrix has one negative eigenvalue, as many
    [ 1  3  1 ]    as there are negative pivots (Sylvester 1852)
    [ 0  1  0 ]

The unknown that meets the fewest others goes first. A constraint, 0 on the diagonal, waits until one of the
unknowns it ties is gone, or goes together with one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import arb

from symflex.balls.precision import UndecidedError

Rows = list[dict[int, "arb"]]  # a symmetric matrix, every entry off the diagonal in both of its rows


def _is_usable(value: arb | None) -> bool:
    """Tell whether the sign is decided."""
    return value is not None and (bool(value > 0) or bool(value < 0))


@dataclass(frozen=True, slots=True)
class Pivots:
    """What is left of a matrix when all unknowns but the borders are gone."""

    negative: int  # how many pivots are
    determinant: arb | None  # their product; None if there is none
    borders: tuple[arb | None, ...]  # what became of the borders' diagonals


def elimination_order(size: int, pairs: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """Return the unknowns in the order in which they are eliminated, fewest neighbours first.

    ``pairs`` are the places of entries, (i, i) of those on the diagonal.

    >>> elimination_order(3, [(0, 0), (0, 1), (1, 1), (1, 2)])
    (0, 1, 2)
    """
    beside: list[set[int]] = [set() for _ in range(size)]
    firm = set()
    for i, j in pairs:
        if i == j:
            firm.add(i)
        else:
            beside[i].add(j)
            beside[j].add(i)
    left, order = dict.fromkeys(range(size)), []
    while left:
        i = min(left, key=lambda i: len(beside[i]) + (0 if i in firm else size))
        del left[i]
        order.append(i)
        for j in beside[i]:
            beside[j] = (beside[j] | beside[i]) - {i, j}
        firm |= beside[i]
    return tuple(order)


def pivots(rows: Rows, order: Sequence[int], borders: Sequence[int] = ()) -> Pivots:
    """Eliminate the unknowns in about this order, using up ``rows``; UndecidedError at an eigenvalue."""
    negative = 0
    determinant: arb | None = None
    waiting: list[int] = []
    pending = list(reversed(order))
    while pending or waiting:
        if not pending:
            pair = _pair(rows, waiting)
            if pair is None:
                raise UndecidedError
            i, j, block = pair
            waiting.remove(i)
            waiting.remove(j)
            negative += _negative_of_pair(block, rows[i].get(i), rows[j].get(j))
            determinant = block if determinant is None else determinant * block
            _eliminate_pair(rows, i, j, block)
            pending, waiting = waiting, []
            continue
        i = pending.pop()
        row = rows[i]
        pivot = row.get(i)
        if pivot is None or not _is_usable(pivot):
            waiting.append(i)
            continue
        negative += bool(pivot < 0)
        determinant = pivot if determinant is None else determinant * pivot
        del row[i]
        for j in row:
            del rows[j][i]
        items = list(row.items())
        for place, (j, x) in enumerate(items):
            factor = x / pivot
            target = rows[j]
            entry = target.get(j)
            target[j] = -(factor * x) if entry is None else entry - factor * x
            for k, y in items[place + 1 :]:
                entry = target.get(k)
                target[k] = rows[k][j] = -(factor * y) if entry is None else entry - factor * y
        if waiting:
            # What waited may have become usable.
            pending += reversed(waiting)
            waiting = []
    return Pivots(negative, determinant, tuple(rows[i].get(i) for i in borders))


def _negative_of_pair(determinant: arb, *diagonal: arb | None) -> int:
    """Return how many eigenvalues of two rows and columns are negative; UndecidedError if undecided."""
    if determinant < 0:
        return 1
    corner = next((x for x in diagonal if x is not None and _is_usable(x)), None)
    if corner is None:
        raise UndecidedError
    return 2 * bool(corner < 0)


def _pair(rows: Rows, waiting: Sequence[int]) -> tuple[int, int, arb] | None:
    """Return two unknowns that go together, with their determinant."""
    among = set(waiting)
    for i in waiting:
        for j, c in rows[i].items():
            if j == i or j not in among:
                continue
            a, b = rows[i].get(i), rows[j].get(j)
            block = -(c * c) if a is None or b is None else a * b - c * c
            if _is_usable(block):
                return i, j, block
    return None


def _eliminate_pair(rows: Rows, i: int, j: int, block: arb) -> None:
    """Eliminate two unknowns at once; ``block`` is the determinant of their rows and columns."""
    first, second = rows[i], rows[j]
    a, c, b = first.pop(i, None), first.pop(j), second.pop(j, None)
    del second[i]
    rows[i], rows[j] = {}, {}
    around = list({**first, **second})
    for k in around:
        rows[k].pop(i, None)
        rows[k].pop(j, None)
    for place, k in enumerate(around):
        # The inverse of [[a, c], [c, b]] times what meets k.
        x, y = first.get(k), second.get(k)
        top = _sum(_times(b, x), _times(-c, y))
        low = _sum(_times(-c, x), _times(a, y))
        for m in around[place:]:
            change = _sum(_times(first.get(m), top), _times(second.get(m), low))
            if change is not None:
                entry = rows[k].get(m)
                rows[k][m] = rows[m][k] = -change / block if entry is None else entry - change / block


def _times(a: arb | None, b: arb | None) -> arb | None:
    return None if a is None or b is None else a * b


def _sum(a: arb | None, b: arb | None) -> arb | None:
    return b if a is None else a if b is None else a + b
