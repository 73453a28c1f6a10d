"""How far a root moves over a box of letters, against roots of equations of first order, written by hand."""

from math import exp, inf

import pytest
from flint import acb, arb

from symflex.letters.distance import moved_over

SMALL = 1e-6


@pytest.mark.parametrize("half", [0.1, 0.5, 0.6])
def test_the_bound_of_a_moved_root_is_attained_at_a_corner_of_the_box(half):
    # s + e x^20 = 1 + e has its root s = 1 + e - e x^20, and 1 + e without the power. At x = exp(half) they
    # are e exp(20 half) apart, of which the first terms of the series are less than 10 % for half = 0.6.
    power = (0, acb(SMALL), [20])
    whole = [(1, acb(1), [0]), (0, acb(-1 - SMALL), [0]), power]
    halves = [arb(half), arb(0.99 * half, 0.01 * half)]  # the farthest end of a ball counts
    bounds = [moved_over(whole, [power], acb(1), [each]) for each in halves]
    moved = SMALL * exp(20 * half)
    least = moved / (1 + SMALL - moved) * (1 - 1e-12)
    assert all(least < bound < 1.01 * least for bound in bounds)


def test_a_root_that_may_vanish_in_the_box_has_no_bound():
    # At half = 0.7 the power is e^14 = 1.2 times 10^6: the root has left for the other side of 0.
    power = (0, acb(SMALL), [20])
    whole = [(1, acb(1), [0]), (0, acb(-1 - SMALL), [0]), power]
    assert moved_over(whole, [power], acb(1), [arb(0.7)]) == inf
