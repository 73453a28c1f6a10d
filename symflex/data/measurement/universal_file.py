"""Frequency responses in universal files, datasets 58 and 58b, read by pyuff.

The layout is that of the Structural Dynamics Research Laboratory, University of Cincinnati (universal file
datasets summary). What pyuff could stumble over is looked at first, so that messages name a line of the file.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Final

import numpy as np

from symflex.data.measurement.measured_response import (
    MAX_LINES,
    MAX_RESPONSES,
    MeasuredResponse,
    checked_response,
    nowhere,
)
from symflex.errors import DataError, Diagnostic
from symflex.errors.optional import installed

MARK: Final = b"    -1"
HEADER_LINES: Final = 11
"""Records of a dataset 58 before its data."""
RESPONSE, TRANSMISSIBILITY, COHERENCE, MULTIPLE_COHERENCE = 4, 5, 6, 26
"""Function types of datasets 58."""
FREQUENCY_AXIS: Final = 18
"""Data type of an abscissa that is a frequency."""
ORDINATE_TYPES: Final = (2, 4, 5, 6)
"""Real in single and double precision, complex in single and double precision."""


@dataclass(frozen=True, slots=True)
class DatasetPlace:
    """Where a dataset 58 begins, and which of all datasets it is."""

    line: int
    number: int


def read_universal_file(name: str, data: bytes, stem: str) -> tuple[MeasuredResponse, ...]:
    """Read all frequency responses of a universal file; coherence functions of the same ends become weights.

    SF902 when pyuff is not installed; SF601 no universal file, or a dataset that cannot be read; SF602 none
    with a frequency response; SF603, SF604, SF605 values; SF607 too many datasets or lines.
    """
    places = _datasets(name, data)
    if not places:
        message = f"'{name}' holds no dataset 58 (function at nodal degree of freedom)"
        raise DataError(
            Diagnostic("SF601", message, None, "datasets stand between lines with -1 in columns 5 and 6")
        )
    if len(places) > MAX_RESPONSES:
        raise DataError(Diagnostic("SF607", f"'{name}' holds more than {MAX_RESPONSES} datasets 58"))
    pyuff = installed("pyuff")
    sets = _read(pyuff, name, data, places)
    coherences = {_ends(s): s for s in sets if s.get("func_type") in (COHERENCE, MULTIPLE_COHERENCE)}
    found = []
    for place, entry in zip(places, sets, strict=True):
        if entry.get("func_type") not in (RESPONSE, TRANSMISSIBILITY):
            continue
        if entry.get("abscissa_spec_data_type") not in (FREQUENCY_AXIS, 0, 1):
            message = f"{name}:{place.line}:1: the abscissa of this dataset is not a frequency"
            raise DataError(Diagnostic("SF602", message))
        found.append(_response(name, stem, place, entry, coherences.get(_ends(entry))))
    if not found:
        message = f"'{name}' holds no frequency response: its datasets 58 are of other function types"
        raise DataError(Diagnostic("SF602", message, None, "function type 4 is a frequency response"))
    return tuple(found)


def _datasets(name: str, data: bytes) -> list[DatasetPlace]:
    """Return the datasets 58, each with a header that can be read and counts within limits."""
    found: list[DatasetPlace] = []
    number, place = -1, 0
    while True:
        start = _next_mark(data, place)
        if start < 0:
            return found
        number += 1
        end = _next_mark(data, start + len(MARK))
        line = data.count(b"\n", 0, start) + 2
        if end < 0:
            message = f"{name}:{line - 1}:1: this dataset has no end"
            raise DataError(Diagnostic("SF601", message, None, "a line with -1 in columns 5 and 6 ends it"))
        block = data[start:end].split(b"\n", HEADER_LINES + 2)
        kind = block[1].strip() if len(block) > 1 else b""
        if kind[:2] == b"58" and kind[2:3] in (b"", b"b", b" ", b"B"):
            _check_header(name, line, block[1:])
            found.append(DatasetPlace(line, number))
        place = end + len(MARK)


def _next_mark(data: bytes, place: int) -> int:
    """Return where the next line of a lone -1 begins, -1 when there is none."""
    while True:
        at = data.find(MARK, place)
        if at < 0:
            return -1
        rest = data[at + len(MARK) : at + 80].split(b"\n", 1)[0].strip()
        if not rest:
            return at
        place = at + 1


def _check_header(name: str, line: int, block: Sequence[bytes]) -> None:
    if len(block) < HEADER_LINES + 1:
        raise DataError(Diagnostic("SF601", f"{name}:{line}:1: this dataset 58 ends within its header"))
    words = block[7].split()
    try:
        kind, size = int(words[0]), int(words[1])
        numbers = [float(word) for word in words[3:5]]
    except (ValueError, IndexError):
        message = f"{name}:{line + 7}:1: record 7 of this dataset 58 holds no numbers"
        raise DataError(Diagnostic("SF601", message)) from None
    if kind not in ORDINATE_TYPES or not 0 < size <= MAX_LINES or not np.isfinite(numbers).all():
        message = f"{name}:{line + 7}:1: ordinate type {kind} with {size} values"
        code = "SF607" if size > MAX_LINES else "SF601"
        raise DataError(Diagnostic(code, message, None, "types 2, 4, 5 and 6 exist"))


def _read(pyuff: ModuleType, name: str, data: bytes, places: Sequence[DatasetPlace]) -> list[dict[str, Any]]:
    found = []
    # pyuff opens files by name; a copy of what was checked is what it gets.
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "data.uff")
        with open(path, "wb") as file:
            file.write(data)
        for place in places:
            try:
                entry = pyuff.UFF(path).read_sets(place.number)
            except Exception as error:
                # Whatever goes wrong in it, pyuff raises Exception itself, never a class derived from it.
                if type(error) is not Exception:
                    raise
                entry = None
            if not isinstance(entry, dict) or "data" not in entry or "x" not in entry:
                message = f"{name}:{place.line}:1: this dataset 58 cannot be read"
                raise DataError(Diagnostic("SF601", message))
            found.append(entry)
    return found


def _ends(entry: Mapping[str, Any]) -> tuple[object, ...]:
    return tuple(entry.get(key) for key in ("rsp_node", "rsp_dir", "ref_node", "ref_dir"))


def _response(
    name: str, stem: str, place: DatasetPlace, entry: Mapping[str, Any], coherence: Mapping[str, Any] | None
) -> MeasuredResponse:
    lines, values = np.asarray(entry["x"]), np.asarray(entry["data"])
    if (
        lines.ndim != 1
        or lines.shape != values.shape
        or lines.dtype.kind not in "fiu"
        or values.dtype.kind not in "fciu"
    ):
        message = f"{name}:{place.line}:1: {values.size} values at {lines.size} frequencies"
        raise DataError(Diagnostic("SF601", message))
    weights = None
    if coherence is not None and np.asarray(coherence["data"]).shape == lines.shape:
        weights = np.clip(np.real(np.asarray(coherence["data"])), 0, 1)
    title = str(entry.get("id1", "")).strip()
    note = "; ".join(t for k in ("id1", "id2", "id3", "id4", "id5") if (t := str(entry.get(k, "")).strip()))
    tf = title if "/" in title and " " not in title else stem
    fields = dict(part.split("=", 1) for part in str(entry.get("id4", "")).split() if "=" in part)
    count = fields.get("averages", "")
    response = MeasuredResponse(
        tf,
        lines,
        values,
        weights,
        float(count) if count.replace(".", "", 1).isdigit() and float(count) >= 1 else None,
        "hann" if fields.get("window") == "hann" else "",
        is_synthetic="synthetic" in note.lower(),
        notes=(note,) if note else (),
    )
    return checked_response(response, f"{name}:{place.line}", nowhere)
