"""How far functions and their roots are apart, against functions of first order, written by hand."""

from math import exp, inf, pi

import pytest
from flint import acb, arb

from symflex import pipeline
from symflex.symbolic.distance import distance, moved_over, roots_of
from symflex.transfer import bind

SMALL = 1e-6


@pytest.mark.parametrize("turned", [0, 1, 3])
@pytest.mark.parametrize("half", [0.1, 0.5, 0.6])
def test_the_bound_of_a_moved_root_is_attained_at_a_corner_of_the_box(half, turned):
    # s + e x^20 = 1 + e has its root s = 1 + e - e x^20, and 1 + e without the power. At x = exp(half) they
    # are e exp(20 half) apart, of which the first terms of the series are less than 10 % for half = 0.6.
    power = (0, acb(SMALL), [20])
    # With x^n beside s both roots are divided by x^n.
    whole = [(1, acb(1), [turned]), (0, acb(-1 - SMALL), [0]), power]
    halves = [arb(half), arb(0.99 * half, 0.01 * half)]  # the farthest end of a ball counts
    bounds = [moved_over(whole, [power], acb(1), [each]) for each in halves]
    moved = SMALL * exp(20 * half)
    least = moved / (1 + SMALL - moved) * (1 - 1e-12)
    assert all(least < bound < 1.01 * least for bound in bounds)


def test_a_root_that_may_vanish_in_the_box_has_no_bound():
    # At half = 0.7 the power is e^14 = 1.2 times 10^6: the root has left for the other side of 0.
    power = (0, acb(SMALL), [20])
    whole = [(1, acb(1), [0]), (0, acb(-1 - SMALL), [0]), power]
    assert moved_over(whole, [power], acb(1), [arb(0.7)]) == inf


def function(output, more=""):
    text = f'symflex = 1\n{more}\nparameters.T = "10 ms"\ninputs.u = {{}}\noutputs.y = "{output}"'
    return bind(*pipeline.derive_all(pipeline.loads(text)))


def test_what_is_said_of_a_lag_that_was_left_out_ends_where_that_begins_to_show():
    # The quotient is 1 + j w T: 10 % off at w T = 0.1, and 1 dB at w T = sqrt(10^0.1 - 1) = 0.5088.
    before, after = function("u/((s + 1)*(T*s + 1))"), function("u/(s + 1.0001)")
    found = distance(before, after, roots_of(before, after), [0.1])
    facts = found.facts
    hertz = 1 / (2 * pi * 0.01)
    low, high = facts["band_hz"]
    assert (low, high) == (pytest.approx(0.1 / (2 * pi)), pytest.approx(10 * hertz))
    assert 0.998 * 0.1 * hertz < facts["within_10_percent_to_hz"] < 0.1 * hertz
    ((begin, end),) = facts["within_1_db_hz"]
    assert begin == low
    assert 0.998 * 0.5088 * hertz < end < 0.5089 * hertz
    (excepted,) = facts["excepted"]
    assert excepted == {"band_hz": [end, high], "poles_hz": [pytest.approx(hertz)], "zeros_hz": []}
    poles = {"displacement": pytest.approx(1e-4), "spread": None, "compared": 1, "lost": 1}
    assert facts["poles"] == poles
    assert facts["zeros"] == {"displacement": 0, "spread": None, "compared": 0, "lost": 0}
    assert found.said == (
        "poles up to 159.2 Hz: 1 moved by at most 0.011 %, 1 without a counterpart",  # 0.01 %, rounded up
        f"error at most 10 %: 0.01592 to {facts['within_10_percent_to_hz']:.4g} Hz",
        f"magnitude within 1 dB: 0.01592 to {end:.4g} Hz",
        f"except {end:.4g} to 159.2 Hz, poles at 15.92 Hz",
    )


def test_roots_beside_an_excepted_part_are_named_with_it():
    # Of 1 + j w T what is beyond 8.098 Hz is excepted, up to the end of the band, 20 Hz. Poles that both have
    # are named up to 5 % beside: 8.098/1.04 and 20*1.04, not 8.098/1.06 and 20*1.06, nor a zero at 1 Hz.
    near = [8.098 / 1.06, 8.098 / 1.04, 20 * 1.04, 20 * 1.06]
    common = "*".join(f"(s + {2 * pi * f:.12g})" for f in near)
    band = 'analysis.band = ["0.5 Hz", "20 Hz"]'
    above = f"u*(s + {2 * pi:.12g})"
    before, after = (function(f"{above}/({common}{lag})", band) for lag in ("*(T*s + 1)", ""))
    facts = distance(before, after, roots_of(before, after)).facts
    (excepted,) = facts["excepted"]
    assert excepted["band_hz"] == [pytest.approx(8.098, rel=2e-3), 20]
    assert excepted["poles_hz"] == [pytest.approx(f) for f in (near[1], 1 / (2 * pi * 0.01), near[2])]
    assert excepted["zeros_hz"] == []
    assert facts["zeros"]["compared"] == 1 and facts["zeros"]["displacement"] < 1e-12


@pytest.mark.parametrize("shift", [0.49, 0.51])
def test_a_root_that_moved_by_half_of_itself_is_another_one(shift):
    before, after = function("u/(s + 1)"), function(f"u/(s + {1 + shift})")
    poles = distance(before, after, roots_of(before, after)).facts["poles"]
    assert (poles["compared"], poles["lost"]) == ((1, 0) if shift < 0.5 else (0, 1))
    assert poles["displacement"] == (pytest.approx(shift) if shift < 0.5 else 0)


def test_the_declared_band_is_compared():
    lag = function("u/(T*s + 1)", 'analysis.band = ["2 Hz", "5 Hz"]')
    assert distance(lag, lag, roots_of(lag, lag)).facts["band_hz"] == [2, 5]


def test_what_is_known_of_roots_over_a_spread_is_said_beside():
    lag = function("u*(s + 3)/(T*s + 1)")
    poles, zeros, *_ = distance(lag, lag, roots_of(lag, lag), (), (0.02, inf)).said
    assert poles == "poles up to 159.2 Hz: 1 unchanged, over the spread by 2 %"
    assert zeros == "zeros up to 159.2 Hz: 1 unchanged, over the spread not bounded"


def test_a_delay_that_was_left_out_shows_from_the_frequency_at_which_it_turns_the_phase():
    # |exp(j w T) - 1| = 2 sin(w T/2) is 0.05 at w T = 0.0500052.
    before, after = function("u*exp(-s*T)/(s + 1)"), function("u/(s + 1)")
    facts = distance(before, after, roots_of(after, after), [0.05]).facts
    assert facts["within_1_db_hz"] == [facts["band_hz"]]
    assert facts["band_hz"] == [pytest.approx(0.1 / (2 * pi)), pytest.approx(10 / (2 * pi))]
    least = 0.0500052 / (2 * pi * 0.01)
    assert 0.998 * least < facts["within_5_percent_to_hz"] < least
    assert facts["excepted"] == []
