"""Whether a function is even in s because waves run one way at s as they run the other way at -s.

With complex coefficients j turns with s, and the function is real on the imaginary axis.

Input: a product over a ring with fundamental functions h, h', ... of dispersions.
Output: proved, or not known.

Example: a belt that moves between rolls, ``w'''' + 2 v s w' + ... = 0``, stays what it is if x and s change
their signs. So ``h^(k)`` at -s and the length l is ``-(-1)^k h^(k)`` at s and -l, which ``exp(-x l)`` gives
modulo the characteristic polynomial of x: the adjugate of the matrix of ``exp(x l)``, over its determinant.
That is 1 without a power n - 1 of x. The belt's poles mirror each other in the imaginary axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from math import prod

from flint import fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, KernelTable, degree_in
from symflex.model.model import IMAGINARY

LARGEST_ORDER = 4  # of a dispersion: adjugates of larger matrices have too many terms
HIGHEST_DEGREE = 4  # in fundamental functions


def is_reversed(part: Factored, table: KernelTable) -> bool:
    """Tell whether each factor F is proved to stay, but for a sign, if waves, s and j turn round."""
    used = [k for k in table.kernels if part.depends_on(k.generator)]
    laws = list(dict.fromkeys(k.dispersion for k in used))
    is_one = len(laws) == 1 and len({k.length for k in used}) == 1
    if not is_one or any(k.function != "fundamental" or k.length.depends_on(LAPLACE) for k in used):
        return False
    (law,), ring = laws, part.ring
    order, at_s = law.order, ring.index[LAPLACE]
    below = [f for c in law.characteristic for f, e in c.factors if e < 0]
    if order > LARGEST_ORDER or not law.characteristic[-1].is_zero or any(degree_in(f, at_s) for f in below):
        return False
    divisors = list(dict.fromkeys(map(str, below)))
    context = fmpq_mpoly_ctx.get(
        (*ring.names, *(f"u{i}" for i in range(len(divisors))), *(f"h{i}" for i in range(order))), "lex"
    )
    every = context.gens()
    inverses = dict(zip(divisors, every[len(ring.names) :], strict=False))
    functions = every[-order:]

    def exact(polynomial: fmpz_mpoly) -> fmpq_mpoly:
        spare = (0,) * (len(every) - len(ring.names))
        return context.from_dict({(*map(int, m), *spare): fmpq(c) for m, c in polynomial.terms()})

    def value_of(value: Factored) -> fmpq_mpoly:
        powers = (exact(f) ** e if e > 0 else inverses[str(f)] ** -e for f, e in value.factors)
        unit = context.constant(fmpq(value.unit.numerator, value.unit.denominator))
        return prod(powers, start=unit)

    turned = list(every)
    at_j = ring.index.get(IMAGINARY)
    for i in (at_s,) if at_j is None else (at_s, at_j):
        turned[i] = -every[i]
    known = [value_of(c) for c in law.characteristic]
    signs = [(-1) ** (order - k) for k in range(order)]
    if any(c.compose(*turned, ctx=context) != sign * c for c, sign in zip(known, signs, strict=True)):
        return False
    reversed_functions, determinant = _at_minus_length(known, functions)
    named = list(every)
    for k in used:
        named[ring.index[k.generator]] = functions[k.order]
    for i, f in enumerate(reversed_functions):
        turned[len(every) - order + i] = (-1) ** (order - 1 + i) * f
    for factor, _ in part.factors:
        own = exact(factor).compose(*named, ctx=context)
        degrees = {sum(m[-order:]) for m in own.monoms()}
        degree = degrees.pop()
        if degrees or degree > HIGHEST_DEGREE or degree * (order - 2) % order:
            return False
        expected = own * determinant ** (degree * (order - 2) // order)
        image = own.compose(*turned, ctx=context)
        differences = [image - expected, image + expected]
        if at_j is not None:  # j^2 = -1
            differences = [x % (every[at_j] ** 2 + 1) for x in differences]
        if all(differences):
            return False
    return True


def _at_minus_length(
    known: Sequence[fmpq_mpoly], functions: Sequence[fmpq_mpoly]
) -> tuple[list[fmpq_mpoly], fmpq_mpoly]:
    """Return ``h, h', ...`` at -l times a determinant, and that, from those at l.

    ``exp(x l)`` modulo ``x^n + ... + c_0`` has the coefficients ``h^(n-1-k) + ... + c_(k+1) h`` of x^k.
    """
    order, one = len(known), known[0] * 0 + 1
    tops = [*known, one]
    column = [sum((tops[k + 1 + j] * functions[j] for j in range(order - k)), one * 0) for k in range(order)]
    columns = [column]
    for _ in range(order - 1):
        columns.append(_times_x(columns[-1], known))
    rows = [[columns[j][i] for j in range(order)] for i in range(order)]
    inverse = [
        (-1) ** k * _determinant([row[:k] + row[k + 1 :] for row in rows[1:]], one) for k in range(order)
    ]
    determinant = sum((rows[0][k] * inverse[k] for k in range(order)), one * 0)
    reversed_functions = []
    for _ in range(order):
        reversed_functions.append(inverse[-1])
        inverse = _times_x(inverse, known)
    return reversed_functions, determinant


def _times_x(column: Sequence[fmpq_mpoly], known: Sequence[fmpq_mpoly]) -> list[fmpq_mpoly]:
    top = column[-1]
    shifted = [top * 0, *column[:-1]]
    return [x - c * top for x, c in zip(shifted, known, strict=True)]


def _determinant(rows: Sequence[Sequence[fmpq_mpoly]], one: fmpq_mpoly) -> fmpq_mpoly:
    total = one * 0
    for order in permutations(range(len(rows))):
        swaps = sum(a > b for i, b in enumerate(order) for a in order[:i])
        total += (-1) ** swaps * prod((row[j] for row, j in zip(rows, order, strict=True)), start=one)
    return total
