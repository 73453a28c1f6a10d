"""Functions of s whose only exponentials are delays: as sums of polynomials times exp(-s T), exactly.

Input: a bound transfer function with pure delays, and rods, shafts and strings that lose nothing.
Output: numerator and denominator as :class:`DelayedQuotient`.

A wave of such a rod has the wavenumber ``s/c``, so it is a delay too:

    2 cosh(s l/c)    =    exp(s l/c) (1 + exp(-2 s l/c))

Where all moves along x, as a belt does with speed v, waves take ``l/(c + v)`` there and ``l/(c - v)`` back.
They have ``exp(-(shift +- gamma) l)``, with a ``shift`` proportional to s; along x it is negative.

Delays are compared exactly. Each is a rational multiple of a square root of a rational number, such as l/c of
``sqrt(rho/E)``; roots whose ratio is irrational are independent over the rational numbers (Besicovitch 1940).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import isqrt, lcm, prod

from flint import acb, arb, arb_poly, fmpz_mpoly

from symflex.algebra import Dispersion, Factored, Ring, degree_in
from symflex.algebra.exponential_sum import Argument, Exponent, arguments_of, exponential_sum
from symflex.analysis.time_response.effort import EFFORT
from symflex.balls import at_centre, ball, precision
from symflex.roots.problem import PolynomialInS, RealConstant
from symflex.transfer import BoundTransferFunction

Delay = tuple[tuple[int, Fraction], ...]  # independent durations, ascending, times what is not zero
Amplitude = dict[tuple[int, ...], Fraction]  # per exponents of s and of the constants, a number
NO_DELAY: Delay = ()
NO_FORMULA = "some wavenumbers have no formula"  # why a function is not read as delays or fronts
TOO_MANY = "it multiplies out to too many exponentials"


@dataclass(frozen=True, eq=False)
class Durations:
    """What all delays of a function are multiples of, and what coefficients of polynomials are made of."""

    enclosed: tuple[Callable[[], arb], ...]  # each independent duration [s], at the current precision
    names: tuple[str, ...]  # of the constants
    constants: tuple[Callable[[], arb], ...]  # at the current precision

    def seconds(self, delay: Delay) -> arb:
        """Return a delay [s] at the current precision."""
        return sum((self.enclosed[i]() * ball(multiple) for i, multiple in delay), arb(0))

    def polynomial(self, amplitude: Amplitude) -> arb_poly:
        """Return an amplitude as a polynomial in s, at the current precision."""
        values = [evaluate() for evaluate in self.constants]
        coefficients = [arb(0)] * (1 + max((exponents[0] for exponents in amplitude), default=0))
        for (power, *others), number in amplitude.items():
            term = ball(number)
            for value, exponent in zip(values, others, strict=True):
                term = term * value**exponent if exponent else term
            coefficients[power] = coefficients[power] + term
        return arb_poly(coefficients)

    def exact(self, amplitude: Amplitude) -> PolynomialInS:
        """Return an amplitude without negative exponents as an exact polynomial, but for a factor."""
        scale = lcm(*(number.denominator for number in amplitude.values()))
        ring = Ring(self.names)
        rows: list[dict[tuple[int, ...], int]] = [{} for _ in range(1 + max(e[0] for e in amplitude))]
        for (power, *others), number in amplitude.items():
            rows[power][tuple(others)] = int(number * scale)
        constants = tuple(map(RealConstant, self.names, self.constants))
        return PolynomialInS(tuple(ring.context.from_dict(row) for row in rows), ring.context, constants)


@dataclass(frozen=True, eq=False)
class DelayedQuotient:
    """Two sums of polynomials times delays, one over the other."""

    above: Mapping[Delay, Amplitude]
    below: Mapping[Delay, Amplitude]
    durations: Durations


def delayed_quotient(bound: BoundTransferFunction) -> DelayedQuotient | None:
    """Return a function as a quotient of sums of delays; None if it contains anything else, or too much."""
    read = read_delays(bound)
    return read if isinstance(read, DelayedQuotient) else None


def read_delays(bound: BoundTransferFunction) -> DelayedQuotient | str:
    """Return a function as a quotient of sums of delays, or why it is none."""
    arguments = arguments_of(bound.kernels)
    if arguments is None:
        return NO_FORMULA
    law_of = {kernel.wavenumber: kernel.dispersion for kernel in bound.kernels.kernels if kernel.wavenumber}
    slowness: dict[str, Factored] = {}
    for name, law in law_of.items():
        squared = _squared_slowness(law)
        if squared is None:
            return "some waves weaken on the way" if _weakens(law) else "some waves change shape"
        slowness[name] = squared
    reader = DelayReader.of(bound, arguments, slowness)
    if isinstance(reader, str):
        return reader
    one = {NO_DELAY: {(0,) * (1 + len(reader.durations.names)): bound.ratio.unit}}
    above: Mapping[Delay, Amplitude] = one
    below: Mapping[Delay, Amplitude] = {NO_DELAY: {(0,) * (1 + len(reader.durations.names)): Fraction(1)}}
    for factor, exponent in bound.ratio.factors:
        terms = reader.read(factor)
        if terms is None:
            return TOO_MANY
        for _ in range(abs(exponent)):
            above, below = (
                (_product(above, terms), below) if exponent > 0 else (above, _product(below, terms))
            )
    return DelayedQuotient(above, below, reader.durations)


@dataclass(frozen=True, eq=False)
class DelayReader:
    """Reads polynomials in kernels as sums of delays."""

    bound: BoundTransferFunction
    arguments: tuple[Argument, ...]
    delays: tuple[tuple[int, Fraction], ...]  # of every argument: which duration, and how often
    places: Mapping[int, int]  # of generators that are constants, or waves' slownesses, in a monomial
    decays: Mapping[int, int]  # the same of what a delay multiplies its input with, by argument
    waves: frozenset[int]  # positions of wavenumbers in the ring
    durations: Durations

    @classmethod
    def of(
        cls, bound: BoundTransferFunction, arguments: tuple[Argument, ...], slowness: Mapping[str, Factored]
    ) -> DelayReader | str:
        """Return the reader of a function, or why an argument is no delay."""
        ring = bound.ratio.ring

        def real_value(value: Factored) -> arb:
            evaluator = bound.kernel_values()
            constants = {name: acb(value) for name, value in evaluator.constants.items()}
            return at_centre(evaluator.value(value, constants)).real

        def root_of(value: Factored) -> arb:
            return real_value(value).sqrt()

        def decay_of(value: Factored) -> arb:
            return (-real_value(value)).exp()

        squares: list[Fraction | None] = []
        durations: list[Callable[[], arb]] = []
        delays: list[tuple[int, Fraction]] = []
        decays: dict[int, Callable[[], arb]] = {}
        for number, argument in enumerate(arguments):
            if argument.wavenumber:
                square = slowness[argument.wavenumber] * argument.length**2
                sign = -1
            else:
                linear = decay_and_rate(argument.rate)
                if linear is None:
                    return "what is delayed changes its form"
                decay, rate = linear
                if not decay.is_zero:
                    decays[number] = partial(decay_of, decay * argument.length)
                delay = rate * argument.length
                if delay.is_zero:
                    delays.append((0, Fraction(0)))
                    continue
                with precision(EFFORT.tie_bits):
                    seconds = real_value(delay)
                if seconds.contains(0):
                    return "it is not known which way some waves go"
                square, sign = delay**2, 1 if seconds > 0 else -1
            exact = square.unit if square.is_constant else None
            found = next(((i, r) for i, q in enumerate(squares) if (r := _ratio(exact, q)) is not None), None)
            if found is None:
                found = (len(squares), Fraction(1))
                squares.append(exact)
                durations.append(partial(root_of, square))
            delays.append((found[0], sign * found[1]))
        names = [name for name, _ in bound.constants]
        constants = [evaluate for _, evaluate in bound.constants]
        for name, value in slowness.items():
            names.append(name)
            constants.append(partial(root_of, value))
        places = {ring.index[name]: i + 1 for i, name in enumerate(names)}
        waves = frozenset(ring.index[name] for name in slowness)
        lossy = {number: 1 + len(names) + i for i, number in enumerate(decays)}
        names += [f"decay_{number}" for number in decays]
        known_constants = Durations(tuple(durations), tuple(names), (*constants, *decays.values()))
        return cls(bound, arguments, tuple(delays), places, lossy, waves, known_constants)

    def decay(self, number: int) -> arb:
        """Return what an argument's exponential is multiplied by besides its delay."""
        return self.durations.constants[self.decays[number] - 1]()

    def delay_of(self, exponent: Exponent) -> Delay:
        """Return what an exponential is late by."""
        return sum_of(*(((self.delays[x][0], self.delays[x][1] * a),) for x, a, _ in exponent))

    def read(self, factor: fmpz_mpoly) -> dict[Delay, Amplitude] | None:
        """Return a factor as a sum of delays; None if there are too many."""
        terms = exponential_sum(self.bound.ratio.ring, self.bound.kernels, self.arguments, factor)
        if terms is None:
            return None
        by_delay: dict[Delay, Amplitude] = {}
        for exponent, amplitude in terms.terms.items():
            terms_then = by_delay.setdefault(self.delay_of(exponent), {})
            for monomial, (number, _) in amplitude.items():
                exponents = [0] * (1 + len(self.durations.names))
                for x, a, _ in exponent:
                    if x in self.decays:
                        exponents[self.decays[x]] += int(a)
                for i, e in monomial:
                    if i == 0 or i in self.waves:  # a wavenumber is s times its slowness
                        exponents[0] += e
                    if i:
                        exponents[self.places[i]] += e
                _add(terms_then, tuple(exponents), Fraction(number, 2**terms.halvings))
        return {delay: terms_then for delay, terms_then in by_delay.items() if terms_then}


def _squared_slowness(law: Dispersion) -> Factored | None:
    """Return 1/c^2 of a law ``gamma^2 = s^2/c^2``, None of any other."""
    if law.kind != "wave" or not all(c.is_zero for c in law.characteristic[1:]):
        return None
    powers = polynomial_in_s(-law.characteristic[0], 2)
    return powers[2] if powers is not None and powers[0].is_zero and powers[1].is_zero else None


def _weakens(law: Dispersion) -> bool:
    """Tell whether ``gamma = s/c + a``, as in a line without distortion: waves keep their shape, not size."""
    if law.kind != "wave":
        return False
    powers = polynomial_in_s(-law.characteristic[0], 2)
    return powers is not None and (powers[1] ** 2 - powers[0] * powers[2] * 4).is_zero


def decay_and_rate(shift: Factored) -> tuple[Factored, Factored] | None:
    """Return a and b of ``a + b s``; None of anything else."""
    for degree in (1, 0):
        if (powers := polynomial_in_s(shift, degree)) is not None:
            return powers[0], powers[1] if degree else Factored.number(shift.ring, 0)
    return None


def polynomial_in_s(value: Factored, degree: int) -> list[Factored] | None:
    """Return the coefficients of a polynomial in s of a degree, the lowest first; None of any other value."""
    ring = value.ring
    moving = [(f, e) for f, e in value.factors if degree_in(f, 0)]
    if sum(degree_in(f, 0) * e for f, e in moving) != degree or any(e < 0 for _, e in moving):
        return None
    constant = Factored(ring, value.unit, tuple(power for power in value.factors if power not in moving))
    polynomial = prod((f**e for f, e in moving), start=ring.constant(1))
    return [constant * Factored.polynomial(ring, c) for c in ring.coefficients(polynomial)]


def _ratio(square: Fraction | None, other: Fraction | None) -> Fraction | None:
    """Return the square root of a ratio if that is rational."""
    if square is None or other is None:
        return None
    ratio = square / other
    above, below = isqrt(ratio.numerator), isqrt(ratio.denominator)
    return Fraction(above, below) if above**2 == ratio.numerator and below**2 == ratio.denominator else None


def sum_of(*delays: Delay) -> Delay:
    """Return delays one after the other."""
    multiples: dict[int, Fraction] = {}
    for delay in delays:
        for i, multiple in delay:
            multiples[i] = multiples.get(i, Fraction(0)) + multiple
    return tuple(sorted((i, multiple) for i, multiple in multiples.items() if multiple))


def _add(amplitude: Amplitude, exponents: tuple[int, ...], number: Fraction) -> None:
    total = amplitude.get(exponents, Fraction(0)) + number
    if total:
        amplitude[exponents] = total
    else:
        amplitude.pop(exponents, None)


def _product(a: Mapping[Delay, Amplitude], b: Mapping[Delay, Amplitude]) -> dict[Delay, Amplitude]:
    product: dict[Delay, Amplitude] = {}
    for first, one in a.items():
        for second, other in b.items():
            summands = product.setdefault(sum_of(first, second), {})
            for m, x in one.items():
                for n, y in other.items():
                    _add(summands, tuple(i + k for i, k in zip(m, n, strict=True)), x * y)
    return {delay: summands for delay, summands in product.items() if summands}


def later(delay: Delay, other: Delay) -> Delay:
    """Return by how much one delay is longer than another.

    >>> later(((0, Fraction(2)),), ((0, Fraction(1)), (1, Fraction(3))))
    ((0, Fraction(1, 1)), (1, Fraction(-3, 1)))
    """
    return sum_of(delay, tuple((i, -multiple) for i, multiple in other))
