"""A paper judged by models. The right formulas are textbook ones; the slips in others were planted here."""

from __future__ import annotations

import pytest

from symflex.audit import audit
from symflex.errors import Text
from symflex.model import Model
from symflex.papers.source import read_text
from symflex.pipeline import loads
from symflex.report.page import report_page
from symflex.report.referee import (
    errata_latex,
    referee,
    referee_document,
    referee_page,
    referee_tables,
    referee_text,
)

MODEL = """
symflex = 1
title = "Two masses"
parameters = { m_1 = "1 kg", m_2 = "2 kg", k = "5 N/m", b = "0.2 N*s/m" }
inputs = { F = { force = "x_1" } }
outputs = { X_1 = "x_1", X_2 = "x_2" }
[elements]
a = { type = "mass", at = "x_1", m = "m_1" }
c = { type = "mass", at = "x_2", m = "m_2" }
spring = { type = "spring", between = ["x_1", "x_2"], k = "k" }
damper = { type = "damper", between = ["x_1", "x_2"], b = "b" }
[notation]
M = "m_2"
"""
PAPER = r"""
\newcommand{\D}{\Delta}
\begin{align}
\frac{X_1(s)}{F(s)} &= \frac{Ms^2 + bs + k}{\D} \label{one} \\
X_2(s) &= \frac{bs + 2k}{\D} F(s) \label{two} \\
\frac{x_2}{F} &= 2\frac{bs + k}{\D} \tag{3} \\
\frac{Y}{U} &= \frac{q}{s} \label{other} \\
G(s) &= \frac{bs+k}{s^2[m_1 M s^2 + (m_1+M)(bs+k)]} \label{found} \\
\frac{X_1}{F} &= \sum_i a_i \label{sum}
\end{align}
with $\D = s^2[m_1 M s^2 + (m_1+M)(bs+k)]$.
"""


@pytest.fixture(scope="module")
def model() -> Model:
    return loads(MODEL)


def judged(model: Model, paper: str = PAPER, only: str | None = None):
    return referee(read_text(Text.alone("paper.tex", paper)), [model], only)


def test_each_displayed_formula_gets_its_verdict(model: Model) -> None:
    found = {j.label: (j.verdict, j.slip) for j in judged(model)}
    assert found["one"] == ("equal", "")
    assert found["two"] == ("different", "numerator: 2*k should be k")
    assert found["(3)"] == ("factor", "it is 2 times the derived function")
    assert found["found"] == ("equal", "")
    assert found["other"][0] in ("not read", "other model")
    assert found["sum"][0] == "not read"


def test_a_letter_may_be_two_functions_of_a_paper(model: Model) -> None:
    # G is X_1/F in the first line; its other values are X_2/F, as in the third, and a slip of X_1/F.
    paper = r"""\begin{align}
G(s) = \frac{X_1(s)}{F(s)} &= \frac{Ms^2 + bs + k}{s^2[m_1 M s^2 + (m_1+M)(bs+k)]} \\
G(s) &= \frac{bs + k}{s^2[m_1 M s^2 + (m_1+M)(bs+k)]} \\
G(s) &= \frac{Ms^2 + bs + 2k}{s^2[m_1 M s^2 + (m_1+M)(bs+k)]}
\end{align}"""
    first, second, third = judged(model, paper)
    assert (first.verdict, second.verdict, third.verdict) == ("equal", "equal", "different")
    assert second.reason == "G is X_1/F and X_2/F in this paper; this is compared with X_2/F"
    assert third.slip == "numerator: 2*k should be k"


def test_one_equation_is_judged_alone(model: Model) -> None:
    (alone,) = judged(model, only="3")
    assert (alone.label, alone.verdict, alone.span.line) == ("(3)", "factor", 6)


def test_json_has_every_formula_and_no_tables(model: Model) -> None:
    document = referee_document("paper.tex", judged(model))
    assert document["schema"] == "symflex.referee/1"
    assert document["tables"] == []
    two = document["formulas"][1]
    assert {k: two[k] for k in ("label", "line", "verdict", "slip", "reason", "tf")} == {
        "label": "two",
        "line": 5,
        "verdict": "different",
        "slip": "numerator: 2*k should be k",
        "reason": None,
        "tf": "X_2/F",
    }


def test_text_page_and_errata_name_the_slip(model: Model) -> None:
    found = judged(model)
    assert "two, line 5   X_2/F   DIFFERS (proved)\n  numerator: 2*k should be k" in referee_text(found)
    page = report_page(referee_page("paper.tex", found))
    assert "DIFFERS" in page
    assert "<script" not in page
    assert errata_latex(found).splitlines()[1] == r"  \item Eq.~\eqref{two}: for $2 k$ read $k$."


def test_brackets_left_out_after_a_root_are_named(model: Model) -> None:
    paper = r"""\[ \frac{X_2}{F} = \frac{\sqrt{4} b s + k}{2s^2[m_1 M s^2 + (m_1+M)(bs+k)]} \]"""
    (one,) = judged(model, paper)
    assert one.verdict == "different"
    assert one.slip


CHAIN = """
symflex = 1
parameters = { m_1 = "1 kg", m_2 = "3 kg", m_3 = "2 kg", k = "4 kN/m" }
inputs = { F = { force = "x" } }
outputs = { X = "x" }
[elements]
a = { type = "mass", at = "x", m = "m_1" }
b = { type = "mass", at = "y", m = "m_2" }
c = { type = "mass", at = "z", m = "m_3" }
s = { type = "spring", between = ["ground", "x"], k = "k" }
t = { type = "spring", between = ["x", "y"], k = "k" }
u = { type = "spring", between = ["y", "z"], k = "k" }
"""
TABLES = r"""
\begin{tabular}{lcc} Mode & Present & Test \\ \hline
1 & 2.9843 & 3.5 \\ 2 & 9.2865 & 9.2 \\ 3 & 15.023 & 15.9 \\ \hline \end{tabular}
\begin{tabular}{lcc} part & mass & length \\ A & 1.5 & 300 \\ B & 17 & 4 \\ C & 1 & 2 \end{tabular}
"""


def test_tables_near_the_poles_of_a_model_are_judged():
    # numpy.linalg.eigh of the chain: 2.984361, 9.286529 and 15.023461 Hz.
    first, second = referee_tables(read_text(Text.alone("paper.tex", TABLES)), [loads(CHAIN)])
    assert first.audit is not None
    assert first.audit.reading == "f [Hz]"
    assert [e.verdict for e in first.audit.entries] == ["rounded", "right", "right"]
    assert second.audit is None
    document = referee_document("paper.tex", (), (first, second))
    assert [t["verdict"] for t in document["tables"]] == ["rounded", "other model"]
    assert "not about the poles" in referee_text((), (first, second))
    assert "badly rounded" in report_page(referee_page("paper.tex", (), (first, second)))


OSCILLATOR = """
symflex = 1
parameters = { m = "2 kg", c = "4 N*s/m", k = "800 N/m", zeta = "0.3", omega_0 = "3 rad/s" }
inputs = { F = { force = "x" } }
outputs = { X = "x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
damper = { type = "damper", between = ["x", "ground"], b = "c" }
"""


def test_a_papers_definitions_stand_for_parameters_of_the_model():
    paper = r"""where $\omega_0=\sqrt{k/m}$ and $\zeta=\frac{c}{2\sqrt{km}}$.
    \[ \frac{X}{F} = \frac{1/m}{s^2+2\zeta\omega_0s+\omega_0^2} \]"""
    (found,) = referee(read_text(Text.alone("paper.tex", paper)), [loads(OSCILLATOR)])
    assert found.verdict == "equal"


def test_a_letter_that_was_a_transfer_function_is_one_where_it_comes_again():
    paper = r"\[ H(s) = \frac{X}{F} = \frac{1}{ms^2+cs+k} \] \[ H(s) = \frac{1}{ms^2+cs+2k} \]"
    first, second = referee(read_text(Text.alone("paper.tex", paper)), [loads(OSCILLATOR)])
    assert (first.verdict, second.verdict) == ("equal", "different")


COIL = """
symflex = 1
parameters = { R = {}, C = {} }
inputs = { U = {}, D = {} }
outputs = { Y = "(U - D)/(R*C*s + 1)" }
"""
"""A low-pass filter by hand: R C y' + y = u - d."""


def verdicts(latex: str, spec: str = COIL) -> list[tuple[str, str]]:
    return [(j.verdict, j.reason) for j in judged(loads(spec), f"$$ {latex} $$")]


@pytest.mark.parametrize(
    ("latex", "verdict"),
    [
        (r"\frac{Y}{U} = \frac{1}{RCs + 1} = \frac{1/R}{Cs + 1/R}", "equal"),
        (r"\frac{Y}{U} = \frac{1/R}{C + 1/R} = \frac{1}{RCs + 1}", "different"),
        (r"G(s) = \frac{1/R}{C + 1/R} = \frac{1}{RCs + 1}", "different"),
        (r"H = \frac{Z_C}{Z_R + Z_C} = \frac{1}{RCs + 1}", "equal"),
    ],
)
def test_the_worst_side_of_an_equation_counts_if_its_symbols_have_a_meaning(latex, verdict):
    ((found, _),) = verdicts(latex)
    assert found == verdict


def test_audit_judges_the_sides_of_an_equation_as_referee_does():
    """Where a middle side is wrong, both say so."""
    middle = r"\\frac{Y}{U} = \\frac{1/R}{C + 1/R} = \\frac{1}{RCs + 1}"
    (found,) = audit(loads(f'{COIL}published."Y/U" = {{ latex = "{middle}" }}'))
    ((verdict, _),) = verdicts(middle.replace("\\\\", "\\"))
    assert (found.verdict, verdict) == ("differs", "different")


def test_a_side_that_is_not_judged_is_named():
    ((found, reason),) = verdicts(r"\frac{Y}{U} = \frac{1}{RCs + 1} = \frac{\omega_g}{s + R C \omega_g}")
    assert found == "equal"
    assert reason.startswith("one of its sides is not judged: symbols without a meaning: omega_g")


def test_an_equation_of_an_output_and_several_inputs_is_solved_by_superposition():
    ((right, _),) = verdicts(r"RCsY(s) + Y(s) = U(s) - D(s)")
    ((wrong, _),) = verdicts(r"RCsY(s) + Y(s) = U(s) + D(s)")
    ((free, _),) = verdicts(r"RCsY(s) + X(s) = U(s)")
    assert (right, wrong, free) == ("equal", "factor", "other model")


def test_a_definition_with_its_value_is_what_it_says_in_symbols():
    paper = r"\frac{Y}{U} = \frac{1}{\tau s + 1}, \qquad \tau = R C = 0.03\ \mathrm{s}"
    assert verdicts(paper)[0] == ("equal", "")


def test_numbers_are_no_difference_where_the_model_has_no_values():
    ((found, reason),) = verdicts(r"\frac{Y}{U} = \frac{1}{0.03 s + 1}")
    assert (found, "the model has no values for" in reason) == ("not read", True)


def test_beside_a_frequency_i_is_no_current():
    spec = (
        'symflex = 1\nparameters = { R = {}, L = {} }\ninputs = { I = {} }\noutputs = { V = "(R + L*s)*I" }'
    )
    assert verdicts(r"Z = R + i \omega L", spec)[0][0] == "equal"


def test_a_letter_that_is_said_anew_is_no_formula_for_its_new_meaning():
    spec = """
    symflex = 1
    parameters = { K = {}, G = {} }
    inputs = { X = {} }
    outputs = { Y = "K*G/(1 + K*G)*X", E = "X/(1 + K*G)" }
    """
    paper = r"$$ T = \frac{Y}{X} = \frac{KG}{1 + KG} $$ $$ T = \frac{E}{X} = \frac{1}{1 + KG} $$"
    assert [j.verdict for j in judged(loads(spec), paper)] == ["equal", "equal"]


def test_a_function_by_the_letter_of_a_parameter_is_refused():
    spec = """
    symflex = 1
    parameters = { K = {}, J = {}, K_p = {} }
    inputs = { V = {} }
    outputs = { E = "1/(1 + K_p*K/(J*s))*V" }
    """
    paper = r"$$ K(s) = K_p, \quad G(s) = \frac{K}{Js} $$ $$ \frac{E(s)}{V(s)} = \frac{1}{1 + K(s)G(s)} $$"
    last = judged(loads(spec), paper)[-1]
    assert (last.verdict, last.reason) == (
        "not read",
        "K(s) is a function by line 1, and K a parameter of the model",
    )


MASS = """
symflex = 1
parameters = { m = "2 kg", b = "0.3 N*s/m", k = "7 N/m" }
inputs = { F = {} }
outputs = { X = "F/(m*s^2 + b*s + k)" }
"""


@pytest.mark.parametrize(
    ("latex", "verdict", "said"),
    [
        (
            r"\frac{X}{F} = \frac{1}{ms^2 + k}",
            "different",
            "denominator: b*s is missing; it is right where b = 0",
        ),
        (r"\frac{X}{F} = \frac{0.5}{s^2 + 0.15 s + 3.5}", "equal", ""),
        (r"\frac{X}{F} = \frac{0.14}{0.29 s^2 + 0.043 s + 1}", "equal", ""),
        (r"\frac{X}{F} = \frac{0.14}{0.29 s^2 + 0.053 s + 1}", "different", None),
    ],
)
def test_numbers_count_to_their_digits_and_neglected_terms_are_named(latex, verdict, said):
    """By hand: 1/k = 0.142857, m/k = 0.285714, b/k = 0.0428571."""
    ((found),) = judged(loads(MASS), f"$$ {latex} $$")
    assert found.verdict == verdict
    if said is not None:
        assert found.slip == said


def test_vectors_are_judged_row_by_row():
    right = (
        r"\begin{pmatrix} X_1 \\ X_2 \end{pmatrix} = \begin{pmatrix} bs + k + m_2s^2 \\ bs + k \end{pmatrix}"
    )
    whole = rf"$$ {right} \frac{{F}}{{s^2(m_1m_2s^2 + (m_1+m_2)(bs+k))}} $$"
    ((one),) = judged(loads(MODEL), whole)
    ((other),) = judged(loads(MODEL), whole.replace("m_2s^2 \\", "2m_2s^2 \\"))
    assert (one.verdict, other.verdict) == ("equal", "different")


def test_a_frequency_in_a_definition_alone_is_the_laplace_variable():
    spec = """
    symflex = 1
    parameters = { R = {}, C = {} }
    inputs = { U = {} }
    outputs = { Y = "1/(1 - (R*C*s)^2)*U" }
    """
    paper = r"$$ \frac{Y(j\omega)}{U(j\omega)} = \frac{1}{1 + q^2}, \quad q^2 = R^2C^2\omega^2 $$"
    assert judged(loads(spec), paper)[0].verdict == "equal"


def test_sides_before_a_sign_of_nearness_are_judged():
    ((found, reason),) = verdicts(r"\frac{Y}{U} = \frac{1}{RCs + 1} \approx \frac{1}{RCs}")
    assert (found, reason) == (
        "equal",
        "one of its sides is not judged: it holds only nearly, by its sign",
    )
    assert verdicts(r"\frac{Y}{U} \approx \frac{1}{RCs + 1}")[0][0] == "not read"


CART = """
symflex = 1
parameters = { M = {}, m = {}, l = {}, I = {}, g = {}, b = {} }
inputs = { u = { unit = "N" } }
outputs = { X = "x", Phi = "phi" }
[equations]
unknowns = ["x", "phi"]
equations = ["(M + m)*x'' + b*x' - m*l*phi'' = u", "(I + m*l^2)*phi'' - m*g*l*phi = m*l*x''"]
"""
CUBIC = r"((M+m)(I+ml^2) - m^2l^2)s^3 + b(I+ml^2)s^2 - (M+m)mgls - bmgl"


@pytest.mark.parametrize(
    ("latex", "verdict", "said"),
    [
        (r"\frac{X}{\Phi} = \frac{(I + ml^2)s^2 - mgl}{mls^2}", "equal", ""),
        (r"X(s) = \left[\frac{I+ml^2}{ml} - \frac{g}{s^2}\right]\Phi(s)", "equal", ""),
        (r"(I+ml^2)\ddot\phi - mgl\phi = ml\ddot x", "equal", ""),
        (r"\frac{X + l\Phi}{\dot\phi} = \frac{(I + 2ml^2)s^2 - mgl}{mls^3}", "equal", ""),
        (r"\frac{\dot\phi}{U} = \frac{mls^2}{CUBIC}", "equal", ""),
        (r"CUBIC = 0", "equal", ""),
        (r"\frac{X}{\Phi} = \frac{(I + ml^2)s^2 + mgl}{mls^2}", "different", "m*g*l should be -m*g*l"),
        (r"(M+m)\ddot x + b\dot x - ml\phi = u", "different", "Phi should be -m*l*Phi*s^2"),
        (r"(M-m)\ddot x = u + 3", "other model", ""),
        (r"\dot x = u", "other model", ""),
        (r"CUBIC + M = 0", "other model", ""),
    ],
)
def test_equations_of_motion_ratios_of_outputs_and_characteristic_equations(latex, verdict, said):
    # The cart's equations by hand: (I + m l^2) phi'' = m l (g phi + x''), (M + m) x'' + b x' = u + m l phi''.
    (found,) = judged(loads(CART), f"\\[ {latex.replace('CUBIC', CUBIC)} \\]")
    assert found.verdict == verdict
    assert said in found.slip


def test_a_characteristic_equation_is_not_judged_by_an_earlier_one():
    paper = rf"\begin{{align}} \Delta(s) &= {CUBIC} = 0 \\ \Delta(s) &= {CUBIC} + M = 0 \end{{align}}"
    assert [j.verdict for j in judged(loads(CART), paper)] == ["equal", "other model"]


def test_one_force_of_an_equation_of_motion_is_not_called_wrong():
    spec = OSCILLATOR.replace(', zeta = "0.3", omega_0 = "3 rad/s"', "")
    ((found, reason),) = verdicts(r"F = c\dot x", spec)
    assert (found, "it has no m, k" in reason) == ("other model", True)
    assert verdicts(r"m\ddot x + c\dot x - kx = F", spec)[0][0] == "different"


def test_a_ratio_of_outputs_is_compared_for_the_input_that_explains_it_best():
    spec = """
symflex = 1
parameters = { J = {}, K = {}, c = {} }
inputs = { M = {}, T = {} }
outputs = { A = "a", B = "b" }
[equations]
unknowns = ["a", "b"]
equations = ["J*a'' + c*(a - b) = M", "K*b'' + c*(b - a) = T"]
"""
    (found,) = judged(loads(spec), r"\[ \frac{B}{A} = \frac{c}{Js^2 + c} \]")
    assert (found.verdict, found.slip) == ("different", "denominator: J should be K")


def test_an_output_is_a_fraction_of_a_sum_of_inputs():
    said = verdicts(r"Y(s) = \frac{U(s) - D(s)}{RCs + 1}"), verdicts(r"Y(s) = \frac{U(s) + D(s)}{RCs + 1}")
    assert [found for ((found, _),) in said] == ["equal", "factor"]


def test_beside_the_imaginary_unit_omega_is_no_output_that_is_called_so():
    spec = (
        'symflex = 1\nparameters = { J = {}, b = {} }\ninputs = { T = {} }\noutputs = { Omega = "x" }\n'
        'equations = { unknowns = ["x"], equations = ["J*x\' + b*x = T"] }'
    )
    paper = r"\frac{\Omega(j\omega)}{T(j\omega)} = \frac{1}{J j\omega + b}"
    assert verdicts(paper, spec)[0][0] == "equal"


@pytest.mark.slow
@pytest.mark.parametrize(("sign", "verdict"), [("+", "equal"), ("-", "other model")])
def test_a_beams_characteristic_equation_is_right_without_the_powers_of_its_wavenumber(sign, verdict):
    spec = """
symflex = 1
parameters = { E = {}, I = {}, rho = {}, A = {}, l = {} }
inputs = { F = { force = "tip" } }
outputs = { Y = "tip" }
[elements]
wall = { type = "fixed", at = "root" }
arm = { type = "beam", between = ["root", "tip"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
"""
    paper = rf"\[ 1 {sign} \cos\beta l\cosh\beta l = 0 \] where $\beta^4 = \rho A\omega^2/(EI)$."
    assert judged(loads(spec), paper)[0].verdict == verdict
