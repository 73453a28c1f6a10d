"""HTML for notebooks: what it shows, and that no text of a model is more than text in it."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from flint import arb

from symflex import pipeline
from symflex.model import ModelParameter
from symflex.print.html import LONGEST, NUMBER, bound_html, escape_html, html_table, model_html, roots_html
from symflex.roots import Certificate, Everything, HiddenRoot, PoleZeroMap, Root
from tests.unit.codegen.hostile_names import HOSTILE

SPEC = """symflex = 1
title = "An oscillator"
source = "a book"
[parameters]
m = { value = "2 kg", doc = "of the body" }
k = { value = "18 N/m", latex = 'k_{\\mathrm{t}}' }
g = { unit = "m/s^2" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
MARKUP = [
    "<script>alert(1)</script>", "<img src=x onerror=alert(1)>", '" onmouseover="alert(1)',
    "</td></table><h1>", "<!--", "]]>", "&lt;b&gt; &#36;x&#36;", "$\\href{javascript:alert(1)}{x}$", "$$x$$",
    "\\(x\\) \\[y\\]", "\\begin{equation}x\\end{equation}", "$\\def\\frac#1{}$",
]  # fmt: skip


class Reader(HTMLParser):
    """Collects tags with their attributes, and the text of every node."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.texts = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        if tag != "span":
            self.tags.append((tag, *attrs))

    def handle_endtag(self, tag):
        if tag != "span":
            self.tags.append((tag,))

    def handle_data(self, data):
        self.texts.append(data)

    def handle_comment(self, data):
        self.tags.append(("comment", data))


@pytest.fixture(scope="module")
def model():
    return pipeline.loads(SPEC)


@pytest.fixture(scope="module")
def bound(model):
    return pipeline.bind(pipeline.derive_all(model)[0])


def test_a_model_shows_title_source_parameters_and_functions(model):
    text = model_html(model)
    assert "<strong>An oscillator</strong>" in text
    assert "a book" in text
    assert all(f">{cell}<" in text for cell in ("$k_{\\mathrm{t}}$", "<code>k</code>", "18", "N/m"))
    assert "symbolic" in text
    assert "<code>X/F</code>" in text


def test_a_bound_function_shows_its_formula_and_values(bound):
    text = bound_html(bound)
    assert r"\frac{X(s)}{F(s)} = \frac{1}{m s^{2} + k_{\mathrm{t}}}" in text
    assert "<code>m</code>" in text
    assert ">18<" in text


def test_poles_and_zeros_are_rows_with_radius_and_certificate(bound):
    # s = +-3 j: 3/(2 pi) Hz
    text = roots_html(pipeline.roots(bound))
    assert "certified: 2 of 2 roots enclosed" in text
    (row,) = re.findall(r"<tr><td[^>]*>pole.*</tr>", text)
    assert re.sub(r"<[^>]*>", " ", row).split() == [
        "pole",
        "0",
        "&pm;3.000000000",
        "0",
        "0.4774648293",
        "0",
        "1",
    ]


def test_what_is_not_proved_says_so():
    pole = Root(arb(-1, 0.1), arb(0), 2, on_imaginary_axis=False, is_real=True, certified=False)
    found = PoleZeroMap(
        "X/F", Everything(), (pole,), (), (HiddenRoot(pole),), Certificate("x", 3, 2, "<one> is lost")
    )
    text = roots_html(found)
    assert "NOT CERTIFIED: &lt;one&gt; is lost" in text
    assert "pole ?" in text
    assert "hidden ?" in text


def test_a_long_table_says_how_many_rows_it_leaves_out():
    text = html_table(("n",), (NUMBER,), [(str(i),) for i in range(LONGEST + 7)])
    assert text.count("<tr>") == LONGEST + 2
    assert "and 7 more" in text


def test_no_text_of_a_model_is_markup_or_mathematics(model):
    def with_texts(text):
        parameters = (*model.parameters, ModelParameter("q", None, text))
        parameters = tuple(replace(p, doc=text, unit=text) for p in parameters)
        return replace(model, title=f"t{text}", source=f"s{text}", parameters=parameters)

    expected = Reader(model_html(with_texts("d"))).tags
    symbols = {"$m$", "$k_{\\mathrm{t}}$", "$g$", "$q$"}
    for text in (*HOSTILE, *MARKUP):
        read = Reader(model_html(with_texts(text)))
        assert read.tags == expected, text
        # A dollar sign or backslash stands alone in its node, or in the mathematics of a symbol.
        alone = {*symbols, "$", "\\"}
        assert [t for t in read.texts if t not in alone and set(t) & {"$", "\\"}] == [], text


def test_escaped_text_reads_as_what_prints_of_it():
    for text in (*HOSTILE, *MARKUP):
        printed = "".join(c for c in " ".join(text.split()) if c.isprintable())
        assert "".join(Reader(escape_html(text)).texts) == printed, text
