r"""From a figure to a file; in PGF, for ``\input`` into a paper, TeX sets its texts in the paper's font.

No TeX is needed to write one. How much room a text has is computed from the metrics of the fonts that come
with matplotlib; where it is centred or ends, TeX measures it itself. A text is either mathematics that
:func:`~symflex.print.label.read_label` reads completely, or it is escaped: nothing that a specification
says reaches a command.
"""

from __future__ import annotations

import logging
import re
import warnings
from contextlib import contextmanager
from io import BytesIO
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib import rc_context
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_rgba
from matplotlib.path import Path as Outline

from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.figures.style import DEFAULT_FONT, PRIMES, paper_style
from symflex.files.write import write_atomically
from symflex.print.label import read_label
from symflex.print.latex.text import escape_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from matplotlib.backend_bases import GraphicsContextBase
    from matplotlib.figure import Figure
    from matplotlib.font_manager import FontProperties
    from matplotlib.text import Text
    from matplotlib.transforms import Transform
    from matplotlib.typing import ColorType
    from numpy.typing import ArrayLike


# What would differ from run to run, or from one version of matplotlib to the next, is left out.
FORMATS: Final[dict[str, dict[str, str | None]]] = {
    "pdf": {"Creator": "symflex", "Producer": None, "CreationDate": None},
    "pgf": {},
    "png": {"Software": None},
    "svg": {"Creator": "symflex", "Date": None},
}


def render(figure: Figure, format: str, *, font: str = DEFAULT_FONT, has_text: bool = False) -> bytes:
    """Return a figure as the content of a file; equal figures give equal bytes.

    ``format`` is ``pdf``, ``pgf``, ``png`` or ``svg``; ``font`` is that in which the figure was drawn. With
    ``has_text`` an SVG holds texts, not outlines of letters. Raises UsageError: SF208 for any other format or
    font.
    """
    if format not in FORMATS:
        hint = nearest(format, FORMATS) or "formats: " + ", ".join(FORMATS)
        raise UsageError(Diagnostic("SF208", f"figures are not written as '{format[:64]}'", None, hint))
    buffer = BytesIO()
    with paper_style(font):
        if format == "pgf":
            return pgf_figure(figure).encode("ascii")
        with _quietly(), rc_context({"svg.fonttype": "none"} if has_text else {}):
            figure.savefig(buffer, format=format, metadata=FORMATS[format])
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
    """Write a figure to a file, as a whole or not at all.

    The format is by default what the file's name ends in. Raises UsageError: SF208 an unknown format; SF903
    the file cannot be written.
    """
    chosen = path.suffix.removeprefix(".").lower() if format is None else format
    write_atomically(path, render(figure, chosen, font=font))


MM_PER_INCH: Final = 25.4
DOTS_PER_INCH: Final = 72.0
TEX_POINTS: Final = 72.27 / DOTS_PER_INCH
FARTHEST: Final = 5000.0
"""TeX has no lengths beyond 16383 points."""
_LINE_SPACING: Final = 1.2
_DOLLAR: Final = re.compile(r"(?<!\\)\$")
_DEFAULT_FONT: Final = re.compile(r"\\mathdefault\{([^{}]*)\}")
_CAPS: Final = {"butt": "butt", "round": "round", "projecting": "rect"}
_UPRIGHT: Final = 90.0
_TURNED: Final = {"top": "right", "bottom": "left", "center": "center"}
"""A text that runs upwards begins at its bottom."""


def pgf_text(text: str, *, is_math: bool = True) -> str:
    r"""Return a text of a figure as LaTeX.

    ``is_math`` is False when dollar signs are dollar signs.

    Examples
    --------
    >>> print(pgf_text(r"Gain [dB re 1 $\mathrm{m/N}$]"), pgf_text("$10^{2}$ 5%", is_math=False))
    Gain [dB re 1 $\mathrm{m/N}$] \$10\textasciicircum{}\{2\}\$ 5\%
    >>> print(pgf_text(r"$\input{x}$"))
    \textbackslash{}input\{x\}
    """
    parts = _DOLLAR.split(text) if is_math else [text]
    if len(parts) % 2 == 0:
        parts = [text]
    return "".join(_mathematics(part) if i % 2 else _prose(part) for i, part in enumerate(parts))


def pgf_figure(figure: Figure) -> str:
    r"""Return a figure as a ``pgfpicture`` exactly as wide as the figure.

    Equal figures give equal text, in ASCII. Colours and transparency are kept; images cannot be drawn.
    """
    renderer = _Renderer(figure.get_figwidth(), figure.get_figheight())
    dpi = figure.dpi
    with warnings.catch_warnings():
        # Letters that matplotlib has no glyphs of are TeX's to set.
        warnings.filterwarnings("ignore", r"Glyph \d+", UserWarning)
        try:
            figure.dpi = DOTS_PER_INCH
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
            *renderer.lines,
            # No space comes of a line that ends in a command.
            r"\end{pgfpicture}\relax",
            "",
        )
    )


def _prose(text: str) -> str:
    before = " " if text[:1].isspace() else ""
    after = " " if text[-1:].isspace() and text.strip() else ""
    return f"{before}{escape_text(text)}{after}"


def _mathematics(latex: str) -> str:
    # A number on an axis says that it is set in the font of texts, which is TeX's own choice of digits.
    plain = _DEFAULT_FONT.sub(r"{\1}", latex).replace("\N{MINUS SIGN}", "-")
    for written, sign in PRIMES.items():
        plain = plain.replace(sign, written)
    return escape_text(latex) if read_label(plain) is None else f"${plain}$"


def _decimal(value: float, places: int) -> str:
    text = f"{value:.{places}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _point(x: float, y: float) -> str:
    return rf"\pgfqpoint{{{_decimal(TEX_POINTS * x, 2)}pt}}{{{_decimal(TEX_POINTS * y, 2)}pt}}"


class _Renderer(RendererBase):
    """Writes what matplotlib draws, at 72 dots per inch."""

    def __init__(self, width: float, height: float) -> None:
        super().__init__()
        self._size = (width * DOTS_PER_INCH, height * DOTS_PER_INCH)
        self.lines: list[str] = []

    def flipy(self) -> bool:
        """Say that y runs upwards."""
        return False

    def get_canvas_width_height(self) -> tuple[float, float]:
        """Return the size in dots."""
        return self._size

    def points_to_pixels(self, points: ArrayLike) -> ArrayLike:
        """Return a length in dots, which are points."""
        return points

    def draw_path(
        self, gc: GraphicsContextBase, path: Outline, transform: Transform, rgbFace: ColorType | None = None
    ) -> None:
        """Stroke a path, and fill it where it has a colour inside."""
        is_stroked = gc.get_linewidth() > 0
        actions = [
            name for name, is_done in (("stroke", is_stroked), ("fill", rgbFace is not None)) if is_done
        ]
        if not actions:
            return
        self.lines.append(r"\begin{pgfscope}")
        self._clip(gc)
        if is_stroked:
            self._pen(gc)
        if rgbFace is not None:
            *colour, alpha = to_rgba(rgbFace)
            self._colour("fill", colour, gc.get_alpha() if gc.get_forced_alpha() else alpha)
        self._trace(path, transform, gc if rgbFace is None else None)
        self.lines += [rf"\pgfusepath{{{','.join(actions)}}}", r"\end{pgfscope}"]

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
        red, green, blue = gc.get_rgb()[:3]
        colour = rf"\color[rgb]{{{_triple((red, green, blue))}}}" if (red, green, blue) != (0, 0, 0) else ""
        body = pgf_text(s, is_math=bool(ismath))
        self.lines += [
            r"\begin{pgfscope}",
            rf"\pgftext[{','.join(options)}]{{{font}{colour}{{}}{body}}}",
            r"\end{pgfscope}",
        ]

    def _clip(self, gc: GraphicsContextBase) -> None:
        box = gc.get_clip_rectangle()
        if box is not None:
            corner, size = _point(box.x0, box.y0), _point(box.width, box.height)
            self.lines.append(rf"\pgfpathrectangle{{{corner}}}{{{size}}}\pgfusepath{{clip}}")
        path, transform = gc.get_clip_path()
        if path is not None and transform is not None:
            self._trace(path, transform, None)  # type: ignore[arg-type]  # a Path, unlike the stub says
            self.lines.append(r"\pgfusepath{clip}")

    def _pen(self, gc: GraphicsContextBase) -> None:
        width = _decimal(TEX_POINTS * gc.get_linewidth(), 3)
        cap, join = _CAPS[gc.get_capstyle()], gc.get_joinstyle()
        self.lines.append(rf"\pgfsetlinewidth{{{width}pt}}\pgfset{cap}cap\pgfset{join}join")
        offset, dashes = gc.get_dashes()
        if dashes is not None:
            pattern = "".join(
                f"{{{_decimal(TEX_POINTS * dash, 3)}pt}}"
                for dash in np.atleast_1d(np.asarray(dashes, dtype=float))
            )
            self.lines.append(
                rf"\pgfsetdash{{{pattern}}}{{{_decimal(TEX_POINTS * float(offset or 0), 3)}pt}}"
            )
        *colour, alpha = to_rgba(gc.get_rgb())
        self._colour("stroke", colour, gc.get_alpha() if gc.get_forced_alpha() else alpha)

    def _colour(self, what: str, colour: Sequence[float], alpha: float) -> None:
        self.lines.append(
            rf"\definecolor{{figure{what}}}{{rgb}}{{{_triple(colour)}}}\pgfset{what}color{{figure{what}}}"
        )
        if alpha != 1.0:
            self.lines.append(rf"\pgfset{what}opacity{{{_decimal(alpha, 3)}}}")

    def _trace(self, path: Outline, transform: Transform, gc: GraphicsContextBase | None) -> None:
        """Write a path; of a line that is only stroked, what is in sight."""
        box = None if gc is None else gc.get_clip_rectangle()
        seen = (-FARTHEST, -FARTHEST, FARTHEST, FARTHEST) if box is None else (box.x0, box.y0, box.x1, box.y1)
        for points, code in path.iter_segments(transform, clip=seen, remove_nans=True):
            pairs = [_point(float(x), float(y)) for x, y in np.reshape(points, (-1, 2))]
            if code == Outline.MOVETO:
                self.lines.append(rf"\pgfpathmoveto{{{pairs[0]}}}")
            elif code == Outline.LINETO:
                self.lines.append(rf"\pgfpathlineto{{{pairs[0]}}}")
            elif code == Outline.CLOSEPOLY:
                self.lines.append(r"\pgfpathclose")
            else:
                name = "quadraticcurveto" if code == Outline.CURVE3 else "curveto"
                self.lines.append(rf"\pgfpath{name}{''.join(f'{{{pair}}}' for pair in pairs)}")


def _triple(colour: Sequence[float]) -> str:
    return ",".join(_decimal(part, 4) for part in colour)
