"""Parameters of a machine, fitted to measured responses or to records: values, errors and correlations.

Input: measured responses, and the machine that they are of. Output: a fit.

Example: force and motion of a mass m on a spring k. ``k/m`` is the square of a resonance and ``1/k`` the
response at rest, so both follow, k with the relative error of the lines at low frequency.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from symflex.data.fitting.fit import FEWEST_LINES, MOST_LINES, ROUNDS, WILD
from symflex.data.fitting.least_squares import Refined, sandwich, sums_of
from symflex.data.fitting.lines import isolated
from symflex.data.fitting.machine import Machine, MachineFunction
from symflex.data.fitting.noise import estimated, with_noise, with_rough_noise
from symflex.data.fitting.order import UNLIKELY, lack_of_fit
from symflex.data.fitting.parameter_fit import ParameterFit, poor_for, warnings_of
from symflex.data.fitting.parameter_records import NAMED_TWINS, OTHER_SIGN, fit_records
from symflex.data.fitting.parameter_residual import (
    ResponseResidual,
    problem_at,
    refined_at,
    shown_at,
    with_base,
)
from symflex.data.fitting.parameter_starts import LINES_OF_STARTS, best_of_starts, twins_of
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Real
from symflex.data.measurement import MeasuredResponse
from symflex.errors import DataError, Diagnostic, FitError, counted
from symflex.quantities import unit_of


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
    return fit_records(measured, found, hold) if are_records else found


def _fit_responses(measured: Sequence[MeasuredResponse], machine: Machine, rank: int) -> ParameterFit:
    """Fit the free parameters to frequency responses."""
    needed = max(FEWEST_LINES, rank + 2)
    for one in measured:
        if one.values.size < needed:
            message = f"'{one.name}' has {counted(one.values.size, 'line')}; such a fit needs {needed}"
            raise DataError(Diagnostic("SF605", message, None, "measure at more frequencies"))
    problem = with_rough_noise(problem_at(measured, machine, machine.start))
    thin = problem.thinned(max(LINES_OF_STARTS // len(measured), FEWEST_LINES))
    x, starts = best_of_starts(thin, machine)
    x = ResponseResidual(machine, problem).descend(x)
    theta = machine.theta(x)
    kept = [np.arange(one.values.size) for one in measured]
    for _ in range(ROUNDS):
        problem = problem_at(measured, machine, theta)
        noisy = with_noise(with_rough_noise(problem.at(kept)), None, MOST_LINES)
        x = ResponseResidual(machine, noisy).descend(x)
        theta = machine.theta(x)
        problem = with_base(noisy, machine, theta)
        before, kept = kept, _without_wild(problem)
        if all(np.array_equal(a, b) for a, b in zip(before, kept, strict=True)):
            break
    refined = refined_at(problem, machine, x)
    likelihood = lack_of_fit(problem, refined)
    if likelihood >= UNLIKELY and any(line.coherence is None for line in problem.lines):
        values = [line.observation(line.base) for line in problem.lines]
        problem = estimated(problem, values, rank)
        x = ResponseResidual(machine, problem).descend(x)
        theta = machine.theta(x)
        problem = with_base(problem, machine, theta)
        refined = refined_at(problem, machine, x)
    if not np.isfinite(ResponseResidual(machine, problem).cost(x)):
        raise FitError(
            Diagnostic(
                "SF619",
                "no values of the parameters describe the data",
                None,
                "check the specification and --tf",
            )
        )
    points, are_exact = twins_of(problem, machine, x)
    x, *others = sorted(points, key=lambda point: float(np.linalg.norm(point)))  # nearest to what is declared
    theta, twins = machine.theta(x), tuple(map(machine.theta, others[:NAMED_TWINS]))
    covariance, directions = _covariance(problem, machine, x, refined)
    shown = shown_at(problem, machine, refined, theta)
    freedom = problem.size - rank
    found = ParameterFit(machine, shown, theta, covariance, directions, freedom, twins, are_exact, starts)
    poor = poor_for(found, likelihood)
    if poor and _is_negated(thin, machine, x):
        poor = (OTHER_SIGN, *poor)
    return replace(found, poor=poor, warnings=warnings_of(found))


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


def _covariance(problem: FitProblem, machine: Machine, x: Real, refined: Refined) -> tuple[Real, Real]:
    """Return the covariance of the parameters, without the directions that no data determine, and these."""
    parts = ResponseResidual(machine, problem)
    slopes = parts.slopes(x)
    insides = [line.base for line in problem.lines]
    sums, shares = sums_of(problem.lines, insides, list(refined.residuals), slopes[:-1])
    prior = np.asarray(slopes[-1], np.float64)
    covariance, directions = sandwich(sums, shares, prior.T @ prior, machine.identifiability.rank)
    scales = machine.scales(machine.theta(x))
    directions[-1] *= scales
    return covariance * np.outer(scales, scales), directions


def _is_negated(thin: FitProblem, machine: Machine, x: Real) -> bool:
    """Return whether data of the other sign leave a tenth of the residual, or less."""
    lines = [
        replace(line, measured=replace(line.measured, values=-line.measured.values), whole=None)
        for line in thin.lines
    ]
    negated = replace(thin, lines=tuple(lines))
    other, _ = best_of_starts(negated, machine)
    return ResponseResidual(machine, negated).cost(other) < 0.01 * ResponseResidual(machine, thin).cost(x)
