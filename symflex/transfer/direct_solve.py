"""The equations of a model solved at one point: numbers first, and then elimination in balls.

Input: :class:`symflex.equations.Equations` without kernels, those of a distributed model cut (see
:func:`symflex.equations.assemble.assemble`), and a :class:`Point`.
Output: the values of transfer functions there, ``y = C x + D u`` with ``A(s) x + B u = 0``.

A distributed part relates the states at its ends by the exponential of its matrix times its length, and by
Taylor steps where its coefficients vary along x. So no wavenumber, no kernel and no cancelling takes part:
nothing is shared with the derivation of a closed form, which can be compared with these values.

Example: a mass m = 2 kg on a spring k = 8 N/m at s = 1 + 1j rad/s, from its one equation.

    (m s^2 + k) x = F          x/F = 1/(8 + 4j) m/N
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property

from flint import acb, acb_mat, acb_poly, acb_series, arb, fmpz, fmpz_mpoly

from symflex.algebra import FUNCTIONS, LAPLACE, Factored, evaluated, summed, terms_of
from symflex.balls import (
    Arithmetic,
    UndecidedError,
    ball,
    current_bits,
    current_terms,
    eliminate,
    raised,
    series_terms,
)
from symflex.budget import spend
from symflex.equations import ConstantFunction, Continuum, Equations
from symflex.errors import ModelError
from symflex.expressions import Expression, Name, fold
from symflex.library.elements import LinearForm, Variable
from symflex.model import Model
from symflex.model.along import COORDINATE, is_tapered, varies_along_x
from symflex.model.linearity import integer_exponent
from symflex.transfer.enclose import later

ZERO = acb(0)
FEW_TERMS = 16  # a polynomial of so many terms is summed term by term
LEAST_TAYLOR_BITS = 80  # by which the last terms of a Taylor step are smaller, twice the bits compared
BITS_A_TERM = 2  # of them: a step is halved until they are small
LAST_TERMS = 3  # a coefficient may vanish by symmetry; so many in a row do not
MOST_STEPS = 64  # Taylor steps along a member, halved ones too; a horn takes four
FIRST_STEPS = 4  # steps that a member is cut into at first


class SingularPointError(Exception):
    """The equations have no unique solution at a point, or no value there."""


class NotFollowedError(Exception):
    """Coefficients that vary along x are not analytic beside it, or waves too many for Taylor steps."""


@dataclass(frozen=True, eq=False)
class Point:
    """A complex frequency [rad/s] and parameters, enclosed at the precision they are asked for with."""

    s: Callable[[], acb]
    parameters: Mapping[str, Callable[[], arb]]
    whole: Mapping[str, int] = field(default_factory=dict)  # those of them, and s, that are integers


@dataclass(frozen=True, eq=False)
class Solution:
    """What the equations say at a point."""

    values: Mapping[tuple[str, str], acb]  # of the transfer functions, by output and input
    determinant: acb  # of A
    divisors: Mapping[str, acb]  # what each output's form is divided by
    generators: Mapping[str, acb]  # the values of the names in the equations


@dataclass(frozen=True, eq=False)
class DirectSolve:
    """The equations of one model, ready to be solved at points."""

    equations: Equations

    @cached_property
    def unsolved(self) -> str:
        """Why the equations cannot be solved at points; empty where they can."""
        ends = any(law.singular is not None for c in self.equations.continua for _, law in c.parts)
        return "a stiffness vanishes at an end, where Taylor steps cannot begin" if ends else ""

    def has(self, pair: tuple[str, str]) -> bool:
        """Tell whether there are an output and an input of these names."""
        output, source = pair
        return any(o.name == output for o in self.equations.outputs) and any(
            v.owner == source for v in self.equations.inputs
        )

    def at(self, point: Point, pairs: Sequence[tuple[str, str]]) -> Solution:
        """Return the values at a point at the current precision; SingularPointError if that is singular."""
        spend()
        equations, values = self.equations, self._generators(point)
        columns = {v: i for i, v in enumerate(equations.unknowns)}
        inputs = {v.owner: v for v in equations.inputs}
        sources = list(dict.fromkeys(source for _, source in pairs))
        places = columns | {inputs[source]: len(columns) + k for k, source in enumerate(sources)}
        number = GeneratorValues(values)
        rows = [number.row(row.form, places) for row in equations.rows]
        for continuum in equations.continua:
            rows += _relations(continuum, number, self._along, point, places)
        if len(rows) != len(columns) or not all(x.is_finite() for row in rows for x in row.values()):
            raise SingularPointError
        rows = [{i: x for i, x in row.items() if x != 0} for row in rows]
        try:
            solved = eliminate(rows, len(columns))
            unknowns = [solved.unknowns(len(columns) + k) for k in range(len(sources))]
        except UndecidedError:
            raise SingularPointError from None
        quotients = {}
        outputs = {row.name: row for row in equations.outputs}
        divisors = {output: number(outputs[output].divisor) for output, _ in pairs}
        for output, source in pairs:
            form, k = number.row(outputs[output].form, places), sources.index(source)
            total = form.get(len(columns) + k, ZERO)
            for i, c in form.items():
                if i < len(columns):
                    total = total + c * unknowns[k][i]
            quotients[output, source] = total / divisors[output]
        return Solution(quotients, solved.determinant, divisors, values)

    @cached_property
    def _along(self) -> Mapping[str, Expression]:
        return along_x(self.equations.model, self.equations.constants)

    def _generators(self, point: Point) -> dict[str, acb]:
        """Return the value of every name but those that vary along x."""
        values = {LAPLACE: point.s(), "pi": acb(arb.pi())}
        values |= {name: acb(enclosed()) for name, enclosed in point.parameters.items()}
        for constant in self.equations.constants:
            if constant.generator not in self._along:
                with suppress(ModelError):  # where it is needed its name is missing
                    values[constant.generator] = acb(later(constant.expression, point.parameters)())
        # Only numbers: definitions may hold delays, and delays may hold definitions.
        number, delays = GeneratorValues(values), self.equations.delays
        for name, value in self.equations.definitions:
            for delay in [d for d in delays if value.ring.index.get(d) is not None and value.depends_on(d)]:
                _delay(delay, delays, number)
            if not _holds(value, self._along):
                values[name] = number(value)
        for delay in delays:
            _delay(delay, delays, number)
        return values


def _delay(name: str, delays: Mapping[str, tuple[Factored, Factored]], number: GeneratorValues) -> None:
    if name not in number.values:
        rate, time = delays[name]
        number.values[name] = (-number(rate) * number(time)).exp()


def along_x(model: Model, constants: Iterable[ConstantFunction]) -> dict[str, Expression]:
    """Return the coordinate along x and its functions, by the names of their generators."""
    if not is_tapered(model):  # then x, if anything, is a parameter
        return {}
    functions = {c.generator: c.expression for c in constants if varies_along_x(c.expression)}
    return {COORDINATE: Name(COORDINATE), **functions}


def _holds(value: Factored, along: Mapping[str, Expression]) -> bool:
    """Tell whether a value varies along x."""
    return any(n in value.ring.index and value.depends_on(n) for n in along)


@dataclass(frozen=True, eq=False)
class GeneratorValues:
    """Takes rational functions to their values."""

    values: dict[str, acb]
    whole: Mapping[str, int] = field(default_factory=dict)

    def __call__(self, value: Factored) -> acb:
        """Return the value of a rational function; not finite where it divides by zero."""
        total = acb(ball(value.unit))
        for factor, exponent in value.factors:
            number = self.polynomial(factor, value.ring.names, is_sparse=value.ring.is_sparse)
            total = total * raised(number, exponent)
        return total

    def polynomial(self, polynomial: fmpz_mpoly, names: Sequence[str], *, is_sparse: bool = False) -> acb:
        """Return the value of a polynomial in the generators named; where all are integers the engine's."""
        is_long = len(polynomial) > FEW_TERMS and not is_sparse
        if is_long and (integer := self.integer(polynomial, names)) is not None:
            return acb(integer)
        return acb(summed(terms_of(polynomial), names, self._named, acb(1)))

    def integer(self, polynomial: fmpz_mpoly, names: Sequence[str]) -> fmpz | None:
        """Return the value of a polynomial where all of its generators are integers; else None."""
        if not all(names[i] in self.whole for i, d in enumerate(polynomial.degrees()) if int(d)):
            return None
        return polynomial(*(self.whole.get(name, 0) for name in names))

    def _named(self, name: str) -> acb:
        if name not in self.values:
            raise SingularPointError
        return self.values[name]

    def row(self, form: LinearForm, places: Mapping[Variable, int]) -> dict[int, acb]:
        """Return a linear form by its columns; what belongs to none is left out."""
        entries: dict[int, acb] = {}
        for variable, coefficient in form.terms:
            if variable in places:
                i, c = places[variable], self(coefficient)
                entries[i] = entries[i] + c if i in entries else c
        return entries


# ---------------------------------------------------------------------------------------- distributed parts


def _relations(
    part: Continuum,
    number: GeneratorValues,
    along: Mapping[str, Expression],
    point: Point,
    places: Mapping[Variable, int],
) -> list[dict[int, acb]]:
    """Return the rows that relate the states at both ends of a part."""
    size, loads = len(part.initial), part.system.loads
    if not part.final:
        return []
    columns = [*zip(*part.system.matrix, strict=True), *loads]
    reached = carried(columns, (part.start, part.length), number, along, point)
    rows = []
    for i, (end, sign) in enumerate(part.final):
        row: dict[int, acb] = {}
        terms = [(end, acb(-sign)), *((v, reached[i, j]) for j, v in enumerate(part.initial))]
        terms += [(v, reached[i, size + k]) for k, v in enumerate(part.loads[: len(loads)])]
        for variable, value in terms:
            if variable is not None and variable in places:
                column = places[variable]
                row[column] = row[column] + value if column in row else value
        rows.append(row)
    return rows


def carried(
    columns: Sequence[Sequence[Factored]],
    reach: tuple[Factored, Factored],
    number: GeneratorValues,
    along: Mapping[str, Expression],
    point: Point,
) -> acb_mat:
    """Return what takes states over ``reach``, given what each adds to all slopes, ``along`` x or not."""
    size, length = len(columns), number(reach[1])
    entries = {
        (i, j): value
        for j, column in enumerate(columns)
        for i, value in enumerate(column)
        if not value.is_zero
    }
    if any(_holds(value, along) for value in entries.values()):
        return _stepped(entries, size, number(reach[0]), length, _AlongX(number, along, point))
    matrix = acb_mat(size, size)
    for index, value in entries.items():
        matrix[index] = number(value) * length
    return matrix.exp()


@dataclass(frozen=True, eq=False)
class _AlongX:
    """Takes rational functions to their Taylor series along x."""

    number: GeneratorValues
    functions: Mapping[str, Expression]
    point: Point

    def series(self, value: Factored, x: acb) -> list[acb]:
        """Return the coefficients about a point, as many as ``current_terms()``."""
        along = acb_series([x, 1])
        known: dict[str, acb_series] = {}

        def named(name: str) -> acb | acb_series:
            if name in self.functions:
                known.setdefault(name, self._function(self.functions[name], along))
            return known[name] if name in known else self.number.values[name]

        expansion = evaluated(value, named, acb_series([1]))
        return [expansion[i] for i in range(current_terms())]

    def _function(self, function: Expression, along: acb_series) -> acb_series:
        def named(name: str) -> acb_series:
            if name == COORDINATE:
                return along
            return acb_series([arb.pi() if name == "pi" else self.point.parameters[name]()])

        series: acb_series = fold(
            function,
            number=lambda x: acb_series([ball(x)]),
            name=named,
            power=_power,
            call=lambda inner, argument: _elementary(inner.name, argument),
        )
        return series


def _power(base: acb_series, exponent: Expression) -> acb_series:
    integer = integer_exponent(exponent)
    if integer is None:
        raise NotFollowedError
    power: acb_series = raised(base, integer)
    return power


def _elementary(name: str, x: acb_series) -> acb_series:
    match name:
        case "sinh" | "cosh" | "tanh":
            up, down = x.exp(), (-x).exp()
            odd, even = up - down, up + down
            quotient: acb_series = odd / even if name == "tanh" else (odd if name == "sinh" else even) / 2
            return quotient
        case "tan":
            return _elementary("sin", x) / _elementary("cos", x)
    function: Callable[[Arithmetic], Arithmetic] = FUNCTIONS[name].evaluate
    series: acb_series = function(x)
    return series


def _stepped(
    entries: Mapping[tuple[int, int], Factored], size: int, start: acb, length: acb, along: _AlongX
) -> acb_mat:
    """Return the same by Taylor steps, its balls as wide as the terms that were left out suggest."""
    states = acb_mat(size, size)
    for i in range(size):
        states[i, i] = acb(1)
    done, step, steps = arb(0), arb(1) / FIRST_STEPS, 0
    with series_terms(_taylor_bits() // BITS_A_TERM):
        while done < 1:
            steps += 1
            if steps > MOST_STEPS:
                raise NotFollowedError
            step = min(step, 1 - done, key=lambda h: float(h.mid()))
            here = start + length * done
            series = {index: along.series(value, here) for index, value in entries.items()}
            while (across := _taylor(series, size, length * step)) is None:
                step = step / 2
                steps += 1
                if steps > MOST_STEPS:
                    raise NotFollowedError
            states = across * states
            done, step = (done + step).mid(), step * 2
    return states


def _taylor(series: Mapping[tuple[int, int], list[acb]], size: int, step: acb) -> acb_mat | None:
    """Return what takes states over one step, None where its last terms are too large."""
    count = current_terms()
    taps = [(i, j, m, c) for (i, j), own in series.items() for m, c in enumerate(own) if c != 0]
    # Each state is a polynomial of one coefficient per column, so all columns are one operation.
    terms = [[acb_poly([int(i == j) for j in range(size)]) for i in range(size)]]
    for k in range(count - 1):
        following = [acb_poly()] * size
        for i, j, m, c in taps:
            if m <= k:
                following[i] = following[i] + terms[k - m][j] * c
        terms.append([x * (acb(1) / (k + 1)) for x in following])
    power, sums = acb(1), [acb_poly()] * size
    last, across = [arb(0)] * size, acb_mat(size, size)
    for k, term in enumerate(terms):
        moved = [x * power for x in term]
        sums = [a + b for a, b in zip(sums, moved, strict=True)]
        if k >= count - LAST_TERMS:
            last = [max(far, *(abs(x[j]).upper() for x in moved), key=_middle) for j, far in enumerate(last)]
        power = power * step
    for j, far in enumerate(last):
        most = max((abs(x[j]).upper() for x in sums), key=_middle)
        if not far.is_finite() or not far <= most * arb(2) ** -_taylor_bits():
            return None
        for i, x in enumerate(sums):
            across[i, j] = x[j] + acb(arb(0, far), arb(0, far))
    return across


def _middle(x: arb) -> float:
    return float(x.mid())


def _taylor_bits() -> int:
    """Return by how many bits the last terms of a step are smaller than the states: more with more bits."""
    return max(LEAST_TAYLOR_BITS, current_bits() // 2)
