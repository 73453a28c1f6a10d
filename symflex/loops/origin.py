"""What poles do near s = 0, where wavenumbers vanish: by power series with proved bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, inf, pi
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import Factored
from symflex.algebra.origin import OriginSeries
from symflex.budget import spend
from symflex.errors import SymflexError
from symflex.roots import Budget, precision
from symflex.roots.counting.local_series import SERIES_POINTS, LocalSeries, local_series
from symflex.roots.counting.winding import Winding
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from symflex.loops.loop import LoopFunction

BITS = 320
SHRINKINGS = 24
SHRINKING = 0.5


@dataclass(frozen=True, slots=True)
class LoopAtOrigin:
    """A and B near 0: ``s^order`` times a power series each, of which no other root lies near."""

    orders: tuple[int, int]  # of the roots of A and B at 0, exact
    series: tuple[LocalSeries, LocalSeries]  # of A and B

    def gain(self) -> arb | None:
        """Return the gain at which a pole passes through 0; ``None`` when that is infinite."""
        first, second = self.orders
        if first > second:
            return arb(0)
        if first < second:
            return None
        with precision(BITS):
            return -(self.series[0].coefficients[first] / self.series[1].coefficients[second]).real

    def sizes(self, radius: arb) -> tuple[acb, acb]:
        """Return balls around ``A/s^order`` and ``B/s^order`` on the piece of the axis within a radius."""
        with precision(BITS):
            omega = arb(0).union(radius)
            first, second = (self._reduced(i, omega) for i in (0, 1))
            return first, second

    def _reduced(self, which: int, omega: arb) -> acb:
        series, order = self.series[which], self.orders[which]
        s, total = acb(0, omega), acb(0)
        for coefficient in reversed(series.coefficients[order:]):
            total = total * s + coefficient.real
        share = omega.upper() / series.reach
        count = len(series.coefficients)
        rest = (series.bound * share ** (count - order) / (1 - share) / series.reach**order).upper()
        return total + acb(arb(0, rest), arb(0, rest))

    def turns_away(self, radius: arb) -> bool:
        """Tell whether ``Im(A conj(B))`` differs from 0 on the axis within a radius, but for 0 itself."""
        with precision(BITS):
            omega = arb(0).union(radius)
            first, second = (self._parts(i, omega) for i in (0, 1))
            if (self.orders[0] - self.orders[1]) % 2:
                value = first[0] * second[0] + omega * omega * first[1] * second[1]
            else:
                value = first[1] * second[0] - first[0] * second[1]
            return bool(value != 0)

    def moves_away(self, radius: arb) -> bool:
        """Tell, if A/B is real on the axis, whether it changes monotonously within a radius of 0.

        Its derivative is then that of a power of omega times a quotient of functions of omega squared.
        """
        with precision(BITS):
            omega = arb(0).union(radius)
            square = omega * omega
            (a, _), (b, _) = (self._parts(i, omega) for i in (0, 1))
            a_slope, b_slope = (self._slope(i, omega) for i in (0, 1))
            turning = a_slope * b - a * b_slope
            difference = self.orders[0] - self.orders[1]
            value = turning if not difference else difference * a * b + 2 * square * turning
            return bool(value != 0)

    def _slope(self, which: int, omega: arb) -> arb:
        """Return the derivative of u in omega squared."""
        series, order = self.series[which], self.orders[which]
        coefficients = [c.real for c in series.coefficients[order::2]]
        square, total = omega * omega, arb(0)
        for k in range(len(coefficients) - 1, 0, -1):
            total = total * square + (-1) ** k * k * coefficients[k]
        # The sum of k q^(k - 1) from the first missing power on.
        q, first = (omega.upper() / series.reach) ** 2, len(coefficients)
        rest = q ** (first - 1) * (first - (first - 1) * q) / (1 - q) ** 2
        error = (series.bound / series.reach ** (order + 2) * rest).upper()
        return total + arb(0, error)

    def _parts(self, which: int, omega: arb) -> tuple[arb, arb]:
        """Return u and v, functions of omega squared, of ``u + j omega v``."""
        series, order = self.series[which], self.orders[which]
        coefficients = [c.real for c in series.coefficients[order:]]
        square = -omega * omega
        parts = []
        for start in (0, 1):
            total = arb(0)
            for coefficient in reversed(coefficients[start::2]):
                total = total * square + coefficient
            parts.append(total)
        share = omega.upper() / series.reach
        # What the series misses is divided by omega for v.
        count = len(series.coefficients)
        scale = series.bound / (1 - share) / series.reach**order
        rest = (scale * share ** (count - order)).upper()
        rest_over_omega = (scale * share ** (count - order - 1) / series.reach).upper()
        return parts[0] + arb(0, rest), parts[1] + arb(0, rest_over_omega)


def loop_at_origin(function: LoopFunction, budget: Budget) -> LoopAtOrigin | None:
    """Return A and B near 0, ``None`` where their orders or series cannot be told."""
    ring = function.bound.ratio.ring
    orders, found = [], []
    for polynomial in (function.a, function.b):
        whole = Factored.polynomial(ring, polynomial)
        try:
            part = KernelFunction(function.bound, whole)
            order = OriginSeries(ring, function.bound.kernels).order(part.part)
            if order is None or part.power != 1:
                return None
            lowest = Winding(part, budget).smallest(pi)
        except SymflexError:
            spend()
            return None
        orders.append(order)
        found.append((part, lowest, whole.unit))
    lowest = min(low for _, low, _ in found)
    if lowest == -inf:
        return None
    with precision(BITS):
        reach = arb(exp(lowest))
        series = []
        for part, _, unit in found:
            own = local_series(part, acb(0), reach, BITS, SERIES_POINTS * 2)
            if own is None:
                return None
            # Functions whose roots are sought are known but for a factor, which counts here.
            scale = ball(unit)
            scaled = tuple(scale * coefficient for coefficient in own.coefficients)
            series.append(replace(own, coefficients=scaled, bound=own.bound * abs(scale)))
    return LoopAtOrigin((orders[0], orders[1]), (series[0], series[1]))
