"""Exact splitting into coprime square-free parts."""

from __future__ import annotations

from symflex.roots import PolynomialInS, RootProblem
from symflex.roots.problem import split
from tests.unit.roots.root_problems import from_roots, problem, with_pi, with_root_of_two


def parts_of(problem):
    return sorted((p.polynomial.integers(), p.multiplicity, p.in_square) for p in split(problem).parts)


def test_powers_of_s_are_counted_over_all_factors():
    factors = ((PolynomialInS.from_integers([0, 0, 1]), 2), (PolynomialInS.from_integers([0, 1, 1]), 3))
    assert split(RootProblem(factors)).zeros == 7


def test_equal_roots_of_different_factors_merge():
    # (s + 1)(s + 2) and (s + 2)^2 (s + 3), the second cubed
    factors = (
        (PolynomialInS.from_rationals(from_roots([-1, -2])), 1),
        (PolynomialInS.from_rationals(from_roots([-2, -2, -3])), 3),
    )
    assert parts_of(RootProblem(factors)) == [
        ((1, 1), 1, False),
        ((2, 1), 7, False),
        ((3, 1), 3, False),
    ]


def test_the_even_part_holds_axis_pairs_and_mirrored_roots_only():
    # (s^2 + 9)(s - 2)(s + 2)(s + 5)
    coefficients = [-180, -36, 25, 5, 5, 1]
    assert parts_of(problem(*coefficients)) == [((-36, 5, 1), 1, True), ((5, 1), 1, False)]


def test_the_content_of_coefficients_is_dropped():
    polynomial = with_pi(lambda pi, one: (pi * 2, pi * 4))
    (part,) = split(RootProblem(((polynomial, 1),))).parts
    assert [str(c) for c in part.polynomial.coefficients] == ["1", "2"]


def test_repeated_factors_are_found_with_a_constant_in_them():
    # (s + pi)^2
    polynomial = with_pi(lambda pi, one: (pi**2, 2 * pi, one))
    (part,) = split(RootProblem(((polynomial, 1),))).parts
    assert (part.polynomial.degree, part.multiplicity) == (1, 2)


def test_factors_with_different_constants_share_a_ring():
    first = with_pi(lambda pi, one: (pi, one))
    second = with_root_of_two(lambda root, one: (root, one))
    splitting = split(RootProblem(((first, 1), (second, 1), (first, 1))))
    assert sorted(part.multiplicity for part in splitting.parts) == [1, 2]


def test_a_constant_polynomial_has_no_parts():
    assert split(problem(7)).parts == ()
