"""Elimination in balls of sparse matrices, which may have further rows and columns as borders.

Input: rows as dictionaries of their entries by column, and how many rows and columns are eliminated.
Output: :class:`Eliminated`, the determinant of these rows and columns and what is left of the others.

Example: with A = [[2, 1], [1, 3]], b = (0, 1) and c = (1, 0), det A = 5, and A x + b = 0 has c x = 1/5.

    [ 2  1  0 ]
    [ 1  3  1 ]    what is left in the corner: 0 - c A^-1 b = 1/5
    [ 1  0  0 ]

Pivots meet few other entries (Markowitz 1957), so that networks stay sparse, and are large in their columns
after rows have been brought to one size, so that balls stay narrow.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from flint import acb

from symflex.balls.precision import UndecidedError
from symflex.balls.values import balancing, binary_exponent

THRESHOLD = -4  # log2 of what a pivot must have of its column's largest entry
CANDIDATES = 4  # columns with fewest entries that are looked at for a pivot
PASSES = 4  # passes of balancing; units make rows differ by far more than any further pass would change
ZERO, ONE = acb(0), acb(1)


@dataclass(frozen=True, slots=True)
class Eliminated:
    """What elimination leaves: rows of pivots as they were in their turn, borders without A's columns."""

    order: Sequence[tuple[int, int]]  # rows and columns of pivots
    determinant: acb
    rows: Sequence[Mapping[int, acb]]

    def unknowns(self, column: int) -> list[acb]:
        """Return x where A x + b = 0, with b in a column of the border. UndecidedError: A may be singular."""
        size = len(self.order)
        values = [ZERO] * size
        for i, j in reversed(self.order):
            row = self.rows[i]
            total = row.get(column, ZERO)
            for k, x in row.items():
                if k < size and k != j:
                    total = total + x * values[k]
            pivot = row.get(j, ZERO)
            if pivot.contains(0):
                raise UndecidedError
            values[j] = -total / pivot
        return values


def eliminate(
    rows: list[dict[int, acb]], size: int, order: Sequence[tuple[int, int]] | None = None
) -> Eliminated:
    """Eliminate so many columns by as many rows, which are used up; by pivots in this order if it is given.

    Raises UndecidedError if no pivot is proved to differ from 0. Without borders, the last one may vanish.

    >>> found = eliminate([{0: acb(2), 1: acb(1)}, {0: acb(1), 1: acb(3), 2: acb(1)}, {0: acb(1)}], 2)
    >>> complex(found.determinant), found.unknowns(2)[0].real, found.rows[2][2].real
    ((5+0j), [0.200000000000000 +/- 4.45e-17], [0.200000000000000 +/- 4.45e-17])
    """
    columns = columns_of(rows)
    scale: Sequence[int] = ()
    if order is None:
        sizes = [{j: _size(x) for j, x in row.items() if j < size} for row in rows[:size]]
        scale, _ = balancing(sizes, size, PASSES)
    left, chosen, determinant = set(range(size)), list[tuple[int, int]](), ONE
    waiting = [(len(columns[j]), j) for j in range(size)]
    heapify(waiting)
    for number in range(size):
        if order is not None:
            i, j = order[number]
        else:
            few = _fewest(waiting, columns, left)
            i, j = _next_pivot(rows, columns, few, left, scale, chosen)
        pivot = rows[i].get(j, ZERO)
        if pivot.contains(0) and not number + 1 == size == len(rows):
            raise UndecidedError
        chosen.append((i, j))
        left.discard(j)
        determinant = determinant * pivot
        _take_out(rows, columns, i, j)
        if order is None:
            for k in left.intersection(rows[i]):
                heappush(waiting, (len(columns[k]), k))
    return Eliminated(chosen, determinant * sign_of(chosen), rows)


def _fewest(
    waiting: list[tuple[int, int]], columns: Sequence[set[int]], left: Collection[int]
) -> Collection[int]:
    """Return the columns left that have fewest entries; others in the heap have had other numbers of them."""
    few: dict[int, int] = {}
    while waiting and len(few) < CANDIDATES:
        entries, j = heappop(waiting)
        if j in left and entries == len(columns[j]):
            few[j] = entries
    for j, entries in few.items():
        heappush(waiting, (entries, j))
    return few


def _next_pivot(
    rows: Sequence[Mapping[int, acb]],
    columns: Sequence[set[int]],
    few: Collection[int],
    left: Collection[int],
    scale: Sequence[int],
    chosen: Sequence[tuple[int, int]],
) -> tuple[int, int]:
    """Return row and column of the next pivot, in few columns; where one is left alone, it may vanish."""
    best: tuple[int, int, int, int] | None = None
    for j in few:
        inside = [i for i in columns[j] if i < len(scale)]
        sizes = {i: _size(rows[i][j]) + scale[i] for i in inside if not rows[i][j].contains(0)}
        largest = max(sizes.values(), default=0)
        for i, x in sizes.items():
            if x >= largest + THRESHOLD:
                cost = (len(rows[i]) - 1) * (len(columns[j]) - 1)
                if best is None or (cost, -x) < best[:2]:
                    best = (cost, -x, i, j)
    if best is not None:
        return best[2], best[3]
    if len(left) > 1:
        raise UndecidedError
    (i,) = set(range(len(scale))) - {i for i, _ in chosen}
    (j,) = left
    return i, j


def _take_out(rows: list[dict[int, acb]], columns: list[set[int]], i: int, j: int) -> None:
    """Eliminate column j by row i."""
    columns[j].discard(i)
    row = rows[i]
    items = [(k, x) for k, x in row.items() if k != j]
    for k, _ in items:
        columns[k].discard(i)
    for m in columns[j]:
        target = rows[m]
        factor = target.pop(j) / row[j]
        for k, x in items:
            entry = target.get(k)
            if entry is None:
                target[k] = -(factor * x)
                columns[k].add(m)
            else:
                target[k] = entry - factor * x
    columns[j] = set()


def _size(value: acb) -> int:
    """Return about the binary logarithm; of zero less than any other."""
    size = binary_exponent(value.mid())
    return -1000 if size is None else size


def columns_of(rows: Sequence[Mapping[int, object]]) -> list[set[int]]:
    """Return which rows have an entry in each column."""
    width = max((j + 1 for row in rows for j in row), default=0)
    columns: list[set[int]] = [set() for _ in range(max(len(rows), width))]
    for i, row in enumerate(rows):
        for j in row:
            columns[j].add(i)
    return columns


def sign_of(order: Sequence[tuple[int, int]]) -> int:
    """Return the sign of the permutation from rows to columns."""
    to = dict(order)
    sign, seen = 1, set()
    for start in to:
        i, length = start, 0
        while i not in seen:
            seen.add(i)
            i = to[i]
            length += 1
        if length and length % 2 == 0:
            sign = -sign
    return sign
