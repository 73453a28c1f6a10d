"""Responses over time with the bands of their enclosures, and what an input shaper leaves."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import cycle
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np
from flint import acb
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symflex.analysis.time_response import INTEGRATIONS, SampleTimes, responses_by_default, time_response
from symflex.figures.axes import (
    FREE,
    AxisLimits,
    Canvas,
    add_legend_above,
    panels_below,
    root_figure,
    write_title,
)
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    DASHES,
    DEFAULT_FONT,
    LINE_INCHES,
    MM_PER_INCH,
    QUIET,
    label_of_tf,
    label_of_unit,
    paper_style,
    title_lines,
)
from symflex.transfer import AnyBoundFunction

if TYPE_CHECKING:
    from matplotlib.lines import Line2D

    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.time_response import EnclosedResponse

HEIGHT_INCHES: Final = 2.2
UNIT_INCHES: Final = 1.0  # height of a further panel
FARTHEST: Final = 0.5  # how far a band of radii is drawn beyond the curve, as a share of its height
VISIBLE: Final = 1e-3  # radius over the largest value from which its band is drawn: about the width of a line
PREFIXES: Final = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
POINTS: Final = 801
DIGITS: Final = 6  # digits of values, far more than a line shows
RESIDUAL_INCHES: Final = 2.3
SPAN: Final = (0.5, 1.5)
RATIOS: Final = 401
TICK: Final = 5  # percent of residual vibration that designers ask for


def draw_responses(kind: str, bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw step or impulse responses without impulses, a panel a unit; see :func:`symflex.figures.draw`."""
    if canvas.frame.x:
        times = SampleTimes.evenly(Fraction(canvas.frame.x[1]), POINTS)
        responses = [time_response(bound, kind, times, DIGITS) for bound in bounds]
    else:
        responses = responses_by_default(bounds, kind, POINTS, DIGITS)
    width = canvas.width or COLUMN_INCHES
    lines = [*title_lines(canvas.title, width), *_said(responses, width)]
    units = list(dict.fromkeys(response.unit for response in responses))
    columns = min(len(bounds), len(DASHES) - 1)
    height = HEIGHT_INCHES + LINE_INCHES * (len(lines) + ceil(len(bounds) / columns))
    if canvas.axes or len(units) == 1:
        panels = dict.fromkeys(units, canvas.one_panel(height))
    else:
        height += UNIT_INCHES * (len(units) - 1)
        panels = dict(zip(units, panels_below(width, height, [1] * len(units)), strict=True))
    has_units = len(units) > 1 and bool(canvas.axes)  # in the legend: the user's axes show all units
    handles = []
    looks = zip(cycle(COLOURS), cycle(DASHES), strict=False)
    for bound, response, look in zip(bounds, responses, looks, strict=False):
        label = label_of_tf(bound.source)
        if has_units and (unit := label_of_unit(response.unit)):
            label = f"{label} [{unit}]"
        handles += _draw_curve(panels[response.unit], response, look, label)
    for unit, axes in panels.items():
        _label(axes, responses[0], "" if has_units else unit, canvas.frame)
    (top, *_), last = panels.values(), [*panels.values()][-1]
    for axes in panels.values():
        if axes is not last:
            axes.set_xlabel("")
            axes.tick_params(labelbottom=False)
    figure = root_figure(top)
    figure.align_ylabels(list(panels.values()))
    add_legend_above(top, columns, handles=None if canvas.axes else handles)
    write_title(figure, lines)
    return figure


def draw_in_time(
    response: EnclosedResponse,
    ax: Axes | None = None,
    *,
    frame: AxisLimits = FREE,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
) -> Figure:
    """Draw one response at its own times, on axes of the user's own if they are given."""
    width = width_mm / MM_PER_INCH if width_mm else COLUMN_INCHES
    canvas = Canvas(frame=frame, width=width, axes=() if ax is None else (ax,))
    first = title_lines(f"{response.tf}, {response.title}", width)
    lines = [*first, *_said([response], width), *title_lines(response.comparison, width)]
    with paper_style(font):
        axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * len(lines))
        if response.measured is not None:
            across = response.times / _prefix(response)[0]
            axes.plot(across, response.measured[1], color=QUIET, label=f"measured {response.measured[0]}")
        _draw_curve(axes, response, (COLOURS[0], "-"), "model" if response.measured else None)
        _label(axes, response, response.unit, frame)
        if response.measured is not None:
            add_legend_above(axes, 2)
        write_title(root_figure(axes), lines)
    return root_figure(axes)


def _said(responses: Sequence[EnclosedResponse], width: float) -> list[str]:
    """Return what stands below a title: what is not drawn, and what is not certified."""
    said = [f"{r.tf}: it also has impulses, which are not drawn" for r in responses if r.impulses]
    said += [f"{r.tf}, not certified: {r.reason}" for r in responses if not r.certified]
    return [line for text in said for line in title_lines(text, width)]


def _prefix(response: EnclosedResponse) -> tuple[float, str]:
    last = float(response.times[-1])
    return next((prefix for prefix in PREFIXES if last >= prefix[0]), PREFIXES[-1])


def _draw_curve(
    axes: Axes, response: EnclosedResponse, look: tuple[str, object], label: str | None
) -> list[Line2D]:
    values, radius = response.values, response.radius
    scale, _ = _prefix(response)
    across = response.times / scale
    colour, dash = look
    if np.max(radius, initial=0) > VISIBLE * np.max(np.abs(values), initial=0):
        # An instant of which nothing is known, as the first may be, does not rule the axis.
        beyond = FARTHEST * np.ptp(values) or np.inf
        low = np.maximum(values - radius, values.min() - beyond)
        high = np.minimum(values + radius, values.max() + beyond)
        axes.fill_between(across, low, high, color=colour, alpha=0.2, linewidth=0)
    return axes.plot(across, values, color=colour, linestyle=dash, label=label)


def _label(axes: Axes, response: EnclosedResponse, unit: str, frame: AxisLimits) -> None:
    """Label axes, and show the times and values that were asked for."""
    scale, second = _prefix(response)
    axes.grid(visible=True)
    axes.axhline(0, color=QUIET, linewidth=0.5, zorder=1)
    start, end = frame.x or (0.0, float(response.times[-1]))
    axes.set_xlim(start / scale, end / scale)
    if frame.y:
        axes.set_ylim(*frame.y)
    axes.set_xlabel(f"Time [{second}]")
    label = label_of_unit(unit)
    name = f"{response.input} response".capitalize() if response.input in INTEGRATIONS else "Response"
    axes.set_ylabel(f"{name} [{label}]" if label else name)


def draw_residual(shaper: InputShaper) -> Figure:
    """Draw what each mode still rings, over the frequency it has in truth; its damping ratio stays."""
    ratios = np.linspace(*SPAN, RATIOS)
    with paper_style():
        axes = Canvas().one_panel(RESIDUAL_INCHES)
        for pole, colour, dash in zip(shaper.poles, COLOURS, DASHES, strict=False):
            middle = acb(pole.re.mid(), pole.im.mid())
            residuals = [100 * float(shaper.residual(middle * r).mid()) for r in ratios.tolist()]
            axes.plot(ratios, residuals, color=colour, linestyle=dash, label=f"{pole.frequency_hz():.4g} Hz")
        axes.grid(visible=True)
        axes.axhline(TICK, color=COLOURS[-1], linewidth=0.5)
        axes.set_xlim(*SPAN)
        axes.set_ylim(0, None)
        axes.set_xlabel("Frequency over that of the model")
        axes.set_ylabel("Residual vibration [%]")
        add_legend_above(axes, len(DASHES))
        write_title(root_figure(axes), title_lines(f"{shaper.tf}, {shaper.title}", COLUMN_INCHES))
    return root_figure(axes)
