"""Signs of real parts, and the least one, of rational functions and of functions with delays."""

from math import cos, pi, sin

import pytest
from flint import arb

from symflex import pipeline
from symflex.contact.real_part import _WavePart, least_part, real_part


def bound(formula):
    text = f'symflex = 1\n[inputs]\nu = {{}}\n[outputs]\ny = "({formula})*u"\n'
    (function,) = pipeline.derive_bound(pipeline.loads(text), [("y", "u")])
    return function


def ends(formula):
    found = real_part(bound(formula), 12)
    return [(float(b.low.mid()), b.high and float(b.high.mid())) for b in found.active], found.reasons


def test_an_all_pass_is_negative_above_its_corner():
    assert ends("(1 - s)/(1 + s)") == ([(1.0, None)], ())


def test_a_root_of_even_order_touches_zero():
    # Re(s^2 + 1)/(s^2 + s + 1) = (1 - x)^2/((1 - x)^2 + x), x = omega^2, zero at 1 rad/s alone.
    assert ends("(s^2 + 1)/(s^2 + s + 1)") == ([], ())


def test_what_only_stores_is_zero_everywhere():
    assert real_part(bound("s/(s^2 + 4) + 3/s"), 12).is_zero


def test_the_least_part_is_where_the_slope_vanishes():
    # Re 1/(s^2 + s + 1) = (1 - x)/((1 - x)^2 + x), x = omega^2: least at x = 2, where it is -1/3.
    least = least_part(bound("1/(s^2 + s + 1)"), (), 15)
    assert float(least.value.mid()) == pytest.approx(-1 / 3, abs=1e-15)
    assert float(least.omega.mid()) == pytest.approx(2**0.5)


def test_a_pole_on_the_axis_makes_it_fall_without_end():
    # Re 1/(s (s^2 + 1) (s + 1)) changes its sign through infinity at 1 rad/s.
    least = least_part(bound("1/((s^2 + 1)*(s + 1))"), (), 12)
    assert not least.value.is_finite()


def test_a_delay_turns_the_sign_again_and_again_beyond_what_is_known():
    # Re exp(-j omega)/(1 + j omega) = (cos(omega) - omega sin(omega))/(1 + omega^2).
    found, reasons = ends("exp(-s)/(s + 1)")
    assert reasons
    first, second = found[0]
    for omega in (first, second):
        assert cos(omega) - omega * sin(omega) == pytest.approx(0, abs=1e-9)
    assert first == pytest.approx(
        0.8603335890193797
    )  # omega tan(omega) = 1 (Abramowitz & Stegun, table 4.20)


def test_the_sign_beyond_is_that_of_the_term_that_outweighs_the_others():
    assert ends("1 + exp(-s)/2") == ([], ())
    assert ends("-1 + exp(-s)/2") == ([(0.0, None)], ())


def test_the_least_part_with_a_delay_is_enclosed():
    # Re(1/2 + exp(-j omega)) is -1/2 at pi; asked for in the band about it.
    function = bound("0.5 + exp(-s)/(1 + s/1000)")
    least = least_part(function, real_part(function, 12).active[:1], 12)
    value = lambda w: 0.5 + (cos(w) - w / 1000 * sin(w)) / (1 + w * w / 1e6)  # noqa: E731
    assert float(least.value.mid()) == pytest.approx(
        min(value(pi + k / 1e5) for k in range(-2000, 2000)), abs=1e-9
    )


def test_no_band_reaches_into_frequencies_that_are_open():
    search = _WavePart(bound("-1 + exp(-s)/2"), 12)
    found = search._between((), (arb(2).union(4),), (1.0, 10.0), 0, [], is_open_below=True)
    bands = [(float(b.low.mid()), float(b.high.mid())) for b in found.active]
    assert bands == [pytest.approx((1, 2)), pytest.approx((4, 10))]
    assert found.reasons == ("the real part between 0.31831 and 0.63662 Hz",)


@pytest.mark.parametrize(
    ("formula", "omega", "exact"),
    [
        ("1 + 40*exp(-s/20)/s", 0, -1),  # 1 - 40 sin(omega/20)/omega
        ("1 - 3*exp(-s)/(1 + s/2)^2", 0, -2),
        # numpy on a grid of 1e-9 rad/s about 0.7282906
        ("1 - 3*exp(-s)*(1 + 2*s)/(1 + s/2)^2", 0.7282906, -3.19845421044828),
    ],
)
def test_the_least_part_of_a_band_from_0_on_is_at_its_end_or_inside(formula, omega, exact):
    function = bound(formula)
    active = real_part(function, 12).active
    least = least_part(function, active, 12)
    assert active[0].low == 0
    assert abs(float(least.value.mid()) - exact) < 1e-12 and least.value.rad() < 1e-12
    assert abs(float(least.omega.mid()) - omega) < 1e-6
    if not omega:
        assert least.value.contains(exact) and least.omega.contains(0)
