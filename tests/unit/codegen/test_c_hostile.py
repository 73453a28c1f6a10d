"""No text of a model can become C: prose stays in comments, names become identifiers of no other meaning."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.codegen.c.body import FUNCTIONS, KEYWORDS, LOCALS, MACROS, RESERVED
from symflex.codegen.c.module import C99
from tests.house.repository import one_in
from tests.unit.codegen.test_numpy_hostile import HOSTILE, NAMES, SPEC, cut, model_of, renamed, ring_takes

IN_COMMENTS = [
    *HOSTILE,
    "*/",
    "*/ int main(void) { abort(); } /*",
    "/*",
    "/* */",
    "**//",
    "*\\",
    "*\\\n/",
    "??/",
    "*??/\n/ abort();",
    "??=include </etc/passwd>",
    "*?" + "?/" * 3,
    "// \\",
    "\n#include </etc/passwd>",
    "#define double float",
    "*\t/",
    "* /",
    "*/" * 2000,
    "/" * 500,
    "*" * 500,
    "<::>%:",
]
C_NAMES = sorted({*NAMES, *KEYWORDS, *MACROS, *FUNCTIONS, *LOCALS})
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only"]
TOKEN = re.compile(r"[A-Za-z_]\w*|\.?\d[\w.]*(?:e[+-]\d+)?|\"[^\"\n]*\"|#\w+|[^\w\s]")


def files_of(model, tfs=None, name="plant"):
    return C99.export(model, tfs or pipeline.derive_all(model), stem=name, is_alone=False, samples=3)


def tokens(text):
    """Return the tokens a compiler sees: lines are spliced, trigraphs replaced, comments gone."""
    for trigraph, mark in zip("=/'()!<>-", "#\\^[]|{}~", strict=True):
        text = text.replace(f"??{trigraph}", mark)
    text = re.sub(r"\\[ \t]*\n", "", text)
    found, at = [], 0
    while at < len(text):
        if text.startswith("/*", at):
            end = text.index("*/", at + 2)
            assert "/*" not in text[at + 2 : end], "a comment inside a comment"
            at = end + 2
        elif text.startswith("//", at):
            at = text.index("\n", at)
        elif match := TOKEN.match(text, at):
            found.append(match.group())
            at = match.end()
        else:
            assert text[at].isspace(), text[at]
            at += 1
    return found


def skeleton(files):
    return tokens(files.companions[".h"]), tokens(files.text)


def structure(files):
    """Return the tokens with every identifier that is none of C's own reduced to one letter."""
    return [
        "x" if re.match(r"[A-Za-z_\"]", t) and t not in KEYWORDS else t
        for part in skeleton(files)
        for t in part
    ]


def dressed(text):
    """Return the model with a text wherever it has prose."""
    model = model_of()
    parameters = tuple(replace(p, doc=text, unit=text) for p in model.parameters)
    return replace(model, title=text, source=text, parameters=parameters)


TAME = files_of(model_of())


@pytest.mark.parametrize("text", one_in(3, IN_COMMENTS), ids=cut)
def test_prose_changes_no_token(text):
    files = files_of(dressed(text))
    assert skeleton(files) == skeleton(TAME)
    for part in (files.companions[".h"], files.text):
        assert all(line.isprintable() for line in part.split("\n"))
        part.encode("utf-8")


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_compilers_take_all_prose_without_a_warning(tmp_path):
    for i, text in enumerate(IN_COMMENTS):
        files = files_of(dressed(text), name=f"prose_{i}")
        (tmp_path / f"prose_{i}.c").write_text(files.text, encoding="utf-8")
        (tmp_path / f"prose_{i}.h").write_text(files.companions[".h"], encoding="utf-8")
    _compile(tmp_path)


def _compile(folder):
    sources = sorted(path.name for path in folder.glob("*.c"))
    done = subprocess.run(["gcc", *STRICT, *sources], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_a_parameter_or_output_of_any_name_keeps_the_structure_and_compiles(tmp_path):
    names = [n for n in dict.fromkeys((*C_NAMES, *HOSTILE)) if ring_takes(n)]
    assert len(names) > 300
    for i, name in enumerate(names):
        given = name if name not in ("s", "pi", "m", "k", "F", "x", "X", "V") else f"{name} "
        model = renamed(model_of(), {"b": given})
        tfs = pipeline.derive_all(model)
        tfs = (replace(tfs[0], output=replace(tfs[0].output, name=name)), *tfs[1:])
        files = files_of(model, tfs, name=f"name_{i}")
        assert structure(files) == structure(TAME), name
        member = re.findall(r"^    double (\w+);", files.companions[".h"], re.MULTILINE)[1]
        assert member not in RESERVED
        (tmp_path / f"name_{i}.c").write_text(files.text, encoding="utf-8")
        (tmp_path / f"name_{i}.h").write_text(files.companions[".h"], encoding="utf-8")
    _compile(tmp_path)


@pytest.mark.parametrize(
    "pair", [("I", "I_"), ("I_", "I"), ("complex", "complex_"), ("a-b", "a_b"), ("a b", "a-b"), ("_y", "y")]
)
def test_two_parameters_never_share_a_member(pair):
    header = files_of(renamed(model_of(), {"m": pair[0], "b": pair[1]})).companions[".h"]
    members = re.findall(r"^    double (\w+);", header, re.MULTILINE)
    assert len(set(members)) == len(members) == 3


@pytest.mark.parametrize(
    "names",
    [
        [("X", "F"), ("X", "F_freq")],
        [("X", "F_freq"), ("X", "F")],
        [("a", "b_over_c"), ("a_over_b", "c")],
        [("X", "F"), ("X", "F_"), ("X", "F-"), ("X", "F_freq"), ("X", "F-freq")],
    ],
)
def test_functions_whose_names_run_together_stay_apart(names):
    model = model_of()
    first = pipeline.derive_all(model)[0]
    tfs = [
        replace(first, output=replace(first.output, name=y), input=replace(first.input, name=u))
        for y, u in names
    ]
    files = files_of(model, tfs)
    declared = re.findall(r"\b(plant_\w+)\(", "\n".join(files.companions[".h"].split("#ifndef PLANT_H")[1:]))
    assert len(declared) == len(set(declared)) == 2 * len(names)


@pytest.mark.parametrize("name", ["value_of", "piece_0_of", "cx", "int", "_x", "2dof", "a.b-c+d", "I"])
def test_a_file_of_any_name_has_public_names_of_its_own(name):
    files = files_of(model_of(), name=name)
    functions = re.findall(r"^[a-z][\w ]* (\w+)\([^;{]*\)[^;{]*\n\{", files.text, re.MULTILINE)
    assert len(functions) == len(set(functions))
    assert all(re.fullmatch(r"[A-Za-z]\w*", f) and f not in RESERVED for f in functions)
    assert f'#include "{name}.h"' in files.text


def test_a_definition_cannot_hide_a_parameter_or_a_name_of_the_code():
    text = SPEC.replace(
        "elements.body",
        'definitions = { num = "m*s^2 + k", g = "2*m", omega = "b*s", cx_mul = "3*m" }\nelements.body',
    )
    source = files_of(model_of(text.replace('V = "s*x"', 'V = "num*x*g*omega*cx_mul"'))).text
    bodies = source.split("\n}\n")
    for body in bodies:
        made = re.findall(r"const (?:double|cx) (\w+) =", body)
        assert len(made) == len(set(made))
        assert not {*made} & {"cx_mul", "omega", "p", "s"}
