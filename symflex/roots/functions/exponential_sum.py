"""Polynomials in kernels as sums of exponentials: ``sum(c_k(s) exp(lambda_k(s)))``.

In most of the s plane one of the exponentials is far larger than all others. Taken out, it leaves a function
that hardly changes, however fast the whole one turns.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import comb, inf
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb

from symflex.transfer.enclose_kernels import power_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Factored, KernelTable, Ring
    from symflex.transfer.balls import Value
    from symflex.transfer.enclose_kernels import KernelValues

MOST_EXPONENTIALS = 1500
NOTHING = -1
Combination = tuple[tuple[int, acb], ...]
"""Positions of arguments, and what they are multiplied with."""


@dataclass(frozen=True, slots=True, eq=False)
class Argument:
    """What an exponential is taken of, but for a factor.

    Parameters
    ----------
    wavenumber : str
        Generator; empty for the decay all solutions of an equation share.
    rate : Factored
        The shift of a decay; not used for a wavenumber.
    length : Factored
        [m], for a delay [s].
    """

    wavenumber: str
    rate: Factored
    length: Factored


@dataclass(frozen=True, slots=True)
class Exponential:
    """One term ``(re + j im)/2^halvings * exp(sum((a + j b) x))``.

    Parameters
    ----------
    powers : tuple of (int, int, int)
        Position of the argument x, a and b.
    re, im : fmpz_mpoly
        In s, constants and wavenumbers; of the ring of kernels.
    halvings : int
        What both are divided by.
    """

    powers: tuple[tuple[int, int, int], ...]
    re: fmpz_mpoly
    im: fmpz_mpoly
    halvings: int


@dataclass(frozen=True, eq=False)
class ExponentialSum:
    """A polynomial in kernels.

    Parameters
    ----------
    arguments : tuple of Argument
        Shared by all polynomials over the ring.
    terms : tuple of Exponential
        What is summed.
    """

    arguments: tuple[Argument, ...]
    terms: tuple[Exponential, ...]

    _known: dict[int, tuple[Combination, ...]] = field(default_factory=dict, repr=False)

    @cached_property
    def combinations(self) -> tuple[dict[int, complex], ...]:
        """The exponent of every term: positions of arguments, and what they are multiplied with."""
        return tuple({i: complex(a, b) for i, a, b in term.powers} for term in self.terms)

    def exponents(self, less: int = NOTHING) -> tuple[Combination, ...]:
        """Return the exponents of all terms, less that of one of them, as combinations of the arguments."""
        if less not in self._known:
            own = {} if less == NOTHING else self.combinations[less]
            found = []
            for each in self.combinations:
                factors = {i: each.get(i, 0) - own.get(i, 0) for i in {**each, **own}}
                found.append(tuple((i, acb(f.real, f.imag)) for i, f in sorted(factors.items()) if f))
            self._known[less] = tuple(found)
        return self._known[less]


Amplitude = tuple[tuple[acb, tuple[tuple[str, int], ...]], ...]
"""Terms of a polynomial in s and wavenumbers: a number, and what it is multiplied with."""


@dataclass(frozen=True, eq=False)
class ExponentialValues:
    """Evaluates sums of exponentials at one precision.

    Parameters
    ----------
    evaluator : KernelValues
        Of the ring of kernels.
    arguments : tuple of Argument
        Of all sums.
    sums : tuple of (ExponentialSum, int)
        Factors and their exponents.
    """

    evaluator: KernelValues
    arguments: tuple[Argument, ...]
    sums: tuple[tuple[ExponentialSum, int], ...]

    @cached_property
    def coefficients(self) -> tuple[tuple[Amplitude, ...], ...]:
        """Per sum the coefficients of its terms."""
        return tuple(
            tuple(self.amplitude(term.re, term.im, term.halvings) for term in terms.terms)
            for terms, _ in self.sums
        )

    def amplitude(self, re: fmpz_mpoly, im: fmpz_mpoly | None = None, halvings: int = 0) -> Amplitude:
        """Return ``(re + j im)/2^halvings`` with the values of all constants in place."""
        evaluator = self.evaluator
        varying = {0, *(evaluator.names.index(name) for name in evaluator.table.wavenumbers)}
        numbers: dict[tuple[tuple[str, int], ...], acb] = {}
        for polynomial, unit in ((re, acb(1)), (im, acb(0, 1))):
            for monomial, coefficient in () if polynomial is None else polynomial.terms():
                number = unit * arb(int(coefficient)) * arb(2) ** -halvings
                moving = []
                for i, e in enumerate(monomial):
                    if e and i in varying:
                        moving.append((evaluator.names[i], int(e)))
                    elif e:
                        number = number * acb(evaluator.constants[evaluator.names[i]]) ** int(e)
                key = tuple(moving)
                numbers[key] = numbers.get(key, acb(0)) + number
        return tuple((number, key) for key, number in numbers.items())

    @cached_property
    def lengths(self) -> tuple[acb, ...]:
        """Of the arguments [m], for delays [s]."""
        values = {"s": acb(1), **{n: acb(c) for n, c in self.evaluator.constants.items()}}
        return tuple(_number(self.evaluator.value(a.length, values)) for a in self.arguments)

    def at(self, s: Value, near: Place | None = None) -> Place:
        """Return what sums are made of at a point or on a ball, or as series about these.

        Parameters
        ----------
        s : acb or acb_series
            Where.
        near : Place, optional
            A ball that holds it: wavenumbers take the same branch.
        """
        values = self.evaluator.generators_at(s, None if near is None else near.values)
        arguments = []
        for argument, length in zip(self.arguments, self.lengths, strict=True):
            rate = (
                values[argument.wavenumber]
                if argument.wavenumber
                else -self.evaluator.value(argument.rate, values)
            )
            arguments.append(rate * length)
        return Place(values, arguments)

    def amplitudes(self, number: int, place: Place) -> list[Value]:
        """Return the coefficients of all terms of one sum."""
        known = place.amplitudes.get(number)
        if known is not None:
            return known
        found = []
        products = place.products
        for amplitude in self.coefficients[number]:
            total: Value | None = None
            for coefficient, powers in amplitude:
                value = products.get(powers)
                if value is None:
                    value = products[powers] = self._product(powers, place)
                term = coefficient * value
                total = term if total is None else total + term
            found.append(acb(0) if total is None else total)
        place.amplitudes[number] = found
        return found

    def _product(self, powers: tuple[tuple[str, int], ...], place: Place) -> Value:
        total: Value = acb(1)
        for name, e in powers:
            total = total * power_of(place.values[name], e)
        return total

    def exponents(self, number: int, place: Place, less: int = NOTHING) -> list[Value | None]:
        """Return the exponents of all terms of one sum, less that of one of them; ``None`` for 0."""
        found: list[Value | None] = []
        for factors in self.sums[number][0].exponents(less):
            total: Value | None = None
            for i, factor in factors:
                term = place.arguments[i] * factor
                total = term if total is None else total + term
            found.append(total)
        return found

    def value(self, number: int, place: Place, less: int = NOTHING) -> Value:
        """Return one sum, or the sum divided by the exponential of one of its terms."""
        total: Value = acb(0)
        amplitudes, exponents = self.amplitudes(number, place), self.exponents(number, place, less)
        for amplitude, exponent in zip(amplitudes, exponents, strict=True):
            total = total + (amplitude if exponent is None else amplitude * exponent.exp())
        return total

    def largest(self, number: int, place: Place) -> int:
        """Return which term of a sum is the largest in the middle of a ball."""
        sizes = []
        amplitudes, exponents = self.amplitudes(number, place), self.exponents(number, place)
        for i, (amplitude, exponent) in enumerate(zip(amplitudes, exponents, strict=True)):
            size = abs(_number(amplitude).mid())
            growth = 0.0 if exponent is None else float(_number(exponent).real.mid())
            sizes.append((growth + float(size.log()) if size > 0 else -inf, -i))
        return -max(sizes)[1]


@dataclass(frozen=True, slots=True)
class Place:
    """What sums are made of at one place.

    Parameters
    ----------
    values : mapping of str to acb or acb_series
        Of s, constants and wavenumbers.
    arguments : sequence of acb or acb_series
        Of the exponentials.
    products, amplitudes : dict
        What is known already of products of generators, and of sums.
    """

    values: Mapping[str, Value]
    arguments: Sequence[Value]
    products: dict[tuple[tuple[str, int], ...], Value] = field(default_factory=dict)
    amplitudes: dict[int, list[Value]] = field(default_factory=dict)


def _number(value: Value) -> acb:
    return value[0] if isinstance(value, acb_series) else value


def arguments_of(table: KernelTable) -> tuple[Argument, ...] | None:
    """Return the arguments of all kernels, ``None`` where some have no formula."""
    found: dict[tuple[str, int, int], Argument] = {}
    for kernel in table.kernels:
        if kernel.function == "fundamental":
            return None
        shift = kernel.dispersion.shift
        found.setdefault(
            (kernel.wavenumber, id(shift) if not kernel.wavenumber else 0, id(kernel.length)),
            Argument(kernel.wavenumber, shift, kernel.length),
        )
    return tuple(found.values())


def exponential_sum(
    ring: Ring, table: KernelTable, arguments: Sequence[Argument], polynomial: fmpz_mpoly
) -> ExponentialSum | None:
    """Return a polynomial in kernels as a sum of exponentials, ``None`` where these are too many."""
    places = _places(ring, table, arguments)
    collected: dict[tuple[tuple[int, int, int], ...], dict[tuple[tuple[int, ...], int], int]] = {}
    halved = [i for i, (function, _) in places.items() if function != "exp"]
    degree = max((sum(int(m[i]) for i in halved) for m in polynomial.monoms()), default=0)
    for monomial, coefficient in polynomial.terms():
        exponents = [int(e) for e in monomial]
        by_argument: dict[int, dict[str, int]] = {}
        own = 0
        for i, (function, argument) in places.items():
            if exponents[i]:
                by_argument.setdefault(argument, {})[function] = exponents[i]
                own += exponents[i] if function != "exp" else 0
            exponents[i] = 0
        rest = tuple(exponents)
        number = int(coefficient) << (degree - own)
        parts = [[(x, *piece) for piece in _expanded(powers)] for x, powers in by_argument.items()]
        for chosen in product(*parts):
            factor, turns = number, 0
            key = []
            for argument, a, b, weight, quarter in chosen:
                factor *= weight
                turns += quarter
                if a or b:
                    key.append((argument, a, b))
            terms = collected.setdefault(tuple(sorted(key)), {})
            place = (rest, turns % 2)
            sign = -1 if turns % 4 > 1 else 1
            terms[place] = terms.get(place, 0) + sign * factor
        if len(collected) > MOST_EXPONENTIALS:
            return None
    found = []
    for powers_of_term, terms in collected.items():
        re = ring.context.from_dict({m: n for (m, odd), n in terms.items() if not odd and n})
        im = ring.context.from_dict({m: n for (m, odd), n in terms.items() if odd and n})
        if len(re) or len(im):
            found.append(Exponential(powers_of_term, re, im, degree))
    return ExponentialSum(tuple(arguments), tuple(found))


def _places(ring: Ring, table: KernelTable, arguments: Sequence[Argument]) -> dict[int, tuple[str, int]]:
    """Return per position of a kernel's generator its function and its argument."""
    found: dict[int, tuple[str, int]] = {}
    for kernel in table.kernels:
        argument = next(
            i
            for i, a in enumerate(arguments)
            if a.wavenumber == kernel.wavenumber
            and a.length is kernel.length
            and (a.wavenumber or a.rate is kernel.dispersion.shift)
        )
        found[ring.index[kernel.generator]] = (kernel.function, argument)
    return found


def _expanded(powers: Mapping[str, int]) -> Iterator[tuple[int, int, int, int]]:
    """Yield a, b, a number and quarter turns of every exponential in a product of kernels of one argument.

    The product is the sum of ``number * j^turns * exp((a + j b) x)``, over two to the power of its degree.
    """
    decay = powers.get("exp", 0)
    hyperbolic = _spread(powers.get("cosh", 0), powers.get("sinh", 0))
    circular = _spread(powers.get("cos", 0), powers.get("sin", 0))
    # sin x = -j (e^(jx) - e^(-jx))/2
    turns = 3 * powers.get("sin", 0)
    for a, one in hyperbolic.items():
        for b, other in circular.items():
            yield a + decay, b, one * other, turns


def _spread(even: int, odd: int) -> dict[int, int]:
    """Return the coefficients of ``(u + 1/u)^even * (u - 1/u)^odd``."""
    found: dict[int, int] = {}
    for i in range(even + 1):
        for k in range(odd + 1):
            power = even - 2 * i + odd - 2 * k
            found[power] = found.get(power, 0) + comb(even, i) * comb(odd, k) * (-1) ** k
    return {power: number for power, number in found.items() if number}
