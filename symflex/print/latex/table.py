"""Tables of parameters, poles, zeros and modes, with booktabs and siunitx, as wide as a column allows.

A table that is too wide gets narrower heads, then smaller type, until the widest row has room. Long tables
become several with the same head, so that pages, and the columns of a page, may break between them;
``longtable`` would not do so in two columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from typing import TYPE_CHECKING, Final

from symflex.expressions.format import decimal_exponent
from symflex.print.label import symbol
from symflex.print.latex.equation import model_labels
from symflex.print.latex.page import COLUMNS_MM
from symflex.print.latex.text import escape_text, text_width
from symflex.print.latex.units import quantity_latex, siunitx_unit, unit_latex
from symflex.print.roots import MODE_COLUMNS, PAPER_COLUMNS, columns_for, one_of_each_pair, roots_of
from symflex.print.width import CDOT, DIGIT, EM_MM, MINUS, OPERATOR, SCRIPT, THIN

if TYPE_CHECKING:
    from symflex.model import ExactValue, Model, ModelParameter
    from symflex.print.roots import PrintedRoot, RootColumn
    from symflex.roots import PoleZeroMap


VALUE_DIGITS: Final = 7  # significant digits of a value that is not a shorter decimal
ROOT_DIGITS: Final = 6  # significant digits of a root, if its radius certifies them and the column has room
LONGEST_MEANING: Final = 400  # characters of a description that a table prints; a row must fit a page
_FEWEST_DIGITS: Final = 3
_PI: Final = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
_LARGEST_PLAIN: Final = 5
_SMALLEST_PLAIN: Final = -4
_NARROWEST_MEANING: Final = 12.5
_WRAPPED: Final = r">{{\raggedright\arraybackslash}}p{{{:.1f}mm}}"


def parameter_table(model: Model, *, width_mm: float = COLUMNS_MM["a4"]) -> str:
    """Return the table of a model's parameters: symbol, meaning, value in the unit it was given in."""
    labels = model_labels(model)
    widths = [symbol(p.name, labels).width for p in model.settable]
    symbols = tuple(f"${labels[p.name]}$" for p in model.settable)
    first = TabularColumn("l", ("Symbol",), (text_width("Symbol"),), symbols, max(widths, default=0.0))
    values = tuple(map(_value, model.settable))
    widest = max(map(_value_width, model.settable), default=0.0)
    last = TabularColumn("l", ("Value",), (text_width("Value"),), values, widest)
    room = width_mm / EM_MM
    docs = [p.doc for p in model.settable]
    if not any(docs):
        return tabular((first, last), fitting((first, last), room) or SETTINGS[-1])
    texts = [d if len(d) <= LONGEST_MEANING else f"{d[:LONGEST_MEANING]}\u2026" for d in docs]
    meanings = tuple(map(escape_text, texts))
    natural = TabularColumn(
        "l", ("Meaning",), (text_width("Meaning"),), meanings, max(map(text_width, texts))
    )
    if SETTINGS[0].width((first, natural, last)) <= room:
        return tabular((first, natural, last), SETTINGS[0])
    for setting in SETTINGS:
        left = room - setting.width((first, TabularColumn("p", ("",), (0.0,), (), 0.0), last))
        if left >= _NARROWEST_MEANING * setting.scale:
            return tabular((first, _wrapped(natural, left), last), setting, _heights(texts, left, setting))
    # Without room beside each other, a value stands below its meaning.
    setting = SETTINGS[-1]
    left = room - setting.width((first, TabularColumn("p", ("",), (0.0,), (), 0.0)))
    both = tuple(rf"{m}\newline {v}" if m else v for m, v in zip(meanings, values, strict=True))
    below = TabularColumn("l", ("Meaning, value",), natural.head_widths, both, 0.0)
    heights = [1 + height for height in _heights(texts, left, setting)]
    return tabular((first, _wrapped(below, left)), setting, heights)


def _wrapped(column: TabularColumn, width: float) -> TabularColumn:
    """Return a column of paragraphs of a width [em]."""
    return TabularColumn(_WRAPPED.format(width * EM_MM), column.head, column.head_widths, column.cells, width)


def _heights(texts: Iterable[str], width: float, setting: Setting) -> list[int]:
    """Return how many lines paragraphs take in a column [em], words being kept whole."""
    return [1 + int(setting.scale * text_width(text) / (0.8 * width)) for text in texts]


def root_table(
    located: PoleZeroMap, kind: str, *, digits: int = ROOT_DIGITS, width_mm: float = COLUMNS_MM["a4"]
) -> str:
    """Return the table of poles, zeros or hidden roots, a ``kind`` of :data:`~symflex.print.roots.KINDS`.

    Each number has the digits that the enclosure certifies, at most ``digits``, fewer in a narrow column.
    """
    entries = one_of_each_pair(roots_of(located, kind))
    return _table_of(entries, columns_for(PAPER_COLUMNS, [e.root for e in entries]), digits, width_mm / EM_MM)


def mode_table(
    maps: Sequence[PoleZeroMap], *, digits: int = ROOT_DIGITS, width_mm: float = COLUMNS_MM["a4"]
) -> str:
    """Return the table of the modes that are poles of any of several functions; see :func:`root_table`."""
    from symflex.roots.root import overlap  # imports numpy

    modes: list[PrintedRoot] = []
    for located in maps:
        for entry in one_of_each_pair(located.all_poles):
            same = [i for i, m in enumerate(modes) if overlap(m.root, entry.root)]
            if not same:
                modes.append(entry)
            elif entry.root.multiplicity > modes[same[0]].root.multiplicity:
                modes[same[0]] = entry
    modes.sort(key=lambda m: float(m.root.natural_frequency().mid()))
    # Rigid-body motions are number 0, as mode_shape() counts.
    before = accumulate((0 if m.root.is_zero else m.root.multiplicity for m in modes), initial=1)
    numbers = ["0" if m.root.is_zero else str(n) for m, n in zip(modes, before, strict=False)]
    columns = columns_for(MODE_COLUMNS, [m.root for m in modes])
    return _table_of(modes, columns, digits, width_mm / EM_MM, ("Mode", numbers))


def _table_of(
    entries: Sequence[PrintedRoot],
    shown: Sequence[RootColumn],
    digits: int,
    room: float,
    first: tuple[str, Sequence[str]] | None = None,
) -> str:
    """Return a table of roots with as many digits as there is room for [em]."""
    for count in range(digits, min(digits, _FEWEST_DIGITS) - 1, -1):
        columns = []
        if first is not None:
            title, numbers = first
            columns.append(TabularColumn("r", (title,), (text_width(title),), tuple(numbers), 2.0))
        rows = [entry.cells(shown, count, r"\pm ") for entry in entries]
        for i, column in enumerate(shown):
            cells = [_cell(column, entry, row[i]) for entry, row in zip(entries, rows, strict=True)]
            columns.append(_number_column(column, cells))
        if any(entry.root.multiplicity > 1 for entry in entries):
            times = tuple(str(entry.root.multiplicity) for entry in entries)
            head = ("Multi-", "plicity")
            columns.append(TabularColumn("r", head, tuple(map(text_width, head)), times, 1.0))
        if (setting := fitting(columns, room)) is not None:
            break
    return tabular(columns, setting or SETTINGS[-1])


def decimal_text(value: ExactValue) -> str:
    """Return a value as a decimal, with pi to eighty digits; without trailing zeros unless it is rounded."""
    number = value.rational * _PI**value.pi_power
    if number == 0:
        return "0"
    sign, size = ("-" if number < 0 else ""), abs(number)
    leading = decimal_exponent(size)
    count = round(size / Fraction(10) ** (leading - VALUE_DIGITS + 1))
    if count == 10**VALUE_DIGITS:
        leading, count = leading + 1, count // 10
    text = str(count)
    if Fraction(count) * Fraction(10) ** (leading - VALUE_DIGITS + 1) == size:
        text = text.rstrip("0")
    if _SMALLEST_PLAIN <= leading < 0:
        return f"{sign}0.{'0' * (-leading - 1)}{text}"
    if 0 <= leading <= _LARGEST_PLAIN:
        whole = text[: leading + 1].ljust(leading + 1, "0")
        return f"{sign}{whole}{'.' if len(text) > leading + 1 else ''}{text[leading + 1 :]}"
    return f"{sign}{text[0]}{'.' if len(text) > 1 else ''}{text[1:]}e{leading}"


def _value(parameter: ModelParameter) -> str:
    value, unit = parameter.as_written()
    if value is None:
        return f"symbolic, in {unit_latex(unit)}" if unit and unit != "1" else "symbolic"
    return quantity_latex(decimal_text(value), unit)


def _value_width(parameter: ModelParameter) -> float:
    value, written = parameter.as_written()
    unit = "" if written == "1" else written
    width = text_width(unit) * (1.0 if siunitx_unit(written) is None else 1.1) + 0.4
    if value is None:
        return text_width("symbolic, in ") + width
    return number_width(decimal_text(value)) + width


def _number_column(column: RootColumn, cells: Sequence[str]) -> TabularColumn:
    unit, plain = siunitx_unit(column.unit), [line.replace("$", "") for line in column.paper]
    head = (*column.paper, rf"(\unit{{{unit}}})") if column.unit else column.paper
    return number_column(head, tuple(map(text_width, [*plain, f"({column.unit})"][: len(head)])), cells)


def _cell(column: RootColumn, entry: PrintedRoot, decimal: str) -> str:
    """Return a decimal as a cell; a zero that is not exact is nearly zero."""
    if not decimal:
        return "{--}"
    is_zero = decimal.removeprefix(r"\pm ").lstrip("~") == "0"
    if is_zero and not column.is_exact(entry.root):
        return r"{$\approx 0$}"
    return f"{{${decimal.replace('+-', chr(92) + 'pm')}$}}" if "+-" in decimal else decimal


LINES_PER_PART: Final = 40  # a table with more lines is set in parts
SIZES: Final = (("", 1.0), (r"\small", 0.93), (r"\footnotesize", 0.86))  # commands, and how wide letters are
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
    """Return a table, centred, as a paragraph; ``heights`` are the lines of each row, one by default."""
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
    """Return a column of decimals such as ``-1.5e-3``, aligned by siunitx; cells in braces are no numbers."""
    numbers = [cell for cell in cells if not cell.startswith("{")]
    signed = any(cell.startswith(("-", r"\pm")) for cell in numbers)
    parts = [cell.removeprefix(r"\pm ").removeprefix("-").partition("e") for cell in numbers]
    mantissas = [mantissa.partition(".") for mantissa, _, _ in parts]
    whole = max((len(before) for before, _, _ in mantissas), default=1)
    places = max((len(after) for _, _, after in mantissas), default=0)
    exponent = max((len(power.removeprefix("-")) for _, _, power in parts), default=0)
    negative_exponent = any(power.startswith("-") for _, _, power in parts)
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
