"""Roots against formulas and other people's algorithms, close together, and of every engine."""

import math
from fractions import Fraction

import pytest
from flint import acb_poly, arb, fmpz_poly
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.balls import precision
from symflex.errors import UncertifiedError
from symflex.roots import PolynomialInS, RootProblem, find_polynomial_roots
from symflex.roots.engines import GUESSES
from symflex.roots.polynomials.discs import propose_by_laguerre
from tests.unit.roots.root_problems import chain, from_roots, problem, problem_of, with_pi, with_root_of_two


def test_frequencies_in_hz_are_exact_and_keep_their_damping_ratio():
    polynomial = with_pi(lambda pi, one: (484 * pi**2, 0 * one, one))  # s^2 + (22 pi)^2
    upper, lower = find_polynomial_roots(RootProblem(((polynomial, 1),)), 50)
    assert upper.on_imaginary_axis
    assert lower.on_imaginary_axis
    assert upper.frequency_hz() == 11.0
    with precision(300):
        assert upper.im.overlaps(22 * arb.pi())
        assert (upper.im / (22 * arb.pi()) - 1).abs_upper() < arb(10) ** -50
    # s^2 + 2 (1/50) (22 pi) s + (22 pi)^2
    polynomial = with_pi(lambda pi, one: (12100 * pi**2, 22 * pi, 25 * one))
    upper, _ = find_polynomial_roots(RootProblem(((polynomial, 1),)), 30)
    assert upper.damping_ratio() == pytest.approx(0.02, abs=1e-16)
    assert upper.frequency_hz() == pytest.approx(11.0, abs=1e-14)


def test_a_thousand_digits_are_those_of_integer_square_roots():
    _, root = find_polynomial_roots(problem(-2, 0, 1), 1000)
    upper, _ = find_polynomial_roots(problem(3, 1, 1), 1000)  # -1/2 +- j sqrt(11)/2
    for found, square in (
        (root.decimal(1000).re, 2 * 10**2100),
        (upper.decimal(1000).im, 11 * 10**2100 // 4),
    ):
        assert found[:999].replace(".", "") == str(math.isqrt(square))[:998]


def test_coefficients_and_roots_beyond_the_range_of_doubles_are_solved():
    roots = find_polynomial_roots(problem(-(10**400), 0, 1), 30)
    assert [root.decimal(30).re for root in roots] == [f"{sign}1.{'0' * 29}e200" for sign in ("-", "")]
    upper, lower = find_polynomial_roots(problem(10**900, 0, 1), 20)
    assert (upper.decimal(20).im, lower.decimal(20).im) == (f"1.{'0' * 19}e450", f"-1.{'0' * 19}e450")


# ---------------------------------- roots that lie close together, and roots that constants make equal


TINY = Fraction(1, 10**30)


def contains(ball, value):
    with precision(2000):
        return bool(ball.overlaps(arb(value.numerator) / value.denominator))


@pytest.mark.slow
def test_roots_too_close_to_be_told_apart_are_enclosed_as_one_and_not_certified():
    close = [1, 1 + TINY, 1 + TINY**2, 1 + TINY**3, -2]
    # x^50 - 2 (1e9 x - 1)^2 has two roots about 1e-234 apart
    mignotte = fmpz_poly([0] * 50 + [1]) - 2 * fmpz_poly([-1, 10**9]) ** 2
    ring = 10**240 * fmpz_poly([-1, 1]) ** 12 + 1
    cases = ((problem(*from_roots(close)), 5), (problem_of(mignotte), 50), (problem_of(ring), 12))
    for case, count in cases:
        roots = find_polynomial_roots(case, 20)
        assert sum(root.multiplicity for root in roots) == count
        assert all(root.certified == (root.multiplicity == 1) for root in roots)


def test_double_roots_by_a_hidden_relation_are_uncertified_discs():
    # (s - sqrt 2)^2 written so that exact steps, which do not know sqrt(2)^2 = 2, see no square
    polynomial = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    (root,) = find_polynomial_roots(RootProblem(((polynomial, 3),)), 30)
    assert (root.multiplicity, root.certified) == (6, False)
    with precision(300):
        assert root.re.overlaps(arb(2).sqrt())
    assert root.re.rad() < arb(10) ** -30
    # (s^2 + sqrt 2)^2
    polynomial = with_root_of_two(lambda root, one: (2 * one, 0 * one, 2 * root, 0 * one, one))
    upper, lower = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert [(r.multiplicity, r.certified) for r in (upper, lower)] == [(2, False), (2, False)]
    with precision(300):
        assert upper.im.overlaps(arb(2).root(4))
        assert lower.im.overlaps(-(arb(2).root(4)))
    # ((s + 1)^2 + 2)^2 with 9 written as 5 + 2 sqrt(2)^2: s^4 + 4 s^3 + 10 s^2 + 12 s + 9
    polynomial = with_root_of_two(lambda root, one: (5 + 2 * root**2, 12 * one, 10 * one, 4 * one, one))
    roots = find_polynomial_roots(RootProblem(((polynomial, 1),)), 20)
    assert [(r.multiplicity, r.certified) for r in roots] == [(2, False), (2, False)]
    with precision(300):
        assert roots[0].re.contains(-1)
        assert roots[0].im.overlaps(arb(2).sqrt())
    # (s - sqrt 2)^3 (s^2 - 2)
    first = with_root_of_two(lambda root, one: (-root, one))
    roots = find_polynomial_roots(RootProblem(((first, 3), (PolynomialInS.from_integers([-2, 0, 1]), 1))), 20)
    assert [(r.multiplicity, r.certified) for r in roots] == [(1, True), (4, False)]
    assert roots[1].re.rad() < arb(10) ** -20


def test_a_hidden_double_root_among_many_leaves_the_others_certified():
    links = [int(c) for c in chain(12, 60, 95000, 40).coeffs()]

    def rows(root, one):
        square = (2 * one, -2 * root, one)
        product = [0 * one] * (len(links) + 2)
        for i, link in enumerate(links):
            for j, c in enumerate(square):
                product[i + j] += link * c
        return product

    roots = find_polynomial_roots(RootProblem(((with_root_of_two(rows), 1),)), 20)
    assert sorted((r.multiplicity, r.certified) for r in roots) == [(1, True)] * 24 + [(2, False)]


def test_sizes_beyond_the_reach_of_doubles_are_refused_not_guessed():
    with pytest.raises(UncertifiedError, match="SF404"):
        find_polynomial_roots(problem(Fraction(1, 10**400), 3, Fraction(1, 10**100), 0, 7, 5), 10)


# --------------------------------------------------------------------------- every engine that guesses


PROBLEMS = {
    "linear": problem(3, 2), "axis": problem(16, 0, 8, 0, 1),
    "real": problem(*from_roots([1, 2, 3, -4, -50])), "damped": problem_of(chain(8, 3, 500, 2)),
    "cyclotomic": problem_of(fmpz_poly.cyclotomic(29)), "rigid": problem(0, 0, 0, 5, 1, 1),
    "constant": problem(5),
}  # fmt: skip


def test_every_engine_finds_as_many_roots_as_the_degree_and_all_agree():
    for name, factored in PROBLEMS.items():
        (polynomial, _), *_ = factored.factors
        value = fmpz_poly(list(polynomial.integers()))
        expected = find_polynomial_roots(factored, 20)
        for engine, guess in GUESSES.items():
            roots = find_polynomial_roots(factored, 20, (guess.propose,))
            assert sum(root.multiplicity for root in roots) == factored.degree, (name, engine)
            for one, other in zip(roots, expected, strict=True):
                assert value(one.enclosure()).contains(0), (name, engine)
                assert one.enclosure().overlaps(other.enclosure()), (name, engine)


# ---------------------------------------------------------------- Facts that hold for every polynomial


SMALL = st.integers(min_value=-20, max_value=20)
COEFFICIENTS = st.lists(SMALL, min_size=2, max_size=12).filter(lambda c: c[-1] != 0)


@settings(max_examples=40)
@given(COEFFICIENTS, st.integers(min_value=1, max_value=60))
def test_linear_factors_multiply_to_the_polynomial_conjugates_come_together_and_digits_are_those_asked_for(
    coefficients, digits
):
    roots = find_polynomial_roots(problem_of(fmpz_poly(coefficients)), digits)
    with precision(300):
        product = acb_poly([coefficients[-1]])
        for root in roots:
            product *= acb_poly([-root.enclosure(), 1]) ** root.multiplicity
        assert all(product[i].contains(c) for i, c in enumerate(coefficients))
    with precision(1000):
        points = {(str(r.re.mid().man_exp()), str(r.im.mid().man_exp())) for r in roots}
        assert points == {(str(r.re.mid().man_exp()), str((-r.im).mid().man_exp())) for r in roots}
    for ball in (part for root in roots for part in (root.re, root.im)):
        assert ball == 0 or ball.rad() <= ball.abs_lower() * arb(10) ** -digits


def test_constants_with_a_hidden_relation_need_an_engine_that_bears_double_roots():
    polynomial = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    roots = find_polynomial_roots(type(PROBLEMS["real"])(((polynomial, 1),)), 10, (propose_by_laguerre,))
    assert [root.multiplicity for root in roots] == [2]
