r"""Numbers of a printed table, as LaTeX types them in a tabular.

Input: what stands between ``\begin{tabular}{...}`` and ``\end{tabular}``. Output: its cells, and the columns
or rows that hold numbers, each with its heading.

    Mode & Present & FEM \\ \hline            Present    3.516   22.034   61.697
    1    & 3.516   & 3.52 \\           -->    FEM        3.52    22.1     61.9
    2    & 22.034  & 22.1 \\
    3    & 61.697  & 61.9

A column that counts 1, 2, 3 ... says that each other column is a list of roots. Without one, each row is.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from symflex.errors import Diagnostic, SpecError, Text

GAP: Final = "-"
PRINTED: Final = re.compile(r"[-+]?(\d{1,30}(\.\d{0,30})?|\.\d{1,30})([eE][-+]?\d{1,2})?\Z")
"""Digits of a number as they are printed."""
LONGEST_TABLE: Final = 100_000  # characters: a page has fewer
MOST_CELLS: Final = 5000
FEWEST: Final = 2  # numbers of a list
ARRAYS: Final = frozenset("tabular tabularx longtable supertabular tblr NiceTabular".split())
_RULES: Final = re.compile(
    r"\\(hline|toprule|midrule|bottomrule|endhead|endfirsthead|endfoot|endlastfoot|centering|small|scriptsize)\b"
    r"|\\(cline|cmidrule|addlinespace|noalign|vspace|caption|label)\s*(\([^)]*\))?\s*(\[[^\]]*\])?\s*(\{[^{}]*\})?"
)
_BEGIN: Final = re.compile(
    r"\A\s*(\\begin\s*\{[A-Za-z]+\*?\}\s*)?(\[[^\]]{0,9}\])?\s*(\{[^{}]*\}\s*)?(\{[lcrpmbSX|@!<>*{}\d.\s\\a-z=]*\})?"
)
"""What begins a tabular: its name, where it stands, its width, and its columns."""
_COMMENT: Final = re.compile(r"(?<!\\)%[^\n]*")
_MULTIPLE: Final = re.compile(r"\\multi(?:column|row)\s*\{(\d{1,2})\}\s*\{[^{}]*\}\s*\{")
_TEN: Final = re.compile(r"(?:\\times|\\cdot)\s*10\s*\^\s*\{?\s*(-?\d{1,2})\s*\}?")
_WRAPPED: Final = re.compile(
    r"\\(?:text|textbf|textit|mathbf|mathrm|num|bm|underline|emph|phantom)\s*\{([^{}]*)\}"
)
_COMMA: Final = re.compile(r"[-+]?\d+(,\d+)+(\.\d*)?([eE][-+]?\d{1,2})?\Z")
_GROUPED: Final = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?([eE][-+]?\d{1,2})?\Z")
_ORDINAL: Final = re.compile(
    r"(?:[nijr] ?= ?|[a-z]{0,12}\.?[ _]*)?\(?(\d{1,2})(?:\)?\.?|\^?(?:st|nd|rd|th)(?: [a-z ]{0,30})?)\Z"
)
"""What numbers a mode: ``1``, ``2nd``, ``(3)``, ``Mode 4``, ``f_5``."""
_WORDS: Final = "first second third fourth fifth sixth seventh eighth ninth tenth".split()
_EMPTY: Final = frozenset(("", "-", "--", "---", "\u2013", "\u2014", r"\ldots", r"\dots", "n/a", "N/A"))


class PrintedList(NamedTuple):
    """A column or a row of numbers."""

    heading: str
    entries: tuple[str, ...]  # digits as printed, ``-`` for a gap


def cells_of(text: Text) -> tuple[tuple[str, ...], ...]:
    r"""Return the cells of a tabular, row by row, as they are typed; SF103 for what no page has.

    >>> cells_of(Text.alone("t", r"Mode & $\omega$ \\ \hline 1 & 3{,}52 \\"))
    (('Mode', '$\\omega$'), ('1', '3{,}52'))
    """
    value = text.value
    if len(value) > LONGEST_TABLE:
        raise _too_large(text)
    value = _BEGIN.sub("", _COMMENT.sub("", value)).rstrip()
    value = re.sub(r"\\end\s*\{[A-Za-z]+\*?\}\s*\Z", "", value)
    rows: list[tuple[str, ...]] = []
    count = 0
    for typed in _parted(value, r"\\"):
        line = _RULES.sub("", re.sub(r"\A\s*(\*|\[[^\]]{0,20}\])", "", typed))
        cells = [cell for each in _parted(line, "&") for cell in _spanned(each.strip())]
        count += len(cells)
        if count > MOST_CELLS:
            raise _too_large(text)
        if any(cells):
            rows.append(tuple(cells))
    return tuple(rows)


def _too_large(text: Text) -> SpecError:
    message = f"a table has at most {LONGEST_TABLE} characters and {MOST_CELLS} cells"
    return SpecError(Diagnostic("SF103", message, text.span, "split it"))


def _parted(value: str, mark: str) -> Iterator[str]:
    """Yield what stands between marks outside of braces."""
    depth, begin, at = 0, 0, 0
    while at < len(value):
        if depth <= 0 and value.startswith(mark, at):
            yield value[begin:at]
            at = begin = at + len(mark)
            continue
        if value[at] == "\\":
            at += 2
            continue
        depth += {"{": 1, "}": -1}.get(value[at], 0)
        at += 1
    yield value[begin:]


def _spanned(cell: str) -> Iterator[str]:
    """Yield the cells that one cell stands for: over several columns its text, and then nothing."""
    match = _MULTIPLE.match(cell)
    if match is None:
        yield cell
        return
    inside = cell[match.end() :].rstrip()
    yield inside.removesuffix("}").strip()
    if cell.startswith(r"\multicolumn"):
        yield from [""] * (int(match[1]) - 1)


def printed_number(cell: str) -> str | None:
    r"""Return the digits of a cell, ``-`` for a gap, None for words.

    >>> [printed_number(c) for c in ("$3{,}516$", r"1.2 \times 10^{3}", "--", "Mode", r"\textbf{61.7}$^a$")]
    ['3.516', '1.2e3', '-', None, '61.7']
    """
    value = cell.strip()
    while (plain := _WRAPPED.sub(r"\1", value)) != value:
        value = plain
    value = re.sub(r"\^\s*(\{\s*[a-z*\\dagr]{1,8}\s*\}|[a-z*])", "", value.replace("$", ""))  # marks of notes
    value = value.replace("{,}", ".").replace("{.}", ".").replace("\u2212", "-")
    value = re.sub(r"\\[,;:! ]|~|[{}]|\s+", "", _TEN.sub(r"e\1", value))
    if value in _EMPTY:
        return GAP
    return value if PRINTED.match(value) else None


def comma_of(shown: Iterable[str]) -> str | None:
    """Return what commas in the numbers of a table stand for: a point, or nothing; None if both may be.

    >>> comma_of(["1,8751", "4,694"]), comma_of(["1,011.2", "986"]), comma_of(["1,875"])
    ('.', '', None)
    """
    every = list(shown)
    numbers = [each for each in every if _COMMA.match(each)]
    has_point = any("." in each and PRINTED.match(each.replace(",", "")) for each in every)
    are_grouped = all(map(_GROUPED.match, numbers))
    has_two = any(each.count(",") > 1 for each in numbers)
    if are_grouped and (has_point or has_two):
        return ""
    return None if are_grouped or has_point or has_two else "."


def lists_of(cells: Sequence[Sequence[str]]) -> tuple[PrintedList, ...]:
    """Return the lists of numbers of a table: its columns where one counts the modes, else its rows.

    >>> lists_of([("Mode", "here"), ("1", "3.516"), ("2", "22.03"), ("3", "61.70")])
    (PrintedList(heading='here', entries=('3.516', '22.03', '61.70')),)
    >>> lists_of([("m", "first", "second"), ("A", "3.516", "22.03")])
    (PrintedList(heading='A', entries=('3.516', '22.03')),)
    """
    width = max(map(len, cells), default=0)
    grid = [[*row, *[""] * (width - len(row))] for row in cells]
    if (comma := comma_of(_bare(cell) for row in grid for cell in row)) is not None:
        grid = [
            [cell.replace(",", comma) if _COMMA.match(_bare(cell)) else cell for cell in row] for row in grid
        ]
    numbers = [[printed_number(cell) for cell in row] for row in grid]
    columns = [[row[j] for row in numbers] for j in range(width)]
    counting = next((j for j in range(min(width, 2)) if _counted([row[j] for row in grid])), None)
    if counting is not None:
        rows = _counted([row[counting] for row in grid])
        first = rows[0]
        heads = {j: _heading(grid[:first], j) for j in range(width)}
        lists = [
            PrintedList(heads[j], tuple(columns[j][i] or GAP for i in rows))
            for j in range(width)
            if j != counting and all(columns[j][i] is not None for i in rows)
        ]
    else:
        lists = []
        for row, words in zip(numbers, grid, strict=True):
            begin = next((j for j, n in enumerate(row) if n not in (None, GAP)), width)
            is_named = begin == 0 and len(row) > FEWEST and _is_label(columns[0])
            begin += is_named
            entries = row[begin:]
            if entries and None not in entries:
                heading = " ".join(filter(None, words[:begin]))
                lists.append(PrintedList(heading, tuple(e or GAP for e in entries)))
    return tuple(each for each in lists if sum(e != GAP for e in each.entries) >= FEWEST)


def _bare(cell: str) -> str:
    """Return a cell without the dollars and the spaces that do not show in a number."""
    return re.sub(r"[$\s]|\\[,;:! ]", "", cell)


def _counted(column: Sequence[str]) -> list[int]:
    """Return the rows that a column counts 1, 2, 3 ... below its heading; none if it does not."""
    found = [(i, n) for i, n in enumerate(map(_ordinal, column)) if n]
    is_counting = [n for _, n in found] == list(range(1, len(found) + 1))
    return [i for i, _ in found] if is_counting and len(found) >= FEWEST else []


def _ordinal(cell: str) -> int:
    """Return the number of a mode, 0 for what is none."""
    value = cell.strip()
    while (plain := _WRAPPED.sub(r"\1", value)) != value:
        value = plain
    value = re.sub(r"\\[a-zA-Z]+\s*", "x", re.sub(r"[${}]|\\[,;:! ]|~", "", value)).lower().strip()
    words = value.split()
    if words and words[0] in _WORDS:
        return _WORDS.index(words[0]) + 1
    match = _ORDINAL.match(value)
    return int(match[1]) if match else 0


def _is_label(column: Sequence[str | None]) -> bool:
    """Tell whether a first column of numbers names the rows, as its heading is no number."""
    return column[0] is None and sum(n is not None for n in column[1:]) >= FEWEST


def _heading(rows: Sequence[Sequence[str]], j: int) -> str:
    """Return the words above a column."""
    return " ".join(filter(None, (row[j] for row in rows)))
