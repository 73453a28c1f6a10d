"""Determinants of systems too large to be multiplied out, at points of a prime field.

Input: sparse equations of a system, and others over the same ring: of the system with a constraint, of parts.
Output: a :class:`PointRatio`, how the numerator of a transfer function over determinants depends on s.

Example: of a mass m on a spring k, with F and x at the mass, the numerator is 1 and the determinant with the
mass held is 1: their quotient is the same at all points.

Theorem: a polynomial of degree d other than zero vanishes at a random point of a field of p elements with
odds of at most d/p (Schwartz 1980; Zippel 1979). So a quotient that agrees at two points that differ in s,
and in all that depends on it, and in nothing else, does not depend on s but for odds of about 1 in 2^50.
Functions of a member are independent names here: what holds of these holds of the functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from symflex.algebra import LAPLACE, PRIME, Factored, random_point, residue
from symflex.algebra.propagators import EXPONENTIAL
from symflex.analysis.explanation.parts import Relation, opened, same_generators, varying
from symflex.equations import Equations
from symflex.equations.elimination.singular import matrix_of
from symflex.library.elements import LinearForm, Variable
from symflex.transfer.equations_at import EquationsAt

MOST_ORDER = 4  # highest power of s, and of a delay, that is looked for in a quotient
Point = dict[str, int]


@dataclass(frozen=True, slots=True)
class PointRatio:
    """What is known of ``num/(factor*determinants)``."""

    order: int | None  # it is this power of s, up to a constant and delays; ``None`` of anything else
    is_delayed: bool  # it contains a delay
    is_rational: bool  # no waves are in it


@dataclass(frozen=True, eq=False)
class PrimePoints:
    """Points at which names that do not depend on s have the same value."""

    equations: Equations

    @cached_property
    def points(self) -> tuple[Point, Point, Point, Point]:
        """A point; one at another s; one with other waves at the same s; one with other delays."""
        at, names = EquationsAt(self.equations), self.equations.ring.names
        random = random_point([*names, *(f"{name}'" for name in names)])
        first = {name: random[name] for name in names}
        decays = self.decays
        waves = {name: random[f"{name}'"] for name in at.waves_of if name not in decays}
        at_another_s = {**first, **waves, LAPLACE: random[f"{LAPLACE}'"]}
        delayed = {**first, **{name: 2 * first[name] % PRIME for name in decays}}
        return (
            self._defined(first),
            self._defined(at_another_s),
            self._defined({**first, **waves}),
            self._defined(delayed),
        )

    @cached_property
    def decays(self) -> frozenset[str]:
        """Exponentials of s, such as delays."""
        waves = EquationsAt(self.equations).waves
        return frozenset(n for each in waves for n, order in each.orders.items() if order == EXPONENTIAL)

    def _defined(self, point: Point) -> Point:
        for name, value in self.equations.definitions:
            point[name] = residue(value, point)
        return point

    def relate(self, pair: tuple[str, str], factor: Factored, constrained: Equations) -> Relation | None:
        """Return what :func:`.parts.relate` does; a transmission that is no power of s is not known."""
        equations = self.equations
        ratio = self.ratio(pair, factor, [constrained]) if same_generators(constrained, equations) else None
        if ratio is None:
            return None
        s, factored = Factored.generator(equations.ring, LAPLACE), opened(equations, factor)
        order = factored.exponent_of(equations.ring.generator(LAPLACE))
        transmission = None if ratio.order is None else s**ratio.order
        filtered = varying(equations, factored / s**order)
        return Relation(order, filtered, transmission, s**0, has_zeros=True, is_delayed=ratio.is_delayed)

    def varies(self, system: Equations) -> bool:
        """Tell whether a determinant depends on s."""
        forms = [row.form for row in system.rows]
        return len({_determinant(forms, system.unknowns, point) for point in self.points[:3]}) > 1

    def ratio(
        self, pair: tuple[str, str], factor: Factored, systems: Sequence[Equations]
    ) -> PointRatio | None:
        """Return how a numerator over a factor and determinants depends on s; ``None`` where one is zero."""
        equations = self.equations
        read = next(o for o in equations.outputs if o.name == pair[0])
        given = next(v for v in equations.inputs if v.owner == pair[1])
        rows = [*(row.form for row in equations.rows), read.form]
        ratios = []
        for point in self.points:
            above = _determinant(rows, (*equations.unknowns, given), point)
            below = residue(factor, point)
            for system in systems:
                forms = [row.form for row in system.rows]
                below = below * _determinant(forms, system.unknowns, point) % PRIME
            if not above or not below:
                return None
            ratios.append(above * pow(below, -1, PRIME) % PRIME)
        one, other, waved, delayed = ratios
        s, t = (point[LAPLACE] for point in self.points[:2])
        # One delay whose double makes the quotient 2^n times as large is a factor of it, to the power n.
        powers = range(-MOST_ORDER, MOST_ORDER + 1) if len(self.decays) == 1 else [0]
        turns = [n for n in powers if delayed == one * pow(2, n, PRIME) % PRIME]
        change = t * pow(s, -1, PRIME) % PRIME
        orders = [n for n in range(MOST_ORDER + 1) if other == one * pow(change, n, PRIME) % PRIME]
        return PointRatio(orders[0] if orders and turns else None, delayed != one, waved == one)


def _determinant(forms: Sequence[LinearForm], columns: Sequence[Variable], point: Mapping[str, int]) -> int:
    return int(matrix_of(forms, columns, PRIME, lambda value: residue(value, point)).det())
