"""A transfer function with numbers in HTML: the formula, and the value of each symbol in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.print.forms import print_form
from symflex.print.html.model import escape_label
from symflex.print.html.table import NUMBER, TEXT, html_table
from symflex.print.html.text import escape_html
from symflex.print.latex import model_labels, notebook_latex
from symflex.print.latex.table import decimal_text

if TYPE_CHECKING:
    from symflex.transfer import BoundTransferFunction


def bound_html(bound: BoundTransferFunction) -> str:
    """Return a transfer function with numbers as HTML, in the shortest symbolic form."""
    tf = bound.source
    parameters = {p.name: p for p in tf.model.parameters}
    labels = model_labels(tf.model)
    formula = notebook_latex(tf, print_form(tf))
    lines = [f"<div><div>{escape_html(bound.name)}, {escape_html(tf.quantity)}</div>"]
    if formula is not None:
        lines.append(f"<div>$\\displaystyle {escape_label(formula)}$</div>")
    rows = [
        (
            f"${escape_label(labels[name])}$" if name in labels else "",
            f"<code>{escape_html(name)}</code>",
            decimal_text(value if shown is None else shown),
            escape_html("" if unit == "1" else unit),
        )
        for name, value in bound.values
        for shown, unit in (parameters[name].as_written(value) if name in parameters else (value, ""),)
    ]
    if rows:
        lines.append(html_table(("Symbol", "Name", "Value", "Unit"), (TEXT, TEXT, NUMBER, TEXT), rows))
    return "\n".join((*lines, "</div>"))
