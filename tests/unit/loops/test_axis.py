"""Roots of real functions on the axis, and parts of a loop next to s = 0, of polynomials known by hand."""

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.loops.axis import LoopAtOrigin, ball_of, find_on_axis, halves, joined, pieces
from symflex.roots.counting.local_series import LocalSeries


def roots_of(value, slope, limits=(0.5, 8.0), *, is_excluded=lambda ball: False, most=2000):
    """Return roots and undecided intervals of a function that is given with its derivative."""
    found = find_on_axis(
        lambda ball, bits: (ball, ball.mid()), lambda w: (value(w), slope(w)), is_excluded, limits, 15, most
    )
    return [float(w) for w in sorted(found.roots, key=float)], found.undecided


def test_each_root_at_which_the_sign_changes_is_found_once():
    def cubic(w):
        return (w - 2) * (w - 5) * (w + 1)

    def slope(w):
        return 3 * w * w - 12 * w + 3

    found, undecided = roots_of(cubic, slope)
    assert (found, undecided) == (pytest.approx([2, 5], abs=1e-14), ())
    assert roots_of(cubic, slope, (0.5, 1.9)) == roots_of(cubic, slope, (5.1, 8.0)) == ([], ())
    apart, undecided = roots_of(cubic, slope, is_excluded=lambda ball: bool(ball < 4))
    assert (apart, undecided) == (pytest.approx([5], abs=1e-14), ())


def test_where_a_function_touches_zero_or_is_zero_at_an_end_nothing_is_decided():
    for value, slope, at in (
        (lambda w: (w - 2) ** 2, lambda w: 2 * (w - 2), 2),
        (lambda w: w - arb(0.5), lambda w: arb(1), 0.5),
        (lambda w: w - 8, lambda w: arb(1), 8),
    ):
        found, (undecided,) = roots_of(value, slope)
        assert found == [] and undecided.contains(at) and undecided.rad() < 1e-6
    # 1e-20 above zero no root is possible.
    assert roots_of(lambda w: (w - 2) ** 2 + arb("1e-20"), lambda w: 2 * (w - 2)) == ([], ())


def test_pieces_meet_and_neighbours_are_joined():
    parts = pieces(1.0, 10.0, 2.0)
    assert parts == [(1, 2), (2, 4), (4, 8), (8, 10)] and pieces(3.0, 3.0, 2.0) == []
    (one, other), ends = halves((1.0, 3.0)), (1.0, 3.0)
    assert (one[0], one[1], other[1]) == (ends[0], other[0], ends[1]) and one[0] < one[1] < other[1]
    assert halves((1.0, 1.0)) == []
    for low, high in pairwise([0.1, 0.7, 1e9]):
        assert ball_of((low, high)).contains(low) and ball_of((low, high)).contains(high)
    whole, apart = joined([ball_of((1.0, 2.0)), ball_of((2.0, 3.0)), ball_of((4.0, 5.0))])
    assert whole.contains(1) and whole.contains(3) and whole < apart


def at_origin(*parts, orders=(0, 0), ratio=None, bound=0.0):
    """Return two polynomials in s by their coefficients, bounded on a circle of 10 rad/s."""
    coefficients = [tuple(acb(c) for c in [*part, *[0] * (6 - len(part))]) for part in parts]
    series = tuple(LocalSeries(acb(0), c, arb(10), arb(bound)) for c in coefficients)
    return LoopAtOrigin(orders, series, ratio, acb(0, 1))


RISING, FALLING = (1, 2, 3), (4, 1)  # abs(A)^2 = 1 - 2 w^2 + 9 w^4, abs(B)^2 = 16 + w^2


def test_the_gain_at_rest_is_minus_the_ratio_of_the_lowest_terms():
    assert float(at_origin(RISING, FALLING).gain()) == -1 / 4
    assert at_origin((0, 2), FALLING, orders=(1, 0)).gain() == 0
    assert at_origin(RISING, (0, 2), orders=(0, 1)).gain() is None
    assert float(at_origin((0, 6), (0, 2), orders=(1, 1)).gain()) == -3


def test_what_a_series_lacks_is_as_much_as_cauchy_allows():
    # Coefficients beyond the sixth of at most M/10^n: at 2 rad/s they add up to M (1/5)^6/(1 - 1/5).
    loop = at_origin((0, 7), (1,), orders=(1, 0), bound=3.0)
    for size, order in zip(loop.sizes(arb(2)), (1, 0), strict=True):
        rest = 3 * 0.2 ** (6 - order) / 0.8 / 10**order
        assert rest * (1 - 1e-15) < float(size.imag.rad()) < rest * (1 + 1e-6)
        assert size.contains(7 if order else 1)


def test_the_turn_of_one_part_against_the_other_is_known_up_to_where_it_ends():
    # Im((1 + s + s^3) * 1) = w - w^3, and Im(s (1 + s^2) conj(1 + s)) = w (1 - w^2).
    for loop in (at_origin((1, 1, 0, 1), (1,)), at_origin((0, 1, 0, 1), (1, 1), orders=(1, 0))):
        assert loop.turns_away(arb(0.99)) and not loop.turns_away(arb(1.01))
    assert not at_origin((1, 0, 1), (2, 0, 1)).turns_away(arb(0.1))  # both real


def test_parts_beside_the_axis_are_those_of_the_loop():
    # Real parts, and imaginary ones over omega, of A and B over the power of s that both have.
    for loop, values in (
        (at_origin(RISING, FALLING), ((-11, 2), (4, 1))),
        (at_origin((0, 5, 1), (7, 1), orders=(1, 0)), ((-4, 5), (7, 1))),  # 5 s + s^2
        (at_origin((0, 5, 1), (0, 0, 3), orders=(1, 2)), ((5, 1), (0, 3))),  # 5 + s, 3 s
    ):
        for found, (real, slope) in zip(loop.beside(arb(2)), values, strict=True):
            assert complex(found) == pytest.approx(complex(real, slope))


def test_a_loop_gain_leaves_one_where_its_excess_has_no_root():
    loop = at_origin(RISING, FALLING, ratio=Fraction(1, 4))
    rest, curvature = loop.excess(arb(1) / 4, arb(0.5))
    assert rest == 0 and curvature.contains(-2 - 1 / 16) and curvature.contains(-2 - 1 / 16 + 9 / 4)
    # -33/16 + 9 w^2 vanishes at 0.479.
    for gain, radius, leaves in ((1, 0.47, True), (-1, 0.47, True), (1, 0.48, False), (2, 0.1, False)):
        assert loop.leaves_one(Fraction(gain, 4), arb(radius)) is leaves
    assert not at_origin(RISING, FALLING).leaves_one(Fraction(1, 4), arb(0.1))


@pytest.mark.parametrize(
    ("parts", "orders", "level", "radius", "side"),
    [
        (((0, 2), (1,)), (1, 0), 3, 1.49, -1),  # abs(A/B) = 2 w
        (((0, 2), (1,)), (1, 0), 3, 1.51, 0),
        (((1,), (0, 2)), (0, 1), 3, 0.166, 1),  # 1/(2 w)
        (((1,), (0, 2)), (0, 1), 3, 0.167, 0),
        ((RISING, FALLING), (0, 0), 0.2499, 0.005, 1),
        ((RISING, FALLING), (0, 0), 0.2501, 0.3, -1),
        ((RISING, FALLING), (0, 0), 0.2501, 1.0, 0),
        ((RISING, FALLING), (0, 0), 0.25, 0.3, 0),
    ],
)
def test_a_loop_gain_is_above_or_below_a_level_next_to_zero(parts, orders, level, radius, side):
    with precision(100):
        assert at_origin(*parts, orders=orders).side(arb(level), arb(radius)) == side


def test_frequencies_on_which_nothing_can_be_said_do_not_leave_the_others_unseen():
    hidden = arb(1).union(1.1)

    def value(w):
        return arb(0, 1) if w.overlaps(hidden) else w - 6

    found, (undecided,) = roots_of(value, lambda w: arb(0, 1) if w.overlaps(hidden) else arb(1), most=200)
    assert found == [pytest.approx(6)]
    assert undecided.contains(arb(1.05)) and undecided.rad() < 0.2
