"""``symflex derive``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from symflex.cli.report import emit_json, note, reporting, terminal_width
from symflex.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.forms import PrintedForm
    from symflex.transfer import TransferFunction


@click.command("derive")
@click.argument("spec", type=click.Path())
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option(
    "--form",
    metavar="FORM",
    help="polynomial, monic, factored, definitions, zpk, frequency; for beams, rods and delays also "
    "hyperbolic, krylov, vaughan. The shortest symbolic form by default.",
)
@click.option(
    "--format", "format_", type=click.Choice(["text", "latex", "json"]), default="text", show_default=True
)
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@click.option("--digits", type=click.IntRange(1, 1000), default=6, show_default=True, help="Digits of zpk.")
@reporting
def command(
    spec: str, *, tfs: tuple[str, ...], form: str | None, format_: str, as_json: bool, digits: int
) -> int:
    """Print the transfer functions of SPEC in closed form.

    All of them by default. JSON strings are in the specification's own expression grammar.
    """
    from symflex import pipeline
    from symflex.emit.json_format import derive_document
    from symflex.emit.latex import transfer_function_latex
    from symflex.emit.text import derive_text

    model = pipeline.load(spec)
    derived = pipeline.derive_all(model, pipeline.pick_pairs(model, tfs))
    entries = _in_form(derived, form, digits)
    if as_json or format_ == "json":
        emit_json(derive_document(entries))
    elif format_ == "latex":
        click.echo(
            "\n\n".join(transfer_function_latex(tf, printed, width_mm=None) for tf, printed in entries)
        )
    else:
        width = terminal_width()
        click.echo("\n".join(derive_text(tf, printed, width) for tf, printed in entries).rstrip("\n"))
    return 0


def _in_form(
    derived: Sequence[TransferFunction], form: str | None, digits: int
) -> list[tuple[TransferFunction, PrintedForm]]:
    """Return every function in the form asked for; those that lack it in their default, with a note.

    Raises
    ------
    UsageError
        SF902 when none of them has the form.
    """
    from symflex.emit.forms import print_form

    found: list[tuple[TransferFunction, PrintedForm]] = []
    refusals: list[UsageError] = []
    notes: list[str] = []
    for tf in derived:
        try:
            found.append((tf, print_form(tf, form, digits)))
        except UsageError as error:
            refusals.append(error)
            if len(refusals) == len(derived):
                raise refusals[0] from None
            printed = print_form(tf, None, digits)
            found.append((tf, printed))
            notes.append(f"{tf.name} has no {form} form: printed in its {printed.name} form")
    for line in notes:
        note(line)
    return found
