"""Examples of environments with which an active machine is unstable."""

import numpy as np
import pytest

from symflex.contact.environment import put_at
from symflex.contact.passivity import find_passivity
from symflex.contact.port import ADMITTANCES
from symflex.library.elements import ELEMENTS
from symflex.model.ports import port_named
from tests.unit.contact.machines import DELAYED, LAGGED, machine


def test_every_element_has_its_parameter():
    for laws in ADMITTANCES.values():
        for type_name, parameter, _ in laws.values():
            assert parameter in {p.name for p in ELEMENTS[type_name].parameters}


def test_values_are_rounded_to_the_side_that_is_asked_for():
    port = port_named(machine(), "tip")
    assert put_at(port, "dissipative", 3.0778889, is_up=True).value == pytest.approx(3.078)
    assert put_at(port, "dissipative", 3.0778889, is_up=False).value == pytest.approx(3.077)


def test_a_mass_makes_the_lagged_wall_unstable_with_the_root_of_its_polynomial():
    # tau (m + M) s^3 + ((m + M) + b tau) s^2 + b s + K = 0.
    example = find_passivity(machine(), "tip").example
    (put,) = example.elements
    assert put.type_name == "mass"
    m = 1 + float(put.value)
    roots = np.roots([0.05 * m, m + 0.05, 1, 20.5])
    (right,) = [z for z in roots if z.real > 0 and z.imag > 0]
    assert complex(example.root) == pytest.approx(right, rel=1e-9)


def test_a_delayed_wall_is_unstable_with_a_root_of_its_own_equation():
    stiff = DELAYED.replace(
        "motor =", 'spring = { type = "spring", between = ["x", "ground"], k = 500 }\nmotor ='
    )
    example = find_passivity(machine(stiff), "tip").example
    (put,) = example.elements
    s = complex(example.root)
    m, k = (1 + float(put.value), 0.0) if put.type_name == "mass" else (1.0, float(put.value))
    assert s.real > 0
    assert abs(m * s**2 + s + 500 + k + 20.5 * np.exp(-s * 0.05)) < 1e-9 * abs(m * s**2)


def test_what_is_active_at_all_frequencies_is_unstable_with_a_hanging_mass_or_alone():
    text = LAGGED.replace("-K/(tau*s + 1)*x", "3*s*x*B").replace(
        "[parameters]", '[parameters]\nB = "1 N*s/m"'
    )
    text = text.replace(
        "[inputs]", 'k = { type = "spring", between = ["x", "ground"], k = "1 N/m" }\n[inputs]'
    )
    assert find_passivity(machine(text), "tip").example.elements == ()


NOT_COLLOCATED = """symflex = 1
[parameters]
kp = "900 N/m"
[elements]
a = { type = "mass", at = "x1", m = "2 kg" }
b = { type = "mass", at = "x2", m = "0.5 kg" }
spring = { type = "spring", between = ["x1", "x2"], k = "4000 N/m" }
damper = { type = "damper", between = ["x1", "x2"], b = "3 N*s/m" }
rail = { type = "damper", between = ["x1", "ground"], b = "10 N*s/m" }
motor = { type = "force_source", at = "x1", f = "-kp*x2/(1 + s/200)" }
[inputs]
F = { force = "x2" }
[outputs]
X = "x2"
[ports]
rel = { at = ["x1", "x2"] }
"""


def test_between_two_nodes_a_spring_with_an_inerter_is_found_with_a_root_of_both():
    example = find_passivity(machine(NOT_COLLOCATED), "rel").example
    spring, inerter = example.elements
    s, k, m = complex(example.root), float(spring.value), float(inerter.value)
    inner = 4000 + 3 * s
    equations = [[2 * s**2 + 10 * s + inner, 900 / (1 + s / 200) - inner], [-inner, 0.5 * s**2 + inner]]
    x1, x2 = np.linalg.solve(np.array(equations), [1, -1])
    assert s.real > 0
    assert s * (x1 - x2) == pytest.approx(-(s / k + 1 / (m * s)), rel=1e-6)
    assert "inerter" in example.lines()[0]
