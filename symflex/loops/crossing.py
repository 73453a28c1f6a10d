"""Where poles meet the imaginary axis, and how many lie right of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import arb


@dataclass(frozen=True, slots=True)
class Crossing:
    """A gain at which poles may pass from one side of the imaginary axis to the other.

    Parameters
    ----------
    gain : arb
        Enclosure of the gain.
    frequencies : tuple of arb
        Enclosures of omega >= 0 [rad/s] at which poles are on the axis; exactly 0 where they pass through
        s = 0.
    is_infinite : bool
        A pole passes through infinity: the highest power of s vanishes.
    is_symmetric : bool
        Poles that mirror each other in the axis for every gain meet on it, and leave it or enter it.
    """

    gain: arb
    frequencies: tuple[arb, ...]
    is_infinite: bool = False
    is_symmetric: bool = False


@dataclass(frozen=True, slots=True)
class PoleCount:
    """Closed-loop poles that are not in the open left half plane, with multiplicity.

    Parameters
    ----------
    right : int
        In the open right half plane.
    axis : int
        On the imaginary axis.

    Examples
    --------
    >>> PoleCount(2, 0) + PoleCount(0, 1)
    PoleCount(right=2, axis=1)
    """

    right: int
    axis: int

    def __add__(self, other: PoleCount) -> PoleCount:
        return PoleCount(self.right + other.right, self.axis + other.axis)

    @property
    def is_stable(self) -> bool:
        """All poles lie in the open left half plane."""
        return not self.right and not self.axis
