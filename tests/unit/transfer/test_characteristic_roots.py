"""Enclosures of characteristic roots on wide balls of s."""

import cmath

import numpy as np
import pytest
from flint import acb, acb_series, arb

from symflex.transfer.enclose_kernels import characteristic_roots, square_root


def coefficients(s):
    """Return those of x^6 - 5 s^2 x^4 + 7 s^2 x^2 - 2 s^4, odd ones zero."""
    return [-2 * s**4, acb(0), 7 * s**2, acb(0), -5 * s**2, acb(0)]


def on(centre, radius):
    return acb(arb(centre.real, radius), arb(centre.imag, radius))


def test_every_box_holds_one_root_of_every_polynomial_on_the_ball():
    for even in [True, False]:
        centre, radius = 0.7 + 1.1j, 1e-4
        boxes = characteristic_roots(coefficients(on(centre, radius)), even=even)
        for k in range(12):
            s = centre + 0.99 * radius * cmath.exp(2j * cmath.pi * k / 12)
            for root in np.roots([1, 0, -5 * s**2, 0, 7 * s**2, 0, -2 * s**4]):
                inside = [box for box in boxes if abs(complex(box.mid()) - root) < float(box.rad()) * 1.5]
                assert len(inside) == 1, even
                assert inside[0].overlaps(acb(arb(root.real, 1e-12), arb(root.imag, 1e-12))), even


def test_pairs_follow_each_other():
    boxes = characteristic_roots(coefficients(acb(0.7, 1.1)), even=True)
    assert all((a + b).contains(0) for a, b in zip(boxes[::2], boxes[1::2], strict=True))


def test_roots_that_meet_on_the_ball_are_not_told_apart():
    # x^2 = s on a ball that contains s = 0.
    assert characteristic_roots([-on(0.001, 0.01), acb(0)], even=True) is None
    assert characteristic_roots([-on(0.001, 0.01), acb(0)]) is None


def test_nothing_is_said_of_coefficients_that_are_not_known():
    assert characteristic_roots([acb("nan", "nan"), acb(0)]) is None


def test_the_slope_of_a_root_is_that_of_the_square_root():
    s = acb_series([acb(4), acb(1)], 2)
    slopes = sorted(float(x[1].real.mid()) for x in characteristic_roots([-s, acb(0)], even=True))
    assert slopes == pytest.approx([-0.25, 0.25])


def test_a_wide_square_root_holds_one_branch_across_the_cut():
    for centre in [4 + 0j, -4 + 0j, 0.1 - 3j]:
        box = square_root(on(centre, 0.05))
        for k in range(8):
            root = cmath.sqrt(centre + 0.05 * cmath.exp(2j * cmath.pi * k / 8))
            inside = [sign for sign in (1, -1) if box.contains(acb(sign * root))]
            assert len(inside) == 1, centre
