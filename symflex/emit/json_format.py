"""Transfer functions as JSON data; strings are in the specification language's own expression grammar."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms import hidden_expressions
from symflex.emit.latex import inline_latex
from symflex.expressions import format_expression

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.forms import PrintedForm
    from symflex.transfer import TransferFunction

SCHEMA = "symflex.derive/1"


def derive_json(tf: TransferFunction, form: PrintedForm) -> dict[str, object]:
    """Return one entry of ``transfer_functions``."""
    return {
        "tf": tf.name,
        "quantity": tf.quantity,
        "unit": tf.unit,
        "form": form.name,
        "num": format_expression(form.num),
        "den": format_expression(form.den),
        "where": [[name, format_expression(e)] for name, e in form.where],
        "laws": [[name, format_expression(law)] for name, law in form.laws],
        "latex": inline_latex(tf, form),
        "hidden": [{"factor": format_expression(e), "multiplicity": m} for e, m in hidden_expressions(tf)],
    }


def derive_document(entries: Sequence[tuple[TransferFunction, PrintedForm]]) -> dict[str, object]:
    """Return the document ``symflex derive --json`` prints."""
    return {"schema": SCHEMA, "transfer_functions": [derive_json(tf, form) for tf, form in entries]}
