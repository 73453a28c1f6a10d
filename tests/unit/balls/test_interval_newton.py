"""Interval Newton steps on polynomials whose roots are known."""

from flint import acb, arb

from symflex.balls import narrowed, stays_inside


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
    assert not stays_inside(acb(float("nan")), arb(1))


def test_a_root_stays_in_its_box_while_that_becomes_smaller():
    found = narrowed(arb(1.4, 0.1), lambda box: box.mid() - step(box), 20, 0.5)
    assert (found * found).contains(2)
    assert found.rad() < 1e-14
    box = arb(1.4, 0.1)
    assert narrowed(box, lambda _: arb(1.4, 0.2), 5, 0.5).rad() == box.rad()
    assert narrowed(box, lambda _: arb("nan"), 5, 0.5).rad() == box.rad()
