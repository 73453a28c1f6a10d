"""The driving-point function of a machine, and an element put at its port."""

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


def test_an_element_is_put_between_the_port_and_ground():
    spring = driving_point(OSCILLATOR, "tip", put={"spring": {"k": number(7)}})
    assert is_equal(spring, "s/(2*s**2 + 3*s + 107)")
    mass = driving_point(OSCILLATOR, "tip", put={"mass": {"m": number(7)}})
    assert is_equal(mass, "s/(9*s**2 + 3*s + 100)")
