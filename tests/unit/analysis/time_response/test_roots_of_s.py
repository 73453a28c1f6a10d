"""Responses in time of functions with a root of s, against closed solutions of textbooks."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from flint import arb
from mpmath import erf, erfc, exp, gamma, inf, mpf, nsum, pi, sqrt

from symflex import loads
from symflex.analysis.time_response import time_response
from symflex.analysis.time_response.enclosed_response import response_text
from symflex.analysis.time_response.sample_times import SampleTimes, default_until
from symflex.errors import ModelError

RESPONSES = {
    # Half-infinite solids: Carslaw and Jaeger 1959, sections 2.4, 2.7 and 2.9.
    "u/sqrt(s*k)": ("step", lambda t: 2 * sqrt(t / pi)),
    "sqrt(s*k)*u": ("step", lambda t: 1 / sqrt(pi * t)),
    "exp(-2*sqrt(s*k))*u": ("impulse", lambda t: exp(-1 / t) / sqrt(pi * t**3)),
    "exp(-2*(s*k)^0.5)*u": ("step", lambda t: erfc(1 / sqrt(t))),
    "u/(1 + sqrt(s*k))": ("step", lambda t: 1 - exp(t) * erfc(sqrt(t))),
    "u/(sqrt(s*k) - 2)": ("step", lambda t: (exp(4 * t) * (1 + erf(2 * sqrt(t))) - 1) / 2),
    "u/sqrt(1 + s*k)": ("step", lambda t: erf(sqrt(t))),
    # Fractional orders: Mittag-Leffler's function.
    "u/(1 + (s*k)^0.8)": (
        "step",
        lambda t: 1 - nsum(lambda n: (-(t**0.8)) ** n / gamma(0.8 * n + 1), [0, inf]),
    ),
    "u/(k*s^(1/3))": ("ramp", lambda t: t ** (mpf(4) / 3) / gamma(mpf(7) / 3)),
}

LATE = {
    # Those of textbooks, from t = 1/4 on; the second shift theorem, exp(-a*t) times f is F(s + a).
    "exp(-s/4)*exp(-2*sqrt(s))*u": lambda t: erfc(1 / sqrt(t)),
    "exp(-(s/4 + 2*sqrt(s)))*u": lambda t: erfc(1 / sqrt(t)),
    "exp(-sqrt(s)*(2 + sqrt(s)/4))*u": lambda t: erfc(1 / sqrt(t)),
    "exp(-s/4 - 2*sqrt(s) + 3)*u": lambda t: exp(3) * erfc(1 / sqrt(t)),
    "exp(-(s + k)/4)*exp(-2*sqrt(s))*u": lambda t: exp(-0.25) * erfc(1 / sqrt(t)),
    "exp(-s/4)/sqrt(s + k)*u": lambda t: erf(sqrt(t)),
    "exp(-s/4)/(1 + sqrt(s))*u": lambda t: 1 - exp(t) * erfc(sqrt(t)),
    "exp(-s/4)/s^(1/3)*u": lambda t: t ** (mpf(1) / 3) / gamma(mpf(4) / 3),
}


def function(expression):
    text = f'symflex = 1\nparameters.k = 1\ninputs.u = {{}}\noutputs.y = "{expression}"'
    return loads(text).transfer_function("y", "u").bind()


@pytest.mark.parametrize("expression", RESPONSES)
def test_responses_are_proved_and_those_of_textbooks(expression):
    kind, exact = RESPONSES[expression]
    times = [0.02, 0.3, 4.0]
    response = getattr(function(expression), f"{kind}_response")(times)
    assert response.certified
    with mpmath.workdps(40):
        assert response.values == pytest.approx([float(exact(mpf(t))) for t in times], rel=1e-12, abs=1e-12)


def test_as_many_digits_are_proved_as_are_asked_for():
    (value,) = function("u/sqrt(s*k)").step_response([3.0], digits=60).enclosures
    assert value.overlaps(2 * (3 / arb.pi()).sqrt()) and value.rad() < 1e-59


def test_values_at_the_beginning_are_limits():
    for expression, kind, value in (
        ("(1 + sqrt(s*k))/(1 + 2*sqrt(s*k))*u", "step", 0.5),
        ("exp(-sqrt(s*k))*u", "impulse", 0),
        ("u/sqrt(s*k)", "step", 0),
    ):
        assert getattr(function(expression), f"{kind}_response")([0, 1]).values[0] == value, expression
    with pytest.raises(ModelError, match="infinite at t = 0"):
        function("u/sqrt(s*k)").impulse_response([0, 1])
    with pytest.raises(ModelError, match="not all waves decay"):
        function("u/(1 + sqrt(s) + exp(-s*k))").step_response([1.0])


@pytest.mark.parametrize("expression", LATE)
def test_a_delay_shifts_a_response_with_a_root_of_s(expression):
    response = function(expression).step_response([0.1, 0.25, 0.5, 3.0])
    assert response.certified
    with mpmath.workdps(40):
        exact = [0, 0, *(float(LATE[expression](mpf(t) - 0.25)) for t in (0.5, 3.0))]
    assert response.values == pytest.approx(exact, rel=1e-12, abs=1e-12)


def test_a_response_at_the_very_moment_of_a_delay_prints():
    # A long cable with skin effect: erfc(a/(2*sqrt(t - T))) from T = 10 ns on, and nearly nothing about T.
    bound = function("exp(-s*1e-8)*exp(-2e-5*sqrt(s*k))*u").bound
    response = time_response(bound, "step", SampleTimes.evenly(Fraction(3, 10**8), 4))
    with mpmath.workdps(40):
        exact = [0, 0, *(erfc(mpf("1e-5") / sqrt(mpf(t))) for t in ("1e-8", "2e-8"))]
    assert response.values == pytest.approx(list(map(float, exact)), rel=1e-12, abs=1e-12)
    assert "2e-08  0.887537083982" in response_text(response)
    assert default_until(bound) == pytest.approx(5e-8)  # five times the delay, and a^2 = 0.4 ns is less


def test_terms_of_a_sum_with_a_root_of_s_come_each_after_its_own_delay():
    response = function("exp(-s*0.3)*exp(-2*sqrt(s))*u + exp(-s)*u/sqrt(s*k)").step_response([0.2, 0.8, 2.3])
    with mpmath.workdps(40):
        exact = [0, erfc(1 / sqrt(mpf(0.8) - mpf("0.3"))), erfc(1 / sqrt(2)) + 2 * sqrt(mpf(2.3 - 1) / pi)]
        assert response.values == pytest.approx(list(map(float, exact)), rel=1e-12, abs=1e-12)


def test_the_value_at_the_moment_of_a_delay_has_what_comes_before_and_after():
    # (1 + sqrt(s))/(1 + 2*sqrt(s)) jumps from 0 to 1/2, the limit of s*F/s. 0.3 is no binary number.
    for expression, limit in (("(1 + sqrt(s*k))/(1 + 2*sqrt(s*k))", 0.5), ("exp(-sqrt(s*k))", 0)):
        bound = function(f"exp(-s*0.3)*{expression}*u").bound
        response = time_response(bound, "step", SampleTimes.evenly(Fraction(6, 10), 3))
        at = response.enclosures[1]
        assert at.contains(0) and at.contains(limit) and (limit or at.rad() < 1e-12), expression
        assert response.enclosures[2].rad() < 1e-12


def test_an_oscillator_with_a_fractional_damper_rings_as_its_pole_and_its_branch_cut_say():
    # s^2 + 0.02 s^1.5 + 100: residues, and the jump across the cut (Rossikhin and Shitikova 1997).
    with mpmath.workdps(30):
        pole = mpmath.findroot(below := lambda s: s**2 + s ** mpf(1.5) / 50 + 100, mpmath.mpc(-0.05, 10))
        residue = 1 / (pole * (2 * pole + 3 * sqrt(pole) / 100))
        cut = mpmath.quad(lambda x: exp(-10 * x) * mpmath.im(1 / below(-x)) / (pi * x), [0, 1, 10, 100, 1000])
        value = 2 * mpmath.re(residue * exp(pole * 10)) + mpf(1) / 100 + cut
        found = function("u/(s^2 + 0.02*k*s^1.5 + 100)").step_response([10.0]).values[0]
        assert found == pytest.approx(float(value), rel=1e-12)


def test_a_rod_with_a_half_infinite_end_agrees_with_talbots_inversion():
    text = """symflex = 1
inputs.u = {}
outputs.Y = "T(0.5)"
fields.T.domain = [0, 1]
fields.T.equation = "T'' = s*T"
fields.T.conditions = ["T(0) = u", "T'(1) = -sqrt(s)/3*T(1)"]
"""

    def step(s):
        at = [mpmath.cosh(sqrt(s) * x) + mpmath.sinh(sqrt(s) * x) / 3 for x in (mpf(1) / 2, 1)]
        return at[0] / at[1] / s

    with mpmath.workdps(30):
        expected = [float(mpmath.invertlaplace(step, t, method="talbot")) for t in (0.1, 1.0)]
    response = loads(text).transfer_function("Y", "u").bind().step_response([0.1, 1.0])
    assert response.certified
    assert response.values == pytest.approx(expected, rel=1e-11)
