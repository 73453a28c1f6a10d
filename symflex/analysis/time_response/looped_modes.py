"""Beams in loops with delays: one sum over modes more after every turn of the loop.

Input: a bound transfer function with delays, and waves that spread. Output: values, and what is not proved.

Example: a force k (r - x) on a beam with receptance P, where x is measured T late. With L = k P

    X/R  =  L/(1 + L e^(-sT))  =  L  -  L^2 e^(-sT)  +  L^3 e^(-2sT)  -  ...

and up to t = 2T the first two terms are all there is, as in :mod:`~symflex.analysis.time_response.echoes`.
Here L is the sum over its lowest modes, c_1/(s - p_1) + c_2/(s - p_2) + ..., so the terms have the same poles
all, each once more often than the one before. All is known from Laurent series at every pole, about which L
is ``c_i/x + l_0 + l_1 x + ...``, and a term of the expansion a product of such series.

What the modes left out add to L and to the response is within a radius each, if the loop were open.
:mod:`~symflex.analysis.time_response.loop_bound` says by how much the loop enlarges them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, acb_mat, acb_series, arb

from symflex.algebra import NO_KERNELS, Factored, KernelTable, degree_in, irreducible_factors
from symflex.analysis.rational.laurent import series_length
from symflex.analysis.time_response.delayed_terms import NO_DELAY, Delay, Durations, later, sum_of
from symflex.analysis.time_response.echoes import Gathered, Sampled, TooManyEchoesError, arriving, earliest
from symflex.analysis.time_response.exponentials import ExponentialTerm, values_of
from symflex.analysis.time_response.loop_bound import PoleSum, loop_bound
from symflex.analysis.time_response.modal import DIGITS, MOST_DIGITS, estimated_step, proved_modes
from symflex.analysis.time_response.partial_fractions import EnclosedQuotient, at_infinity, partial_fractions
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import precision
from symflex.roots.problem import problem_of
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Kernel, Ring
    from symflex.analysis.time_response.modal import PartialSum
    from symflex.transfer import BoundTransferFunction

BITS = 320
"""Of series, whose products lose digits to cancellation."""
MOST_TURNS = 60
"""Of the loop: every pole is as often a pole then, and a series at each has so many terms."""
MOST_WORK = 2e7
"""Squared number of poles times terms of a series: some ten seconds."""
DIGITS_TRIED = (8, 7, 6, 5)
"""Of the parts of a loop, where those asked for take too many modes."""
FINEST = 2.0**-30
"""Of the last time: what is left out is bounded from there on, and before nothing moves as much."""
POINTS = 33
"""At which the size of a part of a loop is seen."""


@dataclass(frozen=True, eq=False)
class DelayedLoop:
    """A function as ``(A_0 + A_1 e^(-s a_1) + ...)/(1 + L_1 e^(-s d_1) + ...)``, all without delays."""

    above: Mapping[Delay, BoundTransferFunction]
    below: Mapping[Delay, BoundTransferFunction]
    durations: Durations


@dataclass(frozen=True, eq=False)
class ModalPart:
    """One of these as a sum over poles p in the upper half plane, and on the real axis."""

    poles: Mapping[int, tuple[acb, ...]]  # by number of a pole, coefficients of 1/(s - p), 1/(s - p)^2, ...
    rest: arb  # by how much its step response differs at most
    speed: arb | None  # the same of its impulse response
    is_proved: bool


@dataclass(frozen=True)
class SeriesAtPole:
    """A series at one pole, ``x^-order (coefficients[0] + coefficients[1] x + ...)``."""

    order: int
    series: acb_series

    def __mul__(self, other: SeriesAtPole) -> SeriesAtPole:
        return SeriesAtPole(self.order + other.order, self.series * other.series)

    def __neg__(self) -> SeriesAtPole:
        return SeriesAtPole(self.order, -self.series)

    def __add__(self, other: SeriesAtPole) -> SeriesAtPole:
        order = max(self.order, other.order)
        moved = [acb_series([acb(0)] * (order - p.order) + p.series.coeffs()) for p in (self, other)]
        return SeriesAtPole(order, moved[0] + moved[1])

    @property
    def principal_part(self) -> tuple[acb, ...]:
        """The coefficients of 1/x, 1/x^2, ..."""
        return tuple(self.series[self.order - 1 - j] for j in range(self.order))


def delayed_loop(bound: BoundTransferFunction) -> DelayedLoop | None:
    """Return a function taken apart by its delays; None where delays are powers below, or come too early."""
    table = bound.kernels
    delays = [k for k in table.kernels if k.dispersion.kind == "exponential"]
    above, below = (_by_delay(part, delays) for part in (bound.num, bound.den))
    if above is None or below is None:
        return None

    def seconds(kernel: Kernel) -> arb:
        evaluator = bound.kernel_values()
        values = {"s": acb(1), **{name: acb(c) for name, c in evaluator.constants.items()}}
        rate, length = (evaluator.value(x, values) for x in (kernel.dispersion.shift, kernel.length))
        return at_centre(rate * length).real

    durations = Durations(tuple(partial(seconds, k) for k in delays), (), ())
    first = earliest(below, durations)
    lead = below[first]
    laws = tuple(law for law in table.dispersions if law.kind != "exponential")
    plain = KernelTable(laws, tuple(k for k in table.kernels if k not in delays))

    def over_lead(value: Factored) -> BoundTransferFunction:
        return replace(
            bound, ratio=value / lead, parts=(value, lead), kernels=plain, hidden=(), is_of_model=False
        )

    begun, more = (
        {later(d, first): over_lead(v) for d, v in side.items() if not v.is_zero} for side in (above, below)
    )
    more.pop(NO_DELAY)
    if any(durations.seconds(d) < 0 for d in begun if d):
        return None
    return DelayedLoop(begun, more, durations)


def _by_delay(value: Factored, delays: Sequence[Kernel]) -> dict[Delay, Factored] | None:
    """Return an entire function as a sum of delays; None where a power below is one."""
    ring = value.ring
    places = [ring.index[k.generator] for k in delays]
    total = {NO_DELAY: Factored(ring, value.unit)}
    for factor, exponent in value.factors:
        own: dict[Delay, dict[tuple[int, ...], int]] = {}
        for monomial, number in factor.terms():
            delay = tuple((i, Fraction(int(monomial[p]))) for i, p in enumerate(places) if monomial[p])
            kept = tuple(0 if p in places else int(e) for p, e in enumerate(monomial))
            own.setdefault(delay, {})[kept] = int(number)
        terms = {d: _factored(ring, ring.context.from_dict(t)) for d, t in own.items()}
        if len(terms) == 1:
            ((delay, term),) = terms.items()
            terms = {tuple((i, m * exponent) for i, m in delay): term**exponent}
        elif exponent < 0:
            return None
        for _ in range(exponent if len(terms) > 1 else 1):
            before, total = total, {}
            for d, v in before.items():
                for e, w in terms.items():
                    when = sum_of(d, e)
                    total[when] = total[when] + v * w if when in total else v * w
    return {d: v for d, v in total.items() if not v.is_zero}


def _factored(ring: Ring, value: fmpz_mpoly) -> Factored:
    """Return a polynomial as a product, so that controllers stand apart from beams."""
    number, factors = irreducible_factors(value)
    total = Factored.number(ring, number)
    for factor, exponent in factors:
        total = total * Factored.polynomial(ring, factor) ** exponent
    return total


def looped_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> tuple[Sampled, str | None] | None:
    """Return the response, and what is not proved of it; None where the function is not such a loop.

    Raises TooManyEchoesError where it takes too long.
    """
    loop = delayed_loop(bound)
    if loop is None:
        return None
    with precision(BITS):
        seconds = times.enclosed()
        last = seconds[-1]
        turns = _turns(loop, last)
        if turns > MOST_TURNS:
            raise TooManyEchoesError
    grid = float(times.seconds[-1]) * np.linspace(0, 1, POINTS)
    moments = SampleTimes.of([0.0, FINEST * float(grid[-1]), *grid[1:]])
    wanted = min(digits, MOST_DIGITS)
    with precision(BITS):
        for fewer in (*(d for d in DIGITS_TRIED if d < wanted), 0):
            poles: list[acb] = [acb(0)]
            above, below = (
                {d: _part(tf, moments, wanted, poles) for d, tf in side.items()}
                for side in (loop.above, loop.below)
            )
            length = _length(above, below, turns, integrations)
            if len(poles) ** 2 * length <= MOST_WORK:
                break
            wanted = fewer
        else:
            raise TooManyEchoesError
        with series_length(length):
            parts = [*above.values(), *below.values()]
            series = _at_poles(parts, poles, length)
            begun = {d: _integrated(at, poles, integrations) for d, at in zip(above, series, strict=False)}
            more = dict(zip(below, series[len(above) :], strict=True))
            total = Gathered(seconds)
            for echo, at in arriving(begun, more, _total, _fed_back, loop.durations, last):
                terms = [
                    ExponentialTerm(p, tuple((1 if p.imag == 0 else 2) * c for c in own.principal_part))
                    for p, own in zip(poles, at, strict=True)
                    if own.order
                ]
                delay = loop.durations.seconds(echo)
                start = total.start(delay)
                total.add(delay, (), arb(0), values_of(terms, times, start, delay), is_late=bool(echo))
        found = total.sampled
        is_proved = all(part.is_proved and part.speed is not None for part in parts)
        if not (is_proved or integrations):
            return None
        largest = max((abs(y.mid()) for y in found.values), default=arb(0))
        off = (
            _proved_rest(loop, above, below, poles, integrations, last)
            if is_proved
            else _estimated_rest(above, below, integrations, last, largest)
        )
    if off is None or not all(y.is_finite() for y in found.values):
        message = f"the loop of {bound.name} grows too much until then to say what high modes add"
        raise UncertifiedError(Diagnostic("SF810", message, None, "ask for a shorter time"))
    reason = None if is_proved else "what high modes add in the loop is estimated"
    values = tuple(y + arb(0, off) for y in found.values)
    return replace(found, values=values, method="looped modes"), reason


def _estimated_rest(
    above: Mapping[Delay, ModalPart],
    below: Mapping[Delay, ModalPart],
    integrations: int,
    last: arb,
    largest: arb,
) -> arb:
    """Return how far the response may be from that of the sums, as if the loop did not turn again."""
    given, eps = (sum((part.rest for part in side.values()), arb(0)) for side in (above, below))
    return (given * last ** (integrations - 1) + eps * largest).upper()


def _proved_rest(
    loop: DelayedLoop,
    above: Mapping[Delay, ModalPart],
    below: Mapping[Delay, ModalPart],
    poles: Sequence[acb],
    integrations: int,
    last: arb,
) -> float | None:
    """Return how far the response may be from that of the sums; None where the loop grows too much."""
    until = float(last.upper())
    sums = [
        [
            PoleSum.of(poles, tuple(part.poles.items()), float(loop.durations.seconds(d).lower()))
            for d, part in side.items()
        ]
        for side in (above, below)
    ]
    bounds = loop_bound(sums[0], sums[1], max(integrations, 1), until)
    if bounds is None:
        return None
    sides = [list(side.values()) for side in (above, below)]
    rests = [sum(float(part.rest.upper()) for part in side) for side in sides]
    speeds = [sum(0.0 if p.speed is None else float(p.speed.upper()) for p in side) for side in sides]
    given, eps = speeds if integrations == 0 else (rests[0] * until ** (integrations - 1), rests[1])
    return bounds.enlarged(given, eps, speeds[1], until)


def _turns(loop: DelayedLoop, last: arb) -> int:
    """Return how often at most something comes round by a time."""
    shortest = min((loop.durations.seconds(d) for d in loop.below), key=arb.mid, default=last + 1)
    return int(float((last / shortest).upper()))


def _part(bound: BoundTransferFunction, times: SampleTimes, digits: int, poles: list[acb]) -> ModalPart:
    """Return a function as a sum over poles; those that are new are added to the list."""
    spend()
    found = proved_modes(bound, 1, times, digits)
    if found is not None and found.rest.is_finite():
        return _of_step(found, poles, is_proved=True)
    rational = _controller(bound)
    if rational is not None:
        inner = replace(
            bound,
            ratio=bound.ratio / rational.ratio,
            parts=(bound.num / rational.num, bound.den / rational.den),
        )
        found = proved_modes(inner, 1, times, digits)
        if found is not None and found.rest.is_finite():
            plant = _of_step(found, poles, is_proved=True)
            whole = _controlled(plant, rational, poles, arb(float(times.seconds[-1])))
            if whole is not None:
                return whole
    return _of_step(estimated_step(bound, times), poles, is_proved=False)


def _of_step(modes: PartialSum, poles: list[acb], *, is_proved: bool) -> ModalPart:
    """Return the function whose step response is a sum.

    What the sum is at t = 0, where the response is 0, is left out as well: nothing comes at once then.
    """
    found: dict[int, tuple[acb, ...]] = {}
    start = arb(0)
    for term in modes.terms:
        p = term.rate
        own = [c * (1 if p.imag == 0 else 0.5) for c in term.coefficients]
        start += term.coefficients[0].real
        # Times s: the coefficient of 1/(s - p)^k is p times what it was, and takes the next one.
        found[_number(p, poles)] = tuple(
            p * c + (own[k + 1] if k + 1 < len(own) else 0) for k, c in enumerate(own)
        )
    return ModalPart(found, (modes.rest + abs(start)).upper(), modes.speed, is_proved)


def _controller(bound: BoundTransferFunction) -> BoundTransferFunction | None:
    """Return the factors of s alone that are not of the beam, if they do not grow with s."""
    ring = bound.ratio.ring
    of_beams = [f for law in bound.kernels.dispersions for c in law.characteristic for f, _ in c.factors]
    ratio = bound.ratio.filter(
        lambda f: (
            f not in of_beams
            and f != ring.context.gen(0)
            and degree_in(f, 0) > 0
            and not any(degree_in(f, ring.index[name]) for name in bound.kernels.generators)
        )
    )
    if ratio.is_one or sum(degree_in(f, 0) * e for f, e in ratio.factors) > 0:
        return None
    return replace(bound, ratio=ratio, kernels=NO_KERNELS, parts=None)


def _controlled(
    plant: ModalPart, rational: BoundTransferFunction, poles: list[acb], last: arb
) -> ModalPart | None:
    """Return a function times a rational one; None where they may share poles, or some are too close.

    A radius grows by no more than the integral of the absolute value of the rational one in time.
    """
    below = [(f, -e) for f, e in rational.ratio.factors if e < 0]
    roots = find_polynomial_roots(problem_of(rational, below), DIGITS)
    bits = max(BITS, *(root.working_bits() for root in roots))
    quotient = EnclosedQuotient.of(rational, bits)
    terms = partial_fractions(quotient, roots, 0)
    if terms is None:
        return None
    weights, _ = at_infinity(quotient, 0)
    through = weights[0] if weights else arb(0)
    size, found = abs(through), {}
    for term in terms:
        number, p = _number(term.rate, poles), term.rate
        if number in plant.poles:
            return None
        found[number] = tuple(c * (1 if p.imag == 0 else 0.5) for c in term.coefficients)
        for j, c in enumerate(term.coefficients, 1):
            lasting = last**j / arb(j + 1).gamma() * (p.real * last).exp().max(1)
            size += abs(c) * (lasting.min((-p.real) ** -j) if p.real < 0 else lasting)
    length = 1 + max(len(c) for part in (found, plant.poles) for c in part.values())
    with series_length(length):
        own = ModalPart(found, arb(0), None, is_proved=True)
        product = {
            i: (a * (b + SeriesAtPole(0, acb_series([through])))).principal_part
            for i, (a, b) in enumerate(zip(*_at_poles((plant, own), poles, length), strict=True))
            if i in found or i in plant.poles
        }
    speed = None if plant.speed is None else (size * plant.speed).upper()
    return ModalPart(product, (size * plant.rest).upper(), speed, is_proved=True)


def _number(pole: acb, poles: list[acb]) -> int:
    """Return which of the poles one is; functions of one loop share them.

    Of both all are known up to some frequency, so where the ball of one meets that of another, and no third,
    they are the same.
    """
    same = [i for i, p in enumerate(poles) if p.overlaps(pole)]
    if len(same) == 1:
        return same[0]
    poles.append(pole)
    return len(poles) - 1


def _length(
    above: Mapping[Delay, ModalPart], below: Mapping[Delay, ModalPart], turns: int, integrations: int
) -> int:
    """Return the highest order of a pole of the response."""
    begun, more = (
        max((len(c) for part in side.values() for c in part.poles.values()), default=0)
        for side in (above, below)
    )
    return begun + integrations + turns * more


def _at_poles(parts: Sequence[ModalPart], poles: Sequence[acb], length: int) -> list[list[SeriesAtPole]]:
    """Return the Laurent series of some functions at every pole."""
    deepest = max(len(c) for part in parts for c in part.poles.values())
    rows = [
        [
            part.poles[i][k] if i in part.poles and k < len(part.poles[i]) else acb(0)
            for i in range(len(poles))
        ]
        for part in parts
        for k in range(deepest)
    ]
    mirrored = [i for i, p in enumerate(poles) if p.imag != 0]
    everywhere = [*poles, *(poles[i].conjugate() for i in mirrored)]
    weights = acb_mat([[*row, *(row[i].conjugate() for i in mirrored)] for row in rows])
    found: list[list[SeriesAtPole]] = [[] for _ in parts]
    for number, centre in enumerate(poles):
        spend()
        powers = []
        for i, p in enumerate(everywhere):
            inverse = acb(0) if i == number else 1 / (p - centre)
            row, power = [], acb(1)
            for _ in range(length + deepest - 1):
                power = power * inverse
                row.append(power)
            powers.append(row)
        sums = weights * acb_mat(powers)
        for at, part in enumerate(parts):
            own = part.poles.get(number, ())
            # 1/(x - d)^(k + 1) is the sum of (-1)^(k + 1) binomial(m + k, k) x^m/d^(m + k + 1).
            regular = [
                sum(
                    (
                        sums[at * deepest + k, m + k] * (comb(m + k, k) * (-1) ** (k + 1))
                        for k in range(deepest)
                    ),
                    acb(0),
                )
                for m in range(length - len(own))
            ]
            found[at].append(SeriesAtPole(len(own), acb_series([*own[::-1], *regular])))
    return found


def _integrated(at: Sequence[SeriesAtPole], poles: Sequence[acb], integrations: int) -> list[SeriesAtPole]:
    found = []
    for own, p in zip(at, poles, strict=True):
        if p == 0:
            found.append(SeriesAtPole(own.order + integrations, own.series))
        else:
            series = own.series
            for _ in range(integrations):
                series = series / acb_series([p, acb(1)])
            found.append(SeriesAtPole(own.order, series))
    return found


def _total(parts: list[list[SeriesAtPole]]) -> list[SeriesAtPole]:
    total = parts[0]
    for more in parts[1:]:
        total = [a + b for a, b in zip(total, more, strict=True)]
    return total


def _fed_back(at: list[SeriesAtPole], gain: list[SeriesAtPole]) -> list[SeriesAtPole]:
    return [-(a * b) for a, b in zip(at, gain, strict=True)]
