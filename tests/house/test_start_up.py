import subprocess
import sys

import pytest

from tests.house.repository import ROOT

LIBRARIES = {
    "click",
    "flint",
    "lark",
    "matplotlib",
    "mpmath",
    "numpy",
    "pyuff",
    "scipy",
    "sympy",
}
READING = {"click", "flint"}
LUMPED = "derivations/eppinger1988/rigid_body.toml"
BEAM = "derivations/classics/pinned_pinned.toml"
ALLOWED = [
    (("--help",), {"click"}),
    (("derive", "--help"), {"click"}),
    (("new",), {"click"}),
    (("examples",), {"click"}),
    (("elements",), {"click"}),
    (("check", LUMPED), READING),
    (("check", BEAM, "--json"), READING),
    (("derive", LUMPED), READING),
    (("derive", BEAM), READING),
    (("derive", LUMPED, "--json"), READING),
    (("derive", LUMPED, "--format", "latex"), READING),
    (("audit", LUMPED), READING),
    (("roots", LUMPED), READING),
    (("export", LUMPED, "--to", "c"), {*READING, "numpy"}),
    (("rational", LUMPED), {*READING, "numpy", "mpmath"}),
]
NUMBERS = {"audit", "explanation", "fitting", "rational", "report", "response", "roots", "sensitivity"}
MOST_MODULES = 122
CODE = """
import sys
from symflex.cli import run
assert run({arguments}) == 0
print("modules:", *sys.modules)
"""


def modules_after(*arguments):
    command = [sys.executable, "-c", CODE.format(arguments=list(arguments))]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.partition("modules:")[2].split())


@pytest.mark.slow
@pytest.mark.parametrize(("arguments", "allowed"), ALLOWED, ids=[" ".join(a) for a, _ in ALLOWED])
def test_a_command_imports_the_libraries_it_needs_and_no_other(arguments, allowed):
    assert modules_after(*arguments) & LIBRARIES == allowed


@pytest.mark.slow
def test_a_drawing_needs_a_style_and_no_roots(tmp_path):
    found = modules_after("draw", LUMPED, "-o", str(tmp_path / "drawing.svg"))
    assert found & LIBRARIES == {*READING, "matplotlib", "numpy"}
    assert "symflex.roots" not in found


@pytest.mark.slow
def test_a_bode_plot_needs_no_loops_no_letters_and_no_file_but_its_own(tmp_path):
    found = modules_after("plot", LUMPED, "bode", "-o", str(tmp_path / "bode.svg"))
    others = {"symflex.loops", "symflex.symbolic", "symflex.figures.pgf", "matplotlib.backends.backend_pgf"}
    assert not found & others


ONLY_WITH_BEAMS = {
    "algebra.exponential_sum",
    "algebra.exponentials",
    "algebra.modal_sum",
    "algebra.normal_form",
    "algebra.propagators",
    "algebra.vanishing",
    "equations.distributed",
    "library.fields",
    "print.forms.closed",
    "print.forms.economical",
    "print.forms.frequency",
    "print.forms.krylov",
    "transfer.distributed",
    "transfer.enclose_kernels",
}
ONLY_WHERE_SOMETHING_IS_WRONG = {"difflib", "symflex.model.spec.diagnose"}


def test_a_lumped_model_needs_nothing_that_only_beams_need():
    imported = modules_after("derive", LUMPED)
    found = {module for module in ONLY_WITH_BEAMS if f"symflex.{module}" in imported}
    assert not found | ONLY_WHERE_SOMETHING_IS_WRONG & imported


def test_deriving_a_lumped_model_imports_at_most_122_modules():
    assert sum(module.startswith("symflex.") for module in modules_after("derive", LUMPED)) <= MOST_MODULES


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "derive"])
def test_what_prints_formulas_does_not_import_the_packages_of_numbers(command):
    imported = modules_after(command, LUMPED)
    assert not {f"symflex.{package}" for package in NUMBERS} & imported


@pytest.mark.slow
def test_roots_are_printed_without_what_prints_formulas():
    assert "symflex.print.forms" not in modules_after("roots", LUMPED)
