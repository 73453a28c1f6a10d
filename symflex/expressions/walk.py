"""Walks over a tree, none of them recursive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
    Equation,
    Expression,
    Measured,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def names(expression: Expression) -> tuple[Name | Attribute | Call | Derivative, ...]:
    """Return every node that bears a name, in order of appearance, as often as it appears.

    Parameters
    ----------
    expression : Expression
        A tree; an :class:`Equation` too.

    Returns
    -------
    tuple of Name, Attribute, Call or Derivative
        A call stands before the names in its argument.

    Examples
    --------
    >>> x = Name("x")
    >>> names(Sum((Call("sin", x), Attribute("motor", "i"), x)))  # doctest: +NORMALIZE_WHITESPACE
    (Call(name='sin', argument=Name(name='x'), order=0), Name(name='x'), Attribute(owner='motor', name='i'),
     Name(name='x'))
    """
    found: list[Name | Attribute | Call | Derivative] = []
    pending = [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Name | Attribute | Call | Derivative):
            found.append(node)
        pending.extend(reversed(node.children))
    return tuple(found)


def measured(expression: Expression) -> tuple[Measured, ...]:
    """Return every number with a unit, in order of appearance."""
    found: list[Measured] = []
    pending = [expression]
    while pending:
        node = pending.pop()
        if isinstance(node, Measured):
            found.append(node)
        pending.extend(reversed(node.children))
    return tuple(found)


def substitute(expression: Expression, mapping: Mapping[str, Expression]) -> Expression:
    """Replace names by expressions, all at once: what is put in is not searched again.

    Parameters
    ----------
    expression : Expression
        A tree; an :class:`Equation` too.
    mapping : Mapping of str to Expression
        From a name, or from ``owner.name`` for an attribute. Names of functions and fields are not replaced.

    Returns
    -------
    Expression
        The new tree, flat like every tree and otherwise not simplified. Parts without a replaced name are the
        same objects as before; rebuilt parts keep their place in the text.

    Examples
    --------
    >>> a, b, c = Name("a"), Name("b"), Name("c")
    >>> substitute(Sum((a, c)), {"a": Sum((b, c)), "c": a})
    Sum(terms=(Name(name='b'), Name(name='c'), Name(name='a')))
    """
    done: list[Expression] = []
    pending: list[tuple[Expression, bool]] = [(expression, False)]
    while pending:
        node, is_ready = pending.pop()
        before = node.children
        if not before:
            done.append(_replacement(node, mapping))
        elif not is_ready:
            pending.append((node, True))
            pending.extend((child, False) for child in reversed(before))
        else:
            after = done[-len(before) :]
            del done[-len(before) :]
            is_same = all(old is new for old, new in zip(before, after, strict=True))
            done.append(node if is_same else _rebuilt(node, after))
    return done[0]


def replace_values(expression: Expression, mapping: Mapping[Call, Expression]) -> Expression:
    """Replace values of fields at points by expressions.

    Examples
    --------
    >>> value = Call("w", Name("l"))
    >>> replace_values(Sum((value, Name("x"))), {value: Name("tip")})
    Sum(terms=(Name(name='tip'), Name(name='x')))
    """
    if isinstance(expression, Call) and expression in mapping:
        return mapping[expression]
    if not expression.children:
        return expression
    return _rebuilt(expression, [replace_values(child, mapping) for child in expression.children])


def _replacement(leaf: Expression, mapping: Mapping[str, Expression]) -> Expression:
    match leaf:
        case Name(name=name):
            return mapping.get(name, leaf)
        case Attribute(owner=owner, name=name):
            return mapping.get(f"{owner}.{name}", leaf)
        case _:
            return leaf


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
