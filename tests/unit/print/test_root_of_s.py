"""Formulas in a root of s are written in s as on paper, and mean the same."""

import cmath

import pytest

from symflex import loads
from symflex.errors import Text
from symflex.expressions import fold, format_expression, parse
from symflex.model.model import RootOfS
from symflex.print.forms.root_of_s import in_roots

WRITTEN = {  # outputs as an author writes them, and how they print
    "(s + c)/sqrt(s + a)*u": ("s + c", "sqrt(s + a)"),
    "(s + a)/(s + c)/sqrt(s + a)*u": ("sqrt(s + a)", "s + c"),
    "(s + a)^2/(s + c)^2*u/sqrt(s + a)": ("(s + a)*sqrt(s + a)", "(s + c)^2"),
    "u/(s*sqrt(s + a) + d)": ("1", "s*sqrt(s + a) + d"),
    "u/((s + c)*sqrt(s + a) + d)": ("1", "(s + c)*sqrt(s + a) + d"),
    "u*s*exp(-b*sqrt(s + a))": ("s*exp(-b*sqrt(s + a))", "1"),
    "u*s/(3 + sqrt(s + a))": ("s", "sqrt(s + a) + 3"),
}


@pytest.mark.parametrize("output", WRITTEN)
def test_polynomials_in_a_root_are_gathered_by_powers_of_s(output):
    text = (
        f'symflex = 1\nparameters = {{ a = 2, b = 3, c = 4, d = 5 }}\ninputs.u = {{}}\noutputs.y = "{output}"'
    )
    form = loads(text).transfer_function("y", "u").form()
    assert tuple(map(format_expression, (form.printed.num, form.printed.den))) == WRITTEN[output]


@pytest.mark.parametrize("order", [2, 3, 4])
def test_what_is_written_in_s_has_the_value_it_had_in_the_root(order):
    values = {"a": 0.7, "b": 1.3, "c": 2.9, "T": 0.4}
    root = RootOfS(parse(Text.alone("", "b/2")), parse(Text.alone("", "a - 3*T")), order)
    s = complex(0.3, 1.1)

    def value(text, s):
        return fold(
            text,
            number=float,
            name={**values, "s": s}.__getitem__,
            power=lambda base, exponent: (
                base ** fold(exponent, number=float, name=values.get, power=pow, call=lambda c, x: x)
            ),
            call=lambda call, x: getattr(cmath, call.name)(x),
        )

    r = (values["b"] / 2 * s + values["a"] - 3 * values["T"]) ** (1 / order)
    for text in (
        "s^2 - a + c",
        "s^4 - 2*a*s^2 + a^2 + c*s",
        "(s^2 - a)*(s^3 + c*s) + T/c*s^2 + 1",
        "exp(-(s^2 - a)*T)",
        "(s^2 + c)/(s - 1/s)",
        "(c - a)*s^3 - (b + T)*s + s^6/b",
        "sqrt(c)*s^2 + 2*s + 5",
    ):
        expression = parse(Text.alone("", text))
        assert value(in_roots(expression, root), s) == pytest.approx(value(expression, r), rel=1e-12), text
