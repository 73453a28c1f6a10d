"""Laying out formulas and roots for a terminal."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.errors import Source, Span, Text
from symflex.expressions import PROGRAM_LIMITS, format_expression, parse
from symflex.print.roots import roots_text
from symflex.print.text import wrapped
from symflex.roots import Modes

CHAIN = " + ".join(
    f"(b_{i}*s + k_{i})*(m_{i}*s^2 + c_{i}*(d_{i} + e_{i}*(f_{i}*s + g_{i})))" for i in range(9)
)
OSCILLATOR = """
symflex = 1
parameters = { m = "2 kg", k = "19 N/m", b = "1 N*s/m" }
inputs  = { F = { force = "x" } }
outputs = { X = "x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
"""


def expression(text):
    return parse(Text(text, Span(Source("", text), 0, len(text))), limits=PROGRAM_LIMITS)


WRAPPED = {
    "what fits stays on one line": ("m*s^2 + b*s + k", 15, ["m*s^2 + b*s + k"]),
    "simple terms fill the lines": ("a + b + c + d + e + f", 12, ["a + b + c", "  + d + e", "  + f"]),
    "terms with parentheses stand one to a line": (
        "(a + b)*(c + d) + (e + f)*(g + h) - (i + j)*k",
        40,
        ["(a + b)*(c + d)", "  + (e + f)*(g + h)", "  - (i + j)*k"],
    ),
    "products break after a times": (
        "(a_1 + b_1)*(a_2 + b_2)*(a_3 + b_3)",
        26,
        ["(a_1 + b_1)*(a_2 + b_2)*", "    (a_3 + b_3)"],
    ),
    "a long sum stands to the right of a short factor": (
        "s^2*((a + b)*(c + d) + (e + f)*(g + h))",
        30,
        ["s^2*((a + b)*(c + d)", "     + (e + f)*(g + h))"],
    ),
    "a long sum stands below a long factor": (
        "(alpha + beta)*((a + b)*(c + d) + (e + f)*(g + h))",
        30,
        ["(alpha + beta)*(", "    (a + b)*(c + d)", "    + (e + f)*(g + h))"],
    ),
    "a name too long for the line is not broken": ("x" * 60, 40, ["x" * 60]),
}


def test_formulas_are_broken_as_a_person_would():
    for fact, (text, width, expected) in WRAPPED.items():
        assert wrapped(expression(text), width) == expected, fact


def test_a_nested_sum_keeps_to_the_width():
    for width in (40, 60, 80, 120):
        assert max(map(len, wrapped(expression(CHAIN), width))) <= width


@settings(max_examples=60)
@given(
    width=st.integers(12, 90),
    parts=st.lists(
        st.sampled_from(["a", "b*(c + d)", "(e - f)^2*g", "-h", "k/(m + n)", CHAIN]), min_size=1, max_size=6
    ),
    nested=st.booleans(),
)
def test_breaking_changes_nothing_but_white_space(width, parts, nested):
    tree = expression(" + ".join(f"({part})*p" if nested else f"({part})" for part in parts))
    joined = "".join("".join(wrapped(tree, width)).split())
    assert joined == "".join(format_expression(tree).split())


@pytest.fixture(scope="module")
def bound():
    return pipeline.bind(pipeline.derive_all(pipeline.loads(OSCILLATOR))[0])


def test_root_tables_keep_to_80_columns(bound):
    for digits in (3, 15, 25, 30):
        rows = roots_text(pipeline.roots(bound, None, digits), digits).splitlines()
        assert max(map(len, rows)) <= 80, digits


def test_all_digits_of_a_pair_are_shown_in_every_layout(bound):
    for digits in (6, 30, 70):
        found = pipeline.roots(bound, None, digits)
        upper = found.poles[0].decimal(digits)
        text = roots_text(found, digits)
        assert upper.re in text, digits
        assert f"+-{upper.im}" in text, digits


def test_the_number_of_roots_counts_multiplicity_and_both_members_of_a_pair(bound):
    assert "  poles: 2\n" in roots_text(pipeline.roots(bound, None, 5), 5)


def test_what_was_asked_for_is_said(bound):
    text = roots_text(pipeline.roots(bound, Modes(1), 5), 5)
    assert "shown: the mode of lowest natural frequency, and roots at 0" in text
