"""Square roots among the generators of a ring: normal forms, and common factors in s modulo their relations.

    (L*s + r)*(C*r*s + 1) / (L*C*s^2 + 2*C*r*s + 1),  r = sqrt(L/C)   ->   r

Roots whose radicands are independent modulo squares generate a field over the rational functions, in which
products of different roots are linearly independent (Kummer; Lang, Algebra, chapter VI, theorem 8.1). So a
polynomial of degree at most one in every root has one normal form; a root that depends on others is a product
of them. Polynomials in s over that field have greatest common divisors by Euclid's algorithm, as the leading
coefficient can be freed of roots: it is multiplied by its conjugates.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, reduce
from math import gcd, isqrt
from random import Random
from typing import TypeVar

from flint import fmpz, fmpz_mpoly, nmod_poly
from flint.utils.flint_exceptions import DomainError

from symflex.algebra.factored import PRIME, Factored, residue
from symflex.algebra.ring import Ring, by_powers, coefficients_of, degree_in
from symflex.budget import spend

TRIES = 2_000  # primes, and numbers for parameters, that are tried until all radicands are squares
SQUARES_SEEN = 40  # points at which a radicand is a square until it is taken for one: odds 2^-40

NEW = -1  # stands for the position of a root that is no generator

Element = TypeVar("Element", int, "fmpz_mpoly")
Point = tuple[int, dict[str, int]]  # a prime, and a residue for every generator


@dataclass(frozen=True, eq=False)
class Radicals:
    """Arithmetic modulo the relations of square roots; false when there are none.

    >>> from symflex.algebra import Ring
    >>> ring = Ring(("s", "k", "m", "p", "q", "r"))  # p = sqrt(k), q = sqrt(m), r = sqrt(k*m)
    >>> s, k, m, p, q, r = (Factored.generator(ring, name) for name in ring.names)
    >>> radicals = Radicals.of(ring, {3: k, 4: m, 5: k * m}, {1, 2})
    >>> str(radicals.reduced(r)), str(radicals.reduced(p**3 / q))
    ('p*q', 'k*p*q^-1')
    >>> square = radicals.reduced(m * s**2 + 2 * r * s + k)
    >>> quotient, cancelled = radicals.in_lowest_terms((q * s + p) / square)
    >>> str(quotient), str(cancelled)
    ('(s*q + p)^-1', '(s*q + p)')
    """

    ring: Ring  # s is its first generator
    squares: Mapping[int, Factored] = field(default_factory=dict)  # by place, of independent ones
    images: Mapping[int, Factored] = field(default_factory=dict)  # what roots are that depend on others
    radicands: Mapping[int, Factored] = field(default_factory=dict)  # of all roots, as they are written
    positive: frozenset[int] = frozenset()  # positions of generators that are
    _points: dict[int, Point | None] = field(default_factory=dict, repr=False)

    @staticmethod
    def of(ring: Ring, radicands: Mapping[int, Factored], positive: Collection[int]) -> Radicals:
        """Return the relations of roots, inner ones first; ``positive`` are positions of generators."""
        plain = {
            i: a for i, a in radicands.items() if not any(a.depends_on(ring.names[j]) for j in radicands)
        }
        radicals = replace(_independent(ring, plain, frozenset(positive)), radicands=plain)
        for i, radicand in radicands.items():
            if i not in plain:
                radicals = radicals.with_nested(i, radicals.reduced(radicand))
        return replace(radicals, radicands=radicands)

    def root(self, value: Factored) -> Factored | None:
        """Return the root of a rational function in terms of the others, ``None`` when it is none."""
        plain = {i: a for i, a in self.radicands.items() if not any(self._is_rooted(f) for f, _ in a.factors)}
        return _independent(self.ring, {**plain, NEW: value}, self.positive).images.get(NEW)

    def either_root(self, value: Factored) -> Factored | None:
        """Return one of the two square roots, whatever the signs of generators are, as :meth:`root`."""
        powers = self.with_powers(value) if self else value
        return replace(self, positive=frozenset(range(len(self.ring.names)))).root(powers)

    @property
    def free(self) -> frozenset[int]:
        """Roots that are as good as independent symbols, as their sign or their dependence is not known."""
        return frozenset(self.radicands) - self.squares.keys() - self.images.keys()

    def __bool__(self) -> bool:
        return bool(self.radicands)

    def with_nested(self, position: int, square: Factored) -> Radicals:
        """Return the same with one more root, whose radicand holds earlier ones."""
        image = self._root_of_nested(square)
        if image is not None:
            return replace(self, images={**self.images, position: image}, _points={})
        for seed in range(SQUARES_SEEN):
            point = self.point(seed)
            if point is None:
                break
            prime, values = point
            if fmpz(residue(square, values, prime)).jacobi(prime) < 0:
                return replace(self, squares={**self.squares, position: square}, _points={})
        return self

    def _root_of_nested(self, value: Factored) -> Factored | None:
        """Return the root of a sum with roots in it as far as it is one of two kinds, ``None`` otherwise.

        ``sqrt(2 - sqrt(2))`` is ``sqrt(2)/sqrt(2 + sqrt(2))``; ``sqrt(3 + 2*sqrt(2))`` is ``1 + sqrt(2)``.
        """
        used = {i for f, _ in value.factors for i in self.squares if degree_in(f, i)}
        if not used:
            return self.root(value)
        for i, square in self.squares.items():
            if any(self._is_rooted(f) for f, _ in square.factors):
                product = self._multiplied(value * square)
                if not any(self._is_rooted(f) for f, _ in product.factors) and (root := self.root(product)):
                    return root / Factored.generator(self.ring, self.ring.names[i])
        if len(used) > 1:
            return None
        (i,) = used
        value = self._multiplied(value)
        parts = by_powers(self.ring, value.numerator().expand(), i)
        zero = self.ring.constant(0)
        even, odd = (Factored.polynomial(self.ring, parts.get(n, zero)) / value.denominator() for n in (0, 1))
        half = self.root(even * even - odd * odd * self.squares[i])
        if half is None or any(self._is_rooted(f) for f, _ in half.factors):
            return None
        larger, smaller = self.root((even + half) / 2), self.root((even - half) / 2)
        if larger is None or smaller is None:
            return None
        sums = (larger + smaller, larger - smaller)
        return next((x for x in sums if self._multiplied(self._multiplied(x**2) - value).is_zero), None)

    def _multiplied(self, value: Factored) -> Factored:
        """Return a product multiplied out, in normal form."""
        above, below = (self.normal(v.expand()) for v in (value.numerator(), value.denominator()))
        return above / below

    # ------------------------------------------------------------------------------------- normal form

    def tidy(self, value: Factored) -> Factored:
        """Return a product without squares of roots, in normal form only if shorter: ``sqrt(6)`` stays."""
        written, result = self._as_written, Factored.number(self.ring, value.unit)
        if not any(degree_in(f, i) for f, _ in value.factors for i in self.radicands):
            return value
        for f, e in value.factors:
            own = written.reduced(Factored.polynomial(self.ring, f) ** e)
            result = result * (own if len(f) == 1 else min(own, self.normal(f) ** e, key=_size))
        return written.reduced(result)

    @cached_property
    def _as_written(self) -> Radicals:
        """The same without dependences between roots."""
        plain = {i: a for i, a in self.images.items() if not any(self._is_rooted(f) for f, _ in a.factors)}
        return Radicals(self.ring, {i: a for i, a in self.radicands.items() if i not in plain}, plain)

    def reduced(self, value: Factored) -> Factored:
        """Return a product with every factor in normal form; ZeroDivisionError when a denominator is zero."""
        if not any(self._is_rooted(f) for f, _ in value.factors):
            return value
        result = Factored.number(self.ring, value.unit)
        for factor, exponent in value.factors:
            result = result * self._power(factor, exponent)
        return self._balanced(result)

    def _power(self, factor: fmpz_mpoly, exponent: int) -> Factored:
        if len(factor) > 1 or not self._is_rooted(factor):
            return self.normal(factor) ** exponent
        (i,) = (i for i in self._rooted if degree_in(factor, i))
        if i in self.images:
            return self.reduced(self.images[i] ** exponent)
        half = int(exponent / 2)
        return self.squares[i] ** half * Factored.generator(self.ring, self.ring.names[i]) ** (
            exponent - 2 * half
        )

    def _balanced(self, value: Factored) -> Factored:
        """Return a product with roots above or below, as is shorter: ``k/sqrt(k)`` is ``sqrt(k)``."""
        for i, square in self.squares.items():
            exponent = value.exponent_of(self.ring.context.gen(i))
            if exponent:
                other = value * (Factored.generator(self.ring, self.ring.names[i]) ** 2 / square) ** -exponent
                value = min(value, other, key=_size)
        return value

    def normal(self, polynomial: fmpz_mpoly) -> Factored:
        """Return a polynomial in normal form."""
        if not self._is_rooted(polynomial):
            return Factored.polynomial(self.ring, polynomial)
        from symflex.algebra.normal_form import with_image  # few models have roots

        below = Factored.number(self.ring, 1)
        for i, image in self.images.items():
            polynomial, scale = with_image(self.ring, polynomial, i, image, 1)
            below = below * scale
        for i, square in reversed(tuple(self.squares.items())):
            polynomial, scale = with_image(self.ring, polynomial, i, square, 2)
            below = below * scale
        return Factored.polynomial(self.ring, polynomial) / below

    @cached_property
    def _rooted(self) -> tuple[int, ...]:
        return (*self.squares, *self.images)

    def _is_rooted(self, polynomial: fmpz_mpoly) -> bool:
        degrees = polynomial.degrees()
        return any(int(degrees[i]) for i in self._rooted)

    def has_squares(self, polynomial: fmpz_mpoly) -> bool:
        """Tell whether a nonzero polynomial contains squares of roots."""
        degrees = polynomial.degrees()
        return any(int(degrees[i]) > 1 for i in self.radicands)

    # ---------------------------------------------------------------------------------- common factors

    def in_lowest_terms(self, value: Factored) -> tuple[Factored, Factored]:
        """Return a product in normal form without common factors in s above and below, and what cancelled."""
        shared, i = Factored.number(self.ring, 1), 0
        # Apart, so that what becomes equal in normal form is seen to cancel.
        top, bottom = self.reduced(value.numerator()), self.reduced(value.denominator())
        if top.is_zero:
            return top, bottom.filter(lambda f: bool(degree_in(f, 0)))
        above, below = ([(f, e) for f, e in v.factors if degree_in(f, 0)] for v in (top, bottom))
        top, bottom = (v.filter(lambda f: not degree_in(f, 0)) * v.unit for v in (top, bottom))
        scale = top / bottom
        while i < len(above):
            f, m = above[i]
            for j, (g, n) in enumerate(below):
                if (common := self._common(f, g)) is None:
                    continue
                power = min(m, n)
                shared = shared * Factored.polynomial(self.ring, common) ** power
                more, above[i : i + 1] = self._pieces(f, common, m, power)
                less, below[j : j + 1] = self._pieces(g, common, n, power)
                scale = scale * more / less
                break
            else:
                i += 1
        for sign, side in ((1, above), (-1, below)):
            for f, e in side:
                scale = scale * self._shortest(f) ** (sign * e)
        hidden = shared.map_factors(self.ring, self._shortest).filter(lambda f: bool(degree_in(f, 0)))
        result = self.without_rooted_scale(self.reduced(scale))
        if not shared.is_one:
            return result, hidden
        return min(self.tidy(value), result, key=_size), shared

    def _pieces(
        self, f: fmpz_mpoly, common: fmpz_mpoly, exponent: int, power: int
    ) -> tuple[Factored, list[tuple[fmpz_mpoly, int]]]:
        """Return ``f**exponent / common**power`` as a part free of s and powers of factors."""
        rest = self.quotient(f, common)
        varying = [(p, e * exponent) for p, e in rest.factors if degree_in(p, 0)]
        if exponent > power:
            varying.append((common, exponent - power))
        free = rest.filter(lambda p: not degree_in(p, 0)) * rest.unit
        return free**exponent, varying

    def shortest(self, value: Factored) -> Factored:
        """Return a product with roots in front of its factors where that is shorter."""
        return self.tidy(value.map_factors(self.ring, self._shortest)) if self else value

    def _shortest(self, f: fmpz_mpoly) -> Factored:
        """Return a factor, a root in front where that is shorter: ``p*(p*s + q)``, not ``m*s + p*q``."""
        best = Factored.polynomial(self.ring, f)
        for i in self.squares:
            if len(f) > 1 and degree_in(f, i):
                root = Factored.generator(self.ring, self.ring.names[i])
                other = self.normal(f * self.ring.context.gen(i)) / root
                best = min(best, other, key=_degrees)
        return best

    def _common(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly | None:
        """Return the common factor of two that are coprime but for roots, ``None`` when there is none."""
        if f == g:
            return f
        if not (self._is_rooted(f) or self._is_rooted(g)):
            return None
        common = self.gcd(f, g)
        return common if degree_in(common, 0) else None

    def without_rooted_scale(self, value: Factored) -> Factored:
        """Return a product whose sums of roots free of s stand below no longer, where that is shorter."""
        scale = value.filter(lambda f: len(f) > 1 and self._is_rooted(f) and not degree_in(f, 0))
        if scale.is_one:
            return value
        freed = Factored.number(self.ring, 1)
        for factor, exponent in scale.factors:
            one = Factored.polynomial(self.ring, factor)
            freed = freed * (one if exponent > 0 else self._inverse(factor)) ** abs(exponent)
        ratio = self.normal(freed.numerator().expand()) / freed.denominator()
        top, bottom = ratio.numerator().expand(), ratio.denominator().expand()
        common = top.gcd(bottom)
        above, below = (Factored.polynomial(self.ring, p / common) for p in (top, bottom))
        return min(value, self.reduced(value / scale * above / below), key=_size)

    def gcd(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
        """Return the greatest common divisor in s by Euclid's algorithm, led by what is free of roots."""
        one = self.ring.constant(1)
        if not degree_in(f, 0) or not degree_in(g, 0) or self._are_coprime(f, g):
            return one
        if degree_in(f, 0) < degree_in(g, 0):
            f, g = g, f
        f, g = self.primitive(f), self.primitive(g)
        while True:
            spend()
            rest = self._divided(f, g)[1]
            if rest.is_zero():
                return g
            if not degree_in(rest, 0):
                return one
            f, g = g, self.primitive(rest)

    def _are_coprime(self, f: fmpz_mpoly, g: fmpz_mpoly) -> bool:
        """Return whether a point proves it, where the resultant is not zero: Euclid's steps grow fast."""
        if (point := self.point()) is None:
            return False
        prime, values = point
        sides = []
        for side in (f, g):
            coefficients = {
                n: residue(Factored.polynomial(self.ring, part), values, prime)
                for n, part in by_powers(self.ring, side).items()
            }
            sides.append(nmod_poly([coefficients.get(n, 0) for n in range(degree_in(side, 0) + 1)], prime))
        is_kept = all(int(p.degree()) == degree_in(q, 0) for p, q in zip(sides, (f, g), strict=True))
        return is_kept and int(sides[0].gcd(sides[1]).degree()) == 0

    def quotient(self, f: fmpz_mpoly, g: fmpz_mpoly) -> Factored:
        """Return ``f/g`` where g divides f."""
        divisor = self.primitive(g)
        whole = self.primitive(self._divided(f, divisor)[0])
        lead = self.normal(self._lead(whole) * self._lead(g))
        scale = Factored.polynomial(self.ring, self._lead(f)) * self._inverse(lead.numerator().expand())
        top = self.normal(scale.numerator().expand()) / scale.denominator()
        return Factored.polynomial(self.ring, whole) * self.reduced(top * lead.denominator())

    def primitive(self, f: fmpz_mpoly) -> fmpz_mpoly:
        """Return a polynomial times a factor free of s so that no root stands in its leading coefficient."""
        for i in reversed(tuple(self.squares)):
            top = self._lead(f)
            if degree_in(top, i):
                value = self.normal(f * _conjugate(self.ring, top, i))
                f = (value * value.denominator()).expand()  # times a factor free of s and of roots
        content = self._content(f)
        return f / (content if int(f.leading_coefficient()) > 0 else -content)

    def _content(self, f: fmpz_mpoly) -> fmpz_mpoly:
        parts = coefficients_of(self.ring, f, (0, *self.squares)).values()
        return reduce(lambda a, b: a.gcd(b), parts, self.ring.constant(0))

    def _divided(self, f: fmpz_mpoly, g: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return quotient and remainder in s by a primitive polynomial, both times one factor free of s."""
        lead, n, s = self._lead(g), degree_in(g, 0), self.ring.context.gen(0)
        whole = self.ring.constant(0)
        while not f.is_zero() and (m := degree_in(f, 0)) >= n:
            spend()
            term = self._lead(f) * s ** (m - n)
            f, whole = self._whole_pair(lead * f - term * g, lead * whole + term)
        return whole, f

    def _whole_pair(self, f: fmpz_mpoly, g: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return both in normal form times one factor free of s and of roots, without common content."""
        values = [self.normal(p) for p in (f, g)]
        below = [v.denominator() for v in values]
        f, g = ((v * below[0] * below[1]).expand() for v in values)
        content = self._content(f).gcd(self._content(g))
        return f / content, g / content

    def _lead(self, f: fmpz_mpoly) -> fmpz_mpoly:
        """Return the coefficient of the highest power of s."""
        return by_powers(self.ring, f)[degree_in(f, 0)]

    def _inverse(self, f: fmpz_mpoly) -> Factored:
        """Return one over a polynomial in normal form, no root below."""
        above, below = self.ring.constant(1), Factored.polynomial(self.ring, f)
        for i in reversed(tuple(self.squares)):
            top = below.numerator().expand()
            if degree_in(top, i):
                conjugate = _conjugate(self.ring, top, i)
                above, below = above * conjugate, self.normal(top * conjugate) / below.denominator()
        return self.normal(above) / below

    def split(self, factors: Iterable[tuple[fmpz_mpoly, int]]) -> list[tuple[fmpz_mpoly, int]]:
        """Return powers as those of square-free coprime polynomials in s, mirror images apart."""
        base: list[tuple[fmpz_mpoly, int]] = []
        for factor, exponent in factors:
            if degree_in(factor, 0):
                for part, times in self._square_free(factor):
                    base = self._inserted(base, part, times * exponent)
        parts = []
        for element, times in base:
            even = self.gcd(element, self.primitive(_conjugate(self.ring, element, 0)))
            parts += [(p, times) for p in (even, self._over(element, even)) if degree_in(p, 0)]
        return parts

    def with_powers(self, value: Factored) -> Factored:
        """Return a product whose polynomials in roots are powers of square-free ones."""
        result, is_changed = self.reduced(value), False
        for f, e in result.factors:
            if not (self._is_rooted(f) and degree_in(f, 0)):
                continue
            parts = [(Factored.polynomial(self.ring, p), self._lead(p), n) for p, n in self._square_free(f)]
            if any(n > 1 for _, _, n in parts):
                is_changed = True
                scale = Factored.polynomial(self.ring, self._lead(f)) / Factored.polynomial(self.ring, f)
                for part, lead, n in parts:
                    scale = scale * (part / Factored.polynomial(self.ring, lead)) ** n
                result = result * scale**e
        return self.shortest(result) if is_changed else value

    def _square_free(self, f: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]]:
        """Return the parts of every multiplicity (Musser 1971)."""
        parts, times, f = [], 1, self.primitive(f)
        repeated = self.gcd(f, f.derivative(0))
        simple = self._over(f, repeated)
        while degree_in(simple, 0):
            common = self.gcd(simple, repeated)
            if degree_in(part := self._over(simple, common), 0):
                parts.append((part, times))
            simple, repeated, times = common, self._over(repeated, common), times + 1
        return parts

    def _inserted(
        self, base: Sequence[tuple[fmpz_mpoly, int]], element: fmpz_mpoly, times: int
    ) -> list[tuple[fmpz_mpoly, int]]:
        result = []
        for other, known in base:
            common = self.gcd(element, other)
            element = self._over(element, common)
            result += [(self._over(other, common), known), (common, known + times)]
        return [(p, n) for p, n in (*result, (element, times)) if degree_in(p, 0)]

    def _over(self, f: fmpz_mpoly, g: fmpz_mpoly) -> fmpz_mpoly:
        """Return ``f/g`` up to a factor free of s."""
        return self.primitive(self._divided(f, g)[0]) if degree_in(g, 0) else f

    def fraction(self, num: fmpz_mpoly, den: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return a quotient free of s, and of roots below; zero has the numerator zero."""
        if not (self._is_rooted(num) or self._is_rooted(den)):
            return num, den
        below = self.normal(den)
        value = Factored.polynomial(self.ring, num) * self._inverse(below.numerator().expand())
        value = self.normal(value.numerator().expand()) / value.denominator() * below.denominator()
        return value.numerator().expand(), value.denominator().expand()

    # ----------------------------------------------------------------------------------------- a prime

    def point(self, seed: int = 0) -> Point | None:
        """Return a prime and random numbers for generators that satisfy all relations, else ``None``."""
        if not self:
            return PRIME, dict(zip(self.ring.names, self._numbers(Random(20 + seed), PRIME), strict=True))
        if seed not in self._points:
            self._points[seed] = self._found_point(Random(20 + seed))
        return self._points[seed]

    def _numbers(self, random: Random, prime: int) -> list[int]:
        # Squares, so that radicands that are products are squares as well.
        return [random.randrange(1, prime) ** 2 % prime for _ in self.ring.names]

    def _found_point(self, random: Random) -> Point | None:
        # Where -1 is a radicand it has to be a square.
        is_imaginary = any(square.is_constant and square.unit < 0 for square in self.squares.values())
        for _ in range(TRIES):
            spend()
            prime = 4 * random.randrange((PRIME + 1) // 8, (PRIME + 1) // 4) + (1 if is_imaginary else 3)
            if fmpz(prime).is_prime():
                values = dict(zip(self.ring.names, self._numbers(random, prime), strict=True))
                if self._satisfies(values, prime):
                    return prime, values
        return None

    def _satisfies(self, values: dict[str, int], prime: int) -> bool:
        """Give roots their values; tell whether they have any."""
        names = self.ring.names
        try:
            for i, square in self.squares.items():
                value = residue(square, values, prime)
                if fmpz(value).jacobi(prime) < 1:
                    return False
                values[names[i]] = int(fmpz(value).sqrtmod(prime))
            for i, image in self.images.items():
                values[names[i]] = residue(image, values, prime)
        except ZeroDivisionError:
            return False
        return True


def _size(value: Factored) -> tuple[int, int]:
    """Return how many terms a product has, zero the fewest, and its degree."""
    terms = sum(len(f) * abs(e) for f, e in value.factors)
    return (-1 if value.is_zero else terms), _degrees(value)


def _degrees(value: Factored) -> int:
    """Return the degrees of all terms of the sums in a product together."""
    return sum(sum(map(int, m)) for f, _ in value.factors if len(f) > 1 for m in f.monoms())


def _conjugate(ring: Ring, polynomial: fmpz_mpoly, i: int) -> fmpz_mpoly:
    """Return a polynomial with the sign of one generator changed."""
    return ring.context.from_dict({m: -c if int(m[i]) % 2 else c for m, c in polynomial.to_dict().items()})


@dataclass(frozen=True, eq=False)
class _Base:
    """Pairwise coprime integers and polynomials, of which radicands are products."""

    ring: Ring
    positive: frozenset[int]  # positions of generators that are
    numbers: list[int] = field(default_factory=list)
    polynomials: list[fmpz_mpoly] = field(default_factory=list)

    def take(self, radicand: Factored) -> None:
        """Let a radicand's factors be products of elements."""
        for number in (radicand.unit.numerator, radicand.unit.denominator):
            _refine(self.numbers, abs(number), gcd, lambda n: n == 1)
        for factor, _ in radicand.factors:
            _refine(self.polynomials, factor, lambda a, b: a.gcd(b), lambda p: bool(p.is_constant()))

    def odd(self, value: Factored) -> frozenset[str]:
        """Return which elements that are no squares stand in a product to an odd power, and its sign."""
        if value.is_zero:
            return frozenset()
        odd = {f"{n}" for n in self.numbers if _times(value.unit, n) % 2 and isqrt(n) ** 2 != n}
        for p in self.polynomials:
            if sum(e * _power_in(f, p) for f, e in value.factors) % 2 and _root_of(p) is None:
                odd.add(f"({p})")
        return frozenset(odd | ({"-"} if value.unit < 0 else set()))

    def root(self, value: Factored) -> Factored | None:
        """Return the root of a square, which is not negative; ``None`` when its sign is not known."""
        top, bottom = isqrt(value.unit.numerator), isqrt(value.unit.denominator)
        result = Factored.number(self.ring, Fraction(top, bottom))
        for p in self.polynomials:
            exponent = sum(e * _power_in(f, p) for f, e in value.factors)
            root = _root_of(p)
            base, times = (p, exponent // 2) if root is None else (root, exponent)
            used = {i for i, d in enumerate(base.degrees()) if int(d)}
            if times % 2 and not (used <= self.positive and all(int(c) > 0 for c in base.coeffs())):
                return None
            result = result * Factored.polynomial(self.ring, base) ** times
        return result


def _independent(ring: Ring, radicands: Mapping[int, Factored], positive: frozenset[int]) -> Radicals:
    """Return the relations of roots of rational functions, the simplest ones independent."""
    base = _Base(ring, positive)
    for radicand in radicands.values():
        if not radicand.is_zero:
            base.take(radicand)
    squares: dict[int, Factored] = {}
    images: dict[int, Factored] = {}
    # Per independent root what is odd in it after elimination, and the roots whose product that is.
    rows: list[tuple[frozenset[str], frozenset[int]]] = []
    for i in sorted(radicands, key=lambda i: (i == NEW, _simplicity(radicands[i], base))):
        radicand = radicands[i]
        if radicand.is_zero:
            images[i] = radicand
            continue
        odd, parts = base.odd(radicand), frozenset[int]()
        for row, of in rows:
            if min(row) in odd:
                odd, parts = odd ^ row, parts ^ of
        if odd:
            rows.append((odd, parts | {i}))
            squares[i] = radicand
            continue
        rest = radicand
        for j in parts:
            rest = rest / radicands[j]
        root = base.root(rest)
        if root is None:
            continue
        for j in sorted(parts):
            root = root * Factored.generator(ring, ring.names[j])
        images[i] = root
    return Radicals(ring, squares, images, positive=positive)


def _simplicity(radicand: Factored, base: _Base) -> tuple[int, tuple[int, int], int]:
    number = abs(radicand.unit.numerator) * radicand.unit.denominator
    return len(base.odd(radicand)), _size(radicand), number


def _refine(
    base: list[Element],
    new: Element,
    common: Callable[[Element, Element], Element],
    is_unit: Callable[[Element], bool],
) -> None:
    """Make an element a product of elements of a pairwise coprime base (Bach, Driscoll and Shallit 1993)."""
    waiting = [new]
    while waiting:
        x = waiting.pop()
        if is_unit(x):
            continue
        for k, known in enumerate(base):
            shared = common(x, known)
            if not is_unit(shared):
                del base[k]
                waiting += [shared, x // shared, known // shared]
                break
        else:
            base.append(x)


def _times(value: Fraction, n: int) -> int:
    """Return how often an integer divides a fraction."""
    above, below, times = abs(value.numerator), value.denominator, 0
    while above % n == 0:
        above, times = above // n, times + 1
    while below % n == 0:
        below, times = below // n, times - 1
    return times


def _power_in(f: fmpz_mpoly, p: fmpz_mpoly) -> int:
    """Return how often a polynomial divides another."""
    times = 0
    while True:
        whole, rest = divmod(f, p)
        if not rest.is_zero():
            return times
        f, times = whole, times + 1


def _root_of(p: fmpz_mpoly) -> fmpz_mpoly | None:
    try:
        return p.sqrt()
    except DomainError:
        return None
