"""Sparse polynomials behave as the engine's do."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symflex.errors import BudgetError
from symflex.kernels import Factored, Ring, degree_in, terms_of

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
    for dense, sparse in ((a + b, x + y), (a - b, x - y), (a * b, x * y), (-a, -x), (a**3, x**3)):
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


def test_nothing_is_substituted_in_a_sparse_ring():
    ring = Ring(NAMES, is_sparse=True)
    with pytest.raises(BudgetError) as caught:
        ring.compose(ring.generator("s"), [ring.generator(n) for n in NAMES])
    assert caught.value.diagnostics[0].code == "SF502"


def test_only_single_terms_divide_and_only_exactly():
    ring = Ring(NAMES, is_sparse=True)
    s, m = ring.generator("s"), ring.generator("m")
    for below in (s + m, m):
        with pytest.raises(ValueError, match=r"single terms|not a polynomial"):
            (s * s) / below
