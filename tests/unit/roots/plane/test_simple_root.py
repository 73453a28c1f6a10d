"""The proof of a single root, on functions whose roots are known, near the edge of what is true."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.roots.plane.local_roots import (
    BOX_SHARE,
    SMALLER,
    _is_alone,
    in_disc,
    nearest_factor,
    prove_simple,
    prove_together,
    snapped,
)
from tests.unit.roots.known_functions import KnownFunction


def ten(exponent):
    """Return a power of ten, to far more digits than any test here asks for."""
    with precision(8000):
        return (arb(10) ** exponent).mid()


def near(root, size=1e-9):
    with precision(8000):
        return (root + acb(size, -size / 3)).mid()


def holds(root, exact):
    with precision(8000):
        return bool(root.enclosure().contains(exact))


def test_a_simple_root_is_enclosed_to_the_digits_asked_for():
    for digits, exponent, place in product([3, 50, 400], [1, 3], [(2, 3), (-70000, 1), (0, 5), (-4, 0)]):
        function = KnownFunction((((place, (11, 12), (-9, 8)), exponent),))
        root = prove_simple(function, near(acb(*place)), digits)
        assert root is not None, (digits, exponent, place)
        assert (root.certified, root.multiplicity) == (True, exponent), (digits, place)
        assert holds(root, acb(*place)), (digits, exponent)
        with precision(8000):
            assert root.re.rad() + root.im.rad() <= abs(acb(*place)) * ten(-digits), exponent


def test_a_double_root_is_never_proved_simple_nor_beside_it_one_of_another_factor():
    assert prove_simple(KnownFunction((((1, 1, -3), 1),)), near(acb(1)), 10) is None
    assert prove_simple(KnownFunction((((1, 7), 1), ((1, 1), 1))), near(acb(1)), 10, factor=0) is None


def test_near_double_roots_are_told_apart_and_the_right_one_is_returned():
    for gap, together in product([-13, -25, -60], [True, False]):
        with precision(8000):
            second = acb(1) + acb(0, 1) * ten(gap)
        roots = ((1, 0), (second.real, second.imag))
        function = KnownFunction(((roots, 1),) if together else tuple(((root,), 1) for root in roots))
        for exact, other in ((acb(1), second), (second, acb(1))):
            with precision(8000):
                start = (exact + (exact - other) / 8).mid()
            root = prove_simple(function, start, 10, first_bits=400)
            assert (root.certified, root.multiplicity) == (True, 1), (gap, together)
            assert holds(root, exact), (gap, together)
            assert not holds(root, other), (gap, together)


def test_a_pair_close_beside_an_axis_is_not_put_on_it():
    for is_even in [True, False]:
        with precision(8000):
            off = ten(-30)
        function = KnownFunction(
            (((((off, arb(1))), (-off, arb(1)), (off, arb(-1)), (-off, arb(-1))), 1),), is_even
        )
        root = prove_simple(function, acb(off, 1), 10, first_bits=300)
        assert (root.on_imaginary_axis, bool(root.re > 0), holds(root, acb(off, 1))) == (False, True, True), (
            is_even
        )
    with precision(8000):
        off = ten(-30)
    function = KnownFunction((((((arb(-2), off)), (arb(-2), -off)), 1),))
    root = prove_simple(function, acb(-2, off), 10, first_bits=300)
    assert (root.is_real, bool(root.im > 0), holds(root, acb(-2, off))) == (False, True, True)


@dataclass(frozen=True, eq=False)
class Told(KnownFunction):
    """A function with one root that Newton's method finds, and about a box says what a test lays down.

    Parameters
    ----------
    step : callable
        Of the half side of the box: Newton's step from its middle.
    others : callable
        Of the half side and the bits: further factors there, their value at the middle, their slope.
    """

    step: object = field(default=lambda reach: acb(0))
    others: object = field(default=lambda reach: [])

    def enclosed_about(self, ball, centre, bits):
        # A ball's radius is rounded up; half the side of the box, which the image is compared with, is exact.
        with precision(bits):
            reach = (centre.abs_upper() * arb(2) ** (-BOX_SHARE * bits)).mid()
        found = [(self.step(reach), acb(1), exponent) for _, exponent in self.roots[:1]]
        return found + [(*other, 1) for other in self.others(reach)]


def step_of(re, im):
    def step(reach):
        with precision(8000):
            return acb(arb(re) * reach, arb(im) * reach)

    return step


JUST_INSIDE, JUST_OUTSIDE = 1 - 2.0**-20, 1 + 2.0**-20


def test_newtons_image_has_to_lie_inside_the_box_and_not_touch_its_edge():
    axes = [(1, 0), (-1, 0), (0, 1), (0, -1)]
    near, far = JUST_INSIDE, JUST_OUTSIDE
    inside = [(0, 0), *((re * near, im * near) for re, im in axes), (near, -near)]
    outside = [*axes, *((re * far, im * far) for re, im in axes), (near, far), (far, near)]
    for re, im in (*inside, *outside):
        function = Told(((((2, 3),), 1),), step=step_of(re, im))
        assert (prove_simple(function, acb(2, 3), 5) is not None) is ((re, im) in inside), (re, im)


def test_another_factor_is_off_the_box_only_where_it_outweighs_its_slope_to_the_farthest_corner():
    # The corners of the box are sqrt(2) times half its side away from the middle.
    def others(reach, distance):
        with precision(8000):
            corner = (arb(2).sqrt() * reach * arb(distance)).mid()
        return [(acb(-corner), acb(1))]

    for distance, certified in ((0.99, False), (1.0, False), (1.01, True)):
        function = Told(
            ((((2, 3),), 1), (((2, 3),), 1)), others=lambda reach, share=distance: others(reach, share)
        )
        root = prove_simple(function, acb(2, 3), 5, factor=0)
        assert (root is not None and root.certified) is certified, distance


def test_a_root_is_alone_where_the_series_counts_no_other_within_some_radii():
    for power, exponent, (neighbour, alone) in product(
        [1, 2], [1, 2], [(0.5, False), (0.98, False), (6.0, True), (40.0, True)]
    ):
        radius = ten(-12)
        with precision(8000):
            second = acb(2, 3) + acb(0, 1) * radius * SMALLER * arb(neighbour)
        function = KnownFunction(((((2, 3),), exponent), (((second.real, second.imag),), 1)), power=power)
        assert _is_alone(function, acb(2, 3), radius, exponent, 200) is alone, power


def test_the_factor_that_vanishes_nearest_by_newtons_estimate_is_chosen():
    one = acb(1)
    assert nearest_factor([(acb(3), one, 1), (acb(2), one, 1), (acb(6), acb(2), 1)]) == 1
    assert nearest_factor([(acb(3), one, 1), (acb(2), acb(0.5), 1), (acb(6), acb(4), 2)]) == 2
    # What stands below, or does not change, has no root; where a factor is 0 it is the nearest.
    assert nearest_factor([(acb(3), one, 1), (acb(1), one, -1), (acb(1), acb(0), 1)]) == 0
    assert nearest_factor([(acb(1), one, 1), (acb(0), one, 1)]) == 1


def together(roots, count, *, within=1e-4, digits=12, exponent=1, power=1, even=False, place=(2, 3)):
    function = KnownFunction(((tuple(roots), exponent),), power=power)
    start = (acb(*place) + acb(1e-14, 1e-14)).mid()
    return prove_together(function, start, arb(within).mid(), digits, count, even=even)


def test_roots_close_together_are_one_of_their_number_in_a_disc_of_the_digits_asked_for():
    exact = acb(2, 3)
    for exponent, power in product([1, 2], [1, 2]):
        root = together([(2, 3), (2, 3)], 2 * exponent * power, exponent=exponent, power=power)
        assert (root.multiplicity, root.certified) == (2 * exponent, False)
        assert holds(root, exact) and root.re.rad() <= abs(exact) * 1.01e-12
    single = together([(2, 3)], 1)
    assert (single.multiplicity, single.certified, single.is_real) == (1, True, False) and holds(
        single, exact
    )
    assert together([(2, 3), (2, 3)], 1) is together([(2, 3), (2, 3)], 3) is None


def test_a_disc_grows_over_roots_that_are_apart_and_stays_below_its_bound():
    # Two roots 2e-9 apart: a disc of 1e-12 times the size holds neither or one, one of 1e-8 times it both.
    roots = [(arb(2), arb(3) + arb(1e-9).mid()), (arb(2), arb(3) - arb(1e-9).mid())]
    root = together(roots, 2)
    assert root.multiplicity == 2 and all(holds(root, acb(*each)) for each in roots)
    assert 1e-9 < root.re.rad() < 1e-6
    assert together(roots, 2, within=1e-10) is None


def test_a_disc_about_a_pair_beside_an_axis_is_put_on_it():
    off = arb(1e-9).mid()
    pair = [(off, arb(2)), (-off, arb(2))]
    root = together(pair, 2, even=True, place=(2e-9, 2))
    assert root.multiplicity == 2 and root.re.mid() == 0 and not root.on_imaginary_axis
    assert all(holds(root, acb(*each)) for each in pair)


@pytest.mark.parametrize("apart", [50, 99, 101, 5000])
def test_a_disc_shrinks_until_no_other_root_is_next_to_it(apart):
    size = abs(acb(2, 3)) * arb(10) ** -12
    with precision(300):
        other = (arb(2) + size * apart).mid()
    root = together([(2, 3), (2, 3), (other, arb(3))], 2)
    assert root.multiplicity == 2 and holds(root, acb(2, 3))
    with precision(300):
        assert root.re.rad() * 100 < abs(other - root.re.mid())


def test_roots_are_put_on_an_axis_only_where_they_are_closer_to_it_than_a_distance():
    close = arb(2) ** -10
    beside, near = close, (close - close / 2**20)
    for s, even, real, found in (
        (acb(near, 1), True, True, (0, 1)),
        (acb(-near, 1), True, True, (0, 1)),
        (acb(beside, 1), True, True, (beside, 1)),
        (acb(near, 1), False, True, (near, 1)),
        (acb(1, near), False, True, (1, 0)),
        (acb(1, beside), True, True, (1, beside)),
        (acb(1, near), True, False, (1, near)),
    ):
        assert snapped(s, close, even=even, real=real) == acb(*found)


@pytest.mark.parametrize(
    ("centre", "multiplicity", "even", "real", "on_axis", "is_real"),
    [
        ((0, 2), 1, True, True, True, False),
        ((0, 2), 1, False, True, False, False),
        ((0, 2), 2, True, True, False, False),  # perhaps a pair beside the axis
        ((-2, 0), 1, False, True, False, True),
        ((-2, 0), 1, False, False, False, False),
        ((-2, 0), 2, True, True, False, False),
        ((1, 2), 1, True, True, False, False),
    ],
)
def test_one_root_alone_in_a_disc_about_a_point_of_an_axis_lies_on_it(
    centre, multiplicity, even, real, on_axis, is_real
):
    size = arb(2) ** -30
    root = in_disc(acb(*centre), size, multiplicity, even=even, real=real)
    assert (root.on_imaginary_axis, root.is_real, root.certified) == (on_axis, is_real, multiplicity == 1)
    assert (root.re == 0, root.im == 0) == (on_axis, is_real)
    assert on_axis or root.re.rad() >= size
    assert is_real or root.im.rad() >= size
