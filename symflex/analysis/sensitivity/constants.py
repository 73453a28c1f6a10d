"""Constants such as ``sqrt(k/m)`` with their derivative with respect to one parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb, arb_series

from symflex.algebra import FUNCTIONS
from symflex.expressions import Call, Expression, Name, Negative, Number, Power, Product, Quotient, Sum
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Mapping


def first_order(value: arb, slope: arb | int = 0) -> arb_series:
    """Return ``value + slope*x``, to first order in x."""
    return arb_series([value, arb(slope)], 2)


def constant_tangent(expression: Expression, values: Mapping[str, arb_series]) -> arb_series:
    """Return an expression of constants to first order, at the current precision.

    Parameters
    ----------
    expression : Expression
        Of numbers, ``pi``, named constants and elementary functions.
    values : mapping of str to arb_series
        The named constants, to first order.

    Returns
    -------
    arb_series
        Not finite where the expression has no derivative, such as ``sqrt(k)`` at ``k = 0``.

    Examples
    --------
    >>> root = Call("sqrt", Name("k"))
    >>> constant_tangent(root, {"k": first_order(arb(4), 1)})
    2.00000000000000 + 0.250000000000000*x + O(x^2)
    """
    match expression:
        case Number(value):
            return first_order(ball(value))
        case Name("pi"):
            return first_order(arb.pi())
        case Name(name):
            return values[name]
        case Negative(operand):
            return -constant_tangent(operand, values)
        case Sum(terms):
            return sum((constant_tangent(t, values) for t in terms), first_order(arb(0)))
        case Product(factors):
            product = first_order(arb(1))
            for factor in factors:
                product = product * constant_tangent(factor, values)
            return product
        case Quotient(numerator, denominator):
            above, below = constant_tangent(numerator, values), constant_tangent(denominator, values)
            quotient = above[0] / below[0]
            return first_order(quotient, (above[1] - quotient * below[1]) / below[0])
        case Power(base, exponent):
            return _power(constant_tangent(base, values), constant_tangent(exponent, values))
        case Call(name, argument):
            inner, function = constant_tangent(argument, values), FUNCTIONS[name]
            # A constant argument has no slope, also where the function has none.
            slope = arb(0) if inner[1].is_zero() else function.derivative(inner[0]) * inner[1]
            return first_order(function.evaluate(inner[0]), slope)
    message = f"unexpected expression {type(expression).__name__}"
    raise TypeError(message)


def _power(base: arb_series, exponent: arb_series) -> arb_series:
    value = base[0] ** exponent[0]
    slope = arb(0)
    if not base[1].is_zero():
        slope = slope + exponent[0] * base[0] ** (exponent[0] - 1) * base[1]
    if not exponent[1].is_zero():
        slope = slope + value * base[0].log() * exponent[1]
    return first_order(value, slope)
