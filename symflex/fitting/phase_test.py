"""Is the measured function minimum phase? The test of the paper.

The resonances are fitted to the magnitude alone, with all zeros in the left half plane. "The phase plots
should match also, if the data to be matched actually represent a minimum-phase system" (Eppinger & Seering
1988, section "Polynomial Resonance Model"): where the measured phase leaves the fitted one, they do not. The
base keeps its own phase.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from scipy.signal import medfilt

if TYPE_CHECKING:
    from symflex.fitting.problem import FitProblem
    from symflex.fitting.resonances import Resonances

Real = npt.NDArray[np.float64]

LIMIT_DEGREES = 10.0
SIGNIFICANT = 4.0
SMOOTHED_LINES = 5
SHORTEST_RUN, LONGEST_GAP = 4, 10
STEPS = 100
CAP = 0.05
LOWEST_DAMPING = 1e-4
EDGE = 12.0


@dataclass(frozen=True, slots=True)
class PartedBand:
    """A band in which the measured phase leaves that of the magnitude-only model.

    Parameters
    ----------
    low_hz, high_hz : float
        Its ends [Hz].
    worst_degrees, worst_hz : float
        The largest difference, measured less fitted, and where.
    """

    low_hz: float
    high_hz: float
    worst_degrees: float
    worst_hz: float


@dataclass(frozen=True, eq=False)
class PhaseTest:
    """The outcome for one response.

    Parameters
    ----------
    resonances : Resonances
        The magnitude-only fit, of this response alone.
    difference : array of float, shape (n,)
        Measured less fitted phase on the lines [rad], in (-pi, pi].
    bands : tuple of PartedBand
        Where they part; empty for a minimum-phase function.
    magnitude_db : float
        Root mean square of the magnitude's own misfit [dB].
    """

    resonances: Resonances
    difference: Real
    bands: tuple[PartedBand, ...]
    magnitude_db: float

    @property
    def is_minimum_phase(self) -> bool:
        """Whether the phases agree in the whole band, within :data:`LIMIT_DEGREES` or the noise."""
        return not self.bands


def judge_phase(problem: FitProblem, response: int, fitted: Resonances) -> PhaseTest:
    """Fit the magnitude alone, from the mirror image of a fit in the left half plane, and compare phases."""
    single = replace(problem, lines=problem.lines[response : response + 1]).without_window()
    (line,) = single.lines
    deviation = np.full(line.omega.size, CAP) if line.deviation is None else np.hypot(line.deviation, CAP)
    wanted = np.log(np.abs(line.measured.values))
    start = type(fitted)(
        fitted.omega_p,
        fitted.zeta_p,
        fitted.omega_z[response : response + 1],
        np.maximum(np.abs(fitted.zeta_z[response : response + 1]), LOWEST_DAMPING),
        fitted.gain[response : response + 1],
        fitted.lag[response : response + 1],
    )
    n = start.count
    damping = slice(3 * n, 4 * n)

    def resonances(vector: Real) -> Resonances:
        plain = np.clip(vector, packed - EDGE, packed + EDGE)
        plain[damping] = np.exp(plain[damping])
        return start.unpack(plain, problem.free)

    def residual(vector: Real) -> Real:
        model = single.values(resonances(vector), 0)
        return (np.log(np.abs(model)) - wanted) / deviation

    def slopes(vector: Real) -> Real:
        now = resonances(vector)
        model, by = single.linearised(now, 0)
        found = (by / model[:, None]).real / deviation[:, None]
        found[:, damping] *= now.zeta_z[0]
        return found

    packed = start.pack(problem.free)
    packed[damping] = np.log(packed[damping])
    best = packed
    if packed.size:
        with np.errstate(all="ignore"):  # a trial step may be wild
            done = least_squares(residual, packed, slopes, method="lm", x_scale="jac", max_nfev=STEPS)
        best = done.x
    found = resonances(best).ordered()
    model = single.values(found, 0)
    difference = np.angle(line.measured.values / model)
    misfit = 20 / np.log(10) * (np.log(np.abs(model)) - wanted)
    noise = np.zeros(line.omega.size) if line.deviation is None else line.deviation
    bands = _parted(line.measured.frequency_hz, difference, noise)
    return PhaseTest(found, difference, bands, float(np.sqrt(np.mean(misfit**2))))


def _parted(frequency_hz: Real, difference: Real, noise: Real) -> tuple[PartedBand, ...]:
    """Return the bands of at least four lines in which a median of five lines leaves the limits."""
    if difference.size < SMOOTHED_LINES:
        return ()
    half = SMOOTHED_LINES // 2
    # On the unit circle: noise would turn an unwrapped phase by whole turns.
    padded = np.pad(np.exp(1j * difference), half, mode="edge")
    turned = medfilt(padded.real, SMOOTHED_LINES) + 1j * medfilt(padded.imag, SMOOTHED_LINES)
    smooth = np.angle(turned[half:-half])
    level = medfilt(np.pad(noise, half, mode="edge"), SMOOTHED_LINES)[half:-half]
    limit = np.maximum(np.radians(LIMIT_DEGREES), SIGNIFICANT * level)
    outside = np.flatnonzero(np.abs(smooth) > limit)
    if not outside.size:
        return ()
    runs = np.split(outside, np.flatnonzero(np.diff(outside) > LONGEST_GAP) + 1)
    bands = []
    for run in runs:
        if run.size < SHORTEST_RUN:
            continue
        worst = run[int(np.argmax(np.abs(smooth[run])))]
        bands.append(
            PartedBand(
                float(frequency_hz[run[0]]),
                float(frequency_hz[run[-1]]),
                float(np.degrees(smooth[worst])),
                float(frequency_hz[worst]),
            )
        )
    return tuple(bands)
