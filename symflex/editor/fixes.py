"""What an editor can do about a problem: the change that its hint describes, where it makes the problem go.

Input: a document and one of its problems. Output: the change of the text that leaves fewer problems. It is
tried before it is offered.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from symflex.editor.document import OpenDocument, examined
from symflex.errors import Diagnostic

_OFFERED = re.compile(r"'([^'\n]+)'|\"([^\"\n]+)\"|: (\S.*)$")
_IN_WORDS = re.compile(r"\.\.\.|\($|[a-z] [a-z]|left = right")  # what stands for something to think of
_FIRST_LINE = re.compile(r"begin the file with: (.+)$")
_TELLING = (
    "did you mean",
    "write",
    "put it",
    "put a",
    "add the",
    "begin with",
)  # how hints begin that name a text
MOST_TRIED = 8  # changes of a hint; each costs as much as a check


@dataclass(frozen=True, slots=True)
class Fix:
    """A change of a text: what stands between two offsets becomes another text."""

    title: str
    start: int
    end: int
    text: str

    def applied(self, text: str) -> str:
        """Return a text with the change."""
        return text[: self.start] + self.text + text[self.end :]


def fixes(document: OpenDocument, problem: Diagnostic) -> tuple[Fix, ...]:
    """Return the changes that a problem's hint describes and that leave fewer problems."""
    count, text = len(document.problems), document.source.text
    good = []
    for number, fix in enumerate(_meant(problem)):
        if number >= MOST_TRIED:
            break
        after = examined(fix.applied(text), document.source.name)
        is_worse = document.problems[0].severity == "warning" and after.model is None
        if len(after.problems) < count and not is_worse:
            good.append(fix)
    return tuple(good[:1])


def _meant(problem: Diagnostic) -> Iterator[Fix]:
    """Yield what a hint may mean: its words in place of what is pointed at, quoted, or behind it."""
    span, hint = problem.span, problem.hint
    if span is None or hint is None or span.origin is not span:
        return
    if hint.startswith("remove it"):
        yield Fix("Remove it", span.start, span.end, "")
    if match := _FIRST_LINE.match(hint):
        yield Fix(f"Begin with {match[1]}", 0, 0, f"{match[1]}\n")
        return
    if not hint.startswith(_TELLING):
        return
    for match in _OFFERED.finditer(hint):
        word = next(group for group in match.groups() if group)
        if _IN_WORDS.search(word):
            continue
        yield Fix(f"Write {word}", span.start, span.end, word)
        yield Fix(f"Write {word}", span.start, span.end, f'"{word}"')
        yield Fix(f"Add {word}", span.end, span.end, word)
