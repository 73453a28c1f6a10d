"""Base lengths."""

from fractions import Fraction

from symflex.algebra import Factored, Ring
from symflex.algebra.propagators import length_base

RING = Ring(("s", "l", "x", "d"))
L, X, D = (Factored.generator(RING, name) for name in ("l", "x", "d"))


def recombined(found, i):
    total = Factored.number(RING, 0)
    for base, n in zip(found.base, found.coordinates[i], strict=True):
        total = total + base * n
    return total


def test_every_length_is_the_combination_its_coordinates_say():
    for lengths in [
        [L], [L, X], [L, X, L - X], [L / 2, L], [L / 3, L / 2], [L, L * Fraction(2, 3), X, X - L],
        [L / D, L / D * 2], [L * X, L, X], [L / D / 2, X / D**2 * Fraction(5, 3), L / D / 3],
        [L * 5, L * 3, X], [L - X, X - D, L - D],
    ]:  # fmt: skip
        found = length_base(lengths)
        for i, length in enumerate(lengths):
            assert (recombined(found, i) - length).is_zero, lengths


def test_a_base_is_as_short_as_it_can_be():
    for lengths, base in [
        ([L / 3, L / 2], ["1/6*l"]),
        # Quotients that no given length divides have a base of their own.
        ([L / D / 2, L / D / 3, L / D], ["1/6*l*d^-1"]),
        # Given lengths are kept when they suffice.
        ([L, X, L - X], ["l", "x"]),
    ]:
        assert [str(b) for b in length_base(lengths).base] == base
    assert sorted(length_base([L / 3, L / 2]).coordinates) == [(2,), (3,)]
    assert length_base([L / D / 2, L / D / 3, L / D]).coordinates == ((3,), (2,), (6,))
    # It is independent.
    assert len(length_base([L - X, X - D, L - D]).base) == 2


def test_a_base_is_made_where_too_many_subsets_would_have_to_be_tried(monkeypatch):
    assert length_base([L * 2, L]).base[0].unit == 1
    monkeypatch.setattr("symflex.algebra.propagators.SUBSET_LIMIT", 1)
    lengths = [L * 2, X, L]
    found = length_base(lengths)
    assert [(recombined(found, i) - length).is_zero for i, length in enumerate(lengths)] == [True] * 3
    assert len(found.base) == 2


def test_no_coordinate_is_negative_when_that_is_asked_for_and_can_be():
    found = length_base([L, X, L - X], positive=True)
    assert all(n >= 0 for c in found.coordinates for n in c)
    # A later base is taken where the first has negative coordinates: l = 2 (l - x) + (2 x - l).
    lengths = [L, X, L - X, X * 2 - L]
    assert [str(b) for b in length_base(lengths).base] == ["l", "x"]
    assert length_base(lengths, positive=True).coordinates[0] == (2, 1)
    # Where some are negative in every base, the first serves.
    found = length_base([L - X, X - L], positive=True)
    assert ([str(b) for b in found.base], found.coordinates) == (["(l - x)"], ((1,), (-1,)))
