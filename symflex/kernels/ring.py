"""The exact ring: integer polynomials in s, the parameters, closed definitions and constants.

Input: an ordered tuple of generator names.
Output: a :class:`Ring` whose elements are python-flint ``fmpz_mpoly``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import comb, prod
from typing import TYPE_CHECKING

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx

from symflex.errors import BudgetError, Diagnostic

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

LAPLACE = "s"
TERM_LIMIT = 3_000_000
DEGREE_LIMIT = 20_000
MEMORY_LIMIT = 100_000_000
"""Bytes an expansion or elimination may take."""
COEFFICIENT_BYTES = 8
FEW = 16
"""How large coefficients may be that do not spoil a count of terms much."""
MANY = 5_000
"""Terms that are not counted one by one."""


@dataclass(frozen=True)
class Ring:
    """Integer polynomials in named generators, lexicographic order, ``s`` first.

    Parameters
    ----------
    names : tuple of str
        Generator names in order; the first one is ``s``.

    Examples
    --------
    >>> ring = Ring(("s", "m", "b"))
    >>> ring.generator("m") * ring.generator("s") + ring.generator("b")
    s*m + b
    """

    names: tuple[str, ...]
    context: fmpz_mpoly_ctx = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        internal = [
            name if name.isascii() and name.isidentifier() else f"_{i}" for i, name in enumerate(self.names)
        ]
        object.__setattr__(self, "context", fmpz_mpoly_ctx.get(internal, Ordering.lex))

    @cached_property
    def index(self) -> Mapping[str, int]:
        """Position of each generator."""
        return {name: i for i, name in enumerate(self.names)}

    def generator(self, name: str) -> fmpz_mpoly:
        """Return the generator called ``name``."""
        return self.context.gen(self.index[name])

    def bytes_of(self, terms: int) -> int:
        """Return about how much memory a polynomial takes: a byte per exponent, and its coefficients."""
        return terms * (len(self.names) + COEFFICIENT_BYTES)

    def constant(self, value: int) -> fmpz_mpoly:
        """Return an integer as a polynomial."""
        return self.context.constant(value)

    def compose(
        self,
        polynomial: fmpz_mpoly,
        images: Sequence[fmpz_mpoly],
        term_limit: int = TERM_LIMIT,
        memory_limit: int = MEMORY_LIMIT,
    ) -> fmpz_mpoly:
        """Replace every generator of ``polynomial``'s ring by its image in this ring.

        Raises
        ------
        BudgetError
            SF501 when the result could exceed the limits, terms and bytes.
        """
        check_expansion(self, polynomial, images, min(term_limit, memory_limit // self.bytes_of(1)))
        return polynomial.compose(*images, ctx=self.context)


def expanded_length(polynomial: fmpz_mpoly, lengths: Sequence[int]) -> int | None:
    """Return a bound on the terms of a polynomial whose generators are sums of some lengths.

    ``None`` when there is no quick one: many coefficients of both signs, or large ones.

    Examples
    --------
    >>> ring = Ring(("s", "x", "y"))
    >>> s, x, y = ring.context.gens()
    >>> expanded_length(s * x + x * y, (1, 2, 3))
    8
    """
    if all(length <= 1 for length, d in zip(lengths, polynomial.degrees(), strict=True) if int(d)):
        return len(polynomial)
    values = polynomial.coeffs()
    if min(values) >= 1 and max(values) <= FEW:
        # Every monomial counts at least once, as its coefficient is at least one.
        return int(polynomial(*lengths))
    if len(values) > MANY:
        return None
    return sum(int(prod(map(pow, lengths, map(int, m)))) for m in polynomial.monoms())


def check_expansion(
    ring: Ring, polynomial: fmpz_mpoly, images: Sequence[fmpz_mpoly], most: int | None = None
) -> None:
    """Refuse a substitution whose result in ``ring`` could be too large.

    Parameters
    ----------
    ring, polynomial, images
        See :meth:`Ring.compose`.
    most : int, optional
        Number of terms.

    Raises
    ------
    BudgetError
        SF501, before any work is done.
    """
    lengths = [len(image) for image in images]
    degrees = [int(image.total_degree()) if len(image) else 0 for image in images]
    small_degree = polynomial.total_degree() * max(degrees, default=0) <= DEGREE_LIMIT
    if max(lengths, default=0) <= 1 and small_degree:
        return
    if most is None:
        most = min(TERM_LIMIT, MEMORY_LIMIT // ring.bytes_of(1))
    bound = expanded_length(polynomial, lengths) if small_degree else None
    if bound is not None and bound <= most:
        return
    terms = 0
    for position in range(len(polynomial)):
        monomial = polynomial.monomial(position)  # one by one: most refusals come early
        product, degree = 1, 0
        for i, exponent in enumerate(monomial):
            if exponent:
                length, image_degree = lengths[i], degrees[i]
                degree += exponent * image_degree
                if length > 1:
                    product *= comb(length + exponent - 1, exponent)
        terms += product
        if terms > most or degree > DEGREE_LIMIT:
            message = (
                f"the expanded form would exceed {most} terms"
                if terms > most
                else f"the expanded form would exceed degree {DEGREE_LIMIT}"
            )
            raise BudgetError(Diagnostic("SF501", message, None, "keep repeated sums in [definitions]"))


def degree_in(polynomial: fmpz_mpoly, generator: int) -> int:
    """Return the degree of ``polynomial`` in the generator at position ``generator``; 0 for zero."""
    return int(polynomial.degrees()[generator]) if len(polynomial) else 0
