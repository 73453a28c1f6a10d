"""Each step of the search of one side, with searches and counts that answer what is known."""

from math import inf, pi

import pytest

from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.distributed import proof
from tests.unit.roots.distributed_models import DELAY_LOOP
from tests.unit.roots.stand_ins import side

# ------------------------------------------------ regions


class Circle:
    """Counts so many about 0, up to any radius."""

    def __init__(self, count=0, smallest=-2.0):
        self.answer, self.lowest, self.asked = count, smallest, []

    def smallest(self, left, holes):
        self.asked.append((left, holes))
        return self.lowest

    def count_within(self, z, left):
        self.asked.append((z, left))
        if self.answer is None:
            raise RootOnPathError
        return self.answer


def many(one, count=1000, smallest=-2.0):
    one._winding, one._lossless = Circle(count, smallest), None
    return one._winding


# ------------------------------------------------ numbers and proofs


class Right(Circle):
    """Counts of the right half plane; the first is of the disc about 0."""

    def __init__(self, within, right, smallest=-2.0):
        super().__init__(within, smallest)
        self.right, self.rings = right, []

    def count(self, cell):
        return self.right

    def count_right(self, low, high, angle):
        self.rings.append((low, high))
        return self.right


def test_the_right_half_plane_is_counted_between_two_half_circles(monkeypatch):
    for within, right, power, smallest, count in (
        (0, 4, 1, -2.0, 4),
        (0, 4, 2, -2.0, 2),
        (0, 3, 2, -2.0, None),
        (1, 4, 1, -2.0, None),
        (0, 4, 1, 5.0, 4),
    ):
        one, used = side(DELAY_LOOP), Right(within, right, smallest)
        used.function = one.function
        monkeypatch.setattr(proof, "CertifiedWinding", lambda *given, tries_series, used=used: used)
        one.function.power, one._order = power, 0
        if count is None:
            with pytest.raises(RootOnPathError):
                one.count_right(3.0)
            continue
        assert one.count_right(3.0) == count
        low = min(smallest, 2.0)
        assert used.rings == [(low, 3.0)]
        assert used.asked == [(pi, one.holes), (low, pi)]


def test_a_ring_holds_what_its_outer_circle_does_but_for_its_inner_circle_and_holes(monkeypatch):
    monkeypatch.setattr(proof, "is_whole_ring", lambda *given: True)
    monkeypatch.setattr(proof.Count, "within", lambda self, z: {(5.0, 1.5): 20, (1.0, 1.5): 6}[z, self.left])
    count = proof.Count(Right(0, 3), 0, (), 1.5)
    cells = [Cell(2, 3, 0, 1), Cell(3, 4, 0, 1)]
    monkeypatch.setattr(proof, "parts", lambda *given: ([], cells))
    assert count.turns(Cell(1.0, 5.0, 0.0, pi)) == 20 - 6 - 2 * 3
    monkeypatch.setattr(proof, "parts", lambda *given: ([], []))
    assert count.turns(Cell(-inf, 5.0, 0.0, pi)) == 20
    monkeypatch.setattr(proof, "is_whole_ring", lambda *given: False)
    monkeypatch.setattr(proof, "parts", lambda *given: (cells, []))
    assert count.turns(Cell(1.0, 5.0, 0.0, pi)) == 2 * 3


def test_without_losses_roots_within_a_circle_are_counted_along_the_axis():
    class Counts:
        def count(self, z):
            return 5 if z == 1.5 else 0

    circle = Circle(9)
    assert proof.Count(circle, 2, (), pi, Counts()).within(1.5) == 7
    assert proof.Count(circle, 2, (), 0.7).within(1.5) == 9
    assert circle.asked == [(1.5, 0.7)]
