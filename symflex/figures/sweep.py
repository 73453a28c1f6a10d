"""Sweeps: modes over a parameter, loci in the s plane, bands of drawn responses."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from symflex.errors import Diagnostic, ModelError
from symflex.figures.axes import (
    RIGHT_HALF_PLANE,
    Canvas,
    axes_of,
    label_s_plane,
    root_figure,
    set_frequency_axis,
    write_title,
)
from symflex.figures.figure import new_figure
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    DASHES,
    DEFAULT_FONT,
    LINE_INCHES,
    MM_PER_INCH,
    QUIET,
    label_of_frequency,
    label_of_name,
    label_with_unit,
    number_label,
    paper_style,
    title_lines,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

    from symflex.figures.axes import AxesGiven
    from symflex.sweep import Labelled, Sweep

    Doubles = npt.NDArray[np.float64]
    Panel = Callable[[Axes], None]
    Family = tuple[Labelled, int]  # the parameter that lines run along, and its axis

PANEL_INCHES: Final = 2.1
DECADES: Final = 15.0  # values that span more than this factor stand on a logarithmic axis
BAND: Final = (5, 95)
MEDIAN: Final = 50
THREE_DIGITS: Final = 1e3
PLAIN: Final = 1e5  # numbers from here on are written with a power of ten
FEW_DECADES: Final = 300.0  # largest range whose decades are divided
OVERDAMPED: Final = 1.5  # real roots are shown as far to the left as so many times the highest imaginary part
UNDAMPED: Final = 1e-12
MARKS: Final = 40
FEW_LINES: Final = 12  # lines per mode that are distinguished by how pale they are
PALEST: Final = 0.3
CROWD: Final = 4000  # points of a cloud beyond which marks become dots


def draw_sweep(
    sweep: Sweep,
    *,
    modes: int | None = None,
    title: str | None = None,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
    ax: AxesGiven | None = None,
) -> Figure:
    """Draw a sweep of modes, up to ``modes`` of them, of a response or of margins.

    Over one parameter: a line for each mode, and loci coloured by the parameter; at a few values of others, a
    line for each of these. Otherwise, and of draws: medians and what holds 90 % of the points. On ``ax`` it
    is drawn in the user's style. Raises ModelError: SF402 there is nothing to draw; UsageError: SF902 wrong
    ``ax``.
    """
    panels = _panels(sweep, modes)
    if ax is not None:
        panel_axes = Canvas(axes=axes_of(ax)).own_axes(len(panels))
        for axes, panel in zip(panel_axes, panels, strict=True):
            panel(axes)
        return root_figure(panel_axes[0])
    with paper_style(font):
        width = width_mm / MM_PER_INCH if width_mm else COLUMN_INCHES
        lines = title_lines(sweep.attribute("title") if title is None else title, width)
        figure = new_figure(width, PANEL_INCHES * len(panels) + 0.3 + LINE_INCHES * len(lines))
        figure.set_layout_engine("constrained", h_pad=0.03, w_pad=0.03)
        every = figure.subplots(len(panels), squeeze=False)[:, 0]
        for axes, panel in zip(every, panels, strict=True):
            panel(axes)
        write_title(figure, lines)
        return figure


def _panels(sweep: Sweep, modes: int | None) -> list[Panel]:
    """Return what draws the panels of a sweep."""
    family = _family(sweep)
    line = family[0] if family and len(sweep["point_status"].shape) == 1 else None
    if sweep.of == "response" and np.isfinite(sweep["re"]).any():
        return [partial(_magnitude_lines, sweep, line) if line else partial(_magnitude_band, sweep)]
    if sweep.of == "margins":
        shown = [name for name in MARGIN_LABELS if np.isfinite(sweep[name]).any()]
        if shown:
            return [
                partial(_margin_line, sweep, n, line) if line else partial(_margins, sweep, n) for n in shown
            ]
    elif sweep.of != "response" and (there := sweep["status"][..., :modes] > 0).any():
        is_damped = np.max(np.abs(sweep["damping_ratio"][..., :modes][there])) > UNDAMPED
        first = partial(_mode_lines, sweep, modes, family, "frequency_hz") if family else None
        found: list[Panel] = [first or partial(_frequency_bands, sweep, modes)]
        if family and is_damped:
            found.append(partial(_mode_lines, sweep, modes, family, "damping_ratio"))
        return [*found, partial(_loci, sweep, modes, line)] if is_damped else found
    raise ModelError(Diagnostic("SF402", "the sweep found nothing that could be drawn"))


def _family(sweep: Sweep) -> Family | None:
    """Return the parameter that lines run along, and its axis: the others, if any, have few values."""
    shape = sweep["point_status"].shape
    if any(p.dims == ("draw",) for p in sweep.shown) or len(sweep.shown) != len(shape):
        return None
    axis = int(np.argmax(shape))
    if np.prod(shape) > FEW_LINES * shape[axis]:
        return None
    return next(p for p in sweep.shown if p.dims == (_dims(sweep)[axis],)), axis


def _dims(sweep: Sweep) -> tuple[str, ...]:
    return next(v.dims for v in sweep.variables if v.name == "point_status")


def _others(sweep: Sweep, parameter: Labelled) -> str:
    """Say what tells the lines of a family apart."""
    others = [p for p in sweep.shown if p.name != parameter.name and p.values.size > 1]
    ends = [(label_with_unit(p.name, p.unit), _short(p.values[0]), _short(p.values[-1])) for p in others]
    shown = [f"{label}: {low} to {high}" for label, low, high in ends]
    return "pale to full, " + "; ".join(shown) if shown else ""


def _spans_decades(values: Doubles) -> bool:
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0 and finite.max() > DECADES * finite.min())


def _is_evenly_spaced(values: Doubles) -> bool:
    """Tell whether values are those of a linear design, which a logarithmic axis would crowd at its end."""
    steps = np.diff(np.unique(values[np.isfinite(values)]))
    return steps.size > 1 and bool(np.allclose(steps, steps[0], rtol=1e-6, atol=0.0))


def _set_parameter_axis(axes: Axes, parameter: Labelled) -> None:
    axes.set_xlabel(label_with_unit(parameter.name, parameter.unit))
    if parameter.values.size > 1:
        axes.set_xlim(float(parameter.values.min()), float(parameter.values.max()))
    if _spans_decades(parameter.values) and not _is_evenly_spaced(parameter.values):
        axes.set_xscale("log")
        _set_plain_ticks(axes.xaxis)
    axes.grid(visible=True)


def _set_plain_ticks(axis: Axis) -> None:
    """Write the decades of a logarithmic axis alone; where there are few, two numbers in between."""
    low, high = axis.get_view_interval()
    few = 0 < low and high < FEW_DECADES * low
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,), numticks=8))
    axis.set_major_formatter(FuncFormatter(lambda value, _: label_of_frequency(value)))
    axis.set_minor_formatter(NullFormatter())


MODE_LABELS: Final = {"frequency_hz": "natural frequency [Hz]", "damping_ratio": "damping ratio"}


def _mode_lines(sweep: Sweep, modes: int | None, family: Family, name: str, axes: Axes) -> None:
    """Draw a quantity of all modes over a parameter."""
    parameter, axis = family
    values = np.moveaxis(sweep[name][..., :modes], axis, 0)
    values = values.reshape(parameter.values.size, -1, values.shape[-1])
    mark = "." if parameter.values.size <= MARKS else "None"
    order = np.argsort(parameter.values, kind="stable")
    across, values = parameter.values[order], values[order]
    members = values.shape[1]
    axes.set_title(_others(sweep, parameter), fontsize=7, loc="right", pad=2)
    for k in range(values.shape[-1]):
        style = DASHES[(k // len(COLOURS)) % len(DASHES)]
        colour = COLOURS[k % len(COLOURS)]
        for member in range(members):
            (line,) = axes.plot(across, values[:, member, k], color=colour, linestyle=style, linewidth=1.0)
            line.set(marker=mark, markersize=2.5)
            line.set_alpha(1.0 if members == 1 else PALEST + (1 - PALEST) * member / (members - 1))
        there = np.nonzero(np.isfinite(values[:, -1, k]))[0]
        if there.size:
            end = (float(across[there[-1]]), float(values[there[-1], -1, k]))
            note = axes.annotate(str(k + 1), end, (2, 0), textcoords="offset points", fontsize=6)
            note.set_color(colour)
            note.set_verticalalignment("center")
            note.set_annotation_clip(False)
    _set_parameter_axis(axes, parameter)
    if _spans_decades(values):
        axes.set_yscale("log")
        _set_plain_ticks(axes.yaxis)
    elif name == "frequency_hz":
        axes.set_ylim(bottom=0)
    axes.set_ylabel(MODE_LABELS[name])


def _frequency_bands(sweep: Sweep, modes: int | None, axes: Axes) -> None:
    """Draw how far each mode's frequency spreads about its median [%]."""
    values = sweep["frequency_hz"].reshape(-1, sweep["frequency_hz"].shape[-1])[:, :modes]
    labels: list[str] = []
    for k in range(values.shape[1]):
        finite = values[np.isfinite(values[:, k]), k]
        if not finite.size or not np.median(finite):
            continue
        median = float(np.median(finite))
        low, high = np.percentile(finite, BAND)
        spread = [100 * (x / median - 1) for x in (finite.min(), low, high, finite.max())]
        at = len(labels)
        axes.plot([at, at], [spread[0], spread[3]], "-", color=QUIET, linewidth=0.8, zorder=2)
        axes.plot([at, at], [spread[1], spread[2]], "-", color=COLOURS[0], linewidth=4, zorder=3)
        axes.plot([at], [0], "_", color="black", markersize=6, markeredgewidth=0.8, zorder=4)
        labels.append(f"{k + 1}\n{_short(median)}")
    axes.set_xticks(range(len(labels)), labels)
    axes.set_xlabel("mode, median of its natural frequency [Hz]")
    axes.set_ylabel("spread [%]")
    axes.set_xlim(-0.6, len(labels) - 0.4)
    axes.grid(visible=True, axis="y")
    axes.set_title("bars: 5 to 95 %, lines: all", fontsize=7, loc="right", pad=2)


def _short(value: float) -> str:
    if value < PLAIN:
        return f"{value:.3g}" if value < THREE_DIGITS else f"{value:.0f}"
    return f"${number_label(float(f'{value:.1e}'))}$"


def _colours(values: Doubles) -> tuple[Normalize, Colormap]:
    low, high = float(np.min(values)), float(np.max(values))
    is_log = _spans_decades(values) and not _is_evenly_spaced(values)
    norm = LogNorm(low, high) if is_log else Normalize(low, high)
    # The yellow at the end of the map is too pale for a line.
    return norm, ListedColormap([colormaps["viridis"](x) for x in np.linspace(0, 0.92, 256)])


def _loci(sweep: Sweep, modes: int | None, line: Labelled | None, axes: Axes) -> None:
    """Draw the roots in the upper half-plane, coloured by the first parameter."""
    parameter = sweep.shown[0]
    along = [-1 if dim == parameter.dims[0] else 1 for dim in _dims(sweep)]
    value = np.broadcast_to(parameter.values.reshape(along), sweep["point_status"].shape).reshape(-1)
    re, im = (sweep[name].reshape(value.size, -1)[:, :modes] for name in ("re", "im"))
    norm, colours = _colours(parameter.values)
    for k in range(re.shape[1]) if line else ():
        points = np.column_stack([re[:, k], im[:, k]])
        segments = np.stack([points[:-1], points[1:]], axis=1)
        kept = np.isfinite(segments).all(axis=(1, 2))
        middles = ((value[:-1] + value[1:]) / 2)[kept]
        pieces = LineCollection(list(segments[kept]), cmap=colours, norm=norm, array=middles, linewidths=1.0)
        axes.add_collection(pieces)
    spread = np.repeat(value[:, None], re.shape[1], axis=1)
    there = np.isfinite(re)
    few = int(there.sum()) <= CROWD
    size, mark = (5, ".") if few else (1, ",")
    x, y, shade = re[there], im[there], spread[there]
    marks = axes.scatter(x, y, size, shade, marker=mark, cmap=colours, norm=norm, linewidths=0)
    marks.set_rasterized(not few)
    axes.axvline(0, color=QUIET, linewidth=0.5, zorder=1)
    right = axes.get_xlim()[1]
    if right > 0 and np.max(x) > 0:
        axes.axvspan(0, right, color=RIGHT_HALF_PLANE, zorder=0, linewidth=0)
        axes.set_xlim(right=right)
    axes.set_ylim(bottom=0)
    farthest = -OVERDAMPED * float(np.max(y))
    if farthest < 0 and float(np.min(x)) < farthest:
        rightmost = max(float(np.max(x)), 0.0)
        axes.set_xlim(farthest, rightmost - 0.06 * farthest)
    label_s_plane(axes)
    _add_scale(axes, marks, parameter)


def _magnitudes(sweep: Sweep) -> tuple[Doubles, Doubles]:
    values = np.hypot(sweep["re"], sweep["im"])
    with np.errstate(divide="ignore"):
        decibels = 20 * np.log10(values.reshape(-1, values.shape[-1]))
    return np.asarray(sweep["frequency"]), np.where(np.isfinite(decibels), decibels, np.nan)


def _magnitude_lines(sweep: Sweep, parameter: Labelled, axes: Axes) -> None:
    frequency, decibels = _magnitudes(sweep)
    norm, colours = _colours(parameter.values)
    curves = [np.column_stack([frequency, row]) for row in decibels]
    lines = LineCollection(curves, cmap=colours, norm=norm, array=parameter.values, linewidths=0.8)
    axes.add_collection(lines)
    axes.autoscale_view()
    _set_magnitude_axes(axes, frequency, sweep)
    _add_scale(axes, lines, parameter)


def _add_scale(axes: Axes, coloured: ScalarMappable, parameter: Labelled) -> None:
    """Say beside a panel which value of a parameter has which colour."""
    bar = axes.figure.colorbar(coloured, ax=axes, pad=0.02, aspect=25)
    bar.set_label(label_with_unit(parameter.name, parameter.unit), fontsize=7)


def _magnitude_band(sweep: Sweep, axes: Axes) -> None:
    frequency, decibels = _magnitudes(sweep)
    decibels = decibels[np.isfinite(decibels).any(axis=1)]
    low, middle, high = np.nanpercentile(decibels, (BAND[0], MEDIAN, BAND[1]), axis=0)
    axes.fill_between(frequency, low, high, color=COLOURS[0], alpha=0.25, linewidth=0, label="5 to 95 %")
    axes.plot(frequency, middle, "-", color=COLOURS[0], linewidth=1.0, label="median")
    axes.legend(frameon=False, loc="best", fontsize=7)
    _set_magnitude_axes(axes, frequency, sweep)


def _set_magnitude_axes(axes: Axes, frequency: Doubles, sweep: Sweep) -> None:
    set_frequency_axis(axes, float(frequency[0]), float(frequency[-1]))
    ratio = "/".join(label_of_name(end) for end in sweep.attribute("tf").split("/"))
    axes.set_ylabel(f"$|{ratio}|$ [dB]")
    axes.grid(visible=True)


MARGIN_LABELS: Final = {"phase_margin": "phase margin [deg]", "gain_margin_up": "gain margin, factor"}


def _margin_line(sweep: Sweep, name: str, parameter: Labelled, axes: Axes) -> None:
    order = np.argsort(parameter.values, kind="stable")
    values = np.where(np.isfinite(sweep[name]), sweep[name], np.nan)
    axes.plot(parameter.values[order], values[order], ".-", color=COLOURS[0], markersize=2.5)
    _set_parameter_axis(axes, parameter)
    axes.set_ylabel(MARGIN_LABELS[name])


def _margins(sweep: Sweep, name: str, axes: Axes) -> None:
    """Draw how often margins are how large."""
    values = sweep[name][np.isfinite(sweep[name])]
    axes.hist(values, bins=30, color=COLOURS[0], alpha=0.6)
    for share, width in ((BAND[0], 0.6), (MEDIAN, 1.0), (BAND[1], 0.6)):
        axes.axvline(float(np.percentile(values, share)), color=COLOURS[1], linewidth=width)
    axes.set_xlabel(f"{MARGIN_LABELS[name]}; lines: 5, 50, 95 %")
    axes.set_ylabel("points")
