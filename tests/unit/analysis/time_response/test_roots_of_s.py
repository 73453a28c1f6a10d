"""Responses in time of functions with a root of s, against closed solutions of textbooks."""

import mpmath
import pytest
from mpmath import erf, erfc, exp, gamma, mpf, nsum, pi, sqrt

from symflex import loads
from symflex.errors import ModelError


def mittag_leffler(a, z):
    return nsum(lambda n: z**n / gamma(a * n + 1), [0, mpmath.inf])


def line(t):
    """Return the end of a diffusive line with an open end (Carslaw and Jaeger 1959, section 3.4)."""
    return 1 - 4 / pi * nsum(
        lambda n: (-1) ** int(n) / (2 * n + 1) * exp(-(((2 * n + 1) * pi / 2) ** 2) * t), [0, mpmath.inf]
    )


RESPONSES = {
    # Half-infinite solids: Carslaw and Jaeger 1959, sections 2.4, 2.7 and 2.9.
    "the surface in a step of heat": ("u/sqrt(s*k)", "step", lambda t: 2 * sqrt(t / pi)),
    "the surface in a ramp of heat": ("u/sqrt(s*k)", "ramp", lambda t: 4 * t**1.5 / (3 * sqrt(pi))),
    "heat into a surface that is suddenly hot": ("sqrt(s*k)*u", "step", lambda t: 1 / sqrt(pi * t)),
    "the inside": ("exp(-2*sqrt(s*k))*u", "step", lambda t: erfc(1 / sqrt(t))),
    "the inside after an impulse": (
        "exp(-2*sqrt(s*k))*u",
        "impulse",
        lambda t: exp(-1 / t) / sqrt(pi * t**3),
    ),
    "the surface beside a fluid": ("u/(1 + sqrt(s*k))", "step", lambda t: 1 - exp(t) * erfc(sqrt(t))),
    "one over a root with a branch point": ("u/sqrt(1 + s*k)", "step", lambda t: erf(sqrt(t))),
    "a Cole-Cole element": (
        "u/(1 + (s*k)^0.8)",
        "step",
        lambda t: 1 - mittag_leffler(mpf("0.8"), -(t ** mpf("0.8"))),
    ),
    "a third": ("u/(k*s^(1/3))", "step", lambda t: t ** (mpf(1) / 3) / gamma(mpf(4) / 3)),
    "a pole to the right": (
        "u/(sqrt(s*k) - 2)",
        "step",
        lambda t: (exp(4 * t) * (1 + erf(2 * sqrt(t))) - 1) / 2,
    ),
    "a diffusive line": ("u/cosh(sqrt(s*k))", "step", line),
}


def function(expression):
    text = f'symflex = 1\nparameters.k = 1\ninputs.u = {{}}\noutputs.y = "{expression}"'
    return loads(text).transfer_function("y", "u").bind()


@pytest.mark.parametrize("name", RESPONSES)
def test_responses_are_proved_and_those_of_textbooks(name):
    expression, kind, exact = RESPONSES[name]
    times = [0.02, 0.3, 4.0]
    response = getattr(function(expression), f"{kind}_response")(times)
    assert response.certified
    with mpmath.workdps(40):
        expected = [exact(mpf(t)) for t in times]
        differences = [
            abs(mpf(y.mid().str(30, radius=False)) - x)
            for y, x in zip(response.enclosures, expected, strict=True)
        ]
        assert max(differences) < max(map(abs, expected)) * mpf(10) ** -12


def test_values_at_the_beginning_are_limits():
    for expression, kind, value in (
        ("(1 + sqrt(s*k))/(1 + 2*sqrt(s*k))*u", "step", 0.5),
        ("exp(-sqrt(s*k))*u", "impulse", 0),
        ("u/sqrt(s*k)", "step", 0),
    ):
        assert getattr(function(expression), f"{kind}_response")([0, 1]).values[0] == value, expression
    with pytest.raises(ModelError, match="infinite at t = 0"):
        function("u/sqrt(s*k)").impulse_response([0, 1])


def test_an_oscillator_with_a_fractional_damper_rings_as_its_pole_and_its_branch_cut_say():
    # s^2 + 0.02 s^1.5 + 100: residues, and the jump across the cut (Rossikhin and Shitikova 1997).
    with mpmath.workdps(30):

        def below(s):
            return s**2 + mpf("0.02") * s ** mpf("1.5") + 100

        pole = mpmath.findroot(below, mpmath.mpc(-0.05, 10))
        residue = 1 / (pole * (2 * pole + mpf("0.03") * sqrt(pole)))
        for t in (0.5, 10.0):
            ringing = 2 * mpmath.re(residue * exp(pole * t)) + mpf(1) / 100
            creep = mpmath.quad(
                lambda x, t=t: exp(-x * t) * mpmath.im(1 / below(-x)) / (pi * x), [0, 1, 10, 100, 1000]
            )
            value = function("u/(s^2 + 0.02*k*s^1.5 + 100)").step_response([t]).values[0]
            assert value == pytest.approx(float(ringing + creep), rel=1e-12)


def test_a_rod_with_a_half_infinite_end_agrees_with_talbots_inversion():
    text = """symflex = 1
inputs.u = {}
outputs.Y = "T(0.5)"
fields.T.domain = ["0", "1"]
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


def test_dead_times_are_refused():
    with pytest.raises(ModelError, match="not all waves decay"):
        function("exp(-s*k)/(1 + sqrt(s))*u").step_response([1.0])
