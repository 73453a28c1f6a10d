"""No text of a model becomes code in any language: names become identifiers, prose stays prose."""

import ast
import builtins
import doctest
import re
from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen import export
from symflex.codegen.c.body import RESERVED as OF_C
from symflex.codegen.c.module import C99
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.javascript import JAVASCRIPT
from symflex.codegen.javascript import RESERVED as OF_JAVASCRIPT
from symflex.codegen.julia import JULIA, module_name
from symflex.codegen.julia import RESERVED as OF_JULIA
from symflex.codegen.matlab import LONGEST, MATLAB, main_name
from symflex.codegen.matlab import RESERVED as OF_MATLAB
from symflex.codegen.module_text import formula_of, identifiers, inert
from symflex.codegen.program.verify import choose_programs
from symflex.codegen.python.dialects import ARRAY_API_DIALECT, JAX_DIALECT, NUMPY_DIALECT
from symflex.codegen.python.module import ARRAY_API, JAX, NUMPY
from symflex.codegen.state_space import state_space_module
from symflex.print import forms
from symflex.state_space import realise
from tests.integration.julia_in_python import functions_of
from tests.integration.octave import Octave
from tests.unit.codegen import hostile_names as hostile
from tests.unit.codegen.exportable import executed
from tests.unit.codegen.hostile_names import benign, mass_on_springs, renamed, with_names, with_prose
from tests.unit.codegen.test_c_files import compiled, value_at

MADE = {}


@pytest.fixture(autouse=True)
def _chosen_once(monkeypatch):
    """Choose the program of a transfer function, and print its formula, once for all its copies."""

    def choose(tf, *_, has_real, most):
        key = id(tf.ratio), has_real
        if key not in MADE:
            MADE[key] = tf, choose_programs(tf, 3, has_real=has_real, most=most)
        return MADE[key][1]

    def formula(tf):
        key = id(tf.ratio), tf.name
        if key not in MADE:
            MADE[key] = tf, formula_of(tf)
        return MADE[key][1]

    monkeypatch.setattr(export, "choose_programs", choose)
    monkeypatch.setattr(export, "formula_of", formula)
    # Names that no specification can have, and a formula is read back by its grammar.
    monkeypatch.setattr(forms, "read_back", lambda *_: 0)


@pytest.fixture
def no_formula(monkeypatch):
    """Leave formulas out, which take longest where there are hundreds of names."""
    monkeypatch.setattr(export, "formula_of", lambda tf: (inert(f"{tf.name} = ..."),))


def c_text(tfs, model):
    files = C99.export(model, tfs, stem="plant", is_alone=False)
    return f"{files.companions['.h']}\n{files.text}"


WRITERS = {
    "numpy": lambda tfs, model: NUMPY.export(model, tfs).text,
    "array-api": lambda tfs, model: ARRAY_API.export(model, tfs).text,
    "jax": lambda tfs, model: JAX.export(model, tfs).text,
    "state-space": lambda tfs, model: state_space_module(realise(model), tfs, samples=3).text,
    "c": c_text,
    "matlab": lambda tfs, model: MATLAB.export(model, tfs, "plant").text,
    "julia": lambda tfs, model: JULIA.export(model, tfs, "plant").text,
    "js": lambda tfs, model: JAVASCRIPT.export(model, tfs, "plant").text,
}
PYTHON = ("numpy", "array-api", "jax", "state-space")
WORDS = dict.fromkeys(PYTHON, hostile.PYTHON) | {
    "c": hostile.C,
    "matlab": hostile.MATLAB,
    "julia": hostile.JULIA,
    "js": hostile.JAVASCRIPT,
}
WRITTEN_ALIKE = {"array-api", "jax", "julia", "state-space"}
"""Targets whose printer is that of another, but for a few lines."""
every_target = pytest.mark.parametrize(
    "target", [pytest.param(t, marks=[pytest.mark.slow] if t in WRITTEN_ALIKE else []) for t in WRITERS]
)


@cache
def springs(names):
    model = mass_on_springs(names)
    return model, pipeline.derive_all(model)


# ---------------------------------------------------------------------------------------- structure of code


C_TOKEN = re.compile(r"[A-Za-z_]\w*|\.?\d[\w.]*(?:e[+-]\d+)?|\"[^\"\n]*\"|#\w+|[^\w\s]")
STRING = {
    "matlab": re.compile(r"(?<=[;,({\s=])'(?:[^'\n]|'')*'"),
    "js": re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"', re.DOTALL),
    "julia": re.compile(r'"""(?:[^"\\]|\\.|"(?!""))*"""|"(?:[^"\\\n]|\\.)*"'),
}
KEYWORDS = {
    "c": set("if else for return static inline const double struct void switch case default break".split()),
    "matlab": set("function end if else for return while".split()),
    "julia": set("function end if else for return while const module import export begin let".split()),
    "js": set("function if else for return while const let export throw new of null".split()),
}


def c_tokens(text):
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
        elif match := C_TOKEN.match(text, at):
            found.append(match.group())
            at = match.end()
        else:
            assert text[at].isspace(), text[at]
            at += 1
    return found


def code(target, text):
    """Return what is obeyed: statements without comments, with all strings empty."""
    if target in PYTHON:
        tree = ast.parse(text)
        for node in ast.walk(tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                node.value = ""
        return ast.dump(tree)
    if target == "c":
        return c_tokens(text)
    if target == "matlab":  # a comment takes its whole line, no string goes over a line
        text = "\n".join(line for line in text.split("\n") if not line.startswith("%"))
    return STRING[target].sub("''", text)


def structure(target, text):
    """Return the same with one word for every name, as tokens; what is looked up and numbers stay."""
    if target in PYTHON:
        found = []
        for node in ast.walk(ast.parse(text)):
            own = node.attr if isinstance(node, ast.Attribute) else None
            if isinstance(node, ast.Constant) and not isinstance(node.value, str):
                own = node.value
            found.append((type(node).__name__, own))
        return found
    kept = code(target, text)
    if target != "c":
        kept = re.findall(
            r"[A-Za-z_]\w*|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[^\w\s]", kept.replace("...\n", " ")
        )
    return ["x" if re.match(r"[A-Za-z_\"]", t) and t not in KEYWORDS[target] else t for t in kept]


# -------------------------------------------------------------------------------------------------- names


def test_every_name_becomes_an_identifier_of_its_own_in_each_language():
    languages = {
        "numpy": (NUMPY_DIALECT.reserved, None, hostile.PYTHON[:30]),
        "array-api": (ARRAY_API_DIALECT.reserved, None, ["xp", "math", "lambda"]),
        "jax": (JAX_DIALECT.reserved, None, ["jnp", "jax", "lambda"]),
        "c": (OF_C, None, ["int", "complex", "I", "NAN", "virtual", "typename"]),
        "matlab": (OF_MATLAB, LONGEST, ["end", "parfor", "pi", "i", "exp", "nargin", "default_parameters"]),
        "julia": (OF_JULIA, None, ["end", "im", "pi", "baremodule", "Base"]),
        "js": (OF_JAVASCRIPT, None, ["await", "Math", "yield", "imaginary", "Float64Array"]),
    }
    names = dict.fromkeys([*hostile.NAMES, *hostile.TEXTS])
    for language, (reserved, longest, words) in languages.items():
        found = identifiers({n: n for n in names}, reserved, longest)
        assert len(set(found.values())) == len(names), language
        for name, made in found.items():
            assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", made), (language, name)
            assert made not in reserved, (language, name)
            assert len(made) <= (longest or len(made)), (language, name)
            kept = re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) and name not in reserved
            assert made == name or not kept or len(name) > (longest or len(name)), (language, name)
        assert not {*words} & {*found.values()}, language


@every_target
@pytest.mark.usefixtures("no_formula")
def test_parameters_of_any_names_leave_the_structure_of_the_code_as_it_is(target):
    names = tuple(dict.fromkeys([*WORDS[target], *hostile.ODD, *hostile.TEX]))
    hostile_text, plain = (
        WRITERS[target](tfs, model) for model, tfs in map(springs, (names, tuple(benign(len(names)))))
    )
    assert structure(target, hostile_text) == structure(target, plain)
    assert all(line.isprintable() for line in hostile_text.split("\n"))


FUNCTIONS = {
    "c": r"^(?:static )?(?:inline )?(?:double complex|void|double|cx) (\w+)\([^;]*?\)\s*\{",
    "matlab": r"^function (?:\S+|\[.*?\]) = (?:\.\.\.\n\s*)?(\w+)\(",
    "julia": r"^function (\w+)\(",
    "js": r"^(?:export const|function) (\w+)(?: = offered)?\(",
}


def functions_in(target, text):
    if target in PYTHON:
        return [n.name for n in ast.parse(text).body if isinstance(n, ast.FunctionDef)]
    return re.findall(FUNCTIONS[target], text, re.MULTILINE)


@pytest.mark.parametrize("target", [t for t in WRITERS if t != "state-space"])
@pytest.mark.usefixtures("no_formula")
def test_outputs_and_inputs_of_any_names_have_functions_of_their_own_and_change_nothing_else(target):
    model, (tf,) = springs(("k_1",))
    names = [*hostile.ODD, *hostile.TEXTS[::10], *WORDS[target][::20]]
    copies = [with_names(tf, given, given[::-1]) for given in (names, benign(len(names)))]
    text, plain = (WRITERS[target](given, model) for given in copies)
    # Wide and narrow names wrap differently: an expression in parentheses is none without.
    assert Counter(structure(target, text)) == Counter(structure(target, plain))
    functions = functions_in(target, text)
    assert len(functions) == len(set(functions)) >= 2 * len(names)
    assert all(re.fullmatch(r"_?[A-Za-z][A-Za-z0-9_]*", name) for name in functions)


def test_files_of_any_names_have_main_functions_modules_and_public_names_of_their_own():
    model, tfs = springs(("k_1",))
    for name in ("value_of", "piece_0_of", "cx", "int", "_x", "2dof", "a.b-c+d", "I"):
        files = C99.export(model, tfs, stem=name, is_alone=False)
        functions = re.findall(r"^[a-z][\w ]* (\w+)\([^;{]*\)[^;{]*\n\{", files.text, re.MULTILINE)
        assert len(functions) == len(set(functions)), name
        assert all(re.fullmatch(r"[A-Za-z]\w*", f) and f not in OF_C for f in functions), name
        assert f'#include "{name}.h"' in files.text
    for name in (*hostile.NAMES, *hostile.TEXTS):
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,62}", main_name(name)), name
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", module_name(name)), name
        assert not {main_name(name)} & {*OF_MATLAB} and not {module_name(name)} & {*OF_JULIA}, name


# -------------------------------------------------------------------------------------------------- prose


@every_target
def test_prose_changes_no_token_and_says_what_it_said(target):
    texts = hostile.TEXTS
    names = tuple(benign(len(texts)))
    model, tfs = springs(names)
    tame = with_prose(model, "tame")
    mixed = [*("tame",) * (len(model.parameters) - len(texts)), *texts]
    text = WRITERS[target](of_model(tfs, prose := with_prose(model, texts[2], mixed)), prose)
    assert code(target, text) == code(target, WRITERS[target](of_model(tfs, tame), tame))
    assert_inert(target, text)
    if target in PYTHON:
        documented = [p["doc"] for p in executed(text)["PARAMETERS"].values()]
        assert documented[-len(texts) :] == [*texts]


@every_target
def test_titles_and_sources_change_no_token(target):
    model, tfs = springs(("k_1",))
    expected = code(target, WRITERS[target](of_model(tfs, tame := with_prose(model, "tame")), tame))
    own = {"c": hostile.IN_COMMENTS, "matlab": hostile.IN_MATLAB, "julia": hostile.IN_JULIA}
    for text in (*own.get(target, ()), *hostile.HOSTILE[[*WRITERS].index(target) :: len(WRITERS)]):
        made = WRITERS[target](of_model(tfs, prose := with_prose(model, text)), prose)
        assert code(target, made) == expected, text
        assert_inert(target, made)


def of_model(tfs, model):
    """Return functions as they would be derived from a model with other prose."""
    return [replace(tf, model=model) for tf in tfs]


def assert_inert(target, text):
    """Assert that a file prints, and that nothing in its prose is obeyed by what reads help texts."""
    assert all(line.isprintable() for line in text.split("\n"))
    text.encode("utf-8")
    if target in PYTHON:
        tree = ast.parse(text)
        for node in [tree, *(n for n in tree.body if isinstance(n, ast.FunctionDef))]:
            assert doctest.DocTestParser().get_examples(ast.get_docstring(node) or "") == []
    elif target == "matlab":
        comments = [line for line in text.split("\n") if line.startswith("%")]
        link = re.compile(r"<(?!U\+)[a-zA-Z/]")
        assert not [c for c in comments if re.match(r"%[{}!#]", c) or "-*-" in c or link.search(c)]
    elif target == "js":
        assert not re.search(r"<[/!A-Za-z]", text)
    elif target == "julia":
        strings = STRING["julia"].findall(text)
        assert not [s for s in strings if re.search(r"(?<!\\)(?:\\\\)*\$", s)]
        assert not [s for s in strings if s.startswith('"""') and ("`" in s or "~~~" in s)]


@pytest.mark.needs_tool("gcc")
@pytest.mark.slow
def test_a_compiler_of_c_takes_any_prose_and_any_members_without_a_warning(tmp_path):
    model, tfs = springs(tuple(dict.fromkeys([*hostile.C, *hostile.ODD])))
    texts = [hostile.TEXTS[i % len(hostile.TEXTS)] for i in range(len(model.parameters))]
    prose = with_prose(model, "*/ int main(void) { abort(); } /* ??/", texts)
    files = C99.export(prose, of_model(tfs, prose), stem="plant", is_alone=False)
    library, _ = compiled(tmp_path, files)
    total = len(texts) - 2
    expected = 1 / (2 * S**2 + 3 * S + total * (total + 1) / 2)
    assert value_at(library, 0, S) == pytest.approx(expected, rel=1e-12)


# ----------------------------------------------------------------- what code computes, whatever the names

S = np.array([0.3j, 20j, 4e3j, -5.0 + 3j])


def values_in(target, folder, tfs, model):
    """Return the values at S of all functions of a file that a target's own program runs."""
    if target == "c":
        library, names = compiled(folder, C99.export(model, tfs, stem="plant", is_alone=False))
        return [value_at(library, number, S) for number in range(len(names))]
    text = WRITERS[target](tfs, model)
    if target == "matlab":
        octave = Octave(folder)
        octave.write("plant", text)
        octave.do(f"G = plant(); s = {octave.points(S)};")
        fields = re.findall(r"^  G\.transfer_functions\(\d+, :\) = \{.*, '(\w+)'\};", text, re.MULTILINE)
        keys = [octave.keep(f"G.{field}(s)") for field in fields]
        octave.run()
        return [octave.value(key) for key in keys]
    if target == "julia":
        functions = {n: f for n, f in functions_of(text).items() if n.startswith("_value_of_")}
        given = [float(p.value.rational) for p in model.parameters]
        return [np.array([f(complex(s), *given) for s in S]) for f in functions.values()]
    space = executed(text)
    if target == "state-space":
        a, b, c, d = space["state_space"]()
        return list(np.array([c @ np.linalg.solve(z * np.eye(len(a)) - a, b) + d for z in S])[:, :, 0].T)
    assert list(space["TRANSFER_FUNCTIONS"]) == [tf.name for tf in tfs]
    return [np.asarray(function(S)) for function in space["TRANSFER_FUNCTIONS"].values()]


RUN = [
    "numpy",
    "array-api",
    pytest.param("jax", marks=[pytest.mark.needs_module("jax"), pytest.mark.slow]),
    pytest.param("c", marks=pytest.mark.needs_tool("gcc")),
    pytest.param("matlab", marks=pytest.mark.needs_tool("octave")),
]

DEFINITIONS = """[definitions]
num = "m0*s + b0"
value = "2*m0"
exp = "b0*s"
cx_mul = "3*m0"
omega = "b0"
[elements]"""
DEFINED = hostile.SPRINGS.replace("[elements]", DEFINITIONS).replace(
    'y_out = "node_q"', 'y_out = "node_q"\nV = "value*exp*cx_mul*omega*node_q/num"'
)


@cache
def chosen():
    model = mass_on_springs(hostile.CHOSEN, DEFINED)
    y, v = pipeline.derive_all(model)
    outputs, inputs = ("class", "", "2m", "im", "a-b"), ("F", "\n*/", "F", "end", "'")
    return model, (*with_names(y, outputs, inputs), v)


@pytest.mark.parametrize("target", [*RUN, "state-space", "julia"])
def test_ten_names_of_parameters_some_of_ends_and_of_definitions_keep_their_values(target, tmp_path, wide):
    model, tfs = chosen()
    if target == "state-space":
        tfs = pipeline.derive_all(model)
    *found, v = values_in(target, tmp_path, tfs, model)
    y = 1 / (2 * S**2 + 3 * S + 55)
    assert found == [pytest.approx(y, rel=1e-12)] * (len(tfs) - 1)
    assert v == pytest.approx(4 * 3 * S * 6 * 3 * y / (2 * S + 3), rel=1e-12)


@pytest.mark.parametrize("target", ["numpy", "array-api"])
def test_parameters_given_by_their_names_take_the_place_of_defaults(target):
    model, (tf, *_) = chosen()
    space = executed(WRITERS[target]([tf], model))
    (function,) = space["TRANSFER_FUNCTIONS"].values()
    names = [*space["PARAMETERS"]][2:]
    changed = function(S, **{name: 2.0 * (i + 1) for i, name in enumerate(names)})
    assert np.asarray(changed) == pytest.approx(1 / (2 * S**2 + 3 * S + 110), rel=1e-12)


@pytest.fixture
def wide(request):
    """Let jax compute in double precision."""
    if request.node.callspec.params["target"] == "jax":
        import jax

        jax.config.update("jax_enable_x64", True)


# ------------------------------------------------------------------------- private functions and public ones

ROD = """
symflex = 1
parameters = { E = "200 GPa", A = "5 cm^2", rho = "7850 kg/m^3", l = "1 m", m = "3 kg", k = "50 N/m" }
[elements]
bar = { type = "rod", between = ["ground", "x"], E = "E", A = "A", rho = "rho", l = "l" }
load = { type = "mass", at = "x", m = "m" }
other = { type = "mass", at = "y", m = "m" }
spring = { type = "spring", between = ["y", "ground"], k = "k" }
[inputs]
F = { force = "x" }
F_0 = { force = "y" }
[outputs]
X = "x"
Y = "y"
"""
SUFFIXES = """
0 1 2 0_parts 1_parts tests pieces limits sizes at at_0 at_tests value at_value freq freq_freq
parts_0 piece_0 F_0
""".split()
PREFIXES = """
value_of piece_0_of piece_1_of tests_of pieces_of limits_of sizes_of parts_0_of parts_of_piece_0_of
""".split()


@cache
def of_a_rod():
    """Return a rod's function, and a mass's under every name that a part of the rod's could have."""
    model = pipeline.loads(ROD)
    found = {tf.name: tf for tf in pipeline.derive_all(model)}
    rod, mass = found["X/F"], found["Y/F_0"]
    outputs = ["X"] * len(SUFFIXES) + [f"{p}_X" for p in PREFIXES] + ["A", "A_over_F", "X_over_F"]
    inputs = [f"F_{suffix}" for suffix in SUFFIXES] + ["F"] * len(PREFIXES) + ["F_over_F", "F", "F"]
    masses = with_names(mass, outputs, inputs)
    assert len({tf.name for tf in (rod, *masses)}) == len(masses) + 1
    return model, (rod, *masses)


@pytest.mark.parametrize("target", [*RUN[:2], *RUN[3:]])
@pytest.mark.slow
def test_a_function_named_like_a_part_of_another_is_not_taken_for_it(target, tmp_path):
    model, tfs = of_a_rod()
    # Rao 2007, chapter 9: 1/(E A g coth(g l) + m s^2) with g = s sqrt(rho/E); a mass on a spring.
    g = S * np.sqrt(7850 / 200e9)
    rod = 1 / (200e9 * 5e-4 * g / np.tanh(g) + 3 * S**2)
    found = values_in(target, tmp_path, tfs, model)
    assert found[0] == pytest.approx(rod, rel=1e-12)
    assert found[1:] == [pytest.approx(1 / (3 * S**2 + 50), rel=1e-12)] * (len(tfs) - 1)


def test_no_two_functions_of_a_file_meet():
    model, tfs = of_a_rod()
    names = functions_in("julia", WRITERS["julia"](tfs, model))
    assert len(names) == len(set(names)) >= 2 * len(tfs)


@cache
def rod_with(words):
    """Return the rod with other names of its parameters."""
    model = renamed(pipeline.loads(ROD), dict(zip("E A rho l m".split(), words.split(), strict=True)))
    return model, pipeline.derive_all(model, [("X", "F")])


@pytest.mark.parametrize("target", [t for t in WRITERS if t != "state-space"])
def test_parameters_hide_nothing_that_the_code_of_waves_computes_with(target):
    for words in ("inverse gamma e_1 c_1 t_1", "held z place xp cx"):
        texts = [
            WRITERS[target](tfs, model) for model, tfs in map(rod_with, (words, "E_0 A_0 rho_0 l_0 m_0"))
        ]
        # Parentheses are those around what is wrapped.
        found, plain = ([t for t in structure(target, text) if t not in ("(", ")")] for text in texts)
        assert found == plain, words
        if target in ("numpy", "array-api"):
            found, expected = (executed(text)["X_over_F"] for text in texts)
            assert [found(s) for s in (0.0, 30j, 4e4j)] == [expected(s) for s in (0.0, 30j, 4e4j)], words


def test_builtins_are_not_shadowed_where_the_code_uses_them():
    used = {"complex", "float", "zip", "tuple", "any", "all", "TypeError"}
    model, tfs = springs(("zip", "complex"))
    tree = ast.parse(WRITERS["numpy"](tfs, model))
    helpers = [
        n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name in ("_numbers", "_in_blocks")
    ]
    assert len(helpers) == 2
    assert used <= set(dir(builtins))
    for helper in helpers:
        assert not {a.arg for a in helper.args.args} & used


# ---------------------------------------------------------------------------- states, and documents of LaTeX


@pytest.mark.slow
def test_names_and_units_of_states_and_their_ends_are_only_strings():
    model, _ = springs(("k_1",))
    system = realise(model)
    for text in (*hostile.TEXTS, *hostile.ODD):
        ends = {
            kind: tuple(replace(x, name=text, unit=text) for x in getattr(system, kind))
            for kind in ("states", "inputs", "outputs")
        }
        made = state_space_module(replace(system, **ends), ()).text
        assert all(line.isprintable() for line in made.split("\n")), text
        space = executed(made)
        assert space["INPUTS"] == space["OUTPUTS"] == ({"name": text, "unit": text},)
        assert space["state_space"]()[0].tolist() == [[0, 1], [-0.5, -1.5]], text


@pytest.mark.slow
def test_documents_have_the_same_environments_and_balanced_braces_whatever_names_are():
    names = [*dict.fromkeys([*hostile.TEX, *hostile.ODD, *hostile.NAMES[::20]])]
    parts, texts = [], []
    for given in (names, benign(len(names))):
        model = mass_on_springs(given)
        texts.append(EXPORTERS["latex"].export(model, pipeline.derive_all(model)).text)
        pattern = r"\\(?:begin|end|section|documentclass|usepackage)\b\*?\{[^{}]*\}"
        parts.append(re.findall(pattern, texts[-1]))
    assert parts[0] == parts[1]
    bare = re.sub(r"\\[\\{}%&#$_]", "", texts[0])
    assert bare.count("{") == bare.count("}")
    assert not re.search(r"\\(?:input|def|write|read|catcode|csname)\b", bare.split(r"\begin{document}")[1])
    assert texts[0].isascii()
