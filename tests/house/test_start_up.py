from __future__ import annotations

import subprocess
import sys

import pytest

from tests.house.repository import ROOT

HEAVY = ("sympy", "numpy", "scipy", "matplotlib", "flint", "lark", "mpmath", "tree_sitter")
CODE = """
import sys
from symflex.cli import run
assert run({arguments}) == 0
print("modules:", *sys.modules)
"""


def modules_after(*arguments):
    command = [sys.executable, "-c", CODE.format(arguments=list(arguments))]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.partition("modules:")[2].split()


@pytest.fixture(scope="module")
def help_modules():
    return modules_after("--help")


@pytest.fixture(scope="module")
def template_modules():
    return modules_after("new")


@pytest.mark.parametrize("heavy", HEAVY)
def test_help_does_not_import(heavy, help_modules):
    assert heavy not in help_modules


@pytest.mark.parametrize("heavy", HEAVY)
def test_the_list_of_templates_does_not_import(heavy, template_modules):
    assert heavy not in template_modules


def test_deriving_as_text_does_not_import_sympy_or_matplotlib():
    imported = modules_after("derive", "derivations/eppinger1988/two_mass.toml")
    assert not {"sympy", "matplotlib"} & set(imported)
