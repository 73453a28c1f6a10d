"""Where roots are looked for, chosen by at most one of several arguments."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

from symflex.errors import Diagnostic, UsageError
from symflex.roots import Band, Mode, Modes, Rectangle, Region


def chosen_region(
    modes: int | None,
    band: tuple[float, float] | None,
    rectangle: tuple[float, float, float, float] | None = None,
    mode: int | None = None,
) -> Region | None:
    """Return the region that the arguments choose, None when all of them are None.

    Parameters
    ----------
    modes : int or None
        The number of the lowest modes.
    band : (float, float) or None
        Natural frequencies [Hz].
    rectangle : (float, float, float, float) or None
        ``(re_low, re_high, im_low, im_high)`` [rad/s].
    mode : int or None
        The number of one mode, from 1.

    Raises
    ------
    UsageError
        SF902 when more than one is given, or a number of a mode that is below 1.

    Examples
    --------
    >>> chosen_region(None, (0.1, 20))
    Band(low=Fraction(1, 10), high=Fraction(20, 1))
    """
    if sum(choice is not None for choice in (modes, mode, band, rectangle)) > 1:
        raise UsageError(Diagnostic("SF902", "give only one of modes, mode, band and region"))
    if mode is not None:
        if mode < 1:
            raise UsageError(Diagnostic("SF902", f"modes are numbered from 1, not {mode}"))
        return Mode(mode)
    if modes is not None:
        return Modes(modes)
    if band is not None:
        return Band(*map(_exact, band))
    return None if rectangle is None else Rectangle(*map(_exact, rectangle))


def _exact(number: float) -> Fraction:
    """Return the shortest decimal that prints a number."""
    return Fraction(Decimal(repr(float(number))))
