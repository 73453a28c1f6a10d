"""Pole-zero arrays: one panel per transfer function, equal scales on both axes and in all panels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING, Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from symflex.figures.axes import FREE, Canvas, draw_points, draw_zero_lines, root_figure, set_round_ticks
from symflex.figures.figure import new_figure
from symflex.figures.modes import PANELS_IN_COLUMN
from symflex.figures.s_plane import (
    GLYPHS,
    POINTS_PER_INCH,
    Box,
    Kind,
    Panel,
    RootMark,
    View,
    choose_view,
    crowded,
    inches_of,
    marks_of,
    write_notes,
)
from symflex.figures.sigma import ends_of
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    LINE_INCHES,
    NOTE_POINTS,
    PAGE_INCHES,
    label_of,
    label_of_tf,
    stability_lines,
    title_lines,
    write_titles,
)
from symflex.matrices.zeros import locate_matrix
from symflex.roots import Band, PoleZeroMap
from symflex.roots.locate import locate
from symflex.transfer import AnyBoundFunction

if TYPE_CHECKING:
    from symflex.loops.clouds import RootCloud

    Roots = tuple[Sequence[RootMark], Sequence[RootCloud]]


PANELS_ON_PAGE: Final = 4
LEFT, RIGHT, BOTTOM, TOP, GAP = 0.54, 0.15, 0.38, 0.20, 0.24
NARROWEST, WIDEST = 0.6, 1.25
INSET, PAD, ROOM_POINTS = 0.3, 24.0, 110.0  # inset's share, room for its numbers, least side [pt]
TALLEST_INCHES: Final = 2.6
LOOKS: Final[dict[Kind, tuple[str, str, float]]] = {  # shape, colour and size of marks
    "zero": ("o", COLOURS[0], 4.6),
    "pole": ("x", COLOURS[1], 4.8),
}
SHADED: Final = "shaded: for all combinations; dashed: not proved"
COLOUR_OF: Final = {kind: colour for kind, (_, colour, _) in LOOKS.items()}


def draw_poles_zeros(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw poles (crosses) and zeros (circles), all panels with the same part of the s plane.

    A root outside is named where the ray to it leaves; an inset shows what is close to the origin of a wide
    one.
    """
    region = _region(canvas)
    maps = [locate(bound, None if bound.is_rational else region) for bound in bounds]
    clouds = [
        [] if canvas.clouds is None else canvas.clouds(*each) for each in zip(bounds, maps, strict=True)
    ]
    return _draw_maps(maps, [label_of_tf(bound.source) for bound in bounds], clouds, canvas)


def draw_poles_zeros_of_matrix(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the poles and transmission zeros of the matrix that functions make, in one panel."""
    model = canvas.model or bounds[0].source.model
    outputs, inputs = ends_of(bounds)
    found = locate_matrix(model, [o.name for o in outputs], [i.name for i in inputs], _region(canvas))
    rows, columns = (", ".join(label_of(end) for end in ends) for ends in (outputs, inputs))
    return _draw_maps([found.located], [f"$({rows})/({columns})$"], [[]], canvas)


def _region(canvas: Canvas) -> Band | None:
    band = canvas.band_hz
    return None if band is None else Band(Fraction(0), Fraction(band[1]))


def _draw_maps(
    maps: Sequence[PoleZeroMap],
    labels: Sequence[str],
    clouds: Sequence[Sequence[RootCloud]],
    canvas: Canvas,
) -> Figure:
    """Draw poles and zeros, a panel each."""
    band_hz, frame = canvas.band_hz, canvas.frame
    panels = [marks_of(located) for located in maps]
    count = len(panels)
    width = canvas.width or (COLUMN_INCHES if count < PANELS_IN_COLUMN else PAGE_INCHES)
    columns = min(count, PANELS_IN_COLUMN if width < (COLUMN_INCHES + PAGE_INCHES) / 2 else PANELS_ON_PAGE)
    rows = ceil(count / columns)
    given_axes = canvas.own_axes(count) if canvas.axes else ()
    room = (width - LEFT - RIGHT - GAP * (columns - 1)) / columns
    narrowest = min(NARROWEST, room / 1.3)
    view = _view(
        [mark for marks in panels for mark in marks],
        _highest_pole(maps) if band_hz is None else band_hz[1],
        (inches_of(given_axes[0])[0] / inches_of(given_axes[0])[1],) * 2
        if given_axes
        else (narrowest, WIDEST),
        [cloud for each in clouds for cloud in each],
    )
    is_asked = frame != FREE
    if is_asked:
        view = View(frame.x or view.re, frame.y or view.im, frozenset())
    shape = min(max(view.ratio, narrowest), WIDEST) if is_asked else view.ratio
    panel_width = min(room, TALLEST_INCHES * shape)
    panel_height = panel_width / shape
    outside = [_said_of_rest(located, view) for located in maps] if is_asked else []
    titles = (
        title_lines(canvas.title, width),
        stability_lines(maps, width) if frame.has_verdict else [],
        [line for said in (*outside, SHADED if canvas.clouds else "") for line in title_lines(said, width)],
    )
    lines = [line for group in titles for line in group]
    above = LINE_INCHES * len(lines) + (0.04 if lines else 0)
    height = above + rows * (TOP + panel_height + BOTTOM)
    figure = root_figure(given_axes[0]) if given_axes else new_figure(width, height)
    # Panels narrower than their room stand in the middle.
    start = LEFT + (width - LEFT - RIGHT - columns * panel_width - (columns - 1) * GAP) / 2
    for i, (label, marks) in enumerate(zip(labels, panels, strict=True)):
        row, column = divmod(i, columns)
        x = start + column * (panel_width + GAP)
        y = height - above - (row + 1) * (TOP + panel_height) - row * BOTTOM
        box = (x / width, y / height, panel_width / width, panel_height / height)
        axes = given_axes[i] if given_axes else figure.add_axes(box)
        if given_axes:
            panel_width, panel_height = inches_of(axes)
        _draw_panel(axes, (marks, clouds[i]), view, panel_width, panel_height)
        if is_asked:
            axes.set_aspect("auto")
        panel = Panel.of(view, panel_width, panel_height, marks)
        inset = () if is_asked else _draw_inset(axes, (marks, clouds[i]), panel)
        write_notes(axes, () if is_asked else marks, panel, COLOUR_OF, marks, inset)
        axes.set_title(label, pad=4)
        axes.set_xlabel(r"$\mathrm{Re}(s)$ [rad/s]", labelpad=2)
        if column == 0 or given_axes:
            axes.set_ylabel(r"$\mathrm{Im}(s)$ [rad/s]", labelpad=1)
        else:
            axes.tick_params(labelleft=False)
    if given_axes:
        given_axes[0].set_title("\n".join([*lines, labels[0]]), pad=4)
    else:
        write_titles(figure, titles, 0.04, height)
    return figure


def _highest_pole(maps: Sequence[PoleZeroMap]) -> float | None:
    """Return up to which frequency [Hz] poles of distributed systems are known, ``None`` without any."""
    poles = [root for each in maps if each.is_infinite for root in each.poles if not root.is_zero]
    # Poles in the right half-plane are known wherever they lie; zeros and others only as far as the rest.
    poles = [root for root in poles if not root.re > 0] or poles
    return max((root.frequency_hz() for root in poles), default=None)


def _view(
    marks: Sequence[RootMark], high_hz: float | None, ratios: tuple[float, float], clouds: Sequence[RootCloud]
) -> View:
    """Return the part to show, wide enough for the rectangles about the roots that it shows."""
    view, corners = choose_view(marks, high_hz, ratios), set[complex]()
    for left, right, low, high in (each.sides for each in clouds):
        if any(left <= s.real <= right and low <= s.imag <= high for s in view.shown):
            corners |= {complex(left, high), complex(right, high)}
    wider = choose_view(marks, None, ratios, {*view.shown, *corners})
    return replace(wider, shown=view.shown) if corners else view


def _draw_panel(axes: Axes, roots: Roots, view: View, width: float, height: float) -> None:
    marks, clouds = roots
    axes.set_xlim(*view.re)
    axes.set_ylim(*view.im)
    axes.set_aspect("equal", adjustable="box")
    draw_zero_lines(axes)
    set_round_ticks(axes, max(2, int(width / 0.36)), max(2, int(height / 0.32)))
    inside = [mark for mark in marks if view.shows(mark)]
    for kind, look in LOOKS.items():
        draw_points(axes, [mark.s for mark in inside if mark.kind == kind], look, is_cut=False)
    for each in clouds:
        left, right, low, high = each.sides
        # What is not proved is not shaded.
        line, colour = "--" if each.count is None else "-", COLOUR_OF[each.kind]
        for bottom in {low, -high}:
            box = Rectangle((left, bottom), right - left, high - low, linestyle=line, linewidth=0.6, zorder=2)
            box.set(edgecolor=colour, facecolor=(colour, 0.25), fill=each.count is not None)
            axes.add_patch(box)


def _draw_inset(axes: Axes, roots: Roots, panel: Panel) -> tuple[Box, ...]:
    """Draw the roots close to the origin where no root is, and return what it covers [points]."""
    near, (wide, high) = crowded(panel.view), panel.size
    across, upwards = INSET * wide, INSET * high
    if not near or min(wide, high) < ROOM_POINTS:
        return ()
    x, y = (1.1 * PAD, wide - across - PAD / 4), (high - upwards - PAD / 4, 0.6 * PAD, high / 2 + 0.75 * PAD)
    boxes = [(a - PAD, b - PAD / 2, a + across, b + upwards) for b in y for a in x]
    box = boxes[panel.clearest(boxes)]
    if panel.cost(box, (), ()):
        return ()
    inset = axes.inset_axes(((box[0] + PAD) / wide, (box[1] + PAD / 2) / high, INSET, INSET))
    view = choose_view([m for m in roots[0] if m.s in near], None, (across / upwards,) * 2, near)
    _draw_panel(inset, roots, view, across / POINTS_PER_INCH, upwards / POINTS_PER_INCH)
    inset.tick_params(labelsize=NOTE_POINTS, pad=2)
    return (box,)


def _said_of_rest(located: PoleZeroMap, view: View) -> str:
    """Return how many of the roots found lie outside the limits that were asked for."""
    outside = [mark for mark in marks_of(located) if not view.shows(mark)]
    counts = {kind: sum(m.multiplicity for m in outside if m.kind == kind) for kind in GLYPHS}
    said = [f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in counts.items() if n]
    return f"{located.tf}: {' and '.join(said)} outside" if said else ""
