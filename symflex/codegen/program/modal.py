"""From a transfer function whose exponents have no closed form to a program in pieces.

Input: a :class:`symflex.transfer.TransferFunction` whose kernels are fundamental functions and decays.
Output: a :class:`Piecewise` program. Where all exponents are small, numerator and denominator are power
series. Elsewhere they are sums of exponentials of the characteristic roots, from which what cancels is left
out; where two roots nearly meet, such sums are averaged over a circle around s.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from math import pi, prod
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.algebra.ring import by_powers
from symflex.budget import spend
from symflex.codegen.program.forge import Forge, straight
from symflex.codegen.program.nodes import CodePiece, Condition, Piecewise, RealNumber
from symflex.codegen.program.series import GeneralSeries
from symflex.codegen.program.site import Site
from symflex.errors import BudgetError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Dispersion
    from symflex.algebra.modal_sum import CharacteristicMode
    from symflex.codegen.program.nodes import Straight
    from symflex.transfer import TransferFunction

MODAL_REACHES = (10.0, 6.0, 4.0, 2.0)
"""Sizes of the largest exponent below which no exponentials are summed; which serves best is measured."""

SERIES_TERMS = 2000
"""Terms up to which such a series is written."""

APART = 0.5
"""Distance of two roots, times the longest length, below which means over a circle are taken."""

CIRCLE = 24
"""Points of a circle over which means are taken."""


def declared_length(tf: TransferFunction, length: Factored) -> float:
    """Return the declared value of a length; without values, of a model with every parameter 1."""
    known = {p.name: p.value for p in tf.parameters}
    point = []
    for name in length.ring.names:
        value = known.get(name)
        point.append(1.0 if value is None else float(value.rational) * pi**value.pi_power)
    result = float(length.unit)
    for factor, exponent in length.factors:
        total = 0.0
        for monomial, number in factor.terms():
            total += int(number) * prod(x ** int(e) for x, e in zip(point, monomial, strict=True))
        result *= total**exponent
    return result


def build_modal(tf: TransferFunction, reach: float) -> Piecewise:
    """Return the program for complex s.

    Kernels are fundamental functions, and decays at most. Up to ``reach``, a size of the largest exponent,
    series are used, or matrix exponentials where these have too many terms. Raises BudgetError: SF503 when
    the sums have too many exponentials.
    """
    return _ModalWorkshop(tf, reach).program()


def _is_double(law: Dispersion) -> bool:
    """Tell whether two characteristic roots are equal at every s, or do not move apart with s."""
    return law.has_double_root or not any(c.depends_on(LAPLACE) for c in law.characteristic)


@dataclass
class _ModalWorkshop:
    tf: TransferFunction
    reach: float

    def __post_init__(self) -> None:
        self.ring = self.tf.ratio.ring
        self.table = self.tf.kernels
        self.sums = self.tf.modal_sums
        kernels = [self.ring.index[k.generator] for k in self.table.kernels]
        one = Factored.number(self.ring, 1)
        self.plain = one * self.tf.num.unit / self.tf.den.unit
        self.halves = [one, one]
        for value, order in ((self.tf.num, (0, 1)), (self.tf.den, (1, 0))):
            bearing = value.filter(lambda f: any(degree_in(f, i) for i in kernels))
            for side, part in zip(order, (bearing.numerator(), bearing.denominator()), strict=True):
                self.halves[side] = self.halves[side] * part
            rest = value.filter(lambda f: not any(degree_in(f, i) for i in kernels))
            self.plain = self.plain * rest ** (-1 if order[0] else 1)

    @cached_property
    def longest(self) -> Mapping[Dispersion, Factored]:
        """The longest length of every dispersion with fundamental functions."""
        found: dict[Dispersion, list[Factored]] = {}
        for mode in self.sums.modes:
            if not mode.is_decay:
                found.setdefault(mode.dispersion, []).append(mode.length)
        size = partial(declared_length, self.tf)
        return {law: max(lengths, key=lambda x: abs(size(x))) for law, lengths in found.items()}

    @property
    def _laws(self) -> list[Dispersion]:
        return [d for d in self.table.dispersions if d in self.longest]

    def program(self) -> Piecewise:
        """Return the program."""
        forge = Forge()
        site = Site(forge, self.tf, ())
        if any(_is_double(law) for law in self._laws):
            # At every s some roots meet, and means over a circle would be of no use.
            return self._assembled(straight(forge, [forge.constant(1)]), (), (0,), (self._direct(),))
        laws = [law for law in self._laws if law.order > 1]
        tests = [(forge.item(self._roots(site, law), law.order), APART) for law in laws]
        code = [self._modal(is_mean=False), self._modal(is_mean=True)]
        pieces = [0, *[1] * (2 ** len(tests) - 1)]
        code.append(self._small())
        tests.append((self._size(site), 1.0))
        pieces += [2] * len(pieces)
        head = straight(forge, [x for x, _ in tests])
        conditions = tuple(
            Condition(node, limit, RealNumber(Fraction(1)))
            for node, (_, limit) in zip(head.values, tests, strict=False)
        )
        return self._assembled(head, conditions, tuple(pieces), tuple(code))

    def _assembled(
        self,
        head: Straight,
        conditions: tuple[Condition, ...],
        pieces: tuple[int, ...],
        code: tuple[CodePiece, ...],
    ) -> Piecewise:
        parameters = tuple(p.name for p in self.tf.parameters)
        return Piecewise(parameters, head, conditions, pieces, code, solves=True)

    # ----------------------------------------------------------------------------------- sums of exponentials

    def _roots(self, site: Site, law: Dispersion) -> int:
        """Return the roots of a dispersion times its longest length."""
        forge, x = site.forge, site.value(self.longest[law])
        n = law.order
        return forge.roots(
            [forge.multiply([forge.power(x, n - i), site.coefficient(law, i)]) for i in range(n)]
        )

    def _mode(self, site: Site, mode: CharacteristicMode) -> int:
        forge = site.forge
        if mode.is_decay:
            shift = forge.multiply([site.value(mode.length), site.value(mode.dispersion.shift)])
            return forge.mode_values(forge.roots([shift]), forge.constant(1))
        ratio = site.value(mode.length / self.longest[mode.dispersion])
        return forge.mode_values(self._roots(site, mode.dispersion), ratio)

    def _modal(self, *, is_mean: bool) -> CodePiece:
        forge = Forge()
        site = Site(forge, self.tf, ())
        modes = [self._mode(site, mode) for mode in self.sums.modes]
        values, growths = [], []
        for half in self.halves:
            factors, growth = [], []
            for factor, exponent in half.factors:
                value, logarithm = self._sum(site, modes, factor)
                factors.append(forge.power(value, exponent))
                growth.append(forge.multiply([forge.constant(exponent), logarithm]))
            values.append(forge.multiply(factors))
            growths.append(forge.add(growth))
        over = forge.apply("exp", forge.add([growths[0], forge.negate(growths[1])]))
        num = forge.multiply([site.value(self.plain.numerator()), values[0], over])
        den = forge.multiply([site.value(self.plain.denominator()), values[1]])
        if not is_mean:
            return CodePiece(straight(forge, [num, den]))
        sizes = [
            forge.apply("abs", forge.item(self._roots(site, law), i))
            for law in self._laws
            for i in range(law.order)
        ]
        radius = forge.divide(forge.apply("abs", forge.s), forge.add([forge.constant(2), *sizes]))
        radius = forge.add([radius, *self._step(site)])
        return CodePiece(straight(forge, [num, den, growths[1], radius]), CIRCLE)

    def _step(self, site: Site) -> list[int]:
        """Return about how far from s = 0 roots that meet there have moved apart, if that can be told.

        There some coefficient of a characteristic polynomial, with the longest length for a unit, has changed
        by as much as the largest of them at s = 0.
        """
        forge = site.forge
        found: list[int] = []
        for law in self._laws:
            x = site.value(self.longest[law])
            static, moving = [forge.constant(1)], []
            for i, c in enumerate(law.characteristic):
                if c.is_zero:
                    continue
                above, below = (by_powers(self.ring, v.expand(), 0) for v in (c.numerator(), c.denominator()))
                if 0 not in below:
                    return []
                at_rest = Factored.polynomial(self.ring, below[0])
                unit = forge.power(x, law.order - i)
                for power, part in above.items():
                    value = site.value(Factored.polynomial(self.ring, part) / at_rest)
                    size = forge.apply("abs", forge.multiply([unit, value]))
                    if power:
                        moving.append((power, size))
                    else:
                        static.append(size)
                for power, part in below.items():
                    if power:
                        share = site.value(Factored.polynomial(self.ring, part) / at_rest)
                        found.append(self._root(forge, forge.apply("abs", share), power))
            largest = forge.add(static)
            for power, size in moving:
                found.append(self._root(forge, forge.divide(size, largest), power))
        return [forge.divide(forge.constant(1), forge.add(found))] if found else []

    @staticmethod
    def _root(forge: Forge, value: int, power: int) -> int:
        """Return about the root of a power."""
        for _ in range((power - 1).bit_length()):
            value = forge.apply("sqrt", value)
        return value

    def _sum(self, site: Site, modes: Sequence[int], factor: fmpz_mpoly) -> tuple[int, int]:
        """Return a factor over its largest exponential, and the logarithm of that."""
        forge, made = site.forge, self.sums.of(factor)
        powers: dict[int, list[int]] = {}
        for frame in made.frames:
            for orders, i in frame.terms:
                # The roots are scaled: h^(k) is L^(n - 1 - k) times what they give.
                powers[i] = [
                    forge.power(site.value(self.longest[mode.dispersion]), mode.roots - 1 - order)
                    for mode, order in zip((self.sums.modes[m] for m in frame.slots), orders, strict=True)
                    if not mode.is_decay
                ]
        coefficients = [
            forge.multiply([*powers.get(i, []), site.polynomial(c)]) for i, c in enumerate(made.coefficients)
        ]
        frames = tuple((f.slots, f.terms, f.keys) for f in made.frames)
        return forge.modal_value(modes, coefficients, frames)

    # ------------------------------------------------------------------------------------ small arguments

    def _small(self) -> CodePiece:
        """Return numerator and denominator as power series in all lengths together, where that is short."""
        series = GeneralSeries(self.ring, self.table)
        try:
            halves = [series.coefficients(half.expand(), self.reach) for half in self.halves]
        except BudgetError:
            spend()
            return self._direct()
        count = sum(len(f) for half in halves for value in half for f, _ in value.factors)
        return self._series_piece(halves) if count <= SERIES_TERMS and all(halves) else self._direct()

    def _direct(self) -> CodePiece:
        """Return numerator and denominator from the fundamental functions themselves."""
        forge = Forge()
        site = Site(forge, self.tf, ())
        num, den = (site.value(half) for half in self.halves)
        num = forge.multiply([site.value(self.plain.numerator()), num])
        den = forge.multiply([site.value(self.plain.denominator()), den])
        return CodePiece(straight(forge, [num, den]))

    def _series_piece(self, halves: Sequence[Sequence[Factored]]) -> CodePiece:
        forge = Forge()
        site = Site(forge, self.tf, ())
        gain, values = self.plain, []
        for half, sign in zip(halves, (1, -1), strict=True):
            s = self.ring.generator(LAPLACE)
            taken = Factored.generator(self.ring, LAPLACE) ** min(value.exponent_of(s) for value in half)
            gain = gain * taken**sign
            values.append(forge.add([site.value(value / taken) for value in reversed(half)]))
        num = forge.multiply([site.value(gain.numerator()), values[0]])
        den = forge.multiply([site.value(gain.denominator()), values[1]])
        return CodePiece(straight(forge, [num, den]))

    def _size(self, site: Site) -> int:
        """Return what is less than one where all exponents times lengths, together, are within reach.

        Where ``sum(abs(c_i) r^i) < r^n``, every root of ``x^n + ... + c_0`` is less than r in size.
        """
        forge = site.forge
        reaches: dict[tuple[Dispersion, bool], list[int]] = {}
        for mode, degree in zip(self.sums.modes, self._degrees(), strict=True):
            if degree:
                part = [forge.constant(degree / Fraction(self.reach)), site.value(mode.length)]
                reaches.setdefault((mode.dispersion, mode.is_decay), []).append(
                    forge.apply("abs", forge.multiply(part))
                )
        parts: list[int] = []
        for (dispersion, is_decay), own in reaches.items():
            scale = forge.add(own)
            if is_decay:
                parts.append(forge.apply("abs", forge.multiply([scale, site.value(dispersion.shift)])))
                continue
            for i, c in enumerate(dispersion.characteristic):
                if not c.is_zero:
                    term = forge.multiply([forge.power(scale, dispersion.order - i), site.value(c)])
                    parts.append(forge.apply("abs", term))
        return forge.add(parts)

    def _degrees(self) -> list[int]:
        """Return the largest number of kernels of every mode in any product."""
        positions: list[list[int]] = [[] for _ in self.sums.modes]
        for position, mode, _ in self.sums.kernels:
            positions[mode].append(position)
        found = []
        for own in positions:
            of_halves = (
                sum(e * max(sum(int(m[i]) for i in own) for m in f.monoms()) for f, e in half.factors)
                for half in self.halves
            )
            found.append(max(of_halves))
        return found
