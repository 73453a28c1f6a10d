"""An audit as JSON data; formulas are in the specification language's own grammar."""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING

from symflex.expressions import Expression, format_expression

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.audit.judge import Audit
    from symflex.audit.numeric import Comparison, Deviation

SCHEMA = "symflex.audit/1"


def audit_document(audits: Sequence[Audit]) -> dict[str, object]:
    """Return the document ``symflex audit --json`` prints."""
    return {"schema": SCHEMA, "audits": [audit_json(audit) for audit in audits]}


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
        "changes": [
            {
                "place": c.place,
                "printed": format_expression(c.printed),
                "derived": format_expression(c.derived),
            }
            for c in audit.changes
        ],
        "corrected": None
        if correction is None
        else {
            "expr": format_expression(correction.expression),
            "scale": _text(correction.scale),
            "where": _lines(correction.lines),
        },
        "derived": _text(audit.derived),
        "counterexample": _counterexample(audit.comparison),
        "agreed_points": None if audit.comparison is None else audit.comparison.agreed,
        "deviation": _deviation(audit.deviation),
        "laws": [asdict(law) for law in audit.laws],
    }


def _text(expression: Expression | None) -> str | None:
    return None if expression is None else format_expression(expression)


def _lines(lines: Sequence[tuple[str, Expression]]) -> list[list[str]]:
    return [[name, format_expression(expression)] for name, expression in lines]


def _counterexample(found: Comparison | None) -> dict[str, object] | None:
    if found is None or found.point is None or found.printed is None or found.derived is None:
        return None
    return {
        "s": {"re": str(found.point[0]), "im": str(found.point[1])},
        "printed": _complex(found.printed),
        "derived": _complex(found.derived),
    }


def _complex(value: complex) -> dict[str, float] | None:
    """Return a value, ``None`` when it is beyond the reach of a double."""
    return {"re": value.real, "im": value.imag} if isfinite(value.real) and isfinite(value.imag) else None


def _deviation(found: Deviation | None) -> dict[str, object] | None:
    if found is None:
        return None
    return {
        "band_hz": [float(limit) for limit in found.band],
        "magnitude_db": None if found.unbounded else found.magnitude_db,
        "magnitude_hz": found.magnitude_hz,
        "unbounded": found.unbounded,
        "phase_deg": found.phase_deg,
        "phase_hz": found.phase_hz,
    }
