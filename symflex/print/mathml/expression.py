r"""Expressions as MathML, whole or in pieces between which a page may break a line.

The notation of :mod:`symflex.print.writer` for pages. Invisible operators stand where none is seen, so that a
screen reader speaks products as products.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.expressions import Expression, Negative, Power, Product, Quotient, Sum
from symflex.print.latex.expression import Writer
from symflex.print.mathml.element import (
    APPLY_FUNCTION,
    INVISIBLE_TIMES,
    SPACED_TIMES,
    fence,
    fence_signs,
    identifier,
    label_mathml,
    numeral,
    operator,
    row,
)
from symflex.print.width import NOTHING, Width
from symflex.print.writer import (
    MOST_PRIMES,
    ExpressionWriter,
    Shape,
    Spelling,
    Style,
    Written,
    is_half,
    numbers_first,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

PIECE_EM: Final = 17.0
"""Width up to which a piece is not broken [em]: that of a narrow telephone's screen."""

_MINUS: Final = operator("-", "prefix")


def mathml_expression(expression: Expression, labels: Mapping[str, str]) -> str:
    """Return an expression as MathML, without the ``math`` element around it.

    Labels are declared ones in LaTeX; other names get theirs from their letters. Raises TypeError for an
    equation or a quantity of an element, which no transfer function holds.

    Examples
    --------
    >>> from symflex.expressions import Name, number, power, product_of, sum_of
    >>> mathml_expression(sum_of([power(Name("s"), 2), Name("k")]), {})
    '<mrow><msup><mi>s</mi><mn>2</mn></msup><mo>+</mo><mi>k</mi></mrow>'
    >>> mathml_expression(product_of([number(2), Name("b")]), {})
    '<mrow><mn>2</mn><mo>&#x2062;</mo><mi>b</mi></mrow>'
    """
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
        """Return an expression as pieces that follow each other, with a line's end allowed between them.

        Sums are parted before their signs, then products between factors, then parentheses inside.

        What is not wider than ``width`` [em] stays whole, and so does what has no place to be parted.
        """
        found: list[str] = []
        # A sign or parenthesis beside a node stays with its first or last piece.
        pending: list[tuple[str, Expression, str]] = [("", expression, "")]
        while pending:
            before, node, after = pending.pop()
            parts = self._parts(node) if self.width(node) > width else None
            if parts is None:
                found.append(f"{before}{self.piece(node).markup}{after}")
                continue
            parts[0] = (before + parts[0][0], *parts[0][1:])
            parts[-1] = (*parts[-1][:2], parts[-1][2] + after)
            pending.extend(reversed(parts))
        return tuple(found)

    def _parts(self, node: Expression) -> list[tuple[str, Expression, str]] | None:
        """Return the parts of a node, each with what stands before and after it; None of what has none."""
        match node:
            case Sum(terms=terms):
                parts = []
                for i, term in enumerate(terms):
                    is_negative = isinstance(term, Negative)
                    inner = term.operand if isinstance(term, Negative) else term
                    sign = operator("-" if is_negative else "+", "infix" if i else "prefix")
                    parts.append(self._fenced_part(sign if i or is_negative else "", inner, Sum, Negative))
                return parts
            case Product(factors=factors):
                parts = []
                for i, factor in enumerate(numbers_first(factors)):
                    parts.append(self._fenced_part(INVISIBLE_TIMES if i else "", factor, Sum, Negative))
                return _joined(parts, self)
            case Negative(operand=operand):
                return [self._fenced_part(operator("-", "prefix"), operand, Sum, Negative)]
            case Quotient(numerator=above, denominator=below):
                return [
                    self._fenced_part("", above, Sum, Negative),
                    self._fenced_part(operator("/"), below, Sum, Negative, Product, Quotient),
                ]
            case Power(base=Sum() as base, exponent=exponent) if not is_half(exponent):
                opening, closing = fence_signs(self.piece(base).nesting)
                raised = self.exponent(exponent).markup
                return [(opening, base, f"<msup>{closing}{raised}</msup>")]
            case _:
                return None

    def _fenced_part(
        self, before: str, node: Expression, *loose: type[Expression]
    ) -> tuple[str, Expression, str]:
        if not isinstance(node, loose):
            return before, node, ""
        opening, closing = fence_signs(self.piece(node).nesting)
        return before + opening, node, closing


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


def _primed(name: str, order: int) -> str:
    counted = row(operator("("), numeral(str(order)), operator(")"))
    return MATHML.power.format(name, operator("′" * order) if order <= MOST_PRIMES else counted)


def _scientific(mantissa: str, exponent: str) -> str:
    power = numeral(exponent.removeprefix("-"))
    power = row(_MINUS, power) if exponent.startswith("-") else power
    return row(numeral(mantissa), operator("⋅"), MATHML.power.format(numeral("10"), power))


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
    if right.markup.startswith("<mn>"):
        return operator("⋅"), NOTHING
    wordy = (p.is_wordy and p.shape is not Shape.POWER for p in (left, right))
    is_worded = Shape.CALL in (left.shape, right.shape) or any(wordy)
    return SPACED_TIMES if is_worded else INVISIBLE_TIMES, NOTHING


MATHML: Final = Spelling(
    fraction="<mfrac>{}{}</mfrac>",
    slash=row("{}", operator("/"), "{}"),
    power="<msup>{}{}</msup>",
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
    function_power=lambda head, call, exponent: call.replace(head, f"<msup>{head}{exponent}</msup>", 1),
)
