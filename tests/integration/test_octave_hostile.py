"""No text of a model can become code of MATLAB: prose changes no statement, names become identifiers."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.codegen.matlab import MATLAB, main_name
from tests.integration.octave import Octave
from tests.unit.codegen.test_numpy_hostile import HOSTILE, NAMES, SPEC, cut, model_of, renamed, ring_takes

pytestmark = pytest.mark.slow  # the same names are tried in Python's text each time

PHRASES = [
    "%{",
    "%}",
    "%{\nunlink('x')\n%}",
    "...",
    "a ...",
    "'",
    "''",
    "'); unlink('x'); ('",
    "end",
    "end\nend\nsystem('ls')",
    "%!test error('ran')",
    "-*- texinfo -*-\n@include /etc/passwd",
    '<a href="matlab:exit">see</a>',
    "Copyright of nobody",
    "x' * y'",
    "!ls",
    "@exit",
    "%#ok",
    "\\n",
    "%d%s\\x",
]
MATLAB_NAMES = [
    "end", "endfunction", "parfor", "spmd", "classdef", "until", "unwind_protect", "methods", "events",
    "i", "j", "pi", "e", "eps", "Inf", "NaN", "ans", "exp", "abs", "sqrt", "complex", "zeros", "ones", "size",
    "varargin", "nargin", "numbers", "columns", "everywhere", "given", "value", "G", "s", "p", "k", "number",
    "X_over_F_value", "X_over_F", "default_parameters", "model", "z", "x" * 63, "x" * 64, "x" * 200,
]  # fmt: skip
TEXTS = [*HOSTILE, *PHRASES]
CALLED = list(dict.fromkeys([*NAMES, *MATLAB_NAMES, *HOSTILE]))
PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")
LINK = re.compile(r"<(?!U\+)[a-zA-Z/]")
STRING = re.compile(r"'(?:[^'\n]|'')*'")


def written(model, tfs=None, name="hostile"):
    return MATLAB.export(model, tfs or pipeline.derive_all(model), name, samples=5).text


def code_of(text):
    """Return statements with strings emptied; a comment takes its whole line, no string goes over a line."""
    lines = [line for line in text.split("\n") if not line.startswith("%")]
    return [STRING.sub("''", line) for line in lines]


def kinds_of(text):
    """Return the same with one word for every name and number, and lines joined."""
    joined = re.sub(r" \.\.\.\n *", " ", "\n".join(code_of(text)))
    return re.sub(r"\w+", "w", joined)


def with_prose(text):
    model = model_of()
    parameters = tuple(replace(p, doc=text, unit=text) for p in model.parameters)
    return replace(model, title=text, source=text, parameters=parameters)


def with_name(name):
    return renamed(model_of(), {"b": name if name not in ("s", "pi", "m", "k") else f"{name} "})


TAME = written(model_of())


@pytest.mark.parametrize("text", TEXTS, ids=cut)
def test_prose_changes_no_statement(text):
    made = written(with_prose(text))
    assert code_of(made) == code_of(TAME)
    assert all(line.isprintable() for line in made.split("\n"))
    comments = [line for line in made.split("\n") if line.startswith("%")]
    assert not any(re.match(r"%[{}!#]", c) or "-*-" in c or LINK.search(c) for c in comments)


@pytest.mark.parametrize("name", [n for n in CALLED if ring_takes(n)], ids=cut)
def test_a_parameter_of_any_name_is_a_plain_identifier_and_nothing_else_changes(name):
    made = written(with_name(name))
    assert kinds_of(made) == kinds_of(TAME)
    fields = re.findall(r"^  p\.(\S+) = ", made, re.MULTILINE)
    assert len(set(fields)) == 3
    assert all(PLAIN.fullmatch(f) for f in fields)
    assert not {"i", "j", "pi", "exp", "end", "abs"} & set(fields)


@pytest.mark.parametrize("name", CALLED, ids=cut)
def test_an_output_or_a_file_of_any_name_gives_plain_names(name):
    model = model_of()
    tfs = tuple(replace(tf, output=replace(tf.output, name=name)) for tf in pipeline.derive_all(model)[:1])
    made = written(model, tfs, name)
    names = re.findall(r"^function (?:\S+|\[.*?\]) = (\w+)\(", made, re.MULTILINE)
    assert len(names) == len(set(names))
    assert all(PLAIN.fullmatch(n) for n in names)
    assert names[0] == main_name(name)
    assert kinds_of(made) == kinds_of(written(model, pipeline.derive_all(model)[:1]))


@pytest.mark.parametrize("pair", [("lambda", "lambda_"), ("a-b", "a_b"), ("x" * 63, "x" * 64), ("_y", "y")])
def test_two_names_never_become_one(pair):
    made = written(renamed(model_of(), dict(zip("mb", pair, strict=True))))
    fields = re.findall(r"^  p\.(\S+) = ", made, re.MULTILINE)
    assert len(set(fields)) == 3


@pytest.mark.needs_tool("octave")
def test_a_definition_cannot_hide_a_name_of_the_code(tmp_path):
    octave = Octave(tmp_path)
    text = SPEC.replace(
        "elements.body", 'definitions = { num = "m*s^2 + k", value = "2*m", abs = "b*s" }\nelements.body'
    )
    model = model_of(text.replace('V = "s*x"', 'V = "num*x*value*abs"'))
    octave.write("hiding_names", written(model, name="hiding_names"))
    octave.do("G = hiding_names();")
    key = octave.keep("G.V_over_F(0.5i, 'k', 5)")
    octave.run()
    s, m, b, k = 0.5j, 2.0, 3.0, 5.0
    expected = (m * s**2 + k) * 2 * m * b * s / (m * s**2 + b * s + k)
    assert octave.value(key)[0] == pytest.approx(expected, rel=1e-15)


@pytest.mark.needs_tool("octave")
def test_every_hostile_model_computes_in_octave_what_the_tame_one_does(tmp_path):
    octave = Octave(tmp_path)
    models = [with_prose(t) for t in TEXTS] + [with_name(n) for n in CALLED if ring_takes(n)]
    keys = []
    for i, model in enumerate(models):
        made = written(model, name=f"hostile_{i}")
        octave.write(f"hostile_{i}", made)
        octave.do(f"G = hostile_{i}(); names = fieldnames(G.parameters); text = help('hostile_{i}');")
        keys.append(octave.keep("G.X_over_F(1, names{2}, 3, names{3}, 5)"))
    octave.run()
    assert len(models) > 200
    # 1/(m + b + k)
    assert [octave.value(k)[0] for k in keys] == [0.1] * len(models)
