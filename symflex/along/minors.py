"""Polynomials in the entries of fundamental matrices, with minors of these in place of signed sums.

Input: a polynomial over a ring whose kernels are entries of fundamental matrices, by their laws and lengths.
Output: a :class:`MinorSum`. Entries grow like waves, and so do the minors that determinants are made of; the
products of entries these are signed sums of grow like their powers, and lose as many digits.

    a T_22 T_33 - a T_23 T_32 + b T_12    is    a |T_22 T_23; T_32 T_33| + b T_12
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations

from flint import fmpz_mpoly

from symflex.algebra import Dispersion, Factored, KernelTable
from symflex.algebra.ring import PolynomialMemo, Ring, coefficients_of, degree_in

Lines = tuple[int, ...]


@dataclass(frozen=True, slots=True, order=True)
class Minor:
    """The determinant of some rows and columns of a matrix; of one of each, an entry."""

    matrix: int  # its number, see :attr:`MinorSums.matrices`
    rows: Lines
    columns: Lines


Product = tuple[Minor, ...]
MinorSum = tuple[tuple["fmpz_mpoly", Product], ...]  # coefficients free of entries, times minors


@dataclass(frozen=True, eq=False)
class MinorSums:
    """The sums of polynomials over one ring, each made once."""

    ring: Ring
    table: KernelTable  # of the ring

    @cached_property
    def matrices(self) -> tuple[tuple[Dispersion, Factored], ...]:
        """The law and the length of every matrix."""
        return tuple({(k.dispersion, k.length): None for k in self.table.kernels if k.function == "entry"})

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

    @cached_property
    def has_entries(self) -> PolynomialMemo[bool]:
        """Tell whether a polynomial has entries in it."""
        return PolynomialMemo(lambda polynomial: any(degree_in(polynomial, i) for i in self.entries))

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
    """Return terms with the signed sums of products of entries of a matrix as its minors."""
    left = dict(terms)
    products: dict[Product, fmpz_mpoly] = {}
    while left:
        product, part = next(iter(left.items()))
        own = [m for m in product if m.matrix == matrix]
        others = tuple(m for m in product if m.matrix != matrix)
        rows, columns = ([m.rows[0] for m in own], [m.columns[0] for m in own])
        signs: dict[Product, int] = {}
        if 1 < len(own) == len(set(rows)) == len(set(columns)):
            for order in permutations(range(len(own))):
                twins = (Minor(matrix, (i,), (columns[k],)) for i, k in zip(rows, order, strict=True))
                signs[tuple(sorted((*others, *twins)))] = _sign(order)
        is_whole = all(t in left and (left[t] - part * sign).is_zero() for t, sign in signs.items())
        if signs and is_whole:
            for twin in signs:
                del left[twin]
            # Rows ascend, as factors are sorted.
            ranks = [sorted(columns).index(c) for c in columns]
            joint = Minor(matrix, tuple(rows), tuple(sorted(columns)))
            products[tuple(sorted((*others, joint)))] = part * _sign(ranks)
            continue
        del left[product]
        products[product] = part
    return products


def _sign(order: Sequence[int]) -> int:
    """Return the sign of a permutation."""
    turned = sum(a > b for i, b in enumerate(order) for a in order[:i])
    return -1 if turned % 2 else 1
