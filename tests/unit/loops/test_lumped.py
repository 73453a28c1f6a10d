"""Where polynomials in s and a gain have roots on the imaginary axis, and how many lie right of it."""

from __future__ import annotations

from fractions import Fraction
from math import exp, sqrt
from types import SimpleNamespace

import pytest
from flint import arb

from symflex import pipeline
from symflex.algebra import Factored, Ring
from symflex.balls import precision
from symflex.loops.loop import GainPolynomial, characteristic_loop
from symflex.loops.lumped import LumpedFactor
from symflex.loops.stability_map import PoleCount

RING = Ring(("s", "c"))


def factor(*by_gain, multiplicity=1, constants=()):
    """Return the factor of a polynomial whose coefficients of K^0, K^1, ... are given as text in s and c."""
    s, c = (Factored.generator(RING, n) for n in RING.names)

    def read(terms):
        total = Factored.number(RING, 0)
        for number, power, *of_c in terms:
            total = total + Factored.number(RING, number) * s**power * c ** (of_c[0] if of_c else 0)
        return total

    bound = SimpleNamespace(radicals=None, constants=constants, ratio=SimpleNamespace(ring=RING))
    return LumpedFactor.of(bound, GainPolynomial(tuple(read(t) for t in by_gain), multiplicity))


def crossings(of):
    """Return gain, frequencies and what kind of crossing, in order of the gain."""
    found = [
        (
            pytest.approx(float(c.gain), abs=1e-9),
            [pytest.approx(float(w), abs=1e-9) for w in c.frequencies],
            c.is_infinite,
            c.is_symmetric,
        )
        for c in of.crossings(12)
    ]
    return sorted(found, key=lambda c: c[0].expected)


def count(of, gain):
    return of.count(Fraction(gain))


# (s + 1)^3 + K: by Routh 1 + K > 0 and 3 * 3 > 1 + K.
THIRD = ([(1, 3), (3, 2), (3, 1), (1, 0)], [(1, 0)])


def test_three_equal_lags_cross_at_eight_and_through_zero_at_minus_one():
    assert crossings(factor(*THIRD)) == [(-1, [0], False, False), (8, [sqrt(3)], False, False)]


def test_three_equal_lags_have_poles_on_the_right_beyond_their_crossings():
    for gain, right in [(-2, 1), (0, 0), ("15/2", 0), ("17/2", 2), (1000, 2)]:
        for multiplicity in [1, 2]:
            found = count(factor(*THIRD, multiplicity=multiplicity), gain)
            assert found == PoleCount(right * multiplicity, 0), (gain, right, multiplicity)


# s (s + 1)(s + 2) + K (s + 3): by Routh 3 (2 + K) > 3 K always, and K > 0.
ALWAYS = ([(1, 3), (3, 2), (2, 1)], [(1, 1), (3, 0)])


def test_a_zero_on_the_left_may_keep_a_loop_stable_for_every_gain():
    assert crossings(factor(*ALWAYS)) == [(0, [0], False, False)]
    assert [count(factor(*ALWAYS), k).right for k in (-1, 1, 10**6)] == [1, 0, 0]


# s^2 + K s + 4, whose poles meet the axis at K = 0, and K s^2 + s + 1, one of whose goes through infinity.
def test_poles_cross_where_their_damping_vanishes():
    of = factor([(1, 2), (4, 0)], [(1, 1)])
    assert crossings(of) == [(0, [2], False, False)]
    assert [count(of, k) for k in (-1, 1)] == [PoleCount(2, 0), PoleCount(0, 0)]


def test_a_pole_goes_through_infinity_where_the_highest_power_vanishes():
    of = factor([(1, 1), (1, 0)], [(1, 2)])
    assert crossings(of) == [(0, [], True, False)]
    assert [count(of, k) for k in ("-1/9", "1/9")] == [PoleCount(1, 0), PoleCount(0, 0)]


# K twice: s^2 + (K^2 - 3 K + 2) s + 1 is damped below 1 and above 2.
def test_a_gain_may_stand_in_a_power():
    of = factor([(1, 2), (2, 1), (1, 0)], [(-3, 1)], [(1, 1)])
    assert crossings(of) == [(1, [1], False, False), (2, [1], False, False)]
    assert [count(of, k).right for k in (0, "3/2", 3)] == [0, 2, 0]


# s^3 + K s^2 + K^2 s + 8: E = 8 - K w and O = K^2 - w meet at w = K^2 = 4, as K^3 = 8.
def test_frequencies_belong_to_the_gain_where_both_parts_vanish():
    of = factor([(1, 3), (8, 0)], [(1, 2)], [(1, 1)])
    assert crossings(of) == [(2, [2], False, False)]
    assert [count(of, k).right for k in (1, 3)] == [2, 0]


# Without damping: s^4 + 5 s^2 + K has s^2 = (-5 +- sqrt(25 - 4 K))/2.
LOSSLESS = ([(1, 4), (5, 2)], [(1, 0)])


def test_poles_without_loss_meet_on_the_axis_and_leave_it():
    found = crossings(factor(*LOSSLESS))
    assert (0, [0], False, False) in found
    assert found[-1] == (6.25, [sqrt(2.5)], False, True)


def test_poles_without_loss_are_counted_on_the_axis():
    for gain, right, axis in [(-6, 1, 2), (4, 0, 4), (7, 2, 0)]:
        assert count(factor(*LOSSLESS), gain) == PoleCount(right, axis), (gain, right, axis)


# (s^2 + K)(s + 1): s^2 + K belongs to E and O.
def test_what_both_parts_have_in_common_lies_on_the_axis_for_all_gains_of_one_sign():
    of = factor([(1, 3), (1, 2)], [(1, 1), (1, 0)])
    assert crossings(of) == [(0, [0], False, False)]
    assert [count(of, k) for k in (-4, 4)] == [PoleCount(1, 0), PoleCount(0, 2)]


def test_a_pole_that_stays_at_zero_is_counted_on_the_axis():
    for gain, right in [(-1, 1), (1, 0)]:
        for multiplicity in [1, 3]:
            # s^2 (s + K).
            of = factor([(1, 3)], [(1, 2)], multiplicity=multiplicity)
            assert count(of, gain) == PoleCount(right * multiplicity, 2 * multiplicity), (
                gain,
                right,
                multiplicity,
            )


def test_without_the_gain_nothing_crosses():
    assert crossings(factor([(1, 2), (1, 1), (1, 0)], [(0, 0)])) == []


def test_numbers_that_are_symbols_count_with_their_value():
    # s^2 + (K - c) s + 1 with c = sqrt(2).
    of = factor([(1, 2), (-1, 1, 1), (1, 0)], [(1, 1)], constants=(("c", lambda: arb(2).sqrt()),))
    assert crossings(of) == [(sqrt(2), [1], False, False)]
    assert [count(of, k).right for k in ("7/5", "3/2")] == [2, 0]
    with precision(100):
        (only,) = of.crossings(20)
        assert only.gain.overlaps(arb(2).sqrt())


def test_a_number_below_is_cleared_too():
    # s^2 + (K - 1/c) s + 1 with c = 1/sqrt(2).
    of = factor([(1, 2), (-1, 1, -1), (1, 0)], [(1, 1)], constants=(("c", lambda: 1 / arb(2).sqrt()),))
    assert crossings(of) == [(sqrt(2), [1], False, False)]


def test_fractions_are_cleared():
    # s^2/4 + (K - 1/3) s/7 + 1.
    of = factor([(Fraction(1, 4), 2), (Fraction(-1, 21), 1), (1, 0)], [(Fraction(1, 7), 1)])
    assert crossings(of) == [(1 / 3, [2], False, False)]


# E and O are (w - 1)(w - 4) and K^2 - w^2, or the other way round: they meet at (1, +-1) and (4, +-4).
@pytest.mark.parametrize("is_swapped", [False, True])
def test_a_frequency_at_which_one_part_alone_vanishes_belongs_to_another_gain(is_swapped):
    squares, gains = [(1, 4), (5, 2), (4, 0)], [(-1, 4)]  # as powers of s
    even, odd = (gains, squares) if is_swapped else (squares, gains)
    of = factor([*even, *((n, p + 1) for n, p in odd)], [], [(1, 0 if is_swapped else 1)])
    found = [c for c in crossings(of) if c[1] != [0]]
    assert found == [(k, [sqrt(abs(k))], False, False) for k in (-4, -1, 1, 4)]


def test_roots_that_mirror_each_other_off_the_axis_have_no_frequency():
    # (s^2 - 1)(s + 1) + log(K) - 1: E and O vanish together at K = e, where s^2 = 1.
    text = """symflex = 1
parameters.K = { value = 2, assume = "positive" }
signals.y = "(log(K) - 1)*(r - y)/((s^2 - 1)*(s + 1))"
inputs.r = {}
outputs.Y = "y"
"""
    model = pipeline.loads(text)
    (tf,) = pipeline.derive_all(model)
    loop = characteristic_loop(tf, model.parameters[0])
    (of,) = (LumpedFactor.of(loop.bound, f, loop, (Fraction(1, 10), Fraction(50))) for f in loop.with_gain)
    at_zero, beside = sorted(of.crossings(12), key=lambda c: -len(c.frequencies))
    assert float(at_zero.gain) == pytest.approx(exp(2)) and at_zero.frequencies == (0,)
    assert float(beside.gain) == pytest.approx(exp(1)) and beside.frequencies == ()
