"""Whether lengths, stiffnesses and delays of distributed parts can be what they are said to be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.library.elements import LineElement
from symflex.model.analysis import PI_NEARLY
from symflex.model.points import Line
from symflex.model.reading import literal_value

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from fractions import Fraction

    from symflex.errors import Span
    from symflex.expressions import Expression
    from symflex.library.elements import Sign
    from symflex.model.draft import Draft
    from symflex.model.model import ExactValue, Model
    from symflex.model.reading import Reader


@dataclass(frozen=True, slots=True)
class RangedValue:
    """A value that has to be positive, or not negative; ``what`` and ``reason`` are for messages."""

    what: str
    expression: Expression
    sign: Sign
    reason: str


def ranged_values(draft: Draft | Model) -> Iterator[RangedValue]:
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

    Signs are told by ``line``, from values and what is assumed of parameters. Places in ``unsound`` hold a
    mistake already; those found here are added.
    """
    for ranged in ranged_values(draft):
        expression, least = ranged.expression, 1 if ranged.sign == "positive" else 0
        if expression.span in unsound:
            continue
        sign = line.sign(expression)
        if sign is None or sign >= least:
            continue
        value = None if literal_value(expression) is not None else line.value(expression)
        reader.note("SF209", _message(ranged, sign, value), expression.span)
        unsound.add(expression.span)


def check_value(model: Model, name: str, value: ExactValue, varied: Collection[str]) -> None:
    """Refuse a value of a parameter with which a distributed part is what none can be.

    All other parameters keep their declared values, but for those ``varied``, which do not count.

    Raises
    ------
    UsageError
        SF209 a length, stiffness or dead time of a sign it cannot have.
    """
    known = {p.name: p.value for p in model.parameters if p.value and p.name not in varied} | {name: value}
    line = Line(
        {d.name: d.expression for d in model.definitions},
        frozenset(p.name for p in model.parameters if p.assume == "positive"),
        # The value itself tells the sign of what it stands for alone.
        frozenset(p.name for p in model.parameters if p.assume == "nonnegative" and p.name != name),
        {each: v.rational * PI_NEARLY**v.pi_power for each, v in known.items()},
    )
    for ranged in ranged_values(model):
        sign = line.sign(ranged.expression)
        if sign is not None and sign < (1 if ranged.sign == "positive" else 0):
            message = _message(ranged, sign, line.value(ranged.expression))
            shown = float(value.rational * PI_NEARLY**value.pi_power)
            raise UsageError(Diagnostic("SF209", f"with {name} = {shown:.6g}, {message}"))


def _message(ranged: RangedValue, sign: int, value: Fraction | None) -> str:
    shown = f" ({float(value):.6g})" if value else ""
    return f"{ranged.what} is {'negative' if sign < 0 else '0'}{shown}; {ranged.reason}"
