r"""A figure in PGF, for ``\input`` into a paper: TeX sets its texts in the paper's font.

No TeX is needed to write one. How much room a text has is computed from the metrics of the fonts that come
with matplotlib; where it is centred or ends, TeX measures it itself. A text is either mathematics that
:func:`~symflex.print.label.read_label` reads completely, or it is escaped: nothing that a specification
says reaches a command.
"""

from __future__ import annotations

import re
import warnings
from io import StringIO
from typing import Final

from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_pgf import RendererPgf
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text

from symflex.figures.style import MM_PER_INCH, PRIMES
from symflex.print.label import read_label
from symflex.print.latex.text import escape_text, prose

DOTS_PER_INCH: Final = 72.0
TEX_POINTS: Final = 72.27 / DOTS_PER_INCH
_LINE_SPACING: Final = 1.2
_DOLLAR: Final = re.compile(r"(?<!\\)\$")
_DEFAULT_FONT: Final = re.compile(r"\\mathdefault\{([^{}]*)\}")
_UPRIGHT: Final = 90.0
_TURNED: Final = {"top": "right", "bottom": "left", "center": "center"}
"""A text that runs upwards begins at its bottom."""


def pgf_text(text: str, *, is_math: bool = True) -> str:
    """Return a text of a figure as LaTeX; ``is_math`` is False when dollar signs are dollar signs."""
    parts = _DOLLAR.split(text) if is_math else [text]
    if len(parts) % 2 == 0:
        parts = [text]
    return "".join(_mathematics(part) if i % 2 else prose(part) for i, part in enumerate(parts))


def pgf_figure(figure: Figure) -> str:
    """Return a figure as a ``pgfpicture`` exactly as wide as it, in ASCII; images cannot be drawn."""
    dpi = figure.dpi
    with warnings.catch_warnings():
        # Letters that matplotlib has no glyphs of are TeX's to set.
        warnings.filterwarnings("ignore", r"Glyph \d+", UserWarning)
        try:
            figure.dpi = DOTS_PER_INCH
            renderer = _Renderer(figure)
            figure.draw(renderer)
        finally:
            figure.dpi = dpi
    width, height = (_decimal(MM_PER_INCH * inches, 5) for inches in figure.get_size_inches())
    return "\n".join(
        (
            rf"% Figure of {width} mm by {height} mm. Needs \usepackage{{pgf}}; to be read with \input.",
            r"% Texts are in the font of the paper; titles with accents need \usepackage[T1]{fontenc}.",
            r"\begin{pgfpicture}",
            rf"\pgfpathrectangle{{\pgfpointorigin}}{{\pgfqpoint{{{width}mm}}{{{height}mm}}}}",
            r"\pgfusepath{use as bounding box}",
            *renderer.written.getvalue().splitlines(),
            # No space comes of a line that ends in a command.
            r"\end{pgfpicture}\relax",
            "",
        )
    )


def _mathematics(latex: str) -> str:
    # A number on an axis says that it is set in the font of texts, which is TeX's own choice of digits.
    plain = _DEFAULT_FONT.sub(r"{\1}", latex).replace("\N{MINUS SIGN}", "-")
    for written, sign in PRIMES.items():
        plain = plain.replace(sign, written)
    return escape_text(latex) if read_label(plain) is None else f"${plain}$"


def _decimal(value: float, places: int) -> str:
    text = f"{value:.{places}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


class _Renderer(RendererPgf):
    """Writes what matplotlib draws, texts as :func:`pgf_text` and without asking TeX how large they are."""

    get_text_width_height_descent = RendererBase.get_text_width_height_descent
    # A mark is a path wherever it stands: no commands of PGF's inside.
    draw_markers = RendererBase.draw_markers

    def __init__(self, figure: Figure) -> None:
        self.written = StringIO()
        super().__init__(figure, self.written)  # type: ignore[no-untyped-call]

    def draw_text(
        self,
        gc: GraphicsContextBase,
        x: float,
        y: float,
        s: str,
        prop: FontProperties,
        angle: float,
        ismath: bool | str = False,
        mtext: Text | None = None,
    ) -> None:
        """Set one line of text with its baseline where matplotlib has it."""
        side = "left"
        if mtext is not None and angle in (0.0, _UPRIGHT):
            anchor = mtext.get_transform().transform(mtext.get_unitless_position())
            if angle == 0.0 or mtext.get_rotation_mode() == "anchor":
                side = mtext.get_horizontalalignment()
            else:
                side = _TURNED.get(mtext.get_verticalalignment(), "")
            if side and angle:
                y = float(anchor[1])
            elif side:
                x = float(anchor[0])
        where = f"x={_decimal(TEX_POINTS * x, 2)}pt,y={_decimal(TEX_POINTS * y, 2)}pt"
        options = [where, "base", *([side or "left"] if side != "center" else [])]
        if angle:
            options.append(f"rotate={_decimal(angle, 3)}")
        # Sizes that every family has.
        size = round(prop.get_size_in_points())
        font = rf"\fontsize{{{size}}}{{{_decimal(_LINE_SPACING * size, 1)}}}\selectfont"
        rgb = gc.get_rgb()[:3]
        shade = ",".join(_decimal(part, 4) for part in rgb)
        colour = rf"\color[rgb]{{{shade}}}" if any(rgb) else ""
        body = pgf_text(s, is_math=bool(ismath))
        text = rf"\pgftext[{','.join(options)}]{{{font}{colour}{{}}{body}}}"
        self.written.write(f"\\begin{{pgfscope}}\n{text}\n\\end{{pgfscope}}\n")
