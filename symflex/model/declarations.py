"""Reading parameters, definitions, signals and outputs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import cast

from symflex.errors import Diagnostic, Span, Text
from symflex.expressions import FUNCTIONS, names, names_among, parse
from symflex.model.model import (
    ONE,
    PI_NEARLY,
    Assumption,
    Definition,
    ExactValue,
    ModelParameter,
    Output,
    Signal,
)
from symflex.model.reading import NAME, Reader
from symflex.model.scope import RESERVED
from symflex.model.spec import KeyValue, NumberValue, StringValue, TableValue, Value
from symflex.papers.labels import check_label
from symflex.quantities import (
    DIMENSIONLESS,
    Quantity,
    looks_like_quantity,
    parse_unit,
    unit_doubt,
    unit_named,
    unit_of,
)

SHOWN_CIRCLE = 8  # names of a circle of definitions that a message lists
ASSUMPTIONS = ("positive", "nonnegative", "real")


@dataclass(frozen=True, slots=True)
class DeclaredParameter:
    """A parameter as written: its quantity still counts cycles; ``None`` when symbolic."""

    name: str
    quantity: Quantity | None
    has_unit: bool
    unit_text: str
    assume: Assumption
    latex: str
    doc: str
    span: Span
    limits: tuple[Quantity, Quantity] | None = None  # its ``range``
    spread: Quantity | None = None

    @property
    def written_unit(self) -> str:
        """The unit of its value, or the one that stands for it; empty if none was written."""
        return self.unit_text or (self.quantity.unit if self.quantity else "")

    @property
    def measured(self) -> Quantity | None:
        """What it is measured in, with its cycles; ``None`` if no unit was written."""
        if self.quantity is None:
            return one_of(self.unit_text) if self.unit_text else None
        return self.quantity if self.has_unit else None

    def resolve(self, implied_unit: str = "", *, is_converted: bool = False) -> ModelParameter:
        """Return the parameter in SI units; what counts cycles does so still, unless it is converted."""
        unit, measured = implied_unit, self.measured
        nominal = [self.quantity] if self.quantity is not None else []
        read = Quantity.angular if is_converted else Quantity.cyclic
        exact = [ExactValue(*read(q)) for q in (*nominal, *(self.limits or ()))]
        value = exact[0] if nominal else None
        limits = (exact[-2], exact[-1]) if self.limits else None
        cycles = measured.cycles if measured is not None and not is_converted else 0
        if measured is not None and (self.quantity is None or cycles or not implied_unit):
            unit = _unit_text(measured, is_converted=is_converted)
        written = self.written_unit
        scale = _scale(written, is_converted=measured is not None and measured.cycles != cycles)
        # What is one in SI units keeps the name it was given: A*s/rad is no C/rad.
        unit = written if written and scale == ONE and not cycles else unit
        return ModelParameter(
            self.name,
            value,
            unit,
            self.assume,
            self.latex,
            self.doc,
            self.span,
            cycles,
            written_unit=written,
            scale=scale,
            limits=limits,
            spread=_resolved_spread(self.spread, is_converted=is_converted),
        )


def _resolved_spread(spread: Quantity | None, *, is_converted: bool) -> Fraction | ExactValue | None:
    if spread is None:
        return None
    if _is_share(spread):
        return spread.magnitude
    return ExactValue(*(spread.angular() if is_converted else spread.cyclic()))


def doubtful_units(declared: Iterable[DeclaredParameter]) -> Iterator[Diagnostic]:
    """Yield a warning for each parameter whose unit data sheets mean differently."""
    for p in declared:
        unit = p.written_unit
        is_slow = p.quantity and p.quantity.magnitude < 1  # 0.5 1/min is a rate, 3000 1/min a speed
        if (doubt := unit_doubt(unit)) and not ("min" in unit and is_slow):
            message = f"the unit '{unit}' of '{p.name}' may mean something else: {doubt[0]}"
            yield Diagnostic("SF656", message, p.span, doubt[1], "warning")


def one_of(unit_text: str) -> Quantity:
    """Return the SI unit of the same kind as a unit, with its cycles and radians."""
    unit = unit_of(unit_text)
    return Quantity(Fraction(1), 0, unit.cycles, unit.dimension, unit.radians, unit_text)


def _scale(written: str, *, is_converted: bool) -> ExactValue:
    """Return what one of a unit is in SI, a turn of it 2 pi radians if the value is in radians."""
    if not written:
        return ONE
    unit = unit_of(written)
    quantity = replace(one_of(written), magnitude=unit.scale, pi_power=unit.pi_power)
    return ExactValue(*(quantity.angular() if is_converted else quantity.cyclic()))


def _unit_text(quantity: Quantity, *, is_converted: bool) -> str:
    """Return the SI unit, with rad or rev where the declared unit turned."""
    turns, turn, text = quantity.radians, "rad", str(quantity.dimension)
    if is_converted:
        turns += quantity.cycles
    elif (quantity.cycles, text) == (1, "1/s"):
        return "Hz"
    elif quantity.cycles:
        turns, turn = quantity.cycles, "rev"
    if abs(turns) > 1 and turn == "rev":
        turn = f"{turn}^{abs(turns)}"
    if turns > 0 and text.startswith("1"):
        return turn + text[1:]
    if turns > 0 and turn != "rad":
        return f"{turn}*{text}"
    return f"{text}/{turn}" if turns < 0 and ("/" not in text or turn != "rad") else text


def read_label(reader: Reader, table: TableValue | None, what: str) -> str:
    """Return the ``latex`` entry of a table when it is harmless."""
    return reader.read(check_label, reader.text(table, "latex", what)) or ""


def with_formulas_defined(sections: Mapping[str, TableValue | None]) -> dict[str, TableValue | None]:
    """Return the sections with formulas of declared names among the definitions, not the parameters."""
    parameters, definitions = sections["parameters"], sections["definitions"]
    if parameters is None:
        return dict(sections)
    declared = {*parameters.keys(), *(definitions.keys() if definitions else ())}
    kept, moved = [], []
    for entry in parameters.entries:
        table = entry.value if isinstance(entry.value, TableValue) else None
        inner = table.get("value") if table else entry
        value = inner.value if inner else None
        used, starts = set[str](), ""
        if isinstance(value, StringValue) and not looks_like_quantity(value.text.value):
            used, starts = _formula_names(value.text), value.text.value.lstrip()[:1]
        may_be_units = starts.isdigit() and all(unit_named(name) for name in used)
        is_twice = bool(definitions and definitions.get(entry.key))
        given = used - {"pi", *FUNCTIONS}
        is_formula = bool(given) and given <= declared - {entry.key} and not may_be_units
        if not is_formula or is_twice or not NAME.match(entry.key):
            kept.append(entry)
        elif table is None:
            moved.append(entry)
        elif {*table.keys()} <= {"value", "doc", "latex"}:
            parts = (replace(e, key="expr") if e is inner else e for e in table.entries)
            moved.append(replace(entry, value=TableValue(tuple(parts), table.span)))
        else:
            kept.append(entry)
    if not moved:
        return dict(sections)
    others = definitions.entries if definitions else ()
    return {
        **sections,
        "parameters": TableValue(tuple(kept), parameters.span),
        "definitions": TableValue((*others, *moved), (definitions or parameters).span),
    }


def read_parameters(
    reader: Reader, section: TableValue | None, definitions: TableValue | None
) -> tuple[DeclaredParameter, ...]:
    """Return the declared parameters in order; definitions are what a formula may name as well."""
    named = {key for table in (section, definitions) if table for key in table.keys()}
    return reader.entries(section, "a parameter", lambda e: _read_parameter(reader, e, named), RESERVED)


def _read_parameter(reader: Reader, entry: KeyValue, named: Collection[str]) -> DeclaredParameter:
    what = f"parameter '{entry.key}'"
    table = entry.value if isinstance(entry.value, TableValue) else None
    if table:
        reader.keys(table, ("value", "unit", "range", "spread", "doc", "latex", "assume"), what)
    inner = table.get("value") if table else entry
    quantity = _quantity(reader, inner, what, named) if inner else None
    literal = bool(quantity and quantity.unit)
    assume, unit_text = _assumption(reader, table, what), ""
    if table is not None and table.get("unit"):
        quantity, unit_text = _with_unit(reader, quantity, reader.text(table, "unit", what), what)
        literal = literal or quantity is not None
    if problem := without_sign(entry.key, quantity, assume, (inner or entry).value.span):
        reader.take((problem,))
    label, doc = read_label(reader, table, what), reader.plain(table, "doc", what)
    p = DeclaredParameter(entry.key, quantity, literal, unit_text, assume, label, doc, entry.key_span)
    if table is None:
        return p
    return replace(p, limits=_limits(reader, table, p), spread=_spread(reader, table, p))


def _limits(reader: Reader, table: TableValue, p: DeclaredParameter) -> tuple[Quantity, Quantity] | None:
    """Return the ends of a parameter's ``range``; numbers are in the unit of its value."""
    entry, what, unit_text = table.get("range"), f"range of parameter '{p.name}'", p.written_unit
    if entry is None or (table.get("value") and p.quantity is None):
        return None
    example = 'two values, for instance range = ["50 kN/m", "200 kN/m"]'
    ends: list[Quantity] = []
    for value in reader.pair(entry.value, f"{what} must have two ends", example) or ():
        end = reader.quantity(value, what)
        if end is None:
            return None
        if not end.unit and unit_text:
            unit = unit_of(unit_text)
            scaled = (end.magnitude * unit.scale, end.pi_power + unit.pi_power)
            end = replace(one_of(unit_text), magnitude=scaled[0], pi_power=scaled[1])
        problem = _misfit(end, what, p.name, unit_text, value.span)
        if problem is None and (problem := without_sign(p.name, end, p.assume, value.span)) is not None:
            message = problem.message.replace(" is", " has a range with an end that is", 1)
            problem = replace(problem, message=message)
        if problem is not None:
            reader.take((problem,))
            return None
        ends.append(end)
    if not ends:
        return None
    low, high = (e.magnitude * Fraction(pi) ** e.pi_power for e in ends)
    if low >= high:
        reader.note("SF208", f"{what} must rise from its first end to its second", entry.value.span)
        return None
    return ends[0], ends[1]


def _misfit(given: Quantity, what: str, name: str, unit_text: str, span: Span | None) -> Diagnostic | None:
    """Return what is wrong with the unit of a range or a spread."""
    nominal = one_of(unit_text) if unit_text else Quantity(Fraction(1), 0, 0, DIMENSIONLESS, 0, "")
    turns = [q.cycles + q.radians for q in (nominal, given)]
    if given.dimension == nominal.dimension and not (
        (nominal.cycles or given.cycles) and turns[0] != turns[1]
    ):
        return None
    declared = f"is in '{unit_text}'" if unit_text else "has no unit"
    return Diagnostic("SF203", f"{what} is in '{given.unit}', and '{name}' {declared}", span)


def _spread(reader: Reader, table: TableValue, p: DeclaredParameter) -> Quantity | None:
    """Return a parameter's ``spread`` to either side: a share of its value, or a quantity in its unit."""
    entry, what = table.get("spread"), f"spread of parameter '{p.name}'"
    name, quantity, unit_text = p.name, p.quantity, p.written_unit
    spread = reader.quantity(entry.value, what, 'for instance spread = "10 %"') if entry else None
    if spread is None or entry is None:
        return None
    value = quantity.magnitude * PI_NEARLY**quantity.pi_power if quantity else None
    size, span, problem = spread.magnitude * PI_NEARLY**spread.pi_power, entry.value.span, None
    cycles = unit_of(unit_text).cycles if unit_text else 0
    most = value
    if _is_share(spread):
        most = Fraction(1)
    elif (problem := _misfit(spread, what, name, unit_text, span)) is None and spread.cycles != cycles:
        problem = Diagnostic("SF203", f"{what} is in '{spread.unit}', and '{name}' is in '{unit_text}'", span)
    if problem is None and size <= 0:
        problem = Diagnostic("SF208", f"{what} must be positive", span)
    elif problem is None and value == 0 and _is_share(spread):
        hint = "give it in the unit of the value"
        problem = Diagnostic("SF208", f"{what} is a share of its value, which is 0", span, hint)
    elif problem is None and value is not None and p.assume != "real" and most is not None:
        at_end = Quantity(most - size, 0, 0, DIMENSIONLESS, 0, "")
        problem = without_sign(name, at_end, p.assume, span)
        if problem is not None:
            message = problem.message.replace(" is", " less its spread is", 1)
            problem = replace(
                problem, message=message, hint=str(problem.hint).removeprefix("remove the minus, or ")
            )
    reader.take((problem,) if problem else ())
    return None if problem else spread


def _is_share(spread: Quantity) -> bool:
    return spread.dimension == DIMENSIONLESS and not (spread.cycles or spread.radians)


def _quantity(reader: Reader, entry: KeyValue, what: str, named: Collection[str]) -> Quantity | None:
    """Return a parameter's value; of a formula in its place, what is wrong with it is noted."""
    plain = Reader()
    quantity = plain.quantity(entry.value, what)
    text = entry.value.text if isinstance(entry.value, StringValue) else None
    formula = Reader()
    if text and text.value.replace("*", "/").split("/")[0].strip() in {*named, "pi"}:
        formula.read(parse, text)  # a formula with a mistake in it
    for problem in formula.problems or plain.problems:
        hints = (problem.hint, _formula_hint(text, named) if text and problem.code == "SF202" else None)
        reader.take((replace(problem, hint="; ".join(filter(None, hints)) or None),))
    return quantity


def _formula_hint(text: Text, named: Collection[str]) -> str | None:
    """Return what a text lacks to be a formula of parameters, nothing where it contains no name."""
    used = _formula_names(text) - {"pi", *FUNCTIONS}
    if unknown := sorted(used.difference(named)):
        return f"a formula may use only parameters, and '{unknown[0]}' is not one"
    return "a formula of parameters belongs in [definitions]" if used else None


def _formula_names(text: Text) -> set[str]:
    """Return the names in an expression, none where a text is no expression."""
    expression = Reader().read(parse, text)
    return set() if expression is None else {n.name for n in names(expression)}


def _with_unit(
    reader: Reader, quantity: Quantity | None, text: Text | None, what: str
) -> tuple[Quantity | None, str]:
    """Apply a separate ``unit`` key to a bare number, or keep it for a symbolic parameter."""
    if text is None:
        return quantity, ""
    unit = reader.read(parse_unit, text)
    if unit is None:
        return None, ""
    if quantity is None:
        return None, text.value
    if quantity.unit:
        message = f"{what} has a unit in its value and a 'unit' key"
        reader.note("SF202", message, text.span, "remove one of them")
        return quantity, ""
    scaled = Quantity(
        quantity.magnitude * unit.scale,
        quantity.pi_power + unit.pi_power,
        unit.cycles,
        unit.dimension,
        unit.radians,
        text.value,
    )
    return scaled, ""


def _assumption(reader: Reader, table: TableValue | None, what: str) -> Assumption:
    text = reader.text(table, "assume", what)
    if text is not None and text.value in ASSUMPTIONS:
        return cast("Assumption", text.value)
    if text is not None:
        # No nearest name: 'negative' would be answered with 'nonnegative'.
        hint = "a parameter is assumed " + ", ".join(ASSUMPTIONS[:-1]) + f" or {ASSUMPTIONS[-1]}"
        reader.note("SF208", f"unknown assumption '{text.value[:60]}'", text.span, hint)
    return "positive"


def without_sign(
    name: str, quantity: Quantity | None, assume: Assumption, span: Span | None
) -> Diagnostic | None:
    """Return what is wrong with the sign of a parameter's value."""
    if quantity is None or assume == "real":
        return None
    magnitude = quantity.magnitude
    if magnitude > 0 or (magnitude == 0 and assume == "nonnegative"):
        return None
    shown = "0" if magnitude == 0 else "negative"
    message = f"parameter '{name}' is {shown}, but a parameter is assumed {assume}"
    other = assuming(name, "nonnegative" if magnitude == 0 else "real")
    return Diagnostic("SF209", message, span, f"remove the minus, or {other}" if magnitude else other)


def assuming(name: str, assume: Assumption) -> str:
    """Return a hint: how a parameter is declared that may have other signs."""
    return f'write {name} = {{ value = ..., assume = "{assume}" }} in the model'


def read_definitions(reader: Reader, section: TableValue | None) -> tuple[Definition, ...]:
    """Return the definitions in order, without circular ones."""

    def read(entry: KeyValue) -> Definition | None:
        what = f"definition '{entry.key}'"
        value, label = _value_and_label(reader, entry, what, 'for instance { expr = "m*s^2" }')
        expression = None
        if isinstance(value, NumberValue | StringValue):
            expression = reader.expression(value, what)
        elif value is not None:
            reader.misfit(f"{what} must be an expression", value)
        doc = reader.plain(entry.value, "doc", what) if isinstance(entry.value, TableValue) else ""
        return None if expression is None else Definition(entry.key, expression, label, entry.key_span, doc)

    return in_order(reader, reader.entries(section, "a definition", read, RESERVED))


def _value_and_label(reader: Reader, entry: KeyValue, what: str, example: str) -> tuple[Value | None, str]:
    """Return what an entry holds, alone or as ``expr`` beside a label; None if that is missing."""
    if not isinstance(entry.value, TableValue):
        return entry.value, ""
    reader.keys(entry.value, ("expr", "latex", "doc"), what)
    label = read_label(reader, entry.value, what)
    inner = reader.needed(entry.value, "expr", entry, f"{what} has no 'expr'", example)
    return inner.value if inner else None, label


def in_order(reader: Reader, definitions: Sequence[Definition]) -> tuple[Definition, ...]:
    """Return the definitions ordered so that each uses only earlier ones."""
    by_name: Mapping[str, Definition] = {d.name: d for d in definitions}
    state: dict[str, str] = {}
    ordered: list[Definition] = []
    for start in definitions:
        if start.name in state:
            continue
        stack = [(start.name, iter(names_among(start.expression, by_name)))]
        state[start.name] = "open"
        while stack:
            name, used = stack[-1]
            following = next(used, None)
            if following is None:
                stack.pop()
                if state[name] == "open":
                    state[name] = "done"
                    ordered.append(by_name[name])
            elif following not in state:
                state[following] = "open"
                stack.append((following, iter(names_among(by_name[following].expression, by_name))))
            elif state[following] == "open":
                circle = [n for n, _ in stack]
                circle = circle[circle.index(following) :]
                shown = circle if len(circle) <= SHOWN_CIRCLE else [*circle[: SHOWN_CIRCLE - 1], "..."]
                path = " -> ".join([*shown, following])
                message = f"definitions refer to each other in a circle: {path}"
                if len(circle) == 1:
                    message = f"definition '{following}' refers to itself"
                reader.note("SF215", message, by_name[following].span)
                for member in circle:
                    state[member] = "circular"
    return tuple(ordered)


def read_signals(reader: Reader, section: TableValue | None) -> tuple[Signal, ...]:
    """Return the signals in order."""

    def read(entry: KeyValue) -> Signal | None:
        expression = reader.expression(entry.value, f"signal '{entry.key}'", quantities=False)
        return None if expression is None else Signal(entry.key, expression, entry.key_span)

    return reader.entries(section, "a signal", read, RESERVED)


def read_outputs(reader: Reader, section: TableValue | None) -> tuple[Output, ...]:
    """Return the outputs in order."""

    def read(entry: KeyValue) -> Output | None:
        what = f"output '{entry.key}'"
        value, label = _value_and_label(reader, entry, what, 'for instance { expr = "x_tip" }')
        expression = None if value is None else reader.expression(value, what, quantities=False)
        return None if expression is None else Output(entry.key, expression, None, "", label, entry.key_span)

    return reader.entries(section, "an output", read)
