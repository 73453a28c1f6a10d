"""Base lengths."""

from __future__ import annotations

from fractions import Fraction

import pytest

from symflex.algebra import Factored, Ring
from symflex.algebra.propagators import length_base

RING = Ring(("s", "l", "x", "d"))
L, X, D = (Factored.generator(RING, name) for name in ("l", "x", "d"))


def recombined(found, i):
    total = Factored.number(RING, 0)
    for base, n in zip(found.base, found.coordinates[i], strict=True):
        total = total + base * n
    return total


@pytest.mark.parametrize(
    "lengths",
    [
        [L],
        [L, X],
        [L, X, L - X],
        [L / 2, L],
        [L / 3, L / 2],
        [L, L * Fraction(2, 3), X, X - L],
        [L / D, L / D * 2],
        [L * X, L, X],
        [L / D / 2, X / D**2 * Fraction(5, 3), L / D / 3],
        [L * 5, L * 3, X],
        [L - X, X - D, L - D],
    ],
)
def test_every_length_is_the_combination_its_coordinates_say(lengths):
    found = length_base(lengths)
    for i, length in enumerate(lengths):
        assert (recombined(found, i) - length).is_zero


def test_halves_and_thirds_need_a_sixth():
    found = length_base([L / 3, L / 2])
    assert [str(b) for b in found.base] == ["1/6*l"]
    assert sorted(found.coordinates) == [(2,), (3,)]


def test_quotients_that_no_given_length_divides_have_a_base_of_their_own():
    found = length_base([L / D / 2, L / D / 3, L / D])
    assert [str(b) for b in found.base] == ["1/6*l*d^-1"]
    assert found.coordinates == ((3,), (2,), (6,))


def test_a_base_is_made_where_too_many_subsets_would_have_to_be_tried(monkeypatch):
    assert length_base([L * 2, L]).base[0].unit == 1
    monkeypatch.setattr("symflex.algebra.propagators.SUBSET_LIMIT", 1)
    lengths = [L * 2, X, L]
    found = length_base(lengths)
    assert [(recombined(found, i) - length).is_zero for i, length in enumerate(lengths)] == [True] * 3
    assert len(found.base) == 2


def test_where_some_coordinate_is_negative_in_every_base_the_first_serves():
    found = length_base([L - X, X - L], positive=True)
    assert [str(b) for b in found.base] == ["(l - x)"]
    assert found.coordinates == ((1,), (-1,))


def test_a_later_base_is_taken_where_the_first_has_negative_coordinates():
    lengths = [L, X, L - X, X * 2 - L]
    assert [str(b) for b in length_base(lengths).base] == ["l", "x"]
    # l = 2 (l - x) + (2 x - l)
    assert length_base(lengths, positive=True).coordinates[0] == (2, 1)


def test_given_lengths_are_kept_when_they_suffice():
    found = length_base([L, X, L - X])
    assert [str(b) for b in found.base] == ["l", "x"]


def test_no_coordinate_is_negative_when_that_is_asked_for():
    found = length_base([L, X, L - X], positive=True)
    assert all(n >= 0 for c in found.coordinates for n in c)


def test_the_base_is_independent():
    assert len(length_base([L - X, X - D, L - D]).base) == 2
