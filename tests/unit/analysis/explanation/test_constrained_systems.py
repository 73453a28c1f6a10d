"""The zeros against the poles of constrained systems that are written down anew, or known from books."""

from math import cos, cosh, pi, sqrt

import numpy as np
import pytest

from symflex import pipeline
from symflex.analysis.explanation import explain_zeros
from symflex.analysis.explanation import zeros as zeros_module
from symflex.roots import Band

DERIVATIONS = "derivations"
# Blevins 1979, table 8-1: clamped-free; roots of cos x cosh x + 1 = 0.
CLAMPED_FREE = (1.87510407, 4.69409113, 7.85475744)


def explained(model, tf, region=None, digits=15):
    (pair,) = pipeline.pick_pairs(model, [tf])
    (bound,) = pipeline.derive_bound(model, [pair])
    found = pipeline.roots(bound, region, digits)
    return explain_zeros(model, bound, found), found


def points(roots):
    return sorted(
        (complex(float(r.re.mid()), float(r.im.mid())) for r in roots for _ in range(r.multiplicity)),
        key=lambda s: (round(s.imag, 6), round(s.real, 6)),
    )


CHAIN = """
symflex = 1
parameters = { m_1 = "1 kg", m_2 = "2 kg", m_3 = "3 kg", m_4 = "4 kg", k_1 = "70 N/m", k_2 = "110 N/m" }
[elements]
body_1 = { type = "mass", at = "x_1", m = "m_1" }
body_2 = { type = "mass", at = "x_2", m = "m_2" }
body_3 = { type = "mass", at = "x_3", m = "m_3" }
body_4 = { type = "mass", at = "x_4", m = "m_4" }
spring_1 = { type = "spring", between = ["x_1", "x_2"], k = "k_1" }
spring_2 = { type = "spring", between = ["x_2", "x_3"], k = "k_2" }
spring_3 = { type = "spring", between = ["x_3", "x_4"], k = "k_1" }
damper_2 = { type = "damper", between = ["x_2", "x_3"], b = "5 N*s/m" }
[inputs]
F_1 = { force = "x_1" }
F_2 = { force = "x_2" }
R   = { force = ["x_2", "x_3"] }
[outputs]
X_1 = "x_1"
A_2 = "s^2*x_2"
X_3 = "x_3"
gap = "x_3 - x_2"
mean = "(x_2 + x_3)/2"
"""

# The chain with its second mass held: what is left on either side stands on the ground.
SECOND_HELD = """
symflex = 1
parameters = { m_1 = "1 kg", m_3 = "3 kg", m_4 = "4 kg", k_1 = "70 N/m", k_2 = "110 N/m" }
inputs  = { F_1 = { force = "x_1" }, F_4 = { force = "x_4" } }
outputs = { X_1 = "x_1", X_4 = "x_4" }
[elements]
body_1 = { type = "mass", at = "x_1", m = "m_1" }
body_3 = { type = "mass", at = "x_3", m = "m_3" }
body_4 = { type = "mass", at = "x_4", m = "m_4" }
spring_1 = { type = "spring", between = ["x_1", "ground"], k = "k_1" }
spring_2 = { type = "spring", between = ["ground", "x_3"], k = "k_2" }
spring_3 = { type = "spring", between = ["x_3", "x_4"], k = "k_1" }
damper_2 = { type = "damper", between = ["ground", "x_3"], b = "5 N*s/m" }
"""


@pytest.fixture(scope="module")
def chain():
    return pipeline.loads(CHAIN)


def poles_of(text, *tfs):
    model = pipeline.loads(text)
    return [root for tf in tfs for root in explained(model, tf)[1].poles]


def test_colocated_zeros_of_a_chain_are_the_poles_of_both_sides_of_the_held_mass(chain):
    told, found = explained(chain, "A_2/F_2")
    assert max(map(len, str(told).splitlines())) <= 80
    assert (told.kind, told.status, told.is_direct, told.order) == ("colocated", "proved", True, 2)
    expected = points(poles_of(SECOND_HELD, "X_1/F_1", "X_4/F_4"))
    ours = points(r for r in (*found.zeros, *(h.root for h in found.hidden)) if not r.is_zero)
    assert np.allclose(ours, expected, rtol=1e-12)
    assert [part.elements for part in told.parts] == [
        ("body_1", "spring_1"),
        ("body_3", "body_4", "spring_2", "spring_3", "damper_2"),
    ]
    assert [part.order for part in told.parts] == [2, 4]


def test_the_line_it_proposes_makes_a_model_with_those_poles(chain):
    told, found = explained(chain, "A_2/F_2")
    line = told.spec.replace("hold = ", "")
    held = CHAIN.replace("[inputs]", f"hold = {line}\n[inputs]")
    poles = [*poles_of(held, "X_1/F_1"), *poles_of(held, "X_3/R")]
    assert np.allclose(points(r for r in found.zeros if not r.is_zero), points(poles), rtol=1e-12)


def test_zeros_beyond_the_output_are_the_poles_of_the_far_side(chain):
    told, found = explained(chain, "A_2/F_1")
    assert max(map(len, str(told).splitlines())) <= 80
    assert (told.kind, told.extra) == ("beyond", "m_1*s^2 + k_1")
    expected = points(poles_of(SECOND_HELD, "X_4/F_4"))
    assert np.allclose(points(r for r in found.zeros if not r.is_zero), expected, rtol=1e-12)
    assert [part.has_input for part in told.parts] == [True, False]


def test_zeros_of_the_path_are_told_from_those_of_the_far_side(chain):
    told, found = explained(chain, "X_3/F_2")
    # The near side adds the resonance of the first mass on its spring and the zero of spring and damper.
    assert told.kind == "partly"
    assert told.transmission in ("(5*s + k_2)*(m_1*s^2 + k_1)", "(m_1*s^2 + k_1)*(5*s + k_2)")
    expected = [-22, 1j * sqrt(70), -1j * sqrt(70), 1j * sqrt(70 / 4), -1j * sqrt(70 / 4)]
    assert np.allclose(points(found.zeros), sorted(expected, key=lambda s: complex(s).imag), rtol=1e-12)


def test_a_force_between_two_masses_is_colocated_with_their_distance(chain):
    told, found = explained(chain, "gap/R")
    assert (told.kind, told.is_direct) == ("colocated", True)
    # Locked together, masses 2 and 3 are one of 5 kg between 1 kg and 4 kg.
    m, k = np.diag([1.0, 5.0, 4.0]), np.array([[70, -70, 0], [-70, 140, -70], [0, -70, 70.0]])
    omega = np.sqrt(
        np.abs(np.linalg.eigvalsh(np.diag(m.diagonal() ** -0.5) @ k @ np.diag(m.diagonal() ** -0.5)))
    )
    ours = points(r for r in (*found.zeros, *(h.root for h in found.hidden)) if r.im > 0)
    assert np.allclose([s.imag for s in ours], omega[1:], rtol=1e-12)


def test_a_mean_of_two_motions_or_another_nodes_is_not_colocated(chain):
    told, _ = explained(chain, "mean/F_2")
    assert (told.kind, told.held) == ("noncolocated", "")
    told, _ = explained(chain, "X_3/F_1")
    assert told.kind != "colocated"
    assert told.spec == "" or "x_3" in told.spec


def test_colocated_zeros_of_the_sliding_beam_are_the_clamped_free_frequencies():
    model = pipeline.load(f"{DERIVATIONS}/eppinger1988/sliding_free_beam.toml")
    told, found = explained(model, "V_act/F", Band(0, 200))
    assert (told.kind, told.status, told.order) == ("colocated", "proved", 1)
    assert [(e.before, e.after) for e in told.ends] == [
        ("sliding at x = 0, free at x = l", "clamped at x = 0, free at x = l")
    ]
    scale = sqrt(200e9 * 4000e-12 / (7850 * 480e-6)) / 1.086**2
    ours = [s.imag for s in points(found.zeros) if s.imag > 0]
    assert np.allclose(ours, [x * x * scale for x in CLAMPED_FREE], rtol=1e-8)


def test_the_tip_zeros_of_the_sliding_beam_are_real_and_come_of_nonpropagating_bending():
    model = pipeline.load(f"{DERIVATIONS}/eppinger1988/sliding_free_beam.toml")
    told, _ = explained(model, "V_tip/F", Band(0, 300))
    assert (told.kind, told.right_half_plane) == ("noncolocated", 3)
    assert all(zero.is_paired for zero in told.real_zeros)
    # cos q cosh q = 0 with q = l*sqrt(s/(2*a)), so that s = 2*a*((n - 1/2)*pi/l)^2 ... on the real axis.
    a = sqrt(200e9 * 4000e-12 / (7850 * 480e-6))
    expected = [2 * a * ((n + 0.5) * pi / 1.086) ** 2 for n in range(3)]
    ours = [float(zero.root.re.mid()) for zero in told.real_zeros]
    assert np.allclose(ours, expected, rtol=1e-6)
    assert told.bending is not None and told.bending.is_evanescent


@pytest.mark.slow
def test_a_motors_winding_gives_no_zero_and_the_held_link_does():
    model = pipeline.load(f"{DERIVATIONS}/eppinger1988/robot_axis.toml")
    told, _ = explained(model, "V_act/V_cmd", Band(0, 100), 8)
    assert (told.kind, told.extra) == ("beyond", "L*s + k_amp*k_current + R")
    assert [part.order for part in told.parts if part.has_input] == [1]
    (link,) = told.ends
    assert link.after.startswith("clamped at x_act, free at x_tip")


def test_a_one_link_arm_is_clamped_where_its_hub_is_held():
    model = pipeline.load(f"{DERIVATIONS}/classics/one_link_arm.toml")
    told, found = explained(model, "theta_hub/tau", Band(0, 30))
    assert told.ends[0].after == "clamped at hub, free at tip with payload"
    # Cantilever with a tip mass (Blevins 1979):
    # 1 + cos x cosh x + (m x/(rho A l)) (cos x sinh x - sin x cosh x) = 0.
    mass, line, EI, length = 0.25, 2700 * 240e-6, 69e9 * 320e-12, 1.1

    def frequency_equation(x):
        ratio = mass / (line * length)
        return 1 + cos(x) * cosh(x) + ratio * x * (cos(x) * np.sinh(x) - np.sin(x) * cosh(x))

    zeros = [s.imag for s in points(found.zeros) if s.imag > 0]
    assert len(zeros) >= 2
    for omega in zeros:
        x = (omega**2 * line / EI) ** 0.25 * length
        assert abs(frequency_equation(x)) < 1e-6 * cosh(x)


MOTOR = """
symflex = 1
[elements]
rotor = { type = "inertia", at = "shaft", J = "0.001 kg*m^2" }
bar   = { type = "torsion_spring", between = ["shaft", "ground"], k = "4 N*m/rad" }
gear  = { type = "transformer", from = "shaft", to = "x", ratio = "5 mm/rad" }
load  = { type = "mass", at = "x", m = "40 kg" }
[elements.motor]
type = "dc_motor"
terminals = ["v", "ground"]
shaft = "shaft"
R = "2 ohm"
L = "3 mH"
k_t = "0.1 N*m/A"
[inputs]
U = { voltage = "v" }
tau = { torque = "shaft" }
[outputs]
i = "motor.i"
x = "x"
theta = "shaft"
far = "motor.i - 3*s*x"
"""


def test_zeros_of_a_current_are_the_poles_with_the_terminals_open():
    told, found = explained(pipeline.loads(MOTOR), "i/U")
    assert (told.kind, told.status) == ("open circuit", "proved")
    inertia = 0.001 + 40 * 0.005**2
    assert np.allclose([abs(s) for s in points(found.zeros)], sqrt(4 / inertia))


def test_an_input_through_a_gear_acts_in_effect_where_the_output_measures():
    told, _ = explained(pipeline.loads(MOTOR), "x/tau")
    assert (told.kind, told.is_direct, told.status) == ("colocated", False, "proved")


def test_a_voltage_input_with_motion_output_is_explained_by_the_driven_winding():
    told, found = explained(pipeline.loads(MOTOR), "theta/U")
    assert not found.zeros
    assert not told.has_zeros
    assert "no zeros" in str(told)


def test_a_mixed_output_is_explained_by_cramers_rule_alone():
    told, _ = explained(pipeline.loads(MOTOR), "far/U")
    assert (told.kind, told.held) == ("noncolocated", "")
    assert "Cramer" in str(told)


def test_an_input_without_effect_has_no_zeros_to_explain():
    text = MOTOR.replace('k_t = "0.1 N*m/A"', 'k_t = "0 N*m/A"\nk_e = "0 V*s/rad"')
    told, _ = explained(pipeline.loads(text), "x/U")
    assert told.kind == "zero"


def test_a_delay_on_the_way_to_the_actuator_has_no_zeros():
    model = pipeline.loads("""
symflex = 1
blocks.D = { type = "delay", T = "5 ms" }
inputs.u = {}
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = 2 }
tail = { type = "mass", at = "y", m = 3 }
link = { type = "spring", between = ["x", "y"], k = 12 }
coil = { type = "force_source", at = "x", f = "D*u" }
""")
    told, found = explained(model, "X/u")
    assert (told.kind, told.is_delayed) == ("colocated", True)
    assert np.allclose([abs(s) for s in points(found.zeros)], 2.0)
    assert "exponentials" in str(told)


def test_a_definition_is_opened_before_factors_are_said_to_be_free_of_s():
    model = pipeline.loads(
        CHAIN.replace("[elements]", '[definitions]\nZ = "m_1*s^2"\n[elements]').replace(
            "[outputs]", '[outputs]\nload = "Z*x_1"'
        )
    )
    told, _ = explained(model, "load/F_1")
    assert (told.kind, told.order) == ("colocated", 2)


def test_without_an_exact_comparison_nothing_is_called_proved(chain, monkeypatch):
    monkeypatch.setattr(zeros_module, "relate", lambda *_: None)
    told, _ = explained(chain, "A_2/F_2")
    assert told.status == "not shown"
    assert "Not proved" in str(told)


@pytest.mark.parametrize(("assume", "proved"), [("nonnegative", True), ("real", False)])
def test_a_foundation_of_unknown_sign_may_carry_waves_at_a_real_s(assume, proved):
    model = pipeline.loads(f"""
symflex = 1
parameters.k_f = {{ value = "3 N/m^2", assume = "{assume}" }}
inputs.F = {{ force = "a" }}
outputs.Y = "b"
[elements]
bar = {{ type = "beam", between = ["a", "b"], E = 1, I = 1, rho = 1, A = 1, l = 1, k_f = "k_f" }}
guide = {{ type = "slider", at = "a" }}
""")
    told, _ = explained(model, "Y/F", Band(0, 20), 8)
    assert told.bending is not None
    assert told.bending.is_evanescent is proved
