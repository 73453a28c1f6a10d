"""Guesses of roots on the axes: sign changes of a function whose roots mirror each other in both axes.

On the imaginary axis, and on the real one, each factor of such a function is real but for a constant factor.
Whether it has roots elsewhere, or two so close that no sign changes, only a count tells. Sums of exponentials
are sampled on a grid in doubles; where these do not serve, and for all others, samples are taken in balls.
"""

from __future__ import annotations

from cmath import pi
from math import ceil, log
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.roots.counting.winding import RootOnPathError, Winding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from symflex.roots.functions.exponential_values import Doubles, DoubleSums
    from symflex.roots.functions.kernel_function import Sample

STEP = 1.0
"""Largest change of an exponent [rad] from one sample to the next."""
LONGEST = 0.15
"""Longest step [in ln(abs(s))]."""
BESIDE = 1e-13
"""How far from the imaginary axis samples are taken [rad], so that roots keep to one branch."""
TILT = 0.1
"""Largest deviation [rad] from a real function that rounding may cause."""
HALVINGS = 3
"""Halvings of a step whose slopes show that it may hold two roots."""
MOST = 500.0
"""Difference of two logarithms beyond which the smaller size is nothing; exp(709) is the largest double."""
AT_ONCE = 4096
"""Samples of one grid."""
LONGEST_GRID = 0.7
"""Length of a grid of equal steps [in ln(abs(s))]."""
LOST = 1e-10
"""Share of what is summed below which a sum is lost in rounding."""
SECANTS = 4
"""Each adds half as many digits again: enough for what Newton steps begin with."""
HALF = log(2)


def sign_changes(winding: Winding, low: float, high: float, angle: float) -> list[complex]:
    """Return z = ln(s) next to every sign change of an even function on a ray, in ascending order.

    ``low`` and ``high`` are ln of the radii between which to look; ``angle`` is 0 for the real axis, pi/2 for
    the imaginary one. RootOnPathError where a sample is a root.
    """
    turned = angle - BESIDE if angle else 0.0
    sums = winding.function.in_doubles
    arguments = None if sums is None else _on_grid(winding, sums, low, high, turned)
    if arguments is None:
        arguments = list(_step_by_step(winding, low, high, turned))
    return [complex(place, angle) for place in sorted(arguments)]


def _on_grid(
    winding: Winding, sums: DoubleSums, low: float, high: float, turned: float
) -> list[float] | None:
    """Return where factors in the numerator change their signs, ``None`` where doubles do not tell."""
    numbers = [i for i, (_, exponent) in enumerate(winding.function.part.factors) if exponent > 0]
    arguments: list[float] = []
    place = low
    while place < high:
        winding.spend()
        length = min(high - place, LONGEST_GRID)
        fastest = sums.fastest(complex(place + length, turned))
        step = min(LONGEST, STEP / fastest if fastest > 0 else LONGEST)
        count = min(ceil(length / step), AT_ONCE)
        end = min(high, place + count * step)
        # One step beyond both ends, so that dips there are seen.
        step = (end - place) / count
        grid: Doubles = place + step * np.arange(-1.0, count + 2.0)
        for number, sample in zip(numbers, sums.sampled(grid, turned, numbers), strict=True):
            turns = np.diff(sample.phase) / pi
            whole = np.round(turns)
            if not (sample.share > LOST).all() or not (abs(turns - whole) < TILT / pi).all():
                return None
            changes = whole % 2 == 1
            for i in _dips(sample.size, changes):
                arguments += _step_by_step(winding, grid[i - 1], grid[i + 1], turned)
            starts = 1 + np.flatnonzero(changes[1:-1])
            if len(starts):
                ends = [(grid[i], sample.size[i], sample.phase[i]) for i in (starts, starts + 1)]
                arguments += _secants(sums, number, ends, turned)
        place = end
    return arguments


def _dips(size: Doubles, changes: npt.NDArray[np.bool_]) -> list[int]:
    """Return where a real function comes close to zero without a change of sign: perhaps it has two."""
    lowest = (size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:]) & ~changes[:-1] & ~changes[1:]
    return [int(i) for i in 1 + np.flatnonzero(lowest)]


def _secants(
    sums: DoubleSums, number: int, ends: list[tuple[Doubles, Doubles, Doubles]], turned: float
) -> list[float]:
    """Return where a real function is zero between pairs of points, to a few digits more."""
    (low, below, phase), (high, above, _) = ends
    moved = np.zeros(len(low))
    for _ in range(SECANTS):
        middle = _crossing(low, below, high, above)
        (sample,) = sums.sampled(middle, turned, [number])
        is_low = np.round((sample.phase - phase) / pi) % 2 == 0
        now = np.where(is_low, -1, 1)
        # An end that stays twice counts half (Dowell and Jarratt 1971), so that both move.
        less = np.where(now == moved, HALF, 0.0)
        low, below = np.where(is_low, middle, low), np.where(is_low, sample.size, below - less)
        high, above = np.where(is_low, high, middle), np.where(is_low, above - less, sample.size)
        moved = now
    return [float(place) for place in _crossing(low, below, high, above)]


def _crossing(
    low: Doubles | float, below: Doubles | float, high: Doubles | float, above: Doubles | float
) -> Doubles:
    """Return where a real function with these logarithms at the ends is about zero."""
    argument: Doubles = low + (high - low) / (1 + np.exp(np.clip(above - below, -MOST, MOST)))
    return argument


def _step_by_step(winding: Winding, low: float, high: float, turned: float) -> Iterator[float]:
    place, sample = low, _sample(winding, complex(low, turned))
    while place < high:
        fastest = winding.function.fastest(complex(place, turned))
        following = min(high, place + min(LONGEST, STEP / fastest if fastest > 0 else LONGEST))
        beyond = _sample(winding, complex(following, turned))
        for start, first, end, last in _pieces(winding, place, sample, following, beyond, turned):
            if _changes_sign(winding, first, last):
                yield float(_crossing(start, first.log.real, end, last.log.real))
        place, sample = following, beyond


def _sample(winding: Winding, z: complex) -> Sample:
    winding.spend()
    sample = winding.function.at_logarithm(z, is_simple=True)
    if sample is None:
        raise RootOnPathError
    return sample


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
            # The dip is in the first half: that is cut next.
            pieces[-2:] = pieces[:-3:-1]
    return sorted(pieces, key=lambda piece: piece[0])


def _changes_sign(winding: Winding, first: Sample, last: Sample) -> bool:
    turn = (last.log.imag - first.log.imag) / winding.function.power
    turns = abs(turn) / pi
    return round(turns) % 2 == 1 and abs(turns - round(turns)) * pi < TILT
