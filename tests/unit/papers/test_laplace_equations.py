"""Which symbols of equations in s are unknown and which act; each was said by hand."""

import pytest

from symflex.errors import Text
from symflex.expressions import parse
from symflex.papers.laplace_equations import signals_in


@pytest.mark.parametrize(
    ("equations", "typed", "unknowns", "inputs"),
    [
        ("F = (m*s^2 + c*s + k)*X", "F X", "X", "F"),
        ("X = F/(m*s^2 + k)", "F X", "X", "F"),
        ("(m*s^2 + k)*X = F", "", "X", "F"),  # the paper writes X, not X(s)
        ("m*s^2*X + k*X = F", "", "X", "F"),
        ("Y = K/(s*(tau*s + 1))*E; E = R - Y", "Y E R", "Y E", "R"),
        ("V = (L*s + R)*I + K*s*Q; J*s^2*Q = K*I", "V I Q", "I Q", "V"),
    ],
)
def test_what_s_multiplies_is_unknown_and_what_acts_is_an_input(equations, typed, unknowns, inputs):
    sides = [[parse(Text.alone("own", side)) for side in one.split("=")] for one in equations.split(";")]
    found = signals_in(sides, set(typed.split()), ("F", "V", "r"))
    assert (set(found.unknowns), found.inputs, found.doubt) == (set(unknowns.split()), (inputs,), "")


def test_a_product_of_signals_is_no_linear_equation():
    sides = [[parse(Text.alone("own", side)) for side in ("m*s*X*Y", "F")]]
    assert signals_in(sides, {"X", "Y", "F"}, ("F",)) is None
