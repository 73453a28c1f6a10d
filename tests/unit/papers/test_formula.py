"""Formulas as papers type them. Each is from a public text; the reading beside it was written by hand."""

from __future__ import annotations

from math import isclose
from random import Random

import pytest

from symflex.errors import SpecError, Text
from symflex.expressions import (
    Call,
    Expression,
    Name,
    format_expression,
    number,
    parse,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.papers.formula import evaluated, read_latex
from symflex.papers.symbols import notation_of
from symflex.print.label import labels_of
from symflex.print.latex import latex_expression
from tests.unit.papers.reading import read

# LaTeX, the names that are known, the same formula in the grammar of specifications.
READ = (
    (r"\frac{\omega_n^2}{s^2 + 2\zeta\omega_n s + \omega_n^2}", "",
     "omega_n^2/(s^2+2*zeta*omega_n*s+omega_n^2)"),
    (r"G(s) = \frac{\theta(s)}{V(s)} = \frac{K_t}{s\left[(Js + b)(Ls + R) + K_t K_b\right]}", "",
     "K_t/(s*((J*s+b)*(L*s+R)+K_t*K_b))"),
    (r"\frac{K_m/J}{s^2 + (c/J)\,s + mgd/J}", "", "K_m/J/(s^2+c/J*s+m*g*d/J)"),
    (r"\frac{2{,}792}{s^2 + 0{,}717\,s + 9{,}985}", "", "2.792/(s^2+0.717*s+9.985)"),
    (r"\dfrac{\frac{1}{sC}}{R + \frac{1}{sC}}", "", "1/(s*C)/(R+1/(s*C))"),
    (r"\frac{V_\mathrm{out}(s)}{V_\mathrm{in}(s)} = \frac{\left(\frac{R}{L}\right)s}{s^2 + \frac RLs}", "",
     "R/L*s/(s^2+R/L*s)"),
    (r"\[ \frac{C(s)}{A(s)C(s)-B^2(s)} \]", "", "C/(A*C-B^2)"),
    (r"\frac{\log x_1}{\log x_2} + \log_{10}(a) + \log_e b", "", "log(x_1)/log(x_2)+log(a)/log(10)+log(b)"),
    (r"\frac{(I + ml^2) s^2 - mgl}{mls^2} \tag{16}", "m l g I", "((I+m*l^2)*s^2-m*g*l)/(m*l*s^2)"),
    (r"-\frac{P\beta}{2k} \cdot \frac{2 + \cos\beta L + \cosh\beta L}{\sin\beta L + \sinh\beta L}", "",
     "-P*beta/(2*k)*(2+cos(beta*L)+cosh(beta*L))/(sin(beta*L)+sinh(beta*L))"),
    (r"\tfrac{1}{2}(\cosh\xi\sin\xi + \sinh\xi\cos\xi)", "", "(cosh(xi)*sin(xi)+sinh(xi)*cos(xi))/2"),
    (r"\frac{1-\cos2\beta L}{4\beta}=\frac{\sin^2\beta L}{2\beta}", "", "sin(beta*L)^2/(2*beta)"),
    (r"\dfrac{K}{s(Ts+1)} e^{-\tau s}", "", "K/(s*(T*s+1))*exp(-tau*s)"),
    (r"\sqrt{(R'+j\omega L')/(G'+j\omega C')}", "", "sqrt((R_p+s*L_p)/(G_p+s*C_p))"),
    (r"\frac{1}{k - m\omega^2 + jc\omega}", "k m c", "1/(k+m*s^2+c*s)"),
    (r"H(i\omega) = \frac{1}{m(\omega_0^2 - \omega^2 + 2i\beta\omega)}", "",
     "1/(m*(omega_0^2+s^2+2*beta*s))"),
    (r"-\frac j{\omega C}", "", "1/(s*C)"),
    (r"\cosh\left(\sqrt[4]{\frac{m\omega^2}{k}}\right) + e^{-j\omega T}", "m k T",
     "cosh((-m*s^2/k)^(1/4))+exp(-s*T)"),
    (r"H(p)=\dfrac{K}{1+2\xi p/\omega_0+p^2/\omega_0^2}.", "", "K/(1+2*xi*s/omega_0+s^2/omega_0^2)"),
    (r"K_p \cdot \left(1 + \frac{1}{T_i s} + T_d s\right)", "", "K_p*(1+1/(T_i*s)+T_d*s)"),
    (r"M\bigg[\frac{p}{s+p}\bigg]e^{-\Delta Ts}", "", "M*p/(s+p)*exp(-Delta*T*s)"),
    (r"\boxed{G(s) = \frac{4}{s(1{,}6s + 1)}}", "", "4/(s*(1.6*s+1))"),
    (r"\begin{vmatrix}\cosh\gamma l&Z\sinh\gamma l\\\frac1{Z}\sinh\gamma l&\cosh\gamma l\end{vmatrix}", "",
     "cosh(gamma*l)^2-sinh(gamma*l)^2"),
    (r"\begin{align} G &= a \nonumber \\ &\quad + \frac{b}{c} \label{eq:g} \end{align}", "", "a+b/c"),
    (r"\begin{multline} G = a \\ (b+c) \end{multline}", "", "a*(b+c)"),
    (r"\underbrace{a+b}_{\text{both}}\,c", "", "(a+b)*c"),
    (r"x_1^2 + x^2_1 + \ddot{x}_1' + \hat{k}", "", "2*x_1^2 + x_ddot_p_1 + k_hat"),
    (r"\prod_{i=1}^{3} (s+p_i)", "", "(s+p_1)*(s+p_2)*(s+p_3)"),
    (r"e^{-\sqrt{T}p} \sin \sqrt{T}p", "T p", "exp(-sqrt(T)*p)*sin(sqrt(T)*p)"),
    (r"2ml^2s^2 + mgls^2", "m l g", "2*m*l^2*s^2 + m*g*l*s^2"),
    (r"EIs + \rho As", "EI rhoA", "EI*s + rhoA*s"),
    (r"\frac{k_{\mathrm{back-emf}}}{k_{tach}}", "k_back_emf k_tach", "k_back_emf/k_tach"),
    (r"{\rm e}^{-sT} + \mathrm{e}^{a} + \exp\left(-\frac{s}{b}\right)", "", "exp(-s*T)+exp(a)+exp(-s/b)"),
    (r"s\tau/2 + a\over b", "", "(s*tau/2+a)/b"),
)  # fmt: skip


def test_printed_formulas_are_read_as_a_person_reads_them() -> None:
    wrong = []
    for latex, known, reading in READ:
        found, expected = (evaluated(e) for e in (read(latex, known), parse(Text.alone("own", reading))))
        if not isclose(abs(found - expected), 0, abs_tol=1e-9 * abs(expected)):
            wrong.append((latex, format_expression(read(latex, known))))
    assert wrong == []


def test_what_symflex_prints_in_latex_is_read_back() -> None:
    names = ["m_1", "EI", "omega_n", "k_eff", "l", "theta", "s"]
    labels = labels_of([(n, "") for n in names[:-1]], {"s": "s"})
    draw = Random(3)

    def tree(depth: int) -> Expression:
        if not depth or draw.random() < 0.2:
            return Name(draw.choice(names)) if draw.random() < 0.8 else number(draw.randint(1, 9))
        parts = [tree(depth - 1) for _ in range(2)]
        function = draw.choice(["sqrt", "exp", "sin", "cosh"])
        shapes = (
            sum_of(parts),
            product_of(parts),
            quotient(*parts),
            power(parts[0], 3),
            Call(function, parts[0]),
        )
        return draw.choice(shapes)

    wrong = []
    for expression in (tree(3) for _ in range(150)):
        latex = latex_expression(expression, labels)
        try:
            (back,), _ = read_latex(Text.alone("printed.tex", latex), notation_of(list(labels.items())))
        except SpecError as error:
            assert "two ways" in str(error)
            continue
        first, second = evaluated(expression), evaluated(back)
        if not isclose(abs(first - second), 0, abs_tol=1e-9 * abs(first)):
            wrong.append((latex, format_expression(back)))
    assert wrong == []


TWO_READINGS = (
    r"\sin \omega t s",
    "1/2k",
    "a/b c",
    "a/(b)(c)",
    "a/b/c",
    r"\sin x/2",
    r"\cos\theta g",
    r"\cos(n+1)x",
    r"\sin(x)^2",
    r"\sin x^2",
    r"\sin^{-1}x",
    "f(a)",
    "x2",
    "1e3",
    r"\log x",
    r"\cosh\sqrt{a}\frac{b}{c}",
    r"K(-s)",
    "{ms}^2",  # braces do not show
    "c{s+k}",
    r"1\frac12m",  # one and a half
)


@pytest.mark.parametrize("latex", TWO_READINGS)
def test_what_print_leaves_open_is_refused_with_its_place(latex: str) -> None:
    with pytest.raises(SpecError) as caught:
        read(latex)
    (problem,) = caught.value.diagnostics
    assert problem.code == "SF115"
    assert problem.span is not None
    assert problem.span.source.name == "paper.tex"


def test_both_readings_are_in_the_message() -> None:
    with pytest.raises(SpecError, match=r"two ways: 1/2\*k or 1/\(2\*k\)"):
        read("1/2k")


def test_readings_that_agree_are_one_formula() -> None:
    assert format_expression(read(r"s\tau/2")) == "s*tau/2"


def test_a_parameter_before_the_laplace_variable_in_brackets_may_be_a_product() -> None:
    with pytest.raises(SpecError, match="two ways"):
        read("k(s)", "k")
    assert format_expression(read("k(s+1)", "k")) == "k*(s + 1)"


def test_definitions_after_where_are_lines() -> None:
    text = Text.alone(
        "paper.tex", r"G = \frac{S}{p}, \text{ where } S = p^2,\quad a^2 = \frac{b}{c}, p = \frac sa"
    )
    (formula,), lines = read_latex(text, notation_of([]))
    assert format_expression(formula) == "S/p"
    assert {name: format_expression(line) for name, line in lines} == {
        "S": "p^2",
        "a": "sqrt(b/c)",
        "p": "s/a",
    }
