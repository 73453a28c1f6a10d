"""From the text of an expression to its tree.

Input: a :class:`~symflex.errors.Text`, hostile until read. Output: an immutable, n-ary tree whose
every node knows its place. The parser keeps its own stack and the nodes are built while it reduces, so no
depth of nesting reaches the interpreter's; limits are checked before or while reading, never after.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import NamedTuple, NoReturn

from symflex.errors import Diagnostic, SpecError, Text
from symflex.expressions.limits import (
    SIZE_OF_NAME,
    USER_LIMITS,
    Limits,
    Size,
    exponent_problem,
    power_problem,
    size_of_call,
    size_of_negative,
    size_of_number,
    size_of_power,
    size_of_product,
    size_of_quotient,
    size_of_sum,
)
from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
    Differentiated,
    Equation,
    Expression,
    Measured,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    measured,
    nodes,
)
from symflex.expressions.slips import FUNCTIONS, RECIPROCALS, character_slip, end_slip, token_slip
from symflex.quantities import parse_quantity
from symflex.quantities.lalr import END, Grammar, Reading, Token, UnexpectedError

NAME_LENGTH = 64
BLANKS = " \t\r\n"

# A level of the tree takes at most three entries of the parser's stack and a parenthesis one.
STACK_PER_LEVEL = 4


def parse(text: Text, *, limits: Limits = USER_LIMITS, brackets: bool = False) -> Expression:
    """Read an expression: sums and products are flat, parentheses leave no trace, numbers are exact.

    Text that the program itself has written takes :data:`PROGRAM_LIMITS`. Only the first problem is reported.
    """
    expression = _read(text, limits, "sum").node
    if not brackets and (
        bracket := next((n for n in nodes(expression) if isinstance(n, Differentiated)), None)
    ):
        message = "a derivative of a bracket along x belongs in the equations and conditions of [fields]"
        hint = "a derivative in time is written with s: s*x"
        raise SpecError(Diagnostic("SF223", message, bracket.span, hint))
    return expression


def parse_equation(text: Text, *, limits: Limits = USER_LIMITS) -> Equation:
    """Read ``left = right``, as fields write their equations and conditions; SF111 without one ``=``."""
    equation = _read(text, limits, "equation").node
    assert isinstance(equation, Equation)
    return equation


@dataclass(frozen=True, slots=True)
class _Reading:
    """One text being read; every leaf's token carries it to the callbacks, which are shared by all texts."""

    text: Text
    limits: Limits

    def refuse(self, start: int, end: int, code: str, message: str, hint: str | None = None) -> NoReturn:
        raise SpecError(Diagnostic(code, message, self.text.at(start, end), hint))


class _Piece(NamedTuple):
    """A subtree on the parser's stack. Its extent includes parentheses around it, its node's does not."""

    node: Expression
    start: int
    end: int
    size: Size
    reading: _Reading


class _TreeBuilder:
    """The parser's callbacks, one for each rule of the grammar; they contain no state."""

    def equation(self, left: _Piece, _equal: Token, right: _Piece) -> _Piece:
        span = left.reading.text.at(left.start, right.end)
        size = size_of_quotient(left.size, right.size)
        return _piece(Equation(left.node, right.node, span=span), left, right, size)

    def sum(self, first: _Piece, *rest: Token | _Piece) -> _Piece:
        pieces = [first]
        sign = None
        for item in rest:
            if isinstance(item, Token):
                sign = item
            else:
                pieces.append(item if sign is None else self.signed(sign, item))
        terms, sizes = _flat(pieces, Sum)
        span = first.reading.text.at(first.start, pieces[-1].end)
        return _piece(Sum(terms, span=span), first, pieces[-1], size_of_sum(sizes))

    def product(self, first: _Piece, *rest: Token | _Piece) -> _Piece:
        pieces = [first]
        operator = ""
        for item in rest:
            if isinstance(item, Token):
                operator = str(item)
            elif operator == "*":
                pieces.append(item)
            else:
                pieces = [_quotient(_product(pieces), item)]
        return _product(pieces)

    def signed(self, sign: Token, operand: _Piece) -> _Piece:
        start = sign.start
        if sign == "+":
            return operand._replace(start=start)
        reading = operand.reading
        node = Negative(operand.node, span=reading.text.at(start, operand.end))
        return _checked(_Piece(node, start, operand.end, size_of_negative(operand.size), reading))

    def power(self, base: _Piece, _operator: Token, exponent: _Piece) -> _Piece:
        reading = base.reading
        if problem := exponent_problem(exponent.size, reading.limits):
            reading.refuse(exponent.start, exponent.end, "SF103", problem, "write a smaller exponent")
        if problem := power_problem(base.size, exponent.size, reading.limits):
            hint = "name the base in [definitions], or write a smaller exponent"
            reading.refuse(base.start, exponent.end, "SF103", problem, hint)
        node = Power(base.node, exponent.node, span=reading.text.at(base.start, exponent.end))
        return _piece(node, base, exponent, size_of_power(base.size, exponent.size))

    def number(self, token: Token) -> _Piece:
        # Decimal is exact here and, unlike int, reads numbers of any length.
        value = Fraction(Decimal(str(token)))
        return _leaf(Number(value), token, token, size_of_number(value))

    def measured(self, token: Token, unit: Token) -> _Piece:
        reading = _reading(token)
        start, end = token.start, unit.end
        span = reading.text.at(start, end)
        quantity = parse_quantity(Text(f"{token} {unit}", span))
        if quantity.pi_power or quantity.cycles:
            reading.refuse(start, end, "SF203", f"a point along x is a length and cannot be in '{unit}'")
        node = Measured(quantity.magnitude, quantity=quantity, span=span)
        return _Piece(node, start, end, size_of_number(quantity.magnitude), reading)

    def name(self, token: Token) -> _Piece:
        return _leaf(Name(str(token)), token, token, SIZE_OF_NAME)

    def attribute(self, owner: Token, _dot: Token, name: Token) -> _Piece:
        return _leaf(Attribute(str(owner), str(name)), owner, name, SIZE_OF_NAME)

    def derivative(self, name: Token, primes: Token) -> _Piece:
        return _leaf(Derivative(str(name), len(primes)), name, primes, SIZE_OF_NAME)

    def call(self, name: Token, _left: Token, argument: _Piece, right: Token) -> _Piece:
        return _called(name, 0, argument, right)

    def evaluation(self, name: Token, primes: Token, _left: Token, argument: _Piece, right: Token) -> _Piece:
        return _called(name, len(primes), argument, right)

    def point(
        self, owner: Token, _dot: Token, name: Token, _left: Token, argument: _Piece, right: Token
    ) -> _Piece:
        return _called(owner, 0, argument, right, name)

    def slope(
        self,
        owner: Token,
        _dot: Token,
        name: Token,
        primes: Token,
        _left: Token,
        argument: _Piece,
        right: Token,
    ) -> _Piece:
        return _called(owner, len(primes), argument, right, name)

    def bracket(self, left: Token, inner: _Piece, _right: Token, primes: Token) -> _Piece:
        return _differentiated(left.start, inner, primes, primes.end)

    def bracket_at(
        self, left: Token, inner: _Piece, _right: Token, primes: Token, _left: Token, at: _Piece, right: Token
    ) -> _Piece:
        return _differentiated(left.start, inner, primes, right.end, at)

    def group(self, left: Token, inner: _Piece, right: Token) -> _Piece:
        return inner._replace(start=left.start, end=right.end)


def _flat(pieces: Sequence[_Piece], kind: type[Expression]) -> tuple[tuple[Expression, ...], list[Size]]:
    """Return the operands with those of the same kind opened, and the sizes they then have."""
    nodes: list[Expression] = []
    sizes: list[Size] = []
    for piece in pieces:
        if isinstance(piece.node, kind):
            nodes.extend(piece.node.children)
            sizes.append(piece.size._replace(depth=piece.size.depth - 1))
        else:
            nodes.append(piece.node)
            sizes.append(piece.size)
    return tuple(nodes), sizes


def _called(name: Token, order: int, argument: _Piece, right: Token, quantity: Token | None = None) -> _Piece:
    reading = argument.reading
    start, end = name.start, right.end
    written = str(name) if quantity is None else f"{name}.{quantity}"
    whole = written if order else RECIPROCALS.get(written, written)
    if whole in FUNCTIONS and (lengths := measured(argument.node)):
        message = f"a number with a unit in the argument of {whole}"
        hint = "a number with a unit belongs in [parameters]; only a point along x may have one here"
        raise SpecError(Diagnostic("SF111", message, lengths[0].span, hint))
    node = Call(whole, argument.node, order, span=reading.text.at(start, end))
    called = _checked(_Piece(node, start, end, size_of_call(argument.size), reading))
    if whole == written:
        return called
    one = _Piece(Number(Fraction(1), span=node.span), start, start, size_of_number(Fraction(1)), reading)
    return _quotient(one, called)


def _differentiated(
    start: int, inner: _Piece, primes: Token, end: int, point: _Piece | None = None
) -> _Piece:
    reading, order = inner.reading, len(primes)
    at = None if point is None else point.node
    node = Differentiated(inner.node, order, at, span=reading.text.at(start, end))
    return _checked(_Piece(node, start, end, size_of_call(inner.size), reading))


def _product(pieces: Sequence[_Piece]) -> _Piece:
    if len(pieces) == 1:
        return pieces[0]
    factors, sizes = _flat(pieces, Product)
    span = pieces[0].reading.text.at(pieces[0].start, pieces[-1].end)
    return _piece(Product(factors, span=span), pieces[0], pieces[-1], size_of_product(sizes))


def _quotient(numerator: _Piece, denominator: _Piece) -> _Piece:
    span = numerator.reading.text.at(numerator.start, denominator.end)
    size = size_of_quotient(numerator.size, denominator.size)
    return _piece(Quotient(numerator.node, denominator.node, span=span), numerator, denominator, size)


def _piece(node: Expression, first: _Piece, last: _Piece, size: Size) -> _Piece:
    return _checked(_Piece(node, first.start, last.end, size, first.reading))


def _checked(piece: _Piece) -> _Piece:
    if piece.size.depth > piece.reading.limits.depth:
        _refuse_depth(piece.reading, piece.start, piece.end)
    return piece


def _refuse_depth(reading: _Reading, start: int, end: int) -> NoReturn:
    message = f"this expression is nested too deeply; at most {reading.limits.depth} levels are allowed"
    reading.refuse(start, end, "SF103", message, "name parts of it in [definitions]")


def _leaf(node: Expression, first: Token, last: Token, size: Size) -> _Piece:
    reading = _reading(first)
    whole = replace(node, span=reading.text.at(first.start, last.end))
    return _Piece(whole, first.start, last.end, size, reading)


def _reading(token: Token) -> _Reading:
    reading = token.value
    assert isinstance(reading, _Reading)
    return reading


@cache
def _grammar() -> Grammar:
    return Grammar(Path(__file__).with_name("grammar.json"), _TreeBuilder(), is_contextual=False)


def _read(text: Text, limits: Limits, start: str) -> _Piece:
    reading = _Reading(text, limits)
    _check_extent(reading, start)
    words = Reading(_grammar(), text.value, start)
    recent: deque[Token] = deque(maxlen=4)
    try:
        for token in words.words():
            _check_token(reading, token)
            recent.append(token)
            token.value = reading
            if len(words.values) > STACK_PER_LEVEL * (limits.depth + limits.parentheses):
                _refuse_depth(reading, token.start, token.end)
        piece = words.end()
    except UnexpectedError as error:
        is_equation = start == "equation"
        if error.token is None:
            slip = character_slip(text.value, error.start)
        elif error.token.type == END:
            slip = end_slip(text.value, recent[-1], error.expected, is_equation=is_equation)
        else:
            slip = token_slip(text.value, tuple(recent), error.expected, is_equation=is_equation)
    else:
        assert isinstance(piece, _Piece)
        return piece
    reading.refuse(*slip)


def _check_extent(reading: _Reading, start: str) -> None:
    value, limits = reading.text.value, reading.limits
    if len(value) > limits.characters:
        message = f"this text has {len(value)} characters; at most {limits.characters} are allowed"
        first = limits.characters
        reading.refuse(first, first + 1, "SF103", message, "name parts of it in [definitions]")
    if not value.strip(BLANKS):
        what = "equation" if start == "equation" else "expression"
        reading.refuse(0, len(value), "SF111", f"the {what} is empty")
    depth = 0
    for match in re.finditer(r"[()]", value):
        depth += 1 if match[0] == "(" else -1
        if depth > limits.parentheses:
            message = f"parentheses are nested too deeply; at most {limits.parentheses} levels are allowed"
            reading.refuse(match.start(), match.end(), "SF103", message, "name parts of it in [definitions]")


def _check_token(reading: _Reading, token: Token) -> None:
    limits = reading.limits
    start, end = token.start, token.end
    if token.type == "NAME" and len(token) > NAME_LENGTH:
        message = f"this name has {len(token)} characters; at most {NAME_LENGTH} are allowed"
        reading.refuse(start, end, "SF112", message)
    if token.type == "PRIMES" and len(token) > limits.order:
        message = f"this derivative is of order {len(token)}; at most {limits.order} is allowed"
        reading.refuse(start, end, "SF103", message, "write a system of lower order in more unknowns")
    if token.type == "NUMBER":
        mantissa, _, exponent = token.lower().partition("e")
        digits = len(mantissa) - mantissa.count(".")
        if digits > limits.digits:
            message = f"this number has {digits} digits; at most {limits.digits} are allowed"
            reading.refuse(start, end, "SF103", message, "leave out the last digits")
        significant = exponent.lstrip("+-0")
        # Compared by length first: the exponent may itself have thousands of digits.
        longest = len(str(limits.decimal_exponent))
        if len(significant) > longest or int(significant or "0") > limits.decimal_exponent:
            message = f"the exponent of this number exceeds {limits.decimal_exponent}"
            reading.refuse(start, end, "SF103", message, "choose units in which values are closer to 1")
