"""Roots where a wavenumber vanishes or meets another: no box about them has values of one branch.

The function itself is as smooth there as elsewhere. Its power series says how many roots a disc holds.
"""

from __future__ import annotations

from math import ceil, log2
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.roots.counting.local_series import BITS_A_POINT, REACH, SERIES_BITS, SERIES_POINTS, local_series
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.root import Root

if TYPE_CHECKING:
    from symflex.roots.functions.kernel_function import KernelFunction

MOST_POINTS = 400
"""Enough for some 600 digits of one root."""
CENTRINGS = 3
"""Least number of times that a disc is moved to the middle of its roots."""
GUESSED_DIGITS = 14
"""Of a centre to begin with; like Newton's, every step doubles them."""
GROWTH = 100
"""Of a disc without other roots next to it, and of one that was too small."""
SHRINKINGS = 5
"""Of a disc, until no other root is next to it."""
WIDER = 5
"""Radius of a disc that holds one moved to an axis, in radii of that."""
DIGITS_A_SHRINKING = 2
"""The logarithm of ``GROWTH``."""
FIRST_BITS = 128
"""Of a look whether wavenumbers have branches."""


def prove_together(
    function: KernelFunction,
    s: acb,
    within: arb,
    digits: int,
    count: int,
    *,
    even: bool,
    is_close: bool = False,
) -> Root | None:
    """Return roots next to a point as one, in a disc that holds so many; ``None`` where none is proved.

    The point is exact. ``count`` is of the roots of ``function**function.power``, with multiplicity; the disc
    stays below the exact radius ``within`` [rad/s]. ``even`` roots mirror each other in the imaginary axis;
    those that are ``is_close`` have to agree in all digits wanted.
    """
    wanted = bits_for_digits(digits + DIGITS_A_SHRINKING * SHRINKINGS)
    most = min(SERIES_POINTS + count * wanted // BITS_A_POINT, MOST_POINTS)
    bits = max(SERIES_BITS + BITS_A_POINT * most, s.bits() + SERIES_BITS)
    with precision(bits):
        reach = within.max(s.abs_upper() * REACH).mid()
    centre = s
    steps = ceil(log2((digits + DIGITS_A_SHRINKING * SHRINKINGS) / GUESSED_DIGITS))
    centrings = max(CENTRINGS, steps + 1)
    for last in reversed(range(centrings)):
        with precision(bits):
            size = (centre.abs_upper() * arb(10) ** -digits).mid()
            centre = snapped(centre, size, even=even)
        # Like Newton's, the first step need not be as accurate as the last.
        points = (SERIES_POINTS + most) // 2 if last == centrings - 1 else most
        series = local_series(function, centre, reach, bits, points)
        if series is None:
            return None
        with precision(bits):
            for _ in range(SHRINKINGS):
                # No other root next to the disc either: what is close to it has a disc of its own.
                if series.count(size) == count == series.count(size * GROWTH):
                    return in_disc(centre, size, count // function.power, even=even)
                size = (size / GROWTH).mid()
            while not (last or is_close) and size < within:
                if series.count(size) == count:
                    place = snapped(centre, size, even=even)
                    if place != centre and series.count(WIDER * size) == count:
                        # About a point of the axis: it holds the disc, and is held by the wider one.
                        centre, size = place, (2 * size).mid()
                    return in_disc(centre, size, count // function.power, even=even)
                size = (size * GROWTH).mid()
            centre = series.middle(count) or centre
    return None


def is_branched(function: KernelFunction, s: acb, within: arb) -> bool:
    """Tell whether a disc may hold a point where wavenumbers have branches."""
    with precision(FIRST_BITS):
        disc = s + acb(arb(0, within), arb(0, within))
    return not all(value.is_finite() for value, _, _ in function.enclosed(disc, FIRST_BITS))


def snapped(s: acb, close: arb, *, even: bool) -> acb:
    """Return a point, on an axis of symmetry if it is closer to that than a distance."""
    on_axis = even and bool(abs(s.real) < close)
    return acb(arb(0) if on_axis else s.real, arb(0) if abs(s.imag) < close else s.imag)


def in_disc(centre: acb, size: arb, multiplicity: int, *, even: bool) -> Root:
    """Return all roots in a disc that holds so many as one."""
    # One root alone in a disc that mirrors itself is its own mirror image.
    on_axis, is_real = (multiplicity == 1 and bool(part == 0) for part in (centre.real, centre.imag))
    on_axis = on_axis and even
    return Root(
        arb(0) if on_axis else arb(centre.real, size),
        arb(0) if is_real else arb(centre.imag, size),
        multiplicity,
        on_imaginary_axis=on_axis,
        is_real=is_real,
        certified=multiplicity == 1,
    )
