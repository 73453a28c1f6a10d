"""The band form: code that is a product over poles and zeros, where there is no short formula."""

import re
from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from scipy.special import jv

from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.program.verify import choose_band
from symflex.errors import ModelError
from tests.unit.codegen.exportable import PIPE, derived, executed
from tests.unit.codegen.test_c_files import compiled, value_at
from tests.unit.codegen.test_c_files import response as c_response

STRING = """
symflex = 1
parameters = { T = "10 N", mu = "10 g/m", l = "1 m" }
[fields.w]
domain = ["0", "l"]
equation = "T*w'' = mu*s^2*w"
conditions = ["w(0) = u", "w'(l) = 0"]
[inputs]
u = {}
[outputs]
end = "w(l)"
"""
"""Whose end moves by 1/cosh(s l/c) with c = sqrt(1000) m/s."""

HANGING = """
symflex = 1
parameters = { rhoA = "20 g/m", g = "9.81 m/s^2", l = "2 m" }
[fields.w]
domain = ["0", "l"]
equation = "(rhoA*g*(l - x)*w')' = rhoA*s^2*w"
conditions = ["w(0) = w_0"]
[inputs]
w_0 = { unit = "m" }
[outputs]
tip = "w(l)"
"""


def band(target, **options):
    return replace(EXPORTERS[target], form="band", **options)


def exported(text, target, **options):
    model = pipeline.loads(text)
    return band(target, **options).export(model, pipeline.derive_all(model), "plant", is_alone=False)


@cache
def string():
    made = exported(STRING, "numpy")
    return made, executed(made.text)["end_over_u"]


def test_a_string_is_its_hyperbolic_cosine_also_beside_its_poles():
    made, end = string()
    assert made.verified[0].form == "band"
    assert made.verified[0].error < 1e-14
    poles = np.pi * np.sqrt(1000) * (np.arange(5) + 0.5)
    s = 1j * np.concatenate([poles * (1 + x) for x in (-1e-3, 1e-7, 1e-9)] + [np.linspace(1, poles[-1], 30)])
    for at in (s, s + 40, s - 40):
        exact = 1 / np.cosh(at / np.sqrt(1000))
        room = 1e-13 + 1e-15 * np.abs(at * np.tanh(at / np.sqrt(1000)) / np.sqrt(1000))
        assert np.all(np.abs(end(at) / exact - 1) < room)


def test_a_docstring_says_where_it_holds_and_that_parameters_are_fixed():
    text = re.sub(r"\s+", " ", string()[1].__doc__)
    assert "20 poles" in text
    assert "Hz, and is NaN beyond" in text
    assert "Numbers are those of the file" in text
    assert "at abs(re(s)) = " in text
    with pytest.raises(TypeError):
        string()[1](1j, T=11.0)


def test_the_band_ends_where_it_is_asked_to():
    (tf,) = pipeline.derive_all(pipeline.loads(STRING))
    _, verified, said = choose_band(tf, up_to_hz=Fraction(100))
    assert verified.band[1] == 100
    assert "628.32 rad/s, 100 Hz" in said[1]


@pytest.mark.slow
def test_a_rod_whose_damper_takes_every_wave_has_zeros_alone():
    text = """
symflex = 1
elements.bar = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }
elements.end = { type = "damper", between = ["x", "ground"], b = 1 }
inputs.F = { force = "x" }
outputs.X = "x"
"""
    s = 1j * np.linspace(0.1, 15, 30)
    # 1/(s coth s + s)
    exact = (1 - np.exp(-2 * s)) / (2 * s)
    assert np.all(np.abs(executed(exported(text, "numpy").text)["X_over_F"](s) - exact) < 1e-14)


def test_what_is_lumped_is_exact_and_needs_no_rest():
    _, tfs = derived("six_mass")
    program, verified, said = choose_band(tfs[0])
    assert verified.error < 1e-14
    assert "a polynomial of degree 0" in said[0]
    assert not program.parameters


def test_what_is_lumped_has_no_end():
    text = """
symflex = 1
inputs = { u = { voltage = "a" } }
outputs = { i = "u.i" }
[elements]
c = { type = "capacitor", between = ["a", "b"], C = "1 pF" }
r = { type = "resistor", between = ["b", "ground"], R = "3 Ohm" }
"""
    s = np.array([1j, 3e5, 2e12j, (-1 + 7j) * 1e11])
    exact = s * 1e-12 / (1 + 3e-12 * s)
    code = executed(exported(text, "numpy").text)["i_over_u"]
    assert "it was measured for" in re.sub(r"\s+", " ", code.__doc__)
    assert np.all(np.abs(code(s) / exact - 1) < 1e-14)


@pytest.mark.slow
def test_a_docstring_says_where_roots_accumulate_and_errors_grow():
    text = """
symflex = 1
inputs = { z = { displacement = "x" } }
outputs = { T = "y" }
[elements]
r = { type = "rod", between = ["x", "y"], EA = "300 kN", rhoA = "0.11 kg/m", l = "0.5 m", eta = "60 us" }
m = { type = "mass", at = "y", m = "2 kg" }
"""
    code = executed(exported(text, "numpy").text)["T_over_z"]
    said = re.sub(r"\s+", " ", code.__doc__)
    assert "near the imaginary axis" in said
    assert "and larger further away" in said

    def exact(s):
        stiff = 300e3 * (1 + 60e-6 * s)
        wave = np.sqrt(0.11 * s**2 / stiff + 0j)
        return 1 / (np.cosh(wave / 2) + 2 * s**2 / (stiff * wave) * np.sinh(wave / 2))

    assert abs(code(3e3j) / exact(3e3j) - 1) < 1e-12
    # Poles accumulate at -1/eta, where E vanishes.
    assert abs(code(-16000.0) / exact(-16000.0) - 1) > 0.1
    assert "infinitely many accumulate about -1.667e+04+0j rad/s" in said


@pytest.mark.slow
@pytest.mark.needs_tool("gcc")
def test_c_has_it_where_waves_would_have_to_be_followed(tmp_path):
    library, _ = compiled(tmp_path, exported(HANGING, "c"))
    omega = np.linspace(0.5, 18, 40)
    x = 2 * omega * np.sqrt(2 / 9.81)
    room = 1e-13 * (1 + np.abs(x * jv(1, x) / jv(0, x)))
    assert np.all(np.abs(c_response(library, 0, omega) * jv(0, x) - 1) < room)
    assert np.all(np.abs(value_at(library, 0, 1j * omega) * jv(0, x) - 1) < room)


@pytest.mark.slow
@pytest.mark.parametrize(("target", "text"), [("julia", HANGING), ("array-api", HANGING), ("matlab", PIPE)])
def test_languages_have_it_where_there_is_no_formula(target, text):
    model = pipeline.loads(text)
    made = EXPORTERS[target].export(model, pipeline.derive_all(model)[:1], "plant", samples=50)
    assert made.verified[0].form == "band"
    assert made.verified[0].error < 1e-13
    assert len(made.text) < 40_000


def test_a_function_that_is_zero_stays_so():
    model = pipeline.loads(STRING.replace('end = "w(l)"', 'end = "w(l)"\nnone = "w(0) - u"'))
    program, verified, _ = choose_band(pipeline.derive_all(model)[1])
    assert verified.error == 0
    assert not program.conditions


def test_a_column_at_its_buckling_load_has_a_pole_at_rest():
    column = """
symflex = 1
parameters = { EI = "168 N*m^2", rhoA = "0.785 kg/m", l = "1 m", P = "pi^2*EI/l^2" }
inputs.M = { torque = "a.theta" }
outputs.turn = "a.theta"
[elements]
left   = { type = "pin", at = "a" }
right  = { type = "pin", at = "b" }
column = { type = "beam", between = ["a", "b"], EI = "EI", rhoA = "rhoA", l = "l", N = "-P" }
"""
    turn = executed(exported(column, "numpy").text)["turn_over_M"]
    omega = 0.01  # rad/s; the next mode is at 500 rad/s
    first_mode = -2 * np.pi**2 / (0.785 * omega**2)  # sqrt(2) sin(pi x/l), which nothing holds
    assert turn(1j * omega) == pytest.approx(first_mode, rel=1e-7)


def test_it_needs_values():
    model = pipeline.loads(STRING.replace('T = "10 N"', 'T = { unit = "N" }'))
    with pytest.raises(ModelError, match=r"SF229.*T has no value"):
        choose_band(pipeline.derive_all(model)[0])
