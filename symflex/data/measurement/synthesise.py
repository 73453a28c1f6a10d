"""A synthetic measurement: what an analyser would show of a model, sensor and noise included.

Band-limited white noise drives the model; its stationary response, sensor noise added, is cut into records
with half an overlap, windowed (Hann) and averaged to the H1 estimate S_xy/S_xx and the ordinary coherence
abs(S_xy)^2/(S_xx S_yy) (Bendat & Piersol, Random Data, 4th ed. 2010, sections 6.1, 9.1 and 11.5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np
import numpy.typing as npt

from symflex.budget import spend
from symflex.data.measurement.measured_response import MeasuredResponse
from symflex.errors import refused
from symflex.options import MeasureOptions, band_ends

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

OVERLAP_WORTH: Final = 0.947  # averages per record, Hann, half overlap: 1/(1 + 2/36) (Welch 1967)
SAMPLING: Final = 2.56  # sampling rate over the highest line, as is usual in analysers
SENSOR_DAMPING: Final = 0.7
LOWEST_HZ: Final = 1e-15
HIGHEST_HZ: Final = 1e15  # beyond, squares and slopes of responses are no doubles; light has 1e15 Hz
MOST_SAMPLES: Final = 20_000_000
BEYOND: Final = 6  # lines above the highest one shown that are excited too: a window sees that far
LEAST_EXCITED: Final = 0.5  # excitation begins at half the lowest frequency shown: all lines are driven


@dataclass(frozen=True, slots=True)
class MeasurementPlan:
    """How a measurement is made."""

    # low_hz and high_hz: the lines shown [Hz].
    low_hz: float
    high_hz: float
    spacing_hz: float  # distance of lines: one over the length of a record [Hz]
    averages: int = 40  # number of records
    noise: float = 0.03  # standard deviation of the sensor's noise, over that of its signal
    # Corner of the accelerometer with its amplifier, a second-order low pass of damping 0.7; None for none.
    rolloff_hz: float | None = 5000.0
    seed: int = 1  # of the random numbers

    @staticmethod
    def of(given: MeasureOptions, band: tuple[Fraction, Fraction] | None) -> MeasurementPlan:
        """Return the plan that options say, over a band [Hz] where they say none; SF902 without one."""
        if given.band is None and band is None:
            raise refused("the specification has no [analysis] band", "give one with --band LO HI")
        low, high = map(float, (band or ()) if given.band is None else band_ends(given.band))
        spacing = high / 800 if given.spacing is None else given.spacing
        plan = MeasurementPlan(low, high, spacing, given.averages, given.noise, given.rolloff, given.seed)
        plan.check()
        return plan

    @property
    def record(self) -> int:
        """Samples per record, even."""
        return 2 * round(SAMPLING * self.high_hz / self.spacing_hz / 2)

    @property
    def rate_hz(self) -> float:
        """Samples per second."""
        return self.record * self.spacing_hz

    @property
    def samples(self) -> int:
        """Samples in all."""
        return self.record // 2 * (self.averages + 1)

    def check(self) -> None:
        """Raise SF902 for a plan that cannot be meant, SF607 for one that is too large."""
        for what, value in (("noise", self.noise), ("roll-off", self.rolloff_hz)):
            if value is not None and not np.isfinite(value):
                raise refused(f"the {what} is {value:g}: not a finite number")
        if (
            not np.isfinite((self.low_hz, self.high_hz, self.spacing_hz)).all()
            or not 0 < self.spacing_hz < self.high_hz
            or not 0 < self.low_hz < self.high_hz
        ):
            raise refused("a measurement needs 0 < LO < HI and a line spacing below HI")
        if not LOWEST_HZ <= self.low_hz < self.high_hz <= HIGHEST_HZ:
            raise refused(f"frequencies of a measurement lie between {LOWEST_HZ:g} and {HIGHEST_HZ:g} Hz")
        if self.noise < 0 or self.averages < 1 or (self.rolloff_hz is not None and self.rolloff_hz <= 0):
            raise refused("noise, averages and roll-off must be positive")
        if SAMPLING * self.high_hz / self.spacing_hz * self.averages > MOST_SAMPLES:
            message = f"this measurement takes more than {MOST_SAMPLES} samples"
            raise refused(message, "use fewer averages, or lines further apart")


def synthesise(
    name: str, function: Callable[[Real], Complex], plan: MeasurementPlan, unit: str = ""
) -> MeasuredResponse:
    """Return the measurement of a model whose response is a function of frequencies [rad/s]; SF902."""
    plan.check()
    random = np.random.default_rng(plan.seed)
    size, rate, record = plan.samples, plan.rate_hz, plan.record
    frequency: Real = np.asarray(np.fft.rfftfreq(size, 1 / rate), np.float64)
    excited = (frequency >= LEAST_EXCITED * plan.low_hz) & (
        frequency <= plan.high_hz + BEYOND * plan.spacing_hz
    )
    spectrum = np.fft.rfft(random.standard_normal(size)) * excited
    response = np.zeros(frequency.size, np.complex128)
    response[excited] = _interpolated(function, frequency[excited], plan)
    if not np.isfinite(response).all():
        message = f"{name} is not finite between {plan.low_hz:g} and {plan.high_hz:g} Hz"
        raise refused(message, "an undamped resonance has no stationary response")
    with np.errstate(all="ignore"):  # what leaves the doubles is told below
        if plan.rolloff_hz is not None:
            x = frequency / plan.rolloff_hz
            response = response / (1 - x * x + 2j * SENSOR_DAMPING * x)
        drive, signal = np.fft.irfft(spectrum, size), np.fft.irfft(spectrum * response, size)
        signal = signal + plan.noise * float(signal.std()) * random.standard_normal(size)
        lines: Real = np.asarray(np.fft.rfftfreq(record, 1 / rate), np.float64)
        window = np.sin(np.pi * np.arange(record) / record) ** 2
        power_in = np.zeros(lines.size)
        power_out = np.zeros(lines.size)
        cross = np.zeros(lines.size, np.complex128)
        for start in range(0, size - record + 1, record // 2):
            spend()
            one = np.fft.rfft(window * drive[start : start + record])
            two = np.fft.rfft(window * signal[start : start + record])
            power_in += np.abs(one) ** 2
            power_out += np.abs(two) ** 2
            cross += np.conj(one) * two
        shown = (lines >= plan.low_hz * (1 - 1e-9)) & (lines <= plan.high_hz * (1 + 1e-9)) & (lines > 0)
        coherence = np.abs(cross[shown]) ** 2 / (power_in[shown] * power_out[shown])
    if not (np.isfinite(coherence).all() and np.isfinite(cross[shown]).all()):
        message = f"the sensor signal of {name} exceeds the range of double precision"
        raise refused(message, "use less --noise or a higher --rolloff")
    independent = 1.0 if plan.averages == 1 else round(OVERLAP_WORTH * plan.averages, 2)
    sensor = "no sensor" if plan.rolloff_hz is None else f"sensor 2nd order, {plan.rolloff_hz:g} Hz"
    note = (
        f"SYNTHETIC data, computed by symflex: noise excitation, H1 estimate, {plan.averages} records, half "
        f"overlapping, Hann; sensor noise {plan.noise:g}; {sensor}; seed {plan.seed}"
    )
    values, shares = cross[shown] / power_in[shown], np.minimum(coherence, 1.0)
    return MeasuredResponse(name, lines[shown], values, shares, independent, "hann", unit, True, (note,))


def _interpolated(function: Callable[[Real], Complex], frequency: Real, plan: MeasurementPlan) -> Complex:
    """Return the response at the frequencies of the whole run, evaluated where it is known to be smooth."""
    # A run's frequencies are as close as it is long; a model is evaluated at one in so many of them, by which
    # its shortest memory still is resolved, and interpolated by cubic splines.
    step = max(1, min(plan.averages // INTERPOLATED, 64))
    if step == 1 or frequency.size < 4 * step:
        return np.asarray(function(2 * np.pi * frequency))
    from scipy.interpolate import CubicSpline

    coarse = np.unique(np.append(np.arange(0, frequency.size, step), frequency.size - 1))
    values = np.asarray(function(2 * np.pi * frequency[coarse]))
    if not np.isfinite(values).all():
        return np.full(frequency.shape, np.nan, np.complex128)
    return np.asarray(CubicSpline(frequency[coarse], values)(frequency))


INTERPOLATED: Final = 16  # the response is evaluated at least at this many points per line shown
