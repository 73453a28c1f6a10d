"""Values of expressions, rational functions and polynomials, exactly or in balls.

Input: the expression, and what encloses its names at the precision of the time. Output: a ball, or the exact
rational number where there is one. Example: ``sqrt(4)`` is a ball about 2. Theorem: see :mod:`symflex.balls`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import isqrt, prod

from flint import acb, arb, arb_series

from symflex.algebra import FUNCTIONS
from symflex.balls import Arithmetic, ball
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Call, Expression, Number, fold, format_expression, names
from symflex.model import ExactValue
from symflex.quantities import IMAGINARY_UNIT

MOST_FACTORS = 64  # power of a ball about 0 that is multiplied out, as logarithms tell nothing of it


def rational_value(expression: Expression, values: Mapping[str, ExactValue]) -> Fraction | None:
    """Return the exact value of an expression of rational numbers, ``None`` when it is anything else.

    >>> from symflex.expressions import Number, Quotient
    >>> rational_value(Quotient(Number(Fraction(8)), Number(Fraction(6))), {})
    Fraction(4, 3)
    """

    def named(name: str) -> Fraction:
        if values[name].pi_power:
            raise KeyError(name)
        return values[name].rational

    def none(*_: object) -> Fraction:
        raise KeyError

    def called(call: Call, square: Fraction) -> Fraction:
        root = Fraction(isqrt(abs(square.numerator)), isqrt(square.denominator))
        return root if call.name == "sqrt" and root**2 == square else none()

    try:
        return fold(expression, number=Fraction, name=named, power=none, call=called)
    except (KeyError, ZeroDivisionError):
        return None


def enclosure(value: ExactValue) -> Callable[[], arb]:
    """Return what encloses an exact value at the precision of the time it is called."""
    if value.is_imaginary:
        unit: Arithmetic = acb(0, 1)
        return lambda: unit
    return lambda: ball(value.rational) * arb.pi() ** value.pi_power


def later(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> Callable[[], arb]:
    """Return what encloses an expression at the precision of the time it is called; see :func:`enclose`."""
    return lambda: enclose(expression, values)


def enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    """Return a ball that contains the value of an expression at the current precision.

    It is one of numbers, ``pi``, named constants and elementary functions. Raises ModelError: SF228 when the
    value is not a finite real number.

    >>> from symflex.expressions import Call, Number
    >>> from fractions import Fraction
    >>> enclose(Call("sqrt", Number(Fraction(4))), {}).contains(2)
    True
    """
    result = _enclose(expression, values)
    if not result.is_finite():
        message = f"'{format_expression(expression)}' is not a finite real number for these values"
        # The root of a negative number may stand for j.
        is_j = isinstance(expression, Call) and expression.name == "sqrt" and not names(expression.argument)
        raise ModelError(Diagnostic("SF228", message, expression.span, IMAGINARY_UNIT if is_j else None))
    return result


def _enclose(expression: Expression, values: Mapping[str, Callable[[], arb]]) -> arb:
    def power(base: arb, exponent: Expression) -> arb:
        rational = rational_value(exponent, {})
        if (
            base.contains(0)
            and rational is not None
            and rational.denominator == 1
            and 0 < rational <= MOST_FACTORS
        ):
            return prod([base] * int(rational), start=arb(1))
        return base ** _enclose(exponent, values)

    return fold(
        expression,
        number=ball,
        name=lambda name: arb.pi() if name == "pi" else values[name](),
        power=power,
        call=lambda call, argument: FUNCTIONS[call.name].evaluate(argument),
    )


def first_order(value: arb, slope: arb | int = 0) -> arb_series:
    """Return ``value + slope*x``, to first order in x."""
    return arb_series([value, arb(slope)], 2)


def constant_tangent(
    expression: Expression, values: Mapping[str, arb_series], *, is_real: bool = False
) -> arb_series:
    """Return an expression of constants to first order, at the current precision.

    Not finite where the expression has no derivative, such as ``sqrt(k)`` at ``k = 0``. Roots are those of
    the positive part of a ball where all that is meant ``is_real``.

    >>> from symflex.expressions import Call, Name
    >>> root = Call("sqrt", Name("k"))
    >>> constant_tangent(root, {"k": first_order(arb(4), 1)})
    2.00000000000000 + 0.250000000000000*x + O(x^2)
    """
    return fold(
        expression,
        number=lambda value: first_order(ball(value)),
        name=lambda name: first_order(arb.pi()) if name == "pi" else values[name],
        power=lambda base, exponent: _real_power(base, constant_tangent(exponent, values)),
        call=lambda call, argument: _called(call, argument, is_real=is_real),
        quotient=_quotient,
    )


def _called(call: Call, argument: arb_series, *, is_real: bool) -> arb_series:
    function = FUNCTIONS[call.name]
    if is_real and call.name == "sqrt" and argument[0].contains(0) and argument[0].upper() > 0:
        return first_order(arb(0).union(argument[0].upper().sqrt()), arb("nan"))
    # A constant argument has no slope, also where the function has none.
    slope = arb(0) if argument[1].is_zero() else function.derivative(argument[0]) * argument[1]
    return first_order(function.evaluate(argument[0]), slope)


def _quotient(above: arb_series, below: arb_series) -> arb_series:
    quotient = above[0] / below[0]
    return first_order(quotient, (above[1] - quotient * below[1]) / below[0])


def _real_power(base: arb_series, exponent: arb_series) -> arb_series:
    value = base[0] ** exponent[0]
    slope = arb(0)
    if not base[1].is_zero():
        slope = slope + exponent[0] * base[0] ** (exponent[0] - 1) * base[1]
    if not exponent[1].is_zero():
        slope = slope + value * base[0].log() * exponent[1]
    return first_order(value, slope)


def principal_values(
    expression: Expression,
    count: int,
    name: Callable[[str], list[acb]],
    call: Callable[[Call, list[acb]], list[acb]] | None = None,
    number: Callable[[Fraction], arb] = ball,
) -> list[acb]:
    """Return balls around the principal values of an expression at so many points, in one walk.

    ``name`` gives the values of a name, ``call`` those of a function that is none of the language's, and
    ``number`` that of a number, which is exact by default. A value is not finite where the expression divides
    by zero.

    >>> from symflex.expressions import Call, Name
    >>> principal_values(Call("sqrt", Name("s")), 2, lambda _: [acb(4), acb(-4)])
    [2.00000000000000, 2.00000000000000j]
    """

    def raised(base: list[acb], exponent: Expression) -> list[acb]:
        power = exponent.value if isinstance(exponent, Number) else rational_value(exponent, {})
        if power is not None and power.denominator == 1:
            return [x ** int(power) for x in base]
        exponents = principal_values(exponent, count, name, call)
        return [x**y for x, y in zip(base, exponents, strict=True)]

    def called(node: Call, argument: list[acb]) -> list[acb]:
        if node.name in FUNCTIONS or call is None:
            function: Callable[[Arithmetic], Arithmetic] = FUNCTIONS[node.name].evaluate
            return [function(x) for x in argument]
        return call(node, argument)

    return fold(
        expression,
        number=lambda value: [acb(number(value))] * count,
        name=name,
        power=raised,
        call=called,
        negative=lambda values: [-x for x in values],
        total=lambda terms: [sum(xs, acb(0)) for xs in zip(*terms, strict=True)],
        product=lambda factors: [prod(xs, start=acb(1)) for xs in zip(*factors, strict=True)],
        quotient=lambda above, below: [x / y for x, y in zip(above, below, strict=True)],
    )
