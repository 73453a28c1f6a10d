"""Undamped functions on the real and on the imaginary axis of s, where they are real, and their roots.

On the real axis ``s = t^2``, on the imaginary one ``s = 2 j t^2``; a function is a sum of products of
exponentials, sines and cosines with polynomials in t. Its derivative is of the same kind; every proof rests
on it:

    d/dt exp(g) (E cos(p) + O sin(p)) = exp(g) ((E' + g' E + p' O) cos(p) + (O' + g' O - p' E) sin(p))

Roots are sought from two places of opposite sign and from guesses in doubles: Newton steps of rising
precision come close, and :mod:`symflex.balls.interval_newton` proves them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import frexp, inf, isfinite, prod, sqrt
from typing import TYPE_CHECKING, overload

from flint import arb

from symflex.algebra.exponential_sum import AxisWave, Monomial, Multiples, Polynomial
from symflex.balls import bits_for_digits, precision, stays_inside
from symflex.budget import spend
from symflex.roots.root import GUARD_BITS

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Doubles = npt.NDArray[np.float64]

FLOAT_BITS = 64  # precision of signs and counts: a few bits more than doubles have
LINEAR, QUADRATIC = 1, 2
REAL, IMAGINARY = 0, 1
DECAYED = 2  # what is smaller than the last bit by this power is bounded rather than evaluated

Rate = tuple[arb, arb]  # coefficients of t and of t^2


@dataclass(frozen=True, slots=True)
class Enclosures:
    """What coefficients and arguments are made of."""

    bits: int  # precision of what follows
    constants: Sequence[arb]  # numbers in coefficients
    rates: Sequence[arb]  # per argument what a power of t is multiplied with
    degrees: Sequence[int]  # that power: 1 or 2

    def rate(self, multiples: Multiples) -> Rate:
        """Return what t and t^2 are multiplied with in a combination of arguments."""
        linear, square = arb(0), arb(0)
        for k, rate, degree in zip(multiples, self.rates, self.degrees, strict=True):
            if k and degree == LINEAR:
                linear += k * rate
            elif k:
                square += k * rate
        return linear, square

    def product(self, monomial: Monomial) -> arb:
        """Return a product of powers of constants."""
        return prod((self.constants[i] ** e for i, e in monomial), start=arb(1))

    def coefficients(self, polynomial: Polynomial) -> dict[int, arb]:
        """Return the coefficients of a polynomial in t."""
        return {
            n: sum((number * self.product(m) for m, number in own.items()), arb(0))
            for n, own in polynomial.items()
        }


@dataclass(frozen=True, eq=False)
class AxisFunction:
    """A real function of t."""

    waves: tuple[AxisWave, ...]  # its terms; at least one does not grow, and the others, for large t, decay
    axis: int  # 0 real, 1 imaginary
    enclosures: Enclosures  # what its terms are made of

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
    def _known(self) -> dict[int, AxisValues]:
        return {}

    def values(self, bits: int) -> AxisValues:
        """Return what evaluates the function at a precision."""
        if bits not in self._known:
            with precision(bits):
                self._known[bits] = AxisValues(self._numbers, bits)
        return self._known[bits]

    @cached_property
    def _numbers(self) -> _Numbers:
        with precision(self.enclosures.bits):
            return _numbers(self.waves, self.enclosures)

    @cached_property
    def _doubles(self) -> _AxisDoubles:
        return _AxisDoubles(self._numbers)

    def sampled(self, t: Doubles) -> tuple[Doubles, Doubles, Doubles]:
        """Return values, derivatives, and the sizes of what is summed, all scaled alike, in doubles."""
        return self._doubles.sampled(t)

    @cached_property
    def _phases(self) -> list[tuple[float, float]]:
        return [(float(p), float(q)) for p, q in self._numbers.phases]

    def fastest(self, t: float) -> float:
        """Return the largest rate of any phase [rad per unit of t]."""
        return max((abs(p + 2 * q * t) for p, q in self._phases), default=0.0)


NONE = -1  # stands for the position of an exponential in a term without one
ZERO = arb(0)
Powers = tuple[tuple[int, arb], ...]  # exponents of t, and coefficients
Term = tuple[int, int, Powers, Powers]  # an exponential's position or none, a phase's, and both amplitudes


@dataclass(frozen=True, slots=True)
class _Numbers:
    """What a function of t and its derivative are made of."""

    growths: list[Rate]  # growths and phases: rates of t and t^2 in exponentials, and in sines and cosines
    phases: list[Rate]
    products: Sequence[tuple[int, int] | None]  # where two exponentials before one make it
    values: list[Term]  # values and slopes: what is summed
    slopes: list[Term]


def _numbers(waves: Sequence[AxisWave], enclosures: Enclosures) -> _Numbers:
    """Return what values and derivatives are made of: per wave its terms, and those of the formula above."""
    growing = sorted({w.growth for w in waves if any(w.growth)}, key=lambda g: (sum(map(abs, g)), g))
    turning = list(dict.fromkeys(w.phase for w in waves))
    growths, phases = ([enclosures.rate(key) for key in keys] for keys in (growing, turning))
    values, slopes = [], []
    for wave in waves:
        g, p = growing.index(wave.growth) if any(wave.growth) else NONE, turning.index(wave.phase)
        even, odd = enclosures.coefficients(wave.even), enclosures.coefficients(wave.odd)
        values.append((g, p, _powers(even), _powers(odd)))
        turn, turn_back = phases[p], (-phases[p][0], -phases[p][1])
        slope_of_even, slope_of_odd = [_derived(even), _by(odd, turn)], [_derived(odd), _by(even, turn_back)]
        if g != NONE:
            slope_of_even.append(_by(even, growths[g]))
            slope_of_odd.append(_by(odd, growths[g]))
        slopes.append((g, p, _powers(_sum(*slope_of_even)), _powers(_sum(*slope_of_odd))))
    return _Numbers(growths, phases, _products(growing), values, slopes)


class AxisValues:
    """Evaluates a function of t, and its derivative, at one precision, which has to be the current one."""

    def __init__(self, numbers: _Numbers, bits: int) -> None:
        self._growths, self._phases = (
            [(+p, +q) for p, q in rates] for rates in (numbers.growths, numbers.phases)
        )
        self._values, self._slopes = _rounded(numbers.values), _rounded(numbers.slopes)
        self._products = numbers.products
        self._negligible = -arb(DECAYED * bits)
        self._decayed = arb(0, 1) * arb(2) ** (-DECAYED * bits)
        self._has_squares = any(q != 0 for _, q in (*numbers.growths, *numbers.phases))

    def value(self, t: arb) -> arb:
        """Return a ball around the values on a ball of t."""
        return _total(t, self._values, *self._moving(t))

    def slope(self, t: arb) -> arb:
        """Return a ball around the derivatives on a ball of t."""
        return _total(t, self._slopes, *self._moving(t))

    def value_and_slope(self, t: arb) -> tuple[arb, arb]:
        """Return both."""
        moving = self._moving(t)
        return _total(t, self._values, *moving), _total(t, self._slopes, *moving)

    def _moving(self, t: arb) -> tuple[list[arb], list[tuple[arb, arb]]]:
        """Return all exponentials, and sines and cosines."""
        square = t * t if self._has_squares else None
        growths: list[arb] = []
        for (p, q), factors in zip(self._growths, self._products, strict=True):
            if factors is not None:
                growths.append(growths[factors[0]] * growths[factors[1]])
                continue
            exponent = p * t if square is None else p * t + q * square
            growths.append(self._decayed if exponent < self._negligible else exponent.exp())
        return growths, [(p * t if square is None else p * t + q * square).sin_cos() for p, q in self._phases]


def _total(t: arb, terms: Sequence[Term], growths: Sequence[arb], turns: Sequence[tuple[arb, arb]]) -> arb:
    total = ZERO
    for g, p, even, odd in terms:
        sine, cosine = turns[p]
        own = ZERO
        for n, c in even:
            own += (c * t**n if n else c) * cosine
        for n, c in odd:
            own += (c * t**n if n else c) * sine
        total += own if g == NONE else own * growths[g]
    return total


class _AxisDoubles:
    """The same in doubles, for many t at once."""

    def __init__(self, numbers: _Numbers) -> None:
        self._growths = [(float(p), float(q)) for p, q in numbers.growths]
        self._phases = [(float(p), float(q)) for p, q in numbers.phases]
        self._terms = [
            (g, p, _floats(even), _floats(odd), _floats(even_slope), _floats(odd_slope))
            for (g, p, even, odd), (_, _, even_slope, odd_slope) in zip(
                numbers.values, numbers.slopes, strict=True
            )
        ]

    def sampled(self, t: Doubles) -> tuple[Doubles, Doubles, Doubles]:
        """Return values, derivatives, and sizes of what is summed."""
        import numpy as np  # lumped systems need none of it

        exponents = [p * t + q * t * t for p, q in self._growths]
        # The last stands for what does not grow; for small t something else may be larger.
        exponents.append(np.zeros_like(t))
        highest = np.maximum.reduce(exponents)
        growths = [np.exp(e - highest) for e in exponents]
        turns = [(np.sin(p * t + q * t * t), np.cos(p * t + q * t * t)) for p, q in self._phases]
        total, slope, size = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        for g, p, even, odd, even_slope, odd_slope in self._terms:
            sine, cosine = turns[p][0] * growths[g], turns[p][1] * growths[g]
            for turn, values, slopes in ((cosine, even, even_slope), (sine, odd, odd_slope)):
                for n, c in values:
                    term = (c * t**n if n else c) * turn
                    total += term
                    size += np.abs(term)
                for n, c in slopes:
                    slope += (c * t**n if n else c) * turn
        return total, slope, size


def _products(growths: Sequence[Multiples]) -> tuple[tuple[int, int] | None, ...]:
    """Return for exponentials that are products of two before them the positions of these."""
    positions: dict[Multiples, int] = {}
    products: list[tuple[int, int] | None] = []
    for position, growth in enumerate(growths):
        factors = None
        for other, i in positions.items():
            rest = positions.get(tuple(a - b for a, b in zip(growth, other, strict=True)))
            if rest is not None:
                factors = (i, rest)
                break
        products.append(factors)
        positions[growth] = position
    return tuple(products)


def _derived(polynomial: dict[int, arb]) -> dict[int, arb]:
    return {n - 1: n * c for n, c in polynomial.items() if n}


def _by(polynomial: dict[int, arb], rate: Rate) -> dict[int, arb]:
    """Return a polynomial times the derivative of ``p t + q t^2``."""
    coefficients: dict[int, arb] = {}
    for n, c in polynomial.items():
        for power, factor in ((n, rate[0]), (n + 1, 2 * rate[1])):
            if factor != 0:
                coefficients[power] = coefficients.get(power, arb(0)) + c * factor
    return coefficients


def _sum(*polynomials: dict[int, arb]) -> dict[int, arb]:
    total: dict[int, arb] = {}
    for polynomial in polynomials:
        for n, c in polynomial.items():
            total[n] = total.get(n, arb(0)) + c
    return total


def _powers(polynomial: dict[int, arb]) -> Powers:
    return tuple(sorted(polynomial.items()))


def _rounded(terms: Sequence[Term]) -> list[Term]:
    """Return terms with coefficients of the current precision."""
    return [
        (g, p, tuple((n, +c) for n, c in even), tuple((n, +c) for n, c in odd)) for g, p, even, odd in terms
    ]


def _floats(powers: Powers) -> list[tuple[int, float]]:
    return [(n, float(c)) for n, c in powers]


GUESS_BITS = 46  # bits of a guess in doubles that are right as a rule
LEAST_BITS = 16  # right bits of a point below which no proof is tried
MARGIN_BITS = 4  # bits of a Newton step's accuracy that are not relied on
ROUNDS = 40  # interval Newton steps; each nearly doubles what is known, so that few are ever taken
BISECTIONS = 100  # nearly twice the bits of a double
CLOSER = 1e-12  # relative to t: no further Newton step is needed after one as short as this


class AxisNewton:
    """Encloses roots to a number of significant digits of abs(s)."""

    def __init__(self, digits: int) -> None:
        self._goal_bits = bits_for_digits(digits + 2)
        self._half_bits = self._goal_bits // 2 + GUARD_BITS
        self._bits = bits_of(digits)
        with precision(self._bits):
            self._goal = arb(10) ** -(digits + 2)

    def frequency(self, source: AxisFunction, guess: float) -> arb | None:
        """Return abs(s) of the root next to t, proved to be alone in a small interval, else ``None``."""
        t, known = self._approached(source, guess)
        while known >= LEAST_BITS:
            spend()
            frequency = self._enclosed(source, t, known)
            if frequency is not None:
                return frequency
            # Next to another root less is known than it seems.
            known //= 2
        return None

    def _approached(self, source: AxisFunction, guess: float) -> tuple[arb, int]:
        """Return t close to a root, and how many of its bits are right by all appearances."""
        t, known = arb(guess), GUESS_BITS
        turned = guess * source.fastest(guess)
        if not isfinite(turned):
            return t, 0  # too large for doubles, in which nothing is then known
        lost = int(turned).bit_length() + MARGIN_BITS
        while 2 * known - lost < self._goal_bits:
            spend()
            bits = _level(2 * known + GUARD_BITS, self._half_bits)
            with precision(bits):
                value, slope = source.values(bits).value_and_slope(t)
                step = value / slope
                share = float(step / t)
                t = (t - step).mid()
            if not t.is_finite():
                break
            # What is too small for a double says nothing of its size.
            agreeing = -frexp(share)[1] if share else known
            closer = min(2 * agreeing - lost, bits - MARGIN_BITS)
            if closer <= known:
                break
            known = closer
        return t, known

    def _enclosed(self, source: AxisFunction, t: arb, known: int) -> arb | None:
        """Return abs(s) of the only root in a ball about t, ``None`` where that is not proved."""
        slope_bits = _level(known + GUARD_BITS, self._half_bits)
        with precision(slope_bits):
            radius = abs(t) * arb(2) ** -known
            box = arb(t, radius)
            slope = source.values(slope_bits).slope(box)
        for i in range(ROUNDS):
            bits = _level(2 * known + GUARD_BITS, self._bits)
            with precision(bits):
                step = source.values(bits).value(t) / slope
                # All of the ball that the step leads to lies inside the ball it started from.
                if i == 0 and not stays_inside(step, radius):
                    return None
                box = t - step
                if box.rad() < self._goal * abs(box):
                    return source.natural_frequency(box)
            accurate = box.rel_accuracy_bits()
            if accurate <= known + MARGIN_BITS:
                return None
            t, known = box.mid(), accurate
            slope_bits = _level(known + GUARD_BITS, self._half_bits)
            with precision(slope_bits):
                slope = source.values(slope_bits).slope(box)
        return None


def bits_of(digits: int) -> int:
    """Return the precision that it takes to enclose roots to a number of digits."""
    return bits_for_digits(digits + 2) + GUARD_BITS


def changes_sign(source: AxisFunction, low: float, high: float) -> bool:
    """Tell whether a function has opposite signs at two t: proved."""
    values = source.values(FLOAT_BITS)
    with precision(FLOAT_BITS):
        return bool(values.value(arb(low)) * values.value(arb(high)) < 0)


def bracketed(source: AxisFunction, low: float, high: float) -> float:
    """Return t of a root between two of opposite sign, by safeguarded Newton steps."""
    values = source.values(FLOAT_BITS)
    with precision(FLOAT_BITS):
        rises = values.value(arb(high)) > 0
        t = (low + high) / 2
        for _ in range(BISECTIONS):
            value, slope = values.value_and_slope(arb(t))
            low, high = (low, t) if (value > 0) == rises else (t, high)
            closer = t - float(value) / float(slope) if slope != 0 else inf
            if not low <= closer <= high:
                closer = (low + high) / 2
            if abs(closer - t) <= CLOSER * t:
                return closer
            t = closer
    return t


@cache
def _level(bits: int, most: int) -> int:
    """Return one of few precisions, so that constants are evaluated for few."""
    level = FLOAT_BITS
    while level < bits:
        level += max(FLOAT_BITS, level // 4)
    return min(level, most)
