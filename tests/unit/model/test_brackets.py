"""Coefficients that vary along x, as specifications write them: what is read, and what is refused."""

import pytest
import sympy

import symflex
from symflex.errors import Source, SpecError, Text
from symflex.errors.diagnostic import Span
from symflex.expressions import format_expression, parse_equation
from symflex.model import load_model
from symflex.model.brackets import named_brackets, open_brackets

PARAMETERS = """symflex = 1
[parameters]
E = "70 GPa"
I_0 = "1e-8 m^4"
rho = "2700 kg/m^3"
A_0 = "1e-3 m^2"
l = "1.2 m"
c = 0.5
k = "3 1/m"
"""
REST = '[inputs]\nF = { unit = "N" }\n[outputs]\nX = "w(l)"\n'
ENDS = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "(E*I_0*(1 - c*x/l)*w'')'(l) = -F"]
TAPER = "(E*I_0*(1 - c*x/l)*w'')'' + rho*A_0*s^2*w = 0"


def equation(text):
    source = Source("field.toml", text)
    return parse_equation(Text(text, Span(source, 0, len(text))))


def spec(equation=TAPER, conditions=ENDS, more=""):
    quoted = ", ".join(f'"{c}"' for c in conditions)
    return (
        f'{PARAMETERS}{more}[fields.w]\ndomain = ["0", "l"]\nequation = "{equation}"\n'
        f"conditions = [{quoted}]\n{REST}"
    )


def problems(text):
    with pytest.raises(SpecError) as caught:
        load_model(Source("taper.toml", text))
    return [(d.code, str(d.span).split(":", 1)[1], d.message) for d in caught.value.diagnostics]


X, A, B = sympy.symbols("x a b")
W = sympy.Function("w")(X)
D = sympy.Derivative


@pytest.mark.slow
def test_brackets_open_as_sympy_differentiates():
    for text, meant in [
        ("(a*(1 - x/b)^3*w'')''", D(A * (1 - X / B) ** 3 * D(W, X, 2), X, 2)),
        ("((1 + x^2)*(w' + x*w))'", D((1 + X**2) * (D(W, X) + X * W), X)),
        ("(w/(1 + x))''", D(W / (1 + X), X, 2)),
        ("(exp(-2*a*x)*w')'", D(sympy.exp(-2 * A * X) * D(W, X), X)),
        ("(sqrt(1 + x)*sin(a*x)*w)'", D(sympy.sqrt(1 + X) * sympy.sin(A * X) * W, X)),
        ("(cos(x)*w' - tan(x)*w)'", D(sympy.cos(X) * D(W, X) - sympy.tan(X) * W, X)),
        ("(log(1 + x)*w + cosh(x)*w)'", D((sympy.log(1 + X) + sympy.cosh(X)) * W, X)),
        ("(sinh(a*x)*tanh(x)*w)'", D(sympy.sinh(A * X) * sympy.tanh(X) * W, X)),
        ("((1 + x)^-2*w)'''", D((1 + X) ** -2 * W, X, 3)),
        ("((a*x*w')'*(1 - x))'", D(D(A * X * D(W, X), X) * (1 - X), X)),
    ]:
        opened, noted = open_brackets(equation(f"{text} = 0"), ["w"], has_coordinate=True, is_condition=False)
        assert noted == [], text
        found = format_expression(opened.left)
        for order in range(6, 0, -1):
            found = found.replace("w" + "'" * order, f"D(w, x, {order})")
        read = sympy.sympify(found.replace("^", "**"), locals={"w": W, "x": X, "a": A, "b": B, "D": D})
        assert sympy.simplify((read - meant).doit()) == 0, text


def test_a_bracket_with_the_highest_derivative_becomes_an_unknown():
    found, unknowns = named_brackets([equation("(a*x*w'')'' - (b*x*w')' = s^2*w")], ["w"])
    assert unknowns == ("w", "(a*x*w'')")
    assert [format_expression(e) for e in found] == [
        "(a*x*w'')'' - (b*w' + b*x*w'') = s^2*w",
        "a*x*w'' = (a*x*w'')",
    ]


PLATE = """symflex = 1
title = "A clamped circular plate that bends symmetrically"
parameters = { D = "1 N*m", m = "1 kg/m^2", a = "1 m" }
inputs.p = { unit = "Pa" }
outputs.centre = "w(0)"
[fields.plate]
unknowns = ["w", "phi", "M", "q"]
domain = ["0", "a"]
equations = ["w' = phi", "(x*phi)' = x*M/D", "x*M' = q", "q' = -m*s^2*x*w + x*p"]
conditions = ["w(a) = 0", "phi(a) = 0"]
"""


def test_a_bracket_that_holds_no_derivative_is_opened():
    # Leissa 1969, Vibration of Plates: the lowest natural frequency is 10.2158 sqrt(D/m)/a^2.
    centre = symflex.loads(PLATE).transfer_function("centre", "p").bind()
    below, above = (centre(omega * 1j).real for omega in (10.2157, 10.2159))
    assert below > 0 > above


def test_a_parameter_called_x_is_no_coordinate():
    text = spec("E*I_0*w'''' + rho*A_0*s^2*x^2*w = 0", [*ENDS[:3], "w'''(l) = 0"], "x = 1\n")
    (field,) = load_model(Source("taper.toml", text)).fields
    assert field.written == ()


def test_coefficients_are_read_or_refused_with_their_place():
    for equation, code, place in [
        ("E*I_0*w'''' + rho*A_0*s^2*w*x/l = 0", None, ""),
        ("(E*I_0*(1 - k*x)*w'')'' + rho*A_0*s^2*w = 0", None, ""),
        ("(E*I_0*w''(l))'' + rho*A_0*s^2*w'''' = 0", "SF241", "12:20"),
        ("(E*I_0*w'')''(l) + rho*A_0*s^2*w'''' = 0", "SF241", "12:13"),
        ("sin((E*I_0*w'')'')*w'''' = w", "SF223", "12:13"),
    ]:
        conditions = [*ENDS[:3], "w'''(l) = 0"]
        if code is None:
            assert load_model(Source("taper.toml", spec(equation, conditions))).fields, equation
            continue
        found = problems(spec(equation, conditions))
        assert (code, place) in [(c, p) for c, p, _ in found], found


def test_a_bracket_with_primes_belongs_into_fields():
    with pytest.raises(SpecError) as caught:
        load_model(Source("a.toml", 'symflex = 1\ninputs.F = {}\noutputs.y = "(F)\'"\n'))
    assert [d.code for d in caught.value.diagnostics] == ["SF223"]
