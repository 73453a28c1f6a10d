"""Figures in somebody's paper: no warning, as wide as asked for, in the paper's font; written without TeX."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.figures import draw, render
from symflex.print.latex import DOCUMENT
from tests.house.repository import specifications
from tests.integration.test_latex_compiles import HOSTILE, LABELS, compiled

ROOT = Path(__file__).parents[2]
DERIVATIONS = ROOT / "derivations"
ENGINES = [
    pytest.param("pdflatex", marks=pytest.mark.needs_tool("pdflatex")),
    pytest.param("lualatex", marks=[pytest.mark.needs_tool("lualatex"), pytest.mark.slow]),
]
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
CHOSEN = [
    path
    for i, path in enumerate(specifications(DERIVATIONS, "**/*.toml"))
    if path.parent.name == "eppinger1988" or i % 8 == 0
]
WAYS = ((PAGE_MM, "lualatex"), *[(WIDTH_MM, "pdflatex")] * 3)
SET = [(path, *WAYS[i % 4]) for i, path in enumerate(CHOSEN)]
"""The paper's models and every eighth of the others, most in a column and each fourth by another engine."""
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
        figure = draw(kind, [b.source for b in bounds], bounds, width_mm=WIDTH_MM, font="latex")
        found[kind] = render(figure, "pgf", font="latex").decode("ascii")
    for i, title in enumerate(HOSTILE.values()):
        ends = [replace(b.source.output, latex=LABELS[(i + j) % len(LABELS)]) for j, b in enumerate(bounds)]
        odd = [replace(b, source=replace(b.source, output=end)) for b, end in zip(bounds, ends, strict=True)]
        printed = title.replace("\ud800", "?")  # matplotlib measures no half of a letter
        figure = draw(
            "poles_zeros", [b.source for b in odd], odd, title=printed, width_mm=WIDTH_MM, font="latex"
        )
        found[f"hostile{i}"] = render(figure, "pgf", font="latex").decode("ascii")
    return found


@pytest.mark.needs_tool("pdffonts")
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.slow
def test_pictures_are_as_wide_as_asked_for_and_take_the_font_of_the_paper(engine, pictures, tmp_path):
    body = []
    for name, text in pictures.items():
        (tmp_path / f"{name}.pgf").write_text(text, encoding="ascii")
        body.append(
            rf"\setbox0\hbox{{\input{{{name}.pgf}}}}\typeout{{WIDTH \the\wd0}}\noindent\box0\par\medskip"
        )
    (tmp_path / "paper.tex").write_text(PAPER % "\n".join(body), encoding="ascii")
    assert compiled(engine, tmp_path) == []
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
@pytest.mark.parametrize(("path", "width", "engine"), SET, ids=[f"{p.stem}-{e}" for p, _, e in SET])
def test_the_files_of_a_model_compile_without_a_warning(path, width, engine, tmp_path):
    model = pipeline.load(path)
    derived, _ = pipeline.derive_as(model, model.transfer_functions, is_read=True)
    files, warnings = LatexExporter(width).export_files(model, derived)
    without_modes = [w for w in warnings if "mode shapes are not available yet where coefficients vary" in w]
    assert list(warnings) == without_modes
    pictures = sum(name.endswith(".pgf") for name in files)
    assert pictures >= len(PICTURES) - 1 - len(without_modes)
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    assert compiled(engine, tmp_path, DOCUMENT.removesuffix(".tex")) == []


@pytest.mark.slow
def test_a_picture_is_written_where_no_tex_is_installed(tmp_path):
    spec = DERIVATIONS / "eppinger1988" / "rigid_body.toml"
    command = [sys.executable, "-m", "symflex", "plot", spec, "fig5", "-o", tmp_path / "a.pgf"]
    environment = {**os.environ, "PATH": "", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")
    assert r"\pgfqpoint{88.9mm}" in (tmp_path / "a.pgf").read_text(encoding="ascii")  # 3.5 inches
