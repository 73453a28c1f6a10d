from __future__ import annotations

from math import gcd

from hypothesis import given
from hypothesis import strategies as st

from symflex.algebra import Ring, irreducible_factors, square_free_factors

S, K = Ring(("s", "k")).context.gens()
LARGE = 2**400

coefficients = st.integers(min_value=-LARGE, max_value=LARGE).filter(bool)


@st.composite
def lines(draw):
    """A polynomial linear in s, with content 1 and positive leading coefficient: no polynomial divides it."""
    a, b = draw(st.integers(1, LARGE)), draw(coefficients)
    common = gcd(a, b)
    return S * (a // common) + K ** draw(st.integers(0, 2)) * (b // common)


@st.composite
def products(draw):
    """A number, and different irreducible polynomials with exponents."""
    found = draw(
        st.lists(st.tuples(lines(), st.integers(1, 3)), min_size=1, max_size=4, unique_by=lambda p: str(p[0]))
    )
    return draw(coefficients), {str(factor): exponent for factor, exponent in found}, found


def multiplied(number, factors):
    result = S**0 * number
    for factor, exponent in factors:
        result = result * factor**exponent
    return result


@given(products())
def test_what_linear_factors_of_any_size_were_multiplied_to_is_taken_apart_again(product):
    number, expected, factors = product
    found_number, found = irreducible_factors(multiplied(number, factors))
    assert (found_number, {str(f): e for f, e in found}) == (number, expected)


@given(products())
def test_square_free_parts_of_any_size_multiply_to_what_they_are_of(product):
    whole = multiplied(product[0], product[2])
    assert multiplied(*square_free_factors(whole)) == whole


@given(products())
def test_square_free_parts_of_any_size_have_no_multiple_root(product):
    _, found = square_free_factors(multiplied(product[0], product[2]))
    assert all(part.gcd(part.derivative("s")).is_constant() for part, _ in found if part.degrees()[0])


@given(products())
def test_factors_stand_by_exponent_and_then_by_terms_whatever_their_size(product):
    _, found = irreducible_factors(multiplied(product[0], product[2]))
    keys = [(exponent, [(m, int(c)) for m, c in factor.terms()]) for factor, exponent in found]
    assert keys == sorted(keys)
