"""The parameters of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.print.latex import model_labels, parameter_table
from symflex.print.latex.table import decimal_text
from symflex.print.mathml import label_mathml
from symflex.report.document import Code, Mathematics, Table, columns
from symflex.report.numerals import exponents, unit_text
from symflex.report.part import ChapterPart

if TYPE_CHECKING:
    from symflex.report.document import Cell
    from symflex.report.study import Study


def parameter_section(study: Study) -> ChapterPart | None:
    """Return the table of parameters: symbol, value in the unit it was given in, meaning."""
    model = study.model
    if not model.parameters:
        return None
    labels = model_labels(model)
    rows: list[tuple[Cell, ...]] = []
    for p in model.parameters:
        symbol = Mathematics(label_mathml(p.name, labels), labels[p.name])
        exact, unit = p.as_written()
        value = "symbolic" if exact is None else exponents(decimal_text(exact))
        rows.append(((symbol,), (Code(p.name),), (value,), (unit_text(unit),), (p.doc,)))
    heads = columns(("Symbol", "plain"), ("Name", "plain"), ("Value", "number"), ("Unit", "plain"), "Meaning")
    table = Table(heads, tuple(rows), latex=parameter_table(model))
    return ChapterPart("Parameters", (table,))
