r"""Tables that fit a column: narrower heads, then smaller type, until the widest row has room.

Long tables become several with the same head, so that pages, and the columns of a page, may break between
them; ``longtable`` would not do so in two columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.print.width import CDOT, DIGIT, MINUS, OPERATOR, SCRIPT, THIN

if TYPE_CHECKING:
    from collections.abc import Sequence

LINES_PER_PART: Final = 40
"""A table with more lines is set in parts."""
SIZES: Final = (("", 1.0), (r"\small", 0.93), (r"\footnotesize", 0.86))
"""Commands, and how wide letters are then, of those of ten points."""
_SETUP: Final = r"\sisetup{per-mode=symbol,group-digits=integer}"
_GAP: Final = 1.21
_NARROW_GAP: Final = 0.61
_DOT: Final = 0.28


@dataclass(frozen=True, slots=True)
class TabularColumn:
    """A column of a table."""

    format: str  # for ``tabular``: ``l``, ``S[...]``, ``p{...}``
    head: tuple[str, ...]  # lines of its head
    head_widths: tuple[float, ...]  # of these lines [em]
    cells: tuple[str, ...]  # LaTeX
    width: float  # of the widest cell [em]

    def needs(self, *, is_stacked: bool) -> float:
        """Return the width that the column takes [em], its head in one line or in several."""
        head = max(self.head_widths) if is_stacked else sum(self.head_widths) + DIGIT * (len(self.head) - 1)
        return max(self.width, head)


@dataclass(frozen=True, slots=True)
class Setting:
    """How a table is set."""

    size: str  # command that chooses the size of type, empty for the text's own
    scale: float  # how wide letters are then
    is_stacked: bool  # heads stand in several lines
    is_dense: bool = False  # columns stand closer

    def width(self, columns: Sequence[TabularColumn]) -> float:
        """Return the width of a table set like this [em of ten points]."""
        gap = _NARROW_GAP if self.is_dense else _GAP
        cells = sum(column.needs(is_stacked=self.is_stacked) for column in columns)
        return self.scale * cells + gap * (len(columns) - 1)


SETTINGS: Final = (
    Setting("", 1.0, is_stacked=False),
    *(Setting(size, scale, is_stacked=True) for size, scale in SIZES),
    Setting(*SIZES[-1], is_stacked=True, is_dense=True),
)


def fitting(columns: Sequence[TabularColumn], width: float) -> Setting | None:
    """Return the first of the settings in which a table has room [em], None when it has in none."""
    return next((setting for setting in SETTINGS if setting.width(columns) <= width), None)


def tabular(columns: Sequence[TabularColumn], setting: Setting, heights: Sequence[int] | None = None) -> str:
    r"""Return a table, centred, as a paragraph of its own.

    ``heights`` are the lines that each row takes, one by default.
    """
    formats = "".join(column.format for column in columns)
    lines = zip(*(column.cells for column in columns), strict=True)
    rows = [f"    {' & '.join(cells)} \\\\" for cells in lines]
    head = " & ".join(_head(column, setting) for column in columns)
    parts = []
    for start, end in _parts(heights or [1] * len(rows)):
        body = "\n".join(rows[start:end])
        parts.append(
            f"  \\begin{{tabular}}{{@{{}}{formats}@{{}}}}\n    \\toprule\n    {head} \\\\\n    \\midrule\n"
            f"{body}\n    \\bottomrule\n  \\end{{tabular}}\\par"
        )
    dense = r"\setlength{\tabcolsep}{3pt}" if setting.is_dense else ""
    return f"\\par{{\\centering{setting.size}{_SETUP}{dense}\n" + "\\medskip\n".join(parts) + "}"


def number_column(
    head: tuple[str, ...], head_widths: tuple[float, ...], cells: Sequence[str]
) -> TabularColumn:
    r"""Return a column of numbers, aligned by siunitx; cells in braces are not numbers.

    Cells are decimals such as ``-1.5e-3``, of which ``\pm`` may stand before; the widths of the lines of the
    head are in em.
    """
    numbers = [cell for cell in cells if not cell.startswith("{")]
    signed = any(cell.startswith(("-", r"\pm")) for cell in numbers)
    whole = places = exponent = 0
    negative_exponent = False
    for cell in numbers:
        mantissa, _, power = cell.removeprefix(r"\pm ").removeprefix("-").partition("e")
        before, _, after = mantissa.partition(".")
        whole, places = max(whole, len(before)), max(places, len(after))
        exponent = max(exponent, len(power.removeprefix("-")))
        negative_exponent = negative_exponent or power.startswith("-")
    whole = max(whole, 1)
    power = f"e{'-' if negative_exponent else ''}{exponent}" if exponent else ""
    width = (MINUS if signed else 0) + DIGIT * whole + THIN * (whole // 4)
    width += _DOT + DIGIT * places if places else 0
    if exponent:
        width += OPERATOR + 2 * DIGIT + SCRIPT * (DIGIT * exponent + (MINUS if negative_exponent else 0))
    braced = tuple(f"{{{line}}}" for line in head)
    plain = f"S[table-format={'+' if signed else ''}{whole}.{places}{power}]"
    return TabularColumn(plain, braced, head_widths, tuple(cells), width)


def number_width(text: str) -> float:
    r"""Return the width of a decimal such as ``-1.5e-3`` as ``\num`` sets it [em]."""
    mantissa, _, power = text.partition("e")
    width = MINUS * mantissa.startswith("-") + DIGIT * len(mantissa) + THIN * (len(mantissa) // 4)
    return width + (2 * DIGIT + OPERATOR + CDOT + SCRIPT * DIGIT * (len(power) + 1) if power else 0)


def _head(column: TabularColumn, setting: Setting) -> str:
    if len(column.head) == 1:
        return column.head[0]
    lines = [line.removeprefix("{").removesuffix("}") for line in column.head]
    if setting.is_stacked:
        stacked = r"\\".join(lines)
        return rf"{{\shortstack{{{stacked}}}}}"
    return f"{{{' '.join(lines).replace('- ', '')}}}"


def _parts(heights: Sequence[int]) -> list[tuple[int, int]]:
    """Return where the parts of a table begin and end."""
    parts, start, lines = [], 0, 0
    for i, height in enumerate(heights):
        if i > start and lines + height > LINES_PER_PART:
            parts.append((start, i))
            start, lines = i, 0
        lines += height
    return [*parts, (start, len(heights))]
