"""Every registered engine that guesses finds known roots."""

from __future__ import annotations

import pytest
from flint import fmpz_poly

from symflex.roots import find_polynomial_roots
from symflex.roots.engines import GUESSES
from symflex.roots.polynomials.discs import propose_by_laguerre
from tests.unit.roots.root_problems import chain, from_roots, problem, problem_of, with_root_of_two

PROBLEMS = {
    "linear": problem(3, 2),
    "axis": problem(16, 0, 8, 0, 1),
    "real": problem(*from_roots([1, 2, 3, -4, -50])),
    "damped": problem_of(chain(8, 3, 500, 2)),
    "cyclotomic": problem_of(fmpz_poly.cyclotomic(29)),
    "rigid": problem(0, 0, 0, 5, 1, 1),
    "constant": problem(5),
}


@pytest.fixture(params=sorted(GUESSES))
def proposers(request):
    return (GUESSES[request.param].propose,)


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_the_number_of_roots_is_the_degree(proposers, name):
    roots = find_polynomial_roots(PROBLEMS[name], 20, proposers)
    assert sum(root.multiplicity for root in roots) == PROBLEMS[name].degree


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_the_polynomial_vanishes_on_every_enclosure(proposers, name):
    (polynomial, _), *_ = PROBLEMS[name].factors
    value = fmpz_poly(list(polynomial.integers()))
    for root in find_polynomial_roots(PROBLEMS[name], 20, proposers):
        assert value(root.enclosure()).contains(0)


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_engines_agree_on_the_digits(proposers, name):
    expected = find_polynomial_roots(PROBLEMS[name], 20)
    roots = find_polynomial_roots(PROBLEMS[name], 20, proposers)
    assert len(roots) == len(expected)
    assert all(a.enclosure().overlaps(b.enclosure()) for a, b in zip(roots, expected, strict=True))


def test_constants_with_a_hidden_relation_need_an_engine_that_bears_double_roots():
    polynomial = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    roots = find_polynomial_roots(type(PROBLEMS["real"])(((polynomial, 1),)), 10, (propose_by_laguerre,))
    assert [root.multiplicity for root in roots] == [2]
