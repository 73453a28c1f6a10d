"""A name of a specification changed everywhere at once, if the model stays the same.

Input: a document without errors, a name and a new one. Output: the new text. It is checked as any other: it
has the transfer functions of before, with the name changed, as many parameters, and no other problems.
"""

from __future__ import annotations

from collections.abc import Mapping

from symflex.editor.document import OpenDocument, examined
from symflex.errors import refused
from symflex.model import Model
from symflex.model.reading import NAME


def renamed(document: OpenDocument, name: str, new: str) -> str:
    """Return the text with a name changed wherever it is defined and used.

    Raises
    ------
    UsageError
        SF902 if the text has errors, has no such name, or would have errors, or another model, afterwards.
    """
    if not NAME.fullmatch(new):
        raise refused(f"'{new[:64]}' cannot be a name", "a name is a letter, then letters, digits and _")
    if document.model is None:
        raise refused(f"'{name}' cannot be renamed while there are problems", "mend them first")
    found = [each for each in document.names if each.name == name]
    if not any(each.is_definition for each in found):
        raise refused(f"there is no name '{name}' that this specification defines")
    if any(each.name == new for each in document.names):
        raise refused(f"'{new}' is a name of this specification", "choose another one")
    text = document.source.text
    for span in sorted((each.span for each in found), key=lambda span: -span.start):
        text = text[: span.start] + new + text[span.end :]
    after = examined(text, document.source.name)
    if after.model is None:
        raise refused(f"'{new}' cannot stand for '{name}' here: {after.problems[0].message}")
    is_same = _meaning(document.model, {name: new}) == _meaning(after.model, {})
    if not is_same or len(after.problems) != len(document.problems):
        raise refused(f"'{name}' has several meanings here", "rename it by hand")
    return text


def _meaning(model: Model, other: Mapping[str, str]) -> tuple[object, ...]:
    """Return what stays: transfer functions, some names of which are others, and how many parameters."""
    pairs = [[other.get(part, part) for part in pair] for pair in model.transfer_functions]
    return pairs, len(model.parameters)
