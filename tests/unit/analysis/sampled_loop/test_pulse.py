"""Pulse functions against formulas by hand (Franklin, Powell and Workman 1998, table of the z-transform)."""

from fractions import Fraction

import pytest
from flint import acb

from symflex import pipeline
from symflex.analysis.sampled_loop.pulse import pulse_function, step_response
from symflex.balls import precision
from symflex.errors import ModelError
from symflex.state_space.sampled import Sampling


def bound(formula, blocks=""):
    text = f'symflex = 1\ninputs.u = {{}}\noutputs.y = "{formula}"\n{blocks}'
    return pipeline.derive_bound(pipeline.loads(text), [("y", "u")])[0]


Z = acb(1.3, 0.4)


def value(formula, period, delay=0, z=Z, blocks=""):
    with precision(128):
        found = pulse_function(bound(formula, blocks), Sampling(Fraction(period)), Fraction(delay)).at()
        return found.value(1 / z)


def test_a_double_integrator():
    with precision(128):
        z, T = acb(1.3, 0.4), acb(1) / 5
        expected = T**2 / 2 * (z + 1) / (z - 1) ** 2
        assert value("u/s^2", "1/5").overlaps(expected)
        assert abs(value("u/s^2", "1/5") - expected) < 1e-25


def test_a_lag_with_a_part_of_a_sample_of_delay():
    # Astrom and Wittenmark 1997, example 2.8: 1/(s + 1), period 1, delay 0.4: the step is 1 - exp(-t)
    with precision(128):
        z, e = acb(1.3, 0.4), (-acb(1)).exp()
        ahead = 1 - (-acb(3) / 5).exp()
        late = (-acb(3) / 5).exp() - e
        expected = (ahead * z + late) / (z * (z - e))
        assert abs(value("u/(s + 1)", 1, "2/5") - expected) < 1e-25


def test_a_delay_of_the_plant_is_a_delay():
    blocks = 'blocks.D = { type = "delay", T = 0.4 }'
    with precision(128):
        assert abs(value("D*u/(s + 1)", 1, blocks=blocks) - value("u/(s + 1)", 1, "2/5")) < 1e-25


def test_coefficients_are_as_precise_as_they_are_asked_for():
    pulse = pulse_function(bound("u/(s^2 + s + 3)"), Sampling(Fraction(1, 7)), Fraction(0))
    with precision(2000):
        assert all(c.rel_accuracy_bits() > 1900 for c in pulse.at().above[1:])


def test_the_step_response_of_an_integrator_is_a_ramp():
    response = step_response(bound("3*u/s"))
    assert [count for _, count in response.modes] == [2]
    assert [complex(c) for c in response.at(0, 0)[1]] == [0, 3]


def test_a_function_that_grows_is_refused():
    with pytest.raises(ModelError) as caught:
        value("s*u", 1)
    assert caught.value.diagnostics[0].code == "SF236"
