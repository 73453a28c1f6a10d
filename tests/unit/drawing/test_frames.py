"""Frames in their plane, and random models of all kinds."""

import pytest

from symflex import pipeline
from symflex.drawing import drawing_of, render_drawing
from symflex.library.blocks import BLOCKS
from symflex.library.elements import ELEMENTS
from symflex.model.model import INPUT_KINDS
from tests.house.repository import ROOT
from tests.random_models import sound
from tests.unit.drawing.geometry_checks import faults, of_kind, place, wrongly_counted


def test_members_stand_where_their_lengths_and_angles_put_them():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/frames/portal_frame.toml"))
    left, right, beam = (place(drawing, "element", n) for n in ("left", "right", "beam"))
    assert left.height > left.width
    assert beam.width > beam.height
    # A rigid corner: members end where their axes meet.
    assert left.centre[0] == pytest.approx(beam.x0, abs=0.5)
    assert right.centre[0] == pytest.approx(beam.x1, abs=0.5)
    assert beam.centre[1] == pytest.approx(left.y1, abs=0.5)
    assert beam.y1 > left.y1 == pytest.approx(right.y1)
    assert beam.width == pytest.approx(left.height, rel=0.1)


def test_a_slanted_member_is_as_long_as_a_level_one():
    member = 'E = "E", I = 1e-9, A = 1e-4, rho = 7800, l = 0.5'
    text = f"""
symflex = 1
parameters = {{ E = "210 GPa" }}
inputs.F = {{ force = "q.y" }}
outputs.Y = "q.y"
[elements]
level   = {{ type = "frame", between = ["ground", "p"], {member} }}
slanted = {{ type = "frame", between = ["p", "q"], angle = "30 deg", {member} }}
"""
    drawing = drawing_of(pipeline.loads(text))
    level, slanted = (place(drawing, "element", n) for n in ("level", "slanted"))
    thick = level.height  # of both, across their axes
    assert slanted.width == pytest.approx((level.width * 3**0.5 + thick) / 2)
    assert slanted.height == pytest.approx((level.width + thick * 3**0.5) / 2)


def test_x_runs_along_the_members_of_a_frame_from_their_first_nodes():
    drawing = drawing_of(pipeline.load(ROOT / "derivations/frames/portal_frame.toml"))
    posts = [place(drawing, "element", n) for n in ("left", "right")]
    arrows = [i.box for i in of_kind(drawing, "axis")]
    assert len(arrows) >= len(posts)
    for post in posts:
        beside = [a for a in arrows if a.height > a.width and abs(a.x0 - post.x1) < 6]
        assert [a.y0 for a in beside] == [pytest.approx(post.y0, abs=2)]


def test_springs_turn_about_joints_and_a_cart_rolls_below_its_pole():
    member = 'E = "E", I = 1e-9, A = 1e-4, rho = 7800, l = 0.5'
    text = f"""
symflex = 1
parameters = {{ E = "210 GPa", k = "10 N*m/rad", M = "2 kg" }}
inputs.F = {{ force = "c.x" }}
outputs.Y = "tip.y"
[elements]
cart  = {{ type = "mass", at = "c.x", m = "M" }}
rail  = {{ type = "fixed", at = "c.y" }}
hinge = {{ type = "pin", between = ["c", "p"] }}
pole  = {{ type = "frame", between = ["p", "q"], angle = "90 deg", {member} }}
knee  = {{ type = "pin", between = ["q", "r"] }}
coil  = {{ type = "torsion_spring", between = ["q.theta", "r.theta"], k = "k" }}
arm   = {{ type = "frame", between = ["r", "tip"], {member} }}
"""
    drawing = drawing_of(pipeline.loads(text))
    pole, cart, rail, hinge, knee, coil = (
        place(drawing, "element", n) for n in ("pole", "cart", "rail", "hinge", "knee", "coil")
    )
    assert rail.y0 < cart.y0 < cart.y1 == pytest.approx(hinge.centre[1]) == pytest.approx(pole.y0)
    assert [b.centre[0] for b in (cart, rail, hinge)] == pytest.approx([pole.centre[0]] * 3, abs=0.1)
    assert coil.overlaps(knee)
    assert coil.centre == pytest.approx(knee.centre, abs=2)


def test_what_a_frame_shares_with_a_row_beside_it_is_named_in_both():
    text = """
symflex = 1
inputs.V = { voltage = "v" }
outputs.Y = "q.y"
[elements]
post  = { type = "frame", between = ["ground", "q"], E = "70 GPa", I = 1e-9, A = 1e-4, rho = 2700, l = 0.5 }
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "q.theta", k_t = 1 }
"""
    model = pipeline.loads(text)
    drawing = drawing_of(model)
    assert sum((i.kind, i.name) == ("tag", "q") for i in drawing.items) == 2
    assert wrongly_counted(model, drawing) == []


@pytest.mark.parametrize(("first", "count"), [(2, 2), pytest.param(1000, 10, marks=pytest.mark.slow)])
def test_random_models_are_drawn_with_everything_in_its_place(first, count):
    for seed, model in sound(first, count):
        assert faults(model, drawing_of(model)) == [], seed


@pytest.mark.slow
def test_random_models_give_the_same_bytes_twice():
    for seed, model in sound(7000, 3):
        one, other = (render_drawing(drawing_of(model), "svg") for _ in range(2))
        assert one == other, seed


@pytest.mark.slow
def test_random_models_are_of_all_kinds():
    found = [model for _, model in sound(1000, 180)]
    blocks = {b.block.type_name for m in found for b in m.blocks}
    # Heat is in no random model: it is drawn like acoustics, and other tests have its elements.
    heat = {e.type_name for e in ELEMENTS.values() if any(p.domain == "thermal" for p in e.ports)}
    kinds = {kind for kind, law in INPUT_KINDS.items() if law.domain != "thermal"}
    assert {e.element.type_name for m in found for e in m.elements} == set(ELEMENTS) - heat
    assert blocks == set(BLOCKS)
    assert {i.kind for m in found for i in m.inputs} == {"signal", *kinds}
    assert sum(bool(m.fields) for m in found) > 5
