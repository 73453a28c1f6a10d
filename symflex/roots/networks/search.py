"""Eigenvalues of a network without losses, isolated by counts and enclosed to any number of digits.

    guesses in doubles     59.402, 71.609, ... rad/s
    counts beside each     0 below 59.4024127, 1 below 59.4024129: one eigenvalue between
    secants                of the determinant, or of the receptance where a motion is held
    counts again           at both ends of an interval as narrow as the digits asked for

What is proved is the counts alone: whatever guesses are, no eigenvalue is missed and none found twice.
"""

from __future__ import annotations

from bisect import insort
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flint import arb, ctx

from symflex.roots.networks.members import UndecidedError
from symflex.roots.precision import bits_for_digits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.budget import Budget
    from symflex.roots.networks.counting import Counter, NetworkSample

BESIDE = 2.0**-28
"""How far to both sides of an estimate its eigenvalue is expected, relative to it."""
GUARD_BITS = 64
"""What the elimination of a network loses mostly; where it loses more, more are taken."""
PATIENCE = 3
"""Secants that may leave most of an interval before it is halved."""
NUDGE = 2.0**-20
"""Parts of an interval by which a point moves that is an eigenvalue itself, of the network or of a member."""
LOWEST = 2.0**-14
"""Fraction of the lowest estimate [of lambda] below which no eigenvalue but 0 is expected."""


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
    budget: Budget
    samples: list[tuple[float, int, NetworkSample]] = field(default_factory=list)  # by lambda
    found: dict[int, Eigenvalue] = field(default_factory=dict)
    base: int | None = None  # count just above 0

    def count(self, sample: NetworkSample) -> int:
        """Return the number of eigenvalues below, but for a constant; UndecidedError at one.

        At an eigenvalue of the network held elsewhere, nothing is told either: what lies in an interval is
        compared.
        """
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

    def at(self, value: arb, room: arb, bits: int | None = None) -> NetworkSample:
        """Return the network at a lambda, or within some room of it where that is an eigenvalue."""
        self.budget.spend()
        bits = bits or self.bits
        for _ in range(3):
            try:
                sample = self.counter.sample(value, bits)
                self.count(sample)
            except UndecidedError:
                with ctx.workprec(2 * bits):
                    value = (value + room * NUDGE).mid()
                    bits *= 2
                    continue
            insort(self.samples, (float(value), len(self.samples), sample))
            return sample
        raise UndecidedError

    def reach(
        self, count: int, highest: arb | None, guesses: Sequence[float], low: NetworkSample
    ) -> NetworkSample:
        """Return a sample above so many eigenvalues, or at the highest lambda asked for."""
        if highest is not None:
            return self.at(highest, highest)
        with ctx.workprec(self.bits):
            value = arb(guesses[-1] * (1 + 2 * BESIDE)) if guesses else 4 * low.value
            sample = self.at(value, value)
            while self._number(sample) < count:
                value = 4 * value
                sample = self.at(value.mid(), value)
        return sample

    def start(self, lowest: float) -> tuple[int, NetworkSample]:
        """Count the eigenvalues at 0 and about it; return how many, and a sample just above."""
        with ctx.workprec(self.bits):
            small = arb(lowest) * LOWEST
            above, below = self.at(small, small), self.at(-small, small)
        self.base = self.count(above)
        return self.base - self.count(below), above

    def isolate(
        self, low: NetworkSample, high: NetworkSample, guesses: Sequence[float], first: int, last: int | None
    ) -> None:
        """Isolate and enclose the eigenvalues between two samples that have numbers from first to last."""
        pending = [(low, high)]
        points = sorted(guesses)
        while pending:
            a, b = pending.pop()
            before, behind = self._number(a), self._number(b)
            if before == behind or behind < first or (last is not None and before >= last):
                continue
            inside = [
                g for g in points if float(a.value) < g * (1 - BESIDE) and g * (1 + BESIDE) < float(b.value)
            ]
            if behind - before == 1 and not inside:
                self._enclose(a, b)
                continue
            if inside:
                guess = inside[len(inside) // 2]
                points.remove(guess)
                with ctx.workprec(self.bits):
                    room = arb(guess) * BESIDE
                    left = self.at((guess - room).mid(), room)
                    right = self.at((guess + room).mid(), room)
                pending += [(right, b), (left, right), (a, left)]
                continue
            if self._is_close(a, b):
                self.found[before + 1] = Eigenvalue(a, b, before + 1, behind - before)
                continue
            middle = self._between(a, b)
            pending += [(middle, b), (a, middle)]

    def ordered(self) -> tuple[Eigenvalue, ...]:
        """Return what was found, in order."""
        return tuple(self.found[n] for n in sorted(self.found))

    def _number(self, sample: NetworkSample) -> int:
        return self.count(sample) - (self.base or 0)

    def _between(self, a: NetworkSample, b: NetworkSample) -> NetworkSample:
        with ctx.workprec(self.bits):
            low, high = a.value, b.value
            # Far apart the geometric mean: frequencies spread over decades.
            middle = (low * high).sqrt() if low > 0 and high > 4 * low else (low + high) / 2
            return self.at(middle.mid(), high - low)

    def _is_close(self, a: NetworkSample, b: NetworkSample) -> bool:
        with ctx.workprec(self.bits):
            return bool(b.value - a.value <= self._tolerance(b.value))

    def _tolerance(self, value: arb) -> arb:
        """Return how wide the interval may be: lambda has a relative error twice that of omega."""
        return value * arb(10) ** -(self.digits + 2)

    def _enclose(self, low: NetworkSample, high: NetworkSample) -> None:
        """Enclose the one eigenvalue between two samples."""
        first = self._number(low)
        with ctx.workprec(self.bits):
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
