"""What a machine leaves of measured responses, and its derivatives: what a search makes small.

Input: the lines of a problem, and a machine. Output: residuals of each response and of the priors.

The residual is that of a fit of resonances: model less data, over the standard deviation of each line, which
coherence tells or a function without structure leaves (:mod:`symflex.data.fitting.noise`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from symflex.data.fitting.fit import Base, ResonanceFit
from symflex.data.fitting.least_squares import Refined, correlation_of, search, triangle
from symflex.data.fitting.lines import CAP
from symflex.data.fitting.machine import Machine, MachineFunction
from symflex.data.fitting.minimum_phase import not_judged
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.order import Candidate
from symflex.data.fitting.problem import FitProblem, fit_problem
from symflex.data.fitting.resonances import Complex, Free, Real, Resonances, Values
from symflex.data.measurement import MeasuredResponse
from symflex.errors import Diagnostic, FitError

STEPS, ROUGH_STEPS, ROUGH = 80, 30, 1e-4  # of a search to the end, of one from any start; tolerance of that
NO_FREE = Free()


class ParameterResidual(ABC):
    """Residuals and derivatives at a point of the search; the last point is kept."""

    machine: Machine
    has_priors = True

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._last: tuple[bytes, list[Values], list[Values]] = (b"", [], [])

    @abstractmethod
    def parts(self, theta: Real, scales: Real) -> Iterator[tuple[Values, Values]]:
        """Yield residuals of each part of the data, and their derivatives by the point of the search."""

    def _at(self, x: Real) -> tuple[list[Values], list[Values]]:
        if self._last[0] == x.tobytes():
            return self._last[1:]
        theta = self.machine.theta(x)
        scales = self.machine.scales(theta)
        residuals: list[Values] = []
        slopes: list[Values] = []
        with np.errstate(all="ignore"):
            for rest, steps in self.parts(theta, scales):
                residuals.append(_finite(rest, 1e9))
                slopes.append(_finite(steps, 0.0))
            if self.has_priors:
                weight = 1 / self.machine.priors
                residuals.append(weight * (theta - self.machine.start))
                slopes.append(np.diag(weight * scales))
        self._last = x.tobytes(), residuals, slopes
        return residuals, slopes

    def residual(self, x: Real) -> list[Values]:
        """Return the residuals of each response, and of priors."""
        return self._at(x)[0]

    def slopes(self, x: Real) -> list[Values]:
        """Return the derivatives of residuals."""
        return self._at(x)[1]

    def reduced(self, x: Real, residuals: list[Values]) -> tuple[Real, Real]:
        """Return a triangle, and its right side, of the linear equations of a step."""
        stacked = np.concatenate([real_parts(one) for one in self.slopes(x)])
        upper = triangle(np.column_stack((stacked, np.concatenate([real_parts(one) for one in residuals]))))
        return upper[:, :-1], upper[:, -1]

    def descend(self, x: Real, steps: int = STEPS, tolerance: float = 1e-10) -> Real:
        """Return the minimum that a point leads to."""
        low, high = self.machine.limits
        return search(self.residual, self.reduced, np.clip(x, low, high), (low, high), steps, tolerance)[0]

    def cost(self, x: Real) -> float:
        """Return the sum of squares."""
        return float(sum(np.vdot(one, one).real for one in self.residual(x)))


class ResponseResidual(ParameterResidual):
    """Residuals of measured responses, or of their logarithms."""

    def __init__(self, machine: Machine, problem: FitProblem, *, is_logarithmic: bool = False) -> None:
        super().__init__(machine)
        self.problem, self.is_logarithmic = problem, is_logarithmic

    def parts(self, theta: Real, scales: Real) -> Iterator[tuple[Values, Values]]:
        """Yield residuals and derivatives of each response."""
        for r, line in enumerate(self.problem.lines):
            inside, by_parameters = self.machine.at(r, line.observation.omega, theta)
            yield self._whitened(line, line.observation(inside), line.observation(by_parameters * scales))

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


def _finite(values: Values, large: float) -> Values:
    """Return values with numbers in place of those that are none."""
    finite = np.nan_to_num(values, nan=large, posinf=large, neginf=-large)
    if np.iscomplexobj(finite):
        return np.asarray(finite, np.complex128)
    return np.asarray(finite, np.float64)


def real_parts(values: Values) -> Real:
    """Return real numbers: real parts, then imaginary ones."""
    return (
        np.concatenate((values.real, values.imag))
        if np.iscomplexobj(values)
        else np.asarray(values, np.float64)
    )


def problem_at(measured: Sequence[MeasuredResponse], machine: Machine, theta: Real) -> FitProblem:
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


def with_base(problem: FitProblem, machine: Machine, theta: Real) -> FitProblem:
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


def refined_at(problem: FitProblem, machine: Machine, x: Real) -> Refined:
    """Return residuals at a point in the form of those of a fit of resonances."""
    residuals = ResponseResidual(machine, problem).residual(x)[:-1]
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


def shown_at(problem: FitProblem, machine: Machine, refined: Refined, theta: Real) -> ResonanceFit:
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
