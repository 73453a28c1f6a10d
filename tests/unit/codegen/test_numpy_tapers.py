"""The module of a conical rod, which has a formula: u (1 - c x) is a uniform rod's motion (Rayleigh 1894)."""

from __future__ import annotations

import types

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import ModelError

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
    return EXPORTERS["numpy"].export(model, pipeline.derive_all(model), "cone")


@pytest.fixture(scope="module")
def cone(made):
    module = types.ModuleType("cone")
    exec(compile(made.text, "cone.py", "exec"), module.__dict__)  # noqa: S102
    return module.y_over_F


def test_the_module_states_an_accuracy_of_thirteen_digits(made):
    assert made.verified[0].error < 1e-13
    assert not made.warnings


@pytest.mark.parametrize("s", [30j, 2000 + 9000j, -5000 + 20000j, 400.0])
def test_numbers_give_the_cones_receptance(cone, s):
    assert cone(s) == pytest.approx(receptance(s), rel=1e-11)


def test_arrays_give_the_cones_receptance(cone):
    s = 1j * np.geomspace(60, 2e4, 300) + 100
    assert cone(s) == pytest.approx(receptance(s), rel=1e-11)


def test_the_taper_may_be_an_array_and_none_is_the_uniform_rod(cone):
    c = np.array([0.0, 0.3, 0.8])
    s = np.array([[4000j], [9000 + 500j]])
    assert cone(s, c=c) == pytest.approx(receptance(s, c), rel=1e-11)


def test_languages_without_code_for_it_refuse_and_name_one_that_has():
    model = pipeline.loads(CONE)
    with pytest.raises(ModelError) as caught:
        EXPORTERS["julia"].export(model, pipeline.derive_all(model), "cone")
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF910"
    assert "numpy" in problem.hint
