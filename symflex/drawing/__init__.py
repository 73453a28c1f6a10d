"""A model drawn as a textbook draws it, from its specification alone.

Model --scheme--> Scheme --rows--> parts in their places --page--> Drawing --> figure
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.drawing.abbreviation import abbreviated
from symflex.drawing.cells import SPACINGS
from symflex.drawing.diagram import diagrams
from symflex.drawing.fields import field_rows
from symflex.drawing.frames import frame_plan, is_planar, name_of
from symflex.drawing.geometry import Drawing, Extent, Placed
from symflex.drawing.lettering import Labels, column_of, filled
from symflex.drawing.page import POINTS, figure_of, render_drawing, stacked
from symflex.drawing.rows import lay_out, order_of
from symflex.drawing.scheme import DrawnNetwork, scheme_of, with_readings
from symflex.drawing.signals import SignalGraph
from symflex.drawing.statements import statements
from symflex.errors import Diagnostic, UsageError
from symflex.figures.save import MM_PER_INCH
from symflex.figures.style import DEFAULT_FONT, paper_style
from symflex.library.elements import LineElement
from symflex.print.latex.page import COLUMNS_MM, WIDEST_MM, checked_width

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.figure import Figure

    from symflex.drawing.cells import Spacing
    from symflex.drawing.scheme import Scheme
    from symflex.model import Model

__all__ = ["Drawing", "Extent", "Placed", "draw_model", "drawing_of", "render_drawing"]

LEGEND: Final = 230.0
"""Width of the lines of values below a drawing [points]."""
SMALLEST: Final = 0.8
"""Share of their size to which symbols and type are made smaller before the page is made wider."""
SMALLEST_ASKED: Final = 0.6
"""The same, before a width that was asked for is refused: type of 4.8 points."""


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
    """Lay out the drawing of a model.

    ``values`` writes numbers with units at the symbols. By default the drawing is as wide as a column of a
    journal (88.5 mm), the text of a page (170 mm), or what it needs. Equal models give equal drawings.
    Raises UsageError: SF902 when the width is not between 80 and 1000 mm or has no room for the model; SF208
    an unknown font.
    """
    with paper_style(font):
        scheme, below = _prepared(model, Labels(model, values))
        asked = [] if width_mm is None else [checked_width(width_mm)]
        for width in asked or sorted(COLUMNS_MM.values()):
            points = width / MM_PER_INCH * POINTS
            for spacing in SPACINGS:
                drawing = _laid_out(model, scheme, below, spacing, points)
                if drawing.width <= points:
                    return drawing
            if points >= (SMALLEST_ASKED if asked else SMALLEST) * drawing.width:
                return drawing.scaled(points / drawing.width)
        needed = drawing.width / POINTS * MM_PER_INCH
        if not asked:
            return drawing.scaled(min(1.0, WIDEST_MM / needed))
        message = f"the drawing has no room in {asked[0]:.4g} mm"
        hint = (
            f"it takes {min(needed * SMALLEST_ASKED, WIDEST_MM):.0f} mm; without a width it has what it needs"
        )
        raise UsageError(Diagnostic("SF902", message, None, hint))


def _network(
    network: DrawnNetwork, scheme: Scheme, model: Model, spacing: Spacing
) -> Iterator[tuple[Sequence[Placed], tuple[str, ...]]]:
    """Yield a frame in its plane, and the row of what is no frame with the elements it leaves out."""
    plan = frame_plan(network, model) if is_planar(network) else None
    if plan is not None:
        items, others = plan
        yield items, ()
        if not others:
            return
        drawn = {i.name for i in items}
        marks = tuple(m for m in network.marks if m.labels[0][1] not in drawn)
        shared = dict.fromkeys(n for p in others for n in p.nodes if scheme.domains[n] == "plane")
        marks += tuple(name_of(n) for n in shared)
        nodes = {n for p in others for n in p.nodes} | {m.node for m in marks}
        names = tuple(n for n in network.nodes if n in nodes)
        network = DrawnNetwork(names, tuple(others), marks, ())
    shortened, gone = abbreviated(network, order_of(network, scheme.domains), scheme.domains)
    yield lay_out(shortened, scheme.domains, spacing), gone


def _prepared(model: Model, labels: Labels) -> tuple[Scheme, list[Sequence[Placed]]]:
    """Return what is to be drawn of the network, and what stands below it: fields, diagrams, formulas."""
    scheme = scheme_of(model, labels)
    fields = field_rows(model, labels, scheme.others)
    shown = {o for f in fields for o in f.outputs}
    graph = SignalGraph(model, labels)
    used = {i for f in fields for i in f.inputs}
    free = [i.name for i in model.inputs if i.kind == "signal" and i.name not in used]
    graph.add_all([o for o in scheme.others if o not in shown], free)
    rows: list[Sequence[Placed]] = [f.items for f in fields]
    rows += [*diagrams(graph), statements(graph), _legend(model, labels)]
    return with_readings(scheme, graph.readings(), labels), rows


def _legend(model: Model, labels: Labels) -> list[Placed]:
    """Return the values of members and fields, of which there are too many to stand beside them."""
    used = [e for use in model.elements if isinstance(use.element, LineElement) for _, e in use.values]
    for one in model.fields:
        used += [one.start, one.end, *one.equations, *one.conditions]
    lines = column_of(filled(labels.values(used), LEGEND)) if used else ()
    return [Placed("values", "", (), lines)] if lines else []


def _laid_out(
    model: Model, scheme: Scheme, below: Sequence[Sequence[Placed]], spacing: Spacing, width: float
) -> Drawing:
    found = [row for network in scheme.networks for row in _network(network, scheme, model, spacing)]
    rows = [*(items for items, _ in found), *below]
    gone = tuple(name for _, names in found for name in names)
    return stacked([r for r in rows if r], width, gone)
