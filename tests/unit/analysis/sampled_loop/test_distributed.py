"""Sampled controllers of a cantilever, against a long sum over modes that books have in formulas."""

from cmath import exp, sqrt
from math import ceil, cos, cosh, pi

import pytest
from scipy.optimize import brentq

from symflex.analysis.sampled_loop import sampled_poles, sampled_stability
from symflex.errors import ModelError, UsageError
from symflex.options import StabilityOptions
from symflex.pipeline import loads

TEXT = """symflex = 1
parameters = { K = "0.5 N/m", T = "50 ms" }
blocks     = { C = "K*z/z" }
sampled    = { period = "T", delay = "0 ms" }
inputs     = { F = { force = "x" } }
outputs    = { X = "x" }
[elements]
wall = { type = "fixed", at = "a" }
arm = { type = "beam", between = ["a", "x"], EI = "4.5 N*m^2", rhoA = "0.5 kg/m", l = "1 m", eta = "2 ms" }
motor = { type = "force_source", at = "x", f = "-C*x" }
"""
PERIOD, LOSS, MODES = 0.05, 2e-3, 200


def frequencies():
    """Return omega of 1 + cosh(beta l) cos(beta l) = 0; the tip moves by phi^2 = 4/(rho A l) in all modes."""
    for n in range(1, MODES + 1):
        middle = (n - 0.5) * pi
        root = brentq(lambda x: cos(x) + 1 / cosh(x), middle - 0.9, middle + 0.9) if n < 9 else middle
        yield root**2 * 3


def pulse(z, late=0.0):
    """Return (1 - 1/z) times the sum of the step responses of all modes at samples, as geometric series."""
    b, samples = 1 / z, ceil(late / PERIOD)
    ahead, total = samples * PERIOD - late, 0j
    for omega in frequencies():
        root = sqrt((LOSS * omega**2 / 2) ** 2 - omega**2)
        one, two = (-LOSS * omega**2 / 2 + sign * root for sign in (1, -1))
        total += 1 / omega**2 / (1 - b)
        for p, q in ((one, two), (two, one)):
            total += exp(p * ahead) / (p * (p - q)) / (1 - exp(p * PERIOD) * b)
    return 8 * (1 - b) * b**samples * total


def test_every_pole_solves_the_equation_of_the_loop():
    found = sampled_poles(loads(TEXT))
    assert found.certified and found.verdict.word == "stable" and float(found.least) == 0.5
    assert found.count == 4
    assert found.counted == "4 poles in z with abs(z) above 0.5"
    for pole in found.poles:
        z = complex(pole.z)
        assert abs(1 + 0.5 * pulse(z)) < 2e-5 * abs(z), z


@pytest.mark.slow
@pytest.mark.parametrize("late", [0.0, 0.013, 0.05, 0.12])
def test_at_every_boundary_a_pole_lies_on_the_unit_circle(late):
    model = loads(TEXT.replace('"0 ms"', f'"{late} s"'))
    found = sampled_stability(model, StabilityOptions(over=("K",), limits=(0.01, 1000)))
    assert found.certified and found.boundaries
    for boundary in found.boundaries:
        omega, gain = float(boundary.frequencies[0]), float(boundary.gain)
        # Modes beyond the last add 8/9 sum (beta l)^-4, at most 3.9e-10 m/N.
        assert abs(1 + gain * pulse(exp(1j * omega * PERIOD), late)) < 4e-10 * gain + 2e-8


def test_what_does_not_fade_is_refused():
    with pytest.raises(ModelError, match="give all members eta") as caught:
        sampled_poles(loads(TEXT.replace(', eta = "2 ms"', "")))
    assert caught.value.diagnostics[0].code == "SF235"


def test_the_period_is_not_followed_beside_beams():
    with pytest.raises((ModelError, UsageError), match="'T' is a parameter of a continuous part"):
        sampled_stability(loads(TEXT), StabilityOptions(over=("T",), limits=(0.01, 0.1)))
