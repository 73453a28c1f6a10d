"""A transfer function as rows of MathML: the quotient, what its names stand for, and its ``where`` lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.expressions import Call, Derivative, Name, is_number, names, number
from symflex.print.latex.equation import form_labels, free_names, split_sign, varying_names
from symflex.print.mathml.element import identifier, label_mathml, operator, row
from symflex.print.mathml.expression import MathmlWriter
from symflex.print.writer import Style

if TYPE_CHECKING:
    from symflex.expressions import Expression
    from symflex.model import Input, Output
    from symflex.print.forms import PrintedForm
    from symflex.transfer import TransferFunction

WIDEST_FRACTION: Final = 42.0
"""Width [em] beyond which numerator and denominator get names and rows of their own."""

LONGEST: Final = 400_000
"""Characters beyond which a page does not show a formula."""

_LETTERS: Final = {r"\mathcal{N}": "𝒩", r"\mathcal{D}": "𝒟"}
_ARGUMENT_OF_S: Final = (
    '<mo form="prefix" stretchy="false">(</mo><mi>s</mi><mo form="postfix" stretchy="false">)</mo>'
)


@dataclass(frozen=True, slots=True)
class MathRow:
    """One equation: its left side, and its right side in pieces between which a line may end."""

    left: str  # MathML
    pieces: tuple[str, ...]  # MathML, to be shown one after the other
    is_where: bool = False  # it says what a name stands for


def ratio_mathml(tf: TransferFunction) -> str:
    """Return output over input, one above the other."""
    return f"<mfrac>{_end(tf.output)}{_end(tf.input)}</mfrac>"


def transfer_function_mathml(tf: TransferFunction, form: PrintedForm) -> tuple[MathRow, ...] | None:
    """Return a transfer function as equations below each other.

    The quotient is one row where it is at most :data:`WIDEST_FRACTION` wide, else it has names for what is
    wide and their rows below it; then come the ``where`` rows. None when all of it would be longer than
    :data:`LONGEST` characters.
    """
    labels = form_labels(tf, form)
    writer = MathmlWriter(labels)
    rows = [*_formula(tf, form, writer, labels), *_where(form, writer, labels)]
    size = sum(len(r.left) + sum(map(len, r.pieces)) for r in rows)
    return tuple(rows) if size <= LONGEST else None


def _end(end: Input | Output) -> str:
    label = label_mathml(end.name, {end.name: end.latex})
    return row(label, "<mo>&#x2061;</mo>", f"<mrow>{_ARGUMENT_OF_S}</mrow>")


def _formula(
    tf: TransferFunction, form: PrintedForm, writer: MathmlWriter, labels: dict[str, str]
) -> list[MathRow]:
    left = ratio_mathml(tf)
    if is_number(form.den, 1):
        return [MathRow(left, writer.pieces(form.num))]
    sign, num = split_sign(form)
    minus = operator("-", "prefix") if sign else ""
    widths = [writer.width(part, Style.TEXT) for part in (num, form.den)]
    if max(widths) <= WIDEST_FRACTION:
        above, below = (writer.piece(part, Style.TEXT).markup for part in (num, form.den))
        return [MathRow(left, (row(*filter(None, (minus, f"<mfrac>{above}{below}</mfrac>"))),))]
    varying = varying_names(form)
    parts, rows = [], []
    for name, expression, width in zip(free_names(form, writer), (num, form.den), widths, strict=True):
        if width <= WIDEST_FRACTION / 2:
            parts.append(writer.piece(expression, Style.TEXT).markup)
            continue
        depends = any(n.name in varying for n in names(expression) if isinstance(n, Name | Call))
        head = identifier(_LETTERS.get(name, name))
        head = row(head, "<mo>&#x2061;</mo>", f"<mrow>{_ARGUMENT_OF_S}</mrow>") if depends else head
        parts.append(head)
        rows.append(MathRow(head, writer.pieces(expression)))
    fraction = f"<mfrac>{parts[0]}{parts[1]}</mfrac>"
    return [MathRow(left, (row(*filter(None, (minus, fraction))),)), *rows]


def _where(form: PrintedForm, writer: MathmlWriter, labels: dict[str, str]) -> list[MathRow]:
    rows = [MathRow(label_mathml(name, labels), writer.pieces(e), is_where=True) for name, e in form.where]
    for name, law in form.laws:
        order = max(node.order for node in names(law) if isinstance(node, Derivative))
        rows.append(_equation(law.left, law.right, writer))
        rows += [
            _equation(Call(name, number(0), k), number(int(k == order - 1)), writer) for k in range(order)
        ]
    return rows


def _equation(left: Expression, right: Expression, writer: MathmlWriter) -> MathRow:
    return MathRow(writer.piece(left).markup, writer.pieces(right), is_where=True)
