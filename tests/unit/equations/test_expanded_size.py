"""The estimate of a determinant's size, on programs and rows small enough to count by hand."""

from math import exp, log
from types import SimpleNamespace

import pytest

from symflex.algebra import Factored, Ring
from symflex.algebra.straight_line import Step, StraightLine
from symflex.equations.elimination.determinants import _forests, _monomials, expanded_terms

RING = Ring(("s", "k", "m", "pi"))
S, K, M, PI = (RING.generator(name) for name in RING.names)


def elimination(steps, *pivots, roles=None):
    kinds, operands = zip(*steps, strict=True)
    return SimpleNamespace(program=StraightLine(("a", "b"), kinds, operands, roles or {}), pivots=pivots)


A, B, NONE, FIVE = (
    (Step.GENERATOR, (0,)),
    (Step.GENERATOR, (1,)),
    (Step.NUMBER, (0, 1)),
    (Step.NUMBER, (5, 2)),
)


def test_a_pivot_counts_terms_where_every_name_is_one():
    for steps, value in [
        ([A, B, (Step.ADD, (0, 1, 1))], 3),
        ([A, FIVE, (Step.ADD, (0, 1))], 2),
        ([A, NONE, (Step.ADD, (0, 0, 1))], 2),
        ([A, (Step.ADD, (0, 0)), (Step.ADD, (0, 0, 0)), (Step.MULTIPLY, (1, 2))], 6),
        ([A, (Step.ADD, (0, 0)), (Step.ADD, (0, 0, 0)), (Step.DIVIDE, (2, 1))], 1.5),
        ([A, (Step.ADD, (0, 0, 0)), (Step.NEGATE, (1,)), (Step.ADD, (0, 2))], 2),
        ([A, (Step.ADD, (0, 0, 0)), (Step.POWER, (1, 4))], 81),
        ([A, NONE, (Step.ADD, (0, 0)), (Step.DIVIDE, (2, 1))], 1),
    ]:
        assert _forests(elimination(steps, len(steps) - 1)) == pytest.approx(log(value)), steps


def rows(*entries):
    """Return equations of the rows of factored entries, as far as sizes are read off them."""
    forms = [SimpleNamespace(form=SimpleNamespace(terms=[(None, e) for e in row])) for row in entries]
    return SimpleNamespace(ring=RING, rows=forms)


def product(*factors):
    value = Factored.number(RING, 1)
    for polynomial, exponent in factors:
        value = value * Factored.polynomial(RING, polynomial) ** exponent
    return value


def test_monomials_are_counted_up_to_the_powers_that_rows_reach():
    for entries, count in [
        # The highest power of each name in a row, added over the rows, and one more for none.
        ([[product((S, 2)), product((S, 1))]], 3),
        ([[product((S, 2))], [product((S, 3))]], 6),
        ([[product((S, 2), (K, 1))], [product((K, 1), (M, 1))]], 3 * 3 * 2),
        # A sum with a parameter is one name, of s and pi alone it has their powers.
        ([[product((S + K, 2))]], 3),
        ([[product((S + K, 2)), product((S + K, 1))], [product((S + K, 1))]], 4),
        ([[product((S**2 + 3 * S, 1)), product((S**3 + 1, 1))]], 4),
        ([[product((S**2 + PI, 2))]], 5 * 3),
        ([[product((S + K, 1), (M, 1), (S**2 + K + M, 1))]], 2 * 2 * 2),
        # What is divided by has no power.
        ([[product((S, -2)), product((K, 1))]], 2),
        ([[product((M, -1))]], 1),
    ]:
        assert exp(_monomials(rows(*entries))) == pytest.approx(count), entries


DOUBLED = [A, (Step.ADD, (0, 0))]


def test_the_smaller_of_both_counts_is_taken():
    for pivots, terms in [(1, 2), (4, 16), (5, 21), (700, 21)]:
        # A row of power 20 has 21 monomials, and so many pivots of two terms make two to their number.
        found = expanded_terms(rows([product((S, 20))]), elimination(DOUBLED, *([1] * pivots)))
        assert found == pytest.approx(terms), pivots
