"""The equations of a model with numbers, enclosed at one s.

Input: :class:`symflex.equations.Equations` and exact values. Output: ball matrices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb

from symflex.algebra import LAPLACE
from symflex.algebra.propagators import EXPONENTIAL
from symflex.analysis.modes.shape import DistributedShape
from symflex.transfer.balls import ball, enclose

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.algebra import Factored, Propagation
    from symflex.equations import Continuum, Equations
    from symflex.library.elements import Variable
    from symflex.model import ExactValue

Values = dict[str, acb]


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
        if equations.propagation is not None:
            values |= _propagators(equations.propagation, values)
        for name, value in waiting:
            _define(name, value, values)
        columns = {variable: j for j, variable in enumerate(equations.unknowns)}
        entries = [[acb(0)] * len(columns) for _ in equations.rows]
        for entry, row in zip(entries, equations.rows, strict=True):
            for variable, coefficient in row.form.terms:
                if variable in columns:
                    entry[columns[variable]] += evaluated(coefficient, values)
        continua = tuple(_continuum(c, values) for c in equations.continua)
        return SystemAt(tuple(columns), acb_mat(entries), continua)

    def _constants(self) -> Mapping[str, arb]:
        later: dict[str, Callable[[], arb]] = {name: _enclosure(v) for name, v in self.values}
        found = {name: evaluate() for name, evaluate in later.items()}
        found["pi"] = arb.pi()
        for constant in self.equations.constants:
            found[constant.generator] = enclose(constant.expression, later)
        return found


@dataclass(frozen=True, slots=True)
class ContinuumAt:
    """A distributed part's field equations at one s."""

    name: str
    kind: str
    states: tuple[str, ...]
    matrix: tuple[tuple[acb, ...], ...]
    load_columns: tuple[tuple[acb, ...], ...]
    start: arb
    length: arb
    initial: tuple[Variable | None, ...]
    loads: tuple[Variable, ...]

    def shape(self, values: Mapping[Variable, acb], bits: int) -> DistributedShape:
        """Return how it moves when the unknowns have these values; inputs are at rest."""
        initial = tuple(acb(0) if v is None else values[v] for v in self.initial)
        load = [acb(0)] * len(self.states)
        for variable, column in zip(self.loads, self.load_columns, strict=True):
            if variable in values:
                load = [x + b * values[variable] for x, b in zip(load, column, strict=True)]
        matrix, states = self.matrix, self.states
        return DistributedShape(
            self.name, self.kind, states, matrix, tuple(load), initial, self.start, self.length, bits
        )


@dataclass(frozen=True, slots=True)
class SystemAt:
    """``matrix x = 0`` at one s, with the names of x and the distributed parts."""

    unknowns: tuple[Variable, ...]
    matrix: acb_mat
    continua: tuple[ContinuumAt, ...]


def evaluated(value: Factored, values: Mapping[str, acb]) -> acb:
    """Return a rational function with a ball in place of every generator; KeyError where one has no value."""
    names = value.ring.names
    result = acb(ball(value.unit))
    for factor, exponent in value.factors:
        total = acb(0)
        for monomial, coefficient in factor.terms():
            term = acb(int(coefficient))
            for name, power in zip(names, monomial, strict=True):
                if power:
                    term = term * values[name] ** int(power)
            total = total + term
        result = result * total**exponent
    return result


def _enclosure(value: ExactValue) -> Callable[[], arb]:
    return lambda: ball(value.rational) * arb.pi() ** value.pi_power


def _define(name: str, value: Factored, values: Values) -> bool:
    """Add a definition's value; False when it holds what has none yet."""
    try:
        values[name] = evaluated(value, values)
    except KeyError:
        return False
    return True


def _propagators(propagation: Propagation, values: Values) -> Values:
    """Return the fundamental functions and exponentials at s."""
    found: Values = {}
    columns: dict[tuple[int, int], list[acb]] = {}
    for p in propagation.propagators:
        law = propagation.table.dispersions[p.dispersion]
        length = evaluated(propagation.lengths[p.dispersion][p.length], values)
        if p.order == EXPONENTIAL:
            found[p.generator] = (-evaluated(law.shift, values) * length).exp()
            continue
        key = (p.dispersion, p.length)
        if key not in columns:
            columns[key] = _fundamental([evaluated(c, values) for c in law.characteristic], length)
        found[p.generator] = columns[key][p.order]
    return found


def _fundamental(characteristic: Sequence[acb], length: acb) -> list[acb]:
    """Return ``h, h', ...`` at a length: the last column of the exponential of the companion matrix."""
    n = len(characteristic)
    rows = [[length if j == i + 1 else acb(0) for j in range(n)] for i in range(n)]
    rows[-1] = [-c * length for c in characteristic]
    whole = acb_mat(rows).exp()
    return [whole[i, n - 1] for i in range(n)]


def _continuum(continuum: Continuum, values: Values) -> ContinuumAt:
    system = continuum.system
    return ContinuumAt(
        continuum.name,
        continuum.kind,
        system.states,
        tuple(tuple(evaluated(x, values) for x in row) for row in system.matrix),
        tuple(tuple(evaluated(x, values) for x in column) for column in system.loads),
        evaluated(continuum.start, values).real,
        evaluated(continuum.length, values).real,
        continuum.initial,
        continuum.loads,
    )
