"""Figures in PGF: their size, their texts, and that no text of a model brings a command."""

import re
from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.errors import UsageError
from symflex.figures import FIGURES, AxisLimits, draw, render
from symflex.figures.pgf import pgf_text
from symflex.print.latex import DOCUMENT
from tests.unit.codegen.hostile_names import HOSTILE
from tests.unit.print.test_html import MARKUP
from tests.unit.print.test_latex_document import MORE
from tests.unit.print.test_latex_text import COMMANDS as OF_TEXT

SPEC = """symflex = 1
title = "Two masses"
inputs.F = { force = "x" }
outputs = { X = "x", Y = "y" }
analysis.band = ["0.2 Hz", "5 Hz"]
[elements]
a = { type = "mass", at = "x", m = "1 kg" }
b = { type = "mass", at = "y", m = "1 kg" }
k = { type = "spring", between = ["x", "y"], k = "50 N/m" }
d = { type = "damper", between = ["x", "y"], b = "0.1 N*s/m" }
"""
NUMBER = r"-?[0-9.]+"
POINT = rf"pgfqpoint\{{{NUMBER}in\}}\{{{NUMBER}in\}}"
OF_DRAWING = re.compile(
    rf"\\(?:(?:begin|end)\{{pgfscope\}}|pgfpath(?:moveto|lineto|close|curveto|quadraticcurveto|rectangle)|{POINT}"
    r"|pgfusepath\{(?:stroke|fill|stroke,fill|clip|)\}"
    rf"|pgfset(?:linewidth\{{{NUMBER}pt\}}|(?:butt|round|rect)cap|(?:miter|round|bevel)join)"
    rf"|pgfsetdash\{{(?:\{{{NUMBER}pt\}})*\}}\{{{NUMBER}pt\}}"
    rf"|definecolor\{{current(?:fill|stroke)\}}\{{rgb\}}\{{{NUMBER},{NUMBER},{NUMBER}\}}"
    rf"|pgfset(?:fill|stroke)(?:color\{{current(?:fill|stroke)\}}|opacity\{{{NUMBER}\}})"
    rf"|pgftext\[x={NUMBER}pt,y={NUMBER}pt,base(?:,left|,right)?(?:,rotate=90)?\]\{{\\fontsize\{{\d\}}\{{[0-9.]+\}}"
    rf"\\selectfont(?:\\color\[rgb\]\{{{NUMBER},{NUMBER},{NUMBER}\}})?\{{\}})"
)
OF_MATHEMATICS = {
    r"\mathrm",
    r"\sigma",
    r"\lambda",
    r"\zeta",
    r"\times",
    r"\circ",
    r"\pm",
    r"\cdot",
    r"\,",
    r"\!",
}


@pytest.fixture(scope="module")
def bounds():
    model = pipeline.loads(SPEC)
    return pipeline.derive_bound(model, model.transfer_functions)


@pytest.fixture(scope="module")
def drawn(bounds):
    """A picture of a kind, drawn once; of one function where a matrix has to be square."""

    def made(kind):
        return text_of(kind, bounds[:1] if kind == "rga" else bounds, width_mm=88.5, title="Two masses")

    return cache(made)


def text_of(kind, bounds, **asked):
    figure = draw(kind, bounds, frame=AxisLimits(at=(Fraction(1),)), font="latex", **asked)
    return render(figure, "pgf", font="latex").decode("ascii")


def commands_beside_drawing(text):
    """The commands of a picture's texts that neither escape a character nor belong to labels of figures."""
    lines = text.splitlines()
    assert lines[2] == r"\begin{pgfpicture}"
    assert lines[4] == r"\pgfusepath{use as bounding box}"
    assert lines[-1] == r"\end{pgfpicture}\relax"
    rest = OF_TEXT.sub("", OF_DRAWING.sub("", "\n".join(lines[5:-1])))
    return set(re.findall(r"\\(?:[A-Za-z]+|.)", rest)) - OF_MATHEMATICS


@pytest.mark.parametrize("kind", FIGURES)
def test_a_picture_is_as_wide_as_asked_for_and_holds_nothing_but_a_drawing(kind, drawn):
    text = drawn(kind)
    assert re.search(r"\\pgfpathrectangle\{\\pgfpointorigin\}\{\\pgfqpoint\{88\.5mm\}\{[0-9.]+mm\}\}", text)
    assert commands_beside_drawing(text) == set()
    assert "Two" in text or kind == "modes"
    # What is drawn stays near the picture: 88.5 mm are 251.8 pt.
    places = [72.27 * float(x) for x in re.findall(r"\\pgfqpoint\{(-?[0-9.]+)in\}", text)]
    assert -30 < min(places)
    assert max(places) < 280


def test_no_text_becomes_a_command_or_mathematics_that_a_label_may_not_hold():
    for text in (*HOSTILE, *MARKUP, *MORE):
        for written in (
            pgf_text(text),
            pgf_text(text, is_math=False),
            pgf_text(f"$X_{{{text}}}$ [${text}$]"),
        ):
            rest = OF_TEXT.sub("", written)
            assert set(re.findall(r"\\(?:[A-Za-z]+|.)", rest)) <= OF_MATHEMATICS, text
            assert rest.count("{") == rest.count("}"), text
            assert rest.count("$") % 2 == 0, text
            assert "%" not in rest, text
            assert "^^" not in rest, text


def labelled(bound, latex):
    return replace(bound, source=replace(bound.source, output=replace(bound.source.output, latex=latex)))


@pytest.mark.slow
def test_a_hostile_model_is_drawn_as_any_other(bounds):
    # Labels are text once they are refused, so that three texts go into one figure.
    for title, *labels in zip(MORE[::3], MORE[1::3], MORE[2::3], strict=True):
        odd = [labelled(bound, latex) for bound, latex in zip(bounds, labels, strict=True)]
        assert commands_beside_drawing(text_of("poles_zeros", odd, title=title)) == set(), (title, labels)


def test_a_label_that_would_break_a_formula_gives_way_in_figures_too(bounds):
    # matplotlib sets both, TeX neither.
    odd = [labelled(bound, latex) for bound, latex in zip(bounds, (r"x^2'", r"\hat"), strict=True)]
    text = text_of("poles_zeros", odd)
    assert "$X/F$" in text
    assert "$Y/F$" in text


def test_a_picture_is_written_where_no_tex_is_installed(bounds, monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert r"\pgfqpoint{88.9mm}" in text_of("poles_zeros", bounds, width_mm=88.9)


def test_colours_and_sizes_of_texts_are_kept(drawn):
    text = drawn("bode")
    assert r"\fontsize{8}{9.6}\selectfont{}Frequency [Hz]" in text
    assert r"\definecolor{currentstroke}{rgb}{0.000000,0.447059,0.698039}" in text  # #0072B2
    assert "rotate=90" in text


def test_equal_figures_give_equal_text(bounds, drawn):
    assert text_of("modes", bounds, width_mm=88.5, title="Two masses") == drawn("modes")


@pytest.mark.slow
def test_a_figure_in_the_font_of_latex_embeds_computer_modern(bounds):
    for font, name in (("latex", b"Cmr10"), ("times", b"STIX"), ("sans", b"DejaVuSans")):
        data = render(draw("poles_zeros", bounds, font=font, width_mm=100), "pdf", font=font)
        assert name in data
        # 100 mm in points of 1/72 inch
        width = float(re.search(rb"/MediaBox \[ 0 0 ([0-9.]+) ", data)[1])
        assert width == pytest.approx(100 / 25.4 * 72, abs=1e-6)


def test_a_font_or_width_that_does_not_exist_is_refused(bounds):
    for asked in ({"font": "comic"}, {"width_mm": 20.0}, {"width_mm": 1e9}):
        with pytest.raises(UsageError):
            draw("bode", bounds, **asked)


@pytest.mark.slow
def test_the_figures_of_a_model_and_one_of_each_other_kind_are_among_the_files():
    figures = '[figures.fig_7]\nkind = "bode"\nof = ["Y/F"]\ntitle = "100 % \\\\input{x}"\n'
    model = pipeline.loads(SPEC + figures)
    tfs = pipeline.derive_all(model)
    files, warnings = LatexExporter(88.5).export_files(model, tfs)
    assert warnings == ()
    assert {name for name in files if name.endswith(".pgf")} == {"fig_7.pgf", "poles_zeros.pgf", "modes.pgf"}
    assert r"\usepackage{pgf}" in files[DOCUMENT]
    assert r"100 \% \textbackslash{}input\{x\}." in files[DOCUMENT]
    assert "$X(s)/F(s)$, $Y(s)/F(s)$" in files[DOCUMENT]
    # Of what is exported only: nothing of the figure's remains.
    files, _ = LatexExporter(88.5).export_files(model, tfs[:1])
    assert "fig_7.pgf" not in files
    without, _ = LatexExporter(88.5, has_figures=False).export_files(model, tfs)
    assert not any(name.endswith(".pgf") for name in without)
    assert "pgf" not in without[DOCUMENT]
