"""What is printed is read back as the same tree, over everything the program prints."""

from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.expressions import Name, format_expression, negative, number, power, product_of, quotient, sum_of
from symflex.print.forms import hidden_expressions, print_form
from symflex.print.forms.printed import forms_of
from symflex.print.json_format import derive_json
from tests.contract.exact import read

FOLDER = Path(__file__).parents[2] / "derivations"
KINDS = (
    "eppinger1988/lumped_bending_beam",
    "eppinger1988/base_flexure",
    "eppinger1988/sliding_free_beam",
    "classics/kelvin_voigt_cantilever",
    "tapers/hanging_string",
)
"""Rational, with hidden factors, and with kernels, damping and Bessel functions."""

LEAVES = st.one_of(
    st.sampled_from(["s", "m_1", "k", "pi", "e", "E", "e5"]).map(Name),
    st.integers(-12, 12).map(number),
    st.fractions(-9, 9, max_denominator=50).filter(lambda q: (10**6 * q).denominator == 1).map(number),
)


@st.composite
def built(draw, depth=4):
    """Draw a tree made by the constructors the program prints with."""
    kind = draw(st.integers(0, 5)) if depth else 0
    if kind == 0:
        return draw(LEAVES)
    if kind in (1, 2):
        parts = [draw(built(depth - 1)) for _ in range(draw(st.integers(1, 4)))]
        return sum_of(parts) if kind == 1 else product_of(parts)
    inner = draw(built(depth - 1))
    if kind == 3:
        below = draw(built(depth - 1))
        return inner if below == number(0) else quotient(inner, below)
    exponent = draw(st.integers(-3, 4))
    return negative(inner) if kind == 4 or inner == number(0) else power(inner, exponent)


@given(expression=built())
@settings(max_examples=60)
@pytest.mark.slow
def test_any_built_tree_is_read_back_as_itself(expression):
    assert read(format_expression(expression)) == expression


@cache
def functions():
    return [tf for stem in KINDS for tf in pipeline.derive_all(pipeline.load(FOLDER / f"{stem}.toml"))[:2]]


@pytest.mark.slow
def test_everything_a_derivation_prints_is_read_back_as_itself():
    for tf in functions():
        forms = [print_form(tf, name) for name in forms_of(tf)]
        parts = [e for f in forms for e in (f.num, f.den, *(w for _, w in f.where))]
        for part in dict.fromkeys([*parts, *(e for e, _ in hidden_expressions(tf))]):
            assert read(format_expression(part)) == part, tf.name


def test_the_strings_of_the_json_are_in_the_expression_grammar():
    for tf in functions():
        entry = derive_json(tf, print_form(tf))
        for text in (entry["num"], entry["den"], *(e for _, e in entry["where"])):
            assert format_expression(read(text)) == text, tf.name
