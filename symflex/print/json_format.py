"""Transfer functions as JSON data; strings are in the specification language's own expression grammar."""

from __future__ import annotations

from collections.abc import Sequence
from graphlib import TopologicalSorter

from symflex.expressions import Name, format_expression, names
from symflex.print.forms import PrintedForm, hidden_expressions
from symflex.print.latex import inline_latex
from symflex.transfer import AnyTransferFunction

SCHEMA = "symflex.derive/1"


def derive_json(tf: AnyTransferFunction, form: PrintedForm) -> dict[str, object]:
    """Return one entry of ``transfer_functions``; ``hidden`` is None where that was not examined."""
    hidden = [{"factor": format_expression(e), "multiplicity": m} for e, m in hidden_expressions(tf)]
    closed = [[format_expression(left), format_expression(e)] for left, e in form.closed]
    lines = dict(form.where)
    needs = {
        n: [x.name for x in names(e) if isinstance(x, Name) and x.name in lines] for n, e in lines.items()
    }
    return {
        "tf": tf.name,
        "quantity": tf.quantity,
        "unit": tf.unit,
        "form": form.name,
        "num": format_expression(form.num),
        "den": format_expression(form.den),
        # Each line uses only those before it.
        "where": [[n, format_expression(lines[n])] for n in TopologicalSorter(needs).static_order()],
        "laws": [[name, format_expression(law)] for name, law in form.laws],
        "latex": inline_latex(tf, form),
        "hidden": hidden if tf.is_reduced else None,
        "stability": form.stability.to_json_dict() if form.stability else None,
        **({"closed": closed} if closed else {}),
        **({"approximation": form.approximation.facts} if form.approximation else {}),
    }


def derive_document(entries: Sequence[tuple[AnyTransferFunction, PrintedForm]]) -> dict[str, object]:
    """Return the document ``symflex derive --json`` prints."""
    return {"schema": SCHEMA, "transfer_functions": [derive_json(tf, form) for tf, form in entries]}
