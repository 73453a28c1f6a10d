"""Rows put below each other on a page, and a page drawn by matplotlib."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from symflex.drawing.geometry import BLACK, Drawing, Placed, union
from symflex.figures.figure import new_figure
from symflex.figures.files import render
from symflex.figures.style import DEFAULT_FONT, paper_style

POINTS: Final = 72.0
TITLED: Final = ("element", "input", "output", "block", "field")  # kinds of parts whose names an SVG shows
_TITLED: Final = re.compile(rf'<g id="({"|".join(TITLED)})\.(\w+)\.\d+">')
_FAMILY: Final = re.compile("font-family: 'STIXGeneral'")
SERIFS: Final = "'STIX Two Text', 'Times New Roman', 'Liberation Serif', 'Nimbus Roman', Times, serif"
"""Fonts with letters nearly as wide, for readers without STIX."""
MARGIN: Final = 4.0
BETWEEN: Final = 11.0


def render_drawing(drawing: Drawing, format: str, *, font: str = DEFAULT_FONT) -> bytes:
    """Return a drawing as the content of a file; in an SVG parts bear the names of what they stand for."""
    with paper_style(font):
        figure = figure_of(drawing)
    if format != "svg":
        return render(figure, format, font=font)
    written = render(figure, format, font=font, has_text=True).decode()
    written = _TITLED.sub(lambda m: f"{m[0]}<title>{m[1]} {m[2]}</title>", written)
    return _FAMILY.sub(f"font-family: 'STIXGeneral', {SERIFS}", written).encode()


def stacked(rows: Sequence[Sequence[Placed]], least: float, abbreviated: tuple[str, ...] = ()) -> Drawing:
    """Return rows below each other, centred on a page at least so wide."""
    boxes = [union(i.box for i in r) for r in rows]
    width = max([least, *(b.width + 2 * MARGIN for b in boxes)])
    y, items = 0.0, []
    for row, box in zip(rows, boxes, strict=True):
        y -= box.height
        items += [i.moved((width - box.width) / 2 - box.x0, y - box.y0) for i in row]
        y -= BETWEEN
    height = -y - BETWEEN + 2 * MARGIN
    return Drawing(width, height, tuple(i.moved(0, height - MARGIN) for i in items), abbreviated)


def figure_of(drawing: Drawing) -> Figure:
    """Return a drawing as a figure."""
    across, up = drawing.width, drawing.height
    figure = new_figure(across / POINTS, up / POINTS)
    for i, item in enumerate(drawing.items):
        for j, stroke in enumerate(item.strokes):
            points = [(x / across, y / up) for x, y in stroke.points]
            codes = [Path.MOVETO, *[Path.LINETO] * (len(points) - 1)]
            if stroke.points[0] == stroke.points[-1]:
                codes[-1] = Path.CLOSEPOLY
            is_first = j == 0 and item.kind in TITLED
            figure.add_artist(
                PathPatch(
                    Path(points, codes),
                    gid=f"{item.kind}.{item.name}.{i}" if is_first else None,
                    transform=figure.transFigure,
                    edgecolor=BLACK,
                    facecolor=stroke.fill or "none",
                    linewidth=stroke.width,
                    linestyle=(0, (3, 2)) if stroke.is_dashed else "-",
                    capstyle="butt" if stroke.is_dashed else "round",
                    joinstyle="miter" if stroke.fill else "round",
                )
            )
        for j, shown in enumerate(item.texts):
            position = (shown.x / across, shown.y / up)
            # An input of a block diagram is a name at the beginning of a wire.
            is_first = j == 0 and not item.strokes and item.kind in TITLED
            gid = f"{item.kind}.{item.name}.{i}" if is_first else None
            figure.text(*position, shown.markup, gid=gid, fontsize=shown.size, ha="left", va="baseline")
    return figure
