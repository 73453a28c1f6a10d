"""Real functions on an axis against the same formulas in mpmath, and their roots where these are known."""

import mpmath
from flint import arb
from mpmath import mp, mpf

from symflex.algebra.exponential_sum import AxisWave
from symflex.balls import precision
from symflex.roots.axes.axis_function import (
    FLOAT_BITS,
    REAL,
    AxisFunction,
    Enclosures,
)

BITS = 300
P, Q = mpf("1.25"), mpf("0.5")
"""Rates of t and of t^2."""
TIMES = ["0.3", "1", "1.7", "2.5", "6"]


def root_of_two():
    with mp.workprec(2 * BITS):
        return mpmath.sqrt(2)


def terms(t):
    """Return all terms of a function of every kind, with constants sqrt(2) and 3."""
    c, d, p, q = root_of_two(), 3, P * t, Q * t * t
    cos, sin, exp = mpmath.cos, mpmath.sin, mpmath.exp
    return [
        (2 + 3 * c) * cos(p),
        -(c**2) * d * t**2 * cos(p),
        5 * t * sin(p),
        exp(-p) * cos(q),
        -t * exp(-p) * cos(q),
        exp(-p) * d * t**3 * sin(q),
        7 * exp(-2 * p),
        4 * exp(-p - q) * cos(p - q),
        -2 * t * exp(-p - q) * sin(p - q),
        6 * exp(2 * p - q),
    ]


def every_kind(bits=BITS):
    """Return the same function, on the real axis."""
    with precision(bits):
        one = Enclosures(bits, (arb(2).sqrt(), arb(3)), (arb("1.25"), arb("0.5")), (1, 2))
    waves = (
        AxisWave((0, 0), (1, 0), {0: {(): 2, ((0, 1),): 3}, 2: {((0, 2), (1, 1)): -1}}, {1: {(): 5}}),
        AxisWave((-1, 0), (0, 1), {0: {(): 1}, 1: {(): -1}}, {3: {((1, 1),): 1}}),
        AxisWave((-2, 0), (0, 0), {0: {(): 7}}, {}),
        AxisWave((-1, -1), (1, -1), {0: {(): 4}}, {1: {(): -2}}),
        AxisWave((2, -1), (0, 0), {0: {(): 6}}, {}),
    )
    return AxisFunction(waves, REAL, one)


def value_and_slope(t):
    """Return the sum of the terms and its derivative, as text of all digits."""
    with mp.workprec(2 * BITS):
        value, slope = sum(terms(mpf(t))), mpmath.diff(lambda x: sum(terms(x)), mpf(t), h=mpf(2) ** -BITS)
        return mp.nstr(value, 75), mp.nstr(slope, 60)


def test_values_and_slopes_are_those_of_the_formula():
    for t in TIMES:
        values = every_kind().values(BITS)
        with precision(BITS):
            value, slope = (arb(text) for text in value_and_slope(t))
            x = arb(t)
            for found, expected, digits in (
                (values.value(x), value, 70),
                (values.slope(x), slope, 50),
                (values.value_and_slope(x)[0], value, 70),
                (values.value_and_slope(x)[1], slope, 50),
            ):
                assert abs(found - expected) < abs(expected) * arb(10) ** -digits, t


def test_values_of_a_ball_are_in_the_ball_of_values():
    for t in TIMES:
        values = every_kind().values(FLOAT_BITS)
        with precision(FLOAT_BITS):
            ball = arb(t, "0.01")
            value, slope = values.value_and_slope(ball)
            for k in range(-4, 5):
                expected = value_and_slope(mpf(t) + mpf(k) / 400)
                assert value.contains(arb(expected[0]).mid()), t
                assert slope.contains(arb(expected[1]).mid()), t
            # Not much wider than the way that the slope leads.
            assert value.rad() < 100 * abs(slope).upper() * ball.rad(), t


# ------------------------------------------------------------------- functions given by their formulas


class Real:
    """A function of t in balls, with its derivative; abs(s) is twice t."""

    def __init__(self, value, slope, fastest=1.0):
        self.value, self.slope, self.speed, self.asked = value, slope, fastest, []

    def values(self, bits):
        self.asked.append(bits)
        return self

    def value_and_slope(self, t):
        return self.value(t), self.slope(t)

    def fastest(self, t):
        return self.speed

    def natural_frequency(self, t):
        return 2 * t
