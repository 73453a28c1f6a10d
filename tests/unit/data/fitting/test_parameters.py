"""Parameters of specifications come back from responses that numpy computed, with errors that hold."""

from __future__ import annotations

import numpy as np
import pytest

from symflex import pipeline
from symflex.data.fitting.text import parameter_passages, parameters_json
from symflex.data.measurement import read_measurement
from symflex.errors import DataError, UsageError
from symflex.options import FitOptions
from symflex.print.text import passages_text
from tests.house.repository import ROOT
from tests.unit.data.fitting.conftest import DRIVE, LINES
from tests.unit.data.machines import study

MEASURED = ROOT / "derivations" / "measured"
TRUE = {"J_1": 2e-3, "J_2": 5e-3, "k": 400.0, "b": 0.03}


def drive(f, at="theta_1"):
    """Newton's equations of two inertias on a spring and a damper, solved by Cramer's rule."""
    s = 2j * np.pi * f
    z = TRUE["k"] + TRUE["b"] * s
    determinant = (TRUE["J_1"] * s**2 + z) * (TRUE["J_2"] * s**2 + z) - z**2
    return ((TRUE["J_2"] * s**2 + z) if at == "theta_1" else z) / determinant


def noisy(values, share, seed):
    source = np.random.default_rng(seed)
    noise = source.standard_normal(values.size) + 1j * source.standard_normal(values.size)
    return values * (1 + share / np.sqrt(2) * noise)


def test_all_parameters_of_a_drive_come_back_within_their_errors(fitted):
    found = fitted("J_1, J_2, k, b", noisy(drive(LINES), 0.02, 1))
    off = [(found.values[name] - TRUE[name]) / e for name, e in zip(TRUE, found.errors, strict=True)]
    assert np.max(np.abs(off)) < 3
    assert np.max(found.errors / found.theta) < 0.05
    assert not found.poor
    assert found.residual.curve(0, LINES) == pytest.approx(found.residual.values(0))  # as it is drawn
    ((definition, value, error),) = found.definitions()
    assert definition.name == "omega_z"
    assert abs(value - np.sqrt(400 / 5e-3)) < 3 * error < 0.01 * value


def test_values_to_begin_with_may_be_far_off(fitted):
    far = {"J_1": 0.05, "J_2": 1e-4, "k": 9e3, "b": 1e-3}
    found = fitted("J_1,J_2,k,b", drive(LINES), **far)
    assert [found.values[name] for name in TRUE] == pytest.approx(list(TRUE.values()), rel=1e-6)


def test_from_the_far_side_two_inertias_tell_their_sum_and_no_more(fitted):
    # k/(J_1 J_2 s^4 + (J_1 + J_2) (b s + k) s^2): three numbers; exchanging the inertias changes nothing
    found = fitted("J_1,J_2,k,b", noisy(drive(LINES, "theta_2"), 0.01, 2), tf="theta_2/tau")
    known = found.machine.identifiability
    assert known.is_exact
    assert (known.rank, known.alone) == (3, ())
    table = {name: (value, error) for name, value, error in found.combinations()}
    value, error = table["J_1 + J_2"]
    assert abs(value - 7e-3) < 3 * error
    text = passages_text(parameter_passages(found))
    assert "NOT IDENTIFIABLE" in text
    assert "one of J_1, J_2, k, b" in text
    assert parameters_json(found)["parameters"][0]["value"] is None
    ((_, _, error),) = found.definitions()
    assert np.isinf(error)


def test_a_spread_stands_for_what_the_response_cannot_tell(fitted):
    given = '{ value = "5 g*m^2", spread = "2 %" }'
    found = fitted("J_1,J_2,k,b", noisy(drive(LINES, "theta_2"), 0.01, 2), tf="theta_2/tau", J_2=given)
    assert found.machine.identifiability.is_complete
    # the sum of the inertias is known far better than either
    assert found.errors[1] == pytest.approx(0.02 * 5e-3 / 1.96, rel=0.1)
    assert abs(found.values["J_1"] - 2e-3) < 3 * found.errors[0]


def test_a_spread_that_the_data_contradict_is_said(fitted):
    given = '{ value = "300 N*m/rad", spread = "1 %" }'
    found = fitted("J_1,k,b", noisy(drive(LINES), 0.01, 3), J_2='"5 g*m^2"', k=given)
    assert any("k is" in reason and "spread" in reason for reason in found.poor)


def test_a_model_that_lacks_a_resonance_is_poor(fitted):
    f = LINES
    x = f / 20
    other = drive(f) * (1 + 0.3 / (1 - x**2 + 0.02j * x))
    assert fitted("J_1,J_2,k,b", noisy(other, 0.01, 4)).poor


def test_data_of_the_other_sign_are_said_to_be(fitted):
    found = fitted("J_1,J_2,k,b", noisy(-drive(LINES), 0.01, 5))
    assert "other sign" in found.poor[0]
    # Where nothing depends on a parameter, no interval of 600 decades stands for it.
    assert all(
        error < 1e3 * abs(value) or np.isinf(error)
        for value, error in zip(found.theta, found.errors, strict=True)
    )
    assert np.all(np.abs(found.correlations) <= 1)


def test_a_parameter_out_of_reach_of_the_band_is_said(fitted):
    f = np.geomspace(0.1, 1, 60)  # far below the resonance at 75 Hz: the inertias move as one
    found = fitted("J_1,k", noisy(drive(f), 0.01, 6), f=f, J_2='"5 g*m^2"', b='"0.03 N*m*s/rad"')
    assert any(said.startswith("k is not determined") for said in found.warnings)
    assert not any(said.startswith("J_1") for said in found.warnings)


MOTOR = """
symflex = 1
[parameters]
R = 2
L = 1e-3
k = 0.03
J = 1e-5
b = 2e-4
[inputs]
u = {{}}
[outputs]
w = "k*u/((L*s + R)*(J*s + b) + k^2)"
"""


def motor(f):
    s = 2j * np.pi * f
    return 0.05 / ((1e-3 * s + 1.2) * (3e-5 * s + 2e-4) + 0.05**2)


def test_a_motor_tells_three_numbers_of_five_parameters(fitted):
    f = np.geomspace(0.5, 2000, 80)
    known = fitted("R,L,k,J,b", noisy(motor(f), 0.01, 7), MOTOR, "w/u", f).machine.identifiability
    assert (known.rank, known.alone, len(known.fixes)) == (3, (), 10)
    # scaling R and L up and J and b down by the same factor: R J, R b and R/L stay
    known = fitted("R,L,J,b", noisy(motor(f), 0.01, 7), MOTOR, "w/u", f).machine.identifiability
    assert {known.text(powers) for powers in known.combinations} == {"R*J", "R*b", "R/L"}


def test_a_motor_has_other_values_with_the_same_response(fitted):
    f = np.geomspace(0.5, 2000, 80)
    found = fitted("R,k,J", motor(f), MOTOR, "w/u", f)
    assert [found.values[name] for name in "RkJ"] == pytest.approx([1.2, 0.05, 3e-5], rel=1e-6)
    (twin,) = found.twins
    assert found.are_exact_twins
    R, k, J = twin
    s = 2j * np.pi * f
    other = k / ((1e-3 * s + R) * (J * s + 2e-4) + k**2)
    assert np.max(np.abs(other / motor(f) - 1)) < 1e-6
    assert abs(R - 1.2) > 0.01


CANTILEVER = """
symflex = 1
[parameters]
E = "180 GPa"
I = "4000 mm^4"
rho = "7000 kg/m^3"
A = "480 mm^2"
l = "1 m"
eta = "100 us"
[elements]
bar = {{ type = "beam", between = ["tip", "ground"], EI = "E*I", rho = "rho", A = "A", l = "l", eta = "eta" }}
[inputs]
F = {{ force = "tip" }}
[outputs]
X = "tip"
"""


def cantilever(f, E=205e9, rho=7850.0, eta=3e-5):
    """Receptance of the tip of a clamped beam (Bishop & Johnson 1960, table 7.1(c))."""
    s = 2j * np.pi * f
    EI = E * (1 + eta * s) * 4e-9
    x = (-rho * 4.8e-4 * s**2 / EI) ** 0.25
    sine, fixed = np.sin(x) * np.cosh(x) - np.cos(x) * np.sinh(x), 1 + np.cos(x) * np.cosh(x)
    return sine / (EI * x**3 * fixed)


def test_modulus_density_and_damping_of_a_beam_come_back(fitted):
    f = np.geomspace(1, 60, 60)
    found = fitted("E,rho,eta", noisy(cantilever(f), 0.01, 8), CANTILEVER, "X/F", f)
    true = np.array([205e9, 7850, 3e-5])
    assert np.max(np.abs(found.theta - true) / found.errors) < 3
    assert not found.poor


def test_a_beam_tells_its_stiffness_and_its_mass(fitted):
    f = np.geomspace(1, 60, 60)
    known = fitted("E,I,rho,A,l,eta", cantilever(f), CANTILEVER, "X/F", f).machine.identifiability
    assert (known.rank, known.alone, known.is_exact) == (3, ("eta",), False)
    assert {known.text(powers) for powers in known.combinations} == {"rho*A*l", "E*I/l^3"}


def test_a_dead_time_comes_back_with_gain_and_time_constant(fitted):
    text = """
symflex = 1
[parameters]
K = 1
T = "30 s"
T_d = "1 s"
[blocks]
D = {{ type = "delay", T = "T_d" }}
[inputs]
u = {{}}
[outputs]
y = "K*D*u/(T*s + 1)"
"""
    f = np.geomspace(1e-3, 1, 60)
    s = 2j * np.pi * f
    values = noisy(2.5 * np.exp(-1.7 * s) / (1 + 12 * s), 0.02, 9)
    found = fitted("K,T,T_d", values, text, "y/u", f)
    assert np.max(np.abs(found.theta - [2.5, 12, 1.7]) / found.errors) < 3


def test_units_of_the_data_are_those_of_the_function_or_are_refused(fitted):
    milli = fitted("k,b", 1e3 * drive(LINES), unit="mrad/(N*m)", J_1='"2 g*m^2"', J_2='"5 g*m^2"')
    assert milli.values["k"] == pytest.approx(400, rel=1e-6)
    with pytest.raises(DataError, match="in V/A"):
        fitted("k,b", drive(LINES), unit="V/A")


@pytest.mark.parametrize("free", ["", "kk", "k,k", "omega_z", "k; import os"])
def test_what_is_no_free_parameter_is_refused(fitted, free):
    with pytest.raises(UsageError):
        fitted(free, drive(LINES))


def test_parameters_without_effect_are_refused(fitted):
    text = DRIVE.replace("b = {b}", "b = {b}\nspare = 3")
    with pytest.raises(UsageError, match="does not depend on 'spare'"):
        fitted("k,spare", drive(LINES), text)


def test_a_corner_in_hertz_comes_back_in_hertz(fitted):
    text = """
symflex = 1
parameters = {{ K = 2, f_0 = "10 Hz", zeta = 0.1 }}
inputs.u = {{}}
blocks.G = {{ type = "low_pass", omega = "f_0", zeta = "zeta" }}
outputs.y = "K*G*u"
"""
    f = np.geomspace(1, 100, 60)
    values = 3 / (1 - (f / 23) ** 2 + 0.06j * f / 23)
    assert fitted("K,f_0,zeta", values, text, "y/u", f).theta == pytest.approx([3, 23, 0.03], rel=1e-6)


def test_a_friction_that_is_not_there_becomes_zero_where_it_may(fitted):
    b = '{ value = "0.05 N*m*s/rad", assume = "nonnegative" }'
    f = np.geomspace(3, 60, 60)
    s = 2j * np.pi * f
    undamped = (5e-3 * s**2 + 400) / ((2e-3 * s**2 + 400) * (5e-3 * s**2 + 400) - 400**2)
    found = fitted("J_1,k,b", noisy(undamped, 0.01, 12), f=f, J_2='"5 g*m^2"', b=b)
    low, high = found.intervals()[2]
    assert low == 0 <= found.values["b"] < high
    assert abs(found.values["k"] - 400) < 3 * found.errors[1]


def test_a_magnitude_without_phase_is_enough_for_a_drive(fitted):
    sizes = np.abs(noisy(drive(LINES), 0.02, 13))
    found = fitted("J_1,J_2,k,b", sizes, is_magnitude=True)
    assert np.max(np.abs(found.theta - list(TRUE.values())) / found.errors) < 3.5


def test_a_few_lines_are_refused(fitted):
    with pytest.raises(DataError, match="SF605"):
        fitted("k", drive(LINES[:5]), f=LINES[:5])


@pytest.mark.slow
def test_the_examples_have_the_values_that_their_first_line_gives():
    cases = {
        "loudspeaker": {"R_e": 6.2, "L_e": 0.5e-3, "Bl": 7.5, "R_m": 1.4, "k_s": 1800},
        "crystal": {"R_1": 12, "L_1": 8e-3, "C_1": 30e-15, "C_0": 6e-12},
        "motor": {"R": 1.2, "k": 0.05, "J": 3e-5},
    }
    for name, true in cases.items():
        given = FitOptions(model=MEASURED / f"{name}.toml", free=",".join(true))
        found = pipeline.fit_parameters(read_measurement(str(MEASURED / "data" / f"{name}.csv")), given)
        off = [(found.values[n] - v) / e for (n, v), e in zip(true.items(), found.errors, strict=True)]
        assert np.max(np.abs(off)) < 3, name
        assert not found.poor, name


@pytest.mark.slow
@pytest.mark.parametrize("name", ["drive", "crystal", "oven", "rod", "hit of a drive", "step of an oven"])
def test_intervals_hold_the_true_values_of_machines(name, tmp_path):
    off, inside, poor = study(name, 10, tmp_path)
    assert np.mean(inside) > 0.8
    assert np.sqrt(np.mean(off**2)) < 1.5
    assert not poor
