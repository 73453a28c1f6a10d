"""Eigenvalues of an undamped network, isolated by counts and enclosed to any number of digits.

    counts        0 below 50 rad/s, 2 below 100, 1 below 70.7: one eigenvalue on either side
    halving       until an interval with one eigenvalue is a thousandth of it
    secants       of the determinant, or of the receptance where a motion is held
    counts again  at both ends of an interval as narrow as the requested digits

What is proved is the counts alone: whatever secants do, no eigenvalue is missed and none found twice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flint import arb

from symflex.balls import Branching, Open, UndecidedError, bits_for_digits, branch, precision, precisions
from symflex.budget import spend
from symflex.roots.networks.disc_series import GUARD_BITS

if TYPE_CHECKING:
    from symflex.roots.networks.counting import Counter, NetworkSample

    Between = tuple[NetworkSample, NetworkSample]

PATIENCE = 3  # secants that may leave most of an interval before it is halved
NEAR = 1e-3  # relative width of an interval in which secants begin
NUDGE = 2.0**-20  # parts of an interval by which a point moves that is an eigenvalue itself
MOST_TIMES = 4  # the precision of samples, where a sign is not decided with it
LOWEST = 2.0**-40  # lambda [rad^2/s^2] below which no eigenvalue but 0 is expected, 1e-6 rad/s
SHRINKING = 2.0**-30  # size of a root's disc relative to the one in which it lies
ROUNDS_AT_REST = 3
RISE = 2**10  # steps up in lambda until there are enough eigenvalues below


@dataclass(frozen=True, slots=True)
class Eigenvalue:
    """Lambda [rad^2/s^2] between two exact numbers, by counts at both."""

    low: NetworkSample
    high: NetworkSample
    number: int  # from 1, of those above 0
    multiplicity: int  # how many lie between

    def enclosure(self) -> arb:
        """Return the interval as a ball."""
        return self.low.value.union(self.high.value)


@dataclass(eq=False)
class EigenvalueSearch:
    """Finds eigenvalues of a network, or of the network with a motion held, in ascending order."""

    counter: Counter
    border: int | None  # which motion is held
    digits: int
    found: dict[int, Eigenvalue] = field(default_factory=dict)
    base: int = 0  # count just above 0
    at_zero: int = 0  # how many eigenvalues lie between the samples about 0
    is_exact: bool = True  # it is proved that these are 0
    near_zero: arb = field(default_factory=arb)  # lambda below which these lie

    def count(self, sample: NetworkSample) -> int:
        """Return the number of eigenvalues below, but for a constant; UndecidedError at one."""
        if not all(r > 0 or r < 0 for r in sample.receptances):
            raise UndecidedError
        if self.border is None:
            return sample.below
        return sample.below + int(sample.receptances[self.border] > 0)

    def function(self, sample: NetworkSample) -> arb:
        """Return what vanishes at an eigenvalue."""
        if self.border is None:
            return sample.determinant
        # Their product is the bordered determinant: a pole beside a zero, as of a mode hardly seen, is gone.
        return sample.determinant * sample.receptances[self.border]

    @property
    def bits(self) -> int:
        """The precision of samples."""
        return bits_for_digits(self.digits) + GUARD_BITS

    def at(self, value: arb, room: arb) -> NetworkSample:
        """Return the network at a lambda, or within some room of it where that is an eigenvalue."""
        spend()
        for bits in precisions(self.bits, MOST_TIMES * self.bits):
            try:
                sample = self.counter.sample(value, bits)
                self.count(sample)
            except UndecidedError:
                with precision(2 * bits):
                    value = (value + room * NUDGE).mid()
            else:
                return sample
        raise UndecidedError

    def reach(self, count: int, low: NetworkSample) -> NetworkSample:
        """Return a sample above so many eigenvalues."""
        sample = low
        while self._number(sample) < count:
            with precision(self.bits):
                value = (RISE * sample.value).mid()
                sample = self.at(value, value)
        return sample

    def start(self, known: Callable[[int], int | None]) -> NetworkSample:
        """Count the eigenvalues about 0, ``known`` of them at 0, and return a sample just above."""
        small = arb(LOWEST)
        for _ in range(ROUNDS_AT_REST):
            above, below = self.at(small, small), self.at(-small, small)
            self.base, self.near_zero = self.count(above), above.value
            self.at_zero = self.base - self.count(below)
            exact = known(self.at_zero) if self.at_zero else 0
            self.is_exact = exact == self.at_zero
            if self.is_exact or exact is None:
                break
            small = (small * SHRINKING).mid()
        return above

    def isolate(self, low: NetworkSample, high: NetworkSample, first: int, last: int | None) -> None:
        """Isolate and enclose the eigenvalues between two samples that have numbers from first to last."""

        def decide(ends: Between) -> Open[Between] | None:
            a, b = ends
            before, behind = self._number(a), self._number(b)
            if before == behind or behind < first or (last is not None and before >= last):
                return None
            if behind - before == 1 and b.value - a.value < NEAR * b.value:
                self._enclose(a, b)
                return None
            return Open(ends)

        def halves(ends: Between) -> list[Between]:
            if self._is_close(*ends):
                return []
            middle = self._between(*ends)
            return [(ends[0], middle), (middle, ends[1])]

        search: Branching[Between, None] = branch([(low, high)], decide, halves)
        for a, b in search.undecided:
            before, behind = self._number(a), self._number(b)
            self.found[before + 1] = Eigenvalue(a, b, before + 1, behind - before)

    def ordered(self) -> tuple[Eigenvalue, ...]:
        """Return what was found, in order."""
        return tuple(self.found[n] for n in sorted(self.found))

    def _number(self, sample: NetworkSample) -> int:
        return self.count(sample) - self.base

    def _between(self, a: NetworkSample, b: NetworkSample) -> NetworkSample:
        with precision(self.bits):
            low, high = a.value, b.value
            # Far apart the geometric mean: frequencies spread over decades.
            middle = (low * high).sqrt() if low > 0 and high > 4 * low else (low + high) / 2
            return self.at(middle.mid(), high - low)

    def _is_close(self, a: NetworkSample, b: NetworkSample) -> bool:
        with precision(self.bits):
            return bool(b.value - a.value <= self._tolerance(b.value))

    def _tolerance(self, value: arb) -> arb:
        """Return how wide the interval may be: lambda has a relative error twice that of omega."""
        return value * arb(10) ** -(self.digits + 2)

    def _enclose(self, low: NetworkSample, high: NetworkSample) -> None:
        """Enclose the one eigenvalue between two samples."""
        first = self._number(low)
        with precision(self.bits):
            before, last, stalled = low, high, 0
            while not self._is_close(low, high):
                width, tolerance = high.value - low.value, self._tolerance(high.value)
                guess = self._secant(before, last)
                middle = ((low.value + high.value) / 2).mid()
                if guess is None or stalled >= PATIENCE or not low.value < guess < high.value:
                    guess, stalled = middle, 0
                points = [guess]
                while points:
                    point = points.pop()
                    if not low.value < point < high.value:
                        continue
                    before, last = last, self.at(point, tolerance)
                    low, high = (last, high) if self._number(last) == first else (low, last)
                    closer = self._secant(before, last) if point is guess else None
                    # Each secant about doubles the digits: the next one has those asked for.
                    if closer is not None and (closer - point) ** 2 < tolerance * closer:
                        points = [(closer + tolerance / 4).mid(), (closer - tolerance / 4).mid()]
                stalled = stalled + 1 if 2 * (high.value - low.value) > width else 0
        self.found[first + 1] = Eigenvalue(low, high, first + 1, 1)

    def _secant(self, a: NetworkSample, b: NetworkSample) -> arb | None:
        """Return where the line through two samples is zero."""
        f, g = self.function(a), self.function(b)
        slope = g - f
        if slope.contains(0):
            return None
        guess: arb = (b.value - g * (b.value - a.value) / slope).mid()
        return guess if guess.is_finite() else None
