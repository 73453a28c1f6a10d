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
    AxisNewton,
    Enclosures,
    bits_of,
    changes_sign,
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


# --------------------------------------------------------------------- roots of polynomials in t, known


def polynomial(*coefficients, axis=REAL):
    """Return a polynomial in t, lowest power first."""
    even = {n: {(): c} for n, c in enumerate(coefficients) if c}
    return AxisFunction((AxisWave((0,), (0,), even, {}),), axis, Enclosures(2000, (), (arb(1),), (1,)))


def test_a_root_next_to_a_guess_is_enclosed():
    for digits in [5, 40, 300]:
        for guess in [1.9999999, 2.0, 2 + 1e-12]:
            # (t - 2)(t - 3)(t + 5)
            source = polynomial(30, -19, 0, 1)
            found = AxisNewton(digits).frequency(source, guess)
            assert found.contains(4), (digits, guess)
            with precision(bits_of(digits)):
                assert found.rad() < 4 * arb(10) ** -digits, guess


def test_no_root_is_enclosed_where_none_is_single_or_the_guess_too_large_for_doubles():
    for coefficients in [
        (4, -4, 1),  # (t - 2)^2
        (5, -4, 1),  # (t - 2)^2 + 1
        (2**62 + 1, -(2**62), 2**60),  # (t - 2)^2 + 2^-60
        (-8, 12, -6, 1),  # (t - 2)^3
        (1,),
    ]:
        for guess in [2.0, 2 + 2.0**-30, 2.001]:
            assert AxisNewton(20).frequency(polynomial(*coefficients), guess) is None
    one = Enclosures(64, (), (arb(1),), (2,))
    source = AxisFunction((AxisWave((0,), (1,), {}, {0: {(): 1}}),), REAL, one)
    assert AxisNewton(20).frequency(source, 1e200) is None


def test_signs_are_opposite_about_one_root():
    for low, high, changes in [
        (1.0, 2.5, True), (2.5, 4.0, True), (1.0, 4.0, False), (2.1, 2.9, False), (2.0, 2.5, False),
    ]:  # fmt: skip
        # (t - 2)(t - 3); at a root there is no sign.
        assert changes_sign(polynomial(6, -5, 1), low, high) is changes


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
