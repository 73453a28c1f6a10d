"""``symflex export``."""

from __future__ import annotations

from pathlib import Path

import click

from symflex.cli.report import note, reporting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest


class ExportCommand(click.Command):
    """A command whose help lists the targets."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the targets and what they are."""
        from symflex.emit.exporters import EXPORTERS

        with formatter.section("Targets"):
            formatter.write_dl([(name, exporter.summary) for name, exporter in EXPORTERS.items()])


@click.command("export", cls=ExportCommand)
@click.argument("spec", type=click.Path())
@click.option("--to", "target", required=True, metavar="TARGET", help="One of the targets below.")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option("-o", "--output", type=click.Path(), help="File to write; standard output by default.")
@click.option("--strict", is_flag=True, help="Exit with 4 when the verified accuracy falls short.")
@reporting
def command(spec: str, *, target: str, tfs: tuple[str, ...], output: str | None, strict: bool) -> int:
    """Write the transfer functions of SPEC for another program.

    Numeric code is verified against ball arithmetic before it is written; the worst error stands in its
    documentation.
    """
    from symflex import pipeline
    from symflex.emit.exporters import EXPORTERS
    from symflex.emit.write import write_atomically

    if target not in EXPORTERS:
        hint = nearest(target, EXPORTERS) or "targets: " + ", ".join(EXPORTERS)
        raise UsageError(Diagnostic("SF902", f"there is no export target '{target[:64]}'", None, hint))
    model = pipeline.load(spec)
    derived = pipeline.derive_all(model, pipeline.pick_pairs(model, tfs))
    made = EXPORTERS[target].export(model, derived)
    for warning in made.warnings:
        note(f"warning: {warning}")
    if output:
        write_atomically(Path(output), made.text.encode())
        note(f"wrote {output}")
    else:
        click.echo(made.text, nl=False)
    return 4 if strict and made.warnings else 0
