"""Formulas in a root of s, written in s: what the ring's s stands for, put in its place.

Input: an expression in which ``s`` is the root ``(a s + b)^(1/q)``, and that root.
Output: the same in s. Example, of ``sqrt(s + a)``:

    s^3 + (c - a)*s + d    (s + c)*sqrt(s + a) + d
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from symflex.algebra import LAPLACE, Factored, Ring, by_powers, terms_of
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Number,
    Power,
    Quotient,
    Sum,
    format_expression,
    is_number,
    names_among,
    nodes,
    number,
    power,
    product_of,
    quotient,
    sum_of,
    with_children,
)
from symflex.model.branches import powers_of
from symflex.model.linearity import factored_of
from symflex.model.model import RootOfS
from symflex.print.forms.printed import S

SQUARE = 2  # the order of a root that has a sign of its own in print


def in_roots(expression: Expression, root: RootOfS) -> Expression:
    """Return an expression with a root of s in place of s, powers of which are written as short as can be.

    >>> cubed = product_of([power(S, 3), Call("exp", S)])
    >>> format_expression(in_roots(cubed, RootOfS(number(1), number(0), 2)))
    's*sqrt(s)*exp(sqrt(s))'
    >>> shifted = sum_of([power(S, 2), Name("c"), Name("a")])
    >>> format_expression(in_roots(shifted, RootOfS(number(1), Name("a"), 2)))
    's + c + 2*a'
    """
    if not names_among(expression, (LAPLACE,)):
        return expression
    match expression:
        case Name():
            return _image(1, root)
        case Power(Name(), Number(exponent)):
            return _image(int(exponent), root)
    inside = with_children(expression, [in_roots(child, root) for child in expression.children])
    if not isinstance(expression, Sum) or is_number(root.shift, 0):
        return inside
    gathered = _gathered(expression, root)
    is_shorter = gathered and len(format_expression(gathered)) < len(format_expression(inside))
    return gathered if gathered and is_shorter else inside


def _image(exponent: int, root: RootOfS) -> Expression:
    """Return a power of the root."""
    slope = root.slope
    above, below = (slope.numerator, slope.denominator) if isinstance(slope, Quotient) else (slope, number(1))
    base = sum_of([quotient(product_of([above, S]), below), root.shift])
    whole, part = divmod(exponent, root.order)
    if root.order == SQUARE:
        return product_of([power(base, whole), *([Call("sqrt", base)] if part else [])])
    return power(base, whole) if not part else Power(base, Number(Fraction(exponent, root.order)))


def _gathered(total: Sum, root: RootOfS) -> Expression | None:
    """Return a polynomial in the root as one in s for each power of the root below its order."""
    powers = powers_of(total, LAPLACE)
    if powers is None:
        return None
    every = [n for e in (*powers.values(), root.slope, root.shift) for n in nodes(e)]
    named = {format_expression(n): n for n in every if isinstance(n, Name | Call)}
    ring = Ring((LAPLACE, *(name for name in named if name != LAPLACE)))
    try:
        base = factored_of(root.slope, ring) * Factored.generator(ring, LAPLACE) + factored_of(
            root.shift, ring
        )
        parts: dict[int, Factored] = {}
        for exponent, coefficient in powers.items():
            whole, part = divmod(exponent, root.order)
            parts[part] = parts.get(part, base * 0) + factored_of(coefficient, ring) * base**whole
    except TypeError:  # an exponent is no whole number
        return None
    lead = {
        part: max(by_powers(ring, value.numerator().expand()), default=0) for part, value in parts.items()
    }
    order = sorted(parts, key=lambda part: root.order * lead[part] + part, reverse=True)
    terms = [(part, _written(parts[part], named)) for part in order if not parts[part].is_zero]
    return sum_of([product_of([e, _image(part, root)] if part else [e]) for part, e in terms])


def _written(value: Factored, named: Mapping[str, Expression]) -> Expression:
    """Return a quotient of polynomials in s as an expression."""
    sides = []
    for side in (value.numerator(), value.denominator()):
        by_power = by_powers(side.ring, side.expand())
        coefficients = {}
        for exponent, polynomial in by_power.items():
            products = [
                (
                    count < 0,
                    product_of([number(count), *(power(named[side.ring.names[i]], e) for i, e in monomial)]),
                )
                for monomial, count in terms_of(polynomial)
            ]
            coefficients[exponent] = sum_of([e for _, e in sorted(products, key=lambda own: own[0])])
        sides.append(
            sum_of([product_of([c, power(S, m)]) for m, c in sorted(coefficients.items(), reverse=True)])
        )
    return quotient(*sides)
