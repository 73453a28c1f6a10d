"""Decimal print: digits and a rigorous radius."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from symflex.roots import Root, find_polynomial_roots, precision
from symflex.roots.root import exact_fraction
from tests.unit.roots.root_problems import problem, problem_of


def box(re, im):
    return Root(re, im, 1, on_imaginary_axis=False, is_real=False)


def farthest_square(root, decimals):
    """Square of the distance from the printed point to the farthest corner of the box, exactly."""
    total = Fraction(0)
    for ball, text in ((root.re, decimals.re), (root.im, decimals.im)):
        total += (abs(exact_fraction(ball) - Fraction(text)) + exact_fraction(ball.rad())) ** 2
    return total


def significant(text):
    return len(text.lstrip("-").split("e")[0].replace(".", "").lstrip("0"))


@pytest.mark.parametrize("digits", [1, 2, 15, 30])
def test_each_component_carries_the_digits_asked_for(digits):
    for root in find_polynomial_roots(problem_of(fmpz_poly([3, 1, 4, 1, 5, 9, 2])), digits):
        decimals = root.decimal(digits)
        expected = (digits, 0 if root.is_real else digits)
        assert (significant(decimals.re), significant(decimals.im)) == expected


@pytest.mark.parametrize("digits", [1, 3, 15, 30, 60])
def test_the_radius_reaches_the_whole_enclosure(digits):
    for root in find_polynomial_roots(problem_of(fmpz_poly([3, 1, 4, 1, 5, 9, 2])), 20):
        decimals = root.decimal(digits)
        assert Fraction(decimals.radius) ** 2 >= farthest_square(root, decimals)


def test_the_radius_is_about_one_unit_of_the_last_digit():
    upper, _ = find_polynomial_roots(problem(3, 2, 7), 30)
    decimals = upper.decimal(30)
    assert Fraction(decimals.radius) <= Fraction(1, 10**30)


def test_digits_beyond_the_enclosure_are_not_printed():
    assert box(arb("1.23456789", 1e-4), arb(0)).decimal(30).re == "1.235"


def test_an_exact_zero_prints_as_zero():
    upper, _ = find_polynomial_roots(problem(2, 0, 1), 10)
    assert upper.decimal(10).re == "0"


def test_an_exact_print_has_radius_zero():
    (root,) = find_polynomial_roots(problem(3, 2), 10)
    decimals = root.decimal(10)
    assert (decimals.re, decimals.im, decimals.radius) == ("-1.500000000", "0", "0")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Fraction(12345), "1.23e4"),
        (Fraction(123), "123"),
        (Fraction(-5, 4), "-1.25"),
        (Fraction(1, 32), "0.0312"),  # 0.03125 is a tie and goes to the even digit
        (Fraction(1, 2**40), "9.09e-13"),
        (Fraction(9999), "1.00e4"),
    ],
)
def test_three_digits_of_a_dyadic_number(value, text):
    with precision(100):
        ball = arb(value.numerator) / value.denominator
    assert box(ball, arb(0)).decimal(3).re == text


@given(
    st.fractions(min_value=-(10**6), max_value=10**6),
    st.fractions(min_value=-(10**6), max_value=10**6),
    st.integers(min_value=0, max_value=120),
    st.integers(min_value=1, max_value=40),
)
def test_the_print_is_rigorous_for_any_box(re, im, exponent, digits):
    with precision(200):
        radius = arb(2) ** -exponent
        root = box(
            arb((arb(re.numerator) / re.denominator).mid(), radius),
            arb((arb(im.numerator) / im.denominator).mid(), radius),
        )
    decimals = root.decimal(digits)
    reached = Fraction(decimals.radius) ** 2
    assert farthest_square(root, decimals) <= reached


@given(st.integers(min_value=-(10**9), max_value=10**9), st.integers(min_value=1, max_value=60))
def test_the_radius_is_at_most_a_tenth_too_large(middle, exponent):
    root = box(arb(arb(middle), arb(2) ** -exponent), arb(0))
    decimals = root.decimal(12)
    assert Fraction(decimals.radius) ** 2 <= farthest_square(root, decimals) * Fraction(122, 100)


def test_damping_and_frequency_of_a_textbook_pair():
    upper, lower = find_polynomial_roots(problem(25, 6, 1), 10)  # -3 +- 4j
    assert (upper.damping_ratio(), lower.damping_ratio()) == (0.6, 0.6)
    assert upper.natural_frequency().contains(5)
    assert upper.frequency_hz() == pytest.approx(0.7957747154594767, rel=1e-15)


def test_damping_is_exactly_zero_on_the_axis():
    upper, _ = find_polynomial_roots(problem(2, 0, 1), 10)
    assert upper.damping_ratio() == 0.0


def test_damping_is_undefined_at_zero():
    (root,) = find_polynomial_roots(problem(0, 1), 10)
    assert root.damping_ratio() is None
    assert root.frequency_hz() == 0.0


def test_an_unstable_real_root_has_damping_minus_one():
    (root,) = find_polynomial_roots(problem(-3, 1), 10)
    assert root.damping_ratio() == -1.0
