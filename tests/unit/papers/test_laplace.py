"""What a paper calls s, and which of its symbols are signals; each answer was said by hand."""

from math import isclose

import pytest

from symflex.errors import SpecError, Text
from symflex.expressions import parse
from symflex.papers.formula import evaluated
from symflex.papers.laplace import signals_in
from tests.unit.papers.reading import read


@pytest.mark.parametrize(
    ("latex", "known", "reading"),
    [
        (r"\frac{1}{1 - \omega^2 LC + j\omega RC}", "L C R", "1/(1+s^2*L*C+s*R*C)"),
        (r"\frac{k}{k - m\Omega^2}", "k m", "k/(k+m*s^2)"),
        (r"\frac{a}{p + a}", "a", "a/(s+a)"),
        (r"\frac{1}{D^2 + c}", "c", "1/(s^2+c)"),
        (r"\frac{a}{p + a}", "a p", "a/(p+a)"),
    ],
)
def test_a_formula_is_in_s_whatever_the_paper_calls_it(latex, known, reading):
    found, expected = evaluated(read(latex, known)), evaluated(parse(Text.alone("own", reading)))
    assert isclose(abs(found - expected), 0, abs_tol=1e-12)


def test_an_imaginary_unit_beside_s_is_refused():
    with pytest.raises(SpecError, match="stand side by side"):
        read(r"\frac{1}{s + j\omega}")


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
