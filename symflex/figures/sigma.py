"""Singular values of a transfer matrix over frequency: what it makes of its best and worst directions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import tau
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from symflex.analysis.response import adaptive_grid, default_band, roots_if_found
from symflex.figures.axes import (
    Canvas,
    add_legend_above,
    label_magnitudes,
    root_figure,
    set_frequency_axis,
    set_magnitude_ticks,
    write_title,
)
from symflex.figures.style import COLOURS, COLUMN_INCHES, LINE_INCHES, title_lines
from symflex.roots import Band
from symflex.transfer import AnyBoundFunction

HEIGHT_INCHES: Final = 2.4


def draw_sigma(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw all singular values of the matrix that functions make; pairs that are not given are zero."""
    given = canvas.band_of(bounds[0].source.model)
    low, high = given or default_band(*filter(None, map(roots_if_found, bounds)))
    band = Band(Fraction(low), Fraction(high))
    omega = np.unique(
        np.concatenate([adaptive_grid(b, low, high, roots=roots_if_found(b, band)) for b in bounds])
    )
    values = singular_values(bounds, omega)
    width = canvas.width or COLUMN_INCHES
    lines = title_lines(canvas.title, width) if canvas.title else []
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    with np.errstate(divide="ignore"):
        levels = 20 * np.log10(values)
    for k, level in enumerate(levels):
        shown = np.where(np.isfinite(level), level, np.nan)
        label = rf"$\sigma_{{{k + 1}}}$"
        axes.plot(omega / tau, shown, color=COLOURS[k % len(COLOURS)], label=label)
    if canvas.frame.y:
        axes.set_ylim(*canvas.frame.y)
    set_frequency_axis(axes, low, high)
    set_magnitude_ticks(axes)
    units = {b.source.unit for b in bounds}
    label_magnitudes(axes, units.pop() if len(units) == 1 else "")
    add_legend_above(axes, len(levels), "\n".join(lines) if canvas.axes and lines else None)
    figure = root_figure(axes)
    if not canvas.axes:
        write_title(figure, lines)
    return figure


def singular_values(
    bounds: Sequence[AnyBoundFunction], omega: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the singular values at frequencies [rad/s], the largest first: (how many, frequencies)."""
    outputs = list(dict.fromkeys(b.source.output.name for b in bounds))
    inputs = list(dict.fromkeys(b.source.input.name for b in bounds))
    matrix = np.zeros((omega.size, len(outputs), len(inputs)), dtype=complex)
    for b in bounds:
        i, j = outputs.index(b.source.output.name), inputs.index(b.source.input.name)
        matrix[:, i, j] = b.each((1j * omega).tolist())
    is_known = np.isfinite(matrix).all(axis=(1, 2))
    values = np.full((min(len(outputs), len(inputs)), omega.size), np.nan)
    values[:, is_known] = np.linalg.svd(matrix[is_known], compute_uv=False).T
    return values
