"""The measured error is a measured error: it sees one wrong digit, and the best form is taken."""

from dataclasses import replace
from fractions import Fraction
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from flint import acb, acb_poly

from symflex import pipeline
from symflex.codegen.program.build import available_forms, build_program
from symflex.codegen.program.nodes import Multiply, RealNumber, lumped
from symflex.codegen.program.verify import (
    DEFAULT_BAND,
    EnclosedValues,
    References,
    Verification,
    _roots,
    choose_programs,
    sample_frequencies,
)

DERIVATIONS = Path(__file__).parents[3] / "derivations" / "eppinger1988"
BAND = (Fraction(1, 10), Fraction(1000))
EPSILON = 2.0**-52


def transfer_functions(name):
    return pipeline.derive_all(pipeline.load(DERIVATIONS / f"{name}.toml"))


@pytest.fixture(scope="module")
def two_mass():
    return transfer_functions("two_mass")[0]


def spoiled(program, factor):
    """Return a program whose result is wrong by a factor."""
    value = Multiply((RealNumber(Fraction(factor)), program.near.values[0]))
    return lumped(program.parameters, replace(program.near, values=(value,)))


@pytest.mark.parametrize("name", ["two_mass", "rigid_body", "lumped_bending_beam"])
def test_the_error_of_every_form_is_of_the_size_of_rounding_and_the_best_is_taken(name):
    for tf in transfer_functions(name)[:2]:
        references = References.over(pipeline.bind(tf), DEFAULT_BAND)
        errors = {f: references.worst_error(build_program(tf, f)) for f in available_forms(tf)}
        assert len(errors) > 2
        assert max(errors.values()) < 1e-13
        # An undamped resonance inside the band, of the bending beam, does not spoil the measure.
        _, verification = choose_programs(tf)[0]
        assert 0 < verification.error < 1e-15


def test_an_error_in_the_ninth_digit_is_measured_as_such(two_mass):
    bound = pipeline.bind(two_mass)
    program = spoiled(build_program(two_mass), 1 + Fraction(1, 10**9))
    # Where |s G'/G| = 2, at low frequencies, the measure divides by 3.
    assert 1e-9 / 3.1 < References.over(bound, BAND).worst_error(program) < 1.01e-9


def test_a_value_that_is_not_finite_is_an_infinite_error(two_mass):
    bound = pipeline.bind(two_mass)
    program = build_program(two_mass)
    assert References.over(bound, BAND).worst_error(spoiled(spoiled(program, 10**300), 10**300)) == np.inf


def test_infinity_at_the_double_nearest_to_a_pole_is_an_error_of_rounding_and_no_overflow():
    text = """symflex = 1
    inputs   = { F = { force = "x" } }
    outputs  = { X = "x" }
    [elements]
    m = { type = "mass", at = "x", m = 1 }
    k = { type = "spring", between = ["x", "ground"], k = KK }"""
    for stiffness in (k for k in range(2, 40) if sqrt(k) ** 2 == k and sqrt(k) % 1):
        (tf,) = pipeline.derive_all(pipeline.loads(text.replace("KK", str(stiffness))))
        omega = sqrt(stiffness)  # irrational, but in doubles k - omega^2 is 0
        values = EnclosedValues(pipeline.bind(tf))
        assert References(values, np.array([1j * omega])).worst_of([complex("inf")]) < 2 * EPSILON
        # A thousandth beside the pole the same is an overflow.
        assert References(values, np.array([1.001j * omega])).worst_of([complex("inf")]) == np.inf


def test_samples_stand_at_every_pole_and_zero(two_mass):
    bound = pipeline.bind(two_mass)
    frequencies = sample_frequencies(bound, BAND, 400)
    # 11 Hz pole and 59.85 rad/s zero of the two-mass model, from its own closed forms.
    pole = np.sqrt(71653 * 80 / (60 * 20)) / (2 * np.pi)
    zero = np.sqrt(71653 / 20) / (2 * np.pi)
    for wanted in (pole, zero):
        assert np.min(abs(frequencies / wanted - 1)) < 1e-4
    assert len(frequencies) > 400


@pytest.mark.slow
def test_recurrences_are_taken_for_the_six_masses_because_they_are_the_most_accurate():
    tf = transfer_functions("six_mass")[0]
    _, verification = choose_programs(tf)[0]
    errors = {
        f: References.over(pipeline.bind(tf), DEFAULT_BAND).worst_error(build_program(tf, f))
        for f in available_forms(tf)
    }
    assert verification.form == "closed" == min(errors, key=errors.get)
    assert errors["factors"] > 10 * errors["closed"]


def test_the_band_of_the_analysis_is_the_default(two_mass):
    assert choose_programs(two_mass)[0][1].band == (Fraction(1, 10), Fraction(100))
    wide = replace(two_mass.model, analysis=replace(two_mass.model.analysis, band=BAND))
    assert choose_programs(replace(two_mass, model=wide))[0][1].band == BAND


def test_a_parameter_without_value_is_named_as_the_reason():
    text = """
    symflex = 1
    parameters = { m = "2 kg", b = {} }
    elements.body = { type = "mass", at = "x", m = "m" }
    elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }
    inputs.F = { force = "x" }
    outputs.V = "s*x"
    """
    _, verification = choose_programs(pipeline.derive_all(pipeline.loads(text))[0])[0]
    assert verification.error is None
    assert verification.text() == "not verified: no values for b"


def test_the_sentence_says_error_and_band():
    verification = Verification("V/F", "closed", 3.14e-16, (Fraction(1, 10), Fraction(1000)), 400)
    assert (
        verification.text()
        == "verified: worst relative error 3.1e-16 over 0.1 Hz ... 1 kHz against ball arithmetic"
    )


def test_rough_roots_are_found_where_quotients_of_coefficients_are_beyond_doubles():
    # (s^2 + 1e24)^30 has coefficients up to 1e720.
    polynomial = acb_poly([acb(10) ** 24, 0, 1]) ** 30
    found = _roots(polynomial.coeffs())
    assert len(found) == 60
    assert abs(np.exp(np.mean(np.log(abs(found)))) / 1e12 - 1) < 1e-6


ROD_ON_A_SPRING = """
symflex = 1
inputs.F = {{ force = "a" }}
outputs.X = "a"
[parameters]
E = "70 GPa"
A = "150 mm^2"
rho = "2700 kg/m^3"
k = "50 MN/m"
m = "1 kg"
l_1 = "{length}"
l_2 = "0.4 m"
l_3 = "0.5 m"
[elements]
r_1 = {{ type = "rod", between = ["ground", "a"], E = "E", A = "A", rho = "rho", l = "l_1" }}
r_2 = {{ type = "rod", between = ["a", "b"], E = "E", A = "A", rho = "rho", l = "l_2" }}
r_3 = {{ type = "rod", between = ["b", "c"], E = "E", A = "A", rho = "rho", l = "l_3" }}
k_1 = {{ type = "spring", between = ["a", "ground"], k = "k" }}
m_1 = {{ type = "mass", at = "b", m = "m" }}
"""


@pytest.mark.parametrize(("length", "pieces"), [("0.3 m", 2), ("1 mm", 4)])
@pytest.mark.slow
def test_three_lengths_have_series_each_by_itself_where_it_is_measured_to_serve(length, pieces):
    (tf,) = pipeline.derive_all(pipeline.loads(ROD_ON_A_SPRING.format(length=length)))
    (_, _), real = choose_programs(tf)
    program, verification = real
    assert (len(program.code), verification.error < 1e-14) == (pieces, True)


BAR = """
symflex = 1
inputs.F = { force = "tip.x" }
outputs.X = "tip.x"
[parameters]
E = "210 GPa"
I = "1e-8 m^4"
A = "1e-4 m^2"
rho = "7800 kg/m^3"
l = "0.5 m"
m = "0.3 kg"
b = DAMPING
[elements]
post = { type = "frame", between = ["ground", "tip"], E = "E", I = "I", A = "A", rho = "rho", l = "l" }
load = { type = "rigid_body", at = "tip", m = "m" }
loss = { type = "damper", between = ["tip.x", "tip.y"], b = "b" }
"""


@pytest.mark.slow
def test_a_bar_gets_no_piece_where_it_bends_like_a_short_one_and_stretches_like_a_long_one():
    valued, symbolic = (
        pipeline.derive_all(pipeline.loads(BAR.replace("DAMPING", given)))[0] for given in ('"2 N*s/m"', "{}")
    )
    (program, verification), real = choose_programs(valued)
    assert (len(program.code), real, verification.error < 1e-14) == (3, None, True)
    (without_values, _), _ = choose_programs(symbolic)
    assert len(without_values.code) == 4
