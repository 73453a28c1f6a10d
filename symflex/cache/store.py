"""A folder of entries, each a file that is there as a whole or counts as not there."""

from __future__ import annotations

import hashlib
import os
import re
import stat
import tempfile
import time
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

MAXIMUM_BYTES: Final = 256 * 2**20
"""Size of all entries together; beyond it those that were not used for longest are removed."""
MAXIMUM_ENTRY: Final = 32 * 2**20
"""Size of an entry on disk."""
MAXIMUM_CONTENT: Final = 256 * 2**20
"""Size of an entry's content: no file makes more of itself in memory."""
SECONDS: Final = 0.05
"""What took less to derive is not kept."""
UNKNOWNS: Final = 8
"""Systems of fewer unknowns are not looked for, unless distributed: they are derived in less time."""
ABANDONED_SECONDS: Final = 3600
"""Age at which a temporary file was left by a process that is gone."""

_NAME: Final = re.compile(r"[0-9a-f]{64}\.sfd")
_TEMPORARY: Final = re.compile(r"[0-9a-f]{64}\.[0-9a-f]{16}\.tmp")
_MAGIC: Final = b"symflex derivation 1\n"
_HEAD: Final = len(_MAGIC) + 2 * hashlib.sha256().digest_size
# Not every platform has all of them.
_NO_LINK, _NO_WAIT, _BINARY = (getattr(os, name, 0) for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"))
_READING: Final = os.O_RDONLY | _NO_LINK | _NO_WAIT | _BINARY
_WRITING: Final = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY


@dataclass(frozen=True, slots=True)
class Usage:
    """How many entries there are, and their size in bytes."""

    entries: int
    size: int


@dataclass(frozen=True, slots=True)
class Store:
    """Entries by key, in one folder.

    An entry is its key and the checksum of both key and content, then the compressed content. It is written
    to a temporary file that takes its place at once, so that processes that write the same key do not
    disturb each other. What is not such a file, or does not belong to the user, is treated as missing.

    Parameters
    ----------
    folder : str or Path
        Made when something is first written.
    seconds : float
        What took less to derive is not kept; 0 to keep everything.
    maximum : int
        Bytes of all entries together.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = Store(folder)
    ...     store.write("ab" * 32, b"content")
    ...     store.read("ab" * 32), store.read("cd" * 32)
    (b'content', None)
    """

    folder: str | Path
    seconds: float = SECONDS
    maximum: int = MAXIMUM_BYTES

    @property
    def unknowns(self) -> int:
        """Lumped systems of fewer unknowns are not looked for."""
        return UNKNOWNS if self.seconds else 0

    def read(self, key: str) -> bytes | None:
        """Return the content of an entry, ``None`` when there is none that is sound."""
        path = self._path(key)
        try:
            data = _read(path)
        except (OSError, ValueError):
            return None
        content = None if data is None else _unpacked(key, data)
        if content is not None:
            with suppress(OSError):
                os.utime(path)  # used last is removed last
        return content

    def write(self, key: str, content: bytes) -> None:
        """Keep a content; nothing happens when that cannot be."""
        if len(content) > MAXIMUM_CONTENT:
            return
        data = _packed(key, content)
        if len(data) > min(MAXIMUM_ENTRY, self.maximum):
            return
        path = self._path(key)
        temporary = path.with_name(f"{key}.{os.urandom(8).hex()}.tmp")
        try:
            Path(self.folder).mkdir(mode=0o700, parents=True, exist_ok=True)
            with os.fdopen(os.open(temporary, _WRITING, 0o600), "wb") as file:
                file.write(data)
            os.replace(temporary, path)
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                temporary.unlink()
            return
        self._make_room()

    def is_writable(self) -> bool:
        """Tell whether something can be kept, by trying: permissions alone do not say it.

        A folder is made and removed at once, where the entries stand or would.
        """
        try:
            place = Path(os.path.abspath(self.folder))
            while not os.path.lexists(place):
                place = place.parent
            os.rmdir(tempfile.mkdtemp(prefix=".symflex-", dir=place))
        except (OSError, ValueError):
            return False
        return True

    def usage(self) -> Usage:
        """Return how many entries there are and what they take."""
        found = self._entries()
        return Usage(len(found), sum(size for _, size, _ in found))

    def clear(self) -> Usage:
        """Remove all entries and temporary files, and nothing else; return what was removed."""
        entries = size = 0
        for _, bytes_, path in self._entries():
            with suppress(OSError):
                path.unlink()
                entries, size = entries + 1, size + bytes_
        self._remove_abandoned(0)
        return Usage(entries, size)

    def _path(self, key: str) -> Path:
        return Path(self.folder) / f"{key}.sfd"

    def _entries(self) -> list[tuple[float, int, Path]]:
        """Return the time of last use [s], the size and the path of every entry, oldest first."""
        return sorted(self._files(_NAME))

    def _files(self, pattern: re.Pattern[str]) -> list[tuple[float, int, Path]]:
        found = []
        with suppress(OSError, ValueError), os.scandir(self.folder) as listed:
            for item in listed:
                # Another process may remove it meanwhile.
                with suppress(OSError):
                    if pattern.fullmatch(item.name) and item.is_file(follow_symlinks=False):
                        status = item.stat(follow_symlinks=False)
                        found.append((status.st_mtime, status.st_size, Path(item.path)))
        return found

    def _make_room(self) -> None:
        entries = self._entries()
        excess = sum(size for _, size, _ in entries) - self.maximum
        for _, size, path in entries:
            if excess <= 0:
                break
            with suppress(OSError):
                path.unlink()
            excess -= size
        self._remove_abandoned(ABANDONED_SECONDS)

    def _remove_abandoned(self, age: float) -> None:
        now = time.time()
        for changed, _, path in self._files(_TEMPORARY):
            if now - changed >= age:
                with suppress(OSError):
                    path.unlink()


def _read(path: Path) -> bytes | None:
    """Return a file's bytes; ``None`` for what is no file of this user, or too large."""
    with os.fdopen(os.open(path, _READING), "rb") as file:
        status = os.fstat(file.fileno())
        is_own = not hasattr(os, "geteuid") or status.st_uid == os.geteuid()
        if not stat.S_ISREG(status.st_mode) or not is_own or status.st_size > MAXIMUM_ENTRY:
            return None
        return file.read(MAXIMUM_ENTRY + 1)


def _digest(key: str, content: bytes) -> bytes:
    return hashlib.sha256(bytes.fromhex(key) + content).digest()


def _packed(key: str, content: bytes) -> bytes:
    return _MAGIC + bytes.fromhex(key) + _digest(key, content) + zlib.compress(content, 1)


def _unpacked(key: str, data: bytes) -> bytes | None:
    """Return the content of an entry's bytes, ``None`` unless all of it is as it was written."""
    start = _MAGIC + bytes.fromhex(key)
    if not data.startswith(start):
        return None
    stream = zlib.decompressobj()
    try:
        content = stream.decompress(data[_HEAD:], MAXIMUM_CONTENT)
    except zlib.error:
        return None
    is_whole = stream.eof and not stream.unused_data
    return content if is_whole and _digest(key, content) == data[len(start) : _HEAD] else None
