"""Printed tables of roots against certified ones: every entry right, badly rounded or wrong.

Input: a model with its ``[tables]``. Output: a :class:`TableAudit` for each.

Roots are enclosed to more digits than are printed, so balls decide which decimal is the nearest one. Entries
belong to roots in their order. Where one was left out or added, the cheapest monotone pairing is taken
(Needleman and Wunsch, 1970).

Example: for a clamped-free beam, ``omega*l^2*sqrt(rho*A/(E*I))`` is 3.51601527. Printed "3.5160" is right,
"3.5161" badly rounded, and "3.15601" wrong, with one right digit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import accumulate, chain
from math import floor, inf, isfinite, log, log10
from typing import Final, Literal

from flint import acb, arb

from symflex.audit.numeric import value_of
from symflex.balls import ball, precision
from symflex.errors import SymflexError, Text
from symflex.expressions import (
    Expression,
    Name,
    format_expression,
    negative,
    number,
    power,
    product_of,
    quotient,
    substitute,
)
from symflex.loops.over import with_values
from symflex.model import ExactValue, Model, PrintedRow, PrintedTable
from symflex.papers.tabular import GAP, cells_of, lists_of
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import PoleZeroMap
from symflex.roots.region import Everything, Modes
from symflex.roots.root import GUARD_BITS, Root
from symflex.transfer.of_model import derive_for_roots

EntryVerdict = Literal["right", "rounded", "wrong", "extra", "missing", "undecided", "unread", "gap"]
TableVerdict = Literal["right", "rounded", "wrong", "undecided"]

BEYOND: Final = 8  # digits beyond the printed ones: on which side of a half a value lies
MORE: Final = 30  # digits beyond where these do not decide it
LATER: Final = 2  # modes searched beyond the printed ones, since one may have been left out among them
MOST_MODES: Final = 400  # searched for one row
# Costs of a pairing. A wrong entry that is near its root is a wrong entry, and one at another root is not.
WRONG, FAR, FARTHEST, SKIPPED, SPARE_ENTRY = 0.7, 3.0, 1.5, 1.0, 2.3
BITS: Final = 4  # of a decimal digit, rounded up
_OMEGA, _F, _ZETA = Name("omega"), Name("f"), Name("zeta")
COMMON: Final[Mapping[str, Expression]] = {
    "omega [rad/s]": _OMEGA,
    "f [Hz]": _F,
    "f [rpm]": product_of([number(60), _F]),
    "omega^2": power(_OMEGA, 2),
    "1/f [s]": quotient(number(1), _F),
    "omega_n [rad/s]": Name("omega_n"),
    "f_n [Hz]": Name("f_n"),
    "zeta": _ZETA,
    "zeta [%]": product_of([number(100), _ZETA]),
    "sigma [rad/s]": Name("sigma"),
    "-sigma [rad/s]": negative(Name("sigma")),
}
"""What tables print that do not say what: the one with which most entries are right."""
POWERS: Final = (Fraction(1), Fraction(1, 2), Fraction(2), Fraction(-1))
"""Exponents of omega in frequencies, wavenumbers of beams, eigenvalues and periods."""
CLOSE: Final = 0.5  # share of entries that must be right to 1 % for a reading to be taken
CLOSE_IN_PROPORTION: Final = 0.75  # where a factor was chosen that makes some of them so
FEWEST_CLOSE: Final = 2  # of a row with more than one entry: one alone may be near by chance
NEAR: Final = 0.01
FEWEST_ENTRIES: Final = 3  # for a factor that is not said
NO_READING: Final = "what the table prints of a root is not said, and no common quantity fits"


@dataclass(frozen=True, slots=True)
class EntryAudit:
    """One printed entry; of a root that was left out, only the right value."""

    row: int  # from 1
    column: int | None  # from 1
    printed: str
    verdict: EntryVerdict
    right: str = ""  # the nearest decimal with as many digits
    digits: int = 0  # how many significant digits are right, of a wrong entry
    value: Fraction | None = None  # the true value, to more digits than are printed


@dataclass(frozen=True, slots=True)
class TableAudit:
    """What was found about one printed table."""

    table: PrintedTable
    prints: Expression | None  # what the entries are; ``None`` where nothing that is common fits
    reading: str  # the same in words
    entries: tuple[EntryAudit, ...]
    reason: str = ""  # what is not proved
    slip: str = ""  # a conjecture: one change with which all entries are right

    @property
    def right(self) -> int:
        """How many entries are right to the last digit."""
        return sum(entry.verdict == "right" for entry in self.entries)

    @property
    def count(self) -> int:
        """How many entries are printed."""
        return sum(entry.verdict not in ("gap", "missing", "unread") for entry in self.entries)

    @property
    def close(self) -> int:
        """How many entries are right to a hundredth."""
        pairs = [(float(e.printed), float(e.value)) for e in self.entries if e.value]
        return sum(abs(printed - true) <= NEAR * abs(true) for printed, true in pairs)

    @property
    def is_right(self) -> bool:
        """Whether every entry is right, if badly rounded, and none is missing."""
        return self.verdict in ("right", "rounded")

    @property
    def verdict(self) -> TableVerdict:
        """The worst of the entries."""
        found = {entry.verdict for entry in self.entries}
        if found & {"wrong", "extra", "missing"}:
            return "wrong"
        if "undecided" in found or self.reason or self.prints is None:
            return "undecided"
        return "rounded" if "rounded" in found else "right"


def judge_table(model: Model, table: PrintedTable) -> TableAudit:
    """Compare a printed table with certified roots.

    Raises
    ------
    SymflexError
        As :func:`symflex.roots.locate.locate` for roots that cannot be found.
    """
    rows = _located_rows(model, table)
    if table.prints is not None:
        return _judged(table, rows, table.prints, format_expression(table.prints))
    if any(row.heading for row in table.rows):  # columns may print different quantities
        each = [_read([row], table) for row in rows]
    else:
        each = [_read(rows, table)]
    quantities = {audit.reading: audit.prints for audit in each if audit.prints is not None}
    for i, audit in enumerate(each):  # a column that is half right in the quantity of another one
        if audit.prints is None:
            again = [_judged(table, [rows[i]], prints, reading) for reading, prints in quantities.items()]
            best = max(again, key=lambda one: one.close, default=audit)
            each[i] = best if best.close >= max(CLOSE * best.count, 1) else audit
    return _joined(table, each)


def printed_values(model: Model, table: PrintedTable, prints: Expression) -> list[float]:
    """Return what the first row of a table would print of the roots that every table lists."""
    return [float(value.mid()) for value, _ in _located_rows(model, table)[0].nonzero(prints)]


def _located_rows(model: Model, table: PrintedTable) -> list[_RowOfRoots]:
    """Return the rows of a table with the roots of a model; rows with the same values share them."""
    digits = max(map(significant, (e for row in table.rows for e in row.entries if e != GAP)), default=4)
    longest = max(len(row.entries) for row in table.rows)
    known: dict[tuple[tuple[str, ExactValue], ...], _Located] = {}
    for row in table.rows:
        known[row.values] = known.get(row.values) or _Located(model, table, row.values, longest, digits)
    return [_RowOfRoots(known[row.values], row) for row in table.rows]


def _joined(table: PrintedTable, each: Sequence[TableAudit]) -> TableAudit:
    """Return what was found about a table whose rows were judged one by one, or together."""
    if len(each) == 1:
        return each[0]
    read = [audit for audit in each if audit.prints is not None] or each[:1]
    entries = tuple(replace(e, row=i) for i, audit in enumerate(each, 1) for e in audit.entries)
    readings = dict.fromkeys(audit.reading for audit in read)
    reasons = dict.fromkeys(filter(None, (audit.reason for audit in read)))
    return TableAudit(table, read[0].prints, "; ".join(readings), entries, "; ".join(reasons))


def _read(rows: Sequence[_RowOfRoots], table: PrintedTable) -> TableAudit:
    """Return what is found about rows that do not say what they print."""
    readings = chain(COMMON.items(), _in_proportion(rows))
    tried = [_judged(table, rows, prints, reading) for reading, prints in readings]
    best = max(tried, key=lambda audit: (audit.is_right, audit.close))
    least = CLOSE if best.reading in COMMON else CLOSE_IN_PROPORTION
    if best.close >= max(least * best.count, min(FEWEST_CLOSE, best.count), 1):
        return best
    entries = tuple(
        EntryAudit(i, j, text, "gap" if text == GAP else "unread")
        for i, row in enumerate(rows, 1)
        for j, text in enumerate(row.row.entries, 1)
    )
    has_roots = any(row.located.values(_OMEGA, BEYOND) for row in rows)
    none = f"{'/'.join(table.tf)} has no {table.of}"
    return TableAudit(
        table, None, "", entries, f'{NO_READING}: say it, prints = "..."' if has_roots else none
    )


def _judged(table: PrintedTable, rows: Sequence[_RowOfRoots], prints: Expression, reading: str) -> TableAudit:
    entries = tuple(entry for i, row in enumerate(rows, 1) for entry in row.judged(i, prints))
    reasons = dict.fromkeys(row.reason for row in rows if row.reason)
    return TableAudit(table, prints, reading, entries, "; ".join(reasons))


def _in_proportion(rows: Sequence[_RowOfRoots]) -> Iterator[tuple[str, Expression]]:
    """Yield powers of omega times the factor with which most entries are right: ratios, beta*l and others."""
    for exponent in POWERS:
        prints = _OMEGA if exponent == 1 else power(_OMEGA, number(exponent))
        ends: list[tuple[Fraction, int]] = []
        for row in rows:
            for text, (value, _) in zip(row.row.entries, row.nonzero(prints), strict=False):
                if text != GAP and value > 0:
                    printed, half = Fraction(Decimal(text)), last_place(text) / 2
                    true = Fraction(float(value.mid()))
                    ends += [((printed - half) / true, 1), ((printed + half) / true, -1)]
        if len(ends) < 2 * FEWEST_ENTRIES:
            continue
        # The part of the line that most intervals cover.
        ends.sort()
        heights = list(accumulate(step for _, step in ends))
        top = heights.index(max(heights))
        factor = (ends[top][0] + ends[top + 1][0]) / 2
        yield f"in proportion to {format_expression(prints)}", product_of([number(factor), prints])


class _Located:
    """The certified roots with some values of parameters, searched as far as the longest row goes."""

    def __init__(
        self,
        model: Model,
        table: PrintedTable,
        values: tuple[tuple[str, ExactValue], ...],
        longest: int,
        digits: int,
    ) -> None:
        self.model = with_values(model, dict(values)) if values else model
        self.table, self.digits, self.count = table, digits, longest + LATER
        (self.bound,) = derive_for_roots(self.model, [table.tf])
        self.known: dict[int, PoleZeroMap] = {}
        self.reason = ""

    def located(self, beyond: int) -> PoleZeroMap:
        """Return the roots to some digits beyond the printed ones."""
        if beyond not in self.known:
            asked, count = self.digits + beyond, self.count
            while True:
                region = Modes(count) if self.model.is_distributed else Everything()
                found = locate(self.bound, region, asked)
                enough = len(self._of(found)) >= self.count
                if enough or not self.model.is_distributed or count >= MOST_MODES:
                    break
                count *= 2
            self.known[beyond] = found
            if not found.certificate.certified:
                self.reason = found.certificate.reason or ""
        return self.known[beyond]

    def _of(self, found: PoleZeroMap) -> list[tuple[Root, bool]]:
        """Return the roots that a table lists, by size, and whether one may leave them out."""
        seen = found.all_poles if self.table.of == "poles" else found.zeros
        roots = [(root, root.is_zero) for root in seen]
        if self.table.of == "poles":  # a natural frequency is one whether a pair of signals shows it or not
            roots += [(hidden.root, True) for hidden in found.hidden]
        upper = [(root, spare) for root, spare in roots if not root.im < 0]
        upper.sort(key=lambda pair: float(pair[0].size().mid()))
        return [pair for pair in upper for _ in range(pair[0].multiplicity)]

    def values(self, prints: Expression, beyond: int) -> list[tuple[arb, bool]]:
        """Return what is printed of every root, and whether it may be left out."""
        with precision(BITS * (self.digits + beyond) + GUARD_BITS):
            definitions = {d.name: d.expression for d in self.model.definitions}
            known = {
                p.name: acb(ball(p.value.rational) * arb.pi() ** p.value.pi_power)
                for p in self.model.parameters
                if p.value is not None and not p.value.is_imaginary
            }
            expression = prints
            for _ in definitions:
                expression = substitute(expression, definitions)
            found = []
            for root, spare in self._of(self.located(beyond)):
                size = root.size()
                at = known | {
                    "pi": acb(arb.pi()),
                    "omega": acb(root.im),
                    "sigma": acb(root.re),
                    "f": acb(root.im / (2 * arb.pi())),
                    "omega_n": acb(size),
                    "f_n": acb(size / (2 * arb.pi())),
                    "zeta": acb(0 if root.on_imaginary_axis else -root.re / size),
                }
                value = value_of(expression, at).real
                if value.is_finite() or not spare:  # a period has no value at 0
                    found.append((value, spare))
            return found


class _RowOfRoots:
    """A row and the roots that belong to it."""

    def __init__(self, located: _Located, row: PrintedRow) -> None:
        self.located, self.row = located, row

    @property
    def reason(self) -> str:
        """What is not proved of the roots."""
        return self.located.reason

    def nonzero(self, prints: Expression) -> list[tuple[arb, bool]]:
        """Return the values of the roots that every table lists."""
        return [pair for pair in self.located.values(prints, BEYOND) if not pair[1]]

    def judged(self, row: int, prints: Expression) -> Iterator[EntryAudit]:
        """Yield what is found about every entry, and roots that were left out."""
        values = self.located.values(prints, BEYOND)
        finer: list[arb] = []
        for column, which in self._paired(values):
            if column is None:
                value = values[which or 0][0]
                yield EntryAudit(row, None, "", "missing", nearest_decimal(value, f"{_shown(self.row)}"))
                continue
            text = self.row.entries[column]
            if which is None:
                yield EntryAudit(row, column + 1, text, "gap" if text == GAP else "extra")
                continue
            value = values[which][0]
            if text == GAP:
                yield EntryAudit(row, column + 1, text, "gap", nearest_decimal(value, _shown(self.row)))
                continue
            verdict = verdict_on(text, value)
            if verdict == "undecided":
                finer = finer or [v for v, _ in self.located.values(prints, MORE)]
                value = finer[which] if which < len(finer) else value
                verdict = verdict_on(text, value)
            right, digits = nearest_decimal(value, text), right_digits(text, value)
            exact = (
                Fraction(str(value.mid().str(self.located.digits + BEYOND, radius=False)))
                if value.is_finite()
                else None
            )
            yield EntryAudit(
                row, column + 1, text, verdict, right, digits if verdict == "wrong" else 0, exact
            )

    def _paired(self, values: Sequence[tuple[arb, bool]]) -> list[tuple[int | None, int | None]]:
        """Return pairs of column and root: in order if that is right, else the cheapest monotone ones."""
        entries = self.row.entries
        spare = {k for k, (_, may_miss) in enumerate(values) if may_miss}

        def fitting(pairs: Sequence[tuple[int | None, int | None]]) -> int:
            known = ((entries[c], values[k][0]) for c, k in pairs if c is not None and k is not None)
            return sum(text != GAP and verdict_on(text, value) != "wrong" for text, value in known)

        aligned = _aligned(entries, values)
        without = [k for k in range(len(values)) if k not in spare]
        in_order: list[list[tuple[int | None, int | None]]] = [
            [*zip(range(len(entries)), listed, strict=False)]
            for listed in (range(len(values)), without)
            if len(listed) >= len(entries)
        ]
        offered = [*in_order, *filter(None, [self._in_any_order(values)])]
        best = max(offered, key=fitting, default=aligned)
        return aligned if fitting(aligned) > fitting(best) else best

    def _in_any_order(self, values: Sequence[tuple[arb, bool]]) -> list[tuple[int | None, int | None]]:
        """Return each entry with a value that it fits, if all do; nothing otherwise."""
        free = list(range(len(values)))
        pairs: list[tuple[int | None, int | None]] = []
        for column, text in enumerate(self.row.entries):
            fit = next((k for k in free if text != GAP and verdict_on(text, values[k][0]) != "wrong"), None)
            if fit is None:
                return []
            free.remove(fit)
            pairs.append((column, fit))
        return pairs


def _aligned(
    entries: Sequence[str], values: Sequence[tuple[arb, bool]]
) -> list[tuple[int | None, int | None]]:
    """Return the cheapest monotone pairing of entries and values; values after the last entry are free."""
    rows, columns = len(entries), len(values)
    cost = [[inf] * (columns + 1) for _ in range(rows + 1)]
    step: dict[tuple[int, int], tuple[int, int]] = {}
    cost[0][0] = 0.0
    for i in range(rows + 1):
        for k in range(columns + 1):
            offers: list[tuple[float, tuple[int, int]]] = []
            if i and k:
                offers.append((cost[i - 1][k - 1] + _cost(entries[i - 1], values[k - 1][0]), (1, 1)))
            if k:
                is_free = values[k - 1][1] or i == rows
                offers.append((cost[i][k - 1] + (0.0 if is_free else SKIPPED), (0, 1)))
            if i:
                offers.append((cost[i - 1][k] + SPARE_ENTRY, (1, 0)))
            if offers:
                cost[i][k], step[i, k] = min(offers)
    pairs: list[tuple[int | None, int | None]] = []
    i, k = rows, columns
    while i or k:
        di, dk = step[i, k]
        if di or (i < rows and not values[k - 1][1]):
            pairs.append((i - 1 if di else None, k - 1 if dk else None))
        i, k = i - di, k - dk
    return pairs[::-1]


def _cost(entry: str, value: arb) -> float:
    """Return what it costs to take an entry for a value."""
    if entry == GAP or verdict_on(entry, value) != "wrong":
        return 0.0
    printed, true = float(entry), float(value.mid())
    apart = abs(log(printed / true)) if printed and true and printed * true > 0 else 1.0
    return WRONG + min(FAR * apart, FARTHEST)


def _shown(row: PrintedRow) -> str:
    """Return the entry of a row with the most digits: others are written like it."""
    return max((e for e in row.entries if e != GAP), key=significant, default="0.000")


def significant(text: str) -> int:
    """Return how many significant digits a decimal has.

    >>> significant("0.01650"), significant("16.250"), significant("1.2e3"), significant("20840")
    (4, 5, 2, 4)
    """
    printed = abs(Fraction(Decimal(text)) / last_place(text))
    return len(str(int(printed))) if printed else 1


def last_place(text: str) -> Fraction:
    """Return the unit of the last digit of a decimal; zeros at the end of an integer may only fill it.

    >>> last_place("16.250"), last_place("1.2e3"), last_place("20840")
    (Fraction(1, 1000), Fraction(100, 1), Fraction(10, 1))
    """
    return Fraction(10) ** _exponent(text)


def _exponent(text: str) -> int:
    exponent = int(Decimal(text).as_tuple().exponent)
    is_filled = text.strip("+-").isdigit() and text.strip("+-0")
    return exponent + (len(text) - len(text.rstrip("0")) if is_filled else 0)


def verdict_on(text: str, value: arb) -> EntryVerdict:
    """Compare a printed decimal with an enclosure of the true value.

    ``right``: off by at most half a unit of the last digit. ``rounded``: by at most one. ``wrong``: by more.

    >>> verdict_on("3.5160", arb("3.516015")), verdict_on("3.515", arb("3.516015")), verdict_on("3.5", arb(4))
    ('right', 'wrong', 'wrong')
    """
    if not value.is_finite():
        return "undecided"
    unit = ball(last_place(text))
    off = abs(value - ball(Fraction(Decimal(text))))
    if off <= unit / 2:
        return "right"
    if off > unit:
        return "wrong"
    if off > unit / 2 and off <= unit:
        return "rounded"
    return "undecided"


def nearest_decimal(value: arb, like: str) -> str:
    """Return a value in decimals, with as many of them as a printed entry has.

    >>> nearest_decimal(arb("3.51601527"), "3.15601")
    '3.51602'
    """
    if not value.is_finite():
        return ""
    unit = last_place(like)
    middle = Fraction(Decimal(value.mid().str(40, radius=False)))
    count = floor(middle / unit + Fraction(1, 2))
    return f"{Decimal(count).scaleb(_exponent(like)):{'e' if 'e' in like.lower() else 'f'}}"


def right_digits(text: str, value: arb) -> int:
    """Return how many significant digits of a decimal are right.

    >>> right_digits("3.15601", arb("3.516015")), right_digits("10.99557", arb("10.9955407"))
    (1, 6)
    """
    printed, true = Fraction(Decimal(text)), float(value.mid())
    off = abs(float(printed) - true)
    if not off or not true or not isfinite(off):
        return significant(text) if not off else 0
    # Off by half a unit of a digit, it is right.
    return max(0, min(significant(text), floor(log10(abs(true))) - floor(log10(2 * off) - 1e-12)))


def judge_array(array: Text, models: Sequence[Model]) -> TableAudit | None:
    """Return what is found about the numbers in a tabular; None if they are about none of the models.

    Each list of numbers is compared with the poles of the models' first functions, in the most common units
    or up to a factor. A list that is near none of them is about something else. Raises SF103 for what no page
    has.
    """
    lists = [each for each in lists_of(cells_of(array)) if len(each.entries) >= FEWEST_ENTRIES]
    rows = tuple(PrintedRow((), each.entries, array.span, each.heading) for each in lists)
    best: TableAudit | None = None
    for model in models if rows else ():
        table = PrintedTable("", model.transfer_functions[0], "poles", None, rows, span=array.span)
        try:
            each = [(one.row, _read([one], table)) for one in _located_rows(model, table)]
        except SymflexError:  # a model without values has no roots
            continue
        about = [(row, audit) for row, audit in each if audit.prints is not None]
        if about:
            table = replace(table, name=about[0][0].heading, rows=tuple(row for row, _ in about))
            joined = _joined(table, [replace(audit, table=table) for _, audit in about])
            best = max(filter(None, (best, joined)), key=lambda audit: audit.close)
    return best
