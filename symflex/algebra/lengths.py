"""Base lengths: the fewest lengths of which all others are integer combinations.

Kernels of ``l/2`` and ``l``, or of ``x_s``, ``l`` and ``l - x_s``, are tied by addition theorems. Written in
kernels of base lengths only, equal functions become equal polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from flint import fmpq, fmpq_mat, fmpz_mat

from symflex.algebra.factored import Factored, common_denominator

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

SUBSET_LIMIT = 500
"""Number of subsets of the given lengths that are tried as a base."""

Monomial = tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class LengthBase:
    """Base lengths, and the integer coordinates of every length that was given."""

    base: tuple[Factored, ...]  # rationally independent
    coordinates: tuple[tuple[int, ...], ...]  # per given length, its multiples of the base lengths


def length_base(lengths: Sequence[Factored], *, positive: bool = False) -> LengthBase:
    """Return base lengths for the given ones; these themselves where they suffice.

    None is zero; earlier ones are preferred, and with ``positive`` those of which no coordinate is negative.

    Examples
    --------
    >>> from symflex.algebra import Factored, Ring
    >>> ring = Ring(("s", "l", "x"))
    >>> l, x = Factored.generator(ring, "l"), Factored.generator(ring, "x")
    >>> found = length_base([l, l / 2, l - x])
    >>> [str(b) for b in found.base], found.coordinates
    (['1/2*l', '(l - x)'], ((2, 0), (1, 0), (0, 1)))
    """
    ring = lengths[0].ring
    common = common_denominator(ring, lengths)
    whole, monomials = _vectors([(length * common).expand() for length in lengths])
    lattice = _lattice(whole)
    rank = len(lattice)
    chosen = _subset(whole, lattice, rank, positive=positive)
    rows = lattice if chosen is None else [whole[i] for i in chosen]
    coordinates = tuple(_coordinates(rows, v) for v in whole)
    base = []
    for i, row in enumerate(rows):
        if chosen is not None:
            base.append(lengths[chosen[i]])
            continue
        polynomial = ring.context.from_dict({m: x for m, x in zip(monomials, row, strict=True) if x})
        base.append(Factored.polynomial(ring, polynomial) / common)
    return LengthBase(tuple(base), coordinates)


def _vectors(lengths: Sequence[fmpz_mpoly]) -> tuple[list[list[int]], list[Monomial]]:
    """Return every length as a vector over the monomials that occur."""
    found = [{tuple(int(e) for e in m): int(c) for m, c in length.terms()} for length in lengths]
    order = sorted({m for terms in found for m in terms}, reverse=True)
    return [[terms.get(m, 0) for m in order] for terms in found], order


def _lattice(vectors: list[list[int]]) -> list[list[int]]:
    """Return a basis of all integer combinations, in Hermite normal form."""
    rows = fmpz_mat(len(vectors), len(vectors[0]), [x for v in vectors for x in v]).hnf().tolist()
    return [[int(x) for x in row] for row in rows if any(int(x) for x in row)]


def _subset(
    vectors: list[list[int]], lattice: list[list[int]], rank: int, *, positive: bool
) -> tuple[int, ...] | None:
    """Return the first vectors that generate the lattice by themselves."""
    first = None
    for tried, subset in enumerate(combinations(range(len(vectors)), rank)):
        if tried >= SUBSET_LIMIT:
            break
        rows = [vectors[i] for i in subset]
        if _lattice(rows) != lattice:
            continue
        if not positive or all(x >= 0 for v in vectors for x in _coordinates(rows, v)):
            return subset
        first = first or subset
    return first


def _coordinates(rows: list[list[int]], vector: list[int]) -> tuple[int, ...]:
    """Return the integers x with ``x rows = vector``."""
    matrix = fmpq_mat(fmpz_mat(len(rows), len(vector), [x for r in rows for x in r])).transpose()
    gram = matrix.transpose() * matrix
    right = matrix.transpose() * fmpq_mat(len(vector), 1, [fmpq(x) for x in vector])
    solution = gram.solve(right)
    return tuple(int(solution[i, 0].p) for i in range(len(rows)))
