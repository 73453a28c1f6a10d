"""The journal of a sweep: a folder beside its file that holds every chunk that is done.

A sweep that was killed goes on where it stopped. Each chunk is written as a whole or not at all, with a
checksum of its sweep, its number and its content; what does not have the right one is solved again. A journal
says which sweep it belongs to, and no other takes it up.
"""

from __future__ import annotations

import json
import os
import shutil
from contextlib import contextmanager
from hashlib import sha256
from typing import TYPE_CHECKING

from symflex.data.measurement.array_files import read_archive
from symflex.errors import Diagnostic, UsageError
from symflex.files.write import write_atomically
from symflex.model.spec.read import read_bytes
from symflex.sweep.files import ARRAYS_LIMIT, SIZE_LIMIT, archive

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from symflex.sweep.design import Rows

SCHEMA = "symflex.sweep.journal/1"
ABOUT = "sweep.json"
ABOUT_LIMIT = 10_000
MAGIC = b"symflex chunk 1\n"


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
        """Return a chunk that was kept, ``None`` where it was not or is not as it was written."""
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
    """Return the journal of the sweep whose result goes to a file: the folder ``FILE.part`` beside it.

    ``key`` is :func:`symflex.sweep.sweep_key`; a fresh journal starts anew, whatever is there. SF916 the
    folder belongs to another sweep, or is not a journal; SF903 it cannot be made.
    """
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
        found = _key_of(about)
        if found is None and any(folder.iterdir()) and not _is_begun(folder):
            message = f"'{folder}' is not a journal of a sweep"
            raise UsageError(Diagnostic("SF916", message, None, "move it away or choose another -o"))
        if found is not None and found != key and not is_fresh:
            message = f"'{folder}' belongs to another sweep, or to another version of symflex"
            hint = "give --fresh to discard it, or choose another -o"
            raise UsageError(Diagnostic("SF916", message, None, hint))
        if is_fresh or found is None:
            _discard(folder)
    folder.mkdir(exist_ok=True)
    for left in folder.glob(".symflex-*.tmp"):
        left.unlink(missing_ok=True)
    if not about.exists():
        text = json.dumps({"schema": SCHEMA, "key": key}, indent=1) + "\n"
        write_atomically(about, text.encode())


def _discard(folder: Path) -> None:
    """Remove a journal; what says whose it is goes last, so that after a kill it is still one."""
    for path in folder.iterdir():
        if path.name == ABOUT:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
    shutil.rmtree(folder)


def _key_of(about: Path) -> str | None:
    try:
        found = json.loads(read_bytes(os.fspath(about), ABOUT_LIMIT).decode())
    except (OSError, ValueError, RecursionError, UsageError):
        return None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        return None
    return str(found.get("key"))


def _is_begun(folder: Path) -> bool:
    """Tell whether a kill came between making a folder and saying whose it is."""
    return all(path.name.startswith(".symflex-") and path.suffix == ".tmp" for path in folder.iterdir())
