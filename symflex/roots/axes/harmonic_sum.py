"""Undamped functions as functions of x, the square root of s, and how far their argument turns on arcs.

Where every wavenumber is a root of a multiple of s^2, those of bending are proportional to x and those of
waves to x^2, and a polynomial in kernels is a sum of ``c(x) exp(p x + q x^2)``. On the real axis of s, x is
t; on the imaginary one it is (1 + j) t, and the sum is real but for a constant factor: growing, decaying and
oscillating terms with real coefficients.

On an arc of x from 0 to 45 degrees, away from directions in which two terms are equally large, one outweighs
all others together, and its own argument is known, however far it turns. Next to those directions, which for
undamped functions are the ends of the arc, lie layers as thin as the arc is long: only these are
followed in steps.
"""

from __future__ import annotations

from cmath import phase, rect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, inf, isfinite, log, pi, sqrt

from flint import acb, arb

from symflex.algebra import Factored
from symflex.algebra.exponential_sum import (
    Amplitude,
    Argument,
    Exponent,
    ExponentialSum,
    Gaussian,
    Monomial,
    Multiples,
)
from symflex.balls import Value, at_centre, precision
from symflex.roots.axes.axis_function import (
    FLOAT_BITS,
    IMAGINARY,
    LINEAR,
    QUADRATIC,
    REAL,
    AxisFunction,
    Enclosures,
)
from symflex.roots.counting.winding import SPREAD, WIDENED, total_turn
from symflex.roots.functions.kernel_function import ROOM, KernelFunction, deviation
from symflex.transfer import BoundTransferFunction

EIGHTH = pi / 4
BESIDE = 0.3  # how far from the ends the largest terms are looked for, in x
OUTWEIGHED = 0.8  # most that all other terms may amount to, of the largest; less than 1
FALL = 4.0  # factor by which other terms, over their number, decay up to the edge of a layer
MARGIN = 1.1  # factor on the width of a layer, because terms do not decay evenly
FIRST_STEP = 0.5  # first step along the arc
SHORTEST = 1e-12  # share of the arc; a step that would have to be shorter says that a root lies on it


@dataclass(frozen=True, slots=True)
class ArcTerm:
    """Terms ``c x^n`` before one exponential."""

    linear: acb  # linear and square: rates p of x and q of x^2
    square: acb
    powers: tuple[tuple[int, acb], ...]  # n and c


@dataclass(frozen=True, slots=True)
class _Size:
    """One term in doubles."""

    linear: complex
    square: complex
    power: int
    coefficient: complex
    log_size: float


@dataclass(frozen=True, eq=False)
class ArcSum:
    """A sum of exponentials."""

    terms: tuple[ArcTerm, ...]  # what is summed

    @cached_property
    def _sizes(self) -> tuple[_Size, ...]:
        """Per exponential the power that is the largest far from 0."""
        sizes = []
        for term in self.terms:
            n, c = max(term.powers, key=lambda power: power[0])
            number = complex(c)
            size = log(abs(number)) if number else -inf
            sizes.append(_Size(complex(term.linear), complex(term.square), n, number, size))
        return tuple(sizes)

    @cached_property
    def _power(self) -> int | None:
        """The only power of x in the sum, ``None`` where there is more to it."""
        (first, *others) = self.terms
        if others or len(first.powers) > 1 or first.linear != 0 or first.square != 0:
            return None
        return first.powers[0][0]

    @cached_property
    def reach(self) -> float:
        """Some abs(x) up to which no exponential turns by more than once."""
        return min((_reach(abs(size.linear), abs(size.square)) for size in self._sizes), default=inf)

    def turn(self, radius: arb) -> arb:
        """Return how far the argument turns on the arc of a radius: proved, or RootOnPathError."""
        if self._power is not None:
            return self._power * arb.pi() / 4
        return _Arc(self.terms, self._sizes, radius).turn_between(0.0, 1.0)

    def estimate(self, radius: float) -> float:
        """Return about how far it turns [rad], from the largest terms."""
        if self._power is not None:
            return self._power * EIGHTH
        aside = BESIDE / (1 + radius)
        start, end = (self._largest(radius * rect(1.0, angle)) for angle in (aside, EIGHTH - aside))
        return end - start

    def _largest(self, x: complex) -> float:
        """Return the argument of the largest term, its turns included."""
        length, angle, square = log(abs(x)), phase(x), x * x
        best, argument = -inf, 0.0
        for term in self._sizes:
            exponent = term.linear * x + term.square * square
            size = exponent.real + term.power * length + term.log_size
            if size > best:
                best = size
                argument = exponent.imag + term.power * angle + phase(term.coefficient)
        return argument


def _reach(linear: float, square: float) -> float:
    """Return r with ``linear r + square r^2`` of one turn, infinity where both are zero."""
    below = linear + sqrt(linear * linear + 8 * pi * square)
    return 4 * pi / below if below else inf


class _Arc:
    """A sum on the arc of one radius; places on it are shares t of its length."""

    def __init__(self, terms: Sequence[ArcTerm], sizes: Sequence[_Size], radius: arb) -> None:
        self._terms = terms
        self._radius = radius
        self._eighth = arb.pi() / 4
        reach = float(radius.mid())
        length = log(reach)
        self._growths = [
            (size.linear * reach, size.square * reach * reach, size.log_size + size.power * length)
            for size in sizes
        ]
        self._powers = [size.power for size in sizes]
        self._points: dict[float, acb] = {}
        self._ratios: dict[tuple[float, int], acb] = {}
        self._rates: dict[int, list[tuple[acb, acb]]] = {}

    def turn_between(self, start: float, end: float) -> arb:
        """Return how far the argument turns from one place to another."""
        largest = self._largest_at((start + end) / 2)
        first, last = self._between_layers(start, end, largest)
        if last - first < (end - start) / 2 or not self._outweighs(first, last, largest):
            return self._stepwise(start, end)
        turned = self._powers[largest] * self._eighth * (arb(last) - arb(first))
        total = self._turn(first, last, largest, turned)
        for one, other in ((start, first), (last, end)):
            if one < other:
                total += self.turn_between(one, other)
        return total

    def _largest_at(self, t: float) -> int:
        unit = rect(1.0, EIGHTH * t)
        sizes = [(p * unit + q * unit * unit).real + c for p, q, c in self._growths]
        return sizes.index(max(sizes))

    def _between_layers(self, start: float, end: float, largest: int) -> tuple[float, float]:
        """Return about where a term begins and ends to outweigh all others, seen from places beyond."""
        own_p, own_q, own_c = self._growths[largest]
        needed = log(FALL * len(self._growths))
        depths = []
        for place, inward in ((start, EIGHTH), (end, -EIGHTH)):
            unit = rect(1.0, EIGHTH * place)
            depth = 0.0
            for i, (p, q, c) in enumerate(self._growths):
                along, twice = (p - own_p) * unit, (q - own_q) * unit * unit
                missing = needed + along.real + twice.real + c - own_c
                if i != largest and missing > 0:
                    fall = (along.imag + 2 * twice.imag) * inward
                    depth = max(depth, missing / fall * MARGIN) if fall > 0 else end - start
            depths.append(depth)
        return start + depths[0], end - depths[1]

    def _outweighs(self, start: float, end: float, largest: int) -> bool:
        """Tell whether one power of one exponential outweighs the rest of the sum: proved."""
        middle, angle = (start + end) / 2, self._eighth * arb((end - start) / 2 * WIDENED + SPREAD)
        x = self._point(middle)
        once, twice = angle.sin_cos(), (2 * angle).sin_cos()
        square = x * x
        power = self._powers[largest]
        total, own = arb(0), arb(0)
        for i, (p, q) in enumerate(self._differences(largest)):
            size = arb(0)
            for n, c in self._terms[i].powers:
                if i == largest and n == power:
                    own = abs(c)
                else:
                    size += abs(c) * self._radius ** (n - power)
            if i != largest:
                size *= (_most(p * x, once) + _most(q * square, twice)).exp()
            total += size
        return bool(total < OUTWEIGHED * own)

    def _turn(self, start: float, end: float, largest: int, turned: arb) -> arb:
        """Return how far the argument turns where the sum over one exponential turns about so far."""
        term, here, there = self._terms[largest], self._point(start), self._point(end)
        ratio = self._ratio_at(end, largest) / self._ratio_at(start, largest) / acb(0, turned).exp()
        exponent = term.linear * (there - here) + term.square * (there * there - here * here)
        return exponent.imag + turned + ratio.arg()

    def _stepwise(self, start: float, end: float) -> arb:
        def place(share: float) -> float:
            return end if share == 1 else start + (end - start) * share

        def change(one: float, other: float) -> tuple[float, arb]:
            return self._change(place(one), place(other))

        return total_turn(change, FIRST_STEP, SHORTEST / (end - start))

    def _change(self, start: float, end: float) -> tuple[float, arb]:
        """Return how far the argument may turn from the middle of a step, and how far it does in all."""
        middle, half = (start + end) / 2, (end - start) / 2
        largest = self._largest_at(middle)
        ball = self._radius * acb(0, self._eighth * arb(middle, half * WIDENED + SPREAD)).exp()
        off = deviation(self._ratio(ball, largest))
        return off, arb(0) if off > ROOM else self._turn(start, end, largest, arb(0))

    def _point(self, t: float) -> acb:
        if t not in self._points:
            self._points[t] = self._radius * acb(0, self._eighth * arb(t)).exp()
        return self._points[t]

    def _differences(self, largest: int) -> list[tuple[acb, acb]]:
        """Return the rates of all exponentials less those of one."""
        if largest not in self._rates:
            own = self._terms[largest]
            self._rates[largest] = [
                (term.linear - own.linear, term.square - own.square) for term in self._terms
            ]
        return self._rates[largest]

    def _ratio_at(self, t: float, largest: int) -> acb:
        if (t, largest) not in self._ratios:
            self._ratios[t, largest] = self._ratio(self._point(t), largest)
        return self._ratios[t, largest]

    def _ratio(self, x: acb, largest: int) -> acb:
        """Return the sum divided by one of its exponentials."""
        square = x * x
        total = acb(0)
        for i, (p, q) in enumerate(self._differences(largest)):
            amplitude = sum((c * x**n if n else c for n, c in self._terms[i].powers), acb(0))
            total += amplitude if i == largest else amplitude * (p * x + q * square).exp()
        return total


def _most(value: acb, turn: tuple[arb, arb]) -> arb:
    """Return an upper bound of the real part, turned by up to an angle with this sine and cosine."""
    sine, cosine = turn
    along = value.real
    return (along * cosine if along < 0 else abs(along)) + abs(value.imag) * sine


LOSSLESS: Mapping[str, int] = {"bending": LINEAR, "wave": QUADRATIC}  # power of x of wavenumbers, by kind
UNITS: Mapping[int, Gaussian] = {REAL: (1, 0), IMAGINARY: (1, 1)}  # what t is multiplied with to be x


@dataclass(frozen=True, eq=False)
class LosslessFunction:
    """A product of powers of sums of exponentials of x."""

    factors: tuple[tuple[ExponentialSum, int], ...]  # over x, the first generator, with exponents
    enclosures: Enclosures  # what terms are made of

    def on_axis(self, number: int, axis: int) -> AxisFunction | None:
        """Return one factor over what grows fastest, as a real function on an axis; ``None`` if not real."""
        degrees = self.enclosures.degrees
        waves = self.factors[number][0].turned(UNITS[axis], degrees).waves(len(degrees))
        if waves is None:
            return None
        fastest = max((wave.growth for wave in waves), key=self._growth)
        # Without an exponential that all have in common.
        growths = [tuple(a - b for a, b in zip(wave.growth, fastest, strict=True)) for wave in waves]
        divided = (replace(wave, growth=own) for wave, own in zip(waves, growths, strict=True))
        return AxisFunction(tuple(divided), axis, self.enclosures)

    def _growth(self, multiples: Multiples) -> tuple[float, float]:
        """Return how fast an exponential grows for large t."""
        linear, square = self.enclosures.rate(multiples)
        return float(square), float(linear)

    def turn(self, z: float) -> arb:
        """Return how far arg of the function turns from s = exp(z) to j exp(z) about 0: proved."""
        with precision(FLOAT_BITS):
            radius = (arb(z) / 2).exp()
            return sum((exponent * terms.turn(radius) for terms, exponent in self._sums), arb(0))

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
                (ArcSum(tuple(_arc_term(*item, self.enclosures) for item in terms.terms.items())), exponent)
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


def lossless_function(function: KernelFunction, bits: int) -> LosslessFunction | None:
    """Return a function as one of x, with numbers of so many bits; ``None`` with damping or several laws."""
    exponentials = function.exponentials
    if exponentials is None:
        return None
    arguments, sums = exponentials
    bound = function.bound
    index = bound.ratio.ring.index
    laws: dict[str, _Law] = {}
    for argument in arguments:
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
    enclosures = _enclosures(bound, laws, arguments, bits)
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
        values = bound.kernel_values()
        places: dict[str, Value] = {"s": acb(1), **{name: acb(c) for name, c in values.constants.items()}}

        def number(value: Factored) -> arb:
            return at_centre(values.value(value, places)).real

        wavenumbers = {}
        for name, law in laws.items():
            size = number(law.multiple)
            wavenumbers[name] = (-size).sqrt() if law.degree == QUADRATIC else (size / 4).sqrt().sqrt()
        return Enclosures(
            bits,
            [*values.constants.values(), *wavenumbers.values()],
            [wavenumbers[argument.wavenumber] * number(argument.length) for argument in arguments],
            [laws[argument.wavenumber].degree for argument in arguments],
        )
