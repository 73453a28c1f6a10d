"""Expressions as SymPy objects, made only when a user asks for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy

from symflex.expressions import (
    FUNCTIONS,
    Attribute,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.model import Model


def symbols_of(model: Model) -> dict[str, sympy.Symbol]:
    """Return one SymPy symbol per parameter, with its assumption; others are made without any."""
    assumptions = {
        "positive": {"positive": True},
        "nonnegative": {"nonnegative": True},
        "real": {"real": True},
    }
    return {p.name: sympy.Symbol(p.name, **assumptions[p.assume]) for p in model.parameters}


def to_sympy(expression: Expression, symbols: Mapping[str, sympy.Symbol]) -> sympy.Expr:
    """Return an expression as a SymPy expression, in the same nesting.

    A name that ``symbols`` lack becomes a plain symbol. A function of x that only a differential equation
    determines becomes an undefined function, or its derivative at a point.

    Examples
    --------
    >>> from symflex.expressions import Name, Sum
    >>> to_sympy(Sum((Name("a"), Name("b"))), {})
    a + b
    """
    match expression:
        case Number(value):
            return sympy.Rational(value.numerator, value.denominator)
        case Name("pi"):
            return sympy.pi
        case Name(name):
            return symbols[name] if name in symbols else sympy.Symbol(name)
        case Attribute(owner, name):
            return sympy.Symbol(f"{owner}.{name}")
        case Negative(operand):
            return -to_sympy(operand, symbols)
        case Sum(terms):
            return sympy.Add(*(to_sympy(t, symbols) for t in terms))
        case Product(factors):
            return sympy.Mul(*(to_sympy(f, symbols) for f in factors))
        case Quotient(numerator, denominator):
            return to_sympy(numerator, symbols) / to_sympy(denominator, symbols)
        case Power(base, exponent):
            return to_sympy(base, symbols) ** to_sympy(exponent, symbols)
        case Call(name, argument) if name in FUNCTIONS:
            return getattr(sympy, name)(to_sympy(argument, symbols))
        case Call(name, argument, order):
            point, x = to_sympy(argument, symbols), sympy.Dummy("x")
            function = sympy.Function(name)
            return sympy.Subs(function(x).diff(x, order), x, point) if order else function(point)
    message = f"{type(expression).__name__} has no SymPy counterpart"
    raise TypeError(message)
