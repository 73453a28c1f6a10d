"""Roots of s, as of semi-infinite bars and fractional orders: each is a block without a name of its own.

Input: a draft, as read. Output: the same, with names of blocks for roots of s and for exponentials of them.

Example: ``G = "exp(-sqrt(s/a)*x)"`` is the block E(x/sqrt(a)) with ``E(k) = exp(-k*r)``, ``r = sqrt(s)``.
With ``r = (a*s + b)^(1/q)`` in place of s all is entire, and exponentials are delays. The principal sheet
is the sector ``abs(arg r) < pi/q`` (Matignon 1996, for polynomials).
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import count, product
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
    from collections.abc import Callable, Collection, Iterable

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
    known = opened_definitions(draft)
    if known is None:
        return draft
    moving = {name: opened for name, opened in known.items() if names_among(opened, (LAPLACE,))}
    roots = {n: found for e in places for n in nodes(substitute(e, moving)) if (found := _radical(n))}
    order = lcm(*(exponent.denominator for exponent, _, _ in roots.values()))
    # Without a shift, roots of constants are factors, of which only square roots have a name.
    based = (
        radical
        for radical in roots.values()
        if radical[0].denominator != HALF or not is_number(radical[2], 0)
    )
    _, a, b = next(based, (0, number(1), number(0)))
    factors = {n: factor for n, radical in roots.items() if (factor := _factor(radical, a)) is not None}
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


def opened_definitions(draft: Draft) -> dict[str, Expression] | None:
    """Return definitions with all others put into them; None where one grows too large."""
    known = dict[str, Expression]()
    for definition in draft.definitions:
        opened = known[definition.name] = substitute(definition.expression, known)
        if len(nodes(opened)) > SIZE_LIMIT:
            return None
    return known


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
    powers = powers_of(argument, LAPLACE)
    if powers is None or max(powers) != 1:
        return None
    return exponent, quotient(powers[1], below), quotient(powers.get(0, number(0)), below)


def _factor(radical: Radical, base: Expression) -> Expression | None:
    """Return what a root is times that of ``base*s + ...``, to the same power; None if it has no name."""
    exponent, slope, _ = radical
    if slope == base:
        return number(1)
    scale = quotient(slope, base)
    parts = (scale.numerator, scale.denominator) if isinstance(scale, Quotient) else (scale, number(1))
    above, below = (x if is_number(x, 1) else Call("sqrt", x) for x in parts)
    return power(quotient(above, below), int(2 * exponent)) if exponent.denominator == HALF else None


def powers_of(expression: Expression, name: str) -> dict[int, Expression] | None:
    """Return the coefficients of a polynomial in a name, by their powers; None of all else."""
    if not names_among(expression, (name,)):
        return {0: expression}
    match expression:
        case Name():
            return {1: number(1)}
        case Power(Name(), Number(m)) if m.denominator == 1:
            return {int(m): number(1)}
        case Negative(operand):
            inner = powers_of(operand, name)
            return inner and {m: negative(a) for m, a in inner.items()}
        case Quotient(above, below) if not names_among(below, (name,)):
            inner = powers_of(above, name)
            return inner and {m: quotient(a, below) for m, a in inner.items()}
        case Product(parts) | Sum(parts):
            found = [each for part in parts if (each := powers_of(part, name))]
            if len(found) < len(parts):
                return None
            if isinstance(expression, Sum):
                return _gathered((m, a) for each in found for m, a in each.items())
            total = {0: number(1)}
            for each in found:
                if max(total) + max(each) > MOST_SHEETS:
                    return None  # their coefficients double with every factor
                pairs = product(total.items(), each.items())
                total = _gathered((m + n, product_of([a, b])) for (m, a), (n, b) in pairs)
            return total
    return None


def _gathered(terms: Iterable[tuple[int, Expression]]) -> dict[int, Expression]:
    by_power: dict[int, list[Expression]] = {}
    for power_, coefficient in terms:
        by_power.setdefault(power_, []).append(coefficient)
    return {m: sum_of(summands) for m, summands in by_power.items()}


def _function(node: Expression, root: str, decay: Decay) -> Expression | None:
    """Return exp, sinh, cosh or tanh of a multiple of a power of the root by decays; None of all else."""
    if not isinstance(node, Call) or node.order or not names_among(node.argument, (root,)):
        return None
    powers = powers_of(node.argument, root)
    if powers is None or any(m and names_among(a, (LAPLACE,)) for m, a in powers.items()):
        return None
    one, two = number(1), number(2)
    decays = [(_is_negative(a), m, a) for m, a in powers.items() if m]
    each = [(turned, decay(negative(a) if turned else a, m)) for turned, m, a in decays]
    if node.name == "exp":
        constant = [Call("exp", powers[0])] if 0 in powers else []
        return product_of([*(e if turned else quotient(one, e) for turned, e in each), *constant])
    if len(powers) > 1:
        return None
    ((is_negative, e),) = each
    square = power(e, 2)
    match node.name:
        case "cosh":
            return quotient(sum_of([one, square]), product_of([two, e]))
        case "sinh" | "tanh":
            below = product_of([two, e]) if node.name == "sinh" else sum_of([one, square])
            value = quotient(sum_of([one, negative(square)]), below)
            return negative(value) if is_negative else value
    return None


def _is_negative(rate: Expression) -> bool:
    """Tell whether a rate is shorter to write with the other sign."""
    return len(format_expression(negative(rate))) < len(format_expression(rate))
