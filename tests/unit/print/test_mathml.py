"""MathML says what the expression says: it is read back by a reader of its own, and evaluated."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex import pipeline
from symflex.errors import Text
from symflex.expressions import (
    Call,
    Name,
    Negative,
    Quotient,
    Sum,
    format_expression,
    number,
    parse,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.papers.labels import ACCENTS, FONTS, GREEK, LABEL_LIMIT, SYMBOLS
from symflex.print.forms import print_form
from symflex.print.latex import model_labels
from symflex.print.mathml import (
    MathmlWriter,
    label_mathml,
    math_element,
    mathml_expression,
    transfer_function_mathml,
)
from tests.independent.spec_expressions import evaluate

ROOT = Path(__file__).parents[3]
CORE = frozenset(
    "math mrow mpadded mi mn mo mtext mspace mfrac msqrt msub msup msubsup mover munder".split()
)  # elements of MathML Core that the printer uses
VALUES = {"s": mpmath.mpf("1.3"), "a": mpmath.mpf("0.7"), "b": mpmath.mpf("2.1"), "c": mpmath.mpf("0.4")}
SIGNS = (
    {"\u2212": "-", "\u22c5": "*", "\u2062": "*", "+": "+", "/": "/"}
    | {c: "(" for c in "([{"}
    | {c: ")" for c in ")]}"}
)


def read(element):
    """Return an element of MathML as text of the specification's grammar."""
    children = list(element)
    match element.tag:
        case "math" | "mrow" | "mpadded":
            return read_row(children)
        case "mi" | "mn":
            return element.text
        case "mo":
            return SIGNS[element.text]
        case "mfrac":
            return f"(({read(children[0])})/({read(children[1])}))"
        case "msqrt":
            return f"sqrt({read_row(children)})"
        case "msup" if children[0].tag == "mi" and children[0].text == "e":
            return f"exp({read(children[1])})"
        case "msup" if children[0].tag == "mo":  # a closing parenthesis that bears the exponent
            return f")^({read(children[1])})"
        case "msup":
            return f"({read(children[0])})^({read(children[1])})"
    raise AssertionError(element.tag)


def read_row(children):
    """Return elements side by side; a function is applied to what follows the invisible operator."""
    texts = []
    i = 0
    while i < len(children):
        following = children[i + 1] if i + 1 < len(children) else None
        if following is not None and following.tag == "mo" and following.text == "\u2061":
            argument = read(children[i + 2])
            head = children[i]
            if head.tag == "msup":
                texts.append(f"({''.join(head[0].itertext())}({argument}))^({read(head[1])})")
            else:
                texts.append(f"{head.text}({argument})")
            i += 3
        else:
            texts.append(read(children[i]))
            i += 1
    return "".join(texts)


@pytest.fixture(autouse=True, scope="module")
def _many_digits():
    # Sines of large numbers need them.
    with mpmath.workdps(60):
        yield


def value_of(mathml):
    text = read(ET.fromstring(f"<mrow>{mathml}</mrow>"))
    return evaluate(re.sub(r"(?<![\w)])\+", "", text), VALUES)


def expressions():
    leaves = st.sampled_from([Name(n) for n in "sabc"]) | st.builds(number, st.integers(1, 20))

    def grow(inner):
        return st.one_of(
            st.builds(lambda x, y: sum_of([x, y]), inner, inner),
            st.builds(lambda x, y: Sum((x, Negative(y))), inner, inner),
            st.builds(lambda x, y: product_of([x, y]), inner, inner),
            st.builds(quotient, inner, inner),
            st.builds(power, inner, st.integers(2, 3)),
            st.builds(Call, st.sampled_from(["sqrt", "sin"]), inner),
            st.builds(lambda x: power(Call("sin", x), 2), inner),
            # Towers of exponentials have no value that fits into memory.
            st.builds(Call, st.sampled_from(["exp", "cosh"]), leaves),
            st.builds(lambda x: power(Call("cosh", x), 2), leaves),
            st.builds(Negative, inner),
        )

    return st.recursive(leaves, grow, max_leaves=10)


def close(a, b):
    if mpmath.isnan(a) or mpmath.isnan(b) or mpmath.isinf(b):
        return True
    return abs(a - b) <= mpmath.mpf("1e-9") * max(1, abs(b))


@settings(max_examples=80)
@given(expressions(), st.floats(1, 12))
def test_mathml_has_the_value_of_the_expression_whole_and_in_pieces(expression, width):
    pieces = MathmlWriter({}).pieces(expression, width)
    try:
        expected = evaluate(format_expression(expression), VALUES)
        found = [value_of(mathml_expression(expression, {})), value_of("".join(pieces))]
    except (ZeroDivisionError, OverflowError):
        return
    assert all(close(value, expected) for value in found)


def test_a_long_sum_is_parted_before_its_signs():
    letters = Sum(tuple(Name(c) for c in "abcdefghijklmnopqrst"))
    pieces = MathmlWriter({}).pieces(letters, 5.0)
    assert len(pieces) == 20
    assert all(piece.startswith('<mo form="infix">+</mo>') for piece in pieces[1:])


def test_every_formula_and_label_is_well_formed_and_of_mathml_core():
    for stem in ("rigid_body", "base_flexure", "sliding_free_beam"):
        model = pipeline.load(ROOT / "derivations" / "eppinger1988" / f"{stem}.toml")
        labels = model_labels(model)
        contents = [label_mathml(name, labels) for name in labels]
        for tf in pipeline.derive_all(model):
            for row in transfer_function_mathml(tf, print_form(tf)):
                contents += [row.left, *row.pieces]
        for content in contents:
            found = ET.fromstring(math_element(f"<mrow>{content}</mrow>"))
            assert {e.tag for e in found.iter()} <= CORE, content


def test_whatever_a_declared_label_may_hold_is_well_formed():
    several = ("x'_{a,b}", "k_1^{*}", r"\mathrm{e.m.f.}", r"\hat{\omega}_{p1}'", "A|B", "{x}_{y_z}")
    plain = [f"\\{c}" for c in (*GREEK, *SYMBOLS)]
    for latex in (*plain, *(f"\\{c}{{x}}" for c in (*ACCENTS, *FONTS)), *several):
        assert len(latex) <= LABEL_LIMIT
        found = ET.fromstring(f"<math>{label_mathml('n', {'n': latex})}</math>")
        assert {e.tag for e in found.iter()} <= CORE, latex


def test_names_that_have_no_label_are_text():
    assert label_mathml("a__b", {}) == '<mtext class="tt">a__b</mtext>'


def test_quotients_inside_exponents_have_slashes():
    shown = mathml_expression(Call("exp", Negative(Quotient(Name("s"), number(2)))), {})
    assert "<mfrac>" not in shown
    assert "<mo>/</mo>" in shown


def test_a_script_without_braces_is_one_digit_as_in_latex():
    assert label_mathml("a", {"a": "a_12"}) == "<mrow><msub><mi>a</mi><mn>1</mn></msub><mn>2</mn></mrow>"


def test_scripts_stand_where_tex_sets_them():
    found = {
        text: mathml_expression(parse(Text.alone("<f>", text)), {})
        for text in ("omega_z^2", "zeta_p*s", "l^2", "2*10^5", "tip", "EI^2", "r_trans^2*m_2")
    }
    assert found["omega_z^2"] == "<msubsup><mi>ω</mi><mi>z</mi><mn>2</mn></msubsup>"
    assert found["zeta_p*s"].startswith(
        '<mrow><msub><mpadded depth="0"><mi>ζ</mi></mpadded><mi>p</mi></msub>'
    )
    assert found["l^2"] == '<msup><mpadded height="0"><mi>l</mi></mpadded><mn>2</mn></msup>'
    assert "<mo>⋅</mo><msup><mn>10</mn>" in found["2*10^5"]  # not 210^5
    assert (found["tip"], ">EI</mi></mpadded><mspace" in found["EI^2"]) == ("<mi>tip</mi>", True)
    assert '</msubsup><mo lspace="0.17em"' in found["r_trans^2*m_2"]


def test_a_product_that_may_be_parted_has_its_sign_there():
    long = product_of([sum_of([Name(f"x_{i}"), Name(f"y_{i}")]) for i in range(3)])
    first, *others = MathmlWriter({}).pieces(long, 5.0)
    assert [">⋅</mo>" in piece for piece in (first, *others)] == [False, True, True]
