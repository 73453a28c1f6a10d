"""Networks solved in double precision and in balls, against boundary-value problems."""

from __future__ import annotations

import numpy as np
import pytest
from flint import acb

from symflex import pipeline
from symflex.transfer import bind_nested
from tests.independent.distributed import CASES

QUICK = (
    "motor, screw, carriage, flexible arm, gripper: tip",
    "Timoshenko root, rigid body, slender tip",
    "clamped-sliding under a distributed load, moment at the clamp",
    "cantilever with delayed velocity feedback",
    "decaying substance in a moving medium",
)
NAMED = [
    pytest.param(case, id=case.name, marks=() if case.name in QUICK else pytest.mark.slow) for case in CASES
]


def bound(case):
    """Return the case's transfer function in nested form, with its values."""
    model = pipeline.loads(case.text)
    (tf,) = pipeline.derive_nested(model, pipeline.pick_pairs(model, [case.tf]))
    return bind_nested(tf)


@pytest.mark.parametrize("case", NAMED)
def test_the_double_precision_network_has_the_response_of_the_boundary_value_problem(case):
    points = case.points(7)
    expected = np.array([complex(case.reference(s, 60)) for s in points])
    assert bound(case).at(points) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("case", NAMED)
def test_value_and_slope_of_the_network_in_balls_meet_those_of_the_elimination(case):
    s = case.points(7)[3]
    point = acb(s.real, s.imag)
    solved = bound(case).solved(256).value_and_slope(point)
    eliminated = bound(case).enclosed(512).value_and_slope(point)
    assert all(x.overlaps(y) and x.rel_accuracy_bits() > 60 for x, y in zip(solved, eliminated, strict=True))


def test_all_quick_cases_are_there():
    assert set(QUICK) <= {case.name for case in CASES}
