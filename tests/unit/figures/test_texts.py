"""Figures can be read: no text lies over another or leaves the page."""

import random

import pytest

import symflex
from symflex import pipeline
from symflex.figures import draw, draw_loop
from symflex.loops.of_model import characteristic_loop
from tests.house.repository import ROOT
from tests.unit.figures.texts import faults

MODELS = ROOT / "derivations"


def bounds_of(model):
    """Return the functions of a model that have a figure."""
    return [one for one in pipeline.derive_for_roots(model, model.transfer_functions) if not one.is_zero]


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("classics/quarter_car", ["bode", "poles_zeros"]),
        pytest.param("classics/quarter_car", ["modes", "nyquist"], marks=pytest.mark.slow),
        # six functions
        pytest.param(
            "eppinger1988/loops/lumped_bending_beam_position", ["bode", "poles_zeros"], marks=pytest.mark.slow
        ),
        pytest.param("eppinger1988/sliding_free_beam", ["modes", "poles_zeros"], marks=pytest.mark.slow),
        pytest.param("frames/portal_frame", ["modes"], marks=pytest.mark.slow),
    ],
)
def test_texts_of_a_figure_keep_apart(name, kinds):
    bounds = bounds_of(pipeline.load(MODELS / f"{name}.toml"))
    for kind in kinds:
        assert not faults(draw(kind, bounds)), kind


@pytest.mark.slow
def test_texts_of_a_figure_of_a_loop_keep_apart():
    model = pipeline.load(MODELS / "eppinger1988/loops/lumped_bending_beam_position.toml")
    for kind in ("locus", "nyquist"):
        assert not faults(draw_loop(kind, characteristic_loop(model, "K"))), kind


def loop(expression, **parameters):
    values = {"K": 1, **parameters}
    return symflex.Model(
        parameters=values, signals={"y": f"K*({expression})*(r - y)"}, inputs={"r": {}}, outputs={"Y": "y"}
    )


def scattered(seed):
    """Return one to five functions whose roots, some multiple, reach over five decades."""
    draws = random.Random(seed)
    size = 10 ** draws.uniform(-1, 5)

    def roots(most):
        found = ["1"]
        for _ in range(draws.randint(0, most)):
            w = size * 10 ** draws.choice([0, 0, draws.uniform(-0.5, 0.5), draws.uniform(-2, 3)])
            pair = f"(s^2 + {2 * draws.choice([0, 0, 0.02, 0.3]) * w:.4g}*s + {w * w:.6g})"
            one = draws.choice([pair, pair, pair, f"(s {draws.choice('++-')} {w:.4g})", "s"])
            found.append(f"{one}^{draws.choice([1, 1, 2, 3])}")
        return "*".join(found)

    below = roots(5)
    return {f"y_{i}": f"u*{roots(4)}/({below})" for i in range(draws.randint(1, 5))}


def crowded(seeds):
    """Return the seeds of figures of scattered roots whose texts do not keep apart."""
    found = {}
    for seed in seeds:
        bounds = bounds_of(symflex.Model(inputs={"u": {}}, outputs=scattered(seed)).resolved)
        found[seed] = faults(draw("poles_zeros", bounds))
    return {seed: said for seed, said in found.items() if said}


@pytest.mark.slow
def test_numbers_and_names_of_scattered_roots_keep_apart():
    assert crowded((0, 1, 5)) == {}


@pytest.mark.slow
def test_numbers_and_names_of_more_scattered_roots_keep_apart():
    assert crowded((2, 3, 4, *range(6, 12))) == {}


@pytest.mark.slow
def test_one_far_pole_does_not_rule_a_locus():
    figure = loop("1/((s + 1)*(s + 2)*(s + 5000))").locus("K", (0, 10))
    (axes,) = figure.axes
    assert axes.get_xlim()[0] > -100
    named = {t.get_text() for t in axes.texts if "5000" in t.get_text()}
    assert named == {r"$\times$ $-5000$", r"$\star$ $-5000$"}


@pytest.mark.slow
def test_a_locus_marks_the_gain_s_own_value():
    # s^2 + 2 s + K at K = 5: -1 +- 2j
    (axes,) = loop("1/(s*(s + 2))", K=5).locus("K", (0, 10)).axes
    (stars,) = (line for line in axes.get_lines() if line.get_marker() == "*")
    assert sorted(map(complex, *stars.get_data()), key=lambda s: s.imag) == [-1 - 2j, -1 + 2j]


def test_a_locus_beyond_the_gain_s_own_value_marks_none():
    (axes,) = loop("1/(s*(s + 2))", K=5).locus("K", (6, 10)).axes
    assert "*" not in {line.get_marker() for line in axes.get_lines()}


def test_a_nyquist_plot_says_how_many_poles_are_in_the_right_half_plane():
    for expression, said in (("1/(s - 1)", "1 pole"), ("1/(s + 1)", "no pole")):
        title = loop(expression).nyquist("K").legends[0].get_title().get_text()
        assert title.startswith(f"open loop: {said} in the right half plane"), (expression, said)


def test_a_nyquist_plot_reaches_the_origin_beyond_the_model_s_band():
    model = symflex.Model(
        inputs={"u": {}}, outputs={"y": "u/(s + 1)^2"}, analysis={"band": ["0.001 Hz", "0.5 Hz"]}
    )
    (axes,) = model.transfer_function("y", "u").bind().nyquist().axes
    (curve,) = (line for line in axes.get_lines() if line.get_label() == "$y/u$")
    last = complex(curve.get_xdata()[-1], curve.get_ydata()[-1])
    assert abs(last) < 0.002  # of a largest value of 1
