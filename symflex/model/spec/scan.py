"""Cut a text into statements without understanding them, and refuse what is too large.

Input: any text. Output: its :class:`Statement` objects and a *masked* copy of the same length, in
which the inside of every string is ``x``. Brackets, key parts and numbers are counted here, so that
no recursive or number-building code ever sees a hostile text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import NoReturn

from symflex.errors import Diagnostic, Source, Span, SpecError
from symflex.model.spec.read import (
    MAX_BYTES,
    MAX_ENTRIES,
    MAX_KEY_PARTS,
    MAX_LEVELS,
    MAX_NESTING,
    number_problem,
)

# A group that may fail halfway through a repeat is not possessive: before 3.11.5, Python does not go back to
# where the repeat began (cpython#106052).
KEY_PART = r"""(?:[A-Za-z0-9_\-]++|"(?:[^"\\\n]|\\[^\n])*+"|'[^'\n]*+')"""
KEY = rf"{KEY_PART}(?:[ \t]*+\.[ \t]*+{KEY_PART})*"

_LINE_STRING = r""" (?!\"{3}|'{3}) (?: "(?:[^"\\\n]|\\[^\n])*+" | '[^'\n]*+' ) """
_BLOCK_STRING = r"""
    \"{3}[^"\\]*+(?:(?:\\.|"(?!""))[^"\\]*+)*\"{3,5}+ | '{3}[^']*+(?:'(?!'')[^']*+)*'{3,5}+ |
"""


def _token(strings: str) -> re.Pattern[str]:
    return re.compile(
        rf"""(?P<blank>[ \t\r]++|\#[^\n]*+) | (?P<line>\n)
        | (?P<string>{strings}) | (?P<quote>\"{{3}}|'{{3}}|["'])
        | (?P<mark>[\[\]{{}},=]) | (?P<word>[^\s\#\[\]{{}},="']++|\s)""",
        re.VERBOSE | re.DOTALL,
    )


_TOKEN = _token(_BLOCK_STRING + _LINE_STRING)
BLANK = re.compile(r"(?:[ \t\r\n]++|\#[^\n]*+)*+")
# Few texts need these three: they are compiled where they are used, so that the others do not wait.
_KEY_LINE = rf"[ \t]*+{KEY}[ \t]*+="
# A line that is a header and cannot be an array's item: its first key part is not a value.
_HEADER_LINE = (
    r"[ \t]*+\[\[?[ \t]*+(?!(?:true|false|inf|nan)[\s.\]])[A-Za-z_][^\[\]{},=\n]*+"
    r"\]\]?[ \t\r]*+(?:\#[^\n]*+)?$"
)
_HALF_HEADER = re.compile(rf"{KEY}[ \t]*+\]\]?[ \t\r]*+(?:\#[^\n]*+)?$", re.MULTILINE)
_NEXT_STATEMENT = rf"^(?={_KEY_LINE}|{_HEADER_LINE})"
_NON_ASCII = re.compile(r"[^\x00-\x7f]")
_SURROGATE = re.compile(r"[\ud800-\udfff]")
_SHORTEST_BLOCK = len("'''" * 2)
_CLOSING = {"[": "]", "{": "}"}


@dataclass(frozen=True, slots=True)
class Statement:
    """One ``key = value`` or ``[header]``, or text in its place that is neither."""

    # start and end: its characters, a comment on its last line included, the line end not.
    start: int
    end: int
    header: bool  # whether it starts with a bracket, or is a key with only the closing one
    equals: int | None  # offset of the equals sign after the key
    unclosed: int | None  # offset of a quote or bracket that is opened and not closed


@dataclass(slots=True)
class _Frame:
    """An open bracket, or the statement itself."""

    mark: str
    offset: int
    level: int
    in_key: bool
    parts: int = 1


@dataclass(slots=True)
class _Scanner:
    source: Source
    text: str
    entries: int = 0
    header_level: int = 0
    token: re.Pattern[str] = _TOKEN
    strings: list[tuple[int, int]] = field(default_factory=list)

    def refuse(self, message: str, start: int, end: int, hint: str | None = None) -> NoReturn:
        raise SpecError(Diagnostic("SF103", message, Span(self.source, start, end), hint))

    def count(self, offset: int) -> None:
        self.entries += 1
        if self.entries > MAX_ENTRIES:
            self.refuse(f"more than {MAX_ENTRIES} entries", offset, offset + 1)

    def line_end(self, offset: int) -> int:
        end = self.text.find("\n", offset)
        return len(self.text) if end < 0 else end

    def statement(self, start: int) -> Statement:
        """Scan one statement; it ends at a line end outside brackets, or where it was surely meant to."""
        self.count(start)
        header = self.text[start] == "[" or _HALF_HEADER.match(self.text, start) is not None
        frames = [_Frame("", start, 0 if header else self.header_level, in_key=True)]
        equals: int | None = None
        unclosed: int | None = None
        previous = ""
        offset = start
        while match := self.token.match(self.text, offset):
            kind, token = match.lastgroup, match[0]
            top = frames[-1]
            if kind == "line":
                if len(frames) == 1 or header:
                    break
                after = _blank_end(self.text, offset)
                if not self.goes_on(after, top.mark, previous):
                    break
                offset = after
                continue
            if kind == "string":
                self.strings.append(match.span())
            elif kind == "quote":
                unclosed = match.start() if unclosed is None else unclosed
                offset = self.skip_unclosed(match.start(), token)
                previous = token
                continue
            elif kind == "word":
                self.word(top, token, match.start())
            elif kind == "mark":
                if token in "]}" and _CLOSING.get(top.mark) != token:
                    offset = self.line_end(offset)
                    break
                if token == "=" and len(frames) == 1 and equals is None:
                    equals = match.start()
                self.mark(frames, token, match.start(), header)
            if kind != "blank":
                previous = token
            offset = match.end()
        if unclosed is None and len(frames) > 1:
            unclosed = frames[-1].offset
        if header:
            self.header_level = frames[-1].parts if len(frames) > 1 else frames[0].parts
        return Statement(start, offset, header, equals, unclosed)

    def goes_on(self, after: int, mark: str, previous: str) -> bool:
        """Say whether a statement goes on after line ends in brackets, or one was forgotten."""
        line = self.text.rfind("\n", 0, after) + 1
        if re.compile(_HEADER_LINE, re.MULTILINE).match(self.text, line):
            return False
        if mark == "[":
            return not re.compile(_KEY_LINE).match(self.text, line)
        return previous in {",", "{"} or self.text[after : after + 1] in {"}", ","}

    def skip_unclosed(self, offset: int, quote: str) -> int:
        if len(quote) == 1:
            return self.line_end(offset)
        # Other triple quotes that never close are not looked for: each look would run to the end again.
        self.token = _token(_LINE_STRING)
        following = re.compile(_NEXT_STATEMENT, re.MULTILINE | re.VERBOSE).search(
            self.text, offset + len(quote)
        )
        return following.start() - 1 if following else len(self.text)

    def word(self, top: _Frame, word: str, offset: int) -> None:
        if top.in_key:
            top.parts += word.count(".")
            if top.parts > MAX_KEY_PARTS:
                self.refuse(f"a key of more than {MAX_KEY_PARTS} parts", offset, offset + len(word))
        elif problem := number_problem(word):
            self.refuse(problem, offset, offset + len(word))

    def mark(self, frames: list[_Frame], mark: str, offset: int, header: bool) -> None:
        top = frames[-1]
        if mark in "[{":
            if len(frames) > MAX_NESTING:
                self.refuse(f"brackets nested deeper than {MAX_NESTING}", offset, offset + 1)
            level = top.level + (1 if top.mark == "[" else top.parts)
            if level > MAX_LEVELS:
                self.refuse(f"tables nested deeper than {MAX_LEVELS}", offset, offset + 1)
            frames.append(_Frame(mark, offset, level, in_key=header or mark == "{"))
        elif mark in "]}":
            closed = frames.pop()
            if header:
                frames[-1].parts = max(frames[-1].parts, closed.parts)
            else:
                frames[-1].in_key = False
        elif mark == "=":
            top.in_key = False
            if top.mark:
                self.count(offset)
        elif mark == ",":
            if top.mark == "{":
                top.in_key, top.parts = True, 1
            elif top.mark:
                self.count(offset)


@dataclass(frozen=True, slots=True)
class Scan:
    """A text cut into statements."""

    text: str  # the text with a byte order mark replaced by a blank
    # The same with ``x`` for every character inside strings and for all that is not ASCII, so that offsets in
    # characters and in bytes are one.
    masked: str
    statements: tuple[Statement, ...]  # in the order of the text


def scan(source: Source) -> Scan:
    r"""Cut a text into statements, and mask the inside of its strings; SF103 beyond a limit.

    >>> found = scan(Source("a.toml", 'k = "2 N/m" # stiff\n\n[b]\n'))
    >>> [found.text[s.start : s.end] for s in found.statements]
    ['k = "2 N/m" # stiff', '[b]']
    >>> found.masked[:11]
    'k = "xxxxx"'
    """
    text = " " + source.text[1:] if source.text.startswith("\ufeff") else source.text
    if len(text) > MAX_BYTES or len(text.encode("utf-8", "surrogatepass")) > MAX_BYTES:
        message = f"the text is larger than {MAX_BYTES} bytes"
        hint = "divide it into files that blocks of type model join"
        raise SpecError(Diagnostic("SF103", message, Span(source, 0, 0), hint))
    if broken := _SURROGATE.search(text):
        message = f"half a surrogate pair, U+{ord(broken[0]):04X}, is not a character"
        raise SpecError(Diagnostic("SF101", message, Span(source, *broken.span())))
    scanner = _Scanner(source, text)
    statements = []
    offset = _blank_end(text, 0)
    while offset < len(text):
        statements.append(scanner.statement(offset))
        offset = _blank_end(text, statements[-1].end)
    pieces = []
    done = 0
    for start, end in scanner.strings:
        quotes = quote_width(text, start, end)
        pieces += [text[done : start + quotes], "x" * (end - start - 2 * quotes)]
        done = end - quotes
    pieces.append(text[done:])
    return Scan(text, _NON_ASCII.sub("x", "".join(pieces)), tuple(statements))


def _blank_end(text: str, offset: int) -> int:
    blank = BLANK.match(text, offset)
    return blank.end() if blank else offset


def quote_width(text: str, start: int, end: int) -> int:
    """Return how many quotes open the string ``text[start:end]``: one or three."""
    block = end - start >= _SHORTEST_BLOCK and text.startswith(text[start] * 3, start)
    return 3 if block else 1
