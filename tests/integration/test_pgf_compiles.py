"""Figures in somebody's paper: no warning, as wide as asked for, in the paper's font."""

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.figures import draw, render
from symflex.print.latex import DOCUMENT
from tests.integration.test_latex_compiles import HOSTILE, LABELS, compiled

DERIVATIONS = Path(__file__).parents[2] / "derivations"
WIDTH_MM = 88.5
PAGE_MM = 170.0
POINTS_PER_MM = 72.27 / 25.4
PAPER = r"""\documentclass[10pt,twocolumn]{article}
\usepackage[T1]{fontenc}
\usepackage{lmodern,amsmath,pgf}
\usepackage[a4paper,textwidth=182mm,columnsep=5mm,textheight=240mm,left=14mm]{geometry}
\raggedbottom\pagestyle{empty}
\begin{document}
%s
\end{document}
"""
MODELS = (
    ("eppinger1988/rigid_body", WIDTH_MM, "pdflatex"),
    ("eppinger1988/sliding_free_beam", PAGE_MM, "lualatex"),
    ("tapers/conical_horn", WIDTH_MM, "pdflatex"),
)
"""With figures of its own, of an elastic member, and without mode shapes."""
PICTURES = (
    ("eppinger1988/rigid_body", "bode"),
    ("eppinger1988/six_mass", "modes"),
    ("eppinger1988/sliding_free_beam", "poles_zeros"),
)


@pytest.fixture(scope="module")
def pictures():
    """Pictures by name: of each kind, and of texts and labels that are not what they should be."""
    found = {}
    for stem, kind in PICTURES:
        model = pipeline.load(DERIVATIONS / f"{stem}.toml")
        bounds = pipeline.derive_bound(model, model.transfer_functions)
        figure = draw(kind, bounds, width_mm=WIDTH_MM, font="latex")
        found[kind] = render(figure, "pgf", font="latex").decode("ascii")
    for i, title in enumerate(HOSTILE.values()):
        ends = [replace(b.source.output, latex=LABELS[(i + j) % len(LABELS)]) for j, b in enumerate(bounds)]
        odd = [replace(b, source=replace(b.source, output=end)) for b, end in zip(bounds, ends, strict=True)]
        printed = title.replace("\ud800", "?")  # matplotlib measures no half of a letter
        figure = draw("poles_zeros", odd, title=printed, width_mm=WIDTH_MM, font="latex")
        found[f"hostile{i}"] = render(figure, "pgf", font="latex").decode("ascii")
    return found


@pytest.mark.slow
@pytest.mark.needs_tool("pdffonts", "pdflatex")
def test_pictures_are_as_wide_as_asked_for_and_take_the_font_of_the_paper(pictures, tmp_path):
    body = []
    for name, text in pictures.items():
        (tmp_path / f"{name}.pgf").write_text(text, encoding="ascii")
        body.append(
            rf"\setbox0\hbox{{\input{{{name}.pgf}}}}\typeout{{WIDTH \the\wd0}}\noindent\box0\par\medskip"
        )
    (tmp_path / "paper.tex").write_text(PAPER % "\n".join(body), encoding="ascii")
    assert compiled("pdflatex", tmp_path) == []
    log = (tmp_path / "paper.log").read_text(encoding="latin-1")
    widths = [float(w) for w in re.findall(r"WIDTH ([0-9.]+)pt", log)]
    assert len(widths) == len(pictures)
    assert widths == pytest.approx([WIDTH_MM * POINTS_PER_MM] * len(pictures), abs=1e-3)
    shown = subprocess.run(
        ["pdffonts", "paper.pdf"], cwd=tmp_path, capture_output=True, check=True, text=True
    )
    fonts = [line.split()[0].partition("+")[2] for line in shown.stdout.splitlines()[2:]]
    assert any("LMRoman" in font for font in fonts)
    # tcrm holds signs that Latin Modern's own encoding lacks.
    assert all(re.match(r"LM|Latin|latin|CM|SFRM|TCRM", font) for font in fonts), fonts


@pytest.mark.slow
@pytest.mark.needs_tool("pdflatex", "lualatex")
@pytest.mark.parametrize(("stem", "width", "engine"), MODELS)
def test_the_files_of_a_model_compile_without_a_warning(stem, width, engine, tmp_path):
    model = pipeline.load(DERIVATIONS / f"{stem}.toml")
    derived, _ = pipeline.derive_as(model, model.transfer_functions, is_read=True)
    files, warnings = LatexExporter(width).export_files(model, derived)
    without_modes = [w for w in warnings if "mode shapes are not available yet where coefficients vary" in w]
    assert list(warnings) == without_modes
    pictures = sum(name.endswith(".pgf") for name in files)
    assert pictures >= len(PICTURES) - 1 - len(without_modes)
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    assert compiled(engine, tmp_path, DOCUMENT.removesuffix(".tex")) == []
