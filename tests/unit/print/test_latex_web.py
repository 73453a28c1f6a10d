"""Mathematics for notebooks and pages holds only commands that KaTeX and MathJax both have."""

import re
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.algebra import FUNCTIONS
from symflex.expressions import Name, number, power, product_of, sum_of
from symflex.papers.labels import ALLOWED_COMMANDS
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.printed import forms_of
from symflex.print.latex import inline_latex, label_of, latex_fragment, notebook_latex
from symflex.print.latex.equation import LONGEST_IN_NOTEBOOK
from tests.independent.web_mathematics import COMMANDS, ENVIRONMENTS

DERIVATIONS = Path(__file__).parents[3] / "derivations"
KINDS = ("eppinger1988/rigid_body", "eppinger1988/sliding_free_beam", "classics/rod_tip_mass", "tapers/wedge")
"""Rational and with numbers, of beams and rods, and with Bessel functions."""
# What numbers an equation and lets pages break within it, in a paper.
OF_PAPERS = {"begin", "end", "label", "notag", "begingroup", "endgroup", "allowdisplaybreaks"}


def commands(latex):
    return set(re.findall(r"\\([A-Za-z]+)", latex))


def environments(latex):
    return set(re.findall(r"\\begin\{([^}]*)\}", latex))


@pytest.fixture(scope="module")
def printed():
    """Functions of models of several kinds in each of their forms."""
    # What differs between the functions of a model is not their commands.
    functions = [
        tf for stem in KINDS for tf in pipeline.derive_all(pipeline.load(DERIVATIONS / f"{stem}.toml"))[:2]
    ]
    return [(tf, print_form(tf, form)) for tf in functions for form in (None, *forms_of(tf))]


@pytest.mark.slow
def test_notebooks_hold_only_what_katex_and_mathjax_have_in_common(printed):
    latex = [notebook_latex(tf, form) for tf, form in printed]
    whole = "\n".join(line for line in latex if line is not None)
    assert commands(whole) - {"begin", "end"} <= COMMANDS
    assert environments(whole) == {"aligned"}
    assert {"aligned"} <= ENVIRONMENTS
    assert max(len(line) for line in latex if line is not None) <= LONGEST_IN_NOTEBOOK


def test_one_line_of_mathematics_has_no_environment(printed):
    assert commands("\n".join(inline_latex(tf, form) for tf, form in printed)) <= COMMANDS


def test_the_equations_of_a_paper_add_only_numbers_and_page_breaks(printed):
    whole = "\n".join(latex_fragment(tf, form, width_mm=88.5) for tf, form in printed)
    equations = "\n".join(line for line in whole.splitlines() if not line.startswith("%"))
    assert commands(equations) - OF_PAPERS <= COMMANDS
    assert environments(equations) <= {"equation", "align", "align*"}


@pytest.mark.slow
def test_a_formula_that_a_page_would_take_seconds_to_set_is_left_out(printed):
    tf, _ = printed[0]

    def notebook(terms, *, is_line):
        long = sum_of([product_of([Name("m"), power(Name("s"), i)]) for i in range(terms, 0, -1)])
        where = (("Z", long),) if is_line else ()
        return notebook_latex(tf, PrintedForm("test", Name("Z") if is_line else long, number(1), where))

    for is_line in (False, True):
        assert notebook(300, is_line=is_line) is not None
        assert notebook(2000, is_line=is_line) is None


def test_labels_and_functions_are_known_to_both():
    assert set(ALLOWED_COMMANDS) <= COMMANDS
    assert commands("".join(function.latex for function in FUNCTIONS.values())) <= COMMANDS
    oddest = ("W" * 64, "a__b", "a_" + "very_" * 11 + "long", "x1y2", "a" + "_" * 63, "EI")
    assert commands("".join(map(label_of, oddest))) <= COMMANDS
