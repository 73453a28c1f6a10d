"""A measured or planned input over time, as instruments and programs save it.

    time_s,force              Time (ms);CH1 (V)        0      0
    0,0                       0,0;0,00                 0.001  0.12
    0.001,0.12                1,0;0,12

A line above the numbers names the time, in the unit that its name or the line below says, and the value is
the column beside it; without such a line, the first column is the time in seconds. Arrays are called t or
time, and as they like. What else a file contains is not read, and said.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from itertools import pairwise
from operator import eq, le, lt
from pathlib import Path
from typing import Final

import numpy as np

from symflex.data.measurement.arrays import Arrays, arrays_in, format_of, matrix_of
from symflex.data.measurement.column_names import SECONDS
from symflex.data.measurement.heading import units_below, with_unit
from symflex.data.measurement.measured_response import (
    MAX_BYTES,
    MAX_ERRORS,
    MAX_LINES,
    in_si,
    listed_names,
)
from symflex.data.measurement.text_table import SIGNS, TextTable, cut
from symflex.errors import DataError, Diagnostic
from symflex.model.spec.read import read_file

ARRAYS: Final = (".npz", ".npy", ".mat", ".h5", ".hdf5", ".tdms", ".json")
ENDINGS: Final = (".csv", ".txt", ".dat", ".tsv", ".asc", ".lvm", *ARRAYS)  # of files that hold inputs
_UNIT, _LONGER = ("|".join(w for w in SECONDS if (SECONDS[w] > 1) == longer) for longer in (False, True))
TIME = re.compile(
    r"(?:(?:elapsed|relative|rel|sim|simulation)[ _.]*)?"
    r"(?:t|tout|(?:date|datum)[ _/]*(?:time|zeit|uhrzeit)|uhrzeit|times?|time[ _]?stamp|zeit|temps|"
    r"tiempo|tempo|tid|tijd|\u0432\u0440\u0435\u043c\u044f|\u65f6\u95f4)(?:[ _.](?:now|rel|abs|corr\w*))?"
    rf"(?:[ _/,]*(?:in\b)? *[\[(]?(?P<unit>{_UNIT}|(?:(?<=[\[(/ ])|(?<=me_))(?:{_LONGER}))[\])]?)?|x_value|"
    rf"(?:in )?(?P<alone>(?!s$){_UNIT}|(?<=in )s)",
    re.I,
)
_AXIS = re.compile(r"x|x[- _]?axis", re.I)  # names of a column that the unit below shows to be the time
_COUNTED = re.compile(r"^(X,.*),Start,Increment,*\nSequence,(.*?),([^,\n]+),([^,\n]+),*$", re.M)
"""Above rows that are numbered, and begin at a time, with a distance (oscilloscopes)."""
BESIDE: Final = 3  # column of the time if those before it hold what is known of a record (oscilloscopes)
_ABOUT: Final = ("Horizontal Units", "Source", "Vertical Units")  # what is known of time and channel there
COMMENTS: Final = ("#", "%", "!", "//")
HINT: Final = "two columns: time_s, and the value"
LARGEST_EXPONENT: Final = 400  # of a decimal: far beyond what doubles hold
MOST_DIGITS: Final = 10**15  # denominator of a time beyond which its last digits are those of a binary number
EVEN: Final = 1e-6  # share of their distance by which times of an array may be off even ones


@dataclass(frozen=True)
class InputSignal:
    """Samples of an input, exact as written."""

    times: tuple[Fraction, ...]  # increasing [s]; twice where the input jumps
    values: tuple[Fraction, ...]  # as many
    guesses: tuple[str, ...] = ()  # what the file does not say, or holds besides
    unit: str = ""  # of the values, in SI, where the file gives it


def read_signal(path: str | Path) -> InputSignal:
    """Read an input signal; SF601 to SF605, SF607 say what is wrong with it, with line and column."""
    name = os.fspath(path)
    data = read_file(name, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise DataError(Diagnostic("SF607", f"'{name}' is larger than {MAX_BYTES} bytes"))
    suffix = format_of(name, data)
    signal = _of_arrays(name, arrays_in(name, data, suffix)) if suffix in ARRAYS else _signal(name, data)
    jumps = [f"{float(a):g} s" for a, b in pairwise(signal.times) if a == b]
    said = f"the input jumps where two samples have one time: {listed_names(jumps)}"
    return replace(signal, guesses=(*signal.guesses, said)) if jumps else signal


def _signal(name: str, data: bytes) -> InputSignal:
    table = TextTable.of(name, data)
    written = [
        i for i, line in enumerate(table.lines) if line.strip() and not line.strip().startswith(COMMENTS)
    ]
    first = next((i for i in written if table.is_row(i, 2)), None)
    first = first_beside(table) if first is None else first
    if first is None:
        raise DataError(Diagnostic("SF605", f"'{name}' contains no rows of numbers", None, HINT))
    lines = [i for i in written if i >= first]
    if len(lines) > MAX_LINES:
        raise DataError(Diagnostic("SF607", f"'{name}' has more than {MAX_LINES} lines"))
    names, at, unit, start = named_time(table, first)
    if not names and written[0] < first:
        above = table.line(written[written.index(first) - 1])
        raise DataError(Diagnostic("SF602", "the first column is not the time", above, HINT))
    width = max(len(table.cells(first)), len(names))
    others = [f"'{word[:30]}'" for i, word in enumerate(names) if word and not at <= i <= at + 1]
    last = 0 if names else len(cut(table.lines[first], table.delimiter))
    others = others or [f"column {i + 1}" for i in range(at + 2, last)]
    guesses = list(table.guesses) + ([f"not used: {', '.join(others[:6])}"] if others else [])
    times: list[Fraction] = []
    values: list[Fraction] = []
    problems: list[Diagnostic] = []
    for index in lines:
        if len(problems) >= MAX_ERRORS:
            break
        cells, line = table.cells(index), table.line(index)
        if len(cells) < at + 2:
            problems.append(Diagnostic("SF602", "a line has a time and no value", line, HINT))
            continue
        if len(cells) > width and any(cell.text for cell in cells[width:]):
            said = f"a line has {len(cells)} columns, and the first has {width}"
            problems.append(Diagnostic("SF602", said, line, "a decimal comma, or a line that was cut off?"))
            continue
        numbers = [_decimal(cell.text, table.decimal) for cell in cells[at : at + 2]]
        for cell, number in zip(cells[at:], numbers, strict=False):
            if number is None:
                said = f"'{cell.text[:40]}' is not a finite number" if cell.text else "a number is missing"
                problems.append(Diagnostic("SF603", said, cell if cell.text else line))
        if numbers[0] is None or numbers[1] is None:
            continue
        time = start + numbers[0] * unit
        if times and (time < times[-1] or times[-2:] == [time, time]):
            problems.append(Diagnostic("SF604", "times do not increase", cells[at]))
        times.append(time)
        values.append(numbers[1])
    if problems:
        raise DataError(*problems)
    if len(times) < 2:  # noqa: PLR2004 (a line has two ends)
        raise DataError(Diagnostic("SF605", f"'{name}' contains fewer than two samples", None, HINT))
    if max(time.denominator for time in times) > MOST_DIGITS:  # binary numbers written to the end
        times = _decimal_times(times)
    return _in_si(InputSignal(tuple(times), tuple(values), tuple(guesses)), table, first, names, at + 1)


def _in_si(signal: InputSignal, table: TextTable, first: int, names: Sequence[str], at: int) -> InputSignal:
    """Return a signal in SI, if the heading of its column or a row below gives a unit."""
    if not names[at:]:
        return signal
    below = units_below(table, first, names)
    called, unit = with_unit(names[at], "")
    unit = unit or (below[at] if below[at:] else "")
    known = in_si(unit)
    if known is None or unit.lower() in SECONDS:
        said = [f"the unit '{unit[:20]}' is not known: values are as written"] if unit.strip("- ") else []
        return replace(signal, guesses=(*signal.guesses, *said))
    factor = Fraction(f"{known[0]:.15g}")
    converted = f"'{called[:30]}' is in {unit[:20]}, and is read in {known[1]}: times {known[0]:.6g}"
    said = [converted] if factor != 1 else []
    values = tuple(value * factor for value in signal.values)
    return replace(signal, values=values, unit=known[1], guesses=(*signal.guesses, *said))


def first_beside(table: TextTable) -> int | None:
    """Return the first line if in all of them the samples are behind what is known of the record."""
    written = [i for i, line in enumerate(table.lines) if line.strip()]
    rows = (cut(table.lines[i], table.delimiter) for i in written)
    are_beside = (
        len(cells) >= BESIDE + 2  # the time and a value
        and _decimal(cells[0]) is None
        and None not in map(_decimal, cells[BESIDE:])
        for cells in rows
    )
    return written[0] if written and all(are_beside) else None


def _names_beside(table: TextTable) -> list[str]:
    """Return the names of the columns of such a table, with the units that it states."""
    rows = (cut(line, table.delimiter) for line in table.lines if line.strip())
    about = {cells[0]: cells[1] for cells in rows if cells[0]}
    horizontal, source, vertical = (about.get(key, "").strip() for key in _ABOUT)
    return [
        *[""] * BESIDE,
        f"TIME [{horizontal or 's'}]",
        (source or "CH1") + f" [{vertical}]" * bool(vertical),
    ]


def named_time(table: TextTable, first: int) -> tuple[list[str], int, Fraction, Fraction]:
    """Return the names of columns above the first row, which is the time, its unit and what to add [s]."""
    if counted := _COUNTED.search(table.source.text):
        start, step = (_decimal(text) for text in counted.groups()[2:])
        if start is not None and step:
            units = [*counted[2].split(","), *[""] * len(counted[1])]
            pairs = zip(counted[1].split(",")[1:], units, strict=False)
            return ["X", *(f"{name} [{unit}]" * bool(name) for name, unit in pairs)], 0, step, start
    if first_beside(table) == first:
        names = _names_beside(table)
        return names, BESIDE, SECONDS.get(names[BESIDE][6:-1].lower(), Fraction(1)), Fraction(0)
    below: list[str] = []
    for line, above in pairwise([*reversed(table.lines[:first]), ""]):
        text = line.strip().lstrip(SIGNS) if line.strip().startswith(COMMENTS) else line
        ways = cut(text, table.delimiter), re.split(r"\s*[,;\t]\s*|\s{2,}|(?<=[\])])\s+", text.strip())
        for names in ways if table.delimiter != " " else ways[::-1]:  # a blank may stand before a unit
            units = [SECONDS.get(word.strip("[]() ").lower()) for word in below] + [None] * len(names)
            for i, name in enumerate(names if names[1:] else ()):
                match = TIME.fullmatch(name.strip("\"' _"))
                over = cut(above.strip().lstrip(SIGNS), table.delimiter)
                are_units = all(in_si(word) for word in names if word is not name)
                is_above = bool(len(over) == len(names) and over[i]) and are_units
                named = over[i : i + 1]
                if match and match["alone"] and is_above and not TIME.fullmatch(over[i]):
                    return over, i, SECONDS[match["alone"].lower()], Fraction(0)  # Second,Volt,Volt
                if match and match["alone"] and (name is names[-1] or (named and TIME.fullmatch(named[0]))):
                    continue  # a row of units: the names are above
                if match or (units[i] and _AXIS.fullmatch(name.strip())):
                    said = (match and (match["unit"] or match["alone"])) or (*names, "")[i + 1].strip("[]()")
                    return names, i, SECONDS.get(said.lower(), units[i] or Fraction(1)), Fraction(0)
        below = cut(text, table.delimiter) if text.strip() else below
    return [], 0, Fraction(1), Fraction(0)


def _of_arrays(name: str, arrays: Arrays) -> InputSignal:
    """Return the input of arrays: a matrix of two columns, or the time and the only other one as long."""
    guesses: list[str] = []
    matrix = matrix_of(arrays)
    if matrix is not None:
        times, values = matrix[1][:, 0], matrix[1][:, 1]
        if matrix[1][:, 2:].size:
            guesses.append(f"of '{matrix[0]}' only the first two columns are used")
        guesses.append(f"the first column of '{matrix[0]}' is the time in seconds")
        factor = Fraction(1)
    else:
        plain = {k: a for k, a in arrays.items() if a.dtype.kind in "fiu" and a.size > 1}
        key, match = next(((k, m) for k in plain if (m := TIME.fullmatch(k.rpartition(".")[2]))), ("", None))
        fitting = [k for k, a in plain.items() if k != key and key and a.size == plain[key].size]
        if match is None or len(fitting) != 1:
            message = f"'{name}': an input is one array called t or time, and one other as long"
            held = f"it has {listed_names(list(arrays)) or 'none'}"
            raise DataError(Diagnostic("SF602", message, None, held))
        times, values = plain[key], plain[fitting[0]]
        factor = SECONDS[(match["unit"] or match["alone"] or "s").lower()]
    exact = []
    for array, what in ((times, "time"), (values, "value")):
        numbers = np.asarray(array.real.ravel(), np.float64)
        if not np.isfinite(numbers).all():
            sample = int(np.argmin(np.isfinite(numbers))) + 1
            raise DataError(Diagnostic("SF603", f"'{name}': {what} {sample} is not a finite number"))
        exact.append([Fraction(number) for number in numbers.tolist()])
    a, b = exact[0], exact[0][1:]
    if not (all(map(le, a, b)) and all(map(lt, a, b[1:]))):  # two at one time are a jump
        raise DataError(Diagnostic("SF604", f"'{name}': times do not increase"))
    seconds = (time * factor for time in _decimal_times(exact[0]))
    return InputSignal(tuple(seconds), tuple(exact[1]), tuple(guesses))


def _decimal_times(times: list[Fraction]) -> list[Fraction]:
    """Return the times that binary numbers mean: multiples of one decimal, or ten digits of each."""
    if max(abs(times[0]), abs(times[-1])) > MOST_DIGITS:
        return times
    numbers = np.array([float(time) for time in times])
    step = float(f"{(numbers[-1] - numbers[0]) / (numbers.size - 1):.10g}") or 1.0
    places = np.round(numbers / step)
    decimal = [Fraction(f"{number:.10g}") for number in numbers.tolist()]
    if np.all(np.abs(numbers - places * step) <= EVEN * step):
        decimal = [Fraction(str(step)) * int(index) for index in places.tolist()]
    return decimal if all(map(eq, *(map(lt, x, x[1:]) for x in (decimal, times)))) else times


def _decimal(text: str, decimal: str = ".") -> Fraction | None:
    """Return the number a decimal means; None for any other text, and for what no double could hold."""
    text = text.strip("\"' ")
    text = text.replace(",", ".") if decimal == "," and "." not in text else text
    try:
        number = Decimal(text) if "_" not in text else None
    except InvalidOperation:
        return None
    if number is None or not number.is_finite() or abs(number.adjusted()) > LARGEST_EXPONENT:
        return None
    return Fraction(number)
