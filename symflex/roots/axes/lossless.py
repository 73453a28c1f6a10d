"""Roots of undamped functions on both axes, isolated in one dimension, and modes by their number.

Sign changes on a grid, in doubles, give guesses; one interval Newton step proves that each is a root, and the
only one in its interval; the count on an arc, which takes the part of that of Wittrick and Williams (1971)
and serves zeros as well as poles, shows that there are no others. A mode of a given number lies between two
circles, aimed at by the largest terms and counted: nothing grows with the number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle, islice
from math import exp, inf, log, pi
from typing import TYPE_CHECKING

from flint import arb

from symflex.balls import precision
from symflex.budget import spend
from symflex.roots.axes.axis_function import (
    CLOSER,
    IMAGINARY,
    REAL,
    AxisFunction,
    AxisNewton,
    bits_of,
    bracketed,
    changes_sign,
)
from symflex.roots.axes.harmonic_sum import LosslessFunction, lossless_function
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.root import Root

if TYPE_CHECKING:
    from symflex.roots.axes.axis_function import Doubles

GRID = 0.8  # largest change of a phase [rad] from one sample to the next
BATCH = 4096  # samples taken at once
MOST_SAMPLES = 2_000_000  # most samples of one search, before it is given up
NEWTON_STEPS = 6  # Newton steps from a tenth of an oscillation to all digits of a double
COUNT_BITS = 64  # precision of turns, of which only the nearest integer is wanted
HALF = 0.5  # distance to one integer that separates it from all others
ROUNDS = 40  # tries to aim a circle at a mode by its number; the first or second hits as a rule
SECANTS = 30  # steps that aim a circle
NEARLY = 0.2  # turns [rad] to which a circle is aimed
ASIDE = (0.0, 0.6, -0.6, 1.2)  # turns by which circles that meet roots are moved; the first is mostly midway
WITHIN, BEYOND = -1, 1
SHARES = (0.5, 0.4, 0.6)  # shares at which a ring is cut in two
HALVINGS = 60  # halvings of a ring until it is as thin as doubles can resolve
FEW = 8  # modes up to which their density says little of where the next ones are
CLOSE = 1e-9  # relative distance of two frequencies between which no circle is drawn
DEPTH = 30.0  # how far below the first resonances roots are sought, in ln
HIGHEST = 1e130  # abs(s) [rad/s] beyond which nothing is sought
UNRELIABLE = 1e-10  # relative to the terms of a sum, what is lost in rounding
FIRST_PHASE = 1e-3  # largest phase [rad] at the first sample


@dataclass(frozen=True, slots=True)
class SignChange:
    """A sign change of one factor on one axis."""

    frequency: float  # abs(s) [rad/s]
    t: float  # where, in the variable of the axis
    source: AxisFunction  # the factor there
    exponent: int  # of the factor: the root's multiplicity


class LosslessSearch:
    """Searches one undamped function, real on both axes but for a constant, factor by factor."""

    def __init__(self, function: LosslessFunction, order: int, digits: int) -> None:
        self.function = function
        self.order = order
        self._newton = AxisNewton(digits)
        self._known: dict[int, tuple[tuple[AxisFunction, int], ...]] = {}
        self.roots: list[Root] = []
        self.reached = -inf
        self.missing = 0
        self.excluded: set[Cell] = set()
        self.holes: tuple[Cell, ...] = ()
        self.is_even = True
        self.left = pi / 2

    def _factors_on(self, axis: int) -> tuple[tuple[AxisFunction, int], ...]:
        """Return all factors that are real on an axis, and their exponents."""
        if axis not in self._known:
            found = (
                (self.function.on_axis(number, axis), exponent)
                for number, (_, exponent) in enumerate(self.function.factors)
                if exponent > 0
            )
            self._known[axis] = tuple(
                (source, e) for source, e in found if source is not None and source.waves
            )
        return self._known[axis]

    @property
    def _sources(self) -> tuple[tuple[AxisFunction, int], ...]:
        return self._factors_on(REAL) + self._factors_on(IMAGINARY)

    def count(self, z: float) -> int:
        """Return the number of roots with ln(abs(s)) below ``z`` but for those at 0: proved."""
        turn = self.function.turn(z)
        with precision(COUNT_BITS):
            quarters = turn / (arb.pi() / 2)
            if not quarters.is_finite():
                raise RootOnPathError
            turns = round(float(quarters))
            if not abs(quarters - turns) < HALF:
                raise RootOnPathError
        return turns - self.order

    def extend(self, modes: int, radius: float) -> None:
        """Find the lowest modes that lie on the axes, and all of these up to ln of a radius."""
        self.roots, self.reached = self.lowest(modes) if modes else ([], self.smallest())
        if self.reached < radius:
            self.roots = self.between(0.0, exp(radius))
            self.reached = radius

    def passing(self, radius: float) -> float:
        """Return ln of the radius itself: nothing is left out."""
        return radius

    def smallest(self) -> float:
        """Return ln of a radius within which no roots are sought."""
        return log(self.function.first_frequency) - DEPTH

    def lowest(self, modes: int) -> tuple[list[Root], float]:
        """Return the lowest modes, one of each pair, and ln of a radius between them and the next."""
        if not self._sources:
            return [], self.smallest()
        low = 0.0
        guesses: list[SignChange] = []
        high, about = self.function.first_frequency, self._about(modes + 1)
        samples = 0
        while sum(g.exponent for g in guesses) <= modes:
            changes, used = self._guesses(low, high)
            guesses += changes
            samples += used
            if samples > MOST_SAMPLES or high > HIGHEST:
                break
            known = len(guesses)
            growth = 4.0 if known < FEW else max(1.05, (1.1 * modes / known) ** 2)
            low, high = high, about if about > high else high * growth
        chosen: list[SignChange] = []
        total = 0
        for guess in guesses:
            if total >= modes and guess.frequency > chosen[-1].frequency * (1 + CLOSE):
                # The circle passes between the last mode wanted and the next.
                return self._proved(chosen), (log(chosen[-1].frequency) + log(guess.frequency)) / 2
            chosen.append(guess)
            total += guess.exponent
        return self._proved(chosen), log(low) if low else self.smallest()

    def _about(self, modes: int) -> float:
        """Return an abs(s) below which about so many modes lie, not far too large in any case."""
        first = self.function.first_frequency
        place = self._place(2 * modes + self.order, log(first))
        return min(max(first, exp(place)), first * (2 * modes + FEW) ** 2)

    def between(self, low: float, high: float) -> list[Root]:
        """Return the roots with abs(s) between two [rad/s] at which a factor changes its sign."""
        return self._proved(self._guesses(low, high)[0])

    def _guesses(self, low: float, high: float) -> tuple[list[SignChange], int]:
        """Return all sign changes between two abs(s), ascending, and how many samples it took."""
        import numpy as np  # lumped systems need none of it

        sign_changes: list[SignChange] = []
        samples = 0
        for source, exponent in self._sources:
            with np.errstate(all="ignore"):  # what is too large for doubles changes no sign
                changes, used = self._sign_changes(source, low, high)
            samples += used
            sign_changes += [SignChange(source.natural_frequency(t), t, source, exponent) for t in changes]
        sign_changes.sort(key=lambda guess: guess.frequency)
        return sign_changes, samples

    def _sign_changes(self, source: AxisFunction, low: float, high: float) -> tuple[list[float], int]:
        """Return t at every sign change between two abs(s), close to doubles' precision."""
        import numpy as np

        start, end = source.at_frequency(low), source.at_frequency(high)
        if start == 0:
            start = end * FIRST_PHASE
        count = int(source.fastest(end) * (end - start) / GRID) + 16
        polished: list[float] = []
        last: tuple[float, float] | None = None
        for first in range(0, count, BATCH):
            spend()
            indices = np.arange(first, min(first + BATCH, count) + 1)
            t = start + (end - start) * indices / count
            values, _, sizes = source.sampled(t)
            sure = np.abs(values) > UNRELIABLE * sizes
            t, values = t[sure], values[sure]
            if last is not None:
                t, values = np.insert(t, 0, last[0]), np.insert(values, 0, last[1])
            if not t.size:
                continue
            last = (float(t[-1]), float(values[-1]))
            at = np.nonzero(np.signbit(values[1:]) != np.signbit(values[:-1]))[0]
            if at.size:
                polished += _polished(source, t[at], t[at + 1], values[at], values[at + 1]).tolist()
        return polished, count

    def _proved(self, guesses: Sequence[SignChange]) -> list[Root]:
        proved = (self._proved_at(guess.source, guess.t, guess.exponent) for guess in guesses)
        return [root for root in proved if root is not None]

    def _proved_at(self, source: AxisFunction, t: float, exponent: int) -> Root | None:
        frequency = self._newton.frequency(source, t)
        if frequency is None:
            return None
        zero = arb(0)
        is_real = source.axis == REAL
        return Root(
            frequency if is_real else zero,
            zero if is_real else frequency,
            exponent,
            on_imaginary_axis=not is_real,
            is_real=is_real,
        )

    def numbered(self, number: int) -> Root | None:
        """Return one mode by its number by frequency, mirror images as one; ``None`` if not isolated."""
        low, below = self._circle(number - 1, WITHIN)
        high, upto = self._circle(number, BEYOND)
        for share in islice(cycle(SHARES), HALVINGS):
            root = self._only_root(low, high, upto - below)
            if root is not None:
                return root
            middle = low + (high - low) * share
            count = self.count(middle) // 2
            if count < number:
                low, below = middle, count
            else:
                high, upto = middle, count
        return None

    def _only_root(self, low: float, high: float, multiplicity: int) -> Root | None:
        """Return the root that is all a ring holds, proved to lie between its circles."""
        for axis in (IMAGINARY, REAL):
            for source, exponent in self._factors_on(axis):
                ends = source.at_frequency(exp(low)), source.at_frequency(exp(high))
                if exponent == multiplicity and changes_sign(source, *ends):
                    root = self._proved_at(source, bracketed(source, *ends), exponent)
                    if root is not None and arb(low).exp() < root.natural_frequency() < arb(high).exp():
                        return root
        return None

    def _circle(self, modes: int, side: int) -> tuple[float, int]:
        """Return ln of a radius within which at most or at least so many modes lie, and how many do."""
        aim = modes
        for _ in range(ROUNDS):
            z, count = self._counted_near(aim)
            if (count - modes) * side >= 0:
                return z, count
            # The estimate is off by a few.
            aim += modes - count
        raise RootOnPathError

    def _counted_near(self, modes: int) -> tuple[float, int]:
        """Return ln of a radius within which about so many modes lie, and how many do."""
        start = log(self.function.first_frequency)
        for aside in ASIDE:
            turns = 2 * modes + self.order + aside
            z = self._place(turns, start) if modes > 0 else start + max(modes - 1, -DEPTH) - aside
            try:
                return z, self.count(z) // 2
            except RootOnPathError:
                continue
        raise RootOnPathError

    def _place(self, turns: float, start: float) -> float:
        """Return ln(abs(s)) where about so many roots lie below, spread evenly along its root."""
        goal = turns * pi / 2
        here, there = start, start + 2.0
        before, value = self.function.estimate(here) - goal, self.function.estimate(there) - goal
        for _ in range(SECANTS):
            if abs(value) < NEARLY or value == before:
                break
            roots = exp(here / 2), exp(there / 2)
            root = roots[1] - value * (roots[1] - roots[0]) / (value - before)
            here, before = there, value
            there = min(2 * log(root) if root > 0 else there - 2.0, log(HIGHEST))
            value = self.function.estimate(there) - goal
        return there


def _polished(source: AxisFunction, low: Doubles, high: Doubles, below: Doubles, above: Doubles) -> Doubles:
    """Return roots of a function between pairs of points of opposite sign, by safeguarded Newton steps."""
    import numpy as np

    t: Doubles = low + (high - low) * np.abs(below) / (np.abs(below) + np.abs(above))
    negative = np.signbit(below)
    for _ in range(NEWTON_STEPS):
        values, slopes, _ = source.sampled(t)
        left = np.signbit(values) == negative
        low, high = np.where(left, t, low), np.where(left, high, t)
        step = t - values / slopes
        last, t = t, np.where((step >= low) & (step <= high), step, (low + high) / 2)
        if (np.abs(t - last) <= CLOSER * t).all():
            break
    return t


def lossless_search(function: KernelFunction, order: int, digits: int) -> LosslessSearch | None:
    """Return a search for an even function of one value without damping, ``None`` for one with damping."""
    lossless = lossless_function(function, bits_of(digits))
    return None if lossless is None else LosslessSearch(lossless, order, digits)
