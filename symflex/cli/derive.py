"""``symflex derive``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import emit_json, note, say, terminal_width
from symflex.errors import Diagnostic, UsageError
from symflex.options import DeriveOptions

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


@command_of("derive", DeriveOptions)
def command(spec: Specification, given: DeriveOptions) -> int:
    """Print the transfer functions of SPEC in closed form.

    All of them by default. JSON strings are in the specification's own expression grammar.
    """
    from symflex import pipeline
    from symflex.print.forms import print_forms, terms_to_print

    if given.width is not None and (given.as_json or given.format != "latex"):
        raise UsageError(Diagnostic("SF902", "--width is for --format latex"))
    column = None
    if given.width is not None:
        from symflex.print.latex import column_width

        column = column_width(given.width)
    model = spec.load()
    derived, reason = pipeline.derive_as(
        model, pipeline.pick_pairs(model, given.tfs), chosen_representation(given.representation, given.form)
    )
    if reason:
        note(reason)
    for tf in derived:
        if (terms := terms_to_print(tf, given.form)) > LONG:
            note(f"printing {tf.name}: about {terms} terms; --representation nested is shorter")
    forms, sentences = print_forms(derived, given.form, given.digits)
    for sentence in sentences:
        note(sentence)
    entries = list(zip(derived, forms, strict=True))
    # Each format is imported where it is printed, so that a terminal does not wait for LaTeX.
    if given.as_json or given.format == "json":
        from symflex.print.json_format import derive_document

        emit_json(derive_document(entries))
    elif given.format == "latex":
        from symflex.print.latex import transfer_function_latex

        verdicts = (f"% {printed.stability.headline}\n" if printed.stability else "" for printed in forms)
        equations = (transfer_function_latex(tf, printed, width_mm=column) for tf, printed in entries)
        say("\n\n".join(map(str.__add__, verdicts, equations)))
    else:
        from symflex.print.text import derive_text

        room = terminal_width()
        say("\n".join(derive_text(tf, printed, room) for tf, printed in entries).rstrip("\n"))
    return 0
