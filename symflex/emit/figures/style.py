"""The look of all figures: sizes, fonts, colours."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

COLUMN_INCHES: Final = 3.5
PAGE_INCHES: Final = 7.16
NOTE_POINTS: Final = 6.0
TITLE_POINTS: Final = 8.0
TITLE_SPACING: Final = 0.95
LETTERS_PER_INCH: Final = 18

# Okabe and Ito (2008), told apart with every kind of colour blindness; their yellow is too pale for a line.
COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
# Told apart in black and white too.
DASHES: Final = ("-", (0, (5, 1.5)), (0, (5, 1.2, 1.2, 1.2)), (0, (1.2, 1.2)))
QUIET: Final = "#8C8C8C"
FAINT: Final = "#E3E3E3"

_PAPER: Final[dict[str, object]] = {
    # STIX comes with matplotlib: the same glyphs on every computer, and at home next to Times.
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": TITLE_POINTS,
    "legend.fontsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "grid.color": FAINT,
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "symflex",
}


def paper_style() -> AbstractContextManager[None]:
    """Return a context in which matplotlib draws as for a paper, whatever the user's own settings."""
    return style.context(["default", _PAPER])


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [inches] that belongs to no window."""
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def title_lines(title: str | None, width: float) -> list[str]:
    """Return a title broken to a width [inches], without the characters that do not print.

    Examples
    --------
    >>> title_lines("Two masses joined by a flexible transmission", 1.5)
    ['Two masses joined by a', 'flexible transmission']
    """
    words = " ".join((title or "").split())
    printed = "".join(c for c in words if c.isprintable())
    return textwrap.wrap(printed, max(8, int(width * LETTERS_PER_INCH)), max_lines=4, placeholder=" ...")
