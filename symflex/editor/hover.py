"""What a name of a specification is, in a few lines of Markdown.

Input: a document and an offset. Output: the value and unit of a parameter, the formula of a definition, the
transfer functions of an input or output, the elements at a node, the summary of a type; or nothing.
"""

from __future__ import annotations

import re

from symflex import pipeline
from symflex.editor.document import Occurrence, OpenDocument
from symflex.errors import SymflexError
from symflex.expressions import format_expression
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.model import Model

_WORD = re.compile(r"\w+")
MOST_LETTERS = 3_000  # of a formula that is shown


def hover(document: OpenDocument, offset: int) -> str | None:
    """Return what stands at a place, as Markdown; None where there is nothing to say."""
    name = document.at(offset)
    if name is not None and document.model is not None:
        said = _of_name(document.model, name)
        if said:
            return said
    word = next((m[0] for m in _WORD.finditer(document.source.text) if m.start() <= offset <= m.end()), "")
    for registry in (ELEMENTS, BLOCKS):
        if word in registry:
            return f"**{word}**: {registry[word].summary}"
    return None


def _of_name(model: Model, name: Occurrence) -> str:
    if name.is_node:
        touching = [
            e.name for e in model.elements if any(name.name == n.node for _, ns in e.nodes for n in ns)
        ]
        return f"**{name.name}**: node" + (f" of {', '.join(touching)}" if touching else "")
    for parameter in model.parameters:
        if parameter.name == name.name:
            value, unit = parameter.as_written()
            said = "no value" if value is None else f"{float(value.nearly):.12g} {unit}".strip()
            return f"**{name.name}** = {said}" + (f"  \n{parameter.doc}" if parameter.doc else "")
    for definition in model.definitions:
        if definition.name == name.name:
            return f"**{name.name}** = `{format_expression(definition.expression)}`"
    outputs = [pair for pair in model.transfer_functions if name.name in pair]
    return _formulas(model, outputs) if outputs else ""


def _formulas(model: Model, pairs: list[tuple[str, str]]) -> str:
    """Return transfer functions as ``derive`` prints them; their names alone where they are long."""
    from symflex.print.forms import print_forms, with_shared_denominators
    from symflex.print.text import derive_text

    names = ", ".join("/".join(pair) for pair in pairs)
    try:
        derived, _ = pipeline.derive_as(model, pairs)
        forms, _ = print_forms(derived)
    except SymflexError as error:
        return f"{names}  \n{error.diagnostics[0].message}"
    text = derive_text(list(zip(derived, with_shared_denominators(derived, forms), strict=True)))
    return f"```text\n{text}\n```" if len(text) <= MOST_LETTERS else names
