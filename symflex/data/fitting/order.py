"""From data to the best fit with a number of resonances, given or chosen by an information criterion.

One resonance at 10 Hz, measured on 300 lines with 1 % of noise:

    resonances                        0      1      2      3
    sum of squares per freedom     3267   0.995  0.972  0.955
    BIC                            4860     24     31     42

One is chosen: its BIC is the least, and two or three explain less than their parameters cost. A number is
tried with few steps of the search first; the one preferred is then fitted to the end, and given up where a
damping ratio is lost in its own error, or where the evidence for it is not strong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import f

from symflex.data.fitting.least_squares import STEPS, Refined, refine, refine_directly
from symflex.data.fitting.numerator import STRANGE, over_poles, strange
from symflex.data.fitting.problem import FitProblem, estimated
from symflex.data.fitting.resonances import Complex, Resonances
from symflex.data.fitting.starts import (
    find_modes,
    poles_from_aaa,
    poles_from_vector_fitting,
    relocated,
    start_from_peaks,
)
from symflex.errors import Diagnostic, FitError

CRITERIA = ("bic", "aicc")
MOST_MODES = 12
"""Beyond, ask for a number: each one tried costs a fit from up to three kinds of starts."""
PATIENCE, MORE_PATIENCE = 1, 3
"""Numbers of resonances tried after the best: where the noise is nearly reached, and where it is far."""
QUICK_STEPS = 25
"""A quarter of the steps of a whole search, enough to compare numbers of resonances."""
EXPLAINED = 1.15
"""Sum of squares per degree of freedom up to which noise explains what is left; 1 is expected."""
WEAK = 0.5
"""Standard error of ln zeta beyond which fewer resonances are preferred, unless that is far worse."""
FAR_BETTER = 4.0
"""Ratio of sums of squares at which a failed fit is said rather than replaced, and a weak one kept."""
LOWER = 0.5
"""How far the BIC has to fall for another start to count as better."""
NEGLIGIBLE = 1e-6
"""Mean square, in units of the noise, below which residuals are rounding and tell nothing apart."""
MOST_NUMERATORS = 3
"""The likeliest numerators over each choice of poles that are fitted."""
SAME = 1e-3
"""Relative distance below which two starts have the same poles."""
MOST_RISE = 1.5
"""Zeros moved to the other half plane are a start where the misfit rises by no more than this factor."""
CLEAR = 6.0
"""Difference of BIC that is strong evidence (Kass & Raftery, J. Am. Stat. Assoc. 90, 1995)."""
UNLIKELY = 1e-5
"""Share of right fits that may be called poor for what a function without structure describes better."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """The best fit with one number of resonances."""

    count: int  # how many resonances
    start_kind: str  # the key of :data:`STARTS` that led to it
    start: Resonances  # where it began
    refined: Refined  # where it ended
    failure: Diagnostic | None  # why it cannot be a result
    rival: Refined | None = None  # the best fit met with another power of s


@dataclass(frozen=True, slots=True)
class Score:
    """What the criteria say of one number of resonances; lower is better."""

    # count and parameters: resonances and parameters.
    count: int
    parameters: int
    # bic and aicc: schwarz 1978; Hurvich & Tsai 1989.
    bic: float
    aicc: float
    reduced: float  # the sum of squares per degree of freedom
    # ``usable``; ``failed`` when the fit did; ``weak`` when it has a damping ratio lost in its own error, or
    # strong evidence for one resonance more is missing.
    status: str

    @property
    def is_usable(self) -> bool:
        """Whether it is a result."""
        return self.status == "usable"


def _from_peaks(problem: FitProblem, count: int) -> Iterator[Resonances]:
    """Return the start of the paper, and what linear least squares put over its poles."""
    slopes = problem.slopes
    if len(slopes) > 1:
        slopes = tuple(slope for slope in (problem.guessed_slope(),) if slope in problem.slopes) or slopes[:1]
    start = start_from_peaks(problem.with_slope(slopes[0]), count)
    if start is None:
        return
    start = replace(start, slope=np.full(start.responses, slopes[0]), delay=np.array(problem.delays))
    yield start
    poles = start.omega_p * (-start.zeta_p + 1j * np.sqrt(1 - start.zeta_p**2))
    yield from _over(problem, [poles, relocated(problem, poles)])


def _over(problem: FitProblem, choices: list[Complex]) -> Iterator[Resonances]:
    """Return the likely functions over each choice of poles."""
    known: list[Complex] = []
    for poles in choices:
        if any(
            other.size == poles.size and np.all(abs(other - poles) < SAME * abs(poles)) for other in known
        ):
            continue
        known.append(poles)
        yield from over_poles(problem, poles, MOST_NUMERATORS)


STARTS: Mapping[str, Callable[[FitProblem, int], Iterator[Resonances]]] = {
    "peaks": _from_peaks,
    "vector": lambda problem, count: _over(problem, poles_from_vector_fitting(problem, count)),
    "aaa": lambda problem, count: _over(problem, poles_from_aaa(problem, count)),
}
"""Ways to begin, the most promising start first; ``auto`` tries all and keeps the best."""


def best_of_starts(
    problem: FitProblem, count: int, kind: str = "auto", *, is_quick: bool = False
) -> Candidate | None:
    """Return the best fit with so many resonances, at least one; None when no start has as many.

    ``kind`` is a key of :data:`STARTS`, or ``auto``. A quick one takes few steps, for comparing numbers of
    resonances.
    """
    kinds = [kind]
    if kind == "auto":
        # On a known base the procedure of the paper is tried first; without, the powers of s are open.
        kinds = list(STARTS) if len(problem.slopes) == 1 else ["vector", "peaks", "aaa"]
    best: Candidate | None = None
    met: list[Refined] = []
    for name in kinds:
        if name == "aaa" and best is not None and best.failure is None and kind == "auto":
            break  # the slowest of the three, for where the others fail
        for start in STARTS[name](problem, count):
            refined = refine(problem, start, steps=QUICK_STEPS if is_quick else STEPS)
            if not (refined.has_converged or is_quick) and (
                best is None or _merit(problem, refined) < _merit(problem, best.refined)
            ):
                refined = refine_directly(problem, refined.resonances, steps=2 * STEPS)
            found = Candidate(count, name, start, refined, _failure(problem, refined, is_quick=is_quick))
            met.append(refined)
            if best is None or _is_better(problem, found, best):
                best = found
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
    problem: FitProblem, kind: str = "auto", criterion: str = "bic"
) -> tuple[Candidate, tuple[Score, ...]]:
    """Return the fit whose number of resonances the criterion prefers, and what it says of all tried.

    SF611 when no resonance improves on the base alone; SF612 to SF614 when the number preferred by far gives
    no fit.
    """
    # Numbers are compared without the window, a sixth of the work; the best one is then fitted with it.
    plain = problem.without_window()
    nothing = _nothing(problem)
    tried = [Candidate(0, "none", nothing, refine(plain, nothing), None)]
    scores = [_score(plain, tried[0], 1.0)]
    worse = 0
    for count in range(1, MOST_MODES + 1):
        found = best_of_starts(plain, count, kind, is_quick=True)
        if found is None:
            break
        tried.append(found)
        scores = [_score(plain, candidate, found.refined.correlation) for candidate in tried]
        usable = [_value(s, criterion) for s in scores[:-1] if s.is_usable]
        is_lower = scores[-1].is_usable and _value(scores[-1], criterion) < min(usable)
        worse = 0 if is_lower else worse + 1
        # Fewer resonances than there are may be no better than none, each with something large left over.
        is_near = min(s.reduced for s in scores) < FAR_BETTER or not problem.is_noise_estimated
        if worse > (PATIENCE if is_near else MORE_PATIENCE):
            break
    weak: tuple[Score, Candidate] | None = None
    failed: list[tuple[Score, Diagnostic]] = []
    least = min(s.reduced for s in scores if s.is_usable)
    # A quick fit may have failed for want of steps: where it is far better than the others, it gets them.
    worth = [s for s in scores if s.is_usable or FAR_BETTER * (s.reduced + NEGLIGIBLE) < least]
    for score in sorted(worth, key=lambda s: _value(s, criterion)):
        if weak is not None and FAR_BETTER * (weak[0].reduced + NEGLIGIBLE) < score.reduced:
            return weak[1], tuple(scores)
        for better, failure in failed:
            if FAR_BETTER * (better.reduced + NEGLIGIBLE) < score.reduced:
                raise FitError(_preferred(better, failure, problem_has_base=problem.has_base))
        if score.count == 0:
            break
        best = _continued(problem, tried[score.count])
        if best.failure is not None or not _is_explained(problem, best.refined):
            again = best_of_starts(problem, score.count, kind)
            if again is not None and _is_better(problem, again, best):
                best = again
        if best.failure is not None:
            failed.append((score, best.failure))
            scores = _marked(scores, score.count, "failed")
        elif _is_weak(best.refined) or not _is_founded(scores, score, criterion):
            weak = weak or (score, best)
            scores = _marked(scores, score.count, "weak")
        else:
            return best, tuple(_marked(scores, score.count, "usable"))
    raise FitError(no_resonance(problem))


def _marked(scores: Sequence[Score], count: int, status: str) -> list[Score]:
    return [replace(score, status=status) if score.count == count else score for score in scores]


def _preferred(score: Score, failure: Diagnostic, *, problem_has_base: bool) -> Diagnostic:
    """Return the failure of the number that the criterion prefers by far."""
    message = f"{score.count} resonances describe the data far better than fewer do, but {failure.message}"
    known = "check --base" if problem_has_base else "give what is known of the system with --base"
    hint = f"{known}, or a number with --modes"
    return Diagnostic(failure.code, message, None, hint)


def _is_founded(scores: Sequence[Score], score: Score, criterion: str) -> bool:
    """Return whether there is strong evidence for so many: one more may have found its place in the noise."""
    fewer = [_value(s, criterion) for s in scores if s.count < score.count and s.status != "failed"]
    return not fewer or _value(score, criterion) < min(fewer) - CLEAR


def _is_weak(refined: Refined) -> bool:
    """Return whether the damping of a pole is lost in its own error: such a resonance fits noise."""
    covariance = refined.covariance
    if covariance is None:
        return True
    n = refined.resonances.count
    return bool(np.any(np.sqrt(np.diag(covariance)[n : 2 * n]) > WEAK))


def _continued(problem: FitProblem, quick: Candidate) -> Candidate:
    """Return where a quick fit leads with all steps, and with the window."""
    refined = refine_directly(problem, quick.refined.resonances, steps=3 * STEPS)
    return _signs_tried(problem, replace(quick, refined=refined, failure=_failure(problem, refined)))


def _value(score: Score, criterion: str) -> float:
    return score.bic if criterion == "bic" else score.aicc


def no_resonance(problem: FitProblem) -> Diagnostic:
    """Return the message that there is nothing to fit."""
    low, high = (value / (2 * np.pi) for value in problem.band)
    message = f"the data show no resonance between {low:.4g} and {high:.4g} Hz"
    if problem.has_base:
        message += " that the base does not have"
    what = "the base and the band" if problem.has_base else "the data and the band"
    return Diagnostic("SF611", message, None, f"check {what}; --modes N asks for N all the same")


def too_few(problem: FitProblem, count: int, kind: str) -> Diagnostic:
    """Return the message that no start has as many resonances as asked for."""
    if kind in ("auto", "peaks"):
        seen = len(find_modes(problem))
        message = f"{count} resonances are asked for, and the magnitude shows {seen} peaks"
        message += " over the base" if problem.has_base else ""
    else:
        message = f"{count} resonances are asked for, and '{kind}' finds fewer"
    return Diagnostic("SF611", message, None, "ask for fewer with --modes, or try --start vector")


def undetermined() -> Diagnostic:
    """Return the message that the parameters have no covariance."""
    return Diagnostic(
        "SF613",
        "the data do not determine all parameters: their covariance is singular",
        None,
        "ask for fewer resonances, or measure a wider band",
    )


def _nothing(problem: FitProblem) -> Resonances:
    """Return the function without resonances: the base, or a gain and a power of s."""
    none = np.zeros(0, np.complex128)
    empty = np.zeros((len(problem.lines), 0))
    plain = Resonances(none.real, none.real, empty, empty, np.ones(len(problem.lines)))
    return next(iter(over_poles(problem, none, 1)), plain)


def _merit(problem: FitProblem, refined: Refined) -> float:
    """Return the BIC of a minimum, for fits of the same lines with other zeros; strange ones cost."""
    size = 2 * problem.count
    merit = float(size * np.log(refined.cost / size + NEGLIGIBLE) + refined.parameters * np.log(size))
    found = refined.resonances
    return merit + STRANGE * int(strange(found.omega_z, found.zeta_z, *problem.band).sum())


def _is_better(problem: FitProblem, found: Candidate, best: Candidate) -> bool:
    if (found.failure is None) != (best.failure is None):
        failed, usable = (found, best) if best.failure is None else (best, found)
        is_far_worse = usable.refined.cost > FAR_BETTER * failed.refined.cost + NEGLIGIBLE * problem.count
        return (found is usable) != is_far_worse
    return _merit(problem, found.refined) < _merit(problem, best.refined) - LOWER


def _simplified(problem: FitProblem, best: Candidate, *, is_quick: bool) -> Candidate:
    """Return the fit without the pairs of zeros that lie outside the band and explain nothing.

    A pair far above the band is left out; one far below is a power of s, where that may be chosen.
    """
    low, high = problem.band
    steps = QUICK_STEPS if is_quick else STEPS
    for r in range(len(problem.lines)):
        for i in reversed(range(best.count)):
            now = best.refined.resonances
            place = abs(now.omega_z[r, i])
            if not np.isfinite(place) or low <= place <= high:
                continue
            omega_z, gain, slope = now.omega_z.copy(), now.gain.copy(), now.slope.copy()
            if place < low:
                slope[r] += 2
                gain[r] *= np.sign(omega_z[r, i]) / place**2
                if slope[r] not in problem.slopes:
                    continue
            omega_z[r, i] = np.inf
            start = replace(now, omega_z=omega_z, gain=gain, slope=slope).ordered()
            refined = refine_directly(problem, start, steps=steps)
            found = replace(best, refined=refined, failure=_failure(problem, refined, is_quick=is_quick))
            if _is_better(problem, found, best):
                best = found
    return best


def _signs_tried(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit after trying each pair of zeros in the other half plane: magnitude hardly tells."""
    for r in range(len(problem.lines)):
        for i in range(best.count):
            now = best.refined.resonances
            if not 0 < now.omega_z[r, i] < np.inf:
                continue
            flipped = now.zeta_z.copy()
            flipped[r, i] = -flipped[r, i]
            start = replace(now, zeta_z=flipped)
            if _logarithmic_cost(problem, start) > MOST_RISE * _logarithmic_cost(problem, now):
                continue
            refined = refine_directly(problem, start)
            found = replace(best, refined=refined, failure=_failure(problem, refined))
            if _is_better(problem, found, best):
                best = found
    return best


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
    return (problem.is_noise_known or problem.is_noise_estimated) and refined.reduced < EXPLAINED


def _failure(problem: FitProblem, refined: Refined, *, is_quick: bool = False) -> Diagnostic | None:
    """Return why a minimum cannot be a result, None when it can."""
    if not (refined.has_converged or is_quick) or not np.isfinite(refined.cost):
        hint = "ask for fewer resonances, or for another --start"
        return Diagnostic("SF612", "the fit did not converge", None, hint)
    if refined.covariance is None:
        return undetermined()
    low, high = problem.band
    if not problem.has_base and np.any(refined.resonances.zeta_p >= 1):
        i = int(np.argmax(refined.resonances.zeta_p))
        message = f"pole pair {i + 1} has the damping ratio {refined.resonances.zeta_p[i]:.3g}"
        hint = "ask for fewer resonances, or give what is known of the system with --base"
        return Diagnostic("SF614", f"{message}: two real poles, no resonance", None, hint)
    for i, omega in enumerate(refined.resonances.omega_p.tolist()):
        if not low <= omega <= high:
            message = (
                f"pole pair {i + 1} went to {omega / (2 * np.pi):.4g} Hz, outside the band measured, "
                f"{low / (2 * np.pi):.4g} to {high / (2 * np.pi):.4g} Hz"
            )
            return Diagnostic("SF614", message, None, "ask for fewer resonances, or check the base")
    return None


def with_own_noise(candidate: Candidate, problem: FitProblem) -> tuple[Candidate, FitProblem]:
    """Return the fit with the noise estimated from its own residuals, where they are the smaller ones."""
    refined, reference = candidate.refined, problem.reference
    if reference is None or lack_of_fit(problem, refined) < UNLIKELY:
        return candidate, problem
    values = [problem.values(refined.resonances, r) for r in range(len(problem.lines))]
    own = estimated(problem, values, refined.parameters)
    again = refine_directly(own, refined.resonances, steps=2 * STEPS)
    if _failure(own, again) is not None:
        return candidate, problem
    return replace(candidate, refined=again), own


def is_rivalled(problem: FitProblem, candidate: Candidate) -> bool:
    """Return whether another power of s describes the lines as well."""
    if candidate.rival is None:
        return False
    return _merit(problem, candidate.rival) < _merit(problem, candidate.refined) + CLEAR


def lack_of_fit(problem: FitProblem, refined: Refined) -> float:
    """Return how likely noise alone leaves so much more than a function without structure does."""
    reference = problem.reference
    if reference is None:
        return 1.0
    spare = max(reference.parameters - refined.parameters, 1)
    freedom = max(2 * problem.count - reference.parameters, 1)
    ratio = (refined.cost - reference.cost) / spare / (reference.cost / freedom)
    return float(f.sf(ratio, spare, freedom)) if ratio > 0 else 1.0


def _score(problem: FitProblem, candidate: Candidate, correlation: float) -> Score:
    """Return the criteria, with as many independent values as correlated lines are worth."""
    refined = candidate.refined
    size = 2 * problem.count / max(correlation, 1.0)
    parameters = refined.parameters
    fit = size * float(np.log(refined.cost / (2 * problem.count) + NEGLIGIBLE))
    spare = size - parameters - 1
    aicc = fit + 2 * parameters + (2 * parameters * (parameters + 1) / spare if spare > 0 else np.inf)
    return Score(
        candidate.count,
        parameters,
        fit + parameters * float(np.log(size)),
        float(aicc),
        refined.reduced,
        "usable" if candidate.failure is None else "failed",
    )
