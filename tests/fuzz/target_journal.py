"""Journals of sweeps: whose they are, and their chunks."""

import shutil
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from symflex.errors import SymflexError
from symflex.sweep.files import FolderJournal, archive, open_journal

ROOMS = ("symflex.sweep.files", "symflex.data.measurement")
ROWS = {"point_status": np.zeros(1, np.int32), "re": np.ones((1, 2))}
ABOUT = b'{"schema": "symflex.sweep.journal/1", "key": "key"}'


@cache
def place():
    """Return a folder to work in."""
    return Path(tempfile.mkdtemp())


def seeds():
    """Return what says whose a journal is, a chunk, and both."""
    journal = FolderJournal(place(), "key")
    journal.write(0, ROWS)
    chunk = (place() / "chunk-000000.npz").read_bytes()
    return [ABOUT + b"\n\n" + chunk, ABOUT + b"\n\n", b"{}\n\n" + chunk, ABOUT + b"\n\n" + archive(ROWS)]


def run(data):
    """Open a journal and read its first chunk: it is as it was written, or is not there."""
    about, _, chunk = data.partition(b"\n\n")
    folder = place() / "a.nc.part"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "sweep.json").write_bytes(about)
    (folder / "chunk-000000.npz").write_bytes(chunk)
    with suppress(SymflexError):
        found = open_journal(place() / "a.nc", "key").read(0)
        if found is not None and not all(np.array_equal(found[name], ROWS[name]) for name in ROWS):
            message = f"read as {found}"
            raise AssertionError(message)
