"""Measured responses with a model or a fit: magnitude, phase, what the fit leaves, coherence."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from symflex.figures.axes import (
    AxesGiven,
    Canvas,
    add_legend_above,
    axes_of,
    label_magnitudes,
    magnitude_over_phase,
    root_figure,
    set_frequency_axis,
    set_magnitude_ticks,
    write_title,
)
from symflex.figures.bode import set_frequency_axes
from symflex.figures.figure import new_figure
from symflex.figures.style import COLOURS, COLUMN_INCHES, DASHES, PAGE_INCHES, QUIET, paper_style, title_lines

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.data.fitting import ResonanceFit, StablePoles
    from symflex.data.measurement import MeasuredResponse

    Real = npt.NDArray[np.float64]
    Complex = npt.NDArray[np.complex128]


FIT_RATIOS, COHERENCE_RATIO = (1.9, 1.3, 0.9), 0.5  # heights of magnitude, phase, residual; of coherence
FIT_INCHES, SMALL_INCHES, ORDER_INCHES = 4.9, 2.9, 2.9
TIME_RATIO: Final = 0.35  # height of a record in time over that of the panels above it
SECONDS: Final = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"))
FIT_COLUMNS: Final = 2
FEW_RESPONSES: Final = 4  # responses up to which two stand side by side; more stand three to a row
SMALL_POINTS, NAME_POINTS = 6.5, 5.5
NAME_LEVELS: Final = 3  # names of modes above each other on either side of their lines
AXES_INCHES: Final = 2.6, 1.6  # about the size of a panel of magnitudes
FINE: Final = 300  # points of a curve over a band, besides those where it is not straight between two
HALVED, BENT = (
    5,
    0.01,
)  # how often intervals are halved in whose middle a curve is off by more than this share
PREFIXES: Final = ((1e9, "GHz"), (1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz"), (1e-3, "mHz"))
DATA_COLOUR: Final = "#555555"


def draw_measured(
    measured: MeasuredResponse, model: Complex | None = None, unit: str = "", ax: AxesGiven | None = None
) -> Figure:
    """Draw a measured response, and over it a model on its lines if there is one, or on the user's axes."""
    given_axes = axes_of(ax)
    with nullcontext() if given_axes else paper_style():
        top, bottom = (
            Canvas(axes=given_axes).own_axes(2)
            if given_axes
            else magnitude_over_phase(COLUMN_INCHES, 3.9, 1.35)
        )
        if model is None:
            _draw_data(top, bottom, measured, measured.values, np.degrees(np.angle(measured.values)))
            if measured.is_magnitude:
                bottom.annotate("not measured", (0.5, 0.5), xycoords="axes fraction", ha="center")
        else:
            phase = _unwrapped(model)
            _draw_data(top, bottom, measured, model, phase)
            top.plot(measured.frequency_hz, _decibels(model), color=COLOURS[0], label="model")
            bottom.plot(measured.frequency_hz, phase, color=COLOURS[0])
        return _finish(top, bottom, measured, unit, 2, is_new=not given_axes)


def draw_fit(fit: ResonanceFit, response: int | None = None, ax: AxesGiven | None = None) -> Figure:
    """Draw a fit on one page: data, start and fit, what the fit leaves, coherence, and the modes by number.

    Lines left out are crossed, and the ground is coloured where the phase is not a minimum one.
    """
    given_axes = axes_of(ax)
    if given_axes:
        top, bottom = Canvas(axes=given_axes).own_axes(2)
        _draw_response(fit, response or 0, top, bottom, is_small=False)
        measured = fit.measured[response or 0]
        figure = _finish(top, bottom, measured, fit.bases[response or 0].unit, FIT_COLUMNS, is_new=False)
        _name_modes(fit, top, is_small=False)
        return figure
    shown = range(len(fit.measured)) if response is None else (response,)
    with paper_style():
        return _page(fit, shown)


def _page(fit: ResonanceFit, shown: Sequence[int]) -> Figure:
    """Return a new figure with a column of panels for each response, some of them side by side."""
    across = 1 if len(shown) == 1 else 2 if len(shown) <= FEW_RESPONSES else 3
    down = ceil(len(shown) / across)
    is_small = across > 1
    with_coherence = any(fit.measured[r].coherence is not None for r in shown)
    ratios = [*FIT_RATIOS, *([COHERENCE_RATIO] if with_coherence else [])]
    height = (SMALL_INCHES if is_small else FIT_INCHES) * sum(ratios) / sum(FIT_RATIOS)
    in_time = 0.0 if fit.validation is None else TIME_RATIO * height
    height += in_time
    figure = new_figure(PAGE_INCHES if is_small else COLUMN_INCHES, down * height)
    figure.set_layout_engine("constrained", h_pad=0.02, w_pad=0.03, hspace=0.03)
    cells = figure.subfigures(down, across, squeeze=False).ravel()
    for cell, r in zip(cells, shown, strict=False):
        measured = fit.measured[r]
        if in_time:
            upper, lower = cell.subfigures(2, 1, height_ratios=(height - in_time, in_time))
            _draw_validation(fit, r, lower.subplots(), is_small=is_small)
        else:
            upper = cell
        panels = upper.subplots(len(ratios), 1, sharex=True, height_ratios=ratios)
        for axes in panels:
            axes.grid(visible=True)
        top, bottom, residual, *others = panels
        _draw_response(fit, r, top, bottom, is_small=is_small)
        _draw_residual(fit, r, residual)
        for axes in others:
            if measured.coherence is not None:
                axes.plot(measured.frequency_hz, measured.coherence, color=DATA_COLOUR, linewidth=0.7)
            axes.set_ylim(0, 1.1)
            axes.set_ylabel("Coherence" if not is_small else "Coh.")
        _label(top, bottom, measured.unit or fit.bases[r].unit)
        if is_small:
            short = ("Magnitude [dB]", "Phase [deg]", "Res. [dB]", "Coh.")
            for axes, label in zip(panels, short, strict=False):
                axes.set_ylabel(label, fontsize=SMALL_POINTS)
                axes.tick_params(labelsize=SMALL_POINTS)
        for axes in panels:
            set_frequency_axis(axes, float(measured.frequency_hz[0]), float(measured.frequency_hz[-1]))
        for axes in panels[:-1]:
            axes.set_xlabel("")
            axes.tick_params(labelbottom=False)
        _name_modes(fit, top, is_small=is_small)
        if is_small:
            top.set_title(_title(measured), fontsize=SMALL_POINTS, parse_math=False)
        else:
            add_legend_above(top, FIT_COLUMNS, is_tight=True)
            write_title(figure, title_lines(_title(measured), COLUMN_INCHES))
    if is_small:
        panels = [axes.get_legend_handles_labels() for cell in cells for axes in cell.get_axes()]
        named = {label: handle for one in panels for handle, label in zip(*one, strict=True)}
        handles, count = list(named.values()), len(named)
        figure.legend(handles, list(named), loc="outside lower center", ncols=count, frameon=False)
    return figure


def _draw_validation(fit: ResonanceFit, response: int, axes: Axes, *, is_small: bool) -> None:
    """Draw the second half of a record over its prediction by a fit to the first half."""
    if (one := fit.validation) is None:
        return
    times = one.times_s[response]
    size, unit = next((x for x in SECONDS if times[-1] >= x[0]), SECONDS[-1])
    axes.grid(visible=True)
    axes.plot(times / size, one.measured[response], color=DATA_COLOUR, linewidth=0.7, label="second half")
    label = f"prediction, {100 * one.share[response]:.2g} % off"
    axes.plot(times / size, one.predicted[response], color=COLOURS[0], linewidth=0.7, label=label)
    axes.set_xlim(times[0] / size, times[-1] / size)
    points = SMALL_POINTS if is_small else None
    axes.set_xlabel(f"Time [{unit}]", fontsize=points)
    axes.set_ylabel("Output", fontsize=points)
    if is_small:
        axes.tick_params(labelsize=SMALL_POINTS)
    axes.legend(loc="upper right", fontsize=SMALL_POINTS)


def _title(measured: MeasuredResponse) -> str:
    return measured.name + (" (synthetic data)" if measured.is_synthetic else "")


def _draw_response(fit: ResonanceFit, response: int, top: Axes, bottom: Axes, *, is_small: bool) -> None:
    """Draw data, start and fit of one response; the phase of the magnitude-only fit where it parts."""
    line, test = fit.problem.lines[response].every, fit.phase_tests[response]
    measured = line.measured
    frequency = measured.frequency_hz
    fine = _fine(fit, response)
    model, start = fit.curve(response, fine), fit.curve(response, fine, fit.candidate.start)
    for axes in (top, bottom):
        for band in () if test.is_minimum_phase else test.bands:
            axes.axvspan(band.low_hz, band.high_hz, color="#F6E3D4", linewidth=0, zorder=0)
    fitted = _unwrapped(model)
    at_lines = np.searchsorted(fine, frequency)
    _draw_data(top, bottom, measured, model[at_lines], fitted[at_lines])
    count, order = int(fit.modes.sum()), fit.resonances.order
    if order and not is_small:
        top.plot(fine, _decibels(start), color=COLOURS[4], linestyle=DASHES[3], label="start")
        aside = np.degrees(np.angle(start / model))
        bottom.plot(fine, fitted + aside, color=COLOURS[4], linestyle=DASHES[3])
    words = "fit" if is_small or not order else f"fit, {count} resonance{'' if count == 1 else 's'}"
    top.plot(fine, _decibels(model), color=COLOURS[0], label=words)
    bottom.plot(fine, fitted, color=COLOURS[0])
    if test.bands and not test.is_minimum_phase:
        alone = fit.values(response) * test.resonances.factor(0, line.omega_seen)
        alone = alone / fit.resonances.factor(response, line.omega_seen)
        phase = np.degrees(np.unwrap(np.angle(alone)))
        phase = phase + 360 * np.round((fitted[0] - phase[0]) / 360)
        bottom.plot(frequency, phase, color=COLOURS[1], linestyle=DASHES[1])
        top.plot([], [], color=COLOURS[1], linestyle=DASHES[1], label="phase from magnitude")
    if not is_small and fit.problem.lines[response].deviation is not None:
        top.plot([], [], color=COLOURS[2], linewidth=0.8, label="expected noise")
    excluded = fit.left_out(response)
    if excluded.size:
        level = _decibels(measured.values[excluded])
        top.plot(frequency[excluded], level, "x", color=COLOURS[1], markersize=4.5, label="left out")
    levels = _decibels(measured.values)
    rise = max(0.05 * float(np.ptp(levels)), 1.0)
    limits = float(levels.min()) - rise, float(levels.max()) + rise
    for hertz in (fit.resonances.omega_p[fit.modes] / (2 * np.pi)).tolist():
        for axes in (top, bottom):
            axes.axvline(hertz, color=QUIET, linewidth=0.4, zorder=0)
    top.set_ylim(limits)


def _fine(fit: ResonanceFit, response: int) -> Real:
    """Return frequencies [Hz] of a smooth curve: the lines, and others where it bends between two."""
    lines = fit.measured[response].frequency_hz
    fine = np.unique(np.concatenate([lines, np.geomspace(lines[0], lines[-1], FINE)[1:-1]]))
    low, high = fine[:-1], fine[1:]
    for _ in range(HALVED):
        middle = (low + high) / 2
        below, value, above = (fit.curve(response, f) for f in (low, middle, high))
        bent = np.abs(value - (below + above) / 2) > BENT * np.abs(value)
        low, middle, high = low[bent], middle[bent], high[bent]
        fine = np.concatenate([fine, middle])
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return np.sort(fine)


def _name_modes(fit: ResonanceFit, axes: Axes, *, is_small: bool) -> None:
    """Name the modes beside their lines, where no other name is; those without room have none."""
    hertz = (fit.resonances.omega_p[fit.modes] / (2 * np.pi)).tolist()
    span = hertz[-1] - hertz[0] if len(hertz) > 1 else np.ptp(axes.get_xlim())
    gaps = np.diff(hertz).min(initial=span) or span
    names = [f"{k}" if is_small else f"{k}: {_in_hertz(x, float(gaps))}" for k, x in enumerate(hertz, 1)]
    low, high = np.log(axes.get_xlim())
    points = 72 * AXES_INCHES[0] / (2 if is_small else 1) / (high - low)
    thick = NAME_POINTS * 1.15
    taken: list[tuple[float, float, int]] = []
    for name, at in zip(names, hertz, strict=True):
        if not low <= np.log(at) <= high:
            continue
        x = points * (np.log(at) - low)
        sides = ((x - thick, x, "right"), (x, x + thick, "left"))
        free = (
            (level, *side)
            for level in range(NAME_LEVELS)
            for side in sides
            if not any(a < side[1] and side[0] < b and level == n for a, b, n in taken)
        )
        if (place := next(free, None)) is None:
            continue
        level, left, right, side = place
        taken.append((left, right, level))
        height = (7 / 100 if is_small else 1 / NAME_LEVELS) * level + 0.02
        axes.annotate(
            name, (at, height), xycoords=("data", "axes fraction"), fontsize=NAME_POINTS,
            rotation=0 if is_small else 90, ha=side, va="bottom",
        )  # fmt: skip


def _in_hertz(hertz: float, gap: float) -> str:
    """Return a frequency with the digits that tell it from one at a distance, four at least."""
    size, unit = next((one for one in PREFIXES if hertz >= one[0]), PREFIXES[-1])
    digits = max(4, int(np.ceil(np.log10(hertz / gap))) + 2) if gap > 0 else 4
    return f"{hertz / size:.{min(digits, 9)}g} {unit}"


def _draw_residual(fit: ResonanceFit, response: int, axes: Axes) -> None:
    """Draw how far the data are off the fit, and the noise that is expected."""
    line = fit.problem.lines[response]
    every = line.every.measured
    with np.errstate(divide="ignore"):
        residual = _decibels(line.every.rest(fit.values(response)))
    wild = fit.left_out(response)
    kept = np.delete(np.arange(residual.size), wild)
    axes.plot(every.frequency_hz[kept], residual[kept], ".", color=DATA_COLOUR, markersize=1.6)
    axes.plot(every.frequency_hz[wild], residual[wild], "x", color=COLOURS[1], markersize=4.5)
    if line.deviation is not None:
        noise = _decibels(np.sqrt(2) * line.deviation * line.measured.values)
        axes.plot(line.measured.frequency_hz, noise, color=COLOURS[2], linewidth=0.8, label="expected noise")
    finite = residual[np.isfinite(residual)]
    if finite.size:
        lowest = max(float(np.min(finite)), float(np.median(finite)) - 40.0)  # what is smaller is chance
        axes.set_ylim(lowest, float(np.max(finite)) + 6)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4))
    axes.set_ylabel("Residual [dB]")


def draw_orders(stable: Sequence[StablePoles], fit: ResonanceFit, response: int = 0) -> Figure:
    """Draw a stabilisation diagram; a filled circle repeats a pole that was found with two poles less."""
    measured = fit.measured[response]
    with paper_style():
        figure = new_figure(COLUMN_INCHES, ORDER_INCHES)
        figure.set_layout_engine("constrained", h_pad=0.02, w_pad=0.03)
        axes = figure.subplots()
        level = axes.twinx()
        level.plot(measured.frequency_hz, _decibels(measured.values), color=QUIET, linewidth=0.6)
        label_magnitudes(level, measured.unit)
        poles = [pole for one in stable for pole in zip(one.frequency_hz, one.is_stable, strict=True)]
        orders = [one.order for one in stable for _ in one.frequency_hz]
        for mark, is_stable, label in (("x", False, "new"), ("o", True, "stable")):
            at = [(f, n) for (f, s), n in zip(poles, orders, strict=True) if bool(s) == is_stable]
            x, y = zip(*at, strict=True) if at else ((), ())
            axes.plot(x, y, mark, color=COLOURS[1] if is_stable else QUIET, markersize=3.2, label=label)
        axes.set_zorder(level.get_zorder() + 1)
        axes.patch.set_visible(False)
        axes.set_ylabel("Number of poles")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        set_frequency_axis(axes, float(measured.frequency_hz[0]), float(measured.frequency_hz[-1]))
        for hertz in (fit.resonances.omega_p[fit.modes] / (2 * np.pi)).tolist():
            axes.axvline(hertz, color=COLOURS[0], linewidth=0.5, zorder=0)
        add_legend_above(axes, 2, is_tight=True)
        write_title(figure, title_lines(f"{measured.name}: poles by their number", COLUMN_INCHES))
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
        if axes is bottom and measured.is_magnitude:
            break
        axes.plot(measured.frequency_hz, values, ".", color=DATA_COLOUR, markersize=2.4, label=label)


def _finish(
    top: Axes, bottom: Axes, measured: MeasuredResponse, unit: str, columns: int, *, is_new: bool
) -> Figure:
    """Label the panels, give them a legend and a new figure a title, and return the figure."""
    _label(top, bottom, measured.unit or unit)
    set_frequency_axes((top, bottom), float(measured.frequency_hz[0]), float(measured.frequency_hz[-1]))
    figure = root_figure(top)
    add_legend_above(top, columns, is_tight=True)
    if is_new:
        write_title(figure, title_lines(_title(measured), COLUMN_INCHES))
    return figure


def _label(top: Axes, bottom: Axes, unit: str) -> None:
    """Label magnitudes and phases."""
    label_magnitudes(top, unit)
    set_magnitude_ticks(top)
    bottom.set_ylabel("Phase [deg]")
    bottom.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 1.5, 3, 4.5, 9, 10]))


def _unwrapped(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Return continuous phases [deg], the first within half a turn of 0."""
    phase = np.degrees(np.unwrap(np.angle(values)))
    return np.asarray(phase - 360 * np.round(phase[0] / 360))


def _decibels(values: Complex | Real) -> npt.NDArray[np.float64]:
    """Return ``20 log10(abs(values))``."""
    return np.asarray(20 * np.log10(np.abs(values)))
