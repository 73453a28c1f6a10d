"""Sampled transfer functions: held inputs exactly, controllers by Tustin's method or matched roots."""

from fractions import Fraction
from math import cos, exp, pi, sin

import control
import numpy as np
import pytest
import scipy.signal

from symflex import loads
from symflex.analysis.sampling import sampled_transfer_function
from symflex.errors import ModelError
from symflex.model import ExactValue
from symflex.state_space.sampled import Sampling
from tests.unit.analysis.systems import rational, words

H = Fraction(1, 50)
FUNCTIONS = {
    "lag": ("1/(s + 2)", [1.0], [1.0, 2.0]),
    "lead": ("(3*s + 1)/(s + 20)", [3.0, 1.0], [1.0, 20.0]),
    "oscillator": ("(3*s + 1)/(s^2 + 2*s + 50)", [3.0, 1.0], [1.0, 2.0, 50.0]),
    "double integrator": ("1/s^2", [1.0], [1.0, 0.0, 0.0]),
    "double pole": ("(s + 3)/((s + 5)^2*(s + 1))", [1.0, 3.0], [1.0, 11.0, 35.0, 25.0]),
    "notch": ("(s^2 + 1*s + 900)/(s^2 + 30*s + 900)", [1.0, 1.0, 900.0], [1.0, 30.0, 900.0]),
    "double pole of roots": ("1/(s^2 + 2*sqrt(2)*s + 2)", [1.0], [1.0, 2 * 2**0.5, 2.0]),
    "unstable": ("1/(s^2 - 9)", [1.0], [1.0, 0.0, -9.0]),
}
CIRCLE = np.exp(1j * np.array([0.05, 0.4, 1.3, 2.9]))


def delayed(delay, text="1/(s + 2)"):
    """Return a function behind a delay [s]."""
    lines = [
        "symflex = 1",
        f'parameters.T = {{ value = "{delay} s", assume = "nonnegative" }}',
        'blocks.D = { type = "delay", T = "T" }',
        "inputs.u = {}",
    ]
    return loads("\n".join([*lines, f'outputs.y = "({text})*D*u"'])).transfer_function("y", "u").bind().bound


def test_it_is_what_scipy_and_python_control_make_of_it():
    for method, other in [("zoh", "zoh"), ("tustin", "bilinear")]:
        for name, (text, num, den) in FUNCTIONS.items():
            found = sampled_transfer_function(rational(text), Sampling(H, method))
            values = np.array([found(z) for z in CIRCLE])
            above, below, _ = scipy.signal.cont2discrete((num, den), float(H), other)
            # Their coefficients, of third degree at most, lose some six digits of a response next to z = 1.
            assert values == pytest.approx(
                np.polyval(above[0], CIRCLE) / np.polyval(below, CIRCLE), rel=1e-8
            ), (method, other, name)
            theirs = control.sample_system(control.tf(num, den), float(H), other)
            assert values == pytest.approx(np.array([theirs(z) for z in CIRCLE]), rel=1e-8), (
                method,
                other,
                name,
            )


def test_tustin_is_right_at_the_frequency_it_is_prewarped_at():
    text, num, den = FUNCTIONS["notch"]
    sampling = Sampling(H, "tustin", ExactValue(Fraction(30)))
    found = sampled_transfer_function(rational(text), sampling)
    s, z = 30j, np.exp(30j * float(H))
    assert found(z) == pytest.approx(np.polyval(num, s) / np.polyval(den, s), rel=1e-13)
    theirs = control.sample_system(control.tf(num, den), float(H), "tustin", prewarp_frequency=30.0)
    assert np.array([found(z) for z in CIRCLE]) == pytest.approx(np.array([theirs(z) for z in CIRCLE]))


def test_matched_roots_are_those_of_python_control():
    for name in ["lead", "notch"]:
        text, num, den = FUNCTIONS[name]
        found = sampled_transfer_function(rational(text), Sampling(H, "matched"))
        theirs = control.sample_system(control.tf(num, den), float(H), "matched")
        assert np.array([found(z) for z in CIRCLE]) == pytest.approx(np.array([theirs(z) for z in CIRCLE])), (
            name
        )


def test_of_matched_zeros_at_infinity_one_stays_and_small_s_decides_the_gain():
    found = sampled_transfer_function(rational("7/(s*(s + 1)*(s + 2))"), Sampling(H, "matched"))
    assert [complex(z) for z in found.zeros] == [-1, -1]  # of three
    s = 1e-7
    assert found(exp(s * float(H))) * s == pytest.approx(3.5, rel=1e-6)


def test_the_response_behind_a_delay_is_right_at_samples():
    for samples in [0.0, 0.3, 1.0, 2.7]:
        # y' = -2 y + u(t - T): a step of the input makes (1 - exp(-2 (t - T)))/2.
        h = 0.1
        found = sampled_transfer_function(delayed(samples * h), Sampling(Fraction(1, 10)))
        num, den = found.coefficients()
        num = np.concatenate([np.zeros(len(den) - len(num)), num])
        got = scipy.signal.lfilter(num, den, np.ones(30))
        times = np.maximum(np.arange(30) * h - samples * h, 0)
        assert np.max(np.abs(got - (1 - np.exp(-2 * times)) / 2)) < 1e-14, samples


def test_a_sum_of_delays_is_sampled_too():
    text = 'symflex = 1\nblocks.D = { type = "delay", T = "T" }\nblocks.E = { type = "delay", T = "2.5*T" }\n'
    text += 'parameters.T = "0.03 s"\ninputs.u = {}\noutputs.y = "(D + 2*E)*9/(s^2 + 9)*u"'
    bound = loads(text).transfer_function("y", "u").bind().bound
    found = sampled_transfer_function(bound, Sampling(Fraction(1, 20)))
    num, den = found.coefficients()
    num = np.concatenate([np.zeros(len(den) - len(num)), num])
    got = scipy.signal.lfilter(num, den, np.ones(40))

    def step(t):
        return 1 - cos(3 * t) if t > 0 else 0.0

    assert got == pytest.approx(
        [step(k / 20 - 0.03) + 2 * step(k / 20 - 0.075) for k in range(40)], abs=1e-13
    )


def test_what_has_no_difference_equation_is_refused():
    for bound, method, error, said in (
        (rational("s"), "tustin", "ModelError", "more zeros than poles"),
        (rational("1/(s - 20)"), "tustin", "UsageError", "takes to infinity"),
        (delayed(0.03), "tustin", "UsageError", "0.3 samples"),
        (delayed(0.03), "matched", "UsageError", "0.3 samples"),
        (delayed(2000), "zoh", "UsageError", "1000 samples"),
    ):
        found = words(sampled_transfer_function, bound, Sampling(Fraction(1, 10), method))
        assert found.startswith(error) and said in found, (method, said)


def test_a_delay_in_a_loop_is_refused():
    text = (
        'symflex = 1\nblocks.D = { type = "delay", T = "1 s" }\ninputs.r = {}\nsignals.y = "2/s*D*(r - y)"\n'
    )
    bound = loads(text.replace("2/s", "K/s") + 'outputs.Y = "y"\nparameters.K = "2 1/s"')
    with pytest.raises(ModelError, match="delay in a loop"):
        bound.transfer_function("Y", "r").bind().discretise("1 ms")


def test_how_it_is_sampled_makes_sense():
    lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 2)"').transfer_function("y", "u").bind()
    for asked, said in (
        (("1 ms", "tustn"), "did you mean 'tustin'"),
        (("1 ms", "zoh", 10.0), "applies to 'tustin'"),
        (("1 ms", "tustin", "600 Hz"), "half of the sampling frequency"),
        (("1 ms", "tustin", -1.0), "half of the sampling frequency"),
        ((0.0,), "sampling time must be positive"),
        ((-1.0,), "sampling time must be positive"),
        ((float("nan"),), "finite"),
        (("1 kg",), "positive time"),
    ):
        found = words(lag.discretise, *asked)
        assert found.startswith("UsageError") and said in found, asked


def test_a_function_of_frequency_in_hertz_is_prewarped_in_hertz():
    lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 2)"').transfer_function("y", "u").bind()
    z = complex(cos(2 * pi * 0.1), sin(2 * pi * 0.1))  # 10 Hz at 10 ms
    assert lag.discretise(0.01, "tustin", 10.0)(z) == pytest.approx(1 / (20j * pi + 2), rel=1e-12)
