"""The direction of a member in the plane: cosine and sine of its angle, exact where they are roots.

    alpha + pi/2   ->   cos: -sin(alpha), sin: cos(alpha)

Terms of a sum are added by the addition theorems, so that members at ``alpha`` and ``alpha + pi/2`` share one
cosine and one sine.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    Quotient,
    Sum,
    negative,
    number,
    product_of,
    sum_of,
)

HALF = Fraction(1, 2)
SQUARES = {
    Fraction(0): Fraction(1),
    Fraction(1, 6): Fraction(3, 4),
    Fraction(1, 4): Fraction(1, 2),
    Fraction(1, 3): Fraction(1, 4),
    Fraction(1, 2): Fraction(0),
}
"""The squares of the cosines of these parts of half a turn: of 0, 30, 45, 60 and 90 deg."""


def direction_of(angle: Expression) -> Mapping[str, Expression]:
    """Return the cosine and sine of an angle, and the products that turning a matrix takes."""
    cos, sin = _cosine_and_sine(angle)
    part = _part(angle)
    square = None if part is None else _square(part)
    if square is None or part is None:
        return {"cos": cos, "sin": sin, "cos_cos": product_of([cos, cos]), "cos_sin": product_of([cos, sin])}
    _, mixed = _cosine_and_sine(product_of([number(2), angle]))
    return {"cos": cos, "sin": sin, "cos_cos": number(square), "cos_sin": product_of([number(HALF), mixed])}


def _part(angle: Expression) -> Fraction | None:
    """Return an angle as a part of half a turn, None if it is none that the text shows."""
    match angle:
        case Number(value) if not value:
            return value
        case Name("pi"):
            return Fraction(1)
        case Negative(operand):
            inner = _part(operand)
            return None if inner is None else -inner
        case Product((Number(value), *rest)) | Product((*rest, Number(value))):
            inner = _part(product_of(rest))
            return None if inner is None else inner * value
        case Quotient(above, Number(value)):
            inner = _part(above)
            return None if inner is None else inner / value
        case Sum(terms):
            parts = [_part(term) for term in terms]
            shares = [p for p in parts if p is not None]
            return sum(shares, Fraction(0)) if len(shares) == len(parts) else None
    return None


def _square(part: Fraction) -> Fraction | None:
    """Return the square of the cosine of a part of half a turn, None if it is not rational."""
    within = part % 1
    return SQUARES.get(min(within, 1 - within))


def _cosine_and_sine(angle: Expression) -> tuple[Expression, Expression]:
    part = _part(angle)
    if part is not None and _square(part) is not None:
        return _root(part), _root(part - HALF)
    match angle:
        case Negative(operand):
            cos, sin = _cosine_and_sine(operand)
            return cos, negative(sin)
        case Sum((first, *rest)):
            (c, s), (d, t) = _cosine_and_sine(first), _cosine_and_sine(sum_of(rest))
            cos = sum_of([product_of([c, d]), negative(product_of([s, t]))])
            return cos, sum_of([product_of([s, d]), product_of([c, t])])
    return Call("cos", angle), Call("sin", angle)


def _root(part: Fraction) -> Expression:
    """Return the cosine of a part of half a turn whose square is rational."""
    square = _square(part)
    if square is None:
        raise ValueError(f"the cosine of {part}*pi is no square root")
    is_negative = HALF < part % 2 < 3 * HALF
    # Twice the cosine is a root of 0, 1, 2, 3 or 4.
    twice = {0: number(0), 1: number(1), 4: number(2)}.get(int(4 * square), Call("sqrt", number(4 * square)))
    root = product_of([number(HALF), twice])
    return negative(root) if is_negative else root
