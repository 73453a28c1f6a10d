from itertools import count

import pytest

from symflex.budget import Budget, entered_budget, memory_held, peak_memory, spend
from symflex.errors import BudgetError


def code_of(call):
    with pytest.raises(BudgetError) as caught:
        call()
    return caught.value.diagnostics[0].code


def test_nothing_is_limited_where_no_budget_is_entered():
    assert (entered_budget().seconds, entered_budget().memory) == (None, None)
    spend()


def test_what_is_entered_is_asked_by_every_loop():
    with Budget(seconds=2, clock=count().__next__).entered():
        spend()
        spend()
        assert code_of(spend) == "SF506"


def test_a_budget_without_limits_of_its_own_heeds_the_one_that_is_entered():
    with Budget(seconds=0, clock=count().__next__).entered():
        assert code_of(Budget().besides().spend) == "SF506"


def test_a_budget_inside_another_replaces_it_until_it_is_left():
    with Budget(seconds=0, clock=count().__next__).entered():
        with Budget().entered():
            spend()
        assert code_of(spend) == "SF506"


def test_memory_is_that_of_the_process():
    held = memory_held()
    assert 5_000_000 < held < 1.1 * peak_memory() < 20_000_000_000


def test_memory_given_back_counts_no_longer():
    room = memory_held() + 50_000_000
    with Budget(memory=room).entered():
        spend()
        block = bytearray(b"x") * 100_000_000
        assert code_of(spend) == "SF504"
        del block
        spend()


def test_a_part_of_a_budget_began_when_the_whole_did():
    clock = iter([0.0, 1.0, 1.0]).__next__
    whole = Budget(seconds=10, clock=clock)
    assert whole.share(0.5).seconds == 5
    assert whole.at_least(20).seconds == 20
