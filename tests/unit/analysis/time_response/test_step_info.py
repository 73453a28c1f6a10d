"""Properties of step responses hold what closed forms say."""

from math import acos, exp, factorial, log, pi, sin, sqrt

import numpy as np
import pytest
from flint import arb
from scipy.optimize import brentq, minimize_scalar
from scipy.special import gammainc

import symflex
from symflex.analysis.time_response import SampleTimes, find_step_info, time_response
from symflex.analysis.time_response.modal import proved_modes
from tests.unit.analysis.systems import rational
from tests.unit.analysis.time_response.test_beams import UNIT, beam, cantilever, damped_step


def test_the_peak_of_a_second_order_system_is_the_textbooks():
    for zeta in [0.05, 0.3, 0.7]:
        found = find_step_info(rational(f"2*9/(s^2 + {6 * zeta}*s + 9)"))
        damped = 3 * sqrt(1 - zeta**2)
        assert float(found.final) == pytest.approx(2, rel=1e-15), zeta
        assert float(found.peak_time) == pytest.approx(pi / damped, rel=1e-12), zeta
        assert float(found.overshoot) == pytest.approx(exp(-zeta * pi / sqrt(1 - zeta**2)), rel=1e-12), zeta
        assert float(found.peak) == pytest.approx(2 * (1 + float(found.overshoot)), rel=1e-12), zeta
        assert found.peak.rad() < 1e-9, zeta


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
    assert "overshoot                none above 0.0001 %" in found.lines("m")
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


def test_what_does_not_come_to_rest_or_at_zero_has_no_such_properties():
    for expression in ["1/s", "1/(s^2 + 4)", "1/(s - 1)", "s/(s + 1)^2"]:
        assert find_step_info(rational(expression)) is None, expression


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
    holds(found.peak, -peak.fun / 3, 1e-7, 1e-5)
    holds(found.overshoot, -peak.fun - 1, 1e-7, 1e-5)
    holds(found.rise_time, rises[1] - rises[0], 1e-6, 1e-4)
    holds(found.settling_time, settled, 1e-6, 1e-4)
    if found.peak_time is not None:
        holds(found.peak_time, peak.x, 1e-5, 1e-2)


def test_a_beam_that_loses_nothing_does_not_come_to_rest():
    assert find_step_info(beam()) is None


# ----------------------------------------------------------------------------------------- loops with a delay


def delayed(law):
    text = f'signals.x = "{law}"\noutputs.y = "x"\nblocks.D = {{ type = "delay", T = "0.1 s" }}\n'
    model = symflex.loads(f"symflex = 1\ninputs.r = {{}}\n{text}")
    return model.transfer_function("y", "r").bind().step_info()


@pytest.mark.parametrize(
    ("law", "gain", "part"),
    [
        ("7/s*D*(r - x)", 7, lambda k, t: t**k / factorial(k)),
        ("2/(1 + 0.5*s)*D*(r - x)", 2, lambda k, t: gammainc(k, 2 * t)),  # Erlang's distributions
    ],
)
def test_a_loop_with_a_delay_rises_overshoots_and_settles_as_the_method_of_steps_says(law, gain, part):
    # With G from r - x to x, x = G D r - (G D)^2 r + ... (Bellman & Cooke 1963).
    found = delayed(law)
    final = 1 if "7" in law else 2 / 3

    def y(t):
        parts = (
            (-1) ** k * gain ** (k + 1) * part(k + 1, max(t - 0.1 * (k + 1), 0)) for k in range(int(10 * t))
        )
        return sum(parts) / final

    times = np.arange(0, 2, 5e-4)
    values = np.array([y(t) for t in times])

    def passing(excess, which):
        changes = np.flatnonzero(np.diff(np.sign([excess(v) for v in values])))[which]
        return brentq(lambda t: excess(y(t)), times[changes], times[changes + 1], xtol=1e-13)

    highest = times[np.argmax(values)]
    peak = minimize_scalar(lambda t: -y(t), bounds=(highest - 1e-3, highest + 1e-3), options={"xatol": 1e-10})
    rise = passing(lambda v: v - 0.9, 0) - passing(lambda v: v - 0.1, 0)
    assert float(found.final) == pytest.approx(final, rel=1e-15)
    assert float(found.rise_time) == pytest.approx(rise, rel=1e-9)
    assert float(found.peak_time) == pytest.approx(peak.x, rel=1e-7)
    assert float(found.overshoot) == pytest.approx(-peak.fun - 1, abs=1e-11)
    assert float(found.settling_time) == pytest.approx(passing(lambda v: abs(v - 1) - 0.02, -1), rel=1e-9)
    assert max(x.rad() for x in (found.peak, found.rise_time, found.settling_time)) < 1e-9


@pytest.mark.slow
def test_a_loop_whose_delay_makes_it_unstable_has_no_such_properties():
    # x' = K (r - x) a delay T later is stable for K T < pi/2 (Hayes 1950).
    assert delayed("15.8/s*D*(r - x)") is None
    assert delayed("15.6/s*D*(r - x)").settling_time > 40


def test_a_lag_that_is_late_rises_as_a_lag():
    found = delayed("D/(1 + s)*r")
    assert float(found.rise_time) == pytest.approx(log(9), rel=1e-9)
    assert float(found.settling_time) == pytest.approx(0.1 + log(50), rel=1e-9)


def test_of_a_loop_that_answers_at_once_nothing_is_said():
    # A gain alone: the response jumps after every turn.
    assert delayed("0.5*D*(r - x)") is None


@pytest.mark.slow
def test_a_string_whose_modes_fall_off_slowly_has_the_peak_of_its_echoes():
    text = """symflex = 1
    inputs.F = { force = "a" }
    outputs.X = "a"
    [elements]
    wire = { type = "string", between = ["ground", "a"], N = "100 N", rhoA = "0.01 kg/m", l = "1 m" }
    load = { type = "mass", at = "a", m = "0.02 kg" }
    loss = { type = "damper", between = ["a", "ground"], b = "0.3 N*s/m" }
    """
    bound = symflex.loads(text).transfer_function("X", "F").bind().bound
    found = find_step_info(bound)
    assert found.missing == 0
    assert float(found.final) == pytest.approx(0.01, rel=1e-12)  # l/N
    # Echoes are exact, and know nothing of modes.
    near = SampleTimes.of([0.0, *np.linspace(0.02, 0.08, 601).tolist()])
    highest = max(time_response(bound, "step", near).values)
    assert abs(float(found.peak.mid()) - highest) < 3e-6
    # Fewer digits than the first modes have ask for no more of them.
    assert proved_modes(bound, 1, SampleTimes.of([0.0, 1.0]), 4, 100).rest < 1e-5


def test_a_mode_that_its_command_takes_out_settles_with_it():
    # w = 20/s: (1 - cos(w t))/2 up to T = pi/w; t/T - sin(w t)/(w T) up to T = 2 pi/w; and of a lag 1/(s + w)
    # and a mean over T = 1/w, for w t <= 1, w t - 1 + exp(-w t), then 1 - (e - 1) exp(-w t).
    text = """
symflex = 1
parameters.w = "20 rad/s"
definitions.T = "{period}"
inputs.r = {{}}
outputs.y = "{command}*r"
"""
    mode = "w^2/(s^2 + w^2)"
    for period, command, level in [
        ("pi/w", f"(1 + exp(-s*T))/2*{mode}", acos(-0.96) / 20),
        (
            "2*pi/w",
            f"(1 - exp(-s*T))/(s*T)*{mode}",
            brentq(lambda x: (x - sin(x)) / (2 * pi) - 0.98, 3, 6) / 20,
        ),
        ("1/w", "(1 - exp(-s*T))/(s*T)*w/(s + w)", log((exp(1) - 1) / 0.02) / 20),
    ]:
        model = symflex.loads(text.format(period=period, command=command))
        found = find_step_info(model.transfer_function("y", "r").bind().bound)
        assert found is not None, command
        assert float(found.final) == pytest.approx(1, rel=1e-15), command
        assert float(found.settling_time) == pytest.approx(level, rel=1e-10), command
