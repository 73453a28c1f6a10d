"""Figures can be read: no text lies over another or leaves the page."""

from __future__ import annotations

import random

import pytest

import symflex
from symflex import pipeline
from symflex.figures import draw, draw_loop
from tests.house.repository import ROOT
from tests.unit.figures.texts import faults

QUICK = ("two_mass", "quarter_car", "lumped_bending_beam_position")
MODELS = sorted(path for path in (ROOT / "derivations").rglob("*.toml") if path.name != "claims.toml")
KINDS = ("bode", "modes", "nyquist", "poles_zeros")
IN_TURN = [
    pytest.param(path, kind, id=f"{path.stem}-{kind}", marks=[] if path.stem in QUICK else pytest.mark.slow)
    for i, path in enumerate(MODELS)
    for j, kind in enumerate(KINDS)
    if path.stem in QUICK or i % 4 == j
]
"""One kind of figure of each model; of the quick ones all."""
LOOPS = [
    pytest.param(path, id=path.stem, marks=[] if path.stem in QUICK else pytest.mark.slow)
    for path in MODELS
    if path.parent.name == "loops"
]


@pytest.fixture(scope="module")
def bound():
    """Functions of a model by its file, derived once."""
    known = {}

    def of(path):
        if path not in known:
            model = pipeline.load(path)
            functions = pipeline.derive_for_roots(model, model.transfer_functions)
            known[path] = [one for one in functions if not one.is_zero]
        return known[path]

    return of


@pytest.mark.parametrize(("path", "kind"), IN_TURN)
def test_texts_of_a_figure_keep_apart(path, kind, bound):
    bounds = bound(path)
    try:
        figure = draw(kind, [one.source for one in bounds], bounds)
    except symflex.SymflexError as error:
        assert kind == "modes"
        # Nothing moves in a model of blocks.
        assert error.diagnostics[0].code == "SF402"
        return
    assert not faults(figure)


@pytest.mark.parametrize("kind", ["locus", "nyquist"])
@pytest.mark.parametrize("path", LOOPS)
def test_texts_of_a_figure_of_a_loop_keep_apart(path, kind):
    assert not faults(draw_loop(kind, pipeline.characteristic_loop(pipeline.load(path), "K")))


def loop(expression, **parameters):
    values = {"K": 1, **parameters}
    return symflex.Model(
        parameters=values,
        signals={"y": f"K*({expression})*(r - y)"},
        inputs={"r": {}},
        outputs={"Y": "y"},
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


@pytest.mark.parametrize(
    "seed", [n if n in (0, 1, 5) else pytest.param(n, marks=pytest.mark.slow) for n in range(20)]
)
def test_numbers_and_names_of_scattered_roots_keep_apart(seed):
    model = symflex.Model(inputs={"u": {}}, outputs=scattered(seed)).resolved
    bounds = [b for b in pipeline.derive_for_roots(model, model.transfer_functions) if not b.is_zero]
    figure = draw("poles_zeros", [b.source for b in bounds], bounds)
    assert not faults(figure)


def test_one_far_pole_does_not_rule_a_locus():
    figure = loop("1/((s + 1)*(s + 2)*(s + 5000))").locus("K", (0, 10))
    (axes,) = figure.axes
    assert axes.get_xlim()[0] > -100
    named = {t.get_text() for t in axes.texts if "5000" in t.get_text()}
    assert named == {r"$\times$ $-5000$", r"$\star$ $-5000$"}


def test_a_locus_marks_the_gain_s_own_value():
    # s^2 + 2 s + K at K = 5: -1 +- 2j
    (axes,) = loop("1/(s*(s + 2))", K=5).locus("K", (0, 10)).axes
    (stars,) = (line for line in axes.get_lines() if line.get_marker() == "*")
    assert sorted(map(complex, *stars.get_data()), key=lambda s: s.imag) == [-1 - 2j, -1 + 2j]


def test_a_locus_beyond_the_gain_s_own_value_marks_none():
    (axes,) = loop("1/(s*(s + 2))", K=5).locus("K", (6, 10)).axes
    assert "*" not in {line.get_marker() for line in axes.get_lines()}


@pytest.mark.parametrize(("expression", "said"), [("1/(s - 1)", "1 pole"), ("1/(s + 1)", "no pole")])
def test_a_nyquist_plot_says_how_many_poles_are_in_the_right_half_plane(expression, said):
    title = loop(expression).nyquist("K").legends[0].get_title().get_text()
    assert title.startswith(f"open loop: {said} in the right half plane")


def test_a_nyquist_plot_reaches_the_origin_beyond_the_model_s_band():
    model = symflex.Model(
        inputs={"u": {}}, outputs={"y": "u/(s + 1)^2"}, analysis={"band": ["0.001 Hz", "0.5 Hz"]}
    )
    (axes,) = model.transfer_function("y", "u").bind().nyquist().axes
    (curve,) = (line for line in axes.get_lines() if line.get_label() == "$y/u$")
    last = complex(curve.get_xdata()[-1], curve.get_ydata()[-1])
    assert abs(last) < 0.002  # of a largest value of 1
