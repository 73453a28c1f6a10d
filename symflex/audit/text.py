"""An audit as plain text for a terminal, and as JSON data with formulas in the specification's grammar."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING

from symflex.audit.judge import Audit
from symflex.audit.numeric import Comparison, Deviation
from symflex.errors.diagnostic import counted
from symflex.expressions import Expression, format_expression, quotient
from symflex.print.forms import print_form
from symflex.print.text import INDENT, WIDTH, hanging, wrapped

if TYPE_CHECKING:
    from symflex.audit.tables import TableAudit

NOTHING = 1e-30
NEGLIGIBLE = 1e-6  # decibels or degrees below which a deviation is rounding
VERDICTS = {
    "rounded": "right to the digits that it prints: proved",
    "equal": "proved equal to the derived function",
    "differs": "DIFFERS from the derived function: proved",
    "agrees": "agrees with the derived function to 50 digits at 40 points: NOT PROVED",
    "undecided": "NOT DECIDED: no value could be compared",
}

LONGEST_HEADING = 24  # characters of a column's or row's heading
TABLE_VERDICTS = {
    "right": "every entry is right to the last digit: proved",
    "rounded": "right, but badly rounded: proved",
    "wrong": "WRONG ENTRIES: proved",
    "undecided": "NOT DECIDED",
}
ENTRY_VERDICTS = {
    "rounded": "badly rounded",
    "wrong": "WRONG",
    "extra": "EXTRA: no root belongs to it",
    "missing": "MISSING in print",
    "undecided": "not decided",
}
READING_NOT_SAID = " (it does not say so; the most common reading that fits)"


def audit_text(audit: Audit, width: int = WIDTH) -> str:
    """Return an audit as lines of at most ``width`` columns where they can be broken."""
    verdict = VERDICTS[audit.verdict]
    if audit.verdict == "agrees" and audit.comparison is not None:
        verdict = verdict.replace("40 points", f"{audit.comparison.agreed} points")
    lines = [f"{audit.tf.name}   {verdict}"]
    if audit.published.source:
        lines += _filled(f"printed in: {audit.published.source}", width, INDENT)
    if audit.numeric:
        values = "the value" if len(audit.numeric) == 1 else "the values"
        said = f"with {values} of the model for {', '.join(audit.numeric)}"
        lines += _filled(said, width, INDENT)
    if audit.unread:
        label = "not read exactly" if audit.verdict == "differs" else "reason"
        lines += _filled(f"{label}: {audit.unread}", width, INDENT)
    if audit.verdict == "differs":
        lines += _difference(audit, width)
    return "\n".join(lines)


def _difference(audit: Audit, width: int) -> list[str]:
    changes, correction = audit.changes, audit.correction
    printed = _marked(audit.published.expression, [(c.place, c.printed) for c in changes], width)
    lines = ["", INDENT + "printed", *printed]
    lines += [*_where(audit.formula.lines, audit.published.scale, width), ""]
    if audit.ratio is not None:
        text = format_expression(audit.ratio)
        times = "minus" if text == "-1" else f"{text} times"
        lines += _filled(f"The printed formula is {times} the derived function (proved).", width, INDENT)
    elif correction is not None:
        lines.append(INDENT + "derived, in the same symbols")
        lines += _marked(correction.expression, [(c.place, c.derived) for c in changes], width)
        if correction.lines != audit.formula.lines or correction.scale != audit.published.scale:
            lines += _where(correction.lines, correction.scale, width)
        lines += ["", *_changes(audit), ""]
        these = "this change" if len(changes) == 1 else "these changes"
        lines += _filled(f"With {these} the printed formula is right (proved).", width, INDENT)
    elif not audit.taken:
        lines += [*_derived(audit, width), ""]
        lines.append(INDENT + "No small change was found that makes the printed formula right.")
    if audit.taken:
        lines += _filled(f"The formula as printed is right where {audit.taken} (proved).", width, INDENT)
    lines += ["", *_numbers(audit, width)]
    for sentence in audit.units:
        lines += ["", *_filled(f"units: {sentence}", width, INDENT)]
    if audit.laws:
        lines += ["", INDENT + "laws"]
        for law in audit.laws:
            head = f"{2 * INDENT}{'kept' if law.kept else 'VIOLATED':<10}"
            lines += _filled(f"{law.law} ({law.how}): {law.detail}", width, head, " " * len(head))
    return lines


def _derived(audit: Audit, width: int) -> list[str]:
    """Return the derived function where no small change to the print gives it."""
    if audit.derived is not None:
        return [INDENT + "derived, in the same symbols", *_marked(audit.derived, [], width)]
    form = print_form(audit.tf)
    ratio = _marked(quotient(form.num, form.den), [], width)
    return [INDENT + "derived", *ratio, *_where(form.where, None, width)]


def _marked(expression: Expression, parts: Sequence[tuple[str, Expression]], width: int) -> list[str]:
    """Return an expression in lines, with the parts that differ underlined where they are found."""
    lines = wrapped(expression, width - 2 * len(INDENT))
    marked = []
    for i, line in enumerate(lines):
        marked.append(2 * INDENT + line)
        marks = [" "] * len(line)
        for side, part in parts:
            text = format_expression(part)
            if side == "factor":
                if i == 0 and line.startswith(text):
                    marks[: len(text)] = "^" * len(text)
                continue
            # A minus that joins the term to a sum is set off by a space.
            for shown in (text, f"- {text.removeprefix('-')}") if text.startswith("-") else (text,):
                if sum(len(_places(other, shown)) for other in lines) == 1 and (
                    places := _places(line, shown)
                ):
                    marks[places[0] : places[0] + len(shown)] = "^" * len(shown)
        if "^" in marks:
            marked.append((2 * INDENT + "".join(marks)).rstrip())
    return marked


def _places(line: str, text: str) -> list[int]:
    """Return where a part stands in a line by itself."""
    alone = rf"(?<![\w.^])(?={re.escape(text)}(?![\w.^]))"
    return [match.start() for match in re.finditer(alone, line)]


def _where(lines: Sequence[tuple[str, Expression]], scale: Expression | None, width: int) -> list[str]:
    hanging_lines = []
    if scale is not None:
        hanging_lines += [2 * INDENT + line for line in hanging("times ", scale, width - 2 * len(INDENT))]
    for i, (name, expression) in enumerate(lines):
        head = f"{'where' if i == 0 else '':<6}{name} = "
        hanging_lines += [2 * INDENT + line for line in hanging(head, expression, width - 2 * len(INDENT))]
    return hanging_lines


def _changes(audit: Audit) -> list[str]:
    rows = [("", "printed", "derived")]
    rows += [(c.place, format_expression(c.printed), format_expression(c.derived)) for c in audit.changes]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    return [
        2 * INDENT + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _numbers(audit: Audit, width: int) -> list[str]:
    lines: list[str] = []
    comparison, deviation = audit.comparison, audit.deviation
    if comparison is not None and comparison.point is not None and comparison.derived is not None:
        s = complex(*map(float, comparison.point))
        printed, derived = _complex(comparison.printed), _complex(comparison.derived)
        apart = f", relative difference {comparison.gap:.2g}" if printed == derived else ""
        given = "".join(f", {name} = {float(value.nearly):g}" for name, value in comparison.values)
        text = f"at s = {_complex(s)} rad/s{given}: printed {printed}, derived {derived}{apart} (proved)"
        lines += _filled(text, width, INDENT)
    if deviation is not None:
        low, high = (f"{float(f):g}" for f in deviation.band)
        parts = []
        if deviation.unbounded:
            parts.append(f"without bound at {deviation.magnitude_hz:.4g} Hz")
        elif abs(deviation.magnitude_db) >= NEGLIGIBLE:
            parts.append(f"{deviation.magnitude_db:+.4g} dB at {deviation.magnitude_hz:.4g} Hz")
        if abs(deviation.phase_deg) >= NEGLIGIBLE:
            parts.append(f"{deviation.phase_deg:+.4g} deg at {deviation.phase_hz:.4g} Hz")
        shown = ", ".join(parts) or "none"
        lines += _filled(f"largest deviation from {low} to {high} Hz (measured): {shown}", width, INDENT)
    return lines


def _complex(value: complex | None) -> str:
    if value is None:
        return "none"
    if abs(value.imag) <= NOTHING * abs(value.real):
        return f"{value.real:.6g}"
    if abs(value.real) <= NOTHING * abs(value.imag):
        return f"{value.imag:.6g}j"
    return f"{value.real:.6g}{value.imag:+.6g}j"


def _filled(text: str, width: int, head: str, margin: str | None = None) -> list[str]:
    """Return words in lines of at most ``width`` columns; what stands in parentheses is kept together."""
    margin = head if margin is None else margin
    lines, line, empty = [], head, True
    for word in _words(text, width - len(margin)):
        if not empty and len(line) + 1 + len(word) > width:
            lines.append(line)
            line, empty = margin, True
        line += word if empty else f" {word}"
        empty = False
    return [*lines, line]


def _words(text: str, longest: int) -> list[str]:
    words: list[str] = []
    depth = 0
    for word in text.split(" "):
        if depth and len(words[-1]) + 1 + len(word) <= longest:
            words[-1] += f" {word}"
        else:
            words.append(word)
        depth += word.count("(") - word.count(")")
    return words


SCHEMA = "symflex.audit/1"


def audit_document(audits: Sequence[Audit], tables: Sequence[TableAudit] = ()) -> dict[str, object]:
    """Return the document ``symflex audit --json`` prints."""
    return {
        "schema": SCHEMA,
        "audits": [audit_json(audit) for audit in audits],
        "tables": [table_json(table) for table in tables],
    }


def table_text(found: TableAudit, width: int = WIDTH) -> str:
    """Return what was found about a table: its verdict, and every entry that is not right."""
    table = found.table
    lines = _filled(f"{table.name}   {TABLE_VERDICTS[found.verdict]}", width, "", INDENT)
    if table.source:
        lines += _filled(f"printed in: {table.source}", width, INDENT)
    if found.prints is not None:
        said = f"prints {found.reading} of the {table.of} of {'/'.join(table.tf)}"
        said += "" if table.prints is not None else READING_NOT_SAID
        lines += _filled(said, width, INDENT)
        lines += _filled(f"right to the last digit: {found.right} of {found.count} (proved)", width, INDENT)
    if found.reason:
        lines += _filled(f"not proved: {found.reason}", width, INDENT)
    unread = {e.row for e in found.entries if e.verdict == "unread"}
    if unread and found.prints is not None:
        said = ", ".join(table.rows[i - 1].heading or str(i) for i in sorted(unread))
        lines += _filled(f"not judged, as no common quantity fits: {said}", width, INDENT)
    rows = [("row", "column", "printed", "right", "")]
    for e in found.entries:
        said = ENTRY_VERDICTS.get(e.verdict, "")
        said += f", {counted(e.digits, 'digit')} right" if e.verdict == "wrong" and e.digits else ""
        if said and (found.prints is not None):
            heading = table.rows[e.row - 1].heading[:LONGEST_HEADING]
            rows.append((heading or str(e.row), str(e.column or "-"), e.printed or "-", e.right or "-", said))
    if len(rows) > 1:
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        cells = (
            "  ".join(c.rjust(w) for c, w in zip(r[:-1], widths, strict=False)) + f"  {r[-1]}" for r in rows
        )
        lines += ["", *(f"{INDENT}{line}".rstrip() for line in cells)]
    if found.slip:
        lines += ["", *_filled(f"conjecture: {found.slip}", width, INDENT)]
    return "\n".join(lines)


def table_json(found: TableAudit) -> dict[str, object]:
    """Return one entry of ``tables``."""
    return {
        "name": found.table.name,
        "tf": "/".join(found.table.tf),
        "of_roots": found.table.of,
        "source": found.table.source,
        "prints": found.reading or None,
        "verdict": found.verdict,
        "right": found.right,
        "of": found.count,
        "reason": found.reason or None,
        "entries": [
            {
                "row": e.row,
                "column": e.column,
                "printed": e.printed or None,
                "right": e.right or None,
                "right_digits": e.digits if e.verdict == "wrong" else None,
                "verdict": e.verdict,
            }
            for e in found.entries
        ],
        "slip": found.slip or None,
    }


def audit_json(audit: Audit) -> dict[str, object]:
    """Return one entry of ``audits``."""
    correction = audit.correction
    return {
        "tf": audit.tf.name,
        "source": audit.published.source,
        "verdict": audit.verdict,
        "certified": audit.is_certified,
        "unread": audit.unread or None,
        "printed": format_expression(audit.published.expression),
        "scale": _text(audit.published.scale),
        "where": _lines(audit.formula.lines),
        "ratio": _text(audit.ratio),
        "right_where": audit.taken or None,
        "changes": [
            {"place": c.place, "printed": _text(c.printed), "derived": _text(c.derived)}
            for c in audit.changes
        ],
        "corrected": correction
        and {
            "expr": _text(correction.expression),
            "scale": _text(correction.scale),
            "where": _lines(correction.lines),
        },
        "derived": _text(audit.derived),
        "counterexample": _counterexample(audit.comparison),
        "agreed_points": None if audit.comparison is None else audit.comparison.agreed,
        "deviation": _deviation(audit.deviation),
        "laws": [asdict(law) for law in audit.laws],
        "units": list(audit.units),
        "numeric": list(audit.numeric),
    }


def _text(expression: Expression | None) -> str | None:
    return None if expression is None else format_expression(expression)


def _lines(lines: Sequence[tuple[str, Expression]]) -> list[list[str]]:
    return [[name, format_expression(expression)] for name, expression in lines]


def _counterexample(shown: Comparison | None) -> dict[str, object] | None:
    if shown is None or shown.point is None or shown.printed is None or shown.derived is None:
        return None
    return {
        "s": {"re": str(shown.point[0]), "im": str(shown.point[1])},
        "values": {name: float(value.nearly) for name, value in shown.values} or None,
        "printed": _complex_json(shown.printed),
        "derived": _complex_json(shown.derived),
    }


def _complex_json(value: complex) -> dict[str, float] | None:
    """Return a value, ``None`` when it is beyond the reach of a double."""
    return {"re": value.real, "im": value.imag} if isfinite(value.real) and isfinite(value.imag) else None


def _deviation(deviation: Deviation | None) -> dict[str, object] | None:
    if deviation is None:
        return None
    plain = asdict(deviation)
    band = [float(limit) for limit in plain.pop("band")]
    return {"band_hz": band, **plain, "magnitude_db": None if deviation.unbounded else deviation.magnitude_db}
