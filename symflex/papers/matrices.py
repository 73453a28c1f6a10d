"""Sums, products and quotients of what a formula is made of: trees, and matrices of trees.

Input: values as they stand beside each other. Output: a tree in the shape that the text reader gives.
A determinant and an inverse are written out by minors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final, NoReturn

from symflex.errors import Span
from symflex.expressions import (
    Expression,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    is_longer,
    is_number,
    product_of,
    sum_of,
)

LARGEST_MATRIX: Final = 4  # whose determinant is expanded
MOST_PARTS: Final = 20_000  # of a product of matrices, or of a determinant


@dataclass(frozen=True, slots=True)
class Matrix:
    """Rows of trees."""

    rows: tuple[tuple[Expression, ...], ...]
    span: Span


Value = Expression | Matrix

Refuse = Callable[[str], NoReturn]
"""Raises the error for what is not read, at its place."""


def unsigned(node: Expression) -> Expression:
    """Return a tree without the sign in front."""
    return node.operand if isinstance(node, Negative) else node


def flat_product(parts: Sequence[Expression], span: Span | None = None) -> Expression:
    """Return the product of trees; products among them are not nested."""
    flat = [f for p in parts for f in (p.factors if isinstance(p, Product) else (p,))]
    return Product(tuple(flat), span=span) if len(flat) > 1 else flat[0]


def mapped(value: Value, change: Callable[[Expression], Expression]) -> Value:
    """Return a value with every tree changed."""
    if isinstance(value, Expression):
        return change(value)
    return replace(value, rows=tuple(tuple(map(change, row)) for row in value.rows))


def negated(value: Value) -> Value:
    """Return a value with the other sign."""
    return mapped(value, lambda x: Negative(x, span=x.span))


def sum_of_values(terms: Sequence[Value], span: Span, refuse: Refuse) -> Value:
    """Return the sum of trees, or of matrices entry by entry."""
    if len(terms) == 1:
        return terms[0]
    matrices = [t for t in terms if isinstance(t, Matrix)]
    if matrices:
        sizes = {(len(m.rows), len(m.rows[0])) for m in matrices}
        if len(matrices) != len(terms) or len(sizes) > 1:
            refuse("matrices of different sizes cannot be added")
        rows = zip(*(m.rows for m in matrices), strict=True)
        cells = (tuple(_sum(entries, span) for entries in zip(*same, strict=True)) for same in rows)
        return Matrix(tuple(cells), span)
    return _sum([x for x in terms if isinstance(x, Expression)], span)


def _sum(terms: Sequence[Expression], span: Span) -> Expression:
    flat = [t for x in terms for t in (x.terms if isinstance(x, Sum) else (x,))]
    return Sum(tuple(flat), span=span)


def product_of_values(a: Value, b: Value, span: Span, refuse: Refuse) -> Value:
    """Return the product of trees, of matrices, or of one of each."""
    if isinstance(a, Matrix) and isinstance(b, Matrix):
        if len(a.rows[0]) != len(b.rows):
            refuse("matrices of these sizes cannot be multiplied")
        columns = list(zip(*b.rows, strict=True))
        rows = [
            tuple(sum_of(product_of(pair) for pair in zip(row, column, strict=True)) for column in columns)
            for row in a.rows
        ]
        if is_longer([e for row in rows for e in row], MOST_PARTS):
            refuse("this product of matrices is too long to be written out")
        whole = Matrix(tuple(rows), span)
        return whole.rows[0][0] if len(rows) == 1 and len(rows[0]) == 1 else whole
    if isinstance(a, Matrix) or isinstance(b, Matrix):
        matrix, factor = (a, b) if isinstance(a, Matrix) else (b, a)
        assert isinstance(matrix, Matrix) and isinstance(factor, Expression)
        return mapped(matrix, lambda x: flat_product([factor, x], span))
    return flat_product([a, b], span)


def quotient_of_values(a: Value, b: Value, span: Span, refuse: Refuse) -> Value:
    """Return a tree or a matrix over a tree."""
    if isinstance(b, Matrix):
        refuse("a quotient by a matrix is not read")
    if is_number(b, 0):
        refuse("a formula divides by zero")
    return mapped(a, lambda x: Quotient(x, b, span=span))


def power_of_value(base: Value, exponent: Expression, span: Span, refuse: Refuse) -> Expression:
    """Return a power of a tree."""
    if isinstance(base, Matrix):
        refuse("a power of a matrix is not read")
    return Power(base, exponent, span=span)


def determinant_of(rows: Sequence[Sequence[Expression]]) -> Expression:
    """Return the determinant of rows, by the minors of the first."""
    if len(rows) == 1:
        return rows[0][0]
    terms: list[Expression] = []
    for k, entry in enumerate(rows[0]):
        if is_number(entry, 0):
            continue
        minor = determinant_of([[*row[:k], *row[k + 1 :]] for row in rows[1:]])
        term = flat_product([entry, minor])
        terms.append(Negative(term) if k % 2 else term)
    return sum_of(terms)


def inverse_of(value: Matrix, refuse: Refuse) -> Matrix:
    """Return the inverse of a matrix, by its minors."""
    rows, size = value.rows, len(value.rows)
    if size != len(rows[0]) or size > LARGEST_MATRIX:
        refuse("the inverse of this matrix is not read")
    if is_longer([e for row in rows for e in row], MOST_PARTS // 24):
        refuse("the inverse of this matrix is too long to be written out")
    whole = determinant_of(rows)
    if is_number(whole, 0):
        refuse("this matrix has no inverse")

    def entry(i: int, k: int) -> Expression:
        minor = [[*row[:i], *row[i + 1 :]] for j, row in enumerate(rows) if j != k]
        inner = determinant_of(minor) if minor else Number(Fraction(1))
        return Quotient(Negative(inner) if (i + k) % 2 else inner, whole, span=value.span)

    return Matrix(tuple(tuple(entry(i, k) for k in range(size)) for i in range(size)), value.span)


def transposed(value: Matrix) -> Matrix:
    """Return a matrix with rows in place of columns."""
    return replace(value, rows=tuple(zip(*value.rows, strict=True)))
