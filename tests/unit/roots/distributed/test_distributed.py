"""Poles and zeros of distributed systems, against characteristic equations solved by mpmath."""

from __future__ import annotations

import cmath
import json
import re
from fractions import Fraction

import mpmath
import pytest
from mpmath import cos, cosh, findroot, mp, mpc, mpf, pi, sin, sinh, sqrt, tan

from symflex import pipeline
from symflex.errors import BudgetError
from symflex.roots import Band, Budget, Everything, Modes, Rectangle
from symflex.roots.counting import winding
from symflex.roots.locate import locate
from tests.unit.roots.distributed_models import (
    DELAY_LOOP,
    FREE,
    KELVIN_VOIGT,
    LINE,
    ON_A_FOUNDATION,
    PINNED_IN_THE_MIDDLE,
    ROD,
    SLIDING_FREE,
    bound,
)

DIGITS = 50


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS + 15):
        yield


def found(text, region, number=0, digits=DIGITS):
    return pipeline.roots(bound(text, number), region, digits)


def upper(roots):
    """Return the roots with im >= 0 as numbers of mpmath, without those at 0."""
    printed = [root.decimal(DIGITS) for root in roots if not root.is_zero]
    return [mpc(p.re, p.im) for p in printed if not p.im.startswith("-")]


def agree(computed, expected, digits=DIGITS - 1):
    assert len(computed) == len(expected)
    for one, other in zip(computed, expected, strict=True):
        assert abs(one - other) <= mpf(10) ** -digits * abs(other)


def test_poles_of_the_sliding_free_beam_solve_sinh_2q_plus_sin_2q():
    # On the axis, with s = j x^2: tan x + tanh x = 0.
    x = [findroot(lambda x: tan(x) + mpmath.tanh(x), (n - mpf(1) / 4) * pi) for n in range(1, 6)]
    agree(upper(found(SLIDING_FREE, Modes(5)).poles), [mpc(0, each**2) for each in x])


def test_these_poles_are_roots_of_the_equation_as_the_source_prints_it():
    for s in upper(found(SLIDING_FREE, Modes(5)).poles):
        q = sqrt(s / 2)
        assert abs(sinh(2 * q) + sin(2 * q)) < mpf(10) ** -(DIGITS - 8) * abs(sinh(2 * q))


def test_colocated_zeros_of_the_sliding_free_beam_solve_2_plus_cosh_2q_plus_cos_2q():
    # The actuator held: clamped-free, cos x cosh x = -1 with s = j x^2.
    x = [findroot(lambda x: cos(x) + 1 / cosh(x), (n - mpf(1) / 2) * pi) for n in range(1, 6)]
    zeros = upper(found(SLIDING_FREE, Modes(5)).zeros)
    agree(zeros, [mpc(0, each**2) for each in x])
    q = sqrt(zeros[2] / 2)
    assert abs(2 + cosh(2 * q) + cos(2 * q)) < mpf(10) ** -(DIGITS - 8) * abs(cosh(2 * q))


def test_tip_zeros_of_the_sliding_free_beam_are_real_pairs_where_cos_q_cosh_q_vanishes():
    # q = (n - 1/2) pi, s = +-2 q^2.
    expected = [sign * 2 * ((n - mpf(1) / 2) * pi) ** 2 for n in (1, 2, 3) for sign in (-1, 1)]
    zeros = found(SLIDING_FREE, Modes(3), 1).zeros
    agree(upper(zeros), expected)
    assert all(root.is_real for root in zeros)


def test_undamped_poles_lie_exactly_on_the_axis():
    assert all(
        root.on_imaginary_axis and root.damping_ratio() in (0.0, None) for root in found(FREE, Modes(5)).poles
    )


def test_both_members_of_each_pair_are_listed_by_frequency():
    poles = found(SLIDING_FREE, Modes(3), digits=12).poles
    assert [(root.im > 0, root.im < 0) for root in poles] == [
        (False, False),
        *[(True, False), (False, True)] * 3,
    ]


def test_a_rod_with_a_tip_mass_solves_x_tan_x_equals_mu():
    x = [findroot(lambda x: x * tan(x) - 2, n * pi + 1 / (n + mpf(1))) for n in range(4)]
    agree(upper(found(ROD, Modes(4)).poles), [mpc(0, each) for each in x])


@pytest.mark.slow
def test_poles_of_a_kelvin_voigt_beam_solve_a_quadratic_per_mode():
    omega = [(n * pi) ** 2 for n in range(1, 5)]
    eta = mpf("0.004")
    expected = [-eta * w**2 / 2 + mpc(0, w * sqrt(1 - (eta * w / 2) ** 2)) for w in omega]
    agree(upper(found(KELVIN_VOIGT, Modes(4)).poles), expected)


@pytest.mark.slow
def test_overdamped_poles_of_a_kelvin_voigt_beam_are_found_outside_the_neighbourhood_left_out():
    region = Rectangle(Fraction(-1000), Fraction(-255), Fraction(-1), Fraction(1))
    eta, expected = mpf("0.004"), []
    for n in range(1, 60):
        w = (n * pi) ** 2
        if eta * w > 2:
            both = [-eta * w**2 / 2 * (1 + sign * sqrt(1 - 4 / (eta * w) ** 2)) for sign in (1, -1)]
            expected += [s for s in both if -1000 < s < -262.5]
    result = found(KELVIN_VOIGT, region)
    agree(sorted(s.real for s in upper(result.poles) if s.real < -262.5), sorted(expected))


def test_the_point_where_kelvin_voigt_poles_accumulate_is_left_out_and_said():
    region = Rectangle(Fraction(-1000), Fraction(0), Fraction(-100), Fraction(100))
    (part,) = found(KELVIN_VOIGT, region, digits=12).excluded
    # A rectangle of 5 % each way in ln(s), and the disc that holds it.
    assert (part.re, part.im) == pytest.approx((-250, 0))
    assert part.radius == pytest.approx(250 * abs(cmath.exp(0.05 + 0.05j) - 1))


def test_nothing_is_left_out_of_a_region_far_from_the_accumulation():
    assert found(KELVIN_VOIGT, Modes(3), digits=12).excluded == ()


def test_poles_of_a_delay_loop_are_branches_of_lambert_s_function():
    expected = sorted((2 * mpmath.lambertw(-1, k) for k in range(4)), key=abs)
    agree(upper(found(DELAY_LOOP, Modes(4)).poles), expected)


def test_a_delay_loop_has_no_zeros_but_those_of_its_polynomials():
    assert found(DELAY_LOOP, Modes(4)).zeros == ()


def test_the_middle_of_a_symmetric_beam_hides_every_other_mode():
    # Pinned-pinned: s = j (n pi)^2; the middle is a node of the even modes.
    result = found(PINNED_IN_THE_MIDDLE, Modes(3))
    agree(upper(result.poles), [mpc(0, (n * pi) ** 2) for n in (1, 3, 5)])
    agree(upper([h.root for h in result.hidden]), [mpc(0, (n * pi) ** 2) for n in (2, 4)])


def test_a_free_beam_has_a_double_pole_at_the_origin():
    (root,) = [root for root in found(FREE, Modes(2)).poles if root.is_zero]
    assert root.multiplicity == 2


def test_the_lowest_modes_come_without_those_at_the_origin_being_counted():
    assert len(upper(found(FREE, Modes(2)).poles)) == 2


def test_a_band_holds_what_lies_between_its_limits():
    # x^2/(2 pi) of the sliding-free beam: 0.89, 4.81, 11.87 Hz.
    poles = found(SLIDING_FREE, Band(Fraction(1), Fraction(12)), digits=12).poles
    assert [f"{root.frequency_hz():.2f}" for root in poles] == ["4.81", "4.81", "11.88", "11.88"]


def test_a_rectangle_holds_one_of_a_pair():
    poles = found(
        SLIDING_FREE, Rectangle(Fraction(-1), Fraction(1), Fraction(2), Fraction(10)), digits=12
    ).poles
    assert [root.im > 0 for root in poles] == [True]


def test_everything_becomes_five_modes_and_is_said():
    result = found(SLIDING_FREE, Everything(), digits=12)
    assert (result.region, result.is_default_region) == (Modes(5), True)


def test_the_model_says_how_many_modes_are_shown_by_default():
    result = found(SLIDING_FREE + "[analysis]\nmodes = 2\n", None, digits=12)
    assert (result.region, len(upper(result.poles))) == (Modes(2), 2)


@pytest.mark.slow
def test_the_model_s_band_is_the_default_without_modes():
    result = found(SLIDING_FREE + '[analysis]\nband = ["1 Hz", "12 Hz"]\n', None, digits=12)
    assert result.region == Band(Fraction(1), Fraction(12))


def test_everything_is_certified():
    document = json.loads(json.dumps(found(SLIDING_FREE, Modes(2), digits=12).to_json_dict()))
    assert document["certified"]
    assert all(root["certified"] for root in (*document["poles"], *document["zeros"]))


def test_radii_hold_the_error():
    x = [findroot(lambda x: tan(x) + mpmath.tanh(x), (n - mpf(1) / 4) * pi) for n in range(1, 6)]
    poles = [root for root in found(SLIDING_FREE, Modes(5), digits=15).poles if root.im > 0]
    for root, expected in zip(poles, x, strict=True):
        printed = root.decimal(15)
        assert abs(mpf(printed.im) - expected**2) <= mpf(printed.radius)


def test_a_root_counted_twice_has_its_multiplicity():
    # Two equal sliding-free beams in a row of signals: every pole is double.
    text = (
        SLIDING_FREE.replace('V_tip = "s*q"', 'V_tip = "s*q"\nboth = "y"')
        .replace(
            "[inputs]",
            f"""
arm_2   = {{ type = "beam", between = ["p_2", "q_2"], {'E = "E", I = "I", rho = "rho", A = "A"'}, l = "l" }}
slide_2 = {{ type = "slider", at = "p_2" }}
push    = {{ type = "force_source", at = "p_2", f = "p*k" }}
[signals]
y = "p_2"
[inputs]""",
        )
        .replace('l   = "1 m"', 'l   = "1 m"\nk = "1 N/m"')
    )
    poles = [root for root in found(text, Modes(4), 2, digits=20).poles if root.im > 0]
    assert [root.multiplicity for root in poles] == [2, 2]


def test_a_search_beyond_its_budget_says_what_it_found(monkeypatch):
    monkeypatch.setattr(winding, "WORK_LIMIT", 12_000)
    result = found(DELAY_LOOP, Modes(30), digits=12)
    expected = sorted((2 * mpmath.lambertw(-1, k) for k in range(31)), key=abs)
    poles = upper(result.poles)
    agree(poles, expected[: len(poles)], 11)
    assert 0 < len(poles) < 30
    assert result.certificate.is_exceeded
    assert not result.certificate.certified
    assert re.search(r"takes too long; \d+ modes were found up to .* Hz", result.certificate.reason)


def test_no_time_is_said_to_be_over_and_keeps_what_was_found():
    times = iter([0.0] * 400 + [10.0] * 100_000)
    region = Modes(30)
    result = locate(bound(DELAY_LOOP), region, 12, Budget(5, clock=lambda: next(times)))
    assert result.certificate.is_exceeded
    assert "the time given is over" in result.certificate.reason


def test_a_million_modes_are_refused_at_once():
    with pytest.raises(BudgetError, match="SF505"):
        found(SLIDING_FREE, Modes(10**6))


def test_a_wavenumber_that_vanishes_is_no_mode():
    # 1/(2 s^2 + g coth g) with g^2 = s^2 + 1; from the second pole on g = j h.
    g = findroot(lambda g: 2 * (g * g - 1) * sinh(g) + g * cosh(g), 0.6)
    h = [findroot(lambda h: 2 * (h * h + 1) * sin(h) - h * cos(h), guess) for guess in (3.3, 6.4)]
    expected = [mpc(0, sqrt(1 - g**2)), *(mpc(0, sqrt(1 + each**2)) for each in h)]
    result = found(ON_A_FOUNDATION, Modes(3))
    agree(upper(result.poles), expected)
    assert result.hidden == ()


def test_what_a_polynomial_and_a_vanishing_wavenumber_share_is_no_mode():
    # y/u = (s + 1) tanh(g)/g with g^2 = (s + 1)(s + 3): poles where g^2 = -((n - 1/2) pi)^2.
    result = found(LINE, Modes(2))
    expected = [-2 + mpc(0, sqrt(((n - mpf(1) / 2) * pi) ** 2 - 1)) for n in (1, 2)]
    agree(upper(result.poles), expected)
    assert result.hidden == ()
