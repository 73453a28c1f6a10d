"""Sums of exponentials on the imaginary axis of a lossless system: real functions of the angular frequency.

There every wavenumber is real, imaginary, or on the diagonal, and a transfer function is real up to a power
of j.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import gcd, lcm
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.algebra.exponential_sum import power, times

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Dispersion, KernelTable, Ring
    from symflex.codegen.program.exponents import Family, KernelSum, Term

Gaussian = tuple[Fraction, Fraction]
ONE: Gaussian = (Fraction(1), Fraction(0))
TURN: Gaussian = (Fraction(0), Fraction(1))

RealTerm = tuple[tuple[tuple[Fraction, Fraction], ...], int]
"""As :data:`symflex.codegen.program.exponents.Term`, with the magnitudes of wavenumbers times lengths."""

RealKey = tuple[RealTerm, ...]


@dataclass(frozen=True, eq=False)
class RealSum:
    """``j^turn * waves * sum(coefficient * product of terms)``, everything but the turn real."""

    # Coefficients in the angular frequency, which takes the place of s, and magnitudes of wavenumbers.
    terms: Mapping[RealKey, fmpz_mpoly]
    waves: Factored  # a product of powers of such magnitudes, with a rational number in front
    turn: int  # the power of j, from 0 to 3


@dataclass(frozen=True, eq=False)
class RealAxis:
    """Turns functions of ``s = j omega`` into real ones."""

    ring: Ring  # with wavenumbers and kernels
    table: KernelTable  # over the same ring
    positive: tuple[str, ...]  # parameters known to be positive
    # Of a dispersion, whether its ``c_0`` is taken to be negative.
    signs: Mapping[Dispersion, bool] = field(default_factory=dict)

    @property
    def is_real(self) -> bool:
        """True when all dispersions are waves or bending without loss."""
        for d in self.table.dispersions:
            if d.kind not in ("wave", "bending") or not d.shift.is_zero:
                return False
            found = self.real(d.characteristic[0])
            if found is None or found[1] % 2:
                return False
        return True

    def where(self, signs: Mapping[Dispersion, bool]) -> RealAxis:
        """Return the same for given signs of ``c_0``."""
        return replace(self, signs=signs)

    def sign(self, dispersion: Dispersion) -> bool | None:
        """Return whether ``c_0`` is negative, ``None`` when it depends on values."""
        if dispersion in self.signs:
            return self.signs[dispersion]
        value = self.coefficient(dispersion)
        known = {self.ring.index[n] for n in (*self.positive, "pi")} | {0}
        for factor, _ in value.factors:
            for monomial, coefficient in factor.terms():
                if int(coefficient) < 0 or any(e and i not in known for i, e in enumerate(monomial)):
                    return None
        return bool(value.unit < 0)

    def coefficient(self, dispersion: Dispersion) -> Factored:
        """Return ``c_0``, with the angular frequency in place of s."""
        found = self.real(dispersion.characteristic[0])
        if found is None:
            message = f"{dispersion.name} has losses"
            raise ValueError(message)
        value, turn = found
        return -value if turn % 4 else value

    def real(self, value: Factored) -> tuple[Factored, int] | None:
        """Return a value without wavenumbers over a power of j, and the power; ``None`` if it is complex."""
        result, turn = Factored.number(self.ring, value.unit), 0
        for factor, exponent in value.factors:
            terms: dict[tuple[int, ...], int] = {}
            degrees = [int(m[0]) for m in factor.monoms()]
            lowest = min(degrees)
            if any((d - lowest) % 2 for d in degrees):
                return None
            for monomial, coefficient in factor.terms():
                sign = -1 if (int(monomial[0]) - lowest) % 4 else 1
                terms[tuple(int(e) for e in monomial)] = int(coefficient) * sign
            real = Factored.polynomial(self.ring, self.ring.context.from_dict(terms))
            result = result * real**exponent
            turn += lowest * exponent
        return result, turn % 4

    def real_sum(self, terms: KernelSum, waves: Factored, families: Sequence[Family]) -> RealSum | None:
        """Return a sum, times a product of powers of wavenumbers, in real terms.

        ``None`` when it is not real up to a power of j.
        """
        powers = {}
        for factor, exponent in waves.factors:
            if len(factor) > 1:
                return None
            powers[str(factor)] = exponent
        places = [
            (self.ring.index[n], self._direction(d), powers.get(str(self.ring.generator(n)), 0))
            for d in self.table.dispersions
            for n in d.wavenumbers[:1]
        ]
        collected: dict[RealKey, dict[tuple[int, ...], Gaussian]] = {}
        for key, polynomial in terms.items():
            images = [self._image(t, f.dispersion) for t, f in zip(key, families, strict=True)]
            for monomial, coefficient in polynomial.terms():
                exponents = tuple(int(e) for e in monomial)
                number = times((Fraction(int(coefficient)), Fraction(0)), power(TURN, exponents[0] % 4))
                for i, direction, extra in places:
                    number = times(number, _power(direction, exponents[i] + extra))
                products: list[tuple[RealKey, Gaussian]] = [((), number)]
                for image in images:
                    products = [((*k, t), times(x, y)) for k, x in products for t, y in image]
                for k, x in products:
                    own = collected.setdefault(k, {})
                    have = own.get(exponents, (Fraction(0), Fraction(0)))
                    own[exponents] = (have[0] + x[0], have[1] + x[1])
        return self._gathered(collected, waves)

    def _gathered(
        self, collected: Mapping[RealKey, Mapping[tuple[int, ...], Gaussian]], waves: Factored
    ) -> RealSum | None:
        is_real = all(not y for own in collected.values() for _, y in own.values())
        is_imaginary = all(not x for own in collected.values() for x, _ in own.values())
        if not (is_real or is_imaginary):
            return None
        part = 0 if is_real else 1
        numbers = [x[part] for own in collected.values() for x in own.values() if x[part]]
        scale = Fraction(lcm(*(x.denominator for x in numbers)), gcd(*(x.numerator for x in numbers)))
        terms = {}
        for key, own in collected.items():
            whole = {m: int(x[part] * scale) for m, x in own.items() if x[part]}
            if whole:
                terms[key] = self.ring.context.from_dict(whole)
        return RealSum(terms, waves / scale, part)

    def _direction(self, dispersion: Dispersion) -> Gaussian:
        """Return the wavenumber over its real magnitude."""
        if dispersion.kind == "bending":
            return (Fraction(1, 2), Fraction(1, 2)) if self.sign(dispersion) else ONE
        return ONE if self.sign(dispersion) else TURN

    def _image(self, term: Term, dispersion: Dispersion) -> list[tuple[RealTerm, Gaussian]]:
        """Return a term in functions of the real magnitude."""
        pairs = tuple((Fraction(a), Fraction(b)) for a, b in term[0])
        direction = self._direction(dispersion)
        if direction == ONE:
            return [((pairs, term[1]), ONE)]
        # A cosine is half the sum of conjugate exponentials, a sine -j/2 times their difference.
        half = times((Fraction(1, 2), Fraction(0)), _power(TURN, -term[1]))
        parts = [(1, half), (-1, _conjugate(half))] if any(b for _, b in pairs) else [(1, ONE)]
        return [
            item
            for sign, number in parts
            for item in _oscillation(tuple(times((a, sign * b), direction) for a, b in pairs), number)
        ]


def _oscillation(
    pairs: tuple[tuple[Fraction, Fraction], ...], number: Gaussian
) -> list[tuple[RealTerm, Gaussian]]:
    """Return ``number * exp(sum((a_i + j b_i) x_i))``."""
    first = next((b for _, b in pairs if b), Fraction(0))
    if not first:
        return [((pairs, 0), number)]
    sign = 1 if first > 0 else -1
    same = tuple((a, sign * b) for a, b in pairs)
    return [((same, 0), number), ((same, 1), times(number, (Fraction(0), Fraction(sign))))]


def _conjugate(value: Gaussian) -> Gaussian:
    return value[0], -value[1]


def _power(base: Gaussian, exponent: int) -> Gaussian:
    size = base[0] ** 2 + base[1] ** 2
    return power(base if exponent >= 0 else (base[0] / size, -base[1] / size), abs(exponent))
