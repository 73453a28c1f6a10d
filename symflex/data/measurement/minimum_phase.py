"""The phase of a minimum-phase function from its magnitude, and how unlike a causal function numbers are.

Input: lines of frequency, magnitudes, phases. Output: a phase, or a misfit in nepers.

    |H| = 1/sqrt(1 + (w T)^2)   ->  phase = -atan(w T), as of a lag

Logarithm of magnitude and phase of a causal minimum-phase function are Hilbert transforms of each other, so
their slopes have equal energy (Titchmarsh 1937, theorem 90), and so has circular noise: a phase read in the
wrong unit is 57 times too steep or too flat. Straight lines, which powers of s and delays add, are taken out
before.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

Real = npt.NDArray[np.float64]

WRAPPED: Final = 2 * np.pi * 1.001  # largest range of phases that may have been wrapped
FEWEST_TO_DECIDE: Final = 8
BEYOND: Final = 7.0  # how far a magnitude is continued beyond its ends: a factor e^7 in frequency


def unlikeness(lines: Real, size: Real, phase: Real) -> float:
    """Return the logarithm of the ratio of the energies that the slopes of ln(size) and phase have."""
    kept = (lines > 0) & (size > 0) & np.isfinite(size) & np.isfinite(phase) & np.isfinite(lines)
    if kept.sum() < FEWEST_TO_DECIDE:
        return 0.0
    x, neper, turn = lines[kept], np.log(size[kept]), phase[kept]
    if np.ptp(turn) <= WRAPPED:
        turn = np.unwrap(turn)
    energies = [
        float(np.linalg.norm(np.diff(y - slope * (t - t.mean()))))
        for t, y in ((np.log(x), neper), (x, turn))
        for slope in [np.cov(t, y)[0, 1] / max(float(np.var(t, ddof=1)), 1e-300)]
    ]
    return abs(float(np.log((energies[1] + 1e-12) / (energies[0] + 1e-12))))


def misfit(lines: Real, size: Real, phase: Real) -> float:
    """Return how unlike a causal function, and one of minimum phase and either sign, a response is."""
    alike = np.nan_to_num(np.abs(np.cos(phase - minimum_phase(lines, size))))
    return unlikeness(lines, size, phase) + float(np.mean(1 - alike))


def minimum_phase(lines: Real, size: Real) -> Real:
    """Return the phase [rad] that the magnitude of a function without zeros on the right has."""
    # 2 w/pi times the integral of (ln|H(v)| - ln|H(w)|)/(v^2 - w^2) over v (Bode 1945, chapter 14); beyond
    # its ends the magnitude goes on with the power of frequency that it has there, rounded. Lines may go
    # down.
    kept = np.flatnonzero((lines > 0) & (size > 0) & np.isfinite(size) & np.isfinite(lines))
    kept = kept[np.argsort(lines[kept])]
    x, y = np.log(lines[kept]), np.log(size[kept])
    phase = np.zeros(lines.size)
    if x.size < FEWEST_TO_DECIDE or np.any(np.diff(x) <= 0):
        return phase
    end = max(x.size // 20, 3)
    low, high = (round(float(np.polyfit(x[s], y[s], 1)[0])) for s in (slice(end), slice(-end, None)))
    step = max((x[-1] - x[0] + 2 * BEYOND) / 2**19, float(np.quantile(np.diff(x), 0.05)))
    grid = np.arange(x[0] - BEYOND, x[-1] + BEYOND, step)
    slope = np.diff(np.interp(grid, x, y)) + step * np.where(grid[1:] < x[0], low, high * (grid[1:] > x[-1]))
    # By parts the kernel is ln(coth(|u|/2)), u = ln(v/w); over the step at u = 0 its mean is 1 + ln(4/step).
    u = step * np.abs(np.arange(-slope.size, slope.size))
    kernel = -np.log(np.tanh(np.where(u == 0, 1.0, u) / 2))
    kernel[slope.size] = 1 + np.log(4 / step)
    size_2 = 2 ** int(np.ceil(np.log2(3 * slope.size)))
    folded = np.fft.irfft(np.fft.rfft(slope, size_2) * np.fft.rfft(kernel, size_2), size_2)
    turn = folded[slope.size : 2 * slope.size] / np.pi
    phase[kept] = np.interp(x, grid[1:] - step / 2, turn)
    return phase
