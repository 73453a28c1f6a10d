"""The exact ring refuses what would be too large, and its generators stay apart."""

from __future__ import annotations

import pytest

from symflex.algebra import Ring, degree_in
from symflex.algebra.ring import DEGREE_LIMIT, check_expansion, expanded_length
from symflex.errors import BudgetError


def test_a_generator_that_is_no_identifier_is_not_confused_with_a_parameter_of_any_name():
    names = ("s", "x1", "x2", "sqrt(k*m)", "x3", "x4", "sum0!", "x6")
    ring = Ring(names)
    assert len({str(ring.generator(n)) for n in names}) == len(names)


def test_the_index_is_the_declared_order():
    assert dict(Ring(("s", "m", "b")).index) == {"s": 0, "m": 1, "b": 2}


def test_rings_of_equal_names_are_equal():
    assert Ring(("s", "m")) == Ring(("s", "m"))


def test_compose_replaces_every_generator():
    inner, outer = Ring(("s", "a")), Ring(("s", "m", "k"))
    s, m, k = (outer.generator(n) for n in ("s", "m", "k"))
    polynomial = inner.generator("a") ** 2 + inner.generator("s")
    assert outer.compose(polynomial, [s, m + k]) == m**2 + 2 * m * k + k**2 + s


def test_compose_refuses_a_result_of_millions_of_terms():
    inner = Ring(("s", "a"))
    outer = Ring(("s", *(f"p{i}" for i in range(40))))
    long = sum((outer.generator(f"p{i}") for i in range(40)), outer.constant(0))
    with pytest.raises(BudgetError) as caught:
        outer.compose(inner.generator("a") ** 20, [outer.generator("s"), long])
    assert caught.value.diagnostics[0].code == "SF501"


@pytest.mark.parametrize(
    ("power", "terms"),
    [(1, 3), (2, 6), (5, 21)],  # (x + y + z)^n has (n + 1) (n + 2)/2 terms
)
@pytest.mark.parametrize("counted", [5_000, 0], ids=["by its bound", "term by term"])
def test_a_power_of_a_sum_is_refused_for_one_term_more_than_the_limit(monkeypatch, power, terms, counted):
    monkeypatch.setattr("symflex.algebra.ring.MANY", counted)
    inner, outer = Ring(("s", "a")), Ring(("s", "x", "y", "z"))
    s, x, y, z = outer.context.gens()
    polynomial, images = -(inner.generator("a") ** power) * inner.generator("s"), [s, x + y + z]
    assert len(outer.compose(polynomial, images, term_limit=terms)) == terms
    with pytest.raises(BudgetError, match=f"the expanded form would exceed {terms - 1} terms"):
        outer.compose(polynomial, images, term_limit=terms - 1)


def test_memory_limits_the_terms_too():
    inner, outer = Ring(("s", "a")), Ring(("s", "x", "y", "z"))
    s, x, y, z = outer.context.gens()
    polynomial, images = inner.generator("a") ** 2 - inner.generator("s") * 20, [s, x + y + z]
    # 7 terms of 4 names and a coefficient of 8 bytes.
    assert len(outer.compose(polynomial, images, memory_limit=84)) == 7
    with pytest.raises(BudgetError, match="would exceed 6 terms"):
        outer.compose(polynomial, images, memory_limit=83)


def test_terms_of_either_sign_are_counted_one_by_one():
    ring = Ring(("s", "x", "y"))
    s, x, y = ring.context.gens()
    found = [expanded_length(p, (1, 2, 3)) for p in (s - 4, x * s - y, x**2 * y - x, (x * 17 + y), -x * y)]
    # C(n + e - 1, e) per power of a sum of n terms.
    assert found == [2, 5, 3 * 3 + 2, 5, 6]


def test_many_large_coefficients_have_no_quick_bound(monkeypatch):
    monkeypatch.setattr("symflex.algebra.ring.MANY", 1)
    ring = Ring(("s", "x", "y"))
    _, x, y = ring.context.gens()
    assert [expanded_length(p, (1, 2, 3)) for p in (x + y * 16, x + y * 17, x - y, x**2 + y)] == [
        50,
        None,
        None,
        7,
    ]


def test_compose_refuses_a_degree_beyond_the_limit():
    ring = Ring(("s", "a"))
    high = ring.generator("s") ** (DEGREE_LIMIT // 10)
    check_expansion(ring.generator("a") ** 10, [ring.generator("s"), high], 1)
    with pytest.raises(BudgetError, match=f"the expanded form would exceed degree {DEGREE_LIMIT}"):
        check_expansion(ring.generator("a") ** 11, [ring.generator("s"), high], 1)


def test_a_substitution_of_monomials_is_never_refused_for_its_terms():
    ring = Ring(("s", "a", "b"))
    s, a, b = (ring.generator(n) for n in ("s", "a", "b"))
    dense = (s + a + b + 1) ** 12
    assert ring.compose(dense, [a, b, s]) == dense


def test_the_degree_of_zero_is_zero():
    ring = Ring(("s", "a"))
    assert degree_in(ring.constant(0), 0) == 0


def test_the_degree_is_that_in_the_generator_asked_for():
    ring = Ring(("s", "a"))
    polynomial = ring.generator("s") ** 3 * ring.generator("a") + ring.generator("a") ** 5
    assert (degree_in(polynomial, 0), degree_in(polynomial, 1)) == (3, 5)
