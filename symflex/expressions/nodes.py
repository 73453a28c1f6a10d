"""The syntax tree of an expression: immutable, n-ary, with positions that do not take part in equality.

Constructors keep trees in the shape the parser gives them and the printers expect: sums and products are
flat, zeros and ones disappear, minus signs stand outside products, quotients and integer powers, and numbers
in one product are multiplied. Nothing else is simplified: like terms stay apart, and a quotient or power of
numbers stays what it is. Walks over a tree list its parts, replace them, and fold them into a value.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from functools import reduce, wraps
from operator import add, attrgetter, mul, neg, truediv
from typing import Any, TypeVar, dataclass_transform

from symflex.errors import Span
from symflex.quantities import Quantity

Node = TypeVar("Node")


class _Remembering:
    """Where a node keeps what is found of it once; it takes no part in equality, nor in what is pickled."""

    __slots__ = ("_hash", "facts")
    facts: dict[Callable[[Any], Any], Any]
    _hash: int


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def _node(kind: type[Node]) -> type[Node]:
    """Make a frozen dataclass whose instances find their hash, which their parts take part in, once."""
    made = dataclass(frozen=True, slots=True)(kind)
    values = attrgetter(*(each.name for each in fields(made) if each.compare))  # type: ignore[arg-type]

    def remembered(self: _Remembering) -> int:
        try:
            return self._hash
        except AttributeError:
            pass
        object.__setattr__(self, "_hash", own := hash(values(self)))
        return own

    made.__hash__ = remembered  # type: ignore[assignment, method-assign]
    return made


@dataclass(frozen=True, slots=True)
class Expression(_Remembering):
    """Base of all nodes; ``span`` is where the node was written, if it was written."""

    span: Span | None = field(default=None, kw_only=True, compare=False, repr=False)

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right; empty for a leaf."""
        return ()


@_node
class Number(Expression):
    """An exact non-negative rational number; a negative one is a ``Negative``."""

    value: Fraction


@_node
class Measured(Number):
    """A length with its unit, as points along x have them: ``0.3 m``; ``value`` is in SI units."""

    quantity: Quantity = field(kw_only=True, compare=False, repr=False)


@_node
class Name(Expression):
    """A parameter, node, signal, input, definition, block, ``s`` or ``pi``."""

    name: str


@_node
class Attribute(Expression):
    """A quantity of an element or of a planar node: ``motor.i``, ``tip.theta``."""

    owner: str
    name: str


@_node
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


@_node
class Bessel(Call):
    """A Bessel function, as formulas that are derived have them: ``J_0(q)``; none is read."""

    kind: str = field(kw_only=True)  # J, Y, I or K; the name may begin otherwise where that is taken
    index: Fraction = field(kw_only=True)

    @property
    def latex(self) -> str:
        """The function's label."""
        letter = self.kind if self.name.startswith(f"{self.kind}_") else rf"\mathrm{{{self.kind}}}"
        return f"{letter}_{{{self.index}}}"


@_node
class Derivative(Expression):
    """A field differentiated along x and not evaluated: ``w''''`` (order 4)."""

    name: str
    order: int


@_node
class Differentiated(Expression):
    """A bracket differentiated along x, ``(E*I*w'')''``, and perhaps taken at a point, ``(E*I*w'')'(l)``.

    Where fields are read it is opened, see :mod:`symflex.model.brackets`; nothing beyond meets one.
    """

    operand: Expression
    order: int
    point: Expression | None = None

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.operand,) if self.point is None else (self.operand, self.point)


@_node
class Negative(Expression):
    """Minus its operand."""

    operand: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.operand,)


@_node
class Sum(Expression):
    """A sum of two or more terms; ``a - b`` is ``Sum((a, Negative(b)))``."""

    terms: tuple[Expression, ...]

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return self.terms


@_node
class Product(Expression):
    """A product of two or more factors."""

    factors: tuple[Expression, ...]

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return self.factors


@_node
class Quotient(Expression):
    """A numerator over a denominator."""

    numerator: Expression
    denominator: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.numerator, self.denominator)


@_node
class Power(Expression):
    """A base raised to an exponent."""

    base: Expression
    exponent: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.base, self.exponent)


@_node
class Equation(Expression):
    """``left = right``, as fields write differential equations and conditions."""

    left: Expression
    right: Expression

    @property
    def children(self) -> tuple[Expression, ...]:
        """The operands, from left to right."""
        return (self.left, self.right)


def number(value: Fraction | int) -> Expression:
    """Return a number; a negative one is minus a positive one."""
    exact = Fraction(value)
    return Number(exact) if exact.numerator >= 0 else Negative(Number(-exact))


def sum_of(terms: Iterable[Expression]) -> Expression:
    """Return the sum of any number of terms, in order; of none, zero."""
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
    """Return the product of any number of factors, its numbers gathered in front; of none, one."""
    coefficient: Fraction | int = 1
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
    if coefficient not in (1, -1):
        flat.insert(0, Number(abs(Fraction(coefficient))))
    product = Product(tuple(flat)) if len(flat) > 1 else flat[0]
    return Negative(product) if coefficient < 0 else product


def quotient(numerator: Expression, denominator: Expression) -> Expression:
    """Return a quotient, with the sign of both parts in front; it may raise ZeroDivisionError."""
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

    ``x^0`` is 1 for every x, as in polynomials. It may raise ZeroDivisionError.
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
    """Return minus an expression; minus minus x is x, minus zero is zero."""
    is_negative, inner = _signed(operand)
    return inner if is_negative or is_number(inner, 0) else Negative(inner)


def _signed(expression: Expression) -> tuple[bool, Expression]:
    """Split all leading minus signs off an expression."""
    is_negative = False
    while isinstance(expression, Negative):
        is_negative, expression = not is_negative, expression.operand
    if isinstance(expression, Number) and expression.value.numerator < 0:
        is_negative, expression = not is_negative, Number(-expression.value)
    return is_negative, expression


def is_number(expression: Expression, value: Fraction | int) -> bool:
    """Tell whether an expression is a given number, as one in the denominator of what has none."""
    return isinstance(expression, Number) and expression.value == value


Value = TypeVar("Value")


def once(find: Callable[[Any], Value]) -> Callable[[Any], Value]:
    """Decorate a function of an expression: what it finds of a sum is kept there, as nodes do not change."""

    @wraps(find)
    def found(expression: Expression) -> Value:
        if type(expression) is not Sum:
            return find(expression)
        try:
            facts = expression.facts
        except AttributeError:
            object.__setattr__(expression, "facts", facts := {})
        if find not in facts:
            facts[find] = find(expression)
        value: Value = facts[find]
        return value

    return found


Named = Name | Attribute | Call | Derivative


def names(expression: Expression) -> tuple[Named, ...]:
    """Return every node of a tree, or an equation, that bears a name; calls before their arguments."""
    return tuple(n for n in nodes(expression) if isinstance(n, Named))


def _below(expression: Expression) -> set[Expression]:
    """Return the different parts of a sum, or of what is none and itself; sums in it are not opened."""
    found = set[Expression]()
    new = {*expression.terms} if isinstance(expression, Sum) else {expression}
    while new:
        found |= new
        new = set().union(*[node.children for node in new if type(node) is not Sum]) - found
    return found


@once
def names_in(expression: Expression) -> frozenset[Named]:
    """Return what :func:`names` does, each once."""
    below = _below(expression)
    own = {n for n in below if isinstance(n, Named)}
    return frozenset(own).union(*[names_in(n) for n in below if type(n) is Sum])


@once
def sums_in(expression: Expression) -> frozenset[Sum]:
    """Return the different sums in an expression, which may be one itself."""
    inner = [n for n in _below(expression) if type(n) is Sum]
    own = (expression,) if isinstance(expression, Sum) else ()
    return frozenset(own).union(*map(sums_in, inner))


def is_longer(expressions: Iterable[Expression], most: int) -> bool:
    """Tell whether expressions have more parts than so many, without looking at all of these."""
    pending = [*expressions]
    while pending and most >= 0:
        most -= 1
        pending.extend(pending.pop().children)
    return most < 0


def names_among(expression: Expression, known: Container[str]) -> list[str]:
    """Return the names of a tree that are among those known, in order and as often as they appear."""
    return [n.name for n in names(expression) if isinstance(n, Name) and n.name in known]


def measured(expression: Expression) -> tuple[Measured, ...]:
    """Return every number with a unit, in order of appearance."""
    return tuple(n for n in nodes(expression) if isinstance(n, Measured))


def nodes(expression: Expression) -> list[Expression]:
    """Return an expression and all its parts, in order of appearance, each before its own parts."""
    visited: list[Expression] = []
    pending = [expression]
    while pending:
        node = pending.pop()
        visited.append(node)
        pending.extend(reversed(node.children))
    return visited


def fold(
    expression: Expression,
    *,
    number: Callable[[Fraction], Value],
    name: Callable[[str], Value],
    power: Callable[[Value, Expression], Value],
    call: Callable[[Call, Value], Value],
    negative: Callable[[Any], Value] = neg,
    total: Callable[[Sequence[Value]], Value] | None = None,
    product: Callable[[Sequence[Value]], Value] | None = None,
    quotient: Callable[[Value, Value], Value] = truediv,
) -> Value:
    """Return the value of an expression in some arithmetic, made from the values of its parts.

    What is not given is done with Python's operators, sums from zero and products from one. ``name`` takes a
    name, or ``owner.name`` for an attribute; ``power`` the base's value and the exponent, which is left as it
    is written; ``call`` a call and its argument's value; the others values. An equation has no value. A sum
    that is the same object in several places is valued once.

    >>> x = Name("x")
    >>> fold(Sum((Power(x, Number(Fraction(2))), Negative(x))), number=Fraction, name={"x": Fraction(3)}.get,
    ...      power=lambda base, exponent: base**exponent.value, call=lambda call, argument: argument)
    Fraction(6, 1)
    """
    sums: dict[int, Value] = {}

    def value(node: Expression) -> Value:
        match node:
            case Number(exact):
                return number(exact)
            case Name(own):
                return name(own)
            case Attribute(owner, own):
                return name(f"{owner}.{own}")
            case Negative(operand):
                return negative(value(operand))
            case Sum(terms):
                if id(node) not in sums:
                    values = [value(t) for t in terms]
                    whole = total(values) if total is not None else reduce(add, values, number(Fraction(0)))
                    sums[id(node)] = whole
                return sums[id(node)]
            case Product(factors):
                values = [value(f) for f in factors]
                return product(values) if product is not None else reduce(mul, values, number(Fraction(1)))
            case Quotient(above, below):
                return quotient(value(above), value(below))
            case Power(base, exponent):
                return power(value(base), exponent)
            case Call(_, argument):
                return call(node, value(argument))
        raise TypeError(f"unexpected expression {type(node).__name__}")

    return value(expression)


def substitute(expression: Expression, mapping: Mapping[str, Expression]) -> Expression:
    """Replace names by expressions, all at once: what is put in is not searched again.

    Names are given as ``name``, or ``owner.name`` for an attribute; those of functions and fields stay. The
    new tree is flat like every tree and otherwise not simplified; parts without a replaced name are the same
    objects as before, and rebuilt parts keep their place in the text.
    """

    def replacement(node: Expression) -> Expression:
        match node:
            case Name(name):
                return mapping.get(name, node)
            case Attribute(owner, name):
                return mapping.get(f"{owner}.{name}", node)
        return node

    return _replaced(expression, replacement)


def replace_values(expression: Expression, mapping: Mapping[Expression, Expression]) -> Expression:
    """Replace names, values of fields at points, derivatives along x, and brackets by expressions.

    >>> value = Call("w", Name("l"))
    >>> replace_values(Sum((value, Name("x"))), {value: Name("tip")})
    Sum(terms=(Name(name='tip'), Name(name='x')))
    """
    kinds = Name | Call | Derivative | Differentiated
    return _replaced(expression, lambda node: mapping.get(node, node) if isinstance(node, kinds) else node)


def replace_node(expression: Expression, old: Expression, new: Expression) -> Expression:
    """Replace every part of an expression that is equal to one.

    >>> power = Power(Name("x"), Number(Fraction(2)))
    >>> replace_node(Sum((power, Name("x"))), power, Name("y"))
    Sum(terms=(Name(name='y'), Name(name='x')))
    """
    return _replaced(expression, lambda node: new if node == old else node)


def _replaced(expression: Expression, new: Callable[[Expression], Expression]) -> Expression:
    done: list[Expression] = []
    pending: list[tuple[Expression, bool]] = [(expression, False)]
    while pending:
        node, is_ready = pending.pop()
        before = node.children
        if not is_ready and ((replacement := new(node)) is not node or not before):
            done.append(replacement)
        elif not is_ready:
            pending.append((node, True))
            pending.extend((child, False) for child in reversed(before))
        else:
            after = done[-len(before) :]
            del done[-len(before) :]
            is_same = all(old is new for old, new in zip(before, after, strict=True))
            done.append(node if is_same else with_children(node, after))
    return done[0]


def with_children(node: Expression, children: Sequence[Expression]) -> Expression:
    """Return a node with other operands, at its place in the text; sums and products stay flat."""
    span = node.span
    match node:
        case Sum():
            return Sum(tuple(_flat(children, Sum)), span=span)
        case Product():
            return Product(tuple(_flat(children, Product)), span=span)
        case Call():
            return replace(node, argument=children[0])
        case Differentiated(order=order):
            return Differentiated(children[0], order, children[1] if len(children) > 1 else None, span=span)
        case Negative() | Quotient() | Power() | Equation():
            return type(node)(*children, span=span)
        case _:
            raise TypeError(f"{type(node).__name__} has no operands to replace")


def _flat(children: Sequence[Expression], kind: type[Expression]) -> list[Expression]:
    opened = (child.children if isinstance(child, kind) else (child,) for child in children)
    return [each for group in opened for each in group]
