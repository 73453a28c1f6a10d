"""Drawings of networks: what stands where, and that nothing stands on anything else."""

import pytest

from symflex import pipeline
from symflex.drawing import draw_model, drawing_of
from symflex.errors import UsageError
from symflex.figures import render
from tests.unit.drawing.geometry_checks import faults, place

CHAIN = """
symflex = 1
parameters = { m_1 = "60 kg", m_2 = "20 kg", k = "95 kN/m", b = "40 N*s/m" }
inputs.F = { force = "y" }
outputs = { X = "x", V = "s*y", Stroke = "y - x", Pull = "drive.f" }
[elements]
first  = { type = "mass", at = "x", m = "m_1" }
second = { type = "mass", at = "y", m = "m_2" }
wall   = { type = "spring", between = ["ground", "x"], k = "k" }
drive  = { type = "spring", between = ["x", "y"], k = "k" }
loss   = { type = "damper", between = ["x", "y"], b = "b" }
"""
CIRCUIT = """
symflex = 1
parameters = { R = "1 ohm", L = "1 mH", C = "1 uF", k = "0.1 N*m/A", J = "1e-4 kg*m^2", n = "0.2" }
inputs.V = { voltage = "v" }
outputs = { Psi = "psi", I = "motor.i" }
[elements]
choke = { type = "inductor", between = ["v", "w"], L = "L" }
store = { type = "capacitor", between = ["w", "ground"], C = "C" }
motor = { type = "dc_motor", terminals = ["w", "ground"], shaft = "phi", R = "R", k_t = "k" }
rotor = { type = "inertia", at = "phi", J = "J" }
gear  = { type = "transformer", from = "phi", to = "psi", ratio = "n" }
load  = { type = "inertia", at = "psi", J = "J" }
drag  = { type = "rotary_damper", between = ["phi", "ground"], b = "1e-3 N*m*s/rad" }
"""
BEAM = """
symflex = 1
parameters = { E = "70 GPa", I = "1e-9 m^4", rho = 2700, A = 1e-4, l = "0.8 m", m = "1 kg", k = "1 N/m" }
inputs.F = { force = "a" }
outputs = { Y = "b", Middle = "bar.y(l/2)" }
[elements]
guide = { type = "slider", at = "a" }
bar   = { type = "beam", between = ["a", "b"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
load  = { type = "mass", at = "b", m = "m" }
bed   = { type = "spring", between = ["b", "ground"], k = "k" }
"""
RING = """
symflex = 1
inputs = { F = { force = "y" }, z_0 = { force = ["x", "z"] } }
outputs.X = "x"
[elements]
a = { type = "mass", at = "x", m = "1 kg" }
b = { type = "mass", at = "y", m = "1 kg" }
c = { type = "mass", at = "z", m = "1 kg" }
d = { type = "mass", at = "z", m = "2 kg" }
ab = { type = "spring", between = ["x", "y"], k = "1 N/m" }
bc = { type = "spring", between = ["y", "z"], k = "2 N/m" }
ca = { type = "spring", between = ["z", "x"], k = "3 N/m" }
hold = { type = "damper", between = ["y", "ground"], b = "1 N*s/m" }
"""
MODELS = {"chain": CHAIN, "circuit": CIRCUIT, "beam": BEAM, "ring": RING}


def read(text):
    return pipeline.loads(text)


@pytest.mark.slow
def test_no_symbol_or_text_stands_on_another():
    for values in (False, True):
        for name, text in MODELS.items():
            model = read(text)
            assert faults(model, drawing_of(model, values=values)) == [], (values, name)


def test_a_chain_runs_from_the_ground_to_its_tip():
    drawing = drawing_of(read(CHAIN))
    wall, first, drive, second = (place(drawing, "element", n) for n in ("wall", "first", "drive", "second"))
    assert wall.x1 <= first.x0 < first.x1 <= drive.x0 < drive.x1 <= second.x0
    assert place(drawing, "input", "F").x0 >= second.x1


def test_parallel_branches_stand_side_by_side():
    drawing = drawing_of(read(CHAIN))
    drive, loss = (place(drawing, "element", n) for n in ("drive", "loss"))
    assert drive.x0 < loss.x1
    assert loss.x0 < drive.x1
    assert loss.y1 < drive.y0


def test_a_motor_stands_between_its_circuit_and_its_shaft():
    drawing = drawing_of(read(CIRCUIT))
    order = [place(drawing, "element", n).x0 for n in ("choke", "motor", "rotor", "gear", "load")]
    assert order == sorted(order)


def test_a_point_of_a_beam_is_marked_where_it_is():
    drawing = drawing_of(read(BEAM))
    bar, middle = place(drawing, "element", "bar"), place(drawing, "output", "Middle")
    assert (middle.x0 + middle.x1) / 2 == pytest.approx((bar.x0 + bar.x1) / 2)


def test_what_closes_a_ring_runs_above_it():
    drawing = drawing_of(read(RING))
    first, between, last = sorted((place(drawing, "element", n) for n in ("a", "b", "c")), key=lambda b: b.x0)
    springs = [place(drawing, "element", n) for n in ("ab", "bc", "ca")]
    assert sum(s.y0 > between.y1 for s in springs) == 1
    assert all(first.x1 < s.x1 < last.x1 for s in springs)


def test_equal_models_give_equal_bytes():
    for format in ("svg", "pgf"):
        one, other = (render(draw_model(read(BEAM)), format) for _ in range(2))
        assert one == other, format


def test_a_drawing_is_as_wide_as_asked_for():
    assert draw_model(read(CHAIN), width_mm=120).get_figwidth() * 25.4 == pytest.approx(120)


def test_a_width_without_room_is_refused_with_the_width_it_takes():
    kinds = (("spring", "k"), ("damper", "b"))  # in turn: no chain of equal links
    links = "".join(
        f'm{i} = {{ type = "mass", at = "x{i}", m = {i + 1} }}\n'
        f'l{i} = {{ type = "{kind}", between = ["x{i}", "x{i + 1}"], {key} = {i + 1} }}\n'
        for i in range(20)
        for kind, key in (kinds[i % 2],)
    )
    text = f'symflex = 1\n[elements]\n{links}\n[inputs]\nF = {{ force = "x0" }}\n[outputs]\nX = "x20"\n'
    with pytest.raises(UsageError, match=r"SF902.*does not fit into 88.5 mm"):
        drawing_of(read(text), width_mm=88.5)


def test_values_stand_below_names_with_the_units_they_were_written_in():
    drawing = drawing_of(read(CHAIN), values=True)
    texts = {t.markup for i in drawing.items if i.name == "wall" for t in i.texts}
    assert texts == {"$k$", r"$95\,\mathrm{kN/m}$"}


def test_a_follower_is_fed_back_round_its_amplifier():
    drawn = drawing_of(
        pipeline.loads("""
symflex = 1
elements.o = { type = "op_amp", inputs = ["p", "o"], out = "o" }
inputs.V = { voltage = "p" }
outputs.U = "o"
""")
    ).items
    triangle = next(i.strokes[0] for i in drawn if i.kind == "element" and i.name == "o")
    left = min(x for x, _ in triangle.points)
    ends = [s.points[-1] for i in drawn if i.kind == "wire" and i.name == "o" for s in i.strokes]
    # One for each input, apart from each other.
    assert len({round(y, 1) for x, y in ends if abs(x - left) < 0.1}) == 2


def test_wires_of_a_gear_lead_to_the_shafts_of_its_discs():
    drawn = drawing_of(
        pipeline.loads("""
symflex = 1
inputs.T = { torque = "s1" }
outputs.C = "c"
[elements]
a = { type = "inertia", at = "s1", J = 1 }
b = { type = "inertia", at = "c", J = 2 }
d = { type = "inertia", at = "r", J = 3 }
g = { type = "planetary_gear", sun = "s1", ring = "r", carrier = "c", rho = 2.5 }
""")
    ).items
    wires = [s.points for i in drawn if i.kind == "wire" and i.name == "g" for s in i.strokes]
    discs = [i.box for i in drawn if i.kind == "element" and i.name in ("a", "b", "d")]
    ends = [points[-1] for points in wires]
    # At half the height of each disc, to the left of it, where its shaft begins.
    for disc in discs:
        assert any(abs(y - disc.centre[1]) < 0.1 and 0 <= disc.x0 - x < 12 for x, y in ends)
