"""Figures for a paper: vector output, column width, the same bytes on every run.

A new kind is one file with a drawing function, and one line in :data:`FIGURES`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.text import Text

from symflex.emit.figures.bode import draw_bode, draw_response
from symflex.emit.figures.drawing import Drawing
from symflex.emit.figures.fit import draw_fit
from symflex.emit.figures.modes import draw_modes
from symflex.emit.figures.pgf import MM_PER_INCH
from symflex.emit.figures.poles_zeros import draw_poles_zeros
from symflex.emit.figures.save import FORMATS, render, save
from symflex.emit.figures.style import DEFAULT_FONT, FONTS, family_of, paper_style
from symflex.emit.latex.column import checked_width
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.errors.diagnostic import nearest
from symflex.model.analysis import FIGURE_KINDS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from matplotlib.figure import Figure

    from symflex.transfer import BoundTransferFunction, TransferFunction

FIGURES: dict[str, Drawing] = {
    "bode": draw_bode,
    "modes": draw_modes,
    "poles_zeros": draw_poles_zeros,
}

__all__ = [
    "DEFAULT_FONT",
    "FIGURES",
    "FONTS",
    "FORMATS",
    "Drawing",
    "draw",
    "draw_fit",
    "draw_response",
    "render",
    "save",
]


def draw(
    kind: str,
    tfs: Sequence[TransferFunction],
    bounds: Sequence[BoundTransferFunction],
    *,
    band_hz: tuple[float | Fraction, float | Fraction] | None = None,
    title: str | None = None,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
) -> Figure:
    """Draw a figure of one or several transfer functions.

    Parameters
    ----------
    kind : str
        A key of :data:`FIGURES`.
    tfs, bounds : sequences of equal length, at least one
        The functions, and the same with numbers.
    band_hz : (number, number), optional
        Frequencies shown [Hz]. Without it a Bode plot takes the model's ``band``, or else one that shows all
        poles and zeros; a pole-zero plot focuses on the resonances that belong together and marks the rest at
        its border; of the lowest modes, all are shown.
    title : str, optional
        Printed as it is, never read as mathematics.
    width_mm : float, optional
        Of the figure; by default 3.5 inches, or 7.16 for what needs the width of a page.
    font : str, optional
        A key of :data:`FONTS`; :func:`render` is to be told the same one.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        SF208 an unknown kind; SF911 a kind that is not available yet; SF227 an empty band; SF208 an unknown
        font; SF902 the width is not between 80 and 1000 mm or too small for what is drawn.
    ModelError
        SF402 a transfer function is identically zero.
    """
    if kind not in FIGURES:
        if kind in FIGURE_KINDS:
            hint = "available: " + ", ".join(FIGURES)
            raise UsageError(
                Diagnostic("SF911", f"figures of kind '{kind}' are not available yet", None, hint)
            )
        hint = nearest(kind, FIGURES) or "kinds: " + ", ".join(FIGURES)
        raise UsageError(Diagnostic("SF208", f"there is no figure of kind '{kind[:64]}'", None, hint))
    if not tfs or len(tfs) != len(bounds):
        message = (
            f"a figure needs as many bound as symbolic transfer functions, not {len(bounds)} and {len(tfs)}"
        )
        raise ValueError(message)
    for bound in bounds:
        if bound.ratio.is_zero:
            raise ModelError(Diagnostic("SF402", f"{bound.name} is identically zero: nothing to draw"))
    band = None if band_hz is None else (float(band_hz[0]), float(band_hz[1]))
    width = None if width_mm is None else checked_width(width_mm) / MM_PER_INCH
    with paper_style(font):
        figure = FIGURES[kind](tfs, bounds, band_hz=band, title=title, width=width)
    for text in figure.findobj(Text):
        family = family_of(text.get_text(), font)
        if family and not text.get_parse_math():
            text.set_fontfamily(family)
    return figure
