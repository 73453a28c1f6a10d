"""Sparse polynomials behave as the engine's do."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symflex.algebra import Factored, Ring, degree_in, terms_of
from symflex.algebra.ring import highest_degree
from symflex.errors import BudgetError

NAMES = ("s", "m", "b", "k")
TERMS = st.lists(st.tuples(st.tuples(*[st.integers(0, 2)] * 4), st.integers(-4, 4)), min_size=0, max_size=4)


def built(ring, terms):
    total = ring.constant(0)
    for exponents, coefficient in terms:
        product = ring.constant(coefficient)
        for name, exponent in zip(NAMES, exponents, strict=True):
            product = product * ring.generator(name) ** exponent
        total = total + product
    return total


def both(terms):
    return built(Ring(NAMES), terms), built(Ring(NAMES, is_sparse=True), terms)


@given(TERMS, TERMS)
def test_arithmetic_is_that_of_the_engine(left, right):
    (a, x), (b, y) = both(left), both(right)
    for dense, sparse in (
        (a + b, x + y), (a - b, x - y), (a * b, x * y), (-a, -x), (a**3, x**3), (a**0, x**0), (a * 0, x * 0)
    ):  # fmt: skip
        assert str(dense) == str(sparse)
        assert dense.is_one() == sparse.is_one()
        assert list(terms_of(dense)) == list(terms_of(sparse))
        assert len(dense) == len(sparse)
        assert dense.is_zero() == sparse.is_zero()
        assert dense.is_constant() == sparse.is_constant()
        assert [degree_in(dense, i) for i in range(4)] == [degree_in(sparse, i) for i in range(4)]
        if len(sparse):
            assert int(dense.leading_coefficient()) == sparse.leading_coefficient()
            content, common = dense.term_content(), sparse.term_content()
            assert list(terms_of(content)) == list(terms_of(common))
            assert list(terms_of(dense / content)) == list(terms_of(sparse / common))


@given(TERMS, TERMS)
def test_factored_values_print_alike(left, right):
    texts = []
    for is_sparse in (False, True):
        ring = Ring(NAMES, is_sparse)
        a, b = (Factored.polynomial(ring, built(ring, t)) for t in (left, right))
        texts.append((str(a + b), str(a * b), str(a - b)))
    assert texts[0] == texts[1]


@given(TERMS)
def test_equal_polynomials_are_one_in_a_set(terms):
    (_, x), (_, y) = both(terms), both(terms[::-1])
    assert len({x, y, x * 1}) == 1
    assert x not in {y + both([((0, 0, 0, 0), 1)])[1]}


def test_a_quotient_by_a_term_has_every_coefficient_divided():
    s, m, b, _ = (Ring(NAMES, is_sparse=True).generator(n) for n in NAMES)
    assert (s**2 * m * 6 - s * b * 4) / (s * -2) == s * m * -3 + b * 2
    with pytest.raises(ValueError, match="not a polynomial"):
        (s * m * 6 + s * 3) / (s * 2)


@pytest.mark.parametrize("is_sparse", [False, True])
def test_the_generators_that_occur_are_named(is_sparse):
    ring = Ring(NAMES, is_sparse)
    s, m, b, k = (ring.generator(n) for n in NAMES)
    assert ring.used_in([s * m + m, k**2, ring.constant(0), ring.constant(3)]) == {"s", "m", "k"}
    assert ring.used_in([b * m - m * b]) == set()


@pytest.mark.parametrize("is_sparse", [False, True])
def test_the_highest_degree_is_that_in_any_generator(is_sparse):
    ring = Ring(NAMES, is_sparse)
    s, m, *_ = (ring.generator(n) for n in NAMES)
    assert [highest_degree(p) for p in (s**2 * m**5 + s**4, m, ring.constant(7))] == [5, 1, 0]


def test_a_term_takes_a_byte_per_name_and_its_coefficient_and_a_sparse_one_counts_for_more():
    assert (Ring(NAMES).bytes_of(10), Ring(NAMES, is_sparse=True).bytes_of(10)) == (120, 10_080)


def test_nothing_is_substituted_in_a_sparse_ring():
    ring = Ring(NAMES, is_sparse=True)
    with pytest.raises(BudgetError) as caught:
        ring.compose(ring.generator("s"), [ring.generator(n) for n in NAMES])
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.message) == ("SF502", "nothing is multiplied out with 4 names")
    assert problem.hint == "ask for the nested form"


def test_only_single_terms_divide_and_only_exactly():
    ring = Ring(NAMES, is_sparse=True)
    s, m = ring.generator("s"), ring.generator("m")
    for below in (s + m, m):
        with pytest.raises(ValueError, match=r"single terms|not a polynomial"):
            (s * s) / below
