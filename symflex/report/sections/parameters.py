"""The parameters of a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.latex import model_labels, parameter_table
from symflex.emit.latex.table import decimal_text, rational_value
from symflex.emit.mathml import label_mathml
from symflex.report.document import Code, Mathematics, Table, columns, text
from symflex.report.numerals import exponents, unit_text
from symflex.report.part import Part

if TYPE_CHECKING:
    from symflex.report.document import Cell
    from symflex.report.study import Study


def parameter_section(study: Study) -> Part | None:
    """Return the table of parameters: symbol, value in SI units, meaning."""
    model = study.model
    if not model.parameters:
        return None
    labels = model_labels(model)
    rows: list[tuple[Cell, ...]] = []
    for p in model.parameters:
        symbol = Mathematics(label_mathml(p.name, labels), labels[p.name])
        value = "symbolic" if p.value is None else exponents(decimal_text(rational_value(p.value)))
        rows.append(((symbol,), (Code(p.name),), (value,), (unit_text(p.unit),), (p.doc,)))
    heads = columns(("Symbol", "plain"), ("Name", "plain"), ("Value", "number"), ("Unit", "plain"), "Meaning")
    table = Table(heads, tuple(rows), latex=parameter_table(model))
    return Part("Parameters", (text("In SI units."), table))
