"""The exported module of state equations: run, and compared."""

import math
from pathlib import Path

import mpmath
import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.state_space import StateSpaceExporter, state_space_module
from symflex.errors import BudgetError, ModelError
from symflex.state_space import minimal, realise
from tests.unit.codegen.exportable import executed
from tests.unit.codegen.hostile_names import SPEC

ROOT = Path(__file__).parents[3]
PAPER = ROOT / "derivations" / "eppinger1988"


def exported(model, samples=5, *, is_minimal=False):
    tfs = pipeline.derive_all(model)
    system = minimal(realise(model)) if is_minimal else realise(model)
    return state_space_module(system, tfs, samples=samples)


def response(matrices, s):
    a, b, c, d = matrices
    return c @ np.linalg.solve(s * np.eye(len(a)) - a, b) + d


@pytest.mark.parametrize(
    ("name", "is_minimal"), [("two_mass", False), ("rigid_body", False), ("six_mass", True)]
)
def test_the_module_computes_every_transfer_function(name, is_minimal):
    model = pipeline.load(PAPER / f"{name}.toml")
    space = executed(exported(model, is_minimal=is_minimal).text)
    matrices = space["state_space"]()
    outputs, inputs = ([x["name"] for x in space[key]] for key in ("OUTPUTS", "INPUTS"))
    assert len(space["STATES"]) == len(matrices[0])
    for tf in pipeline.derive_all(model):
        i, j = outputs.index(tf.output.name), inputs.index(tf.input.name)
        bound = pipeline.bind(tf)
        for s in (30 + 400j, -20 + 50j):
            assert response(matrices, s)[i, j] == pytest.approx(bound(s), rel=1e-10)


def test_states_inputs_and_outputs_are_listed_with_units():
    space = executed(exported(pipeline.load(PAPER / "rigid_body.toml")).text)
    assert space["STATES"] == (
        {"name": "x_tip", "unit": "m", "meaning": "x_tip"},
        {"name": "motor_i", "unit": "A", "meaning": "motor.i"},
        {"name": "x_tip_dot", "unit": "m/s", "meaning": "s*x_tip"},
    )
    assert space["INPUTS"] == ({"name": "V_cmd", "unit": "V"},)
    assert space["OUTPUTS"] == ({"name": "V_tip", "unit": "m/s"}, {"name": "A_tip", "unit": "m/s^2"})


def test_the_docstring_prints_equations_and_matrices():
    documented = executed(exported(pipeline.load(PAPER / "two_mass.toml")).text)["state_space"].__doc__
    assert "s*x_tip_dot = k/m_2*x_act - k/m_2*x_tip + b/m_2*x_act_dot - b/m_2*x_tip_dot" in documented
    assert "[-k/m_1   k/m_1  -b/m_1   b/m_1]" in documented
    assert "None of these may be zero: m_1, m_2." in documented


def test_the_verified_error_is_small_and_stands_in_the_header():
    made = exported(pipeline.load(PAPER / "two_mass.toml"), samples=40)
    assert all(v.error is not None and v.error < 1e-13 for v in made.verified)
    for v in made.verified:
        assert f"{v.name}: verified: worst relative error {v.error:.1e}" in made.text


def test_the_measured_error_bounds_what_the_module_is_off_by():
    model = pipeline.load(PAPER / "two_mass.toml")
    made = exported(model, samples=60)
    a, b, c, d = executed(made.text)["state_space"]()
    # In 40 digits, so that only the rounding of the entries is seen.
    with mpmath.workdps(40):
        for i, (tf, v) in enumerate(zip(pipeline.derive_all(model), made.verified, strict=True)):
            bound = pipeline.bind(tf)
            for hertz in (1.0, 5.0, 150.0):
                s = mpmath.mpc(0, 2 * math.pi * hertz)
                x = mpmath.lu_solve(s * mpmath.eye(4) - mpmath.matrix(a.tolist()), mpmath.matrix(b.tolist()))
                value = complex((mpmath.matrix(c.tolist()) * x)[i] + d[i, 0])
                exact = bound(complex(s))
                slope = abs(
                    complex(s) * (bound(complex(s) * (1 + 1e-6)) - exact) / (1e-6 * complex(s) * exact)
                )
                assert abs(value / exact - 1) <= v.error * (1 + slope) + 2e-16


@pytest.mark.slow
def test_low_frequencies_of_a_free_chain_cost_digits_and_are_warned_of():
    text = (PAPER / "six_mass.toml").read_text().replace('"1 Hz", "200 Hz"', '"0.001 Hz", "200 Hz"')
    model = pipeline.loads(text)
    made = EXPORTERS["state-space"].export(model, pipeline.derive_all(model, [("X_tip", "F")]))
    assert any("accurate to" in warning for warning in made.warnings)
    # without the rigid body among the states nothing is lost
    small = StateSpaceExporter(is_minimal=True).export(model, pipeline.derive_all(model, [("V_tip", "F")]))
    assert small.warnings == ()


def test_parameters_without_value_are_asked_for_and_nothing_is_claimed():
    made = exported(pipeline.loads(SPEC))
    assert "not verified: no values for k" in made.text
    space = executed(made.text)
    with pytest.raises(TypeError, match="'k'"):
        space["state_space"]()
    assert space["state_space"](k=8.0)[0].tolist() == [[0, 1], [-4, -1.5]]


def test_the_functions_of_a_model_are_constants_of_the_module():
    text = (
        'symflex = 1\nparameters = { k = "8 N/m", f = "2 Hz" }\ninputs.u = {}\n'
        'outputs.y = "sqrt(k)*u/(s + 2*f^3/(f*f))"'
    )
    space = executed(exported(pipeline.loads(text)).text)
    a, b, _, _ = space["state_space"]()
    assert (a[0, 0], b[0, 0]) == (pytest.approx(-8 * math.pi), pytest.approx(math.sqrt(8)))


def test_a_beam_has_none():
    model = pipeline.load(PAPER / "sliding_free_beam.toml")
    with pytest.raises(ModelError, match="SF235"):
        EXPORTERS["state-space"].export(model, pipeline.derive_all(model))


def test_a_module_that_would_be_megabytes_is_refused(monkeypatch):
    monkeypatch.setattr("symflex.codegen.state_space.TERM_LIMIT", 10)
    with pytest.raises(BudgetError, match="SF503"):
        exported(pipeline.load(PAPER / "two_mass.toml"))


def test_the_printed_equations_of_large_systems_end_with_how_many_are_left(monkeypatch):
    monkeypatch.setattr("symflex.codegen.state_space.EQUATION_LINES", 3)
    assert "... and 5 equations more." in exported(pipeline.load(PAPER / "two_mass.toml")).text
