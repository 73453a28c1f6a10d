"""What is printed is read back as the same tree, over everything the program prints."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.expressions import (
    Name,
    format_expression,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.print.forms import hidden_expressions, print_form
from symflex.print.forms.printed import forms_of
from symflex.print.json_format import derive_json
from tests.contract.exact import read
from tests.house.repository import EACH_TIME, slow_ones, specifications

LONGEST = 20_000
LARGE = {"six_mass", "fitted_resonances", "polynomial_resonance"}
"""Their prints take seconds to read back."""
FOLDER = Path(__file__).parents[2] / "derivations"
PATHS = slow_ones(
    specifications(FOLDER, "**/*.toml"),
    lambda path: path.stem in LARGE or (path.parent.name != "eppinger1988" and path.stem not in EACH_TIME),
)
QUIET = settings(max_examples=200)

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


@pytest.mark.slow
@given(expression=built())
@QUIET
def test_any_built_tree_is_read_back_as_itself(expression):
    assert read(format_expression(expression)) == expression


@pytest.mark.parametrize("path", PATHS, ids=lambda p: p.stem)
def test_everything_a_derivation_prints_is_read_back_as_itself(path):
    for tf in pipeline.derive_all(pipeline.load(path)):
        forms = [print_form(tf, name) for name in forms_of(tf)]
        parts = [e for f in forms for e in (f.num, f.den, *(w for _, w in f.where))]
        for part in dict.fromkeys([*parts, *(e for e, _ in hidden_expressions(tf))]):
            text = format_expression(part)
            if len(text) <= LONGEST:
                assert read(text) == part


@pytest.mark.parametrize("path", PATHS, ids=lambda p: p.stem)
def test_the_strings_of_the_json_are_in_the_expression_grammar(path):
    for tf in pipeline.derive_all(pipeline.load(path)):
        entry = derive_json(tf, print_form(tf))
        for text in (entry["num"], entry["den"], *(e for _, e in entry["where"])):
            assert format_expression(read(text)) == text
