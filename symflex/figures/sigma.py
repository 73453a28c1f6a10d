"""A transfer matrix over frequency: its singular values, its relative gains, its characteristic loci."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import tau
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symflex.analysis.response import adaptive_grid, default_band, roots_if_found
from symflex.errors import refused
from symflex.figures.axes import (
    Canvas,
    add_legend_above,
    draw_zero_lines,
    label_magnitudes,
    root_figure,
    set_frequency_axis,
    set_magnitude_ticks,
    write_title,
)
from symflex.figures.style import COLOURS, COLUMN_INCHES, LINE_INCHES, QUIET, title_lines
from symflex.matrices.transfer_matrix import followed, relative_gains
from symflex.model import Input, Output
from symflex.roots import Band
from symflex.transfer import AnyBoundFunction

HEIGHT_INCHES: Final = 2.4
MOST_LINES: Final = 16  # of relative gains in one figure: a matrix of four by four
Complex = npt.NDArray[np.complex128]
Drawn = Callable[[Axes, npt.NDArray[np.float64], Complex], int]  # what draws values, and says how many lines


def draw_sigma(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw all singular values of the matrix that functions make; pairs that are not given are zero."""

    def draw(axes: Axes, omega: npt.NDArray[np.float64], matrix: Complex) -> int:
        with np.errstate(divide="ignore"):
            levels = 20 * np.log10(singular_values(matrix))
        for k, level in enumerate(levels):
            shown = np.where(np.isfinite(level), level, np.nan)
            label = rf"$\sigma_{{{k + 1}}}$"
            axes.plot(omega / tau, shown, color=COLOURS[k % len(COLOURS)], label=label)
        _over_frequency(axes, omega, canvas)
        set_magnitude_ticks(axes)
        units = {b.source.unit for b in bounds}
        label_magnitudes(axes, units.pop() if len(units) == 1 else "")
        return len(levels)

    return _draw(bounds, canvas, draw)


def draw_relative_gains(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the magnitudes of all relative gains (Bristol 1966) of a square matrix; SF902 for others."""

    def draw(axes: Axes, omega: npt.NDArray[np.float64], matrix: Complex) -> int:
        gains = np.abs(relative_gains(matrix))
        size = len(gains)
        if size**2 > MOST_LINES:
            raise refused(f"a figure has no room for {size**2} relative gains", "choose a few with --tf")
        for k, gain in enumerate(gains.reshape(size**2, -1)):
            style = ("-", "--", ":", "-.")[k // len(COLOURS) % 4]
            label = rf"$\lambda_{{{k // size + 1}{k % size + 1}}}$"
            axes.plot(omega / tau, gain, style, color=COLOURS[k % len(COLOURS)], label=label)
        _over_frequency(axes, omega, canvas)
        axes.set_ylabel("relative gain")
        return int(size**2)

    return _draw(bounds, canvas, draw)


def draw_loci(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the characteristic loci of a square matrix of open loops, with the point -1; SF902 for others.

    Dashed are negative frequencies. All of them together encircle -1 as often as det(I + L) does 0.
    """

    def draw(axes: Axes, _: npt.NDArray[np.float64], matrix: Complex) -> int:
        loci = followed(np.moveaxis(matrix, -1, 0))
        for k, locus in enumerate(loci):
            colour, label = COLOURS[k % len(COLOURS)], rf"$\lambda_{{{k + 1}}}$"
            axes.plot(locus.real, locus.imag, color=colour, label=label)
            axes.plot(locus.real, -locus.imag, "--", color=colour, linewidth=0.7)
        draw_zero_lines(axes)
        axes.plot(-1, 0, "+", color=QUIET, markersize=8)
        axes.set_xlabel("real part")
        axes.set_ylabel("imaginary part")
        for limits, own in ((axes.set_xlim, canvas.frame.x), (axes.set_ylim, canvas.frame.y)):
            if own:
                limits(*own)
        return len(loci)

    return _draw(bounds, canvas, draw)


def _draw(bounds: Sequence[AnyBoundFunction], canvas: Canvas, draw: Drawn) -> Figure:
    """Draw what the values of a matrix on a grid that follows its roots have, in one panel."""
    given = canvas.band_of(bounds[0].source.model)
    low, high = given or default_band(*filter(None, map(roots_if_found, bounds)))
    band = Band(Fraction(low), Fraction(high))
    omega = np.unique(
        np.concatenate([adaptive_grid(b, low, high, roots=roots_if_found(b, band)) for b in bounds])
    )
    matrix = values_of(bounds, omega)
    width = canvas.width or COLUMN_INCHES
    lines = title_lines(canvas.title, width) if canvas.title else []
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    count = draw(axes, omega, matrix)
    add_legend_above(axes, count, "\n".join(lines) if canvas.axes and lines else None)
    figure = root_figure(axes)
    if not canvas.axes:
        write_title(figure, lines)
    return figure


def _over_frequency(axes: Axes, omega: npt.NDArray[np.float64], canvas: Canvas) -> None:
    if canvas.frame.y:
        axes.set_ylim(*canvas.frame.y)
    set_frequency_axis(axes, omega[0] / tau, omega[-1] / tau)


def ends_of(bounds: Sequence[AnyBoundFunction]) -> tuple[list[Output], list[Input]]:
    """Return the outputs and inputs of functions, once each, in order."""
    outputs = {b.source.output.name: b.source.output for b in bounds}
    inputs = {b.source.input.name: b.source.input for b in bounds}
    return list(outputs.values()), list(inputs.values())


def values_of(bounds: Sequence[AnyBoundFunction], omega: npt.NDArray[np.float64]) -> Complex:
    """Return the matrix at frequencies [rad/s]: (outputs, inputs, frequencies)."""
    outputs, inputs = ([end.name for end in ends] for ends in ends_of(bounds))
    matrix = np.zeros((len(outputs), len(inputs), omega.size), dtype=complex)
    for b in bounds:
        place = outputs.index(b.source.output.name), inputs.index(b.source.input.name)
        matrix[place] = b.each((1j * omega).tolist())
    return matrix


def singular_values(matrix: Complex) -> npt.NDArray[np.float64]:
    """Return singular values of matrices (rows, columns, points), the largest first: (how many, points)."""
    stacked = np.moveaxis(matrix, -1, 0)
    is_known = np.isfinite(stacked).all(axis=(1, 2))
    values = np.full((min(matrix.shape[:2]), matrix.shape[2]), np.nan)
    values[:, is_known] = np.linalg.svd(stacked[is_known], compute_uv=False).T
    return values
