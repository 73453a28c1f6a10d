"""Whether lengths, stiffnesses and delays of distributed parts can be what they are said to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.elements import LineElement
from symflex.model.reading import literal_value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from symflex.elements import Sign
    from symflex.errors import Span
    from symflex.expressions import Expression
    from symflex.model.draft import Draft
    from symflex.model.points import Line
    from symflex.model.reading import Reader


@dataclass(frozen=True, slots=True)
class RangedValue:
    """A value that has to be positive, or not negative; ``what`` and ``reason`` are for messages."""

    what: str
    expression: Expression
    sign: Sign
    reason: str


def ranged_values(draft: Draft) -> Iterator[RangedValue]:
    """Yield the values of distributed elements and delays that cannot have any sign."""
    for use in draft.elements:
        element = use.element
        if not isinstance(element, LineElement):
            continue
        given = dict(use.values)
        for port in element.parameters:
            sign: Sign = "positive" if port.name == element.length else port.sign
            if sign != "any" and port.name in given:
                reason = f"{port.doc} is positive" if sign == "positive" else f"{port.doc} cannot be"
                what = f"{port.name} of {element.type_name} '{use.name}'"
                yield RangedValue(what, given[port.name], sign, reason)
    for placed in draft.blocks:
        block = placed.block
        if block is not None and block.kernel_time:
            what = f"{block.kernel_time} of {block.type_name} '{placed.name}'"
            time = dict(placed.values)[block.kernel_time]
            yield RangedValue(what, time, "nonnegative", "a delay cannot look ahead")


def check_ranges(reader: Reader, draft: Draft, line: Line, unsound: set[Span | None]) -> None:
    """Note values of distributed parts that are zero or negative where they cannot be.

    Parameters
    ----------
    reader : Reader
        Takes what is wrong.
    draft : Draft
        What was read.
    line : Line
        Tells signs, from values and from what is assumed of parameters.
    unsound : set of Span
        Places that hold a mistake already; those found here are added.
    """
    for ranged in ranged_values(draft):
        expression, least = ranged.expression, 1 if ranged.sign == "positive" else 0
        if expression.span in unsound:
            continue
        sign = line.sign(expression)
        if sign is None or sign >= least:
            continue
        value = None if literal_value(expression) is not None else line.value(expression)
        shown = f" ({float(value):.6g})" if value else ""
        word = "negative" if sign < 0 else "0"
        reader.note("SF209", f"{ranged.what} is {word}{shown}; {ranged.reason}", expression.span)
        unsound.add(expression.span)
