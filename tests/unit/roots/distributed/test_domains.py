"""Domains of the plane by elementary geometry: holes, rings, cells about rectangles, and what lies inside."""

from cmath import exp as cexp
from fractions import Fraction
from math import atan2, hypot, inf, log, pi

import pytest
from flint import arb

from symflex.roots import Band, Modes, Rectangle
from symflex.roots.counting.winding import Cell
from symflex.roots.distributed.proof import (
    NEIGHBOURHOOD,
    WIDER,
    decider,
    holes_about,
    is_whole_ring,
    limits,
    parts,
)
from symflex.roots.root import Root

E = NEIGHBOURHOOD


def root(re, im, size=0.0):
    return Root(arb(re, size), arb(im, size), 1, on_imaginary_axis=re == 0, is_real=im == 0)


def sides(cell):
    return cell.low, cell.high, cell.right, cell.left


def test_holes_that_meet_are_one_that_reaches_as_far_as_both():
    for points, count in [
        ([2, 2 * 1.1], 1),
        ([2, 2 * 1.11], 2),
        ([2, 2 * cexp(0.099j)], 1),
        ([2, 2 * cexp(0.101j)], 2),
        ([2 * cexp(0.099j), 2], 1),
        # the third joins two that do not meet each other
        ([2, 2 * cexp(0.15j), 2 * cexp(0.07j)], 1),
        ([2, 3, 4, 3.05], 3),
    ]:
        assert len(holes_about([complex(p) for p in points])) == count, points
    (hole,) = holes_about([2 * cexp(1j), 2.1 * cexp(0.95j), 1.95 * cexp(1.05j)])
    expected = log(1.95) - E, log(2.1) + E, 0.95 - E, 1.05 + E
    assert sides(hole) == pytest.approx(expected)


RING = Cell(0.0, 2.0, 0.0, pi)


def test_a_ring_goes_all_around():
    for cell, left, is_whole in [
        (RING, pi, True),
        (Cell(0.0, 2.0, 0.0, pi / 2), pi / 2, True),
        (Cell(0.0, 2.0, 0.0, 3.0), pi, False),
        (Cell(0.0, 2.0, 0.1, pi), pi, False),
        (Cell(0.0, 2.0, -1.0, 4.0), pi, True),
    ]:
        assert is_whole_ring(cell, left, ()) is is_whole


def test_the_circles_of_a_ring_pass_by_its_holes():
    for low, high, is_whole in [
        (0.5, 1.0, True),
        (-1.0, -0.5, True),
        (2.5, 3.0, True),
        (1.5, 2.5, False),
        (-0.5, 0.5, False),
        (-1, 3, False),
    ]:
        assert is_whole_ring(RING, pi, (Cell(low, high, 1.0, 1.5),)) is is_whole
        assert is_whole_ring(RING, pi, (Cell(0.5, 1.0, 1.0, 1.5), Cell(low, high, 1.0, 1.5))) is is_whole


def test_a_whole_ring_is_one_cell_with_its_holes_and_their_mirror_images():
    within, real, negative = Cell(0.5, 1.0, 1.0, 1.5), Cell(0.5, 1, -0.1, 0.1), Cell(1.2, 1.3, 3.0, 3.3)
    cells, holes = parts(RING, pi, (within, real, negative, Cell(3.0, 3.5, 1.0, 1.5), Cell(-2.0, -1.0, 1, 2)))
    assert [sides(cell) for cell in cells] == [(0.0, 2.0, -pi, pi)]
    assert {sides(hole) for hole in holes} == {
        (0.5, 1.0, 1.0, 1.5),
        (0.5, 1.0, -1.5, -1.0),
        (0.5, 1, -0.1, 0.1),
        (1.2, 1.3, 3.0, 3.3),
    }


def test_from_a_part_of_a_ring_holes_are_cut_out():
    domain, hole = Cell(0.0, 2.0, 0.5, 2.5), Cell(0.5, 1.0, 1.0, 1.5)
    cells, holes = parts(domain, pi, (hole,))
    assert holes == ()

    def area(cell):
        return (cell.high - cell.low) * (cell.left - cell.right)

    assert sum(map(area, cells)) == pytest.approx(area(domain) - area(hole))
    assert not any(c.low < 0.75 < c.high and c.right < 1.25 < c.left for c in cells)


def test_a_root_is_in_a_ring_by_its_distance_from_0():
    for re, im, size, inside in [
        (3, 0, 0, True), (0, 3, 0, True), (0.9, 0, 0, False), (8, 0, 0, False), (3, 4, 0, True),
        (-3, -0.1, 0, True), (1, 0, 0.01, None), (0, 7.389056, 0.001, None), (0, 1.0000001, 1e-9, True),
        (0, 0.9999999, 1e-9, False),
    ]:  # fmt: skip
        assert decider(Cell(0.0, 2.0, -pi, pi))(root(re, im, size)) is inside


def test_a_root_is_in_a_cell_by_its_argument_too():
    for angle, size, inside in [
        (1.25, 0, True), (0.99, 0, False), (1.51, 0, False), (-1.25, 0, False), (1.0, 0.01, None),
        (1.5, 0.01, None), (1.0000001, 1e-9, True), (0.9999999, 1e-9, False), (1.4999999, 1e-9, True),
        (1.5000001, 1e-9, False), (1.25 - pi, 0, False),
    ]:  # fmt: skip
        z = 2 * cexp(1j * angle)
        is_inside = decider(Cell(0.5, 1.0, 1.0, 1.5))
        assert is_inside(root(z.real, z.imag, size)) is inside
        # However its argument, it is outside where its distance is.
        assert is_inside(root(2 * z.real, 2 * z.imag, size)) is False


def test_a_root_about_the_negative_axis_or_at_0_is_in_the_cell_that_holds_it():
    for angle, inside in [(3.0, True), (-3.0, True), (2.5, False), (-2.5, False)]:
        z = 2 * cexp(1j * angle)
        assert decider(Cell(0.5, 1.0, 2.8, 2 * pi - 2.8))(root(z.real, z.imag)) is inside, angle
    zero = Root(arb(0), arb(0), 2, on_imaginary_axis=True, is_real=True)
    assert decider(Cell(-inf, 1.0, -pi, pi))(zero) is True
    assert decider(Cell(-50.0, 1.0, -pi, pi))(zero) is False


def test_a_band_is_a_ring():
    for is_even in [False, True]:
        low, high, right, left = limits(Band(Fraction(1, 2), 3), is_even=is_even)
        assert (low, high) == pytest.approx((log(pi) - WIDER, log(6 * pi) + WIDER)), is_even
        assert (right, left) == (0.0, pi), is_even
        assert limits(Band(0, 3), is_even=is_even)[0] == -inf


def test_a_rectangle_lies_between_its_nearest_point_and_its_corners():
    for rectangle, nearest, farthest, right, left in [
        # off both axes, above and below
        ((3, 6, 4, 8), hypot(3, 4), 10, atan2(4, 6), atan2(8, 3)),
        ((3, 6, -8, -4), hypot(3, 4), 10, atan2(4, 6), atan2(8, 3)),
        ((-6, -3, 4, 8), hypot(3, 4), 10, atan2(8, -3), atan2(4, -6)),
        # across the real axis, on either side
        ((3, 6, -1, 8), 3, 10, 0.0, atan2(8, 3)),
        ((-6, -3, -8, 2), 3, 10, atan2(8, -3), pi),
        # across the imaginary axis, the far corner on either side
        ((-6, 3, 4, 8), 4, 10, atan2(4, 3), atan2(4, -6)),
        ((-3, 6, 4, 8), 4, 10, atan2(4, 6), atan2(4, -3)),
        # with an edge on an axis
        ((0, 6, 4, 8), 4, 10, atan2(4, 6), pi / 2),
        ((-6, 0, 4, 8), 4, 10, pi / 2, atan2(4, -6)),
        ((3, 6, 0, 8), 3, 10, 0.0, atan2(8, 3)),
        ((3, 6, -8, 0), 3, 10, 0.0, atan2(8, 3)),
    ]:
        found = limits(Rectangle(*map(Fraction, rectangle)), is_even=False)
        assert found == pytest.approx((log(nearest) - WIDER, log(farthest) + WIDER, right, left))
        both = limits(Rectangle(*map(Fraction, rectangle)), is_even=True)
        assert both == pytest.approx((log(nearest) - WIDER, log(farthest) + WIDER, 0.0, pi))


def test_a_rectangle_about_0_is_a_disc_and_numbers_of_modes_have_no_limits():
    found = limits(Rectangle(Fraction(-3), Fraction(1), Fraction(-4), Fraction(2)), is_even=False)
    assert found == pytest.approx((-inf, log(5) + WIDER, 0.0, pi))
    with pytest.raises(TypeError, match="no search for Modes"):
        limits(Modes(3), is_even=True)
