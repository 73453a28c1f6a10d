"""Random networks of two to twelve members, against boundary-value problems in numbers."""

import pytest

from symflex import pipeline
from symflex.model import with_numbers
from symflex.transfer import bind, bind_nested
from symflex.transfer.of_model import derive_nested
from tests.independent.members import random_members, response, specification

QUICK = 4
"""Beams, rods and strings, shafts, and a network with a loop; the others are slow."""
SEEDS = [n if n < QUICK else pytest.param(n, marks=pytest.mark.slow) for n in range(10)]
POINTS = (3 + 40j, 900j)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_nested_form_has_the_response_of_the_boundary_value_problem(seed):
    network = random_members(seed, 5 if seed < QUICK else 12)
    model = pipeline.loads(specification(network))
    (tf,) = pipeline.derive_nested(model)
    (numeric,) = derive_nested(with_numbers(model, in_kernels=True), model.transfer_functions)
    for s in POINTS:
        expected = response(network, s)
        assert abs(bind_nested(tf)(s) - expected) <= 1e-14 * abs(expected)
        assert abs(bind_nested(numeric)(s) - expected) <= 1e-14 * abs(expected)


@pytest.mark.parametrize("seed", [0, 1, 2, *(pytest.param(n, marks=pytest.mark.slow) for n in (3, 6, 9))])
def test_nested_and_expanded_forms_meet(seed):
    model = pipeline.loads(specification(random_members(seed, 2)))
    (expanded,), (nested,) = pipeline.derive_all(model), pipeline.derive_nested(model)
    for s in POINTS:
        assert bind_nested(nested)(s) == pytest.approx(bind(expanded)(s), rel=1e-14)
