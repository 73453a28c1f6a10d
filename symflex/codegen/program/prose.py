"""Text of a user inside generated files: readable, and inert whatever it says."""

from __future__ import annotations

import re
from textwrap import TextWrapper

_DIRECTIVE = re.compile(r"(?<!\S)\.\.(?!\S)")
_OPERATOR = re.compile(r"[^*/]+[*/]*|[*/]+")


def inert(text: str) -> str:
    r"""Return text on one line that can neither end a docstring nor start a doctest or directive in it.

    Line ends become spaces, double quotes single ones, characters that do not print their code points,
    and the marks at which doctest and reStructuredText begin to obey are pulled apart.

    Examples
    --------
    >>> inert("mass of\n the \u202e body")
    'mass of the <U+202E> body'
    >>> inert('a' + '"' * 3 + '>' * 3 + ' b')
    "a'''> > > b"
    """
    line = " ".join(text.split())
    shown = "".join(c if c.isprintable() else f"<U+{ord(c):04X}>" for c in line).replace('"', "'")
    return _DIRECTIVE.sub(". .", shown.replace(">>>", "> > >"))


def wrapped(text: str, width: int, indent: str = "", more: str | None = None) -> list[str]:
    """Return a text as lines of at most ``width`` columns, long products broken after their operators.

    Parameters
    ----------
    text : str
        Without line ends.
    width : int
        Columns, indentation included.
    indent, more : str
        What the first line and the others begin with; by default the same.
    """
    more = indent if more is None else more
    room = width - max(len(indent), len(more))
    words = " ".join(_broken(word, room) if len(word) > room else word for word in text.split(" "))
    return TextWrapper(
        width=width, initial_indent=indent, subsequent_indent=more, break_on_hyphens=False
    ).wrap(words) or [indent.rstrip()]


def _broken(word: str, room: int) -> str:
    lines = [""]
    for piece in _OPERATOR.findall(word):
        if lines[-1] and len(lines[-1]) + len(piece) > room:
            lines.append("")
        lines[-1] += piece
    return " ".join(lines)
