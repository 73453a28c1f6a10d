"""Measured responses with what models say of them: magnitude over phase, data as dots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.ticker import MaxNLocator

from symflex.figures.bode import set_frequency_axis
from symflex.figures.labels import label_of_unit
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    TITLE_POINTS,
    TITLE_SPACING,
    new_figure,
    paper_style,
    title_lines,
)

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.data.measurement import MeasuredResponse

HEIGHT_INCHES: Final = 3.9
DATA_COLOUR: Final = "#555555"


def draw_measured(measured: MeasuredResponse, model: npt.NDArray[np.complex128], unit: str = "") -> Figure:
    """Draw a model over a measured response.

    Parameters
    ----------
    measured : MeasuredResponse
        With n lines.
    model : array of complex, shape (n,)
        The model on these lines.
    unit : str
        Of the values, where the data do not say.

    Returns
    -------
    matplotlib.figure.Figure
        Synthetic data are called so in the title.
    """
    with paper_style():
        figure, top, bottom = panels()
        phase = np.degrees(np.unwrap(np.angle(model)))
        phase = phase - 360 * np.round(phase[0] / 360)
        draw_data(top, bottom, measured, model, phase)
        top.plot(measured.frequency_hz, decibels(model), color=COLOURS[0], label="model")
        bottom.plot(measured.frequency_hz, phase, color=COLOURS[0])
        finish(figure, top, bottom, measured, unit, 2)
    return figure


def panels() -> tuple[Figure, Axes, Axes]:
    """Return a figure with an empty panel for magnitudes over one for phases."""
    figure = new_figure(COLUMN_INCHES, HEIGHT_INCHES)
    figure.set_layout_engine("constrained", h_pad=0.02, w_pad=0.03, hspace=0.03)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[1.35, 1])
    return figure, top, bottom


def draw_data(
    top: Axes,
    bottom: Axes,
    measured: MeasuredResponse,
    model: npt.NDArray[np.complex128],
    phase: npt.NDArray[np.float64],
) -> None:
    """Draw the data, their phases within half a turn of the model's ``phase`` [deg]."""
    name = "synthetic data" if measured.is_synthetic else "measured"
    aside = np.degrees(np.angle(measured.values / model))
    for axes, values, label in ((top, decibels(measured.values), name), (bottom, phase + aside, None)):
        axes.plot(measured.frequency_hz, values, ".", color=DATA_COLOUR, markersize=2.4, label=label)


def finish(
    figure: Figure, top: Axes, bottom: Axes, measured: MeasuredResponse, unit: str, columns: int
) -> None:
    """Label the panels and give them a legend and a title."""
    label = label_of_unit(measured.unit or unit)
    top.set_ylabel(f"Magnitude [dB re 1 {label}]" if label else "Magnitude [dB]")
    top.yaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 2, 4, 5, 10], min_n_ticks=3))
    bottom.set_ylabel("Phase [deg]")
    bottom.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 1.5, 3, 4.5, 9, 10]))
    set_frequency_axis(bottom, float(measured.frequency_hz[0]), float(measured.frequency_hz[-1]))
    for axes in (top, bottom):
        axes.grid(visible=True)
    figure.align_ylabels([top, bottom])
    top.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=columns,
        frameon=False,
        handlelength=2.0,
        columnspacing=1.2,
        borderaxespad=0.2,
        borderpad=0.1,
    )
    title = measured.name + (" (synthetic data)" if measured.is_synthetic else "")
    lines = title_lines(title, COLUMN_INCHES)
    figure.suptitle("\n".join(lines), fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False)


def decibels(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Return ``20 log10(abs(values))``."""
    return np.asarray(20 * np.log10(np.abs(values)))
