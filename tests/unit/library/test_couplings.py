"""Couplings between bodies, active circuits and sound, against the equations solved by hand."""

import numpy as np
import pytest
from scipy.linalg import expm

import symflex
from symflex import pipeline
from symflex.errors import SpecError
from symflex.roots.passivity import energy_proof

S = 0.3 + 4j


def values(text, *names):
    model = symflex.loads(f"symflex = 1\n[elements]\n{text}")
    return [complex(model.transfer_function(*name.split("/")).bind()(S)) for name in names]


def solved(matrix, right):
    return np.linalg.solve(np.array(matrix), right)


MOTOR = """
rotor = { type = "inertia", at = "r", J = 2 }
stator = { type = "inertia", at = "st", J = 5 }
mount = { type = "torsion_spring", between = ["st", "ground"], k = 7 }
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = ["r", "st"], R = 3, L = 0.5, k_t = 0.2 }
[inputs]
U = { voltage = "v" }
[outputs]
A = "r"
B = "st"
"""


def test_a_motor_between_two_bodies_pushes_both_and_feels_what_moves_between_them():
    known = solved([[2 * S**2, 0, -0.2], [0, 5 * S**2 + 7, 0.2], [0.2 * S, -0.2 * S, 3 + 0.5 * S]], [0, 0, 1])
    assert values(MOTOR, "A/U", "B/U") == pytest.approx(known[:2])
    linear = MOTOR.replace("dc_motor", "voice_coil").replace("shaft", "mover").replace("k_t", "k_f")
    linear = linear.replace("inertia", "mass").replace("J =", "m =").replace("torsion_spring", "spring")
    assert values(linear, "A/U", "B/U") == pytest.approx(known[:2])


def test_a_planetary_gear_is_willis_equation_and_a_transformer_of_pairs():
    gears = (
        '{ type = "planetary_gear", sun = "s1", ring = "r", carrier = "c", rho = 2.5 }',
        '{ type = "transformer", from = ["s1", "c"], to = ["r", "c"], ratio = "-1/2.5" }',
    )
    # Angles of sun, carrier and ring, and the torque on the sun.
    rows = [[S**2, 0, 0, -1], [0, 2 * S**2, 0, 3.5], [0, 0, 3 * S**2 + 11, -2.5], [1, -3.5, 2.5, 0]]
    known = solved(rows, [1, 0, 0, 0])
    for gear in gears:
        text = f"""
sun = {{ type = "inertia", at = "s1", J = 1 }}
carrier = {{ type = "inertia", at = "c", J = 2 }}
ring = {{ type = "inertia", at = "r", J = 3 }}
mount = {{ type = "torsion_spring", between = ["r", "ground"], k = 11 }}
gear = {gear}
[inputs]
T = {{ torque = "s1" }}
[outputs]
C = "c"
R = "r"
"""
        assert values(text, "C/T", "R/T") == pytest.approx(known[1:3]), gear


def test_a_gyrator_of_pairs_acts_between_bodies():
    text = """
a = { type = "mass", at = "a", m = 2 }
b = { type = "mass", at = "b", m = 3 }
c = { type = "mass", at = "c", m = 5 }
d = { type = "mass", at = "d", m = 7 }
cross = { type = "gyrator", from = ["a", "b"], to = ["c", "d"], ratio = 4 }
[inputs]
F = { force = "a" }
[outputs]
A = "a"
D = "d"
"""
    # Force drawn at the first pair: 4 s (c - d); delivered at the second: 4 s (a - b).
    m = np.diag([2, 3, 5, 7]) * S**2
    m[:2, 2:] += 4 * S * np.array([[1, -1], [-1, 1]])
    m[2:, :2] -= 4 * S * np.array([[1, -1], [-1, 1]])
    known = np.linalg.solve(m, [1, 0, 0, 0])
    assert values(text, "A/F", "D/F") == pytest.approx([known[0], known[3]])


AMPLIFIER = """
r1 = {{ type = "resistor", between = ["u", "n"], R = 2 }}
r2 = {{ type = "resistor", between = ["n", "o"], R = 10 }}
amp = {{ type = "op_amp", inputs = ["ground", "n"], out = "o"{} }}
[inputs]
V = {{ voltage = "u" }}
[outputs]
O = "o"
I = "amp.i"
"""


def test_a_mass_beside_the_axis_couples_bending_and_torsion():
    text = """
root = { type = "fixed", at = "root" }
blade = { type = "beam", between = ["root", "tip"], EI = 12, rhoA = 0.4, l = 0.6 }
twist = { type = "shaft", between = ["ground", "phi"], GJ = 5, rhoJ = 2e-4, l = 0.6 }
arm = { type = "transformer", from = "phi", to = ["y_m", "tip"], ratio = 0.03 }
mass = { type = "mass", at = "y_m", m = 0.2 }
[inputs]
F = { force = "tip" }
[outputs]
Y = "tip"
Phi = "phi"
"""
    # States y, theta, moment and force of the beam; the force f on the mass acts back on tip and twist.
    along = np.array([[0, 1, 0, 0], [0, 0, 1 / 12, 0], [0, 0, 0, -1], [0.4 * S**2, 0, 0, 0]])
    through = expm(along * 0.6)
    bending = through[0, 2:] @ np.linalg.solve(through[2:, 2:], [0, 1])
    wave = np.sqrt(2e-4 / 5) * S
    torsion = np.tanh(wave * 0.6) / (5 * wave)
    rows = [[0.2 * S**2, 0.2 * S**2 * 0.03, -1], [1, 0, bending], [0, 1, 0.03 * torsion]]
    known = solved(rows, [0, bending, 0])
    assert values(text, "Y/F", "Phi/F") == pytest.approx(known[:2])


def test_an_amplifier_is_ideal_or_has_a_gain_and_a_bandwidth():
    assert values(AMPLIFIER.format(""), "O/V", "I/V") == pytest.approx([-5, -0.5])
    for given, gain in (
        (", A = 1000", 1000),
        (", f_u = 50", 50 / S),
        (", A = 1000, f_u = 50", 1 / (1e-3 + S / 50)),
    ):
        # The inverted input has 10/12 of the source and 2/12 of the output.
        closed = -gain * (10 / 12) / (1 + gain * 2 / 12)
        assert values(AMPLIFIER.format(given), "O/V") == pytest.approx([closed]), given


def test_controlled_sources_follow_a_voltage_or_a_current():
    for kind, senses, gain, known in (
        ("vcvs", '"a", "ground"', "mu", 4 * 0.6),
        ("vccs", '"a", "ground"', "g", 4 * 0.6 * 7),
        ("ccvs", '"a", "b"', "r", 4 / 5),
        ("cccs", '"a", "b"', "beta", 4 / 5 * 7),
    ):
        foot = "b" if "b" in senses else "a"
        text = f"""
r1 = {{ type = "resistor", between = ["u", "a"], R = 2 }}
r2 = {{ type = "resistor", between = ["{foot}", "ground"], R = 3 }}
load = {{ type = "resistor", between = ["o", "ground"], R = 7 }}
source = {{ type = "{kind}", inputs = [{senses}], terminals = ["o", "ground"], {gain} = 4 }}
[inputs]
V = {{ voltage = "u" }}
[outputs]
O = "o"
"""
        assert values(text, "O/V") == pytest.approx([known]), kind


def test_coupled_inductors_are_two_windings():
    text = """
r = { type = "resistor", between = ["u", "a"], R = 2 }
core = { type = "coupled_inductors", terminals = ["a", "ground", "o", "ground"], L_1 = 3, L_2 = 5, M = 1.5 }
load = { type = "resistor", between = ["o", "ground"], R = 7 }
[inputs]
V = { voltage = "u" }
[outputs]
O = "o"
"""
    _, second = solved([[2 + 3 * S, 1.5 * S], [1.5 * S, 7 + 5 * S]], [1, 0])
    assert values(text, "O/V") == pytest.approx([-7 * second])


def test_coupled_inductors_supply_no_energy_where_their_matrix_is_semidefinite():
    for l_1, l_2, m in [(3, 5, 1.5), (1, 4, -2), (1, 4, 2.01), (1, 1, -1.5), (-1, -1, 0.5)]:
        text = f"""symflex = 1
elements.core = {{ type = "coupled_inductors", terminals = ["a", "ground", "o", "ground"], L_1 = {l_1},
                  L_2 = {l_2}, M = {m} }}
elements.load = {{ type = "resistor", between = ["o", "ground"], R = 7 }}
inputs.V = {{ voltage = "a" }}
outputs.O = "o"
""".replace(",\n", ",")
        least = min(np.linalg.eigvalsh([[l_1, m], [m, l_2]]))
        assert energy_proof(pipeline.loads(text)).is_passive is bool(least > -1e-9), (l_1, l_2, m)


def test_a_loudspeaker_in_a_vented_box():
    text = """
cone = { type = "mass", at = "x", m = 2 }
surround = { type = "spring", between = ["x", "ground"], k = 3 }
coil = { type = "voice_coil", terminals = ["v", "ground"], mover = "x", R = 3, L = 0.5, k_f = 4 }
back = { type = "piston", mover = "x", chamber = ["ground", "box"], A = 0.7 }
air = { type = "acoustic_compliance", at = "box", C = 2 }
port = { type = "acoustic_mass", between = ["box", "ground"], M = 1.5 }
leak = { type = "acoustic_resistance", between = ["box", "ground"], R = 9 }
[inputs]
V = { voltage = "v" }
[outputs]
X = "x"
P = "box"
Q = "port.q"
"""
    # Motion, current, and the pressure in the box, out of which the cone draws A s x.
    admittance = 2 * S + 1 / (1.5 * S) + 1 / 9
    rows = [[2 * S**2 + 3, -4, -0.7], [4 * S, 3 + 0.5 * S, 0], [0.7 * S, 0, admittance]]
    motion, _, pressure = solved(rows, [0, 1, 0])
    assert values(text, "X/V", "P/V", "Q/V") == pytest.approx([motion, pressure, pressure / (1.5 * S)])


def test_pressures_and_flows_are_imposed():
    rest = """
valve = { type = "acoustic_resistance", between = ["a", "b"], R = 3 }
tank = { type = "acoustic_compliance", at = "b", C = 2 }
[inputs]
p = INPUT
[outputs]
P = "READ"
Q = "valve.q"
"""
    imposed = rest.replace("INPUT", '{ pressure = "a" }').replace("READ", "b")
    assert values(imposed, "P/p", "Q/p") == pytest.approx([1 / (1 + 6 * S), 2 * S / (1 + 6 * S)])
    driven = rest.replace("INPUT", '{ flow = "a" }').replace("READ", "a")
    assert values(driven, "P/p", "Q/p") == pytest.approx([3 + 1 / (2 * S), 1])


def test_a_pair_is_of_one_kind_and_of_two_nodes_at_most():
    with pytest.raises(SpecError, match="takes 1 node, found 3"):
        values(MOTOR.replace('["r", "st"]', '["r", "st", "v"]'), "A/U")
    mixed = MOTOR.replace('type = "dc_motor", terminals', 'type = "transformer", ratio = 2, from').replace(
        'shaft = ["r", "st"], R = 3, L = 0.5, k_t = 0.2', 'to = ["r", "v"]'
    )
    with pytest.raises(SpecError, match="a pair must be of one kind"):
        values(mixed, "A/U")
