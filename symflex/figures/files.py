"""From a figure to a file, the same bytes on every run; PGF is written by :mod:`symflex.figures.pgf`."""

from __future__ import annotations

import html
import logging
import re
from cmath import exp, pi
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from symflex.errors import Diagnostic, UsageError, nearest, refused
from symflex.figures.style import DEFAULT_FONT, paper_style
from symflex.files.write import write_atomically

# What would differ from run to run, or from one version of matplotlib to the next, is left out.
FORMATS: Final[dict[str, dict[str, str | None]]] = {
    "gif": {},
    "pdf": {"Creator": "symflex", "Producer": None, "CreationDate": None},
    "pgf": {},
    "png": {"Software": None},
    "svg": {"Creator": "symflex", "Date": None},
}

FRAMES, FRAME_MS = 30, 50  # browsers play what is shorter than 20 ms slowly; a period lasts 1.5 s
FRAME_DOTS: Final = 144  # per inch: sharp on a slide, and 200 kB for five modes
FRAME_COLOURS: Final = 32

# Colours that figures draw with, and the variables of the style sheet that stand for them on a page.
_COLOURS: Final = {
    "#0072b2": "var(--c1)", "#d55e00": "var(--c2)", "#009e73": "var(--c3)", "#cc79a7": "var(--c4)",
    "#e69f00": "var(--c5)", "#56b4e9": "var(--c6)", "#000000": "var(--ink)", "#ffffff": "var(--paper)",
    "#8c8c8c": "var(--quiet)", "#e3e3e3": "var(--faint)",
}  # fmt: skip
_COLOUR: Final = re.compile("|".join(_COLOURS), re.IGNORECASE)
_PROLOGUE: Final = re.compile(r"^.*?(?=<svg\b)", re.DOTALL)
_METADATA: Final = re.compile(r"\s*<metadata>.*?</metadata>|\s*<style\b.*?</style>", re.DOTALL)
_IDENTIFIER: Final = re.compile(r'(\bid="|url\(#|href="#)')
_SIZE: Final = re.compile(r'\s(?:width|height)="[0-9.]+pt"')
_NAMESPACES: Final = re.compile(r'\sxmlns(?::\w+)?="[^"]*"')


def render(figure: Figure, format: str, *, font: str = DEFAULT_FONT, has_text: bool = False) -> bytes:
    """Return a figure, drawn in ``font``, as the content of a file; equal figures give equal bytes.

    In ``gif`` shapes move. With ``has_text`` an SVG holds texts, not outlines of letters. Raises SF208
    for any other format or font, SF902 for a GIF of what does not move.
    """
    if format not in FORMATS:
        hint = nearest(format, FORMATS) or "formats: " + ", ".join(FORMATS)
        raise UsageError(Diagnostic("SF208", f"figures cannot be written as '{format[:64]}'", None, hint))
    buffer = BytesIO()
    with paper_style(font):
        if format == "pgf":
            from symflex.figures.pgf import pgf_figure  # loads those of PDF and PostScript, too

            return pgf_figure(figure).encode("ascii")
        if format == "gif":
            return _animation(figure)
        with _quietly(), rc_context({"svg.fonttype": "none"} if has_text else {}):
            figure.savefig(buffer, format=format, metadata=FORMATS[format])
    return buffer.getvalue()


def _animation(figure: Figure) -> bytes:
    """Return one period of a motion, repeated without end."""
    from PIL import Image  # only animations need it

    moving = getattr(figure, "moving", ())  # of a ShownFigure, which imports this file to save itself
    if not moving:
        hint = "formats of other figures: pdf, pgf, png, svg"
        raise refused("only shapes move: no GIF of another figure", hint)
    canvas, dpi, pictures, buffer = FigureCanvasAgg(figure), figure.dpi, [], BytesIO()
    try:
        figure.dpi = FRAME_DOTS
        for artist, _ in moving:
            artist.set_visible(False)
        canvas.draw()  # type: ignore[no-untyped-call]
        still = canvas.copy_from_bbox(figure.bbox)  # type: ignore[no-untyped-call]
        for i in range(FRAMES):
            canvas.restore_region(still)  # type: ignore[no-untyped-call]
            for artist, move in moving:
                if move is not None:
                    move(exp(2j * pi * i / FRAMES))
                    artist.set_visible(True)
                    figure.draw_artist(artist)
            dots = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
            frame = Image.fromarray(dots).convert("RGB")
            pictures.append(frame.quantize(FRAME_COLOURS, dither=Image.Dither.NONE))
        pictures[0].save(buffer, "GIF", save_all=True, append_images=pictures[1:], duration=FRAME_MS, loop=0)
    finally:
        figure.dpi = dpi
        for artist, move in moving:
            artist.set_visible(True)
            if move is not None:
                move(1)
    return buffer.getvalue()


@contextmanager
def _quietly() -> Iterator[None]:
    """Keep back what fontTools remarks on fonts that come with matplotlib."""
    logger = logging.getLogger("fontTools")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


def save(figure: Figure, path: Path, format: str | None = None, *, font: str = DEFAULT_FONT) -> None:
    """Write a figure to a file, as a whole or not at all; by default in the format its name ends in."""
    chosen = path.suffix.removeprefix(".").lower() if format is None else format
    write_atomically(path, render(figure, chosen, font=font))


def inline_svg(svg: str, prefix: str, label: str) -> str:
    """Return a figure as an element of a page, in the colours of that, its identifiers with a prefix."""
    content = _PROLOGUE.sub("", svg, count=1)
    content = _METADATA.sub("", content)
    content = _IDENTIFIER.sub(lambda m: f"{m[1]}{prefix}-", content)
    content = _COLOUR.sub(lambda m: _COLOURS[m[0].lower()], content)
    head, tail = content.split(">", 1)
    width = re.search(r'\swidth="([0-9.]+)pt"', head)
    points = float(width[1]) if width else 252.0
    head = _NAMESPACES.sub("", _SIZE.sub("", head))
    # xlink is not declared in HTML, and not needed there.
    tail = tail.replace("xlink:href", "href")
    style = f'style="max-width:{points / 72 * 1.75:.2f}in"'
    attributes = f'class="plot" role="img" aria-label="{html.escape(label)}" {style}'
    return f"{head} {attributes}>{tail.rstrip()}"
