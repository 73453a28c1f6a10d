"""How often s = 0 is a root, such as of motions as a rigid body: power series modulo a prime.

Every coefficient is a number modulo a prime, pi and functions of constants stand for random ones: cosine and
sine of an angle for a point of the circle, roots of numbers for roots modulo the prime. A determinant that
vanishes to some order there does not vanish to a lower one by chance but with odds of about 1 in 2^61.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flint import nmod_poly

from symflex.algebra import LAPLACE, PRIME, random_point
from symflex.algebra.propagators import EXPONENTIAL
from symflex.algebra.vanishing import TaylorField
from symflex.balls import columns_of
from symflex.equations import ConstantFunction
from symflex.expressions import Expression
from symflex.transfer.enclose import rational_value

if TYPE_CHECKING:
    from symflex.roots.networks.cramer import CramerEquations


SPARE_TERMS = 8  # terms of a series beyond those that vanish; each pivot of an order takes as many
FEWEST = 4  # columns with fewest entries that are looked at for a pivot


def _place_constants(cramer: CramerEquations, point: dict[str, int]) -> bool:
    """Put functions of constants where what relates them holds; False where that cannot be done."""
    values = dict(cramer.values)
    for name, value in values.items():
        if name in point and not value.is_imaginary:
            point[name] = value.rational.numerator * pow(value.rational.denominator, -1, PRIME) % PRIME
            point[name] = point[name] * pow(point["pi"], value.pi_power, PRIME) % PRIME
    place_on_circles(cramer.equations.constants, point, PRIME)
    for constant in cramer.equations.constants:
        function, argument = constant.expression.name, constant.expression.argument
        square = rational_value(argument, values) if function == "sqrt" else None
        if square is not None:
            residue = square.numerator * pow(square.denominator, -1, PRIME) % PRIME
            point[constant.generator] = root = pow(residue, (PRIME + 1) // 4, PRIME)  # as PRIME is 3 modulo 4
            if root * root % PRIME != residue:
                return False
    return True


def place_on_circles(constants: Sequence[ConstantFunction], point: dict[str, int], prime: int) -> None:
    """Put cosine and sine of an angle, numbers modulo a prime, at a random point of the circle."""
    tangents: dict[Expression, int] = {}
    for constant in constants:
        function, argument = constant.expression.name, constant.expression.argument
        if function in ("cos", "sin"):
            t = tangents.setdefault(argument, point[constant.generator])  # of half the angle, at random
            above = 1 - t * t if function == "cos" else 2 * t
            point[constant.generator] = above * pow(1 + t * t, -1, prime) % prime


def order_at_zero(cramer: CramerEquations, size: int, least: int) -> int | None:
    """Return the order of a determinant at s = 0, about ``least``; ``None`` with waves at rest."""
    field = TaylorField(SPARE_TERMS + 2 * least, PRIME)
    values = _series(cramer, field)
    if values is None:
        return None
    rows: list[dict[int, nmod_poly]] = []
    for row in cramer.entries[:size]:
        residues = {j: field.rational(c, c.ring.names, values) for j, c in row.items() if j < size}
        rows.append({j: x for j, x in residues.items() if x is not None and not x.is_zero()})
        if any(x is None for x in residues.values()):
            return None
    order = _order(rows, field)
    if order is None or size != len(cramer.entries) - 1:
        return order
    divisor = field.rational(cramer.divisor, cramer.divisor.ring.names, values)
    more = None if divisor is None else field.order(divisor)
    return None if more is None else order + more


def _series(cramer: CramerEquations, field: TaylorField) -> dict[str, nmod_poly] | None:
    """Return every generator as a power series in s, constants without values at random."""
    equations, point = cramer.equations, random_point((*cramer.equations.ring.names, "pi"))
    if not _place_constants(cramer, point):
        return None
    values = {name: field.constant(x) for name, x in point.items()} | {LAPLACE: field.power(1)}
    for name, value in equations.definitions:
        residue = field.rational(value, value.ring.names, values)
        if residue is None:
            return None
        values[name] = residue
    for waves in cramer.numeric.waves:
        parts = [*waves.law.characteristic, waves.law.shift, waves.length]
        series = [field.rational(c, c.ring.names, values) for c in parts]
        *coefficients, shift, length = [x for x in series if x is not None]
        if len(coefficients) != len(waves.law.characteristic) or int(shift[0]):
            return None
        functions = _fundamental(coefficients, length, field)
        if functions is None:
            return None
        decay = field.even_odd(field.times(shift, length) * (field.prime - 1), 1, circular=False)
        for name, order in waves.orders.items():
            values[name] = sum(decay, field.constant(0)) if order == EXPONENTIAL else functions[order]
    return values


def _fundamental(
    coefficients: Sequence[nmod_poly], length: nmod_poly, field: TaylorField
) -> list[nmod_poly] | None:
    """Return fundamental functions as series; ``None`` unless all exponents vanish at rest."""
    n = len(coefficients)
    if not n:
        return []
    if any(int(c[0]) for c in coefficients):
        return None
    term = [field.constant(int(i == n - 1)) for i in range(n)]
    total = list(term)
    for k in range(1, n * (field.terms + 1) + 1):
        last = field.constant(0)
        for c, x in zip(coefficients, term, strict=True):
            last = last - field.times(c, x)
        scale = pow(k, -1, field.prime)
        term = [field.times(x, length) * scale for x in (*term[1:], last)]
        total = [a + b for a, b in zip(total, term, strict=True)]
    return total


def _order(rows: list[dict[int, nmod_poly]], field: TaylorField) -> int | None:
    """Return the order of the determinant, by pivots of least order in their columns."""
    columns = columns_of(rows)
    left, total, terms = set(range(len(rows))), 0, field.terms
    while left:
        for looked_at in (sorted(left, key=lambda j: len(columns[j]))[:FEWEST], left):
            ranked = [
                (field.order(rows[i][j]) or 0, (len(rows[i]) - 1) * (len(columns[j]) - 1), i, j)
                for j in looked_at
                for i in columns[j]
            ]
            if ranked and not min(ranked)[0]:
                break
        if not ranked:
            return None
        order, _, i, j = min(ranked)
        total, terms = total + order, terms - order
        if terms <= 0:
            return None
        row = rows[i]
        pivot = row.pop(j).right_shift(order)
        inverse = pivot.inverse_series_trunc(terms)
        for k in row:
            columns[k].discard(i)
        for m in columns[j] - {i}:
            target = rows[m]
            factor = target.pop(j).right_shift(order).mul_low(inverse, terms)
            for k, x in row.items():
                value = (target.get(k, field.constant(0)) - factor.mul_low(x, terms)).truncate(terms)
                if value.is_zero():
                    target.pop(k, None)
                    columns[k].discard(m)
                else:
                    target[k] = value
                    columns[k].add(m)
        columns[j] = set()
        left.discard(j)
    return total
