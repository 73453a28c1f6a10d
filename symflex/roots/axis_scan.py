"""Guesses of roots on the axes: sign changes of a function whose roots mirror each other in both axes.

On the imaginary axis, and on the real one, such a function is real but for a constant factor. Whether it has
roots elsewhere, or two so close that no sign changes, only a count tells.
"""

from __future__ import annotations

from cmath import pi
from math import exp
from typing import TYPE_CHECKING

from symflex.roots.winding import RootOnPathError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from symflex.roots.kernel_function import Sample
    from symflex.roots.winding import Winding

STEP = 1.0
"""Largest change of an exponent [rad] from one sample to the next."""
LONGEST = 0.15
"""Longest step [in ln(abs(s))]."""
BESIDE = 1e-13
"""How far from the imaginary axis samples are taken [rad], so that roots keep to one branch."""
TILT = 0.1
"""Largest deviation [rad] from a real function that rounding may cause."""
HALVINGS = 3
MOST = 500.0


def sign_changes(winding: Winding, low: float, high: float, angle: float) -> Iterator[complex]:
    """Yield z = ln(s) next to every sign change on a ray, in ascending order.

    Parameters
    ----------
    winding : Winding
        Of an even function.
    low, high : float
        ln of the radii between which to look.
    angle : float
        0 for the real axis, pi/2 for the imaginary one.

    Raises
    ------
    RootOnPathError
        A sample is a root.
    """
    turned = angle - BESIDE if angle else 0.0
    place, sample = low, _sample(winding, complex(low, turned))
    while place < high:
        fastest = winding.function.fastest(complex(place, turned))
        following = min(high, place + min(LONGEST, STEP / fastest if fastest > 0 else LONGEST))
        beyond = _sample(winding, complex(following, turned))
        for start, first, end, last in _pieces(winding, place, sample, following, beyond, turned):
            if _changes_sign(winding, first, last):
                yield complex(_secant(start, first, end, last), angle)
        place, sample = following, beyond


def _sample(winding: Winding, z: complex) -> Sample:
    winding.spend()
    found = winding.function.at_logarithm(z, is_simple=True)
    if found is None:
        raise RootOnPathError
    return found


def _pieces(
    winding: Winding, start: float, first: Sample, end: float, last: Sample, turned: float
) -> list[tuple[float, Sample, float, Sample]]:
    """Return a step, cut where the slopes at its ends say that it may hold two sign changes."""
    pieces = [(start, first, end, last)]
    for _ in range(HALVINGS):
        a, one, b, other = pieces[-1]
        # Towards zero at both ends: abs(F) falls, then rises.
        if _changes_sign(winding, one, other) or not (one.slope.real < 0 < other.slope.real):
            break
        middle = (a + b) / 2
        between = _sample(winding, complex(middle, turned))
        pieces[-1:] = [(a, one, middle, between), (middle, between, b, other)]
        if _changes_sign(winding, one, between):
            break
        if between.slope.real > 0:
            pieces.reverse()
    return sorted(pieces, key=lambda piece: piece[0])


def _changes_sign(winding: Winding, first: Sample, last: Sample) -> bool:
    turn = (last.log.imag - first.log.imag) / winding.function.power
    turns = abs(turn) / pi
    return round(turns) % 2 == 1 and abs(turns - round(turns)) * pi < TILT


def _secant(start: float, first: Sample, end: float, last: Sample) -> float:
    """Return where a real function with these logarithms at the ends is about zero."""
    growth = min(max(last.log.real - first.log.real, -MOST), MOST)
    return start + (end - start) / (1 + exp(growth))
