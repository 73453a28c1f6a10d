"""Writing a tree of files into one folder, and nowhere else."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.files.write import write_atomically

if TYPE_CHECKING:
    from collections.abc import Mapping


def write_tree(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files into a folder and its subfolders, which are made when they are missing.

    ``folder`` may be a symbolic link, its subfolders not; ``files`` are contents by relative path, ``/``
    between names. Raises ValueError for a path that leads elsewhere; UsageError: SF903 when something cannot
    be written, or a subfolder is a symbolic link.
    """
    for name in files:
        path = PurePosixPath(name)
        if path.is_absolute() or not path.parts or "\\" in name or "\0" in name or ".." in path.parts:
            message = f"{name!r} leads out of the folder"
            raise ValueError(message)
    made: set[Path] = set()
    for name, content in files.items():
        target = Path(folder, *PurePosixPath(name).parts)
        for parent in (folder, *(p for p in reversed(target.parents) if folder in p.parents)):
            if parent not in made:
                _make(parent, is_root=parent == folder)
                made.add(parent)
        write_atomically(target, content)


def _make(folder: Path, *, is_root: bool) -> None:
    name = str(folder)
    try:
        if not is_root and folder.is_symlink():
            raise _unwritable(name, "it is a symbolic link, and links are not written through")
        folder.mkdir(parents=is_root, exist_ok=True)
    except OSError as error:
        raise _unwritable(name, error.strerror or "input/output error") from None
    except ValueError:
        raise _unwritable(name, "the name holds a character no folder can have") from None


def _unwritable(name: str, reason: str) -> UsageError:
    return UsageError(Diagnostic("SF903", f"cannot write into '{name}': {reason}"))
