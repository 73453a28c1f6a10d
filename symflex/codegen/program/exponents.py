"""Polynomials in kernels as programs compute them: sums of real exponentials times cosines and sines.

    2 cosh(q) sin(q)  =  e^q sin(q) + e^(-q) sin(q)

Input: a polynomial over the ring of kernels.
Output: per product of terms ``exp(sum(a_i q_i)) cos(sum(b_i q_i))``, or the sine, one for every wavenumber, a
polynomial in s, the parameters and the wavenumbers. Powers of kernels are multiplied out as for every
:class:`symflex.algebra.exponential_sum.ExponentialSum`; conjugate exponentials are one term here.

On the imaginary axis of an undamped system every wavenumber is real, imaginary, or on the diagonal, and a
transfer function is real up to a power of j: a :class:`RealSum` in the angular frequency.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, reduce
from itertools import product
from math import gcd, lcm, prod
from operator import mul

from flint import fmpz_mpoly

from symflex.algebra import Dispersion, Factored, KernelTable, Ring
from symflex.algebra.exponential_sum import expanded, power, times
from symflex.algebra.ring import coefficients_of

Term = tuple[tuple[tuple[int, int], ...], int]
"""Pairs ``(a_i, b_i)``, one per length, and 0 for the cosine or 1 for the sine; the first b that is not zero
is positive."""

Key = tuple[Term, ...]  # one term per family
KernelSum = dict[Key, "fmpz_mpoly"]  # products of terms, with coefficients free of kernels in families
Powers = tuple[tuple[str, int], ...]  # functions of one argument, and exponents


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """A wavenumber with its base lengths, or a delay."""

    dispersion: Dispersion  # whose wavenumber it is
    wavenumber: str  # generator; empty for a delay or a shift
    lengths: tuple[Factored, ...]  # [m]; [s] for a delay
    # Per length, the functions ``cosh``, ``sinh``, ``cos``, ``sin``, ``exp``, with the positions of their
    # generators.
    kernels: tuple[tuple[tuple[str, int], ...], ...]

    @property
    def is_circular(self) -> bool:
        """True when cosine and sine occur besides the hyperbolic functions."""
        return self.dispersion.kind == "bending"


def families_of(ring: Ring, table: KernelTable) -> tuple[Family, ...]:
    """Return the families of a table; fundamental functions have none."""
    by_wave: dict[tuple[str, Dispersion], dict[Factored, list[tuple[str, int]]]] = {}
    for kernel in table.kernels:
        if kernel.function != "fundamental":
            family = by_wave.setdefault((kernel.wavenumber, kernel.dispersion), {})
            family.setdefault(kernel.length, []).append((kernel.function, ring.index[kernel.generator]))
    return tuple(
        Family(dispersion, wavenumber, tuple(of_wave), tuple(map(tuple, of_wave.values())))
        for (wavenumber, dispersion), of_wave in by_wave.items()
    )


def expand(ring: Ring, polynomial: fmpz_mpoly, families: Sequence[Family]) -> tuple[KernelSum, Factored]:
    """Return a polynomial in kernels as a sum whose coefficients share no factor, and that factor."""
    kernels = [(f, i) for family in families for of_length in family.kernels for f, i in of_length]
    parts = coefficients_of(ring, polynomial, [i for _, i in kernels])
    halved = [n for n, (f, _) in enumerate(kernels) if f != "exp"]
    degree = max(sum(key[n] for n in halved) for key in parts)
    sums: KernelSum = {}
    for exponents, part in parts.items():
        scaled = part * 2 ** (degree - sum(exponents[n] for n in halved))
        of = {i: e for (_, i), e in zip(kernels, exponents, strict=True)}
        for chosen in product(
            *(
                _terms(tuple(tuple((f, of[i]) for f, i in of_length) for of_length in x.kernels))
                for x in families
            )
        ):
            key = tuple(t for t, _ in chosen)
            term = scaled * prod(n for _, n in chosen)
            sums[key] = sums[key] + term if key in sums else term
    sums = {key: p for key, p in sums.items() if len(p)}
    common = reduce(lambda x, y: x.gcd(y), sums.values())
    if int(common.leading_coefficient()) < 0:
        common = -common
    return {k: p / common for k, p in sums.items()}, Factored.polynomial(ring, common) / 2**degree


@cache
def _terms(powers: tuple[Powers, ...]) -> tuple[tuple[Term, int], ...]:
    """Return a product of powers of one wavenumber's kernels, times two to the power of its degree."""
    terms = []
    # The greatest angles first, each before its opposite.
    pieces = (
        sorted(expanded(dict(exponentials)), key=lambda x: (-x[0], -abs(x[1]), -x[1]))
        for exponentials in powers
    )
    for chosen in product(*pieces):
        first = next((b for _, b, _ in chosen if b), 0)
        if first >= 0:
            # z e^jR and its conjugate make 2 Re z cos R - 2 Im z sin R; z is real or imaginary.
            re, im = reduce(times, (weight for _, _, weight in chosen))
            # A delay's kernel falls with its exponent.
            pairs = tuple(
                (-a if exponentials[0][0] == "exp" else a, b)
                for (a, b, _), exponentials in zip(chosen, powers, strict=True)
            )
            terms.append(((pairs, int(im != 0)), (re - im) * (2 if first else 1)))
    return tuple(terms)


def in_lengths(terms: KernelSum, changes: Sequence[Sequence[Sequence[int]]]) -> KernelSum:
    """Return a sum in other base lengths: per family and old length, its multiples of the new ones."""
    moved: KernelSum = {}
    for key, polynomial in terms.items():
        sign, images = 1, []
        for (pairs, parity), matrix in zip(key, changes, strict=True):
            a, b = in_other_lengths(pairs, matrix)
            image, parity_sign = canonical(tuple(zip(a, b, strict=True)), parity)
            images.append(image)
            sign *= parity_sign
        moved[tuple(images)] = polynomial * sign
    return moved


def in_other_lengths(
    pairs: Sequence[tuple[int, int]], matrix: Sequence[Sequence[int]]
) -> tuple[list[int], list[int]]:
    """Return what a term's ``a`` and ``b`` are in other lengths."""
    a, b = zip(*pairs, strict=True)
    columns = list(zip(*matrix, strict=True))
    return [sum(map(mul, a, column)) for column in columns], [sum(map(mul, b, column)) for column in columns]


def canonical(pairs: tuple[tuple[int, int], ...], parity: int) -> tuple[Term, int]:
    """Return a term with a positive first angle, and the sign that this costs; 0 when it vanishes."""
    first = next((b for _, b in pairs if b), 0)
    if first == 0:
        return (pairs, 0), 0 if parity else 1
    if first > 0:
        return (pairs, parity), 1
    return (tuple((a, -b) for a, b in pairs), parity), -1 if parity else 1


def derivative_at_zero(term: Term, position: int, order: int) -> tuple[tuple[Term, int], ...]:
    """Return the derivative of a term with respect to ``q_position`` at zero, as a combination of terms."""
    pairs, parity = term
    a, b = pairs[position]
    real, imaginary = 1, 0
    for _ in range(order):
        real, imaginary = a * real - b * imaginary, a * imaginary + b * real
    others = (*pairs[:position], (0, 0), *pairs[position + 1 :])
    # Re (z e^jR) = Re z cos R - Im z sin R, and Im (z e^jR) = Im z cos R + Re z sin R.
    parts = ((0, imaginary), (1, real)) if parity else ((0, real), (1, -imaginary))
    images = []
    for kind, number in parts:
        image, sign = canonical(others, kind)
        if number * sign:
            images.append((image, number * sign))
    return tuple(images)


# ------------------------------------------------------------ the imaginary axis of undamped systems

Gaussian = tuple[Fraction, Fraction]
ONE: Gaussian = (Fraction(1), Fraction(0))
TURN: Gaussian = (Fraction(0), Fraction(1))
RealTerm = tuple[tuple[tuple[Fraction, Fraction], ...], int]
"""As :data:`Term`, with the magnitudes of wavenumbers times lengths."""
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
        """True when all dispersions are waves or undamped bending."""
        for d in self.table.dispersions:
            if d.kind not in ("wave", "bending") or not d.shift.is_zero:
                return False
            coefficient = self.real(d.characteristic[0])
            if coefficient is None or coefficient[1] % 2:
                return False
        return True

    def sign(self, dispersion: Dispersion) -> bool | None:
        """Return whether ``c_0`` is negative; the result is None if that depends on values."""
        if dispersion in self.signs:
            return self.signs[dispersion]
        value = self.coefficient(dispersion)
        positive = {self.ring.index[n] for n in (*self.positive, "pi")} | {0}
        for factor, _ in value.factors:
            for monomial, coefficient in factor.terms():
                if int(coefficient) < 0 or any(e and i not in positive for i, e in enumerate(monomial)):
                    return None
        return bool(value.unit < 0)

    def coefficient(self, dispersion: Dispersion) -> Factored:
        """Return ``c_0``, with the angular frequency in place of s."""
        characteristic = self.real(dispersion.characteristic[0])
        assert characteristic is not None  # without damping
        value, turn = characteristic
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
            result = result * Factored.polynomial(self.ring, self.ring.context.from_dict(terms)) ** exponent
            turn += lowest * exponent
        return result, turn % 4

    def real_sum(self, terms: KernelSum, waves: Factored, families: Sequence[Family]) -> RealSum | None:
        """Return a sum times powers of wavenumbers in real terms; None unless it is real or imaginary."""
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
                    by_monomial = collected.setdefault(k, {})
                    have = by_monomial.get(exponents, (Fraction(0), Fraction(0)))
                    by_monomial[exponents] = (have[0] + x[0], have[1] + x[1])
        return self._gathered(collected, waves)

    def _gathered(
        self, collected: Mapping[RealKey, Mapping[tuple[int, ...], Gaussian]], waves: Factored
    ) -> RealSum | None:
        is_real = all(not y for by_monomial in collected.values() for _, y in by_monomial.values())
        is_imaginary = all(not x for by_monomial in collected.values() for x, _ in by_monomial.values())
        if not (is_real or is_imaginary):
            return None
        part = 0 if is_real else 1
        numbers = [x[part] for by_monomial in collected.values() for x in by_monomial.values() if x[part]]
        scale = Fraction(lcm(*(x.denominator for x in numbers)), gcd(*(x.numerator for x in numbers)))
        terms = {}
        for key, by_monomial in collected.items():
            integers = {m: int(x[part] * scale) for m, x in by_monomial.items() if x[part]}
            if integers:
                terms[key] = self.ring.context.from_dict(integers)
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
        parts = [(1, half), (-1, (half[0], -half[1]))] if any(b for _, b in pairs) else [(1, ONE)]
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


def _power(base: Gaussian, exponent: int) -> Gaussian:
    size = base[0] ** 2 + base[1] ** 2
    return power(base if exponent >= 0 else (base[0] / size, -base[1] / size), abs(exponent))
