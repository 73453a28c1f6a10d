"""Roots of s mean their principal branch, however they are written."""

import cmath
import runpy

import pytest

from symflex import pipeline, transfer
from symflex.codegen.exporters import EXPORTERS
from symflex.errors import ModelError, SpecError
from symflex.expressions import format_expression
from symflex.print.forms import print_form

TEXT = """symflex = 1
parameters = {{ R = "4 Ohm", C = "50 uF", tau = "20 ms", x = "1 cm", a = "4e-6 m^2/s", T = "0.1 s", n = 3 }}
definitions = {{ {definition} }}
inputs.r = {{}}
outputs.Y = "{output}"
"""
S = complex(0.3, 1.7)
ROOT, RC, SKIN = cmath.sqrt(S), cmath.sqrt(2e-4 * S), cmath.sqrt(1 + 0.02 * S)
SPELLINGS = {
    "sqrt(s)*r": ROOT, "s^0.5*r": ROOT, "s^(1/2)*r": ROOT, "s^(3/2)*r": ROOT**3, "r*s^-0.5": 1 / ROOT,
    "r/sqrt(s)": 1 / ROOT, "sqrt(1/s)*r": 1 / ROOT, "n*s*sqrt(s)*r": 3 * ROOT**3, "sqrt(s*R*C)*r": RC,
    "sqrt(R*s*C)*r": RC, "sqrt(a/s)*r": 0.002 / ROOT, "exp(-x*sqrt(s/a))*r": cmath.exp(-5 * ROOT),
    "exp(-x*g)*r": cmath.exp(-5 * ROOT), "exp(-g*x/2)*r": cmath.exp(-2.5 * ROOT),
    "r/exp(x*g)": cmath.exp(-5 * ROOT), "exp(-s*T - x*g)*r": cmath.exp(-0.1 * S - 5 * ROOT),
    "exp(-(x*g + sqrt(s*R*C)))*r": cmath.exp(-5 * ROOT - RC), "tanh(sqrt(s*R*C))*r": cmath.tanh(RC),
    "cosh(-g*x)*r": cmath.cosh(5 * ROOT), "sinh(-g*x)*r": -cmath.sinh(5 * ROOT),
    "r/sinh(x*g)": 1 / cmath.sinh(5 * ROOT), "coth(sqrt(s*R*C))/sqrt(s)*r": 1 / cmath.tanh(RC) / ROOT,
    "sqrt(1 + s*tau)*r": SKIN, "sqrt(w)*r": SKIN, "(s*tau + 1)^0.5*r": SKIN,
    "r/(1 + (s*tau)^0.8)": 1 / (1 + (0.02 * S) ** 0.8), "(1 + s*tau)^-0.3*r": (1 + 0.02 * S) ** -0.3,
    "s^0.25*s^0.5*r": S**0.75, "(s^0.7 + n)*r": S**0.7 + 3, "s^0.5*exp(-s*T)*r": ROOT * cmath.exp(-0.1 * S),
}  # fmt: skip


def model_of(output):
    definition = 'g = "sqrt(s/a)"' if "g" in output else 'w = "1 + s*tau"'
    return pipeline.loads(TEXT.format(output=output, definition=definition))


def function(output):
    (derived,) = pipeline.derive_all(model_of(output))
    return derived


@pytest.mark.parametrize("output", SPELLINGS)
def test_a_root_of_s_is_written_as_on_paper(output):
    assert transfer.bind(function(output))(S) == pytest.approx(SPELLINGS[output], rel=1e-12)


@pytest.mark.parametrize("output", SPELLINGS)
def test_what_is_printed_has_the_value_of_the_function(output):
    form = print_form(function(output))
    above, below = map(format_expression, (form.num, form.den))
    read = function(f"({above})/({below})*r")
    assert transfer.bind(read)(S) == pytest.approx(SPELLINGS[output], rel=1e-12)


@pytest.mark.parametrize(
    ("output", "code", "place"),
    [
        ("sqrt(s^2 + 1)*r", "SF910", "sqrt(s^2 + 1)"),
        ("sqrt(s)*sqrt(s + 1)*r", "SF910", "sqrt(s)"),
        ("sqrt((s + 1)/(s + 2))*r", "SF910", "sqrt((s + 1)/(s + 2))"),
        ("s^0.07*r", "SF225", "0.07"),
        ("s^n*r", "SF225", "n"),
        ("exp(-1/sqrt(s))*r", "SF910", "exp(-1/sqrt(s))"),
        ("tan(sqrt(s))*r", "SF910", "tan(sqrt(s))"),
    ],
)
def test_what_is_no_root_of_one_linear_function_is_refused_at_its_place(output, code, place):
    with pytest.raises((SpecError, ModelError)) as caught:
        function(output)
    problem = caught.value.diagnostics[0]
    assert (problem.code, problem.span.text) == (code, place)


def test_a_branch_point_right_of_the_axis_is_refused():
    with pytest.raises(SpecError, match="must not lie in the right half-plane"):
        function("sqrt(s - 2)*r")


def test_code_takes_the_principal_root(tmp_path):
    for output in ("tanh(sqrt(s*R*C))*r", "sqrt(1 + s*tau)*r", "exp(-x*g)/(s^0.25 + n)*r"):
        model = model_of(output)
        path = tmp_path / "code.py"
        path.write_text(EXPORTERS["numpy"].export(model, pipeline.derive_all(model), "code").text)
        right = SPELLINGS.get(output, cmath.exp(-5 * ROOT) / (S**0.25 + 3))
        assert runpy.run_path(str(path))["Y_over_r"](S) == pytest.approx(right, rel=1e-12), output


def test_code_with_other_roots_than_square_ones_is_refused():
    model = model_of("s^0.7*r")
    with pytest.raises(ModelError, match="code for powers of s with the denominator 10 is not available yet"):
        EXPORTERS["numpy"].export(model, pipeline.derive_all(model), "code")
