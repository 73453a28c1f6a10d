"""Magnitude [dB] over phase [deg] by frequency: of transfer functions, and of data with a model or a fit."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from fractions import Fraction
from itertools import cycle, islice
from math import ceil, inf, tau
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from symflex.analysis.response import SampledResponse, adaptive_grid, default_band, respond, roots_if_found
from symflex.figures.axes import (
    AxesGiven,
    Canvas,
    Limits,
    add_legend_above,
    axes_of,
    label_magnitudes,
    magnitude_over_phase,
    root_figure,
    set_frequency_axis,
    set_magnitude_ticks,
    write_title,
)
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    DASHES,
    LINE_INCHES,
    label_of_tf,
    label_of_unit,
    paper_style,
    stability_lines,
    title_lines,
)
from symflex.roots import Band, PoleZeroMap
from symflex.roots.loss_modes import NO_STABILITY
from symflex.transfer import AnyBoundFunction

HEIGHT_INCHES: Final = 3.2
LEGEND_COLUMNS, LEGEND_COLUMNS_WITH_UNITS = 3, 2
UNIT_INCHES: Final = 1.05  # height of the panel of every unit but the first
RATIO: Final = 1.25  # height of the panel of magnitudes over that of phases
PHASE_MARGIN: Final = 1.12
PHASE_STEPS: Final = (45, 90, 180, 360, 720, 1440)  # degrees: the first with fewer than PHASE_TICKS ticks
PHASE_TICKS: Final = 7.5
UNDAMPED: Final = 1e-4  # damping ratio below which a peak or trough has no end worth showing and is cut off
UNDAMPED_REACH: Final = 0.01  # values this close to such a root, relatively, do not count for the limits
ASYMPTOTE: Final = 0.4  # width [pt]; functions of finite order have asymptotes that hold on s = j omega
UNDAMPED_MARGIN_DB: Final = 15.0  # room beyond the damped values where peaks are cut off
GAPS: Final = "{}: {}; drawn from its values, because not all roots are known"


def draw_bode(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw magnitude, a panel for each unit, and phase; infinite peaks and troughs run to the frame."""
    # The default roots of distributed systems only give a band and the poles in the right half-plane.
    given = canvas.band_of(bounds[0].source.model)
    judged = [None if given else roots_if_found(bound) for bound in bounds]
    low, high = given or default_band(*filter(None, judged))
    band = Band(Fraction(low), Fraction(high))
    maps = [roots_if_found(bound, band, known) for bound, known in zip(bounds, judged, strict=True)]
    responses = [
        respond(bound, adaptive_grid(bound, low, high, roots=located), located)
        for bound, located in zip(bounds, maps, strict=True)
    ]
    width = canvas.width or COLUMN_INCHES
    # Loss factors decide nothing about stability, and whoever gives them knows that.
    shaky = [m for m in maps if m.verdict.word in ("unstable", "unknown") and m.verdict != NO_STABILITY]
    gaps = [GAPS.format(m.tf, m.certificate.reason) for m in maps if m.certificate.is_exceeded]
    lines = [line for one in (canvas.title, *gaps) for line in title_lines(one, width)]
    said = stability_lines(shaky, width)
    units = list(dict.fromkeys(response.unit for response in responses))
    is_mixed = len(units) > 1
    has_units = is_mixed and bool(canvas.axes)  # in the legend: the user's first axes show all magnitudes
    legend_columns = min(len(bounds), LEGEND_COLUMNS_WITH_UNITS if has_units else LEGEND_COLUMNS)
    height = HEIGHT_INCHES + LINE_INCHES * (len(lines) + len(said) + ceil(len(bounds) / legend_columns))
    height += UNIT_INCHES * (len(units) - 1)
    if canvas.axes:
        top, *below = canvas.own_axes(1, 2)
        tops = dict.fromkeys(units, top)
    else:
        panels = magnitude_over_phase(width, height, 1.0 if is_mixed else RATIO, len(units))
        top, below, tops = panels[0], [panels[-1]], dict(zip(units, panels, strict=False))
    drawn = len(top.get_lines())  # on the user's axes
    limits: dict[Axes, tuple[float, float]] = {}
    for axes in tops.values():
        shown = [(r, m) for r, m in zip(responses, maps, strict=True) if tops[r.unit] is axes]
        limits[axes] = canvas.frame.y or _magnitude_limits(shown, axes)
    handles = []
    looks = zip(cycle(COLOURS), cycle(DASHES), strict=False)
    for bound, response, located, (colour, dash) in zip(
        bounds, responses, maps, islice(looks, drawn, None), strict=False
    ):
        label = label_of_tf(bound.source)
        label += f" [{label_of_unit(response.unit)}]" if has_units and response.unit not in ("", "1") else ""
        level = tops[response.unit]
        curve = _magnitude_curve(response, located, limits[level])
        handles += level.plot(*curve, color=colour, linestyle=dash, label=label)
        for axes in below:
            axes.plot(response.frequency_hz, np.degrees(response.phase), color=colour, linestyle=dash)
        if canvas.frame.has_asymptotes and bound.is_rational:
            _draw_asymptotes(level, bound, np.array([low, high]), colour)
    for unit, axes in tops.items():
        axes.set_ylim(*limits[axes])
        set_magnitude_ticks(axes)
        label_magnitudes(axes, "" if has_units else unit, is_short=is_mixed and not has_units)
    for axes in below:
        _set_phase_axis(axes, responses, canvas.frame.phase)
    set_frequency_axes((*dict.fromkeys(tops.values()), *below), low, high)
    figure = root_figure(top)
    heading = "\n".join((*lines, *said) if canvas.axes else said) or None
    add_legend_above(top, legend_columns, heading, handles=None if canvas.axes else handles)
    if not canvas.axes:
        write_title(figure, lines)
    return figure


def set_frequency_axes(panels: Sequence[Axes], low: float, high: float) -> None:
    """Label the lowest of panels that stand below each other."""
    for axes in panels:
        set_frequency_axis(axes, low, high)
    for axes in panels[:-1]:
        axes.set_xlabel("")
        axes.tick_params(labelbottom=False)
    root_figure(panels[0]).align_ylabels(panels)


def draw_response(response: SampledResponse, ax: AxesGiven | None = None) -> Figure | None:
    """Draw a frequency response at its own frequencies; None with fewer than two positive ones."""
    frequency = response.frequency_hz
    kept = frequency > 0
    order = np.argsort(frequency[kept], kind="stable")
    frequency = frequency[kept][order]
    if not frequency.size or frequency[0] == frequency[-1]:
        return None
    level = response.magnitude_db[kept][order]
    level = np.where(np.isfinite(level), level, np.nan)
    given_axes = axes_of(ax)
    with nullcontext() if given_axes else paper_style():
        height = HEIGHT_INCHES + LINE_INCHES
        top, bottom = (
            Canvas(axes=given_axes).own_axes(2)
            if given_axes
            else magnitude_over_phase(COLUMN_INCHES, height, RATIO)
        )
        figure = root_figure(top)
        colour = COLOURS[len(top.get_lines()) % len(COLOURS)]
        top.plot(frequency, level, color=colour, label=response.tf)
        bottom.plot(frequency, np.degrees(response.phase[kept][order]), color=colour)
        label_magnitudes(top, response.unit)
        _set_phase_axis(bottom, [response])
        set_frequency_axes((top, bottom), float(frequency[0]), float(frequency[-1]))
        if not given_axes:
            write_title(figure, title_lines(response.tf, COLUMN_INCHES))
    return figure


def _draw_asymptotes(axes: Axes, bound: AnyBoundFunction, ends: npt.NDArray[np.float64], colour: str) -> None:
    """Draw the powers of s that a function comes close to, as straight lines between two frequencies."""
    from symflex.symbolic.limits import limits_of  # few figures have them

    for row in limits_of(bound.source).rows:
        if row.value and row.power is not None:
            size = 20 * np.log10(abs(row.value) * (tau * ends) ** float(row.power))
            axes.plot(ends, size, color=colour, linewidth=ASYMPTOTE)


def _magnitude_limits(drawn: Sequence[tuple[SampledResponse, PoleZeroMap]], axes: Axes) -> Limits:
    """Return limits [dB] that show every damped peak, undamped ones cut off, and what axes show already."""
    before = axes.get_ylim() if axes.get_lines() else (inf, -inf)
    damped = [(response.magnitude_db[~_undamped(response, located)], response) for response, located in drawn]
    shown = [(level, response) for level, response in damped if level.size]
    if not shown:
        return min(-1.0, before[0]), max(1.0, before[1])
    lowest, highest = (float(end(np.concatenate([level for level, _ in shown]))) for end in (np.min, np.max))
    is_cut = any(level.size < r.omega.size for level, r in shown)
    margin = UNDAMPED_MARGIN_DB if is_cut else max(0.05 * (highest - lowest), 1.0)
    return min(lowest - margin, before[0]), max(highest + margin, before[1])


def _magnitude_curve(
    response: SampledResponse, located: PoleZeroMap, limits: tuple[float, float]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return frequencies [Hz] and levels [dB], with a point beyond the frame at each root on the axis."""
    beyond = limits[1] - limits[0]
    ends = [(root, limits[1] + beyond) for root in located.poles]
    ends += [(root, limits[0] - beyond) for root in located.zeros]
    added = [(root.frequency_hz(), level) for root, level in ends if root.on_imaginary_axis and root.im > 0]
    level = np.clip(response.magnitude_db, limits[0] - beyond, limits[1] + beyond)
    frequency = np.concatenate((response.frequency_hz, [f for f, _ in added]))
    order = np.argsort(frequency, kind="stable")
    return frequency[order], np.concatenate((level, [end for _, end in added]))[order]


def _undamped(response: SampledResponse, found: PoleZeroMap) -> npt.NDArray[np.bool_]:
    """Tell which values lie near an undamped root, or are infinite."""
    near = ~np.isfinite(response.magnitude_db)
    for root in (*found.poles, *found.zeros):
        damping = root.damping_ratio()
        if damping is not None and abs(damping) < UNDAMPED and root.im > 0:
            centre = float(root.im.mid())
            near |= np.abs(response.omega - centre) < UNDAMPED_REACH * centre
    return near


def _set_phase_axis(axes: Axes, responses: Sequence[SampledResponse], limits: Limits | None = None) -> None:
    phase = np.degrees(np.concatenate([response.phase for response in responses]))
    phase = phase[np.isfinite(phase)]
    lowest, highest = limits or ((float(phase.min()), float(phase.max())) if phase.size else (0.0, 0.0))
    for step in PHASE_STEPS:
        if highest - lowest < PHASE_TICKS * step:
            break
    middle, half = (lowest + highest) / 2, max((highest - lowest) / 2, step)
    axes.set_ylim(*(limits or (middle - PHASE_MARGIN * half, middle + PHASE_MARGIN * half)))
    is_plain = limits is not None and not 2 * PHASE_STEPS[0] <= highest - lowest < PHASE_TICKS * step
    axes.yaxis.set_major_locator(MaxNLocator(nbins=7) if is_plain else MultipleLocator(step))
    axes.set_ylabel("Phase [deg]")
