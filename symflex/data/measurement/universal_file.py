"""Frequency responses in universal files, datasets 58 and 58b, read by pyuff.

The layout is that of the Structural Dynamics Research Laboratory, University of Cincinnati (universal file
datasets summary). What pyuff could stumble over is looked at first, so that messages name a line of the file.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.column_meaning import ColumnMeaning, DataColumn
from symflex.data.measurement.columns import assembled
from symflex.data.measurement.measured_response import (
    MAX_LINES,
    MAX_RESPONSES,
    MeasuredResponse,
    checked_response,
    unit_of,
    window_of,
)
from symflex.errors import DataError, Diagnostic, refused
from symflex.errors.optional import installed

UNIVERSAL: Final = (".uff", ".unv", ".uf")  # ends of names
MARK: Final = b"    -1"
_MARKS: Final = re.compile(rb"    -1[^\S\n]*(?:\n|\Z)")
_TYPES: Final = re.compile(rb"^ *58[bB ]?[^\n]*\n(?:[^\n]*\n){5} *(\d{1,5})", re.M)  # of functions
HEADER_LINES: Final = 11  # records of a dataset 58 before its data
RESPONSE, TRANSMISSIBILITY, COHERENCE, MULTIPLE_COHERENCE = 4, 5, 6, 26
POWERS: Final = (2, 9)  # datasets 58, types of function: auto spectrum, power spectral density
FREQUENCY_AXIS, TIME_AXIS = 18, 17  # data types of an abscissa that is a frequency, or a time
TIME_RESPONSE = 1  # a type of function
SPECIFIC_TYPES: Final = {
    8: ("X", "m"), 9: ("F", "N"), 11: ("V", "m/s"), 12: ("A", "m/s^2"), 13: ("F", "N"), 15: ("P", "Pa"),
}  # fmt: skip
"""Letter and SI unit of a quantity by its specific data type."""
DIRECTIONS: Final = {0: "", 1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}
SI: Final = 1  # code of a dataset 164 for metres, newtons and seconds
FUNCTIONS: Final = {
    0: "general", 1: "time response", 2: "auto spectrum", 3: "cross spectrum", 6: "coherence",
    7: "auto correlation", 8: "cross correlation", 9: "power spectral density", 12: "spectrum",
    26: "multiple coherence",
}  # fmt: skip
DATASETS: Final = {
    15: "nodes", 55: "data at nodes", 58: "functions", 82: "trace lines", 151: "header", 164: "units",
    2411: "nodes", 2412: "elements", 2414: "analysis data", 2420: "coordinate systems",
}  # fmt: skip
ORDINATE_TYPES: Final = (2, 4, 5, 6)  # real, then complex, each in single and double precision


_Place = tuple[int, int]  # the line where a dataset 58 begins, and which of all datasets it is


def read_universal_file(name: str, data: bytes, stem: str, asked: str = "") -> tuple[MeasuredResponse, ...]:
    """Read all responses, called ``A_2Z/F_1X`` unless titles name them; coherence becomes their weights."""
    if asked:
        raise refused(f"'{name}' describes its own contents: --columns does not apply")
    places, kinds = _datasets(name, data)
    if not places:
        held = ", ".join(f"{k} ({DATASETS.get(k, 'not read')})" for k in sorted(set(kinds))[:8])
        message = f"'{name}' contains no dataset 58 (function at nodal degree of freedom)"
        message += f"; it contains datasets {held}" if held else ""
        hint = "a line with -1 in columns 5 and 6 begins and ends each dataset"
        raise DataError(Diagnostic("SF601", message, None, hint))
    if len(places) > MAX_RESPONSES:
        raise DataError(Diagnostic("SF607", f"'{name}' contains more than {MAX_RESPONSES} datasets 58"))
    pyuff = installed("pyuff")
    sets = _read(pyuff, name, data, places)
    coherences = {_ends(s): s for s in sets if s.get("func_type") in (COHERENCE, MULTIPLE_COHERENCE)}
    system = kinds.get(164, SI)
    responses: list[MeasuredResponse] = []
    for (line, _), entry in zip(places, sets, strict=True):
        is_general = entry.get("func_type") == 0 and np.iscomplexobj(entry["data"])
        if entry.get("func_type") not in (RESPONSE, TRANSMISSIBILITY) and not is_general:
            continue
        if entry.get("abscissa_spec_data_type") not in (FREQUENCY_AXIS, 0, 1):
            message = f"{name}:{line}:1: the abscissa of this dataset is not a frequency"
            raise DataError(Diagnostic("SF602", message))
        one = _response(f"{name}:{line}", stem, entry, coherences.get(_ends(entry)), system)
        same = sum(one.name == other.name.partition(" ")[0] for other in responses)
        responses.append(replace(one, name=f"{one.name} {same + 1}") if same else one)
    powers = [entry for entry in sets if entry.get("func_type") in POWERS]
    if not responses and powers and all(np.array_equal(entry["x"], powers[0]["x"]) for entry in powers):
        axis = DataColumn("frequency", ColumnMeaning("frequency"), np.asarray(powers[0]["x"]))
        read = ((str(entry.get("id4", "")).strip(), np.asarray(entry["data"]).real) for entry in powers)
        columns = [DataColumn(title, ColumnMeaning("power"), numbers) for title, numbers in read]
        (power,), said = assembled([axis, *columns], name, None)
        response = MeasuredResponse(
            stem, power.frequency_hz, power.values, guesses=tuple(said), is_magnitude=True
        )
        return (checked_response(response, name, lambda *_: None),)
    if not responses:
        types = sorted({int(entry.get("func_type", 0)) for entry in sets})
        held = ", ".join(f"{t} ({FUNCTIONS.get(t, 'not read')})" for t in types[:8])
        message = f"'{name}' contains no frequency response: its datasets 58 are of the function types {held}"
        raise DataError(Diagnostic("SF602", message, None, "function type 4 is a frequency response"))
    return tuple(responses)


def signals_in(name: str, data: bytes) -> dict[str, npt.NDArray[Any]]:
    """Return signals in time and their times; none if the file has no signals, or frequency responses."""
    places, kinds = _datasets(name, data)
    types = {int(match[1]) for match in _TYPES.finditer(data)}
    if (
        not 0 < len(places) <= MAX_RESPONSES
        or TIME_RESPONSE not in types
        or types & {RESPONSE, TRANSMISSIBILITY}
    ):
        return {}
    sets = _read(installed("pyuff"), name, data, places)
    axes = {entry.get("abscissa_spec_data_type") for entry in sets if entry.get("func_type") == TIME_RESPONSE}
    if any(entry.get("func_type") in (RESPONSE, TRANSMISSIBILITY) for entry in sets) or not axes <= {
        TIME_AXIS,
        0,
        1,
    }:
        return {}
    signals: dict[str, npt.NDArray[Any]] = {}
    for entry in (entry for entry in sets if entry.get("func_type") == TIME_RESPONSE):
        times, values = np.asarray(entry["x"]), np.asarray(entry["data"])
        if signals and not np.array_equal(times, signals["time"]):
            continue
        title = str(entry.get("id1", "")).strip()
        called = _end_name(entry, "rsp", "ordinate", "y") or (title if title != "NONE" else "")
        called = called.replace(".", " ") or f"channel {len(signals) or 1}"
        kind = int(entry.get("ordinate_spec_data_type", 0))
        label = str(entry.get("ordinate_axis_units_lab", "")).strip()
        unit = "" if label.lower() in ("", "none") else {"g": "g_n"}.get(label, label)
        if not unit and kinds.get(164, SI) == SI:
            unit = SPECIFIC_TYPES.get(kind, ("", ""))[1]
        many = sum(key.partition(" [")[0].startswith(called) for key in signals)
        called += f" {many + 1}" * bool(many)
        signals |= {"time": times, called + f" [{unit}]" * bool(unit): values}
    return signals


def _datasets(name: str, data: bytes) -> tuple[list[_Place], dict[int, int]]:
    """Return the datasets 58, with headers that can be read, and by kind of all datasets a first number."""
    places: list[_Place] = []
    kinds: dict[int, int] = {}
    offset, lines = 0, 0
    marks = _MARKS.finditer(data)
    for number, begin in enumerate(marks):
        line = lines + data.count(b"\n", offset, begin.start()) + 2
        end = next(marks, None)
        if end is None:
            message = f"{name}:{line - 1}:1: this dataset has no end"
            raise DataError(Diagnostic("SF601", message, None, "a line with -1 in columns 5 and 6 ends it"))
        block = data[begin.start() : end.start()].split(b"\n", HEADER_LINES + 2)
        kind = block[1].strip() if len(block) > 1 else b""
        if kind[:6].isdigit():
            first = block[2][:10].strip() if len(block) > 2 else b""  # noqa: PLR2004
            kinds.setdefault(int(kind[:6]), int(first) if first.isdigit() else 0)
        if kind[:2] == b"58" and kind[2:3] in (b"", b"b", b" ", b"B"):
            _check_header(name, line, block[1:])
            places.append((line, number))
        lines += data.count(b"\n", offset, end.start())
        offset = end.start()
    return places, kinds


def _check_header(name: str, line: int, block: Sequence[bytes]) -> None:
    if len(block) < HEADER_LINES + 1:
        raise DataError(Diagnostic("SF601", f"{name}:{line}:1: this dataset 58 ends within its header"))
    words = block[7].split()
    try:
        kind, size = int(words[0]), int(words[1])
        numbers = [float(word) for word in words[3:5]]
    except (ValueError, IndexError):
        message = f"{name}:{line + 7}:1: record 7 of this dataset 58 contains no numbers"
        raise DataError(Diagnostic("SF601", message)) from None
    if kind not in ORDINATE_TYPES or not 0 < size <= MAX_LINES or not np.isfinite(numbers).all():
        message = f"{name}:{line + 7}:1: ordinate type {kind} with {size} values"
        code = "SF607" if size > MAX_LINES else "SF601"
        raise DataError(Diagnostic(code, message, None, "types 2, 4, 5 and 6 exist"))


def _read(pyuff: ModuleType, name: str, data: bytes, places: Sequence[_Place]) -> list[dict[str, Any]]:
    entries = []
    if not re.search(rb"^ *58[bB]", data, re.M):  # it knows marks with 74 blanks behind them, or none
        data = re.sub(rb"^    -1[ \t]+(?=\r?$)", MARK, data, flags=re.M)
    # pyuff opens files by name; a copy of what was checked is what it gets.
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "data.uff")
        with open(path, "wb") as file:
            file.write(data)
        for line, number in places:
            try:
                entry = pyuff.UFF(path).read_sets(number)
            except Exception as error:
                # Whatever goes wrong in it, pyuff raises Exception itself, never a class derived from it.
                if type(error) is not Exception:
                    raise
                entry = None
            if not isinstance(entry, dict) or "data" not in entry or "x" not in entry:
                raise DataError(Diagnostic("SF601", f"{name}:{line}:1: this dataset 58 cannot be read"))
            entries.append(entry)
    return entries


def _ends(entry: Mapping[str, Any]) -> tuple[object, ...]:
    return tuple(entry.get(key) for key in ("rsp_node", "rsp_dir", "ref_node", "ref_dir"))


def _response(
    location: str, stem: str, entry: Mapping[str, Any], coherence: Mapping[str, Any] | None, system: int
) -> MeasuredResponse:
    lines, values = np.asarray(entry["x"]), np.asarray(entry["data"])
    are_numbers = lines.dtype.kind in "fiu" and values.dtype.kind in "fciu"
    if lines.ndim != 1 or lines.shape != values.shape or not are_numbers:
        raise DataError(
            Diagnostic("SF601", f"{location}:1: {values.size} values at {lines.size} frequencies")
        )
    weights = None
    if coherence is not None and np.asarray(coherence["data"]).shape == lines.shape:
        weights = np.clip(np.real(np.asarray(coherence["data"])), 0, 1)
    title = str(entry.get("id1", "")).strip()
    note = "; ".join(t for k in ("id1", "id2", "id3", "id4", "id5") if (t := str(entry.get(k, "")).strip()))
    tf = title if "/" in title and " " not in title else _ends_name(entry) or stem
    fields = dict(part.split("=", 1) for part in str(entry.get("id4", "")).split() if "=" in part)
    written = fields.get("unit", "")
    unit, guesses = (unit_of(written, location), ()) if written else _unit(entry, system)
    count = fields.get("averages", "")
    averages = float(count) if count.replace(".", "", 1).isdigit() and float(count) >= 1 else None
    window, is_synthetic = window_of(fields.get("window", "")), "synthetic" in note.lower()
    notes = (note,) if note else ()
    response = MeasuredResponse(
        tf, lines, values, weights, averages, window, unit, is_synthetic, notes, guesses
    )
    return checked_response(response, location, lambda *_: None)


def _ends_name(entry: Mapping[str, Any]) -> str:
    """Return ``A_2Z/F_1X`` for an acceleration in node 2 along Z over a force in node 1 along X."""
    ends = _end_name(entry, "rsp", "ordinate", "y"), _end_name(entry, "ref", "orddenom", "u")
    return "/".join(ends) if all(ends) else ""


def _end_name(entry: Mapping[str, Any], end: str, axis: str, unknown: str) -> str:
    """Return what is measured, where and in which direction, as ``A_2Z``; empty if no place is given."""
    node, direction = entry.get(f"{end}_node"), entry.get(f"{end}_dir")
    if not isinstance(node, int) or not isinstance(direction, int) or node < 0 or not (node or direction):
        return ""
    letter, _ = SPECIFIC_TYPES.get(int(entry.get(f"{axis}_spec_data_type", 0)), (unknown, ""))
    return f"{letter}_{node}{'n' * (direction < 0)}{DIRECTIONS.get(abs(direction), '')}"


def _unit(entry: Mapping[str, Any], system: int) -> tuple[str, tuple[str, ...]]:
    """Return the unit of the values by the types of ordinate and denominator, and what was guessed."""
    kinds = [int(entry.get(f"{axis}_spec_data_type", 0)) for axis in ("ordinate", "orddenom")]
    labels = [str(entry.get(f"{axis}_axis_units_lab", "")).strip() for axis in ("ordinate", "orddenom")]
    if not all(kind in SPECIFIC_TYPES for kind in kinds):
        return "", ()
    over = " over ".join(map(str, kinds))
    if all(label.lower() not in ("", "none", "g") for label in labels):
        try:
            return unit_of(f"({labels[0]})/({labels[1]})", ""), ()
        except DataError:
            return "", (f"the units {labels[0]}/{labels[1]} are unknown, so the values have no unit",)
    if system != SI or labels[0].lower() == "g":
        return "", (f"values of the types {over} are in units that are not SI, and are taken without a unit",)
    unit = f"({SPECIFIC_TYPES[kinds[0]][1]})/{SPECIFIC_TYPES[kinds[1]][1]}"
    return unit, (f"the ordinate types {over} are read in SI units, {unit}",)
