"""An entire function in a disc about 0, from its values on the circle: a polynomial, and how far it is off.

    f = cosh(s), abs(s) <= 10: values at 64 points of the circle give 64 coefficients of its Taylor series. As
    abs(f) <= e^40 for abs(s) <= 40, what they lack is below e^40/4^64 = 7e-22, and so is what comes after

The values are balls at points, which elimination gives; the bound beyond may be crude, its logarithm alone
counts. The argument of the polynomial, the error being less than its size, turns on the circle as the
function's does (Rouche), so the roots are counted. Each is proved by an interval Newton step, and then
narrowed by values at points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil, exp, log, pi

from flint import acb, acb_poly, acb_series, arb

from symflex.balls import ball, precision, series_terms, stays_inside
from symflex.budget import spend

GUARD_BITS = 64  # what the elimination of a network loses mostly; where it loses more, more are taken
MOST_TIMES_BITS = 8  # largest factor on the precision of a series to separate its roots
SMALLEST_ARC = 2.0**-11  # shortest arc of a circle that is followed [rad]; below, a root counts as on it
BISECTIONS = 60
SERIES_TERMS = 40  # terms of the function about a point of a circle; the others are bounded
LEFT_OUT = 8  # times what coefficients lack, that leaving some out may add: three bits of them
WITHIN = 0.9  # share of its distance to 0 by which the function may move on a step
WIDENINGS = 8
FEWEST_POINTS = 8  # half of them, on a circle


class RootNearCircleError(Exception):
    """A root lies on the circle, or too close to it."""


@dataclass(frozen=True, eq=False)
class DiscSeries:
    """``f(radius*x)`` for ``abs(x) <= 1``."""

    radius: arb  # [rad/s]
    polynomial: acb_poly  # in x
    off: arb  # how far the polynomial is off
    slope_off: arb  # and its derivative by x is
    bits: int
    is_real: bool = True  # for real x; with loss factors it is not

    @staticmethod
    def of(
        values: Sequence[acb], radius: arb, log_bound: float, ratio: float, bits: int, *, is_real: bool = True
    ) -> DiscSeries:
        """Return the series from values at ``radius*exp(2 pi j k/n)``, with ln of a bound on abs(f)."""
        n = len(values)
        with precision(bits):
            most, shrink = arb(log_bound).exp(), 1 / arb(ratio)
            last = most * shrink**n / (1 - shrink)
            coefficients = acb.dft(list(values))
            aliased = [(last * shrink**k).upper() for k in range(n)]
            terms = [
                acb((c / n).real + arb(0, a), 0 if is_real else (c / n).imag + arb(0, a))
                for c, a in zip(coefficients, aliased, strict=True)
            ]
            slope = most * shrink**n * (n * (1 - shrink) + shrink) / (1 - shrink) ** 2
            # As the bound is crude, most of the last terms are as small as what they lack.
            off, most = last, LEFT_OUT * last
            while len(terms) > FEWEST_POINTS and (more := (off + abs(terms[-1])).upper()) < most:
                slope += (len(terms) - 1) * abs(terms.pop())
                off = more
        return DiscSeries(radius, acb_poly(terms), arb(off), slope, bits, is_real)

    def plus(self, other: DiscSeries, times: Fraction) -> DiscSeries:
        """Return the sum with a multiple of another function in the same disc."""
        bits = min(self.bits, other.bits)
        with precision(bits):
            factor = ball(times)
            polynomial = self.polynomial + other.polynomial * acb(factor)
            off, slope = (
                one + abs(factor) * two
                for one, two in ((self.off, other.off), (self.slope_off, other.slope_off))
            )
        return DiscSeries(self.radius, polynomial, off, slope, bits, self.is_real and other.is_real)

    def on(self, box: acb) -> tuple[tuple[acb, acb], tuple[acb, acb]]:
        """Return value and derivative by x on a box within the unit disc, and in its middle."""
        first, second = self._derivatives
        middle, off, slope_off = box.mid(), ball_about_zero(self.off), ball_about_zero(self.slope_off)
        value, slope = self.polynomial(middle), first(middle)
        along = slope + second(box) * (box - middle)
        return (value + along * (box - middle) + off, along + slope_off), (value + off, slope + slope_off)

    @cached_property
    def _derivatives(self) -> tuple[acb_poly, acb_poly]:
        first = self.polynomial.derivative()
        return first, first.derivative()

    def slope_on(self, box: acb) -> acb:
        """Return the derivative by x on a box within the unit disc."""
        with precision(self.bits):
            return self._slope(self.about(box.mid()), box)

    def _slope(self, local: Sequence[acb], box: acb) -> acb:
        """Return the same from the coefficients about the middle of the box."""
        # What the polynomial's terms take from each other is lost on wide boxes, but not about a point.
        reach = acb(box.real.rad(), box.imag.rad()).abs_upper()
        off = self.slope_off
        power = arb(1)
        for k, c in enumerate(local[2:], 2):
            power = power * reach
            off = off + k * abs(c) * power
        return local[1] + ball_about_zero(off)

    def about(self, x: acb) -> list[acb]:
        """Return the Taylor coefficients of the polynomial about a point."""
        shifted: acb_poly = self.polynomial(acb_poly([x, 1]))
        return shifted.coeffs()

    def first_about(self, x: acb, count: int) -> list[acb]:
        """Return so few of these that the values of derivatives take less time."""
        coefficients, derivative, factorial = [], self.polynomial, 1
        for k in range(count):
            coefficients.append(derivative(x) / factorial)
            derivative, factorial = derivative.derivative(), factorial * (k + 1)
        return coefficients

    # -------------------------------------------------------------------------------------- counting

    def count(self) -> int:
        """Return how many roots the disc contains: proved. RootNearCircleError with one close to its edge."""
        # From one real value to another: half of the circle turns by a multiple of pi.
        return self._turns(acb(0), 1.0, pi, arb.pi) if self.is_real else self.count_about(acb(0), 1.0)

    def count_about(self, centre: acb, size: float) -> int:
        """Return how many roots lie in a disc about a point, within the unit disc: proved."""
        return self._turns(centre, size, 2 * pi, lambda: 2 * arb.pi())

    def _turns(self, centre: acb, size: float, stop: float, unit: Callable[[], arb]) -> int:
        """Follow the argument along a circle in steps on which the function stays close to an exponential."""
        with precision(self.bits):
            angle, total, end = 0.0, arb(0), acb(-1 if stop == pi else 1)
            before: tuple[acb, acb, acb] | None = None
            while True:
                spend()
                point = centre + size * (acb(0, angle).exp() if angle < stop else end)
                local = self.about(point)
                value = local[0] + ball_about_zero(self.off)
                if before is not None:
                    last, start, rate = before
                    turn = rate * (point - start)
                    total += turn.imag + (value / (last * turn.exp())).arg()
                if angle >= stop:
                    break
                rate = (local[1] / local[0]).mid()
                # In units of the circle: powers of those of a small one exceed floats.
                step = self._reach([c * arb(size) ** k for k, c in enumerate(local)], value, rate * size)
                if step < SMALLEST_ARC:
                    raise RootNearCircleError
                before, angle = (value, point, rate), min(angle + step, stop)
            number = (total / unit()).unique_fmpz()
            if number is None:
                raise RootNearCircleError
            return int(number)

    def _reach(self, local: Sequence[acb], value: acb, rate: acb) -> float:
        """Return how far about a point ``f(x + h) exp(-rate h)/f(x)`` stays closer to 1 than 1 is to 0."""
        least = abs(value).abs_lower()
        if not least > 0:
            raise RootNearCircleError
        plain = [float((abs(c) / least).abs_upper()) for c in local]
        slope = float(abs(rate).abs_upper())
        with series_terms(SERIES_TERMS):
            decay = acb_series([0, -rate]).exp()
            turned = [float((abs(c) / least).abs_upper()) for c in (acb_series(local) * decay).coeffs()[1:]]
        off = float((self.off / least).abs_upper())
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            middle = (low * high) ** 0.5 if low else high / 4
            # Terms beyond the series are bounded on a circle four times as large (Cauchy).
            wide = 4 * middle
            beyond = _polynomial_at(plain, wide) * exp(min(slope * wide, 700.0)) * 4.0**-SERIES_TERMS * 4 / 3
            total = (
                _polynomial_at([0.0, *turned], middle) + off * (1 + exp(min(slope * middle, 700.0))) + beyond
            )
            low, high = (middle, high) if total < WITHIN else (low, middle)
            if low and high < 1.1 * low:
                break
        return low

    # -------------------------------------------------------------------------------------- roots

    def order_at_zero(self) -> int:
        """Return how many leading coefficients are not told from zero."""
        coefficients = self.polynomial.coeffs()
        return next((k for k, c in enumerate(coefficients) if not c.contains(0)), len(coefficients))

    def approximate(self, at_zero: int, *, is_even: bool = False) -> list[acb]:
        """Return approximations of roots but 0, from inside outwards; none where they are not separated."""
        with precision(self.bits):
            first, *others = (c.mid() for c in self.polynomial.coeffs()[at_zero :: 1 + is_even])
            # So slight a change splits roots that coincide exactly: none but simple ones are found.
            polynomial = acb_poly([(first * (1 + arb(2) ** (1 - self.bits))).mid(), *others])
            spend()
            try:
                roots = [r.mid() for r in polynomial.roots(maxprec=MOST_TIMES_BITS * self.bits)]
            except ValueError:
                return []
            if is_even:
                roots = [x for r in roots for x in (r.sqrt().mid(), -r.sqrt().mid())]
            close = 2.0 ** (-self.bits // 4)
            guesses = [
                acb(x.real) if self.is_real and abs(x.imag) < abs(x) * close else x
                for x in roots
                if bool(abs(x) < 1)
            ]
            return sorted(guesses, key=lambda x: float(abs(x).mid()))

    def proved(self, guess: acb) -> acb | None:
        """Return a box about a guess that holds exactly one root; ``None`` where none is proved."""
        with precision(self.bits):
            x = guess.mid()
            on_line = self.is_real and bool(x.imag == 0)
            # Horner's rule would turn a box at every step, and widen it.
            local = self.about(x)
            value = local[0] + ball_about_zero(self.off)
            slope = self._slope(local, x)
            if slope.contains(0):
                return None
            reach = (abs(value / slope) * 4).abs_upper()
            for _ in range(WIDENINGS):
                box = x + acb(arb(0, reach), arb(0, 0 if on_line else reach))
                step = value / self._slope(local, box)
                if stays_inside(step.real if on_line else step, reach):
                    return box
                reach = (reach * 4).abs_upper()
        return None


def _polynomial_at(sizes: Sequence[float], x: float) -> float:
    total = 0.0
    for c in reversed(sizes):
        total = total * x + c
    return total


def ball_about_zero(size: arb) -> acb:
    """Return a box about 0 that contains all numbers of a size."""
    reach = arb(0, size.abs_upper())
    return acb(reach, reach)


def points_needed(log_bound: float, log_least: float, ratio: float, bits: int) -> int:
    """Return how many values on the circle tell a function from 0 to so many bits where it is least."""
    wanted = (log_bound - log_least + bits * log(2)) / log(ratio)
    return 2 * max(FEWEST_POINTS, ceil(wanted / 2))
