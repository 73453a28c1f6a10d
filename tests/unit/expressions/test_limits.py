from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.expressions.limits import (
    size_of_negative,
    size_of_number,
    size_of_power,
    size_of_product,
    size_of_quotient,
    size_of_sum,
)


def product(values):
    result = Fraction(1)
    for value in values:
        result *= value
    return result


# Pairs of a value, computed by the fractions of the standard library, and its bound.
numbers = st.fractions(0, 10**6, max_denominator=10**4).map(lambda v: (v, size_of_number(v)))


def grown(pairs):
    several = st.lists(pairs, min_size=2, max_size=4)
    return st.one_of(
        pairs.map(lambda p: (-p[0], size_of_negative(p[1]))),
        several.map(lambda ps: (sum(v for v, _ in ps), size_of_sum([size for _, size in ps]))),
        several.map(lambda ps: (product(v for v, _ in ps), size_of_product([size for _, size in ps]))),
        st.tuples(pairs, pairs.filter(lambda p: p[0] != 0)).map(
            lambda ps: (ps[0][0] / ps[1][0], size_of_quotient(ps[0][1], ps[1][1]))
        ),
        st.tuples(pairs.filter(lambda p: p[0] != 0), st.integers(-3, 3)).map(
            lambda p: (p[0][0] ** p[1], size_of_power(p[0][1], exponent(p[1])))
        ),
    )


def exponent(value):
    size = size_of_number(Fraction(abs(value)))
    return size_of_negative(size) if value < 0 else size


sized = st.recursive(numbers, grown, max_leaves=15)


@settings(max_examples=50)
@given(sized)
@pytest.mark.slow
def test_no_value_exceeds_its_bound_and_a_followed_value_is_the_value(pair):
    value, size = pair
    assert abs(value.numerator) <= 2**size.upper
    assert value.denominator <= 2**size.lower
    assert size.value in (None, value)


def test_the_bound_of_an_integer_sum_grows_like_a_logarithm():
    assert size_of_sum([size_of_number(Fraction(1))] * 1024).upper == 10
