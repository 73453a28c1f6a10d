"""Documents and files for a paper: their parts, their names, and what no text of a model can do in them."""

import re
from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.codegen.latex import LatexExporter
from symflex.print.forms import print_form
from symflex.print.latex import DOCUMENT, latex_files
from tests.unit.codegen.hostile_names import HOSTILE
from tests.unit.print.test_html import MARKUP, SPEC
from tests.unit.print.test_latex_text import COMMANDS as OF_TEXT

MORE = [
    r"\input{/etc/passwd}", r"\write18{ls}", r"\immediate\write18{ls}", r"\openout3=a \write3{b}",
    r"\def\x{y}\x", r"\catcode`\%=12", r"^^5cinput ^^M", r"\end{document}", r"\csname input\endcsname",
    r"}\par\input{x}{", "% comment\n\\input{x}", r"\directlua{os.execute('ls')}",
]  # fmt: skip


@pytest.fixture(scope="module")
def model():
    return pipeline.loads(SPEC.replace('g = { unit = "m/s^2" }', 'g = "9.81 m/s^2"'))


def files_of(model):
    # Figures of hostile models are in test_pgf.py.
    exporter = LatexExporter(88.5, has_figures=False)
    files, warnings = exporter.export_files(model, pipeline.derive_all(model))
    assert warnings == ()
    return files


def commands(files):
    whole = "\n".join(OF_TEXT.sub("", text) for text in files.values())
    return set(re.findall(r"\\(?:[A-Za-z]+|.)", whole))


def with_texts(model, text):
    parameters = tuple(replace(p, doc=f"d{text}", unit=text) for p in model.parameters)
    return replace(model, title=f"t{text}", source=f"s{text}", parameters=parameters)


@pytest.mark.slow
def test_no_text_of_a_model_brings_a_command(model):
    # Letters that a plain text is made of, a unit that siunitx lacks, and a description in lines.
    usual = commands(files_of(with_texts(model, "words " * 20)))
    for text in (*HOSTILE, *MARKUP, *MORE):
        files = files_of(with_texts(model, text))
        assert commands(files) <= usual | {r"\qty", r"\num", r"\unit", r"\newline"}, text
        for name, file in files.items():
            assert file.isascii(), (name, text)
            plain = OF_TEXT.sub("", file)
            assert plain.count("{") == plain.count("}"), (name, text)
            # Comments are the ones at the top.
            lines = plain.splitlines()
            first = next(i for i, line in enumerate(lines) if not line.startswith("%"))
            assert "%" not in "\n".join(lines[first:]), (name, text)
            assert "^^" not in plain, (name, text)


def test_what_is_input_are_the_files_themselves(model):
    files = files_of(with_texts(model, r"\input{x}"))
    names = re.findall(r"\\input\{([^}]*)\}", files[DOCUMENT])
    assert {f"{name}.tex" for name in names} == set(files) - {DOCUMENT}
    assert not any(r"\input" in OF_TEXT.sub("", text) for name, text in files.items() if name != DOCUMENT)


def test_names_of_files_are_letters_whatever_the_function_is_called(model):
    (tf,) = pipeline.derive_all(model)
    odd = ["../a", "a/../../b", "C:\\x", "a b", "A", "a", "a_over_b", "a\0", "ä", "a.tex", "document"]
    copies = [replace(tf, output=replace(tf.output, name=name)) for name in odd]
    files = latex_files(model, copies, [print_form(tf)] * len(copies))
    assert all(re.fullmatch(r"[A-Za-z0-9_]+\.tex", name) for name in files)
    assert len({name.lower() for name in files}) == len(copies) + 2


def test_hidden_factors_with_a_delay_or_waves_are_named_where_the_function_has_neither():
    late = 'y = "(1 - 2*exp(-s*T))/(s + 1)*u"\nu = "(r - y)/(1 - 2*exp(-s*T))"\n'
    beside = 'a = { type = "mass", at = "y", m = 2 }\nb = { type = "rod", EA = 3, rhoA = 1, l = 1, '
    beside += 'between = ["ground", "tip"] }\nc = { type = "mass", at = "tip", m = 1 }\n'
    for text, said in [
        (f"parameters.T = 1\ninputs.r = {{}}\noutputs.Y = 'y'\n[signals]\n{late}", "{-T s} - 1$ cancels"),
        (
            f"inputs.F = {{ force = 'y' }}\noutputs.Y = 'y'\n[elements]\n{beside}",
            r"\cosh(q)$ cancels",
        ),
    ]:
        model = pipeline.loads(f"symflex = 1\n{text}")
        (tf,) = pipeline.derive_all(model)
        whole = "".join(latex_files(model, [tf], [print_form(tf)]).values())
        assert said in whole, whole


def test_a_map_that_cannot_be_found_is_told_and_left_out(model, monkeypatch):
    from symflex.codegen import latex
    from symflex.errors import Diagnostic, UncertifiedError

    def refuse(*_, **__):
        raise UncertifiedError(Diagnostic("SF405", "poles cannot be separated"))

    monkeypatch.setattr(latex, "locate", refuse)
    made = LatexExporter().export(model, pipeline.derive_all(model))
    assert made.warnings == ("poles and zeros of X/F are left out: poles cannot be separated",)
    assert "Poles" not in made.text
