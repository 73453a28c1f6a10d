"""The sections of a specification, and what stands below a heading that it does not belong to.

In TOML a key belongs to the heading above it, a dotted one too::

    [elements]
    body = { type = "mass", at = "x", m = "m" }
    inputs.F = { force = "x" }

Here ``inputs`` is an element, without a type, and the specification has no inputs. That is of
no help: :func:`settled_problems` says instead which heading the key stands below, and where to write it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symflex.errors import Diagnostic, Span
from symflex.model.reading import Reader, describe
from symflex.model.spec import ArrayValue, KeyValue, Spec, StringValue, TableValue
from symflex.quantities import looks_like_quantity

FORMAT_VERSION = 1
SECTIONS = tuple(
    "parameters definitions elements inputs outputs ports signals equations operating_point energy blocks "
    "sampled fields published notation tables analysis figures drawing".split()
)
TOP_KEYS = ("symflex", "title", "source", "doc", *SECTIONS)
CONSEQUENCES = ("SF210", "SF218")  # what is noted of a name that was lost with a mistake elsewhere
NEEDED = {"inputs": 'F = { force = "x_act" }', "outputs": 'X = "x_tip"'}
"""Sections that no specification is without, with an example of each."""


def check_header(reader: Reader, spec: Spec) -> None:
    """Note unknown keys of the whole text, and a format version that is not this program's."""
    reader.keys(spec.root, TOP_KEYS, "the specification")
    version = spec.root.get("symflex")
    if version is None:
        message = "the specification does not state its format version"
        reader.note("SF200", message, Span(spec.source, 0, 0), "begin the file with: symflex = 1")
        return
    literal = getattr(version.value, "value", None)
    if literal != FORMAT_VERSION or isinstance(literal, bool):
        message = f"the format version is {describe(version.value)}; this program reads version 1"
        reader.note("SF200", message, version.value.span, "write symflex = 1")


def read_section(reader: Reader, spec: Spec, name: str) -> TableValue | None:
    """Return a section's table, ``None`` if there is none."""
    entry = spec.root.get(name)
    if entry is None:
        return None
    many = isinstance(entry.value, ArrayValue)
    hint = f"write one [{name}] with a line 'name = ...' for each of them" if many else None
    return reader.table(entry, f"[{name}]", hint)


def settled_problems(spec: Spec, problems: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return problems without those that follow from a section lost as misspelt, no table or misplaced."""
    kept, misplaced = _without_misplaced(spec, problems)
    if misplaced or _has_lost_sections(spec):
        return [p for p in kept if p.code not in CONSEQUENCES]
    return [*kept, *_empty_sections(spec)]


def _without_misplaced(
    spec: Spec, problems: Sequence[Diagnostic]
) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """Return the problems with one for each key below a wrong heading, and these alone."""
    kept, misplaced = list(problems), []
    for section in spec.root.entries:
        if section.key not in SECTIONS or not isinstance(section.value, TableValue):
            continue
        for entry in section.value.entries:
            if spec.root.get(entry.key) is not None or not _looks_misplaced(entry):
                continue
            places = list(_spans(entry))
            remaining = [
                p
                for p in kept
                if not p.span or not any(each.start <= p.span.start < each.end for each in places)
            ]
            if entry.key == "symflex":
                remaining = [p for p in remaining if p.code != "SF200"]
            if len(remaining) < len(kept):
                kept = remaining
                misplaced.append(_below(section.key, entry))
    return [*kept, *misplaced], misplaced


def _looks_misplaced(entry: KeyValue) -> bool:
    """Tell whether an entry that cannot be read is more likely a key of the whole text than a name."""
    match entry.value:
        case TableValue():
            return entry.key in SECTIONS and not any(
                entry.value.get(key) for key in ("type", "value", "expr")
            )
        case StringValue():
            return entry.key in TOP_KEYS and not looks_like_quantity(entry.value.text.value)
        case _:
            return entry.key in TOP_KEYS


def _spans(entry: KeyValue) -> Iterator[Span]:
    yield from (entry.key_span, entry.value.span)
    if isinstance(entry.value, TableValue):
        for inner in entry.value.entries:
            yield from _spans(inner)


def _below(heading: str, entry: KeyValue) -> Diagnostic:
    message = f"'{entry.key}' is below [{heading}] and so belongs to it"
    if entry.key in SECTIONS:
        hint = f"write a heading [{entry.key}], or '{entry.key}.' above all headings"
    else:
        hint = f"write '{entry.key} = ...' above all headings"
    return Diagnostic("SF207", message, entry.key_span, hint)


def _has_lost_sections(spec: Spec) -> bool:
    """Tell whether a section is misspelt or no table, so that its names are not known."""
    return any(
        isinstance(e.value, TableValue) != (e.key in SECTIONS)
        for e in spec.root.entries
        if e.key in SECTIONS or e.key not in TOP_KEYS
    )


def _empty_sections(spec: Spec) -> list[Diagnostic]:
    diagnostics = []
    for name, example in NEEDED.items():
        entry = spec.root.get(name)
        if entry is None or (isinstance(entry.value, TableValue) and not entry.value.entries):
            span = entry.key_span if entry else Span(spec.source, 0, 0)
            message = f"the specification has no [{name}]"
            hint = f"below a heading [{name}], for instance: {example}"
            diagnostics.append(Diagnostic("SF214", message, span, hint))
    return diagnostics
