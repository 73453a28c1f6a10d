"""How the errors of neighbouring lines of an H1 estimate hang together, and what a fit makes of that.

The error of a line is the mean over records of X* E, over that of abs(X)^2, where X is the record's spectrum
and E what a line's own H leaves of the output: noise, and leakage, the response at neighbouring frequencies
less that at the line, seen through the window. X and E are circular Gaussian, and uncorrelated on one line.
By the rule for fourth moments (Isserlis 1918), with P the covariance of X on two lines k and l, Q that of E,
and C those of X on one and E on the other,

    n cov(e_k, e_l) = sum_d P_kl(d) Q_kl(d),    n pcov(e_k, e_l) = sum_d C_kl(d) C_lk(-d),

summed over pairs of records d half records apart. The second one, the covariance without a conjugate, is what
makes leakage harmless to natural frequencies: errors that noise would leave independent cancel over a peak.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.data.fitting.observation import REACH_IN_LINES, STEPS_PER_LINE, seen_amplitudes

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FittedLines

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

LARGEST_LAG = 4
OVERLAPPING = (0, 1, -1)
"""Records that share samples with one, in half records: a Hann window goes with half an overlap."""


def score_covariance(line: FittedLines, inside: Complex, slopes: Complex) -> Real | None:
    """Return the covariance of J'e for the lines of one response, in units of their variance.

    It is J'J where lines are independent and their errors circular.

    Parameters
    ----------
    line : FittedLines
        With deviations.
    inside : array of complex, shape (k,)
        The response at ``line.observation.omega``.
    slopes : array of complex, shape (n, p)
        J: derivatives on the lines over the standard deviation of each part.

    Returns
    -------
    array of float, shape (p, p), or None
        None where the lines were not seen through a window.

    Notes
    -----
    The noise is what coherence says less the leakage that the response implies. Records are taken to overlap
    by half; how many there are follows from the number of independent averages (Welch 1967).
    """
    seen = line.observation.around(inside)
    if seen is None or line.deviation is None:
        return None
    amplitudes = seen_amplitudes()
    power = amplitudes**2
    off = seen - (seen @ power)[:, None]
    deviation = line.deviation * np.abs(line.measured.values)
    averages = line.measured.averages or 1.0
    noise = np.sqrt(np.maximum(2 * averages * deviation**2 - np.abs(off) ** 2 @ power, 0))
    records = averages * sum(abs(_shared(0, d).sum()) ** 2 for d in OVERLAPPING)
    scaled = slopes / deviation[:, None]
    total = np.zeros((slopes.shape[1], slopes.shape[1]))
    for lag in range(min(LARGEST_LAG, noise.size - 1) + 1):
        last, skipped = noise.size - lag, lag * STEPS_PER_LINE
        lower, upper = off[:last, skipped:], off[lag:, : off.shape[1] - skipped]
        circular = np.zeros(last, np.complex128)
        other_part = np.zeros(last, np.complex128)
        for d in OVERLAPPING:
            shared = _shared(lag, d)
            circular += shared.sum().conj() * (
                (lower * upper.conj()) @ shared + shared.sum() * noise[:last] * noise[lag:]
            )
            other_part += (upper @ shared.conj()) * (lower @ shared)
        below, above = scaled[:last], scaled[lag:]
        found = (below.conj() * circular[:, None]).T @ above
        found = found + (below.conj() * other_part[:, None]).T @ above.conj()
        share = found.real / (2 * records)
        total += share if lag == 0 else share + share.T
    return total


def _shared(lag: int, half_records: int) -> Complex:
    """Return how two lines of two records see the same frequencies: the product of their windows' spectra."""
    amplitudes = seen_amplitudes()
    skipped = lag * STEPS_PER_LINE
    offsets = np.arange(skipped, amplitudes.size) / STEPS_PER_LINE - REACH_IN_LINES
    product = amplitudes[skipped:] * amplitudes[: amplitudes.size - skipped]
    return np.asarray(product * np.exp(1j * np.pi * half_records * offsets), np.complex128)
