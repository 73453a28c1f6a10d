"""Responses of functions with pure delays: piecewise, one rational function more after every delay.

Input: a :class:`DelayedQuotient` and times. Output: enclosed values, impulses and jumps.

    1/(s + 1 + 3 e^(-sT))  =  1/(s + 1)  -  3 e^(-sT)/(s + 1)^2  +  9 e^(-2sT)/(s + 1)^3  -  ...

Up to t = 2T the first two terms are all there is: the method of steps (Bellman and Cooke 1963), in the
frequency domain. A rod is such a function, whose echoes are waves that come back from its ends. With

    (D_0 + D_1 e^(-s d_1) + ...) H = N_0 + N_1 e^(-s n_1) + ...

the coefficient of every e^(-sT) in H follows from those of earlier ones, over a power of D_0. Nothing is cut
off, and the loop need not be stable.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_poly

from symflex.analysis.time_response.delayed_terms import NO_DELAY, Delay, DelayedQuotient, later, sum_of
from symflex.analysis.time_response.enclosed_response import ImpulseAt, JumpAt
from symflex.analysis.time_response.exponentials import ExponentialTerm, values_of
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    at_infinity,
    partial_fractions,
    power_series_terms,
)
from symflex.budget import spend
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.problem import RootProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.sample_times import SampleTimes
    from symflex.roots import Root

MOST_ECHOES = 2000
"""Rational functions that one response is made of."""
MOST_POWERS = 30_000
"""Sum of the powers of their denominators, which grow from one to the next: 250 echoes take some seconds."""
TIE_BITS = 256
"""At which delays are put in order; equal ones are equal exactly."""


class TooManyEchoesError(Exception):
    """More echoes arrive by the last time than are worth a sum."""


@dataclass(frozen=True)
class Sampled:
    """Values at given times, and what is between and besides them."""

    values: tuple[arb, ...]
    impulses: tuple[ImpulseAt, ...] = ()
    jumps: tuple[JumpAt, ...] = ()
    at_jumps: frozenset[int] = frozenset()  # positions of values that hold both sides of a jump


@dataclass(frozen=True)
class Echo:
    """One rational function of an expansion: ``numerator / D_0^power * exp(-s T)``."""

    delay: Delay  # T
    numerator: arb_poly
    power: int


def echoes(quotient: DelayedQuotient, last: arb) -> list[Echo] | None:
    """Return the expansion up to a time [s], in order, at the current precision.

    None where the output would come before the input; TooManyEchoesError where it is too long.
    """
    seconds = quotient.durations.seconds
    first = _earliest(quotient)
    below = {later(delay, first): quotient.durations.polynomial(p) for delay, p in quotient.below.items()}
    leading = below.pop(NO_DELAY)
    waiting: dict[Delay, list[tuple[arb_poly, int]]] = {}
    queue: list[tuple[float, Delay]] = []

    def put(delay: Delay, numerator: arb_poly, power: int) -> None:
        if delay not in waiting:
            when = seconds(delay)
            if when > last:
                return
            waiting[delay] = []
            heapq.heappush(queue, (float(when.mid()), delay))
        waiting[delay].append((numerator, power))

    for delay, amplitude in quotient.above.items():
        own = later(delay, first)
        if own and seconds(own) < 0:
            return None
        put(own, quotient.durations.polynomial(amplitude), 1)
    found: list[Echo] = []
    powers = 0
    while queue:
        spend()
        _, delay = heapq.heappop(queue)
        parts = waiting.pop(delay)
        power = max(m for _, m in parts)
        numerator = sum((p * leading ** (power - m) for p, m in parts), arb_poly([0]))
        if numerator.degree() < 0:
            continue
        found.append(Echo(delay, numerator, power))
        powers += power if leading.degree() else 0
        if len(found) > MOST_ECHOES or powers > MOST_POWERS:
            raise TooManyEchoesError
        for more, polynomial in below.items():
            put(sum_of(delay, more), -(numerator * polynomial), power + 1)
    return found


def _earliest(quotient: DelayedQuotient) -> Delay:
    """Return the shortest delay of the denominator; a negative one is a growing exponential."""
    with precision(TIE_BITS):
        return min(quotient.below, key=lambda delay: quotient.durations.seconds(delay).mid())


def echoed(quotient: DelayedQuotient, integrations: int, times: SampleTimes, digits: int) -> Sampled | None:
    """Return the response at one precision, from poles of so many digits; None where it cannot be told.

    Where only poles that are not told apart stand in the way, more digits may help.
    """
    leading = quotient.durations.exact(quotient.below[_earliest(quotient)])
    poles = find_polynomial_roots(RootProblem(((leading, 1),)), digits) if leading.degree else ()
    bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(digits)
    with precision(bits):
        seconds = times.enclosed()
        last = seconds[-1] if seconds else arb(0)
        expansion = echoes(quotient, last)
        if expansion is None:
            return None
        below = acb_poly(quotient.durations.polynomial(quotient.below[_earliest(quotient)]))
        total = [arb(0)] * len(times)
        impulses: list[ImpulseAt] = []
        jumps: list[JumpAt] = []
        at_jumps: set[int] = set()
        for echo in expansion:
            spend()
            part = EnclosedQuotient(((acb_poly(echo.numerator), 1),), ((below, echo.power),), acb(1))
            delay = quotient.durations.seconds(echo.delay)
            weights, height = at_infinity(part, integrations)
            impulses += [ImpulseAt(delay, k, w) for k, w in enumerate(weights) if not w.contains(0)]
            if echo.delay and not height.contains(0):
                jumps.append(JumpAt(delay, height))
            terms = _terms(part, poles, echo.power, integrations, last, digits)
            if terms is None:
                return None
            start = next((i for i, t in enumerate(seconds) if not t < delay), len(seconds))
            for i, value in enumerate(values_of(terms, times, start, delay), start):
                if echo.delay and not seconds[i] > delay:
                    total[i] = total[i] + value.union(arb(0))
                    at_jumps |= set() if height == 0 else {i}
                else:
                    total[i] = total[i] + value
        return Sampled(tuple(total), tuple(impulses), tuple(jumps), frozenset(at_jumps))


def _terms(
    part: EnclosedQuotient, poles: Sequence[Root], power: int, integrations: int, last: arb, digits: int
) -> list[ExponentialTerm] | None:
    """Return one rational function as exponentials in time."""
    repeated = [replace(root, multiplicity=root.multiplicity * power) for root in poles]
    found = partial_fractions(part, repeated, integrations)
    if found is not None:
        return found
    return power_series_terms(part, integrations, last, bits_for_digits(digits))
