"""Start-up: commands on a small model against importing click, SymPy or matplotlib, and python-control."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from tempfile import TemporaryDirectory

from benchmarks.measure import Claim, Extent, Measured, Measurement, time_commands

REPEATS, QUICK_REPEATS = 21, 3
HELP_CEILING = 2.0
CEILINGS = {"check": 1.0, "derive": 1.0, "roots": 1.0}
PICTURE_CEILINGS = {"plot bode": 2.8, "live": 2.6}
SMALL = "derivations/eppinger1988/rigid_body.toml"
DISTRIBUTED = "derivations/classics/timoshenko_cantilever.toml"

CONTROL_WAY = "python-control, one mass"
CONTROL = """
import control
import matplotlib.pyplot as plt
control.bode_plot(control.tf([1], [1, 1, 100]), dB=True)
plt.savefig("FOLDER/control.svg")
"""
"""A Bode plot of one mass, as python-control draws it."""

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
PICTURES = {
    'python -c "import matplotlib.figure"': ("-c", "import matplotlib.figure"),
    "plot bode": ("-m", "symflex", "plot", SMALL, "bode", "-o", "FOLDER/bode.svg"),
    "live": ("-m", "symflex", "live", SMALL, "-o", "FOLDER/live.html"),
    CONTROL_WAY: ("-c", CONTROL),
}
"""What draws, against the import that all of it has in common."""
NOT_COMPARED = {"derive of a Timoshenko beam": ("-m", "symflex", "derive", DISTRIBUTED)}


def measure(extent: Extent) -> Measured:
    """Measure each command and compare it with the import listed first.

    Times are processor times, medians of runs that take turns. Modules that are not compiled yet are compiled
    by a round that does not count.
    """
    repeats = extent.of(REPEATS, QUICK_REPEATS)
    found = _time("start-up", HELP, repeats)
    ours, click, _ = found
    text = "`symflex --help`: times as long as importing click"
    claims = [Claim(text, HELP_CEILING, ours.at_least / click.at_least, larger_is_better=False)]
    with TemporaryDirectory() as folder:
        drawn = {way: tuple(w.replace("FOLDER", folder) for w in words) for way, words in PICTURES.items()}
        if find_spec("control") is None:
            del drawn[CONTROL_WAY]
        groups = (
            ("start-up of commands", COMMANDS | extent.of(NOT_COMPARED, {}), CEILINGS, "SymPy"),
            ("pictures of a small model", drawn, PICTURE_CEILINGS, "matplotlib"),
        )
        for task, commands, ceilings, library in groups:
            first, *others = rows = _time(task, commands, repeats)
            found += rows
            for row in (row for row in others if row.way in ceilings):
                text = f"`symflex {row.way}`, of a small model: times as long as importing {library}"
                ratio = row.at_least / first.at_least
                claims.append(Claim(text, ceilings[row.way], ratio, larger_is_better=False))
    return Measured(found, claims)


def _time(task: str, commands: dict[str, tuple[str, ...]], repeats: int) -> list[Measurement]:
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    arguments = {way: (sys.executable, *words) for way, words in commands.items()}
    return time_commands(task, arguments, repeats, environment)
