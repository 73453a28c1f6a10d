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
from typing import TYPE_CHECKING, TypeVar

from flint import acb, acb_poly, arb, arb_poly

from symflex.analysis.time_response.delayed_terms import (
    NO_DELAY,
    Delay,
    DelayedQuotient,
    Durations,
    later,
    sum_of,
)
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
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from symflex.analysis.time_response.modal import PartialSum
    from symflex.analysis.time_response.sample_times import SampleTimes
    from symflex.roots import Root

MOST_ECHOES = 2000
"""Rational functions that one response is made of."""
MOST_POWERS = 30_000
"""Sum of the powers of their denominators, which grow from one to the next: 250 echoes take a while."""
FEW_POWERS = 3000
"""The same, tried first where modes may say it as well: 50 echoes of a shaft between discs take a second."""
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
    modes: PartialSum | None = None  # of which it is a sum, at any time
    method: str = ""  # what found it, such as ``echoes``; empty where there is nothing to find


@dataclass(frozen=True)
class Echo:
    """One rational function of an expansion: ``numerator / D_0^power * exp(-s T)``."""

    delay: Delay  # T
    numerator: arb_poly
    power: int


def echoes(quotient: DelayedQuotient, last: arb, most: int = MOST_POWERS) -> list[Echo] | None:
    """Return the expansion up to a time [s], in order, at the current precision.

    None where the output would come before the input; TooManyEchoesError where it is too long.
    """
    first = earliest(quotient.below, quotient.durations)
    below = {later(delay, first): quotient.durations.polynomial(p) for delay, p in quotient.below.items()}
    leading = below.pop(NO_DELAY)

    def joined(parts: list[tuple[arb_poly, int]]) -> tuple[arb_poly, int] | None:
        power = max(m for _, m in parts)
        numerator = sum((p * leading ** (power - m) for p, m in parts), arb_poly([0]))
        return None if numerator.degree() < 0 else (numerator, power)

    begun = {
        later(delay, first): (quotient.durations.polynomial(p), 1) for delay, p in quotient.above.items()
    }
    if any(delay and quotient.durations.seconds(delay) < 0 for delay in begun):
        return None
    found: list[Echo] = []
    powers = 0
    for delay, (numerator, power) in arriving(
        begun, below, joined, lambda own, p: (-(own[0] * p), own[1] + 1), quotient.durations, last
    ):
        found.append(Echo(delay, numerator, power))
        powers += power if leading.degree() else 0
        if powers > most:
            raise TooManyEchoesError
    return found


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
        whole = joined(waiting.pop(delay))
        if whole is None:
            continue
        count += 1
        if count > MOST_ECHOES:
            raise TooManyEchoesError
        yield delay, whole
        for more, factor in below.items():
            if waited_for(again := sum_of(delay, more)):
                waiting[again].append(followed(whole, factor))


def earliest(below: Iterable[Delay], durations: Durations) -> Delay:
    """Return the shortest delay of a denominator; a negative one is a growing exponential."""
    with precision(TIE_BITS):
        return min(below, key=lambda delay: durations.seconds(delay).mid())


def echoed(
    quotient: DelayedQuotient, integrations: int, times: SampleTimes, digits: int, most: int = MOST_POWERS
) -> Sampled | None:
    """Return the response at one precision, from poles of so many digits; None where it cannot be told.

    Where only poles that are not told apart stand in the way, more digits may help.
    """
    first = earliest(quotient.below, quotient.durations)
    leading = quotient.durations.exact(quotient.below[first])
    poles = find_polynomial_roots(RootProblem(((leading, 1),)), digits) if leading.degree else ()
    bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(digits)
    with precision(bits):
        seconds = times.enclosed()
        last = seconds[-1] if seconds else arb(0)
        expansion = echoes(quotient, last, most)
        if expansion is None:
            return None
        below = acb_poly(quotient.durations.polynomial(quotient.below[first]))
        total = Gathered(seconds)
        for echo in expansion:
            spend()
            part = _part(echo, below)
            delay = quotient.durations.seconds(echo.delay)
            terms = terms_of_echo(echo, below, poles, integrations, last, digits)
            if terms is None:
                return None
            start = total.start(delay)
            values = values_of(terms, times, start, delay)
            total.add(delay, *at_infinity(part, integrations), values, is_late=bool(echo.delay))
        return replace(total.sampled, method="echoes")


class Gathered:
    """The sum of what has come by each time [s]."""

    def __init__(self, seconds: Sequence[arb]) -> None:
        self._seconds = seconds
        self._values = [arb(0)] * len(seconds)
        self._impulses: list[ImpulseAt] = []
        self._jumps: list[JumpAt] = []
        self._at_jumps: set[int] = set()

    def start(self, delay: arb) -> int:
        """Return the number of the first time that may lie after a delay."""
        return next((i for i, t in enumerate(self._seconds) if not t < delay), len(self._seconds))

    def add(
        self, delay: arb, weights: Sequence[arb], height: arb, values: Iterable[arb], *, is_late: bool
    ) -> None:
        """Add what comes after a delay: weights of impulses, a jump, and values from then on."""
        self._impulses += [ImpulseAt(delay, k, w) for k, w in enumerate(weights) if not w.contains(0)]
        if is_late and not height.contains(0):
            self._jumps.append(JumpAt(delay, height))
        for i, value in enumerate(values, self.start(delay)):
            if is_late and not self._seconds[i] > delay:
                self._values[i] = self._values[i] + value.union(arb(0))
                self._at_jumps |= set() if height == 0 else {i}
            else:
                self._values[i] = self._values[i] + value

    @property
    def sampled(self) -> Sampled:
        """All of it."""
        return Sampled(
            tuple(self._values), tuple(self._impulses), tuple(self._jumps), frozenset(self._at_jumps)
        )


def _part(echo: Echo, leading: acb_poly) -> EnclosedQuotient:
    return EnclosedQuotient(((acb_poly(echo.numerator), 1),), ((leading, echo.power),), acb(1))


def terms_of_echo(
    echo: Echo, leading: acb_poly, poles: Sequence[Root], integrations: int, last: arb, digits: int
) -> list[ExponentialTerm] | None:
    """Return one rational function as exponentials of the time from its delay on; ``leading`` is D_0."""
    part = _part(echo, leading)
    repeated = [replace(root, multiplicity=root.multiplicity * echo.power) for root in poles]
    found = partial_fractions(part, repeated, integrations)
    if found is not None:
        return found
    return power_series_terms(part, integrations, last, bits_for_digits(digits))
