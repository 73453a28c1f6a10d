"""Symbolic conditions, against numpy's roots of characteristic polynomials that were written by hand."""

import json

import numpy as np
import pytest
import sympy

import symflex
from symflex import pipeline
from symflex.errors import SymflexError
from symflex.symbolic.routh import conditions_of
from tests.independent import eppinger1988

# The letters, the loop that is closed, and its characteristic polynomial.
LOOPS = (
    ("K T_i T", "K*(1 + 1/(T_i*s))/(T*s + 1)", "T_i*s*(T*s + 1) + K*(T_i*s + 1)"),
    ("K T_1 T_2", "K/(s*(T_1*s + 1)*(T_2*s + 1))", "s*(T_1*s + 1)*(T_2*s + 1) + K"),
    ("K T_1 T_2 T_3", "K/((T_1*s + 1)*(T_2*s + 1)*(T_3*s + 1))", "(T_1*s + 1)*(T_2*s + 1)*(T_3*s + 1) + K"),
    ("K T", "K/(T*s + 1)^4", "(T*s + 1)**4 + K"),
    ("K T", "K/(T*s + 1)^6", "(T*s + 1)**6 + K"),
    (
        "K K_i K_d T_1 T_2",
        "(K + K_i/s + K_d*s)/((T_1*s + 1)*(T_2*s + 1))",
        "s*(T_1*s + 1)*(T_2*s + 1) + K*s + K_i + K_d*s**2",
    ),
    ("m K K_i K_d", "(K + K_i/s + K_d*s)/(m*s^2)", "m*s**3 + K_d*s**2 + K*s + K_i"),
    (
        "m b k K K_i K_d",
        "(K + K_i/s + K_d*s)/(m*s^2 + b*s + k)",
        "s*(m*s**2 + b*s + k) + K_d*s**2 + K*s + K_i",
    ),
    ("J b K K_i", "(K + K_i/s)/(J*s^2 + b*s)", "s*(J*s**2 + b*s) + K*s + K_i"),
    ("J b K T", "K/((J*s^2 + b*s)*(T*s + 1))", "(J*s**2 + b*s)*(T*s + 1) + K"),
    ("K T a", "K*(T*s + 1)/(s^2*(a*s + 1))", "s**2*(a*s + 1) + K*(T*s + 1)"),
    ("K T", "K/(T*s - 1)", "T*s - 1 + K"),
    ("K T T_i", "K*(1 + 1/(T_i*s))/(T*s - 1)", "T_i*s*(T*s - 1) + K*(T_i*s + 1)"),
    ("K T T_1", "K/((T*s - 1)*(T_1*s + 1))", "(T*s - 1)*(T_1*s + 1) + K"),
    ("K T a", "K*(1 - a*s)/(T*s + 1)^2", "(T*s + 1)**2 + K*(1 - a*s)"),
    ("K T a", "K*(1 - a*s)/(s*(T*s + 1))", "s*(T*s + 1) + K*(1 - a*s)"),
    ("J m g l K K_d", "(K + K_d*s)/(J*s^2 - m*g*l)", "J*s**2 - m*g*l + K + K_d*s"),
    ("J m g l K K_d T", "(K + K_d*s)/((J*s^2 - m*g*l)*(T*s + 1))", "(J*s**2 - m*g*l)*(T*s + 1) + K + K_d*s"),
    ("J c K K_i K_d", "(K + K_i/s + K_d*s)/(J*s^2 - c)", "s*(J*s**2 - c) + K*s + K_i + K_d*s**2"),
    ("m k_x k_i K K_d", "k_i*(K + K_d*s)/(m*s^2 - k_x)", "m*s**2 - k_x + k_i*(K + K_d*s)"),
    (
        "m k_x k_i K K_d L R",
        "k_i*(K + K_d*s)/((m*s^2 - k_x)*(L*s + R))",
        "(m*s**2 - k_x)*(L*s + R) + k_i*(K + K_d*s)",
    ),
    ("m k K", "K/(m*s^2 + k)", "m*s**2 + k + K"),
    ("m k K", "K/(s*(m*s^2 + k))", "s*(m*s**2 + k) + K"),
    ("m b k K", "K/(s*(m*s^2 + b*s + k))", "s*(m*s**2 + b*s + k) + K"),
    ("m b k K T", "K/((m*s^2 + b*s + k)*(T*s + 1))", "(m*s**2 + b*s + k)*(T*s + 1) + K"),
    ("m b k K T", "K*(b*s + k)/((m*s^2 + b*s + k)*(T*s + 1))", "(m*s**2 + b*s + k)*(T*s + 1) + K*(b*s + k)"),
    ("m b k K", "K*(b*s + k)/(s*(m*s^2 + b*s + k))", "s*(m*s**2 + b*s + k) + K*(b*s + k)"),
    (
        "w z g",
        "-g*w^2/(s^2 + 2*z*w*s + w^2)*w^2/(s^2 + w^2)",
        "(s**2 + 2*z*w*s + w**2)*(s**2 + w**2) - g*w**4",
    ),
    (
        "m b K T",
        "-K*s/((m*s^2 + b*s)*(T*s + 1))*(m*s^2 + b*s)/(m*s^2 + b*s + m)",
        "(T*s + 1)*(m*s**2 + b*s + m) - K*s",
    ),
    ("K K_d K_2", "(K + K_d*s + K_2*s^2)/s^3", "s**3 + K_2*s**2 + K_d*s + K"),
    ("J K_p K_v T", "K_v*(K_p + s)/(J*s^2*(T*s + 1))", "J*s**2*(T*s + 1) + K_v*(K_p + s)"),
    (
        "J K_p K_v T_i T",
        "K_v*(1 + 1/(T_i*s))*(K_p + s)/(J*s^2*(T*s + 1))",
        "T_i*J*s**3*(T*s + 1) + K_v*(T_i*s + 1)*(K_p + s)",
    ),
    ("K T", "K/(s^3*(T*s + 1))", "s**3*(T*s + 1) + K"),
    ("K T b", "-K/(T*s^2 + b*s + 1)", "T*s**2 + b*s + 1 - K"),
    (
        "K T_i T_1 T_f",
        "K*(1 + 1/(T_i*s))/((T_1*s + 1)*(T_f*s + 1))",
        "T_i*s*(T_1*s + 1)*(T_f*s + 1) + K*(T_i*s + 1)",
    ),
)
DRIVE = {
    "a": {"type": "mass", "at": "x", "m": "m_1"},
    "b": {"type": "mass", "at": "y", "m": "m_2"},
    "shaft": {"type": "spring", "between": ["x", "y"], "k": "k"},
}
LOSS = {"loss": {"type": "damper", "between": ["x", "y"], "b": "b"}}
CAR = {
    "tyre": {"type": "spring", "between": ["x", "ground"], "k": "k_t"},
    "wheel": {"type": "mass", "at": "x", "m": "m_1"},
    "strut": {"type": "spring", "between": ["x", "y"], "k": "k"},
    "damper": {"type": "damper", "between": ["x", "y"], "b": "b"},
    "body": {"type": "mass", "at": "y", "m": "m_2"},
}
X, Y = "(m_1*s**2 + b*s + k)", "(m_2*s**2 + b*s + k)"
STIFF_X, STIFF_Y = "(m_1*s**2 + k)", "(m_2*s**2 + k)"
PD = "(K + K_d*s)"
# The letters, the elements, the force on x and the characteristic polynomial.
MACHINES = (
    ("m_1 m_2 k", DRIVE, "0", "s**2*(m_1*m_2*s**2 + k*(m_1 + m_2))"),
    ("m_1 m_2 k K K_d", DRIVE, f"-{PD}*x", f"({STIFF_X} + {PD})*{STIFF_Y} - k**2"),
    ("m_1 m_2 k K K_d", DRIVE, f"-{PD}*y", f"{STIFF_X}*{STIFF_Y} - k**2 + k*{PD}"),
    ("m_1 m_2 k b K K_d", DRIVE | LOSS, f"-{PD}*y", f"{X}*{Y} - (b*s + k)**2 + (b*s + k)*{PD}"),
    (
        "m_1 m_2 k K K_i K_d",
        DRIVE,
        "-(K + K_i/s + K_d*s)*x",
        f"s*({STIFF_X}*{STIFF_Y} - k**2) + (K*s + K_i + K_d*s**2)*{STIFF_Y}",
    ),
    ("m_1 m_2 k k_t b", CAR, "0", f"({X} + k_t)*{Y} - (b*s + k)**2"),
)


def model_of(letters, **tables):
    return symflex.Model(parameters={n: {} for n in letters.split()}, **tables)


def models():
    for letters, loop, polynomial in LOOPS:
        signals = {"y": f"({loop})*(r - y)"}
        yield model_of(letters, signals=signals, inputs={"r": {}}, outputs={"Y": "y"}), letters, polynomial
    for letters, elements, force, polynomial in MACHINES:
        driven = {"drive": {"type": "force_source", "at": "x", "f": f"F + {force}"}}
        tables = {"elements": elements | driven, "inputs": {"F": {}}, "outputs": {"X": "y"}}
        yield model_of(letters, **tables), letters, polynomial


def met(found, values):
    """Whether the printed conditions hold."""
    texts = [str(c).replace("^", "**") for c in found.conditions]
    return all(eval(text, dict(values)) for text in texts)  # noqa: S307 (ours)


@pytest.mark.slow
def test_conditions_of_40_models_hold_exactly_where_all_roots_lie_left_of_the_axis():
    random, s, count = np.random.default_rng(58), np.poly1d([1, 0]), 0
    for model, letters, polynomial in models():
        found = model.conditions()
        for _ in range(1000):
            values = {n: 10 ** random.uniform(-1, 1) for n in letters.split()}
            roots = np.roots(eval(polynomial, {"s": s, **values}).coeffs)  # noqa: S307 (ours)
            # Next to the axis doubles decide nothing; roots that stay on it are told of.
            right, near = roots.real.max(), 1e-6 * abs(roots).max()
            if found.on_axis or abs(right) > near:
                count += 1
                assert met(found, values) == bool(right < (near if found.on_axis else 0)), (
                    polynomial,
                    values,
                )
    assert count > 0.99 * 40 * 1000


@pytest.mark.parametrize(
    ("num", "expected"),
    [
        # Routh's array by hand; the coefficient of s^2 follows from the determinant and is left out.
        ("m*s^3 + b*s^2 + (k + K)*s + I", ["b*(k + K) > m*I"]),
        ("(a*s + b)*(b*s + c)", []),
        ("a*s^2 + b*s + R", ["R > 0"]),
        ("(a - b)*s^2 + c", ["a > b"]),  # else a pair on the real axis
        ("R*s^2 + b*s - R", ["0 > 1"]),  # R > 0 and -R > 0: never
        ("a*s^4 + b*s^2 + c", ["b^2 > 4*a*c"]),  # the discriminant in s^2
        ("(s + R)^2 + a", ["R > 0"]),
        ("(a - b)^2*s + c", ["a != b"]),
        ("a*s^3 + b*s + c", ["0 > a*c"]),  # a power of s is missing: the determinant is -a*c
        ("R*s + k*R^2 + R", ["k*R + 1 > 0"]),
        # The roots of R^2 - 9 R + 17, of discriminant 81 - 4*17 = 13, are 2.7 and 6.3; 49 - 4*13 = -3.
        ("s + R^2 - 9*R + 17", ["R^2 + 17 > 9*R"]),
        ("s + R^2 - 7*R + 13", []),
        ("s + R^2 + 1", []),  # an odd power may be negative, an even one not
        ("s + R^3 + 2", ["R^3 + 2 > 0"]),
        ("s + (R^2 - R + 1)*(R^2 + 1)", []),
    ],
)
def test_what_follows_from_signs_or_from_other_conditions_is_left_out(num, expected):
    real = {"R": {"assume": "real"}}
    tables = {"signals": {"y": f"({num})*u/(s + 1)^5"}, "inputs": {"u": {}}, "outputs": {"Y": "y"}}
    parameters = {n: {} for n in "abcmkKI"} | real
    model = symflex.Model(parameters=parameters, **tables)
    assert [str(c) for c in model.conditions("zeros").conditions] == expected


def test_the_condition_of_the_lumped_bending_beam_is_that_of_the_hand_derivation():
    import sympy

    found = symflex.load("derivations/eppinger1988/lumped_bending_beam.toml").conditions("zeros", "X_tip/F")
    (condition,) = found.conditions
    left, _, right = str(condition).replace("^", "**").partition(" > ")
    difference = sympy.sympify(left) - sympy.sympify(right) - eppinger1988.tip_bracket()
    assert sympy.simplify(difference.subs({x: sympy.Symbol(x.name) for x in difference.free_symbols})) == 0


def test_a_passive_structure_needs_no_condition():
    letters, elements, _, _ = MACHINES[0]
    model = model_of(letters, elements=elements, inputs={"F": {"force": "x"}}, outputs={"Y": "y"})
    found = model.conditions()
    assert not found.conditions
    assert found.on_axis == (("s", 2), ("m_1*m_2*s^2 + k*(m_1 + m_2)", 1))


def test_energy_says_nothing_of_what_outputs_are_divided_by():
    # s^3 - s^2 - 2 s + 1 has the roots 1.80, 0.45 and -1.25, though ends and determinant 2 - 1 are positive.
    letters, elements, _, _ = MACHINES[0]
    output = "y/(T^3*s^3 - T^2*s^2 - 2*T*s + 1)"
    model = model_of(letters + " T", elements=elements, inputs={"F": {"force": "x"}}, outputs={"Y": output})
    assert model.conditions().is_never


def test_a_condition_of_more_terms_than_can_be_read_says_how_many():
    # 3 masses, 3 springs and 3 dampers in a row: 1605 terms, by sympy's Hurwitz determinant of order 5.
    elements = {}
    for i in (1, 2, 3):
        between = [f"x_{i - 1}" if i > 1 else "ground", f"x_{i}"]
        elements[f"body_{i}"] = {"type": "mass", "at": f"x_{i}", "m": f"m_{i}"}
        elements[f"spring_{i}"] = {"type": "spring", "between": between, "k": f"k_{i}"}
        elements[f"damper_{i}"] = {"type": "damper", "between": between, "b": f"b_{i}"}
    letters = " ".join(f"{n}_{i}" for n in "mkb" for i in (1, 2, 3))
    model = model_of(letters, elements=elements, inputs={"F": {"force": "x_1"}}, outputs={"X": "x_3"})
    (condition,) = model.conditions().conditions
    assert (condition.sides, condition.terms) == (None, 1605)
    assert "too long to be read" in str(condition)


def test_waves_and_unknown_names_are_refused():
    model = model_of("K T", signals={"y": "K/s*exp(-s*T)*(r - y)"}, inputs={"r": {}}, outputs={"Y": "y"})
    for arguments, code in ((("poles",), "SF801"), (("both",), "SF902"), (("poles", "Q/r"), "SF801")):
        with pytest.raises(SymflexError) as caught:
            model.conditions(*arguments)
        assert caught.value.diagnostics[0].code == code


def test_json_and_latex_say_the_same():
    letters, loop, _ = LOOPS[1]
    tables = {"signals": {"y": f"({loop})*(r - y)"}, "inputs": {"r": {}}, "outputs": {"Y": "y"}}
    found = model_of(letters, **tables).conditions()
    document = json.loads(json.dumps(found.to_json_dict()))
    assert document["conditions"] == [{"condition": "T_1 + T_2 > K*T_1*T_2", "terms": 3}]
    assert "T_{1} + T_{2} &> K T_{1} T_{2}" in found.latex()
    assert r"\begin{align*}" in found.latex()
    assert str(found).split("\n    ") == [
        "poles: all in the open left half-plane exactly when",
        "T_1 + T_2 > K*T_1*T_2",
        "for positive values of all symbols",
    ]


BRAKE = {
    "k_11": "k_1*cos(a)^2 + k_2*cos(b)^2",
    "k_12": "k_1*sin(a)*cos(a) + k_2*sin(b)*cos(b)",
    "k_22": "k_1*sin(a)^2 + k_2*sin(b)^2 + k_3",
}
"""Mode coupling by friction: k_12 may have either sign, k_11 is not negative, k_22 is positive."""


def test_definitions_stay_closed_as_letters_of_the_signs_that_follow_from_their_formulas():
    """By hand: z^2 + (k_11 + k_22)*z + k_11*k_22 - k_12*(k_12 - mu*k_3), z = m*s^2, has negative roots."""
    rows = ["m*s^2*x + k_11*x + (k_12 - mu*k_3)*y = F", "m*s^2*y + k_12*x + k_22*y = 0"]
    equations = {"unknowns": ["x", "y"], "equations": rows}
    tables = {"definitions": BRAKE, "equations": equations, "inputs": {"F": {}}, "outputs": {"X": "x"}}
    found = model_of("m k_1 k_2 k_3 mu a b", **tables).conditions()
    texts = [str(c).replace("^", "**").split(" > ") for c in found.conditions]
    ours = {sympy.expand(sympy.sympify(f"{left} - ({right})")) for left, right in texts}
    k_11, k_12, k_22, k_3, mu = sympy.symbols("k_11 k_12 k_22 k_3 mu")
    slope = k_12 * (k_12 - mu * k_3)
    assert ours == {sympy.expand(k_11 * k_22 - slope), sympy.expand((k_11 - k_22) ** 2 + 4 * slope)}
    assert "(k_11 - k_22)^2 + 4*k_12*(k_12 - mu*k_3) > 0" in str(found)
    assert [name for name, _ in found.where] == [*BRAKE]
    assert "for positive values of all parameters" in str(found)


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("k_1 - k_2", ["k_1 > k_2"]),  # as short as the name and what it is
        ("(k_1 - k_2)*(k_3*cos(a) + k_1*sin(a) - k_2) + k_1*k_3", ["c > 0"]),
        ("k_1*cos(a)^2 + k_2", []),
        ("(k_1 + k_2)/k_3", []),
    ],
)
def test_no_sign_is_assumed_of_a_definition_that_may_be_negative(formula, expected):
    """By hand: m*s^2 + b*s + c is stable where c > 0."""
    signals = {"y": "u/(m*s^2 + b*s + c)"}
    tables = {"definitions": {"c": formula}, "signals": signals, "inputs": {"u": {}}, "outputs": {"Y": "y"}}
    found = model_of("m b k_1 k_2 k_3 a", **tables).conditions()
    assert [str(c) for c in found.conditions] == expected


def test_a_factor_of_two_polynomials_is_counted_twice():
    # m s^2 + k and itself, multiplied: both roots on the axis are double.
    model = pipeline.loads(
        """symflex = 1
parameters = { m = {}, k = {} }
elements.body = { type = "mass", at = "x", m = "m" }
elements.wall = { type = "spring", between = ["x", "ground"], k = "k" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
    )
    (tf,) = pipeline.derive_all(model)
    factors = [*tf.den.factors]
    assert conditions_of(tf, "poles", [*factors, *factors]).on_axis == (("m*s^2 + k", 2),)
