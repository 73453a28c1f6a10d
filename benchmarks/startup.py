"""Start-up: ``symflex --help`` against a Python process that does nothing, and one that imports click."""

from __future__ import annotations

import sys

from benchmarks.measure import Claim, Measurement, time_commands

REPEATS = 21
CEILING = 2.0

COMMANDS = {
    "symflex --help": ("-m", "symflex", "--help"),
    'python -c "import click"': ("-c", "import click"),
    'python -c "pass"': ("-c", "pass"),
}


def measure() -> tuple[list[Measurement], list[Claim]]:
    """Measure each command's median and compare symflex with click alone."""
    commands = {way: (sys.executable, *arguments) for way, arguments in COMMANDS.items()}
    found = time_commands("start-up", commands, REPEATS)
    ours, click, _ = found
    ratio = ours.at_least / click.at_least
    text = "`symflex --help`: times as long as importing click"
    return found, [Claim(text, CEILING, ratio, larger_is_better=False)]
