"""Expressions and transfer functions as MathML, whole or in pieces between which a page may break a line.

    k/(m*s)     <mfrac><mi>k</mi><mrow><mi>m</mi><mo>&#x2062;</mo><mi>s</mi></mrow></mfrac>

The notation of :mod:`symflex.print.writer` for pages. The markup is that of MathML Core (W3C 2024): no
attribute that browsers dropped, ``mathvariant`` only as ``normal``. Other alphabets are classes (``it``,
``bf``, ``sf``, ``tt``), which a page's style sheet sets. Invisible operators stand where none is seen, so
that a screen reader speaks products as products.

Labels of names are those that print in LaTeX, as :mod:`symflex.print.label` reads them. A transfer function
is rows: the quotient, what its names stand for, and its ``where`` lines.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import starmap
from typing import Final

from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
    is_number,
    names,
)
from symflex.model import Input, Output
from symflex.print.forms import PrintedForm
from symflex.print.label import LABEL_SIGNS, identifier, numeral, operator, row, symbol, with_scripts, words
from symflex.print.latex.equation import form_labels, free_names, laws_and_starts, split_sign, varying_names
from symflex.print.latex.expression import Writer
from symflex.print.text import shown
from symflex.print.width import NOTHING, Width
from symflex.print.writer import (
    MOST_PRIMES,
    ExpressionWriter,
    Shape,
    Spelling,
    Style,
    Written,
    is_half,
    parts_of,
)
from symflex.transfer import AnyTransferFunction

INVISIBLE_TIMES: Final = "<mo>&#x2062;</mo>"
SPACED_TIMES: Final = '<mo lspace="0.17em" rspace="0">&#x2062;</mo>'
DOT: Final = '<mo lspace="0" rspace="0.25em">⋅</mo>'  # after the blank at which a line may end
APPLY_FUNCTION: Final = "<mo>&#x2061;</mo>"
EQUALS: Final = '<mo rspace="0">=</mo>'  # a blank follows, at which the line may end


def fence(content: str, nesting: int, is_tall: bool) -> str:
    """Return content in parentheses, or in brackets or braces around those."""
    opening, closing = fence_signs(nesting, is_tall=is_tall)
    return f"<mrow>{opening}{content}{closing}</mrow>"


def fence_signs(nesting: int, *, is_tall: bool = False) -> tuple[str, str]:
    """Return an opening and a closing sign; they grow only around what is tall."""
    left, right = ("()", "[]", "{}")[nesting % 3]
    stretchy = "" if is_tall else ' stretchy="false"'
    return f'<mo form="prefix"{stretchy}>{left}</mo>', f'<mo form="postfix"{stretchy}>{right}</mo>'


def math_element(content: str, *, is_display: bool = False) -> str:
    """Return mathematics as an element of a page."""
    attribute = ' displaystyle="true"' if is_display else ""
    return f"<math{attribute}>{content}</math>"


def label_mathml(name: str, labels: Mapping[str, str]) -> str:
    """Return the label of a name, declared or made."""
    return symbol(name, labels).mathml or words(name, "tt")


def page_signs() -> str:
    """Return every sign that formulas on a page can need, for a font that has them all."""
    ascii_signs = map(chr, range(0x20, 0x7F))
    # The italic h is older than its alphabet, where Unicode left a gap.
    italic = {*map(chr, range(0x1D434, 0x1D468)), "ℎ"} - {"\U0001d455"}
    italic_greek = map(chr, range(0x1D6E2, 0x1D71C))
    named = (*LABEL_SIGNS, *_CALLIGRAPHIC.values())
    return "".join(sorted({*ascii_signs, *italic, *italic_greek, *named, *"−⋅√′″‴\u2061\u2062"}))


PIECE_EM: Final = 17.0  # width up to which a piece is not broken [em]: that of a narrow telephone's screen
_INDEXED: Final = re.compile(r"<msub>(?:<mpadded[^>]*>)?(<mi[^<]*</mi>)(?:</mpadded>)?(.*)</msub>")
_MINUS: Final = operator("-", "prefix")


def mathml_expression(expression: Expression, labels: Mapping[str, str]) -> str:
    """Return an expression as MathML without the ``math`` element; names without a label get one."""
    return MathmlWriter(labels).piece(expression).markup


class MathmlWriter(ExpressionWriter):
    """Writes expressions as MathML with one set of labels."""

    def __init__(self, labels: Mapping[str, str]) -> None:
        super().__init__(labels, MATHML)
        self._widths = Writer(labels)

    def width(self, expression: Expression, style: Style = Style.DISPLAY) -> float:
        """Return about how wide an expression is [em]; type for LaTeX is about as wide."""
        return self._widths.piece(expression, style).width

    def pieces(self, expression: Expression, width: float = PIECE_EM) -> tuple[str, ...]:
        """Return an expression as pieces between which a line may end, whole where it fits ``width`` [em]."""
        markups: list[str] = []
        # A sign or parenthesis beside a node stays with its first or last piece.
        pending: list[tuple[str, Expression, str]] = [("", expression, "")]
        while pending:
            before, node, after = pending.pop()
            parts = self._parts(node) if self.width(node) > width else None
            if parts is None:
                markups.append(f"{before}{self.piece(node).markup}{after}")
                continue
            parts[0] = (before + parts[0][0], *parts[0][1:])
            parts[-1] = (*parts[-1][:2], parts[-1][2] + after)
            pending.extend(reversed(parts))
        return tuple(markups)

    def _parts(self, node: Expression) -> list[tuple[str, Expression, str]] | None:
        """Return the parts of a node, each with what stands before and after it; None of what has none."""
        if isinstance(node, Power) and isinstance(node.base, Sum) and not is_half(node.exponent):
            opening, closing = fence_signs(self.piece(node.base).nesting)
            return [(opening, node.base, f"<msup>{closing}{self.exponent(node.exponent).markup}</msup>")]
        parts = []
        for i, (sign, part) in enumerate(parts_of(node)):
            spelt = operator(sign, "" if sign == "/" else "infix" if i else "prefix") if sign else ""
            looser = (Product, Quotient) if sign == "/" else ()
            spelt = DOT if sign == "*" else spelt
            fences = ("", "")
            if isinstance(part, (Sum, Negative, *looser)):
                fences = fence_signs(self.piece(part).nesting)
            parts.append((spelt + fences[0], part, fences[1]))
        return _joined(parts, self) if isinstance(node, Product) else parts or None


def _joined(
    parts: list[tuple[str, Expression, str]], writer: MathmlWriter
) -> list[tuple[str, Expression, str]] | None:
    """Return the factors with neighbours that are short together as one; None when none is left to part."""
    joined: list[tuple[str, Expression, str]] = []
    for before, node, after in parts:
        if joined and not after and not joined[-1][2]:
            head, left, _ = joined[-1]
            factors = left.factors if isinstance(left, Product) else (left,)
            both = Product((*factors, node))
            if writer.width(both) <= PIECE_EM:
                joined[-1] = (head, both, "")
                continue
        joined.append((before, node, after))
    return joined if len(joined) > 1 or joined[0][2] else None


def _power(base: str, exponent: str) -> str:
    """Return a power; the exponent of what has an index stands above the index."""
    letter, index = found.groups() if (found := _INDEXED.fullmatch(base)) else (base, "")
    return with_scripts(letter, index, exponent)


def _primed(name: str, order: int) -> str:
    if order <= MOST_PRIMES:
        return row(name, operator("′″‴"[order - 1]))  # high enough in fonts: not raised
    return _power(name, row(operator("("), numeral(str(order)), operator(")")))


def _scientific(mantissa: str, exponent: str) -> str:
    minus = [_MINUS] if exponent.startswith("-") else []
    power = row(*minus, numeral(exponent.removeprefix("-")))
    front = [numeral(mantissa), operator("⋅")] if mantissa else []
    return row(*front, _power(numeral("10"), power))


def _sum(terms: Sequence[tuple[str, bool]]) -> str:
    parts: list[str] = []
    for i, (term, is_negative) in enumerate(terms):
        if i or is_negative:
            parts.append(operator("-" if is_negative else "+", "" if i else "prefix"))
        bare = term.removeprefix("<mrow>").removesuffix("</mrow>").removeprefix(_MINUS)
        parts.append(bare if is_negative else term)
    return row(*parts)


def _between(left: Written, right: Written) -> tuple[str, Width]:
    # Two numbers would read as one, a name and a function's name too. The width is not asked for.
    if right.markup.removeprefix("<msup>").startswith("<mn>"):
        return operator("⋅"), NOTHING
    is_worded = Shape.CALL in (left.shape, right.shape) or left.is_wordy or right.is_wordy
    return SPACED_TIMES if is_worded else INVISIBLE_TIMES, NOTHING


MATHML: Final = Spelling(
    fraction="<mfrac>{}{}</mfrac>",
    slash=row("{}", operator("/"), "{}"),
    power=_power,
    applied=row("{}", APPLY_FUNCTION, "{}"),
    digits=numeral("{}"),
    negative=row(_MINUS, "{}"),
    root="<msqrt>{}</msqrt>",
    exponential=f"<msup>{identifier('e', 'rm')}{{}}</msup>",
    name=label_mathml,
    function=identifier,
    primed=_primed,
    scientific=_scientific,
    fenced=fence,
    sum=_sum,
    product=lambda parts: row(*parts),
    between=_between,
    function_power=lambda head, call, exponent: call.replace(head, with_scripts(head, "", exponent), 1),
)


WIDEST_FRACTION: Final = 42.0  # width [em] beyond which numerator and denominator get names and rows
LONGEST: Final = 400_000  # characters beyond which a page does not show a formula
_CALLIGRAPHIC: Final = {r"\mathcal{N}": "𝒩", r"\mathcal{D}": "𝒟"}
_OF_S: Final = (APPLY_FUNCTION, fence("<mi>s</mi>", 0, is_tall=False))


def of_s(head: str) -> str:
    """Return what is a function of s, with its argument."""
    return row(head, *_OF_S)


def table_mathml(cells: Sequence[Sequence[str]]) -> str:
    """Return a matrix in parentheses."""
    lines = (f"<mtr>{''.join(f'<mtd>{cell}</mtd>' for cell in line)}</mtr>" for line in cells)
    return fence(f"<mtable>{''.join(lines)}</mtable>", 0, is_tall=True)


@dataclass(frozen=True, slots=True)
class MathRow:
    """One equation: its left side, and its right side in pieces between which a line may end."""

    left: str  # MathML
    pieces: tuple[str, ...]  # MathML, to be shown one after the other
    is_where: bool = False  # it says what a name stands for

    @property
    def elements(self) -> str:
        """The equation as elements of a page, with blanks where a line may end."""
        sides = (f"{self.left}{EQUALS}", *self.pieces)
        return " ".join(math_element(f"<mrow>{side}</mrow>", is_display=True) for side in sides)


def ratio_mathml(tf: AnyTransferFunction) -> str:
    """Return output over input, one above the other."""
    return f"<mfrac>{_end(tf.output)}{_end(tf.input)}</mfrac>"


def transfer_function_mathml(tf: AnyTransferFunction, form: PrintedForm) -> tuple[MathRow, ...] | None:
    """Return a transfer function as equations below each other, None beyond :data:`LONGEST` characters.

    The quotient is one row, or has names for what is wide; then come the ``where`` rows.
    """
    labels = form_labels(tf, form)
    writer = MathmlWriter(labels)
    rows = _formula(tf, form, writer)
    both = [*starmap(shown, form.where), *laws_and_starts(form)]
    below = [(writer.piece(left).markup, right) for left, right in both]
    rows += [MathRow(left, writer.pieces(right), is_where=True) for left, right in below]
    size = sum(len(r.left) + sum(map(len, r.pieces)) for r in rows)
    return tuple(rows) if size <= LONGEST else None


def _end(end: Input | Output) -> str:
    return of_s(label_mathml(end.name, {end.name: end.latex}))


def _formula(tf: AnyTransferFunction, form: PrintedForm, writer: MathmlWriter) -> list[MathRow]:
    left = ratio_mathml(tf)
    if is_number(form.den, 1):
        return [MathRow(left, writer.pieces(form.num))]
    sign, num = split_sign(form)
    widths = [writer.width(part, Style.TEXT) for part in (num, form.den)]
    widest = WIDEST_FRACTION if max(widths) <= WIDEST_FRACTION else WIDEST_FRACTION / 2
    varying = varying_names(form)
    parts, rows = [], []
    for name, expression, width in zip(free_names(form, writer), (num, form.den), widths, strict=True):
        if width <= widest:
            parts.append(writer.piece(expression, Style.TEXT).markup)
            continue
        depends = any(n.name in varying for n in names(expression) if isinstance(n, Name | Call))
        head = row(identifier(_CALLIGRAPHIC.get(name, name)), *(_OF_S if depends else ()))
        parts.append(head)
        rows.append(MathRow(head, writer.pieces(expression)))
    minus = [_MINUS] if sign else []
    return [MathRow(left, (row(*minus, f"<mfrac>{parts[0]}{parts[1]}</mfrac>"),)), *rows]
