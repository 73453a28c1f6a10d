"""Frequency responses of time records, by scipy's spectral estimates.

Input: a :class:`~symflex.data.measurement.record.TimeRecord`.
Output: a :class:`~symflex.data.measurement.MeasuredResponse` per output; its guesses say how it was made.

    kind        known by                                    response
    step        the input has two levels                    spectrum of y' over that of u'
    impact      the input is zero but for a pulse           spectrum of y over that of u
    transient   the output begins and ends at rest          the same
    periodic    the input repeats two times or more         the mean over whole periods, at excited lines
    noise       anything else                               Welch (1967), H1 or H2
    decay       no input, and the output dies away          spectrum of y, for its poles alone
    response    no input, and it does not die away          root of its power spectrum, likewise

The spectrum of a decay that a record cuts off has its poles, and no others: at lines ``omega_k = 2 pi k/T`` a
mode ``r exp(p t)`` gives ``r (1 - exp(p T))/(j omega_k - p)``. Its gain is wrong. Under a window
``exp(-t/tau)`` over y and u their ratio is the transfer function at ``s = 1/tau + j omega``, where a fit
evaluates its model (Laplace transforms, shifted). The error of an estimate is in its coherence: of Welch's
method and of periods from their scatter, else from the noise of the output where its spectrum is lowest
(Bendat & Piersol, Random Data, 4th ed. 2010, sections 5.3 and 9.1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.measured_response import FEWEST_LINES, MeasuredResponse, Samples, window_of
from symflex.data.measurement.minimum_phase import minimum_phase
from symflex.errors import DataError, Diagnostic, refused

if TYPE_CHECKING:
    from symflex.data.measurement.record import TimeRecord

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

SEGMENTS: Final = 8  # segments of a record by default, without overlap; with half an overlap there are 15
LONGEST_SEGMENT: Final = 16_384  # samples of a segment: a fit of more lines takes longer than it tells
LEVELS: Final = 0.02  # share of a step or pulse by which a level may be off
PULSE: Final = 0.1  # share of a record in which a pulse ends
SETTLED: Final = 1e-4  # the same, below which what is left needs no window, noise or not
BELOW_NOISE: Final = 0.1  # share of the smallest amplitude seen in noise to which a window takes the rest
ABOVE_NOISE, LEAST_ALIVE = 6.0, 1000  # deviations that no sample of noise is off by; samples kept at least
AT_REST: Final = 0.02  # share of the largest amplitude below which a record's end is at rest, noise aside
EXCITED: Final = 1e-3  # share of the largest amplitude of the input's spectrum below which no line is excited
EXCITED_AGAIN: Final = 0.03  # the same of a periodic input: harmonics, and what a window fades, are below
SAME_PERIOD: Final = 0.99  # correlation of an input with itself from which it repeats
BELOW_NYQUIST: Final = {"step": 0.1, "impact": 0.25, "decay": 0.25}
"""Share of the sampling rate up to which lines are used: above, samples mix in what is beyond half of it."""
SWEPT: Final = 0.4  # share of a line's power in one segment from which an input is a sweep; noise has 0.2
OF_STEP: Final = "a step"
HELD: Final = 0.5  # share of samples equal to those before them from which an input is held between samples
STOPPED: Final = 0.01  # share of a record in whose last level the input is switched off, which is left out
PURE: Final = 1e-3  # share of an input's power beside its highest line, up to which it is one sine
TRANSIENT: Final = 100.0  # power of a line over the median, which noise does not reach
DIES_AWAY: Final = 0.3  # rms of the second half of a free decay over that of the first half, at most
DIES_SLOWLY: Final = 0.5  # the same of the last quarter over the first, if every quarter has less
ENDS: Final = 0.05  # share of a record by whose samples its ends are judged


@dataclass(frozen=True)
class Estimate:
    """How responses are estimated."""

    estimator: str = "h1"
    segments: int | None = None  # by default as the input asks
    window: str = "hann"  # or none, exponential, or exponential: and its time constant [s]
    is_chosen: bool = (
        False  # whether a fit is asked to be one to this estimate, and not to the record in time
    )

    def __post_init__(self) -> None:
        if self.window not in ("none", "exponential") and not window_of(self.window):
            message = f"the window '{self.window[:40]}' is neither hann nor none nor exponential:SECONDS"
            raise refused(message, "such as --window exponential:0.5")


@dataclass(frozen=True, eq=False)
class _Channel:
    u: Real
    y: Real
    step_s: float

    @cached_property
    def level(self) -> tuple[int, float] | None:
        """Where the input jumps from one level to another, and by how much; ``None`` if it does not."""
        u, size = self.u, float(np.ptp(self.u))
        low = np.abs(u - u[0]) <= LEVELS * size
        high = np.abs(u - u[-1]) <= LEVELS * size
        if abs(u[-1] - u[0]) < (1 - LEVELS) * size or not np.all(low | high):
            return None
        jump = int(np.argmax(high))
        return (jump, float(u[-1] - u[0])) if np.all(high[jump:]) and np.all(low[:jump]) else None

    @cached_property
    def pulse(self) -> int | None:
        """Where a short pulse begins, before and after which the input is zero; ``None`` if it is another."""
        baseline = np.median(self.u)
        acting = np.flatnonzero(np.abs(self.u - baseline) > LEVELS * np.max(np.abs(self.u - baseline)))
        is_short = acting[-1] - acting[0] < PULSE * self.u.size and acting[0] < self.u.size / 2
        return int(acting[0]) if is_short else None

    @property
    def is_transient(self) -> bool:
        """Tell whether the output begins and ends at rest, but for noise."""
        n = max(int(ENDS * self.y.size), 4)
        begin, end = self.y[: min(n, 4)], self.y[-n:]
        limit = AT_REST * float(np.max(np.abs(self.y - begin[0]))) + 4 * _noise_of(self.y)
        return float(abs(begin[0] - np.median(end))) <= limit and float(np.ptp(end)) <= 2 * limit

    @property
    def is_sweep_from_rest(self) -> bool:
        """Tell whether input and output begin at zero, and every frequency of the input has its time."""
        if any(abs(x[0]) > AT_REST * np.max(np.abs(x)) for x in (self.u, self.y)):
            return False
        length = max(self.u.size // SEGMENTS, 16)
        power = np.abs(_segments(self.u, length, length // 8, np.hanning(length))) ** 2
        return bool(power.max(axis=0).sum() > SWEPT * power.sum())

    @cached_property
    def period(self) -> int | None:
        """Samples after which the input repeats, twice or more in the record; ``None`` if it does not."""
        u = self.u - self.u.mean()
        n = u.size
        same = np.fft.irfft(np.abs(np.fft.rfft(u, 2 * n)) ** 2)[: n // 2 + 1]
        energy = np.concatenate([[0.0], np.cumsum(u**2)])
        ahead, behind = energy[n - np.arange(same.size)], energy[n] - energy[: same.size]
        share = same / np.maximum(np.sqrt(ahead * behind), 1e-300)
        below = np.flatnonzero(share < SAME_PERIOD)
        if not below.size:
            return None
        again = np.flatnonzero(share[below[0] :] >= SAME_PERIOD)
        if not again.size:
            return None
        start = below[0] + int(again[0])
        end = start + int(np.argmax(np.append(share[start:] < SAME_PERIOD, True)))
        return int(start + np.argmax(share[start:end]))


def _dies_away(values: Real) -> bool:
    """Return whether a record is a free decay: most of it is in its first half, or less in each quarter."""
    first, second = (float(np.std(half)) for half in np.array_split(values, 2))
    quarters = [float(np.std(part)) for part in np.array_split(values, 4)]
    begins = np.argmax(np.abs(values - np.median(values))) < values.size / 8
    falls = begins and all(a > b for a, b in pairwise(quarters)) and quarters[-1] < DIES_SLOWLY * quarters[0]
    return second <= DIES_AWAY * first or bool(falls)


def responses_of(record: TimeRecord, how: Estimate) -> tuple[MeasuredResponse, ...]:
    """Return the estimated response of every output of a record; SF605 when no line is left."""
    made = []
    for name, values in record.outputs:
        averages: float | None = None
        window, is_driven = "", record.input is None and not _dies_away(values)
        if record.input is None:
            if is_driven:
                alone = _Channel(values, values, record.step_s)
                frequency, response, coherence, averages, window, said = _by_segments(alone, how)
            else:
                frequency, response, coherence, said = _decay(values, record.step_s)
            called = name if len(record.outputs) > 1 else record.name
        else:
            source, u = record.input
            channel = _Channel(u, values, record.step_s)
            if said := _one_frequency(channel):
                raise DataError(
                    Diagnostic("SF605", said, None, "a sweep, a step or noise has many frequencies")
                )
            frequency, response, coherence, averages, window, said = _estimated(channel, how)
            called = f"{name}/{source}"
        is_finite = np.isfinite(response) & (response != 0) & (frequency > 0)
        if is_finite.sum() < FEWEST_LINES and record.input is not None:
            frequency, response, said = _plain(channel)
            coherence, averages, window = None, None, ""
            is_finite = np.isfinite(response) & (response != 0)
        if is_finite.sum() < FEWEST_LINES:
            message = f"the record of '{name[:40]}' makes no response: it contains too few frequencies"
            raise DataError(Diagnostic("SF605", message, None, "a sweep, a step or noise has them all"))
        shares = None if coherence is None else np.clip(np.asarray(coherence)[is_finite], 1e-6, 1.0)
        made.append(
            MeasuredResponse(
                called, frequency[is_finite], response[is_finite], shares, averages, window,
                record.unit(name) if record.input else "", notes=(said,), guesses=(*record.guesses, said),
                is_record=True, is_magnitude=is_driven,
                cut_off_s=1 / frequency[1] if said.startswith(OF_STEP) and not window else None,
                samples=() if is_driven or how.is_chosen else (_samples(record, values),),
            )
        )  # fmt: skip
    return tuple(made)


def _plain(channel: _Channel) -> tuple[Real, Complex, str]:
    """Return the quotient of spectra on all lines, of a record too short for anything else."""
    with np.errstate(all="ignore"):
        response = np.fft.rfft(np.diff(channel.y))[1:] / np.fft.rfft(np.diff(channel.u))[1:]
    frequency = np.asarray(np.fft.rfftfreq(channel.y.size - 1, channel.step_s)[1:], np.float64)
    return frequency, response, "a short record: spectrum of the output's increments over those of the input"


def _one_frequency(channel: _Channel) -> str:
    """Return what a steady sine says, whose transients are over; empty for any other input."""
    u, y, n = channel.u, channel.y, channel.u.size
    size = np.abs(np.fft.rfft((u - u.mean()) * np.hanning(n))) ** 2
    top = int(np.argmax(size))
    if top < 4 or size[max(top - 3, 0) : top + 4].sum() < (1 - PURE) * size.sum():  # noqa: PLR2004 (Hann)
        return ""
    t = channel.step_s * (np.arange(n) - n / 2)
    omega = 2 * np.pi * top / (n * channel.step_s)
    for _ in range(8):
        cosine, sine, one = np.cos(omega * t), np.sin(omega * t), np.ones(n)
        a, b, _ = np.linalg.lstsq(np.stack((cosine, sine, one), 1), u, rcond=None)[0]
        slope = t * (b * cosine - a * sine)
        omega += np.linalg.lstsq(np.stack((cosine, sine, one, slope), 1), u, rcond=None)[0][3]
    columns = np.stack((np.cos(omega * t), np.sin(omega * t), np.ones(n), t), 1)
    of_u, of_y = (np.linalg.lstsq(columns, x, rcond=None)[0] for x in (u, y))
    rest = np.abs(np.fft.rfft((y - columns @ of_y) * np.hanning(n)))[3:] ** 2
    if rest.max(initial=0.0) > TRANSIENT * np.median(rest) and rest.sum() > PURE * np.sum(y**2):
        return ""
    value = complex(of_y[0], -of_y[1]) / complex(of_u[0], -of_u[1])
    phase = np.degrees(np.angle(value))
    said = f"one frequency gives one value, {abs(value):.4g} at {phase:.4g} degrees"
    return f"the input is a steady sine of {omega / (2 * np.pi):.6g} Hz: {said}"


def _samples(record: TimeRecord, values: Real) -> Samples:
    """Return what a fit in time uses: all samples, or a free decay from where it is largest."""
    if record.input is not None:
        return Samples(record.step_s, values, record.input[1], record.is_missing)
    start = _largest(values)
    missing = None if record.is_missing is None else record.is_missing[start:]
    return Samples(record.step_s, values[start:], None, missing)


def _largest(values: Real) -> int:
    """Return where a free decay begins: at its largest amplitude, if that is in the first half."""
    start = int(np.argmax(np.abs(values - np.median(values[-max(values.size // 10, 8) :]))))
    return start if start < values.size / 2 else 0


_Estimated = tuple[npt.NDArray[Any], Complex, Real | None, float | None, str, str]


def _estimated(channel: _Channel, how: Estimate) -> _Estimated:
    """Return frequencies, response, coherence, number of averages, window, and what was done."""
    held = int(np.flatnonzero(np.append(True, channel.u != channel.u[-1]))[-1])  # before the last level
    shorter = _Channel(channel.u[:held], channel.y[:held], channel.step_s)
    if channel.u.size - held <= STOPPED * channel.u.size and (shorter.level or (0, 0.0))[1]:
        channel = shorter
    is_exponential = how.window.startswith("exponential")
    if how.segments is None and channel.level is not None:
        return _of_step(channel, how)
    if how.segments is None and (channel.pulse is not None or is_exponential):
        made = _of_whole(channel, how, "a record from rest" if channel.pulse is None else "an impact")
    elif how.segments is None and (period := channel.period) is not None:
        made = _of_periods(channel, period)
    elif how.segments is None and channel.is_transient:
        made = _of_whole(channel, how, "the output begins and ends at rest")
    elif how.segments is None and channel.is_sweep_from_rest:
        made = _of_whole(channel, replace(how, window="exponential"), "a record from rest")
    else:
        made = _by_segments(channel, how)
    is_held = np.mean(np.diff(channel.u) == 0) > HELD and channel.pulse is None
    return _without_hold(made, channel.step_s) if is_held else made


def _without_hold(made: _Estimated, step_s: float) -> _Estimated:
    """Return the response of an input that is held between samples, which sees ``(1 - exp(-s h))/(s h)``."""
    # What is folded back is an error: the hold falls with frequency, and so does a plant at least.
    frequency, response, coherence, averages, window, said = made
    s, share = 2j * np.pi * frequency * step_s, frequency * step_s
    with np.errstate(all="ignore"):
        response = response * s / (1 - np.exp(-s))
        noise = 0.0 if coherence is None else 1 / coherence - 1
    coherence = 1 / (1 + noise + (averages or 1.0) * (share / (1 - share)) ** 4)
    return frequency, response, coherence, averages, window, f"{said}; the input is held between samples"


def _of_step(channel: _Channel, how: Estimate) -> _Estimated:
    """Return the response from a step: the spectrum of the output's increments over the jump."""
    # An input that is held between samples gives ``G(s) (1 - exp(-s h))/(s h)`` and what samples fold back.
    assert channel.level is not None
    jump, size = channel.level
    before = float(np.mean(channel.y[:jump])) if jump else 0.0
    y = channel.y[jump:]
    y, noise = y[: _alive(y)], _noise_of(y)
    increments = np.diff(np.concatenate([[before], y]))
    weights, window, said = _weights(increments, 2 * noise, channel.step_s, how)
    frequency = np.fft.rfftfreq(increments.size, channel.step_s)
    s = 2j * np.pi * frequency * channel.step_s - np.log(weights[1])
    with np.errstate(all="ignore"):
        hold = np.where(s == 0, 1, (1 - np.exp(-s)) / s)
    response = np.fft.rfft(increments * weights) / size / hold
    kept = _apart(weights) & (frequency <= BELOW_NYQUIST["step"] / channel.step_s)
    # Noise of every sample enters twice, but for that of the levels at both ends.
    variance = np.abs(1 - np.exp(-s)) ** 2 * np.sum(weights**2) + 1 / max(jump, 1)
    # The last level is no mean of samples that still ring a little: a decay cut off ends with its last one.
    variance += weights[-1] ** 2
    coherence = _coherence(response, noise * np.sqrt(variance) / abs(size) / np.maximum(np.abs(hold), 1e-3))
    said = f"{OF_STEP}: spectrum of the output's increments over the jump{said}"
    return frequency[kept], response[kept], coherence[kept], None, window, said


def _of_whole(channel: _Channel, how: Estimate, kind: str) -> _Estimated:
    first = channel.u[:4]
    offset = float(first[0]) if np.ptp(first) <= LEVELS * np.ptp(channel.u) else 0.0
    before = max(channel.pulse or 0, 4)
    noise, y = _noise_of(channel.y), channel.y - channel.y[:before].mean()
    if channel.pulse is None and how.window == "hann":  # it would weigh little what acts late
        how = replace(how, window="none")
    weights, window, said = _weights(y, noise, channel.step_s, how)
    above, below = np.fft.rfft(y * weights), np.fft.rfft((channel.u - offset) * weights)
    frequency, size = np.fft.rfftfreq(y.size, channel.step_s), np.abs(below)
    least = EXCITED_AGAIN if window and channel.pulse is None else EXCITED
    kept = _apart(weights) & (size > least * size.max())
    if channel.pulse is not None or window:
        kept &= frequency <= BELOW_NYQUIST["impact"] / channel.step_s
    with np.errstate(all="ignore"):
        response = above / below
        # The level before the input acts is a mean of few samples, and is taken from all.
        variance = np.sum(weights**2) + np.abs(np.fft.rfft(weights)) ** 2 / before
        coherence = _coherence(response, noise * np.sqrt(variance) / size)
    reach = f", up to {frequency[kept][-1]:.4g} Hz" if kept.any() and channel.pulse is None else ""
    said = f"{kind}: spectrum of the output over that of the input{reach}{said}"
    return frequency[kept], response[kept], coherence[kept], None, window, said


def _weights(y: Real, noise: float, step_s: float, how: Estimate) -> tuple[Real, str, str]:
    """Return an exponential window over a response that begins at rest, its name, and what is said of it."""
    # ``exp(-t/tau)`` over input and output gives the transfer function at ``s = 1/tau + j omega``. If none is
    # asked for, it is as long as it may be to take what the output still does at the end below the noise.
    # Noise that it lets through correlates lines: ``1/(1 + j pi k tau/T)`` on those k apart.
    length = y.size * step_s
    end = y[-max(y.size // 10, 8) :]
    remaining = 2 * float(np.max(np.abs(np.fft.rfft(end)))) / end.size
    # The largest of m lines of noise hardly exceeds its mean power (ln m + 5)-fold.
    limit = max(2 * noise * np.sqrt((np.log(end.size) + 5) / end.size), SETTLED * float(np.max(np.abs(y))))
    # Whole decades, so that records of one kind have one window and can be averaged.
    decays = np.log(10) * np.ceil(np.log10(remaining / limit / BELOW_NOISE)) if remaining > limit else 0.0
    if how.window == "none" or (how.window == "hann" and decays == 0):
        share = remaining / float(np.max(np.abs(y)))
        said = f"; {share:.0%} of it is left at the end, which changes gains, not poles"
        return np.ones(y.size), "", said if share > AT_REST else ""
    asked = how.window.partition(":")[2]
    tau = float(asked or f"{length / (decays if how.window == 'hann' else np.log(100)):.4g}")
    said = f", both with an exponential window of {tau:.4g} s: a fit subtracts its decay rate from the poles"
    weights = np.exp(-np.arange(y.size) * step_s / tau)
    return np.asarray(weights, np.float64), f"exponential:{tau:.4g}", said


def _alive(y: Real) -> int:
    """Return where to end a record: if most of it is noise, at thrice the time at which only that is left."""
    moving = np.flatnonzero(np.abs(y - np.median(y[y.size // 2 :])) > ABOVE_NOISE * _noise_of(y))
    end = max(3 * int(moving[-1]), LEAST_ALIVE) if moving.size else y.size
    return end if 2 * end < y.size else y.size


def _apart(weights: Real) -> npt.NDArray[np.bool_]:
    """Return which lines are kept behind a window: every so many that noise has half forgotten."""
    lines = np.arange(weights.size // 2 + 1)
    return np.asarray(lines % max(round(-np.log(weights[-1]) / 1.5), 1) == 0)


def _of_periods(channel: _Channel, period: int) -> _Estimated:
    """Return the mean over whole periods, those left out in which the output has not settled."""
    count = channel.u.size // period
    u, y = (x[channel.u.size - count * period :].reshape(count, period) for x in (channel.u, channel.y))
    apart = np.std(y - y[-1], axis=1)
    skipped = int(np.argmax(apart <= 2 * apart[-2])) if count > 2 else 0  # noqa: PLR2004
    u, y = u[skipped:], y[skipped:]
    above, below = np.fft.rfft(y, axis=1), np.fft.rfft(u, axis=1).mean(axis=0)
    kept = np.abs(below) > EXCITED_AGAIN * np.abs(below).max()
    n = y.shape[0]
    with np.errstate(all="ignore"):
        response = above.mean(axis=0) / below
        spread = np.sqrt(np.mean(np.abs(above - above.mean(axis=0)) ** 2, axis=0) / max(n - 1, 1))
        deviation = spread / np.abs(below)
    frequency = np.fft.rfftfreq(period, channel.step_s)
    said = f"a periodic input: the mean over {n} periods of {period * channel.step_s:.6g} s"
    said += f", after {skipped} in which the output settles" if skipped else ""
    # Lines between those of a square wave show how little of the input they have.
    coherence = _coherence(response[kept], np.sqrt(_smoothed(deviation[kept] ** 2))) if n > 1 else None
    return frequency[kept], response[kept], coherence, None, "", said


def _by_segments(channel: _Channel, how: Estimate) -> _Estimated:
    """Return Welch's estimate; of a channel that is its own input, the magnitude under white noise."""
    # Poles are in it as in the decay of its correlation function (Natural Excitation Technique, James, Carne
    # & Lauffer 1993), and errors of its lines are independent, as they are not there.
    n = channel.u.size
    length = max(n // (how.segments or max(SEGMENTS, -(-n // LONGEST_SEGMENT))), 16)
    is_hann = how.window == "hann"
    overlap = length // 2 if is_hann else 0
    weights = np.hanning(length + 1)[:-1] if is_hann else np.ones(length)
    above, below = (_segments(x, length, overlap, weights) for x in (channel.y, channel.u))
    scale = 2 * channel.step_s / np.sum(weights**2)  # one-sided densities
    frequency = np.fft.rfftfreq(length, channel.step_s)
    cross = scale * np.mean(np.conj(below) * above, axis=0)
    of_input, of_output = (scale * np.mean(np.abs(x) ** 2, axis=0) for x in (below, above))
    with np.errstate(all="ignore"):
        coherence = np.abs(cross) ** 2 / (of_input * of_output)
        response = cross / of_input if how.estimator == "h1" else of_output / np.conj(cross)
    kept = (of_input > EXCITED**2 * of_input.max()) & (frequency > 0) & (frequency < 0.45 / channel.step_s)
    count = above.shape[0]
    # Segments of a Hann window that overlap by half are as good as so many independent ones (Welch 1967).
    averages = count / (1 + (count > 1) * 2 * (count - 1) / count / 36) if is_hann else count
    name = "Hann window, half an overlap" if is_hann else "no window"
    long = f"{length * channel.step_s:.6g} s"
    said = f"Welch's method, {how.estimator.upper()}: {count} segments of {long}, {name}"
    if channel.u is channel.y:
        size = np.asarray(np.sqrt(of_output), np.float64)
        response, coherence = size * np.exp(1j * minimum_phase(np.asarray(frequency, np.float64), size)), None
        said = (
            "no input, and the output does not die away: taken as driven by white noise, its magnitude by "
            f"{said}; poles are those of the system, gain and zeros those of this output alone"
        )
    window = "hann" if is_hann else ""
    shares = None if coherence is None else coherence[kept]
    return frequency[kept], response[kept], shares, float(averages), window, said


def _segments(values: Real, length: int, overlap: int, weights: Real) -> Complex:
    """Return the spectra of parts of a signal, a row each, without their means."""
    parts = np.lib.stride_tricks.sliding_window_view(values, length)[:: length - overlap]
    return np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * weights, axis=1)


def _decay(values: Real, step_s: float) -> tuple[npt.NDArray[Any], Complex, Real | None, str]:
    """Return the spectrum of a free response from its largest amplitude on."""
    centred = values - np.median(values[-max(values.size // 10, 8) :])
    start = _largest(values)
    kept = centred[start:].copy()
    kept[0] /= 2  # the trapezoidal rule at a jump
    frequency = np.fft.rfftfreq(kept.size, step_s)
    spectrum = np.fft.rfft(kept) * step_s
    used = (frequency > 0) & (frequency <= BELOW_NYQUIST["decay"] / step_s)
    said = (
        f"no input: the output from {start * step_s:.6g} s on is taken as a free decay; its poles are those "
        "of the system, its gain and zeros those of this record alone"
    )
    deviation = np.full(spectrum.size, _noise_of(kept) * np.sqrt(kept.size) * step_s)
    return frequency[used], spectrum[used], _coherence(spectrum, deviation)[used], said


def _noise_of(values: Real) -> float:
    """Return the standard deviation of white noise on samples: of their spectrum where that is lowest."""
    size = np.abs(np.fft.rfft(np.diff(values))) ** 2
    turn = 4 * np.sin(np.pi * np.arange(size.size) / (2 * max(size.size - 1, 1))) ** 2
    with np.errstate(all="ignore"):
        power = size[1:] / turn[1:]
    parts = np.array_split(power, min(20, max(power.size // 8, 1)))
    medians = np.sort([float(np.median(part)) for part in parts])
    # The lowest of many is too low: all that lie within the scatter of the mean of those below are noise.
    limit = 1 + 3 / np.sqrt(parts[0].size)
    means = np.cumsum(medians) / np.arange(1, medians.size + 1)
    above = np.flatnonzero(medians[1:] > limit * means[:-1])
    return float(np.sqrt(means[above[0] if above.size else -1] / np.log(2) / values.size))


def _smoothed(power: Real) -> Real:
    """Return a power averaged over neighbouring lines, as the scatter of few periods is itself uncertain."""
    width = min(9, power.size | 1)
    padded = np.pad(power, width // 2, mode="reflect")
    return np.asarray(np.convolve(padded, np.ones(width) / width, "valid")[: power.size], np.float64)


def _coherence(response: Complex, deviation: Real) -> Real:
    """Return the coherence that stands for a standard deviation of a complex value, of one average."""
    with np.errstate(all="ignore"):
        share = (deviation / np.abs(response)) ** 2
    return np.asarray(1 / (1 + np.where(np.isfinite(share), share, 1e12)), np.float64)
