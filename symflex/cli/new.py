"""``symflex new``."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import click

from symflex.cli.reporting import note, reporting, say
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

TEMPLATES: dict[str, str] = {
    "mass_spring": "mass on a spring and damper",
    "two_mass": "two masses joined by a flexible transmission",
    "motor_axis": "current-controlled motor, ball screw and carriage",
    "bending_beam": "sliding mass, massless beam and rigid tip body",
    "sliding_beam": "sliding-free bending beam, written as a boundary-value problem",
    "flexible_arm": "current-controlled motor, screw, carriage, flexible arm and gripper",
}


@click.command("new")
@click.argument("template", required=False)
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@reporting
def command(template: str | None, *, output: str | None) -> int:
    """Write the specification TEMPLATE to start from; without TEMPLATE, list them."""
    if template is None:
        width = max(len(name) for name in TEMPLATES)
        for name, summary in TEMPLATES.items():
            say(f"{name.ljust(width)}  {summary}")
        return 0
    if template not in TEMPLATES:
        hint = nearest(template, TEMPLATES) or "templates: " + ", ".join(TEMPLATES)
        raise UsageError(Diagnostic("SF902", f"there is no template '{template[:64]}'", None, hint))
    text = (files("symflex") / "templates" / f"{template}.toml").read_text(encoding="utf-8")
    if output is None:
        say(text, nl=False)
        return 0
    if Path(output).exists():
        raise UsageError(
            Diagnostic("SF903", f"'{output}' exists and is not overwritten", None, "choose another name")
        )
    from symflex.emit.write import write_atomically

    write_atomically(Path(output), text.encode())
    note(f"wrote {output}; try: symflex derive {output}")
    return 0
