"""How large a transfer function with kernels is: on balls of s, on arcs, about points where poles meet.

Input: a bound transfer function. Output: bounds of integrals of its absolute value, which say how much the
poles that a sum over modes leaves out may add to a response.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf, pi
from typing import TYPE_CHECKING, Final

from flint import acb, acb_series, arb

from symflex.algebra.exponential_sum import REAL, arguments_of, exponential_sum
from symflex.analysis.time_response.exponentials import ExponentialTerm
from symflex.budget import spend
from symflex.roots.counting.argument_principle import LogarithmicLine
from symflex.roots.counting.local_series import SeriesSteps
from symflex.roots.functions.exponential_values import ExponentialValues
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.precision import precision
from symflex.transfer.balls import at_centre, ball

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.algebra.exponential_sum import Exponent
    from symflex.roots.counting.winding import Cell
    from symflex.transfer import BoundTransferFunction

BITS = 128
"""Of sizes: exponents of some 10^6 leave a phase of 30 digits."""
FIRST_STEP = 0.1
"""Of arcs [rad]; where values vary much on one, it is halved."""
SMALLEST_STEP = 1e-9
ZERO: Final = arb(0)
SHARP = 0.25
"""Radius of the balls of sums on a step, over their middle: sizes are that uncertain."""
SERIES_TERMS = 4
"""Of sums on a step: with more, they hardly become longer."""
WIDEST = 2.0
"""How far from poles that accumulate a ring about them is sought, over the size of what they lie in."""
SERIES_BITS = 96
"""Of values that make a series, of which a few digits are wanted; terms are lost on the way."""
RING_STEPS = 16
"""Of half a ring, at first."""
RING_POWER = 50
"""A sum over a ring lacks about exp(-50), or 10^-21, of the largest value on it."""


@dataclass(frozen=True, eq=False)
class SizeOfFunction(ABC):
    """How large a transfer function is at most on a ball of s."""

    bound: BoundTransferFunction

    @cached_property
    def is_even(self) -> bool:
        """Whether the function is even or odd in s, as it is without losses."""
        return all(KernelFunction(self.bound, p).is_even for p in (self.bound.num, self.bound.den))

    @classmethod
    def of(cls, bound: BoundTransferFunction) -> SizeOfFunction | None:
        """Return the evaluator of a function; None where there is none, as for long sums."""
        return SizeOfExponentials.of(bound) or SizeBySeries.of(bound)

    @property
    @abstractmethod
    def length(self) -> float:
        """How many exponentials it is made of; infinite where it is not."""

    @abstractmethod
    def at(self, s: acb, sharp: float = 1.0) -> arb | None:
        """Return the most that abs(H) is on a ball; None where it is not told, to about a share."""

    def on_arc(self, reached: float, start: float, end: float) -> arb | None:
        """Return the integral of abs(H) over the angle [rad] from one to another, at one ln(abs(s))."""
        path = LogarithmicLine(complex(reached, start), complex(reached, end))
        count = round((end - start) / FIRST_STEP) + 1
        pending = [(i / count, (i + 1) / count) for i in range(count)]
        total = arb(0)
        while pending:
            low, high = pending.pop()
            size = self.at(path.step(low, high)[0], SHARP)
            if size is not None:
                total += size * (high - low) * (end - start)
            elif (high - low) * (end - start) < SMALLEST_STEP:
                return None
            else:
                middle = (low + high) / 2
                pending += [(low, middle), (middle, high)]
        return total.upper()

    def around(self, hole: Cell, poles: Sequence[acb], integrations: int) -> Ring | None:
        """Return what all poles in a neighbourhood add where infinitely many accumulate, as about -1/eta.

        It is an integral over a ring about them, as a sum over its points: what is summed is analytic on the
        ring, so the error falls like a power of its width (Trefethen and Weideman 2014). First comes the
        ring, with all ``poles`` that it holds besides; then the terms, and what they lack at most. That holds
        if there is no pole on the ring itself, as there is none where all within its reach are given. Then
        no value on it is larger than those on its two edges.
        """
        if not hole.right <= pi <= hole.left:
            return None
        with precision(2 * BITS):
            ring = _ring_about(hole, poles)
            if ring is None:
                return None
            largest = arb(0)
            pending = [
                (k / RING_STEPS, 1 / RING_STEPS, edge) for k in range(RING_STEPS) for edge in (-1.0, 1.0)
            ]
            while pending:
                start, angle, edge = pending.pop()
                s = ring.piece(start, angle, edge)
                size = self.at(s)
                if size is not None:
                    largest = largest.max(size / s.abs_lower() ** integrations)
                elif angle < SMALLEST_STEP:
                    return None
                else:
                    pending += [(start + i * angle / 2, angle / 2, edge) for i in (0, 1)]
            count = 2 * int(RING_POWER / float(ring.width.log().mid()) / 2 + 1)
            terms = []
            values = self.bound.enclosed(2 * BITS)
            for k in range(count // 2):
                # Points come in conjugate pairs.
                off = ring.radius * acb(0, arb(2 * k + 1) * arb.pi() / count).exp()
                s = ring.centre + off
                terms.append(ExponentialTerm(s, (2 * values(s) * off / s**integrations / count,)))
            # Left of the imaginary axis no exponential is larger than 1.
            missing = largest * ring.radius * (ring.width + 1 / ring.width) / (ring.width**count - 1)
            return ring, terms, missing.upper()


@dataclass(frozen=True, eq=False)
class SizeOfExponentials(SizeOfFunction):
    """The same of a sum of exponentials over another.

    Of every sum the largest exponential is taken out, so that values far from the imaginary axis hardly vary.
    """

    values: ExponentialValues

    @classmethod
    def of(cls, bound: BoundTransferFunction) -> SizeOfExponentials | None:
        """Return the evaluator of a function; None where a wavenumber has no formula, or for long sums."""
        arguments = arguments_of(bound.kernels)
        if arguments is None:
            return None
        found = []
        for factor, exponent in bound.ratio.factors:
            terms = exponential_sum(bound.ratio.ring, bound.kernels, arguments, factor)
            if terms is None:
                return None
            found.append((terms, exponent))
        with precision(BITS):
            return cls(bound, ExponentialValues(bound.kernel_values(), arguments, tuple(found)))

    @property
    def length(self) -> int:
        """How many exponentials it is made of."""
        return sum(len(terms.terms) for terms, _ in self.values.sums)

    def at(self, s: acb, sharp: float = 1.0) -> arb | None:
        """Return the most that abs(H) is on a ball, by exponentials."""
        spend()
        place = self.values.at(s)
        total = abs(acb(ball(self.bound.ratio.unit)))
        grown: dict[int, complex] = {}
        for i, (terms, exponent) in enumerate(self.values.sums):
            only = next(iter(terms.terms), REAL)
            largest = only if len(terms.terms) == 1 else self.values.largest([i], place)
            value = at_centre(self.values.value(i, place, largest))
            if not value.is_finite():
                return None
            scale = abs(value.mid())
            if exponent > 0:
                # A numerator may vanish on the way.
                own = self.values.amplitudes(i, place)[list(terms.terms).index(largest)]
                scale = scale.max(abs(at_centre(own).mid()))
            if not value.rad() <= sharp * scale or (exponent < 0 and not abs(value) > 0):
                value = self._expanded(i, s, largest)
                scale = scale if exponent > 0 else abs(value.mid())
                if not value.rad() <= sharp * scale:
                    return None
            size = abs(value)
            total = total * (size.upper() if exponent > 0 else size.lower()) ** exponent
            for k, real, imaginary in largest:
                grown[k] = grown.get(k, 0j) + exponent * complex(real, imaginary)
        # Added up first: the balls of what grows above and below would not cancel.
        rest = place.combined(tuple((k, acb(c.real, c.imag)) for k, c in grown.items() if c))
        found = total if rest is None else total * at_centre(rest).real.exp()
        return found.upper() if found.is_finite() else None

    def _expanded(self, number: int, s: acb, largest: Exponent) -> acb:
        """Return one sum over an exponential from its series in a ball's middle, its last term on the ball.

        Where terms cancel, their balls do not, and it would take a thousand times as many small ones.
        """
        middle, last = s.mid(), SERIES_TERMS - 1
        near = self.values.at(acb_series([s, acb(1)], SERIES_TERMS))
        at_middle = self.values.at(acb_series([middle, acb(1)], SERIES_TERMS), near)
        wide, sharp = (self.values.value(number, place, largest) for place in (near, at_middle))
        if not (isinstance(wide, acb_series) and isinstance(sharp, acb_series)):
            return at_centre(wide)
        total = wide[last]
        for k in reversed(range(last)):
            total = total * (s - middle) + sharp[k]
        return total


@dataclass(frozen=True, eq=False)
class SizeBySeries(SizeOfFunction):
    """The same of members whose coefficients vary along x, from power series about the middles of balls.

    Numerator and denominator are entire, and each is followed by its own series.
    """

    parts: tuple[SeriesSteps, SeriesSteps]

    @classmethod
    def of(cls, bound: BoundTransferFunction) -> SizeBySeries | None:
        """Return the evaluator of a function; None where some waves have wavenumbers."""
        if bound.kernels.wavenumbers or not bound.kernels.kernels or bound.ratio.is_zero:
            return None
        num, den = (SeriesSteps(KernelFunction(bound, part)) for part in (bound.num, bound.den))
        return cls(bound, (num, den)) if num.function.power == den.function.power == 1 else None

    @property
    def length(self) -> float:
        """It is made of none."""
        return inf

    def at(self, s: acb, sharp: float = 1.0) -> arb | None:
        """Return the most that abs(H) is on a ball, by series; its radius is less than half of abs(s)."""
        spend()
        middle, reach = s.mid(), (s - s.mid()).abs_upper()
        size = abs(ball(self.bound.num.unit / self.bound.den.unit))
        for part, exponent in zip(self.parts, (1, -1), strict=True):
            if reach > 0:
                here = part.near(middle, reach, SERIES_BITS)
                if here is None:
                    return None
                (first, *others), missed = here
            else:
                first, others, missed = part.function.value(middle, BITS), [], arb(0)
            off, power = missed, arb(1)
            for coefficient in others:
                power *= reach
                off += abs(coefficient) * power
            if exponent < 0 and not off <= sharp * abs(first):
                return None
            size *= (abs(first) + off) if exponent > 0 else 1 / (abs(first) - off)
        return size.upper() if size.is_finite() else None


@dataclass(frozen=True, slots=True)
class Rest:
    """How much a response differs at most from what the poles below some radius add."""

    always: arb  # at any time up to the last one; infinite where only later times are bounded
    at_times: tuple[arb, ...]  # at each of the times asked for
    start: arb | None = None  # the response at t = 0, where it is known
    fade: arb = ZERO  # at a time t [s] it is exp(-fade t) times what it is always, at most [1/s]


@dataclass(frozen=True, slots=True)
class Annulus:
    """All s whose distance from a real centre is a radius times a number between 1/width and width."""

    centre: arb
    radius: arb
    width: arb

    def piece(self, start: float, angle: float, edge: float) -> acb:
        """Return a ball around a part of the upper half of an edge, the inner one at -1, the outer one at 1.

        From 0 to 1 the angle grows from the right end to the left one.
        """
        turn = arb(start + angle / 2, angle / 2) * arb.pi()
        return self.centre + self.radius * acb(self.width.log() * edge, turn).exp()

    @property
    def reach(self) -> arb:
        """Return the largest abs(s) on the ring."""
        return abs(self.centre) + self.radius * self.width

    @property
    def fade(self) -> arb:
        """Return how fast the slowest exponential on the ring decays [1/s]."""
        return -(self.centre + self.radius * self.width)

    def holds(self, point: acb) -> bool | None:
        """Tell whether a point lies within; None on the ring."""
        distance = abs(point - self.centre)
        return True if distance < self.radius else False if distance > self.radius else None


Ring = tuple[Annulus, list[ExponentialTerm], arb]
"""With what all poles within add to a response, and what that lacks at most."""


def _ring_about(hole: Cell, poles: Sequence[acb]) -> Annulus | None:
    """Return a ring about a neighbourhood, left of the imaginary axis, as far as possible from all poles."""
    centre = -arb((hole.low + hole.high) / 2).exp()
    corner = acb(hole.high, hole.left).exp()
    least = abs(corner - centre).upper()
    most = least * WIDEST
    if not most < -centre:
        return None
    off = sorted((d for p in poles if least < (d := abs(p - centre)) < most), key=arb.mid)
    gaps = list(pairwise([least, *off, most]))
    inner, outer = max(gaps, key=lambda gap: float(gap[1].mid() / gap[0].mid()))
    width = (outer / inner).sqrt().sqrt().mid()
    return Annulus(centre.mid(), (outer * inner).sqrt().mid(), width) if width > 1 else None
