"""Values, limits and orders of a function at one point, to double precision.

Input: what encloses the function, by the precision. Output: its value, rounded once; a limit where parts of
the expression are not numbers. Example: ``sin(s)/s`` at 0 is 1, read off at 2^-200 and 2^-220. A ball that is
accurate to 54 bits holds one double or two neighbours.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, isfinite, nan
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.balls import precision, precisions
from symflex.errors import refused

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Ball = Callable[[acb], acb]

FIRST_BITS = 96
LAST_BITS = 6144
DOUBLE_BITS = 54  # one more than the significand of a double
NEAR = (200, 220)  # negative powers of two between which behaviour at a point is read off without a number


def points_of(s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    """Return complex frequencies [rad/s] as an array; SF902 for what are no numbers."""
    import numpy as np  # values in balls need none of it

    wrong = refused("s is a complex number or an array of them [rad/s]", "such as 2j, or 1j*omega")
    try:
        given = np.asarray(s)
        points = given.astype(complex)
    except (TypeError, ValueError):
        raise wrong from None
    if given.dtype == object and any(x is None for x in given.flat):  # numpy takes it for no number, silently
        raise wrong
    return points


def double_value(
    enclosed: Callable[[int], Ball], s: complex, patience: int | None, first: int = FIRST_BITS
) -> complex:
    """Return a value at s [rad/s] in doubles, a limit after ``patience`` doublings; inf at a pole."""
    if not (isfinite(s.real) and isfinite(s.imag)):
        return complex(nan, nan)
    point, last = acb(s.real, s.imag), None if patience is None else first << patience
    for bits in precisions(first, LAST_BITS):
        value = enclosed(bits)(point)
        if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
            return complex(float(value.real.mid()), float(value.imag.mid()))
        if last is not None and not value.is_finite() and bits >= last:
            order, limit = order_near(enclosed, s)
            if limit is None or order < 0:
                return complex(inf, nan)
            return 0j if order > 0 else complex(float(limit.real.mid()), float(limit.imag.mid()))
    return 0j if value.is_finite() else complex(inf, nan)


def order_near(enclosed: Callable[[int], Ball], s: complex) -> tuple[int, acb | None]:
    """Return the order of the zero (negative: of the pole) at ``s``, and a value close by if one is found."""
    near, nearer = (_beside(enclosed, s, -e) for e in NEAR)
    if near is None or nearer is None:
        return 0, None
    with precision(LAST_BITS):
        ratio = abs(nearer / near).log() / arb(2).log() / (NEAR[0] - NEAR[1])
        return round(float(ratio.mid())), nearer


def _beside(enclosed: Callable[[int], Ball], s: complex, exponent: int) -> acb | None:
    """Return a ball around the value at ``s + 2^exponent``, ``None`` when it is not found."""
    for bits in precisions(FIRST_BITS * 8, LAST_BITS):
        with precision(bits):
            point = acb(s.real, s.imag) + (arb(2) ** exponent) * max(abs(s), 1.0)
            value = enclosed(bits)(point)
            if value.is_finite() and value.rel_accuracy_bits() >= DOUBLE_BITS:
                return value
    return None
