"""The equations of a model with numbers, enclosed at one s, and what they leave free there.

Input: :class:`symflex.equations.Equations` and exact values. Output: ball matrices, and enclosures of a basis
of the null space of one that is singular somewhere in its balls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from random import Random
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb, arb_mat

from symflex.algebra import LAPLACE, Factored, composed
from symflex.algebra.propagators import EXPONENTIAL, Propagation
from symflex.analysis.modes.shape import DistributedShape, VaryingCarrier
from symflex.balls import at_centre, balancing, binary_exponent, current_bits
from symflex.model.along import is_tapered, varies_along_x
from symflex.transfer.enclose import enclose, enclosure, evaluated
from symflex.transfer.enclose_kernels import fundamental_functions
from symflex.transfer.varying_law import BoundLaw

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.algebra import Dispersion
    from symflex.balls import Value
    from symflex.equations import Continuum, Equations
    from symflex.expressions import Call
    from symflex.library.elements import Variable
    from symflex.model import ExactValue


SEED = 7
PASSES = 2
"""Passes of scaling rows and columns: units make entries differ by many powers of ten."""

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
            solution = real.solve(arb_mat([[x.real for x in row] for row in wanted]))
            return [[acb(x) for x in row] for row in solution.tolist()]
        solved: list[list[acb]] = acb_mat(matrix).solve(acb_mat(wanted)).tolist()
    except ZeroDivisionError:
        return None
    return solved


def _scales(rows: Sequence[Sequence[acb]]) -> tuple[list[arb], list[arb]]:
    """Return powers of two for rows and columns that bring their largest entries near one."""
    exponents = ({j: binary_exponent(x) for j, x in enumerate(row)} for row in rows)
    sizes = [{j: e for j, e in row.items() if e is not None} for row in exponents]
    left, right = balancing(sizes, len(rows), PASSES)
    two = arb(2)
    return [two**e for e in left], [two**e for e in right]


Values = dict[str, acb]
Laws = dict["Dispersion", BoundLaw]


@dataclass(frozen=True)
class BoundEquations:
    """``A(s) x = 0`` with numbers."""

    # Assembled without names for wavenumbers: fundamental functions are entire in s, also where wavenumbers
    # vanish.
    equations: Equations
    values: tuple[tuple[str, ExactValue], ...]  # of every parameter that occurs

    def at(self, s: acb) -> SystemAt:
        """Return the equations at a ball of s [rad/s], at the current precision."""
        equations = self.equations
        known = self._constants()
        values: Values = {LAPLACE: s, **{name: acb(value) for name, value in known.items()}}
        waiting = [(n, v) for n, v in equations.definitions if not _define(n, v, values)]
        laws = self._laws(values)
        if equations.propagation is not None:
            values |= _propagators(equations.propagation, values, laws)
        for name, value in waiting:
            _define(name, value, values)
        columns = {variable: j for j, variable in enumerate(equations.unknowns)}
        entries = [[acb(0)] * len(columns) for _ in equations.rows]
        for entry, row in zip(entries, equations.rows, strict=True):
            for variable, coefficient in row.form.terms:
                if variable in columns:
                    entry[columns[variable]] += _evaluated(coefficient, values)
        continua = tuple(_continuum(c, values, laws) for c in equations.continua)
        return SystemAt(tuple(columns), acb_mat(entries), continua)

    def _constants(self) -> Mapping[str, arb]:
        later: dict[str, Callable[[], arb]] = {name: enclosure(v) for name, v in self.values}
        constants = {name: evaluate() for name, evaluate in later.items()}
        constants["pi"] = arb.pi()
        for constant in self.equations.constants:
            if constant.generator not in self._along:
                constants[constant.generator] = enclose(constant.expression, later)
        return constants

    @property
    def _along(self) -> Mapping[str, Call]:
        """The functions of the coordinate along x among the generators."""
        if not is_tapered(self.equations.model):
            return {}
        return {c.generator: c.expression for c in self.equations.constants if varies_along_x(c.expression)}

    def _laws(self, values: Values) -> Laws:
        """Return the laws that vary along x with numbers, given those of all that does not."""
        propagation = self.equations.propagation
        if propagation is None:
            return {}
        constants = {name: _constant(value.real) for name, value in values.items() if name != LAPLACE}
        parameters = {name: enclosure(value) for name, value in self.values}
        return {
            law: BoundLaw(
                law.replaced(lambda x: self._opened(propagation.embed(x))),
                self._along,
                law.start[0],
                constants,
                parameters,
            )
            for law in propagation.table.dispersions
            if law.kind == "varying"
        }

    def _opened(self, value: Factored) -> Factored:
        """Return a coefficient without definitions that depend on s: of laws that is told."""
        moving = {LAPLACE}
        for name, meant in self.equations.definitions:
            if any(meant.depends_on(each) for each in moving):
                moving.add(name)
        for name, meant in reversed(self.equations.definitions):
            if name in moving and value.depends_on(name):
                value = composed(value, {name: meant})
        return value


@dataclass(frozen=True, slots=True)
class ContinuumAt:
    """A distributed part's field equations at one s."""

    at_rest: DistributedShape
    load_columns: tuple[tuple[acb, ...], ...]  # none where coefficients vary along x
    initial: tuple[Variable | None, ...]
    loads: tuple[Variable, ...]

    def shape(self, values: Mapping[Variable, acb]) -> DistributedShape:
        """Return how it moves when the unknowns have these values; inputs are at rest."""
        initial = tuple(acb(0) if v is None else values[v] for v in self.initial)
        load = [values.get(variable, acb(0)) for variable in self.loads]
        varying = self.at_rest.varying
        if varying is not None:
            return replace(self.at_rest, load=tuple(load), initial=varying.started(initial))
        total = self.at_rest.load
        for size, column in zip(load if self.load_columns else (), self.load_columns, strict=True):
            total = tuple(x + b * size for x, b in zip(total, column, strict=True))
        return replace(self.at_rest, load=total, initial=initial)


@dataclass(frozen=True, slots=True)
class SystemAt:
    """``matrix x = 0`` at one s, with the names of x and the distributed parts."""

    unknowns: tuple[Variable, ...]
    matrix: acb_mat
    continua: tuple[ContinuumAt, ...]


def _evaluated(value: Factored, values: Mapping[str, acb]) -> acb:
    """Return a rational function with a ball in place of every generator; KeyError where one has no value."""
    enclosed: acb = evaluated(value, values.__getitem__, acb(1))
    return enclosed


def _define(name: str, value: Factored, values: Values) -> bool:
    """Add a definition's value; False when it holds what has none yet."""
    try:
        values[name] = _evaluated(value, values)
    except KeyError:
        return False
    return True


def _constant(value: arb) -> Callable[[], arb]:
    return lambda: value


def _propagators(propagation: Propagation, values: Values, laws: Laws) -> Values:
    """Return the fundamental functions and exponentials at s."""
    propagators: Values = {}
    matrices: dict[tuple[int, int], list[list[acb]]] = {}
    columns: dict[tuple[int, int], tuple[Value, ...]] = {}
    for p in propagation.propagators:
        law = propagation.table.dispersions[p.dispersion]
        length = _evaluated(propagation.lengths[p.dispersion][p.length], values)
        if p.order == EXPONENTIAL:
            propagators[p.generator] = (-_evaluated(law.shift, values) * length).exp()
            continue
        key = (p.dispersion, p.length)
        if law in laws:
            if key not in matrices:
                start, _ = laws[law].ends()
                matrices[key] = laws[law].matrix_at(values[LAPLACE], (start, start + length.real))
            row, column = divmod(p.order, law.order)
            propagators[p.generator] = matrices[key][row][column]
            continue
        if key not in columns:
            coefficients = [_evaluated(c, values) for c in law.characteristic]
            columns[key] = fundamental_functions(coefficients, length)
        propagators[p.generator] = at_centre(columns[key][p.order])
    return propagators


def _continuum(continuum: Continuum, values: Values, laws: Laws) -> ContinuumAt:
    system = continuum.system
    axes = system.axes
    varying: VaryingCarrier | None = None
    if continuum.parts:
        parts = tuple((states, laws[law]) for states, law in continuum.parts)
        varying = VaryingCarrier(parts, values[LAPLACE], len(system.states))
    matrix, loads = (
        tuple(tuple(_evaluated(x, values) for x in row) for row in (() if varying else rows))
        for rows in (system.matrix, system.loads)
    )
    at_rest = DistributedShape(
        continuum.name,
        continuum.kind,
        system.states,
        matrix,
        (acb(0),) * len(system.states),
        (),
        _evaluated(continuum.start, values).real,
        _evaluated(continuum.length, values).real,
        current_bits(),
        () if axes is None else tuple(_evaluated(x, values).real for x in (axes.cos, axes.sin)),
        varying,
    )
    return ContinuumAt(at_rest, loads, continuum.initial, continuum.loads)
