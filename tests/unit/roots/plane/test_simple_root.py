"""The proof of a single root, on functions whose roots are known, near the edge of what is true."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import pytest
from flint import acb, arb

from symflex.roots import precision
from symflex.roots.plane.local_roots import (
    BOX_SHARE,
    LEAST_BITS,
    PATIENCE,
    SMALLER,
    Box,
    _box,
    _is_alone,
    nearest_factor,
    prove_simple,
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


@pytest.mark.parametrize("digits", [3, 15, 50, 400])
@pytest.mark.parametrize("exponent", [1, 3])
@pytest.mark.parametrize("place", [(2, 3), (-70000, 1), (0, 5), (-4, 0)])
def test_a_simple_root_is_enclosed_to_the_digits_asked_for(place, exponent, digits):
    function = KnownFunction((((place, (11, 12), (-9, 8)), exponent),))
    root = prove_simple(function, near(acb(*place)), digits)
    assert root is not None
    assert (root.certified, root.multiplicity) == (True, exponent)
    assert holds(root, acb(*place))
    with precision(8000):
        assert root.re.rad() + root.im.rad() <= abs(acb(*place)) * ten(-digits)


def test_exact_zeros_are_claimed_only_by_symmetry():
    function = KnownFunction((((-4, (0, 5), (0, -5)), 1),))
    real, imaginary = (prove_simple(function, near(acb(*place)), 20) for place in ((-4, 0), (0, 5)))
    assert (real.is_real, real.on_imaginary_axis) == (True, False)
    assert (imaginary.is_real, imaginary.on_imaginary_axis) == (False, False)
    even = KnownFunction(((((0, 5), (0, -5)), 1),), is_even=True)
    imaginary = prove_simple(even, near(acb(0, 5)), 20)
    assert (imaginary.is_real, imaginary.on_imaginary_axis, imaginary.re == 0) == (False, True, True)


@pytest.mark.parametrize("even", [True, False])
def test_what_the_caller_says_of_symmetry_goes_before_what_the_function_claims(even):
    function = KnownFunction(((((0, 5), (0, -5)), 1),), is_even=not even)
    assert prove_simple(function, near(acb(0, 5)), 20, even=even).on_imaginary_axis is even


def test_a_double_root_is_never_proved_simple():
    assert prove_simple(KnownFunction((((1, 1, -3), 1),)), near(acb(1)), 10) is None


def test_the_same_root_of_two_factors_is_counted_with_both_and_not_certified():
    function = KnownFunction((((1, 7), 2), ((1, -5), 3), ((40,), 1)))
    root = prove_simple(function, near(acb(1)), 10)
    assert (root.certified, root.multiplicity, holds(root, acb(1))) == (False, 5, True)


def test_a_double_root_of_another_factor_in_the_box_leaves_nothing_proved():
    assert prove_simple(KnownFunction((((1, 7), 1), ((1, 1), 1))), near(acb(1)), 10, factor=0) is None


@pytest.mark.parametrize("gap", [-13, -25, -60])
@pytest.mark.parametrize("together", [True, False], ids=["one factor", "two factors"])
def test_near_double_roots_are_told_apart_and_the_right_one_is_returned(gap, together):
    with precision(8000):
        second = acb(1) + acb(0, 1) * ten(gap)
    roots = ((1, 0), (second.real, second.imag))
    function = KnownFunction(((roots, 1),) if together else tuple(((root,), 1) for root in roots))
    for exact, other in ((acb(1), second), (second, acb(1))):
        with precision(8000):
            start = (exact + (exact - other) / 8).mid()
        root = prove_simple(function, start, 10, first_bits=400)
        assert (root.certified, root.multiplicity) == (True, 1)
        assert holds(root, exact)
        assert not holds(root, other)


@pytest.mark.parametrize("is_even", [True, False])
def test_a_pair_close_beside_the_imaginary_axis_is_not_put_on_it(is_even):
    with precision(8000):
        off = ten(-30)
    function = KnownFunction(
        (((((off, arb(1))), (-off, arb(1)), (off, arb(-1)), (-off, arb(-1))), 1),), is_even
    )
    root = prove_simple(function, acb(off, 1), 10, first_bits=300)
    assert (root.on_imaginary_axis, bool(root.re > 0), holds(root, acb(off, 1))) == (False, True, True)


def test_a_pair_close_beside_the_real_axis_is_not_called_real():
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


@pytest.mark.parametrize(
    ("re", "im", "proved"),
    [
        (0, 0, True),
        (JUST_INSIDE, 0, True),
        (-JUST_INSIDE, 0, True),
        (0, JUST_INSIDE, True),
        (0, -JUST_INSIDE, True),
        (JUST_INSIDE, -JUST_INSIDE, True),
        (1, 0, False),
        (-1, 0, False),
        (0, 1, False),
        (0, -1, False),
        (JUST_OUTSIDE, 0, False),
        (-JUST_OUTSIDE, 0, False),
        (0, JUST_OUTSIDE, False),
        (0, -JUST_OUTSIDE, False),
        (JUST_INSIDE, JUST_OUTSIDE, False),
        (JUST_OUTSIDE, JUST_INSIDE, False),
    ],
)
def test_newtons_image_has_to_lie_inside_the_box_and_not_touch_its_edge(re, im, proved):
    function = Told(((((2, 3),), 1),), step=step_of(re, im))
    assert (prove_simple(function, acb(2, 3), 5) is not None) is proved


@pytest.mark.parametrize("re", [arb("nan"), arb("inf")])
def test_an_image_that_is_no_number_proves_nothing(re):
    assert prove_simple(Told(((((2, 3),), 1),), step=lambda reach: acb(re, 0)), acb(2, 3), 5) is None


def test_an_image_that_only_overlaps_the_box_proves_nothing():
    def step(reach):
        return acb(arb(0, 2 * reach.upper()), 0)

    assert prove_simple(Told(((((2, 3),), 1),), step=step), acb(2, 3), 5) is None


@pytest.mark.parametrize(("distance", "certified"), [(0.99, False), (1.0, False), (1.01, True)])
def test_another_factor_is_off_the_box_only_where_it_outweighs_its_slope_to_the_farthest_corner(
    distance, certified
):
    # The corners of the box are sqrt(2) times half its side away from the middle.
    def others(reach):
        with precision(8000):
            corner = (arb(2).sqrt() * reach * arb(distance)).mid()
        return [(acb(-corner), acb(1))]

    function = Told(((((2, 3),), 1), (((2, 3),), 1)), others=others)
    root = prove_simple(function, acb(2, 3), 5, factor=0)
    assert (root is not None and root.certified) is certified


def test_the_box_is_drawn_at_the_share_of_the_bits_that_the_module_says():
    seen = []

    def step(reach):
        seen.append(float(reach))
        return acb(0)

    prove_simple(Told(((((2, 3),), 1),), step=step), acb(2, 3), 1)
    assert seen[0] == pytest.approx(abs(2 + 3j) * 2 ** (-BOX_SHARE * LEAST_BITS), rel=1e-6)


def test_the_nearest_factor_is_that_of_the_smallest_newton_step():
    ball = acb
    factors = [(ball(4), ball(2), 1), (ball(3), ball(3), 2), (ball(1), ball(0), 1), (ball(1), ball(9), -1)]
    assert nearest_factor(factors) == 1
    assert nearest_factor([*factors, (ball(0), ball(1), 1)]) == 4
    assert nearest_factor([(ball(1), ball(0), 1)]) == 0


def test_the_factor_asked_for_is_the_one_that_is_proved():
    function = KnownFunction((((1,), 2), ((5,), 3)))
    root = prove_simple(function, acb(arb("1.5")), 10, factor=1)
    assert (root.multiplicity, holds(root, acb(5))) == (3, True)


def test_a_pole_of_the_function_is_no_root():
    function = KnownFunction((((3,), 1), (((2, 1),), -1)))
    assert holds(prove_simple(function, acb(2, 1), 10), acb(3))


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("exponent", [1, 2])
@pytest.mark.parametrize(("neighbour", "alone"), [(0.5, False), (0.98, False), (6.0, True), (40.0, True)])
def test_a_root_is_alone_where_the_series_counts_no_other_within_some_radii(
    neighbour, alone, exponent, power
):
    radius = ten(-12)
    with precision(8000):
        second = acb(2, 3) + acb(0, 1) * radius * SMALLER * arb(neighbour)
    function = KnownFunction(((((2, 3),), exponent), (((second.real, second.imag),), 1)), power=power)
    assert _is_alone(function, acb(2, 3), radius, exponent, 200) is alone


def test_a_root_is_not_alone_where_its_function_cannot_be_bounded():
    @dataclass(frozen=True, eq=False)
    class Branching(KnownFunction):
        def is_analytic_on(self, ball, bits):
            return False

    assert not _is_alone(Branching(((((2, 3),), 1),)), acb(2, 3), ten(-12), 1, 200)


def test_a_box_keeps_the_size_in_which_it_proved_its_root_to_be_the_only_one():
    bits = 200
    box = _box(KnownFunction(((((2, 3),), 1),)), acb(2, 3), (64, bits), None, even=False)
    assert isinstance(box, Box)
    assert float(box.reach) == pytest.approx(abs(2 + 3j) * 2 ** (-BOX_SHARE * bits), rel=1e-9)
    assert box.touching == ()


@pytest.mark.parametrize("place", [(2, 3), (-4, 0), (0, 5)])
@pytest.mark.parametrize("digits", [1, 20, 100])
def test_the_first_precision_suffices_for_the_digits_asked_for(digits, place):
    # One box is drawn: Newton's image is small enough the first time.
    boxes = []

    class Counted(KnownFunction):
        def enclosed_about(self, ball, centre, bits):
            boxes.append(bits)
            return super().enclosed_about(ball, centre, bits)

    prove_simple(Counted((((place, (11, 1)), 1),)), near(acb(*place)), digits)
    assert len(boxes) == 1


@pytest.mark.parametrize("first_bits", [64, 128, 500])
def test_newtons_steps_begin_with_the_bits_asked_for(first_bits):
    levels = []

    class Watched(KnownFunction):
        def enclosed(self, s, bits):
            levels.append(bits)
            return super().enclosed(s, bits)

    prove_simple(Watched(((((2, 3),), 1),)), near(acb(2, 3)), 100, first_bits=first_bits)
    assert levels[0] == first_bits
    assert all(later <= 2 * earlier for earlier, later in pairwise(levels))


@pytest.mark.parametrize("off", [(0.25, 0), (0, 0.25), (0.25, -0.25)])
def test_what_symmetry_proves_to_be_zero_is_zero_whatever_newtons_image_is(off):
    imaginary = Told(((((0, 5), (0, -5)), 1),), is_even=True, step=step_of(*off))
    found = prove_simple(imaginary, acb(0, 5), 5)
    assert (bool(found.re == 0), found.on_imaginary_axis, found.is_real) == (True, True, False)
    real = prove_simple(Told(((((-4, 0),), 1),), step=step_of(*off)), acb(-4), 5)
    assert (bool(real.im == 0), real.on_imaginary_axis, real.is_real) == (True, False, True)


@pytest.mark.parametrize("wide", [(0, 0.5), (0.5, 0), (0.5, 0.5)])
@pytest.mark.parametrize("digits", [20, 60])
def test_a_root_is_certified_only_where_both_parts_are_known_to_the_digits_asked_for(wide, digits):
    # Newton's image is half as large as the box, 0.4 of the bits: the first box tells less than that.
    def step(reach):
        return acb(arb(0, reach * wide[0]), arb(0, reach * wide[1]))

    function = Told(((((2, 3), (0, 3), (2, 0)), 1),), step=step)
    root = prove_simple(function, acb(2, 3), digits)
    assert (root.certified, holds(root, acb(2, 3))) == (True, True)
    with precision(8000):
        assert root.re.rad() + root.im.rad() <= abs(acb(2, 3)) * ten(-digits)


def test_factors_that_only_seem_to_vanish_in_a_box_are_cleared_by_the_count_of_the_series():
    def others(reach):
        return [(acb(0), acb(1)), (acb(0), acb(1))]

    function = Told(((((2, 3),), 1), (((20, 3),), 1), (((-2, 30),), 1)), others=others)
    box = _box(function, acb(2, 3), (64, 200), 0, even=False)
    assert box.touching == ()
    root = prove_simple(function, acb(2, 3), 10, factor=0)
    assert (root.certified, root.multiplicity, holds(root, acb(2, 3))) == (True, 1, True)


@pytest.mark.parametrize(("off", "is_told"), [(0.1, False), (0.24, False), (2, True), (3, True)])
@pytest.mark.parametrize("turned", [True, False])
def test_a_pair_mirrored_in_an_axis_is_told_apart_where_a_box_about_one_leaves_out_the_other(
    off, is_told, turned
):
    bits = 200
    with precision(8000):
        reach = (arb(5) * arb(2) ** (-BOX_SHARE * bits)).mid()
        one, other = (acb(5, sign * reach * off).mid() for sign in (1, -1))
        if turned:
            one, other = one * acb(0, 1), other * acb(0, 1)
    function = KnownFunction(((((one.real, one.imag), (other.real, other.imag)), 1),), is_even=True)
    box = _box(function, one, (bits, bits), None, even=True)
    assert (box is not None) is is_told
    if box is not None:
        assert acb(box.re, box.im).contains(one)
        assert not acb(box.re, box.im).contains(other)


@pytest.mark.parametrize("turned", [True, False])
def test_a_box_about_a_root_said_to_lie_on_an_axis_mirrors_itself(turned):
    boxes = []

    class Watched(KnownFunction):
        def enclosed_about(self, ball, centre, bits):
            boxes.append((ball, centre))
            return super().enclosed_about(ball, centre, bits)

    # Newton's steps end a tenth of the box off the axis, on which the root is not.
    with precision(8000):
        off = (arb(5) * arb(2) ** (-BOX_SHARE * 200) / 10).mid()
    place = (off, arb(5)) if turned else (arb(5), off)
    found = _box(Watched((((place,), 1),)), acb(*place), (200, 200), None, even=True)
    (ball, centre), axis = boxes[-1], found.re if turned else found.im
    assert axis == 0
    for each in (ball, centre):
        assert (each.real if turned else each.imag).mid() == 0


def test_where_a_step_says_nothing_at_few_bits_more_are_taken():
    class Unknown(KnownFunction):
        def enclosed(self, s, bits):
            return [(v, acb(0) if bits < 90 else d, e) for v, d, e in super().enclosed(s, bits)]

    root = prove_simple(Unknown(((((2, 3),), 1),)), near(acb(2, 3)), 10)
    assert (root.certified, holds(root, acb(2, 3))) == (True, True)


def test_steps_of_unknown_sign_ask_for_more_digits():
    class Blurred(KnownFunction):
        def enclosed(self, s, bits):
            blur = acb(arb(0, 1e-9), arb(0, 1e-9)) if bits < 120 else acb(0)
            return [(v + blur, d, e) for v, d, e in super().enclosed(s, bits)]

    root = prove_simple(Blurred(((((2, 3),), 1),)), near(acb(2, 3)), 10)
    assert (root.certified, holds(root, acb(2, 3))) == (True, True)


def test_steps_that_converge_like_those_to_a_double_root_are_given_up():
    # One bit a step: some twenty at the first precision, and no more than the patience at the next one.
    steps = []

    class Counted(KnownFunction):
        def enclosed(self, s, bits):
            steps.append(bits)
            return super().enclosed(s, bits)

    assert prove_simple(Counted((((1, 1, -3), 1),)), acb(arb("1.125")), 10) is None
    assert len(steps) < 30 + PATIENCE
