"""The null space of a ball matrix, proved.

Input: a square matrix that is singular somewhere in its balls. Output: enclosures of a basis.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb, arb_mat

if TYPE_CHECKING:
    from collections.abc import Sequence

SEED = 7
PASSES = 2
"""Of scaling rows and columns: units make entries differ by many powers of ten."""

Column = tuple[acb, ...]


@dataclass(frozen=True, slots=True)
class NullSpace:
    """A basis of the null space."""

    # For a matrix in the balls whose null space has as many dimensions, a basis of it is enclosed.
    basis: tuple[Column, ...]
    is_refuted: bool  # true when no matrix in the balls has a null space of that dimension


def null_space(matrix: acb_mat, dimension: int = 1, typical: acb_mat | None = None) -> NullSpace | None:
    """Return the null space of a square matrix, bordered so that it becomes regular.

    With ``[A B; C 0] [X; T] = [0; 1]``, B and C of full rank and generic, the bordered matrix is regular as
    soon as the null space of A has at most ``dimension`` dimensions; it has exactly as many where T = 0, and
    X is a basis then (Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 3).
    None when the balls are too wide to tell.

    ``typical`` is a matrix whose entries are as large as those of this one are in general. Rows and columns
    are scaled after it; where entries vanish by the singularity itself, they tell nothing of the scale.

    Examples
    --------
    >>> found = null_space(acb_mat([[1, -2], [-2, 4]]))
    >>> x, y = found.basis[0]
    >>> (x / y).contains(2), found.is_refuted
    (True, False)
    >>> null_space(acb_mat([[1, 0], [0, 1]])).is_refuted
    True
    """
    n = int(matrix.nrows())
    if not n:
        return NullSpace((), True)
    rows = matrix.tolist()
    left, right = _scales(rows if typical is None else typical.tolist())
    random = Random(SEED)
    bordered = [
        [*(x * left[i] * right[j] for j, x in enumerate(row)), *_border(random, dimension)]
        for i, row in enumerate(rows)
    ]
    below = list(zip(*(_border(random, dimension) for _ in range(n)), strict=True))
    bordered += [[*row, *([acb(0)] * dimension)] for row in below]
    wanted = [[acb(int(i == n + k)) for k in range(dimension)] for i in range(n + dimension)]
    solved = _solve(bordered, wanted)
    if solved is None:
        return None
    basis = tuple(tuple(solved[j][k] * right[j] for j in range(n)) for k in range(dimension))
    is_refuted = not all(x.contains(0) for row in solved[n:] for x in row)
    return NullSpace(basis, is_refuted)


def _border(random: Random, dimension: int) -> list[acb]:
    return [acb(random.choice((-1, 1)) * random.uniform(0.5, 1)) for _ in range(dimension)]


def _solve(matrix: list[list[acb]], wanted: list[list[acb]]) -> list[list[acb]] | None:
    """Return ``matrix^-1 wanted``, in real arithmetic where all is real."""
    try:
        if all(x.imag == 0 for row in matrix for x in row):
            real = arb_mat([[x.real for x in row] for row in matrix])
            found = real.solve(arb_mat([[x.real for x in row] for row in wanted]))
            return [[acb(x) for x in row] for row in found.tolist()]
        solved: list[list[acb]] = acb_mat(matrix).solve(acb_mat(wanted)).tolist()
    except ZeroDivisionError:
        return None
    return solved


def _scales(rows: Sequence[Sequence[acb]]) -> tuple[list[arb], list[arb]]:
    """Return powers of two for rows and columns that bring their largest entries near one."""
    sizes = [[_exponent(x) for x in row] for row in rows]
    left, right = [0] * len(rows), [0] * len(rows)
    for _ in range(PASSES):
        for i, row in enumerate(sizes):
            left[i] = -max((e + right[j] for j, e in enumerate(row) if e is not None), default=0)
        for j, column in enumerate(zip(*sizes, strict=True)):
            right[j] = -max((e + left[i] for i, e in enumerate(column) if e is not None), default=0)
    two = arb(2)
    return [two**e for e in left], [two**e for e in right]


def _exponent(value: acb) -> int | None:
    """Return about the binary logarithm of a ball's size, None for zero."""
    size = value.abs_upper()
    if size == 0 or not size.is_finite():
        return None
    mantissa, exponent = size.man_exp()
    return int(mantissa).bit_length() + int(exponent)
