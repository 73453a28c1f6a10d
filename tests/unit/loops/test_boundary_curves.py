"""Curves on which poles lie on the axis, of s^2 + (a^2 + b^2 - 1) s + 1: a circle, at 1 rad/s."""

from __future__ import annotations

from fractions import Fraction
from itertools import count, pairwise
from math import hypot

import pytest

from symflex import pipeline
from symflex.balls import precision
from symflex.budget import Budget
from symflex.loops.boundary_curves import BITS, LONGEST, Tracer
from symflex.loops.over import characteristic, stability_over
from symflex.options import StabilityOptions

TEXT = """symflex = 1
parameters.a = { value = 0.1, assume = "real" }
parameters.b = { value = 0.1, assume = "real" }
signals.y = "r/(s^2 + (a^2 + b^2 - 1)*s + 1)"
inputs.r = {}
outputs.Y = "y"
"""


def tracer(low, high):
    """Return what follows the circle in a square of a and b."""
    ranges = ((Fraction(low), Fraction(high)),) * 2
    function = characteristic(pipeline.loads(TEXT), ("a", "b"), ranges)
    return Tracer(function, ranges, function.tf, function.factors, 0)


def test_a_circle_is_followed_all_round_to_where_it_began():
    with precision(BITS):
        curve = tracer(-2, 2).traced((0.75, 0.5, 1.0))
    assert curve[0] == curve[-1] == (0.75, 0.5, 1.0)
    assert all(abs(hypot(4 * x - 2, 4 * y - 2) - 1) < 1e-12 and abs(w - 1) < 1e-12 for x, y, w in curve)
    # Steps are as long as tangents serve, all around.
    steps = [hypot(c - a, d - b) for (a, b, _), (c, d, _) in pairwise(curve)]
    assert max(steps) < 2 * LONGEST and len(curve) < 2 * 3.1416 / 4 / LONGEST * 1.1
    for k in (0, 1):
        assert min(p[k] for p in curve) == pytest.approx(0.25, abs=1e-4)
        assert max(p[k] for p in curve) == pytest.approx(0.75, abs=1e-4)


def test_a_curve_ends_at_the_ends_of_the_ranges():
    with precision(BITS):
        curve = tracer(0, 2).traced((0.3, 0.4, 1.0))
    ends = sorted((round(x, 12), round(y, 12)) for x, y, _ in (curve[0], curve[-1]))
    assert ends == [(0, 0.5), (0.5, 0)]
    assert all(0 <= p[k] <= 1 for p in curve for k in (0, 1))


def test_a_point_is_moved_to_the_curve_along_the_parameter_that_is_free_or_there_is_none():
    with precision(BITS):
        near, here = tracer(-2, 2), (0.6 / 4 + 0.5 + 1e-3, 0.8 / 4 + 0.5, 1.001)
        for free, at in ((0, (0.65, 0.7)), (1, (here[0], (1 - (4 * here[0] - 2) ** 2) ** 0.5 / 4 + 0.5))):
            found = near.corrected(here, free)
            assert found == (
                pytest.approx(at[0], abs=1e-13),
                pytest.approx(at[1], abs=1e-13),
                pytest.approx(1),
            )
        assert near.corrected((0.5, 0.5, 1.0), 0) is None  # a = 0: where a^2 has its least value
        assert near.corrected((0.9, 0.9, 1.0), 0) is None


def test_a_chart_says_that_curves_are_missing_when_time_is_over():
    given = StabilityOptions(over=("a", "b"), ranges=(("a", "-2", "2"), ("b", "-2", "2")), resolve="20 %")
    chart, whole = (stability_over(pipeline.loads(TEXT), given) for _ in range(2))
    assert chart.certified
    with Budget(0, clock=count().__next__).entered():
        document = chart.to_json_dict()
    assert (document["boundaries"], document["reasons"]) == ([], ["the time budget is used up"])
    complete = whole.to_json_dict()
    assert len(complete["boundaries"]) == 1 and complete["reasons"] == []
