"""The characteristic polynomial of a field's equations, and the exponential of its matrix in closed form.

With ``chi(lambda) = det(lambda I - A)`` and ``adj(lambda I - A) = sum_k lambda^k B_k``, the inverse Laplace
transform in x of ``adj/chi`` is ``exp(A x) = sum_k h^(k)(x) B_k``, where ``chi(d/dx) h = 0`` and
``h(0) = ... = h^(n-2)(0) = 0``, ``h^(n-1)(0) = 1``. Nothing is divided but by what A itself
divides by, so the transfer matrix is entire in s wherever A is.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import TYPE_CHECKING

from symflex.algebra.dispersion import DispersionKind
from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.algebra import Factored
    from symflex.library.fields.system import FieldSystem, Matrix


TERM_LIMIT = 5_000
"""Terms of the adjugate up to which field equations are solved in closed form."""


@dataclass(frozen=True, slots=True, eq=False)
class Characteristic:
    """A characteristic polynomial sorted by what its roots look like."""

    # As of :class:`symflex.algebra.Dispersion`, or ``polynomial`` when every root is zero.
    kind: DispersionKind | str
    coefficients: tuple[Factored, ...]  # ``c_0, ..., c_(n-1)`` in the shifted exponent
    shift: Factored  # the exponents are the roots minus this

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal polynomials, so that elements of one material share their wavenumbers."""
        return tuple(_text(c) for c in (*self.coefficients, self.shift))


def _text(value: Factored) -> str:
    parts = sorted(f"({f})^{e}" for f, e in value.factors)
    return f"{value.unit}*" + "*".join(parts)


@dataclass(frozen=True, slots=True, eq=False)
class Component:
    """A part of a field's states that is coupled to no other part."""

    states: tuple[int, ...]  # their positions among the system's states
    characteristic: Characteristic  # of this part alone
    coefficients: tuple[Factored, ...]  # ``c_0, ..., c_(n-1)`` of the same polynomial, not shifted
    adjugate: tuple[Matrix, ...]  # ``B_0, ..., B_(n-1)``


def components(system: FieldSystem) -> tuple[Component, ...]:
    """Return the uncoupled parts of a field's equations, each with its characteristic polynomial."""
    found = []
    for states in _coupled(system.matrix):
        matrix = tuple(tuple(system.matrix[i][j] for j in states) for i in states)
        coefficients, adjugate = faddeev_leverrier(matrix)
        found.append(Component(states, classify(coefficients), coefficients, adjugate))
    return tuple(found)


def _coupled(matrix: Matrix) -> list[tuple[int, ...]]:
    """Return the connected parts of the states, in order."""
    left, found = list(range(len(matrix))), []
    while left:
        part, pending = set(), [left[0]]
        while pending:
            i = pending.pop()
            if i in part:
                continue
            part.add(i)
            pending += [j for j in left if not (matrix[i][j].is_zero and matrix[j][i].is_zero)]
        found.append(tuple(i for i in left if i in part))
        left = [i for i in left if i not in part]
    return found


def faddeev_leverrier(matrix: Matrix) -> tuple[tuple[Factored, ...], tuple[Matrix, ...]]:
    """Return ``c_0, ..., c_(n-1)`` and ``B_0, ..., B_(n-1)`` (Faddeev & Faddeeva 1963, section 47).

    Raises
    ------
    BudgetError
        SF501 when densely coupled equations grow beyond what a closed form can hold.
    """
    n = len(matrix)
    zero = matrix[0][0] * 0
    identity = tuple(tuple(zero + int(i == j) for j in range(n)) for i in range(n))
    b = identity
    descending: list[Factored] = []
    adjugate = [b]
    for k in range(1, n + 1):
        product = _product(matrix, b)
        trace = zero
        for i in range(n):
            trace = trace + product[i][i]
        c = trace * Fraction(-1, k)
        descending.append(c)
        if k < n:
            b = tuple(
                tuple(product[i][j] + c if i == j else product[i][j] for j in range(n)) for i in range(n)
            )
            adjugate.append(b)
            _check_size(b)
    return tuple(reversed(descending)), tuple(reversed(adjugate))


def _check_size(matrix: Matrix) -> None:
    terms = sum(len(f) for row in matrix for value in row for f, _ in value.factors)
    if terms > TERM_LIMIT:
        message = f"the characteristic polynomial of the field equations needs more than {TERM_LIMIT} terms"
        raise BudgetError(
            Diagnostic("SF501", message, None, "put numbers in place of symbols, or uncouple them")
        )


def _product(left: Matrix, right: Matrix) -> Matrix:
    n = len(left)
    rows = []
    for i in range(n):
        row = []
        for j in range(n):
            total = left[0][0] * 0
            for k in range(n):
                if not (left[i][k].is_zero or right[k][j].is_zero):
                    total = total + left[i][k] * right[k][j]
            row.append(total)
        rows.append(tuple(row))
    return tuple(rows)


def classify(coefficients: Sequence[Factored]) -> Characteristic:
    """Return a characteristic polynomial with its exponents shifted to zero mean where that makes it even."""
    n = len(coefficients)
    zero = coefficients[0] * 0
    if all(c.is_zero for c in coefficients):
        return Characteristic("polynomial", tuple(coefficients), zero)
    if n == 1:
        return Characteristic("exponential", (), coefficients[0])
    shift = coefficients[-1] / n
    shifted = tuple(coefficients) if shift.is_zero else _shifted(coefficients, shift)
    kind = _even_kind(shifted)
    if kind == "general":
        return Characteristic("general", tuple(coefficients), zero)
    return Characteristic(kind, shifted, shift)


def _even_kind(c: Sequence[Factored]) -> DispersionKind:
    if len(c) == 2 and not c[0].is_zero:  # noqa: PLR2004
        return "wave"
    if len(c) == 4 and c[1].is_zero and not c[0].is_zero:  # noqa: PLR2004
        return "bending" if c[2].is_zero else "pair"
    return "general"


def _shifted(coefficients: Sequence[Factored], shift: Factored) -> tuple[Factored, ...]:
    """Return the coefficients of ``chi(lambda - shift)``."""
    n = len(coefficients)
    one = shift**0
    full = (*coefficients, one)
    found = []
    for j in range(n):
        total = one * 0
        for k in range(j, n + 1):
            total = total + full[k] * (-shift) ** (k - j) * comb(k, j)
        found.append(total)
    return tuple(found)
