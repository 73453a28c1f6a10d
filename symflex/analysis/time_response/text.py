"""A response in time as text: what it is, its largest values, and some of its points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb

from symflex.roots.root import decimals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.enclosed_response import EnclosedResponse, ImpulseAt

ROWS = 21
"""Of the table; all points are in the JSON and in files."""
SHOWN_DIGITS = 17
SHORT_DIGITS = 6
IMPULSES = ("an impulse", "the derivative of an impulse")


def response_text(found: EnclosedResponse, notes: Sequence[str] = ()) -> str:
    """Return a response as the command line prints it, with notes between its head and its table."""
    unit = f" [{found.unit}]" if found.unit else ""
    trust = "certified" if found.certified else f"NOT CERTIFIED: {found.reason}"
    lines = [f"{found.tf}   {found.title}{unit}, {trust}", ""]
    if found.impulses:
        lines += [f"  {_impulse(found, impulse)}" for impulse in found.impulses[:ROWS]]
        lines += _more(found.impulses)
    if found.jumps:
        lines += [f"  jumps by {_short(j.height)} at {_short(j.time)} s" for j in found.jumps[:ROWS]]
        lines += _more(found.jumps)
    lines += [f"  {note}" for note in notes]
    lines += [""] if found.impulses or found.jumps or notes else []
    count = len(found.enclosures)
    step = max(1, -(-(count - 1) // (ROWS - 1)))
    rows = [("t [s]", "value", "radius")]
    for i in range(0, count, step):
        rows.append((f"{found.times[i]:.6g}", *_told(found.enclosures[i], found.digits)))
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines += ["  " + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)) for row in rows]
    if step > 1:
        lines += ["", f"  every {step} of {count} points; --json and -o FILE.csv have them all"]
    return "\n".join(lines)


def _told(ball: arb, digits: int) -> tuple[str, str]:
    told = decimals(ball, arb(0), min(digits, SHOWN_DIGITS)).told
    return told.re, told.radius


def _short(ball: arb) -> str:
    return decimals(ball, arb(0), SHORT_DIGITS).told.re


def _impulse(found: EnclosedResponse, impulse: ImpulseAt) -> str:
    order = impulse.order
    what = IMPULSES[order] if order < len(IMPULSES) else f"derivative {order} of an impulse"
    return f"besides, at {_short(impulse.time)} s, {what} of weight {_short(impulse.weight)}"


def _more(shown: Sequence[object]) -> list[str]:
    return [f"  and {len(shown) - ROWS} more"] if len(shown) > ROWS else []
