"""The look of all figures: sizes, fonts, colours, and how names, units and frequencies are written."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from matplotlib import style
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser

from symflex.errors import Diagnostic, UsageError, nearest
from symflex.model import Input, Output
from symflex.papers.labels import GREEK
from symflex.print.label import read_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.roots import PoleZeroMap
    from symflex.transfer import AnyTransferFunction


COLUMN_INCHES: Final = 3.5
PAGE_INCHES: Final = 7.16  # a column and the text of a page in journals of the IEEE
NOTE_POINTS: Final = 7.0
TITLE_POINTS: Final = 8.0
LINE_INCHES: Final = 0.13  # height of a line of a title
TITLE_SPACING: Final = 0.95
DOTS_SHOWN: Final = 120  # dots per inch in a notebook: a column is then as wide as its lines of text

# Okabe and Ito (2008), distinct for every kind of colour blindness; their yellow is too pale for a line.
COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
# Distinct in black and white too.
DASHES: Final = ("-", (0, (5, 1.5)), (0, (5, 1.2, 1.2, 1.2)), (0, (1.2, 1.2)))
QUIET: Final = "#8C8C8C"
FAINT: Final = "#E3E3E3"
_FALLBACK: Final = ["STIXGeneral", "DejaVu Sans"]

# All come with matplotlib: the same glyphs on every computer.
FONTS: Final[dict[str, dict[str, object]]] = {
    "times": {"font.family": _FALLBACK, "mathtext.fontset": "stix"},
    # Computer Modern has no minus sign but that of mathematics.
    "latex": {
        "font.family": ["cmr10", *_FALLBACK],
        "mathtext.fontset": "cm",
        "axes.formatter.use_mathtext": True,
    },
    "sans": {"font.family": ["DejaVu Sans"], "mathtext.fontset": "dejavusans"},
}  # fonts of texts: STIX, at home next to Times; Computer Modern, that of LaTeX; one for slides
MM_PER_INCH: Final = 25.4
DEFAULT_FONT: Final = "times"
PRIMES: Final = {"'": "\N{PRIME}", "''": "\N{DOUBLE PRIME}", "'''": "\N{TRIPLE PRIME}"}
"""Signs that these fonts have for primes, by how LaTeX writes them."""

# Where Computer Modern has what ASCII and Latin-1 say; elsewhere its glyphs are others.
_COMPUTER_MODERN: Final = frozenset(
    " !#$%&'()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]`abcdefghijklmnopqrstuvwxyz"
)
_LAST_OF_LATIN: Final = "\u00c4"

_PAPER: Final[dict[str, object]] = {
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": TITLE_POINTS,
    "legend.fontsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.1,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "grid.color": FAINT,
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "savefig.dpi": 300,
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "symflex",
}


def paper_style(font: str = DEFAULT_FONT) -> AbstractContextManager[None]:
    """Return a context for a paper's style, whatever the user's settings; SF208 for any other font."""
    return style.context(["default", _PAPER | FONTS[_known(font, "SF208")]])


def _known(font: str, code: str) -> str:
    if font not in FONTS:
        hint = nearest(font, FONTS) or "fonts: " + ", ".join(FONTS)
        raise UsageError(Diagnostic(code, f"there is no font '{font[:64]}' for figures", None, hint))
    return font


def family_of(text: str, font: str) -> list[str] | None:
    """Return the families of a text that the font lacks letters for, None when it has them all."""
    if font != "latex" or all(c in _COMPUTER_MODERN or c > _LAST_OF_LATIN for c in text):
        return None
    return _FALLBACK


def stability_lines(maps: Sequence[PoleZeroMap], width: float) -> list[str]:
    """Return what stands below a title: whether what is drawn is stable, broken to a width [inches]."""
    said = list(dict.fromkeys(located.verdict.headline for located in maps))
    if len(said) > 1:
        said = [f"{located.tf}: {located.verdict.headline}" for located in maps]
    return title_lines("; ".join(said), width)


def write_titles(figure: Figure, titles: Sequence[Sequence[str]], above: float, height: float) -> None:
    """Write groups of lines below each other at the top of a figure that leaves room for them [inches]."""
    for group in titles:
        if group:
            title = figure.text(0.5, 1 - above / height, "\n".join(group), ha="center", va="top")
            title.set(fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False)
        above += LINE_INCHES * len(group)


def title_lines(title: str | None, width: float) -> list[str]:
    """Return a title broken to a width [inches], but not at equals signs, without what does not print."""
    words = " ".join((title or "").split())
    printed = "".join(c for c in words if c.isprintable()).replace(" = ", "\xa0=\xa0")
    # So many letters in eight points are never too wide.
    lines = textwrap.wrap(printed, max(8, int(18 * width)), max_lines=4, placeholder=" ...")
    return [line.replace("\xa0", " ") for line in lines]


_PARSER: Final = MathTextParser("path")
_TRAILING_DIGITS: Final = re.compile(r"(?P<stem>[A-Za-z]+)(?P<digits>\d+)")
_UNIT_TOKEN: Final = re.compile(
    r"\^\((?P<fraction>[^)]*)\)|\^(?P<power>-?\d+)|(?P<name>[A-Za-z]+)|(?P<other>.)"
)
PLAIN_LOW, PLAIN_HIGH = 1e-3, 1e5


def label_of_tf(tf: AnyTransferFunction) -> str:
    """Return ``output/input`` in matplotlib's mathematics."""
    return f"${label_of(tf.output)}/{label_of(tf.input)}$"


def label_of(end: Output | Input) -> str:
    """Return the label of an end: the model's own if matplotlib can typeset it, else one of its name."""
    label = end.latex.strip()
    if not label or read_label(label) is None:
        return label_of_name(end.name)
    try:
        _PARSER.parse(f"${{{label}}}$")
    except ValueError:
        return label_of_name(end.name)
    return f"{{{label}}}"


def label_of_name(name: str) -> str:
    """Return a name in mathematics: words upright, Greek letters as such, what follows ``_`` subscript."""
    head, *subscripts = parts = name.split("_")
    if not all(parts):  # as equations print it, so that ``L_`` is not ``L``
        spelt = name.replace("_", r"\_")
        return rf"\mathtt{{{spelt}}}"
    digits = _TRAILING_DIGITS.fullmatch(head)
    if digits and not subscripts:
        head, subscripts = digits["stem"], [digits["digits"]]
    if not subscripts:
        return _word(head)
    return f"{_word(head)}_{{{','.join(_word(part) for part in subscripts)}}}"


def _word(word: str) -> str:
    if word in GREEK:
        return f"\\{word}"
    return word if len(word) == 1 or word.isdigit() else rf"\mathrm{{{word}}}"


def size_of_text(text: str, font: FontProperties) -> tuple[float, float]:
    """Return how wide and high a line of a figure is [points], mathematics between dollar signs in it."""
    width, height, *_ = _PARSER.parse(text, 72, font)
    return float(width), float(height)


def _unit_part(token: re.Match[str]) -> str:
    """Return a part of a unit in mathematics: ohms and micro with their Greek letters."""
    if power := token["fraction"] or token["power"]:
        return f"^{{{power}}}"
    if not (name := token["name"]):
        return r"\," if token["other"] == "*" else token["other"]
    prefix = rf"\mu {name[1:]}" if name[0] == "u" and name[1:] else name
    return rf"{prefix[:-3]}\Omega" if name.endswith(("Ohm", "ohm")) else prefix


def label_of_unit(unit: str) -> str:
    """Return a unit in upright mathematics, empty for a pure or unknown one."""
    return "" if unit in ("", "1") else rf"$\mathrm{{{_UNIT_TOKEN.sub(_unit_part, unit)}}}$"


TIGHT_DOT: Final = r"\!\cdot\!"


def label_with_unit(name: str, unit: str) -> str:
    """Return a name in mathematics with its unit, which an axis shows."""
    shown = label_of_unit(unit)
    return f"${label_of_name(name)}$" + (f" [{shown}]" if shown else "")


def power_of_ten(decimal: str, times: str) -> str:
    """Return a decimal in mathematics, without a factor 1 before a power of ten."""
    mantissa, _, exponent = decimal.partition("e")
    power = f"10^{{{int(exponent or 0)}}}"
    if mantissa in ("1", "-1") and exponent:
        return f"{mantissa[:-1]}{power}"
    return f"{mantissa}{times}{power}" if exponent else mantissa


def label_of_frequency(value: float) -> str:
    """Return a number on a logarithmic axis, written out where that is short."""
    if PLAIN_LOW <= value < PLAIN_HIGH:
        return f"{value:g}"
    return f"${power_of_ten(f'{value:.0e}', TIGHT_DOT)}$"


def number_label(value: float) -> str:
    """Return a number in four digits in matplotlib's mathematics."""
    return power_of_ten(f"{value:.4g}", r"\times ")


def checked_font(font: str | None, path: Path) -> str:
    """Return the name of a font for a figure; UsageError: SF902 when there is no such font."""
    return _known(font or ("latex" if path.suffix.lower() == ".pgf" else DEFAULT_FONT), "SF902")
