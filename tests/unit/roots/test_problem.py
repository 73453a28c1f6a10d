"""Exact polynomials with constants as coefficients, and their splitting into coprime square-free parts."""

import pytest
from flint import fmpz_mpoly_ctx

from symflex.errors import ModelError, UncertifiedError
from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots
from symflex.roots.problem import _Ring, split
from tests.unit.roots.root_problems import problem, with_pi, with_root_of_two


def test_polynomials_that_are_zero_lack_constants_or_contain_some_are_refused():
    for coefficients in [[], [0], [0, 0]]:
        with pytest.raises(ModelError, match=r"SF403.*: the polynomial is zero: every s is a root of it$"):
            PolynomialInS.from_integers(coefficients)
    context = fmpz_mpoly_ctx.get(["pi"], "lex")
    with pytest.raises(ValueError, match=r"^1 generators but 0 constants$"):
        PolynomialInS((context.constant(1),), context, ())
    with pytest.raises(ValueError, match=r"^exponents of factors are positive$"):
        RootProblem(((PolynomialInS.from_integers([1, 1]), 0),))
    with pytest.raises(ValueError, match=r"^the coefficients contain constants$"):
        with_pi(lambda pi, one: (pi, one)).integers()
    with pytest.raises(ValueError, match="at least 1"):
        find_polynomial_roots(problem(1, 1), 0)


def test_a_leading_coefficient_that_may_vanish_is_refused_and_one_that_is_small_told_from_zero():
    polynomial = with_root_of_two(lambda root, one: (one, one, root**2 - 2))
    with pytest.raises(UncertifiedError, match="SF401") as failed:
        find_polynomial_roots(RootProblem(((polynomial, 1),)), 10)
    (diagnostic,) = failed.value.diagnostics
    assert diagnostic.message.startswith("cannot tell whether the coefficient ")
    assert diagnostic.message.endswith(" of s^2 is zero")
    assert diagnostic.hint == "its constants seem to satisfy a relation; write the coefficient without it"
    # pi^2 - 9.8696044010893586 is 2e-17
    polynomial = with_pi(lambda pi, one: (one, 10**16 * pi**2 - 98696044010893586))
    polynomial.require_leading_coefficient()


# ------------------------------------------------------ Exact splitting into coprime square-free parts


def parts_of(problem):
    return sorted((p.polynomial.integers(), p.multiplicity, p.in_square) for p in split(problem).parts)


def test_the_even_part_holds_axis_pairs_and_mirrored_roots_only():
    # (s^2 + 9)(s - 2)(s + 2)(s + 5)
    coefficients = [-180, -36, 25, 5, 5, 1]
    assert parts_of(problem(*coefficients)) == [((-36, 5, 1), 1, True), ((5, 1), 1, False)]


def test_a_mirror_image_changes_the_signs_of_odd_powers_of_s_alone():
    context = fmpz_mpoly_ctx.get(["s", "c0"], "lex")
    s, c = context.gens()
    image = _Ring(context, ()).reflect(s**3 * c + 2 * s**2 * c**3 + 5 * s + 7 * c)
    assert image == 2 * s**2 * c**3 + 7 * c - s**3 * c - 5 * s
