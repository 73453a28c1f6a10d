"""Beams in loops with delays agree with numerical inversions, turn by turn, as far as is estimated."""

import mpmath
import numpy as np
import pytest

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response

BEAM = 'between = ["ground", "x"], E = "1 Pa", A = "1 m^2", I = "1 m^4", rho = "1 kg/m^3", l = "1 m"'


def loop(force, output="x"):
    """Return x/r of a cantilever that a force pushes at its tip, behind a controller that is late."""
    text = f"""
symflex = 1
blocks.D = {{ type = "delay", T = "0.3 s" }}
parameters = {{ T_d = "0.1 s", T_f = "0.05 s", k = "2 N/m" }}
inputs.r = {{ unit = "m" }}
outputs.X = "{output}"
[elements]
arm = {{ type = "beam", {BEAM}, eta = "0.02 s" }}
push = {{ type = "force_source", at = "x", f = "{force}" }}
"""
    return loads(text).transfer_function("X", "r").bind().bound


def receptance(s, eta):
    """Return the tip's displacement over a force there (Bishop and Johnson 1960)."""
    stiff = 1 + eta * s
    q = mpmath.sqrt(mpmath.sqrt(-s * s / stiff))
    sine, cosine, grown, even = mpmath.sin(q), mpmath.cos(q), mpmath.sinh(q), mpmath.cosh(q)
    return (sine * even - cosine * grown) / (1 + cosine * even) / (stiff * q**3)


def stepped(begun, gain, delay, t, integrations=1):
    """Return the response of begun/(1 + gain e^(-s delay)) by Talbot's contour, turn by turn."""
    with mpmath.workdps(30):
        total, n = mpmath.mpf(0), 0
        while n * delay < t:
            left = mpmath.mpf(t) - n * mpmath.mpf(delay)

            def turn(s, n=n):
                return begun(s) * (-gain(s)) ** n / s**integrations

            total += mpmath.invertlaplace(turn, left, method="talbot", degree=70)
            n += 1
        return float(total)


def controlled(s):
    return 2 * (1 + s / 10) / (1 + s / 20) * receptance(s, mpmath.mpf("0.02"))


def proportional(s):
    return 2 * receptance(s, mpmath.mpf("0.02"))


def differentiating(s):
    return 2 * (1 + s / 10) * receptance(s, mpmath.mpf("0.02"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "gain", "late", "kind"),
    [
        ("k*(r - D*x)", proportional, 0.0, "impulse"),
        ("D*k*(r - x)", proportional, 0.3, "ramp"),
        ("D*k*(1 + T_d*s)/(1 + T_f*s)*(r - x)", controlled, 0.3, "step"),
        ("D*k*(1 + T_d*s)*(r - x)", differentiating, 0.3, "step"),
    ],
    ids=["that measures late", "that acts late", "whose controller is proper", "that differentiates"],
)
def test_a_loop_is_what_the_method_of_steps_says(force, gain, late, kind):
    times = [0.1, 0.5, 0.87, 1.3]
    found = time_response(loop(force), kind, SampleTimes.of(times))
    order = ("impulse", "step", "ramp").index(kind)
    expected = [stepped(gain, gain, 0.3, t - late, order) if t > late else 0.0 for t in times]
    assert not found.certified
    assert "estimated" in found.reason
    assert np.all(np.abs(found.values - expected) <= found.radius)
    assert found.radius[1:].max() < 0.02 * np.max(np.abs(expected))


@pytest.mark.slow
def test_what_sensors_outside_of_the_loop_see_comes_later():
    alone = time_response(loop("k*(r - D*x)"), "step", SampleTimes.of([0.5, 1.37]))
    late = time_response(loop("k*(r - D*x)", "D*D*x"), "step", SampleTimes.of([0.1, 0.59, 1.1, 1.97]))
    assert late.values[:2].tolist() == [0, 0]
    assert late.values[2:] == pytest.approx(alone.values, abs=1e-12)
