"""Where the texts of a figure stand once it is drawn."""

import re
from itertools import combinations

from matplotlib.axes import Axes
from matplotlib.text import Annotation, Text

TOUCH = 0.8
"""Pixels at 100 dots per inch by which boxes of texts, which are larger than their letters, may overlap."""
BEYOND = 1.0
EXPONENT = re.compile(r"\de[+-]?\d")


def drawn_texts(figure):
    """Return the texts that are seen, with their boxes [pixels]."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    unseen = set()
    for axes in figure.findobj(Axes):  # insets, too
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-9 * (high - low)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                is_seen = axes.axison and low - slack <= tick.get_loc() <= high + slack
                unseen |= {t for t in (tick.label1, tick.label2) if not is_seen or not t.get_visible()}
    texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip() and t not in unseen]
    return [(t, t.get_window_extent(renderer)) for t in texts]


def faults(figure):
    """Say which texts overlap, leave the figure or their panel, or print a power of ten as a program does."""
    found = drawn_texts(figure)
    return [
        *(f"{t.get_text()!r} leaves the figure" for t, box in found if not _holds(figure.bbox, box)),
        *(
            f"{t.get_text()!r} leaves its panel"
            for t, box in found
            if isinstance(t, Annotation) and t.axes and not _holds(t.axes.get_window_extent(), box)
        ),
        *(f"{t.get_text()!r} has an exponent" for t, _ in found if EXPONENT.search(t.get_text())),
        *(
            f"{t.get_text()!r} and {u.get_text()!r} overlap"
            for (t, a), (u, b) in combinations(found, 2)
            if min(a.x1, b.x1) - max(a.x0, b.x0) > TOUCH and min(a.y1, b.y1) - max(a.y0, b.y0) > TOUCH
        ),
    ]


def _holds(outer, inner):
    return (
        outer.x0 - BEYOND <= inner.x0
        and inner.x1 <= outer.x1 + BEYOND
        and outer.y0 - BEYOND <= inner.y0
        and inner.y1 <= outer.y1 + BEYOND
    )
