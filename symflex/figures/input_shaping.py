"""Residual vibration of an input shaper over the error of a frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from flint import acb

from symflex.figures.axes import Canvas, add_legend_above, write_title
from symflex.figures.style import COLOURS, COLUMN_INCHES, DASHES, paper_style, title_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.analysis.input_shaping import InputShaper

HEIGHT_INCHES: Final = 2.3
SPAN: Final = (0.5, 1.5)
POINTS: Final = 401
TICK: Final = 5
"""Percent that designers ask for."""


def draw_residual(shaper: InputShaper) -> Figure:
    """Draw what each mode still rings, over the frequency it has in truth; its damping ratio stays."""
    ratios = np.linspace(*SPAN, POINTS)
    with paper_style():
        axes = Canvas().one_panel(HEIGHT_INCHES)
        for pole, colour, dash in zip(shaper.poles, COLOURS, DASHES, strict=False):
            middle = acb(pole.re.mid(), pole.im.mid())
            left = [100 * float(shaper.residual(middle * r).mid()) for r in ratios.tolist()]
            axes.plot(ratios, left, color=colour, linestyle=dash, label=f"{pole.frequency_hz():.4g} Hz")
        axes.grid(visible=True)
        axes.axhline(TICK, color=COLOURS[-1], linewidth=0.5)
        axes.set_xlim(*SPAN)
        axes.set_ylim(0, None)
        axes.set_xlabel("Frequency over that of the model")
        axes.set_ylabel("Residual vibration [%]")
        add_legend_above(axes, len(DASHES))
        figure = axes.figure.get_figure(root=True)
        write_title(figure, title_lines(f"{shaper.tf}, {shaper.title}", COLUMN_INCHES))
    return figure
