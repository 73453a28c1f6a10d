"""Kernels as exponentials and half-angle sines: coordinates in which common factors can be found.

In ``E = exp(w x)``, ``t = sin(mu x/2)`` and ``u = cos(mu x/2)`` every polynomial in kernels is a polynomial
over the integers, homogeneous in t and u, up to a power of E; and polynomials have greatest common divisors.

Where ``cos^k`` and ``sin cos^k``, sums of ``cos(i x)`` and ``sin(i x)``, have multiples of n for every i, the
angle ``n x`` serves. Hyperbolic functions follow the same rules.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

from flint import fmpz_mpoly

from symflex.algebra.dispersion import Kernel, KernelTable
from symflex.algebra.exponential_sum import spread
from symflex.algebra.factored import Factored
from symflex.algebra.ring import Ring, coefficients_of


@dataclass(frozen=True, slots=True, eq=False)
class KernelPair:
    """A pair of kernels of one argument."""

    kind: Literal["hyperbolic", "circular"]  # ``hyperbolic`` or ``circular``
    even: Kernel  # even and odd: cosh and sinh, or cos and sin
    odd: Kernel
    coordinates: tuple[str, ...]  # ``(E,)``, or ``(t, u)``


@dataclass(frozen=True, eq=False)
class Exponentials:
    """The change of coordinates for one table."""

    ring: Ring  # with the table's kernels
    table: KernelTable  # wavenumbers and kernels

    @cached_property
    def angles(self) -> tuple[KernelPair, ...]:
        """The pairs of kernels."""
        pairs = []
        for even, odd in self.table.pairs:
            tail = even.generator.partition("[")[2]
            if even.function == "cosh":
                pairs.append(KernelPair("hyperbolic", even, odd, (f"E[{tail}",)))
            else:
                pairs.append(KernelPair("circular", even, odd, (f"t[{tail}", f"u[{tail}")))
        return tuple(pairs)

    @cached_property
    def _kept(self) -> tuple[str, ...]:
        replaced = {k.generator for a in self.angles for k in (a.even, a.odd)}
        return tuple(n for n in self.ring.names if n not in replaced)

    @cached_property
    def coordinates(self) -> Ring:
        """The ring with exponentials and half-angle functions in place of kernels."""
        return Ring((*self._kept, *(c for a in self.angles for c in a.coordinates)))

    @cached_property
    def _both(self) -> Ring:
        """The ring with kernels and coordinates."""
        return Ring((*self.ring.names, *(c for a in self.angles for c in a.coordinates)))

    def transform(self, polynomial: fmpz_mpoly) -> Factored:
        """Return a polynomial in kernels over the coordinates."""
        target = self.coordinates
        degrees = [int(d) for d in polynomial.degrees()]
        scale = Factored.number(target, 1)
        images: dict[str, fmpz_mpoly] = {}
        homogeneous: list[tuple[fmpz_mpoly, tuple[int, int], int]] = []
        for angle in self.angles:
            even, odd = self.ring.index[angle.even.generator], self.ring.index[angle.odd.generator]
            degree = 0
            if degrees[even] or degrees[odd]:
                degree = max(int(m[even]) + int(m[odd]) for m in polynomial.monoms())
            if angle.kind == "hyperbolic":
                e = target.generator(angle.coordinates[0])
                images[angle.even.generator] = e * e + 1
                images[angle.odd.generator] = e * e - 1
                homogeneous.append((2 * e, (even, odd), degree))
                scale = scale * (Factored.polynomial(target, 2 * e) ** -degree)
            else:
                t, u = (target.generator(c) for c in angle.coordinates)
                images[angle.even.generator] = u * u - t * t
                images[angle.odd.generator] = 2 * t * u
                homogeneous.append((t * t + u * u, (even, odd), degree))
        plain = [images[n] if n in images else target.generator(n) for n in self.ring.names]
        if not any(degree for _, _, degree in homogeneous):
            return Factored.polynomial(target, polynomial.compose(*plain))
        # The missing degree of every term is made up by cosh^2 - sinh^2 and cos^2 + sin^2, which are one.
        parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
        for monomial, coefficient in polynomial.terms():
            exponents = tuple(int(e) for e in monomial)
            missing = tuple(d - exponents[p[0]] - exponents[p[1]] for _, p, d in homogeneous)
            parts.setdefault(missing, {})[exponents] = int(coefficient)
        total = target.constant(0)
        for missing, terms in parts.items():
            part = self.ring.context.from_dict(terms).compose(*plain)
            for (one, _, _), power in zip(homogeneous, missing, strict=True):
                if power:
                    part = part * one**power
            total = total + part
        return Factored.polynomial(target, total) * scale

    def restore(self, polynomial: fmpz_mpoly) -> tuple[Factored, tuple[int, ...]]:
        """Return a polynomial, even in every angle, in kernels: f and n of ``f * prod(E^n)``."""
        source, both = self.coordinates, self._both
        center = [int(polynomial.degrees()[source.index[a.coordinates[0]]]) // 2 for a in self.angles]
        total = polynomial.compose(*(both.generator(n) for n in source.names), ctx=both.context)
        halves = 0
        # One angle after the other: terms take each other out before the next multiplies them.
        for angle, middle in zip(self.angles, center, strict=True):
            c, s = both.generator(angle.even.generator), both.generator(angle.odd.generator)
            parts = coefficients_of(both, total, [both.index[name] for name in angle.coordinates])
            total = both.constant(0)
            for powers, part in parts.items():
                if angle.kind == "hyperbolic":
                    n = powers[0] - middle
                    even, odd = _multiple(both, c, s, abs(n))
                    total = total + part * (even + odd if n >= 0 else even - odd)
                else:
                    a, b = powers
                    total = total + part * (1 - c) ** (a // 2) * (1 + c) ** (b // 2) * s ** (a % 2)
            if angle.kind == "circular":
                halves += sum(next(iter(parts))) // 2 if parts else 0
        own = [self.ring.generator(n) for n in self.ring.names]
        images = own + [self.ring.constant(0)] * (len(both.names) - len(own))  # no coordinate is left
        restored = Factored.polynomial(self.ring, total.compose(*images, ctx=self.ring.context))
        return restored * Fraction(1, 2**halves), tuple(
            n for n, a in zip(center, self.angles, strict=True) if a.kind == "hyperbolic"
        )

    def restore_halved(self, polynomial: fmpz_mpoly) -> tuple[fmpz_mpoly, tuple[int, ...]]:
        """Return one of any parity in kernels of half the length: f and n of ``f * prod(E^(n/2))``."""
        source = self.coordinates
        places = [tuple(source.index[c] for c in a.coordinates) for a in self.angles]
        monomials = polynomial.monoms()
        # From the lowest to the highest power of E, so that a bare power of E leaves nothing behind.
        highest = [
            sum(bound(int(m[place[0]]) for m in monomials) for bound in (min, max)) for place in places
        ]
        kept = [(self.ring.index[n], source.index[n]) for n in self._kept]
        total = self.ring.constant(0)
        powers: dict[tuple[int, int], fmpz_mpoly] = {}
        for monomial, coefficient in polynomial.terms():
            exponents = [0] * len(self.ring.names)
            for target, i in kept:
                exponents[target] = int(monomial[i])
            term = self.ring.context.from_dict({tuple(exponents): int(coefficient)})
            for number, (angle, place, n) in enumerate(zip(self.angles, places, highest, strict=True)):
                c, s = self.ring.generator(angle.even.generator), self.ring.generator(angle.odd.generator)
                if angle.kind == "hyperbolic":
                    k = 2 * int(monomial[place[0]]) - n
                    if (number, k) not in powers:
                        powers[number, k] = (c + s) ** k if k >= 0 else (c - s) ** -k
                    term = term * powers[number, k]
                else:
                    a, b = (int(monomial[i]) for i in place)
                    term = term * s**a * c**b
            total = total + term
        return total, tuple(n for n, a in zip(highest, self.angles, strict=True) if a.kind == "hyperbolic")

    def split(self, polynomial: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return a polynomial over the coordinates as one free of kernels times the rest."""
        kernels = {k.generator for k in self.table.kernels}
        # Kernels that are coordinates themselves stand last among the generators that are kept.
        free = sum(n not in kernels for n in self._kept)
        return split_content(self.coordinates, polynomial, free)

    def parity(self, polynomial: fmpz_mpoly) -> tuple[int, ...]:
        """Return per angle whether the degree is odd: then only half the angle's kernels can express it."""
        source = self.coordinates
        monomial = polynomial.monomial(0)
        degrees = polynomial.degrees()
        return tuple(
            int(degrees[source.index[a.coordinates[0]]]) % 2
            if a.kind == "hyperbolic"
            else sum(int(monomial[source.index[c]]) for c in a.coordinates) % 2
            for a in self.angles
        )

    def halved(self, kernels: Sequence[Kernel]) -> KernelTable:
        """Return the table with the lengths of the given kernels' angles divided by two."""
        lengths = {k.length: k.length / 2 for k in kernels}
        return KernelTable(
            self.table.dispersions,
            tuple(
                replace(k, length=lengths[k.length]) if k.length in lengths else k for k in self.table.kernels
            ),
        )


def split_content(ring: Ring, polynomial: fmpz_mpoly, free: int) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return a polynomial as one in the first so many generators times the rest."""
    content = ring.constant(0)
    for part in coefficients_of(ring, polynomial, range(free, len(ring.names))).values():
        content = content.gcd(part)
        if content.is_one():
            break
    return content, polynomial / content


def lift(ring: Ring, polynomial: fmpz_mpoly, angle: KernelPair, n: int) -> Factored | None:
    """Return a polynomial of kernels in normal form with those of n times the angle; ``None`` if not one."""
    even, odd = ring.index[angle.even.generator], ring.index[angle.odd.generator]
    parts = coefficients_of(ring, polynomial, (even, odd))
    highest = max((k + o for k, o in parts), default=0)
    zero = ring.constant(0)
    harmonics: dict[tuple[int, int], fmpz_mpoly] = {}
    for (k, o), coefficient in parts.items():
        if o > 1:
            return None
        part = coefficient * 2 ** (highest - k)
        # 2^k cos^k x, or 2^k sin x cos^k x: exponentials of opposite multiples make one cosine or sine.
        for i, weight in spread(k, o).items():
            if i > 0 or not o:
                harmonics[abs(i), o] = harmonics.get((abs(i), o), zero) + part * weight
    c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
    total = zero
    for (i, o), part in harmonics.items():
        if part.is_zero():
            continue
        if i % n:
            return None
        c_i, s_i = _multiple(ring, c, s, i // n)
        total = total + part * (s_i if o else c_i)
    return Factored.polynomial(ring, total) * Fraction(1, 2**highest)


def _multiple(ring: Ring, c: fmpz_mpoly, s: fmpz_mpoly, times: int) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return the even and the odd kernel of a multiple of the argument, in normal form."""
    even, over = ring.constant(1), ring.constant(0)
    for _ in range(times):
        # sinh^2 and -sin^2 are both this square less one.
        even, over = even * c + over * (c * c - 1), over * c + even
    return even, over * s
