"""Field theories as first-order systems in x, their characteristic polynomials and matrix exponentials.

    EI w'''' + rho A s^2 w = 0   ->   z' = M z,  z = (w, w', w'', w''')

A theory is one function and one line in :data:`FIELDS`: rod, shaft, string, and bending after
Euler-Bernoulli, Rayleigh and Timoshenko. Equations of any order, given by the coefficient of every derivative
of every unknown and of every load, become a :class:`FieldSystem` whose states are the unknowns and their
derivatives below the highest.

With ``chi(lambda) = det(lambda I - A)`` and ``adj(lambda I - A) = sum_k lambda^k B_k``, the inverse Laplace
transform in x of ``adj/chi`` is ``exp(A x) = sum_k h^(k)(x) B_k``, where ``chi(d/dx) h = 0`` and
``h(0) = ... = h^(n-2)(0) = 0``, ``h^(n-1)(0) = 1``. Nothing is divided but by what A itself
divides by, so the transfer matrix is entire in s wherever A is.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import TYPE_CHECKING, Protocol

from symflex.algebra.dispersion import DispersionKind
from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.algebra import Factored

Matrix = tuple[tuple["Factored", ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class FieldSystem:
    """``dz/dx = matrix(s) z + load(s) u``, Laplace-transformed in time."""

    # Names of z. A theory lists its across quantities first and its through quantities after them.
    states: tuple[str, ...]
    matrix: Matrix  # constant in x, rational in s and the parameters
    loads: Matrix = ()  # one column per input that acts all along the field, uniform in x


class FieldTheory(Protocol):
    """A theory: the first-order system of a uniform element."""

    def __call__(self, s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
        """Return the field equations for the element's values."""
        ...


def system_of(
    states: tuple[str, ...], entries: Mapping[tuple[str, str], Factored], zero: Factored
) -> FieldSystem:
    """Return a system from its entries that are not zero, named by (derivative, state)."""
    matrix = tuple(tuple(entries.get((row, column), zero) for column in states) for row in states)
    return FieldSystem(states, matrix)


@dataclass(frozen=True, slots=True, eq=False)
class FieldEquation:
    """``sum(terms[u, k] * d^k u/dx^k) + sum(loads[i] * input_i) = 0``."""

    terms: Mapping[tuple[str, int], Factored]
    loads: Mapping[str, Factored]


def first_order(
    unknowns: Sequence[str], inputs: Sequence[str], equations: Sequence[FieldEquation], zero: Factored
) -> FieldSystem | None:
    """Return the equations as a first-order system, ``None`` when the highest derivatives are not determined.

    The state called ``(u, k)`` is named ``u`` followed by k primes.
    """
    orders = {u: max((k for e in equations for v, k in e.terms if v == u), default=0) for u in unknowns}
    highest = [[e.terms.get((u, orders[u]), zero) for u in unknowns] for e in equations]
    states = [(u, k) for u in unknowns for k in range(orders[u])]
    right = [
        [-e.terms.get(state, zero) for state in states] + [-e.loads.get(i, zero) for i in inputs]
        for e in equations
    ]
    solved = _solve(highest, right)
    if solved is None:
        return None
    position = {state: i for i, state in enumerate(states)}
    one = zero + 1
    matrix: list[tuple[Factored, ...]] = []
    loads: list[tuple[Factored, ...]] = []
    for u, k in states:
        if k + 1 < orders[u]:
            following = position[u, k + 1]
            matrix.append(tuple(one if j == following else zero for j in range(len(states))))
            loads.append(tuple(zero for _ in inputs))
        else:
            row = solved[list(unknowns).index(u)]
            matrix.append(tuple(row[: len(states)]))
            loads.append(tuple(row[len(states) :]))
    columns: Matrix = tuple(tuple(loads[i][j] for i in range(len(states))) for j in range(len(inputs)))
    return FieldSystem(tuple(u + "'" * k for u, k in states), tuple(matrix), columns)


def _solve(matrix: list[list[Factored]], right: list[list[Factored]]) -> list[list[Factored]] | None:
    """Return ``matrix^-1 right`` by Gauss-Jordan elimination, ``None`` when the matrix is singular."""
    rows = [[*a, *b] for a, b in zip(matrix, right, strict=True)]
    n = len(matrix)
    for column in range(n):
        pivot = next((r for r in range(column, n) if not rows[r][column].is_zero), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        scale = rows[column][column]
        rows[column] = [x / scale for x in rows[column]]
        for r in range(n):
            factor = rows[r][column]
            if r != column and not factor.is_zero:
                rows[r] = [
                    x if y.is_zero else x - factor * y for x, y in zip(rows[r], rows[column], strict=True)
                ]
    return [row[n:] for row in rows]


def rod(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``E A (1 + eta s) u'' = (rho A s^2 + c_f s + k_f) u`` (Graff 1975, section 2.1)."""
    stiffness = values["E"] * values["A"] * (values["eta"] * s + 1)
    return _second_order(("u", "f"), s, stiffness, foundation(s, values))


def shaft(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``G J (1 + eta s) theta'' = (rho J s^2 + c_f s + k_f) theta`` (Graff 1975, section 2.6).

    J is the polar second moment of area [m^4] of a circular section.
    """
    stiffness = values["G"] * values["J"] * (values["eta"] * s + 1)
    inertia = values["rho"] * values["J"] * s**2 + values["c_f"] * s + values["k_f"]
    return _second_order(("theta", "tau"), s, stiffness, inertia)


def string(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``N w'' = (rho A s^2 + c_f s + k_f) w`` with tension N (Graff 1975, section 1.1)."""
    return _second_order(("w", "f"), s, values["N"], foundation(s, values))


def _second_order(
    states: tuple[str, str], s: Factored, stiffness: Factored, inertia: Factored
) -> FieldSystem:
    across, through = states
    one = s**0
    return system_of(states, {(across, through): one / stiffness, (through, across): inertia}, one * 0)


BENDING_STATES = ("y", "theta", "f", "tau")


def foundation(s: Factored, values: Mapping[str, Factored]) -> Factored:
    """Return ``rho*A*s^2 + c_f*s + k_f``, inertia and foundation per length [N/m^2]."""
    return values["rho"] * values["A"] * s**2 + values["c_f"] * s + values["k_f"]


def euler_bernoulli(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``EI(1 + eta s) w'''' - N w'' + (rho A s^2 + c_f s + k_f) w = 0`` as a first-order system.

    ``f`` and ``tau`` are the transverse force and the bending moment that the part beyond x exerts on the
    part before it: ``tau = EI w''`` and ``f = -EI w''' + N w'``. The axial force N is positive in tension.
    Valid for wavelengths long against the depth (Graff 1975, section 3.1).
    """
    return _slender(s, values, values["N"])


def rayleigh(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Euler-Bernoulli's equations with rotary inertia ``rho I`` (Rayleigh 1877)."""
    return _slender(s, values, values["N"] + values["rho"] * values["I"] * s**2)


def _slender(s: Factored, values: Mapping[str, Factored], slope_moment: Factored) -> FieldSystem:
    one = s**0
    stiffness = values["E"] * values["I"] * (values["eta"] * s + 1)
    entries = {
        ("y", "theta"): one,
        ("theta", "tau"): one / stiffness,
        ("tau", "f"): -one,
        ("tau", "theta"): slope_moment,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)


def timoshenko(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Timoshenko's equations of deflection w and rotation theta of the cross-section.

    ``kappa G A (w'' - theta') = (rho A s^2 + c_f s + k_f) w`` and
    ``EI theta'' + kappa G A (w' - theta) = rho I s^2 theta``; Kelvin-Voigt losses multiply E and G alike
    (Timoshenko 1921; Graff 1975, section 3.4).
    """
    one = s**0
    loss = values["eta"] * s + 1
    entries = {
        ("y", "theta"): one,
        ("y", "f"): one / (values["kappa"] * values["G"] * values["A"] * loss),
        ("theta", "tau"): one / (values["E"] * values["I"] * loss),
        ("tau", "f"): -one,
        ("tau", "theta"): values["rho"] * values["I"] * s**2,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)


FIELDS: dict[str, FieldTheory] = {
    "euler-bernoulli": euler_bernoulli,
    "rayleigh": rayleigh,
    "timoshenko": timoshenko,
    "rod": rod,
    "shaft": shaft,
    "string": string,
}


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

    Raises BudgetError: SF501 when densely coupled equations grow beyond what a closed form can hold.
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
    match [x.is_zero for x in c]:
        case [False, _]:
            return "wave"
        case [False, True, True, _]:
            return "bending"
        case [False, True, False, _]:
            return "pair"
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
