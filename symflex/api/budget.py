"""How long a search may take, given in seconds."""

from __future__ import annotations

from symflex.errors import Diagnostic, UsageError
from symflex.roots import Budget


def budget_of(seconds: float | None) -> Budget:
    """Return a budget that starts now.

    Parameters
    ----------
    seconds : float or None
        Time [s]; ``None`` is no limit.

    Raises
    ------
    UsageError
        SF902 when it is not positive.

    Examples
    --------
    >>> budget_of(2.5).seconds
    2.5
    """
    if seconds is not None and not seconds > 0:
        raise UsageError(Diagnostic("SF902", f"a budget is a positive time in seconds, not {seconds}"))
    return Budget(seconds)
