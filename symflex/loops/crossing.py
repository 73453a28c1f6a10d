"""Where poles meet the imaginary axis, and how many lie right of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import arb


@dataclass(frozen=True, slots=True)
class Crossing:
    """A gain at which poles may pass from one side of the imaginary axis to the other."""

    gain: arb  # enclosure of the gain
    # Enclosures of omega >= 0 [rad/s] at which poles are on the axis; exactly 0 where they pass through s =
    # 0.
    frequencies: tuple[arb, ...]
    is_infinite: bool = False  # a pole passes through infinity: the highest power of s vanishes
    # Poles that mirror each other in the axis for every gain meet on it, and leave it or enter it.
    is_symmetric: bool = False


@dataclass(frozen=True, slots=True)
class PoleCount:
    """Closed-loop poles that are not in the open left half plane, with multiplicity.

    Examples
    --------
    >>> PoleCount(2, 0) + PoleCount(0, 1)
    PoleCount(right=2, axis=1)
    """

    right: int  # in the open right half plane
    axis: int  # on the imaginary axis

    def __add__(self, other: PoleCount) -> PoleCount:
        return PoleCount(self.right + other.right, self.axis + other.axis)

    @property
    def is_stable(self) -> bool:
        """All poles lie in the open left half plane."""
        return not self.right and not self.axis
