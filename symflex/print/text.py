"""Plain text for a terminal: transfer functions, and the rows of tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain, repeat
from re import Pattern
from re import compile as compile_pattern
from textwrap import wrap
from typing import TYPE_CHECKING, NamedTuple

from symflex.errors import REPORT, Diagnostic, InternalError
from symflex.expressions import (
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Quotient,
    format_expression,
    is_number,
    names,
    power,
)

if TYPE_CHECKING:
    from symflex.print.forms import PrintedForm
    from symflex.transfer import AnyTransferFunction

WIDTH = 80  # columns of a terminal
INDENT = "  "
NARROWEST = 12  # columns below which breaking a line further would not help to read it
SHALLOW = 8  # columns up to which a broken sum stands to the right of its parenthesis


def form_text(tf: AnyTransferFunction, form: PrintedForm) -> str:
    """Return ``OUT/IN = num/den`` on one line, and a line per definition or law used."""
    whole = form.num if is_number(form.den, 1) else Quotient(form.num, form.den)
    lines = [f"{_left_side(tf, form)} = {format_expression(whole)}"]
    lines += [f"  {form.stability.headline}"] if form.stability else []
    both = (map(format_expression, shown(*line)) for line in form.where)
    lines += [f"  where {left} = {right}" for left, right in both]
    lines += [f"  where {line}" for law in form.laws for line in law_lines(*law)]
    lines += [f"  so {format_expression(left)} = {format_expression(e)}" for left, e in form.closed]
    return "\n".join(lines)


def shown(name: str, line: Expression) -> tuple[Expression, Expression]:
    """Return both sides of the line of a name as authors write it: ``beta^4 = value`` for a fourth root.

    Forms in which it occurs depend on the fourth power alone.
    """
    match line:
        case Call("sqrt", Call("sqrt", value)):
            return power(Name(name), 4), value
    return Name(name), line


def derive_text(
    entries: Iterable[tuple[AnyTransferFunction, PrintedForm]], width: int = WIDTH, *, is_named: bool = False
) -> str:
    """Return transfer functions as fractions, sums broken at ``width`` columns, and no definition twice."""
    above: dict[str, list[Expression]] = {}
    kinds = ((tf, form, f", {form.name} form" * is_named) for tf, form in entries)
    return "\n\n".join("\n".join(_fraction_lines(*kind, width, above)).rstrip() for kind in kinds)


def _fraction_lines(
    tf: AnyTransferFunction, form: PrintedForm, kind: str, width: int, above: dict[str, list[Expression]]
) -> list[str]:
    """Return the lines of one transfer function, and add its definitions to those ``above``."""
    from symflex.print.forms import with_hidden  # tables are printed without formulas

    quantity = tf.quantity + (f" [{tf.unit}]" if tf.unit else "")
    verdict = f"; {form.stability.headline}" if form.stability else ""
    lines = [f"{_left_side(tf, form)}   {quantity}{kind}{verdict}", ""]
    num, den = wrapped(form.num, width - 2), wrapped(form.den, width - 2)
    if is_number(form.den, 1):
        lines += [INDENT + line for line in num]
    else:
        bar = max(map(len, (*num, *den)))
        over, below = ([e[0].center(bar).rstrip()] if len(e) == 1 else e for e in (num, den))
        lines += [INDENT + line for line in (*over, "-" * bar, *below)]
    lines.append("")
    form, hidden = with_hidden(tf, form)
    repeated = _repeated(form, above)
    words = chain(["where"], repeat("     "))
    for line in wrap(", ".join(repeated) + " as above" if repeated else "", width - 2 * len(INDENT) - 4):
        lines.append(f"{INDENT}{next(words)} {line}")
    for (name, expression), word in zip(form.where, words, strict=False):
        if name not in repeated:
            left, right = shown(name, expression)
            lines += hanging(f"{INDENT}{word} {format_expression(left)} = ", right, width)
    laws = (line for law in form.laws if law[0] not in repeated for line in law_lines(*law))
    for line, word in zip(laws, words, strict=False):
        first, *more = _lay_out(line, width - len(word) - 3, hanging=len(INDENT))
        lines += [f"{INDENT}{word} {first}", *(" " * (len(word) + 3) + text for text in more)]
    own = [(left, e) for left, e in form.closed if format_expression(left) not in repeated]
    for word, (left, expression) in zip(chain(["so   "], repeat("     ")), own, strict=False):
        lines += hanging(f"{INDENT}{word} {format_expression(left)} = ", expression, width)
    if form.where or form.laws:
        lines.append("")
    for factor, multiplicity in hidden:
        times = f", {multiplicity} times" if multiplicity > 1 else ""
        lines += hanging(f"{INDENT}hidden: ", factor, width, f" cancelled{times}")
    if not tf.is_reduced:
        lines += [f"{INDENT}hidden modes: not examined in this representation", ""]
    elif hidden:
        lines.append("")
    for line in form.approximation.said if form.approximation else ():
        lines += wrap(line, width, initial_indent=INDENT, subsequent_indent=INDENT * 2)
    return lines


def _repeated(form: PrintedForm, above: dict[str, list[Expression]]) -> list[str]:
    """Return the names that mean what they mean above, as everything does that they are made of."""
    meant: dict[str, list[Expression]] = {}
    closed = ((format_expression(left), e) for left, e in form.closed)
    for name, expression in chain[tuple[str, Expression]](form.where, form.laws, closed):
        meant.setdefault(name, []).append(expression)
    new = {name for name, lines in meant.items() if above.get(name) != lines}
    while more := {n for n in meant.keys() - new if any(x.name in new for e in meant[n] for x in names(e))}:
        new |= more
    above |= meant
    return [name for name in meant if name not in new]


def _left_side(tf: AnyTransferFunction, form: PrintedForm) -> str:
    return f"{form.at(tf.output.name)}/{form.at(tf.input.name)}"


def hanging(head: str, expression: Expression, width: int, tail: str = "") -> list[str]:
    """Return an expression after some words and before others, its further lines below its first."""
    room = width - len(head)
    rows = wrapped(expression, room)
    if tail and len(rows[-1]) + len(tail) > room:
        rows.append("")
        tail = tail.lstrip()
    rows[-1] += tail
    return [head + rows[0], *(" " * len(head) + row for row in rows[1:])]


def law_lines(name: str, law: Equation) -> list[str]:
    """Return the differential equation of a function of x, and where it starts."""
    if isinstance(law.left, Derivative | Call):
        return [format_expression(law)]
    order = max(node.order for node in names(law) if isinstance(node, Derivative))
    zero = [f"{name}{chr(39) * k}(0) = " for k in range(order - 1)]
    start = f"{''.join(zero)}0, " if zero else ""
    return [format_expression(law), f"{start}{name}{chr(39) * (order - 1)}(0) = 1"]


def wrapped(expression: Expression, width: int) -> list[str]:
    """Return an expression as lines of ``width`` columns: sums break before signs, products after a times."""
    text = format_expression(expression)
    lines = _lay_out(text, width, hanging=len(INDENT))
    if "".join(lines).replace(" ", "") != text.replace(" ", ""):
        message = "a formula is not shown, as lines it was broken into are not what it is"
        raise InternalError(Diagnostic("SF992", message, None, REPORT))
    return lines


def _lay_out(text: str, width: int, hanging: int) -> list[str]:
    """Return ``text`` in lines; the terms of a broken sum are indented by ``hanging`` after the first."""
    if len(text) <= width or width < NARROWEST:
        return [text]
    terms = _split(text, _SIGNS)
    if len(terms) > 1:
        return _lay_out_sum(terms, width, hanging)
    factors = _split(text, _TIMES)
    if len(factors) > 1:
        return _lay_out_product(factors, width)
    if (group := _group(text)) is None:
        return [text]
    head, inner, tail = group
    first, *more = _lay_out(inner, width - len(head) - len(tail), hanging=0)
    lines = [head + first, *(" " * len(head) + line for line in more)]
    return [*lines[:-1], lines[-1] + tail]


def _group(text: str) -> tuple[str, str, str] | None:
    """Split a factor before and after what its parentheses hold."""
    begin, end = text.find("("), text.rfind(")")
    return None if begin < 0 else (text[: begin + 1], text[begin + 1 : end], text[end:])


def _lay_out_sum(terms: Sequence[str], width: int, hanging: int) -> list[str]:
    """Put every term on a line of its own, or fill the lines when all terms are simple."""
    simple = not any("(" in term for term in terms)
    lines = _lay_out(terms[0], width, hanging)
    for term in terms[1:]:
        if simple and len(lines[-1]) + 1 + len(term) <= width:
            lines[-1] += f" {term}"
            continue
        first, *more = _lay_out(term[2:], width - hanging - 2, hanging)
        margin = " " * hanging
        lines += [f"{margin}{term[:2]}{first}", *(f"{margin}  {line}" for line in more)]
    return lines


def _lay_out_product(factors: Sequence[str], width: int) -> list[str]:
    """Fill lines with factors; a sum too long for a line stands below its parenthesis, indented."""
    lines = [""]
    for factor in factors:
        column, room = len(lines[-1]), width - len(lines[-1])
        group = _group(factor)
        if len(factor) <= room:
            lines[-1] += factor
        elif column and (len(factor) <= width - 2 * len(INDENT) or group is None or len(group[0]) > room):
            lines += [2 * INDENT + line for line in _lay_out(factor, width - 2 * len(INDENT), hanging=0)]
        elif group is None or column + len(group[0]) <= SHALLOW:
            first, *more = _lay_out(factor, room, hanging=0)
            lines[-1] += first
            lines += [" " * column + line for line in more]
        else:
            head, inner, tail = group
            lines[-1] += head
            lines += [
                2 * INDENT + line for line in _lay_out(inner, width - 2 * len(INDENT) - len(tail), hanging=0)
            ]
            lines[-1] += tail
    return lines


def _split(text: str, breaks: Pattern[str]) -> list[str]:
    """Return the parts of a text between the places outside parentheses where it may break."""
    depth, start = 0, 0
    parts: list[str] = []
    for stop in breaks.finditer(text):
        i, found = stop.start(), stop[0]
        if not depth and i > start and stop.lastindex:
            parts.append(text[start:i].rstrip())
            start = i
        depth += 1 if found == "(" else -1 if found == ")" else 0
    return [*parts, text[start:]]


# Groups where a sum, or a product, may break; parentheses open and close what is not broken.
_SIGNS, _TIMES = compile_pattern(r"[()]|(?<= )([+\-])"), compile_pattern(r"(?<=\*)(.)|(/)|[()]")


class Passage(NamedTuple):
    """Lines, and a table below them: a paragraph of a command's output, in a terminal and on a page."""

    lines: Sequence[str]
    rows: Sequence[tuple[str, ...]] = ()
    has_head: bool = True  # the first row names the columns


def passages_text(passages: Iterable[Passage], width: int | None = None) -> str:
    """Return passages for a terminal, an empty line between two; their lines broken at ``width`` if given."""
    shown = []
    for passage in passages:
        lines = [part for line in passage.lines for part in (broken(line, width) if width else [line])]
        shown.append("\n".join([*lines, *(aligned(passage.rows) if passage.rows else ())]))
    return "\n\n".join(shown)


def broken(line: str, width: int = WIDTH) -> list[str]:
    """Return a line in several, those after the first further in."""
    indent = line[: len(line) - len(line.lstrip())]
    further = indent + INDENT
    return wrap(
        line.lstrip(), width, initial_indent=indent, subsequent_indent=further, break_on_hyphens=False
    )


def aligned(rows: Sequence[tuple[str, ...]], indent: str = 2 * INDENT) -> list[str]:
    """Return the rows of a table, numbers under each other; a column without a text takes no room."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        indent + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True) if w).rstrip() for row in rows
    ]
