"""Closing sub-impedances: every sum becomes one generator, so that elimination and print stay compact.

Input: :class:`symflex.equations.Equations`, entries factored over the ring of parameters.
Output: a :class:`ClosedSystem`, a sparse matrix over a ring with one more generator per distinct sum.

Unknowns whose pivot is plus or minus one are eliminated first, which keeps rows polynomial.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, expanded_length
from symflex.budget import spend
from symflex.expressions import Name, format_expression
from symflex.expressions import names as names_in
from symflex.library.elements import LinearForm, Variable

if TYPE_CHECKING:
    from symflex.equations import Equations


SparseRow = dict[int, "fmpz_mpoly"]

TERM_LIMIT = 6_000_000
MEMORY_LIMIT = 300_000_000  # of all minors: a free chain of sixteen masses needs 270 MB
"""Terms and bytes of one opened polynomial: a free chain of twelve masses, all symbolic, has 5.6 million."""


@dataclass(frozen=True)
class Closure:
    """A ring with one generator per closed sum, and the way back."""

    base: Ring  # s, parameters, definitions, pi, functions of constants
    ring: Ring  # generators outside of closed sums, s, pi and the sums: a byte each per monomial
    sums: tuple[tuple[str, fmpz_mpoly], ...]  # each closed generator's name and its polynomial in ``base``

    @cached_property
    def images(self) -> tuple[fmpz_mpoly, ...]:
        """What every generator of ``ring`` is in ``base``."""
        plain = self.ring.names[: len(self.ring.names) - len(self.sums)]
        return (*(self.base.generator(n) for n in plain), *(p for _, p in self.sums))

    @cached_property
    def _closed(self) -> Mapping[str, fmpz_mpoly]:
        return {str(p): self.ring.generator(name) for name, p in self.sums}

    def close(self, value: Factored) -> fmpz_mpoly:
        """Return a polynomial entry with its sums closed."""
        result = self.ring.constant(int(value.unit))
        for factor, exponent in value.factors:
            closed = self._closed.get(str(factor))
            result = result * (factor.compose(*self._embedding) if closed is None else closed) ** exponent
        return result

    @cached_property
    def _embedding(self) -> tuple[fmpz_mpoly, ...]:
        """What every generator of ``base`` is in ``ring``, where it is there."""
        absent = self.ring.constant(0)
        index = self.ring.index
        return tuple(self.ring.generator(n) if n in index else absent for n in self.base.names)

    def open(self, polynomial: fmpz_mpoly) -> Factored:
        """Return a closed polynomial over ``base``; factors that stand in front stay factored."""
        if polynomial.is_zero():
            return Factored.number(self.base, 0)
        content = polynomial.term_content()
        result = Factored.number(self.base, Fraction(int(content.leading_coefficient())))
        for image, exponent in zip(self.images, content.monoms()[0], strict=True):
            if exponent:
                result = result * Factored.polynomial(self.base, image) ** int(exponent)
        primitive = polynomial / content
        if primitive.is_constant():
            return result * int(primitive.leading_coefficient())
        opened = self.base.compose(primitive, self.images, TERM_LIMIT, MEMORY_LIMIT)
        return result * Factored.polynomial(self.base, opened)

    def opened_length(self, polynomial: fmpz_mpoly) -> int | None:
        """Return a bound on the terms of a closed polynomial over ``base``; see ``expanded_length``."""
        return expanded_length(polynomial, [len(image) for image in self.images])


@dataclass(frozen=True)
class ClosedSystem:
    """The equations as sparse rows over the closed ring: a column per unknown, then one per input."""

    closure: Closure
    unknowns: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    rows: tuple[SparseRow, ...]
    outputs: tuple[SparseRow, ...]


def close(equations: Equations) -> ClosedSystem:
    """Return the equations with every sum of two or more terms closed."""
    sums: dict[str, fmpz_mpoly] = {}
    outside = {LAPLACE, "pi"}
    forms = [r.form for r in equations.rows] + [o.form for o in equations.outputs]
    entries = [c for form in forms for _, c in form.terms] + [o.divisor for o in equations.outputs]
    for entry in entries:
        spend()
        for factor, _ in entry.factors:
            used = {equations.ring.names[i] for i, d in enumerate(factor.degrees()) if int(d)}
            # A sum of numbers, s and pi stays open.
            if len(factor) > 1 and used - {LAPLACE, "pi"}:
                sums.setdefault(str(factor), factor)
            else:
                outside |= used
    for constant in equations.constants:
        if constant.generator in outside and constant.expression.name == "sqrt":
            # Its square is what is in it.
            inside = names_in(constant.expression)
            outside |= {n.name if isinstance(n, Name) else format_expression(n) for n in inside}
    named = tuple((f"sum{i}", factor) for i, factor in enumerate(sums.values()))
    # A parameter may be called like a closed sum; generator names must differ.
    taken = set(equations.ring.names)
    named = tuple((name if name not in taken else f"{name}!", factor) for name, factor in named)
    kept = (n for n in equations.ring.names if n in outside)
    closure = Closure(equations.ring, Ring((*kept, *(n for n, _ in named))), named)
    columns = {v: i for i, v in enumerate((*equations.unknowns, *equations.inputs))}

    def sparse(form: LinearForm) -> SparseRow:
        row: SparseRow = {}
        for variable, coefficient in form.terms:
            spend()
            column, entry = columns[variable], closure.close(coefficient)
            row[column] = row[column] + entry if column in row else entry
        return {c: e for c, e in row.items() if not e.is_zero()}

    return ClosedSystem(
        closure,
        equations.unknowns,
        equations.inputs,
        tuple(sparse(r.form) for r in equations.rows),
        tuple(sparse(o.form) for o in equations.outputs),
    )


@dataclass(frozen=True)
class ReducedSystem:
    """What remains: square rows over ``columns``, borders over the inputs, and the outputs."""

    rows: tuple[SparseRow, ...]
    outputs: tuple[SparseRow, ...]
    columns: tuple[int, ...]
    kept: tuple[int, ...]


def eliminate_unit_pivots(
    rows: tuple[SparseRow, ...], outputs: tuple[SparseRow, ...], unknowns: int
) -> ReducedSystem:
    """Eliminate unknowns, columns below ``unknowns``, by unit pivots, cheapest first (Markowitz 1957)."""
    live: dict[int, SparseRow] = {i: dict(r) for i, r in enumerate(rows)}
    goals = [dict(r) for r in outputs]
    columns = set(range(unknowns))
    users: dict[int, set[int]] = {c: set() for c in columns}
    for i, row in live.items():
        for c in row:
            if c in columns:
                users[c].add(i)
    while (pivot := _cheapest(live, users, columns)) is not None:
        r, c = pivot
        pivot_row = live.pop(r)
        for other in pivot_row:
            if other in columns:
                users[other].discard(r)
        sign = int(pivot_row[c].leading_coefficient())
        for i in sorted(users[c]):
            _subtract(live[i], pivot_row, c, sign)
            for other in pivot_row:
                if other in columns:
                    (users[other].add if other in live[i] else users[other].discard)(i)
        for goal in goals:
            if c in goal:
                _subtract(goal, pivot_row, c, sign)
        columns.discard(c)
        del users[c]
    kept = tuple(sorted(live))
    return ReducedSystem(tuple(live[i] for i in kept), tuple(goals), tuple(sorted(columns)), kept)


def _cheapest(
    live: dict[int, SparseRow], users: dict[int, set[int]], columns: set[int]
) -> tuple[int, int] | None:
    """Return the unit pivot with the smallest fill-in bound; ties go to the first row and column."""
    best: tuple[int, int, int] | None = None
    for r in sorted(live):
        row = live[r]
        inside = sum(1 for c in row if c in columns)
        for c, entry in row.items():
            if c not in columns or not entry.is_constant() or abs(int(entry.leading_coefficient())) != 1:
                continue
            cost = (inside - 1) * (len(users[c]) - 1)
            if best is None or (cost, r, c) < best:
                best = (cost, r, c)
        if best is not None and best[0] == 0:
            break
    return None if best is None else best[1:]


def _subtract(row: SparseRow, pivot_row: SparseRow, column: int, sign: int) -> None:
    """Clear ``column`` of ``row`` in place."""
    factor = row[column] * sign
    for c, entry in pivot_row.items():
        value = row[c] - factor * entry if c in row else -factor * entry
        if value.is_zero():
            row.pop(c, None)
        else:
            row[c] = value
