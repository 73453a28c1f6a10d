r"""Frequency responses as text in columns.

What stands above the numbers names the columns, and comment lines may contain what the columns cannot:
``# tf: A_tip/V_cmd``, ``# averages: 40``, ``# window: hann``, ``# unit: m/(V*s^2)``, ``# synthetic: yes``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import Final

import numpy as np

from symflex.data.measurement.column_meaning import (
    ColumnMeaning,
    DataColumn,
    columns_asked,
    counts,
    in_unit_of,
    meaning_of,
    meanings_of,
)
from symflex.data.measurement.column_names import UNITS
from symflex.data.measurement.columns import Assembled, assembled, names_of, ratio_unit
from symflex.data.measurement.likely_readings import HINT, WITHOUT_AXIS, WITHOUT_TIME, ask
from symflex.data.measurement.measured_response import (
    MAX_LINES,
    MeasuredResponse,
    averages_of,
    checked_response,
    unit_of,
    window_of,
)
from symflex.data.measurement.text_table import (
    COMMENTS,
    FEWEST_ROWS,
    SIGNS,
    WHOLE,
    NumberBlock,
    TextTable,
    bare,
    cut,
    number,
)
from symflex.errors import DataError, Diagnostic, Span

_COMMENT_FIELD = re.compile(r"\W*(?P<key>tf|averages|window|unit|synthetic)\s*[:=]\s*(?P<value>.*)", re.I)
_AXIS_UNIT = re.compile(r"(?:axis|freq|x)[\w .]*unit\w*\W+(hz|khz|mhz|rad/s)\b", re.I)
_LISTED = re.compile(r"[#%!*;][\s#%!*;]*(?:REM\s+)?(?:name|col(?:umn)?)?[ _]?\d+\s*[:=]\s*(.+)", re.I)
"""A name of a column in a line of its own: ``# NAME0 = Frequency [Hz]``, ``# column 2: phase (deg)``."""
_IMPLIED: Final = {
    ".frd": ("f,mag_db,phase_deg", "Hz, dB, degrees"),
    ".zma": ("f,mag,phase_deg", "Hz, Ohm, degrees"),
}
"""Columns of files without a header, by the end of their names (loudspeaker programs)."""
_Rewritten = tuple[bytes, Callable[[Span | None], Span | None], tuple[str, ...]]
"""A text of columns, the function that says where what stands in it comes from, and what was guessed."""
MOST_TURNED: Final = 12  # lines of a table that are columns
MOST_UNNAMED: Final = 4  # such lines may lack names: frequency, two parts of values, coherence
NEAR: Final = 60  # lines above the numbers among which the names of columns are looked for


def read_columns(name: str, data: bytes, stem: str, asked: str = "") -> tuple[MeasuredResponse, ...]:
    """Read responses from text in columns; a single one is called ``stem`` when the file gives no name."""
    table = TextTable.of(name, data)
    turned = _turned(table) or _qucs(table) or lines_with_axis(table) or _citi(table)
    if turned is not None:
        text, origin, said = turned
        try:
            made_of_lines = read_columns(name, text, stem, asked)
        except DataError as error:
            raise DataError(*(replace(d, span=origin(d.span)) for d in error.diagnostics)) from None
        return tuple(replace(one, guesses=said + one.guesses) for one in made_of_lines)
    fields = _comment_fields(table)
    blocks = table.blocks()
    if not blocks:
        are_alone = sum(number(line, table.decimal) is not None for line in table.lines) >= FEWEST_ROWS
        hint = f"{WITHOUT_AXIS}; {WITHOUT_TIME.format('y,dt=SECONDS')}" if are_alone else HINT
        raise DataError(Diagnostic("SF605", f"'{name}' contains no rows of numbers", None, hint))
    if sum(len(block.rows) for block in blocks) > MAX_LINES:
        raise DataError(Diagnostic("SF607", f"'{name}' has more than {MAX_LINES} lines"))
    guesses = list(table.guesses)
    made, guessed = _responses(name, table, blocks, asked, guesses)
    guesses += guessed + _skipped(table, blocks)
    words = {key: span.text.strip() for key, span in fields.items()}
    averages = averages_of(words["averages"], name, fields["averages"]) if "averages" in words else None
    signs = (line.strip() for line in table.lines)
    comments = tuple(line.lstrip("#%!/*; ") for line in signs if line.startswith(COMMENTS))
    unit = unit_of(words.get("unit", ""), name, fields.get("unit"))
    is_said = words.get("synthetic", "").lower() in ("yes", "true", "1")
    is_synthetic = is_said or "synthetic" in " ".join(comments).lower()
    responses = []
    for one, called in zip(made, names_of(made, (len(made) == 1 and words.get("tf")) or stem), strict=True):
        response = MeasuredResponse(
            called, one.frequency_hz, one.values, one.coherence, averages, window_of(words.get("window", "")),
            unit or one.unit, is_synthetic, comments, tuple(dict.fromkeys(guesses)),
            is_magnitude=one.is_magnitude,
        )  # fmt: skip
        frequency, value, *_ = one.columns
        places = {"frequency": frequency.place, "value": value.place, "coherence": one.columns[-1].place}
        responses.append(checked_response(response, name, partial(_place, places)))
    return tuple(responses)


def _place(places: Mapping[str, Callable[[int], Span | None]], index: int, kind: str) -> Span | None:
    return places[kind](index)


def _qucs(table: TextTable) -> _Rewritten | None:
    """Return a dataset of Qucs with its variables side by side, those of as many values as the first one."""
    if not table.source.text.startswith("<Qucs Dataset"):
        return None
    lists = re.findall(r"^<(?:in)?dep (\S+)[^>\n]*>\n([^<]+)<", table.source.text, re.M)
    columns = [[name, *body.split()] for name, body in lists]
    columns = [column for column in columns if len(column) == len(columns[0])]
    if not columns[1:]:
        return None
    return "".join("\t".join(row) + "\n" for row in zip(*columns, strict=True)).encode(), lambda _: None, ()


def lines_with_axis(table: TextTable) -> _Rewritten | None:
    """Return a LabVIEW file with a column of its times or frequencies, if its header gives their step."""
    head, names, rows = table.source.text.partition("\nX_Value\t")
    fields = {key: more.partition("\t")[0] for key, _, more in (x.partition("\t") for x in head.split("\n"))}
    start, step = (number(fields.get(key, ""), table.decimal) for key in ("X0", "Delta_X"))
    if fields.get("X_Columns") != "No" or not (isinstance(start, float) and isinstance(step, float)):
        return None
    first, _, rows = rows.partition("\n")
    head = head.replace("\nX_Columns\tNo", "") + f"{names}{first}\n"
    return _with_axis(head, (f"{start + i * step!r}".replace(".", table.decimal) for i in count()), rows)


def _citi(table: TextTable) -> _Rewritten | None:
    """Return a CITIFILE as a table; its header lists the frequencies, or gives both ends and their number."""
    head, _, rows = table.source.text.partition("\nBEGIN\n")
    if not head.startswith("CITIFILE") or not re.search(r"^DATA \S+ RI$", head, re.M):
        return None
    axis = head.partition("VAR_LIST_BEGIN\n")[2].partition("VAR_LIST_END")[0].split()
    if ends := re.search(r"^SEG (\S{1,30}) (\S{1,30}) (\d{1,7})$", head, re.M):
        start, stop = number(ends[1]), number(ends[2])
        if isinstance(start, float) and isinstance(stop, float):
            axis = [repr(x) for x in np.linspace(start, stop, min(int(ends[3]), MAX_LINES)).tolist()]
    return _with_axis("frequency_hz\tre\tim\n", axis, rows.partition("\nEND")[0].replace(",", "\t"))


def _with_axis(head: str, axis: Iterable[str], rows: str) -> _Rewritten | None:
    """Return rows with a frequency in front of each; ``None`` if there are no rows."""
    written = [row.strip() for row in rows.split("\n") if row.strip()]
    lines = "".join(f"{x}\t{row}\n" for x, row in zip(axis, written, strict=False))
    said = ("the frequencies are those that the header gives",)
    return ((head + lines).encode(), lambda _: None, said) if lines else None


def with_axis(name: str, data: bytes, first: float, step: float) -> bytes:
    """Return a text with a frequency in front of each row of numbers, tabs between cells."""
    table = TextTable.of(name, data)
    axis, lines = count(), []
    for line in table.lines:
        words = cut(line, table.delimiter)
        readings = (
            cells
            for cells in (words, [line.strip()])
            if None not in (number(c, table.decimal) for c in cells)
        )
        if words and (cells := next(readings, None)):
            words = [repr(first + next(axis) * step).replace(".", table.decimal), *cells]
        lines.append("\t".join(words))
    return "\n".join(lines).encode()


def _turned(table: TextTable) -> _Rewritten | None:
    """Return the text with columns where a table has few lines of many numbers; None if it has not."""
    places = [i for i, line in enumerate(table.lines) if line.strip()][: MOST_TURNED + 1]
    rows = [cut(table.lines[i], table.delimiter) for i in places]
    if not 1 < len(rows) <= MOST_TURNED or len({*map(len, rows)}) > 1 or len(rows[0]) < 2 * len(rows):
        return None
    are_texts = [[number(c, table.decimal) is None for c in row] for row in rows]
    are_named = all(row[0] for row in are_texts)
    if any(any(row[are_named:]) for row in are_texts) or (not are_named and len(rows) > MOST_UNNAMED):
        return None
    delimiter = "\t" if table.delimiter == " " else table.delimiter

    def origin(span: Span | None) -> Span | None:
        if span is None:
            return None
        above, _, before = ("\n" + span.source.text[: span.start]).rpartition("\n")
        row = before.count(delimiter)
        return table.cell(places[row], rows[row], above.count("\n"))

    text = "".join(delimiter.join(column) + "\n" for column in zip(*rows, strict=True))
    return text.encode(), origin, ("each line is taken as a column",)


def _responses(
    name: str, table: TextTable, blocks: Sequence[NumberBlock], asked: str, guesses: list[str]
) -> tuple[list[Assembled], list[str]]:
    """Return the responses of blocks: each alone, or side by side where each holds a part of the values."""
    parts = [_columns(table, block, guesses) for block in blocks]
    named = next((i for i, part in enumerate(parts) if part[1] is not None), 0)
    if named and not asked:
        lines = f"{blocks[0].lines[0] + 1} to {blocks[named - 1].lines[-1] + 1}"
        guesses.append(f"lines {lines} contain a table without a frequency and are skipped")
        blocks, parts = blocks[named:], parts[named:]
    for i in range(1, len(parts)):  # a table below another one of the same shape has its names
        (above, line), (heading, own_line) = parts[0], parts[i]
        if own_line is None and len(heading) == len(above) and line is not None:
            pairs = zip(heading, above, strict=True)
            heading = [
                replace(c, meaning=c.meaning if c.meaning.kind else a.meaning, name=a.name) for c, a in pairs
            ]
            parts[i] = heading, line
    columns, header = parts[0]
    for others, _ in parts[1:]:
        first, other = columns[0].numbers.real, others[0].numbers.real
        if first.shape == other.shape and np.allclose(first, other, rtol=1e-6, equal_nan=True):
            columns = columns + others[1:]
    if asked:
        meanings = columns_asked(asked, len(columns), [c.name for c in columns])
        better = re.search(r"--columns (?![-,]*t,)([^\s,]+(?:,[^\s,]+)*)", ask(columns))
        if better and better[1] != asked and {"real", "phase"} & {m.kind for m in meanings}:
            places = {tuple(bool(w.strip("- ")) for w in words.split(",")) for words in (asked, better[1])}
            if len(places) == 1 or not header:
                guesses.append(f"names and numbers look more like --columns {better[1]}")
        columns = [
            replace(c, meaning=in_unit_of(m, c.meaning)) for c, m in zip(columns, meanings, strict=True)
        ]
        return assembled(columns, name, header, is_asked=True)
    implied = _IMPLIED.get(Path(name).suffix.lower())
    if implied and header is None and len(columns) == 3:  # noqa: PLR2004
        said = f"no line names the columns: {implied[1]}, as in {Path(name).suffix} files"
        meanings = columns_asked(implied[0], len(columns))
        columns = [replace(c, meaning=m) for c, m in zip(columns, meanings, strict=True)]
        made, more = assembled(columns, name, header)
        return made, [said, *more]
    if not any(c.meaning.kind for c in columns):
        span, message = table.line(blocks[0].lines[0]), "no line above the numbers names the columns"
        for i in reversed(blocks[0].above[-NEAR:]):
            words = cut(table.lines[i].strip().lstrip(SIGNS), table.delimiter)
            spare = len(words) - len(columns)  # a comment has no column
            are_names = all(number(w, table.decimal) is None for w in words)
            if are_names and (not spare or (spare > 0 and table.delimiter != " ")):
                columns = [replace(c, name=w) for c, w in zip(columns, words, strict=False)]
                span, message = table.line(i), "none of these names is one that symflex knows"
                break
        raise DataError(Diagnostic("SF602", message, span, ask(columns)))
    if len(parts) > 1 and len(columns) == len(parts[0][0]):
        each = [assembled(one, name, line) for one, line in parts]
        return [m for made, _ in each for m in made], [s for _, said in each for s in said]
    return assembled(columns, name, header)


def _skipped(table: TextTable, blocks: Sequence[NumberBlock]) -> list[str]:
    """Return what is to be said of lines among the numbers and below them that are no rows."""
    used = {i for block in blocks for i in (*block.lines, *block.above)}
    within = [
        i for i in range(blocks[0].lines[0], len(table.lines))
        if i not in used and table.lines[i].strip() and not table.lines[i].strip().startswith(COMMENTS)
    ]  # fmt: skip
    if not within:
        return []
    first = f"line {within[0] + 1} ('{' '.join(table.lines[within[0]].split())[:30]}')"
    many = f"{len(within)} lines among the numbers or below them are not rows and are skipped: {first}, ..."
    return [many if len(within) > 1 else f"{first} is not a row of numbers and is skipped"]


def _columns(
    table: TextTable, block: NumberBlock, guesses: list[str]
) -> tuple[list[DataColumn], Span | None]:
    """Return the columns of a block, and the line that names them; ``None`` if no line does."""
    width = block.width
    numbers = [block.numbers(i) for i in range(width)]
    if numbers[0][0].dtype.kind == "c" and not np.any(numbers[0][0].imag):  # numpy writes all as complex
        numbers[0] = numbers[0][0].real, numbers[0][1]
    integer = next((c for row in block.rows for c in row if WHOLE[table.decimal].fullmatch(c)), None)
    if integer:
        guesses.append(f"numbers such as {integer} are read in thousands")
    line, cells, under, below = _header(table, block, [n.dtype.kind == "c" for n, _ in numbers])
    if table.delimiter == "," and 0 < 2 * sum(map(bool, cells)) == width:
        message = f"{width} cells where the header has {width // 2} names: decimal commas between commas?"
        hint = "save the file with semicolons or tabs between the columns"
        raise DataError(Diagnostic("SF602", message, table.line(block.lines[0]), hint))
    meanings = meanings_of(cells, below)
    if {m.word for m in meanings} >= {"x", "y"} and not any(
        np.any(n.real < 0) for (n, _), m in zip(numbers, meanings, strict=True) if m.word in ("x", "y")
    ):  # two amplitudes rather than the parts of one number
        meanings = [meaning_of(c, u) for c, u in zip(cells, below, strict=True)]
    ends = {"Channel 1": "in", "Channel 2": "out"}
    is_size = [m.kind == "magnitude" for m in meanings]
    if {*re.findall(r"^#Relative: (\w+)", table.source.text, re.M)} == {"no"} and sum(is_size) == len(ends):
        # WaveForms: both channels as they are, and the phase between them
        pairs = zip(meanings, is_size, strict=True)
        meanings = [replace(m, label=ends.get(m.label, "") if is_one else "") for m, is_one in pairs]
    for i, (values, _) in enumerate(numbers):
        if values.dtype.kind == "c":
            meanings[i] = ColumnMeaning("complex", label=cells[i])
        elif [*cells, ""][i + 1] == cells[i] and re.fullmatch(r"[vi]\(.+\)", cells[i], re.I):  # ngspice
            meanings[i : i + 2] = [ColumnMeaning(part, label=cells[i]) for part in ("real", "imaginary")]
            guesses.append(f"'{cells[i][:30]}' twice is read as real and imaginary part")
    longer = next((i for i, row in enumerate(block.rows) if len(row) > width), None)
    if longer is not None:
        many = len(block.rows[longer])
        guesses.append(f"line {block.lines[longer] + 1} has {many} cells: the first {width} are read")
    header = None if line is None else table.line(line)
    above = [i for i in block.above if table.lines[i].strip()]
    is_comment = all(table.lines[i].strip().startswith(COMMENTS) for i in above if i not in (line, under))
    if not is_comment:
        begin = f"the numbers begin in line {block.lines[0] + 1}"
        named = f"line {(line or 0) + 1} names the columns, and {begin}: the other lines above are skipped"
        guesses.append(begin if line is None else named)
    title = _title(table, [i for i in above if i != line])
    # Analysers write two parts of all that they trace, the second one empty where there is only one.
    beside = numbers[2:]
    is_single = not any(n.any() for n, _ in beside) if beside else not meanings[1].kind
    if title and is_single:
        meanings[1:] = [title, *(ColumnMeaning() for _ in beside)]
    unit = next((m[1] for i in above if (m := _AXIS_UNIT.search(table.lines[i][:200]))), "")
    if unit and not meanings[0].kind:
        meanings[0] = replace(meanings[0], unit=unit)
    columns = []
    for i, (cell, meaning) in enumerate(zip(cells, meanings, strict=True)):
        span = None if line is None else table.cell(line, cells, i) if cell else header
        columns.append(DataColumn(cell, meaning, *numbers[i], span, block.place(i)))
    return columns, header


def _title(table: TextTable, above: Sequence[int]) -> ColumnMeaning | None:
    """Return what a line above a table announces: ``Phase (deg)``, ``TRACE B: Magnitude [dB]``."""
    for i in reversed(above[-NEAR:]):
        meaning = meaning_of(table.lines[i].strip(SIGNS + '"'))
        if meaning.kind not in ("", "frequency") and len(meaning.label) < 30:  # noqa: PLR2004
            return replace(meaning, label="")
    return None


def _header(
    table: TextTable, block: NumberBlock, is_complex: Sequence[bool]
) -> tuple[int | None, list[str], int | None, list[str]]:
    """Return the line that names most columns, its cells, and the line of units below with its cells."""
    width = block.width
    are_counted = width > 2 and counts(block.numbers(0)[0])  # noqa: PLR2004
    best: tuple[float, int, list[str]] | None = None
    for line in block.above[-NEAR:]:
        for cells in _ways_to_cut(table, line, width, are_counted=are_counted):
            named = meanings_of(cells[:width])
            kinds = ["complex" if is_complex[i] else m.kind for i, m in enumerate(named)]
            values = sum(kind not in ("", "frequency") for kind in kinds)
            recognised = values + ("frequency" in kinds) if values else 0
            # A row of units, Hz and deg, names columns where nothing else does.
            is_units = sum(c.strip("[]() ").lower() in UNITS for c in cells) >= 2  # noqa: PLR2004
            score = recognised + (len(cells) == width) / 2 - is_units
            is_better = best is None or score > best[0] or (score == best[0] and line > best[1])
            if recognised >= 2 and is_better:  # noqa: PLR2004 (two columns are known)
                best = score, line, cells[:width]
    if best is None:
        listed = [(i, m[1]) for i in block.above if (m := _LISTED.fullmatch(table.lines[i].strip()))]
        if len(listed) != width:
            return None, [""] * width, None, [""] * width
        best = 0, listed[0][0], [bare(name) for _, name in listed]
    _, line, cells = best
    following = next((i for i in block.above if i > line and table.lines[i].strip()), None)
    units = [] if following is None else _units(table, following, width)
    return line, cells, following if units else None, units + [""] * (width - len(units))


def _units(table: TextTable, line: int, width: int) -> list[str]:
    """Return the units in the row below the names; none where it is no such row."""
    text = table.lines[line].strip()
    units = cut(text, table.delimiter)
    units = units if len(units) == width else cut(text.lstrip("#%!/*"), table.delimiter)
    if len(units) == width - 1 and table.lines[line].startswith("\t") and table.delimiter == "\t":
        units = ["", *units]
    is_apart = table.delimiter != " " and table.delimiter in text  # a unit of the frequency alone: MHz,,
    is_row = 2 - is_apart <= len(units) <= width and any(
        u.strip("[]()").lower() in UNITS or ratio_unit(u.strip("[]"), "") for u in units
    )
    return units if is_row else []


def _ways_to_cut(table: TextTable, line: int, width: int, *, are_counted: bool = False) -> list[list[str]]:
    """Return the ways to cut a line into as many names as there are columns, or one less: the frequency's."""
    text = table.lines[line].strip()
    if text.startswith(COMMENTS) or (text.count('"') == 2 and text[0] == text[-1] == '"'):  # noqa: PLR2004
        text = text.strip('"').lstrip(SIGNS)
    text = re.sub(r"^C\s\s+", "", text)  # a comment of Fortran
    ways = [cut(text, table.delimiter)]
    if table.delimiter in " " or table.delimiter not in text:
        joined = re.sub(r"(?<!\s)\s+(?=[\[(])", "\0", text)
        ways += [cut(text, d) for d in "\t;,"] + [re.split(r"\s{2,}", text)]
        ways.append([c.replace("\0", " ") for c in joined.split()])
    cuts = []
    for cells in ways:
        names = [bare(c) for c in cells]
        has_frequency = any(meaning_of(n).kind == "frequency" for n in names)
        # The names of R's write.table are one less than the columns, of which the first counts the rows.
        is_short = are_counted or table.lines[line].startswith(table.delimiter)
        if len(names) == width - 1 and has_frequency and is_short:
            names = ["", *names]
        if len(names) == width - 1 and not has_frequency:
            names = ["", *names] if all(meaning_of(n).kind for n in names) else []
        if 1 < len(names) < width and has_frequency:
            names += [""] * (width - len(names))
        if len(names) >= width:
            cuts.append(names)
    return cuts


def _comment_fields(table: TextTable) -> dict[str, Span]:
    spans: dict[str, Span] = {}
    for start, line in zip(table.starts, table.lines, strict=False):
        if line.strip().startswith(COMMENTS) and (match := _COMMENT_FIELD.fullmatch(line)):
            begin = start + match.start("value")
            location = Span(table.source, begin, begin + len(match["value"].rstrip()))
            spans.setdefault(match["key"].lower(), location)
    return spans
