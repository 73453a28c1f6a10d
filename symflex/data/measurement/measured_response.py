"""A measured frequency response, what is known of its accuracy, and what every file of one has to fulfil."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, Self

import numpy as np
import numpy.typing as npt

from symflex.errors import DataError, Diagnostic, Span, SpecError, Text
from symflex.quantities import WRITTEN_OUT, Unit, parse_unit

LONGEST_UNIT: Final = 30  # characters
_RELATIVE: Final = ("g", "gs", "1", "-", "x", "h", "d")  # of no unit, or of one that means two things
_KELVIN: Final = re.compile(r"(?:\u00b0|deg(?:rees?)? ?)C(?:elsius)?\b|\u2103")  # of differences
_EXPONENTIAL = re.compile(
    r"exponential[\s:=]+((?=[\d.]*[1-9])(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d{1,2})?)\s*s?", re.I
)
SMALLEST_NOISE = 1e-6  # least share of incoherent power: a coherence rounded to 1 makes no line exact
SMALLEST_NOISE_OF_RECORD = 1e-8  # the same of records, whose input is known to 1e-4 at best between samples
SHARE_OF_MEDIAN = 0.02  # no line counts more than fifty times the median one, whatever its rounded coherence


@dataclass(frozen=True, eq=False)
class Samples:
    """Even samples of an output and of its input, as a record in time has them."""

    step_s: float
    output: npt.NDArray[np.float64]
    input: npt.NDArray[np.float64] | None = None
    # Which samples were lost: the values there are guesses. None if none were.
    is_missing: npt.NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """A frequency response as an analyser estimates it, on increasing frequencies.

    Parameters
    ----------
    name : str
        Its name in reports: ``OUT/IN`` if the file has it, else the file's stem.
    frequency_hz : array of float, shape (n,)
        Positive and increasing [Hz].
    values : array of complex, shape (n,)
        Output over input, finite and not zero.
    coherence : array of float, shape (n,), optional
        Ordinary coherence, 0 < gamma^2 <= 1.
    averages : float, optional
        The number of independent averages behind each value.
    window : str
        The time window of the estimate, ``hann``, or ``exponential:0.5`` with a time constant of 0.5 s; empty
        when it is unknown or there was none.
    unit : str
        Of the values; empty when unknown.
    is_synthetic : bool
        True for computed data.
    notes : tuple of str
        How the file describes itself.
    guesses : tuple of str
        What was assumed when the file was read, because it does not state it.
    is_record : bool
        True when it was estimated from a time record.
    is_magnitude : bool
        True when no phase was measured: that of the values belongs to a minimum-phase function.
    cut_off_s : float, optional
        Length [s] of the record of a step that was cut off, whose last sample stands for the final level.
    samples : tuple of Samples
        The records in time that it was estimated from.

    Notes
    -----
    The arrays are copied and read-only. Convention: values are those of exp(+j omega t).

    Examples
    --------
    >>> response = MeasuredResponse("A/F", [1.0, 2.0], [1.0, 2j], coherence=[0.5, 0.9], averages=8)
    >>> response.relative_deviation().round(3).tolist()
    [0.25, 0.083]
    """

    name: str
    frequency_hz: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    coherence: npt.NDArray[np.float64] | None = None
    averages: float | None = None
    window: str = ""
    unit: str = ""
    is_synthetic: bool = False
    notes: tuple[str, ...] = field(default=(), repr=False)
    guesses: tuple[str, ...] = field(default=(), repr=False)
    is_record: bool = field(default=False, repr=False)
    is_magnitude: bool = field(default=False, repr=False)
    cut_off_s: float | None = field(default=None, repr=False)
    samples: tuple[Samples, ...] = field(default=(), repr=False)

    def __repr__(self) -> str:
        ends = f"{self.frequency_hz[0]:g} to {self.frequency_hz[-1]:g} Hz" if self.frequency_hz.size else "no"
        kind = "synthetic, " if self.is_synthetic else ""
        return f"<MeasuredResponse {self.name}: {kind}{self.frequency_hz.size} lines, {ends}>"

    def __post_init__(self) -> None:
        kinds = {"frequency_hz": np.float64, "values": np.complex128, "coherence": np.float64}
        for name, kind in kinds.items():
            if (given := getattr(self, name)) is not None:
                array: npt.NDArray[np.generic] = np.array(given, kind)
                array.setflags(write=False)
                object.__setattr__(self, name, array)
        shapes = {a.shape for a in (self.frequency_hz, self.values, self.coherence) if a is not None}
        if self.frequency_hz.ndim != 1 or len(shapes) != 1:
            message = f"a measured response needs one-dimensional arrays of one length, not {sorted(shapes)}"
            raise ValueError(message)

    @property
    def omega(self) -> npt.NDArray[np.float64]:
        """``2 pi`` times the frequency [rad/s]."""
        return 2 * np.pi * self.frequency_hz

    @property
    def decay_rate(self) -> float:
        """The rate that an exponential window adds to every decay [1/s]: one over its time constant."""
        return 1 / float(self.window.partition(":")[2] or np.inf)

    @property
    def omega_seen(self) -> npt.NDArray[Any]:
        """``s/j`` of the values [rad/s]: an exponential window moves ``s = j omega`` to the right."""
        return self.omega - 1j * self.decay_rate if self.decay_rate else self.omega

    @property
    def spacing_hz(self) -> float | None:
        """The spacing of lines [Hz] if it is uniform, else None."""
        steps = np.diff(self.frequency_hz)
        if not steps.size or np.ptp(steps) > 1e-3 * float(steps.mean()):
            return None
        return float(steps.mean())

    def relative_deviation(self) -> npt.NDArray[np.float64] | None:
        """Return the standard deviation of the real and of the imaginary part, over the magnitude.

        sqrt((1 - gamma^2)/(2 gamma^2 n)) for an H1 estimate with n independent averages (Bendat & Piersol,
        Random Data, 4th ed. 2010, section 9.1, equation 9.90). Without a number of averages n is 1,
        and the result is right up to a factor common to all lines. None without coherence.
        """
        if self.coherence is None:
            return None
        is_estimated = self.is_record and not self.averages
        least = SMALLEST_NOISE_OF_RECORD if is_estimated else SMALLEST_NOISE
        share = np.maximum(1 - self.coherence, least) / np.maximum(self.coherence, SMALLEST_NOISE)
        if not is_estimated:
            share = np.maximum(share, SHARE_OF_MEDIAN * float(np.median(share)))
        return np.sqrt(share / (2 * (self.averages or 1.0)))

    def misfit_db(self, model: npt.NDArray[np.complex128]) -> float:
        """Return the rms error of the model's magnitude on the lines [dB]."""
        with np.errstate(divide="ignore"):
            return float(np.sqrt(np.mean((20 * np.log10(np.abs(model / self.values))) ** 2)))

    def misfit_degrees(self, model: npt.NDArray[np.complex128]) -> float:
        """Return the rms error of the model's phase on the lines [deg]."""
        return float(np.degrees(np.sqrt(np.mean(np.angle(model / self.values) ** 2))))

    def between(self, low_hz: float, high_hz: float) -> Self:
        """Return the lines within a band [Hz], including its ends."""
        return self.taken(np.flatnonzero((self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz)))

    def taken(self, lines: npt.NDArray[np.intp]) -> Self:
        """Return the lines with these indices, in this order."""
        coherence = None if self.coherence is None else self.coherence[lines]
        return replace(
            self, frequency_hz=self.frequency_hz[lines], values=self.values[lines], coherence=coherence
        )


MAX_BYTES: Final = 50_000_000
MAX_LINES: Final = 1_000_000
MAX_RESPONSES: Final = 100  # larger files are refused before they fill the memory
MOST_LEFT_OUT: Final = 0.1  # share of lines without a number to leave out; more may be a misread column
MAX_ERRORS: Final = 20  # problems of one file that are listed
FEWEST_LINES, FEWEST_TO_SCATTER = 3, 8
MOST_AVERAGES = 1e9  # of a number of averages, beyond which it is a mistake
SHOWN_NAMES = 8
SLOWEST, FASTEST = 1e-18, 1e18  # limits [Hz]: the eighth power of a ratio of two is still a double
SMALLEST, LARGEST = 1e-100, 1e100  # magnitudes: squares, and these over another, are numbers too


def checked_response(
    response: MeasuredResponse, file: str, span_of: Callable[[int, str], Span | None]
) -> MeasuredResponse:
    """Return a response whose lines are in order, at positive frequencies, with a number each."""
    if response.frequency_hz.size > MAX_LINES:
        raise DataError(Diagnostic("SF607", f"'{file}' has more than {MAX_LINES} lines"))
    lines, said = _ordered(response, span_of)
    response = response.taken(lines)
    if (known := in_si(response.unit)) and known[0] != 1:
        factor, unit = known
        said.append(f"values are in {response.unit}, and are read in {unit}: times {factor:.6g}")
        response = replace(response, values=factor * response.values, unit=unit)
    if response.coherence is not None and lines.size >= FEWEST_TO_SCATTER:
        if many := int(np.sum(response.coherence > 1)):
            said.append(f"the coherence is above 1 on {many} lines: lines are weighed by their scatter")
            response = replace(response, coherence=None)
    response = replace(response, guesses=(*response.guesses, *said))
    frequency, values, coherence = response.frequency_hz, response.values, response.coherence
    problems: list[Diagnostic] = []

    def note(
        code: str, wrong: npt.NDArray[np.bool_], column: str, say: Callable[[int], str], hint: str
    ) -> None:
        # The first one tells: of two sweeps, or a column that was misread, every line would be named.
        for i in np.flatnonzero(wrong)[:1].tolist():
            span = span_of(int(lines[i]), column)
            location = "" if span else f"'{file}', line {lines[i] + 1} of {response.name}: "
            others = int(np.sum(wrong)) - 1
            more = f"; so in {others} more line{'s' * (others > 1)}" if others else ""
            problems.append(Diagnostic(code, location + say(i) + more, span, hint))

    wrong = ~((frequency >= SLOWEST) & (frequency <= FASTEST))
    hint = f"frequencies lie between {SLOWEST:g} and {FASTEST:g} Hz"
    note("SF603", wrong, "frequency", lambda i: f"frequency {frequency[i]:g} Hz", hint)
    is_finite, hint = np.isfinite(values), "leave the line out"
    note("SF603", ~is_finite, "value", lambda i: "the value is not a finite number", hint)
    wrong = is_finite & (values == 0)
    note("SF603", wrong, "value", lambda i: "the value is zero, which a measured value never is", hint)
    with np.errstate(over="ignore"):
        size = np.abs(values)
    wrong = is_finite & (values != 0) & ~((size >= SMALLEST) & (size <= LARGEST))
    limits = f"has a magnitude beyond {SMALLEST:g} to {LARGEST:g}"
    hint = "check the unit of the values"
    note("SF603", wrong, "value", lambda i: f"the value {values[i]:.3g} {limits}", hint)
    if (shares := coherence) is not None:
        wrong = ~((shares >= 0) & (shares <= 1))
        hint = "coherence lies between 0 and 1"
        note("SF603", wrong, "coherence", lambda i: f"coherence {shares[i]:g}", hint)
    if not problems and frequency.size:
        steps = np.diff(frequency, prepend=-1.0)
        hz = [f"frequency {f:.9g} Hz" for f in frequency] if np.any(steps <= 0) else []
        hint = "one line per frequency, and one sweep or response per table"
        note("SF604", steps == 0, "frequency", lambda i: f"{hz[i]} repeats with other values", hint)
        note("SF604", steps < 0, "frequency", lambda i: f"{hz[i]} follows {hz[i - 1][10:]}", hint)
    if problems:
        raise DataError(*problems)
    if values.size < FEWEST_LINES:
        message = f"'{file}' has {values.size} lines of data; at least {FEWEST_LINES} are needed"
        raise DataError(Diagnostic("SF605", message))
    return response


def are_few(wrong: npt.NDArray[np.bool_]) -> bool:
    """Return whether lines without a number may be left out: of those between good ones, a tenth.

    >>> are_few(np.array([True, False, True, False])), are_few(np.array([True] * 9 + [False] * 20))
    (False, True)
    """
    good = np.flatnonzero(~wrong)
    if good.size < FEWEST_LINES:
        return False
    return float(np.mean(wrong[good[0] : good[-1] + 1])) <= MOST_LEFT_OUT


@np.errstate(invalid="ignore")  # infinite frequencies
def _ordered(
    response: MeasuredResponse, span_of: Callable[[int, str], Span | None]
) -> tuple[npt.NDArray[np.intp], list[str]]:
    """Return the lines that are used, by frequency where it can be told, and what is to be said of it."""
    frequency, values, coherence = response.frequency_hz, response.values, response.coherence
    said = []

    def note(left_out: npt.NDArray[np.intp], kind: str) -> None:
        places = [(int(i), span_of(int(i), "frequency")) for i in left_out[:SHOWN_NAMES]]
        listed = ", ".join(str(location.line if location else i + 1) for i, location in places)
        more = f", ... ({left_out.size} in all)" if left_out.size > SHOWN_NAMES else ""
        many = "lines" if left_out.size > 1 else "line"
        said.append(f"left out {kind}: {many} {listed}{more}")

    def without(wrong: npt.NDArray[np.bool_], kind: str) -> npt.NDArray[np.intp]:
        if not (wrong.any() and are_few(wrong)):
            return lines
        note(lines[wrong], kind)
        return lines[~wrong]

    lines = np.flatnonzero(frequency != 0)
    if lines.size < frequency.size - 1 and not are_few(frequency == 0):
        lines = np.arange(frequency.size)  # so many zeros are no frequencies
    elif lines.size < frequency.size:
        many = frequency.size - lines.size
        said.append("the line at 0 Hz is left out" if many == 1 else f"{many} lines at 0 Hz are left out")
    is_negative = frequency[lines] < 0
    if is_negative.any() and (~is_negative).sum() >= FEWEST_LINES:
        note(lines[is_negative], "negative frequencies")
        lines = lines[~is_negative]
    with np.errstate(all="ignore"):
        wrong = ~np.isfinite(frequency[lines]) | ~np.isfinite(values[lines]) | (values[lines] == 0)
    if coherence is not None:
        wrong |= np.isnan(coherence[lines])
    lines = without(wrong, "lines without a number, or with zero")
    if coherence is not None:
        lines = without(coherence[lines] > 1, "a coherence above 1")
    steps = np.diff(frequency[lines])
    if lines.size > 1 and np.all(steps < 0):
        return lines[::-1], [*said, "the lines go down in frequency, and are reversed"]
    if np.any(steps < 0) and not _goes_through_again(frequency[lines]):
        said.append("the lines are not in order of frequency, and are sorted")
        lines = lines[np.argsort(frequency[lines], kind="stable")]
    same = np.flatnonzero((np.diff(frequency[lines]) == 0) & (np.diff(values[lines]) == 0))
    if same.size:
        note(lines[same + 1], "what repeats the line before it")
        lines = np.delete(lines, same + 1)
    return lines, said


def _goes_through_again(frequency: npt.NDArray[np.float64]) -> bool:
    """Return whether a few long runs cover the same band: several sweeps, not lines out of order."""
    runs = np.cumsum(np.diff(frequency, prepend=frequency[0]) < 0)
    switches = np.count_nonzero(np.diff(runs[np.argsort(frequency, kind="stable")]))
    return bool(8 * (runs[-1] + 1) <= frequency.size < 4 * switches)


def averages_of(text: str, file: str, span: Span | None = None) -> float:
    """Return a number of averages; SF603 when it is not one."""
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not 1 <= number <= MOST_AVERAGES:
        location = "" if span else f"'{file}': "
        message = f"{location}the number of averages is '{text[:40]}'"
        raise DataError(Diagnostic("SF603", message, span, "write a number of at least 1"))
    return number


def unit_of(text: str, file: str, span: Span | None = None) -> str:
    """Return the unit of the values, checked; empty when there is none, SF602 when it is not a unit."""
    unit = text.strip()
    if not unit:
        return ""
    try:
        parse_unit(Text.alone(file, unit))
    except SpecError as error:
        (reason, *_) = error.diagnostics
        location = "" if span else f"'{file}': "
        message = f"{location}the unit of the values: {reason.message}"
        usual = "such as m/N, m/(N*s^2), rad/V; 1 for a pure number; leave it out if there is no unit"
        raise DataError(Diagnostic("SF602", message, span, reason.hint or usual)) from None
    return unit


def in_si(written: str) -> tuple[float, str] | None:
    """Return the factor to SI of a unit as headers write it, and the SI unit; ``None`` if it is unknown.

    >>> in_si("mm/s"), in_si("Volts"), in_si("rpm"), in_si("N.m"), in_si("counts")
    ((0.001, 'm/s'), (1.0, 'V'), (0.10471975511965977, 'rad/s'), (1.0, 'N*m'), None)
    """
    text = re.sub(r"(?<=[A-Za-z])[.\u00b7\u22c5\u2022](?=[A-Za-z])", "*", written.strip())
    if not 0 < len(text) <= LONGEST_UNIT or text.lower() in _RELATIVE:
        return None
    text = re.sub(r"[A-Za-z]{3,}", lambda word: WRITTEN_OUT.get(word[0].lower(), word[0]), text)
    text = re.sub(r"\b(?:rpm|rad|deg)\b", lambda word: word[0].lower(), text, flags=re.I)
    text = _KELVIN.sub("K", re.sub(r"\bdps\b", "deg/s", text).replace("\u00ba", "\u00b0"))
    try:
        unit = parse_unit(Text.alone("", text))
    except SpecError:
        return None
    if "hz" in text.lower():  # a measured frequency is no speed of rotation
        return (1.0, text) if text == "Hz" else None
    factor = float(unit.scale) * np.pi**unit.pi_power * (2 * np.pi) ** unit.cycles
    return float(factor), _coherent(unit, text if factor == 1 and not unit.cycles else "")


def _coherent(unit: Unit, text: str) -> str:
    """Return the SI unit, in the words of the text that wrote it if there is one."""
    if re.fullmatch(r"[A-Za-z*^2/()1]+", text) and text.count("/") < 2 and text != "Nm":  # noqa: PLR2004
        return text
    turns, plain = unit.radians + unit.cycles, str(unit.dimension)
    if turns != 1:
        return plain
    return "rad" + plain.removeprefix("1") if plain.startswith("1") else f"rad*{plain}"


def ratio_of_units(above: str, below: str) -> str:
    """Return one SI unit over another, empty unless both are known."""
    if not above or not below:
        return ""
    if below in (above, "1"):
        return "1" if above == below else above
    over = f"({above})" if "/" in above else above
    under = f"({below})" if re.search("[*/]", below) else below
    return (in_si(f"{over}/{under}") or (0, ""))[1]


def window_of(text: str) -> str:
    """Return ``hann``, ``exponential:`` and the time constant [s], or nothing for any other window.

    >>> window_of(" Hanning"), window_of("exponential: 0.5 s"), window_of("flat top")
    ('hann', 'exponential:0.5', '')
    """
    if match := _EXPONENTIAL.fullmatch(text.strip()):
        return f"exponential:{match[1]}"
    return "hann" if text.strip().lower() in ("hann", "hanning", "von hann") else ""


def listed_names(names: Sequence[str]) -> str:
    """Return some names for a message."""
    shown = ", ".join(name[:30] for name in names[:SHOWN_NAMES])
    return shown + (", ..." if len(names) > SHOWN_NAMES else "")
