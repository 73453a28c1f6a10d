"""How long a search may take, given in seconds."""

from __future__ import annotations

from math import inf

from symflex.budget import Budget, entered_budget
from symflex.errors import Diagnostic, UsageError


def budget_of(seconds: float | None) -> Budget:
    """Return a budget that starts now, the one that is entered when no time is given.

    Parameters
    ----------
    seconds : float or None
        Time [s]; ``None``: no limit of its own.

    Raises
    ------
    UsageError
        SF902 when it is not positive and finite.

    Examples
    --------
    >>> budget_of(2.5).seconds
    2.5
    """
    if seconds is None:
        return entered_budget()
    if not 0 < seconds < inf:
        raise UsageError(Diagnostic("SF902", f"a budget is a positive time in seconds, not {seconds}"))
    return Budget(seconds)
