"""What a specification holds: exact values, each with the place it was written.

tomllib decodes them; here their places are read, in the same order. Input: a valid document, its masked copy,
and the map of its offsets to the source. Output: the root :class:`TableValue`. What tomllib accepted is TOML,
so that its masked copy, whose strings are ``x``, needs a few patterns and no grammar.
"""

from __future__ import annotations

import datetime
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NoReturn, TypeAlias

from symflex.errors import Diagnostic, Source, Span, SpecError, Text
from symflex.model.spec.scan import BLANK, quote_width

_STRING = r"""\"{3}x*+\"{3}|'{3}x*+'{3}|"x*+"|'x*+'"""  # in a masked copy
_KEY_PART = re.compile(rf"[A-Za-z0-9_\-]++|{_STRING}")
_SCALAR = re.compile(rf"{_STRING}|[0-9-]{{10}} [0-9:.+Z-]++|[^\s,\]}}#=\[{{]++")
_BLANK_ON_LINE = re.compile(r"[ \t]*+")


@dataclass(frozen=True, slots=True)
class Literal:
    """A float as tomllib found it: its characters, not yet a number."""

    text: str


@dataclass(frozen=True, slots=True)
class Document:
    """A valid TOML document made from a source by blanking what is wrong in it."""

    source: Source  # what the spans refer to
    # text and masked: the document and its masked copy, see :class:`symflex.model.spec.scan.Scan`.
    text: str
    masked: str
    origin: Callable[[int], int]  # maps an offset in ``text`` to an offset in the source
    # For the origin of each stand-in value, the place of the value it stands in for.
    invalid: Mapping[int, Span]
    # For each stand-in header's name, the path of the table it stands in for.
    adopted: Mapping[str, tuple[str, ...]]


@dataclass(slots=True)
class _Table:
    """A table while it is being filled."""

    span: Span
    entries: dict[str, tuple[Span, _Table | _Tables | Value]] = field(default_factory=dict)
    explicit: bool = False

    def add(self, key: str, key_span: Span, value: _Table | _Tables | Value) -> None:
        # A key can be there already only where a stand-in header joined two tables; that error is reported.
        self.entries.setdefault(key, (key_span, value))

    def freeze(self) -> TableValue:
        entries = (KeyValue(key, span, _frozen(value)) for key, (span, value) in self.entries.items())
        return TableValue(tuple(entries), self.span)


@dataclass(slots=True)
class _Tables:
    """An array of ``[[tables]]`` while it is being filled."""

    span: Span
    items: list[_Table] = field(default_factory=list)


def _frozen(value: _Table | _Tables | Value) -> Value:
    if isinstance(value, _Table):
        return value.freeze()
    if isinstance(value, _Tables):
        return ArrayValue(tuple(item.freeze() for item in value.items), value.span)
    return value


def locate(document: Document, decoded: Mapping[str, Any]) -> TableValue:
    """Give every value that tomllib made of a text its place, floats being :class:`Literal`.

    Raises SpecError: SF101 where tomllib accepts what is not TOML 1.0 (it is newer in later Pythons).
    """
    return _PositionReader(document).root(decoded)


@dataclass(slots=True)
class _PositionReader:
    """A place in a document, which goes on as tables, keys and values are read."""

    document: Document
    at: int = 0

    def span(self, start: int) -> Span:
        first = self.document.origin(start)
        return Span(self.document.source, first, max(first, self.document.origin(self.at)))

    def refuse(self) -> NoReturn:
        start, self.at = self.at, self.at + 1
        raise SpecError(Diagnostic("SF101", "this is not TOML 1.0", self.span(start)))

    def skip(self, pattern: re.Pattern[str]) -> str:
        """Go on behind a pattern; return the next character, or nothing at the end."""
        if (match := pattern.match(self.document.masked, self.at)) is None:
            self.refuse()
        self.at = match.end()
        return self.document.masked[self.at : self.at + 1]

    def take(self, mark: str) -> None:
        if not self.document.masked.startswith(mark, self.at):
            self.refuse()
        self.at += len(mark)

    def root(self, decoded: Mapping[str, Any]) -> TableValue:
        top = _Table(Span(self.document.source, 0, 0))
        self.fill(top, decoded)
        adopted = []
        while self.at < len(self.document.masked):
            start = self.at
            repeated = self.document.masked.startswith("[[", start)
            self.take("[[" if repeated else "[")
            parts = self.key()
            self.take("]]" if repeated else "]")
            header = self.span(start)
            name = parts[0][0]
            if name in self.document.adopted:
                adopted.append((self.at, name, header))
                self.fill(_Table(header), decoded[name])
            else:
                self.fill(*_enter(top, parts, header, decoded, repeated=repeated))
        # Last, for until then the tables are step by step those tomllib has.
        for body, name, header in adopted:
            self.at = body
            self.fill(_adopt(top, self.document.adopted[name], header), decoded[name])
        return top.freeze()

    def fill(self, table: _Table, decoded: Mapping[str, Any]) -> None:
        """Read pairs up to the next header."""
        while self.skip(BLANK) not in {"", "["}:
            self.pair(table, decoded)

    def key(self) -> list[tuple[str, Span]]:
        """Read a key with the blanks around it; return its parts."""
        parts = []
        while True:
            self.skip(_BLANK_ON_LINE)
            start = self.at
            self.skip(_KEY_PART)
            parts.append((decode_key(self.document.text[start : self.at]), self.span(start)))
            if self.skip(_BLANK_ON_LINE) != ".":
                return parts
            self.at += 1

    def pair(self, table: _Table, decoded: Mapping[str, Any]) -> None:
        *outer, (name, span) = self.key()
        self.take("=")
        self.skip(_BLANK_ON_LINE)
        inner: _Table | None = table
        for part, part_span in outer:
            decoded = decoded[part]
            if inner is not None:
                inner.add(part, part_span, _Table(part_span))
                entry = inner.entries[part][1]
                inner = entry if isinstance(entry, _Table) else None
        value = self.value(decoded[name], span)
        if inner is not None:
            inner.add(name, span, value)

    def value(self, decoded: object, key: Span | None) -> Value:
        start = self.at
        if isinstance(decoded, list):
            items = []
            self.take("[")
            for item in decoded:
                self.skip(BLANK)
                items.append(self.value(item, None))
                if self.skip(BLANK) == ",":
                    self.at += 1
            self.skip(BLANK)
            self.take("]")
            return ArrayValue(tuple(items), self.span(start))
        if isinstance(decoded, dict):
            table = _Table(key or self.span(start))
            self.take("{")
            if self.skip(_BLANK_ON_LINE) != "}":
                self.pair(table, decoded)
                while self.skip(_BLANK_ON_LINE) == ",":
                    self.at += 1
                    self.pair(table, decoded)
            self.take("}")
            table.span = key or self.span(start)
            return table.freeze()
        self.skip(_SCALAR)
        span = self.span(start)
        if span.start in self.document.invalid:
            return OtherValue("invalid", self.document.invalid[span.start])
        return self.scalar(decoded, start, span)

    def scalar(self, decoded: object, start: int, span: Span) -> Value:
        raw = self.document.text[start : self.at]
        match decoded:
            case str():
                quotes = quote_width(self.document.text, start, self.at)
                return StringValue(_text(raw[quotes:-quotes], quotes, span, decoded), span)
            case bool():
                return BooleanValue(decoded, span)
            case int():
                return NumberValue(Fraction(decoded), raw, span)
            case Literal(text):
                kind = text.lstrip("+-")
                if kind in {"inf", "nan"}:
                    return OtherValue(kind, span)
                return NumberValue(Fraction(text.replace("_", "")), text, span)
            case datetime.datetime():
                return OtherValue("date-time", span)
            case datetime.date():
                return OtherValue("date", span)
            case _:
                return OtherValue("time", span)


def _text(raw: str, quotes: int, span: Span, decoded: str) -> Text:
    skipped = 0
    if quotes > 1:
        # TOML drops a line end directly after opening triple quotes.
        skipped = 2 if raw.startswith("\r\n") else int(raw.startswith("\n"))
    inside = Span(span.source, span.start + quotes + skipped, span.end - quotes)
    return Text(decoded, inside, verbatim=raw[skipped:] == decoded)


def decode_key(raw: str) -> str:
    r"""Return the key a bare or quoted key part means.

    >>> decode_key('"V_act/F"'), decode_key("m_1"), decode_key(r'"\u03c9"')
    ('V_act/F', 'm_1', 'ω')
    """
    if raw.startswith('"') and "\\" in raw:
        return next(iter(tomllib.loads(f"{raw} = 0")))
    return raw[1:-1] if raw[0] in "\"'" else raw


def _enter(
    top: _Table, parts: list[tuple[str, Span]], header: Span, decoded: Mapping[str, Any], *, repeated: bool
) -> tuple[_Table, Mapping[str, Any]]:
    """Return the table a header opens and what tomllib found in it."""
    table = top
    inside: Any = decoded
    for depth, (name, span) in enumerate(parts, start=1):
        last = depth == len(parts)
        inside = inside[name]
        if last and repeated:
            table.add(name, span, _Tables(header))
        else:
            table.add(name, span, _Table(header))
        entry = table.entries[name][1]
        if isinstance(entry, _Tables):
            if last:
                entry.items.append(_Table(header, explicit=True))
            inside = inside[len(entry.items) - 1]
            table = entry.items[-1]
        elif isinstance(entry, _Table):
            if last and not entry.explicit:
                entry.span, entry.explicit = header, True
                table.entries[name] = (span, entry)
            table = entry
        else:
            table = _Table(header)
    return table, inside


def _adopt(top: _Table, path: tuple[str, ...], header: Span) -> _Table:
    """Return the table at a path, made where it is missing; one apart where another value stands."""
    if not path:
        return _Table(header)
    table = top
    for name in path:
        table.add(name, header, _Table(header))
        entry = table.entries[name][1]
        if isinstance(entry, _Tables):
            entry = entry.items[-1]
        if not isinstance(entry, _Table):
            return _Table(header)
        table = entry
    return table


@dataclass(frozen=True, slots=True)
class StringValue:
    """A string."""

    # The decoded string with the place between its quotes. A line break directly after opening triple quotes
    # is not part of the value and stands outside that place.
    text: Text
    span: Span  # the whole value, with its quotes


@dataclass(frozen=True, slots=True)
class NumberValue:
    """An integer or a decimal, exact."""

    value: Fraction  # the exact value: ``0.1`` is 1/10
    literal: str  # the number as it was written, such as ``1_000`` or ``0xff``
    span: Span  # where it was written


@dataclass(frozen=True, slots=True)
class BooleanValue:
    """``true`` or ``false``."""

    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class ArrayValue:
    """An array; one of ``[[tables]]`` has the first header as its span."""

    items: tuple[Value, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class TableValue:
    """A table in the order of its text."""

    entries: tuple[KeyValue, ...]  # keys are unique
    # The header ``[a.b]`` of the table, or the key of an inline or dotted one, or all of ``{...}`` inside an
    # array. The root's is empty and at the start of the text.
    span: Span
    _by_key: Mapping[str, KeyValue] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Index the entries, so that a table of thousands is not searched end to end."""
        object.__setattr__(self, "_by_key", {entry.key: entry for entry in self.entries})

    def get(self, key: str) -> KeyValue | None:
        """Return the entry of ``key``, or ``None``."""
        return self._by_key.get(key)

    def keys(self) -> tuple[str, ...]:
        """Return the keys in the order of the text."""
        return tuple(entry.key for entry in self.entries)


@dataclass(frozen=True, slots=True)
class OtherValue:
    """A value the specification language has no use for, kept so that it can be pointed at."""

    # ``date-time``, ``date``, ``time``, ``inf``, ``nan``; or ``invalid`` for a value whose syntax error is
    # already reported (only from :func:`symflex.model.spec.parse_with_recovery`).
    kind: str
    span: Span  # where it was written


@dataclass(frozen=True, slots=True)
class KeyValue:
    """One ``key = value``, or a table under its key."""

    key: str  # the decoded key, one part of a dotted one
    key_span: Span  # that part as it was written, with its quotes if it has any
    value: Value  # what it contains


@dataclass(frozen=True, slots=True)
class Spec:
    """A whole specification: the text and what it says."""

    source: Source
    root: TableValue

    def __repr__(self) -> str:
        return f"<Spec {self.source.name}: {len(self.source.text)} characters>"


Value: TypeAlias = StringValue | NumberValue | BooleanValue | ArrayValue | TableValue | OtherValue
