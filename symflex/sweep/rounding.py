"""From balls to doubles: the nearest double of the true value, and a radius that is rounded upwards.

A ball that is small enough lies between two neighbouring midpoints of doubles: then the double nearest to the
true value is known, whatever the ball's own centre is. So two computations of one root agree to the last bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import hypot, inf, isfinite, nextafter, ulp
from typing import TYPE_CHECKING

from symflex.roots.root import exact_fraction

if TYPE_CHECKING:
    from flint import arb

LARGEST = Fraction(2) ** 1023


@dataclass(frozen=True, slots=True)
class Doubles:
    """A complex number in double precision.

    Parameters
    ----------
    re, im : float
        Centre.
    radius : float
        The true value lies no further from the centre.
    is_nearest : bool
        Both parts are the doubles nearest to the true ones.
    """

    re: float
    im: float
    radius: float
    is_nearest: bool


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
    middle, radius = exact_fraction(ball), exact_fraction(ball.rad())
    low, high = middle - radius, middle + radius
    if max(abs(low), abs(high)) > LARGEST:
        return float("nan"), inf, False
    first, last = float(low), float(high)
    if first == last and first:
        # Within one rounding interval of the double, which is half a unit in the last place wide at most.
        return first, ulp(first) / 2, True
    centre = float(middle)
    return centre, _upwards(max(abs(Fraction(centre) - low), abs(high - Fraction(centre)))), False


def _upwards(value: Fraction) -> float:
    result = float(value)
    if not isfinite(result):
        return inf
    return nextafter(result, inf) if Fraction(result) < value else result
