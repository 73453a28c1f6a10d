"""Values at rest are the solutions that declared values lead to, or are refused with those found elsewhere.

Expected values are roots of polynomials by numpy, closed forms, or roots by mpmath.
"""

import re

import mpmath
import numpy as np
import pytest

from symflex import loads as load
from symflex.cli import run
from symflex.errors import ModelError, SpecError
from symflex.pipeline import loads
from symflex.symbolic.routh import conditions

ACTUATOR = {  # k x = eps A V^2/(2 (d - x)^2), in three spellings
    "charge": (
        ["m*x'' + k*x = q^2/(2*eps*A)", "q*(d - x)/(eps*A) = u"],
        {"u": "V_0", "x": "x_0", "q": "eps*A*V_0/(d - x_0)"},
    ),
    "quotient": (["m*x'' + k*x = eps*A*u^2/(2*(d - x)^2)"], {"u": "V_0", "x": "x_0"}),
    "product": (["(m*x'' + k*x)*(d - x)^2 = eps*A*u^2/2"], {"u": "V_0", "x": "x_0"}),
}


def _text(parameters, unknowns, equations, rest, solve, inputs=("u",)):
    lines = ["symflex = 1", "[parameters]", *(f"{n} = {_value(v)}" for n, v in parameters.items())]
    lines += ["[inputs]", *(f"{name} = {{}}" for name in inputs), "[outputs]", f'Y = "{unknowns[0]}"']
    written = ", ".join(f'"{e}"' for e in equations)
    lines += ["[equations]", f"unknowns = {list(unknowns)}", f"equations = [{written}]"]
    lines += ["[operating_point]", *(f'"{n}" = "{v}"' for n, v in rest.items()), f"solve = {list(solve)}"]
    return "\n".join(lines)


def _value(value):
    if isinstance(value, str):
        return f'"{value}"'
    return value if value > 0 else f'{{ value = {value}, assume = "real" }}'


def _solved(text):
    """Return the values that are solved for, in the units that are declared."""
    return {v.name: float(v.value) for v in loads(text).operating_point.found}


def _refused(text):
    """Return the message of a refusal, and the values that it lists for each name."""
    with pytest.raises(SpecError) as refused:
        loads(text)
    (problem,) = refused.value.diagnostics
    assert problem.code == "SF407"
    listed = {}
    for name, value in re.findall(r"(\w+) = (-?[\d.]+(?:e-?\d+)?)", problem.message):
        listed.setdefault(name, []).append(float(value))
    return problem.message, listed


def _actuator(spelling, volts, x_0):
    equations, rest = ACTUATOR[spelling]
    unknowns = ["x", "q"][: len(equations)]
    values = {"m": "1e-9 kg", "k": "2 N/m", "d": "3 um", "A": "4e-8 m^2", "eps": "8.854e-12 F/m"}
    return _text({**values, "V_0": f"{volts} V", "x_0": f"{x_0} um"}, unknowns, equations, rest, ["x_0"])


def _gaps(volts):
    """Return all displacements in um at which forces balance, beyond the plate at 3 um too."""
    roots = np.roots([2, -12, 18, -8.854e-12 * 4e-8 * volts**2 / 2 * 1e18])
    return sorted(r.real for r in roots if abs(r.imag) < 1e-9)


@pytest.mark.parametrize("spelling", ACTUATOR)
@pytest.mark.parametrize(
    ("volts", "declared", "which"), [(6, 0.1, 0), (6, 0.7, 0), (6, 1.6, 1), (6.7, 0.5, 0)]
)
def test_an_actuator_rests_where_the_declared_value_leads(spelling, volts, declared, which):
    assert _solved(_actuator(spelling, volts, declared))["x_0"] == pytest.approx(
        _gaps(volts)[which], rel=1e-7
    )


@pytest.mark.parametrize("spelling", ACTUATOR)
@pytest.mark.parametrize(("volts", "declared"), [(6.73, 0.9), (8, 0.1), (8, 2.5), (20, 0.1)])
def test_beyond_pull_in_no_value_is_taken_and_the_one_beyond_the_plate_is_listed(spelling, volts, declared):
    message, listed = _refused(_actuator(spelling, volts, declared))
    (beyond,) = _gaps(volts)
    assert listed["x_0"] == [pytest.approx(beyond, rel=1e-5)]
    assert f"({beyond - declared:.4g}"[:5] in message


# fmt: off
# parameters but the declared one, equation in x and u, declared values, and what each is to give: a value, or
# None where solutions are to be listed
CURVES = {
    "a cubic with folds": (  # x^3 - x = f
        {"f": 0.1}, "x' - x + x^3 = u*f",
        {1.2: 1.0466805, -0.8: -0.9456493, 0.5: None, -0.1: -0.1010312}),
    "a cubic with one solution": ({"f": 0.5}, "x' - x + x^3 = u*f", {1: 1.1914879, 5: 1.1914879, 0.1: None,
                                                                     -0.9: None}),
    "a phase-locked loop": (  # asin 0.5, pi - asin 0.5, ...
        {}, "x' + 2*sin(x) = u", {0.3: mpmath.pi / 6, 1.5: mpmath.pi / 6, 2.4: 5 * mpmath.pi / 6,
                                  9: 17 * mpmath.pi / 6, -3: -7 * mpmath.pi / 6}),
    "a phase-locked loop out of lock": ({}, "x' + 2*sin(x) = 3*u", {0.3: None, 2: None}),
    "slip of a motor": (  # s/(s^2 + 0.04) = 2.2, then 1
        {"a": 0.2, "M": 2.2}, "x' + x/(x^2 + a^2) = u*M", {0.02: 0.1193242, 0.15: 0.1193242, 0.5: 0.3352214}),
    "slip of a motor, past the other": (
        {"a": 0.2, "M": 1.0}, "x' + x/(x^2 + a^2) = u*M", {0.1: 0.0417424, 0.9: 0.9582576, 0.25: None}),
    "radiation": (
        {"P": 500}, "x' = u*P - 2.5515e-9*(x^4 - 300^4) - 0.5*(x - 300)",
        {300: 614.360512, 800: 614.360512, 1500: 614.360512}),
}
# fmt: on


@pytest.mark.parametrize("name", CURVES)
def test_a_value_on_a_curve_with_folds_is_that_between_the_same_folds(name):
    values, equation, expected = CURVES[name]
    for declared, value in expected.items():
        text = _text({**values, "x_0": declared}, ["x"], [equation], {"x": "x_0", "u": "1"}, ["x_0"])
        if value is not None:
            assert _solved(text)["x_0"] == pytest.approx(float(value), rel=1e-6), declared
        else:
            assert "found elsewhere" in (message := _refused(text)[0]) or "is in doubt" in message, declared


def test_of_several_solutions_a_message_lists_the_nearest_first():
    # x (x - 1)(x - 3) = 0.5 turns at (4 + sqrt(7))/3.
    text = _text(
        {"x_0": 2.2152504370215302}, ["x"], ["x' + x*(x - 1)*(x - 3) = u"], {"x": "x_0", "u": 0.5}, ["x_0"]
    )
    roots = sorted(np.roots([1, -4, 3, -0.5]).real, key=lambda x: abs(x - 2.2152504))
    assert _refused(text)[1]["x_0"] == pytest.approx(roots, rel=1e-5)


SWITCH = ["x' = a*u/(1 + y^2) - x", "y' = a/(1 + x^2) - y"]


def test_values_that_depend_on_each_other_are_followed_together():
    def text(x_0, y_0):
        values = {"a": 4, "x_0": x_0, "y_0": y_0}
        return _text(values, ["x", "y"], SWITCH, {"x": "x_0", "y": "y_0", "u": "1"}, ["x_0", "y_0"])

    # x y = 1 and x + y = 4, or x = y with x^3 + x = 4.
    for start, end in (((3, 0.2), (2 + 3**0.5, 2 - 3**0.5)), ((1, 2), (1.3787967, 1.3787967))):
        assert list(_solved(text(*start)).values()) == pytest.approx(end, rel=1e-7)
    _, listed = _refused(text(5, 5))  # between two that mirror each other
    assert sorted(listed["x_0"]) == pytest.approx([2 - 3**0.5, 1.3787967, 2 + 3**0.5], rel=1e-5)


def test_another_solution_brings_doubt_where_no_unknown_is_farther_from_its_declared_value():
    def text(equations, x_0, y_0, **values):
        rest = {"x": "x_0", "y": "y_0", "u": "1"}
        return _text(values | {"x_0": x_0, "y_0": y_0}, ["x", "y"], equations, rest, ["x_0", "y_0"])

    # x = 1, and y turns at 1 between 0.811 and 1.177, which are as far as 0.994; x may be declared as it is.
    fold = ["x' + x^3 + x = 2*u", "y' + y^3 - 3*y = -1.9*u"]
    one, other = sorted(np.roots([1, 0, -3, 1.9]).real)[1:]
    for x_0 in (1, 1.1):
        message, listed = _refused(text(fold, x_0, (one + other) / 2 + 1e-4))
        assert "is in doubt" in message
        assert listed["y_0"] == pytest.approx([one, other], rel=1e-5)
        assert _solved(text(fold, x_0, (one + other) / 2 - 1e-4))["y_0"] == pytest.approx(one)
    # x = y = 1.379 is nearer in x alone.
    assert list(_solved(text(SWITCH, 2.5, 0.3, a=4)).values()) == pytest.approx([2 + 3**0.5, 2 - 3**0.5])


def test_a_formula_of_one_value_is_put_into_the_equations_of_others():
    # y = 2 x and x^3 - 5 x + y = 0.1: x turns at 1, and for a y that stays it would at 1.29.
    equations = ["x' + x^3 - 5*x + y = 0.1*u", "y' + y = 2*x"]
    rest = {"x": "x_0", "y": "y_0", "u": "1"}
    text = _text({"x_0": 1.1, "y_0": 2}, ["x", "y"], equations, rest, ["x_0", "y_0"])
    x = max(np.roots([1, 0, -3, -0.1]).real)
    assert _solved(text) == {"x_0": pytest.approx(x), "y_0": pytest.approx(2 * x)}


def test_of_several_values_each_that_is_assumed_positive_has_to_be():
    # y + y^3 = 2 + x^3 and x + x^3 = -y^3: x < 0 < y
    equations = ["x' + x + x^3 + y^3 = 0", "y' + y + y^3 - x^3 = 2*u"]
    text = _text(
        {"x_0": 0.1, "y_0": 1}, ["x", "y"], equations, {"x": "x_0", "y": "y_0", "u": "1"}, ["x_0", "y_0"]
    )
    message, listed = _refused(text)
    assert "is assumed positive, but leads to" in message
    assert message.endswith("found elsewhere: none")
    with mpmath.workdps(20):
        x, y = mpmath.findroot(lambda x, y: (x + x**3 + y**3, y + y**3 - x**3 - 2), (-0.6, 0.9))
    assert (listed["x_0"] + listed["y_0"]) == pytest.approx([float(x), float(y)], rel=1e-5)
    real = text.replace("x_0 = 0.1", 'x_0 = { value = 0.1, assume = "real" }')
    assert _solved(real) == {"x_0": pytest.approx(float(x)), "y_0": pytest.approx(float(y))}


def test_power_flow_is_refused_beyond_its_limit_and_solved_below():
    equations = ["T*x' = P*u - y*sin(x)/X", "T*y' = (y*cos(x) - y^2)/X - Q"]

    def text(power, reactive):
        values = {"T": 1, "P": power, "Q": reactive, "X": 0.25, "x_0": 0.3, "y_0": 0.95}
        return _text(values, ["x", "y"], equations, {"x": "x_0", "y": "y_0", "u": "1"}, ["x_0", "y_0"])

    # y^4 + (2 Q X - 1) y^2 + X^2 (P^2 + Q^2) = 0, and tan x = P X/(Q X + y^2).
    square = max(np.roots([1, 2 * 0.05 - 1, 0.0625 * (0.64 + 0.04)]).real)
    assert _solved(text(0.8, 0.2))["y_0"] == pytest.approx(square**0.5, rel=1e-12)
    assert _solved(text(0.8, 0.2))["x_0"] == pytest.approx(np.arctan(0.2 / (0.05 + square)), rel=1e-12)
    assert _refused(text(2.2, 0.8))[1] == {}


def test_a_value_that_is_assumed_positive_does_not_become_zero_or_negative():
    text = _text({"k": 0.2, "w": 0.6, "x_0": 0.3}, ["x"], ["x'' + k*x - w*sin(x) = u"], {"x": "x_0"}, ["x_0"])
    message, listed = _refused(text)
    assert "assumed positive" in message
    assert listed["x_0"] == [0, pytest.approx(2.2788627, rel=1e-5)]  # mpmath.findroot of 0.2 q = 0.6 sin q
    assert _solved(text.replace("x_0 = 0.3", 'x_0 = { value = 0.3, assume = "real" }'))["x_0"] == 0


TANK = {"A": 2, "a": 0.001, "g": 9.81, "q_0": 0.005, "w_0": 0.001}


def _tank(**values):
    rest = {"q": "q_0", "w": "w_0"}
    return _text(TANK | values, ["h"], ["A*h' = q - w - a*sqrt(2*g*h)"], rest, ["h"], ["q", "w"])


def test_a_root_that_has_one_sign_near_the_declared_values_is_solved_there_alone():
    # Torricelli: sqrt(2 g h) = (q - w)/a while q > w
    assert _solved(_tank())["h_0"] == pytest.approx((4**2) / (2 * 9.81), rel=1e-12)
    for w_0 in (0.006, 0.5):
        assert _refused(_tank(w_0=w_0))[1] == {}
    for name in ("q_0", "w_0"):
        with pytest.raises(ModelError, match="would not follow it"):
            load(_tank()).stability(over=name)
    assert load(_tank()).stability(over="g").certified
    given = _text(TANK, ["h"], ["A*h' = q - w - a*sqrt(2*g*h)"],
                  {"q": "q_0", "w": "w_0", "h": "((q_0 - w_0)/a)^2/(2*g)"}, [], ["q", "w"])  # fmt: skip
    assert "h" in dict(loads(given).operating_point.values)
    assert _refused(given.replace("w_0 = 0.001", "w_0 = 0.006"))


def test_tanks_that_act_on_each_other_rest_where_all_that_comes_in_goes_out():
    # Torricelli twice: sqrt(2 g (h_1 - h_2)) = q/a and sqrt(2 g h_2) = (q - w)/a
    values = {"A": 1, "a": 5e-4, "g": 9.81, "q_0": 2e-3, "w_0": 5e-4}
    equations = ["A*h1' = q - a*sqrt(2*g*(h1 - h2))", "A*h2' = a*sqrt(2*g*(h1 - h2)) - w - a*sqrt(2*g*h2)"]
    text = _text(values, ["h1", "h2"], equations, {"q": "q_0", "w": "w_0"}, ["h1", "h2"], ["q", "w"])
    assert _solved(text) == {"h1_0": pytest.approx(25 / 19.62), "h2_0": pytest.approx(9 / 19.62)}
    # slopes a g/sqrt(...) = a^2 g/q and a^2 g/(q - w)
    one, two = 2.5e-7 * 9.81 / 2e-3, 2.5e-7 * 9.81 / 1.5e-3
    found = load(text).transfer_function("Y/q").bind().poles()
    expected = np.linalg.eigvals([[-one, one], [one, -one - two]])
    assert sorted(complex(p).real for p in found) == pytest.approx(sorted(expected), rel=1e-9)


def test_a_square_that_is_solved_for_is_not_followed_to_where_it_is_negative():
    # C i^2/x^2 = m g - F: no current holds the ball against F > m g = 0.4905
    values = {"m": 0.05, "g": 9.81, "C": 1e-4, "x_0": 0.01, "F_0": 0.2, "R": 2}
    equations = ["m*x'' = m*g - F - C*i^2/x^2", "i' + R*i = u"]
    text = _text(values, ["x", "i"], equations, {"x": "x_0", "F": "F_0"}, ["i", "u"], ["u", "F"])
    assert _solved(text)["i_0"] == pytest.approx((0.2905 / 1e-4) ** 0.5 * 0.01)
    with pytest.raises(ModelError, match="would not follow it"):
        load(text).stability(over="F_0")
    assert load(text).stability(over="x_0").certified
    with pytest.raises(SpecError, match="has no value at the operating point") as refused:
        loads(text.replace("F_0 = 0.2", "F_0 = 0.6"))
    assert refused.value.diagnostics[0].hint == "correct the values of parameters"
    # In symbols the poles are on the axis for F > m g, where i_0 is imaginary: the condition says that.
    assert str(conditions(loads(text))).endswith("where i_0 = sqrt(-(-m*g + F_0)*x_0^2/C) is real")


@pytest.mark.parametrize(
    ("value", "hint"), [("tank_O", "did you mean 'tank_0'?"), ("2*x", "known names: tank_0, u_0")]
)
def test_values_at_rest_that_are_no_constants_are_refused_at_their_place(value, hint):
    with pytest.raises(SpecError, match="values at equilibrium are constant") as refused:
        loads(_text({"tank_0": 2}, ["x"], ["x' + x^2 = u"], {"x": value, "u": 4}, []))
    (problem,) = refused.value.diagnostics
    assert (problem.code, problem.hint) == ("SF210", hint)
    assert problem.span is not None


def test_formulas_have_what_a_function_is_at_rest_in_its_place():
    # A h' = q - w - a sqrt(2 g h): the slope is a g/sqrt(2 g h) = a^2 g/(q - w).
    tf = load(_tank()).transfer_function("Y/q")
    assert "sqrt" not in str(tf)
    assert complex(tf.bind()(0)) == pytest.approx(0.004 / (0.001**2 * 9.81))


CHEMOSTAT = ["X' = m*S/(k + S)*X - D*X", "S' = D*(f - S) - m*S/(k + S)*X/Y"]
CULTURE = {"m": 0.2, "k": 1, "Y": 0.5, "f": 10, "D_0": 0.1}


@pytest.mark.parametrize(
    ("X_0", "S_0", "end"),
    [
        ('{ value = 4, assume = "real" }', 1.2, (4.5, 1)),
        ('{ value = 0.1, assume = "real" }', 9.9, (0, 10)),
        ('{ value = 0, assume = "nonnegative" }', 10, (0, 10)),
        ("0.1", 9.9, (4.5, 1)),  # positive, so it cannot wash out
    ],
)
def test_a_factor_that_may_vanish_is_not_divided_by(X_0, S_0, end):
    # mu(S) = D at S = k D/(m - D) = 1, where X = Y (f - S); or X = 0, where the feed passes through
    rest = {"D": "D_0", "X": "X_0", "S": "S_0"}
    text = _text({**CULTURE, "S_0": S_0}, ["X", "S"], CHEMOSTAT, rest, ["X_0", "S_0"], ["D"])
    text = text.replace("[parameters]", f"[parameters]\nX_0 = {X_0}")
    found = _solved(text)
    assert (found["X_0"], found["S_0"]) == pytest.approx(end, abs=1e-12)


def test_an_equation_that_holds_for_every_value_leaves_it_to_another():
    # mu(S) = D holds, so the first equation says nothing of X, and the second X = Y (f - S) = 4.5.
    rest = {"D": "D_0", "S": "k*D_0/(m - D_0)"}
    text = _text(CULTURE, ["X", "S"], CHEMOSTAT, rest, ["X"], ["D"])
    assert _solved(text)["X_0"] == pytest.approx(4.5, rel=1e-12)


def test_what_has_no_declared_value_and_no_formula_is_refused_with_what_is_found():
    text = _text({}, ["x"], ["x' + x + x^3 = u"], {"u": "10"}, ["x"])
    assert _refused(text)[1]["x_0"] == [pytest.approx(2)]
    text = _text({"k": 2}, ["x"], ["x' + k*x + x^3 = u"], {"u": "3"}, ["x"])
    assert _refused(text)[0].endswith("no value is declared; found: x_0 = 1")
    assert _refused(text.replace("k = 2", "k = {}"))[0].endswith("no value is declared")


FORMULAS = {  # equation, value of u, solution for x
    "x' + k*sqrt(x) = u": (6, 9),
    "x' + k*exp(x) = u": (6, float(mpmath.log(3))),
    "x' + k*log(x) + 1 = u": (6, float(mpmath.exp(2.5))),
    "x' + k*sqrt(x + 2) = u": (6, 7),
    "x' + k/sqrt(x) = u": (4, 0.25),
}


@pytest.mark.parametrize("equation", FORMULAS)
def test_the_argument_of_one_function_is_found_by_its_inverse(equation):
    given, expected = FORMULAS[equation]
    text = _text({"k": 2, "u_0": given}, ["x"], [equation], {"u": "u_0"}, ["x"])
    assert _solved(text) == {"x_0": pytest.approx(expected, rel=1e-14)}


@pytest.mark.parametrize(
    ("equation", "rest", "expected"),
    [
        ("x' + abs(x - 2) = u", {"x": 1, "u": 1}, -1),
        ("x' + abs(2 - x) = u", {"x": 1, "u": 1}, -1),
        ("x' + sgn(x)*x^2 = u", {"x": -1, "u": -1}, 2),
        ("x' + abs(exp(x)) = u", {"x": -1}, np.exp(-1)),
        ("x' + abs(cosh(x)) = u", {"x": -1}, -np.sinh(1)),
        ("x' + x*abs(x) = u", {"x": "-w"}, 6),
        ("x' + abs(x)^1.5 = u", {"x": -4, "u": 8}, -3),
        ("x' + abs(abs(x) - 3) = u", {"x": -1}, 1),
        ("x' + 2*sgn(x) + x = u", {"x": -4}, 1),
        ("x' + sgn(x - 5)*sqrt(abs(x - 5)) = u", {"x": 1}, 0.25),
        ("x' + abs(sin(x)) = u", {"x": 4}, -np.cos(4)),
        ("x' + abs(atan(x)) = u", {"x": -1}, -0.5),
        ("x' + abs(x - w) = u", {"x": 1}, -1),
        ("x' + x*atan(w) + x^2 = u", {"x": 1}, 2 + np.arctan(3)),
        ("x' + atan(x) = u", {"x": 1}, 0.5),
    ],
)
def test_abs_sgn_and_atan_are_read_at_rest(equation, rest, expected):
    solve = [] if "u" in rest else ["u"]
    text = _text({"w": 3}, ["x"], [equation], rest, solve)
    assert 1 / complex(load(text).transfer_function("Y/u").bind()(0)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("declared", "force", "expected"),
    [(-3, -4, -2), (3, 4, 1)],  # b v + c abs(v) = F, b = 3, c = 1
)
def test_signs_hold_at_the_solution(declared, force, expected):
    values = {"v_0": declared, "F": force}
    text = _text(values, ["v"], ["v' + 3*v + abs(v) = u"], {"v": "v_0", "u": "F"}, ["v_0"])
    assert _solved(text)["v_0"] == pytest.approx(expected)
    values |= {"v_0": -declared}
    text = _text(values, ["v"], ["v' + 3*v + abs(v) = u"], {"v": "v_0", "u": "F"}, ["v_0"])
    with pytest.raises(SpecError, match="SF407"):
        loads(text)


FOUR_BAR = """symflex = 1
parameters = { J = 0.1, k = 3, p = 0.4, q = 1 }
inputs  = { T = {} }
outputs = { A = "a" }
[energy]
coordinates = ["a", "b", "c"]
kinetic     = "J*a'^2/2 + J*b'^2/2 + J*c'^2"
potential   = "k*b^2/2"
forces      = { a = "T" }
constraints = ["p*cos(a) + q*cos(b) - p*cos(c) = q", "p*sin(a) + q*sin(b) - p*sin(c) = 0"]
[operating_point]
a = "ANGLE"
b = 0
c = "ANGLE"
"""


def test_a_singular_configuration_is_called_one():
    with pytest.raises(SpecError, match="singular configuration") as refused:
        loads(FOUR_BAR.replace("ANGLE", "0"))
    assert [d.code for d in refused.value.diagnostics] == ["SF407"]
    loads(FOUR_BAR.replace("ANGLE", "30 deg"))


@pytest.mark.parametrize(
    ("coordinates", "constraints", "rest"),
    [
        (["x", "y"], ["x^2 + y^2 = 0"], {"y": 0}),  # a circle without a radius
        (["x", "y"], ["x^2 + y^2 = r^2", "2*x^2 + 2*y^2 = 2*r^2"], {"y": "-r"}),  # twice the same
        (
            ["x", "a", "b"],
            ["x = r*cos(a) + r*cos(b)", "sin(a) = sin(b)"],
            {"a": "pi/2", "b": "pi/2"},
        ),  # a crank
    ],
)
def test_dependent_constraints_are_called_singular_whatever_else_is_wrong(coordinates, constraints, rest):
    lines = ["symflex = 1", "parameters = { m = 1, g = 9.81, r = 2 }", "inputs = { F = {} }"]
    lines += ['outputs = { X = "x" }', "[energy]", f"coordinates = {coordinates}"]
    energy = " + ".join(f"m*{q}'^2" for q in coordinates)
    lines += [f'kinetic = "{energy}"', 'forces = { x = "F" }']
    lines += ['potential = "m*g*y"'] if "y" in coordinates else []
    lines += [f"constraints = {constraints}", "[operating_point]", *(f'{q} = "{v}"' for q, v in rest.items())]
    with pytest.raises(SpecError, match="singular configuration"):
        loads("\n".join(lines))


@pytest.mark.parametrize("zero", ["0", "(1 - 1)", "(k - k)", "sin(0)", "(0*m)"])
@pytest.mark.parametrize(
    "part",
    ["kinetic = \"m*x'^2/ZERO\"", 'potential = "k*x^2/ZERO"', "dissipation = \"x'^2/ZERO\"",
     "kinetic = \"(x/ZERO)'^2\"", 'forces = { x = "F/ZERO" }', 'constraints = ["x/ZERO = 1"]',
     'potential = "k*cos(x*ZERO^-1)"'],
)  # fmt: skip
def test_division_by_zero_in_an_energy_has_its_place(part, zero):
    text = (
        'symflex = 1\nparameters = { m = 2, k = 3 }\ninputs = { F = {} }\noutputs = { X = "x" }\n[energy]\n'
    )
    with pytest.raises(SpecError, match="division by zero") as refused:
        loads(f'{text}coordinates = ["x"]\n{part.replace("ZERO", zero)}')
    (problem,) = refused.value.diagnostics
    assert problem.code == "SF224"
    assert problem.span.text == zero.removeprefix("(").removesuffix(")" * zero.startswith("("))


@pytest.mark.parametrize(
    ("equation", "value"), [("x' + x^2/0 = u", "1"), ("x' + x^2 = u", "k/0"), ("x' + x/(x - k) = u", "3")]
)
def test_division_by_zero_at_rest_has_its_place(equation, value):
    with pytest.raises(SpecError, match=r"division by zero|denominator") as refused:
        loads(_text({"k": 3}, ["x"], [equation], {"x": value}, ["u"]))
    assert refused.value.diagnostics[0].code == "SF224"


def test_commands_print_the_values_that_were_found_beside_the_declared_ones(tmp_path, capsys):
    path = tmp_path / "actuator.toml"
    path.write_text(_actuator("charge", 6, 0.1))
    for command in ("check", "derive", "roots"):
        assert run([command, str(path)]) == 0
        out = capsys.readouterr().out
        assert "solved at equilibrium: x_0 = 0.516996 um (radius 6.0e-9 um, declared 0.1 um)" in out, command
        assert run([command, str(path), "--json"]) == 0
        out = capsys.readouterr().out
        assert '"declared": "0.1"' in out, command
        assert f'"value": "{_gaps(6)[0]:.8f}' in out, command


def test_formulas_keep_numbers_at_rest_as_names_that_can_be_set():
    text = _text({"k": 3}, ["x"], ["x' + k*x^2 = u"], {"x": "2"}, ["u"])
    assert str(load(text).transfer_function("Y/u")) == "Y/u = 1/(s + 2*k*x_0)"
    moved = load(text, values={"x_0": "5"}).transfer_function("Y/u").bind()
    assert complex(moved(0)) == pytest.approx(1 / 30)


def test_what_has_no_declared_value_follows_from_what_has_one():
    """A slider-crank on a spring: the torque that holds it is dV/dtheta, V = k (x - c)^2/2."""
    model = load(
        """
        symflex = 1
        parameters = { r = 0.06, l = 0.2, k = 8e3, c = 0.2, theta_0 = "50 deg", beta_0 = "13 deg", x_0 = 0.2 }
        inputs = { T = {} }
        outputs = { angle = "theta" }
        [energy]
        coordinates = ["theta", "beta", "x"]
        kinetic = "x'^2/2"
        potential = "k*(x - c)^2/2"
        constraints = ["r*cos(theta) + l*cos(beta) = x", "r*sin(theta) = l*sin(beta)"]
        forces = { theta = "T" }
        [operating_point]
        theta = "theta_0"
        beta = "beta_0"
        x = "x_0"
        T = "T_0"
        solve = ["beta_0", "x_0", "T_0"]
        """
    )
    found = {v.name: float(v.value) for v in model.resolved.operating_point.found}
    theta = np.radians(50)
    beta = np.arcsin(0.3 * np.sin(theta))
    x = 0.06 * np.cos(theta) + 0.2 * np.cos(beta)
    slope = -0.06 * np.sin(theta) - 0.06 * np.cos(theta) * np.tan(beta)
    expected = {"beta_0": np.degrees(beta), "x_0": x, "T_0": 8000 * (x - 0.2) * slope}
    assert {n: found[n] for n in expected} == pytest.approx(expected, rel=1e-10)


def test_a_value_without_a_unit_is_printed_without_one(tmp_path, capsys):
    path = tmp_path / "joint.toml"
    path.write_text(
        "symflex = 1\nparameters = { k = '4 N*m', w = '2 N*m', J = '1 kg*m^2', a = '30 deg' }\n"
        "inputs = { r = { unit = '1' } }\noutputs = { Q = 'q' }\n"
        "[equations]\nunknowns = ['q']\nequations = [\"J*q'' + k*q + w*cos(q) = k*r\"]\n"
        "[operating_point]\nq = 'a'\nsolve = ['r']\n"
    )
    assert run(["check", str(path)]) == 0
    # r_0 = a + w cos(a)/k
    assert "solved at equilibrium: r_0 = 0.956611 (radius 4.8e-7)" in capsys.readouterr().out
