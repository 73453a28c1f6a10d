"""A fit of resonances to measured responses, and everything a report says of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from symflex.data.fitting.order import (
    CRITERIA,
    STARTS,
    UNLIKELY,
    Candidate,
    Score,
    best_of_starts,
    chosen_order,
    is_rivalled,
    lack_of_fit,
    too_few,
    undetermined,
    with_own_noise,
)
from symflex.data.fitting.phase_test import PhaseTest, judge_phase
from symflex.data.fitting.problem import FitProblem, fit_problem, with_noise, with_rough_noise
from symflex.data.fitting.resonances import MILLISECOND, Complex, Free, Real, Resonances
from symflex.data.fitting.starts import with_delays
from symflex.errors import DataError, Diagnostic, FitError, UsageError, nearest
from symflex.options import FitOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from symflex.data.fitting.least_squares import Refined
    from symflex.data.measurement import MeasuredResponse

SLOPES = tuple(range(-4, 5))
FEWEST_LINES = 8
"""Of a response that is fitted."""
WEAK = 0.5
"""Standard error over the value from which a damping ratio, or a zero, is hardly determined."""
LARGE = 2.0
"""Sum of squares per degree of freedom from which coherence does not explain the residual."""
OVERDAMPED = 2.0
"""Damping ratio of a pair of zeros that had better be called two real ones."""
LEAST_DAMPING = 0.05
"""Damping ratios of zeros below this are not held against their own error."""
DEFAULTS = FitOptions()
SMOOTH = 3.0
"""A Hann window makes this 2, see :attr:`symflex.data.fitting.least_squares.Refined.correlation`."""


@dataclass(frozen=True, eq=False)
class Base:
    """What the resonances are multiplied by."""

    # Of angular frequencies [rad/s], shape (n,), to complex values.
    function: Callable[[Real], Complex] = field(repr=False)
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
    # What the criteria say of the numbers of resonances tried; empty when the number was given.
    scores: tuple[Score, ...]
    criterion: str  # the one that chose
    phase_tests: tuple[PhaseTest, ...]  # one per response
    warnings: tuple[str, ...]  # what to be careful about
    # Why the result is poor, so that standard errors do not tell how far off it may be; empty where it is
    # not.
    poor: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ResonanceFit: {self.resonances.count} resonances of {len(self.bases)} responses>"

    @property
    def resonances(self) -> Resonances:
        """The fitted resonances."""
        return self.candidate.refined.resonances

    @property
    def refined(self) -> Refined:
        """The minimum with its residuals and covariance."""
        return self.candidate.refined

    @property
    def measured(self) -> tuple[MeasuredResponse, ...]:
        """The data."""
        return tuple(line.measured for line in self.problem.lines)

    def values(self, response: int, resonances: Resonances | None = None) -> Complex:
        """Return the fitted (or another) model on the lines of one response, without the window's effect."""
        line = self.problem.lines[response]
        return line.base_at_lines * (resonances or self.resonances).factor(response, line.omega)

    def standard_errors(self) -> Resonances:
        """Return the standard error of every parameter, in a record of the same shape; 0 if it was fixed.

        SF613 where the data do not determine all parameters; :func:`fit_resonances` returns no such fit.
        """
        covariance = self.refined.covariance
        if covariance is None:
            raise FitError(undetermined())
        deviation = np.sqrt(np.diag(covariance))
        found = self.resonances
        n, free = found.count, self.problem.free
        omega_z, zeta_z = np.zeros_like(found.omega_z), np.zeros_like(found.zeta_z)
        gain, lag, delay = (np.zeros(found.responses) for _ in range(3))
        for r, shown in enumerate(found.has_zeros):
            at = found.places(r, free)
            omega_z[r, shown] = np.abs(found.omega_z[r, shown]) * deviation[at["omega_z"]]
            zeta_z[r, shown] = deviation[at["zeta_z"]]
            # Parameters that were not fitted have an empty place.
            gain[r : r + 1][: free.gain] = np.abs(found.gain[r]) * deviation[at["gain"]]
            lag[r : r + 1][: free.lag] = MILLISECOND * deviation[at["lag"]]
            delay[r : r + 1][: free.delay] = MILLISECOND * deviation[at["delay"]]
        return type(found)(
            found.omega_p * deviation[:n],
            found.zeta_p * deviation[n : 2 * n],
            omega_z,
            zeta_z,
            gain,
            lag,
            delay,
            found.slope,
        )

    def misfit_db(self, response: int) -> float:
        """Return the root mean square of model over data on the lines [dB], magnitude alone."""
        return self.measured[response].misfit_db(self.problem.values(self.resonances, response))

    def misfit_degrees(self, response: int) -> float:
        """Return the root mean square of the phase difference on the lines [deg]."""
        return self.measured[response].misfit_degrees(self.problem.values(self.resonances, response))


def fit_resonances(
    measured: Sequence[MeasuredResponse], bases: Sequence[Base] | None = None, given: FitOptions = DEFAULTS
) -> ResonanceFit:
    """Fit simple resonances, in cascade with a known base, to responses that share their poles.

    Each response has its base; without any, it is a gain times a power of s, the same for all. Of the
    options, ``slope`` is that power, ``start`` a key of :data:`symflex.data.fitting.order.STARTS` or ``auto``
    for the best of all; ``is_gain_free`` holds anyway without bases.

    SF902 for an unknown start or criterion, or options that contradict each other; SF605 too few lines for
    what is asked; SF611 no (or not enough) resonances to begin with; SF612 no convergence; SF613 parameters
    that the data do not determine; SF614 a pole that left the band; SF615 a base that vanishes in it.

    Examples
    --------
    >>> from symflex.data.fitting.resonances import Resonances
    >>> from symflex.data.measurement import MeasuredResponse
    >>> frequency = np.arange(5.0, 20.0, 0.05)
    >>> omega = 2 * np.pi * frequency
    >>> data = 3.0 * Resonances.of([(62.8, 0.02, 75.4, 0.03)]).factor(0, omega)
    >>> asked = FitOptions(modes=1)
    >>> fit = fit_resonances([MeasuredResponse("y/u", frequency, data)], None, asked)
    >>> print(fit.resonances.omega_p.round(6), fit.resonances.zeta_p.round(6), fit.resonances.gain.round(6))
    [62.8] [0.02] [3.]
    """
    for name, known, what in (
        (given.start, ("auto", *STARTS), "start"),
        (given.criterion, CRITERIA, "criterion"),
    ):
        if name not in known:
            hint = nearest(name, known) or f"choose from: {', '.join(known)}"
            raise UsageError(Diagnostic("SF902", f"there is no {what} '{name[:64]}'", None, hint))
    if bases is not None and given.slope is not None:
        raise UsageError(Diagnostic("SF902", "a power of s is for fits without a base"))
    for response in measured:
        needed = max(FEWEST_LINES, 4 * (given.modes or 1) + 2)
        if response.values.size < needed:
            message = f"'{response.name}' has {response.values.size} lines; such a fit needs {needed} or more"
            raise DataError(Diagnostic("SF605", message))
    if bases is not None:
        return _fit(measured, tuple(bases), given, (0,))
    same = tuple(Base.power(0) for _ in measured)
    slopes = SLOPES if given.slope is None else (given.slope,)
    return _fit(measured, same, replace(given, is_gain_free=True), slopes)


def _fit(
    measured: Sequence[MeasuredResponse], bases: tuple[Base, ...], given: FitOptions, slopes: tuple[int, ...]
) -> ResonanceFit:
    has_base = any(base.tf for base in bases)
    modes, start = given.modes, given.start
    is_lag_free = given.is_lag_free or given.is_lag_signed
    free = Free(given.is_gain_free, is_lag_free, given.is_delay_free, given.is_lag_signed)
    problem = fit_problem(measured, [base.function for base in bases], free, has_base=has_base, slopes=slopes)
    for line, base in zip(problem.lines, bases, strict=True):
        wrong = ~np.isfinite(line.base) | (line.base == 0)
        if wrong.any():
            place = float(line.observation.omega[int(np.argmax(wrong))]) / (2 * np.pi)
            message = f"the base {base.tf} is zero or infinite at {place:.4g} Hz, inside the band measured"
            raise FitError(
                Diagnostic("SF615", message, None, "a base needs damping, or --band a smaller band")
            )
    problem = with_noise(with_delays(with_rough_noise(problem), modes), modes)
    scores: tuple[Score, ...] = ()
    if modes is None:
        candidate, scores = chosen_order(problem, start, given.criterion)
    else:
        found = best_of_starts(problem, modes, start)
        if found is None:
            raise FitError(too_few(problem, modes, start))
        candidate = found
    if candidate.failure is not None:
        raise FitError(candidate.failure)
    is_ambiguous = is_rivalled(problem, candidate)
    candidate, problem = with_own_noise(candidate, problem)
    if not has_base:
        bases = tuple(Base.power(int(power)) for power in candidate.refined.resonances.slope)
    tests = tuple(judge_phase(problem, r, candidate.refined.resonances) for r in range(len(measured)))
    fit = ResonanceFit(problem, bases, candidate, scores, given.criterion, tests, ())
    return replace(fit, warnings=_warnings(fit), poor=_poor(fit, is_ambiguous=is_ambiguous))


def _poor(fit: ResonanceFit, *, is_ambiguous: bool) -> tuple[str, ...]:
    """Return why a fit is poor."""
    found, errors = fit.resonances, fit.standard_errors()
    reasons = []
    if lack_of_fit(fit.problem, fit.refined) < UNLIKELY:
        reasons.append("a function with more poles describes the data far better than noise explains")
    if fit.problem.is_noise_known and fit.refined.reduced > LARGE:
        reasons.append(f"the residual is {np.sqrt(fit.refined.reduced):.2g} times what coherence explains")
    if is_ambiguous:
        reasons.append("another power of s describes the data as well: gain and zeros may be others")
    if fit.refined.correlation > SMOOTH:
        reasons.append("neighbouring lines deviate together, as they do where the model lacks something")
    for i in range(found.count):
        where = f"pole pair {i + 1} at {found.omega_p[i] / (2 * np.pi):.4g} Hz"
        if errors.zeta_p[i] > WEAK * found.zeta_p[i]:
            reasons.append(f"the damping of {where} is lost in its error")
        if found.zeta_p[i] >= 1:
            reasons.append(f"{where} has the damping ratio {found.zeta_p[i]:.2g}: it is not a resonance")
    return tuple(reasons)


def _warnings(fit: ResonanceFit) -> tuple[str, ...]:
    found = fit.resonances
    errors = fit.standard_errors()
    low, high = fit.problem.band
    warnings = []
    for i in range(found.count):
        if errors.zeta_p[i] > WEAK * found.zeta_p[i]:
            warnings.append(f"the damping of pole pair {i + 1} is hardly determined by the data")
        for r in range(found.responses):
            if not found.has_zeros[r, i]:
                continue
            line = fit.problem.lines[r]
            where = f" of {line.measured.name}" if found.responses > 1 else ""
            if errors.zeta_z[r, i] > max(abs(found.zeta_z[r, i]), LEAST_DAMPING) or (
                errors.omega_z[r, i] > WEAK * abs(found.omega_z[r, i])
            ):
                warnings.append(
                    f"zero pair {i + 1}{where} is not determined by the data: its error is of its own size"
                )
                continue
            if abs(found.zeta_z[r, i]) > OVERDAMPED:
                warnings.append(
                    f"zero pair {i + 1}{where} has the damping ratio {found.zeta_z[r, i]:.2g}: two "
                    "real zeros, that stand for what a gain, a power of s and resonances cannot have"
                )
            if not low <= abs(found.omega_z[r, i]) <= high:
                place = abs(found.omega_z[r, i]) / (2 * np.pi)
                warnings.append(
                    f"zero pair {i + 1}{where} lies outside the band measured, at {place:.4g} Hz: "
                    "the data show its effect, not itself"
                )
    for line in fit.problem.lines:
        spacing = line.measured.spacing_hz
        if spacing is None or line.observation.matrix is not None:
            continue
        narrow = [
            i + 1 for i in range(found.count) if found.zeta_p[i] * found.omega_p[i] / np.pi < 4 * spacing
        ]
        if narrow:
            pairs = ", ".join(map(str, narrow))
            warnings.append(
                f"less than four lines in the half-power bandwidth of pole pair {pairs}: if the estimate "
                "used a Hann window, say --window hann, or damping comes out too large"
            )
            break
    advice = ""
    if not fit.problem.has_base:
        advice = "; try --slope N" + (
            ", the responses one by one, or --driving OUT/IN" if found.responses > 1 else " or more --modes"
        )
    if fit.problem.is_noise_known and fit.refined.reduced > LARGE:
        warnings.append(
            f"the residual is {np.sqrt(fit.refined.reduced):.2g} times what coherence explains: "
            "the model lacks something that the data show" + advice
        )
    if fit.refined.correlation > SMOOTH:
        lacking = "" if fit.problem.free.lag else ", as the lag of a sensor would: try --lag"
        warnings.append(f"neighbouring lines deviate together: the model lacks something smooth{lacking}")
    return tuple(warnings)
