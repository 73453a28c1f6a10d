"""Gains that enter by roots, logarithms, powers, quotients, definitions, or at which models degenerate.

With ``f(K)`` in place of a gain, ``1/(s + 1)^4`` is stable for -1 < f < 4 and ``1/(s + 1)^3`` for -1 < f < 8
(Routh); so boundaries are inverses of f, which mpmath has.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from mpmath import asinh, atanh, e, exp, findroot, inf, lambertw, log, mpc, mpf, sqrt

import symflex


def loop(function, order=4, value=2, definitions=None, **more):
    """Return a loop about equal lags whose gain is a function of K."""
    return symflex.Model(
        parameters={"K": {"value": value, "assume": "positive" if value > 0 else "real"}, **more},
        definitions=definitions or {},
        signals={"y": f"({function})*(r - y)/(s + 1)^{order}"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )


NESTED = {"a": "K^2", "b": "sqrt(1 + a)", "c": "b/2"}
CASES = [
    ("sqrt(K)", {}, [(0, 16)]),
    ("sqrt(2*K)", {"order": 3}, [(0, 32)]),
    ("sqrt(K*m)", {"m": 8}, [(0, 2)]),
    ("2*zeta*sqrt(K/m) + K", {"m": {"value": 4}, "zeta": {"value": 1}}, [(0, ((sqrt(17) - 1) / 2) ** 2)]),
    ("sqrt(sqrt(K))", {}, [(0, 256)]),
    ("K*sqrt(K)", {}, [(0, mpf(4) ** (mpf(2) / 3))]),
    ("K^2 + K^3", {"order": 3}, [(0, np.roots([1, 1, 0, -8])[-1].real)]),
    ("1/K", {}, [(0.25, inf)]),
    ("10*K/(1 + K)", {}, [(0, mpf(2) / 3)]),
    ("K*log(K)", {}, [(0, exp(lambertw(4).real))]),
    ("log(1 + K)", {}, [(0, e**4 - 1)]),
    ("exp(K/3) - 1", {}, [(0, 3 * log(5))]),
    ("10*exp(-K)", {}, [(log(mpf(5) / 2), 200)]),
    ("5*tanh(K)", {}, [(0, atanh(mpf(4) / 5))]),
    ("sinh(K)", {}, [(0, asinh(4))]),
    ("b", {"definitions": NESTED}, [(0, sqrt(15))]),
    ("c*c", {"definitions": NESTED}, [(0, sqrt(15))]),
    ("sqrt(20 - K)", {"value": 5}, [(4, 20)]),
    ("sqrt(-K)", {"value": -2}, [(-16, 0)]),
    (
        "16*log(K)/K",
        {},
        [
            (16 * lambertw(mpf(1) / 16).real, -4 * lambertw(-mpf(1) / 4).real),
            (-4 * lambertw(-mpf(1) / 4, -1).real, 200),
        ],
    ),
]


@pytest.mark.parametrize(("function", "more", "expected"), CASES)
def test_a_loop_is_stable_where_the_function_of_its_gain_is(function, more, expected):
    found = loop(function, **more).stability("K")
    assert found.certified
    assert len(found.stable) == len(expected)
    for (low, high), (lowest, highest) in zip(found.stable, expected, strict=True):
        assert low == pytest.approx(float(lowest), abs=1e-9)
        assert high == pytest.approx(float(highest), rel=1e-12)


def test_damping_that_follows_the_root_of_a_stiffness_follows_it_as_the_gain_varies():
    # By Routh 1.4 sqrt(K) > 0.49 K + K for m = 1 kg, zeta = 0.7, T_f = 0.5 s.
    model = symflex.loads("""
symflex = 1
[parameters]
m = "1 kg"
zeta = 0.7
K = { value = "2 N/m" }
T_f = "0.5 s"
[definitions]
b = "2*zeta*sqrt(K*m)"
[elements]
a = { type = "mass", at = "x", m = "m" }
f = { type = "force_source", at = "x", f = "(K + b*s)*(r - x)/(1 + T_f*s)^2" }
[inputs]
r = { unit = "m" }
[outputs]
X = "x"
""")
    found = model.stability("K")
    assert found.certified
    assert found.is_stable is False
    ((low, high),) = found.stable
    assert (low, high) == (0, pytest.approx((1.4 / 1.49) ** 2, rel=1e-14))
    # The frequency at which they cross: omega^2 = 1.4 sqrt(K), from the coefficient of s of the polynomial.
    assert found.boundaries[0].frequencies_hz[0] == pytest.approx(
        np.sqrt(1.4 * 1.4 / 1.49) / (2 * np.pi), rel=1e-12
    )


def test_with_another_value_of_a_parameter_beside_the_gain_no_bound_is_needed():
    # Poles depend on K/m alone.
    model = symflex.loads("""
symflex = 1
[parameters]
K = "2 N/m"
m = "1 kg"
[elements]
a = { type = "mass", at = "x", m = "m" }
k = { type = "spring", between = ["x", "ground"], k = "K" }
b = { type = "damper", between = ["x", "ground"], b = "1.4*sqrt(K*m)" }
f = { type = "force_source", at = "x", f = "3*K*(r - x)/(1 + 0.5*s)^2" }
[inputs]
r = { unit = "m" }
[outputs]
X = "x"
""")
    one, three = (model.stability("K", m=m) for m in (1, 3))
    assert one.proved.limits == three.proved.limits == (0, None)
    for small, large in zip(one.boundaries, three.boundaries, strict=True):
        assert float(large.gain) == pytest.approx(3 * float(small.gain), rel=1e-13)


def test_a_function_that_only_touches_its_limit_is_not_certified():
    # 4 sin(K) is 4 at pi/2, and less beside it.
    found = loop("4*sin(K)", value=1).stability("K", limits=(0, 3))
    assert not found.certified
    assert found.reasons == ("it could not be decided whether poles touch the axis near a gain of 1.5708",)


@pytest.mark.parametrize("value", [1, -1])
def test_at_a_gain_for_which_there_is_no_solution_nothing_is_stable(value):
    model = symflex.Model(
        parameters={"K": {"value": value, "assume": "real"}},
        signals={"y": "K*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K")
    assert found.stable == ((-inf, -1), (-1, inf))
    assert "no solution" in str(found)
    assert found.is_stable is (True if value == 1 else None)


@pytest.mark.parametrize("value", [1, 2, -3])
def test_a_gain_whose_own_value_lowers_the_order_is_no_obstacle(value):
    # (1 - K)(s + 1) + K^2: the pole is -1 - K^2/(1 - K), on the left for K < 1.
    model = symflex.Model(
        parameters={"K": {"value": value, "assume": "real"}},
        signals={"y": "K^2*(r - y)/(s + 1) + K*y"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K")
    assert found.stable == ((-inf, 1),)
    assert found.proved.nominal == Fraction(value)


CHANNELS = """
symflex = 1
[parameters]
K = "0.8 1/s"
w = "0.5 1/s"
T = "1 s"
[equations]
unknowns = ["x", "y"]
equations = ["s*x = K*exp(-s*T)*(r - x) + w*y", "s*y = -K*exp(-s*T)*y - w*x"]
[inputs]
r = {}
[outputs]
X = "x"
"""


def test_one_gain_of_two_channels_with_a_delay_has_two_boundaries_at_one_frequency():
    # s + K exp(-s T) = -+ j w: at omega T = pi/2 poles cross for K = pi/2 - w and for K = pi/2 + w.
    found = symflex.loads(CHANNELS).stability("K", (0, 4))
    assert found.certified
    gains = [float(boundary.gain) for boundary in found.boundaries]
    assert gains == [pytest.approx(np.pi / 2 + w, rel=1e-14) for w in (-0.5, 0.5)]
    assert [b.entering for b in found.boundaries] == [2, 2]


@pytest.mark.parametrize(
    ("function", "highest"),
    [("K^2", np.sqrt(np.pi)), ("sqrt(K)", np.pi**2), ("exp(K) - 1", np.log(1 + np.pi))],
)
def test_with_a_delay_an_integrator_is_stable_up_to_pi_over_twice_the_time(function, highest):
    # s + f(K) exp(-s T) with T = 0.5 s: f < pi.
    model = symflex.Model(
        parameters={"K": {"value": 1}, "T": "0.5 s", "tau": "1 s"},
        signals={"y": f"({function})*exp(-s*T)*(r - y)/(tau*s)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    found = model.stability("K", (0, 1.2 * highest))
    assert found.certified
    assert float(found.stable[0][1]) == pytest.approx(highest, rel=1e-12)


@pytest.mark.slow
def test_a_search_that_takes_too_long_says_that_a_narrower_range_may_do_and_it_does():
    # s + 3 sqrt(K) exp(-s T) + 0.3 K s exp(-2 s T): the slope of the root has no bound next to K = 0.
    model = symflex.Model(
        parameters={"K": {"value": 2}, "T": "0.1 s", "w": "3 rad/s"},
        signals={"y": "(w*sqrt(K)*exp(-s*T)/s + 0.3*K*exp(-2*s*T))*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
    )
    wide, narrow = (model.stability("K", limits) for limits in ((0, 3), (0.5, 3)))
    assert not wide.certified
    assert wide.proved.reasons[0].endswith("; give a narrower --range")

    def on_axis(gain, omega):
        s = mpc(0, omega)
        value = s + 3 * sqrt(gain) * exp(-s / 10) + mpf("0.3") * gain * s * exp(-s / 5)
        return value.real, value.imag

    gain, _ = findroot(on_axis, (2.3, 10))
    assert narrow.certified
    assert float(narrow.stable[0][1]) == pytest.approx(float(gain), rel=1e-12)
