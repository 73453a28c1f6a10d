"""Roots close together inside a circle, told apart by moments, where all roots are known."""

from __future__ import annotations

from itertools import product

from flint import acb, arb

from symflex.roots.plane.local_roots import MOST, middle_of, resolve
from symflex.roots.precision import precision
from tests.unit.roots.known_functions import KnownFunction

CENTRE = acb(2, 3)
BITS = 256
DIGITS = 20
CLOSE = (0, 1, 1j, -2 + 1j)
"""In millionths of the circle's radius."""


def beside(*offsets, scale=2.0**-20):
    """Return roots that lie so far from the centre."""
    with precision(BITS):
        return tuple((arb(2) + scale * complex(z).real, arb(3) + scale * complex(z).imag) for z in offsets)


def resolved(*factors, radius=1, even=False, centre=CENTRE):
    function = KnownFunction(tuple(factors), power=1)
    return resolve(function, centre, arb(radius), DIGITS, BITS, even=even)


def holds_each_once(found, roots):
    with precision(2 * BITS):
        return [sum(root.enclosure().contains(acb(*each)) for root in found) for each in roots] == [1] * len(
            roots
        )


def test_every_root_of_a_cluster_is_enclosed_by_itself():
    for count, radius in product([1, 2, 3, 4], [1, 0.125]):
        roots = beside(*CLOSE[:count])
        found = resolved((roots, 1), radius=radius)
        assert len(found) == count, radius
        assert holds_each_once(found, roots), (count, radius)
        assert all(root.certified and root.multiplicity == 1 for root in found), (count, radius)


def test_roots_outside_of_the_circle_are_not_among_them():
    inside, outside = beside(0, 1), beside(3, -4j, 10 + 10j, scale=1.0)
    found = resolved((inside + outside, 1))
    assert len(found) == 2
    assert holds_each_once(found, inside)
    assert resolved((beside(3, 4j, scale=1.0), 1)) == []


def test_roots_of_a_factor_have_its_exponent_and_those_of_a_denominator_are_none():
    first, second, third = (beside(z) for z in (1, -3j, 5))
    found = resolved((first, 2), (second, -1), (third, 1))
    assert [root.multiplicity for root in found] == [2, 1]
    assert holds_each_once(found, first + third)


def test_one_root_of_two_factors_or_on_the_circle_is_not_told_apart():
    assert resolved((beside(1), 1), (beside(1, 5), 1)) is None
    assert resolved((beside(0, scale=1.0) + beside(1, scale=1.0), 1)) is None
    # Close to it, the moments are no whole numbers.
    assert resolved((beside(0, 0.9999, scale=1.0), 1)) is None


def test_a_cluster_has_so_many_roots_and_no_more():
    for count in [MOST, MOST + 1]:
        roots = beside(*range(count), scale=2.0**-8)
        found = resolved((roots, 1))
        if count > MOST:
            assert found is None, count
        else:
            assert holds_each_once(found, roots), count


def test_a_root_next_to_an_axis_lies_on_it_where_roots_mirror_each_other():
    for even, on_axis in [(True, True), (False, False)]:
        with precision(4 * BITS):
            roots = ((arb(0), arb(10).sqrt()), (arb(0), -arb(10).sqrt()))
        function = KnownFunction(((roots, 1),), is_even=even)
        (root,) = resolve(function, acb(2.0**-20, 3), arb(1), DIGITS, BITS, even=even)
        assert root.on_imaginary_axis is on_axis, even
        assert root.multiplicity == 1, even


def test_the_middle_of_roots_is_their_mean_if_there_are_any():
    for (factors, mean), radius in product(
        [
            ([((0, 0.25), 1)], 0.125),
            ([((0.25,), 1), ((-0.25j,), 3)], (0.25 - 0.75j) / 4),
            ([((0.25, 0.125j, 5), 1)], (0.25 + 0.125j) / 2),
            # a pole takes away what it adds
            ([((0.25, 0.125), 2), ((0.25,), -1)], (0.25 + 2 * 0.125) / 3),
        ],
        [0.5, 2],
    ):
        function = KnownFunction(tuple((beside(*roots, scale=1.0), e) for roots, e in factors))
        found = middle_of(function, CENTRE, arb(radius), BITS)
        assert abs(complex(found) - (2 + 3j) - mean) < 1e-15, radius
        assert found.is_exact(), (factors, radius)
    # The pole makes up for the root: their number is 0.
    function = KnownFunction(((beside(0), 1), (beside(0), -1)))
    assert middle_of(function, CENTRE, arb(1), BITS) is None
