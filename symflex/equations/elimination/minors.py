"""Determinants of sparse polynomial matrices by memoised Laplace expansion.

Every minor is expanded along its first row and remembered by the columns it has left, so a banded matrix
costs a number of products that grows linearly with its size (Gentleman & Johnson 1976 compare the method
with elimination for polynomial entries).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, TypeVar

from symflex.algebra import Ring
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import fmpz_mpoly

    from symflex.equations.elimination.closing import SparseRow

MINOR_LIMIT = 200_000
ROW_LIMIT = 700
MEMORY_LIMIT = 300_000_000
"""Bytes that all minors of a system may take together: a free chain of sixteen masses needs 270 MB. The
engine takes almost three times as much for a while."""

Entry = TypeVar("Entry")
Value = TypeVar("Value")


@dataclass
class LaplaceExpansion(ABC, Generic[Entry, Value]):
    """Values of all minors of some rows, each found once from smaller ones.

    Parameters
    ----------
    rows : tuple of dict
        Sparse rows, in the order of expansion.

    Raises
    ------
    BudgetError
        SF502 when the expansion exceeds its limits.
    """

    rows: tuple[Mapping[int, Entry], ...]
    _known: dict[int, Value] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.rows) > ROW_LIMIT:
            raise _too_large(f"{len(self.rows)} unknowns remain after elimination, more than {ROW_LIMIT}")

    @abstractmethod
    def _one(self) -> Value:
        """Return the value of the minor without rows."""

    @abstractmethod
    def _expand(self, entries: Mapping[int, Entry], below: int, columns: int) -> Value:
        """Return a minor along one row from those that begin with row ``below``."""

    def _note(self, value: Value) -> None:
        """Take notice of a value that is about to be kept."""

    def determinant(self, columns: int) -> Value:
        """Return the determinant over the columns whose bits are set, taken in increasing order."""
        self._find(columns)
        return self._minor(0, columns)

    def bordered(self, top: Mapping[int, Entry], columns: int) -> Value:
        """Return the determinant with one more row on top."""
        for left in self._left(top, columns):
            self._find(left)
        return self._expand(top, 0, columns)

    def _minor(self, row: int, columns: int) -> Value:
        # The number of columns left tells the row, so the columns alone are the key.
        return self._one() if row == len(self.rows) else self._known[columns]

    def _left(self, entries: Mapping[int, Entry], columns: int) -> set[int]:
        return {columns & ~(1 << column) for column in entries if columns >> column & 1}

    def _find(self, columns: int) -> None:
        """Compute a determinant and all its minors, the smallest first: calls go less deep than chains."""
        wanted = [{columns} - self._known.keys()]
        count = len(self._known)
        for entries in self.rows:
            spend()
            count += len(wanted[-1])
            if count > MINOR_LIMIT:
                raise _too_large("the determinant has too many minors or terms")
            below = {left for each in wanted[-1] for left in self._left(entries, each)}
            wanted.append(below - self._known.keys())
        for row in reversed(range(len(self.rows))):
            for each in wanted[row]:
                spend()
                known = self._expand(self.rows[row], row + 1, each)
                self._known[each] = known
                self._note(known)


@dataclass
class Minors(LaplaceExpansion["fmpz_mpoly", "fmpz_mpoly"]):
    """The minors of polynomial rows over any set of columns, each computed once.

    Parameters
    ----------
    rows : tuple of dict
        Sparse rows, in the order of expansion.
    ring : Ring
        Where the entries live.

    Raises
    ------
    BudgetError
        SF502 when the expansion exceeds its limits.
    """

    ring: Ring = field(kw_only=True)
    _bytes: int = 0

    def _one(self) -> fmpz_mpoly:
        return self.ring.constant(1)

    def _note(self, value: fmpz_mpoly) -> None:
        self._bytes += self.ring.bytes_of(len(value))
        if self._bytes > MEMORY_LIMIT:
            raise _too_large("the determinant has too many minors or terms")

    def _expand(self, entries: Mapping[int, fmpz_mpoly], below: int, columns: int) -> fmpz_mpoly:
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


@dataclass
class DegreeBounds(LaplaceExpansion[int, int]):
    """What the degrees of minors can be at most: those of entries add in products, the larger one is a sum's.

    A minor that is zero for its pattern alone has degree -1.
    """

    def _one(self) -> int:
        return 0

    def _expand(self, entries: Mapping[int, int], below: int, columns: int) -> int:
        highest = -1
        for column, degree in entries.items():
            bit = 1 << column
            if columns & bit and (minor := self._minor(below, columns & ~bit)) >= 0:
                highest = max(highest, degree + minor)
        return highest


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
