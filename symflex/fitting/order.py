"""From data to the best fit with a number of resonances, given or chosen by an information criterion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from symflex.errors import Diagnostic, FitError
from symflex.fitting.least_squares import STEPS, Refined, refine, refine_directly
from symflex.fitting.peaks import find_modes, start_from_peaks
from symflex.fitting.rational_start import start_from_aaa, start_from_vector_fitting
from symflex.fitting.resonances import Resonances

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.fitting.problem import FitProblem

STARTS: Mapping[str, Callable[[FitProblem, int], Resonances | None]] = {
    "peaks": start_from_peaks,
    "vector": start_from_vector_fitting,
    "aaa": start_from_aaa,
}
"""Ways to begin; ``auto`` tries all and keeps the lowest residual."""

CRITERIA = ("bic", "aicc")
MOST_MODES = 12
PATIENCE = 1
QUICK_STEPS = 25
EXPLAINED = 1.15
WEAK = 0.5
"""Standard error of ln zeta beyond which fewer resonances are preferred, unless that is far worse."""
FAR_BETTER = 4.0
"""Ratio of sums of squares at which a failed fit is said rather than replaced, and a weak one kept."""
LOWER = 0.999
"""How far a residual has to fall for another start to count as better."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """The best fit with one number of resonances.

    Parameters
    ----------
    count : int
        How many resonances.
    start_kind : str
        The key of :data:`STARTS` that led to it.
    start : Resonances
        Where it began.
    refined : Refined
        Where it ended.
    failure : Diagnostic or None
        Why it is no result.
    """

    count: int
    start_kind: str
    start: Resonances
    refined: Refined
    failure: Diagnostic | None


@dataclass(frozen=True, slots=True)
class Score:
    """What the criteria say of one number of resonances; lower is better.

    Parameters
    ----------
    count, parameters : int
        Resonances and parameters.
    bic, aicc : float
        Schwarz 1978; Hurvich & Tsai 1989.
    reduced : float
        The sum of squares per degree of freedom.
    status : str
        ``usable``; ``failed`` when the fit did; ``weak`` when it has a damping ratio lost in its own error.
    """

    count: int
    parameters: int
    bic: float
    aicc: float
    reduced: float
    status: str

    @property
    def is_usable(self) -> bool:
        """Whether it is a result."""
        return self.status == "usable"


def best_of_starts(
    problem: FitProblem, count: int, kind: str = "auto", *, is_quick: bool = False
) -> Candidate | None:
    """Return the best fit with so many resonances; None when no start has as many.

    Parameters
    ----------
    problem : FitProblem
        What is fitted.
    count : int
        At least one.
    kind : str
        A key of :data:`STARTS`, or ``auto``.
    is_quick : bool
        With few steps, for comparing numbers of resonances.
    """
    kinds = list(STARTS) if kind == "auto" else [kind]
    best: Candidate | None = None
    for name in kinds:
        if name == "aaa" and best is not None and best.failure is None and kind == "auto":
            break  # the slowest of the three, for where the others fail
        start = STARTS[name](problem, count)
        if start is None:
            continue
        refined = refine(problem, start, steps=QUICK_STEPS if is_quick else STEPS)
        failure = _failure(problem, refined, is_quick=is_quick)
        found = Candidate(count, name, start, refined, failure)
        if best is None or _is_better(found, best):
            best = found
        if best.failure is None and _is_explained(problem, best.refined):
            break
    return best if best is None or is_quick else _signs_tried(problem, best)


def chosen_order(
    problem: FitProblem, kind: str = "auto", criterion: str = "bic"
) -> tuple[Candidate, tuple[Score, ...]]:
    """Return the fit whose number of resonances the criterion prefers, and what it says of all tried.

    Raises
    ------
    FitError
        SF611 when no resonance improves on the base alone; SF612 to SF614 when the number preferred by far
        gives no fit.
    """
    # Numbers are compared without the window, a sixth of the work; the best one is then fitted with it.
    plain = problem.without_window()
    nothing = no_resonances(problem)
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
        if worse > PATIENCE:
            break
    weak: tuple[Score, Candidate] | None = None
    failed: list[tuple[Score, Diagnostic]] = []
    least = min(s.reduced for s in scores if s.is_usable)
    # A quick fit may have failed for want of steps: where it is far better than the others, it gets them.
    worth = [s for s in scores if s.is_usable or FAR_BETTER * s.reduced < least]
    for score in sorted(worth, key=lambda s: _value(s, criterion)):
        if weak is not None and FAR_BETTER * weak[0].reduced < score.reduced:
            return weak[1], tuple(scores)
        for better, failure in failed:
            if FAR_BETTER * better.reduced < score.reduced:
                raise FitError(_preferred(better, failure, problem_has_base=problem.has_base))
        if score.count == 0:
            break
        best = _continued(problem, tried[score.count])
        if best.failure is not None or not _is_explained(problem, best.refined):
            again = best_of_starts(problem, score.count, kind)
            if again is not None and _is_better(again, best):
                best = again
        if best.failure is not None:
            failed.append((score, best.failure))
            scores = _marked(scores, score.count, "failed")
        elif _is_weak(best.refined):
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


def no_resonances(problem: FitProblem) -> Resonances:
    """Return a gain near the median of each response, and nothing else."""
    gains = []
    for line in problem.lines:
        middle = complex(np.median(line.ratio.real), 0)
        size = float(np.exp(np.median(np.log(np.abs(line.ratio)))))
        gains.append((size if middle.real >= 0 else -size) if problem.free.gain else 1.0)
    empty = np.zeros((len(gains), 0))
    return Resonances(np.zeros(0), np.zeros(0), empty, empty, np.array(gains))


def _is_better(found: Candidate, best: Candidate) -> bool:
    if (found.failure is None) != (best.failure is None):
        return found.failure is None
    return found.refined.cost < LOWER * best.refined.cost


def _signs_tried(problem: FitProblem, best: Candidate) -> Candidate:
    """Return the fit after trying each pair of zeros in the other half plane: magnitude hardly tells."""
    for r in range(len(problem.lines)):
        for i in range(best.count):
            now = best.refined.resonances
            flipped = now.zeta_z.copy()
            flipped[r, i] = -flipped[r, i]
            start = Resonances(now.omega_p, now.zeta_p, now.omega_z, flipped, now.gain, now.lag)
            residual = sum(
                float(np.sum(np.abs(np.log(problem.values(start, k) / line.measured.values)) ** 2))
                for k, line in enumerate(problem.lines)
            )
            before = sum(
                float(np.sum(np.abs(np.log(problem.values(now, k) / line.measured.values)) ** 2))
                for k, line in enumerate(problem.lines)
            )
            if residual > 1.5 * before:
                continue
            refined = refine_directly(problem, start)
            found = replace(best, refined=refined, failure=_failure(problem, refined))
            if _is_better(found, best):
                best = found
    return best


def _is_explained(problem: FitProblem, refined: Refined) -> bool:
    """Return whether the residual is no larger than coherence says: no other start can do better."""
    known = problem.has_deviations and all(line.measured.averages for line in problem.lines)
    return known and refined.reduced < EXPLAINED


def _failure(problem: FitProblem, refined: Refined, *, is_quick: bool = False) -> Diagnostic | None:
    """Return why a minimum is no result, None when it is one."""
    if not (refined.has_converged or is_quick) or not np.isfinite(refined.cost):
        hint = "ask for fewer resonances, or for another --start"
        return Diagnostic("SF612", "the fit did not converge", None, hint)
    if refined.covariance is None:
        return undetermined()
    low, high = problem.band
    for i, omega in enumerate(refined.resonances.omega_p.tolist()):
        if not low <= omega <= high:
            message = (
                f"pole pair {i + 1} went to {omega / (2 * np.pi):.4g} Hz, outside the band measured, "
                f"{low / (2 * np.pi):.4g} to {high / (2 * np.pi):.4g} Hz"
            )
            return Diagnostic("SF614", message, None, "ask for fewer resonances, or check the base")
    return None


def _score(problem: FitProblem, candidate: Candidate, correlation: float) -> Score:
    """Return the criteria, with as many independent values as correlated lines are worth."""
    refined = candidate.refined
    size = 2 * problem.count / max(correlation, 1.0)
    parameters = refined.parameters
    fit = size * float(np.log(max(refined.cost, np.finfo(float).tiny) / (2 * problem.count)))
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
