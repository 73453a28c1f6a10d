"""Over five hundred names at once, in code of every target: apart, the code the same, the values right."""

from __future__ import annotations

import ast
import ctypes
import keyword
import re
import subprocess
from collections import Counter
from functools import cache

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen import export
from symflex.codegen.c.module import C99
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.julia import JULIA
from symflex.codegen.matlab import MATLAB
from symflex.codegen.program.verify import choose_programs
from symflex.codegen.python.module import ARRAY_API, JAX, NUMPY
from symflex.codegen.state_space import state_space_module
from tests.house.repository import slow_ones
from tests.unit.codegen.hostile_names import NAMES, PARAMETERS, C, benign, mass_on_springs, with_names

COUNT = len(NAMES)
TOTAL = COUNT * (COUNT + 1) // 2
"""N/m: the stiffness of all springs."""


@pytest.fixture(autouse=True)
def _chosen_once(monkeypatch):
    """Choose the program of a transfer function once for all its copies: names have no part in it."""
    found = {}

    def choose(tf, *_):
        return found.setdefault(id(tf.ratio), (tf, choose_programs(tf, None, 3)))[1]

    monkeypatch.setattr(export, "choose_programs", choose)


def c_text(tfs, model):
    files = C99.export(model, tfs, stem="plant", is_alone=False)
    return f"{files.companions['.h']}\n{files.text}"


WRITERS = {
    "numpy": lambda tfs, model: NUMPY.export(model, tfs).text,
    "array-api": lambda tfs, model: ARRAY_API.export(model, tfs).text,
    "jax": lambda tfs, model: JAX.export(model, tfs).text,
    "c": c_text,
    "matlab": lambda tfs, model: MATLAB.export(model, tfs, "plant").text,
    "julia": lambda tfs, model: JULIA.export(model, tfs, "plant").text,
    "state-space": lambda tfs, model: state_space_module(pipeline.state_space(model), tfs, samples=3).text,
}
EACH_TIME = ("numpy", "c", "matlab")
"""Their structure is compared in every run; that of the others, written alike, with -m slow."""
PYTHON = ("numpy", "array-api", "jax", "state-space")


@cache
def springs(names):
    model = mass_on_springs(names)
    return model, pipeline.derive_all(model)


@cache
def with_parameters(target, names):
    model, tfs = springs(names)
    return WRITERS[target](tfs, model)


# ---------------------------------------------------------------------------------------- structure of code


def python_structure(text):
    """Return every node of the tree without names and texts; what is looked up and numbers stay."""
    found = []
    for node in ast.walk(ast.parse(text)):
        own = getattr(node, "attr", None) if isinstance(node, ast.Attribute) else None
        if isinstance(node, ast.Constant) and not isinstance(node.value, str):
            own = node.value
        found.append((type(node).__name__, own))
    return found


KEYWORDS = {
    "c": set(
        "if else for return static inline const double struct void switch case default break while".split()
    ),
    "matlab": set("function end if else for return while".split()),
    "julia": set("function end if else for return while const module import export begin let".split()),
}
NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
COMMENTS = {
    "c": r"/\*.*?\*/",
    "matlab": r"^\s*%[^\n]*|\.\.\.\n|(?<=[;,({\s=])'(?:[^'\n]|'')*'",
    "julia": r'"""(?:[^"\\]|\\.|"(?!""))*"""|"(?:[^"\\\n]|\\.)*"|#[^\n]*',
}


def token_structure(text, language):
    """Return tokens without prose, every name and every string the same."""
    kept = re.sub(COMMENTS[language], " ", text, flags=re.DOTALL | re.MULTILINE)
    kept = re.sub(r'"[^"\n]*"', " ", kept)
    tokens = re.findall(rf"[A-Za-z_]\w*|{NUMBER}|[^\w\s]", kept)
    own = KEYWORDS[language]
    return ["x" if re.match(r"[A-Za-z_]", t) and t not in own else t for t in tokens]


def structure(target, text):
    return python_structure(text) if target in PYTHON else token_structure(text, target)


@pytest.mark.parametrize("target", slow_ones(WRITERS, lambda target: target not in EACH_TIME))
@pytest.mark.slow
def test_parameters_of_any_names_leave_the_structure_of_the_code_as_it_is(target):
    hostile, plain = (with_parameters(target, names) for names in (PARAMETERS, tuple(benign(COUNT))))
    assert COUNT >= 300
    assert structure(target, hostile) == structure(target, plain)
    assert hostile.isprintable() or all(line.isprintable() for line in hostile.split("\n"))


@pytest.mark.slow
@pytest.mark.parametrize("target", [t for t in WRITERS if t != "state-space"])
def test_outputs_and_inputs_of_any_names_leave_the_structure_of_the_code_as_it_is(target):
    model, (tf,) = springs(("k_1",))
    copies = [with_names(tf, names, names[::-1]) for names in (NAMES, benign(COUNT))]
    # Wide and narrow names wrap differently: an expression in parentheses is none without.
    hostile, plain = (WRITERS[target](given, model) for given in copies)
    if target in PYTHON:
        assert python_structure(hostile) == python_structure(plain)
    else:
        assert Counter(token_structure(hostile, target)) == Counter(token_structure(plain, target))


# --------------------------------------------------------------------------------------------- all apart


def defined(text):
    return [n.name for n in ast.parse(text).body if isinstance(n, ast.FunctionDef)]


@pytest.mark.slow
@pytest.mark.parametrize("target", ["numpy", "array-api", "jax"])
def test_every_function_of_a_python_module_has_a_name_of_its_own(target):
    model, (tf,) = springs(("k_1",))
    tfs = with_names(tf, NAMES, NAMES[::-1])
    names = defined(WRITERS[target](tfs, model))
    assert len(names) == len(set(names)) > 2 * len({t.name for t in tfs}) - 1
    assert not any(keyword.iskeyword(name) or not name.isidentifier() for name in names)


def function_names(target, text):
    if target == "c":
        return re.findall(
            r"^(?:static )?(?:inline )?(?:double complex|void|double|cx) (\w+)\([^;]*?\)\s*\{",
            text,
            re.MULTILINE,
        )
    pattern = {
        "matlab": r"^function (?:\S+|\[.*?\]) = (?:\.\.\.\n\s*)?(\w+)\(",
        "julia": r"^function (\w+)\(",
    }[target]
    return re.findall(pattern, text, re.MULTILINE)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["c", "matlab", "julia"])
def test_every_function_of_other_languages_has_a_name_of_its_own(target):
    model, (tf,) = springs(("k_1",))
    tfs = with_names(tf, NAMES, NAMES[::-1])
    names = function_names(target, WRITERS[target](tfs, model))
    assert len(names) == len(set(names)) >= 2 * len({t.name for t in tfs})


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


S = np.array([0.3j, 20j, 4e3j, -5.0 + 3j])


def expected_of_a_rod():
    # Rao 2007, chapter 9: 1/(E A g coth(g l) + m s^2) with g = s sqrt(rho/E); a mass on a spring.
    g = S * np.sqrt(7850 / 200e9)
    rod = 1 / (200e9 * 5e-4 * g / np.tanh(g) + 3 * S**2)
    return [rod] + [1 / (3 * S**2 + 50)] * (len(of_a_rod()[1]) - 1)


def in_python(text):
    space = {}
    exec(compile(text, "generated.py", "exec"), space)  # noqa: S102
    return space


@pytest.mark.parametrize(
    "target", ["numpy", "array-api", pytest.param("jax", marks=pytest.mark.needs_module("jax"))]
)
def test_a_function_named_like_a_part_of_another_is_not_taken_for_it(target):
    if target == "jax":
        import jax

        jax.config.update("jax_enable_x64", True)
    model, tfs = of_a_rod()
    text = WRITERS[target](tfs, model)
    names = defined(text)
    assert len(names) == len(set(names))
    functions = in_python(text)["TRANSFER_FUNCTIONS"]
    assert list(functions) == [tf.name for tf in tfs]
    for tf, expected in zip(tfs, expected_of_a_rod(), strict=True):
        assert np.asarray(functions[tf.name](S)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("target", ["c", "matlab", "julia"])
def test_no_two_functions_of_other_languages_meet(target):
    model, tfs = of_a_rod()
    names = function_names(target, WRITERS[target](tfs, model))
    assert len(names) == len(set(names)) >= 2 * len(tfs)


CALLS = """
void run_{i}(const double *s, double *value, int n)
{{
    for (int k = 0; k < n; k++) {{
        const double complex z = {name}(s[2 * k] + s[2 * k + 1] * I, &plant_defaults);
        value[2 * k] = creal(z);
        value[2 * k + 1] = cimag(z);
    }}
}}
"""
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]


def in_c(folder, tfs, model):
    """Compile and run a file, and return the values of its functions in order."""
    files = C99.export(model, tfs, stem="plant", is_alone=False)
    names = re.findall(r"^double complex (\w+)\(", files.companions[".h"], re.MULTILINE)
    calls = "".join(CALLS.format(i=i, name=name) for i, name in enumerate(names))
    (folder / "plant.h").write_text(files.companions[".h"], encoding="utf-8")
    (folder / "plant.c").write_text(files.text, encoding="utf-8")
    (folder / "run.c").write_text(f'#include "plant.h"\n{calls}', encoding="utf-8")
    command = ["gcc", *STRICT, "-shared", "-fPIC", "-o", "plant.so", "plant.c", "run.c", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    library = ctypes.CDLL(str(folder / "plant.so"))
    found = []
    for i in range(len(names)):
        value = np.empty_like(S)
        given = [a.view(float).ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in (S, value)]
        getattr(library, f"run_{i}")(*given, len(S))
        found.append(value)
    return found


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_c_tells_functions_named_like_parts_of_others_apart(tmp_path):
    model, tfs = of_a_rod()
    for value, expected in zip(in_c(tmp_path, tfs, model), expected_of_a_rod(), strict=True):
        assert value == pytest.approx(expected, rel=1e-12)


def fields_of(text):
    return re.findall(r"^  G\.transfer_functions\(\d+, :\) = \{.*, '(\w+)'\};", text, re.MULTILINE)


def in_octave(folder, tfs, model):
    text = WRITERS["matlab"](tfs, model)
    fields = fields_of(text)
    (folder / "plant.m").write_text(text, encoding="utf-8")
    points = ", ".join(f"complex({z.real!r}, {z.imag!r})" for z in S.tolist())
    lines = [f"G = plant(); s = [{points}];"]
    lines += [f"v = G.{field}(s); printf('%.17g ', [real(v); imag(v)]); printf('\\n');" for field in fields]
    return [np.array(row.split(), dtype=float).view(complex) for row in run_octave(folder, lines)]


def run_octave(folder, lines):
    (folder / "run.m").write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = ["octave", "--no-gui", "--quiet", "--norc", "run.m"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    return done.stdout.strip().split("\n")


@pytest.mark.needs_tool("octave")
def test_octave_tells_functions_named_like_parts_of_others_apart(tmp_path):
    model, tfs = of_a_rod()
    found = in_octave(tmp_path, tfs, model)
    for value, expected in zip(found, expected_of_a_rod(), strict=True):
        assert value == pytest.approx(expected, rel=1e-12)


# ------------------------------------------------------------------------------- values, whatever the names


def expected_of_springs():
    return 1 / (2 * S**2 + 3 * S + TOTAL)


@pytest.mark.slow
@pytest.mark.parametrize(
    "target", ["numpy", "array-api", pytest.param("jax", marks=pytest.mark.needs_module("jax"))]
)
def test_parameters_of_any_names_keep_their_values(target):
    if target == "jax":
        import jax

        jax.config.update("jax_enable_x64", True)
    space = in_python(with_parameters(target, PARAMETERS))
    (function,) = space["TRANSFER_FUNCTIONS"].values()
    assert np.asarray(function(S)) == pytest.approx(expected_of_springs(), rel=1e-12)
    names = [*space["PARAMETERS"]][2:]
    changed = function(S, **{name: 2.0 * (i + 1) for i, name in enumerate(names)})
    assert len(names) == len(set(names)) == COUNT
    assert np.asarray(changed) == pytest.approx(1 / (2 * S**2 + 3 * S + 2 * TOTAL), rel=1e-12)


@pytest.mark.slow
def test_state_equations_with_parameters_of_any_names_keep_their_values():
    space = in_python(with_parameters("state-space", PARAMETERS))
    a, b, c, d = space["state_space"]()
    found = [(c @ np.linalg.solve(z * np.eye(len(a)) - a, b) + d)[0, 0] for z in S]
    assert found == pytest.approx(expected_of_springs(), rel=1e-12)


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_c_takes_members_of_any_names(tmp_path):
    model, tfs = springs(PARAMETERS)
    (value,) = in_c(tmp_path, tfs, model)
    assert value == pytest.approx(expected_of_springs(), rel=1e-12)


@pytest.mark.needs_tool("gcc")
@pytest.mark.slow
def test_c_takes_outputs_and_inputs_of_any_names(tmp_path):
    model, (tf,) = springs(("k_1",))
    tfs = with_names(tf, C, C[::-1])
    expected = 1 / (2 * S**2 + 3 * S + 1)
    assert np.array(in_c(tmp_path, tfs, model)) == pytest.approx(np.tile(expected, (len(C), 1)), rel=1e-12)


@pytest.mark.slow
@pytest.mark.needs_tool("octave")
def test_octave_takes_parameters_outputs_and_inputs_of_any_names(tmp_path):
    model, tfs = springs(PARAMETERS)
    (value,) = in_octave(tmp_path, tfs, model)
    assert value == pytest.approx(expected_of_springs(), rel=1e-12)
    model, (tf,) = springs(("k_1",))
    found = in_octave(tmp_path, with_names(tf, NAMES, NAMES[::-1]), model)
    assert len(found) == COUNT
    assert np.array(found) == pytest.approx(np.tile(1 / (2 * S**2 + 3 * S + 1), (COUNT, 1)), rel=1e-12)


# ------------------------------------------------------------------------------------------------- LaTeX


def latex(names):
    model = mass_on_springs(names)
    return EXPORTERS["latex"].export(model, pipeline.derive_all(model)).text


@pytest.mark.parametrize("start", range(0, COUNT, 90))
def test_documents_have_the_same_environments_and_balanced_braces_whatever_names_are(start):
    names = PARAMETERS[start : start + 90]
    found, plain = latex(names), latex(benign(len(names)))
    parts = [
        re.findall(r"\\(?:begin|end|section|documentclass|usepackage)\b\*?\{[^{}]*\}", t)
        for t in (found, plain)
    ]
    assert parts[0] == parts[1]
    bare = re.sub(r"\\[\\{}%&#$_]", "", found)
    assert bare.count("{") == bare.count("}")
    assert not re.search(r"\\(?:input|def|write|read|catcode|csname)\b", bare.split(r"\begin{document}")[1])
    assert found.isascii()
