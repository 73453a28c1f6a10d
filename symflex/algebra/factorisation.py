"""Factors of integer polynomials with coefficients of any size: what stands before the library.

``12 x^2 - 12 y^2`` is ``12 (x - y) (x + y)``. Nothing else in the program asks a polynomial for its factors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpq_mpoly_ctx

if TYPE_CHECKING:
    from flint import fmpz_mpoly


def irreducible_factors(polynomial: fmpz_mpoly) -> tuple[int, list[tuple[fmpz_mpoly, int]]]:
    """Return a nonzero polynomial as a number times powers of polynomials irreducible over the rationals.

    The number bears the sign; factors have content 1 and positive leading coefficients, and are ordered by
    exponents, then by terms.

    Examples
    --------
    >>> from symflex.algebra import Ring
    >>> s, k = Ring(("s", "k")).context.gens()
    >>> irreducible_factors((s + 2**70) * (s + 2**70 + 2) * k**2 * -6)
    (-6, [(s + 1180591620717411303424, 1), (s + 1180591620717411303426, 1), (k, 2)])
    """
    try:
        number, factors = polynomial.factor()
    except OverflowError:
        # To sort integer polynomials python-flint 0.9 reads their coefficients as C integers. Those with
        # rational coefficients it sorts in the same order, and with coefficients of any size.
        context = polynomial.context()
        rational = fmpq_mpoly_ctx.get(context.names(), context.ordering())
        unit, parts = rational.from_dict(polynomial.to_dict()).factor()
        number = unit.p
        factors = [(context.from_dict({m: c.p for m, c in part.terms()}), times) for part, times in parts]
    return int(number), [(factor, int(times)) for factor, times in factors]


def square_free_factors(polynomial: fmpz_mpoly) -> tuple[int, list[tuple[fmpz_mpoly, int]]]:
    """Return a nonzero polynomial as a number times powers of coprime polynomials without squares.

    See :func:`irreducible_factors`; these are in no order.

    Examples
    --------
    >>> from symflex.algebra import Ring
    >>> s, k = Ring(("s", "k")).context.gens()
    >>> square_free_factors(3 * (s + 1) * (s - k) ** 2)
    (3, [(s + 1, 1), (s - k, 2)])
    """
    number, factors = polynomial.factor_squarefree()
    return int(number), [(factor, int(times)) for factor, times in factors]
