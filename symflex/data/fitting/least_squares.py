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

The search is that of Levenberg (1944) and Marquardt (1963), with the scales of Moré (1978). A response
depends on the poles and on parameters of its own, so that its equations are first reduced to a triangle by an
orthogonal factorisation of these few columns; only the triangles of all responses are solved together. A
step for 50,000 lines costs what forming their derivatives costs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from symflex.budget import spend
from symflex.data.fitting.lines import CAP
from symflex.data.fitting.observation import FittedLines, score_covariance
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Complex, Real, Resonances, Values, Whole

STEPS = 100  # evaluations of each residual; a search that takes more has lost its way
TOLERANCE = 1e-9  # relative, of parameters and cost: far below any standard error, far above rounding
ROUGH = 1e-5  # the same of a search that another one follows: a thousandth of what tells two fits apart
LARGEST_LAG = 3  # lines apart: one more than a Hann window correlates
HANN_SHARES = (4 / 9, 1 / 36, 0.0)
"""Correlation of noise 1, 2 and 3 lines apart: squares of 2/3, 1/6, 0, of a Hann spectrum -1/4, 1/2, -1/4."""
SINGULAR = 1e-12  # reciprocal condition number below which the inverse in doubles has four digits at most
FLAT = 0.25  # damping ratio of a pair of zeros from which no sharp trough shows where it lies
NEXT_TERM = 0.5  # deviation of further terms of what lies outside the band, over those of zeros, at its end
NULL_PART = 1e-3  # share of a parameter in an undetermined direction from which its error is infinite
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-12, 1e9  # Marquardt: first, least, giving up
EASIER, HARDER = 0.2, 6.0  # factors of the damping after a step that lowers the cost, and after another
EDGE = 12.0  # logarithms of parameters stay within this of their start, so that nothing overflows


@dataclass(frozen=True, eq=False)
class Refined:
    """The minimum a start led to."""

    resonances: Resonances  # the parameters
    has_converged: bool  # false when the steps ran out
    residuals: tuple[Values, ...]  # per response, in units of the standard deviation where that is known
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
        freedom = sum(_parts(r).size for r in self.residuals) - self.parameters
        return self.cost / freedom if freedom > 0 else float("nan")


def refine(
    problem: FitProblem, start: Resonances, steps: int = STEPS, tolerance: float = TOLERANCE
) -> Refined:
    """Return the minimum that a start leads to: logarithmic, then complex where deviations are known."""
    # On the way the effect of the window does not matter, and without it a step takes a sixth of the time.
    plain = problem.without_window() if problem.has_deviations else problem
    first = ROUGH if problem.has_deviations else tolerance
    modes, converged = _descend(plain, start, "logarithmic", steps, first)
    if problem.has_deviations:
        modes, converged = _descend(problem, modes, "complex", steps, tolerance)
    return _judged(problem, modes.ordered(), has_converged=converged)


def refine_directly(
    problem: FitProblem, start: Resonances, steps: int = STEPS, tolerance: float = TOLERANCE
) -> Refined:
    """Return the minimum near a start that is close to one, by the last residual alone."""
    kind = "complex" if problem.has_deviations else "logarithmic"
    modes, converged = _descend(problem, start, kind, steps, tolerance)
    return _judged(problem, modes.ordered(), has_converged=converged)


def _descend(
    problem: FitProblem, start: Resonances, kind: str, steps: int, tolerance: float
) -> tuple[Resonances, bool]:
    is_alone = np.array([line.parts == 1 for line in problem.lines])
    start = start.minimum_phase(is_alone)
    packed = start.pack(problem.free)
    if not packed.size:
        return start, True
    low, high = packed - EDGE, packed + EDGE
    for r in range(start.responses):
        at = start.places(r, problem.free)
        low[at["delay"]], high[at["delay"]] = 0.0, np.inf
        low[at["lag"]], high[at["lag"]] = -np.inf if problem.free.lag_sign else 0.0, np.inf
        low[at["zeta_z"]], high[at["zeta_z"]] = -np.inf, np.inf

    def residual(vector: Real) -> list[Values]:
        return _residuals(problem, start.unpack(vector, problem.free), kind)

    def reduced(vector: Real, residuals: list[Values]) -> tuple[Real, Real]:
        return _reduced(problem, start.unpack(vector, problem.free), residuals, kind)

    solution, has_converged = search(
        residual, reduced, np.clip(packed, low, high), (low, high), steps, tolerance
    )
    return start.unpack(solution, problem.free).minimum_phase(is_alone), has_converged


def search(
    residual: Callable[[Real], list[Values]],
    reduced: Callable[[Real, list[Values]], tuple[Real, Real]],
    x: Real,
    limits: tuple[Real, Real],
    steps: int,
    tolerance: float = TOLERANCE,
) -> tuple[Real, bool]:
    """Return a minimum of a sum of squares within limits, and whether it was reached within the steps."""
    # ``reduced`` returns matrix and right side of the linear equations of a step, of any height.
    low, high = limits
    scale = np.zeros(x.size)
    damping = FIRST_DAMPING
    with np.errstate(all="ignore"):  # a trial step may be wild; what it leads to is looked at
        residuals = residual(x)
        cost = _cost(residuals)
        for _ in range(steps):
            matrix, right = reduced(x, residuals)
            if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
                break
            scale = np.maximum(scale, np.linalg.norm(matrix, axis=0))
            scale[scale == 0] = 1.0
            # What would leave through a limit that it has reached stays there.
            gradient = matrix.T @ right
            is_free = ~(((x <= low) & (gradient > 0)) | ((x >= high) & (gradient < 0)))
            while damping < MOST_DAMPING:
                spend()
                step = np.zeros(x.size)
                step[is_free] = _step(matrix[:, is_free], right, np.sqrt(damping) * scale[is_free])
                moved = np.clip(x + step, low, high)
                step = moved - x
                expected = float(right @ right - np.sum((matrix @ step + right) ** 2))
                is_short = np.linalg.norm(scale * step) <= tolerance * np.linalg.norm(scale * x)
                is_settled = bool(is_short or expected <= tolerance * cost)
                trial = residual(moved)
                gained = cost - _cost(trial)
                if gained > 0:
                    break
                if is_settled:
                    return x, True
                damping *= HARDER
            else:
                return x, True  # no step, however short, lowers the cost
            x, residuals, cost = moved, trial, cost - gained
            damping = max(damping * EASIER, LEAST_DAMPING)
            if (is_settled and gained <= tolerance * (cost + gained)) or not cost > 0:
                return x, True
    return x, False


def _cost(residuals: list[Values]) -> float:
    return float(sum(np.vdot(one, one).real for one in residuals))


def triangle(matrix: Real) -> Real:
    """Return the triangular factor of a matrix: what least squares need of it."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), np.float64)


def _step(matrix: Real, right: Real, damped: Real) -> Real:
    """Return the step that least squares give to the reduced equations with Marquardt's rows below them."""
    # Columns are scaled, as they would be in an inverse.
    stacked = np.concatenate((matrix / damped, np.eye(damped.size)))
    target = np.concatenate((-right, np.zeros(damped.size)))
    upper = triangle(np.column_stack((stacked, target)))
    size = damped.size
    return np.asarray(np.linalg.solve(upper[:size, :size], upper[:size, size]) / damped, np.float64)


def _reduced(problem: FitProblem, modes: Resonances, residuals: list[Values], kind: str) -> tuple[Real, Real]:
    """Return the linear equations of a step: a triangle for each response, shape (k, p), and their right."""
    size = modes.size(problem.free)
    rows, right = [], []
    for r, slopes in enumerate(_slopes(problem, modes, kind)):
        columns = modes.columns(r, problem.free)
        upper = triangle(np.column_stack((_parts(slopes), _parts(residuals[r]))))
        wide = np.zeros((upper.shape[0], size))
        wide[:, columns] = upper[:, :-1]
        rows.append(wide)
        right.append(upper[:, -1])
    return np.concatenate(rows), np.concatenate(right)


def _parts(values: Values) -> Real:
    return np.concatenate((values.real, values.imag)) if np.iscomplexobj(values) else values.real


def _residuals(problem: FitProblem, resonances: Resonances, kind: str) -> list[Values]:
    pairs = [(problem.values(resonances, r), line) for r, line in enumerate(problem.lines)]
    if kind == "complex":
        return [line.rest(model) / _absolute(line) for model, line in pairs]
    ratios = [(model / line.measured.values, line) for model, line in pairs]
    return [
        np.log(ratio if line.parts > 1 else np.abs(ratio)) / _capped(line.deviation) for ratio, line in ratios
    ]


def _slopes(problem: FitProblem, resonances: Resonances, kind: str) -> Iterator[Values]:
    for r, line in enumerate(problem.lines):
        model, slopes = problem.linearised(resonances, r)
        scale = model * _capped(line.deviation)
        if kind != "logarithmic":
            # The magnitude changes by what is in phase with the model.
            turn = np.exp(1j * np.angle(model) * (line.parts == 1))
            scale = np.asarray(_absolute(line) * turn, np.complex128)
        scaled = np.asarray(slopes / scale[:, None], np.complex128)
        yield scaled if line.parts > 1 else scaled.real


def _capped(deviation: Real | None) -> Real:
    return np.ones(1) if deviation is None else np.hypot(deviation, CAP)


def _absolute(line: FittedLines) -> Real:
    return (np.ones(1) if line.deviation is None else line.deviation) * np.abs(line.measured.values)


def _judged(problem: FitProblem, modes: Resonances, *, has_converged: bool) -> Refined:
    kind = "complex" if problem.has_deviations else "logarithmic"
    residuals = _residuals(problem, modes, kind)
    total = modes.size(problem.free)
    with np.errstate(all="ignore"):
        insides = [
            line.base * modes.factor(r, line.observation.omega) for r, line in enumerate(problem.lines)
        ]
        columns = [modes.columns(r, problem.free) for r in range(len(problem.lines))]
        slopes = _slopes(problem, modes, kind)
        sums, shares = sums_of(problem.lines, insides, residuals, slopes, columns, total)
        covariance, correlation = _covariance(sums, shares)
    return Refined(modes, has_converged, tuple(residuals), covariance, correlation, total)


def sums_of(
    lines: Sequence[FittedLines],
    insides: Sequence[Complex],
    residuals: list[Values],
    slopes: Iterable[Values],
    columns: Sequence[Whole] | None = None,
    total: int | None = None,
) -> tuple[Sums, Shares]:
    """Return what a covariance is made of; ``insides`` are responses at the frequencies of observations.

    ``columns`` are the parameters that each response depends on, of a ``total``; by default all.
    """
    sums, shares = None, correlation_of(residuals, _cost(residuals))
    for r, (line, by_own) in enumerate(zip(lines, slopes, strict=True)):
        if sums is None:
            count = by_own.shape[1] if total is None else total
            sums = Sums(count, sum(_parts(one).size for one in residuals), _cost(residuals))
        turn = 1 if line.parts > 1 else np.exp(1j * np.angle(line.observation(insides[r])))[:, None]
        score = score_covariance(line, insides[r], by_own * turn)
        own = np.arange(by_own.shape[1]) if columns is None else columns[r]
        sums.add(own, by_own, score, len(shares))
    assert sums is not None  # there is a response
    return sums, shares


def widened(problem: FitProblem, refined: Refined) -> Refined:
    """Return a minimum with errors that count what is not known of modes outside the band.

    Zeros outside the band, or without a sharp trough, stand for such modes: they follow the terms (s/w)^2 and
    s/w that inertia and damping of these add to ln G, w being the end of the band, with further terms of
    their own, which need not be right. In a fit with more parameters, for terms (s/w)^4, (s/w)^6, (s/w)^3 and
    (s/w)^5 that are normally distributed about 0 with half the first term as deviation, every parameter would
    have another error, and another value: errors are these, and the way from this value to that one. Below
    the band powers are negative. So are what the end of a step leaves unknown, see :func:`_ends`.
    """
    modes, size = refined.resonances, refined.resonances.size(problem.free)
    normal, gradient = np.zeros((size, size)), np.zeros(size)
    crosses, squares, pulls = [], [], []
    for r, slopes in enumerate(_slopes(problem, modes, "complex")):
        line, columns = problem.lines[r], modes.columns(r, problem.free)
        frequency, damping = np.abs(modes.omega_z[r]), np.abs(modes.zeta_z[r])
        low, high = line.omega[[0, -1]]
        outside = (frequency < low) | ((frequency > high) | (damping > FLAT)) & (frequency < np.inf)
        frequency, damping = frequency[outside], damping[outside]
        bends = []
        for end, sign in ((low, -1), (high, 1)):
            near = np.minimum(frequency / end, end / frequency)
            even, odd = np.max(near**2, initial=0.0), 2j * np.max(damping * near, initial=0.0)
            ratio = (line.omega / end) ** sign
            bends += [even * ratio**4, even * ratio**6, odd * ratio**3, odd * ratio**5]
        values, deviation = problem.values(modes, r), _absolute(line)
        bent = NEXT_TERM * np.column_stack(bends) * (values / deviation)[:, np.newaxis]
        if line.measured.cut_off_s:
            bent = np.column_stack((bent, _ends(line, modes, values) / deviation[:, np.newaxis]))
        residuals = line.rest(values) / deviation
        if line.parts == 1:
            bent = (bent / np.exp(1j * np.angle(values))[:, np.newaxis]).real.astype(np.complex128)
        normal[np.ix_(columns, columns)] += (np.conj(slopes).T @ slopes).real
        gradient[columns] += (np.conj(slopes).T @ residuals).real
        cross = np.zeros((size, bent.shape[1]))
        cross[columns] = (np.conj(slopes).T @ bent).real
        crosses.append(cross)
        squares.append((np.conj(bent).T @ bent).real)
        pulls.append((np.conj(bent).T @ residuals).real)
    covariance = refined.covariance
    if covariance is None or not np.isfinite(normal).all():
        return refined
    scale = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))[:, np.newaxis]
    cross = np.hstack(crosses)
    moved = np.linalg.lstsq(normal / (scale * scale.T), cross / scale, rcond=SINGULAR)[0] / scale
    stiffness, turned = np.linalg.eigh(block_diag(*squares) - cross.T @ moved)
    noise = max(refined.reduced, np.finfo(float).tiny)
    variance = 1 / (1 + np.maximum(stiffness, 0.0) / noise)
    moved, pull = moved @ turned, turned.T @ (np.concatenate(pulls) - moved.T @ gradient)
    way = moved @ (variance * pull / noise)
    return replace(refined, covariance=covariance + moved * variance @ moved.T + np.outer(way, way))


def _ends(line: FittedLines, modes: Resonances, values: Complex) -> Complex:
    """Return what a step that is cut off adds to lines, a column each, with its deviation."""
    # Noise of its last sample is all of the lowest line. A mode that rings on has ``r (1 - exp(p T))`` for r.
    s, w, zeta = 1j * line.omega, modes.omega_p[:, None], modes.zeta_p[:, None]
    peak = np.interp(w, line.omega, np.abs(values)) * np.sqrt(2) * zeta
    shape = peak * np.exp(-zeta * w * (line.measured.cut_off_s or 0)) / (1 + 2 * zeta * s / w + (s / w) ** 2)
    common = np.full(s.size, np.sqrt(2) * _absolute(line)[0], np.complex128)
    return np.vstack((common, shape, shape * s / w)).T


Shares = list[tuple[float, int]]  # correlation of residuals some lines apart, and counts of pairs


class Sums:
    """Sums over lines that a covariance is made of; a response adds to those of its own parameters."""

    def __init__(self, size: int, values: int, power: float) -> None:
        self.values, self.power = values, power
        self.normal: Real = np.zeros((size, size))
        self.score: Real | None = np.zeros((size, size))
        self.crossed: list[Real] = []

    def add(self, columns: Whole, slopes: Values, score: Real | None, lags: int) -> None:
        """Add the sums over the lines of one response."""
        at = np.ix_(columns, columns)
        self.normal[at] += (np.conj(slopes).T @ slopes).real
        if score is None:
            self.score = None
        elif self.score is not None:
            self.score[at] += score
        for lag in range(1, lags + 1):
            if len(self.crossed) < lag:
                self.crossed.append(np.zeros_like(self.normal))
            cross = (np.conj(slopes[:-lag]).T @ slopes[lag:]).real
            self.crossed[lag - 1][at] += cross + cross.T


def correlation_of(residuals: list[Values], power: float) -> Shares:
    """Return the correlation of residuals some lines apart, until it may be chance, and counts of pairs."""
    shares: Shares = []
    total = sum(r.size for r in residuals)
    for lag in range(1, LARGEST_LAG + 1 if power > 0 else 1):
        pairs = sum(max(r.size - lag, 0) for r in residuals)
        shared = sum(float(np.sum((np.conj(r[:-lag]) * r[lag:]).real)) for r in residuals)
        share = shared / power * total / max(pairs, 1)
        if not share >= 2 / np.sqrt(max(pairs, 1)):
            break
        shares.append((share, pairs))
    return shares


def sandwich(sums: Sums, shares: Shares, prior: Real, rank: int) -> tuple[Real, Real]:
    """Return the covariance of parameters that lines and a ``prior`` determine, in so many directions.

    The second result has the other directions, one a row, in parameters over their scales; after them a row
    of these scales.
    """
    size = np.sqrt(np.maximum(np.diag(sums.normal + prior), np.finfo(float).tiny))
    scaled = np.outer(size, size)
    values, vectors = np.linalg.eigh((sums.normal + prior) / scaled)
    inverse = (vectors[:, -rank:] / np.maximum(values[-rank:], np.finfo(float).tiny)) @ vectors[:, -rank:].T
    middle = _middle(sums, shares) * max(sums.power / max(sums.values - rank, 1), np.finfo(float).tiny)
    covariance = inverse @ ((middle + prior) / scaled) @ inverse / scaled
    return covariance, np.vstack((vectors[:, :-rank].T, 1 / size))


def _middle(sums: Sums, shares: Shares) -> Real:
    """Return the covariance of J'e for lines of unit variance."""
    middle = sums.normal if sums.score is None else sums.score
    for lag, (share, pairs) in enumerate(shares, 1):
        kept = share
        if sums.score is not None:
            kept -= HANN_SHARES[lag - 1]
            kept = kept if kept > 2 / np.sqrt(pairs) else 0.0
        middle = middle + kept * sums.crossed[lag - 1]
    return middle


def _covariance(sums: Sums, shares: Shares) -> tuple[Real | None, float]:
    """Return the covariance of the parameters, ``None`` if it is no number, and the factor of correlation."""
    # Parameters that the lines do not determine have infinite variance. Windows and overlapping records
    # correlate lines: the correlation of residuals up to :data:`LARGEST_LAG` lines apart enters between two
    # inverses of J'J (White 1980; Newey & West 1987). Where the window is known for all responses, its
    # covariance of J'e stands there, with as much of that correlation as no window brings. The scale is that
    # of the residuals.
    count = sums.normal.shape[0]
    if not count:
        return np.zeros((0, 0)), 1.0
    size = np.sqrt(np.diag(sums.normal))
    freedom = sums.values - count
    if not np.isfinite(sums.normal).all() or freedom <= 0:
        return None, 1.0
    size = np.where(size > 0, size, 1.0)
    scaled = np.outer(size, size)
    values, vectors = np.linalg.eigh(sums.normal / scaled)
    is_null = values < SINGULAR * values[-1]
    inverse = (vectors[:, ~is_null] / values[~is_null]) @ vectors[:, ~is_null].T
    middle = _middle(sums, shares) / scaled
    factor = 1 + 2 * sum(share for share, _ in shares)
    covariance = inverse @ middle @ inverse * (sums.power / freedom) / scaled
    covariance[np.diag_indices(count)] += np.finfo(float).eps ** 2  # doubles are no more exact
    lost = np.any(np.abs(vectors[:, is_null]) > NULL_PART, axis=1)
    covariance[lost, lost] = np.inf
    return covariance, factor
