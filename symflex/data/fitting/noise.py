"""The noise of lines without coherence, estimated from what a function without structure leaves of them.

A rational function with more poles than are looked for, and powers of s of its own, follows whatever a
laboratory measures; what it leaves is noise. Its variance is described by nonnegative shares of the
response's own power, as multiplicative errors and leakage have it, and of powers of the frequency, as sensors
that are integrated or differentiated have them. The shares are those of greatest likelihood for complex
Gaussian errors, found by multiplicative steps that never lower it (Fevotte & Idier, Neural Computation 23(9),
2011: the Itakura-Saito divergence).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.data.fitting.rational_start import generous_fit

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FitProblem

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

STEPS = 60
POWERS = (0, 2, 4, -2, -4)
LEAST = 1e-6
"""Relative deviation below which no line is taken to be known: that of six digits in a file."""
MOST_PAIRS = 14
LINES_PER_PARAMETER = 2.0
PATIENCE = 2
FEWEST = 5


@dataclass(frozen=True, slots=True)
class Reference:
    """How well a function without structure describes the lines: its sum of squares and its parameters."""

    cost: float
    parameters: int


def with_rough_noise(problem: FitProblem) -> FitProblem:
    """Return the problem with deviations guessed from how lines differ from their neighbours' line.

    Curvature of peaks is taken for noise too, so that these only weigh less than they might; lines that noise
    drowns no longer weigh as if they were exact.
    """
    lines = []
    for line in problem.lines:
        if line.deviation is not None or line.omega.size < FEWEST:
            lines.append(line)
            continue
        x, y = line.omega, line.measured.values
        share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
        between = y[1:-1] - (1 - share) * y[:-2] - share * y[2:]
        power = np.abs(between) ** 2 / (2 * (1 + share**2 + (1 - share) ** 2))
        size = np.abs(y)
        variance = _variance(np.pad(power, 1, mode="edge"), x, size)
        lines.append(replace(line, deviation=np.maximum(np.sqrt(variance) / size, LEAST)))
    return replace(problem, lines=tuple(lines))


def with_noise(problem: FitProblem, count: int | None) -> FitProblem:
    """Return the problem with deviations estimated for the lines that have no coherence.

    Parameters
    ----------
    problem : FitProblem
        With rough deviations, and dead times to begin with.
    count : int or None
        How many resonances are looked for, None when that is open.
    """
    if all(line.measured.coherence is not None for line in problem.lines):
        return problem
    size = 2 * problem.count
    best: tuple[float, list[Complex], int] | None = None
    worse = 0
    for pairs in range(1 if count is None else count, MOST_PAIRS if count is None else count + 3):
        values, parameters = generous_fit(problem, pairs)
        if parameters * LINES_PER_PARAMETER > size and best is not None:
            break
        rest = 0.0
        for v, line in zip(values, problem.lines, strict=True):
            scale = 1.0 if line.deviation is None else line.deviation
            rest += float(np.sum(np.abs((v / line.measured.values - 1) / scale) ** 2))
        score = size * np.log(max(rest, LEAST * size)) + parameters * np.log(size)
        if best is None or score < best[0]:
            best, worse = (float(score), values, parameters), 0
        else:
            worse += 1
        if worse > PATIENCE:
            break
    return problem if best is None else estimated(problem, best[1], best[2])


def estimated(problem: FitProblem, values: list[Complex], parameters: int) -> FitProblem:
    """Return the problem with deviations of what these values leave, and how well they describe the lines."""
    freedom = max(1 - parameters / (2 * problem.count), 0.2)
    lines, cost = [], 0.0
    for model, line in zip(values, problem.lines, strict=True):
        deviation = line.deviation
        if deviation is None or line.measured.coherence is None:
            power = np.abs(model - line.measured.values) ** 2 / 2
            variance = _variance(power, line.omega, np.abs(model)) / freedom
            size = np.abs(line.measured.values)
            deviation = np.maximum(np.sqrt(variance) / size, LEAST)
        lines.append(replace(line, deviation=deviation))
        rest = np.abs(model - line.measured.values) / (deviation * np.abs(line.measured.values))
        cost += float(np.sum(rest**2))
    return replace(
        problem, lines=tuple(lines), is_noise_estimated=True, reference=Reference(cost, parameters)
    )


def _variance(power: Real, omega: Real, size: Real) -> Real:
    """Return the smooth expectation of the power of each part on every line."""
    x = omega / np.exp(np.mean(np.log(omega)))
    shapes = np.stack([size**2, *(x ** float(p) for p in POWERS)])
    shapes = shapes / np.mean(shapes, axis=1, keepdims=True)
    floor = max(float(np.mean(power)) * 1e-12, np.finfo(float).tiny)
    power = np.maximum(power, floor)
    shares = np.full(shapes.shape[0], float(np.mean(power)) / shapes.shape[0])
    for _ in range(STEPS):
        expected = shares @ shapes
        shares = shares * np.sqrt((shapes @ (power / expected**2)) / (shapes @ (1 / expected)))
    return np.asarray(shares @ shapes, np.float64)
