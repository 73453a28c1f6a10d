"""Where the loop gain is one: crossover frequencies, the loop's value there, and the bandwidth a loop allows.

Definition of that bandwidth: the gain is raised from 0 up to half of the one at which the loop first becomes
unstable, so that a gain margin of 6 dB is left (Franklin, Powell & Emami-Naeini, Feedback Control of Dynamic
Systems, 2010, section 6.4). It is the frequency at which the loop gain then first falls below one.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from flint import acb, arb

from symflex.algebra import Factored
from symflex.roots import Budget, RootProblem, find_polynomial_roots, precision
from symflex.roots.counting.tail import right_tail
from symflex.roots.problem import polynomial_in_s
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.loops.distributed import DistributedFactors
    from symflex.loops.loop import GainPolynomial, LoopValue
    from symflex.loops.stability_map import GainInterval
    from symflex.transfer import BoundTransferFunction


BITS = 128
SHRINKINGS = 30


@dataclass(frozen=True)
class LoopGain:
    """The loop gain ``K B/A`` of a loop closed once, on the imaginary axis."""

    bound: BoundTransferFunction  # carries ring, constants and kernels
    factor: GainPolynomial  # a + K B
    distributed: DistributedFactors | None  # where it has kernels
    digits: int  # of frequencies
    budget: Budget  # limits the search

    def crossovers(self, gain: Fraction) -> list[tuple[arb, acb]]:
        """Return the frequencies [rad/s] at which it is one in magnitude, ascending, and B/A there."""
        if self.distributed is None:
            found = lumped_crossovers(self.bound, self.factor, gain, self.digits, self.budget)
        else:
            found = distributed_crossovers(self.distributed, gain, self.digits)
        return sorted(found, key=lambda pair: float(pair[0].mid()))

    def ratio(self, omega: arb) -> acb:
        """Return an enclosure of B/A at a frequency [rad/s]."""
        if self.distributed is None:
            with precision(BITS):
                return _ratio(self.bound, self.factor, omega)
        (function,) = self.distributed.with_gain
        around, _ = function.on(omega, BITS)
        with precision(BITS):
            return around.b / around.a


def lumped_crossovers(
    bound: BoundTransferFunction, factor: GainPolynomial, nominal: Fraction, digits: int, budget: Budget
) -> list[tuple[arb, acb]]:
    """Return the frequencies [rad/s] at which ``abs(A) = abs(K B)``, and B/A there.

    ``A(s) A(-s) - K^2 B(s) B(-s)`` is even in s; its roots on the imaginary axis are these frequencies.
    """
    a, b = factor.coefficients
    squared = a * _mirrored(a) - b * _mirrored(b) * nominal**2
    if squared.is_zero:
        return []
    problem = RootProblem(
        tuple(
            (polynomial, e)
            for f, e in squared.factors
            if e > 0 and (polynomial := polynomial_in_s(bound, f)).degree
        )
    )
    found = []
    for root in find_polynomial_roots(problem, digits, budget=budget):
        if root.on_imaginary_axis and root.im > 0:
            with precision(2 * root.working_bits()):
                omega = root.im
                found.append((omega, _ratio(bound, factor, omega)))
    return found


def _ratio(bound: BoundTransferFunction, factor: GainPolynomial, omega: arb) -> acb:
    a, b = (_value(bound, part, acb(0, omega)) for part in factor.coefficients)
    return b / a


def _mirrored(value: Factored) -> Factored:
    """Return a function of s at -s."""
    ring = value.ring
    images = [ring.context.gen(i) for i in range(len(ring.names))]
    images[0] = -images[0]
    return value.map_factors(ring, lambda f: Factored.polynomial(ring, f.compose(*images, ctx=ring.context)))


def _value(bound: BoundTransferFunction, part: Factored, s: acb) -> acb:
    total = acb(ball(part.unit))
    for factor, exponent in part.factors:
        total = total * polynomial_in_s(bound, factor).enclosure()(s) ** exponent
    return total


def distributed_crossovers(
    distributed: DistributedFactors, nominal: Fraction, digits: int
) -> list[tuple[arb, acb]]:
    """Return the same for a loop with kernels; where it is not proved is added to its reasons."""
    (function,) = distributed.with_gain
    gain = ball(nominal)

    def equation(value: LoopValue) -> tuple[arb, arb]:
        return value.excess(gain)

    first, origin = distributed.next_to_zero(function)
    if origin is not None:
        start = first
        for _ in range(SHRINKINGS):
            a, b = origin.sizes(arb(first))
            orders = origin.orders
            share = abs(gain) * arb(first) ** (orders[1] - orders[0])
            if a.abs_lower() > share * b.abs_upper() and orders[1] >= orders[0]:
                break
            if a.abs_upper() < share * b.abs_lower() and orders[1] <= orders[0]:
                break
            first /= 2
        else:
            # As where it is one at s = 0 itself: nothing is gained by going closer.
            distributed.reasons.append("whether the loop gain is one next to s = 0 is not proved")
            first = start
    last = distributed.radius[0]
    if distributed.radius[1]:
        most = abs(gain).upper()
        disc = acb(arb(0, most), arb(0, most))
        tail = right_tail(function.bound, (function.a, function.b), (acb(1), disc), last)
        if tail.radius is None:
            distributed.reasons.append("whether the loop gain is one at high frequencies is not proved")
        last = tail.radius or last
    result = distributed.on_axis(function, equation, lambda value: False, (first, last), digits)
    found = []
    for omega in result.roots:
        bits = max(BITS, 2 * omega.bits())
        around, _ = function.on(omega, bits)
        with precision(bits):
            if not around.a.contains(0):
                found.append((omega, around.b / around.a))
    return found


MARGIN: Final = 2
"""Of the gain: 6 dB."""


@dataclass(frozen=True, slots=True)
class AllowedBandwidth:
    """Up to which frequency a loop can follow, with a gain margin of 6 dB."""

    gain: Fraction | None  # the largest gain with that margin; ``None`` when every gain is stable
    # At which the loop gain first falls below one [rad/s]; ``None`` when there is no such gain, or when the
    # loop gain is below one from the lowest frequencies on.
    frequency: arb | None
    phase_margin: arb | None  # the smallest one there in absolute value [rad], positive for lag
    is_limited: bool  # by a boundary: twice the gain is one. Otherwise the gains examined end there.


def allowed_bandwidth(
    intervals: Sequence[GainInterval], limit: Fraction | None, loop_gain: LoopGain
) -> AllowedBandwidth | None:
    """Return the bandwidth that the stable gains next to 0 allow, ``None`` when there are none.

    Intervals ascend, and negative gains may be among them; gains were examined up to ``limit``, None for all.
    ``loop_gain`` is that of a loop closed once.
    """
    begin = next((i for i in intervals if _is_above(i.high) and not (i.low is not None and i.low > 0)), None)
    if begin is None or not begin.poles.is_stable:
        return None
    if begin.high is None:
        return AllowedBandwidth(None, None, None, is_limited=False)
    is_limited = begin is not intervals[-1]
    end = Fraction(float(begin.high.mid())) if is_limited or limit is None else limit
    gain = end / MARGIN
    found = loop_gain.crossovers(gain)
    with precision(BITS):
        size = ball(gain)
        if not found or not abs(loop_gain.ratio(found[0][0].mid() / 2)) * size > 1:
            return AllowedBandwidth(gain, None, None, is_limited)
        angles = [(-ratio * acb(size)).arg() for _, ratio in found]
    worst = min(angles, key=lambda angle: abs(float(angle.mid())))
    return AllowedBandwidth(gain, found[0][0], worst, is_limited)


def _is_above(end: arb | None) -> bool:
    return end is None or bool(end > 0)
