"""Nichols charts: magnitude [dB] over phase [deg], about -1, with contours of the closed loop."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from math import ceil, floor
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from symflex.figures.axes import Canvas
from symflex.figures.loops import AxisCurve, draw_curves, point_along
from symflex.figures.style import COLOURS, QUIET
from symflex.loops import AnyLoop
from symflex.transfer import AnyBoundFunction

CLOSED_DB: Final = (12, 6, 3, 1, 0, -1, -3, -6, -12, -20)  # of L/(1 + L), with a contour each
BESIDE: Final = 10  # least distance of a curve from the border [deg]
REACH_DB, WIDEST = 40, 1080  # magnitudes [dB] and phases [deg] shown at most, unless others are asked for


def draw_nichols(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw magnitudes of transfer functions over their phases, as :func:`draw_nyquist` draws values."""
    return draw_curves(bounds, canvas, _draw_chart)


def draw_loop_phase(loop: AnyLoop, canvas: Canvas) -> Figure:
    """Draw the magnitude of a loop gain over its phase; contours give the closed loop's magnitude."""
    return draw_curves(loop, canvas, _draw_chart)


def _draw_chart(
    axes: Axes, curves: list[AxisCurve], labels: list[str], canvas: Canvas, is_loop: bool
) -> None:
    charts = [_phases_and_levels(curve.values) for curve in curves]
    shown = np.concatenate(charts)
    phases = shown.real[np.abs(shown.imag) <= REACH_DB]
    high = 90 * ceil(float(phases.max(initial=-90) + BESIDE) / 90)
    low = max(90 * floor(float(phases.min(initial=-180) - BESIDE) / 90), high - WIDEST)
    bottom = max(-REACH_DB, 10 * floor(float(shown.imag.min(initial=-20)) / 10))
    top = min(REACH_DB, 10 * ceil(float(shown.imag.max(initial=20)) / 10))
    axes.set_xlim(*(canvas.frame.x or (low, high)))
    axes.set_ylim(*(canvas.frame.y or (bottom, top)))
    (left, right), (lowest, highest) = axes.get_xlim(), axes.get_ylim()
    turns, last = range(floor(left / 360), ceil(right / 360) + 1), floor((right + 179) / 360)
    for level in CLOSED_DB:
        contour = _contour(level)
        for turn in turns:
            phase = contour.real + 360 * turn
            axes.plot(*_held(phase + 1j * contour.imag, axes), color=QUIET, linewidth=0.3, zorder=1)
            inside = (
                (phase > left) & (phase < right) & (contour.imag > lowest) & (contour.imag < 0.95 * highest)
            )
            if inside.any() and turn == last:
                places = np.flatnonzero(inside)
                # At the top of closed contours, else at the border.
                i = places[np.argmax(contour.imag[places] if level > 0 else phase[places])]
                side = "center" if level > 0 else "right"
                note = axes.annotate(f"${level}$ dB", (phase[i], contour.imag[i]), fontsize=6, ha=side)
                note.set(color=QUIET, va="center", zorder=1.5, bbox={"fc": "white", "ec": "none", "pad": 0.4})
    for centre in (360 * turn - 180 for turn in turns if left <= 360 * turn - 180 <= right):
        axes.plot([centre], [0], "+", color="black", markersize=8, markeredgewidth=1.1, zorder=4)
    for chart, label, colour in zip(charts, labels, cycle(COLOURS), strict=False):
        axes.plot(*_held(chart, axes), "-", color=colour, linewidth=1.0, zorder=2, label=label)
        point_along(axes, chart, colour)
    axes.xaxis.set_major_locator(MultipleLocator(45 * ceil((right - left) / 360)))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 2, 5, 10]))
    axes.set_xlabel("Phase [deg]")
    axes.set_ylabel("Magnitude [dB]")


def _held(chart: npt.NDArray[np.complex128], axes: Axes) -> list[npt.NDArray[np.float64]]:
    """Return phases and levels, those outside of what axes show brought next to it."""
    ends = ((chart.real, *axes.get_xlim()), (chart.imag, *axes.get_ylim()))
    return [np.clip(x, low - 0.05 * (high - low), high + 0.05 * (high - low)) for x, low, high in ends]


def _phases_and_levels(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return phases [deg] plus j times levels [dB]; the first phase is from -270 to 90 degrees."""
    values = values[(np.abs(values) > 0) & np.isfinite(values)]
    angles = np.angle(values, deg=True)
    steps = (np.diff(angles) + 180.1) % 360 - 180.1  # of half a turn, at a pole without damping, downwards
    phases = np.cumsum(np.concatenate((angles[:1], steps)))
    if phases.size:
        phases -= 360 * ceil((phases[0] - 90) / 360)
    return np.asarray(phases + 20j * np.log10(np.abs(values)), np.complex128)


def _contour(level: float) -> npt.NDArray[np.complex128]:
    """Return where ``L/(1 + L)`` has a magnitude, as phases from -360 degrees and levels."""
    closed = 10 ** (level / 20) * np.exp(1j * np.linspace(1e-3, 2 * np.pi - 1e-3, 721))
    gain = closed / (1 - closed)
    phases = np.degrees(np.angle(gain)) % 360 - 360
    return np.asarray(phases + 20j * np.log10(np.abs(gain)), np.complex128)
