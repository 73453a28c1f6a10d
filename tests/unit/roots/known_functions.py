"""Functions of s whose roots are known, in the form that the proofs of single roots take them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from flint import acb

from symflex.balls import precision


def exact(value):
    """Return a complex number given as an int, a pair of balls, or a pair of ints as a ball."""
    return acb(*value) if isinstance(value, tuple) else acb(value)


@dataclass(frozen=True, eq=False)
class KnownFunction:
    """A product of factors, each ``scale * (s - a) * (s - b) * ...`` to an exponent.

    Parameters
    ----------
    factors : tuple of (tuple of roots, int)
        Roots as ints or pairs, and the exponent.
    is_even : bool
        What the function claims of itself.
    scale : int
        Slopes of any size prove the same.
    """

    factors: tuple
    is_even: bool = False
    is_mirrored: bool = False
    scale: int = 3
    power: int = 1
    is_real: bool = True
    is_paired: bool = True

    @cached_property
    def roots(self):
        return [([exact(root) for root in roots], exponent) for roots, exponent in self.factors]

    def value_and_slope(self, i, s):
        value, slope = acb(self.scale), acb(0)
        for root in self.roots[i][0]:
            value, slope = value * (s - root), slope * (s - root) + value
        return value, slope

    def enclosed(self, s, bits):
        with precision(bits):
            return [(*self.value_and_slope(i, s), self.roots[i][1]) for i in range(len(self.roots))]

    def enclosed_about(self, ball, centre, bits):
        with precision(bits):
            return [
                (self.value_and_slope(i, centre)[0], self.value_and_slope(i, ball)[1], exponent)
                for i, (_, exponent) in enumerate(self.roots)
            ]

    def is_analytic_on(self, ball, bits):
        return True

    def value(self, s, bits):
        with precision(bits):
            product = acb(1)
            for i, (_, exponent) in enumerate(self.roots):
                product *= self.value_and_slope(i, s)[0] ** exponent
            return product**self.power
