"""Certified discs: what they claim and what they refuse."""

from fractions import Fraction
from itertools import combinations
from random import Random

from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.roots.polynomials.discs import (
    Disc,
    LevelPolynomial,
    complete,
    connected,
    groups,
    overlapping_pairs,
    propose_by_durand_kerner,
    with_mirrors,
)


def relative(z):
    return z.abs_lower() / 10**10


def test_a_polished_disc_holds_the_root():
    level = LevelPolynomial.of(acb_poly([-2, 0, 1]))
    disc = level.polish(acb(1.4), relative)
    assert abs(disc.centre - acb(2).sqrt()) < disc.radius + arb(2) ** -50


def test_touching_discs_count_as_overlapping():
    assert overlapping_pairs([Disc(acb(0), arb(1)), Disc(acb(2), arb(1))]) == [(0, 1)]


def test_discs_a_hair_apart_are_told_apart_beyond_double_precision():
    for scale in [0, 1, 10**6]:
        for hair in [-70, -40]:
            with precision(200):
                gap = arb(2) ** hair
                apart, near = acb(scale, 2 * scale), acb(scale, 2 * scale) + acb(3, 4) / 5
                # Centres one apart, radii a half each but for a hair.
                assert (
                    overlapping_pairs([Disc(apart.mid(), arb(0.5)), Disc(near.mid(), (0.5 - gap).mid())])
                    == []
                ), (scale, hair)
                assert overlapping_pairs(
                    [Disc(apart.mid(), arb(0.5)), Disc(near.mid(), (0.5 + gap).mid())]
                ) == [(0, 1)], (scale, hair)


def test_discs_that_prove_nothing_are_not_complete():
    assert not complete([Disc(acb(0), arb(1))], 2)
    assert not complete([Disc(acb(0), arb("inf"))], 1)
    assert not complete([Disc(acb(0, 1), arb(2))], 2)
    discs = [Disc(acb(0), arb(1), 2), Disc(acb(5, 3), arb(1), 1)]
    assert complete(discs, 4)
    assert not complete(discs, 3)
    assert not complete(discs, 5)
    assert not complete([*discs, Disc(acb(1.5), arb(1))], 5)
    assert not complete([Disc(acb(0), arb("inf"), 2)], 2)
    disc = Disc(acb(5, 3), arb(1), 2)
    assert disc.mirrored() == Disc(acb(5, -3), arb(1), 2)
    assert complete([disc, Disc(acb(0), arb(1))], 5)
    assert len(with_mirrors([Disc(acb(1), arb(1)), Disc(acb(0, 3), arb(1))])) == 3


def test_pellet_surrounds_a_double_root_and_refuses_a_count_that_is_wrong():
    level = LevelPolynomial.of(acb_poly([1, -2, 1]) * acb_poly([5, 1]))
    disc = level.surround(acb(1), 2)
    assert disc.count == 2
    assert disc.radius < arb(10) ** -5
    level = LevelPolynomial.of(acb_poly([1, -2, 1]) * acb_poly([-1.001, 1]))
    assert level.surround(acb(1), 1) is None


def test_groups_follow_chains_of_touching_discs_and_closeness_where_these_have_no_radius():
    row = [Disc(acb(3 * i), arb(1.6)) for i in range(3)] + [Disc(acb(50), arb(1))]
    assert [len(group) for group in groups(row)] == [3, 1]
    far = arb("inf")
    row = [
        Disc(acb(1), far),
        Disc(acb(1 + 2.0**-31), far),
        Disc(acb(1 + 2.0**-20), far),
        Disc(acb(3), arb(1.5)),
    ]
    assert [len(group) for group in groups(row)] == [2, 1, 1]
    assert groups(row)[0] == (row[0], row[1])


def monic(*roots):
    product = acb_poly([1])
    for root in roots:
        product *= acb_poly([-acb(root), 1])
    return LevelPolynomial.of(product)


def nothing(centre):
    return arb(0)


def test_a_guess_where_the_slope_vanishes_is_left_unproved():
    disc = monic(1, -1).polish(acb(0), nothing)
    assert (disc.centre, disc.radius.is_finite()) == (acb(0), False)


def test_pairs_are_those_whose_exact_distance_is_not_more_than_both_radii():
    random = Random(5)
    numbers = [
        (random.randrange(-64, 65), random.randrange(-64, 65), random.randrange(1, 24)) for _ in range(40)
    ]
    numbers += [(0, 0, 100), (300, 400, 400), (3, 4, 3), (6, 8, 2)]
    discs = [Disc(acb(x, y) / 8, arb(r) / 8) for x, y, r in numbers]
    expected = [
        (i, j)
        for (i, a), (j, b) in combinations(enumerate(numbers), 2)
        if (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 <= (a[2] + b[2]) ** 2
    ]
    assert overlapping_pairs(discs) == expected
    # Groups are what these pairs connect.
    found = connected(discs)
    assert sorted(i for group in found for i in group) == list(range(len(discs)))
    for i, j in combinations(range(len(discs)), 2):
        together = any(i in group and j in group for group in found)
        reached = {i}
        while more := {b for a, b in [*expected, *((b, a) for a, b in expected)] if a in reached} - reached:
            reached |= more
        assert together is (j in reached)


def test_pellets_disc_holds_exactly_as_many_roots_as_asked_for():
    for scale in [1, 1e-12, 1e9]:
        for count in [1, 2, 3]:
            near = [Fraction(1, 2) + Fraction(k, 10**7) for k in range(count)]
            others = [Fraction(4), Fraction(-3), Fraction(5)]
            with precision(300):
                exact = [acb(arb(r.numerator) / r.denominator * scale) for r in near + others]
                disc = monic(*exact).surround((exact[0] * (1 + arb(10) ** -9)).mid(), count)
                assert disc.count == count, scale
                assert [bool(abs(root - disc.centre) < disc.radius) for root in exact] == [True] * count + [
                    False
                ] * 3, scale
                assert disc.radius < abs(exact[0]) * 1e-3, (scale, count)
                assert disc.is_real, (scale, count)


def test_pellets_disc_off_the_real_axis_stays_there():
    with precision(200):
        disc = monic(acb(1, 2), acb(1, 2) + acb(1e-9), acb(1, -2), acb(1, -2) + acb(1e-9)).surround(
            acb(1, 2), 2
        )
    assert (disc.count, disc.is_real, float(disc.centre.imag.mid())) == (2, False, 2)


def test_pellets_disc_leaves_the_third_of_three_close_roots_out_or_gives_up():
    with precision(200):
        roots = [acb(1), acb(1 + arb(10) ** -9), acb(1 + 2 * arb(10) ** -9)]
        disc = monic(*roots).surround(acb(1), 2)
        assert [bool(abs(root - disc.centre) < disc.radius) for root in roots] == [True, True, False]
    with precision(200):
        # The second derivative of s^3 - s vanishes in the middle of the three.
        assert monic(1, 0, -1).surround(acb(0), 2) is None


def test_roots_are_listed_in_the_closed_upper_half_plane_if_they_separate():
    found = propose_by_durand_kerner(acb_poly([-25, 19, 5, 1]))
    assert sorted((round(float(r.real), 6), round(float(r.imag), 6)) for r in found) == [(-3, 4), (1, 0)]
    assert found[0].imag == 0
    assert propose_by_durand_kerner(acb_poly([1, -2, 1])) is None
    # No real polynomial: i and 2i have no mirror images.
    assert propose_by_durand_kerner(acb_poly([-2, acb(0, -3), 1])) is None


def test_pellets_disc_is_for_every_polynomial_in_the_balls_of_its_coefficients():
    for wide in [1e-4, 1e-20]:
        # s^2 - c with abs(c) up to a small number, whose root is the distance.
        with precision(200):
            level = LevelPolynomial.of(acb_poly([acb(arb(0, wide)), 0, 1, arb("0.001")]))
            disc = level.surround(acb(0), 2)
            assert disc.radius >= arb(wide).sqrt()
            assert disc.radius < 3 * arb(wide).sqrt()
