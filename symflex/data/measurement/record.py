"""Time records, as data loggers, oscilloscopes and simulators save them: which column is what.

Input: a file with a column of time, ``time,u,y``, or one with a sampling time or rate above its columns.
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
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.arrays import (
    Arrays,
    arrays_in,
    format_of,
    largest_matrix,
    matrix_of,
    with_axes,
)
from symflex.data.measurement.column_meaning import meaning_of
from symflex.data.measurement.column_names import SECONDS
from symflex.data.measurement.comma_separated import lines_with_axis
from symflex.data.measurement.heading import units_below, with_unit
from symflex.data.measurement.input_signal import (
    ARRAYS,
    TIME,
    InputSignal,
    first_beside,
    named_time,
)
from symflex.data.measurement.likely_readings import is_time
from symflex.data.measurement.measured_response import MAX_LINES, are_few, in_si, listed_names, ratio_of_units
from symflex.data.measurement.text_table import COMMENTS, TextTable, bare, cut, number
from symflex.data.measurement.universal_file import UNIVERSAL, signals_in
from symflex.errors import DataError, Diagnostic, refused

Real = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SEARCHED: Final = 300  # lines among which the names of columns and the first row are sought
BEGIN: Final = 4  # samples by which it is judged where a record begins
LONG: Final = 2.0  # sampling time [s] from which a time without unit may be in milliseconds or microseconds
FEWEST_SAMPLES: Final = 32  # fewer make no response
JITTER: Final = 0.02  # share of the sampling time by which a clock's last digit may move times
MOST_GAPS: Final = 0.02  # share of steps up to which they are gaps, and beyond which steps differ
UNEVEN: Final = 0.5  # the same, from which a sample is missing
SATURATED: Final = 4  # samples in a row at an end of a channel's range, from which it looks cut off
LEVELS: Final = 10  # different values of a step or of a square wave, and of nothing else
STANDARD_GRAVITY: Final = 9.80665  # m/s^2 (CGPM 1901)
MOST_CHANNELS: Final = 64  # columns of a matrix that are channels
SAME: Final = 1 - 1e-12  # correlation from which a channel is a multiple of another

_INPUT = re.compile(
    r"(?:v\(\w*in\w*\)|\w+ ?\(in\)|f_\d+n?[rxyz]*)|"
    r"(?:u|u_?est|u_?val|v_?in|u_?in|in|inp|f|exc|stim|ref|r|cmd|dac|pwm|duty)(?:[ _]?\d+)?|"
    r"(?:\w+[ _])?(?:input|eingang|entr[eé]e|force|kraft|hammer|impact|excitation|anregung|drive|actuator|"
    r"stimulus|reference|command|cmd|desired|target|set[ _]?point|torque|moment|effort|throttle|esc)"
    r"(?:[ _]?\w+)?",
    re.I,
)
_COMMAND = re.compile(r"(?:\w+[ _])?(?:esc|throttle|pwm|duty)", re.I)
_MARKER = re.compile(r"(?:\w+[ _])?(?:trigger|trig|tacho\w*|keyphasor|marker|event|gate)(?:[ _]?\w+)?", re.I)
"""Names of channels that say when something happens, and are neither input nor output."""
_CLOCK = re.compile(
    rb"(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}([T ,;\t])\s*)?(?<!\d)(\d\d?):(\d\d):(\d\d)(\.\d+|,\d+(?=[;\t\"]))?"
    rb"(?:Z|[-+]\d\d:?\d\d)?"
)
"""A time of day, perhaps behind a date: 2024-01-05T10:00:00.010Z, 05.01.2024 10:00:00,010, 10:00:00.010."""
_CLOCK_NAME = re.compile(r"time|stamp|clock|epoch", re.I)
DAY: Final = 86_400
_EPOCHS: Final = {1e-3: (1e11, 1e13), 1e-6: (1e14, 1e16), 1e-9: (1e17, 1e19)}
"""Where times since 1970 are if they are not in seconds, of this century."""
_DAYS: Final = (36_526, 73_050)  # numbers of days by which workbooks write the dates from 2000 to 2099
_RATE = re.compile(r"(?:sampl\w*|scan)[ _.]*(?:rate|freq\w*)|(?<![a-z])f_?s(?![a-z])|abtastrate", re.I)
_INTERVAL = re.compile(
    r"sampl\w*[ _.]*(?:interval|period|time)|"  # "record length" is a number of samples
    r"(?<![a-z])(?:dt|delta[ _]?[tx]|[tx]_?incr\w*|t_?s)(?![a-z])",
    re.I,
)
_NUMBER_WITH_UNIT = re.compile(r"[\s:=,;\t\"]*([-+]?[\d.]+(?:[.,]\d+)?(?:e[-+]?\d+)?)\s*\(?([a-zµμ]*)", re.I)
_HERTZ: Final = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6, "s/s": 1.0, "sps": 1.0}
_ALIKE = re.compile(r"[ _.-]?(?:[xyz]|\d+)$", re.I)
_OF_AN_INSTRUMENT: Final = {"", "ch", "channel", "kanal", "ai", "trace", "in", "col", "column"}
"""What channels are called whatever they measure."""
_FREQUENCY = re.compile(r"freq|fr\u00e9q", re.I)
_SPEED = re.compile(r"vel|speed|gyro|rate|geschw|vitesse|drehz|angular(?!.?fr)", re.I)
MOST_RECORDS: Final = 100  # of a file, one below the other
_SIGNALS: Final = ("f", "omega", "w", "\u03c9", "angular")
"""Words for frequencies that signals have, too."""
_SPECTRUM = re.compile(r"\b(?:fft|psd)\b|spectrum|spectral", re.I)
_OF_TIME = re.compile(r"(?:t|time)([/_])\s*(?:s|ms)", re.I)
"""Names of a time after which others have their units in the same way, ``F/N`` or ``x_m``."""
_SAID = re.compile(r"\W*units?(?:[ _]+(?:of[ _]+)?(?P<of>[^:=]+?))?\s*[:=]\s*(?P<unit>[^=]+)", re.I)
"""Comments that give the unit of a response, of one channel, or of all columns."""
_SHAKEN = re.compile(r"acc|a[xyz]?\d*|beschl|vib|imu|point.*", re.I)  # names of what is measured in g


class RestartError(DataError):
    """The times of a record begin again on a line: another record follows."""

    def __init__(self, diagnostic: Diagnostic, line: int) -> None:
        super().__init__(diagnostic)
        self.line = line  # from 0


@dataclass(frozen=True, eq=False)
class TimeRecord:
    """Even samples of an input, if there is one, and of outputs."""

    name: str  # the file's stem
    step_s: float
    outputs: tuple[tuple[str, Real], ...]  # names and samples
    input: tuple[str, Real] | None = None
    guesses: tuple[str, ...] = ()  # what the file does not say
    units: Mapping[str, str] = field(default_factory=dict)  # of channels, in SI, where the file gives them
    is_missing: Mask | None = None  # which samples were lost, and are guesses

    def unit(self, output: str) -> str:
        """Return the unit of an output over the input, empty if the file does not give both."""
        source = self.input[0] if self.input else ""
        return self.units.get(f"{output}/{source}") or ratio_of_units(
            self.units.get(output, ""), self.units.get(source, "")
        )

    @property
    def is_held(self) -> bool:
        """Whether the input keeps its samples until the next, as one that jumps or waits does."""
        changes = np.flatnonzero(np.diff(self.input[1])) if self.input else np.empty(0, int)
        if not self.input or not changes.size:
            return False
        is_switched = np.unique(self.input[1]).size < LEVELS
        return bool(is_switched or 2 * changes.size < changes[-1] - changes[0])

    def driven(self, output: str) -> tuple[InputSignal, tuple[str, Real]]:
        """Return the input from where it begins, and an output, by name or the first; SF902 without."""
        if self.input is None:
            message = f"'{self.name}' has no input that could drive a model"
            raise refused(message, "--columns t,u,y names the columns")
        _, u = self.input
        u = u - u[0] if np.all(u[:BEGIN] == u[0]) else u
        name, y = next((one for one in self.outputs if one[0] == output), self.outputs[0])
        step = Fraction(f"{self.step_s:.9g}")
        times, values = [i * step for i in range(u.size)], [Fraction(f"{x:.12g}") for x in u.tolist()]
        return InputSignal(tuple(times), tuple(values), self.guesses), (name, y)


def read_record(name: str, data: bytes, stem: str, asked: str = "") -> TimeRecord | None:
    """Return the record that a file contains, ``None`` if its columns, or those ``asked``, say no time."""
    given = [word.strip() for word in asked.split(",")] if asked else []
    interval = next((word for word in given if word.lower().startswith("dt=")), "")
    words = [word for word in given if word != interval]
    if asked and not (interval or any(re.fullmatch(r"(?:t|time)(?:[_=].*)?", word, re.I) for word in words)):
        return None
    suffix = format_of(name, data)
    if suffix in ARRAYS or suffix in UNIVERSAL:
        arrays = signals_in(name, data) if suffix in UNIVERSAL else with_axes(arrays_in(name, data, suffix))
        if not arrays:
            return None
        if suffix in UNIVERSAL and arrays["time"].size < FEWEST_SAMPLES:
            raise _too_short(arrays["time"].size)
        return _asked_arrays(arrays, words, interval, name, stem) if asked else _of_arrays(arrays, name, stem)
    if not asked and not _may_be_record(data):
        return None
    if (stepped := lines_with_axis(TextTable.of(name, data))) is not None:
        data = stepped[0]
    table = TextTable.of(name, timed := _without_clock(data))
    used = [i for i, word in enumerate(words) if word not in ("-", "")]
    head = range(min(SEARCHED, len(table.lines)))
    first = next((i for i in head if _is_row(table, i, used)), None)
    first = first_beside(table) if first is None else first
    if first is None and asked:
        raise DataError(Diagnostic("SF605", f"'{name}' has no rows of numbers", None, "one row per sample"))
    if first is None:
        return None
    if asked:
        return _asked_columns(table, first, words, interval, stem)
    return _of_table(table, first, stem, is_timed=timed is not data)


def read_all_records(name: str, data: bytes, stem: str, asked: str = "") -> list[TimeRecord]:
    """Return the records that a file contains, one below the other where its times begin again."""
    found: list[TimeRecord] = []
    rows = data
    while True:
        try:
            record = read_record(name, rows, stem, asked)
        except RestartError as error:
            lines = rows.splitlines(keepends=True)
            table = TextTable.of(name, _without_clock(rows))
            first = next(i for i in range(error.line) if _is_row(table, i))
            if (
                min(error.line - first, len(lines) - error.line) < FEWEST_SAMPLES
                or len(found) == MOST_RECORDS
            ):
                raise
            record = read_record(name, b"".join(lines[: error.line]), stem, asked)
            rows = b"".join((*lines[:first], *lines[error.line :]))
            found += [record] if record is not None else []
            continue
        found += [record] if record is not None else []
        break
    if len(found) > 1:
        said = f"the times begin again: {len(found)} records, one below the other"
        found = [replace(one, guesses=(*one.guesses, said)) for one in found]
    return found


def joined(records: Sequence[TimeRecord], kinds: Sequence[str]) -> TimeRecord:
    """Return one record of several with one channel each, an input ``u`` and outputs ``y``."""
    step = records[0].step_s
    for one in records:
        if abs(one.step_s - step) > JITTER * step:
            message = (
                f"'{one.name}' has a sample every {one.step_s:.6g} s, '{records[0].name}' every {step:.6g} s"
            )
            raise DataError(Diagnostic("SF604", message, None, "record the channels together"))
    names = [one.outputs[0][0] for one in records]
    names = names if len(set(names)) == len(names) else [one.name for one in records]
    size = min(one.outputs[0][1].size for one in records)
    channels = [(name, one.outputs[0][1][:size]) for name, one in zip(names, records, strict=True)]
    units = {name: one.units.get(one.outputs[0][0], "") for name, one in zip(names, records, strict=True)}
    said = [guess for one in records for guess in one.guesses]
    said.append("the channels are taken as sampled at the same times")
    if any(one.outputs[0][1].size > size for one in records):
        said.append(f"the first {size} samples of each are used")
    by_kind = list(zip(kinds, channels, strict=True))
    return TimeRecord(
        names[kinds.index("y")] if kinds.count("y") == 1 else "records",
        step,
        tuple(channel for kind, channel in by_kind if kind == "y"),
        next((channel for kind, channel in by_kind if kind == "u"), None),
        tuple(dict.fromkeys(said)),
        {name: unit for name, unit in units.items() if unit},
    )


def _width(table: TextTable, first: int, names: Sequence[str]) -> int:
    """Return how many columns there are: rows of oscilloscopes may have an empty one at the end."""
    cells = cut(table.lines[first], table.delimiter)
    return len(cells) if first_beside(table) is not None else max(len(cells), len(names))


def _asked_columns(
    table: TextTable, first: int, words: Sequence[str], interval: str, stem: str
) -> TimeRecord:
    """Return the record of the columns that ``--columns`` names, in the units of the header."""
    guesses = list(table.guesses)
    names, at, unit, _ = named_time(table, first)
    width = _width(table, first, names)
    unused = {*range(len(words), width), *(i for i, word in enumerate(words) if word in ("-", ""))}
    columns, lines = _numbers(table, first, width, guesses, unused)
    # A plain t has the unit of the header.
    columns = [x * float(unit) if (i, words[i:][:1]) == (at, ["t"]) else x for i, x in enumerate(columns)]
    cells = names or _names(table, first, width) or [*words, *["-"] * width]
    named = _in_si(cells, units_below(table, first, cells), columns, table.lines[:first])
    return _with_units(_asked(named.channels, words, interval, stem, guesses, (table, lines)), named)


def _of_table(table: TextTable, first: int, stem: str, *, is_timed: bool) -> TimeRecord | None:
    """Return the record of a text, ``None`` if it has no time; times of day may have no name."""
    guesses = list(table.guesses)
    names, at, unit, start = named_time(table, first)
    width = _width(table, first, names)
    unused = {i for i, name in enumerate(names[:at]) if not name}
    if not names and is_timed:  # nothing names the times of day: behind a date of zero, or first
        names, at = [f"column {i + 1}" for i in range(width)], int(table.lines[first].startswith("0"))
    step = None if names else _stated_step(table, first)
    if not names and step is None:
        return None
    if _are_responses([*names, *_names(table, first, width)]):
        return None
    cells = names or _names(table, first, width) or [f"channel {i + 1}" for i in range(width)]
    columns, lines = _numbers(table, first, width, guesses, unused)
    named = _in_si(cells, units_below(table, first, cells), columns, table.lines[:first])
    if names and np.isfinite(columns[at]).sum() == 1 and np.nansum(columns[at]) > 0:  # the sampling time
        names, step = [], float(np.nansum(columns[at])) * float(unit)
    lost: Mask | None = None
    if names:
        times = _seconds(columns[at] * float(unit), guesses) + float(start)
        # Counters and magnitudes of vectors, which are no longer such where they are made even.
        excluded = [at, *unused, *(i for i, x in enumerate(columns) if np.all(np.diff(x) == 1))]
        squares = np.sum([x**2 for i, x in enumerate(columns) if i not in excluded], axis=0)
        for i, x in enumerate(columns):
            if width - len(excluded) > 3 and np.allclose(2 * x**2, squares, 1e-6, 0):  # noqa: PLR2004 (x, y, z)
                excluded.append(i)
                guesses.append(f"'{cells[i][:30]}' is the magnitude of the others and is left out")
        channels = [c for i, c in enumerate(named.channels) if i not in excluded]
        step, lost = _even(times, table, lines, guesses)
        channels = [(c, x if lost is None else _resampled(times, x, step)) for c, x in channels]
    else:
        assert step is not None
        guesses.append(f"the samples are {step:.6g} s apart, as the file states")
        channels = named.channels
    option = "t,u,y" if names else f"u,y,dt={step:.6g}"
    record = _sorted(channels, step, stem, table.source.name, guesses, option)
    return _with_units(replace(record, is_missing=_missing(lost, record)), named)


def _without_clock(data: bytes) -> bytes:
    """Return a text with times of day, and dates before them, as seconds; days go on after midnight."""
    if len(_CLOCK.findall(data, 0, 20_000)) < BEGIN:
        return data
    last, days = 0.0, 0

    def seconds(match: re.Match[bytes]) -> bytes:
        nonlocal last, days
        now = 3600.0 * int(match[2]) + 60 * int(match[3]) + int(match[4])
        days += now < last - DAY / 2
        last = now
        date = b"0" + match[1] if (match[1] or b" ") not in b"T " else b""  # it has a column of its own
        return b"%s%d%s" % (date, now + DAY * days, match[5] or b"")

    return _CLOCK.sub(seconds, data)


def _seconds(times: Real, guesses: list[str]) -> Real:
    """Return times in seconds: large numbers count since 1970, and those of workbooks are days."""
    begin, end = float(times[0]), float(times[-1])
    unit = next((unit for unit, (low, high) in _EPOCHS.items() if low < begin < high), None)
    if unit is not None:
        guesses.append(f"times are read as multiples of {unit:g} s since 1970")
        return (times - begin) * unit
    if _DAYS[0] < begin < _DAYS[1] and end - begin < 1 and 0 < (end - begin) / times.size < 1 / DAY:
        guesses.append("times are read as days, as workbooks count them; --columns t_s,u,y for seconds")
        return (times - begin) * DAY
    if (step := (end - begin) / times.size) > LONG:
        guesses.append(f"samples are {step:.4g} s apart; --columns t_ms,u,y, or t_us, for another unit")
    return times


def _are_responses(names: Sequence[str]) -> bool:
    """Tell whether one of several names is that of a frequency or of a spectrum."""
    # A force may be called F, a velocity w: they are frequencies beside both parts of a response alone.
    meanings = [meaning_of(name) for name in names]
    kinds = {m.kind for m in meanings}
    are_pairs = {"real", "imaginary"} <= kinds or {"magnitude", "phase"} <= kinds
    frequencies = (
        name
        for name, m in zip(names, meanings, strict=True)
        if m.kind == "frequency" and (are_pairs or m.word not in _SIGNALS)
    )
    return any(not _SPEED.search(name) for name in frequencies) or any(map(_SPECTRUM.search, names))


def _may_be_record(data: bytes) -> bool:
    """Tell whether a text may be a record: its head says time, and no line below speaks of a frequency."""
    head = data[:20_000].decode("latin-1")
    if not (any(p.search(head) for p in (TIME, _RATE, _INTERVAL)) or _CLOCK.search(data, 0, len(head))):
        return False
    lower = data.lower()
    if not any(word in lower for word in (b"freq", b"fr\xe9q", b"fr\xc3\xa9q")):
        return True
    lines = data.decode("latin-1").splitlines()
    return not any(_FREQUENCY.search(_RATE.sub("", line)) for line in lines if not line.startswith(COMMENTS))


def _is_row(table: TextTable, index: int, used: Sequence[int] = ()) -> bool:
    """Tell whether a line has numbers in columns, or begins with one and has another, or nothing else."""
    cells = [number(c, table.decimal) for c in cut(table.lines[index], table.delimiter)]
    if used and not table.lines[index].lstrip().startswith(COMMENTS):
        return all(isinstance(cell, float) for i in used for cell in cells[i : i + 1] or [None])
    if table.is_row(index):
        return True
    return isinstance(cells[0], float) and sum(isinstance(c, float) for c in cells) > 1 if cells else False


def _names(table: TextTable, first: int, width: int) -> list[str]:
    """Return the names in the last line above the first row that has as many as columns, and no number."""
    for line in reversed(table.lines[:first]):
        cells = cut(line.strip().lstrip("#%!/; "), table.delimiter)
        if len(cells) == width and all(number(c, table.decimal) is None for c in cells):
            return cells
    return []


def _stated_step(table: TextTable, first: int) -> float | None:
    """Return the sampling time that a line above the first row states, perhaps as a rate [s]."""
    for line in table.lines[:first]:
        for pattern, units in ((_RATE, _HERTZ), (_INTERVAL, SECONDS)):
            match = pattern.search(line)
            written = match and _NUMBER_WITH_UNIT.search(line[match.end() :])
            if not written or (unit := written[2].lower()) not in {"", *units}:
                continue
            value = number(written[1], table.decimal)
            if isinstance(value, float) and 0 < value < np.inf:
                return value * float(SECONDS.get(unit, 1)) if units is SECONDS else 1 / (value * _HERTZ[unit])
    return None


@dataclass(frozen=True, slots=True, eq=False)
class _Named:
    """Channels by name, with values in SI where a file gives their units."""

    channels: list[tuple[str, Real]]
    units: Mapping[str, str]  # in SI, by channel
    said: Mapping[str, str]  # what is to be said of units, by channel
    ratio: str = ""  # the unit of the response, as a comment gives it


def _with_units(record: TimeRecord, named: _Named) -> TimeRecord:
    """Return a record with the units of its channels, or of the response if a comment gives that alone."""
    source = record.input[0] if record.input else ""
    names = [*([source] if source else []), *(name for name, _ in record.outputs)]
    guesses = [named.said[name] for name in names if name in named.said]
    units, outputs = {name: unit for name, unit in named.units.items() if name in names}, record.outputs
    known = in_si(named.ratio)
    if known and not any(name in units for name, _ in outputs):
        factor, ratio = known
        outputs = tuple((name, x * factor) for name, x in outputs)
        units |= {f"{name}/{source}" if source else name: ratio for name, _ in outputs}
        if factor != 1:
            guesses.append(f"values in {named.ratio[:20]} are read in {ratio}: times {factor:.6g}")
    return replace(record, outputs=outputs, units=units, guesses=(*record.guesses, *guesses))


def _in_si(
    cells: Sequence[str], below: Sequence[str], columns: Sequence[Real], head: Sequence[str] = ()
) -> _Named:
    """Return channels in SI by their names, the units in a row below, and comments above."""
    style = next((m[1] for cell in cells if (m := _OF_TIME.fullmatch(bare(cell)))), "")
    parts = [with_unit(cell, style) for cell in cells]
    if "out" in {unit.lower() for _, unit in parts}:  # ``(in)`` beside it is no inch
        parts = [
            (bare(c), "") if p[1].lower() in ("in", "out") else p for c, p in zip(cells, parts, strict=True)
        ]
    comments = (line.strip() for line in head if line.lstrip().startswith(COMMENTS))
    fields = [match for line in comments if (match := _SAID.fullmatch(line))]
    by_name = {(m["of"] or "").strip(" '\"[]()").lower(): m["unit"].strip() for m in fields}
    listed = re.split(r"[,;\t]\s*", by_name.get("", ""))
    rows = [row for row in (below, listed if len(listed) == len(cells) > 1 else ()) if row]
    channels: list[tuple[str, Real]] = []
    units: dict[str, str] = {}
    said: dict[str, str] = {}
    for i, (x, (name, own)) in enumerate(zip(columns, parts, strict=False)):
        unit = own or by_name.get(name.lower(), "") or next((row[i] for row in rows if row[i:]), "")
        are_units = in_si(name) is not None and [part[0] for part in parts].count(name) > 1
        unit, called = (unit or name, "") if are_units else (unit, name)
        called = called or f"channel {i + 1}"
        called = f"{called} {i + 1}" if called in dict(channels) else called
        known = in_si("m/s^2" if unit == "g" and _SHAKEN.match(called) else unit)
        factor = (known[0] * (STANDARD_GRAVITY if unit == "g" else 1.0)) if known else 1.0
        if unit.lower() in SECONDS or unit in ("", "-"):  # widths of pulses
            known, factor = None, 1.0
        elif known is None:
            said[called] = f"the unit '{unit[:20]}' of '{called[:30]}' is not known: values are as written"
        elif factor != 1:
            said[called] = f"'{called[:30]}' is in {unit[:20]}, and is read in {known[1]}: times {factor:.6g}"
        units |= {called: known[1]} if known else {}
        channels.append((called, x * factor))
    return _Named(channels, units, said, "" if rows and not below else by_name.get("", ""))


def _numbers(
    table: TextTable, first: int, width: int, guesses: list[str], unused: Set[int] = frozenset()
) -> tuple[list[Real], list[int]]:
    """Return the columns below the names, and the lines they stand in; unused ones may hold anything."""
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
        if np.isfinite(values).all():
            return list(values.T), lines
    except (ValueError, IndexError):
        pass  # some cell is no plain number
    rows = [cut(table.lines[i], table.delimiter) for i in lines]
    read = [[number(c, table.decimal) for c in row[:width]] + [None] * (width - len(row)) for row in rows]
    read = [[x.real if isinstance(x, complex) and not x.imag else x for x in row] for row in read]
    empty = np.array([[not (isinstance(x, float) and np.isfinite(x)) for x in row] for row in read])
    sparse = np.flatnonzero(2 * empty.sum(axis=0) > len(empty) * ~np.isin(range(width), [*unused])).tolist()
    wrong = np.asarray(np.delete(empty, sparse, axis=1).any(axis=1), bool)
    if not are_few(wrong):
        location = table.line(lines[int(np.argmax(wrong))])
        hint = "a time record has a number in every column; --columns t,-,u,y leaves columns out"
        raise DataError(Diagnostic("SF603", "a line contains something other than numbers", location, hint))
    if sparse_used := [i for i in sparse if i not in unused]:
        many = ", ".join(str(i + 1) for i in sparse_used[:12])
        guesses.append(f"columns in which most cells contain no number are left out: {many}")
    if sparse:
        read = [[x if isinstance(x, float) else np.nan for x in row] for row in read]
    if wrong.any():
        listed = ", ".join(str(lines[i] + 1) for i in np.flatnonzero(wrong)[:6].tolist())
        guesses.append(f"left out lines without a number: line {listed}")
    good = [row for row, is_wrong in zip(read, wrong.tolist(), strict=True) if not is_wrong]
    return list(np.array(good, float).T), [i for i, w in zip(lines, wrong.tolist(), strict=True) if not w]


def _too_short(samples: int) -> DataError:
    message = f"a record of {samples} samples; at least {FEWEST_SAMPLES} are needed"
    return DataError(Diagnostic("SF605", message))


def _even(
    times: Real, table: TextTable | None, lines: Sequence[int], guesses: list[str]
) -> tuple[float, Mask | None]:
    """Return the sampling time, and which even samples were lost; None if the samples are even."""
    steps = np.diff(times)
    if times.size < FEWEST_SAMPLES:
        raise _too_short(times.size)
    if not np.all(steps > 0):
        i = int(np.argmax(~(steps > 0))) + 1
        location = table.line(lines[i]) if table else None
        hint = "sort its lines, or leave out what was recorded before"
        if np.all(steps >= 0):
            hint = "several samples have one time: say how far they are apart, --columns -,u,y,dt=SECONDS"
        message = f"the time {times[i]:.9g} s follows {times[i - 1]:.9g} s"
        problem = Diagnostic("SF604", message, location, hint)
        # A record that goes on from a time of its middle is out of order.
        if table and times[i] < times[i - 1] and times[i] <= times[0] + abs(times[1] - times[0]):
            raise RestartError(problem, lines[i])
        raise DataError(problem)
    step = float(np.median(steps))
    even = times[0] + step * np.arange(times.size)
    mean = (times[-1] - times[0]) / (times.size - 1)
    if np.all(np.abs(steps - mean) <= JITTER * mean):
        return float(f"{mean:.9g}"), None
    gaps = steps > (1 + UNEVEN) * step
    # Where all others are even, the sampling time is that of the whole record.
    places = np.round((times - times[0]) / step)
    whole = float((times[-1] - times[0]) / places[-1])
    is_even = bool(np.all(np.abs(times - times[0] - places * whole) <= JITTER * whole))
    if gaps.any() and (gaps.mean() <= MOST_GAPS or (is_even and 2 * times.size > places[-1])):
        i = int(np.argmax(gaps))
        many = f" and {int(gaps.sum()) - 1} more" if gaps.sum() > 1 else ""
        guesses.append(f"samples are missing from {times[i]:.6g} to {times[i + 1]:.6g} s{many}: interpolated")
        if is_even:
            return whole, ~np.isin(np.arange(places[-1] + 1), places)
    elif np.max(np.abs(times - even)) > JITTER * step:
        spread = float(np.max(np.abs(steps / step - 1)))
        much = f"off by up to {spread:.0%} of a step" if spread < 1 else "steps differ"
        guesses.append(f"the times are not even ({much}), and samples are interpolated every {step:.4g} s")
    return step, np.zeros(round(float(times[-1] - times[0]) / step) + 1, bool)


def _missing(lost: Mask | None, record: TimeRecord) -> Mask | None:
    """Return which samples of a record were lost, None where none were."""
    if lost is None or not lost.any():
        return None
    return np.pad(lost, (record.outputs[0][1].size - lost.size, 0))  # a step has one before them


def _resampled(times: Real, values: Real, step: float) -> Real:
    """Return samples at even times, on the lines between those there are; few levels are held."""
    even = times[0] + step * np.arange(round(float(times[-1] - times[0]) / step) + 1)
    if np.unique(values).size < LEVELS:
        return np.asarray(values[np.searchsorted(times, even + step / 4, "right") - 1], np.float64)
    return np.asarray(np.interp(even, times, values), np.float64)


def _asked(
    channels: Sequence[tuple[str, Real]], words: Sequence[str], interval: str, stem: str, guesses: list[str],
    location: tuple[TextTable | None, Sequence[int]] = (None, ()),
) -> TimeRecord:  # fmt: skip
    words = [word.lower() for word in words]
    if len(words) > len(channels):
        message = f"--columns has {len(words)} words, and there are {len(channels)} columns"
        raise refused(message, "such as t,u,y or t_ms,-,u,y")
    at = next((i for i, word in enumerate(words) if word.partition("_")[0] in ("t", "time")), None)
    step, times = number(interval[3:]), np.empty(0)
    lost: Mask | None = None
    if not interval and at is not None:
        times = channels[at][1] * float(SECONDS.get(words[at].partition("_")[2], 1))
        times = _seconds(times, guesses) if words[at] == "t" else times
        step, lost = _even(times, *location, guesses)
    if not (isinstance(step, float) and 0 < step < np.inf):
        raise refused(
            f"--columns: '{interval[:40]}' is not a sampling time in seconds", "such as u,y,dt=0.01"
        )
    made: dict[str, list[tuple[str, Real]]] = {"u": [], "y": []}
    for i, word in enumerate(words):
        if word in ("-", "") or i == at:
            continue
        if word.rstrip("0123456789") not in made:
            message = f"--columns: unknown column '{word[:40]}' of a time record"
            raise refused(message, "t (or t_ms, t_us), u, y, -, dt=0.01")
        values = channels[i][1] if lost is None else _resampled(times, channels[i][1], step)
        if values.size < FEWEST_SAMPLES or not np.isfinite(values).all():
            message = f"column {i + 1} has not {FEWEST_SAMPLES} finite numbers, or contains something else"
            raise DataError(Diagnostic("SF603", message, None, "choose another column, or leave lines out"))
        made[word.rstrip("0123456789")].append((channels[i][0], values))
    if len(made["u"]) > 1 or not made["y"]:
        message = "--columns of a time record has one t, at most one u, and one y or more"
        raise refused(message, "such as t,u,y or u,y,dt=0.01")
    source, outputs = next(iter(made["u"]), None), made["y"]
    if source and np.ptp(source[1]) == 0 and source[1][0]:
        source, *outputs = _from_zero([source, *outputs], source[0], guesses)
    record = TimeRecord(stem, step, tuple(outputs), source, tuple(guesses))
    return replace(record, is_missing=_missing(lost, record))


def _asked_arrays(arrays: Arrays, words: Sequence[str], interval: str, name: str, stem: str) -> TimeRecord:
    """Return the record of the arrays that ``--columns`` names, or of the columns of the largest matrix."""
    keys = [key for _, is_named, key in (word.partition("=") for word in words) if is_named]
    array_name, matrix = largest_matrix(arrays)
    arrays = {**arrays, **_apart(arrays)}
    chosen = [arrays[k].ravel() for k in keys if k in arrays and arrays[k].dtype.kind in "fiu"]
    chosen = chosen if keys else list(matrix.T)
    if len(chosen) < len(words) or len({x.size for x in chosen}) != 1:
        message = f"'{name}': --columns {','.join(words)[:60]}: there are no such arrays of one length"
        raise refused(message, f"it has {listed_names(list(arrays))}")
    channels = [(c, np.asarray(x, np.float64)) for c, x in zip(keys or words, chosen, strict=False)]
    words, guesses = (
        [word.partition("=")[0] for word in words],
        [f"the columns are those of '{array_name[:30]}'"],
    )
    return _asked(channels, words, interval, stem, [] if keys else guesses)


def _apart(arrays: Arrays) -> Arrays:
    """Return arrays with each channel of a matrix under its name and a number, ``acc 2``."""
    apart: dict[str, npt.NDArray[Any]] = {}
    for key, array in arrays.items():
        if array.ndim != 2 or not 1 < min(array.shape) <= MOST_CHANNELS:  # noqa: PLR2004 (a matrix)
            apart[key] = array
            continue
        called, unit = with_unit(key, "")
        rows = array if array.shape[0] < array.shape[1] else array.T
        apart |= {f"{called} {i}" + f" [{unit}]" * bool(unit): row for i, row in enumerate(rows, 1)}
    return apart


def _of_arrays(arrays: Arrays, name: str, stem: str) -> TimeRecord | None:
    """Return the record of arrays: a time or a sampling time, and channels of one length."""
    plain = {k.rpartition(".")[2]: np.asarray(a) for k, a in arrays.items() if a.dtype.kind in "fiu"}
    if any(a.dtype.kind == "c" for a in arrays.values()):
        return None
    if (only := matrix_of(arrays)) is not None:
        return _of_matrix(*only, stem)
    plain = dict(_apart(plain))
    long = {k: np.asarray(a.ravel(), np.float64) for k, a in plain.items() if a.size >= FEWEST_SAMPLES}
    if not long:
        return None
    guesses, key = list[str](), ""
    lost: Mask | None = None
    timed = next(((k, m) for k in long if (m := TIME.fullmatch(k))), None)
    if timed is not None:
        key, match = timed
        times = long[key] * float(SECONDS[(match["unit"] or match["alone"] or "s").lower()])
        step, lost = _even(times, None, (), guesses)
        others = [(k, x) for k, x in long.items() if x.size == times.size and k != key]
        channels = [(k, x if lost is None else _resampled(times, x, step)) for k, x in others]
    else:
        single = {k: float(a.ravel()[0]) for k, a in plain.items() if a.size == 1 and np.isfinite(a).all()}
        rate = next((v for k, v in single.items() if _RATE.fullmatch(k) and v > 0), np.inf)
        step = next((v for k, v in single.items() if _INTERVAL.fullmatch(k) and v > 0), 1 / rate)
        if not step:
            return None
        size = Counter(x.size for x in long.values()).most_common(1)[0][0]
        channels = [(k, x) for k, x in long.items() if x.size == size]
    if not channels or _are_responses([k for k, _ in channels]):
        return None
    named = _in_si([*(k for k, _ in channels), key], (), [x for _, x in channels])
    option = f"u=NAME,y=NAME,dt={step:.6g}"
    record = _sorted(named.channels, step, stem, name, guesses, option)
    return _with_units(replace(record, is_missing=_missing(lost, record)), named)


def _of_matrix(key: str, matrix: npt.NDArray[Any], stem: str) -> TimeRecord | None:
    """Return the record of a matrix without names if its first column can only be a time."""
    columns = [np.asarray(x, np.float64) for x in matrix.T]
    if len(columns[0]) < FEWEST_SAMPLES or not is_time(columns):
        return None
    said = (
        f"the first column of '{key[:30]}' goes up evenly from 0, beside no response: it is taken as the time"
    )
    names = ["t", "u", *("y" if len(columns) == 3 else f"y{i}" for i in range(1, len(columns) - 1))]  # noqa: PLR2004
    guesses = [f"{said} in seconds, the second as the input; --columns f,re,im says otherwise"]
    return _asked(list(zip(names, columns, strict=True)), names, "", stem, guesses)


def _sorted(
    channels: list[tuple[str, Real]], step: float, stem: str, name: str, guesses: list[str], option: str
) -> TimeRecord:
    channels = [(c, x) for c, x in channels if 2 * np.isnan(x).sum() <= x.size and np.any(np.diff(x) != 1)]
    channels = [(c, x) for c, x in channels if not (_CLOCK_NAME.search(c) and np.all(np.diff(x) >= 0))]
    channels = [
        c for i, c in enumerate(channels) if not any(np.array_equal(c[1], x) for _, x in channels[:i])
    ]
    for channel, values in channels:
        if not np.isfinite(values).all():
            sample = int(np.argmin(np.isfinite(values))) + 1
            message = f"'{name}': sample {sample} of '{channel[:40]}' is not a finite number"
            raise DataError(Diagnostic("SF603", message, None, "leave the line out"))
    steady = [c for c, x in channels if _INPUT.fullmatch(c) and np.ptp(x) == 0 and x[0]]
    constant = steady[0] if steady and len(channels) > len(steady) else None
    channels = _from_zero(channels, constant, guesses) if constant else channels
    dead = [channel for channel, values in channels if np.ptp(values) == 0]
    channels = [(c, x) for c, x in channels if c not in dead]
    markers = [channel for channel, _ in channels if _MARKER.fullmatch(channel)]
    if markers and len(channels) > len(markers) + 1:
        channels = [(c, x) for c, x in channels if c not in markers]
        guesses.append(f"'{markers[0][:30]}' marks times and is left out; --columns {option} says otherwise")
    if dead:
        guesses.append(f"'{dead[0][:30]}' never changes and is left out")
    if not channels:
        raise DataError(Diagnostic("SF602", f"'{name}' has a time and no channel of numbers that changes"))
    for channel, values in channels:
        if cut_off := _cut_off(values):
            guesses.append(f"'{channel[:30]}' stays at {cut_off:.4g} for several samples: is it saturated?")
    named = [c for c, _ in channels if _INPUT.fullmatch(c)]
    named = sorted(named, key=lambda c: not _COMMAND.match(c))  # beside one, a torque is measured
    [(alike, many)] = Counter(_ALIKE.sub("", c).lower() for c, _ in channels).most_common(1)
    if named:
        source = named[0]
    elif len(channels) == 1 or (many > 1 and alike not in _OF_AN_INSTRUMENT):
        if channels[1:]:
            guesses.append(f"no channel is an input; --columns {option} says otherwise")
        return TimeRecord(stem, step, tuple(channels), None, tuple(guesses))
    else:
        source = channels[0][0]
        said = f"'{source[:30]}', the first channel, is taken as the input"
        guesses.append(f"{said}; --columns {option} says otherwise")
    excitation = next((c, x) for c, x in channels if c == source)
    others = [c for c in named[1:] if len(channels) > len(named) and c[0].lower() == source[0].lower()]
    mates = {c[1:].lower() for c in others if not c[-1].isdigit()}  # yVal belongs to uVal, and y2 to u1 too
    others += [c for c, _ in channels if c[1:].lower() in mates and c not in others]
    again = [c for c, x in channels if abs(np.corrcoef(x, excitation[1])[0, 1]) > SAME and c != source]
    for dropped, why in (
        (others, "another input, or its output,"),
        (again, f"a multiple of '{source[:30]}'"),
    ):
        if dropped and len(channels) > len(dropped) + 1:
            guesses.append(f"'{dropped[0][:30]}' is {why} and is left out")
            channels = [(c, x) for c, x in channels if c not in dropped]
    outputs = tuple((c, x) for c, x in channels if c != source)
    return TimeRecord(stem, step, outputs or (excitation,), excitation if outputs else None, tuple(guesses))


def _from_zero(
    channels: Sequence[tuple[str, Real]], constant: str, guesses: list[str]
) -> list[tuple[str, Real]]:
    """Return channels with a sample in front, at which an input that never changes is zero."""
    guesses.append(f"'{constant[:30]}' is constant: a step from 0 at the first sample")
    return [(c, np.append(0.0 if c == constant else x[0], x)) for c, x in channels]


def _cut_off(values: Real) -> float | None:
    """Return the end of its range at which a channel that varies stays several times, None if it does not."""
    if np.unique(values[:2000]).size < LEVELS:
        return None
    for end in (values.max(), values.min()):
        at_end = np.flatnonzero(values == end)
        runs = np.split(at_end, np.flatnonzero(np.diff(at_end) != 1) + 1)
        if end != 0 and len(runs) > 1 and max(map(len, runs)) >= SATURATED:
            return float(end)
    return None
