"""Where the cache lies: in the user's cache folder, or where an environment variable says."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Final

FOLDER_VARIABLE: Final = "SYMFLEX_CACHE_DIR"
OFF_VARIABLE: Final = "SYMFLEX_NO_CACHE"


def cache_folder() -> Path | None:
    """Return the folder of the cache, ``None`` when it is switched off or the user has no home.

    ``$SYMFLEX_CACHE_DIR``; else ``symflex`` in ``$XDG_CACHE_HOME`` or ``~/.cache``, on macOS in
    ``~/Library/Caches``, on Windows in ``%LOCALAPPDATA%``. Any SYMFLEX_NO_CACHE but "" and "0" switches it
    off.

    Sources: XDG Base Directory Specification 0.8 (2021), which says that relative paths are ignored.
    """
    if os.environ.get(OFF_VARIABLE, "") not in {"", "0"}:
        return None
    named = os.environ.get(FOLDER_VARIABLE, "")
    if named:
        return Path(os.path.abspath(named))
    user = _user_folder()
    return None if user is None else user / "symflex"


def _user_folder() -> Path | None:
    variable = "LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME"
    given = os.environ.get(variable, "")
    if os.path.isabs(given):
        return Path(given)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    # Accounts of services have a home that does not exist, and should not.
    if not home.is_absolute() or not home.is_dir():
        return None
    if sys.platform == "win32":
        return home / "AppData" / "Local"
    return home / ("Library/Caches" if sys.platform == "darwin" else ".cache")
