"""Derivatives of expressions: what changes with a name, the others being constant.

Input: a tree, and a leaf of it. Output: a tree, kept short by the constructors of
:mod:`symflex.expressions.nodes`.

    C*(i/x)^2  by i:  C*2*(i/x)/x
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from math import nan, prod
from typing import Final

from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
    Differentiated,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    is_number,
    names_in,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    replace_node,
    sum_of,
)

SLOPES: Final[Mapping[str, Callable[[Call, Expression], Expression]]] = {
    "sqrt": lambda whole, _: quotient(number(1), product_of([number(2), whole])),
    "exp": lambda whole, _: whole,
    "log": lambda _, inner: quotient(number(1), inner),
    "sin": lambda _, inner: Call("cos", inner),
    "cos": lambda _, inner: negative(Call("sin", inner)),
    "tan": lambda whole, _: sum_of([number(1), power(whole, 2)]),
    "sinh": lambda _, inner: Call("cosh", inner),
    "cosh": lambda _, inner: Call("sinh", inner),
    "tanh": lambda whole, _: sum_of([number(1), negative(power(whole, 2))]),
    "atan": lambda _, inner: quotient(number(1), sum_of([number(1), power(inner, 2)])),
    "abs": lambda _, inner: Call("sgn", inner),
    "sgn": lambda *_: number(0),
    "sign": lambda *_: number(0),
}  # the derivative of every function by its argument
AT_ZERO: Final = {
    **dict.fromkeys(("sqrt", "sin", "tan", "sinh", "tanh", "atan", "abs"), 0),
    **dict.fromkeys(("exp", "cos", "cosh"), 1),
}


def derivative(expression: Expression, leaf: Expression) -> Expression:
    """Return the derivative by a leaf with a name.

    ValueError has the part without one, ZeroDivisionError is raised.

    >>> from symflex.expressions import Name, format_expression, parse
    >>> from symflex.errors import Text
    >>> for text in ("a*x^3 + sin(x)*y", "sqrt(x)/x"):
    ...     print(format_expression(derivative(parse(Text.alone("text", text)), Name("x"))))
    3*a*x^2 + cos(x)*y
    (1/(2*sqrt(x))*x - sqrt(x))/x^2
    """
    if expression == leaf:
        return number(1)
    if leaf not in names_in(expression):
        return number(0)

    def by(node: Expression) -> Expression:
        return derivative(node, leaf)

    match expression:
        case Negative(operand):
            return negative(by(operand))
        case Sum(terms):
            return sum_of(map(by, terms))
        case Product(factors):
            changed = ((*factors[:i], by(each), *factors[i + 1 :]) for i, each in enumerate(factors))
            return sum_of(map(product_of, changed))
        case Quotient(above, below) if leaf not in names_in(below):
            return quotient(by(above), below)
        case Quotient(above, below):
            top = [product_of([by(above), below]), negative(product_of([above, by(below)]))]
            return quotient(sum_of(top), power(below, 2))
        case Power(Call("sqrt", inner) as root, Number(n)):
            return product_of([number(n / 2), power(root, number(n - 2)), by(inner)])
        case Power(base, Number(n) | Negative(Number(n))) if n.denominator == 1:
            n = n if isinstance(expression.exponent, Number) else -n
            return product_of([number(n), power(base, number(n - 1)), by(base)])
        case Call(name, inner) if name in SLOPES:
            return product_of([SLOPES[name](expression, inner), by(inner)])
    raise ValueError(expression)


def divisor(node: Expression) -> Expression | None:
    """Return what a quotient, or a power that is one, divides by; None of all else."""
    match node:
        case Quotient(_, below) | Power(below, Negative(Number())):
            return below
    return None


def rate(expression: Expression, varies: Callable[[Expression], bool]) -> Expression:
    """Return the derivative in time, by the chain rule over names, and derivatives, that vary.

    >>> from symflex.expressions import Name, format_expression, parse
    >>> from symflex.errors import Text
    >>> text = Text.alone("text", "m*sin(x)*x'")
    >>> format_expression(rate(parse(text), lambda n: n in (Name("x"), Derivative("x", 1))))
    "m*cos(x)*x'*x' + m*sin(x)*x''"
    """
    leaves = dict.fromkeys(n for n in nodes(expression) if isinstance(n, Name | Derivative) and varies(n))
    return sum_of(
        product_of([derivative(expression, n), Derivative(n.name, getattr(n, "order", 0) + 1)])
        for n in leaves
    )


def without_brackets(expression: Expression, varies: Callable[[Expression], bool]) -> Expression:
    """Return an :func:`elementary` expression with ``(x + l*sin(theta))'`` carried out."""
    expression = elementary(expression)
    while bracket := next((n for n in reversed(nodes(expression)) if isinstance(n, Differentiated)), None):
        changed = bracket.operand
        for _ in range(bracket.order):
            changed = rate(changed, varies)
        expression = replace_node(expression, bracket, changed)
    return expression


def elementary(expression: Expression) -> Expression:
    """Return an expression whose powers of half a number are roots, and other broken ones exponentials.

    >>> from symflex.expressions import format_expression, parse
    >>> from symflex.errors import Text
    >>> format_expression(elementary(parse(Text.alone("text", "x^1.5 + 10^(-x)"))))
    'sqrt(x)^3 + exp(-x*log(10))'
    """
    for node in nodes(expression):
        if not isinstance(node, Power) or Name("s") in nodes(node):
            continue
        base, exponent = elementary(node.base), node.exponent
        twice = 2 * fold(
            exponent, number=float, name=lambda _: nan, power=lambda *_: nan, call=lambda *_: nan
        )
        if twice % 2 == 0:
            continue
        whole: Expression = Call("exp", product_of([exponent, Call("log", base)]))
        if twice % 1 == 0:
            whole = power(Call("sqrt", base), number(int(twice)))
        expression = replace_node(expression, node, whole)
    return expression


def simplified(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    """Return an expression with values for names, without what vanishes; it may raise ZeroDivisionError.

    >>> from symflex.expressions import format_expression, parse
    >>> from symflex.errors import Text
    >>> format_expression(simplified(parse(Text.alone("text", "a*cos(x) + b*sin(x)/c")), {"x": number(0)}))
    'a'
    """

    def named(name: str) -> Expression:
        return values.get(name) or (Attribute(*name.split(".")) if "." in name else Name(name))

    def called(call: Call, inner: Expression) -> Expression:
        if is_number(inner, 0) and call.name in AT_ZERO:
            return number(AT_ZERO[call.name])
        return number(0) if call.name == "log" and is_number(inner, 1) else Call(call.name, inner)

    return fold(
        expression,
        number=number,
        name=named,
        power=lambda base, exponent: power(base, simplified(exponent, values)),
        call=called,
        negative=negative,
        total=sum_of,
        product=lambda factors: _gathered([_sign_first(f) for f in factors]),
        quotient=lambda above, below: _gathered([quotient(above, below)]),
    )


def _gathered(factors: Sequence[Expression]) -> Expression:
    """Return a product with one number and each factor once: ``2*(m/2)*l*l`` is ``m*l^2``."""
    parts = list[Expression]()
    for factor in factors:
        whole = factor.operand if isinstance(factor, Negative) else factor
        if isinstance(whole, Quotient) and isinstance(whole.denominator, Number):
            parts += [
                number(1 if whole is factor else -1),
                number(1 / whole.denominator.value),
                whole.numerator,
            ]
        else:
            parts.append(factor)
    flat = [f for p in parts for f in (p.factors if isinstance(p, Product) else (p,))]
    numbers = [f.value for f in flat if isinstance(f, Number) and f.value != 1]
    if len(numbers) > 1 and prod(numbers).denominator == 1:
        factors = flat
    whole = product_of(factors)
    product = whole.operand if isinstance(whole, Negative) else whole
    if not isinstance(product, Product) or len({*product.factors}) == len(product.factors):
        return whole
    times = Counter(product.factors)
    once = product_of(power(f, n) if n > 1 else f for f, n in times.items())
    return once if product is whole else negative(once)


def _sign_first(factor: Expression) -> Expression:
    """Return a sum of negative terms as minus their sum."""
    if isinstance(factor, Sum) and all(isinstance(t, Negative) for t in factor.terms):
        return Negative(sum_of(map(negative, factor.terms)))
    return factor
