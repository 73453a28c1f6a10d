"""Roots of known real functions of one variable: from a guess, and between two places of opposite sign."""

from __future__ import annotations

from math import inf, pi, sqrt

import pytest
from flint import arb

from symflex.roots.axes.axis_function import AxisNewton, _level, bits_of, bracketed, changes_sign
from symflex.roots.precision import bits_for_digits, precision


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


def of_roots(*roots):
    """Return the product of all t - root, given as texts."""

    def known():
        return [arb(root) for root in roots]

    def value(t):
        product = arb(1)
        for root in known():
            product *= t - root
        return product

    def slope(t):
        total = arb(0)
        for i in range(len(roots)):
            product = arb(1)
            for k, root in enumerate(known()):
                product *= t - root if k != i else 1
            total += product
        return total

    return Real(value, slope)


COSINE = Real(lambda t: t.cos(), lambda t: -t.sin())
SQUARE = Real(lambda t: t * t - 2, lambda t: 2 * t)


@pytest.mark.parametrize("digits", [5, 15, 30, 100, 400])
@pytest.mark.parametrize(
    ("source", "guess", "root"),
    [(COSINE, 1.5707963267949, lambda: arb.pi() / 2), (SQUARE, 1.41421356237309, lambda: arb(2).sqrt())],
    ids=["cosine", "square"],
)
def test_a_root_next_to_a_guess_is_enclosed_to_the_digits_wanted(source, guess, root, digits):
    found = AxisNewton(digits).frequency(source, guess)
    with precision(3000):
        assert found.contains(2 * root()) or abs(found.mid() - 2 * root()) <= found.rad() * 1.001
        assert found.rad() < abs(found) * arb(10) ** -(digits + 1)


@pytest.mark.parametrize(("guess", "root"), [(1.0, "1"), (1.000001, "1.000001")])
def test_of_two_close_roots_the_one_guessed_is_enclosed(guess, root):
    found = AxisNewton(30).frequency(of_roots("1", "1.000001"), guess)
    with precision(400):
        assert found.overlaps(2 * arb(root))
        assert found.rad() < 1e-30


@pytest.mark.parametrize(
    "source",
    [Real(lambda t: t * t + 1, lambda t: 2 * t), of_roots("1", "1")],
    ids=["none", "double"],
)
def test_where_no_simple_root_is_none_is_proved(source):
    assert AxisNewton(20).frequency(source, 1.0) is None


def test_where_doubles_do_not_reach_nothing_is_known():
    source = Real(lambda t: t - 1, lambda t: arb(1), fastest=inf)
    assert AxisNewton(20).frequency(source, 1.0) is None
    assert source.asked == []


def test_no_more_precision_is_asked_for_than_the_digits_take():
    source = Real(lambda t: t.cos(), lambda t: -t.sin())
    AxisNewton(50).frequency(source, pi / 2)
    assert max(source.asked) <= bits_of(50) < bits_for_digits(52) + 200
    assert min(source.asked) >= 53


@pytest.mark.parametrize(
    ("low", "high", "changes"), [(1.0, 2.0, True), (2.0, 1.0, True), (0.0, 1.0, False), (2.0, 4.0, False)]
)
def test_opposite_signs_at_two_places_are_told(low, high, changes):
    assert changes_sign(SQUARE, low, high) is changes
    assert changes_sign(Real(lambda t: 2 - t * t, lambda t: -2 * t), low, high) is changes


def test_a_value_not_told_from_zero_has_no_sign():
    assert not changes_sign(of_roots("1", "3"), 1.0, 2.0)
    assert not changes_sign(Real(lambda t: arb(0, 1), lambda t: arb(1)), 1.0, 2.0)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("value", "slope", "low", "high", "root"),
    [
        (lambda t: t * t - 2, lambda t: 2 * t, 1.0, 2.0, sqrt(2)),
        (lambda t: t.cos(), lambda t: -t.sin(), 0.1, 3.0, pi / 2),
        # Newton's method alone leaves the interval.
        (lambda t: (20 * (t - 1.1)).atan(), lambda t: 20 / (1 + 400 * (t - 1.1) ** 2), 0.5, 9.0, 1.1),
        (lambda t: (t - 2) ** 2 - 0.25, lambda t: 2 * (t - 2), 1.0, 2.4, 1.5),
        # No slope in the middle.
        (lambda t: (t - 2) ** 3 + 0.125, lambda t: 3 * (t - 2) ** 2, 1.0, 3.0, 1.5),
    ],
    ids=["square", "cosine", "atan", "parabola", "flat"],
)
def test_a_root_between_two_places_of_opposite_sign_is_met(value, slope, low, high, root, sign):
    source = Real(lambda t: sign * value(t), lambda t: sign * slope(t))
    assert bracketed(source, low, high) == pytest.approx(root, rel=1e-11)


@pytest.mark.parametrize(
    ("bits", "most"), [(10, 900), (64, 900), (65, 900), (700, 900), (880, 900), (1000, 900)]
)
def test_precisions_are_few_and_enough(bits, most):
    level = _level(bits, most)
    assert min(bits, most) <= level <= most
    assert len({_level(k, most) for k in range(1, 1000)}) < 12
