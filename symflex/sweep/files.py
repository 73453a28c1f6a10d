"""Sweeps as files: netCDF and .npz with named axes, CSV and Parquet as tables; equal sweeps, equal bytes.

While one is solved, a journal beside its file, a folder, holds every chunk that is done: a sweep that was
killed goes on where it stopped. Each chunk is written as a whole or not at all, with a checksum of its sweep,
its number and its content; what does not have the right one is solved again. A journal says which sweep it
belongs to, and no other takes it up.
"""

from __future__ import annotations

import csv
import json
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np

from symflex.data.measurement.array_files import read_archive, read_netcdf, require
from symflex.errors import DataError, Diagnostic, UsageError, refused
from symflex.errors.optional import installed
from symflex.files import write
from symflex.files.write import write_atomically
from symflex.model.spec.read import read_bytes
from symflex.sweep.design import Array, Rows
from symflex.sweep.labelled import DRAW, FREQUENCY, MODE, SCHEMA, STABILITY, Labelled, Sweep
from symflex.sweep.points import MARGINS, VERDICTS

NEW_YEAR = (1980, 1, 1, 0, 0, 0)  # the date of every file in an archive
SIZE_LIMIT = 2**30  # bytes of a file that is read, and of what it contains
ARRAYS_LIMIT = 10_000
HEADER = "header"
CHARACTERS = "characters"
_ROOTS = ("re", "im", "radius", "status", "link", "multiplicity", "frequency_hz", "damping_ratio")
ARRAYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "poles": ((MODE,), _ROOTS),
    "zeros": ((MODE,), _ROOTS),
    "response": ((FREQUENCY,), ("re", "im")),
    "margins": ((), (*MARGINS, "stable")),
}  # the axes that arrays have besides that of points, and their names, by what is swept


def archive(arrays: Mapping[str, Array]) -> bytes:
    """Return arrays as the content of an .npz file without dates."""
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as file:
        for name, values in arrays.items():
            content = BytesIO()
            np.lib.format.write_array(content, np.asarray(values, order="C"), allow_pickle=False)
            file.writestr(zipfile.ZipInfo(f"{name}.npy", NEW_YEAR), content.getvalue())
    return buffer.getvalue()


def npz_bytes(sweep: Sweep) -> bytes:
    """Return a sweep as an .npz; its entry ``header`` is JSON and says which axes the arrays have."""
    every = (*sweep.coordinates, *sweep.variables)
    header = {
        "attributes": dict(sweep.attributes),
        "coordinates": [c.name for c in sweep.coordinates],
        "arrays": {e.name: {"dims": e.dims, "unit": e.unit, "doc": e.doc} for e in every},
    }
    return archive({HEADER: np.array(json.dumps(header, indent=1)), **{e.name: e.values for e in every}})


def netcdf_bytes(sweep: Sweep) -> bytes:
    """Return a sweep as netCDF 3, with 64-bit offsets, as xarray, MATLAB, Julia and R read it."""
    from scipy.io import netcdf_file  # most commands write none

    buffer = _Unclosed()
    file = netcdf_file(buffer, "w", version=2)
    for name, value in sweep.attributes:
        setattr(file, name, value.encode())
    every = (*sweep.coordinates, *sweep.variables)
    for dim, size in dict(d for e in every for d in zip(e.dims, e.values.shape, strict=True)).items():
        file.createDimension(dim, size)
    for each in every:
        values, dims = each.values, each.dims
        if values.dtype.kind == "U":
            width = max(values.dtype.itemsize // 4, 1)
            if CHARACTERS not in file.dimensions:
                file.createDimension(CHARACTERS, width)
            values = values.astype(f"S{width}").view("S1").reshape(*values.shape, width)
            dims = (*dims, CHARACTERS)
        # netCDF 3 has no integers of 64 bits.
        stored = np.dtype(np.int32) if values.dtype == np.int64 else values.dtype
        variable = file.createVariable(each.name, stored, dims)
        variable[...] = values
        for name, value in (("units", each.unit), ("long_name", each.doc)):
            if value:
                setattr(variable, name, value.encode())
    file.close()
    return buffer.content


class _Unclosed(BytesIO):
    """Keeps its content when the writer closes it."""

    content = b""

    def close(self) -> None:
        self.content = self.getvalue()
        super().close()


def csv_bytes(sweep: Sweep) -> bytes:
    """Return a sweep as comma-separated text: a row for each point and mode or frequency."""
    names, columns = _table(sweep)
    buffer = StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(names)
    # The shortest decimal that is read back as the same double.
    texts = ([repr(x) if isinstance(x, float) else str(x) for x in column.tolist()] for column in columns)
    writer.writerows(zip(*texts, strict=True))
    return buffer.getvalue().encode()


def parquet_bytes(sweep: Sweep) -> bytes:
    """Return the same table as Apache Parquet; SF914 when pyarrow is not installed."""
    pyarrow, parquet = installed("pyarrow"), installed("pyarrow.parquet")
    names, columns = _table(sweep)
    table = pyarrow.table(dict(zip(names, columns, strict=True)))
    table = table.replace_schema_metadata(dict(sweep.attributes))
    buffer = BytesIO()
    parquet.write_table(table, buffer)
    return buffer.getvalue()


def _table(sweep: Sweep) -> tuple[list[str], list[Array]]:
    """Return names and columns of a long table: one row for each element of the largest arrays."""
    largest = max(sweep.variables, key=lambda v: len(v.dims))
    dims, shape = largest.dims, largest.values.shape
    columns: dict[str, Array] = {}
    for each in (*sweep.coordinates, *sweep.variables):
        values = each.values.reshape([shape[dims.index(d)] if d in each.dims else 1 for d in dims])
        columns[each.name] = np.broadcast_to(values, shape).reshape(-1)
    if "status" in columns:
        # What is absent needs no row, unless a point has nothing else.
        first = np.zeros(shape, bool)
        first[..., :1] = ~np.any(sweep["status"], axis=-1, keepdims=True)
        kept = (columns["status"] > 0) | first.reshape(-1)
        columns = {name: column[kept] for name, column in columns.items()}
    return list(columns), list(columns.values())


WRITERS: dict[str, Callable[[Sweep], bytes]] = {  # writers by the ending of a file's name
    ".nc": netcdf_bytes,
    ".npz": npz_bytes,
    ".csv": csv_bytes,
    ".parquet": parquet_bytes,
}


def check_writable(path: Path) -> None:
    """Refuse, before anything is computed, a file that cannot be written: SF902, SF903 or SF914."""
    if path.suffix.lower() not in WRITERS:
        raise refused(f"'{path.name}' must end in {', '.join(WRITERS)}")
    if path.suffix.lower() == ".parquet":
        installed("pyarrow")
    write.check_writable(path)


def sweep_bytes(sweep: Sweep, suffix: str) -> bytes:
    """Return a sweep as the content of a file with that ending."""
    return WRITERS[suffix.lower()](sweep)


def read_sweep(path: str | Path) -> Sweep:
    """Read a sweep that was written as netCDF or .npz; SF901 no such file, SF915 it contains no sweep."""
    file = Path(path)
    try:
        data = read_bytes(os.fspath(file), SIZE_LIMIT)
    except OSError as error:
        raise UsageError(Diagnostic("SF901", f"cannot read '{path}': {error.strerror}")) from None
    except ValueError:
        raise UsageError(Diagnostic("SF901", f"cannot read '{str(path)!r}'")) from None
    try:
        if len(data) > SIZE_LIMIT:
            raise OverflowError
        sweep = _from_npz(data) if data[:2] == b"PK" else _from_netcdf(data)
    except OverflowError:
        raise _no_sweep(path, f"it is larger than {SIZE_LIMIT} bytes, or contains too many arrays") from None
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError) as error:
        raise _no_sweep(path, str(error)) from None
    if sweep.attribute("schema") != SCHEMA:
        raise _no_sweep(path, "it is not marked as one")
    return sweep


def _no_sweep(path: str | Path, reason: str) -> DataError:
    said = "".join(c for c in reason if c.isprintable())[:100]
    hint = "it reads what 'symflex sweep -o' writes as .nc or .npz"
    return DataError(Diagnostic("SF915", f"'{path}' contains no sweep: {said}", None, hint))


def _from_npz(data: bytes) -> Sweep:
    entries = read_archive(data, SIZE_LIMIT, ARRAYS_LIMIT)
    header = json.loads(str(entries[HEADER]))
    arrays = [
        Labelled(str(name), tuple(map(str, of["dims"])), entries[name], str(of["unit"]), str(of["doc"]))
        for name, of in header["arrays"].items()
    ]
    return _sweep(header["attributes"], arrays, set(header["coordinates"]))


def _from_netcdf(data: bytes) -> Sweep:
    attributes, variables = read_netcdf(data, ARRAYS_LIMIT)
    arrays = [
        Labelled(name, *_texts_joined(dims, values), about.get("units", ""), about.get("long_name", ""))
        for name, (dims, values, about) in variables.items()
    ]
    reserved = {*attributes.get("parameters", "").split(), "mode", "frequency", "draw"}
    return _sweep(attributes, arrays, reserved)


def _texts_joined(dims: tuple[str, ...], values: Array) -> tuple[tuple[str, ...], Array]:
    """Return an array with characters put together to texts, in this computer's byte order."""
    if dims and dims[-1] == CHARACTERS and values.shape[-1]:
        width = values.shape[-1]
        joined = np.ascontiguousarray(values).view(f"S{width}").reshape(values.shape[:-1])
        return dims[:-1], joined.astype(f"<U{width}")
    return dims, values.astype(values.dtype.newbyteorder("="))


def _sweep(attributes: Mapping[str, str], arrays: list[Labelled], coordinates: set[str]) -> Sweep:
    """Return a sweep, with every array that one of its kind has, in its shape; ValueError if one lacks."""
    sizes: dict[str, int] = {}
    for each in arrays:
        for dim, size in zip(each.dims, each.values.shape, strict=True):
            require(sizes.setdefault(dim, size) == size, f"arrays disagree about the length of '{dim}'")
    sweep = Sweep(
        tuple((str(k), str(v)) for k, v in attributes.items()),
        tuple(each for each in arrays if each.name in coordinates),
        tuple(each for each in arrays if each.name not in coordinates),
    )
    arrays_by_name = {each.name: each for each in (*sweep.coordinates, *sweep.variables)}
    is_known = sweep.of in ARRAYS and "point_status" in arrays_by_name
    require(is_known, f"it contains no {sweep.of[:40] or 'results'} with their status")
    own, names = ARRAYS[sweep.of]
    points = arrays_by_name["point_status"].dims
    swept = sweep.attribute("parameters").split()
    expected = {name: (points + own, "fiub") for name in names} | {dim: ((dim,), "fiu") for dim in own}
    expected |= {"point_status": (points, "fiu"), "code": (points, "U")}
    if any(name in arrays_by_name for name in STABILITY):  # files of earlier versions hold none of them
        expected |= dict.fromkeys(STABILITY, (points, "iu"))
    expected |= {
        name: ((DRAW,) if (name,) != arrays_by_name[name].dims else (name,), "fiu") for name in swept
    }
    for name, (dims, kinds) in expected.items():
        fits = (
            name in arrays_by_name
            and arrays_by_name[name].dims == dims
            and arrays_by_name[name].values.dtype.kind in kinds
        )
        require(fits, f"'{name[:40]}' is missing, or of another shape or kind")
    words = arrays_by_name["verdict"].values if "verdict" in arrays_by_name else 0
    require(bool(np.all((words >= 0) & (words < len(VERDICTS)))), "a verdict on stability is not a known one")
    are_swept = set(points) <= {*swept, DRAW} and 0 not in arrays_by_name["point_status"].values.shape
    require(are_swept, "its axes are not parameters, or are empty")
    return sweep


JOURNAL_SCHEMA = "symflex.sweep.journal/1"
ABOUT = "sweep.json"
ABOUT_LIMIT = 10_000
MAGIC = b"symflex chunk 2\n"


class FolderJournal:
    """Keeps chunks in a folder that belongs to the sweep with this key; see :func:`open_journal`."""

    def __init__(self, folder: Path, key: str) -> None:
        self.folder = folder
        self.key = key

    @property
    def kept(self) -> int:
        """How many chunks are kept."""
        return sum(1 for _ in self.folder.glob("chunk-*.npz"))

    def read(self, chunk: int) -> Rows | None:
        """Return a chunk that was kept, ``None`` if it was not or is not as it was written."""
        try:
            data = read_bytes(os.fspath(self._path(chunk)), SIZE_LIMIT)
            content = data[len(self._head(chunk, b"")) :]
            if not content or data != self._head(chunk, content) + content:
                return None
            return read_archive(content, SIZE_LIMIT, ARRAYS_LIMIT)
        except (OSError, ValueError, OverflowError, UsageError):
            return None

    def write(self, chunk: int, rows: Rows) -> None:
        """Keep a chunk."""
        content = archive(rows)
        write_atomically(self._path(chunk), self._head(chunk, content) + content)

    def _head(self, chunk: int, content: bytes) -> bytes:
        return MAGIC + sha256(f"{self.key} {chunk}\n".encode() + content).digest()

    def remove(self) -> None:
        """Delete the folder, when the result is safe."""
        with _writing(self.folder):
            _discard(self.folder)

    def _path(self, chunk: int) -> Path:
        return self.folder / f"chunk-{chunk:06d}.npz"


def open_journal(output: Path, key: str, *, is_fresh: bool = False) -> FolderJournal:
    """Return the journal ``FILE.part`` of the sweep with this key; SF916 when it belongs to another."""
    folder = output.with_name(output.name + ".part")
    with _writing(folder):
        _prepare(folder, key, is_fresh=is_fresh)
    return FolderJournal(folder, key)


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        message = f"cannot write '{folder}': {error.strerror or 'input/output error'}"
        raise UsageError(Diagnostic("SF903", message)) from None


def _prepare(folder: Path, key: str, *, is_fresh: bool) -> None:
    about = folder / ABOUT
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise UsageError(Diagnostic("SF916", f"'{folder}' is not a journal of a sweep", None, "move it away"))
    if folder.is_dir():
        own_key = _key_of(about)
        # A kill may have come between making a folder and saying whose it is.
        if own_key is None and not all(path.match(".symflex-*.tmp") for path in folder.iterdir()):
            message = f"'{folder}' is not a journal of a sweep"
            raise UsageError(Diagnostic("SF916", message, None, "move it away or choose another -o"))
        if own_key is not None and own_key != key and not is_fresh:
            message = f"'{folder}' belongs to another sweep, or to another version of symflex"
            hint = "give --fresh to discard it, or choose another -o"
            raise UsageError(Diagnostic("SF916", message, None, hint))
        if is_fresh or own_key is None:
            _discard(folder)
    folder.mkdir(exist_ok=True)
    for left in folder.glob(".symflex-*.tmp"):
        left.unlink(missing_ok=True)
    if not about.exists():
        text = json.dumps({"schema": JOURNAL_SCHEMA, "key": key}, indent=1) + "\n"
        write_atomically(about, text.encode())


def _discard(folder: Path) -> None:
    """Remove a journal; what says whose it is goes last, so that after a kill it is still one."""
    for path in folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path.name != ABOUT:
            path.unlink()
    shutil.rmtree(folder)


def _key_of(about: Path) -> str | None:
    try:
        journal = json.loads(read_bytes(os.fspath(about), ABOUT_LIMIT).decode())
    except (OSError, ValueError, RecursionError, UsageError):
        return None
    if not isinstance(journal, dict) or journal.get("schema") != JOURNAL_SCHEMA:
        return None
    return str(journal.get("key"))
