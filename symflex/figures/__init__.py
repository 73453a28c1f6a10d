"""Figures for a paper: vector output, column width, the same bytes on every run.

A new kind is one file with a drawing function, and one line in :data:`FIGURES`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from symflex.figures.axes import AxesGiven, AxisLimits, Drawing
    from symflex.figures.bode import draw_response
    from symflex.figures.files import FORMATS, render, save
    from symflex.figures.fitted import draw_fit, draw_measured, draw_orders
    from symflex.figures.in_time import draw_in_time, draw_residual
    from symflex.figures.kinds import (
        FIGURES,
        LOOP_FIGURES,
        draw,
        draw_over,
        draw_shape,
        part_shown,
        picture_of_shape,
    )
    from symflex.figures.style import DEFAULT_FONT, FONTS, checked_font
    from symflex.figures.sweep import draw_sweep

_HOME: Final = {
    "axes": "AxesGiven AxisLimits Drawing",
    "bode": "draw_response",
    "files": "FORMATS render save",
    "fitted": "draw_fit draw_measured draw_orders",
    "in_time": "draw_in_time draw_residual",
    "kinds": "FIGURES LOOP_FIGURES draw draw_over draw_shape part_shown picture_of_shape",
    "style": "DEFAULT_FONT FONTS checked_font",
    "sweep": "draw_sweep",
}  # modules of the public names, imported on first use: a drawing of a model takes a style and no roots


def __getattr__(name: str) -> object:
    for module, names in _HOME.items():
        if name in names.split():
            return getattr(import_module(f"symflex.figures.{module}"), name)
    raise AttributeError(f"module 'symflex.figures' has no attribute '{name}'")
