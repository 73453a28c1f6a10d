"""Sums of exponentials, exact: what polynomials in kernels are when they are multiplied out.

    4 cosh(q) cos(q)  =  e^((1 + j) q) + e^((1 - j) q) + e^((-1 + j) q) + e^((-1 - j) q)

An exponent is a combination of arguments (q is a wavenumber times a length) with Gaussian integers, an
amplitude a polynomial with Gaussian integers over a power of two. What evaluates sums stands where it is
used: in balls and in doubles at any s, on the axes where there is no damping, on arcs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from math import comb
from typing import TypeVar

from flint import acb, fmpz_mpoly

from symflex.algebra.dispersion import Kernel, KernelTable
from symflex.algebra.factored import Factored
from symflex.algebra.ring import Ring

MOST_EXPONENTIALS = 1500  # of a sum that is written out: each is evaluated at every step of every path

Gaussian = tuple[int, int]  # an integer a + j b
Part = TypeVar("Part", int, Fraction)  # the type of a complex number's rational parts
Exponent = tuple[tuple[int, int, int], ...]  # positions of arguments, ascending, and their factors a + j b
Monomial = tuple[tuple[int, int], ...]  # positions of generators, ascending, with exponents; s comes first
Amplitude = dict[Monomial, Gaussian]
Multiples = tuple[int, ...]  # one integer for each argument
Polynomial = dict[int, dict[Monomial, int]]  # a number per power of the first generator and monomial
Combination = tuple[tuple[int, acb], ...]  # positions of arguments, and what they are multiplied with
REAL: Exponent = ()  # the exponent 0


def times(a: tuple[Part, Part], b: tuple[Part, Part]) -> tuple[Part, Part]:
    """Return a product of complex numbers."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def power(a: tuple[Part, Part], n: int) -> tuple[Part, Part]:
    """Return a power that is not negative."""
    kind = type(a[0])
    raised = (kind(1), kind(0))
    for _ in range(n):
        raised = times(raised, a)
    return raised


def _add(amplitude: Amplitude, monomial: Monomial, value: Gaussian) -> None:
    re, im = amplitude.get(monomial, (0, 0))
    amplitude[monomial] = (re + value[0], im + value[1])


def parts(amplitude: Mapping[Monomial, Gaussian]) -> Iterator[tuple[Monomial, Gaussian]]:
    """Yield all real coefficients, then all imaginary ones."""
    yield from ((m, (re, 0)) for m, (re, _) in amplitude.items() if re)
    yield from ((m, (0, im)) for m, (_, im) in amplitude.items() if im)


@dataclass(frozen=True, slots=True, eq=False)
class Argument:
    """What an exponential is taken of, but for a factor."""

    wavenumber: str  # generator; empty for the decay all solutions of an equation share
    rate: Factored  # the shift of a decay; not used for a wavenumber
    length: Factored  # [m], for a delay [s]

    def is_of(self, kernel: Kernel) -> bool:
        """Tell whether a kernel has this argument."""
        same = self.wavenumber == kernel.wavenumber and self.length is kernel.length
        return same and (bool(self.wavenumber) or self.rate is kernel.dispersion.shift)


@dataclass(frozen=True, slots=True)
class AxisWave:
    """Terms ``exp(g) (even(t) cos(p) + odd(t) sin(p))``."""

    growth: Multiples  # growth and phase: multiples of the arguments, which make up g and p
    phase: Multiples
    even: Polynomial  # of the cosine
    odd: Polynomial  # of the sine


@dataclass(frozen=True, eq=False)
class ExponentialSum:
    """A sum of amplitudes times exponentials, over two to a power."""

    terms: Mapping[Exponent, Amplitude]  # what is summed
    halvings: int = 0  # what all amplitudes are divided by two so often

    _known: dict[Exponent, tuple[Combination, ...]] = field(default_factory=dict, repr=False)

    def exponents(self, less: Exponent = REAL) -> tuple[Combination, ...]:
        """Return the exponents of all terms, less another one, as combinations of the arguments."""
        if less not in self._known:
            self._known[less] = tuple(combination(exponent, less) for exponent in self.terms)
        return self._known[less]

    def mapped(self, image: Callable[[Monomial], Monomial]) -> ExponentialSum:
        """Return the sum with other monomials in place of its own; where two become equal, they are added."""
        amplitudes: dict[Exponent, Amplitude] = {}
        for exponent, amplitude in self.terms.items():
            own = amplitudes.setdefault(exponent, {})
            for monomial, value in parts(amplitude):
                _add(own, image(monomial), value)
        return ExponentialSum(amplitudes, self.halvings)

    def turned(self, unit: Gaussian, degrees: Sequence[int]) -> ExponentialSum:
        """Return the sum with ``unit`` times its first generator, given arguments' ``degrees`` in that."""
        amplitudes: dict[Exponent, Amplitude] = {}
        for exponent, amplitude in self.terms.items():
            moved = tuple((i, *times((a, b), power(unit, degrees[i]))) for i, a, b in exponent)
            own = amplitudes.setdefault(moved, {})
            for monomial, value in amplitude.items():
                own[monomial] = times(value, power(unit, _degree(monomial)))
        return ExponentialSum(amplitudes, self.halvings)

    def waves(self, arguments: int) -> tuple[AxisWave, ...] | None:
        """Return real terms, as ``2 e^q cos(q)`` of ``e^((1 +- j) q)``, if all come in conjugate pairs."""
        pairs: dict[tuple[Multiples, Multiples], Amplitude] = {}
        for exponent, amplitude in self.terms.items():
            growth, phase = [0] * arguments, [0] * arguments
            for i, a, b in exponent:
                growth[i], phase[i] = growth[i] + a, phase[i] + b
            own = pairs.setdefault((tuple(growth), tuple(phase)), {})
            for monomial, value in amplitude.items():
                _add(own, monomial, value)
        unit = _unit_that_makes_real(pairs)
        waves = []
        done: set[tuple[Multiples, Multiples]] = set()
        for (growing, turning), own in pairs.items():
            if (growing, turning) in done:
                continue
            opposite = _opposite(turning)
            done |= {(growing, turning), (growing, opposite)}
            here = {m: times(value, unit) for m, value in own.items()}
            other = pairs.get((growing, opposite), {})
            there = {m: _conjugate(times(value, unit)) for m, value in other.items()}
            if any(here.get(m, (0, 0)) != there.get(m, (0, 0)) for m in {*here, *there}):
                return None
            wave = _wave(growing, turning, here)
            if wave.even or wave.odd:
                waves.append(wave)
        return tuple(waves)


def combination(exponent: Exponent, less: Exponent = REAL) -> Combination:
    """Return one exponent less another as a combination of the arguments."""
    factors = {i: complex(a, b) for i, a, b in exponent}
    for i, a, b in less:
        factors[i] = factors.get(i, 0) - complex(a, b)
    return tuple((i, acb(f.real, f.imag)) for i, f in sorted(factors.items()) if f)


def arguments_of(table: KernelTable) -> tuple[Argument, ...] | None:
    """Return the arguments of all kernels, ``None`` if some have no formula."""
    arguments: list[Argument] = []
    for kernel in table.kernels:
        if kernel.function in ("fundamental", "entry"):
            return None
        if not any(argument.is_of(kernel) for argument in arguments):
            arguments.append(Argument(kernel.wavenumber, kernel.dispersion.shift, kernel.length))
    return tuple(arguments)


def exponential_sum(
    ring: Ring, table: KernelTable, arguments: Sequence[Argument], polynomial: fmpz_mpoly
) -> ExponentialSum | None:
    """Return a polynomial in kernels as a sum of exponentials, ``None`` if these are too many."""
    places = {
        ring.index[kernel.generator]: (
            kernel.function,
            next(i for i, argument in enumerate(arguments) if argument.is_of(kernel)),
        )
        for kernel in table.kernels
    }
    collected: dict[Exponent, dict[tuple[int, ...], Gaussian]] = {}
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
        pieces = [[(x, *piece) for piece in expanded(powers)] for x, powers in by_argument.items()]
        for chosen in product(*pieces):
            factor = (number, 0)
            key = []
            for x, a, b, weight in chosen:
                factor = times(factor, weight)
                if a or b:
                    key.append((x, a, b))
            terms = collected.setdefault(tuple(sorted(key)), {})
            re, im = terms.get(rest, (0, 0))
            terms[rest] = (re + factor[0], im + factor[1])
        if len(collected) > MOST_EXPONENTIALS:
            return None
    # Descending, as in the ring, so that sums of balls are the same on every way here.
    amplitudes = {
        exponent: {
            tuple((i, int(e)) for i, e in enumerate(m) if e): terms[m]
            for m in sorted(terms, reverse=True)
            if any(terms[m])
        }
        for exponent, terms in collected.items()
    }
    return ExponentialSum({exponent: own for exponent, own in amplitudes.items() if own}, degree)


def expanded(powers: Mapping[str, int]) -> Iterator[tuple[int, int, Gaussian]]:
    """Yield a, b and coefficient of each exponential of kernels of one argument, over 2 to the degree."""
    decay = powers.get("exp", 0)
    hyperbolic = spread(powers.get("cosh", 0), powers.get("sinh", 0))
    circular = spread(powers.get("cos", 0), powers.get("sin", 0))
    # sin x = -j (e^(jx) - e^(-jx))/2
    turns = power((0, -1), powers.get("sin", 0))
    for a, one in hyperbolic.items():
        for b, other in circular.items():
            yield a + decay, b, times((one * other, 0), turns)


def spread(even: int, odd: int) -> dict[int, int]:
    """Return the coefficients of ``(u + 1/u)^even * (u - 1/u)^odd`` by powers of u.

    >>> spread(1, 2)
    {3: 1, 1: -1, -1: -1, -3: 1}
    """
    binomials: dict[int, int] = {}
    for i in range(even + 1):
        for k in range(odd + 1):
            exponent = even - 2 * i + odd - 2 * k
            binomials[exponent] = binomials.get(exponent, 0) + comb(even, i) * comb(odd, k) * (-1) ** k
    return {exponent: number for exponent, number in binomials.items() if number}


def _degree(monomial: Monomial) -> int:
    return monomial[0][1] if monomial and monomial[0][0] == 0 else 0


def _opposite(multiples: Multiples) -> Multiples:
    return tuple(-n for n in multiples)


def _conjugate(a: Gaussian) -> Gaussian:
    return a[0], -a[1]


def _unit_that_makes_real(pairs: Mapping[tuple[Multiples, Multiples], Amplitude]) -> Gaussian:
    """Return a power of 1 + j by which the first pair becomes conjugate, if any does."""
    for (growing, turning), own in pairs.items():
        other = pairs.get((growing, _opposite(turning)), {})
        for monomial, value in own.items():
            for eighths in range(4):
                unit = power((1, 1), eighths)
                there = times(other.get(monomial, (0, 0)), unit)
                if any(value) and times(value, unit) == _conjugate(there):
                    return unit
    return 1, 0


def _wave(growth: Multiples, phase: Multiples, amplitude: Amplitude) -> AxisWave:
    """Return one of two conjugate exponentials and the other as cosine and sine of a phase of one sign."""
    opposite = _opposite(phase)
    weight = 1 + (opposite != phase)
    sign = -1 if phase > opposite else 1
    even: Polynomial = {}
    odd: Polynomial = {}
    for monomial, (re, im) in amplitude.items():
        degree = _degree(monomial)
        others = tuple((i - 1, e) for i, e in monomial if i)
        if re:
            even.setdefault(degree, {})[others] = weight * re
        if im and opposite != phase:
            odd.setdefault(degree, {})[others] = weight * sign * im
    return AxisWave(growth, max(phase, opposite), even, odd)
