"""The real part of a driving-point function over frequency, with the bands in which it is negative."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from symflex.analysis.response import default_band, grid_about
from symflex.contact.lossless import without_ladder
from symflex.contact.real_part import real_part
from symflex.errors import Diagnostic, UncertifiedError
from symflex.figures.axes import Canvas, root_figure, set_frequency_axis, write_title
from symflex.figures.style import COLOURS, COLUMN_INCHES, LINE_INCHES, QUIET, title_lines
from symflex.roots import Band
from symflex.roots.locate import locate
from symflex.transfer import AnyBoundFunction

HEIGHT_INCHES: Final = 2.2
DIGITS: Final = 6  # of the ends of bands
SHADE: Final = 0.25
ROOM: Final = 2.0  # by what factor the ends of bands are inside of the frequencies shown


def draw_passivity(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the real part of one function over frequency; bands in which it is negative are shaded."""
    bound, width = bounds[0], canvas.width or COLUMN_INCHES
    if not bound.is_reduced:
        message = "the real part of a network that is not written out is not known"
        raise UncertifiedError(Diagnostic("SF802", message))
    lines = title_lines(canvas.title, width)
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    bands = [
        (float(b.low.mid()) / (2 * np.pi), None if b.high is None else float(b.high.mid()) / (2 * np.pi))
        for b in real_part(without_ladder(bound), DIGITS).active
    ]
    low, high = canvas.band_of(bound.source.model) or _with_bands(default_band(locate(bound)), bands)

    def values(omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
        return np.array([bound(1j * w) for w in omega.tolist()], dtype=np.complex128)

    omega = grid_about(locate(bound, Band(Fraction(low), Fraction(high))), values, low, high)
    found = values(omega).real
    kept = np.isfinite(found)
    axes.axhline(0, color=QUIET, linewidth=0.5, zorder=1)
    for start, end in bands:
        shown = max(start, low), high if end is None else min(end, high)
        axes.axvspan(*shown, color=COLOURS[1], alpha=SHADE, linewidth=0, zorder=0)
    axes.plot(omega[kept] / (2 * np.pi), found[kept], color=COLOURS[0], zorder=2)
    if canvas.frame.y:
        axes.set_ylim(*canvas.frame.y)
    set_frequency_axis(axes, *(canvas.frame.x or (low, high)))
    axes.grid(visible=True)
    axes.set_ylabel(f"Real part [{bound.source.unit}]" if bound.source.unit else "Real part")
    if not canvas.axes:
        write_title(root_figure(axes), lines)
    return root_figure(axes)


def _with_bands(
    shown: tuple[float, float], bands: Sequence[tuple[float, float | None]]
) -> tuple[float, float]:
    """Return frequencies that hold the ends of all bands, too."""
    ends = [x for band in bands for x in band if x]
    return min([shown[0], *(x / ROOM for x in ends)]), max([shown[1], *(x * ROOM for x in ends)])
