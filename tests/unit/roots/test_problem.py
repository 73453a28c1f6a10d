"""Exact polynomials with constants as coefficients."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb, fmpz_mpoly_ctx

from symflex.errors import ModelError, UncertifiedError
from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots, precision
from tests.unit.roots.root_problems import problem, with_pi, with_root_of_two


def test_rationals_are_scaled_to_integers():
    assert PolynomialInS.from_rationals([Fraction(1, 6), Fraction(1, 4)]).integers() == (2, 3)


def test_leading_zeros_are_dropped():
    assert PolynomialInS.from_integers([1, 2, 0, 0]).degree == 1


@pytest.mark.parametrize("coefficients", [[], [0], [0, 0]])
def test_the_zero_polynomial_is_refused(coefficients):
    with pytest.raises(ModelError, match=r"SF403.*: the polynomial is zero: every s is a root of it$"):
        PolynomialInS.from_integers(coefficients)


def test_every_generator_needs_its_constant():
    context = fmpz_mpoly_ctx.get(["pi"], "lex")
    with pytest.raises(ValueError, match=r"^1 generators but 0 constants$"):
        PolynomialInS((context.constant(1),), context, ())


def test_exponents_are_positive():
    with pytest.raises(ValueError, match=r"^exponents of factors are positive$"):
        RootProblem(((PolynomialInS.from_integers([1, 1]), 0),))


def test_degree_counts_multiplicity():
    assert RootProblem(((PolynomialInS.from_integers([1, 0, 1]), 3),)).degree == 6


def test_enclosure_evaluates_constants_at_the_current_precision():
    polynomial = with_pi(lambda pi, one: (pi**2, one))
    with precision(300):
        assert polynomial.enclosure()[0].overlaps(arb.pi() ** 2)
        assert polynomial.enclosure()[0].rel_accuracy_bits() > 290


def test_coefficients_with_constants_are_not_integers():
    with pytest.raises(ValueError, match=r"^the coefficients contain constants$"):
        with_pi(lambda pi, one: (pi, one)).integers()


def test_a_leading_coefficient_that_may_vanish_is_refused():
    polynomial = with_root_of_two(lambda root, one: (one, one, root**2 - 2))
    with pytest.raises(UncertifiedError, match="SF401") as failed:
        find_polynomial_roots(RootProblem(((polynomial, 1),)), 10)
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.message.startswith("cannot tell whether the coefficient ")
    assert diagnostic.message.endswith(" of s^2 is zero")
    assert diagnostic.hint == "its constants seem to satisfy a relation; write the coefficient without it"


def test_a_leading_coefficient_that_is_small_is_told_from_zero():
    # pi^2 - 9.8696044010893586 is 2e-17
    polynomial = with_pi(lambda pi, one: (one, 10**16 * pi**2 - 98696044010893586))
    polynomial.require_leading_coefficient()


def test_every_term_of_a_coefficient_counts():
    polynomial = with_pi(lambda pi, one: (3 * pi**2 - 5 * pi + 7, one))
    with precision(100):
        expected = 3 * arb.pi() ** 2 - 5 * arb.pi() + 7
        assert abs(polynomial.enclosure()[0] - expected) < arb(2) ** -90


def test_at_least_one_digit_is_asked_for():
    with pytest.raises(ValueError, match="at least 1"):
        find_polynomial_roots(problem(1, 1), 0)
