"""Beams in loops with delays agree with numerical inversions turn by turn, and with modal sums.

Few digits are asked for where few are compared: with fewer of them fewer modes are found.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response
from symflex.errors import ModelError, UncertifiedError

BEAM = 'between = ["ground", "x"], E = "1 Pa", A = "1 m^2", I = "1 m^4", rho = "1 kg/m^3", l = "1 m"'


def loop(force, eta="0.02 s", output="x", load=""):
    """Return x/r of a cantilever that a force pushes at its tip, behind a controller that is late."""
    text = f"""
symflex = 1
blocks.D = {{ type = "delay", T = "0.3 s" }}
parameters = {{ T_d = "0.1 s", T_f = "0.05 s", k = "2 N/m" }}
inputs.r = {{ unit = "m" }}
outputs.X = "{output}"
[elements]
arm = {{ type = "beam", {BEAM}, eta = "{eta}" }}
push = {{ type = "force_source", at = "x", f = "{force}" }}
{load}
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "gain", "late", "kind"),
    [
        ("k*(r - D*x)", proportional, 0.0, "step"),
        ("D*k*(r - x)", proportional, 0.3, "ramp"),
        ("D*k*(1 + T_d*s)/(1 + T_f*s)*(r - x)", controlled, 0.3, "step"),
    ],
    ids=["that measures late", "that acts late", "whose controller is proper"],
)
def test_a_loop_is_what_the_method_of_steps_says(force, gain, late, kind):
    times = [0.1, 0.5, 0.87, 1.3]
    found = time_response(loop(force), kind, SampleTimes.of(times), 8)
    order = 1 if kind == "step" else 2
    expected = [stepped(gain, gain, 0.3, t - late, order) if t > late else 0.0 for t in times]
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius)
    assert found.radius.max() < 2e-6 * np.max(np.abs(expected))


@pytest.mark.slow
def test_an_impulse_is_enclosed_too():
    times = [0.2, 0.5]
    found = time_response(loop("k*(r - D*x)"), "impulse", SampleTimes.of(times), 5)
    expected = [stepped(proportional, proportional, 0.3, t, 0) for t in times]
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius)
    assert found.radius.max() < 0.3 * np.max(np.abs(expected))


LOAD = """
mass = { type = "mass", at = "x", m = "0.3 kg" }
loss = { type = "damper", between = ["ground", "x"], b = "0.5 N*s/m" }
"""


def loaded(s):
    """Return twice the tip's displacement over a force there, of the beam with a mass and a damper."""
    return 2 / (1 / receptance(s, mpmath.mpf("0.02")) + mpmath.mpf("0.3") * s**2 + s / 2)


@pytest.mark.slow
def test_a_loop_about_a_beam_with_a_load_is_what_the_method_of_steps_says():
    times = [0.1, 0.5, 0.87]
    found = time_response(loop("k*(r - D*x)", load=LOAD), "step", SampleTimes.of(times), 8)
    expected = [stepped(loaded, loaded, 0.3, t) for t in times]
    assert found.certified
    assert np.all(np.abs(found.values - expected) <= found.radius)
    assert found.radius.max() < 1e-8 * np.max(np.abs(expected))


def convolved_twice(t):
    """Return the inverse of P^2/s of a cantilever without loss, from its modes w/(s^2 + omega^2)."""
    n = np.arange(1, 301)
    beta = (n - 0.5) * np.pi
    for _ in range(60):
        fading = 1 / np.cosh(np.minimum(beta, 300))
        beta = beta + (np.cos(beta) + fading) / (np.sin(beta) + fading * np.tanh(beta))
    square = beta**4
    omega = beta**2
    single = (1 - np.cos(omega * t)) / square  # of 1/(s (s^2 + omega^2))
    apart = square[None, :] - square[:, None] + np.eye(n.size)
    pairs = (single[:, None] - single[None, :]) / apart
    same = (1 - np.cos(omega * t)) / square**2 - t * np.sin(omega * t) / (2 * omega * square)
    np.fill_diagonal(pairs, same)
    return 16.0 * float(np.sum(pairs)), 4.0 * float(np.sum(single))


@pytest.mark.slow
def test_without_loss_the_second_turn_is_a_convolution_of_modes():
    times = [0.1, 0.45, 0.6]
    found = time_response(loop("k*(r - D*x)", eta="0 s"), "step", SampleTimes.of(times), 7)
    expected = [
        2 * convolved_twice(t)[1] - (4 * convolved_twice(t - 0.3)[0] if t > 0.3 else 0.0) for t in times
    ]
    assert found.certified
    left = 1e-8  # of 300 modes, which fall off like 1/n^4
    assert np.all(np.abs(found.values - expected) <= found.radius + left)
    assert found.radius.max() < 1e-6 * np.max(np.abs(expected))


@pytest.mark.slow
def test_a_controller_that_differentiates_leaves_an_estimate():
    found = time_response(loop("D*k*(1 + T_d*s)*(r - x)"), "step", SampleTimes.of([0.5, 0.8]), 3)

    def gain(s):
        return 2 * (1 + s / 10) * receptance(s, mpmath.mpf("0.02"))

    expected = [stepped(gain, gain, 0.3, t - 0.3) for t in (0.5, 0.8)]
    assert not found.certified
    assert "estimated" in found.reason
    assert np.all(np.abs(found.values - expected) < 0.02 * np.max(np.abs(expected)))


def test_a_thousand_turns_are_too_many():
    with pytest.raises(UncertifiedError, match="SF810"):
        time_response(loop("k*(r - D*x)"), "step", SampleTimes.of([300.0]))


@pytest.mark.slow
def test_an_impulse_that_would_only_be_estimated_is_refused():
    with pytest.raises(ModelError, match="SF813"):
        time_response(loop("D*k*(1 + T_d*s)*(r - x)"), "impulse", SampleTimes.of([0.5]), 3)
