"""Nonlinear least squares from a start, and how accurate the result is.

Two residuals are used one after the other. Where the model G misses a peak of H by a factor of two on one
line, and a trough on another, both measured to sigma = 1 %:

    line     H    G    ln(G/H)    (G - H)/sigma
    peak     6    3     -0.69         -50
    trough   3    6      0.69         100

``logarithmic``: ln(G/H), the logarithm of the quotient of model and measurement. A peak missed by a factor
of two counts as much as a trough missed by a factor of two, in magnitude and in phase, and the way from a
poor start is short.

``complex``: (G - H)/sigma with the standard deviation sigma of each measured line, known from coherence. It
is the maximum-likelihood residual of an H1 estimate, whose error is complex, Gaussian and independent of
sigma's own error; troughs drowned in noise pull nothing their way, where a logarithm would be biased. As
sigma is a share of the magnitude, resonances and antiresonances still count alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

from symflex.budget import spend
from symflex.data.fitting.observation import score_covariance
from symflex.data.fitting.resonances import Complex, Real, Resonances

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FitProblem, FittedLines

STEPS = 100
"""Evaluations of each residual; a search that takes more has lost its way."""
TOLERANCE = 1e-9
"""Relative, of parameters and cost: far below any standard error, far above rounding."""
CAP = 0.05
"""Added to the deviation in the logarithmic residual, so that no single line pulls a poor start astray."""
LARGEST_LAG = 3
"""Lines apart: one more than a Hann window correlates."""
HANN_SHARES = (4 / 9, 1 / 36, 0.0)
"""Correlation of noise on lines 1, 2 and 3 apart, seen through a Hann window.

They are the squares of 2/3, 1/6 and 0, the correlations of its spectrum -1/4, 1/2, -1/4 with itself.
"""
SINGULAR = 1e-12
"""Reciprocal condition number below which the inverse in doubles has four digits at most."""
EDGE = 12.0
"""Logarithms of parameters are kept within this of their start, so that nothing overflows on the way."""


@dataclass(frozen=True, eq=False)
class Refined:
    """The minimum a start led to."""

    resonances: Resonances  # the parameters
    has_converged: bool  # false when the steps ran out
    residuals: tuple[Complex, ...]  # per response, in units of the standard deviation where that is known
    # shape (p, p): Of the packed parameters; None when the lines do not determine all of them.
    covariance: Real | None
    # What correlated neighbouring lines multiply the variance of a mean by; 1 for independent lines.
    correlation: float
    parameters: int  # how many parameters were found

    @property
    def cost(self) -> float:
        """The sum of squares."""
        return float(sum(np.sum(np.abs(r) ** 2) for r in self.residuals))

    @property
    def reduced(self) -> float:
        """The sum of squares per degree of freedom; 1 when the model is right and deviations are known."""
        freedom = 2 * sum(r.size for r in self.residuals) - self.parameters
        return self.cost / freedom if freedom > 0 else float("nan")


def refine(problem: FitProblem, start: Resonances, *, steps: int = STEPS) -> Refined:
    """Return the minimum that a start leads to: logarithmic first, then complex where deviations are known.

    The start has positive frequencies and pole damping; each of the two residuals is evaluated ``steps``
    times at most.
    """
    # On the way the effect of the window does not matter, and without it a step takes a sixth of the time.
    plain = problem.without_window() if problem.has_deviations else problem
    found, converged = _descend(plain, start, "logarithmic", steps)
    if problem.has_deviations:
        found, converged = _descend(problem, found, "complex", steps)
    return _judged(problem, found.ordered(), has_converged=converged)


def refine_directly(problem: FitProblem, start: Resonances, *, steps: int = STEPS) -> Refined:
    """Return the minimum near a start that is close to one, by the last residual alone."""
    kind = "complex" if problem.has_deviations else "logarithmic"
    found, converged = _descend(problem, start, kind, steps)
    return _judged(problem, found.ordered(), has_converged=converged)


def _descend(problem: FitProblem, start: Resonances, kind: str, steps: int) -> tuple[Resonances, bool]:
    packed = start.pack(problem.free)
    if not packed.size:
        return start, True

    def resonances(vector: Real) -> Resonances:
        return start.unpack(np.clip(vector, packed - EDGE, packed + EDGE), problem.free)

    def residual(vector: Real) -> Real:
        spend()
        return _parts(np.concatenate(_residuals(problem, resonances(vector), kind)))

    def slopes(vector: Real) -> Real:
        spend()
        return _parts(np.concatenate(_slopes(problem, resonances(vector), kind)))

    limits = np.full(packed.size, -np.inf)
    for r in range(start.responses):
        at = start.places(r, problem.free)
        limits[at["delay"]] = 0.0
        if not problem.free.lag_sign:
            limits[at["lag"]] = 0.0
    search = partial(
        least_squares,
        residual,
        jac=slopes,
        x_scale="jac",
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=steps,
    )
    with np.errstate(all="ignore"):  # a trial step may be wild; what it leads to is looked at
        done = search(packed, method="lm")
        if np.any(done.x < limits):
            # The slower search, for a time that would have to be negative.
            done = search(np.maximum(packed, limits), method="trf", bounds=(limits, np.inf))
    return resonances(done.x), done.status > 0


def _parts(values: Complex) -> Real:
    return np.concatenate((values.real, values.imag))


def _residuals(problem: FitProblem, resonances: Resonances, kind: str) -> list[Complex]:
    found: list[Complex] = []
    for r, line in enumerate(problem.lines):
        model = problem.values(resonances, r)
        if kind == "logarithmic":
            found.append(np.asarray(np.log(model / line.measured.values) / _capped(line.deviation), complex))
        else:
            found.append((model - line.measured.values) / _absolute(line))
    return found


def _slopes(problem: FitProblem, resonances: Resonances, kind: str) -> list[Complex]:
    found: list[Complex] = []
    for r, line in enumerate(problem.lines):
        model, slopes = problem.linearised(resonances, r)
        scale = model * _capped(line.deviation) if kind == "logarithmic" else _absolute(line)
        found.append(np.asarray(slopes / scale[:, None], np.complex128))
    return found


def _capped(deviation: Real | None) -> Real:
    return np.ones(1) if deviation is None else np.hypot(deviation, CAP)


def _absolute(line: FittedLines) -> Real:
    """Return the standard deviation of each part of each line."""
    return (np.ones(1) if line.deviation is None else line.deviation) * np.abs(line.measured.values)


def _judged(problem: FitProblem, found: Resonances, *, has_converged: bool) -> Refined:
    kind = "complex" if problem.has_deviations else "logarithmic"
    residuals = _residuals(problem, found, kind)
    slopes = _slopes(problem, found, kind)
    scores = [
        score_covariance(line, line.base * found.factor(r, line.observation.omega), slopes[r])
        for r, line in enumerate(problem.lines)
    ]
    covariance, correlation = _covariance(residuals, slopes, [s for s in scores if s is not None])
    return Refined(found, has_converged, tuple(residuals), covariance, correlation, slopes[0].shape[1])


def _covariance(
    residuals: list[Complex], slopes: list[Complex], scores: list[Real]
) -> tuple[Real | None, float]:
    """Return the covariance of the parameters, None when it is singular, and the factor of correlation.

    Windows and overlapping records correlate neighbouring lines, so that the inverse of J'J alone would
    promise too much. The correlation up to :data:`LARGEST_LAG` lines is estimated from the residuals, and
    enters between two such inverses (White 1980; Newey & West 1987). Where the window is known for all
    responses, the covariance of J'e that follows from it stands there, with as much of that correlation as a
    window does not bring: what a model lacks is not noise. The scale is that of the residuals.
    """
    stacked = np.concatenate([_parts(s) for s in slopes])
    if not stacked.shape[1]:
        return np.zeros((0, 0)), 1.0
    size = np.linalg.norm(stacked, axis=0)
    if not np.all(size > 0) or not np.isfinite(size).all():
        return None, 1.0
    scaled = [s / size for s in slopes]
    normal = sum((np.conj(s).T @ s).real for s in scaled)
    if np.linalg.cond(normal) > 1 / SINGULAR:
        return None, 1.0
    freedom = sum(2 * r.size for r in residuals) - stacked.shape[1]
    if freedom <= 0:
        return None, 1.0
    power = sum(float(np.sum(np.abs(r) ** 2)) for r in residuals)
    is_explained = len(scores) == len(residuals)
    middle = np.sum(scores, axis=0) / np.outer(size, size) if is_explained else np.array(normal)
    factor = 1.0
    if power == 0:
        return np.zeros_like(normal), factor
    for lag in range(1, LARGEST_LAG + 1):
        pairs = sum(max(r.size - lag, 0) for r in residuals)
        shared = sum(float(np.sum((np.conj(r[:-lag]) * r[lag:]).real)) for r in residuals)
        total = sum(r.size for r in residuals)
        share = shared / power * total / max(pairs, 1)
        if share < 2 / np.sqrt(max(pairs, 1)):
            break
        cross = sum((np.conj(s[:-lag]).T @ s[lag:]).real for s in scaled)
        factor += 2 * share
        kept = share
        if is_explained:
            kept -= HANN_SHARES[lag - 1]
            kept = kept if kept > 2 / np.sqrt(pairs) else 0.0
        middle = middle + kept * (cross + cross.T)
    inverse = np.linalg.inv(normal)
    covariance = inverse @ middle @ inverse * (power / freedom)
    return covariance / np.outer(size, size), factor
