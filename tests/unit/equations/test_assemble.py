"""The equations of a model, against the matrix written by hand, and what assembly refuses."""

from __future__ import annotations

import cmath
from importlib import import_module
from itertools import pairwise

import pytest

import symflex
from symflex import pipeline
from symflex.algebra import Factored
from symflex.equations.equations import Equations
from symflex.errors import BudgetError, ModelError

ROOM = import_module("symflex.equations.assemble")
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


def test_an_exact_value_of_a_function_is_a_number():
    for expression, value in [
        ("sqrt(9/4)", "3/2"),
        ("sin(0)", "0"),
        ("cos(k - k)", "1"),
        ("exp(0)", "1"),
        ("tanh(0)", "0"),
    ]:
        text = f'{HEADER}k = {{}}\n[inputs]\nU = {{}}\n[outputs]\nX = "({expression})*U"\n'
        (output,) = assemble(text).outputs
        found = "0" if not output.form.terms else str(output.form.terms[0][1] / output.divisor)
        assert found == value, expression


def signal(expression, definitions="", blocks=""):
    return (
        f"{HEADER}k = {{}}\nm = {{}}\n[definitions]\n{definitions}\n[blocks]\n{blocks}\n[signals]\n"
        f'e = "{expression}"\n[inputs]\nU = {{}}\n[outputs]\nX = "e"\n'
    )


def test_a_division_by_zero_is_found_through_definitions():
    for expression, definitions in [
        ("U*(m + k - m - k)^-2", ""),
        ("U/(k - Z)", 'Z = "k"'),
        ("U*Z^-1", 'Z = "Y - k"\nY = "k"'),
        ("Z*U", 'Z = "1/Y"\nY = "k - k"'),
    ]:
        assert codes(signal(expression, definitions)) == ["SF224"], (expression, definitions)


def test_a_function_of_s_is_refused_however_it_is_reached():
    for expression, definitions, blocks in [
        ("sqrt(s^2)*U", "", ""),
        ("sqrt(Z)*U", 'Z = "s*k + s^2"', ""),
        ("sqrt(Z)*U", 'Z = "Y + k"\nY = "s^2"', ""),
        ("exp(G)*U", "", 'G = { type = "integrator" }'),
        ("sqrt(G)*U", "", 'G = { type = "tf", num = "k" }'),
        ("sqrt(Z)*U", 'Z = "G"', 'G = { type = "tf", num = "k" }'),
    ]:
        with pytest.raises(symflex.SymflexError) as caught:
            assemble(signal(expression, definitions, blocks))
        assert {d.code for d in caught.value.diagnostics} == {"SF910"}, (expression, definitions)


def test_every_problem_is_reported_at_its_place():
    text = signal("U/(k - k)").replace('X = "e"', 'X = "e/(m - m)"')
    with pytest.raises(ModelError) as caught:
        assemble(text)
    assert [d.span.text for d in caught.value.diagnostics] == ["k - k", "m - m"]


def test_an_output_s_divisor_may_be_a_sum():
    text = PENDULUM.replace('X = "x"', 'X = "x/(k + m)"')
    (output,) = assemble(text).outputs
    assert str(output.divisor) == "(m + k)"


# ------------------------------------------------------------------------------------- limits and problems


def test_what_is_too_large_is_refused_with_the_way_round_it(monkeypatch):
    for limit, largest, text, message, hint in [
        (
            "GENERATOR_LIMIT",
            5,
            PENDULUM.replace("[elements]", '[definitions]\nc = "2*k"\n[elements]').replace(
                '"k"', '"c*sqrt(k*m)"'
            ),
            "5 parameters, definitions and functions of them; at most 4 are allowed",
            "write numbers in place of parameters that need no name",
        ),
        ("UNKNOWN_LIMIT", 2, PENDULUM, "2 unknowns; at most 1 are solved for", "split the model"),
    ]:
        with monkeypatch.context() as patch:
            patch.setattr(ROOM, limit, largest)
            assemble(text)
            patch.setattr(ROOM, limit, largest - 1)
            with pytest.raises(BudgetError) as caught:
                assemble(text)
            assert len(pipeline.assemble_sparse(pipeline.loads(text)).rows) == 2, limit
        (problem,) = caught.value.diagnostics
        assert (problem.code, problem.message) == ("SF502", f"the closed form is too large: {message}"), limit
        assert problem.hint == hint, limit


def test_equations_of_many_names_have_a_limit_of_their_own(monkeypatch):
    model = pipeline.loads(PENDULUM)
    for largest, is_refused in ((3, False), (2, True), (1, True)):
        monkeypatch.setattr(ROOM, "SPARSE_LIMIT", largest)
        if is_refused:
            with pytest.raises(BudgetError, match=f"at most {largest}"):
                pipeline.assemble_sparse(model)
        else:
            pipeline.assemble_sparse(model)


LARGE = f"({' + '.join(f'a{i}' for i in range(12))})^40 + 1"


def test_only_where_every_problem_is_one_of_size_is_it_a_matter_of_budget():
    for expressions, error, found in [
        ((LARGE,), BudgetError, ["SF501"]),
        ((LARGE, "1/(k - k)"), ModelError, ["SF501", "SF224"]),
        (("1/(k - k)",), ModelError, ["SF224"]),
    ]:
        rows = "\n".join(f'e{i} = "({e})*U"' for i, e in enumerate(expressions))
        names = "".join(f"{n} = {{}}\n" for n in ("k", *(f"a{i}" for i in range(12))))
        text = f'{HEADER}{names}[signals]\n{rows}\n[inputs]\nU = {{}}\n[outputs]\nX = "e0"\n'
        with pytest.raises(error) as caught:
            assemble(text)
        assert [d.code for d in caught.value.diagnostics] == found, expressions


def test_a_block_that_divides_by_zero_is_reported_once_wherever_it_is_used():
    blocks = 'A = { type = "tf", num = 1, den = "k - k" }\nB = { type = "tf", num = "A*m", den = "s + 1" }'
    with pytest.raises(ModelError) as caught:
        assemble(signal("A*B*U + U/A", "Z = 'A + 1'\nY = 'Z*k'", blocks))
    assert [(d.code, d.message, d.span.text) for d in caught.value.diagnostics] == [
        ("SF224", "block 'A' divides by zero", "A")
    ]


def test_a_block_of_what_is_not_available_is_reported_once_wherever_it_is_used():
    blocks = 'A = { type = "tf", num = "sqrt(Z)", den = 1 }\nB = { type = "tf", num = "A*m", den = "s + 1" }'
    assert codes(signal("A*B*U + U/A", "Z = 's^2*k'", blocks)) == ["SF910"]


def test_a_block_that_divides_by_a_definition_of_zero_is_found():
    blocks = 'A = { type = "tf", num = 1, den = "Z*s" }'
    with pytest.raises(ModelError) as caught:
        assemble(signal("A*U", "Z = 'k - k'", blocks))
    assert [(d.code, d.message, d.span.text) for d in caught.value.diagnostics] == [
        ("SF224", "block 'A' divides by zero", "A")
    ]


def test_a_definition_of_a_division_by_zero_is_reported_once():
    assert codes(signal("U*Z + U*Y", "Z = '1/(k - k)'\nY = 'Z + k'")) == ["SF224"]


def test_blocks_in_a_circle_are_named_in_the_order_they_refer_to_each_other():
    blocks = 'A = { type = "tf", num = "B", den = 1 }\nB = { type = "tf", num = "C", den = 1 }\n'
    with pytest.raises(ModelError) as caught:
        assemble(signal("A*U", "C = '2*A'", blocks))
    (problem,) = caught.value.diagnostics
    message = "blocks refer to each other in a circle: "
    assert (problem.code, problem.message.startswith(message)) == ("SF215", True)
    circle = problem.message.removeprefix(message).split(" -> ")
    assert (circle[0], set(circle), len(circle)) == (circle[-1], {"A", "B", "C"}, 4)
    assert all({"A": "B", "B": "C", "C": "A"}[a] == b for a, b in pairwise(circle))
    assert problem.span.text in "AB"


# --------------------------------------------------------------------------------------------- blocks


def response(text, s):
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return pipeline.bind(tf)(s)


def test_blocks_may_be_made_of_delays_and_of_each_other_in_any_order():
    for order in [(0, 1, 2), (2, 1, 0), (1, 2, 0)]:
        rows = (
            'D = { type = "delay", T = 0.25 }',
            'G = { type = "tf", num = "3*D", den = "s + 2" }',
            'H = { type = "tf", num = "G - D", den = 1 }',
        )
        text = signal("(H + w)*U", "w = 'G*D'", "\n".join(rows[i] for i in order))
        text = text.replace("k = {}", "k = 1").replace("m = {}", "m = 1")
        s = 1 + 3j
        d = cmath.exp(-s / 4)
        g = 3 * d / (s + 2)
        assert response(text, s) == pytest.approx(g - d + g * d, rel=1e-13), order


def test_a_delay_of_no_time_is_one():
    text = signal("D*U/(s + 1)", "", 'D = { type = "delay", T = "k - k" }')
    assert response(text.replace("k = {}", "k = 1").replace("m = {}", "m = 1"), 2j) == pytest.approx(
        1 / (1 + 2j)
    )


# ------------------------------------------------------------------------------ what else equations contain


ALONG = """symflex = 1
parameters = { E = 2, A = 3, rho = 5, l = 7, a = 1, k = 11 }
elements.rod = { type = "rod", between = ["x", "ground"], E = "E", A = "A", rho = "rho", l = "l" }
inputs = { F = { force = "x" }, p = {} }
outputs = { X = "x", W = "w(a + l)" }
[fields.string]
unknowns = ["w"]
domain = ["a", "a + l"]
equation = "k*w'' = s^2*w + p"
conditions = ["w(a)/(s + k) = x", "w'(a + l)/(k + 1)^2 = 0"]
"""


def test_what_rows_were_cleared_of_is_kept():
    """One factor (k + 1)^2 of a condition, and what the rod's rows are divided by; 1/(s + k) is a filter."""
    equations = assemble(ALONG)
    ring = equations.ring
    k, s = (ring.generator(n) for n in "ks")
    assert (equations.cleared.exponent_of(s + k), equations.cleared.exponent_of(k + 1)) == (0, 2)
    for row in equations.rows:
        for _, coefficient in row.form.terms:
            coefficient.expand()


def test_a_block_of_another_model_has_the_value_found_for_it_over_the_ring_of_the_equations(tmp_path):
    (tmp_path / "inner.toml").write_text(PENDULUM)
    outer = signal("3*G*U", blocks='G = { type = "model", spec = "inner.toml", tf = "X/F" }')
    (tmp_path / "outer.toml").write_text(outer)
    asked = []

    def nested(block, ring):
        asked.append(block.name)
        return Factored.generator(ring, "k") / (Factored.generator(ring, "s") + 5), Factored.number(ring, 1)

    equations = ROOM.assemble(pipeline.load(tmp_path / "outer.toml"), nested)
    assert set(asked) == {"G"}
    (row,) = equations.rows
    assert [(str(v), str(c)) for v, c in row.form.terms] == [("e", "-1*(s + 5)"), ("U", "3*k")]
