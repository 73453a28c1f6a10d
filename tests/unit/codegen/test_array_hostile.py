"""No text of a model can become code in modules over libraries of arrays either."""

from __future__ import annotations

import ast
import keyword
from dataclasses import replace
from functools import cache

import pytest

from symflex import pipeline
from symflex.codegen.python.module import ARRAY_API, JAX
from tests.house.repository import slow_ones
from tests.unit.codegen.test_numpy_hostile import HOSTILE, NAMES, cut, model_of, renamed, ring_takes, skeleton

DIALECTS = {"array-api": ARRAY_API, "jax": JAX}
MORE_NAMES = [
    *("xp", "jnp", "jax", "cmath", "math", "sys", "importlib", "Any", "Array", "omega", "limit", "space"),
    *("_shape", "_numbers", "_in_pieces", "isinstance", "list", "tuple", "next", "iter", "max"),
]

ROD = """
symflex = 1
title = "tame"
parameters = { E = "200 GPa", A = "5 cm^2", rho = "7850 kg/m^3", l = "1 m", m = "3 kg" }
[elements]
bar = { type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }
load = { type = "mass", at = "x", m = "m" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def some_each_time(texts):
    """The texts; a few in every run, as the module over numpy takes more of them and names alike."""
    return slow_ones(texts, lambda text: text not in MORE_NAMES and text not in (*HOSTILE, *NAMES)[::8])


def export(model, dialect, tfs=None):
    return DIALECTS[dialect].export(model, tfs or pipeline.derive_all(model), samples=3).text


@cache
def tame_rod(dialect):
    return export(pipeline.loads(ROD), dialect)


def kinds(text):
    return [type(node).__name__ for node in ast.walk(ast.parse(text))]


def executed(text):
    space = {}
    exec(compile(text, "generated.py", "exec"), space)  # noqa: S102
    return space


TAME = {dialect: skeleton(export(model_of(), dialect)) for dialect in DIALECTS}
KINDS = {dialect: kinds(export(model_of(), dialect)) for dialect in DIALECTS}


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("text", some_each_time(HOSTILE), ids=cut)
def test_prose_changes_no_token_of_the_code(text, dialect):
    model = model_of()
    parameters = tuple(replace(p, doc=text, unit=text) for p in model.parameters)
    made = export(replace(model, title=text, source=text, parameters=parameters), dialect)
    assert skeleton(made) == TAME[dialect]
    assert all(line.isprintable() for line in made.split("\n"))


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(
    "name", some_each_time([n for n in (*NAMES, *MORE_NAMES, *HOSTILE) if ring_takes(n)]), ids=cut
)
def test_a_parameter_of_any_name_keeps_the_codes_structure_and_value(name, dialect):
    model = renamed(model_of(), {"b": name if name not in ("s", "pi", "m", "k") else f"{name} "})
    text = export(model, dialect)
    assert kinds(text) == KINDS[dialect]
    if dialect == "array-api":
        space = executed(text)
        assert space["TRANSFER_FUNCTIONS"]["X/F"](1.0, **{list(space["PARAMETERS"])[2]: 5.0}) == 0.1


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("name", some_each_time([*NAMES, *MORE_NAMES, *HOSTILE]), ids=cut)
def test_an_output_of_any_name_gives_a_plain_function_name(name, dialect):
    model = model_of()
    tfs = tuple(replace(tf, output=replace(tf.output, name=name)) for tf in pipeline.derive_all(model)[:1])
    tree = ast.parse(export(model, dialect, tfs))
    functions = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
    assert all(f.isascii() and f.isidentifier() and not keyword.iskeyword(f) for f in functions)
    assert functions[0].endswith("_over_F")


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("name", [*MORE_NAMES, "inverse", "gamma", "e_1", "c_1", "t_1", "held", "z", "place"])
@pytest.mark.slow
def test_a_parameter_of_a_distributed_system_hides_nothing(name, dialect):
    tame, text = tame_rod(dialect), export(renamed(pipeline.loads(ROD), {"rho": name}), dialect)
    assert kinds(text) == kinds(tame)
    if dialect == "array-api":
        points = (0.0, 30j, 4e4j, -20.0)
        expected, found = (executed(t)["X_over_F"] for t in (tame, text))
        assert [found(s) for s in points] == [expected(s) for s in points]


def test_a_function_named_like_a_piece_of_another_keeps_apart():
    model = pipeline.loads(
        ROD.replace('F = { force = "x" }', 'F_0 = { force = "y" }\nF = { force = "x" }')
        .replace("[inputs]", 'other = { type = "mass", at = "y", m = "m" }\n[inputs]')
        .replace('X = "x"', 'X = "x + y"')
    )
    space = executed(export(model, "array-api"))
    assert space["TRANSFER_FUNCTIONS"]["X/F_0"](2.0) == 1 / 12
    static = 1 / (200e9 * 5e-4)
    assert space["TRANSFER_FUNCTIONS"]["X/F"](0.0) == pytest.approx(static, rel=1e-14)
    assert {"X_over_F", "X_over_F_0"} <= set(space)
