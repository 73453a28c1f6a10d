from fractions import Fraction

import pytest

from symflex.audit.field import Arithmetic, GrowError, UnreadError, ground_of
from symflex.audit.reading import Formula, formula_lines
from symflex.errors import Source, Span, Text
from symflex.expressions import parse

PARAMETERS = (("x", True), ("y", True), ("z", False))


def expression(text):
    return parse(Text(text, Span(Source("formula", text), 0, len(text))))


def equal(left, right):
    """Read two texts in the smallest field and compare them."""
    names = frozenset(n for n, _ in PARAMETERS)
    formula = Formula(expression("0"), None, (("L", expression(left)), ("R", expression(right))), names)
    ground = ground_of(PARAMETERS)
    while True:
        field = Arithmetic(ground)
        try:
            values = formula_lines(field, formula)
        except GrowError as more:
            ground = more.ground
            continue
        return field.equal(values["L"], values["R"])


EQUAL = {
    "sqrt(x*y)": "sqrt(x)*sqrt(y)", "sqrt(8*x^3)": "2*x*sqrt(2*x)", "sqrt(2)*sqrt(6)": "2*sqrt(3)",
    "1/(sqrt(2) + 1)": "sqrt(2) - 1", "sqrt(s^2)": "s", "sqrt(x^2 + 2*x*y + y^2)": "x + y",
    "sqrt(1 + x*s)^3": "(1 + x*s)*sqrt(1 + x*s)", "x^(3/4)/x^0.25": "sqrt(x)", "sqrt(-4)^2": "-4",
    "(-4)^(1/4)": "1 + sqrt(-1)", "sqrt(x/sqrt(-1))": "sqrt(x/2)*(1 - sqrt(-1))",
    "sqrt(-2*x*sqrt(-1))": "sqrt(x)*(1 - sqrt(-1))", "(-x)^(-3/2)": "sqrt(-1)/x^(3/2)",
    "sqrt(1 - x^2)^2": "1 - x^2", "sqrt(x^2 - 1)^3": "(x^2 - 1)*sqrt(x^2 - 1)",
    "sqrt(y - y*x^2)": "sqrt(y)*sqrt(1 - x^2)", "cosh(x)^2 - sinh(x)^2": "1",
    "cos(3*x)": "4*cos(x)^3 - 3*cos(x)", "tanh(x)": "(exp(2*x) - 1)/(exp(2*x) + 1)",
    "tan(2*x)": "2*tan(x)/(1 - tan(x)^2)", "sin(x + y)": "sin(x)*cos(y) + cos(x)*sin(y)",
    "exp(x - y)": "exp(x)/exp(y)", "cosh(sqrt(-1)*x)": "cos(x)",
    "sinh((1 + sqrt(-1))*x)": "sinh(x)*cos(x) + sqrt(-1)*cosh(x)*sin(x)", "sqrt(exp(2*x))": "exp(x)",
    "cos(sqrt(x*s/2))": "2*cos(sqrt(s/8)*sqrt(x))^2 - 1", "exp(0)": "1",
}  # fmt: skip
DIFFERENT = {
    "sqrt(x + y)": "sqrt(x) + sqrt(y)",
    "sqrt(2) + sqrt(3)": "sqrt(5)",
    "sqrt(10)": "3.1622776601683793319988935444327185337",
    "cos(2*x)": "2*cos(x)^2 + 1",
    "exp(x*y)": "exp(x)*exp(y)",
    "exp(pi)": "exp(3.14159265358979)",
    "sinh(x)": "sin(x)",
    "sqrt(x - y)": "sqrt(y - x)",
    "sqrt(-1)*sqrt(x - y)": "sqrt(y - x)",
}


def test_equal_expressions_are_proved_equal():
    assert [(left, right) for left, right in EQUAL.items() if not equal(left, right)] == []


def test_different_expressions_are_told_apart():
    assert [(left, right) for left, right in DIFFERENT.items() if equal(left, right)] == []


# fmt: off
UNREAD = (
    "sqrt(z)", "sqrt(z^2)", "sqrt((x - y)^2)", "sqrt(1/(x - y))", "sqrt((x - y)*(x - 2*y))",
    "sqrt((x - y)^3)", "sqrt(cos(x))", "log(x)", "cos(cos(s))",
)
# fmt: on


def test_what_has_two_readings_or_none_is_left_unread():
    for text in UNREAD:
        with pytest.raises(UnreadError):
            equal(text, "1")


def test_a_constant_ratio_is_found_and_a_varying_one_is_not():
    field = Arithmetic(ground_of(PARAMETERS))
    x, y, s = (field.name(n) for n in "xys")
    assert str(field.constant_ratio(2 * x * (s + y), s + y)) == "2*x"
    assert field.constant_ratio(s + x, s + y) is None


def test_a_power_of_zero_with_a_negative_exponent_is_an_error():
    field = Arithmetic(ground_of(PARAMETERS))
    with pytest.raises(ZeroDivisionError):
        field.power(field.number(0), Fraction(-1, 2))
