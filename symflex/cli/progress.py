"""A bar on stderr for what takes longer than a second, and the time where nothing says how far it is."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isnan
from time import monotonic
from typing import TextIO

DELAY = 1.0  # seconds before anything is drawn: what is done by then needs no bar
INTERVAL = 0.1  # seconds between two drawings
FIRST_WORD = 2.0  # seconds before a command without a bar says that it works
COLUMNS = 79
BAR = 20


class ProgressBar:
    """One line that shows how far a computation is, and erases itself.

    It is drawn on terminals only, not before a second has passed, and not when ``NO_COLOR`` is set or the
    terminal is a ``dumb`` one: both stand for lines that are not rewritten.
    """

    def __init__(self, stream: TextIO | None = None, clock: Callable[[], float] = monotonic) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._clock = clock
        self._is_shown = _is_rewritable(self._stream)
        self._next = clock() + DELAY
        self._drawn = 0

    def report(self, done: float, text: str) -> None:
        """Say which part of the computation is done, from 0 to 1, and what is being done."""
        if not self._is_shown:
            return
        now = self._clock()
        if now < self._next:
            return
        self._next = now + INTERVAL
        part = 0.0 if isnan(done) else min(max(done, 0.0), 1.0)
        filled = int(part * BAR)
        shown = "".join(c if " " <= c <= "~" else "?" for c in text)
        line = f"[{'#' * filled}{'-' * (BAR - filled)}] {int(part * 100):3d} %  {shown}"
        self._draw(line[:COLUMNS].rstrip())

    def close(self) -> None:
        """Erase the bar; nothing is drawn afterwards."""
        if self._drawn:
            self._write(f"\r{' ' * self._drawn}\r")
            _give_way(to_bar=False)
        self._drawn = 0
        self._is_shown = False

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _draw(self, line: str) -> None:
        # What was longer before is covered with blanks.
        _give_way(to_bar=True)
        self._write(f"\r{line.ljust(self._drawn)}")
        self._drawn = len(line)

    def _write(self, text: str) -> None:
        with hushed():
            self._stream.write(text)
            self._stream.flush()


class Waiting:
    """Seconds on stderr while a command works and no bar has been drawn; erased before anything is printed.

    A timer of the process draws it, as a computation that reports nothing calls nothing. Only a command that
    was started as a program has one, and on terminals only.
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self.drawn = 0
        self.is_hushed = False
        self.has_bar = False
        self._begin = self._spoken = monotonic()

    def __enter__(self) -> Waiting:
        global _waiting  # noqa: PLW0603
        if _is_rewritable(sys.stderr) and hasattr(signal, "setitimer"):
            _waiting = self
            signal.signal(signal.SIGALRM, self._draw)
            signal.setitimer(signal.ITIMER_REAL, FIRST_WORD, 1.0)
        return self

    def __exit__(self, *_: object) -> None:
        global _waiting  # noqa: PLW0603
        if _waiting is self:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, signal.SIG_IGN)  # one may be on its way
            self.erase()
            _waiting = None

    def erase(self) -> None:
        """Make room for what is printed."""
        if self.drawn:
            os.write(sys.stderr.fileno(), f"\r{' ' * self.drawn}\r".encode())
        self.drawn, self._spoken = 0, monotonic()

    def _draw(self, *_: object) -> None:
        now = monotonic()
        is_early = not self.drawn and now - self._spoken < FIRST_WORD
        if self.is_hushed or self.has_bar or is_early:
            return
        line = f"symflex {self.what}: {now - self._begin:.0f} s"
        os.write(sys.stderr.fileno(), f"\r{line}".encode())
        self.drawn = len(line)


_waiting: Waiting | None = None  # the one of the command that runs


@contextmanager
def hushed() -> Iterator[None]:
    """Keep the seconds away while something is printed."""
    waiting = _waiting
    if waiting is None:
        yield
        return
    waiting.is_hushed = True
    waiting.erase()
    try:
        yield
    finally:
        waiting.is_hushed = False


def _give_way(*, to_bar: bool) -> None:
    if _waiting is not None:
        _waiting.has_bar = to_bar


def _is_rewritable(stream: TextIO) -> bool:
    return stream.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
