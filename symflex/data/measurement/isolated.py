"""Files that optional libraries read, each in a process of its own: .xlsx, HDF5 and MATLAB 7.3, .tdms.

Input: the bytes of a file. Output: its arrays by name, or the text of a sheet, one line a row::

    /run/H, complex, chunked and compressed   ->  {"run.H": array}

A damaged HDF5 file of 5 kB ends the process that reads it (h5py 3.16), a workbook of 40 kB may
unpack to gigabytes, and what these libraries raise is listed nowhere. A process of its own has a limit of
memory and of time, and what ends it is one reason. Nothing outside the file is read: soft and external links,
storage in other files and virtual datasets are left out.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from io import BytesIO
from operator import itemgetter
from typing import Any, Final

import numpy as np

from symflex.data.measurement.array_files import DEEPEST, VARIABLES_LIMIT, Arrays, read_archive, require
from symflex.data.measurement.text_table import MAX_CELLS
from symflex.errors.optional import installed

SECONDS: Final = 60
MEMORY: Final = 2**31  # limits of a process [s, bytes]: a sheet of 5 million cells takes 40 s and 1 GB
_CALL: Final = (
    "import sys; sys.path[:] = {}; from symflex.data.measurement.isolated import main; main({!r}, {})"
)


def read_isolated(library: str, data: bytes, limit: int) -> Arrays:
    """Return the arrays that a library finds in a file; a text is the array without a name."""
    installed(library)
    command = [sys.executable, "-c", _CALL.format(sys.path, library, limit)]
    try:
        done = subprocess.run(command, input=data, capture_output=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        raise OverflowError(f"reading it takes more than {SECONDS} s") from None
    reason = done.stderr.decode("utf-8", "replace").strip().rpartition("\n")[2]
    if re.match(r"OverflowError|MemoryError|numpy\..*MemoryError", reason):
        raise OverflowError
    require(not done.returncode, reason if done.returncode > 0 else f"{library} fails on it")
    arrays = read_archive(done.stdout, limit, VARIABLES_LIMIT)
    names = arrays.pop("arr_0").tolist()
    return {name: arrays[f"arr_{i}"] for i, name in enumerate(names, 1)}


def main(library: str, limit: int) -> None:
    """Read a file from standard input, and write its arrays to standard output."""
    with contextlib.suppress(ImportError):  # of Unix
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    found = _LIBRARIES[library](BytesIO(sys.stdin.buffer.read()))
    if sum(array.nbytes for array in found.values()) > limit or len(found) > VARIABLES_LIMIT:
        raise OverflowError
    np.savez(sys.stdout.buffer, np.array(list(found), "U"), *found.values())


def _sheet(file: BytesIO) -> Arrays:
    """Return the sheet with the most rows that begin with a number, as text."""
    book = installed("openpyxl").load_workbook(file, read_only=True, data_only=True)
    best, remaining = (0, [""]), MAX_CELLS
    for sheet in book.worksheets:
        sheet.reset_dimensions()  # those that a file claims would be filled with empty cells
        rows = []
        for row in sheet.values:
            remaining -= len(row) + 1
            if remaining < 0:
                raise OverflowError
            rows.append("\t".join("" if x is None else " ".join(str(x).split()) for x in row))
        best = max(best, (sum(bool(re.match(r"[-+.\d]", row)) for row in rows), rows), key=itemgetter(0))
    return {"": np.frombuffer("\n".join(best[1]).encode(), np.uint8)}


def _datasets(file: BytesIO) -> Arrays:
    """Return the datasets of an HDF5 file with numbers or text."""
    h5py = installed("h5py")
    found: Arrays = {}
    walked = set()

    def walk(group: Any, path: str, depth: int) -> None:  # noqa: ANN401 (a library without types)
        walked.add(group)
        for name in group:
            if not isinstance(group.get(name, getlink=True), h5py.HardLink) or name.startswith("#"):
                continue
            one, key = group[name], f"{path}{name}"
            if isinstance(one, h5py.Group) and depth < DEEPEST and one not in walked:
                walk(one, f"{key}.", depth + 1)
            elif isinstance(one, h5py.Dataset) and not one.external and not one.is_virtual and one.shape:
                if one.dtype.names and len(one.dtype.names) == 2:  # noqa: PLR2004 (MATLAB's complex numbers)
                    values = one[()]
                    found[key] = np.asarray(values[one.dtype.names[0]] + 1j * values[one.dtype.names[1]])
                elif one.attrs.get("MATLAB_class") == b"char":
                    found[key] = np.array("".join(map(chr, one[()].ravel())))
                elif one.dtype.kind in "fciu":
                    found[key] = one[()]
            elif isinstance(one, h5py.Dataset) and h5py.check_string_dtype(one.dtype):
                found[key] = np.array(one.asstr()[()])

    with h5py.File(file, "r") as opened:
        walk(opened, "", 0)
    return {name: np.squeeze(array) for name, array in found.items() if array.dtype.kind in "fciuU"}


def _channels(file: BytesIO) -> Arrays:
    """Return the channels of a .tdms file, and their common axis: a sampling time, or frequencies."""
    channels = [c for g in installed("nptdms").TdmsFile.read(file).groups() for c in g.channels()]
    many = Counter(channel.name for channel in channels)
    found: Arrays = {}
    for c in channels:
        name = c.name if many[c.name] == 1 else f"{c.group_name} {c.name}"
        values, about = np.asarray(c[:]), c.properties
        found |= {name.replace(".", " "): values} if values.dtype.kind in "fciu" else {}
        if step := about.get("wf_increment"):
            is_spectrum = re.search(
                "freq|hz", f"{about.get('wf_xname')} {about.get('wf_xunit_string')}", re.I
            )
            axis = about.get("wf_start_offset", 0.0) + step * np.arange(values.size)
            found |= {"frequency_hz": axis} if is_spectrum else {"dt": np.asarray(step)}
    return found


_LIBRARIES: Final[Mapping[str, Callable[[BytesIO], Arrays]]] = {
    "openpyxl": _sheet, "h5py": _datasets, "nptdms": _channels,
}  # fmt: skip
