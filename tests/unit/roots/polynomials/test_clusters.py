"""Roots that lie close together, and roots that constants make equal."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, fmpz_poly

from symflex.errors import UncertifiedError
from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots, precision
from tests.unit.roots.root_problems import chain, from_roots, multiply, problem, problem_of, with_root_of_two

TINY = Fraction(1, 10**30)


def contains(ball, value):
    with precision(2000):
        return bool(ball.overlaps(arb(value.numerator) / value.denominator))


@pytest.mark.parametrize("centre", [Fraction(1), Fraction(1, 3), Fraction(-22, 7)])
@pytest.mark.parametrize("others", [range(0), range(40, 43), range(40, 80)], ids=len)
def test_three_roots_1e_30_apart_are_told_apart(centre, others):
    close = [centre, centre + TINY, centre + 2 * TINY]
    roots = find_polynomial_roots(problem(*from_roots([*close, *others])), 10)
    assert all(root.certified and root.multiplicity == 1 for root in roots)
    for value in close:
        assert sum(contains(root.re, value) for root in roots) == 1


def test_clusters_inside_clusters_are_told_apart():
    close = [1, 1 + TINY, 1 + TINY**2, 1 + TINY**3, -2]
    roots = find_polynomial_roots(problem(*from_roots(close)), 10)
    assert len(roots) == 5
    assert all(sum(contains(root.re, Fraction(value)) for root in roots) == 1 for value in close)


def test_close_roots_of_different_factors_are_told_apart():
    factors = tuple((PolynomialInS.from_rationals([-x, 1]), 1) for x in (Fraction(1), 1 + TINY))
    roots = find_polynomial_roots(RootProblem(factors), 5)
    assert [root.certified for root in roots] == [True, True]


def test_a_pair_1e_40_off_the_real_axis_is_not_called_real():
    # (s - 1)^2 + 1e-80
    roots = find_polynomial_roots(problem(10**80 + 1, -2 * 10**80, 10**80), 10)
    assert [root.is_real for root in roots] == [False, False]
    assert contains(roots[0].im, Fraction(1, 10**40))


@pytest.mark.parametrize("others", [[1], from_roots(range(1, 40))], ids=len)
def test_two_damped_pairs_1e_30_apart_are_told_apart(others):
    # s^2 + s + 1 and s^2 + (1 + 1e-30) s + 1: the damping ratios are 1/2 and (1 + 1e-30)/2
    product = multiply(multiply([1, 1, 1], [1, 1 + TINY, 1]), others)
    roots = [root for root in find_polynomial_roots(problem(*product), 10) if not root.is_real]
    assert len(roots) == 4
    for value in (Fraction(-1, 2), -(1 + TINY) / 2):
        assert sum(contains(root.re, value) for root in roots) == 2


def test_mignotte_polynomial_of_degree_100_is_separated():
    # x^100 - 2 (1e9 x - 1)^2 has two roots about 1e-459 apart
    polynomial = fmpz_poly([0] * 100 + [1]) - 2 * fmpz_poly([-1, 10**9]) ** 2
    roots = find_polynomial_roots(problem_of(polynomial), 20)
    assert (len(roots), all(root.certified for root in roots)) == (100, True)


def test_a_ring_of_twenty_roots_of_radius_1e_20_is_resolved():
    # (s - 1)^20 + 1e-400
    ring = 10**400 * fmpz_poly([-1, 1]) ** 20 + 1
    roots = find_polynomial_roots(problem_of(ring), 10)
    assert len(roots) == 20
    with precision(500):
        distances = [abs(root.enclosure() - 1) for root in roots]
        assert all(distance.overlaps(arb(10) ** -20) for distance in distances)


def test_a_double_root_by_a_hidden_relation_is_one_uncertified_disc():
    # (s - sqrt 2)^2 written so that exact steps, which do not know sqrt(2)^2 = 2, see no square
    polynomial = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    (root,) = find_polynomial_roots(RootProblem(((polynomial, 3),)), 30)
    assert (root.multiplicity, root.certified) == (6, False)
    with precision(300):
        assert root.re.overlaps(arb(2).sqrt())
    assert root.re.rad() < arb(10) ** -30


def test_a_hidden_double_root_in_the_square_is_a_pair_of_discs():
    # (s^2 + sqrt 2)^2
    polynomial = with_root_of_two(lambda root, one: (2 * one, 0 * one, 2 * root, 0 * one, one))
    upper, lower = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert [(r.multiplicity, r.certified) for r in (upper, lower)] == [(2, False), (2, False)]
    with precision(300):
        assert upper.im.overlaps(arb(2).root(4))
        assert lower.im.overlaps(-(arb(2).root(4)))


def test_a_hidden_double_pair_off_both_axes_is_enclosed():
    # ((s + 1)^2 + 2)^2 with 9 written as 5 + 2 sqrt(2)^2: s^4 + 4 s^3 + 10 s^2 + 12 s + 9
    polynomial = with_root_of_two(lambda root, one: (5 + 2 * root**2, 12 * one, 10 * one, 4 * one, one))
    roots = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert [(r.multiplicity, r.certified) for r in roots] == [(2, False), (2, False)]
    with precision(300):
        assert roots[0].re.contains(-1)
        assert roots[0].im.overlaps(arb(2).sqrt())


def test_a_root_shared_by_a_hidden_relation_is_merged_and_uncertified():
    # (s - sqrt 2)^3 (s^2 - 2)
    first = with_root_of_two(lambda root, one: (-root, one))
    roots = find_polynomial_roots(RootProblem(((first, 3), (PolynomialInS.from_integers([-2, 0, 1]), 1))), 20)
    assert [(r.multiplicity, r.certified) for r in roots] == [(1, True), (4, False)]
    assert roots[1].re.rad() < arb(10) ** -20


def test_a_root_at_zero_by_a_hidden_relation_is_enclosed():
    # s^2 + s + (sqrt(2)^2 - 2)
    polynomial = with_root_of_two(lambda root, one: (root**2 - 2, one, one))
    near_zero, other = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert near_zero.re.contains(0)
    assert not near_zero.is_zero
    assert near_zero.damping_ratio() is None
    assert other.re.contains(-1)


def test_a_double_root_at_zero_by_a_hidden_relation_is_enclosed():
    # s^4 + s^2 + (sqrt(2)^2 - 2)
    polynomial = with_root_of_two(lambda root, one: (root**2 - 2, 0 * one, one, 0 * one, one))
    near_zero, upper, lower = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert (near_zero.multiplicity, near_zero.certified) == (2, False)
    assert upper.on_imaginary_axis
    assert lower.im.contains(-1)


def test_a_hidden_double_root_among_many_leaves_the_others_certified():
    links = [int(c) for c in chain(30, 60, 95000, 40).coeffs()]

    def rows(root, one):
        square = (2 * one, -2 * root, one)
        product = [0 * one] * (len(links) + 2)
        for i, link in enumerate(links):
            for j, c in enumerate(square):
                product[i + j] += link * c
        return product

    roots = find_polynomial_roots(RootProblem(((with_root_of_two(rows), 1),)), 20)
    assert sorted((r.multiplicity, r.certified) for r in roots) == [(1, True)] * 60 + [(2, False)]


def test_sizes_beyond_the_reach_of_doubles_are_refused_not_guessed():
    with pytest.raises(UncertifiedError, match="SF404"):
        find_polynomial_roots(problem(Fraction(1, 10**400), 3, Fraction(1, 10**100), 0, 7, 5), 10)
