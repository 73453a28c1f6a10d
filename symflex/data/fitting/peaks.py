"""A start from the magnitude alone, by the procedure of the paper.

For each resonance, starting with the lowest: compare the model so far with the data; the peak is omega_p,
the trough omega_z; zeta_p matches the height of the peak, zeta_z the depth of the trough (Eppinger &
Seering 1988, section "Polynomial Resonance Model").
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks, savgol_filter

from symflex.data.fitting.resonances import Resonances

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FitProblem

Real = npt.NDArray[np.float64]

LEAST_PROMINENCE = 0.02
"""Of the logarithm of the magnitude: 0.2 dB, below the shoulders that close pairs leave."""
NOISE_MULTIPLE = 5.0
TYPICAL_RATIO, TYPICAL_DAMPING = 1.1, 0.05
"""omega_z over omega_p, and the damping ratio, that the paper calls typical."""
LOWEST_DAMPING, HIGHEST_DAMPING = 1e-4, 0.5
MATCHING_STEPS = 30
SMOOTHED = 5
APART = 3


def find_modes(problem: FitProblem) -> list[int]:
    """Return the lines of the first response's peaks over its base, the most prominent first."""
    level = _level(problem, 0)
    noise = _noise(level)
    smooth = _smoothed(level)
    peaks, found = find_peaks(smooth, prominence=max(LEAST_PROMINENCE, NOISE_MULTIPLE * noise))
    return [int(peaks[i]) for i in np.argsort(-found["prominences"], kind="stable")]


def start_from_peaks(problem: FitProblem, count: int) -> Resonances | None:
    """Return a start with so many resonances, None when the magnitude has fewer peaks.

    Several responses share the peaks of the first; each has its own troughs.
    """
    found = find_modes(problem)[:count]
    while len(found) < count:
        # A shoulder becomes a peak when the modes found so far are divided out.
        more = _hidden_peak(problem, sorted(found))
        if more is None:
            return None
        found.append(more)
    peaks = sorted(found)
    omega_p: list[float] = []
    zeta_p: list[float] = []
    zeros: list[list[tuple[float, float]]] = []
    gains = []
    for r in range(len(problem.lines)):
        modes, gain = _one_response(problem, r, peaks)
        if r == 0:
            omega_p, zeta_p = [m[0] for m in modes], [m[1] for m in modes]
        zeros.append([(m[2], m[3]) for m in modes])
        gains.append(gain)
    table = np.array(zeros, dtype=np.float64)
    return Resonances(
        np.array(omega_p), np.array(zeta_p), table[:, :, 0], table[:, :, 1], np.array(gains)
    ).ordered()


def _hidden_peak(problem: FitProblem, peaks: list[int]) -> int | None:
    """Return the most prominent peak of what is left of the first response, away from those known."""
    if not peaks:
        return None
    modes, gain = _one_response(problem, 0, peaks)
    line = problem.lines[0]
    level = np.log(np.abs(line.ratio / Resonances.of(modes, gain).factor(0, line.omega)))
    noise = NOISE_MULTIPLE * _noise(level)
    places, found = find_peaks(_smoothed(level), prominence=max(LEAST_PROMINENCE, noise))
    for i in np.argsort(-found["prominences"], kind="stable"):
        if min(abs(int(places[i]) - peak) for peak in peaks) > APART:
            return int(places[i])
    return None


def _one_response(
    problem: FitProblem, response: int, peaks: list[int]
) -> tuple[list[tuple[float, float, float, float]], float]:
    line = problem.lines[response]
    omega, ratio = line.omega, line.ratio
    gain = 1.0
    if problem.free.gain:
        # The sign is that of the lowest lines, where no resonance has turned the phase yet.
        first = ratio[: max(3, peaks[0] // 3)]
        sign = 1 if np.median(first.real) >= 0 else -1
        gain = sign * float(np.exp(np.median(np.log(np.abs(first)))))
    level = np.log(np.abs(ratio / gain))
    modes: list[tuple[float, float, float, float]] = []
    for i, peak in enumerate(peaks):
        before = peaks[i - 1] if i else 0
        after = peaks[i + 1] if i + 1 < len(peaks) else omega.size - 1
        smooth = _smoothed(level)
        low, high = (before + peak) // 2, (peak + after) // 2 + 1
        top = low + int(np.argmax(smooth[low:high])) if i else peak
        if not low < top < high - 1:
            top = peak
        trough = _trough(smooth, top, before, after)
        modes.append(_matched(omega, smooth, top, trough))
        level = level - np.log(np.abs(Resonances.of([modes[-1]]).factor(0, omega)))
    return modes, gain


def _trough(smooth: Real, top: int, before: int, after: int) -> int | None:
    """Return the line of the trough that belongs to a peak: above it, unless one below is far deeper."""
    above = top + 1 + int(np.argmin(smooth[top + 1 : after + 1])) if after > top + 1 else None
    if above is not None and 0 < above < smooth.size - 1:
        return above
    below = before + int(np.argmin(smooth[before:top])) if top > before + 1 else None
    return below if below is not None and below > 0 else None


def _matched(omega: Real, smooth: Real, top: int, trough: int | None) -> tuple[float, float, float, float]:
    """Return the resonance with this peak and trough, their height and depth matched."""
    omega_p = float(omega[top])
    if trough is None or trough == top:
        return omega_p, TYPICAL_DAMPING, TYPICAL_RATIO * omega_p, TYPICAL_DAMPING
    omega_z = float(omega[trough])
    height, depth = np.exp(smooth[top]), np.exp(smooth[trough])
    zeta_p = zeta_z = TYPICAL_DAMPING
    apart = 1 - (omega_p / omega_z) ** 2
    for _ in range(MATCHING_STEPS):
        zeta_p = float(np.hypot(apart, 2 * zeta_z * omega_p / omega_z) / (2 * height))
        zeta_p = min(max(zeta_p, LOWEST_DAMPING), HIGHEST_DAMPING)
        back = 1 - (omega_z / omega_p) ** 2
        zeta_z = float(depth * np.hypot(back, 2 * zeta_p * omega_z / omega_p) / 2)
        zeta_z = min(max(zeta_z, LOWEST_DAMPING), HIGHEST_DAMPING)
    return omega_p, zeta_p, omega_z, zeta_z


def _level(problem: FitProblem, response: int) -> Real:
    return np.log(np.abs(problem.lines[response].ratio))


def _noise(level: Real) -> float:
    """Return the scatter of a smoothed level from line to line."""
    if level.size < SMOOTHED:
        return 0.0
    second = np.diff(level, 2)
    return float(np.median(np.abs(second)) / 0.6745 / np.sqrt(6) * np.sqrt(0.49))


def _smoothed(level: Real) -> Real:
    return savgol_filter(level, SMOOTHED, 2) if level.size > SMOOTHED else level
