"""Base lengths."""

from __future__ import annotations

from fractions import Fraction

import pytest

from symflex.kernels import Factored, Ring
from symflex.kernels.lengths import length_base

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


def test_given_lengths_are_kept_when_they_suffice():
    found = length_base([L, X, L - X])
    assert [str(b) for b in found.base] == ["l", "x"]


def test_no_coordinate_is_negative_when_that_is_asked_for():
    found = length_base([L, X, L - X], positive=True)
    assert all(n >= 0 for c in found.coordinates for n in c)


def test_the_base_is_independent():
    assert len(length_base([L - X, X - D, L - D]).base) == 2
