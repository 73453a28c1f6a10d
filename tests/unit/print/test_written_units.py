"""Values stand in tables as they were written, and beside the SI values of generated code."""

import pytest

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.print.html import model_html
from symflex.print.latex import parameter_table

SPEC = """
symflex = 1
[parameters]
E = "70 GPa"
K = { value = "40 V/(A*s)", doc = "integral gain" }
n = "90 deg"
l = "2 m"
m = { unit = "t" }
[inputs]
u = {}
[outputs]
y = "l*u"
"""
ROWS = [r"\qty{70}{\giga\pascal}", r"\qty{40}{\volt\per\ampere\per\second}", r"\qty{90}{\degree}",
        r"\qty{2}{\metre}", r"symbolic, in \unit{\tonne}"]  # fmt: skip


@pytest.fixture(scope="module")
def model():
    return pipeline.loads(SPEC)


def test_a_table_in_latex_has_values_as_they_were_written(model):
    table = parameter_table(model)
    assert [row for row in ROWS if row not in table] == []


def test_a_notebook_has_values_as_they_were_written(model):
    shown = model_html(model)
    assert ">70</td>" in shown
    assert ">GPa</td>" in shown
    assert "7e10" not in shown


def test_a_value_set_in_another_unit_stands_in_that_unit():
    model = pipeline.loads(SPEC.replace('"2 m"', '"80 cm"'))
    assert r"\qty{80}{\centi\metre}" in parameter_table(model)


BEAM = """
symflex = 1
parameters = { k = "35 kN/m", m = "3 kg" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
"""


def test_generated_code_says_values_as_they_were_written():
    model = pipeline.loads(BEAM)
    tfs = pipeline.derive_all(model)
    for target in ("numpy", "jax", "julia", "matlab", "state-space", "c"):
        said = ".k = 35000.0, /* 35 kN/m */" if target == "c" else "[N/m]. 35 kN/m in the model."
        text = EXPORTERS[target].export(model, tfs, "spring").text
        assert said in " ".join(text.replace("%", " ").split()), target
        assert "3 kg in the model" not in text, target  # that is SI


def test_a_pitch_stands_as_it_was_declared_also_where_it_is_read_in_radians():
    model = pipeline.loads("""
symflex = 1
parameters = { J = "2 kg*m^2", h = "10 mm/rev", m = "3 kg" }
inputs.T = { torque = "phi" }
outputs.X = "x"
[elements]
rotor = { type = "inertia", at = "phi", J = "J" }
screw = { type = "transformer", from = "phi", to = "x", ratio = "h" }
table = { type = "mass", at = "x", m = "m" }
""")
    assert r"\num{10}~mm/rev" in parameter_table(model)
    assert repr(model.parameters[1]) == "<ModelParameter h: 10 mm/rev>"
    # 10 mm per 2 pi rad: the value that is computed with.
    assert float(model.parameters[1].value.nearly) == pytest.approx(0.01 / (2 * 3.141592653589793), rel=1e-14)


def test_transfer_functions_and_parameters_have_the_units_that_were_written():
    model = pipeline.loads("""
symflex = 1
parameters = { K_i = "2 V/A", K_w = "0.2 A*s/rad", w_c = "30 rad/s", k = "2 W/(m*K)", l = "1 m" }
inputs = { w = { unit = "rad/s" }, q = { unit = "W/m^2" } }
outputs = { i = "K_w*w", v = "K_i*K_w*w", z = "w_c/(s + w_c)*w", T = "q*l/k" }
""")
    assert [p.unit for p in model.parameters[:3]] == ["V/A", "A*s/rad", "rad/s"]
    units = {tf.name: tf.unit for tf in pipeline.derive_all(model)}
    assert [units[name] for name in ("i/w", "v/w", "z/w", "T/q")] == ["A*s/rad", "V*s/rad", "1", "K*m^2/W"]
