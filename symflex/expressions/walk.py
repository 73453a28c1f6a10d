"""Walks over a tree: parts are listed, replaced, and folded into a value."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from operator import add, mul, neg, truediv
from typing import TYPE_CHECKING, Any, TypeVar

from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
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
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

Value = TypeVar("Value")


def names(expression: Expression) -> tuple[Name | Attribute | Call | Derivative, ...]:
    """Return every node of a tree, or an equation, that bears a name, in order and as often as it appears.

    A call stands before the names in its argument.

    Examples
    --------
    >>> x = Name("x")
    >>> names(Sum((Call("sin", x), Attribute("motor", "i"), x)))  # doctest: +NORMALIZE_WHITESPACE
    (Call(name='sin', argument=Name(name='x'), order=0), Name(name='x'), Attribute(owner='motor', name='i'),
     Name(name='x'))
    """
    return tuple(n for n in nodes(expression) if isinstance(n, Name | Attribute | Call | Derivative))


def measured(expression: Expression) -> tuple[Measured, ...]:
    """Return every number with a unit, in order of appearance."""
    return tuple(n for n in nodes(expression) if isinstance(n, Measured))


def nodes(expression: Expression) -> list[Expression]:
    """Return an expression and all its parts, in order of appearance, each before its own parts."""
    found: list[Expression] = []
    pending = [expression]
    while pending:
        node = pending.pop()
        found.append(node)
        pending.extend(reversed(node.children))
    return found


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

    What is not given is done with Python's operators, sums from zero and products from one.

    Parameters
    ----------
    number : callable
        Of the value of a number.
    name : callable
        Of a name, or of ``owner.name`` for an attribute.
    power : callable
        Of the base's value and the exponent, which is left as it is written.
    call : callable
        Of a call and its argument's value.
    negative, total, product, quotient : callable, optional
        Of values.

    Raises
    ------
    TypeError
        On what has no value by itself, such as an equation.

    Examples
    --------
    >>> x = Name("x")
    >>> fold(Sum((Power(x, Number(Fraction(2))), Negative(x))), number=Fraction, name={"x": Fraction(3)}.get,
    ...      power=lambda base, exponent: base**exponent.value, call=lambda call, argument: argument)
    Fraction(6, 1)
    """

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
                values = [value(t) for t in terms]
                return total(values) if total is not None else reduce(add, values, number(Fraction(0)))
            case Product(factors):
                values = [value(f) for f in factors]
                return product(values) if product is not None else reduce(mul, values, number(Fraction(1)))
            case Quotient(above, below):
                return quotient(value(above), value(below))
            case Power(base, exponent):
                return power(value(base), exponent)
            case Call(_, argument):
                return call(node, value(argument))
        message = f"unexpected expression {type(node).__name__}"
        raise TypeError(message)

    return value(expression)


def substitute(expression: Expression, mapping: Mapping[str, Expression]) -> Expression:
    """Replace names by expressions, all at once: what is put in is not searched again.

    Names are given as ``name``, or ``owner.name`` for an attribute; those of functions and fields stay. The
    new tree is flat like every tree and otherwise not simplified; parts without a replaced name are the same
    objects as before, and rebuilt parts keep their place in the text.

    Examples
    --------
    >>> a, b, c = Name("a"), Name("b"), Name("c")
    >>> substitute(Sum((a, c)), {"a": Sum((b, c)), "c": a})
    Sum(terms=(Name(name='b'), Name(name='c'), Name(name='a')))
    """
    return _replaced(expression, lambda node: _replacement(node, mapping))


def replace_values(expression: Expression, mapping: Mapping[Call, Expression]) -> Expression:
    """Replace values of fields at points by expressions.

    Examples
    --------
    >>> value = Call("w", Name("l"))
    >>> replace_values(Sum((value, Name("x"))), {value: Name("tip")})
    Sum(terms=(Name(name='tip'), Name(name='x')))
    """
    return _replaced(expression, lambda node: mapping.get(node, node) if isinstance(node, Call) else node)


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
            done.append(node if is_same else _rebuilt(node, after))
    return done[0]


def _replacement(node: Expression, mapping: Mapping[str, Expression]) -> Expression:
    match node:
        case Name(name=name):
            return mapping.get(name, node)
        case Attribute(owner=owner, name=name):
            return mapping.get(f"{owner}.{name}", node)
        case _:
            return node


def _rebuilt(node: Expression, children: Sequence[Expression]) -> Expression:
    span = node.span
    match node:
        case Sum():
            return Sum(tuple(_flat(children, Sum)), span=span)
        case Product():
            return Product(tuple(_flat(children, Product)), span=span)
        case Call(name=name, order=order):
            return Call(name, children[0], order, span=span)
        case Negative():
            return Negative(children[0], span=span)
        case Quotient():
            return Quotient(children[0], children[1], span=span)
        case Power():
            return Power(children[0], children[1], span=span)
        case Equation():
            return Equation(children[0], children[1], span=span)
        case _:
            raise TypeError(f"{type(node).__name__} has no operands to replace")


def _flat(children: Sequence[Expression], kind: type[Expression]) -> list[Expression]:
    flat: list[Expression] = []
    for child in children:
        flat.extend(child.children if isinstance(child, kind) else (child,))
    return flat
