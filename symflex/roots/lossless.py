"""Roots of lossless functions on both axes, isolated in one dimension, and modes by their number.

Sign changes on a grid, in doubles, give guesses; one interval Newton step proves that each is a root, and the
only one in its interval; the count on an arc, which takes the part of that of Wittrick and Williams (1971)
and serves zeros as well as poles, shows that there are no others. Nothing grows with the number of a mode.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from math import exp, inf, log, log1p, pi
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from symflex.roots.harmonic_sum import IMAGINARY, REAL, lossless_function
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.root import GUARD_BITS, Root
from symflex.roots.winding import RootOnPathError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.roots.harmonic_sum import AxisFunction, Doubles, LosslessFunction
    from symflex.roots.kernel_function import KernelFunction
    from symflex.roots.winding import Cell

GRID = 0.8
"""Largest change of a phase [rad] from one sample to the next."""
BATCH = 4096
MOST_SAMPLES = 2_000_000
NEWTON_STEPS = 6
WIDTH = 2.0**-46
"""Relative width of the interval in which a guess is proved to be the only root."""
SLOPE_BITS = 64
ROUNDS = 40
SECANTS = 30
NEARLY = 0.2
MANY = 100
"""Turns from which on they are proportional to the root of the frequency."""
FEW = 8
CLOSE = 1e-9
DEPTH = 30.0
"""How far below the first resonances roots are sought, in ln."""
HIGHEST = 1e130
"""abs(s) [rad/s] beyond which nothing is sought."""
UNRELIABLE = 1e-10
"""Relative to the terms of a sum, what is lost in rounding."""
FIRST_PHASE = 1e-3
"""Largest phase [rad] at the first sample."""


@dataclass(frozen=True, slots=True)
class Guess:
    """A sign change of one factor on one axis.

    Parameters
    ----------
    frequency : float
        abs(s) [rad/s].
    t : float
        Where, in the variable of the axis.
    source : AxisFunction
        The factor there.
    exponent : int
        Of the factor: the root's multiplicity.
    """

    frequency: float
    t: float
    source: AxisFunction
    exponent: int


class LosslessSearch:
    """Searches one lossless function.

    Parameters
    ----------
    function : LosslessFunction
        Real, but for a constant factor, on both axes, factor by factor; what is not is left to a count.
    order : int
        To which the function vanishes at s = 0.
    digits : int
        Significant digits of every root.

    Attributes
    ----------
    roots : list of Root
        What :meth:`scan` found, in the closed right upper quadrant.
    reached : float
        ln of the radius up to which it searched.
    """

    def __init__(self, function: LosslessFunction, order: int, digits: int) -> None:
        self.function = function
        self.order = order
        self.digits = digits
        self.roots: list[Root] = []
        self.reached = -inf
        self.missing = 0
        self.excluded: set[Cell] = set()
        self.holes: tuple[Cell, ...] = ()
        self.is_even = True
        self.left = pi / 2
        self._sources: list[tuple[AxisFunction, int]] = []
        for number, (_, exponent) in enumerate(function.factors):
            if exponent <= 0:
                continue
            for axis in (REAL, IMAGINARY):
                source = function.on_axis(number, axis)
                if source is not None and source.waves:
                    self._sources.append((source, exponent))

    def count(self, z: float) -> int:
        """Return the number of roots with ln(abs(s)) below ``z``, without those at 0: proved.

        Raises
        ------
        RootOnPathError
            A root lies on the circle, or too close to it.
        """
        turn = self.function.turn(z)
        with precision(SLOPE_BITS):
            found = (turn / (arb.pi() / 2)).unique_fmpz()
        if found is None:
            raise RootOnPathError
        return int(found) - self.order

    def scan(self, modes: int, radius: float, is_complete: Callable[[], bool]) -> bool:
        """Find the lowest modes, and all up to ln of a radius; tell whether these are all."""
        self.roots, self.reached = self.lowest(modes) if modes else ([], self.smallest())
        if self.reached < radius:
            self.roots = self.on_axes(-inf, radius)
            self.reached = radius
        return is_complete()

    def on_axes(self, low: float, high: float) -> list[Root]:
        """Return the roots on both axes between ln of two radii."""
        return self.between(exp(low), exp(high))

    def passing(self, radius: float) -> float:
        """Return ln of the radius itself: nothing is left out."""
        return radius

    def smallest(self) -> float:
        """Return ln of a radius within which no roots are sought."""
        return log(self._first_frequency()) - DEPTH

    def lowest(self, modes: int) -> tuple[list[Root], float]:
        """Return the lowest modes, one of each pair, and ln of a radius between them and the next."""
        if not self._sources:
            return [], self.smallest()
        low = 0.0
        guesses: list[Guess] = []
        high = self._first_frequency()
        samples = 0
        while sum(g.exponent for g in guesses) <= modes:
            found, used = self._guesses(low, high)
            guesses += found
            samples += used
            if samples > MOST_SAMPLES or high > HIGHEST:
                break
            known = len(guesses)
            low, high = high, high * (4.0 if known < FEW else max(1.05, (1.1 * modes / known) ** 2))
        chosen: list[Guess] = []
        total = 0
        for guess in guesses:
            if total >= modes and guess.frequency > chosen[-1].frequency * (1 + CLOSE):
                # The circle passes between the last mode wanted and the next.
                return self._proved(chosen), log(chosen[-1].frequency * guess.frequency) / 2
            chosen.append(guess)
            total += guess.exponent
        return self._proved(chosen), log(low)

    def between(self, low: float, high: float) -> list[Root]:
        """Return the roots with abs(s) between two [rad/s] at which a factor changes its sign."""
        return self._proved(self._guesses(low, high)[0])

    def _guesses(self, low: float, high: float) -> tuple[list[Guess], int]:
        """Return all sign changes between two abs(s), ascending, and how many samples it took."""
        found: list[Guess] = []
        samples = 0
        for source, exponent in self._sources:
            changes, used = self._sign_changes(source, low, high)
            samples += used
            found += [Guess(source.natural_frequency(t), t, source, exponent) for t in changes]
        found.sort(key=lambda guess: guess.frequency)
        return found, samples

    def _first_frequency(self) -> float:
        """Return an abs(s) below which no argument is large."""
        frequency = 1.0
        for _ in range(ROUNDS * 4):
            fastest = max(
                (
                    source.fastest(source.at_frequency(frequency)) * source.at_frequency(frequency)
                    for source, _ in self._sources
                ),
                default=1.0,
            )
            if fastest > 4 * pi:
                frequency /= 3
            elif fastest < pi:
                frequency *= 3
            else:
                break
        return frequency

    def _sign_changes(self, source: AxisFunction, low: float, high: float) -> tuple[list[float], int]:
        """Return t at every sign change between two abs(s), close to doubles' precision."""
        start, end = source.at_frequency(low), source.at_frequency(high)
        if start == 0:
            start = end * FIRST_PHASE
        count = int(source.fastest(end) * (end - start) / GRID) + 16
        found: list[float] = []
        last: tuple[float, float] | None = None
        for first in range(0, count, BATCH):
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
                found += _polished(source, t[at], t[at + 1], values[at], values[at + 1]).tolist()
        return found, count

    def _proved(self, guesses: Sequence[Guess]) -> list[Root]:
        proved = (self.prove(guess) for guess in guesses)
        return [root for root in proved if root is not None]

    def prove(self, guess: Guess) -> Root | None:
        """Return the root next to a guess, proved to be the only one of its factor in a small interval."""
        source = guess.source
        wanted = bits_for_digits(self.digits + 2) + GUARD_BITS
        with precision(wanted):
            goal = arb(10) ** -(self.digits + 2)
        known = 40
        box = arb(guess.t, abs(guess.t) * WIDTH)
        slope_bits = SLOPE_BITS
        is_first = True
        for _ in range(ROUNDS):
            bits = _level(2 * known + GUARD_BITS, wanted)
            slope = source.slope(box, slope_bits)
            middle = box.mid()
            value = source.value(middle, bits)
            with precision(bits):
                step = middle - value / slope
                if not step.is_finite() or (is_first and not box.contains_interior(step)):
                    return None
                is_first = False
                box = step
                accurate = step.rel_accuracy_bits()
                if step.rad() < goal * abs(step):
                    break
                if accurate <= known + 4:
                    return None
            known = accurate
            slope_bits = _level(known + GUARD_BITS, wanted)
        else:
            return None
        with precision(wanted):
            frequency = source.natural_frequency(box)
        zero = arb(0)
        is_real = source.axis == REAL
        return Root(
            frequency if is_real else zero,
            zero if is_real else frequency,
            guess.exponent,
            on_imaginary_axis=not is_real,
            is_real=is_real,
        )

    def numbered(self, number: int) -> Root | None:
        """Return one mode by its number, from 1, without those below it; ``None`` where it is not isolated.

        Modes count by natural frequency; roots that mirror each other count as one.

        Raises
        ------
        RootOnPathError
            Roots are too close to each other for circles to pass between them.
        """
        turns = 2.0 * number + self.order
        place, below = self._count_near(turns)
        # The estimate is off by a few; counted from here, the mode is so many places further.
        further = 2.0 * (number - below)
        if turns > MANY:
            low, high = (place + 2 * log1p((further + side) / turns) for side in (-6, 6))
        else:
            low, high = (self._place(turns + further + side, place) for side in (-6, 6))
        guesses, _ = self._guesses(exp(min(low, place)), exp(max(high, place)))
        reached = below - sum(g.exponent for g in guesses if log(g.frequency) < place)
        totals = accumulate((g.exponent for g in guesses), initial=reached)
        i = next((k for k, total in enumerate(totals) if total >= number), 0) - 1
        if i < 0:
            return None
        guess = guesses[i]
        here = log(guess.frequency)
        below_it = log(guesses[i - 1].frequency) if i else here - log(2)
        above_it = log(guesses[i + 1].frequency) if i + 1 < len(guesses) else max(low, high, place)
        edges = [(below_it + here) / 2, (above_it + here) / 2]
        counts = [self.count(z) // 2 for z in edges]
        if not counts[0] < number <= counts[1] or counts[1] - counts[0] != guess.exponent:
            return None
        return self.prove(guess)

    def _count_near(self, turns: float) -> tuple[float, int]:
        """Return ln(abs(s)) where about so many roots lie below, and how many modes there are."""
        for aside in (0.3, 0.9, -0.4, 1.4):
            place = self._place(turns + aside, log(self._first_frequency()))
            try:
                return place, self.count(place) // 2
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


def _level(bits: int, most: int) -> int:
    """Return one of few precisions, so that constants are evaluated for few."""
    level = SLOPE_BITS
    while level < bits:
        level += max(SLOPE_BITS, level // 4)
    return min(level, most)


def _polished(
    source: AxisFunction,
    low: Doubles,
    high: Doubles,
    below: Doubles,
    above: Doubles,
) -> Doubles:
    """Return roots of a function between pairs of points of opposite sign, by safeguarded Newton steps."""
    t: Doubles = low + (high - low) * np.abs(below) / (np.abs(below) + np.abs(above))
    negative = np.signbit(below)
    for _ in range(NEWTON_STEPS):
        values, slopes, _ = source.sampled(t)
        left = np.signbit(values) == negative
        low, high = np.where(left, t, low), np.where(left, high, t)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = t - values / slopes
        t = np.where((step >= low) & (step <= high), step, (low + high) / 2)
    return t


def lossless_search(function: KernelFunction, order: int, digits: int) -> LosslessSearch | None:
    """Return a search for a function without losses, ``None`` for any other."""
    if not function.is_even or function.power != 1:
        return None
    lossless = lossless_function(function)
    return None if lossless is None else LosslessSearch(lossless, order, digits)
