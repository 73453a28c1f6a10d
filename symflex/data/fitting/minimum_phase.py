"""Is the measured function minimum phase? The test of the paper.

A resonance at 10 Hz with a pair of zeros at 12 Hz in the right half-plane, zeta_z = -0.3:

    fitted to the magnitude alone      zeta_z = +0.3, with the same magnitude on every line
    measured less fitted phase         146 degrees at 5 Hz, -121 degrees at 20 Hz: they part
    magnitude and phase together       no zeros in the left half-plane have both: nonminimum phase

The resonances are fitted to the magnitude alone, with all zeros in the left half-plane. "The phase plots
should match also, if the data to be matched actually represent a minimum-phase system" (Eppinger & Seering
1988, section "Polynomial Resonance Model"): where the measured phase leaves the fitted one, they do not. The
base keeps its own phase.

Magnitude in a band does not determine phase there: a pair of zeros at twice the highest frequency changes the
level by tenths of a decibel and the phase by tens of degrees (Bode 1945, chapter 14: phase depends on the
slope of the level at all frequencies). Where the phases part, a second fit therefore looks for any product of
the same resonances, zeros in the left half-plane, that has both: magnitude and phase as measured. Only where
there is none, not even with a lag linear in frequency, is the function called nonminimum phase.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from symflex.data.fitting.least_squares import EDGE, ROUGH, STEPS, search, triangle
from symflex.data.fitting.lines import CAP
from symflex.data.fitting.observation import FittedLines
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Complex, Real, Resonances, Values

Verdict = Literal["minimum", "undetermined", "nonminimum", "assumed"]

LIMIT_DEGREES = 10.0  # phases part beyond this, or beyond the noise where that is larger
SIGNIFICANT = 4.0  # standard deviations of the phase that noise alone is not taken to reach
MOST_NOISE: Final = np.pi / 2  # deviation of a phase beyond which it says nothing: lead and lag look alike
SMOOTHED_LINES = 5  # width of the running median; single lines that are off do not count
SHORTEST_RUN, LONGEST_GAP = 4, 10  # fewest lines of a band where phases part; most that it skips
LOWEST_DAMPING = 1e-4  # of mirrored zeros, whose logarithms are searched for
MOST_LAG: Final = np.pi / 2  # a lag at the highest line that poles above the band, or a sensor, may cause
WORSE: Final = 1.25  # a magnitude misfit up to this times the least one counts as a fit as well
TINY: Final = 1e-300  # keeps a quotient by an error of zero finite
POOR: Final = 2.0  # magnitude misfit, over the noise and :data:`CAP`, from which resonances describe nothing


@dataclass(frozen=True, slots=True)
class PartedBand:
    """A band in which the measured phase leaves that of the magnitude-only model."""

    # low_hz and high_hz: its ends [Hz].
    low_hz: float
    high_hz: float
    # worst_degrees and worst_hz: the largest difference, measured less fitted, and where.
    worst_degrees: float
    worst_hz: float


@dataclass(frozen=True, eq=False)
class PhaseTest:
    """The outcome for one response."""

    resonances: Resonances  # the magnitude-only fit, of this response alone
    difference: Real  # shape (n,): Measured less fitted phase on the lines [rad], in (-pi, pi]
    bands: tuple[PartedBand, ...]  # where they part, beyond :data:`LIMIT_DEGREES` and the noise
    magnitude_db: float  # root mean square of the magnitude's own misfit [dB]
    # ``minimum``: a minimum-phase function has magnitude and phase as measured. ``nonminimum``: none of this
    # order has. ``undetermined``: only one with a lag linear in frequency has, or none describes the
    # magnitude, so that its phase says nothing. ``assumed``: no phase was measured.
    verdict: Verdict
    # The minimum-phase function found by fitting magnitude and phase, where the magnitude alone left the
    # phase open and there is one.
    with_phase: Resonances | None = None
    lag_s: float = 0.0  # the lag [s] it needs besides; 0 for none

    @property
    def is_minimum_phase(self) -> bool:
        """Whether a minimum-phase function has the measured magnitude and phase in the whole band."""
        return self.verdict == "minimum"


def judge_phase(problem: FitProblem, response: int, fitted: Resonances) -> PhaseTest:
    """Fit the magnitude alone, from the mirror image of a fit in the left half-plane, and compare phases."""
    # Where they part, functions with zeros in the left half-plane are fitted to magnitude and phase together.
    if problem.lines[response].measured.is_magnitude:
        return replace(not_judged(problem, response, fitted), verdict="assumed")
    search = _PhaseSearch(problem, response, fitted)
    line = search.line
    alone, _ = search.found(search.mirrored, "magnitude")
    model = search.single.values(alone, 0)
    mirrored = search.mirrored
    if problem.free.gain and np.mean(np.cos(np.angle(line.measured.values / model))) < 0:
        # A magnitude does not tell the sign of a gain, and zeros moved to the other side may have turned it.
        alone, mirrored = (replace(one, gain=-one.gain) for one in (alone, mirrored))
        model = -model
    difference = np.angle(line.measured.values / model)
    bands = _parted(line.measured.frequency_hz, difference, search.noise)
    magnitude_db = float(20 / np.log(10) * np.sqrt(np.mean(search.level(model) ** 2)))
    if not bands:
        is_lost = SIGNIFICANT * np.median(search.noise) > MOST_NOISE
        return PhaseTest(alone, difference, bands, magnitude_db, "undetermined" if is_lost else "minimum")
    misfit = search.misfit(model)
    verdict: Verdict
    for kind in KINDS[1:]:
        for start in (mirrored, alone):
            other, lag = search.found(start, kind)
            turned = search.single.values(other, 0) * np.exp(-1j * line.omega * lag)
            if search.is_as_measured(turned, misfit):
                verdict = "undetermined" if kind == "lag" else "minimum"
                return PhaseTest(alone, difference, bands, magnitude_db, verdict, other, lag)
    verdict = "undetermined" if misfit > POOR else "nonminimum"
    return PhaseTest(alone, difference, bands, magnitude_db, verdict)


def judge_zeros(modes: Resonances, errors: Resonances) -> PhaseTest:
    """Return what the zeros of a fit in time say: their sides, where their errors leave no doubt."""
    shown = modes.has_zeros[0]
    damping = np.where(modes.omega_z[0] < 0, -np.inf, modes.zeta_z[0] / np.maximum(errors.zeta_z[0], TINY))[
        shown
    ]
    real = modes.real_z[np.isfinite(modes.real_z)]
    worst = float(np.min([np.inf, *damping, *np.where(real < 0, -np.inf, np.inf)]))
    verdict: Verdict = "undetermined"
    if abs(worst) > 2:  # noqa: PLR2004 (standard errors)
        verdict = "minimum" if worst > 0 else "nonminimum"
    return PhaseTest(modes, np.zeros(0), (), 0.0, verdict)


def not_judged(problem: FitProblem, response: int, fitted: Resonances) -> PhaseTest:
    """Return the outcome where there is no time for the test."""
    line = problem.lines[response]
    difference = np.angle(line.measured.values / problem.values(fitted, response))
    return PhaseTest(fitted.one(response), difference, (), 0.0, "undetermined")


KINDS: Final = ("magnitude", "both", "lag")  # fit magnitude; it and phase; both and a linear lag


class _PhaseSearch:
    """Fits of one response by resonances whose zeros lie in the left half-plane."""

    def __init__(self, problem: FitProblem, response: int, fitted: Resonances) -> None:
        # A delay is not part of the question: it stays as it was fitted.
        free = replace(problem.free, delay=False)
        self.single = replace(
            problem, lines=problem.lines[response : response + 1], delays=(), free=free
        ).without_window()
        self.line: FittedLines = self.single.lines[0]
        size = self.line.omega.size
        self.noise: Real = np.zeros(size) if self.line.deviation is None else self.line.deviation
        self.weight: Real = 1 / np.hypot(self.noise, CAP)
        self.wanted: Real = np.log(np.abs(self.line.measured.values))
        of_response = fitted.one(response)
        mirrored = of_response.minimum_phase(np.ones(1, np.bool_))
        self.mirrored = replace(
            mirrored, zeta_z=np.maximum(mirrored.zeta_z, LOWEST_DAMPING), gain=of_response.gain
        )

    def level(self, model: Complex) -> Real:
        """Return the logarithm of the model's magnitude over the measured one."""
        return np.asarray(np.log(np.abs(model)) - self.wanted, np.float64)

    def misfit(self, model: Complex) -> float:
        """Return the root mean square of that in units of the noise, or of :data:`CAP` where that is more."""
        return float(np.sqrt(np.mean((self.level(model) * self.weight) ** 2)))

    def is_as_measured(self, model: Complex, misfit: float) -> bool:
        """Return whether a model has the measured magnitude, as well as any, and phase within the limits."""
        if not self.misfit(model) <= max(1.0, WORSE * misfit):
            return False
        difference = np.angle(self.line.measured.values / model)
        return not _parted(self.line.measured.frequency_hz, difference, self.noise)

    def found(self, start: Resonances, kind: str) -> tuple[Resonances, float]:
        """Return where a start leads, and the lag [s]; ``kind`` is one of :data:`KINDS`."""
        free, omega = self.single.free, self.line.omega
        damping = start.places(0, free)["zeta_z"]
        packed = start.pack(free)
        packed[damping] = np.log(packed[damping])
        turn = omega / omega[-1]
        if kind == "lag":
            packed = np.append(packed, 0.0)

        def resonances(vector: Real) -> Resonances:
            plain = vector.copy()
            plain[damping] = np.exp(plain[damping])
            return start.unpack(plain[:-1] if kind == "lag" else plain, free)

        def residual(vector: Real) -> list[Values]:
            model = self.single.values(resonances(vector), 0)
            level = (self.level(model) * self.weight).astype(np.complex128)
            if kind == "magnitude":
                return [level]
            if kind == "lag":
                model = model * np.exp(-1j * turn * vector[-1])
            aside = np.angle(model / self.line.measured.values) * self.weight
            return [np.asarray(level + 1j * aside, np.complex128)]

        def reduced(vector: Real, residuals: list[Values]) -> tuple[Real, Real]:
            now = resonances(vector)
            model, by = self.single.linearised(now, 0)
            by = by / model[:, None]
            by[:, damping] *= now.zeta_z[0, now.has_zeros[0]]
            if kind == "lag":
                by = np.column_stack((by, -1j * turn))
            stacked = np.column_stack((by * self.weight[:, None], residuals[0]))
            parts = stacked.real if kind == "magnitude" else np.concatenate((stacked.real, stacked.imag))
            upper = triangle(parts)
            return upper[:, :-1], upper[:, -1]

        best = packed
        if packed.size:
            best, _ = search(residual, reduced, packed, (packed - EDGE, packed + EDGE), STEPS, ROUGH)
        lag = float(np.clip(best[-1], -MOST_LAG, MOST_LAG) / omega[-1]) if kind == "lag" else 0.0
        return resonances(best).ordered(), lag


def _parted(frequency_hz: Real, difference: Real, noise: Real) -> tuple[PartedBand, ...]:
    """Return the bands of at least four lines in which a median of five lines leaves the limits."""
    if difference.size < SMOOTHED_LINES:
        return ()
    half = SMOOTHED_LINES // 2
    # On the unit circle: noise would turn an unwrapped phase by whole turns.
    padded = np.pad(np.exp(1j * difference), half, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view
    turned = around(padded, SMOOTHED_LINES)
    smooth = np.angle(np.median(turned.real, axis=1) + 1j * np.median(turned.imag, axis=1))
    level = np.median(around(np.pad(noise, half, mode="edge"), SMOOTHED_LINES), axis=1)
    limit = np.maximum(np.radians(LIMIT_DEGREES), SIGNIFICANT * level)
    outside = np.flatnonzero(np.abs(smooth) > limit)
    bands = []
    for run in np.split(outside, np.flatnonzero(np.diff(outside) > LONGEST_GAP) + 1):
        if run.size >= SHORTEST_RUN:
            worst = run[int(np.argmax(np.abs(smooth[run])))]
            low, high, at = (float(frequency_hz[i]) for i in (run[0], run[-1], worst))
            bands.append(PartedBand(low, high, float(np.degrees(smooth[worst])), at))
    return tuple(bands)
