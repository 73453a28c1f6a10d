"""Everything the LaTeX printer writes compiles without a warning, and nothing is set beyond its column.

Many texts go into one document; what is complained of bears the name of the text that it follows.
"""

import random
import re
import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.expressions import (
    FUNCTIONS,
    Call,
    Name,
    Power,
    Quotient,
    negative,
    number,
    power,
    product_of,
    sum_of,
)
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.printed import forms_of
from symflex.print.latex import DOCUMENT, latex_document, latex_expression, latex_fragment
from symflex.print.latex.expression import Writer
from symflex.roots.locate import locate
from symflex.transfer import bind
from tests.unit.codegen.hostile_names import HOSTILE as TEXTS
from tests.unit.codegen.models_with_kernels import derived as of_case

pytestmark = pytest.mark.needs_tool("pdflatex")

DERIVATIONS = Path(__file__).parents[2] / "derivations"
RUNS = 3
"""At most: with hyperref, a third run settles the outlines."""
AGAIN = re.compile(r"Rerun (?!checks)")
"""What LaTeX says of references and outlines that have moved; one package has the word in its own name."""
COMPLAINT = re.compile(r"^(?:!|.*Warning:|Overfull|Underfull|Missing character).*$", re.MULTILINE)
SAFE = ["-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape"]
WRAPPER = (
    r"\documentclass[10pt]{article}\usepackage[T1]{fontenc}\usepackage{lmodern,amsmath}"
    r"\usepackage[textwidth=%gmm,textheight=240mm]{geometry}\raggedbottom\begin{document}"
    "\n%s\n\\end{document}\n"
)


def settled(engine, folder, name="paper"):
    """Compile until nothing moves any more, and return the log."""
    for _ in range(RUNS):
        subprocess.run([engine, *SAFE, f"{name}.tex"], cwd=folder, capture_output=True, check=False)
        log = (folder / f"{name}.log").read_text(encoding="latin-1")
        if not AGAIN.search(log):
            break
    return log


def compiled(engine, folder, name="paper"):
    """Compile a file, and return what was complained of."""
    log = settled(engine, folder, name)
    assert "Output written" in log
    return COMPLAINT.findall(log)


def complaints_of_parts(folder, parts, opening, column=None):
    """Compile many texts in one document, and return complaints with the names of the texts they follow."""
    texts = [
        rf"\typeout{{PART {i} {name}}}" + "\n" + re.sub(r"\\(label|eqref)\{", rf"\\\1{{{i}:", text)
        for i, (name, text) in enumerate(parts)
    ]
    body = "\n\n".join(texts)
    source = opening % (column, body) if column else f"{opening}{body}\n\\end{{document}}\n"
    (folder / "paper.tex").write_text(source, encoding="utf-8")
    log = settled("pdflatex", folder)
    first, *others = log.split("\nPART ")
    assert len(others) == len(parts), log[-2000:]
    assert "Output written" in log, log[-2000:]
    return [(part.split("\n")[0], found) for part in (first, *others) for found in COMPLAINT.findall(part)]


def body_of(document):
    """Return what an article opens with, and what it holds."""
    opening, begin, body = document.partition("\\begin{document}\n")
    return opening + begin, body.removesuffix("\\end{document}\n")


def derived(stem):
    model = pipeline.load(DERIVATIONS / f"{stem}.toml")
    return model, pipeline.derive_all(model)


# Kinds of tables and equations: symbolic, with numbers, with hidden modes, of beams, with laws of their own.
DOCUMENTS = {
    "eppinger1988/rigid_body": ("zpk", True),
    "eppinger1988/two_mass": (None, True),
    "eppinger1988/fitted_resonances": ("polynomial", True),
    "eppinger1988/lumped_bending_beam": ("constant", True),
    "eppinger1988/sliding_free_beam": ("vaughan", False),
    "eppinger1988/robot_axis": (None, False),
    "classics/clamped_clamped": ("frequency", False),
    "tapers/wedge": (None, False),
}


@pytest.mark.slow
def test_documents_of_models_of_every_kind_compile_without_a_warning(tmp_path):
    parts = []
    for stem, (form, has_maps) in DOCUMENTS.items():
        model, tfs = derived(stem)
        maps = [locate(bind(tf), None, 12) for tf in tfs] if has_maps else ()
        document = latex_document(model, tfs, [print_form(tf, form) for tf in tfs], pole_zero_maps=maps)
        opening, body = body_of(document)
        parts.append((stem, body))
    assert complaints_of_parts(tmp_path, parts, opening) == []


@pytest.mark.slow
def test_a_document_compiles_where_fonts_are_bitmaps_that_cannot_be_expanded(tmp_path):
    model, tfs = derived("eppinger1988/two_mass")
    document = latex_document(model, tfs, [print_form(tf) for tf in tfs])
    (tmp_path / "paper.tex").write_text(
        document.replace("lmodern.sty", "no-such-fonts.sty"), encoding="utf-8"
    )
    assert "Output written" in settled("pdflatex", tmp_path)


FITTING = {
    88.0: ("sliding_free_beam", "clamped_clamped", "third order", "damped rod", "timoshenko_cantilever"),
    120.0: ("sliding_free_beam", "rayleigh beam", "rigid_body", "six_mass"),
}


@pytest.mark.slow
@pytest.mark.parametrize("width", FITTING)
def test_fragments_of_every_form_fit_the_column_they_are_made_for(width, tmp_path):
    parts = [
        (f"{name} {tf.name} {form}", "Text:\n" + latex_fragment(tf, print_form(tf, form), width_mm=width))
        for name in FITTING[width]
        for tf in of_case(name)[:2]
        for form in ((None,) if tf.is_rational else forms_of(tf))
    ]
    assert complaints_of_parts(tmp_path, parts, WRAPPER, width) == []


HOSTILE = {
    "commands": r"\input{x} \write18{ls} \def\x{y} \catcode`\#=1 ^^5c $x_1$ 100% # ~ {}} \end{document}",
    "letters": "Größe, Łódź, ž, ΑΩ αβγ ϑ 中文 Кириллица → ≤ ½ ² ′ … “q” 😀 ﬁ \x07\x1b[31m\u202e\u200b \ud800",
    "latin": "".join(map(chr, range(0x20, 0x250))),
    "wide": "W" * 400,
    "address": "https://doi.org/10.1109/ROBOT.1988.12115?x=%20&y=_#a",
    "lines": "a\n\n\\par\n\n\tb",
    "ligatures": "?` !` ,, << >> -- --- '' `` 'quoted' \"quoted\"",
    "long": "word " * 300,
}
LABELS = (
    r"\hat", "x^2'", r"\text{a_b}", r"\overline{\dot{\mathcal{abc}}}^{\star}", r"\boldsymbol{\gamma}|a|",
    "W" * 120, r"\operatorname{a-b'*}_{x}", r"\varpi^{\infty}_{\ldots}", "a+b", "x'",
)  # fmt: skip
UNITS = ("kg", "zz_%", "m^(1/2)", "", "1/s", r"\input{x}", "kN*m^2/rad", "1", "furlong", "m/(V*s)")


@pytest.mark.slow
def test_hostile_titles_and_descriptions_compile_without_a_warning(tmp_path):
    model, tfs = derived("eppinger1988/two_mass")
    forms = [print_form(tf) for tf in tfs]
    first = model.parameters
    parts = []
    for name, text in HOSTILE.items():
        parameters = tuple(
            replace(first[i % 4], name=first[i].name if i < 4 else f"q_{i}", doc=text, latex=label, unit=unit)
            for i, (label, unit) in enumerate(zip(LABELS, UNITS, strict=True))
        )
        model = replace(model, title=text, source=text, parameters=parameters)
        opening, body = body_of(latex_document(model, [replace(tf, model=model) for tf in tfs], forms))
        parts.append((name, body))
    assert complaints_of_parts(tmp_path, parts, opening) == []


NAMES = ("a", "m_1", "k_amp", "omega_p1", "EI", "W" * 64, "a__b", "x_" + "M" * 20, "zeta", "s", "s", "s")
DECLARED = {"a": "a'", "m_1": "m_1^{*}", "k_amp": r"\hat{k}_{\text{a b}}", "EI": "W" * 11, "zeta": "a+b"}
NUMBERS = (2, Fraction(1, 3), 10**190, Fraction(7, 10**12), Fraction(10**80 + 1, 3**70))


def tree(chance, depth):
    kind = chance.random()
    if depth == 0 or kind < 0.12:
        return Name(chance.choice(NAMES)) if chance.random() < 0.8 else number(chance.choice(NUMBERS))
    if kind < 0.45:
        terms = [tree(chance, depth - 1) for _ in range(chance.randint(2, 6))]
        return sum_of([negative(t) if chance.random() < 0.3 else t for t in terms])
    if kind < 0.75:
        return product_of([tree(chance, depth - 1) for _ in range(chance.randint(2, 5))])
    if kind < 0.83:
        return Quotient(tree(chance, depth - 1), tree(chance, depth - 1))
    if kind < 0.92:
        return Power(
            tree(chance, depth - 1), number(chance.choice((2, 3, -1, Fraction(1, 2), Fraction(3, 2))))
        )
    return Call(chance.choice(sorted(FUNCTIONS)), tree(chance, depth - 1))


def fake(name, chance):
    """Return the parts of a transfer function that the printer reads."""
    output, source = chance.choice(NAMES), chance.choice(NAMES)
    parameters = [SimpleNamespace(name=n, latex=latex) for n, latex in DECLARED.items()]
    return SimpleNamespace(
        name=name,
        quantity="mobility",
        output=SimpleNamespace(name=output, latex=DECLARED.get(output, "")),
        input=SimpleNamespace(name=source, latex=DECLARED.get(source, "")),
        model=SimpleNamespace(parameters=parameters, definitions=[]),
    )


@pytest.mark.slow
@pytest.mark.parametrize("width", [88.0, 160.0])
def test_random_formulas_fit_whatever_their_names_and_numbers(width, tmp_path):
    chance = random.Random(1988)
    parts = []
    for i in range(40):
        where = tuple((name, tree(chance, 3)) for name in ("p", "Z_1", "N", "w" * 60)[: chance.randint(0, 4)])
        form = PrintedForm(
            "test", tree(chance, chance.randint(1, 5)), tree(chance, chance.randint(1, 5)), where
        )
        parts.append((str(i), "Text:\n" + latex_fragment(fake(f"{i}", chance), form, width_mm=width)))
    # Displays that TeX holds in its memory one after the other.
    s = Name("s")
    terms = [product_of([number(i + 2), Name(f"m_{i % 9}"), power(s, i % 40 + 2)]) for i in range(2500)]
    form = PrintedForm("test", number(1), sum_of(terms))
    parts.append(("long", "Text:\n" + latex_fragment(fake("long", chance), form, width_mm=width)))
    assert complaints_of_parts(tmp_path, parts, WRAPPER, width) == []


@pytest.mark.slow
def test_estimated_widths_are_never_below_those_of_tex(tmp_path):
    chance = random.Random(8)
    expressions = [tree(chance, chance.randint(0, 3)) for _ in range(300)]
    boxes = [
        rf"\setbox0\hbox{{$\displaystyle {latex_expression(e, DECLARED)}$}}\typeout{{WIDTH \the\wd0}}"
        for e in expressions
    ]
    (tmp_path / "paper.tex").write_text(WRAPPER % (160, "\n".join(boxes)), encoding="utf-8")
    log = settled("pdflatex", tmp_path)
    widths = [float(w) / 10 for w in re.findall(r"WIDTH ([0-9.]+)pt", log)]  # one em is ten points
    estimates = [Writer(DECLARED).piece(e).width for e in expressions]
    assert len(widths) == len(estimates)
    assert [e for e, w in zip(estimates, widths, strict=True) if e < w] == []


# ----- Fragments in somebody's paper, and where glyphs end up on compiled pages.

POINTS_PER_MM = 72 / 25.4
OVERHANG = 0.15
"""How far a slanted letter reaches over its box [mm]."""
PROTRUSION = 0.8
"""How far microtype puts full stops and parentheses into the margin, on purpose [mm]."""

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


def fragments():
    """Return texts by name: equations of several forms and tables of several models, for a column."""
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


@pytest.mark.slow
@pytest.mark.needs_tool("pdftotext", "pdflatex")
def test_fragments_fit_the_columns_of_a_paper_with_other_packages(tmp_path):
    files = fragments()
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    labels = [label for text in files.values() for label in re.findall(r"\\label\{([^}]*)\}", text)]
    body = "\n\n".join(rf"Text before. \input{{{name.removesuffix('.tex')}}}" for name in files)
    references = "; ".join(rf"\eqref{{{label}}}, \cref{{{label}}}" for label in labels)
    (tmp_path / "paper.tex").write_text(PAPER % f"{body}\n\n{references}.", encoding="ascii")
    assert len(labels) > 5
    assert compiled("pdflatex", tmp_path) == []
    assert beyond(tmp_path, [(14, 14 + 88.5), (14 + 93.5, 14 + 182)], OVERHANG) == []


@pytest.mark.slow
@pytest.mark.needs_tool("pdftotext", "lualatex")
def test_a_document_of_hostile_texts_in_the_narrowest_column_is_like_any_other(tmp_path):
    model = many_parameters(pipeline.load(DERIVATIONS / "eppinger1988" / "two_mass.toml"))
    model = replace(model, title=HOSTILE["commands"], source=HOSTILE["letters"])
    tfs = pipeline.derive_all(model)
    text = LatexExporter(80.0, "constant").export(model, tfs).text
    (tmp_path / "paper.tex").write_text(text, encoding="ascii")
    assert compiled("lualatex", tmp_path) == []
    assert beyond(tmp_path, [(65, 145)], PROTRUSION) == []
    assert sorted(p.name for p in tmp_path.iterdir()) == ["paper.aux", "paper.log", "paper.pdf", "paper.tex"]
