r"""Read a formula as a paper types it in LaTeX, in one way only.

Input: tokens with their places, and the names that a model has. Output: the tree that the text reader gives.

    \frac{2ml^2s^2}{\cosh^2\lambda l}      2*m*l^2*s^2/cosh(lambda*l)^2

Print leaves some formulas open. ``1/2k``, ``a/b c`` and ``\sin \omega t s`` are read both ways and compared
at a point that nothing suggests: equal readings are one formula, others are refused with both.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Final
from zlib import crc32

from symflex.errors import SpecError, Text
from symflex.expressions import (
    FUNCTIONS,
    Call,
    Derivative,
    Differentiated,
    Expression,
    Name,
    Number,
    Power,
    Product,
    Quotient,
    fold,
    format_expression,
    names,
    parse,
    substitute,
    with_children,
)
from symflex.papers.laplace import in_laplace, laplace_of, settled
from symflex.papers.matrices import Matrix, Value
from symflex.papers.reader import LatexReader
from symflex.papers.source import (
    LatexToken,
    PrintedEquation,
    group_end,
    refusal,
    statements,
    text_of,
    tokens_of,
)
from symflex.papers.symbols import LAPLACE, PaperNotation, PrintedSymbol

MOST_OPEN: Final = 12  # places that can be read in two ways


def read_formula(
    tokens: Sequence[LatexToken],
    notation: PaperNotation,
    bound: Mapping[str, int] | None = None,
    laplace: str = LAPLACE,
) -> Expression:
    """Return the tree of one side of an equation; ``laplace`` is what the paper calls s.

    Raises SpecError with SF115 at what is not read or can be read in two ways, SF103 beyond limits.
    """
    value = read_value(tokens, notation, bound)
    if isinstance(value, Matrix):
        raise refusal(tokens[0].span, "this is a matrix, not a formula", "give one of its entries")
    if laplace != LAPLACE:
        value = substitute(value, {laplace: Name(LAPLACE)})
    return value


Lines = tuple[tuple[str, Expression], ...]


def read_latex(text: Text, notation: PaperNotation) -> tuple[tuple[Expression, ...], Lines]:
    r"""Return the sides of ``G = a = b`` that are formulas, and the definitions that follow it.

    The last side has to be read. One before it counts if nothing in it lacks a meaning.

    >>> from symflex.expressions import format_expression
    >>> from symflex.papers.symbols import notation_of
    >>> text = Text.alone("paper", r"\frac{c}{s+p}, \text{ where } p = 2c")
    >>> (formula,), lines = read_latex(text, notation_of([("c", "")]))
    >>> format_expression(formula), [(name, format_expression(line)) for name, line in lines]
    ('c/(s + p)', [('p', '2*c')])
    """
    found = [s for s in statements(tokens_of(text)) if not s.is_condition]
    if not found:
        raise refusal(text.span, "this is no formula")
    first, *others = found
    if first.nearly is not None:
        raise refusal(first.nearly, "this formula only holds nearly", "write = if it is meant exactly")
    symbols = dict(filter(None, (defined_symbol(s) for s in others)))
    more = notation.with_names({symbol: symbol.name for symbol in symbols})
    lines = tuple((symbol.name, definition(statement, more)) for symbol, statement in symbols.items())
    for other in others:
        if defined_symbol(other) is None:
            raise refusal(other.span, "this is more than one formula", "give one formula")
    laplace = laplace_of(first, notation)
    formula = read_formula(first.sides[-1], more, laplace=laplace)
    meant = {*more.names.values(), "pi", *(n.name for n in names(formula) if isinstance(n, Name))}
    meant -= notation.signals
    sides = []
    for side in first.sides[1:-1]:
        try:
            sides.append(read_formula(side, more, laplace=laplace))
        except SpecError:
            continue
    sides = [
        e
        for e in sides
        if all(isinstance(n, Name) and n.name in meant for n in names(e) if n.name not in FUNCTIONS)
    ]
    whole, _ = in_laplace([*sides, formula, *(line for _, line in lines)], more)
    count = len(sides) + 1
    return tuple(whole[:count]), tuple((n, e) for (n, _), e in zip(lines, whole[count:], strict=True))


def defined_symbol(statement: PrintedEquation) -> tuple[PrintedSymbol, PrintedEquation] | None:
    """Return the symbol that an equation defines, or a power of which, ``None`` if it defines none."""
    if len(statement.sides) < 2 or statement.is_condition or statement.nearly:  # noqa: PLR2004
        return None
    reader = LatexReader(statement.sides[0], PaperNotation())
    try:
        symbol = reader.whole_symbol()
        if reader.text == "^":
            typed = text_of(reader.tokens[reader.at + 1 : group_end(reader.tokens, reader.at + 1)]).strip(
                "{}"
            )
            reader.take()
            reader.group()
            if typed.isalpha():  # G^v is a name where nothing else has been said of G
                symbol = symbol._replace(script=f"{symbol.script}^{typed}")
        reader.applied(Name(symbol.name))
    except SpecError:
        return None
    return (symbol, statement) if reader.at == len(reader.tokens) and not reader.open else None


def definition(
    statement: PrintedEquation, notation: PaperNotation, bound: Mapping[str, int] | None = None
) -> Expression:
    """Return what an equation says its symbol is, of ``a^2 = b`` the root; ``bound`` are indices."""
    value = read_formula(statement.sides[-1], notation, bound, laplace_of(statement, notation))
    left_side = read_formula(statement.sides[0], notation, bound)
    if not isinstance(left_side, Power):
        return value
    if not isinstance(left_side.exponent, Number) or left_side.exponent.value < 1:
        raise refusal(statement.span, "this power defines no symbol")
    if left_side.exponent.value == 2:  # noqa: PLR2004
        return Call("sqrt", value, span=value.span)
    return Power(value, Quotient(Number(Fraction(1)), left_side.exponent), span=value.span)


def read_value(
    tokens: Sequence[LatexToken], notation: PaperNotation, bound: Mapping[str, int] | None = None
) -> Value:
    """Return what one side of an equation is, a matrix too; see :func:`read_formula`."""
    if not tokens:
        raise refusal(None, "the formula is empty")
    first = LatexReader(tokens, notation, bound=bound)
    value = first.everything()
    _check_limits(value, tokens)
    if len(first.open) > MOST_OPEN:
        message = f"more than {MOST_OPEN} places of this formula can be read in two ways"
        raise refusal(tokens[0].span, message, "write brackets")
    for at, count in first.open.items():
        for choice in range(1, count):
            other = LatexReader(tokens, notation, {at: choice}, bound)
            try:
                second = other.everything()
            except SpecError:
                continue  # is no reading
            if not _agree(value, second, notation):
                shown = [_shown(first.built.get(at, value)), _shown(other.built.get(at, second))]
                if shown[0] == shown[1]:
                    shown = [_shown(value), _shown(second)]
                message = f"this can be read in two ways: {shown[0]} or {shown[1]}"
                raise refusal(tokens[at].span, message, "write brackets, as \\left( ... \\right)")
    return settled(value, notation, tokens[0].span)


def _check_limits(value: Value, tokens: Sequence[LatexToken]) -> None:
    """Refuse a tree that the text reader would refuse for its size."""
    for entry in (value,) if isinstance(value, Expression) else (e for row in value.rows for e in row):
        try:
            parse(Text.alone("formula", format_expression(entry)), brackets=True)
        except SpecError as error:
            placed = (replace(d, span=tokens[0].span) for d in error.diagnostics)
            raise SpecError(*placed) from None


def _shown(value: Value) -> str:
    text = format_expression(value) if isinstance(value, Expression) else "a matrix"
    return text if len(text) <= 90 else f"{text[:40]} ... {text[-40:]}"  # noqa: PLR2004


def _agree(a: Value, b: Value, notation: PaperNotation) -> bool:
    """Tell whether two readings are one formula, or the second has names that nobody knows."""
    if isinstance(a, Matrix) or isinstance(b, Matrix):
        if not (isinstance(a, Matrix) and isinstance(b, Matrix)) or len(a.rows) != len(b.rows):
            return False
        pairs = [(x, y) for r, q in zip(a.rows, b.rows, strict=True) for x, y in zip(r, q, strict=True)]
        return all(_agree(x, y, notation) for x, y in pairs)
    for seed in ("a", "b"):
        try:
            x, y = evaluated(_at_rest(a), seed), evaluated(_at_rest(b), seed)
        except (ArithmeticError, ValueError, TypeError):
            return False
        if abs(x - y) > 1e-9 * (abs(x) + abs(y)):
            return False
    return True


def _at_rest(node: Expression) -> Expression:
    """Return an expression with derivatives and values at points as names of their own."""
    if isinstance(node, Derivative) or (isinstance(node, Call) and node.name not in FUNCTIONS):
        return Name(format_expression(node))
    if isinstance(node, Differentiated):
        return Product((Name("derivative"), _at_rest(node.operand)))
    return with_children(node, [_at_rest(child) for child in node.children]) if node.children else node


def evaluated(expression: Expression, seed: str = "") -> complex:
    """Return the value of a tree at a point that its names' spelling decides."""

    def value(name: str) -> complex:
        if name == "pi":
            return complex(cmath.pi)
        drawn = crc32(f"{name} {seed}".encode())
        return complex(0.3 + (drawn & 0xFFFF) / 50_000, 0.1 + (drawn >> 16) / 90_000)

    def call(node: Call, argument: complex) -> complex:
        function = {"exp": cmath.exp, "log": cmath.log}.get(node.name) or getattr(cmath, node.name)
        result: complex = function(argument)
        return result

    return fold(
        expression,
        number=complex,
        name=value,
        power=lambda base, exponent: base ** evaluated(exponent, seed),
        call=call,
    )
