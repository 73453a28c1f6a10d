r"""A report as LaTeX, with its figures from files; it compiles with pdflatex and lualatex without warnings.

It needs, besides what every document of :mod:`symflex.print.latex` needs, graphicx and longtable, which come
with every distribution.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final, assert_never

from symflex.print.latex import TEXT_WIDTH_MM, escape_text
from symflex.print.latex.page import preamble
from symflex.print.latex.text import prose, text_width
from symflex.print.width import EM_MM
from symflex.report.document import (
    Aside,
    Badge,
    Block,
    Cell,
    Code,
    DisplayedFormula,
    Listing,
    Mathematics,
    Notice,
    PageFigure,
    PageLink,
    Paragraph,
    Run,
    Section,
    Table,
)
from symflex.report.report import Report

OVERVIEW: Final = "models"  # anchor of the section that follows the table of contents on its page
HEADINGS: Final = ("section", "subsection", "subsubsection", "paragraph")
CONTENTS_DEPTH: Final = 1
# Blanks of typewriter type do not stretch, so that lines with several of them would be loose elsewhere.
BLANKS: Final = r"\spaceskip=.5em plus .4em minus .1em\relax"

_PACKAGES: Final = r"""
\usepackage{graphicx}
\usepackage{longtable}
\setlength{\parindent}{0pt}
\setlength{\parskip}{4pt plus 2pt}
\setlength{\LTpre}{4pt}
\setlength{\LTpost}{6pt}
\setcounter{secnumdepth}{2}
\setcounter{tocdepth}{%d}
\emergencystretch=3em
\ifdefined\pdfinfoomitdate\pdfinfoomitdate=1\fi
\ifdefined\pdftrailerid\pdftrailerid{}\fi
\ifdefined\pdfsuppressptexinfo\pdfsuppressptexinfo=-1\fi
"""

_GAP_MM: Final = 4.3
_BOLD: Final = 1.15
_TYPEWRITER: Final = 0.55
_SLACK_MM: Final = 0.8
_DEEPEST_INDENT: Final = 24
_LONGEST_PIECE: Final = 16
_SMALL: Final = 0.86
_TALLEST_MM: Final = 190.0
_POINTS_PER_MM: Final = 72 / 25.4
# Mathematics is narrower than its source, which contains commands.
_EM_PER_CHARACTER: Final = 0.34


def report_article(report: Report) -> str:
    """Return a report as a LaTeX document, to be compiled three times, beside its folder ``figures``."""
    byline = r"\\[2pt]".join(escape_text(line) for line in (report.subtitle, report.date) if line)
    parts = [
        "% To be compiled three times, with pdflatex or lualatex.",
        preamble(TEXT_WIDTH_MM) + _PACKAGES % CONTENTS_DEPTH,
        r"\begin{document}",
        r"\begin{center}",
        rf"{{\LARGE\bfseries {escape_text(report.title)}\par}}",
        rf"\medskip {byline}" if byline else "",
        r"\end{center}",
        r"\tableofcontents",
        *(_section(section, 0) for section in report.sections),
        r"\end{document}",
    ]
    return "\n".join(filter(None, parts)) + "\n"


def _section(section: Section, level: int) -> str:
    if not section.title:
        return "\n\n".join(_block(block, level) for block in section.blocks)
    heading = HEADINGS[min(level, len(HEADINGS) - 1)]
    title = escape_text(section.title)
    shown = f"${section.mathematics.latex}$" if section.mathematics else title
    # A heading in mathematics has no counterpart in bookmarks, and none in the table of contents either.
    star = "*" if section.mathematics else ""
    break_ = "\\clearpage\n" if level == 0 and section.anchor != OVERVIEW else ""
    body = "\n\n".join(_block(block, level + 1) for block in section.blocks)
    return f"\n{break_}\\{heading}{star}{{{shown}}}\n\n{body}\n"


def _block(block: Block, level: int) -> str:
    match block:
        case Section():
            return _section(block, level)
        case Paragraph(runs=runs):
            return _runs(runs)
        case DisplayedFormula(latex=latex):
            return latex
        case Table():
            return _table(block)
        case PageFigure(stem=stem, caption=caption):
            drawing = rf"\includegraphics[width={_drawn_width(block):.1f}mm]{{figures/{stem}.pdf}}"
            below = rf"\par\nopagebreak\smallskip {{\small {escape_text(caption)}}}\par"
            return rf"{{\centering {drawing}{below}}}\medskip"
        case Listing(title=title, text=text):
            return f"{escape_text(title)}:\n\n{_verbatim(text)}"
        case Notice(text=text):
            return rf"\textit{{Note:}} {escape_text(text)}"
        case _:
            assert_never(block)


def _drawn_width(picture: PageFigure) -> float:
    """Return the width of a figure [mm]: its own, less where a page is smaller."""
    size = picture_size(picture.svg)
    if size is None:
        return TEXT_WIDTH_MM / 2
    width, height = (points / _POINTS_PER_MM for points in size)
    return width * min(1.0, TEXT_WIDTH_MM / width, _TALLEST_MM / height)


def picture_size(svg: str) -> tuple[float, float] | None:
    """Return width and height of a drawing [pt], None if it does not say."""
    head = svg[: svg.find(">", svg.find("<svg")) + 1]
    width, height = (re.search(rf'\s{side}="([0-9.]+)pt"', head) for side in ("width", "height"))
    return (float(width[1]), float(height[1])) if width and height else None


def _verbatim(text: str) -> str:
    lines = []
    for line in text.expandtabs(4).splitlines():
        bare = line.lstrip(" ")
        indent = "~" * min(len(line) - len(bare), _DEEPEST_INDENT)
        # Of spaces that align columns the last one may end a line.
        shown = "".join(
            "~" * (len(word) - 1) + " " if not word.strip() else _breakable(word)
            for word in re.split("( +)", bare)
            if word
        )
        lines.append(f"\\strut {indent}{shown}")
    body = "\\par\n".join(lines)
    return f"{{\\ttfamily\\scriptsize\\raggedright\\setlength{{\\parskip}}{{0pt}}\n{body}\\par}}"


def _table(table: Table) -> str:
    caption = rf"\textbf{{{escape_text(table.caption)}}}\par\nopagebreak" + "\n" if table.caption else ""
    if table.latex:
        return f"{caption}{table.latex}"
    if not table.rows:
        return caption
    room = TEXT_WIDTH_MM - _GAP_MM * (len(table.columns) - 1) - _SLACK_MM
    widths = _widths(table, room)
    formats = []
    for column, width in zip(table.columns, widths, strict=True):
        side = r"\raggedleft" if column.side == "number" else r"\raggedright"
        formats.append(rf">{{{side}\arraybackslash}}p{{{width:.1f}mm}}")
    head = " & ".join(rf"\textbf{{{_runs(c.head)}}}" for c in table.columns)
    separator = rf"\hspace{{{_GAP_MM}mm}}"
    layout = f"@{{}}{f'@{{{separator}}}'.join(formats)}@{{}}"
    # Space after a row of paragraphs is lost in their depth; a line of its own keeps it.
    rows = " \\\\\n\\addlinespace[2.5pt]\n".join(
        " & ".join(_runs(cell) or "~" for cell in row) for row in table.rows
    )
    return (
        f"{caption}{{\\footnotesize\n\\begin{{longtable}}{{{layout}}}\n\\toprule\n{head} \\\\\n\\midrule\n"
        f"\\endhead\n\\bottomrule\n\\endfoot\n{rows} \\\\\n\\end{{longtable}}}}"
    )


def _widths(table: Table, room: float) -> list[float]:
    """Return widths [mm]: at least that of the widest word each, and what is left where it is needed."""
    scale = _BOLD * _SMALL * EM_MM
    natural, least = [], []
    for i, column in enumerate(table.columns):
        lines = [line for cell in (column.head, *(row[i] for row in table.rows)) for line in _lines(cell)]
        natural.append(scale * max(sum(width for _, width in line) for line in lines) + _SLACK_MM)
        words = max((width for line in lines for _, width in line), default=0.0)
        # Longer words are broken; TeX has no widths of metres.
        least.append(min(natural[i], scale * words + _SLACK_MM, room / 2))
    if sum(natural) <= room:
        return natural
    kept = [n if c.side != "text" else m for c, n, m in zip(table.columns, natural, least, strict=True)]
    if sum(kept) > room:
        kept = least
    # A root keeps one long text from taking all the room.
    wants = [(n - k) ** 0.5 for n, k in zip(natural, kept, strict=True)]
    spare = max(room - sum(kept), 0.0) / (sum(wants) or 1.0)
    return [k + spare * w for k, w in zip(kept, wants, strict=True)]


def _lines(cell: Cell) -> list[list[tuple[str, float]]]:
    """Return the lines of a cell as what is not broken in them, with widths [em of the text]."""
    lines: list[list[tuple[str, float]]] = [[]]
    for run in cell:
        for i, piece in enumerate(run.split("\n") if isinstance(run, str) else (run,)):
            if i:
                lines.append([])
            match piece:
                case str():
                    lines[-1] += [(word, text_width(word)) for word in re.split("(?<= )", piece)]
                case Mathematics(latex=latex):
                    # Mathematics in a text may be broken at its signs.
                    lines[-1] += [(t, _EM_PER_CHARACTER * len(t)) for t in re.split("(?=[+=-])", latex)]
                case Code(text=text) | PageLink(text=text):
                    lines[-1] += [(part, _TYPEWRITER * len(part)) for part in re.split("(?<=[/_. ])", text)]
                case _:
                    lines[-1] += [(word, text_width(word)) for word in re.split("(?<= )", piece.text)]
    return [line or [("", 0.0)] for line in lines]


def _runs(runs: Sequence[Run] | Iterable[Run]) -> str:
    return "".join(map(_run, runs))


def _run(run: Run) -> str:
    match run:
        case str():
            return r"\newline ".join(prose(line) for line in run.split("\n"))
        case Mathematics(latex=latex):
            return f"${latex}$"
        case Code(text=text):
            return rf"{{\ttfamily{BLANKS} {_breakable(text)}}}"
        case Badge(text=text):
            return rf"\textbf{{{escape_text(text)}}}"
        case Aside(text=text):
            return rf"\textit{{{escape_text(text)}}}"
        case PageLink(text=text, target=target):
            shown = _breakable(text)
            return shown if target.startswith("#") else rf"\texttt{{{shown}}}"
        case _:
            assert_never(run)


def _breakable(text: str) -> str:
    """Return code that may be broken at blanks, after what joins names, and anywhere in what is long."""
    return " ".join(map(_breakable_word, text.split(" ")))


def _breakable_word(word: str) -> str:
    pieces = [""]
    for c in word:
        pieces[-1] += c
        if c in "/_.,=(" or len(pieces[-1]) >= _LONGEST_PIECE:
            pieces.append("")
    return r"\allowbreak{}".join(escape_text(piece) for piece in pieces if piece)
