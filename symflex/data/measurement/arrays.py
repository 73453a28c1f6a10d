"""Frequency responses as named arrays: what .npz and .mat files hold."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Final

import numpy as np

from symflex.data.measurement.array_files import NewerFileError, read_archive, read_variables
from symflex.data.measurement.measured_response import (
    MAX_BYTES,
    MAX_RESPONSES,
    MeasuredResponse,
    averages_of,
    checked_response,
    listed_names,
    nowhere,
    unit_of,
    window_of,
)
from symflex.errors import DataError, Diagnostic

FREQUENCY: Final = ("frequency_hz", "frequency", "freq", "f", "f_hz")
ANGULAR: Final = ("omega", "w")
VALUES: Final = ("values", "h", "frf", "g", "response", "h1", "tf_values")
COHERENCE: Final = ("coherence", "coh", "gamma2")
PARTS: Final = (("re", "im"), ("real", "imag"))
_HINT: Final = "arrays: frequency_hz (n), values (n or m x n, complex), coherence, averages, window, tf"


def read_npz(name: str, data: bytes, stem: str) -> tuple[MeasuredResponse, ...]:
    """Read responses from a numpy archive; nothing in it is unpickled.

    SF601 no such archive; otherwise as :func:`responses_of`; SF607 too large.
    """
    try:
        arrays = read_archive(data, MAX_BYTES, MAX_RESPONSES)
    except ValueError as error:
        raise _unreadable(name, "a numpy archive (.npz)", error) from None
    except OverflowError:
        raise _too_large(name) from None
    return responses_of(arrays, name, stem)


def read_mat(name: str, data: bytes, stem: str) -> tuple[MeasuredResponse, ...]:
    """Read responses from a MATLAB file of version 4 to 7.

    SF601 no such file, or version 7.3; otherwise as :func:`responses_of`; SF607 too large.
    """
    try:
        arrays = read_variables(data, MAX_BYTES)
    except NewerFileError:
        message = f"'{name}' is a MATLAB file of version 7.3"
        raise DataError(Diagnostic("SF601", message, None, "save it with -v7")) from None
    except (ValueError, zlib.error) as error:
        raise _unreadable(name, "a MATLAB file (.mat)", error) from None
    except OverflowError:
        raise _too_large(name) from None
    return responses_of(arrays, name, stem)


def responses_of(arrays: Mapping[str, np.ndarray], name: str, stem: str) -> tuple[MeasuredResponse, ...]:
    """Return the responses that named arrays hold.

    These are ``frequency_hz`` (n) or ``omega`` [rad/s]; ``values`` (n, or m rows of n), or ``re`` and ``im``;
    names are compared without case, and some usual ones are understood. ``coherence``, ``averages``,
    ``window``, ``unit``, ``tf`` (m names), ``synthetic`` where known. Messages call the file ``name``;
    responses are called ``stem`` when the file gives no name.

    SF602 arrays missing or of the wrong shape; SF603, SF604 values; SF605 none, or too few.

    Examples
    --------
    >>> (one,) = responses_of({"F": np.arange(1.0, 9), "H": np.ones(8)}, "a.mat", "a")
    >>> one.name, one.frequency_hz.size
    ('a', 8)
    """
    known = {key.lower(): value for key, value in arrays.items()}

    def first(names: tuple[str, ...]) -> np.ndarray | None:
        return next((known[n] for n in names if n in known), None)

    frequency = first(FREQUENCY)
    if frequency is None and (angular := first(ANGULAR)) is not None:
        frequency = _numeric(angular, name, "omega").real / (2 * np.pi)
    values = first(VALUES)
    if values is None:
        values = next(
            (
                _numeric(known[a], name, a).real + 1j * _numeric(known[b], name, b).real
                for a, b in PARTS
                if a in known and b in known and known[a].shape == known[b].shape
            ),
            None,
        )
    if frequency is None or values is None:
        what = "frequency_hz" if frequency is None else "values"
        message = f"'{name}' has no array {what}; it has {listed_names(list(arrays)) or 'none'}"
        raise DataError(Diagnostic("SF602", message, None, _HINT))
    lines = _numeric(frequency, name, "frequency_hz").real.ravel()
    table = _rows(_numeric(values, name, "values"), lines.size, name, "values")
    coherence = first(COHERENCE)
    weights = (
        None
        if coherence is None
        else _rows(_numeric(coherence, name, "coherence").real, lines.size, name, "coherence")
    )
    if weights is not None and len(weights) != len(table):
        message = f"'{name}': {len(weights)} rows of coherence for {len(table)} of values"
        raise DataError(Diagnostic("SF602", message, None, _HINT))
    averages = known.get("averages")
    names = [str(n) for n in np.atleast_1d(known["tf"]).ravel()] if "tf" in known else []
    if len(names) != len(table):
        names = [stem] if len(table) == 1 else [f"{stem} {i + 1}" for i in range(len(table))]
    found_responses = []
    for i, row in enumerate(table):
        response = MeasuredResponse(
            names[i],
            lines,
            row,
            None if weights is None else weights[i].real,
            None if averages is None else averages_of(_word(averages), name),
            window_of(_word(known["window"])) if "window" in known else "",
            unit_of(_word(known["unit"]), name) if "unit" in known else "",
            "synthetic" in known and _word(known["synthetic"]).lower() in ("yes", "true", "1", "1.0"),
            (_word(known["note"]),) if "note" in known else (),
        )
        found_responses.append(checked_response(response, name, nowhere))
    return tuple(found_responses)


def _word(array: np.ndarray) -> str:
    return str(array.ravel()[0])[:200] if array.size else ""


def _numeric(array: np.ndarray, name: str, what: str) -> np.ndarray:
    if array.dtype.kind not in "fciub" or array.ndim > 2:  # noqa: PLR2004
        message = f"'{name}': {what} is not an array of numbers"
        raise DataError(Diagnostic("SF602", message, None, _HINT))
    return array.astype(np.complex128)


def _rows(array: np.ndarray, size: int, name: str, what: str) -> np.ndarray:
    table = np.atleast_2d(array)
    if table.shape[1] != size and table.shape[0] == size:
        table = table.T
    if table.shape[1] != size:
        shape = " x ".join(map(str, array.shape))
        message = f"'{name}': {what} has the shape {shape}, and there are {size} frequencies"
        raise DataError(Diagnostic("SF602", message, None, _HINT))
    if not len(table):
        raise DataError(Diagnostic("SF605", f"'{name}': {what} is empty"))
    if len(table) > MAX_RESPONSES:
        raise DataError(Diagnostic("SF607", f"'{name}' holds more than {MAX_RESPONSES} responses"))
    return table


def _too_large(name: str) -> DataError:
    return DataError(Diagnostic("SF607", f"'{name}' holds more than {MAX_BYTES} bytes of data"))


def _unreadable(name: str, what: str, error: Exception) -> DataError:
    reason = str(error).splitlines()[0][:100] if str(error) else type(error).__name__
    return DataError(Diagnostic("SF601", f"'{name}' is not {what}: {reason}"))
