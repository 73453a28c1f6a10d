"""The proof of a single root, on functions whose roots are known, near the edge of what is true."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

from flint import acb, arb

from symflex.balls import precision
from symflex.roots.plane.local_roots import BOX_SHARE, SMALLER, _box, _is_alone, prove_simple
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


def test_what_symmetry_or_the_caller_says_is_exact():
    function = KnownFunction((((-4, (0, 5), (0, -5)), 1),))
    real, imaginary = (prove_simple(function, near(acb(*place)), 20) for place in ((-4, 0), (0, 5)))
    assert (real.is_real, real.on_imaginary_axis) == (True, False)
    assert (imaginary.is_real, imaginary.on_imaginary_axis) == (False, False)
    even = KnownFunction(((((0, 5), (0, -5)), 1),), is_even=True)
    imaginary = prove_simple(even, near(acb(0, 5)), 20)
    assert (imaginary.is_real, imaginary.on_imaginary_axis, imaginary.re == 0) == (False, True, True)
    for even in [True, False]:
        function = KnownFunction(((((0, 5), (0, -5)), 1),), is_even=not even)
        assert prove_simple(function, near(acb(0, 5)), 20, even=even).on_imaginary_axis is even


def test_a_double_root_is_never_proved_simple_nor_beside_it_one_of_another_factor():
    assert prove_simple(KnownFunction((((1, 1, -3), 1),)), near(acb(1)), 10) is None
    assert prove_simple(KnownFunction((((1, 7), 1), ((1, 1), 1))), near(acb(1)), 10, factor=0) is None


def test_the_same_root_of_two_factors_is_counted_with_both_and_not_certified():
    function = KnownFunction((((1, 7), 2), ((1, -5), 3), ((40,), 1)))
    root = prove_simple(function, near(acb(1)), 10)
    assert (root.certified, root.multiplicity, holds(root, acb(1))) == (False, 5, True)


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


def test_an_image_that_is_no_number_or_only_overlaps_the_box_proves_nothing():
    for image in (
        lambda reach: acb(arb("nan"), 0),
        lambda reach: acb(arb("inf"), 0),
        lambda reach: acb(arb(0, 2 * reach.upper()), 0),
    ):
        assert prove_simple(Told(((((2, 3),), 1),), step=image), acb(2, 3), 5) is None


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


def test_the_factor_asked_for_is_proved_and_no_pole():
    function = KnownFunction((((1,), 2), ((5,), 3)))
    root = prove_simple(function, acb(arb("1.5")), 10, factor=1)
    assert (root.multiplicity, holds(root, acb(5))) == (3, True)
    function = KnownFunction((((3,), 1), (((2, 1),), -1)))
    assert holds(prove_simple(function, acb(2, 1), 10), acb(3))


def test_a_root_is_alone_where_the_series_counts_no_other_within_some_radii():
    for power, exponent, (neighbour, alone) in product(
        [1, 2], [1, 2], [(0.5, False), (0.98, False), (6.0, True), (40.0, True)]
    ):
        radius = ten(-12)
        with precision(8000):
            second = acb(2, 3) + acb(0, 1) * radius * SMALLER * arb(neighbour)
        function = KnownFunction(((((2, 3),), exponent), (((second.real, second.imag),), 1)), power=power)
        assert _is_alone(function, acb(2, 3), radius, exponent, 200) is alone, power


def test_a_root_is_not_alone_where_its_function_cannot_be_bounded():
    @dataclass(frozen=True, eq=False)
    class Branching(KnownFunction):
        def is_analytic_on(self, ball, bits):
            return False

    assert not _is_alone(Branching(((((2, 3),), 1),)), acb(2, 3), ten(-12), 1, 200)


@dataclass(frozen=True, eq=False)
class Watched(KnownFunction):
    """Notes the bits of values and the boxes it is asked for."""

    levels: list = field(default_factory=list)
    boxes: list = field(default_factory=list)

    def enclosed(self, s, bits):
        self.levels.append(bits)
        return super().enclosed(s, bits)

    def enclosed_about(self, ball, centre, bits):
        self.boxes.append((ball, centre))
        return super().enclosed_about(ball, centre, bits)


def test_what_symmetry_proves_to_be_zero_is_zero_whatever_newtons_image_is():
    for off in [(0.25, 0), (0, 0.25), (0.25, -0.25)]:
        imaginary = Told(((((0, 5), (0, -5)), 1),), is_even=True, step=step_of(*off))
        found = prove_simple(imaginary, acb(0, 5), 5)
        assert (bool(found.re == 0), found.on_imaginary_axis, found.is_real) == (True, True, False), off
        real = prove_simple(Told(((((-4, 0),), 1),), step=step_of(*off)), acb(-4), 5)
        assert (bool(real.im == 0), real.on_imaginary_axis, real.is_real) == (True, False, True), off


def test_a_root_is_certified_only_where_both_parts_are_known_to_the_digits_asked_for():
    # Newton's image is half as large as the box, 0.4 of the bits: the first box tells less than that.
    for wide, digits in product(((0, 0.5), (0.5, 0), (0.5, 0.5)), (20, 60)):
        function = Told(
            ((((2, 3), (0, 3), (2, 0)), 1),),
            step=lambda reach, wide=wide: acb(arb(0, reach * wide[0]), arb(0, reach * wide[1])),
        )
        root = prove_simple(function, acb(2, 3), digits)
        assert (root.certified, holds(root, acb(2, 3))) == (True, True), (wide, digits)
        with precision(8000):
            assert root.re.rad() + root.im.rad() <= abs(acb(2, 3)) * ten(-digits), (wide, digits)


def test_factors_that_only_seem_to_vanish_in_a_box_are_cleared_by_the_count_of_the_series():
    def others(reach):
        return [(acb(0), acb(1)), (acb(0), acb(1))]

    function = Told(((((2, 3),), 1), (((20, 3),), 1), (((-2, 30),), 1)), others=others)
    box = _box(function, acb(2, 3), (64, 200), 0, even=False)
    assert box.touching == ()
    root = prove_simple(function, acb(2, 3), 10, factor=0)
    assert (root.certified, root.multiplicity, holds(root, acb(2, 3))) == (True, 1, True)


def test_a_pair_mirrored_in_an_axis_is_told_apart_where_a_box_about_one_leaves_out_the_other():
    for (off, is_told), turned in product([(0.1, False), (0.24, False), (2, True), (3, True)], [True, False]):
        bits = 200
        with precision(8000):
            reach = (arb(5) * arb(2) ** (-BOX_SHARE * bits)).mid()
            one, other = (acb(5, sign * reach * off).mid() for sign in (1, -1))
            if turned:
                one, other = one * acb(0, 1), other * acb(0, 1)
        function = KnownFunction(((((one.real, one.imag), (other.real, other.imag)), 1),), is_even=True)
        box = _box(function, one, (bits, bits), None, even=True)
        assert (box is not None) is is_told, turned
        if box is not None:
            assert acb(box.re, box.im).contains(one), (off, turned)
            assert not acb(box.re, box.im).contains(other), (off, turned)


def test_a_box_about_a_root_said_to_lie_on_an_axis_mirrors_itself():
    for turned in [True, False]:
        # Newton's steps end a tenth of the box off the axis, on which the root is not.
        with precision(8000):
            off = (arb(5) * arb(2) ** (-BOX_SHARE * 200) / 10).mid()
        place = (off, arb(5)) if turned else (arb(5), off)
        function = Watched((((place,), 1),))
        found = _box(function, acb(*place), (200, 200), None, even=True)
        (ball, centre), axis = function.boxes[-1], found.re if turned else found.im
        assert axis == 0, turned
        for each in (ball, centre):
            assert (each.real if turned else each.imag).mid() == 0
