"""The pulse function of a machine with beams and rods that lose energy in their material.

Input: a bound transfer function, a period, a delay. Output: a :class:`~.pulse.Pulse`, and the smallest
``abs(z)`` at which it holds.

The step response is a sum of few exponentials and a rest that fades like ``exp(-fade t)``, both enclosed
(:mod:`symflex.analysis.time_response.modal`). With the slow ones of the exponentials in the denominator,

    P(b) = (1 - b) sum y(k T) b^k = (a_0 + a_1 b + ... + a_J b^J + R(b))/prod(1 - exp(p T) b)

has coefficients that fade as well, and ``R``, all later ones, is small for ``abs(b)`` up to 2 at most.
At any point of that disc R and its slope are those of a real cubic, by Hermite's interpolation in the point
and its conjugate: its divided differences are at most ``sum abs(a_j) binomial(j, n) abs(b)^(j - n)``. So R is
counted in by widening four coefficients.

Example: a cantilever of which one mode is slow at T has n = 2, and J is some 10.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil, comb

from flint import acb_poly, arb, arb_poly

from symflex.analysis.sampled_loop.pulse import Pulse, PulseCoefficients
from symflex.analysis.time_response.modal import proved_modes
from symflex.analysis.time_response.partial_fractions import ExponentialTerm, values_of
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import PartialSum
from symflex.balls import ball, precision
from symflex.state_space.sampled import Sampling
from symflex.transfer import BoundTransferFunction

BITS = 256  # of coefficients, in which those of many slow modes cancel
DIGITS = 12  # of the step response at samples, of its largest value, where so many can be had
FIRST = 8  # samples at which the rest is bounded by itself; later it fades
MORE = 48  # coefficients beyond the number of slow exponentials that are looked at
SHARP = 20  # bits that the last coefficient kept is known to at least
WIDEST = 2  # largest abs(b) that R is bounded for: what late coefficients are uncertain by grows as its power
CUBIC = 4  # coefficients of a cubic
SLOWEST = 1.0  # least fade times the period: below, R does not fall off within some tens of coefficients
CUBES = 52
"""Sum of (1 + i)^3/2^i: that of j^3 r^j from c on is at most c^3 r^c times it, for r = exp(-3/4) or less."""
TOO_SLOW = "modes fade too slowly over a period, or at no rate that is known: give all members eta"


def distributed_pulse(
    bound: BoundTransferFunction, sampling: Sampling, delay: Fraction
) -> tuple[Pulse, arb] | str:
    """Return the function from held outputs to samples, and the least ``abs(z)`` at which it holds.

    Why there is none, if modes do not fade fast enough.
    """
    samples = ceil(delay / sampling.sample)
    ahead = samples * sampling.sample - delay
    with precision(BITS):
        total = proved_modes(bound, 1, _times(sampling, ahead, FIRST), DIGITS)
        if total is None or not total.fade * sampling.seconds > SLOWEST:
            return TOO_SLOW
        found, least = _coefficients(total, sampling, ahead)
        shifted = replace(found, above=(arb(0),) * samples + found.above)
    return Pulse(lambda: shifted, frozenset(j for j, c in enumerate(shifted.above) if c == 0)), least


def _times(sampling: Sampling, ahead: Fraction, count: int) -> SampleTimes:
    """Return ``ahead``, ``ahead + T``, ..., exactly."""
    times = SampleTimes.evenly(sampling.sample * (count - 1), count)
    if not ahead:
        return times
    first = float(ahead)
    return replace(times, seconds=times.seconds + first, origin=arb(first) - ball(ahead))


def _coefficients(total: PartialSum, sampling: Sampling, ahead: Fraction) -> tuple[PulseCoefficients, arb]:
    """Return the coefficients of a pulse function, and the least ``abs(z)`` at which they are right."""
    period, fade = sampling.seconds, total.fade
    slow = [t for t in total.terms if not t.rate.real < -fade or len(t.coefficients) > 1]
    fast = [t for t in total.terms if t.rate.real < -fade and len(t.coefficients) == 1]
    below, at_one = _below(slow, period)
    whole = arb_poly(below) * arb_poly([1, -1]) ** at_one
    count = len(whole) + MORE
    steps = _steps(total, sampling, ahead, count)
    jumps = [y - before for y, before in zip(steps, [arb(0), *steps], strict=False)]
    product = whole * arb_poly(jumps)
    above = [product[j] for j in range(count)]
    kept = 1 + max(
        (j for j, a in enumerate(above) if a.rel_accuracy_bits() > SHARP and not a.contains(0)), default=0
    )
    # From the second sample on the fast part is at most size*exp(-fade*t).
    since = ball(ahead) + period
    rest = total.at_times[1] if total.at_times else total.rest
    size = sum((abs(t.coefficients[0]) for t in fast), arb(0)) + rest * (fade * since).exp()
    weights = sum(map(abs, whole.coeffs()), arb(0))
    size = size * weights * (1 + (fade * period).exp()) * (fade * (period * len(whole) - ball(ahead))).exp()
    reach = (fade * period / 4).exp().min(arb(WIDEST))
    first = 1 if above[0] == 0 else 0
    widths = _cubic(above, kept, first, size, (-fade * period).exp(), reach)
    coefficients = above[:kept] + [arb(0)] * max(first + CUBIC - kept, 0)
    for j, width in enumerate(widths):
        coefficients[first + j] += arb(0, width.upper())
    return PulseCoefficients(tuple(coefficients), tuple(below), at_one), (1 / reach).upper()


def _below(slow: Sequence[ExponentialTerm], period: arb) -> tuple[list[arb], int]:
    """Return the denominator without the poles at s = 0, and how many these are."""
    product, at_one = acb_poly([1]), 0
    for term in slow:
        if term.rate == 0:
            at_one = len(term.coefficients) - 1
            continue
        z = (term.rate * period).exp()
        factor = acb_poly([1, -z])
        if term.rate.imag != 0:
            factor *= acb_poly([1, -z.conjugate()])
        product *= factor ** len(term.coefficients)
    return [c.real for c in product.coeffs()], at_one


def _steps(total: PartialSum, sampling: Sampling, ahead: Fraction, count: int) -> list[arb]:
    """Return the step response at so many samples: what is known of the first, and what fades after them."""
    known = total.sampled.values
    times = _times(sampling, ahead, count)
    seconds = times.enclosed()
    rest, since = (total.at_times or (total.rest,))[-1], seconds[len(known) - 1]
    later = zip(values_of(total.terms, times, len(known)), seconds[len(known) :], strict=True)
    return [*known, *(y + arb(0, (rest * (total.fade * (since - t)).exp()).upper()) for y, t in later)]


def _cubic(above: Sequence[arb], kept: int, first: int, size: arb, falls: arb, reach: arb) -> list[arb]:
    """Return how large the coefficients of the cubic are that stands for those left out."""
    count, ratio = len(above), falls * reach
    # What rounds in a late coefficient is more than what it can be.
    later = {j: abs(above[j]).upper().min(size * falls**j) for j in range(kept, count)}
    differences = []
    for n in range(CUBIC):
        within = sum((a * comb(j - first, n) * reach ** (j - first - n) for j, a in later.items()), arb(0))
        differences.append(within + size * arb(count) ** 3 * ratio**count * CUBES)
    return [
        sum((differences[n] * comb(n, j) * reach ** (n - j) for n in range(j, CUBIC)), arb(0))
        for j in range(CUBIC)
    ]
