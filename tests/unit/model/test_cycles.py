"""A name given in Hz counts cycles in every formula, and 2 pi stands beside it where radians are meant."""

import math
import re
from cmath import exp, pi, sqrt
from fractions import Fraction

import numpy as np
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


def conversions(model):
    """Return every conversion, with the value and unit that it is used with."""
    return [(p.name, float(p.value.nearly), p.unit) for p in model.resolved.conversions]


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
    assert conversions(again) == []


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


def test_a_pitch_that_a_model_block_brings_may_be_divided_by_its_2_pi_or_not(tmp_path):
    (tmp_path / "inner.toml").write_text(
        """symflex = 1
parameters = { p = "5 mm/rev" }
inputs = { T = { torque = "phi" } }
outputs = { X = "x" }
[elements]
rotor = { type = "inertia", at = "phi", J = "1 kg*m^2" }
screw = { type = "transformer", from = "phi", to = "x", ratio = "p" }
"""
    )
    (tmp_path / "outer.toml").write_text(
        'symflex = 1\ninputs = { T = { unit = "N*m" } }\noutputs = { Y = "p*G*T", Z = "p/(2*pi)*G*T" }\n'
        '[blocks]\nG = { type = "model", spec = "inner.toml", tf = "X/T" }\n'
    )
    model = symflex.load(tmp_path / "outer.toml")
    values = [model.transfer_function(y, "T").bind()(POINT) for y in ("Y", "Z")]
    assert values == pytest.approx([P**2 / POINT**2] * 2, rel=1e-12)


def test_a_table_of_modes_in_hertz_prints_the_two_pi_beside_each_frequency():
    # The modal sum of Ewins (Modal Testing, 2000), with 2*pi*f for every angular frequency.
    modes = " + ".join(f"a_{i}/(s^2 + 2*z_{i}*f_{i}*s + f_{i}^2)" for i in (1, 2, 3))
    values = ", ".join(f"f_{i} = '{i} Hz', a_{i} = '1 1/s^2', z_{i} = 0.0{i}" for i in (1, 2, 3))
    text = f"symflex = 1\nparameters = {{ {values} }}\nblocks = {{ G = '{modes}' }}\n"
    model = symflex.loads(text + "inputs = { u = {} }\noutputs = { y = 'G*u' }\n")
    assert [name for name, *_ in conversions(model)] == ["f_1", "f_2", "f_3"]
    terms = (f"a_{i}/(s^2 + 2*z_{i}*(2*pi*f_{i})*s + (2*pi*f_{i})^2)" for i in (1, 2, 3))
    shown = str(model.transfer_function("y", "u").form()).replace("\n", "").replace(" ", "")
    assert "+".join(terms).replace(" ", "") in shown


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


# What follows is compared with the reading of an engineer, written with angular frequencies.
W, G, N = 2 * pi * 50, 2 * pi * 20, 2 * pi * 50
P, A, LINE = 0.005 / (2 * pi), pi * 0.04**2 / 4, 7800 * 0.5
BLOCK = """symflex = 1
[parameters]
f = "50 Hz"
g = "20 Hz"
n = "3000 rpm"
p = "5 mm/rev"
w = "7 rad/s"
a = "3 1/s"
m = "2 kg"
d = "40 mm"
r = "20 mm"
l = "0.5 m"
rho = "7800 kg/m^3"
zeta = 0.05
i = 5
tau = 6.2832
K = "2 V/A"
R = "100 Ohm"
C = "2 uF"
k = "3 N/m"
[definitions]
T_s = "1/f"
A = "pi*d^2/4"
m_t = "rho*A*l"
c = "m*f"
f_N = "f/2"
w_N = "2*pi*f_N"
f_0 = "10 Hz"
two_pi = "2*pi"
[inputs]
u = {{}}
[outputs]
y = "G*u"
[blocks]
G = "{}"
"""
SPELLINGS = {
    # A frequency is converted, as often as it stands there.
    "f": W, "-f": -W, "f^2": W**2, "m*f": 2 * W, "w*f": 7 * W, "sqrt(f)": sqrt(W),
    "s + f": POINT + W, "m*(f + g)": 2 * (W + G), "sqrt(f^2 + g^2)": sqrt(W**2 + G**2), "n*m": 2 * N,
    "f_0": 20 * pi, "2*pi*f_0": 20 * pi,
    "f^2/(s^2 + 2*zeta*f*s + f^2)": W**2 / (POINT**2 + 0.1 * W * POINT + W**2),
    # It is not where its 2 pi stands in the same product, in any order, once for each power.
    "2*pi*f": W, "pi*f*2": W, "f*2*pi": W, "2*f*pi": W, "m*2*pi*f": 2 * W, "2*pi*m*f": 2 * W,
    "4*pi*zeta*m*f": 0.2 * W, "(2*pi*f)^2": W**2, "4*pi^2*f^2": W**2, "4*pi^2*m*f^2": 2 * W**2,
    "(2*pi)^2*f^2": W**2, "m*(2*pi*f)^2": 2 * W**2, "pi^2*4*f^2": W**2, "2*pi*f*2*pi*g": W * G,
    "two_pi*f": W, "m*f*two_pi": 2 * W, "sqrt(2*pi*f)": sqrt(W),
    "2*pi*(f + g)": W + G, "2*pi*(f + 3*g)": W + 3 * G, "2*pi*f + g": W + G,
    "2*pi*f*(s + g)": W * (POINT + G), "2*pi*f/(s + f)": W / (POINT + W),
    # A pi of geometry is not one of these, in its definition or beside a pair.
    "m_t*n^2": LINE * A * N**2, "A*n": A * N, "m_t*(2*pi*n)^2": LINE * A * N**2,
    "rho*pi*d^2/4*l*(2*pi*n)^2": LINE * A * N**2, "rho*pi*d^2/4*l*2*pi*n": LINE * A * N,
    "pi*d*(2*pi*n)": pi * 0.04 * N, "pi*d/(s + f)": pi * 0.04 / (POINT + W),
    "A*(1 + s/f)": A * (1 + POINT / W), "pi*d^2/4*(1 + s/f)": A * (1 + POINT / W),
    # What is divided by it: 1/f is a period, s/f compares with an angular frequency.
    "1/f": 1 / 50, "3/f": 3 / 50, "f^-1": 1 / 50, "1/(2*f)": 1 / 100, "1/2/f": 1 / 100, "(1/f)^2": 1 / 2500,
    "T_s": 1 / 50, "3*T_s*s": 3 * POINT / 50, "(1/f)*s": POINT / 50, "2*s*f^-1": 2 * POINT / 50,
    "K*(1/f)": 2 / 50, "s/f": POINT / W, "0.4*s/f": 0.4 * POINT / W, "(s/f)^2": (POINT / W) ** 2,
    "s^2/f^2": (POINT / W) ** 2, "s/(2*pi*f)": POINT / W, "1/(2*pi*f)": 1 / W, "1/2/pi/f": 1 / W,
    "1/(2*pi*f*R)": 1 / (100 * W), "1/(2*pi*R*f*C)": 1 / (2e-4 * W), "1/(f*R)": 1 / (100 * W),
    "1/f/R": 1 / (100 * W), "k/f^2": 3 / W**2, "k/(2*pi*f)^2": 3 / W**2, "1/(f^2*m)": 1 / (2 * W**2),
    "w/f": 7 / W, "f/w": W / 7, "exp(-1.5*s/f)": exp(-1.5 * POINT / 50), "exp(-s*T_s)": exp(-POINT / 50),
    # A frequency over another is the same number in cycles and in radians.
    "f/g": 2.5, "1 - (f/g)^2": -5.25, "n/f": 1, "pi*f/g": 2.5 * pi, "2*pi*f/g": 5 * pi,
    "p*s": P * POINT, "p/(2*pi)*s": P * POINT, "p*n": 0.25,
    # Definitions through definitions.
    "c*s": 2 * W * POINT, "s + f_N": POINT + W / 2, "s + 2*pi*f_N": POINT + W / 2, "w_N": W / 2,
    "1/f_N": 1 / 25, "s/w_N": 2 * POINT / W,
}  # fmt: skip
TWO_READINGS = [
    "pi*d*n", "n*pi*d", "rho*pi*d^2/4*l*n^2", "2*pi*r*l*n", "2*r*pi*n", "m/(2*pi*r*n)", "d^2*pi/4*2*n",
    "pi*f", "pi*f/2", "i*pi*f", "sqrt(pi*f)", "f/(2*pi)", "2*pi*f^2", "2*pi*f*g", "pi*(f + g)", "2*pi/f",
    "pi/f", "1/(pi*f*m)", "2*pi*p", "K/f", "K/f*m", "zeta/f", "1/(i*f)", "1/f^2", "f*T_s", "2*pi*f/n",
    "2*pi*(f + a)", "2*pi*c", "6.2832*f", "6.28*f", "3.14159*2*f", "tau*f", "2*pi*n/60", "n/60", "pi*n/30",
    "60/n",
]  # fmt: skip


def test_every_spelling_of_a_product_has_the_right_reading():
    wrong = {}
    for written, right in SPELLINGS.items():
        value = symflex.loads(BLOCK.format(written)).transfer_function("y", "u").bind()(POINT)
        if value != pytest.approx(right, rel=1e-12):
            wrong[written] = value
    assert wrong == {}


def test_a_product_with_two_readings_is_refused_with_both():
    for written in TWO_READINGS:
        with pytest.raises(SpecError, match="SF204") as caught:
            symflex.loads(BLOCK.format(written))
        assert {d.code for d in caught.value.diagnostics} == {"SF204"}, written
    with pytest.raises(SpecError, match=r"in cycles, or 'rho\*pi\*d\^2/4\*l\*\(2\*pi\*n\)\^2'"):
        symflex.loads(BLOCK.format("rho*pi*d^2/4*l*n^2"))


def test_a_parameter_is_read_by_use():
    both = "U*f_c/(s + f_c) + U*2*pi*f_c/(s + 2*pi*f_c)".replace("U", "u")
    assert loaded(both).transfer_function("y", "u").bind()(POINT) == pytest.approx(
        2 * low_pass(50), rel=1e-12
    )


def test_without_any_metre_what_has_no_unit_may_be_a_length():
    text = 'symflex = 1\nparameters = { r = 0.02, mu = 3, n = "60 rpm" }\ninputs.u = {}\n'
    with pytest.raises(SpecError, match="SF204"):
        symflex.loads(text + 'outputs.y = "2*pi*r*mu*n*u"\n')


def test_the_2_pi_of_a_pitch_may_stand_behind_it_beside_a_length():
    values = [
        symflex.loads(BLOCK.format(written)).transfer_function("y", "u").bind()(POINT)
        for written in ("p/(2*pi)*l*s", "p*l*s")
    ]
    assert values == pytest.approx([0.5 * P * POINT] * 2, rel=1e-12)


TUBE = """symflex = 1
[parameters]
rho = "7800 kg/m^3"
E = "70 GPa"
d = "40 mm"
l = "0.5 m"
k = "200 kN/m"
f_0 = "11 Hz"
Omega = "600 rpm"
[definitions]
A = "pi*d^2/4"
m = "rho*A*l"
c = "2*0.05*m*f_0"
softer = "k - m*Omega^2"
[outputs]
X = "x"
[inputs]
F = """
# m (s^2 - Omega^2) x + c s x + k x = F, with everything in rad/s.
MASS = LINE * A
STIFFNESS = MASS * (POINT**2 - (20 * pi) ** 2) + 0.1 * MASS * 22 * pi * POINT + 2e5
BODY = """{ force = "x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
"""
PLACES = {
    "elements": f"""{BODY}
wall = {{ type = "spring", between = ["x", "ground"], k = "k" }}
loss = {{ type = "damper", between = ["x", "ground"], b = "c" }}
turn = {{ type = "force_source", at = "x", f = "m*Omega^2*x" }}""",
    "definitions": f"""{BODY}
wall = {{ type = "force_source", at = "x", f = "-softer*x" }}
loss = {{ type = "damper", between = ["x", "ground"], b = "2*0.05*m*f_0" }}""",
    "equations": """{ unit = "N" }
[equations]
unknowns = ["x"]
equations = ["m*s^2*x + 2*0.05*m*f_0*s*x + (k - m*Omega^2)*x = F"]""",
    "an energy": """{ unit = "N" }
[energy]
coordinates = ["x"]
kinetic = "m*(x'^2 + (Omega*x)^2)/2"
potential = "k*x^2/2"
dissipation = "c*x'^2/2"
forces = { x = "F" }""",
    "an operating point": """{ unit = "N" }
[equations]
unknowns = ["x", "theta"]
equations = ["m*x'' + c*x' + k*x - m*x*theta'^2 = F", "theta' = v"]
[operating_point]
x = 0
"theta'" = "Omega"
v = "Omega"
F = 0
[inputs.v]
unit = "rad/s" """,
    "a signal": """{ unit = "N" }
[signals]
x = "F/(m*(s^2 - (2*pi*Omega)^2) + c*s + k)" """,
    "a block": """{ unit = "N" }
[blocks]
G = { type = "tf", num = [1], den = ["m", "c", "k - m*Omega^2"] }
[signals]
x = "G*F" """,
}


def test_the_rule_is_the_same_in_every_place():
    wrong = {}
    for place, text in PLACES.items():
        value = symflex.loads(TUBE + text).transfer_function("X", "F").bind()(POINT)
        if value != pytest.approx(1 / STIFFNESS, rel=1e-12):
            wrong[place] = value * STIFFNESS
    assert wrong == {}


def test_the_rule_is_the_same_in_a_field():
    text = (
        TUBE.replace('X = "x"', 'X = "w(l)"')
        + """{ unit = "N" }
[fields.w]
domain = ["0", "l"]
equation = "E*A*w'' + rho*A*Omega^2*w = rho*A*s^2*w"
conditions = ["w(0) = 0", "E*A*w'(l) = F"]"""
    )
    q = sqrt(7800 * (POINT**2 - (20 * pi) ** 2) / 70e9)
    right = (exp(q) - 1) / (exp(q) + 1) / (70e9 * A * q)  # tanh(q l)/(E A q), l = 1/2
    value = symflex.loads(text).transfer_function("X", "F").bind()(POINT)
    assert value == pytest.approx(right, rel=1e-12)


def test_a_pi_in_the_formula_of_a_load_is_refused_there_too():
    for place, text in PLACES.items():
        inline = text.replace("m*Omega^2", "rho*pi*d^2/4*l*Omega^2")
        if inline != text:
            with pytest.raises(SpecError, match="SF204"):
                symflex.loads(TUBE + inline)
                raise AssertionError(place)


DISC = """symflex = 1
parameters = { rho = "7800 kg/m^3", h = "20 mm", D = "200 mm", k = "500 N*m/rad", Omega = "6000 rpm" }
inputs = { T = { torque = "a" } }
outputs = { A = "a" }
[definitions]
J_p = "rho*pi*h*D^4/32"
J_d = "J_p/2"
[elements]
ja = { type = "inertia", at = "a", J = "J_d" }
jb = { type = "inertia", at = "b", J = "J_d" }
ka = { type = "torsion_spring", between = ["a", "ground"], k = "k" }
kb = { type = "torsion_spring", between = ["b", "ground"], k = "k" }
ga = { type = "torque_source", at = "a", tau = "-J_p*Omega*s*b" }
gb = { type = "torque_source", at = "b", tau = "J_p*Omega*s*a" }
"""
ROTOR = """symflex = 1
parameters.Omega = { value = "3000 rpm", assume = "nonnegative" }
parameters.m = "3 kg"
parameters.k = "9 kN/m"
parameters.eta = "2e5 N*s/m^4"
parameters.d = "20 mm"
parameters.l = "0.4 m"
parameters.c_e = "30 N*s/m"
inputs = { F = { unit = "N" } }
outputs = { X = "x" }
[definitions]
c_i = "eta*pi*d^2/4*l/0.001"
[equations]
unknowns = ["x", "y"]
equations = [
    "m*s^2*x + (c_e + c_i)*s*x + k*x + c_i*Omega*y = F",
    "m*s^2*y + (c_e + c_i)*s*y + k*y - c_i*Omega*x = 0",
]
"""


def test_a_gyroscopic_disc_whose_inertia_contains_pi_turns_in_radians():
    inertia = 7800 * math.pi * 0.02 * 0.2**4 / 32
    # J_d s^2 + k on both axes, J_p Omega s between them: |..|^2 with Omega = 200 pi rad/s.
    square = np.polymul([inertia / 2, 0, 500], [inertia / 2, 0, 500])
    right = np.roots(np.polyadd(square, [(inertia * 200 * math.pi) ** 2, 0, 0]))
    model = symflex.loads(DISC)
    poles = [complex(root.re, root.im) for root in model.transfer_function("A", "T").bind().poles()]
    assert sorted(map(abs, poles)) == pytest.approx(sorted(map(abs, right)), rel=1e-9)
    assert conversions(model) == [("Omega", pytest.approx(200 * math.pi), "rad/s")]


def test_a_rotor_in_rpm_is_answered_in_rpm():
    # Internal damping is unstable above sqrt(k/m) (1 + c_e/c_i): D. M. Smith, Proc. R. Soc. A 142 (1933).
    c_i = 2e5 * math.pi * 0.02**2 / 4 * 0.4 / 0.001
    limit = math.sqrt(9000 / 3) * (1 + 30 / c_i)  # rad/s
    model = symflex.loads(ROTOR)
    stability = model.stability("Omega")
    ((_, high),) = stability.stable
    assert float(high) == pytest.approx(limit / (2 * math.pi), rel=1e-9)
    assert not stability.is_stable
    text = str(stability)
    assert "Omega [rpm]" in text
    assert "Omega = 3000: unstable" in text
    (shown,) = re.findall(r"0 < Omega < ([\d.]+)", text)
    assert float(shown) == pytest.approx(limit * 30 / math.pi, rel=1e-12)
