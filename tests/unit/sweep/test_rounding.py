from fractions import Fraction
from math import inf, isnan, ulp

import mpmath
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.balls import precision
from symflex.sweep.points import doubles, rounded


def test_an_exact_zero_has_no_radius():
    assert rounded(arb(0)) == (0.0, 0.0, True)


def test_what_is_not_finite_is_said_to_be_nothing():
    centre, radius, is_nearest = rounded(arb(1) / arb(0))
    assert isnan(centre) and radius == inf and not is_nearest


def test_what_is_larger_than_any_double_is_said_to_be_nothing():
    assert rounded(arb(10) ** 400)[1] == inf


@settings(max_examples=40)
@given(st.fractions(min_value=-(10**6), max_value=10**6).filter(bool))
def test_small_balls_give_the_nearest_double(value):
    with precision(200):
        ball = arb(value.numerator) / value.denominator
    centre, radius, is_nearest = rounded(ball)
    if is_nearest:
        assert centre == value.numerator / value.denominator
    assert abs(Fraction(centre) - value) <= Fraction(radius)


@settings(max_examples=40)
@given(st.floats(-1e6, 1e6).filter(lambda x: abs(x) > 1e-6), st.floats(1e-12, 1e3))
def test_large_balls_are_covered(middle, size):
    centre, radius, is_nearest = rounded(arb(middle, size))
    if size > ulp(middle):
        assert not is_nearest
    for end in (Fraction(middle) - Fraction(size), Fraction(middle) + Fraction(size)):
        assert abs(Fraction(centre) - end) <= Fraction(radius)


def test_two_parts_make_a_disc():
    with precision(150):
        place = doubles(arb(1) / 3, arb(2).sqrt())
    with mpmath.workdps(50):
        error = abs(mpmath.mpc(place.re, place.im) - mpmath.mpc(mpmath.mpf(1) / 3, mpmath.sqrt(2)))
        assert error <= place.radius
    assert place.radius == pytest.approx(2**-53, rel=0.3)


def test_centres_do_not_depend_on_the_ball():
    with precision(100):
        coarse = rounded(arb(2).sqrt())
    with precision(1000):
        fine = rounded(arb(2).sqrt())
    assert coarse == fine
