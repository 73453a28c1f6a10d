"""What every figure is asked for, and axes that several kinds share: magnitude over phase, the s plane."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import log10
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import (
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    NullFormatter,
    NullLocator,
    ScalarFormatter,
)

from symflex.errors import refused
from symflex.figures.figure import new_figure
from symflex.figures.style import (
    COLUMN_INCHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    label_of_frequency,
    label_of_unit,
)
from symflex.model import Model

if TYPE_CHECKING:
    from matplotlib.legend import Legend
    from matplotlib.lines import Line2D

    from symflex.loops.clouds import RootCloud
    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import AnyBoundFunction

    CloudsOf = Callable[[AnyBoundFunction, PoleZeroMap], Sequence[RootCloud]]


SHORT_BAND_DECADES: Final = 1.3
NARROW_BAND_DECADES: Final = 0.6  # a narrow band: from f to 4 f there may be one tick of 1, 2 and 5
FARTHEST: Final = 50.0  # times what is shown; numbers beyond a page would overflow in what reads the figure
RIGHT_HALF_PLANE: Final = "#FBEDE4"  # a tint, pale enough for every line on it


# ------------------------------------------------------------------------------------ magnitude over phase


def magnitude_over_phase(width: float, height: float, ratio: float, units: int = 1) -> tuple[Axes, ...]:
    """Return axes of a new figure [inches]: for magnitudes of each unit, ``ratio`` times those for phases."""
    return panels_below(width, height, [ratio] * units + [1])


def panels_below(width: float, height: float, ratios: Sequence[float]) -> tuple[Axes, ...]:
    """Return axes of a new figure [inches], below each other over one axis, with heights in these ratios."""
    figure = new_figure(width, height)
    figure.set_layout_engine("constrained", h_pad=0.02, w_pad=0.03, hspace=0.03)
    panels = tuple(figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0])
    for axes in panels:
        axes.grid(visible=True)
    return panels


def label_magnitudes(axes: Axes, unit: str, *, is_short: bool = False) -> None:
    """Label an axis of magnitudes over one of a unit."""
    label = label_of_unit(unit) or "1" * is_short
    said = f"dB re {label}" if is_short else f"Magnitude [dB, 0 dB = 1 {label}]"
    axes.set_ylabel(said if label else "Magnitude [dB]")


def set_magnitude_ticks(axes: Axes) -> None:
    """Put ticks at round numbers of decibels."""
    axes.yaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 2, 4, 5, 10], min_n_ticks=3))


def set_frequency_axis(axes: Axes, low: float, high: float) -> None:
    """Label a logarithmic axis of frequencies [Hz]."""
    axes.set_xscale("log")
    axes.set_xlim(low, high)
    axes.set_xlabel("Frequency [Hz]")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: label_of_frequency(value)))
    decades = log10(high / low)
    if decades < NARROW_BAND_DECADES:
        axes.xaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10]))
        axes.xaxis.set_major_formatter(ScalarFormatter(useMathText=True))
        axes.xaxis.set_minor_locator(NullLocator())
    elif decades < SHORT_BAND_DECADES:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_minor_formatter(NullFormatter())


def add_legend_above(
    axes: Axes,
    columns: int,
    title: str | None = None,
    *,
    is_tight: bool = False,
    handles: Sequence[Line2D] | None = None,
) -> None:
    """Put a legend over a panel; a tight one has shorter lines and gaps."""
    legend = axes.legend(
        handles=handles,
        title=title,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=columns,
        frameon=False,
        handlelength=2.0 if is_tight else 2.4,
        columnspacing=1.2 if is_tight else 1.4,
        borderaxespad=0.2,
        borderpad=0.1,
    )
    legend.get_title().set(parse_math=False, multialignment="center")


def write_title(figure: Figure, lines: Sequence[str]) -> None:
    """Write the lines of a title over a figure, as they are: nothing in them is mathematics."""
    if lines:
        figure.suptitle("\n".join(lines), fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False)


# ------------------------------------------------------------------------------------------- the s plane


def draw_zero_lines(axes: Axes) -> None:
    """Draw the real and the imaginary axis."""
    axes.axhline(0, color=QUIET, linewidth=0.5, zorder=1)
    axes.axvline(0, color=QUIET, linewidth=0.5, zorder=1)


def label_s_plane(axes: Axes) -> None:
    """Label real and imaginary part of s, with ticks at round numbers."""
    axes.set_xlabel(r"$\mathrm{Re}(s)$ [rad/s]")
    axes.set_ylabel(r"$\mathrm{Im}(s)$ [rad/s]")
    set_round_ticks(axes, 6, 6)


def set_round_ticks(axes: Axes, across: int, upwards: int) -> None:
    """Put at most so many intervals between ticks, at round numbers."""
    for axis, count in ((axes.xaxis, across), (axes.yaxis, upwards)):
        axis.set_major_locator(MaxNLocator(nbins=count, steps=[1, 2, 2.5, 5, 10]))
        axis.set_major_formatter(ScalarFormatter(useMathText=True))


def draw_points(
    axes: Axes,
    points: Sequence[complex],
    look: tuple[str, str, float],
    label: str | None = None,
    *,
    is_cut: bool = True,
) -> None:
    """Draw hollow marks of a shape, colour and size at points of the s plane, cut at its frame or not."""
    shape, colour, size = look
    across, upwards = [s.real for s in points], [s.imag for s in points]
    axes.plot(
        across, upwards, shape, color=colour, markersize=size, markeredgewidth=0.9, markerfacecolor="none",
        clip_on=is_cut, zorder=3, label=label,
    )  # fmt: skip


def point_of(root: Root) -> complex:
    """Return the midpoint of a root's enclosure in double precision."""
    return complex(float(root.re.mid()), float(root.im.mid()))


def drawable(values: npt.NDArray[np.complex128], reach: float) -> npt.NDArray[np.complex128]:
    """Return values with those far outside brought nearer, in their own directions.

    ``reach`` is half the width of what is shown; infinite values become gaps.
    """
    finite = np.where(np.isfinite(values), values, np.nan + 1j * np.nan)
    size = np.abs(finite)
    limit = FARTHEST * reach
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(size > limit, finite / size * limit, finite), np.complex128)


Limits = tuple[float, float]  # the lower and the higher end of an axis
LARGEST = 1e30  # ends of an axis: far below what single precision holds, in which readers of pages compute
NARROWEST = 1e-6  # least length of an axis over its ends: its ticks have six digits


@dataclass(frozen=True, slots=True)
class AxisLimits:
    """Ends of axes in place of those that a figure would choose."""

    # x and y: of the axes across and upwards: real and imaginary part, in an s plane [rad/s]; magnitudes [dB]
    # of a Bode plot upwards, whose frequencies are its band.
    x: Limits | None = None
    y: Limits | None = None
    phase: Limits | None = None  # of a Bode plot [deg]
    has_asymptotes: bool = False  # of a Bode plot
    has_verdict: bool = field(default=False, compare=False)  # says whether what is drawn is stable
    at: tuple[Fraction, ...] = field(default=(), compare=False)  # the frequencies of deflections [Hz]

    def __post_init__(self) -> None:
        for ends in (self.x, self.y, self.phase):
            if ends is None:
                continue
            # Written so that what is not a number is refused too.
            if not -LARGEST <= ends[0] < ends[1] <= LARGEST:
                message = f"an axis runs from a lower to a higher number, not from {ends[0]:g} to {ends[1]:g}"
                raise refused(message)
            if ends[1] - ends[0] < NARROWEST * max(map(abs, ends)):
                raise refused(f"an axis from {ends[0]!r} to {ends[1]!r} is too short to be drawn")


AxesGiven = Axes | Sequence[Axes] | npt.NDArray[np.object_]
"""What a user may give to draw on: as :func:`matplotlib.pyplot.subplots` returns them."""


def axes_of(given: AxesGiven | None) -> tuple[Axes, ...]:
    """Return axes in a row."""
    return () if given is None else tuple(np.ravel(np.asarray(given, dtype=object)))


def root_figure(axes: Axes) -> Figure:
    """Return the figure that axes stand in."""
    figure = axes.get_figure(root=True)
    if figure is None:
        raise refused("these axes belong to no figure")
    return figure


FREE = AxisLimits()  # every axis is as the figure chooses it


@dataclass(frozen=True, slots=True)
class Canvas:
    """What is asked of a figure, whatever its kind."""

    band_hz: Limits | None = None  # frequencies shown [Hz]
    frame: AxisLimits = FREE  # of axes, in place of those that suit what is drawn
    title: str | None = None  # printed as it is
    width: float | None = None  # [inches]; by default what suits the figure
    axes: tuple[Axes, ...] = ()  # to draw on, in place of those of a new figure
    gains: tuple[Fraction | None, Fraction | None] | None = None  # first and last one of a locus
    modes: int | None = None  # traced in the locus of a loop with kernels
    model: Model | None = None  # with all values, of a matrix that is drawn
    clouds: CloudsOf | None = None  # where the poles and zeros of a function may lie

    def own_axes(self, *counts: int) -> tuple[Axes, ...]:
        """Return the axes to draw on, if there are as many as a figure has panels; UsageError: SF902."""
        if len(self.axes) not in counts:
            needed = " or ".join(map(str, counts))
            message = f"this figure has {needed} panel{'s' if needed != '1' else ''}, not {len(self.axes)}"
            raise refused(message, "pass that many axes as ax")
        return self.axes

    def one_panel(self, height: float) -> Axes:
        """Return the only axes, of a new figure [inches] if there are none to draw on."""
        if self.axes:
            return self.own_axes(1)[0]
        figure = new_figure(self.width or COLUMN_INCHES, height)
        figure.set_layout_engine("constrained", h_pad=0.03, w_pad=0.03)
        return figure.subplots()

    def legend(self, axes: Axes, **look: object) -> Legend:
        """Put a legend over axes: outside of them in a new figure, which makes room for it."""
        if self.axes:
            return axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), **look)
        return root_figure(axes).legend(loc="outside upper center", **look)

    def band_of(self, model: Model) -> Limits | None:
        """Return the band asked for, else that of a model [Hz]."""
        band = model.analysis.band
        return self.band_hz or (None if band is None else (float(band[0]), float(band[1])))


Drawing = Callable[["Sequence[AnyBoundFunction]", Canvas], "Figure"]
"""A function that draws transfer functions; :func:`symflex.figures.draw` sets the style."""
