"""Reading ``[tables]``: roots that a paper printed, digit by digit.

Input: the section of a specification and its model. Output: a :class:`~symflex.model.PrintedTable` for each
entry, whose digits stay text: ``"16.250"`` promises one digit more than ``"16.25"``.

    [tables."Table 1"]
    of     = "poles"
    prints = "omega*l^2*sqrt(rho*A/(E*I))"
    rows   = [ { set = { m = "1 kg" }, values = ["1.5573", "16.250"] } ]
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

from symflex.algebra import LAPLACE
from symflex.errors import Text, UsageError
from symflex.expressions import Expression, Name, names, substitute
from symflex.model.analysis import check_printed, named_pairs, pick_tf, readable_names
from symflex.model.declarations import assuming
from symflex.model.model import ROOT_QUANTITIES, ExactValue, Model, PrintedRow, PrintedTable, Published
from symflex.model.network import AsWritten
from symflex.model.reading import Reader
from symflex.model.settings import value_in_unit
from symflex.model.spec import ArrayValue, KeyValue, NumberValue, StringValue, TableValue, Value
from symflex.papers.tabular import GAP, PRINTED, cells_of, comma_of, lists_of
from symflex.quantities import parse_quantity

KEYS = ("of", "tf", "prints", "rows", "values", "latex", "source", "doc")
ROW_KEYS = ("set", "values")
MOST_ENTRIES = 2000  # a printed page has fewer
EXAMPLE = 'for instance { prints = "f", rows = [{ values = ["8.231", "51.58"] }] }'


def read_tables(
    reader: Reader, section: TableValue | None, model: Model, cycles: AsWritten
) -> tuple[PrintedTable, ...]:
    """Return the printed tables; what is wrong in one is noted at its place."""
    entries = section.entries if section else ()
    return tuple(filter(None, (_TableReading(reader, model, cycles, entry).table() for entry in entries)))


@dataclass(frozen=True)
class _TableReading:
    """One table as it is read."""

    reader: Reader
    model: Model
    cycles: AsWritten
    entry: KeyValue

    @property
    def what(self) -> str:
        return f"table '{self.entry.key[:80]}'"

    def table(self) -> PrintedTable | None:
        reader, what = self.reader, self.what
        table = reader.table(self.entry, what, EXAMPLE)
        if table is None:
            return None
        reader.keys(table, KEYS, what)
        pairs = named_pairs(self.model)
        if not pairs:
            return None
        of, tf = reader.text(table, "of", what), reader.text(table, "tf", what)
        if of is not None and of.value not in ("poles", "zeros"):
            reader.note("SF208", f"of of {what} is '{of.value[:60]}'", of.span, 'write "poles" or "zeros"')
            return None
        pair = pick_tf(reader, tf.value, tf.span, pairs) if tf else next(iter(pairs.values()))
        given = table.get("prints")
        prints = self._prints(given) if given else None
        rows = tuple(self._rows(table))
        cited = reader.plain(table, "source", what)
        if pair is None or (given and prints is None) or not rows:
            return None
        kind: Literal["poles", "zeros"] = "zeros" if of is not None and of.value == "zeros" else "poles"
        return PrintedTable(self.entry.key, pair, kind, prints, rows, cited, self.entry.key_span)

    def _prints(self, entry: KeyValue) -> Expression | None:
        """Return what the table prints of a root, with 2 pi beside what is declared in cycles."""
        reader, what = self.reader, f"prints of {self.what}"
        expression = reader.expression(entry.value, what, quantities=False)
        if expression is None:
            return None
        readable = readable_names(self.model)
        constants = readable.constants - {LAPLACE}
        used = {name.name: name for name in names(expression)}
        taken = used.keys() & ROOT_QUANTITIES.keys() & {*constants, *readable.definitions}
        for name in sorted(taken):
            message = f"'{name}' in {what} is a name of the model and {ROOT_QUANTITIES[name]}"
            reader.note("SF213", message, used[name].span, "give what the model calls so another name")
        known = replace(readable, constants=constants | ROOT_QUANTITIES.keys())
        problems = check_printed(Published(("", ""), expression), known)
        reader.take(problems)
        if taken or problems:
            return None
        if not used.keys() & ROOT_QUANTITIES:
            hint = 'for instance "f" or "omega*sqrt(m/k)"'
            reader.note("SF208", f"{what} has nothing of a root", entry.value.span, hint)
            return None
        # As in a printed formula, a parameter in hertz beside s is read in radians, and beside f in hertz.
        written = substitute(expression, {"omega": Name(LAPLACE)})
        read = self.cycles.printed(Published(("", ""), written)).expression
        return substitute(read, {LAPLACE: Name("omega")})

    def _rows(self, table: TableValue) -> Iterator[PrintedRow]:
        reader, what = self.reader, self.what
        rows, values, latex = table.get("rows"), table.get("values"), table.get("latex")
        many = list(filter(None, (rows, values, latex)))
        if len(many) != 1:
            message = f"{what} has {' and '.join(each.key for each in many) or 'no rows'}"
            reader.note("SF214", message, (many[-1] if many else self.entry).key_span, EXAMPLE)
            return
        (given,) = many
        if given is latex:
            yield from self._typed(given)
            return
        items: tuple[Value, ...] = (given.value,)
        if given is rows:
            if not isinstance(given.value, ArrayValue):
                reader.misfit(f"rows of {what} must be an array", given.value, EXAMPLE)
                return
            items = given.value.items
        count, comma = 0, comma_of(_strings(items))
        for item in items:
            if (row := self._row(item, comma)) is None:
                continue
            count += len(row.entries)
            if count > MOST_ENTRIES:
                reader.note("SF103", f"{what} has more than {MOST_ENTRIES} entries", item.span, "split it")
                return
            yield row

    def _typed(self, entry: KeyValue) -> Iterator[PrintedRow]:
        """Yield the lists of numbers of a tabular."""
        text = self.reader.string(entry, f"latex of {self.what}")
        found = None if text is None else self.reader.read(lambda text: lists_of(cells_of(text)), text)
        if found == ():
            hint = "a column that counts 1, 2, 3 makes the other columns lists; else rows are"
            self.reader.note("SF208", f"latex of {self.what} has no list of numbers", entry.value.span, hint)
        for each in found or ():
            yield PrintedRow((), each.entries, entry.value.span, each.heading)

    def _row(self, item: Value, comma: str | None) -> PrintedRow | None:
        reader, what = self.reader, f"a row of {self.what}"
        values, given = item, tuple[tuple[str, ExactValue], ...]()
        if isinstance(item, TableValue):
            reader.keys(item, ROW_KEYS, what)
            entry, settings = item.get("values"), item.get("set")
            if entry is None:
                reader.note("SF214", f"{what} has no 'values'", item.span, EXAMPLE)
                return None
            values = entry.value
            inner = reader.table(settings, f"set of {what}") if settings else None
            given = tuple(filter(None, map(self._setting, inner.entries if inner else ())))
        if not isinstance(values, ArrayValue):
            reader.misfit(f"values of {what} must be an array", values, EXAMPLE)
            return None
        texts = tuple(self._printed(value, comma) for value in values.items)
        if None in texts or not texts:
            return None
        return PrintedRow(given, tuple(filter(None, texts)), item.span)

    def _printed(self, value: Value, comma: str | None) -> str | None:
        """Return the digits of an entry as they stand, ``None`` for what is no number."""
        match value:
            case StringValue():
                shown = value.text.value.strip()
            case NumberValue():
                shown = value.literal
            case _:
                shown = ""
        plain = shown if comma is None else shown.replace(",", comma)
        if plain == GAP or PRINTED.match(plain):
            return plain
        message = f'an entry of {self.what} must be the digits as printed, or "-" for a gap'
        if PRINTED.match(shown.replace(",", "")):
            message = f"the comma in {shown[:40]} of {self.what} may be a decimal comma or part thousands"
        self.reader.misfit(message, value, 'for instance "16.250"')
        return None

    def _setting(self, entry: KeyValue) -> tuple[str, ExactValue] | None:
        reader, what = self.reader, f"set of a row of {self.what}"
        known = {p.name: p for p in self.model.parameters}
        if entry.key not in known:
            hint = "parameters: " + (", ".join(list(known)[:8]) or "none")
            reader.note("SF210", f"{what} has an unknown parameter '{entry.key[:64]}'", entry.key_span, hint)
            return None
        match entry.value:
            case StringValue():
                text = entry.value.text
            case NumberValue():
                text = Text(entry.value.literal, entry.value.span)
            case _:
                reader.misfit(f"{entry.key} in {what} must be a value", entry.value)
                return None
        quantity = reader.read(parse_quantity, text)
        if quantity is None:
            return None
        parameter = known[entry.key]
        try:
            value = value_in_unit(parameter, quantity)
        except UsageError as error:
            reader.note("SF203", error.diagnostics[0].message, text.span, error.diagnostics[0].hint)
            return None
        if value.rational < 0 and parameter.assume != "real":
            message = f"'{entry.key}' is negative in {what}, but is assumed {parameter.assume}"
            reader.note("SF209", message, text.span, assuming(entry.key, "real"))
            return None
        return entry.key, value


def _strings(items: Iterable[Value]) -> Iterator[str]:
    """Yield the texts of entries."""
    for item in items:
        match item:
            case StringValue():
                yield item.text.value.strip()
            case ArrayValue():
                yield from _strings(item.items)
            case TableValue() if (values := item.get("values")) is not None:
                yield from _strings((values.value,))
