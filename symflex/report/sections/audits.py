"""What a publication printed, against what is derived."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from symflex.audit.json_format import audit_document
from symflex.audit.text import VERDICTS
from symflex.print.label import labels_of
from symflex.print.latex import TEXT_WIDTH_MM, formula_latex, model_labels, ratio_latex
from symflex.print.mathml import (
    WIDEST_FRACTION,
    MathmlWriter,
    MathRow,
    label_mathml,
    mathml_expression,
    ratio_mathml,
)
from symflex.report.document import (
    Badge,
    DisplayedFormula,
    Mathematics,
    Section,
    Table,
    columns,
    mathematics,
    text,
)
from symflex.report.part import ChapterPart
from symflex.report.sections.equations import ratio_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.audit import Audit
    from symflex.expressions import Expression
    from symflex.report.document import Block
    from symflex.report.study import Study

WORDS: Final = {
    "equal": ("right as printed (proved)", "good"),
    "differs": ("not right as printed (proved)", "bad"),
    "agrees": ("agrees at all points tried (not proved)", "fair"),
    "undecided": ("not decided", "fair"),
}


def audit_section(study: Study) -> ChapterPart | None:
    """Return every printed formula with its verdict, and the smallest change that makes a wrong one right."""
    if not study.audits:
        return None
    blocks = tuple(
        Section(
            audit.tf.name,
            _of(audit),
            f"{study.stem}-printed-{i + 1}",
            Mathematics(ratio_line(audit.tf), ratio_latex(audit.tf)),
        )
        for i, audit in enumerate(study.audits)
    )
    data = json.dumps(audit_document(study.audits), indent=1, ensure_ascii=True).encode()
    return ChapterPart("Printed formulas", blocks, {f"data/{study.stem}_audit.json": data})


def _of(audit: Audit) -> tuple[Block, ...]:
    word, tone = WORDS[audit.verdict]
    source = f", printed in {audit.published.source}" if audit.published.source else ""
    blocks: list[Block] = [text(Badge(word, tone), f"{source}:")]  # type: ignore[arg-type]
    where = audit.formula.lines
    scale = audit.published.scale
    blocks.append(_formula(audit, audit.published.expression, where, f"{audit.tf.name} as printed"))
    if scale is not None:
        blocks.append(
            text("times ", mathematics(scale, audit.tf.model), ", a scale that the print leaves out.")
        )
    if audit.verdict == "equal":
        return tuple(blocks)
    if audit.verdict != "differs":
        blocks.append(text(f"The formula {VERDICTS[audit.verdict]}."))
    if audit.ratio is not None:
        blocks.append(
            text("It is the derived function times ", mathematics(audit.ratio, audit.tf.model), ".")
        )
    if audit.correction is not None:
        blocks.append(text("Right, in the same symbols:"))
        lines = audit.correction.lines if audit.correction.lines != where else ()
        blocks.append(_formula(audit, audit.correction.expression, lines, f"{audit.tf.name}, corrected"))
    if audit.changes:
        rows = tuple(
            ((c.place,), (_mathematics(audit, c.printed),), (_mathematics(audit, c.derived),))
            for c in audit.changes
        )
        blocks.append(Table(columns("Where", "Printed", "Right"), rows, "What differs"))
    deviation = audit.deviation
    if deviation is not None:
        low, high = (f"{float(f):g}" for f in deviation.band)
        size = "grows without bound" if deviation.unbounded else f"is {deviation.magnitude_db:+.4g} dB"
        blocks.append(
            text(
                f"The largest deviation of the magnitude from {low} to {high} Hz {size} at "
                f"{deviation.magnitude_hz:.4g} Hz, that of the phase is {deviation.phase_deg:+.4g}° at "
                f"{deviation.phase_hz:.4g} Hz (measured)."
            )
        )
    if audit.laws:
        laws = tuple(
            (
                (law.law,),
                (Badge("kept", "good") if law.kept else Badge("violated", "bad"),),
                (f"{law.detail} ({law.how})",),
            )
            for law in audit.laws
        )
        blocks.append(Table(columns(("Law", "plain"), ("", "plain"), "Why"), laws, "Structural laws"))
    return tuple(blocks)


def _labels(audit: Audit) -> dict[str, str]:
    labels = model_labels(audit.tf.model)
    return labels_of([(name, "") for name, _ in audit.formula.lines if name not in labels], labels)


def _mathematics(audit: Audit, expression: Expression) -> Mathematics:
    from symflex.print.latex import latex_expression

    labels = _labels(audit)
    return Mathematics(mathml_expression(expression, labels), latex_expression(expression, labels))


def _formula(
    audit: Audit, expression: Expression, where: Sequence[tuple[str, Expression]], name: str
) -> DisplayedFormula:
    labels = _labels(audit)
    writer = MathmlWriter(labels)
    is_narrow = writer.width(expression) <= WIDEST_FRACTION
    pieces = (writer.piece(expression).markup,) if is_narrow else writer.pieces(expression)
    rows = [MathRow(ratio_mathml(audit.tf), pieces)]
    rows += [MathRow(label_mathml(n, labels), writer.pieces(e), is_where=True) for n, e in where]
    latex = formula_latex(ratio_latex(audit.tf), expression, where, labels, width_mm=TEXT_WIDTH_MM)
    return DisplayedFormula(tuple(rows), latex, name)
