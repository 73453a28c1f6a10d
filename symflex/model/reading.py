"""Reading values out of a parsed specification, noting every problem instead of stopping at the first."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from symflex.errors import Diagnostic, Span, SpecError, Text, nearest
from symflex.expressions import Expression, Negative, Number, parse
from symflex.library.words import FORMULAS, key_meant
from symflex.model.spec import ArrayValue, BooleanValue, NumberValue, OtherValue, StringValue, TableValue
from symflex.quantities import DIMENSIONLESS, Quantity, looks_like_quantity, name_hint, parse_quantity

if TYPE_CHECKING:
    from symflex.model.spec import KeyValue, Value

Made = TypeVar("Made")

NAMED = "a formula cannot contain a value with a unit: declare it in [parameters]"
LOSS_WORDS = ("loss", "loss_factor", "tan_delta", "damping", "structural", "g")
"""What a key for a loss factor is called elsewhere."""
SHOWN = 40  # characters of a value that a message repeats
MAX_PROBLEMS = 100  # more than anybody reads at once
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}\Z")


@dataclass(frozen=True, slots=True)
class QuantityLiteral(Expression):
    """A quantity written where an expression may stand: ``m = "150 g"``."""

    quantity: Quantity


def shorten(text: str) -> str:
    """Return the text, cut where it is too long for a message."""
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


def describe(value: Value) -> str:
    """Return what a value is, for messages."""
    match value:
        case StringValue():
            return f"the string '{shorten(value.text.value)}'"
        case NumberValue():
            return f"the number {shorten(value.literal)}"
        case BooleanValue():
            return "true" if value.value else "false"
        case ArrayValue():
            return f"an array of {len(value.items)}"
        case TableValue():
            return "a table"
        case _:
            return value.kind if value.kind in ("inf", "nan") else f"a {value.kind}"


@dataclass(slots=True)
class Reader:
    """Typed access to entries; ``problems`` collects what does not fit."""

    problems: list[Diagnostic] = field(default_factory=list)

    def take(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Add problems found elsewhere; SpecError when they are more than anybody would read."""
        self.problems.extend(diagnostics)
        if len(self.problems) > MAX_PROBLEMS:
            message = f"more than {MAX_PROBLEMS} problems; only the first ones are listed"
            more = Diagnostic("SF103", message, None, "fix these, then check again")
            raise SpecError(*self.problems[:MAX_PROBLEMS], more)

    def misfit(self, message: str, value: Value, hint: str | None = None) -> None:
        """Note a value of the wrong kind, unless its syntax error is already reported."""
        if not (isinstance(value, OtherValue) and value.kind == "invalid"):
            self.note("SF206", f"{message}, found {describe(value)}", value.span, hint)

    def pair(self, value: Value, message: str, hint: str) -> tuple[Value, Value] | None:
        """Return the two items of an array; anything else is noted with a message."""
        match value:
            case ArrayValue(items=(first, second)):
                return first, second
        self.misfit(message, value, hint)
        return None

    def note(self, code: str, message: str, span: Span | None, hint: str | None = None) -> None:
        """Add one problem."""
        self.take((Diagnostic(code, message, span, hint),))

    def table(self, entry: KeyValue, what: str, hint: str | None = None) -> TableValue | None:
        """Return the entry's table."""
        if isinstance(entry.value, TableValue):
            return entry.value
        self.misfit(f"{what} must be a table", entry.value, hint)
        return None

    def keys(self, table: TableValue, allowed: Iterable[str], what: str, example: str = "") -> frozenset[str]:
        """Note every key that is not allowed, and return those plainly meant by them."""
        offered = tuple(allowed)
        absent = [k for k in offered if table.get(k) is None]
        keys: set[str] = set()
        for entry in table.entries:
            if entry.key not in offered:
                meant = key_meant(entry.key, absent)
                keys |= {meant} if meant else set()
                hint = f"write {meant}" if meant else nearest(entry.key, offered)
                hint = hint or "; ".join(filter(None, ("known keys: " + ", ".join(offered), example)))
                if entry.key in LOSS_WORDS and "eta_s" in offered:
                    hint = "a loss factor is 'eta_s'"
                elif formulas := [FORMULAS[entry.key, k] for k in offered if (entry.key, k) in FORMULAS]:
                    hint = f"write {formulas[0]}"
                elif entry.key == "matrices":
                    hint = "Python's symflex.from_matrices(M=..., D=..., K=...) makes a model of matrices"
                self.note("SF207", f"unknown key '{entry.key}' in {what}", entry.key_span, hint)
        return frozenset(keys)

    def name(self, entry: KeyValue, what: str, reserved: Mapping[str, str] | None = None) -> bool:
        """Tell whether the entry's key is a name; ``reserved`` says why some are taken."""
        if not NAME.match(entry.key):
            usual = "names are a letter followed by up to 63 letters, digits and underscores"
            message = f"'{entry.key[:80]}' is not a name for {what}"
            self.note("SF213", message, entry.key_span, name_hint(entry.key) or usual)
            return False
        if reserved and entry.key in reserved:
            message = f"'{entry.key}' is reserved and cannot name {what}"
            self.note("SF213", message, entry.key_span, reserved[entry.key])
            return False
        return True

    def entries(
        self,
        section: TableValue | None,
        what: str,
        read: Callable[[KeyValue], Made | None],
        reserved: Mapping[str, str] | None = None,
    ) -> tuple[Made, ...]:
        """Return what can be read of the entries of a section, in order, whose keys are names."""
        named = (e for e in (section.entries if section else ()) if self.name(e, what, reserved))
        return tuple(made for made in map(read, named) if made is not None)

    def string(self, entry: KeyValue, what: str) -> Text | None:
        """Return the entry's string."""
        if isinstance(entry.value, StringValue):
            return entry.value.text
        self.misfit(f"{what} must be a string", entry.value)
        return None

    def text(self, table: TableValue | None, key: str, what: str) -> Text | None:
        """Return an optional string of a table, None when missing."""
        entry = table.get(key) if table else None
        return self.string(entry, f"{key} of {what}") if entry else None

    def plain(self, table: TableValue | None, key: str, what: str) -> str:
        """Return an optional string, empty when missing."""
        text = self.text(table, key, what)
        return text.value if text else ""

    def needed(
        self, table: TableValue, key: str, entry: KeyValue, message: str, hint: str | None = None
    ) -> KeyValue | None:
        """Return what the table of an entry must hold; the message reports that it does not."""
        given = table.get(key)
        if given is None:
            self.note("SF214", message, entry.key_span, hint)
        return given

    def strings(
        self, entry: KeyValue, what: str, kind: str = "a string or an array of strings"
    ) -> tuple[Text, ...] | None:
        """Return the entry's array of strings; one string counts as an array of one."""
        value = entry.value
        if isinstance(value, StringValue):
            return (value.text,)
        if isinstance(value, ArrayValue) and all(isinstance(i, StringValue) for i in value.items):
            return tuple(i.text for i in value.items if isinstance(i, StringValue))
        self.misfit(f"{what} must be {kind}", value)
        return None

    def read(self, make: Callable[[Text], Made], text: Text | None) -> Made | None:
        """Return what is made of a string, None without one or where it is wrong, which is noted."""
        try:
            return None if text is None else make(text)
        except SpecError as error:
            self.take(error.diagnostics)
            return None

    def quantity(self, value: Value, what: str, hint: str | None = None) -> Quantity | None:
        """Return a number or a quantity; the hint is for one that is malformed and has no better one."""
        if isinstance(value, NumberValue):
            return Quantity(value.value, 0, 0, DIMENSIONLESS, 0, "")
        if isinstance(value, StringValue):
            try:
                return parse_quantity(value.text)
            except SpecError as error:
                self.take(
                    replace(d, hint=d.hint or (hint if d.code == "SF202" else None))
                    for d in error.diagnostics
                )
                return None
        self.misfit(f'{what} must be a number or a quantity such as "35 kN/m"', value)
        return None

    def expression(self, value: Value, what: str, *, quantities: bool = True) -> Expression | None:
        """Return an expression, a number, or, where it may stand, a quantity as :class:`QuantityLiteral`."""
        if isinstance(value, NumberValue):
            return signed_number(value.value, value.span)
        if not isinstance(value, StringValue):
            self.misfit(f"{what} must be an expression or a number", value)
            return None
        if quantities and looks_like_quantity(value.text.value):
            quantity = self.quantity(value, what, NAMED)
            if quantity is None:
                return None
            if quantity.unit:
                return QuantityLiteral(quantity, span=value.text.span)
        return self.read(parse, value.text)


def signed_number(value: Fraction, span: Span | None = None) -> Expression:
    """Return a rational number as an expression."""
    if value < 0:
        return Negative(Number(-value, span=span), span=span)
    return Number(Fraction(value), span=span)


def literal_value(expression: Expression) -> Fraction | None:
    """Return the number an expression is when it is only that, in the unit it was written in."""
    match expression:
        case Number(value):
            return value
        case QuantityLiteral(quantity):
            return quantity.magnitude
        case Negative(operand):
            inner = literal_value(operand)
            return None if inner is None else -inner
        case _:
            return None


def has_ports(value: Value) -> bool:
    """Tell whether a block is an ``ss`` that lists what goes in and comes out."""
    if not isinstance(value, TableValue) or not (value.get("from") or value.get("to")):
        return False
    kind = value.get("type")
    return kind is not None and isinstance(kind.value, StringValue) and kind.value.text.value == "ss"
