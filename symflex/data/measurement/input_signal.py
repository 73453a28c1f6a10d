"""A measured or planned input over time, as text in two columns.

    time_s,force              0      0
    0,0                       0.001  0.12
    0.001,0.12

The first column is the time in seconds, or in the unit its header names (``time_ms``, ``t [us]``), the second
the value; further columns are not read. A header may be left out.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from symflex.data.measurement.measured_response import MAX_ERRORS, MAX_LINES
from symflex.data.measurement.text_table import TextTable
from symflex.errors import DataError, Diagnostic, Span
from symflex.model.spec.read import read_file

if TYPE_CHECKING:
    from pathlib import Path

MAX_BYTES: Final = 50_000_000
SECONDS: Final = {"": Fraction(1), "s": Fraction(1), "ms": Fraction(1, 10**3), "us": Fraction(1, 10**6)}
_TIME = re.compile(r"(?:t|time)(?:[ _]*[\[(]?(?P<unit>s|ms|us|µs)[\])]?)?", re.I)
COMMENTS: Final = ("#", "%", "!", "//")
HINT: Final = "two columns: time_s, and the value"
LARGEST_EXPONENT: Final = 400
"""Of a decimal: far beyond what doubles hold."""


@dataclass(frozen=True)
class InputSignal:
    """Samples of an input, exact as written."""

    times: tuple[Fraction, ...]  # increasing [s]
    values: tuple[Fraction, ...]  # as many


def read_signal(path: str | Path) -> InputSignal:
    """Read an input signal.

    Raises
    ------
    UsageError
        SF901 when there is no such regular file.
    DataError
        SF601, SF602, SF603, SF604, SF605, SF607: what is wrong with it, with line and column.
    """
    name = os.fspath(path)
    data = read_file(name, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise DataError(Diagnostic("SF607", f"'{name}' is larger than {MAX_BYTES} bytes"))
    return _signal(TextTable.of(name, data))


def _signal(table: TextTable) -> InputSignal:
    name = table.source.name
    lines = [
        i for i, line in enumerate(table.lines) if line.strip() and not line.strip().startswith(COMMENTS)
    ]
    if len(lines) > MAX_LINES + 1:
        raise DataError(Diagnostic("SF607", f"'{name}' has more than {MAX_LINES} lines"))
    unit, width = Fraction(1), len(table.cells(lines[0])) if lines else 0
    if lines and _decimal(table.cells(lines[0])[0].text) is None:
        unit = _unit_of(table.cells(lines[0]), table.line(lines[0]))
        lines = lines[1:]
    times: list[Fraction] = []
    values: list[Fraction] = []
    problems: list[Diagnostic] = []
    for index in lines:
        if len(problems) >= MAX_ERRORS:
            break
        cells, line = table.cells(index), table.line(index)
        if len(cells) < 2:  # noqa: PLR2004 (time and value)
            problems.append(Diagnostic("SF602", "a line has a time and no value", line, HINT))
            continue
        if len(cells) > width:
            said = f"a line has {len(cells)} columns, and the first has {width}"
            problems.append(Diagnostic("SF602", said, line, "a decimal comma, or a line that was cut off?"))
            continue
        numbers = [_decimal(cell.text) for cell in cells[:2]]
        for cell, number in zip(cells, numbers, strict=False):
            if number is None:
                said = f"'{cell.text[:40]}' is not a finite number" if cell.text else "a number is missing"
                problems.append(Diagnostic("SF603", said, cell if cell.text else line))
        if numbers[0] is None or numbers[1] is None:
            continue
        time = numbers[0] * unit
        if times and time <= times[-1]:
            problems.append(Diagnostic("SF604", "times do not increase", cells[0]))
        times.append(time)
        values.append(numbers[1])
    if problems:
        raise DataError(*problems)
    if len(times) < 2:  # noqa: PLR2004 (a line has two ends)
        raise DataError(Diagnostic("SF605", f"'{name}' holds fewer than two samples", None, HINT))
    return InputSignal(tuple(times), tuple(values))


def _unit_of(cells: list[Span], line: Span) -> Fraction:
    match = _TIME.fullmatch(cells[0].text.strip("\"' "))
    if match is None or len(cells) < 2:  # noqa: PLR2004
        raise DataError(Diagnostic("SF602", "the first column is not the time", line, HINT))
    return SECONDS[(match["unit"] or "").lower().replace("µ", "u")]


def _decimal(text: str) -> Fraction | None:
    """Return the number a decimal means; None for any other text, and for what no double could hold."""
    try:
        number = Decimal(text) if "_" not in text else None
    except InvalidOperation:
        return None
    if number is None or not number.is_finite() or abs(number.adjusted()) > LARGEST_EXPONENT:
        return None
    return Fraction(number)
