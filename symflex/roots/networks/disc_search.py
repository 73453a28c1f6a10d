"""Poles and zeros of any network in a disc about 0: damped, with motors, loops, delays, outputs anywhere.

Numerator and denominator are entire functions whose values elimination gives. How fast they grow tells how
many roots a disc contains, about (Jensen); in one that contains enough they become series, whose roots are
counted and proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import ceil, exp, inf, log, pi

from flint import acb, arb

from symflex.balls import UndecidedError, bits_for_digits, precision, precisions
from symflex.budget import spend
from symflex.roots.networks.at_rest import order_at_zero
from symflex.roots.networks.cramer import MOST_LOST, CramerEquations, CramerValue
from symflex.roots.networks.disc_series import GUARD_BITS, DiscSeries, RootNearCircleError, points_needed
from symflex.roots.root import Root, mirror_images
from symflex.transfer.equations_at import EssentialSingularityError

RATIOS = (1.1, 1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 32.0)  # radii of bounds over those of values
MOST_POINTS = 1000  # most points of a circle that may separate what is bounded beyond it from what is on it
SAMPLES = 6  # points of a circle that tell how fast a function grows
ROUGH_BITS = 24  # precision of values that only say how large a function is
SERIES_BITS = 64  # bits to which a series gives the function where it is least on the circles looked at
LEAST_CIRCLES = (1.0, 0.5, 0.25, 0.1, 0.03)
WIDENED = 1.07
TRIES = 8
SMALLEST, LARGEST = 1e-6, 1e12  # radius [rad/s] below which nothing is sought
TOO_WIDE = 0.3  # part by which a disc may be larger than it need be
SHORT = 0.2  # how far the mean growth may stay below the number of all zeros
UNLIKE = 12  # times as many roots as the other has, and so many more, are enough of one function
REFINEMENTS = 40
NEAR_AXIS = 2.0**-20  # share of abs(s): a guess this close to the imaginary axis may lie on it


@dataclass(frozen=True, eq=False)
class DiscSide:
    """Numerator or denominator in a disc."""

    series: DiscSeries
    value: Callable[[acb, int], acb]  # at radius*x, with so many bits
    count: int  # roots in the disc, proved to be all
    roots: tuple[tuple[acb, int], ...]  # enclosures of x = s/radius, one of mirror images, and their counts
    at_zero: int  # how many roots lie at 0
    zero_reach: float  # how far from 0 they may lie [rad/s]; 0 where that is where they are
    is_even: bool

    @property
    def found(self) -> int:
        """How many roots are enclosed."""
        is_real = self.series.is_real
        return self.at_zero + sum(
            n * (images(box, is_even=self.is_even) if is_real else 1) for box, n in self.roots
        )

    def refined(self, box: acb, digits: int) -> acb:
        """Return a smaller enclosure of a simple root, to so many digits of each part, if not far smaller."""
        first = bits_for_digits(digits) + GUARD_BITS
        finer = precisions(first, first << REFINEMENTS)
        bits, wanted = next(finer), arb(10) ** -(digits + 2)
        slope = self.series.slope_on(box)
        for _ in range(REFINEMENTS):
            with precision(bits):
                size = abs(box).mid()
                parts = [abs(x).mid() for x in (box.real, box.imag) if not x.contains(0)]
                least = max(min(parts, default=size), size * wanted)
                if max(box.real.rad(), box.imag.rad()) <= least * wanted:
                    return box
                middle = box.mid()
                closer = middle - self.value(middle, bits) / slope
                if self.is_even and box.real.mid() == 0:
                    closer = acb(arb(0, closer.real.abs_upper()), closer.imag)
                elif self.series.is_real and box.imag == 0:
                    closer = acb(closer.real)
                before, behind = (b.real.rad() + b.imag.rad() for b in (box, closer))
                if not closer.is_finite() or behind > before / 4:
                    bits = next(finer)
                if closer.is_finite() and closer.rad() < box.rad():
                    box = closer
        return box

    def root(self, box: acb, count: int, digits: int) -> Root:
        """Return a root s [rad/s] to so many digits."""
        if count == 1 and self.series.is_real and box.imag.contains(0):
            box = acb(box.real)  # off the axis its image would be one root more than there are
        if count == 1:
            box = self.refined(box, digits)
        on_axis = self.is_even and count == 1 and bool(box.real.mid() == 0)
        is_real = count == 1 and self.series.is_real and bool(box.imag == 0)
        with precision(2 * bits_for_digits(digits) + GUARD_BITS):
            s = box * self.series.radius
        re = arb(0) if on_axis else s.real
        return Root(re, s.imag, count, on_imaginary_axis=on_axis, is_real=is_real, certified=count == 1)

    def all_roots(self, digits: int) -> list[Root]:
        """Return all roots of the disc but those at 0."""
        roots = [self.root(box, count, digits) for box, count in self.roots]
        return mirror_images(roots, even=self.is_even) if self.series.is_real else roots


def images(box: acb, *, is_even: bool) -> int:
    """Return how many boxes mirror a root's, itself among them."""
    count = 1 if box.imag == 0 or box.imag.contains(0) else 2
    return 2 * count if is_even and box.real.mid() != 0 else count


@dataclass(eq=False)
class DiscSearch:
    """Finds the roots of numerator and denominator in discs about 0."""

    equations: CramerEquations
    # Whether roots of denominator and numerator mirror each other in the imaginary axis.
    symmetric: tuple[bool, bool] = (False, False)
    series_bits: int = SERIES_BITS  # to which a series tells the function where it is least
    most_zeros: int | None = None  # where there are not infinitely many
    _lost: int = 0  # bits that elimination lost where it lost most

    def radius_of(self, count: int) -> float:
        """Return the radius [rad/s] of a disc with about so many roots, less where roots accumulate."""
        high = 1.0
        while high > SMALLEST and self._holds(high, count):
            high /= 4
        low = high
        while not self._holds(high, count):
            low, high = high, 4 * high
            if high > LARGEST:
                return high
            if not self._is_bounded(high):
                high = self._last_bounded(low, high)
                if not self._holds(high, count):
                    return high
                break
        while high / low > 1 + TOO_WIDE:
            middle = (low * high) ** 0.5
            low, high = (low, middle) if self._holds(middle, count) else (middle, high)
        return high

    def may_grow(self, radius: float, wanted: int) -> bool:
        """Tell whether a larger disc is worth a search: nothing accumulates, and neither has many."""
        return self._is_bounded(radius) and not self._holds(radius / 2, UNLIKE * wanted)

    def _is_bounded(self, radius: float) -> bool:
        """Tell whether not too many values tell the determinants in a disc."""
        sizes = self._grown(radius)
        for ratio in RATIOS:
            try:
                bounds = self.equations.bounds(radius * ratio)
            except EssentialSingularityError:
                return False
            if max(b - a for a, b in zip(sizes, bounds, strict=True)) < MOST_POINTS * log(ratio):
                return True
        return False

    def _last_bounded(self, low: float, high: float) -> float:
        while high / low > 1 + TOO_WIDE / 4:
            middle = (low * high) ** 0.5
            low, high = (middle, high) if self._is_bounded(middle) else (low, middle)
        return low

    def _holds(self, radius: float, count: int) -> bool:
        """Tell whether a disc contains so many roots, by how fast the functions grow across its circle."""
        step = 0.12
        outer, inner = self._grown(radius * exp(step)), self._grown(radius * exp(-step))
        den, num = ((a - b) / (2 * step) for a, b in zip(outer, inner, strict=True))
        wanted = count if self.most_zeros is None else min(count, self.most_zeros - SHORT)
        return (den >= count and num >= wanted) or max(den, num) >= UNLIKE * count + UNLIKE

    def _grown(self, radius: float) -> tuple[float, float]:
        """Return the mean of ln abs of denominator and numerator on a circle."""
        sizes = self.equations.sizes
        if radius not in sizes:
            spend()
            totals = [0.0, 0.0]
            for k in range(SAMPLES):
                value = self._value((acb(0, pi * (k + 0.5) / SAMPLES).exp() * radius).mid(), ROUGH_BITS)
                for i, x in enumerate((value.den, value.num)):
                    totals[i] += _log(x) / SAMPLES
            sizes[radius] = (totals[0], totals[1])
        return sizes[radius]

    def _value(self, s: acb, bits: int) -> CramerValue:
        """Return both at a point, right to so many bits: elimination loses some with every member."""
        while True:
            value = self.equations.at(s, bits + self._lost)
            known = min(value.den.rel_accuracy_bits(), value.num.rel_accuracy_bits())
            most = MOST_LOST * len(self.equations.entries)
            if known >= bits or self._lost >= most:
                return value
            self._lost = min(self._lost + bits - known, most)

    def sides(self, radius: float) -> tuple[DiscSide, DiscSide]:
        """Return denominator and numerator in a disc about 0, with all their roots there: proved."""
        wide = radius
        for _ in range(TRIES):
            try:
                return self._sides(wide)
            except RootNearCircleError:
                wide *= WIDENED
            except EssentialSingularityError:
                if wide == radius:
                    raise
                break
        raise UndecidedError

    def series(self, radius: float) -> tuple[DiscSeries, DiscSeries]:
        """Return denominator and numerator in a disc about 0, whose roots nobody asks for."""
        return next(self._sampled(radius))

    def _sides(self, radius: float) -> tuple[DiscSide, DiscSide]:
        for below, above in self._sampled(radius):
            if (den := self._side(below, "den")) and (num := self._side(above, "num")):
                return den, num
        raise UndecidedError

    def _sampled(self, radius: float) -> Iterator[tuple[DiscSeries, DiscSeries]]:
        """Yield denominator and numerator in a disc, to ever more bits."""
        middle = arb(radius)
        bounds = []
        for ratio in RATIOS:
            try:
                bound = self.equations.bounds(radius * ratio)
            except EssentialSingularityError:
                break
            if not max(bound) < inf:
                break
            bounds.append((ratio, bound))
        if not bounds:
            raise EssentialSingularityError
        least = [min(size) for size in zip(*(self._least(radius * c) for c in LEAST_CIRCLES), strict=True)]
        extra = self.series_bits
        while extra <= 16 * self.series_bits:
            plans = [
                (max(points_needed(b[i], least[i], ratio, extra) for i in (0, 1)), ratio, b)
                for ratio, b in bounds
            ]
            count, ratio, bound = min(plans)
            largest = self._least(radius, largest=True)
            falls = [ceil((a - b) / log(2)) for a, b in zip(largest, least, strict=True)]
            bits = GUARD_BITS + extra + max(falls)
            # Points so narrow that values do not gain from more bits of theirs.
            with precision(8 * bits):
                values = circle_values(
                    partial(self._value, bits=bits),
                    middle,
                    count,
                    symmetric=all(self.symmetric),
                    is_real=self.equations.is_real,
                )
            den, num = [v.den for v in values], [v.num for v in values]
            yield (
                DiscSeries.of(den, middle, bound[0], ratio, bits, is_real=self.equations.is_real),
                DiscSeries.of(num, middle, bound[1], ratio, bits, is_real=self.equations.is_real),
            )
            extra *= 2

    def _least(self, radius: float, *, largest: bool = False) -> tuple[float, float]:
        points = [(acb(0, pi * (k + 0.3) / SAMPLES).exp() * radius).mid() for k in range(SAMPLES)]
        values = [self._value(point, ROUGH_BITS) for point in points]
        pick = max if largest else min
        return pick(_log(v.den) for v in values), pick(_log(v.num) for v in values)

    def _side(self, series: DiscSeries, name: str) -> DiscSide | None:
        """Return all roots of one function; ``None`` where they are not all proved."""
        is_even = series.is_real and self.symmetric[name == "num"]
        count = series.count()
        at_zero = series.order_at_zero()
        size = len(self.equations.entries) - (name == "den")
        exact = not at_zero or order_at_zero(self.equations, size, at_zero) == at_zero
        boxes = enclosed_roots(series, at_zero, is_even=is_even)

        def value(x: acb, bits: int) -> acb:
            with precision(4 * bits):
                s = x * series.radius
            return self.equations.alone(s, bits, is_num=name == "num")

        reach = 0.0
        if not exact:
            reach = min((float(abs(box).lower()) for box, _ in boxes), default=1.0) / 4
            if series.count_about(acb(0), reach) != at_zero:
                return None
            reach *= float(series.radius)
        side = DiscSide(series, value, count, tuple(boxes), at_zero, reach, is_even)
        return side if side.found == count else None


def enclosed_roots(series: DiscSeries, at_zero: int, *, is_even: bool = False) -> list[tuple[acb, int]]:
    """Return boxes about roots but 0, one of those that mirror each other, with counts: proved."""
    boxes: list[tuple[acb, int]] = []
    left: list[acb] = []
    for guess in series.approximate(at_zero, is_even=is_even):
        if (series.is_real and guess.imag < 0) or (is_even and guess.real < -(abs(guess) * NEAR_AXIS)):
            continue
        x = acb(0, guess.imag) if is_even and abs(guess.real) < abs(guess) * NEAR_AXIS else guess
        box = series.proved(x) or series.proved(guess)
        if box is None:
            left.append(x)
        elif abs(box) < 1 and not any(box.overlaps(b) for b, _ in boxes):
            boxes.append((box, 1))
    return boxes + _clusters(series, left, boxes)


def _clusters(
    series: DiscSeries, guesses: Sequence[acb], boxes: Sequence[tuple[acb, int]]
) -> list[tuple[acb, int]]:
    """Return discs about guesses too close together to be separated, with how many roots they contain."""
    clusters: list[tuple[acb, int]] = []
    for guess in guesses:
        if any(box.contains(guess) for box, _ in clusters):
            continue
        near = [g for g in guesses if abs(g - guess) < abs(guess) * 2.0**-8]
        size = max(float(abs(g - guess).upper()) for g in near) * 4 + float(abs(guess).upper()) * 2.0**-30
        try:
            number = series.count_about(guess, size)
        except RootNearCircleError:
            continue
        box = acb(arb(guess.real.mid(), size), arb(guess.imag.mid(), size))
        if number and abs(box) < 1 and not any(box.overlaps(b) for b, _ in (*boxes, *clusters)):
            clusters.append((box, number))
    return clusters


def circle_values(
    value: Callable[[acb], CramerValue],
    radius: arb,
    count: int,
    *,
    symmetric: bool = False,
    is_real: bool = True,
) -> list[CramerValue]:
    """Return values on a circle, mirrored in the real axis; ``symmetric`` ones in the imaginary axis, too."""
    half = count // 2
    values = {0: value(acb(radius)), half: value(acb(-radius))}
    signs = _parities(values[0], values[half]) if symmetric else None
    if not is_real:
        for k in (k for k in range(count) if k not in values):
            across = values.get(k - half)
            if across is not None and signs is not None:
                values[k] = CramerValue(signs[0] * across.den, signs[1] * across.num)
            else:
                values[k] = value(radius * acb(0, 2 * arb.pi() * k / count).exp())
        return [values[k] for k in range(count)]
    for k in range(1, half):
        across = values.get(half - k)
        if across is not None and signs is not None:
            den, num = signs
            values[k] = CramerValue(den * across.den.conjugate(), num * across.num.conjugate())
        else:
            values[k] = value(radius * acb(0, 2 * arb.pi() * k / count).exp())
    below = (values[k] for k in reversed(range(1, half)))
    return [
        *(values[k] for k in range(half + 1)),
        *(CramerValue(v.den.conjugate(), v.num.conjugate()) for v in below),
    ]


def _parities(right: CramerValue, left: CramerValue) -> tuple[int, int] | None:
    """Return 1 for an even function, -1 for an odd one, by values at r and -r; ``None`` if not known."""
    signs = []
    for a, b in ((right.den, left.den), (right.num, left.num)):
        if a.overlaps(b) == a.overlaps(-b):
            return None
        signs.append(1 if a.overlaps(b) else -1)
    return signs[0], signs[1]


def _log(value: acb) -> float:
    size = abs(value).mid()
    return float(size.log().mid()) if size > 0 else -1e6
