"""Leading terms at both ends against formulas by hand: statics, and waves that nothing sends back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import mpmath
import pytest
import sympy

import symflex

if TYPE_CHECKING:
    from symflex.symbolic.limits import SymbolicForm

PARAMETERS = """
symflex = 1
[parameters]
m = "2 kg"
M = "3 kg"
k = "8 N/m"
K = "5 N/m"
b = "0.3 N*s/m"
E = "70 GPa"
I = "2e-9 m^4"
rho = "2700 kg/m^3"
A = "1e-4 m^2"
l = "0.5 m"
N = "100 N"
R = "10 Ohm"
L = "2 mH"
C = "3 uF"
T = "0.1 s"
tau = "2 s"
c = "3"
"""
MASS = '[elements]\nbody = { type = "mass", at = "x", m = "m" }\n'
SPRING = 'wall = { type = "spring", between = ["x", "ground"], k = "k" }\n'
DAMPER = 'loss = { type = "damper", between = ["x", "ground"], b = "b" }\n'
TWO = (
    MASS + 'other = { type = "mass", at = "y", m = "M" }\n'
    'link = { type = "spring", between = ["x", "y"], k = "K" }\n'
)
FORCE = '[inputs]\nF = { force = "x" }\n[outputs]\n'
BEAM = (
    '[elements]\narm = { type = "beam", between = ["a", "z"], '
    'E = "E", I = "I", rho = "rho", A = "A", l = "l" }\n'
)
FIXED = 'end = { type = "fixed", at = "a" }\n'
ROD = '[elements]\nbar = { type = "rod", between = ["a", "z"], E = "E", rho = "rho", A = "A", l = "l" }\n'
STRING = (
    "[elements]\n"
    'one = { type = "string", between = ["a", "x"], N = "N", rho = "rho", A = "A", l = "l/4" }\n'
    'two = { type = "string", between = ["x", "z"], N = "N", rho = "rho", A = "A", l = "3*l/4" }\n'
    'left = { type = "fixed", at = "a" }\nright = { type = "fixed", at = "z" }\n'
)
PULL = '[inputs]\nF = { force = "z" }\n[outputs]\n'
SIGNALS = "[inputs]\nu = {}\n[signals]\n"
RLC = (
    '[elements]\nr = { type = "resistor", between = ["p", "q"], R = "R" }\n'
    'i = { type = "inductor", between = ["q", "o"], L = "L" }\n'
    'c = { type = "capacitor", between = ["o", "ground"], C = "C" }\n'
    '[inputs]\nU = { voltage = "p" }\n[outputs]\n'
)
TIP = "sqrt(2)*(E*I)**Rational(-1, 4)*(rho*A)**Rational(-3, 4)"
"""Displacement of the end of a half-infinite beam under a force there, times s^(3/2)."""

CASES = {
    "oscillator": (MASS + SPRING + DAMPER + FORCE + 'y = "x"', "1/k", "1/(m*s**2)"),
    "oscillator's mobility": (MASS + SPRING + DAMPER + FORCE + 'y = "s*x"', "s/k", "1/(m*s)"),
    "free body": (MASS + FORCE + 'y = "x"', "1/(m*s**2)", "1/(m*s**2)"),
    "damped body": (MASS + DAMPER + FORCE + 'y = "x"', "1/(b*s)", "1/(m*s**2)"),
    "two masses": (TWO + FORCE + 'y = "y"', "1/((m + M)*s**2)", "K/(m*M*s**4)"),
    "low pass": (RLC + 'y = "o"', "1", "1/(L*C*s**2)"),
    "current": (RLC + 'y = "(p - q)/R"', "C*s", "1/(L*s)"),
    "rod": (ROD + FIXED + PULL + 'y = "z"', "l/(E*A)", "1/(A*sqrt(E*rho)*s)"),
    "free rod": (ROD + PULL + 'y = "z"', "1/(rho*A*l*s**2)", "1/(A*sqrt(E*rho)*s)"),
    "through a rod": (
        ROD + PULL + 'y = "a"',
        "1/(rho*A*l*s**2)",
        "2*exp(-s*l*sqrt(rho/E))/(A*sqrt(E*rho)*s)",
    ),
    "cantilever": (BEAM + FIXED + PULL + 'y = "z.y"', "l**3/(3*E*I)", TIP + "/s**Rational(3, 2)"),
    "cantilever's speed": (BEAM + FIXED + PULL + 'y = "s*z.y"', "s*l**3/(3*E*I)", TIP + "/sqrt(s)"),
    "cantilever's angle": (
        BEAM + FIXED + PULL + 'y = "z.theta"',
        "l**2/(2*E*I)",
        "1/(sqrt(E*I*rho*A)*s)",
    ),
    "loaded cantilever": (
        BEAM + FIXED + 'load = { type = "mass", at = "z", m = "m" }\n' + PULL + 'y = "z.y"',
        "l**3/(3*E*I)",
        "1/(m*s**2)",
    ),
    "free beam": (BEAM + PULL + 'y = "z.y"', "4/(rho*A*l*s**2)", TIP + "/s**Rational(3, 2)"),
    "pinned and free": (
        BEAM + FIXED.replace("fixed", "pin") + PULL + 'y = "z.y"',
        "3/(rho*A*l*s**2)",
        TIP + "/s**Rational(3, 2)",
    ),
    "string": (STRING + FORCE + 'y = "x"', "3*l/(16*N)", "1/(2*sqrt(N*rho*A)*s)"),
    "loop with a delay": (
        SIGNALS + 'e = "u - y"\ny = "c*e*exp(-s*T)/(tau*s + 1)"\n[outputs]\nout = "y"',
        "c/(1 + c)",
        "c*exp(-s*T)/(tau*s)",
    ),
    "far apart": (SIGNALS + 'y = "u*(s + 1e-12)/(s^2 + 1e6*s)"\n[outputs]\nout = "y"', "1/(10**18*s)", "1/s"),
    "half a power": (SIGNALS + 'y = "u/(c*s + sqrt(s))"\n[outputs]\nout = "y"', "1/sqrt(s)", "1/(c*s)"),
    "thermal bar": (
        SIGNALS + 'y = "u*tanh(sqrt(tau*s))/sqrt(tau*s)"\n[outputs]\nout = "y"',
        "1",
        "1/sqrt(tau*s)",
    ),
    "definitions in each other": (
        SIGNALS + 'y = "u*h/(c*s^2 + s + J)"\n[outputs]\nout = "y"\n'
        '[definitions]\nh = "c/2"\nJ = "c*h^2/(h^2 + m/M) + 2"',
        "c*(c**2 + 4*m/M)/(2*(c**3 + 2*c**2 + 8*m/M))",
        "1/(2*s**2)",
    ),
    "differences of letters": (
        SIGNALS + 'y = "u*(T - tau)*s/((T*s + 1)*(tau*s + 1))"\n[outputs]\nout = "y"',
        "(T - tau)*s",
        "(T - tau)/(T*tau*s)",
    ),
}


def limits_of(text: str) -> SymbolicForm:
    return symflex.loads(PARAMETERS + text).transfer_functions()[0].limits()


@pytest.mark.parametrize("name", CASES)
def test_leading_terms_are_those_found_by_hand(name: str) -> None:
    text, *expected = CASES[name]
    limits = limits_of(text)
    for end, wanted in zip(("s -> 0", "s -> infinity"), expected, strict=True):
        found = limits.expr(end)
        assert found is not None, limits
        names = {x: sympy.Symbol(x, positive=True) for x in ("E", "I", "N", "C", "s")}
        quotient = found / sympy.sympify(wanted, names)
        positive = {x: sympy.Symbol(x.name, positive=True) for x in quotient.free_symbols}
        assert sympy.simplify(quotient.subs(positive)) == 1


def test_what_decays_along_a_beam_agrees_with_a_numeric_solution() -> None:
    term = limits_of(BEAM + PULL + 'y = "a.y"').expr("s -> infinity")
    assert term is not None
    stiffness, mass, length = mpmath.mpf(140), mpmath.mpf("0.27"), mpmath.mpf("0.5")
    for s in (30000, 100000):
        with mpmath.workdps(40):
            # w = sum of c_i exp(r_i x), r_i^4 = -rho A s^2/(E I); at the far end E I w''' = -F
            q = (mass * mpmath.mpf(s) ** 2 / stiffness) ** 0.25 * mpmath.exp(mpmath.pi * 0.25j)
            roots = [q, -q, 1j * q, -1j * q]
            rows = [[r**n for r in roots] for n in (2, 3)]
            rows += [[r**n * mpmath.exp(r * length) for r in roots] for n in (2, 3)]
            whole = sum(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix([0, 0, 0, -1 / stiffness]))).real
        values = {"E": 70e9, "I": 2e-9, "rho": 2700, "A": 1e-4, "l": 0.5, "s": s}
        assert float(term.subs({x: values[x.name] for x in term.free_symbols})) == pytest.approx(
            float(whole), rel=1e-5
        )


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("oscillator", ["static compliance, 0.125 m/N", "mass line, -40 dB/decade, 0.5 m/(N*s^2)"]),
        ("damped body", ["damper line, -20 dB/decade", "corner frequency:   b/m   0.0238732 Hz, 0.15 rad/s"]),
        ("cantilever", ["static compliance", "-30 dB/decade", "on s = j*omega only with damping"]),
        ("low pass", ["static gain, 1", "corner frequency:   1/sqrt(L*C)"]),
    ],
)
def test_terms_are_told_in_words_with_their_values_and_where_they_meet(name: str, lines: list[str]) -> None:
    text = str(limits_of(CASES[name][0]))
    assert all(line in text for line in lines), text


def test_a_bode_plot_shows_both_asymptotes() -> None:
    function = symflex.loads(PARAMETERS + CASES["oscillator"][0]).transfer_functions()[0].bind()
    _, static, inertia = function.bode(band=(0.01, 10), asymptotes=True).axes[0].get_lines()
    assert static.get_ydata() == pytest.approx([20 * math.log10(1 / 8)] * 2)
    assert inertia.get_ydata()[1] == pytest.approx(-20 * math.log10(2 * (20 * math.pi) ** 2))


LOSS = MASS + SPRING.replace('k = "k"', 'k = "k", eta_s = 0.1') + FORCE + 'y = "x"'
TIMOSHENKO = """[fields.beam]
unknowns = ["w", "p"]
domain = ["0", "l"]
equations = ["N*(w'' - p') = rho*A*s^2*w", "E*I*p'' + N*(w' - p) = rho*I*s^2*p"]
conditions = ["w(0) = 0", "p(0) = 0", "p'(l) = 0", "N*(w'(l) - p(l)) = F"]
[inputs]
F = {}
[outputs]
y = "w(l)"
"""


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (LOSS, "loss factors hold on s = j*omega alone"),
        (TIMOSHENKO, "s -> infinity: no symbolic term, its waves are not roots of one term"),
        (
            SIGNALS + 'y = "u*((tau - 20*T)*s + 1)/(T*tau*s^2)"\n[outputs]\nout = "y"',
            "(tau - 20*T)/(T*tau*s) is zero for the",
        ),
    ],
)
def test_a_term_that_is_not_had_is_refused_with_its_reason(text: str, reason: str) -> None:
    assert reason in str(limits_of(text))


FIN = """symflex = 1
parameters = { k = "200 W/(m*K)", h = "40 W/(m^2*K)", P = "44 mm", A = "40 mm^2", L = "50 mm" }
inputs = { Q = { unit = "W" } }
outputs = { T_root = "T(0)" }
definitions = { rho = "2700 kg/m^3", c = "900 J/(kg*K)" }
[fields.T]
domain = ["0", "L"]
equation = "k*A*T'' - h*P*T = rho*c*A*s*T"
conditions = ["-k*A*T'(0) = Q", "-k*T'(L) = h*T(L)"]
"""


def test_a_fin_that_is_cooled_along_its_length_has_a_static_gain():
    """Incropera and DeWitt, Fundamentals of Heat and Mass Transfer, 1996, table 3.4, case A: q_f/theta_b."""
    limits = symflex.loads(FIN).transfer_functions()[0].limits()
    k, h, P, A, L = sympy.symbols("k h P A L", positive=True)
    m = sympy.sqrt(h * P / (k * A))
    ratio = (sympy.sinh(m * L) + h / (m * k) * sympy.cosh(m * L)) / (
        sympy.cosh(m * L) + h / (m * k) * sympy.sinh(m * L)
    )
    found = limits.expr("s -> 0")
    numbers = {"k": 200, "h": 40, "P": 44e-3, "A": 40e-6, "L": 50e-3}
    wanted = (1 / (sympy.sqrt(h * P * k * A) * ratio)).subs(
        {sympy.Symbol(n, positive=True): x for n, x in numbers.items()}
    )
    assert abs(found.subs({x: numbers[x.name] for x in found.free_symbols}) / wanted - 1) < 1e-12
    assert limits.row("s -> 0").value == pytest.approx(13.2054270974, rel=1e-11)
    assert "where gamma_0 = sqrt(h*P/(k*A))" in str(limits)


def test_a_term_that_a_delay_turns_has_no_slope_beside_it() -> None:
    text = str(limits_of(CASES["loop with a delay"][0]))
    assert "exp(-T*s)" in text and "dB/decade" not in text
