"""Cramer's rule on one elimination: the determinant of a system, and bordered ones for its outputs.

Input: :class:`symflex.equations.Equations`.
Output: polynomials over the closed ring. The determinant's roots are the poles of the system. With the row of
an output and the column of an input as border its roots are the zeros: the poles of the system in which that
output is kept at zero by whatever that input takes.

Determinants of sparse polynomial matrices are found by memoised Laplace expansion: every minor is expanded
along its first row and remembered by the columns it has left, so a banded matrix costs a number of products
that grows linearly with its size (Gentleman & Johnson 1976 compare the method with elimination for polynomial
entries).

How many terms an expanded determinant would have is estimated before anything is multiplied out.

Example: a mass on a spring and a damper, pushed by F and read at its node.

    before    (m s^2 + b s + k) x - F = 0          X = x
    after     den = |m s^2 + b s + k|       num = -|       1           0|  =  1
                                                   |m s^2 + b s + k   -1|
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, log
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar

from symflex.algebra import LAPLACE, Factored, Ring, terms_of
from symflex.algebra.straight_line import Step
from symflex.budget import spend
from symflex.equations.elimination.closing import (
    MEMORY_LIMIT,
    ClosedSystem,
    ReducedSystem,
    close,
    eliminate_unit_pivots,
)
from symflex.equations.elimination.singular import explain_singular
from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from flint import fmpz_mpoly

    from symflex.equations import Equations
    from symflex.equations.elimination.closing import SparseRow
    from symflex.equations.elimination.full import MinorsInS
    from symflex.equations.elimination.star_mesh import Elimination


@dataclass(frozen=True, eq=False)
class Determinants:
    """The determinants of one system, each up to the sign they share."""

    equations: Equations  # the system
    system: ClosedSystem  # the same over the closed ring
    reduced: ReducedSystem  # what remains of it without unit pivots
    minors: Minors | MinorsInS  # shared by all determinants
    den: fmpz_mpoly  # the determinant, not zero, over the closed ring

    @staticmethod
    def of(equations: Equations, most: int | None = None) -> Determinants:
        """Return a system's determinants, of minors of ``most`` terms; else SF502, or SF30x if singular."""
        system = close(equations)
        reduced = eliminate_unit_pivots(system.rows, system.outputs, len(system.unknowns))
        if len(reduced.rows) != len(reduced.columns):
            raise explain_singular(equations)
        order = expansion_order(reduced.rows, reduced.columns)
        if most is None and equations.propagation is not None:
            most = KERNEL_TERMS
        rows, columns = tuple(reduced.rows[i] for i in order), sum(1 << c for c in reduced.columns)
        minors: Minors | MinorsInS = (expanded := Minors(rows, ring=system.closure.ring, most=most))
        if not expanded.are_few(columns):
            from symflex.equations.elimination.full import MinorsInS  # few systems are full

            minors = MinorsInS.of(rows, reduced.outputs, system.closure.ring) or expanded
        den = minors.determinant(columns)
        if den.is_zero():
            raise explain_singular(equations)
        return Determinants(equations, system, reduced, minors, den)

    def num(self, output: str, source: str) -> fmpz_mpoly:
        """Return the determinant bordered by an output and an input: over :attr:`den` their quotient."""
        # Cramer: det [C D; A B] over det A, up to the sign of moving the border from last row to first.
        minor = self.minors.bordered(self.reduced.outputs[self.position(output)], self.border(source))
        return -minor if len(self.reduced.columns) & 1 else minor

    def position(self, output: str) -> int:
        """Return where an output stands among the rows of outputs."""
        return [row.name for row in self.equations.outputs].index(output)

    def border(self, source: str) -> int:
        """Return the columns of the unknowns left, and that of an input, as bits."""
        column = len(self.system.unknowns) + [v.owner for v in self.system.inputs].index(source)
        return sum(1 << c for c in self.reduced.columns) | 1 << column

    def opened(self, polynomial: fmpz_mpoly) -> Factored:
        """Return a determinant over the ring of the equations."""
        return self.system.closure.open(polynomial)


FEW_MINORS = 1_000  # a full matrix of 10 rows has more
MINOR_LIMIT = 200_000  # minors of one system: a full matrix of 17 rows has 131,072, a chain few
ROW_LIMIT = 700  # unknowns left, not measured: 700 nested masses take 2.4 s and 60 MB
KERNEL_TERMS = 10_000  # of a minor with kernels: four beams have 2,500; 26,000 take 1 GB

Entry = TypeVar("Entry")
Value = TypeVar("Value")


@dataclass
class LaplaceExpansion(ABC, Generic[Entry, Value]):
    """Values of all minors of some rows, each found once from smaller ones, within limits: else SF502."""

    rows: tuple[Mapping[int, Entry], ...]  # sparse rows, in the order of expansion
    _known: dict[int, Value] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if len(self.rows) > ROW_LIMIT:
            raise _too_large(f"{len(self.rows)} unknowns remain after elimination, more than {ROW_LIMIT}")

    @abstractmethod
    def _one(self) -> Value:
        """Return the value of the minor without rows."""

    @abstractmethod
    def _expand(self, entries: Mapping[int, Entry], below: int, columns: int) -> Value:
        """Return a minor along one row from those that begin with row ``below``."""

    def _note(self, value: Value) -> None:
        """Take notice of a value that is about to be kept."""

    def determinant(self, columns: int) -> Value:
        """Return the determinant over the columns whose bits are set, taken in increasing order."""
        self._find(columns)
        return self._minor(0, columns)

    def bordered(self, top: Mapping[int, Entry], columns: int) -> Value:
        """Return the determinant with one more row on top."""
        for remaining in self._left(top, columns):
            self._find(remaining)
        return self._expand(top, 0, columns)

    def _minor(self, row: int, columns: int) -> Value:
        # The number of columns left tells the row, so the columns alone are the key.
        return self._one() if row == len(self.rows) else self._known[columns]

    def _left(self, entries: Mapping[int, Entry], columns: int) -> set[int]:
        return {columns & ~(1 << column) for column in entries if columns >> column & 1}

    def are_few(self, columns: int) -> bool:
        """Tell whether a determinant takes few minors."""
        return self._wanted(columns, FEW_MINORS) is not None

    def _wanted(self, columns: int, most: int) -> list[set[int]] | None:
        """Return the minors that a determinant takes and are not known, by row; None if too many."""
        wanted = [{columns}.difference(self._known)]
        count = len(self._known)
        for entries in self.rows:
            spend()
            count += len(wanted[-1])
            if count > most:
                return None
            below = {remaining for each in wanted[-1] for remaining in self._left(entries, each)}
            wanted.append(below.difference(self._known))
        return wanted

    def _find(self, columns: int) -> None:
        """Compute a determinant and all its minors, the smallest first: calls go less deep than chains."""
        wanted = self._wanted(columns, MINOR_LIMIT)
        if wanted is None:
            raise _too_large("the determinant has too many minors or terms")
        for row in reversed(range(len(self.rows))):
            for each in wanted[row]:
                spend()
                expanded = self._expand(self.rows[row], row + 1, each)
                self._known[each] = expanded
                self._note(expanded)


@dataclass
class Minors(LaplaceExpansion["fmpz_mpoly", "fmpz_mpoly"]):
    """The minors of polynomial rows over any columns, each computed once; SF502 beyond limits."""

    ring: Ring = field(kw_only=True)
    most: int | None = field(default=None, kw_only=True)  # terms of one of them
    are_expanded: ClassVar[bool] = True
    _bytes: int = 0

    def _one(self) -> fmpz_mpoly:
        return self.ring.constant(1)

    def _note(self, value: fmpz_mpoly) -> None:
        self._bytes += self.ring.bytes_of(len(value))
        if self._bytes > MEMORY_LIMIT:
            raise _too_large("the determinant has too many minors or terms")
        if self.most is not None and len(value) > self.most:
            hint = "split the model; roots, plots, sweeps, stability and exports do not need it"
            raise _too_large(f"its determinant would have more than {self.most} terms", hint)

    def _expand(self, entries: Mapping[int, fmpz_mpoly], below: int, columns: int) -> fmpz_mpoly:
        total = self.ring.constant(0)
        for column in sorted(entries):
            bit = 1 << column
            if not columns & bit:
                continue
            minor = self._minor(below, columns & ~bit)
            if minor.is_zero():
                continue
            # Refused before it is made: the engine does not survive running out of memory.
            if self.ring.bytes_of(len(total) + len(entries[column]) * len(minor)) > MEMORY_LIMIT:
                raise _too_large("a minor has too many terms")
            term = entries[column] * minor
            odd = (columns & (bit - 1)).bit_count() & 1
            total = total - term if odd else total + term
        return total


@dataclass
class DegreeBounds(LaplaceExpansion[int, int]):
    """What the degrees of minors can be at most, -1 where they are zero for their pattern alone."""

    def _one(self) -> int:
        return 0

    def _expand(self, entries: Mapping[int, int], below: int, columns: int) -> int:
        highest = -1
        for column, degree in entries.items():
            bit = 1 << column
            if columns & bit and (minor := self._minor(below, columns & ~bit)) >= 0:
                highest = max(highest, degree + minor)
        return highest


def _too_large(message: str, hint: str = "split the model or give it fewer nodes") -> BudgetError:
    return BudgetError(Diagnostic("SF502", f"the closed form is too large: {message}", None, hint))


def expansion_order(rows: tuple[SparseRow, ...], columns: tuple[int, ...]) -> tuple[int, ...]:
    """Return an order of the rows that touches new columns late, which keeps minors few and small."""
    wanted = set(columns)
    patterns = [frozenset(c for c in row if c in wanted) for row in rows]
    users: dict[int, list[int]] = {}
    for i, pattern in enumerate(patterns):
        for c in pattern:
            users.setdefault(c, []).append(i)
    fresh = [len(p) for p in patterns]
    seen: set[int] = set()
    remaining = set(range(len(rows)))
    touched: set[int] = set()
    order: list[int] = []
    while remaining:
        candidates = touched or remaining
        best = min(candidates, key=lambda i: (fresh[i], i))
        order.append(best)
        remaining.discard(best)
        touched.discard(best)
        for c in patterns[best] - seen:
            for i in users[c]:
                fresh[i] -= 1
                if i in remaining:
                    touched.add(i)
        seen |= patterns[best]
    return tuple(order)


LARGEST = 700.0  # logarithms beyond this overflow a double


def expanded_terms(equations: Equations, elimination: Elimination) -> float:
    """Return about how many terms the determinant has with its sub-impedances closed.

    The determinant of a network is the sum over its spanning forests (Kirchhoff 1847), each one term with
    coefficient one: with one for every sub-impedance and parameter its value is their number. Elsewhere
    signs may cancel, and it is an estimate. A determinant in few symbols has no more terms than these have
    monomials up to the degrees they can reach.
    """
    exponent = min(_forests(elimination), _monomials(equations))
    return inf if exponent > LARGEST else 2.718281828459045**exponent


def _forests(elimination: Elimination) -> float:
    """Return the logarithm of the product of the pivots where every closed sum and generator is one."""
    program = elimination.program
    operations = (
        (Step.GENERATOR if program.roles.get(i) == "w" else kind, i, operands, gone)
        for kind, i, operands, gone in program.operations(range(len(program.kinds)))
    )
    values = program.values(
        operations,
        name=lambda _: 1.0,
        number=lambda value: 1.0 if value else 0.0,
        quotient=lambda above, below: above / below if below else 1.0,
    )
    return sum(log(abs(values[x])) for x in elimination.pivots if values[x])


def _monomials(equations: Equations) -> float:
    """Return the logarithm of how many monomials the generators have, up to their degrees in all rows."""
    names = equations.ring.names
    degrees: dict[object, int] = {}
    for row in equations.rows:
        here: dict[object, int] = {}
        for _, coefficient in row.form.terms:
            for factor, exponent in coefficient.factors:
                terms = list(terms_of(factor))
                used = {i: e for monomial, _ in terms for i, e in monomial}
                if len(terms) > 1 and any(names[i] not in (LAPLACE, "pi") for i in used):
                    here[tuple(terms)] = max(here.get(tuple(terms), 0), exponent)
                    continue
                for i, e in used.items():
                    here[i] = max(here.get(i, 0), e * exponent)
        for key, degree in here.items():
            degrees[key] = degrees.get(key, 0) + max(degree, 0)
    return sum(log(1 + degree) for degree in degrees.values())
