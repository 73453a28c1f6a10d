"""The same file gives the same bytes, whatever order Python's sets happen to have."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests.house.repository import ROOT, slow_ones, specifications

SPECIFICATIONS = specifications(ROOT / "derivations", "**/*.toml")
EACH_TIME = {"two_mass_force", "sliding_free_beam", "rod_tip_mass"}
"""A network, a loop and fields, of models that take seconds; every fifth of the others with -m slow."""
OTHERS = [path for path in SPECIFICATIONS if path.stem not in EACH_TIME]
COMPARED = [*(p for p in SPECIFICATIONS if p.stem in EACH_TIME), *OTHERS[::5]]
COMMANDS = (
    ("derive", "--format", "text"),
    ("derive", "--format", "json"),
    ("derive", "--format", "latex"),
    ("roots", "--json"),
    ("export", "--to", "numpy"),
    ("export", "--to", "state-space"),
)
# One process runs all commands on one file: starting Python is most of the cost.
CODE = """
import sys
from click.testing import CliRunner
from symflex.cli import group
path, *commands = sys.argv[1:]
for command in commands:
    name, *options = command.split()
    result = CliRunner().invoke(group, [name, path, *options], standalone_mode=False)
    assert result.exception is None, result.exception
    print("====", command, result.return_value)
    print(result.output)
"""


def outputs(path, seed):
    command = [sys.executable, "-c", CODE, str(path), *(" ".join(c) for c in COMMANDS)]
    environment = {**os.environ, "PYTHONHASHSEED": seed}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return done.stdout


def test_there_are_derivations_to_compare():
    assert SPECIFICATIONS


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", slow_ones(COMPARED, lambda path: path.stem not in EACH_TIME), ids=lambda path: path.stem
)
def test_output_does_not_depend_on_the_hash_seed(path):
    assert outputs(path, "1") == outputs(path, "2025")
