r"""SPICE's raw files, in text or binary, as a table of text: transient and AC analyses.

Input: the bytes of a file. Output: names of variables, and a row a point::

    Flags: real ... Variables: 0 time, 1 V(in), 2 V(out) ... Binary: ...
    ->  time\tV(in) [V]\tV(out) [V]\n0.0\t0.0\t0.0\n1e-06\t...

LTspice writes its header as UTF-16, times in double and other variables in single precision unless a flag
says ``double``, complex numbers in double precision, the sign of a time to mark points it may leave out, and
with ``fastaccess`` one variable after the other. ngspice writes an ASCII header, and all in double precision.
(LTspice help, "Waveform Data File Format"; ngspice manual, section on raw files.)
"""

from __future__ import annotations

import re
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.measured_response import MAX_LINES

_UNITS: Final = {"voltage": "V", "current": "A"}
MOST_VARIABLES: Final = 1000


def is_raw(data: bytes) -> bool:
    """Return whether a file begins as SPICE's do."""
    return re.match(rb"(?:\xff\xfe)?T\0?i\0?t\0?l\0?e\0?:", data) is not None


def table_of_raw(data: bytes) -> bytes:
    """Return a raw file as text in columns; ValueError says what is wrong with it."""
    # ngspice writes several plots after each other, of which the largest is read.
    data = max(re.split(rb"(?=Title: [^\n]*\nDate: )", data.removeprefix(b"\xff\xfe")), key=len)
    width = 2 if data[:12].count(0) > 2 else 1  # noqa: PLR2004 (UTF-16)
    encoding = "utf-16-le" if width > 1 else "latin-1"
    marks = {word: data.find(f"\n{word}:".encode(encoding)) for word in ("Binary", "Values")}
    kind, start = next(((word, at) for word, at in marks.items() if at >= 0), ("", -1))
    if not kind:
        raise ValueError("it has neither a part 'Binary:' nor 'Values:'")
    head = data[:start].decode(encoding).replace("\r\n", "\n")
    end = data.find("\n".encode(encoding), start + width)
    body = data[end + width :]
    fields = dict(re.findall(r"^([\w. ]+):[ \t]*(\S.*)$", head, re.M))
    variables = re.findall(r"^\s*\d+\s+(\S+)\s+(\S+)", head.partition("Variables:\n")[2], re.M)
    kinds = {word.lower() for word in variables[0]} if variables else set()
    if not kinds & {"time", "frequency"}:
        raise ValueError(
            f"its first variable, {' '.join(sorted(kinds))[:40]}, is neither a time nor a frequency"
        )
    size = fields.get("No. Points", "").strip()
    count, points = len(variables), int(size) if size.isdigit() and len(size) < 9 else 0  # noqa: PLR2004
    if not (1 < count <= MOST_VARIABLES and points <= MAX_LINES) or (kind == "Binary" and not points):
        raise ValueError(f"its header names {count} variables with {points} points")
    flags = fields.get("Flags", "").lower().split()
    if kind == "Values":
        columns = _listed(body.decode(encoding), count, is_complex="complex" in flags)
    else:
        columns = _binary(body, count, points, flags)
    axis = np.real(columns[0])
    columns[0] = np.abs(axis) if "time" in kinds else axis
    return _text(variables, columns)


def _binary(body: bytes, count: int, points: int, flags: list[str]) -> list[npt.NDArray[Any]]:
    """Return variables of a binary part, whose size shows the precision of all but the first."""
    first, others = ("<c16", ("<c16", "<c8")) if "complex" in flags else ("<f8", ("<f8", "<f4"))
    sizes = {np.dtype(first).itemsize + (count - 1) * np.dtype(kind).itemsize: kind for kind in others}
    kind = sizes.get(len(body) // points if len(body) % points == 0 else 0)
    if kind is None:
        raise ValueError(f"{len(body)} bytes are no {points} points of {count} variables: it is cut short")
    if "fastaccess" in flags:
        at = np.dtype(first).itemsize * points
        others_of = np.frombuffer(body[at:], kind).reshape(count - 1, points)
        return [np.frombuffer(body[:at], first), *others_of]
    rows = np.frombuffer(body, np.dtype([("axis", first), ("rest", kind, (count - 1,))]))
    return [rows["axis"], *rows["rest"].T]


def _listed(text: str, count: int, *, is_complex: bool) -> list[npt.NDArray[Any]]:
    """Return variables of a part in text: the number of a point, then the values of each variable."""
    cells = re.sub(r",\s+", ",", text).split()
    if not cells or len(cells) % (count + 1):
        raise ValueError(f"{len(cells)} numbers are no points of {count} variables: it is cut short")
    table = [cells[i + 1 :: count + 1] for i in range(count)]
    if not is_complex:
        return [np.array(column, np.float64) for column in table]
    parts = ([cell.split(",") for cell in column] for column in table)
    return [np.array([complex(float(a), float(b)) for a, b in column]) for column in parts]


def _text(variables: list[tuple[str, str]], columns: list[npt.NDArray[Any]]) -> bytes:
    """Return columns with their names: of AC, over the voltage that is the same at all frequencies."""
    names = [name for name, _ in variables]
    if np.iscomplexobj(columns[1]):
        names[0] = "frequency_hz"
        steady = (
            i for i, x in enumerate(columns) if i and x[0] and np.all(np.abs(x - x[0]) < 1e-9 * np.abs(x[0]))
        )
        source = next((i for i in steady if variables[i][1] == "voltage"), None)
        if source is not None:
            columns = [x if i in (0, source) else x / columns[source] for i, x in enumerate(columns)]
            names = [n if i in (0, source) else f"{n}/{names[source]}" for i, n in enumerate(names)]
            del columns[source], names[source]
        rows = (
            "\t".join([repr(f), *(f"{z.real!r}{z.imag:+.17g}j" for z in values)])
            for f, *values in zip(*(x.tolist() for x in columns), strict=True)
        )
    else:
        units = (next((u for kind, u in _UNITS.items() if kind in of.lower()), "") for _, of in variables)
        names = [name + f" [{unit}]" * bool(unit) for name, unit in zip(names, units, strict=True)]
        rows = ("\t".join(map(repr, row)) for row in zip(*(x.tolist() for x in columns), strict=True))
    return ("\t".join(names) + "\n" + "\n".join(rows) + "\n").encode()
