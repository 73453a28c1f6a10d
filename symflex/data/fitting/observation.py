"""What an analyser makes of a frequency response: it sees it through the spectrum of its time window.

With a stationary input of flat spectrum the expectation of an H1 estimate with the window w is

    H_seen(f) = integral abs(W(f - f'))^2 H(f') df' / integral abs(W)^2

(Bendat & Piersol, Random Data, 4th ed. 2010, sections 8.5 and 9.1: resolution bias). A peak whose width is
a few lines looks lower and broader than it is; fitted without this, its damping would come out too large.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Places = npt.NDArray[np.intp]

STEPS_PER_LINE = 6
REACH_IN_LINES = 4


@dataclass(frozen=True, eq=False)
class Observation:
    """Where a response has to be known, and how the lines of a measurement follow from that.

    Parameters
    ----------
    omega : array of float, shape (k,)
        Positive angular frequencies [rad/s].
    matrix : sparse array, shape (n, k), or None
        Its real and conjugating part; None when the lines are the values themselves.
    mirror : sparse array, shape (n, k), or None
        Acts on the conjugate values: what negative frequencies give to the lowest lines.
    places : array of int, shape (n, u), or None
        Which of :attr:`omega` each line sees, from :data:`REACH_IN_LINES` below it to as many above; a
        negative number, one's complement, stands for the negative frequency.
    """

    omega: Real
    matrix: csr_array | None = None
    mirror: csr_array | None = None
    places: Places | None = None

    def __call__(self, values: Complex) -> Complex:
        """Return the lines that values at :attr:`omega` give; shape (k,) or (k, p) to (n,) or (n, p)."""
        if self.matrix is None:
            return values
        seen: Complex = np.asarray(self.matrix @ values)
        return seen if self.mirror is None else np.asarray(seen + self.mirror @ np.conj(values))

    def around(self, values: Complex) -> Complex | None:
        """Return the response at the frequencies that each line sees, shape (n, u); None without a window."""
        if self.places is None:
            return None
        seen = values[np.where(self.places < 0, ~self.places, self.places)]
        return np.where(self.places < 0, np.conj(seen), seen)


def observe(frequency_hz: Real, spacing_hz: float | None, window: str) -> Observation:
    """Return how lines of a measurement follow from the response.

    Parameters
    ----------
    frequency_hz : array of float, shape (n,)
        The lines.
    spacing_hz : float or None
        The distance of neighbouring lines, one over the length of a record; None when it is not the same
        throughout, and then the lines are taken as the values themselves.
    window : str
        ``hann``, or empty for none.

    Examples
    --------
    >>> seen = observe(np.arange(10.0, 20.0), 1.0, "hann")
    >>> bool(np.allclose(seen(np.ones(seen.omega.size)), 1))
    True
    """
    if window != "hann" or spacing_hz is None or frequency_hz.size < REACH_IN_LINES:
        return Observation(2 * np.pi * frequency_hz)
    steps = np.arange(-REACH_IN_LINES * STEPS_PER_LINE, REACH_IN_LINES * STEPS_PER_LINE + 1)
    power = seen_amplitudes() ** 2
    step = spacing_hz / STEPS_PER_LINE
    first = round(float(frequency_hz[0]) / step)
    lines = first + STEPS_PER_LINE * np.arange(frequency_hz.size)
    wanted = lines[:, None] + steps[None, :]
    # At s = 0 there may be a pole; the nearest point with a value stands for it.
    wanted = np.where(wanted == 0, 1, wanted)
    grid, places = np.unique(np.abs(wanted), return_inverse=True)
    places = places.reshape(wanted.shape)
    rows = np.repeat(np.arange(lines.size), steps.size)
    weights = np.broadcast_to(power, wanted.shape)
    shape = (lines.size, grid.size)
    positive = wanted > 0
    matrix = csr_array((np.where(positive, weights, 0).ravel(), (rows, places.ravel())), shape=shape)
    mirror = None
    if not positive.all():
        mirror = csr_array((np.where(positive, 0, weights).ravel(), (rows, places.ravel())), shape=shape)
    offset = float(frequency_hz[0]) - first * step
    seen = np.where(positive, places, ~places)
    return Observation(2 * np.pi * np.maximum(grid * step + offset, 0.5 * step), matrix, mirror, seen)


def seen_amplitudes() -> Real:
    """Return with which amplitudes a line sees the frequencies around it; their squares add up to 1."""
    steps = np.arange(-REACH_IN_LINES * STEPS_PER_LINE, REACH_IN_LINES * STEPS_PER_LINE + 1)
    spectrum = _hann_spectrum(steps / STEPS_PER_LINE)
    return np.asarray(spectrum / np.sqrt(np.sum(spectrum**2)), np.float64)


def _hann_spectrum(line: Real) -> Real:
    """Return the spectrum of a Hann window over its value at 0, by the distance in lines."""
    near = np.isclose(np.abs(line), 1)
    safe = np.where(near, 0.0, line)
    return np.where(near, 0.5, np.sinc(safe) / (1 - safe * safe))
