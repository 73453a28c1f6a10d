"""No text of a model can become code: prose changes no token, names become plain identifiers."""

from __future__ import annotations

import ast
import builtins
import doctest
import functools
import importlib.util
import keyword
from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.codegen.python.module import NUMPY
from symflex.expressions import Name, substitute
from tests.house.repository import one_in

SPEC = """
symflex = 1
title = "tame"
source = "tame"
parameters.m = { value = "2 kg", doc = "tame" }
parameters.b = { value = "3 N*s/m", doc = "tame" }
parameters.k = { doc = "tame" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "sqrt(k*k)" }
inputs.F = { force = "x" }
outputs = { X = "x", V = "s*x" }
"""

HOSTILE = [
    '"""',
    "'''",
    '"""\nimport os\nos.abort()\n"""',
    'r"""',
    "\\",
    "\\\\",
    '\\"""',
    '\\\\"""',
    "ends with a backslash \\",
    'ends with a quote "',
    "ends with a quote '",
    "\n",
    "\r",
    "\r\nimport os",
    "line\nbreak",
    "\x0bvertical tab",
    "\x0cform feed",
    "\x1cfile separator",
    "\x85next line",
    "\u2028line separator",
    "\u2029paragraph separator",
    "\x00nul",
    "\x07bell",
    "\x08\x08backspace",
    "\x1b[31mred",
    "\x7fdelete",
    "\u202eright to left override",
    "\u2066isolate\u2069",
    "\u200bzero width",
    "\u200djoiner",
    "\ufeffbyte order mark",
    "\ud800lone surrogate",
    "\U000e0001tag",
    "\U0001f600 emoji",
    "\N{CYRILLIC SMALL LETTER A}",
    "\N{FULLWIDTH QUOTATION MARK}" * 3,
    "a\u0301combining",
    "# coding: utf-7",
    "-*- coding: utf-16 -*-",
    "# type: ignore",
    "# noqa",
    "# ruff: noqa",
    ">>> import os; os.abort()",
    "x >>> 1/0",
    ">>> >>> >>>1/0",
    "... 1/0",
    ".. include:: /etc/passwd",
    ".. raw:: html",
    "{0.__class__}",
    "{m}",
    "%s%n",
    "${HOME}",
    "$(reboot)",
    "`reboot`",
    "\\N{DIGIT ONE}",
    "\\x41",
    "\\u0041",
    "\\U0001F600",
    "\\8",
    "\\",
    "__import__('os').abort()",
    "1); import os; os.abort(); (1",
    "1 if 1 else",
    "lambda: 0",
    "*args",
    "a, b=1/0",
    "a: int = 1/0",
    "m=1/0",
    ") -> None: ...",
    "]}",
    "@decorator",
    "Parameters\n----------",
    "Returns",
    " ",
    "\t",
    "x" * 5000,
    "y " * 300,
    "<script>alert(1)</script>",
    "\\begin{document}",
    "=cmd|' /C calc'!A0",
]

NAMES = [
    *keyword.kwlist,
    *keyword.softkwlist,
    "np",
    "s",
    "pi",
    "complex",
    "float",
    "arguments",
    "value",
    "limit",
    "is_far",
    "inverse",
    "num",
    "den",
    "c_1",
    "t_1",
    "sum0",
    "ArrayLike",
    "NDArray",
    "annotations",
    "PARAMETERS",
    "TRANSFER_FUNCTIONS",
    "X_over_F",
    "_X_over_F",
    "_numbers",
    "_in_blocks",
    "__builtins__",
    "__class__",
    "__import__",
    "_",
    "l",
    "O",
    "print",
    "sum",
    "self",
    "m",
    "2m",
    "\u1d50",
    "\N{GREEK SMALL LETTER MU}",
]


def cut(text):
    """Return what a test with this text is called."""
    return ascii(text)[:40]


@functools.cache
def model_of(text=SPEC):
    return pipeline.loads(text)


def export(model, tfs=None):
    return NUMPY.export(model, tfs or pipeline.derive_all(model), samples=5).text


def skeleton(text):
    """Return the tree of a module with all its strings emptied."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


def renamed(model, mapping):
    """Return the model with parameters renamed, as a program that builds models could name them."""
    to = {old: Name(new) for old, new in mapping.items()}
    parameters = tuple(replace(p, name=mapping.get(p.name, p.name)) for p in model.parameters)
    elements = tuple(
        replace(e, values=tuple((n, substitute(x, to)) for n, x in e.values)) for e in model.elements
    )
    return replace(model, parameters=parameters, elements=elements)


@pytest.fixture
def loaded(tmp_path):
    """Import generated text as a module from a file and return what it defines."""

    def load(text):
        path = tmp_path / "generated.py"
        path.write_text(text, encoding="utf-8")
        spec = importlib.util.spec_from_file_location("generated", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return vars(module)

    return load


def ring_takes(name):
    """Tell whether the exact ring can have a generator of this name."""
    return name.isascii() or not name.isidentifier()


TAME = skeleton(export(model_of()))
KINDS = [type(node).__name__ for node in ast.walk(ast.parse(export(model_of())))]


def test_there_are_at_least_sixty_hostile_texts():
    assert len(set(HOSTILE)) >= 60


@functools.cache
def with_prose(text):
    """Return the module of a model all of whose prose is a text."""
    model = model_of()
    parameters = tuple(replace(p, doc=text, unit=text) for p in model.parameters)
    return export(replace(model, title=text, source=text, parameters=parameters))


@pytest.mark.parametrize("text", HOSTILE, ids=cut)
def test_prose_changes_no_token_of_the_code(text):
    assert skeleton(with_prose(text)) == TAME


@pytest.mark.parametrize("text", one_in(3, HOSTILE), ids=cut)
def test_prose_survives_in_the_table_of_parameters(text, loaded):
    assert loaded(with_prose(text))["PARAMETERS"]["m"]["doc"] == text


@pytest.mark.parametrize("text", HOSTILE, ids=cut)
def test_the_text_prints_and_holds_no_doctest(text):
    generated = with_prose(text)
    assert all(line.isprintable() for line in generated.split("\n"))
    generated.encode("utf-8")
    tree = ast.parse(generated)
    documented = [tree, *(n for n in tree.body if isinstance(n, ast.FunctionDef))]
    for node in documented:
        assert doctest.DocTestParser().get_examples(ast.get_docstring(node) or "") == []


@pytest.mark.parametrize("name", one_in(3, [n for n in (*NAMES, *HOSTILE) if ring_takes(n)]), ids=cut)
def test_a_parameter_of_any_name_keeps_the_codes_structure_and_value(name, loaded):
    model = renamed(model_of(), {"b": name if name not in ("s", "pi", "m", "k") else f"{name} "})
    text = export(model)
    assert [type(node).__name__ for node in ast.walk(ast.parse(text))] == KINDS
    space = loaded(text)
    assert space["TRANSFER_FUNCTIONS"]["X/F"](1.0, **{list(space["PARAMETERS"])[2]: 5.0}) == 0.1


@pytest.mark.parametrize("name", one_in(3, [*NAMES, *HOSTILE]), ids=cut)
def test_an_output_of_any_name_gives_a_plain_function_name(name, loaded):
    model = model_of()
    tfs = tuple(replace(tf, output=replace(tf.output, name=name)) for tf in pipeline.derive_all(model)[:1])
    text = export(model, tfs)
    tree = ast.parse(text)
    functions = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
    assert all(f.isascii() and f.isidentifier() and not keyword.iskeyword(f) for f in functions)
    assert functions[0].endswith("_over_F")
    assert loaded(text)["TRANSFER_FUNCTIONS"][f"{name}/F"](1.0, k=5.0) == 0.1


@pytest.mark.parametrize(
    "pair", [("lambda", "lambda_"), ("lambda_", "lambda"), ("a-b", "a_b"), ("a b", "a-b"), ("_y", "y")]
)
def test_two_names_never_become_one(pair, loaded):
    first, second = pair
    text = export(renamed(model_of(), {"m": first, "b": second}))
    space = loaded(text)
    names = list(space["PARAMETERS"])
    assert len(set(names)) == 3
    value = space["X_over_F"](1.0, **dict(zip(names, (2.0, 3.0, 5.0), strict=True)))
    assert value == 0.1


def test_transfer_functions_whose_names_run_together_stay_apart(loaded):
    model = model_of()
    x, v = pipeline.derive_all(model)
    tfs = (
        replace(x, output=replace(x.output, name="a"), input=replace(x.input, name="b_over_c")),
        replace(v, output=replace(v.output, name="a_over_b"), input=replace(v.input, name="c")),
    )
    space = loaded(export(model, tfs))
    functions = space["TRANSFER_FUNCTIONS"]
    assert functions["a/b_over_c"] is not functions["a_over_b/c"]
    assert functions["a/b_over_c"](2.0, k=1.0) == 1 / 15
    assert functions["a_over_b/c"](2.0, k=1.0) == 2 / 15


def test_a_definition_cannot_hide_a_parameter_or_a_name_of_the_code(loaded):
    text = SPEC.replace(
        "elements.body", 'definitions = { num = "m*s^2 + k", value = "2*m", np_ = "b*s" }\nelements.body'
    )
    text = text.replace('V = "s*x"', 'V = "num*x*value*np_"')
    space = loaded(export(model_of(text)))
    s, m, b, k = 0.5j, 2.0, 3.0, 5.0
    expected = (m * s**2 + k) * 2 * m * b * s / (m * s**2 + b * s + k)
    assert space["V_over_F"](s, k=k) == pytest.approx(expected, rel=1e-15)


def test_builtins_are_not_shadowed_where_the_code_uses_them():
    used = {"complex", "float", "zip", "tuple", "any", "all", "TypeError"}
    tree = ast.parse(export(renamed(model_of(), {"b": "zip", "m": "complex"})))
    helpers = [
        n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name in ("_numbers", "_in_blocks")
    ]
    assert len(helpers) == 2
    assert used <= set(dir(builtins))
    for helper in helpers:
        assert not {a.arg for a in helper.args.args} & used
