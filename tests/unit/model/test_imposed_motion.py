"""Inputs that nodes follow: what moves, what that takes, and what is refused."""

import re
from math import sqrt

import pytest

import symflex
from symflex import pipeline
from symflex.analysis.explanation import explain_zeros
from symflex.errors import SymflexError

# One mass on a spring and a damper whose far end is moved.
SUSPENDED = """
symflex = 1
[parameters]
m = "2 kg"
k = "50 N/m"
b = "3 N*s/m"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "base"], k = "k" }
loss = { type = "damper", between = ["x", "base"], b = "b" }
[inputs]
u = { INPUT }
[outputs]
X = "x"
A = "s^2*x"
R = "x - base"
F = "u.f"
"""
TURNED = """
symflex = 1
[elements]
disc = { type = "inertia", at = "phi", J = "2 kg*m^2" }
shaft = { type = "torsion_spring", between = ["phi", "drive"], k = "50 N*m/rad" }
[inputs]
u = { INPUT }
[outputs]
X = "phi"
F = "u.tau"
"""
S = 0.7 + 3.1j


def suspended(given):
    return symflex.loads(SUSPENDED.replace("INPUT", given))


def value(model, name, source="u"):
    return complex(model.transfer_function(name, source).bind()(S))


def moved():
    """X over the motion of its base, by Newton's law: m s^2 x = (k + b s)(u - x)."""
    link = 50 + 3 * S
    return link / (2 * S**2 + link)


def test_a_body_follows_its_moved_base_as_newton_says():
    for kind, rate in [("displacement", 1), ("velocity", S), ("acceleration", S**2)]:
        model = suspended(f'{kind} = "base"')
        assert value(model, "X") == pytest.approx(moved() / rate, rel=1e-13), kind
        assert value(model, "A") == pytest.approx(moved() * S**2 / rate, rel=1e-13), kind


def test_a_disc_follows_its_turned_shaft_as_newton_says():
    for kind, rate in [("angle", 1), ("angular_velocity", S), ("angular_acceleration", S**2)]:
        model = symflex.loads(TURNED.replace("INPUT", f'{kind} = "drive"'))
        turned = 50 / (2 * S**2 + 50)
        assert value(model, "X") == pytest.approx(turned / rate, rel=1e-13), kind
        assert value(model, "F") == pytest.approx(50 * (1 - turned) / rate, rel=1e-13), kind


def test_transmissibility_at_a_frequency_ratio_is_that_of_the_textbook():
    # Den Hartog 1956: |T|^2 = (1 + (2 zeta r)^2)/((1 - r^2)^2 + (2 zeta r)^2).
    omega_n, r = 5.0, 1.7
    loss = 2 * (3 / (2 * sqrt(50 * 2))) * r
    expected = sqrt((1 + loss**2) / ((1 - r**2) ** 2 + loss**2))
    G = suspended('displacement = "base"').transfer_function("X", "u").bind()
    assert abs(complex(G(1j * r * omega_n))) == pytest.approx(expected, rel=1e-13)


def test_the_force_it_takes_accelerates_the_body():
    model = suspended('displacement = "base"')
    assert value(model, "F") == pytest.approx(2 * S**2 * moved(), rel=1e-13)


def test_the_force_on_a_moved_mass_carries_its_inertia_too():
    G = suspended('displacement = "x"').transfer_function("F", "u").bind()
    assert complex(G(S)) == pytest.approx(2 * S**2, rel=1e-13)  # the base, free and without mass, comes along


def test_a_motion_at_two_nodes_is_relative_and_its_force_acts_on_the_first():
    model = symflex.loads(
        'symflex = 1\n[elements]\na = { type = "mass", at = "x", m = 2 }\n'
        'b = { type = "mass", at = "y", m = 3 }\n[inputs]\n'
        'u = { displacement = ["x", "y"] }\n[outputs]\nX = "x"\nY = "y"\nF = "u.f"\n'
    )
    # Momentum is kept: 2 x + 3 y = 0 and x - y = u.
    assert value(model, "X") == pytest.approx(0.6)
    assert value(model, "Y") == pytest.approx(-0.4)
    assert value(model, "F") == pytest.approx(2 * 0.6 * S**2)


def test_a_force_elsewhere_finds_an_imposed_node_at_rest():
    text = SUSPENDED.replace("INPUT", 'velocity = "base"').replace(
        "[outputs]", 'F_x = { force = "x" }\n[outputs]'
    )
    G = symflex.loads(text).transfer_function("X", "F_x").bind()
    assert complex(G(S)) == pytest.approx(1 / (2 * S**2 + 3 * S + 50), rel=1e-13)


def test_a_bare_planar_node_moves_in_y():
    for place in ["p", "p.y"]:
        model = symflex.loads(
            'symflex = 1\n[elements]\nbody = { type = "rigid_body", at = "p", m = 2, J = 3, cg = "0.5 m" }\n'
            f'[inputs]\nu = {{ displacement = "{place}" }}\n[outputs]\nY = "p"\nQ = "p.theta"\nF = "u.f"\n'
        )
        assert value(model, "Y") == pytest.approx(1), place
        # Free to turn about the moved point: (J + m c^2) theta + m c y = 0.
        assert value(model, "Q") == pytest.approx(-2 * 0.5 / (3 + 2 * 0.25)), place


def test_the_end_of_a_rod_is_moved():
    model = symflex.loads(
        "symflex = 1\n[elements]\n"
        'bar = { type = "rod", between = ["a", "b"], E = 7, A = 2, rho = 3, l = 1.5 }\n'
        '[inputs]\nu = { displacement = "a" }\n[outputs]\nX = "b"\n'
    )
    # A free rod: u(l)/u(0) = 1/cosh(gamma l), gamma^2 = rho s^2/E.
    from cmath import cosh

    assert value(model, "X") == pytest.approx(1 / cosh(1.5 * S * sqrt(3 / 7)), rel=1e-12)


def test_a_voltage_input_offers_its_current():
    model = symflex.loads(
        'symflex = 1\n[elements]\nR = { type = "resistor", between = ["a", "ground"], R = 4 }\n'
        '[inputs]\nu = { voltage = "a" }\n[outputs]\nI = "u.i"\n'
    )
    assert value(model, "I") == pytest.approx(0.25)


def test_an_element_of_a_voltage_inputs_name_keeps_its_current():
    model = symflex.loads(
        'symflex = 1\n[elements]\nR = { type = "resistor", between = ["a", "ground"], R = 4 }\n'
        'u = { type = "dc_motor", terminals = ["a", "ground"], shaft = "phi", R = 4, k_t = 3 }\n'
        'J = { type = "fixed", at = "phi" }\n'
        '[inputs]\nu = { voltage = "a" }\n[outputs]\nI = "u.i"\n'
    )
    assert value(model, "I") == pytest.approx(0.25)  # of the motor alone; both together take 0.5


def test_transfer_functions_of_a_motion_have_its_unit_below():
    for given, units in [
        ('displacement = "base"', ["1", "1/s^2", "1", "N/m"]),
        ('velocity = "base"', ["s", "1/s", "s", "N*s/m"]),
        ('acceleration = "base"', ["s^2", "1", "s^2", "N*s^2/m"]),
    ]:
        model = suspended(given)
        assert [model.transfer_function(o, "u").unit for o in "XARF"] == units, given


def test_transfer_functions_of_a_motion_are_called_as_in_the_field():
    for given, names in [
        ('displacement = "base"', ("transmissibility", "dynamic stiffness")),
        ('velocity = "base"', ("transfer function", "mechanical impedance")),
        ('acceleration = "base"', ("transfer function", "apparent mass")),
    ]:
        model = suspended(given)
        assert tuple(model.transfer_function(o, "u").quantity for o in "XF") == names, given


def test_acceleration_per_imposed_acceleration_is_a_transmissibility():
    assert suspended('acceleration = "base"').transfer_function("A", "u").quantity == "transmissibility"


def test_a_motion_that_cannot_be_is_refused_where_it_stands():
    for inputs, code, position in [
        ('u = { displacement = "base" }\nv = { velocity = "base" }', "SF302", "12:1"),
        ('u = { displacement = "x" }\nv = { displacement = ["x", "ground"] }', "SF302", "12:1"),
        ('u = { displacement = "ground" }', "SF218", "11:22"),
        ('u = { displacement = ["ground", "ground"] }', "SF218", "11:22"),
        ('u = { displacement = ["x", "x"] }', "SF218", "11:22"),
        ('u = { displacement = ["x", "base", "z"] }', "SF217", "11:22"),
        ('u = { displacement = [] }', "SF217", "11:22"),
        ('u = { displacement = 3 }', "SF206", "11:22"),
        ('u = { displacement = "base.theta" }', "SF219", "11:23"),
        ('u = { angle = "base" }', "SF220", "11:16"),
        ('u = { angular_velocity = "base.y" }', "SF219", "11:27"),
        ('u = { displacement = "base", velocity = "x" }', "SF217", "11:30"),
        ('u = { displacement = "base", unit = "mm" }', "SF203", "11:38"),
        ('u = { velocity = "base", unit = "m" }', "SF203", "11:34"),
        ('u = { speed = "base" }', "SF207", "11:7"),
    ]:  # fmt: skip
        text = SUSPENDED[1:].replace("u = { INPUT }", inputs).replace('F = "u.f"', "")
        with pytest.raises(SymflexError) as caught:
            pipeline.check_solvable(pipeline.assemble(pipeline.loads(text)))
        found = caught.value.diagnostics[0]
        assert (found.code, str(found.span).removeprefix("<string>:")) == (code, position), inputs


def test_a_motion_and_a_support_at_one_node_are_refused():
    text = SUSPENDED.replace("INPUT", 'displacement = "base"').replace(
        "[inputs]", 'wall = { type = "fixed", at = "base" }\n[inputs]'
    )
    with pytest.raises(SymflexError, match=re.escape("the constraints of 'wall' and 'u'")) as caught:
        pipeline.check_solvable(pipeline.assemble(pipeline.loads(text)))
    assert caught.value.diagnostics[0].code == "SF302"


def test_a_quantity_a_motion_does_not_offer_is_answered_with_the_one_it_does():
    text = SUSPENDED.replace("INPUT", 'displacement = "base"').replace("u.f", "u.tau")
    with pytest.raises(SymflexError) as caught:
        pipeline.loads(text)
    (found,) = caught.value.diagnostics
    assert (found.code, found.hint) == ("SF210", "it offers u.f")


def test_an_element_and_a_motion_of_one_name_that_both_offer_a_force_are_told_apart():
    text = SUSPENDED.replace("u = { INPUT }", 'spring = { displacement = "base" }').replace("u.f", "spring.f")
    with pytest.raises(SymflexError, match="two ways") as caught:
        pipeline.loads(text)
    assert caught.value.diagnostics[0].code == "SF211"


def test_zeros_of_the_force_a_motion_takes_are_the_poles_of_the_free_system():
    text = SUSPENDED.replace("INPUT", 'displacement = "x"').replace('"base"], k', '"ground"], k')
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, [("F", "u")])
    told = explain_zeros(model, bound, pipeline.roots(bound))
    assert (told.kind, told.status, told.held) == ("free", "proved", "u.f = 0")


def test_the_nested_form_knows_imposed_motions():
    tf = suspended('velocity = "base"').nested("R", "u")
    assert complex(tf.bind()(S)) == pytest.approx((moved() - 1) / S, rel=1e-12)


def test_a_motion_may_bear_the_name_of_the_node_it_moves():
    # Both readings of the name are one value; a velocity of that name is not, and stays ambiguous.
    text = SUSPENDED.replace("u = { INPUT }", 'base = { displacement = "base" }').replace("u.f", "x - base")
    (*_, tf) = pipeline.derive_all(pipeline.loads(text))
    assert pipeline.bind(tf)(0j) == 0
    with pytest.raises(SymflexError, match="two ways"):
        pipeline.loads(text.replace("displacement", "velocity"))
