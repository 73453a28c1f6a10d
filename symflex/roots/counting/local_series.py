"""A function's power series about a point, with proof: roots in small discs, and turns of the argument.

Where wavenumbers vanish or meet, a function with kernels is a small difference of large terms, and still as
smooth in s as anywhere. Its values on a circle about the place, where they are easily told, make the
coefficients (Lyness and Moler 1967); what these miss is bounded by Cauchy's estimate on a wider circle. Where
one term outweighs all others on a circle, it says how many roots lie within (Pellet 1881).

On a step of a path, the function divided by the exponential that it resembles there hardly changes; what is
left is told by the series.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from math import ceil, inf, isfinite, log

from flint import acb, acb_poly, arb

from symflex.balls import UndecidedError, covered, precision
from symflex.roots.functions.entire import Entire
from symflex.roots.functions.kernel_function import ROOM, angle

TERMS = 16  # coefficients that are computed; those beyond are bounded
SHRUNK = 2.0**-6  # radius of the circle where values are taken, over that where they are bounded
ARCS = 32  # into which a circle is cut to bound a function on it, at first
MOST_ARCS = 1024  # after halvings of those on which nothing is known
WIDE_BITS = 64  # precision of bounds on wide balls, which lose all digits anyway
REACH = 0.04  # relative radius of the circle on which a function is bounded to expand it about a point
SERIES_POINTS = 20  # values that make a series of the usual accuracy
SERIES_BITS = 128  # precision of these values
BITS_A_POINT = 6  # what every value more adds to the accuracy of a series


@dataclass(frozen=True, slots=True, eq=False)
class LocalSeries:
    """The first terms of ``F(c + x)``, and a bound of the others."""

    centre: acb  # c, exact [rad/s]
    coefficients: tuple[acb, ...]  # of the powers of x from 0 on
    reach: arb  # radius of a disc where F is analytic [rad/s]
    bound: arb  # at least abs(F) on that disc's circle

    def count(self, radius: arb) -> int | None:
        """Return how many roots are closer to the centre than a radius [rad/s]; ``None`` if not known."""
        share = radius / self.reach
        if not share < 1:
            return None
        power, sizes = arb(1), []
        for coefficient in self.coefficients:
            sizes.append(abs(coefficient) * power)
            power *= radius
        rest = self.bound * share ** len(sizes) / (1 - share)
        largest = max(range(len(sizes)), key=lambda k: sizes[k].mid())
        others = sum((size for k, size in enumerate(sizes) if k != largest), rest)
        return largest if sizes[largest] > others else None

    def around(self, centre: acb, radius: arb) -> tuple[tuple[acb, ...], arb] | None:
        """Return coefficients about another point, and what they miss in a radius, ``None`` beyond reach."""
        off = centre - self.centre
        share = (off.abs_upper() + radius).upper() / self.reach
        if not share < 1:
            return None
        rest = (self.bound * share ** len(self.coefficients) / (1 - share)).upper()
        shifted = acb_poly(list(self.coefficients))(acb_poly([off, acb(1)]))
        return tuple(shifted.coeffs()), rest

    def middle(self, count: int) -> acb | None:
        """Return about the mean of so many roots next to the centre, ``None`` where it cannot be told."""
        below, own = self.coefficients[count - 1 : count + 1]
        # Of a monic polynomial the coefficient below the highest is minus the sum of the roots.
        mean = self.centre - below / (own * count)
        return mean.mid() if mean.is_finite() else None


def local_series(function: Entire, centre: acb, reach: arb, bits: int, points: int) -> LocalSeries | None:
    """Return a series of a function's power about a point, bounded on a circle, or ``None``."""
    bound = bound_on_circle(function, centre, reach, ARCS)
    if bound is None:
        return None
    return sampled_series(function, centre, reach, bound, bits, points, TERMS, SHRUNK)


def sampled_series(
    function: Entire, centre: acb, reach: arb, bound: arb, bits: int, points: int, terms: int, shrunk: float
) -> LocalSeries | None:
    """Return a series about a point from values on a ``shrunk`` circle and a ``bound``, or ``None``."""
    with precision(bits):
        radius = (reach * shrunk).mid()
        roots = [(acb(0, 2) * arb.pi() * k / points).exp() for k in range(points)]
        values = [function.value(centre + radius * root, bits) for root in roots]
        if not all(value.is_finite() for value in values):
            return None
        share = radius / reach
        aliased = bound * share**points / (1 - share**points)
        coefficients = []
        power, limit = arb(1), arb(1)
        for n in range(min(terms, points)):
            total = sum((v * roots[-n * k % points] for k, v in enumerate(values)), acb(0)) / points
            # a_n + a_(n + points) r^points + ... is what the values give.
            error = (aliased / limit).upper()
            coefficients.append(total / power + acb(arb(0, error), arb(0, error)))
            power *= radius
            limit *= reach
        return LocalSeries(centre, tuple(coefficients), reach, bound)


def bound_on_circle(function: Entire, centre: acb, reach: arb, arcs: int) -> arb | None:
    """Return a bound on a function's power on an exact circle, in ``arcs`` at first; ``None`` without one."""
    with precision(WIDE_BITS):
        disc = centre + acb(arb(0, reach), arb(0, reach))
        if not function.is_analytic_on(disc, WIDE_BITS):
            return None
        # The farthest arc is first: what is expanded in powers of s is expanded once for all of them.
        outwards = centre.mid().arg().mid() if centre.mid() != 0 else arb(0)

        def size_on(low: float, high: float) -> arb | None:
            half = (arb.pi() * (high - low)).upper()
            direction = (acb(0, 1) * (outwards + arb.pi() * (low + high) + arb(0, half))).exp()
            value = function.value(centre + reach * direction, WIDE_BITS)
            return abs(value).upper() if value.is_finite() else None

        largest = arb(0)
        with suppress(UndecidedError):
            for _, _, size in covered(size_on, arcs, 1 / MOST_ARCS):
                largest = largest.max(size)
            return largest
        return None


LEAST = 2  # coefficients that a decision needs at least
FEWEST = 20  # terms where a bound is as small as the function
MOST = 250  # terms; where more were needed, shorter steps are better
STEP_SHRUNK = 0.25  # radius of the circle where values are taken, over that where they are bounded
FIRST_ARCS = 16  # into which a circle is cut to bound a function on it, at first
BITS = 160  # least precision: sums that cancel lose about half of them
WIDER = 4  # radius to which a series is bounded, over that of the step it is made for
BEYOND = 3  # radius on which what is cut off a product of series is bounded, over that of the step
SHARP = 2.0**-20  # largest relative error of values at the ends of a step
BLURRED = 2.0  # reported where that is exceeded: more than any step may turn
COVERED = 0.4  # share of the radius of a bound in which the series serves for steps
NOTHING = (inf, arb("nan"))  # bound and turn where nothing is proved


@dataclass(eq=False)
class SeriesSteps:
    """Follows one function by its power series."""

    function: Entire  # its :attr:`~symflex.roots.functions.entire.Entire.power` is followed
    _last: LocalSeries | None = field(default=None, init=False)
    _bits: int = field(default=0, init=False)

    def change(self, middle: acb, reach: arb, start: acb, end: acb, bits: int) -> tuple[float, arb]:
        """Return a bound on the turn of the argument off an exponential's, maybe infinite, and its turn."""
        bits = max(BITS, 2 * bits)
        with precision(bits):
            centre, radius = middle.mid(), reach + (middle - middle.mid()).abs_upper()
            last = self._last
            reached = inf if last is None else (centre - last.centre).abs_upper() + radius
            if last is not None and bits <= self._bits and reached < last.reach * COVERED:
                bound, turn = _followed(last, centre, radius, start, end)
                if bound <= ROOM or last.reach < radius * (2 * WIDER):
                    return bound, turn
            self._last, self._bits = self._made(centre, (radius * WIDER).mid(), bits), bits
            return NOTHING if self._last is None else _followed(self._last, centre, radius, start, end)

    def _made(self, centre: acb, reach: arb, bits: int) -> LocalSeries | None:
        bound = bound_on_circle(self.function, centre, reach, FIRST_ARCS)
        if bound is None:
            return None
        # Terms enough to make up for what the bound is larger than the function.
        excess = float((bound / abs(self.function.value(centre, bits))).upper().log())
        terms = FEWEST + ceil(max(0.0, excess) / log(WIDER)) if isfinite(excess) else MOST
        if terms > MOST:
            return None
        bits += 2 * terms
        return sampled_series(self.function, centre, reach, bound, bits, terms, terms, STEP_SHRUNK)


def _followed(series: LocalSeries, centre: acb, radius: arb, start: acb, end: acb) -> tuple[float, arb]:
    """Return what a series tells of a step in a disc."""
    here = series.around(centre, radius)
    if here is None or len(here[0]) < LEAST:
        return NOTHING
    coefficients, missed = here
    growth = (coefficients[1] / coefficients[0]).mid()
    if not growth.is_finite():
        return NOTHING
    size, count = abs(growth), len(coefficients)
    decay = [acb(1)]
    for n in range(1, count):
        decay.append(decay[-1] * -growth / n)
    # Times exp(-growth x), the term of first order is gone.
    flat = (acb_poly(list(coefficients)) * acb_poly(decay)).truncate(count).coeffs()
    wide = radius * BEYOND
    largest = acb_poly([abs(c) for c in coefficients])(acb(wide)).real * (size * wide).exp()
    cut = largest * arb(BEYOND) ** -count * BEYOND / (BEYOND - 1)
    error = cut + missed * (size * radius).exp()
    power, off = arb(1), error
    for coefficient in flat[1:]:
        power *= radius
        off += abs(coefficient) * power
    first = flat[0]
    if not off.is_finite():
        return NOTHING
    bound = angle(off, abs(first))
    if not error < abs(first) * SHARP:
        # What was cut off would make the argument at the ends too blurred to add up.
        bound = max(BLURRED, bound)
    unsure = acb(arb(0, error), arb(0, error))
    ends = [acb_poly(flat)(place - centre) + unsure for place in (start, end)]
    turn = (growth * (end - start)).imag
    # Both ends lie within a right angle of the middle.
    return bound, turn + (ends[1] / first).arg() - (ends[0] / first).arg()
