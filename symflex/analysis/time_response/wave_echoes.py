"""Echoes of waves that change their form on the way, by damping or a foundation, but also fronts.

Input: a bound transfer function whose waves all have a speed, and times. Output: enclosed values and jumps.

Example: a rod that loses energy to what surrounds it, free at its end, where a force acts. Its wavenumber is

    gamma  =  sqrt(s^2/c^2 + a s)  =  s/c + a c/2 - a^2 c^3/(8 s) + ...

so a wave that has gone a way d is late by d/c, weaker by exp(-a c d/2), and what follows its front is a power
series in x = 1/s. All series here are such: of wavenumbers over s, of reflections, of every echo

    exp(-s T) (h_1/s + h_2/s^2 + h_3/s^3 + ...)    which is    h_1 + h_2 (t - T) + h_3 (t - T)^2/2 + ...

in time. They converge for abs(s) > R, outside a circle about all branch points; with abs(F) <= M there,
Cauchy's estimate abs(h_k) <= M R^k bounds what is left out. M comes from the same sum of echoes with sizes in
place of series. Nothing is known or asked of poles, and loops need not be stable.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

from flint import acb, acb_series, arb, arb_poly, arb_series

from symflex.algebra import Dispersion, Factored, degree_in
from symflex.algebra.exponential_sum import ExponentialSum, arguments_of
from symflex.analysis.time_response.delayed_terms import (
    NO_DELAY,
    NO_FORMULA,
    TOO_MANY,
    Delay,
    DelayReader,
    later,
    sum_of,
)
from symflex.analysis.time_response.echoes import TooManyEchoesError, arriving, check_order, earliest
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import Gathered, Sampled
from symflex.balls import Value, at_centre, ball, bits_for_digits, precision, series_terms
from symflex.budget import spend
from symflex.roots.functions.exponential_values import ExponentialValues, exponential_sums
from symflex.roots.problem import polynomial_in_s
from symflex.transfer import BoundTransferFunction

NO_FRONT = "some waves have no front"  # why a function is not read as fronts


@dataclass(frozen=True, eq=False)
class WaveQuotient:
    """A function whose exponentials are waves with speeds, and delays."""

    bound: BoundTransferFunction
    reader: DelayReader
    sums: tuple[tuple[ExponentialSum, int], ...]  # factors and their exponents

    def echoed(self, integrations: int, times: SampleTimes, digits: int) -> Sampled:
        """Return the response with a radius of about 10 to minus ``digits``; else TooManyEchoesError."""
        with precision(EFFORT.wave_bits):
            seconds = times.enclosed()
            last = seconds[-1].upper()
            bounded = self._bounded(last)
            if bounded is None:
                raise TooManyEchoesError
            radius, largest, echoes = bounded
            reach = radius * last
            bits = bits_for_digits(digits) + EFFORT.wave_guard_bits
            # With this power of 1/s the function may begin.
            shift = integrations - sum(d * e for d, (_, e) in zip(self.degrees, self.sums, strict=True))
            missing = largest * radius ** (1 - shift)
            count = 1
            # Of sum(M R^k t^(k - 1)/(k - 1)!) from some k on.
            while not (count > 2 * reach and missing < arb(2) ** -bits):
                missing = missing * reach / count
                count += 1
                if echoes * count**2 > EFFORT.wave_work:
                    raise TooManyEchoesError
            missing = (2 * missing).upper()
            lost = int(1.5 * float((reach + largest.log() + abs(radius.log())).upper()))
        with precision(bits + lost), series_terms(count + max(0, 1 - shift) + 1):
            return self._summed(shift, times, missing)

    @cached_property
    def degrees(self) -> tuple[int, ...]:
        """Per factor, the highest power of s and of wavenumbers."""
        with precision(EFFORT.wave_bits):
            return tuple(
                max(sum(e for _, e in powers) for terms in factor for _, powers in terms)
                for factor in self.values.coefficients
            )

    @property
    def values(self) -> ExponentialValues:
        """What evaluates all sums, at the current precision."""
        return ExponentialValues(self.bound.kernel_values(), self.reader.arguments, self.sums)

    def _bounded(self, last: arb) -> tuple[arb, arb, int] | None:
        """Return R, a bound of all echoes outside, and how many there are."""
        durations = self.reader.durations
        origin = _AtInfinity.on(self, acb(0))
        begun = None if origin is None else self._normalised(origin)
        if origin is None or begun is None:
            return None
        check_order((*begun.above, *begun.below), durations)
        radius = 1 / last
        while radius * last < EFFORT.wave_reach:
            spend()
            sizes = self._sizes(radius, origin, at_centre(begun.lead))
            if sizes is None:
                radius = EFFORT.wave_circles * radius
                continue
            echoes = arriving(*sizes, _total, lambda grown, q: (grown * q).upper(), durations, last)
            echo_sizes = [size for _, size in echoes]
            return radius, max(echo_sizes, default=arb(1), key=arb.mid).max(1), len(echo_sizes)
        return None

    def _sizes(
        self, radius: arb, origin: _AtInfinity, lead: acb
    ) -> tuple[dict[Delay, arb], dict[Delay, arb]] | None:
        """Return how large what begins and what follows are outside a circle; None if not analytic there."""
        above: dict[Delay, arb] = {}
        below: dict[Delay, arb] = {}
        for k in reversed(range(EFFORT.wave_arcs)):
            turn = arb(k).union(arb(k + 1)) / EFFORT.wave_arcs * arb.pi()
            arc = _AtInfinity.on(self, acb(0, turn).exp() / radius, origin)
            parts = None if arc is None else self._normalised(arc)
            if parts is None or _may_turn(at_centre(parts.lead) / lead):
                return None
            for sizes, side in ((above, parts.above), (below, parts.below)):
                for delay, value in side.items():
                    sizes[delay] = sizes.get(delay, arb(0)).max(abs(at_centre(value)).upper())
        return above, below

    def _normalised(self, at_infinity: _AtInfinity) -> _Parts | None:
        """Return the function over powers of s; None if D_0 may be 0."""
        above: dict[Delay, Value] = {NO_DELAY: acb(ball(self.bound.ratio.unit))}
        below: dict[Delay, Value] = {NO_DELAY: acb(1)}
        for number, (_, exponent) in enumerate(self.sums):
            sums = at_infinity.sum(number)
            for _ in range(abs(exponent)):
                above, below = (
                    (_product(above, sums), below) if exponent > 0 else (above, _product(below, sums))
                )
        first = earliest(below, self.reader.durations)
        lead = below.pop(first)
        if at_centre(lead).contains(0):
            return None
        begun = {later(d, first): v / lead for d, v in above.items()}
        return _Parts(begun, {later(d, first): -v / lead for d, v in below.items()}, lead)

    def _summed(self, shift: int, times: SampleTimes, missing: arb) -> Sampled:
        at_infinity = _AtInfinity.on(self, acb_series([0, 1]))
        parts = None if at_infinity is None else self._normalised(at_infinity)
        if parts is None:
            raise TooManyEchoesError
        durations = self.reader.durations
        seconds = times.enclosed()
        total = Gathered(seconds)
        off = arb(0, missing)
        begun, below = ({d: _real(v) for d, v in side.items()} for side in (parts.above, parts.below))
        for echo, series in arriving(
            begun, below, _total, lambda series_then, q: series_then * q, durations, seconds[-1]
        ):
            delay = durations.seconds(echo)
            by_power = dict(enumerate(series.coeffs(), shift))  # of 1/s
            zero = arb(0)
            weights = [by_power.get(-k, zero) for k in range(max(0, 1 - shift))]
            coefficients = [by_power.get(k, zero) for k in range(1, max(by_power, default=0) + 1)] or [zero]
            values = _in_time(coefficients, times, total.start(delay), delay, off)
            total.add(delay, weights, coefficients[0], values, is_late=bool(echo))
        return total.sampled("wave echoes")


def _in_time(coefficients: Sequence[arb], times: SampleTimes, start: int, delay: arb, off: arb) -> list[arb]:
    """Return the sum of ``h_k t^k/k!`` at times from one on, less a delay."""
    scaled, factorial = [], arb(1)
    for k, h in enumerate(coefficients):
        factorial = factorial * max(k, 1)
        scaled.append(h / factorial)
    polynomial = arb_poly(scaled)
    return [polynomial(t) + off for t in times.enclosed(start, delay)]


def _real(series: Value) -> arb_series:
    """Return a series without the imaginary parts, which are zero."""
    if isinstance(series, acb_series):
        return arb_series([c.real for c in series.coeffs()], series.prec)
    return arb_series([series.real])


def _product(a: Mapping[Delay, Value], b: Mapping[Delay, Value]) -> dict[Delay, Value]:
    product: dict[Delay, Value] = {}
    for first, one in a.items():
        for second, other in b.items():
            delay, term = sum_of(first, second), one * other
            product[delay] = product[delay] + term if delay in product else term
    return product


Sum = TypeVar("Sum", arb, arb_series)


def _total(parts: list[Sum]) -> Sum:
    return sum(parts[1:], parts[0])


@dataclass(frozen=True, slots=True)
class _Parts:
    """``above/(1 - below)``: what begins, N/D_0, and what follows, -D_k/D_0, by delays."""

    above: Mapping[Delay, Value]
    below: Mapping[Delay, Value]
    lead: Value  # D_0


@dataclass(frozen=True, eq=False)
class _AtInfinity:
    """What terms are made of at x = 1/s, on a ball about 0 or as series."""

    waves: WaveQuotient
    values: ExponentialValues
    x: Value
    slownesses: Mapping[str, Value]  # of every wavenumber, over s
    spread: Sequence[Value]  # of every argument, without what is proportional to s

    @classmethod
    def on(cls, waves: WaveQuotient, x: Value, origin: _AtInfinity | None = None) -> _AtInfinity | None:
        """Return the place, on a circle about the ``origin`` without ``spread``; None if not analytic."""
        values = waves.values
        roots: dict[str, Value] = {}
        for law in values.evaluator.table.dispersions:
            if law.wavenumbers:
                try:
                    over = [_over(waves.bound, c, law.order - i, x) for i, c in enumerate(law.characteristic)]
                    roots.update(law.roots(over, _root))
                except _BranchError:
                    return None
        slopes: dict[str, Value] = {}
        for name, g in roots.items():
            if isinstance(g, acb_series):
                slopes[name] = acb_series(g.coeffs()[1:], g.prec - 1)
            elif origin is not None:
                slopes[name] = (g - origin.slownesses[name]) / x
        # A delay is proportional to s.
        rates = [slopes.get(argument.wavenumber, acb(0)) for argument in values.arguments]
        spread = [rate * length for rate, length in zip(rates, values.lengths, strict=True)]
        return cls(waves, values, x, roots, spread)

    def sum(self, number: int) -> dict[Delay, Value]:
        """Return one factor over the highest power of s, by delays."""
        terms, _ = self.values.sums[number]
        top = self.waves.degrees[number]
        amplitudes: dict[Delay, Value] = {}
        for (exponent, _), valued in zip(terms.terms.items(), self.values.coefficients[number], strict=True):
            amplitude: Value = acb(0)
            for number_, powers in valued:
                term: Value = number_ * self._power(self.x, top - sum(e for _, e in powers))
                for name, e in powers:
                    if name != "s":
                        term = term * self._power(self.slownesses[name], e)
                amplitude = amplitude + term
            for i, a, _ in exponent:
                amplitude = amplitude * (self.spread[i] * a).exp()
                if i in self.waves.reader.decays:
                    amplitude = amplitude * self.waves.reader.decay(i) ** a
            delay = self.waves.reader.delay_of(exponent)
            amplitudes[delay] = amplitudes[delay] + amplitude if delay in amplitudes else amplitude
        return amplitudes

    @staticmethod
    def _power(value: Value, exponent: int) -> Value:
        return value**exponent if exponent else acb(1)


class _BranchError(Exception):
    """Something that may not be analytic."""


def _may_turn(value: acb) -> bool:
    """Tell whether a ball touches the real numbers that are not positive, about which it may turn."""
    return not (value.real > 0 or value.imag > 0 or value.imag < 0)


def _root(square: Value) -> Value:
    first = at_centre(square)
    if isinstance(square, acb_series):
        if _may_turn(first):
            raise _BranchError
        return square.sqrt()
    middle = first.mid()
    share = first.rad() / abs(middle)
    if _may_turn(first) or not share < 1:
        raise _BranchError
    # A root of a wide ball is narrower than its parts: sqrt(1 + h) is off 1 by 1 - sqrt(1 - abs(h)) at most.
    off = (abs(middle.sqrt()) * (1 - (1 - share).sqrt())).upper()
    return middle.sqrt() + acb(arb(0, off), arb(0, off))


def _over(bound: BoundTransferFunction, value: Factored, power: int, x: Value) -> Value:
    """Return a product of polynomials in s, over a power of it, where it is analytic in x."""
    total: Value = acb(ball(value.unit))
    remaining = power
    for factor, exponent in value.factors:
        polynomial = polynomial_in_s(bound, factor).enclosure()
        evaluated: Value = acb(0)
        for c in polynomial.coeffs():
            evaluated = evaluated * x + c
        if exponent < 0 and _may_turn(at_centre(evaluated) / acb(polynomial[polynomial.degree()])):
            raise _BranchError
        remaining -= int(polynomial.degree()) * exponent
        total = total * evaluated**exponent
    if remaining < 0:
        raise _BranchError
    return total * x**remaining if remaining else total


def wave_quotient(bound: BoundTransferFunction) -> WaveQuotient | str:
    """Return a function as waves with speeds, or why it is none."""
    arguments = arguments_of(bound.kernels)
    if arguments is None:
        return NO_FORMULA
    slowness: dict[str, Factored] = {}
    for law in bound.kernels.dispersions:
        square = _squared_slowness(bound, law)
        if square is None and law.kind != "exponential":
            return "some waves have two wavenumbers" if law.kind == "pair" else NO_FRONT
        slowness |= dict.fromkeys(law.wavenumbers, square) if square is not None else {}
    reader = DelayReader.of(bound, arguments, slowness)
    if isinstance(reader, str):
        return reader
    summed = exponential_sums(bound.ratio, bound.kernels)
    if summed is None:
        return TOO_MANY
    if any(b for terms, _ in summed[1] for e in terms.terms for _, _, b in e):
        return NO_FRONT
    return WaveQuotient(bound, reader, summed[1])


def _squared_slowness(bound: BoundTransferFunction, law: Dispersion) -> Factored | None:
    """Return 1/c^2 of the fronts of a law of one wave, None of any other, or if there is none."""
    if law.kind != "wave":
        return None
    lead = _at_fronts(bound, law.characteristic[0], law.order)
    return None if lead is None or lead.is_zero else -lead


def _at_fronts(bound: BoundTransferFunction, value: Factored, power: int) -> Factored | None:
    """Return the coefficient of a power of s that a coefficient grows with; zero where it grows less."""
    ring = bound.ratio.ring
    if value.is_zero:
        return value
    degree = sum(degree_in(f, 0) * e for f, e in value.factors)
    if degree > power:
        return None
    total = Factored.number(ring, value.unit if degree == power else 0)
    for factor, exponent in value.factors:
        highest = degree_in(factor, 0)
        terms = {(0, *map(int, m[1:])): int(c) for m, c in factor.terms() if int(m[0]) == highest}
        total = total * Factored.polynomial(ring, ring.context.from_dict(terms)) ** exponent
    return total
