"""``symflex export``."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.report import note, reporting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.exporters import LatexExporter
    from symflex.model import Model
    from symflex.transfer import TransferFunction


@click.command("export")
@click.argument("spec", type=click.Path())
@click.option("--to", "target", required=True, metavar="TARGET", help="What to write; see below.")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option("--form", metavar="FORM", help="latex: form of the functions, as for derive.")
@click.option("--width", metavar="ieee|a4|MM", help="latex: width of the column; a4 (170 mm) by default.")
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@click.option("--minimal", "is_minimal", is_flag=True, help="state-space: without hidden states.")
@click.option("--strict", is_flag=True, help="Exit with 4 when the verified accuracy falls short.")
@reporting
def command(
    spec: str,
    *,
    target: str,
    tfs: tuple[str, ...],
    form: str | None,
    width: str | None,
    output: str | None,
    is_minimal: bool,
    strict: bool,
) -> int:
    """Write the transfer functions of SPEC for another program.

    Numeric code is verified against ball arithmetic before it is written; the worst error stands in its
    documentation.

    With --to latex and -o FOLDER/ every transfer function and table becomes a file for a paper to input, and
    document.tex inputs them all.

    With --to state-space all of them get one realisation, whose states are displacements, velocities,
    currents and the like of the model. Exit code 3 says that there is none: beams, rods and delays have
    infinitely many states, and what has more zeros than poles has no output equation.
    """
    from symflex import pipeline
    from symflex.emit.exporters import EXPORTERS, LatexExporter, StateSpaceExporter
    from symflex.emit.latex import column_width
    from symflex.emit.write import write_atomically

    if target not in EXPORTERS:
        hint = nearest(target, EXPORTERS) or "targets: " + ", ".join(EXPORTERS)
        raise UsageError(Diagnostic("SF902", f"there is no export target '{target[:64]}'", None, hint))
    exporter = EXPORTERS[target]
    if isinstance(exporter, LatexExporter):
        exporter = replace(exporter, form=form, width_mm=column_width(width or "a4"))
    elif form is not None or width is not None:
        raise UsageError(Diagnostic("SF902", "--form and --width are for --to latex"))
    if isinstance(exporter, StateSpaceExporter):
        exporter = StateSpaceExporter(is_minimal=is_minimal)
    elif is_minimal:
        raise UsageError(Diagnostic("SF902", "--minimal is for --to state-space"))
    model = pipeline.load(spec)
    derived = pipeline.derive_all(model, pipeline.pick_pairs(model, tfs))
    if isinstance(exporter, LatexExporter):
        if output and _is_folder(output):
            return _write_fragments(exporter, model, derived, output, strict=strict)
    made = exporter.export(model, derived)
    for warning in made.warnings:
        note(f"warning: {warning}")
    if output:
        write_atomically(Path(output), made.text.encode())
        note(f"wrote {output}")
    else:
        click.echo(made.text, nl=False)
    return 4 if strict and made.warnings else 0


def _is_folder(output: str) -> bool:
    return output.endswith(("/", os.sep)) or Path(output).is_dir()


def _write_fragments(
    exporter: LatexExporter, model: Model, derived: Sequence[TransferFunction], folder: str, *, strict: bool
) -> int:
    from symflex.emit.write import write_folder

    files, warnings = exporter.export_files(model, derived)
    for warning in warnings:
        note(f"warning: {warning}")
    write_folder(Path(folder), files)
    note(f"wrote {len(files)} files to {folder}")
    return 4 if strict and warnings else 0
