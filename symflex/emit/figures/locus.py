"""Root loci: where closed-loop poles go as a gain grows, from proved poles to proved zeros."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.ticker import MaxNLocator

from symflex.emit.figures.curves import drawable
from symflex.emit.figures.labels import label_of_name
from symflex.emit.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    new_figure,
    title_lines,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.roots import Root
    from symflex.stability import RootLocus

HEIGHT_INCHES: Final = 3.3
LINE_INCHES: Final = 0.13
ROOM: Final = 1.12
ZERO_REACH: Final = 1.6
"""Zeros are shown up to so many times the largest pole."""
CLOSE: Final = 0.3
"""Narrowest width shown, over the height."""


def draw_locus(locus: RootLocus, title: str | None = None, width: float | None = None) -> Figure:
    """Draw a root locus.

    Crosses are the poles at the first gain, squares those at the last, circles the zeros; all three are
    proved. The lines between are traced numerically. Right of the imaginary axis the ground is tinted.
    """
    width = width or COLUMN_INCHES
    lines = title_lines(title, width)
    figure = new_figure(width, HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    figure.set_layout_engine("constrained", h_pad=0.03, w_pad=0.03)
    axes = figure.subplots()
    starts, ends, zeros = (
        [_point(root) for root in roots] for roots in (locus.start.poles, locus.end.poles, locus.start.zeros)
    )
    _set_view(axes, locus, starts, zeros)
    right, seen = max(axes.get_xlim()[1], 0.0), float(np.max(np.abs([axes.get_xlim(), axes.get_ylim()])))
    axes.axvspan(0, right, color="#FBEDE4", zorder=0, linewidth=0)
    for value, draw in ((0, axes.axhline), (0, axes.axvline)):
        draw(value, color=QUIET, linewidth=0.5, zorder=1)
    for branch in locus.branches:
        s = drawable(np.array(branch), seen)
        axes.plot(s.real, s.imag, "-", color=COLOURS[0], linewidth=1.0, zorder=2)
    low, high = (number_label(float(x)) for x in locus.limits)
    name = label_of_name(locus.gain)
    marks = (
        (starts, "x", COLOURS[1], f"poles, ${name} = {low}$"),
        (ends, "s", COLOURS[0], f"poles, ${name} = {high}$"),
        (zeros, "o", COLOURS[2], "zeros"),
    )
    for points, shape, colour, label in marks:
        if points:
            axes.plot(
                [s.real for s in points],
                [s.imag for s in points],
                shape,
                color=colour,
                markersize=3.4 if shape == "s" else 5,
                markeredgewidth=0.9,
                markerfacecolor="none",
                zorder=3,
                label=label,
            )
    axes.set_xlabel(r"$\mathrm{Re}(s)$ [rad/s]")
    axes.set_ylabel(r"$\mathrm{Im}(s)$ [rad/s]")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 2.5, 5, 10]))
    figure.legend(loc="outside upper center", ncols=3, frameon=False, handletextpad=0.2, columnspacing=1.0)
    if lines:
        figure.suptitle("\n".join(lines), fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False)
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


def _set_view(axes: Axes, locus: RootLocus, starts: list[complex], zeros: list[complex]) -> None:
    """Show all poles traced, and the zeros not much further out."""
    traced = [s for branch in locus.branches for s in branch]
    size = max((abs(s) for s in starts), default=1.0) or max((abs(s) for s in traced), default=1.0) or 1.0
    near = [s for s in (*traced, *zeros) if abs(s) <= ZERO_REACH * size]
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


def _point(root: Root) -> complex:
    return complex(float(root.re.mid()), float(root.im.mid()))
