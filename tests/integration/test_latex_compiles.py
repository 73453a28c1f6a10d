"""Everything the LaTeX printer writes compiles with pdflatex without a warning."""

from __future__ import annotations

import random
import re
import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest

from symflex.equations import assemble
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
from symflex.model import load_model
from symflex.model.spec import read
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.printed import forms_of
from symflex.print.latex import latex_document, latex_expression, latex_fragment
from symflex.print.latex.expression import Writer
from symflex.roots.locate import locate
from symflex.transfer import bind, derive, derive_all
from tests.house.repository import specifications
from tests.unit.codegen.models_with_kernels import derived as of_case

pytestmark = pytest.mark.needs_tool("pdflatex")

DERIVATIONS = Path(__file__).parents[2] / "derivations"
WITH_KERNELS = ("sliding_free_beam", "robot_axis")
MODELS = [p for p in specifications(DERIVATIONS / "eppinger1988", "*.toml") if p.stem not in WITH_KERNELS]
DISTRIBUTED = [
    *(DERIVATIONS / "eppinger1988" / f"{name}.toml" for name in WITH_KERNELS),
    *specifications(DERIVATIONS / "classics", "*.toml"),
]
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


def marks_of(is_quick):
    """TeX takes seconds: one document of a kind is compiled each time, the others when asked for."""
    return [] if is_quick else [pytest.mark.slow]


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


def complaints(folder, source):
    (folder / "paper.tex").write_text(source, encoding="utf-8")
    return compiled("pdflatex", folder)


def nested(block, ring):
    tf = derive(assemble(block.submodel, nested), *block.tf)
    images = [ring.generator(name) for name in tf.ratio.ring.names]
    return tf.ratio.map_factors(ring, lambda f: type(tf.ratio).polynomial(ring, ring.compose(f, images)))


def derived(path):
    model = load_model(read(path))
    return model, derive_all(assemble(model, nested), model.transfer_functions)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "form"),
    [
        pytest.param(
            path, form, id=f"{path.stem}-{form}", marks=marks_of(path.stem == "rigid_body" and not form)
        )
        for path in MODELS
        for form in (None, "polynomial", "zpk")
    ],
)
def test_the_document_of_every_model_compiles_without_a_warning(path, form, tmp_path):
    model, tfs = derived(path)
    maps = [locate(bind(tf), None, 12) for tf in tfs]
    forms = [print_form(tf, form) for tf in tfs]
    assert complaints(tmp_path, latex_document(model, tfs, forms, pole_zero_maps=maps)) == []


@pytest.mark.slow
@pytest.mark.parametrize("path", DISTRIBUTED, ids=lambda p: p.stem)
def test_the_document_of_a_model_with_kernels_compiles_without_a_warning(path, tmp_path):
    model, tfs = derived(path)
    assert complaints(tmp_path, latex_document(model, tfs, [print_form(tf) for tf in tfs])) == []


@pytest.mark.slow
@pytest.mark.parametrize("path", [*DISTRIBUTED, Path("third order")], ids=lambda p: p.stem)
def test_every_form_of_a_function_with_kernels_fits_a_column(path, tmp_path):
    fragments = [
        "Text:\n"
        + latex_fragment(tf, print_form(tf, form), width_mm=88).replace(r"\label{", rf"\label{{{form}-")
        for tf in of_case(path.stem)
        for form in forms_of(tf)
    ]
    assert complaints(tmp_path, WRAPPER % (88, "\n\n".join(fragments))) == []


@pytest.mark.slow
@pytest.mark.parametrize("width", [88.0, 120.0])
@pytest.mark.parametrize("path", MODELS, ids=lambda p: p.stem)
def test_a_fragment_fits_the_column_it_is_made_for(path, width, tmp_path):
    _, tfs = derived(path)
    fragments = "\n\n".join("Text:\n" + latex_fragment(tf, print_form(tf), width_mm=width) for tf in tfs)
    assert complaints(tmp_path, WRAPPER % (width, fragments)) == []


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
@pytest.mark.parametrize(
    "text", [pytest.param(t, id=n, marks=marks_of(n == "commands")) for n, t in HOSTILE.items()]
)
def test_hostile_titles_and_descriptions_compile_without_a_warning(text, tmp_path):
    model, _ = derived(next(p for p in MODELS if p.stem == "two_mass"))
    first = model.parameters
    parameters = tuple(
        replace(
            first[i % 4], name=first[i].name if i < 4 else f"q_{i}", doc=text, latex=LABELS[i], unit=UNITS[i]
        )
        for i in range(len(LABELS))
    )
    model = replace(model, title=text, source=text, parameters=parameters)
    tfs = derive_all(assemble(model), model.transfer_functions)
    source = latex_document(model, tfs, [print_form(tf) for tf in tfs])
    assert complaints(tmp_path, source) == []


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
    fragments = []
    for i in range(40):
        where = tuple((name, tree(chance, 3)) for name in ("p", "Z_1", "N", "w" * 60)[: chance.randint(0, 4)])
        form = PrintedForm(
            "test", tree(chance, chance.randint(1, 5)), tree(chance, chance.randint(1, 5)), where
        )
        fragments.append("Text:\n" + latex_fragment(fake(f"{i}", chance), form, width_mm=width))
    assert complaints(tmp_path, WRAPPER % (width, "\n\n".join(fragments))) == []


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


@pytest.mark.slow
def test_a_sum_of_twenty_thousand_terms_compiles_without_a_warning(tmp_path):
    terms = [
        product_of([number(i + 2), Name(f"m_{i % 9}"), power(Name("s"), i % 40 + 2)]) for i in range(20_000)
    ]
    latex = latex_fragment(fake("big", random.Random(0)), PrintedForm("test", number(1), sum_of(terms)))
    assert complaints(tmp_path, WRAPPER % (170, "Text:\n" + latex)) == []
