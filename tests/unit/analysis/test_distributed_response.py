"""Frequency responses of distributed systems."""

import numpy as np
import pytest
from mpmath import cos, cosh, mp, mpc, sin, sinh, sqrt

from symflex.analysis.response import default_band, respond
from symflex.figures import draw
from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import DELAY_LOOP, FREE, KELVIN_VOIGT, ROD, SLIDING_FREE, bound

# omega of the sliding-free beam: poles x^2 with tan x + tanh x = 0 at 5.59, 30.2, 74.6; colocated zeros
# (clamped-free) at 3.52, 22.0, 61.7.
OMEGA = [1.0, 4.0, 10.0, 25.0, 40.0, 70.0, 80.0]


def sliding_free(s):
    """Return V_act/F and V_tip/F of the sliding-free beam with E I = rho A = l = 1."""
    with mp.workdps(40):
        q = sqrt(mpc(s) / 2)
        below = 2 * q * (sinh(2 * q) + sin(2 * q))
        return complex((2 + cosh(2 * q) + cos(2 * q)) / below), complex(4 * cosh(q) * cos(q) / below)


def test_values_are_those_of_the_closed_form():
    for number in [0, 1]:
        values = respond(bound(SLIDING_FREE, number), OMEGA).values
        expected = [sliding_free(1j * omega)[number] for omega in OMEGA]
        assert np.abs(values - expected).max() <= 1e-14 * np.abs(expected).max(), number


def test_the_colocated_phase_alternates_between_lag_and_lead():
    phase = np.degrees(respond(bound(SLIDING_FREE), OMEGA).phase)
    assert phase == pytest.approx([-90, 90, -90, 90, -90, 90, -90])


def test_the_phase_at_the_tip_loses_half_a_turn_at_every_pole():
    phase = np.degrees(respond(bound(SLIDING_FREE, 1), OMEGA).phase)
    assert phase == pytest.approx([-90, -90, -270, -270, -450, -450, -630])


@pytest.mark.slow
def test_the_phase_does_not_depend_on_the_grid():
    # 10 poles below 1000 rad/s, (n - 1/4)^2 pi^2; the tip's zeros are real.
    (phase,) = np.degrees(respond(bound(SLIDING_FREE, 1), [1000.0]).phase)
    poles = sum(1 for n in range(1, 40) if ((n - 0.25) * np.pi) ** 2 < 1000)
    assert phase == pytest.approx(-90 - 180 * poles)


@pytest.mark.slow
def test_the_phase_of_a_lossy_beam_is_continuous_through_its_resonances():
    # It turns by 1/zeta times the logarithmic step at a resonance, at most; zeta = 0.02 at the lowest.
    phase = respond(bound(KELVIN_VOIGT), np.geomspace(1, 300, 800)).phase
    assert np.abs(np.diff(phase)).max() < 0.5


def test_a_delay_outside_a_loop_lags_without_bound():
    # exp(-s/2) times a loop whose phase tends to -90 degrees.
    phase = respond(bound(DELAY_LOOP, 1), [100.0]).phase - respond(bound(DELAY_LOOP), [100.0]).phase
    assert phase == pytest.approx([-50])


def test_at_zero_frequency_the_limit_is_taken():
    # A rod held at one end: E A/l = 1 N/m.
    assert respond(bound(ROD), [0.0]).values[0] == pytest.approx(1)


def test_at_zero_frequency_a_free_beam_has_no_value():
    assert np.isinf(respond(bound(FREE), [0.0]).values[0].real)


def test_the_band_shown_ends_a_little_above_the_last_pole():
    found = locate(bound(ROD), Modes(3))
    _, high = default_band(found)
    last = max(root.frequency_hz() for root in found.poles)
    following = max(root.frequency_hz() for root in locate(bound(ROD), Modes(4)).poles)
    assert last < high < following * 1.1


def test_a_panel_reaches_up_to_the_highest_of_the_default_poles():
    bounds = [bound(SLIDING_FREE)]
    (axes,) = draw("poles_zeros", bounds).axes
    assert axes.get_ylim()[1] > max(float(root.im.mid()) for root in locate(bounds[0], Modes(5)).poles)
