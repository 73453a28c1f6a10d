"""Boundary-value problems in x, solved with mpmath at one complex s: exponentials and one linear system.

Every distributed part is a first-order system z' = A z + b on a length; its state at x is an affine form of
the state at its first end, z(x) = exp(A x) z(0) + integral of exp(A (x - t)) b dt. Conditions are affine
forms that vanish. No kernels, no transfer functions, no elements: numbers from the first line to the last.

States hold what a text on strength of materials draws, not what the program's elements exchange. With
V = E I w''' - N w' and M = E I w'', the beam's energy gives the loads on its ends: upward force +V(0) and
moment -M(0) on the first end, -V(l) and +M(l) on the second.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mpmath import ldexp, log, matrix, mp, mpc, mpf
from mpmath import lu_solve as solve_linear

if TYPE_CHECKING:
    from collections.abc import Mapping

Number = Any  # mpmath's numbers have no types
Rows = list[list[Number]]
Values = dict[str, Number]

DIGITS = 120
"""Working digits: the largest exponentials of the cases cost sixty of them."""


# ------------------------------------------------------------------------------------------ the solver


@dataclass(frozen=True)
class Form:
    """An affine form: numbers times unknowns, plus a constant.

    Examples
    --------
    >>> form = 2 * Form({0: mpf(1)}) - 3
    >>> form.coefficients, form.constant
    ({0: mpf('2.0')}, -3)
    """

    coefficients: Mapping[int, Number] = field(default_factory=dict)
    constant: Number = 0

    def __add__(self, other: Form | Number) -> Form:
        if not isinstance(other, Form):
            return Form(self.coefficients, self.constant + other)
        total = dict(self.coefficients)
        for unknown, coefficient in other.coefficients.items():
            total[unknown] = total.get(unknown, 0) + coefficient
        return Form(total, self.constant + other.constant)

    def __mul__(self, factor: Number) -> Form:
        return Form({u: c * factor for u, c in self.coefficients.items()}, self.constant * factor)

    def __neg__(self) -> Form:
        return self * -1

    def __sub__(self, other: Form | Number) -> Form:
        return self + -other

    def __rsub__(self, other: Number) -> Form:
        return -self + other

    def __truediv__(self, divisor: Number) -> Form:
        return self * (1 / mpc(divisor))

    __radd__ = __add__
    __rmul__ = __mul__


@dataclass(frozen=True)
class Line:
    """One distributed part: its system and the form of each component of its state at the first end.

    Parameters
    ----------
    rows : list of list
        A, and last a column b: z' = A z + b.
    start : tuple of Form
        z(0).
    known : dict
        The states found so far, by x.
    """

    rows: Rows
    start: tuple[Form, ...]
    known: dict[Number, list[Form]] = field(default_factory=dict)

    def at(self, x: Number) -> list[Form]:
        """Return the state at x, counted from the first end."""
        if x not in self.known:
            self.known[x] = self._transferred(x)
        return self.known[x]

    def _transferred(self, x: Number) -> list[Form]:
        n = len(self.start)
        augmented = [list(row) for row in self.rows] + [[mpf(0)] * (n + 1)]
        transfer = exponential(augmented, x)
        state = []
        for row in transfer[:n]:
            form = Form({}, row[n])
            for entry, initial in zip(row, self.start, strict=False):
                form = form + initial * entry
            state.append(form)
        return state


@dataclass
class Problem:
    """Unknowns and the conditions on them.

    Examples
    --------
    A rod with one end held, unit force on the other, at s = 0: u(l) = l/(E A).

    >>> problem = Problem()
    >>> rod = problem.line([[0, mpf(1) / 8, 0], [0, 0, 0]])
    >>> u, force = rod.at(mpf(2))
    >>> problem.require(rod.start[0])
    >>> problem.require(force - 1)
    >>> print(problem.solve()(u).real)
    0.25
    """

    count: int = 0
    conditions: list[Form] = field(default_factory=list)

    def unknown(self) -> Form:
        """Return a new unknown."""
        self.count += 1
        return Form({self.count - 1: mpf(1)})

    def line(self, rows: Rows) -> Line:
        """Return a distributed part whose state at its first end is unknown."""
        return Line(rows, tuple(self.unknown() for _ in rows))

    def require(self, *forms: Form) -> None:
        """Let each form vanish."""
        self.conditions.extend(forms)

    def solve(self) -> Solution:
        """Return the solution.

        Raises
        ------
        ValueError
            When conditions and unknowns do not match in number.
        ZeroDivisionError
            When the conditions do not determine the unknowns.
        """
        if len(self.conditions) != self.count:
            message = f"{len(self.conditions)} conditions for {self.count} unknowns"
            raise ValueError(message)
        system, right_side = matrix(self.count), matrix(self.count, 1)
        # Forces and motions of stiff parts differ by many powers of ten: rows and columns are scaled.
        columns = [mpf(0)] * self.count
        for form in self.conditions:
            largest = max((abs(c) for c in form.coefficients.values()), default=mpf(0))
            for unknown, c in form.coefficients.items():
                columns[unknown] = max(columns[unknown], abs(c) / (largest or 1))
        scale = [power_of_two(c) for c in columns]
        for i, form in enumerate(self.conditions):
            scaled = {u: c / scale[u] for u, c in form.coefficients.items()}
            size = power_of_two(max((abs(c) for c in scaled.values()), default=mpf(0)))
            for unknown, c in scaled.items():
                system[i, unknown] = c / size
            right_side[i] = -form.constant / size
        found = solve_linear(system, right_side)
        return Solution(tuple(found[i] / scale[i] for i in range(self.count)))


@dataclass(frozen=True)
class Solution:
    """The unknowns' values."""

    unknowns: tuple[Number, ...]

    def __call__(self, form: Form) -> Number:
        return form.constant + sum(c * self.unknowns[u] for u, c in form.coefficients.items())


def power_of_two(size: Number) -> Number:
    """Return a power of two near ``size``, one for zero.

    Examples
    --------
    >>> print(power_of_two(mpf(700)), power_of_two(mpf(0)))
    1024.0 1.0
    """
    return ldexp(mpf(1), mp.mag(size)) if size else mpf(1)


def exponential(rows: Rows, x: Number) -> Rows:
    """Return exp(A x) by scaling and squaring of its Taylor series.

    A is balanced by powers of two first: its entries bear units, flexibilities of 1e-6 beside forces of 1e12.

    Examples
    --------
    >>> rotation = exponential([[0, -1], [1, 0]], mp.pi / 2)
    >>> abs(rotation[0][1] + 1) < 1e-12 and abs(rotation[0][0]) < 1e-12
    True
    """
    n = len(rows)
    weight = balance(rows)
    a = [[mpc(rows[i][j]) * x * weight[j] / weight[i] for j in range(n)] for i in range(n)]
    norm = max(sum(abs(entry) for entry in row) for row in a)
    halvings = max(0, int(mp.mag(norm)) + 1) if norm else 0
    sparse = [[(j, ldexp(1, -halvings) * row[j]) for j in range(n) if row[j]] for row in a]
    # Each squaring doubles the relative error: as many bits more as there are squarings.
    with mp.workprec(mp.prec + halvings + 20):
        term = identity(n)
        total = identity(n)
        k = 0
        while any(term[i][j] for i in range(n) for j in range(n)):
            k += 1
            term = [
                [sum((entry * term[m][j] for m, entry in row), mpc(0)) / k for j in range(n)]
                for row in sparse
            ]
            largest = max(abs(entry) for row in term for entry in row)
            total = [[t + d for t, d in zip(*pair, strict=True)] for pair in zip(total, term, strict=True)]
            if largest < ldexp(mpf(1), -mp.prec):
                break
        for _ in range(halvings):
            total = product(total, total)
    return [[total[i][j] * weight[i] / weight[j] for j in range(n)] for i in range(n)]


def identity(n: int) -> Rows:
    """Return the unit matrix."""
    return [[mpc(int(i == j)) for j in range(n)] for i in range(n)]


def product(left: Rows, right: Rows) -> Rows:
    """Return a matrix product."""
    columns = list(zip(*right, strict=True))
    return [[sum((a * b for a, b in zip(row, c, strict=True)), mpc(0)) for c in columns] for row in left]


def balance(rows: Rows, rounds: int = 12) -> list[Number]:
    """Return weights d, powers of two, that make rows and columns of d^-1 A d alike (Osborne 1960)."""
    n = len(rows)
    size = [[float(log(abs(e), 2)) if e else None for e in row] for row in rows]
    exponents = [0] * n
    for _ in range(rounds):
        for i in range(n):
            outward = [size[i][j] + exponents[j] for j in range(n) if j != i and size[i][j] is not None]
            inward = [size[j][i] - exponents[j] for j in range(n) if j != i and size[j][i] is not None]
            if outward and inward:
                exponents[i] = round((max(outward) - max(inward)) / 2)
            elif outward or inward:  # a load's column: nothing feeds it, so it may be as small as it likes
                exponents[i] = round(max(outward)) if outward else -round(max(inward))
    return [ldexp(mpf(1), e) for e in exponents]


# -------------------------------------------------------------------------------- the field equations


def loss(v: Values, s: Number) -> Number:
    """Return the Kelvin-Voigt factor 1 + eta s."""
    return 1 + v.get("eta", mpf(0)) * s


def transverse(v: Values, s: Number) -> Number:
    """Return force per length over displacement: inertia, viscous and elastic foundation."""
    return v["rho"] * v["A"] * s**2 + v.get("c_f", mpf(0)) * s + v.get("k_f", mpf(0))


def bending(v: Values, s: Number, load: Number = 0, rotary: bool = False) -> Rows:
    """Return the Euler-Bernoulli (or Rayleigh) beam in (w, w', M, V), with an upward load per length.

    (E I w'')'' - N w'' - rho I s^2 w'' + (rho A s^2 + c_f s + k_f) w = load,
    and V = E I w''' - (N + rho I s^2) w'.
    """
    slope = v.get("N", mpf(0)) + (v["rho"] * v["I"] * s**2 if rotary else 0)
    stiffness = v["E"] * v["I"] * loss(v, s)
    return [
        [0, 1, 0, 0, 0],
        [0, 0, 1 / stiffness, 0, 0],
        [0, slope, 0, 1, 0],
        [-transverse(v, s), 0, 0, 0, load],
    ]


def timoshenko(v: Values, s: Number, load: Number = 0) -> Rows:
    """Return the Timoshenko beam in (w, phi, M, V): the shear force kappa G A (w' - phi) is -V.

    M' + kappa G A (w' - phi) = rho I s^2 phi and (kappa G A (w' - phi))' + load = rho A s^2 w.
    """
    stiffness = v["E"] * v["I"] * loss(v, s)
    shear = v["kappa"] * v["G"] * v["A"] * loss(v, s)
    return [
        [0, 1, 0, -1 / shear, 0],
        [0, 0, 1 / stiffness, 0, 0],
        [0, v["rho"] * v["I"] * s**2, 0, 1, 0],
        [-transverse(v, s), 0, 0, 0, load],
    ]


def rod(v: Values, s: Number, load: Number = 0) -> Rows:
    """Return the axial rod in (u, tension)."""
    return [[0, 1 / (v["E"] * v["A"] * loss(v, s)), 0], [transverse(v, s), 0, -load]]


def shaft(v: Values, s: Number, load: Number = 0) -> Rows:
    """Return the shaft in (angle, torque)."""
    inertia = v["rho"] * v["J"] * s**2 + v.get("c_f", mpf(0)) * s + v.get("k_f", mpf(0))
    return [[0, 1 / (v["G"] * v["J"] * loss(v, s)), 0], [inertia, 0, -load]]


def string(v: Values, s: Number, load: Number = 0) -> Rows:
    """Return the string in (w, N w')."""
    return [[0, 1 / v["N"], 0], [transverse(v, s), 0, -load]]
