"""A fit over its data: magnitude and phase of measurement, start and fit, and where the phase test parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from symflex.figures.measured import decibels, draw_data, finish, panels
from symflex.figures.style import COLOURS, DASHES, QUIET, paper_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.data.fitting import ResonanceFit

PARTED_COLOUR: Final = "#F6E3D4"


def draw_fit(fit: ResonanceFit, response: int = 0) -> Figure:
    """Draw one response of a fit: data, start, fit; and the phase of the magnitude-only fit where it parts.

    Parameters
    ----------
    fit : ResonanceFit
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
    with paper_style():
        figure, top, bottom = panels()
        for axes in (top, bottom):
            for band in () if test.is_minimum_phase else test.bands:
                axes.axvspan(band.low_hz, band.high_hz, color=PARTED_COLOUR, linewidth=0, zorder=0)
        fitted = np.degrees(np.unwrap(np.angle(model)))
        fitted = fitted - 360 * np.round(fitted[0] / 360)
        draw_data(top, bottom, measured, model, fitted)
        top.plot(frequency, decibels(start), color=COLOURS[4], linestyle=DASHES[3], label="start")
        top.plot(
            frequency, decibels(model), color=COLOURS[0], label=f"fit, {fit.resonances.count} resonances"
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
        finish(figure, top, bottom, measured, fit.bases[response].unit, 3 if test.is_minimum_phase else 2)
    return figure
