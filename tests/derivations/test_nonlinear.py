"""The nonlinear models at their operating points, against what their books print."""

from pathlib import Path

import numpy as np
import pytest

import symflex

FOLDER = Path(__file__).parents[2] / "derivations" / "nonlinear"
S = 3.0 + 40.0j


def model_and_values(name):
    model = symflex.load(FOLDER / f"{name}.toml")
    return model, {p.name: float(p.value.nearly) for p in model.parameters if p.value}


def value(model, pair):
    return complex(model.transfer_function(pair).bind()(S))


def test_levitation_is_unstable_by_the_root_of_two_g_over_the_gap():
    model, v = model_and_values("magnetic_levitation")
    poles = sorted(complex(p).real for p in model.transfer_function("X/u").bind().poles())
    fast = (2 * v["g"] / v["x_0"]) ** 0.5
    assert poles == pytest.approx(sorted([-v["R"] / v["L"], -fast, fast]), rel=1e-12)


def test_the_arm_has_the_inertia_matrix_of_spong():
    model, v = model_and_values("arm_at_a_pose")
    m_1, m_2, l_1, l_2 = (v[n] for n in ("m_1", "m_2", "l_1", "l_2"))
    c_2, s_1, s_12 = np.cos(v["q_20"]), np.sin(v["q_10"]), np.sin(v["q_10"] + v["q_20"])
    d = m_2 * (l_2**2 + l_1 * l_2 * c_2)
    mass = np.array([[(m_1 + m_2) * l_1**2 + m_2 * (l_2**2 + 2 * l_1 * l_2 * c_2), d], [d, m_2 * l_2**2]])
    weight = m_2 * v["g"] * l_2 * s_12
    stiffness = -np.array([[(m_1 + m_2) * v["g"] * l_1 * s_1 + weight, weight], [weight, weight]])
    inverse = np.linalg.inv(mass * S**2 + v["b"] * np.eye(2) * S + stiffness)
    found = [[value(model, f"Q_{i}/tau_{j}") for j in (1, 2)] for i in (1, 2)]
    assert np.allclose(found, inverse, rtol=1e-12)


def test_the_converter_is_that_of_erickson_with_the_resistance_of_its_coil():
    model, v = model_and_values("buck_converter")
    below = 1 + S * v["L"] / v["R"] + S**2 * v["L"] * v["C"] + v["r"] * (1 / v["R"] + S * v["C"])
    assert value(model, "V_out/d") == pytest.approx(v["V"] / below, rel=1e-12)
    assert value(model, "V_out/V_in") == pytest.approx(v["D"] / below, rel=1e-12)


def test_the_servo_has_the_hydraulic_frequency_of_merritt():
    model, v = model_and_values("hydraulic_servo")
    omega = v["A"] * (v["B"] / (v["V"] * v["m"])) ** 0.5
    gain = v["k_v"] * (v["p_s"] - v["p_0"]) ** 0.5 / v["A"]
    expected = gain / (S * (S**2 / omega**2 + v["b"] * S / (v["m"] * omega**2) + 1))
    assert value(model, "X/y") == pytest.approx(expected, rel=1e-12)


def test_the_ball_rolls_down_with_the_inertia_of_its_spin():
    model, v = model_and_values("ball_on_beam")
    rolled = value(model, "R/tau") / value(model, "Theta/tau")
    assert rolled == pytest.approx(-v["g"] / ((1 + v["J_b"] / (v["m"] * v["r_b"] ** 2)) * S**2), rel=1e-12)


def test_the_upright_pendulum_has_the_matrices_of_its_arm():
    model, v = model_and_values("furuta_pendulum")
    cross = v["m"] * v["L"] * v["l"] * S**2
    a = [[(v["J"] + v["m"] * v["L"] ** 2) * S**2 + v["b"] * S, cross]]
    a += [[cross, v["m"] * v["l"] ** 2 * S**2 - v["m"] * v["g"] * v["l"]]]
    found = [value(model, "Phi/tau"), value(model, "Theta/tau")]
    assert found == pytest.approx(list(np.linalg.solve(np.array(a), [1, 0])), rel=1e-12)


def test_the_motor_has_the_poles_of_its_state_matrix():
    model, v = model_and_values("pmsm_field_weakened")
    p, w, difference = v["p"], v["Omega"], v["L_d"] - v["L_q"]
    a = np.array(
        [
            [-v["R"] / v["L_d"], p * w * v["L_q"] / v["L_d"], p * v["L_q"] * v["i_q0"] / v["L_d"]],
            [
                -p * w * v["L_d"] / v["L_q"],
                -v["R"] / v["L_q"],
                -p * (v["L_d"] * v["i_d0"] + v["psi"]) / v["L_q"],
            ],
            [
                1.5 * p * difference * v["i_q0"] / v["J"],
                1.5 * p * (v["psi"] + difference * v["i_d0"]) / v["J"],
                -v["b"] / v["J"],
            ],
        ]
    )
    poles = sorted(
        map(complex, model.transfer_function("W/u_q").bind().poles()), key=lambda z: (z.real, z.imag)
    )
    assert poles == pytest.approx(sorted(np.linalg.eigvals(a), key=lambda z: (z.real, z.imag)), rel=1e-9)


def test_the_filter_has_the_frequency_and_q_of_sallen_and_key():
    model, v = model_and_values("../classics/sallen_key")
    omega = (v["R1"] * v["R2"] * v["C1"] * v["C2"]) ** -0.5
    q = 1 / (omega * v["C2"] * (v["R1"] + v["R2"]))
    assert value(model, "V_out/V1") == pytest.approx(1 / ((S / omega) ** 2 + S / (q * omega) + 1), rel=1e-12)
