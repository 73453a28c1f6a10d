"""Reading a data file: which reader its name asks for, and no more of it than the limit.

What a user knows of the responses, and their files do not say, is added afterwards.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.data.measurement.arrays import read_mat, read_npz
from symflex.data.measurement.checks import MAX_BYTES, MOST_AVERAGES
from symflex.data.measurement.comma_separated import read_columns
from symflex.data.measurement.universal_file import read_universal_file
from symflex.errors import DataError, Diagnostic, UsageError
from symflex.model.spec.read import read_bytes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.data.measurement.measured_response import MeasuredResponse


READERS: Mapping[str, Callable[[str, bytes, str], tuple[MeasuredResponse, ...]]] = {
    ".csv": read_columns,
    ".txt": read_columns,
    ".dat": read_columns,
    ".tsv": read_columns,
    ".npz": read_npz,
    ".mat": read_mat,
    ".uff": read_universal_file,
    ".unv": read_universal_file,
    ".uf": read_universal_file,
}
"""Readers by the end of a file's name. Each takes what messages call the file, its bytes, and a name."""


def read_measurement(path: str | Path) -> tuple[MeasuredResponse, ...]:
    """Read the frequency responses of a data file.

    Parameters
    ----------
    path : str or Path
        A regular file of at most 50 MB; the end of its name says what it holds, see :data:`READERS`.

    Raises
    ------
    UsageError
        SF901 when there is no such regular file; SF902 when a library for its format is not installed.
    DataError
        SF601 to SF607: what is wrong with it, as far as can be with line and column.

    Examples
    --------
    >>> read_measurement("no/such.csv")
    Traceback (most recent call last):
    symflex.errors.exceptions.UsageError: error[SF901]: cannot read 'no/such.csv': No such file or directory
    """
    name = os.fspath(path)
    suffix = Path(name).suffix.lower()
    if suffix not in READERS:
        message = f"'{name}': data files end in {', '.join(READERS)}"
        raise DataError(Diagnostic("SF606", message))
    try:
        data = read_bytes(name, MAX_BYTES)
    except OSError as error:
        raise _unreadable(name, error.strerror or "input/output error") from None
    except ValueError:
        raise _unreadable(name, "the name holds a character no file name can have") from None
    if len(data) > MAX_BYTES:
        raise DataError(Diagnostic("SF607", f"'{name}' is larger than {MAX_BYTES} bytes"))
    if not data.strip():
        raise DataError(Diagnostic("SF605", f"'{name}' is empty"))
    return READERS[suffix](name, data, Path(name).stem)


def _unreadable(name: str, reason: str) -> UsageError:
    return UsageError(Diagnostic("SF901", f"cannot read '{name}': {reason}"))


def prepared(
    responses: Sequence[MeasuredResponse],
    band: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
) -> tuple[MeasuredResponse, ...]:
    """Return responses with what is known of them, and the lines in a band [Hz] alone.

    ``window`` is ``hann`` or ``none``. SF902 a band whose ends are not in order, an unknown window, or no
    number of averages; SF605 when a response has no lines in the band.

    Examples
    --------
    >>> from symflex.data.measurement import MeasuredResponse
    >>> (one,) = prepared([MeasuredResponse("A/F", [1.0, 2.0, 3.0], [1, 2, 3])], (1.5, 9.0), averages=8)
    >>> one.frequency_hz.tolist(), one.averages
    ([2.0, 3.0], 8)
    """
    if window not in (None, "hann", "none"):
        raise UsageError(Diagnostic("SF902", f"the window '{window[:40]}' is neither hann nor none"))
    if averages is not None and not 1 <= averages <= MOST_AVERAGES:
        message = f"the number of averages is {averages:g}; it lies between 1 and {MOST_AVERAGES:g}"
        raise UsageError(Diagnostic("SF902", message))
    if band is not None and not 0 <= band[0] < band[1]:
        raise UsageError(Diagnostic("SF902", "a band is two frequencies in Hz, the lower one first"))
    found = []
    for response in responses:
        known = response
        if averages is not None:
            known = replace(known, averages=averages)
        if window is not None:
            known = replace(known, window=window.replace("none", ""))
        if band is not None:
            known = known.between(*band)
            if not known.values.size:
                message = f"'{response.name}' has no lines between {band[0]:g} and {band[1]:g} Hz"
                raise DataError(Diagnostic("SF605", message))
        found.append(known)
    return tuple(found)
