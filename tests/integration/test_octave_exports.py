"""Exported function files, run in Octave, against ball arithmetic."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.matlab import MATLAB
from symflex.transfer import bind
from tests.integration.octave import Octave
from tests.unit.codegen.against_balls import axis_points, worst_errors
from tests.unit.codegen.exportable import derived, public_name

pytestmark = pytest.mark.needs_tool("octave")

ACCURACY = 1e-13


@pytest.fixture
def octave(tmp_path):
    return Octave(tmp_path)


def exported(octave, name, samples=400):
    """Write the function file of a model, call its main function, and return its transfer functions."""
    model, tfs = derived(name)
    made = MATLAB.export(model, tfs, name, samples=samples)
    octave.write(name, made.text)
    octave.do(f"G = {name}();")
    return tfs, {v.name for v in made.verified[len(tfs) :]}


@pytest.mark.slow
def test_what_else_a_program_can_hold_agrees_on_the_axis_and_in_both_half_planes(octave):
    asked = []
    for name in ("two_beams", "tension", "delayed", "chain"):
        tfs, on_axis = exported(octave, name, samples=5)
        assert bool(on_axis) == (name == "two_beams")
        for tf in tfs:
            w = axis_points(tf, 20)
            turned = w[::5] * np.exp(1j * np.linspace(0.3, 6.0, len(w[::5])))
            s = np.concatenate([1j * w, turned if name != "delayed" else []])
            asked.append((tf, s, octave.keep(f"G.{public_name(tf)}({octave.points(s)})")))
            if name == "chain":  # powers that overflow are taken of 1/s
                assert "is_far" in (octave.folder / "chain.m").read_text()
                far = np.array([1e3j, 1e8j, 1e16j, 1e18 + 1e18j, 1e25, -1e30j, 2.0])
                asked.append((tf, far, octave.keep(f"G.X_over_F({octave.points(far)})")))
            if tf.name in on_axis:
                key = octave.keep(f"G.{public_name(tf)}_at(real({octave.points(-w)}))")
                asked.append((tf, -1j * w, key))
    octave.run()
    for tf, s, key in asked:
        assert worst_errors(tf, s, octave.value(key))[0] <= ACCURACY, tf.name


# ------------------------------------------------------------------------------------------ what is called


@pytest.mark.slow
def test_parameters_are_given_by_name_or_in_a_struct_and_expand_against_s(octave):
    (tf, *_), _ = exported(octave, "sliding_free_beam", samples=5)
    name, s = public_name(tf), 1j * np.array([3.0, 400.0, 9e4])
    asked = [
        (f"G.{name}(s, 'l', 0.8)", s, [0.8] * 3),
        (f"G.{name}(s, struct('l', 0.8))", s, [0.8] * 3),
        (f"G.{name}(s, 'E', G.parameters.E, 'l', [0.7; 0.8; 0.9])", s, [0.7, 0.8, 0.9]),
        (f"G.{name}(s(2), struct('l', [0.7, 0.8]))", s[[1, 1]], [0.7, 0.8]),
        (f"G.{name}(s.', 'l', [0.7; 0.8])", s.repeat(2), [0.7, 0.8] * 3),
        (f"G.{name}_at(imag(s.'), 'l', [0.7; 0.8])", s.repeat(2), [0.7, 0.8] * 3),
    ]
    octave.do(f"s = {octave.points(s)};")
    octave.do("p = G.parameters; p.l = 0.8;")
    asked.append((f"G.{name}(s, p)", s, [0.8] * 3))
    keys = [octave.keep(expression) for expression, _, _ in asked]
    octave.do(f"disp(size(G.{name}(s.', 'l', [0.7; 0.8])));")
    octave.do(f"disp(size(G.{name}(ones(2, 1, 3))));")
    octave.do(f"disp(size(G.{name}([])));")
    printed = octave.run()
    assert [line.split() for line in printed.splitlines()] == [["2", "3"], ["2", "1", "3"], ["0", "0"]]
    for key, (expression, points, lengths) in zip(keys, asked, strict=True):
        for value, at, length in zip(octave.value(key), points, lengths, strict=True):
            assert abs(value / bind(tf, {"l": length})(complex(at)) - 1) < 1e-12, expression


@pytest.mark.slow
def test_complex_stiffness_and_integers_serve_as_arguments(octave):
    tfs, _ = exported(octave, "kelvin_voigt_cantilever", samples=5)
    exported(octave, "two_mass", samples=5)
    whole = octave.keep("G.X_act_over_F(int32(2), 'm_1', int8(60), 'b', false)")
    octave.do("G = kelvin_voigt_cantilever();")
    name = public_name(tfs[0])
    octave.do("p = G.parameters; eta = p.eta; s = 50i;")
    lossy = octave.keep(f"[G.{name}(s, p), G.{name}(s, 'E', p.E*(1 + eta*s), 'eta', 1e-30)]")
    octave.run()
    m_1, m_2, k = 60.0, 20.0, 71653.0
    expected = (m_2 * 4 + k) / (4 * (m_1 * m_2 * 4 + k * (m_1 + m_2)))
    assert octave.value(whole)[0] == pytest.approx(expected, rel=1e-14)
    same, other = octave.value(lossy)
    assert abs(other / same - 1) < 1e-12


@pytest.mark.slow
def test_what_cannot_be_computed_is_an_error_that_says_what(octave):
    exported(octave, "clamped_free", samples=5)
    calls = {
        "G.W_tip_over_F(1i, 'length', 2)": "there is no parameter 'length'",
        "G.W_tip_over_F(1i, struct('length', 2))": "there is no parameter 'length'",
        "G.W_tip_over_F(1i, 'l')": "parameters are a struct, or names and values in turn",
        "G.W_tip_over_F(1i, 'l', 'long')": "parameter 'l' is not a number",
        "G.W_tip_over_F(1i, 'l', [])": "parameter 'l' has no value",
        "G.W_tip_over_F('s')": "the first argument is not a number",
        "G.W_tip_over_F_at(1i)": "angular frequency and parameters must be real",
        "G.W_tip_over_F_at(1, 'E', 1i)": "angular frequency and parameters must be real",
    }
    for call in calls:
        octave.do(f"try, {call}; disp('no error'); catch problem, disp(problem.message); end")
    assert octave.run().splitlines() == list(calls.values())


def test_the_struct_tells_what_is_in_it(octave):
    exported(octave, "rod_tip_mass", samples=5)
    octave.do("disp(G.parameters.l); disp(G.units.rho); disp(G.descriptions.l);")
    octave.do("disp(strjoin(G.transfer_functions(1, :))); disp(strjoin(G.frequency_responses(1, :)));")
    octave.do("text = help('rod_tip_mass'); disp(strtok(text, char(10)));")
    printed = [line.strip() for line in octave.run().splitlines()]
    assert printed[1:5] == ["kg/m^3", "length", "X_tip/F X_tip_over_F", "X_tip/F X_tip_over_F_at"]
    assert printed[5].startswith("ROD_TIP_MASS  Transfer functions of:")


@pytest.mark.slow
def test_poles_are_not_finite_and_the_rest_of_an_array_is(octave):
    exported(octave, "two_mass", samples=5)
    octave.do("disp(isfinite(G.X_act_over_F([0, 1i])));")
    exported(octave, "sliding_free_beam", samples=5)
    octave.do("disp(isfinite(G.V_act_over_F([0, 1i])));")
    octave.do("disp(isfinite(G.V_act_over_F_at([0, 1])));")
    printed = octave.run()
    assert [line.split() for line in printed.splitlines()] == [["0", "1"]] * 3


def test_a_parameter_without_a_value_has_to_be_given(octave):
    text = """
symflex = 1
parameters.m = "2 kg"
parameters.k = {}
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
    model = pipeline.loads(text)
    octave.write("held_mass", MATLAB.export(model, pipeline.derive_all(model), "held_mass").text)
    octave.do("G = held_mass(); disp(isempty(G.parameters.k)); disp(G.X_over_F(1, 'k', 8));")
    octave.do("try, G.X_over_F(1); catch problem, disp(problem.message); end")
    assert octave.run().split("\n")[:3] == ["1", "0.1000", "parameter 'k' has no value"]
