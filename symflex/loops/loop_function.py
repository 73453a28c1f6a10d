"""``A(s) + K B(s)`` of a loop with gain K, on the imaginary axis.

Input: two functions over the ring of a bound transfer function. Output: their values and slopes in balls.
Both are divided by the same exponential, the one that is largest in the middle of a ball, so that neither
overflows nor turns fast; their quotient, which alone decides where poles cross the axis, stays what it is.

Example: with A = s + 2 and B = exp(-s), ``-A/B`` at s = j omega is the gain for which a pole lies there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import lcm

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import Factored
from symflex.balls import expansion, precision
from symflex.loops.axis import LoopAtOrigin, loop_at_origin
from symflex.roots.functions.characteristic import CharacteristicValues
from symflex.roots.functions.exponential_values import Summed, sums_of
from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, slots=True)
class LoopValue:
    """Enclosures of A and B at ``s = j omega``, divided alike, and of their derivatives in s."""

    a: acb
    a_slope: acb
    b: acb
    b_slope: acb

    def crossing(self) -> tuple[arb, arb]:
        """``Im(A conj(B))``, which vanishes where the gain is real, and its derivative in omega."""
        value = (self.a * self.b.conjugate()).imag
        j = acb(0, 1)
        slope = j * self.a_slope * self.b.conjugate() + self.a * (j * self.b_slope).conjugate()
        return value, slope.imag

    def excess(self, gain: arb) -> tuple[arb, arb]:
        """``abs(A)^2 - K^2 abs(B)^2``, which vanishes where the loop gain is one, and its derivative."""
        square = gain * gain
        a, b = self.a.conjugate(), self.b.conjugate()
        value = (self.a * a).real - square * (self.b * b).real
        j = acb(0, 1)
        slope = 2 * (j * self.a_slope * a).real - 2 * square * (j * self.b_slope * b).real
        return value, slope

    def gain(self) -> arb:
        """``-Re(A/B)``: the gain of a pole here, where that is real."""
        return -(self.a / self.b).real


@dataclass(frozen=True, eq=False)
class LoopFunction:
    """A and B of one factor ``A + K B`` of a characteristic function, or more parts of another factor."""

    bound: BoundTransferFunction  # whose ring and kernels they have
    a: fmpz_mpoly  # polynomials over that ring, without common denominator
    b: fmpz_mpoly
    others: tuple[fmpz_mpoly, ...] = ()

    @classmethod
    def of(cls, bound: BoundTransferFunction, *values: Factored) -> LoopFunction:
        """Return functions with the same quotients that are polynomials over the ring."""
        ring = bound.ratio.ring
        below = Factored.number(ring, 1)
        for value in values:
            for factor, exponent in value.factors:
                missing = -exponent - below.exponent_of(factor)
                if missing > 0:
                    below = below * Factored(ring, Fraction(1), ((factor, missing),))
        scale = lcm(*(value.unit.denominator for value in values))
        a, b, *others = ((value * below * scale).expand() for value in values)
        return cls(bound, a, b, tuple(others))

    @property
    def parts(self) -> tuple[fmpz_mpoly, ...]:
        """All of them."""
        return self.a, self.b, *self.others

    @cached_property
    def _sums(self) -> Summed | None:
        """The parts as sums of exponentials, ``None`` where wavenumbers have no formula."""
        return sums_of(self.bound.ratio.ring, self.parts, self.bound.kernels)

    @cached_property
    def _characteristics(self) -> dict[int, CharacteristicValues]:
        return {}

    def characteristic(self, bits: int) -> CharacteristicValues:
        """Return all parts at one precision."""
        if bits not in self._characteristics:
            with precision(bits):
                kernels = self.bound.kernel_values()
            self._characteristics[bits] = CharacteristicValues.of(kernels, self.parts, self._sums)
        return self._characteristics[bits]

    @property
    def turn(self) -> acb:
        """The direction of the axis where functions are of a root of s: that of the root of j."""
        order = self.bound.sheets
        return acb(0, 1) if order == 1 else acb(0, arb.pi() / (2 * order)).exp()

    def on(self, omega: arb, bits: int) -> tuple[LoopValue, LoopValue]:
        """Return A and B on a ball of frequencies and in its middle, with slopes along the axis of s."""
        with precision(bits):
            both, slope = self.around(omega * self.turn, bits), self.turn / acb(0, 1)
            around, middle = (
                replace(value, a_slope=value.a_slope * slope, b_slope=value.b_slope * slope) for value in both
            )
            return around, middle

    def around(self, s: acb, bits: int) -> tuple[LoopValue, LoopValue]:
        """Return A and B on a ball and in its middle, as :meth:`parts_around`."""
        (a, b), (a_mid, b_mid) = self.parts_around(s, bits)
        return LoopValue(*a, *b), LoopValue(*a_mid, *b_mid)

    def parts_around(self, s: acb, bits: int) -> tuple[Sequence[tuple[acb, acb]], Sequence[tuple[acb, acb]]]:
        """Return values, by the mean value theorem if narrower, and slopes on a ball, and in its middle."""
        with precision(bits):
            middle = s.mid()
            parts, which = self.characteristic(bits), range(len(self.parts))
            around = parts.at(expansion(s))
            centre = parts.at(expansion(middle), around)
            less = parts.largest(which, centre)
            values = [[parts.first_order(i, place, less) for i in which] for place in (around, centre)]
            off, pairs = s - middle, zip(*values, strict=True)
            return [(_narrower(x[0], mid[0] + x[1] * off), x[1]) for x, mid in pairs], values[1]

    def is_blurred(self, omega: arb, bits: int = 96) -> bool:
        """Tell whether next to nothing is known of A or B on a hundredth of a frequency."""
        around, _ = self.on(omega * arb(1, 0.01), bits)
        return bool(around.a.contains(0)) or bool(around.b.contains(0))

    def at_origin(self, times: float = 1.0, beyond: Sequence[fmpz_mpoly] = ()) -> LoopAtOrigin | None:
        """Return A and B near 0; see :func:`.loop_at_origin`."""
        return loop_at_origin(self.bound, self.parts, self.turn, times, beyond)

    def near(self, s: complex, bits: int = 96) -> tuple[complex, complex, complex, complex]:
        """Return A, A', B and B' at a point, divided alike, in doubles and without proof."""
        with precision(bits):
            parts = self.characteristic(bits)
            at = parts.at(expansion(acb(s.real, s.imag)))
            less = parts.largest((0, 1), at)
            a, b = (parts.first_order(i, at, less) for i in (0, 1))
            return complex(a[0].mid()), complex(a[1].mid()), complex(b[0].mid()), complex(b[1].mid())


def _narrower(one: acb, other: acb) -> acb:
    is_better = not one.is_finite() or other.rad() < one.rad()
    return other if other.is_finite() and is_better else one
