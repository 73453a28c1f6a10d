"""Mode shapes: one row of panels per mode, distributed parts along x and nodes side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullFormatter

from symflex.analysis.modes import DistributedShape, EnclosedModeShape, EnclosedShape, lowest_modes
from symflex.errors import Diagnostic, ModelError, refused
from symflex.figures.axes import Canvas, root_figure
from symflex.figures.figure import ShownFigure, new_figure
from symflex.figures.runs import Panel, Plan, Run, Stems, panels_of
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    FAINT,
    LINE_INCHES,
    MM_PER_INCH,
    PAGE_INCHES,
    PLAIN_HIGH,
    QUIET,
    label_of_name,
    title_lines,
    write_titles,
)
from symflex.model import Model
from symflex.roots import Band
from symflex.roots.locate import DEFAULT_MODES
from symflex.transfer import AnyBoundFunction

if TYPE_CHECKING:
    import numpy.typing as npt

    Points = npt.NDArray[np.float64]
    Amplitudes = npt.NDArray[np.complex128]

MODES_LIMIT: Final = 40
ROW_INCHES, PLAN_INCHES, HEADING_INCHES, AXIS_INCHES, LEGEND_INCHES = 0.56, 1.5, 0.17, 0.38, 0.06
LEFT, RIGHT = 0.46, 0.08
GAP, LABELLED_GAP = 0.34, 0.54
LABEL_OFFSET: Final = 0.35
STEM_INCHES, NARROWEST_STEMS, NARROWEST_RUN = 0.3, 0.42, 0.9
NARROWEST_PANEL: Final = 0.25
PANELS_IN_COLUMN: Final = 3
NAMES_LIMIT: Final = 12
NAME_INCHES: Final = 0.06
MARGIN: Final = 1.2
SWING: Final = 0.15  # how far the largest displacement is drawn in a plan, as a share of its size
VISIBLE: Final = 0.1  # share of the largest motion from which what moves in quadrature is drawn
LEAST: Final = 1e-6  # numbers from here on are written out
FINER, MOST_POINTS = 6, 8000
"""Points drawn for every one that no wave is missed by, which makes a hundred a half wave; and in all."""
UNIT_NAMES: Final = {"m": "displacement", "rad": "angle", "V": "voltage", "": "signal"}
PLAN: Final = "plan"
SUPPORT: Final = 0.04  # size of a support over that of the frame
LAGGING: Final = (0, (4, 1.5))
Moving = tuple[Artist, Callable[[complex], object] | None]
Curve = tuple["npt.NDArray[np.float64]", "npt.NDArray[np.complex128]"]


def draw_modes(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the lowest modes of the first function's model, and all of poles in the right half-plane.

    The part in phase with the largest displacement is drawn in full, what moves in quadrature dashed.
    """
    model, band_hz = bounds[0].source.model, canvas.band_hz
    band = None if band_hz is None else Band(Fraction(band_hz[0]), Fraction(band_hz[1]))
    count = min(model.analysis.modes or (MODES_LIMIT if band else DEFAULT_MODES), MODES_LIMIT)
    numbered, verdict = lowest_modes(bounds[0], count, band)
    shapes = [mode.shape for mode in numbered]
    if not panels_of(model, shapes):
        where = "" if band_hz is None else f" between {band_hz[0]:g} and {band_hz[1]:g} Hz"
        message = f"{bounds[0].name} has no mode other than at 0 that has a shape{where}"
        raise ModelError(Diagnostic("SF402", message))
    said = verdict.headline if canvas.frame.has_verdict else None
    return draw_shapes(model, shapes, [heading(shape) for shape in shapes], canvas, said)


def draw_shapes(
    model: Model,
    shapes: Sequence[EnclosedShape],
    headings: Sequence[str],
    canvas: Canvas,
    said: str | None = None,
) -> Figure:
    """Draw shapes of a model below each other, with what is ``said`` of it; see :func:`draw_modes`."""
    panels = panels_of(model, shapes)
    width = canvas.width or (COLUMN_INCHES if len(panels) <= PANELS_IN_COLUMN else PAGE_INCHES)
    titles = (title_lines(canvas.title, width), title_lines(said, width))
    lines = [line for group in titles for line in group]
    is_per_metre = all(unit_of_reference(shape) == "m" for shape in shapes)
    names = UNIT_NAMES | ({"rad": "angle [rad/m]"} if is_per_metre else {})
    labels = ["" if isinstance(panel, Plan) else names[_unit_of(panel)] for panel in panels]
    gaps = [LEFT, *(GAP if a == b else LABELLED_GAP for a, b in pairwise(labels))]
    columns = _widths(panels, width - RIGHT - sum(gaps))
    given_axes = canvas.own_axes(len(panels) * len(shapes)) if canvas.axes else ()
    if min(columns) < NARROWEST_PANEL and not given_axes:
        message = f"{len(panels)} panels side by side do not fit into {MM_PER_INCH * width:.4g} mm"
        raise refused(message, "the width of a page is 170 mm")
    is_lagging = any(_lags(panel, shape) for shape in shapes for panel in panels)
    few = [(p, room) for p, room in zip(panels, columns, strict=True) if isinstance(p, Stems)]
    crowded = (_crowded(p, room) + 0.08 for p, room in few if len(p.names) <= NAMES_LIMIT)
    below = RIGHT if all(isinstance(panel, Plan) for panel in panels) else max(AXIS_INCHES, *crowded, 0.0)
    above = LINE_INCHES * len(lines) + (LEGEND_INCHES if is_lagging else 0) + 0.02
    row = PLAN_INCHES if any(isinstance(panel, Plan) for panel in panels) else ROW_INCHES
    # Shapes of frames alone stand side by side.
    across = 2 if len(panels) == 1 and isinstance(panels[0], Plan) and len(shapes) > 1 else 1
    height = above + ceil(len(shapes) / across) * (HEADING_INCHES + row) + below
    figure = root_figure(given_axes[0]) if given_axes else new_figure(width, height)
    moving: list[Moving] = []
    for i, shape in enumerate(shapes):
        bottom = height - above - (i // across + 1) * (HEADING_INCHES + row)
        edge = i % across * columns[0] / across
        for j, (panel, room, gap) in enumerate(zip(panels, columns, gaps, strict=True)):
            edge += gap
            box = (edge / width, bottom / height, room / across / width, row / height)
            axes = given_axes[i * len(panels) + j] if given_axes else figure.add_axes(box)
            if isinstance(panel, Plan):
                parts = _draw_plan(axes, panel, shape)
            else:
                parts = _draw_panel(axes, panel, shape)
                is_named = sum(isinstance(panel, Run) for panel in panels) > 1
                _set_x_axis(axes, panel, room, is_last=i == len(shapes) - 1, is_named=is_named)
            still = isinstance(shape, EnclosedModeShape) and shape.pole.is_real
            moving += [(artist, _stays if still and move else move) for artist, move in parts]
            if j == 0:
                axes.set_title(headings[i], loc="left", pad=2.5, fontsize=7.5)
            if given_axes:
                axes.set_ylabel(labels[j])
            edge += room
    _share_scale([axes for axes in figure.axes if axes.get_gid() == PLAN])
    if given_axes:
        return figure
    _label_columns(figure, labels, columns, gaps, (below + (height - above - below) / 2) / height)
    if is_lagging:
        _add_legend(figure, panels, 1 - (LINE_INCHES * len(lines) + 0.03) / height)
    if isinstance(figure, ShownFigure):
        figure.moving = (*moving, *((legend, None) for legend in figure.legends))
    write_titles(figure, titles, 0.02, height)
    return figure


def heading(shape: EnclosedModeShape) -> str:
    """Return natural frequency and damping ratio, or loss factor, of a mode, or its pole if that is real."""
    pole = shape.pole
    unstable = ", unstable" if pole.re > 0 else ""
    if pole.is_real:
        return f"$s = {label_of_value(float(pole.re.mid()), 4)}$ rad/s{unstable}"
    frequency = f"${label_of_value(pole.frequency_hz(), 4)}$ Hz"
    factor = pole.loss_factor()
    name, damping = (r"\zeta", pole.damping_ratio()) if factor is None else (r"\eta", float(factor.mid()))
    return rf"{frequency}, ${name} = {label_of_value(damping, 3)}${unstable}" if damping else frequency


def label_of_value(value: float, digits: int) -> str:
    """Return a number with all its significant digits, trailing zeros too."""
    if value and not LEAST <= abs(value) < PLAIN_HIGH:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        return rf"{mantissa}\cdot 10^{{{int(exponent)}}}"
    decimals = max(0, digits - 1 - floor(log10(abs(value)))) if value else 0
    return f"{value:.{decimals}f}"


def _widths(panels: Sequence[Panel], room: float) -> list[float]:
    """Return the panels' widths [inches]: nodes take what they need, the rest is shared."""
    counts = [min(len(p.names), NAMES_LIMIT) if isinstance(p, Stems) else 0 for p in panels]
    stems = [max(NARROWEST_STEMS, STEM_INCHES * count) if count else 0.0 for count in counts]
    runs = stems.count(0.0)
    if not runs:
        return [room * s / sum(stems) for s in stems]
    most = max(room - NARROWEST_RUN * runs, NARROWEST_STEMS)
    shrink = min(1.0, most / sum(stems)) if any(stems) else 1.0
    return [s * shrink or (room - shrink * sum(stems)) / runs for s in stems]


def _curves(panel: Run, shape: EnclosedShape) -> list[Curve]:
    """Return the displacement along each part of a run."""
    curves = []
    for segment in panel.segments:
        part = shape.along(segment.name)
        share, (moved,) = _smooth(part, (0,))
        length = float(part.length.mid())
        # From a tip at its second end x falls.
        if segment.is_reversed != (length < 0):
            share = 1 - share
        curves.append((segment.offset + abs(length) * share, moved))
    return curves


def _smooth(
    part: DistributedShape, states: Sequence[int]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.complex128]]:
    """Return shares of a part's length and states there, so close that no corner shows."""
    few = part.intervals()
    many = few * max(1, min(FINER, MOST_POINTS // few))
    points = list(part.sampled(many if part.varying is None else few))
    shares = np.array([float(share) for share, _ in points])
    moved = np.array([[complex(z[i].mid()) for _, z in points] for i in states])
    if part.varying is None:
        return shares, moved
    from scipy.interpolate import CubicSpline  # other figures need none

    share = np.linspace(0, 1, many + 1)
    return share, CubicSpline(shares, moved, axis=1)(share)


def _amplitudes(panel: Panel, shape: EnclosedShape) -> npt.NDArray[np.complex128]:
    if isinstance(panel, Stems):
        return np.array([complex(shape.motion(name).value.mid()) for name in panel.names])
    if isinstance(panel, Plan):
        return np.concatenate([moved.ravel() for *_, moved in _members(panel, shape)])
    return np.concatenate([values for _, values in _curves(panel, shape)])


def _lags(panel: Panel, shape: EnclosedShape) -> bool:
    """Tell whether something in a panel is seen to move out of phase."""
    values = _amplitudes(panel, shape)
    largest = 1.0 if _is_normalised(panel, shape) else float(np.abs(values).max())
    return bool(np.abs(values.imag).max() > VISIBLE * largest)


def _members(
    panel: Plan, shape: EnclosedShape
) -> Iterator[tuple[npt.NDArray[np.float64], npt.NDArray[np.complex128]]]:
    """Yield points of every member where it rests, and by how much they move; a row for x and one for y."""
    for name, x, y in panel.members:
        part = shape.along(name)
        share, moved = _smooth(part, part.displacements)
        along = float(part.length.mid()) * share
        c, s = (float(value.mid()) for value in part.direction)
        yield np.array([x + c * along, y + s * along]), moved


def _stays(_: complex) -> None:
    """Leave what does not oscillate where it is."""


def _moving_line(axes: Axes, at_rest: Points, moved: Amplitudes, **style: Any) -> Moving:  # noqa: ANN401
    """Draw points where they are at the crest of the motion; a row for x and one for y."""
    (line,) = axes.plot(*(at_rest + moved.real), **style)
    return line, lambda turn: line.set_data(*(at_rest + (turn * moved).real))


def _draw_plan(axes: Axes, panel: Plan, shape: EnclosedShape) -> list[Moving]:
    moving: list[Moving] = []
    members = list(_members(panel, shape))
    size = float(max(np.ptp(np.concatenate([points for points, _ in members], axis=1), axis=1)))
    largest = float(max(np.abs(moved).max() for _, moved in members)) or 1.0
    scale = SWING * size / largest
    is_lagging = _lags(panel, shape)
    for points, moved in members:
        axes.plot(*points, color=QUIET, linewidth=0.5, zorder=1)
        if is_lagging:
            swung = points + scale * moved.imag
            (lagging,) = axes.plot(*swung, color=COLOURS[1], linestyle=LAGGING, linewidth=0.9, zorder=2)
            moving.append((lagging, None))
        style = {"color": COLOURS[0], "zorder": 3, "solid_capstyle": "round"}
        moving.append(_moving_line(axes, points, scale * moved, **style))
        swing = scale * np.abs(moved)
        axes.update_datalim(np.concatenate([points - swing, points + swing], axis=1).T)
    for node, x, y in panel.loaded:
        swings = [[complex(shape.motion(f"{node}.{c}").value.mid())] for c in ("x", "y")]
        moving.append(_draw_inertia(axes, x, y, np.array(swings) * complex(scale)))
    for kind, x, y in panel.held:
        _draw_support(axes, kind, (x, y), SUPPORT * size)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.03)  # beyond the moved members, which count for the limits
    axes.set_axis_off()
    axes.set_gid(PLAN)
    return moving


def _draw_support(axes: Axes, kind: str, at: tuple[float, float], size: float) -> None:
    """Draw how an end is held: hatched ground, below a triangle for a pin, below a roller for a slider."""
    x, y = at
    style: dict[str, Any] = {"color": QUIET, "linewidth": 0.6, "zorder": 1}
    drop = 0.0 if kind == "fixed" else size
    if kind == "pin":
        axes.plot([x, x - 0.6 * size, x + 0.6 * size, x], [y, y - size, y - size, y], **style)
    elif kind == "slider":
        turn = np.linspace(0, 2 * np.pi, 25)
        axes.plot(x + size / 2 * np.cos(turn), y - size / 2 + size / 2 * np.sin(turn), **style)
    axes.plot([x - size, x + size], [y - drop, y - drop], **style)
    for start in np.linspace(-size, 0.6 * size, 5):
        axes.plot([x + start + 0.4 * size, x + start], [y - drop, y - drop - 0.4 * size], **style)


def _share_scale(panels: Sequence[Axes]) -> None:
    """Give shapes in the plane the same limits, so that they have one scale."""
    for part, put in (("get_xlim", "set_xlim"), ("get_ylim", "set_ylim")):
        ends = [getattr(axes, part)() for axes in panels]
        for axes in panels:
            axes.set_aspect("equal", adjustable="box")
            getattr(axes, put)(min(low for low, _ in ends), max(high for _, high in ends))


def _draw_panel(axes: Axes, panel: Panel, shape: EnclosedShape) -> list[Moving]:
    axes.axhline(0, color=QUIET, linewidth=0.5, zorder=1)
    values, is_lagging = _amplitudes(panel, shape), _lags(panel, shape)
    if isinstance(panel, Run):
        moving = _draw_run(axes, panel, shape, is_lagging=is_lagging)
    else:
        moving = _draw_stems(axes, values, is_lagging=is_lagging)
    axes.tick_params(top=False, right=False)
    if _is_normalised(panel, shape):
        axes.set_ylim(-MARGIN, MARGIN)
        axes.yaxis.set_major_locator(FixedLocator([-1, 0, 1]))
    else:
        limit = MARGIN * (float(np.abs(values).max()) or 1.0)
        axes.set_ylim(-limit, limit)
        axes.yaxis.set_major_locator(MaxNLocator(nbins=3, symmetric=True, steps=[1, 2, 3, 4, 5, 10]))
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
        axes.yaxis.get_offset_text().set_fontsize(6)
    return moving


def _is_normalised(panel: Panel, shape: EnclosedShape) -> bool:
    """Tell whether the panel's unit is that of the largest displacement, which is 1."""
    return _unit_of(panel) in ("m", unit_of_reference(shape))


def _unit_of(panel: Panel) -> str:
    if isinstance(panel, Stems):
        return panel.unit
    return "rad" if isinstance(panel, Run) and panel.is_turning else "m"


def unit_of_reference(shape: EnclosedShape) -> str:
    """Return the SI unit of the largest displacement."""
    owner = shape.reference.partition("(")[0].partition(".")[0] if shape.reference.endswith(")") else ""
    part = next((p for p in shape.distributed if p.name == owner), None)
    if part is not None:
        return "rad" if part.kind == "shaft" else "m"
    return shape.motion(shape.reference).unit


def _draw_run(axes: Axes, panel: Run, shape: EnclosedShape, *, is_lagging: bool) -> list[Moving]:
    moving: list[Moving] = []
    for joint in panel.ends[1:-1]:
        axes.axvline(joint, color=FAINT, linewidth=0.6, zorder=0)
    for x, values in _curves(panel, shape):
        if is_lagging:
            (lagging,) = axes.plot(
                x, values.imag, color=COLOURS[1], linestyle=LAGGING, linewidth=0.9, zorder=2
            )
            moving.append((lagging, None))
        at_rest, moved = np.array([x, 0 * x]), np.array([0 * values, values])
        style = {"color": COLOURS[0], "zorder": 3, "solid_capstyle": "round"}
        moving.append(_moving_line(axes, at_rest, moved, **style))
    for node, position in panel.loaded:
        name = node if any(m.name == node for m in shape.motions) else f"{node}.y"
        amplitude = complex(shape.motion(name).value.mid())
        moving.append(_draw_inertia(axes, position, 0.0, np.array([[0j], [amplitude]])))
    span = panel.ends[-1] - panel.ends[0]
    axes.set_xlim(panel.ends[0] - 0.02 * span, panel.ends[-1] + 0.02 * span)
    return moving


def _draw_inertia(axes: Axes, x: float, y: float, moved: Amplitudes) -> Moving:
    style = {"marker": "o", "linestyle": "none", "markersize": 4.2, "clip_on": False, "zorder": 4}
    return _moving_line(axes, np.array([[x], [y]]), moved, color=COLOURS[0], **style)


def _draw_stems(axes: Axes, values: npt.NDArray[np.complex128], *, is_lagging: bool) -> list[Moving]:
    moving: list[Moving] = []
    places = np.arange(1, len(values) + 1)
    at_rest, moved = np.array([places, 0 * places]), np.array([0 * values, values])
    is_crowded = len(values) > NAMES_LIMIT
    if len(values) > 1:
        style = {"color": COLOURS[0], "linewidth": 0.5, "alpha": 0.6, "zorder": 2}
        moving.append(_moving_line(axes, at_rest, moved, **style))
    width = 0.5 if is_crowded else 1.1
    stems = axes.vlines(places, 0, values.real, color=COLOURS[0], linewidth=width, zorder=3)
    ends = [[(position, 0.0), (position, value)] for position, value in zip(places, values, strict=True)]
    moving.append((stems, lambda turn: stems.set_segments(list((np.array(ends) * (1, turn)).real))))
    style = {"marker": "o", "linestyle": "none", "markersize": 1.8 if is_crowded else 3.6, "zorder": 4}
    moving.append(_moving_line(axes, at_rest, moved, color=COLOURS[0], **style))
    if is_lagging:
        size = 1.4 if is_crowded else 2.8
        (marks,) = axes.plot(places, values.imag, "D", color=COLOURS[1], markersize=size, zorder=5)
        marks.set(markerfacecolor="none", markeredgewidth=0.8)
        moving.append((marks, None))
    axes.set_xlim(0.5, len(values) + 0.5)
    return moving


def _set_x_axis(axes: Axes, panel: Run | Stems, room: float, *, is_last: bool, is_named: bool) -> None:
    if isinstance(panel, Run):
        axes.xaxis.set_major_locator(MaxNLocator(nbins=max(2, int(room / 0.42)), steps=[1, 2, 2.5, 5, 10]))
        if is_last:
            symbol = label_of_name(f"x_{panel.segments[0].name}") if is_named else "x"
            axes.set_xlabel(f"${symbol}$ [{panel.unit}]" if panel.unit else f"${symbol}$", labelpad=1.5)
    elif len(panel.names) <= NAMES_LIMIT:
        axes.xaxis.set_major_locator(FixedLocator(range(1, len(panel.names) + 1)))
        axes.tick_params(axis="x", length=0)
        if is_last:
            rotation = 90 if _crowded(panel, room) else 0
            axes.set_xticklabels([_label(n) for n in panel.names], rotation=rotation)
    else:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=max(2, int(room / 0.42))))
        if is_last:
            axes.set_xlabel("node", labelpad=1.5)
    if not is_last:
        axes.xaxis.set_major_formatter(NullFormatter())


def _label(name: str) -> str:
    owner, _, component = name.partition(".")
    if component == "theta":
        return rf"$\theta_{{{label_of_name(owner)}}}$"
    return f"${label_of_name(owner)}$"


def _crowded(panel: Stems, room: float) -> float:
    """Return how long the longest name is [inches], 0 where names have room side by side."""
    longest = max(len(name.partition(".")[0]) + name.endswith(".theta") for name in panel.names)
    return NAME_INCHES * longest if NAME_INCHES * longest > room / len(panel.names) else 0.0


def _label_columns(
    figure: Figure, labels: Sequence[str], columns: Sequence[float], gaps: Sequence[float], middle: float
) -> None:
    """Say beside the panels what they show."""
    width = figure.get_figwidth()
    edge, before = 0.0, ""
    for label, room, gap in zip(labels, columns, gaps, strict=True):
        edge += gap
        if label not in (before, ""):
            position, text = (edge - LABEL_OFFSET) / width, label[0].upper() + label[1:]
            figure.text(position, middle, text, rotation=90, ha="center", va="center", fontsize=8)
        edge, before = edge + room, label


def _add_legend(figure: Figure, panels: Sequence[Panel], top: float) -> None:
    are_stems = [isinstance(panel, Stems) for panel in panels]
    style, mark = "" if all(are_stems) else LAGGING, "D" if any(are_stems) else ""
    lagging = Line2D([], [], linewidth=0.9, color=COLOURS[1], label="in quadrature")
    lagging.set(linestyle=style, marker=mark, markersize=2.8, markerfacecolor="none", markeredgewidth=0.8)
    figure.legend(
        handles=[Line2D([], [], color=COLOURS[0], label="in phase"), lagging],
        loc="upper right",
        ncols=2,
        bbox_to_anchor=(1 - RIGHT / figure.get_figwidth(), top),
        frameon=False,
        fontsize=7,
        borderpad=0.0,
        borderaxespad=0.0,
    )
