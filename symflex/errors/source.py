"""Where a piece of text stands: the file it came from and its offsets in it."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Source:
    """A named text that positions refer to."""

    name: str  # as shown in messages; a path, or ``<python>`` for a model built in Python
    text: str = field(repr=False)  # the whole text


@dataclass(frozen=True, slots=True)
class Span:
    r"""A half-open range of characters ``start <= i < end`` of a source.

    Examples
    --------
    >>> span = Span(Source("a.toml", "x = 1\nk = 2\n"), 6, 7)
    >>> span.line, span.column, span.text
    (2, 1, 'k')
    """

    source: Source
    start: int
    end: int

    @property
    def line(self) -> int:
        """Line number, counted from 1."""
        return self.source.text.count("\n", 0, self.start) + 1

    @property
    def column(self) -> int:
        """Column in characters, counted from 1."""
        return self.start - self._line_start() + 1

    @property
    def text(self) -> str:
        """The characters the span covers."""
        return self.source.text[self.start : self.end]

    @property
    def line_text(self) -> str:
        """The whole line the span starts on, without its line end."""
        begin = self._line_start()
        end = self.source.text.find("\n", begin)
        line = self.source.text[begin:] if end < 0 else self.source.text[begin:end]
        return line.rstrip("\r")

    def _line_start(self) -> int:
        return self.source.text.rfind("\n", 0, self.start) + 1

    def __str__(self) -> str:
        """Return ``file:line:col``."""
        return f"{self.source.name}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Text:
    """A string value together with the place it was written."""

    value: str  # the decoded string
    span: Span  # the characters between the quotes (without them)
    # True when ``value`` stands in the source character by character, so that an offset in ``value`` is an
    # offset in the source; False when escapes were decoded.
    verbatim: bool = True

    def at(self, start: int, end: int) -> Span:
        """Return the span of ``value[start:end]``, or of all of it when escapes were decoded."""
        if not self.verbatim:
            return self.span
        return Span(self.span.source, self.span.start + start, self.span.start + end)
