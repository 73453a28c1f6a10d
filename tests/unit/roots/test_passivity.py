"""Loops and fields that are proved to be passive, what only looks so, and finite elements that agree."""

from fractions import Fraction
from math import cos, cosh, pi, sin, sinh
from string import Template

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.linalg import eigvals, expm

from symflex import pipeline
from symflex.errors import SpecError
from symflex.loops.of_model import stability
from symflex.options import StabilityOptions
from symflex.roots import Band, Modes
from symflex.roots.passivity import EnergyProof, energy_proof

ARM = Template("""
symflex = 1
parameters = { K = "3 N*m/rad", T = "0.2 s", n = 2, I_0 = "1 m^4", A_0 = "1 m^2", l = "1 m" }
inputs.r = { unit = "rad" }
outputs.y = "tip"
signals.e = "r - hub.theta"
[elements]
bearing = { type = "pin", at = "hub" }
rotor = { type = "inertia", at = "phi", J = "0.1 kg*m^2" }
gears = { type = "transformer", from = "phi", to = "hub.theta", ratio = "1/n" }
arm = { type = "beam", between = [$between], E = "2 Pa", rho = "1 kg/m^3", l = "l", $section }
load = { type = "mass", at = "tip", m = "0.5 kg" }
motor = { type = "torque_source", at = "phi", tau = "$tau" }
$more
""")
PD = "K/n*(r - (1 + T*s)*hub.theta)"
UNIFORM = 'I = "I_0", A = "A_0"'
TIMOSHENKO = UNIFORM + ', theory = "timoshenko", kappa = "1", G = "1 Pa"'


def arm(tau=PD, section=UNIFORM, between='"hub", "tip"', more=""):
    """Return a flexible arm on a geared motor: at the hub EI = 2 N m^2 and rho A = 1 kg/m, l = 1 m."""
    return pipeline.loads(ARM.substitute(tau=tau, section=section, between=between, more=more))


def closed(model):
    return energy_proof(model, free=("K",))


def test_pd_control_of_a_geared_joint_is_a_spring_and_a_damper_at_the_rotor():
    for between in ('"hub", "tip"', '"tip", "hub"'):
        found = closed(arm(between=between))
        # A torque K/n (1 + T s) phi/n at the rotor's angle phi.
        assert (found.stiffness, found.damping, found.rests) == pytest.approx((1 / 4, 0.2 / 4, True)), between


def test_a_loop_closed_by_signals_is_followed_through_them():
    found = closed(arm("K*e - K*T*s*phi"))
    # The rotor turns twice as far as the hub.
    assert (found.stiffness, found.damping, found.rests) == pytest.approx((1 / 2, 0.2, True))


def test_other_loops_are_not_taken_for_passive():
    for tau in [
        "K/n*(r - tip/l)",  # not where it acts
        "K*(hub.theta - r)",  # of the wrong sign
        "K*(r - (1 - T*s)*hub.theta)",
        "K*(r - hub.theta)/(1 + T*s)",  # lags
        "K*(r - (1 + 1/(T*s))*hub.theta)",
        "K*(r - T^3*s^3*hub.theta)",
        "K*(r - hub.theta) - arm.tau",
        "K/n*(r/(1 - T*s) - (1 + T*s)*hub.theta)",  # what the reference passes grows
        "K/n*(1 - T*s)/(1 - T*s)*(r - (1 + T*s)*hub.theta)",  # cancels, but grows
    ]:
        assert not closed(arm(tau)).reason


def test_a_gain_that_elements_hold_is_passive_only_if_they_are_for_all_its_values():
    support = 'support = { type = "torsion_spring", between = ["hub", "ground"], k = "VALUE" }'
    for value, expected in (("K", True), ("4*K_0 - K", False)):  # with K = 3 K_0
        text = ARM.substitute(
            tau=PD, section=UNIFORM, between='"hub", "tip"', more=support.replace("VALUE", value)
        )
        model = pipeline.loads(text.replace("parameters = {", 'parameters = { K_0 = "1 N*m/rad",'))
        assert energy_proof(model).is_passive, value
        assert closed(model).is_passive is expected, value


def test_nothing_is_said_with_loss_factors_which_hold_at_positive_frequencies_alone():
    lossy = 'spring = { type = "torsion_spring", between = ["hub", "ground"], k = "K", eta_s = 0.02 }'
    assert not energy_proof(arm(more=lossy)).reason
    assert energy_proof(arm(more=lossy.replace(", eta_s = 0.02", ""))).reason


def test_nothing_is_said_of_a_loop_on_a_compressed_arm():
    pressed = arm(section=UNIFORM + ', N = "-1 N"')
    assert not energy_proof(pressed).reason
    assert not closed(pressed).reason


def test_a_law_with_a_filter_is_passive_where_force_over_velocity_is_positive_real():
    """Judged by the poles of that and by its real part at many frequencies."""
    omega = 1j * np.geomspace(1e-3, 1e4, 2000)
    for law, above, below in [
        ("1 + T*s/(1 + T*s/20)", [0.21, 1], [0.01, 1, 0]),  # filtered PD
        ("(1 + T*s)/(1 + T*s/20)", [0.2, 1], [0.01, 1, 0]),  # leads
        ("(1 + T*s/20)/(1 + T*s)", [0.01, 1], [0.2, 1, 0]),  # lags
        ("T*s/(1 + T*s)", [0.2], [0.2, 1]),  # a velocity, filtered
        ("T*s/(1 + T*s)^2", [0.2], [0.04, 0.4, 1]),  # filtered twice
        ("T*s/(1 - T*s)", [0.2], [-0.2, 1]),  # grows by itself
        ("1 + T*s/(1 + T*s/20) + 1/(T*s)", [0.042, 1.01, 5], [0.01, 1, 0, 0]),  # with an integral
        ("F*(1 + T*s)", [0.028, 0.34, 1], [0.04, 0.4, 1, 0]),  # by a block
        ("F*T*s", [0.028, 0.2], [0.04, 0.4, 1]),
    ]:
        tau = f"K/n*({law})*(r - hub.theta)"
        text = ARM.substitute(tau=tau, section=UNIFORM, between='"hub", "tip"', more="")
        block = 'blocks.F = { type = "tf", num = "1 + 0.7*T*s", den = "(1 + T*s)^2" }'
        model = pipeline.loads(text.replace("[elements]", f"{block}\n[elements]") if "F" in law else text)
        real = (np.polyval(above, omega) / np.polyval(below, omega)).real
        is_passive = max(np.roots(below).real) <= 0 <= min(real)
        assert closed(model).is_passive == is_passive, law


def test_a_gain_may_be_a_mass_of_which_no_phase_is_known():
    found = closed(arm("K*(r - T^2*s^2*hub.theta)"))
    assert (found.stiffness, found.damping, found.least_phase_margin(2.0)) == (0, 0, 0)


def test_of_a_beam_with_rotatory_inertia_nothing_is_said_about_the_axis():
    found = closed(arm(section=TIMOSHENKO))
    assert found.is_passive
    assert not found.rests


def test_a_mode_that_the_joint_does_not_feel_is_not_overlooked():
    """A spring and an inertia at the tip for which the clamped arm needs no moment at its base."""
    x, ei, m = 2.0, 2.0, 0.5
    square = ei * x**4
    y, slope = (sinh(x) - sin(x)) / 2, x * (cosh(x) - cos(x)) / 2
    bending, shear = ei * x**2 * (sinh(x) + sin(x)) / 2, ei * x**3 * (cosh(x) + cos(x)) / 2
    # Balance of the tip: shear = (k - m omega^2) y, bending moment = J omega^2 slope.
    k, J = shear / y + m * square, bending / (square * slope)
    spring = f'spring = {{ type = "spring", between = ["tip", "ground"], k = "{k!r} N/m" }}'
    gripper = f'gripper = {{ type = "inertia", at = "tip.theta", J = "{J!r} kg*m^2" }}'
    assert not closed(arm(more=f"{spring}\n{gripper}")).rests
    # With a mass alone it has to pull where it pushes.
    assert closed(arm(more=gripper)).rests


SHEARED = """
symflex = 1
parameters = { K = "0.4 N*m/rad", N_0 = "4.5 N", a = "2 m" }
inputs.r = { unit = "rad" }
outputs.y = "hub.theta"
elements.left = { type = "pin", at = "hub" }
elements.right = { type = "pin", at = "end" }
elements.rotor = { type = "inertia", at = "hub.theta", J = "0.1 kg*m^2" }
elements.motor = { type = "torque_source", at = "hub.theta", tau = "K*(r - hub.theta)" }
elements.arm = { type = "beam", between = ["hub", "end"], E = 2, I = 1, A = 1, rho = 1, l = 1, MORE }
"""
SHEARS_TOO = 'theory = "timoshenko", kappa = 1, G = 4'


def test_a_foundation_does_not_damp_sections_that_turn_without_deflection():
    """At omega^2 = kappa G A/(rho I) = 4 they turn alike; with K = 0.1 * 4 so does the rotor."""
    for loss, rests in [("c_f = 1", False), ("eta = 0.001", True)]:
        assert closed(pipeline.loads(SHEARED.replace("MORE", f"{SHEARS_TOO}, {loss}"))).rests is rests


def test_a_turning_blade_may_flap_without_strain():
    """With N = N_0 (1 - x^2/a^2), as of a blade with tip mass, y = x solves at rho A omega^2 = 2 N_0/a^2."""
    for tension, rests in [("", True), (', N = "N_0*(1 - x^2/a^2)"', False)]:
        text = SHEARED.replace('elements.right = { type = "pin", at = "end" }\n', "")
        assert closed(pipeline.loads(text.replace("MORE", f"eta = 0.001{tension}"))).rests is rests


SECOND = 'second = { type = "beam", between = [BETWEEN], E = "2 Pa", rho = "1 kg/m^3", l = "l", SECTION MORE}'


def test_a_second_beam_rests_where_it_cannot_move_by_itself():
    for between, more, rests in [
        ('"tip", "end"', "", True),  # after the first, with a mass between them
        ('"end", "tip"', "", False),  # folded back over the first
        ('"hub", "end"', "", False),  # two alike may swing against each other, the hub at rest
        ('"ground", "end"', "", False),  # nothing is felt of it
        ('"hub", "end"', ', eta = "1 ms"', True),
        ('"hub", "end"', ', c_f = "1 N*s/m^2"', True),
    ]:
        second = SECOND.replace("BETWEEN", between).replace("MORE", more).replace("SECTION", UNIFORM)
        assert closed(arm(more=second)).rests is rests, (between, more)


def test_a_second_beam_behind_an_inertia_is_not_taken_to_rest():
    """Its moment bends the second beam the other way, and both may swing with the hub at rest."""
    second = SECOND.replace("BETWEEN", '"tip", "end"').replace("MORE", "").replace("SECTION", UNIFORM)
    body = 'body = { type = "inertia", at = "tip.theta", J = "1 kg*m^2" }'
    assert not closed(arm(more=f"{second}\n{body}")).rests


def beam_matrices(count, depth):
    """Return mass and stiffness of a beam of length 1, EI = 2 depth^3, rho A = depth, in cubic elements."""
    h, size = 1 / count, 2 * count + 2
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
    k = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    lengths = np.array([1, h, 1, h])
    for i in range(count):
        at = slice(2 * i, 2 * i + 4)
        d = depth((i + 0.5) * h)
        mass[at, at] += m * np.outer(lengths, lengths) * h * d
        stiffness[at, at] += 2 * d**3 * k * np.outer(lengths, lengths) / h**3
    return mass, stiffness


HELD = """
symflex = 1
inputs.F = { force = "tip" }
outputs.X = "tip"
elements.arm = { type = "beam", between = ["ground", "tip"], E = 1, I = 1, rho = 1, A = 1, l = 1, $section }
"""
TURNING = 'theory = "timoshenko", G = 1, kappa = 1, c_f = 0.1'
ABSORBER = """
elements.load = { type = "mass", at = "a", m = 0.1 }
elements.hold = { type = "spring", between = ["tip", "a"], k = 0.2 }
elements.loss = { type = "damper", between = ["tip", "a"], b = 0.05 }
"""
STRUNG = """
symflex = 1
inputs.F = { force = "tip" }
outputs.X = "tip"
elements.one = { type = "string", between = ["ground", "tip"], N = 1, rhoA = 1, l = 1 }
elements.two = { type = "string", between = ["tip", "ground"], N = 1, rhoA = 1, l = 1 }
"""


def all_rests(text, section="eta = 0"):
    return energy_proof(pipeline.loads(Template(text).substitute(section=section))).rests


def test_what_loses_energy_rests_on_the_axis_if_an_end_is_held():
    # Without strain a beam moves as a rigid body; without deflection its sections turn as the shear force
    # says, which is one number. A clamp allows neither, a pin both.
    for section in ('theory = "rayleigh", eta = 0.01', "k_f = 1, eta = 0.01", TURNING):
        assert all_rests(HELD, section), section
        pinned = HELD.replace("ground", "base") + 'elements.pin = { type = "pin", at = "base" }'
        assert not all_rests(pinned, section), section


CANTILEVER = """
symflex = 1
parameters = { E = "2 Pa", tau = "0.1 s", G = "4 Pa", k_0 = "3 N/m^2", c_0 = "2 N*s/m^2" }
inputs.F = { force = "tip" }
outputs.X = "tip"
definitions.E_c = "E*(1 + tau*s)"
elements.arm = { type = "beam", between = ["ground", "tip"], I = 1, A = 1, rho = 1, l = 1, $section }
"""
SHEARS = 'theory = "timoshenko", kappa = 1'


@pytest.mark.parametrize(
    ("values", "is_passive", "rests"),
    [
        ('E = "E"', True, False),
        ('E = "(s*tau + 1)*E"', True, True),  # as eta = tau
        ('E = "E_c"', True, True),
        ('E = "E + 0.2*s"', True, True),
        ('E = "E - 0.2*s"', False, False),
        ('E = "E*(1 + tau*s^2)"', False, False),
        ('E = "E", k_f = "k_0 + c_0*s"', True, True),  # as c_f = c_0, which holds every section
        ('E = "E", k_f = "k_0 - c_0*s"', False, False),
        (f'E = "E_c", G = "G*(1 + tau*s)", {SHEARS}', True, True),
        (f'E = "E_c", G = "G", {SHEARS}', True, False),  # shear alone loses nothing: not told
        (f'E = "E", G = "G*(1 + tau*s)", {SHEARS}', True, False),
    ],
)
def test_a_modulus_with_a_loss_in_it_is_damping_of_the_material(values, is_passive, rests):
    proof = energy_proof(pipeline.loads(Template(CANTILEVER).substitute(section=values)))
    assert (proof.is_passive, proof.rests) == (is_passive, rests)


def test_an_absorber_without_strain_moves_with_the_tip_and_holds_it():
    # Its mass alone is left, m s^2 x = 0. A cantilever rests if three of four quantities do at its tip.
    assert all_rests(HELD + ABSORBER)
    # In the middle of a string it does not feel every other mode.
    assert not all_rests(STRUNG + ABSORBER)


def test_a_dashpot_at_the_tip_stops_a_cantilever_that_is_pulled():
    # A mode that the dashpot does not feel would be one of a clamped beam whose tip turns alone. At any
    # frequency a tension adds to the deflection that the turn then gives at the clamp: it is never zero.
    text = 'symflex = 1\ninputs.F = { force = "tip" }\noutputs.X = "tip"\n[elements]\n'
    text += 'loss = { type = "damper", between = ["tip", "ground"], b = 1 }\n'
    text += 'arm = { type = "beam", between = ["ground", "tip"], EI = 1, rhoA = 1, l = 1, N = $section }'
    for tension in (0, 5, 400):
        assert all_rests(text, str(tension)), tension
        for square in np.geomspace(1e-4, 1e6, 30):  # deflection, slope, moment and force, from the tip on
            law = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, tension, 0, 1], [square, 0, 0, 0]])
            assert expm(law)[0, 1] >= 1
    # Where it is pressed, the sum is not of one sign, and nothing is said.
    found = energy_proof(pipeline.loads(Template(text).substitute(section="-1")))
    assert found.limit
    assert not found.rests


def test_finite_elements_are_stable_too():
    for taper, gain in ((0.0, 0.01), (0.5, 3.0), (0.5, 250.0)):
        mass, stiffness = beam_matrices(12, lambda x, taper=taper: 1 - taper * x)
        mass, stiffness = mass[1:, 1:], stiffness[1:, 1:]  # the hub is pinned
        damping = np.zeros_like(mass)
        mass[0, 0] += 0.1 * 2**2  # the rotor, n^2 times at the hub
        mass[-2, -2] += 0.5
        stiffness[0, 0] += gain
        damping[0, 0] += 0.2 * gain
        one, zero = np.eye(len(mass)), np.zeros_like(mass)
        found = eigvals(
            np.block([[zero, one], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
        )
        assert found.real.max() < 0, (taper, gain)


@pytest.mark.slow
def test_every_gain_of_a_joint_loop_is_certified():
    model = arm()
    found = stability(model, StabilityOptions(gain="K", up_to="1 Hz"))
    assert found.certified
    (only,) = found.intervals
    assert only.poles.is_stable
    assert found.phase_margins
    # At the rotor the velocity and the torque on it differ by 90 degrees at most.
    for margin in found.phase_margins:
        least = closed(model).least_phase_margin(float(margin.frequency.mid()))
        assert abs(float(margin.angle.mid())) >= least


@pytest.mark.slow
def test_where_a_loop_has_no_damping_of_its_own_phase_margins_beyond_are_not_certified():
    loss = 'loss = { type = "rotary_damper", between = ["phi", "ground"], b = "0.1 N*m*s/rad" }'
    model = arm("K*(r - phi)", more=loss)
    assert closed(model).rests
    found = stability(model, StabilityOptions(gain="K", up_to="1 Hz"))
    assert not found.certified
    assert found.is_complete
    assert found.reasons == ("phase margins above 1 Hz are not known",)


AXLE = """
symflex = 1
parameters = { K = "1 N*m/rad", T = "0.1 s" }
inputs.r = { unit = "rad" }
outputs.y = "phi"
elements.rotor = { type = "inertia", at = "phi", J = "1 kg*m^2" }
elements.axle = { type = "shaft", between = ["phi", "end"], GJ = "1 N*m^2", rhoJ = "1 kg*m", l = "1 m" }
elements.motor = { type = "torque_source", at = "phi", tau = "K*(r - phi)*LAW" }
"""


@pytest.mark.slow
def test_a_lead_holds_a_shaft_without_loss_and_a_lag_is_said_to_shake_it():
    """``(1 + a s)/(1 + b s)`` damps where a > b: at s = j omega its imaginary part has the sign of a - b."""
    for law, word in [("(1 + T*s)/(1 + T*s/9)", "stable"), ("(1 + T*s/9)/(1 + T*s)", "unstable")]:
        found = stability(pipeline.loads(AXLE.replace("LAW", law)), StabilityOptions(gain="K"))
        assert found.verdict.word == word, law
        assert found.reasons, law  # neither is certified: how far poles are counted, or phase margins


def test_no_phase_margin_above_a_frequency_is_below_that_of_spring_and_damper():
    # arg(k + j omega d); the force on a passive structure and its velocity differ by 90 degrees at most.
    for stiffness, damping, least in ((3.0, 2.0, pi / 4), (3.0, 0.0, 0.0), (-1.0, 2.0, pi / 2)):
        found = EnergyProof(stiffness=stiffness, damping=damping).least_phase_margin(1.5)
        assert found == pytest.approx(least), (stiffness, damping)


def judged(tau, region):
    model = arm(tau)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    return pipeline.roots(bound, region).verdict


def test_poles_of_a_passive_loop_are_left_of_the_axis_and_those_of_one_that_pushes_are_not():
    found = judged(PD, Modes(1))
    assert found.word == "stable"
    assert found.sentence == "stable: passive, nothing supplies energy"
    assert judged("K*(r + phi)", Modes(1)).word == "unstable"


def test_a_loop_without_a_spring_leaves_a_pole_at_0_wherever_others_are_sought():
    # A torque -K T s phi alone: the arm turns freely.
    found = judged("K*T*s*(r - phi)", Band(Fraction(2), Fraction(3)))
    # The input does not see where it comes to rest.
    assert found.headline == "stable, with a hidden pole at s = 0"


# ------------------------------------------------------------------------------- elements, by their values

MEMBERS = 'symflex = 1\ndefinitions.G = "E/(2*(1 + nu))"\nparameters = { E = "200 Pa", rho = "1 kg/m^3", '
MEMBERS += (
    'nu = { value = "NU", assume = "real" }, A = "1 m^2", A_1 = "3 m^2", I = "1 m^4", l = "1 m", m = "2 kg", '
)
MEMBERS += (
    'k = "3 N/m", b = "1 N*s/m", C = "2 F", R = "1 Ohm", L = "1 H", k_t = "2 N*m/A", k_e = "KE V*s/rad" }\n'
)
ROD = """
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
rod = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l" }
"""
FOLLOWS = ROD + 'follows = { type = "force_source", at = "y", f = "FORCE" }\n'
SHAFT = """
inputs.T = { torque = "x" }
outputs.X = "x"
elements.rod = { type = "shaft", between = ["ground", "x"], G = "SHEAR", J = "I", rho = "rho", l = "l" }
"""
PINNED = """
inputs.T = { torque = "b.theta" }
outputs.X = "b.theta"
[elements]
left = { type = "pin", at = "a" }
right = { type = "pin", at = "b" }
beam = { type = "beam", between = ["a", "b"], E = "E", I = "I", A = "A", rho = "rho", l = "l", SHEARS }
""".replace("SHEARS", 'theory = "timoshenko", G = "G", kappa = "5/6"')
COIL = ROD.replace('E = "E"', 'E = "E*A_1/A"').replace('rho = "rho"', 'rho = "rho*A_1/A"')
MOTOR = """
inputs.u = { unit = "V" }
outputs.X = "x"
[elements]
rod = { type = "shaft", between = ["phi", "x"], G = "G", J = "I", rho = "rho", l = "l" }
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "phi", R = "R", MORE }
supply = { type = "voltage_source", between = ["v", "ground"], v = "u" }
""".replace("MORE", 'L = "L", k_t = "k_t", k_e = "k_e"')
LEAK = 'leak = { type = "current_source", at = "v_2", i = "CURRENT" }\n'
CURRENT = MOTOR + LEAK + 'resistor = { type = "resistor", between = ["v", "v_2"], R = "R" }\n'


def members(text, nu="0.3", k_e="2"):
    return pipeline.loads(MEMBERS.replace("NU", nu).replace("KE", k_e) + text)


def word(model):
    (tf,) = pipeline.derive_bound(model, [model.transfer_functions[0]])
    return pipeline.roots(tf, Modes(1)).verdict


@pytest.mark.slow
def test_signs_are_told_with_numbers_whatever_the_form_of_a_value():
    for text in (SHAFT.replace("SHEAR", "E/(2*(1 + nu))"), SHAFT.replace("SHEAR", "G"), PINNED, COIL):
        for nu in ("0.3", "-0.3"):
            assert word(members(text, nu)).sentence.endswith("passive, nothing supplies energy"), text


def test_a_modulus_that_is_negative_with_its_numbers_is_refused():
    with pytest.raises(SpecError, match=r"G of shaft 'rod' is negative \(-200\)"):
        members(SHAFT.replace("SHEAR", "E/(2*(1 + nu))"), "-1.5")


def test_motor_constants_that_are_equal_by_value_make_a_passive_motor():
    assert word(members(MOTOR)).reason == "a pole at 0; passive, nothing supplies energy"
    assert not energy_proof(members(MOTOR, k_e="2.5")).is_passive


def test_sources_that_act_as_springs_dampers_and_masses_supply_nothing():
    second = 'more = { type = "force_source", at = "x", f = "-b*s*x - m*s^2*x" }\n'
    inputs = 'inputs.F_2 = { unit = "N" }\ninputs.a = { unit = "m" }\ninputs.F ='
    for force in ("-m*s^2*y", "-k*y", "F_2 - m*s^2*y", "-m*s^2*a", "-(k + b*s + m*s^2)*y"):
        text = FOLLOWS.replace("FORCE", force).replace("inputs.F =", inputs)
        for more in ("", second):
            assert closed(members(text + more)).is_passive, (force, more)


def test_sources_that_supply_energy_are_not_taken_for_springs_dampers_or_masses():
    for force in ("m*s^2*y", "k*y", "-m*s^2*x", "-m*b/k*s^3*y", "-k*y/(1 + b*s/k)", "b*s*y - m*s^2*y"):
        assert not closed(members(FOLLOWS.replace("FORCE", force))).reason, force


def test_a_source_between_two_nodes_is_a_spring_and_a_damper_by_what_moves_between_them():
    turns = FOLLOWS.replace('at = "y"', 'between = ["y", "x"]')
    for force, is_one in (
        ("-(k + b*s)*(y - x)", True),
        ("b*s*(x - y)", True),
        ("(k + b*s)*(y - x)", False),  # of the wrong sign
        ("-k*y", False),  # not relative
        ("-k*(y - x/2)", False),
    ):
        assert closed(members(turns.replace("FORCE", force))).is_passive is is_one, force


@pytest.mark.slow
def test_poles_of_a_network_are_left_of_the_axis_where_a_motor_in_a_joint_is_a_damper():
    (tf,) = pipeline.derive_bound(pipeline.load("derivations/frames/two_link_arm.toml"), [("theta_2", "tau")])
    verdict = pipeline.roots(tf, Modes(1)).verdict
    assert (verdict.word, verdict.certified) == ("marginal", True)


def test_a_current_that_follows_a_voltage_is_a_resistor_or_a_capacitor():
    # Of a voltage the derivative does no work: the second one is no inertia.
    for current, is_one in (("-v_2/R", True), ("-C*s*v_2", True), ("-C*b/k*s^2*v_2", False)):
        assert closed(members(CURRENT.replace("CURRENT", current))).is_passive is is_one, current


def test_what_is_held_moves_as_it_is_told_and_supplies_nothing():
    base = ROD.replace('F = { force = "x" }', 'a = { displacement = "x" }').replace('X = "x"', 'Y = "y"')
    assert energy_proof(members(base + 'load = { type = "mass", at = "y", m = "m" }\n')).is_passive


# ---------------------------------------------------------------------------------------------- fields


HEAD = """
symflex = 1
inputs.F = { unit = "N" }
parameters = { EI = "2 N*m^2", T = "3 N", rhoA = "1.5 kg/m", J = "0.1 kg*m", kGA = "50 N", MORE }
""".replace(
    "MORE", 'c = "0.2 N*s/m^2", k = "7 N/m", m = "0.4 kg", eta = "0.01 s", v = "0.3 m/s", l = "1.2 m"'
)
FIELD = """
[fields.w]
domain = ["0", "l"]
equation = "EQUATION"
conditions = CONDITIONS
[outputs]
y = "w(l)"
"""
BEAM = "EI*w'''' + rhoA*s^2*w = 0"
PULLED = "EI*w'''' - T*w'' + rhoA*s^2*w = 0"
PUSHED = "EI*w'''' - (T*(1 - 2*x/l)*w')' + rhoA*s^2*w = 0"
LOSSY = "EI*(1 - eta*s)*w'''' + rhoA*s^2*w = 0"
STRING = "T*w'' = rhoA*s^2*w"
CLAMPED = ["w(0) = 0", "w'(0) = 0"]
FREE = [*CLAMPED, "w''(l) = 0", "EI*w'''(l) = -F"]
FIXED = ["w(0) = 0", "T*w'(l) = F"]


def model_of(equation, conditions):
    shown = "[" + ", ".join(f'"{each}"' for each in conditions) + "]"
    return pipeline.loads(HEAD + FIELD.replace("EQUATION", equation).replace("CONDITIONS", shown))


def known(model):
    return energy_proof(model).is_passive


PASSIVE = {
    "cantilever": (BEAM, FREE),
    "pinned at both ends": (BEAM, ["w(0) = 0", "w''(0) = 0", "w(l) = 0", "EI*w''(l) = F*l"]),
    "free at both ends": (BEAM, ["w''(0) = 0", "w'''(0) = 0", "w''(l) = 0", "EI*w'''(l) = -F"]),
    "a mass at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = m*s^2*w(l) - F"]),
    "a spring and a damper at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = (k + m*s^2 + c*l*s)*w(l) - F"]),
    "a spring that turns at the root": (BEAM, ["w(0) = 0", "EI*w''(0) = k*l^2*w'(0)", *FREE[2:]]),
    "with the loss of its material": (LOSSY.replace("-", "+"), [*FREE[:3], "w'''(l) = -F/EI"]),
    "pulled, the end guided": (PULLED, [*CLAMPED, "w'(l) = 0", "EI*w'''(l) = -F"]),
    "pulled by its end": (PULLED, [*FREE[:3], "EI*w'''(l) - T*w'(l) = -F"]),
    "pulled along x": ("EI*w'''' - (T*(1 - x^2/l^2)*w')' + rhoA*s^2*w = 0", FREE),
    "turning": ("EI*w'''' - J*s^2*w'' + rhoA*s^2*w = 0", [*FREE[:3], "EI*w'''(l) - J*s^2*w'(l) = -F"]),
    "on a foundation": ("EI*w'''' + (c*s + k/l + rhoA*s^2)*w = 0", FREE),
    "a taper": ("(EI*(1 - x/(2*l))^3*w'')'' + rhoA*(1 - x/(2*l))*s^2*w = 0", FREE),
    "a string": (STRING, FIXED),
    "a string with a mass": (STRING, ["w(0) = 0", "T*w'(l) = F - m*s^2*w(l)"]),
    "a force that comes late": (STRING, ["w(0) = 0", "(1 + eta*s)*T*w'(l) = F"]),
    "a string of growing mass": ("T*w'' = rhoA*exp(x/l)*s^2*w", FIXED),
}
NOT_PASSIVE = {
    "a negative mass at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -m*s^2*w(l) - F"]),
    "a negative spring at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -20*k*w(l) - F"]),
    "a negative damper at the tip": (BEAM, [*FREE[:3], "EI*w'''(l) = -c*l*s*w(l) - F"]),
    "a force that follows the slope": (PULLED, [*FREE[:3], "EI*w'''(l) = -F"]),
    "a force that follows the other end": (BEAM, ["w''(0) = 0", "EI*w'''(0) = k*w(l)", *FREE[2:]]),
    "a foundation that pushes": ("EI*w'''' - 30*k/l*w + rhoA*s^2*w = 0", FREE),
    "a foundation that feeds": ("EI*w'''' - c*s*w + rhoA*s^2*w = 0", FREE),
    "pushed": ("EI*w'''' + 4*T*w'' + rhoA*s^2*w = 0", [*FREE[:3], "EI*w'''(l) + 4*T*w'(l) = -F"]),
    "pushed somewhere": (PUSHED, [*FREE[:3], "EI*w'''(l) + T*w'(l) = -F"]),
    "a string that moves along": ("T*w'' = rhoA*(s^2*w + 2*v*s*w' + v^2*w'')", FIXED),
    "a negative loss": (LOSSY, [*FREE[:3], "w'''(l) = -F/EI"]),
    "a condition that an s in the right half-plane meets": (STRING, ["w(0) = 0", "(s*l/v - 1)*T*w'(l) = F"]),
    "not what a slope does": ("EI*w'''' - T*x/l*w'' + rhoA*s^2*w = 0", FREE),
}


@pytest.mark.slow
def test_energy_is_nowhere_supplied():
    for name, given in PASSIVE.items():
        assert known(model_of(*given)), name


@pytest.mark.slow
def test_what_may_supply_energy_is_not_said_to_be_passive():
    for name, given in NOT_PASSIVE.items():
        assert not known(model_of(*given)), name


@pytest.mark.slow
def test_some_of_these_have_poles_in_the_right_half_plane():
    for name in ("a negative spring at the tip", "pushed"):
        model = model_of(*NOT_PASSIVE[name])
        (bound,) = pipeline.derive_bound(model, model.transfer_functions)
        assert any(root.re > 0 for root in pipeline.roots(bound, Modes(2), 12).poles), name


COUPLED = """
[fields.w]
unknowns = UNKNOWNS
domain = ["0", "l"]
equations = EQUATIONS
conditions = CONDITIONS
[outputs]
y = "u'(l)"
"""
LAYER = ["T*u'' - k/l*(u - h) = rhoA*s^2*u", "2*T*h'' - (k/l)*(h - u) = rhoA*s^2*h"]
ENDS = ["u(0) = 0", "h(0) = 0"]
LOOSE = [*ENDS, "T*u'(l) = F", "h'(l) = 0"]
TIED = [*ENDS, "T*u'(l) + k*(u(l) - h(l)) = F", "2*T*h'(l) + k*(h(l) - u(l)) = 0"]
BOTH_PINNED = ["u(0) = 0", "u''(0) = 0", "u(l) = 0", "EI*u''(l) = F*l"]
BOTH_PINNED += ["h(0) = 0", "h''(0) = 0", "h(l) = 0", "h''(l) = 0"]
SANDWICH = ["EI*u'''' + rhoA*s^2*u + k/l*(u - h) = 0", "EI*h'''' + rhoA*s^2*h + k/l*(h - u) = 0"]
TIMOSHENKOS = [
    "kGA*(u'' - a') = rhoA*s^2*u + k/l*(u - h)", "EI*a'' + kGA*(u' - a) = J*s^2*a",
    "kGA*(h'' - b') = rhoA*s^2*h + k/l*(h - u)", "EI*b'' + kGA*(h' - b) = J*s^2*b",
]  # fmt: skip
HELD_AT_0 = [
    *ENDS, "a(0) = 0", "b(0) = 0", "kGA*(u'(l) - a(l)) = F", "a'(l) = 0", "h'(l) - b(l) = 0", "b'(l) = 0",
]  # fmt: skip
THREE = ["T*u'' - k/l*(u - h) = rhoA*s^2*u", "T*h'' - k/l*(2*h - u - z) = rhoA*s^2*h"]
THREE += ["T*z'' - k/l*(z - h) = rhoA*s^2*z"]
UNLIKE = ["EI*u'''' - T*u'' + rhoA*s^2*u + (k/l + c*s)*(u - h) = 0"]
UNLIKE += ["2*EI*h'''' + rhoA*s^2*h + (k/l + c*s)*(h - u) = 0"]
COLUMNS = [x.replace(" = 0", f" + 9*T*{u}'' = 0") for x, u in zip(SANDWICH, "uh", strict=True)]
MASSES = ["T*u'' = 2*rhoA*s^2*u + rhoA*s^2*h", "T*h'' = rhoA*s^2*(u + h)"]
TOGETHER = {
    "strings": (LAYER, TIED),
    "strings and a layer that is lossy": ([x.replace("k/l", "(k/l + c*s)") for x in LAYER], TIED),
    "three strings": (THREE, [*LOOSE, "z(0) = 0", "z'(l) = 0"]),
    "beams that shear": (TIMOSHENKOS, HELD_AT_0),
    "beams": (SANDWICH, BOTH_PINNED),
    "a beam that is pulled, another twice as stiff, and a layer that is lossy": (
        UNLIKE, [x.replace("EI*u''(l) = F*l", "u''(l) = F*l/EI") for x in BOTH_PINNED]
    ),
    "strings with a mass of both": (MASSES, LOOSE),
}  # fmt: skip
APART = {
    "a layer that pushes": ([x.replace("k/l", "-9*k/l") for x in LAYER], LOOSE),
    "a layer without reaction": ([LAYER[0], "T*h'' = rhoA*s^2*h"], LOOSE),
    "a layer that turns": ([LAYER[0], "T*h'' - k/l*(h + u) = rhoA*s^2*h"], LOOSE),
    "a spring that pushes": (LAYER, [x.replace("k*", "-k*") for x in TIED]),
    "a spring without reaction": (LAYER, [*TIED[:3], "h'(l) = 0"]),
    "more mass of both than of each": ([x.replace("2*rhoA", "rhoA/2") for x in MASSES], LOOSE),
    "beams and a layer without reaction": ([SANDWICH[0], SANDWICH[1].replace("h - u", "h")], BOTH_PINNED),
    "beams and a layer that pushes": ([x.replace("k/l", "-k/l") for x in SANDWICH], BOTH_PINNED),
    "beams of which one end pushes": (
        SANDWICH, [*BOTH_PINNED[:2], "EI*u''(l) = F*l", "EI*u'''(l) + k*u(l) = 0", *BOTH_PINNED[4:]]
    ),
    "columns": (COLUMNS, BOTH_PINNED),
}  # fmt: skip


def together(equations, conditions):
    text = HEAD + COUPLED
    unknowns = [u for u in "uhzab" if any(f"{u}(0)" in each for each in conditions)]
    for name, given in (("UNKNOWNS", unknowns), ("EQUATIONS", equations), ("CONDITIONS", conditions)):
        text = text.replace(name, "[" + ", ".join(f'"{each}"' for each in given) + "]")
    return pipeline.loads(text)


@pytest.mark.slow
def test_displacements_that_hold_one_another_share_their_energy():
    for name, given in TOGETHER.items():
        assert known(together(*given)), name


@pytest.mark.slow
def test_what_couples_displacements_may_supply_energy():
    for name, given in APART.items():
        assert not known(together(*given)), name


@pytest.mark.slow
def test_two_equal_beams_move_together_and_against_each_other():
    # Sines: rhoA omega^2 is EI (n pi/l)^4 of motion together, and twice the layer's more against each other.
    model = together(SANDWICH, BOTH_PINNED)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, Modes(2), 12)
    bending = 2 * (pi / 1.2) ** 4
    expected = [(bending / 1.5) ** 0.5, ((bending + 2 * 7 / 1.2) / 1.5) ** 0.5]
    assert [float(p.im) for p in found.poles if p.im > 0] == pytest.approx(expected, rel=1e-10)


SHEARS = """
[fields.beam]
unknowns = ["w", "phi"]
domain = ["0", "l"]
equations = ["kGA*(w'' - phi') = rhoA*s^2*w", "EI*phi'' + kGA*(w' - SIGNphi) = J*s^2*phi"]
conditions = ["w(0) = 0", "phi(0) = 0", "phi'(l) = 0", "kGA*(w'(l) - phi(l)) = F"]
[outputs]
y = "w(l)"
"""


def test_a_beam_that_shears_is_one_of_two_unknowns():
    for sign, expected in [("", True), ("-", False)]:
        assert known(pipeline.loads(HEAD + SHEARS.replace("SIGN", sign))) is expected


TRANSMISSION = """
symflex = 1
[parameters]
R = { value = "0.05 ohm/m", assume = "real" }
G = { value = "1 mS/m", assume = "real" }
Z = { value = "50 ohm", assume = "real" }
L = "253 nH/m"
C = "101 pF/m"
M = "1 uH"
D = "1 nF"
l = "10 m"
[inputs]
V = { unit = "V" }
[outputs]
v_l = "v(l)"
[fields.line]
unknowns = ["v", "i"]
domain = ["0", "l"]
equations = ["v' = -(R + s*L)*i", "i' = -(G + s*C)*v"]
conditions = ["v(0) = V - Z*i(0)", "i(l) = 0"]
"""
LINES = {
    "": True, "0.05 ohm/m -> -0.05 ohm/m": False, "1 mS/m -> -1 mS/m": False, "50 ohm -> -50 ohm": False,
    "Z*i(0) -> M*s*i(0)": True, " - Z*i(0) -> ": True, "V - Z*i(0) -> V + M*s*i(0)": False,
    "i(l) = 0 -> i(l) = v(l)/Z + D*s*v(l)": True, "i(l) = 0 -> v(l) = M*s*i(l)": True,
    "i(l) = 0 -> i(l) = D*s*v(l) - v(l)/Z": False, "i(l) = 0 -> i(l) = v(0)/Z": False, "s*L -> -s*L": False,
}  # fmt: skip
"""Changes of a line, and whether it is passive: what has a resistance loses energy where that is positive."""


def test_lossy_lines_are_passive_with_what_ends_them():
    for change, expected in LINES.items():
        old, _, new = change.partition(" -> ")
        assert known(pipeline.loads(TRANSMISSION.replace(old, new) if old else TRANSMISSION)) is expected, (
            change
        )


NETWORK = """symflex = 1
parameters = {{ R = 50, Z = 75, T = "1 us", C = "1 nF", L = "1 uH" }}
[inputs]
V = {{ voltage = "in" }}
[outputs]
v = "b"
[elements]
R_1 = {{ type = "resistor", between = ["in", "a"], R = "R" }}
at_a = {{ type = "current_source", between = ["{a}"], i = "{i}(0)" }}
at_b = {{ type = "current_source", between = ["b", "ground"], i = "i(1)" }}
{end}
[fields.line]
unknowns = ["v", "i"]
domain = ["0", "1"]
equations = ["v' = -{z}*s*T*i", "i' = -s*T/Z*v"]
conditions = ["v(0) = {v}", "v(1) = b"]
"""
AS_LINE = {"a": 'ground", "a', "i": "i", "v": "a", "z": "Z"}
RESISTOR, CAPACITOR, TANK = (
    'end = {{ type = "{}", between = ["b", "ground"], {} }}'.format(*each)
    for each in (
        ("resistor", 'R = "2*R"'),
        ("capacitor", 'C = "C"'),
        ("resistor", 'R = "R" }\nl = { type = "inductor", between = ["b", "c"], L = "L" }\n'
         'c = { type = "capacitor", between = ["c", "ground"], C = 3e-9'),
    )
)  # fmt: skip


def test_lines_between_the_nodes_of_passive_circuits_are_passive():
    # At an end of impedance R the reflection is (R - Z)/(R + Z), and s = ln(r_1*r_2)/(2*T) a pole: it grows
    # if both reflections together exceed one, as where a source drives the line instead of following it.
    for changes, end, expected in (
        ({}, RESISTOR, (True, True)),
        ({}, CAPACITOR, (True, True)),
        ({}, TANK, (True, True)),
        ({}, RESISTOR.replace("2*R", "-2*R"), (False, False)),
        ({"a": 'a", "ground'}, RESISTOR, (False, False)),
        ({"v": "2*a"}, RESISTOR, (False, False)),
        ({"v": "2*a", "i": "2*i"}, RESISTOR, (True, True)),
        ({"i": "3*v"}, RESISTOR, (False, False)),
        ({"z": "(1 - 2*s*T)*Z"}, RESISTOR, (False, False)),
        ({}, RESISTOR + '\nf = { type = "current_source", at = "b", i = "a/R" }', (False, False)),
    ):
        proof = energy_proof(pipeline.loads(NETWORK.format(**AS_LINE | changes, end=end)))
        assert (proof.is_passive, proof.rests) == expected, (changes, end)


def test_a_line_between_undamped_circuits_is_passive_and_may_ring():
    undamped = NETWORK.replace('between = ["in", "a"], R = "R"', 'between = ["in", "a"], L = "L"')
    undamped = undamped.replace('type = "resistor", between = ["in"', 'type = "inductor", between = ["in"')
    proof = energy_proof(pipeline.loads(undamped.format(**AS_LINE, end=CAPACITOR)))
    assert (proof.is_passive, proof.rests) == (True, False)


def test_fields_rest_on_the_axis_where_what_moves_them_loses_energy():
    # EI (1 + eta s) w'''' = -rhoA s^2 w has s^2 + eta p s + p = 0 with p > 0; without eta s^2 = -p.
    for law, expected in [("(1 + eta*s)*EI", True), ("EI", False)]:
        ends = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", f"{law}*w'''(l) = -F"]
        model = model_of(f"{law}*w'''' + rhoA*s^2*w = 0", ends)
        assert energy_proof(model).rests is expected
    # (R + L s) (G + C s) = -q^2 has its roots in the left half-plane with R or G.
    line = pipeline.loads(TRANSMISSION)
    assert energy_proof(line).rests


COLUMN = """
symflex = 1
parameters = { EI = "2 N*m^2", I = "1e-8 m^4", m = "3 kg/m", A = "1e-4 m^2", l = "0.7 m", t = TIME }
definitions = { P = "FACTOR*pi^2*EI/l^2" }
inputs.M = { torque = "b.theta" }
outputs.y = "b.theta"
elements.a = { type = "FIRST", at = "a" }
elements.b = { type = "pin", at = "b" }
elements.bar = { type = "beam", between = ["a", "b"], LIKE, l = "l", N = "-P", eta = "t" }
""".replace("LIKE", 'E = "EI/I", I = "I", rho = "m/A", A = "A"')


def column(factor, first="pin", time="0 s"):
    time = f'{{ value = "{time}", assume = "nonnegative" }}'
    return COLUMN.replace("FACTOR", factor).replace("FIRST", first).replace("TIME", time)


@pytest.mark.slow
def test_a_post_buckles_under_its_own_weight():
    # Greenhill 1881: clamped, of stiffness EI and weight q per length, at q l^3 = 7.8373 EI.
    text = column("1", "fixed").replace('elements.b = { type = "pin", at = "b" }\n', "")
    for weight, expected in [("7.83", "marginal"), ("7.84", "unstable")]:
        loaded = text.replace('N = "-P"', f'N = "-{weight}*EI/l^2*(1 - x/l)"')
        assert word(pipeline.loads(loaded)).word == expected, weight


@pytest.mark.slow
def test_columns_are_stable_up_to_their_buckling_load_and_not_beyond():
    # Euler: the load is pi^2 EI/l^2 with both ends pinned, 2.0457 times that with one clamped.
    loads = [("0.99", "pin", "marginal"), ("1.01", "pin", "unstable"), ("4.01", "pin", "unstable")]
    loads += [("2.04", "fixed", "marginal"), ("2.05", "fixed", "unstable")]
    for factor, first, expected in loads:
        assert word(pipeline.loads(column(factor, first))).word == expected, (factor, first)
    assert word(pipeline.loads(column("0.99", time="1 ms"))).word == "stable"
    verdict = word(pipeline.loads(column("4.01", time="1 ms")))
    assert (verdict.word, verdict.right) == ("unstable", 2)  # two half waves buckle at four times the load


def test_what_is_near_rest_at_the_buckling_load_is_listed_and_not_certified():
    model = pipeline.loads(column("1"))
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, Modes(2), 12)
    near = [p for p in found.poles if p.re.contains(0) and p.im.contains(0)]
    assert [(p.multiplicity, p.certified) for p in near] == [(2, False)]
    assert (found.verdict.word, found.certificate.certified) == ("unknown", False)


def test_slope_and_deflection_are_bounded_by_curvature_and_deflection():
    # Polynomials up to degree 39 on a length of 1: e |w''|^2 + (1/e + 12) |w|^2 - |w'|^2 is positive.
    x, weights = legendre.leggauss(80)
    basis = [legendre.Legendre.basis(n) * np.sqrt((2 * n + 1) / 2) for n in range(40)]
    first, second = ([2**k * b.deriv(k)(x) for b in basis] for k in (1, 2))
    slope, curvature = ((np.array(d) * weights) @ np.array(d).T for d in (first, second))
    for e in np.logspace(-3, 2, 40):
        assert np.linalg.eigvalsh(e * curvature - slope)[0] > -(1 / e + 12), e


def test_a_column_of_a_bending_stiffness_is_one_of_modulus_and_section():
    text = column("0.5")
    whole = text.replace('E = "EI/I", I = "I", rho = "m/A", A = "A"', 'EI = "EI", rhoA = "m"')
    assert whole != text
    limits = [energy_proof(model).limit for model in map(pipeline.loads, (text, whole))]
    assert limits[0] == pytest.approx(limits[1], rel=1e-12)


def test_growth_of_a_compressed_column_is_bounded_from_above():
    # Both ends pinned: s^2 = (P pi^2/l^2 - EI pi^4/l^4)/m at its largest.
    for load in (5, 50, 500):
        model = pipeline.loads(column(str(load)))
        limit = energy_proof(model).limit
        waves = np.arange(1, 40) * pi / 0.7
        force = load * pi**2 * 2 / 0.7**2
        grows = np.sqrt(max((force * waves**2 - 2 * waves**4) / 3))
        assert grows < limit < 3 * grows + 200, load


def test_all_poles_of_a_passive_field_are_said_to_be_on_the_axis_or_left_of_it():
    model = model_of(*PASSIVE["pulled by its end"])
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    found = pipeline.roots(bound, Modes(2), 12)
    assert found.verdict.word == "marginal"


def test_signals_alone_have_no_energy():
    proof = energy_proof(pipeline.loads('symflex = 1\ninputs = { u = {} }\noutputs = { y = "u/(s + 1)" }'))
    assert proof.is_passive and "energy" not in proof.reason


def test_nothing_is_known_beside_elements():
    model = pipeline.loads(
        HEAD
        + FIELD.replace("EQUATION", STRING).replace("CONDITIONS", '["w(0) = 0", "T*w\'(l) = F"]')
        + '[elements]\nbody = { type = "mass", at = "z", m = "m" }\n'
    )
    assert not known(model)


JOINED = """
[fields.a]
domain = ["0", "l"]
equation = "EI*a'''' + rhoA*s^2*a = 0"
conditions = ["a(0) = 0", "a'(0) = 0", "a(l) = b(l)", "a'(l) = b'(l)"]
[fields.b]
domain = ["l", "2*l"]
equation = "2*EI*b'''' + rhoA*s^2*b = 0"
conditions = [
  "a''(l) = 2*b''(l)", "EI*a'''(l) = 2*EI*b'''(l)SIGNm*s^2*a(l)", "b''(2*l) = 0", "2*EI*b'''(2*l) = -F"
]
[outputs]
y = "b(2*l)"
"""


def test_two_fields_that_meet_at_a_mass():
    for sign, expected in [(" + ", True), (" - ", False)]:
        assert known(pipeline.loads(HEAD + JOINED.replace("SIGN", sign))) is expected


def test_an_s_behind_a_name_is_not_overlooked():
    text = HEAD + '[definitions]\nT_s = "T*(1 + eta*s)"\n'
    text += FIELD.replace("EQUATION", "T_s*w'' = rhoA*s^2*w")
    assert not known(pipeline.loads(text.replace("CONDITIONS", """["w(0) = 0", "T_s*w'(l) = F"]""")))


def test_a_beam_is_passive_however_its_values_are_written():
    text = """symflex = 1
parameters = { E = "2 Pa", nu = NU, A = "1 m^2", mu = "1 kg/m", c = "1 1/m^2" }
inputs.F = { force = "tip" }
outputs.y = "tip"
definitions = { shear = "E/(2*(1 + nu))", kappa = "10*(1 + nu)/(12 + 11*nu)" }
elements.arm = { type = "beam", theory = "timoshenko", between = ["ground", "tip"], I = 1, l = 1, MORE }
""".replace("MORE", 'kappa = "kappa", E = "2*E/(1 + A*c)", G = "shear", rho = "mu/A", A = "A"')
    for ratio in ("0.25", "{}"):
        assert energy_proof(pipeline.loads(text.replace("NU", ratio))).is_passive == (ratio == "0.25")


def test_a_parameter_that_cancels_leaves_a_rod_passive():
    # Its stiffness times its length is k, its mass per length M/l, and the cross-section takes no part.
    text = """
    symflex = 1
    parameters = { k = "100 N", M = "4 kg/m", A = AREA }
    inputs.F = { force = "x" }
    outputs.X = "x"
    [elements]
    coil = { type = "rod", between = ["ground", "x"], E = "k/A", A = "A", rho = "M/A", l = "1 m" }
    """.replace("\n    ", "\n")
    for area in ('"1 m^2"', '{ unit = "m^2" }'):
        (bound,) = pipeline.derive_bound(pipeline.loads(text.replace("AREA", area)), [("X", "F")])
        assert pipeline.roots(bound, Modes(1)).verdict.word == "marginal", area


DASHPOT = """
symflex = 1
inputs.T = { torque = "a" }
outputs.Y = "a.theta"
[elements]
hinge = { type = "pin", at = "a" }
one = { type = "beam", between = ["a", "m"], EI = "2 N*m^2", rhoA = "1 kg/m", l = "1 m", k_f = "50 N/m^2" }
dash = { type = "damper", between = ["m", "ground"], b = "3 N*s/m" }
"""
FURTHER = """
end = { type = "pin", at = "b" }
two = { type = "beam", between = ["m", "b"], EI = "2 N*m^2", rhoA = "1 kg/m", l = "1 m", k_f = "50 N/m^2" }
"""
LOADED = Template("""
symflex = 1
inputs.F = { force = "tip" }
outputs.Y = "tip"
[elements]
arm = { type = "beam", between = ["ground", "tip"], EI = 1, rhoA = 1, l = 1, k_f = $foundation }
load = { type = "rigid_body", at = "tip", m = "0.3 kg", J = $inertia }
dash = { type = "damper", between = ["tip", "ground"], b = "2 N*s/m" }
""")


def said_of(text):
    """Return what is said of the stability of a model with one transfer function."""
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions)
    return pipeline.roots(bound, Modes(2)).verdict.word


@pytest.mark.slow
def test_a_dashpot_at_a_tip_on_a_foundation_damps_all_and_one_where_modes_rest_does_not():
    """Pinned at both ends, EI (n pi/2)^4 + k_f = rho A omega^2 rests at midspan for every even n.

    That pole lies on the axis, which the program does not prove.
    """
    assert said_of(DASHPOT) == "stable"
    assert said_of(DASHPOT + FURTHER) == "unknown"


def felt(foundation, inertia, square):
    """Return how far the clamp would move, and turn, of a beam whose loaded tip turns by 1 and rests."""
    # Deflection, slope, moment and shear, from the tip on, where the load turns the other way.
    law = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [square - foundation, 0, 0, 0]])
    return np.hypot(*(expm(law) @ [0, 1, -inertia * square, 0])[:2])


@pytest.mark.slow
def test_a_dashpot_damps_a_payload_but_for_an_inertia_with_which_the_tip_only_turns():
    """With k l = pi, J k^3 = rho A (cosh(pi) - 1)/sinh(pi), the tip of a clamped beam may turn alone."""
    tuned = (cosh(pi) - 1) / sinh(pi) / pi**3
    for foundation, inertia in ((0, 0.02), (30, 0.05)):
        assert said_of(LOADED.substitute(foundation=foundation, inertia=inertia)) == "stable"
        assert min(felt(foundation, inertia, w * w) for w in np.geomspace(0.1, 400, 2000)) > 1e-2
    assert felt(0, tuned, pi**4) < 1e-12
    assert said_of(LOADED.substitute(foundation=0, inertia=repr(tuned))) == "unknown"


ENDED = """
symflex = 1
inputs.F = { unit = "N" }
outputs.Y = "w(1/3)"
[fields.w]
domain = [0, 1]
equation = "2*w'' = (3*s^2 + 5)*w"
conditions = ["w(0) = 0", "2*w'(1) + 4*s*w(1) = F"]
"""


def test_a_dashpot_at_the_end_of_a_field_damps_it():
    """A string on a foundation; with N w' = m s^2 w at its end none of its modes is damped."""
    assert said_of(ENDED) == "stable"
    assert said_of(ENDED.replace("4*s*w", "4*s^2*w")) == "marginal"
