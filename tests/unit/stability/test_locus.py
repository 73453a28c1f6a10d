"""Root loci: ends, asymptotes, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from symflex import pipeline
from symflex.errors import UsageError
from symflex.stability import loop_gain, trace_locus


def characteristic(model, gain="K"):
    return pipeline.characteristic_loop(model.resolved, gain)


def test_curves_go_from_open_loop_poles_to_closed_loop_poles(loop):
    locus = trace_locus(characteristic(loop("K/(s*(s + 1)*(s + 2))")), (Fraction(0), Fraction(60)))
    assert locus.arrived
    ends = sorted((branch[-1] for branch in locus.branches), key=lambda s: (s.real, s.imag))
    wanted = sorted(np.roots([1, 3, 2, 60]), key=lambda s: (s.real, s.imag))
    assert np.allclose(ends, wanted, rtol=1e-9)
    assert sorted(branch[0].real for branch in locus.branches) == [-2, -1, 0]


def test_every_point_traced_is_a_pole_for_some_gain(loop):
    locus = trace_locus(characteristic(loop("K*(s + 3)/(s^2 + 1*s + 1)")), (Fraction(0), Fraction(100)))
    for branch in locus.branches:
        for s in branch[::10]:
            gain = -(s * s + s + 1) / (s + 3)
            assert abs(gain.imag) < 1e-8 * (1 + abs(gain))
            assert -1e-9 < gain.real < 100.001


def test_one_curve_ends_next_to_the_zero(loop):
    locus = trace_locus(characteristic(loop("K*(s - 3)/((s + 1)*(s + 2))")), (Fraction(0), Fraction(10**6)))
    assert min(abs(branch[-1] - 3) for branch in locus.branches) < 1e-4


def test_a_delay_loop_is_traced(loop):
    locus = trace_locus(characteristic(loop("K*D/(s + 1)")), (Fraction(1, 10), Fraction(4)), modes=3)
    assert locus.arrived
    assert len(locus.branches) >= 3
    for branch in locus.branches:
        s = branch[-1]
        assert abs(s + 1 + 4 * np.exp(-s / 2)) < 1e-7 * abs(4 * np.exp(-s / 2))


def test_the_loop_gain_is_minus_one_at_a_boundary(loop):
    model = loop("K/(s*(s + 1)*(s + 2))", K=6)
    assert abs(loop_gain(characteristic(model))(1j * 2**0.5) + 1) < 1e-12


def test_errors(loop):
    with pytest.raises(UsageError, match="SF806"):
        trace_locus(characteristic(loop("K^2/(s + 1)")))
    with pytest.raises(UsageError, match="SF804"):
        trace_locus(characteristic(loop("K/(s + 1)", K={})))
    with pytest.raises(UsageError, match="SF806"):
        loop_gain(characteristic(loop("K/(s + 1)", K={})))
