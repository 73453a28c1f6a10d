"""A model drawn as a textbook draws it, from its specification alone.

Model --scheme--> Scheme --rows--> parts in their places --page--> Drawing --> figure
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Final

from symflex.drawing.cells import SPACINGS
from symflex.drawing.diagram import diagrams, statements
from symflex.drawing.fields import FieldRow, field_rows
from symflex.drawing.frames import frame_plan, name_of
from symflex.drawing.geometry import Drawing, Extent, Placed, upright
from symflex.drawing.joins import Join, joined
from symflex.drawing.lettering import Labels, column_of, filled
from symflex.drawing.order import abbreviated
from symflex.drawing.page import MARGIN, POINTS, figure_of, render_drawing, stacked
from symflex.drawing.rows import lay_out
from symflex.drawing.scheme import DrawnNetwork, scheme_of, with_readings
from symflex.drawing.signals import SignalGraph, whole
from symflex.errors import Diagnostic, UsageError, refused
from symflex.expressions import Name, names
from symflex.figures.style import DEFAULT_FONT, MM_PER_INCH, paper_style
from symflex.library.elements import LineElement
from symflex.print.latex.page import COLUMNS_MM, WIDEST_MM, checked_width

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from matplotlib.figure import Figure

    from symflex.drawing.cells import Spacing
    from symflex.drawing.scheme import DrawnPart, Scheme
    from symflex.model import Model

    _Row = tuple[Sequence[Placed], tuple[str, ...]]  # what is drawn, and elements that are left out

__all__ = ["Drawing", "Extent", "Placed", "draw_model", "drawing_of", "render_drawing"]
LEGEND: Final = 230.0  # width of the lines of values below a drawing [points]
ROUND: Final = 0.3  # where wires leave a round body, as a share of its radius: it is still as wide there
LARGEST_DRAWING: Final = 60  # elements of a model that is drawn on a page or in a notebook
MOST_WIRES: Final = 2  # dashed wires between signals and the model
SMALLEST: Final = 0.8  # how far symbols and type are made smaller before the page is made wider
SMALLEST_ASKED: Final = 0.6  # the same, before a width that was asked for is refused: type of 4.8 points


def draw_model(
    model: Model, *, values: bool = False, width_mm: float | None = None, font: str = DEFAULT_FONT
) -> Figure:
    """Draw a model as a figure; see :func:`drawing_of`."""
    drawing = drawing_of(model, values=values, width_mm=width_mm, font=font)
    with paper_style(font):
        return figure_of(drawing)


def drawing_of(
    model: Model, *, values: bool = False, width_mm: float | None = None, font: str = DEFAULT_FONT
) -> Drawing:
    """Lay out the drawing of a model, with numbers at the symbols where ``values``.

    By default it is as wide as a column (88.5 mm), a page (170 mm), or what it needs. Raises SF902, SF208.
    """
    with paper_style(font):
        content = _content_of(model, Labels(model, values))
        asked = [] if width_mm is None else [checked_width(width_mm)]
        usual = sorted(COLUMNS_MM.values())
        rooms = [w / MM_PER_INCH * POINTS - 2 * MARGIN for w in usual]
        bands = cache(partial(diagrams, content.graph))  # by how wide they may be
        # How many names stand for wires: more than need be where a loop goes on below its beginning.
        ends = [sum(i.kind == "tag" for band in bands(room) for i in band) for room in (*rooms, 1e9)]
        if ends[0] > ends[-1] >= ends[1]:
            usual = usual[1:]  # a loop is closed there
        networks = cache(lambda spacing: list(_networks(content, spacing)))
        for width in asked or usual:
            points = width / MM_PER_INCH * POINTS
            for spacing in SPACINGS:
                drawing = _laid_out(content, networks(spacing), points, bands(points - 2 * MARGIN))
                if drawing.width <= points:
                    return _with_joins(content, drawing)
            if points >= (SMALLEST_ASKED if asked else SMALLEST) * drawing.width:
                return _with_joins(content, drawing).scaled(points / drawing.width)
        needed = drawing.width / POINTS * MM_PER_INCH
        if not asked:
            return _with_joins(content, drawing).scaled(min(1.0, WIDEST_MM / needed))
        message = f"the drawing does not fit into {asked[0]:.4g} mm"
        hint = (
            f"it needs {min(needed * SMALLEST_ASKED, WIDEST_MM):.0f} mm; leave out the width to let "
            "symflex choose it"
        )
        raise refused(message, hint)


def _networks(content: _Content, spacing: Spacing) -> Iterator[_Row]:
    """Yield frames in their plane, and rows of what is no frame with the elements that they leave out."""
    domains = content.scheme.domains
    for one in content.scheme.networks:
        network, plan = one, frame_plan(one, content.model)
        if plan is not None:
            items, others = plan
            yield items, ()
            if not others:
                continue
            drawn = {i.name for i in items}
            marks = tuple(m for m in network.marks if m.labels[0][1] not in drawn)
            shared = dict.fromkeys(n for p in others for n in p.nodes if domains[n] == "plane")
            marks += tuple(name_of(n) for n in shared)
            nodes = {n for p in others for n in p.nodes} | {m.node for m in marks}
            nodes_within = tuple(n for n in network.nodes if n in nodes)
            network = replace(network, nodes=nodes_within, parts=tuple(others), marks=marks, spans=())
        shortened, gone = abbreviated(network, domains)
        row: Sequence[Placed] = lay_out(shortened, domains, spacing)
        is_up = content.model.drawing.is_up and all(domains[n] == "translation" for n in shortened.nodes)
        yield upright(row) if is_up else row, gone


@dataclass(frozen=True)
class _Content:
    """What is to be drawn of a model: a network, and below it fields, block diagrams, formulas and values."""

    model: Model
    scheme: Scheme
    graph: SignalGraph
    fields: tuple[FieldRow, ...]
    at_sources: Mapping[str, str]  # inputs that are all there is to an element, by its name


def _content_of(model: Model, labels: Labels) -> _Content:
    scheme = scheme_of(model, labels)
    fields = tuple(field_rows(model, labels, scheme.others))
    shown = {o for f in fields for o in f.outputs}
    used = {i for f in fields for i in f.inputs}
    free = [i.name for i in model.inputs if i.kind == "signal" and i.name not in used]
    graph = SignalGraph(model, labels, free)
    alone = [(whole(e.values[0][1]), e.name) for e in model.elements if e.element.is_source]
    sources = {value.name: name for value, name in alone if isinstance(value, Name) and value.name in free}
    graph.add_all([o for o in scheme.others if o not in shown], sources)
    written = {e: n for n, e in sources.items() if ("input", n) not in graph.known}
    return _Content(model, with_readings(scheme, graph.readings(), labels), graph, fields, written)


def _legend(model: Model, labels: Labels) -> list[Placed]:
    """Return the values of members and fields, of which there are too many to stand beside them."""
    used = [e for use in model.elements if isinstance(use.element, LineElement) for _, e in use.values]
    for one in model.fields:
        used += [one.start, one.end, *one.equations, *one.conditions]
    lines = column_of(filled(labels.values(used), LEGEND)) if used else ()
    return [Placed("values", "", (), lines)] if lines else []


def _laid_out(content: _Content, drawn_rows: list[_Row], width: float, bands: list[list[Placed]]) -> Drawing:
    model, graph = content.model, content.graph
    rows = [*(items for items, _ in drawn_rows), *(f.items for f in content.fields)]
    rows += [*bands, statements(graph), _legend(model, graph.labels)]
    gone = tuple(name for _, left_out in drawn_rows for name in left_out)
    at = content.at_sources
    named = [
        [replace(i, kind="input", name=at[i.name]) if i.kind == "label" and i.name in at else i for i in row]
        for row in rows
        if row
    ]
    return stacked(named, width, gone)


def _with_joins(content: _Content, drawing: Drawing) -> Drawing:
    """Return a drawing with wires from what signals read, and to the sources that they drive."""
    boxes: dict[tuple[str, str], list[Extent]] = {}
    for item in drawing.items:
        boxes.setdefault((item.kind, item.name), []).append(item.box)
    bodies: dict[str, list[Extent]] = {}
    for part in (p for net in content.scheme.networks for p in net.parts if p.symbol.role == "body"):
        part_boxes = boxes.get(("element", part.name), ())
        bodies.setdefault(part.nodes[0], []).extend(c for b in part_boxes for c in _faces(part, b))
    joins = []
    for name in content.graph.readings():
        node = name.partition(".")[0]
        starts = bodies.get(node) or boxes.get(("node", node)) or boxes.get(("reading", name), [])
        joins += [Join(name, tuple(starts), (tag.grown(1.5),)) for tag in boxes.get(("tag", name), ())]
    for use in (e for e in content.model.elements if e.element.is_source):
        driving = [n.name for n in names(use.values[0][1]) if isinstance(n, Name)]
        starts = [b for n in driving for b in boxes.get(("end", n), ())] or boxes.get(("drive", use.name), [])
        ends = tuple(boxes.get(("element", use.name), ()))
        # Where an arrow to the right begins; of another symbol all of it.
        tails = tuple(Extent(b.x0, b.y0, b.x0, b.y1) if b.width > 2 * b.height else b for b in ends)
        joins.append(Join(use.name, tuple(starts), tails, ends))
    # More than two would confuse, and names stand at both ends.
    wires = joined(drawing, joins) if len({j.name for j in joins if j.ends}) <= MOST_WIRES else ()
    return replace(drawing, items=(*drawing.items, *wires))


def _faces(part: DrawnPart, box: Extent) -> tuple[Extent, ...]:
    """Return where wires may leave a body: all around it, of a round one near its four utmost points."""
    if part.type_name != "inertia" or abs(box.width - box.height) > 1:
        return (box,)
    (x, y), near = box.centre, ROUND * box.width / 2
    return Extent(x - near, box.y0, x + near, box.y1), Extent(box.x0, y - near, box.x1, y + near)
