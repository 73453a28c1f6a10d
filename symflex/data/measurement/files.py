"""Reading and writing data files: the end of a name says how, and no more is read than the limit.

What a user knows of the responses, and their files do not say, is added afterwards.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Final

import numpy as np

from symflex.data.measurement.arrays import arrays_in, format_of, read_arrays
from symflex.data.measurement.arrays import responses_of as responses_of_arrays
from symflex.data.measurement.comma_separated import read_columns, with_axis
from symflex.data.measurement.estimate import Estimate, responses_of
from symflex.data.measurement.input_signal import ARRAYS
from symflex.data.measurement.measured_response import MAX_BYTES, MOST_AVERAGES, MeasuredResponse, window_of
from symflex.data.measurement.record import TimeRecord, joined, read_all_records, read_record
from symflex.data.measurement.spice_raw import is_raw, table_of_raw
from symflex.data.measurement.touchstone import read_touchstone
from symflex.data.measurement.universal_file import (
    COHERENCE,
    FREQUENCY_AXIS,
    RESPONSE,
    UNIVERSAL,
    read_universal_file,
)
from symflex.errors import DataError, Diagnostic, refused
from symflex.errors.optional import installed
from symflex.model.spec.read import read_file

WORKBOOKS: Final = (".xlsx", ".xlsm")
READERS: Mapping[str, Callable[[str, bytes, str, str], tuple[MeasuredResponse, ...]]] = {
    **dict.fromkeys((".csv", ".txt", ".dat", ".tsv", ".frd", ".zma", ".raw"), read_columns),
    **dict.fromkeys((".s1p", ".s2p"), read_touchstone),
    **dict.fromkeys(ARRAYS, read_arrays),
    **dict.fromkeys(WORKBOOKS, read_columns),
    **dict.fromkeys(UNIVERSAL, read_universal_file),
}
"""Readers by the end of a file's name.

Each takes what messages call the file, its bytes, a name, and what ``--columns`` says. Files with other
endings are read as text in columns where they are text.
"""
CERTAIN: Final = 0.95  # coherence of one average that noise has on one line in 200 million: exp(-0.95/0.05)
SAVE_AS: Final = {
    **dict.fromkeys((".xls", ".ods"), "save the sheet as .xlsx or .csv"),
    **dict.fromkeys((".s3p", ".s4p"), "save two of its ports as .s2p"),
    ".wav": "save the samples as columns, time_s,u,y",
    ".toml": "this is a specification, not measured data",
}
"""What to do with files that are not read."""


def read_measurement(
    path: str | Path,
    columns: str = "",
    estimate: Estimate | None = None,
    axis: tuple[float, float] | None = None,
) -> tuple[MeasuredResponse, ...]:
    """Read the frequency responses of a data file, or estimate those of a time record.

    Parameters
    ----------
    path : str or Path
        A regular file of at most 50 MB; the end of its name gives its format, see :data:`READERS`. Files
        with other endings are read as text in columns.
    columns : str
        What the columns are, if the file does not state it or is wrong: words such as ``f,re,im`` or
        ``f_khz,-,mag_db,phase_deg`` for text and matrices, ``f=NAME,h=NAME`` for named arrays, ``s21`` or
        ``z11`` for Touchstone files; ``t,u,y`` for time records.
    estimate : Estimate, optional
        How responses of a time record are estimated.
    axis : (float, float), optional
        First frequency and step [Hz] of a file without frequencies.

    Returns
    -------
    tuple of MeasuredResponse
        Their ``guesses`` list what was assumed.

    Raises
    ------
    UsageError
        SF901 when there is no such regular file; SF902 when a library for its format is not installed, or
        requested columns do not exist.
    DataError
        SF601 to SF607: what is wrong with it, with line and column if possible.

    Examples
    --------
    >>> read_measurement("no/such.csv")
    Traceback (most recent call last):
    symflex.errors.exceptions.UsageError: error[SF901]: cannot read 'no/such.csv': No such file or directory
    """
    name = os.fspath(path)
    suffix = Path(name).suffix.lower()
    if suffix in SAVE_AS:
        message = f"'{name}': data files end in {', '.join(READERS)}"
        raise DataError(Diagnostic("SF606", message, None, SAVE_AS[suffix]))
    data = _contents(name)
    if not data.strip():
        raise DataError(Diagnostic("SF605", f"'{name}' is empty"))
    suffix = format_of(name, data)
    if axis is not None and suffix in ARRAYS:
        arrays = arrays_in(name, data, suffix)
        size = max((max(a.shape, default=0) for a in arrays.values()), default=0)
        arrays = {**arrays, "frequency_hz": axis[0] + axis[1] * np.arange(size)}
        return responses_of_arrays(arrays, name, Path(name).stem, columns)
    if axis is not None:
        return read_columns(name, with_axis(name, data, *axis), Path(name).stem, columns)
    if READERS.get(suffix, read_columns) in (read_columns, read_arrays, read_universal_file):
        records = read_all_records(name, data, Path(name).stem, columns)
        if records:
            how = estimate or Estimate()
            return tuple(response for record in records for response in responses_of(record, how))
    if suffix in READERS:
        return READERS[suffix](name, data, Path(name).stem, columns)
    try:
        return read_columns(name, data, Path(name).stem, columns)
    except DataError as error:
        if error.diagnostics[0].code not in ("SF601", "SF605"):
            raise
        message = f"'{name}' is not a text table; other data files end in {', '.join(READERS)}"
        raise DataError(Diagnostic("SF606", message)) from None


def _contents(name: str) -> bytes:
    """Return the bytes of a file; of a workbook and of SPICE's raw files, their table as text."""
    data = read_file(name, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise DataError(Diagnostic("SF607", f"'{name}' is larger than {MAX_BYTES} bytes"))
    suffix = Path(name).suffix.lower()
    if is_raw(data):
        try:
            return table_of_raw(data)
        except ValueError as error:
            raise DataError(Diagnostic("SF601", f"'{name}' is not a raw file of SPICE: {error}")) from None
    return arrays_in(name, data, suffix)[""].tobytes() if suffix in WORKBOOKS else data


def record_in_time(path: str | Path, columns: str = "") -> TimeRecord | None:
    """Return the record that a file contains, ``None`` if its columns do not say time."""
    return read_record(os.fspath(path), _contents(os.fspath(path)), Path(path).stem, columns)


def responses_in_time(
    path: str | Path, columns: str = "", estimate: Estimate | None = None
) -> tuple[MeasuredResponse, ...] | None:
    """Return the responses of a time record, ``None`` if the columns of a file do not say time."""
    record = record_in_time(path, columns)
    return None if record is None else responses_of(record, estimate or Estimate())


def read_records(
    files: str, columns: str = "", estimate: Estimate | None = None
) -> tuple[MeasuredResponse, ...]:
    """Return the responses of a time record that has one channel a file: ``u=A.CSV,y=B.CSV``."""
    parts = [part.partition("=") for part in files.split(",")]
    kinds = [kind.strip().rstrip("0123456789") for kind, *_ in parts]
    if (
        not {*kinds} <= {"u", "y"}
        or kinds.count("u") > 1
        or "y" not in kinds
        or not all(p for *_, p in parts)
    ):
        raise refused(f"--records {files[:60]}: name at most one u, and one y or more", "u=A.CSV,y=B.CSV")
    read: list[TimeRecord] = []
    for _, _, path in parts:
        one = record_in_time(path.strip(), columns)
        if one is None or one.input is not None or len(one.outputs) != 1:
            raise refused(f"'{path}' is no time record of one channel", "--columns t,y names its columns")
        read.append(one)
    return responses_of(joined(read, kinds), estimate or Estimate())


def _averaged(responses: Sequence[MeasuredResponse]) -> list[MeasuredResponse]:
    """Return responses with those of several records of the same length averaged, each as it is sure."""
    # Lines are weighted by one over their variance, so that the variance of the mean is one over the sum.
    groups: dict[tuple[str, bytes], list[MeasuredResponse]] = {}
    for i, one in enumerate(responses):
        key = (one.name + one.window, one.frequency_hz.tobytes()) if one.is_record else (str(i), b"")
        groups.setdefault(key, []).append(one)
    averaged = []
    for same in groups.values():
        deviations = [one.relative_deviation() for one in same]
        absolute = [d * np.abs(one.values) for d, one in zip(deviations, same, strict=True) if d is not None]
        if len(same) == 1 or len(absolute) < len(same):
            averaged += same
            continue
        weights = np.array([1 / np.maximum(d, 1e-300) ** 2 for d in absolute])
        values = np.sum(weights * np.array([one.values for one in same]), axis=0) / weights.sum(axis=0)
        count = sum(one.averages for one in same if one.averages) or 1.0
        share = 2 * count / (weights.sum(axis=0) * np.abs(values) ** 2)
        said = f"{len(same)} records are averaged"
        averaged.append(
            replace(
                same[0],
                values=values,
                coherence=1 / (1 + share),
                averages=count if same[0].averages else None,
                notes=(*same[0].notes, said),
                guesses=(*same[0].guesses, said),
                samples=tuple(record for one in same for record in one.samples),
            )
        )
    return averaged


def prepared(
    responses: Sequence[MeasuredResponse],
    band: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
) -> tuple[MeasuredResponse, ...]:
    """Return responses with what is known of them, and the lines in a band [Hz] alone."""
    # ``window`` is ``hann``, ``none`` or ``exponential:`` and a time constant [s]. A record keeps the lines
    # from the first to the last that is no noise, eight at least.
    Estimate(window=window or "none")
    if averages is not None and not 1 <= averages <= MOST_AVERAGES:
        raise refused(f"the number of averages is {averages:g}; it must lie between 1 and {MOST_AVERAGES:g}")
    if band is not None and not 0 <= band[0] < band[1]:
        raise refused("give a band as two frequencies in Hz, the lower one first")
    prepared_ones = []
    for response in _averaged(responses):
        chosen = response
        if averages is not None and not chosen.is_record:
            chosen = replace(chosen, averages=averages)
        if window == "exponential" and not chosen.is_record:
            hint = "say its time constant: --window exponential:SECONDS"
            raise refused(f"'{response.name}' is not a time record", hint)
        if window is not None and not chosen.is_record:
            chosen = replace(chosen, window=window_of(window))
        if chosen.is_record and chosen.coherence is not None and not chosen.averages:
            certain = np.flatnonzero(chosen.coherence > CERTAIN)
            if certain.size:
                lines = slice(certain[0], max(certain[-1] + 1, certain[0] + 8))  # so many a fit needs
                chosen = chosen.taken(np.arange(chosen.values.size)[lines])
        if band is not None:
            chosen = chosen.between(*band)
            if not chosen.values.size:
                message = f"'{response.name}' has no lines between {band[0]:g} and {band[1]:g} Hz"
                raise DataError(Diagnostic("SF605", message))
        prepared_ones.append(chosen)
    return tuple(prepared_ones)


def csv_bytes(response: MeasuredResponse) -> bytes:
    """Return a response as text in columns, with what else is known in comment lines."""
    lines = [f"# {note}" for note in response.notes]
    lines.append(f"# tf: {response.name}")
    fields = (
        ("unit", response.unit),
        ("averages", f"{response.averages:g}" if response.averages else ""),
        ("window", response.window),
        ("synthetic", "yes" if response.is_synthetic else ""),
    )
    lines += [f"# {key}: {value}" for key, value in fields if value]
    lines.append("frequency_hz,re,im" + ",coherence" * (response.coherence is not None))
    shares = [""] * len(response.values)
    if response.coherence is not None:
        shares = [f",{share:.6f}" for share in response.coherence]
    for f, h, share in zip(response.frequency_hz, response.values, shares, strict=True):
        lines.append(f"{f:.9g},{h.real:.6g},{h.imag:.6g}{share}")
    return ("\n".join(lines) + "\n").encode()


def npz_bytes(response: MeasuredResponse) -> bytes:
    """Return a response as a numpy archive."""
    arrays: dict[str, np.ndarray] = {
        "frequency_hz": response.frequency_hz,
        "values": response.values,
        "tf": np.array(response.name),
        "synthetic": np.array("yes" if response.is_synthetic else "no"),
        "note": np.array("; ".join(response.notes)),
    }
    fields = {"averages": response.averages, "window": response.window, "unit": response.unit}
    arrays |= {name: np.array(value) for name, value in fields.items() if value}
    if response.coherence is not None:
        arrays["coherence"] = response.coherence
    buffer = BytesIO()
    # An array called allow_pickle would be taken for numpy's option, whose type mypy sees; none is.
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def universal_bytes(response: MeasuredResponse) -> bytes:
    """Return a response, and its coherence, as datasets 58 of a universal file; SF902 without pyuff."""
    pyuff = installed("pyuff")
    lines = response.frequency_hz
    remarks = [f"averages={response.averages:g}"] if response.averages else []
    remarks += [f"window={response.window}"] if response.window else []
    remarks += [f"unit={response.unit}"] if response.unit else []
    header: dict[str, object] = {
        **dict.fromkeys(("id3", "id5", "rsp_ent_name", "ref_ent_name"), "NONE"),
        **dict.fromkeys(("binary", "abscissa_spacing"), 0),
        **dict.fromkeys(("ordinate_spec_data_type", "orddenom_spec_data_type"), 0),
        **{"rsp_node": 1, "rsp_dir": 1, "ref_node": 2, "ref_dir": 1},
        "abscissa_spec_data_type": FREQUENCY_AXIS,
        "id1": response.name[:80],
        "id2": "SYNTHETIC data" if response.is_synthetic else "NONE",
        "id4": " ".join(remarks) or "NONE",
    }
    sets = [(RESPONSE, response.values)]
    if response.coherence is not None:
        sets.append((COHERENCE, response.coherence.astype(np.float64)))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "data.uff")
        for kind, data in sets:
            values = {"func_type": kind, "data": np.array(data), "x": np.array(lines)}
            pyuff.UFF(path).write_sets([pyuff.prepare_58(**header, **values)], mode="add")
        with open(path, "rb") as file:
            return file.read()


WRITERS: Mapping[str, Callable[[MeasuredResponse], bytes]] = {
    ".csv": csv_bytes,
    ".npz": npz_bytes,
    ".uff": universal_bytes,
}
"""Writers by the end of a file's name."""


def measurement_bytes(response: MeasuredResponse, path: str | Path) -> bytes:
    """Return the content of a file of the format its name asks for; SF902 for another ending."""
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        raise refused(f"'{path}': the name of a measurement must end in {', '.join(WRITERS)}")
    return WRITERS[suffix](response)
