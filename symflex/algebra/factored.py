"""Rational functions kept as a product of powers, so that what a user grouped stays grouped.

Their values at a random point of a prime field tell whether they vanish, almost surely.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, lcm, prod
from random import Random

from flint import fmpz, fmpz_mpoly

from symflex.algebra.ring import (
    DEGREE_LIMIT,
    MEMORY_LIMIT,
    TERM_LIMIT,
    Ring,
    by_powers,
    degree_in,
    highest_degree,
    terms_of,
)
from symflex.algebra.sparse import Monomial
from symflex.balls import Arithmetic, ball, raised
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic


@dataclass(frozen=True, slots=True, eq=False)
class Factored:
    """``unit * product(factor ** exponent)`` over a :class:`Ring`.

    Every factor is a generator, or a primitive polynomial of two or more terms with positive
    leading coefficient and no monomial factor. Exponents are nonzero integers; negative ones
    form the denominator. Products and powers never expand; sums expand only what differs.

    >>> ring = Ring(("s", "k", "b"))
    >>> k, b, s = (Factored.generator(ring, n) for n in "kbs")
    >>> impedance = k + b * s
    >>> str(impedance * impedance / k)
    '(s*b + k)^2*k^-1'
    """

    ring: Ring  # where the factors live
    unit: Fraction  # the rational number in front; zero makes the whole value zero
    factors: tuple[tuple[fmpz_mpoly, int], ...] = ()  # pairwise different, in order of appearance

    @staticmethod
    def number(ring: Ring, value: Fraction | int) -> Factored:
        """Return a rational constant."""
        return Factored(ring, Fraction(value))

    @staticmethod
    def generator(ring: Ring, name: str) -> Factored:
        """Return a generator of the ring."""
        return Factored(ring, Fraction(1), ((ring.generator(name), 1),))

    @staticmethod
    def polynomial(ring: Ring, value: fmpz_mpoly) -> Factored:
        """Return a polynomial with its numeric and monomial content pulled out."""
        if value.is_zero():
            return Factored(ring, Fraction(0))
        content = value.term_content()
        rest = value if content.is_one() else value / content
        unit = int(content.leading_coefficient())
        if int(rest.leading_coefficient()) < 0:
            rest, unit = -rest, -unit
        ((monomial, _),) = terms_of(content)
        factors = [(ring.context.gen(i), e) for i, e in monomial]
        if not rest.is_constant():
            factors.append((rest, 1))
        return Factored(ring, Fraction(unit), tuple(factors))

    @property
    def is_zero(self) -> bool:
        """True for the zero function."""
        return self.unit == 0

    @property
    def is_one(self) -> bool:
        """True for the constant one."""
        return self.unit == 1 and not self.factors

    @property
    def is_constant(self) -> bool:
        """True for a rational number."""
        return not self.factors

    def __mul__(self, other: Factored | int | Fraction) -> Factored:
        other = self._coerce(other)
        unit = self.unit * other.unit
        if unit == 0:
            return Factored(self.ring, unit)
        return Factored(self.ring, unit, _merge(self.factors, other.factors))

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> Factored:
        if exponent == 0:
            return Factored.number(self.ring, 1)
        return Factored(self.ring, self.unit**exponent, tuple((f, e * exponent) for f, e in self.factors))

    def __truediv__(self, other: Factored | int | Fraction) -> Factored:
        return self * self._coerce(other) ** -1

    def __rtruediv__(self, other: int | Fraction) -> Factored:
        return self._coerce(other) / self

    def __neg__(self) -> Factored:
        return Factored(self.ring, -self.unit, self.factors)

    def __add__(self, other: Factored | int | Fraction) -> Factored:
        other = self._coerce(other)
        if self.is_zero:
            return other
        if other.is_zero:
            return self
        common = self._common(other)
        left, right = self / common, other / common
        scale = fmpz(left.unit.denominator).lcm(fmpz(right.unit.denominator))
        total = left._expand_scaled(int(scale)) + right._expand_scaled(int(scale))
        return common * Factored.polynomial(self.ring, total) * Fraction(1, int(scale))

    __radd__ = __add__

    def __sub__(self, other: Factored | int | Fraction) -> Factored:
        return self + (-self._coerce(other))

    def __rsub__(self, other: int | Fraction) -> Factored:
        return self._coerce(other) - self

    def numerator(self) -> Factored:
        """Return the factors with positive exponents and the unit's numerator."""
        return Factored(
            self.ring, Fraction(self.unit.numerator), tuple((f, e) for f, e in self.factors if e > 0)
        )

    def denominator(self) -> Factored:
        """Return the factors with negative exponents, inverted, and the unit's denominator."""
        return Factored(
            self.ring, Fraction(self.unit.denominator), tuple((f, -e) for f, e in self.factors if e < 0)
        )

    def expand(self) -> fmpz_mpoly:
        """Return the product multiplied out; ValueError where it is no polynomial, SF501 beyond the limit."""
        return self._expand_scaled(1)

    def exponent_of(self, factor: fmpz_mpoly) -> int:
        """Return the exponent of one of the factors, zero when it is none of them."""
        return next((e for f, e in self.factors if f == factor), 0)

    def filter(self, keep: Callable[[fmpz_mpoly], bool]) -> Factored:
        """Return the product of the factors that ``keep`` accepts, with unit one."""
        return Factored(self.ring, Fraction(1), tuple((f, e) for f, e in self.factors if keep(f)))

    def depends_on(self, name: str) -> bool:
        """Tell whether a factor contains the generator called ``name``."""
        i = self.ring.index[name]
        return any(degree_in(f, i) for f, _ in self.factors)

    def slope(self, name: str) -> Factored:
        """Return the derivative with respect to a generator.

        >>> ring = Ring(("x", "y"))
        >>> x, y = Factored.generator(ring, "x"), Factored.generator(ring, "y")
        >>> str((y / x).slope("x"))
        '-1*y*x^-2'
        """
        i, total = self.ring.index[name], Factored.number(self.ring, 0)
        for factor, exponent in self.factors:
            if degree_in(factor, i):
                own, rate = (Factored.polynomial(self.ring, f) for f in (factor, factor.derivative(i)))
                total = total + self / own * rate * exponent
        return total

    def map_factors(self, ring: Ring, image: Callable[[fmpz_mpoly], Factored]) -> Factored:
        """Return the value with every factor replaced by its image in ``ring``."""
        return prod((image(f) ** e for f, e in self.factors), start=Factored.number(ring, self.unit))

    def over(self, ring: Ring) -> Factored:
        """Return the same function over another ring; names that it lacks are zero."""
        names = self.ring.names
        return self.map_factors(ring, lambda f: Factored.polynomial(ring, ring.taken_over(f, names)))

    def __str__(self) -> str:
        parts = [str(self.unit)] if self.unit != 1 or not self.factors else []
        for factor, exponent in self.factors:
            text = f"({factor})" if len(factor) > 1 else str(factor)
            parts.append(text if exponent == 1 else f"{text}^{exponent}")
        return "*".join(parts)

    def _coerce(self, other: Factored | int | Fraction) -> Factored:
        return other if isinstance(other, Factored) else Factored.number(self.ring, other)

    def _common(self, other: Factored) -> Factored:
        """Return the product of shared factors with the smaller exponent of each."""
        common = [(f, min(e, other.exponent_of(f))) for f, e in self.factors]
        common += [(f, min(e, 0)) for f, e in other.factors if self.exponent_of(f) == 0]
        return Factored(self.ring, Fraction(1), tuple((f, e) for f, e in common if e))

    def _expand_scaled(self, scale: int) -> fmpz_mpoly:
        unit = self.unit * scale
        if unit.denominator != 1 or any(e < 0 for _, e in self.factors):
            raise ValueError("only a polynomial with integer coefficients can be expanded")
        terms, most = 1, min(TERM_LIMIT, MEMORY_LIMIT // self.ring.bytes_of(1))
        for factor, exponent in self.factors:
            terms *= comb(len(factor) + exponent - 1, exponent) if len(factor) > 1 else 1
            degree = exponent * highest_degree(factor)
            if terms > most or degree > DEGREE_LIMIT:
                raise BudgetError(
                    Diagnostic(
                        "SF501",
                        f"an expanded product would exceed {most} terms or degree {DEGREE_LIMIT}",
                        None,
                        "keep repeated sums in [definitions]",
                    )
                )
        return prod((factor**e for factor, e in self.factors), start=self.ring.constant(int(unit)))


def in_lowest_terms(
    numerator: Factored,
    denominator: Factored,
    are_coprime: Callable[[fmpz_mpoly, fmpz_mpoly], bool] = lambda _f, _g: False,
) -> tuple[Factored, Factored]:
    """Return a quotient in lowest terms, and the common factor; ``are_coprime`` may prove factors coprime.

    >>> s = Factored.generator(Ring(("s",)), "s")
    >>> quotient, shared = in_lowest_terms((s + 2) * (s**2 - 1), (s - 1) ** 2 * (s + 3))
    >>> str(quotient), str(shared)
    ('(s + 2)*(s + 1)*(s - 1)^-1*(s + 3)^-1', '(s - 1)')
    """
    ring = numerator.ring
    quotient = numerator / denominator
    if quotient.is_zero:
        return quotient, Factored.number(ring, 1)
    shared = Factored.number(ring, 1)
    for factor, exponent in numerator.factors:
        other = denominator.exponent_of(factor)
        if exponent > 0 and other > 0:
            shared = shared * Factored(ring, Fraction(1), ((factor, min(exponent, other)),))
    above = [(f, e) for f, e in quotient.factors if e > 0]
    below = [(f, -e) for f, e in quotient.factors if e < 0]
    i, changed = 0, False
    while i < len(above):
        j = 0
        while j < len(below):
            spend()
            f, m = above[i]
            g, n = below[j]
            if are_coprime(f, g) or (common := f.gcd(g)).is_constant():
                j += 1
                continue
            power = min(m, n)
            shared, changed = shared * Factored.polynomial(ring, common) ** power, True
            above[i : i + 1] = _pieces(f, common, m, power)
            below[j : j + 1] = _pieces(g, common, n, power)
            if i >= len(above):
                break
            j = 0
        i += 1
    if not changed:
        return quotient, shared
    result = Factored.number(ring, quotient.unit)
    for f, e in above:
        result = result * Factored.polynomial(ring, f) ** e
    for f, e in below:
        result = result / Factored.polynomial(ring, f) ** e
    return result, shared


def _pieces(
    factor: fmpz_mpoly, common: fmpz_mpoly, exponent: int, power: int
) -> list[tuple[fmpz_mpoly, int]]:
    """Return ``factor**exponent / common**power`` as factors with positive exponents."""
    rest = factor / common
    pieces = [(rest, exponent), (common, exponent - power)]
    return [(f, e) for f, e in pieces if e > 0 and not f.is_constant()]


def least_common_multiple(start: Factored, values: Iterable[Factored]) -> Factored:
    """Return the least multiple of ``start`` with the factors of every value, whose numbers are ignored."""
    result = start
    for value in values:
        for factor, exponent in value.factors:
            missing = exponent - result.exponent_of(factor)
            if missing > 0:
                result = result * Factored(start.ring, Fraction(1), ((factor, missing),))
    return result


def common_denominator(ring: Ring, values: Sequence[Factored]) -> Factored:
    """Return the least common multiple of the values' denominators, numbers included.

    >>> ring = Ring(("s", "k"))
    >>> k = Factored.generator(ring, "k")
    >>> str(common_denominator(ring, [k / 6, k**-2 / 4, k**-1]))
    '12*k^2'
    """
    numbers = Factored.number(ring, lcm(*(v.unit.denominator for v in values)))
    return least_common_multiple(numbers, (v.denominator() for v in values))


def composed(value: Factored, images: Mapping[str, Factored]) -> Factored:
    """Return a value with rational functions of the same ring in place of some generators.

    >>> ring = Ring(("s", "k"))
    >>> s, k = (Factored.generator(ring, name) for name in ring.names)
    >>> str(composed((s + k) * k, {"k": 1 / s}))
    's^-2*(s^2 + 1)'
    """
    return value.map_factors(value.ring, lambda factor: _composed(value.ring, factor, images))


def _composed(ring: Ring, factor: fmpz_mpoly, images: Mapping[str, Factored]) -> Factored:
    composition = Factored.polynomial(ring, factor)
    for name, image in images.items():
        if not composition.depends_on(name):
            continue
        total = Factored.number(ring, 0)
        above = composition.numerator().expand()
        for power, part in by_powers(ring, above, ring.index[name]).items():
            total = total + Factored.polynomial(ring, part) * image**power
        composition = total / composition.denominator()
    return composition


def _merge(
    left: tuple[tuple[fmpz_mpoly, int], ...], right: tuple[tuple[fmpz_mpoly, int], ...]
) -> tuple[tuple[fmpz_mpoly, int], ...]:
    merged = list(left)
    for factor, exponent in right:
        for i, (known, power) in enumerate(merged):
            if known == factor:
                merged[i] = (known, power + exponent)
                break
        else:
            merged.append((factor, exponent))
    return tuple((f, e) for f, e in merged if e)


# A prime of Mersenne's below what a word of the machine has room for: those of WebAssembly have 32 bits.
# A polynomial of degree d vanishes at a random point with odds d/PRIME.
PRIME = 2**61 - 1 if sys.maxsize > 2**32 else 2**31 - 1


def random_point(names: Sequence[str]) -> dict[str, int]:
    """Return a value per generator, the same in every run."""
    random = Random(20)
    return {name: random.randrange(1, PRIME) for name in names}


def residue(value: Factored, point: Mapping[str, int], prime: int = PRIME) -> int:
    """Return a factored rational function at a point, modulo a prime.

    Raises ZeroDivisionError when its denominator is zero there.

    >>> from symflex.algebra import Factored, Ring
    >>> ring = Ring(("s", "k"))
    >>> k = Factored.generator(ring, "k")
    >>> residue((k + 1) / k, {"s": 1, "k": 1}), residue(k - k, {"s": 1, "k": 1})
    (2, 0)
    """
    names = value.ring.names
    number = value.unit.numerator % prime * _power(value.unit.denominator, -1, prime) % prime
    for factor, exponent in value.factors:
        number = number * _power(_polynomial(factor, names, point, prime), exponent, prime) % prime
    return number


def _power(base: int, exponent: int, prime: int) -> int:
    if exponent < 0 and base % prime == 0:
        raise ZeroDivisionError("division by zero")
    return pow(base, exponent, prime)


def _polynomial(polynomial: fmpz_mpoly, names: Sequence[str], point: Mapping[str, int], prime: int) -> int:
    total = 0
    for monomial, coefficient in terms_of(polynomial):
        product = coefficient % prime
        for i, exponent in monomial:
            product = product * pow(point[names[i]], exponent, prime) % prime
        total += product
    return total % prime


def evaluated(value: Factored, number: Callable[[str], Arithmetic], one: Arithmetic) -> Arithmetic:
    """Return a rational function with a number in place of every generator; ``one`` is 1 of their kind."""
    total, names = one * ball(value.unit), value.ring.names
    return prod((raised(summed(terms_of(f), names, number, one), e) for f, e in value.factors), start=total)


def summed(
    terms: Sequence[tuple[Monomial, int]],
    names: Sequence[str],
    number: Callable[[str], Arithmetic],
    one: Arithmetic,
) -> Arithmetic:
    """Return the same of a polynomial, by its terms."""
    total = one * 0
    for monomial, coefficient in terms:
        total = total + prod((raised(number(names[i]), e) for i, e in monomial), start=one * coefficient)
    return total
