"""A name given in Hz counts cycles in every formula, and 2 pi stands beside it where radians are meant."""

import math
from fractions import Fraction

import pytest
import sympy

import symflex
from benchmarks.generated import imported
from symflex import audit as audit_layer
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import SpecError
from symflex.model import ExactValue
from symflex.print.mathml import transfer_function_mathml

POINT = 3 + 40j
LOW_PASS = """symflex = 1
[parameters]
f_c = "50 Hz"
[inputs]
u = {{}}
[outputs]
y = "{expression}"
{sections}
"""


def loaded(expression, sections=""):
    return symflex.loads(LOW_PASS.format(expression=expression, sections=sections))


def readings(model):
    return [(w.span.line, w.span.text, w.message) for w in model.warnings if w.code == "SF655"]


def printed(model):
    """Return the printed formula and what it is at the point, with 50 put in for f_c."""
    text = str(model.transfer_function("y", "u").form("polynomial")).partition(" = ")[2]
    value = sympy.sympify(text.replace("^", "**")).subs({"f_c": 50, "s": sympy.sympify(POINT)})
    return text, complex(value)


def low_pass(hertz):
    return 2 * math.pi * hertz / (POINT + 2 * math.pi * hertz)


def test_the_printed_formula_with_the_declared_hertz_put_in_is_the_function():
    for expression in [
        "f_c*u/(s + f_c)",
        "u*2*pi*f_c/(s + 2*pi*f_c)",
        "u/(1 + s/f_c)",
        "u/(1 + s/(2*pi*f_c))",
    ]:
        model = loaded(expression)
        values = printed(model)[1], model.transfer_function("y", "u").bind()(POINT)
        assert values == pytest.approx([low_pass(50)] * 2, rel=1e-12), expression


def test_two_pi_that_entered_is_printed():
    assert printed(loaded("f_c*u/(s + f_c)"))[0] == "2*pi*f_c/(s + 2*pi*f_c)"


def test_latex_and_mathml_show_it_too():
    tf = loaded("f_c*u/(s + f_c)").transfer_function("y", "u")
    assert r"2 \pi f_{c}" in tf.latex()
    (row,) = transfer_function_mathml(tf.exact, tf.form().printed)
    assert "".join(row.pieces).count("π") == 2


def test_the_sympy_expression_is_the_printed_one():
    tf = loaded("f_c*u/(s + f_c)").transfer_function("y", "u")
    (f_c,) = (x for x in tf.num.free_symbols if x.name == "f_c")
    assert sympy.simplify(tf.num / tf.den.subs("s", 0) - 1) == 0
    assert tf.num / f_c == 2 * sympy.pi


def test_the_printed_formula_read_again_is_the_same_function():
    text, value = printed(loaded("f_c*u/(s + f_c)"))
    again = loaded(f"({text})*u")
    assert again.transfer_function("y", "u").bind()(POINT) == pytest.approx(value, rel=1e-12)
    assert readings(again) == []


def test_exported_code_takes_hertz():
    resolved = loaded("f_c*u/(s + f_c)").resolved
    text = EXPORTERS["numpy"].export(resolved, pipeline.derive_all(resolved)).text
    (function,) = imported(text, "exported").TRANSFER_FUNCTIONS.values()
    assert complex(function(POINT, f_c=60.0)) == pytest.approx(low_pass(60), rel=1e-12)
    assert "Hz" in text


def test_values_bound_to_a_frequency_in_hertz_are_in_hertz_unless_their_unit_says_else():
    for value in [60, "60 Hz", "3600 rpm", "120*pi rad/s", Fraction(60)]:
        bound = loaded("f_c*u/(s + f_c)").transfer_function("y", "u").bind(f_c=value)
        assert bound(POINT) == pytest.approx(low_pass(60), rel=1e-12), value


def test_a_definition_of_a_frequency_shows_the_two_pi():
    model = loaded("w*u/(s + w)", '[definitions]\nw = "f_c"')
    form = model.transfer_function("y", "u").form("definitions")
    assert "w = 2*pi*f_c" in str(form)


def test_a_published_formula_may_convert_by_itself_or_not():
    for expression in ["f_c/(s + f_c)", "2*pi*f_c/(s + 2*pi*f_c)", "1/(1 + s/w)"]:
        where = '\nwhere = { w = "2*pi*f_c" }'
        model = loaded("f_c*u/(s + f_c)", f'[published."y/u"]\nexpr = "{expression}"{where}')
        (audit,) = audit_layer.audit(model.resolved)
        assert audit.verdict == "equal", expression


def test_a_frequency_of_a_model_block_means_the_same_outside(tmp_path):
    inner = LOW_PASS.format(expression="u/(1 + s/f_c)", sections="")
    (tmp_path / "inner.toml").write_text(inner, encoding="utf-8")
    outer = (
        'symflex = 1\ninputs = { u = {} }\noutputs = { y = "f_c*G*u/(s + f_c)" }\n'
        '[blocks]\nG = { type = "model", spec = "inner.toml", tf = "y/u" }\n'
    )
    (tmp_path / "outer.toml").write_text(outer, encoding="utf-8")
    model = symflex.load(tmp_path / "outer.toml")
    assert model.transfer_function("y", "u").bind()(POINT) == pytest.approx(low_pass(50) ** 2, rel=1e-12)
    assert [(p.name, p.value, p.unit) for p in model.parameters] == [("f_c", ExactValue(Fraction(50)), "Hz")]


def test_uses_that_could_be_read_either_way_are_told_at_the_first_with_their_number():
    model = loaded("s*v + u*f_c/9/s", '[signals]\nv = "u/(s + f_c)"')
    told = "'f_c', in 'Hz', is read in radians here and elsewhere (2 places): as 2*pi*f_c"
    assert readings(model) == [(7, "u*f_c/9/s", told)]


def test_a_table_of_modes_in_hertz_is_told_once_and_prints_the_two_pi_beside_each_frequency():
    # The modal sum of Ewins (Modal Testing, 2000), with 2*pi*f for every angular frequency.
    modes = " + ".join(f"a_{i}/(s^2 + 2*z_{i}*f_{i}*s + f_{i}^2)" for i in (1, 2, 3))
    values = ", ".join(f"f_{i} = '{i} Hz', a_{i} = '1 1/s^2', z_{i} = 0.0{i}" for i in (1, 2, 3))
    text = f"symflex = 1\nparameters = {{ {values} }}\nblocks = {{ G = '{modes}' }}\n"
    model = symflex.loads(text + "inputs = { u = {} }\noutputs = { y = 'G*u' }\n")
    told = "'f_1', 'f_2', 'f_3', in 'Hz', are read in radians here and elsewhere (6 places): as 2*pi*f_1"
    assert [message for _, _, message in readings(model)] == [told]
    terms = (f"a_{i}/(s^2 + 2*z_{i}*(2*pi*f_{i})*s + (2*pi*f_{i})^2)" for i in (1, 2, 3))
    shown = str(model.transfer_function("y", "u").form()).replace("\n", "").replace(" ", "")
    assert "+".join(terms).replace(" ", "") in shown


def test_a_time_is_read_in_cycles_and_told():
    lag = '[blocks]\nL = { type = "lead_lag", T_1 = "1/f_c", T_2 = "2 s" }'
    assert readings(loaded("L*u", lag)) == [
        (9, "1/f_c", "'f_c', in 'Hz', is read in cycles here: without 2*pi")
    ]


def test_what_the_expression_or_the_port_says_is_not_told():
    for expression, sections in [
        ("2*pi*f_c*u/(s + 2*pi*f_c)", ""),
        (
            "R*u",
            '[blocks]\nR = { type = "resonance", omega_p = "f_c", zeta_p = 0.1, '
            'omega_z = "3*f_c", zeta_z = 0.1 }',
        ),
    ]:
        assert readings(loaded(expression, sections)) == [], expression


def test_a_frequency_in_units_without_cycles_is_not_told():
    text = LOW_PASS.format(expression="f_c*u/(s + f_c)", sections="").replace("50 Hz", "50 1/s")
    assert symflex.loads(text).warnings == ()


def test_frequencies_that_are_compared_must_be_read_alike():
    text = LOW_PASS.format(
        expression="f_c/f_d*u/(s + f_c) + L*u",
        sections='[blocks]\nL = { type = "lead_lag", T_1 = "1/f_d", T_2 = "2 s" }',
    ).replace("[inputs]", 'f_d = "20 Hz"\n[inputs]')
    with pytest.raises(SpecError, match="SF204"):
        symflex.loads(text)


def test_a_pitch_in_an_expression_is_printed_with_the_two_pi_it_is_read_with():
    text = """symflex = 1
[parameters]
p = "5 mm/rev"
[elements]
rotor = { type = "inertia", at = "phi", J = "1 kg*m^2" }
[inputs]
T = { torque = "phi" }
[outputs]
x = "p*phi"
"""
    model = symflex.loads(text)
    assert str(model.transfer_function("x", "T").form("polynomial")) == "x/T = p/(2*pi*s^2)"
    assert [(p.value, p.unit) for p in model.parameters] == [(ExactValue(Fraction(5, 1000)), "m/rev")]


def test_a_frequency_in_a_definition_of_a_capacitance_is_told_as_at_the_port():
    for C, sections in [("1/(f_c*R)", ""), ("C", 'definitions = { C = "1/(f_c*R)" }')]:
        text = f"""symflex = 1
parameters = {{ f_c = "50 Hz", R = "1 Ohm" }}
{sections}
inputs  = {{ V = {{ voltage = "a" }} }}
outputs = {{ y = "b" }}
elements.r = {{ type = "resistor", between = ["a", "b"], R = "R" }}
elements.c = {{ type = "capacitor", between = ["b", "ground"], C = "{C}" }}
"""
        assert [message for *_, message in readings(symflex.loads(text))] == [
            "'f_c', in 'Hz', is read in radians here: as 2*pi*f_c"
        ], C
