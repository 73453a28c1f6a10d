"""Determinants of full systems whose entries are polynomials in s alone: none of their minors is expanded.

Input: the rows of a system, over the closed ring. Output: determinants with columns, and a row on top, as
:class:`.determinants.Minors` returns them.

Example: 20 states with a full matrix of numbers have 2^20 minors. Their determinant is that of 20 rows of
integers at one large s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from symflex.algebra import LAPLACE, Ring
from symflex.algebra.polynomial_determinant import determinant, in_one_variable

if TYPE_CHECKING:
    from flint import fmpz_mpoly, fmpz_poly

    from symflex.equations.elimination.closing import SparseRow

MOST_ROWS = 100  # of a full matrix: 70 take 0.7 s, and none can be interrupted


@dataclass(frozen=True, eq=False)
class MinorsInS:
    """The determinants of rows whose entries are polynomials in s alone: none is expanded."""

    rows: tuple[SparseRow, ...]
    ring: Ring
    are_expanded: ClassVar[bool] = False

    @staticmethod
    def of(rows: Sequence[SparseRow], borders: Sequence[SparseRow], ring: Ring) -> MinorsInS | None:
        """Return them for some rows, and borders on top; None if one is no polynomial in s."""
        entries = (x for row in (*rows, *borders) for x in row.values())
        if len(rows) > MOST_ROWS or any(in_one_variable(x, ring) is None for x in entries):
            return None
        return MinorsInS(tuple(rows), ring)

    @cached_property
    def _in_s(self) -> tuple[dict[int, fmpz_poly], ...]:
        return tuple(_in_s(row, self.ring) for row in self.rows)

    def determinant(self, columns: int) -> fmpz_mpoly:
        """Return the determinant over the columns whose bits are set, taken in increasing order."""
        return self._expanded(self._in_s, columns)

    def bordered(self, top: SparseRow, columns: int) -> fmpz_mpoly:
        """Return the determinant with one more row on top."""
        return self._expanded((_in_s(top, self.ring), *self._in_s), columns)

    def _expanded(self, rows: Sequence[Mapping[int, fmpz_poly]], columns: int) -> fmpz_mpoly:
        found = determinant(rows, [c for c in range(columns.bit_length()) if columns >> c & 1])
        s, size = self.ring.index[LAPLACE], len(self.ring.names)
        terms = {tuple(k if i == s else 0 for i in range(size)): int(c) for k, c in enumerate(found.coeffs())}
        return self.ring.context.from_dict(terms)


def _in_s(row: SparseRow, ring: Ring) -> dict[int, fmpz_poly]:
    return {j: own for j, x in row.items() if (own := in_one_variable(x, ring)) is not None}
