"""Products of sines and cosines as sums, so that squares and products that belong together become one term.

Input: a tree. Output: an equal tree, expanded, each of whose terms has one sine or cosine at most.

    cos(a + b)*cos(a) + sin(a + b)*sin(a) = cos(b),    cos(a)^2 + sin(a)^2 = 1,    cos(a + pi/2) = -sin(a)
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Final

from symflex.expressions.format import format_expression
from symflex.expressions.nodes import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    nodes,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    Combination = tuple[tuple[Expression, Fraction], ...]  # what is added up, or multiplied, and how often
    Term = tuple[Combination, str, Combination]  # powers, then "sin" or "cos" of an angle, or ""
    Terms = Mapping[Term, Fraction]

MOST_TERMS: Final = 500  # beyond them a product is left alone: nobody reads as many
LONGEST: Final = 500  # parts of an expression that is tried
ONE: Final[Term] = ((), "", ())
HALF: Final = Fraction(1, 2)
PI: Final = Name("pi")


def shorter(expression: Expression) -> Expression:
    """Return the shorter of an expression and its expansion with products of sines and cosines as sums.

    >>> from symflex.expressions import format_expression, parse
    >>> from symflex.errors import Text
    >>> text = Text.alone("text", "m*(l*cos(a + b)*cos(a) + l*sin(a)*sin(a + b)) + cos(c)")
    >>> format_expression(shorter(parse(text)))
    'm*l*cos(b) + cos(c)'
    """
    if len(nodes(expression)) > LONGEST:
        return expression
    try:
        terms = _expanded(expression)
    except OverflowError:
        return expression
    places: dict[Expression, int] = {}
    for place, node in enumerate(nodes(expression)):
        places.setdefault(node, place)
    other = sum_of(_built(term, n, places) for term, n in terms.items())
    return other if len(nodes(other)) < len(nodes(expression)) else expression


def _expanded(node: Expression) -> Terms:
    match node:
        case Number(value):
            return {ONE: value} if value else {}
        case Negative(operand):
            return {term: -n for term, n in _expanded(operand).items()}
        case Sum(terms):
            return _added(_expanded(t) for t in terms)
        case Product(factors):
            result: Terms = {ONE: Fraction(1)}
            for factor in factors:
                result = _times(result, _expanded(factor))
            return result
        case Quotient(above, below):
            return _times(_expanded(above), _inverse(below))
        case Power(base, Number(n)) if n.denominator == 1:
            inner = _expanded(base)
            if len(inner) == 1 and not next(iter(inner))[1]:
                (((powers, _, angle), value),) = inner.items()
                return {(tuple((b, e * n) for b, e in powers), "", angle): value ** int(n)}
            return _expanded(Product((base,) * int(n)))
        case Call(kind, argument) if kind in ("sin", "cos"):
            turns: dict[Expression, Fraction] = {}
            for (powers, function, _), n in _expanded(argument).items():
                if function:
                    return {(((node, Fraction(1)),), "", ()): Fraction(1)}
                turns[_product(powers, {})] = n
            return _turned((), kind, turns, Fraction(1))
    return {(((node, Fraction(1)),), "", ()): Fraction(1)}


def _inverse(node: Expression) -> Terms:
    """Return one over an expression, whose sums stay together."""
    result: Terms = {ONE: Fraction(1)}
    for factor in node.factors if isinstance(node, Product) else (node,):
        inner = {} if isinstance(factor, Sum) else _expanded(factor)
        if len(inner) == 1 and not next(iter(inner))[1]:
            (((powers, _, angle), value),) = inner.items()
            over = {(tuple((b, -e) for b, e in powers), "", angle): 1 / value}
        else:
            over = {(((factor, Fraction(-1)),), "", ()): Fraction(1)}
        result = _times(result, over)
    return result


def _added(parts: Iterable[Terms]) -> Terms:
    total: dict[Term, Fraction] = {}
    for part in parts:
        for term, n in part.items():
            total[term] = total.get(term, Fraction(0)) + n
    return {term: n for term, n in total.items() if n}


def _times(left: Terms, right: Terms) -> Terms:
    if len(left) * len(right) > MOST_TERMS:
        raise OverflowError
    products: list[Terms] = []
    for (powers, kind, angle), n in left.items():
        for (others, other, turned), m in right.items():
            both = dict(powers)
            for base, exponent in others:
                both[base] = both.get(base, Fraction(0)) + exponent
            gathered = _gathered(both)
            if not kind or not other:
                products.append({(gathered, kind or other, angle or turned): n * m})
                continue
            add, take = dict(angle), dict(angle)
            for base, times in turned:
                add[base] = add.get(base, Fraction(0)) + times
                take[base] = take.get(base, Fraction(0)) - times
            made = "cos" if kind == other else "sin"
            first = -1 if kind == other == "sin" else 1
            second = -1 if (kind, other) == ("cos", "sin") else 1
            products.append(_turned(gathered, made, add, first * n * m * HALF))
            products.append(_turned(gathered, made, take, second * n * m * HALF))
    return _added(products)


def _turned(powers: Combination, kind: str, angle: Mapping[Expression, Fraction], times: Fraction) -> Terms:
    """Return a sine or cosine whose angle begins with a plus, or what it is at 0, without quarter turns."""
    turn = 2 * angle.get(PI, Fraction(0))
    if turn.denominator == 1:
        angle = {base: n for base, n in angle.items() if base != PI}
        if turn % 2:
            times = -times if (kind == "cos") == (turn % 4 == 1) else times
            kind = "sin" if kind == "cos" else "cos"
        elif turn % 4:
            times = -times
    combination = _gathered(angle)
    if not combination:
        return {(powers, "", ()): times} if kind == "cos" else {}
    if combination[0][1] < 0:
        combination = tuple((base, -n) for base, n in combination)
        times = -times if kind == "sin" else times
    return {(powers, kind, combination): times}


def _gathered(parts: Mapping[Expression, Fraction]) -> Combination:
    return tuple(sorted(((b, n) for b, n in parts.items() if n), key=lambda part: format_expression(part[0])))


def _product(
    powers: Combination,
    places: Mapping[Expression, int],
    others: Sequence[Expression] = (),
    times: Fraction = Fraction(1),
) -> Expression:
    """Return a product of powers, in the order of their places."""
    ordered = sorted(powers, key=lambda part: places.get(part[0], 0))
    above = [power(base, number(n)) for base, n in ordered if n > 0]
    below = [power(base, number(-n)) for base, n in ordered if n < 0]
    return quotient(
        product_of([number(times.numerator), *above, *others]),
        product_of([number(times.denominator), *below]),
    )


def _built(term: Term, times: Fraction, places: Mapping[Expression, int]) -> Expression:
    powers, kind, angle = term
    if not kind:
        return _product(powers, places, (), times)
    ordered = sorted(angle, key=lambda part: places.get(part[0], 0))
    turned = Call(kind, sum_of(product_of([number(n), base]) for base, n in ordered))
    return _product(powers, places, (turned,), times)
