"""Frequency responses as named arrays: what .npz, .npy and .mat files contain."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.array_files import (
    DEEPEST,
    ClassName,
    NewerFileError,
    read_archive,
    read_array,
    read_variables,
    require,
)
from symflex.data.measurement.column_meaning import ColumnMeaning, DataColumn, columns_asked, meaning_of
from symflex.data.measurement.column_names import SECONDS
from symflex.data.measurement.columns import CROSS, Assembled, assembled, names_of, unit_by_round_ends
from symflex.data.measurement.isolated import read_isolated
from symflex.data.measurement.likely_readings import WITHOUT_AXIS, WITHOUT_TIME, ask, option_in_time, signals
from symflex.data.measurement.measured_response import (
    MAX_BYTES,
    MAX_RESPONSES,
    MeasuredResponse,
    averages_of,
    checked_response,
    listed_names,
    unit_of,
    window_of,
)
from symflex.data.measurement.text_table import MAX_CELLS, number
from symflex.data.measurement.universal_file import MARK
from symflex.errors import DataError, Diagnostic, refused

Array = npt.NDArray[Any]
Arrays = Mapping[str, Array]

FREQUENCY: Final = (
    "frequency_hz", "frequency", "freq", "f", "f_hz", "freq_hz", "fhz", "freqs", "frequencies", "hz", "faxis",
    "f_axis", "freq_domain", "freqaxis", "freq_axis", "fvec", "freq_vec", "freqvec", "frequency_vector",
)  # fmt: skip
ANGULAR: Final = ("omega", "w", "wout", "om", "w_rad", "omega_rad", "freq_rad", "rad_s")
VALUES: Final = (
    "values", "h", "frf", "frfs", "g", "response", "responsedata", "h1", "txy", "tf_values", "tf_data", "hf",
    "frf_avg", "h_avg", "tfe", "resp", "z", "p",
)  # fmt: skip
NUMBERED: Final = re.compile(r"(?:h|g|frf|tf|hf_chan)_?\d+(?:_\d+)?")
WORDS: Final = {"cxy": "coherence", "cohere": "coherence", "magdb": "mag_db", "ph": "phase"}
"""Names of arrays that are none of columns."""
UNITS: Final = ("frequencyunit", "frequency_unit", "units")
_HINT: Final = "arrays: frequency_hz (n), values (n or m x n, complex), coherence, averages, window, tf"


def read_arrays(name: str, data: bytes, stem: str, asked: str = "") -> tuple[MeasuredResponse, ...]:
    """Read responses from a .npz, .npy or .mat file; as :func:`arrays_in` and :func:`responses_of`."""
    return responses_of(arrays_in(name, data, format_of(name, data)), name, stem, asked)


OCTAVE: Final = b"# Created by Octave"
"""How files begin that Octave saves unless another format is asked for, whatever they are called."""
_OCTAVE_VARIABLE: Final = re.compile(
    r"^# name: (.+)\n# type: (?:complex )?(?:matrix|scalar)\n(?:# rows: \d+\n# columns: (\d+)\n)?"
    r"((?:[^#\n].*\n)*)",
    re.M,
)


def format_of(name: str, data: bytes) -> str:
    """Return the end of a file's name, or that of its format where its begin shows another."""
    if re.match(rb"[\r\n]*" + MARK + rb"[ \t]*\r?\n", data):
        return ".uff"  # no table begins so
    return ".mat" if data.startswith(OCTAVE) else Path(name).suffix.lower()


def _octave_variables(data: bytes) -> Arrays:
    """Return the scalars, vectors and matrices of a text; ValueError where one is cut short."""
    text, variables = data.decode("utf-8", "replace").replace("\r\n", "\n") + "\n", {}
    for name, columns, body in _OCTAVE_VARIABLE.findall(text):
        numbers = [number(cell) for cell in body.split()]
        require(None not in numbers, f"{name[:40]} contains something other than a number")
        width = int(columns or 1)
        require(width > 0 and len(numbers) % width == 0, f"{name[:40]} is cut short")
        variables[name] = np.array(numbers).reshape(-1, width).squeeze()
    return variables


def _json_variables(data: bytes) -> Arrays:
    """Return the arrays of an object, ``run.H``, ``runs(2).H``; a list of objects is a table of keys."""
    if data.count(b",") + 2 * data.count(b"[") + 4 * data.count(b"{") > MAX_CELLS:
        raise OverflowError
    found: dict[str, Array] = {}

    def walk(value: object, path: str, depth: int) -> None:
        require(depth <= DEEPEST, "it is nested too deeply")
        if isinstance(value, list) and any(isinstance(x, dict) for x in value):
            rows = [x if isinstance(x, dict) else {} for x in value]
            keys = dict.fromkeys(key for x in rows for key in x)
            if any(isinstance(y, list | dict) for x in rows for y in x.values()):
                value = {f"({i})": x for i, x in enumerate(rows, 1)}
            elif len(keys) * len(rows) > MAX_CELLS:
                raise OverflowError
            else:
                value = {key: [x.get(key) for x in rows] for key in keys}
        if not isinstance(value, dict):
            cells = [np.nan if x is None else x for x in value] if isinstance(value, list) else []
            if texts := [len(x) for x in cells if isinstance(x, str)]:  # each takes the room of the longest
                require(len(cells) * max(texts) <= MAX_BYTES // 4, "it contains a list of long texts")
                numbers = [number(x) if isinstance(x, str) else x for x in cells]
                cells = cells if None in numbers else numbers
            array = np.array(cells if isinstance(value, list) else value)
            are_pairs = array.shape[1:] == (2,) and array.dtype.kind in "fi"
            are_values = are_pairs and _meaning(path.rpartition(".")[2].lower()).kind == "complex"
            found[path or "array"] = array.astype(float).view(complex)[:, 0] if are_values else array
            return
        for key, inner in value.items():
            walk(inner, f"{path}{key}" if key.startswith("(") or not path else f"{path}.{key}", depth + 1)

    try:
        walk(json.loads(data), "", 0)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    return {key: array for key, array in found.items() if array.dtype.kind in "fciubU"}


_FILES: Final[Mapping[str, tuple[str, Callable[[bytes], Arrays]]]] = {
    ".npz": ("a numpy archive (.npz)", lambda data: read_archive(data, MAX_BYTES, MAX_RESPONSES)),
    ".npy": ("a numpy array (.npy)", lambda data: read_array("array", data)),
    ".mat": ("a MATLAB file (.mat)", lambda data: read_variables(data, MAX_BYTES)),
    **dict.fromkeys((".h5", ".hdf5"), ("an HDF5 file", lambda data: read_isolated("h5py", data, MAX_BYTES))),
    ".tdms": ("a .tdms file", lambda data: read_isolated("nptdms", data, MAX_BYTES)),
    ".json": ("JSON of arrays", _json_variables),
    **dict.fromkeys(
        (".xlsx", ".xlsm"), ("a workbook", lambda data: read_isolated("openpyxl", data, MAX_BYTES))
    ),
    "octave": ("a text file of Octave", _octave_variables),
}
"""What files of arrays are, and how they are read, by the end of their names."""


def arrays_in(name: str, data: bytes, suffix: str) -> Arrays:
    """Return the arrays of a .npz, .npy or .mat file; nothing in it is unpickled."""
    kind, read = _FILES["octave" if data.startswith(OCTAVE) else suffix]
    try:
        arrays = read(data)
    except NewerFileError:  # from version 7.3 on they are HDF5
        return arrays_in(name, data, ".h5")
    except (ValueError, zlib.error) as error:
        reason = str(error).splitlines()[0][:100] if str(error) else type(error).__name__
        raise DataError(Diagnostic("SF601", f"'{name}' is not {kind}: {reason}")) from None
    except OverflowError as error:
        message = (
            f"'{name}': {error}" if error.args else f"'{name}' contains more than {MAX_BYTES} bytes of data"
        )
        raise DataError(Diagnostic("SF607", message)) from None
    if suffix != ".mat":
        return arrays
    objects = ((k, a.item()) for k, a in arrays.items() if a.dtype.kind == "O" and a.size and k)
    plain = {k: a for k, a in arrays.items() if a.dtype.kind != "O" and not k.startswith("__") and k}
    variable, of = next(((k, o) for k, o in objects if isinstance(o, ClassName)), ("", None))
    if of and not any(a.size > 2 and a.dtype.kind in "fciu" for a in plain.values()):  # noqa: PLR2004
        what = f"an object of the class {of.name[:40]}"
        message = f"'{name}': {variable[:40]} is {what}, which only MATLAB reads"
        hint = (
            f"in MATLAB: [H, w] = frdata({variable}); save('FILE.mat', 'H', 'w', '-v7') "
            f"(w in rad/s, unless {variable}.FrequencyUnit says Hz: then call it f)"
        )
        raise DataError(Diagnostic("SF601", message, None, hint))
    return plain


def responses_of(arrays: Arrays, name: str, stem: str, asked: str = "") -> tuple[MeasuredResponse, ...]:
    """Return the responses that named arrays hold; they are called ``stem`` when the file gives no name."""
    # The arrays are ``frequency_hz`` (n) or ``omega`` [rad/s]; ``values`` (n, or m rows of n, or more
    # dimensions of which the last is n), ``re`` and ``im``, or ``mag`` and ``phase``; names are compared
    # without case, and some usual ones are understood. ``coherence``, ``averages``, ``window``, ``unit``,
    # ``tf`` (m names), ``synthetic`` where known. Fields of structures are found by their last names, each
    # with the frequency nearest above it. A matrix alone has columns: the frequency, then values. ``asked``
    # names arrays (``f=freq,h=G``) or columns of a matrix, as ``--columns`` does. Messages call the file
    # ``name``.
    arrays = _with_parts(with_axes(arrays))
    if "=" in asked:
        arrays = _renamed(arrays, asked, name)
    matrix = matrix_of(arrays)
    if matrix is not None and "=" not in asked:
        return _from_matrix(*matrix, name, stem, asked)
    if asked and "=" not in asked:
        hint = f"such as --columns f=NAME,h=NAME; it has {listed_names(list(arrays))}"
        raise refused(f"'{name}' contains several arrays: --columns names them", hint)
    scopes: dict[str, dict[str, Array]] = {}
    for key, array in arrays.items():
        scope, _, last = key.rpartition(".")
        scopes.setdefault(scope, {})[last.lower()] = array
    holding = [scope for scope, arrays_within in scopes.items() if _has_values(arrays_within)]
    responses: list[MeasuredResponse] = []
    for scope in holding:
        parts = scope.split(".") if scope else []
        inherited: dict[str, Array] = {}
        for outer in (scopes.get(".".join(parts[:depth]), {}) for depth in range(len(parts))):
            inherited |= {k: a for k, a in outer.items() if k in (*FREQUENCY, *ANGULAR, *UNITS, "averages")}
        called = stem if len(holding) == 1 else scope or stem
        responses += _from_scope(inherited | scopes[scope], name, called, scope)
    return tuple(responses) if responses else _from_unknown(arrays, name, stem)


def with_axes(arrays: Arrays) -> Arrays:
    """Return arrays with the axes that structures of Testlab tell by start and increment."""
    # Signals in time become a sampling time and channels, called as they are; of responses frequencies are
    # added.
    with_axes = dict(arrays)
    timed: dict[str, Array] = {}
    for stem in [key.removesuffix(".x_values.increment") for key in arrays if key.endswith(".increment")]:
        parts = ("x_values.start_value", "x_values.increment", "y_values.values")
        start, step, values = (arrays.get(f"{stem}.{part}", np.empty(0)) for part in parts)
        if start.size != 1 or step.size != 1 or not values.size or values.dtype.kind not in "fciu":
            continue
        words = ("x_values.quantity.label", "y_values.quantity.label", "function_record.name")
        axis, unit, title = (_word(arrays.get(f"{stem}.{word}", np.empty(0))) for word in words)
        if axis.lower() in SECONDS or (not axis and values.dtype.kind != "c"):
            called = (title or stem).replace(".", " ")
            called = f"{stem} {called}" if called in timed else called
            unit = f" [{'g_n' if unit == 'g' else unit}]" * bool(unit)  # an acceleration
            timed |= {called + unit: values, "dt": step * float(SECONDS.get(axis.lower(), 1))}
        else:
            lines = start.item() + step.item() * np.arange(max(values.shape))
            with_axes[f"{stem}.y_values.frequency_hz"] = lines
    return timed or with_axes


def _with_parts(arrays: Arrays) -> Arrays:
    """Return arrays with the complex values that tables of two columns are, and their frequencies."""
    with_axes = dict(arrays)
    tables = {k: a for k, a in arrays.items() if a.shape[1:] == (2,) and a[2:].size}
    tables = {k: a for k, a in tables.items() if _meaning(k.rpartition(".")[2].lower()).kind == "complex"}
    beside = {k: a for k, a in tables.items() if a.dtype.kind == "c" and _goes_up(a[:, 0])}
    if len(beside) > 1:  # values beside their frequencies; what is called G is a spectrum where others are H
        horizontal = {k: a for k, a in beside.items() if k.lower().startswith("h")} or beside
        return {"f": next(iter(horizontal.values()))[:, 0].real} | {k: a[:, 1] for k, a in horizontal.items()}
    pairs = {k: a for k, a in tables.items() if a.dtype.kind in "fi" and np.any(a < 0)}
    with_axes |= {k: np.array(a, np.float64, order="C").view(np.complex128)[:, 0] for k, a in pairs.items()}
    ends = [with_axes[k] for k in ("f_start", "df") if k in with_axes]
    if pairs and [(e.size, e.dtype.kind in "fiu") for e in ends] == [(1, True)] * 2:
        count = len(next(iter(pairs.values())))
        with_axes["f"] = ends[0].item() + ends[1].item() * np.arange(count)
    return with_axes


def _meaning(key: str) -> ColumnMeaning:
    """Return what the name of an array says; labels are left out, since a scope is one measurement."""
    if key in VALUES:
        return ColumnMeaning("complex")
    if NUMBERED.fullmatch(key):
        return ColumnMeaning("complex", label=key)
    return replace(meaning_of(WORDS.get(key, key)), label="")


def _renamed(arrays: Arrays, asked: str, name: str) -> dict[str, Array]:
    """Return the arrays that ``f=freq,h=G`` names; SF902 where there is none, or the left side is unknown."""
    words = {"f": "frequency_hz", "omega": "omega", "w": "omega", "h": "values", "coh": "coherence"}
    kinds = {*words, "re", "im", "mag", "mag_db", "phase", "phase_deg", "phase_rad"}
    renamed: dict[str, Array] = {}
    for part in asked.split(","):
        kind, _, key = (text.strip() for text in part.partition("="))
        if kind not in kinds or key not in arrays:
            what = f"no array '{key[:40]}'" if kind in kinds else f"unknown '{kind}'"
            message = f"'{name}': --columns {part[:60]}: {what}"
            names = listed_names(list(arrays))
            hint = f"the names left of '=' are {', '.join(sorted(kinds))}; those right of it are {names}"
            raise refused(message, hint)
        renamed[words.get(kind, kind)] = arrays[key]
    return renamed


def _has_values(arrays: Arrays) -> bool:
    kinds = {_meaning(key).kind for key, array in arrays.items() if array.dtype.kind in "fciub"}
    return "complex" in kinds or {"real", "imaginary"} <= kinds or {"magnitude", "phase"} <= kinds


def _from_scope(arrays: Arrays, name: str, stem: str, scope: str = "") -> list[MeasuredResponse]:
    guesses: list[str] = []
    lines = _frequency(arrays, name, guesses)
    if lines is None:
        message = f"'{name}' has no array frequency_hz; it has {listed_names(list(arrays)) or 'none'}"
        raise DataError(Diagnostic("SF602", message, None, f"{_HINT}; {WITHOUT_AXIS}"))
    columns = [DataColumn("frequency", ColumnMeaning("frequency"), lines)]
    kinds = ("complex", "real", "imaginary", "magnitude", "phase")
    used = [key for key in arrays if _meaning(key).kind in kinds and key != "values"]
    if used:
        guesses.append(f"the values are {listed_names(used)}{f' of {scope}' if scope else ''}")
    for key, array in arrays.items():
        meaning = _meaning(key)
        is_whole = meaning.kind == "complex" or lines.size in array.shape
        if meaning.kind not in ("", "frequency") and is_whole:
            rows = _rows(_numeric(array, name, key), lines.size, name, key)
            columns += [DataColumn(key, meaning, r if meaning.kind == "complex" else r.real) for r in rows]
    made, said = assembled(columns, name, None)
    return _responses(arrays, made, name, stem, guesses + said)


def _frequency(arrays: Arrays, name: str, guesses: list[str]) -> Array | None:
    """Return the frequencies [Hz]; ``None`` if no array is called so."""
    key = next((n for n in (*FREQUENCY, *ANGULAR) if n in arrays), None)
    if key is None:
        return None
    lines = np.asarray(_numeric(arrays[key], name, key).real.ravel(), np.float64)
    unit = next((_word(arrays[u]).lower() for u in UNITS if u in arrays), "")
    if key in ANGULAR:
        guesses.append(f"'{key}' is read in rad/s")
        return lines / (2 * np.pi)
    if "rad" in unit:
        return lines / (2 * np.pi)
    if key == "frequency" and "responsedata" in arrays and unit not in ("hz", "khz", "mhz", "ghz"):
        guesses.append("'Frequency' beside 'ResponseData' is read in rad/s, MATLAB's default")
        return lines / (2 * np.pi)
    scale = {"khz": 1e3, "mhz": 1e6, "ghz": 1e9}.get(unit, 1.0)
    if not unit and "hz" not in key:
        guesses.append(f"'{key}' is read in Hz")
    return lines * scale


def _responses(
    arrays: Arrays, made: Sequence[Assembled], name: str, stem: str, guesses: Sequence[str]
) -> list[MeasuredResponse]:
    words = {
        key: _word(arrays[key])
        for key in ("averages", "window", "unit", "synthetic", "note")
        if key in arrays
    }
    averages = averages_of(words["averages"], name) if "averages" in words else None
    window, unit = window_of(words.get("window", "")), unit_of(words.get("unit", ""), name)
    is_synthetic = words.get("synthetic", "").lower() in ("yes", "true", "1", "1.0")
    notes = (words["note"],) if "note" in words else ()
    names = [str(n) for n in np.atleast_1d(arrays["tf"]).ravel()] if "tf" in arrays else []
    if len(names) != len(made):
        names = names_of(made, stem)
    responses = []
    for called, one in zip(names, made, strict=True):
        response = MeasuredResponse(
            called, one.frequency_hz, one.values, one.coherence, averages, window, unit, is_synthetic,
            notes, tuple(guesses), is_magnitude=one.is_magnitude,
        )  # fmt: skip
        responses.append(checked_response(response, name, lambda *_: None))
    return responses


def matrix_of(arrays: Arrays) -> tuple[str, Array] | None:
    """Return the only matrix of a file, its first column going up; rows are turned to columns."""
    large = [(k, a) for k, a in arrays.items() if a.size > 2 and a.dtype.kind in "fciu"]  # noqa: PLR2004
    if len(large) != 1 or large[0][1].ndim != 2:  # noqa: PLR2004
        return None
    key, array = large[0]
    for matrix in (array, array.T):
        if matrix.shape[0] > matrix.shape[1] >= 2 and _goes_up(matrix[:, 0]):  # noqa: PLR2004
            return key, matrix
    return None


def largest_matrix(arrays: Arrays) -> tuple[str, Array]:
    """Return the largest matrix of real numbers, its longer side down, empty if there is none."""
    real = {k: a for k, a in arrays.items() if a.dtype.kind in "fiu" and len(a.shape[1:]) == 1 < min(a.shape)}
    key, matrix = max(real.items(), key=lambda item: item[1].size, default=("", np.empty((0, 0))))
    return key, matrix if len(matrix) >= matrix.shape[1] else matrix.T


def _goes_up(array: Array) -> bool:
    with np.errstate(all="ignore"):
        steps = np.diff(array.real)
    return bool(array.size > 2 and np.all(np.imag(array) == 0) and np.all(steps > 0) and array[0].real >= 0)  # noqa: PLR2004


def _from_matrix(key: str, matrix: Array, name: str, stem: str, asked: str) -> tuple[MeasuredResponse, ...]:
    """Read a matrix of columns: the frequency, then complex values; real ones only as ``asked``."""
    width = matrix.shape[1]
    numbers = [matrix[:, 0].real.astype(np.float64), *(matrix[:, i] for i in range(1, width))]
    if matrix.dtype.kind != "c":
        numbers = [n.astype(np.float64) for n in numbers]
    guesses: list[str] = []
    names = [f"column {i + 1}" for i in range(width)]
    if asked:
        meanings = columns_asked(asked, width)
    elif matrix.dtype.kind == "c":
        unit = unit_by_round_ends(numbers[0])
        if unit is None:
            raise _ask_unit(f"the first column of {key}", name, "--columns f,h", "--columns omega,h")
        guesses.append(f"the first column of '{key}' is read in {unit}, in which its ends are round numbers")
        first = ColumnMeaning("frequency", 1.0 if unit == "Hz" else 1 / (2 * np.pi))
        meanings = [first, *[ColumnMeaning("complex")] * (width - 1)]
    else:
        word = "omega" if unit_by_round_ends(numbers[0]) == "rad/s" else "f"
        message = f"'{name}': {key} is a matrix of {width} real columns without names"
        hint = ask([DataColumn("", ColumnMeaning(), n) for n in numbers], word)
        raise DataError(Diagnostic("SF602", message, None, f"{hint} (omega for rad/s)"))
    columns = [
        DataColumn(n, m, v if m.kind in ("complex", "") or v.dtype.kind != "c" else v.real)
        for n, m, v in zip(names, meanings, numbers, strict=True)
    ]
    made, said = assembled(columns, name, None, is_asked=True)
    return tuple(_responses({}, made, name, stem, [*guesses, *said]))


def _from_unknown(arrays: Arrays, name: str, stem: str) -> tuple[MeasuredResponse, ...]:
    """Read the one complex array and the one that goes up and is as long, whatever they are called."""
    complexes = {k: a for k, a in arrays.items() if a.dtype.kind == "c" and a.size > 2}  # noqa: PLR2004
    complexes = {k: a for k, a in complexes.items() if not CROSS.fullmatch(k.rpartition(".")[2])}
    rising = {k: a for k, a in arrays.items() if a.dtype.kind in "fiu" and a.ndim == 1 and _goes_up(a)}
    named = {k: a for k, a in rising.items() if k.rpartition(".")[2].lower() in (*FREQUENCY, *ANGULAR)}
    pairs = [(f, h) for f, a in (named or rising).items() for h, b in complexes.items() if a.size in b.shape]
    if len(pairs) != 1:
        what = "values" if named else "frequency_hz"
        shapes = [
            f"{k} ({' x '.join(map(str, a.shape)) or 1})" for k, a in arrays.items() if a.dtype.kind in "fciu"
        ]
        message = f"'{name}' has no array {what}; it has {listed_names(shapes) or 'none'}"
        option = f"--columns f={next(iter(named or rising), 'NAME')},h={next(iter(complexes), 'NAME')}"
        hint = f"say which arrays: {option} (omega= for rad/s; re=, im=; mag=, phase_deg=; or t=, u=, y=)"
        if not (named or complexes) and (time := rising.keys() & {"t", "time", "T", "Time"}):
            hint = f"of a time record, one channel each: --columns t={min(time)},u=NAME,y=NAME"
        key, matrix = largest_matrix(arrays)
        columns, alone = list(matrix.T), "u=NAME,y=NAME,dt=SECONDS"
        alone = f"{signals(columns, ',dt=SECONDS')}, columns of '{key}'" if columns[1:] else alone
        timed = option_in_time(columns) if columns else ""
        timed = f"{timed} in '{key}'" if timed else WITHOUT_TIME.format(alone)
        alone = WITHOUT_AXIS if complexes else f"{timed}; {WITHOUT_AXIS}"
        raise DataError(Diagnostic("SF602", message, None, hint if rising else alone))
    ((f, h),) = pairs
    last_name = f.rpartition(".")[2].lower()
    guesses = [f"'{h}' is taken as the values, the only complex array as long as '{f}'"]
    key = last_name if last_name in (*FREQUENCY, *ANGULAR) else ""
    if not key:
        unit = unit_by_round_ends(np.asarray(arrays[f], np.float64))
        if unit is None:
            raise _ask_unit(f, name, f"--columns f={f},h={h}", f"--columns omega={f},h={h}")
        guesses.append(f"'{f}' is read as the frequency in {unit}, in which its ends are round numbers")
        key = "frequency_hz" if unit == "Hz" else "omega"
    shares = {k.lower(): a for k, a in arrays.items() if _meaning(k.lower()).kind == "coherence"}
    responses = _from_scope(shares | {key: arrays[f], "values": arrays[h]}, name, stem)
    return tuple(replace(one, guesses=(*guesses, *one.guesses)) for one in responses)


def _ask_unit(what: str, name: str, in_hz: str, in_rad: str) -> DataError:
    message = f"'{name}': {what[:60]} is in Hz or in rad/s, and the file does not tell which"
    return DataError(Diagnostic("SF602", message, None, f"add {in_hz} for Hz, or {in_rad} for rad/s"))


def _word(array: Array) -> str:
    return str(array.ravel()[0])[:200] if array.size else ""


def _numeric(array: Array, name: str, what: str) -> Array:
    if array.dtype.kind not in "fciub":
        raise DataError(Diagnostic("SF602", f"'{name}': {what} is not an array of numbers", None, _HINT))
    return array.astype(np.complex128)


def _rows(array: Array, size: int, name: str, what: str) -> Array:
    table = np.atleast_2d(array)
    if table.ndim > 2:  # noqa: PLR2004 (outputs x inputs x frequencies, or the frequencies first)
        last = table.shape[-1] == size
        table = table.reshape(-1, table.shape[-1]) if last else table.reshape(table.shape[0], -1)
    if table.shape[1] != size and table.shape[0] == size:
        table = table.T
    if table.shape[1] != size:
        shape = " x ".join(map(str, array.shape))
        message = f"'{name}': {what} has the shape {shape}, and there are {size} frequencies"
        raise DataError(Diagnostic("SF602", message, None, _HINT))
    if not len(table):
        raise DataError(Diagnostic("SF605", f"'{name}': {what} is empty"))
    if len(table) > MAX_RESPONSES:
        raise DataError(Diagnostic("SF607", f"'{name}' contains more than {MAX_RESPONSES} responses"))
    return table
