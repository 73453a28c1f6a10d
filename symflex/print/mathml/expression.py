r"""Expressions as MathML, whole or in pieces between which a page may break a line.

The layout is that of :mod:`symflex.print.latex.expression`: quotients are fractions, one level of fractions
within fractions, slashes below that and in exponents. Invisible operators stand where none is seen, so that
a screen reader speaks products as products.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Final, NamedTuple

from symflex.algebra.functions import FUNCTIONS
from symflex.expressions import (
    Call,
    Derivative,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
)
from symflex.expressions.format import number_text
from symflex.print.latex.expression import (
    TRIGONOMETRIC,
    Shape,
    Style,
    Writer,
    inner_styles,
    is_half,
    is_short,
    numbers_first,
)
from symflex.print.mathml.element import (
    APPLY_FUNCTION,
    INVISIBLE_TIMES,
    SPACED_TIMES,
    fence,
    fence_signs,
    identifier,
    numeral,
    operator,
    row,
)
from symflex.print.mathml.label import label_mathml

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

PIECE_EM: Final = 17.0
"""Width up to which a piece is not broken [em]: that of a narrow telephone's screen."""

_MOST_PRIMES: Final = 3


class Markup(NamedTuple):
    """A printed subtree and what its surroundings must know."""

    mathml: str
    shape: Shape
    is_tall: bool = False
    nesting: int = 0
    has_superscript: bool = False
    is_wordy: bool = False


def mathml_expression(expression: Expression, labels: Mapping[str, str]) -> str:
    """Return an expression as MathML, without the ``math`` element around it.

    Parameters
    ----------
    expression : Expression
        Any width and depth.
    labels : Mapping of str to str
        Declared labels in LaTeX; other names get theirs from their letters.

    Raises
    ------
    TypeError
        For an equation or a quantity of an element, which no transfer function holds.

    Examples
    --------
    >>> from symflex.expressions import number, power, product_of, sum_of
    >>> mathml_expression(sum_of([power(Name("s"), 2), Name("k")]), {})
    '<mrow><msup><mi>s</mi><mn>2</mn></msup><mo>+</mo><mi>k</mi></mrow>'
    >>> mathml_expression(product_of([number(2), Name("b")]), {})
    '<mrow><mn>2</mn><mo>&#x2062;</mo><mi>b</mi></mrow>'
    """
    return MathmlWriter(labels).markup(expression).mathml


class MathmlWriter:
    """Writes expressions with one set of labels.

    Parameters
    ----------
    labels : Mapping of str to str
        Declared labels in LaTeX.
    """

    def __init__(self, labels: Mapping[str, str]) -> None:
        self._labels = labels
        self._widths = Writer(labels)

    def label(self, name: str) -> str:
        """Return the label of a name."""
        return label_mathml(name, self._labels)

    def width(self, expression: Expression, style: Style = Style.DISPLAY) -> float:
        """Return about how wide an expression is [em]; type for LaTeX is about as wide."""
        return self._widths.piece(expression, style).width

    def markup(self, expression: Expression, style: Style = Style.DISPLAY) -> Markup:
        """Return a subtree printed in a style."""
        done: list[Markup] = []
        pending: list[tuple[Expression, Style, bool]] = [(expression, style, False)]
        while pending:
            node, where, is_ready = pending.pop()
            if isinstance(node, Name):
                done.append(self._name(node.name))
            elif isinstance(node, Derivative):
                done.append(self._primed(node.name, node.order))
            elif isinstance(node, Number):
                done.append(_number(node.value, where))
            elif not is_ready:
                pending.append((node, where, True))
                inner = zip(node.children, inner_styles(node, where), strict=True)
                pending.extend((child, style, False) for child, style in reversed(list(inner)))
            else:
                pieces = done[-len(node.children) :]
                del done[-len(node.children) :]
                if isinstance(node, Call) and node.name not in FUNCTIONS:
                    head = self._primed(node.name, node.order).mathml
                    inside = _fenced(pieces[0])
                    done.append(
                        Markup(row(head, APPLY_FUNCTION, inside.mathml), Shape.CALL, nesting=inside.nesting)
                    )
                else:
                    done.append(_combined(node, pieces, where))
        return done[0]

    def pieces(self, expression: Expression, width: float = PIECE_EM) -> tuple[str, ...]:
        """Return an expression as pieces that follow each other, with a line's end allowed between them.

        Sums are parted before their signs, then products between factors, then parentheses inside.

        Parameters
        ----------
        expression : Expression
            Any.
        width : float, optional
            What is not wider [em] stays whole, and so does what has no place to be parted.
        """
        found: list[str] = []
        # A sign or parenthesis beside a node stays with its first or last piece.
        pending: list[tuple[str, Expression, str]] = [("", expression, "")]
        while pending:
            before, node, after = pending.pop()
            parts = self._parts(node) if self.width(node) > width else None
            if parts is None:
                found.append(f"{before}{self.markup(node).mathml}{after}")
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
                opening, closing = fence_signs(self.markup(base).nesting)
                raised = self.markup(exponent, Style.INLINE).mathml
                return [(opening, base, f"<msup>{closing}{raised}</msup>")]
            case _:
                return None

    def _fenced_part(
        self, before: str, node: Expression, *loose: type[Expression]
    ) -> tuple[str, Expression, str]:
        if not isinstance(node, loose):
            return before, node, ""
        opening, closing = fence_signs(self.markup(node).nesting)
        return before + opening, node, closing

    def _primed(self, name: str, order: int) -> Markup:
        piece = self._name(name)
        if not order:
            return piece
        primes = (
            operator("′" * order)
            if order <= _MOST_PRIMES
            else row(operator("("), numeral(str(order)), operator(")"))
        )
        return Markup(f"<msup>{piece.mathml}{primes}</msup>", Shape.ATOM, has_superscript=True)

    def _name(self, name: str) -> Markup:
        label = self._widths.label(name)
        shape = Shape.SUM if label.is_sum else Shape.PRODUCT if label.is_product else Shape.ATOM
        return Markup(self.label(name), shape, has_superscript=label.has_superscript, is_wordy=label.is_wordy)


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


def _number(value: Fraction, style: Style) -> Markup:
    text = number_text(abs(value))
    above, _, below = text.partition("/")
    found = _decimal(above) if not below else _quotient(_decimal(above), _decimal(below), style)
    return found if value >= 0 else _negative(found)


def _decimal(text: str) -> Markup:
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return Markup(numeral(text), Shape.ATOM)
    power = (
        row(operator("-", "prefix"), numeral(exponent[1:])) if exponent.startswith("-") else numeral(exponent)
    )
    ten = f"<msup>{numeral('10')}{power}</msup>"
    return Markup(row(numeral(mantissa), operator("⋅"), ten), Shape.PRODUCT)


def _combined(node: Expression, pieces: Sequence[Markup], style: Style) -> Markup:
    match node:
        case Sum(terms=terms):
            return _sum(terms, pieces)
        case Product(factors=factors):
            order = sorted(range(len(pieces)), key=lambda i: not isinstance(factors[i], Number))
            return _product([_as_factor(pieces[i]) for i in order])
        case Negative():
            return _negative(pieces[0])
        case Quotient():
            return _quotient(pieces[0], pieces[1], style)
        case Power(base=base, exponent=exponent):
            return _power(base, exponent, pieces)
        case Call(order=0):
            return _call(node, pieces[0])
        case _:
            raise TypeError(f"no MathML for {type(node).__name__}")


def _fenced(piece: Markup) -> Markup:
    content = fence(piece.mathml, piece.nesting, is_tall=piece.is_tall)
    return Markup(content, Shape.ATOM, piece.is_tall, piece.nesting + 1)


def _as_factor(piece: Markup) -> Markup:
    return _fenced(piece) if piece.shape <= Shape.RATIO else piece


def _as_term(piece: Markup) -> Markup:
    return _fenced(piece) if piece.shape <= Shape.NEGATIVE else piece


def _sum(terms: Sequence[Expression], pieces: Sequence[Markup]) -> Markup:
    parts: list[str] = []
    is_tall, nesting = False, 0
    for i, (term, written) in enumerate(zip(terms, pieces, strict=True)):
        is_negative = isinstance(term, Negative)
        # A negative term's minus sign is the sum's own.
        piece = written if is_negative else _as_term(written)
        content = piece.mathml
        if is_negative:
            content = content.removeprefix("<mrow>").removesuffix("</mrow>")
            content = content.removeprefix(_MINUS)
        if i or is_negative:
            parts.append(operator("-" if is_negative else "+", "" if i else "prefix"))
        parts.append(content)
        is_tall, nesting = is_tall or piece.is_tall, max(nesting, piece.nesting)
    return Markup(row(*parts), Shape.SUM, is_tall, nesting)


_MINUS: Final = operator("-", "prefix")


def _negative(operand: Markup) -> Markup:
    piece = _as_term(operand)
    return Markup(f"<mrow>{_MINUS}{piece.mathml}</mrow>", Shape.NEGATIVE, piece.is_tall, piece.nesting)


def _product(factors: Sequence[Markup]) -> Markup:
    parts = [factors[0].mathml]
    for left, right in pairwise(factors):
        parts += [_between(left, right), right.mathml]
    is_tall = any(f.is_tall for f in factors)
    return Markup(row(*parts), Shape.PRODUCT, is_tall, max(f.nesting for f in factors))


def _between(left: Markup, right: Markup) -> str:
    # Two numbers would read as one, a name and a function's name too.
    if right.mathml.startswith("<mn>"):
        return operator("⋅")
    is_worded = Shape.CALL in (left.shape, right.shape) or left.is_wordy or right.is_wordy
    return SPACED_TIMES if is_worded else INVISIBLE_TIMES


def _quotient(above: Markup, below: Markup, style: Style) -> Markup:
    if style is Style.INLINE:
        left = above if above.shape >= Shape.PRODUCT else _fenced(above)
        right = below if below.shape >= Shape.CALL else _fenced(below)
        is_tall = left.is_tall or right.is_tall
        return Markup(
            row(left.mathml, operator("/"), right.mathml),
            Shape.RATIO,
            is_tall,
            max(left.nesting, right.nesting),
        )
    return Markup(f"<mfrac>{above.mathml}{below.mathml}</mfrac>", Shape.FRACTION, is_tall=True)


def _power(base: Expression, exponent: Expression, pieces: Sequence[Markup]) -> Markup:
    below, above = pieces
    if is_half(exponent):
        return _root(below)
    if isinstance(base, Call) and base.name in TRIGONOMETRIC and isinstance(exponent, Number):
        # The exponent of a function stands at its name.
        name = identifier(base.name)
        content = below.mathml.replace(name, f"<msup>{name}{above.mathml}</msup>", 1)
        return Markup(content, Shape.CALL, below.is_tall, below.nesting)
    foot = below if below.shape is Shape.ATOM and not below.has_superscript else _fenced(below)
    return Markup(f"<msup>{foot.mathml}{above.mathml}</msup>", Shape.POWER, foot.is_tall, foot.nesting)


def _root(radicand: Markup) -> Markup:
    return Markup(f"<msqrt>{radicand.mathml}</msqrt>", Shape.CALL, radicand.is_tall)


def _call(node: Call, argument: Markup) -> Markup:
    if node.name == "sqrt":
        return _root(argument)
    if node.name == "exp" and is_short(node.argument):
        return Markup(f"<msup>{identifier('e', 'rm')}{argument.mathml}</msup>", Shape.POWER)
    inside = _fenced(argument)
    content = row(identifier(node.name), APPLY_FUNCTION, inside.mathml)
    return Markup(content, Shape.CALL, inside.is_tall, inside.nesting)
