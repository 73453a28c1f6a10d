"""The Smith-McMillan form of a lumped transfer matrix, in symbols: its poles and zeros, place by place.

Input: a transfer matrix. Output: numerators and denominators on the diagonal of its form, up to factors
without s.

Example: ``G = [1/(s+1), 2/(s+3); 1/(s+1), 1/(s+1)]`` is N(s)/((s+1)(s+3)), N = [s+3, 2(s+1); s+3, s+3]. The
entries of N have no common divisor, and det N = (s+3)(1-s). So the form is diag(1/((s+1)(s+3)), (s-1)/(s+1)).

With D_k the greatest common divisor of all minors of order k, the invariant polynomials of N(s) are
D_k/D_(k-1), each divides the next, and over d(s), in lowest terms, they are the form (Smith 1861; McMillan
1952).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import comb, lcm

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.expressions import Expression, power, product_of, quotient
from symflex.matrices.transfer_matrix import TransferMatrix
from symflex.print.forms.arrange import Arranger
from symflex.transfer import TransferFunction
from symflex.transfer.lowest_terms import cancel

MOST_MINORS = 2_000  # of one order: those of a matrix of eight rows and four columns are fewer
Minors = dict[tuple[tuple[int, ...], tuple[int, ...]], fmpz_mpoly]  # by rows and columns
Entry = tuple[Factored, Factored]  # numerator and denominator


def smith_mcmillan(matrix: TransferMatrix) -> tuple[Entry, ...]:
    """Return the entries on the diagonal but for zeros, as many as the normal rank.

    Raises ModelError: SF910 for functions that are not rational in s; BudgetError: SF501 for too many minors.
    """
    if not matrix.is_rational or matrix.model.root:
        message = "only a matrix of rational functions of s has a Smith-McMillan form"
        raise ModelError(Diagnostic("SF910", message, None, "ask for its zeros as numbers"))
    over = matrix.over
    rows, columns = matrix.shape
    if max(comb(rows, k) * comb(columns, k) for k in range(min(rows, columns) + 1)) > MOST_MINORS:
        message = f"a matrix of {rows} outputs and {columns} inputs has too many minors"
        raise BudgetError(Diagnostic("SF501", message, None, "choose fewer with --out and --in"))
    scale = lcm(*(n.unit.denominator for row in over.numerators for n in row))
    entries = [[(n * scale).expand() for n in row] for row in over.numerators]
    ring, one = over.den.ring, entries[0][0] ** 0
    radicals = next(tf for tf in matrix.each if isinstance(tf, TransferFunction)).radicals
    form: list[Entry] = []
    before = Factored.number(ring, 1)
    minors: Minors = {((), ()): one}
    for order in range(1, min(rows, columns) + 1):
        minors = _minors(entries, minors, order)
        divisor = one * 0
        for minor in minors.values():
            spend()
            divisor = divisor.gcd(minor)
        if divisor.is_zero():
            break
        here = _in_s(Factored.polynomial(ring, divisor))
        above, _ = cancel(here, before, radicals=radicals)
        entry, _ = cancel(above, _in_s(over.den), radicals=radicals)
        form.append((_in_s(entry.numerator()), _in_s(entry.denominator())))
        before = here
    return tuple(form)


def _minors(
    entries: Sequence[Sequence[fmpz_mpoly]],
    before: Minors,
    order: int,
) -> Minors:
    """Return all minors of an order by rows and columns, from those of the order before (Laplace)."""
    zero = entries[0][0] * 0
    minors: Minors = {}
    for rows in combinations(range(len(entries)), order):
        for columns in combinations(range(len(entries[0])), order):
            spend()
            parts = (
                (-1) ** k * entries[rows[0]][j] * before[rows[1:], columns[:k] + columns[k + 1 :]]
                for k, j in enumerate(columns)
            )
            minors[rows, columns] = sum(parts, zero)
    return minors


def _in_s(value: Factored) -> Factored:
    """Return the factors that contain s."""
    s = value.ring.index[LAPLACE]
    kept = value.filter(lambda factor: bool(int(factor.degrees()[s])))
    return kept / kept.unit if kept.unit else kept


def in_expressions(matrix: TransferMatrix, form: Sequence[Entry]) -> list[Expression]:
    """Return the entries of the form as expressions."""
    like = next(tf for tf in matrix.each if isinstance(tf, TransferFunction))
    found = []
    for above, below in form:
        arranger = Arranger.plain(above.ring, {c.generator: c.expression for c in like.constants})
        num, den = (
            product_of([power(arranger.collected(f), e) for f, e in value.factors])
            for value in (above, below)
        )
        found.append(quotient(num, den))
    return found
