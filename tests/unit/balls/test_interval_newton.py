"""Interval Newton steps on polynomials whose roots are known."""

import pytest
from flint import acb, arb

from symflex.balls import narrowed, newton_box, status_of, stays_inside, two_steps


def step(box):
    """Return the step of x^2 - 2 on a box."""
    middle = box.mid()
    return (middle * middle - 2) / (2 * box)


def test_a_box_with_one_root_well_inside_is_told_from_others():
    for middle, reach, is_proved in [
        (1.4, 0.1, True),
        (-1.5, 0.25, True),
        (3.0, 0.1, False),
        (0.0, 2.0, False),
        (1.5, 0.08, False),
    ]:
        assert stays_inside(step(arb(middle, reach)), arb(reach)) is is_proved


def test_a_step_has_to_stay_inside_on_both_axes_and_to_be_known():
    for off in [acb(0.2), acb(0, 0.2)]:
        assert stays_inside(off, arb(0.25))
        assert not stays_inside(off, arb(0.125))
    assert stays_inside(acb(0.2, 0.2), arb(0.25))  # a corner of the square, not of a disc
    assert not stays_inside(acb(float("nan")), arb(1))


def test_a_root_stays_in_its_box_while_that_becomes_smaller():
    found = narrowed(arb(1.4, 0.1), lambda box: box.mid() - step(box), 20, 0.5)
    assert (found * found).contains(2)
    assert found.rad() < 1e-14
    box = arb(1.4, 0.1)
    assert narrowed(box, lambda _: arb(1.4, 0.2), 5, 0.5).rad() == box.rad()
    assert narrowed(box, lambda _: arb("nan"), 5, 0.5).rad() == box.rad()


def test_the_last_step_is_the_first_that_leaves_more_than_a_share():
    # 8 steps are allowed; the first that leaves half is kept, and is the last one.
    for left, steps in ((0.5, 1), (0.75, 1), (0.25, 8), (1.0, 0)):
        found = narrowed(arb(1, 1), lambda box, left=left: arb(1, left * box.rad()), 8, 0.5)
        assert float(found.rad()) == pytest.approx(left**steps, rel=1e-6)


def test_one_unknown_is_narrowed_on_while_the_other_stays():
    def steps(box, bits):
        return arb(0, 0.999 * box[0].rad()), arb(0, box[1].rad() / 4)

    status, (x, y) = newton_box(steps, (arb(1, 0.5), arb(1, 0.5)), 64, 300)
    assert status == "one"
    assert x.rad() > 0.4
    assert y.rad() < 1e-18


def circle_steps(box, bits):
    """Return the steps of ``x^2 + y^2 - 5 + j (x y - 2) = 0``, which holds at (1, 2) and (2, 1)."""
    x, y = box
    a, b = x.mid(), y.mid()
    return two_steps(acb(a * a + b * b - 5, a * b - 2), acb(2 * x, y), acb(2 * y, x))


def test_a_box_of_two_unknowns_has_one_root_none_or_is_undecided():
    for middle, reach, status in [
        ((1.01, 1.99), 0.1, "one"),
        ((2.0, 1.0), 0.2, "one"),
        ((1.3, 2.3), 0.1, "none"),
        ((1.5, 1.5), 0.6, "undecided"),  # both
        ((1.5, 1.5), 0.01, "undecided"),  # slopes are parallel where x = y
    ]:
        found, root = newton_box(circle_steps, (arb(middle[0], reach), arb(middle[1], reach)), 96, 300)
        assert found == status, middle
        if status == "one":
            assert (root[0] * root[1]).contains(2)
            assert min(x.rel_accuracy_bits() for x in root) > 300


def test_a_step_as_long_as_the_box_proves_nothing():
    # At the rim: a step of exactly the reach may end on a root there, inside or not.
    for step, status in [(0.5, "undecided"), (0.5 - 2.0**-40, "one"), (0.5 + 2.0**-40, "none")]:
        for steps in ((arb(step), arb(0)), (arb(0), arb(-step))):
            assert status_of(steps, (arb(0.5), arb(0.5))) == status
    assert status_of((arb("nan"), arb(0)), (arb(1), arb(1))) == "undecided"
    assert status_of(None, (arb(1), arb(1))) == "undecided"
