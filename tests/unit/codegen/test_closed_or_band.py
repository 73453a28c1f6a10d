"""Which functions have code of their formula in every language, and what is said of the others."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.program.evaluate import evaluate
from tests.unit.codegen.exportable import PIPE

# A motor, a ball screw, a carriage with friction, and an arm with a load: 25 printed lines, 108 expanded.
ARM = """
symflex = 1
[parameters]
R = "1.2 Ohm"
L_a = "2 mH"
k_t = "0.11 N*m/A"
J = "3e-5 kg*m^2"
p_h = "5 mm"
M = "4 kg"
b = "3 N*s/m"
b_r = "1e-4 N*m*s"
EI = "35 N*m^2"
rhoA = "0.4 kg/m"
l = "0.45 m"
m = "0.3 kg"
J_l = "1e-4 kg*m^2"
[inputs]
U = { voltage = "v" }
[outputs]
X_tip = "tip"
[elements]
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "rotor", R = "R", L = "L_a", k_t = "k_t" }
rotor = { type = "inertia", at = "rotor", J = "J" }
bearing = { type = "rotary_damper", between = ["rotor", "ground"], b = "b_r" }
screw = { type = "transformer", from = "rotor", to = "x", ratio = "p_h/(2*pi)" }
carriage = { type = "mass", at = "x", m = "M" }
friction = { type = "damper", between = ["x", "ground"], b = "b" }
guide = { type = "slider", at = "x" }
arm = { type = "beam", between = ["x", "tip"], EI = "EI", rhoA = "rhoA", l = "l" }
load = { type = "rigid_body", at = "tip", m = "m", J = "J_l" }
"""

# Two strings with the wavenumbers sqrt(mu/T) s and sqrt((mu_2 s^2 + k)/T), equal at 173.205 rad/s.
COUPLED = """
symflex = 1
parameters = { T = "10 N", mu = "10 g/m", mu_2 = "20 g/m", k = "300 N/m^2", c = "5 N/m^2", l = "1 m" }
inputs.u = {}
outputs.end = "v(l)"
[fields.w]
domain = ["0", "l"]
unknowns = ["w", "v"]
equations = ["T*w'' = mu*s^2*w", "T*v'' = mu_2*s^2*v + k*v + c*w"]
conditions = ["w(0) = u", "w'(l) = 0", "v(0) = 0", "v'(l) = 0"]
"""

# Their sum and difference have the wavenumbers; (cosh q_1 + cosh q_2)/(2 cosh q_1 cosh q_2) has neither sum.
SYMMETRIC = COUPLED.replace(
    "\"T*w'' = mu*s^2*w\", \"T*v'' = mu_2*s^2*v + k*v + c*w\"",
    "\"T*w'' = mu*s^2*w + c*(w - v)\", \"T*v'' = mu*s^2*v + c*(v - w)\"",
).replace('mu_2 = "20 g/m", k = "300 N/m^2", ', "")

TWO_BEAMS = """
symflex = 1
parameters = { EI = "35 N*m^2", rhoA = "0.4 kg/m", l = "0.45 m", l_2 = "0.3 m", m = "0.3 kg" }
inputs.F = { force = "mid" }
outputs.Y = "tip"
[elements]
base = { type = "fixed", at = "root" }
a = { type = "beam", between = ["root", "mid"], EI = "EI", rhoA = "rhoA", l = "l" }
b = { type = "beam", between = ["mid", "tip"], EI = "EI", rhoA = "rhoA", l = "l_2" }
m = { type = "mass", at = "mid", m = "m" }
"""


def contents(text, target="c", **options):
    model, exporter = pipeline.loads(text), replace(EXPORTERS[target], **options)
    derived, _ = pipeline.derive_as(model, model.transfer_functions, solves=exporter.solves)
    return exporter.contents(model, derived, samples=20)


@pytest.mark.parametrize("target", ["c", "js", "jax"])
def test_a_formula_that_is_short_in_factored_form_keeps_its_parameters(target):
    made = contents(ARM, target)
    assert made.notes == ()
    assert {p.name for p in made.members[0].parameters} == {p.name for p in made.model.parameters}


def test_its_values_are_those_of_the_equations_far_beyond_the_first_modes():
    # exp(A l) of the beam's four states and a solve of the assembled equations, in mpmath with 250 digits.
    made = contents(ARM).members[0]
    declared = {p.name: float(p.value.nearly) for p in made.parameters}
    for omega, length, expected in (
        (300.0, 0.45, 2.4924876010740012e-6 + 1.343736783051959e-6j),
        (2000.0, 0.6, 1.2015657768040734e-9 - 3.7975096636671984e-9j),
        (200000.0, 0.45, 4.6605992338256925e-18 - 1.5454583392250734e-15j),
    ):
        (value,) = evaluate(made.program, np.array([1j * omega]), declared | {"l": length})
        assert abs(value / expected - 1) < 1e-12, omega


def test_two_beams_and_coupled_strings_have_code_of_their_formula():
    for text in (TWO_BEAMS, SYMMETRIC):
        assert contents(text).notes == ()


def test_a_parameter_without_value_is_an_argument_of_two_beams():
    text = TWO_BEAMS.replace('EI = "35 N*m^2"', 'EI = { unit = "N*m^2" }')
    assert "EI" in {p.name for p in contents(text).members[0].parameters}


@pytest.mark.parametrize(
    ("text", "target", "options", "said"),
    [
        (
            COUPLED,
            "c",
            {"up_to": Fraction(30)},
            "up to 30 Hz and with the numbers of the file: code of its formula",
        ),
        (SYMMETRIC, "numpy", {"form": "band", "up_to": Fraction(30)}, "end/u is in band form, up to 30 Hz"),
        pytest.param(
            PIPE,
            "js",
            {},
            "up to 20 Hz and with the numbers of the file: it has no short formula",
            marks=pytest.mark.slow,
        ),
    ],
    ids=["overflows", "chosen", "no_short_formula"],
)
def test_a_band_form_says_why_and_where_it_ends(text, target, options, said):
    assert said in contents(text, target, **options).notes[0]
