"""Figures can be read: no text lies over another or leaves the page."""

import random

import numpy as np
import pytest

import symflex
from symflex import pipeline
from symflex.figures import LOOP_FIGURES, draw
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
    for kind in LOOP_FIGURES:
        assert not faults(draw(kind, characteristic_loop(model, "K"))), kind


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


def test_a_locus_notes_the_gain_and_frequency_at_which_poles_cross_the_axis():
    # s^3 + 3 s^2 + 2 s + K: Routh's array has a zero row at K = 6, where s^2 = -2.
    (axes,) = loop("1/(s*(s + 1)*(s + 2))").locus("K", (0, 20)).axes
    assert "$K = 6$, 0.2251 Hz" in [text.get_text() for text in axes.texts]


def test_a_nichols_chart_shows_phase_and_level_and_passes_beside_its_critical_points():
    (axes,) = loop("1/(s*(s + 1))", K=1).nichols("K").axes
    (curve,) = (line for line in axes.lines if line.get_label().startswith("loop gain"))
    phases, levels = (np.asarray(data, float) for data in curve.get_data())
    # At 1 rad/s |L| is 1/sqrt(2), and the phase -135 degrees.
    assert np.interp(-135, phases[::-1], levels[::-1]) == pytest.approx(-10 * np.log10(2), abs=0.01)
    assert {float(x) for line in axes.lines if line.get_marker() == "+" for x in line.get_xdata()} >= {-180.0}


def test_a_sensitivity_marks_its_peak_where_a_grid_has_its_largest_value():
    (axes,) = loop("1/(s*(s + 1)*(s + 2))").sensitivity_plot("K").axes
    marks = [(line.get_xdata()[0], line.get_ydata()[0]) for line in axes.lines if line.get_marker() == "o"]
    s = 1j * np.linspace(0.01, 5, 200_001)
    gain = 1 / (s * (s + 1) * (s + 2))
    for (frequency, level), size in zip(marks, (abs(1 / (1 + gain)), abs(gain / (1 + gain))), strict=True):
        assert frequency == pytest.approx(abs(s[size.argmax()]) / (2 * np.pi), rel=1e-3)
        assert level == pytest.approx(20 * np.log10(size.max()), abs=1e-6)


def test_roots_near_the_origin_of_a_wide_plane_have_an_inset():
    expression = "1/((s + 2)*(s^2 + 2*s + 4)*(s^2 + 20*s + 10000))"
    panel = loop(expression).transfer_function("Y", "r").bind().pole_zero_plot().axes[0]
    (inset,) = panel.child_axes
    assert -10 < inset.get_xlim()[0] < inset.get_xlim()[1] < 10


def test_a_locus_beyond_the_gain_s_own_value_marks_none():
    (axes,) = loop("1/(s*(s + 2))", K=5).locus("K", (6, 10)).axes
    assert "*" not in {line.get_marker() for line in axes.get_lines()}


def test_a_nyquist_plot_says_how_many_poles_are_in_the_right_half_plane():
    for expression, label in (("1/(s - 1)", ", $P = 1$"), ("1/(s + 1)", "")):
        (legend,) = loop(expression).nyquist("K").legends
        assert legend.get_texts()[0].get_text() == f"loop gain, $K = 1${label}"


def test_a_nyquist_plot_reaches_the_origin_beyond_the_model_s_band():
    model = symflex.Model(
        inputs={"u": {}}, outputs={"y": "u/(s + 1)^2"}, analysis={"band": ["0.001 Hz", "0.5 Hz"]}
    )
    (axes,) = model.transfer_function("y", "u").bind().nyquist().axes
    (curve,) = (line for line in axes.get_lines() if line.get_label() == "$y/u$")
    last = complex(curve.get_xdata()[-1], curve.get_ydata()[-1])
    assert abs(last) < 0.002  # of a largest value of 1
