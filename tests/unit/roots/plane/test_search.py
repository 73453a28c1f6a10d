"""Searches of cells of the plane."""

from dataclasses import dataclass, field

from symflex.roots.counting.winding import Cell
from symflex.roots.functions.entire import Sample
from symflex.roots.plane.search import RootSearch


@dataclass
class Powers:
    """A product of ``z - root`` for each root, in z = ln(s), that counts its samples."""

    roots: tuple[complex, ...]
    power: int = 1
    is_even: bool = False
    samples: list[complex] = field(default_factory=list)

    @property
    def function(self):
        return self

    def sample(self, z):
        self.samples.append(z)
        return Sample(0j, sum(1 / (z - root) for root in self.roots))


def test_steps_between_several_roots_end_where_they_fall_no_more():
    # A step 2/(1/(z - a) + 1/(z - b)) is the harmonic mean of the ways to both roots, and leads to neither.
    winding = Powers((0.3 + 1j, -0.3 + 1j))
    cell = Cell(-0.5, 0.6, 0.5, 1.55)
    assert RootSearch(winding, (), 15)._together(cell, 2) is None
    assert len(winding.samples) < 6
