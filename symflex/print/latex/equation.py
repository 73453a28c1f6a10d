"""A transfer function as numbered display mathematics that fits the column, with amsmath alone."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from symflex.algebra import LAPLACE
from symflex.expressions import Call, Derivative, Expression, Name, Negative, is_number, names, number
from symflex.model import Input, Model, Output
from symflex.print.forms import PrintedForm
from symflex.print.forms.printed import functions_in
from symflex.print.label import labels_of, symbol
from symflex.print.latex.expression import Writer, break_lines
from symflex.print.latex.page import NARROWEST_MM
from symflex.print.text import shown
from symflex.print.width import EM_MM, FRACTION_EDGES, MINUS, QUAD, RELATION
from symflex.print.writer import ExpressionWriter, Style, Written
from symflex.transfer import AnyTransferFunction

_OVER: Final = "_over_"
RESERVED: Final = {LAPLACE: "s", "pi": r"\pi"}
NOTEBOOK_MM: Final = 190.0  # width of an equation in a notebook, in type of ten points
LONGEST_IN_NOTEBOOK: Final = 20_000

# TeX keeps a whole display in its memory.
_LINES_PER_DISPLAY: Final = 300
_TAG: Final = 2.9  # a number of three digits and the least room before it
_PARENTHESES: Final = 0.781
_Sides = tuple[str, float, "Expression"]  # left side of an equation with its width [em], and the right one
_WHERE: Final = r"\text{where}\quad "
_WHERE_WIDTH: Final = 3.57
_LEAST_ROOM: Final = 17.5
_WIDEST_LEFT: Final = 6.0
_NUMERATORS: Final = (("N", "D"), ("P", "Q"), ("B", "A"), (r"\mathcal{N}", r"\mathcal{D}"))


class _DisplayRow(NamedTuple):
    """One equation of a display: its left side, and its right one in lines."""

    left: str
    right: tuple[str, ...]


def model_labels(model: Model) -> dict[str, str]:
    """Return the labels of a model's parameters and definitions, declared or made, no two alike."""
    named = [(p.name, p.latex) for p in model.parameters] + [(d.name, d.latex) for d in model.definitions]
    return labels_of(named, RESERVED)


def equation_label(name: str) -> str:
    r"""Return the ``\label`` of a transfer function: that of the exported functions of its name.

    Different names have different labels: a slash remains where ``_over_`` could be read in two ways.
    """
    plain = re.sub(r"[^A-Za-z0-9_/]", lambda m: f".{ord(m[0]):x}.", name)
    joined = plain.replace("/", _OVER)
    is_unique = len(re.findall(f"(?={_OVER})", joined)) == 1
    return f"eq:{joined if is_unique else plain}"


def ratio_latex(tf: AnyTransferFunction) -> str:
    r"""Return output over input on one line, such as ``V_{\mathrm{tip}}(s)/F(s)``."""
    s = Writer({}).piece(Name(LAPLACE))
    (above, _), (below, _) = _end(tf.output, s), _end(tf.input, s)
    return f"{above}/{below}"


def transfer_function_latex(
    tf: AnyTransferFunction, form: PrintedForm, *, width_mm: float | None, label: str = ""
) -> str:
    """Return a transfer function as a numbered display, with its definitions in ``where`` lines.

    One line is an ``equation``, more an ``align`` with numerator and denominator named; ``width_mm`` is that
    of the text, ``None`` for lines of any length.
    """
    writer = Writer(form_labels(tf, form))
    width = None if width_mm is None else max(width_mm, NARROWEST_MM) / EM_MM
    parts = [_formula(tf, form, writer, width, label or equation_label(tf.name))]
    return "\n".join([*parts, *where_latex(form, writer, width_mm)])


def where_latex(form: PrintedForm, writer: Writer, width_mm: float | None) -> list[str]:
    """Return the display below a formula that says what its names stand for, none where it has none."""
    if not (form.where or form.laws):
        return []
    width = None if width_mm is None else max(width_mm, NARROWEST_MM) / EM_MM
    return [_align(_where_rows(_explained(form, writer), writer, width), "align*", "")]


def formula_latex(
    sides: Sequence[tuple[str, Expression]],
    where: Sequence[tuple[str, Expression]],
    labels: Mapping[str, str],
    *,
    width_mm: float | None,
) -> str:
    """Return equations, left sides in LaTeX, as a display without numbers, broken where they must be."""
    writer = Writer(labels)
    width = None if width_mm is None else max(width_mm, NARROWEST_MM) / EM_MM
    # The commands of the left side are wider than what they print.
    column = max(min(float(len(left)), _WIDEST_LEFT) for left, _ in sides)
    parts = [_align([_row(left, e, writer, width, column) for left, e in sides], "align*", "")]
    if where:
        room = None if width is None else width - _WHERE_WIDTH
        parts.append(_align(_where_rows(_defined(where, writer), writer, room), "align*", ""))
    return "\n".join(parts)


def inline_latex(tf: AnyTransferFunction, form: PrintedForm) -> str:
    r"""Return a transfer function as one line of mathematics without delimiters, for notebooks and HTML."""
    writer = Writer(form_labels(tf, form))
    formula = f"{_left_side(tf, form, writer)[0]} = {_right_side(form, writer)[0]}"
    if not (form.where or form.laws):
        return formula
    where = [f"{left} = {writer.piece(right).markup}" for left, _, right in _explained(form, writer)]
    return rf"{formula},\quad \text{{where }} " + r",\; ".join(where)


def notebook_latex(tf: AnyTransferFunction, form: PrintedForm) -> str | None:
    """Return a transfer function as mathematics without delimiters, in lines where one would be too long.

    Only what KaTeX and MathJax share is used; None beyond :data:`LONGEST_IN_NOTEBOOK` characters.
    """
    writer = Writer(form_labels(tf, form))
    width = NOTEBOOK_MM / EM_MM
    right, right_width = _right_side(form, writer)
    if len(right) > LONGEST_IN_NOTEBOOK:
        return None
    one_line = _left_side(tf, form, writer)[1] + RELATION + right_width
    if not (form.where or form.laws) and one_line <= width:
        return inline_latex(tf, form)
    rows = [*_rows(tf, form, writer, width), *_where_rows(_explained(form, writer), writer, width)]
    lines = []
    for row in rows:
        first, *more = row.right if row.right[0] else row.right[1:]
        lines += [f"{row.left} &= {first}", *(rf"&\quad {line}" for line in more)]
    body = " \\\\ ".join(lines)
    latex = rf"\begin{{aligned}} {body} \end{{aligned}}"
    return latex if len(latex) <= LONGEST_IN_NOTEBOOK else None


def form_labels(tf: AnyTransferFunction, form: PrintedForm) -> dict[str, str]:
    """Return the labels of every name in a printed form: the model's, and those the form brings."""
    labels = model_labels(tf.model)
    own = [(name, "") for name, _ in (*form.where, *form.laws) if name not in labels]
    own += [(left.name, "") for left, _ in form.closed if isinstance(left, Name)]
    labelled = {*labels, *dict(own)}
    own += [(name, latex) for name, latex in sorted(functions_in(form).items()) if name not in labelled]
    return labels_of(own, labels)


def _end(end: Input | Output, argument: Written) -> tuple[str, float]:
    label = symbol(end.name, {end.name: end.latex})
    return f"{label.latex}({argument.markup})", label.width + argument.width + _PARENTHESES


def _left_side(tf: AnyTransferFunction, form: PrintedForm, writer: Writer) -> tuple[str, float]:
    argument = writer.piece(form.argument)
    (above, above_width), (below, below_width) = _end(tf.output, argument), _end(tf.input, argument)
    return rf"\frac{{{above}}}{{{below}}}", max(above_width, below_width) + FRACTION_EDGES.text


def split_sign(form: PrintedForm) -> tuple[str, Expression]:
    """Return the sign that stands before the fraction, and the numerator without it."""
    num = form.num
    return ("-", num.operand) if isinstance(num, Negative) else ("", num)


def _right_side(form: PrintedForm, writer: Writer) -> tuple[str, float]:
    if is_number(form.den, 1):
        piece = writer.piece(form.num)
        return piece.markup, piece.width
    sign, num = split_sign(form)
    above, below = writer.piece(num, Style.TEXT), writer.piece(form.den, Style.TEXT)
    width = max(above.width, below.width) + FRACTION_EDGES.text + (MINUS if sign else 0)
    return rf"{sign}\frac{{{above.markup}}}{{{below.markup}}}", width


def _formula(
    tf: AnyTransferFunction, form: PrintedForm, writer: Writer, width: float | None, name: str
) -> str:
    left, left_width = _left_side(tf, form, writer)
    right, right_width = _right_side(form, writer)
    label = rf"\label{{{name}}}"
    # Where only the number lacks room, it stands below the formula by itself.
    if width is None or left_width + RELATION + right_width <= width:
        return f"\\begin{{equation}}\n  {label}\n  {left} = {right}\n\\end{{equation}}"
    return _align(_rows(tf, form, writer, width), "align", label)


def _rows(tf: AnyTransferFunction, form: PrintedForm, writer: Writer, width: float) -> list[_DisplayRow]:
    """Return a formula too wide for one line: a quotient in names for what is long, and what these are."""
    left, left_width = _left_side(tf, form, writer)
    if is_number(form.den, 1):
        return [_row(left, form.num, writer, width, left_width, _TAG)]
    sign, num = split_sign(form)
    varying, argument = varying_names(form), writer.piece(form.argument)
    parts, rows = [], []
    for name, expression in zip(free_names(form, writer), (num, form.den), strict=True):
        piece = writer.piece(expression, Style.TEXT)
        head = piece.markup
        if left_width + RELATION + MINUS + FRACTION_EDGES.text + piece.width + _TAG > width:
            depends = any(n.name in varying for n in names(expression))
            head = f"{name}({argument.markup})" if depends else name
            rows.append(_row(head, expression, writer, width, left_width))
        parts.append(head)
    return [_DisplayRow(left, (rf"{sign}\frac{{{parts[0]}}}{{{parts[1]}}}",)), *rows]


def varying_names(form: PrintedForm) -> frozenset[str]:
    """Return s, and the names that stand for functions of it."""
    varying = {LAPLACE, *functions_in(form)}
    # A line may use the names of any other.
    users: dict[str, set[str]] = {}
    for name, expression in form.where:
        for used in names(expression):
            if isinstance(used, Name):
                users.setdefault(used.name, set()).add(name)
    pending = list(varying)
    while pending:
        pending += users.get(pending.pop(), set()) - varying
        varying.update(pending)
    return frozenset(varying)


def free_names(form: PrintedForm, writer: ExpressionWriter) -> tuple[str, str]:
    """Return names for numerator and denominator that no symbol of the formula bears."""
    expressions = [form.num, form.den, *(e for _, e in form.where)]
    used = {n.name for e in expressions for n in names(e) if isinstance(n, Name)}
    taken = {writer.label(name).latex for name in sorted(used)}
    return next((pair for pair in _NUMERATORS if not taken & set(pair)), _NUMERATORS[-1])


def _explained(form: PrintedForm, writer: Writer) -> list[_Sides]:
    """Return both sides of what stands below a formula: definitions of names, and laws."""
    laws = [(writer.piece(left), right) for left, right in laws_and_starts(form)]
    return [*_defined(form.where, writer), *((left.markup, left.width, right) for left, right in laws)]


def _where_rows(equations: Sequence[_Sides], writer: Writer, width: float | None) -> list[_DisplayRow]:
    """Return equations aligned with each other, "where" before the first."""
    widths = (left_width + _WHERE_WIDTH * (not i) for i, (_, left_width, _) in enumerate(equations))
    column = max(widths, default=0.0)
    return [
        _row(left if i else f"{_WHERE}{left}", right, writer, width, column)
        for i, (left, _, right) in enumerate(equations)
    ]


def _defined(where: Sequence[tuple[str, Expression]], writer: Writer) -> list[_Sides]:
    """Return both sides of definitions of names."""
    sides = (shown(*line) for line in where)
    return [((piece := writer.piece(left)).markup, piece.width, right) for left, right in sides]


def laws_and_starts(form: PrintedForm) -> Iterator[tuple[Expression, Expression]]:
    """Yield both sides of each differential equation, of each value at x = 0, and of closed forms."""
    for name, law in form.laws:
        if isinstance(law.left, Derivative | Call):
            yield law.left, law.right
            continue
        order = max(node.order for node in names(law) if isinstance(node, Derivative))
        yield law.left, law.right
        yield from ((Call(name, number(0), k), number(int(k == order - 1))) for k in range(order))
    yield from form.closed


def _row(
    left: str, expression: Expression, writer: Writer, width: float | None, column: float, tag: float = 0.0
) -> _DisplayRow:
    """Return an equation with its right side broken; ``tag`` is the room left for a number [em]."""
    if width is None:
        return _DisplayRow(left, (writer.piece(expression).markup,))
    room = width - column - RELATION
    if room - tag < _LEAST_ROOM:
        # The left side stands in a line of its own.
        room = width - RELATION - QUAD
        return _DisplayRow(left, ("", *break_lines(expression, writer, room, room - QUAD + RELATION)))
    return _DisplayRow(left, tuple(break_lines(expression, writer, room - tag, room - QUAD)))


def _align(rows: Sequence[_DisplayRow], environment: str, label: str) -> str:
    """Return rows aligned at their equals signs; pages may break between lines."""
    stands_alone = any(row.right[0] == "" for row in rows)
    lines: list[str] = []
    for row in rows:
        first, *more = row.right if row.right[0] else row.right[1:]
        lines += [f"& {row.left}", rf"&\quad = {first}"] if stands_alone else [f"{row.left} &= {first}"]
        indent = r"&\qquad " if stands_alone else r"&\quad "
        lines += [f"{indent}{line}" for line in more]
    if environment == "align":
        lines = [f"{lines[0]} {label}", *(rf"{line} \notag" for line in lines[1:])]
    displays = []
    for start in range(0, len(lines), _LINES_PER_DISPLAY):
        # The first line stays with the next.
        first, *more = lines[start : start + _LINES_PER_DISPLAY]
        body = " \\\\*\n  ".join((first, " \\\\\n  ".join(more))) if more else first
        displays.append(f"\\begin{{{environment}}}\n  {body}\n\\end{{{environment}}}")
    if len(lines) == 1:
        return displays[0]
    return "\n".join((r"\begingroup\allowdisplaybreaks", *displays, r"\endgroup"))
