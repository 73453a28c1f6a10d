"""Responses to an input that went through a shaper are sums of late ones."""

from fractions import Fraction
from math import cos, pi, sqrt

import numpy as np
import pytest
from mpmath import cos as cos_
from mpmath import cosh, findroot

from symflex import loads
from symflex.analysis.input_shaping import input_shaper
from symflex.analysis.time_response import SampleTimes, forced_response, time_response
from symflex.errors import UsageError
from symflex.figures import draw_in_time
from tests.unit.analysis.systems import rational

OSCILLATOR = "9/(s^2 + 3*s/5 + 9)"  # zeta = 0.1
OMEGA, SIGMA = 3 * sqrt(0.99), 0.3


def step(t):
    """Return the closed form of the oscillator's step response, 0 before t = 0."""
    t = np.maximum(t, 0)
    return 1 - np.exp(-SIGMA * t) * (np.cos(OMEGA * t) + SIGMA / OMEGA * np.sin(OMEGA * t))


def test_a_shaped_step_is_the_sum_of_late_steps():
    for kind in ["zv", "zvd", "ei"]:
        bound = rational(OSCILLATOR)
        shaper = input_shaper(bound, kind=kind)
        for times in (SampleTimes.evenly(Fraction(4), 41), SampleTimes.of([0.2, 1.0, 1.5, 3.9])):
            found = time_response(bound, "step", times, shaper=shaper)
            late = [a * step(found.times - t) for t, a in zip(shaper.times, shaper.amplitudes, strict=True)]
            assert np.max(np.abs(found.values - sum(late))) < 1e-14, kind
            assert found.certified, kind
            assert np.max(found.radius) < 1e-12, kind


def test_a_shaper_for_another_oscillator_leaves_what_the_definition_says():
    bound, other = rational("1/(s^2 + 9)"), rational("1/(s^2 + 25/4)")
    shaper = input_shaper(other)  # half a period of 2.5 rad/s, where 3 rad/s turns by 1.2 pi
    found = time_response(bound, "impulse", SampleTimes.of([2.0, 3.0, 4.0]), shaper=shaper)
    t = found.times
    assert found.values == pytest.approx((np.sin(3 * t) + np.sin(3 * (t - pi / 2.5))) / 6, abs=1e-14)
    assert np.max(np.abs(found.values)) <= cos(0.6 * pi) * -1 / 3 + 1e-12


def test_the_value_at_the_moment_of_an_impulse_holds_both_sides():
    # cos(pi t) after an impulse; half a period is a second.
    text = 'symflex = 1\nparameters.r = "1 1/s"\ninputs.u = {}\noutputs.y = "s*u/(s^2 + pi^2*r^2)"'
    bound = loads(text).transfer_function("y", "u").bind().bound
    found = time_response(bound, "impulse", SampleTimes.evenly(Fraction(1), 2), shaper=input_shaper(bound))
    assert all(found.enclosures[1].contains(side) for side in (-0.5 + 1e-9, -1e-9))
    assert found.radius[1] < 0.26
    (jump,) = found.jumps
    assert (float(jump.time), float(jump.height)) == pytest.approx((1.0, 0.5))


def test_a_shaped_input_of_samples_is_a_sum_of_late_ramps():
    bound = rational(OSCILLATOR)
    shaper = input_shaper(bound)
    moments = [Fraction(0), Fraction(1, 2), Fraction(2)]
    given = [Fraction(0), Fraction(1), Fraction(1)]
    wanted = [Fraction(k, 4) for k in range(13)]
    shaped = forced_response(bound, moments, given, wanted, shaper=shaper)
    fine = SampleTimes.of(
        sorted({float(t) - u for t in wanted for u in shaper.times if float(t) > u + 1e-12})
    )
    known = {}
    for t in fine.seconds.tolist():
        ramp = time_response(bound, "ramp", SampleTimes.of([t, t + 1.0])).values
        late = t - 0.5
        second = time_response(bound, "ramp", SampleTimes.of([late, late + 1.0])).values[0] if late > 0 else 0
        known[t] = 2 * ramp[0] - 2 * second
    for t, value in zip(wanted, shaped.values, strict=True):
        expected = sum(
            a * known[float(t) - u]
            for u, a in zip(shaper.times, shaper.amplitudes, strict=True)
            if float(t) > u + 1e-12
        )
        assert value == pytest.approx(expected, abs=1e-12)


@pytest.mark.slow
def test_a_shaped_cantilever_has_its_first_mode_at_rest():
    text = 'symflex = 1\nelements.arm = { type = "beam", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", '
    text += 'I = "1 m^4", rho = "1 kg/m^3", l = "1 m" }\ninputs.F = { force = "x" }\noutputs.X = "x"'
    arm = loads(text).transfer_function("X", "F").bind()
    shaper = arm.input_shaper()
    found = arm.step_response(np.linspace(1.0, 2.0, 9), 9, shaper)
    assert shaper.times[-1] < 1.0
    # The tip's modes are 4/w^2 (1 - cos w t) with cos b cosh b = -1 for w = b^2; what 40 leave out is 2e-7.
    roots = [findroot(lambda b: cos_(b) + 1 / cosh(b), (n - 0.5) * pi) for n in range(2, 41)]
    first = 4 / 1.8751040687119611664**4  # OEIS A076417: its swing is gone, and it stands where it would rest
    expected = np.full(9, first)
    for root in map(float, roots):
        for t, a in zip(shaper.times, shaper.amplitudes, strict=True):
            expected += 4 * a / root**4 * (1 - np.cos(root**2 * (found.times - t)))
    assert np.max(np.abs(found.values - expected)) < 1e-6


def test_a_shaper_with_too_few_digits_is_refused():
    bound = rational(OSCILLATOR)
    with pytest.raises(UsageError, match="more digits"):
        time_response(bound, "step", SampleTimes.of([1.0]), 60, input_shaper(bound))


def test_without_times_a_response_lasts_until_the_motion_has_died_away():
    text = 'symflex = 1\ninputs.u = {}\noutputs.y = "9*u/(s^2 + 6*s/10 + 9)"'  # exp(-0.3 t): 0.67 % is left
    found = loads(text).transfer_function("y", "u").bind().step_response()
    assert found.times[-1] == pytest.approx(5 / 0.3)
    assert found._repr_svg_().startswith("<?xml")


def test_a_figure_of_a_shaped_response_names_the_shaper_once_in_its_title():
    bound = rational(OSCILLATOR)
    found = time_response(bound, "step", SampleTimes.evenly(Fraction(4), 41), shaper=input_shaper(bound))
    (axes,) = draw_in_time(found).axes
    assert axes.get_ylabel() == "Step response"
    assert found.title == "step response, shaped by ZV"
