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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from flint import acb, acb_poly, arb, arb_poly

from symflex.analysis.time_response.delayed_terms import (
    NO_DELAY,
    Delay,
    DelayedQuotient,
    Durations,
    later,
    sum_of,
)
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    ExponentialTerm,
    at_infinity,
    partial_fractions,
    values_of,
)
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import Gathered, Sampled
from symflex.balls import bits_for_digits, precision
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots import Root, RootProblem, find_polynomial_roots


class TooManyEchoesError(Exception):
    """More echoes arrive by the last time than are worth a sum."""


@dataclass(frozen=True)
class Echo:
    """One rational function of an expansion: ``numerator / D_0^power * exp(-s T)``."""

    delay: Delay  # T
    numerator: arb_poly
    power: int


def echoes(quotient: DelayedQuotient, last: arb) -> list[Echo]:
    """Return the expansion up to a time [s]; TooManyEchoesError, or SF810 for what comes too early."""
    first = earliest(quotient.below, quotient.durations)
    below = {later(delay, first): quotient.durations.polynomial(p) for delay, p in quotient.below.items()}
    leading = below.pop(NO_DELAY)

    def joined(parts: list[tuple[arb_poly, int]]) -> tuple[arb_poly, int] | None:
        power = max(m for _, m in parts)
        numerator = sum((p * leading ** (power - m) for p, m in parts), arb_poly([0]))
        return None if numerator.degree() < 0 else (numerator, power)

    def followed(echo: tuple[arb_poly, int], p: arb_poly) -> tuple[arb_poly, int]:
        return -(echo[0] * p), echo[1] + 1

    begun = {
        later(delay, first): (quotient.durations.polynomial(p), 1) for delay, p in quotient.above.items()
    }
    check_order(begun, quotient.durations)
    echoes_so_far: list[Echo] = []
    powers = 0
    for delay, (numerator, power) in arriving(begun, below, joined, followed, quotient.durations, last):
        echoes_so_far.append(Echo(delay, numerator, power))
        powers += power if leading.degree() else 0
        if powers > EFFORT.powers:
            raise TooManyEchoesError
    return echoes_so_far


def check_order(begun: Iterable[Delay], durations: Durations) -> None:
    """Raise UncertifiedError: SF810 where something comes before the input."""
    if any(delay and durations.seconds(delay) < 0 for delay in begun):
        raise too_early()


def too_early() -> UncertifiedError:
    """Return what is wrong where something comes before the input."""
    message, hint = (
        "the output would come before the input",
        "a delay in a denominator needs future values of its input",
    )
    return UncertifiedError(Diagnostic("SF810", message, None, hint))


Coming = TypeVar("Coming")
Factor = TypeVar("Factor")


def arriving(
    begun: Mapping[Delay, Coming],
    below: Mapping[Delay, Factor],
    joined: Callable[[list[Coming]], Coming | None],
    followed: Callable[[Coming, Factor], Coming],
    durations: Durations,
    last: arb,
) -> Iterator[tuple[Delay, Coming]]:
    """Yield what comes after each delay up to a time [s], in order.

    ``begun`` comes by itself; everything comes again after every delay of ``below``, as ``followed`` says.
    What comes at the same time is ``joined``; None for nothing. Raises TooManyEchoesError.
    """
    waiting: dict[Delay, list[Coming]] = {}
    queue: list[tuple[float, Delay]] = []

    def waited_for(delay: Delay) -> bool:
        if delay not in waiting:
            when = durations.seconds(delay)
            if when > last:
                return False
            waiting[delay] = []
            heapq.heappush(queue, (float(when.mid()), delay))
        return True

    for delay, part in begun.items():
        if waited_for(delay):
            waiting[delay].append(part)
    count = 0
    while queue:
        spend()
        _, delay = heapq.heappop(queue)
        total = joined(waiting.pop(delay))
        if total is None:
            continue
        count += 1
        if count > EFFORT.echoes:
            raise TooManyEchoesError
        yield delay, total
        for more, factor in below.items():
            if waited_for(again := sum_of(delay, more)):
                waiting[again].append(followed(total, factor))


def earliest(below: Iterable[Delay], durations: Durations) -> Delay:
    """Return the shortest delay of a denominator; a negative one is a growing exponential."""
    with precision(EFFORT.tie_bits):
        return min(below, key=lambda delay: durations.seconds(delay).mid())


def echoed(quotient: DelayedQuotient, integrations: int, times: SampleTimes, digits: int) -> Sampled | None:
    """Return the response at one precision, from poles of so many digits; None if these may be too few."""
    first = earliest(quotient.below, quotient.durations)
    leading = quotient.durations.exact(quotient.below[first])
    poles = find_polynomial_roots(RootProblem(((leading, 1),)), digits) if leading.degree else ()
    bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(digits)
    with precision(bits):
        seconds = times.enclosed()
        below = acb_poly(quotient.durations.polynomial(quotient.below[first]))
        total = Gathered(seconds)
        for echo in echoes(quotient, seconds[-1] if seconds else arb(0)):
            spend()
            delay = quotient.durations.seconds(echo.delay)
            terms = terms_of_echo(echo, below, poles, integrations)
            if terms is None:
                return None
            values = values_of(terms, times, total.start(delay), delay)
            total.add(delay, *at_infinity(_part(echo, below), integrations), values, is_late=bool(echo.delay))
        return total.sampled("echoes")


def _part(echo: Echo, leading: acb_poly) -> EnclosedQuotient:
    return EnclosedQuotient(((acb_poly(echo.numerator), 1),), ((leading, echo.power),), acb(1))


def terms_of_echo(
    echo: Echo, leading: acb_poly, poles: Sequence[Root], integrations: int
) -> list[ExponentialTerm] | None:
    """Return one rational function as exponentials of the time from its delay on; ``leading`` is D_0."""
    repeated = [replace(root, multiplicity=root.multiplicity * echo.power) for root in poles]
    return partial_fractions(_part(echo, leading), repeated, integrations)
