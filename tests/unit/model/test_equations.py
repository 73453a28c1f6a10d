"""Equations of motion as they stand on paper, against numpy's solution of the same equations at one s."""

import numpy as np
import pytest

import symflex
from symflex.errors import ModelError, SpecError

S = 0.7 + 3.1j


def value(model, output, source, s=S):
    return complex(model.transfer_function(output, source).bind()(s))


def test_an_inverted_pendulum_on_a_cart():
    model = symflex.loads("""
    symflex = 1
    parameters = { M = "2 kg", m = "0.5 kg", l = "0.3 m", g = "9.81 m/s^2" }
    inputs.F = { unit = "N" }
    outputs = { X = "x", Theta = "theta" }
    [equations]
    unknowns  = ["x", "theta"]
    equations = ["(M + m)*s^2*x + m*l*s^2*theta = F", "s^2*x + l*s^2*theta - g*theta = 0"]
    """)
    matrix = np.array([[2.5 * S**2, 0.15 * S**2], [S**2, 0.3 * S**2 - 9.81]])
    x, theta = np.linalg.solve(matrix, [1, 0])
    np.testing.assert_allclose([value(model, "X", "F"), value(model, "Theta", "F")], [x, theta], rtol=1e-13)
    # Textbooks: the pole is sqrt((M + m) g/(M l)).
    poles = [complex(p).real for p in model.transfer_function("Theta", "F").bind().poles()]
    np.testing.assert_allclose(max(poles), np.sqrt(2.5 * 9.81 / 0.6))
    assert [str(o.dimension) for o in model.resolved.outputs] == ["m", "1"]


def test_a_double_pendulum_with_small_angles():
    model = symflex.loads("""
    symflex = 1
    parameters = { m_1 = "1 kg", m_2 = "0.4 kg", l_1 = "0.8 m", l_2 = "0.5 m", g = "9.81 m/s^2" }
    inputs.tau = { unit = "N*m" }
    outputs.Phi = "phi_2 - phi_1"
    [equations]
    unknowns = ["phi_1", "phi_2"]
    equations = [
      "(m_1 + m_2)*l_1^2*s^2*phi_1 + m_2*l_1*l_2*s^2*phi_2 + (m_1 + m_2)*g*l_1*phi_1 = tau",
      "m_2*l_1*l_2*s^2*phi_1 + m_2*l_2^2*s^2*phi_2 + m_2*g*l_2*phi_2 = 0",
    ]
    """)
    mass = np.array([[1.4 * 0.64, 0.4 * 0.4], [0.4 * 0.4, 0.4 * 0.25]])
    motion = np.linalg.solve(mass * S**2 + np.diag([1.4 * 9.81 * 0.8, 0.4 * 9.81 * 0.5]), [1, 0])
    np.testing.assert_allclose(value(model, "Phi", "tau"), motion[1] - motion[0], rtol=1e-13)


def test_a_quarter_car_with_both_sides_filled():
    model = symflex.loads("""
    symflex = 1
    parameters = { m_s = "300 kg", m_u = "40 kg", k_s = "18 kN/m", k_t = "180 kN/m", b = "1.2 kN*s/m" }
    inputs.z_r = { unit = "m" }
    outputs = { Z = "z_s", Travel = "z_s - z_u" }
    [equations]
    unknowns  = ["z_s", "z_u"]
    equations = [
      "m_s*s^2*z_s = -(k_s + b*s)*(z_s - z_u)",
      "m_u*s^2*z_u = (k_s + b*s)*(z_s - z_u) - k_t*(z_u - z_r)",
    ]
    """)
    link = 18e3 + 1.2e3 * S
    matrix = np.array([[300 * S**2 + link, -link], [-link, 40 * S**2 + link + 180e3]])
    body, wheel = np.linalg.solve(matrix, [0, 180e3])
    found = [value(model, "Z", "z_r"), value(model, "Travel", "z_r")]
    np.testing.assert_allclose(found, [body, body - wheel], rtol=1e-12)


def test_equations_beside_elements_and_signals():
    # A cart of elements, its pendulum an equation; the rod pulls the cart with -m s^2 (x + l theta).
    model = symflex.loads("""
    symflex = 1
    parameters = { m = "0.5 kg", l = "0.3 m", g = "9.81 m/s^2" }
    elements.cart = { type = "mass", at = "x", m = "2 kg" }
    elements.rod = { type = "force_source", at = "x", f = "-m*s^2*tip" }
    signals.tip = "x + l*theta"
    inputs.F = { force = "x" }
    outputs.X = "x"
    [equations]
    unknowns  = ["theta"]
    equations = ["s^2*tip + g*theta = 0"]
    """)
    matrix = np.array([[2.5 * S**2, 0.15 * S**2], [S**2, 0.3 * S**2 + 9.81]])
    np.testing.assert_allclose(value(model, "X", "F"), np.linalg.solve(matrix, [1, 0])[0], rtol=1e-13)
    nested = complex(model.nested("X", "F").bind()(S))
    np.testing.assert_allclose(nested, np.linalg.solve(matrix, [1, 0])[0], rtol=1e-13)


def test_an_unknown_may_be_the_force_of_a_constraint():
    # x = 3 y by a force f: the kinetic energy is that of 2 + 1/9 kg at x.
    model = symflex.loads("""
    symflex = 1
    elements.one = { type = "mass", at = "x", m = "2 kg" }
    elements.two = { type = "mass", at = "y", m = "1 kg" }
    elements.left = { type = "force_source", at = "x", f = "f" }
    elements.right = { type = "force_source", at = "y", f = "-3*f" }
    equations = { unknowns = ["f"], equations = ["x = 3*y"] }
    inputs.F = { force = "x" }
    outputs.X = "x"
    """)
    assert str(model.transfer_function("X", "F")) == "X/F = 9/(19*s^2)"


def test_state_equations_of_written_equations_are_theirs():
    model = symflex.loads("""
    symflex = 1
    inputs = { u = {}, v = {} }
    outputs.y = "p + 2*q"
    equations = { unknowns = ["p", "q"], equations = ["s*p + 2*q = 3*u", "s^2*q + 4*s*p/(s + 5) = 7*p - v"] }
    """)
    states = model.state_space().bind()
    matrix = np.array([[S, 2], [4 * S / (S + 5) - 7, S**2]])
    for source, load in (("u", [3, 0]), ("v", [0, -1])):
        p, q = np.linalg.solve(matrix, load)
        i = [x.name for x in model.resolved.inputs].index(source)
        resolvent = np.linalg.solve(S * np.eye(len(states.A)) - states.A, states.B[:, i])
        np.testing.assert_allclose((states.C @ resolvent + states.D[:, i])[0], p + 2 * q, rtol=1e-12)
        np.testing.assert_allclose(value(model, "y", source), p + 2 * q, rtol=1e-12)


def test_a_loop_around_written_equations_is_judged():
    # (M l s^2 - K T s - (M + m) g - K) theta = -d is stable for K < -(M + m) g.
    model = symflex.loads("""
    symflex = 1
    parameters.K = { value = "-60 N", assume = "real" }
    inputs.d = { unit = "N" }
    signals.u = "d - K*(1 + 0.1*s)*theta"
    outputs.Theta = "theta"
    [equations]
    unknowns  = ["x", "theta"]
    equations = ["2.5*s^2*x + 0.15*s^2*theta = u", "s^2*x + 0.3*s^2*theta - 9.81*theta = 0"]
    """)
    (boundary,) = model.stability("K").boundaries
    assert float(boundary.gain) == pytest.approx(-2.5 * 9.81)


def test_equations_that_follow_from_each_other_say_so():
    model = symflex.loads("""
    symflex = 1
    inputs.F = {}
    outputs.X = "x"
    equations = { unknowns = ["x", "y"], equations = ["x + y = F", "2*x + 2*y = 0"] }
    """)
    with pytest.raises(ModelError, match=r"'x \+ y = F' and '2\*x \+ 2\*y = 0' repeat or contradict"):
        model.transfer_function("X", "F")


def test_what_equations_leave_free_cancels_and_stays_a_hidden_mode():
    model = symflex.loads("""
    symflex = 1
    inputs.F = {}
    outputs.X = "x"
    equations = { unknowns = ["x", "y"], equations = ["s*x + 1*x = F", "s*y - 2*y = 3*x"] }
    """)
    found = model.transfer_function("X", "F").bind().pole_zero_map()
    assert [float(p.re) for p in found.poles] == [-1]
    assert [float(h.root.re) for h in found.hidden] == [2]


def test_terms_that_disagree_are_shown_in_full_units():
    # Beside m*s*v and v/d alone, whose unknown v has no unit yet, neither would be a force.
    text = """symflex = 1
parameters = { m = "2 kg", k = "400 N/m", d = "0.1 m" }
inputs.F = { unit = "N" }
outputs.V = "v"
[equations]
unknowns = ["v", "x"]
equations = ["m*s*v + v/d + k*x = F", "v = s*x"]
"""
    with pytest.raises(SpecError, match=r"terms of a sum disagree: F in 'N' and v/d in '1/s'"):
        symflex.loads(text)


def test_units_are_inferred_beside_a_written_number():
    # The 2 of 2*m*Omega*s*y is a pure number, as nothing in the model says otherwise.
    model = symflex.loads("""
    symflex = 1
    parameters = { m = "2 ug", k = "0.8 N/m", Omega = "5 rad/s" }
    inputs.F = { unit = "N" }
    outputs.Y = "y"
    [equations]
    unknowns = ["x", "y"]
    equations = ["m*s^2*x + k*x - 2*m*Omega*s*y = F", "m*s^2*y + k*y + 2*m*Omega*s*x = 0"]
    """)
    assert model.transfer_function("Y", "F").unit == "m/N"
