"""The names of printed formulas, checked when the file is read."""

import pytest

from symflex.errors import Source, SpecError
from symflex.expressions import format_expression
from symflex.model import load_model

MODEL = """symflex = 1
[parameters]
m = "2 kg"
k = { value = "8 N/m" }
[definitions]
w_0 = "k/m"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
[published."X/F"]
"""


def codes(expr, where="", scale="1"):
    text = f'{MODEL}expr = "{expr}"\nwhere = {{ {where} }}\nscale = "{scale}"\n'
    try:
        load_model(Source("spec.toml", text))
    except SpecError as error:
        return [d.code for d in error.diagnostics]
    return []


def test_a_formula_of_known_names_is_accepted():
    for expr, where in [
        ("1/(m*s^2 + k)", ""),
        ("1/(m*(s^2 + w_0))", ""),
        ("exp(-s*T)*sqrt(s)^(1/2)", 'T = "1"'),
        ("1/a", 'a = "m*b", b = "s^2 + w_0"'),
        ("w_0", 'w_0 = "2"'),
        ("s^(-3/(1 + 1))", ""),
        ("x", 'x = "s"'),
    ]:
        assert codes(expr, where) == [], expr


def test_a_formula_with_a_mistake_is_refused():
    for expr, where, code in [
        ("1/(M*s^2)", "", "SF210"), ("erf(s)", "", "SF210"), ("a", 'a = "3*zz"', "SF210"),
        ("s", 'unused = "zz"', "SF210"), ("x", "", "SF212"), ("F", "", "SF212"), ("X", "", "SF212"),
        ("spring.f", "", "SF212"), ("X'", "", "SF212"), ("w'(0)", "", "SF212"),
        ("a", 'a = "b", b = "a"', "SF215"), ("k", 'k = "2*k"', "SF215"), ("w_0", 'k = "w_0"', "SF215"),
        ("s^m", "", "SF225"), ("s^pi", "", "SF225"),
    ]:  # fmt: skip
        assert codes(expr, where) == [code], (expr, where)


def test_the_scale_is_checked():
    assert codes("s", scale="zz") == ["SF210"]


def test_a_long_chain_of_lines_is_answered():
    lines = ", ".join(f'a{i} = "a{i + 1}*s"' for i in range(2000))
    assert codes("a0", lines + ', a2000 = "s"') == []


def test_a_name_with_a_mistake_of_its_own_is_not_called_unknown():
    text = MODEL.replace("8 N/m", "8 Nq/m") + 'expr = "1/k"\n'
    with pytest.raises(SpecError) as caught:
        load_model(Source("spec.toml", text))
    assert [d.code for d in caught.value.diagnostics] == ["SF201"]


def with_latex(latex, notation=""):
    text = f"{MODEL}latex = '{latex}'\n[notation]\n{notation}\n"
    return load_model(Source("spec.toml", text))


def test_a_formula_in_latex_is_the_same_formula():
    (published,) = with_latex(
        r"\frac{X(s)}{F(s)} = \frac{1}{m(s^2 + \omega_0^2)}, \text{ where } \omega_0 = \sqrt{k/m}"
    ).published
    assert format_expression(published.expression) == "1/(m*(s^2 + omega_0^2))"
    assert [(name, format_expression(line)) for name, line in published.where] == [("omega_0", "sqrt(k/m)")]


def test_notation_ties_symbols_of_a_paper():
    (published,) = with_latex(r"\frac{1}{Mp^2 + c_{1}}", 'M = "m"\np = "s"\n"c_{1}" = "k"').published
    assert format_expression(published.expression) == "1/(m*s^2 + k)"
    with pytest.raises(SpecError, match=r"unknown name 'kk' in \[notation\]"):
        with_latex("1", 'M = "kk"')
    with pytest.raises(SpecError, match=r"'a\+b' in \[notation\] is no symbol"):
        with_latex("1", '"a+b" = "k"')


def test_a_symbol_without_a_meaning_is_named_with_what_fits_its_place():
    with pytest.raises(SpecError) as caught:
        with_latex(r"\frac{1}{M s^2 + k}")
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF210"
    assert (problem.span.line, problem.span.text) == (15, "M")
    assert "it could be m [kg]" in problem.hint


def test_a_formula_is_given_once():
    with pytest.raises(SpecError, match="both 'expr' and 'latex'"):
        load_model(Source("spec.toml", f"{MODEL}expr = '1'\nlatex = '1'\n"))


def test_p_and_d_are_the_laplace_variable_where_nothing_else_is_left():
    for latex in (
        r"\frac{1}{mp^2 + k}",
        r"\frac{X}{F} = \frac{1}{mD^2 + k}",
        r"\frac{1}{k - m\omega^2}",
    ):
        (published,) = with_latex(latex).published
        assert "s^2" in format_expression(published.expression)
    with pytest.raises(SpecError, match="unknown name 'p'"):
        with_latex(r"\frac{p}{ms^2 + k}")
