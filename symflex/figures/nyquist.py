"""Nyquist plots: a transfer function along the imaginary axis, and the point -1."""

from __future__ import annotations

from fractions import Fraction
from itertools import cycle
from typing import TYPE_CHECKING, Final

import numpy as np

from symflex.analysis.response import adaptive_grid, default_band, respond, roots_if_found
from symflex.figures.axes import draw_zero_lines, drawable, set_round_ticks
from symflex.figures.labels import label_of_tf
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    LINE_INCHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    new_figure,
    title_lines,
)
from symflex.roots import Band

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures.drawing import Canvas
    from symflex.roots.verdict import StabilityVerdict
    from symflex.transfer import BoundTransferFunction, TransferFunction

HEIGHT_INCHES: Final = 3.3
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
    found = [_curve(bound, canvas.band_hz) for bound in bounds]
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
    >>> from symflex.roots.verdict import StabilityVerdict
    >>> _open_poles(StabilityVerdict("unstable", 2, True, "", 2))
    '$P = 2$'
    """
    if verdict.right is not None:
        return f"$P = {verdict.right}$"
    return rf"$P \geq {verdict.found}$" if verdict.found else "$P$ not known"


def _curve(
    bound: BoundTransferFunction, band_hz: tuple[float, float] | None
) -> tuple[npt.NDArray[np.complex128], StabilityVerdict]:
    """Return values along the axis, dense where a resonance turns them, and what is known of its poles."""
    band = bound.source.model.analysis.band
    given = band_hz or (None if band is None else (float(band[0]), float(band[1])))
    if given is None:
        low, high = default_band(roots_if_found(bound))
        low, high = low / WIDENED, high * WIDENED
    else:
        low, high = given
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
    steps = np.abs(np.diff(values[shown])) if shown.size > 2 else np.array([])  # noqa: PLR2004
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
