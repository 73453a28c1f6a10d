"""Reading ``[equations]``, linear equations of motion as they stand on paper, and ``ss`` blocks with ports.

Input: the section. Output: a :class:`~symflex.model.model.Signal` for each unknown, whose expression is an
equation; which equation an unknown is listed with does not matter.

    unknowns  = ["x", "theta"]
    equations = ["(M + m)*s^2*x + m*l*s^2*theta = F", "s^2*x + l*s^2*theta - g*theta = 0"]

A block in state space that lists what goes in and comes out has a signal for each output as well.

    type = "ss", from = ["u", "w"], to = ["y"], A = [["-a", 2], [0, -3]], B = [[0, 1], [5, 0]], C = [[1, 0]]
    s*G_x_1 = -a*G_x_1 + 2*G_x_2 + 1*w,    s*G_x_2 = -3*G_x_2 + 5*u,    y = 1*G_x_1
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from symflex.algebra import LAPLACE
from symflex.errors import Text, counted, nearest
from symflex.expressions import (
    Attribute,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    is_number,
    names,
    number,
    product_of,
    sum_of,
)
from symflex.model.blocks import items_of, matrix_rows
from symflex.model.fields import name_problem, parsed
from symflex.model.model import Signal
from symflex.model.reading import Reader, has_ports
from symflex.model.spec import KeyValue, TableValue
from symflex.model.units import lower

KEYS = ("unknowns", "equations", "doc")
EXAMPLE = 'for instance: unknowns = ["x"], equations = ["m*s^2*x + k*x = F"]'
BLOCK_KEYS = ("type", "from", "to", "A", "B", "C", "D", "states", "doc")
PORTS_EXAMPLE = 'for instance from = ["u_1", "u_2"], to = ["y_1", "y_2"]'


def read_equations(
    reader: Reader, section: TableValue | None, taken: Collection[str], signals: Collection[str]
) -> tuple[Signal, ...]:
    """Return the unknowns of ``[equations]``; ``taken`` names parameters, definitions and blocks."""
    if section is None:
        return ()
    what = "[equations]"
    reader.keys(section, KEYS, what, EXAMPLE)
    entries = {key: section.get(key) for key in KEYS[:2]}
    for key, entry in entries.items():
        if entry is None and all(e.key in KEYS for e in section.entries):
            location = section.entries[0].key_span if section.entries else section.span
            reader.note("SF214", f"{what} has no {key}", location, EXAMPLE)
    named, written = entries["unknowns"], entries["equations"]
    if named is None or written is None:
        return ()
    texts = reader.strings(named, f"unknowns of {what}", "an array of names")
    equations = parsed(reader, reader.strings(written, f"equations of {what}", "an array of equations"))
    if texts is None or equations is None:
        return ()
    owners = dict.fromkeys(signals, "signals")
    good = True
    for text in texts:
        problem = name_problem(text.value, taken, {})
        if problem is None and text.value in owners:
            again = "is named twice" if not owners[text.value] else "is a signal already"
            problem = "SF211", f"the unknown '{text.value}' {again}", "rename one of them"
        if problem is not None:
            code, message, hint = problem
            reader.note(code, message, text.span, hint)
            good = False
        owners.setdefault(text.value, "")
    if good and len(texts) != len(equations):
        message = f"{what} has {counted(len(equations), 'equation')} for {counted(len(texts), 'unknown')}"
        more = len(equations) > len(texts)
        hint = "list in 'unknowns' what the equations determine" if more else "each unknown needs an equation"
        spare = equations[len(texts)].span if more else texts[len(equations)].span
        reader.note("SF242", message, spare, hint)
        return ()
    if not good:
        return ()
    pairs = zip(texts, equations, strict=True)
    return tuple(Signal(text.value, equation, text.span) for text, equation in pairs)


def check_unknowns(reader: Reader, signals: Sequence[Signal], others: Iterable[Expression]) -> None:
    """Note every unknown of ``[equations]`` that no equation holds, nor anything else that acts."""
    unknowns = [x for x in signals if isinstance(x.expression, Equation)]
    everything = (*(x.expression for x in signals), *others)
    used = {
        n.owner if isinstance(n, Attribute) else n.name
        for e in (everything if unknowns else ())
        for n in names(e)
        if isinstance(n, Name | Attribute)
    }
    for unknown in unknowns:
        if unknown.name not in used:
            hint = nearest(unknown.name, used) or "leave it out, together with one equation"
            reader.note("SF242", f"no equation contains the unknown '{unknown.name}'", unknown.span, hint)


def read_state_equations(
    reader: Reader, section: TableValue | None, taken: Collection[str], signals: Collection[str]
) -> tuple[Signal, ...]:
    """Return states and outputs; ``taken`` names parameters, definitions and other blocks."""
    read: list[Signal] = []
    for entry in section.entries if section else ():
        if isinstance(entry.value, TableValue) and has_ports(entry.value):
            read += _read_ports(reader, entry, entry.value, taken, {*signals, *(x.name for x in read)})
    return tuple(read)


def _read_ports(
    reader: Reader, entry: KeyValue, table: TableValue, taken: Collection[str], signals: set[str]
) -> list[Signal]:
    what = f"ss '{entry.key}'"
    reader.keys(table, BLOCK_KEYS, what)
    needed = [
        reader.needed(table, k, entry, f"{what} lacks {k}", PORTS_EXAMPLE) for k in ("from", "to", *"ABC")
    ]
    given = {e.key: e for e in (*needed, table.get("D"), table.get("states")) if e is not None}
    if None in needed:
        return []
    sources = [
        reader.expression(x, f"from of {what}", quantities=False) for x in items_of(given["from"].value)
    ]
    outputs = reader.strings(given["to"], f"to of {what}")
    numbers = range(1, len(items_of(given["A"].value)) + 1)
    states: tuple[Text, ...] | None = tuple(Text(f"{entry.key}_x_{i}", entry.key_span) for i in numbers)
    if "states" in given:
        states = reader.strings(given["states"], f"states of {what}")
    if outputs is None or states is None:
        return []
    is_good = None not in sources
    for text in (*states, *outputs):
        problem = name_problem(text.value, taken, {})
        if problem is None and text.value in signals:
            problem = "SF211", f"'{text.value}' is a signal already", "rename one of them"
        if problem is not None:
            reader.note(problem[0], problem[1].replace("an unknown", "a signal"), text.span, problem[2])
            is_good = False
        signals.add(text.value)
    order, count = len(numbers), len(sources)
    sizes = {
        "A": (len(states),) * 2,
        "B": (order, count),
        "C": (len(outputs), order),
        "D": (len(outputs), count),
    }
    a, b, c, d = (
        matrix_rows(reader, given[k].value, f"{k} of {what}", size)
        if k in given
        else [[number(0)] * count] * len(outputs)
        for k, size in sizes.items()
    )
    if not is_good or a is None or b is None or c is None or d is None:
        return []
    return _state_signals(states, [x for x in sources if x is not None], outputs, (a, b, c, d))


def _state_signals(
    states: Sequence[Text],
    sources: Sequence[Expression],
    outputs: Sequence[Text],
    matrices: Sequence[Sequence[Sequence[Expression]]],
) -> list[Signal]:
    """Return ``s x = A x + B u`` and ``y = C x + D u``, a signal per row."""
    a, b, c, d = matrices
    moving = [Name(x.value, span=x.span) for x in states]
    columns = [*moving, *sources]
    sums = [
        sum_of(_times(x, name) for x, name in zip((*of_states, *of_sources), columns, strict=True))
        for of_states, of_sources in zip((*a, *c), (*b, *d), strict=True)
    ]
    rows: list[Expression] = [
        Equation(Product((Name(LAPLACE), x)), total, span=x.span)
        for x, total in zip(moving, sums, strict=False)
    ]
    rows += [replace(total, span=y.span) for total, y in zip(sums[len(states) :], outputs, strict=True)]
    return [Signal(x.value, row, x.span) for x, row in zip((*states, *outputs), rows, strict=True)]


def _times(entry: Expression, factor: Expression) -> Expression:
    """Return a product in which 1 stays, as a number may have any unit."""
    value = lower(entry)
    if is_number(value, 0):
        return value
    if isinstance(value, Negative):
        return Negative(_times(value.operand, factor))
    return Product((value, factor)) if isinstance(value, Number) else product_of([value, factor])
