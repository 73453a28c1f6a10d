"""A transfer matrix as text, LaTeX, MathML, Typst, Office Math, JSON and SymPy.

Input: a transfer matrix with its printed form. Output: what commands print and notebooks show.

    G(s) = 1/d(s) [ m_2*s^2 + k_2   k_2 ]        what does not fit a line gets a name, ``d(s)``, ``N_11(s)``,
                  [ ...             ... ]        and a row of its own below
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import starmap
from textwrap import wrap
from typing import TYPE_CHECKING, Final

from symflex.expressions import (
    Expression,
    Sum,
    format_expression,
    is_number,
    quotient,
    sum_of,
)
from symflex.matrices.colocated import colocated
from symflex.matrices.printed import MatrixForm
from symflex.matrices.transfer_matrix import TransferMatrix
from symflex.model import Input, Output
from symflex.print.forms.naming import Naming, names_of
from symflex.print.forms.printed import PrintedForm
from symflex.print.text import INDENT, WIDTH, hanging, law_lines, shown

if TYPE_CHECKING:
    import sympy

    from symflex.print.latex.expression import Writer
    from symflex.print.mathml import MathRow

SCHEMA: Final = "symflex.matrix/1"
APART: Final = "   "  # between the columns of a matrix
INLINE: Final = 24  # characters of a denominator that stands in a fraction before a matrix


def matrix_text(matrix: TransferMatrix, form: MatrixForm, width: int = WIDTH) -> str:
    """Return a matrix for a terminal: in one picture, or its entries in lines where that is too wide."""
    naming = Naming((*names_of(matrix.model), *(name for name, _ in (*form.where, *form.laws))))
    whole, below, entry = (_free(naming, *stems) for stems in (("G", "H"), ("d", "D"), ("N", "P")))
    lines = [f"{ends_text(matrix.outputs)} / {ends_text(matrix.inputs)}", ""]
    named = len(format_expression(form.den)) > INLINE
    den = f"{below}(s)" if named else format_expression(form.den)
    picture = drawn_matrix(f"{whole}(s) = ", form, den)
    is_listed = max(map(len, picture)) > width
    if is_listed:
        between = "_" if max(matrix.shape) > 9 else ""  # noqa: PLR2004 (one digit)
        lines += [INDENT + f"{whole}(s) = {_front(form, den)}{entry}(s)", ""]
        for i, row in enumerate(form.entries, 1):
            for j, e in enumerate(row, 1):
                lines += hanging(f"{INDENT}{entry}_{i}{between}{j} = ", e, width)
        lines.append("")
    else:
        lines += [*picture, ""]
    if named:
        lines += [*hanging(f"{INDENT}{below}(s) = ", form.den, width), ""]
    lines += _where_lines(form, width)
    return "\n".join([*lines, *_quantities(matrix, width), *_colocated(matrix, width)])


def _colocated(matrix: TransferMatrix, width: int) -> list[str]:
    """Return a line that names the colocated pairs, none where there is at most one function."""
    if matrix.shape == (1, 1) or not (pairs := _colocated_pairs(matrix)):
        return []
    said = f"colocated: {', '.join('/'.join(pair) for pair in pairs)}"
    return wrap(said, width, initial_indent=INDENT, subsequent_indent=INDENT * 2)


def _colocated_pairs(matrix: TransferMatrix) -> list[tuple[str, str]]:
    if matrix.model.imposed:
        return []
    every = {(tf.output.name, tf.input.name) for tf in matrix.each}
    return [pair for pair in colocated(matrix.model) if pair in every]


def _free(naming: Naming, *stems: str) -> str:
    """Return the first stem that names nothing else, or the first with a number."""
    return next((stem for stem in stems if stem not in naming.taken), None) or naming.take(stems[0])[0]


def ends_text(ends: Sequence[Output | Input]) -> str:
    """Return the names of outputs or inputs, several in brackets."""
    names = ", ".join(end.name for end in ends)
    return names if len(ends) == 1 else f"({names})"


def _front(form: MatrixForm, den: str) -> str:
    """Return the fraction before a matrix on one line."""
    if is_number(form.den, 1):
        return "" if is_number(form.front, 1) else f"({format_expression(form.front)}) * "
    front = format_expression(form.front)
    front = front if front.isidentifier() or front.isdigit() else f"({front})"
    den = den if den.endswith("(s)") and den.count("(") == 1 else f"({den})"
    return f"{front}/{den} * "


def drawn_matrix(head: str, form: MatrixForm, den: str) -> list[str]:
    """Return a fraction, and a matrix in brackets beside it."""
    cells = [[format_expression(e) for e in row] for row in form.entries]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    rows = [APART.join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells]
    if len(rows) == 2:  # noqa: PLR2004 (a line between for the bar of the fraction)
        rows.insert(1, " " * len(rows[0]))
    is_single = len(cells) == len(cells[0]) == 1
    matrix = [] if is_single and is_number(form.entries[0][0], 1) else [f"[ {row} ]" for row in rows]
    front = format_expression(form.front)
    if is_number(form.den, 1):
        front = f"({front})" if matrix and isinstance(form.front, Sum) else front
        fraction = [] if is_number(form.front, 1) and matrix else ["", front, ""]
    else:
        bar = max(len(front), len(den))
        fraction = [front.center(bar), "-" * bar, den.center(bar)]
    height = max(len(matrix), len(fraction), 1)
    middle = (height - 1) // 2
    blocks = [[head], fraction, matrix]
    lines = [""] * height
    for block, gap in zip(blocks, ("", "", " " if fraction else ""), strict=True):
        if not block:
            continue
        start = middle - (len(block) - 1) // 2
        room = max(map(len, block))
        for i in range(height):
            own = block[i - start] if 0 <= i - start < len(block) else ""
            lines[i] += gap + own.ljust(room)
    return [(INDENT + line).rstrip() for line in lines]


def _where_lines(form: MatrixForm, width: int) -> list[str]:
    """Return a line for each name, law and closed form."""
    lines: list[str] = []
    word = "where"
    for left, right in starmap(shown, form.where):
        lines += hanging(f"{INDENT}{word} {format_expression(left)} = ", right, width)
        word = "     "
    for law in form.laws:
        for line in law_lines(*law):
            lines.append(f"{INDENT}{word} {line}")
            word = "     "
    word = "so   "
    for left, expression in form.closed:
        lines += hanging(f"{INDENT}{word} {format_expression(left)} = ", expression, width)
        word = "     "
    return [*lines, ""] if lines else []


def _quantities(matrix: TransferMatrix, width: int) -> list[str]:
    """Return what the entries are: all the same, or a line for each quantity."""
    kinds: dict[str, list[str]] = {}
    for tf in matrix.each:
        kinds.setdefault(tf.quantity + (f" [{tf.unit}]" if tf.unit else ""), []).append(tf.name)
    if len(kinds) == 1:
        return [f"{INDENT}{next(iter(kinds))}"]
    lines: list[str] = []
    for kind, names in kinds.items():
        lines += wrap(
            f"{kind}: {', '.join(names)}", width, initial_indent=INDENT, subsequent_indent=INDENT * 2
        )
    return lines


def matrix_json(matrix: TransferMatrix, form: MatrixForm) -> dict[str, object]:
    """Return the document ``symflex derive --matrix --json`` prints: an entry is ``num`` over ``den``."""
    places = [[(i, j) for j in range(matrix.shape[1])] for i in range(matrix.shape[0])]
    numerators = [[format_expression(form.entry(*place).num) for place in row] for row in places]
    return {
        "schema": SCHEMA,
        "outputs": [o.name for o in matrix.outputs],
        "inputs": [i.name for i in matrix.inputs],
        "form": form.name,
        "num": numerators,
        "den": format_expression(form.den),
        "quantities": [[tf.quantity for tf in row] for row in matrix.pairs],
        "units": [[tf.unit for tf in row] for row in matrix.pairs],
        "where": [[name, format_expression(e)] for name, e in form.where],
        "laws": [[name, format_expression(law)] for name, law in form.laws],
        "colocated": [list(pair) for pair in _colocated_pairs(matrix)],
        "latex": matrix_latex(matrix, form),
        "closed": [[format_expression(a), format_expression(b)] for a, b in form.closed],
    }


def matrix_sympy(matrix: TransferMatrix, form: MatrixForm) -> sympy.ImmutableMatrix:
    """Return the matrix in SymPy, each entry its numerator over d(s)."""
    import sympy

    from symflex.print.sympy import symbols_of, to_sympy

    symbols = symbols_of(matrix.model)
    rows = [
        [to_sympy(quotient(form.entry(i, j).num, form.den), symbols) for j, _ in enumerate(row)]
        for i, row in enumerate(form.entries)
    ]
    return sympy.ImmutableMatrix(rows)


def matrix_latex(matrix: TransferMatrix, form: MatrixForm) -> str:
    """Return a matrix as one line of mathematics without delimiters, for notebooks and HTML."""
    from symflex.print.latex.equation import laws_and_starts

    page = _Latex.of(matrix, form)
    writer = page.writer
    both = [*starmap(shown, form.where), *laws_and_starts(form.lines)]
    where = [f"{writer.piece(a).markup} = {writer.piece(b).markup}" for a, b in both]
    line, _ = page.line(0)
    return rf"{line},\quad \text{{where }} " + r",\; ".join(where) if where else line


def matrix_display(matrix: TransferMatrix, form: MatrixForm, width_mm: float | None = None) -> str:
    """Return a matrix as a numbered display, and what it names in displays below it.

    Where the matrix is wider than ``width_mm``, its denominator gets a name, and then its entries do.
    """
    from symflex.print.latex.equation import formula_latex, where_latex
    from symflex.print.latex.page import NARROWEST_MM
    from symflex.print.width import EM_MM

    page = _Latex.of(matrix, form)
    room = None if width_mm is None else max(width_mm, NARROWEST_MM) / EM_MM
    named = next((n for n in (0, 1, 2) if room is None or page.line(n)[1] <= room), 2)
    line, _ = page.line(named)
    display = f"\\begin{{equation}}\n  \\label{{{page.label}}}\n  {line}\n\\end{{equation}}"
    rows = page.rows(named)
    below = [formula_latex(rows, (), page.labels, width_mm=width_mm)] if rows else []
    return "\n".join([display, *below, *where_latex(form.lines, page.writer, width_mm)])


def _all_in_one(form: MatrixForm) -> PrintedForm:
    """Return a form of one function in which all names of a matrix occur."""
    return replace(form.lines, num=sum_of(form.parts))


@dataclass(frozen=True)
class _Latex:
    """Writes the equation of a matrix with more or fewer parts named."""

    matrix: TransferMatrix
    form: MatrixForm
    labels: Mapping[str, str]
    writer: Writer

    @staticmethod
    def of(matrix: TransferMatrix, form: MatrixForm) -> _Latex:
        """Return the writer of a matrix, with the labels of all its names."""
        from symflex.print.latex.equation import form_labels
        from symflex.print.latex.expression import Writer

        labels = form_labels(matrix.pairs[0][0], _all_in_one(form))
        return _Latex(matrix, form, labels, Writer(labels))

    @property
    def label(self) -> str:
        """What a reference to the equation says: ``eq:G``, or ``eq:X_over_F`` of a single function."""
        from symflex.print.latex.equation import equation_label

        return "eq:G" if self.matrix.shape != (1, 1) else equation_label(self.matrix.pairs[0][0].name)

    @cached_property
    def _stems(self) -> tuple[str, str]:
        from symflex.print.latex.equation import free_names

        return free_names(_all_in_one(self.form), self.writer)

    def line(self, named: int) -> tuple[str, float]:
        """Return the equation and its width [em], with 0: nothing, 1: d(s), 2: the entries named as well."""
        from symflex.print.width import RELATION

        left, left_width = self._vector(self.matrix.outputs)
        right, right_width = self._vector(self.matrix.inputs)
        front, front_width = self._front(named > 0)
        inner, inner_width = self._entries(named > 1)
        return (
            f"{left} = {front}{inner} {right}",
            left_width + RELATION + front_width + inner_width + right_width,
        )

    def rows(self, named: int) -> list[tuple[str, Expression]]:
        """Return what is named, with its name."""
        found: list[tuple[str, Expression]] = []
        if named > 0 and self._has_name:
            found.append((f"{self._stems[1]}(s)", self.form.den))
        if named > 1:
            for i, row in enumerate(self.form.entries):
                found += [(self._place(i, j), e) for j, e in enumerate(row) if not is_plain(e)]
        return found

    @property
    def _has_name(self) -> bool:
        return len(format_expression(self.form.den)) > INLINE // 2

    def _place(self, i: int, j: int) -> str:
        comma = "," if max(self.matrix.shape) > 9 else ""  # noqa: PLR2004 (one digit)
        return f"{self._stems[0]}_{{{i + 1}{comma}{j + 1}}}(s)"

    def _vector(self, ends: Sequence[Output | Input]) -> tuple[str, float]:
        from symflex.print.label import symbol

        labels = [symbol(end.name, {end.name: end.latex}) for end in ends]
        cells = [[f"{label.latex}(s)"] for label in labels]
        width = max(label.width for label in labels) + _ARGUMENT
        return (cells[0][0], width) if len(ends) == 1 else (_pmatrix(cells), width + _FENCES)

    def _front(self, named: bool) -> tuple[str, float]:
        from symflex.print.width import FRACTION_EDGES
        from symflex.print.writer import Style

        if is_number(self.form.den, 1):
            if is_number(self.form.front, 1):
                return "", 0.0
            piece = self.writer.as_factor(self.writer.piece(self.form.front))
            return f"{piece.markup} ", piece.width
        above = self.writer.piece(self.form.front, Style.TEXT)
        below = self.writer.piece(self.form.den, Style.TEXT)
        markup, width = below.markup, below.width
        if named and self._has_name:
            markup, width = f"{self._stems[1]}(s)", _ARGUMENT + 1
        return rf"\frac{{{above.markup}}}{{{markup}}} ", max(above.width, width) + FRACTION_EDGES.text

    def _entries(self, named: bool) -> tuple[str, float]:
        from symflex.print.width import QUAD

        if self.matrix.shape == (1, 1) and is_number(self.form.entries[0][0], 1):
            return "", 0.0
        cells: list[list[str]] = []
        widths: list[list[float]] = []
        for i, row in enumerate(self.form.entries):
            pieces = [self.writer.piece(e) for e in row]
            is_named = [named and not is_plain(e) for e in row]
            cells.append([self._place(i, j) if is_named[j] else p.markup for j, p in enumerate(pieces)])
            widths.append([_ARGUMENT + 2 if is_named[j] else p.width for j, p in enumerate(pieces)])
        width = sum(map(max, zip(*widths, strict=True))) + QUAD * (len(widths[0]) - 1)
        return _pmatrix(cells), width + _FENCES


_ARGUMENT: Final = 1.4  # width of ``(s)`` [em]
_FENCES: Final = 1.8  # of both parentheses of a matrix [em]
PLAIN: Final = 6  # characters of an entry that needs no name


def is_plain(entry: Expression) -> bool:
    """Tell whether an entry is as short as a name for it."""
    return len(format_expression(entry)) <= PLAIN


def _pmatrix(cells: Sequence[Sequence[str]]) -> str:
    rows = r" \\ ".join(" & ".join(row) for row in cells)
    return rf"\begin{{pmatrix}} {rows} \end{{pmatrix}}"


def matrix_mathml(matrix: TransferMatrix, form: MatrixForm) -> tuple[MathRow, ...]:
    """Return a matrix as equations below each other: the matrix, what it names, and the ``where`` rows."""
    from symflex.print.label import numeral, row, with_scripts
    from symflex.print.latex.equation import form_labels, laws_and_starts
    from symflex.print.mathml import WIDEST_FRACTION, MathmlWriter, MathRow, label_mathml, of_s, table_mathml
    from symflex.print.writer import Style

    every = _all_in_one(form)
    labels = form_labels(matrix.pairs[0][0], every)
    writer = MathmlWriter(labels)
    naming = Naming((*names_of(matrix.model), *(name for name, _ in (*form.where, *form.laws))))
    below, entry = (_free(naming, *stems) for stems in (("d", "D"), ("N", "P")))

    def vector(ends: Sequence[Output | Input]) -> str:
        cells = [[of_s(label_mathml(end.name, {end.name: end.latex}))] for end in ends]
        return cells[0][0] if len(cells) == 1 else table_mathml(cells)

    rows: list[MathRow] = []
    parts: list[str] = []
    if is_number(form.den, 1):
        parts += [] if is_number(form.front, 1) else [writer.as_factor(writer.piece(form.front)).markup]
    else:
        den = writer.piece(form.den, Style.TEXT).markup
        if writer.width(form.den, Style.TEXT) > WIDEST_FRACTION / 4:
            den = of_s(label_mathml(below, labels))
            rows.append(MathRow(den, writer.pieces(form.den)))
        parts.append(f"<mfrac>{writer.piece(form.front, Style.TEXT).markup}{den}</mfrac>")
    widths = [max(map(writer.width, column)) for column in zip(*form.entries, strict=True)]
    cells = [[writer.piece(e).markup for e in line] for line in form.entries]
    if sum(widths) > WIDEST_FRACTION:
        for i, line in enumerate(form.entries):
            for j, e in enumerate(line):
                if not is_plain(e):
                    place = row(numeral(str(i + 1)), numeral(str(j + 1)))
                    cells[i][j] = of_s(with_scripts(label_mathml(entry, labels), place, ""))
                    rows.append(MathRow(cells[i][j], writer.pieces(e)))
    if not (matrix.shape == (1, 1) and is_number(form.entries[0][0], 1)):
        parts.append(table_mathml(cells))
    parts.append(vector(matrix.inputs))
    both = [*starmap(shown, form.where), *laws_and_starts(every)]
    where = [(writer.piece(a).markup, b) for a, b in both]
    lines = (MathRow(left, writer.pieces(right), is_where=True) for left, right in where)
    return (MathRow(vector(matrix.outputs), tuple(parts)), *rows, *lines)
