r"""Frequency responses as text in columns.

A header line names the columns; comment lines begin with ``#``, ``%`` or ``!``, and such a line may hold
what the columns cannot: ``# tf: A_tip/V_cmd``, ``# averages: 40``, ``# window: hann``, ``# unit:
m/(V*s^2)``, ``# synthetic: yes``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from symflex.data.measurement.measured_response import (
    MAX_ERRORS,
    MAX_LINES,
    MeasuredResponse,
    averages_of,
    checked_response,
    unit_of,
    window_of,
)
from symflex.errors import DataError, Diagnostic, Source, Span, nearest

COMMENTS: Final = ("#", "%", "!", "//")
_CELL = re.compile(r"[^,;\t ]+(?: +[^,;\t ]+)*")
_COMMENT_FIELD = re.compile(r"\W*\s*(?P<key>tf|averages|window|unit|synthetic)\s*[:=]\s*(?P<value>.*)", re.I)
_UNIT = re.compile(
    r"\s*[\[(](?P<bracket>[^\])]*)[\])]\s*$|[_ ](?P<suffix>hz|khz|rad/s|rad_s|db|deg|rad)$", re.I
)
_NAMES: Final = {
    "frequency": ("frequency", "freq", "f", "frequencies"),
    "omega": ("omega", "w", "angular frequency"),
    "real": ("re", "real", "real part", "re(h)", "h_re", "real(h)"),
    "imaginary": ("im", "imag", "imaginary", "imaginary part", "im(h)", "h_im", "imag(h)"),
    "magnitude": ("magnitude", "mag", "gain", "amplitude", "abs", "level", "|h|"),
    "decibel": ("db",),
    "phase": ("phase", "angle", "arg", "phi"),
    "coherence": ("coherence", "coh", "gamma2", "gamma^2"),
}
_KINDS: Final = {name: kind for kind, names in _NAMES.items() for name in names}
_UNITS: Final[dict[str, dict[str, float]]] = {
    "frequency": {"": 1.0, "hz": 1.0, "khz": 1000.0, "rad/s": 1 / (2 * np.pi), "rad_s": 1 / (2 * np.pi)},
    "phase": {"deg": np.pi / 180, "degrees": np.pi / 180, "°": np.pi / 180, "rad": 1.0, "radians": 1.0},
}
_HEADER_HINT: Final = (
    "columns: frequency_hz; re, im or magnitude_db, phase_deg or magnitude, phase_rad; coherence if known"
)


@dataclass(frozen=True, slots=True)
class DataColumn:
    """One column: what it is, the factor to its SI unit, and whether it is in decibels."""

    kind: str
    index: int
    factor: float = 1.0
    is_decibel: bool = False


def read_columns(name: str, data: bytes, stem: str) -> tuple[MeasuredResponse, ...]:
    """Read one response from text in columns; it is called ``stem`` when the file gives no name.

    SF601 no text; SF602 columns missing, unknown or in an unknown unit; SF603, SF604, SF605, SF607 values.
    """
    text = decoded_text(name, data)
    source = Source(name, text)
    lines = data_lines(source)
    fields = _comment_fields(source)
    if not lines:
        raise DataError(Diagnostic("SF605", f"'{name}' holds no data", None, _HEADER_HINT))
    if len(lines) > MAX_LINES + 1:
        raise DataError(Diagnostic("SF607", f"'{name}' has more than {MAX_LINES} lines"))
    split = cell_splitter(text[lines[0][0] : lines[0][1]])
    columns = _columns(source, split, *lines[0])
    table = _numbers(source, split, lines[1:], columns)
    unit_span = fields.get("averages")
    averages = None if unit_span is None else averages_of(unit_span.text, name, unit_span)
    by_kind = {column.kind: i for i, column in enumerate(columns)}

    def span_of(index: int, kind: str) -> Span | None:
        wanted = {"value": "real" if "real" in by_kind else "magnitude"}.get(kind, kind)
        cells = split(source, *lines[1 + index])
        return cells[columns[by_kind[wanted]].index]

    def told(key: str) -> str:
        return fields[key].text.strip() if key in fields else ""

    with np.errstate(all="ignore"):  # what overflows is reported as no finite number
        values = _complex(columns, table, by_kind)
    response = MeasuredResponse(
        told("tf") or stem,
        table[:, by_kind["frequency"]] * columns[by_kind["frequency"]].factor,
        values,
        table[:, by_kind["coherence"]] if "coherence" in by_kind else None,
        averages,
        window_of(told("window")),
        unit_of(told("unit"), name, fields.get("unit")),
        told("synthetic").lower() in ("yes", "true", "1")
        or "synthetic" in " ".join(_comments(source)).lower(),
        tuple(_comments(source)),
    )
    return (checked_response(response, name, span_of),)


def _complex(columns: list[DataColumn], table: np.ndarray, by_kind: dict[str, int]) -> np.ndarray:
    if "real" in by_kind:
        return np.asarray(table[:, by_kind["real"]] + 1j * table[:, by_kind["imaginary"]])
    magnitude, phase = by_kind["magnitude"], by_kind["phase"]
    size = table[:, magnitude]
    size = 10 ** (size / 20) if columns[magnitude].is_decibel else np.where(size < 0, np.nan, size)
    return np.asarray(size * np.exp(1j * columns[phase].factor * table[:, phase]))


def decoded_text(name: str, data: bytes) -> str:
    """Return the text of a file, with newlines as line ends; DataError SF601 when it is none."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        message = f"'{name}' is UTF-16 text"
        raise DataError(Diagnostic("SF601", message, None, "save the file as UTF-8"))
    try:
        text = data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        message = f"'{name}' is not text: byte 0x{data[error.start]:02x} at byte offset {error.start}"
        raise DataError(
            Diagnostic("SF601", message, None, "binary formats end in .npz, .mat, .uff")
        ) from None
    if "\0" in text:
        message = f"'{name}' is not text: it holds NUL characters"
        raise DataError(Diagnostic("SF601", message, None, "binary formats end in .npz, .mat, .uff"))
    return text.replace("\r\n", "\n").replace("\r", "\n")


def data_lines(source: Source) -> list[tuple[int, int]]:
    """Return start and end of every line that is neither empty nor a comment."""
    found, start = [], 0
    for line in source.text.split("\n"):
        stripped = line.strip()
        if stripped and not stripped.startswith(COMMENTS):
            found.append((start, start + len(line)))
        start += len(line) + 1
    return found


def _comments(source: Source) -> list[str]:
    found = []
    for line in source.text.split("\n"):
        stripped = line.strip()
        if stripped.startswith(COMMENTS):
            found.append(stripped.lstrip("#%!/ "))
    return found


def _comment_fields(source: Source) -> dict[str, Span]:
    found: dict[str, Span] = {}
    start = 0
    for line in source.text.split("\n"):
        match = _COMMENT_FIELD.fullmatch(line) if line.strip().startswith(COMMENTS) else None
        if match and match["key"].lower() not in found:
            end = start + match.start("value") + len(match["value"].rstrip())
            found[match["key"].lower()] = Span(source, start + match.start("value"), end)
        start += len(line) + 1
    return found


def cell_splitter(header: str) -> Callable[[Source, int, int], list[Span]]:
    """Return the function that cuts a line into cells, as the header, or the first line, is cut."""
    separator = next((c for c in (";", "\t", ",") if c in header), None)

    def split(source: Source, start: int, end: int) -> list[Span]:
        text = source.text[start:end]
        if separator is None:
            return [Span(source, start + m.start(), start + m.end()) for m in re.finditer(r"\S+", text)]
        cells, offset = [], 0
        for part in text.split(separator):
            left = len(part) - len(part.lstrip())
            begin = start + offset + left
            cells.append(Span(source, begin, begin + len(part.strip())))
            offset += len(part) + 1
        return cells

    return split


def _columns(
    source: Source, split: Callable[[Source, int, int], list[Span]], start: int, end: int
) -> list[DataColumn]:
    cells = split(source, start, end)
    if all(_number(cell.text) is not None for cell in cells):
        message = "the first line holds numbers: without a header, columns have no meaning"
        raise DataError(Diagnostic("SF602", message, cells[0], _HEADER_HINT))
    found: list[DataColumn] = []
    problems: list[Diagnostic] = []
    for i, cell in enumerate(cells):
        column = _column(cell, i, problems)
        if column is None:
            continue
        if any(column.kind == other.kind for other in found):
            problems.append(Diagnostic("SF602", f"a second column of {column.kind}", cell, _HEADER_HINT))
        found.append(column)
    kinds = {column.kind for column in found}
    line = Span(source, start, end)
    if not problems:
        if "frequency" not in kinds:
            problems.append(Diagnostic("SF602", "no column is the frequency", line, _HEADER_HINT))
        pairs = [{"real", "imaginary"}, {"magnitude", "phase"}]
        if not any(pair <= kinds for pair in pairs):
            missing = next((next(iter(p - kinds)) for p in pairs if p & kinds), None)
            message = f"a column of {missing} is missing" if missing else "no columns hold the values"
            problems.append(Diagnostic("SF602", message, line, _HEADER_HINT))
    if problems:
        raise DataError(*problems[:MAX_ERRORS])
    return found


def _column(cell: Span, index: int, problems: list[Diagnostic]) -> DataColumn | None:
    written = cell.text.strip("\"' ").lower()
    name, unit = written, ""
    if written not in _KINDS and (match := _UNIT.search(written)):
        name, unit = (
            written[: match.start()].strip(),
            (match["bracket"] or match["suffix"] or "").strip().lower(),
        )
    kind = _KINDS.get(name)
    if kind is None:
        hint = nearest(name, _KINDS) or _HEADER_HINT
        problems.append(Diagnostic("SF602", f"unknown column '{cell.text[:40]}'", cell, hint))
        return None
    if kind == "omega":
        kind, unit = "frequency", unit or "rad/s"
    if kind == "decibel":
        return DataColumn("magnitude", index, is_decibel=True)
    if kind in _UNITS:
        factor = _UNITS[kind].get(unit)
        if factor is None:
            known = ", ".join(u for u in _UNITS[kind] if u)
            said = f"unknown unit '{unit[:20]}'" if unit else "no unit"
            problems.append(Diagnostic("SF602", f"{said} of column '{name}'", cell, f"units: {known}"))
            return None
        return DataColumn(kind, index, factor)
    return DataColumn(kind, index, is_decibel=kind == "magnitude" and unit == "db")


def _number(text: str) -> float | None:
    if "_" in text:
        return None
    try:
        return float(text)
    except ValueError:
        return None


def _numbers(
    source: Source,
    split: Callable[[Source, int, int], list[Span]],
    lines: list[tuple[int, int]],
    columns: list[DataColumn],
) -> np.ndarray:
    table = np.empty((len(lines), len(columns)))
    problems: list[Diagnostic] = []
    width = 1 + max(column.index for column in columns)
    for row, (start, end) in enumerate(lines):
        if len(problems) >= MAX_ERRORS:
            break
        cells = split(source, start, end)
        if len(cells) < width:
            message = f"{len(cells)} columns where the header has {width}"
            problems.append(Diagnostic("SF602", message, Span(source, start, end)))
            continue
        for place, column in enumerate(columns):
            cell = cells[column.index]
            number = _number(cell.text)
            if number is None:
                is_comma = re.fullmatch(r"[-+]?\d+,\d*(e[-+]?\d+)?", cell.text, re.I)
                hint = "write decimals with a point" if is_comma else None
                shown = f"'{cell.text[:40]}' is not a number" if cell.text else "a number is missing"
                span = cell if cell.text else Span(source, start, end)
                problems.append(Diagnostic("SF603", shown, span, hint))
                number = 1.0
            table[row, place] = number
    if problems:
        raise DataError(*problems)
    return table
