"""Pivots of sparse symmetric matrices: how many are negative, in balls; which vanish, modulo a prime.

    [ 2  1  0 ]    pivots 2, 5/2, and -2/5 from the last row: the matrix has one negative eigenvalue, as many
    [ 1  3  1 ]    as there are negative pivots (Sylvester)
    [ 0  1  0 ]

The unknown that meets the fewest others goes first. A constraint, 0 on the diagonal, waits until one of the
unknowns it ties is gone, or goes together with one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from flint import arb, nmod

from symflex.roots.networks.members import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import numpy as np
    import numpy.typing as npt

Number = TypeVar("Number", arb, nmod, "npt.NDArray[np.float64]")
Operand_contra = TypeVar("Operand_contra", arb, nmod, "npt.NDArray[np.float64]", contravariant=True)
Rows = list[dict[int, Number]]
"""A symmetric matrix, every entry off the diagonal in both of its rows."""
Count = Any
"""A number, or an array of numbers."""


class PivotArithmetic(Protocol[Operand_contra]):
    """What a kind of numbers knows of its signs."""

    def is_usable(self, value: Operand_contra) -> bool:
        """Tell whether it may be divided by, and its sign is decided."""
        ...

    def negative(self, value: Operand_contra) -> Count:
        """Return 1 for a usable number below zero, else 0."""
        ...

    def negative_of_pair(self, determinant: Operand_contra, corner: Operand_contra | None) -> Count:
        """Return how many eigenvalues of two rows and columns are negative; ``corner`` is of their diagonal.

        UndecidedError where that cannot be told.
        """
        ...


class Balls:
    """Real balls."""

    def is_usable(self, value: arb) -> bool:
        """Tell whether the sign is decided."""
        return bool(value > 0) or bool(value < 0)

    def negative(self, value: arb) -> int:
        """Return 1 for a number below zero, else 0."""
        return int(value < 0)

    def negative_of_pair(self, determinant: arb, corner: arb | None) -> int:
        """Return how many eigenvalues of two rows and columns are negative."""
        if determinant < 0:
            return 1
        if corner is None or not self.is_usable(corner):
            raise UndecidedError
        return 2 * self.negative(corner)


@dataclass(frozen=True, slots=True)
class Pivots(Generic[Number]):
    """What is left of a matrix when all unknowns but the borders are gone."""

    negative: Count  # how many pivots are; of arrays, each
    determinant: Number | None  # their product; None where there is none
    borders: tuple[Number | None, ...]  # what became of the borders' diagonals


def elimination_order(size: int, pairs: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """Return the unknowns in the order in which they are eliminated, fewest neighbours first.

    ``pairs`` are the places of entries, (i, i) of those on the diagonal.

    Examples
    --------
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
    buckets: dict[int, dict[int, None]] = {}
    left = set(range(size))

    def rank(i: int) -> int:
        return len(beside[i]) if i in firm else size + len(beside[i])

    ranks = [rank(i) for i in range(size)]
    for i, r in enumerate(ranks):
        buckets.setdefault(r, {})[i] = None
    order = []
    while left:
        lowest = min(r for r, members in buckets.items() if members)
        i = next(iter(buckets[lowest]))
        del buckets[lowest][i]
        left.discard(i)
        order.append(i)
        around = beside[i]
        for j in around:
            beside[j].discard(i)
            beside[j] |= around - {j}
            firm.add(j)
        for j in around:
            del buckets[ranks[j]][j]
            ranks[j] = rank(j)
            buckets.setdefault(ranks[j], {})[j] = None
    return tuple(order)


def pivots(
    rows: Rows[Number], order: Sequence[int], arithmetic: PivotArithmetic[Number], borders: Sequence[int] = ()
) -> Pivots[Number]:
    """Eliminate the unknowns in about this order; ``rows`` is used up.

    UndecidedError where no usable pivot is left, as at an eigenvalue.
    """
    negative: Count = 0
    determinant: Number | None = None
    waiting: list[int] = []
    pending = list(reversed(order))
    while pending or waiting:
        if not pending:
            pair = _pair(rows, waiting, arithmetic)
            if pair is None:
                raise UndecidedError(len(waiting))
            i, j, block = pair
            waiting.remove(i)
            waiting.remove(j)
            a, b = rows[i].get(i), rows[j].get(j)
            corner = a if a is not None and arithmetic.is_usable(a) else b
            negative = negative + arithmetic.negative_of_pair(block, corner)
            determinant = block if determinant is None else determinant * block
            _eliminate_pair(rows, i, j, block)
            pending, waiting = waiting, []
            continue
        i = pending.pop()
        row = rows[i]
        pivot = row.get(i)
        if pivot is None or not arithmetic.is_usable(pivot):
            waiting.append(i)
            continue
        negative = negative + arithmetic.negative(pivot)
        determinant = pivot if determinant is None else determinant * pivot
        del row[i]
        for j in row:
            del rows[j][i]
        items = list(row.items())
        for place, (j, x) in enumerate(items):
            factor = x / pivot
            target = rows[j]
            known = target.get(j)
            target[j] = -(factor * x) if known is None else known - factor * x
            for k, y in items[place + 1 :]:
                known = target.get(k)
                target[k] = rows[k][j] = -(factor * y) if known is None else known - factor * y
        if waiting:
            # What waited may have become usable.
            pending += reversed(waiting)
            waiting = []
    return Pivots(negative, determinant, tuple(rows[i].get(i) for i in borders))


def _pair(
    rows: Rows[Number], waiting: Sequence[int], arithmetic: PivotArithmetic[Number]
) -> tuple[int, int, Number] | None:
    """Return two unknowns that go together, with their determinant."""
    among = set(waiting)
    for i in waiting:
        for j, c in rows[i].items():
            if j == i or j not in among:
                continue
            a, b = rows[i].get(i), rows[j].get(j)
            block = -(c * c) if a is None or b is None else a * b - c * c
            if arithmetic.is_usable(block):
                return i, j, block
    return None


def _eliminate_pair(rows: Rows[Number], i: int, j: int, block: Number) -> None:
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
                known = rows[k].get(m)
                rows[k][m] = rows[m][k] = -change / block if known is None else known - change / block


def _times(a: Number | None, b: Number | None) -> Number | None:
    return None if a is None or b is None else a * b


def _sum(a: Number | None, b: Number | None) -> Number | None:
    return b if a is None else a if b is None else a + b
