"""A fit of resonances to measured responses, and everything that is reported of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from symflex.data.fitting.least_squares import FLAT, Refined, widened
from symflex.data.fitting.lines import isolated, single_lines, step_line, wild_lines
from symflex.data.fitting.minimum_phase import PhaseTest, judge_phase, judge_zeros, not_judged
from symflex.data.fitting.noise import rounding, with_noise, with_rough_noise
from symflex.data.fitting.numerator import Residues
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.order import (
    CRITERIA,
    FAR_OFF,
    LAST_SHARE,
    NARROW_BAND,
    NOISE_SHARE,
    PHASE_SHARE,
    STARTS,
    UNLIKELY,
    Candidate,
    Score,
    Stages,
    chosen_order,
    lack_of_fit,
    refitted,
    with_own_noise,
)
from symflex.data.fitting.problem import EXACT, FitProblem, fit_problem
from symflex.data.fitting.record_search import RecordSearch, RecordTerms, Settings, Tried, described
from symflex.data.fitting.resonances import (
    LOGARITHMIC,
    NO_PEAK,
    UNITS,
    Complex,
    Free,
    Mask,
    Real,
    Resonances,
    Values,
    Whole,
)
from symflex.data.fitting.starts import with_delays
from symflex.data.fitting.validation import Validation, validated
from symflex.data.measurement import MeasuredResponse
from symflex.data.measurement.measured_response import ratio_of_units
from symflex.errors import DataError, Diagnostic, FitError, no_such, refused
from symflex.options import FitOptions

SLOPES = tuple(range(-4, 5))
FEWEST_LINES = 8  # of a response that is fitted
WEAK = 0.5  # standard error over the value from which a damping ratio, or a zero, is hardly determined
WEAK_ROUNDED, MOST_ROUNDED = 0.2, 0.25
"""The same, and the share of the noise, where numbers of few digits make it: steps look like resonances."""
LARGE = 2.0  # sum of squares per degree of freedom from which coherence does not explain the residual
MEDIAN = 1.177  # median of the size of a complex Gaussian error whose parts have the deviation 1
DECADE = 10.0  # frequency over that of a band's end, or the reverse, from which a pole is far outside
CLEAN, UNLIKE, MOST_AVERAGES, FEWEST_JUDGED = 0.99, 0.5, 500, 112
"""Median coherence from which its digits decide, loss of likelihood a line from which it is false, averages
that there may be where data do not say, lines that 14 pairs of poles leave enough scatter to judge it by."""
WILD = 6.5  # deviations of each part beyond which a line is wild; noise reaches that once in 10^9 lines
NAMED_LINES = 6  # wild lines whose frequencies are listed
ROUNDS = 3  # rounds in which lines are left out or taken back; they end earlier when nothing changes
MOST_LINES, FEWEST_OF_EACH = 1000, 300  # lines on which numbers of poles are compared, and of each response
DROWNED = 0.5  # deviation of each part over the magnitude from which a line shows noise
DROWNED_DB = 6.0  # misfit of a fit without poles from which noise is as large as the response
OVERDAMPED = 2.0  # damping ratio of a pair of zeros that had better be called two real ones
FAINT = 0.0116  # share of a response: 0.1 dB, which data sheets of analysers give as accuracy
LEAST_DAMPING = 0.05  # damping ratios of zeros below this are not held against their own error
DEFAULTS = FitOptions()
SMOOTH = 3.0  # a Hann window makes this 2, see :attr:`symflex.data.fitting.least_squares.Refined.correlation`


@dataclass(frozen=True, eq=False)
class Base:
    """What the resonances are multiplied by."""

    # Of angular frequencies [rad/s], shape (n,), to complex values.
    function: Callable[[Values], Complex] = field(repr=False)
    tf: str = ""  # ``OUT/IN`` of the specification it comes from; empty for a bare power of s
    path: str = ""  # the specification; empty likewise
    unit: str = ""  # of its values, empty when unknown
    slope: int = 0  # the power of s, where that is all the base is
    taken: tuple[str, ...] = ()  # names of the specification's parameters
    folders: tuple[str | Path, ...] = ()  # that it was allowed to read: its own, and others

    @staticmethod
    def power(slope: int) -> Base:
        """Return the base ``s^slope``."""
        return Base(lambda omega: np.asarray((1j * omega) ** slope, np.complex128), slope=slope)


@dataclass(frozen=True, eq=False)
class ResonanceFit:
    """The result of a fit."""

    problem: FitProblem  # what was fitted
    bases: tuple[Base, ...]  # one per response
    candidate: Candidate  # start and minimum
    # What the criteria say of the numbers of poles tried.
    scores: tuple[Score, ...]
    criterion: str  # the one that chose
    phase_tests: tuple[PhaseTest, ...]  # one per response
    warnings: tuple[str, ...]  # what to be careful about
    # Why the result is poor, so that standard errors do not tell how far off it may be; empty where it is
    # not.
    poor: tuple[str, ...] = ()
    record: RecordTerms | None = None  # what else a fit in time found
    validation: Validation | None = None  # if it was asked for

    def __repr__(self) -> str:
        return f"<ResonanceFit: {self.modes.sum()} resonances of {len(self.bases)} responses>"

    @property
    def resonances(self) -> Resonances:
        """The fitted resonances."""
        return self.candidate.refined.resonances

    @property
    def refined(self) -> Refined:
        """The minimum with its residuals and covariance."""
        return self.candidate.refined

    @property
    def modes(self) -> Mask:
        """Which pole pairs are resonances in the band, shape (n,); the others are residual terms."""
        return self.resonances.in_band(*self.problem.band)

    @property
    def measured(self) -> tuple[MeasuredResponse, ...]:
        """The data, with the lines that were left out."""
        return tuple(line.every.measured for line in self.problem.lines)

    @property
    def leaves_rounding(self) -> bool:
        """Whether the fit leaves no more than the rounding of numbers of six digits or more."""
        if self.record is not None:
            return max(self.record.residual_share) < EXACT
        return self.problem.is_exact and self.refined.reduced < FAR_OFF

    def left_out(self, response: int) -> Whole:
        """Return which lines of a response were left out of the fit, because they are wild."""
        line = self.problem.lines[response]
        return np.flatnonzero(~np.isin(line.every.omega, line.omega))

    def gain_unit(self, response: int) -> str:
        """Return the unit of a response's gain beside its base, or power of s; empty where unknown."""
        base, unit = self.bases[response], self.measured[response].unit
        if base.path:
            return ratio_of_units(unit, base.unit)
        return unit if not base.slope or not unit else ratio_of_units(unit, f"1/s^{base.slope}")

    def values(self, response: int, resonances: Resonances | None = None) -> Complex:
        """Return the fitted (or another) model on the lines of one response, without the window's effect."""
        line = self.problem.lines[response].every
        return line.base_at_lines * (resonances or self.resonances).factor(response, line.omega_seen)

    def curve(self, response: int, frequency_hz: Real, resonances: Resonances | None = None) -> Complex:
        """Return the fitted (or another) model between the lines, as :meth:`values` on them."""
        omega: Values = 2 * np.pi * frequency_hz
        if rate := self.measured[response].decay_rate:  # as MeasuredResponse.omega_seen
            omega = np.asarray(omega - 1j * rate, np.complex128)
        factor = (resonances or self.resonances).factor(response, omega)  # with the power of s without a base
        return factor * self.bases[response].function(omega) if self.bases[response].path else factor

    def real_poles(self) -> list[tuple[float, float]]:
        """Return the corner frequency of each real pole and its standard error [rad/s], ascending."""
        modes, covariance = self.resonances, self.refined.covariance
        n = modes.count
        poles = [(float(p), (2 * n + i, 1.0, 2 * n + i, 0.0)) for i, p in enumerate(modes.real_p)]
        for i in np.flatnonzero(modes.zeta_p >= 1).tolist():
            zeta = float(modes.zeta_p[i])
            root = np.sqrt(max(zeta**2 - 1, np.finfo(float).tiny))
            # d ln(zeta +- root) by ln zeta is +- zeta/root.
            poles += [
                (float(modes.omega_p[i] * (zeta + root) ** sign), (i, 1.0, n + i, sign * zeta / root))
                for sign in (-1, 1)
            ]
        result = []
        for corner, (a, by_a, b, by_b) in poles:
            variance = np.inf
            if covariance is not None and np.isfinite([covariance[a, a], covariance[b, b]]).all():
                variance = by_a**2 * covariance[a, a] + by_b**2 * covariance[b, b]
                variance += 2 * by_a * by_b * covariance[a, b]
            error = corner * np.sqrt(max(variance, 0.0)) if np.isfinite(variance) else np.inf
            result.append((corner, float(error)))
        return sorted(result)

    def standard_errors(self) -> Resonances:
        """Return the standard error of every parameter, in their shape; 0 if fixed, inf if undetermined."""
        modes = self.resonances
        n, free = modes.count, self.problem.free
        covariance = self.refined.covariance
        deviation = np.full(modes.size(free), np.inf)
        if covariance is not None:
            deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        errors = {name: np.zeros_like(getattr(modes, name)) for name in UNITS}
        for name, index, columns in modes.own_places(free):
            sizes = np.abs(getattr(modes, name)[index]) if name in LOGARITHMIC else UNITS[name]
            errors[name][index] = sizes * deviation[columns]
        return replace(
            modes,
            omega_p=modes.omega_p * deviation[:n],
            zeta_p=modes.zeta_p * deviation[n : 2 * n],
            real_p=modes.real_p * deviation[2 * n : modes.shared()],
            **errors,
        )

    def of_response(self, response: int) -> str:
        """Return whose something is, where there are several responses: `` of A_1/F``."""
        return f" of {self.measured[response].name}" if len(self.measured) > 1 else ""

    def misfit_db(self, response: int) -> float:
        """Return the root mean square of model over data on the lines above the noise [dB]."""
        measured, model = self._seen(response)
        return measured.misfit_db(model)

    def misfit_degrees(self, response: int) -> float:
        """Return the root mean square of the phase difference on the lines above the noise [deg]."""
        measured, model = self._seen(response)
        return measured.misfit_degrees(model)

    def _seen(self, response: int) -> tuple[MeasuredResponse, Complex]:
        problem, seen = self.problem, _seen(self.problem, response, self.resonances)
        return problem.lines[response].at(seen).measured, problem.values(self.resonances, response)[seen]


def fit_resonances(
    measured: Sequence[MeasuredResponse], bases: Sequence[Base] | None = None, given: FitOptions = DEFAULTS
) -> ResonanceFit:
    """Fit simple resonances, in cascade with known bases, to responses that share their poles."""
    # Without bases, each is a gain times a power of s, the same for all: ``slope``. ``start`` is a key of
    # :data:`symflex.data.fitting.order.STARTS`, or ``auto`` for the best of all. Pole pairs outside the band
    # and real poles are residual terms, not resonances. Outliers are left out.
    choices = ((given.start, ("auto", *STARTS), "start"), (given.criterion, CRITERIA, "criterion"))
    for name, allowed, what in choices:
        if name not in allowed:
            raise no_such(what, name, allowed, "choose from")
    if bases is not None and given.slope is not None:
        raise refused("a power of s is for fits without a base")
    if bases is None and are_in_time(measured, given):
        in_time = _fit_in_time(measured, given)
        if in_time is not None and in_time.record and in_time.record.poor and _are_many(measured):
            # What an input does between its samples does not enter a response that is a mean of many.
            in_lines = replace(given, is_validated=False)
            of_lines = fit_resonances([replace(one, samples=()) for one in measured], None, in_lines)
            return in_time if of_lines.poor else of_lines
        if in_time is not None:
            return in_time
    if given.is_validated:
        raise refused(
            "--validate is for records that are fitted in time", "without --base, --lag, --segments"
        )
    for response in measured:
        needed = max(FEWEST_LINES, 4 * (given.modes or 1) + 2)
        if response.values.size < needed:
            message = f"'{response.name}' has {response.values.size} lines; such a fit needs {needed} or more"
            hint = "a longer record has more lines, and so has an input of more frequencies than a sine"
            raise DataError(Diagnostic("SF605", message, None, hint if response.is_record else None))
    if bases is not None:
        return _fit(measured, tuple(bases), given, (0,))
    same = tuple(Base.power(0) for _ in measured)
    slopes = SLOPES if given.slope is None else (given.slope,)
    return _fit(measured, same, replace(given, is_gain_free=True), slopes)


def _fit(
    measured: Sequence[MeasuredResponse], bases: tuple[Base, ...], given: FitOptions, slopes: tuple[int, ...]
) -> ResonanceFit:
    has_base = any(base.tf for base in bases)
    is_lag_free = given.is_lag_free or given.is_lag_signed
    free = Free(given.is_gain_free, is_lag_free, given.is_delay_free, given.is_lag_signed)
    if free.delay and any(one.is_magnitude for one in measured):
        raise refused("a delay leaves no trace in a magnitude without a phase", "leave --delay out")
    problem = fit_problem(measured, [base.function for base in bases], free, has_base=has_base, slopes=slopes)
    for line, base in zip(problem.lines, bases, strict=True):
        wrong = ~np.isfinite(line.base) | (line.base == 0)
        if wrong.any():
            frequency = float(line.observation.omega[int(np.argmax(wrong))].real) / (2 * np.pi)
            message = (
                f"the base {base.tf} is zero or infinite at {frequency:.4g} Hz, inside the band measured"
            )
            hint = "add damping to the base, or choose a --band without this frequency"
            raise FitError(Diagnostic("SF615", message, None, hint))
    most = max(MOST_LINES // len(problem.lines), FEWEST_OF_EACH)
    problem, doubts = _without_false_coherence(problem, most)
    problem = problem.at([_kept(line, wild_lines(line.omega, line.ratio)) for line in problem.lines])
    stages = Stages()
    candidate, problem, scores, reasons = _chosen(problem, given, most, stages)
    single = [single_lines(line.omega, candidate.refined.resonances) for line in problem.lines]
    if any(places.size for places in single):
        # A resonance that only one line shows is none, if it is not there without that line.
        fewer = problem.at([_kept(line, places) for line, places in zip(problem.lines, single, strict=True)])
        other, fewer, other_scores, other_reasons = _chosen(fewer, given, most, stages)
        before = candidate.refined.resonances.in_band(*problem.band).sum()
        if other.refined.resonances.in_band(*problem.band).sum() < before and not other.failure:
            candidate, problem, scores, reasons = other, fewer, other_scores, other_reasons
    candidate, problem = stages.within(
        LAST_SHARE, partial(_settled, candidate, problem), lambda: (candidate, problem)
    )
    candidate = replace(candidate, refined=widened(problem, candidate.refined))
    if not has_base:
        bases = tuple(Base.power(int(power)) for power in candidate.refined.resonances.slope)
    fitted = candidate.refined.resonances
    thin = problem.thinned(most)
    thin = thin.at([_seen(thin, r, fitted) for r in range(len(measured))])
    judged = [partial(judge_phase, thin, r, fitted) for r in range(len(bases))]
    otherwise = [partial(not_judged, thin, r, fitted) for r in range(len(bases))]
    ways = zip(judged, otherwise, strict=True)
    tests = tuple(stages.within(PHASE_SHARE, judge, give_up) for judge, give_up in ways)
    fit = ResonanceFit(problem, bases, candidate, scores, given.criterion, tests, ())
    if stages.is_cut:
        reasons = ("the time budget ended before the fit was complete", *reasons)
    elif not fitted.order and np.median([fit.misfit_db(r) for r in range(len(bases))]) > DROWNED_DB:
        reasons = (*reasons, "the data show no resonance, and noise as large as the response")
    reasons = (*reasons, *_poor(fit))
    if reasons:
        # What a poor fit leaves is taken for noise, within which a function may have any magnitude.
        tests = tuple(
            replace(test, verdict="undetermined", with_phase=None)
            if test.bands and test.is_minimum_phase
            else test
            for test in tests
        )
    return replace(fit, phase_tests=tests, warnings=(*doubts, *_warnings(fit)), poor=reasons)


def _are_many(measured: Sequence[MeasuredResponse]) -> bool:
    """Tell whether responses are means that have lines enough to be fitted instead of the records."""
    return all(one.averages and one.values.size >= FEWEST_JUDGED for one in measured)


def are_in_time(measured: Sequence[MeasuredResponse], given: FitOptions) -> bool:
    """Tell whether all responses are of records that can be fitted in time, and nothing else is asked for."""
    is_lag_free = given.is_lag_free or given.is_lag_signed
    are_driven = {one.input is not None for response in measured for one in response.samples}
    return (
        all(one.samples for one in measured)
        and len(are_driven) == 1
        and not is_lag_free
        and given.start == "auto"
    )


def _fit_in_time(measured: Sequence[MeasuredResponse], given: FitOptions) -> ResonanceFit | None:
    """Return the fit to records in time, None if no pole describes them: a gain is fitted to their lines."""
    settings = Settings(
        given.hold, given.criterion, given.modes, given.slope, given.is_delay_free, given.band
    )
    records = [one.samples for one in measured]
    search = RecordSearch(records, settings)
    stages = Stages()
    problem, dynamics = stages.within(LAST_SHARE, search.found, search.best)
    if not dynamics.order:
        return None
    residues = Residues(problem, dynamics, given.slope)
    free = Free(gain=True, delay=dynamics.is_delay_free)
    resonances, covariance = residues.packed(free)
    bases = tuple(Base.power(int(power)) for power in resonances.slope)
    of_lines = fit_problem(measured, [base.function for base in bases], free, has_base=False)
    low = 2 * np.pi / problem.length_s
    reach = (low / 2, np.pi / problem.step_s)
    if given.band is not None:
        reach = (2 * np.pi * given.band[0], 2 * np.pi * given.band[1])
    of_lines = replace(of_lines, reach=reach)
    residuals = tuple(one.residual for one in residues.solved)
    parameters = sum(problem.linear_terms(dynamics, r) for r in range(len(residuals))) + dynamics.order
    refined = Refined(resonances, True, residuals, covariance, 1.0, parameters)
    candidate = Candidate(resonances.order, "subspace", resonances, refined, None)
    scores = tuple(_score_in_time(search.tried[order]) for order in sorted(search.tried))
    record = described(
        problem, dynamics, residues.solved, residues.all_errors, [one.samples[0] for one in measured]
    )
    fit = ResonanceFit(of_lines, bases, candidate, scores, given.criterion, (), (), record=record)
    errors = fit.standard_errors()
    tests = tuple(judge_zeros(resonances.one(r), errors.one(r)) for r in range(len(bases)))
    fit = replace(fit, phase_tests=tests, warnings=(*record.warnings, *_warnings(fit)))
    reasons = ["the time budget ended before the fit was complete"] if stages.is_cut else []
    if given.modes is not None and fit.modes.sum() != given.modes:
        reasons.append(f"{given.modes} resonances were requested, and the best fit has {fit.modes.sum()}")
    if residues.is_contradicted:
        reasons.append(f"the record contradicts --slope {given.slope}: its static gain is not zero")
    fit = replace(fit, poor=(*reasons, *record.poor, *_poor(fit)))
    if not given.is_validated:
        return fit
    validation = validated(records, settings)
    return replace(fit, validation=validation, warnings=(*fit.warnings, *validation.warnings))


def _score_in_time(tried: Tried) -> Score:
    dynamics, problem, costs = tried.dynamics, tried.problem, tried.costs
    parameters = sum(problem.linear_terms(dynamics, r) for r in range(len(costs))) + dynamics.order
    size = sum(problem.sizes)
    freedom = max(size - parameters - 1, 1)
    fit = sum(n * np.log(max(cost, 1e-300) / n) for n, cost in zip(problem.sizes, costs, strict=True))
    aicc = fit + 2 * parameters * size / freedom
    count = int(np.sum(dynamics.zeta < NO_PEAK))
    return Score(dynamics.order, count, parameters, tried.score, aicc, sum(costs) / freedom, "usable")


def _without_false_coherence(problem: FitProblem, most: int) -> tuple[FitProblem, list[str]]:
    """Return the problem without coherence that the scatter of lines contradicts, and what is said of it."""
    # For Gaussian errors of variance w, estimated without coherence, the likelihood of the variance v that
    # coherence gives is lower by w/v - 1 - ln(w/v) a line, however many averages there are.
    lines, said = list(problem.lines), []
    for r, line in enumerate(problem.lines):
        shares = line.measured.coherence
        are_few = line.omega.size < FEWEST_JUDGED
        if are_few or shares is None or line.deviation is None or np.median(shares) > CLEAN:
            continue
        plain = replace(line, is_coherence_used=False, deviation=None)
        single = with_rough_noise(replace(problem, lines=(plain,), delays=()))
        (reweighted,) = with_noise(with_delays(single, None), None, most).lines
        if reweighted.deviation is None:
            continue
        ratio = (reweighted.deviation / line.deviation) ** 2
        level = float(np.mean(ratio))
        scale = max(level, 1 / MOST_AVERAGES) if level > 1 or not line.measured.averages else 1.0
        if np.mean(ratio / scale - 1 - np.log(ratio / scale)) > UNLIKE:
            seen = f"the scatter of the lines, {20 * np.log10(1 + np.median(reweighted.deviation)):.2g} dB"
            whose = f"the coherence of {line.measured.name}, {np.median(shares):.2g} in the median,"
            said.append(f"{whose} contradicts {seen}: lines are weighed by their scatter")
            lines[r] = plain
    return replace(problem, lines=tuple(lines)), said


def _settled(candidate: Candidate, problem: FitProblem) -> tuple[Candidate, FitProblem]:
    """Return the fit with its own noise, and without the lines that it finds to be wild."""
    candidate, problem = with_own_noise(candidate, problem)
    for _ in range(ROUNDS):
        lines = []
        for r, line in enumerate(problem.lines):
            every = line.every
            factor = candidate.refined.resonances.factor(r, every.observation.omega)
            model = every.observation(every.base * factor)
            off = np.abs(every.rest(model)) / line.deviation_of_every()
            # What is larger than the noise everywhere is no matter of single lines.
            off = off / max(float(np.median(off)) / MEDIAN, 1.0 if problem.has_scale else 0.0)
            lines.append(_kept(every, np.flatnonzero(off > WILD)))
        again = problem.readmitted(lines)
        if again is problem:
            break
        candidate, problem = with_own_noise(refitted(candidate, again), again)
    return candidate, problem


def _chosen(
    problem: FitProblem, given: FitOptions, most: int, stages: Stages
) -> tuple[Candidate, FitProblem, tuple[Score, ...], tuple[str, ...]]:
    """Return the best fit, the problem with its noise, how its number of poles was chosen, what is wrong."""
    rough = with_rough_noise(problem)
    problem = stages.within(
        NOISE_SHARE, lambda: with_noise(with_delays(rough, given.modes), given.modes, most), lambda: rough
    )
    candidate, scores, reasons = chosen_order(problem, problem.thinned(most), given, stages)
    return candidate, problem, scores, reasons


def _seen(problem: FitProblem, response: int, resonances: Resonances) -> Whole:
    """Return the lines on which the fit is above the noise; all, where these are too few."""
    line = problem.lines[response]
    every = np.arange(line.omega.size)
    if line.deviation is None:
        return every
    noise = line.deviation * np.abs(line.measured.values)
    seen = np.flatnonzero(noise < DROWNED * np.abs(problem.values(resonances, response)))
    return seen if seen.size >= FEWEST_LINES else every


def _kept(line: FittedLines, wild: Whole) -> Whole:
    return np.delete(np.arange(line.omega.size), isolated(wild, line.omega.size))


def _poor(fit: ResonanceFit) -> tuple[str, ...]:
    modes, errors = fit.resonances, fit.standard_errors()
    low, high = fit.problem.band
    is_rounded = not fit.leaves_rounding and _is_rounded(fit)
    weak, why = (WEAK_ROUNDED, ", and the data have few digits") if is_rounded else (WEAK, "")
    lost = []
    for i in np.flatnonzero(fit.modes).tolist():
        if not errors.zeta_p[i] <= weak * modes.zeta_p[i]:
            where = f"{named_pair(fit, i)} at {modes.omega_p[i] / (2 * np.pi):.4g} Hz"
            lost.append(f"the damping of {where} is less than {1 / weak:g} times its standard error{why}")
    if fit.leaves_rounding:
        return tuple(lost)  # what is left tells nothing
    reasons = []
    if fit.record is not None:
        return (*lost, *_gain_lost(fit))
    if lack_of_fit(fit.problem, fit.refined) < UNLIKELY:
        reasons.append("a function with more poles describes the data far better than noise explains")
    if fit.problem.is_noise_known and fit.refined.reduced > LARGE:
        reasons.append(
            f"the residual is {np.sqrt(fit.refined.reduced):.2g} times what the coherence predicts"
        )
    if fit.candidate.is_rivalled and high > NARROW_BAND * low:
        reasons.append("another power of s fits the data equally well, with another gain and other zeros")
    if fit.refined.correlation > SMOOTH:
        reasons.append("neighbouring lines deviate together: the model lacks something")
    reasons += [*lost, *_gain_lost(fit)]
    for r, line in enumerate(fit.problem.lines):
        if reasons and (k := step_line(line.omega, line.measured.values)) is not None:
            low, high = line.measured.frequency_hz[k : k + 2]
            where = f"{fit.of_response(r)} between {low:.6g} and {high:.6g} Hz"
            reasons.append(f"the magnitude steps{where}, as where an analyser changes its range")
    return tuple(reasons)


def _gain_lost(fit: ResonanceFit) -> list[str]:
    modes, errors, reasons = fit.resonances, fit.standard_errors(), []
    if fit.problem.free.gain and not np.all(errors.gain <= WEAK * np.abs(modes.gain)):
        is_beyond = (modes.omega_z > fit.problem.band[1]) & (modes.zeta_z < 0)
        is_lag = (
            fit.record is None
            and not fit.problem.free.delay
            and bool(np.any(modes.real_z < 0) or np.any(is_beyond))
        )
        advice = ": zeros in the right half-plane above the band may be a delay, try --delay"
        reasons.append("the gain is less than twice its standard error" + advice * is_lag)
    return reasons


def _is_rounded(fit: ResonanceFit) -> bool:
    """Tell whether the noise of a response is that its numbers have few digits: it is not random."""
    for r, line in enumerate(fit.problem.lines):
        steps = rounding(line, fit.problem.values(fit.resonances, r)).sum(axis=0)
        if steps.size and line.deviation is not None:
            noise = line.deviation * np.abs(line.measured.values)
            if np.median(steps / noise**2) > MOST_ROUNDED:
                return True
    return False


def named_pair(fit: ResonanceFit, i: int) -> str:
    """Return what a pole pair is called: resonances are counted from 1."""
    return f"pole pair {int(fit.modes[: i + 1].sum())}" if fit.modes[i] else "a residual pole pair"


def _said_of_lines(fit: ResonanceFit) -> list[str]:
    """Return which lines were left out, and which real zeros no line shows."""
    modes, warnings = fit.resonances, []
    low, high = fit.problem.band
    for r in range(modes.responses):
        excluded = fit.left_out(r)
        if excluded.size:
            places = ", ".join(f"{f:.6g}" for f in fit.measured[r].frequency_hz[excluded][:NAMED_LINES])
            more = ", ..." if excluded.size > NAMED_LINES else ""
            word = "outlier" if excluded.size == 1 else "outliers"
            warnings.append(f"{excluded.size} {word}{fit.of_response(r)} left out, at {places}{more} Hz")
    for r, corner in enumerate(np.abs(modes.real_z).tolist()):
        if np.isfinite(corner) and not low <= corner <= high:
            corner_hz = f"{corner / (2 * np.pi):.4g} Hz"
            warnings.append(
                f"the real zero{fit.of_response(r)} lies outside the band measured, at {corner_hz}"
            )
    poles = [*modes.omega_p[modes.zeta_p < 1].tolist(), *modes.real_corners()]
    far = ", ".join(f"{p / (2 * np.pi):.4g} Hz" for p in poles if not low / DECADE <= p <= DECADE * high)
    if far:
        warnings.append(f"poles more than a decade outside the band: the data show only their effect: {far}")
    return warnings


def said_of_units(fit: ResonanceFit, what: str = "base") -> list[str]:
    """Return where data and base, or ``what`` stands for it, are not known to have one unit."""
    said = []
    for measured, base in zip(fit.measured, fit.bases, strict=True):
        if not base.path or not base.unit or (not measured.unit and base.unit == "1"):
            continue
        if not measured.unit:
            said.append(
                f"the data of {measured.name} have no unit, and are taken in that of the {what}, {base.unit}"
            )
        elif ratio_of_units(measured.unit, base.unit) not in ("1", "rad", "1/rad"):
            words = f"the data of {measured.name} are in {measured.unit}, and the {what} in {base.unit}"
            said.append(f"{words}: the gain of the fit has the quotient")
    return list(dict.fromkeys(said))


def _said_of_faint(fit: ResonanceFit) -> list[str]:
    """Return which resonances an instrument's error, or one line of hum, looks like."""
    modes, said = fit.resonances, []
    for i in np.flatnonzero(fit.modes).tolist():
        where = f"{named_pair(fit, i)} at {modes.omega_p[i] / (2 * np.pi):.4g} Hz"
        heights, is_narrow = [], True
        for r, line in enumerate(fit.problem.lines):
            omega = line.omega_seen
            near = np.abs(omega - modes.omega_p[i])
            heights.append(float(np.max(np.abs(modes.share(r, i, omega)))))
            first = int(np.argmin(near))
            beside = np.delete(near, first)
            width = 2 * modes.zeta_p[i] * modes.omega_p[i]
            is_narrow &= line.measured.spacing_hz is None and width < near[first] + np.min(beside)
        if max(heights) < FAINT:
            most = f"{20 * np.log10(1 + max(heights)):.2g} dB"
            said.append(f"{where} changes the response by {most} at most, as an instrument's error may")
        if is_narrow:
            said.append(f"{where} is narrower than the distance of lines: one wrong line looks the same")
    return said


def _warnings(fit: ResonanceFit) -> tuple[str, ...]:
    modes = fit.resonances
    errors = fit.standard_errors()
    low, high = fit.problem.band
    is_exact = fit.leaves_rounding
    warnings = [*_said_of_lines(fit), *said_of_units(fit)]
    if fit.candidate.is_rivalled and high <= NARROW_BAND * low:
        width = f"{200 * (high - low) / (high + low):.2g} % wide"
        other = "another one fits as well, with another gain and other zeros"
        warnings.append(f"the band, {width}, is too narrow to tell the power of s: {other}")
    for i in range(modes.count):
        if fit.modes[i] and not errors.zeta_p[i] <= WEAK * modes.zeta_p[i]:
            warnings.append(f"the damping of {named_pair(fit, i)} is hardly determined by the data")
        for r in range(modes.responses):
            if not modes.has_zeros[r, i]:
                continue
            pair = f"zero pair {i + 1}{fit.of_response(r)}"
            damped = f"{pair} has the damping ratio {modes.zeta_z[r, i]:.2g}"
            if errors.zeta_z[r, i] > max(abs(modes.zeta_z[r, i]), LEAST_DAMPING) or (
                errors.omega_z[r, i] > WEAK * abs(modes.omega_z[r, i])
            ):
                warnings.append(f"{pair} is not determined: its standard error is as large as its value")
                continue
            if abs(modes.zeta_z[r, i]) > OVERDAMPED:
                lacking = "behaviour that a gain, a power of s and resonances cannot have"
                warnings.append(f"{damped}: two real zeros, which stand for {lacking}")
            elif abs(modes.zeta_z[r, i]) > FLAT and not is_exact:
                moved = "modes outside the band may move it by more than its standard error"
                warnings.append(f"{damped} and no sharp trough: {moved}")
            if not low <= abs(modes.omega_z[r, i]) <= high:
                at_hz = abs(modes.omega_z[r, i]) / (2 * np.pi)
                warnings.append(
                    f"{pair} lies outside the band measured, at {at_hz:.4g} Hz: the data show only its effect"
                )
    if fit.record is not None:
        return tuple(warnings)
    warnings += [] if is_exact else _said_of_faint(fit)
    for line in fit.problem.lines:
        spacing = line.measured.spacing_hz
        if spacing is None or line.measured.window:
            continue
        widths = (modes.zeta_p * modes.omega_p / np.pi)[fit.modes]
        narrow = (np.flatnonzero(widths < 4 * spacing) + 1).tolist()
        if narrow:
            pairs = ", ".join(map(str, narrow))
            said = f"fewer than four lines in the half-power bandwidth of pole pair {pairs}: if the estimate "
            warnings.append(f"{said}used a Hann window, give --window hann, or damping comes out too large")
            break
    several = ", the responses one by one, or --driving OUT/IN" if modes.responses > 1 else " or more --modes"
    advice = "" if fit.problem.has_base else f"; try --slope N{several}"
    if fit.problem.is_noise_known and fit.refined.reduced > LARGE:
        said = f"the residual is {np.sqrt(fit.refined.reduced):.2g} times what the coherence predicts"
        warnings.append(f"{said}: the model lacks something that the data show{advice}")
    if fit.refined.correlation > SMOOTH and not is_exact:
        lacking = "" if fit.problem.free.lag else ", as the lag of a sensor would: try --lag"
        warnings.append(f"neighbouring lines deviate together: the model lacks something smooth{lacking}")
    return tuple(warnings)
