"""Root loci, from proved poles to proved zeros as a gain grows, and Nyquist plots about the point -1."""

from __future__ import annotations

from fractions import Fraction
from itertools import cycle
from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.patches import Circle

from symflex.analysis.response import adaptive_grid, default_band, respond, roots_if_found
from symflex.figures.axes import (
    RIGHT_HALF_PLANE,
    draw_points,
    draw_zero_lines,
    drawable,
    label_s_plane,
    point_of,
    set_round_ticks,
    write_title,
)
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    LINE_INCHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    label_of_name,
    label_of_tf,
    new_figure,
    title_lines,
)
from symflex.roots import Band

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures.axes import Canvas
    from symflex.loops import RootLocus
    from symflex.roots.pole_zero_map import StabilityVerdict
    from symflex.transfer import BoundTransferFunction, TransferFunction


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
            told = f"{label} ({outside if inside else 'all'} outside)" if outside else label
            draw_points(axes, inside, (shape, colour, 3.4 if shape == "s" else 5), told)
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


WIDENED: Final = 10.0
"""How far beyond the band of poles and zeros the curve is drawn, to both sides."""
REACHES: Final = (1.5, 2.5)
"""Half the side of the square shown of a loop gain, about -1."""
OBLONG: Final = 4.0
"""Limits asked for whose ratio exceeds this have a scale each."""
QUANTILE: Final = 0.9
"""Share of the values of a function that is not a loop gain for which the square is made."""
WITHIN: Final = 0.9
"""An arrow stands in so much of what is shown."""
SHAFT: Final = 0.01
"""Length of an arrow without its head, in halves of the square."""


def draw_nyquist(
    tfs: Sequence[TransferFunction],
    bounds: Sequence[BoundTransferFunction],
    canvas: Canvas,
    labels: Sequence[str] = (),
    verdict: str | None = None,
) -> Figure:
    """Draw the values of transfer functions for positive frequencies and, dashed, for negative ones.

    Of a loop gain, which ``labels`` tell apart, the part of the plane about -1 is shown; where a curve leaves
    it, it goes on outside. Arrows point to growing frequency. P is the number of poles of what is drawn in
    the right half plane: a closed loop is stable if the curve winds P times counterclockwise about -1.
    ``verdict`` says below the title whether it is.
    """
    width = canvas.width or COLUMN_INCHES
    lines = [*title_lines(canvas.title, width), *title_lines(verdict, width)]
    figure = new_figure(width, HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    figure.set_layout_engine("constrained", h_pad=0.03, w_pad=0.03)
    axes = figure.subplots()
    draw_zero_lines(axes)
    circle = np.exp(1j * np.linspace(0, 2 * np.pi, 361))
    axes.plot(circle.real, circle.imag, ":", color=QUIET, linewidth=0.7, zorder=1)
    found = [_curve(bound, canvas.band_of(bound.source)) for bound in bounds]
    curves = [curve for curve, _ in found]
    reach = _reach(np.concatenate(curves), is_loop=bool(labels))
    across, upwards = canvas.frame.x or (-reach, reach), canvas.frame.y or (-reach, reach)
    axes.set_xlim(*across)
    axes.set_ylim(*upwards)
    reach = max(map(abs, (*across, *upwards)))
    for i, ((curve, poles), colour) in enumerate(zip(found, cycle(COLOURS), strict=False)):
        values = drawable(curve, reach)
        label = f"{labels[i] if labels else label_of_tf(tfs[i])}, {_open_poles(poles)}"
        axes.plot(values.real, values.imag, "-", color=colour, linewidth=1.0, zorder=2, label=label)
        axes.plot(values.real, -values.imag, "--", color=colour, linewidth=0.6, zorder=2)
    if reach > 1:
        axes.plot([-1], [0], "+", color="black", markersize=8, markeredgewidth=1.1, zorder=4)
    if 1 / OBLONG < (across[1] - across[0]) / (upwards[1] - upwards[0]) < OBLONG:
        axes.set_aspect("equal", adjustable="box")
    for values, colour in zip(curves, cycle(COLOURS), strict=False):
        _point_along(axes, values, colour)
    set_round_ticks(axes, 5, 5)
    axes.set_xlabel("Real part")
    axes.set_ylabel("Imaginary part")
    # A title of the figure would stand over a legend outside of the axes.
    legend = figure.legend(loc="outside upper center", ncols=3, frameon=False, title="\n".join(lines))
    legend.get_title().set(fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False, ha="center")
    return figure


def _open_poles(verdict: StabilityVerdict) -> str:
    """Return P of Nyquist's criterion: how many poles of what is drawn lie in the right half plane.

    Examples
    --------
    >>> from symflex.roots.pole_zero_map import StabilityVerdict
    >>> _open_poles(StabilityVerdict("unstable", 2, True, "", 2))
    '$P = 2$'
    """
    if verdict.right is not None:
        return f"$P = {verdict.right}$"
    return rf"$P \geq {verdict.found}$" if verdict.found else "$P$ not known"


def _curve(
    bound: BoundTransferFunction, band: tuple[float, float] | None
) -> tuple[npt.NDArray[np.complex128], StabilityVerdict]:
    """Return values along the axis, dense where a resonance turns them, and what is known of its poles."""
    if band is None:
        low, high = default_band(roots_if_found(bound))
        low, high = low / WIDENED, high * WIDENED
    else:
        low, high = band
    found = roots_if_found(bound, Band(Fraction(low), Fraction(high)))
    response = respond(bound, adaptive_grid(bound, low, high, roots=found), found)
    values: npt.NDArray[np.complex128] = np.array(response.values, dtype=np.complex128)
    finite: npt.NDArray[np.complex128] = values[np.isfinite(values)]
    return finite, found.verdict


def _reach(values: npt.NDArray[np.complex128], *, is_loop: bool) -> float:
    """Return half the side of a square that shows -1, and most of a curve that is not a loop gain."""
    largest = float(np.max(np.abs(values))) if values.size else 1.0
    if is_loop:
        return min(max(1.1 * largest, REACHES[0]), REACHES[1])
    return 1.1 * float(np.quantile(np.abs(values), QUANTILE)) or 1.0


def _point_along(axes: Axes, values: npt.NDArray[np.complex128], colour: str) -> None:
    """Draw an arrow halfway along the part of a curve that is shown."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    half_width, half_height = (right - left) / 2, (high - low) / 2
    aside = np.abs(values.real - (left + right) / 2) / half_width
    aside = np.maximum(aside, np.abs(values.imag - (low + high) / 2) / half_height)
    shown = np.flatnonzero(aside < WITHIN)
    steps = np.abs(np.diff(values[shown])) if shown.size > 2 else np.array([])  # noqa: PLR2004 (two steps at least)
    if not steps.size or not float(steps.sum()) > 0:
        return
    middle = int(np.searchsorted(np.cumsum(steps), 0.4 * float(steps.sum())))
    i = int(shown[min(middle, shown.size - 2)])
    a, step = values[i], values[min(i + 1, values.size - 1)] - values[i]
    # Its head alone: the next value may be far outside.
    b = a + SHAFT * min(half_width, half_height) * step / abs(step)
    axes.annotate(
        "",
        (b.real, b.imag),
        (a.real, a.imag),
        arrowprops={"arrowstyle": "-|>", "mutation_scale": 9, "linewidth": 0, "color": colour},
    )
