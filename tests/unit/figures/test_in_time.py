"""Figures of responses in time."""

from fractions import Fraction

import numpy as np
import pytest

from symflex import loads, pipeline
from symflex.errors import SpecError
from symflex.figures import AxisLimits, draw

LOOP = """
symflex = 1
parameters = { K = "3 1/s", T = "0.5 s" }
blocks  = { D = { type = "delay", T = "T" } }
inputs  = { r = {} }
signals = { y = "K/s*D*(r - y)" }
outputs = { Y = "y", E = "r - y" }
"""


def drawn(kind, frame=None):
    loop = loads(LOOP)
    bounds = [loop.transfer_function(name, "r").bind().bound for name in ("Y", "E")]
    return draw(kind, bounds, frame=frame or AxisLimits())


def test_a_step_figure_has_a_curve_a_function_up_to_the_time_asked_for():
    (axes,) = drawn("step", AxisLimits(x=(0.0, 2.0))).axes
    curves = [line for line in axes.lines if len(line.get_xdata()) > 2]
    assert [curve.get_xdata()[-1] for curve in curves] == [2.0, 2.0]
    t, y = curves[0].get_data()
    # Before the second echo, at t = 1, the response is 3 (t - 1/2).
    assert np.allclose(y[t <= 1], np.maximum(3 * (t[t <= 1] - 0.5), 0), atol=1e-6)


def test_outputs_of_other_units_have_a_panel_of_their_own():
    model = loads(LOOP.replace('E = "r - y"', 'E = "s*y"').replace("r = {}", 'r = { unit = "m" }'))
    bounds = [model.transfer_function(name, "r").bind().bound for name in ("Y", "E")]
    top, bottom = draw("step", bounds, frame=AxisLimits(x=(0.0, 1.0))).axes
    assert ("m}" in top.get_ylabel(), "m/s}" in bottom.get_ylabel()) == (True, True)
    for axes, value in ((top, lambda t: 3 * (t - 0.5)), (bottom, lambda t: 3 + 0 * t)):
        (curve,) = [line for line in axes.lines if len(line.get_xdata()) > 2]
        t, y = curve.get_data()
        assert np.allclose(y[(t > 0.501) & (t < 0.999)], value(t[(t > 0.501) & (t < 0.999)]), atol=1e-6)


def test_a_step_of_a_network_in_nested_form_is_drawn():
    model = loads(
        'symflex = 1\nparameters = { m = "1 kg", k = "1 N/m" }\ninputs.F = { force = "x" }\noutputs.X = "x"\n'
        'elements.a = { type = "mass", at = "x", m = "m" }\n'
        'elements.b = { type = "spring", between = ["x", "ground"], k = "k" }'
    )
    (axes,) = draw("step", [model.nested("X", "F").bind().bound], frame=AxisLimits(x=(0.0, 7.0))).axes
    (curve,) = [line for line in axes.lines if len(line.get_xdata()) > 2]
    t, x = curve.get_data()
    assert np.allclose(x, 1 - np.cos(t), atol=1e-6)


def test_an_impulse_that_is_not_drawn_is_said():
    figure = drawn("impulse", AxisLimits(x=(0.0, 2.0)))
    assert "E/r: it also has impulses, which are not drawn" in figure.get_suptitle()


def test_the_time_shown_is_read_from_the_specification():
    text = LOOP + 'figures.a = { kind = "step", until = "20 ms", of = ["Y/r"] }'
    assert pipeline.loads(text).figures[0].until == Fraction(1, 50)


def test_a_time_that_is_none_is_refused():
    for figure, code in (
        ('{ kind = "bode", until = "1 s" }', "SF207"),
        ('{ kind = "step", until = "1 kg" }', "SF203"),
        ('{ kind = "step", until = "-1 s" }', "SF227"),
        ('{ kind = "step", until = 0 }', "SF227"),
    ):
        with pytest.raises(SpecError, match=code):
            loads(f"{LOOP}figures.a = {figure}")
