"""Bounds of loops hold for loops of one pole, which are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from flint import acb

from symflex.analysis.time_response.loop_bound import PoleSum, loop_bound


def lag(gain, rate, delay=0.0):
    return PoleSum.of([acb(-rate)], [(0, (acb(gain),))], delay)


def test_both_integrals_of_a_first_order_loop_are_bounded():
    for gain, rate, last in [(3.0, 1.0, 2.0), (0.2, 5.0, 10.0), (-3.0, 1.0, 2.0), (-6.0, 1.0, 1.0)]:
        # Q = g/(s + b + g), and of a step y' is the same as q here.
        total = rate + gain
        true = abs(gain) * (1 - np.exp(-total * last)) / total
        found = loop_bound([lag(gain, rate)], [lag(gain, rate)], 1, last)
        assert true <= found.turned <= 30 * true, (gain, rate, last)
        assert true <= found.travelled <= 30 * true, (gain, rate, last)


def test_a_late_loop_of_an_integrator_is_bounded():
    # y' + y(t - 1) = 1 from rest, up to t = 3: y = t, t - (t - 1)^2/2, ... rises until y(t - 1) = 1.
    found = loop_bound([lag(1.0, 0.0)], [lag(1.0, 0.0, 1.0)], 1, 3.0)
    # y' = 1, then 2 - t, then that plus (t - 2)^2/2: its absolute value has the integral 1 + 1/2 + 1/3.
    travelled = 1 + 1 / 2 + 1 / 3
    assert travelled <= found.travelled <= 4 * travelled
    # q = y'(t - 1) here.
    assert 1.5 <= found.turned <= 6.0


def test_what_is_not_known_of_an_open_path_counts_once_and_loops_enlarge_it():
    alone = loop_bound([lag(1.0, 1.0)], [], 1, 2.0)
    assert alone.turned == 0.0
    assert alone.enlarged(1e-9, 0.0, 0.0, 2.0) == pytest.approx(1e-9, rel=1e-6)
    closed = loop_bound([lag(1.0, 1.0)], [lag(1.0, 1.0)], 1, 2.0)
    # Of 1/(s + 2) the step response moves by (1 - e^-4)/2, and an error of the loop's gain as well.
    assert closed.enlarged(0.0, 1e-9, 0.0, 2.0) >= 1e-9 * 0.49
    assert closed.enlarged(0.0, 1e-9, 1.0, 2.0) is None
