r"""Expressions as mathematics: where parentheses stand and how quotients print, in one of two notations.

    1/(m*s)     LaTeX  \frac{1}{m s}     MathML  <mfrac><mn>1</mn><mrow><mi>m</mi>...<mi>s</mi></mrow></mfrac>

Quotients are fractions, one level of fractions within fractions, slashes below that and in exponents;
parentheses, brackets and braces take turns outwards and grow only around something tall. A :class:`Spelling`
only says how a piece is spelt; widths are those of LaTeX, and MathML is about as wide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction
from itertools import pairwise
from typing import Final, NamedTuple

from symflex.algebra.ring import FUNCTIONS
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
from symflex.print.label import Label, symbol
from symflex.print.width import (
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


class Written(NamedTuple):
    """A printed subtree and what its surroundings must know."""

    markup: str
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


@dataclass(frozen=True)
class Spelling:
    """How pieces are spelt."""

    # fraction, slash and applied: templates of two pieces: above and below, function and its argument in a
    # fence. power: from base and exponent.
    fraction: str
    slash: str
    power: Callable[[str, str], str]
    applied: str
    # digits, negative, root and exponential: templates of one piece: a number, minus it, a square root, a
    # power of e.
    digits: str
    negative: str
    root: str
    exponential: str
    name: Callable[[str, Mapping[str, str]], str]  # from a name and the declared labels
    function: Callable[[str], str]  # from a function's name as expressions have it
    # From a function of x and how often it is differentiated; up to :data:`MOST_PRIMES` with primes.
    primed: Callable[[str, int], str]
    scientific: Callable[[str, str], str]  # from a mantissa, nothing where that is 1, and a power of ten
    fenced: Callable[[str, int, bool], str]  # from content, the depth of fences in it, and whether it is tall
    # From terms, each with whether it is spelt as ``negative``.
    sum: Callable[[Sequence[tuple[str, bool]]], str]
    product: Callable[[Sequence[str]], str]  # from factors and what stands between them, in turn
    # From two factors; what stands between them, and its width.
    between: Callable[[Written, Written], tuple[str, Width]]
    # From a function, a call of it and an exponent, which stands at the function.
    function_power: Callable[[str, str, str], str]


FENCES: Final = (("(", ")"), ("[", "]"), (r"\{", r"\}"))
MOST_PRIMES: Final = 3
# The letters of a function's name, with the space that sets it off on either side.
_OPERATORS: Final = frozenset(("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "coth", "arctan"))
_WIDEST_OPERATOR: Final = always(2.3)
TRIGONOMETRIC: Final = frozenset(("sin", "cos", "tan", "sinh", "cosh", "tanh"))
_SHORT_EXPONENT: Final = 8


class ExpressionWriter:
    """Writes expressions in one notation with one set of labels."""

    def __init__(self, labels: Mapping[str, str], spelling: Spelling) -> None:
        self._labels = labels
        self._spelling = spelling
        self._names: dict[str, Written] = {}
        self._powers: dict[tuple[str, Fraction], Written] = {}

    def piece(self, expression: Expression, style: Style = Style.DISPLAY) -> Written:
        """Return a subtree printed in a style; TypeError for what no transfer function contains."""
        done: list[Written] = []
        pending: list[tuple[Expression, Style, bool]] = [(expression, style, False)]
        while pending:
            node, where, is_ready = pending.pop()
            if (leaf := self._leaf(node, where)) is not None:
                done.append(leaf)
                continue
            children = node.children
            if not is_ready:
                pending.append((node, where, True))
                inner = zip(children, inner_styles(node, where), strict=True)
                pending.extend((child, style, False) for child, style in reversed(list(inner)))
            else:
                pieces = done[-len(children) :]
                del done[-len(children) :]
                done.append(self._combined(node, pieces, where))
        return done[0]

    def exponent(self, expression: Expression) -> Written:
        """Return a subtree as it prints in an exponent."""
        return self.piece(expression, Style.INLINE)

    def label(self, name: str) -> Label:
        """Return the label of a name."""
        return symbol(name, self._labels)

    def number(self, text: str) -> Written:
        """Return a number as its digits, or as a decimal times a power of ten."""
        mantissa, _, exponent = text.partition("e")
        if not exponent:
            return Written(self._spelling.digits.format(mantissa), DIGIT_SIZES * len(mantissa), Shape.ATOM)
        mantissa = mantissa if mantissa != "1" else ""
        power = DIGIT_SIZES * len(exponent) + MINUS_SIZES * exponent.startswith("-")
        size = DIGIT_SIZES * (len(mantissa) + 2) + CDOT_SIZES * bool(mantissa) + power.raised + SCRIPT_SPACE
        return Written(self._spelling.scientific(mantissa, exponent), size, Shape.PRODUCT)

    def joined(self, factors: Sequence[Written]) -> tuple[list[str], Width]:
        """Return factors, already fenced where they must be, with the signs between, and the signs' width."""
        parts = [factors[0].markup]
        extra: list[Width] = []
        for left, right in pairwise(factors):
            between, size = self.between(left, right)
            parts += [between, right.markup]
            if size is not NOTHING:
                extra.append(size)
        return parts, total(extra)

    def between(self, left: Written, right: Written) -> tuple[str, Width]:
        """Return what stands between two factors, and its width."""
        return self._spelling.between(left, right)

    def fenced(self, piece: Written) -> Written:
        """Return a piece in parentheses, or in brackets or braces around those."""
        fence = (TALL_FENCES if piece.is_tall else FENCE_SIZES)[piece.nesting % len(FENCES)]
        markup = self._spelling.fenced(piece.markup, piece.nesting, piece.is_tall)
        return Written(markup, piece.size + fence * 2, Shape.ATOM, piece.is_tall, piece.nesting + 1)

    def as_term(self, piece: Written) -> Written:
        """Return a piece as it stands in a sum."""
        return self.fenced(piece) if piece.shape <= Shape.NEGATIVE else piece

    def as_factor(self, piece: Written) -> Written:
        """Return a piece as it stands in a product."""
        return self.fenced(piece) if piece.shape <= Shape.RATIO else piece

    def as_base(self, piece: Written) -> Written:
        """Return a piece as the base of a power."""
        return piece if piece.shape is Shape.ATOM and not piece.has_superscript else self.fenced(piece)

    def as_numerator(self, piece: Written) -> Written:
        """Return a piece as it stands before a slash."""
        return piece if piece.shape >= Shape.PRODUCT else self.fenced(piece)

    def _leaf(self, node: Expression, style: Style) -> Written | None:
        match node:
            case Name(name=name):
                return self._name(name)
            case Derivative(name=name, order=order):
                return self._primed(name, order)
            case Number(value=value):
                return self._number(value, style)
            case Power(base=Name(name=name) as base, exponent=Number(value=value) as exponent) if (
                value.denominator == 1
            ):
                # Integer powers of names are most of a polynomial, and written once.
                if (name, value) not in self._powers:
                    raised = self._number(value, Style.INLINE)
                    self._powers[name, value] = self._power(base, exponent, self._name(name), raised)
                return self._powers[name, value]
            case _:
                return None

    def _name(self, name: str) -> Written:
        piece = self._names.get(name)
        if piece is None:
            label = self.label(name)
            shape = Shape.SUM if label.is_sum else Shape.PRODUCT if label.is_product else Shape.ATOM
            piece = Written(
                self._spelling.name(name, self._labels),
                label.size,
                shape,
                is_wordy=label.is_wordy,
                has_superscript=label.has_superscript,
                subscript=label.subscript,
            )
            self._names[name] = piece
        return piece

    def _primed(self, name: str, order: int) -> Written:
        """Return a function of x or one of its derivatives."""
        piece = self._name(name)
        if not order:
            return piece
        size = piece.size + PRIME_SIZES * order + SCRIPT_SPACE
        if order > MOST_PRIMES:
            size = piece.size + (FENCE_SIZES[0] * 2 + DIGIT_SIZES * len(str(order))).raised + SCRIPT_SPACE
        markup = self._spelling.primed(piece.markup, order)
        return piece._replace(markup=markup, size=size, has_superscript=True, subscript=NOTHING)

    def _number(self, value: Fraction, style: Style) -> Written:
        if value < 0:
            return self._negative(self._number(-value, style))
        above, _, below = number_text(value).partition("/")
        if not below:
            return self.number(above)
        return self._quotient(self.number(above), self.number(below), style)

    def _combined(self, node: Expression, pieces: Sequence[Written], style: Style) -> Written:
        match node:
            case Sum():
                return self._sum(pieces)
            case Product(factors=factors):
                order = sorted(range(len(pieces)), key=lambda i: not isinstance(factors[i], Number))
                return self._product([self.as_factor(pieces[i]) for i in order])
            case Negative():
                return self._negative(pieces[0])
            case Quotient():
                return self._quotient(pieces[0], pieces[1], style)
            case Power(base=base, exponent=exponent):
                return self._power(base, exponent, pieces[0], pieces[1])
            case Call(name=name, order=order) if name not in FUNCTIONS:
                function = self._primed(name, order)
                return self._applied(function.markup, function.size, pieces[0])
            case Call(order=0):
                return self._call(node, pieces[0])
            case _:
                raise TypeError(f"no mathematics for {type(node).__name__}")

    def _sum(self, pieces: Sequence[Written]) -> Written:
        terms: list[tuple[str, bool]] = []
        size, is_tall, nesting = NOTHING, False, 0
        for index, written in enumerate(pieces):
            is_negative = written.shape is Shape.NEGATIVE
            # The minus sign of a negative term is the sum's own.
            piece = written if is_negative else self.as_term(written)
            sign = OPERATOR_SIZES.beyond(MINUS_SIZES) if is_negative else OPERATOR_SIZES
            terms.append((piece.markup, is_negative))
            size += piece.size + (sign if index else NOTHING)
            is_tall, nesting = is_tall or piece.is_tall, max(nesting, piece.nesting)
        return Written(self._spelling.sum(terms), size, Shape.SUM, is_tall, nesting)

    def _negative(self, operand: Written) -> Written:
        piece = self.as_term(operand)
        size = piece.size + MINUS_SIZES
        return Written(
            self._spelling.negative.format(piece.markup), size, Shape.NEGATIVE, piece.is_tall, piece.nesting
        )

    def _product(self, factors: Sequence[Written]) -> Written:
        parts, between = self.joined(factors)
        return Written(
            self._spelling.product(parts),
            total([between, *(factor.size for factor in factors)]),
            Shape.PRODUCT,
            any(f.is_tall for f in factors),
            max(f.nesting for f in factors),
            any(f.is_wordy for f in factors),
        )

    def _quotient(self, above: Written, below: Written, style: Style) -> Written:
        if style is Style.INLINE:
            left, right = self.as_numerator(above), below if below.shape >= Shape.CALL else self.fenced(below)
            return Written(
                self._spelling.slash.format(left.markup, right.markup),
                left.size + SLASH_SIZES + right.size,
                Shape.RATIO,
                left.is_tall or right.is_tall,
                max(left.nesting, right.nesting),
            )
        inside = widest(above.size, below.size)
        size = (inside if style is Style.DISPLAY else inside.raised) + FRACTION_EDGES
        return Written(
            self._spelling.fraction.format(above.markup, below.markup), size, Shape.FRACTION, is_tall=True
        )

    def _power(self, base: Expression, exponent: Expression, below: Written, above: Written) -> Written:
        if is_half(exponent):
            return self._root(below)
        size = above.size.raised + SCRIPT_SPACE
        if isinstance(base, Call) and base.name in TRIGONOMETRIC and isinstance(exponent, Number):
            function = self._spelling.function(base.name)
            markup = self._spelling.function_power(function, below.markup, above.markup)
            return Written(markup, below.size + size, Shape.CALL, below.is_tall, below.nesting)
        root = self.as_base(below)
        markup = self._spelling.power(root.markup, above.markup)
        size = root.size + size.beyond(root.subscript)
        return Written(markup, size, Shape.POWER, root.is_tall, root.nesting, root.is_wordy)

    def _root(self, radicand: Written) -> Written:
        size = radicand.size + (TALL_ROOT if radicand.is_tall else ROOT)
        return Written(self._spelling.root.format(radicand.markup), size, Shape.CALL, radicand.is_tall)

    def _applied(self, function: str, size: Width, argument: Written) -> Written:
        inside = self.fenced(argument)
        markup = self._spelling.applied.format(function, inside.markup)
        return Written(markup, size + inside.size, Shape.CALL, inside.is_tall, inside.nesting)

    def _call(self, node: Call, argument: Written) -> Written:
        if node.name == "sqrt":
            return self._root(argument)
        if node.name == "exp" and is_short(node.argument):
            size = argument.size.raised + UPRIGHT.widths["e"] + SCRIPT_SPACE
            return Written(self._spelling.exponential.format(argument.markup), size, Shape.POWER)
        return self._applied(self._spelling.function(node.name), operator_size(node.name), argument)


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


class Part(NamedTuple):
    """A part of an expression that may begin a line, after a sign or nothing."""

    sign: str  # ``+``, ``-``, ``*``, ``/`` or empty
    node: Expression


def parts_of(node: Expression) -> list[Part]:
    """Return where an expression may be broken, in any notation: at signs, between factors, at a slash."""
    match node:
        case Sum(terms=terms):
            signed = [
                ("-", t.operand) if isinstance(t, Negative) else ("+" if i else "", t)
                for i, t in enumerate(terms)
            ]
            return [Part(*each) for each in signed]
        case Product(factors=factors):
            ordered = sorted(factors, key=lambda factor: not isinstance(factor, Number))
            return [Part("*" if i else "", factor) for i, factor in enumerate(ordered)]
        case Negative(operand=operand):
            return [Part("-", operand)]
        case Quotient(numerator=above, denominator=below):
            return [Part("", above), Part("/", below)]
        case _:
            return []


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


def operator_size(function: str) -> Width:
    """Return the width of a function's name."""
    function = function.replace("atan", "arctan")
    if function not in _OPERATORS:
        return _WIDEST_OPERATOR
    size = THIN_SIZES * 2
    for letter in function:
        size += UPRIGHT.widths[letter]
    return size
