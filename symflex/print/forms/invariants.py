"""Krylov-Duncan functions: the entire functions of s that kernels combine to.

The solution of ``z' = A z`` is ``exp(lambda x) = K_0 + lambda K_1 + ... + lambda^(n-1) K_(n-1)`` for every
root lambda of the characteristic polynomial. A polynomial in kernels that permuting the roots leaves as it is
becomes a polynomial in the K when each exponential is written in this way: nothing is divided, no system is
solved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import Dispersion, Factored, KernelTable, Ring, by_powers, degree_in
from symflex.algebra.exponential_sum import power, spread, times
from symflex.algebra.normal_form import NormalForm, with_image
from symflex.print.forms.notation import Angle, angles_of, coefficient_name
from symflex.transfer.expansion import compose_rational

if TYPE_CHECKING:
    Groups = Sequence[tuple[int, tuple[Angle, ...]]]  # angles of one dispersion, by their argument's number
    Step = tuple[fmpz_mpoly, Factored] | None
    """A polynomial with some kernels written in the K, and what it is to be multiplied by."""

IMAGINARY = "j[]"
ORDERS = {"bending": 4, "pair": 4, "wave": 2}
Laurent = dict[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True, eq=False)
class Invariants:
    """The change from kernels to Krylov-Duncan functions, for one table."""

    source: Ring  # of the kernels
    table: KernelTable  # its kernels, none of them of a dispersion without a formula for its wavenumbers

    @cached_property
    def angles(self) -> tuple[tuple[Angle, ...], ...]:
        """The angles by argument: those of both wavenumbers of a pair stand together."""
        groups: dict[tuple[Dispersion, Factored], list[Angle]] = {}
        for angle in angles_of(self.table):
            groups.setdefault((angle.dispersion, angle.length), []).append(angle)
        return tuple(tuple(group) for group in groups.values())

    @cached_property
    def ring(self) -> Ring:
        """The source's generators, two coefficients per pair, the K, and the imaginary unit."""
        families = [
            krylov_name(i, order)
            for i, g in enumerate(self.angles)
            for order in range(ORDERS[g[0].dispersion.kind])
        ]
        coefficients = [
            coefficient_name(i, k)
            for i, d in enumerate(self.table.dispersions)
            if d.kind == "pair"
            for k in (0, 2)
        ]
        return Ring((*self.source.names, *coefficients, *families, IMAGINARY))

    def embed(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return a polynomial over the source as one over the ring."""
        return self.ring.taken_over(polynomial)

    def convert(self, value: Factored) -> Factored | None:
        """Return a quotient in Krylov-Duncan functions, ``None`` when it needs arguments half as long."""
        kernels = [self.source.index[k.generator] for k in self.table.kernels if k.wavenumber]
        waves = [self.source.index[name] for name in self.table.wavenumbers]

        def one(factor: fmpz_mpoly) -> Factored | None:
            degrees = factor.degrees()
            # A sum of powers of wavenumbers need not be invariant either.
            moving = kernels if len(factor) == 1 else [*kernels, *waves]
            if not any(int(degrees[i]) for i in moving):
                return Factored.polynomial(self.ring, self.embed(factor))
            return self._invariant(factor)

        result = factor_by_factor(value, self.ring, one, self._whole)
        return None if result is None else self._without_wavenumbers(result)

    def _whole(self, side: fmpz_mpoly) -> Factored | None:
        """Return a numerator or denominator in the K as :meth:`_invariant` does, in all ways there are."""
        # Factors in normal form have a product that need not be: sin(q)*sin(q) is one.
        plain = NormalForm(self.source, self.table).without_odd_squares
        # What is in lowest terms may lack a wavenumber: lambda_1*S_2 - lambda_2*S_1 is odd, and 1/lambda_1 of
        # it is neither odd nor even.
        pairs = [w for d in self.table.dispersions if d.kind == "pair" for w in d.wavenumbers]
        tries = (
            (change(side * self.source.generator(w)) if w else change(side), w)
            for w in ("", *pairs)
            for change in (lambda f: f, plain)
        )
        for tried, w in tries:
            invariant = self._invariant(tried)
            if invariant is not None:
                return invariant / Factored.generator(self.ring, w) if w else invariant
        return None

    def _invariant(self, polynomial: fmpz_mpoly) -> Factored | None:
        """Return a polynomial in the K, times powers of wavenumbers; ``None`` if it has no such form."""
        work: fmpz_mpoly = self.embed(polynomial)
        scale = Factored.number(self.ring, 1)
        for number, dispersion in enumerate(self.table.dispersions):
            groups = [(i, g) for i, g in enumerate(self.angles) if g[0].dispersion is dispersion]
            if not groups:
                continue
            step = {"bending": self._bending, "wave": self._wave, "pair": self._pair}[dispersion.kind]
            stepped = step(work, number, dispersion, groups)
            if stepped is None:
                return None
            work, factor = stepped
            scale = scale * factor
        return Factored.polynomial(self.ring, work) * scale

    def _k(self, i: int, order: int) -> fmpz_mpoly:
        return self.ring.generator(krylov_name(i, order))

    def _wave(self, work: fmpz_mpoly, number: int, dispersion: Dispersion, groups: Groups) -> Step:
        """Write ``cosh = K_0``, ``sinh = gamma K_1``."""
        del number
        gamma = self.ring.generator(dispersion.wavenumbers[0])
        images: dict[str, fmpz_mpoly] = {}
        for i, (angle,) in groups:
            images |= {angle.kernels["cosh"]: self._k(i, 0), angle.kernels["sinh"]: gamma * self._k(i, 1)}
        work = self.ring.replaced(work, images)
        return self._even(work, dispersion.wavenumbers[0])

    def _even(self, work: fmpz_mpoly, wavenumber: str) -> Step:
        """Return a polynomial even in a wavenumber, and the wavenumber if it had to be taken out."""
        index = self.ring.index[wavenumber]
        parities = {int(m[index]) % 2 for m in work.monoms()}
        if len(parities) > 1:
            return None
        one = Factored.number(self.ring, 1)
        if parities == {1}:
            return work / self.ring.generator(wavenumber), Factored.generator(self.ring, wavenumber)
        return work, one

    def _pair(self, work: fmpz_mpoly, number: int, dispersion: Dispersion, groups: Groups) -> Step:
        """Write ``cosh = K_0 + lambda^2 K_2``, ``sinh = lambda K_1 + lambda^3 K_3`` for both wavenumbers."""
        images: dict[str, fmpz_mpoly] = {}
        for i, group in groups:
            for angle in group:
                w = self.ring.generator(angle.wavenumber)
                images[angle.kernels["cosh"]] = self._k(i, 0) + w**2 * self._k(i, 2)
                images[angle.kernels["sinh"]] = w * self._k(i, 1) + w**3 * self._k(i, 3)
        work = self.ring.replaced(work, images)
        scale = Factored.number(self.ring, 1)
        for name in dispersion.wavenumbers:
            even = self._even(work, name)
            if even is None:
                return None
            work, taken = even
            scale = scale * taken
        plain, square = self._symmetric(work, number, dispersion)
        c2 = self.ring.generator(coefficient_name(number, 2))
        if self._vanishes(square):
            return plain, scale
        # An odd one under exchange is g*(lambda_1^2 - lambda_2^2) = -c_2*g - 2*g*lambda_2^2.
        if not self._vanishes(2 * plain - c2 * square):
            return None
        x, y = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
        return square, scale * (x**2 - y**2) / -2

    def _symmetric(
        self, work: fmpz_mpoly, number: int, dispersion: Dispersion
    ) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return f and g of ``f + g*lambda_2^2``, by ``lambda_1^2 + lambda_2^2 = -c_2``."""
        ring = self.ring
        first, second = (ring.index[w] for w in dispersion.wavenumbers)
        y = ring.generator(dispersion.wavenumbers[1])
        c0, c2 = (ring.generator(coefficient_name(number, k)) for k in (0, 2))
        square, fourth = (Factored.polynomial(ring, f) for f in (-c2 - y * y, -c2 * y * y - c0))
        work, _ = with_image(ring, work, first, square, 2)
        while degree_in(work, second) >= dispersion.order:
            work, _ = with_image(ring, work, second, fourth, dispersion.order)
        parts = by_powers(ring, work, second)
        zero = ring.constant(0)
        return parts.get(0, zero), parts.get(2, zero)

    def _vanishes(self, work: fmpz_mpoly) -> bool:
        """Tell whether a polynomial is zero when the coefficients of pairs are what they are."""
        if work.is_zero():
            return True
        images: list[Factored | None] = [Factored.generator(self.ring, n) for n in self.ring.names]
        for i, d in enumerate(self.table.dispersions):
            if d.kind == "pair":
                for k in (0, 2):
                    images[self.ring.index[coefficient_name(i, k)]] = d.characteristic[k].over(self.ring)
        return compose_rational(self.ring, work, images).is_zero

    def _bending(self, work: fmpz_mpoly, number: int, dispersion: Dispersion, groups: Groups) -> Step:
        """Write ``exp(mu x (+-1 +-j))`` as ``K_0 + lambda K_1 + lambda^2 K_2 + lambda^3 K_3``."""
        del number
        (name,) = dispersion.wavenumbers
        mu = self.ring.generator(name)
        power = self._character(work, name, groups)
        if power is None:
            return None
        work = work * mu**power
        scale = Factored.generator(self.ring, name) ** -power
        for i, (angle,) in groups:
            opened = self._opened(work, i, angle, mu)
            if opened is None:
                return None
            work, halves = opened
            scale = scale / halves
        index = self.ring.index[name]
        assert not any(int(m[index]) % 4 for m in work.monoms())
        return work, scale

    def _character(self, work: fmpz_mpoly, name: str, groups: Groups) -> int | None:
        """Return the power of mu that makes a polynomial invariant under ``mu -> j mu``."""
        j = self.ring.generator(IMAGINARY)
        images = {name: j * self.ring.generator(name)}
        for _, (angle,) in groups:
            k = {f: self.ring.generator(g) for f, g in angle.kernels.items()}
            images |= {
                angle.kernels["cosh"]: k["cos"],
                angle.kernels["sinh"]: j * k["sin"],
                angle.kernels["cos"]: k["cosh"],
                angle.kernels["sin"]: j * k["sinh"],
            }
        turned = real_powers(self.ring, self.ring.replaced(work, images))
        return next((n for n in range(4) if real_powers(self.ring, turned * j**n) == work), None)

    def _opened(
        self, work: fmpz_mpoly, i: int, angle: Angle, mu: fmpz_mpoly
    ) -> tuple[fmpz_mpoly, int] | None:
        """Replace the kernels of one angle; return also the power of two that was multiplied in."""
        coefficients, highest = in_exponentials(self.ring, work, angle)
        j = self.ring.generator(IMAGINARY)
        powers = _Powers(self, [self._k(i, order) for order in range(4)], mu, j)
        total = self.ring.constant(0)
        for (a, b), part in coefficients.items():
            if part.is_zero():
                continue
            if (a + b) % 2:
                return None
            total = total + part * powers.product((a + b) // 2, (a - b) // 2)
        return real_powers(self.ring, total), 2**highest

    def _without_wavenumbers(self, value: Factored) -> Factored | None:
        """Return a value with pairs of wavenumbers in their coefficients; ``None`` if odd powers are left."""
        for number, d in enumerate(self.table.dispersions):
            if d.kind != "pair":
                continue
            x, y = (Factored.generator(self.ring, w) for w in d.wavenumbers)
            c0, c2 = (Factored.generator(self.ring, coefficient_name(number, k)) for k in (0, 2))
            exponents = {str(f): e for f, e in value.factors}
            power = exponents.get(str(x.factors[0][0]), 0)
            value = value / (x * y) ** power * c0 ** (power // 2)
            difference = x**2 - y**2
            meeting = exponents.get(str(difference.factors[0][0]), 0)
            if power % 2 or meeting % 2:
                return None
            value = value / difference**meeting * (c2**2 - c0 * 4) ** (meeting // 2)
        return value

    def halved(self) -> tuple[Invariants, Mapping[str, fmpz_mpoly]]:
        """Return the same with bending arguments half as long, and the kernels in terms of the new ones."""
        lengths = {a.length: a.length / 2 for g in self.angles for a in g if a.dispersion.kind == "bending"}
        table = KernelTable(
            self.table.dispersions,
            tuple(
                replace(k, length=lengths[k.length]) if k.wavenumber and k.dispersion.kind == "bending" else k
                for k in self.table.kernels
            ),
        )
        images: dict[str, fmpz_mpoly] = {}
        for group in self.angles:
            for angle in group:
                if angle.dispersion.kind == "bending":
                    k = {f: self.source.generator(g) for f, g in angle.kernels.items()}
                    images[angle.kernels["cosh"]] = 2 * k["cosh"] ** 2 - 1
                    images[angle.kernels["sinh"]] = 2 * k["sinh"] * k["cosh"]
                    images[angle.kernels["cos"]] = 2 * k["cos"] ** 2 - 1
                    images[angle.kernels["sin"]] = 2 * k["sin"] * k["cos"]
        return Invariants(self.source, table), images


def factor_by_factor(
    value: Factored,
    ring: Ring,
    one: Callable[[fmpz_mpoly], Factored | None],
    whole: Callable[[fmpz_mpoly], Factored | None],
) -> Factored | None:
    """Return a quotient over another ring, factor by factor or as sides; ``None`` if it has no image."""
    result = Factored.number(ring, value.unit)
    for side in (1, -1):
        rest = Factored.number(value.ring, 1)
        for factor, exponent in value.factors:
            if exponent * side < 0:
                continue
            if (converted := one(factor)) is not None:
                result = result * converted**exponent
            else:
                rest = rest * Factored(value.ring, Fraction(1), ((factor, abs(exponent)),))
        if not rest.is_one:
            converted = whole(rest.expand())
            if converted is None:
                return None
            result = result * converted**side
    return result


def in_krylov_functions(
    source: Ring, table: KernelTable, value: Factored
) -> tuple[Invariants, Factored] | None:
    """Return the change, and a quotient in Krylov-Duncan functions, of half the lengths if it must be."""
    change = Invariants(source, table)
    converted = change.convert(value)
    if converted is not None:
        return change, converted
    change, images = change.halved()
    normal = NormalForm(source, table)
    converted = change.convert(value.map_factors(source, lambda f: normal.reduce(source.replaced(f, images))))
    return None if converted is None else (change, converted)


def krylov_name(group: int, order: int) -> str:
    """Return the generator of ``K_order`` of one argument."""
    return f"K{order}[{group}]"


def real_powers(ring: Ring, work: fmpz_mpoly) -> fmpz_mpoly:
    """Use ``j^2 = -1``."""
    return with_image(ring, work, ring.index[IMAGINARY], Factored.number(ring, -1), 2)[0]


def in_exponentials(
    ring: Ring, work: fmpz_mpoly, angle: Angle
) -> tuple[dict[tuple[int, int], fmpz_mpoly], int]:
    """Return 2^n times a polynomial in kernels of one angle as the coefficients of ``E^a z^b``, and n."""
    places = [ring.index.get(angle.kernels.get(f, "")) for f in ("cosh", "sinh", "cos", "sin")]
    parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
    for monomial, coefficient in work.terms():
        m = [int(e) for e in monomial]
        key = tuple(0 if p is None else m[p] for p in places)
        for p in places:
            if p is not None:
                m[p] = 0
        parts.setdefault(key, {})[tuple(m)] = int(coefficient)
    highest = max(sum(key) for key in parts)
    j = ring.generator(IMAGINARY)
    coefficients: dict[tuple[int, int], fmpz_mpoly] = {}
    for key, terms in parts.items():
        part = ring.context.from_dict(terms) * 2 ** (highest - sum(key))
        for (a, b), (re, im) in laurent(*key).items():
            term = part * (re + im * j)
            coefficients[a, b] = coefficients[a, b] + term if (a, b) in coefficients else term
    return coefficients, highest


def laurent(cosh: int, sinh: int, cos: int, sin: int) -> Laurent:
    """Return ``(2 cosh)^a (2 sinh)^b (2 cos)^c (2 sin)^d`` as a sum of ``E^i z^k``, coefficients as pairs."""
    hyperbolic = spread(cosh, sinh)
    circular = spread(cos, sin)
    # 2 sin q = -j (z - 1/z)
    unit = power((0, -1), sin)
    return {(a, b): times((x * y, 0), unit) for a, x in hyperbolic.items() for b, y in circular.items()}


class _Powers:
    """Powers of ``u = exp((1 + j) q)`` and ``v = exp((1 - j) q)``, each used once for every exponent."""

    def __init__(self, change: Invariants, k: Sequence[fmpz_mpoly], mu: fmpz_mpoly, j: fmpz_mpoly) -> None:
        self._change, self._k, self._mu, self._j = change, k, mu, j
        self._known: dict[tuple[int, int], fmpz_mpoly] = {}

    def product(self, a: int, b: int) -> fmpz_mpoly:
        """Return ``u^a v^b``."""
        return self._power(1, a) * self._power(-1, b)

    def _power(self, conjugate: int, n: int) -> fmpz_mpoly:
        if (conjugate, n) not in self._known:
            sign = 1 if n > 0 else -1
            j = conjugate * self._j
            mu = sign * self._mu
            first = self._k[0] + (1 + j) * mu * self._k[1]
            base = first + 2 * j * mu**2 * self._k[2] + (2 * j - 2) * mu**3 * self._k[3]
            self._known[conjugate, n] = real_powers(self._change.ring, base ** abs(n))
        return self._known[conjugate, n]
