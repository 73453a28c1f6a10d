"""Measured responses with what a model or a fit says of them: magnitude over phase, data as dots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.ticker import MaxNLocator

from symflex.figures.axes import (
    add_legend_above,
    label_magnitudes,
    magnitude_over_phase,
    set_frequency_axis,
    set_magnitude_ticks,
    write_title,
)
from symflex.figures.style import COLOURS, COLUMN_INCHES, DASHES, QUIET, paper_style, title_lines

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.data.fitting import ResonanceFit
    from symflex.data.measurement import MeasuredResponse

HEIGHT_INCHES: Final = 3.9
RATIO: Final = 1.35
"""Height of the panel of magnitudes over that of phases."""
DATA_COLOUR: Final = "#555555"
PARTED_COLOUR: Final = "#F6E3D4"
"""Ground where the phase is not that of a minimum-phase function."""


def draw_measured(measured: MeasuredResponse, model: npt.NDArray[np.complex128], unit: str = "") -> Figure:
    """Draw a model over a measured response.

    ``model`` is the model on the measured lines; ``unit`` is that of the values, where the data do not say.
    Synthetic data are called so in the title.
    """
    with paper_style():
        figure, top, bottom = magnitude_over_phase(COLUMN_INCHES, HEIGHT_INCHES, RATIO)
        phase = np.degrees(np.unwrap(np.angle(model)))
        phase = phase - 360 * np.round(phase[0] / 360)
        _draw_data(top, bottom, measured, model, phase)
        top.plot(measured.frequency_hz, _decibels(model), color=COLOURS[0], label="model")
        bottom.plot(measured.frequency_hz, phase, color=COLOURS[0])
        _finish(figure, top, bottom, measured, unit, 2)
    return figure


def draw_fit(fit: ResonanceFit, response: int = 0) -> Figure:
    """Draw one response of a fit: data, start, fit; and the phase of the magnitude-only fit where it parts.

    Synthetic data are called so in the title.
    """
    line, test = fit.problem.lines[response], fit.phase_tests[response]
    measured = line.measured
    frequency = measured.frequency_hz
    model = fit.values(response)
    start = fit.values(response, fit.candidate.start)
    with paper_style():
        figure, top, bottom = magnitude_over_phase(COLUMN_INCHES, HEIGHT_INCHES, RATIO)
        for axes in (top, bottom):
            for band in () if test.is_minimum_phase else test.bands:
                axes.axvspan(band.low_hz, band.high_hz, color=PARTED_COLOUR, linewidth=0, zorder=0)
        fitted = np.degrees(np.unwrap(np.angle(model)))
        fitted = fitted - 360 * np.round(fitted[0] / 360)
        _draw_data(top, bottom, measured, model, fitted)
        top.plot(frequency, _decibels(start), color=COLOURS[4], linestyle=DASHES[3], label="start")
        top.plot(
            frequency, _decibels(model), color=COLOURS[0], label=f"fit, {fit.resonances.count} resonances"
        )
        bottom.plot(
            frequency, fitted + np.degrees(np.angle(start / model)), color=COLOURS[4], linestyle=DASHES[3]
        )
        bottom.plot(frequency, fitted, color=COLOURS[0])
        if test.bands and not test.is_minimum_phase:
            alone = fit.values(response, None) * test.resonances.factor(0, line.omega)
            alone = alone / fit.resonances.factor(response, line.omega)
            phase = np.degrees(np.unwrap(np.angle(alone)))
            phase = phase + 360 * np.round((fitted[0] - phase[0]) / 360)
            bottom.plot(frequency, phase, color=COLOURS[1], linestyle=DASHES[1])
            top.plot([], [], color=COLOURS[1], linestyle=DASHES[1], label="phase from magnitude")
        for omega in fit.resonances.omega_p.tolist():
            bottom.axvline(omega / (2 * np.pi), color=QUIET, linewidth=0.4, zorder=0)
        _finish(figure, top, bottom, measured, fit.bases[response].unit, 3 if test.is_minimum_phase else 2)
    return figure


def _draw_data(
    top: Axes,
    bottom: Axes,
    measured: MeasuredResponse,
    model: npt.NDArray[np.complex128],
    phase: npt.NDArray[np.float64],
) -> None:
    """Draw the data, their phases within half a turn of the model's ``phase`` [deg]."""
    name = "synthetic data" if measured.is_synthetic else "measured"
    aside = np.degrees(np.angle(measured.values / model))
    for axes, values, label in ((top, _decibels(measured.values), name), (bottom, phase + aside, None)):
        axes.plot(measured.frequency_hz, values, ".", color=DATA_COLOUR, markersize=2.4, label=label)


def _finish(
    figure: Figure, top: Axes, bottom: Axes, measured: MeasuredResponse, unit: str, columns: int
) -> None:
    """Label the panels and give them a legend and a title."""
    label_magnitudes(top, measured.unit or unit)
    set_magnitude_ticks(top)
    bottom.set_ylabel("Phase [deg]")
    bottom.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 1.5, 3, 4.5, 9, 10]))
    set_frequency_axis(bottom, float(measured.frequency_hz[0]), float(measured.frequency_hz[-1]))
    figure.align_ylabels([top, bottom])
    add_legend_above(top, columns, is_tight=True)
    title = measured.name + (" (synthetic data)" if measured.is_synthetic else "")
    write_title(figure, title_lines(title, COLUMN_INCHES))


def _decibels(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Return ``20 log10(abs(values))``."""
    return np.asarray(20 * np.log10(np.abs(values)))
