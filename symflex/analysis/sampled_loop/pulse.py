"""What a controller sees of a continuous machine that it holds its output for: the pulse function.

Input: a bound transfer function, a period, a delay. Output: a :class:`Pulse`, a quotient of polynomials in
``b = 1/z``, one sample back, whose coefficients are balls of any precision.

    1/s^2, period T    step response t^2/2, at samples 0, T^2/2, 4 T^2/2 ...
                       P = (1 - b) sum (k T)^2/2 b^k = T^2/2 b (1 + b)/(1 - b)^2

The output is constant from one sample to the next, so the response at samples is a sum of late steps, and the
pulse function is exact (Ragazzini and Franklin 1958). A delay of any fraction of a sample moves the times at
which the step response is read (the modified z-transform; Jury 1958). Of a system with n poles, n values
of the step response determine the numerator. A pole at s = 0 is one at z = 1 exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import ceil
from typing import TypeVar

from flint import acb, acb_poly, arb, arb_poly

from symflex.analysis.sampling import Continuous, continuous_parts, whole_delay
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    ExponentialTerm,
    partial_fractions,
    values_of,
)
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.balls import UndecidedError, ball, current_bits, precision, precisions
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.root import exact_fraction
from symflex.state_space.sampled import Sampling
from symflex.transfer import BoundTransferFunction

SPARE_BITS = 64  # of coefficients beyond the precision that they are asked for at
FIRST_BITS, LAST_BITS = 256, 16384
DIGITS_PER_BIT = 0.15  # digits of poles: half of what so many bits hold
Found = TypeVar("Found")


@dataclass(frozen=True, eq=False)
class PulseCoefficients:
    """``sum(above[j] b^j) / ((1 - b)^at_one * sum(below[j] b^j))``."""

    above: tuple[arb, ...]  # exactly 0 where that is proved
    below: tuple[arb, ...]  # begins with 1
    at_one: int

    def value(self, b: acb) -> acb:
        """Return the value at a ball of the current precision."""
        above, below = (acb_poly([acb(c) for c in side])(b) for side in (self.above, self.below))
        return above / below / (1 - b) ** self.at_one


@dataclass(frozen=True, eq=False)
class Pulse:
    """A pulse function, whose coefficients are found as precisely as they are asked for."""

    at: Callable[[], PulseCoefficients]  # at the current precision
    zeros: frozenset[int]  # numbers of coefficients of the numerator that are exactly 0


@dataclass(frozen=True, eq=False)
class StepResponse:
    """A step response as sums of exponentials, one for each delay, found as precisely as asked for."""

    delays: tuple[Fraction, ...]  # of the machine [s]
    modes: tuple[tuple[acb, int], ...]  # rates, about, with how many coefficients each has
    terms: Callable[[], Sequence[Sequence[ExponentialTerm]]]  # by delay, at the current precision

    def at(self, part: int, mode: int) -> tuple[acb, Sequence[acb]]:
        """Return the rate and the coefficients of a mode at the current precision."""
        term = self.terms()[part][mode]
        return term.rate, term.coefficients


def step_response(bound: BoundTransferFunction) -> StepResponse:
    """Return the step response of a function that is rational but for delays; errors as of sampling."""

    def terms(bits: int) -> tuple[Continuous, list[Sequence[ExponentialTerm]]]:
        given = continuous_parts(bound, int(bits * DIGITS_PER_BIT), bits)
        return given, [_terms(given, term.numerator) for term in given.terms]

    at = settled_at(terms, bound.name)
    given, first = at()
    with precision(FIRST_BITS):
        delays = tuple(exact_fraction(term.late.mid()) for term in given.terms)
    modes = tuple((term.rate, len(term.coefficients)) for term in first[0])
    return StepResponse(delays, modes, lambda: at()[1])


def settled_at(find: Callable[[int], Found], name: str) -> Callable[[], Found]:
    """Return what finds something at the current precision, with more bits where so many do not decide."""

    @cache
    def level(least: int) -> Found:
        for bits in precisions(least, LAST_BITS):
            with precision(bits):
                try:
                    return find(bits)
                except UndecidedError:
                    continue
        message = f"poles of {name} cannot be separated, so it cannot be sampled"
        raise UncertifiedError(Diagnostic("SF810", message))

    def at() -> Found:
        wanted = current_bits() + SPARE_BITS
        return level(next(bits for bits in precisions(FIRST_BITS, 2 * LAST_BITS) if bits >= wanted))

    return at


def pulse_function(bound: BoundTransferFunction, sampling: Sampling, delay: Fraction) -> Pulse:
    """Return the function from held outputs to samples, the outputs late by a delay [s].

    ModelError: SF235 for delays in continuous loops and beams, SF236 for a function that grows with s;
    UncertifiedError: SF810 where poles cannot be separated.
    """
    at = settled_at(lambda bits: _coefficients(bound, sampling, delay, bits), bound.name)
    return Pulse(at, frozenset(j for j, c in enumerate(at().above) if c == 0))


def _coefficients(
    bound: BoundTransferFunction, sampling: Sampling, delay: Fraction, bits: int
) -> PulseCoefficients:
    given = continuous_parts(bound, int(bits * DIGITS_PER_BIT), bits)
    below, at_one = _below(given, sampling)
    order = len(below) - 1 + at_one + 1  # with that of the step
    whole = arb_poly(below) * arb_poly([1, -1]) ** (at_one + 1)
    above = arb_poly([])
    for term in given.terms:
        late = whole_delay(term.late, sampling) + delay
        samples = ceil(late / sampling.sample)
        steps = _steps(given, term.numerator, sampling, samples * sampling.sample - late, order)
        product = whole * arb_poly(steps)
        kept = [product[j] if j < len(product) else arb(0) for j in range(order)]
        first = next((j for j, step in enumerate(steps) if step != 0), 0)
        above += arb_poly([arb(0)] * samples + [arb(0)] * first + kept[first:])
    return PulseCoefficients(tuple(above.coeffs()), tuple(below), at_one)


def _steps(
    given: Continuous, numerator: acb_poly, sampling: Sampling, ahead: Fraction, count: int
) -> list[arb]:
    """Return the step response at so many samples, each read ahead by a part of one."""
    count = max(count, 2)
    times = SampleTimes.evenly(sampling.sample * (count - 1), count)
    steps = values_of(_terms(given, numerator), times, delay=-ball(ahead))
    if not ahead and numerator.degree() < given.order:
        steps[0] = arb(0)
    return steps


def _terms(given: Continuous, numerator: acb_poly) -> Sequence[ExponentialTerm]:
    """Return the step response without its delay."""
    quotient = EnclosedQuotient(((numerator, 1),), ((given.denominator, 1),), acb(1))
    terms = partial_fractions(quotient, given.poles, 1)
    if terms is None:
        raise UndecidedError
    return terms


def _below(given: Continuous, sampling: Sampling) -> tuple[list[arb], int]:
    """Return the denominator without the poles at s = 0, and how many these are."""
    at_one = sum(root.multiplicity for root in given.poles if root.is_zero)
    product = acb_poly([1])
    for root in given.poles:
        if not root.is_zero:
            z = (root.enclosure() * sampling.seconds).exp()
            product *= acb_poly([1, -z]) ** root.multiplicity
    return [c.real for c in product.coeffs()], at_one
