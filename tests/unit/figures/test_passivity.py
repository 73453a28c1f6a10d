"""The figure of a real part: the curve, and the bands in which it is negative."""

from math import pi, sqrt

import pytest

from symflex.contact.passivity import driving_function
from symflex.figures import draw
from tests.unit.contact.machines import machine


def test_the_active_band_is_shaded():
    # Re Z = b - K tau/(1 + (omega tau)^2) is negative up to sqrt(K tau/b - 1)/tau.
    figure = draw("passivity", [driving_function(machine(K="40 N/m"), "tip")])
    (axes,) = figure.axes
    (shade,) = axes.patches
    assert shade.get_x() + shade.get_width() == pytest.approx(sqrt(40 * 0.05 - 1) / 0.05 / (2 * pi))
    (curve,) = (line for line in axes.lines if len(line.get_xdata()) > 2)
    x, y = curve.get_xdata(), curve.get_ydata()
    s = 2j * pi * x[len(x) // 2]
    expected = (0.05 * s**2 + s) / ((s**2 + s) * (0.05 * s + 1) + 40)
    assert y[len(x) // 2] == pytest.approx(expected.real)
