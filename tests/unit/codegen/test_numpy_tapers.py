"""Modules of a cone, whose u (1 - c x) is a uniform rod's motion (Rayleigh 1894), and of what has a tip."""

import numpy as np
import pytest
from scipy.special import factorial, ive, jv

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from tests.unit.codegen.exportable import derived, executed

CONE = """
symflex = 1
[parameters]
E = "200 GPa"
rho = "7800 kg/m^3"
A_0 = "16 cm^2"
l = "1 m"
c = "0.5 1/m"
[elements]
rod = { type = "rod", between = ["ground", "tip"], E = "E", rho = "rho", l = "l", A = "A_0*(1 - c*x)^2" }
[inputs]
F = { force = "tip" }
[outputs]
y = "tip"
[analysis]
band = ["10 Hz", "5 kHz"]
"""


def receptance(s, c=0.5, l=1.0):  # noqa: E741
    """Return u(l)/F of the cone, fixed at x = 0."""
    k = -1j * s * np.sqrt(7800 / 200e9)
    below = (1 - c * l) * k * np.cos(k * l) + c * np.sin(k * l)
    return np.sin(k * l) / (1 - c * l) / (200e9 * 16e-4 * below)


@pytest.fixture(scope="module")
def made():
    model = pipeline.loads(CONE)
    return EXPORTERS["numpy"].export(model, pipeline.derive_all(model), "cone", samples=30)


def function_of(made):
    return executed(made.text)["y_over_F"]


@pytest.fixture(scope="module")
def cone(made):
    return function_of(made)


def test_the_module_states_an_accuracy_of_thirteen_digits(made):
    assert made.verified[0].error < 1e-13
    assert not made.warnings


def test_numbers_give_the_cones_receptance(cone):
    for s in (30j, 2000 + 9000j, -5000 + 20000j, 400.0):
        assert cone(s) == pytest.approx(receptance(s), rel=1e-11), s


def test_arrays_give_the_cones_receptance(cone):
    s = 1j * np.geomspace(60, 2e4, 300) + 100
    assert cone(s) == pytest.approx(receptance(s), rel=1e-11)


def test_the_taper_may_be_an_array_and_none_is_the_uniform_rod(cone):
    c = np.array([0.0, 0.3, 0.8])
    s = np.array([[4000j], [9000 + 500j]])
    assert cone(s, c=c) == pytest.approx(receptance(s, c), rel=1e-11)


@pytest.mark.slow
def test_a_uniform_rod_before_the_cone_is_followed_too():
    rod = """[elements]
        root = { type = "rod", between = ["ground", "p"], E = "E", rho = "rho", l = "l", A = "A_0" }"""
    text = CONE.replace("[elements]", rod).replace('["ground", "tip"]', '["p", "tip"]')
    model = pipeline.loads(text)
    made = EXPORTERS["numpy"].export(model, pipeline.derive_all(model), "cone", samples=30)
    s = np.array([30j, 2000 + 9000j, -5000 + 20000j, 400.0])
    k, c = -1j * s * np.sqrt(7800 / 200e9), 0.5
    # u = v/(1 - c x), where v'' = -k^2 v; at x = 0 both rods have u = sin(k) and u' = k cos(k).
    u, slope = np.sin(k), k * np.cos(k) - c * np.sin(k)
    tip = (u * np.cos(k) + slope * np.sin(k) / k) / (1 - c)
    strain = (slope * np.cos(k) - u * k * np.sin(k) + c * tip) / (1 - c)
    assert made.verified[0].error < 1e-12
    assert function_of(made)(s) == pytest.approx(tip / (200e9 * 16e-4 * (1 - c) ** 2 * strain), rel=1e-11)


# ---------------------------------------------------------------------------------------------------- tips

TIPS = np.array([2j, 9j, 0.3 + 4j, -0.5 + 12j, 30j, 1.5])
"""Frequencies [rad/s]: of the string up to its twelfth mode."""


def functions(name):
    model, tfs = derived(name)
    made = EXPORTERS["numpy"].export(model, tfs, name, samples=10)
    assert not made.warnings
    return executed(made.text)


def hanging(s, above, length):
    """Return w/w_0 of a string that hangs, at a height above its free end (D. Bernoulli 1733)."""
    x = -2j * s / np.sqrt(9.81)
    return jv(0, x * np.sqrt(above)) / jv(0, x * np.sqrt(length))


@pytest.mark.slow
def test_a_hanging_string_is_bessels_function():
    string = functions("hanging_string")
    assert string["tip_over_w_0"](TIPS) == pytest.approx(hanging(TIPS, 0.0, 2.0), rel=2e-12)
    assert string["mid_over_w_0"](TIPS) == pytest.approx(hanging(TIPS, 1.0, 2.0), rel=2e-12)
    lengths = np.array([[0.5], [3.0]])
    assert string["tip_over_w_0"](TIPS, l=lengths) == pytest.approx(hanging(TIPS, 0.0, lengths), rel=2e-12)
    # Up to the mode 86; in C up to the mode 570. A rounding of s alone costs |s G'/G| times as much.
    omega = np.geomspace(0.1, 300, 12)
    x = 2 * omega * np.sqrt(2 / 9.81)
    room = 3e-14 * (1 + np.abs(x * jv(1, x) / jv(0, x)))
    assert np.all(np.abs(string["tip_over_w_0"](1j * omega) * jv(0, x) - 1) < room)


def kirchhoff(s, n):
    """Return w/w_0 at the tip of a wedge, n = 1, or of a cone, n = 2, of length 1 (Kirchhoff 1879).

    With h from the tip w = (a J_n(z) + b I_n(z)) h^(-n/2), z = 2 beta sqrt(h).
    """
    beta = (-(s**2) * 0.8 / 200.0 + 0j) ** 0.25
    z = 2 * beta
    # w' = 0 at the clamp; both functions begin with (z/2)^n/n!. ive(n, z) is iv(n, z) exp(-|Re z|).
    shape = jv(n + 1, z) / ive(n + 1, z)
    growing = shape * np.exp(-np.abs(z.real))
    return beta**n / factorial(n) * (1 + growing) / (jv(n, z) + shape * ive(n, z))


FAST = 200 * TIPS
"""Frequencies [rad/s] up to the sixth mode of the wedge."""


@pytest.mark.parametrize(("name", "n"), [("wedge", 1), ("cone", 2)])
@pytest.mark.slow
def test_a_wedge_and_a_cone_are_kirchhoffs(name, n):
    assert functions(name)["tip_over_w_0"](FAST) == pytest.approx(kirchhoff(FAST, n), rel=1e-11)
