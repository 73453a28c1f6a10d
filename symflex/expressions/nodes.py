"""The syntax tree of an expression: immutable, n-ary, with positions that do not take part in equality.

Constructors keep trees in the shape the parser gives them and the printers expect: sums and products are
flat, zeros and ones disappear, minus signs stand outside products, quotients and integer powers, and numbers
in one product are multiplied. Nothing else is simplified: like terms stay apart, and a quotient or power of
numbers stays what it is.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from symflex.errors import Span
    from symflex.quantities import Quantity


@dataclass(frozen=True, slots=True)
class Expression:
    """Base of all nodes; ``span`` is where the node was written, if it was written."""

    span: Span | None = field(default=None, kw_only=True, compare=False, repr=False)

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right; empty for a leaf."""
        return ()


@dataclass(frozen=True, slots=True)
class Number(Expression):
    """An exact non-negative rational number; a negative one is a ``Negative``."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Measured(Number):
    """A length with its unit, as points along x have them: ``0.3 m``; ``value`` is in SI units."""

    quantity: Quantity = field(kw_only=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name(Expression):
    """A parameter, node, signal, input, definition, block, ``s`` or ``pi``."""

    name: str


@dataclass(frozen=True, slots=True)
class Attribute(Expression):
    """A quantity of an element or of a planar node: ``motor.i``, ``tip.theta``."""

    owner: str
    name: str


@dataclass(frozen=True, slots=True)
class Call(Expression):
    """A function of one argument ``sqrt(x)``, or a field evaluated at a point ``w''(l)`` (order 2).

    A quantity of an element at a point, ``arm.y(l/2)``, bears both names: ``"arm.y"``.
    """

    name: str
    argument: Expression
    order: int = 0

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.argument,)


@dataclass(frozen=True, slots=True)
class Derivative(Expression):
    """A field differentiated along x and not evaluated: ``w''''`` (order 4)."""

    name: str
    order: int


@dataclass(frozen=True, slots=True)
class Negative(Expression):
    """Minus its operand."""

    operand: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.operand,)


@dataclass(frozen=True, slots=True)
class Sum(Expression):
    """A sum of two or more terms; ``a - b`` is ``Sum((a, Negative(b)))``."""

    terms: tuple[Expression, ...]

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return self.terms


@dataclass(frozen=True, slots=True)
class Product(Expression):
    """A product of two or more factors."""

    factors: tuple[Expression, ...]

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return self.factors


@dataclass(frozen=True, slots=True)
class Quotient(Expression):
    """A numerator over a denominator."""

    numerator: Expression
    denominator: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.numerator, self.denominator)


@dataclass(frozen=True, slots=True)
class Power(Expression):
    """A base raised to an exponent."""

    base: Expression
    exponent: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.base, self.exponent)


@dataclass(frozen=True, slots=True)
class Equation(Expression):
    """``left = right``, as fields write differential equations and conditions."""

    left: Expression
    right: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.left, self.right)


def number(value: Fraction | int) -> Expression:
    """Return a number; a negative one is minus a positive one.

    Examples
    --------
    >>> number(-2)
    Negative(operand=Number(value=Fraction(2, 1)))
    """
    exact = Fraction(value)
    return Number(exact) if exact >= 0 else Negative(Number(-exact))


def sum_of(terms: Iterable[Expression]) -> Expression:
    """Return the sum of any number of terms, in order; of none, zero.

    Examples
    --------
    >>> from symflex.expressions.nodes import Name
    >>> sum_of([Name("a"), number(0), Sum((Name("b"), Name("c")))])
    Sum(terms=(Name(name='a'), Name(name='b'), Name(name='c')))
    """
    flat: list[Expression] = []
    pending = list(terms)[::-1]
    while pending:
        is_negative, term = _signed(pending.pop())
        if isinstance(term, Sum) and not is_negative:
            pending.extend(reversed(term.terms))
        elif not is_number(term, 0):
            flat.append(Negative(term) if is_negative else term)
    if not flat:
        return number(0)
    return Sum(tuple(flat)) if len(flat) > 1 else flat[0]


def product_of(factors: Iterable[Expression]) -> Expression:
    """Return the product of any number of factors, its numbers gathered in front; of none, one.

    Examples
    --------
    >>> from symflex.expressions.nodes import Name
    >>> product_of([Name("a"), number(-2), Name("b"), number(3)])
    Negative(operand=Product(factors=(Number(value=Fraction(6, 1)), Name(name='a'), Name(name='b'))))
    """
    coefficient = Fraction(1)
    flat: list[Expression] = []
    pending = list(factors)[::-1]
    while pending:
        is_negative, factor = _signed(pending.pop())
        if is_negative:
            coefficient = -coefficient
        if isinstance(factor, Product):
            pending.extend(reversed(factor.factors))
        elif isinstance(factor, Number):
            coefficient *= factor.value
        else:
            flat.append(factor)
    if not flat or coefficient == 0:
        return number(coefficient)
    if abs(coefficient) != 1:
        flat.insert(0, Number(abs(coefficient)))
    product = Product(tuple(flat)) if len(flat) > 1 else flat[0]
    return Negative(product) if coefficient < 0 else product


def quotient(numerator: Expression, denominator: Expression) -> Expression:
    """Return a quotient, with the sign of both parts in front.

    Raises
    ------
    ZeroDivisionError
        When the denominator is the number zero.

    Examples
    --------
    >>> from symflex.expressions.nodes import Name
    >>> quotient(number(-1), Name("s"))
    Negative(operand=Quotient(numerator=Number(value=Fraction(1, 1)), denominator=Name(name='s')))
    """
    above_is_negative, above = _signed(numerator)
    below_is_negative, below = _signed(denominator)
    if is_number(below, 0):
        raise ZeroDivisionError("the denominator is zero")
    if is_number(above, 0):
        return above
    whole = above if is_number(below, 1) else Quotient(above, below)
    return whole if above_is_negative == below_is_negative else Negative(whole)


def power(base: Expression, exponent: Expression | int) -> Expression:
    """Return a power; the sign of the base leaves it when the exponent is an integer.

    ``x^0`` is 1 for every x, as in polynomials.

    Raises
    ------
    ZeroDivisionError
        When the base is the number zero and the exponent a negative number.

    Examples
    --------
    >>> from symflex.expressions.nodes import Name
    >>> power(negative(Name("s")), 3)
    Negative(operand=Power(base=Name(name='s'), exponent=Number(value=Fraction(3, 1))))
    """
    exponent_is_negative, size = _signed(number(exponent) if isinstance(exponent, int) else exponent)
    if is_number(size, 0):
        return number(1)
    base_is_negative, root = _signed(base)
    if isinstance(size, Number) and is_number(root, 0):
        if exponent_is_negative:
            raise ZeroDivisionError("a negative power of zero")
        return root
    is_integer = isinstance(size, Number) and size.value.denominator == 1
    if base_is_negative and not is_integer:
        root = Negative(root)
    is_odd = is_integer and isinstance(size, Number) and size.value.numerator % 2 == 1
    if is_number(root, 1) or (is_number(size, 1) and not exponent_is_negative):
        raised = root
    else:
        raised = Power(root, Negative(size) if exponent_is_negative else size)
    return Negative(raised) if base_is_negative and is_odd else raised


def negative(operand: Expression) -> Expression:
    """Return minus an expression; minus minus x is x, minus zero is zero.

    Examples
    --------
    >>> from symflex.expressions.nodes import Name
    >>> negative(negative(Name("a")))
    Name(name='a')
    """
    is_negative, inner = _signed(operand)
    return inner if is_negative or is_number(inner, 0) else Negative(inner)


def _signed(expression: Expression) -> tuple[bool, Expression]:
    """Split all leading minus signs off an expression."""
    is_negative = False
    while isinstance(expression, Negative):
        is_negative, expression = not is_negative, expression.operand
    if isinstance(expression, Number) and expression.value < 0:
        is_negative, expression = not is_negative, Number(-expression.value)
    return is_negative, expression


def is_number(expression: Expression, value: Fraction | int) -> bool:
    """Tell whether an expression is a given number, as one in the denominator of what has none."""
    return isinstance(expression, Number) and expression.value == value
