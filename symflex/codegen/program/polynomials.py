"""Integer polynomials as few operations: nested products and sums, or recurrences found in a determinant.

Input: exact polynomials of one ring, and an expression for each of its generators.
Output: expressions on the forge; no term, and no equal sub-determinant, is computed twice.

For recurrences a polynomial is split as ``v**k * q + r`` with ``r`` free of v, and q and r are stripped of
common factors. For masses in series, ``p_k = m_k s^2 u_k + w_k p_(k+1)`` and ``u_k = p_(k+1) + w_k u_(k+1)``
come out. They grow linearly with the number of masses, where the expanded polynomial grows exponentially; and
each value is exact for slightly different parameters, so that nothing is lost between resonances, where the
expanded polynomial cancels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import gcd
from typing import TYPE_CHECKING

import numpy as np
from flint import fmpz_mpoly

from symflex.algebra import Ring, irreducible_factors
from symflex.errors import BudgetError, Diagnostic
from symflex.print.forms.arrange import FACTOR_LIMIT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from symflex.codegen.program.forge import Forge


Monomial = tuple[int, ...]
Terms = dict[Monomial, int]  # generators' exponents, with an integer or an expression on the forge


@dataclass(frozen=True)
class RingValues:
    """What stands for the generators of a ring."""

    # An expression for each generator; that of the Laplace variable is s, or 1/s in the far branch.
    values: tuple[int, ...]
    degrees: tuple[int, ...]  # degree in s of each generator: 1 for s, 0 for a parameter
    pi: int  # position of the generator pi
    is_far: bool  # true when ``values`` are the generators over ``s**degree``, in powers of 1/s


def degree_of(polynomial: fmpz_mpoly, degrees: Sequence[int]) -> int:
    """Return the degree in s when every generator has its own degree in s."""
    return max(sum(int(e) * d for e, d in zip(m, degrees, strict=True)) for m in polynomial.monoms())


def evaluate_polynomial(forge: Forge, polynomial: fmpz_mpoly, images: RingValues) -> int:
    """Return a polynomial by Horner's rule in s, in the far branch over ``s**degree``."""
    groups: dict[Monomial, Terms] = {}
    total = degree_of(polynomial, images.degrees)
    varying = [i for i, d in enumerate(images.degrees) if d]
    for exponents, coefficient in polynomial.terms():
        monomial = tuple(int(e) for e in exponents)
        degree = sum(e * d for e, d in zip(monomial, images.degrees, strict=True))
        key = [monomial[i] for i in varying]
        if images.is_far:
            key[0] = total - degree
        fixed = tuple(0 if d else e for e, d in zip(monomial, images.degrees, strict=True))
        groups.setdefault(tuple(key), {})[fixed] = int(coefficient)
    values = [images.values[i] for i in varying]
    parts: dict[int, Terms] = {}  # by powers of the first value, the Laplace variable
    for monomial, group in groups.items():
        parts.setdefault(monomial[0], {})[(0, *monomial[1:])] = _coefficient(forge, group, images)
    powers = sorted(parts, reverse=True)
    result = _nest(forge, parts[powers[0]], values)
    for higher, lower in pairwise(powers):
        raised = forge.power(values[0], higher - lower)
        result = forge.add([forge.multiply([result, raised]), _nest(forge, parts[lower], values)])
    return forge.multiply([result, forge.power(values[0], powers[-1])])


def _coefficient(forge: Forge, terms: Terms, images: RingValues) -> int:
    """Return a polynomial in parameters."""
    numbers: Terms = {}
    for monomial, integer in terms.items():
        without_pi = tuple(0 if i == images.pi else e for i, e in enumerate(monomial))
        number = forge.constant(integer, monomial[images.pi])
        numbers[without_pi] = forge.add([numbers[without_pi], number]) if without_pi in numbers else number
    return _nest(forge, numbers, images.values)


def _nest(forge: Forge, terms: Mapping[Monomial, int], values: Sequence[int]) -> int:
    """Return a sum of products, the generator that most terms share taken out first, and so on inside."""
    common = tuple(map(min, zip(*terms, strict=True)))
    reduced = {tuple(e - c for e, c in zip(m, common, strict=True)): k for m, k in terms.items()}
    outside = [forge.power(v, e) for v, e in zip(values, common, strict=True) if e]
    if len(reduced) == 1:
        return forge.multiply([*reduced.values(), *outside])
    coefficients = set(reduced.values())
    if len(coefficients) == 1:
        outside = [coefficients.pop(), *outside]
        reduced = dict.fromkeys(reduced, forge.constant(1))
    summands: list[int] = []
    while reduced:
        counts = [sum(1 for m in reduced if m[i]) for i in range(len(values))]
        most = max(counts)
        if most < 2:  # noqa: PLR2004
            summands += [_nest(forge, {m: k}, values) for m, k in reduced.items()]
            break
        i = counts.index(most)
        inside = {m: k for m, k in reduced.items() if m[i]}
        reduced = {m: k for m, k in reduced.items() if not m[i]}
        summands.append(_nest(forge, inside, values))
    return forge.multiply([*outside, forge.add(summands)])


WORK_LIMIT, DEPTH_LIMIT = 300_000_000, 150
"""Exponents looked at before the search for structure is given up, about two seconds, and splits inside one
another: a polynomial of so high a degree is better nested by powers of s."""


@dataclass(frozen=True, slots=True)
class Scaled:
    """``integer * monomial * steps[rest]``; a negative ``rest`` stands for one."""

    integer: int
    monomial: tuple[int, ...]
    rest: int


@dataclass(frozen=True, slots=True)
class SumStep:
    """The sum of its parts."""

    parts: tuple[Scaled, ...]


@dataclass(frozen=True, slots=True)
class ProductStep:
    """An integer times powers of irreducible factors."""

    integer: int
    parts: tuple[tuple[Scaled, int], ...]


@dataclass(frozen=True, slots=True)
class RecurrencePlan:
    """How to compute some polynomials together."""

    steps: tuple[SumStep | ProductStep, ...]  # each uses earlier ones only
    roots: tuple[Scaled, ...]  # the polynomials asked for


def plan_recurrences(
    ring: Ring, polynomials: Sequence[fmpz_mpoly], *, splits_s: bool = False
) -> RecurrencePlan:
    """Return how to compute several polynomials of a ring with few operations; SF503 if that is long.

    With ``splits_s`` they are split by s as by any other generator, which serves elements that share
    parameters.
    """
    planner = _Planner(ring, splits_s)
    roots = planner.plan_all([_Terms.of(polynomial) for polynomial in polynomials])
    return RecurrencePlan(tuple(planner.steps), roots)


def express(forge: Forge, plan: RecurrencePlan, images: RingValues) -> list[tuple[int, int]]:
    """Return the expressions of a plan's polynomials, far ones over ``s**degree``, and their degrees."""
    made: list[tuple[int, int]] = []

    def scaled(part: Scaled) -> tuple[int, int]:
        value, degree = made[part.rest] if part.rest >= 0 else (forge.constant(1), 0)
        factors = [forge.constant(part.integer, part.monomial[images.pi])]
        for i, exponent in enumerate(part.monomial):
            if exponent and i != images.pi:
                degree += exponent * images.degrees[i]
                # In the far branch s divided by its own power is one.
                if i or not images.is_far:
                    factors.append(forge.power(images.values[i], exponent))
        return forge.multiply([*factors, value]), degree

    for step in plan.steps:
        if isinstance(step, ProductStep):
            pairs = [(scaled(part), exponent) for part, exponent in step.parts]
            factors = [forge.power(value, exponent) for (value, _), exponent in pairs]
            total = sum(degree * exponent for (_, degree), exponent in pairs)
            made.append((forge.multiply([forge.constant(step.integer), *factors]), total))
            continue
        parts = [scaled(part) for part in step.parts]
        total = max(degree for _, degree in parts)
        if images.is_far:
            inverse = images.values[0]
            parts = [(forge.multiply([v, forge.power(inverse, total - d)]), d) for v, d in parts]
        made.append((forge.add([value for value, _ in parts]), total))
    return [scaled(root) for root in plan.roots]


@dataclass(frozen=True, eq=False)
class _Terms:
    """A polynomial as a matrix of exponents, one row per term in the ring's order, and coefficients."""

    exponents: NDArray[np.int32]
    coefficients: tuple[int, ...]

    @staticmethod
    def of(polynomial: fmpz_mpoly) -> _Terms:
        exponents = [[int(e) for e in monomial] for monomial in polynomial.monoms()]
        return _Terms(np.array(exponents, dtype=np.int32), tuple(int(c) for c in polynomial.coeffs()))

    @property
    def key(self) -> tuple[bytes, tuple[int, ...]]:
        return self.exponents.tobytes(), self.coefficients

    def stripped(self) -> tuple[int, tuple[int, ...], _Terms]:
        """Return the integer and the monomial that all terms share, and the rest, its first term positive."""
        content = self.exponents.min(axis=0)
        integer = gcd(*self.coefficients)
        integer = -integer if self.coefficients[0] < 0 else integer
        primitive = _Terms(self.exponents - content, tuple(c // integer for c in self.coefficients))
        return integer, tuple(content.tolist()), primitive

    def parts(self, variable: int) -> tuple[_Terms, _Terms]:
        """Return the terms with a variable and those without; both exist when there is no content."""
        has = self.exponents[:, variable] > 0
        with_it: list[int] = []
        without: list[int] = []
        for c, is_in in zip(self.coefficients, has.tolist(), strict=True):
            (with_it if is_in else without).append(c)
        return _Terms(self.exponents[has], tuple(with_it)), _Terms(self.exponents[~has], tuple(without))

    def variables(self) -> list[int]:
        return [int(i) for i in np.flatnonzero(self.exponents.any(axis=0))]


@dataclass
class _Planner:
    """Finds the steps, the operands of each before itself."""

    ring: Ring
    splits_s: bool
    steps: list[SumStep | ProductStep] = field(default_factory=list)
    _positions: dict[tuple[bytes, tuple[int, ...]], int] = field(default_factory=dict)
    _wanted: set[tuple[bytes, tuple[int, ...]]] = field(default_factory=set)
    _work: int = 0
    _depth: int = 0

    def plan_all(self, polynomials: Sequence[_Terms]) -> tuple[Scaled, ...]:
        """Return several polynomials, planned from the largest: smaller ones are often its parts."""
        self._wanted.update(polynomial.stripped()[2].key for polynomial in polynomials)
        plans: dict[int, Scaled] = {}
        for i in sorted(range(len(polynomials)), key=lambda i: -len(polynomials[i].coefficients)):
            plans[i] = self.plan(polynomials[i])
        return tuple(plans[i] for i in range(len(polynomials)))

    def plan(self, terms: _Terms) -> Scaled:
        """Return a polynomial in terms of the steps found so far and those it adds."""
        integer, monomial, primitive = terms.stripped()
        if len(primitive.coefficients) == 1:
            return Scaled(integer, monomial, -1)
        key = primitive.key
        if key not in self._positions:
            self._depth += 1
            if self._depth > DEPTH_LIMIT:
                raise _without_structure()
            step = self._product(primitive) or self._split(primitive)
            self._depth -= 1
            self.steps.append(step)
            self._positions[key] = len(self.steps) - 1
        return Scaled(integer, monomial, self._positions[key])

    def _product(self, terms: _Terms) -> ProductStep | None:
        """Return the product of the irreducible factors, ``None`` when there is only one."""
        if len(terms.coefficients) > FACTOR_LIMIT:
            return None
        rows = map(tuple, terms.exponents.tolist())
        polynomial = self.ring.context.from_dict(dict(zip(rows, terms.coefficients, strict=True)))
        constant, factors = irreducible_factors(polynomial)
        if len(factors) == 1 and factors[0][1] == 1:
            return None
        parts = [(self.plan(_Terms.of(factor)), exponent) for factor, exponent in factors]
        return ProductStep(constant, tuple(parts))

    def _split(self, terms: _Terms) -> SumStep:
        every = terms.variables()
        variables = every if self.splits_s else [i for i in every if i] or every
        self._work += terms.exponents.size * len(variables)
        if self._work > WORK_LIMIT:
            raise _without_structure()
        parts = min((terms.parts(v) for v in variables), key=self._cost)
        return SumStep(self.plan_all(parts))

    def _cost(self, parts: tuple[_Terms, _Terms]) -> tuple[int, int]:
        """Return how many terms, and generators, a split leaves to do; the first of equals is taken."""
        rests = [part.stripped()[2] for part in parts]
        new = [remaining for remaining in rests if remaining.key not in self._wanted]
        return sum(len(remaining.coefficients) for remaining in new), sum(
            len(remaining.variables()) for remaining in new
        )


def _without_structure() -> BudgetError:
    message = "the closed form has too little structure for recurrences"
    return BudgetError(Diagnostic("SF503", message, None, "give more parameters numbers, or split the model"))
