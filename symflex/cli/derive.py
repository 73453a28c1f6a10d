"""``symflex derive``."""

from __future__ import annotations

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, note, outside, reporting, say, setting, terminal_width
from symflex.errors import Diagnostic, UsageError

LONG = 5_000
"""Terms beyond which a print is announced: it takes seconds, or minutes."""


def chosen_representation(representation: str, form: str | None) -> str:
    """Return the representation to derive in: a form belongs to one of them.

    Raises
    ------
    UsageError
        SF902 when the two options contradict each other.
    """
    if form is None:
        return representation
    wanted = "nested" if form == "nested" else "expanded"
    if representation not in ("auto", wanted):
        message = f"--form {form[:64]} is of the {wanted} representation, not the {representation} one"
        raise UsageError(Diagnostic("SF902", message))
    return wanted


@click.command("derive")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this transfer function; repeatable.")
@click.option(
    "--form",
    metavar="FORM",
    help="polynomial, monic, constant, factored, definitions, zpk, frequency; for beams, rods and delays "
    "also hyperbolic, krylov, vaughan; nested is that representation. The shortest symbolic form by default.",
)
@click.option(
    "--format", "format_", type=click.Choice(["text", "latex", "json"]), default="text", show_default=True
)
@click.option(
    "--width",
    metavar="ieee|a4|MM",
    help="Column that equations in LaTeX are broken to, in type of ten points; not broken by default.",
)
@click.option(
    "--representation",
    type=click.Choice(["auto", "expanded", "nested"]),
    default="auto",
    show_default=True,
    help="Quotients of polynomials, or straight-line programs of named sub-impedances; auto takes the latter "
    "where expansion would explode, and says so.",
)
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@click.option("--digits", type=click.IntRange(1, 1000), default=6, show_default=True, help="Digits of zpk.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tfs: tuple[str, ...],
    form: str | None,
    format_: str,
    width: str | None,
    representation: str,
    as_json: bool,
    digits: int,
) -> int:
    """Print the transfer functions of SPEC in closed form.

    All of them by default. JSON strings are in the specification's own expression grammar.
    """
    from symflex import pipeline
    from symflex.print.forms import print_forms, terms_to_print

    if width is not None and (as_json or format_ != "latex"):
        raise UsageError(Diagnostic("SF902", "--width is for --format latex"))
    column = None
    if width is not None:
        from symflex.print.latex import column_width

        column = column_width(width)
    model = load(spec, allow_outside, settings)
    derived, reason = pipeline.derive_as(
        model, pipeline.pick_pairs(model, tfs), chosen_representation(representation, form)
    )
    if reason:
        note(reason)
    for tf in derived:
        if (terms := terms_to_print(tf, form)) > LONG:
            note(f"printing {tf.name}: about {terms} terms; --representation nested is shorter")
    forms, sentences = print_forms(derived, form, digits)
    for sentence in sentences:
        note(sentence)
    entries = list(zip(derived, forms, strict=True))
    # Each format is imported where it is printed, so that a terminal does not wait for LaTeX.
    if as_json or format_ == "json":
        from symflex.print.json_format import derive_document

        emit_json(derive_document(entries))
    elif format_ == "latex":
        from symflex.print.latex import transfer_function_latex

        verdicts = (f"% {printed.stability.headline}\n" if printed.stability else "" for printed in forms)
        equations = (transfer_function_latex(tf, printed, width_mm=column) for tf, printed in entries)
        say("\n\n".join(map(str.__add__, verdicts, equations)))
    else:
        from symflex.print.text import derive_text

        room = terminal_width()
        say("\n".join(derive_text(tf, printed, room) for tf, printed in entries).rstrip("\n"))
    return 0
