"""Determinants of a network's equations at single frequencies, and a bound on them in a disc.

Numerator and denominator of a transfer function by Cramer's rule, ``y = det [A b; c d] / det A``. Members
stand in A by what takes the state from their start to their end, which is entire in s: so are both
determinants, and a member's own frequencies are no poles of anything. Values come from elimination in balls;
where a ball is wide that leads to none, so what is said of a whole disc comes from Hadamard's inequality,
``|det A| <= product of the lengths of its rows``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, arb, fmpq

from symflex.algebra import LAPLACE, terms_of
from symflex.algebra.factored import least_common_multiple
from symflex.algebra.propagators import EXPONENTIAL
from symflex.balls import UndecidedError, Value, at_centre, current_bits, eliminate, precision, settled
from symflex.budget import spend
from symflex.library.elements import LinearForm
from symflex.transfer.enclose import later
from symflex.transfer.enclose_kernels import fundamental_functions

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping

    from symflex.algebra import Factored
    from symflex.balls import Eliminated
    from symflex.equations import Equations
    from symflex.library.elements import Variable

Powers = Sequence[tuple[str, int]]
Plan = tuple[acb, Powers, Sequence[tuple[int, Sequence[tuple[acb, Powers]], int]]]
"""A constant, powers of generators that are none, and sums of such terms with exponents."""
MOST_LOST = 16
"""Bits that elimination may lose per equation; chains of beams lose about one."""
ZERO, ONE = acb(0), acb(1)
BALANCING = 40
"""Rounds that make rows and columns alike; each about halves what is left to gain."""
ROUNDING = 1e-9
"""Error of logarithms in doubles, per row: far above what is lost, far below what matters."""


class EssentialSingularityError(Exception):
    """A denominator vanishes in the disc: roots accumulate there."""


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
    _constants: dict[int, dict[str, acb]] = field(default_factory=dict)  # by bits
    _resting: dict[int, list[dict[int, acb]]] = field(default_factory=dict)  # by bits: entries free of s
    # By bits and id of a value, which is kept so that no other has its id.
    _plans: dict[tuple[int, int], tuple[object, Plan]] = field(default_factory=dict)
    # By size: pivots, and the bits they were chosen at.
    _orders: dict[int, tuple[Sequence[tuple[int, int]], int]] = field(default_factory=dict)
    _least_bits: int = 0  # with fewer, elimination came to nothing
    # By radius [rad/s], the mean of ln abs of denominator and numerator on a circle.
    sizes: dict[float, tuple[float, float]] = field(default_factory=dict)

    @staticmethod
    def of(equations: Equations, output: str, source: str) -> CramerEquations:
        """Return the equations between an input and an output; those asked for before are the same."""
        known = equations.memo.get((output, source))
        if isinstance(known, CramerEquations):
            return known
        given = next(v for v in equations.inputs if v.owner == source)
        places = {v: i for i, v in enumerate((*equations.unknowns, given))}
        lines = {c.name for c in equations.continua}
        rows = []
        for row in equations.rows:
            form = LinearForm.total([row.form])
            if row.role != "condition" and not (row.about.kind == "through" and row.about.owner in lines):
                form = form * _denominator(form)
            rows.append({places[v]: c for v, c in form.terms if v in places})
        read = next(o for o in equations.outputs if o.name == output)
        form = LinearForm.total([read.form])
        below = _denominator(form)
        rows.append({places[v]: c for v, c in (form * below).terms if v in places})
        cramer = equations.memo[output, source] = CramerEquations(equations, rows, read.divisor * below)
        return cramer

    # -------------------------------------------------------------------------------- values at points

    def at(self, s: acb, bits: int) -> CramerValue:
        """Return numerator and denominator at an exact s, computed with at least so many bits.

        UndecidedError where the equations are singular.
        """
        return settled(lambda: self._at(s), max(bits, self._least_bits))

    def _at(self, s: acb) -> CramerValue:
        spend()
        values = self._values(s)
        factors: dict[int, acb] = {}
        rows = self._rows(values, factors)
        den, last = self._eliminated(rows, len(rows) - 1)
        if current_bits() <= MOST_LOST * len(self.entries):
            self._least_bits = max(self._least_bits, current_bits() // 2)
        return CramerValue(den * self._value(self.divisor, values, factors), den * last)

    def _rows(self, values: Mapping[str, acb], factors: dict[int, acb]) -> list[dict[int, acb]]:
        """Return all entries; of those free of s, which are many, as they were."""
        bits = current_bits()
        if bits not in self._resting:
            self._resting[bits] = [
                {j: self._value(c, values, factors) for j, c in row.items() if j not in moving}
                for row, moving in zip(self.entries, self._moving, strict=True)
            ]
        return [
            resting | {j: self._value(row[j], values, factors) for j in moving}
            for row, moving, resting in zip(self.entries, self._moving, self._resting[bits], strict=True)
        ]

    @cached_property
    def moving_names(self) -> frozenset[str]:
        """The generators that are no constants."""
        moving = {LAPLACE, *(name for group in self.waves.values() for name, _ in group)}
        for name, value in self.equations.definitions:
            if _uses(value, moving):
                moving.add(name)
        return frozenset(moving)

    @cached_property
    def _moving(self) -> list[tuple[int, ...]]:
        """The columns of entries that are no constants, row by row."""
        names = self.moving_names
        return [tuple(j for j, c in row.items() if _uses(c, names)) for row in self.entries]

    def _values(self, s: acb) -> dict[str, acb]:
        equations = self.equations
        bits = current_bits()
        factors: dict[int, acb] = {}
        if bits not in self._constants:
            known = {c.generator: acb(later(c.expression, {"pi": arb.pi})()) for c in equations.constants}
            known |= {"pi": acb(arb.pi())}
            for name, value in equations.definitions:
                if name not in self.moving_names:
                    known[name] = self._value(value, known, factors)
            self._constants[bits] = known
        values = {LAPLACE: s, **self._constants[bits]}
        for name, value in equations.definitions:
            if name in self.moving_names:
                values[name] = self._value(value, values, factors)
        values.update(self._along_members(lambda x: self._value(x, values, factors)))
        return values

    def _along_members(
        self, value: Callable[[Factored], acb], *, is_growing: bool = False
    ) -> Iterator[tuple[str, acb]]:
        """Yield the generators that are fundamental functions and exponentials, with their values.

        All coefficients may be turned to grow: what solves the equation then is larger, term by term.
        """
        propagation, sign = self.equations.propagation, -1 if is_growing else 1
        if propagation is None:
            return
        for (number, place), group in self.waves.items():
            law = propagation.table.dispersions[number]
            length = value(propagation.lengths[number][place])
            plain: tuple[Value, ...] = ()
            if any(order >= 0 for _, order in group):
                plain = fundamental_functions([value(c) * sign for c in law.characteristic], length)
            for name, order in group:
                if order == EXPONENTIAL:
                    yield name, (value(law.shift) * -sign * length).exp()
                else:
                    yield name, at_centre(plain[order])

    @cached_property
    def waves(self) -> dict[tuple[int, int], list[tuple[str, int]]]:
        """The generators that are fundamental functions, with their orders, by dispersion and length."""
        groups: dict[tuple[int, int], list[tuple[str, int]]] = {}
        propagation = self.equations.propagation
        for p in () if propagation is None else propagation.propagators:
            groups.setdefault((p.dispersion, p.length), []).append((p.generator, p.order))
        return groups

    def _value(self, value: Factored, values: Mapping[str, acb], factors: dict[int, acb]) -> acb:
        result, powers, sums = self._plan(value, values)
        for name, power in powers:
            result = result * values[name] if power == 1 else result * values[name] ** power
        for number, terms, exponent in sums:
            known = factors.get(number)
            if known is None:
                known = ZERO
                for constant, of in terms:
                    term = constant
                    for name, power in of:
                        term = term * (values[name] if power == 1 else values[name] ** power)
                    known += term
                factors[number] = known
            result = result * known if exponent == 1 else result * known**exponent
        return result

    def _plan(self, value: Factored, values: Mapping[str, acb]) -> Plan:
        """Return how to evaluate a value, with the products of constants, made once for each precision."""
        key = current_bits(), id(value)
        if key in self._plans:
            return self._plans[key][1]
        constant, powers, sums = acb(fmpq(value.unit.numerator, value.unit.denominator)), [], []
        for factor, exponent in value.factors:
            by_moving: dict[tuple[tuple[str, int], ...], acb] = {}
            for monomial, coefficient in terms_of(factor):
                term, moving = acb(coefficient), []
                for name, power in ((value.ring.names[i], e) for i, e in monomial):
                    if name in self.moving_names:
                        moving.append((name, power))
                    else:
                        term *= values[name] ** power
                by_moving[tuple(moving)] = by_moving.get(tuple(moving), ZERO) + term
            if len(by_moving) == 1:
                ((alone, term),) = by_moving.items()
                constant *= term**exponent
                powers += [(name, power * exponent) for name, power in alone]
            else:
                sums.append((id(factor), [(term, of) for of, term in by_moving.items()], exponent))
        self._plans[key] = value, (constant, powers, sums)
        return self._plans[key][1]

    def _eliminated(self, rows: list[dict[int, acb]], size: int) -> tuple[acb, acb]:
        """Return the determinant of so many rows and columns, and what is left of the entry after the last.

        It goes by the pivots that served last, else by others.
        """
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
        values = self._values(s)
        factors: dict[int, acb] = {}
        size = len(self.entries) - (not is_num)
        rows = [{j: x for j, x in row.items() if j < size} for row in self._rows(values, factors)[:size]]
        value, _ = self._eliminated(rows, size)
        return value if is_num else value * self._value(self.divisor, values, factors)

    # -------------------------------------------------------------------------------- bounds in discs

    def bounds(self, radius: float) -> tuple[float, float]:
        """Return ln of bounds on abs(den) and abs(num) for abs(s) up to a radius [rad/s].

        EssentialSingularityError where a denominator may vanish there.
        """
        with precision(64):
            values = self._majorants(radius)
            sizes = [{j: _bound(c, values) for j, c in row.items()} for row in self.entries]
            divisor = _bound(self.divisor, values)
        if not all(x.is_finite() for row in sizes for x in row.values()):
            return inf, inf  # beyond what a ball's exponent holds
        den = _hadamard(sizes[:-1], len(sizes) - 1) + _log(divisor)
        return den, _hadamard(sizes, len(sizes))

    def bounds_on(self, box: acb) -> tuple[float, float]:
        """Return ln of bounds on abs(den) and abs(num) on a box; infinite where a denominator may vanish."""
        values, factors = self._values(box), dict[int, acb]()
        sizes = [{j: x.abs_upper() for j, x in row.items()} for row in self._rows(values, factors)]
        divisor = self._value(self.divisor, values, factors).abs_upper()
        if not all(x.is_finite() for x in (divisor, *(x for row in sizes for x in row.values()))):
            return inf, inf
        den = _hadamard(sizes[:-1], len(sizes) - 1) + _log(divisor)
        return den, _hadamard(sizes, len(sizes))

    def _majorants(self, radius: float) -> dict[str, tuple[arb, bool]]:
        """Return a bound on every generator in the disc, and whether it is a constant."""
        equations = self.equations
        constants = {
            name: (abs(value.real), True) for name, value in self._values(acb(0)).items() if name != LAPLACE
        }
        values: dict[str, tuple[arb, bool]] = {LAPLACE: (arb(radius), False)}
        values |= {name: constants[name] for name in ("pi", *(c.generator for c in equations.constants))}
        for name, value in equations.definitions:
            is_moving = value.depends_on(LAPLACE)
            values[name] = (_bound(value, values), False) if is_moving else constants[name]
        for name, x in self._along_members(lambda x: acb(_bound(x, values)), is_growing=True):
            values[name] = (x.real.abs_upper(), False)
        return values


def _determinants(solved: Eliminated) -> tuple[acb, acb]:
    size = len(solved.order)
    return solved.determinant, solved.rows[size].get(size, ZERO) if len(solved.rows) > size else ZERO


def _uses(value: Factored, names: Collection[str]) -> bool:
    """Tell whether a value has one of these generators."""
    known = value.ring.names
    return any(known[i] in names for f, _ in value.factors for m, _ in terms_of(f) for i, _ in m)


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
        message = "an empty form"
        raise ValueError(message)
    one = form.coefficients[0] ** 0
    s = one.ring.index[LAPLACE]
    parts = (
        c.denominator().filter(lambda f: any(i == s for m, _ in terms_of(f) for i, _ in m))
        for c in form.coefficients
    )
    return least_common_multiple(one, parts)


def _bound(value: Factored, values: Mapping[str, tuple[arb, bool]]) -> arb:
    """Return a bound on abs(value) where abs(s) is at most what ``values`` were made for."""
    result = arb(abs(fmpq(value.unit.numerator, value.unit.denominator)))
    names = value.ring.names
    for factor, exponent in value.factors:
        fixed, moving = arb(0), arb(0)
        for monomial, coefficient in terms_of(factor):
            term, is_fixed = arb(coefficient), True
            for i, power in monomial:
                size, constant = values[names[i]]
                term, is_fixed = term * size**power, is_fixed and constant
            if is_fixed:
                fixed += term
            else:
                moving += abs(term)
        if exponent > 0:
            result *= (abs(fixed) + moving) ** exponent
        else:
            least = abs(fixed) - moving
            if not least > 0:
                raise EssentialSingularityError
            result /= least**-exponent
    return arb(result.abs_upper())


def _log(value: arb) -> float:
    """Return ln of an upper bound."""
    return -inf if value == 0 else float(value.abs_upper().log().upper()) + ROUNDING


def _hadamard(rows: Sequence[Mapping[int, arb]], size: int) -> float:
    """Return ln of a bound on a determinant from bounds on its entries.

    Columns are scaled so that the product of the rows' lengths is about as small as it gets: any scaling
    gives a bound.
    """
    places = [
        (i, j, _log(x)) for i, row in enumerate(rows) for j, x in row.items() if j < size and not x == 0
    ]
    i, j = (np.array([p[k] for p in places], dtype=int) for k in (0, 1))
    logs = np.array([p[2] for p in places])
    scale = np.zeros(size)
    for _ in range(BALANCING):
        lengths = _lengths(i, logs + scale[j], size)
        share = np.exp(2 * (logs + scale[j] - lengths[i]))
        taken = np.bincount(j, share, size)
        scale -= 0.5 * np.log(np.maximum(taken, np.finfo(float).tiny))
    lengths = _lengths(i, logs + scale[j], size)
    return float(lengths.sum() - scale.sum() + ROUNDING * size)


def _lengths(
    i: np.typing.NDArray[np.intp], logs: np.typing.NDArray[np.float64], size: int
) -> np.typing.NDArray[np.float64]:
    """Return ln of the rows' lengths from ln of their entries."""
    largest = np.full(size, -np.inf)
    np.maximum.at(largest, i, logs)
    return np.asarray(largest + 0.5 * np.log(np.bincount(i, np.exp(2 * (logs - largest[i])), size)))
