"""One- and two-ports in Touchstone files (.s1p, .s2p), as network analysers write them.

    # MHz S RI R 50
    1.0  0.33  0.02        ->  Z = 50 Ohm (1 + S11)/(1 - S11) at 1 MHz

The layout is that of the IBIS Open Forum, Touchstone File Format Specification 2.0 (2009), whose version 1
has no keywords in brackets. In version 1 impedances and admittances are over the reference resistance. A
response is the impedance at the port of a one-port and S21 of a two-port; ``--columns z11`` takes another.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.measured_response import MAX_LINES, MeasuredResponse, checked_response
from symflex.data.measurement.text_table import decoded
from symflex.errors import DataError, Diagnostic, Source, Span, refused

Complex = npt.NDArray[np.complex128]
_SCALES: Final = {"HZ": 1.0, "KHZ": 1e3, "MHZ": 1e6, "GHZ": 1e9}
_OPTIONS: Final = "such as # MHz S RI R 50: a unit, S, Z or Y, RI, MA or DB, and the reference resistance"
_KEYWORD = re.compile(r"\[(reference|two-port data order|version)\]\s*([-+.\w]+)", re.I)


def read_touchstone(name: str, data: bytes, stem: str, asked: str = "") -> tuple[MeasuredResponse, ...]:
    """Read the impedance of a one-port, or S21 of a two-port; ``asked`` names another one, as ``z21``."""
    ports = 1 if Path(name).suffix.lower() != ".s2p" else 2
    text, guesses = decoded(name, data)
    source = Source(name, text)
    options = ["GHZ", "S", "MA", "R", "50"]
    keywords: dict[str, str] = {}
    rows: list[list[float]] = []
    places: list[Span] = []
    start = 0
    for line in text.split("\n"):
        written = line.split("!")[0].strip()
        location = Span(source, start + len(line) - len(line.lstrip()), start + len(line.rstrip()))
        start += len(line) + 1
        if written.startswith("#") and not rows:
            options = _options(written[1:].upper().split(), options, location)
        elif written.startswith("["):
            keywords |= {m[1].lower(): m[2].upper() for m in [_KEYWORD.match(written)] if m}
            options[4] = _resistance(keywords.get("reference", options[4]), location)
            if "noise data" in written.lower():
                break
        elif written:
            row = _row(written, ports, location)
            if rows and row[0] < rows[-1][0] and ports == 2 and len(row) == 5:  # noqa: PLR2004 (noise parameters)
                break
            rows.append(row)
            places.append(location)
            if len(row) != 1 + 2 * ports**2:
                message = f"{len(row)} numbers in a line of a {ports}-port, which has {1 + 2 * ports**2}"
                raise DataError(Diagnostic("SF601", message, location, "one line per frequency"))
    if not rows or len(rows) > MAX_LINES:
        raise DataError(Diagnostic("SF607" if rows else "SF605", f"'{name}' has {len(rows)} lines of data"))
    table = np.array(rows)
    resistance = float(options[4])
    chosen = asked.strip().lower() or ("z11" if ports == 1 else "s21")
    with np.errstate(all="ignore"):  # what is no finite number is reported
        parameters = _parameters(table[:, 1:], options[2]).reshape(-1, ports, ports)
        # A two-port is written 11, 21, 12, 22.
        if keywords.get("two-port data order") != "12_21":
            parameters = parameters.transpose(0, 2, 1)
        if options[1] != "S" and "version" in keywords:
            parameters = parameters / resistance if options[1] == "Z" else parameters * resistance
        values = _chosen(parameters, options[1], chosen, resistance, name)
    said = f"{chosen.upper()} is the response, from {options[1]}-parameters with the reference "
    guesses += () if asked else (f"{said}{resistance:g} Ohm",)
    unit = {"z": "Ohm", "y": "S", "s": ""}[chosen[0]]
    response = MeasuredResponse(stem, table[:, 0] * _SCALES[options[0]], values, unit=unit, guesses=guesses)
    return (checked_response(response, name, lambda i, _: places[i]),)


def _options(words: list[str], options: list[str], location: Span) -> list[str]:
    unit, kind, form, _, resistance = options
    for i, word in enumerate(words):
        if word in _SCALES:
            unit = word
        elif word in ("S", "Z", "Y"):
            kind = word
        elif word in ("RI", "MA", "DB"):
            form = word
        elif word == "R" and i + 1 < len(words):
            resistance = words[i + 1]
        elif not (i and words[i - 1] == "R"):
            raise DataError(Diagnostic("SF601", f"unknown option '{word[:20]}'", location, _OPTIONS))
    return [unit, kind, form, "R", _resistance(resistance, location)]


def _resistance(text: str, location: Span) -> str:
    if not re.fullmatch(r"\d{1,20}\.?\d{0,20}(E[-+]?\d{1,2})?", text) or not float(text) > 0:
        raise DataError(Diagnostic("SF601", f"a reference resistance '{text[:20]}'", location, _OPTIONS))
    return text


def _row(written: str, ports: int, location: Span) -> list[float]:
    try:
        if "_" not in written:
            return [float(cell) for cell in written.split()]
    except ValueError:
        pass
    message = f"this line of a {ports}-port contains something other than a number"
    raise DataError(Diagnostic("SF603", message, location, _OPTIONS))


def _parameters(cells: npt.NDArray[np.float64], form: str) -> Complex:
    one, two = cells[:, 0::2], cells[:, 1::2]
    if form == "RI":
        return np.asarray(one + 1j * two, np.complex128)
    size = 10 ** (one / 20) if form == "DB" else one
    return np.asarray(size * np.exp(1j * np.radians(two)), np.complex128)


def _chosen(parameters: Complex, kind: str, chosen: str, resistance: float, name: str) -> Complex:
    """Return one parameter: all are turned to S, Z or Y by matrices over the reference resistance."""
    ports = parameters.shape[1]
    match = re.fullmatch(r"([szy])([12])([12])", chosen)
    if match is None or max(int(match[2]), int(match[3])) > ports:
        names = ", ".join(
            f"{k}{i}{j}" for k in "szy" for i in range(1, ports + 1) for j in range(1, ports + 1)
        )
        raise refused(f"'{name}': --columns {chosen[:20]}", f"one of {names}")
    one = np.eye(ports)
    wanted = match[1].upper()
    matrices: npt.NDArray[np.complexfloating] = parameters
    try:
        # S = (z - 1)(z + 1)^-1, z = (1 + S)(1 - S)^-1; y is the inverse of z, and S of y has another sign.
        if wanted != kind == "S":
            signed = parameters if wanted == "Z" else -parameters
            matrices = (one + signed) @ np.linalg.inv(one - signed)
        elif wanted == "S" != kind:
            matrices = (parameters - one) @ np.linalg.inv(parameters + one) * (1 if kind == "Z" else -1)
        elif wanted != kind:
            matrices = np.linalg.inv(parameters)
    except np.linalg.LinAlgError:
        message = f"'{name}': {kind} has no {wanted} at some line, where a matrix is singular"
        raise DataError(Diagnostic("SF603", message, None, f"--columns {kind.lower()}11")) from None
    scale = {"S": 1.0, "Z": resistance, "Y": 1 / resistance}[wanted]
    return np.asarray(scale * matrices[:, int(match[2]) - 1, int(match[3]) - 1], np.complex128)
