"""What was read of a specification, before names and units are checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.model.declarations import DeclaredParameter
from symflex.model.model import (
    Definition,
    FieldProblem,
    ModelParameter,
    NetworkNode,
    Output,
    PlacedBlock,
    Signal,
)
from symflex.model.network import DraftElement, DraftInput
from symflex.model.spec import ArrayValue, StringValue, TableValue

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from symflex.model.spec import KeyValue


@dataclass(frozen=True, slots=True)
class Draft:
    """What was read, before names and units were checked."""

    declared: tuple[DeclaredParameter, ...]
    inherited: tuple[ModelParameter, ...]
    definitions: tuple[Definition, ...]
    nodes: tuple[NetworkNode, ...]
    elements: tuple[DraftElement, ...]
    inputs: tuple[DraftInput, ...]
    blocks: tuple[PlacedBlock, ...]
    signals: tuple[Signal, ...]
    outputs: tuple[Output, ...]
    fields: tuple[FieldProblem, ...] = ()


def broken_names(sections: Mapping[str, TableValue | None], draft: Draft) -> frozenset[str]:
    """Return the names in declarations that could not be read: their own and those of nodes listed there."""
    read = {
        "parameters": {p.name for p in draft.declared},
        "definitions": {d.name for d in draft.definitions},
        "elements": {e.name for e in draft.elements},
        "inputs": {d.input.name for d in draft.inputs},
        "signals": {x.name for x in draft.signals},
        "blocks": {b.name for b in draft.blocks},
        "fields": {f.name for f in draft.fields},
    }
    broken: set[str] = set()
    for section, names_read in read.items():
        table = sections[section]
        for entry in table.entries if table else ():
            if entry.key not in names_read:
                broken.add(entry.key)
                if not isinstance(entry.value, TableValue):
                    continue
                if section in ("elements", "inputs"):
                    broken.update(_listed_names(entry.value.entries))
                if section == "fields":
                    broken.update(_listed_names(e for e in entry.value.entries if e.key == "unknowns"))
    return frozenset(broken)


def _listed_names(entries: Iterable[KeyValue]) -> Iterator[str]:
    for entry in entries:
        items = entry.value.items if isinstance(entry.value, ArrayValue) else (entry.value,)
        yield from (i.text.value.partition(".")[0] for i in items if isinstance(i, StringValue))
