"""Lowest terms of transfer functions with kernels: common factors cancelled, both parts entire.

Input: numerator and denominator over the ring of wavenumbers and kernels.
Output: a :class:`ReducedQuotient`; what cancelled is kept, as hidden modes.

Example: a rod clamped at one end and pulled at the other, ``gamma^2 = rho s^2/E``.

    before    sinh(gamma l) / (E A gamma cosh(gamma l))
    after     num = sinh(gamma l)/gamma       den = E A cosh(gamma l)

Both are functions of s without poles: sinh(gamma l)/gamma is even in gamma, and l where gamma is zero. As it
stood before, the wavenumber below would count as a pole at s = 0, which the rod does not have.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import accumulate, combinations, product, repeat
from math import prod
from operator import mul
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import (
    LAPLACE,
    MEMORY_LIMIT,
    Dispersion,
    Factored,
    KernelTable,
    Radicals,
    Ring,
    degree_in,
    irreducible_factors,
)
from symflex.algebra.exponentials import Exponentials, KernelPair, lift, split_content
from symflex.algebra.normal_form import NormalForm
from symflex.algebra.ring import by_powers
from symflex.algebra.vanishing import OriginSeries, Vanishing
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic
from symflex.transfer.expansion import KERNEL_TERMS
from symflex.transfer.lowest_terms import cancel

if TYPE_CHECKING:
    Split = Callable[[fmpz_mpoly], tuple[fmpz_mpoly, fmpz_mpoly]]

WAYS = 12  # ways to solve the dispersion relations that are tried when orders of vanishing are looked for


@dataclass(frozen=True, slots=True, eq=False)
class ReducedQuotient:
    """A quotient in lowest terms."""

    num: Factored  # num and den: entire in s, maybe with negative powers of wavenumbers that cancel
    den: Factored
    shared: Factored  # the common factor that was cancelled
    table: KernelTable  # what the generators are; its base lengths may be half the given ones


class KernelReduction:
    """Reduces quotients over one ring of kernels.

    The ring has s, parameters, pi, functions of constants, wavenumbers and kernels; one of the ``parameters``
    may be expressed by a wavenumber while common factors are sought. ``coordinates`` has, per dispersion and
    length that was asked for, its multiples of the table's base lengths.
    """

    def __init__(
        self,
        ring: Ring,
        table: KernelTable,
        parameters: Sequence[str],
        coordinates: Sequence[Sequence[Sequence[int]]] = (),
        radicals: Radicals | None = None,
    ) -> None:
        self.ring = ring
        self._radicals = radicals or Radicals(ring)
        self._multiples = _multiples(table, coordinates)
        self.table = table
        self.normal = NormalForm(ring, table)
        self.coordinates = Exponentials(ring, table)
        self.solved = _solve_relations(ring, table, parameters)
        # A later formula contains no parameter of an earlier one, so the last is evaluated first.
        self._solutions = tuple(s[::-1] for s in _solve_in_many_ways(ring, table, parameters)) or ((),)
        relations = sum(len(_relations(ring, d)) for d in table.dispersions)
        self._is_solved = len(self.solved) == relations
        self._kernels = [ring.index[k.generator] for k in table.kernels]
        self._parameters = parameters

    @property
    def is_sure(self) -> bool:
        """True where no common factor is overlooked: pairs of wavenumbers belong to parameters or numbers."""
        coefficients = (c for d in self.table.dispersions if d.kind == "pair" for c in d.characteristic)
        return self._is_solved or not any(c.depends_on(p) for c in coefficients for p in self._parameters)

    def has_kernels(self, factor: fmpz_mpoly) -> bool:
        """Tell whether a polynomial over the ring contains a kernel."""
        degrees = factor.degrees()
        return any(int(degrees[i]) for i in self._kernels)

    def _is_of_waves(self, factor: fmpz_mpoly) -> bool:
        """Tell whether a polynomial, in kernels or exponentials, holds wavenumbers and no kernels."""
        degrees = factor.degrees()
        free = len(self.ring.names) - len(self._kernels)
        return self._has_waves(factor) and not any(int(d) for d in degrees[free:])

    def _has_waves(self, factor: fmpz_mpoly) -> bool:
        degrees = factor.degrees()
        return any(int(degrees[self.ring.index[w]]) for w in self.table.wavenumbers)

    def reduce(self, num: Factored, den: Factored, cancelled: Factored) -> ReducedQuotient | None:
        """Return a quotient in lowest terms, ``None`` where it divides by 0, given what was ``cancelled``."""
        if max(sum(len(f) for f, _ in v.factors) for v in (num, den)) > KERNEL_TERMS:
            message = f"the closed form has more than {KERNEL_TERMS} terms before it is reduced"
            hint = "let equal parts share their parameters, or split the model"
            raise BudgetError(Diagnostic("SF502", message, None, hint))
        # Where parameters follow from the wavenumbers, that alone makes equal functions equal.
        pairs = not self._is_solved
        above, below = (
            self._radicals.reduced(_solved_for(self.normal.reduce_factored(v, pairs=pairs), self.solved))
            for v in (num, den)
        )
        if below.is_zero:
            return None
        if above.is_zero:
            one, modes = Factored.number(self.ring, 1), self.normal.reduce_factored(den * cancelled)
            return ReducedQuotient(one * 0, one, self._modes(modes), self.table)
        before = _solved_for(cancelled, self.solved)
        above, below, before = (self._in_exponentials(v) for v in (above, below, before))
        matched = self._without_reflections(num, den, cancelled)
        quotient, shared = matched or self._lowest(above, below, before)
        table, back = self._restorer([quotient, shared])
        quotient, shared = back(quotient), back(shared)
        if matched:
            quotient, _ = self._radicals.in_lowest_terms(quotient)
        shortest = _with_fewer_waves(self._shortest(self._waves_apart(quotient)), table)
        ratio = _split_contents(shortest, self._kernel_content)
        plain = ratio.filter(lambda f: not self.has_kernels(f))
        ratio = ratio / plain * self._radicals.without_rooted_scale(plain)  # (1 + j*eta)^2 is multiplied out
        modes = self._modes(self._shortest(shared)).filter(lambda f: not self._is_one_wave(f))
        if table is self.table:
            ratio, modes, table = self._lifted(ratio, modes)
        num, den = self._entire(ratio, table)
        return ReducedQuotient(num, den, modes, table)

    def _without_reflections(
        self, num: Factored, den: Factored, cancelled: Factored
    ) -> tuple[Factored, Factored] | None:
        """Return :meth:`_lowest` if it leaves no kernel: a line that ends in its impedance is a resistor."""
        if len(self._images) < len(self.table.dispersions):
            return None
        values = (self._radicals.reduced(_solved_for(v, self._images)) for v in (num, den, cancelled))
        above, below, before = map(self._in_exponentials, values)
        if below.is_zero:
            return None
        quotient, shared = self._lowest(above, below, before)
        free = len(self.ring.names) - len(self._kernels)
        return None if any(any(f.degrees()[free:]) for f, _ in quotient.factors) else (quotient, shared)

    @cached_property
    def _images(self) -> list[tuple[str, Factored]]:
        """The wavenumbers that are rational functions of s."""
        waves = [law for law in self.table.dispersions if law.kind == "wave"]
        roots = ((law.wavenumbers[0], self._radicals.either_root(-law.characteristic[0])) for law in waves)
        return [(name, root) for name, root in roots if root is not None]

    def _is_one_wave(self, factor: fmpz_mpoly) -> bool:
        """Tell whether a polynomial in kernels is one exponential times powers, so that only 0 is a root."""
        value = self._radicals.reduced(_solved_for(Factored.polynomial(self.ring, factor), self._images))
        return self.has_kernels(factor) and all(len(f) == 1 for f, _ in self._in_exponentials(value).factors)

    def _lowest(self, above: Factored, below: Factored, before: Factored) -> tuple[Factored, Factored]:
        """Return a quotient with common factors cancelled, and these times what was cancelled before."""
        # Parameters that follow from wavenumbers have left denominators, which are no part of what is shared.
        above, below = (cancel(v.numerator(), v.denominator())[0] for v in (above, below))
        quotient, shared = cancel(above, below)
        shared, _ = cancel((shared * before).numerator(), before.denominator())
        quotient, shared = (_split_contents(v, self.coordinates.split) for v in (quotient, shared))
        # Powers of wavenumbers come of clearing denominators: as powers of s they would look like modes.
        return quotient, shared.filter(lambda f: not self._is_of_waves(f)).numerator()

    def _kernel_content(self, polynomial: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return a polynomial as one free of kernels times the rest."""
        return split_content(self.ring, polynomial, len(self.ring.names) - len(self._kernels))

    def _lifted(self, ratio: Factored, modes: Factored) -> tuple[Factored, Factored, KernelTable]:
        """Return the values in kernels of longer lengths that were asked for, where these suffice."""
        table = self.table
        for length, multiples in self._multiples:
            angles = [a for a in self.coordinates.angles if a.even.length is length]
            for n in multiples:
                lifted = [self._lift(v, angles, n) for v in (ratio, modes)]
                if lifted[0] is not None and lifted[1] is not None:
                    ratio, modes = lifted[0], lifted[1]
                    longer = {a.even.length: a.even.length * n for a in angles}
                    table = KernelTable(
                        table.dispersions,
                        tuple(replace(k, length=longer.get(k.length, k.length)) for k in table.kernels),
                    )
                    break
        return ratio, modes, table

    def _lift(self, value: Factored, angles: Sequence[KernelPair], n: int) -> Factored | None:
        result = Factored.number(self.ring, value.unit)
        for factor, exponent in value.factors:
            images = Factored.polynomial(self.ring, factor)
            if self.has_kernels(factor):
                for angle in angles:
                    lifted = Factored.number(self.ring, images.unit)
                    for polynomial, power in images.factors:
                        image = lift(self.ring, polynomial, angle, n)
                        if image is None:
                            return None
                        lifted = lifted * image**power
                    images = lifted
            result = result * images**exponent
        return result

    def hidden_where_waves_vanish(self, determinant: Factored, reduced: ReducedQuotient) -> Factored:
        """Return the factors that only the determinant has: rigid-body modes out of sight."""
        result = Factored.number(self.ring, 1)
        if reduced.num.is_zero:
            return result
        for factor in self._vanishing:
            full_order = OriginSeries(self.ring, self.table, factor).order(determinant)
            reduced_order = OriginSeries(self.ring, reduced.table, factor).order(reduced.den)
            if full_order is not None and reduced_order is not None and full_order > reduced_order:
                result = result * Factored.polynomial(self.ring, factor) ** (full_order - reduced_order)
        return result

    @cached_property
    def _vanishing(self) -> tuple[fmpz_mpoly, ...]:
        """What vanishes with a wavenumber or where two meet: s, and where foundations balance inertia."""
        factors = [self.ring.context.gen(0)]
        for dispersion in self.table.dispersions:
            for meeting in dispersion.meets:
                factors += [f for f, _ in meeting.factors if f not in factors and degree_in(f, 0)]
            for factor, exponent in dispersion.characteristic[0].factors if dispersion.characteristic else ():
                if exponent > 0 and degree_in(factor, 0) and factor not in factors:
                    factors.append(factor)
        return tuple(factors)

    def _shortest(self, value: Factored) -> Factored:
        """Return a value in normal form, or with its pairs of wavenumbers left, whichever is shorter."""
        pairs = any(d.kind == "pair" for d in self.table.dispersions)

        def shortest(factor: fmpz_mpoly) -> Factored:
            reduced = [self.normal.reduce(factor, pairs=p) for p in ((False, True) if pairs else (False,))]
            return min(reduced, key=lambda value: sum(len(f) - 1 for f, _ in value.factors))

        return self.normal.balance(value.map_factors(self.ring, shortest))

    def _waves_apart(self, value: Factored) -> Factored:
        """Return a product in which no factor hides wavenumbers of a pair, or what vanishes where they meet.

        If no parameter follows from the wavenumbers, ``q_1 (q_2 sinh(q_1) - q_1 sinh(q_2))`` has become
        ``q_1 q_2 sinh(q_1) + (q_2^2 + c_2) sinh(q_2)``. A factor holds q_1 if its product with ``q_1 q_2^2``
        holds ``c_0 = q_1^2 q_2^2``, and ``s - a q_1`` if its product with those of ``-q_1`` and the other
        wavenumber holds what all four make, a polynomial in s.
        """

        def is_of_waves(factor: fmpz_mpoly) -> bool:
            return len(factor) > 1 and self._is_of_waves(factor)

        for law in self.table.dispersions:
            if law.kind in ("wave", "bending"):
                value = self._single_wave_apart(value, law)
            if law.kind != "pair" or self._is_solved:
                continue
            first, second = (Factored.generator(self.ring, w) for w in law.wavenumbers)
            split, meets, c_0 = self._split(law), law.discriminant, law.characteristic[0]
            parts = [(split, split, meets), (first, first * second**2, c_0), (second, second * first**2, c_0)]
            # s^2 - 2500 q_2^2 may be 1250 (q_1^2 - q_2^2), which neither of its factors tells.
            waves = value.filter(is_of_waves)
            for side, exponent in ((waves.numerator(), 1), (waves.denominator(), -1)):
                made = self._divided(*parts[0], side.expand())
                if all(made.exponent_of(f) > 0 for f, _ in split.factors):
                    value = value * (made / side) ** exponent
            for f, _ in value.filter(is_of_waves).factors:
                divisor, times = Factored.polynomial(self.ring, f), self._conjugates(f, law)
                product = self.normal.reduce((divisor * times).expand())
                if not any(self._has_waves(g) for g, _ in product.factors):
                    parts.append((divisor, times, product))
            for divisor, times, product in parts:
                if product.numerator().factors:
                    divided = partial(self._divided, divisor, times, product)
                    value = value.map_factors(self.ring, divided)
            # What vanishes where they meet, the split's square over powers of s, say, may face the split.
            largest = max((f for f, _ in meets.numerator().factors), key=len, default=None)
            order = 0 if largest is None else value.exponent_of(largest)
            if order * min(value.exponent_of(f) for f, _ in split.factors) < 0:
                value = value * (split**2 / meets) ** order
        return value

    def _single_wave_apart(self, value: Factored, law: Dispersion) -> Factored:
        """Return a product in which no factor hides a wavenumber that vanishes elsewhere than at s = 0.

        With ``gamma^2 = s (s + c)``, ``gamma (s sinh(gamma) + gamma cosh(gamma))`` has become ``s gamma
        sinh(gamma) + s (s + c) cosh(gamma)``: over s it would hold s + c, as a pole or a zero.
        """
        power, (name,) = self.normal.power_of(law), law.wavenumbers
        if not any(f != self.ring.context.gen(0) and degree_in(f, 0) for f, _ in power.numerator().factors):
            return value
        wave = Factored.generator(self.ring, name)
        times = wave if law.kind == "wave" else wave**3
        return value.map_factors(self.ring, partial(self._divided, wave, times, power))

    def _conjugates(self, factor: fmpz_mpoly, law: Dispersion) -> Factored:
        """Return the product of the other polynomials that signs and order of two wavenumbers make."""
        first, second = law.wavenumbers
        made, gen = [factor], self.ring.generator
        result = Factored.number(self.ring, 1)
        for (one, other), x, y in product(((first, second), (second, first)), (1, -1), (1, -1)):
            conjugate = self.ring.replaced(factor, {first: x * gen(one), second: y * gen(other)})
            if conjugate not in made and -conjugate not in made:
                made.append(conjugate)
                result = result * Factored.polynomial(self.ring, conjugate)
        return result

    def _divided(self, divisor: Factored, times: Factored, product: Factored, factor: fmpz_mpoly) -> Factored:
        """Return a factor with the divisor ``whole/times`` set apart; a power of s may be left below."""
        multiplied = prod((f**e for f, e in times.factors), start=factor)
        quotient = _split_contents(self.normal.reduce(multiplied), self._kernel_content) / product
        s = self.ring.context.gen(0)
        lacking = [f for f, e in quotient.factors if e < 0 and product.exponent_of(f) > 0]
        has_others = any(f != s and int(f.degrees()[0]) for f, _ in product.numerator().factors)
        if lacking and not (lacking == [s] and has_others):
            return Factored.polynomial(self.ring, factor)
        return divisor * quotient.map_factors(self.ring, partial(self._divided, divisor, times, product))

    def _modes(self, value: Factored) -> Factored:
        """Return factors that are modes: not of wavenumbers, poles of fields, or exponentials."""
        singular = [
            f for d in self.table.dispersions for c in d.characteristic for f, _ in c.denominator().factors
        ]
        pairs = (d for d in self.table.dispersions if d.kind == "pair")
        singular += [f for d in pairs for f, _ in d.discriminant.numerator().factors]
        decays = [self.ring.generator(k.generator) for k in self.table.kernels if k.function == "exp"]

        def is_mode(factor: fmpz_mpoly) -> bool:
            if self.has_kernels(factor):
                return factor not in decays
            return len(factor) > 1 and degree_in(factor, 0) > 0 and not self._has_waves(factor)

        result = Factored.number(self.ring, 1)
        for factor, exponent in value.filter(is_mode).factors:
            remaining = (
                factor if self.has_kernels(factor) else _without(factor, (*singular, *self._vanishing))
            )
            if not remaining.is_constant():
                result = result * Factored.polynomial(self.ring, remaining) ** exponent
        return result

    def _in_exponentials(self, value: Factored) -> Factored:
        return value.map_factors(self.coordinates.coordinates, self.coordinates.transform)

    def _restorer(self, values: Sequence[Factored]) -> tuple[KernelTable, _Restorer]:
        """Return how to come back from exponentials, with half angles where nothing else will do."""
        plain = _Restorer(self.coordinates, self.coordinates, ())
        odd = {i for v in values for i in plain.odd_angles(v)}
        if not odd:
            return self.table, plain
        angles = self.coordinates.angles
        lengths = {angles[i].even.length for i in odd}
        table = self.coordinates.halved([a.even for a in angles if a.even.length in lengths])
        doubled = tuple(i for i, a in enumerate(angles) if a.even.length in lengths)
        return table, _Restorer(self.coordinates, Exponentials(self.ring, table), doubled)

    def _entire(self, ratio: Factored, table: KernelTable) -> tuple[Factored, Factored]:
        """Split a quotient into entire parts that are not both zero where a wavenumber is."""
        vanishing = Vanishing(self.ring, table, self._solutions)
        one = Factored.number(self.ring, 1)
        above, below = [one], [one]
        remaining = Factored.number(self.ring, ratio.unit)
        splits = {d: self._split(d) for d in table.dispersions if d.kind == "pair"}
        meets = [value for d in table.dispersions for value in d.meets]
        meetings = [f for f in self._vanishing if any(value.exponent_of(f) for value in meets)]
        series = [(f, OriginSeries(self.ring, table, f)) for f in meetings]
        for factor, exponent in ratio.factors:
            if not self.has_kernels(factor):
                remaining = remaining * Factored(self.ring, Fraction(1), ((factor, exponent),))
                continue
            orders = self._orders(vanishing, factor, table, splits)
            for meeting, near in series:
                order = near.order(Factored.polynomial(self.ring, factor)) or 0
                orders = orders * Factored.polynomial(self.ring, meeting) ** order
            piece = Factored(self.ring, Fraction(1), ((factor, abs(exponent)),))
            (above if exponent > 0 else below).append(piece / orders ** abs(exponent))
            remaining = remaining * orders**exponent
        remaining = self._whole(_merge_splits(remaining, splits.values()), table, splits)
        num, den = prod(above, start=remaining.numerator()), prod(below, start=remaining.denominator())
        return self._apart_at_origin(num, den, table)

    def _apart_at_origin(self, num: Factored, den: Factored, table: KernelTable) -> tuple[Factored, Factored]:
        """Return both without the power of s that divides both, as entire functions."""
        origin = OriginSeries(self.ring, table)
        orders = origin.order(num), origin.order(den)
        if orders[0] is None or orders[1] is None:
            return num, den
        common = Factored.generator(self.ring, "s") ** -min(orders[0], orders[1])
        return num * common, den * common

    def _split(self, dispersion: Dispersion) -> Factored:
        first, second = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
        return first**2 - second**2

    def _orders(
        self, vanishing: Vanishing, factor: fmpz_mpoly, table: KernelTable, splits: dict[Dispersion, Factored]
    ) -> Factored:
        """Return the powers of wavenumbers, and of their differences, that a factor vanishes like."""
        result = Factored.number(self.ring, 1)
        degrees = factor.degrees()
        for dispersion in table.dispersions:
            used = [k for k in table.kernels_of(dispersion) if int(degrees[self.ring.index[k.generator]])]
            if not used:
                continue
            if dispersion.kind in ("wave", "bending"):
                (name,) = dispersion.wavenumbers
                result = result * Factored.generator(self.ring, name) ** (
                    vanishing.at_zero(factor, name) or 0
                )
            elif dispersion.kind == "pair":
                first, second = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
                at_zero = vanishing.at_zero_of_pair(factor, dispersion) or 0
                meeting = vanishing.at_confluence(factor, dispersion) or 0
                result = result * (first * second) ** at_zero * splits[dispersion] ** meeting
        return result

    def _whole(self, remaining: Factored, table: KernelTable, splits: dict[Dispersion, Factored]) -> Factored:
        """Return a product of wavenumber powers as a rational function of s."""
        remaining = self.normal.balance(remaining)
        for dispersion in table.dispersions:
            if dispersion.kind != "pair":
                continue
            first, second = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
            power, other = (remaining.exponent_of(self.ring.generator(w)) for w in dispersion.wavenumbers)
            split = splits[dispersion]
            ((polynomial, _),) = split.factors
            meeting = remaining.exponent_of(polynomial)
            if power and power == other and power % 2 == 0:
                remaining = (
                    remaining / (first * second) ** power * dispersion.characteristic[0] ** (power // 2)
                )
            if meeting and meeting % 2 == 0:
                remaining = remaining / split**meeting * dispersion.discriminant ** (meeting // 2)
        return remaining


def opened(num: Factored, den: Factored, table: KernelTable) -> tuple[Factored, Factored]:
    """Return a quotient into which coefficients have been put without what is common to both parts."""
    num, den = _with_fewer_waves(num, table), _with_fewer_waves(den, table)
    _, shared = cancel(num.numerator(), den.numerator())
    return num / shared, den / shared


def _with_fewer_waves(value: Factored, table: KernelTable) -> Factored:
    """Return a product with factors such as ``c - lambda_i^2`` multiplied out, to one of s."""
    ring, normal = value.ring, NormalForm(value.ring, table)
    waves, kernels = frozenset(table.wavenumbers), frozenset(k.generator for k in table.kernels)
    used = [(f, e, ring.used_in([f])) for f, e in value.factors]
    wave_factors = [(f, e) for f, e, names in used if names & waves and not names & kernels]
    for (f, e), (g, d) in combinations(wave_factors, 2):
        joined = normal.reduce(f * g)
        if e == d and ring.used_in(p for p, _ in joined.factors).isdisjoint(waves):
            pair = Factored.polynomial(ring, f) * Factored.polynomial(ring, g)
            return _with_fewer_waves(value / pair**e * joined**e, table)
    return value


def _split_contents(value: Factored, split: Split) -> Factored:
    """Return a value with every factor free of kernels set apart."""
    result = Factored.number(value.ring, value.unit)
    for factor, exponent in value.factors:
        content, primitive = split(factor)
        number, pieces = irreducible_factors(content)
        result = result * Fraction(number) ** exponent
        for piece, power in (*pieces, (primitive, 1)):
            result = result * Factored.polynomial(value.ring, piece) ** (exponent * power)
    return result


def _merge_splits(value: Factored, splits: Iterable[Factored]) -> Factored:
    """Return a product with ``(lambda_1 - lambda_2) (lambda_1 + lambda_2)`` as one factor."""
    for pair in splits:
        ((polynomial, _),) = pair.factors
        _, pieces = irreducible_factors(polynomial)
        halves = [Factored.polynomial(value.ring, p) for p, _ in pieces]
        exponents = [value.exponent_of(h.factors[0][0]) for h in halves if len(h.factors) == 1]
        if len(exponents) == 2 and exponents[0] == exponents[1] != 0:  # noqa: PLR2004
            value = value * (pair / (halves[0] * halves[1])) ** exponents[0]
    return value


def _without(polynomial: fmpz_mpoly, factors: Sequence[fmpz_mpoly]) -> fmpz_mpoly:
    """Return a polynomial divided by every power of the factors that divides it."""
    for factor in factors:
        while not (common := polynomial.gcd(factor)).is_constant():
            spend()
            polynomial = polynomial / common
    return polynomial


def _multiples(
    table: KernelTable, coordinates: Sequence[Sequence[Sequence[int]]]
) -> tuple[tuple[Factored, tuple[int, ...]], ...]:
    """Return per base length the multiples of it alone that were asked for, longest first."""
    products: list[tuple[Factored, tuple[int, ...]]] = []
    for dispersion, wanted in zip(table.dispersions, coordinates, strict=False):
        if dispersion.kind == "general" or not dispersion.shift.is_zero:
            continue
        lengths = list({k.length: None for k in table.kernels_of(dispersion)})
        for i, length in enumerate(lengths):
            alone = {abs(c[i]) for c in wanted if not any(x for j, x in enumerate(c) if j != i)}
            if multiples := sorted((n for n in alone if n > 1), reverse=True):
                products.append((length, tuple(multiples)))
    return tuple(products)


def _solve_relations(
    ring: Ring, table: KernelTable, parameters: Sequence[str]
) -> tuple[tuple[str, Factored], ...]:
    """Return parameters by wavenumbers and the rest, one per relation: the shortest, in either order."""
    relations = [r for d in table.dispersions for r in _relations(ring, d)]
    orders = (
        (relations, relations[::-1]) if any(d.kind == "pair" for d in table.dispersions) else (relations,)
    )
    ways = (_solve_in_turn(ring, order, parameters) for order in orders)
    # Few relations left unsolved, then few terms.
    return min(ways, key=lambda way: (-len(way), sum(len(f) for _, x in way for f, _ in x.factors)))


def _solve_in_many_ways(
    ring: Ring, table: KernelTable, parameters: Sequence[str]
) -> list[tuple[tuple[str, Factored], ...]]:
    """Return solutions from different parameters; some have no poles where waves vanish."""
    if not any(d.kind == "pair" for d in table.dispersions):
        return []
    solutions: dict[tuple[str, ...], tuple[tuple[str, Factored], ...]] = {}
    relations = [r for d in table.dispersions for r in _relations(ring, d)]
    for first in (None, *parameters):
        for order in (relations, relations[::-1]):
            solved = _solve_in_turn(ring, order, parameters, first)
            if len(solved) == len(relations):
                solutions.setdefault(tuple(name for name, _ in solved), solved)
        if len(solutions) > WAYS:
            break
    return list(solutions.values())


def _solve_in_turn(
    ring: Ring,
    relations: Sequence[tuple[Sequence[str], Factored]],
    parameters: Sequence[str],
    preferred: str | None = None,
) -> tuple[tuple[str, Factored], ...]:
    solved: list[tuple[str, Factored]] = []
    for wavenumbers, relation in relations:
        polynomial = _branch(_solved_for(relation, solved), wavenumbers)
        if polynomial is None:
            continue
        candidates: list[tuple[int, int, int, str, Factored]] = []
        # s comes last: it is everywhere, but better than nothing where a diffusivity enters squared.
        for name in (*parameters, LAPLACE):
            index = ring.index[name]
            if any(n == name for n, _ in solved) or degree_in(polynomial, index) != 1:
                continue
            terms = {tuple(map(int, m)): int(c) for m, c in polynomial.terms() if not m[index]}
            zero = ring.context.from_dict(terms)
            slope = (polynomial - zero) / ring.context.gen(index)
            if not zero.is_zero():
                formula = -Factored.polynomial(ring, zero) / Factored.polynomial(ring, slope)
                divisors = [f for _, earlier in solved for f, e in earlier.factors if e < 0]
                if not any(_substitute(ring, name, formula, f).is_zero for f in divisors):
                    rank = 2 if name == LAPLACE else int(name != preferred)
                    candidates.append((rank, len(zero) + len(slope), len(zero), name, formula))
        if candidates:
            *_, name, formula = min(candidates, key=lambda entry: entry[:3])
            solved.append((name, formula))
    return tuple(solved)


def _branch(value: Factored, wavenumbers: Sequence[str]) -> fmpz_mpoly | None:
    """Return the one irreducible factor that makes a relation true, ``None`` when there may be several.

    ``value`` is the relation with parameters expressed by wavenumbers. It may have factors without the
    wavenumbers of the relation, which are never zero: ``(1 + nu)*(...) = 0`` does not mean ``nu = -1``.
    """
    ring = value.ring
    waves = [ring.generator(w) for w in wavenumbers]
    factors = [
        piece
        for factor in value.numerator().factors
        for piece, _ in irreducible_factors(factor[0])[1]
        if piece not in waves and not ring.used_in([piece]).isdisjoint(wavenumbers)
    ]
    return factors[0] if len(factors) == 1 else None


def _solved_for(value: Factored, solved: Sequence[tuple[str, Factored]]) -> Factored:
    """Return a value with the parameters that wavenumbers determine expressed by them."""
    for name, formula in solved:
        value = value.map_factors(value.ring, partial(_substitute, value.ring, name, formula))
    return value


def _relations(ring: Ring, dispersion: Dispersion) -> list[tuple[Sequence[str], Factored]]:
    """Return what is zero by the definition of the wavenumbers, which stand beside it."""
    waves = [Factored.generator(ring, w) for w in dispersion.wavenumbers]
    c, relations = dispersion.characteristic, list[Factored]()
    match dispersion.kind:
        case "wave":
            relations = [waves[0] ** 2 + c[0]]
        case "bending":
            relations = [waves[0] ** 4 * 4 - c[0]]
        case "pair":
            relations = [waves[0] ** 2 + waves[1] ** 2 + c[2], (waves[0] * waves[1]) ** 2 - c[0]]
    return [(dispersion.wavenumbers, value) for value in relations]


def _substitute(ring: Ring, name: str, formula: Factored, factor: fmpz_mpoly) -> Factored:
    """Return a polynomial with a rational function in place of a generator."""
    index = ring.index[name]
    if not degree_in(factor, index):
        return Factored.polynomial(ring, factor)
    highest = degree_in(factor, index)
    below = formula.denominator()
    # The factors are many terms each: powers are made once, and multiplied by the engine.
    above_powers, below_powers = (
        list(accumulate(repeat(value.expand(), highest), mul, initial=ring.constant(1)))
        for value in (formula * below, below)
    )
    total = ring.constant(0)
    for power, part in by_powers(ring, factor, index).items():
        size = len(part) * len(above_powers[power]) * len(below_powers[highest - power])
        if ring.bytes_of(size) > MEMORY_LIMIT:
            message = "the closed form is too large: its wavenumbers depend on too many symbols"
            hint = "leave out damping, foundations or lengths, or split the model"
            raise BudgetError(Diagnostic("SF502", message, None, hint))
        total = total + part * above_powers[power] * below_powers[highest - power]
    return Factored.polynomial(ring, total) / below**highest


@dataclass(frozen=True, eq=False)
class _Restorer:
    """The way back from exponentials to kernels."""

    source: Exponentials  # the coordinates
    target: Exponentials  # the same, or with some angles halved
    doubled: tuple[int, ...]  # which angles of ``source`` are twice those of ``target``

    def odd_angles(self, value: Factored) -> set[int]:
        """Return the angles in which numerator or denominator are odd even as a whole."""
        odd: set[int] = set()
        for _, parity in self._grouped(value):
            odd |= {i for i, p in enumerate(parity) if p}
        return odd

    def _grouped(self, value: Factored) -> list[tuple[Factored, tuple[int, ...]]]:
        """Return the factors, those of odd degree multiplied together, with what parity is left."""
        groups: list[tuple[Factored, tuple[int, ...]]] = []
        hyperbolic = [a for a in self.source.angles if a.kind == "hyperbolic"]
        exponentials = [self.source.coordinates.generator(a.coordinates[0]) for a in hyperbolic]
        for side in (1, -1):
            odd = Factored.number(value.ring, 1)
            total = [0] * len(self.source.angles)
            for factor, exponent in value.factors:
                if exponent * side < 0 or factor in exponentials:
                    continue
                parity = self.source.parity(factor)
                if any(parity):
                    odd = odd * Factored(value.ring, Fraction(1), ((factor, abs(exponent)),))
                    total = [(t + p * abs(exponent)) % 2 for t, p in zip(total, parity, strict=True)]
                else:
                    groups.append((Factored(value.ring, Fraction(1), ((factor, exponent),)), parity))
            if not odd.is_one:
                groups.append((Factored(value.ring, Fraction(1), ((odd.expand(), side),)), tuple(total)))
        return groups

    def __call__(self, value: Factored) -> Factored:
        """Return the value in kernels; powers of exponentials balance out."""
        result = Factored.number(self.target.ring, value.unit)
        for group, _ in self._grouped(value):
            ((polynomial, exponent),) = group.factors
            if self.doubled:
                polynomial = self._double(polynomial)
            restored, _ = self.target.restore(polynomial)
            result = result * restored**exponent
        return result

    def _double(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        ring = self.source.coordinates
        images = dict[str, "fmpz_mpoly"]()
        for i in self.doubled:
            angle = self.source.angles[i]
            if angle.kind == "hyperbolic":
                e = ring.generator(angle.coordinates[0])
                images[angle.coordinates[0]] = e * e
            else:
                t, u = (ring.generator(c) for c in angle.coordinates)
                images[angle.coordinates[0]] = 2 * t * u
                images[angle.coordinates[1]] = u * u - t * t
        return ring.replaced(polynomial, images)
