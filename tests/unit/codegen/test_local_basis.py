from fractions import Fraction
from math import factorial, log

import mpmath
import pytest

from symflex.codegen.program.series import LocalBasis, series_length, taylor_term


def test_the_logarithm_of_a_taylor_term_is_that_of_its_quotient():
    for size, order in ((3.0, 0), (3.0, 1), (3.0, 40), (0.5, 300), (700.0, 500), (0.0, 0)):
        expected = mpmath.log(mpmath.mpf(size) ** order / mpmath.factorial(order))
        assert taylor_term(size, order) == pytest.approx(float(expected), rel=1e-13, abs=1e-12)


def test_a_taylor_term_of_nothing_is_nothing():
    assert taylor_term(0.0, 3) == -float("inf")


def test_a_series_stops_where_the_first_term_left_out_is_below_the_last_digit():
    m = series_length(3.0) - 1
    assert 3.0**m / factorial(m) < 1e-19 < 3.0 ** (m - 1) / factorial(m - 1)


def test_an_equation_of_order_400_has_solutions_whose_factorials_exceed_a_double():
    basis = LocalBasis(1, 400, ({(0, 0): -1}, *({} for _ in range(399))))
    # y^(400) = y: solution 399 is x^399/399! + x^799/799! + ..., and the second term is below any double.
    assert basis.series(399, 3.0) == (Fraction(1, factorial(399)),)
    assert log(factorial(399)) > 709
