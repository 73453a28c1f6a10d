"""Interval Newton steps on polynomials whose roots are known."""

from __future__ import annotations

import pytest
from flint import acb, arb

from symflex.algebra.interval_newton import narrowed, stays_inside


def step(box):
    """Return the step of x^2 - 2 on a box."""
    middle = box.mid()
    return (middle * middle - 2) / (2 * box)


@pytest.mark.parametrize(
    ("middle", "reach", "is_proved"),
    [(1.4, 0.1, True), (-1.5, 0.25, True), (3.0, 0.1, False), (0.0, 2.0, False), (1.5, 0.08, False)],
    ids=["one root", "the other", "none", "both", "too close to its end"],
)
def test_a_box_with_one_root_well_inside_is_told_from_others(middle, reach, is_proved):
    assert stays_inside(step(arb(middle, reach)), arb(reach)) is is_proved


@pytest.mark.parametrize("off", [acb(0.2), acb(0, 0.2)])
def test_a_complex_step_has_to_stay_inside_on_both_axes(off):
    assert stays_inside(off, arb(0.25))
    assert not stays_inside(off, arb(0.125))


def test_what_is_not_known_proves_nothing():
    assert not stays_inside(acb(float("nan")), arb(1))


def test_a_root_stays_in_its_box_while_that_is_narrowed():
    found = narrowed(arb(1.4, 0.1), lambda box: box.mid() - step(box), 20, 0.5)
    assert (found * found).contains(2)
    assert found.rad() < 1e-14


def test_a_box_that_becomes_no_smaller_is_left():
    box = arb(1.4, 0.1)
    assert narrowed(box, lambda _: arb(1.4, 0.2), 5, 0.5).rad() == box.rad()
    assert narrowed(box, lambda _: arb("nan"), 5, 0.5).rad() == box.rad()
