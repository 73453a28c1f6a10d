"""One process at a time works on a file: who comes second is told who holds it, or waits."""

from __future__ import annotations

import os
import platform
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from symflex.errors import Diagnostic, UsageError

MARK = b"symflex: "
SHOWN = 200
FLAGS = os.O_RDWR | os.O_CREAT
for _name in ("O_NOFOLLOW", "O_CLOEXEC", "O_NONBLOCK"):
    FLAGS |= getattr(os, _name, 0)


@contextmanager
def held(path: Path, *, waits: bool = False) -> Iterator[None]:
    """Hold a file, or folder, while the context lasts; it needs not exist, but its folder does.

    The lock is the operating system's, on the file ``PATH.lock`` beside it, so it ends with the process
    however that ends; what a kill leaves of the file locks nothing. Windows, which has none, goes without.
    ``waits`` says whether to wait for another process rather than refuse: SF919.
    """
    if sys.platform == "win32":
        yield
        return
    lock = path.with_name(path.name + ".lock")
    try:
        descriptor = _locked(path, lock, waits=waits)
    except OSError as error:
        raise UsageError(Diagnostic("SF903", f"cannot write '{lock}': {error.strerror}")) from None
    try:
        yield
    finally:
        # Whoever waits for it finds that the file at this path is another, and begins anew.
        lock.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(path: Path, lock: Path, *, waits: bool) -> int:
    """Return the descriptor of a lock file that is locked and still stands at its path."""
    import fcntl  # Windows has none

    while True:
        descriptor = os.open(lock, FLAGS, 0o666)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise _foreign(lock)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB))
            except BlockingIOError:
                raise _taken(path, os.pread(descriptor, SHOWN, 0)) from None
            mark = os.pread(descriptor, SHOWN, 0)
            if mark and not mark.startswith(MARK):
                raise _foreign(lock)
            if _is_at(lock, descriptor):
                now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
                said = f"process {os.getpid()} on {platform.node() or 'this computer'} since {now}\n"
                os.ftruncate(descriptor, 0)
                os.pwrite(descriptor, MARK + said.encode(), 0)
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _is_at(lock: Path, descriptor: int) -> bool:
    try:
        there = os.stat(lock, follow_symlinks=False)
    except FileNotFoundError:
        return False
    return os.path.samestat(there, os.fstat(descriptor))


def _taken(path: Path, content: bytes) -> UsageError:
    who = content.removeprefix(MARK).decode(errors="replace").strip() or "another process"
    hint = "wait until it ends, or choose another -o"
    return UsageError(Diagnostic("SF919", f"'{path}' is being written by {who}", None, hint))


def _foreign(lock: Path) -> UsageError:
    return UsageError(Diagnostic("SF903", f"cannot write '{lock}': it exists and is not a lock of symflex"))
