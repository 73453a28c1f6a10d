"""How accurate measured lines are, where no coherence says so.

The noise is estimated from what a function without structure leaves of the lines. A
rational function with more poles than are looked for, and powers of s of its own, follows whatever a
laboratory measures; what it leaves is noise. Its variance is described by nonnegative shares of the
response's own power, as multiplicative errors and leakage have it, and of powers of the frequency, as sensors
that are integrated or differentiated have them. The shares are those of greatest likelihood for complex
Gaussian errors, found by multiplicative steps that never lower it (Fevotte & Idier, Neural Computation 23(9),
2011: the Itakura-Saito divergence).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from symflex.data.fitting.lines import written_step
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.problem import FitProblem, StructurelessFit
from symflex.data.fitting.resonances import Complex, Real
from symflex.data.fitting.starts import generous_fit

STEPS = 60  # multiplicative steps for the shares of the variance; none of them makes it worse
POWERS = (0, 2, 4, -2, -4)  # powers of the frequency that describe the variance of the noise
LEAST = 1e-9  # relative deviation below which no line is taken to be known: rounding on the way is 1e-12
MOST_PAIRS = 14  # most pairs of poles of the function without structure, if the number of resonances is open
LINES_PER_PARAMETER = 2.0  # real values that each parameter of that function takes at least
PATIENCE = 2  # numbers of pairs tried after the best one
FEWEST = 5  # lines from which the noise is guessed at all
DECIBEL, DEGREE = np.log(10) / 20, np.pi / 180
LARGEST = 20.0  # power of an error, over what is expected of it, beyond which it counts as no more than this


def with_rough_noise(problem: FitProblem) -> FitProblem:
    """Return the problem with deviations guessed from how lines differ from their neighbours' line."""
    # Curvature of peaks is taken for noise too: these only weigh less than they might.
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


def with_noise(problem: FitProblem, count: int | None, most_lines: int) -> FitProblem:
    """Return the problem with deviations estimated, no longer rough, for the lines without coherence."""
    if all(line.coherence is not None and line.parts > 1 for line in problem.lines):
        return problem
    thin = problem.thinned(most_lines)
    size = thin.size
    best: tuple[float, int, Complex] | None = None
    worse = 0
    for pairs in range(1 if count is None else count, MOST_PAIRS if count is None else count + 4):
        values, parameters, poles = generous_fit(thin, pairs)
        if parameters * LINES_PER_PARAMETER > size and best is not None:
            break
        misfit = 0.0
        for v, line in zip(values, thin.lines, strict=True):
            scale = 1.0 if line.deviation is None else line.deviation
            misfit += float(np.sum(np.abs(line.rest(v) / np.abs(line.measured.values) / scale) ** 2))
        score = size * np.log(max(misfit, LEAST**2 * size)) + parameters * np.log(size)
        if best is None or score < best[0]:
            best, worse = (float(score), pairs, poles), 0
        else:
            worse += 1
        if worse > PATIENCE:
            break
    if best is None:
        return problem
    values, parameters, _ = generous_fit(problem, best[1], best[2])
    return estimated(problem.rephased(values), values, parameters)


def estimated(problem: FitProblem, values: list[Complex], parameters: int) -> FitProblem:
    """Return the problem with deviations of what these values leave, and how well they describe the lines."""
    freedom = max(1 - parameters / problem.size, 0.2)
    lines, cost = [], 0.0
    for model, line in zip(values, problem.lines, strict=True):
        deviation = line.deviation
        if deviation is None or line.coherence is None:
            power = np.abs(line.rest(model)) ** 2 / line.parts
            variance = _variance(power, line.omega, np.abs(model), rounding(line, model)) / freedom
            size = np.abs(line.measured.values)
            deviation = np.maximum(np.sqrt(variance) / size, LEAST)
        lines.append(replace(line, deviation=deviation))
        residuals = np.abs(line.rest(model)) / (deviation * np.abs(line.measured.values))
        cost += float(np.sum(residuals**2))
    return replace(
        problem, lines=tuple(lines), is_noise_estimated=True, reference=StructurelessFit(cost, parameters)
    )


def rounding(line: FittedLines, model: Complex) -> Real:
    """Return the variance of each part that rounded frequencies, and rounded values, have at most."""
    # Frequencies may be rounded in Hz or in rad/s, values in any of the ways in which files write them.
    omega, values = line.omega, line.measured.values
    size, turn = np.abs(values), np.angle(values)
    written = (
        (1.0, values.real), (1.0, values.imag), (1.0, size), (size * DECIBEL, np.log(size) / DECIBEL),
        (size, turn), (size * DEGREE, turn / DEGREE),
    )  # fmt: skip
    rows = [np.sum([(scale * written_step(numbers)) ** 2 for scale, numbers in written], axis=0)]
    if line.every.measured.spacing_hz is None:
        steps = np.hypot(written_step(omega), 2 * np.pi * written_step(omega / (2 * np.pi)))
        rows.append(np.abs(np.gradient(model, omega) * steps) ** 2)
    return np.stack([row for row in rows if row.any()] or [np.zeros(0)]) / 24  # of two parts, a twelfth


def _variance(power: Real, omega: Real, size: Real, rounded: Real | None = None) -> Real:
    """Return the smooth expectation of the power of each part, a row of ``rounded``, on every line."""
    x = omega / np.exp(np.mean(np.log(omega)))
    unit = float(np.mean(size**2))  # whose square may be no number
    power = power / unit
    shapes = np.stack([size**2 / unit, *(x ** float(p) for p in POWERS)])
    shapes = shapes / np.mean(shapes, axis=1, keepdims=True)
    most = np.full(shapes.shape[0], np.inf)
    if rounded is not None and rounded.size:
        shapes, most = np.concatenate((shapes, rounded / unit)), np.append(most, np.ones(rounded.shape[0]))
    # The square of a variance has to be a number, of exact data too.
    floor = max(float(np.mean(power)) * 1e-12, np.finfo(float).tiny ** 0.4)
    power = np.maximum(power, floor)
    shares = np.full(shapes.shape[0], float(np.mean(power)) / shapes.shape[0])
    for _ in range(STEPS):
        expected = shares @ shapes
        # Gaussian errors reach this once in a billion lines; what is larger is no noise.
        bounded = np.minimum(power, LARGEST * expected)
        shares = shares * np.sqrt((shapes @ (bounded / expected**2)) / (shapes @ (1 / expected)))
        shares = np.minimum(shares, most)
    return np.asarray(unit * (shares @ shapes), np.float64)
