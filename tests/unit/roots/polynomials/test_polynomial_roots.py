"""Roots against formulas and other people's algorithms."""

from __future__ import annotations

import math

import mpmath
import pytest
from flint import acb, arb, fmpz_poly

from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots, precision
from tests.unit.roots.root_problems import chain, from_roots, problem, problem_of, with_pi

DIGITS = 40


def holds(root, value):
    return bool(root.re.overlaps(value.real)) and bool(root.im.overlaps(value.imag))


def in_tight_boxes(roots, values, digits=DIGITS):
    """Each value, computed by a formula in balls, lies in exactly one box, and the boxes are tight."""
    assert len(roots) == len(values)
    for value in values:
        (root,) = [each for each in roots if holds(each, value)]
        size = root.enclosure().abs_lower()
        assert root.re.rad() <= size * arb(10) ** -digits
        assert root.im.rad() <= size * arb(10) ** -digits
    return True


def chain_frequency(j, masses, m, k):
    """Fixed-free chain: omega_j = 2 sqrt(k/m) sin((2 j - 1) pi / (2 (2 N + 1))), any textbook on lattices."""
    return 2 * (arb(k) / m).sqrt() * (arb(2 * j - 1) / (2 * (2 * masses + 1))).sin_pi()


def damped_pair(omega, m, k, b):
    """Stiffness-proportional damping: s^2 + (b/k) omega^2 s + omega^2 = 0."""
    half = omega**2 * b / (2 * k)
    root = acb(half**2 - omega**2).sqrt()
    return [-half + root, -half - root]


@pytest.mark.parametrize("order", [5, 12, 105, 401])
def test_cyclotomic_roots_are_primitive_roots_of_unity(order):
    with precision(300):
        angles = [arb(2 * k) / order for k in range(order) if math.gcd(k, order) == 1]
        values = [acb(t.cos_pi(), t.sin_pi()) for t in angles]
    roots = find_polynomial_roots(problem_of(fmpz_poly.cyclotomic(order)), DIGITS)
    with precision(300):
        assert in_tight_boxes(roots, values)


@pytest.mark.parametrize("degree", [3, 20, 101])
def test_chebyshev_roots_follow_the_cosine_formula(degree):
    roots = find_polynomial_roots(problem_of(fmpz_poly.chebyshev_t(degree)), DIGITS)
    with precision(300):
        values = [acb((arb(2 * k + 1) / (2 * degree)).cos_pi()) for k in range(degree) if 2 * k + 1 != degree]
        assert in_tight_boxes([root for root in roots if not root.is_zero], values)
    assert all(root.is_real for root in roots)


@pytest.mark.parametrize("degree", [20, 60])
def test_wilkinson_roots_are_the_integers(degree):
    roots = find_polynomial_roots(problem(*from_roots(range(1, degree + 1))), DIGITS)
    assert len(roots) == degree
    assert all(root.re.contains(k) for k, root in enumerate(roots, 1))


@pytest.mark.parametrize("masses", [1, 2, 7, 40, 200])
def test_undamped_chain_has_the_lattice_frequencies_exactly_on_the_axis(masses):
    roots = find_polynomial_roots(problem_of(chain(masses, 60, 95000, 0)), 50)
    assert all(root.on_imaginary_axis and root.re == 0 for root in roots)
    with precision(400):
        values = [chain_frequency(j, masses, 60, 95000) for j in range(1, masses + 1)]
        both = [acb(0, sign * value) for value in values for sign in (1, -1)]
        assert in_tight_boxes(roots, both, 50)


@pytest.mark.parametrize(("masses", "b"), [(3, 40), (25, 40), (25, 9000), (200, 40)])
def test_damped_chain_has_the_roots_of_its_modal_quadratics(masses, b):
    roots = find_polynomial_roots(problem_of(chain(masses, 60, 95000, b)), 50)
    with precision(400):
        frequencies = [chain_frequency(j, masses, 60, 95000) for j in range(1, masses + 1)]
        values = [s for omega in frequencies for s in damped_pair(omega, 60, 95000, b)]
        assert in_tight_boxes(roots, values, 50)


def test_every_pole_of_a_damped_chain_is_proved_stable():
    roots = find_polynomial_roots(problem_of(chain(100, 60, 95000, 1)), 15)
    assert len(roots) == 200
    assert all(root.re < 0 for root in roots)


def test_a_free_chain_has_a_double_root_at_zero():
    # two free masses joined by a spring: s^2 (m_1 m_2 s^2 + (m_1 + m_2) k)
    roots = find_polynomial_roots(problem(0, 0, 80 * 95000, 0, 1200), 30)
    assert (roots[0].is_zero, roots[0].multiplicity) == (True, 2)
    with precision(200):
        assert roots[1].im.overlaps((arb(80 * 95000) / 1200).sqrt())


def test_repeated_roots_carry_their_multiplicity():
    roots = find_polynomial_roots(problem(*from_roots([-1, -1, -1, -2, -2, 5])), 20)
    assert [(int(r.re.unique_fmpz()), r.multiplicity) for r in roots] == [(-1, 3), (-2, 2), (5, 1)]


def test_a_repeated_pair_on_the_axis_is_one_pair_of_multiplicity_two():
    roots = find_polynomial_roots(problem(16, 0, 8, 0, 1), 20)  # (s^2 + 4)^2
    assert [(int(r.im.unique_fmpz()), r.multiplicity) for r in roots] == [(2, 2), (-2, 2)]


def test_coefficients_with_pi_give_the_frequency_of_11_hz_exactly_on_the_axis():
    polynomial = with_pi(lambda pi, one: (484 * pi**2, 0 * one, one))  # s^2 + (22 pi)^2
    upper, lower = find_polynomial_roots(RootProblem(((polynomial, 1),)), 50)
    assert upper.on_imaginary_axis
    assert lower.on_imaginary_axis
    assert upper.frequency_hz() == 11.0
    with precision(300):
        assert upper.im.overlaps(22 * arb.pi())
        assert (upper.im / (22 * arb.pi()) - 1).abs_upper() < arb(10) ** -50


def test_a_damped_resonance_given_in_hz_keeps_its_damping_ratio():
    # s^2 + 2 (1/50) (22 pi) s + (22 pi)^2
    polynomial = with_pi(lambda pi, one: (12100 * pi**2, 22 * pi, 25 * one))
    upper, _ = find_polynomial_roots(RootProblem(((polynomial, 1),)), 30)
    assert upper.damping_ratio() == pytest.approx(0.02, abs=1e-16)
    assert upper.frequency_hz() == pytest.approx(11.0, abs=1e-14)


def test_a_thousand_digits_of_the_square_root_of_two():
    roots = find_polynomial_roots(problem(-2, 0, 1), 1000)
    digits = str(math.isqrt(2 * 10**2100))
    assert roots[1].decimal(1000).re[:999].replace(".", "") == digits[:998]


def test_a_thousand_digits_of_a_damped_pair():
    upper, _ = find_polynomial_roots(problem(3, 1, 1), 1000)  # -1/2 +- j sqrt(11)/2
    digits = str(math.isqrt(11 * 10**2100 // 4))
    assert upper.decimal(1000).im[:999].replace(".", "") == digits[:998]


def test_a_mirrored_quadruple_is_exactly_symmetric():
    roots = find_polynomial_roots(problem(1, 0, 0, 0, 1), 30)  # s^4 = -1
    with precision(300):
        assert len({str(abs(root.re.mid()).man_exp()) for root in roots}) == 1
        assert len({str(abs(root.im.mid()).man_exp()) for root in roots}) == 1
        assert in_tight_boxes(roots, [acb(x, y) / arb(2).sqrt() for x in (1, -1) for y in (1, -1)], 30)


def test_a_nonminimum_phase_pair_is_exactly_symmetric_and_real():
    left, right = find_polynomial_roots(problem(-7, 0, 1), 30)
    assert (left.is_real, right.is_real) == (True, True)
    with precision(300):
        assert left.re.mid() == -right.re.mid()
    assert left.im == 0


def test_conjugates_are_exact():
    roots = find_polynomial_roots(problem_of(fmpz_poly([3, 1, 4, 1, 5, 9, 2, 6])), 30)
    uppers = [root for root in roots if root.im > 0]
    lowers = [root for root in roots if root.im < 0]
    with precision(300):
        for upper, lower in zip(uppers, lowers, strict=True):
            assert upper.enclosure().mid() == lower.enclosure().mid().conjugate()


def test_order_is_by_frequency_then_real_part_then_positive_imaginary_part_first():
    # s (s + 1)(s^2 + 1)(s^2 + s + 1)(s + 3)
    one = [(0, 1), (1, 1), (1, 0, 1), (1, 1, 1), (3, 1)]
    factors = tuple((PolynomialInS.from_integers(c), 1) for c in one)
    roots = find_polynomial_roots(RootProblem(factors), 10)
    seen = [(round(float(r.re.mid()), 3), round(float(r.im.mid()), 3)) for r in roots]
    assert seen == [(0, 0), (-1, 0), (-0.5, 0.866), (-0.5, -0.866), (0, 1), (0, -1), (-3, 0)]


def test_order_does_not_depend_on_the_order_of_factors():
    factors = [(PolynomialInS.from_integers(c), 1) for c in ((1, 0, 1), (1, 1, 1), (2, 3, 7), (0, 1))]
    forward = find_polynomial_roots(RootProblem(tuple(factors)), 20)
    backward = find_polynomial_roots(RootProblem(tuple(reversed(factors))), 20)
    assert [r.decimal(20) for r in forward] == [r.decimal(20) for r in backward]


def test_a_root_very_close_to_the_axis_is_told_from_one_on_it():
    # s^2 + 1e-300 s + 1
    upper, _ = find_polynomial_roots(problem(10**300, 1, 10**300), 15)
    assert not upper.on_imaginary_axis
    assert upper.re < 0
    assert upper.damping_ratio() == pytest.approx(5e-301, rel=1e-14)


def test_a_constant_polynomial_has_no_roots():
    assert find_polynomial_roots(problem(5), 10) == ()


def test_roots_agree_with_mpmath_on_a_polynomial_without_structure():
    coefficients = [7, -3, 11, 2, -13, 5, 1, 17, -8, 3, 2]
    roots = find_polynomial_roots(problem(*coefficients), 20)
    with mpmath.workdps(60):
        values = mpmath.polyroots(coefficients[::-1], maxsteps=500, extraprec=500)
        for value in values:
            box = acb(arb(mpmath.nstr(value.real, 50)), arb(mpmath.nstr(value.imag, 50)))
            assert any(holds(root, box) for root in roots)


def test_coefficients_of_hundreds_of_digits_are_solved():
    roots = find_polynomial_roots(problem(*[-(10**400), 0, 1]), 30)
    assert [root.decimal(30).re for root in roots] == [f"{sign}1.{'0' * 29}e200" for sign in ("-", "")]


def test_roots_beyond_the_range_of_doubles_are_solved():
    upper, lower = find_polynomial_roots(problem(10**900, 0, 1), 20)
    assert (upper.decimal(20).im, lower.decimal(20).im) == (f"1.{'0' * 19}e450", f"-1.{'0' * 19}e450")


@pytest.mark.slow
def test_all_600_roots_of_dense_integer_coefficients_are_isolated():
    coefficients = [(7919 * k * k + 104729) % 2003 - 1001 for k in range(601)]
    roots = find_polynomial_roots(problem_of(fmpz_poly(coefficients)), 15)
    assert sum(root.multiplicity for root in roots) == 600
    assert all(root.certified for root in roots)
