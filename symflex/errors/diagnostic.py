"""One problem found in a text: what is wrong, where it stands, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True, slots=True)
class Source:
    """A named text that positions refer to."""

    name: str  # as shown in messages; a path, or ``<python>`` for a model built in Python
    text: str = field(repr=False)  # the whole text
    # What each line of a text comes from that was made from another one, ``None`` where it was added.
    origins: tuple[Span | None, ...] = field(default=(), repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class Span:
    r"""A half-open range of characters ``start <= i < end`` of a source.

    >>> span = Span(Source("a.toml", "x = 1\nk = 2\n"), 6, 7)
    >>> span.line, span.column, span.text
    (2, 1, 'k')
    """

    source: Source
    start: int
    end: int

    @property
    def origin(self) -> Span:
        """Itself, or what its line comes from if the text was made from another one."""
        number = self.source.text.count("\n", 0, self.start)
        return next(filter(None, self.source.origins[number : number + 1]), self)

    @property
    def line(self) -> int:
        """Line number of its origin, counted from 1."""
        origin = self.origin
        return origin.source.text.count("\n", 0, origin.start) + 1

    @property
    def column(self) -> int:
        """Column of its origin in characters, counted from 1."""
        origin = self.origin
        return origin.start - origin.source.text.rfind("\n", 0, origin.start)

    @property
    def end_line(self) -> int:
        """Line number of the end of its origin, counted from 1."""
        origin = self.origin
        return origin.source.text.count("\n", 0, origin.end) + 1

    @property
    def end_column(self) -> int:
        """Column behind the last character of its origin, counted from 1."""
        origin = self.origin
        return origin.end - origin.source.text.rfind("\n", 0, origin.end)

    @property
    def text(self) -> str:
        """The characters the span covers."""
        return self.source.text[self.start : self.end]

    @property
    def line_text(self) -> str:
        """The whole line the span starts on, without its line end."""
        begin = self.source.text.rfind("\n", 0, self.start) + 1
        end = self.source.text.find("\n", begin)
        line = self.source.text[begin:] if end < 0 else self.source.text[begin:end]
        return line.rstrip("\r")

    def __str__(self) -> str:
        """Return ``file:line:col`` of its origin."""
        return f"{self.origin.source.name}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Text:
    """A string value together with the place it was written."""

    value: str  # the decoded string
    span: Span  # the characters between the quotes (without them)
    # True when ``value`` stands in the source character by character, so that an offset in ``value`` is an
    # offset in the source; False when escapes were decoded.
    verbatim: bool = True

    @classmethod
    def alone(cls, source: str, value: str) -> Text:
        """Return a text that is all there is in a source, such as an option."""
        return cls(value, Span(Source(source, value), 0, len(value)))

    def at(self, start: int, end: int) -> Span:
        """Return the span of ``value[start:end]``, or of all of it when escapes were decoded."""
        if not self.verbatim:
            return self.span
        return Span(self.span.source, self.span.start + start, self.span.start + end)


SHOWN_COLUMNS = 160


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One problem, with a stable code.

    >>> from symflex.errors import Source, Span
    >>> source = Source("a.toml", 'm = "3 kgg"')
    >>> print(Diagnostic("SF201", "unknown unit 'kgg'", Span(source, 7, 10), "did you mean 'kg'?").render())
    a.toml:1:8: error[SF201]: unknown unit 'kgg'
      1 | m = "3 kgg"
        |        ^^^
      hint: did you mean 'kg'?
    """

    code: str  # ``SF`` and three digits; docs/error-codes.md lists them
    message: str  # what is wrong, with the value found
    span: Span | None = None  # where; ``None`` when the problem has no place in a text
    hint: str | None = None  # what to do about it
    # ``error``, or ``warning`` for what is allowed and perhaps not meant.
    severity: Literal["error", "warning"] = "error"

    @property
    def mark(self) -> str:
        """What it is, and its code: ``error[SF201]``."""
        return f"{self.severity}[{self.code}]"

    def render(self) -> str:
        """Return the diagnostic as the lines a terminal shows."""
        said = f"{self.mark}: {self.message}"
        lines = [said] if self.span is None else [f"{self.span}: {said}", *_excerpt(self.span.origin)]
        if self.hint:
            lines.append(f"  hint: {self.hint}")
        return "\n".join(printable(line) for line in lines)


def _excerpt(span: Span) -> list[str]:
    number = str(span.line)
    text = span.line_text.replace("\t", " ")
    first = span.column - 1
    offset = max(0, first - SHOWN_COLUMNS // 2) if len(text) > SHOWN_COLUMNS else 0
    shown = text[offset : offset + SHOWN_COLUMNS]
    width = max(1, min(span.end - span.start, len(shown) - (first - offset)))
    gutter = " " * len(number)
    return [f"  {number} | {shown}", f"  {gutter} | {' ' * (first - offset)}{'^' * width}"]


def printable(text: str, kept: str = "") -> str:
    r"""Return ``text`` with control characters escaped but those kept: a file cannot drive a terminal.

    >>> print(printable("\x1b[2J\n", kept="\n"), end="")
    \x1b[2J
    """
    return "".join(c if c.isprintable() or c in kept else f"\\x{ord(c):02x}" for c in text)


def nearest(name: str, known: Iterable[str], alike: float = 0.6) -> str | None:
    """Return a hint naming the closest known name, or ``None`` when none is close.

    >>> nearest("sprnig", ["mass", "spring"])
    "did you mean 'spring'?"
    >>> nearest("X", ["x", "XY"]), nearest("x_1", ["x", "F"])
    ("did you mean 'x'?", "did you mean 'x'?")
    """
    if len(name) > 64:  # noqa: PLR2004
        return None
    from difflib import get_close_matches  # most commands go well

    known = sorted(known)
    same = [n for n in known if n.lower() == name.lower()]
    bare = [n for n in known if n == name.rstrip("0123456789_")]
    matches = same or get_close_matches(name, known, n=1, cutoff=alike) or bare
    return f"did you mean '{matches[0]}'?" if matches else None


def counted(count: int, noun: str) -> str:
    """Return a number of things.

    >>> counted(1, "pole"), counted(0, "zero"), counted(3, "zero")
    ('1 pole', 'no zeros', '3 zeros')
    """
    return f"{count or 'no'} {noun}{'' if count == 1 else 's'}"
