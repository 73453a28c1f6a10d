"""One slip that explains a printed table: a conjecture, with its evidence.

Input: a table with wrong entries, and the text of its model. Output: a sentence, empty without such a slip.

Tried in this order: a slip of the pen in each wrong entry, a factor common to all entries, values exchanged,
another number, and one change of the specification (a support, a condition, an element, a sign, a term, an
exponent). A change counts only if every entry is right with it, and a number only if the entries say more
digits than it has.

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
from itertools import chain, combinations, islice
from typing import Final

from flint import arb

from symflex.audit.literals import (
    FACTORS,
    LATE,
    LISTED,
    SECTIONS,
    WrittenNumber,
    literals_of,
    other_text,
    refits,
    respelled,
    written,
)
from symflex.audit.tables import (
    EntryAudit,
    TableAudit,
    judge_table,
    last_place,
    printed_values,
    significant,
    verdict_on,
)
from symflex.balls import ball, precision
from symflex.budget import Budget, spend
from symflex.errors import BudgetError, Source, SymflexError
from symflex.expressions import (
    FUNCTIONS,
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
from symflex.model.spec import StringValue, TableValue
from symflex.model.spec.parse import parse as parse_specification

MOST_CHANGES: Final = 400  # changes of a model that are tried for one table
SEARCHED: Final = 40.0  # seconds after which no more changes are tried
OVER: Final = ("SF504", "SF506")  # codes of a budget that is used up
MOST_OF_ONE: Final = 40  # changes of one expression
ENOUGH_DIGITS: Final = 6  # printed digits of wrong entries in all, below which a match says little
MARGIN: Final = 3  # digits of evidence beyond those of a number that is no slip of the pen
SHOWN: Final = 3  # explanations that are named
SUPPORTS: Final = {"fixed": "fixed", "pin": "a pin", "slider": "a slider"}
EXPONENTS: Final = (1, 2, 3, 4)
ORDERS: Final = (0, 1, 2, 3)  # of derivatives in conditions
FEWEST: Final = 2  # entries that share a factor
BITS: Final = 128
EXCHANGED: Final = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}

Values = Mapping[str, ExactValue]


@dataclass(frozen=True)
class _Change:
    """One change of a model, in words, and what it makes of model and table."""

    said: str
    made: Callable[[], tuple[Model, PrintedTable]]
    digits: int = LISTED  # how many digits of evidence it takes to choose it
    literal: WrittenNumber | None = None  # the number that it changes, where that is all


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
    factor = _common_factor(found)
    text = _Text(found, source, load)
    fitting: list[_Change] = []
    if sum(significant(e.printed) for e in _wrong(found) if e.printed) >= ENOUGH_DIGITS:
        offered = chain(_of_values(model, found.table), text.exchanges(), text.refits(), text.rewritings())
        evidence = _evidence(found)
        with suppress(BudgetError), Budget(seconds=SEARCHED).entered():  # what is found before is named
            for change in islice(offered, MOST_CHANGES):
                is_likely = change.digits <= LISTED or change.digits + MARGIN <= evidence
                is_named = change.literal is not None and change.literal in {c.literal for c in fitting}
                if is_likely and not is_named and _explains(change, found):
                    fitting.append(change)
                if sum(each.digits <= LISTED for each in fitting) == SHOWN:
                    break
    least = min((each.digits for each in fitting), default=0)
    said = list(dict.fromkeys(each.said for each in fitting if each.digits <= max(least, LISTED)))[:SHOWN]
    which = {1: "the entry is", 2: "both entries are"}.get(found.count, f"all {found.count} entries are")
    if factor and said:
        return replace(found, slip=f"{factor}; or {which} right if {', or if '.join(said)}")
    return replace(found, slip=factor or (f"{which} right if {', or if '.join(said)}" if said else ""))


def explained_by_print(found: TableAudit) -> TableAudit:
    """Return the same with slips of the pen, or a factor common to all entries; no model is changed."""
    said = _pen(found) or _common_factor(found) if found.verdict == "wrong" else ""
    return replace(found, slip=said)


def _wrong(found: TableAudit) -> list[EntryAudit]:
    return [e for e in found.entries if e.verdict in ("wrong", "extra", "missing")]


def _distance(entry: EntryAudit) -> float:
    """Return how far an entry is off, in units of its last digit."""
    if entry.value is None:
        return 0.0
    return float(abs(Fraction(Decimal(entry.printed)) - entry.value) / last_place(entry.printed))


def _evidence(found: TableAudit) -> int:
    """Return how many digits the wrong entries say: one entry's, if all are off by one factor."""
    ratios = [
        (float(e.printed) / float(e.value), significant(e.printed))
        for e in _wrong(found)
        if e.value and e.printed
    ]
    digits = [digits for _, digits in ratios]
    if not digits:
        return 0
    first, apart = ratios[0][0], 10.0 ** (1 - min(digits))
    is_one = all(abs(ratio / first - 1) <= 2 * apart for ratio, _ in ratios)
    return max(digits) if is_one else sum(digits)


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
    if 1 < found.count < 2 * len(_wrong(found)):  # the pen does not slip more often than not
        return ""
    for entry in _wrong(found):
        if entry.value is None:
            return ""
        off = abs(Fraction(Decimal(entry.printed)) - entry.value) / last_place(entry.printed)
        text = respelled(entry.printed, entry.value)
        slips += text is not None
        if text is not None:
            said.append(f"{entry.printed} in row {entry.row} is {text[1]} with {text[0]}")
        elif off < LATE:
            said.append(f"{entry.printed} in row {entry.row} is off in its last digits")
        else:
            return ""
    return "; ".join(said) if slips else ""


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
    except ZeroDivisionError:  # a model that divides by what is left out
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
    for name, value in known.items():
        for said, factor in ((f"{name} is minus the declared value", -1), (f"{name} is left out", 0)):
            if value.rational:
                yield _Change(said, partial(changed, partial(_times, name=name, factor=factor)))


def _exchanged(values: Values, one: str, other: str) -> Values:
    return {**values, one: values[other], other: values[one]}


def _times(values: Values, name: str, factor: int) -> Values:
    value = values[name]
    return {**values, name: replace(value, rational=value.rational * factor)}


class _Text:
    """The text of a model, to be written with one slip."""

    def __init__(self, found: TableAudit, source: Source, load: Callable[[Source], Model]) -> None:
        self.found, self.source, self.load = found, source, load
        spec = parse_specification(source)
        self.sections = {s.key: s.value for s in spec.root.entries if isinstance(s.value, TableValue)}

    def made(self, *edits: tuple[int, int, str]) -> tuple[Model, PrintedTable]:
        """Return the model and the table with other texts from offset to offset."""
        text = self.source.text
        for start, end, new in sorted(edits, reverse=True):
            text = f"{text[:start]}{new}{text[end:]}"
        changed = self.load(replace(self.source, text=text))
        return changed, next(t for t in changed.tables if t.name == self.found.table.name)

    def changed(self, said: str, *edits: tuple[int, int, str]) -> _Change:
        """Return a change of the text."""
        return _Change(said, partial(self.made, *edits))

    def exchanges(self) -> Iterator[_Change]:
        """Yield numbers of elements of one key, or of rows, that are exchanged."""
        alone = [n for n in literals_of(self.sections, self.found.table) if n.is_alone]
        alike: dict[str, list[WrittenNumber]] = {}
        for each in alone:
            if " of " in each.path or each.row:
                alike.setdefault(each.path.split()[0], []).append(each)
        for one, other in chain.from_iterable(combinations(each, 2) for each in alike.values()):
            if one.whole != other.whole:
                pairs = (one, other), (other, one)
                edits = [(n.place, n.place + len(n.whole), by.whole) for n, by in pairs]
                yield self.changed(f"{one.path} and {other.path} are exchanged", *edits)

    def refits(self) -> Iterator[_Change]:
        """Yield other numbers with which one wrong entry is right."""
        prints = self.found.prints
        far = {e.row: e for e in sorted(_wrong(self.found), key=_distance) if e.value is not None}
        if prints is None or not far:
            return
        for literal in literals_of(self.sections, self.found.table):
            entry = far.get(literal.row or min(far))
            if entry is None or entry.column is None:
                continue

            def at(
                number: float, literal: WrittenNumber = literal, entry: EntryAudit = entry
            ) -> float | None:
                try:
                    model, table = self.made(_edit(literal, repr(number)))
                    only = replace(table, rows=(table.rows[entry.row - 1],))
                    values = printed_values(model, only, prints)
                except SymflexError as error:
                    if error.diagnostics[0].code in OVER:
                        raise
                    return None
                column = (entry.column or 1) - 1
                return values[column] if column < len(values) else None

            for refit in refits(literal, entry.printed, at, float(entry.value or 0)):
                change = self.changed(refit.said, _edit(literal, refit.text))
                yield replace(change, digits=refit.digits, literal=literal)

    def rewritings(self) -> Iterator[_Change]:
        """Yield one support, element or expression written differently."""
        elements = self.sections["elements"].entries if "elements" in self.sections else ()
        for entry in elements:
            kind = entry.value.get("type") if isinstance(entry.value, TableValue) else None
            if kind is None or not isinstance(kind.value, StringValue):
                continue
            named, span = kind.value.text.value, kind.value.text.span
            for other in SUPPORTS if named in SUPPORTS else ():
                if other != named:
                    said = f"{entry.key} is {SUPPORTS[other]}, not {SUPPORTS[named]}"
                    yield self.changed(said, (span.start, span.end, other))
            whole = entry.key_span.start, entry.value.span.end, ""
            yield self.changed(f"{entry.key} ({named}) is left out", whole)
        for section in SECTIONS:
            for path, value in written(section, self.sections.get(section)):
                if isinstance(value, StringValue):
                    place, old = value.text.span, value.text.value
                    for new in islice(_rewritten(value), MOST_OF_ONE):
                        yield self.changed(other_text(path, new, old), (place.start, place.end, new))


def _edit(literal: WrittenNumber, number: str) -> tuple[int, int, str]:
    start = literal.place + literal.start
    return start, start + len(literal.text), number


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
            case Call(name, argument, order) if name not in FUNCTIONS:  # a condition at a point of a field
                for other in ORDERS:
                    if other != order:
                        yield replace_node(expression, part, Call(name, argument, other))
            case Product(factors):
                for factor in factors:
                    left = product_of([f for f in factors if f is not factor])
                    yield replace_node(expression, part, left)
    for times in (2, Fraction(1, 2)):
        yield product_of([number(times), expression])
