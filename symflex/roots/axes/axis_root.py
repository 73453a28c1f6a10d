"""Roots of real functions on an axis: from two places of opposite sign, and from guesses in doubles.

Newton steps of rising precision come close to a root, and :mod:`symflex.algebra.interval_newton` proves it.
"""

from __future__ import annotations

from functools import cache
from math import frexp, inf, isfinite

from flint import arb

from symflex.algebra.interval_newton import stays_inside
from symflex.budget import spend
from symflex.roots.axes.axis_function import FLOAT_BITS, AxisFunction
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.root import GUARD_BITS

GUESS_BITS = 46
"""Bits of a guess in doubles that are right as a rule."""
LEAST_BITS = 16
"""Right bits of a point below which no proof is tried."""
MARGIN_BITS = 4
"""By which less is believed than a Newton step says."""
ROUNDS = 40
"""Interval Newton steps; each nearly doubles what is known, so that few are ever taken."""
BISECTIONS = 100
"""Nearly twice the bits of a double."""
CLOSER = 1e-12
"""Relative to t: no further Newton step is needed after one as short as this."""


class AxisNewton:
    """Encloses roots to a number of significant digits of abs(s)."""

    def __init__(self, digits: int) -> None:
        self._goal_bits = bits_for_digits(digits + 2)
        self._half_bits = self._goal_bits // 2 + GUARD_BITS
        self._bits = bits_of(digits)
        with precision(self._bits):
            self._goal = arb(10) ** -(digits + 2)

    def frequency(self, source: AxisFunction, guess: float) -> arb | None:
        """Return abs(s) of the root next to t, proved to be the only one in a small interval.

        ``None`` where that is not proved.
        """
        t, known = self._approached(source, guess)
        while known >= LEAST_BITS:
            spend()
            frequency = self._enclosed(source, t, known)
            if frequency is not None:
                return frequency
            # Next to another root less is known than it seems.
            known //= 2
        return None

    def _approached(self, source: AxisFunction, guess: float) -> tuple[arb, int]:
        """Return t close to a root, and how many of its bits are right by all appearances."""
        t, known = arb(guess), GUESS_BITS
        turned = guess * source.fastest(guess)
        if not isfinite(turned):
            return t, 0  # too large for doubles, in which nothing is then known
        lost = int(turned).bit_length() + MARGIN_BITS
        while 2 * known - lost < self._goal_bits:
            spend()
            bits = _level(2 * known + GUARD_BITS, self._half_bits)
            with precision(bits):
                value, slope = source.values(bits).value_and_slope(t)
                step = value / slope
                share = float(step / t)
                t = (t - step).mid()
            if not t.is_finite():
                break
            # What is too small for a double says nothing of its size.
            agreeing = -frexp(share)[1] if share else known
            closer = min(2 * agreeing - lost, bits - MARGIN_BITS)
            if closer <= known:
                break
            known = closer
        return t, known

    def _enclosed(self, source: AxisFunction, t: arb, known: int) -> arb | None:
        """Return abs(s) of the only root in a ball about t, ``None`` where that is not proved."""
        slope_bits = _level(known + GUARD_BITS, self._half_bits)
        with precision(slope_bits):
            radius = abs(t) * _shift(known)
            box = arb(t, radius)
            slope = source.values(slope_bits).slope(box)
        for i in range(ROUNDS):
            bits = _level(2 * known + GUARD_BITS, self._bits)
            with precision(bits):
                step = source.values(bits).value(t) / slope
                # All of the ball that the step leads to lies inside the ball it started from.
                if i == 0 and not stays_inside(step, radius):
                    return None
                box = t - step
                if box.rad() < self._goal * abs(box):
                    return source.natural_frequency(box)
            accurate = box.rel_accuracy_bits()
            if accurate <= known + MARGIN_BITS:
                return None
            t, known = box.mid(), accurate
            slope_bits = _level(known + GUARD_BITS, self._half_bits)
            with precision(slope_bits):
                slope = source.values(slope_bits).slope(box)
        return None


def bits_of(digits: int) -> int:
    """Return the precision that it takes to enclose roots to a number of digits."""
    return bits_for_digits(digits + 2) + GUARD_BITS


def changes_sign(source: AxisFunction, low: float, high: float) -> bool:
    """Tell whether a function has opposite signs at two t: proved."""
    values = source.values(FLOAT_BITS)
    with precision(FLOAT_BITS):
        return bool(values.value(arb(low)) * values.value(arb(high)) < 0)


def bracketed(source: AxisFunction, low: float, high: float) -> float:
    """Return t of a root between two of opposite sign, by safeguarded Newton steps."""
    values = source.values(FLOAT_BITS)
    with precision(FLOAT_BITS):
        rises = values.value(arb(high)) > 0
        t = (low + high) / 2
        for _ in range(BISECTIONS):
            value, slope = values.value_and_slope(arb(t))
            low, high = (low, t) if (value > 0) == rises else (t, high)
            closer = t - float(value) / float(slope) if slope != 0 else inf
            if not low <= closer <= high:
                closer = (low + high) / 2
            if abs(closer - t) <= CLOSER * t:
                return closer
            t = closer
    return t


@cache
def _level(bits: int, most: int) -> int:
    """Return one of few precisions, so that constants are evaluated for few."""
    level = FLOAT_BITS
    while level < bits:
        level += max(FLOAT_BITS, level // 4)
    return min(level, most)


@cache
def _shift(bits: int) -> arb:
    """Return two to the power of minus so many."""
    return arb(2) ** -bits
