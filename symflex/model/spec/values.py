"""What a specification holds: exact values, each with the place it was written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from symflex.errors import Source, Span, Text


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
    value: Value  # what it holds


@dataclass(frozen=True, slots=True)
class Spec:
    """A whole specification: the text and what it says."""

    source: Source
    root: TableValue


Value: TypeAlias = StringValue | NumberValue | BooleanValue | ArrayValue | TableValue | OtherValue
