"""Stable gains of loops with roots of s: where poles cross the axis on the principal sheet."""

from __future__ import annotations

from math import exp, pi

import numpy as np
import pytest

from symflex import loads
from symflex.errors import ModelError

LOOP = """symflex = 1
parameters = {{ {parameters} }}
definitions.G = "{plant}"
signals.y = "G*(r - y)"
inputs.r = {{}}
outputs.Y = "y"
"""


def stable(plant, parameters, gain, end):
    return loads(LOOP.format(plant=plant, parameters=parameters)).stability(gain, limits=(0, end))


def test_a_half_infinite_bar_has_the_ultimate_gain_exp_pi():
    # 1 + K exp(-sqrt(j w)) = 0: sqrt(w/2) = pi, then 3 pi, and K = exp(sqrt(w/2)).
    found = stable("K*exp(-sqrt(s))", "K = 3", "K", 20_000)
    assert found.certified
    assert [float(b.gain) for b in found.boundaries] == pytest.approx([exp(pi), exp(3 * pi)], rel=1e-12)
    assert [b.entering for b in found.boundaries] == [2, 2]
    assert [tuple(map(float, ends)) for ends in found.stable] == [(0, pytest.approx(exp(pi), rel=1e-12))]
    assert [b.frequencies_hz[0] for b in found.boundaries] == pytest.approx([pi, 9 * pi], rel=1e-12)


def test_a_gain_beside_a_root_of_s_is_answered_as_any_parameter_is():
    bar = loads(LOOP.format(plant="K*exp(-sqrt(s))", parameters="K = 3"))
    found = bar.stability(over="K", limits=(0, 1000))
    assert found.certified
    assert [float(b.gain) for b in found.boundaries] == pytest.approx([exp(pi)], rel=1e-12)


def test_a_fractional_controller_has_the_gains_at_which_a_polynomial_s_roots_enter_a_sector():
    # With r = sqrt(s): (r^2/2 + 1)^3 r + k_p r + k_i has roots within 45 degrees of the real axis.
    cube = np.poly([-2.0] * 3) / 8

    def entering(k_p, k_i):
        whole = np.zeros(8)
        whole[:-1:2] = cube
        whole[-2:] += (k_p, k_i)
        return np.count_nonzero(abs(np.angle(np.roots(whole))) < pi / 4)

    for gain, count in (("k_p", lambda k: entering(k, 1.5)), ("k_i", lambda k: entering(2, k))):
        low, high = 1.5, 12.0
        for _ in range(50):
            low, high = ((low + high) / 2, high) if not count((low + high) / 2) else (low, (low + high) / 2)
        found = stable("(k_p + k_i/s^0.5)/(T*s + 1)^3", 'k_p = 2, k_i = 1.5, T = "0.5 s"', gain, 30)
        assert found.certified
        assert [float(b.gain) for b in found.boundaries] == pytest.approx([low], rel=1e-12)
        assert [b.entering for b in found.boundaries] == [2]


def test_a_delay_beside_a_root_of_s_counts_at_its_own_rate():
    # K exp(-s T - sqrt(s)) = -1 at s = j w: w T + sqrt(w/2) = pi, K = exp(sqrt(w/2)).
    root = (-1 + np.sqrt(1 + 4 * pi * 2 * 0.5)) / (2 * 2 * 0.5)  # u = sqrt(w/2): 2 T u^2 + u = pi
    found = stable("K*exp(-s*T - sqrt(s))", 'K = 2, T = "0.5 s"', "K", 5)
    assert float(found.boundaries[0].gain) == pytest.approx(exp(root), rel=1e-12)
    assert [b.entering for b in found.boundaries] == [2] * len(found.boundaries)


def test_a_branch_point_elsewhere_leaves_the_verdict_at_the_gain_itself():
    found = stable("K*exp(-sqrt(1 + s))", "K = 3", "K", 100)
    assert (found.certified, found.verdict.word, found.boundaries) == (False, "stable", ())


def test_what_is_inside_a_root_of_s_is_no_gain():
    with pytest.raises(ModelError, match="cannot be a gain"):
        stable("1/(s*(1 + (s*K)^0.8))", "K = 3", "K", 10)


def test_a_loop_around_a_diffusive_line_that_no_gain_destabilises_has_no_boundary():
    # tanh(sqrt(s))/sqrt(s) is passive: its phase stays above -90 degrees.
    found = stable("K*tanh(5*sqrt(s))/sqrt(s)", "K = 1", "K", 60)
    assert (found.boundaries, found.verdict.word) == ((), "stable")
