"""Poles and zeros in HTML."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.print.html.table import NUMBER, TEXT, html_table
from symflex.print.html.text import escape_html
from symflex.print.latex.table import damping_text, frequency_text, one_of_each_pair
from symflex.print.text import region_text

if TYPE_CHECKING:
    from symflex.print.latex.table import PrintedRoot
    from symflex.roots import PoleZeroMap

DIGITS: Final = 10
"""Significant digits shown at most; fewer where the enclosure does not certify them."""

HEAD: Final = (
    "",
    "Re s [rad/s]",
    "Im s [rad/s]",
    "radius [rad/s]",
    "frequency [Hz]",
    "damping ratio",
    "multiplicity",
)


def roots_html(found: PoleZeroMap) -> str:
    """Return poles, zeros and hidden modes as a table with the certificate above it."""
    certificate = found.certificate
    status = "certified" if certificate.certified else f"NOT CERTIFIED: {certificate.reason}"
    count = f"{certificate.found} of {certificate.counted} roots enclosed"
    caption = f"<strong>{escape_html(found.tf)}</strong>, {escape_html(status)}: {count}"
    caption += f"<br>{escape_html(found.verdict.sentence)}"
    if shown := region_text(found.region):
        caption += f"<br>shown: {escape_html(shown)}"
    if found.excluded:
        caption += f"<br>{len(found.excluded)} neighbourhoods where roots accumulate are left out"
    rows = []
    for word, roots in (
        ("pole", found.all_poles),
        ("zero", found.zeros),
        ("hidden", tuple(h.root for h in found.hidden)),
    ):
        rows += [_row(word, entry) for entry in one_of_each_pair(roots)]
    return html_table(HEAD, (TEXT, *[NUMBER] * (len(HEAD) - 1)), rows, caption)


def _row(word: str, entry: PrintedRoot) -> tuple[str, ...]:
    root = entry.root
    printed = root.decimal(DIGITS)
    mark = ("" if root.certified else " ?") + (" |" if root.on_boundary else "")
    sign = "&pm;" if entry.is_pair else ""
    return (
        f"{word}{mark}",
        printed.re.replace("-", "\u2212"),
        sign + printed.im.replace("-", "\u2212"),
        printed.radius,
        frequency_text(root, DIGITS),
        damping_text(root, DIGITS),
        str(root.multiplicity),
    )
