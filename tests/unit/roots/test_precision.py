"""The working precision never leaks."""

from __future__ import annotations

import flint
import pytest

from symflex.roots import Modes, find_pole_zero_map, find_polynomial_roots, precision
from symflex.roots.precision import bits_for_digits
from tests.unit.roots.root_problems import problem, problem_of


def test_precision_holds_inside_the_block():
    with precision(777):
        assert flint.ctx.prec == 777


def test_precision_is_restored_after_an_exception():
    before = flint.ctx.prec
    with pytest.raises(RuntimeError), precision(777):
        raise RuntimeError
    assert flint.ctx.prec == before


def test_blocks_nest():
    with precision(100):
        with precision(200):
            pass
        assert flint.ctx.prec == 100


def test_bits_cover_the_digits():
    assert 2 ** bits_for_digits(40) > 10**40


def test_finding_roots_leaves_the_precision_as_it_was():
    before = flint.ctx.prec
    find_polynomial_roots(problem(5, 1, 3, 2, 7), 200)
    assert flint.ctx.prec == before


def test_methods_of_a_root_leave_the_precision_as_it_was():
    (root, *_) = find_polynomial_roots(problem(5, 1, 3), 50)
    before = flint.ctx.prec
    root.natural_frequency(), root.frequency_hz(), root.damping_ratio(), root.decimal(40)
    assert flint.ctx.prec == before


def test_a_map_leaves_the_precision_as_it_was():
    before = flint.ctx.prec
    find_pole_zero_map("a/b", problem(4, 0, 1), problem(1), Modes(1)).to_json_dict()
    assert flint.ctx.prec == before


def test_the_callers_precision_does_not_change_the_result():
    polynomial = flint.fmpz_poly([9, 2, 5, 3, 8, 1])
    wanted = [root.decimal(60) for root in find_polynomial_roots(problem_of(polynomial), 60)]
    for bits in (4, 53, 1000):
        with precision(bits):
            roots = find_polynomial_roots(problem_of(polynomial), 60)
            assert [root.decimal(60) for root in roots] == wanted
