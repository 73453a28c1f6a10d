"""Parameters of a machine, fitted to measured responses: their values, errors and correlations.

Input: measured responses, the function of each with its derivatives in the free parameters, and what the
specification says of these: values to begin with, signs, spreads.
Output: a :class:`ParameterFit`.

The residual is that of a fit of resonances: model less data, over the standard deviation of each line, which
coherence tells or a function without structure leaves (:mod:`symflex.data.fitting.noise`). Positive
parameters are searched for by their logarithms, so that no bound is ever reached. A spread counts as a
measurement: 95 % of a normal distribution lie within it. Starts are the declared values, for rational
functions those of coefficients found by linear least squares (Sanathanan & Koerner 1963), and random ones
around both.

Example: force and motion of a mass m on a spring k. ``k/m`` is the square of a resonance and ``1/k`` the
response at rest, so both follow, k with the relative error of the lines at low frequency.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc, stdtrit

from symflex.budget import entered_budget, spend
from symflex.data.fitting.fit import (
    FEWEST_LINES,
    LARGE,
    MOST_LINES,
    ROUNDS,
    SMOOTH,
    WILD,
    Base,
    ResonanceFit,
    said_of_units,
)
from symflex.data.fitting.identifiable import Coefficients, Identifiability
from symflex.data.fitting.least_squares import (
    Refined,
    Sums,
    correlation_of,
    sandwich,
    search,
    sums_of,
    triangle,
)
from symflex.data.fitting.lines import CAP, isolated
from symflex.data.fitting.minimum_phase import not_judged
from symflex.data.fitting.noise import estimated, with_noise, with_rough_noise
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.order import UNLIKELY, Candidate, lack_of_fit
from symflex.data.fitting.problem import FitProblem, fit_problem
from symflex.data.fitting.pulse_response import PulseResponse, of_coefficients, of_function, terms_for
from symflex.data.fitting.resonances import Complex, Free, Real, Resonances, Values
from symflex.data.fitting.sampled_record import autoregression, is_held
from symflex.data.fitting.starts import poles_from_vector_fitting
from symflex.data.measurement import MeasuredResponse
from symflex.data.measurement.measured_response import Samples
from symflex.errors import DataError, Diagnostic, FitError, counted, no_such, refused
from symflex.model import ModelParameter
from symflex.model.settings import check_free
from symflex.quantities import unit_of

Gradient = Callable[[Complex, Mapping[str, complex]], tuple[Complex, Complex]]

INTERVAL: Final = 0.95  # share of cases in which an interval holds the value
OF_SPREAD: Final = 1.959964  # standard deviations of a normal distribution within which so many lie
STEPS, ROUGH_STEPS, ROUGH = 80, 30, 1e-4  # of a search to the end, of one from any start; tolerance of that
SANATHANAN = 12  # linear fits, each weighted by the denominator of the one before
LINES_OF_STARTS = 200  # lines that starts are compared on
RANDOM_STARTS, REACH = 6, 0.7  # random starts, and how far they are from others, in ln p
FAR_STARTS, FEW_STARTS, NEAR, FAR = 24, 3, 2.5, 7.0
"""Starts that other values are looked for from, of coefficients and of responses, and how far they are."""
APART = 0.3  # distance in ln p from which other values of functions with kernels are others
ENOUGH = 2  # starts that end in the same minimum, with a residual that noise explains
SAME = 1e-3  # relative distance within which two minima are one
EXPLAINED = 1.5  # sum of squares per degree of freedom up to which noise explains a residual
EQUAL = 4.0  # sum of squares by which two minima describe the data equally well
EQUAL_COEFFICIENTS = 1e-9  # relative distance of coefficients within which parameters are others of the same
EDGE = 25.0  # ln p, or parameters over their scale, stay within this of their start
LOST = 1e3  # ratio of standard error to value above which no value is printed
STRONG = 0.95  # correlation that is named
WEAK = 0.5  # relative standard error from which a parameter is hardly determined by the data
CONTRADICTED = 3.3  # standard deviations off what a spread says that noise exceeds once in a thousand cases
NAMED_TWINS = 4
UNMOVED = 1e-6  # share of a definition's slope along an undetermined direction below which it does not move
NO_FREE = Free()
OTHER_SIGN: Final = "with the other sign the data agree far better with the specification"
COLOURED: Final = 2  # rounds in which the noise of records is coloured anew
MOST_LAGS: Final = 40  # lags of the correlation between what is left of a record and its input


@dataclass(frozen=True, eq=False)
class MachineFunction:
    """A transfer function of a specification, as a fit of its parameters needs it."""

    name: str  # ``OUT/IN``
    unit: str  # of its values, empty when unknown
    gradient: Gradient  # of complex s and the values of parameters: values, and derivatives in the free ones
    coefficients: Coefficients | None = None  # of a quotient of polynomials in s and the free parameters


@dataclass(frozen=True, eq=False)
class Derived:
    """A definition that depends on free parameters."""

    name: str
    unit: str
    # Maps the values of all parameters to its value and its derivatives in the free ones.
    gradient: Callable[[Mapping[str, complex]], tuple[float, Real]]


@dataclass(frozen=True, eq=False)
class Machine:
    """What is fitted: functions, one for each response, and their parameters."""

    path: str  # the specification
    functions: tuple[MachineFunction, ...]
    parameters: tuple[ModelParameter, ...]  # the free ones
    values: Mapping[str, complex]  # of all parameters, as declared; the imaginary unit among them
    identifiability: Identifiability
    definitions: tuple[Derived, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the free parameters."""
        return tuple(p.name for p in self.parameters)

    @property
    def is_logarithmic(self) -> npt.NDArray[np.bool_]:
        """Which parameters are searched for by their logarithms."""
        return np.array([p.assume == "positive" for p in self.parameters])

    @property
    def start(self) -> Real:
        """The declared values of the free parameters."""
        return np.array([float(self.values[name].real) for name in self.names])

    @property
    def priors(self) -> Real:
        """Standard deviation that the spread of each free parameter stands for; infinite without one."""
        return np.array([_prior(p) for p in self.parameters])

    @property
    def _scale(self) -> Real:
        return np.where(self.start == 0, 1.0, np.abs(self.start))

    def theta(self, x: Real) -> Real:
        """Return the parameters at a point of the search, which begins at zero."""
        with np.errstate(over="ignore"):
            moved = self._scale * np.exp(np.where(self.is_logarithmic, x, 0.0))
        return np.where(self.is_logarithmic, moved, self.start + self._scale * x)

    def point(self, theta: Real) -> Real:
        """Return the point of the search where parameters have some values."""
        with np.errstate(all="ignore"):
            logarithm = np.log(theta / self._scale)
        return np.where(self.is_logarithmic, logarithm, (theta - self.start) / self._scale)

    def scales(self, theta: Real) -> Real:
        """Return the derivatives of the parameters by the point of the search."""
        return np.where(self.is_logarithmic, theta, self._scale)

    @property
    def limits(self) -> tuple[Real, Real]:
        """The lowest and the highest point of the search."""
        low, high = np.full(len(self.names), -EDGE), np.full(len(self.names), EDGE)
        is_bounded = np.array([p.assume == "nonnegative" for p in self.parameters])
        low[is_bounded] = -self.start[is_bounded] / self._scale[is_bounded]
        return low, high

    def at(self, response: int, omega: Values, theta: Real) -> tuple[Complex, Complex]:
        """Return a function at angular frequencies, and its derivatives by the parameters, shape (n, p)."""
        spend()
        given = {**self.values, **dict(zip(self.names, theta.tolist(), strict=True))}
        return self.functions[response].gradient(np.asarray(1j * omega, np.complex128), given)


def _prior(parameter: ModelParameter) -> float:
    spread = parameter.spread
    if spread is None or parameter.value is None:
        return np.inf
    if hasattr(spread, "nearly"):
        return float(spread.nearly) / OF_SPREAD or np.inf
    return abs(float(parameter.value.nearly)) * float(spread) / OF_SPREAD or np.inf


@dataclass(frozen=True, eq=False)
class ParameterFit:
    """Fitted parameters of a machine, and everything that is reported of them."""

    machine: Machine
    residual: ResonanceFit  # no resonances, on bases that are the fitted functions
    theta: Real  # the parameters
    covariance: Real  # of them, without what no data determine
    # The directions that no data determine, in parameters over their scales, a row each; a row of these.
    directions: Real
    freedom: int  # numbers measured less numbers determined
    twins: tuple[Real, ...]  # other values with the same function, or ones that fit as well
    are_exact_twins: bool  # whether these have the same function
    starts: tuple[int, int]  # how many led to this minimum, and how many were tried
    warnings: tuple[str, ...] = ()
    poor: tuple[str, ...] = ()
    in_time: tuple[
        str, ...
    ] = ()  # how each response was fitted to its records, in words; empty if it was not

    def __repr__(self) -> str:
        return f"<ParameterFit: {', '.join(self.machine.names)} of {self.machine.path}>"

    @property
    def values(self) -> dict[str, float]:
        """The values by name, in the unit of SI."""
        return dict(zip(self.machine.names, self.theta.tolist(), strict=True))

    @property
    def errors(self) -> Real:
        """Standard errors; infinite for parameters that no data of this kind, or not these, determine."""
        mixed = self.machine.identifiability.mixed
        found = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        # A variance that is not positive is rounding: nothing was measured of the parameter.
        is_lost = ~(np.isfinite(found) & (found > 0)) | (found > LOST * np.abs(self.theta))
        is_lost &= self.theta != 0
        return np.where([name in mixed for name in self.machine.names] | is_lost, np.inf, found)

    @property
    def correlations(self) -> Real:
        """Correlations of the errors, shape (p, p); 0 for what is not determined."""
        size = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        inverse = np.where((size > 0) & np.isfinite(size), 1 / np.where(size > 0, size, 1.0), 0.0)
        shares = np.nan_to_num(self.covariance * np.outer(inverse, inverse))
        return np.asarray(np.clip(shares, -1.0, 1.0), np.float64)

    def interval(self, value: float, error: float, *, is_positive: bool) -> tuple[float, float]:
        """Return the interval of a value that holds the true one in 95 % of cases."""
        reach = float(stdtrit(max(self.freedom, 1), (1 + INTERVAL) / 2))
        if is_positive and value:
            factor = np.exp(min(reach * error / abs(value), 700.0))
            low, high = sorted((value / factor, value * factor))
            return float(low), float(high)
        return value - reach * error, value + reach * error

    def intervals(self) -> list[tuple[float, float]]:
        """Return the interval of each parameter."""
        rows = zip(self.theta.tolist(), self.errors.tolist(), self.machine.is_logarithmic, strict=True)
        found = [self.interval(value, error, is_positive=bool(log)) for value, error, log in rows]
        is_bounded = [p.assume != "real" for p in self.machine.parameters]
        return [
            (max(low, 0.0), high) if b else (low, high)
            for b, (low, high) in zip(is_bounded, found, strict=True)
        ]

    def combinations(self) -> Iterator[tuple[str, float, float]]:
        """Yield what is determined of parameters that are not: expression, value and standard error."""
        known = self.machine.identifiability
        relative = np.asarray(self.covariance / np.outer(self.theta, self.theta), np.float64)
        for exponents in known.combinations:
            powers = np.array(exponents, float)
            value = float(np.prod(self.theta**powers))
            variance = max(float(np.dot(powers @ relative, powers)), 0.0)
            yield known.text(exponents), value, abs(value) * float(np.sqrt(variance))
        for one in known.expressions:
            coefficients = self.machine.functions[one.function].coefficients
            assert coefficients is not None  # of which the expression is a quotient
            values, slopes = coefficients.at(self.theta)
            value = float(values[one.above] / values[one.below])
            row = value * (slopes[one.above] / values[one.above] - slopes[one.below] / values[one.below])
            yield one.text, value, float(np.sqrt(max(float(row @ self.covariance @ row), 0.0)))

    def definitions(self) -> Iterator[tuple[Derived, float, float]]:
        """Yield definitions that depend on free parameters: value and standard error."""
        given: dict[str, complex] = {**self.machine.values, **self.values}
        for one in self.machine.definitions:
            value, slopes = one.gradient(given)
            scaled = slopes * self.directions[-1]
            lost = np.abs(self.directions[:-1] @ scaled)
            is_lost = np.max(lost, initial=0.0) > UNMOVED * np.linalg.norm(scaled)
            error = np.inf if is_lost else float(np.sqrt(max(float(slopes @ self.covariance @ slopes), 0.0)))
            yield one, value, error

    def strong_correlations(self) -> list[tuple[str, str, float]]:
        """Return pairs of determined parameters whose errors hang together, the closest first."""
        names, table, errors = self.machine.names, self.correlations, self.errors
        alone = [n for n, e in zip(names, errors, strict=True) if np.isfinite(e)]
        alone = [n for n in alone if n in self.machine.identifiability.alone]
        pairs = [
            (names[i], names[j], float(table[i, j]))
            for i in range(len(names))
            for j in range(i)
            if abs(table[i, j]) > STRONG and names[i] in alone and names[j] in alone
        ]
        return sorted(pairs, key=lambda pair: -abs(pair[2]))


class _MachineRest:
    """Residuals and derivatives of all responses at a point of the search; the last point is kept."""

    def __init__(self, machine: Machine, problem: FitProblem, *, is_logarithmic: bool = False) -> None:
        self.machine, self.problem, self.is_logarithmic = machine, problem, is_logarithmic
        self.prior = 1 / machine.priors
        self._last: tuple[bytes, list[Values], list[Values]] = (b"", [], [])

    def _at(self, x: Real) -> tuple[list[Values], list[Values]]:
        if self._last[0] == x.tobytes():
            return self._last[1:]
        theta = self.machine.theta(x)
        scales = self.machine.scales(theta)
        residuals: list[Values] = []
        slopes: list[Values] = []
        with np.errstate(all="ignore"):
            for r, line in enumerate(self.problem.lines):
                inside, by_parameters = self.machine.at(r, line.observation.omega, theta)
                model, by_x = line.observation(inside), line.observation(by_parameters * scales)
                rest, steps = self._whitened(line, model, by_x)
                residuals.append(_finite(rest, 1e9))
                slopes.append(_finite(steps, 0.0))
            residuals.append(self.prior * (theta - self.machine.start))
            slopes.append(np.diag(self.prior * scales))
        self._last = x.tobytes(), residuals, slopes
        return residuals, slopes

    def _whitened(self, line: FittedLines, model: Complex, slopes: Complex) -> tuple[Values, Values]:
        measured = line.measured.values
        deviation = np.ones(1) if line.deviation is None else line.deviation
        if self.is_logarithmic:
            size = np.hypot(deviation, CAP)
            rest, steps = np.log(model / measured) / size, slopes / (model * size)[:, None]
            if line.parts == 1:
                return rest.real, steps.real
            return rest, steps
        size = deviation * np.abs(measured)
        if line.parts == 1:
            turn = np.exp(-1j * np.angle(model))[:, np.newaxis]
            return line.rest(model) / size, (slopes * turn).real / size[:, np.newaxis]
        return line.rest(model) / size, slopes / size[:, np.newaxis]

    def residual(self, x: Real) -> list[Values]:
        """Return the residuals of each response, and of priors."""
        return self._at(x)[0]

    def slopes(self, x: Real) -> list[Values]:
        """Return the derivatives of residuals."""
        return self._at(x)[1]

    def reduced(self, x: Real, residuals: list[Values]) -> tuple[Real, Real]:
        """Return a triangle, and its right side, of the linear equations of a step."""
        stacked = np.concatenate([_real(one) for one in self.slopes(x)])
        upper = triangle(np.column_stack((stacked, np.concatenate([_real(one) for one in residuals]))))
        return upper[:, :-1], upper[:, -1]

    def descend(self, x: Real, steps: int = STEPS, tolerance: float = 1e-10) -> Real:
        """Return the minimum that a point leads to."""
        low, high = self.machine.limits
        return search(self.residual, self.reduced, np.clip(x, low, high), (low, high), steps, tolerance)[0]

    def cost(self, x: Real) -> float:
        """Return the sum of squares."""
        return float(sum(np.vdot(one, one).real for one in self.residual(x)))


def _finite(values: Values, large: float) -> Values:
    """Return values with numbers in place of those that are none."""
    finite = np.nan_to_num(values, nan=large, posinf=large, neginf=-large)
    if np.iscomplexobj(finite):
        return np.asarray(finite, np.complex128)
    return np.asarray(finite, np.float64)


def _real(values: Values) -> Real:
    return (
        np.concatenate((values.real, values.imag))
        if np.iscomplexobj(values)
        else np.asarray(values, np.float64)
    )


def fit_parameters(
    measured: Sequence[MeasuredResponse], machine: Machine, hold: str = "auto"
) -> ParameterFit:
    """Fit the free parameters of a machine to a response for each of its functions, or to records in time.

    ``hold`` says how inputs of records run between samples, as :attr:`symflex.options.FitOptions.hold`.
    """
    measured = [_in_unit(one, function) for one, function in zip(measured, machine.functions, strict=True)]
    rank = machine.identifiability.rank
    found = _fit_responses(measured, machine, rank)
    are_records = all(one.samples and all(same.input is not None for same in one.samples) for one in measured)
    return _fit_records(measured, found, hold) if are_records else found


def _fit_responses(measured: Sequence[MeasuredResponse], machine: Machine, rank: int) -> ParameterFit:
    """Fit the free parameters to frequency responses."""
    needed = max(FEWEST_LINES, rank + 2)
    for one in measured:
        if one.values.size < needed:
            message = f"'{one.name}' has {counted(one.values.size, 'line')}; such a fit needs {needed}"
            raise DataError(Diagnostic("SF605", message, None, "measure at more frequencies"))
    problem = with_rough_noise(_problem(measured, machine, machine.start))
    thin = problem.thinned(max(LINES_OF_STARTS // len(measured), FEWEST_LINES))
    x, starts = _best_of_starts(thin, machine)
    x = _MachineRest(machine, problem).descend(x)
    theta = machine.theta(x)
    kept = [np.arange(one.values.size) for one in measured]
    for _ in range(ROUNDS):
        problem = _problem(measured, machine, theta)
        noisy = with_noise(with_rough_noise(problem.at(kept)), None, MOST_LINES)
        x = _MachineRest(machine, noisy).descend(x)
        theta = machine.theta(x)
        problem = _with_base(noisy, machine, theta)
        before, kept = kept, _without_wild(problem)
        if all(np.array_equal(a, b) for a, b in zip(before, kept, strict=True)):
            break
    refined = _refined(problem, machine, x)
    likelihood = lack_of_fit(problem, refined)
    if likelihood >= UNLIKELY and any(line.coherence is None for line in problem.lines):
        values = [line.observation(line.base) for line in problem.lines]
        problem = estimated(problem, values, rank)
        x = _MachineRest(machine, problem).descend(x)
        theta = machine.theta(x)
        problem = _with_base(problem, machine, theta)
        refined = _refined(problem, machine, x)
    if not np.isfinite(_MachineRest(machine, problem).cost(x)):
        raise FitError(
            Diagnostic(
                "SF619",
                "no values of the parameters describe the data",
                None,
                "check the specification and --tf",
            )
        )
    points, are_exact = _twins(problem, machine, x)
    x, *others = sorted(points, key=lambda point: float(np.linalg.norm(point)))  # nearest to what is declared
    theta, twins = machine.theta(x), tuple(map(machine.theta, others[:NAMED_TWINS]))
    covariance, directions = _covariance(problem, machine, x, refined)
    shown = _shown(problem, machine, refined, theta)
    freedom = problem.size - rank
    found = ParameterFit(machine, shown, theta, covariance, directions, freedom, twins, are_exact, starts)
    poor = _poor(found, likelihood)
    if poor and _is_negated(thin, machine, x):
        poor = (OTHER_SIGN, *poor)
    return replace(found, poor=poor, warnings=_warnings(found))


def _in_unit(measured: MeasuredResponse, function: MachineFunction) -> MeasuredResponse:
    """Return a response in the unit of its function; refuse one of another dimension."""
    if not (measured.unit and function.unit):
        return measured
    given, wanted = unit_of(measured.unit), unit_of(function.unit)
    if given.dimension != wanted.dimension:
        message = f"'{measured.name}' is in {measured.unit}, and {function.name} in {function.unit}"
        raise DataError(Diagnostic("SF602", message, None, "choose another function with --tf"))
    factor = float(given.scale / wanted.scale) * np.pi ** (given.pi_power - wanted.pi_power)
    if factor == 1:
        return measured
    samples = tuple(replace(one, output=one.output * factor) for one in measured.samples)
    return replace(measured, values=measured.values * factor, unit=function.unit, samples=samples)


def _problem(measured: Sequence[MeasuredResponse], machine: Machine, theta: Real) -> FitProblem:
    """Return all lines on bases that are the functions at some values, with the deviations of coherence."""

    def base(r: int) -> Callable[[Values], Complex]:
        return lambda omega: machine.at(r, omega, theta)[0]

    problem = fit_problem(measured, [base(r) for r in range(len(measured))], NO_FREE)
    for line, function in zip(problem.lines, machine.functions, strict=True):
        if not (np.isfinite(line.base_at_lines).all() and np.any(line.base_at_lines)):
            message = f"{function.name} is zero or infinite in the band measured, at the declared values"
            raise FitError(Diagnostic("SF615", message, None, "change the values or the --band"))
    usable = [
        replace(
            line,
            base=np.where(line.base == 0, 1.0, line.base),
            base_at_lines=np.where(line.base_at_lines == 0, 1.0, line.base_at_lines),
        )
        for line in problem.lines
    ]
    return replace(problem, lines=tuple(usable))


def _with_base(problem: FitProblem, machine: Machine, theta: Real) -> FitProblem:
    """Return the problem on bases that are the functions at some values."""
    lines = []
    for r, line in enumerate(problem.lines):
        every = line.every
        everywhere = replace(
            every,
            base=machine.at(r, every.observation.omega, theta)[0],
            base_at_lines=machine.at(r, every.omega_seen, theta)[0],
        )
        own = replace(
            line,
            base=machine.at(r, line.observation.omega, theta)[0],
            base_at_lines=machine.at(r, line.omega_seen, theta)[0],
            whole=None if line.whole is None else everywhere,
        )
        lines.append(own)
    return replace(problem, lines=tuple(lines))


def _without_wild(problem: FitProblem) -> list[npt.NDArray[np.int64]]:
    """Return the lines that no wild deviation sets apart."""
    kept = []
    for line in problem.lines:
        every = line.every
        off = np.abs(every.rest(every.observation(every.base))) / line.deviation_of_every()
        off = off / max(float(np.median(off)), 1.0)
        wild = np.flatnonzero(off > WILD)
        kept.append(np.delete(np.arange(every.omega.size), isolated(wild, every.omega.size)))
    return kept


def _best_of_starts(problem: FitProblem, machine: Machine) -> tuple[Real, tuple[int, int]]:
    """Return the best point that starts lead to, and how many led there of how many."""
    rough, exact = _MachineRest(machine, problem, is_logarithmic=True), _MachineRest(machine, problem)
    found: list[tuple[float, Real]] = []
    for i, start in enumerate(_starts(problem, machine)):
        entered_budget().progress.report(0.1, f"start {i + 1}")
        x = exact.descend(rough.descend(start, ROUGH_STEPS, ROUGH), ROUGH_STEPS, ROUGH)
        found.append((exact.cost(x), x))
        best = min(found, key=lambda one: one[0])
        same = [one for one in found if one[0] <= best[0] * (1 + SAME) + SAME]
        if len(same) >= ENOUGH and best[0] < EXPLAINED * problem.size:
            break
    cost, x = min(found, key=lambda one: one[0])
    return x, (sum(one[0] <= cost * (1 + SAME) + SAME for one in found), len(found))


def _starts(problem: FitProblem, machine: Machine) -> Iterator[Real]:
    """Yield points to begin at: the declared values, those of coefficients, random ones around both."""
    size, source = len(machine.names), np.random.default_rng(1)
    begun = [np.zeros(size)]
    yield begun[0]
    for linear in _linear_fits(problem, machine):
        begun.append(_from_coefficients(machine, linear))
        yield begun[-1]
    for i in range(RANDOM_STARTS):
        yield begun[i % len(begun)] + source.uniform(-REACH, REACH, size) * (1 + i // 2)


@dataclass(frozen=True, eq=False)
class _LinearFit:
    """Coefficients of one function by linear least squares."""

    values: Real  # up to a common factor
    weights: Real  # what multiplies them, over these values, in the equations they solve


def _linear_fits(problem: FitProblem, machine: Machine) -> Iterator[list[_LinearFit]]:
    """Yield the coefficients of all functions, from denominators to begin with; none if one has none."""
    if any(f.coefficients is None for f in machine.functions) or any(
        line.parts == 1 for line in problem.lines
    ):
        return
    choices = []
    for line, function in zip(problem.lines, machine.functions, strict=True):
        assert function.coefficients is not None  # asked above
        below = [power for is_below, power in function.coefficients.powers if is_below]
        plain = replace(line, base=np.ones_like(line.base), base_at_lines=np.ones_like(line.base_at_lines))
        alone = replace(problem, lines=(plain,), delays=())
        sets = poles_from_vector_fitting(alone, max(below) - min(below))
        s = np.asarray(1j * line.omega_seen, np.complex128)
        divisors = [
            np.ones(s.size),
            *(_size_of_product(s, poles) * np.abs(s) ** min(below) for poles in sets),
        ]
        choices.append([_linear_fit(line, function.coefficients, divisor) for divisor in divisors])
    for fits in zip(*choices, strict=False):
        usable = [one for one in fits if one is not None]
        if len(usable) == len(fits):
            yield usable


def _size_of_product(s: Complex, poles: Complex) -> Real:
    both = np.concatenate((poles, poles[poles.imag != 0].conj()))
    return np.asarray(np.prod(np.abs(s[:, np.newaxis] - both), axis=1), np.float64)


def _linear_fit(line: FittedLines, coefficients: Coefficients, divisor: Real) -> _LinearFit | None:
    """Return the coefficients after Sanathanan and Koerner's iteration, begun with a denominator."""
    s, values = 1j * line.omega_seen, line.measured.values
    middle = float(np.exp(np.mean(np.log(line.omega))))
    powers = np.array([power for _, power in coefficients.powers])
    is_below = np.array([below for below, _ in coefficients.powers])
    basis = (s[:, np.newaxis] / middle) ** powers
    columns = np.where(is_below, -values[:, np.newaxis] * basis, basis)
    weight = 1 / (np.abs(values) * _deviation(line))
    with np.errstate(all="ignore"):
        for _ in range(SANATHANAN):
            weighted = columns * (weight / (divisor / np.max(divisor)))[:, np.newaxis]
            stacked = triangle(np.concatenate((weighted.real, weighted.imag)))
            scale = np.linalg.norm(stacked, axis=0)
            if not np.isfinite(stacked).all() or not scale.all():
                return None
            _, _, right = np.linalg.svd(stacked / scale)
            solution = right[-1] / scale
            divisor = np.abs(basis[:, is_below] @ solution[is_below])
    if not solution.all():
        return None
    return _LinearFit(solution / middle ** powers.astype(float), stacked * solution)


def _deviation(line: FittedLines) -> Real:
    return np.ones(1) if line.deviation is None else line.deviation


class _CoefficientRest(_MachineRest):
    """Residuals of coefficients: how far they are from being proportional to given ones, or weighted so."""

    def __init__(self, machine: Machine, wanted: Sequence[_LinearFit], *, is_weighted: bool = False) -> None:
        self.machine, self.wanted, self.is_weighted = machine, wanted, is_weighted
        self._last = (b"", [], [])

    def _at(self, x: Real) -> tuple[list[Values], list[Values]]:
        if self._last[0] == x.tobytes():
            return self._last[1:]
        theta = self.machine.theta(x)
        residuals, slopes = [], []
        with np.errstate(all="ignore"):
            for function, wanted in zip(self.machine.functions, self.wanted, strict=True):
                assert function.coefficients is not None  # else there are none wanted
                values, derivatives = function.coefficients.at(theta)
                ratio = values / wanted.values
                steps = derivatives * self.machine.scales(theta) / wanted.values[:, np.newaxis]
                middle, mean_step = np.mean(ratio), steps.mean(axis=0)
                rest = ratio / middle
                steps = steps / middle - np.outer(ratio, mean_step) / middle**2
                if self.is_weighted:
                    rest, steps = wanted.weights @ rest, wanted.weights @ steps
                else:
                    rest = rest - 1
                residuals.append(_finite(rest, 1e9))
                slopes.append(_finite(steps, 0.0))
        self._last = x.tobytes(), residuals, slopes
        return residuals, slopes


def _from_coefficients(machine: Machine, wanted: Sequence[_LinearFit]) -> Real:
    """Return where coefficients, and then the equations that they solve, lead from the declared values."""
    x = _CoefficientRest(machine, wanted).descend(np.zeros(len(machine.names)), 2 * STEPS, 1e-12)
    return _CoefficientRest(machine, wanted, is_weighted=True).descend(x, STEPS, ROUGH)


def _refined(problem: FitProblem, machine: Machine, x: Real) -> Refined:
    """Return residuals at a point in the form of those of a fit of resonances."""
    residuals = _MachineRest(machine, problem).residual(x)[:-1]
    power = float(sum(np.vdot(one, one).real for one in residuals))
    shares = correlation_of(list(residuals), power)
    factor = 1 + 2 * sum(share for share, _ in shares)
    return Refined(
        _no_resonances(problem), True, tuple(residuals), None, factor, machine.identifiability.rank
    )


def _no_resonances(problem: FitProblem) -> Resonances:
    count = len(problem.lines)
    none, empty = np.zeros(0), np.zeros((count, 0))
    return Resonances(none, none, empty, empty, np.ones(count))


def _covariance(problem: FitProblem, machine: Machine, x: Real, refined: Refined) -> tuple[Real, Real]:
    """Return the covariance of the parameters, without the directions that no data determine, and these."""
    parts = _MachineRest(machine, problem)
    slopes = parts.slopes(x)
    insides = [line.base for line in problem.lines]
    sums, shares = sums_of(problem.lines, insides, list(refined.residuals), slopes[:-1])
    prior = np.asarray(slopes[-1], np.float64)
    covariance, directions = sandwich(sums, shares, prior.T @ prior, machine.identifiability.rank)
    scales = machine.scales(machine.theta(x))
    directions[-1] *= scales
    return covariance * np.outer(scales, scales), directions


def _shown(problem: FitProblem, machine: Machine, refined: Refined, theta: Real) -> ResonanceFit:
    """Return the fit as one of no resonances on known bases: for its residual, its report and its figure."""
    none = _no_resonances(problem)

    def base(response: int, function: MachineFunction) -> Base:
        return Base(
            lambda omega: machine.at(response, omega, theta)[0], function.name, machine.path, function.unit
        )

    bases = tuple(base(r, function) for r, function in enumerate(machine.functions))
    candidate = Candidate(0, "none", none, refined, None)
    tests = tuple(not_judged(problem, r, none) for r in range(len(problem.lines)))
    return ResonanceFit(problem, bases, candidate, (), "bic", tests, ())


def _twins(problem: FitProblem, machine: Machine, x: Real) -> tuple[list[Real], bool]:
    """Return a point and others with the same functions, or without coefficients those that fit as well."""
    size, source = len(machine.names), np.random.default_rng(2)
    found = [x]
    if not machine.identifiability.is_complete or size < 2 or np.isfinite(machine.priors).any():  # noqa: PLR2004
        return found, True
    every = [function.coefficients for function in machine.functions]
    if is_exact := all(one is not None for one in every):
        none = np.zeros((0, 0))
        own = [_LinearFit(one.at(machine.theta(x))[0], none) for one in every if one is not None]
        parts: _MachineRest = _CoefficientRest(machine, own)
        accepted, count, tolerance = EQUAL_COEFFICIENTS**2, FAR_STARTS, 1e-14
    else:
        parts = _MachineRest(
            machine, problem.thinned(max(LINES_OF_STARTS // len(problem.lines), FEWEST_LINES))
        )
        accepted, count, tolerance = parts.cost(parts.descend(x)) + EQUAL, FEW_STARTS, ROUGH
    for i in range(count):
        start = x + source.uniform(-1, 1, size) * (FAR if i % 2 and is_exact else NEAR)
        other = parts.descend(start, STEPS, tolerance)
        least = SAME if is_exact else APART
        if parts.cost(other) <= accepted and all(np.max(np.abs(other - one)) > least for one in found):
            found.append(other)
    return found, is_exact


@dataclass(frozen=True, eq=False)
class _Record:
    """Samples of an output of a machine, and what is assumed of them."""

    response: int  # number of the function
    samples: Samples
    is_joined: bool  # whether lines join the samples of the input; else each is held to the next
    begins: str  # a key of BEGINNINGS
    whitening: Real  # coefficients of the regression that whitens the noise
    deviation: float  # of what that leaves

    @property
    def kept(self) -> npt.NDArray[np.bool_]:
        """Which samples count."""
        kept = np.ones(self.samples.output.size, bool)
        kept[: self.whitening.size - 1] = False
        return kept if self.samples.is_missing is None else kept & ~self.samples.is_missing

    def whitened(self, values: Real) -> Real:
        """Return what samples leave after the regression, over its deviation; shape (n, ...) to (k, ...)."""
        from scipy.signal import lfilter  # takes a second, and fits to responses need none of it

        return np.asarray(
            lfilter(self.whitening, 1.0, values, axis=0)[self.kept] / self.deviation, np.float64
        )

    def disturbance(self, pulse: PulseResponse) -> Real:
        """Return the columns of an offset, and of a state to begin with if that is open."""
        offset = np.ones((self.samples.output.size, 1))
        free = pulse.free if self.begins == "free" else pulse.free[:, :0]
        scale = np.maximum(np.abs(free).max(axis=0, initial=0.0), np.finfo(float).tiny)
        return np.concatenate((offset, free / scale), axis=1)


BEGINNINGS: Final = {
    "rest": "it begins at rest, with the input at zero before",
    "level": "it begins at rest, with the input as on the first sample",
    "free": "the state that it begins with is fitted",
}


class _RecordRest(_MachineRest):
    """Residuals of records in time, without what an offset and a state to begin with explain."""

    def __init__(self, machine: Machine, records: Sequence[_Record]) -> None:
        self.machine, self.records = machine, records
        self.prior = 1 / machine.priors
        self._last = (b"", [], [])
        self._finer: dict[int, int] = {}

    def pulse(self, record: _Record, theta: Real) -> PulseResponse:
        """Return the response to one sample of an input; no numbers where the function has none."""
        machine, samples = self.machine, record.samples
        function, count = machine.functions[record.response], samples.output.size
        if function.coefficients is not None:
            made = of_coefficients(
                function.coefficients, theta, samples.step_s, count, is_joined=record.is_joined
            )
        else:

            def response(finer: int) -> PulseResponse | None:
                return of_function(
                    lambda s: machine.at(record.response, -1j * s, theta),
                    samples.step_s,
                    count,
                    finer,
                    is_joined=record.is_joined,
                )

            if record.response not in self._finer:
                self._finer[record.response] = terms_for(response, count)
            made = response(self._finer[record.response])
        if made is None:
            nothing = np.full(count, np.nan)
            made = PulseResponse(nothing, np.full((count, theta.size), np.nan), np.zeros((count, 0)))
        return made

    def model(self, record: _Record, theta: Real) -> tuple[Real, Real, Real]:
        """Return output and derivatives by parameters, and the columns of disturbances; not whitened."""
        from scipy.signal import fftconvolve  # as above

        pulse, u = self.pulse(record, theta), record.samples.input
        assert u is not None  # only driven records are fitted
        driven = u - u[0] if record.begins == "level" else u
        both = np.column_stack((pulse.values, pulse.slopes))
        output = fftconvolve(driven[:, np.newaxis], both, axes=0)[: driven.size]
        return output[:, 0], output[:, 1:], record.disturbance(pulse)

    def left(self, record: _Record, theta: Real) -> Real:
        """Return what the model and the best disturbances leave of the samples; not whitened."""
        output, _, columns = self.model(record, theta)
        rest = record.samples.output - output
        solved = np.linalg.lstsq(record.whitened(columns), record.whitened(rest), rcond=None)[0]
        return np.asarray(rest - columns @ solved, np.float64)

    def _at(self, x: Real) -> tuple[list[Values], list[Values]]:
        if self._last[0] == x.tobytes():
            return self._last[1:]
        theta = self.machine.theta(x)
        scales = self.machine.scales(theta)
        residuals: list[Values] = []
        slopes: list[Values] = []
        with np.errstate(all="ignore"):
            for record in self.records:
                output, by_parameters, columns = self.model(record, theta)
                rest = record.whitened(output - record.samples.output)
                steps = record.whitened(by_parameters * scales)
                before = record.whitened(columns)
                if all(np.isfinite(one).all() for one in (rest, steps, before)):
                    basis = np.linalg.qr(before)[0]
                    rest, steps = (one - basis @ (basis.T @ one) for one in (rest, steps))
                else:  # an unstable response has grown beyond all numbers
                    rest, steps = np.full_like(rest, np.nan), np.zeros_like(steps)
                residuals.append(_finite(rest, 1e9))
                slopes.append(_finite(steps, 0.0))
            residuals.append(self.prior * (theta - self.machine.start))
            slopes.append(np.diag(self.prior * scales))
        self._last = x.tobytes(), residuals, slopes
        return residuals, slopes


def _fit_records(measured: Sequence[MeasuredResponse], begun: ParameterFit, hold: str) -> ParameterFit:
    """Fit the free parameters to records in time, from what their frequency responses gave."""
    machine = begun.machine
    starts = [machine.point(begun.theta), np.zeros(len(machine.names))]
    chosen: tuple[float, Real, list[_Record]] | None = None
    for is_joined in _holds(measured, hold):
        for begins in BEGINNINGS:
            records = [
                _Record(r, same, is_joined, begins, np.ones(1), float(np.std(same.output)) or 1.0)
                for r, one in enumerate(measured)
                for same in one.samples
            ]
            rest = _RecordRest(machine, records)
            low, high = machine.limits
            points = [rest.descend(np.clip(start, low, high), ROUGH_STEPS, ROUGH) for start in starts]
            x = min(points, key=rest.cost)
            terms = sum(
                record.disturbance(rest.pulse(record, machine.theta(x))).shape[1] for record in records
            )
            count = sum(record.kept.sum() for record in records)
            score = count * np.log(max(rest.cost(x), np.finfo(float).tiny) / count) + terms * np.log(count)
            if chosen is None or score < chosen[0]:
                chosen = score, x, records
    assert chosen is not None  # there are beginnings
    _, x, records = chosen
    for record in records:
        if not np.isfinite(_RecordRest(machine, records).pulse(record, machine.theta(x)).values).all():
            name = machine.functions[record.response].name
            message = f"{name} does not fall towards high frequencies: it has no response in time"
            raise FitError(Diagnostic("SF619", message, None, "fit its frequency response: --segments 8"))
    if all(function.coefficients is not None for function in machine.functions):
        x = _best_of_random(_RecordRest(machine, records), x, starts)
    for _ in range(COLOURED):
        rest = _RecordRest(machine, records)
        left = [rest.left(record, machine.theta(x)) for record in records]
        records = [_coloured(record, values) for record, values in zip(records, left, strict=True)]
        x = _RecordRest(machine, records).descend(x)
    return _in_time(measured, begun, records, x)


def _best_of_random(rest: _RecordRest, x: Real, starts: Sequence[Real]) -> Real:
    """Return the best of a point and of those that random starts lead to."""
    source, found = np.random.default_rng(3), [(rest.cost(x), x)]
    for i in range(RANDOM_STARTS):
        start = starts[i % len(starts)] + source.uniform(-REACH, REACH, x.size) * (1 + i // 2)
        low, high = rest.machine.limits
        other = rest.descend(np.clip(start, low, high), ROUGH_STEPS, ROUGH)
        found.append((rest.cost(other), other))
    return min(found, key=lambda one: one[0])[1]


def _holds(measured: Sequence[MeasuredResponse], hold: str) -> tuple[bool, ...]:
    """Return whether lines may join the samples of the inputs: not where these show that they are held."""
    if hold != "auto":
        return (hold != "held",)
    inputs = [same.input for one in measured for same in one.samples if same.input is not None]
    return (False,) if all(map(is_held, inputs)) else (False, True)


def _coloured(record: _Record, left: Real) -> _Record:
    """Return a record with the noise that its residual shows."""
    if record.samples.is_missing is not None:
        return replace(record, deviation=float(np.std(left[record.kept])) or 1.0)
    whitening, variance = autoregression(left)
    return replace(record, whitening=whitening, deviation=float(np.sqrt(variance)))


def _in_time(
    measured: Sequence[MeasuredResponse], begun: ParameterFit, records: Sequence[_Record], x: Real
) -> ParameterFit:
    """Return a fit to records at its minimum, with its errors and its report."""
    machine, rank = begun.machine, begun.machine.identifiability.rank
    problem = begun.residual.problem
    points, are_exact = _twins(problem, machine, x) if begun.are_exact_twins else ([x], True)
    x, *others = sorted(points, key=lambda point: float(np.linalg.norm(point)))
    theta = machine.theta(x)
    rest = _RecordRest(machine, records)
    residuals, slopes = rest.residual(x), rest.slopes(x)
    stacked = np.concatenate([_real(one) for one in residuals[:-1]])
    sums = Sums(len(machine.names), stacked.size, float(stacked @ stacked))
    for one in slopes[:-1]:
        sums.add(np.arange(len(machine.names)), one, None, 0)
    prior = np.asarray(slopes[-1], np.float64)
    covariance, directions = sandwich(sums, [], prior.T @ prior, rank)
    scales = machine.scales(theta)
    directions[-1] *= scales
    problem = _with_base(problem, machine, theta)
    shown = _shown(problem, machine, _refined(problem, machine, x), theta)
    words, poor, warnings = [], [], []
    for record in records:
        left, output = rest.left(record, theta), record.samples.output
        share = float(np.std(left) / np.std(output)) if np.std(output) else 0.0
        held = "joined by lines" if record.is_joined else "held between samples"
        noise = "white noise" if record.whitening.size == 1 else f"noise of order {record.whitening.size - 1}"
        words.append(
            f"in time: {output.size} samples, {record.samples.step_s:.6g} s apart; the input is {held}; "
            f"{BEGINNINGS[record.begins]}; residual {100 * share:.3g} % rms, {noise}"
        )
        name = measured[record.response].name
        if _follows(record, record.whitened(left), rank):
            poor.append(f"what is left of {name} follows the input: the specification lacks something")
        if (error := rest.pulse(record, theta).error) > SAME:
            warnings.append(f"the response of {name} in time is computed to {100 * error:.1g} % only")
    found = replace(
        begun,
        residual=shown,
        theta=theta,
        covariance=covariance * np.outer(scales, scales),
        directions=directions,
        freedom=stacked.size - rank,
        twins=tuple(map(machine.theta, others[:NAMED_TWINS])),
        are_exact_twins=are_exact,
        in_time=tuple(words),
    )
    kept = [reason for reason in begun.poor if reason == OTHER_SIGN]
    poor += _contradicted(found)
    return replace(found, poor=(*kept, *poor), warnings=(*warnings, *_warnings(found)))


def _follows(record: _Record, left: Real, rank: int) -> bool:
    """Return whether what a model leaves correlates with the input (Ljung 1999, section 16.6)."""
    from scipy.signal import lfilter  # as above

    u = record.samples.input
    assert u is not None  # only driven records are fitted
    source, variance = autoregression(u - u.mean())
    driving = lfilter(source, 1.0, u - u.mean())[record.kept] / np.sqrt(variance)
    lags = min(MOST_LAGS, left.size // 8)
    size = np.std(left) * np.std(driving) * np.sqrt(left.size)
    if not size > 0:
        return False
    shares = [float(left[lag:] @ driving[: left.size - lag]) / size for lag in range(lags)]
    return float(chdtrc(max(lags - rank, 1), float(np.sum(np.square(shares))))) < UNLIKELY


def _is_negated(thin: FitProblem, machine: Machine, x: Real) -> bool:
    """Return whether data of the other sign leave a tenth of the residual, or less."""
    lines = [
        replace(line, measured=replace(line.measured, values=-line.measured.values), whole=None)
        for line in thin.lines
    ]
    negated = replace(thin, lines=tuple(lines))
    other, _ = _best_of_starts(negated, machine)
    return _MachineRest(machine, negated).cost(other) < 0.01 * _MachineRest(machine, thin).cost(x)


def _poor(fit: ParameterFit, likelihood: float) -> tuple[str, ...]:
    """Return why the specification does not describe the data."""
    shown, reasons = fit.residual, []
    problem, refined = shown.problem, shown.refined
    if problem.is_noise_known and refined.reduced > LARGE:
        reasons.append(f"the residual is {np.sqrt(refined.reduced):.2g} times what the coherence predicts")
    elif likelihood < UNLIKELY and not shown.leaves_rounding:
        reasons.append("a function with more poles describes the data far better than noise explains")
    if refined.correlation > SMOOTH and not shown.leaves_rounding:
        reasons.append("neighbouring lines deviate together: the specification lacks something")
    return (*reasons, *_contradicted(fit))


def _contradicted(fit: ParameterFit) -> list[str]:
    """Return which spreads the data contradict."""
    reasons = []
    for p, value, prior in zip(fit.machine.parameters, fit.theta, fit.machine.priors, strict=True):
        off = abs(value - fit.machine.values[p.name]) / prior
        if off > CONTRADICTED:
            reasons.append(f"{p.name} is {off:.2g} standard deviations from what its spread says")
    return reasons


def _warnings(fit: ParameterFit) -> tuple[str, ...]:
    """Return what to be careful about."""
    low, high = (end / (2 * np.pi) for end in fit.residual.problem.band)
    said = said_of_units(fit.residual, "specification")
    for r in range(len(fit.residual.measured)):
        excluded = fit.residual.left_out(r)
        if excluded.size and not fit.in_time:
            places = ", ".join(f"{f:.6g}" for f in fit.residual.measured[r].frequency_hz[excluded][:6])
            said.append(
                f"{counted(excluded.size, 'outlier')}{fit.residual.of_response(r)} left out, at {places} Hz"
            )
    for p, value, error in zip(fit.machine.parameters, fit.theta, fit.errors, strict=True):
        if value and np.isfinite(error) and error > WEAK * abs(value):
            reach = f"{error / abs(value):.2g} times its value"
            said.append(
                f"{p.name} is not determined: its standard error is {reach}; from {low:.4g} to {high:.4g} Hz "
                "the response hardly depends on it"
            )
        if not np.isfinite(error) and p.name in fit.machine.identifiability.alone:
            where = f"from {low:.4g} to {high:.4g} Hz"
            said.append(f"{p.name} is not determined: with these values nothing depends on it {where}")
        if p.assume == "nonnegative" and value == 0:
            said.append(f"{p.name} is zero, its bound: its error says how large it may be")
    for a, b, share in fit.strong_correlations():
        digits = max(3, 1 - int(np.floor(np.log10(max(1 - abs(share), 1e-9)))))
        said.append(f"the errors of {a} and {b} hang together: their correlation is {share:.{digits}f}")
    return tuple(said)


def refuse_free(names: Sequence[str], known: Mapping[str, ModelParameter], defined: Sequence[str]) -> None:
    """Refuse names that are no parameters or come twice, SF902, and values used at rest, SF801."""
    if not names:
        raise refused("--model needs --free, the parameters to fit", f"parameters: {', '.join(known)}")
    for name in names:
        if name in defined:
            raise refused(
                f"'{name}' is a definition, not a parameter", "free the parameters that it depends on"
            )
        if name not in known:
            raise no_such("parameter", name, known)
        check_free(known[name])
        if names.count(name) > 1:
            raise refused(f"'{name}' is given twice in --free")
