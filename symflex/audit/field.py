"""The exact field in which printed and derived functions are compared.

    printed     2*sinh(x)*cosh(x), x = l*sqrt(s)      (E - 1/E)*(E + 1/E)/2
    derived     sinh(2*x)                             (E^2 - 1/E^2)/2

With a generator E for exp(x), which satisfies no relation to s, both sides are quotients of polynomials, and
multiplied out they are the same: equal, proved.

Generators are roots of s, of positive parameters, of primes and of sums of them, the imaginary unit, and
``exp``, ``cos`` and ``sin`` of lengths times wavenumbers. Real radicals of multiplicatively independent
positive numbers are linearly independent (Mordell 1953), and exponentials and trigonometric functions of
independent arguments satisfy no relation but ``cos^2 + sin^2 = 1``; so every polynomial has one normal
form, and equal functions are those whose difference has the normal form zero. (Where a root stands in a
sum under another root, they may satisfy more relations: then equality is still proved by zero, and
nothing by its absence.) Roots are the principal ones for s > 0: what is proved there holds everywhere by
analytic continuation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import gcd

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, irreducible_factors
from symflex.algebra.normal_form import with_image
from symflex.errors import BudgetError, Diagnostic

# Limits of what is read exactly, so that a hostile formula cannot take minutes; beyond them, the printed and
# the derived function are compared by numbers.
FINEST_ROOT = 96
MOST_GENERATORS = 40
SQUARE = 2
MOST_MULTIPLES = 48
LARGEST_PRIME = 1000
LARGEST_COFACTOR_BITS = 256
LARGEST_NUMBER_BITS = 20_000
CIRCULAR = ("cos", "sin", "tan")
UNIT = "unit(i)"  # generator of i, for formulas in omega: ``(-x)^(1/4)`` is ``x^(1/4)*(1 + i)/sqrt(2)``
HOLE = "?"  # generator that stands for a part of a formula whose right value is looked for

Key = tuple[tuple[str, Fraction], ...]
Recipe = tuple[tuple[Key, int], ...]  # a polynomial in roots, by name and exponent, valid in larger fields
Multiples = Sequence[tuple[int, int]]  # base arguments by number, each with how many times it is taken


class UnreadError(Exception):
    """A formula leaves the field: it can be evaluated, and not read exactly."""


class GrowError(Exception):
    """A formula needs a larger field, which is given."""

    def __init__(self, ground: Ground) -> None:
        super().__init__()
        self.ground = ground


@dataclass(frozen=True, slots=True)
class Wave:
    """What the generators ``exp``, ``cos``, ``sin`` of one number are functions of: ``unit * monomial``."""

    key: Key
    unit: Fraction


@dataclass(frozen=True)
class Ground:
    """What a field is made of; it grows as formulas are read."""

    names: tuple[str, ...]  # s, the parameters, pi
    rootable: frozenset[str]  # those of them taken positive
    order: int = 1  # generators stand for the roots of this order
    primes: tuple[int, ...] = ()  # whose roots occur
    sums: tuple[Recipe, ...] = ()  # polynomials whose roots occur, each in s, parameters and earlier roots
    waves: tuple[Wave, ...] = ()  # arguments of transcendental functions
    plain: Ring = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "plain", Ring(self.names))

    def grown(self, **more: object) -> Ground:
        """Return the ground with other entries; UnreadError when it would become unreasonably large."""
        ground = replace(self, **more)  # type: ignore[arg-type]
        size = len(ground.primes) + len(ground.sums) + 3 * len(ground.waves)
        if ground.order > FINEST_ROOT:
            raise UnreadError(f"it needs roots of higher order than {FINEST_ROOT}")
        if size > MOST_GENERATORS:
            raise UnreadError("it has too many different roots and functions")
        return ground


@dataclass(frozen=True, eq=False)
class Arithmetic:
    """Arithmetic over one ground."""

    ground: Ground  # what it is made of

    @cached_property
    def ring(self) -> Ring:
        """Polynomials in all generators."""
        g = self.ground
        waves = [f"{name}({i})" for i in range(len(g.waves)) for name in ("exp", "cos", "sin")]
        roots, sums = [f"root({p})" for p in g.primes], [f"sum({i})" for i in range(len(g.sums))]
        return Ring((*g.names, *roots, *sums, UNIT, *waves, HOLE))

    def number(self, value: Fraction | int) -> Factored:
        """Return a rational number."""
        return Factored.number(self.ring, value)

    def name(self, name: str) -> Factored:
        """Return s, a parameter or pi."""
        generator = Factored.generator(self.ring, name)
        return generator**self.ground.order if name in self.ground.rootable else generator

    @property
    def hole(self) -> Factored:
        """The value looked for."""
        return Factored.generator(self.ring, HOLE)

    def from_recipe(self, recipe: Recipe) -> Factored:
        """Return a polynomial in roots."""
        terms: dict[tuple[int, ...], int] = {}
        for key, coefficient in recipe:
            exponents = [0] * len(self.ring.names)
            for name, exponent in key:
                exponents[self.ring.index[name]] = int(exponent * self._order_of(name))
            terms[tuple(exponents)] = coefficient
        return Factored.polynomial(self.ring, self.ring.context.from_dict(terms))

    def _order_of(self, name: str) -> int:
        """Return of which root of a name its generator stands for."""
        g = self.ground
        return 1 if name in g.names and name not in g.rootable else g.order

    def power(self, value: Factored, exponent: Fraction) -> Factored:
        """Return the principal value of a rational power, for positive s and parameters."""
        if value.is_zero:
            if exponent < 0:
                raise ZeroDivisionError
            return self.number(1 if exponent == 0 else 0)
        if exponent.denominator == 1:
            n = exponent.numerator
            bits = max(abs(value.unit.numerator).bit_length(), value.unit.denominator.bit_length())
            if bits * abs(n) > LARGEST_NUMBER_BITS:
                message = f"a number would exceed {LARGEST_NUMBER_BITS} bits"
                raise BudgetError(Diagnostic("SF501", message, None, "name the power in 'where'"))
            return value**n
        unit = self.ring.generator(UNIT)
        turns = (2 if value.unit < 0 else 0) + sum(e for f, e in value.factors if f == unit)
        factors = tuple((f, e) for f, e in value.factors if f != unit)
        # One difference may have either sign, for its root is one number whichever it is. Of two, or of a
        # power or reciprocal, the roots of the parts need not multiply to the root of the whole.
        mixed = [e for factor, times in factors for e in self._mixed(factor, times)]
        if mixed and (mixed != [1] or turns % 2):
            raise UnreadError("it takes the root of a product, power or reciprocal of differences")
        is_flipped = bool(mixed) and turns % 4 == SQUARE
        result = self._number_power(abs(value.unit), exponent)
        if not is_flipped:
            result = result * self._turned(turns, exponent)
        for factor, times in factors:
            result = result * self._factor_power(factor, exponent, times, is_flipped)
        return result

    def _mixed(self, factor: fmpz_mpoly, times: int) -> list[int]:
        """Return the exponents of the irreducible parts of a factor that may be negative."""
        if self._is_positive(factor):
            return []
        parts = self._parts(factor) if len(factor) > 1 else None
        if parts is None:
            return [times]
        return [power * times for recipe, power in parts[1] if not self._is_sum_of_positives(recipe)]

    def _number_power(self, value: Fraction, exponent: Fraction) -> Factored:
        """Return a power of a positive number."""
        result = self.number(1)
        for number, sign in ((value.numerator, 1), (value.denominator, -1)):
            for prime, times in _primes(number):
                power = sign * times * exponent
                integer = power.numerator // power.denominator
                part = power - integer
                result = result * Fraction(prime) ** integer
                if part:
                    if prime not in self.ground.primes:
                        raise GrowError(self.ground.grown(primes=(*self.ground.primes, prime)))
                    result = result * Factored.generator(self.ring, f"root({prime})") ** self._steps(part)
        return result

    def _turned(self, turns: int, exponent: Fraction) -> Factored:
        """Return the principal value of a power of ``i^turns``."""
        nearest = turns % 4 - 4 if turns % 4 == 3 else turns % 4  # noqa: PLR2004
        eighths = 2 * nearest * exponent
        if eighths.denominator != 1:
            message = "it takes a root of a number that is not positive, and not a square root of i or -1"
            raise UnreadError(message)
        unit = Factored.generator(self.ring, UNIT)
        if int(eighths) % 2 == 0:
            return self.reduced(unit ** (int(eighths) // 2 % 4))
        diagonal = (unit + 1) / self.power(self.number(2), Fraction(1, 2))
        return self.reduced(diagonal ** (int(eighths) % 8))

    def _steps(self, exponent: Fraction) -> int:
        """Return an exponent in steps of the roots' order."""
        steps = exponent * self.ground.order
        if steps.denominator != 1:
            raise GrowError(self.ground.grown(order=self.ground.order * steps.denominator))
        return int(steps)

    def _factor_power(self, factor: fmpz_mpoly, exponent: Fraction, times: int, is_flipped: bool) -> Factored:
        """Return ``(factor^times)^exponent``, the exponent no integer; of minus the factor when flipped."""
        total = times * exponent
        if total.denominator == 1:
            return Factored.polynomial(self.ring, factor) ** int(total)
        if len(factor) == 1:
            name = self.ring.names[next(i for i, e in enumerate(factor.monoms()[0]) if e)]
            g = self.ground
            if name.startswith("exp("):
                wave = int(name[4:-1])
                finer = Wave(g.waves[wave].key, g.waves[wave].unit / total.denominator)
                raise GrowError(g.grown(waves=(*g.waves[:wave], finer, *g.waves[wave + 1 :])))
            if name.startswith(("cos(", "sin(", HOLE, UNIT)) or (name in g.names and name not in g.rootable):
                what = "the imaginary unit" if name == UNIT else "a function" if "(" in name else f"'{name}'"
                raise UnreadError(f"it takes a root of {what}")
            raise GrowError(g.grown(order=g.order * total.denominator))
        parts = self._parts(factor)
        if parts is None:
            raise UnreadError("it takes a root that is not one of s and the parameters")
        result = self._number_power(Fraction(parts[0]), total)
        for recipe, power in parts[1]:
            turned = is_flipped and not self._is_sum_of_positives(recipe)
            signed = tuple((key, -n) for key, n in recipe) if turned else recipe
            result = result * self._sum_power(signed, power * total)
        return result

    def _parts(self, factor: fmpz_mpoly) -> tuple[int, list[tuple[Recipe, int]]] | None:
        """Return content and irreducible parts of a polynomial, ``None`` when it contains functions."""
        plain = self._plain(factor)
        if plain is not None:
            content, parts = irreducible_factors(plain)
            return content, [(_recipe_of_plain(self.ground.names, part), e) for part, e in parts]
        terms = []
        for monomial, coefficient in factor.terms():
            key = []
            for name, exponent in zip(self.ring.names, monomial, strict=True):
                if int(exponent):
                    if name in (UNIT, HOLE) or name.startswith(("exp(", "cos(", "sin(")):
                        return None
                    key.append((name, Fraction(int(exponent), self._order_of(name))))
            terms.append((tuple(key), int(coefficient)))
        return 1, [(tuple(sorted(terms)), 1)]

    def _is_positive(self, factor: fmpz_mpoly) -> bool:
        """Tell whether a polynomial is positive as a sum of positive terms."""
        degrees = factor.degrees()
        used = [n for n, d in zip(self.ring.names, degrees, strict=True) if int(d)]
        return all(int(c) > 0 for c in factor.coeffs()) and all(map(self._is_positive_name, used))

    def _is_positive_name(self, name: str) -> bool:
        if name.startswith("sum("):
            return self._is_sum_of_positives(self.ground.sums[int(name[4:-1])])
        return name in self.ground.rootable or name.startswith(("root(", "exp("))

    def _is_sum_of_positives(self, recipe: Recipe) -> bool:
        return all(c > 0 and all(self._is_positive_name(n) for n, _ in key) for key, c in recipe)

    def _sum_power(self, recipe: Recipe, exponent: Fraction) -> Factored:
        """Return a power of a polynomial, which is taken positive."""
        integer = exponent.numerator // exponent.denominator
        result = self.from_recipe(recipe) ** integer
        fractional = exponent - integer
        return result * self._root_of_sum(recipe) ** self._steps(fractional) if fractional else result

    def _root_of_sum(self, recipe: Recipe) -> Factored:
        """Return the generator that stands for the root of a polynomial."""
        if recipe not in self.ground.sums:
            raise GrowError(self.ground.grown(sums=(*self.ground.sums, recipe)))
        return Factored.generator(self.ring, f"sum({self.ground.sums.index(recipe)})")

    def _plain(self, factor: fmpz_mpoly) -> fmpz_mpoly | None:
        """Return a polynomial in s and the parameters themselves over their own ring."""
        g = self.ground
        count = len(g.names)
        terms: dict[tuple[int, ...], int] = {}
        for monomial, coefficient in factor.terms():
            exponents = [int(e) for e in monomial]
            if any(exponents[count:]):
                return None
            for i, name in enumerate(g.names):
                if name in g.rootable:
                    exponents[i], remainder = divmod(exponents[i], g.order)
                    if remainder:
                        return None
            terms[tuple(exponents[:count])] = int(coefficient)
        return g.plain.context.from_dict(terms)

    def function(self, name: str, argument: Factored) -> Factored:
        """Return ``exp``, ``sin``, ``cos``, ``tan``, ``sinh``, ``cosh``, ``tanh`` or ``sqrt`` of a value."""
        if name == "sqrt":
            return self.power(argument, Fraction(1, 2))
        if name in ("log", "atan"):
            raise UnreadError(f"it takes {'a logarithm' if name == 'log' else 'an arctangent'}")
        real, imaginary = self._multiples(argument)
        if name in CIRCULAR and not imaginary:
            cosine, sine = self._circular(real)
            return cosine if name == "cos" else sine if name == "sin" else sine / cosine
        if name in CIRCULAR:  # cos x = cosh ix, sin x = sinh ix/i
            real, imaginary = [(w, -n) for w, n in imaginary], real
        grown = self._exponential(real, imaginary)
        decayed = self._exponential([(w, -n) for w, n in real], [(w, -n) for w, n in imaginary])
        if name == "exp":
            return grown
        even, odd = (grown + decayed) / 2, (grown - decayed) / 2
        if name in CIRCULAR:
            odd = odd / Factored.generator(self.ring, UNIT)
        return even if name in ("cos", "cosh") else odd if name in ("sin", "sinh") else odd / even

    def _exponential(self, real: Multiples, imaginary: Multiples) -> Factored:
        """Return ``exp(x + iy)``."""
        grown = self.number(1)
        for wave, n in real:
            grown = grown * Factored.generator(self.ring, f"exp({wave})") ** n
        if not imaginary:
            return grown
        cosine, sine = self._circular(imaginary)
        return grown * (cosine + Factored.generator(self.ring, UNIT) * sine)

    def _circular(self, multiples: Sequence[tuple[int, int]]) -> tuple[Factored, Factored]:
        """Return cosine and sine of a sum of multiples of the base arguments, by addition theorems."""
        cosine, sine = self.number(1), self.number(0)
        for wave, n in multiples:
            c, s = (Factored.generator(self.ring, f"{f}({wave})") for f in ("cos", "sin"))
            for _ in range(abs(n)):
                turned = s if n > 0 else -s
                cosine, sine = cosine * c - sine * turned, sine * c + cosine * turned
                cosine, sine = self.reduced(cosine), self.reduced(sine)
        return cosine, sine

    def _multiples(self, argument: Factored) -> tuple[Multiples, Multiples]:
        """Return real and imaginary part of an argument as integer multiples of the base arguments."""
        parts: tuple[list[tuple[int, int]], list[tuple[int, int]]] = ([], [])
        for (key, is_imaginary), coefficient in self._terms(argument).items():
            index = next((i for i, w in enumerate(self.ground.waves) if w.key == key), None)
            if index is None:
                wave = Wave(key, abs(coefficient))
                raise GrowError(self.ground.grown(waves=(*self.ground.waves, wave)))
            unit = self.ground.waves[index].unit
            n = coefficient / unit
            if n.denominator != 1:
                below = coefficient.denominator * unit.denominator  # both are multiples of the new unit
                finer = Wave(key, Fraction(gcd(int(coefficient * below), int(unit * below)), below))
                waves = (*self.ground.waves[:index], finer, *self.ground.waves[index + 1 :])
                raise GrowError(self.ground.grown(waves=waves))
            if abs(n) > MOST_MULTIPLES:
                message = f"arguments of its functions are more than {MOST_MULTIPLES} times one another"
                raise UnreadError(message)
            parts[is_imaginary].append((index, int(n)))
        return parts

    def _terms(self, argument: Factored) -> dict[tuple[Key, bool], Fraction]:
        """Return an argument as monomials in roots, times i or not, with rational coefficients."""
        common, expanded = self.number(argument.unit), self.number(1)
        for factor, exponent in argument.factors:
            if len(factor) == 1:
                common = common * Factored.polynomial(self.ring, factor) ** exponent
                continue
            parts = self._parts(factor)
            if exponent > 0 and (parts is None or any(r not in self.ground.sums for r, _ in parts[1])):
                expanded = expanded * Factored.polynomial(self.ring, factor) ** exponent
                continue
            if parts is None:
                raise UnreadError("the argument of a function has a denominator that contains functions")
            common = common * Fraction(parts[0]) ** exponent
            for recipe, times in parts[1]:
                common = common * self._root_of_sum(recipe) ** (times * exponent * self.ground.order)
        outer = {next(i for i, e in enumerate(f.monoms()[0]) if e): n for f, n in common.factors}
        terms: dict[tuple[Key, bool], Fraction] = {}
        unit = self.ring.index[UNIT]
        for monomial, coefficient in expanded.expand().terms():
            exponents = [int(e) + outer.get(i, 0) for i, e in enumerate(monomial)]
            turns, exponents[unit] = exponents[unit] % 4, 0
            key, number = self._key(exponents)
            term = key, bool(turns % 2)
            sign = -1 if turns >= SQUARE else 1
            terms[term] = terms.get(term, Fraction(0)) + sign * number * int(coefficient) * common.unit
        return {key: value for key, value in terms.items() if value}

    def _key(self, exponents: Sequence[int]) -> tuple[Key, Fraction]:
        g, number, key = self.ground, Fraction(1), []
        for name, exponent in zip(self.ring.names, exponents, strict=True):
            if not exponent:
                continue
            if name == HOLE or name.startswith(("exp(", "cos(", "sin(")):
                raise UnreadError("the argument of a function contains another function of s")
            if name.startswith("root("):
                integer, remainder = divmod(exponent, g.order)
                number *= Fraction(int(name[5:-1])) ** integer
                if remainder:
                    key.append((name, Fraction(remainder, g.order)))
            elif name in g.names and name not in g.rootable:
                key.append((name, Fraction(exponent)))
            else:
                key.append((name, Fraction(exponent, g.order)))
        return tuple(key), number

    @cached_property
    def _relations(self) -> tuple[tuple[int, int, Factored], ...]:
        """Position, power, and what the power is equal to."""
        g, index = self.ground, self.ring.index
        # A sum may contain roots of earlier ones, and all hold roots of primes.
        sums = reversed(list(enumerate(g.sums)))
        relations = [(index[f"sum({i})"], g.order, self.from_recipe(recipe)) for i, recipe in sums]
        relations += [(index[f"root({p})"], g.order, self.number(p)) for p in g.primes]
        relations.append((index[UNIT], 2, self.number(-1)))
        for i in range(len(g.waves)):
            c = self.ring.generator(f"cos({i})")
            relations.append((index[f"sin({i})"], 2, Factored.polynomial(self.ring, 1 - c * c)))
        return tuple(relations)

    def reduce(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return the normal form of a polynomial."""
        for index, power, image in self._relations:
            polynomial, _ = with_image(self.ring, polynomial, index, image, power)
        return polynomial

    def reduced(self, value: Factored) -> Factored:
        """Return a value with every factor in normal form; ZeroDivisionError when a denominator is zero."""
        result = self.number(value.unit)
        for factor, exponent in value.factors:
            image = Factored.polynomial(self.ring, self.reduce(factor))
            if image.is_zero and exponent < 0:
                raise ZeroDivisionError
            result = result * image**exponent
        return result

    def is_zero(self, value: Factored) -> bool:
        """Decide whether a value is zero."""
        return value.is_zero or any(self.reduce(f).is_zero() for f, e in value.factors if e > 0)

    def equal(self, left: Factored, right: Factored) -> bool:
        """Decide whether two values are the same function."""
        return self.is_zero(left - right)

    def constant_ratio(self, left: Factored, right: Factored) -> Factored | None:
        """Return ``left / right`` when it is a number times powers of s and the parameters."""
        ratio = left / right
        above, below = self.reduce(ratio.numerator().expand()), self.reduce(ratio.denominator().expand())
        leading = Fraction(int(above.leading_coefficient()), int(below.leading_coefficient()))
        candidate = Factored.number(self.ring, leading)
        for name, n, m in zip(self.ring.names, above.monoms()[0], below.monoms()[0], strict=True):
            if int(n) != int(m):
                if name.startswith(("exp(", "cos(", "sin(", HOLE)):
                    return None
                candidate = candidate * Factored.generator(self.ring, name) ** (int(n) - int(m))
        return candidate if self.equal(left, right * candidate) else None

    def depends_on_functions(self, value: Factored) -> bool:
        """Tell whether exponentials or trigonometric functions occur."""
        first = self.ring.index.get("exp(0)", len(self.ring.names))
        return any(any(map(int, f.degrees()[first:])) for f, _ in value.factors)


def _recipe_of_plain(names: Sequence[str], part: fmpz_mpoly) -> Recipe:
    terms = []
    for monomial, coefficient in part.terms():
        key = tuple((n, Fraction(int(e))) for n, e in zip(names, monomial, strict=True) if int(e))
        terms.append((key, int(coefficient)))
    return tuple(sorted(terms))


def ground_of(parameters: Sequence[tuple[str, bool]]) -> Ground:
    """Return the ground of a model's parameters, each with whether it is positive."""
    names = (LAPLACE, *(n for n, _ in parameters), "pi")
    return Ground(names, frozenset({LAPLACE, "pi", *(n for n, positive in parameters if positive)}))


def _primes(number: int) -> list[tuple[int, int]]:
    """Return the prime factors of a number; what has no small ones stays together."""
    primes, remaining, candidate = [], number, 2
    while candidate <= LARGEST_PRIME and candidate * candidate <= remaining:
        times = 0
        while remaining % candidate == 0:
            remaining, times = remaining // candidate, times + 1
        if times:
            primes.append((candidate, times))
        candidate += 1
    if remaining.bit_length() > LARGEST_COFACTOR_BITS:
        raise UnreadError("it takes the root of a large number")
    return [*primes, (remaining, 1)] if remaining > 1 else primes
