"""Certified discs: what they claim and what they refuse."""

from __future__ import annotations

from flint import acb, acb_poly, arb

from symflex.roots.discs import Disc, LevelPolynomial, complete, groups, overlapping_pairs, with_mirrors


def relative(z):
    return z.abs_lower() / 10**10


def test_a_polished_disc_holds_the_root():
    level = LevelPolynomial.of(acb_poly([-2, 0, 1]))
    disc = level.polish(acb(1.4), relative)
    assert abs(disc.centre - acb(2).sqrt()) < disc.radius + arb(2) ** -50


def test_touching_discs_count_as_overlapping():
    assert overlapping_pairs([Disc(acb(0), arb(1)), Disc(acb(2), arb(1))]) == [(0, 1)]


def test_discs_a_hair_apart_are_told_apart_beyond_double_precision():
    gap = arb(2) ** -60
    assert overlapping_pairs([Disc(acb(1), gap / 4), Disc(acb(1 + gap), gap / 4)]) in ([], [(0, 1)])
    assert overlapping_pairs([Disc(acb(0), gap), Disc(acb(4 * gap), gap)]) == []


def test_a_set_of_discs_that_misses_a_root_is_not_complete():
    assert not complete([Disc(acb(0), arb(1))], 2)


def test_an_infinite_disc_proves_nothing():
    assert not complete([Disc(acb(0), arb("inf"))], 1)


def test_a_disc_that_meets_its_mirror_image_is_not_complete():
    assert not complete([Disc(acb(0, 1), arb(2))], 2)


def test_mirrors_are_added_off_the_real_axis_only():
    assert len(with_mirrors([Disc(acb(1), arb(1)), Disc(acb(0, 3), arb(1))])) == 3


def test_pellet_surrounds_a_double_root():
    level = LevelPolynomial.of(acb_poly([1, -2, 1]) * acb_poly([5, 1]))
    disc = level.surround(acb(1), 2)
    assert disc.count == 2
    assert disc.radius < arb(10) ** -5


def test_pellet_refuses_a_count_that_is_wrong():
    level = LevelPolynomial.of(acb_poly([1, -2, 1]) * acb_poly([-1.001, 1]))
    assert level.surround(acb(1), 1) is None


def test_groups_follow_chains_of_touching_discs():
    row = [Disc(acb(3 * i), arb(1.6)) for i in range(3)] + [Disc(acb(50), arb(1))]
    assert [len(group) for group in groups(row)] == [3, 1]
