"""Where searches for parameters begin, and which other values have the same functions.

Input: a problem and its machine. Output: the best point that starts lead to.

Starts are the declared values, for rational functions those of coefficients found by linear least squares
(Sanathanan & Koerner 1963), and random ones around both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symflex.budget import entered_budget
from symflex.data.fitting.fit import FEWEST_LINES
from symflex.data.fitting.identifiable import Coefficients
from symflex.data.fitting.least_squares import triangle
from symflex.data.fitting.machine import Machine
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.parameter_residual import (
    ROUGH,
    ROUGH_STEPS,
    STEPS,
    ParameterResidual,
    ResponseResidual,
)
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Complex, Real, Values
from symflex.data.fitting.starts import poles_from_vector_fitting

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


def best_of_starts(problem: FitProblem, machine: Machine) -> tuple[Real, tuple[int, int]]:
    """Return the best point that starts lead to, and how many led there of how many."""
    rough, exact = ResponseResidual(machine, problem, is_logarithmic=True), ResponseResidual(machine, problem)
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


class _CoefficientResidual(ParameterResidual):
    """Residuals of coefficients: how far they are from being proportional to given ones, or weighted so."""

    has_priors = False

    def __init__(self, machine: Machine, wanted: Sequence[_LinearFit], *, is_weighted: bool = False) -> None:
        super().__init__(machine)
        self.wanted, self.is_weighted = wanted, is_weighted

    def parts(self, theta: Real, scales: Real) -> Iterator[tuple[Values, Values]]:
        """Yield residuals and derivatives of the coefficients of each function."""
        for function, wanted in zip(self.machine.functions, self.wanted, strict=True):
            assert function.coefficients is not None  # else there are none wanted
            values, derivatives = function.coefficients.at(theta)
            ratio = values / wanted.values
            steps = derivatives * scales / wanted.values[:, np.newaxis]
            middle, mean_step = np.mean(ratio), steps.mean(axis=0)
            rest = ratio / middle
            steps = steps / middle - np.outer(ratio, mean_step) / middle**2
            if self.is_weighted:
                yield wanted.weights @ rest, wanted.weights @ steps
            else:
                yield rest - 1, steps


def _from_coefficients(machine: Machine, wanted: Sequence[_LinearFit]) -> Real:
    """Return where coefficients, and then the equations that they solve, lead from the declared values."""
    x = _CoefficientResidual(machine, wanted).descend(np.zeros(len(machine.names)), 2 * STEPS, 1e-12)
    return _CoefficientResidual(machine, wanted, is_weighted=True).descend(x, STEPS, ROUGH)


def twins_of(problem: FitProblem, machine: Machine, x: Real) -> tuple[list[Real], bool]:
    """Return a point and others with the same functions, or without coefficients those that fit as well."""
    size, source = len(machine.names), np.random.default_rng(2)
    found = [x]
    if not machine.identifiability.is_complete or size < 2 or np.isfinite(machine.priors).any():  # noqa: PLR2004
        return found, True
    every = [function.coefficients for function in machine.functions]
    if is_exact := all(one is not None for one in every):
        none = np.zeros((0, 0))
        own = [_LinearFit(one.at(machine.theta(x))[0], none) for one in every if one is not None]
        parts: ParameterResidual = _CoefficientResidual(machine, own)
        accepted, count, tolerance = EQUAL_COEFFICIENTS**2, FAR_STARTS, 1e-14
    else:
        parts = ResponseResidual(
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
