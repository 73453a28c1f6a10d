"""Start-up: ``symflex --help`` against a Python process that does nothing, and one that imports click."""

from __future__ import annotations

import sys

from benchmarks.measure import Claim, Measurement, time_command

REPEATS = 11
STATED_RATIO = 1.5

COMMANDS = {
    "symflex --help": ("-m", "symflex", "--help"),
    'python -c "import click"': ("-c", "import click"),
    'python -c "pass"': ("-c", "pass"),
}


def measure() -> tuple[list[Measurement], list[Claim]]:
    """Measure each command's median and compare symflex with click alone."""
    found = {
        way: time_command("start-up", way, (sys.executable, *arguments), REPEATS)
        for way, arguments in COMMANDS.items()
    }
    ratio = found["symflex --help"].at_least / found['python -c "import click"'].at_least
    claim = Claim(
        f"`symflex --help` takes at most {STATED_RATIO} times as long as importing click",
        STATED_RATIO,
        ratio,
        larger_is_better=False,
    )
    return list(found.values()), [claim]
