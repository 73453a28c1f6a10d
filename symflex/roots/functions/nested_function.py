"""A function in nested form, with what winding numbers and phases ask of one: values, slopes, scale.

It is evaluated at points, where it is right to the last bit; balls about them lead to no enclosure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from flint import acb, acb_poly

from symflex.balls import precision, precisions
from symflex.roots.functions.entire import Sample
from symflex.transfer import BoundNested
from symflex.transfer.double_value import FIRST_BITS, LAST_BITS

SETTLED_BITS = 30  # precision of a value and its slope: more than a step along a path needs
LOW = -200.0  # ln of a frequency [rad/s] below all roots but those at rest


@dataclass(eq=False)
class NestedFunction:
    """A transfer function in nested form along paths in ``z = ln(s)``; ``work`` counts operations."""

    bound: BoundNested
    work: int = field(default=0, init=False)
    is_negated: bool = field(default=False, init=False)
    _bits: int = field(default=FIRST_BITS, init=False)

    @property
    def is_even(self) -> bool:
        """False, as nothing is known of it."""
        return False

    def at_logarithm(self, z: complex) -> Sample | None:
        """Return the sample at ``s = exp(z)``, with the slope in z; None on a root."""
        return self._settled(lambda: acb(z.real, z.imag).exp())

    def at_point(self, s: acb) -> Sample | None:
        """Return the sample at an exact ``s``, with the slope in ln(s)."""
        return self._settled(lambda: s)

    def order_at_zero(self) -> float:
        """Return the order of the root at s = 0, close to an integer; NaN when it is not found."""
        sample = self.at_logarithm(complex(LOW, 0.0))
        return float("nan") if sample is None else sample.slope.real

    def reach(self, s: float) -> float:
        """Return how many radians all members together hold of their waves at a positive ``s``."""
        self.work += self.bound.source.size
        with precision(FIRST_BITS):
            number, total = self.bound.numeric.on(acb(s)), 0.0
            for waves in self.bound.numeric.waves:
                characteristic = acb_poly([*map(number, waves.law.characteristic), acb(1)])
                exponents = [*characteristic.roots(), number(waves.law.shift)]
                total += float((max(abs(x).mid() for x in exponents) * abs(number(waves.length)).mid()).mid())
            return total

    def _settled(self, point: Callable[[], acb]) -> Sample | None:
        for bits in precisions(self._bits, LAST_BITS):
            self.work += self.bound.source.size
            with precision(bits):
                s = point()
                value, slope = self.bound.enclosed(bits).value_and_slope(s)
                if value.is_finite() and value == 0:
                    return None
                if all(x.is_finite() and x.rel_accuracy_bits() >= SETTLED_BITS for x in (value, slope)):
                    self._bits = bits
                    middle = value.mid()
                    return Sample(complex(float(abs(middle).log()), float(middle.arg())), complex(s * slope))
        return None
