"""What distributed parts may contain, and what they may not."""

import pytest

from symflex import pipeline
from symflex.errors import BudgetError, ModelError

HEAD = """
symflex = 1
parameters = { E = "70 GPa", I = "1e-8 m^4", rho = "2700 kg/m^3", A = "1e-4 m^2", l = "1 m", T_d = "1 ms" }
blocks.D = { type = "delay", T = "T_d" }
"""
FIELD = """
[fields.w]
domain = ["0", "l"]
equation = "EQUATION"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "CONDITION"]
[inputs]
F = {}
[outputs]
X = "w(l)"
"""


def derived(body, equation="E*I*w'''' + rho*A*s^2*w = 0", condition="E*I*w'''(l) = -F"):
    text = HEAD + body.replace("EQUATION", equation).replace("CONDITION", condition)
    return pipeline.derive_all(pipeline.loads(text))[0]


def test_a_delay_inside_an_equation_is_refused_at_its_place():
    for equation in ["E*I*w'''' + rho*A*s^2*D*w = 0", "E*I*w'''' + rho*A*s^2*w = D*F/l"]:
        with pytest.raises(ModelError) as caught:
            derived(FIELD, equation)
        (problem,) = caught.value.diagnostics
        assert problem.code == "SF910", equation
        assert problem.span is not None, equation


def test_a_delay_in_a_condition_is_a_factor():
    late, prompt = derived(FIELD, condition="E*I*w'''(l) = -D*F"), derived(FIELD)
    s = 3 + 40j
    ratio = pipeline.bind(late)(s) / pipeline.bind(prompt)(s)
    # exp(-s*T) with T = 1 ms
    assert abs(ratio - 2.718281828459045 ** (-s * 1e-3)) < 1e-14


def test_a_delay_may_stand_in_a_definition():
    body = """
[definitions]
late = "D"
[signals]
y = "late*u"
[inputs]
u = {}
[outputs]
Y = "y"
"""
    assert abs(pipeline.bind(derived(body))(1j) - 2.718281828459045 ** (-1e-3j)) < 1e-15


@pytest.mark.slow
def test_densely_coupled_symbols_end_in_a_budget():
    n = 7
    names = [f"u{i}" for i in range(n)]
    parameters = "\n".join(f'a_{i}_{j} = {{ unit = "1/m" }}' for i in range(n) for j in range(n))
    equations = ", ".join(
        '"u{}\' = {}"'.format(i, " + ".join(f"a_{i}_{j}*u{j}" for j in range(n))) for i in range(n)
    )
    conditions = ", ".join(f'"u{i}({"0" if i else "l"}) = {"0" if i else "F"}"' for i in range(n))
    text = f"""
symflex = 1
[parameters]
l = "1 m"
{parameters}
[fields.f]
unknowns = [{", ".join(f'"{u}"' for u in names)}]
domain = ["0", "l"]
equations = [{equations}]
conditions = [{conditions}]
[inputs]
F = {{}}
[outputs]
X = "u1(l)"
"""
    with pytest.raises(BudgetError) as caught:
        pipeline.derive_all(pipeline.loads(text))
    assert caught.value.diagnostics[0].span is not None


@pytest.mark.parametrize(
    ("unknowns", "equations", "static"),
    [('["a", "b"]', '["a\' = s*b", "b = 2*a"]', "b"), ('["a"]', "[\"a' - a' + s*a = 0\"]", "a")],
)
def test_an_unknown_without_derivatives_is_refused_at_its_field(unknowns, equations, static):
    text = f"""
symflex = 1
inputs.u = {{}}
outputs.Y = "{static}(1)"
[fields]
f = {{ unknowns = {unknowns}, domain = ["0", "1"], equations = {equations}, conditions = ["a(0) = u"] }}
"""
    with pytest.raises(ModelError, match=f"SF305.*no derivative of {static}") as caught:
        pipeline.derive_all(pipeline.loads(text))
    (problem,) = caught.value.diagnostics
    assert problem.span.text == "f"
    assert problem.hint == "substitute what it equals in the other equations and conditions"


def test_equations_that_leave_a_highest_derivative_open_are_refused_at_their_field():
    text = """
symflex = 1
[fields.f]
unknowns = ["a", "b"]
domain = ["0", "1"]
equations = ["a' + b' = s*a", "a' + b' = s*b"]
conditions = ["a(0) = u", "b(0) = 0"]
[inputs]
u = {}
[outputs]
Y = "a(1)"
"""
    with pytest.raises(ModelError) as caught:
        pipeline.derive_all(pipeline.loads(text))
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF305"
    assert problem.message == "the equations of field 'f' do not determine the highest derivatives of a and b"
    assert problem.hint == "eliminate an unknown by hand, or differentiate an equation"
    assert problem.span.text == "f"
