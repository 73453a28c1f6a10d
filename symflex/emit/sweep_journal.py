"""The journal of a sweep: a folder beside its file that holds every chunk that is done.

A sweep that was killed goes on where it stopped. Each chunk is written as a whole or not at all, so what is
there is good; a journal says which sweep it belongs to, and no other takes it up.
"""

from __future__ import annotations

import json
import shutil
import zipfile
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from symflex.emit.sweep_files import archive
from symflex.emit.write import write_atomically
from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from symflex.sweep.task import Rows

SCHEMA = "symflex.sweep.journal/1"
ABOUT = "sweep.json"


class FolderJournal:
    """Keeps chunks in a folder; see :func:`open_journal`.

    Parameters
    ----------
    folder : Path
        That exists and belongs to the sweep.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @property
    def kept(self) -> int:
        """How many chunks are kept."""
        return sum(1 for _ in self.folder.glob("chunk-*.npz"))

    def read(self, chunk: int) -> Rows | None:
        """Return a chunk that was kept, ``None`` where it was not or cannot be read."""
        try:
            data = self._path(chunk).read_bytes()
            with np.load(BytesIO(data), allow_pickle=False) as file:
                return {name: file[name] for name in file.files}
        except (FileNotFoundError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None

    def write(self, chunk: int, rows: Rows) -> None:
        """Keep a chunk."""
        write_atomically(self._path(chunk), archive(rows))

    def remove(self) -> None:
        """Delete the folder, when the result is safe."""
        shutil.rmtree(self.folder)

    def _path(self, chunk: int) -> Path:
        return self.folder / f"chunk-{chunk:06d}.npz"


def open_journal(output: Path, key: str, *, is_fresh: bool = False) -> FolderJournal:
    """Return the journal of the sweep whose result goes to a file: the folder ``FILE.part`` beside it.

    Parameters
    ----------
    output : Path
        Where the result goes.
    key : str
        Of the sweep, see :func:`symflex.sweep.sweep_key`.
    is_fresh : bool
        Start anew, whatever is there.

    Raises
    ------
    UsageError
        SF916 the folder belongs to another sweep, or is no journal; SF903 it cannot be made.
    """
    folder = output.with_name(output.name + ".part")
    about = folder / ABOUT
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise UsageError(Diagnostic("SF916", f"'{folder}' is no journal of a sweep", None, "move it away"))
    if folder.is_dir():
        found = _key_of(about)
        if found is None and any(folder.iterdir()) and not _is_begun(folder):
            message = f"'{folder}' is no journal of a sweep"
            raise UsageError(Diagnostic("SF916", message, None, "move it away or choose another -o"))
        if found is not None and found != key and not is_fresh:
            message = f"'{folder}' belongs to another sweep, or to another version of symflex"
            hint = "give --fresh to discard it, or choose another -o"
            raise UsageError(Diagnostic("SF916", message, None, hint))
        if is_fresh or found is None:
            shutil.rmtree(folder)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise UsageError(Diagnostic("SF903", f"cannot write '{folder}': {error.strerror}")) from None
    for left in folder.glob(".symflex-*.tmp"):
        left.unlink(missing_ok=True)
    if not about.exists():
        text = json.dumps({"schema": SCHEMA, "key": key}, indent=1) + "\n"
        write_atomically(about, text.encode())
    return FolderJournal(folder)


def _key_of(about: Path) -> str | None:
    try:
        found = json.loads(about.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        return None
    return str(found.get("key"))


def _is_begun(folder: Path) -> bool:
    """Tell whether a kill came between making a folder and saying whose it is."""
    return all(path.name.startswith(".symflex-") and path.suffix == ".tmp" for path in folder.iterdir())
