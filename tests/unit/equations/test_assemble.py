"""The equations of a model, against the matrix written by hand, and what assembly refuses."""

from __future__ import annotations

import pytest

import symflex
from symflex import pipeline
from symflex.elements import Variable
from symflex.equations.equations import Equations
from symflex.errors import ModelError

HEADER = "symflex = 1\n[parameters]\n"
PENDULUM = (
    HEADER
    + """m = {}
k = {}
b = {}
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "y"], k = "k" }
B = { type = "damper", between = ["y", "x"], b = "b" }
N = { type = "mass", at = "y", m = "2*m" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
)


def assemble(text) -> Equations:
    return pipeline.assemble(pipeline.loads(text))


def matrix(equations):
    """Return the rows as {variable: summed coefficient text}, one dict per row."""
    found = []
    for row in equations.rows:
        sums = {}
        for variable, coefficient in row.form.terms:
            sums[str(variable)] = sums[str(variable)] + coefficient if str(variable) in sums else coefficient
        found.append({name: str(value.expand()) for name, value in sums.items() if not value.is_zero})
    return found


def codes(text):
    with pytest.raises(symflex.SymflexError) as caught:
        assemble(text)
    return [d.code for d in caught.value.diagnostics]


def test_two_masses_assemble_to_the_dynamic_stiffness_matrix():
    assert matrix(assemble(PENDULUM)) == [
        {"x": "s^2*m + s*b + k", "y": "-s*b - k", "F": "-1"},
        {"x": "-s*b - k", "y": "2*s^2*m + s*b + k"},
    ]


def test_a_parallel_spring_and_damper_stay_one_sub_impedance():
    (first, _) = assemble(PENDULUM).rows
    coefficients = [str(c) for v, c in first.form.terms if str(v) == "y"]
    assert coefficients == ["-1*(s*b + k)"]


def test_there_are_as_many_rows_as_unknowns_and_they_name_each_other():
    equations = assemble(PENDULUM)
    assert [r.about for r in equations.rows] == list(equations.unknowns)
    assert equations.inputs == (Variable("input", "F"),)


def test_rows_are_polynomial():
    text = PENDULUM.replace('k = "k"', 'k = "k*m/(b + m)/3"')
    for row in assemble(text).rows:
        for _, coefficient in row.form.terms:
            coefficient.expand()


def test_a_function_of_constants_is_one_generator_however_often_it_is_written():
    text = PENDULUM.replace('k = "k"', 'k = "sqrt(k*m)"').replace('b = "b"', 'b = "sqrt(k * m)"')
    assert [c.generator for c in assemble(text).constants] == ["sqrt(k*m)"]


def test_a_definition_inside_a_function_is_opened():
    text = PENDULUM.replace("[elements]", '[definitions]\nw = "k/m"\n[elements]').replace(
        'b = "b"', 'b = "sqrt(w)"'
    )
    assert [c.generator for c in assemble(text).constants] == ["sqrt(k/m)"]


@pytest.mark.parametrize(
    ("expression", "value"),
    [("sqrt(9/4)", "3/2"), ("sin(0)", "0"), ("cos(k - k)", "1"), ("exp(0)", "1"), ("tanh(0)", "0")],
)
def test_an_exact_value_of_a_function_is_a_number(expression, value):
    text = f'{HEADER}k = {{}}\n[inputs]\nU = {{}}\n[outputs]\nX = "({expression})*U"\n'
    (output,) = assemble(text).outputs
    found = "0" if not output.form.terms else str(output.form.terms[0][1] / output.divisor)
    assert found == value


def signal(expression, definitions="", blocks=""):
    return (
        f"{HEADER}k = {{}}\nm = {{}}\n[definitions]\n{definitions}\n[blocks]\n{blocks}\n[signals]\n"
        f'e = "{expression}"\n[inputs]\nU = {{}}\n[outputs]\nX = "e"\n'
    )


@pytest.mark.parametrize(
    "expression", ["U/(k - k)", "U*(k - k)^-1", "U*(m + k - m - k)^-2", "U/((k + m)*(k - m) - k^2 + m^2)"]
)
def test_a_division_by_zero_is_found_whatever_it_is_written_as(expression):
    assert codes(signal(expression)) == ["SF224"]


@pytest.mark.parametrize(
    ("expression", "definitions"),
    [
        ("U/Z", 'Z = "k - k"'),
        ("U/Z", 'Z = "0"'),
        ("U/(k - Z)", 'Z = "k"'),
        ("U*Z^-1", 'Z = "Y - k"\nY = "k"'),
        ("Z*U", 'Z = "1/Y"\nY = "k - k"'),
    ],
)
def test_a_division_by_zero_is_found_through_definitions(expression, definitions):
    assert codes(signal(expression, definitions)) == ["SF224"]


def test_a_definition_of_zero_may_be_added():
    assert len(assemble(signal("U*(k + Z)", 'Z = "k - k"')).rows) == 1


def test_a_long_chain_of_reciprocal_definitions_is_quick():
    chain = 'd0 = "k"\n' + "\n".join(f'd{i} = "1/d{i - 1}"' for i in range(1, 100))
    (tf,) = pipeline.derive_all(pipeline.loads(signal("d99*U", chain)))
    assert str(tf.ratio) == "k^-1"


@pytest.mark.parametrize(
    ("expression", "definitions", "blocks"),
    [
        ("sqrt(s)*U", "", ""),
        ("sqrt(Z)*U", 'Z = "s*k"', ""),
        ("sqrt(Z)*U", 'Z = "Y + k"\nY = "s^2"', ""),
        ("exp(G)*U", "", 'G = { type = "integrator" }'),
        ("sqrt(G)*U", "", 'G = { type = "tf", num = "k" }'),
        ("sqrt(Z)*U", 'Z = "G"', 'G = { type = "tf", num = "k" }'),
    ],
)
def test_a_function_of_s_is_refused_however_it_is_reached(expression, definitions, blocks):
    with pytest.raises(symflex.SymflexError) as caught:
        assemble(signal(expression, definitions, blocks))
    assert {d.code for d in caught.value.diagnostics} == {"SF910"}


def test_every_problem_is_reported_at_its_place():
    text = signal("U/(k - k)").replace('X = "e"', 'X = "e/(m - m)"')
    with pytest.raises(ModelError) as caught:
        assemble(text)
    assert [d.span.text for d in caught.value.diagnostics] == ["k - k", "m - m"]


def test_an_output_s_divisor_may_be_a_sum():
    text = PENDULUM.replace('X = "x"', 'X = "x/(k + m)"')
    (output,) = assemble(text).outputs
    assert str(output.divisor) == "(m + k)"


def test_an_output_s_filter_is_no_unknown_of_the_others():
    text = PENDULUM.replace('X = "x"', 'X = "x"\nY = "x/(1 + m*s)"')
    assert [str(v) for v in assemble(text).unknowns] == ["x", "y"]
