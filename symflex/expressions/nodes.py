"""The syntax tree of an expression: immutable, n-ary, with positions that do not take part in equality."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
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
