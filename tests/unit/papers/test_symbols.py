"""Printed symbols and what they are called; what each is was said by hand."""

import pytest

from symflex.errors import SpecError, Text
from symflex.expressions import format_expression
from symflex.papers.formula import read_latex
from symflex.papers.symbols import PrintedSymbol, notation_of, symbol_of_latex
from tests.unit.papers.reading import read


def test_symbols_of_labels_are_those_of_print() -> None:
    assert symbol_of_latex(Text.alone("label", r"\omega_{\mathrm{n}}")) == PrintedSymbol("omega", "", "n")
    assert symbol_of_latex(Text.alone("label", r"\hat{x}_1'")) == PrintedSymbol("x", "hat_p", "1")
    assert symbol_of_latex(Text.alone("label", r"a+b")) is None


def test_letters_that_the_known_names_cut_in_two_ways_are_refused() -> None:
    with pytest.raises(SpecError, match="two ways"):
        read("EI", "EI E I")
    assert format_expression(read("EI", "E I")) == "E*I"


def test_words_in_a_formula_are_names_and_never_lost() -> None:
    assert format_expression(read(r"G = \text{proportional gain}\cdot s")) == "proportionalgain*s"
    assert format_expression(read(r"G = K\mathrm{a} s")) == "K*a*s"
    assert format_expression(read(r"G = V\text{in}")) == "V*in"
    assert format_expression(read(r"G = a \text{ (rad/s)}")) == "a"
    assert format_expression(read(r"G = a\;{\rm where}\; a = b")) == "a"


def test_a_superscript_of_letters_may_be_tied():
    notation = notation_of([("theta_d", "")], (), [(r"\theta_L^d", "theta_d")])
    (formula,), _ = read_latex(Text.alone("f", r"\frac{\theta_L^d}{2}"), notation)
    assert format_expression(formula) == "theta_d/2"
