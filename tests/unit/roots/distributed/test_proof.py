"""A count along the boundary of what was searched, against the roots found there."""

from dataclasses import dataclass, field
from math import hypot, inf, log, pi
from types import SimpleNamespace

import pytest

from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.distributed.proof import UNPROVED, Count, Proof
from symflex.roots.distributed.side import Side
from symflex.roots.plane.search import RootSearch
from tests.unit.roots.stand_ins import root

AT = ((-1, 2), (-1, -2), (-3, 0))
FOUND = [root(*at) for at in AT]


@dataclass
class Told:
    """Counts given roots by their sizes, and two at 0, each ``power`` times, and perhaps ``more``."""

    sizes: tuple[float, ...] = tuple(hypot(*at) for at in AT)
    power: int = 1
    more: int = 0
    on_path: bool = False
    function: SimpleNamespace = field(init=False)

    def __post_init__(self):
        self.function = SimpleNamespace(power=self.power, is_paired=True)

    def count_within(self, z, left):
        if self.on_path:
            raise RootOnPathError
        return 2 * self.power + sum(self.power for size in self.sizes if log(size) < z) + self.more * (z > 2)


DISC, RING = (Cell(low, 3.0, -pi, pi) for low in (-inf, 0.5))


def proof(domain, found=FOUND, at_zero=(), innermost=0.5, **told):
    winding = Told(**told)
    return Count(winding, 2 * winding.power, (), pi).proof(domain, found, at_zero, innermost)


@pytest.mark.parametrize("power", [1, 2])
def test_roots_at_zero_are_not_counted_in_a_disc_nor_in_a_ring(power):
    assert proof(DISC, power=power) == proof(RING, power=power) == Proof(3, 3)
    assert proof(DISC, at_zero=[root(0, 0)], power=power) == Proof(4, 3)  # one that is a pole is one more
    assert proof(RING, FOUND[:2], power=power) == Proof(3, 2)
    assert not proof(RING, FOUND[:2], power=power).is_complete


def test_a_count_that_is_no_whole_number_of_roots_or_leaves_out_a_part_that_holds_some_proves_nothing():
    unproved = Proof(3, 3, UNPROVED)
    assert proof(DISC, power=2, more=1) == proof(RING, power=2, more=1) == unproved
    assert proof(RING, on_path=True) == proof(DISC, on_path=True) == unproved
    # A root of size sqrt(5) lies within exp(0.9), which was not searched; of a disc nothing is left out.
    assert proof(RING, innermost=0.9) == unproved and proof(DISC, innermost=0.9) == Proof(3, 3)
    assert proof(RING, innermost=None) == Proof(3, 3)


@pytest.mark.parametrize(
    ("is_searched", "is_empty", "missing", "found"),
    [
        (True, True, 0, Proof(3, 3)),
        (True, False, 0, Proof(3, 3, UNPROVED)),
        (False, True, 0, Proof(3, 3, UNPROVED)),
        (True, True, 2, Proof(5, 3, "2 roots were counted but not found")),
    ],
)
def test_cells_that_were_counted_with_proof_are_all_if_the_disc_within_is_empty(
    is_searched, is_empty, missing, found
):
    side = SimpleNamespace(
        _located=FOUND,
        _search=object.__new__(RootSearch) if is_searched else None,
        _count=SimpleNamespace(is_empty_within=lambda _: is_empty),
        _innermost=0.5,
        missing=missing,
    )
    assert Side._subdivided(side) == found
