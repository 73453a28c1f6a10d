"""Figures of transfer functions and loops, as Python asks for them: options of ``symflex plot``, and axes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.options import PlotOptions, gain_ends
from symflex.print.latex import column_width

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from symflex.figures import AxesGiven
    from symflex.loops import AnyLoop
    from symflex.transfer import BoundTransferFunction


def width_of(width: float | str | None) -> float | None:
    """Return the width of a figure [mm], from a number of mm or the name of a column.

    Examples
    --------
    >>> width_of("ieee"), width_of(120), width_of(None)
    (88.5, 120, None)
    """
    return None if width is None else column_width(width)


def plot_functions(
    given: PlotOptions, bounds: Sequence[BoundTransferFunction], ax: AxesGiven | None = None
) -> Figure:
    """Draw a figure of transfer functions; see :func:`symflex.figures.draw`."""
    from symflex.figures import DEFAULT_FONT, draw, part_shown  # imports matplotlib

    if given.modes is not None:
        bounds = [_with_modes(bound, given.modes) for bound in bounds]
    band, frame = part_shown(given.kind, given)
    return draw(
        given.kind,
        [bound.source for bound in bounds],
        bounds,
        band_hz=band,
        frame=frame,
        width_mm=width_of(given.width),
        font=given.font or DEFAULT_FONT,
        ax=ax,
    )


def _with_modes(bound: BoundTransferFunction, modes: int) -> BoundTransferFunction:
    """Return a function whose model asks for so many modes."""
    model = bound.source.model
    model = replace(model, analysis=replace(model.analysis, modes=modes))
    return replace(bound, source=replace(bound.source, model=model))


def plot_loop(given: PlotOptions, loop: AnyLoop, ax: AxesGiven | None = None) -> Figure:
    """Draw a root locus or the Nyquist plot of a loop gain; see :func:`symflex.figures.draw_loop`."""
    from symflex.figures import DEFAULT_FONT, draw_loop, part_shown  # imports matplotlib

    band, frame = part_shown(given.kind, given)
    return draw_loop(
        given.kind,
        loop,
        limits=gain_ends(given.limits, loop.gain),
        modes=given.modes,
        band_hz=band,
        frame=frame,
        width_mm=width_of(given.width),
        font=given.font or DEFAULT_FONT,
        ax=ax,
    )
