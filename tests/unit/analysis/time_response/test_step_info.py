"""Properties of step responses hold what closed forms say."""

from __future__ import annotations

from math import acos, exp, log, pi, sin, sqrt

import numpy as np
import pytest
from flint import arb
from scipy.optimize import brentq, minimize_scalar

from symflex.analysis.time_response import find_step_info
from tests.unit.analysis.systems import rational
from tests.unit.analysis.time_response.test_beams import UNIT, beam, cantilever, damped_step


@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.7])
def test_the_peak_of_a_second_order_system_is_the_textbooks(zeta):
    found = find_step_info(rational(f"2*9/(s^2 + {6 * zeta}*s + 9)"))
    damped = 3 * sqrt(1 - zeta**2)
    assert float(found.final) == pytest.approx(2, rel=1e-15)
    assert float(found.peak_time) == pytest.approx(pi / damped, rel=1e-12)
    assert float(found.overshoot) == pytest.approx(exp(-zeta * pi / sqrt(1 - zeta**2)), rel=1e-12)
    assert float(found.peak) == pytest.approx(2 * (1 + float(found.overshoot)), rel=1e-12)
    assert found.peak.rad() < 1e-9


def test_the_settling_time_is_the_last_crossing_of_two_percent():
    zeta, omega = 0.1, 3.0
    damped, angle = omega * sqrt(1 - zeta**2), acos(zeta)

    def off(t):
        return exp(-zeta * omega * t) * sin(damped * t + angle) / sqrt(1 - zeta**2)

    found = find_step_info(rational("9/(s^2 + 6*s/10 + 9)"))
    grid = [i * 0.001 for i in range(20000)]
    last = max(t for t in grid if abs(off(t)) > 0.02)
    expected = brentq(lambda t: abs(off(t)) - 0.02, last, last + 0.001)
    assert float(found.settling_time) == pytest.approx(expected, rel=1e-10)


def test_a_lag_rises_in_ln_9_and_has_no_peak():
    found = find_step_info(rational("1/(s + 1)"))
    assert found.peak is None
    assert 0 <= float(found.overshoot.upper()) < 2e-6
    assert float(found.rise_time) == pytest.approx(log(9), rel=1e-12)
    assert float(found.settling_time) == pytest.approx(log(50), rel=1e-12)


def test_a_response_that_begins_at_its_peak_says_so():
    found = find_step_info(rational("(2*s + 1)/(s + 1)"))  # 1 + e^-t
    assert (float(found.peak), float(found.peak_time)) == (2.0, 0.0)
    assert float(found.settling_time) == pytest.approx(log(50), rel=1e-12)


def test_undershoot_is_no_overshoot():
    found = find_step_info(rational("(1 - s)/(s + 1)^2"))
    assert found.peak is None


def test_of_a_negative_gain_the_peak_is_the_lowest_value():
    found = find_step_info(rational("-9/(s^2 + 6*s/10 + 9)"))
    assert float(found.peak) == pytest.approx(-1 - exp(-0.1 * pi / sqrt(0.99)), rel=1e-12)


def test_a_response_that_rings_six_hundred_times_is_followed_to_its_end():
    found = find_step_info(rational("1/(s^2 + s/500 + 4)"))
    assert float(found.overshoot) == pytest.approx(exp(-0.0005 * pi / sqrt(1 - 0.0005**2)), rel=1e-12)


@pytest.mark.parametrize("expression", ["1/s", "1/(s^2 + 4)", "1/(s - 1)", "s/(s + 1)^2"])
def test_what_does_not_come_to_rest_or_at_zero_has_no_such_properties(expression):
    assert find_step_info(rational(expression)) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "loss"), [('eta = "0.02 s"', (0.02, 0, 0)), ('c_f = "2 N*s/m^2"', (0, 2, 0))]
)
def test_the_properties_of_a_beam_hold_those_of_its_modal_sum(kind, loss):
    beta, weights = (each[:400] for each in cantilever())

    def response(t):
        # What higher modes lack is below 10^-8 of the final value.
        return 3 * damped_step(beta, weights, *loss, np.atleast_1d(t))

    found = find_step_info(beam(kind=f"{UNIT}, {kind}"))
    grid = np.linspace(0, 40, 8001)
    values = response(grid)
    top = int(np.argmax(values))
    peak = minimize_scalar(lambda t: -response(t)[0], bounds=(grid[top - 1], grid[top + 1]), method="bounded")
    rises = []
    for level in (0.1, 0.9):
        after = int(np.argmax(values > level))
        rises.append(brentq(lambda t, level=level: response(t)[0] - level, grid[after - 1], grid[after]))
    last = int(np.flatnonzero(np.abs(values - 1) > 0.02)[-1])
    settled = brentq(lambda t: abs(response(t)[0] - 1) - 0.02, grid[last], grid[last + 1])

    def holds(ball, value, off, share):
        assert (ball + arb(0, off)).overlaps(arb(value))
        assert float(ball.rad()) < share * value

    holds(found.final, 1 / 3, 1e-12, 1e-9)
    holds(found.peak, -peak.fun / 3, 1e-7, 1e-4)
    holds(found.overshoot, -peak.fun - 1, 1e-7, 1e-4)
    holds(found.rise_time, rises[1] - rises[0], 1e-6, 1e-3)
    holds(found.settling_time, settled, 1e-6, 1e-3)
    if found.peak_time is not None:
        holds(found.peak_time, peak.x, 1e-5, 1e-1)


def test_a_beam_that_loses_nothing_does_not_come_to_rest():
    assert find_step_info(beam()) is None
