"""HTML for notebooks: a model, its numbers and roots. No text of a model becomes markup or mathematics."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from symflex.model import ExactValue, Model
from symflex.print.forms import print_form
from symflex.print.latex import model_labels, notebook_latex
from symflex.print.latex.table import decimal_text
from symflex.print.roots import PAGE_COLUMNS, columns_for, one_of_each_pair, region_text, roots_of
from symflex.print.text import Passage
from symflex.transfer import BoundTransferFunction

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap


# MathJax and KaTeX look for mathematics within one text node: alone in a node, these begin none.
_ALONE: Final = {"$": "<span>$</span>", "\\": "<span>\\</span>"}


def escape_html(text: str) -> str:
    """Return plain text as HTML that shows it as an element's content, whatever it holds.

    White space becomes single spaces and what does not print vanishes, also what would turn the direction of
    writing. Dollar signs and backslashes stand in elements of their own, so that no typesetter of a page
    finds mathematics.
    """
    plain = " ".join(text.split())
    return "".join(_ALONE.get(c, html.escape(c)) for c in plain if c.isprintable())


TEXT: Final = "left"
NUMBER: Final = "right"
LONGEST: Final = 200  # rows that are shown; the number of those that are not is said


def html_table(
    head: Sequence[str], columns: Sequence[str], rows: Sequence[Sequence[str]], caption: str = ""
) -> str:
    """Return a table. Head, cells and caption are HTML; every column is :data:`TEXT` or :data:`NUMBER`."""
    lines = ["<table>"]
    if caption:
        lines.append(f'<caption style="text-align: left">{caption}</caption>')
    lines.append(f"<thead>{_html_row('th', head, columns)}</thead>")
    lines.append("<tbody>")
    lines += [_html_row("td", row, columns) for row in rows[:LONGEST]]
    if len(rows) > LONGEST:
        text = f"and {len(rows) - LONGEST} more"
        lines.append(f'<tr><td colspan="{len(head)}" style="text-align: left">{text}</td></tr>')
    return "\n".join((*lines, "</tbody>", "</table>"))


def _html_row(tag: str, cells: Sequence[str], columns: Sequence[str]) -> str:
    written = [
        f'<{tag} style="text-align: {side}">{cell}</{tag}>' for cell, side in zip(cells, columns, strict=True)
    ]
    return f"<tr>{''.join(written)}</tr>"


NUMERIC: Final = re.compile(r"[-+]?[-+0-9.]|[-+]?inf|$")
"""How a cell of numbers begins; an empty one is among them."""
MINUS: Final = re.compile(r"(?<![\w.])-(?=[\d.i])|(?<=\de)-(?=\d)")


def passages_html(passages: Iterable[Passage]) -> str:
    """Return the output of a command as paragraphs and tables."""
    parts = []
    for passage in passages:
        outer = min((_indent(line) for line in passage.lines), default=0)
        said = "<br>".join(
            ("&emsp;" if _indent(line) > outer else "") + escape_html(line) for line in passage.lines
        )
        if not passage.rows:
            parts.append(f"<p>{said}</p>")
            continue
        head, *body = passage.rows if passage.has_head else [("",) * len(passage.rows[0]), *passage.rows]
        sides = [NUMBER if all(map(NUMERIC.match, cells)) else TEXT for cells in zip(*body, strict=True)]
        signs = [[c.replace("+-", "\u00b1").replace("-+", "\u2213") for c in row] for row in (head, *body)]
        cells = [[escape_html(MINUS.sub("\u2212", cell)) for cell in row] for row in signs]
        parts.append(html_table(cells[0], sides or [TEXT] * len(head), cells[1:], said))
    return "\n".join(parts)


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


LONGEST_TEXT: Final = 400
MOST_FUNCTIONS: Final = 60


def model_html(model: Model) -> str:
    """Return a model as HTML; symbols of parameters are mathematics between dollar signs."""
    title = _cut(model.title) or "Model without title"
    lines = [f"<div><strong>{title}</strong>"]
    if model.source:
        lines.append(f"<div>{_cut(model.source)}</div>")
    if model.settable:
        labels = model_labels(model)
        rows = [(*_valued(p.name, labels, *p.as_written()), _cut(p.doc)) for p in model.settable]
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


def _valued(
    name: str, labels: Mapping[str, str], value: ExactValue | None, unit: str
) -> tuple[str, str, str, str]:
    """Return symbol, name, value and unit of a parameter."""
    return (
        f"${escape_label(labels[name])}$" if name in labels else "",
        f"<code>{escape_html(name)}</code>",
        "symbolic" if value is None else decimal_text(value),
        escape_html("" if unit == "1" else unit),
    )


def _cut(text: str) -> str:
    return escape_html(text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}\u2026")


def bound_html(bound: BoundTransferFunction) -> str:
    """Return a transfer function with numbers as HTML, in the shortest symbolic form."""
    tf = bound.source
    parameters = {p.name: p for p in tf.model.parameters}
    labels = model_labels(tf.model)
    formula = notebook_latex(tf, print_form(tf, is_read=True))
    lines = [f"<div><div>{escape_html(bound.name)}, {escape_html(tf.quantity)}</div>"]
    if formula is not None:
        lines.append(f"<div>$\\displaystyle {escape_label(formula)}$</div>")
    rows = [
        _valued(name, labels, value if shown is None else shown, unit)
        for name, value in bound.values
        for shown, unit in (parameters[name].as_written(value) if name in parameters else (value, ""),)
    ]
    if rows:
        lines.append(html_table(("Symbol", "Name", "Value", "Unit"), (TEXT, TEXT, NUMBER, TEXT), rows))
    return "\n".join((*lines, "</div>"))


DIGITS: Final = 10  # significant digits shown at most; fewer where the enclosure does not certify them


def roots_html(located: PoleZeroMap) -> str:
    """Return poles, zeros and hidden modes as a table with the certificate above it."""
    certificate = located.certificate
    status = "certified" if certificate.certified else f"NOT CERTIFIED: {certificate.reason}"
    count = f"{certificate.found} of {certificate.counted} roots enclosed"
    caption = f"<strong>{escape_html(located.tf)}</strong>, {escape_html(status)}: {count}"
    for said in filter(None, (located.verdict.sentence, located.verdict.hidden_motion)):
        caption += f"<br>{escape_html(said)}"
    if shown := region_text(located.region):
        caption += f"<br>shown: {escape_html(shown)}"
    if located.excluded:
        caption += f"<br>{len(located.excluded)} neighbourhoods where roots accumulate are left out"
    columns = columns_for(PAGE_COLUMNS, located.all_poles + located.zeros)
    rows = []
    for kind, word in (("poles", "pole"), ("zeros", "zero"), ("hidden", "hidden")):
        for entry in one_of_each_pair(roots_of(located, kind)):
            mark = ("" if entry.root.certified else " ?") + (" |" if entry.root.on_boundary else "")
            cells = entry.cells(columns, DIGITS, "&pm;")
            rows.append((f"{word}{mark}", *(cell.replace("-", "\u2212") for cell in cells)))
    head = ("", *(column.head for column in columns))
    return html_table(head, (TEXT, *[NUMBER] * len(columns)), rows, caption)
