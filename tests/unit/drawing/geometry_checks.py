"""What every drawing keeps to, told from its geometry alone."""

from dataclasses import replace
from itertools import combinations

from symflex.drawing.geometry import Extent

TOUCH = 0.4
"""How far boxes may reach into each other [points]: lines have widths, and symbols meet at their ends."""
SLANTED = 1.3
"""The same of slanted members, which are covered by small rectangles and meet at sharp angles."""
THICK = 4.5
"""Width of a member with room for rounding."""
PASSIVE = ("wire", "node", "join")


def of_kind(drawing, *kinds):
    """Return the parts of some kinds."""
    return tuple(item for item in drawing.items if item.kind in kinds)


def _within(box, by):
    return Extent(box.x0 + by, box.y0 + by, box.x1 - by, box.y1 - by)


def _share(a, b, touch):
    a, b = _within(a, touch), _within(b, touch)
    return a.x0 < a.x1 and b.x0 < b.x1 and a.overlaps(b)


def _meet(a, b):
    """Tell whether two members run into each other at a rigid corner."""
    is_thin = all(i.kind == "element" and min(i.box.width, i.box.height) < THICK for i in (a, b))
    across, up = (
        min(a.box.x1, b.box.x1) - max(a.box.x0, b.box.x0),
        min(a.box.y1, b.box.y1) - max(a.box.y0, b.box.y0),
    )
    return is_thin and max(across, up) < THICK


def _is_label_of(a, b):
    return a.name == b.name and "label" in (a.kind, b.kind)


def _is_slanted(item):
    return any(len(replace(item, strokes=(s,), texts=()).extents) > 1 for s in item.strokes)


def overlaps(drawing):
    """Return the pairs of symbols and texts that share room; a label may stand in its own symbol."""
    solid = [i for i in drawing.items if i.kind not in PASSIVE]
    found = []
    for a, b in combinations(solid, 2):
        if not (_is_label_of(a, b) or _meet(a, b)) and a.box.overlaps(b.box):
            touch = SLANTED if _is_slanted(a) or _is_slanted(b) else TOUCH
            if any(_share(p, q, touch) for p in a.extents for q in b.extents):
                found.append((f"{a.kind} {a.name}", f"{b.kind} {b.name}"))
    return found


def _untouched(item, kind):
    """Return what a wire of a kind must not pass through."""
    return item.extents if kind == "join" and item.kind not in PASSIVE else [t.box for t in item.texts]


def struck_texts(drawing):
    """Return the texts that a wire passes through, and the symbols that a dashed one does."""
    wires = [
        (item, Extent(min(a[0], b[0]), min(a[1], b[1]), max(a[0], b[0]), max(a[1], b[1])).grown(0.01))
        for item in of_kind(drawing, "wire", "join")
        for stroke in item.strokes
        for a, b in zip(stroke.points, stroke.points[1:], strict=False)
    ]
    return [
        (wire.name, item.kind, item.name)
        for item in drawing.items
        for wire, segment in wires
        for box in _untouched(item, wire.kind)
        if _within(box, TOUCH).overlaps(segment)
    ]


def outside(drawing):
    """Return the parts that reach over the page."""
    page = Extent(0, 0, drawing.width, drawing.height).grown(0.01)
    return [
        (i.kind, i.name)
        for i in drawing.items
        if i.box.x0 < page.x0 or i.box.y0 < page.y0 or i.box.x1 > page.x1 or i.box.y1 > page.y1
    ]


def count(drawing, kind, name):
    return sum(i.kind == kind and i.name == name for i in drawing.items)


def wrongly_counted(model, drawing):
    """Return the elements, inputs, outputs and blocks that do not stand in the drawing once."""
    wanted = [
        *(("element", e.name) for e in model.elements if e.name not in drawing.abbreviated),
        *(("input", i.name) for i in model.inputs),
        *(("output", o.name) for o in model.outputs),
        *(("block", b.name) for b in model.blocks),
    ]
    return [(kind, name, n) for kind, name in wanted if (n := count(drawing, kind, name)) != 1]


def faults(model, drawing):
    """Return all of these that a drawing of a model has."""
    checks = overlaps(drawing), struck_texts(drawing), outside(drawing), wrongly_counted(model, drawing)
    return [found for found in checks if found]


def place(drawing, kind, name):
    """Return the box of the first item of a kind and name."""
    return next(i for i in drawing.items if (i.kind, i.name) == (kind, name)).box
