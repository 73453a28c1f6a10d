"""What counts, searches and phases ask of a function of s, whatever it is made of.

Input: none; sums of exponentials, polynomials in kernels and equations answer.
Output: two protocols, :class:`Followed` along paths and :class:`Entire` for proofs.

Example: cosh(s) is real on the real axis and even, so that its roots mirror each other in both axes, and a
quarter of a circle says how many it holds. With a loss factor, cosh(s/sqrt(1 + j eta)) is even and not real:
-s is a root if s is, and half a circle says it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from flint import acb, arb

FactorBall = tuple[acb, acb, int]  # value and derivative of a factor, and its exponent


@dataclass(frozen=True, slots=True)
class Sample:
    """Value and slope of a function F at a point."""

    log: complex  # ln F, its imaginary part up to whole turns
    slope: complex  # the logarithmic derivative in the coordinate of the path


class Followed(Protocol):
    """A function that paths in ``z = ln(s)`` follow by its values, which are right and prove nothing."""

    @property
    def work(self) -> int:
        """What was evaluated so far, so that searches can keep to a budget."""

    @property
    def is_even(self) -> bool:
        """Whether roots are proved to mirror each other in both axes."""

    @property
    def is_negated(self) -> bool:
        """Whether a minus sign stands in front."""

    def at_logarithm(self, z: complex) -> Sample | None:
        """Return the sample at ``s = exp(z)``, with the slope in z; ``None`` on a root."""

    def at_point(self, s: acb) -> Sample | None:
        """Return the sample at an exact ``s``, with the slope in ln(s)."""

    def order_at_zero(self) -> float:
        """Return the order of the root at s = 0, close to an integer; NaN when it is not found."""

    def reach(self, s: float) -> float:
        """Return how many radians of its waves the function holds at a positive ``s``, at most."""


class Entire(Followed, Protocol):
    """An entire function, a product of powers of factors; its ``power`` has one value, and is counted."""

    @property
    def power(self) -> int:
        """Exponent that makes one function of what changes with the branch of a wavenumber."""

    @property
    def cancels(self) -> bool:
        """Whether balls that are not small say nothing, so that series take their place."""

    @property
    def is_real(self) -> bool:
        """Whether it is real on the real axis, so that roots mirror each other in it."""

    @property
    def is_paired(self) -> bool:
        """Whether the roots of one half-plane follow from those of the other."""

    @property
    def is_mirrored(self) -> bool:
        """Whether roots are proved to mirror each other in both axes, though values may not."""

    def value(self, s: acb, bits: int) -> acb:
        """Return a ball around the power of F on a ball ``s``."""

    def enclosed(self, s: acb, bits: int) -> list[FactorBall]:
        """Return balls around value and derivative of every factor on a ball ``s``."""

    def enclosed_about(self, ball: acb, centre: acb, bits: int) -> list[FactorBall]:
        """Return balls around values at an exact point, and around derivatives on a ball that contains it."""

    def is_analytic_on(self, disc: acb, bits: int) -> bool:
        """Tell whether the function has no pole on a ball."""

    def turn_of_exponentials(self, ball: acb, start: acb, end: acb, bits: int) -> tuple[float, arb] | None:
        """Return how far the argument may turn on a ball, and its turn between points, else ``None``."""
