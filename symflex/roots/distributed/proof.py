"""The proof that no root of one side is missing: its domain is counted by its boundary.

Found within 100 rad/s are a double root at 0 and j 3.5, -j 3.5. The argument turns four times on that circle:
they are all. Were it six times, two would be missing, and the domain is searched with every count proved.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import TYPE_CHECKING

from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.plane.domains import decider, is_whole_ring, parts
from symflex.roots.root import Root, overlap

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.budget import Budget
    from symflex.roots.axes.lossless import LosslessSearch

UNPROVED = "the number of roots could not be proved"
TOUCHING = "some roots could not be told apart"
ROUNDING = 1e-15
"""What doubles of enclosures' ends may be off by, relative to them: a few times 2^-53."""


@dataclass(frozen=True, slots=True)
class Proof:
    """Whether the roots of one side are all there."""

    counted: int  # roots in the domain searched, by a certified count; those found where there is none
    found: int  # roots proved there
    reason: str | None = None  # why the count is not certified

    @property
    def is_complete(self) -> bool:
        """The count is certified, and every root was found."""
        return self.reason is None and self.counted == self.found


@dataclass(frozen=True, slots=True)
class Count:
    """Counts the roots of one function with kernels by boundaries."""

    winding: CertifiedWinding  # counts with proof
    order: int  # to which the function vanishes at s = 0
    holes: tuple[Cell, ...]  # what is left out of every domain
    left: float  # pi, or pi/2 where roots mirror each other in the imaginary axis
    lossless: LosslessSearch | None = None  # counts on arcs more quickly

    def within(self, z: float) -> int:
        """Return how many roots lie within exp(z), those at 0 included.

        RootOnPathError where a root lies on the circle, or too close to it.
        """
        if self.lossless is not None:
            return self.lossless.count(z) + self.order
        return self.winding.count_within(z, self.left)

    def is_empty_within(self, z: float | None) -> bool:
        """Tell whether it is proved that no roots but those at 0 lie within exp(z), a disc not searched."""
        if z is None:
            return True
        try:
            return self.winding.count_within(z, self.left) == self.order
        except RootOnPathError:
            return False

    def turns(self, domain: Cell) -> int:
        """Return how often the function winds about 0 on the boundary of a domain without its holes."""
        cells, holes = parts(domain, self.left, self.holes)
        if not is_whole_ring(domain, self.left, self.holes):
            return sum(self.winding.count(cell) for cell in cells)
        turns = self.within(domain.high)
        if domain.low > -inf:
            turns -= self.within(domain.low)
        return turns - sum(self.winding.count(hole) for hole in holes)

    def proof(
        self, domain: Cell, located: Sequence[Root], at_zero: Sequence[Root], innermost: float | None
    ) -> Proof:
        """Count the domain that was searched, and compare with all roots located, mirror images included.

        ``innermost`` is ln of the radius of a disc about 0 within which none was sought.
        """
        if not are_apart(located):
            found = sum(root.multiplicity for root in located)
            return Proof(found, found, TOUCHING)
        cells, holes = parts(domain, self.left, self.holes)
        found, unsure = 0, False
        deciders, hole_deciders = [decider(cell) for cell in cells], [decider(hole) for hole in holes]
        for root in located:
            positions = [is_inside(root) for is_inside in deciders]
            unsure = unsure or (not any(positions) and None in positions)
            if any(positions) and not any(is_inside(root) for is_inside in hole_deciders):
                found += root.multiplicity
        if unsure:
            return Proof(found, found, "a root lies on the boundary of what was searched")
        try:
            turns = self.turns(domain)
        except RootOnPathError:
            return Proof(found, found, UNPROVED)
        if domain.low == -inf:
            turns -= self.order
        elif not self.is_empty_within(innermost):
            return Proof(found, found, UNPROVED)
        counted, rest = divmod(turns, self.winding.function.power)
        if rest:
            return Proof(found, found, UNPROVED)
        if domain.low == -inf:
            counted += sum(root.multiplicity for root in at_zero)
        return Proof(counted, found)

    def right(self, high: float, budget: Budget) -> int:
        """Return how many roots lie right of the imaginary axis, with ln(abs(s)) below ``high``: proved.

        RootOnPathError where a root lies on the path, which follows the imaginary axis, or too close to it;
        SF505, SF506.
        """
        winding = CertifiedWinding(self.winding.function, budget, tries_series=True)
        low = min(winding.smallest(pi, self.holes), high - 1.0)
        if winding.count_within(low, pi) != self.order:
            raise RootOnPathError
        counted, rest = divmod(winding.count(Cell(low, high, -pi / 2, pi / 2)), winding.function.power)
        if rest:
            raise RootOnPathError
        return counted


def are_apart(roots: Sequence[Root]) -> bool:
    """Tell whether no two enclosures overlap."""
    sizes = ((root.natural_frequency(), root) for root in roots)
    spans = [(float(f.lower()) * (1 - ROUNDING), float(f.upper()) * (1 + ROUNDING), r) for f, r in sizes]
    spans.sort(key=lambda span: span[0])
    near: list[tuple[float, Root]] = []
    for low, high, root in spans:
        near = [(end, other) for end, other in near if end >= low]
        if any(overlap(root, other) for _, other in near):
            return False
        near.append((high, root))
    return True
