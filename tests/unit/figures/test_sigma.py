"""Singular values in a figure."""

import numpy as np
import pytest

from tests.unit.analysis.norms.models import two_masses


def test_each_singular_value_has_its_curve():
    figure = two_masses().transfer_matrix().bind().sigma_plot(band=(0.5, 5))
    curves = figure.axes[0].get_lines()
    assert [
        text.get_text() for text in figure.axes[0].get_legend().get_texts() or figure.legends[0].get_texts()
    ] == [
        r"$\sigma_{1}$",
        r"$\sigma_{2}$",
    ]
    # At 0.5 Hz both modes are static but for a few per cent: 1/(100 - pi^2), 1/(300 - pi^2).
    levels = [10 ** (curve.get_ydata()[0] / 20) for curve in curves]
    assert levels == pytest.approx([1 / (100 - np.pi**2), 1 / (300 - np.pi**2)], rel=1e-3)
