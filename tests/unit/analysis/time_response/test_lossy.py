"""Servos about beams that lose energy in their material: responses are the inverses of closed forms."""

import mpmath
import numpy as np
import pytest
from flint import arb
from scipy.optimize import brentq

from symflex.analysis.time_response import SampleTimes, find_step_info, time_response
from symflex.analysis.time_response.lossy_modes import lossy_bound
from symflex.analysis.time_response.modal import BoundedModes
from symflex.analysis.time_response.sampled import Refused
from symflex.roots.distributed.far_out import SECTORS, TILTED, FunctionFarOut
from tests.unit.analysis.time_response.test_passive import (
    TIMES,
    UNIT,
    WHOLE,
    assert_holds,
    clamped_between,
    inverted,
    of,
    tip_of_clamped,
    wave,
)

ETA = "0.02"
GAINS = 'parameters = { k = "4 N/m", d = "1.5 N*s/m", i = "3 N/(m*s)", T = "20 ms" }'
PD = "(k + d*s/(1 + T*s))"
IDEAL = "(k + d*s)"
PID = "(k + i/s + d*s/(1 + T*s))"


def pd(s):
    return 4 + mpmath.mpf("1.5") * s / (1 + s / 50)


def ideal(s):
    return 4 + mpmath.mpf("1.5") * s


def pid(s):
    return pd(s) + 3 / s


def servo(controller, output="x", measured="x", eta=ETA):
    """Return a cantilever whose tip follows r by a force."""
    return of(
        f"""
{GAINS}
elements.arm  = {{ type = "beam", between = ["ground", "x"], {UNIT}, {WHOLE}, eta = "{eta} s" }}
elements.push = {{ type = "force_source", at = "x", f = "{controller}*(r - {measured})" }}
inputs.r  = {{ unit = "m" }}
outputs.X = "{output}"
""",
        source="r",
    )


def receptance(s, eta=ETA):
    return tip_of_clamped(s, lambda _: 0, eta)


def closed(control):
    def follow(s):
        gain = control(s) * receptance(s)
        return gain / (1 + gain)

    return follow


def pushed(control):
    return lambda s: control(s) / (1 + control(s) * receptance(s))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("controller", "control"),
    [(PD, pd), pytest.param("-8*k", lambda s: -32, marks=pytest.mark.slow)],
    ids=["PD", "unstable"],
)
def test_a_servo_at_the_tip_follows_as_its_inverse_transform(controller, control):
    found = time_response(servo(controller), "step", SampleTimes.of([0.0, *TIMES]))
    assert found.enclosures[0] == 0
    assert_holds(found, [0.0, *inverted(closed(control), 1, TIMES)], off=1e-14 * np.abs(found.values).max())


@pytest.mark.slow
def test_what_is_told_of_a_servos_step_has_many_digits():
    def at(t):
        return inverted(closed(pd), 1, [t], degree=60)[0] * 7 / 4

    def crossed(level, low, high):
        return brentq(lambda t: at(t) - level, low, high, xtol=1e-8)

    found = find_step_info(servo(PD))
    peak = float(found.peak_time)
    assert (7 * found.final).contains(4)
    assert (found.overshoot + 1 - float(at(peak))).overlaps(arb(0, 1e-10))
    for off in (-1e-3, 1e-3):
        assert at(peak + off) < at(peak)
    rise = crossed(0.9, 0.01, peak) - crossed(0.1, 0.01, peak)
    assert found.rise_time.overlaps(arb(rise, 2e-8)) and found.rise_time.rad() < 1e-5 * rise
    settled = float(found.settling_time)
    assert found.settling_time.rad() < 1e-9 * settled
    assert abs(abs(at(settled) - 1) - 0.02) < 1e-9
    assert all(abs(at(settled + t) - 1) < 0.02 for t in np.linspace(0.01, 3, 10))


@pytest.mark.slow
def test_an_impulse_is_held_after_the_first_instant():
    found = time_response(servo(IDEAL), "impulse", SampleTimes.of(TIMES))
    assert_holds(found, inverted(closed(ideal), 0, TIMES), off=1e-14)


@pytest.mark.slow
def test_what_a_servo_pushes_with_begins_at_its_limit():
    found = time_response(servo(PID, "push.f"), "step", SampleTimes.of([0.0, *TIMES]))
    # 4 + 1.5/0.02 at once, before anything moves.
    assert found.enclosures[0].contains(79)
    assert_holds(found, [79.0, *inverted(pushed(pid), 1, TIMES)], off=1e-12)


@pytest.mark.slow
def test_a_sensor_away_from_the_motor_is_held_too():
    found = time_response(servo("k", measured="arm.y(0.4 m)"), "step", SampleTimes.of(TIMES))
    place = mpmath.mpf("0.4")

    def follow(s):
        return 4 * receptance(s) / (1 + 4 * clamped_between(s, place, lambda _: 0, ETA))

    assert_holds(found, inverted(follow, 1, TIMES), off=1e-15)


@pytest.mark.slow
def test_a_support_that_is_moved_moves_the_tip():
    bound = of(
        f"""
elements.arm = {{ type = "beam", between = ["base", "tip"], {UNIT}, {WHOLE}, eta = "{ETA} s" }}
elements.hold = {{ type = "slider", at = "base" }}
inputs.z  = {{ displacement = "base" }}
outputs.X = "tip"
""",
        source="z",
    )
    found = time_response(bound, "step", SampleTimes.of(TIMES))

    def follow(s):
        q, _ = wave(s, ETA)
        c, h = mpmath.cos(q), mpmath.cosh(q)
        # w = a cos + b cosh + ..., moved at x = 0 without slope, free at the other end.
        return (c + h) / (1 + c * h)

    assert_holds(found, inverted(follow, 1, TIMES), off=1e-14)


@pytest.mark.parametrize(("controller", "control", "sectors"), [(PD, pd, TILTED), (IDEAL, ideal, SECTORS)])
@pytest.mark.slow
def test_the_size_far_out_holds_wherever_it_is_said_to(controller, control, sectors):
    bound = servo(controller)
    far_out = FunctionFarOut.of(bound, sectors)
    radius = 10 * far_out.least(1.0)
    size = far_out.size(radius)
    share = 0.0
    with mpmath.workdps(40):
        for turned in np.linspace(0, sectors / SECTORS * np.pi / 2, 5):
            for times in (1, 3, 1e6):
                s = radius * times * mpmath.expj(turned)
                value = abs(closed(control)(s)) / abs(s) ** mpmath.mpf(float(size.power))
                assert value <= float(size.most)
                share = max(share, float(value) / float(size.most))
    assert share > 0.02
    # 4 + 75 (or 1.5 s) times s^(-7/4)/eta^(1/4): E I (1 + eta s) q^3 for large s.
    assert size.power == (-0.75 if control is ideal else -1.75)
    limit = (1.5 if control is ideal else 79) * 2**0.5 * 0.02**-0.25
    assert float(far_out.size(1e60).lead.real) == pytest.approx(limit, rel=1e-12)


@pytest.mark.slow
def test_more_modes_move_a_response_by_no_more_than_what_was_left():
    times = SampleTimes.of([0.0, 1e-4, 1e-2, 1.0])
    modes = BoundedModes(*lossy_bound(servo(PD), 1), times)
    few, many = modes.summed(10), modes.summed(32)
    for a, b, left in zip(few.values, many.values, few.at_times, strict=True):
        assert abs(a - b) <= left
    assert max(many.at_times, key=float) < max(few.at_times, key=float)


def test_a_beam_without_loss_has_no_such_bound():
    assert lossy_bound(servo(PD, eta="0"), 1) == Refused("some waves have no material damping")


def test_a_bound_beyond_very_many_modes_is_none():
    # The boom stretches: waves of 5200 m/s are damped as those of bending are only beyond 10^9 rad/s.
    steel = (
        'E = "210 GPa", I = "8.3e-10 m^4", A = "1e-4 m^2", rho = "7800 kg/m^3", l = "0.5 m", eta = "1e-5 s"'
    )
    boom = of(
        f"""
elements.post = {{ type = "frame", between = ["ground", "corner"], angle = "90 deg", {steel} }}
elements.boom = {{ type = "frame", between = ["corner", "tip"], {steel} }}
inputs.F = {{ force = "tip.y" }}
outputs.X = "tip.y"
"""
    )
    assert lossy_bound(boom, 1) == Refused("a bound on poles is known only beyond very many modes")
