"""A fit over its data: magnitude and phase of measurement, start and fit, and where the phase test parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.ticker import MaxNLocator

from symflex.emit.figures.bode import set_frequency_axis
from symflex.emit.figures.labels import label_of_unit
from symflex.emit.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    DASHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    new_figure,
    paper_style,
    title_lines,
)

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.figure import Figure

    from symflex.fitting import Fit

HEIGHT_INCHES: Final = 3.9
DATA_COLOUR: Final = "#555555"
PARTED_COLOUR: Final = "#F6E3D4"
PHASE_STEP: Final = (45, 90, 180, 360)


def draw_fit(fit: Fit, response: int = 0) -> Figure:
    """Draw one response of a fit: data, start, fit; and the phase of the magnitude-only fit where it parts.

    Parameters
    ----------
    fit : Fit
        The result.
    response : int
        Which of its responses.

    Returns
    -------
    matplotlib.figure.Figure
        Synthetic data are called so in the title.
    """
    line, test = fit.problem.lines[response], fit.phase_tests[response]
    measured = line.measured
    frequency = measured.frequency_hz
    model = fit.values(response)
    start = fit.values(response, fit.candidate.start)
    title = measured.name + (" (synthetic data)" if measured.is_synthetic else "")
    lines = title_lines(title, COLUMN_INCHES)
    with paper_style():
        figure = new_figure(COLUMN_INCHES, HEIGHT_INCHES)
        figure.set_layout_engine("constrained", h_pad=0.02, w_pad=0.03, hspace=0.03)
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[1.35, 1])
        for axes in (top, bottom):
            for band in test.bands:
                axes.axvspan(band.low_hz, band.high_hz, color=PARTED_COLOUR, linewidth=0, zorder=0)
        name = "synthetic data" if measured.is_synthetic else "measured"
        top.plot(frequency, _db(measured.values), ".", color=DATA_COLOUR, markersize=1.6, label=name)
        top.plot(frequency, _db(start), color=COLOURS[4], linestyle=DASHES[3], label="start")
        top.plot(frequency, _db(model), color=COLOURS[0], label=f"fit, {fit.resonances.count} resonances")
        fitted = np.degrees(np.unwrap(np.angle(model)))
        fitted = fitted - 360 * np.round(fitted[0] / 360)
        bottom.plot(
            frequency,
            fitted + np.degrees(np.angle(measured.values / model)),
            ".",
            color=DATA_COLOUR,
            markersize=1.6,
        )
        bottom.plot(
            frequency, fitted + np.degrees(np.angle(start / model)), color=COLOURS[4], linestyle=DASHES[3]
        )
        bottom.plot(frequency, fitted, color=COLOURS[0])
        if test.bands:
            alone = fit.values(response, None) * test.resonances.factor(0, line.omega)
            alone = alone / fit.resonances.factor(response, line.omega)
            phase = np.degrees(np.unwrap(np.angle(alone)))
            phase = phase + 360 * np.round((fitted[0] - phase[0]) / 360)
            bottom.plot(frequency, phase, color=COLOURS[1], linestyle=DASHES[1])
            top.plot([], [], color=COLOURS[1], linestyle=DASHES[1], label="phase from magnitude")
        unit = label_of_unit(measured.unit or fit.bases[response].unit)
        top.set_ylabel(f"Magnitude [dB re 1 {unit}]" if unit else "Magnitude [dB]")
        top.yaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 2, 4, 5, 10], min_n_ticks=3))
        bottom.set_ylabel("Phase [deg]")
        bottom.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 1.5, 3, 4.5, 9, 10]))
        set_frequency_axis(bottom, float(frequency[0]), float(frequency[-1]))
        for axes in (top, bottom):
            axes.grid(visible=True)
        for omega in fit.resonances.omega_p.tolist():
            bottom.axvline(omega / (2 * np.pi), color=QUIET, linewidth=0.4, zorder=0)
        figure.align_ylabels([top, bottom])
        top.legend(
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=2 if test.bands else 3,
            frameon=False,
            handlelength=2.0,
            columnspacing=1.2,
            borderaxespad=0.2,
            borderpad=0.1,
        )
        figure.suptitle("\n".join(lines), fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False)
    return figure


def _db(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    return np.asarray(20 * np.log10(np.abs(values)))
