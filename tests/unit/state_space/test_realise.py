"""State equations against textbooks, and against transfer functions found another way."""

from pathlib import Path

import numpy as np
import pytest
import sympy

import symflex
from symflex import pipeline
from symflex.errors import ModelError
from symflex.model import with_numbers
from symflex.state_space import realise

DERIVATIONS = Path(__file__).parents[3] / "derivations" / "eppinger1988"
LUMPED = ["two_mass", "rigid_body", "lumped_bending_beam", "polynomial_resonance"]

TWO_MASSES = """
symflex = 1
parameters = { m_1 = "2 kg", m_2 = "5 kg", k = "3 N/m", b = "0.5 N*s/m" }
elements.left = { type = "mass", at = "x", m = "m_1" }
elements.right = { type = "mass", at = "y", m = "m_2" }
elements.joint = { type = "spring", between = ["x", "y"], k = "k" }
elements.loss = { type = "damper", between = ["x", "y"], b = "b" }
inputs.F = { force = "x" }
outputs = { X = "x", V = "s*y" }
"""

MOTOR = """
symflex = 1
parameters = { R = "2 ohm", L = "0.5 H", k = "0.1 N*m/A", J = "0.02 kg*m^2", b = "0.003 N*m*s/rad" }
elements.motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "p", L = "L", R = "R", k_t = "k" }
elements.rotor = { type = "inertia", at = "p", J = "J" }
elements.friction = { type = "rotary_damper", between = ["p", "ground"], b = "b" }
inputs.V = { voltage = "v" }
outputs = { Theta = "p", Omega = "s*p" }
"""

RLC = """
symflex = 1
parameters = { R = "2 ohm", L = "3 H", C = "0.5 F" }
elements.r = { type = "resistor", between = ["a", "b"], R = "R" }
elements.l = { type = "inductor", between = ["b", "c"], L = "L" }
elements.c = { type = "capacitor", between = ["c", "ground"], C = "C" }
inputs.V = { voltage = "a" }
outputs = { v = "c", i = "l.i" }
"""

BASE = """
symflex = 1
parameters = { m = "2 kg", k = "3 N/m", b = "0.5 N*s/m" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.mount = { type = "force_source", at = "x", f = "k*(u - x) + b*s*(u - x)" }
inputs.u = {}
outputs = { X = "x", V = "s*x" }
"""

PID = """
symflex = 1
parameters = { m = "2 kg", k_p = "3 N/m", k_i = "0.5 N/(m*s)", k_d = "1 N*s/m", T = "0.1 s" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.drive = { type = "force_source", at = "x", f = "c" }
signals = { e = "r - x", c = "k_p*e + k_i/s*e + k_d*s/(T*s + 1)*e" }
inputs.r = {}
outputs.X = "x"
"""


def system(text):
    return symflex.loads(text).state_space()


def matrices(text):
    found = system(text)
    symbols = {s.name: s for m in (found.A, found.B, found.C, found.D) for s in m.free_symbols}
    return found, symbols


def test_two_masses_have_the_equations_of_a_book():
    # Ogata 2010, Modern Control Engineering, section 3-3: M q'' + B q' + K q = F
    found, p = matrices(TWO_MASSES)
    k, b, m, n = p["k"], p["b"], p["m_1"], p["m_2"]
    assert found.states == ("x", "y", "x_dot", "y_dot")
    expected = sympy.Matrix(
        [[0, 0, 1, 0], [0, 0, 0, 1], [-k / m, k / m, -b / m, b / m], [k / n, -k / n, b / n, -b / n]]
    )
    assert found.A == expected
    assert found.B == sympy.Matrix([0, 0, 1 / m, 0])
    assert found.C == sympy.Matrix([[1, 0, 0, 0], [0, 0, 0, 1]])
    assert found.D == sympy.zeros(2, 1)


def test_a_motor_has_angle_speed_and_current():
    # Franklin, Powell & Emami-Naeini 2010, Feedback Control of Dynamic Systems, example 2.15
    found, p = matrices(MOTOR)
    R, L, k, J, b = (p[name] for name in ("R", "L", "k", "J", "b"))
    assert found.states == ("p", "motor_i", "p_dot")
    assert found.A == sympy.Matrix([[0, 0, 1], [0, -R / L, -k / L], [0, k / J, -b / J]])
    assert found.B == sympy.Matrix([0, 1 / L, 0])
    assert [found.units[name] for name in found.states] == ["rad", "A", "rad/s"]


def test_a_circuit_has_the_capacitor_s_voltage_and_the_inductor_s_current():
    found, p = matrices(RLC)
    R, L, C = p["R"], p["L"], p["C"]
    assert found.states == ("c", "l_i")
    assert found.A == sympy.Matrix([[0, 1 / C], [-1 / L, -R / L]])
    assert [found.units[name] for name in (*found.states, "V", "v", "i")] == ["V", "A", "V", "V", "A"]


def test_a_state_that_follows_the_input_s_derivative_is_what_is_left_of_it():
    # m x'' = k (u - x) + b (u' - x'): with w = x' - b u/m there is no u' (Ogata 2010, section 2-5)
    found, p = matrices(BASE)
    m, k, b = p["m"], p["k"], p["b"]
    assert found.states == ("x", "x_dot_rest")
    u, s, x = (sympy.Symbol(name) for name in "usx")
    assert sympy.expand(found.meanings["x_dot_rest"] - (s * x - b * u / m)) == 0
    assert found.A == sympy.Matrix([[0, 1], [-k / m, -b / m]])
    assert sympy.simplify(found.B - sympy.Matrix([b / m, k / m - (b / m) ** 2])) == sympy.zeros(2, 1)
    assert found.D == sympy.Matrix([0, b / m])


def test_the_terms_of_a_controller_have_states_of_their_own():
    found = system(PID)
    assert found.states == ("x", "c_2", "c_3_partial", "x_dot")
    assert {name for name in map(str, found.exact.ring.names)} >= {"k_i"}
    assert str(found).splitlines()[1] == "s*c_2 = -k_i*x + k_i*r"


def test_filters_with_a_common_denominator_share_its_state():
    text = 'symflex = 1\ninputs = { u = {}, v = {} }\noutputs.y = "u/(s + 2) + (s + 1)/(s + 2)*v"'
    assert len(system(text).states) == 1


def test_blocks_in_series_have_the_states_of_each():
    found = symflex.load(DERIVATIONS / "polynomial_resonance.toml").state_space()
    assert len(found.states) == 12
    # in series: no resonance acts back on the one before
    blocks = {name.split("_out")[0]: i for i, name in enumerate(found.states) if name.endswith("partial")}
    assert found.A[blocks["R_5"] + 6, blocks["R_4"]] == 0
    assert found.A[blocks["R_4"] + 6, blocks["R_5"]] != 0


@pytest.mark.parametrize("text", [MOTOR, RLC, BASE, PID], ids=["motor", "circuit", "base", "controller"])
def test_the_resolvent_is_the_transfer_function_symbolically(text):
    model = symflex.loads(text)
    found = model.state_space()
    s = sympy.Symbol("s")
    resolvent = found.C * (s * sympy.eye(found.A.rows) - found.A).LUsolve(found.B) + found.D
    for i, output in enumerate(model.outputs):
        for j, source in enumerate(model.inputs):
            assert sympy.cancel(resolvent[i, j] - model.transfer_function(output, source).expr) == 0


def response(a, b, c, d, s):
    n = len(a)
    return c @ np.linalg.solve(s * np.eye(n) - a, b) + d


@pytest.mark.parametrize("name", LUMPED)
def test_numbers_give_the_values_of_every_transfer_function(name):
    model = symflex.load(DERIVATIONS / f"{name}.toml")
    pairs = [(output, source) for output in model.outputs for source in model.inputs]
    functions = [model.transfer_function(*pair).bind() for pair in pairs]
    for minimal in (False, True):
        found = model.state_space(minimal=minimal).bind()
        for s in (40 + 300j, -25 + 60j, 900 + 0j):
            values = response(found.A, found.B, found.C, found.D, s).ravel()
            assert values == pytest.approx([H(s) for H in functions], rel=1e-10), (minimal, s)


@pytest.mark.parametrize("name", LUMPED)
def test_eigenvalues_are_the_proved_poles_and_hidden_modes(name):
    model = symflex.load(DERIVATIONS / f"{name}.toml")
    for output in model.outputs:
        H = model.transfer_function(output, model.inputs[0]).bind()
        found = H.pole_zero_map(20)
        roots = [*found.poles, *(h.root for h in found.hidden)]
        expected = [complex(r.enclosure().mid()) for r in roots for _ in range(r.multiplicity)]
        eigenvalues = list(np.linalg.eigvals(H.state_space().A))
        assert len(eigenvalues) == len(expected)
        size = max(map(abs, expected))
        for root in expected:
            nearest = min(eigenvalues, key=lambda x, root=root: abs(x - root))
            # a double root at 0 moves by the square root of what rounding does
            assert abs(nearest - root) < (1e-9 if abs(root) else 1e-5) * size
            eigenvalues.remove(nearest)


def test_values_can_be_given_as_numbers_or_quantities():
    found = system(TWO_MASSES)
    assert found.bind(k="6 kN/m").A[2, 1] == 3000
    assert found.bind(k=8).A[2, 1] == 4


def test_a_parameter_without_value_is_named():
    text = TWO_MASSES.replace('k = "3 N/m"', 'k = { unit = "N/m" }')
    with pytest.raises(ModelError, match="parameter 'k' has no value"):
        system(text).bind()


def test_a_limit_that_divides_by_zero_has_its_own_equations():
    model = symflex.loads(TWO_MASSES)
    with pytest.raises(ModelError, match="SF231"):
        model.state_space().bind(m_2=0)
    massless = model.transfer_function("X", "F").bind(m_2=0).state_space()
    # y follows x with the time constant b/k of the joint, and the joint carries nothing
    assert [state.name for state in massless.states] == ["x", "y", "x_dot"]
    assert massless.A.tolist() == [[0, 0, 1], [6, -6, 1], [0, 0, 0]]


def test_a_static_gain_has_no_states():
    for expression, gain in [("3*u", [[3.0]]), ("u - u", [[0.0]]), ("u/4 + u/4", [[0.5]])]:
        found = (
            symflex.loads(f'symflex = 1\ninputs.u = {{}}\noutputs.y = "{expression}"').state_space().bind()
        )
        assert (found.A.shape, found.B.shape, found.C.shape) == ((0, 0), (0, 1), (1, 0)), (expression, gain)
        assert found.D.tolist() == gain, (expression, gain)


def test_what_grows_with_s_has_no_state_equations():
    for expression in ["s*u", "(s^2 + 1)/(s + 1)*u"]:
        model = symflex.loads(f'symflex = 1\ninputs.u = {{}}\noutputs = {{ y = "{expression}", z = "u" }}')
        with pytest.raises(ModelError, match=r"SF236.*y/u has more zeros than poles"):
            model.state_space()
        assert model.state_space(outputs=["z"]).states == (), expression


def test_a_beam_has_no_state_equations_but_its_approximation_has():
    H = symflex.load(DERIVATIONS / "sliding_free_beam.toml").transfer_function("V_tip", "F").bind()
    with pytest.raises(ModelError, match=r"SF235(.|\n)*hint: .*H.rational\(modes=N\)"):
        H.state_space()
    found = H.rational(modes=3).state_space()
    assert found.A.shape == (7, 7)


def test_a_rational_function_of_a_model_with_a_delay_has_state_equations():
    text = (
        'symflex = 1\nblocks.D = { type = "delay", T = "2 s" }\ninputs.u = {}\n'
        'outputs = { y = "D*u", z = "(s + 3)/(s^2 + 2*s + 5)*u" }'
    )
    model = symflex.loads(text)
    found = model.transfer_function("z", "u").bind().state_space()
    assert response(found.A, found.B, found.C, found.D, 1j)[0, 0] == pytest.approx((3 + 1j) / (4 + 2j))
    with pytest.raises(ModelError, match="SF235"):
        model.transfer_function("y", "u").bind().state_space()


def test_a_free_node_is_explained():
    text = TWO_MASSES.replace('outputs = { X = "x", V = "s*y" }', 'outputs = { X = "x", Z = "z.f" }').replace(
        "inputs.F", 'elements.z = { type = "spring", between = ["p", "q"], k = "k" }\ninputs.F'
    )
    with pytest.raises(ModelError, match="SF301"):
        system(text)


def test_states_of_a_definition_that_holds_a_filter():
    text = """
symflex = 1
parameters = { m = "2 kg", k = "3 N/m", tau = "5 s" }
definitions.Z = "k/(tau*s + 1)"
elements.body = { type = "mass", at = "x", m = "m" }
elements.slow = { type = "spring", between = ["x", "y"], k = "Z" }
elements.other = { type = "mass", at = "y", m = "m" }
inputs.F = { force = "x" }
outputs.Y = "y"
"""
    found = system(text)
    # two masses and one relaxing spring: no denominator is counted twice
    assert found.states == ("x", "y", "slow_f", "x_dot", "y_dot")


def test_a_chain_of_a_hundred_masses_is_realised_with_numbers():
    lines = ["symflex = 1"]
    for i in range(100):
        before = f"x{i - 1}" if i else "ground"
        lines.append(f'elements.m{i} = {{ type = "mass", at = "x{i}", m = "2 kg" }}')
        lines.append(f'elements.k{i} = {{ type = "spring", between = ["{before}", "x{i}"], k = "8 N/m" }}')
    lines += ['inputs.F = { force = "x99" }', 'outputs.X = "x99"']
    model = with_numbers(pipeline.loads("\n".join(lines)))
    assert realise(model, [("X", "F")]).order == 200
