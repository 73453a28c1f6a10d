"""Start-up: commands on a small model against importing click, and against importing SymPy."""

from __future__ import annotations

import os
import sys

from benchmarks.measure import Claim, Extent, Measured, Measurement, time_commands

REPEATS, QUICK_REPEATS = 21, 3
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
}
NOT_COMPARED = {"derive of a Timoshenko beam": ("-m", "symflex", "derive", DISTRIBUTED)}


def measure(extent: Extent) -> Measured:
    """Measure each command and compare it with the import that stands first.

    Times are processor times, medians of runs that take turns. Modules that are not compiled yet are compiled
    by a round that does not count.
    """
    repeats = extent.of(REPEATS, QUICK_REPEATS)
    found = _time("start-up", HELP, repeats)
    compared = _time("start-up of commands", COMMANDS | extent.of(NOT_COMPARED, {}), repeats)
    ours, click, _ = found
    text = "`symflex --help`: times as long as importing click"
    claims = [Claim(text, HELP_CEILING, ours.at_least / click.at_least, larger_is_better=False)]
    sympy, *others = compared
    for row in others:
        if row.way in CEILINGS:
            text = f"`symflex {row.way}`, of a small model: times as long as importing SymPy"
            ratio = row.at_least / sympy.at_least
            claims.append(Claim(text, CEILINGS[row.way], ratio, larger_is_better=False))
    return Measured([*found, *compared], claims)


def _time(task: str, commands: dict[str, tuple[str, ...]], repeats: int) -> list[Measurement]:
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    arguments = {way: (sys.executable, *words) for way, words in commands.items()}
    return time_commands(task, arguments, repeats, environment)
