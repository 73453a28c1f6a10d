"""One root: frequency and damping, mirror images, decimals with a rigorous radius, and precision."""

from fractions import Fraction
from math import hypot, pi

import flint
import hypothesis
import pytest
from flint import arb, fmpz_poly
from hypothesis import strategies as st

from symflex.balls import precision
from symflex.roots import Root, find_polynomial_roots
from symflex.roots.root import decimals, exact_fraction, mirror_images, overlap
from tests.unit.roots.root_problems import problem, problem_of
from tests.unit.roots.stand_ins import root


def test_a_root_has_a_frequency_and_a_damping_ratio():
    for given, hertz, zeta in [
        (root(-3, 4), 5 / (2 * pi), 0.6),
        (root(3, -4), 5 / (2 * pi), -0.6),
        (root(0, -7), 7 / (2 * pi), 0.0),
        (root(-2, 0), 1 / pi, 1.0),
        (root(3, 0), 1.5 / pi, -1.0),
        (root(0, 0), 0.0, None),
        # not told from the axis, and not told from 0
        (root(0, 7, size=0.5), 7 / (2 * pi), 0.0),
        (root(0, 0, size=0.5), 0.0, None),
    ]:
        assert given.frequency_hz() == pytest.approx(hertz, abs=0.3 if given.re.rad() else 1e-15)
        assert given.damping_ratio() == (zeta if zeta is None else pytest.approx(zeta))


def test_a_frequency_is_known_as_well_as_both_parts():
    with precision(600):
        third = arb(1) / 3
        for re, im in ((third, arb(1)), (arb(1), third), (third, third)):
            found = Root(re, im, 1, on_imaginary_axis=False, is_real=False).natural_frequency()
            assert found.rel_accuracy_bits() > 590
            assert found.overlaps((re * re + im * im).sqrt())
        alone = Root(arb(0), -third, 1, on_imaginary_axis=True, is_real=False).natural_frequency()
        assert alone.overlaps(third)
        assert alone.rel_accuracy_bits() > 590
    assert float(root(-3, 4).natural_frequency()) == hypot(3, 4)


def test_roots_come_with_their_mirror_images():
    for given, even, images in [
        (root(-3, 4), False, [(-3, 4), (-3, -4)]), (root(-3, 4), True, [(-3, 4), (-3, -4), (3, 4), (3, -4)]),
        (root(-3, 0), False, [(-3, 0)]), (root(-3, 0), True, [(-3, 0), (3, 0)]),
        (root(0, 4), True, [(0, 4), (0, -4)]), (root(0, 0), True, [(0, 0)]),
    ]:  # fmt: skip
        found = mirror_images([given], even=even)
        assert [(float(r.re), float(r.im)) for r in found] == images, (given, even)
        assert all(
            (r.is_real, r.on_imaginary_axis) == (given.is_real, given.on_imaginary_axis) for r in found
        ), (given, even)


def test_roots_may_be_the_same_where_both_parts_may():
    for re, im, same in [(0.15, 0.15, True), (0.25, 0, False), (0, 0.25, False)]:
        assert overlap(root(1, 1, size=0.1), root(1 + re, 1 + im, size=0.1)) is same


def test_a_part_is_printed_with_its_digits_and_what_they_are_off_by():
    for value, digits, text, radius in [
        (arb("0.00001"), 3, "0.0000100", "0"), (arb(2) ** -17, 2, "7.6e-6", "3.0e-8"),
        (arb(1024), 2, "1.0e3", "2.4e+1"), (arb(1024), 4, "1024", "0"), (arb(1024), 6, "1024.00", "0"),
        (arb("9.996"), 3, "10.0", "4.1e-3"), (arb(99.96875), 3, "100", "3.2e-2"), (arb(-0.5), 1, "-0.5", "0"),
        (arb(1000000, 2), 9, "1.00000e6", "2.1e+0"),
    ]:  # fmt: skip
        found = decimals(value, arb(0), digits)
        assert found.im == "0", (value, digits)
        assert found.re == text
        assert float(found.radius) == pytest.approx(float(radius), rel=0.1, abs=1e-19), (value, digits)


# --------------------------------------------------------- Decimal print: digits and a rigorous radius


def box(re, im):
    return Root(re, im, 1, on_imaginary_axis=False, is_real=False)


def farthest_square(root, decimals):
    """Square of the distance from the printed point to the farthest corner of the box, exactly."""
    total = Fraction(0)
    for ball, text in ((root.re, decimals.re), (root.im, decimals.im)):
        total += (abs(exact_fraction(ball) - Fraction(text)) + exact_fraction(ball.rad())) ** 2
    return total


def significant(text):
    return len(text.lstrip("-").split("e")[0].replace(".", "").lstrip("0"))


def test_each_component_carries_the_digits_asked_for_and_the_radius_reaches_the_whole_enclosure():
    for digits in (1, 2, 15, 30):
        for found in find_polynomial_roots(problem_of(fmpz_poly([3, 1, 4, 1, 5, 9, 2])), digits):
            decimals = found.decimal(digits)
            expected = (digits, 0 if found.is_real else digits)
            assert (significant(decimals.re), significant(decimals.im)) == expected, digits
            assert Fraction(decimals.radius) ** 2 >= farthest_square(found, decimals), digits


def test_exact_prints_have_radius_zero_and_others_about_one_unit_of_the_last_digit():
    upper, _ = find_polynomial_roots(problem(3, 2, 7), 30)
    decimals = upper.decimal(30)
    assert Fraction(decimals.radius) <= Fraction(1, 10**30)
    assert box(arb("1.23456789", 1e-4), arb(0)).decimal(30).re == "1.235"
    (root,) = find_polynomial_roots(problem(3, 2), 10)
    decimals = root.decimal(10)
    assert (decimals.re, decimals.im, decimals.radius) == ("-1.500000000", "0", "0")


@hypothesis.settings(max_examples=60)
@hypothesis.given(
    st.fractions(min_value=-(10**6), max_value=10**6),
    st.fractions(min_value=-(10**6), max_value=10**6),
    st.integers(min_value=0, max_value=120),
    st.integers(min_value=1, max_value=40),
)
def test_the_print_is_rigorous_for_any_box(re, im, exponent, digits):
    with precision(200):
        radius = arb(2) ** -exponent
        root = box(
            arb((arb(re.numerator) / re.denominator).mid(), radius),
            arb((arb(im.numerator) / im.denominator).mid(), radius),
        )
    decimals = root.decimal(digits)
    reached = Fraction(decimals.radius) ** 2
    assert farthest_square(root, decimals) <= reached


# ------------------------------------------------------------------- The working precision never leaks


def test_precision_holds_inside_a_block_and_is_restored():
    before = flint.ctx.prec
    with precision(100):
        with precision(777):
            assert flint.ctx.prec == 777
        assert flint.ctx.prec == 100
    with pytest.raises(RuntimeError), precision(777):
        raise RuntimeError
    assert flint.ctx.prec == before


def test_the_callers_precision_does_not_change_the_result():
    polynomial = flint.fmpz_poly([9, 2, 5, 3, 8, 1])
    wanted = [root.decimal(60) for root in find_polynomial_roots(problem_of(polynomial), 60)]
    for bits in (4, 53, 1000):
        with precision(bits):
            roots = find_polynomial_roots(problem_of(polynomial), 60)
            assert [root.decimal(60) for root in roots] == wanted


def test_images_are_in_the_axes_in_which_roots_mirror_each_other():
    def images(at, **symmetry):
        re, im = at
        root = Root(arb(re), arb(im), 1, on_imaginary_axis=re == 0, is_real=im == 0)
        return [(float(r.re), float(r.im)) for r in mirror_images([root], **symmetry)]

    for at, even, real, expected in (
        ((-3, 4), False, True, [(-3, 4), (-3, -4)]),
        ((-3, 4), False, False, [(-3, 4)]),
        ((-3, 4), True, False, [(-3, 4), (3, -4)]),
        ((-3, 0), True, True, [(-3, 0), (3, 0)]),
        ((0, 4), True, True, [(0, 4), (0, -4)]),
        ((0, 4), True, False, [(0, 4)]),
        ((0, 0), True, True, [(0, 0)]),
    ):
        assert images(at, even=even, real=real) == expected
