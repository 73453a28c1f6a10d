"""Root loci: where closed-loop poles go as a gain grows, from proved poles to proved zeros."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.patches import Circle

from symflex.figures.axes import (
    RIGHT_HALF_PLANE,
    draw_zero_lines,
    drawable,
    label_s_plane,
    point_of,
    write_title,
)
from symflex.figures.labels import label_of_name
from symflex.figures.style import COLOURS, COLUMN_INCHES, LINE_INCHES, QUIET, new_figure, title_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures.drawing import Canvas
    from symflex.loops import RootLocus

HEIGHT_INCHES: Final = 3.3
ROOM: Final = 1.12
ZERO_REACH: Final = 1.6
"""Zeros are shown up to so many times the largest pole."""
END_REACH: Final = 10.0
"""Poles that run away are shown at the last gain up to so many times the largest at the first."""
LEGEND_LETTERS: Final = 18.0
"""So many letters of three labels have room in a line, per inch."""
CLOSE: Final = 0.3
"""Narrowest width shown, over the height."""


def draw_locus(locus: RootLocus, canvas: Canvas) -> Figure:
    """Draw a root locus, of what lies up to the end of a band, or within limits.

    Crosses are the poles at the first gain, squares those at the last, circles the zeros; all three are
    proved. The lines between are traced numerically: solid from poles at the first gain, dashed from
    infinity, dotted from where none is marked. The legend says how many of each lie outside. Grey circles
    surround points at which poles accumulate. Right of the imaginary axis the ground is tinted. Poles there
    are among those marked wherever they lie, and the title says how many there are at both gains.
    """
    width = canvas.width or COLUMN_INCHES
    reach = None if canvas.band_hz is None else 2 * pi * canvas.band_hz[1]
    lines = title_lines(canvas.title, width)
    figure = new_figure(width, HEIGHT_INCHES + LINE_INCHES * (len(lines) + 3))
    figure.set_layout_engine("constrained", h_pad=0.03, w_pad=0.03)
    axes = figure.subplots()
    starts, zeros = (
        [point_of(root) for root in roots] for roots in (locus.start.all_poles, locus.start.zeros)
    )
    ends = list(locus.ends)
    _set_view(axes, locus, starts, zeros, reach)
    axes.set_xlim(*(canvas.frame.x or axes.get_xlim()))
    axes.set_ylim(*(canvas.frame.y or axes.get_ylim()))
    right, seen = max(axes.get_xlim()[1], 0.0), float(np.max(np.abs([axes.get_xlim(), axes.get_ylim()])))
    axes.axvspan(0, right, color=RIGHT_HALF_PLANE, zorder=0, linewidth=0)
    draw_zero_lines(axes)
    low, high = (number_label(float(x)) for x in locus.limits)
    name = label_of_name(locus.gain)
    marks = (
        (starts, "x", COLOURS[1], f"poles, ${name} = {low}$"),
        (ends, "s", COLOURS[0], f"poles, ${name} = {high}$"),
        (zeros, "o", COLOURS[2], "zeros"),
    )
    for points, shape, colour, label in marks:
        inside = [s for s in points if _is_seen(axes, s)]
        # Infinitely many zeros have no number that those listed could tell.
        outside = 0 if points is zeros and locus.start.is_infinite else len(points) - len(inside)
        if inside or (points and points is not zeros):
            axes.plot(
                [s.real for s in inside],
                [s.imag for s in inside],
                shape,
                color=colour,
                markersize=3.4 if shape == "s" else 5,
                markeredgewidth=0.9,
                markerfacecolor="none",
                zorder=3,
                label=f"{label} ({outside if inside else 'all'} outside)" if outside else label,
            )
    kinds = (
        (locus.branches, "-", None),
        (locus.entering, "--", "poles from infinity"),
        (locus.joining, ":", "from poles not marked"),
    )
    for branches, line, legend in kinds:
        shown = [b for b in branches if any(_is_seen(axes, s) for s in b)]
        for i, branch in enumerate(shown):
            s = drawable(np.array(branch), seen)
            axes.plot(
                s.real, s.imag, line, color=COLOURS[0], linewidth=1.0, zorder=2, label=None if i else legend
            )
    _draw_holes(axes, locus)
    label_s_plane(axes)
    verdicts = (locus.start.verdict.headline, locus.end.verdict.headline)
    said = [f"${name} = {gain}$, {verdict}" for gain, verdict in zip((low, high), verdicts, strict=True)]
    letters = sum(len(str(label).replace("$", "")) for label in axes.get_legend_handles_labels()[1])
    figure.legend(
        title="\n".join(said),
        loc="outside upper center",
        ncols=3 if letters <= LEGEND_LETTERS * width else 2,
        frameon=False,
        handletextpad=0.2,
        columnspacing=1.0,
    )
    write_title(figure, lines)
    return figure


def number_label(value: float) -> str:
    r"""Return a number in four digits in matplotlib's mathematics.

    Examples
    --------
    >>> number_label(25.0), number_label(1e6), number_label(2.5e-7)
    ('25', '10^{6}', '2.5\\times 10^{-7}')
    """
    text = f"{value:.4g}"
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    power = f"10^{{{int(exponent)}}}"
    return power if mantissa == "1" else rf"{mantissa}\times {power}"


def _set_view(
    axes: Axes, locus: RootLocus, starts: list[complex], zeros: list[complex], reach: float | None
) -> None:
    """Show all poles at both gains but those that run far away, and the zeros not much further out."""
    entered = [branch[-1] for branch in (*locus.entering, *locus.joining) if branch]
    size = max((abs(s) for s in (*starts, *entered)), default=0.0)
    size = size or max((abs(s) for s in (*locus.ends, *zeros)), default=1.0) or 1.0
    held = [*starts, *(s for s in locus.ends if abs(s) <= END_REACH * size)]
    size = max(map(abs, held), default=size) or size
    traced = [s for branch in locus.branches for s in branch]
    near = [*held, *(s for s in (*traced, *zeros) if abs(s) <= ZERO_REACH * size)]
    if reach is not None:
        size, near = reach, [s for s in (*starts, *locus.ends, *traced, *zeros) if abs(s) <= reach]
        near.append(reach * 1j)
    high = ROOM * max((abs(s.imag) for s in near), default=size) or size
    left = min((s.real for s in near), default=0.0)
    right = max((s.real for s in near), default=0.0)
    left, right = min(left, 0.0), max(right, 0.0)
    missing = CLOSE * 2 * high - (right - left)
    if missing > 0:
        left, right = left - 0.6 * missing, right + 0.4 * missing
    margin = 0.06 * (right - left)
    axes.set_xlim(left - margin, right + margin)
    axes.set_ylim(-high, high)


def _is_seen(axes: Axes, s: complex) -> bool:
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    return left <= s.real <= right and low <= s.imag <= high


def _draw_holes(axes: Axes, locus: RootLocus) -> None:
    """Draw what was not searched, as poles accumulate there."""
    holes = {(hole.re, side * hole.im, hole.radius) for hole in locus.end.excluded for side in (1, -1)}
    label = "poles accumulate"
    for re, im, radius in sorted(holes):
        if _is_seen(axes, complex(re, im)):
            axes.add_patch(
                Circle((re, im), radius, fill=False, edgecolor=QUIET, linewidth=0.8, zorder=1.5, label=label)
            )
            label = ""
