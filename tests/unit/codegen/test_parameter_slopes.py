"""Programs have derivatives in their parameters: those of formulas written by hand, or of differences."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.codegen.program.evaluate import Gradient, evaluate
from symflex.codegen.program.verify import choose_programs
from tests.house.repository import ROOT


def gradient_of(model, tf, names):
    (derived,), _ = pipeline.derive_as(model, [tuple(tf.split("/"))], solves=True)
    (program, _), _ = choose_programs(derived, 20, has_real=False)
    values = {p.name: float(p.value.nearly) for p in model.parameters}
    return Gradient(program, names), values


def test_slopes_of_a_rational_function_are_those_by_hand():
    text = 'symflex = 1\nparameters.m = 2\nparameters.k = 8\ninputs.F = {}\noutputs.X = "F/(m*s^2 + k^2)"'
    gradient, values = gradient_of(pipeline.loads(text), "X/F", ("m", "k"))
    s = 1j * np.linspace(0.5, 6, 9)
    value, slopes = gradient(s, values)
    den = 2 * s**2 + 64
    assert value == pytest.approx(1 / den, rel=1e-12)
    assert slopes[:, 0] == pytest.approx(-(s**2) / den**2, rel=1e-12)
    assert slopes[:, 1] == pytest.approx(-2 * 8 / den**2, rel=1e-12)


@pytest.mark.parametrize(
    ("file", "tf", "names", "band"),
    [
        ("classics/kelvin_voigt_cantilever", "X_tip/F", ("E", "rho", "l", "eta"), (0.05, 400)),
        pytest.param(
            "classics/timoshenko_cantilever", "W_tip/F", ("E", "G", "rho"), (10, 9000), marks=pytest.mark.slow
        ),
        pytest.param("frames/portal_frame", "x/F", ("E", "rho"), (10, 500), marks=pytest.mark.slow),
        pytest.param("tapers/cone", "tip/w_0", ("EI", "rhoA"), (1, 100), marks=pytest.mark.slow),
    ],
)
def test_slopes_with_kernels_are_those_of_differences(file, tf, names, band):
    gradient, values = gradient_of(pipeline.load(ROOT / "derivations" / f"{file}.toml"), tf, names)
    s = 2j * np.pi * np.geomspace(*band, 12)
    value, slopes = gradient(s, values)
    assert value == pytest.approx(evaluate(gradient.program, s, values), rel=1e-12)
    for i, name in enumerate(names):
        h = 1e-4 * values[name]
        ends = [evaluate(gradient.program, s, {**values, name: values[name] + k * h}) for k in (-2, -1, 1, 2)]
        difference = (8 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12 * h)
        assert np.max(np.abs(slopes[:, i] - difference)) < 1e-5 * np.max(np.abs(difference))
