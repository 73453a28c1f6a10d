"""The forms print what a person would write."""

import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.errors import ModelError, SpecError, Text, UncertifiedError
from symflex.expressions import Sum, format_expression, nodes, parse, quotient
from symflex.print.forms import hidden_expressions, print_form, print_forms
from symflex.print.forms.printed import RATIONAL, PrintedForm
from symflex.print.forms.shapes import SumSigns
from symflex.print.json_format import derive_json
from symflex.print.text import derive_text
from tests.contract.exact import Point, read, value_of

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "derivations" / "eppinger1988"

TWO_MASS = """symflex = 1
parameters = { m_1 = {}, m_2 = {}, k = {}, b = {} }
[elements]
M_1 = { type = "mass", at = "x", m = "m_1" }
M_2 = { type = "mass", at = "y", m = "m_2" }
K = { type = "spring", between = ["x", "y"], k = "k" }
B = { type = "damper", between = ["x", "y"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
Y = "y"
"""
SPRING = 'K = { type = "spring", between = ["x", "y"], k = "k" }\n'
DAMPER = 'B = { type = "damper", between = ["x", "y"], b = "b" }\n'


def with_definitions(text):
    return TWO_MASS.replace("[elements]", f"[definitions]\n{text}\n[elements]")


def one_spring(definitions, k):
    """Return the compliance of one spring."""
    text = f"""symflex = 1
parameters = {{ m = {{}}, b = {{}}, k = {{}}, q = {{}}, k_2 = {{}} }}
definitions = {{ {definitions} }}
elements.part = {{ type = "spring", between = ["x", "ground"], k = "{k}" }}
inputs.F = {{ force = "x" }}
outputs.X = "x"
"""
    return tf_of(text, "X", "F")


def tf_of(text, output, source):
    return pipeline.derive(pipeline.assemble(pipeline.loads(text)), output, source)


def printed(tf, form=None, digits=6):
    found = print_form(tf, form, digits)
    return format_expression(found.num), format_expression(found.den)


def test_the_rigid_body_prints_as_the_paper_does():
    model = pipeline.load(FOLDER / "rigid_body.toml")
    tf = pipeline.derive(pipeline.assemble(model), "V_tip", "V_cmd")
    assert printed(tf) == (
        "k_amp*k_preamp*r*k_tau",
        "r^2*(m_eff*s + b_eff)*(L*s + R + k_amp*k_current) + k_tau*(k_amp*k_preamp*k_tach + k_bemf)",
    )


def test_the_polynomial_form_has_descending_powers_and_parameters_in_declared_order():
    assert printed(tf_of(TWO_MASS, "X", "F"), "polynomial") == (
        "m_2*s^2 + b*s + k",
        "m_1*m_2*s^4 + b*(m_1 + m_2)*s^3 + k*(m_1 + m_2)*s^2",
    )


def test_the_factored_form_takes_the_rigid_body_mode_out():
    assert printed(tf_of(TWO_MASS, "Y", "F"), "factored") == (
        "b*s + k",
        "s^2*(m_1*m_2*s^2 + b*(m_1 + m_2)*s + k*(m_1 + m_2))",
    )


def test_the_monic_form_s_denominator_begins_with_a_bare_power_of_s():
    num, den = printed(tf_of(TWO_MASS, "Y", "F"), "monic")
    assert den.startswith("s^4 + ")
    assert num == "b/(m_1*m_2)*s + k/(m_1*m_2)"


def test_a_zero_function_prints_as_zero_over_one():
    text = TWO_MASS.replace(SPRING, "").replace(DAMPER, "")
    tf = tf_of(text.replace("m_1 = {}", "m_1 = 1").replace("m_2 = {}", "m_2 = 1"), "Y", "F")
    assert {printed(tf, form) for form in RATIONAL} == {("0", "1")}


def test_a_definition_is_used_where_it_shortens_and_stands_in_the_where_list():
    text = with_definitions('Z = "b*s + k"\nunused = "m_1 + m_2"')
    form = print_form(tf_of(text, "Y", "F"), "definitions")
    assert format_expression(form.num) == "Z"
    assert [(n, format_expression(e)) for n, e in form.where if n == "Z"] == [("Z", "b*s + k")]


def test_a_where_list_brings_the_definitions_of_its_definitions_in_dependency_order():
    form = print_form(one_spring('Z = "m*s^2 + Y", Y = "b*s + k"', "Z"), "definitions")
    assert (format_expression(form.num), format_expression(form.den)) == ("1", "Z")
    assert [n for n, _ in form.where] == ["Y", "Z"]


CLOSED = {
    "polynomial": "mu*s^4 + M*b*s^3 + M*k*s^2",
    "monic": "s^4 + M*b/mu*s^3 + M*k/mu*s^2",
    "constant": "mu/(M*k)*s^4 + b/k*s^3 + s^2",
    "factored": "s^2*(mu*s^2 + M*b*s + M*k)",
    "frequency": "omega^2*(mu*omega^2 - M*k - j*M*b*omega)",
}


def test_definitions_stay_closed_in_every_form_of_two_masses():
    # s^2 (m_1 m_2 s^2 + (m_1 + m_2)(b s + k)), by hand; factors of a product may stand in any order.
    tf = tf_of(with_definitions('M = "m_1 + m_2"\nmu = "m_1*m_2"'), "Y", "F")
    for name, expected in CLOSED.items():
        form = print_form(tf, name)
        assert format_expression(form.den).replace("k*M", "M*k").replace("b*M", "M*b") == expected
        assert {"M", "mu"} <= {n for n, _ in form.where}


ABSORBER = """
symflex = 1
parameters  = { M = {}, K = {}, mu = {}, zeta = {} }
definitions = { m = "mu*M", w = "sqrt(K/M)/(1 + mu)", k = "m*w^2", c = "2*zeta*m*w" }
inputs.F    = { force = "x" }
outputs.X   = "x"
[elements]
house    = { type = "mass", at = "x", m = "M" }
absorber = { type = "mass", at = "y", m = "m" }
ground   = { type = "spring", between = ["x", "ground"], k = "K" }
spring   = { type = "spring", between = ["x", "y"], k = "k" }
damper   = { type = "damper", between = ["x", "y"], b = "c" }
"""


def test_a_tuned_absorber_prints_in_its_own_mass_spring_and_damper():
    # Den Hartog 1934, section 3.3: opened, it is a page of mu and roots of K and M.
    assert printed(tf_of(ABSORBER, "X", "F")) == (
        "m*s^2 + c*s + k",
        "(M*s^2 + K)*(m*s^2 + c*s + k) + m*s^2*(c*s + k)",
    )


def test_what_cancels_only_where_definitions_are_opened_is_cancelled():
    text = """
symflex = 1
parameters  = { R = {}, C = {} }
definitions = { T_1 = "R*C", T_2 = "C*R" }
inputs.u    = {}
outputs.y   = "u*(T_1*s + 1)/((T_2*s + 1)*(T_1*s + 2))"
"""
    assert printed(tf_of(text, "y", "u")) == ("1", "T_1*s + 2")


def test_a_factor_that_is_a_definition_with_s_bears_its_name():
    form = print_form(tf_of(with_definitions('Z = "b*s + k"'), "Y", "F"), "factored")
    assert format_expression(form.num) == "Z"


def test_a_definition_that_shortens_one_coefficient_only_is_used_there():
    form = print_form(tf_of(with_definitions('M = "m_1 + m_2"'), "Y", "F"), "definitions")
    assert format_expression(form.den).replace("*M", "").count("M") == 0
    assert "m_1*m_2*s^2" in format_expression(form.den)


def test_a_reciprocal_definition_is_not_lost():
    """k_2 + k/q: a definition 1/q once counted as zero there."""
    tf = one_spring('c = "1/q"', "c*k + k_2")
    at = Point(3)
    for name in ("polynomial", "monic", "factored", "definitions"):
        form = print_form(tf, name)
        for n, e in form.where:
            at.values[n] = value_of(e, at)
        assert value_of(form.num, at) / value_of(form.den, at) == 1 / (at["k"] / at["q"] + at["k_2"])


NUMERIC = TWO_MASS.replace(
    "m_1 = {}, m_2 = {}, k = {}, b = {}", 'm_1 = "2 kg", m_2 = "3 kg", k = "8 N/m", b = "1 N*s/m"'
)


def test_zpk_prints_gain_and_real_quadratic_factors():
    # X/F = (3 s^2 + s + 8)/(s^2 (6 s^2 + 5 s + 40)): 1/2 (s^2 + s/3 + 8/3)/(s^2 (s^2 + 5/6 s + 20/3)).
    num, den = printed(tf_of(NUMERIC, "X", "F"), "zpk", 4)
    assert num == "0.5*(s^2 + 0.3333*s + 2.667)"
    assert den == "s^2*(s^2 + 0.8333*s + 6.667)"


def test_zpk_prints_as_many_digits_as_asked_for():
    tf = tf_of(NUMERIC, "X", "F")
    for digits in (1, 3, 17, 30):
        _, den = printed(tf, "zpk", digits)
        constant = den.removesuffix(")").rpartition(" + ")[2]
        assert abs(Fraction(constant) - Fraction(20, 3)) <= Fraction(1, 2 * 10 ** (digits - 1))
        assert len(constant.replace(".", "")) == digits


def test_zpk_prints_every_digit_of_real_roots():
    # s^2 + 3 s + 1: (3 -+ sqrt(5))/2.
    tf = tf_of('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s^2 + 3*s + 1)"', "y", "u")
    num, den = printed(tf, "zpk", 40)
    roots = ("0.3819660112501051517954131656343618822797", "2.61803398874989484820458683436563811772")
    assert (num, den) == ("1", f"(s + {roots[0]})*(s + {roots[1]})")


def test_zpk_needs_every_value():
    with pytest.raises(ModelError) as caught:
        print_form(tf_of(TWO_MASS, "X", "F"), "zpk")
    assert caught.value.diagnostics[0].code == "SF229"


def test_zpk_lists_roots_with_their_multiplicity_or_refuses():
    text = """symflex = 1
parameters = { w = "1 rad/s" }
inputs = { u = {} }
outputs = { y = "w^2*u/(s^2 + 2*sqrt(2)*w*s + 2*w^2)", z = "w^2*u/(s^2 + 2*exp(1)*w*s + exp(2)*w^2)" }
"""
    assert printed(tf_of(text, "y", "u"), "zpk", 6) == ("1", "(s + 1.41421)^2")
    # e^2 is exp(2), and exp(1) twice: that relation is not known.
    with pytest.raises(UncertifiedError, match="could not be separated") as caught:
        print_form(tf_of(text, "z", "u"), "zpk")
    assert caught.value.diagnostics[0].code == "SF404"


CRITICAL = """symflex = 1
parameters = { m = "2 kg", k = "700 N/m" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "2*sqrt(k*m)" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def test_critical_damping_is_a_square():
    assert printed(tf_of(CRITICAL, "X", "F"), "factored") == ("m", "(m*s + sqrt(k*m))^2")
    assert printed(tf_of(CRITICAL, "X", "F"), "polynomial") == ("1", "m*s^2 + 2*sqrt(k*m)*s + k")
    split = CRITICAL.replace("sqrt(k*m)", "sqrt(k)*sqrt(m)")
    assert printed(tf_of(split, "X", "F"), "factored") == ("1", "(sqrt(m)*s + sqrt(k))^2")
    by_frequency = CRITICAL.replace("2*sqrt(k*m)", "2*m*w_n").replace(
        "[elements]", '[definitions]\nw_n = "sqrt(k/m)"\n[elements]'
    )
    assert printed(tf_of(by_frequency, "X", "F"), "factored") == ("1", "m*(s + w_n)^2")


def test_the_square_of_a_root_is_what_is_under_it():
    text = """symflex = 1
parameters = { K_m = "0.05 N*m/W^(1/2)", R = "2 Ohm", J = "1e-4 kg*m^2", L = "1 mH" }
[elements]
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "p", R = "R", L = "L", k_t = "K_m*sqrt(R)" }
rotor = { type = "inertia", at = "p", J = "J" }
[inputs]
V = { voltage = "v" }
[outputs]
W = "s*p"
"""
    found = printed(tf_of(text, "W", "V"), "definitions")
    assert found == ("K_m*sqrt(R)", "J*L*s^2 + R*J*s + K_m^2*R")


def test_an_undamped_pair_has_no_term_in_s():
    text = NUMERIC.replace(DAMPER, "")
    # Without b: (3 s^2 + 8)/(s^2 (6 s^2 + 40)), and 40/6 = 6.667.
    assert printed(tf_of(text, "X", "F"), "zpk", 4) == ("0.5*(s^2 + 2.667)", "s^2*(s^2 + 6.667)")


def test_what_cancelled_prints_by_descending_powers():
    text = TWO_MASS.replace('between = ["x", "y"]', 'between = ["y", "ground"]')
    tf = tf_of(text, "X", "F")
    assert [(format_expression(e), m) for e, m in hidden_expressions(tf)] == [("m_2*s^2 + b*s + k", 1)]


def test_a_factor_that_waits_is_listed_also_where_the_function_does_not_wait():
    text = """symflex = 1
parameters.T = "1 s"
inputs.r = {}
outputs.Y = "y"
signals.y = "(1 - 2*exp(-s*T))/(s + 1)*u"
signals.u = "(r - y)/(1 - 2*exp(-s*T))"
"""
    tf = tf_of(text, "Y", "r")
    ((factor, times),) = hidden_expressions(tf)
    assert (format_expression(factor), times) == ("2*exp(-T*s) - 1", 1)
    assert "hidden: 2*exp(-T*s) - 1 cancelled" in derive_text([(tf, print_form(tf))])


def test_pi_stands_before_the_parameters():
    text = TWO_MASS.replace('k = "k" }', 'k = "k*pi^2*m_1" }')
    num, _ = printed(tf_of(text, "Y", "F"), "polynomial")
    assert num == "b*s + pi^2*k*m_1"


def test_a_function_of_constants_prints_as_it_was_written():
    text = TWO_MASS.replace('k = "k" }', 'k = "sqrt(k*m_1)" }')
    num, _ = printed(tf_of(text, "Y", "F"), "polynomial")
    assert num == "b*s + sqrt(k*m_1)"


PROGRAM = """
from symflex import pipeline
from symflex.print.forms import print_form
from symflex.print.forms.printed import forms_of
from symflex.expressions import format_expression
for stem in ("lumped_bending_beam", "sliding_free_beam"):
    for tf in pipeline.derive_all(pipeline.load(f"derivations/eppinger1988/{stem}.toml")):
        for name in (*forms_of(tf), None):
            form = print_form(tf, name)
            print(*(format_expression(e) for e in (form.num, form.den)), form.where)
"""


@pytest.mark.slow
def test_the_forms_do_not_depend_on_the_hash_seed():
    seen = {
        subprocess.run(
            [sys.executable, "-c", PROGRAM],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
            cwd=ROOT,
            capture_output=True,
            check=True,
            text=True,
        ).stdout
        for seed in ("0", "1")
    }
    assert len(seen) == 1


def test_a_long_print_is_read_back():
    (tf, *_) = pipeline.derive_all(pipeline.load(FOLDER / "six_mass.toml"))
    form = print_form(tf)
    assert read(format_expression(form.den)) == form.den


def test_a_form_that_lists_poles_says_what_a_hidden_one_makes_of_stability():
    text = 'symflex = 1\ninputs.u = {}\nsignals.x = "u/(s - 3)"\noutputs.y = "(s - 3)*x/(s + 1)"'
    tf = tf_of(text, "y", "u")
    form = print_form(tf, "zpk")
    assert derive_text([(tf, form)]).splitlines()[0].endswith("; unstable: 1 pole in the right half-plane")
    assert derive_json(tf, form)["stability"]["right_half_plane"] == 1


def test_zpk_writes_a_gain_of_more_digits_than_python_does():
    text = 'symflex = 1\nparameters.a = 1e200\ninputs.u = {}\noutputs.y = "a^23*u/(s + 1)"'
    num, _ = printed(tf_of(text, "y", "u"), "zpk", 4)
    assert num == "1" + 4600 * "0"


def test_a_power_of_a_block_of_many_poles_is_not_nested_level_by_level():
    # (s + a)^900 has 901 terms, each of which would be nested in the one before.
    text = """symflex = 1
parameters = { a = "3 1/s" }
blocks.G = { type = "tf", num = "1", den = "(s + a)^30" }
signals.u = "G^30*r"
inputs.r = {}
outputs.U = "u"
"""
    assert printed(tf_of(text, "U", "r"), "definitions") == ("1", "(s + a)^900")


def shaped(parameters, output, more=""):
    """Return the print of one output of a free input u."""
    text = f"""symflex = 1
parameters = {{ {parameters} }}
inputs.u = {{}}
outputs.y = "{output}"
{more}"""
    made = print_form(tf_of(text, "y", "u"))
    return format_expression(quotient(made.num, made.den))


SHAPES = {
    "a difference is positive at the declared values": ("k = 0.7, R = 2", "u/(R*s*(1 - k^2) + 1)",
                                                        "1/(R*(1 - k^2)*s + 1)"),
    "a difference stays as it is written": ("k = {}, R = {}", "u/(R*s*(1 - k^2) + 1)",
                                            "1/(R*(1 - k^2)*s + 1)"),
    "also where the declared values make it negative": ("k = 0.7, R = 2", "u/(s + (k^2 - 1)*R)",
                                                        "1/(s + R*(k^2 - 1))"),
    "what was factored is as it was written": ("nu = 0.3, a = 1", "(1 - nu^2)*a*u/(s + a)",
                                               "a*(1 - nu^2)/(s + a)"),
    "a zero on the right": ("T = 2", "(1 - T*s)*u/(1 + T*s)", "(1 - T*s)/(T*s + 1)"),
    "decimals as typed": ("", "u/(s^2 + 0.9*s + 1)", "1/(s^2 + 0.9*s + 1)"),
    "a time constant beside a decimal gain": ("", "0.1*5*u/(5*s + 1)", "0.5/(5*s + 1)"),
    "no decimals where none are typed": ("K = {}", "K*u/(10*s^2 + 9*s + 10)", "K/(10*s^2 + 9*s + 10)"),
    # Ogata, Modern Control Engineering, a conditionally stable loop; and a lag with delay.
    "what a gain multiplies follows the plant": (
        "K = {}", "K*(s^2 + 2*s + 4)*u/(s^4 + 11*s^3 + 24*s + K*(s^2 + 2*s + 4))",
        "K*(s^2 + 2*s + 4)/(s^4 + 11*s^3 + 24*s + K*(s^2 + 2*s + 4))"),
    "a resonance given in hertz, by powers of s": (
        "zeta = 0.1, f = '5 Hz'", "u/(s^2 + 2*zeta*f*s + f^2)", "1/(s^2 + 2*zeta*(2*pi*f)*s + (2*pi*f)^2)"),
    # 1/s^2 - 0.6/D = (D - 0.6*s^2)/(s^2*D), D = s^2 + 2*z*w*s + w^2, w = 2*pi*f: 0.4 of s^2 is left.
    "pi in front of brackets goes to the frequencies in hertz": (
        "K = {}, z = 0.1, f = '5 Hz', f_l = '8 Hz'",
        "K*(1/s^2 - 0.6/(s^2 + 2*z*f*s + f^2))*f_l/(s + f_l)*exp(-0.01*s)*u",
        "2*pi*K*f_l*(0.4*s^2 + 2*z*(2*pi*f)*s + (2*pi*f)^2)*exp(-s/100)"
        "/(s^2*(s^2 + 2*z*(2*pi*f)*s + (2*pi*f)^2)*(s + 2*pi*f_l))"),
    "a notch of typed damping": (
        "f = '60 Hz'", "(s^2 + 2*0.05*f*s + f^2)*u/(s^2 + 2*0.5*f*s + f^2)",
        "(s^2 + 0.2*pi*f*s + (2*pi*f)^2)/(s^2 + 2*pi*f*s + (2*pi*f)^2)"),
    # Sallen & Key 1955, with unity gain.
    "a filter of second order, by powers of s": (
        "R_1 = {}, R_2 = {}, C_1 = {}, C_2 = {}", "u/(C_2*s*(R_1*(R_2*C_1*s + 1) + R_2) + 1)",
        "1/(R_1*R_2*C_1*C_2*s^2 + C_2*(R_1 + R_2)*s + 1)"),
    "a loop of typed decimals begins with s^2": (
        "", "(0.2*s + 2)*u/((s^2 + 0.6*s + 4) + (0.2*s + 2))", "(0.2*s + 2)/(s^2 + 0.8*s + 6)"),
    "a minus sign stands in front of all terms": (
        "a = {}", "-2*(a*s + 0.25)*u/(s^2 + 0.1*s + 1)", "-(2*a*s + 0.5)/(s^2 + 0.1*s + 1)"),
    "two terms with a minus of three": (
        "a = 1, b = 2, c = 3", "u/(s^2 - a*s + b*s + c*s + 1)", "1/(s^2 + (b + c - a)*s + 1)"),
    # A Sallen-Key filter of equal parts, as in Franco, Design with Operational Amplifiers.
    "a difference of unknown sign is added": (
        "R = {}, C = {}, A = {}", "A*u/(R^2*C^2*s^2 - A*R*C*s + 3*R*C*s + 1)",
        "A/(R^2*C^2*s^2 + R*C*(3 - A)*s + 1)"),
    "what is added stands before what is subtracted": (
        "K = {}, m = {}, k = {}, Omega = {}", "u/(m*s^2 - m*Omega^2 + k)", "1/(m*s^2 + k - m*Omega^2)"),
    "a positive feedback": ("K = {}", "u/(s - K + 1)", "1/(s + 1 - K)"),
    "powers of a symbol fall": ("K = {}", "u/(s^2 + 3*K^4 - K^2 + 5)", "1/(s^2 + 3*K^4 - K^2 + 5)"),
    "products keep the order in which they are typed": (
        "m = {}, l = {}, J = {}, g = {}, n = {}", "u/((J + n^2*J + m*l^2)*s^2 + m*g*l)",
        "1/((J + n^2*J + m*l^2)*s^2 + m*g*l)"),
    "a damping ratio stands before its frequency": (
        "omega = {}, zeta = {}", "u/(s^2 + omega*(2*zeta*s + omega))", "1/(s^2 + 2*zeta*omega*s + omega^2)"),
    "large round numbers": ("", "1e9*u/(s^2 + 14000*s + 1e8)", "1e9/(s^2 + 14000*s + 1e8)"),
    # Nise, Control Systems Engineering, the antenna: 0.318*120*100*2.083*0.1 = 794.8728.
    "a loop of typed decimals leads with one power of s": (
        "", "794.8728*u/(s*(s + 100)*(s + 1.71) + 0.318*120*100*2.083*0.1)",
        "794.8728/(s^3 + 101.71*s^2 + 171*s + 794.8728)"),
    "what a loop gain is added to stays factored": (
        "a = {}, b = {}, K = {}", "K*u/(s^3 + (a + b)*s^2 + a*b*s + K)", "K/(s*(s + a)*(s + b) + K)"),
    # A crane with a PD controller behind a filter: s^2 (M l s^2 + (M + m) g) (tau s + 1) and the controller
    # times l s^2 + g, as one closes the loop by hand.
    "what several gains multiply stays factored": (
        "K = {}, B = {}, tau = {}, M = {}, m = {}, l = {}, g = {}",
        "u/((tau*s + 1)*s^2*(M*(l*s^2 + g) + m*g) + (K*(tau*s + 1) + B*s)*(l*s^2 + g))",
        "1/(s^2*(M*l*s^2 + g*(M + m))*(tau*s + 1) + (l*s^2 + g)*((K*tau + B)*s + K))"),
    "a square": ("a = {}, b = {}, J = {}, m = {}", "u/((J + m*(a + b)^2)*s^2 + 1)",
                 "1/((J + m*(a + b)^2)*s^2 + 1)"),
}  # fmt: skip


@pytest.mark.parametrize("fact", SHAPES)
def test_sums_are_printed_as_a_person_writes_them(fact):
    parameters, output, expected = SHAPES[fact]
    assert shaped(parameters, output) == expected


def test_dampers_beside_a_spring_are_collected_in_powers_of_s():
    # A body on a mount whose second damper is a gain: (b + K)*s + k is the stiffness between both.
    text = """symflex = 1
parameters = { m = {}, b = {}, k = {}, K = {} }
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "w"], k = "k" }
elements.damper = { type = "damper", between = ["x", "w"], b = "b" }
elements.gain = { type = "force_source", at = "x", f = "-K*s*(x - w)" }
inputs.w = { displacement = "w" }
outputs.X = "x"
"""
    assert printed(tf_of(text, "X", "w")) == ("(b + K)*s + k", "m*s^2 + (b + K)*s + k")
    closed = text + 'definitions.Z = "b*s + k"\n'
    assert printed(tf_of(closed, "X", "w")) == ("K*s + Z", "m*s^2 + K*s + Z")


def test_what_a_typed_damping_is_multiplied_by_is_cancelled():
    # Two masses on a spring, whose drive has a notch: 2*0.7*2*pi is 14/5 pi, and the 5 is of all terms.
    text = """symflex = 1
parameters = { K = {}, m = {}, M = {}, b = {}, k = {}, f = "200 Hz" }
elements.motor = { type = "mass", at = "x", m = "m" }
elements.load = { type = "mass", at = "y", m = "M" }
elements.shaft = { type = "spring", between = ["x", "y"], k = "k" }
elements.loss = { type = "damper", between = ["x", "y"], b = "b" }
elements.drive = { type = "force_source", at = "x", f = "N*K*(r - x)" }
blocks.N = { type = "notch", omega = "f", zeta_p = 0.7 }
inputs.r = { unit = "m" }
outputs.Y = "y"
"""
    num, den = printed(tf_of(text, "Y", "r"))
    assert num == "K*(b*s + k)*(s^2 + (2*pi*f)^2)"
    assert den == (
        "s^2*(m*(M*s^2 + b*s + k) + M*(b*s + k))*(s^2 + 2.8*pi*f*s + (2*pi*f)^2)"
        " + K*(M*s^2 + b*s + k)*(s^2 + (2*pi*f)^2)"
    )


DELAYS = """[blocks]
A = { type = "delay", T = "T_1" }
B = { type = "delay", T = "T_2" }
"""


def test_delays_are_one_and_decay_below_one():
    names = 'T_1 = "1 s", T_2 = "2 s"'
    assert shaped(names, "A*B*u", DELAYS) == "exp(-(T_1 + T_2)*s)"
    assert shaped(names, "(1 - A)/(s*T_1)*B*u", DELAYS).startswith("exp(-T_2*s)*(1 - exp(-T_1*s))")


def test_a_delay_stands_behind_the_same_factors_above_and_below():
    # A loop with the block (T_n*s + 1)/s and a delay has numerator and denominator N and s*D + N.
    text = """symflex = 1
parameters = { K = {}, T_n = {}, T = {}, R = {}, L = {} }
blocks.D = { type = "delay", T = "T" }
signals.i = "D*K*(T_n*s + 1)/s*(r - i)/(L*s + R)"
inputs.r = {}
outputs.y = "i"
"""
    num, den = printed(tf_of(text, "y", "r"))
    assert num == "K*(T_n*s + 1)*exp(-T*s)"
    assert den == f"L*s^2 + R*s + {num}"


MODES = """[blocks]
A = { type = "tf", num = "a_1", den = "s^2 + 2*zeta*w_1*s + w_1^2" }
B = { type = "tf", num = "a_2", den = "s^2 + 2*zeta*w_2*s + w_2^2" }
C = { type = "tf", num = "a_3", den = "s^2 + 2*zeta*w_3*s + w_3^2" }
"""


def test_a_modal_sum_is_left_a_sum():
    names = ", ".join(f"{n} = {{}}" for n in ("k", "zeta", *(f"{x}_{i}" for x in "aw" for i in (1, 2, 3))))
    modes = " + ".join(f"a_{i}/(s^2 + 2*zeta*w_{i}*s + w_{i}^2)" for i in (1, 2, 3))
    assert shaped(names, "k*(1/s^2 + A + B + C)*u", MODES) == f"k*(1/s^2 + {modes})"


def test_a_sum_of_two_blocks_in_a_loop_is_one_fraction():
    text = """symflex = 1
parameters = { k = {}, T = {}, J = {} }
elements.rotor = { type = "inertia", at = "phi", J = "J" }
blocks.C = { type = "tf", num = "k", den = "T*s + 1" }
elements.drive = { type = "torque_source", at = "phi", tau = "C*(r - phi)" }
inputs.r = {}
outputs.y = "phi + C*(r - phi)"
"""
    assert "/" not in "".join(printed(tf_of(text, "y", "r")))


def test_a_nested_closed_sum_is_printed_by_powers_of_s():
    # Two oil volumes: (V_1*s + B*(K_c + C))*(V_2*s + B*(K_c + C)) - B^2*C^2, multiplied out by hand.
    text = """symflex = 1
parameters = { A = {}, V_1 = {}, V_2 = {}, B = {}, K = {}, K_c = {}, C = {}, m = {}, b = {} }
[elements]
left  = { type = "piston", mover = "x", chamber = ["ground", "p1"], A = "A" }
right = { type = "piston", mover = "x", chamber = ["p2", "ground"], A = "A" }
oil1  = { type = "acoustic_compliance", at = "p1", C = "V_1/B" }
oil2  = { type = "acoustic_compliance", at = "p2", C = "V_2/B" }
out1  = { type = "flow_source", at = "p1", q = "K*(r - x) - K_c*p1" }
out2  = { type = "flow_source", at = "p2", q = "K*(x - r) - K_c*p2" }
leak  = { type = "acoustic_resistance", between = ["p1", "p2"], R = "1/C" }
load  = { type = "mass", at = "x", m = "m" }
loss  = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
r = { unit = "m" }
[outputs]
X = "x"
"""
    _, den = printed(tf_of(text, "X", "r"))
    oil = "(V_1*V_2*s^2 + B*(V_1 + V_2)*(K_c + C)*s + B^2*K_c*(K_c + 2*C))"
    assert den.startswith(f"s*(m*s + b)*{oil} + ")


def test_powers_of_s_are_collected_beside_functions():
    text = """symflex = 1
parameters = { J_1 = {}, J_2 = {}, c = {}, K = {}, GJ = {}, rhoJ = {}, l = {} }
elements.pipe  = { type = "shaft", between = ["a", "b"], GJ = "GJ", rhoJ = "rhoJ", l = "l" }
elements.top   = { type = "inertia", at = "a", J = "J_1" }
elements.bit   = { type = "inertia", at = "b", J = "J_2" }
elements.loss  = { type = "rotary_damper", between = ["b", "ground"], b = "c" }
elements.drive = { type = "rotary_damper", between = ["a", "ground"], b = "K" }
inputs.T = { torque = "b" }
outputs.W = "s*a"
"""
    # A rigid pipe (cosh = 1) leaves the sum of both inertias and both dampers.
    assert "((J_1 + J_2)*s + c + K)" in printed(tf_of(text, "W", "T"))[1]


def test_terms_that_closed_sums_share_are_printed_once():
    storeys = "".join(
        f"""
m{n} = {{ type = "mass", at = "x{n}", m = "m" }}
k{n} = {{ type = "spring", between = ["{below}", "x{n}"], k = "k_{n}" }}
c{n} = {{ type = "damper", between = ["{below}", "x{n}"], b = "c" }}"""
        for n, below in ((1, "z"), (2, "x1"), (3, "x2"))
    )
    text = f"""symflex = 1
inputs  = {{ a = {{ acceleration = "z" }} }}
outputs = {{ A_3 = "s^2*x3" }}
[parameters]
{"".join(f"{name} = {{}}" + chr(10) for name in "m k_1 k_2 k_3 c m_d k_d c_d g T".split())}
[elements]{storeys}
mover = {{ type = "mass", at = "d", m = "m_d" }}
soft  = {{ type = "spring", between = ["x3", "d"], k = "k_d" }}
loss  = {{ type = "damper", between = ["x3", "d"], b = "c_d" }}
push  = {{ type = "force_source", between = ["d", "x3"], f = "g*s^2*x3/(1 + T*s)" }}
"""
    _, den = printed(tf_of(text, "A_3", "a"))
    assert "(1 + 1)" not in den
    assert "(m*s^2 + 2*c*s + k_2 + k_3)" in den


def test_an_imposed_motion_leaves_the_product_of_transmissibilities():
    text = """symflex = 1
parameters = { m_1 = {}, m_2 = {}, k_1 = {}, k_2 = {} }
elements.a = { type = "mass", at = "x", m = "m_1" }
elements.b = { type = "mass", at = "y", m = "m_2" }
elements.k = { type = "spring", between = ["w", "x"], k = "k_1" }
elements.c = { type = "spring", between = ["x", "y"], k = "k_2" }
inputs.w = { acceleration = "w" }
outputs.Y = "s^2*y"
"""
    form = print_form(pipeline.derive_nested(pipeline.loads(text))[0])
    # y/x = k_2/(m_2*s^2 + k_2), and x/w = k_1/(k_1 + m_1*s^2 + m_2*s^2*y/x).
    assert format_expression(quotient(form.num, form.den)) == "T_1*T_2"
    assert [name for name, _ in form.where] == ["Z_1", "T_1", "Z_2", "T_2"]


def test_pi_stands_beside_the_number_in_a_coefficient():
    head = "symflex = 1\nparameters = { f = {}, a = {}, b = {} }\ninputs.u = {}\n"
    text = head + 'outputs.y = "u/(s + 2*pi*f*(a + b))"'
    assert printed(tf_of(text, "y", "u"), "polynomial")[1] == "s + 2*pi*f*(a + b)"


def test_state_equations_of_four_digits_print_the_characteristic_polynomial():
    # McRuer, Ashkenas & Graham 1973 print such data; s^2 - (a + d)*s + a*d - b*c by hand.
    block = "A = [[-0.0558, -0.9968], [0.598, -0.115]], B = [0.0073, -0.475], C = [0, 1]"
    text = f'symflex = 1\nblocks.G = {{ type = "ss", {block} }}\ninputs.u = {{}}\noutputs.y = "G*u"'
    # -0.475*(s + 0.0558) + 0.598*0.0073; 0.0558*0.115 + 0.9968*0.598
    assert printed(tf_of(text, "y", "u")) == ("-(0.475*s + 0.0221396)", "s^2 + 0.1708*s + 0.6025034")


def test_normalised_forms_are_normalised_where_decimals_are_typed():
    text = 'symflex = 1\ninputs.u = {}\noutputs.y = "1.6*u/(1e-8*s^2 + 1.4e-4*s + 1)"'
    assert printed(tf_of(text, "y", "u"), "constant") == ("1.6", "1e-8*s^2 + 0.00014*s + 1")
    assert printed(tf_of(text, "y", "u"), "monic") == ("1.6e8", "s^2 + 14000*s + 1e8")


def test_a_corner_in_hertz_divides_the_coefficients_of_the_constant_form():
    text = 'symflex = 1\nparameters.f = "1 MHz"\ninputs.u = {}\noutputs.y = "u/(1 + s/(2*pi*f))^3"\n'
    cube = "1/(2*pi*f)^3*s^3 + 3/(2*pi*f)^2*s^2 + 3/(2*pi*f)*s + 1"
    assert printed(tf_of(text, "y", "u"), "constant") == ("1", cube)


def test_a_damping_ratio_of_a_half_does_not_halve_what_is_printed():
    # By hand, with w = 2*pi*f: X = K*G*(r - X)/Z, Z = m*s^2 + b*s + k, G = w^2/(s^2 + w*s + w^2).
    text = """symflex = 1
parameters = { m = {}, b = {}, k = {}, f = { unit = "Hz" }, K = {} }
blocks.G = { type = "low_pass", omega = "f", zeta = 0.5 }
inputs.r = { unit = "m" }
outputs.X = "x"
elements.mass = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }
elements.drive = { type = "force_source", at = "x", f = "K*G*(r - x)" }
"""
    whole = "(m*s^2 + b*s + k)*(s^2 + 2*pi*f*s + (2*pi*f)^2) + (2*pi*f)^2*K"
    assert printed(tf_of(text, "X", "r")) == ("(2*pi*f)^2*K", whole)


def test_like_terms_are_added_and_whole_numbers_stand_in_front():
    # By hand: x/y = (1.5*m*s^2 + b*s + k)/(b*s + k), C = (1 + 3*T*s)/(1 + T*s/3), both masses 2.5*m.
    text = """symflex = 1
parameters = { m = {}, b = {}, c = {}, k = {}, K = {}, T = { unit = "s" } }
blocks.C = { type = "lead_lag", k = "K", T_1 = "3*T", T_2 = "T/3" }
inputs.r = { unit = "m" }
outputs.X = "x"
elements.here = { type = "mass", at = "x", m = "m" }
elements.there = { type = "mass", at = "y", m = "1.5*m" }
elements.ground = { type = "damper", between = ["x", "ground"], b = "c" }
elements.loss = { type = "damper", between = ["x", "y"], b = "b" }
elements.spring = { type = "spring", between = ["x", "y"], k = "k" }
elements.drive = { type = "force_source", at = "x", f = "C*(r - y)" }
"""
    num, den = printed(tf_of(text, "X", "r"), "definitions")
    assert num == "6*K*(3*T*s + 1)*(1.5*m*s^2 + b*s + k)"
    assert den == ("3*m*s^3*(m*s + c)*(T*s + 3) + (b*s + k)*(s*(5*m*s + 2*c)*(T*s + 3) + 6*K*(3*T*s + 1))")


def test_numbers_nobody_can_read_are_printed_as_decimals():
    long = "(0.123456789012345*s + 1.000000000000017)*(s^2 + 0.3333333333333333*s + 0.1414213562373095)"
    text = f'symflex = 1\ninputs.u = {{}}\noutputs.y = "u/({long})"'
    form = print_form(tf_of(text, "y", "u"))
    assert form.name == "zpk"
    # 1/0.123456789012345 and their ratio, to six digits
    assert printed(tf_of(text, "y", "u")) == ("8.1", "(s^2 + 0.333333*s + 0.141421)*(s + 8.1)")


def test_a_factor_of_all_terms_stands_in_front_in_the_default_form():
    # As typed; one symbol more than K*T*s + K, but the gain and the zero are seen.
    text = """symflex = 1
parameters = { K = {}, T = { unit = "s" }, m = { unit = "kg" }, alpha = {} }
blocks.C = { type = "lead_lag", T_1 = "T", T_2 = "alpha*T" }
blocks.P = { type = "tf", num = "1", den = "m*s^2" }
inputs.r = {}
outputs.Y = "P*K*C*r"
"""
    assert printed(tf_of(text, "Y", "r")) == ("K*(T*s + 1)", "m*s^2*(alpha*T*s + 1)")


def test_sums_with_decimals_are_printed_as_they_are_typed():
    for typed in (("K*w*(0.2*s + w)", "1"), ("(0.5*s + w)*(0.1*s + w)", "(s + w)^2")):
        text = f'''symflex = 1
parameters = {{ K = {{}}, w = {{}} }}
inputs.u = {{}}
outputs.y = "{typed[0]}/{typed[1]}*u"
'''
        assert printed(tf_of(text, "y", "u")) == typed


MIRROR = """symflex = 1
parameters = { K = 1, g = 0.5, f_1 = "5.2 kHz", z_1 = 0.02, T = "30 us", k_v = "1.2e7 1/s^2" }
inputs.r = {}
outputs.E = "r - y"
[blocks]
V = "k_v*(0.4*s^2 + 2*z_1*2*pi*f_1*s + (2*pi*f_1)^2)/(s^2 + 2*z_1*2*pi*f_1*s + (2*pi*f_1)^2)/s^2"
[signals]
y = "K*(V + g/(T*s + 1))*(r - y)"
"""


def test_a_sum_keeps_its_typed_decimal_and_its_typed_square():
    den = printed(tf_of(MIRROR, "E", "r"))[1]
    assert "k_v*(0.4*s^2 + 2*z_1*(2*pi*f_1)*s + (2*pi*f_1)^2)" in den


def test_a_repeated_sum_is_one_name_written_as_it_is_typed():
    text = """symflex = 1
inputs.r = { unit = "m" }
outputs.E = "e"
[parameters]
K   = 1
T   = "30 us"
k_v = "1.2e7 1/s^2"
f_1 = "5.2 kHz"
z_1 = 0.02
f_2 = "9.4 kHz"
z_2 = 0.015
T_l = "0.8 ms"
f_l = "3 kHz"
g_m = 0.5
T_m = "60 us"
[blocks]
P_v = "k_v*(1/s^2 - 0.6/(s^2 + 2*z_1*f_1*s + f_1^2))"
P_m = "f_2^2/(s^2 + 2*z_2*f_2*s + f_2^2)"
[signals]
e = "r - exp(-s*T)*y"
y = "K*(P_v*(1 + T_l*s)/(1 + s/f_l) + P_m*g_m/(1 + T_m*s))*e"
"""
    form = print_form(tf_of(text, "E", "r"), is_read=True)
    lines = {name: format_expression(meaning) for name, meaning in form.where}
    assert lines == {"P": "s^2 + 2*z_1*(2*pi*f_1)*s + (2*pi*f_1)^2"}


def test_factors_without_parameters_are_typed_or_end_with_one():
    text = """symflex = 1
blocks.C = { type = "pid", k_p = "2.5", k_i = "10", k_d = "0.1", T_f = "0.01" }
blocks.P = { type = "tf", num = "4", den = "s*(0.5*s + 1)*(0.02*s + 1)" }
inputs.r = {}
outputs.Y = "P*C*r"
"""
    # 4*(2.5 + 10/s + 0.1*s/(0.01*s + 1)) over one denominator, by hand.
    den = "s^2*(0.5*s + 1)*(0.02*s + 1)*(0.01*s + 1)"
    assert printed(tf_of(text, "Y", "r")) == ("0.5*s^2 + 10.4*s + 40", den)


def test_constants_of_a_sum_stand_in_declared_order_above_and_below_the_bar():
    text = """symflex = 1
parameters = { m = {}, k = {}, k_f = {}, alpha = {}, C = {}, R = {}, K = {}, T = {} }
inputs.x_r = {}
outputs.V = "v"
[blocks]
I = { type = "pid", k_p = "0", k_i = "K/T" }
[elements]
amp = { type = "voltage_source", at = "u", v = "I*(x_r - x)" }
r = { type = "resistor", between = ["u", "v"], R = "R" }
stack.type = "piezo"
stack.terminals = ["v", "ground"]
stack.between = ["ground", "x"]
stack.alpha = "alpha"
stack.C = "C"
stack.k = "k"
stage = { type = "mass", at = "x", m = "m" }
flexure = { type = "spring", between = ["x", "ground"], k = "k_f" }
"""
    num, den = printed(tf_of(text, "V", "x_r"))
    assert num == "K*(m*s^2 + k + k_f)"
    assert "(m*s^2 + k + k_f)" in den


def of_network(elements, names="R_1 R_2 R_3 C_1 C_2", own_names=""):
    """Return the voltage gain from node in to node out of resistors and capacitors between nodes."""
    parts = [line.split() for line in elements.split(";")]
    kinds = {"R": "resistor", "C": "capacitor"}
    lines = [
        f'e{i} = {{ type = "{kinds[n[0]]}", between = ["{a}", "{b}"], {n[0]} = "{n}" }}'
        for i, (n, a, b) in enumerate(parts)
        if n != "op"
    ]
    lines += [
        f'amp{i} = {{ type = "op_amp", inputs = ["ground", "{a}"], out = "{b}" }}'
        for i, (n, a, b) in enumerate(parts)
        if n == "op"
    ]
    values = ", ".join(f"{name} = {{}}" for name in names.split())
    own = f"analysis = {{ print = {{ {own_names} }} }}\n"
    text = f"symflex = 1\nparameters = {{ {values} }}\n{own}[elements]\n" + "\n".join(lines)
    return tf_of(text + '\n[inputs]\nv_i = { voltage = "in" }\n[outputs]\nv_o = "out"\n', "v_o", "v_i")


def test_filters_of_second_order_are_printed_by_powers_of_s():
    # Multiple feedback (Franco, Design with Operational Amplifiers, 4th ed. 2014, 3.5), Tow and Thomas (3.7)
    # with unit inverter, and a bridged T, by hand.
    filters = {
        "R_1 in a; R_2 a ground; R_3 n out; C_1 a out; C_2 a n; op n out": (
            "-R_2*R_3*C_2*s",
            "R_1*R_2*R_3*C_1*C_2*s^2 + R_1*R_2*(C_1 + C_2)*s + R_1 + R_2",
        ),
        "R_1 in a; R_2 a b; C_1 a b; op a b; R_3 b c; C_2 c d; op c d; R_4 d e; R_4 e out; op e out; "
        "R_5 out a": (
            "-R_2*R_5",
            "R_1*(R_2*R_3*R_5*C_1*C_2*s^2 + R_3*R_5*C_2*s + R_2)",
        ),
        "C_1 in a; C_2 a out; R_1 a ground; R_2 in out": (
            "R_1*R_2*C_1*C_2*s^2 + R_1*(C_1 + C_2)*s + 1",
            "R_1*R_2*C_1*C_2*s^2 + (R_1*(C_1 + C_2) + R_2*C_2)*s + 1",
        ),
    }
    for elements, sides in filters.items():
        assert printed(of_network(elements, "R_1 R_2 R_3 R_4 R_5 C_1 C_2")) == sides, elements


def test_a_product_of_two_sums_stays_what_it_means():
    # The motor of a servo: its mechanical and its electrical part (Ogata, Modern Control Engineering).
    text = """symflex = 1
parameters = { J = {}, b = {}, K = {}, R = {}, L = {} }
equations = { unknowns = ["w", "i"], equations = ["J*s*w + b*w = K*i", "L*s*i + R*i = u - K*w"] }
inputs = { u = {} }
outputs = { theta = "w/s" }
"""
    assert printed(tf_of(text, "theta", "u")) == ("K", "s*((J*s + b)*(L*s + R) + K^2)")


def test_a_pole_at_zero_is_seen_beside_a_closed_sum():
    # Point kinetics: N/rho = 1/(s*(Lambda + sum(beta_i/(s + lambda_i)))) (Hetrick, Dynamics of Nuclear
    # Reactors, 1971), where beta is the sum of the beta_i.
    for n in (2, 3, 4):
        names = [f"{x}_{i}" for x in ("beta", "lambda", "c") for i in range(1, n + 1)]
        betas, rates, unknowns = names[:n], names[n : 2 * n], names[2 * n :]
        fed = " + ".join(f"{rate}*{c}" for rate, c in zip(rates, unknowns, strict=True))
        parts = zip(betas, rates, unknowns, strict=True)
        rows = [f"s*{c} = {beta}*n - {rate}*{c}" for beta, rate, c in parts]
        text = f"""symflex = 1
parameters = {{ Lambda = {{}}, {", ".join(f"{x} = {{}}" for x in betas + rates)} }}
definitions = {{ beta = "{" + ".join(betas)}" }}
[equations]
unknowns = {["n", *unknowns]}
equations = {[f"Lambda*s*n = rho - beta*n + {fed}", *rows]}
[inputs]
rho = {{}}
[outputs]
N = "n"
"""
        den = printed(tf_of(text, "N", "rho"))[1]
        assert den.startswith("s*("), (n, den)


OSCILLATOR = """symflex = 1
parameters = { m = {ASSUME}, k = {}, c = {} }
analysis = { print = { PRINT } }
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "k" }
elements.damper = { type = "damper", between = ["x", "ground"], b = "c" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
RESONANCE = 'omega_0 = "sqrt(k/m)", zeta = "c/(2*sqrt(k*m))"'


def oscillator(own_names, assume=""):
    text = OSCILLATOR.replace("PRINT", own_names).replace("ASSUME", assume)
    return tf_of(text, "X", "F")


def test_a_standard_form_is_printed_in_names_of_ones_own():
    # m*s^2 + c*s + k is m times s^2 + 2*zeta*omega_0*s + omega_0^2, or k times T^2*s^2 + 2*zeta*T*s + 1.
    forms = {
        RESONANCE: ("1", "m*(s^2 + 2*zeta*omega_0*s + omega_0^2)"),
        'T = "sqrt(m/k)", zeta = "c/(2*sqrt(k*m))"': ("1", "k*(T^2*s^2 + 2*zeta*T*s + 1)"),
        'a = "1/k", T = "sqrt(m/k)", zeta = "c/(2*k*T)"': ("a", "T^2*s^2 + 2*zeta*T*s + 1"),
        'f_0 = "sqrt(k/m)/(2*pi)", Q = "sqrt(k*m)/c"': ("1", "m*(s^2 + 2*pi*f_0*s/Q + 4*pi^2*f_0^2)"),
    }
    for own_names, sides in forms.items():
        assert printed(oscillator(own_names)) == sides, own_names


def test_a_gain_is_printed_in_ones_own_names_too():
    # Franco (see above): H = -A*(omega_0/Q)*s/(s^2 + omega_0/Q*s + omega_0^2), A = R_3*C_2/(R_1*(C_1 + C_2)).
    elements = "R_1 in a; R_2 a ground; R_3 n out; C_1 a out; C_2 a n; op n out"
    own_names = (
        'omega_0 = "sqrt((R_1 + R_2)/(R_1*R_2*R_3*C_1*C_2))", A = "R_3*C_2/(R_1*(C_1 + C_2))", '
        'Q = "sqrt(R_3*(R_1 + R_2)*C_1*C_2/(R_1*R_2))/(C_1 + C_2)"'
    )
    tf = of_network(elements, own_names=own_names)
    assert printed(tf) == ("-omega_0*A*s", "Q*(s^2 + omega_0*s/Q + omega_0^2)")


def test_names_that_are_not_equal_or_only_for_some_signs_are_not_printed():
    # sqrt(k*m)*sqrt(k/m) is k, but -k where m is negative and k is not; m*s^2 + c*s + k contains no k + c.
    for own_names, assume in [(RESONANCE, 'assume = "real"'), ('a = "k + c"', "")]:
        tf = oscillator(own_names, assume)
        assert printed(tf) == ("1", "m*s^2 + c*s + k"), own_names
        assert any("has no factor in" in sentence for sentence in print_forms([tf])[1]), own_names


def test_names_of_ones_own_are_checked():
    for own_names, code in {
        'k = "c/m"': "SF213",
        'a = "sqrt(kk/m)"': "SF210",
        'a = "b", b = "a"': "SF215",
        'a = "x"': "SF212",
        "a = 'k*'": "SF111",
    }.items():
        with pytest.raises(SpecError) as refused:
            oscillator(own_names)
        assert [d.code for d in refused.value.diagnostics] == [code], own_names


def test_a_definition_is_not_repeated_unless_something_in_it_means_another_thing():
    tf = tf_of('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"', "y", "u")
    whole, same, other = (
        PrintedForm("closed", read("s"), read("1"), tuple((name, read(line)) for name, line in lines.items()))
        for lines in (
            {"P": "a*s", "T": "P + b", "q": "b*c"},
            {"P": "a*s", "T": "P + b"},
            {"P": "a*s^2", "T": "P + b", "q": "b*c"},
        )
    )
    text = derive_text([(tf, form) for form in (whole, same, other, whole)])
    lines = [line.removeprefix("  where").strip() for line in text.splitlines()]
    assert [line for line in lines if " = " in line or "above" in line] == [
        *("P = a*s", "T = P + b", "q = b*c"),
        "P, T as above",
        *("q as above", "P = a*s^2", "T = P + b"),
        *("q as above", "P = a*s", "T = P + b"),
    ]  # fmt: skip


def test_definitions_beside_roots_of_s_print_as_they_are_written():
    # By hand: (m s^2 + K) x = F; the sums are those of the file.
    for definitions, k, output, expected in [
        ('d = "1 + s"', "k*d", "s^(1/2)*x", "sqrt(s)/(m*s^2 + k*d); d = 1 + s"),
        ('d = "1 + s", e = "d*(q + s)"', "k*e", "sqrt(s)*x",
         "sqrt(s)/(m*s^2 + k*e); d = 1 + s; e = d*(q + s)"),
        ('d = "(1 + s)/(s + q)"', "k*d", "sqrt(s)*x", "sqrt(s)*(s + q)/(m*s^2*(s + q) + k*s + k)"),
        ('d = "q + s"', "k*d", "s^0.3*x", "s^0.3/(m*s^2 + k*d); d = q + s"),
        ('w = "sqrt(k/m)", d = "s + w"', "k*d", "sqrt(s)*x",
         "sqrt(s)/(m*s^2 + k*d); w = sqrt(k/m); d = s + w"),
        ('d = "1 + s"', "k", "sqrt(s)/d*x", "sqrt(s)/(d*(m*s^2 + k)); d = 1 + s"),
    ]:  # fmt: skip
        text = f"""symflex = 1
parameters = {{ m = 2, k = 3, q = 5 }}
definitions = {{ {definitions} }}
inputs.F = {{ force = "x" }}
outputs.X = "{output}"
elements.body = {{ type = "mass", at = "x", m = "m" }}
elements.wall = {{ type = "spring", between = ["x", "ground"], k = "{k}" }}
"""
        form = print_form(tf_of(text, "X", "F"))
        lines = [f"{name} = {format_expression(line)}" for name, line in form.where]
        assert "; ".join([format_expression(quotient(form.num, form.den)), *lines]) == expected, text


def test_a_long_form_with_a_root_of_s_is_printed():
    # Sums of blocks stay as written where one fraction is long, but not with roots of s.
    blocks = " + ".join(f"a_{i}/(s^2 + b_{i}*s + c_{i})" for i in range(6))
    letters = ", ".join(f"{x}_{i} = {i + 2}" for x in "abc" for i in range(6))
    for output in (f"s^(1/2)*({blocks})*u", f"({blocks} + 1/(1 + sqrt(s)))*u"):
        text = f'symflex = 1\nparameters = {{ {letters} }}\ninputs.u = {{}}\noutputs.y = "{output}"\n'
        form = print_form(tf_of(text, "y", "u"))
        assert "sqrt(s)" in format_expression(quotient(form.num, form.den)), output


def test_a_root_of_s_before_a_rotation_of_a_field_prints():
    text = """symflex = 1
parameters = { kGA = "1e5 N", EI = "40 N*m^2", r = "2 kg/m", J = "1e-3 kg*m", l = "1 m" }
inputs.F = { unit = "N" }
outputs.Y = "s^(1/2)*phi'(0)"
[fields.b]
unknowns = ["w", "phi"]
domain = ["0 m", "l"]
equations = ["kGA*(w'' - phi') = r*s^2*w", "EI*phi'' + kGA*(w' - phi) = J*s^2*phi"]
conditions = ["w(0) = 0", "phi(0) = 0", "phi'(l) = 0", "kGA*(w'(l) - phi(l)) = F"]
"""
    form = print_form(tf_of(text, "Y", "F"))
    assert "sqrt(s)" in format_expression(form.num) + format_expression(form.den)


def test_a_ladder_is_printed_with_names_for_what_its_sections_share():
    # Every section of a ladder bears those behind it, once for its resistor and once for its capacitor.
    n = range(1, 7)
    values = ", ".join(f"R_{i} = {{}}, C_{i} = {{}}" for i in n)
    parts = [f'r{i} = {{ type = "resistor", between = ["n{i - 1}", "n{i}"], R = "R_{i}" }}' for i in n]
    parts += [f'c{i} = {{ type = "capacitor", between = ["n{i}", "ground"], C = "C_{i}" }}' for i in n]
    text = f'symflex = 1\nparameters = {{ {values} }}\ninputs.U = {{ voltage = "n0" }}\noutputs.V = "n6"\n'
    form = print_form(tf_of("\n".join([text, "[elements]", *parts]), "V", "U"), is_read=True)
    # A name stands for what sections share, so that no long sum is printed twice.
    sums = [
        part for e in (form.den, *(e for _, e in form.where)) for part in nodes(e) if isinstance(part, Sum)
    ]
    twice = {part for part in sums if sums.count(part) > 1}
    assert all(len(format_expression(part)) < 25 for part in twice)
    assert len(form.where) > 2


def test_factors_of_a_long_product_stay_by_powers_of_s_also_with_sines_of_constants():
    # A Butterworth filter of order 20, as Butterworth wrote it in 1930: ten quadratic factors.
    factors = [f"s^2 + 2*sin({n}*pi/40)*w*s + w^2" for n in range(1, 20, 2)]
    product = "*".join(f"({factor})" for factor in factors)
    text = f'symflex = 1\nparameters.w = {{}}\ninputs.u = {{}}\noutputs.y = "w^20/({product})*u"\n'
    form = print_form(tf_of(text, "y", "u"))
    assert format_expression(form.num) == "w^20"
    assert format_expression(form.den) == "*".join(
        f"(s^2 + 2*w*sin({n if n > 1 else ''}{'*' * (n > 1)}pi/40)*s + w^2)" for n in range(1, 20, 2)
    )


def test_impedances_in_series_add_in_a_nested_line():
    # A winding: coils with a resistance each, a capacitor beside each; z = R + L*s, as series impedances add.
    parts = [
        f'{kind}{k} = {{ type = "{name}", between = ["{a}{k}", "{b}{k + own}"], {letter} = "{letter}" }}'
        for k in range(2)
        for kind, name, a, b, own, letter in (
            ("l", "inductor", "n", "m", 0, "L"),
            ("r", "resistor", "m", "n", 1, "R"),
            ("c", "capacitor", "n", "n", 1, "C"),
        )
    ]
    parts += [f'g{k} = {{ type = "capacitor", between = ["n{k}", "ground"], C = "G" }}' for k in (1, 2)]
    head = 'symflex = 1\nparameters = { L = {}, R = {}, C = {}, G = {} }\ninputs.U = { voltage = "n0" }\n'
    model = pipeline.loads("\n".join([head + 'outputs.V = "n2"\n[elements]', *parts]))
    (tf,) = pipeline.derive_nested(model, [("V", "U")])
    assert "C*s + 1/(L*s + R)" in [format_expression(line) for _, line in print_form(tf).where]


@pytest.mark.parametrize(
    ("printed", "expected"),
    [
        ("a*(cosh(q)^2 - 1)", "a*sinh(q)^2"),
        ("a*(1 - cos(q)^2) + b", "a*sin(q)^2 + b"),
        ("2*a + cos(q)^2 - 1", "2*a - sin(q)^2"),
        ("3*cosh(q)^2 + b - 3", "3*sinh(q)^2 + b"),
        ("2*cosh(q)^2 - 1", "2*cosh(q)^2 - 1"),
    ],
)
def test_squares_less_one_are_squares_of_the_other_function(printed, expected):
    model = pipeline.loads(
        'symflex = 1\nparameters = { a = {}, b = {}, q = {} }\ninputs.u = {}\noutputs.y = "u/(s + a)"'
    )
    assert format_expression(SumSigns.of(model).oriented(parse(Text.alone("t", printed)))) == expected


def test_a_function_of_delays_alone_has_no_minus_over_minus():
    # The echoes of a pipe: u + R*exp(-2*s*l/c)*y = y.
    text = """symflex = 1
parameters = { R = {}, T = {} }
inputs.u = {}
outputs.y = "x"
signals.x = "u + R*exp(-T*s)*x"
"""
    form = print_form(tf_of(text, "y", "u"))
    assert (format_expression(form.num), format_expression(form.den)) == ("1", "1 - R*exp(-T*s)")
