"""Text of a user inside generated files: readable, and inert whatever it says."""

from __future__ import annotations

from textwrap import TextWrapper

_CONFUSABLE = str.maketrans({'"': "'"})


def inert(text: str) -> str:
    """Return text on one line that can neither end a docstring nor start a doctest or directive in it.

    Line ends become spaces, double quotes single ones, characters that do not print their code points,
    and the marks at which doctest and reStructuredText would begin to obey are pulled apart.

    Examples
    --------
    >>> inert("mass of\\n the \\u202e body")
    'mass of the <U+202E> body'
    >>> inert('a' + '\\"' * 3 + '>' * 3 + ' b')
    "a'''> > > b"
    """
    line = " ".join(text.split())
    shown = "".join(c if c.isprintable() else f"<U+{ord(c):04X}>" for c in line).translate(_CONFUSABLE)
    for mark in (">", "."):
        while mark * 2 in shown:
            shown = shown.replace(mark * 2, f"{mark} {mark}")
    return shown


def wrapped(text: str, width: int, indent: str = "", more: str | None = None) -> list[str]:
    """Return a text as lines of at most ``width`` columns; only a word longer than that is broken."""
    wrapper = TextWrapper(
        width=width,
        initial_indent=indent,
        subsequent_indent=indent if more is None else more,
        break_on_hyphens=False,
    )
    return wrapper.wrap(text) or [indent.rstrip()]
