"""How much time and memory a computation may take, and whom it tells how far it is.

Whatever can grow asks :func:`spend` in its loops. The command line enters one budget for all of a command,
and so can Python: ``with Budget(seconds=10, memory=2 * GB).entered(): ...``. A search that shows what it
proved until its time was over enters a budget besides.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from time import monotonic
from typing import Final, Protocol

from symflex.errors import BudgetError, Diagnostic

GB: Final = 10**9
LOOK: Final = 0.02
"""Seconds between two looks at the memory, in which a process can take 40 MB: each asks the system."""
LESS: Final = "allow more time (--budget), or ask for less: fewer modes, digits or functions"
TIME_OVER: Final = Diagnostic("SF506", "the time budget is used up", None, LESS)


class Progress(Protocol):
    """Shows how far a search is."""

    def report(self, done: float, text: str) -> None:
        """Show a fraction of the whole from 0 to 1, and what is being done."""
        ...


class Silent:
    """Shows nothing."""

    def report(self, done: float, text: str) -> None:
        """Show nothing."""


@dataclass(frozen=True)
class Budget:
    """A limit on time and memory.

    Parameters
    ----------
    seconds : float, optional
        Time from now on [s]; no limit by default.
    progress : Progress
        Receives the progress of the work.
    clock : callable
        Returns the time [s].
    memory : int, optional
        Bytes that the process may hold; no limit by default.

    Examples
    --------
    >>> Budget().spend()
    >>> Budget(seconds=0, clock=iter([0, 1]).__next__).spend()
    Traceback (most recent call last):
    ...
    symflex.errors.exceptions.BudgetError: error[SF506]: the time budget is used up
      hint: allow more time (--budget), or ask for less: fewer modes, digits or functions

    Numbers of bytes are those of the whole process, Python and its libraries included:

    >>> with Budget(memory=1000).entered():
    ...     spend()
    Traceback (most recent call last):
    ...
    symflex.errors.exceptions.BudgetError: error[SF504]: the memory budget is used up: 0.000001 GB
      hint: allow more memory (--memory), or ask for less
    """

    seconds: float | None = None
    progress: Progress = field(default_factory=Silent)
    clock: Callable[[], float] = monotonic
    memory: int | None = None
    _start: float = field(init=False, repr=False, compare=False)
    _look: float = field(init=False, repr=False, compare=False)
    _outer: Budget | None = field(default=None, init=False, repr=False, compare=False)  # heeded as well

    def __post_init__(self) -> None:
        object.__setattr__(self, "_start", self.clock())
        object.__setattr__(self, "_look", self._start)

    def share(self, fraction: float) -> Budget:
        """Return a budget with the same start that ends after a fraction of the time.

        >>> Budget(seconds=2).share(0.75).seconds
        1.5
        """
        shorter = None if self.seconds is None else fraction * self.seconds
        return self._changed(replace(self, seconds=shorter))

    def at_least(self, seconds: float) -> Budget:
        """Return a budget with the same start that lasts at least this long."""
        return self._changed(
            replace(self, seconds=None if self.seconds is None else max(self.seconds, seconds))
        )

    def reporting_to(self, progress: Progress) -> Budget:
        """Return this budget with another receiver of its progress."""
        return self._changed(replace(self, progress=progress))

    def _changed(self, part: Budget) -> Budget:
        object.__setattr__(part, "_start", self._start)
        object.__setattr__(part, "_outer", self._outer)
        return part

    @property
    def deadline(self) -> float | None:
        """The time on the clock at which it ends; ``None`` without a limit."""
        return None if self.seconds is None else self._start + self.seconds

    @property
    def left(self) -> float | None:
        """Seconds left, not below 0; ``None`` without a limit."""
        return None if self.deadline is None else max(0.0, self.deadline - self.clock())

    @property
    def is_timed(self) -> bool:
        """Whether time is limited."""
        return self.seconds is not None or (self._outer is not None and self._outer.is_timed)

    def spend(self) -> None:
        """Raise BudgetError if time (SF506) or memory (SF504) is used up."""
        if self._outer is not None:
            self._outer.spend()
        if self.seconds is None and self.memory is None:
            return
        now = self.clock()
        if self.seconds is not None and now - self._start > self.seconds:
            raise BudgetError(TIME_OVER)
        if self.memory is not None and now >= self._look:
            # The most it ever held is known at once; what it contains now has to be read from a file.
            if peak_memory() > self.memory and memory_held() > self.memory:
                raise BudgetError(memory_used_up(self.memory))
            object.__setattr__(self, "_look", now + LOOK)

    @contextmanager
    def entered(self) -> Iterator[Budget]:
        """Apply this budget to the current thread inside the ``with`` block."""
        token = _ENTERED.set(self)
        try:
            yield self
        finally:
            _ENTERED.reset(token)

    def besides(self) -> Budget:
        """Return this budget, limited also by the one that is entered now."""
        both = self._changed(replace(self))
        object.__setattr__(both, "_outer", _ENTERED.get())
        return both


_ENTERED: ContextVar[Budget | None] = ContextVar("budget", default=None)
_UNLIMITED: Final = Budget()


def entered_budget() -> Budget:
    """Return the budget that is entered, one without limits when none is."""
    return _ENTERED.get() or _UNLIMITED


def spend() -> None:
    """Go on if the budget that is entered has time and memory left; BudgetError else."""
    entered = _ENTERED.get()
    if entered is not None:
        entered.spend()


def memory_used_up(memory: int) -> Diagnostic:
    """Return what is said when a process holds more than it may."""
    amount = f"{memory / GB:.6f}".rstrip("0").rstrip(".")
    message = f"the memory budget is used up: {amount} GB"
    return Diagnostic("SF504", message, None, "allow more memory (--memory), or ask for less")


def peak_memory() -> int:
    """Return the most bytes this process ever held at once; 0 where that is not known."""
    try:
        import resource  # not on every system, and not needed without a limit
    except ImportError:
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def memory_held(process: int | None = None) -> int:
    """Return the bytes a process holds now, this one by default; its peak where that is not known."""
    try:
        with open(f"/proc/{process or 'self'}/statm", "rb") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0 if process else peak_memory()


@contextmanager
def uncollected() -> Iterator[None]:
    """Pause the collector of cycles, whose passes over all objects would make linear work quadratic.

    >>> import gc
    >>> with uncollected():
    ...     gc.isenabled()
    False
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            if not gc.get_freeze_count():
                # Now they all count as old, and the next young generation is looked at without them.
                gc.freeze()
                gc.unfreeze()
            gc.enable()
