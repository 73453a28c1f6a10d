"""Fragments in somebody's paper, and documents of all widths: no warning, nothing beyond its column.

One paper holds a bit of everything, so that each engine is run on one document only. Where glyphs end up is
measured in the compiled pages.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.print.latex import DOCUMENT
from tests.integration.test_latex_compiles import HOSTILE, LABELS, UNITS, compiled
from tests.unit.codegen.test_numpy_hostile import HOSTILE as TEXTS

DERIVATIONS = Path(__file__).parents[2] / "derivations"
POINTS_PER_MM = 72 / 25.4
OVERHANG = 0.15
"""How far a slanted letter reaches over its box [mm]."""
PROTRUSION = 0.8
"""How far microtype puts full stops and parentheses into the margin, on purpose [mm]."""


def engines(quick):
    """Both engines, of which one is run each time and the other when asked for."""
    return [
        pytest.param(name, marks=[pytest.mark.needs_tool(name)] + [pytest.mark.slow] * (name != quick))
        for name in ("pdflatex", "lualatex")
    ]


# Two columns as in a journal, with packages that authors load.
PAPER = r"""\documentclass[10pt,twocolumn]{article}
\usepackage[T1]{fontenc}
\usepackage{lmodern,amsmath,amssymb,array,booktabs,siunitx,graphicx}
\usepackage[a4paper,textwidth=182mm,columnsep=5mm,textheight=240mm,left=14mm]{geometry}
\usepackage{hyperref,cleveref}
\raggedbottom\pagestyle{empty}
\begin{document}
%s
\end{document}
"""


def beyond(folder, columns, tolerance, name="paper"):
    """Return the words that are set outside the columns [mm], with where they are [mm]."""
    shown = subprocess.run(
        ["pdftotext", "-bbox", f"{name}.pdf", "-"], cwd=folder, capture_output=True, check=True, text=True
    ).stdout
    words = re.findall(r'<word xMin="([-0-9.]+)" yMin="[^"]*" xMax="([-0-9.]+)"[^>]*>([^<]*)<', shown)
    assert len(words) > 100
    boxes = [(float(left) / POINTS_PER_MM, float(right) / POINTS_PER_MM, word) for left, right, word in words]
    return [
        box
        for box in boxes
        if not any(left - tolerance <= box[0] and box[1] <= right + tolerance for left, right in columns)
    ]


def many_parameters(model):
    """Return a model with hostile texts, odd labels and units, and a table that no column holds."""
    first = model.parameters[0]
    more = [
        replace(
            first,
            name=f"q_{i}",
            latex=LABELS[i] if i < len(LABELS) else "",
            unit=UNITS[i % len(UNITS)],
            doc=(*HOSTILE.values(), *TEXTS)[i % (len(HOSTILE) + len(TEXTS))],
        )
        for i in range(90)
    ]
    return replace(model, parameters=(*model.parameters, *more))


@pytest.fixture(scope="module")
def fragments():
    """Texts by name: equations of several forms and tables of several models, in a column of a journal."""
    found = {}
    for stem, form, few in (
        ("eppinger1988/rigid_body", None, 9),
        ("eppinger1988/six_mass", None, 2),
        ("eppinger1988/two_mass", "monic", 9),
        ("eppinger1988/sliding_free_beam", "vaughan", 9),
        ("classics/timoshenko_cantilever", "hyperbolic", 1),
    ):
        model = pipeline.load(DERIVATIONS / f"{stem}.toml")
        tfs = pipeline.derive_all(model)[-few:]
        if stem.endswith("two_mass"):
            model = many_parameters(model)
        files, _ = LatexExporter(88.5, form, has_figures=False).export_files(model, tfs)
        for name, text in files.items():
            if name != DOCUMENT:
                key = f"{stem.rpartition('/')[2]}-{name}"
                found[key] = text.replace(r"\label{eq:", rf"\label{{eq:{key}:")
    return found


@pytest.mark.needs_tool("pdftotext")
@pytest.mark.parametrize("engine", engines("pdflatex"))
@pytest.mark.slow
def test_fragments_fit_the_columns_of_a_paper_with_other_packages(engine, fragments, tmp_path):
    for name, text in fragments.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    labels = [label for text in fragments.values() for label in re.findall(r"\\label\{([^}]*)\}", text)]
    body = "\n\n".join(rf"Text before. \input{{{name.removesuffix('.tex')}}}" for name in fragments)
    references = "; ".join(rf"\eqref{{{label}}}, \cref{{{label}}}" for label in labels)
    (tmp_path / "paper.tex").write_text(PAPER % f"{body}\n\n{references}.", encoding="ascii")
    assert len(labels) > 5
    assert compiled(engine, tmp_path) == []
    assert beyond(tmp_path, [(14, 14 + 88.5), (14 + 93.5, 14 + 182)], OVERHANG) == []


@pytest.mark.slow
@pytest.mark.needs_tool("pdftotext")
@pytest.mark.parametrize("engine", engines("lualatex"))
def test_a_document_of_hostile_texts_in_the_narrowest_column_is_like_any_other(engine, tmp_path):
    model = many_parameters(pipeline.load(DERIVATIONS / "eppinger1988" / "two_mass.toml"))
    model = replace(model, title=HOSTILE["commands"], source=HOSTILE["letters"])
    tfs = pipeline.derive_all(model)
    text = LatexExporter(80.0, "constant").export(model, tfs).text
    (tmp_path / "paper.tex").write_text(text, encoding="ascii")
    assert compiled(engine, tmp_path) == []
    assert beyond(tmp_path, [(65, 145)], PROTRUSION) == []
    assert sorted(p.name for p in tmp_path.iterdir()) == ["paper.aux", "paper.log", "paper.pdf", "paper.tex"]
