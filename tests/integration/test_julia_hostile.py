"""No text of a model can become code of Julia: prose changes no statement, names become plain identifiers."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.codegen.julia import JULIA, module_name
from tests.integration.julia import Julia
from tests.integration.julia_in_python import functions_of
from tests.unit.codegen.test_numpy_hostile import HOSTILE, NAMES, SPEC, cut, model_of, renamed, ring_takes

pytestmark = pytest.mark.slow  # the same names are tried in Python's text each time

PHRASES = [
    "$(run(`ls`))",
    "$x",
    "\\$(exit())",
    "\\\\$(exit())",
    "$",
    "```jldoctest\njulia> exit()\n```",
    "```@eval\nexit()\n```",
    "~~~@eval",
    "`exit()`",
    "#= comment",
    "=#",
    '""" module X; exit(); end',
    "end # module",
    "@eval exit()",
    "; exit()",
    "\\u0022",
    "\\x22",
    'raw"',
]
JULIA_NAMES = [
    "end", "function", "module", "baremodule", "begin", "quote", "let", "local", "const", "mutable", "where",
    "isa", "in", "outer", "public", "true", "false", "nothing", "missing", "im", "pi", "e", "Inf", "NaN",
    "exp",
    "abs", "sqrt", "complex", "float", "real", "conj", "Base", "Main", "Core", "Number", "Real", "Complex",
    "Dict", "String", "NamedTuple", "LinearAlgebra", "PARAMETERS", "TRANSFER_FUNCTIONS", "X_over_F",
    "_X_over_F", "Hostile", "s", "z", "number", "eval", "include", "k", "p",
]  # fmt: skip
TEXTS = [*HOSTILE, *PHRASES]
CALLED = list(dict.fromkeys([*NAMES, *JULIA_NAMES, *HOSTILE]))
PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
STRING = re.compile(r'"""(?:[^"\\]|\\.|"(?!""))*"""|"(?:[^"\\\n]|\\.)*"')
BARE_DOLLAR = re.compile(r"(?<!\\)(?:\\\\)*\$")


def written(model, tfs=None, name="hostile"):
    return JULIA.export(model, tfs or pipeline.derive_all(model), name, samples=5).text


def code_of(text):
    """Return a module with its strings emptied."""
    return STRING.sub('""', text)


def kinds_of(text):
    """Return the same with one word for every name and number, however it is laid out."""
    joined = re.sub(r"(?<=[;,(+\-*/])\s+|\s+(?=\))", "", re.sub(r"\w+", "w", code_of(text)))
    return re.sub(r" *\n", "\n", joined)


def fits(name):
    """Tell whether a name is short enough for statements to stay on one line each."""
    return len(name) < 60


def with_prose(text):
    model = model_of()
    parameters = tuple(replace(p, doc=text, unit=text) for p in model.parameters)
    return replace(model, title=text, source=text, parameters=parameters)


def with_name(name):
    return renamed(model_of(), {"b": name if name not in ("s", "pi", "m", "k") else f"{name} "})


def keywords_of(text):
    return re.findall(r"^    (\w+) = \(value", text, re.MULTILINE)


TAME = written(model_of())


@pytest.mark.parametrize("text", TEXTS, ids=cut)
def test_prose_changes_no_statement(text):
    made = written(with_prose(text))
    assert code_of(made) == code_of(TAME)
    assert all(line.isprintable() for line in made.split("\n"))
    strings = STRING.findall(made)
    assert not any(BARE_DOLLAR.search(s) for s in strings)
    assert not any("`" in s or "~~~" in s for s in strings if s.startswith('"""'))


@pytest.mark.parametrize("name", [n for n in CALLED if ring_takes(n)], ids=cut)
def test_a_parameter_of_any_name_is_a_plain_identifier_and_nothing_else_changes(name):
    made = written(with_name(name))
    assert kinds_of(made) == kinds_of(TAME) or not fits(name)
    keywords = keywords_of(made)
    assert len(set(keywords)) == 3
    assert all(PLAIN.fullmatch(k) for k in keywords)
    assert not {"im", "pi", "exp", "end", "abs", "begin", "complex"} & set(keywords)
    # 1/(m + b + k)
    assert functions_of(made)["_value_of_X_over_F"](1.0, 2.0, 3.0, 5.0) == 0.1


@pytest.mark.parametrize("name", CALLED, ids=cut)
def test_an_output_or_a_file_of_any_name_gives_plain_names(name):
    model = model_of()
    tfs = tuple(replace(tf, output=replace(tf.output, name=name)) for tf in pipeline.derive_all(model)[:1])
    made = written(model, tfs, name)
    (module,) = re.findall(r"^module (.*)$", made, re.MULTILINE)
    (function,) = re.findall(r"^export (.*?)\n\n", made, re.MULTILINE | re.DOTALL)
    assert module == module_name(name)
    assert PLAIN.fullmatch(module)
    assert PLAIN.fullmatch(function.strip())
    assert kinds_of(made) == kinds_of(written(model, pipeline.derive_all(model)[:1])) or not fits(name)


@pytest.mark.parametrize("pair", [("lambda", "lambda_"), ("end", "end_"), ("a-b", "a_b"), ("_y", "y")])
def test_two_names_never_become_one(pair):
    made = written(renamed(model_of(), dict(zip("mb", pair, strict=True))))
    assert len(set(keywords_of(made))) == 3


def test_a_definition_cannot_hide_a_name_of_the_code():
    text = SPEC.replace(
        "elements.body", 'definitions = { num = "m*s^2 + k", exp = "2*m", abs = "b*s" }\nelements.body'
    )
    made = written(model_of(text.replace('V = "s*x"', 'V = "num*x*exp*abs"')))
    s, m, b, k = 0.5j, 2.0, 3.0, 5.0
    expected = (m * s**2 + k) * 2 * m * b * s / (m * s**2 + b * s + k)
    assert functions_of(made)["_value_of_V_over_F"](s, m, b, k) == pytest.approx(expected, rel=1e-15)


@pytest.mark.skipif(shutil.which("julia") is None, reason="julia is not installed")
def test_every_hostile_model_computes_in_julia_what_the_tame_one_does(tmp_path):
    julia = Julia(tmp_path)
    models = [with_prose(t) for t in TEXTS] + [with_name(n) for n in CALLED if ring_takes(n)]
    for i, model in enumerate(models):
        made = written(model, name=f"hostile_{i}")
        julia.write(f"hostile_{i}", made)
        second, third = keywords_of(made)[1:]
        julia.do(f"print(Hostile{i}.X_over_F(1; {second} = 3, {third} = 5) == 0.1 ? '.' : 'x')")
        julia.do(f"length(string(@doc Hostile{i}.X_over_F))")
    docs = [f"Hostile{i}.PARAMETERS[1].doc" for i in range(len(TEXTS))]
    julia.do(f"println(); foreach(d -> println(join(map(UInt32, collect(d)), ' ')), [{', '.join(docs)}])")
    first, *others = julia.run().splitlines()
    assert first == "." * len(models)
    found = ["".join(chr(int(n)) for n in line.split()) for line in others]
    assert found == TEXTS
