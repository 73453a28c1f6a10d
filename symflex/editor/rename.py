"""A name of a specification changed everywhere at once, if the model stays the same.

Input: a document without errors, a name and a new one. Output: the new text. It is checked as any other: it
has the transfer functions of before, with the name changed, and no other problems.
"""

from __future__ import annotations

from symflex.editor.document import OpenDocument, examined
from symflex.errors import refused
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
    places = [each.span for each in document.names if each.name == name]
    if not places:
        raise refused(f"there is no name '{name}' that this specification defines")
    if any(each.name == new for each in document.names):
        raise refused(f"'{new}' is a name of this specification", "choose another one")
    text = document.source.text
    for span in sorted(places, key=lambda span: -span.start):
        text = text[: span.start] + new + text[span.end :]
    after = examined(text, document.source.name)
    if after.model is None:
        raise refused(f"'{new}' cannot stand for '{name}' here: {after.problems[0].message}")
    pairs = [
        tuple(new if part == name else part for part in pair) for pair in document.model.transfer_functions
    ]
    if pairs != list(after.model.transfer_functions) or len(after.problems) != len(document.problems):
        raise refused(f"'{name}' has several meanings here", "rename it by hand")
    return text
