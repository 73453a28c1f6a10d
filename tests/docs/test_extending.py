"""The diffs of docs/extending.md apply to this version, and what they add works."""

from __future__ import annotations

import cmath
import json
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
blocks     = { P = { type = "low_pass", T = "T" } }

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
CANTILEVER = """
symflex = 1
parameters = { EI = "3 N*m^2", rhoA = "2 kg/m", l = "1.5 m" }
inputs     = { F = {} }
outputs    = { W = "w(l)" }

[fields.w]
domain     = ["0", "l"]
equation   = "EI*w'''' + rhoA*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*w'''(l) = -F"]
"""
IN_NODE = """
import {TRANSFER_FUNCTIONS} from "./exported.mjs";
const [name, s, values] = JSON.parse(process.argv[1]);
console.log(JSON.stringify(TRANSFER_FUNCTIONS[name](s, values)));
"""
pytestmark = pytest.mark.needs_tool("git")


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A copy of the package with every diff of the page applied."""
    folder = tmp_path_factory.mktemp("extended")
    for name in ("symflex", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    patch = "".join(block.text for block in DIFFS)
    subprocess.run(["git", "apply", "-"], cwd=folder, input=patch, text=True, check=True, capture_output=True)
    (folder / "model.toml").write_text(MODEL, encoding="utf-8")
    return folder


def python(folder, *arguments):
    environment = {"PYTHONPATH": str(folder), "NO_COLOR": "1", "SYMFLEX_NO_CACHE": "1"}
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def derived(folder, form):
    text = python(folder, "-m", "symflex", "derive", "model.toml", "--json", "--form", form)
    return {entry["tf"]: (entry["num"], entry["den"]) for entry in json.loads(text)["transfer_functions"]}


def test_there_are_diffs():
    assert len(DIFFS) > 5


@pytest.mark.slow
def test_an_inerter_adds_to_the_mass(extended):
    assert derived(extended, "polynomial")["X/F"] == ("1", "(m + B)*s^2 + k")


@pytest.mark.slow
def test_the_new_theory_adds_the_lateral_inertia_to_the_stiffness(extended):
    (extended / "rod.toml").write_text(ROD, encoding="utf-8")
    text = python(extended, "-m", "symflex", "derive", "rod.toml", "--json", "--form", "hyperbolic")
    (entry,) = json.loads(text)["transfer_functions"]
    numbers = {"E": 4.0, "A": 0.5, "rho": 2.0, "nu": 0.25, "I_p": 3.0, "l": 1.5, "s": 0.7 + 1.1j}
    for name, line in entry["where"]:
        numbers[name] = evaluate(line, numbers, [])
    found = evaluate(entry["num"], numbers, []) / evaluate(entry["den"], numbers, [])
    stiffness = 4.0 * 0.5 + 2.0 * 0.25**2 * 3.0 * numbers["s"] ** 2
    gamma = cmath.sqrt(2.0 * 0.5 * numbers["s"] ** 2 / stiffness)
    assert abs(found - cmath.tanh(1.5 * gamma) / (stiffness * gamma)) < 1e-13


@pytest.mark.slow
def test_the_low_pass_multiplies_the_displacement(extended):
    assert derived(extended, "factored")["Y/F"] == ("1", "(T*s + 1)*((m + B)*s^2 + k)")


@pytest.mark.slow
def test_the_new_form_multiplies_by_s_once_at_a_time(extended):
    assert derived(extended, "horner")["Y/F"] == ("1", "((T*(m + B)*s + m + B)*s + k*T)*s + k")


@pytest.mark.slow
def test_the_new_target_writes_a_module_that_runs(extended):
    text = python(extended, "-m", "symflex", "export", "model.toml", "--to", "sympy")
    (extended / "exported.py").write_text(text, encoding="utf-8")
    code = "from exported import *; num, den = TRANSFER_FUNCTIONS['X/F']; print(degree(den, Symbol('s')))"
    assert python(extended, "-c", code).strip() == "2"


def in_javascript(folder, model, name, s, values):
    """The value of a transfer function, as node computes it from the exported module."""
    (folder / "exporting.toml").write_text(model, encoding="utf-8")
    text = python(folder, "-m", "symflex", "export", "exporting.toml", "--to", "js")
    (folder / "exported.mjs").write_text(text, encoding="utf-8")
    given = json.dumps([name, [s.real, s.imag], values])
    command = ["node", "--input-type=module", "-e", IN_NODE, given]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return complex(*json.loads(done.stdout))


@pytest.mark.slow
@pytest.mark.needs_tool("node")
def test_the_new_language_computes_a_lumped_model(extended):
    s = -0.3 + 2.1j
    found = in_javascript(extended, MODEL, "X/F", s, {"k": 7.0})
    assert abs(found * ((2 + 1) * s**2 + 7) - 1) < 1e-14


@pytest.mark.slow
@pytest.mark.needs_tool("node")
@pytest.mark.parametrize("s", [1e-3j, 0.4 + 3j, -2 + 90j])
def test_the_new_language_computes_a_cantilever(extended, s):
    # EI w'''' = b^4 EI w with w, w' = 0 at the root and w'' = 0, EI w''' = -F at the tip.
    b = (-2 * s**2 / 3) ** 0.25
    sine, cosine, sinh, cosh = (f(1.5 * b) for f in (cmath.sin, cmath.cos, cmath.sinh, cmath.cosh))
    expected = (sine * cosh - cosine * sinh) / (3 * b**3 * (1 + cosine * cosh))
    assert abs(in_javascript(extended, CANTILEVER, "W/F", s, {}) / expected - 1) < 1e-11


@pytest.mark.slow
def test_the_new_root_finder_proves_its_roots(extended):
    # s^2 + 6 s + 25 = (s + 3)^2 + 4^2
    assert python(extended, "-c", ROOTS).strip() == "[('-3.00', '4.00', True), ('-3.00', '-4.00', True)]"


@pytest.mark.slow
def test_the_contract_tests_pass_with_the_additions(extended):
    options = [
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
        "--import-mode=importlib",
        "-k",
        "inerter or low_pass",
    ]
    python(extended, "-m", "pytest", *options, "tests/contract")
