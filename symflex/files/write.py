"""Writing a file as a whole or not at all."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path, PurePosixPath

from symflex.errors import Diagnostic, UsageError

PERMISSIONS = 0o666
LINK = "it is a symbolic link, and symflex does not write through links"


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file so that at every moment its path holds the old content or the new, never a part.

    The data go to a temporary file in the same folder, reach the disk, and then take the place of ``path``.
    An existing file keeps its permissions; a new one gets those of the process's umask. SF903 with the reason
    leaves the old content, if any, and no temporary file.
    """
    with _refusals(os.fspath(path)):
        _write(Path(path), data)


def check_writable(path: Path) -> None:
    """Refuse, before anything is computed for it, a file that could not be written afterwards: SF903."""
    name = os.fspath(path)
    with _refusals(name):
        _mode_of_regular_file(path)
        if not path.parent.is_dir():
            raise FileNotFoundError
    _check_entry(path.parent, name)


def check_folder(folder: Path) -> None:
    """Refuse, before anything is computed for it, a folder that could not be made or written into: SF903."""
    name = os.fspath(folder)
    if folder.exists() and not folder.is_dir():
        raise _unwritable(name, "it is not a folder")
    nearest = next((parent for parent in (folder, *folder.parents) if parent.exists()), Path())
    if not nearest.is_dir():
        raise _unwritable(name, f"'{nearest}' is not a folder")
    _check_entry(nearest, name)


def _check_entry(folder: Path, name: str) -> None:
    if not os.access(folder, os.W_OK | os.X_OK):
        raise _unwritable(name, f"nothing can be written into '{folder}'")


def write_tree(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files into a folder and its subfolders, which are made when they are missing.

    ``folder`` may be a symbolic link, its subfolders not; ``files`` are contents by relative path, ``/``
    between names. ValueError for a path that leads elsewhere; SF903 when something cannot be written.
    """
    for name in files:
        path = PurePosixPath(name)
        if path.is_absolute() or not path.parts or "\\" in name or "\0" in name or ".." in path.parts:
            raise ValueError(f"{name!r} leads out of the folder")
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
    with _refusals(name, into=True):
        if not is_root and folder.is_symlink():
            raise _unwritable(name, LINK, into=True)
        folder.mkdir(parents=is_root, exist_ok=True)


def _write(path: Path, data: bytes) -> None:
    mode = _mode_of_regular_file(path)
    temporary = path.parent / f".symflex-{secrets.token_hex(8)}.tmp"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    for name_of_flag in ("O_NOFOLLOW", "O_CLOEXEC", "O_BINARY"):
        flags |= getattr(os, name_of_flag, 0)
    descriptor = os.open(temporary, flags, PERMISSIONS)
    try:
        with open(descriptor, "wb") as file:
            if mode is not None:
                os.chmod(temporary, mode)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    _sync_folder(path.parent)


def _mode_of_regular_file(path: Path) -> int | None:
    """Return the permissions of the file that would be replaced, None when there is none."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return None
    if stat.S_ISLNK(mode):
        raise _unwritable(os.fspath(path), LINK)
    if not stat.S_ISREG(mode):
        raise _unwritable(os.fspath(path), "it is not a regular file")
    return stat.S_IMODE(mode)


def _sync_folder(folder: Path) -> None:
    """Make the new name survive a power failure, where the system can do so."""
    directory_flag = getattr(os, "O_DIRECTORY", None)
    if directory_flag is None:
        return
    descriptor = os.open(folder, os.O_RDONLY | directory_flag)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def free_name(stem: str, taken: Iterable[str], suffix: str = "") -> str:
    """Return a file's name that is not taken, not even where capitals count as small letters.

    >>> free_name("Beam", ["beam.csv"], ".csv")
    'Beam_2.csv'
    """
    small = {name.lower() for name in taken}
    offered = (f"{stem}{'' if number == 1 else f'_{number}'}{suffix}" for number in count(1))
    return next(name for name in offered if name.lower() not in small)


@contextmanager
def _refusals(name: str, *, into: bool = False) -> Iterator[None]:
    """Report what the system refuses in the program's words, SF903."""
    try:
        yield
    except FileNotFoundError:
        reason = f"there is no folder '{os.path.dirname(name.rstrip('/')) or '.'}'"
    except OSError as error:
        reason = error.strerror or "input/output error"
    except ValueError:
        reason = f"the name contains a character that {'folders' if into else 'file names'} cannot have"
    else:
        return
    raise _unwritable(name, reason, into=into)


def _unwritable(name: str, reason: str, *, into: bool = False) -> UsageError:
    return UsageError(Diagnostic("SF903", f"cannot write {'into ' * into}'{name}': {reason}"))
