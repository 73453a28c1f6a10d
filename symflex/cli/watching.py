"""``--watch``: a command that runs again whenever its file is saved, until Ctrl-C."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import sleep
from typing import Final

import click

from symflex.cli.reporting import note

PAUSE: Final = 0.2  # seconds between looks at the files; a person does not notice it
MOST_FILES: Final = 200  # of the folder that are looked at


def watched(path: str, run: Callable[[], int]) -> int:
    """Run at once, and again after each change of a file or of another specification beside it."""
    seen = None
    try:
        while True:
            if (state := _state(path)) != seen:
                if seen is not None and sys.stdout.isatty():
                    click.clear()
                seen = state
                run()
                sys.stdout.flush()
                note(f"watching {path}; stop with Ctrl-C")
            sleep(PAUSE)
    except KeyboardInterrupt:
        return 0


def _state(path: str) -> tuple[tuple[str, int, int], ...]:
    """Return names, times and sizes of a file and of those of its kind beside it."""
    suffix, folder = Path(path).suffix, os.path.dirname(path) or "."
    try:
        with os.scandir(folder) as entries:
            names = sorted(e.path for e in entries if e.name.endswith(suffix))[:MOST_FILES]
    except OSError:
        names = []
    found = []
    for name in dict.fromkeys([path, *names]):
        try:
            one = os.stat(name)
        except OSError:
            continue  # between two steps of an editor that saves
        found.append((name, one.st_mtime_ns, one.st_size))
    return tuple(found)
