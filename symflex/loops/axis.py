"""Poles on the imaginary axis: all roots of a real function of frequency, and what poles do near s = 0.

Between two limits each root is enclosed and none missing: an interval of frequencies is dropped where the
function, or what the caller asks for, excludes it; it is kept where the function is monotonous and changes
its sign; else it is halved. Near 0, where wavenumbers vanish, power series with rigorous bounds say the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import exp, inf, pi
from typing import TypeVar

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import Factored
from symflex.balls import (
    NEWTON_STEPS,
    STALLED,
    Open,
    Part,
    ball,
    bits_for_digits,
    branch,
    narrowed,
    precision,
)
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, SymflexError
from symflex.model.model import IMAGINARY
from symflex.roots.counting.local_series import SERIES_POINTS, LocalSeries, local_series
from symflex.roots.counting.winding import Winding
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer import BoundTransferFunction

BITS = 96  # of intervals, whose ends are doubles
FIRST_RATIO = 1.25  # of the ends of the first intervals
NARROWEST = 1e-11  # relative width of an interval that is not halved any more
MOST_INTERVALS = 40_000  # of one search, before it is given up

Place = TypeVar("Place")


@dataclass(frozen=True, slots=True)
class AxisRoots:
    """What was found between two frequencies."""

    roots: tuple[arb, ...]  # enclosures [rad/s], ascending; one simple root each
    undecided: tuple[arb, ...]  # narrow intervals about which nothing is proved [rad/s]


def find_on_axis(
    on: Callable[[arb, int], tuple[Place, Place]],
    equation: Callable[[Place], tuple[arb, arb]],
    is_excluded: Callable[[Place], bool],
    limits: Part,
    digits: int,
    most: int = 0,
) -> AxisRoots:
    """Return the roots of a real function of A and B at ``s = j omega``, 0 < omega [rad/s] within limits.

    ``equation`` returns value and derivative; what is left after ``most`` intervals is undecided, else SF505.
    """

    def decide(ends: Part) -> arb | Open[Part] | None:
        ball = ball_of(ends)
        around, centre = on(ball, BITS)
        with precision(BITS):
            if is_excluded(around):
                return None
            value, slope = equation(around)
            middle, _ = equation(centre)
            mean = middle + slope * (ball - ball.mid())
            if value != 0 or mean != 0:
                return None
            if slope != 0:
                sides = [equation(on(arb(x), BITS)[1])[0] for x in ends]
                if all(x != 0 for x in sides):
                    is_passed = bool(sides[0] > 0) != bool(sides[1] > 0)
                    return _refined(on, equation, ball, digits) if is_passed else None
        return Open(ends)

    search = branch(
        pieces(*limits, FIRST_RATIO),
        decide,
        halves,
        order="breadth" if most else "depth",  # what is hard must not leave the rest unseen
        most=most or MOST_INTERVALS,
    )
    if search.unseen and not most:
        message = "the search for crossings of the imaginary axis takes too long"
        raise BudgetError(
            Diagnostic("SF505", message, None, "narrow the range of the gain, or lower --up-to")
        )
    roots = tuple(sorted(search.decided, key=lambda omega: float(omega.mid())))
    return AxisRoots(roots, joined(map(ball_of, sorted(search.undecided))))


def ball_of(ends: Part) -> arb:
    """Return the ball around an interval of frequencies."""
    with precision(BITS):
        low, high = map(arb, ends)
        return (low + high) / 2 + arb(0, ((high - low) / 2).upper())


def halves(ends: Part) -> list[Part]:
    """Return both parts of an interval of frequencies, none of one that is narrow."""
    low, high = ends
    # Off the middle, so that a root there does not stay on an end for ever.
    cut = low + 0.4873 * (high - low)
    return [] if high - low < NARROWEST * high else [(low, cut), (cut, high)]


def pieces(low: float, high: float, ratio: float) -> list[Part]:
    """Return intervals between two frequencies; the ends of each have a ratio."""
    ends = [low]
    while ends[-1] < high:
        ends.append(min(ends[-1] * ratio, high))
    return list(pairwise(ends))


def _refined(
    on: Callable[[arb, int], tuple[Place, Place]],
    equation: Callable[[Place], tuple[arb, arb]],
    ball: arb,
    digits: int,
) -> arb:
    """Return a narrower enclosure of the only root in an interval on which the function is monotonous."""
    wanted = bits_for_digits(digits) + 16

    def newton(ball: arb) -> arb:
        bits = min(max(BITS, 2 * ball.rel_accuracy_bits() + 64), 2 * wanted + BITS)
        around, centre = on(ball, bits)
        with precision(bits):
            candidate = ball.mid() - equation(centre)[0] / equation(around)[1]
            is_near = candidate.is_finite() and candidate.overlaps(ball)
            return ball.intersection(candidate) if is_near else ball

    return narrowed(ball, newton, NEWTON_STEPS, STALLED)


def joined(intervals: Iterable[arb]) -> tuple[arb, ...]:
    """Return intervals, neighbours as one."""
    joined: list[arb] = []
    for interval in intervals:
        if joined and joined[-1].overlaps(interval):
            joined[-1] = joined[-1].union(interval)
        else:
            joined.append(interval)
    return tuple(joined)


ORIGIN_BITS = 320  # precision next to s = 0, where kernels cancel
SHARES = (1, 0.7, 0.5)  # shares of a radius: functions are expanded about 0 up to the first that bounds them


@dataclass(frozen=True, slots=True)
class LoopAtOrigin:
    """The parts near 0: ``s^order`` times a power series each, of which no other root lies near."""

    orders: tuple[int, ...]  # of the roots of the parts at 0, exact
    series: tuple[LocalSeries, ...]  # of the parts, A and B
    ratio: Fraction | None  # A/B at 0 where that is known to be a number, neither zero nor infinite
    turn: acb  # the direction of the axis, another if functions are of a root of s
    is_real: bool = True  # the functions are real for a real s: all but those with loss factors

    def gain(self) -> arb | None:
        """Return the gain at which a pole passes through 0; ``None`` when that is infinite."""
        first, second = self.orders
        if first > second:
            return arb(0)
        if first < second:
            return None
        with precision(ORIGIN_BITS):
            return -(self._lowest(0) / self._lowest(1))

    def sizes(self, radius: arb) -> tuple[acb, acb]:
        """Return balls around ``A/s^order`` and ``B/s^order`` on the piece of the axis within a radius."""
        with precision(ORIGIN_BITS):
            omega = arb(0).union(radius)
            return self._beyond(0, omega), self._beyond(1, omega)

    def turns_away(self, radius: arb) -> bool:
        """Tell whether ``Im(A conj(B))`` differs from 0 on the axis within a radius, but for 0 itself."""
        with precision(ORIGIN_BITS):
            omega = arb(0).union(radius)
            turned = self.turn ** (self.orders[0] - self.orders[1])
            first, second = (self._beyond(i, omega) for i in (0, 1))
            if turned.imag != 0:
                return bool((first * second.conjugate() * turned).imag != 0)
            one, other = (self.turn * self._beyond(i, omega, 1) for i in (0, 1))
            other = other.conjugate()
            rise = one * self._lowest(1) + self._lowest(0) * other + omega * one * other
            return bool((rise * turned.real).imag != 0)

    def beside(self, omega: arb) -> list[acb]:
        """Return real parts, and imaginary ones over omega, of the parts over a power of s they share."""
        least, beside = min(self.orders), []
        for i, order in enumerate(self.orders):
            if order == least:
                beside.append(acb(self._beyond(i, omega).real, (self.turn * self._beyond(i, omega, 1)).imag))
            else:
                part = self._beyond(i, omega) * self.turn ** (order - least) * omega ** (order - least - 1)
                beside.append(acb(omega * part.real, part.imag))
        return beside

    def leaves_one(self, gain: Fraction, radius: arb) -> bool:
        """Tell whether the loop gain is exactly one at 0, and nowhere else on the axis within a radius.

        There ``abs(A)^2 - K^2 abs(B)^2`` is omega squared times what differs from 0.
        """
        if self.ratio is None or self.ratio**2 != gain**2:
            return False
        return bool(self.excess(ball(gain), radius)[1] != 0)

    def excess(self, gain: arb, radius: arb) -> tuple[arb, arb]:
        """Return ``abs(A)^2 - K^2 abs(B)^2`` at 0, and what is times omega^2 within a radius."""
        with precision(ORIGIN_BITS):
            omega = arb(0).union(radius)
            # abs(a + s one)^2 is a^2 + omega^2 (abs(one)^2 - 2 a Re(two)), as one is real but for s two.
            first, second = (
                abs(self._beyond(i, omega, 1)) ** 2 - 2 * self._lowest(i) * self._beyond(i, omega, 2).real
                for i in (0, 1)
            )
            return self._lowest(0) ** 2 - (gain * self._lowest(1)) ** 2, first - gain**2 * second

    def side(self, level: arb, radius: arb) -> int:
        """Return 1 if ``abs(A/B)`` stays above a level within a radius, -1 if below, and 0 if not known."""
        a, b = self.sizes(radius)
        at_zero, curvature = self.excess(level, radius)
        with precision(ORIGIN_BITS):
            power = self.orders[0] - self.orders[1]
            share = level * radius**-power
            if power >= 0 and a.abs_upper() < share * b.abs_lower():
                return -1
            if power <= 0 and a.abs_lower() > share * b.abs_upper():
                return 1
            gain, is_even = radius**2 * curvature, not power and self.is_real and self.turn.real == 0
            # A hull with 0 would reach beyond it by more than the excess at rest.
            least, most = at_zero + gain.min(arb(0)), at_zero + gain.max(arb(0))
            return bool(least > 0) - bool(most < 0) if is_even else 0

    def _lowest(self, which: int) -> arb:
        return self.series[which].coefficients[self.orders[which]].real

    def _number(self, which: int, power: int) -> acb:
        number = self.series[which].coefficients[power]
        return acb(number.real) if self.is_real else number

    def _beyond(self, which: int, omega: arb, beyond: int = 0) -> acb:
        """Return A or B over its lowest power on a piece of the axis, without its first ``beyond`` terms."""
        series, order, argument = self.series[which], self.orders[which] + beyond, omega * self.turn
        share, total = argument.abs_upper() / series.reach, acb(0)
        for power in reversed(range(order, len(series.coefficients))):
            total = total * argument + self._number(which, power)
        remainder = (
            series.bound / (1 - share) / series.reach**order * share ** (len(series.coefficients) - order)
        )
        return total + acb(arb(0, remainder.upper()), arb(0, remainder.upper()))


def loop_at_origin(
    bound: BoundTransferFunction,
    polynomials: Sequence[fmpz_mpoly],
    turn: acb,
    times: float = 1.0,
    beyond: Sequence[fmpz_mpoly] = (),
) -> LoopAtOrigin | None:
    """Return the parts near 0 along ``turn``, up to the next root times a factor; ``None`` if not known.

    Roots of the polynomials ``beyond`` do not matter: they may lie nearer.
    """
    ring = bound.ratio.ring
    orders, parts = [], []
    for polynomial in polynomials:
        product = Factored.polynomial(ring, polynomial)
        try:
            part = KernelFunction(bound, product)
            order = part.order()
            if order is None or part.power != 1:
                return None
            lowest = inf if any(polynomial is each for each in beyond) else Winding(part).smallest(pi)
        except SymflexError:
            spend()
            return None
        orders.append(order)
        parts.append((part, lowest, product.unit))
    lowest = min(low for _, low, _ in parts)
    if abs(lowest) == inf:
        return None
    with precision(ORIGIN_BITS):
        for share in SHARES:  # where waves lose energy, a wavenumber may vanish on the circle
            reach = arb(exp(lowest) * times * share)
            tried = [
                local_series(part, acb(0), reach, ORIGIN_BITS, SERIES_POINTS * 2) for part, _, _ in parts
            ]
            known = [each for each in tried if each is not None]
            if len(known) == len(parts):
                break
        else:
            return None
        series = []
        for each, (_, _, unit) in zip(known, parts, strict=True):
            # Functions whose roots are sought are known but for a factor, which counts here.
            scale = ball(unit)
            scaled = tuple(scale * coefficient for coefficient in each.coefficients)
            series.append(replace(each, coefficients=scaled, bound=each.bound * abs(scale)))
        ratio = _ratio_at_zero(bound, *polynomials[:2])
        return LoopAtOrigin(tuple(orders), tuple(series), ratio, turn, IMAGINARY not in ring.index)


def _ratio_at_zero(bound: BoundTransferFunction, a: fmpz_mpoly, b: fmpz_mpoly) -> Fraction | None:
    """Return A/B at s = 0 of a loop with delay and no waves, None if it is not known."""
    ring, kernels = bound.ratio.ring, bound.kernels.kernels
    if any(k.function != "exp" or not k.dispersion.shift.exponent_of(ring.context.gen(0)) for k in kernels):
        return None
    images = {ring.names[0]: ring.constant(0)} | {k.generator: ring.constant(1) for k in kernels}
    above, below = (Factored.polynomial(ring, ring.replaced(f, images)) for f in (a, b))
    ratio = None if above.is_zero or below.is_zero else above / below
    return ratio.unit if ratio is not None and ratio.is_constant else None
