"""Polynomials in the entries of fundamental matrices, with minors of these in place of differences.

Input: a polynomial over a ring whose kernels are entries of fundamental matrices, by their laws and lengths.
Output: a :class:`MinorSum`. Entries grow like waves, and so do the minors that determinants are made of; the
products of entries these are differences of grow like their squares, and lose as many digits.

    a T_22 T_33 - a T_23 T_32 + b T_12    is    a |T_22 T_23; T_32 T_33| + b T_12
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from symflex.algebra.ring import PolynomialMemo, Ring, coefficients_of, degree_in

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import fmpz_mpoly

    from symflex.algebra.dispersion import Dispersion, KernelTable
    from symflex.algebra.factored import Factored

Lines = tuple[int, ...]


@dataclass(frozen=True, slots=True, order=True)
class Minor:
    """The determinant of some rows and columns of a matrix; of one of each, an entry."""

    matrix: int  # its number, see :attr:`MinorSums.matrices`
    rows: Lines
    columns: Lines


Product = tuple[Minor, ...]
MinorSum = tuple[tuple["fmpz_mpoly", Product], ...]
"""Coefficients, free of entries, and the minors they are multiplied by."""


@dataclass(frozen=True, eq=False)
class MinorSums:
    """The sums of polynomials over one ring, each made once."""

    ring: Ring
    table: KernelTable  # of the ring

    @cached_property
    def matrices(self) -> tuple[tuple[Dispersion, Factored], ...]:
        """The law and the length of every matrix."""
        found = {(k.dispersion, k.length): None for k in self.table.kernels if k.function == "entry"}
        return tuple(found)

    @cached_property
    def entries(self) -> Mapping[int, Minor]:
        """The entries, by the positions of their generators."""
        numbers = {key: i for i, key in enumerate(self.matrices)}
        return {
            self.ring.index[k.generator]: Minor(
                numbers[k.dispersion, k.length],
                (k.order // k.dispersion.order,),
                (k.order % k.dispersion.order,),
            )
            for k in self.table.kernels
            if k.function == "entry"
        }

    def has_entries(self, polynomial: fmpz_mpoly) -> bool:
        """Tell whether a polynomial has entries in it."""
        return any(degree_in(polynomial, i) for i in self.entries)

    @cached_property
    def of(self) -> PolynomialMemo[MinorSum]:
        """The sum of a polynomial."""
        return PolynomialMemo(self._made)

    def _made(self, polynomial: fmpz_mpoly) -> MinorSum:
        positions = list(self.entries)
        terms: dict[Product, fmpz_mpoly] = {}
        for powers, part in coefficients_of(self.ring, polynomial, positions).items():
            product = [self.entries[i] for i, n in zip(positions, powers, strict=True) for _ in range(n)]
            terms[tuple(sorted(product))] = part
        for matrix in range(len(self.matrices)):
            terms = _joined(terms, matrix)
        return tuple((part, product) for product, part in terms.items())


def _joined(terms: Mapping[Product, fmpz_mpoly], matrix: int) -> dict[Product, fmpz_mpoly]:
    """Return terms with the differences of two products of two entries of a matrix as its minors."""
    left = dict(terms)
    found: dict[Product, fmpz_mpoly] = {}
    while left:
        product, part = next(iter(left.items()))
        del left[product]
        own = [m for m in product if m.matrix == matrix]
        others = tuple(m for m in product if m.matrix != matrix)
        if len(own) == 2 and own[0].rows != own[1].rows and own[0].columns != own[1].columns:  # noqa: PLR2004
            (a, b), (c, d) = ((m.rows[0], m.columns[0]) for m in own)
            twins = Minor(matrix, (a,), (d,)), Minor(matrix, (c,), (b,))
            twin = tuple(sorted((*others, *twins)))
            if twin in left and (left[twin] + part).is_zero():
                del left[twin]
                rows, columns = (a, c), (b, d)
                sign = 1
                if b > d:
                    columns, sign = (d, b), -1
                joint = Minor(matrix, rows, columns)
                found[tuple(sorted((*others, joint)))] = part * sign
                continue
        found[product] = part
    return found
