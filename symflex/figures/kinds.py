"""Kinds of figures: what is asked of one, checked, and drawn in the style of a paper or on a user's axes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.text import Text

from symflex.errors import Diagnostic, ModelError, UsageError, nearest, refused
from symflex.figures.axes import FREE, AxesGiven, AxisLimits, Canvas, Drawing, axes_of
from symflex.figures.figure import Raster, raster_of
from symflex.figures.style import DEFAULT_FONT, MM_PER_INCH, family_of, paper_style
from symflex.model import Model
from symflex.options import PlotOptions, Stated, axis_ends, band_ends, frequency
from symflex.print.latex import width_of
from symflex.print.latex.page import checked_width
from symflex.transfer import AnyBoundFunction

if TYPE_CHECKING:
    from symflex.analysis.modes import EnclosedModeShape
    from symflex.contact.over import PassiveChart
    from symflex.loops import AnyLoop, StabilityMap
    from symflex.loops.chart import StabilityChart


def _later(module: str, name: str) -> Callable[..., Figure]:
    """Return a function that draws, whose module is imported when it is asked for."""

    def drawn(*arguments: object) -> Figure:
        """Do what the function of that name in its module does."""
        figure: Figure = getattr(import_module(f"symflex.figures.{module}"), name)(*arguments)
        return figure

    return drawn


FIGURES: dict[str, Drawing] = {
    "bode": _later("bode", "draw_bode"),
    "deflection": _later("deflection", "draw_deflections"),
    "impulse": partial(_later("in_time", "draw_responses"), "impulse"),
    "modes": _later("modes", "draw_modes"),
    "nichols": _later("nichols", "draw_nichols"),
    "nyquist": _later("loops", "draw_nyquist"),
    "passivity": _later("passivity", "draw_passivity"),
    "poles_zeros": _later("poles_zeros", "draw_poles_zeros"),
    "rga": _later("sigma", "draw_relative_gains"),
    "sigma": _later("sigma", "draw_sigma"),
    "step": partial(_later("in_time", "draw_responses"), "step"),
}

MATRIX_FIGURES: dict[str, Drawing] = {
    "nyquist": _later("sigma", "draw_loci"),
    "poles_zeros": _later("poles_zeros", "draw_poles_zeros_of_matrix"),
    "rga": FIGURES["rga"],
    "sigma": FIGURES["sigma"],
}  # kinds that are drawn of all functions as one matrix

LOOP_FIGURES: dict[str, Callable[[AnyLoop, Canvas], Figure]] = {
    "locus": _later("loops", "draw_locus"),
    "nichols": _later("nichols", "draw_loop_phase"),
    "nyquist": _later("loops", "draw_loop_gain"),
    "sensitivity": _later("sensitivity", "draw_sensitivity"),
}  # kinds that are drawn of a loop and its gain


def draw(
    kind: str,
    drawn: Sequence[AnyBoundFunction] | AnyLoop,
    *,
    limits: tuple[Fraction | None, Fraction | None] | None = None,
    modes: int | None = None,
    band_hz: tuple[float | Fraction, float | Fraction] | None = None,
    frame: AxisLimits = FREE,
    title: str | None = None,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
    ax: AxesGiven | None = None,
    spread: Stated | None = None,
    model: Model | None = None,
    is_matrix: bool = False,
) -> Figure:
    """Draw a figure of transfer functions or of a loop; ``kind`` is a key of its table above.

    Without ``band_hz`` [Hz] each kind shows what lies in the model's band, or all that matters. ``frame``
    takes the place of limits that suit what is drawn; ``title`` is never read as mathematics. The figure is
    3.5 inches wide by default, or 7.16 for what needs the width of a page. On ``ax``, axes of the user's own,
    it is drawn in the user's style. With ``spread`` a pole-zero plot shades where roots may lie. ``limits``
    are the first and last gain of a locus, and ``modes`` those traced in one of a loop with kernels. With
    ``is_matrix`` functions are drawn as one matrix. Raises
    UsageError: SF208 an unknown kind or font, SF227 an empty band, SF804 no range, SF806 no straight line in
    the gain, SF902 a wrong size or number of axes; ModelError: SF402 a function is identically zero;
    UncertifiedError: SF807 curves without certified ends.
    """
    canvas = replace(_canvas(band_hz, frame, title, width_mm, ax), gains=limits, modes=modes)
    if spread is not None:
        from symflex.loops.clouds import root_clouds  # few ask for them

        canvas = replace(canvas, clouds=partial(root_clouds, share=spread, model=model))
    is_loop = not isinstance(drawn, Sequence)
    if is_matrix and (is_loop or kind not in MATRIX_FIGURES or spread is not None):
        message = f"--matrix is for figures of kind {', '.join(MATRIX_FIGURES)}"
        raise refused(message, "leave --gain and --spread out")
    figures = MATRIX_FIGURES if is_matrix else FIGURES
    known = LOOP_FIGURES if is_loop else figures
    if kind not in known:
        if kind in LOOP_FIGURES:
            message = f"a figure of kind '{kind}' needs a loop"
            raise refused(message, "name its gain: --gain K, or gain in [figures]")
        hint = nearest(kind, known) or "kinds: " + ", ".join(known)
        raise UsageError(Diagnostic("SF208", f"there is no figure of kind '{kind[:64]}'", None, hint))
    _check_frame(kind, frame)
    if not isinstance(drawn, Sequence):
        return _styled(font, canvas, lambda: LOOP_FIGURES[kind](drawn, canvas))
    if not drawn:
        raise ValueError("a figure needs a transfer function")
    for bound in drawn:
        if bound.is_zero:
            raise ModelError(Diagnostic("SF402", f"{bound.name} is identically zero: nothing to draw"))
    canvas = replace(canvas, model=model)
    return _styled(font, canvas, lambda: figures[kind](drawn, canvas))


def draw_shape(
    model: Model,
    shape: EnclosedModeShape,
    *,
    width_mm: float | None = None,
    font: str = DEFAULT_FONT,
    ax: AxesGiven | None = None,
) -> Figure:
    """Draw one mode shape of a model, as :func:`draw` draws several; SF402 if nothing moves."""
    from symflex.figures.modes import draw_shapes, heading
    from symflex.figures.runs import panels_of

    canvas = _canvas(None, FREE, None, width_mm, ax)
    if not panels_of(model, [shape]):
        raise ModelError(Diagnostic("SF402", "nothing that moves in this mode could be drawn"))
    return _styled(font, canvas, lambda: draw_shapes(model, [shape], [heading(shape)], canvas))


def picture_of_shape(model: Model, shape: EnclosedModeShape) -> Raster | None:
    """Return one mode shape as a notebook shows it; None if nothing moves that could be drawn."""
    from symflex.figures.runs import panels_of

    return raster_of(draw_shape(model, shape)) if panels_of(model, [shape]) else None


def part_shown(kind: str, given: PlotOptions) -> tuple[tuple[Fraction, Fraction] | None, AxisLimits]:
    """Return the band [Hz] and the limits of axes that options say.

    Raises UsageError: SF902 for what are not limits, and for two of the frequencies of a Bode plot.
    """
    band, xlim = given.band, given.xlim
    if xlim is not None and kind == "bode":
        if band is not None:
            raise refused("give only one of --band and --xlim")
        band, xlim = xlim, None
    if given.asymptotes and kind != "bode":
        raise refused(f"--asymptotes is for bode, not for '{kind}'")
    if given.at and kind != "deflection":
        raise refused(f"--at is for deflection, not for '{kind}'")
    if given.spread is not None and kind != "poles_zeros":
        raise refused(f"--spread is for poles_zeros, not for '{kind}'")
    is_plane = kind in ("locus", "poles_zeros")
    frame = AxisLimits(
        axis_ends(xlim, "--xlim", is_frequency=is_plane),
        axis_ends(given.ylim, "--ylim", is_frequency=is_plane),
        axis_ends(given.phase, "--phase"),
        given.asymptotes,
        given.verdict,
        tuple(frequency(each, "--at", "30 or '30 Hz'", is_hertz=True) for each in given.at),
    )
    is_logarithmic = kind in ("bode", "nichols", "nyquist", "sensitivity", "sigma")  # without 0
    return None if band is None else band_ends(band, above_zero=is_logarithmic), frame


def _canvas(
    band_hz: tuple[float | Fraction, float | Fraction] | None,
    frame: AxisLimits,
    title: str | None,
    width_mm: float | None,
    ax: AxesGiven | None,
) -> Canvas:
    """Return what is asked of a figure, checked and in the units of matplotlib."""
    band = None if band_hz is None else (float(band_hz[0]), float(band_hz[1]))
    if band is not None and not 0 <= band[0] < band[1] < float("inf"):
        message = f"a band runs from a lower to a higher frequency, not from {band[0]:g} to {band[1]:g} Hz"
        raise UsageError(Diagnostic("SF227", message))
    width = None if width_mm is None else checked_width(width_mm) / MM_PER_INCH
    return Canvas(band, frame, title, width, axes_of(ax))


def _styled(font: str, canvas: Canvas, drawing: Callable[[], Figure]) -> Figure:
    """Draw in the style of a paper, with texts in a font that has their letters; or on axes as they are."""
    if canvas.axes:
        return drawing()
    with paper_style(font):
        figure = drawing()
    for text in (t for t in figure.findobj(Text) if not t.get_parse_math()):
        if family := family_of(text.get_text(), font):
            text.set_fontfamily(family)
    return figure


def _check_frame(kind: str, frame: AxisLimits) -> None:
    """Refuse limits of axes that a kind of figure has not."""
    if frame.phase and kind != "bode":
        raise refused("limits of a phase are for 'bode'")
    if frame.x and kind == "bode":
        raise refused("the frequencies of a Bode plot are its band")
    if frame != FREE and kind in ("deflection", "modes"):
        raise refused("shapes have no limits: their largest displacement is 1")


def draw_over(
    stability: StabilityChart | StabilityMap | PassiveChart, given: PlotOptions, ax: AxesGiven | None = None
) -> Figure:
    """Draw for which values of one parameter, or of two, a model is stable, as options say."""
    from symflex.figures.stability import draw_stability

    canvas = _canvas(None, FREE, None, width_of(given.width), ax)
    drawing = partial(draw_stability, stability, canvas, with_box=given.box)
    return _styled(given.font or DEFAULT_FONT, canvas, drawing)
