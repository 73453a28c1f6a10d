"""How large a transfer function with waves is on balls of s, on arcs, and about points where poles meet.

Input: a bound transfer function. Output: bounds of integrals of its absolute value, which say how much the
poles that a sum over modes leaves out may add to a response. What knows that is a :class:`ModesBound`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from math import inf, pi
from typing import ClassVar

from flint import acb, acb_series, arb

from symflex.algebra.exponential_sum import REAL, Exponent
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.partial_fractions import ExponentialTerm
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import ZERO
from symflex.balls import UndecidedError, at_centre, ball, covered, precision
from symflex.budget import spend
from symflex.roots import Root
from symflex.roots.counting.argument_principle import LogarithmicLine
from symflex.roots.counting.winding import Cell
from symflex.roots.functions.exponential_values import ExponentialValues, exponential_sums
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, slots=True)
class Rest:
    """How much a response differs at most from what the poles below some radius add."""

    always: arb  # at any time up to the last one; infinite where only later times are bounded
    at_times: tuple[arb, ...]  # at each of the times asked for
    start: arb | None = None  # the response at t = 0, where it is known
    fade: arb = ZERO  # at a time t [s] it is exp(-fade t) times what it is always, at most [1/s]


@dataclass(frozen=True, eq=False)
class SizeOfExponentials:
    """How large a sum of exponentials over another is on a ball of s, the largest of each taken out."""

    bound: BoundTransferFunction
    values: ExponentialValues

    @classmethod
    def of(cls, bound: BoundTransferFunction) -> SizeOfExponentials | None:
        """Return the evaluator of a function; None if a wavenumber has no formula, or for long sums."""
        sums = exponential_sums(bound.ratio, bound.kernels)
        if sums is None:
            return None
        with precision(EFFORT.bits):
            return cls(bound, ExponentialValues(bound.kernel_values(), *sums))

    @cached_property
    def is_even(self) -> bool:
        """Whether the function is even or odd in s, as it is without damping."""
        return all(KernelFunction(self.bound, p).is_even for p in (self.bound.num, self.bound.den))

    @property
    def length(self) -> int:
        """How many exponentials it is made of."""
        return sum(len(terms.terms) for terms, _ in self.values.sums)

    def at(self, s: acb, sharp: float = 1.0) -> arb | None:
        """Return the most that abs(H) is on a ball, by exponentials."""
        spend()
        exponents = self.values.at(s)
        total = abs(acb(ball(self.bound.ratio.unit)))
        grown: dict[int, complex] = {}
        for i, (terms, exponent) in enumerate(self.values.sums):
            only = next(iter(terms.terms), REAL)
            largest = only if len(terms.terms) == 1 else self.values.largest([i], exponents)
            value = at_centre(self.values.value(i, exponents, largest))
            if not value.is_finite():
                return None
            scale = abs(value.mid())
            if exponent > 0:
                # A numerator may vanish on the way.
                amplitude = self.values.amplitudes(i, exponents)[list(terms.terms).index(largest)]
                scale = scale.max(abs(at_centre(amplitude).mid()))
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
        growing = exponents.combined(tuple((k, acb(c.real, c.imag)) for k, c in grown.items() if c))
        bound = total if growing is None else total * at_centre(growing).real.exp()
        return bound.upper() if bound.is_finite() else None

    def on_arc(self, reached: float, start: float, end: float) -> arb | None:
        """Return the integral of abs(H) over the angle [rad] from one to another, at one ln(abs(s))."""
        path = LogarithmicLine(complex(reached, start), complex(reached, end))
        count = round((end - start) / EFFORT.arc_step) + 1

        def size_on(low: float, high: float) -> arb | None:
            return self.at(path.step(low, high)[0], EFFORT.sharp)

        total = arb(0)
        with suppress(UndecidedError):
            for low, high, size in covered(size_on, count, EFFORT.smallest_step):
                total += size * (high - low) * (end - start)
            return total.upper()
        return None

    def around(self, hole: Cell, poles: Sequence[acb], within: arb, integrations: int) -> Ring | None:
        """Return what all poles about an accumulation add: a sum on a ring (Trefethen and Weideman 2014).

        First comes the ring, with all ``poles`` that it contains; then the terms, and what they lack at most.
        None if it does not fit into a radius [rad/s], or the function is not bounded on it.
        """
        with precision(2 * EFFORT.bits):
            ring = ring_about(hole, poles)
            if ring is None or not ring.reach < within:
                return None

            def size_on(edge: float, low: float, high: float) -> arb | None:
                s = ring.piece(low, high - low, edge)
                size = self.at(s)
                return None if size is None else size / s.abs_lower() ** integrations

            largest = arb(0)
            try:
                for edge in (-1.0, 1.0):
                    decide = partial(size_on, edge)
                    for _, _, size in covered(decide, EFFORT.ring_steps, EFFORT.smallest_step):
                        largest = largest.max(size)
            except UndecidedError:
                return None
            terms = ring.terms(self.bound, integrations)
            count = 2 * len(terms)
            # In the left half-plane no exponential is larger than 1.
            missing = largest * ring.radius * (ring.width + 1 / ring.width) / (ring.width**count - 1)
            return ring, terms, missing.upper()

    def _expanded(self, number: int, s: acb, largest: Exponent) -> acb:
        """Return one sum over an exponential from its series in a ball's middle, the last term on it."""
        middle, last = s.mid(), EFFORT.series_terms - 1
        near = self.values.at(acb_series([s, acb(1)], EFFORT.series_terms))
        at_middle = self.values.at(acb_series([middle, acb(1)], EFFORT.series_terms), near)
        wide, sharp = (self.values.value(number, disc, largest) for disc in (near, at_middle))
        if not (isinstance(wide, acb_series) and isinstance(sharp, acb_series)):
            return at_centre(wide)
        total = wide[last]
        for k in reversed(range(last)):
            total = total * (s - middle) + sharp[k]
        return total


class ModesBound(ABC):
    """What is known of all modes of a function beyond a radius."""

    name: ClassVar[str]
    slow: ClassVar[int] = EFFORT.slow_modes  # modes that are searched where no number is enough

    @property
    @abstractmethod
    def bound(self) -> BoundTransferFunction:
        """The function."""

    @abstractmethod
    def rest(self, reached: float, integrations: int, times: SampleTimes) -> Rest | None:
        """Return what poles beyond ln(abs(s)) ``reached`` add at most to an impulse integrated so often."""

    @property
    def least(self) -> float:
        """Return ln of the radius from which on something is known."""
        return -inf

    @property
    def most(self) -> int:
        """How many modes are searched at most."""
        return self.slow

    def ring(self, hole: Cell, poles: Sequence[acb], within: arb, integrations: int) -> Ring | None:
        """Return what all poles in a neighbourhood add where infinitely many accumulate, within a radius."""
        return None

    def may_be_pole(self, root: Root) -> bool:
        """Tell whether a root of the denominator may be a pole."""
        return True

    def term(self, root: Root, integrations: int) -> ExponentialTerm | None:
        """Return what a pole and its conjugate add, where that takes less than its residue does."""
        return None


class BoundBySize(ModesBound):
    """The same from how large the function is on paths between poles."""

    function: SizeOfExponentials

    @property
    def bound(self) -> BoundTransferFunction:
        """The function."""
        return self.function.bound

    @property
    def most(self) -> int:
        """How many modes are searched at most: no more than at first, where it takes long."""
        return EFFORT.continued_modes if self.function.length <= EFFORT.long else EFFORT.first_modes[1]

    def ring(self, hole: Cell, poles: Sequence[acb], within: arb, integrations: int) -> Ring | None:
        """Return what poles add that accumulate."""
        return self.function.around(hole, poles, within, integrations)


@dataclass(frozen=True, slots=True)
class Annulus:
    """All s whose distance from a real centre is a radius times a number between 1/width and width."""

    centre: arb
    radius: arb
    width: arb

    def piece(self, start: float, angle: float, edge: float) -> acb:
        """Return a part of the upper half of the inner edge, -1, or the outer, 1, from right to left."""
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

    def terms(self, bound: BoundTransferFunction, integrations: int) -> list[ExponentialTerm]:
        """Return what poles within add, as a sum over points of the ring, in conjugate pairs."""
        count = 2 * int(EFFORT.ring_power / float(self.width.log().mid()) / 2 + 1)
        values, terms = bound.enclosed(2 * EFFORT.bits), []
        for k in range(count // 2):
            off = self.radius * acb(0, arb(2 * k + 1) * arb.pi() / count).exp()
            s = self.centre + off
            terms.append(ExponentialTerm(s, (2 * values(s) * off / s**integrations / count,)))
        return terms

    def holds(self, point: acb) -> bool | None:
        """Tell whether a point lies within; None on the ring."""
        distance = abs(point - self.centre)
        return True if distance < self.radius else False if distance > self.radius else None


Ring = tuple[Annulus, list[ExponentialTerm], arb]  # with what its poles add, and a bound on what that lacks


def ring_about(hole: Cell, poles: Sequence[acb]) -> Annulus | None:
    """Return a ring about a neighbourhood in the left half-plane, as far as possible from all poles."""
    if not hole.right <= pi <= hole.left:
        return None
    centre = -arb((hole.low + hole.high) / 2).exp()
    corner = acb(hole.high, hole.left).exp()
    least = abs(corner - centre).upper()
    most = least * EFFORT.widest
    if not most < -centre:
        return None
    off = sorted((d for p in poles if least < (d := abs(p - centre)) < most), key=arb.mid)
    gaps = list(pairwise([least, *off, most]))
    inner, outer = max(gaps, key=lambda gap: float(gap[1].mid() / gap[0].mid()))
    width = (outer / inner).sqrt().sqrt().mid()
    return Annulus(centre.mid(), (outer * inner).sqrt().mid(), width) if width > 1 else None
