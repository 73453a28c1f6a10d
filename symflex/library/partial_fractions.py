"""Characteristic polynomials that factor, and what each factor adds to the fundamental matrix.

Input: a characteristic polynomial ``chi`` and ``adj(lambda I - A) = sum_k lambda^k B_k``.
Output: one :class:`Share` per factor ``p^m`` of ``chi``.

With ``adj/chi = sum_i R_i/p_i^m_i``, the inverse Laplace transform in x says that ``exp(A x)`` is the sum of
``h_i^(k)(x) R_ik``, where ``p_i(d/dx)^m_i h_i = 0``. So every factor has wavenumbers of its own, and equal
ones, a factor with ``m > 1``, never divide by their difference: solutions have powers of x in front instead.

Example: two equal strings, of which one drives the other.

    chi = (lambda^2 - gamma^2)^2     h = (x cosh(gamma x) - sinh(gamma x)/gamma)/(2 gamma^2)
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from flint import fmpz_mpoly

from symflex.algebra import Factored, Ring, by_powers, degree_in, irreducible_factors

Matrix = tuple[tuple[Factored, ...], ...]
Row = list[Factored]

EXPONENT = "[lambda]"  # the generator that stands for the exponent: no name of a model has brackets
FACTORED_TERMS = 2_000  # terms of a characteristic polynomial up to which it is factored: less than a second


@dataclass(frozen=True, slots=True, eq=False)
class Share:
    """One factor ``p^multiplicity`` of a characteristic polynomial."""

    factor: tuple[Factored, ...]  # ``c_0, ..., c_(n-1)`` of p, which is monic
    multiplicity: int
    coefficients: tuple[Factored, ...]  # the same of ``p^multiplicity``
    adjugate: tuple[Matrix, ...]  # ``R_0, R_1, ...``
    meets: tuple[Factored, ...] = ()  # what is zero where another factor has the same root, but for s


def squared(coefficients: Sequence[Factored]) -> tuple[Factored, ...]:
    """Return p of a polynomial ``p^2 = lambda^4 + c_2 lambda^2 + c_0`` that is known to be a square."""
    return coefficients[2] / 2, coefficients[0] * 0


def factors(coefficients: Sequence[Factored]) -> list[tuple[tuple[Factored, ...], int]]:
    """Return the monic factors of ``lambda^n + ... + c_0``, with multiplicities; whole if too large.

    >>> ring = Ring(("s", "k"))
    >>> k = Factored.generator(ring, "k")
    >>> found = factors([k * (k + 1), k * 0, k * 2 + 1, k * 0])
    >>> [([str(c) for c in p], m) for p, m in found]
    [(['k', '0'], 1), (['(k + 1)', '0'], 1)]
    """
    ring = coefficients[0].ring
    wide = Ring((*ring.names, EXPONENT))
    last, position = wide.generator(EXPONENT), len(ring.names)
    lifted = [c.over(wide) for c in coefficients]
    total = Factored.polynomial(wide, last) ** len(lifted)
    for k, c in enumerate(lifted):
        total = total + c * Factored.polynomial(wide, last) ** k
    polynomials = [f for f, e in total.factors if e > 0]
    if sum(map(len, polynomials)) > FACTORED_TERMS:
        return [(tuple(coefficients), 1)]
    parts = []
    for polynomial, exponent in total.factors:
        if exponent < 0 or not degree_in(polynomial, position):
            continue
        for part, times in irreducible_factors(polynomial)[1]:
            powers = by_powers(wide, part, position)
            if (degree := max(powers)) > 0:
                plain = {k: ring.taken_over(c, wide.names) for k, c in powers.items()}
                monic = (_quotient(ring, plain.get(k), plain[degree]) for k in range(degree))
                parts.append((tuple(monic), times * exponent))
    return parts


def _quotient(ring: Ring, above: fmpz_mpoly | None, below: fmpz_mpoly) -> Factored:
    if above is None:
        return Factored.number(ring, 0)
    return lowest(Factored.polynomial(ring, above) / Factored.polynomial(ring, below))


def lowest(value: Factored) -> Factored:
    """Return a value in lowest terms, with irreducible factors below."""
    ring = value.ring
    sums = [(f, -e) for f, e in value.factors if e < 0 and len(f) > 1]
    if not sums or value.is_zero:
        return value
    above = value.numerator().filter(lambda f: len(f) > 1).expand()
    result = value.filter(lambda f: len(f) == 1) * value.unit
    for polynomial, exponent in sums:
        for part, times in irreducible_factors(polynomial)[1]:
            power = times * exponent
            while power and (above % part).is_zero():
                above, power = above / part, power - 1
            result = result / Factored.polynomial(ring, part) ** power
    return result * Factored.polynomial(ring, above)


def shares(
    factors_found: Sequence[tuple[tuple[Factored, ...], int]],
    adjugate: Sequence[Matrix],
    known: Collection[fmpz_mpoly],
) -> tuple[Share, ...] | None:
    """Return the partial fractions of ``adj/chi``, whose denominators are ``known`` before."""
    # Where two factors meet, their sum has no pole, but each has. That is seen later at s = 0, and where what
    # vanishes is linear in s or a parameter; ``None`` for others.
    one = adjugate[0][0][0] ** 0
    powers = []
    for p, m in factors_found:
        power = [one]
        for _ in range(m):
            power = _multiplied(power, [*p, one])
        powers.append(power)
    result = []
    for n, ((p, m), modulus) in enumerate(zip(factors_found, powers, strict=True)):
        other = [one]
        for k, power in enumerate(powers):
            other = other if k == n else _remainder(_multiplied(other, power), modulus)
        inverse = _inverse(other, modulus)
        if inverse is None:
            return None
        matrices = _reduced(adjugate, inverse, modulus)
        meets = _poles(matrices, known) if len(factors_found) > 1 else []
        if any(degree_in(f, 0) and 1 not in map(int, f.degrees()) for f in meets):
            return None
        meeting = tuple(Factored.polynomial(one.ring, f) for f in meets)
        result.append(Share(p, m, tuple(modulus[:-1]), matrices, meeting))
    return tuple(result)


def _poles(matrices: Sequence[Matrix], known: Collection[fmpz_mpoly]) -> list[fmpz_mpoly]:
    """Return the factors below entries, but for s and those known."""
    poles: list[fmpz_mpoly] = []
    for value in (x for b in matrices for row in b for x in row):
        for f, e in value.factors:
            if e < 0 and f != value.ring.context.gen(0) and f not in known and f not in poles:
                poles.append(f)
    return poles


def _multiplied(left: Row, right: Row) -> Row:
    total = [left[0] * 0] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for k, b in enumerate(right):
            if not (a.is_zero or b.is_zero):
                total[i + k] = total[i + k] + a * b
    return total


def _remainder(polynomial: Row, divisor: Row) -> Row:
    """Return the remainder of a division by a monic polynomial, as many coefficients as that has roots."""
    degree, remaining = len(divisor) - 1, list(polynomial)
    for k in range(len(remaining) - 1, degree - 1, -1):
        top = remaining.pop()
        if not top.is_zero:
            for j, c in enumerate(divisor[:-1]):
                if not c.is_zero:
                    remaining[k - degree + j] = remaining[k - degree + j] - top * c
    return [*map(lowest, remaining), *[divisor[0] * 0] * (degree - len(remaining))]


def _inverse(polynomial: Row, divisor: Row) -> Row | None:
    """Return what times a polynomial leaves the remainder one."""
    degree, zero = len(divisor) - 1, divisor[0] * 0
    columns = [_remainder([*[zero] * k, *polynomial], divisor) for k in range(degree)]
    rows = [[column[i] for column in columns] for i in range(degree)]
    solved = solve(rows, [[zero + int(i == 0)] for i in range(degree)])
    return None if solved is None else [lowest(x) for (x,) in solved]


def _reduced(adjugate: Sequence[Matrix], inverse: Row, divisor: Row) -> tuple[Matrix, ...]:
    """Return the coefficients of ``adj*inverse`` modulo a divisor."""
    size = range(len(adjugate[0]))
    remainders = [
        [_remainder(_multiplied([b[i][j] for b in adjugate], inverse), divisor) for j in size] for i in size
    ]
    return tuple(
        tuple(tuple(remainders[i][j][k] for j in size) for i in size) for k in range(len(divisor) - 1)
    )


def solve(matrix: list[Row], right: list[Row]) -> list[Row] | None:
    """Return ``matrix^-1 right`` by Gauss-Jordan elimination, ``None`` when the matrix is singular."""
    rows = [[*a, *b] for a, b in zip(matrix, right, strict=True)]
    n = len(matrix)
    for column in range(n):
        pivot = next((r for r in range(column, n) if not rows[r][column].is_zero), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        scale = rows[column][column]
        rows[column] = [x / scale for x in rows[column]]
        for r in range(n):
            factor = rows[r][column]
            if r != column and not factor.is_zero:
                rows[r] = [
                    x if y.is_zero else x - factor * y for x, y in zip(rows[r], rows[column], strict=True)
                ]
    return [row[n:] for row in rows]
