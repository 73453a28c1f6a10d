"""Tables in HTML, with no more style than a notebook needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

TEXT: Final = "left"
NUMBER: Final = "right"

LONGEST: Final = 200
"""Rows that are shown; the number of those that are not is said."""


def html_table(
    head: Sequence[str], columns: Sequence[str], rows: Sequence[Sequence[str]], caption: str = ""
) -> str:
    """Return a table.

    Head, cells and caption are HTML; every column is :data:`TEXT` or :data:`NUMBER`.
    """
    lines = ["<table>"]
    if caption:
        lines.append(f'<caption style="text-align: left">{caption}</caption>')
    lines.append(f"<thead>{_row('th', head, columns)}</thead>")
    lines.append("<tbody>")
    lines += [_row("td", row, columns) for row in rows[:LONGEST]]
    if len(rows) > LONGEST:
        text = f"and {len(rows) - LONGEST} more"
        lines.append(f'<tr><td colspan="{len(head)}" style="text-align: left">{text}</td></tr>')
    return "\n".join((*lines, "</tbody>", "</table>"))


def _row(tag: str, cells: Sequence[str], columns: Sequence[str]) -> str:
    written = [
        f'<{tag} style="text-align: {side}">{cell}</{tag}>' for cell, side in zip(cells, columns, strict=True)
    ]
    return f"<tr>{''.join(written)}</tr>"
