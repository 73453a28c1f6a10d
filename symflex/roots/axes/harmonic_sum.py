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
    REAL,
    AxisFunction,
    Enclosures,
)
from symflex.roots.precision import precision
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.algebra import Factored
    from symflex.algebra.exponential_sum import (
        Amplitude,
        Argument,
        AxisWave,
        Exponent,
        ExponentialSum,
        Gaussian,
        Monomial,
        Multiples,
    )
    from symflex.roots.functions.kernel_function import KernelFunction
    from symflex.transfer import BoundTransferFunction
    from symflex.transfer.balls import Value

LOSSLESS: Mapping[str, int] = {"bending": LINEAR, "wave": QUADRATIC}
"""Power of x that wavenumbers are proportional to, by kind of dispersion."""
UNITS: Mapping[int, Gaussian] = {REAL: (1, 0), IMAGINARY: (1, 1)}
"""What t is multiplied with to be x."""


@dataclass(frozen=True, eq=False)
class LosslessFunction:
    """A product of powers of sums of exponentials of x."""

    # The sums over x, and their exponents; the first generator is x, the others are constants.
    factors: tuple[tuple[ExponentialSum, int], ...]
    enclosures: Enclosures  # what terms are made of

    def on_axis(self, number: int, axis: int) -> AxisFunction | None:
        """Return one factor, divided by what grows fastest, as a real function on an axis.

        ``None`` if it is not real there.
        """
        degrees = self.enclosures.degrees
        waves = self.factors[number][0].turned(UNITS[axis], degrees).waves(len(degrees))
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

        RootOnPathError where a root lies on the arc, or too close to it.
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
                (
                    ArcSum(tuple(_arc_term(*item, self.enclosures) for item in terms.terms.items())),
                    exponent,
                )
                for terms, exponent in self.factors
            )


def _arc_term(exponent: Exponent, amplitude: Amplitude, numbers: Enclosures) -> ArcTerm:
    linear, square = acb(0), acb(0)
    for i, a, b in exponent:
        if numbers.degrees[i] == LINEAR:
            linear += acb(a, b) * numbers.rates[i]
        else:
            square += acb(a, b) * numbers.rates[i]
    powers: dict[int, acb] = {}
    for monomial, number in amplitude.items():
        n = sum(e for i, e in monomial if i == 0)
        factor = numbers.product(tuple((i - 1, e) for i, e in monomial if i))
        powers[n] = powers.get(n, acb(0)) + acb(*number) * factor
    return ArcTerm(linear, square, tuple(sorted(powers.items())))


def _divided(wave: AxisWave, growth: Multiples) -> AxisWave:
    """Return a wave without an exponential that all have in common."""
    rest = tuple(own - taken for own, taken in zip(wave.growth, growth, strict=True))
    return replace(wave, growth=rest)


def lossless_function(function: KernelFunction, bits: int) -> LosslessFunction | None:
    """Return a function as one of x, ``None`` where there are losses, delays or waves of another law.

    ``bits`` are the precision of its numbers; up to this it can be evaluated.
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

    def in_root_of_s(monomial: Monomial) -> Monomial:
        power, others = 0, []
        for i, e in monomial:
            place, degree = position[i] if i else (-1, 2)
            power += degree * e
            others += [(place + 1, e)] if i else []
        return (*(((0, power),) if power else ()), *others)

    factors = tuple((terms.mapped(in_root_of_s), exponent) for terms, exponent in sums)
    return LosslessFunction(factors, enclosures)


@dataclass(frozen=True, slots=True, eq=False)
class _Law:
    """A wavenumber proportional to x or x^2: the fourth or square root of a multiple of s^2."""

    degree: int  # of x
    multiple: Factored  # what s^2 is multiplied with


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
            return at_centre(found).real

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
