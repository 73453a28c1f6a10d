"""Distributed functions up to a power of s: the books' effective masses, and the errors that are stated."""

import mpmath
import pytest
import sympy

from symflex import pipeline
from symflex.errors import UsageError
from symflex.expressions import format_expression
from symflex.print.text import form_text
from symflex.symbolic.order import truncated

VALUES = {"E": "70 GPa", "I": "1e-8 m^4", "rho": "2700 kg/m^3", "A": "1e-3 m^2", "l": "1 m", "m": "1 kg"}
VALUES |= {"G": "26 GPa", "J": "1 g*m^2", "J_p": "1e-8 m^4", "eta": "1 us"}
HEAD = "symflex = 1\n" + "".join(f'parameters.{name} = "{value}"\n' for name, value in VALUES.items())
CLAMP = 'elements.clamp = { type = "fixed", at = "a" }\n'
MASS = 'elements.load = { type = "mass", at = "b", m = "m" }\ninputs.F = { force = "b" }\noutputs.X = "b"\n'
INERTIA = (
    'elements.load = { type = "inertia", at = "b", J = "J" }\ninputs.F = { torque = "b" }\noutputs.X = "b"\n'
)
BEAM, ROD = (
    'type = "beam", E = "E", I = "I", rho = "rho", A = "A"',
    'type = "rod", E = "E", rho = "rho", A = "A"',
)


def member(law, between='["a", "b"]', length="l", name="arm"):
    return f'elements.{name} = {{ {law}, between = {between}, l = "{length}" }}\n'


def function(text):
    return pipeline.derive_all(pipeline.loads(HEAD + text))[0]


CANTILEVER = CLAMP + MASS + member(BEAM)
PINS = 'elements.p = { type = "pin", at = "a" }\nelements.q = { type = "pin", at = "c" }\n'
BOOKS = [
    # Rayleigh 1877, section 182 a; Blevins 1979, table 8-8
    (CANTILEVER, 2, "3*E*I/l^3 + (33*rho*A*l/140 + m)*s^2"),
    (
        PINS + MASS + member(BEAM, length="l/2") + member(BEAM, '["b", "c"]', "l/2", "other"),
        2,
        "48*E*I/l^3 + (17*rho*A*l/35 + m)*s^2",
    ),
    # a third of a spring's mass, of a shaft's inertia
    (CLAMP + MASS + member(ROD), 2, "E*A/l + (rho*A*l/3 + m)*s^2"),
    (
        CLAMP + INERTIA + member('type = "shaft", G = "G", J = "J_p", rho = "rho"'),
        2,
        "G*J_p/l + (rho*l*J_p/3 + J)*s^2",
    ),
    # E (1 + eta s) A/l
    (CLAMP + MASS + member(ROD + ', eta = "eta"'), 1, "E*A/l + E*A*eta/l*s"),
    # Rayleigh 1877, rotary inertia: 6/5 of rho I/l
    (
        CLAMP + MASS + member(BEAM + ', theory = "rayleigh"'),
        2,
        "3*E*I/l^3 + (6*I*rho/(5*l) + 33*rho*A*l/140 + m)*s^2",
    ),
    # x^3 (1 + cos x cosh x)/(sin x cosh x - cos x sinh x) = 3 - 33/140 x^4 - 1037/1940400 x^8 - ..., by SymPy
    (CANTILEVER, 4, "3*E*I/l^3 + (33*rho*A*l/140 + m)*s^2 - 1037*rho^2*A^2*l^5/(1940400*E*I)*s^4"),
]


@pytest.mark.parametrize(("text", "order", "expected"), BOOKS)
def test_the_dynamic_stiffness_is_that_of_books(text, order, expected):
    assert form_text(*truncated(function(text), order)) == f"X/F = 1/({expected})"


def test_the_stated_error_is_not_exceeded_and_the_pole_lies_where_it_is_said():
    facts = truncated(function(CANTILEVER), 2)[1].approximation.facts
    ei, rho_a, m = 700, mpmath.mpf(27) / 10, 1

    def stiffness(omega):
        x = mpmath.sqrt(omega * mpmath.sqrt(rho_a / ei))
        sin, cos, sinh, cosh = (f(x) for f in (mpmath.sin, mpmath.cos, mpmath.sinh, mpmath.cosh))
        return ei * x**3 * (1 + cos * cosh) / (sin * cosh - cos * sinh) - m * omega**2

    def short(omega):
        return 3 * ei - (mpmath.mpf(33) / 140 * rho_a + m) * omega**2

    for error in (1, 10):
        end = 2 * mpmath.pi * facts[f"within_{error}_percent_to_hz"]
        errors = [abs(stiffness(w) / short(w) - 1) for w in mpmath.linspace(end / 1000, end, 200)]
        assert 0.9 * error / 100 <= max(errors) <= error / 100
    with mpmath.workdps(30):
        exact = mpmath.findroot(stiffness, 35.7)
        moved = abs(mpmath.sqrt(3 * ei / (m + mpmath.mpf(33) / 140 * rho_a)) / exact - 1)
    assert moved <= facts["poles"]["displacement"] <= 1.000001 * moved


def test_the_stated_error_is_that_of_the_short_function_where_a_parameter_is_zero():
    text = """
symflex = 1
parameters = { T = "0.1 s", a = { value = 0, assume = "real" } }
inputs = { u = {} }
outputs = { y = "exp(-s*T)*u/(1 + 2*T*s) + a*u*exp(-2*s*T)" }
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    facts = truncated(tf, 2)[1].approximation.facts
    # abs(1 - j x - x^2/2 - exp(-j x)) is 1 % at x = omega T.
    x = mpmath.findroot(lambda x: abs(1 - 1j * x - x**2 / 2 - mpmath.expj(-x)) - 0.01, 0.4)
    assert facts["within_1_percent_to_hz"] == pytest.approx(float(x) / (0.2 * mpmath.pi), rel=0.01)


@pytest.mark.parametrize("law", [', N = "100 N"', ', k_f = "1 kN/m^2"'])
def test_waves_that_do_not_come_to_rest_are_refused(law):
    with pytest.raises(UsageError, match="do not vanish at s = 0, as under tension or on a foundation"):
        truncated(function(CLAMP + MASS + member(BEAM + law)), 2)


def test_a_timoshenko_beam_moves_as_its_static_shape():
    """Its mass at the tip is the kinetic energy of what a force there bends and shears (Rayleigh)."""
    law = ', theory = "timoshenko", G = "G", kappa = "5/6"'
    _, form = truncated(function(CLAMP + MASS + member(BEAM + law)), 2)
    names = {n: sympy.Symbol(n) for n in ("E", "I", "G")}
    num, den = (sympy.sympify(format_expression(side), names) for side in (form.num, form.den))
    e, i, g, a, r, length, m, s, x = sympy.symbols("E I G A rho l m s x")
    turn = (x * length - x**2 / 2) / (e * i)
    shape = sympy.integrate(turn, x) + 6 * x / (5 * g * a)
    tip = shape.subs(x, length)
    mass = sympy.integrate(r * a * shape**2 + r * i * turn**2, (x, 0, length)) / tip**2 + m
    assert sympy.simplify(den / num - 1 / tip - mass * s**2) == 0


def test_a_sliding_beam_becomes_a_mass_and_a_mode():
    # w(l) = -(1 + 3/40 b^4 + ...)/b^4 for a unit shear, E I = l = 1, b^4 = -rho A s^2, by SymPy
    beam = PINS.replace("pin", "slider").splitlines()[0] + "\n" + member(BEAM)
    tf = function(beam + 'inputs.F = { force = "a" }\noutputs.X = "b"\n')
    (_, form) = truncated(tf, 4)
    ones = dict.fromkeys(("E", "I", "rho", "A", "l"), 1)
    num, den = (
        sympy.sympify(format_expression(side), {"E": sympy.Symbol("E"), "I": sympy.Symbol("I")}).subs(ones)
        for side in (form.num, form.den)
    )
    s = sympy.Symbol("s")
    assert sympy.series(s**2 * num / den, s, 0, 4).removeO() == 1 - sympy.Rational(3, 40) * s**2
