"""A bar on stderr for what takes longer than a second."""

from __future__ import annotations

import os
import sys
from math import isnan
from time import monotonic
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable

DELAY = 1.0
"""Seconds before anything is drawn: what is done by then needs no bar."""
INTERVAL = 0.1
"""Seconds between two drawings."""
COLUMNS = 79
BAR = 20


class ProgressBar:
    r"""One line that shows how far a computation is, and erases itself.

    It is drawn on terminals only, not before a second has passed, and not when ``NO_COLOR`` is set or the
    terminal is a ``dumb`` one: both stand for lines that are not rewritten.

    Parameters
    ----------
    stream : file, optional
        stderr by default.
    clock : callable
        Returns the time [s].

    Examples
    --------
    >>> from io import StringIO
    >>> class Screen(StringIO):
    ...     def isatty(self):
    ...         return True
    >>> screen, times = Screen(), iter([0.0, 2.0])
    >>> bar = ProgressBar(screen, lambda: next(times))
    >>> bar.report(0.25, "12 of 48 roots")
    >>> screen.getvalue()
    '\r[#####---------------]  25 %  12 of 48 roots'
    """

    def __init__(self, stream: TextIO | None = None, clock: Callable[[], float] = monotonic) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._clock = clock
        self._is_shown = (
            self._stream.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
        )
        self._next = clock() + DELAY
        self._drawn = 0

    def report(self, done: float, text: str) -> None:
        """Say how far the computation is.

        Parameters
        ----------
        done : float
            The part done, from 0 to 1; what lies outside is drawn as the nearest, what is not a number as 0.
        text : str
            What is being done; one line, cut where it does not fit.
        """
        if not self._is_shown:
            return
        now = self._clock()
        if now < self._next:
            return
        self._next = now + INTERVAL
        self._draw(_line(done, text))

    def close(self) -> None:
        """Erase the bar; nothing is drawn afterwards."""
        if self._drawn:
            self._write(f"\r{' ' * self._drawn}\r")
        self._drawn = 0
        self._is_shown = False

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _draw(self, line: str) -> None:
        # What was longer before is covered with blanks.
        self._write(f"\r{line.ljust(self._drawn)}")
        self._drawn = len(line)

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()


def _line(done: float, text: str) -> str:
    part = 0.0 if isnan(done) else min(max(done, 0.0), 1.0)
    filled = int(part * BAR)
    shown = "".join(c if " " <= c <= "~" else "?" for c in text)
    line = f"[{'#' * filled}{'-' * (BAR - filled)}] {int(part * 100):3d} %  {shown}"
    return line[:COLUMNS].rstrip()
