r"""A specification as an editor holds it: its text, what is right of it, its problems, and its names.

Input: a text and the name of its file. Output: an :class:`OpenDocument`. What is wrong with a text does not
hide the rest of it: names come from the entries that are TOML, as ``parse_with_recovery`` gives them.

    document = examined('symflex = 1\n[parameters]\nm = "3 kg"\n', "a.toml")
    [each.name for each in document.names if each.is_definition]    ["m"]
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from symflex import pipeline
from symflex.budget import Budget
from symflex.errors import Diagnostic, Source, Span, SpecError, SymflexError
from symflex.library.elements import ELEMENTS
from symflex.model import Model
from symflex.model.spec import (
    ArrayValue,
    KeyValue,
    Spec,
    StringValue,
    TableValue,
    Value,
    parse_with_recovery,
)
from symflex.quantities import looks_like_quantity

DEFINING = ("parameters", "definitions", "inputs", "outputs", "signals", "blocks", "fields", "ports")
"""Sections whose keys are names that expressions use."""
PROSE = {"title", "source", "doc", "latex", "unit", "type", "kind", "assume", "quantity", "spec", "method"}
"""Keys whose text has no names of the model in it."""
NODE_KEYS = {port.name for e in ELEMENTS.values() for port in e.ports} | {
    port.pair for e in ELEMENTS.values() for port in e.ports if port.pair
}
MOST_SECONDS = 3.0  # of an examination, behind which the next keystroke waits
_NAME = re.compile(r"(?<![\w.])[A-Za-z]\w*")
_NAMES_AS_KEYS = {"operating_point", "published", "forces", "set"}
"""Tables whose keys are names that are defined elsewhere, or transfer functions between them."""
_NAMED_LISTS = {"equations": "unknowns", "energy": "coordinates"}
"""Sections that name their unknowns in a list, and its key."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name, where it is defined or used."""

    name: str
    span: Span
    is_definition: bool
    is_node: bool  # a node of the network, which its first element defines


@dataclass(frozen=True)
class OpenDocument:
    """A text, what is right of it, and what is not."""

    source: Source
    model: Model | None  # None when there is a problem
    problems: tuple[Diagnostic, ...]  # errors, or else warnings, in the order of the text

    @cached_property
    def spec(self) -> Spec | None:
        """What of it is TOML; None beyond the limits of a text."""
        try:
            return parse_with_recovery(self.source)[0]
        except SpecError:
            return None

    @cached_property
    def names(self) -> tuple[Occurrence, ...]:
        """Every name in the order of the text."""
        if self.spec is None:
            return ()
        found = sorted(_names(self.spec.root), key=lambda each: each.span.start)
        defined = {each.name for each in found if each.is_definition}
        first = {n.name: n.span for n in reversed(found) if n.is_node and n.name not in {*defined, "ground"}}
        return tuple(
            replace(
                each,
                is_node=each.name in first,
                is_definition=each.is_definition or first.get(each.name) == each.span,
            )
            for each in found
        )

    def at(self, offset: int) -> Occurrence | None:
        """Return the name at a place of the text."""
        return next((n for n in self.names if n.span.start <= offset <= n.span.end), None)


def examined(text: str, name: str, allow_outside: Sequence[str] = ()) -> OpenDocument:
    """Return a text with its problems, those of ``symflex check``."""
    source = Source(name, text)
    try:
        with Budget(seconds=MOST_SECONDS).entered():
            model = pipeline.loads(text, name, allow_outside)
            return OpenDocument(source, model, pipeline.warnings(model, pipeline.checked(model)))
    except SymflexError as error:
        return OpenDocument(source, None, error.diagnostics)


def _names(root: TableValue) -> Iterator[Occurrence]:
    for section in root.entries:
        if not isinstance(section.value, TableValue):
            continue
        for entry in section.value.entries:
            if section.key in DEFINING:
                yield Occurrence(entry.key, _bare(entry.key_span, entry.key), True, False)
            elif section.key in _NAMES_AS_KEYS:
                yield from _of_key(entry)
            if entry.key == _NAMED_LISTS.get(section.key):
                yield from (replace(each, is_definition=True) for each in _within(entry.value, entry.key))
            else:
                yield from _within(entry.value, entry.key)


def _within(value: Value, key: str, where: frozenset[str] = frozenset()) -> Iterator[Occurrence]:
    """Yield the names that a value contains, but for those that a list of its own defines."""
    if isinstance(value, TableValue):
        inner = value.get("where")
        if inner is not None and isinstance(inner.value, TableValue):
            where |= set(inner.value.keys())
        is_of_another_file = value.get("spec") is not None
        for entry in value.entries:
            if entry.key == "tf" and is_of_another_file:
                continue
            if key in _NAMES_AS_KEYS:
                yield from _of_key(entry)
            yield from _within(entry.value, entry.key, where)
    elif isinstance(value, ArrayValue):
        for item in value.items:
            yield from _within(item, key, where)
    elif isinstance(value, StringValue) and key not in PROSE and not looks_like_quantity(value.text.value):
        for match in _NAME.finditer(value.text.value):
            if match[0] not in where and value.text.verbatim:
                yield Occurrence(match[0], value.text.at(*match.span()), False, key in NODE_KEYS)


def _of_key(entry: KeyValue) -> Iterator[Occurrence]:
    """Yield the names in a key."""
    span = _bare(entry.key_span, entry.key)
    for match in _NAME.finditer(entry.key):
        start, end = match.span()
        yield Occurrence(match[0], Span(span.source, span.start + start, span.start + end), False, False)


def _bare(span: Span, name: str) -> Span:
    """Return the place of a key without its quotes."""
    quotes = (span.end - span.start - len(name)) // 2
    return Span(span.source, span.start + quotes, span.end - quotes)
