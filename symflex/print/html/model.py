"""A model in HTML: its title, its parameters and the names of its transfer functions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.print.html.table import NUMBER, TEXT, html_table
from symflex.print.html.text import escape_html
from symflex.print.latex import model_labels
from symflex.print.latex.table import decimal_text

if TYPE_CHECKING:
    from symflex.model import Model, ModelParameter

LONGEST_TEXT: Final = 400
MOST_FUNCTIONS: Final = 60


def model_html(model: Model) -> str:
    """Return a model as HTML; symbols of parameters are mathematics between dollar signs."""
    title = _cut(model.title) or "Model without title"
    lines = [f"<div><strong>{title}</strong>"]
    if model.source:
        lines.append(f"<div>{_cut(model.source)}</div>")
    if model.parameters:
        labels = model_labels(model)
        rows = [
            (
                f"${escape_label(labels[p.name])}$",
                f"<code>{escape_html(p.name)}</code>",
                *_written(p),
                _cut(p.doc),
            )
            for p in model.parameters
        ]
        head = ("Symbol", "Name", "Value", "Unit", "Meaning")
        lines.append(html_table(head, (TEXT, TEXT, NUMBER, TEXT, TEXT), rows))
    names = [f"<code>{escape_html('/'.join(pair))}</code>" for pair in model.transfer_functions]
    more = f" and {len(names) - MOST_FUNCTIONS} more" if len(names) > MOST_FUNCTIONS else ""
    if names:
        lines.append(f"<div>Transfer functions: {', '.join(names[:MOST_FUNCTIONS])}{more}</div>")
    return "\n".join((*lines, "</div>"))


def escape_label(latex: str) -> str:
    """Return a label, sound LaTeX already, as the text of an HTML element."""
    return latex.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _written(parameter: ModelParameter) -> tuple[str, str]:
    value, unit = parameter.as_written()
    shown = "symbolic" if value is None else decimal_text(value)
    return shown, escape_html("" if unit == "1" else unit)


def _cut(text: str) -> str:
    return escape_html(text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}\u2026")
