"""Systems of exported function files in Octave.

The Control System Toolbox is not here, nor the package control: functions of the names ``tf``, ``zpk`` and
``ss`` keep what they are given, so that this is seen.
"""

import pytest

from symflex import pipeline
from symflex.codegen.matlab import MATLAB
from tests.integration.octave import Octave

pytestmark = pytest.mark.needs_tool("octave")

# m x'' + b x' + k x = F, by hand: X/F = 1/(m s^2 + b s + k), poles of 2 s^2 + 8 s + 6 at -1 and -3.
OSCILLATOR = """
symflex = 1
parameters = { m = "2 kg", b = "8 N*s/m", k = "6 N/m", T = "4 ms", num = "5 m/s" }
inputs.F = { force = "x" }
blocks.late = { type = "delay", T = "T" }
outputs = { X = "x", Y = "num*late*x", W = "late*x - x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
"""
KEEPERS = {
    "tf": "function v = tf(num, den)\n  v.kind = 'tf'; v.num = num; v.den = den;\nend\n",
    "zpk": "function v = zpk(z, p, k)\n  v.kind = 'zpk'; v.z = z; v.p = p; v.k = k;\nend\n",
    "ss": "function v = ss(s)\n  v = s; v.kind = 'ss';\nend\n",
}


@pytest.fixture(scope="module")
def values(tmp_path_factory):
    octave = Octave(tmp_path_factory.mktemp("systems"))
    model = pipeline.loads(OSCILLATOR)
    octave.write("osc", MATLAB.export(model, pipeline.derive_all(model), "osc", samples=20).text)
    for name, text in KEEPERS.items():
        octave.write(name, text)
    octave.do("G = osc(); a = G.systems.X_over_F(); z = G.systems.X_over_F('zpk'); y = G.systems.Y_over_F();")
    octave.do("c = G.systems.X_over_F('ss', 'm', 4); [n, d, t] = G.coefficients.Y_over_F(struct('T', 0.5));")
    asked = {
        "num": "a.num", "den": "a.den", "poles": "sort(z.p)", "gain": "z.k", "late": "y.InputDelay",
        "other mass": "c.den", "late elsewhere": "t", "numerator": "n",
        "names": "double([a.InputName, a.OutputName, a.InputUnit, a.OutputUnit, c.kind])",
        "delayless": "isfield(a, 'InputDelay')", "rational": "isfield(G.systems, 'W_over_F')",
    }  # fmt: skip
    keys = {name: octave.keep(expression) for name, expression in asked.items()}
    octave.run()
    return {name: octave.value(key).real.tolist() for name, key in keys.items()}


def test_a_tf_has_the_coefficients_by_descending_powers_of_s(values):
    assert values["num"] == [1]
    assert values["den"] == [2, 8, 6]


def test_a_zpk_has_poles_and_the_gain_of_the_leading_coefficients(values):
    assert values["poles"] == pytest.approx([-3, -1])
    assert values["gain"] == [0.5]


def test_values_given_stand_in_place_of_the_model_s(values):
    assert values["other mass"] == [4, 8, 6]
    assert values["late elsewhere"] == [0.5]


def test_a_delay_is_an_input_delay(values):
    assert values["late"] == [0.004]
    assert values["delayless"] == [0]


def test_a_parameter_may_be_called_as_a_variable_of_the_code(values):
    assert values["numerator"] == [5]


def test_a_system_has_names_and_units_of_its_ends(values):
    assert "".join(map(chr, map(int, values["names"]))) == "FXNmss"


def test_what_is_no_rational_function_with_a_delay_is_no_system(values):
    assert values["rational"] == [0]
