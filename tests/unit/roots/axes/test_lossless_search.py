"""Searching functions of the root of s whose roots are known: a clamped beam's, a rod's, a polynomial's."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log

import mpmath
import pytest
from flint import acb, arb
from mpmath import mp, mpf

from symflex.balls import precision
from symflex.roots import Mode
from symflex.roots.axes.axis_function import IMAGINARY
from symflex.roots.axes.lossless import LosslessSearch
from symflex.roots.counting.winding import RootOnPathError
from tests.unit.roots.distributed_models import ROD as ROD_WITH_A_MASS
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.lossless_functions import RATES, function_of
from tests.unit.roots.stand_ins import poles_by

DIGITS = 20

# cosh(p x) + cos(p x) - 2 is 2 (cosh(b) cos(b) - 1) for b = p x exp(-j pi/4)/sqrt(2): at s = j w, b is real.
CLAMPED = ((1, 0, 0, ((0, "cosh"),)), (1, 0, 0, ((0, "cos"),)), (-2, 0, 0, ()))
# 3 s cosh(s/2) + sinh(s/2)/2: at s = j w, tan(w/2) = -6 w
ROD = ((3, 2, 0, ((2, "cosh"),)), (1, 0, 0, ((2, "sinh"),)))
# s^2 - 9, s^2 + 4
REAL_PAIR, PAIR = ((1, 4, 0, ()), (-9, 0, 0, ())), ((1, 4, 0, ()), (4, 0, 0, ()))


def clamped(n):
    with mp.workdps(50):
        b = mpmath.findroot(lambda b: mpmath.cos(b) - mpmath.sech(b), (n + mpf(1) / 2) * mp.pi)
        return 2 * b**2 / mpf(RATES[0]) ** 2


def rod(n):
    """Return w with 3 w cos(w/2) + sin(w/2) = 0."""
    with mp.workdps(50):
        low, high = (2 * n - 1) * mp.pi, (2 * n - mpf(1) / 2) * mp.pi
        return mpmath.findroot(
            lambda w: 3 * w * mpmath.cos(w / 2) + mpmath.sin(w / 2), (low, high), solver="anderson"
        )


def search(*factors, order=0, digits=DIGITS):
    return LosslessSearch(function_of(*factors), order, digits)


def holds(root, value):
    with precision(160):
        return bool(abs(root.natural_frequency() - arb(mp.nstr(value, 45))) < value * 1e-19)


def test_a_multiple_root_is_as_many_modes():
    roots, reached = search((CLAMPED, 3), order=6).lowest(4)
    assert [root.multiplicity for root in roots] == [3, 3]
    assert clamped(2) < exp(reached) < clamped(3)


def test_roots_of_one_frequency_are_found_together():
    # No circle passes between the roots of two equal factors, nor between 3 and 3j.
    roots, reached = search((CLAMPED, 1), (CLAMPED, 1), order=4).lowest(1)
    assert [holds(root, clamped(1)) for root in roots] == [True, True]
    assert clamped(1) < exp(reached) < clamped(2)
    both, reached = search((REAL_PAIR, 1), (((1, 4, 0, ()), (9, 0, 0, ())), 1), (PAIR, 1)).lowest(2)
    assert sorted((round(float(root.re)), round(float(root.im))) for root in both) == [(0, 2), (0, 3), (3, 0)]
    assert exp(reached) > 3


def test_roots_on_the_real_axis_are_modes_too():
    roots, _ = search((REAL_PAIR, 1), (ROD, 1)).lowest(2)
    (real, other) = sorted(roots, key=lambda root: not root.is_real)
    assert holds(real, mpf(3))
    assert (real.is_real, real.on_imaginary_axis, real.re > 0, real.im == 0) == (True, False, True, True)
    assert holds(other, rod(1))
    assert (other.is_real, other.on_imaginary_axis, other.im > 0, other.re == 0) == (False, True, True, True)


def test_modes_of_a_polynomial_end_and_a_denominator_has_none():
    roots, reached = search((PAIR, 1), (REAL_PAIR, 2)).lowest(9)
    assert sorted((root.multiplicity, root.is_real) for root in roots) == [(1, False), (2, True)]
    assert exp(reached) > 9
    alone = search((PAIR, -1))
    assert alone.lowest(3) == ([], alone.smallest())
    assert [root.is_real for root in search((PAIR, -1), (REAL_PAIR, 1)).lowest(3)[0]] == [True]


def test_a_circle_about_0_holds_both_roots_of_every_mode_below_and_passes_through_none():
    for n in [1, 2, 7, 30]:
        found = search((CLAMPED, 1), order=2)
        between = (log(clamped(n)) + log(clamped(n + 1))) / 2
        assert found.count(between) == 2 * n
        close = 1e-6
        assert found.count(log(clamped(n)) - close) == 2 * n - 2
        assert found.count(log(clamped(n)) + close) == 2 * n
    for n in [1, 5]:
        with pytest.raises(RootOnPathError):
            search((CLAMPED, 1), order=2).count(float(log(clamped(n))))


def test_roots_of_a_denominator_are_taken_away_and_those_at_0_left_out():
    found = search((PAIR, -1), (REAL_PAIR, 2), order=0)
    assert [found.count(log(radius)) for radius in (1, 2.5, 4)] == [0, -2, 2]
    assert search((PAIR, 1), order=2).count(log(3)) == 0


@dataclass(frozen=True)
class Turned:
    """Stands for a function that turns by so many quarters."""

    quarters: arb

    def turn(self, z):
        return self.quarters * arb.pi() / 2


def test_a_turn_is_a_count_where_it_is_known_to_less_than_half_a_quarter():
    for middle, radius in ((10, 0.1), (10, 0.49), (10.3, 0.1), (9.7, 0.1)):
        assert LosslessSearch(Turned(arb(middle, radius)), 3, DIGITS).count(1.0) == 7, (middle, radius)
    for quarters in (arb(10, 0.51), arb(10.3, 0.3), arb(10.5, 0.01), arb("nan"), arb(0, "inf")):
        with pytest.raises(RootOnPathError):
            LosslessSearch(Turned(quarters), 3, DIGITS).count(1.0)


def test_between_two_radii_all_roots_are_found_in_batches_without_a_gap():
    found = search((CLAMPED, 1), (ROD, 1), order=2)
    low, high = 30.0, 200.0
    every = sorted(w for n in range(1, 60) for w in (clamped(n), rod(n)) if low < w < high)
    roots = found.on_axes(log(low), log(high))
    assert len(roots) == len(every) > 20
    assert all(holds(root, value) for root, value in zip(roots, every, strict=True))
    found = search((ROD, 1))
    # One little above every odd multiple of pi, the last 1081 pi = 3396.
    assert len(found.between(0.5, 3400.0)) == 541


def test_a_root_is_proved_where_a_guess_is_close_and_nowhere_else():
    found = search((CLAMPED, 1), order=2)
    ((source, exponent),) = found._factors_on(IMAGINARY)
    t = source.at_frequency(float(clamped(3)))
    root = found._proved_at(source, t, exponent)
    assert holds(root, clamped(3))
    assert root.enclosure().overlaps(acb(arb(0), arb(float(clamped(3)), 1e-9)))
    assert found._proved_at(source, source.at_frequency(float(clamped(3) + clamped(4)) / 2), exponent) is None


# ------------------------------------------------------------------------ whole models


def test_a_very_high_mode_of_a_rod_with_a_tip_mass():
    # x tan x = 2, and omega = x.
    with mp.workdps(50):
        number = 10**9
        (root, _) = poles_by("lossless", bound(ROD_WITH_A_MASS, 0), Mode(number), 30)
        x = mpmath.findroot(lambda x: x * mp.sin(x) - 2 * mp.cos(x), (number - 1) * mp.pi + mpf(2) / number)
        assert abs(mpf(root.decimal(30).im) - x) < mpf(10) ** -18
