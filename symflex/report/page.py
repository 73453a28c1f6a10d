"""A report as one HTML page that needs nothing else: no script, no network, no font of the machine.

Everything that comes from a specification is plain text here and is escaped; mathematics and figures are
markup that symflex itself wrote.
"""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Iterable, Iterator
from importlib import resources
from itertools import takewhile
from typing import Final, assert_never

from symflex.figures.files import inline_svg
from symflex.print.mathml import math_element
from symflex.report.document import (
    Aside,
    Badge,
    Block,
    Code,
    DisplayedFormula,
    Listing,
    Mathematics,
    Notice,
    PageColumn,
    PageFigure,
    PageLink,
    Paragraph,
    Run,
    Section,
    Table,
)
from symflex.report.report import Report

DEEPEST_HEADING: Final = 6
CONTENTS_DEPTH: Final = 2
PAIR: Final = 2  # columns up to which a table with text is narrow enough for every screen
WIDE: Final = 6  # columns from which a table with text may be wider than the column of text
LONG_INLINE: Final = 600  # characters of mathematics in a sentence that may be wider than a telephone
MATH_FONT: Final = "fonts/symflex-math.woff2"
_FONT_FACE: Final = (
    '@font-face{{font-family:"symflex math";src:url(data:font/woff2;base64,{}) format("woff2")}}'
)


def report_page(report: Report) -> str:
    """Return a report as HTML."""
    package = resources.files("symflex.report")
    style = package.joinpath("page.css").read_text(encoding="utf-8")
    font = b64encode(package.joinpath(MATH_FONT).read_bytes()).decode("ascii")
    byline = " · ".join(filter(None, (report.subtitle, report.date)))
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        "<head>",
        '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        '<meta name="color-scheme" content="light dark">',
        # Whatever slipped through could still load nothing.
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; font-src data:; style-src '
        "'unsafe-inline'\">",
        f"<title>{_escape(report.title)}</title>",
        f"<style>\n{_FONT_FACE.format(font)}\n{style}</style>",
        "</head>",
        '<body id="top">',
        '<a class="skip" href="#models">To the results</a>',
        "<header>",
        f"<h1>{_escape(report.title)}</h1>",
        f"<p>{_escape(byline)}</p>" if byline else "",
        "</header>",
        '<nav id="contents" aria-label="Contents">',
        "<details><summary>Contents</summary>",
        _contents(report.sections, 1),
        "</details></nav>",
        "<main>",
        *(_section(section, 2) for section in report.sections),
        "</main>",
        "</body>",
        "</html>",
    ]
    return "\n".join(filter(None, parts)) + "\n"


def _escape(text: str) -> str:
    """Return plain text for content and quoted attributes; what does not print vanishes."""
    shown = "".join(c for c in " ".join(text.split(" ")) if c.isprintable())
    return html.escape(shown, quote=True)


def _contents(sections: Iterable[Section], depth: int) -> str:
    items = []
    for section in sections:
        inner = [b for b in section.blocks if isinstance(b, Section) and b.title]
        below = _contents(inner, depth + 1) if inner and depth < CONTENTS_DEPTH else ""
        items.append(f'<li><a href="#{_escape(section.anchor)}">{_heading(section)}</a>{below}</li>')
    return f"<ol>{''.join(items)}</ol>" if depth == 1 else f"<ul>{''.join(items)}</ul>"


def _heading(section: Section) -> str:
    if section.mathematics is None:
        return _escape(section.title)
    return math_element(section.mathematics.mathml)


def _section(section: Section, level: int) -> str:
    anchor = _escape(section.anchor)
    tag = f"h{min(level, DEEPEST_HEADING)}"
    if not section.title:
        body = "\n".join(_block(block, level) for block in section.blocks)
        return f'<div id="{anchor}">\n{body}\n</div>'
    blocks = [_block(block, level + 1) for block in section.blocks]
    if section.folded:
        # A chapter's first sentences, and what it warns of, stay in sight.
        shown = sum(1 for _ in takewhile(lambda b: isinstance(b, Paragraph | Notice), section.blocks))
        summary = f'<details class="folded"><summary>{_escape(section.folded)}</summary>'
        blocks[shown:] = [summary, *blocks[shown:], "</details>"]
    body = "\n".join(blocks)
    return (
        f'<section id="{anchor}" aria-labelledby="{anchor}-h">\n'
        f'<{tag} id="{anchor}-h">{_heading(section)}</{tag}>\n{body}\n</section>'
    )


def _block(block: Block, level: int) -> str:
    match block:
        case Section():
            return _section(block, level)
        case Paragraph(runs=runs):
            is_long = any(isinstance(run, Mathematics) and len(run.mathml) > LONG_INLINE for run in runs)
            attributes = ' class="scroll" tabindex="0"' if is_long else ""
            return f"<p{attributes}>{_runs(runs)}</p>"
        case DisplayedFormula():
            return "\n".join(_formula(block))
        case Table():
            return _table(block)
        case PageFigure():
            drawn = inline_svg(block.svg, block.stem, block.caption)
            files = (
                f'<a href="figures/{_escape(block.stem)}.pdf">PDF</a>, '
                f'<a href="figures/{_escape(block.stem)}.svg">SVG</a>'
            )
            shown = f"{_escape(block.caption)} <span>{files}</span>"
            return f"<figure>{drawn}\n<figcaption>{shown}</figcaption></figure>"
        case Listing(title=title, text=text):
            lines = "\n".join(_escape(line) for line in text.expandtabs(4).splitlines())
            return f"<details><summary>{_escape(title)}</summary><pre>{lines}</pre></details>"
        case Notice(text=text):
            return f'<p class="notice" role="note">{_escape(text)}</p>'
        case _:
            assert_never(block)


def _formula(formula: DisplayedFormula) -> Iterator[str]:
    yield f'<div class="formula" tabindex="0" role="group" aria-label="{_escape(formula.name)}">'
    is_below = False
    for row in formula.rows:
        if row.is_where and not is_below:
            yield '<div class="where"><span>where</span>'
            is_below = True
        yield f'<div class="row">{row.elements}</div>'
    if is_below:
        yield "</div>"
    yield "</div>"


def _table(table: Table) -> str:
    # On a narrow screen the cells of a row stand below each other, each with its head.
    has_text = any(c.side == "text" for c in table.columns)
    is_stacked = len(table.columns) > PAIR and has_text
    is_wide = len(table.columns) >= WIDE and has_text
    kind = ' class="stack"' if is_stacked else ""
    scroll = "scroll wide" if is_wide else "scroll"
    label = _escape(table.caption or "Table")
    head = "".join(f'<th scope="col" class="{c.side}">{_runs(c.head)}</th>' for c in table.columns)
    body = "\n".join(_row(row, table.columns) for row in table.rows)
    caption = f"<caption>{_escape(table.caption)}</caption>" if table.caption else ""
    return (
        f'<div class="{scroll}" tabindex="0" role="region" aria-label="{label}">'
        f"<table{kind}>{caption}<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def _row(row: Iterable[tuple[Run, ...]], columns: Iterable[PageColumn]) -> str:
    cells = ""
    for cell, c in zip(row, columns, strict=True):
        head = "".join(run for run in c.head if isinstance(run, str))
        cells += f'<td class="{c.side}" data-head="{_escape(head)}">{_runs(cell)}</td>'
    return f"<tr>{cells}</tr>"


def _runs(runs: Iterable[Run]) -> str:
    return "".join(map(_run, runs))


def _run(run: Run) -> str:
    match run:
        case str():
            return "<br>".join(_escape(line) for line in run.split("\n"))
        case Mathematics(mathml=mathml):
            return math_element(mathml)
        case Code(text=text):
            return f"<code>{_escape(text)}</code>"
        case Badge(text=text, tone=tone):
            return f'<strong class="{tone}">{_escape(text)}</strong>'
        case Aside(text=text):
            return f"<small>{_escape(text)}</small>"
        case PageLink(text=text, target=target):
            return f'<a href="{_escape(target)}">{_escape(text)}</a>'
        case _:
            assert_never(run)
