"""Right formulas in many prints, and right formulas made wrong in one place."""

import pytest

from symflex import pipeline
from symflex.audit.judge import audit
from symflex.expressions import format_expression
from tests.unit.audit.beam import COLOCATED, KRYLOV, SCALE, TIP, VAUGHAN, audited

DOUBLE = "mu/(rho*A*s)*(2 + cosh(2*q) + cos(2*q))/(sinh(2*q) + sin(2*q))"


def act(expr, where=VAUGHAN, scale=SCALE):
    return "V_act", expr, where, scale


def tip(expr, where=VAUGHAN, scale=SCALE):
    return "V_tip", expr, where, scale


RIGHT = {
    "as the paper should have printed it": act(COLOCATED),
    "the tip as the paper prints it": tip(TIP),
    "hyperbolic": act("mu*(cosh(q)^2 + cos(q)^2)/(rho*A*s*(cosh(q)*sinh(q) + cos(q)*sin(q)))", KRYLOV, None),
    "in double arguments": act(DOUBLE, KRYLOV, None),
    "with tangents": tip("2*mu/(rho*A*s)/(tanh(q)*cosh(q)/cos(q) + tan(q)*cos(q)/cosh(q))", KRYLOV, None),
    "with the wavenumber as a product of roots": act(
        DOUBLE, {"mu": "sqrt(s/2)*(rho*A/(E*I))^0.25", "q": "mu*l"}, None
    ),
    "in omega, with a root of a negative number": tip(
        "-b*(cosh(b) + cos(b))*l/(s*rho*A*l^2)*(-1)/(sinh(b)*cos(b) + cosh(b)*sin(b))",
        {"b": "l*(-rho*A*s^2/(E*I))^(1/4)"},
        None,
    ),
    "with a common factor above and below": act(COLOCATED.replace("*((S", "*(C*S - 3)*((S") + "/(C*S - 3)"),
    "multiplied out": act(COLOCATED.replace("(S^2 + C^2)^2", "S^4 + 2*S^2*C^2 + C^4")),
    "with the scale in the formula": tip(f"{TIP}/(rho*A*a)", scale=None),
    "with negative powers": tip(TIP.replace("sqrt(2/p)", "sqrt(2)*p^(-1/2)")),
}


@pytest.mark.slow
def test_a_right_formula_is_proved():
    assert {name: audited(*given).verdict for name, given in RIGHT.items()} == dict.fromkeys(RIGHT, "equal")


WRONG = {
    "a sign": (act(COLOCATED.replace("- 4*C*S", "+ 4*C*S")), [("denominator", "4*C*S", "-4*C*S")]),
    "the constant term": (act(COLOCATED.replace("- 1)", "- 2)")), [("denominator", "-2", "-1")]),
    "a coefficient and the factor": (
        act(COLOCATED.replace("6*C^2", "2*C^2").replace("-1/2", "-1")),
        [("factor", "-1", "-1/2"), ("numerator", "2*C^2", "6*C^2")],
    ),
    "coefficients above and below, and the factor": (
        act(COLOCATED.replace("6*C", "2*C").replace("4*C*S", "3*C*S").replace("-1/2", "1")),
        [("factor", "1", "-1/2"), ("numerator", "2*C^2", "6*C^2"), ("denominator", "-3*C*S", "-4*C*S")],
    ),
    "S and C exchanged": (tip(TIP.replace("*C*(", "*S*(")), [("numerator", "S", "C")]),
    "the constant missing": (tip(TIP.replace("S^2 + C^2 + 1", "S^2 + C^2")), [("numerator", "0", "1")]),
    "an exponent": (tip(TIP.replace("S^2 + C^2 + 1", "S^2 + C^3 + 1")), [("numerator", "C^3", "C^2")]),
    "the exponent of a sum": (
        act(COLOCATED.replace("(S^2 + C^2)^2 + 2", "(S^2 + C^2)^3 + 2")),
        [("numerator", "(S^2 + C^2)^3", "(S^2 + C^2)^2")],
    ),
    "a hyperbolic function": (
        act(DOUBLE.replace("sinh(2*q)", "cosh(2*q)"), KRYLOV, None),
        [("denominator", "cosh(2*q)", "sinh(2*q)")],
    ),
    "a pole the beam does not have": (
        act(COLOCATED + "/(1 + s*l*sqrt(rho/E))"),
        [("denominator", "1 + s*l*sqrt(rho/E)", "1")],
    ),
    "a line of the abbreviations": (act(COLOCATED, VAUGHAN | {"T": "l^2"}), [("line T", "l^2", "l^2/2")]),
    "a root not printed": (
        act(COLOCATED, VAUGHAN | {"a": "E*I/(rho*A)"}),
        [("line a", "E*I/(rho*A)", "sqrt(E*I/(rho*A))")],
    ),
    "a quotient turned over": (
        act(COLOCATED, VAUGHAN | {"a": "sqrt(rho*A/(E*I))"}),
        [("line a", "sqrt(rho*A/(E*I))", "sqrt(E*I/(rho*A))")],
    ),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.slow
def test_a_wrong_formula_is_proved_to_differ_and_what_was_made_wrong_is_found(name):
    given, expected = WRONG[name]
    found = audited(*given)
    assert found.verdict == "differs"
    changes = [(c.place, format_expression(c.printed), format_expression(c.derived)) for c in found.changes]
    assert changes == expected


ISOLATOR = """symflex = 1
parameters = { m = { unit = "kg" }, k = { unit = "N/m" }, b = { unit = "N*s/m" } }
inputs.y = { displacement = "y" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "y"], k = "k" }
damper = { type = "damper", between = ["x", "y"], b = "b" }
[published."X/y"]
"""
MODAL = "w = 'sqrt(k/m)', z = 'b/(2*sqrt(k*m))'"
ISOLATOR_SLIPS = [
    ("(b*s + k)/(k*s^2 + b*s + m)", "", [("denominator", "k", "m"), ("denominator", "m", "k")]),
    ("(b*s + k)/(m*s^2 + s/b + k)", "", [("denominator", "b", "1/b")]),
    ("k/(m*s^2 + b*s + k)", "", [("numerator", "0", "b*s")]),
    ("(b*s + k)/(m*s^2 + b + k)", "", [("denominator", "b", "b*s")]),
    ("(m + k)/(m*s^2 + b*s + k)", "", [("numerator", "m", "b*s")]),
    ("(1 + 2*z*(s/w))/(1 + 2*z*(s/w) + (s/w)^3)", MODAL, [("denominator", "(s/w)^3", "(s/w)^2")]),
    ("(1 + 2*z*s/w)/(1 + 2*z*s/w + s^2/w)", MODAL, [("denominator", "w", "w^2")]),
    ("(b*s + k)/(k + m*w2 + b*s)", "w2 = '-s^2'", [("denominator", "m*w2", "-m*w2")]),
]


def test_slips_in_the_formula_of_an_isolator_are_found():
    for expr, where, expected in ISOLATOR_SLIPS:
        (found,) = audit(pipeline.loads(f"{ISOLATOR}expr = '{expr}'\nwhere = {{ {where} }}\n"))
        changes = [
            (c.place, format_expression(c.printed), format_expression(c.derived)) for c in found.changes
        ]
        assert (found.verdict, changes) == ("differs", expected), expr


SERIES = """symflex = 1
parameters = { m = { unit = "kg" }, k_1 = { unit = "N/m" }, k_2 = { unit = "N/m" }, c = { unit = "N*s/m" } }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
first = { type = "spring", between = ["x", "y"], k = "k_1" }
second = { type = "spring", between = ["y", "ground"], k = "k_2" }
damper = { type = "damper", between = ["x", "ground"], b = "c" }
[published."X/F"]
"""
BELOW = "denominator"
SERIES_SLIPS = [
    ("1/(m*s^2 + c*s + 1/k_1 + 1/k_2)", (BELOW, "1/k_1 + 1/k_2", "1/(1/k_1 + 1/k_2)")),
    ("1/(m*s^2 + c*s + k_1 + k_2)", (BELOW, "k_1 + k_2", "1/(1/k_1 + 1/k_2)")),
    ("(k_1 + k_2)/((m*s^2 + c*s)*(k_1 + k_2) + k_1 + k_2)", (BELOW, "k_1 + k_2", "k_1*k_2")),
    ("1/((m*s^2 + c*s)*(k_1 + k_2) + k_1*k_2)", ("numerator", "1", "k_1 + k_2")),
    ("(k_1 + k_2)/((m*s^2 + c*s)*k_1 + k_1*k_2)", None),
    ("(k_1 + k_2)/(m*s^2*(k_1 + k_2) + k_1*k_2)", (BELOW, "0", "c*(k_1 + k_2)*s")),
]


@pytest.mark.parametrize(("expr", "expected"), SERIES_SLIPS)
def test_springs_in_series_are_repaired_as_a_person_would(expr, expected):
    (found,) = audit(pipeline.loads(f"{SERIES}expr = '{expr}'\n"))
    changes = [(c.place, format_expression(c.printed), format_expression(c.derived)) for c in found.changes]
    assert found.verdict == "differs"
    if expected is not None:
        assert changes == [expected]
    # A term k/s^2 in a polynomial is no repair.
    assert not any("/s" in derived for _, _, derived in changes)


CANTILEVER = """symflex = 1
parameters = { E = "200 GPa", I = "1e-8 m^4", rho = "7800 kg/m^3", A = "1e-4 m^2", l = "1 m" }
inputs.F = { force = "tip" }
outputs.Y = "tip"
[elements]
wall = { type = "fixed", at = "root" }
arm = { type = "beam", between = ["root", "tip"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
[published."Y/F"]
"""
RECEPTANCE = "(cosh(b)*sin(b) - sinh(b)*cos(b))/(E*I*(b/l)^3*(1 + cosh(b)*cos(b)))"
WAVENUMBER = "l*(-rho*A*s^2/(E*I))^(1/4)"
BEAM_SLIPS = [
    (RECEPTANCE.replace("- sinh", "+ sinh"), WAVENUMBER, ("numerator", "sinh(b)*cos(b)", "-sinh(b)*cos(b)")),
    (
        RECEPTANCE.replace("(1 + cosh(b)*cos(b))", "cosh(b)*cos(b)"),
        WAVENUMBER,
        (BELOW, "cosh(b)*cos(b)", "cosh(b)*cos(b) + 1"),
    ),
    (
        RECEPTANCE,
        WAVENUMBER.replace("-rho", "rho"),
        ("line b", WAVENUMBER.replace("-rho", "rho"), WAVENUMBER),
    ),
    (
        RECEPTANCE,
        WAVENUMBER.replace("*A", ""),
        ("line b", WAVENUMBER.replace("*A", ""), "l*(-rho*s^2/(E*I)*A)^(1/4)"),
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("expr", "line", "expected"), BEAM_SLIPS)
def test_a_receptance_is_repaired_as_a_person_would(expr, line, expected):
    (found,) = audit(pipeline.loads(f"{CANTILEVER}expr = '{expr}'\nwhere = {{ b = '{line}' }}\n"))
    changes = [(c.place, format_expression(c.printed), format_expression(c.derived)) for c in found.changes]
    assert changes == [expected]


RATIOS = {
    "twice": (COLOCATED.replace("-1/2", "-1"), SCALE, "2"),
    "with the other sign": (COLOCATED.replace("-1/2", "1/2"), SCALE, "-1"),
    "without its scale": (COLOCATED, None, "sqrt(E*I*rho*A)"),
    "as a receptance": (COLOCATED, "1/(rho*A*a*s)", "1/s"),
    "a third": (COLOCATED.replace("-1/2", "-1/6"), SCALE, "1/3"),
}


@pytest.mark.slow
def test_a_constant_ratio_is_named():
    for name, (expr, scale, expected) in RATIOS.items():
        assert format_expression(audited(*act(expr, scale=scale)).ratio) == expected, name


@pytest.mark.slow
def test_a_formula_of_another_kind_is_proved_to_differ_without_a_correction():
    found = audited("V_tip", "2*mu/(rho*A*s)/(tanh(q) + tan(q))", KRYLOV)
    assert found.verdict == "differs"
    assert found.correction is None


@pytest.mark.slow
def test_the_derived_function_is_written_in_the_symbols_of_a_hopeless_print():
    found = audited("V_tip", "(S^3 - C)/(S - 7*C^2)", VAUGHAN)
    assert "(C^3 + S^2*C + C)/(C^4 + 2*S^2*C^2 + S^4 - 4*S*C - 1)" in format_expression(found.derived)


ABSORBER = """
symflex = 1
parameters = { m_1 = "2 kg", m_2 = "1 kg", k_1 = "8 N/m", k_2 = "3 N/m", b = "1 N*s/m" }
[elements]
A = { type = "mass", at = "x", m = "m_1" }
B = { type = "mass", at = "y", m = "m_2" }
K1 = { type = "spring", between = ["x", "ground"], k = "k_1" }
K2 = { type = "spring", between = ["x", "y"], k = "k_2" }
D = { type = "damper", between = ["x", "y"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
Y = "y"
"""
EXPR = "d/m_1/((s^2 + d)*(s^2 + w_1^2) + mu*s^2*d)"
LINES = {
    "d": "2*zeta*w_2*s + w_2^2",
    "w_1": "sqrt(k_1/m_1)",
    "w_2": "sqrt(k_2/m_2)",
    "zeta": "b/(2*sqrt(k_2*m_2))",
    "mu": "m_2/m_1",
}


def judged(lines, expr=EXPR):
    where = ", ".join(f'{name} = "{line}"' for name, line in lines.items())
    model = pipeline.loads(f'{ABSORBER}[published."Y/F"]\nexpr = "{expr}"\nwhere = {{ {where} }}\n')
    return audit(model)[0]


SLIPS = {
    "turned over": {"w_1": "sqrt(m_1/k_1)"},
    "turned over where the formula could be mended": {"mu": "m_1/m_2"},
    "another name": {"w_2": "sqrt(k_1/m_2)"},
    "a root forgotten": {"zeta": "b/(2*k_2*m_2)"},
    "above for below": {"zeta": "b*sqrt(k_2*m_2)/2"},
    "a factor forgotten": {"mu": "m_2"},
    "hidden by a mass of 1 kg": {"w_2": "sqrt(k_2*m_2)"},
    "two lines exchanged": {"w_1": LINES["w_2"], "w_2": LINES["w_1"]},
    "two slips in one line": {"zeta": "b*sqrt(k_2*m_2)/4"},
    "a slip in each of two lines": {"w_1": "sqrt(m_1/k_1)", "zeta": "b/(4*sqrt(k_2*m_2))"},
}


@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.slow
def test_a_slip_in_a_line_is_mended_there(slip):
    found = judged(LINES | SLIPS[slip])
    assert found.verdict == "differs"
    assert {c.place.removeprefix("line ") for c in found.changes} == SLIPS[slip].keys()


@pytest.mark.slow
def test_a_printed_sum_of_unlike_units_is_named():
    assert judged(LINES).verdict == "equal"
    (sentence,) = judged(LINES, EXPR.replace("w_1^2", "w_1")).units
    assert sentence == "the terms of s^2 + w_1 disagree: s^2 in '1/s^2', w_1 in '1/s'"


LOOP = """
symflex = 1
parameters = { m = "2 kg", k = "800 N/m", b = "4 N*s/m", K = "30 N/m", T = "20 ms" }
signals = { u = "K*(1 + T*s)*(r - x)" }
inputs = { r = { unit = "m" } }
outputs = { X = "x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
damper = { type = "damper", between = ["x", "ground"], b = "b" }
drive = { type = "force_source", at = "x", f = "u" }
"""
LINE_SLIPS = {
    "the exponent of a quotient": (
        "C/(m*(s^2 + w^2) + b*s + C)",
        {"C": "K*(1 + T*s)", "w": "(k/m)^(1/4)"},
        "line w: (k/m)^(1/4), (k/m)^(1/2)",
    ),
    "one left out": ("C/(m*s^2 + b*s + k + C)", {"C": "K*T*s"}, "line C: K*T*s, K*(1 + T*s)"),
    "another name for s is right": (
        "C/(m*q + b*p + k + C)",
        {"p": "s", "q": "s", "C": "K*(1 + T*s)"},
        "denominator: q, q^2",
    ),
}


@pytest.mark.parametrize("name", LINE_SLIPS)
def test_a_slip_is_blamed_on_the_line_that_has_it(name):
    expr, lines, expected = LINE_SLIPS[name]
    where = ", ".join(f'{line} = "{value}"' for line, value in lines.items())
    model = pipeline.loads(f'{LOOP}[published."X/r"]\nexpr = "{expr}"\nwhere = {{ {where} }}\n')
    (change,) = audit(model)[0].changes
    printed, derived = format_expression(change.printed), format_expression(change.derived)
    assert f"{change.place}: {printed}, {derived}" == expected


# A rod that a mass loads: X/F = tanh(g*l)/(E*A*g + m*s^2*tanh(g*l)), g = s/c; and a lag behind a delay.
ROD = """
symflex = 1
parameters = { E = "210 GPa", A = "1e-4 m^2", rho = "7800 kg/m^3", l = "0.7 m", m = "0.3 kg" }
inputs.F = { force = "x" }
outputs.X = "x"
elements.tip = { type = "mass", at = "x", m = "m" }
elements.rod = { type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }
[published."X/F"]
"""
LATE = """
symflex = 1
parameters = { K = 3, tau = "0.5 s", T = "0.2 s" }
blocks.D = { type = "delay", T = "T" }
inputs.F = {}
signals.x = "D*K/(tau*s + 1)*(F - x)"
outputs.X = "x"
[published."X/F"]
"""
SPEED = "s*sqrt(rho/E)"
CALL_SLIPS = [
    (ROD, "tanh(2*g*l)/(E*A*g + m*s^2*tanh(g*l))", SPEED, "numerator: tanh(2*g*l), tanh(g*l)"),
    (ROD, "tanh(g*l)/(E*A*g + m*s^2*tanh(g*l/2))", SPEED, "denominator: tanh(g*l/2), tanh(g*l)"),
    (ROD, "tanh(g*m)/(E*A*g + m*s^2*tanh(g*l))", SPEED, "numerator: tanh(g*m), tanh(g*l)"),
    (ROD, "tanh(g*l)/(E*A*g + m*s^2*tanh(g*l))", "s", "line g: s, s*sqrt(rho/E)"),
    (LATE, "K*exp(-T*s)/(tau*s + 1 + K)", "s", "denominator: K, K*exp(-T*s)"),
    (
        LATE,
        "K/(tau*s + 1 + K*exp(-T*s))",
        "s",
        "numerator: K/(tau*s + 1 + K*exp(-T*s)), K*exp(-T*s)/(tau*s + 1 + K*exp(-T*s))",
    ),
]


@pytest.mark.slow
def test_slips_in_arguments_wavenumbers_and_delays_are_found():
    for head, expr, line, expected in CALL_SLIPS:
        (found,) = audit(pipeline.loads(f"{head}expr = '{expr}'\nwhere = {{ g = '{line}' }}\n"))
        (change,) = found.changes
        printed, derived = format_expression(change.printed), format_expression(change.derived)
        assert f"{change.place}: {printed}, {derived}" == expected


def test_a_sign_under_a_root_is_found_where_it_is():
    expr = "1/(m*((s + b/(2*m))^2 + sqrt(k/m + (b/(2*m))^2)^2))"
    text = ISOLATOR.replace('"X/y"', '"X/F"').replace('y = { displacement = "y" }', 'F = { force = "x" }')
    text = text.replace('["x", "y"]', '["x", "ground"]')
    (found,) = audit(pipeline.loads(f"{text}expr = '{expr}'\n"))
    (change,) = found.changes
    assert format_expression(change.derived) == "sqrt(k/m - (b/(2*m))^2)"


CHAMBER = """symflex = 1
parameters = { rho = "1.2 kg/m^3", c = "343 m/s", S_1 = "1 m^2", S_2 = "5 m^2", S_3 = "2 m^2", L = "3 m" }
definitions = { Z_1 = "rho*c/S_1", Z_2 = "rho*c/S_2", Z_3 = "rho*c/S_3" }
inputs.p_i = { unit = "Pa" }
outputs.p_t = "p(L)"
[fields.chamber]
domain = ["0", "L"]
unknowns = ["p", "q"]
equations = ["p' = -rho*s/S_2*q", "q' = -S_2*s/(rho*c^2)*p"]
conditions = ["p(0) + Z_1*q(0) = 2*p_i", "p(L) = Z_3*q(L)"]
[published."p_t/p_i"]
expr = "2/(T_11*Z_1/Z_3 + T_12/Z_3 + Z_1*T_21 + T_22*Z_3/Z_1)"
where = { T_11 = "cosh(s*L/c)", T_12 = "Z_2*sinh(s*L/c)", T_21 = "sinh(s*L/c)/Z_2", T_22 = "cosh(s*L/c)" }
"""


@pytest.mark.slow
def test_a_repair_divides_no_name_by_itself():
    # Munjal, Acoustics of Ducts and Mufflers: 2/(T_11 + T_12/Z_3 + Z_1*T_21 + T_22*Z_1/Z_3), T_11 = T_22.
    for misprint in ("T_22*Z_3/Z_1", "T_22*Z_1/Z_2"):
        text = CHAMBER.replace("T_22*Z_3/Z_1", misprint)
        (found,) = audit(pipeline.loads(text))
        (change,) = found.changes
        sides = format_expression(change.printed), format_expression(change.derived)
        assert sides == (misprint, "T_22")


TWO_INERTIAS = """symflex = 1
parameters = { J_1 = "0.01 kg*m^2", J_2 = "0.02 kg*m^2", k = "500 N*m/rad", d = "0.4 N*m*s/rad" }
inputs.T = { torque = "a" }
outputs.W_2 = "s*b"
[elements]
first = { type = "inertia", at = "a", J = "J_1" }
second = { type = "inertia", at = "b", J = "J_2" }
shaft = { type = "torsion_spring", between = ["a", "b"], k = "k" }
losses = { type = "rotary_damper", between = ["a", "b"], b = "d" }
[published."W_2/T"]
"""
# The sum and the difference of J_1*s^2*a = T - (d*s + k)*(a - b) and J_2*s^2*b = (d*s + k)*(a - b) give
# W_2/T = (1 + d/k*s)/(J_1 + J_2)/s/(1 + d/k*s + J_1*J_2/(k*(J_1 + J_2))*s^2).
TURNED_RATIOS = [
    (
        "(1 + d/k*s)/((J_1 + J_2)*s)/(1 + d/k*s + (J_1 + J_2)/(k*J_1*J_2)*s^2)",
        "denominator: (J_1 + J_2)/(k*J_1*J_2), J_1*J_2/(k*(J_1 + J_2))",
    ),
    (
        "(1 + d/k*s)/((J_1 + J_2)*s)/(1 + d/k*s + (s*sqrt((J_1 + J_2)/(J_1*J_2*k)))^2)",
        "denominator: (J_1 + J_2)/(J_1*J_2*k), J_1*J_2/(k*(J_1 + J_2))",
    ),
    (
        "1/((J_1 + J_2)*s)*(1 + d/k*s + J_1*J_2/(k*(J_1 + J_2))*s^2)/(1 + d/k*s)",
        "numerator: 1/((J_1 + J_2)*s)*(1 + d/k*s + J_1*J_2/(k*(J_1 + J_2))*s^2)/(1 + d/k*s), "
        "(1 + d/k*s)/(s*(J_1 + J_2)*(1 + d/k*s + J_1*J_2/(k*(J_1 + J_2))*s^2))",
    ),
    (
        "(1 + d/k*s)/((J_1 + J_2)*s)/D', where.D = '1 + d/k*s + s^2*(J_1 + J_2)/(k*J_1*J_2)",
        "line D: 1 + d/k*s + s^2*(J_1 + J_2)/(k*J_1*J_2), 1 + d/k*s + s^2*J_1*J_2/(k*(J_1 + J_2))",
    ),
]


def test_a_ratio_turned_over_is_found_with_sums_among_its_factors():
    for expr, expected in TURNED_RATIOS:
        lines = f"expr = '{expr}'".replace(", where", "\nwhere")
        (change,) = audit(pipeline.loads(TWO_INERTIAS + lines))[0].changes
        printed, derived = format_expression(change.printed), format_expression(change.derived)
        assert f"{change.place}: {printed}, {derived}" == expected


OSCILLATOR = """symflex = 1
parameters = { m = "2 kg", c = "4 N*s/m", k = "800 N/m" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
damper = { type = "damper", between = ["x", "ground"], b = "c" }
[published."X/F"]
"""


@pytest.mark.parametrize(
    ("expr", "verdict", "numeric", "changes"),
    [
        ("0.5/(s^2 + 2*s + 400)", "equal", ("m", "c", "k"), []),
        ("1/(m*s^2 + 4*s + 800)", "equal", ("c", "k"), []),
        ("0.5/(s^2 + 2*s + 200)", "differs", ("m", "c", "k"), [("denominator", "200", "400")]),
        ("1/(2*s^2 - 4*s + k)", "differs", ("m", "c"), [("denominator", "-4*s", "4*s")]),
        ("1/(m*s^2 + k)", "differs", (), [("denominator", "0", "c*s")]),
        ("1/m/(s^2 + 2*c*s/m + k/m)", "differs", (), [("denominator", "2*c*s/m", "c*s/m")]),
        ("1/m/(s^2 + c*s/m + k/(3*m))", "differs", (), [("denominator", "k/(3*m)", "k/m")]),
    ],
)
def test_a_formula_with_numbers_is_compared_at_the_models_values(expr, verdict, numeric, changes):
    (found,) = audit(pipeline.loads(f"{OSCILLATOR}expr = '{expr}'\n"))
    said = [(c.place, format_expression(c.printed), format_expression(c.derived)) for c in found.changes]
    assert (found.verdict, found.numeric, said) == (verdict, numeric, changes)
