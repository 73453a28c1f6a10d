"""``symflex export``."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.derive import chosen_representation
from symflex.cli.reporting import load, note, outside, reporting, say, setting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.codegen.export import Exporter
    from symflex.codegen.targets.latex import LatexExporter
    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction


class ExportCommand(click.Command):
    """A command whose help lists the targets."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the targets and what they are."""
        from symflex.codegen.exporters import EXPORTERS

        with formatter.section("Targets"):
            formatter.write_dl([(name, exporter.summary) for name, exporter in EXPORTERS.items()])


@click.command("export", cls=ExportCommand)
@click.argument("spec", type=click.Path())
@outside
@click.option("--to", "target", required=True, metavar="TARGET", help="One of the targets below.")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option("--form", metavar="FORM", help="latex: form of the functions, as for derive.")
@click.option("--width", metavar="ieee|a4|MM", help="latex: width of the column; a4 (170 mm) by default.")
@click.option("--no-figures", "no_figures", is_flag=True, help="latex: a folder without figures.")
@click.option(
    "--representation",
    type=click.Choice(["auto", "expanded", "nested"]),
    default="auto",
    show_default=True,
    help="Quotients of polynomials or nested expressions, as for derive.",
)
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@click.option("--minimal", "is_minimal", is_flag=True, help="state-space: without hidden states.")
@click.option("--strict", is_flag=True, help="Exit with 4 when the verified accuracy falls short.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    target: str,
    tfs: tuple[str, ...],
    form: str | None,
    width: str | None,
    no_figures: bool,
    representation: str,
    output: str | None,
    is_minimal: bool,
    strict: bool,
) -> int:
    """Write the transfer functions of SPEC for another program.

    Numeric code is verified against ball arithmetic before it is written; the worst error stands in its
    documentation. A target that consists of several files, as c does with its header, writes them beside
    the one named with -o; on standard output it is one file.

    With --to latex and -o FOLDER/ every transfer function, table and figure becomes a file for a paper to
    input, and document.tex inputs them all.

    With --to state-space all of them get one realisation, whose states are displacements, velocities,
    currents and the like of the model. Exit code 3 says that there is none: beams, rods and delays have
    infinitely many states, and what has more zeros than poles has no output equation.
    """
    from symflex import pipeline
    from symflex.codegen.exporters import EXPORTERS
    from symflex.codegen.program import identifiers
    from symflex.codegen.targets.latex import LatexExporter
    from symflex.files.write import check_folder, check_writable, write_atomically

    if target not in EXPORTERS:
        hint = nearest(target, EXPORTERS) or "targets: " + ", ".join(EXPORTERS)
        raise UsageError(Diagnostic("SF902", f"there is no export target '{target[:64]}'", None, hint))
    exporter = _chosen(EXPORTERS[target], form, width, no_figures=no_figures, is_minimal=is_minimal)
    is_folder = isinstance(exporter, LatexExporter) and bool(output) and _is_folder(output or "")
    if output:
        (check_folder if is_folder else check_writable)(Path(output))
    model = load(spec, allow_outside, settings)
    derived, reason = pipeline.derive_as(
        model, pipeline.pick_pairs(model, tfs), chosen_representation(representation, form)
    )
    if reason:
        note(reason)
    if isinstance(exporter, LatexExporter) and output and is_folder:
        return _write_fragments(exporter, model, derived, output, strict=strict)
    stem = Path(output).stem if output else identifiers({"": Path(spec).stem}, ())[""]
    made = exporter.export(model, derived, stem, is_alone=not output)
    for warning in made.warnings:
        note(f"warning: {warning}")
    if output:
        path = Path(output)
        files = {path: made.text} | {path.with_suffix(s): text for s, text in made.companions.items()}
        if len(files) <= len(made.companions):
            message = f"'{output}' is the name of a file that belongs beside it"
            hint = f"end its name with {EXPORTERS[target].suffix}"
            raise UsageError(Diagnostic("SF902", message, None, hint))
        for file, text in files.items():
            write_atomically(file, text.encode())
            note(f"wrote {file}")
    else:
        say(made.text, nl=False)
    return 4 if strict and made.warnings else 0


def _chosen(
    exporter: Exporter, form: str | None, width: str | None, *, no_figures: bool, is_minimal: bool
) -> Exporter:
    """Return an exporter with the options that are its own."""
    from symflex.codegen.targets.latex import LatexExporter
    from symflex.codegen.targets.state_space import StateSpaceExporter
    from symflex.print.latex import column_width

    if isinstance(exporter, LatexExporter):
        column = column_width(width or "a4")
        exporter = replace(exporter, form=form, width_mm=column, has_figures=not no_figures)
    elif form is not None or width is not None or no_figures:
        raise UsageError(Diagnostic("SF902", "--form, --width and --no-figures are for --to latex"))
    if isinstance(exporter, StateSpaceExporter):
        exporter = replace(exporter, is_minimal=is_minimal)
    elif is_minimal:
        raise UsageError(Diagnostic("SF902", "--minimal is for --to state-space"))
    return exporter


def _is_folder(output: str) -> bool:
    return output.endswith(("/", os.sep)) or Path(output).is_dir()


def _write_fragments(
    exporter: LatexExporter,
    model: Model,
    derived: Sequence[AnyTransferFunction],
    folder: str,
    *,
    strict: bool,
) -> int:
    from symflex.files.write import write_folder

    files, warnings = exporter.export_files(model, derived)
    for warning in warnings:
        note(f"warning: {warning}")
    write_folder(Path(folder), files)
    note(f"wrote {len(files)} files to {folder}")
    return 4 if strict and warnings else 0
