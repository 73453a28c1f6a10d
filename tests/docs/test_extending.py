"""The diffs of docs/extending.md apply to this version, and what they add works."""

import cmath
import json
import re
import runpy
import shutil
import subprocess
import sys

import pytest

from tests.house.repository import ROOT, blocks
from tests.independent.spec_expressions import evaluate

DIFFS = [block for block in blocks(ROOT / "docs" / "extending.md") if block.language == "diff"]
MODEL = """
symflex = 1
parameters = { m = "2 kg", B = "1 kg", k = "12 N/m", T = "0.5 s" }
inputs     = { F = { force = "x" } }
outputs    = { X = "x", Y = "P*x" }
blocks     = { P = { type = "wash_out", T = "T" } }

[elements]
body   = { type = "mass",    at = "x", m = "m" }
side   = { type = "inerter", between = ["x", "ground"], B = "B" }
spring = { type = "spring",  between = ["x", "ground"], k = "k" }
"""
ROD = """
symflex = 1
parameters = { E = "4 Pa", A = "0.5 m^2", rho = "2 kg/m^3", nu = "0.25", I_p = "3 m^4", l = "1.5 m" }
inputs     = { F = { force = "q" } }
outputs    = { X = "q" }

[elements]
rod = { type = "love_rod", between = ["ground", "q"], E = "E", A = "A", rho = "rho", nu = "nu", I_p = "I_p",\
    l = "l" }
"""
ROOTS = """
from symflex.roots import RootProblem, find_polynomial_roots
from symflex.roots.engines import GUESSES
found = find_polynomial_roots(RootProblem.from_rationals([25, 6, 1]), 10, [GUESSES["eigenvalues"].propose])
print([(root.decimal(3).re, root.decimal(3).im, root.certified) for root in found])
"""
CONTROLLER = """
symflex = 1
title      = "(* not the end *) x := 1;"
parameters = { k_p = "40", T_d = "0.1 s", T_f = "20 ms", T = "25 ms" }
inputs     = { e = {} }
outputs    = { u = "k_p*(1 + T_d*s/(1 + T_f*s))*e", U = "D*e/(1e7*s + 1)" }
blocks     = { D = { type = "delay", T = "T" } }
"""
HOSTILE = "tests/unit/codegen/test_difference.py"
MODELS = {"model": MODEL, "rod": ROD, "pid": CONTROLLER}
COMMANDS = (
    "derive model.toml --json --form polynomial",
    "derive model.toml --json --form factored",
    "derive model.toml --json --form horner",
    "derive rod.toml --json --form hyperbolic",
    "export model.toml --to sympy -o exported.py",
    "export pid.toml --to st --sample 5ms -o exported.st",
    "export pid.toml --to numpy --sample 5ms -o stepped.py",
    "export --help",
    "decay model.toml",
    "decay pid.toml --tf u/e --json",
)
RUN = """
import contextlib, io, json, sys
from symflex.cli import run
said = {}
for command in sys.argv[1:]:
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert run(command.split()) == 0, command
    said[command] = out.getvalue()
print(json.dumps(said))
"""
pytestmark = pytest.mark.needs_tool("git")


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A copy of the package with every diff of the page applied, and some models."""
    folder = tmp_path_factory.mktemp("extended")
    for name in ("symflex", "tests"):
        shutil.copytree(ROOT / name, folder / name)
    patch = "".join(block.text for block in DIFFS)
    command = ["git", "apply", "-"]
    done = subprocess.run(command, cwd=folder, input=patch, text=True, check=False, capture_output=True)
    assert not done.returncode, done.stderr
    for name, text in MODELS.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def said(extended):
    """What the commands print there, all run in one process."""
    return json.loads(python(extended, "-c", RUN, *COMMANDS))


def python(folder, *arguments):
    environment = {"PYTHONPATH": str(folder), "NO_COLOR": "1"}
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def derived(said, model, form):
    text = said[f"derive {model}.toml --json --form {form}"]
    return {entry["tf"]: entry for entry in json.loads(text)["transfer_functions"]}


def test_there_are_diffs():
    assert len(DIFFS) > 5


@pytest.mark.slow
def test_a_new_element_a_new_block_and_a_new_form_are_printed(said):
    """An inerter adds to the mass, a low pass multiplies, and the form multiplies by s once at a time."""
    expected = {
        ("polynomial", "X/F"): ("1", "(m + B)*s^2 + k"),
        ("factored", "Y/F"): ("T*s", "(T*s + 1)*((m + B)*s^2 + k)"),
        ("horner", "Y/F"): ("T*s", "((T*(m + B)*s + m + B)*s + k*T)*s + k"),
    }
    found = {(form, tf): derived(said, "model", form)[tf] for form, tf in expected}
    assert {key: (entry["num"], entry["den"]) for key, entry in found.items()} == expected


@pytest.mark.slow
def test_the_new_theory_adds_the_lateral_inertia_to_the_stiffness(said):
    (entry,) = derived(said, "rod", "hyperbolic").values()
    numbers = {"E": 4.0, "A": 0.5, "rho": 2.0, "nu": 0.25, "I_p": 3.0, "l": 1.5, "s": 0.7 + 1.1j}
    for name, line in entry["where"]:
        numbers[name] = evaluate(line, numbers, [])
    found = evaluate(entry["num"], numbers, []) / evaluate(entry["den"], numbers, [])
    stiffness = 4.0 * 0.5 + 2.0 * 0.25**2 * 3.0 * numbers["s"] ** 2
    gamma = cmath.sqrt(2.0 * 0.5 * numbers["s"] ** 2 / stiffness)
    assert abs(found - cmath.tanh(1.5 * gamma) / (stiffness * gamma)) < 1e-13


@pytest.mark.slow
def test_the_new_target_writes_a_module_that_runs(said, extended):
    names = runpy.run_path(str(extended / "exported.py"))
    _, denominator = names["TRANSFER_FUNCTIONS"]["X/F"]
    assert names["degree"](denominator, names["Symbol"]("s")) == 2


def block_step(text, name):
    """Return a function of one sample after the other that does what a block in Structured Text says."""
    code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
    block = rf"FUNCTION_BLOCK {name}\n((?:VAR.*?END_VAR\n)+)(.*?)END_FUNCTION_BLOCK"
    declared, body = re.search(block, code, re.DOTALL).groups()
    kept = {n: 0 if kind == "DINT" else 0.0 for n, kind in re.findall(r"(\w+) : (LREAL|DINT);", declared)}
    kept |= {n: [0.0] * (int(last) + 1) for n, last in re.findall(r"(\w+) : ARRAY\[0\.\.(\d+)\]", declared)}
    statements = compile(body.replace(":=", "=").replace("MOD", "%").replace(";", ""), name, "exec")

    def step(u):
        kept["u"] = u
        exec(statements, {}, kept)  # noqa: S102 (what the test has written)
        return kept["y"]

    return step


@pytest.mark.slow
def test_the_new_sampled_language_takes_the_steps_that_python_takes(said, extended):
    text = (extended / "exported.st").read_text()
    names = runpy.run_path(str(extended / "stepped.py"))
    u = [1.0, -2.0, 0.5, 3.0, 0.25, -1.0, 4.0, 7.0, -3.0]
    for block, function in (("u_over_e_step", "u_over_e"), ("u_over_e__step", "U_over_e")):
        step, state = block_step(text, block), names[f"{function}_start"]()
        assert [step(x) for x in u] == [names[f"{function}_step"](state, x) for x in u]
    assert re.search(r"\d\.\d+e-\d+ \* ", text), "no number with an exponent was tried"
    assert "st with --sample: Structured Text" in " ".join(said["export --help"].split())


@pytest.mark.slow
def test_a_language_that_is_only_sampled_says_so_and_is_in_the_api_and_the_tests_of_hostile_names(extended):
    refused = "from symflex.cli import run; import sys; sys.exit(run(sys.argv[1:]) != 2)"
    python(extended, "-c", refused, "export", "pid.toml", "--to", "st")
    shown = "import symflex; print(symflex.load('pid.toml').export_sampled('st', '5 ms')[:2])"
    assert python(extended, "-c", shown) == "(*\n"
    options = ["-v", "-p", "no:cacheprovider", "-p", "no:xdist", "--import-mode=importlib"]
    tested = python(extended, "-m", "pytest", *options, "-k", "sampled_language", HOSTILE)
    assert tested.count("[st] PASSED") == 2


@pytest.mark.slow
def test_the_new_root_finder_proves_its_roots(extended):
    # s^2 + 6 s + 25 = (s + 3)^2 + 4^2
    assert python(extended, "-c", ROOTS).strip() == "[('-3.00', '4.00', True), ('-3.00', '-4.00', True)]"


@pytest.mark.slow
def test_the_contract_of_elements_and_blocks_holds_with_the_additions(extended):
    options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    options += ["--import-mode=importlib", "-k", "test_elements or a_block"]
    python(extended, "-m", "pytest", *options, "tests/contract")


@pytest.mark.slow
def test_the_new_command_proves_its_number(said):
    # (m + B) s^2 + k is undamped; the pole of k_p (1 + T_d s/(1 + T_f s)) is -1/T_f = -50.
    assert said["decay model.toml"] == "slowest pole: Re s = 0 1/s   certified\n"
    assert json.loads(said["decay pid.toml --tf u/e --json"]) == {
        "rate": {"value": "-50.0000000000", "radius": "0"},
        "certified": True,
    }
