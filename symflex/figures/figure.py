"""A figure that belongs to no window: a notebook shows it, and it saves itself in every format."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from symflex.figures.style import DOTS_SHOWN

Raster = tuple[bytes, dict[str, int]]


class ShownFigure(Figure):
    """A figure that belongs to no window, and that a notebook shows where it is a cell's value.

    One of mode shapes also knows its ``moving`` artists: what places each, given the factor that the motion
    has turned by, or None for what is not shown in motion.
    """

    moving: tuple[tuple[Artist, Callable[[complex], object] | None], ...] = ()

    def _repr_png_(self) -> Raster:
        return raster_of(self)

    def savefig(self, fname: Any, **kwargs: Any) -> None:  # noqa: ANN401 (as matplotlib has it)
        """Save the figure as matplotlib does; GIF, and PGF without TeX, as ``symflex plot`` writes them."""
        from symflex.figures.files import save  # its backend takes time to load

        format = kwargs.get("format") or Path(str(fname)).suffix.removeprefix(".")
        if isinstance(fname, str | Path) and format.lower() in ("gif", "pgf"):
            save(self, Path(fname), format.lower())
        else:
            super().savefig(fname, **kwargs)


def raster_of(figure: Figure) -> Raster:
    """Return a figure as a notebook takes it: a PNG, and how large it is to be shown."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=2 * DOTS_SHOWN)  # sharp on fine screens
    across, upwards = (round(inches * DOTS_SHOWN) for inches in figure.get_size_inches())
    return buffer.getvalue(), {"width": across, "height": upwards}


def new_figure(width: float, height: float) -> ShownFigure:
    """Return an empty figure [inches]."""
    figure = ShownFigure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure
