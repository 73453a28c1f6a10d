"""Searching the plane for roots of polynomials that are known: close, multiple, on axes and beside holes."""

from itertools import pairwise
from math import inf, log, pi

import pytest
from flint import acb, arb

from symflex.algebra import Factored
from symflex.balls import precision
from symflex.budget import Budget
from symflex.errors import BudgetError
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import Cell, RootOnPathError, Winding
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.plane.search import RootSearch
from tests.unit.roots.distributed_models import DELAY_LOOP, bound

DIGITS = 15


class Told:
    """Remembers what progress was reported."""

    def __init__(self):
        self.said = []

    def report(self, done, text):
        self.said.append((done, text))


def search(make, holes=(), kind=Winding):
    """Return a search of a product of polynomials in s, each given with its exponent."""
    source = bound(DELAY_LOOP)
    ring = source.ratio.ring
    part = Factored.number(ring, 1)
    for polynomial, exponent in make(ring.context.gen(0)):
        part = part * Factored.polynomial(ring, polynomial) ** exponent
    function = KernelFunction(source, part)
    return RootSearch(kind(function), holes, DIGITS)


def mixed(s):
    # -1 +- 2j, -3, 4, -1/2 +- j/2
    return [(s**2 + 2 * s + 5, 1), (s + 3, 1), (s - 4, 1), (2 * s**2 + 2 * s + 1, 1)]


MIXED = [-0.5 + 0.5j, -1 + 2j, -3, 4]


def even(s):
    # +-2j, +-3, and the four of s^4 + 64: +-2 +- 2j
    return [(s**2 + 4, 1), (s**2 - 9, 1), (s**4 + 64, 1)]


EVEN = [2j, 2 + 2j, 3]


def values(roots):
    found = [complex(float(r.re.mid()), float(r.im.mid())) for r in roots]
    return sorted(found, key=lambda s: (round(abs(s), 6), s.real))


def test_a_ring_holds_all_roots_in_the_upper_half_plane():
    for make, roots, kind in (
        (mixed, MIXED, Winding),
        (mixed, MIXED, CertifiedWinding),
        (even, EVEN, Winding),
    ):
        found = search(make, kind=kind).ring(log(0.1), log(10))
        assert values(found.roots) == pytest.approx(
            sorted(roots, key=lambda s: (round(abs(s), 6), complex(s).real))
        )
        assert found.missing == 0, kind
        assert all(root.certified and root.multiplicity == 1 for root in found.roots), kind


def test_a_ring_whose_border_meets_roots_is_widened_on_all_sides_each_time():
    one, cells = search(mixed), []

    def refused(cell):
        cells.append(cell)
        raise RootOnPathError

    one._search = refused
    assert one.ring(0.0, 1.0, 0.2, 1.0).missing == 1
    for inner, outer in pairwise(cells):
        assert outer.low < inner.low < inner.high < outer.high
        assert outer.right < inner.right < inner.left < outer.left


def test_of_an_even_function_a_quarter_is_searched_and_roots_next_to_the_axis_lie_on_it():
    for other, on_axis in [(lambda s: s**4 + 2, True), (lambda s: s + 1, False)]:
        # j sqrt(10), of which no box about it tells more than that it is close to the axis.
        found = search(lambda s, other=other: [(s**2 + 10, 1), (other(s), 1)]).ring(log(0.1), log(10))
        (root,) = (root for root in found.roots if root.im > 3)
        assert root.on_imaginary_axis is bool(root.re == 0) is on_axis, other
        assert root.re.contains(0), other
    one = search(even)
    assert (one.is_even, one.left) == (True, pi / 2)
    assert one.ring(log(0.1), log(10)).cell.left < 2
    other = search(mixed)
    assert (other.is_even, other.left) == (False, pi)


@pytest.mark.parametrize(("apart", "alone"), [(10**3, True), (10**9, True), (10**14, False), (10**25, False)])
def test_two_roots_are_told_apart_by_cuts_and_left_as_one_where_cells_would_be_too_small(apart, alone):
    # 2 + 1/apart, and 2; and beside them one at -5
    found = search(close(apart)).ring(log(0.1), log(10))
    assert found.missing == 0
    with precision(400):
        expected = (arb(2), 2 + arb(1) / apart, arb(-5))
    assert contained(found.roots, *expected) == [1, 1, 1]
    assert sorted(root.multiplicity for root in found.roots) == ([1, 1, 1] if alone else [1, 2])
    assert all(root.certified is (root.multiplicity == 1) for root in found.roots)


def test_a_root_that_two_factors_share_is_one_of_two_that_are_not_told_apart():
    found = search(shared).ring(log(0.1), log(10))
    both = [root for root in found.roots if root.re.contains(2)]
    assert sum(root.multiplicity for root in both) == 2
    assert not any(root.certified for root in both if root.multiplicity == 2)
    assert found.missing == 0
    assert sum(root.multiplicity for root in found.roots) == 4


def test_modes_located_are_reported_and_a_scan_for_more_than_there_are_ends():
    told = Told()
    with Budget(progress=told).entered():
        search(even).extend(3)
    assert told.said
    assert all(text == f"{round(3 * done)} of 3 modes located" for done, text in told.said)
    told = Told()
    one = search(lambda s: [(4 * s**2 + 25, 1)])
    with Budget(progress=told).entered():
        assert one.scan(2, -inf, lambda: True) is True
    assert one.reached == inf
    assert {text for _, text in told.said} == {"0 of 2 modes located", "1 of 2 modes located"}


def test_a_scan_says_whether_these_are_all():
    for complete in [True, False]:
        assert search(even).scan(1, log(9), lambda complete=complete: complete) is complete


def test_a_scan_along_axes_without_roots_ends_soon():
    # The roots of s^4 + 64 are +-2 +- 2j: none lies on an axis.
    one = search(lambda s: [(s**4 + 64, 1)])
    asked = []
    assert one.scan(1, -inf, lambda: bool(asked.append(one.reached))) is False
    assert len(asked) == 1
    assert log(8) < asked[0] < log(100)


HOLE = Cell(log(2) - 0.05, log(2) + 0.3, 1.8, 2.3)
"""About -1 + 2j, at ln 2.236 and 2.03 rad."""


def test_what_lies_in_a_hole_is_left_out_and_said():
    one = search(mixed, holes=(HOLE, Cell(log(50), log(60), 1.0, 2.0)))
    found = one.ring(log(0.1), log(10))
    assert values(found.roots) == pytest.approx(sorted((s for s in MIXED if s != -1 + 2j), key=abs))
    assert one.excluded == {HOLE}


def test_circles_pass_by_one_hole_and_the_next():
    for radius, passed in [
        (HOLE.low - 0.5, None),
        (HOLE.low - 0.1, HOLE.high + 0.03),
        (HOLE.high, HOLE.high + 0.03),
        (HOLE.high + 0.1, None),
    ]:
        assert search(mixed, holes=(HOLE,)).passing(radius) == pytest.approx(passed or radius)
    other = Cell(HOLE.high + 0.1, HOLE.high + 0.4, 0.5, 1.0)
    for holes in ((HOLE, other), (other, HOLE)):
        assert search(mixed, holes=holes).passing(HOLE.low) == pytest.approx(other.high + 0.03)


def test_where_no_circle_passes_it_is_said_where():
    class Blocked(Winding):
        def count(self, cell):
            raise RootOnPathError

    one = search(mixed, kind=Winding)
    one._winding = Blocked(one.function)
    with pytest.raises(BudgetError, match=r"SF505.*: roots do not separate near 2 rad/s") as failed:
        one._ring(log(1), log(2))
    assert failed.value.diagnostics[0].hint == "ask for a band that ends elsewhere"
    # A ring that was asked for has one that was not found.
    found = one.ring(log(1), log(2))
    assert (found.roots, found.missing, found.cell) == ((), 1, None)


# ----------------------------------------------------------------- roots that cuts do not tell apart, by hand


def cell_about(place, size):
    z = log(place)
    return Cell(z - size / 2, z + size / 2, -size / 2, size / 2)


def shared(s):
    # 2 is a root of both factors, and no other is near.
    return [(s - 2, 1), (s**2 - 4, 1), (s**2 + s + 9, 1)]


def close(apart):
    return lambda s: [((apart * s - 2 * apart - 1) * (s - 2), 1), (s + 5, 1)]


def contained(roots, *expected):
    with precision(600):
        return [sum(bool(root.enclosure().contains(acb(value))) for root in roots) for value in expected]


def test_a_cell_with_fewer_roots_than_none_has_lost_some():
    for count, power, lost in [(-2, 1, 2), (-4, 2, 2), (-1, 2, 1)]:
        # Where poles lie, which an entire function has not.
        one = search(mixed)
        one.function.power = power
        assert one._separate(cell_about(4, 0.1), count) == ([], lost)
