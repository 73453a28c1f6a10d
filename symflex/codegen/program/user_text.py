"""What a user wrote, inside generated code: names as identifiers, one to one, and text that is inert."""

from __future__ import annotations

import re
from itertools import chain, count
from textwrap import TextWrapper
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping


_OUTSIDE = re.compile(r"[^A-Za-z0-9_]")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifiers(
    wanted: Mapping[str, str], reserved: Collection[str], longest: int | None = None
) -> Mapping[str, str]:
    """Return an identifier for every key: the text wanted for it where that can be one.

    Any texts may be wanted, the same one twice. ``reserved`` are keywords, and what the generated code uses;
    texts of more than the ``longest`` number of characters are cut. Different keys have different
    identifiers: letters, digits and underscores of ASCII, a letter first.

    Examples
    --------
    >>> dict(identifiers({"a": "lambda", "b": "lambda_", "c": "k", "d": "2x)", "e": "k"}, {"lambda"}))
    {'a': 'lambda_2', 'b': 'lambda_', 'c': 'k', 'd': 'p_2x_', 'e': 'k_'}
    >>> dict(identifiers({"a": "stiffness_1", "b": "stiffness_2"}, {}, longest=9))
    {'a': 'stiffness', 'b': 'stiffnes_'}
    """
    found: dict[str, str] = {}
    taken = set(reserved)
    for key, text in wanted.items():
        if _PLAIN.fullmatch(text) and text not in taken and text == text[:longest]:
            found[key] = text
            taken.add(text)
    for key, text in wanted.items():
        if key not in found:
            found[key] = _free(_mangled(text), taken, longest)
            taken.add(found[key])
    return {key: found[key] for key in wanted}


def _mangled(text: str) -> str:
    plain = _OUTSIDE.sub("_", text)
    return plain if plain[:1].isalpha() else f"p_{plain.lstrip('_')}"


def _free(text: str, taken: Collection[str], longest: int | None) -> str:
    for suffix in chain(("", "_"), (f"_{number}" for number in count(2))):
        kept = text if longest is None else text[: longest - len(suffix)]
        if f"{kept}{suffix}" not in taken:
            return f"{kept}{suffix}"
    raise AssertionError


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
    """Return a text without line ends as lines, long products broken after their operators.

    They have at most ``width`` columns, with what the first line and the others begin with: ``indent``, and
    ``more`` where that differs.
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
