"""Functions without losses as functions of x, the square root of s.

Where every wavenumber is a root of a multiple of s^2, those of bending are proportional to x and those of
waves to x^2, and a polynomial in kernels is a sum of ``c(x) exp(p x + q x^2)``. On the real axis of s, x is
t; on the imaginary one it is (1 + j) t, and the sum is real but for a constant factor: growing, decaying and
oscillating terms with real coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, isfinite
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.roots.axes.arc_sum import ArcSum, ArcTerm
from symflex.roots.axes.axis_function import (
    FLOAT_BITS,
    IMAGINARY,
    LINEAR,
    QUADRATIC,
    AxisFunction,
    AxisWave,
    Enclosures,
    Monomial,
    Multiples,
    Polynomial,
)
from symflex.roots.precision import precision

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.algebra import Factored
    from symflex.roots.functions.exponential_sum import Argument, ExponentialSum
    from symflex.roots.functions.kernel_function import KernelFunction
    from symflex.transfer import BoundTransferFunction
    from symflex.transfer.balls import Value

LOSSLESS: Mapping[str, int] = {"bending": LINEAR, "wave": QUADRATIC}
"""Power of x that wavenumbers are proportional to, by kind of dispersion."""
QUARTERS = 4

Key = tuple[tuple[int, int, int], ...]
"""Positions of arguments, and what they are multiplied with, a + j b."""
Gaussian = tuple[int, int]
"""An integer a + j b."""
Place = tuple[int, Monomial]
"""A power of x, and a product of constants."""
Terms = dict[Key, dict[Place, Gaussian]]
"""Per exponential, what it is multiplied with; all times the same power of two."""


def _times(a: Gaussian, b: Gaussian) -> Gaussian:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _plus(a: Gaussian, b: Gaussian) -> Gaussian:
    return a[0] + b[0], a[1] + b[1]


def _conjugate(a: Gaussian) -> Gaussian:
    return a[0], -a[1]


def _unit(axis: int, power: int) -> Gaussian:
    """Return a power of 1, or of 1 + j."""
    unit = (1, 0)
    for _ in range(power if axis == IMAGINARY else 0):
        unit = _times(unit, (1, 1))
    return unit


@dataclass(frozen=True, eq=False)
class LosslessFunction:
    """A product of powers of sums of exponentials of x.

    Parameters
    ----------
    factors : tuple of (Terms, int)
        The sums, and their exponents.
    enclosures : Enclosures
        What terms are made of.
    """

    factors: tuple[tuple[Terms, int], ...]
    enclosures: Enclosures

    def on_axis(self, number: int, axis: int) -> AxisFunction | None:
        """Return one factor, divided by what grows fastest, as a real function on an axis.

        ``None`` if it is not real there.
        """
        degrees = self.enclosures.degrees
        turned: Terms = {}
        for key, terms in self.factors[number][0].items():
            new_key = tuple((i, *_times((a, b), _unit(axis, degrees[i]))) for i, a, b in key)
            own = turned.setdefault(new_key, {})
            for (power, monomial), value in terms.items():
                own[power, monomial] = _times(value, _unit(axis, power))
        waves = _real_waves(turned, len(degrees))
        if waves is None:
            return None
        fastest = max((wave.growth for wave in waves), key=self._growth)
        return AxisFunction(tuple(_divided(wave, fastest) for wave in waves), axis, self.enclosures)

    def _growth(self, multiples: Multiples) -> tuple[float, float]:
        """Return how fast an exponential grows for large t."""
        linear, square = self.enclosures.rate(multiples)
        return float(square), float(linear)

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
            for terms, exponent in self._sums:
                total += exponent * terms.turn(radius)
            return total

    def estimate(self, z: float) -> float:
        """Return about how far arg turns on that arc [rad], from the largest terms."""
        radius = exp(z / 2)
        return sum(exponent * terms.estimate(radius) for terms, exponent in self._sums)

    @cached_property
    def first_frequency(self) -> float:
        """Some abs(s) [rad/s] up to which no exponential turns by more than once."""
        reach = min(terms.reach for terms, _ in self._sums)
        return reach**2 if isfinite(reach) else 1.0

    @cached_property
    def _sums(self) -> tuple[tuple[ArcSum, int], ...]:
        """The factors and their exponents, as sums over exponentials in balls."""
        with precision(FLOAT_BITS):
            return tuple(
                (ArcSum(tuple(_exponential(*item, self.enclosures) for item in terms.items())), exponent)
                for terms, exponent in self.factors
            )


def _exponential(key: Key, terms: dict[Place, Gaussian], numbers: Enclosures) -> ArcTerm:
    linear, square = acb(0), acb(0)
    for i, a, b in key:
        if numbers.degrees[i] == LINEAR:
            linear += acb(a, b) * numbers.rates[i]
        else:
            square += acb(a, b) * numbers.rates[i]
    powers: dict[int, acb] = {}
    for (power, monomial), number in terms.items():
        powers[power] = powers.get(power, acb(0)) + acb(*number) * numbers.product(monomial)
    return ArcTerm(linear, square, tuple(sorted(powers.items())))


def _real_waves(turned: Terms, arguments: int) -> tuple[AxisWave, ...] | None:
    """Return real terms, if all complex ones times one unit come in conjugate pairs."""
    pairs: dict[tuple[Multiples, Multiples], dict[Place, Gaussian]] = {}
    for key, terms in turned.items():
        growth, phase = [0] * arguments, [0] * arguments
        for i, a, b in key:
            growth[i], phase[i] = growth[i] + a, phase[i] + b
        own = pairs.setdefault((tuple(growth), tuple(phase)), {})
        for place, value in terms.items():
            own[place] = _plus(own.get(place, (0, 0)), value)
    unit = _unit_that_makes_real(pairs)
    waves = []
    done: set[tuple[Multiples, Multiples]] = set()
    for (growing, turning), own in pairs.items():
        if (growing, turning) in done:
            continue
        opposite = tuple(-p for p in turning)
        done |= {(growing, turning), (growing, opposite)}
        here = {place: _times(value, unit) for place, value in own.items()}
        other = pairs.get((growing, opposite), {})
        there = {place: _conjugate(_times(value, unit)) for place, value in other.items()}
        if any(here.get(place, (0, 0)) != there.get(place, (0, 0)) for place in {*here, *there}):
            return None
        wave = _wave(growing, turning, here)
        if wave.even or wave.odd:
            waves.append(wave)
    return tuple(waves)


def _unit_that_makes_real(pairs: Mapping[tuple[Multiples, Multiples], dict[Place, Gaussian]]) -> Gaussian:
    """Return a power of 1 + j by which the first pair becomes conjugate, if any does."""
    for (growing, turning), own in pairs.items():
        other = pairs.get((growing, tuple(-p for p in turning)), {})
        for place, value in own.items():
            for power in range(QUARTERS):
                unit = _unit(IMAGINARY, power)
                if any(value) and _times(value, unit) == _conjugate(_times(other.get(place, (0, 0)), unit)):
                    return unit
    return 1, 0


def _wave(growth: Multiples, phase: Multiples, terms: Mapping[Place, Gaussian]) -> AxisWave:
    """Return one of two conjugate exponentials and the other as cosine and sine of a phase of one sign."""
    opposite = tuple(-p for p in phase)
    weight = 1 + (opposite != phase)
    sign = -1 if phase > opposite else 1
    even: Polynomial = {}
    odd: Polynomial = {}
    for (power, monomial), (re, im) in terms.items():
        if re:
            even.setdefault(power, {})[monomial] = weight * re
        if im and opposite != phase:
            odd.setdefault(power, {})[monomial] = weight * sign * im
    return AxisWave(growth, max(phase, opposite), even, odd)


def _divided(wave: AxisWave, growth: Multiples) -> AxisWave:
    """Return a wave without an exponential that all have in common."""
    rest = tuple(own - taken for own, taken in zip(wave.growth, growth, strict=True))
    return replace(wave, growth=rest)


def lossless_function(function: KernelFunction, bits: int) -> LosslessFunction | None:
    """Return a function of x, ``None`` where there are losses, delays or wavenumbers of another law.

    Parameters
    ----------
    function : KernelFunction
        The same function of s.
    bits : int
        Precision of its numbers; up to this it can be evaluated.
    """
    sums = function.exponentials
    if sums is None:
        return None
    bound = function.bound
    index = bound.ratio.ring.index
    laws: dict[str, _Law] = {}
    for argument in function.arguments:
        law = _law_of(bound, argument)
        if law is None:
            return None
        laws[argument.wavenumber] = law
    unknown = [name for name in bound.kernels.wavenumbers if name not in laws]
    if any(function.part.depends_on(name) for name in unknown):
        return None
    position = {index[name]: (i, 0) for i, (name, _) in enumerate(bound.constants)}
    for name, law in laws.items():
        position[index[name]] = (len(position), law.degree)
    enclosures = _enclosures(bound, laws, function.arguments, bits)
    # Where a factor of s^2 has the other sign, waves do not travel.
    wavenumbers = enclosures.constants[len(bound.constants) :]
    if not all(rate.is_finite() and rate > 0 for rate in wavenumbers):
        return None
    factors = tuple((_terms(terms, position), exponent) for terms, exponent in sums)
    return LosslessFunction(factors, enclosures)


@dataclass(frozen=True, slots=True, eq=False)
class _Law:
    """A wavenumber proportional to x or x^2: the fourth or square root of a multiple of s^2.

    Parameters
    ----------
    degree : int
        Of x.
    multiple : Factored
        What s^2 is multiplied with.
    """

    degree: int
    multiple: Factored


def _law_of(bound: BoundTransferFunction, argument: Argument) -> _Law | None:
    """Return the law of an argument, ``None`` where it is another one."""
    law = next((law for law in bound.kernels.dispersions if argument.wavenumber in law.wavenumbers), None)
    if law is None or law.kind not in LOSSLESS or not law.shift.is_zero:
        return None
    first, *others = law.characteristic
    s = first.ring.context.gen(0)
    multiple = first / first.filter(lambda factor: factor == s)
    if first.exponent_of(s) != QUADRATIC or multiple.depends_on("s") or not all(c.is_zero for c in others):
        return None
    return _Law(LOSSLESS[law.kind], multiple)


def _enclosures(
    bound: BoundTransferFunction, laws: Mapping[str, _Law], arguments: Sequence[Argument], bits: int
) -> Enclosures:
    """Return all constants and what x or x^2 is multiplied with in wavenumbers, and in arguments."""
    with precision(bits):
        constants = {name: evaluate() for name, evaluate in bound.constants}
        values = bound.kernel_values(constants)
        places: dict[str, Value] = {"s": acb(1), **{name: acb(c) for name, c in constants.items()}}

        def number(value: Factored) -> arb:
            found = values.value(value, places)
            return (found if isinstance(found, acb) else found[0]).real

        wavenumbers = {}
        for name, law in laws.items():
            size = number(law.multiple)
            wavenumbers[name] = (-size).sqrt() if law.degree == QUADRATIC else (size / 4).sqrt().sqrt()
        return Enclosures(
            bits,
            [*constants.values(), *wavenumbers.values()],
            [wavenumbers[argument.wavenumber] * number(argument.length) for argument in arguments],
            [laws[argument.wavenumber].degree for argument in arguments],
        )


def _terms(terms: ExponentialSum, position: Mapping[int, tuple[int, int]]) -> Terms:
    """Return a sum over exponentials of x.

    Parameters
    ----------
    terms : ExponentialSum
        In s, constants and wavenumbers; all halved equally often.
    position : mapping of int to (int, int)
        Of constants and wavenumbers: where they stand among the constants, and the power of x they bring.
    """
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
                key = (power, tuple(constants))
                own[key] = _plus(own.get(key, (0, 0)), _times((int(coefficient), 0), unit))
    return found
