"""How long a search may take, and whom it tells how far it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from time import monotonic
from typing import TYPE_CHECKING, Protocol

from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Callable


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
    """A limit on the time of a search.

    Parameters
    ----------
    seconds : float, optional
        From now on; no limit by default.
    progress : Progress
        Told how far the search is.
    clock : callable
        Returns the time [s].

    Examples
    --------
    >>> Budget().spend()
    >>> Budget(seconds=0, clock=iter([0, 1]).__next__).spend()
    Traceback (most recent call last):
    ...
    symflex.errors.exceptions.BudgetError: error[SF506]: the time given is over
      hint: allow more time, or ask for fewer roots
    """

    seconds: float | None = None
    progress: Progress = field(default_factory=Silent)
    clock: Callable[[], float] = monotonic
    _start: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_start", self.clock())

    def share(self, fraction: float) -> Budget:
        """Return a budget that began when this one did and ends after a fraction of its time.

        Examples
        --------
        >>> Budget(seconds=2).share(0.75).seconds
        1.5
        """
        part = replace(self, seconds=None if self.seconds is None else fraction * self.seconds)
        object.__setattr__(part, "_start", self._start)
        return part

    def spend(self) -> None:
        """Go on if there is time left.

        Raises
        ------
        BudgetError
            SF506 when the time is over.
        """
        if self.seconds is not None and self.clock() - self._start > self.seconds:
            message = "the time given is over"
            raise BudgetError(Diagnostic("SF506", message, None, "allow more time, or ask for fewer roots"))
