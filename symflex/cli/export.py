"""``symflex export``."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.command import Specification, command_of
from symflex.cli.derive import chosen_representation
from symflex.cli.reporting import note, say
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.options import ExportOptions

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


@command_of("export", ExportOptions, cls=ExportCommand)
def command(spec: Specification, given: ExportOptions) -> int:
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
    from symflex.codegen.program.user_text import identifiers
    from symflex.codegen.targets.latex import LatexExporter
    from symflex.files.write import check_folder, check_writable, write_atomically

    if given.target not in EXPORTERS:
        hint = nearest(given.target, EXPORTERS) or "targets: " + ", ".join(EXPORTERS)
        raise UsageError(Diagnostic("SF902", f"there is no export target '{given.target[:64]}'", None, hint))
    exporter = _chosen(EXPORTERS[given.target], given)
    is_folder = isinstance(exporter, LatexExporter) and bool(given.output) and _is_folder(given.output or "")
    if given.output:
        (check_folder if is_folder else check_writable)(Path(given.output))
    model = spec.load()
    derived, reason = pipeline.derive_as(
        model, pipeline.pick_pairs(model, given.tfs), chosen_representation(given.representation, given.form)
    )
    if reason:
        note(reason)
    if isinstance(exporter, LatexExporter) and given.output and is_folder:
        return _write_fragments(exporter, model, derived, given.output, strict=given.strict)
    stem = Path(given.output).stem if given.output else identifiers({"": Path(spec.path).stem}, ())[""]
    made = exporter.export(model, derived, stem, is_alone=not given.output)
    for warning in made.warnings:
        note(f"warning: {warning}")
    if given.output:
        path = Path(given.output)
        files = {path: made.text} | {path.with_suffix(s): text for s, text in made.companions.items()}
        if len(files) <= len(made.companions):
            message = f"'{given.output}' is the name of a file that belongs beside it"
            hint = f"end its name with {EXPORTERS[given.target].suffix}"
            raise UsageError(Diagnostic("SF902", message, None, hint))
        for file, text in files.items():
            write_atomically(file, text.encode())
            note(f"wrote {file}")
    else:
        say(made.text, nl=False)
    return 4 if given.strict and made.warnings else 0


def _chosen(exporter: Exporter, given: ExportOptions) -> Exporter:
    """Return an exporter with the options that are its own."""
    from symflex.codegen.state_space import StateSpaceExporter
    from symflex.codegen.targets.latex import LatexExporter
    from symflex.print.latex import column_width

    if isinstance(exporter, LatexExporter):
        column = column_width(given.width or "a4")
        exporter = replace(exporter, form=given.form, width_mm=column, has_figures=not given.no_figures)
    elif given.form is not None or given.width is not None or given.no_figures:
        raise UsageError(Diagnostic("SF902", "--form, --width and --no-figures are for --to latex"))
    if isinstance(exporter, StateSpaceExporter):
        exporter = replace(exporter, is_minimal=given.is_minimal)
    elif given.is_minimal:
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
