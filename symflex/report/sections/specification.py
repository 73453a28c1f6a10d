"""The model as it was given: a table of its parameters, and the text that all of the above follows from."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from symflex.print.latex import model_labels, parameter_table
from symflex.print.latex.table import decimal_text
from symflex.print.mathml import label_mathml
from symflex.report.document import Code, Listing, Mathematics, Table, columns, exponents, text, unit_text
from symflex.report.part import ChapterPart

if TYPE_CHECKING:
    from symflex.report.document import Cell
    from symflex.report.study import Study


def specification_section(study: Study) -> ChapterPart:
    """Return the specification as it was read, with its checksum."""
    content = study.text.encode()
    checksum = hashlib.sha256(content).hexdigest()
    name = f"data/{study.stem}.toml"
    return ChapterPart(
        "Specification",
        (text("SHA-256 ", Code(checksum)), Listing(f"{study.stem}.toml", study.text)),
        {name: content},
    )


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
