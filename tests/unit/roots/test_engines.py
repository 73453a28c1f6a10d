"""Every registered root finder finds known roots."""

from __future__ import annotations

import pytest
from flint import fmpz_poly

from symflex.roots import ROOT_FINDERS, Everything, PolynomialRootFinder
from tests.unit.roots.polynomials import chain, from_roots, problem, problem_of, with_root_of_two

PROBLEMS = {
    "linear": problem(3, 2),
    "axis": problem(16, 0, 8, 0, 1),
    "real": problem(*from_roots([1, 2, 3, -4, -50])),
    "damped": problem_of(chain(8, 3, 500, 2)),
    "cyclotomic": problem_of(fmpz_poly.cyclotomic(29)),
    "rigid": problem(0, 0, 0, 5, 1, 1),
    "constant": problem(5),
}


@pytest.fixture(
    params=sorted(name for name, f in ROOT_FINDERS.items() if isinstance(f, PolynomialRootFinder))
)
def finder(request):
    return ROOT_FINDERS[request.param]


def test_registry_keys_are_names():
    assert all(finder.name == name for name, finder in ROOT_FINDERS.items())


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_the_number_of_roots_is_the_degree(finder, name):
    roots = finder.find(PROBLEMS[name], Everything(), 20)
    assert sum(root.multiplicity for root in roots) == PROBLEMS[name].degree


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_the_polynomial_vanishes_on_every_enclosure(finder, name):
    (polynomial, _), *_ = PROBLEMS[name].factors
    value = fmpz_poly(list(polynomial.integers()))
    for root in finder.find(PROBLEMS[name], Everything(), 20):
        assert value(root.enclosure()).contains(0)


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_engines_agree_on_the_digits(finder, name):
    expected = ROOT_FINDERS["polynomial"].find(PROBLEMS[name], Everything(), 20)
    roots = finder.find(PROBLEMS[name], Everything(), 20)
    assert len(roots) == len(expected)
    assert all(a.enclosure().overlaps(b.enclosure()) for a, b in zip(roots, expected, strict=True))


@pytest.mark.parametrize("name", sorted(PROBLEMS))
def test_polynomials_are_accepted(finder, name):
    assert finder.accepts(PROBLEMS[name])


def test_constants_with_a_hidden_relation_need_an_engine_that_bears_double_roots():
    polynomial = with_root_of_two(lambda root, one: (2 * one, -2 * root, one))
    roots = ROOT_FINDERS["laguerre"].find(type(PROBLEMS["real"])(((polynomial, 1),)), Everything(), 10)
    assert [root.multiplicity for root in roots] == [2]
