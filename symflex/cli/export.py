"""``symflex export``."""

from __future__ import annotations

from pathlib import Path

import click

from symflex.cli.report import note, reporting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest


@click.command("export")
@click.argument("spec", type=click.Path())
@click.option("--to", "target", required=True, metavar="TARGET", help="numpy, latex or state-space.")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@click.option("--minimal", "is_minimal", is_flag=True, help="state-space: without hidden states.")
@click.option("--strict", is_flag=True, help="Exit with 4 when the verified accuracy falls short.")
@reporting
def command(
    spec: str, *, target: str, tfs: tuple[str, ...], output: str | None, is_minimal: bool, strict: bool
) -> int:
    """Write the transfer functions of SPEC for another program.

    Numeric code is verified against ball arithmetic before it is written; the worst error stands in its
    documentation.

    With --to state-space all of them get one realisation, whose states are displacements, velocities,
    currents and the like of the model. Exit code 3 says that there is none: beams, rods and delays have
    infinitely many states, and what has more zeros than poles has no output equation.
    """
    from symflex import pipeline
    from symflex.emit.exporters import EXPORTERS, StateSpaceExporter
    from symflex.emit.write import write_atomically

    if target not in EXPORTERS:
        hint = nearest(target, EXPORTERS) or "targets: " + ", ".join(EXPORTERS)
        raise UsageError(Diagnostic("SF902", f"there is no export target '{target[:64]}'", None, hint))
    exporter = EXPORTERS[target]
    if is_minimal:
        if not isinstance(exporter, StateSpaceExporter):
            raise UsageError(Diagnostic("SF902", "--minimal goes with --to state-space"))
        exporter = StateSpaceExporter(is_minimal=True)
    model = pipeline.load(spec)
    derived = pipeline.derive_all(model, pipeline.pick_pairs(model, tfs))
    made = exporter.export(model, derived)
    for warning in made.warnings:
        note(f"warning: {warning}")
    if output:
        write_atomically(Path(output), made.text.encode())
        note(f"wrote {output}")
    else:
        click.echo(made.text, nl=False)
    return 4 if strict and made.warnings else 0
