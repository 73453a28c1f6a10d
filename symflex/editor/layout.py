"""How a specification is laid out: the tables that fold, and blanks that mean nothing.

Input: a document. Output: ranges of lines, or the text with no blanks at the ends of lines, one blank line
between others at most, and a line end behind the last line. What is within quotes stays.
"""

from __future__ import annotations

from symflex.editor.document import OpenDocument
from symflex.errors import SpecError
from symflex.model.spec.scan import Scan, scan


def folds(document: OpenDocument) -> tuple[tuple[int, int], ...]:
    """Return the first and last line of each table, counted from 0."""
    found = _scanned(document)
    if found is None:
        return ()
    text = found.text
    starts = [s.start for s in found.statements if s.header]
    ends = [*starts[1:], len(text)]
    lines = []
    for start, end in zip(starts, ends, strict=True):
        first, final = text.count("\n", 0, start), text.count("\n", 0, len(text[:end].rstrip()))
        if final > first:
            lines.append((first, final))
    return tuple(lines)


def tidied(document: OpenDocument) -> str:
    """Return the text without blanks that mean nothing."""
    found = _scanned(document)
    text = document.source.text
    if found is None or any(s.unclosed is not None for s in found.statements):
        return text
    kept, blank = [], 0
    at = 0
    for line in text.splitlines(keepends=True):
        end = at + len(line.rstrip("\r\n"))
        # In the masked text, all of a string is x: a line that ends inside of one has no blank there.
        is_free = found.masked[end : end + 1] in {"\n", "\r", ""} and not line.isspace()
        if is_free:
            blank = 0
            bare = found.masked[at:end].rstrip(" \t")
            kept.append(text[at : at + len(bare)] + "\n")
        elif found.masked[at:end].strip(" \t") or found.masked[end : end + 1] == "x":
            blank = 0
            kept.append(line)
        else:
            blank += 1
            if blank == 1 and kept:
                kept.append("\n")
        at += len(line)
    while kept and kept[-1] == "\n":
        kept.pop()
    return "".join(kept)


def _scanned(document: OpenDocument) -> Scan | None:
    try:
        return scan(document.source)
    except SpecError:
        return None
