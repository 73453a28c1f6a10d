"""Determinants of sparse polynomial matrices by memoised Laplace expansion.

Every minor is expanded along its first row and remembered by the columns it has left, so a banded matrix
costs a number of products that grows linearly with its size (Gentleman & Johnson 1976 compare the method
with elimination for polynomial entries).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from symflex.errors import BudgetError, Diagnostic
from symflex.kernels import MEMORY_LIMIT, Ring

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.elimination.closing import SparseRow

MINOR_LIMIT = 200_000
ROW_LIMIT = 700


@dataclass
class Minors:
    """The minors of some rows over any set of columns, each computed once.

    Parameters
    ----------
    ring : Ring
        Where the entries live.
    rows : tuple of dict
        Sparse rows, in the order of expansion.

    Raises
    ------
    BudgetError
        SF502 when the expansion exceeds its limits.
    """

    ring: Ring
    rows: tuple[SparseRow, ...]
    _known: dict[int, fmpz_mpoly] = field(default_factory=dict)
    _bytes: int = 0

    def __post_init__(self) -> None:
        if len(self.rows) > ROW_LIMIT:
            raise _too_large(f"{len(self.rows)} unknowns remain after elimination, more than {ROW_LIMIT}")

    def determinant(self, columns: int) -> fmpz_mpoly:
        """Return the determinant over the columns whose bits are set, taken in increasing order."""
        self._find(columns)
        return self._minor(0, columns)

    def bordered(self, top: SparseRow, columns: int) -> fmpz_mpoly:
        """Return the determinant with one more row on top."""
        for left in self._left(top, columns):
            self._find(left)
        return self._expand(top, 0, columns)

    def _minor(self, row: int, columns: int) -> fmpz_mpoly:
        # The number of columns left tells the row, so the columns alone are the key.
        return self.ring.constant(1) if row == len(self.rows) else self._known[columns]

    def _left(self, entries: SparseRow, columns: int) -> set[int]:
        return {columns & ~(1 << column) for column in entries if columns >> column & 1}

    def _find(self, columns: int) -> None:
        """Compute a determinant and all its minors, the smallest first: calls go less deep than chains."""
        wanted = [{columns} - self._known.keys()]
        count = len(self._known)
        for entries in self.rows:
            count += len(wanted[-1])
            if count > MINOR_LIMIT:
                raise _too_large("the determinant has too many minors or terms")
            below = {left for each in wanted[-1] for left in self._left(entries, each)}
            wanted.append(below - self._known.keys())
        for row in reversed(range(len(self.rows))):
            for each in wanted[row]:
                known = self._expand(self.rows[row], row + 1, each)
                self._known[each] = known
                self._bytes += self.ring.bytes_of(len(known))
                if self._bytes > MEMORY_LIMIT:
                    raise _too_large("the determinant has too many minors or terms")

    def _expand(self, entries: SparseRow, below: int, columns: int) -> fmpz_mpoly:
        total = self.ring.constant(0)
        for column in sorted(entries):
            bit = 1 << column
            if not columns & bit:
                continue
            minor = self._minor(below, columns & ~bit)
            if minor.is_zero():
                continue
            # Refused before it is made: the engine does not survive running out of memory.
            if self.ring.bytes_of(len(total) + len(entries[column]) * len(minor)) > MEMORY_LIMIT:
                raise _too_large("a minor has too many terms")
            term = entries[column] * minor
            odd = (columns & (bit - 1)).bit_count() & 1
            total = total - term if odd else total + term
        return total


def _too_large(message: str) -> BudgetError:
    return BudgetError(
        Diagnostic(
            "SF502",
            f"the closed form is too large: {message}",
            None,
            "split the model or give it fewer nodes",
        )
    )


def expansion_order(rows: tuple[SparseRow, ...], columns: tuple[int, ...]) -> tuple[int, ...]:
    """Return an order of the rows that touches new columns as late as possible.

    Rows that reach few columns not yet seen come first, which keeps the number of different
    column sets, and so of minors, small.
    """
    wanted = set(columns)
    patterns = [frozenset(c for c in row if c in wanted) for row in rows]
    users: dict[int, list[int]] = {}
    for i, pattern in enumerate(patterns):
        for c in pattern:
            users.setdefault(c, []).append(i)
    fresh = [len(p) for p in patterns]
    seen: set[int] = set()
    left = set(range(len(rows)))
    touched: set[int] = set()
    order: list[int] = []
    while left:
        candidates = touched or left
        best = min(candidates, key=lambda i: (fresh[i], i))
        order.append(best)
        left.discard(best)
        touched.discard(best)
        for c in patterns[best] - seen:
            for i in users[c]:
                fresh[i] -= 1
                if i in left:
                    touched.add(i)
        seen |= patterns[best]
    return tuple(order)
