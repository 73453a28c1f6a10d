"""What a report is made of: blocks that say nothing of the page or paper they end up on.

Text in blocks is plain: the printers (:mod:`symflex.report.page`, :mod:`symflex.report.article`) escape all
of it. Mathematics comes from the printers of :mod:`symflex.print`, in both languages, and is sound in them.
Numbers and units are for people: real minus signs, powers of ten, dots between units.

What a section of a report hands over: its blocks, and the files that belong to it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, TypeAlias

from matplotlib.figure import Figure

from symflex.errors import SymflexError, UncertifiedError
from symflex.expressions import Expression
from symflex.figures import render
from symflex.model import Model
from symflex.print.latex import latex_expression, model_labels
from symflex.print.mathml import MathRow, mathml_expression
from symflex.print.text import Passage

Verdict: TypeAlias = Literal["holds", "holds with a condition", "does not hold", "not examined"]
Tone: TypeAlias = Literal["good", "fair", "bad", "quiet"]
Side: TypeAlias = Literal["text", "plain", "number"]


@dataclass(frozen=True, slots=True)
class Mathematics:
    """Mathematics in a line of text."""

    mathml: str  # content of a ``math`` element
    latex: str  # for math mode


@dataclass(frozen=True, slots=True)
class Code:
    """A name of a file, key or command."""

    text: str


@dataclass(frozen=True, slots=True)
class Badge:
    """A verdict, or another word that a reader looks for."""

    text: str
    tone: Tone = "quiet"


@dataclass(frozen=True, slots=True)
class PageLink:
    """A word that leads to a file of the report's folder, or to a heading (``#...``)."""

    text: str
    target: str


@dataclass(frozen=True, slots=True)
class Aside:
    """Words of less weight than those beside them."""

    text: str


Run: TypeAlias = "str | Mathematics | Code | Badge | PageLink | Aside"  # a line break is ``"\n"``
Cell: TypeAlias = "tuple[Run, ...]"


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    runs: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class DisplayedFormula:
    """A displayed equation."""

    rows: tuple[MathRow, ...]  # for pages
    latex: str  # a display for paper, such as an ``equation`` environment
    name: str  # what it is an equation of, for those who do not see it


@dataclass(frozen=True, slots=True)
class PageColumn:
    """A column of a table."""

    head: Cell  # its head
    side: Side = "text"  # ``text`` is broken into lines, ``plain`` is not, a ``number`` stands at the right


@dataclass(frozen=True, slots=True)
class Table:
    """A table."""

    columns: tuple[PageColumn, ...]  # heads and how cells stand
    rows: tuple[tuple[Cell, ...], ...]  # as many cells each as there are columns
    caption: str = ""  # plain text above it
    latex: str = ""  # a table for paper that is printed instead, where one was made for it; empty without


@dataclass(frozen=True, slots=True)
class PageFigure:
    """A figure."""

    stem: str  # of its files in the folder of figures, ``stem.pdf`` and ``stem.svg``
    svg: str  # as matplotlib writes it
    caption: str  # plain text


@dataclass(frozen=True, slots=True)
class Listing:
    """Verbatim text under a title; pages fold it."""

    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Notice:
    """Something that could not be done, and why."""

    text: str


Block: TypeAlias = "Paragraph | DisplayedFormula | Table | PageFigure | Listing | Notice | Section"


@dataclass(frozen=True, slots=True)
class Section:
    """A heading and what follows it."""

    title: str  # plain text; empty for blocks without a heading
    blocks: tuple[Block, ...]  # in order
    anchor: str  # of letters, digits and hyphens; unique in its report
    mathematics: Mathematics | None = field(default=None)  # stands in place of the title
    folded: str = ""  # what a page shows until a reader opens the section; empty where all of it is shown


def text(*runs: Run) -> Paragraph:
    """Return a paragraph."""
    return Paragraph(runs)


def sentence(words: str) -> str:
    """Return words with a capital letter at the beginning and a full stop at the end."""
    bare = words.strip(" .,:;")
    return f"{bare[:1].upper()}{bare[1:]}." if bare else ""


def marked(badge: Badge, words: str) -> Paragraph:
    """Return a verdict, and behind it what it rests on as a sentence of its own."""
    said = sentence(words)
    return text(badge, f" {said}") if said else text(badge)


def as_printed(passages: Iterable[Passage]) -> list[Block]:
    """Return what a command prints: each passage as a paragraph, and the table below it."""
    blocks: list[Block] = []
    for lines, rows, has_head in passages:
        runs: list[Run] = []
        for line in lines:
            runs += ["\n", sentence(line)] if runs else [sentence(line)]
        blocks += [text(*runs)] if runs else []
        if rows:
            head, *body = rows if has_head else [("",) * len(rows[0]), *rows]
            cells = tuple(tuple((exponents(cell.replace("+-", "±")),) for cell in row) for row in body)
            blocks.append(Table(columns(*((name, "number") for name in head)), cells))
    return blocks


def parted(sections: Sequence[Section]) -> tuple[Block, ...]:
    """Return sections below each other; of a single one its blocks, since a heading would say nothing new."""
    return sections[0].blocks if len(sections) == 1 else tuple(sections)


def columns(*heads: str | tuple[str, Side]) -> tuple[PageColumn, ...]:
    """Return columns with plain heads."""
    return tuple(PageColumn((h,)) if isinstance(h, str) else PageColumn((h[0],), h[1]) for h in heads)


def filled(heads: tuple[PageColumn, ...], rows: Sequence[tuple[Cell, ...]], latex: str = "") -> Table:
    """Return a table without the columns in which no row says anything."""
    kept = [i for i in range(len(heads)) if any(row[i] not in (("",), ("–",)) for row in rows)]
    chosen = tuple(tuple(row[i] for i in kept) for row in rows)
    return Table(tuple(heads[i] for i in kept), chosen, latex=latex)


def mathematics(expression: Expression, model: Model) -> Mathematics:
    """Return an expression with a model's labels."""
    return labelled(expression, model_labels(model))


def labelled(expression: Expression, labels: Mapping[str, str]) -> Mathematics:
    """Return an expression with given labels."""
    return Mathematics(mathml_expression(expression, labels), latex_expression(expression, labels))


_RAISED: Final = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def exponents(decimal: str) -> str:
    """Return a decimal such as ``-1.5e-3`` as it is written by hand."""
    mantissa, _, exponent = decimal.partition("e")
    shown = mantissa.replace("-", "−")
    return f"{shown}·10{exponent.translate(_RAISED)}" if exponent else shown


def unit_text(unit: str) -> str:
    """Return a unit, nothing for a pure number."""
    raised = re.sub(r"\^(-?[0-9]+)", lambda m: m[1].translate(_RAISED), unit)
    return "" if unit == "1" else raised.replace("*", "·")


@dataclass(frozen=True, slots=True)
class ChapterPart:
    """One section of the chapter about a model."""

    title: str  # plain text; empty for blocks without a heading
    blocks: tuple[Block, ...]  # what it says
    files: Mapping[str, bytes] = field(default_factory=dict)  # content by path inside the report's folder
    warnings: tuple[str, ...] = ()  # what the user should be told on the terminal as well
    code: int = 0  # exit code: not 0 when something is missing that the specification asks for


def code_of(error: SymflexError) -> int:
    """Return the exit code for what a report lacks: 4 not certified, 5 a budget; 0 if it is not to be had."""
    return error.exit_code if error.exit_code >= UncertifiedError.exit_code else 0


def picture(stem: str, drawn: Figure, caption: str, files: dict[str, bytes]) -> PageFigure:
    """Return a figure as a block: its SVG stands on the page, and beside its PDF in ``files`` for papers."""
    svg = render(drawn, "svg")
    files |= {f"figures/{stem}.svg": svg, f"figures/{stem}.pdf": render(drawn, "pdf")}
    return PageFigure(stem, svg.decode(), caption)
