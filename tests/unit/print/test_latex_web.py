"""Mathematics for notebooks and pages holds only commands that KaTeX and MathJax both have."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.algebra import FUNCTIONS
from symflex.errors import SymflexError
from symflex.model.labels import ALLOWED_COMMANDS
from symflex.print.forms import print_form
from symflex.print.forms.printed import forms_of
from symflex.print.latex import inline_latex, label_of, latex_fragment, notebook_latex
from symflex.print.latex.equation import LONGEST_IN_NOTEBOOK
from tests.house.repository import specifications
from tests.independent.web_mathematics import COMMANDS, ENVIRONMENTS

DERIVATIONS = Path(__file__).parents[3] / "derivations"
LONG = {"six_mass", "fitted_resonances", "polynomial_resonance"}
"""Models whose expanded forms run over pages."""
# What numbers an equation and lets pages break within it, in a paper.
OF_PAPERS = {"begin", "end", "label", "notag", "begingroup", "endgroup", "allowdisplaybreaks"}


def commands(latex):
    return set(re.findall(r"\\([A-Za-z]+)", latex))


def environments(latex):
    return set(re.findall(r"\\begin\{([^}]*)\}", latex))


@pytest.fixture(scope="module")
def printed():
    """Every transfer function of the repository in each of its forms."""
    found = []
    for path in specifications(DERIVATIONS, "**/*.toml"):
        tfs = pipeline.derive_all(pipeline.load(path))
        # What differs between the functions of a model is not their commands, and expanded forms can be long.
        for tf in tfs[:2]:
            for form in (None, *forms_of(tf)) if path.stem not in LONG else (None, "monic"):
                try:
                    found.append((tf, print_form(tf, form)))
                except SymflexError:
                    continue  # zpk of what has no numbers
    return found


@pytest.mark.slow
def test_notebooks_hold_only_what_katex_and_mathjax_have_in_common(printed):
    latex = [notebook_latex(tf, form) for tf, form in printed]
    whole = "\n".join(line for line in latex if line is not None)
    assert commands(whole) - {"begin", "end"} <= COMMANDS
    assert environments(whole) <= ENVIRONMENTS
    assert sum(line is not None for line in latex) > 100


@pytest.mark.slow
def test_one_line_of_mathematics_has_no_environment(printed):
    whole = "\n".join(inline_latex(tf, form) for tf, form in printed if form.name != "monic")
    assert commands(whole) <= COMMANDS


@pytest.mark.slow
def test_the_equations_of_a_paper_add_only_numbers_and_page_breaks(printed):
    shorter = [(tf, form) for tf, form in printed if tf.model.title[:3] != "Six" or form.name != "monic"]
    whole = "\n".join(latex_fragment(tf, form, width_mm=88.5) for tf, form in shorter)
    equations = "\n".join(line for line in whole.splitlines() if not line.startswith("%"))
    assert commands(equations) - OF_PAPERS <= COMMANDS
    assert environments(equations) <= {"equation", "align", "align*"}


@pytest.mark.slow
def test_a_formula_that_a_page_would_take_seconds_to_set_is_left_out(printed):
    lengths = [len(latex) for tf, form in printed if (latex := notebook_latex(tf, form))]
    assert max(lengths) <= LONGEST_IN_NOTEBOOK
    assert any(notebook_latex(tf, form) is None for tf, form in printed)


def test_labels_and_functions_are_known_to_both():
    assert set(ALLOWED_COMMANDS) <= COMMANDS
    assert commands("".join(function.latex for function in FUNCTIONS.values())) <= COMMANDS


@pytest.mark.parametrize(
    "name", ["W" * 64, "a__b", "a_" + "very_" * 11 + "long", "x1y2", "a" + "_" * 63, "EI"]
)
def test_labels_of_the_oddest_names_are_known_to_both(name):
    assert commands(label_of(name)) <= COMMANDS
