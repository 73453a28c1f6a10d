"""From data to the best fit with a number of poles, given or chosen by an information criterion.

One resonance at 10 Hz, measured on 300 lines with 1 % of noise:

    poles                             0      1      2      3      4
    sum of squares per freedom     3267   2893  0.995  0.992  0.972
    BIC                            4860   4820     24     29     31

Two are chosen, which are one resonance: their BIC is the least, and more explain less than their parameters
cost. Poles are counted one by one, because some are real; pairs outside the band and real poles are residual
terms, which stand for what a resonance in the band is not. A number is tried with few steps of the search
first, on lines that tell the most; the one preferred is then fitted to the end on all lines, and given up
where a damping ratio is less than twice its standard error, or where the evidence for it is not strong. There
always is a result: where all are given up, it is the best of them, and says why it is poor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from scipy.special import fdtrc

from symflex.budget import TIME_OVER, entered_budget
from symflex.data.fitting.least_squares import ROUGH, STEPS, TOLERANCE, Refined, refine, refine_directly
from symflex.data.fitting.noise import estimated
from symflex.data.fitting.numerator import FAR_OUTSIDE, STRANGE, over_poles, strange
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Complex, Resonances, Whole
from symflex.data.fitting.starts import poles_from_aaa, poles_from_vector_fitting, relocated, start_from_peaks
from symflex.errors import BudgetError, Diagnostic
from symflex.options import FitOptions

Result = TypeVar("Result")


CRITERIA = ("bic", "aicc")
MOST_MODES = 12  # beyond, ask for a number: each one tried costs a fit from up to three kinds of starts
EXTRA = 5  # poles beyond those of the resonances that are asked for: modes outside the band, and real ones
PATIENCE, MORE_PATIENCE = 1, 3  # pairs tried after the best: near the noise, and far from it
NOISE_SHARE, TRIED_SHARE, THOROUGH_SHARE, LAST_SHARE, PHASE_SHARE = 0.15, 0.6, 0.7, 0.85, 0.92
"""Parts of the time given when the noise has to be known, numbers of poles compared, the fit found, fitted to
all lines, and its phase tested."""
THOROUGH, QUICK = (STEPS, TOLERANCE), (25, ROUGH)  # steps and tolerance of a whole search and a comparison
EXPLAINED = 1.15  # sum of squares per degree of freedom up to which noise explains the rest; 1 is expected
WEAK = 0.5  # standard error of ln zeta beyond which fewer resonances are preferred, unless that is far worse
FAR_BETTER = 4.0  # ratio of sums of squares at which a failed fit is said, not replaced, and a weak one kept
FAR_OFF = 100.0  # sum of squares per degree of freedom from which poles are missing, whatever the start
LOWER = 0.5  # how far the BIC has to fall for another start to count as better
NEGLIGIBLE = 1e-6  # mean square, over the noise's, below which residuals are rounding and tell nothing apart
WELL_BELOW = 0.1  # the same of records, in units of the noise that they show where they are quietest
MOST_NUMERATORS, MOST_STARTS = 3, 4  # the likeliest of a choice of poles, and of these fitted
MOST_SHAPES = 12  # numerators over each choice of poles among which the simplest is looked for
NARROW_BAND = 1.1  # ratio of the ends of a band in which a power of s is hardly more than a gain
SAME = 1e-3  # relative distance below which two starts have the same poles
MOST_RISE = 1.5  # zeros moved to the other half-plane are a start where the misfit rises by no more than this
CLEAR = 6.0  # difference of BIC that is strong evidence (Kass & Raftery, J. Am. Stat. Assoc. 90, 1995).
HALF_FORGOTTEN = 1.66  # 1.5 coth 1.5, the sum of 1/(1 + (pi k/1.5)^2) over k, for an exponential window
UNLIKELY = 1e-5  # share of right fits that a function without structure may describe better: called poor


class Stages:
    """The parts of a fit, each of which ends with a share of the time left, so that there is a result."""

    def __init__(self) -> None:
        entered = entered_budget()
        # From now on: programs that start, and files that are read, have had their part of the time.
        self.budget = replace(entered, seconds=entered.left)
        self.untimed = replace(entered, seconds=None)
        self.is_cut = False  # whether one of them did not end in time

    def within(self, share: float, compute: Callable[[], Result], otherwise: Callable[[], Result]) -> Result:
        """Return what is computed, or something else when a share of the time is over."""
        try:
            with self.budget.share(share).entered():
                return compute()
        except BudgetError as error:
            if error.diagnostics[0].code != TIME_OVER.code:
                raise
        self.is_cut = True
        # A part that is over has to end in something, if only in its first guess.
        with self.untimed.entered():
            return otherwise()


@dataclass(frozen=True, eq=False)
class Candidate:
    """The best fit with one number of poles."""

    order: int  # how many poles
    start_kind: str  # the key of :data:`STARTS` that led to it
    start: Resonances  # where it began
    refined: Refined  # where it ended
    failure: Diagnostic | None  # why it had better not be a result
    rival: Refined | None = None  # the best fit met with another power of s
    is_rivalled: bool = False  # whether that describes the lines as well


@dataclass(frozen=True, slots=True)
class Score:
    """What the criteria say of one number of poles; lower is better."""

    order: int  # poles
    count: int  # resonances in the band among them
    parameters: int
    # bic and aicc: schwarz 1978; Hurvich & Tsai 1989.
    bic: float
    aicc: float
    reduced: float  # the sum of squares per degree of freedom
    # ``usable``; ``failed`` when the fit did; ``weak`` when a damping ratio is less than twice its error, or
    # strong evidence for one resonance more is missing.
    status: str


def _from_peaks(problem: FitProblem, order: int) -> Iterator[Resonances]:
    """Return the start of the paper, and what linear least squares put over its poles."""
    if order % 2:
        return
    slopes = problem.slopes
    if len(slopes) > 1:
        slopes = tuple(slope for slope in (problem.guessed_slope(),) if slope in problem.slopes) or slopes[:1]
    start = start_from_peaks(problem.with_slope(slopes[0]), order // 2)
    if start is None:
        return
    start = replace(start, slope=np.full(start.responses, slopes[0]), delay=np.array(problem.delays))
    yield start
    poles = start.omega_p * (-start.zeta_p + 1j * np.sqrt(1 - start.zeta_p**2))
    yield from _over(problem, [poles, relocated(problem, poles)])


def _over(problem: FitProblem, choices: list[Complex]) -> Iterator[Resonances]:
    """Return the likeliest functions over all choices of poles, the best first."""
    distinct: list[Complex] = []
    starts: list[tuple[float, Resonances]] = []
    for poles in choices:
        alike = (other for other in distinct if other.size == poles.size)
        if not any(np.all(abs(other - poles) < SAME * abs(poles)) for other in alike):
            distinct.append(poles)
            starts += over_poles(problem, poles, MOST_NUMERATORS)
    for _, resonances in sorted(starts, key=lambda one: one[0])[:MOST_STARTS]:
        yield resonances


STARTS: Mapping[str, Callable[[FitProblem, int], Iterator[Resonances]]] = {
    "peaks": _from_peaks,
    "vector": lambda problem, order: _over(problem, poles_from_vector_fitting(problem, order)),
    "aaa": lambda problem, order: _over(problem, [] if order % 2 else poles_from_aaa(problem, order // 2)),
}
"""Ways to begin, the most promising start first; ``auto`` tries all and keeps the best."""


def best_of_starts(
    problem: FitProblem, order: int, kind: str = "auto", *, is_quick: bool = False
) -> Candidate | None:
    """Return the best fit with so many poles; None when no start has as many."""
    kinds = [kind]
    if kind == "auto":
        # On a known base the procedure of the paper is tried first; without, the powers of s are open.
        kinds = list(STARTS) if len(problem.slopes) == 1 else ["vector", "peaks", "aaa"]
        if is_quick and len(problem.slopes) > 1:
            kinds = kinds[:1]
    if not order:
        kinds = ["vector"]
    best: Candidate | None = None
    met: list[Refined] = []
    for name in kinds:
        if name == "aaa" and best is not None and best.failure is None and kind == "auto":
            break  # the slowest of the three, for where the others fail
        for start in STARTS[name](problem, order):
            refined = refine(problem, start, *(QUICK if is_quick else THOROUGH))
            if not (refined.has_converged or is_quick) and (
                best is None or _merit(problem, refined) < _merit(problem, best.refined)
            ):
                refined = refine_directly(problem, refined.resonances, 2 * STEPS)
            failure = _failure(problem, refined, is_quick=is_quick)
            candidate = Candidate(order, name if order else "none", start, refined, failure)
            met.append(refined)
            if best is None or _is_better(problem, candidate, best):
                best = candidate
            if is_quick and best.refined.reduced > FAR_OFF:
                break
            # Where the power of s is open, another may explain the lines as well.
            if len(problem.slopes) == 1 and _is_enough(problem, best):
                break
        if best is not None and _is_enough(problem, best):
            break
    if best is None:
        return None
    best = _simplified(problem, best, is_quick=is_quick)
    if not is_quick:
        best = _signs_tried(problem, best)
    others = [one for one in met if np.any(one.resonances.slope != best.refined.resonances.slope)]
    return replace(best, rival=min(others, key=lambda one: _merit(problem, one), default=None))


def chosen_order(
    problem: FitProblem, thin: FitProblem, given: FitOptions, stages: Stages
) -> tuple[Candidate, tuple[Score, ...], tuple[str, ...]]:
    """Return the fit whose number of poles the criterion prefers, what it says of all, and what is wrong."""
    modes, criterion = given.modes, given.criterion
    tried: list[Candidate] = []
    stages.within(TRIED_SHARE, lambda: _try(thin, given, tried), lambda: None)
    if not tried:
        with stages.untimed.entered():
            none = np.zeros(0, np.complex128)
            empty = np.zeros((len(thin.lines), 0))
            plain = Resonances(none.real, none.real, empty, empty, np.ones(len(thin.lines)))
            refined = refine(thin, plain, *QUICK)
            tried.append(Candidate(0, "none", plain, refined, _failure(thin, refined)))
    tried = sorted(tried, key=lambda one: one.order)
    reasons: list[str] = []
    # What is correlated because a resonance lacks tells nothing of the noise.
    closest = min(tried, key=lambda one: one.refined.reduced)
    scores = [_score(thin, one, closest.refined.correlation) for one in tried]
    by_order = {one.order: one for one in tried}
    wanted = [s for s in scores if modes is None or s.count == modes]
    if not wanted:
        low, high = (value / (2 * np.pi) for value in thin.band)
        band = f"{' over the base' if thin.has_base else ''} between {low:.4g} and {high:.4g} Hz"
        most = max(s.count for s in scores)
        reasons.append(f"{modes} resonances were requested, and the best fit has {most}{band}")
        wanted = scores
    given_up: list[tuple[Score, Candidate]] = []
    result: Candidate | None = None
    unlikely = {s for s in wanted if thin.is_exact and not _is_founded(thin, scores, s, criterion)}
    for score in sorted(wanted, key=lambda s: (s in unlikely, _value(s, criterion))):
        limit = (score.reduced + NEGLIGIBLE) / FAR_BETTER
        result = next((one for s, one in given_up if s.reduced + NEGLIGIBLE < limit), None)
        if result is not None:
            break
        best = _continued(problem, thin, by_order[score.order], tried, given.start, stages)
        status = "usable" if best.failure is None else "failed"
        if status == "usable" and score.order and modes is None:
            is_weak = _is_weak(thin, best.refined) or not _is_founded(thin, scores, score, criterion)
            status = "weak" if is_weak else status
        scores = [replace(s, status=status) if s.order == score.order else s for s in scores]
        if status == "usable":
            result = best
            break
        given_up.append((score, best))
    result = result or given_up[0][1]
    if result.failure is not None:
        reasons.append(result.failure.message)
    return result, tuple(scores), tuple(reasons)


def _try(thin: FitProblem, given: FitOptions, tried: list[Candidate]) -> None:
    """Add quick fits with even numbers of poles until more explain nothing, and those beside the best."""
    modes = given.modes
    first, last = (0, 2 * MOST_MODES) if modes is None else (2 * modes, 2 * modes + EXTRA)

    def values() -> list[float]:
        """Return what the criterion says of each one tried; infinite where that failed."""
        scores = [_score(thin, one, tried[-1].refined.correlation) for one in tried]
        return [_value(s, given.criterion) if s.status == "usable" else np.inf for s in scores]

    def attempt(order: int) -> bool:
        """Try a number; return whether that settles it."""
        done = TRIED_SHARE * (order - first) / (last - first + 1)
        entered_budget().progress.report(done, f"fit with {order} poles to {thin.count} lines")
        candidate = best_of_starts(thin, order, given.start, is_quick=modes is None)
        if candidate is None:
            return False
        tried.append(candidate)
        if modes is not None:
            resonances = candidate.refined.resonances
            return int(resonances.in_band(*thin.band).sum()) == modes and _is_enough(thin, candidate)
        return candidate.refined.reduced < NEGLIGIBLE and thin.is_noise_estimated  # what is left is rounding

    worse = 0
    for order in range(first, last + 1, 1 if thin.is_exact else 2):
        if attempt(order):
            return
        now = values()
        worse = worse + 1 if now and now[-1] > min(now) else 0
        least = min((one.refined.reduced for one in tried), default=np.inf)
        # Fewer poles than there are may be no better than none, each with something large left over.
        patience = MORE_PATIENCE if not thin.has_scale or least > FAR_BETTER else PATIENCE
        patience *= 1 + thin.is_exact
        if worse > (0 if thin.has_scale and least < EXPLAINED and not thin.is_exact else patience):
            break
    if tried:
        best = tried[int(np.argmin(values()))].order
        for order in (best - 1, best + 1):
            if first <= order <= last and order not in {one.order for one in tried}:
                attempt(order)


def _is_founded(problem: FitProblem, scores: Sequence[Score], score: Score, criterion: str) -> bool:
    """Return whether there is strong evidence for so many poles."""
    # Noise looks like a resonance on some of the lines more often than on a given one, as many times as there
    # are lines (Sidak 1967): one more needs evidence against all of them.
    chances = 2 * float(np.log(problem.count))
    fewer = [s for s in scores if s.order < score.order and s.status != "failed"]
    if problem.is_exact:  # rounding repeats itself, and is no noise: a pole that is there leaves far less
        return all(FAR_BETTER * (score.reduced + NEGLIGIBLE) < s.reduced + NEGLIGIBLE for s in fewer)
    limits = (_value(s, criterion) - CLEAR - chances * (score.count > s.count) for s in fewer)
    return all(_value(score, criterion) < limit for limit in limits)


def _is_weak(problem: FitProblem, refined: Refined) -> bool:
    """Return whether a gain, or the damping of a resonance, is less than twice its error: it fits noise."""
    covariance, modes = refined.covariance, refined.resonances
    if covariance is None:
        return True
    n, variances = modes.count, np.diag(covariance)
    gains = [variances[modes.places(r, problem.free)["gain"]] for r in range(modes.responses)]
    dampings = np.sqrt(variances[n : 2 * n])[modes.in_band(*problem.band)]
    return bool(np.any(dampings > WEAK) or not np.isfinite(gains).all())


def _slope_in_band(problem: FitProblem, modes: Resonances) -> Whole:
    """Return the powers of s that the band shows: poles and zeros far below it are such powers."""
    low = problem.band[0] / FAR_OUTSIDE
    poles = 2 * np.sum(modes.omega_p < low) + np.sum(modes.real_p < low)
    zeros = 2 * np.sum(np.abs(modes.omega_z) < low, axis=1) + (np.abs(modes.real_z) < low)
    return np.asarray(modes.slope + zeros - poles, np.int64)


def _continued(
    problem: FitProblem,
    thin: FitProblem,
    quick: Candidate,
    tried: Sequence[Candidate],
    kind: str,
    stages: Stages,
) -> Candidate:
    """Return where a quick fit leads with all steps, on all lines and with the window."""
    best = stages.within(THOROUGH_SHARE, lambda: _thorough(thin, quick, kind), lambda: quick)
    # Another power of s, with as many poles or fewer, may describe the lines as well; more poles with another
    # power are the same function where one of them is at the end of the band.
    near = [one for one in tried if one.order <= best.order] + [best]
    rivals = [rival for one in near for rival in (one.refined, one.rival) if rival is not None]
    slope, limit = _slope_in_band(thin, best.refined.resonances), _merit(thin, best.refined) + CLEAR
    others = [one for one in rivals if np.any(_slope_in_band(thin, one.resonances) != slope)]
    best = replace(best, is_rivalled=any(_merit(thin, rival) < limit for rival in others))
    if len(thin.slopes) > 1 and thin.band[1] <= NARROW_BAND * thin.band[0]:
        best = stages.within(THOROUGH_SHARE, lambda: _with_least_power(thin, best), lambda: best)
    if thin.count == problem.count and all(line.observation.matrix is None for line in problem.lines):
        return best
    stages.budget.progress.report(THOROUGH_SHARE, f"fit with {best.order} poles to {problem.count} lines")
    refined = stages.within(
        LAST_SHARE,
        lambda: refine_directly(problem, best.refined.resonances, 3 * STEPS),
        lambda: refine_directly(problem, best.refined.resonances, 0),
    )
    return replace(best, refined=refined, failure=_failure(problem, refined))


def _thorough(thin: FitProblem, quick: Candidate, kind: str) -> Candidate:
    """Return where a quick fit leads with all steps, and from other starts where it leaves something."""
    best = refitted(quick, thin, 3 * STEPS)
    best = _signs_tried(thin, _without_far_poles(thin, _simplified(thin, best, is_quick=False)))
    best = _simplest(thin, best) if thin.is_exact else best
    if best.failure is not None or not _is_explained(thin, best.refined):
        again = best_of_starts(thin, quick.order, kind)
        if again is not None and _is_better(thin, again, best):
            best = again
    return best


def _value(score: Score, criterion: str) -> float:
    return score.bic if criterion == "bic" else score.aicc


def _negligible(problem: FitProblem) -> float:
    """Return the mean square below which residuals tell nothing: the noise of a record is known roughly."""
    is_rough = any(line.coherence is not None and line.measured.is_record for line in problem.lines)
    return WELL_BELOW if is_rough and not problem.is_noise_known else NEGLIGIBLE


def _merit(problem: FitProblem, refined: Refined, correlation: float = 1.0) -> float:
    """Return the BIC of a minimum, for fits of the same lines with other zeros; strange ones cost."""
    size = problem.size / max(correlation, 1.0)
    fit = size * np.log(refined.cost / problem.size + _negligible(problem))
    merit = float(fit + refined.parameters * np.log(size))
    modes = refined.resonances
    improper = 0 if problem.has_base else int(modes.is_improper.sum())
    return merit + STRANGE * (improper + strange(modes.omega_z, modes.zeta_z, modes.real_z, *problem.band))


def _is_better(problem: FitProblem, candidate: Candidate, best: Candidate) -> bool:
    if (candidate.failure is None) != (best.failure is None):
        failed, usable = (candidate, best) if best.failure is None else (best, candidate)
        is_far_worse = usable.refined.cost > FAR_BETTER * failed.refined.cost + NEGLIGIBLE * problem.count
        return (candidate is usable) != is_far_worse
    # What a model lacks makes its residuals correlated; the better one of the two shows the noise.
    least = min(candidate.refined.correlation, best.refined.correlation)
    return _merit(problem, candidate.refined, least) < _merit(problem, best.refined, least) - LOWER


def _better_of(
    problem: FitProblem, best: Candidate, start: Resonances, *, is_quick: bool = False
) -> Candidate:
    """Return where another start leads, if that is better than the fit so far."""
    refined = refine_directly(problem, start, *(QUICK if is_quick else THOROUGH))
    failure = _failure(problem, refined, is_quick=is_quick)
    candidate = replace(best, order=start.order, refined=refined, failure=failure)
    return candidate if _is_better(problem, candidate, best) else best


def _simplified(problem: FitProblem, best: Candidate, *, is_quick: bool) -> Candidate:
    """Return the fit without the pairs of zeros that lie outside the band and explain nothing."""
    # A pair far above the band is left out; one far below is a power of s, where that may be chosen, and so
    # are two real zeros of which one lies below and one above.
    for r in range(len(problem.lines)):
        for i in (*reversed(range(best.refined.resonances.count)), None):
            now = best.refined.resonances
            start = _without_zeros(now, r, i, *problem.band)
            if start is None or start.slope[r] not in (now.slope[r], *problem.slopes):
                continue
            if _is_promising(problem, r, now, start):
                best = _better_of(problem, best, start, is_quick=is_quick)
    return best


def _without_zeros(now: Resonances, r: int, i: int | None, low: float, high: float) -> Resonances | None:
    """Return a fit without a pair of zeros, or the real one, outside the band; ``None`` if it is inside."""
    omega_z, real_z = now.omega_z.copy(), now.real_z.copy()
    gain, slope = now.gain.copy(), now.slope.copy()
    zeros, index = (real_z, r) if i is None else (omega_z, (r, i))
    size, twice = abs(zeros[index]), 0.0 if i is None else 2 * now.zeta_z[r, i]
    is_apart = size < low * abs(twice) and abs(twice) * size > high  # two real ones
    if not np.isfinite(size) or (low <= size <= high and not is_apart):
        return None
    if is_apart:
        slope[r] += 1
        gain[r] *= twice / size
    elif size < low and i is None:
        slope[r] += 1
        gain[r] /= real_z[r]
    elif size < low:
        slope[r] += 2
        gain[r] *= np.sign(omega_z[r, i]) / size**2
    zeros[index] = np.inf
    return replace(now, omega_z=omega_z, real_z=real_z, gain=gain, slope=slope).ordered()


def _without_far_poles(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit without real poles so far outside the band that they are a gain, or a power of s."""
    now = best.refined.resonances
    low, high = problem.band[0] / FAR_OUTSIDE, problem.band[1] * FAR_OUTSIDE
    corners = now.real_corners()
    for k, corner in enumerate(corners):
        if low <= corner <= high:
            continue
        start = now.with_real_corners(corners[:k] + corners[k + 1 :])
        if start is not None and corner < low:
            start = replace(start, slope=start.slope - 1, gain=start.gain * corner)
        if start is None or not set(start.slope.tolist()) <= set(problem.slopes):
            continue
        fewer = _better_of(problem, best, start)
        if fewer is not best:
            return _without_far_poles(problem, fewer)
    return best


def _simplest(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit to computed lines without poles and zeros that leave no more than rounding does."""
    modes, limit = best.refined.resonances, FAR_BETTER * (best.refined.reduced + NEGLIGIBLE)
    pairs = modes.omega_p * (-modes.zeta_p + 1j * np.sqrt(np.maximum(1 - modes.zeta_p**2, 0)))
    poles = np.append(pairs[modes.zeta_p < 1], -np.array(modes.real_corners(), np.complex128))
    found = [best.refined]
    for k in range(poles.size + 1):
        for _, start in over_poles(problem, np.delete(poles, slice(k, k + 1)), MOST_SHAPES):
            if start.size(problem.free) < found[-1].parameters:
                refined = refine_directly(problem, start, *QUICK)
                found += [refined] * (refined.reduced <= limit)
    if len(found) == 1:
        return best
    simpler = refitted(replace(best, refined=found[-1]), problem)
    return _simplest(problem, replace(simpler, order=simpler.refined.resonances.order))


def _with_least_power(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit in a narrow band with the power of s nearest to 0 of those that fit as well."""
    now, middle = best.refined.resonances, np.sqrt(problem.band[0] * problem.band[1])
    least = np.sign(now.slope) * (np.abs(now.slope) % 2)
    others = []
    for slope in (least, least + 2, least - 2):
        turns = (slope - now.slope).astype(float)  # even, so that each changes the sign at most
        gain = now.gain * (-1.0) ** (turns / 2) / middle**turns
        others.append(refine_directly(problem, replace(now, slope=slope, gain=gain), *THOROUGH))
    limit = min(_merit(problem, one) for one in (*others, best.refined)) + CLEAR
    alike = [one for one in (*others, best.refined) if _merit(problem, one) < limit]
    return replace(best, refined=alike[0], is_rivalled=best.is_rivalled or len(alike) > 1)


def _signs_tried(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit after trying each pair of zeros in the other half-plane: magnitude hardly tells."""
    for r in range(len(problem.lines)):
        for i in range(best.refined.resonances.count):
            now = best.refined.resonances
            if not 0 < now.omega_z[r, i] < np.inf:
                continue
            flipped = now.zeta_z.copy()
            flipped[r, i] = -flipped[r, i]
            start = replace(now, zeta_z=flipped)
            if _logarithmic_cost(problem, start) > MOST_RISE * _logarithmic_cost(problem, now):
                continue
            if _is_promising(problem, r, now, start):
                best = _better_of(problem, best, start)
    return best


def _is_promising(problem: FitProblem, r: int, now: Resonances, start: Resonances) -> bool:
    """Return whether one response of several is described better from another start, by poles of its own."""
    if len(problem.lines) == 1:
        return True
    single = replace(problem, lines=problem.lines[r : r + 1], delays=problem.delays[r : r + 1])
    best, other = (refine_directly(single, one.one(r), *QUICK) for one in (now, start))
    return _merit(single, other) < _merit(single, best) - LOWER


def _logarithmic_cost(problem: FitProblem, resonances: Resonances) -> float:
    """Return the sum of squares of ln(G/H), which counts peaks and troughs alike."""
    return sum(
        float(np.sum(np.abs(np.log(problem.values(resonances, r) / line.measured.values)) ** 2))
        for r, line in enumerate(problem.lines)
    )


def _is_enough(problem: FitProblem, best: Candidate) -> bool:
    return best.failure is None and _is_explained(problem, best.refined)


def _is_explained(problem: FitProblem, refined: Refined) -> bool:
    """Return whether the residual is no larger than coherence says: no other start can do better."""
    return problem.has_scale and refined.reduced < EXPLAINED


def _failure(problem: FitProblem, refined: Refined, *, is_quick: bool = False) -> Diagnostic | None:
    """Return why a minimum had better not be a result, None when it may."""
    if not (refined.has_converged or is_quick) or not np.isfinite(refined.cost):
        hint = "ask for fewer resonances, or for another --start"
        return Diagnostic("SF612", "the fit did not converge", None, hint)
    # Residual terms may be undetermined: what a mode far outside damps is not seen in the band.
    modes, covariance = np.tile(refined.resonances.in_band(*problem.band), 2), refined.covariance
    if covariance is not None and np.isfinite(np.diag(covariance)[: modes.size][modes]).all():
        return None
    message = "the data do not determine all parameters: their covariance is singular"
    return Diagnostic("SF613", message, None, "ask for fewer resonances, or measure a wider band")


def with_own_noise(candidate: Candidate, problem: FitProblem) -> tuple[Candidate, FitProblem]:
    """Return the fit with the noise estimated from its own residuals, where they are the smaller ones."""
    refined, reference = candidate.refined, problem.reference
    if reference is None or lack_of_fit(problem, refined) < UNLIKELY:
        return candidate, problem
    if problem.is_exact:  # magnitudes of many decades, which a sum of fractions cannot follow
        alike = tuple(replace(line, deviation=None) for line in problem.lines)
        refined = refine_directly(replace(problem, lines=alike), refined.resonances, 2 * STEPS)
    values = [problem.values(refined.resonances, r) for r in range(len(problem.lines))]
    own_noise = estimated(problem, values, refined.parameters)
    again = refine_directly(own_noise, refined.resonances, 2 * STEPS)
    if _failure(own_noise, again) is not None:
        return candidate, problem
    return replace(candidate, refined=again), own_noise


def refitted(candidate: Candidate, problem: FitProblem, steps: int = 2 * STEPS) -> Candidate:
    """Return the fit to a problem with other lines, or more steps, than those it was found with."""
    refined = refine_directly(problem, candidate.refined.resonances, steps)
    return replace(candidate, refined=refined, failure=_failure(problem, refined))


def lack_of_fit(problem: FitProblem, refined: Refined) -> float:
    """Return how likely noise alone leaves so much more than a function without structure does."""
    # What neighbouring lines share, as rounded numbers do, counts once: the ratio is over their correlation.
    reference = problem.reference
    if reference is None:
        return 1.0
    spare = max(reference.parameters - refined.parameters, 1)
    freedom = max(problem.size - reference.parameters, 1)
    ratio = (refined.cost - reference.cost) / spare / (reference.cost / freedom)
    ratio /= max(refined.correlation, 1.0)
    return float(fdtrc(spare, freedom, ratio)) if ratio > 0 else 1.0


def _score(problem: FitProblem, candidate: Candidate, correlation: float) -> Score:
    """Return the criteria, with as many independent values as correlated lines are worth."""
    refined = candidate.refined
    is_decaying = any(line.measured.decay_rate for line in problem.lines)
    size = problem.size / max(correlation, HALF_FORGOTTEN if is_decaying else 1.0)
    parameters = refined.parameters
    fit = size * float(np.log(refined.cost / problem.size + _negligible(problem)))
    spare = size - parameters - 1
    aicc = fit + 2 * parameters + (2 * parameters * (parameters + 1) / spare if spare > 0 else np.inf)
    bic = fit + parameters * float(np.log(size))
    count = int(refined.resonances.in_band(*problem.band).sum())
    status = "usable" if candidate.failure is None else "failed"
    return Score(candidate.order, count, parameters, bic, float(aicc), refined.reduced, status)
