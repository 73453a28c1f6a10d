"""Gains and frequencies at which ``s^2 + 4 + m(K) s`` vanishes on the axis: at 2 rad/s, where m(K) = 0."""

from dataclasses import dataclass
from itertools import pairwise

import pytest
from flint import acb, arb, arb_series

from symflex.loops import two_unknowns
from symflex.loops.two_unknowns import DEEPEST, SHORT, GainTree, PartsAlong, find_axis_points, left


@dataclass(frozen=True)
class Oscillator:
    """The parts s^2 + 4 and s, with their slopes."""

    def parts_around(self, s, bits):
        def at(s):
            return [(s * s + 4, 2 * s), (s, acb(1))]

        return at(s), at(s.mid())


def tree(function, low, high):
    """Return a range of gains with the weights 1 and a function of the gain."""
    return GainTree(
        lambda gain: [arb_series([1], 2), function(arb_series([gain, 1], 2))], (arb(low), arb(high))
    )


def found(function, low, high, limits):
    points = find_axis_points(Oscillator(), tree(function, low, high), limits, 15)
    assert not points.undecided
    for omega, gain in points.proved:
        assert omega.rel_accuracy_bits() > 50
        assert omega.contains(2)
        assert gain.rel_accuracy_bits() > 50
    return sorted(float(gain) for _, gain in points.proved)


@pytest.mark.parametrize(
    ("limits", "gains"),
    [
        ((0.5, 4.1), [1, 3]),
        ((1.6, 2.5), [1, 3]),  # 2 = 1.6*1.25 is the end of two intervals: it counts once
        ((0.5, 1.9), []),
        ((2.1, 9.0), []),
    ],
)
def test_two_gains_at_one_frequency_are_two_points(limits, gains):
    assert found(lambda gain: (gain - 1) * (gain - 3), 0, 5, limits) == pytest.approx(gains)


def test_gains_outside_of_the_range_are_no_points():
    assert found(lambda gain: (gain - 1) * (gain - 3), 1.5, 5, (0.5, 4.1)) == pytest.approx([3])
    assert found(lambda gain: (gain - 1) * (gain - 3), 1.5, 2.5, (0.5, 4.1)) == []


def test_a_gain_at_which_a_boundary_turns_back_is_undecided():
    # (K - 2)^2 vanishes twice at 2: no Newton step proves a single root.
    points = find_axis_points(
        Oscillator(), tree(lambda gain: (gain - 2) * (gain - 2), 0.5, 5), (1.5, 2.6), 15
    )
    assert points is None or (not points.proved and points.undecided)


def test_pieces_of_gains_that_are_left_hold_every_gain_at_which_a_sum_vanishes():
    # -2 + K^2 at one frequency vanishes at sqrt(2) and for no other K > 0.
    own = tree(lambda gain: gain * gain, 0, 4)
    pieces = left([own], PartsAlong([acb(-2), acb(1)]))
    assert any(piece.gain.contains(arb(2).sqrt()) for piece in pieces)
    assert all(piece.depth == DEEPEST for piece in pieces)
    assert all(abs(piece.gain - arb(2).sqrt()) < 1e-14 for piece in pieces)
    # Where the frequency is known to 1 % only, gains between sqrt(1.96) and sqrt(2.04) may belong to it.
    pieces = left([own], PartsAlong([acb(-2), acb(1)], [acb(1), acb(0)], acb(arb(0, 0.04))))
    ends = [float(x) for piece in pieces for x in piece.ends]
    assert ends == sorted(ends)
    assert 1.38 < ends[0] <= 1.96**0.5
    assert 2.04**0.5 <= ends[-1] < 1.45
    assert all(one.ends[1] == other.ends[0] for one, other in pairwise(pieces))
    assert left([own], PartsAlong([acb(-17), acb(1)])) == []
    assert left([own], PartsAlong([acb(-2, 1), acb(1)])) == []


def test_sums_reach_as_far_as_values_at_the_ends_of_a_piece():
    # K^2 is 0 and 16 at the ends, and K^2 s is -16 j and 16 j where s is -j and j.
    own = tree(lambda gain: gain * gain, 0, 4)
    across_gains, _ = own.sums(PartsAlong([acb(0), acb(1)]))
    assert across_gains.contains(acb(0))
    assert across_gains.contains(acb(16))
    over_both, _ = own.sums(PartsAlong([acb(0), acb(0)], [acb(0), acb(1)], acb(0, arb(0, 1))))
    assert over_both.contains(acb(0, 16))
    assert over_both.contains(acb(0, -16))
    assert left([own], PartsAlong([acb(-16), acb(1)]))


def test_pieces_are_short_where_weights_have_no_bound():
    assert {piece.depth for piece in tree(lambda gain: gain, 0, 4).pieces} == {SHORT}
    pieces = tree(lambda gain: arb_series([gain[0].log(), 1 / gain[0]], 2), 0, 4).pieces
    assert [piece.depth for piece in pieces] == [DEEPEST, *range(DEEPEST, SHORT, -1), *[SHORT] * 63]
    assert all(one.ends[1] == other.ends[0] for one, other in pairwise(pieces))
    assert (pieces[0].ends[0], pieces[-1].ends[1]) == (0, 4)


def test_a_search_ends_where_it_would_look_at_too_many_pieces(monkeypatch):
    # Every gain belongs to a sum that is 0.
    monkeypatch.setattr(two_unknowns, "MOST_BOXES", 16)
    pieces = left([tree(lambda gain: gain, 0, 4)], PartsAlong([acb(0), acb(0, arb(0, 1e-9))]))
    assert len(pieces) in (17, 18)
    assert (pieces[0].ends[0], pieces[-1].ends[1]) == (0, 4)
    assert all(one.ends[1] == other.ends[0] for one, other in pairwise(pieces))
    monkeypatch.setattr(two_unknowns, "MOST_INTERVALS", 3)
    assert find_axis_points(Oscillator(), tree(lambda gain: gain - 1, 0, 5), (0.5, 4.1), 15) is None
