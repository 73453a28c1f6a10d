"""An entire function in a disc about 0, from its values on the circle: a polynomial, and how far it is off.

    f = cosh(s), abs(s) <= 10: values at 64 points of the circle give 64 coefficients of its Taylor series. As
    abs(f) <= e^40 for abs(s) <= 40, what they lack is below e^40/4^64 = 7e-22, and so is what comes after

The values are balls at points, which elimination gives; the bound beyond may be crude, its logarithm alone
counts. The argument of the polynomial, the error being less than its size, turns on the circle as the
function's does (Rouche), so the roots are counted. Each is proved by an interval Newton step, and then
narrowed by values at points.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, ctx

from symflex.algebra.interval_newton import stays_inside
from symflex.budget import spend
from symflex.roots.counting.local_series import turn_of
from symflex.roots.counting.winding import WIDENED, RootOnPathError, total_turn

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

GUARD_BITS = 64
MOST_TIMES_BITS = 8
"""Of the precision of a series, that telling its roots apart may take."""
FIRST_ARC, SMALLEST_ARC = 2.0**-5, 2.0**-13
"""Steps on which the argument is followed, over a circle's length: the first, and the shortest."""
FEWEST_TERMS = 24
"""Of a series about a point of a circle."""
LEFT_OUT = 8
"""Times what coefficients lack, that leaving some out may add: three bits of them."""
WIDENINGS = 8
FEWEST_POINTS = 8
"""Half of them, on a circle."""


@dataclass(frozen=True, eq=False)
class DiscSeries:
    """``f(radius*x)`` for ``abs(x) <= 1``, real for real x."""

    radius: arb  # [rad/s]
    polynomial: acb_poly  # in x
    off: arb  # how far the polynomial is off
    slope_off: arb  # and its derivative by x is
    bits: int

    @staticmethod
    def of(values: Sequence[acb], radius: arb, log_bound: float, ratio: float, bits: int) -> DiscSeries:
        """Return the series from values at ``radius*exp(2 pi j k/n)``.

        ``log_bound`` is ln of a bound on abs(f) within ratio times the radius.
        """
        n = len(values)
        with ctx.workprec(bits):
            most, shrink = arb(log_bound).exp(), 1 / arb(ratio)
            last = most * shrink**n / (1 - shrink)
            coefficients = acb.dft(list(values))
            aliased = [acb(arb(0, (last * shrink**k).upper())) for k in range(n)]
            terms = [(c / n).real + a for c, a in zip(coefficients, aliased, strict=True)]
            slope = most * shrink**n * (n * (1 - shrink) + shrink) / (1 - shrink) ** 2
            # As the bound is crude, most of the last terms are as small as what they lack.
            off, most = last, LEFT_OUT * last
            while len(terms) > FEWEST_POINTS and (more := (off + abs(terms[-1])).upper()) < most:
                slope += (len(terms) - 1) * abs(terms.pop())
                off = more
        return DiscSeries(radius, acb_poly(terms), arb(off), slope, bits)

    def slope_on(self, box: acb) -> acb:
        """Return the derivative by x on a box within the unit disc."""
        # What the polynomial's terms take from each other is lost on wide boxes, but not about a point.
        with ctx.workprec(self.bits):
            reach = acb(box.real.rad(), box.imag.rad()).abs_upper()
            local = self.about(box.mid())
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
        found, derivative, factorial = [], self.polynomial, 1
        for k in range(count):
            found.append(derivative(x) / factorial)
            derivative, factorial = derivative.derivative(), factorial * (k + 1)
        return found

    # -------------------------------------------------------------------------------------- counting

    def count(self) -> int:
        """Return how many roots the disc holds: proved. RootOnPathError with one close to its edge."""
        # From one real value to another: half of the circle turns by a multiple of pi.
        return self._turns(acb(0), 1.0, arb.pi)

    def count_about(self, centre: acb, size: float) -> int:
        """Return how many roots lie in a disc about a point, within the unit disc: proved."""
        return self._turns(centre, size, lambda: 2 * arb.pi())

    def _turns(self, centre: acb, size: float, whole: Callable[[], arb]) -> int:
        """Return how often the argument turns by an angle, on an arc of that angle about a point."""
        with ctx.workprec(self.bits):

            def point(t: float) -> acb:
                return centre + size * acb(0, whole() * t).exp()

            def change(start: float, end: float) -> tuple[float, arb]:
                middle = point((start + end) / 2).mid()
                local = self.about(middle)
                local += [acb(0)] * (FEWEST_TERMS - len(local))
                reach = (size * whole() * (end - start) / 2 * WIDENED).upper()
                return turn_of(local, self.off, reach, (point(start) - middle, point(end) - middle))

            number = (total_turn(change, FIRST_ARC, SMALLEST_ARC) / whole()).unique_fmpz()
            if number is None:
                raise RootOnPathError
            return int(number)

    # -------------------------------------------------------------------------------------- roots

    def order_at_zero(self) -> int:
        """Return how many leading coefficients are not told from zero."""
        coefficients = self.polynomial.coeffs()
        return next((k for k, c in enumerate(coefficients) if not c.contains(0)), len(coefficients))

    def approximate(self, at_zero: int, *, is_even: bool = False) -> list[acb]:
        """Return approximations of the roots in the disc but for those at 0, from the inside outwards.

        An even function's are sought in x squared. Empty where they are not told apart.
        """
        with ctx.workprec(self.bits):
            first, *others = (c.mid() for c in self.polynomial.coeffs()[at_zero :: 1 + is_even])
            # So slight a change splits roots that coincide exactly: none but simple ones are found.
            polynomial = acb_poly([first * (1 + arb(2) ** (1 - self.bits)).mid(), *others])
            spend()
            try:
                roots = [r.mid() for r in polynomial.roots(maxprec=MOST_TIMES_BITS * self.bits)]
            except ValueError:
                return []
            if is_even:
                roots = [x for r in roots for x in (r.sqrt().mid(), -r.sqrt().mid())]
            close = 2.0 ** (-self.bits // 4)
            guesses = [acb(x.real) if abs(x.imag) < abs(x) * close else x for x in roots if bool(abs(x) < 1)]
            return sorted(guesses, key=lambda x: float(abs(x).mid()))

    def proved(self, guess: acb) -> acb | None:
        """Return a box about a guess that holds exactly one root; ``None`` where none is proved."""
        with ctx.workprec(self.bits):
            x = guess.mid()
            # Horner's rule would turn a box at every step, and widen it.
            value = self.about(x)[0] + ball_about_zero(self.off)
            slope = self.slope_on(x)
            if slope.contains(0):
                return None
            reach = (abs(value / slope) * 4).abs_upper()
            for _ in range(WIDENINGS):
                box = x + acb(arb(0, reach), arb(0, 0 if x.imag == 0 else reach))
                step = value / self.slope_on(box)
                if stays_inside(step.real if x.imag == 0 else step, reach):
                    return box
                reach = (reach * 4).abs_upper()
        return None


def ball_about_zero(size: arb) -> acb:
    """Return a box about 0 that holds all numbers of a size."""
    reach = arb(0, size.abs_upper())
    return acb(reach, reach)


def points_needed(log_bound: float, log_least: float, ratio: float, bits: int) -> int:
    """Return how many values on the circle tell a function from 0 to so many bits where it is least."""
    wanted = (log_bound - log_least + bits * log(2)) / log(ratio)
    return 2 * max(FEWEST_POINTS, ceil(wanted / 2))
