"""Determinants of a network's equations at single frequencies, and a bound on them in a disc.

Numerator and denominator of a transfer function by Cramer's rule, ``y = det [A b; c d] / det A``. Members
stand in A by what takes the state from their start to their end, which is entire in s: so are both
determinants, and a member's own frequencies are no poles of anything. Values come from elimination in balls;
where a ball is wide that leads to none, so what is said of a whole disc comes from Hadamard's inequality,
``|det A| <= product of the lengths of its rows``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

import numpy as np
from flint import acb, arb

from symflex.algebra import LAPLACE, Factored, least_common_multiple, terms_of
from symflex.balls import Eliminated, UndecidedError, current_bits, eliminate, precision, settled
from symflex.budget import spend
from symflex.equations import Equations
from symflex.library.elements import LinearForm, Variable
from symflex.model import ExactValue
from symflex.model.model import IMAGINARY
from symflex.transfer.equations_at import EquationsAt, Majorants, NamedValues

MOST_LOST = 16  # bits that elimination may lose per equation; chains of beams lose about one
ZERO = acb(0)
BALANCING = 40  # rounds that make rows and columns alike; each about halves what is left to gain
ROUNDING = 1e-9  # error of logarithms in doubles, per row: far above what is lost, far below what matters


@dataclass(frozen=True, slots=True)
class CramerValue:
    """Values at one s."""

    den: acb
    num: acb


@dataclass(eq=False)
class CramerEquations:
    """The equations between an input and an output, with numbers, ready to be evaluated."""

    equations: Equations
    entries: list[dict[int, Factored]]  # rows of A, and of c last; columns of A, and b last
    divisor: Factored  # of the output
    values: tuple[tuple[str, ExactValue], ...] = ()  # of the parameters that have names in them
    # By size: pivots, and the bits they were chosen at.
    _orders: dict[int, tuple[Sequence[tuple[int, int]], int]] = field(default_factory=dict)
    _least_bits: int = 0  # with fewer, elimination came to nothing
    sizes: dict[float, tuple[float, float]] = field(default_factory=dict)  # by radius [rad/s], mean ln abs

    @staticmethod
    def of(
        equations: Equations, output: str, source: str, values: tuple[tuple[str, ExactValue], ...] = ()
    ) -> CramerEquations:
        """Return the equations between an input and an output; those asked for before are the same."""
        known = equations.memo.get((output, source))
        if isinstance(known, CramerEquations):
            if known.values == values:
                return known
            return CramerEquations(equations, known.entries, known.divisor, values)
        rows, (read,), (divisor,) = bordered(equations, [output], [source])
        cramer = CramerEquations(equations, [*rows, read], divisor, values)
        equations.memo[output, source] = cramer
        return cramer

    @property
    def is_real(self) -> bool:
        """Whether determinants are real for real s, as without loss factors."""
        return IMAGINARY not in self.equations.ring.index

    # -------------------------------------------------------------------------------- values at points

    def at(self, s: acb, bits: int) -> CramerValue:
        """Return numerator and denominator at an exact s, with at least so many bits, else UndecidedError."""
        return settled(lambda: self._at(s), max(bits, self._least_bits))

    def _at(self, s: acb) -> CramerValue:
        spend()
        number = self.numeric.on(s)
        rows = self._rows(number)
        den, last = self._eliminated(rows, len(rows) - 1)
        if current_bits() <= MOST_LOST * len(self.entries):
            self._least_bits = max(self._least_bits, current_bits() // 2)
        return CramerValue(den * number(self.divisor), den * last)

    @cached_property
    def numeric(self) -> EquationsAt:
        """What gives entries their values."""
        return EquationsAt(self.equations, self.values)

    def _rows(self, number: NamedValues) -> list[dict[int, acb]]:
        return [{j: number(c) for j, c in row.items()} for row in self.entries]

    def _eliminated(self, rows: list[dict[int, acb]], size: int) -> tuple[acb, acb]:
        """Return the determinant of so many rows and columns, and what is left of the entry after them."""
        order, bits = self._orders.get(size, (None, 0))
        if order is not None:
            try:
                return _determinants(eliminate([dict(row) for row in rows], size, order))
            except UndecidedError:
                # Mostly nothing is wanting but bits.
                if current_bits() < 2 * bits:
                    raise
        eliminated = eliminate(rows, size)
        self._orders[size] = eliminated.order, current_bits()
        return _determinants(eliminated)

    def alone(self, s: acb, bits: int, *, is_num: bool) -> acb:
        """Return numerator or denominator at an exact s, also where it vanishes."""
        return settled(lambda: self._alone(s, is_num=is_num), bits)

    def _alone(self, s: acb, *, is_num: bool) -> acb:
        spend()
        number, size = self.numeric.on(s), len(self.entries) - (not is_num)
        rows = [{j: number(c) for j, c in row.items() if j < size} for row in self.entries[:size]]
        value, _ = self._eliminated(rows, size)
        return value if is_num else value * number(self.divisor)

    # -------------------------------------------------------------------------------- bounds in discs

    def bounds(self, radius: float) -> tuple[float, float]:
        """Return ln of bounds on abs(den) and abs(num) for abs(s) up to a radius [rad/s], if they exist."""
        with precision(64):
            bound = Majorants(self.numeric, arb(radius))
            sizes = [{j: bound(c) for j, c in row.items()} for row in self.entries]
            return self._bounds(sizes, bound(self.divisor))

    def bounds_on(self, box: acb) -> tuple[float, float]:
        """Return ln of bounds on abs(den) and abs(num) on a box; infinite where a denominator may vanish."""
        number = self.numeric.on(box)
        sizes = [{j: x.abs_upper() for j, x in row.items()} for row in self._rows(number)]
        return self._bounds(sizes, number(self.divisor).abs_upper())

    @staticmethod
    def _bounds(sizes: Sequence[Mapping[int, arb]], divisor: arb) -> tuple[float, float]:
        if not all(x.is_finite() for x in (divisor, *(x for row in sizes for x in row.values()))):
            return inf, inf  # beyond what a ball's exponent holds, too
        den = _hadamard(sizes[:-1], len(sizes) - 1) + _log(divisor)
        return den, _hadamard(sizes, len(sizes))


Entries = list[dict[int, Factored]]  # rows, by column


def bordered(
    equations: Equations, outputs: Sequence[str], sources: Sequence[str]
) -> tuple[Entries, Entries, list[Factored]]:
    """Return the rows ``[A B]`` and ``[C D]``, entire in s, and what divides each output."""
    given = [next(v for v in equations.inputs if v.owner == source) for source in sources]
    places = {v: i for i, v in enumerate((*equations.unknowns, *given))}
    lines = {c.name for c in equations.continua}
    rows = []
    for row in equations.rows:
        form = LinearForm.total([row.form])
        if row.role != "condition" and not (row.about.kind == "through" and row.about.owner in lines):
            form = form * _denominator(form)
        rows.append({places[v]: c for v, c in form.terms if v in places})
    reads, divisors = list[dict[int, Factored]](), list[Factored]()
    for output in outputs:
        read = next(o for o in equations.outputs if o.name == output)
        form = LinearForm.total([read.form])
        below = _denominator(form) if form.terms else read.divisor**0
        reads.append({places[v]: c for v, c in (form * below).terms if v in places})
        divisors.append(read.divisor * below)
    return rows, reads, divisors


def _determinants(solved: Eliminated) -> tuple[acb, acb]:
    size = len(solved.order)
    return solved.determinant, solved.rows[size].get(size, ZERO) if len(solved.rows) > size else ZERO


def is_zero(equations: Equations, output: str, source: str) -> bool:
    """Tell whether nothing leads from an input to an output, through rows and unknowns that meet."""
    given = next(v for v in equations.inputs if v.owner == source)
    read = next(o for o in equations.outputs if o.name == output)
    wanted = {v for v, _ in read.form.terms}
    beside: dict[Variable, list[int]] = {}
    rows = [
        [v for v, _ in row.form.terms if v not in equations.inputs or v == given] for row in equations.rows
    ]
    for i, row in enumerate(rows):
        for v in row:
            beside.setdefault(v, []).append(i)
    reached, pending = {given}, [given]
    while pending:
        for i in beside.pop(pending.pop(), ()):
            pending += [v for v in rows[i] if v not in reached]
            reached.update(rows[i])
    return not wanted & reached


def _denominator(form: LinearForm) -> Factored:
    """Return the least common denominator in s of a form's coefficients."""
    if not form.terms:
        raise ValueError("an empty form")
    one = form.coefficients[0] ** 0
    s = one.ring.index[LAPLACE]
    parts = (
        c.denominator().filter(lambda f: any(i == s for m, _ in terms_of(f) for i, _ in m))
        for c in form.coefficients
    )
    return least_common_multiple(one, parts)


def _log(value: arb) -> float:
    """Return ln of an upper bound."""
    return -inf if value == 0 else float(value.abs_upper().log().upper()) + ROUNDING


def _hadamard(rows: Sequence[Mapping[int, arb]], size: int) -> float:
    """Return ln of a bound on a determinant from bounds on its entries, whose columns are scaled first."""
    places = [
        (i, j, _log(x)) for i, row in enumerate(rows) for j, x in row.items() if j < size and not x == 0
    ]
    i, j = (np.array([p[k] for p in places], dtype=int) for k in (0, 1))
    logs = np.array([p[2] for p in places])
    scale = np.zeros(size)
    for _ in range(BALANCING):
        lengths = _lengths(i, logs + scale[j], size)
        share = np.exp(2 * (logs + scale[j] - lengths[i]))
        scale -= 0.5 * np.log(np.maximum(np.bincount(j, share, size), np.finfo(float).tiny))
    lengths = _lengths(i, logs + scale[j], size)
    return float(lengths.sum() - scale.sum() + ROUNDING * size)


def _lengths(
    i: np.typing.NDArray[np.intp], logs: np.typing.NDArray[np.float64], size: int
) -> np.typing.NDArray[np.float64]:
    """Return ln of the rows' lengths from ln of their entries."""
    largest = np.full(size, -np.inf)
    np.maximum.at(largest, i, logs)
    return np.asarray(largest + 0.5 * np.log(np.bincount(i, np.exp(2 * (logs - largest[i])), size)))
