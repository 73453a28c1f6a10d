"""Mode shapes against textbooks, independent eigenvectors and the equations they have to satisfy."""

from pathlib import Path

import mpmath
import numpy as np
import pytest
from numpy import cos, cosh, exp, pi, sin, sinh

import symflex
from symflex.errors import UsageError
from tests.independent.classics import CLAMPED_CLAMPED, CLAMPED_FREE
from tests.unit.analysis.systems import words

ROOT = Path(__file__).parents[4]
CLASSICS = ROOT / "derivations" / "classics"
X = np.linspace(0, 1, 21)

MASSES = (3.0, 1.0, 2.0, 5.0, 1.5)
SPRINGS = (700.0, 300.0, 900.0, 200.0, 500.0)  # the first one holds to ground
DAMPERS = (0.0, 2.0, 1.0, 0.5, 3.0)


def chain(dampers=(0.0,) * 5):
    lines = ["symflex = 1", "[elements]"]
    for i, (m, k, b) in enumerate(zip(MASSES, SPRINGS, dampers, strict=True)):
        before = f"x_{i - 1}" if i else "ground"
        lines.append(f'm_{i} = {{ type = "mass", at = "x_{i}", m = "{m} kg" }}')
        lines.append(f'k_{i} = {{ type = "spring", between = ["{before}", "x_{i}"], k = "{k} N/m" }}')
        if b:
            lines.append(f'b_{i} = {{ type = "damper", between = ["{before}", "x_{i}"], b = "{b} N*s/m" }}')
    lines += ["[inputs]", 'F = { force = "x_0" }', "[outputs]", 'X = "x_4"']
    return symflex.loads("\n".join(lines)).transfer_function("X", "F").bind()


def laplacian(values):
    matrix = np.diag(np.array(values) + np.array([*values[1:], 0.0]))
    for i, value in enumerate(values[1:]):
        matrix[i, i + 1] = matrix[i + 1, i] = -value
    return matrix


def vector(shape):
    return np.array([complex(shape[f"x_{i}"]) for i in range(5)])


def scaled(values):
    return values / values[np.argmax(np.abs(values))]


def classic(name, output, source):
    return symflex.load(CLASSICS / f"{name}.toml").transfer_function(output, source).bind()


def of(text, output, source):
    return symflex.loads(f"symflex = 1\n{text}").transfer_function(output, source).bind()


def clamped(x, beta):
    """The shape of Blevins 1979, table 8-1, of a beam clamped at 0 and clamped or free at 1."""
    sign = 1 if abs(np.cos(beta) * np.cosh(beta) + 1) < 1e-6 else -1
    sigma = (
        (sinh(beta) - sin(beta)) / (cosh(beta) + cos(beta))
        if sign > 0
        else (cosh(beta) - cos(beta)) / (sinh(beta) - sin(beta))
    )
    return cosh(beta * x) - cos(beta * x) - sigma * (sinh(beta * x) - sin(beta * x))


def wavenumber(right_side, start):
    return float(mpmath.findroot(lambda x: mpmath.cos(x) * mpmath.cosh(x) - right_side, start))


# ------------------------------------------------------------------------------------- lumped networks


def test_a_damped_chain_moves_as_the_eigenvectors_of_its_state_equations():
    inverse = np.diag(1 / np.array(MASSES))
    state = np.block(
        [[np.zeros((5, 5)), np.eye(5)], [-inverse @ laplacian(SPRINGS), -inverse @ laplacian(DAMPERS)]]
    )
    values, vectors = np.linalg.eig(state)
    bound = chain(DAMPERS)
    for mode in range(1, 6):
        shape = bound.mode_shape(mode)
        column = np.argmin(np.abs(values - complex(shape.pole)))
        assert not shape.is_real, mode
        assert vector(shape) == pytest.approx(scaled(vectors[:5, column]), abs=1e-10), mode


TWO_MASSES = """
parameters = { m = "1 kg", r = "3 kg", k = "7 N/m" }
elements.a = { type = "mass", at = "x", m = "m" }
elements.b = { type = "mass", at = "y", m = "r" }
elements.k = { type = "spring", between = ["x", "y"], k = "k" }
inputs.F   = { force = "x" }
outputs.X  = "x"
"""


def test_the_shape_of_two_masses_is_proved():
    bound = of(TWO_MASSES, "X", "F")
    shape = bound.mode_shape(1, digits=40)
    assert shape.certified
    assert shape.reference == "x"
    with mpmath.workdps(200):
        # Momentum is zero: m x + r y = 0.
        assert abs(shape["y"] + mpmath.mpf(1) / 3) <= shape.radius("y") < mpmath.mpf(10) ** -40
    rigid = bound.mode_shape(0)
    assert [complex(rigid[name]) for name in "xy"] == pytest.approx([1, 1])
    # Given values take the place of declared ones.
    drive = symflex.loads(f"symflex = 1\n{TWO_MASSES}").transfer_function("X", "F")
    assert complex(drive.bind(r=10).mode_shape(1)["y"]) == pytest.approx(-0.1)


def test_a_massless_beam_with_a_rigid_body_satisfies_its_own_equations():
    path = ROOT / "derivations" / "eppinger1988" / "lumped_bending_beam.toml"
    shape = symflex.load(path).transfer_function("X_tip", "F").bind().mode_shape(1)
    y, theta, tip = (complex(shape[name]) for name in ("joint.y", "joint.theta", "tip.y"))
    assert tip == pytest.approx(y + 0.15 * theta)
    # Linear momentum of the sliding mass and of the body about its mass centre is zero.
    assert 10 * complex(shape["act"]) + 2 * (y + 0.075 * theta) == pytest.approx(0, abs=1e-12)


def test_a_node_with_two_components_is_named_by_both_or_by_itself():
    shape = classic("one_link_arm", "y_tip", "tau").mode_shape(1)
    assert shape["tip"] == shape["tip.y"]
    assert "tip.theta" in shape.names


# --------------------------------------------------------------------------------- beams of textbooks


@pytest.mark.slow
def test_a_cantilever_bends_as_blevins_prints():
    bound = classic("clamped_free", "W_tip", "F")
    for mode in (1, 2, 5):
        beta = float(CLAMPED_FREE[:30]) if mode == 1 else wavenumber(-1, (mode - 0.5) * pi)
        expected = clamped(X, beta)
        shape = bound.mode_shape(mode)
        assert shape.along("w", X) == pytest.approx(expected / expected[-1], abs=1e-9), mode


def test_a_clamped_beam_bends_as_blevins_prints():
    shape = classic("clamped_clamped", "W_mid", "p").mode_shape(1)
    beta = float(CLAMPED_CLAMPED[:30])
    assert shape.along("w", X) == pytest.approx(clamped(X, beta) / clamped(0.5, beta), abs=1e-9)


def test_a_pinned_beam_is_a_sine_with_the_forces_of_its_derivatives():
    bound, stiffness = classic("pinned_pinned", "theta_far", "tau"), 200e9 * 4e-9
    for mode in (1, 4):
        shape, q = bound.mode_shape(mode), mode * pi
        for quantity, expected, off in (
            ("y", sin(q * X), 1e-9),
            ("theta", q * cos(q * X), 1e-9),
            ("tau", -stiffness * q**2 * sin(q * X), 1e-7),
            ("f", stiffness * q**3 * cos(q * X), 1e-6),
        ):
            found = shape.along("bar", X, quantity)
            assert found == pytest.approx(expected, rel=1e-9, abs=off), (mode, quantity)


def test_a_free_beam_has_neither_moment_nor_force_at_its_ends():
    bound = classic("free_free", "A_far", "F")
    for mode in (1, 2):
        shape = bound.mode_shape(mode)
        for quantity in ("f", "tau"):
            largest = np.abs(shape.along("bar", X, quantity)).max()
            assert np.abs(shape.along("bar", [0.0, 1.0], quantity)).max() < 1e-12 * largest, (mode, quantity)
        assert np.abs(shape.along("bar", [0.0, 1.0])) == pytest.approx([1, 1]), mode


@pytest.mark.slow
def test_a_stocky_cantilever_meets_its_conditions_and_equations():
    shape = classic("timoshenko_cantilever", "W_tip", "F").mode_shape(2)
    assert shape.quantities("beam") == ("w", "w'", "phi", "phi'")
    x = np.array([0.0, 0.1, 0.3])
    w, slope, phi, bend = (shape.along("beam", x, quantity) for quantity in shape.quantities("beam"))
    assert [w[0], phi[0], bend[2], slope[2] - phi[2]] == pytest.approx([0, 0, 0, 0], abs=1e-10)
    step, shear, density = 1e-5, 0.85 * 77e9 * 2.4e-3, 7850 * 2.4e-3
    around = shape.along("beam", [0.1 - step, 0.1 + step], "w'")
    change = (around[1] - around[0]) / (2 * step)
    square = (complex(shape.pole) ** 2).real
    assert shear * (change - bend[1]) == pytest.approx(density * square * w[1], rel=1e-6)


def test_a_rod_with_a_mass_is_a_sine_from_its_support():
    shape = classic("rod_tip_mass", "X_tip", "F").mode_shape(2)
    wave = abs(complex(shape.pole)) / np.sqrt(200e9 / 7850)
    expected = sin(wave * (1 - X))  # x runs from the mass to the wall
    ratio = shape.along("bar", X[:-1]) / expected[:-1]
    assert ratio == pytest.approx(np.full(20, ratio[0]), rel=1e-9)
    # The rod pulls its mass.
    assert complex(shape["bar.f_a"]).real == pytest.approx(
        3 * (complex(shape.pole) ** 2).real * shape["tip"].real
    )


def test_a_shaft_between_discs_turns_with_the_largest_angle_one():
    shape = classic("shaft_discs", "angle_2", "tau").mode_shape(2)
    dense = shape.along("shaft", np.linspace(0, 1.2, 2001))
    assert np.abs(dense).max() == pytest.approx(1, abs=1e-6)
    assert dense[[0, -1]] == pytest.approx([float(shape["theta_1"].real), float(shape["theta_2"].real)])


def test_a_string_written_as_a_field_is_a_sine():
    text = """
inputs.u  = {}
outputs.W = "w(0.325)"
[fields.w]
domain     = ["0", "0.65"]
equation   = "180*w'' + u = 0.00942*s^2*w"
conditions = ["w(0) = 0", "w(0.65) = 0"]
"""
    assert of(text, "W", "u").mode_shape(1).along("w", 0.65 * X) == pytest.approx(sin(pi * X), abs=1e-9)


@pytest.mark.slow
def test_material_loss_alone_leaves_a_pinned_beam_its_sine():
    unit = 'E = "1 Pa", I = "1 m^4", rho = "1 kg/m^3", A = "1 m^2", l = "1 m"'
    text = f"""
elements.arm  = {{ type = "beam", between = ["p", "q"], {unit}, eta = "0.004 s" }}
elements.near = {{ type = "pin", at = "p" }}
elements.far  = {{ type = "pin", at = "q" }}
inputs.M      = {{ torque = "p.theta" }}
outputs.angle = "p.theta"
"""
    shape = of(text, "angle", "M").mode_shape(2)
    assert shape.damping_ratio > 0.05
    assert shape.along("arm", X) == pytest.approx(sin(2 * pi * X), abs=1e-9)


def test_the_highest_of_many_modes_is_as_accurate_as_the_first():
    shape = classic("clamped_free", "W_tip", "F").mode_shape(20)
    assert shape.along("w", [0.0, 1.0]) == pytest.approx([0, 1], abs=1e-14)
    assert shape.along("w", 1.0, "w''") == pytest.approx(0, abs=1e-9)
    assert shape.radius_along("w", X).max() < 1e-15


# ------------------------------------------------------------------------------------------- networks


@pytest.mark.slow
def test_motor_amplifier_screw_and_link_move_together():
    path = ROOT / "derivations" / "eppinger1988" / "robot_axis.toml"
    shape = symflex.load(path).transfer_function("V_tip", "V_cmd").bind().mode_shape(2)
    s = complex(shape.pole)
    a = {name: complex(shape[name]) for name in shape.names}
    assert a["x_act.y"] == pytest.approx(0.025 / (2 * pi) * a["shaft"])
    assert a["e_1"] == pytest.approx(-4 * 0.03 * s * a["shaft"])
    assert a["v_m"] == pytest.approx(50 * (a["e_1"] - 0.2 * a["motor.i"]))
    assert a["v_m"] == pytest.approx((1.1 + 0.0021 * s) * a["motor.i"] + 0.11 * s * a["shaft"])
    assert a["link.f"] == pytest.approx(3.6 * s**2 * a["x_tip.y"])
    assert shape.along("link", [0, 0.71]) == pytest.approx([a["x_act.y"], a["x_tip.y"]])
    assert shape.along("link", 0, "theta") == pytest.approx(0, abs=1e-12)


OSCILLATOR = """
elements.body = { type = "mass", at = "x", m = "1 kg" }
elements.wall = { type = "spring", between = ["x", "ground"], k = "K N/m" }
elements.loss = { type = "damper", between = ["x", "ground"], b = "B N*s/m" }
inputs.F  = { force = "x" }
outputs.X = "x"
"""


def test_a_delayed_force_lags():
    text = (
        OSCILLATOR.replace("K", "100").replace("B", "4")
        + """
blocks.D  = { type = "delay", T = "0.1 s" }
signals.u = "-3*D*x"
elements.pull = { type = "force_source", at = "x", f = "u" }
"""
    )
    shape = of(text, "X", "F").mode_shape(1)
    s = complex(shape.pole)
    assert shape["x"] == 1
    assert complex(shape["u"]) == pytest.approx(-3 * exp(-0.1 * s))
    assert s**2 + 4 * s + 100 == pytest.approx(complex(shape["u"]), abs=1e-9)


def test_a_field_loaded_by_a_signal_all_along_satisfies_its_equation():
    text = """
signals.q = "-500*w(1/2)"
inputs.F  = {}
outputs.W = "w(1)"
[fields.w]
domain     = ["0", "1"]
equation   = "w'''' + s^2*w = q"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(1) = 0", "w'''(1) = -F"]
"""
    shape = of(text, "W", "F").mode_shape(1)
    assert complex(shape["q"]).real == pytest.approx(-500 * float(shape.along("w", 0.5)))
    step = 1e-5
    third = shape.along("w", [0.3 - step, 0.3 + step], "w'''")
    fourth = (third[1] - third[0]) / (2 * step)
    square = (complex(shape.pole) ** 2).real
    assert fourth + square * shape.along("w", 0.3) == pytest.approx(complex(shape["q"]).real, rel=1e-6)


def test_a_circuit_is_scaled_by_its_largest_voltage():
    text = """
elements.L   = { type = "inductor", between = ["a", "b"], L = "1 H" }
elements.C   = { type = "capacitor", between = ["b", "ground"], C = "1 F" }
elements.C_a = { type = "capacitor", between = ["a", "ground"], C = "2 F" }
inputs.i     = { current = "a" }
outputs.v    = "b"
"""
    shape = of(text, "v", "i").mode_shape(1)
    assert [complex(shape[n]) for n in "ab"] == pytest.approx([-0.5, 1])


@pytest.mark.slow
def test_near_a_pole_the_outputs_stand_in_the_ratio_of_the_shape():
    for path, source, outputs, amplitudes in (
        ("eppinger1988/six_mass", "F", ("X_act", "X_tip"), lambda a: (a["x_act"], a["x_tip"])),
        ("classics/one_link_arm", "tau", ("theta_hub", "y_tip"), lambda a: (a["hub.theta"], a["tip"])),
        ("classics/clamped_free", "F", ("W_mid", "W_tip"), lambda a: (a.along("w", 0.5), a.along("w", 1))),
        ("classics/kelvin_voigt_cantilever", "F", ("M_root", "X_tip"), lambda a: (a["bar.tau"], a["tip"])),
    ):
        model = symflex.load(ROOT / "derivations" / f"{path}.toml")
        first, second = (model.transfer_function(output, source).bind() for output in outputs)
        shape = first.mode_shape(2)
        a, b = (complex(x) for x in amplitudes(shape))
        s = complex(shape.pole) * (1 + 1e-12)
        assert first(s) / second(s) == pytest.approx(a / b, rel=1e-6), path


# ------------------------------------------------------------------------- hidden and multiple modes


@pytest.mark.slow
def test_a_hidden_mode_has_a_shape():
    bound = classic("clamped_clamped", "W_mid", "p")
    hidden = bound.pole_zero_map(modes=2).hidden[0]
    shape = bound.mode_shape(hidden)
    assert repr(bound.mode_shape(symflex.Root(hidden.root))) == repr(shape)
    expected = clamped(X, wavenumber(1, 2.5 * pi))
    assert shape.along("w", 0.5) == pytest.approx(0, abs=1e-9)
    assert shape.along("w", X) == pytest.approx(expected / expected[5] * shape.along("w", X[5]), abs=1e-8)


TWO_ARMS = """
[elements]
one = { type = "rod", between = ["ground", "p"], E = "1 Pa", rho = "1 kg/m^3", A = "1 m^2", l = "1 m" }
two = { type = "rod", between = ["ground", "q"], E = "1 Pa", rho = "1 kg/m^3", A = "1 m^2", l = "1 m" }
[inputs]
F = { force = "p" }
[outputs]
Y = "p"
"""


def test_two_equal_arms_have_two_shapes_at_one_pole():
    bound = of(TWO_ARMS, "Y", "F")
    first, second = bound.mode_shapes(1)
    assert [complex(first[n]) for n in "pq"] == pytest.approx([1, 0])
    assert [complex(second[n]) for n in "pq"] == pytest.approx([0, 1])
    assert first.along("one", X) == pytest.approx(second.along("two", X))
    assert not first.certified
    with pytest.raises(UsageError, match=r"SF904.*2 independent shapes"):
        bound.mode_shape(1)


def test_the_modes_of_a_double_pole_share_its_shapes():
    text = """
elements.a = { type = "mass", at = "x", m = "1 kg" }
elements.b = { type = "mass", at = "y", m = "1 kg" }
elements.c = { type = "spring", between = ["x", "ground"], k = "4 N/m" }
elements.d = { type = "spring", between = ["y", "ground"], k = "4 N/m" }
inputs.F  = { force = "x" }
outputs.X = "x"
"""
    first, second = of(text, "X", "F").mode_shapes(1)
    assert [complex(first[n]) for n in "xy"] == pytest.approx([1, 0])
    assert [complex(second[n]) for n in "xy"] == pytest.approx([0, 1])


def test_a_double_pole_with_one_shape_has_no_second_mode():
    bound = of(OSCILLATOR.replace("K", "1").replace("B", "2"), "X", "F")  # (s + 1)^2
    assert bound.mode_shape(1)["x"] == 1
    with pytest.raises(UsageError, match="SF904"):
        bound.mode_shape(2)


def test_a_free_beam_shifts_and_turns_at_the_origin():
    shapes = classic("free_free", "A_far", "F").mode_shapes(0)
    assert len(shapes) == 2
    for shape in shapes:
        # Rigid: the slope is the difference of the ends, and nothing is loaded.
        y, theta = shape.along("bar", X), shape.along("bar", X, "theta")
        assert theta == pytest.approx(np.full(21, y[-1] - y[0]))
        assert shape.along("bar", X, "tau") == pytest.approx(np.zeros(21), abs=1e-12)


def test_a_hub_with_an_arm_turns_rigidly_at_the_origin():
    shape = classic("one_link_arm", "y_tip", "tau").mode_shape(0)
    assert shape.along("link", [0, 0.55, 1.1]) == pytest.approx([0, 0.5, 1])
    assert shape.pole.multiplicity == 2


# --------------------------------------------------------------------------------------------- errors


def test_there_are_only_as_many_modes_as_there_are():
    bound = chain()
    for mode, said in (
        (6, "has only 5 modes besides those at s = 0; mode 6 does not exist"),
        (0, "no pole at 0"),  # it is held, and has no motion as a rigid body
        (-1, ""),
    ):
        found = words(bound.mode_shape, mode)
        assert "UsageError" in found and "SF902" in found and said in found, mode


def test_a_zero_has_no_shape():
    bound = (
        symflex.load(ROOT / "derivations/eppinger1988/two_mass.toml").transfer_function("X_act", "F").bind()
    )
    with pytest.raises(UsageError, match=r"SF902.*is not a pole"):
        bound.mode_shape(bound.zeros()[0])


def test_the_pole_of_a_filter_in_an_output_has_no_shape():
    for output in ("x/(s + 5)", "u/(s + 5)"):
        motion = 'm = { type = "mass", at = "x", m = "1 kg" }' if "x" in output else ""
        given = '{ force = "x" }' if motion else "{}"
        bound = of(f'[elements]\n{motion}\n[inputs]\nu = {given}\n[outputs]\nY = "{output}"', "Y", "u")
        found = words(bound.mode_shape, 1)
        assert "SF902" in found and "is not a pole of the model's equations" in found, output


def test_what_is_not_there_is_refused():
    lumped = chain().mode_shape(1)
    shape = classic("pinned_pinned", "theta_far", "tau").mode_shape(1)
    for ask, arguments, code, said in (
        (lumped.__getitem__, ("x_9",), "SF902", "nothing is called 'x_9'"),
        (lumped.along, ("x_0", 0), "SF902", "is not a distributed element"),
        (shape.along, ("bars", 0), "SF902", "did you mean 'bar'"),
        (shape.along, ("bar", 0, "taw"), "SF902", "did you mean 'tau'"),
        (shape.along, ("bar", 1.1), "SF240", "reaches from 0 to 1"),
        (shape.along, ("bar", float("nan")), "SF240", ""),
    ):
        found = words(ask, *arguments)
        assert "UsageError" in found and code in found and said in found, arguments
