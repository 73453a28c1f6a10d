"""What is printed is read back as the same tree, over everything the program prints."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.emit.forms import FORMS, hidden_expressions, print_form
from symflex.emit.json_format import derive_json
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
from tests.contract.exact import read

FOLDER = Path(__file__).parents[2] / "derivations"
QUIET = settings(max_examples=400, deadline=None, database=None, derandomize=True)

LEAVES = st.one_of(
    st.sampled_from(["s", "m_1", "k", "pi", "e", "E", "e5"]).map(Name),
    st.integers(-12, 12).map(number),
    st.fractions(-9, 9, max_denominator=50).filter(lambda q: (10**6 * q).denominator == 1).map(number),
)


def grown(inner):
    several = st.lists(inner, min_size=1, max_size=4)
    pair = st.tuples(inner, inner).filter(lambda p: p[1] != number(0))
    raised = st.tuples(inner, st.integers(-3, 4)).filter(lambda p: p[0] != number(0))
    return st.one_of(
        several.map(sum_of),
        several.map(product_of),
        pair.map(lambda p: quotient(*p)),
        raised.map(lambda p: power(*p)),
        inner.map(negative),
    )


@given(expression=st.recursive(LEAVES, grown, max_leaves=25))
@QUIET
def test_any_built_tree_is_read_back_as_itself(expression):
    assert read(format_expression(expression)) == expression


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.toml")), ids=lambda p: p.stem)
def test_everything_a_derivation_prints_is_read_back_as_itself(path):
    for tf in pipeline.derive_all(pipeline.load(path)):
        forms = [print_form(tf, name) for name in FORMS]
        hidden = [e for e, _ in hidden_expressions(tf)]
        for part in (e for f in forms for e in (f.num, f.den, *(w for _, w in f.where), *hidden)):
            assert read(format_expression(part)) == part


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.toml")), ids=lambda p: p.stem)
def test_the_strings_of_the_json_are_in_the_expression_grammar(path):
    for tf in pipeline.derive_all(pipeline.load(path)):
        entry = derive_json(tf, print_form(tf))
        for text in (entry["num"], entry["den"], *(e for _, e in entry["where"])):
            assert format_expression(read(text)) == text
