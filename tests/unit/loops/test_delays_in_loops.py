"""Cascaded loops with delay: proved whatever carries the delay, or it is said why not."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from symflex import pipeline
from symflex.loops import two_unknowns
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions

CASCADE = """
symflex = 1

[parameters]
J   = "3 g*m^2"
k_t = "1.1 N*m/A"
L   = "6 mH"
R   = "0.6 ohm"
K_c = "30 V/A"
T_c = "2 ms"
K_v = "4 A*s/rad"
T_v = "10 ms"
K_p = "60 1/s"
T   = "0.5 ms"

[blocks]
D_v  = {{ type = "delay", T = "{speed}*T" }}
D_c  = {{ type = "delay", T = "{current}*T" }}
D_u  = {{ type = "delay", T = "{voltage}*T" }}
PI_v = {{ type = "tf", num = "K_v*(T_v*s + 1)", den = "T_v*s" }}
PI_c = {{ type = "tf", num = "K_c*(T_c*s + 1)", den = "T_c*s" }}

[elements]
motor = {{ type = "dc_motor", terminals = ["u", "ground"], shaft = "phi", k_t = "k_t", L = "L", R = "R" }}
amp   = {{ type = "voltage_source", at = "u", v = "v_m" }}
rotor = {{ type = "inertia", at = "phi", J = "J" }}

[signals]
v_m = "D_u*PI_c*(PI_v*(K_p*(r - phi) - D_v*s*phi) - D_c*motor.i)"

[inputs]
r = {{ unit = "rad" }}

[outputs]
Phi = "phi"
"""


def counted(speed, current, voltage):
    """Count the roots of the hand-written characteristic function by its winding, with numpy alone."""
    inertia, k, inductance, resistance = 3e-3, 1.1, 6e-3, 0.6
    time = 0.5e-3

    def function(s):
        speed_controller, current_controller = (
            4 * (0.01 * s + 1) / (0.01 * s),
            30 * (0.002 * s + 1) / (0.002 * s),
        )
        forward = np.exp(-s * voltage * time) * current_controller
        winding = inductance * s + resistance + forward * np.exp(-s * current * time)
        back = k * s + forward * speed_controller * (60 + np.exp(-s * speed * time) * s)
        return s**2 * (inertia * s**2 * winding + k * back)

    radius, inner = 1e6, 1e-2
    axis = np.geomspace(inner, radius, 400_000)
    half = np.linspace(-np.pi / 2, np.pi / 2, 400_000)
    path = np.concatenate(
        [radius * np.exp(1j * half), 1j * axis[::-1], inner * np.exp(1j * half[::-1]), -1j * axis]
    )
    return round(
        float(np.unwrap(np.angle(function(path)))[-1] - np.angle(function(path[:1]))[0]) / (2 * np.pi)
    )


def cascade(speed, current, voltage):
    return pipeline.loads(CASCADE.format(speed=speed, current=current, voltage=voltage))


@pytest.mark.slow
def test_a_cascade_is_proved_with_delay_in_several_places():
    place = (2, 0, 1)
    model = cascade(*place)
    found = stability(model, StabilityOptions("K_v", (Fraction(3), Fraction(5))))
    assert (found.certified, found.reasons) == (True, ())
    assert found.nominal_interval.poles.right == counted(*place)
    # The roots of its transfer functions say the same.
    verdict = pipeline.roots(pipeline.derive_bound(model, model.transfer_functions)[0]).verdict
    assert (verdict.right, verdict.certified) == (counted(*place), True)


@pytest.mark.slow
def test_a_loop_that_cannot_be_proved_has_a_reason():
    # The current's rate fed back with delay: K_d D s^2 beside L s^2, neutral and of one size.
    text = CASCADE.format(speed=0, current=1, voltage=0).replace("D_c*motor.i", "D_c*(1 + s/5000)*motor.i")
    found = stability(pipeline.loads(text), StabilityOptions("K_v", (Fraction(3), Fraction(5))))
    assert not found.certified
    assert "share the highest power of s" in found.reasons[0]
    assert f"not proved: {found.reasons[0]}" in " ".join(str(found).split())


def test_a_map_that_is_not_complete_cannot_be_without_a_reason():
    found = stability(cascade(0, 0, 1), StabilityOptions("K_v", (Fraction(3), Fraction(5))))
    with pytest.raises(ValueError, match="needs a reason"):
        replace(found, is_complete=False, reasons=())


@pytest.mark.parametrize(("gain", "word"), [("0.999", "stable"), ("1.001", "unstable")])
def test_a_repetitive_controller_is_judged_at_its_gain_where_the_range_leaves_it_open(gain, word):
    # All poles have exp(s T) = K, and so a real part ln(K)/T.
    text = f"""
symflex = 1
parameters = {{ K = {gain}, T = "20 ms" }}
blocks.D = {{ type = "delay", T = "T" }}
signals.v = "r + K*D*v"
inputs.r = {{}}
outputs.V = "v"
"""
    assert stability(pipeline.loads(text), StabilityOptions("K")).verdict.word == word


def test_a_loop_whose_delayed_rate_outweighs_the_rate_is_unstable_for_every_gain():
    # s (1 + 1.2 exp(-s)) + K: for large s exp(-s) is -1/1.2, and so poles have a real part near ln(1.2).
    text = """
symflex = 1
parameters.K = 0.001
blocks.D = { type = "delay", T = 1 }
signals.v = "(K*(r - v) - 1.2*s*D*v)/s"
inputs.r = {}
outputs.V = "v"
"""
    found = stability(pipeline.loads(text), StabilityOptions("K"))
    assert found.verdict.word == "unstable"
    assert not found.intervals
    assert "infinitely many poles lie in the right half-plane" in found.reasons[0]
    assert "not proved" not in str(found)


@pytest.mark.parametrize(("gain", "word"), [(2, "stable"), (6, "unstable")])
def test_the_range_of_a_delayed_acceleration_ends_below_the_mass(gain, word):
    # 4 s^2 + 8 s + 100 + K s^2 exp(-s T): at a crossing K^2 = 16 - 736/w^2 + 10^4/w^4, first where w T is
    # near pi and K is 3.9998; beyond K = 4 infinitely many poles lie in the right half-plane.
    text = f"""
symflex = 1
parameters = {{ m = "4 kg", K_a = "{gain} kg" }}
elements.block = {{ type = "mass", at = "x", m = "m" }}
elements.spring = {{ type = "spring", between = ["x", "ground"], k = "100 N/m" }}
elements.damper = {{ type = "damper", between = ["x", "ground"], b = "8 N*s/m" }}
elements.motor = {{ type = "force_source", at = "x", f = "F - K_a*D*s^2*x" }}
blocks.D = {{ type = "delay", T = "4 ms" }}
inputs.F = {{}}
outputs.X = "x"
"""
    found = stability(pipeline.loads(text), StabilityOptions("K_a"))
    assert found.certified
    assert found.is_narrowed
    assert found.verdict.word == word
    (stable,) = found.stable
    assert (found.limits[0], not found.boundaries) == (0, True)
    assert 3.9 < float(stable.high) < 3.9999


@pytest.mark.parametrize("written", ["0", '"0 s"'])
def test_without_delay_a_loop_is_one_of_polynomials(written):
    # s + K*exp(-s*T) is stable up to K = pi/(2 T); without delay it always is.
    text = f"""
symflex = 1
parameters.K = 3
blocks.D = {{ type = "delay", T = {written} }}
blocks.I = {{ type = "integrator" }}
signals.v = "I*K*D*(r - v)"
inputs.r = {{}}
outputs.V = "v"
"""
    model = pipeline.loads(text)
    assert not model.is_distributed
    found = stability(model, StabilityOptions("K"))
    assert found.method == "polynomials"
    assert [(i.low, i.high) for i in found.stable] == [(0, None)]


def test_the_range_of_one_gain_in_two_channels_begins_at_its_end():
    # Wood & Berry 1973, a distillation column; scipy's fsolve of 1 + ... = 0 in K and omega: 1.26032, 0.5125.
    column = """symflex = 1
parameters.K = 0.1
inputs = { r_1 = {}, r_2 = {} }
outputs.Y = "y_1"
[signals]
y_1 = "12.8*exp(-s)/(16.7*s + 1)*u_1 - 18.9*exp(-3*s)/(21*s + 1)*u_2"
y_2 = "6.6*exp(-7*s)/(10.9*s + 1)*u_1 - 19.4*exp(-3*s)/(14.4*s + 1)*u_2"
u_1 = "K*(r_1 - y_1)"
u_2 = "-0.2*K*(r_2 - y_2)"
"""
    (stable,) = stability(pipeline.loads(column), StabilityOptions("K", ("0", "1.5"))).stable
    assert stable.low == 0
    assert float(stable.high) == pytest.approx(1.26032, abs=5e-6)


def test_a_function_of_the_gain_has_the_boundaries_of_its_values():
    # exp(-0.1*s)/(s + 1) has poles on the axis where tan(w/10) = -w, and there the gain is sqrt(1 + w^2).
    text = 'symflex = 1\nparameters.K = 2\nsignals.y = "K*(1 + K)*exp(-0.1*s)/(s + 1)*(r - y)"\n'
    found = stability(
        pipeline.loads(text + 'inputs.r = {}\noutputs.Y = "y"\n'), StabilityOptions("K", (0, 20))
    )
    w = np.array([float(boundary.frequencies[0]) for boundary in found.boundaries])
    gains = np.array([float(boundary.gain) for boundary in found.boundaries])
    assert found.certified
    assert len(w) == 7
    np.testing.assert_allclose(np.tan(w / 10), -w, rtol=1e-9)
    np.testing.assert_allclose(gains * (1 + gains), np.sqrt(1 + w**2), rtol=1e-12)
    # (K + K^2)/(s + 1) has magnitude one at w^2 = 35; the delay takes 0.1 w off its phase.
    (margin,) = found.phase_margins
    assert float(margin.angle) == pytest.approx(np.pi - np.arctan(35**0.5) - 0.1 * 35**0.5, rel=1e-12)


def test_a_search_in_two_unknowns_that_takes_too_long_tells_of_the_gain_itself_alone(monkeypatch):
    # s + K exp(-s) = -+ 0.5 j is stable up to K = pi/2 - 0.5.
    monkeypatch.setattr(two_unknowns, "MOST_INTERVALS", 3)
    text = 'symflex = 1\nparameters.K = 0.8\nsignals.y = "K*(2*s + K*exp(-s))*exp(-s)/(s^2 + 0.25)*(r - y)"\n'
    found = stability(
        pipeline.loads(text + 'inputs.r = {}\noutputs.Y = "y"\n'), StabilityOptions("K", (0, 4))
    )
    assert (found.intervals, found.at_nominal.word, found.certified) == ((), "stable", False)
