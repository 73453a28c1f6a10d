"""Transfer functions as display mathematics."""

import re
from functools import cache
from pathlib import Path

import pytest
from flint import arb

from symflex import pipeline
from symflex.errors import UsageError
from symflex.expressions import Name, negative, number, power, product_of, quotient, sum_of
from symflex.print.forms import PrintedForm, print_form
from symflex.print.label import read_label
from symflex.print.latex import (
    equation_label,
    inline_latex,
    latex_document,
    latex_expression,
    latex_fragment,
    transfer_function_latex,
)
from symflex.roots import Certificate, Everything, PoleZeroMap, Root

DERIVATIONS = Path(__file__).parents[3] / "derivations" / "eppinger1988"


@pytest.fixture(scope="module")
def two_mass():
    return next(tf for tf in functions("two_mass") if tf.name == "V_tip/F")


@pytest.fixture(scope="module")
def rigid_body():
    return next(tf for tf in functions("rigid_body") if tf.name == "V_tip/V_cmd")


@cache
def functions(stem):
    return pipeline.derive_all(pipeline.load(DERIVATIONS / f"{stem}.toml"))


s = Name("s")
SHORT = PrintedForm("test", Name("k"), sum_of([product_of([Name("m_1"), s]), Name("b")]))
MANY = sum_of([product_of([Name(f"a_{i}"), power(s, i)]) for i in range(40, 0, -1)])


def test_a_short_formula_is_one_numbered_line(two_mass):
    assert transfer_function_latex(two_mass, SHORT, width_mm=160) == "\n".join(
        (
            r"\begin{equation}",
            r"  \label{eq:V_tip_over_F}",
            r"  \frac{V_{\mathrm{tip}}(s)}{F(s)} = \frac{k}{m_{1} s + b}",
            r"\end{equation}",
        )
    )


def test_a_minus_sign_stands_before_the_fraction(two_mass):
    form = PrintedForm("test", negative(Name("k")), s)
    assert r"= -\frac{k}{s}" in transfer_function_latex(two_mass, form, width_mm=160)


def test_a_denominator_of_one_is_not_printed(two_mass):
    form = PrintedForm("test", Name("k"), number(1))
    assert inline_latex(two_mass, form) == r"\frac{V_{\mathrm{tip}}(s)}{F(s)} = k"


def test_only_what_is_too_wide_is_named(two_mass):
    latex = transfer_function_latex(two_mass, PrintedForm("test", Name("k"), MANY), width_mm=160)
    assert r"&= \frac{k}{D(s)} \label{eq:V_tip_over_F} \\" in latex
    assert "N(s)" not in latex


def test_names_of_parameters_are_not_taken_for_numerator_and_denominator(two_mass):
    form = PrintedForm("test", Name("N"), MANY)
    assert r"\frac{N}{Q(s)}" in transfer_function_latex(two_mass, form, width_mm=160)


def test_a_display_of_many_lines_has_one_number(two_mass):
    latex = transfer_function_latex(two_mass, PrintedForm("test", MANY, MANY), width_mm=160)
    rows = re.split(r"\\\\\*?\n", latex)
    assert [r"\notag" in row for row in rows] == [False] + [True] * (len(rows) - 1)


def test_without_a_width_nothing_is_broken(two_mass):
    latex = transfer_function_latex(two_mass, PrintedForm("test", MANY, MANY), width_mm=None)
    assert "align" not in latex


def test_definitions_follow_as_where_lines(two_mass):
    form = PrintedForm("test", Name("Z"), s, (("Z", Name("k")), ("Y", quotient(number(1), Name("b")))))
    latex = transfer_function_latex(two_mass, form, width_mm=160)
    assert r"\text{where}\quad Z &= k \\" in latex
    assert r"Y &= \frac{1}{b}" in latex


def test_the_inline_form_is_one_line_with_its_definitions(two_mass):
    form = PrintedForm("test", Name("Z"), s, (("Z", Name("k")),))
    assert inline_latex(two_mass, form) == (
        r"\frac{V_{\mathrm{tip}}(s)}{F(s)} = \frac{Z}{s},\quad \text{where } Z = k"
    )


def test_the_label_holds_only_letters_digits_and_underscores():
    assert re.fullmatch(r"eq:[A-Za-z0-9._/]+", equation_label("V_tip}/V#%\\ä"))


def test_two_transfer_functions_never_share_a_label():
    ends = ("a", "over_a", "a_over", "over", "a_over_a", "_over_", "a_", "_a", "_")
    labels = [equation_label(f"{output}/{source}") for output in ends for source in ends]
    assert len(set(labels)) == len(labels)


def test_the_rigid_body_formula_reads_as_in_the_paper(rigid_body):
    # Eppinger & Seering 1988, section "Rigid-Body Dynamics", with the labels of the file.
    label = {p.name: p.latex or p.name for p in rigid_body.model.parameters}
    numerator = r" \, ".join(label[n] for n in ("k_amp", "k_preamp", "r", "k_tau"))
    latex = inline_latex(rigid_body, print_form(rigid_body))
    assert rf"= \frac{{{numerator}}}{{" in latex
    assert rf"({label['m_eff']} \, s + {label['b_eff']})" in latex
    feedback = r" \, ".join(label[n] for n in ("k_amp", "k_preamp", "k_tach"))
    assert rf"({feedback} + {label['k_bemf']})" in latex


def test_the_labels_of_the_file_are_printed(rigid_body):
    latex = latex_fragment(rigid_body, print_form(rigid_body))
    assert all(p.latex in latex for p in rigid_body.parameters if p.latex)
    assert all(read_label(p.latex) for p in rigid_body.parameters if p.latex)


def test_a_fragment_needs_nothing_but_amsmath(rigid_body):
    known = {"frac", "begin", "end", "label", "mathrm", "left", "right", "tau", "eqref", "text"}
    comment, needs, *lines = latex_fragment(rigid_body, print_form(rigid_body)).splitlines()
    assert (comment[0], needs) == ("%", r"% Needs \usepackage{amsmath}; for a column of 170 mm.")
    assert set(re.findall(r"\\([A-Za-z]+)", "\n".join(lines))) <= known


def document(tf, **keywords):
    return latex_document(tf.model, [tf], [print_form(tf)], **keywords)


def test_a_hidden_mode_is_named_in_words(two_mass):
    assert r"The factor $s$ cancels between numerator and denominator: the mode at $s = 0$ is hidden" in (
        document(two_mass)
    )


def test_the_quantity_and_its_unit_are_named(two_mass):
    assert r"The mobility, in \unit{\metre\per\newton\per\second}, with one zero and three poles:" in (
        document(two_mass)
    )


def test_title_and_source_are_escaped(two_mass):
    latex = document(two_mass)
    assert r"Eppinger \& Seering 1988" in latex


def test_an_empty_map_says_so(two_mass):
    empty = PoleZeroMap("V_tip/F", Everything(), (), (), (), Certificate("x", 0, 0))
    assert "neither poles nor zeros" in document(two_mass, pole_zero_maps=[empty])


def test_an_uncertified_map_gives_the_reason(two_mass):
    pole = Root(arb(-1), arb(0), 1, on_imaginary_axis=False, is_real=True)
    found = PoleZeroMap("V_tip/F", Everything(), (pole,), (), (), Certificate("x", 2, 1, "one is lost"))
    assert "not certified: one is lost." in document(two_mass, pole_zero_maps=[found])


def test_a_map_of_another_transfer_function_is_refused(two_mass):
    other = PoleZeroMap("X/Y", Everything(), (), (), (), Certificate("x", 0, 0))
    with pytest.raises(UsageError, match="SF902"):
        document(two_mass, pole_zero_maps=[other])


def test_every_transfer_function_of_a_model_has_a_subsection(two_mass):
    model, tfs = two_mass.model, functions("two_mass")
    latex = latex_document(model, tfs, [print_form(tf) for tf in tfs])
    assert latex.count(r"\subsection{") == len(model.transfer_functions)


def test_an_expression_of_the_formula_prints_alone(two_mass):
    form = print_form(two_mass)
    assert latex_expression(form.num, {}) in inline_latex(two_mass, form)
