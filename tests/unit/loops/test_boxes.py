"""Boxes about ``s^2 + b s + 1 + c``, which has a root on the axis where b = 0; and geometry of sums."""

from fractions import Fraction
from itertools import pairwise, product
from math import inf

import pytest
from flint import acb, arb

from symflex.loops.boxes import share_taken
from symflex.loops.over import characteristic
from symflex.pipeline import loads


def function(*names, of=None):
    parameters = "".join(f'parameters.{n} = {{ value = 0.1, assume = "real" }}\n' for n in names)
    of = of or f"1/(s^2 + b*s + 1{' + c' if 'c' in names else ''})"
    model = loads(f'symflex = 1\n{parameters}signals.y = "{of}*r"\ninputs.r = {{}}\noutputs.Y = "y"')
    return characteristic(model, names, ((Fraction(-1), Fraction(1)),) * len(names))


def box(*ends):
    return tuple((Fraction(low), Fraction(high)) for low, high in ends)


def test_values_and_slopes_are_those_in_the_middle_and_reach_every_corner():
    first = function("b", "c").expanded(box((-1, 3), (0, 1)))
    # b = 1 and c = 1/2: s^2 + s + 3/2 at 2j; slopes s and 1, half ranges 2 and 1/2.
    ((value, slopes),) = first.at(acb(0, 2), [0])
    assert value == acb(-2.5, 2)
    assert slopes == [acb(0, 2), acb(1)]
    ((value, swings),) = first.swings(acb(0, 2), [0], first.generators(acb(0, 2)))
    assert (value, swings) == (acb(-2.5, 2), [acb(0, 4), acb(0.5)])
    ((values, slopes),) = first.around(acb(0, arb(2, 0.5)), [0])
    for omega, b, c in product((1.5, 2.5), (-1, 3), (0, 1)):
        assert values.contains(acb(1 + c - omega**2, b * omega))
        assert slopes.contains(acb(b, 2 * omega))


def test_a_range_from_0_reaches_from_0_to_its_end():
    # b s at 2j for b from 0 to 4, which is not negative
    ((value, _),) = function("b").expanded(box((0, 4))).around(acb(0, 2), [0])
    assert value.contains(acb(-3))
    assert value.contains(acb(-3, 8))
    assert value.imag.lower() > -1e-6


def test_the_axis_is_covered_up_to_where_no_root_lies():
    whole = function("b").whole(box((-1, 1)))
    (pieces,) = whole.pieces
    assert 1 <= whole.radius < 4  # all roots have the size 1
    assert (pieces[0][0], pieces[-1][1]) == (0, whole.radius)
    assert all(one[1] == other[0] for one, other in pairwise(pieces))


@pytest.mark.parametrize("ends", [(0, "1/10"), ("-1/10", 0), ("-1/100", "1/100"), (0, 1), (-1, 1)])
def test_a_root_at_an_end_of_a_box_is_kept(ends):
    own = function("b")
    left = own.narrowed(own.whole(box(ends)))
    held = [i for i, (low, high) in enumerate(left.pieces[0]) if low <= 1 <= high]
    assert held
    low, high = box(ends)[0]
    at = -(low + high) / (high - low)  # where b = 0 is between the ends, from -1 to 1
    for i in held if left.lines else ():
        middle, half = left.lines[i]
        assert (middle + half * arb(at.numerator) / at.denominator).contains(0)


def test_a_real_pole_is_at_0_where_the_line_of_its_piece_is():
    # s + b = 0 on the axis for b = 0 alone: b/(j) has the imaginary part -b.
    own = function("b", of="1/(s + b)")
    left = own.narrowed(own.whole(box(("-1/100", "3/100"))))
    assert left.pieces == (((0, 0),),)
    ((middle, half),) = left.lines
    assert middle.overlaps(arb("-0.01"))
    assert half.overlaps(arb("-0.02"))


def test_boxes_without_a_root_are_decided():
    own = function("b")
    for ends in ((1, 2), ("1/2", 1), (-1, "-1/2")):
        assert own.narrowed(own.whole(box(ends))).pieces == ((),)


def test_pieces_reach_as_far_as_roots_do_and_boxes_are_halved_across_what_moves_these():
    own = function("b", "c")
    left = own.narrowed(own.whole(box(("-1/100", "1/100"), ("-1/10", "1/10"))))
    (pieces,) = left.pieces
    assert 0.94 < pieces[0][0] <= 0.9**0.5
    assert 1.1**0.5 <= pieces[-1][1] < 1.06
    assert all(one[1] == other[0] for one, other in pairwise(pieces))
    b, c = left.weights
    assert b < 0.1 < c
    halves = [half.box for half in own.halves(left)]
    assert halves == [
        box(("-1/100", "1/100"), ("-1/10", 0)),
        box(("-1/100", "1/100"), (0, "1/10")),
    ]
    # On the axis b alone turns values across that: the line has no part of c.
    for _, of_b, of_c in left.lines:
        assert abs(of_b) > 0.004
        assert abs(of_c) < 1e-3


def test_a_box_about_which_nothing_is_known_is_halved_across_its_relatively_widest_range():
    own = function("b", "c")
    halves = own.halves(own.whole(box((1, 3), (1, 2))))
    assert [half.box for half in halves] == [box((1, 2), (1, 2)), box((2, 3), (1, 2))]
    # What stands beside the highest power counts twice: 2/3 is more than 1/2.
    own = function("b", "c", of="1/(c*s^2 + b*s + 1)")
    halves = own.halves(own.whole(box((1, 3), (1, 2))))
    assert [half.box for half in halves] == [box((1, 3), (1, "3/2")), box((1, 3), ("3/2", 2))]


def test_a_half_in_which_the_highest_power_does_not_vanish_is_bounded():
    own = function("b", of="1/(b*s^2 + s + 1)")
    whole = own.whole(box((-1, 3)))
    assert not whole.is_bounded
    one, other = own.halves(whole)
    assert not one.is_bounded
    assert other.is_bounded
    assert other.pieces[0]


def test_poles_and_zeros_have_functions_of_their_own():
    own = function("b", of="(s^2 + b)/(s^2 + b*s + 1)")
    at = {"zero": acb(-3.5), "pole": acb(-3, 1)}  # at s = 2j for b = 1/2
    for kind, value in at.items():
        first = own.of_roots(kind).expanded(box(("1/2", "1/2")))
        assert [each for each, _ in first.at(acb(0, 2), [0])] == [value]
    assert function("b").of_roots("zero").whole(box((0, 1))).radius == 0


def test_what_a_root_of_a_parameter_moves_depends_on_it_and_on_nothing_else():
    own = function("b", "c", of="c/(s^2 + sqrt(b)*s + 1)")
    assert own.depends_on("b")
    assert not own.depends_on("c")


def test_slopes_go_through_roots_of_a_parameter():
    # b sqrt(b) s changes by 3/2 sqrt(b) s: 6j for b = 4 at s = 2j.
    first = function("b", of="1/(s^2 + b*sqrt(b)*s + 1)").expanded(box((4, 4)))
    ((value, (slope,)),) = first.at(acb(0, 2), [0])
    assert value.overlaps(acb(-3, 16))
    assert slope.overlaps(acb(0, 6))
    assert slope.rad() < 1e-12


@pytest.mark.parametrize(("low", "count"), [(1, 1), (-1, 2)])
def test_hidden_poles_are_followed_where_energy_does_not_keep_them_on_the_left(low, count):
    model = loads("""
        symflex = 1
        parameters = { m = 1, k = 4, d = 0.5 }
        inputs.F = { force = "x" }
        outputs.X = "x"
        [elements]
        seen = { type = "mass", at = "x", m = "m" }
        wall = { type = "spring", between = ["x", "ground"], k = "k" }
        loss = { type = "damper", between = ["x", "ground"], b = "d" }
        hidden = { type = "mass", at = "y", m = "2*m" }
        other = { type = "spring", between = ["y", "ground"], k = "3*k" }
        """)
    assert len(characteristic(model, ("k",), box((low, 9))).factors) == count


@pytest.mark.parametrize(
    ("centre", "terms", "share", "parts"),
    [
        (3, [1, 1], 2 / 3, [1 / 3, 1 / 3]),
        (3, [1, -1], 2 / 3, [1 / 3, 1 / 3]),
        (1j, [0.5j], 0.5, [0.5]),
        # A square about 1.1 + 0.5 j has an edge at 0.1; towards its middle it takes 1.6 of 1.46.
        (1.1 + 0.5j, [1, 1j], 1 / 1.1, [1 / 1.1, 0]),
        (0.5 + 1.1j, [1, 1j], 1 / 1.1, [0, 1 / 1.1]),
        (1 + 1j, [0.5 + 0.5j], 0.5, [0.5]),
        (2 + 1j, [1 + 1j], 0, [0]),  # beside 0
        (0, [1], inf, [1]),
        # Balls count with the end that is worst.
        (2, [arb(0.5, 0.25)], 0.375, [0.375]),
        (arb(2, 0.5), [0.75], 0.5, [0.5]),
    ],
)
def test_terms_take_away_the_share_that_the_best_direction_shows(centre, terms, share, parts):
    found, own = share_taken(acb(centre), [acb(x) for x in terms])
    assert found == pytest.approx(share, rel=1e-8, abs=1e-12)
    assert own == pytest.approx(parts, rel=1e-8)


def test_terms_that_just_reach_0_take_all_away():
    for centre, terms in ((2, [1, 1]), (1 + 0.5j, [1, 1j]), (1, [1, 1j])):
        assert share_taken(acb(centre), [acb(x) for x in terms])[0] >= 1
        assert share_taken(acb(centre) * (1 + 2**-20), [acb(x) for x in terms])[0] < 1
