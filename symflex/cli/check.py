"""``symflex check``."""

from __future__ import annotations

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import diagnostic_json, emit_json, listed, outside, reporting, say
from symflex.cli.setting import setting
from symflex.errors import SymflexError
from symflex.errors.diagnostic import printable


@click.command("check")
@click.argument("spec", type=click.Path())
@outside
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
@setting
def command(spec: str, *, allow_outside: tuple[str, ...], settings: dict[str, str], as_json: bool) -> int:
    """Parse and resolve SPEC; report every problem at once.

    Names, units, ports, linearity and solvability are checked; nothing is derived.
    """
    from symflex import pipeline

    try:
        model = pipeline.load(spec, allow_outside, settings)
        pipeline.check_solvable(pipeline.assemble(model))
    except SymflexError as error:
        if not as_json:
            raise
        problems = [diagnostic_json(d) for d in error.diagnostics]
        emit_json({"schema": "symflex.check/1", "ok": False, "problems": problems})
        return error.exit_code
    names = ["/".join(pair) for pair in model.transfer_functions]
    if as_json:
        emit_json({"schema": "symflex.check/1", "ok": True, "problems": [], "transfer_functions": names})
        return 0
    symbolic = [p.name for p in model.parameters if p.value is None]
    counts = ", ".join(
        f"{len(group)} {word}{'' if len(group) == 1 else 's'}"
        for group, word in (
            (model.parameters, "parameter"),
            (model.nodes, "node"),
            (model.elements, "element"),
            (model.signals, "signal"),
            (model.blocks, "block"),
            (model.fields, "field"),
        )
        if group
    )
    say(f"{printable(spec)}: ok")
    if model.title:
        say(listed("", printable(model.title).split(), " "))
    say(listed("", counts.split(), " "))
    say(listed("transfer functions: ", names))
    if symbolic:
        say(listed("symbolic (no value): ", symbolic))
    return 0
