"""Ports: what is read, and what is refused with its reason."""

import pytest

import symflex
from symflex import pipeline
from symflex.errors import SpecError, UsageError
from symflex.model.model import PORT_PAIRS
from symflex.model.ports import port_named
from symflex.quantities import unit_of

MACHINE = """symflex = 1
[elements]
cart = { type = "mass", at = "cart", m = "1 kg" }
spring = { type = "spring", between = ["cart", "base"], k = "100 N/m" }
wheel = { type = "inertia", at = "wheel", J = "1 kg*m^2" }
clamp = { type = "fixed", at = "wall" }
brace = { type = "spring", between = ["cart", "wall"], k = "1 N/m" }
room = { type = "thermal_capacity", at = "room", C = "1 J/K" }
coil = { type = "inductor", between = ["coil", "ground"], L = "1 H" }
pipe = { type = "acoustic_mass", between = ["pipe", "ground"], M = "1 kg/m^4" }
arm = { type = "beam", between = ["root", "tip"], EI = "1 N*m^2", rhoA = "1 kg/m", l = "1 m" }
[inputs]
ground_motion = { displacement = "base" }
V = { voltage = "amplifier" }
[outputs]
X = "cart"
"""


def read(ports):
    return pipeline.loads(MACHINE + "[ports]\n" + ports)


def refusal(ports):
    with pytest.raises(SpecError) as caught:
        read(ports)
    (problem,) = caught.value.diagnostics
    return problem.code, problem.message, problem.hint or ""


def test_a_port_has_the_domain_of_its_node():
    model = read('a = { at = "cart" }\nb = { at = "wheel" }\nc = { at = "coil" }\nd = { at = "pipe" }\n')
    assert [p.domain for p in model.ports] == ["translation", "rotation", "electrical", "acoustic"]


def test_a_planar_node_is_touched_at_its_deflection_or_where_a_part_says():
    model = read('a = { at = "tip" }\nb = { at = "tip.theta" }\nc = { at = ["cart", "tip.y"] }\n')
    assert [p.domain for p in model.ports] == ["translation", "rotation", "translation"]
    assert [r.node for r in model.ports[2].nodes] == ["cart", "tip"]


@pytest.mark.parametrize(
    ("ports", "code", "says"),
    [
        ('a = { at = "cort" }', "SF210", "cart"),
        ('a = { at = "ground" }', "SF218", "ground"),
        ('a = { at = "base" }', "SF218", "ground_motion"),
        ('a = { at = "wall" }', "SF218", "clamp"),
        ('a = { at = "room" }', "SF219", "no power"),
        ('a = { at = "cart.theta" }', "SF219", "no part"),
        ('a = { at = ["cart", "wheel"] }', "SF219", "rotation"),
        ('a = { at = ["cart", "cart"] }', "SF218", "twice"),
        ('a = { at = ["cart", "tip", "coil"] }', "SF217", "found 3"),
        ('a = "cart"', "SF206", "table"),
    ],
)
def test_a_port_that_cannot_be_touched_is_refused(ports, code, says):
    found = refusal(ports)
    assert found[0] == code
    assert says in found[1] + found[2]


def test_a_port_is_named_or_a_node():
    model = read('hand = { at = "cart" }\n')
    assert port_named(model, "hand") == model.ports[0]
    assert port_named(model, "tip.theta").domain == "rotation"
    with pytest.raises(UsageError, match="no node 'hnd'"):
        port_named(model, "hnd")


def test_units_of_a_pair_multiply_to_a_power():
    for pair in PORT_PAIRS.values():
        effort, flow = (unit_of(unit).dimension for unit in pair.units)
        assert effort * flow == unit_of("W").dimension


EQUATIONS = """symflex = 1
[parameters]
m = "2 kg"
[equations]
unknowns = ["x"]
equations = ["m*s^2*x = F"]
[inputs]
F = { unit = "N" }
[outputs]
X = "x"
V = "s*x"
[ports]
"""


@pytest.mark.parametrize(
    ("port", "code", "says"),
    [
        ('hand = { force = "F" }', "SF217", "its dual"),
        ('hand = { velocity = "V" }', "SF217", "delivered"),
        ('hand = { force = "F", angle = "X" }', "SF219", "no power"),
        ('hand = { force = "G", velocity = "V" }', "SF210", "no free input 'G'"),
        ('hand = { force = "F", velocity = "U" }', "SF210", "no output 'U'"),
        ('hand = { force = "F", velocity = 3 }', "SF206", "string"),
        ('m = { force = "F", velocity = "V" }', "SF211", "something else"),
        ('hand = { force = "F", velocity = "V", at_ = "x" }', "SF207", "at_"),
    ],
)
def test_a_port_of_an_input_and_an_output_that_cannot_be_one_is_refused(port, code, says):
    with pytest.raises(SpecError) as caught:
        pipeline.loads(EQUATIONS + port + "\n")
    problem = caught.value.diagnostics[0]
    assert problem.code == code and says in problem.message


def test_equations_are_as_they_were_beside_a_port():
    with_port = EQUATIONS + 'hand = { force = "F", displacement = "X" }\n'
    for text in (with_port, EQUATIONS.replace("[ports]\n", "")):
        receptance = symflex.loads(text).transfer_function("X", "F")
        assert str(receptance.form()) == "X/F = 1/(m*s^2)"
