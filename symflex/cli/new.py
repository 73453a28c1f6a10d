"""``symflex new``."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import click

from symflex.cli.reporting import note, reporting, say
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

TEMPLATES: dict[str, str] = {
    "mass_spring": "A mass on a spring and a damper, driven by a force.",
    "two_mass": "Two masses joined by a spring and a damper.",
    "motor_axis": "A motor with a current loop, a ball screw and a carriage.",
    "motor_loop": "Current, velocity and position loop of a motor with a load.",
    "bending_beam": "A sliding mass, a massless beam and a rigid body at its end.",
    "sliding_beam": "A beam that slides at one end, as a boundary-value problem.",
    "flexible_arm": "A flexible arm on a driven hub, with a gripper at its tip.",
}


@click.command(
    "new", epilog="\b\n" + "\n".join(("Templates:", *(f"  {n}: {s}" for n, s in TEMPLATES.items())))
)
@click.argument("template", required=False)
@click.option("--list", "is_list", is_flag=True, help="List the templates, as without TEMPLATE.")
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@reporting
def command(template: str | None, *, output: str | None, is_list: bool) -> int:
    """Write the specification TEMPLATE to start from; without TEMPLATE, list them.

    A template says at its head what it is and what to try next.
    """
    if template is None or is_list:
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
    from symflex.files.write import write_atomically

    write_atomically(Path(output), text.encode())
    note(f"wrote {output}; try: symflex derive {output}, and what its head says")
    return 0
