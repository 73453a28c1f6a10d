"""Facts that hold for every polynomial."""

from __future__ import annotations

import mpmath
import pytest
from flint import acb, acb_poly, arb, fmpz_poly
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from symflex.roots import find_polynomial_roots, precision
from tests.unit.roots.root_problems import problem_of

SMALL = st.integers(min_value=-20, max_value=20)
COEFFICIENTS = st.lists(SMALL, min_size=2, max_size=12).filter(lambda c: c[-1] != 0)
FACTORS = st.lists(
    st.tuples(st.lists(SMALL, min_size=2, max_size=4).filter(lambda c: c[-1] != 0), st.integers(1, 3)),
    min_size=1,
    max_size=4,
)


@given(COEFFICIENTS)
def test_the_product_of_linear_factors_is_the_polynomial(coefficients):
    roots = find_polynomial_roots(problem_of(fmpz_poly(coefficients)), 15)
    with precision(200):
        product = acb_poly([coefficients[-1]])
        for root in roots:
            for _ in range(root.multiplicity):
                product *= acb_poly([-root.enclosure(), 1])
        assert all(product[i].contains(c) for i, c in enumerate(coefficients))


@pytest.mark.slow
@given(FACTORS)
def test_multiplicities_of_a_product_add_up_to_its_degree(factors):
    product = fmpz_poly([1])
    for coefficients, exponent in factors:
        product *= fmpz_poly(coefficients) ** exponent
    roots = find_polynomial_roots(problem_of(product), 10)
    assert sum(root.multiplicity for root in roots) == product.degree()


@pytest.mark.slow
@given(FACTORS)
def test_multiplicities_are_those_of_the_square_free_factorisation(factors):
    product = fmpz_poly([1])
    for coefficients, exponent in factors:
        product *= fmpz_poly(coefficients) ** exponent
    expected = sorted(m for factor, m in product.factor_squarefree()[1] for _ in range(factor.degree()))
    roots = find_polynomial_roots(problem_of(product), 10)
    assert sorted(root.multiplicity for root in roots) == expected


@given(FACTORS)
def test_enclosures_of_distinct_roots_are_disjoint(factors):
    product = fmpz_poly([1])
    for coefficients, _ in factors:
        product *= fmpz_poly(coefficients)
    roots = find_polynomial_roots(problem_of(product), 10)
    boxes = [root.enclosure() for root in roots]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


@given(COEFFICIENTS)
def test_conjugates_come_together(coefficients):
    roots = find_polynomial_roots(problem_of(fmpz_poly(coefficients)), 10)
    points = {(str(r.re.mid().man_exp()), str(r.im.mid().man_exp())) for r in roots}
    with precision(1000):
        mirrored = {(str(r.re.mid().man_exp()), str((-r.im).mid().man_exp())) for r in roots}
    assert points == mirrored


@settings(max_examples=40)
@given(COEFFICIENTS)
@pytest.mark.slow
def test_enclosures_contain_the_roots_mpmath_finds_at_higher_precision(coefficients):
    polynomial = fmpz_poly(coefficients)
    assume(polynomial.gcd(polynomial.derivative()).degree() == 0)
    roots = find_polynomial_roots(problem_of(polynomial), 10)
    with mpmath.workdps(80):
        values = mpmath.polyroots(coefficients[::-1], maxsteps=2000, extraprec=2000)
    for value in values:
        with precision(400):
            near = acb(arb(mpmath.nstr(value.real, 70), 1e-50), arb(mpmath.nstr(value.imag, 70), 1e-50))
        assert sum(bool(root.enclosure().overlaps(near)) for root in roots) == 1


@given(COEFFICIENTS, st.integers(min_value=1, max_value=60))
def test_digits_asked_for_are_digits_given(coefficients, digits):
    for root in find_polynomial_roots(problem_of(fmpz_poly(coefficients)), digits):
        for ball in (root.re, root.im):
            assert ball == 0 or ball.rad() <= ball.abs_lower() * arb(10) ** -digits
