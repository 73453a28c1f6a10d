"""Times at which a response is asked for, and how long it is looked at when nobody says.

Input: doubles, or an end and a number of points. Output: :class:`SampleTimes`, exact.

Times that are evenly spaced are sums of two short lists, here of a = 0, 3 and b = 0, 1, 2:

    0 1 2 3 4 5    =    a + b

so exp(p t) at n of them takes some 2 sqrt(n) exponentials and one product of matrices.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt, pi

import numpy as np
import numpy.typing as npt
from flint import acb, arb

from symflex.algebra import degree_in
from symflex.analysis.response import real_numbers, roots_if_found
from symflex.balls import at_centre, ball
from symflex.errors import Diagnostic, UsageError
from symflex.options import exact
from symflex.roots import PoleZeroMap
from symflex.transfer import AnyBoundFunction

MOST_TIMES = 1_000_000  # as many lines as a file of measured data may have
ROUNDING = 4 * 2.0**-53  # what numpy.linspace may be off by, of the last time: twice a product and a sum
FEWEST = 9  # times from which their even spacing saves anything
TIME_CONSTANTS = 5.0  # after which 1 % of a motion is left
PERIODS, UNDAMPED_PERIODS = 12, 4  # of the slowest oscillation that are shown: more show nothing


@dataclass(frozen=True, eq=False)
class Spread:
    """Two lists whose sums, a by a, are times [s]."""

    outer: list[arb]
    inner: list[arb]
    step: arb | None = None  # between two times that follow each other, where all are evenly spaced

    def exponentials(self, rate: acb) -> tuple[list[acb], list[acb]]:
        """Return ``exp(rate*t)`` at all times of both lists: of even ones two, and powers of these.

        >>> outer, inner = SampleTimes.evenly(Fraction(3), 4).spread().exponentials(acb(1))
        >>> [round(float((a * b).real.log()), 9) for a in outer for b in inner]
        [0.0, 1.0, 2.0, 3.0]
        """
        if self.step is None:
            return [(rate * a).exp() for a in self.outer], [acb(1)]
        inner = _powers((rate * self.step).exp(), len(self.inner) + 1)
        rows, first = _powers(inner.pop(), len(self.outer)), (rate * self.outer[0]).exp()
        return [first * power for power in rows], inner


def _powers(base: acb, count: int) -> list[acb]:
    """Return so many powers from 0 on, each of two before it: a chain of products would widen their balls."""
    powers = [acb(1), base]
    for n in range(len(powers), count):
        powers.append(powers[n // 2] * powers[n - n // 2])
    return powers[:count]


@dataclass(frozen=True, eq=False)
class SampleTimes:
    """Increasing times from 0 on [s]."""

    seconds: npt.NDArray[np.float64]  # to double precision
    step: Fraction | None  # where time number i is ``i*step``, or ``seconds[0] + i*step`` up to ``slack``
    slack: float = 0.0  # [s]
    origin: arb | None = None  # what is taken from every time [s], a ball

    @classmethod
    def evenly(cls, until: Fraction, points: int) -> SampleTimes:
        """Return so many times from 0 to ``until``, exactly evenly spaced.

        >>> SampleTimes.evenly(Fraction(1, 2), 3).seconds.tolist()
        [0.0, 0.25, 0.5]
        """
        return cls(np.array([float(t) for t in evenly(until, points)]), until / (points - 1))

    @classmethod
    def of(cls, times: npt.ArrayLike) -> SampleTimes:
        """Return times given as doubles, each taken as the number it is.

        Raises UsageError: SF811 when they are not finite, not negative and increasing, or too many.

        >>> SampleTimes.of([0, 0.5, 2.0]).step is None
        True
        """
        given = real_numbers(times, "times", "SF811")
        if given.ndim != 1 or given.size > MOST_TIMES:
            raise _refused(f"times must be a list of at most {MOST_TIMES} numbers")
        if not np.isfinite(given).all():
            raise _refused("times must be finite numbers")
        if given.size and given[0] < 0:
            raise _refused(f"a response begins at t = 0, and {given[0]:g} s is earlier")
        if (late := np.flatnonzero(np.diff(given) <= 0)).size:
            a, b = given[late[0]], given[late[0] + 1]
            raise _refused(f"times must increase: {b:g} s follows {a:g} s")
        given.setflags(write=False)
        if given.size < FEWEST:
            return cls(given, None)
        step = (given[-1] - given[0]) / (given.size - 1)
        off = float(np.max(np.abs(given - (given[0] + step * np.arange(given.size)))))
        slack = off + ROUNDING * float(given[-1])
        return cls(given, Fraction(float(step)) if slack < 4 * ROUNDING * given[-1] else None, slack)

    def __len__(self) -> int:
        return int(self.seconds.size)

    def exactly(self) -> list[Fraction]:
        """Return the times as what they mean: even ones as multiples of their step, others as decimals.

        >>> SampleTimes.of([0.1, 0.3]).exactly()
        [Fraction(1, 10), Fraction(3, 10)]
        """
        if self.step is None:
            return [exact(t) for t in self.seconds.tolist()]
        return [exact(float(self.seconds[0])) + self.step * i for i in range(len(self))]

    @property
    def is_exact(self) -> bool:
        """Whether :meth:`enclosed` adds nothing to the times that were given."""
        return self.step is None or self.slack == 0

    def one_by_one(self) -> SampleTimes:
        """Return the same times without what makes them even."""
        return SampleTimes(self.seconds, None, origin=self.origin)

    def since(self, moment: arb) -> tuple[int, SampleTimes]:
        """Return the number of the first time that may not lie before a moment, and times counted from there.

        Where only one is left another follows, as the digits of a response are those of its largest value.

        >>> start, later = SampleTimes.evenly(Fraction(1), 5).since(arb(0.6))
        >>> start, [round(float(t), 3) for t in later.enclosed()]
        (3, [0.15, 0.4])
        """
        every = self.enclosed()
        start = next((i for i, t in enumerate(every) if not t < moment), len(every))
        remaining = self.seconds[start:]
        if remaining.size == 1:
            off = arb(float(remaining[0])) - every[start]
            return start, SampleTimes(np.array([1.0, 2.0]) * remaining[0], None, origin=moment + off)
        if self.step is None or not remaining.size:
            return start, SampleTimes(remaining, None, origin=moment)
        if self.slack:
            return start, SampleTimes(remaining, self.step, 2 * self.slack, moment)
        off = arb(float(remaining[0])) - arb(float(self.seconds[0])) - ball(self.step) * start
        return start, SampleTimes(remaining, self.step, 0.0, moment + off)

    def spread(self, start: int = 0, delay: arb | None = None) -> Spread:
        """Return all times from number ``start`` on, less ``delay``, as sums of two lists."""
        off = (arb(0) if delay is None else delay) + (self.origin or 0)
        if self.step is None or not len(self):
            return Spread([arb(t) - off for t in self.seconds[start:].tolist()], [arb(0)])
        count = len(self) - start
        width = isqrt(max(count - 1, 0)) + 1
        step = ball(self.step)
        first = arb(float(self.seconds[0]), self.slack) + step * start - off
        rows = -(-count // width)
        return Spread(
            [first + step * (width * i) for i in range(rows)], [step * i for i in range(width)], step
        )

    def enclosed(self, start: int = 0, delay: arb | None = None) -> list[arb]:
        """Return every time from number ``start`` on, less a delay, as a ball at the current precision."""
        spread = self.spread(start, delay)
        return [a + b for a in spread.outer for b in spread.inner][: len(self) - start]


def evenly(until: Fraction, points: int) -> tuple[Fraction, ...]:
    """Return so many times from 0 to the last one."""
    return tuple(until / (points - 1) * i for i in range(points))


def _refused(message: str) -> UsageError:
    return UsageError(Diagnostic("SF811", message))


def default_until(bound: AnyBoundFunction, roots: PoleZeroMap | None = None) -> float:
    """Return a time [s] by which the slowest motion has died away, or has been seen often enough.

    >>> from symflex import loads
    >>> lag = loads('symflex = 1' + chr(10) + 'inputs.u = {}' + chr(10) + 'outputs.y = "u/(s + 2)"')
    >>> default_until(lag.transfer_function("y", "u").bind().bound)
    2.5
    """
    waits = [TIME_CONSTANTS * delay for delay in _delays(bound)]
    for root in (roots or roots_if_found(bound)).all_poles:
        size = float(root.natural_frequency())
        if root.is_zero or not size > 0:
            continue
        damping = abs(float(root.re.mid())) if not root.on_imaginary_axis else 0.0
        period = 2 * pi / size
        decay = TIME_CONSTANTS / damping if damping else UNDAMPED_PERIODS * period
        waits.append(decay if root.is_real else min(decay, PERIODS * period))
    return max(waits, default=0.0) or 1.0


def _delays(bound: AnyBoundFunction) -> list[float]:
    if not bound.is_reduced or bound.is_rational:
        return []
    evaluator, delays = bound.kernel_values(), []
    constants = {name: acb(c) for name, c in evaluator.constants.items()}
    for kernel in bound.kernels.kernels:
        if kernel.function == "exp":
            shift = kernel.dispersion.shift * kernel.length
            before, after = (evaluator.value(shift, {"s": acb(x), **constants}) for x in (0, 1))
            # The root of s to a power: s itself in a delay, and a square root where its root decays.
            power = max(sum(degree_in(f, 0) * e for f, e in shift.factors), 1)
            delays.append(abs(float(at_centre(after - before).real)) ** (bound.sheets / power))
    return delays
