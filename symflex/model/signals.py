"""Reading signals and outputs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.model.declarations import read_label
from symflex.model.model import Output, Signal
from symflex.model.reading import Reader
from symflex.model.scope import RESERVED
from symflex.model.spec import TableValue

if TYPE_CHECKING:
    from symflex.model.spec import KeyValue


def read_signals(reader: Reader, section: TableValue | None) -> tuple[Signal, ...]:
    """Return the signals in order."""
    found: list[Signal] = []
    for entry in section.entries if section else ():
        if reader.name(entry, "a signal", RESERVED):
            expression = reader.expression(entry.value, f"signal '{entry.key}'", quantities=False)
            if expression is not None:
                found.append(Signal(entry.key, expression, entry.key_span))
    return tuple(found)


def read_outputs(reader: Reader, section: TableValue | None) -> tuple[Output, ...]:
    """Return the outputs in order."""
    found: list[Output] = []
    for entry in section.entries if section else ():
        if reader.name(entry, "an output"):
            output = _read_output(reader, entry)
            if output is not None:
                found.append(output)
    return tuple(found)


def _read_output(reader: Reader, entry: KeyValue) -> Output | None:
    what, value, label = f"output '{entry.key}'", entry.value, ""
    if isinstance(value, TableValue):
        reader.keys(value, ("expr", "latex", "doc"), what)
        label = read_label(reader, value, what)
        inner = value.get("expr")
        if inner is None:
            hint = 'for instance { expr = "x_tip" }'
            reader.note("SF214", f"{what} has no 'expr'", entry.key_span, hint)
            return None
        value = inner.value
    expression = reader.expression(value, what, quantities=False)
    return None if expression is None else Output(entry.key, expression, None, "", label, entry.key_span)
