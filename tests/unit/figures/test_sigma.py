"""Figures of matrices: singular values, relative gains, characteristic loci, poles and zeros."""

import numpy as np
import pytest

import symflex
from symflex.errors import UsageError
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


def rosenbrock():
    outputs = {"y": "u/(s + 1) + 2*v/(s + 3)", "z": "u/(s + 1) + v/(s + 1)"}
    return symflex.Model(inputs={"u": {}, "v": {}}, outputs=outputs).transfer_matrix().bind()


def test_each_relative_gain_has_its_curve():
    # By hand at s = 0: G = [1, 2/3; 1, 1], so that the first gain is 1/(1 - 2/3).
    curves = rosenbrock().rga_plot(band=(1e-5, 1)).axes[0].get_lines()
    assert [curve.get_ydata()[0] for curve in curves] == pytest.approx([3, 2, 2, 3], rel=1e-4)


def test_characteristic_loci_begin_at_the_eigenvalues_at_rest():
    # By hand: (1 - x)^2 = 2/3. Dashed are the loci of negative frequencies.
    lines = rosenbrock().nyquist_plot(band=(1e-5, 1)).axes[0].get_lines()
    loci = [line for line in lines if line.get_label().startswith("$")]
    ends = sorted(line.get_xdata()[0] for line in loci)
    assert ends == pytest.approx([1 - np.sqrt(2 / 3), 1 + np.sqrt(2 / 3)], rel=1e-4)
    dashed = [line for line in lines if line.get_linestyle() == "--"]
    assert np.array_equal(dashed[0].get_ydata(), -loci[0].get_ydata())


def test_poles_and_zeros_are_those_of_the_matrix():
    # By hand: det G = (1 - s)/((s + 1)^2 (s + 3)); no entry has a zero.
    figure = rosenbrock().poles_zeros_plot()
    (axes,) = figure.axes
    marks = {line.get_marker(): line.get_xdata() for line in axes.get_lines() if line.get_marker() in "ox"}
    assert sorted(marks["x"]) == pytest.approx([-3, -1]) and list(marks["o"]) == pytest.approx([1])


def test_figures_of_square_matrices_refuse_others():
    tall = symflex.Model(inputs={"u": {}}, outputs={"y": "u/(s + 1)", "z": "u"}).transfer_matrix().bind()
    for draw in (tall.rga_plot, tall.nyquist_plot):
        with pytest.raises(UsageError, match="SF902"):
            draw(band=(0.1, 1))
