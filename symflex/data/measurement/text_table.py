"""Tables of numbers in text that instruments and programs write: encoding, delimiter, decimal sign, blocks.

    Analyser 3000;V1.2              text above
    Frequency;Real;Imag.            text above, of which column_meaning.py reads the names
    1,0E+00;2,5E-04;-9,0E-07        a block of two rows: delimiter ";", decimal comma
    2,0E+00;2,6E-04;-8,8E-07

Every combination of delimiter and decimal sign cuts the lines, and the one by which most cells are numbers is
taken. A block is a run of lines that begin with a number and have as many cells; text between two blocks
belongs to the second.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.errors import DataError, Diagnostic, Source, Span

COMMENTS: Final = ("#", "%", "!", "//", "*", ";", '"#', '"*', '"!')
SIGNS: Final = "#%!/*; \t"
"""What stands before the text of a comment."""
_NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_POLAR = re.compile(rf"\(?({_NUMBER})\s*(dB\s*[,;]|(?:dB)?\s*\u2220)\s*({_NUMBER})\s*(\S{{0,3}}?)\)?", re.I)
"""Size and angle: ``(-3dB,45deg)``, ``1.2\u222045\u00b0``."""
_CARTESIAN = re.compile(
    rf"\(?({_NUMBER})\s*([-+])\s*(?:%?[ij]\s*\*?\s*)?({_NUMBER})\s*\*?\s*(?:%?[ij]m?)?\)?", re.I
)
_IMAGINARY = re.compile(rf"({_NUMBER})[ij]m?", re.I)
_PAIR = re.compile(rf"\(?({_NUMBER}),\s*({_NUMBER})\)?")
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:,\d{3})+\.\d+")
_GAPPED = re.compile(r"[-+]?\d{1,3}(?:['\u2019\u00a0\u2009\u202f]\d{3})+(?:[.,]\d+)?")
_WITH_UNIT = re.compile(rf"({_NUMBER})\s*(?:([kMG]?)(?:Hz)?|dB|deg|°|Ohm|\u03a9|\u2126)", re.I)
_PREFIXES: Final = {"": 1.0, "k": 1e3, "m": 1e6, "g": 1e9}
_APART = re.compile(r"(?<=\d),\s+(?=[-+.\d])")  # between real and imaginary part: ngspice
_SPACED = re.compile(r"(?<!\s)\s*([-+])\s*(?=[\d.]+(?:e[-+]?\d+)?[ij]m?\b)", re.I)
_GROUPED = re.compile(r"[-+]?\d{1,3}(?:\.\d{3})+,\d+")
WHOLE: Final = {d: re.compile(rf"[-+]?[1-9]\d{{0,2}}(?:\{t}\d{{3}})+") for d, t in ((".", ","), (",", "."))}
"""Whole numbers in groups of three digits by decimal sign: numbers where others show the sign."""
_CONTROL = re.compile("[\0-\x08\x0e-\x19\x1b-\x1f]")
_CANDIDATES: Final = (
    (";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (" ", "."), (" ", ","), (",", ","),
    ("|", "."),
)  # fmt: skip
"""Delimiters and decimal signs; of equals the first is taken."""
_EASTERN: Final = {"GB18030": "频率", "Shift_JIS": "周波数"}
"""Encodings beside UTF-8, and the word for a frequency by which they are known."""
SAMPLE, MOST_SAMPLED = 400, 200_000  # lines from a file's middle that decide delimiter and sign; characters
MAX_CELLS: Final = 5_000_000  # cells that all rows may have together; reading them takes 15 s and 800 MB
LONGEST_LINE: Final = 20_000
LONGEST_NUMBER: Final = 100
FEWEST_ROWS: Final = 3
SMALL_SHARE: Final = 10  # a block with under a tenth of the rows of the largest is no table of the same data


def decoded(name: str, data: bytes) -> tuple[str, tuple[str, ...]]:
    """Return the text of a file with newlines as line ends, and what was guessed; SF601 when it is none."""
    zeros = [data[i:2000:2].count(0) for i in (0, 1)]
    sixteen = "utf-16-le" if zeros[1] > max(3 * zeros[0], 1) else "utf-16-be" if zeros[0] > 3 else ""  # noqa: PLR2004
    guesses: tuple[str, ...] = ()
    try:
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            sixteen = "utf-16"
        if sixteen:  # half a character at the end is left out
            text, guesses = data[: len(data) & ~1].decode(sixteen), ("the text is UTF-16",)
        else:
            text = data.decode("utf-8")
    except UnicodeDecodeError:
        # Every letter of a name in another alphabet may be wrong then, but its unit may be right.
        encodings = (name for name, word in _EASTERN.items() if word.encode(name) in data)
        encoding = next(encodings, "Latin-1 (Windows-1252)")
        text = data.decode(encoding if encoding in _EASTERN else "cp1252", "replace")
        guesses = (f"the file is not UTF-8 and is read as {encoding}",)
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a\n")
    if match := _CONTROL.search(text):
        message = f"'{name}' is not text: it contains the control character 0x{ord(match[0]):02x}"
        raise DataError(Diagnostic("SF601", message, None, "binary formats end in .npz, .npy, .mat, .uff"))
    return text + "\n", guesses


def number(cell: str, decimal: str = ".") -> float | complex | None:
    """Return the number that a cell means; complex for ``1+2j``, ``(1,2)`` and ``(-3dB,45deg)``, or None.

    >>> number("2,5", ","), number("1.0D+3"), number("1-2i"), number("x")
    (2.5, 1000.0, (1-2j), None)
    """
    text = cell.strip("\"' ").replace("\u2212", "-")
    if _GAPPED.fullmatch(text):
        text = re.sub(r"[^-+\d.,]", "", text)
    if WHOLE[decimal].fullmatch(text):
        return float(re.sub("[.,]", "", text))
    if decimal == ",":
        if "." in text and not _GROUPED.fullmatch(text):
            return None
        text = text.replace(".", "")
        text = text.replace(",", ".") if re.search(r"\d,\d", text) else text
    if "_" in text or not 0 < len(text) <= LONGEST_NUMBER:
        return None
    try:
        return float(text)
    except ValueError:
        pass
    if re.fullmatch(r"[-+.\d]+[dD][-+]?\d+", text):
        return number(text.replace("d", "e").replace("D", "e"))
    if decimal == "." and _THOUSANDS.fullmatch(text):
        return float(text.replace(",", ""))
    if (match := _WITH_UNIT.fullmatch(text)) and not re.search(r"\dm(hz)?$", text):
        return float(match[1]) * _PREFIXES[(match[2] or "").lower()]
    return _complex_number(text)


def _complex_number(text: str) -> complex | None:
    if match := _POLAR.fullmatch(text):
        size, angle = np.float64(match[1]), float(match[3])
        with np.errstate(over="ignore"):
            size = np.float64(10) ** (size / 20) if match[2][:1] in "dD" else size
        return complex(size * np.exp(1j * (angle if match[4].lower() == "rad" else np.radians(angle))))
    match = _CARTESIAN.fullmatch(text)
    if match and re.search("[ij]", text, re.I):
        sign = -1.0 if match[2] == "-" else 1.0  # older numpy writes 1+-2j
        return complex(float(match[1]), sign * float(match[3]))
    if match := _IMAGINARY.fullmatch(text):
        return complex(0.0, float(match[1]))
    match = _PAIR.fullmatch(text)
    if match and ("(" in text or ("." in match[1] and "." in match[2])):
        return complex(float(match[1]), float(match[2]))
    return None


def bare(cell: str) -> str:
    """Return a cell without blanks and quotes around it; primes at its end, as of Z'', stay."""
    text = cell.strip().strip('"').strip()
    return text.strip("'") if text.startswith("'") else text


def cut(line: str, delimiter: str, *, are_all_kept: bool = False) -> list[str]:
    """Return the cells of a line, trailing empty ones left out or kept; quotes may hold the delimiter."""
    text = line.strip()
    if text.count('"') == 2 and text[0] == text[-1] == '"':  # noqa: PLR2004 (a whole line in quotes)
        text = text[1:-1]
    if delimiter in " \t" and ", " in text.replace(",\t", ", "):
        text = _APART.sub(",", text)
    if delimiter == " ":
        text = _SPACED.sub(r"\1", text) if "i" in text or "j" in text else text
        cells = re.findall(r'"[^"]*"|\S+', text)
    elif '"' in text:
        cells = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True), [])
    else:
        cells = text.split(delimiter)
    cells = [bare(cell) for cell in cells]
    while cells and not cells[-1] and not are_all_kept:
        cells.pop()
    return cells


@dataclass(frozen=True, eq=False)
class NumberBlock:
    """Rows of numbers, and the text above them."""

    table: TextTable
    above: tuple[int, ...]  # lines, counted from 0
    lines: tuple[int, ...]
    rows: tuple[tuple[str, ...], ...]

    @property
    def width(self) -> int:
        """How many cells most rows have."""
        return Counter(map(len, self.rows)).most_common(1)[0][0]

    @property
    def names_frequency(self) -> bool:
        """Whether one of the three lines above speaks of a frequency."""
        return any(re.search(r"\bfreq", self.table.lines[i], re.I) for i in self.above[-3:])

    def numbers(self, index: int) -> tuple[npt.NDArray[Any], tuple[int, ...]]:
        """Return a column, and the rows where it has no number."""
        cells = [row[index] if index < len(row) else "" for row in self.rows]
        if self.table.decimal == "." and not any("_" in cell for cell in cells):
            try:
                return np.array([float(cell) for cell in cells]), ()
            except ValueError:
                pass
        values = [number(cell, self.table.decimal) for cell in cells]
        wrong = tuple(i for i, value in enumerate(values) if value is None)
        return np.array([np.nan if value is None else value for value in values]), wrong

    def place(self, index: int) -> Callable[[int], Span]:
        """Return the function that says where a column's cell of a row stands."""
        return lambda row: self.table.cell(self.lines[row], self.rows[row], index)


@dataclass(frozen=True, eq=False)
class TextTable:
    """A text cut into lines, and how they are cut into cells."""

    source: Source
    lines: tuple[str, ...]
    starts: tuple[int, ...]
    delimiter: str
    decimal: str
    guesses: tuple[str, ...] = field(default=())

    @staticmethod
    def of(name: str, data: bytes) -> TextTable:
        """Return a file's text; SF601 when it is none, or has a line longer than any table's."""
        text, guesses = decoded(name, data)
        lines = tuple(text.split("\n"))
        longest = max(range(len(lines)), key=lambda i: len(lines[i]))
        if len(lines[longest]) > LONGEST_LINE:
            message = f"{name}:{longest + 1}:1: a line of {len(lines[longest])} characters"
            hint = f"at most {LONGEST_LINE} are read: turn lines that are channels into columns"
            raise DataError(Diagnostic("SF601", message, None, hint))
        lengths = np.cumsum([0, *(len(line) + 1 for line in lines)])
        delimiter, decimal = _format(lines)
        if decimal == ",":
            guesses += ("decimals are written with a comma",)
        return TextTable(Source(name, text), lines, tuple(lengths.tolist()), delimiter, decimal, guesses)

    def line(self, index: int) -> Span:
        """Return where a line stands."""
        start, text = self.starts[index], self.lines[index]
        return Span(self.source, start + len(text) - len(text.lstrip()), start + len(text.rstrip()))

    def is_row(self, index: int, fewest: int = 1) -> bool:
        """Tell whether a line that is no comment begins with real numbers, two if it has as many cells."""
        line = self.lines[index]
        cells = [] if line.strip().startswith(COMMENTS) else cut(line, self.delimiter)
        are_numbers = (isinstance(number(cell, self.decimal), float) for cell in cells[:2])
        return len(cells) >= fewest and all(are_numbers)

    def cell(self, index: int, cells: Sequence[str], which: int) -> Span:
        """Return where a cell of a line stands, the whole line when it is empty or not there."""
        text, end = self.lines[index], 0
        for i, cell in enumerate(cells[: which + 1]):
            at = text.find(cell, end)
            if i == which and cell and at >= 0:
                return Span(self.source, self.starts[index] + at, self.starts[index] + at + len(cell))
            end = max(at, end) + len(cell)
        return self.line(index)

    def cells(self, index: int) -> list[Span]:
        """Return where the cells of a line stand, empty ones with an empty range."""
        text, start, end, spans = self.lines[index], self.starts[index], 0, []
        for word in cut(text, self.delimiter, are_all_kept=True):
            at = text.find(word, end) if word else 0
            end = max(at, end) + len(word)
            location = Span(self.source, start + at, start + at + len(word))
            spans.append(location if at >= 0 else self.line(index))
        return spans

    def blocks(self) -> list[NumberBlock]:
        """Return the blocks of numbers; where no line begins with a number, of those with text in front."""
        return self._blocks(has_text_in_front=False) or self._blocks(has_text_in_front=True)

    def _blocks(self, *, has_text_in_front: bool) -> list[NumberBlock]:
        """Return the blocks of numbers, without those that are small beside the largest."""
        begun: list[tuple[list[int], list[int], list[tuple[str, ...]]]] = []
        gap: list[int] = []
        remaining = MAX_CELLS
        for i, line in enumerate(self.lines):
            cells = cut(line, self.delimiter) if line and not line.isspace() else []
            if not self._has_numbers(cells, len(begun[-1][2][-1]) if begun else 0, has_text_in_front):
                gap.append(i)
                continue
            remaining -= len(cells)
            if remaining < 0:
                message = f"'{self.source.name}' has more than {MAX_CELLS} numbers"
                raise DataError(Diagnostic("SF607", message, self.line(i)))
            rows = begun[-1][2] if begun else []
            is_stray = len(rows) == 1 and len(cells) > len(rows[0])
            # A blank line below the first row tells nothing: rows may stand two lines apart.
            is_apart = len(rows) != 1 or any(self.lines[i].strip() for i in gap)
            if not begun or is_stray or (gap and is_apart and self._begins(rows, cells)):
                begun.append((gap, [], []))
            gap = []
            begun[-1][1].append(i)
            begun[-1][2].append(tuple(cells))
        blocks = [NumberBlock(self, tuple(a), tuple(b), tuple(c)) for a, b, c in begun]
        most = max((len(block.rows) for block in blocks), default=0)
        fewest = min(most, max(FEWEST_ROWS, most // SMALL_SHARE))
        return [b for b in blocks if len(b.rows) >= (min(most, FEWEST_ROWS) if b.names_frequency else fewest)]

    def _has_numbers(self, cells: list[str], width: int, has_text_in_front: bool) -> bool:
        if len(cells) < 2 or (number(cells[0], self.decimal) is None and not has_text_in_front):  # noqa: PLR2004
            return False
        if len(cells) == width and not has_text_in_front:
            return True
        numbers = sum(number(cell, self.decimal) is not None for cell in cells)
        return numbers >= 2 and 2 * numbers > len(cells)  # noqa: PLR2004

    def _begins(self, rows: list[tuple[str, ...]], cells: list[str]) -> bool:
        """Tell whether a row after other text begins a table: it has another width, or goes back."""
        if len(cells) != len(rows[-1]):
            return True
        first, second, last, new = (
            np.real(number(row[0], self.decimal) or 0.0)
            for row in (rows[0], rows[min(1, len(rows) - 1)], rows[-1], cells)
        )
        return bool((new - last) * (second - first) <= 0)


def _format(lines: Sequence[str]) -> tuple[str, str]:
    written = [line for line in lines if line.strip()]
    size = min(SAMPLE, MOST_SAMPLED // max(map(len, written), default=1) + 1)
    begin = max((len(written) - size) // 2, 0)
    sample = written[begin : begin + size]

    def score(candidate: tuple[str, str]) -> float:
        share = 0.0
        delimiter, decimal = candidate
        for line in sample:
            cells = cut(line, delimiter)
            are_numbers = (number(c, decimal) is not None and not WHOLE[decimal].fullmatch(c) for c in cells)
            numbers = sum(are_numbers)
            if numbers >= 2 and 2 * numbers > len(cells):  # noqa: PLR2004
                share += numbers / len(cells)
        return round(share, 6)

    joined = "".join(sample)
    present = [c for c in _CANDIDATES if c[0] in joined and (c[1] == "." or "," in joined)]
    return max(present, key=score, default=(" ", "."))
