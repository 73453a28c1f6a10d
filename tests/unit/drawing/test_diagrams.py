"""Drawings of signals, blocks and fields, and of every worked model."""

import functools
from itertools import pairwise

import pytest

import symflex
from symflex import pipeline
from symflex.drawing import drawing_of, render_drawing
from symflex.drawing.diagram import statements
from symflex.drawing.lettering import Labels
from symflex.drawing.signals import SignalGraph
from symflex.drawing.symbols import SYMBOLS
from symflex.library.elements import ELEMENTS
from tests.house.repository import ROOT
from tests.unit.drawing.geometry_checks import count, faults, of_kind, place

LOOP = """
symflex = 1
parameters = { m = "2 kg", K = "300 N/m", T = "1 ms", T_d = "2 ms" }
[blocks]
G = { type = "lag", T = "T" }
D = { type = "delay", T = "T_d" }
[signals]
e = "r - D*x - n"
f = "K*G*e"
[elements]
car   = { type = "mass", at = "x", m = "m" }
drive = { type = "force_source", at = "x", f = "f" }
[inputs]
r = {}
n = {}
[outputs]
X = "x"
Error = "e"
Both = "r + 2*x"
"""
TWO_SPANS = """
symflex = 1
parameters = { EI = { unit = "N*m^2" }, rhoA = { unit = "kg/m" }, l = "1 m", x_F = "0.4 m" }
inputs.F = { unit = "N" }
outputs = { Y = "w_2(l/2)", Slope = "w_2'(l)" }
[fields.w_1]
domain     = ["0", "x_F"]
equation   = "EI*w_1'''' + rhoA*s^2*w_1 = 0"
conditions = ["w_1(0) = 0", "w_1'(0) = 0"]
[fields.w_2]
domain     = ["x_F", "l"]
equation   = "EI*w_2'''' + rhoA*s^2*w_2 = 0"
conditions = ["w_2(x_F) = w_1(x_F)", "w_2'(x_F) = w_1'(x_F)", "w_2''(x_F) = w_1''(x_F)",
              "EI*(w_2'''(x_F) - w_1'''(x_F)) = F", "w_2(l) = 0", "w_2''(l) = 0"]
"""


WORKED = (
    "classics/quarter_car",
    "classics/shaft_discs",
    "eppinger1988/lumped_bending_beam",
    "eppinger1988/robot_axis",
    "eppinger1988/loops/sliding_free_beam_force",
    "frames/two_link_arm",
    "tapers/turning_blade",
    "tapers/conical_horn",
)
"""Masses, shafts, rigid bodies and links, a motor, a loop, a frame, members and fields that taper."""


@functools.cache
def loop_drawing():
    return drawing_of(pipeline.loads(LOOP))


@pytest.mark.slow
def test_worked_models_are_drawn_with_everything_in_its_place():
    for name in WORKED:
        model = pipeline.load(ROOT / f"derivations/{name}.toml")
        drawing = drawing_of(model)
        assert faults(model, drawing) == [], name
        assert drawing.width == pytest.approx(88.5 / 25.4 * 72), name


def test_every_element_has_a_symbol():
    assert set(ELEMENTS) == set(SYMBOLS)


@pytest.mark.slow
def test_a_loop_runs_from_its_input_and_closes_below():
    model, drawing = pipeline.loads(LOOP), loop_drawing()
    assert faults(model, drawing) == []
    command, box, fed_back = (place(drawing, *n) for n in (("input", "r"), ("block", "G"), ("block", "D")))
    assert command.x1 < box.x0
    assert fed_back.y1 < box.y0


def test_short_transfer_functions_are_printed_in_their_blocks():
    drawing = loop_drawing()
    texts = {t.markup for i in drawing.items if i.name in ("G", "D") for t in i.texts}
    assert texts >= {r"$\frac{1}{1 + T s}$", r"$\mathrm{e}^{-s T_{d}}$"}


def test_what_a_signal_reads_is_marked_where_it_is():
    drawing = loop_drawing()
    assert count(drawing, "reading", "x") == 1
    assert count(drawing, "tag", "x") == 2


def test_a_loop_is_joined_to_what_it_reads_and_where_it_acts():
    drawing = loop_drawing()
    read, driven = (next(i for i in drawing.items if (i.kind, i.name) == ("join", n)) for n in ("x", "drive"))
    car, tag, arrow = (place(drawing, *n) for n in (("element", "car"), ("tag", "x"), ("element", "drive")))
    for wire, start, end in ((read, car, tag), (driven, place(drawing, "end", "f"), arrow)):
        first, last = wire.strokes[0].points[0], wire.strokes[1].points[0]
        for box, (x, y) in ((start, first), (end, last)):
            assert box.grown(1.6).x0 <= x <= box.grown(1.6).x1
            assert box.grown(1.6).y0 <= y <= box.grown(1.6).y1


def test_what_is_measured_comes_back_from_beyond_the_end_of_the_path():
    """So a wire to it crosses no line of the path."""
    drawing = drawing_of(pipeline.load(ROOT / "derivations/eppinger1988/loops/rigid_body_position.toml"))
    tag, end, driven = (place(drawing, *n) for n in (("tag", "x"), ("end", "F_act"), ("input", "X_cmd")))
    assert tag.x1 == pytest.approx(end.x1, abs=2)
    wires = [s for i in of_kind(drawing, "join") for s in i.strokes if s.is_dashed]
    for (ax, ay), (bx, by) in (pair for wire in wires for pair in pairwise(wire.points)):
        level = (end.y0 + end.y1) / 2
        assert not (ax == bx and min(ay, by) < level < max(ay, by) and driven.x1 < ax < end.x1)


def test_a_node_that_a_guide_holds_is_joined_to_what_reads_it():
    drawing = drawing_of(
        pipeline.load(ROOT / "derivations/eppinger1988/loops/sliding_free_beam_position.toml")
    )
    assert count(drawing, "join", "act") == 1


def test_a_long_diagram_goes_on_below_its_beginning():
    count = 14
    blocks = "".join(f'G_{i} = {{ type = "lag", T = "{i + 1} ms" }}\n' for i in range(count))
    loop = f'y = "{"*".join(f"G_{i}" for i in range(count))}*(r - 2*y)"\n'
    model = pipeline.loads(
        f'symflex = 1\n[blocks]\n{blocks}[signals]\n{loop}[inputs]\nr = {{}}\n[outputs]\nY = "y"\n'
    )
    drawing = drawing_of(model)
    assert faults(model, drawing) == []
    assert drawing.width == pytest.approx(88.5 / 25.4 * 72)
    first, last = (place(drawing, "block", f"G_{i}") for i in (0, count - 1))
    assert abs(first.y0 - last.y0) > 2 * first.height
    assert {t.size for i in drawing.items for t in i.texts} == {7.0, 8.0}  # nothing made smaller


def test_fields_that_follow_each_other_are_drawn_end_to_end_with_supports():
    model = pipeline.loads(TWO_SPANS)
    drawing = drawing_of(model)
    assert faults(model, drawing) == []
    first, second, force = (place(drawing, *n) for n in (("field", "w_1"), ("field", "w_2"), ("input", "F")))
    assert first.x1 == pytest.approx(second.x0)
    assert (force.x0 + force.x1) / 2 == pytest.approx(first.x1)
    assert first.width / second.width == pytest.approx(0.4 / 0.6)
    # Zero deflection and slope are a clamp; zero deflection and moment a hinge; at a joint there is none.
    clamp, hinge = (place(drawing, "ground", n) for n in ("w_1", "w_2"))
    assert clamp.height > clamp.width
    assert hinge.y1 < second.y1


def test_texts_of_an_svg_are_texts_and_parts_bear_their_names():
    drawing = loop_drawing()
    svg = render_drawing(drawing, "svg").decode()
    assert "<title>element car</title>" in svg
    assert "<title>block G</title>" in svg
    assert ">K</tspan>" in svg
    assert svg == render_drawing(drawing, "svg").decode()


@pytest.mark.slow
def test_a_notebook_shows_the_drawing_of_a_model():
    shown = symflex.loads(LOOP)._repr_html_()
    assert "<title>element car</title>" in shown
    assert "<style" not in shown


DISTURBED = """
symflex = 1
[signals]
e = "r - H*y"
u = "C*e"
y = "G*D*(u + d)"
[blocks]
C = { type = "pid", k_p = 3, k_i = "2 1/s" }
G = { type = "lag", T = "0.1 s" }
D = { type = "delay", T = "1 s" }
H = { type = "lag", T = "20 ms" }
[inputs]
d = {}
r = {}
[outputs]
Y = "y"
"""


def test_a_loop_of_signals_begins_at_its_command_and_is_closed_on_a_page():
    model = pipeline.loads(DISTURBED)
    drawing = drawing_of(model)
    assert faults(model, drawing) == []
    boxes = [place(drawing, *n) for n in (("input", "r"), ("block", "C"), ("block", "G"), ("block", "D"))]
    assert all(a.x1 < b.x0 for a, b in pairwise(boxes))
    assert count(drawing, "tag", "y") == 0  # no name stands for a wire
    assert place(drawing, "block", "H").y1 < boxes[1].y0


def test_the_force_that_an_imposed_motion_takes_is_an_arrow_of_its_own():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/classics/quarter_car.toml"))
    force, tyre = place(drawing, "output", "F_road"), place(drawing, "element", "tyre")
    assert force.y1 <= tyre.y0
    assert force.x0 < (tyre.x0 + tyre.x1) / 2 < force.x1
    assert not force.overlaps(place(drawing, "input", "z_road"))


def test_a_wedge_ends_in_a_point():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/tapers/wedge.toml"))
    (outline,) = next(i.strokes for i in of_kind(drawing, "field"))
    tip = max(x for x, _ in outline.points)
    assert len({round(y, 6) for x, y in outline.points if x == tip}) == 1


def test_a_force_at_a_wall_is_written_there():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/classics/rod_tip_mass.toml"))
    bar, force = place(drawing, "element", "bar"), place(drawing, "output", "F_wall")
    assert abs(force.centre[0] - bar.x0) < bar.width / 8  # the wall is to the left


def test_the_distance_of_two_shaft_ends_is_measured_from_these():
    member = 'G = "1 GPa", J = "1 m^4", rho = "1 kg/m^3", l = "1 m"'
    text = f"""
symflex = 1
elements.shaft = {{ type = "shaft", between = ["p", "q"], {member} }}
inputs.T = {{ torque = "p" }}
outputs = {{ D = "q - p", P = "p" }}
"""
    drawing = drawing_of(pipeline.loads(text))
    leads = [i.strokes[0].points for i in of_kind(drawing, "wire") if i.name == "D"]
    assert all(len({round(x, 6) for x, _ in points}) == 1 for points in leads)


@pytest.mark.slow
def test_what_is_read_twice_has_one_wire_that_branches():
    text = f'{LOOP}Other = "n + 3*x"\n'
    drawing = drawing_of(pipeline.loads(text))
    stem, *branches = (i.strokes for i in of_kind(drawing, "join") if i.name == "x")
    assert len(branches) == count(drawing, "tag", "x") - 1 == 2
    for x, y in (strokes[0].points[0] for strokes in branches):
        sides = pairwise(stem[0].points)
        assert any(
            min(a[0], b[0]) <= x <= max(a[0], b[0]) and min(a[1], b[1]) <= y <= max(a[1], b[1])
            for a, b in sides
        )


def test_a_delay_written_in_a_signal_is_drawn_as_it_is_written():
    model = pipeline.loads("""symflex = 1
parameters = { T = {}, T_1 = {} }
signals.y = "exp(-s*T)/(T_1*s + 1)*(r - y)"
inputs.r = {}
outputs.Y = "y"
""")
    (signal,) = model.signals
    shown = Labels(model).expression(signal.expression)
    assert r"\mathrm{e}^{-s T}" in shown
    assert "delay" not in shown
    assert not statements(SignalGraph(model, Labels(model), ["r"]))  # nor is it explained below the drawing
