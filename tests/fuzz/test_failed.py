"""What fuzzing once found stays found, and every target reaches what it is for."""

import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from tests.fuzz import TARGETS
from tests.house.repository import ROOT

FAILED = sorted((Path(__file__).parent / "failed").glob("*/*"))


@pytest.mark.parametrize("file", FAILED, ids=lambda path: f"{path.parent.name}: {path.name}")
def test_an_input_that_once_failed_is_answered(file):
    import_module(f"tests.fuzz.target_{file.parent.name}").run(file.read_bytes())


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in TARGETS if name != "derivation"])
def test_a_target_takes_its_seeds(name):
    target = import_module(f"tests.fuzz.target_{name}")
    for seed in target.seeds():
        target.run(seed)


def test_every_target_is_listed():
    files = (Path(__file__).parent).glob("target_*.py")
    assert {path.stem.removeprefix("target_") for path in files} == set(TARGETS)


@pytest.mark.slow
@pytest.mark.needs_module("atheris")
def test_the_command_counts_what_it_tries():
    command = [sys.executable, "-m", "tests.fuzz", "--seconds", "3", "quantity"]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=False, env=dict(os.environ)
    )
    assert done.returncode == 0, done.stderr
    assert int(re.match(r"quantity +(\d+) inputs, 0 failed", done.stdout)[1]) > 0
