"""Records in time, as data loggers, oscilloscopes and simulators save them: which column is what.

Input: a file whose columns say time, ``time,u,y``, or one with a sampling time or rate above its columns.
Output: a :class:`TimeRecord` with even samples, from which :mod:`symflex.data.measurement.estimate` makes
frequency responses; ``None`` for a file of anything else::

    time (ms);Force [N];Accel [m/s^2]        t = 0, 1e-3, ...; Force is the input, Accel an output
    0,0;0,00;0,01
    1,0;0,12;0,03

An input is known by its name, else it is the first of several channels, and that is said. Where channels
differ in their last letter or number alone, ``accel_x, accel_y``, all are outputs without an input.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.arrays import arrays_in, format_of
from symflex.data.measurement.columns import meaning_of
from symflex.data.measurement.input_signal import ARRAYS, SECONDS, TIME, InputSignal, named_time
from symflex.data.measurement.measured_response import MAX_LINES, are_few
from symflex.data.measurement.text_table import COMMENTS, TextTable, bare, cut, number
from symflex.errors import DataError, Diagnostic, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.data.measurement.arrays import Arrays

Real = npt.NDArray[np.float64]

SEARCHED: Final = 300
"""Lines among which the names of columns and the first row are sought."""
BEGIN: Final = 4
"""Samples by which it is judged where a record begins."""
LONG: Final = 100.0
"""Sampling time [s] from which a time without a unit may be in milliseconds or microseconds."""
FEWEST_SAMPLES: Final = 32
"""Fewer make no response."""
JITTER: Final = 0.02
"""Share of the sampling time by which times may be off even ones without a word: a clock's last digit."""
UNEVEN: Final = 0.5
"""The same, from which a sample is missing."""
SATURATED: Final = 4
"""Samples one after the other at an end of a channel's range, from which it looks cut off."""

_INPUT = re.compile(
    r"(?:u|v_?in|u_?in|in|inp|f|exc|stim|ref|r|cmd|dac|pwm|duty)(?:[ _]?\d+)?|"
    r"(?:\w+[ _])?(?:input|eingang|entr[eé]e|force|kraft|hammer|impact|excitation|anregung|drive|actuator|"
    r"stimulus|reference|command|set[ _]?point|torque|moment|effort)(?:[ _]?\w+)?",
    re.I,
)
_RATE = re.compile(r"(?:sampl\w*|scan)[ _.]*(?:rate|freq\w*)|(?<![a-z])f_?s(?![a-z])|abtastrate", re.I)
_INTERVAL = re.compile(
    r"sampl\w*[ _.]*(?:interval|period|time)|"  # "record length" is a number of samples
    r"(?<![a-z])(?:dt|delta[ _]?[tx]|[tx]_?incr\w*|t_?s)(?![a-z])",
    re.I,
)
_NUMBER_WITH_UNIT = re.compile(r"[\s:=,;\t\"]*([-+]?[\d.]+(?:[.,]\d+)?(?:e[-+]?\d+)?)\s*\(?([a-zµμ]*)", re.I)
_HERTZ: Final = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6, "s/s": 1.0, "sps": 1.0}
_ALIKE = re.compile(r"[ _.-]?(?:[xyz]|\d+)$", re.I)
_OF_AN_INSTRUMENT: Final = {"ch", "channel", "kanal", "ai", "trace", "in", "col", "column"}
"""What channels are called whatever they measure."""
_FREQUENCY = re.compile(r"freq|fr\u00e9q|omega", re.I)
_SPEED = re.compile(r"vel|speed|gyro|rate|geschw|vitesse|drehz", re.I)
_SPECTRUM = re.compile(r"\b(?:fft|psd)\b|spectrum|spectral", re.I)
_IN_BRACKETS = re.compile(r"\s*[\[(](.*?)[\])]\s*$")


@dataclass(frozen=True, eq=False)
class TimeRecord:
    """Even samples of an input, if there is one, and of outputs."""

    name: str  # the file's stem
    step_s: float
    outputs: tuple[tuple[str, Real], ...]  # names and samples
    input: tuple[str, Real] | None = None
    guesses: tuple[str, ...] = ()  # what the file does not say

    def driven(self, output: str) -> tuple[InputSignal, tuple[str, Real]]:
        """Return the input, and the output of this name or else the first, as of a model that starts at rest.

        Both are counted from where they begin; the input only if it rests there. SF902 without an input.
        """
        if self.input is None:
            message = f"'{self.name}' has no input that could drive a model"
            raise UsageError(Diagnostic("SF902", message, None, "--columns t,u,y names the columns"))
        _, u = self.input
        u = u - u[0] if np.all(u[:BEGIN] == u[0]) else u
        name, y = next((one for one in self.outputs if one[0] == output), self.outputs[0])
        step = Fraction(f"{self.step_s:.9g}")
        times, values = [i * step for i in range(u.size)], [Fraction(f"{x:.12g}") for x in u.tolist()]
        return InputSignal(tuple(times), tuple(values), self.guesses), (name, y - np.median(y[:BEGIN]))


def read_record(name: str, data: bytes, stem: str, asked: str = "") -> TimeRecord | None:
    """Return the record that a file holds, ``None`` if its columns do not say time.

    ``asked`` is what ``--columns`` says: ``t,u,y``, ``t_ms,-,u,y``. SF602 for columns without a value; SF603
    values that are no numbers; SF604 times that do not increase; SF605 too few samples.
    """
    words = [word.strip().lower() for word in asked.split(",")] if asked else []
    is_asked = any(word.partition("_")[0] in ("t", "time") for word in words)
    if asked and not is_asked:
        return None
    suffix = format_of(name, data)
    if suffix in ARRAYS:
        return _of_arrays(arrays_in(name, data, suffix), name, stem)
    if not is_asked and not _may_be_record(data):
        return None
    table = TextTable.of(name, data)
    first = next((i for i in range(min(SEARCHED, len(table.lines))) if _is_row(table, i)), None)
    if first is None:
        return None
    width = len(cut(table.lines[first], table.delimiter))
    guesses = list(table.guesses)
    if is_asked:
        return _asked(table, first, width, words, stem, guesses)
    names, at, unit, start = named_time(table, first)
    step = None if names else _told_step(table, first)
    if not names and step is None:
        return None
    if any(_is_frequency(cell) for cell in (*names, *_names(table, first, width))):
        return None
    cells = names or _names(table, first, width) or [f"channel {i + 1}" for i in range(width)]
    columns, lines = _numbers(table, first, width, guesses)
    if names:
        times = columns[at] * float(unit) + float(start)
        channels = [(_plain(c, i), columns[i]) for i, c in enumerate(cells[:width]) if i != at]
        step, kept = _even(times, table, lines, guesses)
        if step > LONG:
            guesses.append(f"samples are {step:.6g} s apart; --columns t_us,u,y if that is another unit")
        channels = [(c, _resampled(times, x, step) if kept else x) for c, x in channels]
    else:
        assert step is not None
        guesses.append(f"the samples are {step:.6g} s apart, as the lines above say")
        channels = [(_plain(c, i), columns[i]) for i, c in enumerate(cells[:width])]
    return _sorted(channels, step, stem, name, guesses)


def _is_frequency(name: str) -> bool:
    """Tell whether a name is that of a frequency or of a spectrum; a force may be called F."""
    is_named = meaning_of(name).kind == "frequency" and bare(name).lower() != "f"
    return (is_named and not _SPEED.search(name)) or bool(_SPECTRUM.search(name))


def _may_be_record(data: bytes) -> bool:
    """Tell whether a text may be a record: its head says time, and none of it speaks of a frequency."""
    head = data[:20_000].decode("latin-1")
    if not (TIME.search(head) or _RATE.search(head) or _INTERVAL.search(head)):
        return False
    lower = data.lower()
    if not any(word in lower for word in (b"freq", b"fr\xe9q", b"fr\xc3\xa9q", b"omega")):
        return True
    return not _FREQUENCY.search(_RATE.sub("", data.decode("latin-1")))


def _is_row(table: TextTable, index: int) -> bool:
    """Tell whether a line begins with a number and has another, or nothing else; cells may be empty."""
    if table.is_row(index):
        return True
    cells = [number(c, table.decimal) for c in cut(table.lines[index], table.delimiter)]
    return isinstance(cells[0], float) and sum(isinstance(c, float) for c in cells) > 1 if cells else False


def _names(table: TextTable, first: int, width: int) -> list[str]:
    """Return the names in the last line above the first row that has as many as columns, and no number."""
    for line in reversed(table.lines[:first]):
        cells = cut(line.strip().lstrip("#%!/; "), table.delimiter)
        if len(cells) == width and all(number(c, table.decimal) is None for c in cells):
            return cells
    return []


def _told_step(table: TextTable, first: int) -> float | None:
    """Return the sampling time that a line above the first row tells, or makes with a rate [s]."""
    for line in table.lines[:first]:
        for pattern, units in ((_RATE, _HERTZ), (_INTERVAL, SECONDS)):
            match = pattern.search(line)
            told = match and _NUMBER_WITH_UNIT.search(line[match.end() :])
            if not told or (unit := told[2].lower()) not in {"", *units}:
                continue
            value = number(told[1], table.decimal)
            if isinstance(value, float) and np.isfinite(value) and value > 0:
                factor = float(SECONDS.get(unit, 1)) if units is SECONDS else _HERTZ[unit]
                return value * factor if units is SECONDS else 1 / (value * factor)
    return None


def _plain(cell: str, index: int) -> str:
    """Return the name of a channel without its unit."""
    plain = _IN_BRACKETS.sub("", bare(cell)).strip()
    return plain or f"channel {index + 1}"


def _numbers(table: TextTable, first: int, width: int, guesses: list[str]) -> tuple[list[Real], list[int]]:
    """Return the columns below the names, and the lines they stand in."""
    lines = [
        i
        for i, text in enumerate(table.lines[first:], first)
        if text.strip() and not text.lstrip().startswith(COMMENTS)
    ]
    if len(lines) > MAX_LINES:
        raise DataError(Diagnostic("SF607", f"'{table.source.name}' has more than {MAX_LINES} lines"))
    delimiter = None if table.delimiter == " " else table.delimiter
    texts = [table.lines[i] for i in lines]
    if table.decimal == ",":
        texts = [text.replace(",", ".") for text in texts]
    try:
        values = np.loadtxt(texts, delimiter=delimiter, ndmin=2, usecols=range(width), comments=None)
        return list(values.T), lines
    except (ValueError, IndexError):
        pass  # some cell is no plain number
    rows = [cut(table.lines[i], table.delimiter) for i in lines]
    read = [[number(c, table.decimal) for c in row[:width]] + [None] * (width - len(row)) for row in rows]
    empty = np.array([[not isinstance(x, float) for x in row] for row in read])
    sparse = np.flatnonzero(empty.mean(axis=0) > 0.5).tolist()  # noqa: PLR2004 (most of its cells)
    wrong = np.asarray(np.delete(empty, sparse, axis=1).any(axis=1), bool)
    if not are_few(wrong):
        place = table.line(lines[int(np.argmax(wrong))])
        hint = "a record in time has a number in every column"
        raise DataError(Diagnostic("SF603", "a line holds something else than numbers", place, hint))
    if sparse:
        many = ", ".join(str(i + 1) for i in sparse[:12])
        guesses.append(f"columns in which most cells hold no number are left out: {many}")
        read = [[np.nan if i in sparse else x for i, x in enumerate(row)] for row in read]
    if wrong.any():
        listed = ", ".join(str(lines[i] + 1) for i in np.flatnonzero(wrong)[:6].tolist())
        guesses.append(f"left out what holds no number: line {listed}")
    good = [row for row, is_wrong in zip(read, wrong.tolist(), strict=True) if not is_wrong]
    return list(np.array(good, float).T), [i for i, w in zip(lines, wrong.tolist(), strict=True) if not w]


def _even(
    times: Real, table: TextTable | None, lines: Sequence[int], guesses: list[str]
) -> tuple[float, bool]:
    """Return the sampling time, and whether the samples have to be made even first."""
    steps = np.diff(times)
    if times.size < FEWEST_SAMPLES:
        message = f"a record of {times.size} samples; at least {FEWEST_SAMPLES} are needed"
        raise DataError(Diagnostic("SF605", message))
    if not np.all(steps > 0):
        i = int(np.argmax(~(steps > 0))) + 1
        place = table.line(lines[i]) if table else None
        hint = "one record per file; sort its lines, or leave out what was recorded before"
        message = f"the time {times[i]:.9g} s follows {times[i - 1]:.9g} s"
        raise DataError(Diagnostic("SF604", message, place, hint))
    step = float(np.median(steps))
    even = times[0] + step * np.arange(times.size)
    mean = (times[-1] - times[0]) / (times.size - 1)
    if np.all(np.abs(steps - mean) <= JITTER * mean):
        return float(f"{mean:.9g}"), False
    gaps = steps > (1 + UNEVEN) * step
    if gaps.any():
        i = int(np.argmax(gaps))
        many = f" and {int(gaps.sum()) - 1} more" if gaps.sum() > 1 else ""
        guesses.append(f"samples are missing from {times[i]:.6g} to {times[i + 1]:.6g} s{many}: interpolated")
    elif np.max(np.abs(times - even)) > JITTER * step:
        spread = float(np.max(np.abs(steps / step - 1)))
        guesses.append(f"the times are not even (off by up to {spread:.0%} of a step), and are interpolated")
    return step, True


def _resampled(times: Real, values: Real, step: float) -> Real:
    """Return samples at even times, on the lines between those there are."""
    even = np.arange(times[0], times[-1] + step / 2, step)
    return np.asarray(np.interp(even, times, values), np.float64)


def _asked(
    table: TextTable, first: int, width: int, words: Sequence[str], stem: str, guesses: list[str]
) -> TimeRecord:
    """Return the record whose columns are those that ``--columns`` names."""
    if len(words) > width:
        message = f"--columns has {len(words)} words, and there are {width} columns"
        raise UsageError(Diagnostic("SF902", message, None, "such as t,u,y or t_ms,-,u,y"))
    columns, lines = _numbers(table, first, width, guesses)
    cells = _names(table, first, width) or list(words)
    at = next(i for i, word in enumerate(words) if word.partition("_")[0] in ("t", "time"))
    unit = SECONDS.get(words[at].partition("_")[2], 1)
    times = columns[at] * float(unit)
    step, kept = _even(times, table, lines, guesses)
    made: dict[str, list[tuple[str, Real]]] = {"u": [], "y": []}
    for i, word in enumerate(words):
        if word in ("-", "") or i == at:
            continue
        if word.rstrip("0123456789") not in made:
            message = f"--columns: unknown column '{word[:40]}' of a record in time"
            raise UsageError(Diagnostic("SF902", message, None, "t (or t_ms, t_us), u, y, -"))
        values = _resampled(times, columns[i], step) if kept else columns[i]
        made[word.rstrip("0123456789")].append((_plain(cells[i], i), values))
    if len(made["u"]) > 1 or not made["y"]:
        message = "--columns of a record in time has one t, at most one u, and one y or more"
        raise UsageError(Diagnostic("SF902", message, None, "such as t,u,y"))
    return TimeRecord(stem, step, tuple(made["y"]), next(iter(made["u"]), None), tuple(guesses))


def _of_arrays(arrays: Arrays, name: str, stem: str) -> TimeRecord | None:
    """Return the record of arrays: a time or a sampling time, and channels of one length."""
    plain = {k.rpartition(".")[2]: np.asarray(a) for k, a in arrays.items() if a.dtype.kind in "fiu"}
    long = {k: np.asarray(a.ravel(), np.float64) for k, a in plain.items() if a.size >= FEWEST_SAMPLES}
    if any(a.dtype.kind == "c" for a in arrays.values()) or not long:
        return None
    guesses: list[str] = []
    timed = next(((k, m) for k in long if (m := TIME.fullmatch(k))), None)
    if timed is not None:
        key, match = timed
        times = long[key] * float(SECONDS[(match["unit"] or match["alone"] or "s").lower()])
        step, kept = _even(times, None, (), guesses)
        others = [(k, x) for k, x in long.items() if x.size == times.size and k != key]
        channels = [(k, _resampled(times, x, step) if kept else x) for k, x in others]
    else:
        single = {k: float(a.ravel()[0]) for k, a in plain.items() if a.size == 1 and np.isfinite(a).all()}
        rate = next((v for k, v in single.items() if _RATE.fullmatch(k) and v > 0), None)
        told = next((v for k, v in single.items() if _INTERVAL.fullmatch(k) and v > 0), None)
        if rate is None and told is None:
            return None
        step = told or 1 / (rate or 1.0)
        sizes = Counter(x.size for x in long.values())
        size = sizes.most_common(1)[0][0]
        channels = [(k, x) for k, x in long.items() if x.size == size]
    if not channels or any(_is_frequency(k) for k, _ in channels):
        return None
    return _sorted(channels, step, stem, name, guesses)


def _sorted(
    channels: list[tuple[str, Real]], step: float, stem: str, name: str, guesses: list[str]
) -> TimeRecord:
    """Return the record with its input chosen among the channels."""
    channels = [(c, x) for c, x in channels if not (np.isnan(x).all() or np.all(np.diff(x) == 1))]
    for channel, values in channels:
        if not np.isfinite(values).all():
            place = int(np.argmin(np.isfinite(values))) + 1
            message = f"'{name}': sample {place} of '{channel[:40]}' is not a finite number"
            raise DataError(Diagnostic("SF603", message, None, "leave the line out"))
    for channel, values in channels:
        if _INPUT.fullmatch(channel) and np.ptp(values) == 0 and values[0]:
            guesses.append(f"'{channel[:30]}' is constant: a step from 0 at the first sample")
            channels = [(c, np.append(0.0 if c == channel else x[0], x)) for c, x in channels]
            break
    dead = [channel for channel, values in channels if np.ptp(values) == 0]
    channels = [(c, x) for c, x in channels if c not in dead]
    if dead:
        guesses.append(f"'{dead[0][:30]}' never changes and is left out")
    if not channels:
        raise DataError(Diagnostic("SF602", f"'{name}' has a time and no channel of numbers that changes"))
    for channel, values in channels:
        if cut_off := _cut_off(values):
            guesses.append(f"'{channel[:30]}' stays at {cut_off:.4g} for several samples: is it saturated?")
    named = [c for c, _ in channels if _INPUT.fullmatch(c)]
    family = Counter(_ALIKE.sub("", c).lower() for c, _ in channels)
    alike, many = family.most_common(1)[0]
    if named:
        source = named[0]
    elif len(channels) == 1 or (many > 1 and alike not in _OF_AN_INSTRUMENT):
        return TimeRecord(stem, step, tuple(channels), None, tuple(guesses))
    else:
        source = channels[0][0]
        said = f"'{source[:30]}', the first channel, is taken as the input"
        guesses.append(f"{said}; --columns t,u,y says otherwise")
    excitation = next((c, x) for c, x in channels if c == source)
    outputs = tuple((c, x) for c, x in channels if c != source)
    if not outputs:
        return TimeRecord(stem, step, (excitation,), None, tuple(guesses))
    return TimeRecord(stem, step, outputs, excitation, tuple(guesses))


def _cut_off(values: Real) -> float | None:
    """Return the end of its range at which a channel that varies stays several times, None if it does not."""
    if np.unique(values[:2000]).size < 10:  # noqa: PLR2004 (levels of a step or of a square wave)
        return None
    for end in (values.max(), values.min()):
        at_end = np.flatnonzero(values == end)
        if at_end.size >= SATURATED and np.any(np.diff(at_end, n=SATURATED - 1) == 0) and end != 0:
            runs = np.split(at_end, np.flatnonzero(np.diff(at_end) != 1) + 1)
            if max(map(len, runs)) >= SATURATED and len(runs) > 1:
                return float(end)
    return None
