"""Certified discs: what they claim and what they refuse."""

from fractions import Fraction

from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.roots.polynomials.discs import Disc, LevelPolynomial, complete, overlapping_pairs, with_mirrors


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


def monic(*roots):
    product = acb_poly([1])
    for root in roots:
        product *= acb_poly([-acb(root), 1])
    return LevelPolynomial.of(product)


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


def test_pellets_disc_is_for_every_polynomial_in_the_balls_of_its_coefficients():
    for wide in [1e-4, 1e-20]:
        # s^2 - c with abs(c) up to a small number, whose root is the distance.
        with precision(200):
            level = LevelPolynomial.of(acb_poly([acb(arb(0, wide)), 0, 1, arb("0.001")]))
            disc = level.surround(acb(0), 2)
            assert disc.radius >= arb(wide).sqrt()
            assert disc.radius < 3 * arb(wide).sqrt()
