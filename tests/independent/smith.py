"""Smith forms of polynomial matrices over the rationals, by division: lists of fractions, lowest power first.

Nothing of the program: a pivot of least degree divides its row and column until nothing is left of them, and
every other entry; then comes the next. From it follow poles, zeros and decoupling zeros by their definitions.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import mpmath

Polynomial = list[Fraction]
Matrix = list[list[Polynomial]]
Rows = list[list[Fraction]]
ONE = [Fraction(1)]


def trimmed(p: Polynomial) -> Polynomial:
    while p and p[-1] == 0:
        p = p[:-1]
    return p


def plus(a: Polynomial, b: Polynomial) -> Polynomial:
    size = max(len(a), len(b))
    padded = [x + [Fraction(0)] * (size - len(x)) for x in (a, b)]
    return trimmed([x + y for x, y in zip(*padded, strict=True)])


def times(a: Polynomial, b: Polynomial) -> Polynomial:
    product = [Fraction(0)] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] += x * y
    return trimmed(product)


def divided(a: Polynomial, b: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return quotient and remainder."""
    quotient = [Fraction(0)] * max(len(a) - len(b) + 1, 0)
    while len(a) >= len(b) and a:
        shift, ratio = len(a) - len(b), a[-1] / b[-1]
        quotient[shift] = ratio
        a = plus(a, [Fraction(0)] * shift + [-ratio * x for x in b])
    return trimmed(quotient), a


def monic(p: Polynomial) -> Polynomial:
    return [x / p[-1] for x in p]


def common(a: Polynomial, b: Polynomial) -> Polynomial:
    while b:
        a, b = b, divided(a, b)[1]
    return monic(a)


def product(polynomials: list[Polynomial]) -> Polynomial:
    total = ONE
    for p in polynomials:
        total = times(total, p)
    return total


def smith(matrix: Matrix) -> list[Polynomial]:
    """Return the invariant polynomials that are not zero."""
    left = [[trimmed(x) for x in row] for row in matrix]
    found: list[Polynomial] = []
    while (pivot := _least(left)) is not None:
        i, j = pivot
        left[0], left[i] = left[i], left[0]
        left = [[row[j], *row[:j], *row[j + 1 :]] for row in left]
        first = left[0][0]
        for row in left[1:]:
            factor = divided(row[0], first)[0]
            row[:] = [plus(x, times([-y for y in factor], z)) for x, z in zip(row, left[0], strict=True)]
        for k in range(1, len(left[0])):
            factor = [-y for y in divided(left[0][k], first)[0]]
            for row in left:
                row[k] = plus(row[k], times(factor, row[0]))
        if any(row[0] for row in left[1:]) or any(left[0][1:]):
            continue
        spoiled = next((row for row in left[1:] if any(divided(x, first)[1] for x in row)), None)
        if spoiled is not None:
            left[0] = [plus(x, y) for x, y in zip(left[0], spoiled, strict=True)]
            continue
        found.append(monic(first))
        left = [row[1:] for row in left[1:]]
    return found


def _least(matrix: Matrix) -> tuple[int, int] | None:
    places = [(len(x), i, j) for i, row in enumerate(matrix) for j, x in enumerate(row) if x]
    return min(places)[1:] if places else None


def roots(p: Polynomial) -> list[tuple[complex, int]]:
    """Return the roots of a polynomial, each with its multiplicity."""
    found, order = [], 1
    slope = trimmed([i * x for i, x in enumerate(p)][1:])
    shared = common(p, slope) if len(p) > 1 else ONE
    simple = divided(p, shared)[0]
    while len(simple) > 1:
        rest = common(simple, shared)
        alone = divided(simple, rest)[0]
        if len(alone) > 1:
            numbers = [mpmath.mpf(x.numerator) / x.denominator for x in reversed(alone)]
            found += [(complex(z), order) for z in mpmath.polyroots(numbers, maxsteps=500, extraprec=400)]
        simple, shared, order = rest, divided(shared, rest)[0], order + 1
    return found


@dataclass(frozen=True)
class Zeros:
    """What the definitions say of a system, as polynomials, and its normal rank."""

    poles: Polynomial
    zeros: Polynomial
    invariant: Polynomial
    inputs: Polynomial
    outputs: Polynomial
    rank: int


def zeros_of(a: Rows, b: Rows, c: Rows, d: Rows) -> Zeros:
    """Return poles and zeros of state equations, by Smith forms of their matrices (Rosenbrock 1970)."""
    states = len(a)

    def constant(x: Fraction) -> Polynomial:
        return [x] if x else []

    def entry(i: int, j: int) -> Polynomial:
        return trimmed([-a[i][j], Fraction(int(i == j))])

    upper = [[entry(i, j) for j in range(states)] + [constant(-x) for x in b[i]] for i in range(states)]
    lower = [[constant(x) for x in (*c[i], *d[i])] for i in range(len(c))]
    invariant = smith([*upper, *lower])
    modes, adjugate = _adjugate(a)
    numerators = [
        [
            plus(_between(c[i], adjugate, [row[j] for row in b]), [x * d[i][j] for x in modes if d[i][j]])
            for j in range(len(d[i]))
        ]
        for i in range(len(c))
    ]
    poles, zeros = [], []
    for polynomial in smith(numerators):
        shared = common(polynomial, modes)
        zeros.append(divided(polynomial, shared)[0])
        poles.append(divided(modes, shared)[0])
    alone = [row[:states] for row in (*upper, *lower)]
    return Zeros(
        product(poles),
        product(zeros),
        product(invariant),
        product(smith(upper)),
        product(smith(alone)),
        len(invariant) - states,
    )


def _between(c: list[Fraction], adjugate: Matrix, b: list[Fraction]) -> Polynomial:
    total: Polynomial = []
    for x, row in zip(c, adjugate, strict=True):
        for entry, y in zip(row, b, strict=True):
            if x * y:
                total = plus(total, [x * y * z for z in entry])
    return total


def _adjugate(a: Rows) -> tuple[Polynomial, Matrix]:
    """Return ``det(s - A)`` and the adjugate of ``s - A`` (Faddeev and Leverrier)."""
    size = len(a)
    places = range(size)
    modes, powers = [Fraction(0)] * size + [Fraction(1)], []
    last = [[Fraction(0)] * size for _ in places]
    for k in range(1, size + 1):
        turned = [[sum((a[i][m] * last[m][j] for m in places), Fraction(0)) for j in places] for i in places]
        last = [[turned[i][j] + modes[size - k + 1] * (i == j) for j in places] for i in places]
        powers.append(last)
        trace = sum((a[i][m] * last[m][i] for i in places for m in places), Fraction(0))
        modes[size - k] = -trace / k
    powers.reverse()
    return modes, [[trimmed([power[i][j] for power in powers]) for j in places] for i in places]
