"""Right formulas in many prints, and right formulas made wrong in one place."""

from __future__ import annotations

import pytest

from symflex.expressions import format_expression
from tests.house.repository import slow_ones
from tests.unit.audit.beam import COLOCATED, KRYLOV, SCALE, TIP, VAUGHAN, audited

RIGHT = {
    "as the paper should have printed it": ("V_act", COLOCATED, VAUGHAN, SCALE),
    "the tip as the paper prints it": ("V_tip", TIP, VAUGHAN, SCALE),
    "hyperbolic": (
        "V_act",
        "mu*(cosh(q)^2 + cos(q)^2)/(rho*A*s*(cosh(q)*sinh(q) + cos(q)*sin(q)))",
        KRYLOV,
        None,
    ),
    "in double arguments": (
        "V_act",
        "mu/(rho*A*s)*(2 + cosh(2*q) + cos(2*q))/(sinh(2*q) + sin(2*q))",
        KRYLOV,
        None,
    ),
    "with tangents": (
        "V_tip",
        "2*mu/(rho*A*s)/(tanh(q)*cosh(q)/cos(q) + tan(q)*cos(q)/cosh(q))",
        KRYLOV,
        None,
    ),
    "with the wavenumber as a product of roots": (
        "V_act",
        "mu/(rho*A*s)*(2 + cosh(2*q) + cos(2*q))/(sinh(2*q) + sin(2*q))",
        {"mu": "sqrt(s/2)*(rho*A/(E*I))^0.25", "q": "mu*l"},
        None,
    ),
    "in omega, with a root of a negative number": (
        "V_tip",
        "-b*(cosh(b) + cos(b))*l/(s*rho*A*l^2)*(-1)/(sinh(b)*cos(b) + cosh(b)*sin(b))",
        {"b": "l*(-rho*A*s^2/(E*I))^(1/4)"},
        None,
    ),
    "with a common factor above and below": (
        "V_act",
        COLOCATED.replace("*((S", "*(C*S - 3)*((S") + "/(C*S - 3)",
        VAUGHAN,
        SCALE,
    ),
    "multiplied out": (
        "V_act",
        COLOCATED.replace("(S^2 + C^2)^2", "S^4 + 2*S^2*C^2 + C^4"),
        VAUGHAN,
        SCALE,
    ),
    "with the scale in the formula": ("V_tip", f"{TIP}/(rho*A*a)", VAUGHAN, None),
    "with negative powers": ("V_tip", TIP.replace("sqrt(2/p)", "sqrt(2)*p^(-1/2)"), VAUGHAN, SCALE),
}


@pytest.mark.parametrize("name", RIGHT)
def test_a_right_formula_is_proved(name):
    assert audited(*RIGHT[name]).verdict == "equal"


WRONG = {
    "a coefficient": (
        ("V_act", COLOCATED.replace("6*C^2", "5*C^2"), VAUGHAN, SCALE),
        [("numerator", "5*C^2", "6*C^2")],
    ),
    "a sign": (
        ("V_act", COLOCATED.replace("- 4*C*S", "+ 4*C*S"), VAUGHAN, SCALE),
        [("denominator", "4*C*S", "-4*C*S")],
    ),
    "the constant term": (
        ("V_act", COLOCATED.replace("- 1)", "- 2)"), VAUGHAN, SCALE),
        [("denominator", "-2", "-1")],
    ),
    "a coefficient and the factor": (
        ("V_act", COLOCATED.replace("6*C^2", "2*C^2").replace("-1/2", "-1"), VAUGHAN, SCALE),
        [("factor", "-1", "-1/2"), ("numerator", "2*C^2", "6*C^2")],
    ),
    "coefficients above and below, and the factor": (
        (
            "V_act",
            COLOCATED.replace("6*C", "2*C").replace("4*C*S", "3*C*S").replace("-1/2", "1"),
            VAUGHAN,
            SCALE,
        ),
        [("factor", "1", "-1/2"), ("numerator", "2*C^2", "6*C^2"), ("denominator", "-3*C*S", "-4*C*S")],
    ),
    "S and C exchanged": (
        ("V_tip", TIP.replace("*C*(", "*S*("), VAUGHAN, SCALE),
        [("numerator", "S", "C")],
    ),
    "a term missing": (
        ("V_act", COLOCATED.replace(" + 6*C^2", ""), VAUGHAN, SCALE),
        [("numerator", "0", "6*C^2")],
    ),
    "the constant missing": (
        ("V_tip", TIP.replace("S^2 + C^2 + 1", "S^2 + C^2"), VAUGHAN, SCALE),
        [("numerator", "0", "1")],
    ),
    "an exponent": (
        ("V_tip", TIP.replace("S^2 + C^2 + 1", "S^2 + C^3 + 1"), VAUGHAN, SCALE),
        [("numerator", "C^3", "C^2")],
    ),
    "the exponent of a sum": (
        ("V_act", COLOCATED.replace("(S^2 + C^2)^2 + 2", "(S^2 + C^2)^3 + 2"), VAUGHAN, SCALE),
        [("numerator", "(S^2 + C^2)^3", "(S^2 + C^2)^2")],
    ),
    "a hyperbolic function": (
        ("V_act", "mu/(rho*A*s)*(2 + cosh(2*q) + cos(2*q))/(cosh(2*q) + sin(2*q))", KRYLOV, None),
        [("denominator", "cosh(2*q)", "sinh(2*q)")],
    ),
    "a pole the beam does not have": (
        ("V_act", COLOCATED + "/(1 + s*l*sqrt(rho/E))", VAUGHAN, SCALE),
        [("denominator", "1 + s*l*sqrt(rho/E)", "1")],
    ),
    "a line of the abbreviations": (
        ("V_act", COLOCATED, VAUGHAN | {"T": "l^2"}, SCALE),
        [("line T", "l^2", "l^2/2")],
    ),
    "a root not printed": (
        ("V_act", COLOCATED, VAUGHAN | {"a": "E*I/(rho*A)"}, SCALE),
        [("line a", "E*I/(rho*A)", "sqrt(E*I/(rho*A))")],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_formula_is_proved_to_differ(name):
    given, _ = WRONG[name]
    assert audited(*given).verdict == "differs"


EACH_TIME = ("a coefficient and the factor", "the constant missing", "a hyperbolic function")


@pytest.mark.parametrize("name", slow_ones(WRONG, lambda name: name not in EACH_TIME))
def test_what_was_made_wrong_is_found(name):
    given, expected = WRONG[name]
    changes = audited(*given).changes
    assert [
        (c.place, format_expression(c.printed), format_expression(c.derived)) for c in changes
    ] == expected


RATIOS = {
    "twice": (COLOCATED.replace("-1/2", "-1"), SCALE, "2"),
    "with the other sign": (COLOCATED.replace("-1/2", "1/2"), SCALE, "-1"),
    "without its scale": (COLOCATED, None, "sqrt(E*I*rho*A)"),
    "as a receptance": (COLOCATED, "1/(rho*A*a*s)", "1/s"),
    "a third": (COLOCATED.replace("-1/2", "-1/6"), SCALE, "1/3"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RATIOS)
def test_a_constant_ratio_is_named(name):
    expr, scale, expected = RATIOS[name]
    assert format_expression(audited("V_act", expr, VAUGHAN, scale).ratio) == expected


@pytest.mark.slow
def test_a_formula_of_another_kind_is_proved_to_differ_without_a_correction():
    found = audited("V_tip", "2*mu/(rho*A*s)/(tanh(q) + tan(q))", KRYLOV)
    assert found.verdict == "differs"
    assert found.correction is None


@pytest.mark.slow
def test_the_derived_function_is_written_in_the_symbols_of_a_hopeless_print():
    found = audited("V_tip", "(S^3 - C)/(S - 7*C^2)", VAUGHAN)
    assert "(C^3 + S^2*C + C)/(C^4 + 2*S^2*C^2 + S^4 - 4*S*C - 1)" in format_expression(found.derived)
