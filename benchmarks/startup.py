"""Start-up: commands on a small model against importing click, and against importing SymPy."""

from __future__ import annotations

import os
import sys
import tempfile

from benchmarks.measure import Claim, Measurement, time_commands

REPEATS = 21
HELP_CEILING = 2.0
CEILINGS = {"check": 1.2, "derive": 1.2, "roots": 1.8}
SMALL = "derivations/eppinger1988/rigid_body.toml"
DISTRIBUTED = "derivations/classics/timoshenko_cantilever.toml"

HELP = {
    "symflex --help": ("-m", "symflex", "--help"),
    'python -c "import click"': ("-c", "import click"),
    'python -c "pass"': ("-c", "pass"),
}
COMMANDS = {
    'python -c "import sympy"': ("-c", "import sympy"),
    "check": ("-m", "symflex", "check", SMALL),
    "derive": ("-m", "symflex", "derive", SMALL),
    "roots": ("-m", "symflex", "roots", SMALL),
    "derive of a Timoshenko beam": ("-m", "symflex", "derive", DISTRIBUTED),
}


def measure() -> tuple[list[Measurement], list[Claim]]:
    """Measure each command and compare it with the import that stands first.

    Times are processor times, medians of runs that take turns. All modules are compiled by a round that does
    not count, as they are when a package is installed.
    """
    with tempfile.TemporaryDirectory() as folder:
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = f"{folder}/compiled"
        found = _time("start-up", HELP, environment)
        compared = _time("start-up of commands", COMMANDS, environment)
    ours, click, _ = found
    text = "`symflex --help`: times as long as importing click"
    claims = [Claim(text, HELP_CEILING, ours.at_least / click.at_least, larger_is_better=False)]
    sympy, *commands = compared
    for row in commands:
        if row.way in CEILINGS:
            text = f"`symflex {row.way}`, of a small model: times as long as importing SymPy"
            ratio = row.at_least / sympy.at_least
            claims.append(Claim(text, CEILINGS[row.way], ratio, larger_is_better=False))
    return [*found, *compared], claims


def _time(task: str, commands: dict[str, tuple[str, ...]], environment: dict[str, str]) -> list[Measurement]:
    arguments = {way: (sys.executable, *words) for way, words in commands.items()}
    return time_commands(task, arguments, REPEATS, environment)
