"""Enclosing the value of an expression of constants in a real ball."""

from __future__ import annotations

from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING

from flint import arb, fmpq

from symflex.algebra import FUNCTIONS
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from symflex.model import ExactValue


def ball(value: Fraction) -> arb:
    """Return a rational number as a ball at the current precision."""
    return arb(fmpq(value.numerator, value.denominator))


def rational_value(expression: Expression, values: Mapping[str, ExactValue]) -> Fraction | None:
    """Return the exact value of an expression of rational numbers, ``None`` when it is anything else.

    Examples
    --------
    >>> from symflex.expressions import Number, Quotient
    >>> rational_value(Quotient(Number(Fraction(8)), Number(Fraction(6))), {})
    Fraction(4, 3)
    """
    match expression:
        case Number(value):
            return value
        case Name(name):
            known = values.get(name)
            return known.rational if known is not None and known.pi_power == 0 else None
        case Negative(operand):
            inner = rational_value(operand, values)
            return None if inner is None else -inner
        case Sum(terms) | Product(terms):
            parts = [rational_value(t, values) for t in terms]
            known_parts = [p for p in parts if p is not None]
            if len(known_parts) < len(parts):
                return None
            return (
                sum(known_parts, Fraction(0))
                if isinstance(expression, Sum)
                else prod(known_parts, start=Fraction(1))
            )
        case Quotient(numerator, denominator):
            above, below = rational_value(numerator, values), rational_value(denominator, values)
            return above / below if above is not None and below else None
    return None


def enclosure(value: ExactValue) -> Callable[[], arb]:
    """Return what encloses an exact value at the precision of the time it is called."""
    return lambda: ball(value.rational) * arb.pi() ** value.pi_power


def later(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> Callable[[], arb]:
    """Return what encloses an expression at the precision of the time it is called; see :func:`enclose`."""
    return lambda: enclose(expression, values)


def enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    """Return a ball that contains the value of an expression at the current precision.

    Parameters
    ----------
    expression : Expression
        Of numbers, ``pi``, named constants and elementary functions.
    values : mapping of str to callable
        The named constants, evaluated at the current precision.

    Raises
    ------
    ModelError
        SF228 when the value is not a finite real number.

    Examples
    --------
    >>> from symflex.expressions import Call, Number
    >>> from fractions import Fraction
    >>> enclose(Call("sqrt", Number(Fraction(4))), {}).contains(2)
    True
    """
    result = _enclose(expression, values)
    if not result.is_finite():
        message = f"'{format_expression(expression)}' is not a finite real number for these values"
        raise ModelError(Diagnostic("SF228", message, expression.span))
    return result


def _enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    match expression:
        case Number(value):
            return ball(value)
        case Name("pi"):
            return arb.pi()
        case Name(name):
            return values[name]()
        case Negative(operand):
            return -_enclose(operand, values)
        case Sum(terms):
            return sum((_enclose(t, values) for t in terms), arb(0))
        case Product(factors):
            product = arb(1)
            for factor in factors:
                product = product * _enclose(factor, values)
            return product
        case Quotient(numerator, denominator):
            return _enclose(numerator, values) / _enclose(denominator, values)
        case Power(base, exponent):
            return _enclose(base, values) ** _enclose(exponent, values)
        case Call(name, argument):
            return FUNCTIONS[name].evaluate(_enclose(argument, values))
    message = f"unexpected expression {type(expression).__name__}"
    raise TypeError(message)
