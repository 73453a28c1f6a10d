"""A transfer function in the names that ``[analysis]`` asks for.

Input: a transfer function of finite order, and names with what they are: ``omega_0 = sqrt(k/m)``.
Output: its form with every factor whose coefficients are numbers times powers of these names written so:

    1/(m*s^2 + b*s + k)    ->    1/(m*(s^2 + 2*zeta*omega_0*s + omega_0^2))

Numbers and powers are those of values at test points. As all prints are read back, a wrong guess is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import combinations, product
from math import prod
from random import Random
from typing import Final

from flint import acb

from symflex.balls import ball
from symflex.budget import spend
from symflex.expressions import (
    FUNCTIONS,
    Expression,
    Name,
    Sum,
    format_expression,
    names,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.print.forms.arrange import length
from symflex.print.forms.notation import reachable
from symflex.print.forms.polynomial import factored_form
from symflex.print.forms.printed import PrintedForm, S
from symflex.print.forms.shapes import of_powers, powers_of
from symflex.transfer import TransferFunction
from symflex.transfer.enclose import principal_values

POINTS: Final = 3
EXPONENTS: Final = (1, 2, -1, -2)
MOST: Final = 3  # names in one product
SIMPLE: Final = 64  # the largest denominator of a number beside names, and the part of values between 1 and 2


def own_form(tf: TransferFunction) -> PrintedForm | None:
    """Return a form in one's own names, None if no factor of the function is one in them."""
    lines = tf.model.analysis.print
    if not tf.is_rational or tf.is_large:
        return None
    in_names, made = _products_of(tf), factored_form(tf)
    front, powers = powers_of(quotient(made.num, made.den))
    gain = of_powers(front, {base: n for base, n in powers.items() if S not in names(base)})
    whole: dict[Expression, int] = {}
    for base, n in powers.items():
        if S in names(base):
            ways = sorted(_ways(base, in_names), key=lambda w: ("/" in format_expression(w[1]), length(w[1])))
            divisor, total = ways[0] if ways else (None, base)
            gain = quotient(gain, of_powers(Fraction(1), {divisor: -n})) if divisor else gain
            whole[total] = n
    front, powers = powers_of(in_names(gain) or gain)
    powers |= whole
    num, den = ({b: n * side for b, n in powers.items() if n * side > 0} for side in (1, -1))
    above, below = of_powers(Fraction(front.numerator), num), of_powers(Fraction(front.denominator), den)
    used = reachable([above, below], lines)
    return PrintedForm("definitions", above, below, used) if used else None


def _ways(
    base: Expression, in_names: Callable[[Expression], Expression | None]
) -> Iterator[tuple[Expression, Expression]]:
    """Yield a sum as what it is divided by, and a sum of powers of s and products of names alone."""
    parts: dict[int, list[Expression]] = {}
    for front, powers in (powers_of(t) for t in (base.terms if isinstance(base, Sum) else ())):
        parts.setdefault(powers.pop(S, 0), []).append(of_powers(front, powers))
    totals = {n: sum_of(each) for n, each in parts.items()}
    for scale in (totals[max(totals)], totals[min(totals)]) if len(totals) > 1 else ():
        own = {n: e for n, total in totals.items() if (e := in_names(quotient(total, scale)))}
        if len(own) == len(totals) and any(map(names, own.values())):
            yield scale, sum_of([of_powers(*powers_of(product_of([e, power(S, n)]))) for n, e in own.items()])


def _products_of(tf: TransferFunction) -> Callable[[Expression], Expression | None]:
    """Return what finds a number times powers of names that has the values of an expression."""
    lines, random = tf.model.analysis.print, Random(1)
    points = {"pi": [acb.pi()] * POINTS}
    for p in tf.model.parameters:
        points[p.name] = [acb(random.randrange(SIMPLE)) / SIMPLE + 1 for _ in range(POINTS)]

    def values(expression: Expression) -> list[acb] | None:
        if {n.name for n in names(expression)} <= {*points, *FUNCTIONS}:
            return principal_values(expression, POINTS, lambda name: points[name])
        return None

    for name, e in (*((d.name, d.expression) for d in tf.model.definitions), *lines * len(lines)):
        if (own := values(e)) is not None:  # each may use others
            points[name] = own
    bases = ["pi", *sorted((n for n, _ in lines if n in points), key=lambda n: not n.startswith("zeta"))]
    chosen = (each for count in range(MOST + 1) for each in combinations(bases, count))
    raised = [dict(zip(c, e, strict=True)) for c in chosen for e in product(EXPONENTS, repeat=len(c))]

    def found(expression: Expression) -> Expression | None:
        wanted = values(expression)
        for exponents in raised if wanted else ():
            spend()
            first, *others = (
                prod((points[b][i] ** -n for b, n in exponents.items()), start=value)
                for i, value in enumerate(wanted or ())
            )
            scale = Fraction(float(first.real)).limit_denominator(SIMPLE)
            if all(first.overlaps(x) for x in (acb(ball(scale)), *others)):
                return of_powers(scale, {Name(b): n for b, n in exponents.items()})
        return None

    return found
