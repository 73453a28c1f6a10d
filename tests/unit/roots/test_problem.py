"""Exact polynomials with constants as coefficients."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, fmpz_mpoly_ctx

from symflex.errors import ModelError, UncertifiedError
from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots, precision
from tests.unit.roots.polynomials import problem, with_pi, with_root_of_two


def test_rationals_are_scaled_to_integers():
    assert PolynomialInS.from_rationals([Fraction(1, 6), Fraction(1, 4)]).integers() == (2, 3)


def test_leading_zeros_are_dropped():
    assert PolynomialInS.from_integers([1, 2, 0, 0]).degree == 1


@pytest.mark.parametrize("coefficients", [[], [0], [0, 0]])
def test_the_zero_polynomial_is_refused(coefficients):
    with pytest.raises(ModelError, match="SF403"):
        PolynomialInS.from_integers(coefficients)


def test_every_generator_needs_its_constant():
    context = fmpz_mpoly_ctx.get(["pi"], "lex")
    with pytest.raises(ValueError, match="1 generators but 0 constants"):
        PolynomialInS((context.constant(1),), context, ())


def test_exponents_are_positive():
    with pytest.raises(ValueError, match="positive"):
        RootProblem(((PolynomialInS.from_integers([1, 1]), 0),))


def test_degree_counts_multiplicity():
    assert RootProblem(((PolynomialInS.from_integers([1, 0, 1]), 3),)).degree == 6


def test_enclosure_evaluates_constants_at_the_current_precision():
    polynomial = with_pi(lambda pi, one: (pi**2, one))
    with precision(300):
        assert polynomial.enclosure()[0].overlaps(arb.pi() ** 2)
        assert polynomial.enclosure()[0].rel_accuracy_bits() > 290


def test_coefficients_with_constants_are_not_integers():
    with pytest.raises(ValueError, match="constants"):
        with_pi(lambda pi, one: (pi, one)).integers()


def test_a_leading_coefficient_that_may_vanish_is_refused():
    polynomial = with_root_of_two(lambda root, one: (one, one, root**2 - 2))
    with pytest.raises(UncertifiedError, match="SF401"):
        find_polynomial_roots(RootProblem(((polynomial, 1),)), 10)


def test_at_least_one_digit_is_asked_for():
    with pytest.raises(ValueError, match="at least 1"):
        find_polynomial_roots(problem(1, 1), 0)
