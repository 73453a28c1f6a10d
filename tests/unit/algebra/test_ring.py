"""The exact ring refuses what would be too large, and its generators stay apart."""

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.algebra import Factored, Ring, degree_in, terms_of
from symflex.algebra.ring import DEGREE_LIMIT, check_expansion, expanded_length, highest_degree
from symflex.errors import BudgetError


def test_a_generator_that_is_no_identifier_is_not_confused_with_a_parameter_of_any_name():
    names = ("s", "x1", "x2", "sqrt(k*m)", "x3", "x4", "sum0!", "x6")
    ring = Ring(names)
    assert len({str(ring.generator(n)) for n in names}) == len(names)


def test_rings_of_equal_names_are_equal_and_keep_their_order():
    assert dict(Ring(("s", "m", "b")).index) == {"s": 0, "m": 1, "b": 2}
    assert Ring(("s", "m")) == Ring(("s", "m"))


def test_compose_replaces_every_generator():
    inner, outer = Ring(("s", "a")), Ring(("s", "m", "k"))
    s, m, k = (outer.generator(n) for n in ("s", "m", "k"))
    polynomial = inner.generator("a") ** 2 + inner.generator("s")
    assert outer.compose(polynomial, [s, m + k]) == m**2 + 2 * m * k + k**2 + s


def test_expansions_of_too_many_terms_bytes_or_degrees_are_refused():
    inner = Ring(("s", "a"))
    outer = Ring(("s", *(f"p{i}" for i in range(40))))
    long = sum((outer.generator(f"p{i}") for i in range(40)), outer.constant(0))
    with pytest.raises(BudgetError) as caught:
        outer.compose(inner.generator("a") ** 20, [outer.generator("s"), long])
    assert caught.value.diagnostics[0].code == "SF501"
    inner, outer = Ring(("s", "a")), Ring(("s", "x", "y", "z"))
    s, x, y, z = outer.context.gens()
    polynomial, images = inner.generator("a") ** 2 - inner.generator("s") * 20, [s, x + y + z]
    # 7 terms of 4 names and a coefficient of 8 bytes.
    assert len(outer.compose(polynomial, images, memory_limit=84)) == 7
    with pytest.raises(BudgetError, match="would exceed 6 terms"):
        outer.compose(polynomial, images, memory_limit=83)
    ring = Ring(("s", "a"))
    high = ring.generator("s") ** (DEGREE_LIMIT // 10)
    check_expansion(ring.generator("a") ** 10, [ring.generator("s"), high], 1)
    with pytest.raises(BudgetError, match=f"the expanded form would exceed degree {DEGREE_LIMIT}"):
        check_expansion(ring.generator("a") ** 11, [ring.generator("s"), high], 1)


def test_a_power_of_a_sum_is_refused_for_one_term_more_than_the_limit(monkeypatch):
    inner, outer = Ring(("s", "a")), Ring(("s", "x", "y", "z"))
    s, x, y, z = outer.context.gens()
    # By a bound of its terms, and counted term by term; (x + y + z)^n has (n + 1) (n + 2)/2.
    for counted, (power, terms) in product((5_000, 0), ((1, 3), (2, 6), (5, 21))):
        monkeypatch.setattr("symflex.algebra.ring.MANY", counted)
        polynomial, images = -(inner.generator("a") ** power) * inner.generator("s"), [s, x + y + z]
        assert len(outer.compose(polynomial, images, term_limit=terms)) == terms
        with pytest.raises(BudgetError, match=f"the expanded form would exceed {terms - 1} terms"):
            outer.compose(polynomial, images, term_limit=terms - 1)


def test_terms_are_counted_one_by_one_and_many_large_coefficients_have_no_quick_bound(monkeypatch):
    ring = Ring(("s", "x", "y"))
    s, x, y = ring.context.gens()
    found = [expanded_length(p, (1, 2, 3)) for p in (s - 4, x * s - y, x**2 * y - x, (x * 17 + y), -x * y)]
    # C(n + e - 1, e) per power of a sum of n terms.
    assert found == [2, 5, 3 * 3 + 2, 5, 6]
    monkeypatch.setattr("symflex.algebra.ring.MANY", 1)
    ring = Ring(("s", "x", "y"))
    _, x, y = ring.context.gens()
    assert [expanded_length(p, (1, 2, 3)) for p in (x + y * 16, x + y * 17, x - y, x**2 + y)] == [
        50,
        None,
        None,
        7,
    ]


def test_a_substitution_of_monomials_is_never_refused_for_its_terms():
    ring = Ring(("s", "a", "b"))
    s, a, b = (ring.generator(n) for n in ("s", "a", "b"))
    dense = (s + a + b + 1) ** 12
    assert ring.compose(dense, [a, b, s]) == dense


def test_the_degree_is_that_in_the_generator_asked_for():
    ring = Ring(("s", "a"))
    polynomial = ring.generator("s") ** 3 * ring.generator("a") + ring.generator("a") ** 5
    assert (degree_in(polynomial, 0), degree_in(polynomial, 1), degree_in(ring.constant(0), 0)) == (3, 5, 0)


# ---------------------------------------------------------------------------------------- sparse rings


NAMES = ("s", "m", "b", "k")
TERMS = st.lists(st.tuples(st.tuples(*[st.integers(0, 2)] * 4), st.integers(-4, 4)), min_size=0, max_size=4)


def built(ring, terms):
    total = ring.constant(0)
    for exponents, coefficient in terms:
        term = ring.constant(coefficient)
        for name, exponent in zip(NAMES, exponents, strict=True):
            term = term * ring.generator(name) ** exponent
        total = total + term
    return total


def both(terms):
    return built(Ring(NAMES), terms), built(Ring(NAMES, is_sparse=True), terms)


@settings(max_examples=60)
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


@settings(max_examples=60)
@given(TERMS, TERMS)
def test_factored_values_print_alike(left, right):
    texts = []
    for is_sparse in (False, True):
        ring = Ring(NAMES, is_sparse)
        a, b = (Factored.polynomial(ring, built(ring, t)) for t in (left, right))
        texts.append((str(a + b), str(a * b), str(a - b)))
    assert texts[0] == texts[1]


@settings(max_examples=60)
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


def test_generators_that_occur_are_named_and_the_highest_degree_is_that_in_any():
    for is_sparse in [False, True]:
        ring = Ring(NAMES, is_sparse)
        s, m, b, k = (ring.generator(n) for n in NAMES)
        assert ring.used_in([s * m + m, k**2, ring.constant(0), ring.constant(3)]) == {"s", "m", "k"}, (
            is_sparse
        )
        assert ring.used_in([b * m - m * b]) == set(), is_sparse
    for is_sparse in [False, True]:
        ring = Ring(NAMES, is_sparse)
        s, m, *_ = (ring.generator(n) for n in NAMES)
        assert [highest_degree(p) for p in (s**2 * m**5 + s**4, m, ring.constant(7))] == [5, 1, 0], is_sparse


def test_a_term_takes_a_byte_per_name_and_its_coefficient_and_a_sparse_one_counts_for_more():
    assert (Ring(NAMES).bytes_of(10), Ring(NAMES, is_sparse=True).bytes_of(10)) == (120, 10_080)


def test_nothing_is_substituted_in_a_sparse_ring():
    ring = Ring(NAMES, is_sparse=True)
    with pytest.raises(BudgetError) as caught:
        ring.compose(ring.generator("s"), [ring.generator(n) for n in NAMES])
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.message) == ("SF502", "products are not expanded with 4 names")
    assert problem.hint == "ask for the nested form"


def test_only_single_terms_divide_and_only_exactly():
    ring = Ring(NAMES, is_sparse=True)
    s, m = ring.generator("s"), ring.generator("m")
    for below in (s + m, m):
        with pytest.raises(ValueError, match=r"single terms|not a polynomial"):
            (s * s) / below
