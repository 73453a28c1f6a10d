"""Minors against elimination with fractions, degree bounds against all permutations, limits at their edge."""

from fractions import Fraction
from itertools import combinations, permutations
from math import comb
from random import Random

import pytest

from symflex.algebra import Ring
from symflex.equations.elimination import determinants as module
from symflex.equations.elimination.determinants import DegreeBounds, Minors
from symflex.errors import BudgetError

RING = Ring(("s", "a", "b"))


def bareiss(matrix):
    """Return a determinant by fraction-free elimination (Bareiss 1968)."""
    rows, sign, previous = [list(row) for row in matrix], 1, Fraction(1)
    for k in range(len(rows)):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != k:
            rows[k], rows[pivot], sign = rows[pivot], rows[k], -sign
        for i in range(k + 1, len(rows)):
            for j in range(k + 1, len(rows)):
                rows[i][j] = (rows[i][j] * rows[k][k] - rows[i][k] * rows[k][j]) / previous
        previous = rows[k][k]
    return sign * previous


def at(polynomial, point):
    """Return a polynomial's value where its generators are fractions."""
    total = Fraction(0)
    for powers, coefficient in polynomial.terms():
        term = Fraction(int(coefficient))
        for x, power in zip(point, powers, strict=True):
            term *= x ** int(power)
        total += term
    return total


def sparse(seed, height, width):
    """Return random sparse rows of polynomials of low degree, some of them numbers."""
    random = Random(seed)
    s, a, b = (RING.generator(name) for name in RING.names)
    entries = (s, a * s + b, s**2 - a, RING.constant(2), RING.constant(-1), a - b, b * s - 3)
    rows = []
    for i in range(height):
        row = {i: random.choice(entries)} if random.random() < 0.8 else {}
        for column in random.sample(range(width), random.randrange(1, width)):
            row[column] = random.choice(entries)
        # The order in which a row names its columns is its own.
        rows.append(dict(random.sample(sorted(row.items(), key=lambda item: item[0]), len(row))))
    return tuple(rows)


def dense(rows, columns, point):
    return [[at(row[c], point) if c in row else Fraction(0) for c in columns] for row in rows]


def bits(columns):
    return sum(1 << c for c in columns)


POINT = (Fraction(3, 2), Fraction(-5, 7), Fraction(11, 3))


def test_determinants_over_any_columns_are_those_of_elimination_with_fractions():
    for size in [1, 2, 3, 5]:
        for seed in range(4):
            rows = sparse(seed, size, size + 2)
            minors = Minors(rows, ring=RING)
            for columns in combinations(range(size + 2), size):
                expected = bareiss(dense(rows, columns, POINT))
                assert at(minors.determinant(bits(columns)), POINT) == expected, columns


def test_a_row_on_top_goes_before_all_others():
    for seed in range(6):
        *rest, top = sparse(seed, 5, 6)
        minors = Minors(tuple(rest), ring=RING)
        for columns in combinations(range(6), 5):
            expected = bareiss(dense([top, *rest], columns, POINT))
            assert at(minors.bordered(top, bits(columns)), POINT) == expected, columns


def test_the_determinant_without_rows_is_one():
    assert Minors((), ring=RING).determinant(0) == RING.constant(1)
    assert Minors((), ring=RING).bordered({3: RING.constant(7)}, 8) == RING.constant(7)


def refused(code):
    try:
        code()
    except BudgetError as error:
        (diagnostic,) = error.diagnostics
        return diagnostic.code, diagnostic.message, diagnostic.hint
    return None


def full(size):
    """Return a matrix of as many symbols as entries, of which no two products are alike."""
    names = [f"a_{i}{j}" for i in range(size) for j in range(size)]
    ring = Ring(("s", *names))
    return tuple({j: ring.generator(f"a_{i}{j}") for j in range(size)} for i in range(size)), ring


@pytest.mark.parametrize("above", [0, -1])
def test_as_many_minors_as_the_limit_are_kept_and_not_one_more(monkeypatch, above):
    # Below row i stand all choices of size - i columns: 2^size - 1 in all, without the empty one.
    rows, ring = full(5)
    monkeypatch.setattr(module, "MINOR_LIMIT", sum(comb(5, k) for k in range(1, 6)) + above)
    minors = Minors(rows, ring=ring)
    found = refused(lambda: minors.determinant(31))
    assert (found is None) is (above == 0)
    if found:
        assert found[:2] == (
            "SF502",
            "the closed form is too large: the determinant has too many minors or terms",
        )
        assert "split the model" in found[2]
    else:
        assert refused(lambda: minors.determinant(31)) is None


def test_minors_of_determinants_before_count(monkeypatch):
    rows, ring = full(3)
    wide = tuple({**row, 3: ring.constant(1)} for row in rows)
    # Columns 0, 1, 2 have 7 minors. With 3 in place of 2, those that contain 3 are new: 1 + 2 + 1.
    monkeypatch.setattr(module, "MINOR_LIMIT", 7 + 4 - 1)
    minors = Minors(wide, ring=ring)
    assert refused(lambda: minors.determinant(0b0111)) is None
    assert refused(lambda: minors.determinant(0b1011)) is not None


@pytest.mark.parametrize("above", [0, -1])
def test_the_memory_of_all_minors_together_has_a_limit(monkeypatch, above):
    # A minor of k rows of symbols has k! terms: 3 of one, 3 of two, one of six.
    rows, ring = full(3)
    monkeypatch.setattr(module, "MEMORY_LIMIT", ring.bytes_of(3 * 1 + 3 * 2 + 6) + above)
    found = refused(lambda: Minors(rows, ring=ring).determinant(7))
    assert found == (
        None
        if above == 0
        else (
            "SF502",
            "the closed form is too large: the determinant has too many minors or terms",
            "split the model or give it fewer nodes",
        )
    )


@pytest.mark.parametrize("above", [0, -1])
def test_a_product_that_would_be_too_large_is_refused_before_it_is_made(monkeypatch, above):
    ring = Ring(("s", "a", "b", "c", "d"))
    s, a, b, c, d = (ring.generator(name) for name in ring.names)
    # The first product has one term, the second is 2 by 3.
    below = ({0: s + a + b, 1: c},)
    minors = Minors(below, ring=ring)
    minors.determinant(1)
    minors.determinant(2)
    monkeypatch.setattr(module, "MEMORY_LIMIT", ring.bytes_of(1 + 2 * 3) + above)
    found = refused(lambda: minors.bordered({0: d, 1: c + d}, 3))
    assert found == (
        None
        if above == 0
        else (
            "SF502",
            "the closed form is too large: a minor has too many terms",
            "split the model or give it fewer nodes",
        )
    )


def test_rows_up_to_the_limit_are_taken():
    for count, is_refused in [(700, False), (701, True)]:
        found = refused(lambda rows=count: Minors(({0: RING.constant(1)},) * rows, ring=RING))
        assert (found is not None) is is_refused, count
        if found:
            assert "701 unknowns remain after elimination, more than 700" in found[1], count


def highest_product(rows, columns):
    """Return the largest sum of degrees along a permutation, -1 where no permutation has all entries."""
    sums = [
        sum(row[c] for row, c in zip(rows, order, strict=True))
        for order in permutations(columns)
        if all(c in row for row, c in zip(rows, order, strict=True))
    ]
    return max(sums, default=-1)


def test_the_degree_bound_is_the_largest_sum_along_a_permutation():
    for seed in range(12):
        random = Random(seed)
        rows = tuple({c: random.randrange(4) for c in range(5) if random.random() < 0.5} for _ in range(4))
        bounds = DegreeBounds(rows)
        top = {c: random.randrange(4) for c in range(5) if random.random() < 0.6}
        for columns in combinations(range(5), 4):
            assert bounds.determinant(bits(columns)) == highest_product(rows, columns), seed
        assert bounds.bordered(top, 31) == highest_product((top, *rows), range(5)), seed
