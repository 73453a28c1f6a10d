"""The driving-point function of a machine, and an element put at its port."""

import numpy as np
import pytest
from sympy import Symbol, simplify, sympify

from symflex import pipeline
from symflex.contact import at_port, with_branch
from symflex.expressions import number
from symflex.model.ports import port_named
from symflex.print.sympy import sympy_system

s = Symbol("s")
OSCILLATOR = """symflex = 1
[elements]
body = { type = "mass", at = "m", m = "m" }
spring = { type = "spring", between = ["m", "base"], k = 100 }
damper = { type = "damper", between = ["m", "ground"], b = 3 }
[inputs]
motion = { displacement = "base" }
[outputs]
X = "spring.f"
[parameters]
m = 2
[ports]
tip = { at = "m" }
jaw = { at = ["m", "base"] }
"""
AMPLIFIER = """symflex = 1
[elements]
coil = { type = "inductor", between = ["v", "w"], L = 2 }
load = { type = "resistor", between = ["w", "ground"], R = 5 }
[inputs]
V = { current = "v" }
[outputs]
out = "w"
"""


def driving_point(text, name, **options):
    model = pipeline.loads(text)
    for kind, values in options.pop("put", {}).items():
        model = with_branch(model, port_named(model, name), kind, values, "put")
    driven, pair = at_port(model, port_named(model, name), **options)
    (tf,) = pipeline.derive_bound(driven, [pair])
    ratio = sympy_system(tf)
    return ratio.num / ratio.den


def is_equal(found, expected):
    return simplify(found - sympify(expected, {"s": s})) == 0


def test_a_delivered_force_moves_the_node_while_imposed_inputs_stand_still():
    assert is_equal(driving_point(OSCILLATOR, "tip"), "s/(2*s**2 + 3*s + 100)")


def test_an_imposed_velocity_needs_the_reciprocal_force():
    assert is_equal(driving_point(OSCILLATOR, "tip", is_imposed=True), "(2*s**2 + 3*s + 100)/s")


def test_at_an_electrical_port_a_current_is_delivered_and_a_voltage_answers():
    assert is_equal(driving_point(AMPLIFIER, "v"), "2*s + 5")


def test_between_two_nodes_a_force_and_its_reaction_act():
    assert is_equal(driving_point(OSCILLATOR, "jaw"), "s/(2*s**2 + 3*s + 100)")


HANDLE = """symflex = 1
parameters = { m = "1 kg", b = "1 N*s/m", k = "1 N/m" }
[equations]
unknowns = ["x"]
equations = ["2*m*s^2*x + 3*b*s*x + 100*k*x = F"]
[inputs]
F = { unit = "N" }
[outputs]
X = "x"
V = "s*x"
[ports]
"""


@pytest.mark.parametrize(
    "port",
    [
        '{ force = "F", displacement = "X" }',
        '{ force = "F", velocity = "V" }',
        '{ velocity = "V", force = "F" }',
    ],
)
def test_a_port_of_an_input_and_an_output_is_touched_as_a_node_is(port):
    text = f"{HANDLE}hand = {port}\n"
    assert is_equal(driving_point(text, "hand"), "s/(2*s**2 + 3*s + 100)")
    spring = driving_point(text, "hand", put={"spring": {"k": number(7)}})
    assert is_equal(spring, "s/(2*s**2 + 3*s + 107)")


def test_an_end_of_a_field_is_a_port():
    rod = """symflex = 1
[parameters]
EA = "1 N"
mu = "1 kg/m"
[fields.u]
domain = ["0 m", "1 m"]
equation = "EA*u'' = mu*s^2*u"
conditions = ["-EA*u'(0) = F", "u(1) = 0"]
[inputs]
F = {}
[outputs]
V = "s*u(0)"
[ports]
end = { force = "F", velocity = "V" }
"""
    driven, pair = at_port(pipeline.loads(rod), port_named(pipeline.loads(rod), "end"))
    (mobility,) = pipeline.derive_bound(driven, [pair])
    # A rod held at the other end: v/f = tanh(s l/c)/sqrt(EA mu).
    assert mobility(0.3 + 2j) == pytest.approx(np.tanh(0.3 + 2j), rel=1e-12)


def test_an_element_is_put_between_the_port_and_ground():
    spring = driving_point(OSCILLATOR, "tip", put={"spring": {"k": number(7)}})
    assert is_equal(spring, "s/(2*s**2 + 3*s + 107)")
    mass = driving_point(OSCILLATOR, "tip", put={"mass": {"m": number(7)}})
    assert is_equal(mass, "s/(9*s**2 + 3*s + 100)")
