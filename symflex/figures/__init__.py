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
    from symflex.figures.in_time import draw_in_time
    from symflex.figures.input_shaping import draw_residual
    from symflex.figures.kinds import (
        FIGURES,
        LOOP_FIGURES,
        draw,
        draw_loop,
        draw_shape,
        part_shown,
        picture_of_shape,
    )
    from symflex.figures.style import DEFAULT_FONT, FONTS
    from symflex.figures.sweep import draw_sweep

_HOME: Final = {
    "AxesGiven": "axes",
    "AxisLimits": "axes",
    "Drawing": "axes",
    "draw_fit": "fitted",
    "draw_measured": "fitted",
    "draw_orders": "fitted",
    "draw_response": "bode",
    "FORMATS": "files",
    "render": "files",
    "save": "files",
    "draw_in_time": "in_time",
    "draw_residual": "input_shaping",
    "FIGURES": "kinds",
    "LOOP_FIGURES": "kinds",
    "draw": "kinds",
    "draw_loop": "kinds",
    "draw_shape": "kinds",
    "part_shown": "kinds",
    "picture_of_shape": "kinds",
    "DEFAULT_FONT": "style",
    "FONTS": "style",
    "draw_sweep": "sweep",
}
"""Where each name is found when it is first used: a drawing of a model takes a style and no roots."""

__all__ = [
    "DEFAULT_FONT",
    "FIGURES",
    "FONTS",
    "FORMATS",
    "LOOP_FIGURES",
    "AxesGiven",
    "AxisLimits",
    "Drawing",
    "draw",
    "draw_fit",
    "draw_in_time",
    "draw_loop",
    "draw_measured",
    "draw_orders",
    "draw_residual",
    "draw_response",
    "draw_shape",
    "draw_sweep",
    "part_shown",
    "picture_of_shape",
    "render",
    "save",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        message = f"module 'symflex.figures' has no attribute '{name}'"
        raise AttributeError(message)
    return getattr(import_module(f"symflex.figures.{_HOME[name]}"), name)
