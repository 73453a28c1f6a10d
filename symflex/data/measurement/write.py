"""Writing a measured response: CSV, numpy archive, universal file."""

from __future__ import annotations

import os
import tempfile
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from symflex.data.measurement.universal_file import COHERENCE, FREQUENCY_AXIS, RESPONSE, load_pyuff
from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from symflex.data.measurement.measured_response import MeasuredResponse

CSV_DIGITS, COHERENCE_DIGITS = 6, 6


def csv_bytes(response: MeasuredResponse) -> bytes:
    """Return a response as text in columns, with what else is known in comment lines."""
    lines = [f"# {note}" for note in response.notes]
    lines.append(f"# tf: {response.name}")
    if response.unit:
        lines.append(f"# unit: {response.unit}")
    if response.averages:
        lines.append(f"# averages: {response.averages:g}")
    if response.window:
        lines.append(f"# window: {response.window}")
    if response.is_synthetic:
        lines.append("# synthetic: yes")
    has_coherence = response.coherence is not None
    lines.append("frequency_hz,re,im" + ",coherence" * has_coherence)
    coherence = response.coherence if response.coherence is not None else np.ones(response.values.size)
    for f, h, c in zip(response.frequency_hz, response.values, coherence, strict=True):
        cells = [f"{f:.9g}", f"{h.real:.{CSV_DIGITS}g}", f"{h.imag:.{CSV_DIGITS}g}"]
        lines.append(",".join(cells + [f"{c:.{COHERENCE_DIGITS}f}"] * has_coherence))
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
    if response.coherence is not None:
        arrays["coherence"] = response.coherence
    if response.averages:
        arrays["averages"] = np.array(response.averages)
    if response.window:
        arrays["window"] = np.array(response.window)
    if response.unit:
        arrays["unit"] = np.array(response.unit)
    buffer = BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def universal_bytes(response: MeasuredResponse) -> bytes:
    """Return a response, and its coherence, as datasets 58 of a universal file; SF902 without pyuff."""
    pyuff = load_pyuff()
    lines = response.frequency_hz
    told = [f"averages={response.averages:g}"] if response.averages else []
    told += [f"window={response.window}"] if response.window else []
    sets = [(RESPONSE, response.values)]
    if response.coherence is not None:
        sets.append((COHERENCE, response.coherence.astype(np.float64)))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "data.uff")
        for kind, data in sets:
            entry = pyuff.prepare_58(
                binary=0,
                func_type=kind,
                rsp_node=1,
                rsp_dir=1,
                ref_node=2,
                ref_dir=1,
                data=np.array(data),
                x=np.array(lines),
                id1=response.name[:80],
                id2="SYNTHETIC data" if response.is_synthetic else "NONE",
                id3="NONE",
                id4=" ".join(told) or "NONE",
                id5="NONE",
                rsp_ent_name="NONE",
                ref_ent_name="NONE",
                abscissa_spacing=0,
                abscissa_spec_data_type=FREQUENCY_AXIS,
                ordinate_spec_data_type=0,
                orddenom_spec_data_type=0,
            )
            pyuff.UFF(path).write_sets([entry], mode="add")
        with open(path, "rb") as file:
            return file.read()


WRITERS: Mapping[str, Callable[[MeasuredResponse], bytes]] = {
    ".csv": csv_bytes,
    ".npz": npz_bytes,
    ".uff": universal_bytes,
}
"""Writers by the end of a file's name."""


def measurement_bytes(response: MeasuredResponse, path: str | Path) -> bytes:
    """Return the content of a file of the format its name asks for.

    SF902 for another ending, or when a library for the format is not installed.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        message = f"'{path}': measurements are written to {', '.join(WRITERS)}"
        raise UsageError(Diagnostic("SF902", message))
    return WRITERS[suffix](response)
