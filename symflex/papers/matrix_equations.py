r"""Equations of matrices and vectors that a paper names, written out row by row.

Input: the equations of a paper. Output: the same with every matrix in place of its name.

    \dot{x} = Ax + Bu,  A = [0, 1; -k/m, 0],  B = [0; 1/m]      x_1' = x_2,  x_2' = -k/m*x_1 + 1/m*u

What a matrix multiplies is a vector, whose entries are x_1, x_2 where the paper gives them no names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import NoReturn

from symflex.expressions import (
    Derivative,
    Expression,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    is_number,
    names,
    number,
    product_of,
    sum_of,
)
from symflex.papers.formula import read_value
from symflex.papers.matrices import (
    Matrix,
    Value,
    inverse_of,
    mapped,
    negated,
    product_of_values,
    quotient_of_values,
    transposed,
)
from symflex.papers.source import (
    MATRICES,
    LatexToken,
    PrintedEquation,
    environment,
    group_end,
    refusal,
    with_depth,
)
from symflex.papers.symbols import PaperNotation

TRANSPOSED = ("T", "top")  # what is typed as the power of a matrix
PLAIN = MATRICES - {"vmatrix", "Vmatrix"}  # matrices that are no determinants
LITERAL = "matrix"  # how a matrix is named that stands in an equation


@dataclass
class NamedMatrices:
    """The matrices and vectors of a paper."""

    values: dict[str, Value] = field(default_factory=dict)  # zero stands for a matrix of zeros

    def read(self, equation: PrintedEquation, notation: PaperNotation) -> list[Value]:
        """Return the sides of an equation; matrices in it have names, as those outside have."""
        return [read_value(self._without_literals(side, notation), notation) for side in equation.sides]

    def takes(self, sides: Sequence[Value], equation: PrintedEquation) -> bool:
        """Keep what an equation says a matrix is; tell whether it is one that does."""
        left, right = sides[0], sides[-1]
        if not isinstance(left, Name) or not isinstance(right, Expression) or left.name in self.values:
            return False
        if is_number(right, 0):
            self.values[left.name] = number(0)
        if not self._held([right]):
            return False
        rows = _RowWriter(self.values, equation)
        rows.name_vectors(right)
        value = rows.value(right) if rows.known == self.values else right
        if isinstance(value, Matrix):
            self.values[left.name] = value
        return isinstance(value, Matrix)

    def written_out(self, sides: Sequence[Value], equation: PrintedEquation) -> list[Value]:
        """Return the sides of an equation with matrices in place of their names."""
        if not any(_is_operator(self.values[name]) for name in self._held(sides)):
            return list(sides)
        rows = _RowWriter(self.values, equation)
        trees = [side for side in sides if isinstance(side, Expression)]
        for tree in trees:
            rows.name_vectors(tree)
        return [rows.in_rows(side) if isinstance(side, Expression) else side for side in sides]

    def _held(self, sides: Sequence[Value]) -> set[str]:
        trees = [side for side in sides if isinstance(side, Expression)]
        held = {node.name for tree in trees for node in names(tree)}
        return {name for name in self.values if held & {name, *(f"{name}_{t}" for t in TRANSPOSED)}}

    def _without_literals(self, side: Sequence[LatexToken], notation: PaperNotation) -> list[LatexToken]:
        """Return tokens with a name in place of each matrix that is no determinant."""
        out: list[LatexToken] = []
        at = 0
        while at < len(side):
            token = side[at]
            before = out[-1].text if out else ""
            is_matrix = token.text == r"\begin" and environment(side, at)[0] in PLAIN
            if not is_matrix or before in ("|", r"\vert", r"\lvert", r"\det"):
                out.append(token)
                at += 1
                continue
            end = at + 1 + next(i for i, (_, depth) in enumerate(with_depth(side[at:])) if i and not depth)
            end = group_end(side, end)
            name = LITERAL + "".join(chr(ord("a") + int(digit)) for digit in str(len(self.values)))
            self.values[name] = read_value(side[at:end], notation)
            out += [token._replace(text=text) for text in (r"\mathrm", "{", *name, "}")]
            at = end
        return out


def _is_operator(value: Value) -> bool:
    """Tell whether a value is a matrix, and no vector of signals."""
    if isinstance(value, Expression):
        return False
    return not all(isinstance(entry, Name | Derivative) for row in value.rows for entry in row)


class _RowWriter:
    """Writes out the sides of one equation."""

    def __init__(self, known: Mapping[str, Value], equation: PrintedEquation) -> None:
        self.known, self.equation = dict(known), equation
        self.rows = 0  # of the equation

    def refuse(self, message: str) -> NoReturn:
        raise refusal(self.equation.span, message, "write the equations out, a line for each row")

    def name_vectors(self, node: Expression) -> None:
        """Name the entries of what a matrix multiplies, and count the rows of the equation."""
        if isinstance(node, Product):
            size, first = 0, 0
            for factor in node.factors:
                matrix = self._matrix(factor)
                if matrix is not None:
                    first, size = first or len(matrix.rows), len(matrix.rows[0])
                elif isinstance(factor, Name | Derivative) and size:
                    self.known.setdefault(factor.name, _vector(factor.name, size, self.equation))
                    size = 0
            self.rows = self.rows or first
        elif isinstance(node, Sum | Negative):
            for child in node.children:
                self.name_vectors(child)

    def in_rows(self, node: Expression) -> Value:
        """Return a side; what stands alone in a term has as many rows as the equation."""
        for term in node.terms if isinstance(node, Sum) else (node,):
            bare = term.operand if isinstance(term, Negative) else term
            if isinstance(bare, Name | Derivative) and self.rows > 1:
                self.known.setdefault(bare.name, _vector(bare.name, self.rows, self.equation))
        return self.value(node)

    def _matrix(self, node: Expression) -> Matrix | None:
        if isinstance(node, Derivative):
            return None
        value = self.value(node) if isinstance(node, Name | Power) else None
        return value if isinstance(value, Matrix) else None

    def value(self, node: Expression) -> Value:
        """Return a tree with matrices in place of their names."""
        span = self.equation.span
        match node:
            case Name(name):
                stem, _, typed = name.rpartition("_")
                if typed in TRANSPOSED and isinstance(known := self.known.get(stem), Matrix):
                    return transposed(known)
                return self.known.get(name, node)
            case Derivative(name, order):
                known = self.known.get(name, node)
                return node if known is node else mapped(known, lambda entry: self._derived(entry, order))
            case Negative(operand):
                return negated(self.value(operand))
            case Sum(terms):
                return self._sum([self.value(term) for term in terms], terms)
            case Product(factors):
                return reduce(self._product, map(self.value, factors))
            case Quotient(above, below):
                return quotient_of_values(self.value(above), self.value(below), span, self.refuse)
            case Power(base, exponent):
                inner = self.value(base)
                if not isinstance(inner, Matrix):
                    return node
                if isinstance(exponent, Name) and exponent.name in TRANSPOSED:
                    return transposed(inner)
                if isinstance(exponent, Negative) and is_number(exponent.operand, 1):
                    return inverse_of(inner, self.refuse)
                self.refuse("a power of a matrix other than its inverse is not read")
        return node

    def _sum(self, values: Sequence[Value], terms: Sequence[Expression]) -> Value:
        matrices = [value for value in values if isinstance(value, Matrix)]
        if not matrices:
            return sum_of(value for value in values if isinstance(value, Expression))
        for value, term in zip(values, terms, strict=True):
            if isinstance(value, Expression) and not is_number(value, 0):
                said = f"the term {format_expression(term)} stands beside matrices and has no rows"
                self.refuse(f"an equation of matrices is not read: {said}")
        if len({(len(one.rows), len(one.rows[0])) for one in matrices}) > 1:
            self.refuse("matrices of different sizes cannot be added")
        rows = zip(*(one.rows for one in matrices), strict=True)
        sums = (tuple(map(sum_of, zip(*same, strict=True))) for same in rows)
        return Matrix(tuple(sums), self.equation.span)

    def _product(self, first: Value, second: Value) -> Value:
        if isinstance(first, Matrix):
            if isinstance(second, Matrix):
                return product_of_values(first, second, self.equation.span, self.refuse)
            factor = second
            return mapped(first, lambda entry: product_of((entry, factor)))
        return mapped(second, lambda entry: product_of((first, entry)))

    def _derived(self, entry: Expression, order: int) -> Expression:
        if isinstance(entry, Name):
            return Derivative(entry.name, order, span=entry.span)
        if isinstance(entry, Derivative):
            return replace(entry, order=entry.order + order)
        self.refuse("a derivative of this vector is not read")


def _vector(name: str, size: int, equation: PrintedEquation) -> Value:
    if size == 1:
        return Name(name, span=equation.span)
    return Matrix(tuple((Name(f"{name}_{i + 1}", span=equation.span),) for i in range(size)), equation.span)
