"""Printed formulas of members whose coefficients vary along x."""

import pytest
import sympy

import symflex as api
from symflex import pipeline
from symflex.print.forms import print_form
from symflex.print.json_format import derive_json
from symflex.print.mathml import transfer_function_mathml
from symflex.print.text import derive_text

ROD = """
symflex = 1
parameters = {E = {}, A_0 = {}, rho = {}, l = {}, Z_1 = {}}
inputs.F = {force = "tip"}
outputs.u = "tip"
[elements]
bar = { type = "rod", between = ["ground", "tip"], E = "E", A = "A_0*(1 - x/(2*l))", rho = "rho", l = "l" }
"""


@pytest.fixture(scope="module")
def rod():
    model = pipeline.loads(ROD)
    (found,) = pipeline.derive_all(model)
    return found


def test_the_differential_equations_of_a_tapered_rod_are_where_lines(rod):
    # u' = f/(E A) and f' = rho A s^2 u (Graff 1975, section 2.1); Z is a parameter's letter here.
    text = derive_text([(rod, print_form(rod))]).splitlines()
    assert [line.strip() for line in text[2:5]] == ["Y_12(l)", "-------", "Y_22(l)"]
    assert [line.removeprefix("  where").strip() for line in text[6:9]] == [
        "Y_1j' = 2*l/(E*A_0*(2*l - x))*Y_2j",
        "Y_2j' = A_0*rho*s^2*(2*l - x)/(2*l)*Y_1j",
        "Y_ij(0) = delta_ij",
    ]


def test_latex_and_json_hold_the_same_lines(rod):
    entry = derive_json(rod, print_form(rod))
    assert [name for name, _ in entry["laws"]] == ["Y_1j", "Y_2j", "Y_ij"]
    assert r"\frac{Y_{12}(l)}{Y_{22}(l)}" in entry["latex"]
    assert r"\delta_{ij}" in entry["latex"]


STRING = """
symflex = 1
parameters = {{rhoA = {{}}, N = {{}}, l = {{}}, {extra} = {{}}}}
inputs.u = {{}}
outputs.y = "{extra}*w({end})"
[fields]
w = {{ domain = ["0", "l"], equation = "{equation}", conditions = [{conditions}] }}
"""
HANGING = {"equation": "(rhoA*N*(l - x)*w')' = rhoA*s^2*w", "conditions": '"w(0) = u"', "end": "l"}
THICK = {"equation": "N*w'' = rhoA*(1 + x/l)*s^2*w", "conditions": '"w(0) = 0", "w\'(l) = u"', "end": "l"}
TURNING = {"equation": "(N*(l^2 - x^2)*w')' = rhoA*s^2*w", "conditions": '"w(0) = u"', "end": "l"}


def string(extra="c", **case):
    (found,) = pipeline.derive_all(pipeline.loads(STRING.format(extra=extra, **case)))
    return found, print_form(found)


def test_a_hanging_string_is_bernoullis_bessel_function():
    # Watson 1944, section 1.2: J_0(2 omega sqrt(l/g)), which is I_0 of s.
    tf, form = string(**HANGING)
    text = derive_text([(tf, form)]).splitlines()
    assert ["  so    Z_11(0) = I_0(q)", "        q = 2*s*sqrt(l/N)"] == text[-2:]
    assert derive_json(tf, form)["closed"] == [["Z_11(0)", "I_0(q)"], ["q", "2*s*sqrt(l/N)"]]
    assert r"Z_{11}(0) = I_{0}(q)" in derive_json(tf, form)["latex"]
    assert "<msub><mi>I</mi><mn>0</mn></msub>" in str(transfer_function_mathml(tf, form))


def test_a_bessel_function_leaves_a_parameter_its_name():
    tf, form = string("I_0", **HANGING)
    assert "Z_11(0) = BesselI_0(q)" in derive_text([(tf, form)])
    assert r"\mathrm{I}_{0}(q)" in derive_json(tf, form)["latex"]


def test_orders_that_are_fractions_stand_in_parentheses():
    # w'' = k^2 (1 + x/l) w is Airy's equation, and Airy's functions are of order 1/3.
    tf, form = string(**THICK)
    assert "I_(1/3)(q_2)" in derive_text([(tf, form)])
    assert "I_{1/3}" in derive_json(tf, form)["latex"]


def test_a_law_that_has_no_bessel_functions_stays_alone():
    # A turning string is Legendre's equation.
    tf, form = string(**TURNING)
    assert form.laws
    assert not form.closed
    assert "closed" not in derive_json(tf, form)


def test_a_law_whose_inertia_vanishes_at_its_start_stays_alone():
    # Airy's own equation w'' = k^2 x w, and others whose Bessel functions have no value at x = 0.
    for inertia in ("x/l*s^2", "x^2/l^2*s^2", "s^2*(x/l)^3"):
        _, form = string(**{**THICK, "equation": f"N*w'' = rhoA*{inertia}*w"})
        assert form.laws and not form.closed, inertia


def test_sympy_has_the_bessel_functions_of_a_closed_form():
    model = api.loads(STRING.format(extra="c", **HANGING))
    (called, value), (q, argument) = model.transfer_function("y", "u").form("hyperbolic").closed
    assert value == sympy.besseli(0, q)
    assert str(called) == "Z_11(0)"
    assert value.diff(q) == sympy.besseli(1, q)
    rate, length, tension = (next(x for x in argument.free_symbols if x.name == n) for n in ("s", "l", "N"))
    assert sympy.simplify(argument**2 - 4 * rate**2 * length / tension) == 0
