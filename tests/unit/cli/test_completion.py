"""The tab key, in the shells that people use: what is typed, and the line that it becomes."""

import os
import pty
import select
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from symflex.cli import group

SPEC = """symflex = 1
parameters = { mass_1 = "2 kg", stiffness = "8 N/m" }
elements.body = { type = "mass", at = "x", m = "mass_1" }
elements.wall = { type = "spring", between = ["x", "ground"], k = "stiffness" }
inputs = { F = { force = "x" } }
outputs = { X = "x", V = "s*x" }
"""


def offered(words):
    """Return what is offered for the last word of a command line."""
    variable = "_SYMFLEX_COMPLETE"
    given = {"COMP_WORDS": words, "COMP_CWORD": str(len(words.split(" ")) - 1), variable: "bash_complete"}
    done = CliRunner().invoke(group, prog_name="symflex", env=given, complete_var=variable)
    return [line.partition(",")[2] for line in done.output.split()]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("plant.toml").write_text(SPEC, encoding="utf-8")
    Path("broken.toml").write_text("symflex = 1\n[inputs\n", encoding="utf-8")
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_transfer_functions_parameters_forms_and_targets_are_offered():
    expected = {
        "symflex roots plant.toml --tf ": ["X/F", "V/F"],
        "symflex roots plant.toml --tf V": ["V/F"],
        "symflex roots plant.toml --set m": ["mass_1="],
        "symflex sweep plant.toml --over s": ["stiffness="],
        "symflex stability plant.toml --gain ": ["mass_1", "stiffness"],
        "symflex roots plant.toml --sensitivity st": ["stiffness"],
        "symflex derive plant.toml --form fac": ["factored"],
        "symflex export plant.toml --to ju": ["julia"],
        "symflex roots broken.toml --tf ": [],
        "symflex roots absent.toml --set ": [],
        "symflex roots --tf ": [],
    }
    assert {words: offered(words) for words in expected} == expected


def typed(shell, start, line, wanted, folder):
    """Return what an interactive shell shows after a line and a tab, once it shows what is wanted."""
    (folder / "symflex").write_text(f'#!/bin/sh\nexec {sys.executable} -m symflex "$@"\n', encoding="utf-8")
    (folder / "symflex").chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{folder}:{os.environ['PATH']}",
        "TERM": "dumb",
        "HOME": str(folder),
    }
    environment["PYTHONPATH"] = str(Path(__file__).parents[3])
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.execvpe(shell[0], shell, environment)
    shown, end = "", time.monotonic() + 60
    os.write(terminal, f"{start}; echo rea''dy\n".encode())
    pending = f"{line}\t"
    while wanted not in shown and time.monotonic() < end:
        if select.select([terminal], [], [], 0.2)[0]:
            shown += os.read(terminal, 4096).decode(errors="replace")
        if "ready" in shown and pending:
            os.write(terminal, pending.encode())
            pending = ""
    os.write(terminal, b"\x03exit\n")
    os.close(terminal)
    os.waitpid(process, 0)
    return shown


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shell", "start"),
    [
        pytest.param(
            ["bash", "--norc", "-i"],
            'eval "$(_SYMFLEX_COMPLETE=bash_source symflex)"',
            marks=pytest.mark.needs_tool("bash"),
        ),
        pytest.param(
            ["zsh", "-f", "-i"],
            'autoload -U compinit; compinit -D; eval "$(_SYMFLEX_COMPLETE=zsh_source symflex)"',
            marks=pytest.mark.needs_tool("zsh"),
        ),
    ],
)
def test_the_tab_key_completes_in_a_shell(shell, start, folder):
    asked = {"symflex stab": "symflex stability", "symflex roots plant.toml --set stif": "--set stiffness="}
    for line, wanted in asked.items():
        assert wanted in typed(shell, start, line, wanted, folder), line
