"""Figures for a paper: vector output, column width, the same bytes on every run.

A new kind is one file with a drawing function, and one line in :data:`FIGURES`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.text import Text

from symflex.analysis.response import roots_if_found
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.errors.diagnostic import nearest
from symflex.figures.axes import FREE, AxisLimits, Canvas, Drawing
from symflex.figures.bode import draw_bode, draw_fit, draw_measured, draw_response
from symflex.figures.loops import draw_locus, draw_nyquist, number_label
from symflex.figures.modes import draw_modes
from symflex.figures.poles_zeros import draw_poles_zeros
from symflex.figures.save import FORMATS, MM_PER_INCH, render, save
from symflex.figures.style import DEFAULT_FONT, FONTS, family_of, label_of_name, paper_style
from symflex.figures.sweep import draw_sweep
from symflex.loops import closed_loop, loop_gain, require_arrival, trace_locus
from symflex.model.analysis import FIGURE_KINDS
from symflex.print.latex.page import checked_width

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from matplotlib.figure import Figure

    from symflex.loops import Loop
    from symflex.transfer import BoundTransferFunction, TransferFunction

FIGURES: dict[str, Drawing] = {
    "bode": draw_bode,
    "modes": draw_modes,
    "nyquist": draw_nyquist,
    "poles_zeros": draw_poles_zeros,
}

LOOP_FIGURES: tuple[str, ...] = ("locus", "nyquist")
"""Kinds that are drawn of a loop and its gain, by :func:`draw_loop`."""

__all__ = [
    "DEFAULT_FONT",
    "FIGURES",
    "FONTS",
    "FORMATS",
    "LOOP_FIGURES",
    "AxisLimits",
    "Drawing",
    "draw",
    "draw_fit",
    "draw_loop",
    "draw_measured",
    "draw_response",
    "draw_sweep",
    "render",
    "save",
    "unavailable",
]


def draw(
    kind: str,
    tfs: Sequence[TransferFunction],
    bounds: Sequence[BoundTransferFunction],
    *,
    band_hz: tuple[float | Fraction, float | Fraction] | None = None,
    frame: AxisLimits = FREE,
    title: str | None = None,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
) -> Figure:
    """Draw a figure of one or several transfer functions.

    ``kind`` is a key of :data:`FIGURES`, ``bounds`` are the functions ``tfs`` with numbers. Without
    ``band_hz`` [Hz] a Bode plot takes the model's ``band``, or else one that shows all poles and zeros; a
    pole-zero plot focuses on the resonances that belong together and marks the rest at its border, and with
    it shows those up to its end; of modes, the lowest are shown, or those in it. ``frame`` takes the place of
    limits that suit what is drawn; ``title`` is printed as it is, never read as mathematics. The figure is
    3.5 inches wide by default, or 7.16 for what needs the width of a page. :func:`render` is to be told the
    same ``font``, a key of :data:`FONTS`. Raises UsageError: SF208 an unknown kind; SF911 a kind that is not
    available yet; SF227 an empty band; SF208 an unknown font; SF902 the width is not between 80 and 1000 mm
    or too small for what is drawn, or limits are of axes that the figure has not; ModelError: SF402 a
    transfer function is identically zero.
    """
    if kind not in FIGURES:
        if kind in LOOP_FIGURES:
            message = f"a figure of kind '{kind}' is drawn of a loop"
            raise UsageError(
                Diagnostic("SF902", message, None, "name its gain: --gain K, or gain in [figures]")
            )
        if kind in FIGURE_KINDS:
            raise UsageError(unavailable(kind))
        hint = nearest(kind, FIGURES) or "kinds: " + ", ".join(FIGURES)
        raise UsageError(Diagnostic("SF208", f"there is no figure of kind '{kind[:64]}'", None, hint))
    _check_frame(kind, frame)
    if not tfs or len(tfs) != len(bounds):
        message = (
            f"a figure needs as many bound as symbolic transfer functions, not {len(bounds)} and {len(tfs)}"
        )
        raise ValueError(message)
    for bound in bounds:
        if bound.ratio.is_zero:
            raise ModelError(Diagnostic("SF402", f"{bound.name} is identically zero: nothing to draw"))
    canvas = _canvas(band_hz, frame, title, width_mm)
    with paper_style(font):
        figure = FIGURES[kind](tfs, bounds, canvas)
    return _with_every_letter(figure, font)


def unavailable(kind: str) -> Diagnostic:
    """Return what is said of a kind that is announced and not drawn yet."""
    hint = "there are " + ", ".join((*FIGURES, *LOOP_FIGURES))
    return Diagnostic("SF911", f"figures of kind '{kind}' are not available yet", None, hint)


def _canvas(
    band_hz: tuple[float | Fraction, float | Fraction] | None,
    frame: AxisLimits,
    title: str | None,
    width_mm: float | None,
) -> Canvas:
    """Return what is asked of a figure, checked and in the units of matplotlib."""
    band = None if band_hz is None else (float(band_hz[0]), float(band_hz[1]))
    if band is not None and not 0 <= band[0] < band[1] < float("inf"):
        message = f"a band runs from a lower to a higher frequency, not from {band[0]:g} to {band[1]:g} Hz"
        raise UsageError(Diagnostic("SF227", message))
    width = None if width_mm is None else checked_width(width_mm) / MM_PER_INCH
    return Canvas(band, frame, title, width)


def _check_frame(kind: str, frame: AxisLimits) -> None:
    """Refuse limits of axes that a kind of figure has not."""
    if frame.phase and kind != "bode":
        raise UsageError(Diagnostic("SF902", "limits of a phase are for 'bode'"))
    if frame.x and kind == "bode":
        raise UsageError(Diagnostic("SF902", "the frequencies of a Bode plot are its band"))
    if frame != FREE and kind == "modes":
        raise UsageError(Diagnostic("SF902", "mode shapes have no limits: their largest displacement is 1"))


def _with_every_letter(figure: Figure, font: str) -> Figure:
    """Set texts with letters that a font lacks in one that has them."""
    for text in figure.findobj(Text):
        family = family_of(text.get_text(), font)
        if family and not text.get_parse_math():
            text.set_fontfamily(family)
    return figure


def draw_loop(
    kind: str,
    loop: Loop,
    *,
    limits: tuple[Fraction | None, Fraction | None] | None = None,
    modes: int | None = None,
    band_hz: tuple[float | Fraction, float | Fraction] | None = None,
    frame: AxisLimits = FREE,
    title: str | None = None,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
) -> Figure:
    """Draw a root locus, or the Nyquist plot of a loop gain ``K B/A``.

    ``kind`` is ``locus`` or ``nyquist``. ``limits`` are the first and last gain of a locus, by default from 0
    to 10 times the nominal one; ``modes`` are traced in the locus of a loop with kernels, by default those in
    the band, or the lowest five. ``band_hz`` are frequencies of a Nyquist plot [Hz]; a locus is shown up to
    its end. The rest is as for :func:`draw`. Raises UsageError: SF208 an unknown kind, SF804 no range, SF806
    no straight line in the gain; UncertifiedError: SF807 the curves do not end in proved poles.
    """
    if kind not in LOOP_FIGURES:
        hint = "kinds: " + ", ".join(LOOP_FIGURES)
        raise UsageError(
            Diagnostic("SF208", f"no figure of kind '{kind[:64]}' is drawn of a loop", None, hint)
        )
    _check_frame(kind, frame)
    canvas = _canvas(band_hz, frame, title, width_mm)
    with paper_style(font):
        if kind == "locus":
            locus = trace_locus(loop, limits, modes, band_hz=canvas.band_hz)
            require_arrival(locus)
            return _with_every_letter(draw_locus(locus, canvas), font)
        bound = loop_gain(loop)
        label = f"loop gain, ${label_of_name(loop.gain.name)} = {number_label(float(loop.nominal or 0))}$"
        verdict = f"closed loop {roots_if_found(closed_loop(loop)).verdict.headline}"
        return _with_every_letter(draw_nyquist([bound.source], [bound], canvas, [label], verdict), font)
