"""Searches by halving: nothing is lost, whatever the order, and every limit says what it left."""

import pytest
from flint import arb

from symflex.balls import Open, UndecidedError, branch, covered
from symflex.budget import Budget
from symflex.errors import BudgetError


def halve(ends):
    """Return both halves of an interval that is not too short."""
    low, high = ends
    middle = (low + high) / 2
    return [(low, middle), (middle, high)] if high - low > 2.0**-12 else []


def about_root(of):
    """Return what decides on intervals where ``x^2 - of`` excludes zero."""
    return lambda ends: Open(ends) if (arb(ends[0]).union(arb(ends[1])) ** 2 - of).contains(0) else None


@pytest.mark.parametrize("order", ["depth", "breadth", lambda ends: ends[1]])
def test_what_is_not_excluded_is_left_in_every_order(order):
    # x^2 = 2 has the roots -+ 1.41421356..., and [-3, 3] no other; 0 as an end is a root of x^2.
    for of, roots in ((2, (-(2**0.5), 2**0.5)), (0, (0.0,))):
        found = branch([(-3.0, 0.0), (0.0, 3.0)], about_root(of), halve, order=order)
        for root in roots:
            assert any(low <= root <= high for low, high in found.undecided)
        assert all(any(low - 1e-2 <= root <= high + 1e-2 for root in roots) for low, high in found.undecided)
        assert not found.unseen


def test_parts_are_looked_at_in_the_order_that_is_asked_for():
    def seen(order):
        looked = []

        def decide(ends):
            looked.append(ends)
            return Open(ends) if ends[1] - ends[0] > 1 else None

        branch([(0, 2), (2, 4)], decide, lambda e: [(e[0], e[0] + 1), (e[0] + 1, e[1])], order=order)
        return looked

    assert seen("depth") == [(0, 2), (0, 1), (1, 2), (2, 4), (2, 3), (3, 4)]
    assert seen("breadth") == [(0, 2), (2, 4), (0, 1), (1, 2), (2, 3), (3, 4)]
    assert seen(lambda ends: ends[0]) == [(2, 4), (3, 4), (2, 3), (0, 2), (1, 2), (0, 1)]


def test_a_search_that_ends_early_leaves_all_that_was_not_looked_at():
    whole = [(k, k + 1) for k in range(5)]
    for limits in ({"most": 2}, {"until": lambda found, waiting: waiting == 3}):
        found = branch(whole, lambda ends: ends, halve, **limits)
        assert found.decided == whole[:2]
        assert found.undecided == whole[2:]
        assert (found.spent, found.unseen) == (2, 3)


def test_a_region_that_was_narrowed_is_halved_as_it_is_now():
    found = branch([(0.0, 8.0)], lambda e: Open((0.0, 0.75)) if e[1] > 2 else e, lambda e: [e])
    assert found.decided == [(0.0, 0.75)]


def test_a_budget_ends_a_search_with_or_without_what_it_proved():
    def search(**given):
        clock = iter([0.0, *[0.0] * 4, *[9.0] * 9]).__next__
        with Budget(seconds=1, clock=clock).entered():
            return branch([(-3.0, 3.0)], about_root(2), halve, **given)

    with pytest.raises(BudgetError, match="SF506"):
        search()
    found = search(keeps=True)
    assert found.over.code == "SF506"
    for root in (-(2**0.5), 2**0.5):
        assert any(low <= root <= high for low, high in found.undecided)


def test_the_region_that_is_looked_at_when_a_budget_ends_is_undecided_too():
    clock = iter([0.0, *[0.0] * 4, *[9.0] * 9]).__next__
    with Budget(seconds=1, clock=clock).entered():
        found = branch([(0.0, 8.0)], Open, halve, keeps=True)
    assert found.over is not None
    assert sum(high - low for low, high in found.undecided) == 8


def test_a_path_is_covered_by_pieces_that_touch_or_is_undecided():
    pieces = covered(lambda a, b: b <= 0.3 or a >= 0.25 or None, 1, 0.01)
    assert [a for a, *_ in pieces] == [0.0, 0.25, 0.5]
    assert [b for _, b, _ in pieces] == [0.25, 0.5, 1.0]
    assert covered(lambda a, b: b - a, 4, 0.01) == [(k / 4, (k + 1) / 4, 0.25) for k in range(4)]
    with pytest.raises(UndecidedError):
        covered(lambda a, b: b <= 0.3 or a >= 0.3 or None, 1, 0.01)


def test_pieces_as_short_as_allowed_are_tried_and_one_that_stays_open_ends_the_search():
    quarters = covered(lambda a, b: b - a <= 0.25 or None, 1, 0.25)
    assert [a for a, *_ in quarters] == [0, 0.25, 0.5, 0.75]
    tried = []
    with pytest.raises(UndecidedError):
        covered(lambda a, b: tried.append(a), 8, 0.125)
    assert tried == [0]
