"""Functions without losses as functions of x, the square root of s.

Where every wavenumber is a root of a multiple of s^2, those of bending are proportional to x and those of
waves to x^2, and a polynomial in kernels is a sum of ``c(x) exp(p x + q x^2)``. On the real axis of s, x is
t; on the imaginary one it is (1 + j) t, and the sum is real but for a constant factor: growing, decaying and
oscillating terms with real coefficients.
"""

from __future__ import annotations

from cmath import phase, rect
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import exp, pi, sqrt
from typing import TYPE_CHECKING, overload

import numpy as np
import numpy.typing as npt
from flint import acb, arb

from symflex.roots.precision import precision
from symflex.roots.stepping import ROOM, SPREAD, WIDENED, deviation, total_turn

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from symflex.kernels import Dispersion, Factored
    from symflex.roots.exponential_sum import Argument, ExponentialSum
    from symflex.roots.kernel_function import KernelFunction
    from symflex.transfer import BoundTransferFunction
    from symflex.transfer.monomials import Value

FLOAT_BITS = 64
LINEAR, QUADRATIC = 1, 2
LOSSLESS: Mapping[str, int] = {"bending": LINEAR, "wave": QUADRATIC}
"""Power of x that wavenumbers are proportional to, by kind of dispersion."""
ROTATIONS = 8
BESIDE = 0.3
"""How far from the axes the largest terms are looked for, in x."""
REAL, IMAGINARY = 0, 1
FIRST_STEP = 0.5
SHORTEST = 1e-12

Key = tuple[tuple[int, int, int], ...]
"""Positions of arguments, and what they are multiplied with, a + j b."""
Monomial = tuple[tuple[int, int], ...]
"""Positions of constants, and exponents."""
Gaussian = tuple[Fraction, Fraction]
Doubles = npt.NDArray[np.float64]
Exponential = tuple[acb, acb, list[tuple[int, acb]]]
"""Rates of x and of x^2, and the coefficients of powers of x before it."""
Terms = dict[Key, dict[tuple[int, Monomial], Gaussian]]
"""Per exponential, per power of x and monomial of constants, a number."""


def _times(a: Gaussian, b: Gaussian) -> Gaussian:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _plus(a: Gaussian, b: Gaussian) -> Gaussian:
    return a[0] + b[0], a[1] + b[1]


def _unit(axis: int, power: int) -> Gaussian:
    """Return a power of 1, or of 1 + j."""
    unit = (Fraction(1), Fraction(0))
    for _ in range(abs(power) if axis == IMAGINARY else 0):
        unit = _times(unit, (Fraction(1), Fraction(1)))
    if power < 0:
        size = unit[0] ** 2 + unit[1] ** 2
        return unit[0] / size, -unit[1] / size
    return unit


@dataclass(frozen=True, slots=True)
class _Wave:
    """Two real terms of a sum on an axis: of the same growth, and of cosine and sine of the same phase."""

    growth: tuple[int, ...]
    phase: tuple[int, ...]
    even: dict[int, dict[Monomial, Fraction]]
    odd: dict[int, dict[Monomial, Fraction]]


@dataclass(frozen=True, eq=False)
class LosslessFunction:
    """A product of powers of sums of exponentials of x.

    Parameters
    ----------
    factors : tuple of (Terms, int)
        The sums, and their exponents.
    degrees : tuple of int
        Per argument 1 when it is proportional to x, 2 when it is to x^2.
    rates : tuple of callable
        Per argument what that is multiplied with, enclosed at the current precision.
    constants : tuple of callable
        Enclosures of what coefficients hold.
    """

    factors: tuple[tuple[Terms, int], ...]
    degrees: tuple[int, ...]
    rates: tuple[Callable[[], arb], ...]
    constants: tuple[Callable[[], arb], ...]

    def on_axis(self, number: int, axis: int) -> AxisFunction | None:
        """Return one factor as a real function on an axis, ``None`` if it is not real there."""
        turned: Terms = {}
        for key, terms in self.factors[number][0].items():
            new_key = tuple((i, *self._turned(i, (a, b), axis)) for i, a, b in key)
            own = turned.setdefault(new_key, {})
            for (power, monomial), value in terms.items():
                own[power, monomial] = _times(value, _unit(axis, power))
        for rotation in range(ROTATIONS):
            unit = _unit(IMAGINARY, rotation)
            waves = _real_waves(turned, unit, len(self.degrees))
            if waves is not None:
                return AxisFunction(self, waves, axis)
        return None

    def _turned(self, argument: int, factor: tuple[int, int], axis: int) -> tuple[int, int]:
        unit = _unit(axis, self.degrees[argument])
        value = _times((Fraction(factor[0]), Fraction(factor[1])), unit)
        return int(value[0]), int(value[1])

    def turn(self, z: float) -> arb:
        """Return how far arg of the function turns from s = exp(z) to j exp(z), on an arc about 0: proved.

        Raises
        ------
        RootOnPathError
            A root lies on the arc, or too close to it.
        """
        with precision(FLOAT_BITS):
            radius = (arb(z) / 2).exp()
            total = arb(0)
            for i, (_, exponent) in enumerate(self.factors):
                total += exponent * _turn(self._sums[i], radius)
            return total

    def estimate(self, z: float) -> float:
        """Return about how far arg turns on that arc [rad], from the largest terms."""
        with precision(FLOAT_BITS):
            total = 0.0
            radius = exp(z / 2)
            aside = BESIDE / (1 + radius)
            ends = radius * rect(1.0, aside), radius * rect(1.0, pi / 4 - aside)
            for i, (_, exponent) in enumerate(self.factors):
                turned = []
                for x in ends:
                    found = []
                    for p, q, powers in self._sums[i]:
                        value = complex(p) * x + complex(q) * x * x
                        n, c = max(powers, key=lambda power: power[0])
                        found.append((value.real + n * z / 2, value.imag + n * phase(x) + phase(complex(c))))
                    turned.append(max(found)[1])
                total += exponent * (turned[1] - turned[0])
            return total

    @cached_property
    def _sums(self) -> tuple[list[Exponential], ...]:
        """Per factor the rates of x and x^2 and the coefficients of every exponential, in balls."""
        with precision(FLOAT_BITS):
            constants = [c() for c in self.constants]
            rates = [r() for r in self.rates]
            return tuple(
                [self._exponential(*item, rates, constants) for item in f.items()] for f, _ in self.factors
            )

    def _exponential(
        self,
        key: Key,
        terms: dict[tuple[int, Monomial], Gaussian],
        rates: Sequence[arb],
        constants: Sequence[arb],
    ) -> Exponential:
        linear, square = acb(0), acb(0)
        for i, a, b in key:
            if self.degrees[i] == LINEAR:
                linear += acb(a, b) * rates[i]
            else:
                square += acb(a, b) * rates[i]
        powers: dict[int, acb] = {}
        for (power, monomial), (re, im) in terms.items():
            number = acb(_ball(re), _ball(im)) * _product(monomial, constants)
            powers[power] = powers.get(power, acb(0)) + number
        return linear, square, sorted(powers.items())


def _ball(value: Fraction) -> arb:
    return arb(value.numerator) / value.denominator


def _product(monomial: Monomial, constants: Sequence[arb]) -> arb:
    total = arb(1)
    for i, e in monomial:
        total *= constants[i] ** e
    return total


def _turn(terms: Sequence[Exponential], radius: arb) -> arb:
    """Return how far the argument of a sum of exponentials turns on the arc of x from 0 to 45 degrees."""
    slopes = [(complex(p), complex(q)) for p, q, _ in terms]
    sizes = [max((float(abs(c.mid()).log()), n) for n, c in powers) for _, _, powers in terms]
    size, reach = float(radius.log()), float(radius.mid())
    differences: dict[int, list[tuple[acb, acb]]] = {}
    eighth = arb.pi() / 4
    known: dict[tuple[float, int], acb] = {}

    def largest_at(t: float) -> int:
        x = reach * rect(1.0, pi / 4 * t)
        growths = [
            (p * x + q * x * x).real + c + n * size for (p, q), (c, n) in zip(slopes, sizes, strict=True)
        ]
        return growths.index(max(growths))

    def ratio(x: acb, largest: int) -> acb:
        square = x * x
        total = acb(0)
        for i, (p, q) in enumerate(differences[largest]):
            amplitude = acb(0)
            for n, c in terms[i][2]:
                amplitude += c if n == 0 else c * x**n
            total += amplitude if i == largest else amplitude * (p * x + q * square).exp()
        return total

    def ratio_at(t: float, x: acb, largest: int) -> acb:
        if (t, largest) not in known:
            known[t, largest] = ratio(x, largest)
        return known[t, largest]

    def change(start: float, end: float) -> tuple[float, arb]:
        middle, half = (start + end) / 2, (end - start) / 2
        largest = largest_at(middle)
        p, q, _ = terms[largest]
        if largest not in differences:
            differences[largest] = [(own_p - p, own_q - q) for own_p, own_q, _ in terms]
        ball = radius * acb(0, eighth * arb(middle, half * WIDENED + SPREAD)).exp()
        off = deviation(ratio(ball, largest))
        if off > ROOM:
            return off, arb(0)
        here, there = (radius * acb(0, eighth * t).exp() for t in (start, end))
        turned = ratio_at(end, there, largest) / ratio_at(start, here, largest)
        leading = p * (there - here) + q * (there * there - here * here)
        return off, leading.imag + turned.arg()

    return total_turn(change, FIRST_STEP, SHORTEST)


def _real_waves(turned: Terms, unit: Gaussian, arguments: int) -> tuple[_Wave, ...] | None:
    """Return real terms, if all complex ones times a unit come in conjugate pairs."""
    found: dict[tuple[tuple[int, ...], tuple[int, ...]], dict[tuple[int, Monomial], Gaussian]] = {}
    for key, terms in turned.items():
        growth, phase = [0] * arguments, [0] * arguments
        for i, a, b in key:
            growth[i], phase[i] = growth[i] + a, phase[i] + b
        own = found.setdefault((tuple(growth), tuple(phase)), {})
        for place, value in terms.items():
            own[place] = _plus(own.get(place, (Fraction(0), Fraction(0))), _times(value, unit))
    waves = []
    done: set[tuple[tuple[int, ...], tuple[int, ...]]] = set()
    for place_of, own in found.items():
        if place_of in done:
            continue
        growing, turning = place_of
        opposite = tuple(-p for p in turning)
        other = found.get((growing, opposite), {})
        done |= {place_of, (growing, opposite)}
        places = {*own, *other}
        zero = (Fraction(0), Fraction(0))
        if any(own.get(p, zero) != (other.get(p, zero)[0], -other.get(p, zero)[1]) for p in places):
            return None
        is_pair = opposite != turning
        weight = 1 + is_pair
        even: dict[int, dict[Monomial, Fraction]] = {}
        odd: dict[int, dict[Monomial, Fraction]] = {}
        for (power, monomial), (re, im) in own.items():
            if re:
                even.setdefault(power, {})[monomial] = weight * re
            if im and is_pair:
                odd.setdefault(power, {})[monomial] = -weight * im
        if turning < opposite:
            # One sign of every phase, so that sines and cosines are made once.
            odd = {n: {m: -v for m, v in o.items()} for n, o in odd.items()}
        if even or odd:
            waves.append(_Wave(growing, max(turning, opposite), even, odd))
    return tuple(waves)


@dataclass(frozen=True, eq=False)
class AxisFunction:
    """A real function of t, on the real axis with ``s = t^2``, on the imaginary one with ``s = 2 j t^2``.

    Parameters
    ----------
    function : LosslessFunction
        Where it comes from.
    waves : tuple
        Its terms.
    axis : int
        0 real, 1 imaginary.
    """

    function: LosslessFunction
    waves: tuple[_Wave, ...]
    axis: int

    @overload
    def natural_frequency(self, t: arb) -> arb: ...
    @overload
    def natural_frequency(self, t: float) -> float: ...
    def natural_frequency(self, t: arb | float) -> arb | float:
        """Return abs(s)."""
        return t * t if self.axis == REAL else 2 * t * t

    def at_frequency(self, frequency: float) -> float:
        """Return t at an abs(s)."""
        return sqrt(frequency if self.axis == REAL else frequency / 2)

    @cached_property
    def _levels(self) -> dict[int, _Level]:
        return {}

    def _level(self, bits: int) -> _Level:
        if bits not in self._levels:
            with precision(bits):
                self._levels[bits] = _Level(self)
        return self._levels[bits]

    def value(self, t: arb, bits: int) -> arb:
        """Return a ball around the values on a ball of t."""
        level = self._level(bits)
        with precision(bits):
            return level.sum(t, level.values)

    def slope(self, t: arb, bits: int) -> arb:
        """Return a ball around the derivatives on a ball of t."""
        level = self._level(bits)
        with precision(bits):
            return level.sum(t, level.slopes)

    def sampled(self, t: Doubles) -> tuple[Doubles, Doubles, Doubles]:
        """Return values, derivatives, and the sizes of what is summed, all scaled alike, in doubles."""
        return self._level(FLOAT_BITS).sampled(t)

    def fastest(self, t: float) -> float:
        """Return the largest rate of any phase [rad per unit of t]."""
        phases = self._level(FLOAT_BITS).float_phases
        return max((abs(p + 2 * q * t) for p, q in phases), default=0.0)


RealTerm = tuple[int, int, list[tuple[int, arb]], list[tuple[int, arb]]]
"""Positions of growth and phase, and the polynomials before cosine and sine."""


class _Level:
    """The numbers of one function at one precision."""

    def __init__(self, source: AxisFunction) -> None:
        owner = source.function
        constants = [c() for c in owner.constants]
        rates = [r() for r in owner.rates]

        def rate(key: tuple[int, ...]) -> tuple[arb, arb]:
            linear, square = arb(0), arb(0)
            for k, value, degree in zip(key, rates, owner.degrees, strict=True):
                if degree == LINEAR:
                    linear += k * value
                else:
                    square += k * value
            return linear, square

        def polynomial(powers: dict[int, dict[Monomial, Fraction]]) -> dict[int, arb]:
            return {
                n: sum((_ball(v) * _product(m, constants) for m, v in own.items()), arb(0))
                for n, own in powers.items()
            }

        growths: dict[tuple[int, ...], int] = {}
        phases: dict[tuple[int, ...], int] = {}
        self.values: list[RealTerm] = []
        self.slopes: list[RealTerm] = []
        for wave in source.waves:
            g = growths.setdefault(wave.growth, len(growths))
            p = phases.setdefault(wave.phase, len(phases))
            even, odd = polynomial(wave.even), polynomial(wave.odd)
            growing, turning = rate(wave.growth), rate(wave.phase)
            self.values.append((g, p, sorted(even.items()), sorted(odd.items())))
            even_slope = _sum(_derived(even), _by(even, growing), _by(odd, turning))
            minus = (-turning[0], -turning[1])
            odd_slope = _sum(_derived(odd), _by(odd, growing), _by(even, minus))
            self.slopes.append((g, p, sorted(even_slope.items()), sorted(odd_slope.items())))
        self.growths = [rate(key) for key in growths]
        opposite = {key: growths.get(tuple(-k for k in key), -1) for key in growths}
        self._inverse = [opposite[key] if 0 <= opposite[key] < i else -1 for key, i in growths.items()]
        self.phases = [rate(key) for key in phases]
        self.float_growths = [(float(p), float(q)) for p, q in self.growths]
        self.float_phases = [(float(p), float(q)) for p, q in self.phases]
        self._float_values = [_floats(term) for term in self.values]
        self._float_slopes = [_floats(term) for term in self.slopes]
        self._has_squares = any(degree != LINEAR for degree in owner.degrees)

    def sum(self, t: arb, terms: list[RealTerm]) -> arb:
        """Return a sum at a ball of t."""
        square = t * t if self._has_squares else None
        growths: list[arb] = []
        for (p, q), inverse in zip(self.growths, self._inverse, strict=True):
            if inverse >= 0:
                growths.append(1 / growths[inverse])
            else:
                growths.append((p * t if square is None else p * t + q * square).exp())
        turns = [(p * t if square is None else p * t + q * square).sin_cos() for p, q in self.phases]
        total = arb(0)
        for g, turn, even, odd in terms:
            sine, cosine = turns[turn]
            own = arb(0)
            for n, c in even:
                own += (c * t**n if n else c) * cosine
            for n, c in odd:
                own += (c * t**n if n else c) * sine
            total += own * growths[g]
        return total

    def sampled(self, t: Doubles) -> tuple[Doubles, Doubles, Doubles]:
        """Return values, derivatives, and sizes of what is summed."""
        exponents = [p * t + q * t * t for p, q in self.float_growths]
        highest = np.maximum.reduce(exponents)
        growths = [np.exp(e - highest) for e in exponents]
        turns = [(np.sin(p * t + q * t * t), np.cos(p * t + q * t * t)) for p, q in self.float_phases]
        found = []
        size = np.zeros_like(t)
        for terms in (self._float_values, self._float_slopes):
            total = np.zeros_like(t)
            for g, p, even, odd in terms:
                sine, cosine = turns[p]
                for weights, wave in ((even, cosine), (odd, sine)):
                    for n, c in weights:
                        term = c * t**n * growths[g] * wave
                        total += term
                        if terms is self._float_values:
                            size += np.abs(term)
            found.append(total)
        return found[0], found[1], size


def _derived(polynomial: dict[int, arb]) -> dict[int, arb]:
    return {n - 1: n * c for n, c in polynomial.items() if n}


def _by(polynomial: dict[int, arb], rate: tuple[arb, arb]) -> dict[int, arb]:
    """Return a polynomial times the derivative of ``p t + q t^2``."""
    found: dict[int, arb] = {}
    for n, c in polynomial.items():
        for power, factor in ((n, rate[0]), (n + 1, 2 * rate[1])):
            if factor != 0:
                found[power] = found.get(power, arb(0)) + c * factor
    return found


def _sum(*polynomials: dict[int, arb]) -> dict[int, arb]:
    found: dict[int, arb] = {}
    for polynomial in polynomials:
        for n, c in polynomial.items():
            found[n] = found.get(n, arb(0)) + c
    return found


def _floats(
    term: RealTerm,
) -> tuple[int, int, list[tuple[int, float]], list[tuple[int, float]]]:
    g, p, even, odd = term
    return g, p, [(n, float(c)) for n, c in even], [(n, float(c)) for n, c in odd]


def lossless_function(function: KernelFunction) -> LosslessFunction | None:
    """Return a function of x, ``None`` where there are losses, delays or wavenumbers of another law."""
    sums = function.exponentials
    if sums is None:
        return None
    bound = function.bound
    ring = bound.ratio.ring
    constants: list[Callable[[], arb]] = []
    position: dict[int, tuple[int, int]] = {}
    for name, evaluate in bound.constants:
        position[ring.index[name]] = (len(constants), 0)
        constants.append(evaluate)
    degrees, rates = [], []
    for argument in function.arguments:
        law = _law_of(bound, argument)
        rate = None if law is None else _rate(bound, law)
        if law is None or rate is None:
            return None
        degree = LOSSLESS[law.kind]
        index = ring.index[argument.wavenumber]
        if index not in position:
            position[index] = (len(constants), degree)
            constants.append(rate)
        length = argument.length
        degrees.append(degree)
        rates.append(_times_length(bound, rate, length))
    for law in bound.kernels.dispersions:
        for name in law.wavenumbers:
            used = any(f.degrees()[ring.index[name]] for f, _ in function.part.factors)
            if ring.index[name] not in position and used:
                return None
    factors = tuple((_terms(terms, position), exponent) for terms, exponent in sums)
    return LosslessFunction(factors, tuple(degrees), tuple(rates), tuple(constants))


def _law_of(bound: BoundTransferFunction, argument: Argument) -> Dispersion | None:
    laws = (law for law in bound.kernels.dispersions if argument.wavenumber in law.wavenumbers)
    return next((law for law in laws if law.kind in LOSSLESS and law.shift.is_zero), None)


def _rate(bound: BoundTransferFunction, law: Dispersion) -> Callable[[], arb] | None:
    """Return what x or x^2 is multiplied with in the wavenumber, ``None`` where that is not real."""
    first, *others = law.characteristic
    s = bound.ratio.ring.context.gen(0)
    below = first.filter(lambda factor: factor == s)
    rest = first / below
    if (
        any(not other.is_zero for other in others)
        or first.exponent_of(s) != QUADRATIC
        or rest.depends_on("s")
    ):
        return None
    sign = -1 if law.kind == "wave" else 1

    def evaluate() -> arb:
        size = sign * _real_value(bound, rest)
        return size.sqrt() if law.kind == "wave" else (size / 4).sqrt().sqrt()

    with precision(FLOAT_BITS):
        return evaluate if evaluate().is_finite() and evaluate() > 0 else None


def _times_length(
    bound: BoundTransferFunction, rate: Callable[[], arb], length: Factored
) -> Callable[[], arb]:
    def evaluate() -> arb:
        return rate() * _real_value(bound, length)

    return evaluate


def _real_value(bound: BoundTransferFunction, value: Factored) -> arb:
    """Return what does not depend on s."""
    constants = {name: each() for name, each in bound.constants}
    places: dict[str, Value] = {"s": acb(1), **{name: acb(c) for name, c in constants.items()}}
    number = bound.kernel_values(constants).value(value, places)
    return (number if isinstance(number, acb) else number[0]).real


def _terms(terms: ExponentialSum, position: Mapping[int, tuple[int, int]]) -> Terms:
    found: Terms = {}
    for term in terms.terms:
        own = found.setdefault(tuple(sorted(term.powers)), {})
        for polynomial, unit in ((term.re, (1, 0)), (term.im, (0, 1))):
            for monomial, coefficient in polynomial.terms():
                power, constants = 2 * int(monomial[0]), []
                for i, e in enumerate(monomial):
                    if i and e:
                        place, degree = position[i]
                        power += degree * int(e)
                        constants.append((place, int(e)))
                number = Fraction(int(coefficient), 2**term.halvings)
                value = (number * unit[0], number * unit[1])
                place_of = (power, tuple(constants))
                own[place_of] = _plus(own.get(place_of, (Fraction(0), Fraction(0))), value)
    return found
