"""Guesses by Laguerre's method, and each of its parts, for polynomials made of their roots."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.budget import Budget
from symflex.roots.polynomials.discs import (
    LARGEST_LOGARITHM,
    _central_exponent,
    _find_one,
    _log_derivatives,
    _polygon_moduli,
    _turns_up,
    guess_by_laguerre,
    propose_by_laguerre,
)


@pytest.fixture(autouse=True)
def working_precision():
    with precision(200):
        yield


def made_of(*roots, leading=1):
    """Return the real polynomial with these roots, and the conjugates of those that are not real."""
    product = acb_poly([leading])
    for root in roots:
        if isinstance(root, complex):
            product *= acb_poly([arb(root.real) ** 2 + arb(root.imag) ** 2, -2 * arb(root.real), 1])
        else:
            product *= acb_poly([-arb(root), 1])
    return product


def with_derivatives(polynomial):
    return polynomial, polynomial.derivative(), polynomial.derivative().derivative()


def numbers(guesses):
    return sorted((complex(g) for g in guesses), key=lambda z: (abs(z), z.real))


def test_every_root_of_the_upper_half_plane_is_guessed_once():
    for leading in [1, -3, 1e-30]:
        for roots in [
            (5.0,),
            (-1 + 2j,),
            (1.0, -2.0, 3 + 4j),
            (1e-6, 1.0, 1e6, -1e3 + 1e-2j),
            (-0.01 + 1j, -0.02 + 2j, -0.03 + 3j, -0.04 + 4j, -7.0),
            (1j, 2j, 3j),
            (0.0, 0.0, 2j),
        ]:
            found = numbers(propose_by_laguerre(made_of(*roots, leading=leading)))
            wanted = numbers(roots)
            assert len(found) == len(wanted), (leading, roots)
            for one, other in zip(found, wanted, strict=True):
                assert abs(one - other) <= 1e-6 if other == 0 else abs(one - other) <= 1e-11 * abs(other), (
                    leading
                )
            assert [z.imag == 0 for z in found] == [z.imag == 0 for z in wanted], (leading, roots)


def test_roots_far_from_1_are_guessed_as_well():
    for scale in [1e-150, 1e150, 1e250]:
        found = numbers(propose_by_laguerre(made_of(scale * (1 + 2j), 3 * scale)))
        assert [z / scale for z in found] == pytest.approx([1 + 2j, 3], rel=1e-11), scale


def test_of_a_double_root_both_are_guessed():
    found = numbers(propose_by_laguerre(made_of(2.0, 2.0, -5.0)))
    assert sum(1 if z.imag == 0 else 2 for z in found) == 3
    assert [z.real for z in found] == pytest.approx([2.0] * (len(found) - 1) + [-5.0], rel=1e-6)


def test_guesses_come_one_after_the_other_and_heed_the_time_before_each_step():
    guesses = guess_by_laguerre(made_of(1.0, 100.0, 1e4))
    assert [float(g.real) for g in guesses] == pytest.approx([1, 100, 1e4])
    asked = []

    def clock():
        asked.append(None)
        return 0.0

    with Budget(seconds=1, clock=clock).entered():
        list(guess_by_laguerre(made_of(1.0, 100.0, 1e4)))
    # A start, and at least two steps for each of three roots.
    assert len(asked) > 6


def test_roots_are_scaled_by_their_geometric_mean():
    for roots, exponent in [
        ((2.0**10, 2.0**12), 11),
        ((2.0**-7,), -7),
        ((8.0, 8.0, 0.0), 3),
        ((0.0, 0.0), 0),
        ((1j, 4.0, 4.0), 1),
    ]:
        for leading in [1, 1e5]:
            polynomial = made_of(*roots, leading=leading)
            assert _central_exponent(polynomial, polynomial.degree()) == exponent, leading


def test_the_newton_polygon_tells_the_moduli_within_doubles():
    for coefficients, moduli in [
        ([16, 0, 0, 0, 1], [2, 2, 2, 2]),
        # sides from 0 to 1, 1 to 2, 2 to 3
        ([1e-3, 1, 1, 1e-4], [1e-3, 1, 1e4]),
        # the middle lies below the hull
        ([4, 1e-3, 1], [2, 2]),
        # on the hull
        ([4, 2, 1], [2, 2]),
        ([0, 0, -5, 1], [5, 5, 5]),
        ([0, 0, 1], [1, 1]),
        # sides from 0 to 1, 1 to 3, 3 to 4
        ([1, 100, 1, 1, 1e-6], [0.01, 10, 10, 1e6]),
    ]:
        found = _polygon_moduli(acb_poly(coefficients), len(coefficients) - 1)
        assert found == pytest.approx(moduli), coefficients
    tiny = arb(10) ** -900
    assert _polygon_moduli(acb_poly([tiny, 1]), 1) == [math.exp(-LARGEST_LOGARITHM)]
    assert _polygon_moduli(acb_poly([1, tiny]), 1) == [math.exp(LARGEST_LOGARITHM)]


def test_a_point_below_or_on_the_line_from_the_first_to_the_last_is_no_corner():
    for height, up in [(1.0, True), (0.5, True), (0.49, False), (-1.0, False)]:
        # From (1, 0) by (2, 1/2 + ...) to (5, 4 height): the line is at height in the middle.
        assert _turns_up((1, 0.0), (2, 0.5), (5, 4 * height)) is up


def test_derivatives_of_the_logarithm_are_sums_over_the_roots_and_none_at_a_root():
    for z in [0.3 + 0.7j, -4 + 0.1j, 10.0 + 0j]:
        roots = [1, -2, 3 + 4j, 3 - 4j]
        found = _log_derivatives(*with_derivatives(made_of(1.0, -2.0, 3 + 4j)), z)
        assert found == pytest.approx(
            (sum(1 / (z - r) for r in roots), sum(1 / (z - r) ** 2 for r in roots))
        ), z
    assert _log_derivatives(*with_derivatives(made_of(1.0, -2.0)), 1 + 0j) is None


def test_a_root_that_is_found_already_is_not_found_again():
    for found, start, expected in [
        ([], 0.9, {1}),
        ([1], 1.001, {3, 2 + 4j, 2 - 4j}),
        ([1, 3], 1.001, {2 + 4j, 2 - 4j}),
        ([1, 2 + 4j, 2 - 4j], 2.002 + 4j, {3}),
    ]:
        polynomial = made_of(1.0, 3.0, 2 + 4j)
        root = _find_one(with_derivatives(polynomial), np.array(found, complex), complex(start))
        assert min(abs(root - other) for other in expected) < 1e-11, (found, start)


def test_what_is_nearly_real_is_real():
    # 3 and 3 (1 +- 1e-9 j) are not told apart here, and 3 (1 +- 1e-7 j) are.
    for apart, is_real in ((1e-9, True), (1e-7, False)):
        polynomial = made_of(complex(3, 3 * apart))
        root = _find_one(with_derivatives(polynomial), np.empty(0, complex), 3 + 1j)
        assert (root.imag == 0) is is_real
        assert abs(root - 3) < 1e-6


def test_without_any_slope_no_root_is_found():
    # z^4 + 1 at 0: both derivatives of the logarithm vanish.
    derivatives = with_derivatives(acb_poly([1, 0, 0, 0, 1]))
    assert _find_one(derivatives, np.empty(0, complex), 0j) is None
    # From elsewhere there is.
    (guess, *_) = guess_by_laguerre(derivatives[0])
    assert abs(complex(guess) ** 4 + 1) < 1e-11


def test_where_the_value_is_lost_in_rounding_the_start_is_the_root():
    blurred = acb_poly([acb(arb(-1, 0.1)), 1])
    assert _find_one(with_derivatives(blurred), np.empty(0, complex), 1.05 + 0j) == 1.05


def test_a_polynomial_lost_in_rounding_altogether_has_still_as_many_guesses_or_none():
    # z^2 + (0 +- 1): whatever it is, it is said as none or as two.
    found = propose_by_laguerre(acb_poly([acb(arb(0, 1)), 0, 1]))
    assert found is None or sum(1 if g.imag == 0 else 2 for g in found) == 2


def test_guesses_are_exact_points_in_the_upper_half_plane():
    for guess in propose_by_laguerre(made_of(-1 + 2j, -3 + 1j, 4.0)):
        assert (guess.real.rad(), guess.imag.rad()) == (0, 0)
        assert guess.imag >= 0


def test_roots_of_one_are_guessed():
    for degree in [8, 15]:
        found = numbers(propose_by_laguerre(acb_poly([-1, *[0] * (degree - 1), 1])))
        assert all(abs(z**degree - 1) < 1e-10 for z in found), degree
        angles = sorted(round(cmath.phase(z) * degree / (2 * math.pi)) for z in found)
        assert angles == list(range(degree // 2 + 1))
