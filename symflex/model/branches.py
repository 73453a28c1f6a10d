"""Roots of s, as of semi-infinite bars and fractional orders: each is a block without a name of its own.

Input: a draft, as read. Output: the same, with names of blocks for roots of s and for exponentials of them.

Example: ``G = "exp(-sqrt(s/a)*x)"`` is the block E(x/sqrt(a)) with ``E(k) = exp(-k*r)``, ``r = sqrt(s)``.
With ``r = (a*s + b)^(1/q)`` in place of s all is entire, and exponentials are delays. The principal sheet
is the sector ``abs(arg r) < pi/q`` (Matignon 1996, for polynomials).
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import count
from math import lcm
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
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
    is_number,
    names_among,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    replace_node,
    replace_values,
    substitute,
    sum_of,
)
from symflex.library.blocks import DECAY, ROOT
from symflex.model.linearity import rational_exponent
from symflex.model.model import PlacedBlock, rewritten

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from symflex.model.network import Draft

    Decay = Callable[[Expression, int], Expression]
    Radical = tuple[Fraction, Expression, Expression]  # e, a and b of ``(a*s + b)^e``

SIZE_LIMIT = 1_000  # nodes of a definition that is written out
HALF = 2  # the denominator of powers of which a constant may be a factor: its root is a function of constants
MOST_SHEETS = 12  # largest common denominator of exponents: a polynomial in r has so many times the degree


def with_branches(draft: Draft, taken: Collection[str]) -> Draft:
    """Return a draft with a block for the root of s in it, and for each exponential of that."""
    places = draft.expressions()
    written = [n for e in places for n in nodes(e)]
    if not any(n.name == "sqrt" if isinstance(n, Call) else isinstance(n, Power) for n in written):
        return draft
    known, moving = dict[str, Expression](), dict[str, Expression]()
    for definition in draft.definitions:
        opened = known[definition.name] = substitute(definition.expression, known)
        if len(nodes(opened)) > SIZE_LIMIT:
            return draft
        if names_among(opened, (LAPLACE,)):
            moving[definition.name] = opened
    roots = {n: found for e in places for n in nodes(substitute(e, moving)) if (found := _radical(n))}
    order = lcm(*(exponent.denominator for exponent, _, _ in roots.values()))
    # Without a shift, roots of constants are factors, of which only square roots have a name.
    based = (own for own in roots.values() if own[0].denominator != HALF or not is_number(own[2], 0))
    _, a, b = next(based, (0, number(1), number(0)))
    factors = {n: factor for n, own in roots.items() if (factor := _factor(own, a)) is not None}
    shifts = {format_expression(quotient(b, a)) for _, a, b in roots.values()}
    if len(shifts) != 1 or len(factors) < len(roots) or order > MOST_SHEETS:
        return draft
    free = (name for i in count(1) if (name := f"branch_{i}") not in {*taken, *known})
    values = (("a", substitute(a, known)), ("b", substitute(b, known)), ("q", number(order)))
    root, decays = PlacedBlock(next(free), ROOT, values), dict[tuple[Expression, int], PlacedBlock]()

    def decay(rate: Expression, times: int) -> Expression:
        if (rate, times) not in decays:
            decays[rate, times] = PlacedBlock(next(free), DECAY, (("k", rate), ("m", number(times))))
        return Name(decays[rate, times].name)

    def put_in(expression: Expression) -> Expression:
        opened = substitute(expression, moving)
        if not any(n in roots for n in nodes(opened)):
            return expression
        for node, factor in factors.items():
            value = power(Name(root.name), int(roots[node][0] * order))
            opened = replace_node(opened, node, product_of([factor, value]))
        return replace_values(opened, {n: x for n in nodes(opened) if (x := _function(n, root.name, decay))})

    kept = (d for d in draft.definitions if put_in(d.expression) is d.expression)
    changed = rewritten(replace(draft, definitions=tuple(kept)), put_in)
    return replace(changed, blocks=(root, *decays.values(), *changed.blocks))


def _radical(node: Expression) -> Radical | None:
    match node:
        case Call("sqrt", argument, 0):
            exponent = Fraction(1, HALF)
        case Power(argument, written) if (
            found := rational_exponent(written)
        ) is not None and found.denominator > 1:
            exponent = found
        case _:
            return None
    below = number(1)
    match argument:
        case Quotient(above, divisor) if not names_among(above, (LAPLACE,)):
            argument, below, exponent = divisor, above, -exponent
    terms = argument.terms if isinstance(argument, Sum) else (argument,)
    rest = [t for t in terms if not names_among(t, (LAPLACE,))]
    slope = per(sum_of([t for t in terms if t not in rest]), LAPLACE)
    if slope is None or slope[1] != 1:
        return None
    return exponent, quotient(slope[0], below), quotient(sum_of(rest), below)


def _factor(radical: Radical, base: Expression) -> Expression | None:
    """Return what a root is times that of ``base*s + ...``, to the same power; None if it has no name."""
    exponent, slope, _ = radical
    if slope == base:
        return number(1)
    scale = quotient(slope, base)
    parts = (scale.numerator, scale.denominator) if isinstance(scale, Quotient) else (scale, number(1))
    above, below = (x if is_number(x, 1) else Call("sqrt", x) for x in parts)
    return power(quotient(above, below), int(2 * exponent)) if exponent.denominator == HALF else None


def per(expression: Expression, name: str) -> tuple[Expression, int] | None:
    """Return a and m of ``a*name^m``, a free of it; None of all else."""
    match expression:
        case Name(own) if own == name:
            return number(1), 1
        case Power(Name(own), Number(m)) if own == name:
            return number(1), int(m)
        case Negative(operand):
            inner = per(operand, name)
            return inner and (negative(inner[0]), inner[1])
        case Product(factors):
            moving = [f for f in factors if names_among(f, (name,))]
            inner = per(moving[0], name) if len(moving) == 1 else None
            return inner and (product_of([inner[0] if f is moving[0] else f for f in factors]), inner[1])
        case Quotient(above, below) if not names_among(below, (name,)):
            inner = per(above, name)
            return inner and (quotient(inner[0], below), inner[1])
        case Sum(terms):
            found = [each for term in terms if (each := per(term, name))]
            if len(found) == len(terms) and len({m for _, m in found}) == 1:
                return sum_of([a for a, _ in found]), found[0][1]
    return None


def _function(node: Expression, root: str, decay: Decay) -> Expression | None:
    """Return exp, sinh, cosh or tanh of a multiple of a power of the root by decays; None of all else."""
    if not isinstance(node, Call) or node.order or not names_among(node.argument, (root,)):
        return None
    terms = node.argument.terms if isinstance(node.argument, Sum) and node.name == "exp" else (node.argument,)
    rest = [t for t in terms if not names_among(t, (root,))]
    found = per(sum_of([t for t in terms if t not in rest]), root)
    if found is None or found[1] < 1:
        return None
    rate, turned = found[0], negative(found[0])
    is_negative = len(format_expression(turned)) < len(format_expression(rate))
    e = decay(turned if is_negative else rate, found[1])
    one, two, square = number(1), number(2), power(e, 2)
    match node.name:
        case "exp":
            value = e if is_negative else quotient(one, e)
            return product_of([value, Call("exp", sum_of(rest))]) if rest else value
        case "cosh":
            return quotient(sum_of([one, square]), product_of([two, e]))
        case "sinh" | "tanh":
            below = product_of([two, e]) if node.name == "sinh" else sum_of([one, square])
            value = quotient(sum_of([one, negative(square)]), below)
            return negative(value) if is_negative else value
    return None
