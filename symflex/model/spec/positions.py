"""What a specification holds: exact values, each with the place it was written.

tomllib decodes them, and tree-sitter finds their places. Input: a valid document, its masked copy, and the
map of its offsets to the source. Output: the root :class:`TableValue`. The masked copy is ASCII, so the byte
offsets of tree-sitter are offsets in characters.
"""

from __future__ import annotations

import datetime
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, TypeAlias

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

from symflex.errors import Diagnostic, Source, Span, SpecError, Text
from symflex.model.spec.scan import quote_width

_TOML = Language(tree_sitter_toml.language())


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
    """Give every value that tomllib made of a text its place, floats being :class:`Literal`."""
    # Raises SpecError: SF101 where tomllib accepts what is not TOML 1.0 (it is newer in later Pythons).
    tree = Parser(_TOML).parse(document.masked.encode("ascii"))
    if tree.root_node.has_error:
        span = _PositionReader(document).span(_first_error(tree.root_node))
        raise SpecError(Diagnostic("SF101", "this is not TOML 1.0", span))
    return _PositionReader(document).root(tree.root_node, decoded)


def _first_error(node: Node) -> Node:
    for child in node.children:
        if child.is_error or child.is_missing:
            return child
        if child.has_error:
            return _first_error(child)
    return node


@dataclass(frozen=True, slots=True)
class _PositionReader:
    document: Document

    def span(self, node: Node) -> Span:
        start = self.document.origin(node.start_byte)
        return Span(self.document.source, start, max(start, self.document.origin(node.end_byte)))

    def raw(self, node: Node) -> str:
        return self.document.text[node.start_byte : node.end_byte]

    def root(self, root: Node, decoded: Mapping[str, Any]) -> TableValue:
        top = _Table(Span(self.document.source, 0, 0))
        adopted = []
        for node in root.named_children:
            if node.type == "pair":
                self.pair(top, node, decoded)
            elif node.type in {"table", "table_array_element"}:
                parts = self.key_parts(self.parts(node)[0])
                if parts[0][0] in self.document.adopted:
                    adopted.append((node, parts[0][0]))
                    continue
                repeated = node.type == "table_array_element"
                self.fill(node, *_enter(top, parts, self.header(node), decoded, repeated=repeated))
        # Last, for until then the tables are step by step those tomllib has.
        for node, name in adopted:
            self.fill(node, _adopt(top, self.document.adopted[name], self.header(node)), decoded[name])
        return top.freeze()

    def parts(self, node: Node) -> list[Node]:
        return [child for child in node.named_children if child.type != "comment"]

    def header(self, node: Node) -> Span:
        closing = next(child for child in node.children if child.type in {"]", "]]"})
        return Span(self.document.source, self.span(node).start, self.span(closing).end)

    def fill(self, node: Node, table: _Table, decoded: Mapping[str, Any]) -> None:
        for child in self.parts(node)[1:]:
            self.pair(table, child, decoded)

    def pair(self, table: _Table, node: Node, decoded: Mapping[str, Any]) -> None:
        key, value = self.parts(node)
        *outer, (name, span) = self.key_parts(key)
        for part, part_span in outer:
            table.add(part, part_span, _Table(part_span))
            inner = table.entries[part][1]
            if not isinstance(inner, _Table):
                return
            table, decoded = inner, decoded[part]
        table.add(name, span, self.value(value, decoded[name], span))

    def key_parts(self, node: Node) -> list[tuple[str, Span]]:
        if node.type == "dotted_key":
            return [part for child in node.named_children for part in self.key_parts(child)]
        return [(decode_key(self.raw(node)), self.span(node))]

    def value(self, node: Node, decoded: object, key: Span | None) -> Value:
        span = self.span(node)
        if span.start in self.document.invalid:
            return OtherValue("invalid", self.document.invalid[span.start])
        match decoded:
            case str():
                return StringValue(self.text(node, span, decoded), span)
            case bool():
                return BooleanValue(decoded, span)
            case int():
                return NumberValue(Fraction(decoded), self.raw(node), span)
            case Literal(text):
                kind = text.lstrip("+-")
                if kind in {"inf", "nan"}:
                    return OtherValue(kind, span)
                return NumberValue(Fraction(text.replace("_", "")), text, span)
            case list():
                items = zip(self.parts(node), decoded, strict=True)
                return ArrayValue(tuple(self.value(item, each, None) for item, each in items), span)
            case dict():
                table = _Table(key or span)
                for child in node.named_children:
                    if child.type == "pair":
                        self.pair(table, child, decoded)
                return table.freeze()
            case datetime.datetime():
                return OtherValue("date-time", span)
            case datetime.date():
                return OtherValue("date", span)
            case _:
                return OtherValue("time", span)

    def text(self, node: Node, span: Span, decoded: str) -> Text:
        quotes = quote_width(self.document.text, node.start_byte, node.end_byte)
        raw = self.raw(node)[quotes:-quotes]
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
