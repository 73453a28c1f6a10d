"""Members of plane frames: nodes of the plane, directions, what is read along a member."""

import math
from fractions import Fraction

import numpy as np
import pytest

import symflex
from symflex import pipeline
from symflex.errors import ModelError, SpecError
from symflex.expressions import Name, Number, Product, Quotient, Sum, format_expression, negative
from symflex.model.direction import direction_of

VALUES = 'E = "70 GPa", I = "2e-9 m^4", A = "3e-5 m^2", rho = "2700 kg/m^3"'
POINTS = (3 + 40j, 700j, 100 + 5000j)


def frame(name, first, second, angle=0, length="0.3 m", more=""):
    ends = f'between = ["{first}", "{second}"]'
    return f'{name} = {{ type = "frame", {ends}, {VALUES}, l = "{length}", angle = {angle}{more} }}\n'


def model(elements, inputs='F = { force = "b.y" }', outputs='Y = "b.y"'):
    text = f"symflex = 1\n[elements]\n{elements}\n[inputs]\n{inputs}\n[outputs]\n{outputs}\n"
    return pipeline.loads(text)


def values(elements, inputs='F = { force = "b.y" }', outputs='Y = "b.y"'):
    """Return every transfer function at some points, with numbers in place."""
    found = model(elements, inputs, outputs)
    functions = pipeline.derive_bound(found, found.transfer_functions)
    return [complex(function(s)) for function in functions for s in POINTS]


def near(left, right):
    return all(abs(a - b) <= 1e-12 * abs(b) for a, b in zip(left, right, strict=True))


def problems(text):
    with pytest.raises(SpecError) as caught:
        pipeline.loads(text)
    return [(d.code, d.message, d.hint) for d in caught.value.diagnostics]


ALPHA, PI = Name("alpha"), Name("pi")


def part(numerator, denominator):
    return Quotient(Product((Number(Fraction(numerator)), PI)), Number(Fraction(denominator)))


def test_an_angle_enters_by_its_cosine_and_sine_as_exact_as_they_are():
    for angle, cos, sin in [
        (Number(Fraction(0)), "1", "0"),
        (part(1, 2), "0", "1"),
        (PI, "-1", "0"),
        (negative(part(1, 2)), "0", "-1"),
        (part(1, 3), "0.5", "0.5*sqrt(3)"),
        (part(5, 6), "-0.5*sqrt(3)", "0.5"),
        (part(7, 4), "0.5*sqrt(2)", "-0.5*sqrt(2)"),
        (part(1, 7), "cos(1*pi/7)", "sin(1*pi/7)"),
        (Sum((ALPHA, part(1, 2))), "-sin(alpha)", "cos(alpha)"),
        (Sum((PI, negative(ALPHA))), "-cos(alpha)", "sin(alpha)"),
    ]:
        found = direction_of(angle)
        assert (format_expression(found["cos"]), format_expression(found["sin"])) == (cos, sin), angle


def test_products_of_roots_are_rational():
    found = direction_of(part(-1, 4))
    assert [format_expression(found[name]) for name in ("cos_cos", "cos_sin")] == ["0.5", "-0.5"]


def test_a_straight_member_is_a_beam_and_a_rod():
    inputs, outputs = 'F = { force = "b.y" }\nG = { force = "b.x" }', 'Y = "b.y"\nX = "b.x"'
    for more in (', N = "30 N"', ', theory = "timoshenko", kappa = 0.85, G = "26 GPa"'):
        apart = (
            f'bend = {{ type = "beam", between = ["ground", "b"], {VALUES}, l = "0.3 m"{more} }}\n'
            f'stretch = {{ type = "rod", between = ["ground", "b.x"], E = "70 GPa", A = "3e-5 m^2", '
            'rho = "2700 kg/m^3", l = "0.3 m" }\n'
        )
        whole = frame("member", "ground", "b", more=more)
        assert near(values(whole, inputs, outputs), values(apart, inputs, outputs)), more


@pytest.mark.slow
def test_turning_a_whole_frame_with_its_load_changes_nothing():
    def response(by):
        elements = (
            frame("column", "ground", "p", f'"{by} + pi/2"')
            + frame("boom", "p", "b", f'"{by}"')
            + f'along_x = {{ type = "force_source", at = "b.x", f = "-sin({by})*U" }}\n'
            f'along_y = {{ type = "force_source", at = "b.y", f = "cos({by})*U" }}\n'
        )
        return values(elements, "U = {}", f'Y = "cos({by})*b.y - sin({by})*b.x"')

    upright = response("0")
    assert near(response("-pi/4"), upright)
    assert near(response("0.7"), upright)


@pytest.mark.slow
def test_a_frame_that_is_turned_as_a_whole_has_the_formula_of_one_that_is_not():
    text = (
        'symflex = 1\n[parameters]\na = { unit = "rad", assume = "real" }\n[elements]\n'
        + frame("post", "ground", "p", '"a + pi/2"')
        + frame("boom", "p", "b", '"a"')
        + '[inputs]\nT = { torque = "b" }\n[outputs]\nQ = "b.theta"\n'
    )
    (turned,) = pipeline.derive_all(pipeline.loads(text))
    (upright,) = pipeline.derive_all(pipeline.loads(text.replace("a + ", "").replace('"a"', "0")))
    assert "a" not in {p.name for p in turned.parameters}
    terms = [max(len(f) for f, _ in part.factors) for tf in (turned, upright) for part in (tf.num, tf.den)]
    assert terms[:2] == terms[2:]


def test_two_members_in_line_are_one_of_both_lengths():
    joined = frame("one", "ground", "p", '"45 deg"', "0.1 m") + frame("two", "p", "b", '"45 deg"', "0.1 m")
    assert near(values(joined), values(frame("whole", "ground", "b", '"45 deg"', "0.2 m")))


def test_a_member_turned_end_for_end_is_the_same():
    backwards = frame("member", "b", "ground", '"-120 deg"')
    assert near(values(backwards), values(frame("member", "ground", "b", '"60 deg"')))


def test_at_its_ends_what_is_read_along_a_member_is_what_its_nodes_do():
    outputs = 'A = "b.x"\nB = "b.y"\nC = "b.theta"\nP = "m.x(0.3 m)"\nQ = "m.y(0.3 m)"\nR = "m.theta(0.3 m)"'
    found = values(frame("m", "ground", "b", '"60 deg"'), outputs=outputs)
    assert near(found[:9], found[9:])


def test_in_its_own_axes_a_vertical_member_moves_along_y_and_across_minus_x():
    outputs = 'A = "m.y(0.1 m)"\nB = "m.u(0.1 m)"\nC = "-m.x(0.1 m)"\nD = "m.v(0.1 m)"'
    found = values(
        frame("m", "ground", "b", '"90 deg"'), 'F = { force = "b.y" }\nG = { force = "b.x" }', outputs
    )
    assert near(found[:6], found[6:12])
    assert near(found[12:18], found[18:])


def test_its_axial_force_is_that_of_its_strain():
    outputs = 'N = "m.f_u(0.1 m)"\nS = "70e9*3e-5*k*m.u\'(0.1 m)"'
    text = frame("m", "ground", "b", '"30 deg"')
    spec = (
        f'symflex = 1\nparameters.k = {{ value = 1, unit = "N" }}\n[elements]\n{text}\n[inputs]\n'
        f'F = {{ force = "b.y" }}\n[outputs]\n{outputs}\n'
    )
    found = pipeline.loads(spec)
    stress, strain = pipeline.derive_bound(found, found.transfer_functions)
    assert near([stress(s) for s in POINTS], [strain(s) for s in POINTS])


def test_what_it_delivers_at_its_second_end_is_minus_what_the_rest_exerts_there():
    outputs = 'A = "m.f_x"\nB = "-m.f_x(0.3 m)"'
    found = values(frame("m", "ground", "b", '"30 deg"') + frame("n", "b", "c"), outputs=outputs)
    assert near(found[:3], found[3:])


def test_a_link_carries_a_planar_node_along_x():
    link = 'link = { type = "rigid_link", between = ["b", "tip"], length = "0.1 m" }\n'
    found = model(frame("m", "ground", "b") + link)
    assert {n.name: n.domain for n in found.nodes} == {"b": "plane", "tip": "plane"}


def test_a_planar_node_without_members_has_no_x():
    found = model('beam = { type = "massless_beam", between = ["ground", "b"], EI = 1, l = 1 }\n')
    assert [n.components for n in found.nodes] == [("y", "theta")]


def test_a_support_at_a_component_holds_that_alone():
    held = frame("m", "ground", "b", '"30 deg"') + 'roller = { type = "fixed", at = "b.y" }\n'
    found = model(held, 'F = { force = "b.x" }', 'X = "b.x"\nN = "roller.f"')
    assert [q for use in found.elements[1:] for q in use.element.quantities(dict(use.domains))] == ["f"]


def test_a_clamp_and_ground_are_the_same():
    wall = 'wall = { type = "fixed", at = "a" }\n'
    assert near(values(wall + frame("m", "a", "b", 0.4)), values(frame("m", "ground", "b", 0.4)))


HEAD = "symflex = 1\n[elements]\n" + frame("m", "ground", "b")
TAIL = '[inputs]\nF = { force = "b.y" }\n[outputs]\nY = "b.y"\n'


def test_a_mass_at_a_node_of_the_plane_says_along_what_it_moves():
    found = problems(f'{HEAD}load = {{ type = "mass", at = "b", m = "1 kg" }}\n{TAIL}')
    hint = "write 'b.x' or 'b.y'; a mass that moves both ways is a rigid_body"
    assert found == [("SF219", "node 'b' moves along x and y; mass 'load' acts on one of them", hint)]


def test_a_force_at_a_node_of_the_plane_says_along_what_it_acts():
    found = problems(HEAD + TAIL.replace('"b.y" }', '"b" }'))
    assert found[0][:2] == ("SF219", "node 'b' moves along x and y; input 'F' acts on one of them")


def test_the_bare_name_of_a_node_of_the_plane_has_no_value():
    found = problems(HEAD + TAIL.replace('Y = "b.y"', 'Y = "b"'))
    assert found == [
        (
            "SF210",
            "unknown name 'b'",
            "a node of the plane has no value of its own; it offers b.x, b.y, b.theta",
        )
    ]


def test_a_torque_needs_no_component():
    assert values(frame("m", "ground", "b"), 'T = { torque = "b" }', 'Q = "b.theta"')


def test_a_member_without_supports_is_moved_as_the_body_it_is():
    """At low frequencies a force at the centre of mass moves m = rho A l: s^2 x = F/m."""
    halves = frame("one", "a", "b", '"30 deg"', "0.1 m") + frame("two", "b", "c", '"30 deg"', "0.1 m")
    found = values(halves, outputs='A = "s^2*b.y"')
    assert abs(found[0] * 2700 * 3e-5 * 0.2 - 1) < 1e-4


def refused(text):
    with pytest.raises(ModelError) as caught:
        pipeline.derive_all(pipeline.loads(text))
    return [(d.code, d.message) for d in caught.value.diagnostics]


def test_a_component_that_is_held_twice_is_explained():
    twice = 'roller = { type = "fixed", at = "b.x" }\npin = { type = "pin", at = "b" }\n'
    tail = TAIL.replace('force = "b.y"', 'torque = "b"').replace('Y = "b.y"', 'Y = "b.theta"')
    assert refused(HEAD + twice + tail) == [
        ("SF302", "the constraints of 'roller' and 'pin' repeat or contradict each other")
    ]


def test_the_slope_of_a_hinge_that_joins_nothing_else_is_explained():
    hinge = 'hinge = { type = "pin", between = ["b", "c"] }\n'
    assert refused(HEAD + hinge + TAIL) == [("SF301", "nothing determines node 'c.theta': it floats")]


def test_an_angle_is_measured_in_radians():
    found = problems(HEAD.replace("angle = 0", 'angle = "3 kg"') + TAIL)
    message = "angle of frame 'm' is in 'kg'; an angle from the x axis is in 'rad'"
    assert [(code, text) for code, text, _ in found] == [("SF203", message)]


@pytest.mark.slow
def test_poles_of_a_portal_that_does_not_stretch_are_those_of_its_dynamic_stiffness():
    # Sway and two turns: the beam moves as a mass besides (Clough & Penzien 1993, chapter 17).
    height, span, stiffness, mass = 3.0, 4.0, 2e6, 50.0

    def end(omega, length):
        """Return the stiffnesses y-y, y-theta, theta-theta of an end, and the last one to the far end."""
        b = (mass * omega**2 / stiffness) ** 0.25
        c, s, ch, sh = (f(b * length) for f in (math.cos, math.sin, math.cosh, math.sinh))
        d = stiffness / (1 - c * ch)
        near = b**3 * (c * sh + s * ch) * d, b**2 * s * sh * d, b * (s * ch - c * sh) * d
        return *near, b * (sh - s) * d

    def determinant(omega):
        yy, yt, tt, _ = end(omega, height)
        _, _, turn, far = end(omega, span)
        sway = 2 * yy - mass * span * omega**2
        return np.linalg.det([[sway, yt, yt], [yt, tt + turn, far], [yt, far, tt + turn]])

    column = 'EI = 2e6, rhoA = 50, l = "h", inextensible = true'
    portal = f"""symflex = 1
parameters = {{ h = "3 m", l = "4 m" }}
inputs.F = {{ force = "b.x" }}
outputs.X = "b.x"
[elements]
foot = {{ type = "fixed", at = "a" }}
other = {{ type = "fixed", at = "d" }}
left = {{ type = "frame", between = ["a", "b"], angle = "90 deg", {column} }}
beam = {{ type = "frame", between = ["b", "c"], EI = 2e6, rhoA = 50, l = "l", inextensible = true }}
right = {{ type = "frame", between = ["c", "d"], angle = "-90 deg", {column} }}
"""
    found = symflex.loads(portal).transfer_functions()[0].bind().pole_zero_map(modes=3)
    assert found.verdict.word == "marginal"
    poles = [abs(float(p.im)) for p in found.poles]
    for omega in poles:
        assert determinant(omega * (1 - 1e-9)) * determinant(omega * (1 + 1e-9)) < 0, omega
