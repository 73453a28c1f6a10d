"""One root: its frequency and damping, its mirror images, and its decimals by hand."""

from __future__ import annotations

from dataclasses import replace
from math import hypot, pi

import pytest
from flint import arb

from symflex.roots import Root, precision
from symflex.roots.root import FLOAT_BITS, decimals, mirror_images, overlap
from tests.unit.roots.stand_ins import root


@pytest.mark.parametrize(
    ("given", "hertz", "zeta"),
    [
        (root(-3, 4), 5 / (2 * pi), 0.6),
        (root(3, -4), 5 / (2 * pi), -0.6),
        (root(0, -7), 7 / (2 * pi), 0.0),
        (root(-2, 0), 1 / pi, 1.0),
        (root(0, 0), 0.0, None),
        # not told from the axis, and not told from 0
        (root(0, 7, size=0.5), 7 / (2 * pi), 0.0),
        (root(0, 0, size=0.5), 0.0, None),
    ],
)
def test_a_root_has_a_frequency_and_a_damping_ratio(given, hertz, zeta):
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


def test_arithmetic_with_a_root_loses_nothing():
    with precision(600):
        third = arb(1) / 3
    for re, im in ((third, arb(1)), (arb(1), third)):
        bits = Root(re, im, 1, on_imaginary_axis=False, is_real=False).working_bits()
        assert bits > 600
        with precision(bits):
            assert (+re).rel_accuracy_bits() >= re.rel_accuracy_bits()
    assert root(1, 1).working_bits() > FLOAT_BITS


@pytest.mark.parametrize(
    ("given", "even", "images"),
    [
        (root(-3, 4), False, [(-3, 4), (-3, -4)]),
        (root(-3, 4), True, [(-3, 4), (-3, -4), (3, 4), (3, -4)]),
        (root(-3, 0), False, [(-3, 0)]),
        (root(-3, 0), True, [(-3, 0), (3, 0)]),
        (root(0, 4), True, [(0, 4), (0, -4)]),
        (root(0, 0), True, [(0, 0)]),
    ],
)
def test_roots_come_with_their_mirror_images(given, even, images):
    found = mirror_images([given], even=even)
    assert [(float(r.re), float(r.im)) for r in found] == images
    assert all((r.is_real, r.on_imaginary_axis) == (given.is_real, given.on_imaginary_axis) for r in found)


def test_a_mirror_image_is_as_certain_as_the_root():
    given = replace(root(-3, 4, 2, 0.1), certified=False, on_boundary=True)
    for image in mirror_images([given, root(5, 6)], even=True)[:4]:
        assert (image.multiplicity, image.certified, image.on_boundary) == (2, False, True)
        assert float(image.re.rad()) == pytest.approx(0.1)
        assert float(image.im.rad()) == pytest.approx(0.1)
    assert mirror_images([], even=True) == []


@pytest.mark.parametrize(("re", "im", "same"), [(0.15, 0.15, True), (0.25, 0, False), (0, 0.25, False)])
def test_roots_may_be_the_same_where_both_parts_may(re, im, same):
    assert overlap(root(1, 1, size=0.1), root(1 + re, 1 + im, size=0.1)) is same


@pytest.mark.parametrize(
    ("value", "digits", "text", "radius"),
    [
        (arb("0.00001"), 3, "0.0000100", "0"),
        (arb(2) ** -17, 2, "7.6e-6", "3.0e-8"),
        (arb(1024), 2, "1.0e3", "2.4e+1"),
        (arb(1024), 4, "1024", "0"),
        (arb(1024), 6, "1024.00", "0"),
        (arb("9.996"), 3, "10.0", "4.1e-3"),
        (arb(99.96875), 3, "100", "3.2e-2"),
        (arb(-0.5), 1, "-0.5", "0"),
        (arb(1000000, 2), 9, "1.00000e6", "2.1e+0"),
    ],
)
def test_a_part_is_printed_with_its_digits_and_what_they_are_off_by(value, digits, text, radius):
    found = decimals(value, arb(0), digits)
    assert found.im == "0"
    assert found.re == text
    assert float(found.radius) == pytest.approx(float(radius), rel=0.1, abs=1e-19)
