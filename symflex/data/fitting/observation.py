"""What an analyser makes of a frequency response: it sees it through the spectrum of its time window.

With a stationary input of flat spectrum the expectation of an H1 estimate with the window w is

    H_seen(f) = integral abs(W(f - f'))^2 H(f') df' / integral abs(W)^2

(Bendat & Piersol, Random Data, 4th ed. 2010, sections 8.5 and 9.1: resolution bias). A peak whose width is
a few lines looks lower and broader than it is; fitted without this, its damping would come out too large.

Errors of neighbouring lines hang together. The error of a line is the mean over records of X* E, over that of
abs(X)^2, where X is the record's spectrum and E what a line's own H leaves of the output: noise, and leakage,
the response at neighbouring frequencies less that at the line, seen through the window. X and E are circular
Gaussian, and uncorrelated on one line. By the rule for fourth moments (Isserlis 1918), with P the covariance
of X on two lines k and l, Q that of E, and C those of X on one and E on the other,

    n cov(e_k, e_l) = sum_d P_kl(d) Q_kl(d),    n pcov(e_k, e_l) = sum_d C_kl(d) C_lk(-d),

summed over pairs of records d half records apart. The second one, the covariance without a conjugate, is what
makes leakage harmless to natural frequencies: errors that noise would leave independent cancel over a peak.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from symflex.data.fitting.resonances import Complex, Real, Values, Whole
from symflex.data.measurement import MeasuredResponse

Places = npt.NDArray[np.intp]

STEPS_PER_LINE = 6
REACH_IN_LINES = 4


@dataclass(frozen=True, eq=False)
class Observation:
    """Where a response has to be known, and how the lines of a measurement follow from that."""

    omega: Values  # shape (k,): Positive angular frequencies [rad/s], as :attr:`MeasuredResponse.omega_seen`
    # shape (n, k): Its real and conjugating part; None when the lines are the values themselves.
    matrix: csr_array | None = None
    # shape (n, k): Acts on the conjugate values: what negative frequencies give to the lowest lines.
    mirror: csr_array | None = None
    # shape (n, u): Which of :attr:`omega` each line sees, from :data:`REACH_IN_LINES` below it to as many
    # above; a negative number, one's complement, stands for the negative frequency.
    places: Places | None = None

    def __call__(self, values: Complex) -> Complex:
        """Return the lines that values at :attr:`omega` give; shape (k,) or (k, p) to (n,) or (n, p)."""
        if self.matrix is None:
            return values
        seen: Complex = np.asarray(self.matrix @ values)
        return seen if self.mirror is None else np.asarray(seen + self.mirror @ np.conj(values))

    def at(self, places: npt.NDArray[np.int64]) -> Observation:
        """Return how some of the lines follow from the response."""
        if self.matrix is None or self.places is None:
            return Observation(self.omega[places])
        mirror = None if self.mirror is None else self.mirror[places]
        return Observation(self.omega, self.matrix[places], mirror, self.places[places])

    def around(self, values: Complex) -> Complex | None:
        """Return the response at the frequencies that each line sees, shape (n, u); None without a window."""
        if self.places is None:
            return None
        seen = values[np.where(self.places < 0, ~self.places, self.places)]
        return np.where(self.places < 0, np.conj(seen), seen)


def observe(response: MeasuredResponse) -> Observation:
    """Return how lines of a measurement follow from the response seen through a ``hann`` window, or none.

    >>> from symflex.data.measurement import MeasuredResponse
    >>> seen = observe(MeasuredResponse("Y/U", np.arange(10.0, 20.0), np.ones(10), window="hann"))
    >>> bool(np.allclose(seen(np.ones(seen.omega.size)), 1))
    True
    """
    frequency_hz, spacing_hz = response.frequency_hz, response.spacing_hz
    if response.window != "hann" or spacing_hz is None or frequency_hz.size < REACH_IN_LINES:
        return Observation(response.omega_seen)
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
    lines = steps / STEPS_PER_LINE
    near = np.isclose(np.abs(lines), 1)
    safe = np.where(near, 0.0, lines)
    spectrum = np.where(near, 0.5, np.sinc(safe) / (1 - safe * safe))  # of a Hann window
    return np.asarray(spectrum / np.sqrt(np.sum(spectrum**2)), np.float64)


LARGEST_LAG = 4
OVERLAPPING = (0, 1, -1)  # records that share samples, in half records: Hann windows overlap by half


def score_covariance(line: FittedLines, inside: Complex, slopes: Complex) -> Real | None:
    """Return the covariance of J'e for one response, over the variance of lines; None without a window."""
    # It is J'J where lines are independent and their errors circular. ``inside`` is the response at
    # ``line.observation.omega``, ``slopes`` (n, p) is J: derivatives over the standard deviation of each
    # part. The noise is what coherence says less the leakage that the response implies. Records are taken to
    # overlap by half; how many there are follows from the number of independent averages (Welch 1967).
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
        covariance = (below.conj() * circular[:, None]).T @ above
        covariance = covariance + (below.conj() * other_part[:, None]).T @ above.conj()
        share = covariance.real / (2 * records)
        total += share if lag == 0 else share + share.T
    return total


def _shared(lag: int, half_records: int) -> Complex:
    """Return how two lines of two records see the same frequencies: the product of their windows' spectra."""
    amplitudes = seen_amplitudes()
    skipped = lag * STEPS_PER_LINE
    offsets = np.arange(skipped, amplitudes.size) / STEPS_PER_LINE - REACH_IN_LINES
    product = amplitudes[skipped:] * amplitudes[: amplitudes.size - skipped]
    return np.asarray(product * np.exp(1j * np.pi * half_records * offsets), np.complex128)


@dataclass(frozen=True, eq=False)
class FittedLines:
    """One measured response as the fit sees it."""

    measured: MeasuredResponse  # the lines
    observation: Observation  # how the lines follow from the response
    # base and base_at_lines: the known factor where the observation needs it, and on the lines.
    base: Complex
    base_at_lines: Complex
    # shape (n,): Standard deviation of each part over the magnitude; None when there is no coherence.
    deviation: Real | None
    is_coherence_used: bool = True
    # All lines of the measurement, where this is a part of them.
    whole: FittedLines | None = None

    @property
    def omega(self) -> Real:
        """Angular frequencies of the lines [rad/s]."""
        return self.measured.omega

    @property
    def omega_seen(self) -> Values:
        """``s/j`` of the lines [rad/s]."""
        return self.measured.omega_seen

    @property
    def ratio(self) -> Complex:
        """Measured values over the base: what the resonances have to be."""
        return self.measured.values / self.base_at_lines

    @property
    def coherence(self) -> Real | None:
        """The coherence, if there is one that the scatter of lines does not contradict."""
        return self.measured.coherence if self.is_coherence_used else None

    @property
    def parts(self) -> int:
        """How many real numbers each line is: two, or a magnitude alone."""
        return 1 if self.measured.is_magnitude else 2

    def rest(self, model: Complex) -> Values:
        """Return how far values of a model are off, real where magnitudes alone were measured."""
        if self.measured.is_magnitude:
            return np.asarray(np.abs(model) - np.abs(self.measured.values), np.float64)
        return np.asarray(model - self.measured.values, np.complex128)

    @property
    def every(self) -> FittedLines:
        """All lines of the measurement."""
        return self.whole or self

    def deviation_of_every(self) -> Real:
        """Return the standard deviation of each part on all lines: what is left out has its neighbours'."""
        size = np.abs(self.measured.values)
        deviation = size if self.deviation is None else self.deviation * size
        return np.interp(self.every.omega, self.omega, deviation)

    def at(self, places: Whole) -> FittedLines:
        """Return some of the lines."""
        observation = self.observation.at(places)
        return replace(
            self,
            measured=self.measured.taken(places),
            observation=observation,
            base=self.base if observation.matrix is not None else self.base[places],
            base_at_lines=self.base_at_lines[places],
            deviation=None if self.deviation is None else self.deviation[places],
            whole=self.every,
        )
