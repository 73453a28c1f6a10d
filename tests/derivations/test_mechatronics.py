"""Machines, transducers and lines of textbooks, against their equations solved in numbers."""

from pathlib import Path

import mpmath
import numpy as np
import pytest

import symflex

FOLDER = Path(__file__).parents[2] / "derivations"
S = 2.0 + 30.0j


def model_and_values(name):
    model = symflex.load(FOLDER / f"{name}.toml")
    return model, {p.name: float(p.value.nearly) for p in model.parameters if p.value}


def value(model, pair, s=S):
    return complex(model.transfer_function(pair).bind()(s))


def solved(matrix, load):
    return np.linalg.solve(np.array(matrix, complex), np.array(load, complex))


def test_the_joint_of_spong_has_its_two_by_two_matrix():
    model, v = model_and_values("mechatronics/elastic_joint")
    weight = v["M"] * v["g"] * v["L"]
    matrix = [[v["I"] * S**2 + weight + v["k"], -v["k"]], [-v["k"], v["J"] * S**2 + v["k"]]]
    q, theta = solved(matrix, [0, 1])
    assert value(model, "Q/u") == pytest.approx(q, rel=1e-12)
    assert value(model, "Theta/u") == pytest.approx(theta, rel=1e-12)


def test_a_drive_train_has_the_antiresonance_of_its_load_and_the_resonance_of_both():
    model, v = model_and_values("mechatronics/drive_train")
    shaft, both = v["d"] * S + v["k"], 1 / v["n"]
    matrix = [
        [v["J_M"] * S**2 + both**2 * shaft, -both * shaft],
        [-both * shaft, v["J_L"] * S**2 + shaft],
    ]
    motor, load = solved(matrix, [1, 0])
    assert value(model, "Omega_M/M_M") == pytest.approx(S * motor, rel=1e-12)
    assert value(model, "Omega_L/M_M") == pytest.approx(S * load, rel=1e-12)


def test_a_flexible_arm_shows_at_the_head_without_zeros_but_that_of_its_damper():
    model, v = model_and_values("mechatronics/disk_drive")
    arm = v["b"] * S + v["k"]
    matrix = [
        [v["m_c"] * S**2 + arm, -arm, -v["k_f"]],
        [-arm, v["m_h"] * S**2 + arm, 0],
        [v["k_f"] * S, 0, v["L"] * S + v["R"]],
    ]
    carriage, head, current = solved(matrix, [0, 0, 1])
    for pair, expected in (("X_c/V_a", carriage), ("X_h/V_a", head), ("I/V_a", current)):
        assert value(model, pair) == pytest.approx(expected, rel=1e-12)
    (zero,) = model.transfer_function("X_h/V_a").bind().zeros()
    assert complex(zero) == pytest.approx(-v["k"] / v["b"])


def test_a_screw_drive_is_its_shaft_of_waves_between_motor_and_nut():
    model, v = model_and_values("mechatronics/ball_screw")
    lead, polar = v["p"], np.pi * v["d"] ** 4 / 32
    wave = S * (v["rho"] / v["G"]) ** 0.5 * v["l"]
    own = v["G"] * polar / v["l"] * wave
    ends = own / np.sinh(wave) * np.array([[np.cosh(wave), -1], [-1, np.cosh(wave)]])
    nut = v["k_n"]
    matrix = np.zeros((3, 3), complex)
    matrix[:2, :2] = ends
    matrix[0, 0] += v["J_M"] * S**2
    matrix[1:, 1:] += [[lead**2 * nut, -lead * nut], [-lead * nut, nut + v["m"] * S**2 + v["b"] * S]]
    motor, _, carriage = solved(matrix, [1, 0, 0])
    assert value(model, "Phi_M/tau") == pytest.approx(motor, rel=1e-10)
    assert value(model, "X/tau") == pytest.approx(carriage, rel=1e-10)


def test_a_delayed_pendulum_falls_from_the_delay_at_which_its_roots_cross():
    # On s = j omega, P + D j omega = m l^2 (g/l + omega^2) exp(j omega T): omega from the sizes, T from the
    # angles (Stepan 1989).
    model, v = model_and_values("mechatronics/delayed_pendulum")
    inertia, a = v["m"] * v["l"] ** 2, v["g"] / v["l"]
    squares = np.roots([inertia**2, 2 * a * inertia**2 - v["D"] ** 2, (a * inertia) ** 2 - v["P"] ** 2])
    omega = max(squares.real) ** 0.5
    last = np.arctan2(v["D"] * omega, v["P"]) / omega
    found = model.stability(over="T")
    assert [float(end) for end in found.stable[0]] == pytest.approx([0, last], rel=1e-9)


def test_an_absorber_has_den_hartogs_fixed_points():
    # X/F is the same for every damper at two frequencies; there both are sqrt(1 + 2/mu) high.
    model, v = model_and_values("mechatronics/absorber")
    mu, omega = v["mu"], (v["K"] / v["M"]) ** 0.5
    f = 1 / (1 + mu)
    squares = np.roots([2 + mu, -2 * (1 + f**2 + mu * f**2), 2 * f**2])
    tf = model.transfer_function("X/F")
    for r in np.sqrt(squares.real):
        heights = [abs(complex(tf.bind(z=z)(1j * r * omega))) * v["K"] for z in ("0.05", "0.127285", "0.3")]
        assert heights == pytest.approx([(1 + 2 / mu) ** 0.5] * 3, rel=1e-9)


def test_a_wall_and_two_manipulators_have_their_delays():
    model, v = model_and_values("mechatronics/haptic_wall")
    late = np.exp(-S * v["T"] / 2)
    below = v["m"] * S**2 + v["b"] * S + (v["K"] + v["B"] * S) * late
    assert value(model, "X/F") == pytest.approx(1 / below, rel=1e-12)
    model, v = model_and_values("mechatronics/teleoperator")
    late = v["k"] * np.exp(-S * v["T"])
    matrix = [
        [v["m_m"] * S**2 + v["b_m"] * S + v["k"], -late],
        [-late, v["m_s"] * S**2 + v["b_s"] * S + v["k"]],
    ]
    master, slave = solved(matrix, [1, 0])
    assert value(model, "X_m/F_m") == pytest.approx(master, rel=1e-12)
    assert value(model, "X_s/F_m") == pytest.approx(slave, rel=1e-12)


def loudspeaker(v, box):
    """Cone, current and pressure in the box for one volt."""
    s = S
    cone = v["m"] * s**2 + v["r"] * s + v["k"]
    return solved([[cone, -v["Bl"], v["S"]], [v["Bl"] * s, v["R_e"], 0], [-v["S"] * s, 0, box]], [0, 1, 0])


def test_a_closed_box_stiffens_a_loudspeaker():
    model, v = model_and_values("transducers/loudspeaker_closed_box")
    cone, current, _ = loudspeaker(v, v["C_ab"] * S + 1 / v["R_al"])
    assert value(model, "A_cone/E_g") == pytest.approx(S**2 * cone, rel=1e-12)
    assert value(model, "I/E_g") == pytest.approx(current, rel=1e-12)


def test_a_vented_box_radiates_what_cone_and_vent_push():
    model, v = model_and_values("transducers/loudspeaker_vented_box")
    box = v["C_ab"] * S + 1 / (v["M_ap"] * S) + 1 / v["R_al"]
    cone, current, pressure = loudspeaker(v, box)
    out = S**2 * (v["S"] * cone) - S * pressure * (1 / (v["M_ap"] * S) + 1 / v["R_al"])
    assert value(model, "P_far/E_g") == pytest.approx(out, rel=1e-11)
    assert value(model, "I/E_g") == pytest.approx(current, rel=1e-12)


def test_a_stack_with_a_lever_moves_its_load_by_the_voltage():
    model, v = model_and_values("transducers/piezo_lever")
    load = v["m"] * S**2 + v["c"] * S + v["k"]
    matrix = [
        [v["k_p"] + v["n"] ** 2 * load, -v["alpha"]],
        [v["alpha"] * S, v["C"] * S + 1 / v["R"]],
    ]
    stack, electrodes = solved(matrix, [0, 1 / v["R"]])
    assert value(model, "Y/U") == pytest.approx(v["n"] * stack, rel=1e-12)
    assert value(model, "I/U") == pytest.approx((1 - electrodes) / v["R"], rel=1e-12)


def test_a_beam_on_an_intermediate_support_has_the_determinant_of_its_spans():
    model, v = model_and_values("distributed/intermediate_support")
    inner = v["c"] * v["l"]
    outer = v["l"] - inner
    scale = (v["E"] * v["I"] / (v["rho"] * v["A"])) ** 0.5

    def determinant(b):
        # Inner span: A (cosh b x - cos b x) + B (sinh b x - sin b x); outer: from the support, all four.
        cosh, sinh, cos, sin = mpmath.cosh, mpmath.sinh, mpmath.cos, mpmath.sin
        x, y = b * inner, b * outer
        return mpmath.det(
            mpmath.matrix(
                [
                    [cosh(x) - cos(x), sinh(x) - sin(x), 0, 0, 0, 0],
                    [0, 0, 1, 0, 1, 0],
                    [sinh(x) + sin(x), cosh(x) - cos(x), 0, -1, 0, -1],
                    [cosh(x) + cos(x), sinh(x) + sin(x), -1, 0, 1, 0],
                    [0, 0, cosh(y), sinh(y), -cos(y), -sin(y)],
                    [0, 0, sinh(y), cosh(y), sin(y), -cos(y)],
                ]
            )
        )

    for root in model.transfer_function("Y/F").bind().poles()[:6:2]:
        found = mpmath.mpf(abs(complex(root)))
        b = mpmath.findroot(determinant, mpmath.sqrt(found / scale))
        assert float(b**2 * scale) == pytest.approx(float(found), rel=1e-12)


def test_a_pipe_bends_as_the_four_waves_of_its_equation():
    model, v = model_and_values("distributed/fluid_conveying_pipe")
    s = 1.0 + 9.0j
    waves = np.roots([v["EI"], 0, v["U"] ** 2, 2 * v["beta"] ** 0.5 * v["U"] * s, v["m_t"] * s**2])
    tip = np.exp(waves * v["L"])
    matrix = [np.ones(4), waves, waves**2 * tip, v["EI"] * waves**3 * tip]
    assert value(model, "Y/F", s) == pytest.approx(solved(matrix, [0, 0, 0, -1]) @ tip, rel=1e-10)


def zeros_of(model, outputs=(), inputs=(), **values):
    zeros = model.transfer_matrix(outputs, inputs).bind(**values).zeros()
    return sorted((complex(zero) for zero in zeros), key=lambda z: (z.real, z.imag))


SECOND = {"h_1": 0.126, "h_2": 0.13, "h_3": 0.048, "h_4": 0.049, "gamma_1": 0.43, "gamma_2": 0.34}
SECOND |= {"k_1": 3.14e-6, "k_2": 3.29e-6}  # of four tanks in SI units, where the zero is on the right


def test_four_tanks_have_zeros_on_either_side_as_their_valves_are_set():
    # Johansson 2000: (1 + s T_3)(1 + s T_4) = (1 - gamma_1)(1 - gamma_2)/(gamma_1 gamma_2); a zero at 0.013
    # and the relative gains are in print.
    model, v = model_and_values("mechatronics/quadruple_tank")
    for given in ({}, SECOND):
        own = {**v, **given}
        lag, other = (own[f"A_{i}"] / own[f"a_{i}"] * np.sqrt(2 * own[f"h_{i}"] / own["g"]) for i in (3, 4))
        share = (1 - own["gamma_1"]) * (1 - own["gamma_2"]) / (own["gamma_1"] * own["gamma_2"])
        expected = sorted(np.roots([lag * other, lag + other, 1 - share]))
        assert np.allclose(zeros_of(model, **given), expected, rtol=1e-9)
        gain = model.transfer_matrix().bind(**given).rga(0)[0, 0].real
        assert f"{gain:.2f}" == ("-0.64" if given else "1.40")
        assert not given or f"{expected[1]:.3f}" == "0.013"


def test_a_gantry_whose_encoders_are_held_has_the_modes_of_its_head_alone():
    model, v = model_and_values("mechatronics/gantry")
    expected = sorted(np.roots([v["m"], v["b"], v["k"]]), key=lambda z: z.imag)
    assert np.allclose(zeros_of(model, ["X_1", "X_2"]), expected, rtol=1e-9)
    assert zeros_of(model) == []  # with the head measured as well nothing is left to move unseen


def test_a_rotor_in_one_magnetic_bearing_has_the_zeros_of_a_rotor_held_at_its_sensors():
    # In z = x + j y and tau = alpha + j beta, without what B is given and with z = -c tau:
    # forces and moments of A and B leave J tau'' - j J_p Omega tau' + ... = 0, in the force f of bearing A.
    model, v = model_and_values("mechatronics/magnetic_bearing")
    m, J, gyro, a, b, c, k = (v["m"], v["J"], v["J_p"] * v["Omega"], v["a"], v["b"], v["c"], v["k_s"])
    # m z'' - k (2 z + (a - b) tau) = f and J tau'' - j gyro tau' - k ((a - b) z + (a^2 + b^2) tau) = a f:
    # the moment less a times the force, with z = -c tau.
    inertia = J + a * c * m
    stiffness = -k * ((a**2 + b**2) - (a - b) * c) + a * k * ((a - b) - 2 * c)
    expected = [r for sign in (1, -1) for r in np.roots([inertia, -1j * sign * gyro, stiffness])]
    expected = sorted(expected, key=lambda z: (round(z.real, 6), z.imag))
    found = sorted(
        zeros_of(model, ["X_A", "Y_A"], ["i_xA", "i_yA"]), key=lambda z: (round(z.real, 6), z.imag)
    )
    assert np.allclose(found, expected, rtol=1e-9)
