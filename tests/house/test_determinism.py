"""The same file gives the same bytes, whatever order Python's sets happen to have."""

import os
import subprocess
import sys

import pytest

from tests.house.repository import ROOT

COMPARED = {
    "a network": "eppinger1988/loops/two_mass_force",
    "a field": "eppinger1988/sliding_free_beam",
    "a member": "classics/rod_tip_mass",
    "a taper": "tapers/conical_horn",
}
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


@pytest.mark.slow
@pytest.mark.parametrize("model", COMPARED.values(), ids=COMPARED)
def test_output_does_not_depend_on_the_hash_seed(model):
    path = ROOT / "derivations" / f"{model}.toml"
    assert outputs(path, "1") == outputs(path, "2025")
