"""One slip that explains a printed table: a conjecture, with its evidence.

Input: a table with wrong entries, and the text of its model. Output: a sentence, empty without such a slip.

Tried in this order: a slip of the pen in each wrong entry, a factor common to all entries, another value of a
parameter, and one change of the specification (a support, an element, a sign, a term, an exponent). A change
counts only if every entry is right with it.

Example: frequencies of a cantilever are printed as 124.26, 402.67 and 840.15 Hz. They are wrong, and right if
its wall is a pin; no other change makes them so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import partial
from itertools import chain, combinations, islice, pairwise
from typing import Final

from flint import arb

from symflex.audit.tables import EntryAudit, TableAudit, judge_table, last_place, significant, verdict_on
from symflex.balls import ball, precision
from symflex.budget import Budget, spend
from symflex.errors import BudgetError, Source, SymflexError
from symflex.expressions import (
    Call,
    Expression,
    Power,
    Product,
    Sum,
    format_expression,
    is_number,
    negative,
    nodes,
    number,
    parse,
    parse_equation,
    power,
    product_of,
    replace_node,
    sum_of,
)
from symflex.model import ExactValue, Model, PrintedTable
from symflex.model.spec import ArrayValue, StringValue, TableValue, Value
from symflex.model.spec.parse import parse as parse_specification

MOST_CHANGES: Final = 400  # changes of a model that are tried for one table
SEARCHED: Final = 40.0  # seconds after which no more changes are tried
OVER: Final = ("SF504", "SF506")  # codes of a budget that is used up
MOST_OF_ONE: Final = 40  # changes of one expression
ENOUGH_DIGITS: Final = 6  # printed digits of wrong entries in all, below which a match says little
SHOWN: Final = 3  # explanations that are named
LATE: Final = 20  # units of the last digit by which an entry is off that was computed with too few
FACTORS: Final[Mapping[str, tuple[Fraction, int, bool]]] = {
    "2 pi times": (Fraction(2), 1, False),
    "1/(2 pi) times": (Fraction(1, 2), -1, False),
    "twice": (Fraction(2), 0, False),
    "half": (Fraction(1, 2), 0, False),
    "pi times": (Fraction(1), 1, False),
    "1/pi times": (Fraction(1), -1, False),
    "4 times": (Fraction(4), 0, False),
    "1/4 of": (Fraction(1, 4), 0, False),
    "10 times": (Fraction(10), 0, False),
    "1/10 of": (Fraction(1, 10), 0, False),
    "1000 times": (Fraction(1000), 0, False),
    "1/1000 of": (Fraction(1, 1000), 0, False),
    "minus": (Fraction(-1), 0, False),
    "8 times": (Fraction(8), 0, False),
    "1/8 of": (Fraction(1, 8), 0, False),
    "16 times": (Fraction(16), 0, False),
    "1/16 of": (Fraction(1, 16), 0, False),
    "60 times": (Fraction(60), 0, False),
    "60/(2 pi) times": (Fraction(30), -1, False),
    "180/pi times": (Fraction(180), -1, False),
    "sqrt(2) times": (Fraction(2), 0, True),
    "1/sqrt(2) times": (Fraction(1, 2), 0, True),
    "sqrt(3) times": (Fraction(3), 0, True),
}
"""What a unit, a diameter for a radius or a decimal point makes of a value: rational, power of pi, and
whether its square root is meant."""
SUPPORTS: Final = ("fixed", "pin", "slider")
WRITTEN: Final = (
    "definitions",
    "elements",
    "signals",
    "equations",
    "fields",
    "energy",
    "blocks",
    "parameters",
)
"""Sections whose expressions are changed."""
EXPONENTS: Final = (1, 2, 3, 4)
DIGITS: Final = "0123456789"
FEWEST: Final = 2  # entries that share a factor
BITS: Final = 128
EXCHANGED: Final = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}

Values = Mapping[str, ExactValue]


@dataclass(frozen=True)
class _Change:
    """One change of a model, in words, and what it makes of model and table."""

    said: str
    made: Callable[[], tuple[Model, PrintedTable]]


def audit_tables(model: Model, source: Source, load: Callable[[Source], Model]) -> tuple[TableAudit, ...]:
    """Return what is found about the printed tables of a model, with slips that explain wrong entries."""
    return tuple(explained(judge_table(model, table), model, source, load) for table in model.tables)


def explained(found: TableAudit, model: Model, source: Source, load: Callable[[Source], Model]) -> TableAudit:
    """Return what was found about a table with the slip that makes all of its entries right, if one does.

    ``load`` makes a model of a changed text of the specification.
    """
    if found.verdict != "wrong" or found.prints is None:
        return found
    if pen := _pen(found):
        return replace(found, slip=pen)
    said = [factor] if (factor := _common_factor(found)) else []
    if sum(significant(e.printed) for e in _wrong(found) if e.printed) >= ENOUGH_DIGITS:
        offered = chain(_of_values(model, found.table), _of_text(found.table, source, load))
        fitting = (c.said for c in islice(offered, MOST_CHANGES) if _explains(c, found))
        with (
            suppress(BudgetError),
            Budget(seconds=SEARCHED).entered(),
        ):  # a slip found before that is still named
            said += islice(fitting, SHOWN)
    which = "the entry is" if found.count == 1 else f"all {found.count} entries are"
    evidence = f": with this {which} right" if said else ""
    return replace(found, slip="; or ".join(said) + evidence)


def explained_by_print(found: TableAudit) -> TableAudit:
    """Return the same with slips of the pen, or a factor common to all entries; no model is changed."""
    said = _pen(found) or _common_factor(found) if found.verdict == "wrong" else ""
    return replace(found, slip=said)


def _wrong(found: TableAudit) -> list[EntryAudit]:
    return [e for e in found.entries if e.verdict in ("wrong", "extra", "missing")]


def _common_factor(found: TableAudit) -> str:
    """Return what all entries are off by, where that is one factor."""
    entries = [e for e in found.entries if e.value and e.verdict not in ("gap", "missing")]
    if len(entries) < max(FEWEST, found.count):
        return ""
    with precision(BITS):
        for name, (rational, pi_power, is_root) in FACTORS.items():
            factor = ball(rational) * arb.pi() ** pi_power
            factor = factor.sqrt() if is_root else factor
            verdicts = {verdict_on(e.printed, ball(e.value or Fraction(0)) * factor) for e in entries}
            if verdicts <= {"right", "rounded"}:
                return f"every entry is {name} what it should be"
    return ""


def _pen(found: TableAudit) -> str:
    """Return the slips of the pen in all wrong entries, nothing if one has none."""
    said, slips = [], 0
    for entry in _wrong(found):
        if entry.value is None:
            return ""
        off = abs(Fraction(Decimal(entry.printed)) - entry.value) / last_place(entry.printed)
        text = _respelled(entry.printed, entry.value)
        slips += text is not None
        if text is not None:
            said.append(f"{entry.printed} in row {entry.row} is {text[1]} with {text[0]}")
        elif off < LATE:
            said.append(f"{entry.printed} in row {entry.row} is off in its last digits")
        else:
            return ""
    return "; ".join(said) if slips else ""


def _respelled(printed: str, value: Fraction) -> tuple[str, str] | None:
    """Return what happened to a decimal on its way to the page, and what it was; None if nothing simple did.

    >>> _respelled("3.15601", Fraction("3.5160152685")), _respelled("1111", Fraction("1011.2"))
    (('two digits exchanged', '3.51601'), ('a mistyped digit', '1011'))
    """
    places = [i for i, c in enumerate(printed) if c.isdigit()]
    offered: list[tuple[str, str]] = []
    for i, j in pairwise(places):
        swapped = [*printed]
        swapped[i], swapped[j] = printed[j], printed[i]
        offered.append(("two digits exchanged", "".join(swapped)))
    early = places[: -1 if abs(Fraction(Decimal(printed)) - value) > LATE * last_place(printed) else -2]
    offered += [("one digit too many", printed[:i] + printed[i + 1 :]) for i in early]
    offered += [("a mistyped digit", printed[:i] + d + printed[i + 1 :]) for i in early for d in DIGITS]
    offered += [("a digit left out", printed[:i] + d + printed[i:]) for i in places[1:-1] for d in DIGITS]
    plain = "" if "e" in printed.lower() else printed.replace(".", "")
    moved = [f"{plain[:i]}.{plain[i:]}" for i in range(1, len(plain))]
    offered += [("a decimal point at another place", text) for text in moved]
    for what, text in offered:
        if text != printed and text.strip("-+.") and verdict_on(text, ball(value)) in ("right", "rounded"):
            return what, text
    return None


def _explains(change: _Change, found: TableAudit) -> bool:
    """Tell whether all entries are right with a change, tried on the first wrong row first."""
    spend()
    wrong = _wrong(found)
    try:
        model, table = change.made()
        first = wrong[0].row - 1
        table = replace(table, prints=found.prints)
        if not judge_table(model, replace(table, rows=(table.rows[first],))).is_right:
            return False
        return len(table.rows) == 1 or judge_table(model, table).is_right
    except SymflexError as error:
        if error.diagnostics[0].code in OVER:
            raise
        return False


def _of_values(model: Model, table: PrintedTable) -> Iterator[_Change]:
    """Yield other values of a parameter, and two values exchanged."""
    known = {p.name: p.value for p in model.parameters if p.value is not None and not p.value.is_imaginary}

    def changed(new: Callable[[Values], Values]) -> tuple[Model, PrintedTable]:
        rows = tuple(
            replace(row, values=tuple(new({**known, **dict(row.values)}).items())) for row in table.rows
        )
        return model, replace(table, rows=rows)

    alike: dict[str, list[str]] = {}
    for parameter in model.parameters:
        if parameter.name in known:
            alike.setdefault(parameter.unit, []).append(parameter.name)
    for one, other in chain.from_iterable(combinations(each, 2) for each in alike.values()):
        if known[one] != known[other] or any({one, other} & dict(r.values).keys() for r in table.rows):
            exchange = partial(_exchanged, one=one, other=other)
            yield _Change(f"{one} and {other} are exchanged", partial(changed, exchange))
    for said, (factor, pi_power, is_root) in FACTORS.items():
        for name, value in known.items():
            if value.rational and not is_root:
                times = partial(_times, name=name, factor=factor, pi_power=pi_power)
                yield _Change(f"{name} is {said} its value", partial(changed, times))
    for name, value in known.items():
        if value.rational:
            nothing = partial(_times, name=name, factor=Fraction(0), pi_power=0)
            yield _Change(f"{name} is left out", partial(changed, nothing))


def _exchanged(values: Values, one: str, other: str) -> Values:
    return {**values, one: values[other], other: values[one]}


def _times(values: Values, name: str, factor: Fraction, pi_power: int) -> Values:
    value = values[name]
    return {**values, name: ExactValue(value.rational * factor, value.pi_power + pi_power)}


def _of_text(table: PrintedTable, source: Source, load: Callable[[Source], Model]) -> Iterator[_Change]:
    """Yield one support, element or expression written differently."""
    spec = parse_specification(source)
    sections = {s.key: s.value for s in spec.root.entries if isinstance(s.value, TableValue)}
    elements = sections["elements"].entries if "elements" in sections else ()

    def made(start: int, end: int, new: str) -> tuple[Model, PrintedTable]:
        text = f"{source.text[:start]}{new}{source.text[end:]}"
        changed = load(replace(source, text=text))
        return changed, next(t for t in changed.tables if t.name == table.name)

    for entry in elements:
        kind = entry.value.get("type") if isinstance(entry.value, TableValue) else None
        if kind is None or not isinstance(kind.value, StringValue):
            continue
        written, span = kind.value.text.value, kind.value.text.span
        for other in SUPPORTS if written in SUPPORTS else ():
            if other != written:
                said = f"{entry.key} is a {other} and no {written}"
                yield _Change(said, partial(made, span.start, span.end, other))
        ends = entry.key_span.start, entry.value.span.end
        yield _Change(f"{entry.key} ({written}) is left out", partial(made, *ends, ""))
    for section in WRITTEN:
        for path, value in _strings(section, sections.get(section)):
            old = value.text.value
            for new in islice(_rewritten(value), MOST_OF_ONE):
                place = value.text.span
                yield _Change(f"{path} is {new} and not {old}", partial(made, place.start, place.end, new))


def _strings(path: str, value: Value | None) -> Iterator[tuple[str, StringValue]]:
    """Yield the strings below a section, with what they belong to."""
    match value:
        case StringValue() if value.text.verbatim:
            yield path, value
        case TableValue():
            for entry in value.entries:
                if entry.key not in ("type", "at", "between", "doc", "latex", "unit", "assume", "from", "to"):
                    yield from _strings(
                        entry.key if path in WRITTEN else f"{entry.key} of {path}", entry.value
                    )
        case ArrayValue():
            for item in value.items:
                yield from _strings(path, item)


def _rewritten(value: StringValue) -> Iterator[str]:
    """Yield an expression or an equation with one slip."""
    written = value.text.value
    try:
        if "=" in written:
            equation = parse_equation(value.text)
            sides = equation.left, equation.right
            for i, side in enumerate(sides):
                for new in _mistyped(side):
                    yield " = ".join(map(format_expression, (*sides[:i], new, *sides[i + 1 :])))
            return
        expression = parse(value.text)
    except SymflexError:  # a quantity, or words
        return
    yield from map(format_expression, _mistyped(expression))


def _mistyped(expression: Expression) -> Iterator[Expression]:
    """Yield an expression with a sign, term, exponent, function, or a factor that is another one."""
    for part in nodes(expression):
        match part:
            case Sum(terms):
                for i, term in enumerate(terms):
                    others = terms[:i], terms[i + 1 :]
                    yield replace_node(expression, part, sum_of([*others[0], negative(term), *others[1]]))
                    yield replace_node(expression, part, sum_of([*others[0], *others[1]]))
            case Power(base, exponent):
                for other in EXPONENTS:
                    if not is_number(exponent, other):
                        yield replace_node(expression, part, power(base, other))
            case Call(name, argument) if name in EXCHANGED:
                yield replace_node(expression, part, Call(EXCHANGED[name], argument))
            case Product(factors):
                for factor in factors:
                    left = product_of([f for f in factors if f is not factor])
                    yield replace_node(expression, part, left)
    for times in (2, Fraction(1, 2)):
        yield product_of([number(times), expression])
