"""Every form of random networks and of models with definitions reads back to the same rational function."""

import pytest
from hypothesis import given, settings

from symflex import pipeline
from symflex.algebra import degree_in
from symflex.expressions import format_expression
from symflex.print.forms import hidden_expressions, print_form
from symflex.print.forms.printed import RATIONAL
from tests.contract.exact import Point, read, value_in_ring, value_of
from tests.property.networks import networks, to_toml

SYMBOLIC = tuple(name for name in RATIONAL if name not in ("zpk", "frequency"))
"""The forms whose print has an exact value at rational points; the frequency form holds an imaginary unit."""
SHORT = 60


def reread(form, point):
    """Return the exact value of what a form prints, its where list substituted."""
    for name, expression in form.where:
        point.values[name] = value_of(reparsed(expression), point)
    return value_of(reparsed(form.num), point) / value_of(reparsed(form.den), point)


def reparsed(expression):
    """Return an expression read back from its print, which must be itself."""
    found = read(format_expression(expression))
    assert found == expression
    return found


def assert_every_form_agrees(tf):
    for name in (*SYMBOLIC, None):
        point = Point(7)
        assert reread(print_form(tf, name), point) == value_in_ring(tf.ratio, point)


def is_short(tf):
    """Tell whether the written-out function is short enough to be read back quickly."""
    return sum(len(factor) for factor, _ in tf.ratio.factors) <= SHORT


def assert_lowest_terms(tf):
    numerator = [f for f, e in tf.ratio.factors if e > 0]
    denominator = [f for f, e in tf.ratio.factors if e < 0]
    assert all(f.gcd(g).is_constant() for f in numerator for g in denominator)


@given(network=networks())
@settings(max_examples=20)
@pytest.mark.slow
def test_a_random_network_is_in_lowest_terms_and_every_form_reads_back_to_it(network):
    for tf in pipeline.derive_all(pipeline.loads(to_toml(network))):
        assert_lowest_terms(tf)
        for factor in tf.hidden:
            assert degree_in(factor.polynomial, 0) > 0
            assert factor.multiplicity > 0
        for expression, _ in hidden_expressions(tf):
            reparsed(expression)
        if is_short(tf):
            assert_every_form_agrees(tf)


DEFINED = {
    "an impedance": """
definitions.Z = "m*s + b"
[elements]
M = { type = "mass", at = "x", m = "m" }
B = { type = "damper", between = ["x", "ground"], b = "b" }
K = { type = "spring", between = ["x", "y"], k = "k" }
N = { type = "mass", at = "y", m = "3*m" }
""",
    "definitions of definitions": """
definitions = { k_e = "k*d/(k + d)", d = "2*b*s + k", Z = "m*s^2 + k_e" }
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "y"], k = "k_e + d" }
B = { type = "spring", between = ["y", "ground"], k = "Z" }
""",
    "a reciprocal": """
definitions = { q = "1/b", r = "q*k/2 - k" }
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "y"], k = "q + k" }
B = { type = "spring", between = ["y", "ground"], k = "r*q" }
""",
    "a definition of zero": """
definitions.off = "k - k"
[elements]
M = { type = "mass", at = "x", m = "m" }
B = { type = "damper", between = ["x", "y"], b = "b + off" }
K = { type = "spring", between = ["y", "ground"], k = "k + off*b" }
""",
    "functions of constants": """
definitions.omega = "sqrt(k/m)"
[elements]
M = { type = "mass", at = "x", m = "m" }
B = { type = "damper", between = ["x", "y"], b = "2*m*omega*cos(pi/5)" }
K = { type = "spring", between = ["y", "ground"], k = "pi^2*m*omega^2 + k" }
""",
}


@pytest.mark.parametrize("name", DEFINED)
def test_every_form_of_a_model_with_definitions_reads_back_to_the_derived_function(name):
    text = "symflex = 1\nparameters = { m = {}, b = {}, k = {} }" + DEFINED[name]
    text += '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\nV = "s*y"\nW = "(x - y)/(k + 1)"\n'
    for tf in pipeline.derive_all(pipeline.loads(text)):
        assert_every_form_agrees(tf)
        assert_lowest_terms(tf)
