"""Charts of stability: shaded regions with counts of unstable poles, and the curves between them."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from symflex.contact.over import PassiveChart
from symflex.figures.axes import Canvas, root_figure, set_round_ticks
from symflex.figures.style import COLOURS, QUIET, label_with_unit
from symflex.loops.chart import StabilityChart, word_of
from symflex.loops.stability_map import StabilityMap

STABLE: Final = "#DDEBF5"  # a tint, pale enough for every line on it
HEIGHT_INCHES: Final = 2.9
STRIP_INCHES: Final = 1.7
LEGIBLE: Final = 0.01  # least share of the area of a region in which its count stands
MOST_PIXELS: Final = 1024


def draw_stability(
    stability: StabilityChart | StabilityMap | PassiveChart, canvas: Canvas, *, with_box: bool = False
) -> Figure:
    """Draw for which values of two parameters a model is stable, or passive, or the unstable poles over one.

    What is undecided is grey, a star marks the declared values, dashes the largest box about them. Passive
    values are lines, one at each value of the second parameter at which they are proved.
    """
    axes = canvas.one_panel(STRIP_INCHES if isinstance(stability, StabilityMap) else HEIGHT_INCHES)
    if isinstance(stability, StabilityChart):
        _draw_chart(stability, axes, with_box=with_box)
    elif isinstance(stability, PassiveChart):
        _draw_passive(stability, axes)
    else:
        _draw_counts(stability.shown, axes)
    return root_figure(axes)


def _draw_chart(chart: StabilityChart, axes: Axes, *, with_box: bool) -> None:
    (unit, size), (other_unit, other_size) = chart.counted_in
    sizes = np.array([float(size), float(other_size)])
    (left, low), (right, high) = np.array(chart.ranges, dtype=float).T / sizes
    step = max(1, len(chart.cells) // MOST_PIXELS)
    cells = np.pad(chart.cells[step // 2 :: step, step // 2 :: step].T, 1, mode="edge")
    middles = (np.arange(len(cells)) - 0.5) / (len(cells) - 2)
    x, y = left + (right - left) * middles, low + (high - low) * middles
    is_stable = np.array([*(r.verdict.word == "stable" for r in chart.regions), False])
    for shown, colour in ((is_stable[cells], STABLE), (cells < 0, QUIET)):
        if shown.any():
            axes.contourf(x, y, shown.astype(float), levels=(0.5, 1.5), colors=[colour], zorder=1)
    for curve in chart.boundaries:
        across, upwards = np.array(curve)[:, :2].T / sizes[:, None]
        axes.plot(across, upwards, "-", color=COLOURS[0], linewidth=1.1, zorder=3)
    for region in chart.regions:
        if region.share >= LEGIBLE:
            count = region.verdict.right
            said = f"{count} unstable" if count else word_of(region.verdict)
            at = np.array(region.point, dtype=float) / sizes
            # Above its point, at which the star of the declared values may stand.
            note = axes.annotate(said, at, (0, 5), textcoords="offset points", ha="center", fontsize=7)
            note.set(zorder=4, clip_on=True)
    a, b = chart.nominal
    if a is not None and b is not None:
        axes.plot([float(a / size)], [float(b / other_size)], "*", color="black", markersize=6, zorder=5)
    if with_box and (box := chart.largest_box()):
        (a0, b0), (a1, b1) = np.array(box, dtype=float).T / sizes
        axes.add_patch(
            Rectangle((a0, b0), a1 - a0, b1 - b0, fill=False, linestyle="--", linewidth=0.8, zorder=4)
        )
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    set_round_ticks(axes, 6, 6)
    axes.set_xlabel(label_with_unit(chart.names[0], unit))
    axes.set_ylabel(label_with_unit(chart.names[1], other_unit))


def _draw_passive(chart: PassiveChart, axes: Axes) -> None:
    """Draw the passive values of the first parameter at each value of the second, their ends as dots."""
    first = chart.slices[0][1]
    (unit, size), (other_unit, other_size) = first.parameter.counted_in, chart.other.counted_in
    left, right = (float(x / size) for x in first.limits)
    for value, values in chart.slices:
        height = float(value / other_size)
        for interval in values.passive:
            ends = [float(x.mid()) / float(size) for x in (interval.low, interval.high)]
            axes.plot(ends, [height] * 2, "-", color=STABLE, linewidth=4, solid_capstyle="butt", zorder=1)
            inside = [x for x in ends if left < x < right]
            axes.plot(inside, [height] * len(inside), ".", color=COLOURS[0], markersize=4, zorder=3)
    axes.set_xlim(left, right)
    axes.set_ylim(*(float(chart.slices[i][0] / other_size) for i in (0, -1)))
    set_round_ticks(axes, 6, 6)
    axes.set_xlabel(label_with_unit(first.parameter.name, unit))
    axes.set_ylabel(label_with_unit(chart.other.name, other_unit))


def _draw_counts(stability: StabilityMap, axes: Axes) -> None:
    ends = [float(x) for x in stability.limits if x is not None]
    for interval in stability.intervals:
        a, b = (float(x.mid()) if x is not None else ends[-1] for x in (interval.low, interval.high))
        axes.plot([a, b], [interval.poles.right] * 2, "-", color=COLOURS[0], linewidth=1.6, zorder=3)
        if not interval.poles.right and not interval.poles.axis:
            axes.axvspan(a, b, color=STABLE, linewidth=0, zorder=0)
    for boundary in stability.boundaries:
        at = float(boundary.gain.mid())
        axes.axvline(at, color=QUIET, linewidth=0.6, zorder=1)
        said = ", ".join(f"{float(w.mid()) / (2 * np.pi):.4g} Hz" for w in boundary.frequencies)
        note = axes.annotate(said, (at, 0.45), (1, 0), ("data", "axes fraction"), "offset points")
        note.set(rotation=90, fontsize=6, va="center", ha="left")
    axes.set_xlim(*ends)
    most = max((interval.poles.right for interval in stability.intervals), default=0)
    axes.set_ylim(-0.25, max(most, 2) + 0.5)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel(label_with_unit(stability.gain, stability.unit))
    axes.set_ylabel("unstable poles")
