"""A record in time as a fit sees it: the spectrum of its samples, and what a pole adds to that, exactly.

For samples ``y_k = y(k h)``, k = 0 ... n - 1, let ``Y`` be their discrete Fourier transform and ``z = exp(j
omega h)`` on its lines. A pole p of a plant, ``1/(s - p)``, takes an input that is held between samples, or
joined by lines, from one sample to the next by ``E = exp(p h)``. Therefore, without a window or leakage,

    Y = H U + c/(1 - E/z),    H = g_0 + g_1/z + g_2/z^2/(1 - E/z),

where g_0, g_1, g_2 are the responses to one sample of the input, delayed by any fraction of h, and c is free:
what the record begins with less what it ends with (Pintelon &
Schoukens, System Identification, 2nd ed. 2012, section 6.3). By Parseval's theorem, least squares on these
lines are those of the output's error in time. Noise of any colour weighs lines, and a band is some of them.

    smooth             H = 1/(j omega - p): an input without frequencies above half the sampling rate
    held, no delay     g = (0, (E - 1)/p, E (E - 1)/p): H = (E - 1)/p/(z - E)
    a steady sine      c/(1 - exp(j omega_0 h)/z), no input
    offset, drift      the line at 0 Hz, which is left out; 1/(1 - 1/z)
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy.linalg import solve_toeplitz

from symflex.data.fitting.resonances import Complex, Mask, Real
from symflex.data.measurement.measured_response import Samples

SMALL: Final = 0.5  # size of an argument below which a series has more digits than its closed form
TERMS: Final = 18  # of that series: 0.5^18/21! is far below rounding
FORGOTTEN: Final = 37.0  # exp(-37) is the rounding of 1
BLOCK: Final = 128  # samples whose sum takes one product of matrices
ON_LINE: Final = 1e-12  # distance of a pole from a line, below which this one stands for it
MOST_REGRESSORS: Final = 30  # of a disturbance whose colour is estimated
SAMPLES_EACH: Final = 12  # samples that each of these takes at least
FEW_LEVELS: Final = 3  # of a step or a square wave, whose input is held
HELD: Final = 0.5  # share of samples equal to those before them from which an input is held
FEWEST_LEVELS, MOST_LEVELS, EVEN = 20, 300, 0.05  # of an input of few bits, and how even their gaps are
PARTED: Final = 6  # rounds in which a residual is parted into what an input's rounding adds, and the rest


Weights = tuple[complex, complex, complex]


@dataclass(frozen=True, eq=False)
class SampledRecord:
    """The spectrum of an output and of its input on the lines of a band; variances are those of samples."""

    step_s: float
    output: Real  # shape (n,)
    # shape (lead + n,): The input, from so many samples before the first of the output; None without.
    input: Real | None
    lead: int = 0
    is_joined: bool = False  # whether lines join the samples of the input; else each is held to the next
    is_smooth: bool = False  # whether it has no frequency above half the sampling rate, instead of both
    is_at_rest: bool = False  # whether nothing moved before the first sample, and the input was as there
    is_from_zero: bool = False  # whether it was zero instead, as simulations begin
    lines: Mask | None = None  # which of the lines above 0 Hz and below half the sampling rate; None for all
    noise: Real | None = None  # shape (lines,): standard deviation of a line; None for 1
    measured: Mask | None = None  # which samples of the output there are; the others hold a guess
    rounding: float = 0.0  # standard deviation of the errors of an input of few bits
    # shape (2 lines, g): an orthonormal basis of what errors of the input add, weighted, at samples that were
    # lost; None to trust guesses.
    lost: Real | None = None
    _inputs: dict[int, Complex] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(
        samples: Samples,
        *,
        is_joined: bool,
        is_at_rest: bool = False,
        is_from_zero: bool = False,
        lead: int = 0,
        is_smooth: bool = False,
    ) -> SampledRecord:
        """Return the record of samples; without rest, the input must lead by the delay in whole samples."""
        y, u = samples.output, samples.input
        measured = None if samples.is_missing is None else ~samples.is_missing
        rounding = 0.0 if u is None else few_levels(u)[1] / np.sqrt(12)
        if u is not None and is_at_rest:
            begun = 0.0 if is_from_zero else u[0]
            u = np.concatenate((np.full(lead, begun), u)) - begun
        elif lead:
            y, measured = y[lead:], None if measured is None else measured[lead:]
        return SampledRecord(
            samples.step_s, y, u, lead, is_joined, is_smooth, is_at_rest, is_from_zero, measured=measured,
            rounding=rounding,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """How many samples of the output there are."""
        return self.output.size

    @cached_property
    def omega(self) -> Real:
        """The lines [rad/s]."""
        every = 2 * np.pi / (self.size * self.step_s) * np.arange(1, (self.size - 1) // 2 + 1)
        return np.asarray(every if self.lines is None else every[self.lines], np.float64)

    @cached_property
    def back(self) -> Complex:
        """``1/z`` on the lines."""
        return np.asarray(np.exp(-1j * self.omega * self.step_s), np.complex128)

    def spectrum(self, values: Real) -> Complex:
        """Return the transform of samples of the output's time on the lines."""
        every = np.fft.rfft(values)[1 : (self.size - 1) // 2 + 1] / np.sqrt(self.size)
        return np.asarray(every if self.lines is None else every[self.lines], np.complex128)

    def samples(self, spectrum: Complex) -> Real:
        """Return the samples that a spectrum on the lines stands for; it is nothing elsewhere."""
        every = np.zeros(self.size // 2 + 1, np.complex128)
        every[1 : (self.size - 1) // 2 + 1][slice(None) if self.lines is None else self.lines] = spectrum
        return np.asarray(np.fft.irfft(every, self.size) * np.sqrt(self.size), np.float64)

    @cached_property
    def output_lines(self) -> Complex:
        """The spectrum of the output."""
        return self.spectrum(self.output)

    def input_lines(self, delay: int = 0) -> Complex:
        """Return the spectrum of the input, delayed by whole samples."""
        if delay not in self._inputs:
            self._inputs[delay] = self.spectrum(self.delayed(delay))
        return self._inputs[delay]

    def input_mean(self, delay: int = 0) -> Complex:
        """Return the line at 0 Hz of the input, delayed by whole samples."""
        return np.array([np.sum(self.delayed(delay)) / np.sqrt(self.size)], np.complex128)

    def delayed(self, delay: int) -> Real:
        """Return the input at the output's samples, delayed by whole samples."""
        assert self.input is not None
        first = max(self.lead - delay, 0)
        return self.input[first : first + self.size]

    def weighted(self, spectrum: Complex) -> Real:
        """Return real numbers of variance 1, if the noise is right: shape (k, ...) to (2 k, ...)."""
        # They are without what an input that was lost may have added.
        noise = 1.0 if self.noise is None else self.noise.reshape(-1, *[1] * (spectrum.ndim - 1))
        scaled = np.sqrt(2) * spectrum / noise
        values = np.concatenate((scaled.real, scaled.imag))
        return values if self.lost is None else values - self.lost @ (self.lost.T @ values)

    def drift(self) -> Complex:
        """Return the spectrum of a straight line, up to a factor; its mean is not on the lines."""
        return np.asarray(1 / (1 - self.back) / np.sqrt(self.size), np.complex128)

    def at_first_sample(self) -> Complex:
        """Return the spectrum of one sample, the first: it depends on an input that was not recorded."""
        return np.full(self.omega.size, 1 / np.sqrt(self.size), np.complex128)

    def pole(self, p: complex, delay_s: float = 0.0, *, is_mean: bool = False) -> PoleSpectrum:
        """Return what a pole ``1/(s - p)`` adds to the spectrum of the output, or to its line at 0 Hz."""
        return PoleSpectrum(self, complex(p), delay_s, is_mean)

    def direct(self, delay_s: float = 0.0) -> tuple[Complex, Complex]:
        """Return the spectrum of the delayed input itself as the output samples it, and by the delay."""
        if self.is_smooth:
            u = np.exp(-1j * self.omega * delay_s) * self.input_lines()
            return u, -1j * self.omega * u
        whole, fraction = divmod(delay_s / self.step_s, 1)
        u = self.input_lines(int(whole))
        if self.is_joined:
            step = (self.back - 1) * u
            return u + fraction * step, step / self.step_s
        return (self.back * u if fraction else u), np.zeros_like(u)

    def at(self, lines: Mask) -> SampledRecord:
        """Return the record with some of its lines."""
        if lines.all():
            return self
        every = np.zeros((self.size - 1) // 2, bool)
        every[np.flatnonzero(np.ones_like(every) if self.lines is None else self.lines)[lines]] = True
        noise = None if self.noise is None else self.noise[lines]
        return replace(self, lines=every, noise=noise, _inputs={})

    def struck(self) -> SampledRecord:
        """Return the record of a unit input at the first sample alone."""
        assert self.input is not None
        pulse = np.zeros(self.input.size)
        pulse[self.lead] = 1.0
        return replace(self, input=pulse, is_at_rest=False, _inputs={})

    def with_noise(self, residual: Complex, gain: Real | float = 0.0) -> SampledRecord:
        """Return the record with the noise that a residual shows: autoregressive, or white in a band.

        ``gain`` is how much larger than its input a line of the output is: errors of an input of few bits,
        which are white, pass through it. What they leave of the residual is what else disturbs the output
        (its power is that expected of it, round after round: Dempster, Laird & Rubin, J. R. Stat. Soc. B 39,
        1977).
        """
        by_input = np.broadcast_to(gain * self.rounding, residual.shape) ** 2
        power = np.abs(residual) ** 2
        left = np.full(residual.size, np.median(power) if by_input.any() else np.inf)
        for _ in range(PARTED if by_input.any() else 1):
            share = 1 / (1 + by_input / left)
            expected = np.sqrt(share**2 + share * by_input / np.maximum(power, np.finfo(float).tiny))
            left = self._smoothed(residual * expected)
        return replace(self, noise=np.sqrt(left + by_input))

    def _smoothed(self, residual: Complex) -> Real:
        """Return the power of noise on the lines."""
        if self.lines is not None:
            level = max(float(np.mean(np.abs(residual) ** 2)), np.finfo(float).tiny)
            return np.full(self.omega.size, level)
        values = self.samples(residual)
        coefficients, variance = autoregression(values if self.measured is None else values[self.measured])
        response = sum(a * self.back**k for k, a in enumerate(coefficients))
        return np.asarray(variance / np.abs(np.asarray(response)) ** 2, np.float64)

    def filled(self, residual: Complex) -> SampledRecord:
        """Return the record with samples that are missing replaced by those of the model."""
        if self.measured is None:
            return self
        model = self.output - self.samples(residual)
        return replace(self, output=np.where(self.measured, self.output, model))


@dataclass(frozen=True, eq=False)
class PoleSpectrum:
    """What a pole of residue 1 adds to the spectrum of an output, each part once it is asked for."""

    record: SampledRecord
    p: complex
    delay_s: float
    is_mean: bool  # whether it is that of the line at 0 Hz

    @cached_property
    def free(self) -> Complex:
        """By what the record begins with: exp(p t) on its samples."""
        return np.asarray(self._free / np.sqrt(self.record.size), np.complex128)

    @cached_property
    def free_by_pole(self) -> Complex:
        """The derivative of :attr:`free`."""
        return np.asarray(self._free_by_pole / np.sqrt(self.record.size), np.complex128)

    @cached_property
    def driven(self) -> Complex:
        """By the input."""
        if self.record.is_smooth:
            return np.asarray(np.exp(-self._s * self.delay_s) * self._input / self._off, np.complex128)
        g = self._weights[0]
        driven = (g[0] + g[1] * self._back + g[2] * self._tail) * self._input
        return np.asarray(
            driven - self._free * self._rest[0] if self.record.is_at_rest else driven, np.complex128
        )

    @cached_property
    def driven_by_pole(self) -> Complex:
        """The derivative of :attr:`driven`."""
        if self.record.is_smooth:
            return np.asarray(self.driven / self._off, np.complex128)
        g, by_pole, _ = self._weights
        driven = by_pole[0] + by_pole[1] * self._back + by_pole[2] * self._tail
        driven = (driven + g[2] * self._back**2 * self._free_by_pole) * self._input
        if self.record.is_at_rest:
            rest, rest_by_pole, _ = self._rest
            driven = driven - self._free_by_pole * rest - self._free * rest_by_pole
        return np.asarray(driven, np.complex128)

    @cached_property
    def driven_by_delay(self) -> Complex:
        """The derivative of :attr:`driven` by the delay of the input."""
        if self.record.is_smooth:
            return np.asarray(-self._s * self.driven, np.complex128)
        by_delay = self._weights[2]
        driven = (by_delay[0] + by_delay[1] * self._back + by_delay[2] * self._tail) * self._input
        return np.asarray(
            driven - self._free * self._rest[2] if self.record.is_at_rest else driven, np.complex128
        )

    @cached_property
    def _back(self) -> Complex:
        return np.ones(1, np.complex128) if self.is_mean else self.record.back

    @cached_property
    def _s(self) -> Complex:
        return np.asarray(np.zeros(1) if self.is_mean else 1j * self.record.omega, np.complex128)

    @cached_property
    def _off(self) -> Complex:
        h, off = self.record.step_s, self._s - self.p
        return np.asarray(np.where(np.abs(off) * h < ON_LINE, ON_LINE / h, off), np.complex128)

    @cached_property
    def _free(self) -> Complex:
        off = 1 - np.exp(self.p * self.record.step_s) * self._back
        return np.asarray(1 / np.where(np.abs(off) < ON_LINE, ON_LINE, off), np.complex128)

    @cached_property
    def _free_by_pole(self) -> Complex:
        h = self.record.step_s
        return np.asarray(h * np.exp(self.p * h) * self._back * self._free**2, np.complex128)

    @cached_property
    def _tail(self) -> Complex:
        return np.asarray(self._back**2 * self._free, np.complex128)

    @property
    def _whole(self) -> int:
        return int(self.delay_s // self.record.step_s)

    @cached_property
    def _input(self) -> Complex:
        whole = 0 if self.record.is_smooth else self._whole
        return self.record.input_mean(whole) if self.is_mean else self.record.input_lines(whole)

    @cached_property
    def _weights(self) -> tuple[Weights, Weights, Weights]:
        h = self.record.step_s
        return _weights(self.p, h, self.delay_s / h % 1, is_joined=self.record.is_joined)

    @cached_property
    def _rest(self) -> tuple[Complex, Complex, Complex]:
        """What an end of a record that began at rest takes from :attr:`driven`, and its derivatives."""
        h, E, root = self.record.step_s, np.exp(self.p * self.record.step_s), np.sqrt(self.record.size)
        g, by_pole, by_delay = self._weights
        u = self.record.delayed(self._whole)[::-1]
        last, u = u[0], u[1:]
        decay = -self.p.real * h
        u = u[: int(min(FORGOTTEN / decay, u.size)) + 1] if decay > 0 else u
        # Powers of exp(p h) up to the size of a block, and those of blocks: few exponentials.
        blocks = np.zeros((-(-u.size // BLOCK), BLOCK))
        blocks.ravel()[: u.size] = u
        m, k = np.arange(BLOCK), BLOCK * np.arange(len(blocks))
        power, of_block = np.exp(self.p * h * m), np.exp(self.p * h * k)
        inner = blocks @ np.stack((power.real, power.imag, m * power.real, m * power.imag), axis=1)
        sums, moments = inner[:, 0] + 1j * inner[:, 1], inner[:, 2] + 1j * inner[:, 3]
        total = complex(of_block @ sums)
        moment = h * complex(of_block @ moments + (k * of_block) @ sums)
        # The state behind the last sample, and what the last sample adds to the first of the next period.
        ends = (
            (g[1] * last + g[2] * total, g[2] - E * g[1]),
            (
                by_pole[1] * last + by_pole[2] * total + g[2] * moment,
                by_pole[2] - E * by_pole[1] - h * E * g[1],
            ),
            (by_delay[1] * last + by_delay[2] * total, by_delay[2] - E * by_delay[1]),
        )
        first, second, third = ((end + self._back * wrap * last) / root for end, wrap in ends)
        return first, second, third


def is_held(values: Real) -> bool:
    """Return whether an input shows that it is held between samples: where it acts, it often stays."""
    if np.unique(values).size <= FEW_LEVELS:
        return True
    is_at_rest = values == np.median(values)
    acts = ~(is_at_rest[1:] & is_at_rest[:-1])
    return bool(np.mean(np.diff(values)[acts] == 0) > HELD)


def few_levels(values: Real) -> tuple[int, float]:
    """Return how many levels a converter of few bits gave an input, and their distance.

    Both are 0 for many levels, and for few on purpose. Levels of 8 bits are even: the gaps between neighbours
    are whole numbers of the smallest one.

    >>> few_levels(np.round(np.sin(np.arange(200.0)), 1))[0]
    21
    """
    levels = np.unique(values)
    if not FEWEST_LEVELS <= levels.size <= MOST_LEVELS or levels.size > values.size // 2:
        return 0, 0.0
    gaps = np.diff(levels)
    steps = gaps / np.min(gaps)
    is_even = np.max(np.abs(steps - np.round(steps))) < EVEN
    return (levels.size, float(np.ptp(levels) / np.sum(np.round(steps)))) if is_even else (0, 0.0)


def autoregression(values: Real, most: int = MOST_REGRESSORS) -> tuple[Real, float]:
    """Return the coefficients, from 1 on, that whiten values, and the variance of what is left."""
    # By the equations of Yule and Walker; the order is that of the lowest BIC.
    n = values.size
    most = min(most, n // SAMPLES_EACH)
    spectrum = np.abs(np.fft.rfft(values, 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: most + 1] / n
    if not correlation[0] > 0:
        return np.ones(1), float(np.finfo(float).tiny)
    best = (n * np.log(correlation[0]), np.ones(1), float(correlation[0]))
    for order in range(1, most + 1):
        ahead = solve_toeplitz(correlation[:order], correlation[1 : order + 1])
        variance = float(correlation[0] - ahead @ correlation[1 : order + 1])
        if not variance > 0:
            break
        bic = n * np.log(variance) + order * np.log(n)
        if bic < best[0] - 2:
            best = (bic, np.append(1.0, -ahead), variance)
    return best[1], best[2]


def _weights(p: complex, h: float, fraction: float, *, is_joined: bool) -> tuple[Weights, Weights, Weights]:
    """Return the response to one sample of the input after 0, 1, 2 steps, by the pole, and by the delay."""
    # Held: differences of the step response s(t). Joined: second differences of that to a ramp, r(t).
    ages = [h * (k - fraction) for k in ((1, 2, 3) if is_joined else (1, 2))]
    parts = [(age, *_phi(p * age)) for age in ages]
    if not is_joined:
        return (
            _held(*[age * first for age, first, _, _ in parts]),
            _held(*[age**2 * (first - second) for age, first, second, _ in parts]),
            _held(*[-cmath.exp(p * age) for age in ages]),
        )
    return (
        _joined(h, *[age**2 * second for age, _, second, _ in parts]),
        _joined(h, *[age**3 * (second - 2 * third) for age, _, second, third in parts]),
        _joined(h, *[-age * first for age, first, _, _ in parts]),
    )


def _held(a: complex, b: complex) -> Weights:
    return 0j, a, b - a


def _joined(h: float, a: complex, b: complex, c: complex) -> Weights:
    return a / h, (b - 2 * a) / h, (c - 2 * b + a) / h


def _phi(x: complex) -> tuple[complex, complex, complex]:
    """Return ``phi_1 = (e^x - 1)/x``, ``phi_2 = (phi_1 - 1)/x`` and ``phi_3 = (phi_2 - 1/2)/x``.

    >>> [[round(one.real, 6) for one in _phi(x)[:2]] for x in (0j, 1 + 0j)]
    [[1.0, 0.5], [1.718282, 0.718282]]
    """
    if abs(x) >= SMALL:
        first = (cmath.exp(x) - 1) / x
        second = (first - 1) / x
        return first, second, (second - 0.5) / x
    third, term = 0j, 1 / 6 + 0j
    for k in range(TERMS):
        third, term = third + term, term * x / (k + 4)
    second = 0.5 + x * third
    return 1 + x * second, second, third
