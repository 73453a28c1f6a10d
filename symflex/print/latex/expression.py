r"""Expressions as LaTeX mathematics, written directly and with their widths.

Quotients are fractions, one level of fractions within fractions, slashes below that and in exponents;
parentheses, brackets and braces take turns outwards and grow only around something tall; factors follow each
other without a sign except where two numbers would meet.
"""

from __future__ import annotations

from enum import IntEnum
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
from symflex.print.latex.label import symbol
from symflex.print.latex.width import (
    CDOT_SIZES,
    DIGIT_SIZES,
    FENCE_SIZES,
    FRACTION_EDGES,
    MINUS_SIZES,
    NOTHING,
    OPERATOR_SIZES,
    PRIME_SIZES,
    ROOT,
    SCRIPT_SPACE,
    SLASH_SIZES,
    TALL_FENCES,
    TALL_ROOT,
    THIN_SIZES,
    UPRIGHT,
    Width,
    always,
    total,
    widest,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.print.latex.label import Label


class Shape(IntEnum):
    """What a piece prints as; what comes earlier binds less tightly."""

    SUM = 0
    NEGATIVE = 1
    RATIO = 2
    PRODUCT = 3
    FRACTION = 4
    CALL = 5
    POWER = 6
    ATOM = 7


class Style(IntEnum):
    """How a quotient prints: at full size, within another fraction, or with a slash."""

    DISPLAY = 0
    TEXT = 1
    INLINE = 2


class Piece(NamedTuple):
    """A printed subtree and what its surroundings must know."""

    latex: str
    size: Width
    shape: Shape
    is_tall: bool = False
    nesting: int = 0
    is_wordy: bool = False
    has_superscript: bool = False
    subscript: Width = NOTHING

    @property
    def width(self) -> float:
        """Width at full size [em]."""
        return self.size.text


FENCES: Final = (("(", ")"), ("[", "]"), (r"\{", r"\}"))
# The letters of a function's name, with the space that sets it off on either side.
_OPERATORS: Final = {"exp": "exp", "log": "log", "sin": "sin", "cos": "cos", "tan": "tan"} | {
    name: name for name in ("sinh", "cosh", "tanh", "coth")
}
_WIDEST_OPERATOR: Final = always(2.3)
TRIGONOMETRIC: Final = frozenset(("sin", "cos", "tan", "sinh", "cosh", "tanh"))
_SHORT_EXPONENT: Final = 8
_MOST_PRIMES: Final = 3


def latex_expression(expression: Expression, labels: Mapping[str, str], style: Style = Style.DISPLAY) -> str:
    r"""Return an expression as LaTeX for math mode.

    Parameters
    ----------
    expression : Expression
        Any width and depth.
    labels : Mapping of str to str
        Declared labels; other names get :func:`~symflex.print.latex.label.label_of`.
    style : Style, optional
        How its quotients print.

    Raises
    ------
    TypeError
        For an equation or a quantity of an element, which no transfer function holds.

    Examples
    --------
    >>> from symflex.expressions import number, power, product_of, quotient, sum_of
    >>> s, zeta, omega = Name("s"), Name("zeta_p1"), Name("omega_p1")
    >>> print(latex_expression(sum_of([power(s, 2), product_of([number(2), zeta, omega, s])]), {}))
    s^{2} + 2 \zeta_{p1} \omega_{p1} s
    >>> print(latex_expression(quotient(number(1), product_of([Name("r"), sum_of([s, zeta])])), {"r": "r_t"}))
    \frac{1}{r_t (s + \zeta_{p1})}
    """
    return Writer(labels).piece(expression, style).latex


class Writer:
    """Writes expressions with one set of labels.

    Parameters
    ----------
    labels : Mapping of str to str
        Declared labels.
    """

    def __init__(self, labels: Mapping[str, str]) -> None:
        self._labels = labels
        self._names: dict[str, Piece] = {}
        self._powers: dict[tuple[str, Fraction], Piece] = {}

    def piece(self, expression: Expression, style: Style = Style.DISPLAY) -> Piece:
        """Return a subtree printed in a style; see :func:`latex_expression`."""
        done: list[Piece] = []
        pending: list[tuple[Expression, Style, bool]] = [(expression, style, False)]
        while pending:
            node, where, is_ready = pending.pop()
            if isinstance(node, Name):
                done.append(self._name(node.name))
                continue
            if isinstance(node, Derivative):
                done.append(self._primed(node.name, node.order))
                continue
            if isinstance(node, Number):
                done.append(_number(node.value, where))
                continue
            if isinstance(node, Power) and (power := self._power_of_name(node)) is not None:
                done.append(power)
                continue
            children = node.children
            if not is_ready:
                pending.append((node, where, True))
                inner = zip(children, inner_styles(node, where), strict=True)
                pending.extend((child, style, False) for child, style in reversed(list(inner)))
            else:
                pieces = done[-len(children) :]
                del done[-len(children) :]
                if isinstance(node, Call) and node.name not in FUNCTIONS:
                    done.append(_applied(self._primed(node.name, node.order), pieces[0]))
                else:
                    done.append(_combined(node, pieces, where))
        return done[0]

    def _power_of_name(self, node: Power) -> Piece | None:
        """Return an integer power of a name, written once; None for any other power."""
        base, exponent = node.base, node.exponent
        if not isinstance(base, Name) or not isinstance(exponent, Number) or exponent.value.denominator != 1:
            return None
        key = base.name, exponent.value
        if key not in self._powers:
            raised = _number(exponent.value, Style.INLINE)
            self._powers[key] = _power(base, exponent, (self._name(base.name), raised))
        return self._powers[key]

    def _primed(self, name: str, order: int) -> Piece:
        """Return a function of x or one of its derivatives."""
        piece = self._name(name)
        if not order:
            return piece
        primes = "'" * order if order <= _MOST_PRIMES else rf"^{{({order})}}"
        size = piece.size + PRIME_SIZES * order + SCRIPT_SPACE
        if order > _MOST_PRIMES:
            size = piece.size + (FENCE_SIZES[0] * 2 + DIGIT_SIZES * len(str(order))).raised + SCRIPT_SPACE
        return piece._replace(latex=piece.latex + primes, size=size, has_superscript=True, subscript=NOTHING)

    def exponent(self, expression: Expression) -> Piece:
        """Return a subtree as it prints in an exponent."""
        return self.piece(expression, Style.INLINE)

    def label(self, name: str) -> Label:
        """Return the label of a name."""
        return symbol(name, self._labels)

    def _name(self, name: str) -> Piece:
        piece = self._names.get(name)
        if piece is None:
            label = self.label(name)
            shape = Shape.SUM if label.is_sum else Shape.PRODUCT if label.is_product else Shape.ATOM
            piece = Piece(
                label.latex,
                label.size,
                shape,
                is_wordy=label.is_wordy,
                has_superscript=label.has_superscript,
                subscript=label.subscript,
            )
            self._names[name] = piece
        return piece


def joined(factors: Sequence[Piece]) -> tuple[str, Width]:
    """Return factors, already fenced where they must be, side by side, and the width of the signs between."""
    parts = [factors[0].latex]
    extra: list[Width] = []
    for left, right in pairwise(factors):
        between, size = between_factors(left, right)
        parts += [between, right.latex]
        if size is not NOTHING:
            extra.append(size)
    return "".join(parts), total(extra)


def between_factors(left: Piece, right: Piece) -> tuple[str, Width]:
    """Return what stands between two factors, and its width."""
    if right.latex[:1].isdigit() or (right.latex.startswith(r"\frac") and left.latex[-1:].isdigit()):
        return r" \cdot ", CDOT_SIZES
    if left.shape is Shape.CALL or right.shape is Shape.CALL:
        return r" \, ", THIN_SIZES
    if (left.is_wordy or right.is_wordy) and not (left.nesting or right.nesting):
        return r" \, ", THIN_SIZES
    return " ", NOTHING


def fenced(piece: Piece) -> Piece:
    """Return a piece in parentheses, or in brackets or braces around those."""
    kind = piece.nesting % len(FENCES)
    left, right = FENCES[kind]
    if piece.is_tall:
        latex, fence = rf"\left{left} {piece.latex} \right{right}", TALL_FENCES[kind]
    else:
        latex, fence = f"{left}{piece.latex}{right}", FENCE_SIZES[kind]
    return Piece(latex, piece.size + fence * 2, Shape.ATOM, piece.is_tall, piece.nesting + 1)


def as_term(piece: Piece) -> Piece:
    """Return a piece as it stands in a sum."""
    return fenced(piece) if piece.shape <= Shape.NEGATIVE else piece


def as_factor(piece: Piece) -> Piece:
    """Return a piece as it stands in a product."""
    return fenced(piece) if piece.shape <= Shape.RATIO else piece


def as_base(piece: Piece) -> Piece:
    """Return a piece as the base of a power."""
    return piece if piece.shape is Shape.ATOM and not piece.has_superscript else fenced(piece)


def numbers_first(factors: Sequence[Expression]) -> list[Expression]:
    """Return factors with the plain numbers before all others, otherwise in order."""
    return sorted(factors, key=lambda factor: not isinstance(factor, Number))


def is_half(exponent: Expression) -> bool:
    """Return whether an exponent makes a square root."""
    if isinstance(exponent, Quotient):
        return exponent == Quotient(Number(Fraction(1)), Number(Fraction(2)))
    return exponent == Number(Fraction(1, 2))


def is_short(expression: Expression) -> bool:
    """Return whether an expression may stand in the exponent of e."""
    pending, size = [expression], 0
    while pending and size <= _SHORT_EXPONENT:
        node = pending.pop()
        size += 1
        pending.extend(node.children)
    return size <= _SHORT_EXPONENT


def number_piece(text: str) -> Piece:
    """Return a number as its digits, or as a decimal times a power of ten."""
    mantissa, _, exponent = text.partition("e")
    if exponent:
        latex = rf"{mantissa} \cdot 10^{{{exponent}}}"
        power = DIGIT_SIZES * len(exponent) + MINUS_SIZES * exponent.startswith("-")
        digits = DIGIT_SIZES * (len(mantissa) + 2)
        return Piece(latex, digits + CDOT_SIZES + power.raised + SCRIPT_SPACE, Shape.PRODUCT)
    return Piece(mantissa, DIGIT_SIZES * len(mantissa), Shape.ATOM)


def _number(value: Fraction, style: Style) -> Piece:
    if value < 0:
        return _negative(_number(-value, style))
    text = number_text(value)
    above, _, below = text.partition("/")
    if not below:
        return number_piece(text)
    return _quotient(number_piece(above), number_piece(below), style)


def inner_styles(node: Expression, style: Style) -> tuple[Style, ...]:
    """Return in which style each operand is set."""
    match node:
        case Quotient():
            inner = Style.TEXT if style is Style.DISPLAY else Style.INLINE
            return inner, inner
        case Power():
            return style, Style.INLINE
        case Call(name="exp", argument=argument) if is_short(argument):
            return (Style.INLINE,)
        case Call(name=name, argument=Quotient(denominator=Number())) if name in TRIGONOMETRIC:
            return (Style.INLINE,)
        case _:
            return (style,) * len(node.children)


def _combined(node: Expression, pieces: Sequence[Piece], style: Style) -> Piece:
    match node:
        case Sum():
            return _sum(pieces)
        case Product():
            order = sorted(range(len(pieces)), key=lambda i: not isinstance(node.factors[i], Number))
            return _product([as_factor(pieces[i]) for i in order])
        case Negative():
            return _negative(pieces[0])
        case Quotient():
            return _quotient(pieces[0], pieces[1], style)
        case Power(base=base, exponent=exponent):
            return _power(base, exponent, pieces)
        case Call(order=0):
            return _call(node, pieces[0])
        case _:
            raise TypeError(f"no LaTeX for {type(node).__name__}")


def _sum(pieces: Sequence[Piece]) -> Piece:
    parts: list[str] = []
    size, is_tall, nesting = NOTHING, False, 0
    for index, written in enumerate(pieces):
        if written.shape is Shape.NEGATIVE:
            # Its minus sign is the sum's own.
            parts.append(("- " if index else "-") + written.latex[1:])
            size += written.size + (OPERATOR_SIZES.beyond(MINUS_SIZES) if index else NOTHING)
            piece = written
        else:
            piece = as_term(written)
            parts.append(("+ " if index else "") + piece.latex)
            size += piece.size + (OPERATOR_SIZES if index else NOTHING)
        is_tall = is_tall or piece.is_tall
        nesting = max(nesting, piece.nesting)
    return Piece(" ".join(parts), size, Shape.SUM, is_tall, nesting)


def _negative(operand: Piece) -> Piece:
    piece = as_term(operand)
    return Piece(f"-{piece.latex}", piece.size + MINUS_SIZES, Shape.NEGATIVE, piece.is_tall, piece.nesting)


def _product(factors: Sequence[Piece]) -> Piece:
    latex, between = joined(factors)
    return Piece(
        latex,
        total([between, *(factor.size for factor in factors)]),
        Shape.PRODUCT,
        any(f.is_tall for f in factors),
        max(f.nesting for f in factors),
        any(f.is_wordy for f in factors),
    )


def _quotient(above: Piece, below: Piece, style: Style) -> Piece:
    if style is Style.INLINE:
        numerator = above if above.shape >= Shape.PRODUCT else fenced(above)
        denominator = below if below.shape >= Shape.CALL else fenced(below)
        return Piece(
            f"{numerator.latex}/{denominator.latex}",
            numerator.size + SLASH_SIZES + denominator.size,
            Shape.RATIO,
            numerator.is_tall or denominator.is_tall,
            max(numerator.nesting, denominator.nesting),
        )
    inside = widest(above.size, below.size)
    size = (inside if style is Style.DISPLAY else inside.raised) + FRACTION_EDGES
    return Piece(rf"\frac{{{above.latex}}}{{{below.latex}}}", size, Shape.FRACTION, is_tall=True)


def _power(base: Expression, exponent: Expression, pieces: Sequence[Piece]) -> Piece:
    below, above = pieces
    if is_half(exponent):
        return _root(below)
    raised = f"^{{{above.latex}}}"
    size = above.size.raised + SCRIPT_SPACE
    if isinstance(base, Call) and base.name in TRIGONOMETRIC and isinstance(exponent, Number):
        # The exponent of a function stands at its name.
        head = FUNCTIONS[base.name].latex
        latex = f"{head}{raised}{below.latex.removeprefix(head)}"
        return Piece(latex, below.size + size, Shape.CALL, below.is_tall, below.nesting)
    root = as_base(below)
    latex = f"{root.latex}{raised}"
    size = root.size + size.beyond(root.subscript)
    return Piece(latex, size, Shape.POWER, root.is_tall, root.nesting, root.is_wordy)


def _root(radicand: Piece) -> Piece:
    latex = rf"\sqrt{{{radicand.latex}}}"
    return Piece(
        latex, radicand.size + (TALL_ROOT if radicand.is_tall else ROOT), Shape.CALL, radicand.is_tall
    )


def _applied(function: Piece, argument: Piece) -> Piece:
    """Return a function of x at a point."""
    inside = fenced(argument)
    size = function.size + inside.size
    return Piece(function.latex + inside.latex, size, Shape.CALL, inside.is_tall, inside.nesting)


def _call(node: Call, argument: Piece) -> Piece:
    if node.name == "sqrt":
        return _root(argument)
    if node.name == "exp" and is_short(node.argument):
        latex = rf"\mathrm{{e}}^{{{argument.latex}}}"
        return Piece(latex, argument.size.raised + UPRIGHT.widths["e"] + SCRIPT_SPACE, Shape.POWER)
    inside = fenced(argument)
    size = operator_size(node.name) + inside.size
    latex = FUNCTIONS[node.name].latex + inside.latex
    return Piece(latex, size, Shape.CALL, inside.is_tall, inside.nesting)


def operator_size(function: str) -> Width:
    """Return the width of a function's name."""
    if function not in _OPERATORS:
        return _WIDEST_OPERATOR
    size = THIN_SIZES * 2
    for letter in _OPERATORS[function]:
        size += UPRIGHT.widths[letter]
    return size
