"""From balls to doubles: the nearest double of the true value, and a radius that is rounded upwards.

A ball that is small enough lies between two neighbouring midpoints of doubles: then the double nearest to the
true value is known, whatever the ball's own centre is. So two computations of one root agree to the last bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import hypot, inf, isfinite, nextafter, ulp
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import arb

LARGEST = 1023
"""Exponent of two beyond which nothing is told."""


@dataclass(frozen=True, slots=True)
class Doubles:
    """A complex number in double precision."""

    # re and im: Centre.
    re: float
    im: float
    radius: float  # the true value lies no further from the centre
    is_nearest: bool  # both parts are the doubles nearest to the true ones


def doubles(re: arb, im: arb) -> Doubles:
    """Round an enclosure.

    Examples
    --------
    >>> from flint import arb
    >>> from symflex.roots import precision
    >>> with precision(128):
    ...     third = doubles(arb(0), arb(1) / 3)
    >>> third.im == 1 / 3, third.radius == 2**-55, third.is_nearest
    (True, True, True)
    """
    x, dx, is_nearest_re = rounded(re)
    y, dy, is_nearest_im = rounded(im)
    radius = max(dx, dy) if not dx or not dy else nextafter(nextafter(hypot(dx, dy), inf), inf)
    return Doubles(x, y, radius, is_nearest_re and is_nearest_im)


def rounded(ball: arb) -> tuple[float, float, bool]:
    """Return the centre, a bound on its distance from the true value, and whether it is the nearest double.

    A value beyond the doubles is NaN with an infinite radius.
    """
    if ball == 0:
        return 0.0, 0.0, True
    if not ball.is_finite():
        return float("nan"), inf, False
    mantissa, exponent = (int(x) for x in ball.mid().man_exp())
    spread, finer = (int(x) for x in ball.rad().man_exp())
    if max(mantissa.bit_length() + exponent, spread.bit_length() + finer) >= LARGEST:
        return float("nan"), inf, False
    least = min(exponent, finer)
    size, around = mantissa << (exponent - least), spread << (finer - least)
    first, last = (_nearest(end, least) for end in (size - around, size + around))
    if first == last and first:
        # Within one rounding interval of the double, which is half a unit in the last place wide at most.
        return first, ulp(first) / 2 or ulp(first), True
    centre = _nearest(size, least)
    unit = Fraction(2) ** least
    ends = ((size - around) * unit, (size + around) * unit)
    return centre, _upwards(max(abs(Fraction(centre) - end) for end in ends)), False


def _nearest(mantissa: int, exponent: int) -> float:
    """Return the double nearest to ``mantissa * 2^exponent``: quotients of integers are rounded correctly."""
    return mantissa / (1 << -exponent) if exponent < 0 else float(mantissa << exponent)


def _upwards(value: Fraction) -> float:
    result = float(value)
    if not isfinite(result):
        return inf
    return nextafter(result, inf) if Fraction(result) < value else result
