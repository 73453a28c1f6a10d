"""What of a file is mathematics, and what macros make of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from symflex.errors import SpecError, Text
from symflex.papers.source import Paper, read_paper, read_text, statements, text_of, tokens_of

PAPER = r"""\documentclass{article} % \[ no \]
\newcommand{\w}{\omega}
\newcommand{\over2}[2]{\frac{#1}{#2}}
\newcommand{\x}[1][a]{x_{#1}}
\def\be{\begin{equation}} \def\ee{\end{equation}}
\def\pair#1#2{#1 + #2}
\DeclareMathOperator{\sech}{sech}
\begin{document}
In words $m=1$, \verb|\[ a = b \]| and \$5.
\be \label{eq:one} G = \frac{1}{ms^2 + \x + \x[b]}, \ee
\begin{align} A &= b \label{a}\\ C &= d, \qquad\text{where } p = \w^2 \tag{7} \end{align}
\begin{verbatim} \[ x=y \] \end{verbatim}
\[ \left\{\begin{array}{l} a = \pair{b}{c} \\ c = d \end{array}\right. \]
$$ y = a \qquad [\mathrm{m}] $$
\begin{multline} x = a \\ + b \end{multline}
"""


def sides(paper: Paper) -> list[list[str]]:
    return [[text_of(s) for s in e.sides] for d in paper.displays for e in statements(d.tokens)]


def test_a_paper_is_cut_into_equations_with_macros_replaced() -> None:
    assert sides(read_text(Text.alone("paper.tex", PAPER))) == [
        ["m", "1"],
        ["G", r"\frac{1}{ms^2+x_{a}+x_{b}}"],
        ["A", "b"],
        ["C", "d"],
        ["p", r"\omega^2"],
        ["a", "b+c"],
        ["c", "d"],
        ["y", "a"],
        ["x", "a+b"],
    ]


FORMS = (
    (r"\begin{eqnarray} G &=& a \nonumber \\ &=& c, \label{x} \end{eqnarray}", [["G", "a", "c"]]),
    (
        r"\begin{equation}\begin{array}{rcl} x &=& a \\ y &=& c \end{array}\end{equation}",
        [["x", "a"], ["y", "c"]],
    ),
    (r"\[ G = a, \quad\text{with}\quad a = c \text{ and } b = d \]", [["G", "a"], ["a", "c"], ["b", "d"]]),
    (r"\begin{align} x &= a \\ \intertext{where} a &= b \end{align}", [["x", "a"], ["a", "b"]]),
    (r"\begin{alignat}{2} x &= a &\quad y &= b \end{alignat}", [["x", "a"], ["y", "b"]]),
    (r"\begin{split} G &= a\,\Bigl[ b \\ &\quad + c \Bigr] \end{split}", [["G", "a[b+c]"]]),
    (r"\begin{IEEEeqnarray}{rCl} a & = & b \IEEEyesnumber \end{IEEEeqnarray}", [["a", "b"]]),
    (r"$$ a = b \eqno(3) $$", [["a", "b"]]),
    (r"\[ \left. \begin{aligned} a &= b \\ c &= d \end{aligned} \right\} \]", [["a", "b"], ["c", "d"]]),
    (r"\[ a = b \quad \Rightarrow \quad c = d \]", [["a", "b"], ["c", "d"]]),
    (r"\[ a = b \qquad (7) \]", [["a", "b"]]),
)


def test_authors_lay_out_equations_in_many_ways() -> None:
    for latex, expected in FORMS:
        shown = latex if not latex.startswith(r"\begin{split}") else rf"\[ {latex} \]"
        assert sides(read_text(Text.alone("paper.tex", shown))) == expected


def test_labels_and_tags_are_kept_with_their_places() -> None:
    paper = read_text(Text.alone("paper.tex", PAPER))
    names = [[name for _, name in d.labels] for d in paper.displays]
    assert names == [[], ["eq:one"], ["a", "(7)"], [], [], []]
    assert paper.displays[1].span.line == 10


def test_files_beside_the_paper_are_read_and_no_others(tmp_path: Path) -> None:
    (tmp_path / "secret.tex").write_text(r"\[ secret = 1 \]")
    folder = tmp_path / "paper"
    (folder / "parts").mkdir(parents=True)
    (folder / "parts" / "model.tex").write_text(r"\[ a = b \]")
    main = folder / "main.tex"
    main.write_text(r"\input{parts/model} \input parts/model.tex \input{missing} \[ c = d \]")
    paper = read_paper(main)
    assert sides(paper) == [["a", "b"], ["a", "b"], ["c", "d"]]
    assert [n.message for n in paper.notes] == ["'missing.tex' is not read: there is no such file"]
    (folder / "link.tex").symlink_to(tmp_path / "secret.tex")
    for asked in (r"\input{../secret}", rf"\input{{{tmp_path}/secret}}", r"\input{link}", r"\input{main}"):
        main.write_text(asked)
        with pytest.raises(SpecError, match=r"main.tex:1:1: error\[SF115\]"):
            read_paper(main)


HOSTILE = (
    r"\def\a{\a\a}\[ \a \]",
    r"\newcommand{\a}{\b\b}\newcommand{\b}{\a\a}\[ x = \a \]",
    r"\def\a#1{#1#1#1#1}\[ " + r"\a{" * 30 + "x" + "}" * 30 + r" \]",
    r"\[ " + "{" * 3000 + r" \]",
    r"\[ " + r"\frac{" * 2000 + r" \]",
    r"\[ " + "(" * 3000 + "a" + ")" * 3000 + r" \]",
    r"\[ " + "a+" * 30_000 + r"b \]",
    r"\begin{equation} a = b",
    r"\begin{equation}" * 500,
    r"\[ " + r"\begin{cases}" * 200 + r" \]",
    r"\[ x = \begin{pmatrix}" + "a&" * 5000 + r"\end{pmatrix} \]",
    r"\newcommand{\a}[9]{#1}\[ \a \]",
    r"\newcommand{\a",
    "\\[ a\x00b\x1b[2J = \ud7ff \\]",
    r"\[ a = b^{b^{b^{b^{b^{b^{b^{b}}}}}}} \]",
    r"\[ x_{x_{x_{x_{x}}}} = \sqrt[999999]{x} \]",
    r"\[ \prod_{i=1}^{999} \prod_{j=1}^{999} x = a\]",
    "$" * 9999,
    r"\verb|" * 5000,
)


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_files_end_in_a_typed_error_or_in_formulas(text: str) -> None:
    try:
        paper = read_text(Text.alone("paper.tex", text))
        for display in paper.displays:
            if display.problem is None:
                statements(display.tokens)
    except SpecError as error:
        assert all(d.code in ("SF103", "SF115") and d.span is not None for d in error.diagnostics)


@pytest.mark.parametrize(
    ("latex", "count"),
    [
        (r"\begin{align} a &= b & c &= d \end{align}", 2),
        (r"\begin{align} a &= b & &= c \end{align}", 1),
        (r"\begin{eqnarray} a & = & b \\ & & + c \end{eqnarray}", 1),
        (r"\begin{alignat}{2} x &+ y &&= 3 \end{alignat}", 1),
    ],
)
def test_columns_are_equations_where_both_have_a_relation(latex, count):
    assert len(statements(tokens_of(Text.alone("f", latex)))) == count
