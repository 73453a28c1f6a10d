"""The look of all figures: sizes, fonts, colours."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager

    from symflex.roots import PoleZeroMap

COLUMN_INCHES: Final = 3.5
PAGE_INCHES: Final = 7.16
"""A column and the text of a page in journals of the IEEE."""
NOTE_POINTS: Final = 6.0
TITLE_POINTS: Final = 8.0
LINE_INCHES: Final = 0.13
"""Height of a line of a title."""
TITLE_SPACING: Final = 0.95
LETTERS_PER_INCH: Final = 18
"""Of a title in eight points, so that lines are broken before they are too long."""

# Okabe and Ito (2008), told apart with every kind of colour blindness; their yellow is too pale for a line.
COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
# Told apart in black and white too.
DASHES: Final = ("-", (0, (5, 1.5)), (0, (5, 1.2, 1.2, 1.2)), (0, (1.2, 1.2)))
QUIET: Final = "#8C8C8C"
FAINT: Final = "#E3E3E3"

_FALLBACK: Final = ["STIXGeneral", "DejaVu Sans"]

# All come with matplotlib: the same glyphs on every computer.
FONTS: Final[dict[str, dict[str, object]]] = {
    "times": {"font.family": _FALLBACK, "mathtext.fontset": "stix"},
    # Computer Modern has no minus sign but that of mathematics.
    "latex": {
        "font.family": ["cmr10", *_FALLBACK],
        "mathtext.fontset": "cm",
        "axes.formatter.use_mathtext": True,
    },
    "sans": {"font.family": ["DejaVu Sans"], "mathtext.fontset": "dejavusans"},
}
"""Fonts of texts: STIX, at home next to Times; Computer Modern, that of LaTeX; one for slides."""
DEFAULT_FONT: Final = "times"

# Where Computer Modern has what ASCII and Latin-1 say; elsewhere its glyphs are others.
_COMPUTER_MODERN: Final = frozenset(
    " !#$%&'()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]`abcdefghijklmnopqrstuvwxyz"
)
_LAST_OF_LATIN: Final = "\u00c4"

_PAPER: Final[dict[str, object]] = {
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


def paper_style(font: str = DEFAULT_FONT) -> AbstractContextManager[None]:
    """Return a context in which matplotlib draws as for a paper, whatever the user's own settings.

    Raises UsageError: SF208 for any other font.
    """
    if font not in FONTS:
        hint = nearest(font, FONTS) or "fonts: " + ", ".join(FONTS)
        raise UsageError(Diagnostic("SF208", f"there is no font '{font[:64]}' for figures", None, hint))
    return style.context(["default", _PAPER | FONTS[font]])


def family_of(text: str, font: str) -> list[str] | None:
    """Return the families of a text that the font lacks letters for, None when it has them all.

    Examples
    --------
    >>> family_of("Two masses", "latex"), family_of("a < b", "latex"), family_of("a < b", "times")
    (None, ['STIXGeneral', 'DejaVu Sans'], None)
    """
    if font != "latex" or all(c in _COMPUTER_MODERN or c > _LAST_OF_LATIN for c in text):
        return None
    return _FALLBACK


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [inches] that belongs to no window."""
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def stability_lines(maps: Sequence[PoleZeroMap], width: float) -> list[str]:
    """Return what stands below a title: whether what is drawn is stable, broken to a width [inches]."""
    said = list(dict.fromkeys(found.verdict.headline for found in maps))
    if len(said) > 1:
        said = [f"{found.tf}: {found.verdict.headline}" for found in maps]
    return title_lines("; ".join(said), width)


def write_titles(figure: Figure, titles: Sequence[Sequence[str]], above: float, height: float) -> None:
    """Write groups of lines below each other at the top of a figure that leaves room for them [inches]."""
    for group in titles:
        if group:
            figure.text(
                0.5,
                1 - above / height,
                "\n".join(group),
                ha="center",
                va="top",
                fontsize=TITLE_POINTS,
                linespacing=TITLE_SPACING,
                parse_math=False,
            )
        above += LINE_INCHES * len(group)


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
