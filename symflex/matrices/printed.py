"""A transfer matrix as an author would write it: one fraction in front, and a matrix of numerators.

Input: a transfer matrix. Output: a :class:`MatrixForm`, each entry of which has been read back.

The fraction has what all numerators share over d(s); it and the numerators are arranged each on its own, as
functions are. The names that they need are those of one list: what means the same has one name, and a name
that two would use for different things is numbered. Then each entry, with fraction and list, is evaluated and
compared with its transfer function, as single forms are.

    X_1/F_1 = (b*s + k)*k_a/d,  X_2/F_1 = k_a*k/d      G(s) = k_a/d * [b*s + k; k]
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import gcd
from typing import Final

from symflex.algebra import Factored
from symflex.errors import refused
from symflex.expressions import (
    Call,
    Equation,
    Expression,
    Name,
    is_number,
    number,
    product_of,
    quotient,
    replace_values,
    substitute,
)
from symflex.matrices.transfer_matrix import TransferMatrix, derive_matrix, over_common_denominator
from symflex.model import with_numbers
from symflex.model.analysis import lines_in_order
from symflex.print.forms import DECIMAL_FORMS, in_s, is_unreadable, print_form, print_part
from symflex.print.forms.arrange import length
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.naming import Naming, names_of
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.shapes import powers_of
from symflex.print.read_back import read_back
from symflex.transfer import ClosedForm, TransferFunction

Rows = tuple[tuple[Expression, ...], ...]


@dataclass(frozen=True, slots=True)
class MatrixForm:
    """``front/den`` times the matrix of ``entries``, for print; a single entry is 1."""

    name: str  # the form's name, a key of ``FORMS``, or ``shortest`` or ``nested``
    front: Expression  # what all entries share
    den: Expression  # d(s)
    entries: Rows
    where: tuple[tuple[str, Expression], ...] = ()  # see :class:`symflex.print.forms.PrintedForm`
    laws: tuple[tuple[str, Equation], ...] = ()
    closed: tuple[tuple[Expression, Expression], ...] = ()

    @property
    def parts(self) -> tuple[Expression, ...]:
        """The fraction in front, and the entries."""
        return self.front, self.den, *(e for row in self.entries for e in row)

    @property
    def lines(self) -> PrintedForm:
        """The fraction in front with all lines, as printers of single functions take them."""
        return PrintedForm(self.name, self.front, self.den, self.where, self.laws, self.closed)

    def entry(self, i: int, j: int) -> PrintedForm:
        """Return one transfer function as this form has it."""
        return replace(self.lines, num=product_of([self.front, self.entries[i][j]]))


def print_matrix(matrix: TransferMatrix, form: str | None = None, digits: int = 6) -> MatrixForm:
    """Return a matrix in the named form, or each part in the one that prints shortest.

    Raises SF902 where there is no such form, SF992 where an entry, read back, is not its function.
    """
    if form == "frequency":
        raise refused("a matrix has no frequency form", "ask for that of single functions")
    if not matrix.is_reduced:
        made = _nested(matrix, form)
    else:
        made = _expanded(matrix, form, digits)
    for i, row in enumerate(matrix.pairs):
        for j, tf in enumerate(row):
            read_back(tf, made.entry(i, j), digits if made.name in DECIMAL_FORMS else None)
    return _in_s(matrix, made)


def _nested(matrix: TransferMatrix, form: str | None) -> MatrixForm:
    """Return quotients of one program, over one denominator where it is the same in all."""
    merger = _Merger(matrix)
    sides = [merger.add(print_form(tf, form)) for tf in matrix.each]
    dens = {den for num, den in sides if not is_number(num, 0)}
    den = dens.pop() if len(dens) == 1 else number(1)
    entries = [num if dens == set() or is_number(num, 0) else quotient(num, own) for num, own in sides]
    if is_number(den, 1):
        entries = [quotient(num, own) for num, own in sides]
    return merger.form("nested", number(1), den, matrix.rows(entries))


def _expanded(matrix: TransferMatrix, form: str | None, digits: int) -> MatrixForm:
    """Return the form over d(s), definitions closed where that is shorter and no form was asked for."""
    arranged = Arranged()
    if form in DECIMAL_FORMS:
        numbers = with_numbers(matrix.model)
        outputs, inputs = ([x.name for x in side] for side in (matrix.outputs, matrix.inputs))
        return _over_denominator(derive_matrix(numbers, outputs, inputs), form, digits, arranged)
    opened = _over_denominator(matrix, form, digits, arranged)
    if form is not None:
        return opened
    if matrix.is_rational and not matrix.model.root and is_unreadable(opened.parts):
        return _expanded(matrix, "zpk", digits)
    each = [arranged.definitions.of(tf) for tf in matrix.each if isinstance(tf, TransferFunction)]
    closed = [tf for tf in each if tf is not None]
    if len(closed) < len(each):
        return opened
    kept = _over_denominator(TransferMatrix(matrix.rows(closed)), form, digits, arranged)
    return min(opened, kept, key=_length)


def _length(form: MatrixForm) -> float:
    return length(
        form.front, form.den, *(e for row in form.entries for e in row), *(e for _, e in form.where)
    )


def _over_denominator(
    matrix: TransferMatrix, form: str | None, digits: int, arranged: Arranged
) -> MatrixForm:
    """Return one form of a matrix over d(s): the fraction in front, and each numerator."""
    parts = closed_parts(matrix) or _opened_parts(matrix)
    merger = _Merger(matrix)
    above, den = merger.add(print_part(parts[0], form, digits, arranged))
    entries: list[Expression] = []
    for part in parts[1:]:
        num, below = merger.add(print_part(part, form, digits, arranged))
        entries.append(num if is_number(below, 1) else quotient(num, below))
    return merger.form(form or "shortest", above, den, matrix.rows(entries))


def _opened_parts(matrix: TransferMatrix) -> list[TransferFunction]:
    """Return the fraction in front, and the numerators, as functions that are entire."""
    over = matrix.over
    like = next(tf for tf in matrix.each if isinstance(tf, TransferFunction))
    entries = [n for row in over.numerators for n in row]
    shared = _shared(entries)

    def part(num: Factored, den: Factored) -> TransferFunction:
        used = num.ring.used_in(f for v in (num, den) for f, _ in v.factors)
        table = over.kernels.restricted(used)
        sides = (num, den) if table else None
        return replace(
            like,
            reduced=num / den,
            closed=None,
            hidden=(),
            kernels=table,
            parts=sides,
            solve=None,
            with_waves=None,
        )

    one = Factored.number(over.den.ring, 1)
    return [part(shared, over.den), *(part(n / shared, one) for n in entries)]


def closed_parts(matrix: TransferMatrix) -> list[TransferFunction] | None:
    """Return the same with sums closed, None where an entry had to be reduced without these."""
    each = [tf for tf in matrix.each if isinstance(tf, TransferFunction) and not tf.is_zero]
    forms = [tf.closed for tf in each if tf.closed is not None]
    if not forms or len(forms) < len(each) or any(f.opening is not forms[0].opening for f in forms):
        return None
    opening, ring = forms[0].opening, forms[0].closure.ring
    sides = [(Factored.polynomial(ring, f.num), Factored.polynomial(ring, f.den)) for f in forms]
    numerators, den = over_common_denominator(sides)
    shared = _shared(numerators)
    entries = iter([n / shared for n in numerators])
    one, zero = ring.constant(1), ring.constant(0)

    def part(num: Factored, den: Factored) -> TransferFunction:
        closed = ClosedForm(opening, num.expand(), den.expand())
        return replace(each[0], reduced=None, closed=closed, hidden=(), solve=None)

    unit = Factored.polynomial(ring, one)
    nothing = Factored.polynomial(ring, zero)
    parts = [part(nothing if tf.is_zero else next(entries), unit) for tf in matrix.each]
    return [part(shared, den), *parts]


def _shared(values: Sequence[Factored]) -> Factored:
    """Return what all values but zeros share: factors, powers of waves that all are divided by, numbers."""
    others = [v for v in values if not v.is_zero]
    if not others:
        return Factored.number(values[0].ring, 1)
    shared = []
    for factor, _ in others[0].factors:
        exponents = [v.exponent_of(factor) for v in others]
        if min(exponents) > 0 or max(exponents) < 0:
            shared.append((factor, min(exponents, key=abs)))
    unit = gcd(*(v.unit.numerator for v in others))
    return Factored(values[0].ring, Fraction(unit), tuple(shared))


def _in_s(matrix: TransferMatrix, form: MatrixForm) -> MatrixForm:
    """Return a form in s where the ring has a root of s in its place."""
    tf = matrix.pairs[0][0]
    if tf.model.root is None:
        return form
    written = in_s(tf, form.lines)

    def entry(expression: Expression) -> Expression:
        return in_s(tf, PrintedForm(form.name, expression, number(1))).num

    entries = tuple(tuple(map(entry, row)) for row in form.entries)
    return replace(form, front=written.num, den=written.den, entries=entries, where=written.where)


_NUMBER: Final = re.compile(r"_\d+$")
_Meaning = tuple[Fraction, frozenset[tuple[Expression, int]]]  # a product without the order of its factors


class _Merger:
    """Joins the lines of several forms of one model into one list."""

    def __init__(self, matrix: TransferMatrix) -> None:
        self._naming = Naming(names_of(matrix.model))
        self._where: dict[str, Expression] = {}
        self._names: dict[_Meaning, str] = {}
        self._laws: list[tuple[str, Equation]] = []
        self._closed: dict[Expression, Expression] = {}
        self._own = {d.name for d in matrix.model.definitions}

    def add(self, form: PrintedForm) -> tuple[Expression, Expression]:
        """Return numerator and denominator of a form in the names of the list, which takes its lines."""
        below = {left.name: e for left, e in form.closed if isinstance(left, Name)}
        lines, roots = {**dict(form.where), **below}, [form.num, form.den]
        inside = [side for _, law in form.laws for side in (law.left, law.right)]
        order, _ = lines_in_order([*roots, *inside, *(e for pair in form.closed for e in pair)], lines)
        opened: dict[str, Expression] = {}
        renamed: dict[str, Expression] = {}
        for name in order:
            line = substitute(lines[name], renamed)
            # Nested forms have many lines, which are the same wherever they mean the same.
            meaning = line if form.name == "nested" else substitute(lines[name], opened)
            opened[name] = meaning
            known = name if name in self._own else self._names.get(_key(meaning))
            if known is None:
                known = self._names[_key(meaning)] = self._free(name)
                self._naming.keep((known,))
            if name in below:
                self._closed.setdefault(Name(known), line)
            else:
                self._where[known] = min(self._where.get(known, line), line, key=length)
            if known != name:
                renamed[name] = Name(known)
        for name, law in form.laws:
            own = Equation(substitute(law.left, renamed), substitute(law.right, renamed))
            if (name, own) not in self._laws:
                self._laws.append((name, own))
        for left, right in form.closed:
            if not isinstance(left, Name):
                self._closed.setdefault(substitute(left, renamed), substitute(right, renamed))
        num, den = (substitute(e, renamed) for e in roots)
        return num, den

    def _free(self, name: str) -> str:
        """Return a name that stands for nothing yet, the one that is wanted where it is free."""
        is_free = name not in self._where and Name(name) not in self._closed
        return name if is_free else self._naming.take(_NUMBER.sub("", name))[0]

    def form(self, name: str, front: Expression, den: Expression, entries: Rows) -> MatrixForm:
        """Return the matrix with the list."""
        roots = {e: Name(line) for line, e in self._where.items() if isinstance(e, Call)}
        for line, e in self._where.items():
            self._where[line] = replace_values(
                e, {call: own for call, own in roots.items() if own.name != line}
            )
        inside = [side for _, law in self._laws for side in (law.left, law.right)]
        inside += [e for pair in self._closed.items() for e in pair]
        roots_of = [front, den, *(e for row in entries for e in row), *inside]
        order, _ = lines_in_order(roots_of, self._where)
        where = tuple((line, self._where[line]) for line in order)
        return MatrixForm(name, front, den, entries, where, tuple(self._laws), tuple(self._closed.items()))


def _key(meaning: Expression) -> _Meaning:
    front, powers = powers_of(meaning)
    return front, frozenset(powers.items())
