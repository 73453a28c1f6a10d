"""Plain text for a terminal: transfer functions, poles and zeros."""

from __future__ import annotations

from itertools import chain, repeat
from re import compile as compile_pattern
from textwrap import wrap
from typing import TYPE_CHECKING, Final

from symflex.expressions import (
    Derivative,
    Equation,
    Expression,
    Quotient,
    format_expression,
    is_number,
    names,
)
from symflex.print.forms import PrintedForm, with_hidden
from symflex.print.roots import one_of_each_pair
from symflex.transfer import NestedTransferFunction

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.roots import PoleZeroMap, Region, Root
    from symflex.roots.root import RootDecimals
    from symflex.transfer import AnyTransferFunction

Row = tuple[str, ...]

WIDTH = 80
INDENT = "  "
NARROWEST = 12
"""Columns below which breaking a line further would not help to read it."""
CAUSES = {
    "cancelled": "cancelled between numerator and denominator",
    "coincident": "poles and zeros that agree in all digits",
}
SHALLOW = 8
"""Columns up to which a broken sum stands to the right of its parenthesis."""


def form_text(tf: AnyTransferFunction, form: PrintedForm) -> str:
    """Return ``OUT/IN = num/den`` on one line, and a line per definition or law used."""
    whole = form.num if is_number(form.den, 1) else Quotient(form.num, form.den)
    lines = [f"{_left_side(tf, form)} = {format_expression(whole)}"]
    lines += [f"  {form.stability.headline}"] if form.stability else []
    lines += [f"  where {name} = {format_expression(e)}" for name, e in form.where]
    lines += [f"  where {line}" for law in form.laws for line in law_lines(*law)]
    return "\n".join(lines)


def derive_text(tf: AnyTransferFunction, form: PrintedForm, width: int = WIDTH) -> str:
    """Return a transfer function as a fraction, with its definitions and hidden modes.

    Sums longer than ``width`` columns are broken before plus and minus.
    """
    quantity = tf.quantity + (f" [{tf.unit}]" if tf.unit else "")
    verdict = f"; {form.stability.headline}" if form.stability else ""
    lines = [f"{_left_side(tf, form)}   {quantity}, {form.name} form{verdict}", ""]
    num, den = wrapped(form.num, width - 2), wrapped(form.den, width - 2)
    if is_number(form.den, 1):
        lines += [INDENT + line for line in num]
    else:
        bar = max(len(line) for line in (*num, *den))
        lines += [INDENT + _placed(line, bar, alone=len(num) == 1) for line in num]
        lines.append(INDENT + "-" * bar)
        lines += [INDENT + _placed(line, bar, alone=len(den) == 1) for line in den]
    lines.append("")
    form, hidden = with_hidden(tf, form)
    for word, (name, expression) in zip(chain(["where"], repeat("     ")), form.where, strict=False):
        lines += hanging(f"{INDENT}{word} {name} = ", expression, width)
    for line in (line for law in form.laws for line in law_lines(*law)):
        word = "     " if form.where or lines[-1].startswith(f"{INDENT}where") else "where"
        first, *more = _lay_out(line, width - len(word) - 3, hanging=len(INDENT))
        lines += [f"{INDENT}{word} {first}", *(" " * (len(word) + 3) + text for text in more)]
    if form.where or form.laws:
        lines.append("")
    for factor, multiplicity in hidden:
        times = f", {multiplicity} times" if multiplicity > 1 else ""
        lines += hanging(f"{INDENT}hidden: ", factor, width, f" cancelled{times}")
    if isinstance(tf, NestedTransferFunction):
        lines += [f"{INDENT}hidden modes: not examined in this representation", ""]
    elif tf.hidden:
        lines.append("")
    return "\n".join(lines)


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
    order = max(node.order for node in names(law) if isinstance(node, Derivative))
    zero = [f"{name}{chr(39) * k}(0) = " for k in range(order - 1)]
    start = f"{''.join(zero)}0, " if zero else ""
    return [format_expression(law), f"{start}{name}{chr(39) * (order - 1)}(0) = 1"]


def _placed(line: str, width: int, *, alone: bool) -> str:
    return line.center(width).rstrip() if alone else line


def wrapped(expression: Expression, width: int) -> list[str]:
    """Return an expression as lines of at most ``width`` columns where it can be broken.

    Sums break before a sign, products after a times, outermost first; what stands in parentheses is broken
    only when it does not fit, and then stands to the right of its parenthesis or below it.
    """
    return _lay_out(format_expression(expression), width, hanging=len(INDENT))


def _lay_out(text: str, width: int, hanging: int) -> list[str]:
    """Return ``text`` in lines; the terms of a broken sum are indented by ``hanging`` after the first."""
    if len(text) <= width or width < NARROWEST:
        return [text]
    terms = _split(text, lambda i: text[i] in "+-" and text[i - 1] == " ")
    if len(terms) > 1:
        return _lay_out_sum(terms, width, hanging)
    factors = _split(text, lambda i: text[i - 1] == "*" or text[i] == "/")
    if len(factors) > 1:
        return _lay_out_product(factors, width)
    group = _group(text)
    if group is None:
        return [text]
    head, inner, tail = group
    lines = _lay_out(inner, width - len(head) - len(tail), hanging=0)
    lines[-1] += tail
    return [head + lines[0], *(" " * len(head) + line for line in lines[1:])]


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
        sign, rest = term[:2], term[2:]
        first, *more = _lay_out(rest, width - hanging - len(sign), hanging)
        margin = " " * hanging
        lines += [margin + sign + first, *(f"{margin}{' ' * len(sign)}{line}" for line in more)]
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
            within = _lay_out(inner, width - 2 * len(INDENT) - len(tail), hanging=0)
            lines += [2 * INDENT + line for line in within]
            lines[-1] += tail
    return lines


def _split(text: str, breaks: Callable[[int], bool]) -> list[str]:
    """Return the parts of a text between the places outside parentheses where it may break."""
    depth, start = 0, 0
    parts: list[str] = []
    for found in _STOPS.finditer(text):
        i = found.start()
        if not depth and i > start and breaks(i):
            parts.append(text[start:i].rstrip())
            start = i
        depth += {"(": 1, ")": -1}.get(text[i], 0)
    return [*parts, text[start:]]


_STOPS = compile_pattern(r"[()+\-/]|(?<=\*).")
"""Where a text may break, and what opens and closes a group."""


def roots_text(found: PoleZeroMap, digits: int, width: int = WIDTH) -> str:
    """Return poles and zeros as tables, with the certificate.

    Where a line per root is longer than ``width`` columns, the imaginary part stands below the real part.
    """
    certificate = found.certificate
    status = "certified" if certificate.certified else f"NOT CERTIFIED: {certificate.reason}"
    word = found.verdict.brief
    lines = [f"{found.tf}   {status}: {certificate.found} of {certificate.counted} roots enclosed; {word}"]
    if found.verdict.sentence != word:
        lines += wrap(found.verdict.sentence, width, initial_indent=INDENT, subsequent_indent=2 * INDENT)
    if shown := region_text(found.region):
        if found.verdict.word == "unstable" and not found.unstable:
            shown += "; poles in the right half plane, all that are known"
        lines += wrap(f"shown: {shown}", width, initial_indent=INDENT, subsequent_indent=2 * INDENT)
    if found.is_default_region:
        lines.append(f"{INDENT}by default: a distributed system has infinitely many poles")
    for part in found.excluded:
        im = f" +- {part.im:g} j" if part.im else ""
        where = f"{part.radius:.3g} rad/s about {part.re:g}{im}"
        lines.append(f"{INDENT}left out: {where}, where roots accumulate")
    for title, roots in (("poles", found.poles), ("zeros", found.zeros)):
        lines += ["", _counted(title, roots), *_root_table(roots, digits, width)]
    if found.unstable:
        title = f"{_counted('poles', found.unstable)}, in the right half plane, outside of what was asked for"
        lines += ["", title, *_root_table(found.unstable, digits, width)]
    if found.hidden:
        for cause, meaning in CAUSES.items():
            hidden = [h.root for h in found.hidden if h.cause == cause]
            if hidden:
                lines += ["", f"{_counted('hidden', hidden)}, {meaning}", *_root_table(hidden, digits, width)]
    everything = [*found.poles, *found.zeros, *found.unstable, *(h.root for h in found.hidden)]
    if everything:
        lines += ["", "  radius bounds the distance from the printed value to the root [rad/s]"]
    if any(root.on_boundary for root in everything):
        lines.append("  | marks a root on the boundary of what was asked for")
    if not all(root.certified for root in everything):
        lines.append("  ? marks roots that could not be told apart, enclosed as one")
    return "\n".join(lines)


def region_text(region: Region) -> str:
    """Say what was asked for, nothing when it was everything."""
    from symflex.roots import Band, Mode, Modes, Rectangle  # imports numpy

    match region:
        case Modes(count):
            modes = "mode" if count == 1 else f"{count} modes"
            return f"the {modes} of lowest natural frequency, and roots at 0"
        case Mode(number):
            return f"mode number {number}, by natural frequency"
        case Band(low, high):
            return f"natural frequencies from {float(low):g} to {float(high):g} Hz"
        case Rectangle(re_low, re_high, im_low, im_high):
            re = f"Re from {float(re_low):g} to {float(re_high):g}"
            return f"{re}, Im from {float(im_low):g} to {float(im_high):g} rad/s"
        case _:
            return ""


def _counted(title: str, roots: Sequence[Root]) -> str:
    """Return a heading with the number of roots, multiplicity counted."""
    return f"{INDENT}{title}: {sum(root.multiplicity for root in roots) or 'none'}"


def _zeta(root: Root, printed: RootDecimals) -> str:
    zeta = root.damping_ratio()
    return "" if zeta is None else "~0" if printed.re.startswith("0e") else f"{zeta:.6g}"


_ABOUT: Final[tuple[tuple[str, Callable[[Root, RootDecimals], str]], ...]] = (
    ("radius", lambda root, printed: printed.radius),
    ("f [Hz]", lambda root, printed: f"{root.frequency_hz():.6g}"),
    ("zeta", _zeta),
)
"""Columns after real and imaginary part."""


def _root_table(roots: Sequence[Root], digits: int, width: int) -> list[str]:
    """Return a line per real root or conjugate pair, or two where one is too long."""
    if not roots:
        return []
    rows: list[Row] = _root_rows(roots, digits)
    heads = [head for head, _ in _ABOUT]
    lines = aligned([("", "Re [rad/s]", "Im [rad/s]", *heads), *rows])
    if max(map(len, lines)) <= width:
        return lines
    stacked: list[Row] = [("", "Re, Im [rad/s]", *heads)]
    for flags, re, im, *rest in rows:
        stacked.append((flags, f"{re}  ", *rest))
        if im != "0":
            stacked.append(("", f"{im} j", *("" for _ in rest)))
    lines = aligned(stacked)
    if max(map(len, lines)) <= width:
        return lines
    return [line for row in rows for line in _root_paragraph(row)][:-1]


def _root_rows(roots: Sequence[Root], digits: int) -> list[Row]:
    """Return flags, real and imaginary part and what stands beside them; a conjugate pair is one row."""
    rows: list[Row] = []
    for entry in one_of_each_pair(roots):
        root, printed = entry.root, entry.root.decimal(digits)
        times = f"x{root.multiplicity}" if root.multiplicity > 1 else ""
        flags = times + ("" if root.certified else "?") + ("|" if root.on_boundary else "")
        im = f"+-{printed.im}" if entry.is_pair else printed.im
        rows.append((flags, printed.re, im, *(text(root, printed) for _, text in _ABOUT)))
    return rows


def _root_paragraph(row: Row) -> list[str]:
    """Return a root whose digits fill lines of their own."""
    flags, re, im, *rest = row
    about = []
    for (head, _), cell in zip(_ABOUT, rest, strict=True):
        name, _, unit = head.removesuffix("]").partition(" [")
        about.append(f"{name} {cell} {unit}".rstrip() if cell else "")
    lines = (f"Re {re}", f"Im {im}", ", ".join(filter(None, (*about, flags))))
    return [*(2 * INDENT + line for line in lines), ""]


def aligned(rows: Sequence[Row], indent: str = 2 * INDENT) -> list[str]:
    """Return the rows of a table, numbers under each other; a column without a text takes no room."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return [
        indent + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True) if w).rstrip() for row in rows
    ]
