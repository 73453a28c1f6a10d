"""What inputs do not reach, or outputs do not show, is left out, and nothing else."""

import numpy as np
import pytest
import sympy
from hypothesis import given, settings

import symflex
from symflex import pipeline
from symflex.errors import BudgetError, ModelError, UncertifiedError
from symflex.model import with_numbers
from symflex.state_space import minimal, realise
from symflex.state_space.numeric import response, rounded
from tests.property.networks import networks, to_toml
from tests.unit.state_space.test_realise import DERIVATIONS, TWO_MASSES

POINTS = (0.37 + 1.13j, 1.71 - 0.59j, 0.05 + 2.9j)


def test_a_velocity_does_not_show_where_the_masses_are():
    found = symflex.loads(TWO_MASSES).transfer_function("V", "F").state_space(minimal=True)
    assert found.states == ("x_minus_y", "x_dot", "y_dot")
    x, y = sympy.symbols("x y")
    assert found.meanings["x_minus_y"] == x - y
    assert found.units["x_minus_y"] == "m"


def test_the_centre_of_mass_does_not_show_the_vibration():
    text = TWO_MASSES.replace('X = "x"', 'X = "(m_1*x + m_2*y)/(m_1 + m_2)"')
    found = symflex.loads(text).transfer_function("X", "F").state_space(minimal=True)
    m_1, m_2 = (sympy.Symbol(n, positive=True) for n in ("m_1", "m_2"))
    x, y = sympy.symbols("x y")
    assert found.states == ("z_1", "z_2")
    assert sympy.expand(found.meanings["z_1"] - (x + m_2 / m_1 * y)) == 0
    assert found.A == sympy.Matrix([[0, 1], [0, 0]])
    assert found.C * found.A * found.B == sympy.Matrix([1 / (m_1 + m_2)])


def test_what_the_input_does_not_reach_keeps_no_state():
    text = TWO_MASSES.replace(
        "inputs.F",
        'elements.far = { type = "mass", at = "z", m = "m_1" }\n'
        'elements.wall = { type = "spring", between = ["z", "ground"], k = "k" }\ninputs.F',
    )
    text = text.replace('V = "s*y"', 'V = "x + z"')
    model = symflex.loads(text)
    assert "z" in model.transfer_function("V", "F").state_space().states
    assert model.transfer_function("V", "F").state_space(minimal=True).states == ("x", "y", "x_dot", "y_dot")


def test_two_equal_arms_move_as_one():
    text = """
symflex = 1
parameters = { m = "2 kg", M = "9 kg", k = "3 N/m" }
elements.hub = { type = "mass", at = "x", m = "M" }
elements.a = { type = "mass", at = "y", m = "m" }
elements.b = { type = "mass", at = "z", m = "m" }
elements.p = { type = "spring", between = ["x", "y"], k = "k" }
elements.q = { type = "spring", between = ["x", "z"], k = "k" }
inputs.F = { force = "x" }
outputs.X = "x"
"""
    found = symflex.loads(text).transfer_function("X", "F").state_space(minimal=True)
    assert found.states == ("x", "y", "x_dot", "y_dot")


def test_one_realisation_of_several_outputs_is_minimal_for_all_of_them_together():
    model = symflex.loads(TWO_MASSES)
    assert len(model.state_space(minimal=True).states) == 4
    assert len(model.state_space(["V"], minimal=True).states) == 3


def test_a_pole_that_a_zero_cancels_is_left_out():
    text = 'symflex = 1\ninputs.u = {}\noutputs.y = "(s + 1)/((s + 2)*(s + 1))*u"'
    G = symflex.loads(text).transfer_function("y", "u")
    assert len(G.state_space().states) == 2
    found = G.state_space(minimal=True)
    assert (found.A, found.C * found.B) == (sympy.Matrix([[-2]]), sympy.Matrix([[1]]))


def test_six_masses_with_all_their_symbols_take_no_time():
    G = symflex.load(DERIVATIONS / "six_mass.toml").transfer_function("V_tip", "F")
    found = G.state_space(minimal=True)
    assert len(found.states) == 11
    assert found.states[:2] == ("x_act_minus_x_tip", "x_2_minus_x_tip")


def test_combinations_that_grow_too_large_are_refused(monkeypatch):
    monkeypatch.setattr("symflex.state_space.reduction.SIZE_LIMIT", 5)
    text = TWO_MASSES.replace('X = "x"', 'X = "(m_1*x + m_2*y)/(m_1 + m_2)"')
    G = symflex.loads(text).transfer_function("X", "F")
    with pytest.raises(BudgetError, match=r"SF502(.|\n)*bind"):
        G.state_space(minimal=True)


@pytest.mark.slow
@given(network=networks())
@settings(max_examples=40)
def test_a_random_network_has_as_many_minimal_states_as_proved_poles(network):
    model = pipeline.loads(to_toml(network))
    for pair in model.transfer_functions:
        (bound,) = pipeline.derive_bound(model, [pair])
        try:
            whole = realise(with_numbers(model), [pair])
        except ModelError as error:
            above, below = bound.source.order
            assert error.diagnostics[0].code == "SF236"
            assert above > below
            continue
        small = minimal(whole)
        found = pipeline.roots(bound)
        assert small.order == sum(r.multiplicity for r in found.poles)
        assert whole.order == small.order + sum(h.root.multiplicity for h in found.hidden)
        for system in (whole, small):
            for s, value in zip(POINTS, response(rounded(system), POINTS), strict=True):
                if np.isfinite(bound(s)):
                    assert value[0][0] == pytest.approx(bound(s), rel=1e-9)


def test_states_that_cancel_over_roots_are_left_out():
    # R + L s beside R + 1/(C s) with R = sqrt(L/C) is R.
    text = """symflex = 1
parameters = { L = "0.5 mH", C = "7.8 uF" }
definitions = { R = "sqrt(L/C)" }
[elements]
r1 = { type = "resistor", between = ["p", "a"], R = "R" }
l1 = { type = "inductor", between = ["a", "ground"], L = "L" }
r2 = { type = "resistor", between = ["p", "b"], R = "R" }
c2 = { type = "capacitor", between = ["b", "ground"], C = "C" }
[inputs]
I = { current = "p" }
[outputs]
U = "p"
"""
    tf = symflex.loads(text).transfer_function("U", "I")
    assert len(tf.state_space().states) == 2
    found = tf.state_space(minimal=True)
    inductance, capacitance = (sympy.Symbol(n, positive=True) for n in "LC")
    assert found.states == ()
    assert sympy.simplify(found.D[0, 0] - sympy.sqrt(inductance / capacitance)) == 0


def test_a_filter_over_dependent_roots_is_proved_minimal():
    # Butterworth's of fourth order: sqrt(2 - sqrt(2)) is sqrt(2)/sqrt(2 + sqrt(2)).
    sections = "(s^2 + sqrt(2 - sqrt(2))*w*s + w^2)*(s^2 + sqrt(2 + sqrt(2))*w*s + w^2)"
    text = f"""symflex = 1
parameters = {{ w = "1 rad/s", x = {{ value = "-2 rad/s", assume = "real" }} }}
inputs = {{ u = {{}} }}
outputs = {{ y = "w^4*u/({sections})", z = "w*u/(s + sqrt(x^2))" }}
"""
    model = symflex.loads(text)
    found = model.transfer_function("y", "u").state_space(minimal=True)
    assert (len(found.states), found.is_minimal) == (4, True)
    # The square root of x^2 is x or -x, and nothing is said of more.
    with pytest.raises(UncertifiedError, match="SF401"):
        minimal(realise(model.resolved, [("z", "u")]))
