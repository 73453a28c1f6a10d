from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.optimize import brentq

from symflex import pipeline
from symflex.analysis.modes import lowest_modes
from symflex.errors import ModelError, UsageError
from symflex.figures import draw, render
from symflex.figures.modes import heading, label_of_value
from symflex.figures.runs import Run, Stems, panels_of

ROOT = Path(__file__).parents[3]
EPPINGER, CLASSICS = ROOT / "derivations" / "eppinger1988", ROOT / "derivations" / "classics"
BAR = 'E = "1 Pa", rho = "1 kg/m^3", A = "1 m^2"'
BEAM = f'{BAR}, I = "1 m^4"'


def model_of(elements, source="x"):
    return pipeline.loads(
        f'symflex = 1\n[elements]\n{elements}\n[inputs]\nF = {{ force = "{source}" }}\n'
        f'[outputs]\nX = "{source}"\n'
    )


def drawn(model, modes=3):
    model = replace(model, analysis=replace(model.analysis, modes=modes))
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    return draw("modes", [bound])


def panels(model, modes=2):
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    return panels_of(bound.source.model, [found.shape for found in lowest_modes(bound, modes)[0]])


def test_there_is_a_row_per_mode_with_its_frequency_and_damping():
    figure = drawn(pipeline.load(EPPINGER / "six_mass.toml"), modes=2)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles == [r"$11.00$ Hz, $\zeta = 0.0149$", r"$38.01$ Hz, $\zeta = 0.0149$"]


def test_shapes_of_a_frame_stand_two_in_a_row_in_one_scale_and_above_its_supports():
    figure = drawn(pipeline.load(ROOT / "derivations" / "frames" / "pin_ended_cross.toml"), modes=3)
    places = [axes.get_position(original=True) for axes in figure.axes]
    assert places[0].y0 == places[1].y0 > places[2].y0 and places[0].x0 == places[2].x0 < places[1].x0
    assert len({(axes.get_xlim(), axes.get_ylim()) for axes in figure.axes}) == 1
    # Each end is pinned: a triangle of four points with its corner at the end, 5 m from the middle.
    corners = {
        tuple(np.round(line.get_xydata()[0], 6))
        for line in figure.axes[0].lines
        if len(line.get_xdata()) == 4
    }
    assert len(corners) == 4
    assert np.ptp([x for x, _ in corners]) == np.ptp([y for _, y in corners]) == pytest.approx(10)


@pytest.mark.slow
def test_hidden_modes_are_drawn_in_their_place_and_as_many_as_the_analysis_says():
    model = pipeline.load(CLASSICS / "clamped_clamped.toml")
    assert model.analysis.modes == 3
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    titles = [axes.get_title(loc="left") for axes in draw("modes", [bound]).axes]
    assert titles == ["$51.88$ Hz", "$143.0$ Hz", "$280.4$ Hz"]


@pytest.mark.slow
def test_the_curve_is_the_displacement_along_the_beam():
    axes = drawn(pipeline.load(CLASSICS / "pinned_pinned.toml")).axes[1]
    x, y = axes.lines[1].get_data()
    assert y == pytest.approx(np.sin(2 * np.pi * np.asarray(x)), abs=1e-9)


@pytest.mark.slow
def test_the_curve_of_a_high_mode_has_no_corners():
    axes = drawn(pipeline.load(CLASSICS / "pinned_pinned.toml"), modes=8).axes[7]
    line = axes.lines[1]
    inches = line.get_transform().transform(line.get_xydata()) / axes.figure.dpi
    directions = np.unwrap(np.arctan2(*np.diff(inches, axis=0).T[::-1]))
    assert np.degrees(np.abs(np.diff(directions))).max() < 10


@pytest.mark.slow
def test_the_curve_of_a_member_that_tapers_is_its_displacement():
    model = pipeline.loads("""
        symflex = 1
        parameters = { A_0 = "1 m^2", l = "1 m" }
        [elements.cone]
        type = "rod"
        between = ["ground", "x"]
        E = "1 Pa"
        rho = "1 kg/m^3"
        l = "l"
        A = "A_0*(2 - x/l)^2"
        [inputs]
        F = { force = "x" }
        [outputs]
        X = "x"
        """)
    x, y = map(np.asarray, drawn(model, modes=3).axes[2].lines[1].get_data())
    # (2 - x) u obeys the equation of a uniform rod, and u' vanishes at the free end.
    k = brentq(lambda k: np.sin(k) + k * np.cos(k), 7.9, 8.1)
    expected = np.sin(k * x) / (2 - x)
    largest = expected[np.argmax(np.abs(expected))]
    assert y * np.sign(y[-1]) == pytest.approx(expected / largest * np.sign(expected[-1] / largest), abs=2e-4)


@pytest.mark.slow
def test_nodes_with_inertia_at_the_ends_are_marked():
    axes = drawn(pipeline.load(CLASSICS / "kelvin_voigt_cantilever.toml")).axes[0]
    marks = [line for line in axes.lines if line.get_marker() == "o"]
    assert [tuple(map(float, mark.get_xydata()[0])) for mark in marks] == [pytest.approx((0, 1))]


def test_a_link_driven_by_a_motor_has_a_panel_each():
    model = model_of(
        'rotor = { type = "inertia", at = "shaft", J = "1 kg*m^2" }\n'
        'screw = { type = "transformer", from = "shaft", to = "x_act", ratio = "1 m/rad" }\n'
        'slide = { type = "mass", at = "x_act", m = "1 kg" }\n'
        f'link = {{ type = "rod", between = ["x_act", "x_tip"], {BAR}, l = "1 m" }}\n'
        'tool = { type = "mass", at = "x_tip", m = "1 kg" }',
        "x_tip",
    )
    run, stems = panels(model)
    assert [segment.name for segment in run.segments] == ["link"]
    assert [node for node, _ in run.loaded] == ["x_act", "x_tip"]
    assert stems == Stems(("shaft",), "rad")


DAMPED = """
m = { type = "mass", at = "x", m = "1 kg" }
k = { type = "spring", between = ["x", "ground"], k = "1 N/m" }
b = { type = "damper", between = ["x", "ground"], b = "3 N*s/m" }
"""
COUPLED = """
n = { type = "mass", at = "y", m = "1 kg" }
c = { type = "spring", between = ["x", "y"], k = "1 N/m" }
"""


def test_what_lags_is_drawn_apart_and_explained():
    figure = drawn(model_of(DAMPED.replace("3 N", "0.5 N") + COUPLED, "y"), modes=2)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["in phase", "in quadrature"]
    assert not drawn(pipeline.load(EPPINGER / "six_mass.toml"), modes=2).legends


def test_a_real_pole_is_named_by_its_place():
    # s^2 + 3 s + 1 = 0
    (bound,) = pipeline.derive_bound(model := model_of(DAMPED), model.transfer_functions[:1])
    assert heading(lowest_modes(bound, 1)[0][0].shape) == "$s = -0.3820$ rad/s"


def test_what_never_moves_is_left_out():
    stems = panels(pipeline.load(EPPINGER / "lumped_bending_beam.toml"))
    assert [s.names for s in stems] == [("act.y", "joint.y", "tip.y"), ("joint.theta", "tip.theta")]


def test_beams_that_go_on_are_laid_end_to_end():
    model = model_of(
        f'b = {{ type = "beam", between = ["m", "x"], {BEAM}, l = "0.5 m" }}\n'
        f'a = {{ type = "beam", between = ["ground", "m"], {BEAM}, l = "1 m" }}'
    )
    (run,) = panels(model)
    assert [(s.name, s.offset) for s in run.segments] == [("a", 0.0), ("b", 1.0)]
    assert run.ends == (0.0, 1.0, 1.5)


def test_a_folded_beam_has_an_axis_of_its_own():
    model = model_of(
        f'a = {{ type = "beam", between = ["ground", "m"], {BEAM}, l = "1 m" }}\n'
        f'b = {{ type = "beam", between = ["x", "m"], {BEAM}, l = "0.5 m" }}'
    )
    assert [[s.name for s in run.segments] for run in panels(model)] == [["a"], ["b"]]


def test_a_rod_may_be_walked_backwards():
    model = model_of(
        f'a = {{ type = "rod", between = ["ground", "m"], {BAR}, l = "1 m" }}\n'
        f'b = {{ type = "rod", between = ["x", "m"], {BAR}, l = "0.5 m" }}'
    )
    (run,) = panels(model)
    assert [(s.name, s.is_reversed) for s in run.segments] == [("a", False), ("b", True)]
    # Quarter waves of a rod of 1.5 m: sin(pi x/3).
    axes = drawn(model, modes=1).axes[0]
    for line in axes.lines[2:]:
        x, y = map(np.asarray, line.get_data())
        assert y == pytest.approx(np.sin(np.pi * x / 3), abs=1e-9)


def test_where_rods_branch_each_has_an_axis():
    rods = [
        f'r_{i} = {{ type = "rod", between = ["{a}", "{b}"], {BAR}, l = "{i} m" }}'
        for i, (a, b) in enumerate([("ground", "x"), ("x", "p"), ("x", "q")], 1)
    ]
    found = panels(model_of("\n".join(rods)))
    assert all(isinstance(panel, Run) for panel in found)
    assert len(found) == 3


def test_fields_on_adjoining_domains_share_an_axis():
    model = pipeline.loads("""
    symflex = 1
    [parameters]
    h = "0.7 m"
    l = "2 m"
    [fields.u]
    domain     = ["0", "h"]
    equation   = "u'' = s^2*u/100"
    conditions = ["u(0) = 0", "u(h) = v(h)"]
    [fields.v]
    domain     = ["h", "l"]
    equation   = "v'' = s^2*v/25"
    conditions = ["4*u'(h) = v'(h)", "v'(l) = F"]
    [inputs]
    F = {}
    [outputs]
    X = "v(l)"
    """)
    (run,) = panels(model)
    assert run.ends == pytest.approx((0, 0.7, 2))
    assert run.unit == "m"


@pytest.mark.slow
def test_a_long_chain_is_drawn_without_names():
    elements = "\n".join(
        f'm_{i} = {{ type = "mass", at = "x_{i}", m = "1 kg" }}\n'
        f'k_{i} = {{ type = "spring", between = ["x_{i}", "x_{i + 1}"], k = "1 N/m" }}'
        for i in range(20)
    )
    model = model_of(f'{elements}\nend = {{ type = "mass", at = "x_20", m = "1 kg" }}', "x_0")
    figure = drawn(model, modes=2)
    assert figure.axes[-1].get_xlabel() == "node"
    assert render(figure, "pdf").startswith(b"%PDF")


def test_a_model_without_modes_has_nothing_to_draw():
    with pytest.raises(ModelError, match=r"SF402.*no mode other than at 0"):
        drawn(model_of('a = { type = "mass", at = "x", m = "1 kg" }'))


def test_numbers_keep_four_digits():
    for value, label in (
        (0, "0"),
        (-51.6712, "-51.67"),
        (99999.0, "99999"),
        (3e7, r"3.000\cdot 10^{7}"),
        (2.5e-8, r"2.500\cdot 10^{-8}"),
    ):
        assert label_of_value(value, 4) == label, (value, label)


def test_a_gif_holds_one_period_of_every_mode(tmp_path):
    spring = 'k = { type = "spring", between = ["ground", "x"], k = "1 N/m" }'
    figure = drawn(model_of(f'a = {{ type = "mass", at = "x", m = "1 kg" }}\n{spring}'))
    figure.savefig(tmp_path / "modes.gif")
    with Image.open(tmp_path / "modes.gif") as animation:
        assert (animation.n_frames, animation.info["loop"]) == (30, 0)
        crest = animation.convert("L").tobytes()
        animation.seek(15)
        assert animation.convert("L").tobytes() != crest
    artist, place = figure.moving[-1]
    place(0.6 + 0.8j)
    assert list(artist.get_ydata()) == pytest.approx([0.6])
    assert figure.axes[0].get_title(loc="left") == "$0.1592$ Hz"


def test_only_what_moves_becomes_a_gif():
    model = pipeline.load(EPPINGER / "six_mass.toml")
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    with pytest.raises(UsageError, match="only shapes move"):
        render(draw("bode", [bound]), "gif")
