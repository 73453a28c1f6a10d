"""Conditions for minimum phase, against Routh's and derivations that share no code."""

from pathlib import Path

import sympy

from symflex import pipeline
from symflex.analysis.explanation import explain_zeros
from symflex.expressions import format_expression
from symflex.report.minimum_phase import minimum_phase
from tests.independent import eppinger1988

FOLDER = Path(__file__).parents[3] / "derivations" / "eppinger1988"


def condition(model, name):
    (pair,) = pipeline.pick_pairs(model, [name])
    (tf,) = pipeline.derive_all(model, [pair])
    bound = pipeline.bind(tf, {p.name: 1 for p in model.parameters if p.value is None})
    return minimum_phase(tf, explain_zeros(model, bound, pipeline.roots(bound)))


def test_the_bracket_of_the_lumped_bending_beam_is_that_of_the_hand_derivation():
    found = condition(pipeline.load(FOLDER / "lumped_bending_beam.toml"), "X_tip/F")
    assert found.kind == "if positive"
    names = {n: sympy.Symbol(n) for n in ("m_2", "J", "c", "h", "l", "EI")}
    printed = sympy.sympify(format_expression(found.expression).replace("^", "**"), locals=names)
    assert sympy.simplify(printed - eppinger1988.tip_bracket()) == 0


FILTER = """
symflex = 1
parameters = {{ a = {a}, b = {{}}, c = {{}} }}
inputs.u = {{}}
outputs.y = "({num})*u/(s + 1)^4"
"""


def test_the_signs_of_coefficients_decide_what_they_can():
    for num, expected in (
        ("a*s^2 + b*s + c", "always"),  # Routh: all coefficients positive, degree 2
        ("(a*s + b)*(b*s + c)", "always"),
        ("a*s - b", "never"),
        ("a*s^2 - b", "never"),
        ("a*s^2 - b*s + c", "never"),  # the sum of both zeros is b/a
        ("(a - b)*s^2 + c", "if positive"),
        ("a*s^3 + b*s^2 + c*s + a", "if positive"),  # Routh: b*c > a^2
        ("a", "always"),
    ):
        assert condition(pipeline.loads(FILTER.format(num=num, a="{}")), "y/u").kind == expected, (
            num,
            expected,
        )


def test_a_parameter_of_any_sign_has_to_be_positive():
    model = pipeline.loads(FILTER.format(num="a*s + b", a='{ assume = "real" }'))
    assert format_expression(condition(model, "y/u").expression) == "a"


def test_two_conditions_at_once_are_not_one():
    model = pipeline.loads(FILTER.format(num="((a - b)*s^2 + c)*((b - c)*s^2 + a)", a="{}"))
    assert condition(model, "y/u").kind == "unknown"


def test_the_zeros_of_a_beam_without_losses_move_along_rays():
    model = pipeline.load(FOLDER / "sliding_free_beam.toml")
    assert condition(model, "V_tip/F").kind == "as given"


def test_a_driving_point_of_a_passive_structure_is_minimum_phase():
    assert condition(pipeline.load(FOLDER / "six_mass.toml"), "X_act/F").kind == "always"


def test_a_driving_point_is_not_where_a_stiffness_may_be_negative():
    # The zeros are those of s^2 + k + k_1 - P with m_2 = 1: one is positive where P > k + k_1.
    model = pipeline.loads("""
symflex = 1
parameters = { k = {}, k_1 = {}, P = {} }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
one  = { type = "mass", at = "x", m = 1 }
two  = { type = "mass", at = "y", m = 1 }
join = { type = "spring", between = ["x", "y"], k = "k" }
wall = { type = "spring", between = ["y", "ground"], k = "k_1 - P" }
""")
    assert condition(model, "X/F").kind != "always"
