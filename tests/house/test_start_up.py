from __future__ import annotations

import subprocess
import sys

import pytest

from tests.house.repository import ROOT

HEAVY = ("sympy", "numpy", "scipy", "matplotlib", "flint", "lark", "mpmath", "tree_sitter")
CODE = """
import sys
from click.testing import CliRunner
from symflex.cli import main
result = CliRunner().invoke(main, ["--help"])
assert result.exit_code == 0, result.output
print(*sys.modules)
"""


@pytest.fixture(scope="module")
def modules():
    command = [sys.executable, "-c", CODE]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.parametrize("heavy", HEAVY)
def test_help_does_not_import(heavy, modules):
    assert heavy not in modules
