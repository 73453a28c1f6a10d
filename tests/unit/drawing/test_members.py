"""Members that taper, lengths, coordinates, rollers, and what a specification says of its drawing."""

import pytest

import symflex
from symflex import pipeline
from symflex.drawing import drawing_of
from symflex.drawing.symbols import TRANSFORMER_SYMBOLS
from symflex.model import model as model_layer
from tests.house.repository import ROOT
from tests.unit.drawing.geometry_checks import count, faults, of_kind, overlaps

TAPERED = """
symflex = 1
parameters = { E = "70 GPa", rho = 2700, l = "0.8 m", c = 0.75, h = "40 mm", m = "1 kg" }
definitions = { I_0 = "h^4/12", A_0 = "h^2" }
elements.load = { type = "mass", at = "tip", m = "m" }
inputs  = { F = { force = "tip" } }
outputs = { Y = "tip" }
[elements.arm]
type = "beam"
between = ["ground", "tip"]
E = "E"
rho = "rho"
l = "l"
"""
UNIFORM = 'I = "I_0"\nA = "A_0"\n'
SQUARE = 'I = "I_0*(1 - c*x/l)^4"\nA = "A_0*(1 - c*x/l)^2"\n'
FIELD = """
symflex = 1
parameters = { EI = { unit = "N*m^2" }, rhoA = "1 kg/m", l = "1 m" }
[fields.w]
domain     = ["0", "l"]
equation   = "(EI*(1 - x/(2*l))^4*w'')'' + rhoA*(1 - x/(2*l))^2*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "(EI*(1 - x/(2*l))^4*w'')'(l) = -F"]
[inputs]
F = { unit = "N" }
[outputs]
Y = "w(l)"
"""
LINKED = """
symflex = 1
parameters = { m = "1 kg", J = "1 kg*m^2", c = "0.1 m", h = "0.2 m" }
[elements]
body = { type = "rigid_body", at = "p", m = "m", J = "J", cg = "c" }
link = { type = "rigid_link", between = ["p", "q"], length = "h" }
end  = { type = "rigid_body", at = "q", m = "m", J = "J", cg = "-c" }
lone = { type = "mass", at = "x", m = "m" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""
FREE = """
symflex = 1
[elements]
a = { type = "mass", at = "x", m = "1 kg" }
b = { type = "mass", at = "y", m = "1 kg" }
k = { type = "spring", between = ["x", "y"], k = "1 N/m" }
[inputs]
F = { force = "x" }
[outputs]
Y = "y"
"""
TURNING = """
symflex = 1
[elements]
rotor  = { type = "inertia", at = "phi", J = "1 kg*m^2" }
pinion = { type = "transformer", from = "phi", to = "x", ratio = "3 mm/rad" }
car    = { type = "mass", at = "x", m = "1 kg" }
[inputs]
T = { torque = "phi" }
[outputs]
X = "x"
"""


ARM_AND_LOAD = (("element", "arm"), ("element", "load"))


def sound(text):
    model = pipeline.loads(text)
    drawing = drawing_of(model)
    assert faults(model, drawing) == []
    return drawing


def item(drawing, kind, name):
    return next(i for i in drawing.items if (i.kind, i.name) == (kind, name))


def depths(drawing, kind, name):
    """Return the depth of a member at its left and right end."""
    points = item(drawing, kind, name).strokes[0].points
    left, right = min(x for x, _ in points), max(x for x, _ in points)
    heights = ([y for x, y in points if x == pytest.approx(end)] for end in (left, right))
    return [max(ys) - min(ys) for ys in heights]


def markups(drawing):
    return [t.markup for i in drawing.items for t in i.texts]


def test_a_beam_is_drawn_as_thick_as_a_square_one_of_its_section():
    """The side of a square whose second moment is (1 - c x/l)^4 I_0: a quarter is left where c = 0.75.

    If a beam loses width alone, I/A is the same everywhere, and so is its depth: a quarter of its width is
    left.
    """
    width_alone = 'I = "I_0*(1 - c*x/l)"\nA = "A_0*(1 - c*x/l)"\n'
    for section, left in ((SQUARE, 0.25), (width_alone, 0.25), (UNIFORM, 1)):
        thick, thin = depths(sound(TAPERED + section), "element", "arm")
        assert thin / thick == pytest.approx(left), section


def test_a_string_whose_tension_varies_is_a_line():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/tapers/hanging_string.toml"))
    assert depths(drawing, "field", "w") == pytest.approx([0.0, 0.0])


def test_a_field_of_second_order_with_a_modulus_or_torsion_is_as_thick_as_a_beam():
    for stiffness, unit, mass in (("E*A", "GPa", "kg/m"), ("GJ", "N*m^2", "kg*m")):
        name = stiffness.partition("*")[0]
        drawing = drawing_of(
            symflex.Model(
                parameters={name: f"2 {unit}", "A": "1 cm^2", "l": "1 m", "mu": f"1 {mass}"},
                fields={
                    "u": {
                        "domain": ["0", "l"],
                        "equation": f"{stiffness}*u'' = mu*s^2*u",
                        "conditions": ["u(0) = 0", "u'(l) = p"],
                    }
                },
                inputs={"p": {}},
                outputs={"tip": "u(l)"},
            ).resolved
        )
        assert all(depth > 1.0 for depth in depths(drawing, "field", "u")), (stiffness, unit, mass)


def test_a_cone_is_drawn_straight_to_its_tip_and_its_driven_root_in_a_guide():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/tapers/cone.toml"))
    points = item(drawing, "field", "w").strokes[0].points
    upper = points[: len(points) // 2]
    (x0, y0), (xm, ym) = upper[0], upper[len(upper) // 2]
    axis = (max(y for _, y in points) + min(y for _, y in points)) / 2
    assert (ym - axis) / (y0 - axis) == pytest.approx(1 - (xm - x0) / (upper[-1][0] - x0))
    assert count(drawing, "ground", "w") == 1


def test_a_field_is_drawn_by_its_radius_of_gyration():
    drawing = sound(FIELD)
    thick, thin = depths(drawing, "field", "w")
    assert thin / thick == pytest.approx(0.5)
    assert any(
        "\N{DOUBLE PRIME}" in t and "[1 - x/(2 l)]^{4}" in t for t in markups(drawing)
    )  # as it is written


def test_a_field_with_an_equation_without_derivatives_is_drawn():
    follows = 'unknowns = ["w", "q"]\nequations = ["q = rhoA*(1 - x/l)*s^2*w", "EI*w\'\'\'\' + q = 0"]\n'
    text = FIELD.replace("(EI*(1 - x/(2*l))^4*w'')'(l) = -F", "EI*w'''(l) = -F")
    lines = [follows if line.startswith("equation") else f"{line}\n" for line in text.splitlines()]
    thick, thin = depths(sound("".join(lines)), "field", "w")
    assert thick == thin


def test_the_length_of_a_link_runs_from_node_to_node_and_mass_centres_lie_beside_these():
    drawing = sound(LINKED)
    length, left, right = (
        item(drawing, *n).box for n in (("length", "link"), ("element", "body"), ("element", "end"))
    )
    assert length.x0 == pytest.approx((left.x0 + left.x1) / 2)
    assert length.x1 == pytest.approx((right.x0 + right.x1) / 2)
    for name, sign in (("body", 1), ("end", -1)):
        body = item(drawing, "element", name)
        circle = body.strokes[-3].points  # before its cross
        offset = sum(x for x, _ in circle) / len(circle) - (body.box.x0 + body.box.x1) / 2
        assert offset * sign > 5, name
    assert "$c$" in markups(drawing)


def test_the_length_of_a_beam_is_a_dimension_and_stands_in_its_label_no_more():
    text = TAPERED.replace("elements.load", "elements.hub = { type = 'pin', at = 'a' }\nelements.load")
    drawing = sound(text.replace('"ground"', '"a"') + UNIFORM)
    length, arm, load = (item(drawing, *n).box for n in (("length", "arm"), *ARM_AND_LOAD))
    assert (length.x0, length.x1) == (pytest.approx(arm.x0), pytest.approx((load.x0 + load.x1) / 2))
    assert length.y0 > arm.y1
    labels = [t.markup for i in of_kind(drawing, "label") if i.name == "arm" for t in i.texts]
    assert sum("l" in label.replace(r"\rho", "") for label in labels) == 1


def test_parallel_beams_keep_their_lengths_in_their_labels():
    beams = "".join(
        f'{n} = {{ type = "massless_beam", between = ["a", "b"], EI = "B", l = "l" }}\n'
        for n in ("one", "two")
    )
    drawing = sound(
        f'symflex = 1\nparameters = {{ B = "1 N*m^2", l = "1 m" }}\n[elements]\n{beams}'
        'hold = { type = "fixed", at = "a" }\n[inputs]\nF = { force = "b" }\n[outputs]\nY = "b"\n'
    )
    assert of_kind(drawing, "length") == ()
    assert markups(drawing).count(r"$B,\,l$") == 2


def test_beams_in_line_share_one_coordinate_where_x_runs_on():
    for second, arrows in (('["q", "r"]', 1), ('["r", "q"]', 2)):
        section = "E = 1, I = 1, rho = 1, A = 1, l = 1"
        drawing = sound(
            f'symflex = 1\n[elements]\na = {{ type = "beam", between = ["p", "q"], {section} }}\n'
            f'b = {{ type = "beam", between = {second}, {section} }}\n'
            '[inputs]\nF = { force = "p" }\n[outputs]\nY = "r"\n'
        )
        assert count(drawing, "axis", "x") == arrows, (second, arrows)


def test_what_hangs_where_a_beam_begins_leaves_room_for_its_coordinate():
    drawing = sound(
        'symflex = 1\n[elements]\nk = { type = "spring", between = ["p", "ground"], k = 1 }\n'
        'a = { type = "beam", between = ["p", "q"], E = 1, I = 1, rho = 1, A = 1, l = 1 }\n'
        '[inputs]\nF = { force = "p" }\n[outputs]\nY = "q"\n'
    )
    beam, axis, spring = (item(drawing, *n).box for n in (("element", "a"), ("axis", "x"), ("element", "k")))
    assert spring.y0 < axis.y0 < axis.y1 < beam.y0
    assert beam.y0 - axis.y1 < axis.height + 2
    assert axis.x0 == pytest.approx(beam.x0)


def test_a_support_is_called_what_its_latex_says():
    for kind in ("pin", "slider", "fixed"):
        text = TAPERED + 'I = "I_0"\nA = "A_0"\n[elements.held]\ntype = "' + kind + '"\nat = "end"\n'
        text = text.replace('"ground", "tip"', '"end", "tip"')
        assert r"${\text{bearing}}$" in markups(sound(text + "latex = '\\text{bearing}'\n")), kind
        assert not [t for i in of_kind(sound(text), "label") if i.name == "held" for t in i.texts], kind


def test_an_element_is_called_what_its_latex_says_besides_its_parameters():
    text = FREE.replace('m = "1 kg" }\nb', "m = \"1 kg\", latex = '\\text{motor}' }\nb")
    box = item(sound(text), "label", "a")
    assert [t.markup for t in box.texts] == [r"$1\,\mathrm{kg}$", r"${\text{motor}}$"]


def test_x_begins_at_the_first_node_of_a_beam():
    text = TAPERED.replace('["ground", "tip"]', '["tip", "ground"]') + SQUARE
    for case, sign in ((TAPERED + SQUARE, 1), (text, -1)):
        drawing = sound(case)
        arm, axis = item(drawing, "element", "arm").box, item(drawing, "axis", "x").box
        start = arm.x0 if sign > 0 else arm.x1
        assert (axis.x0 if sign > 0 else axis.x1) == pytest.approx(start)


def test_free_masses_stand_on_rollers_unless_the_specification_wants_it_otherwise():
    held = f'{FREE}[elements.wall]\ntype = "damper"\nbetween = ["x", "ground"]\nb = "1 N*s/m"\n'
    no, yes = "[drawing]\nrollers = false\n", "[drawing]\nrollers = true\n"
    for text, grounds in ((FREE, 2), (FREE + no, 0), (held, 1), (held + yes, 3)):
        assert len(of_kind(sound(text), "ground")) == grounds, text


def test_nodes_stand_in_the_order_that_the_specification_wants():
    for order in (["x", "y"], ["y", "x"]):
        drawing = sound(f"{FREE}[drawing]\norder = {order}\n")
        places = {n: item(drawing, "element", e).box.x0 for n, e in (("x", "a"), ("y", "b"))}
        assert sorted(places, key=places.get) == order


def test_a_transformer_is_drawn_with_the_symbol_that_the_specification_wants():
    assert tuple(TRANSFORMER_SYMBOLS) == model_layer.TRANSFORMER_SYMBOLS
    chosen = f"{TURNING}[drawing.symbols]\npinion = "
    drawn = {name: item(sound(f'{chosen}"{name}"\n'), "element", "pinion") for name in TRANSFORMER_SYMBOLS}
    assert item(sound(TURNING), "element", "pinion") == drawn["rack"] != drawn["screw"]
    per_turn = sound(TURNING.replace("3 mm/rad", "3 mm/rev"))
    assert len(item(per_turn, "element", "pinion").strokes) == len(drawn["screw"].strokes)


def test_values_of_members_and_fields_stand_once_below():
    for text in (TAPERED + SQUARE, FIELD):
        drawing = drawing_of(pipeline.loads(text), values=True)
        assert count(drawing, "values", "") == 1
        assert sum(r"l = " in t for t in markups(drawing)) == 1


def test_values_stand_in_gains_and_blocks():
    text = FREE.replace('F = { force = "x" }', "r = {}").replace("[inputs]", SIGNALS)
    drawing = drawing_of(pipeline.loads(text), values=True)
    assert {r"$3\,\mathrm{N/m}$", r"$T = 2\,\mathrm{ms}$"} <= set(markups(drawing))
    assert not overlaps(drawing)


SIGNALS = """
[parameters]
K = "3 N/m"
T = "2 ms"
[blocks]
G = { type = "lag", T = "T" }
[signals]
f = "K*G*(r - x)"
[elements.drive]
type = "force_source"
at = "x"
f = "f"
[inputs]"""


STRING = """
symflex = 1
[elements]
left  = { type = "string", between = ["ground", "p"], N = "9 N", rho = 7800, A = 1e-6, l = "0.4 m" }
right = { type = "string", between = ["p", "ground"], N = "9 N", rho = 7800, A = 1e-6, l = "0.6 m" }
bead  = { type = "mass", at = "p", m = "1 g" }
[inputs]
F = { force = "p" }
[outputs]
Y = "p"
"""


def test_a_bead_on_a_string_moves_across_it_between_two_walls():
    drawing = sound(STRING)
    left, bead, right = (item(drawing, "element", n).box for n in ("left", "bead", "right"))
    assert left.x1 <= bead.x0 < bead.x1 <= right.x0
    for arrow in (item(drawing, "input", "F").box, item(drawing, "output", "Y").box):
        assert arrow.height > arrow.width


def test_members_are_drawn_in_line_and_what_hangs_on_them_bridges():
    beam = 'type = "beam", E = "70 GPa", I = 1e-9, rho = 2700, A = 1e-4, l = 1'
    drawing = sound(
        f"""
symflex = 1
[elements]
a = {{ {beam}, between = ["p", "q"] }}
b = {{ {beam}, between = ["q", "r"] }}
k = {{ type = "spring", between = ["q", "z"], k = 1 }}
m = {{ type = "mass", at = "z", m = 1 }}
[inputs]
F = {{ force = "q" }}
[outputs]
Y = "q"
"""
    )
    a, b, spring = (item(drawing, "element", n).box for n in "abk")
    assert a.centre[1] == pytest.approx(b.centre[1])
    assert spring.y0 > a.y1


def test_a_value_written_in_place_keeps_the_unit_it_was_written_in():
    drawing = sound(TURNING.replace("3 mm/rad", "5 mm/rev").replace('m = "1 kg"', 'm = "2 t"'))
    assert {r"$5\,\mathrm{mm/rev}$", r"$2\,\mathrm{t}$"} <= set(markups(drawing))


def test_an_input_that_is_all_of_a_source_is_named_there():
    push = 'push = { type = "force_source", at = "x", f = "u" }\n[inputs]\nu = {}'
    drawing = sound(TURNING.replace("[inputs]", push))
    name, arrow = (item(drawing, *n).box for n in (("input", "u"), ("element", "push")))
    assert abs(name.centre[0] - arrow.centre[0]) < 30  # points


def test_a_ring_is_a_chain_with_one_spring_above_it():
    lines = [
        f'm_{i} = {{ type = "mass", at = "x_{i}", m = 1 }}\n'
        f'k_{i} = {{ type = "spring", between = ["x_{i}", "x_{(i + 1) % 6}"], k = 1 }}'
        for i in range(6)
    ]
    ends = '[inputs]\nF = { force = "x_0" }\n[outputs]\nX = "x_3"\n'
    drawing = sound("\n".join(("symflex = 1\n[elements]", *lines, ends)))
    springs = [item(drawing, "element", f"k_{i}").box.centre[1] for i in range(6)]
    assert sum(y > item(drawing, "element", "m_0").box.y1 for y in springs) == 1


def test_a_car_stands_on_its_road_and_a_row_whose_labels_would_cross_stays_level():
    text = (ROOT / "derivations/classics/quarter_car.toml").read_text()
    stop = 'stop = { type = "spring", between = ["body", "axle"], k = "7 kN/m" }\ntyre  '
    third = text.replace("tyre  ", stop).replace('b = "c_s"', 'b = "1500 N*s/m"')
    for specification, is_upright in ((text, True), (text.replace("up = true", ""), False), (third, False)):
        drawing = drawing_of(pipeline.loads(specification))
        boxes = {i.name: i.box for i in drawing.items if i.kind == "element" and i.strokes}
        places = [boxes[name].centre[is_upright] for name in ("tyre", "axle", "body")]
        assert places == sorted(places), specification
        assert len({round(boxes[name].centre[not is_upright]) for name in ("axle", "body")}) == 1
        assert not overlaps(drawing)
